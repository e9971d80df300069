//! The transmission of a state as the engine takes it: train, bodies, bearings, meshes.

use std::sync::Arc;

use gear_geom::MeshSite;
use nalgebra::Vector3;
use planetary::elastic::ElasticBody;
use planetary::engine::{Anchor, Bearing, BevelStage, BodyId, Mesh, PlanetaryStage, RigidBody, TransmissionSpec};
use planetary::mesh::{MeshLaw, pin_offset};
use planetary::stage::{StageLaws, StageValues, mean_stiffness};

use gearwright_case::TransmissionCase;
use gearwright_case::transmission::bevel;
use gearwright_case::transmission::resolve::BodyValues;
use gearwright_case::transmission::schema::Supported;

const MM: f64 = 1e-3;
const STANDING: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Force, as a part of the mean, from which on the damping of a mesh is full.
const FULL_DAMPING: f64 = 0.01;

/// Laws of the meshes of a state.
#[derive(Debug, Clone)]
pub struct Laws {
    /// Planetary stage.
    pub stage: StageLaws,
    /// Bevel mesh.
    pub bevel: Option<Arc<dyn MeshLaw>>,
}

/// The transmission of a state.
///
/// # Errors
/// A planet that the train does not have (it has been checked).
pub fn spec(case: &TransmissionCase, laws: &Laws, housing: Option<ElasticBody>) -> anyhow::Result<TransmissionSpec> {
    let gears = case.train.spec();
    let [z_s, z_r] = [&gears.sun, &gears.ring].map(|gear| f64::from(gear.teeth()));
    let own = case.inputs.bearing.iter().find(|bearing| bearing.on == Supported::Planet);
    let [radial, axial, tilt, bearing_damping] = own.map_or([0.0; 4], |b| {
        [b.radial_stiffness_n_per_m, b.axial_stiffness_n_per_m, b.tilt_stiffness_n_m_per_rad, b.damping_s]
    });
    let planet = &case.bodies.planet;
    let values = StageValues {
        output_torque: case.inputs.run.torque_n_m,
        mesh_damping: case.inputs.numerics.mesh_damping_s,
        planet_mass: planet.mass,
        planet_polar: planet.polar,
        planet_transverse: planet.transverse,
        bearing_stiffness: [radial, radial, axial, tilt, tilt],
        bearing_damping,
    };
    let mut stage = PlanetaryStage::of_train(&case.train, &laws.stage, &values)?;
    let angles = [stage.sun_pressure_angle, stage.ring_pressure_angle];
    for (planet, &[radial, tangential]) in stage.planets.iter_mut().zip(&case.pin_errors) {
        for (mesh, site, angle) in [
            (&mut planet.sun_mesh, MeshSite::SunPlanet, angles[0]),
            (&mut planet.ring_mesh, MeshSite::PlanetRing, angles[1]),
        ] {
            if let Some(coast) = &mut mesh.coast {
                // coast flanks push the planet backward
                coast.backlash = (coast.backlash + pin_offset(site, angle, [radial, -tangential])).max(0.0);
            }
        }
    }
    Ok(TransmissionSpec {
        stage,
        sun: on_main_axis(&case.bodies.sun, (z_s + z_r) / z_s),
        carrier: on_main_axis(&case.bodies.carrier, 1.0),
        bearings: bearings(case),
        housing,
        drive: Some(if case.bevel.is_some() { BodyId::BevelPinion } else { BodyId::Sun }),
        bevel: case.bevel.as_ref().zip(laws.bevel.as_ref()).map(|(stage, law)| bevel_stage(case, stage, law)),
    })
}

/// Mean force of the bevel mesh along its normal (N).
#[must_use]
pub fn bevel_force(case: &TransmissionCase, stage: &bevel::BevelStage) -> f64 {
    let spec = case.train.spec();
    let [z_s, z_r] = [&spec.sun, &spec.ring].map(|gear| f64::from(gear.teeth()));
    case.inputs.run.torque_n_m * z_s / (z_s + z_r) / stage.line.arms[1].abs()
}

fn bevel_stage(case: &TransmissionCase, stage: &bevel::BevelStage, law: &Arc<dyn MeshLaw>) -> BevelStage {
    let speeds = &case.speeds;
    let line = &stage.line;
    let axis: [f64; 3] = line.pinion_axis.into_inner().into();
    let place = stage.pinion.centre;
    let force = bevel_force(case, stage);
    // teeth that pass in a turn of the carrier; the mesh stands with the housing
    let cycles_per_turn = f64::from(stage.pair.spec().teeth[1]) * speeds.sun / speeds.carrier;
    let pinion = RigidBody {
        position: std::array::from_fn(|k| stage.apex[k] + place * axis[k]),
        axis,
        mass: stage.pinion.mass,
        polar: stage.pinion.polar,
        transverse: stage.pinion.transverse,
        // the torque on the pinion is against its sense
        spin_ratio: -line.arms[0].signum() * cycles_per_turn / f64::from(stage.pair.spec().teeth[0]),
    };
    BevelStage {
        pinion,
        gear: stage.gear.map(|gear| on_main_axis(&gear, speeds.sun / speeds.carrier)),
        mesh: Mesh {
            law: law.clone(),
            cycle_offset: 0.0,
            damping: case.inputs.numerics.mesh_damping_s * mean_stiffness(law.as_ref(), force),
            damping_force: (FULL_DAMPING * force).max(f64::MIN_POSITIVE),
            coast: None,
        },
        point: line.point.coords.into(),
        normal: line.normal.into_inner().into(),
        cycles_per_turn,
    }
}

fn on_main_axis(body: &BodyValues, spin_ratio: f64) -> RigidBody {
    RigidBody {
        position: [0.0, 0.0, body.centre],
        axis: [0.0, 0.0, 1.0],
        mass: body.mass,
        polar: body.polar,
        transverse: body.transverse,
        spin_ratio,
    }
}

/// Bearings but those of the planets, named by body and number, and the spline.
fn bearings(case: &TransmissionCase) -> Vec<Bearing> {
    let pinion_axis = case.bevel.as_ref().map(|stage| stage.line.pinion_axis.into_inner());
    let mut counts = [0_usize; 5];
    let made = case.inputs.bearing.iter().filter_map(|bearing| {
        let body = body_of(bearing.on)?;
        let count = &mut counts[bearing.on as usize];
        *count += 1;
        let (kr, kz, kt) =
            (bearing.radial_stiffness_n_per_m, bearing.axial_stiffness_n_per_m, bearing.tilt_stiffness_n_m_per_rad);
        let stiffness = [kr, kr, kz, kt, kt, 0.0];
        let along = bearing.place_mm * MM;
        let (position, axes) = match (pinion_axis.filter(|_| body == BodyId::BevelPinion), &case.bevel) {
            (Some(axis), Some(stage)) => (std::array::from_fn(|k| stage.apex[k] + along * axis[k]), about(axis)),
            _ => ([0.0, 0.0, along], STANDING),
        };
        Some(Bearing {
            name: format!("{body} {count}"),
            body,
            anchor: bearing.port.clone().map_or(Anchor::Ground, Anchor::Port),
            position,
            axes,
            stiffness,
            damping: stiffness.map(|k| bearing.damping_s * k),
        })
    });
    let spline = case.inputs.bevel.as_ref().and_then(|bevel| bevel.spline).map(|spline| {
        let (kr, kz, kt) =
            (spline.radial_stiffness_n_per_m, spline.axial_stiffness_n_per_m, spline.tilt_stiffness_n_m_per_rad);
        let stiffness = [kr, kr, kz, kt, kt, spline.torsional_stiffness_n_m_per_rad];
        Bearing {
            name: "spline".into(),
            body: BodyId::BevelGear,
            anchor: Anchor::Body(BodyId::Sun),
            position: [0.0, 0.0, spline.place_mm * MM],
            axes: STANDING,
            stiffness,
            damping: stiffness.map(|k| spline.damping_s * k),
        }
    });
    made.chain(spline).collect()
}

/// Orthonormal axes of which the third is this one.
fn about(axis: Vector3<f64>) -> [[f64; 3]; 3] {
    let level = Vector3::z().cross(&axis);
    // an axis along z has any level direction beside it
    let first = if level.norm() > 1e-9 { level.normalize() } else { Vector3::x() };
    [first.into(), axis.cross(&first).into(), axis.into()]
}

fn body_of(on: Supported) -> Option<BodyId> {
    match on {
        Supported::Sun => Some(BodyId::Sun),
        Supported::Carrier => Some(BodyId::Carrier),
        Supported::BevelPinion => Some(BodyId::BevelPinion),
        Supported::BevelGear => Some(BodyId::BevelGear),
        Supported::Planet => None,
    }
}
