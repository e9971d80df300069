//! The housing of a case: a parametric casing or a mesh of the user's, ready to be reduced.

use std::path::Path;

use planetary::housing::casing::{BearingPart, BossBearing, InputPart, MountPart, Swelling, WallPoint};
use planetary::housing::inp::{self, Units};
use planetary::housing::{
    Casing, Damping, Housing as Solid, Mount as SolidMount, PortPlace, ReductionOptions, SeatPlace, SensorAt,
    SensorPlace, Tie,
};

use super::resolve::Place;
use super::schema::Transmission;
use super::stage_schema::{Housing, MeshUnits};
use crate::document::Node;
use crate::fault::Fault;
use crate::input;

const MM: f64 = 1e-3;

/// A housing to be reduced.
#[derive(Debug, Clone, PartialEq)]
pub struct HousingPlan {
    /// Mesh, mounts, ports, seat, sensors.
    pub solid: Solid,
    /// What is kept of it.
    pub options: ReductionOptions,
}

impl HousingPlan {
    /// Names of its ports.
    pub fn ports(&self) -> impl Iterator<Item = &str> {
        self.solid.ports.iter().map(|port| port.name.as_str())
    }
}

/// The housing of a case with its sensors; `None` without one, or with faults.
pub fn plan(
    inputs: &Transmission,
    sensors: &[Place],
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<HousingPlan> {
    let written = inputs.housing.as_ref()?;
    let before = faults.len();
    let mut fault = |key: &str, message: String| faults.push(document.fault(key, message));
    let place = |sensor: &Place| SensorPlace {
        name: sensor.name.clone(),
        at: SensorAt::Wall { angle: sensor.angle, z: sensor.height },
        direction: None,
    };
    let sensors: Vec<SensorPlace> = sensors.iter().map(place).collect();
    let solid = match &written.mesh {
        Some(name) => own_mesh(written, &folder.join(name), sensors, &mut fault),
        None => casing(inputs, written, sensors, &mut fault),
    };
    let solid = solid?;
    for (index, bearing) in inputs.bearing.iter().enumerate() {
        let Some(port) = &bearing.port else { continue };
        if !solid.ports.iter().any(|own| own.name == *port) {
            let known = solid.ports.iter().map(|own| own.name.as_str()).collect::<Vec<_>>().join(", ");
            let message = format!("the housing has no such port; it has: {known}");
            faults.push(document.fault(&format!("bearing[{}].port", index + 1), message));
        }
    }
    let options = ReductionOptions {
        modes: written.modes as usize,
        highest_frequency: written.highest_frequency_hz,
        damping: Damping::Ratio(written.damping_ratio),
    };
    (faults.len() == before).then_some(HousingPlan { solid, options })
}

/// A mesh of the user's.
fn own_mesh(
    written: &Housing,
    file: &Path,
    sensors: Vec<SensorPlace>,
    fault: &mut impl FnMut(&str, String),
) -> Option<Solid> {
    for (key, given) in [
        ("wall_radius_mm", !written.wall_radius_mm.is_empty()),
        ("swelling", !written.swelling.is_empty()),
        ("input", written.input.is_some()),
        ("ring_segment", written.ring_segment.is_some()),
    ] {
        if given {
            fault(&format!("housing.{key}"), "describes a casing; leave it out with a mesh of your own".into());
        }
    }
    for (key, empty) in [("mount", written.mount.is_empty()), ("port", written.port.is_empty())] {
        if empty {
            let message = "a mesh of your own needs at least one: name its node set";
            fault(&format!("housing.{key}"), message.into());
        }
    }
    let text = input::read_text(file, input::MAX_MESH);
    let text = text.map_err(|e| fault("housing.mesh", format!("cannot be read: {e}"))).ok()?;
    let units = match written.mesh_units {
        MeshUnits::Si => Units::SI,
        MeshUnits::Millimetre => Units::MILLIMETRE,
    };
    let mesh = inp::read(&text, &units).map_err(|e| fault("housing.mesh", e.to_string())).ok()?;
    let known = mesh.node_sets.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
    let mut set = |key: String, name: &str| {
        if !mesh.node_sets.contains_key(name) {
            fault(&key, format!("the mesh has no node set of this name; it has: {known}"));
        }
    };
    set("housing.ring_seat".into(), &written.ring_seat);
    for (index, mount) in written.mount.iter().enumerate() {
        set(format!("housing.mount[{}].name", index + 1), &mount.name);
    }
    for (index, port) in written.port.iter().enumerate() {
        set(format!("housing.port[{}].name", index + 1), &port.name);
    }
    let mount = |mount: &super::stage_schema::Mount| SolidMount {
        set: mount.name.clone(),
        tie: Tie::Springs([
            mount.radial_stiffness_n_per_m,
            mount.tangential_stiffness_n_per_m,
            mount.axial_stiffness_n_per_m,
        ]),
    };
    Some(Solid {
        mounts: written.mount.iter().map(mount).collect(),
        ports: written.port.iter().map(|port| PortPlace { name: port.name.clone(), position: None }).collect(),
        seat: Some(SeatPlace { set: written.ring_seat.clone(), harmonics: written.seat_harmonics as usize }),
        sensors,
        mesh,
    })
}

/// A casing of revolution; what is left out is that of the default.
fn casing(
    inputs: &Transmission,
    written: &Housing,
    sensors: Vec<SensorPlace>,
    fault: &mut impl FnMut(&str, String),
) -> Option<Solid> {
    let mut casing = Casing { sensors, seat_harmonics: written.seat_harmonics as usize, ..Casing::default() };
    let (radii, heights, thickness) = (&written.wall_radius_mm, &written.wall_height_mm, &written.wall_thickness_mm);
    if !(radii.is_empty() && heights.is_empty() && thickness.is_empty()) {
        if radii.len() != heights.len() || radii.len() != thickness.len() {
            let counts = format!("{}, {} and {} values", radii.len(), heights.len(), thickness.len());
            let message = "wall_height_mm and wall_thickness_mm need one value for each point of the wall";
            fault("housing.wall_radius_mm", format!("{counts}: {message}"));
            return None;
        }
        let point = |((r, z), t): ((&f64, &f64), &f64)| WallPoint { r: r * MM, z: z * MM, thickness: t * MM };
        casing.wall = radii.iter().zip(heights).zip(thickness).map(point).collect();
        for (key, given) in [
            ("ring_segment", written.ring_segment.is_some()),
            ("mount", !written.mount.is_empty()),
            ("port", !written.port.is_empty()),
        ] {
            if !given {
                fault(&format!("housing.{key}"), "this key is required with a wall of your own".into());
            }
        }
        // those of the default sit on the default's wall
        casing.swellings.clear();
        casing.input = None;
    }
    let segment = |number: u32| number as usize - 1;
    if let Some(ring) = &mut casing.ring {
        if let Some(number) = written.ring_segment {
            ring.segment = segment(number);
        }
        // the teeth themselves are the meshes'
        let root = written.ring_inner_diameter_mm.or((!radii.is_empty()).then_some(inputs.ring.root_diameter_mm));
        ring.inner_radius = root.map_or(ring.inner_radius, |diameter| 0.5 * diameter * MM);
    }
    if !written.swelling.is_empty() {
        let swelling = |s: &super::stage_schema::Swelling| Swelling {
            angle: s.angle_deg.to_radians(),
            width: s.width_deg.to_radians(),
            along: s.along_mm * MM,
            length: s.length_mm * MM,
            thickness: s.thickness_mm * MM,
        };
        casing.swellings = written.swelling.iter().map(swelling).collect();
    }
    if !written.mount.is_empty() {
        casing.mounts.clear();
    }
    for (index, mount) in written.mount.iter().enumerate() {
        let (Some(angle), Some(width), Some(first)) = (mount.angle_deg, mount.width_deg, mount.first_segment) else {
            let message = "a mount of a casing needs angle_deg, width_deg and first_segment";
            fault(&format!("housing.mount[{}]", index + 1), message.into());
            continue;
        };
        casing.mounts.push(MountPart {
            name: mount.name.clone(),
            angle: angle.to_radians(),
            width: width.to_radians(),
            segments: [segment(first), segment(mount.last_segment.unwrap_or(first))],
            stiffness: [
                mount.radial_stiffness_n_per_m,
                mount.tangential_stiffness_n_per_m,
                mount.axial_stiffness_n_per_m,
            ],
        });
    }
    if !written.port.is_empty() {
        casing.bearings.clear();
    }
    for (index, port) in written.port.iter().enumerate() {
        match port.segment {
            Some(number) => casing.bearings.push(BearingPart { name: port.name.clone(), segment: segment(number) }),
            None => fault(&format!("housing.port[{}].segment", index + 1), "this key is required of a casing".into()),
        }
    }
    if let Some(input) = &written.input {
        casing.input = Some(InputPart {
            segment: segment(input.segment),
            angle: input.angle_deg.to_radians(),
            width: input.width_deg.to_radians(),
            thickness: input.thickness_mm * MM,
            elevation: input.elevation_deg.to_radians(),
            bearings: input
                .port
                .iter()
                .map(|port| BossBearing { name: port.name.clone(), span: [port.from_mm * MM, port.to_mm * MM] })
                .collect(),
        });
    }
    let material = &mut casing.material;
    material.young_modulus = written.young_modulus_gpa.map_or(material.young_modulus, |e| e * 1e9);
    material.poisson_ratio = written.poisson_ratio.unwrap_or(material.poisson_ratio);
    material.density = written.density_kg_per_m3.unwrap_or(material.density);
    casing.density.element_size = written.element_size_mm * MM;
    casing.housing().map_err(|error| fault("housing", error.to_string())).ok()
}
