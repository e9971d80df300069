//! Notes on a dynamics case: keys without effect, physics, assumptions.

use fecm::FaceModel;
use fecm::dynamics::Support;

use super::resolve::DynamicsCase;
use super::schema::{Bearing, Integrator, Rotor};
use crate::document::Node;
use crate::notes::Notes;
use crate::physics::{self, NamedPair};
use crate::spur_pair::notes::PLANE;

/// Notes on a resolved case.
pub(super) fn notes(case: &DynamicsCase, document: &Node) -> Notes {
    let mut notes = Notes::default();
    let (inputs, statics) = (&case.inputs, &case.statics);
    notes.include("pair.spur_pair", &statics.notes);
    if case.torque != statics.inputs.load.torque_n_m {
        let load_key = "load.torque_n_m";
        notes.warnings.retain(|warning| !warning.place.key.ends_with(load_key));
        let scene = NamedPair {
            pair: &statics.pair,
            options: &statics.options,
            names: ["pinion", "gear"],
            load_key: "pair.torque_n_m",
            force: case.torque / statics.pair.wheel().base_radius(),
        };
        physics::overload(&scene, document, &mut notes);
    }
    let mut idle = |section: &str, keys: &[&str], because: &str| notes.without_effect(document, section, keys, because);
    let is_plane = !matches!(statics.options.face, FaceModel::Solid { .. });
    if is_plane {
        idle("numerics", &["face_cells"], PLANE);
    }
    if inputs.numerics.integrator == Integrator::Newmark {
        idle("numerics", &["spectral_radius"], "only \"generalized-alpha\" has it");
    }
    if inputs.run.transient_mesh_cycles.is_some() {
        idle(
            "run",
            &["steady_tolerance", "steady_limit_mesh_cycles"],
            "run.transient_mesh_cycles says how long the transient is",
        );
    }
    if case.speeds.is_empty() {
        let keys = [
            "steps_per_mesh_cycle",
            "mesh_cycle_from",
            "mesh_cycle_origin",
            "mesh_cycles",
            "start",
            "transient_mesh_cycles",
            "steady_tolerance",
            "steady_limit_mesh_cycles",
        ];
        let because = "only impulse tests are run; give run.speed_rpm or run.mesh_frequency_hz";
        idle("run", &keys, because);
        idle("output", &["film"], because);
    }
    let modes = [inputs.pinion.elastic_modes, inputs.gear.elastic_modes];
    if modes == [0, 0] {
        idle("damping", &["modal_ratio"], "no elastic modes are kept");
    }
    let rotors = [("pinion", &inputs.pinion), ("gear", &inputs.gear)];
    let springs = case.options.rotors.iter().flat_map(|rotor| rotor.supports);
    let sprung = springs.filter(|s| matches!(s, Support::Elastic { stiffness, .. } if *stiffness > 0.0)).count() > 0;
    if modes == [0, 0] && !sprung {
        idle("damping", &["stiffness_proportional_s"], "there are neither springs nor elastic modes");
    }
    for ((name, rotor), options) in rotors.into_iter().zip(&case.options.rotors) {
        let [x, y, z, tilt_x, tilt_y, rotation] = options.supports.map(|support| support != Support::Fixed);
        let has_modes = rotor.elastic_modes > 0;
        // mass and inertia also make the default of the transverse inertia
        let tilts = (tilt_x || tilt_y) && document.find(&format!("{name}.transverse_inertia_kg_m2")).is_none();
        if !(x || y || z || tilts) {
            idle(name, &["mass_kg"], "the gear's centre does not move: none of its bearing's stiffnesses is given");
        }
        if !(tilt_x || tilt_y) {
            idle(
                name,
                &["transverse_inertia_kg_m2"],
                "the gear does not tilt: no tilt stiffness of its bearing is given",
            );
        }
        if !rotation && !tilts {
            idle(name, &["inertia_kg_m2"], "its rotation is prescribed");
        }
        if !has_modes && is_plane {
            idle(&format!("{name}.bearing"), &Z_KEYS, "spur gears with plane teeth do not push along the axis");
        }
        if is_plane {
            idle(&format!("{name}.bearing"), &TILT_KEYS, "plane teeth resist no tilt");
        }
    }
    assume(case, &mut notes);
    notes
}

const Z_KEYS: [&str; 2] = ["z_stiffness_n_per_m", "z_damping_n_s_per_m"];
const TILT_KEYS: [&str; 4] = [
    "tilt_x_stiffness_n_m_per_rad",
    "tilt_y_stiffness_n_m_per_rad",
    "tilt_x_damping_n_m_s_per_rad",
    "tilt_y_damping_n_m_s_per_rad",
];

fn assume(case: &DynamicsCase, notes: &mut Notes) {
    let rotors = [("pinion", &case.inputs.pinion), ("gear", &case.inputs.gear)];
    let mut assume = |applies: fn(&Rotor) -> bool, text: &str| {
        let names: Vec<&str> = rotors.iter().filter(|(_, rotor)| applies(rotor)).map(|(name, _)| *name).collect();
        if !names.is_empty() {
            notes.assume(format!("{}: {text}", names.join(", ")));
        }
    };
    assume(|rotor| rotor.elastic_modes == 0, "a rigid body with teeth that deform as at rest (no elastic modes)");
    assume(|rotor| rotor.bearing == Bearing::default(), "on a rigid bearing");
}
