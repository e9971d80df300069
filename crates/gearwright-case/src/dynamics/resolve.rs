//! From keys to model options, bodies and speeds in SI units; faults told at their keys.

use std::path::Path;

use fecm::dynamics::{
    Damping, DynamicsOptions, InitialState, Integrator, RotorInertia, RotorOptions, StepSolver, Support,
};

use super::notes::notes;
use super::schema::{self, Dynamics, Input, Rotor, Solver, Start};
use crate::SpurPairCase;
use crate::document::Node;
use crate::fault::Fault;
use crate::notes::Notes;
use crate::spur_pair::damage::Severity;
use crate::spur_pair::schema::Values;

/// Steps of a run, at most.
const MOST_STEPS: f64 = 1e8;
/// Speeds of a case, at most.
const MOST_SPEEDS: usize = 1000;

/// A dynamics case, ready to run.
#[derive(Debug, Clone)]
pub struct DynamicsCase {
    /// The case with every default filled in.
    pub inputs: Dynamics,
    /// The spur-pair case it rests on, with the contact numerics of this one.
    pub statics: Box<SpurPairCase>,
    /// Damaged pairs to run after the healthy one, each with its number in the spur-pair case, counted from 1.
    pub severities: Vec<(usize, Severity)>,
    /// Options of the engine.
    pub options: DynamicsOptions,
    /// Mean speeds of the pinion (rad/s); none for impulse tests alone.
    pub speeds: Vec<f64>,
    /// Torque on the gear (N m).
    pub torque: f64,
    /// How runs start.
    pub initial: InitialState,
    /// Steps of a mesh cycle, where given.
    pub steps: Option<usize>,
    /// Mesh cycle at which the record begins, counted from the pitch point.
    pub from: f64,
    /// Added to mesh cycles counted from the pitch point.
    pub origin: f64,
    /// Mesh cycles recorded.
    pub cycles: usize,
    /// Warnings and assumptions.
    pub notes: Notes,
}

/// Resolves a case; `folder` is where files it refers to are looked for.
///
/// # Errors
/// All faults that can be told together.
pub fn resolve(mut inputs: Dynamics, document: &Node, folder: &Path) -> Result<DynamicsCase, Vec<Fault>> {
    let mut faults = Vec::new();
    let file = folder.join(&inputs.pair.spur_pair);
    let statics = crate::load_spur_pair(&file)
        .map_err(|found| faults.push(document.fault("pair.spur_pair", format!("its file has faults:\n{found}"))));
    let mut fault = |key: &str, message: String| faults.push(document.fault(key, message));
    let pinion_rotation = input_support(&inputs, &mut fault);
    dampers_have_springs("pinion", &inputs.pinion, &mut fault);
    dampers_have_springs("gear", &inputs.gear, &mut fault);
    let Ok(mut statics) = statics else { return Err(faults) };
    statics.options.contact.cells_per_half_width = inputs.numerics.cells_per_half_width;
    statics.options.contact.face_cells = inputs.numerics.face_cells as usize;
    let severities = chosen(&inputs, &statics, &mut fault);
    fill_defaults(&mut inputs, &statics, &severities);
    let speeds = speeds(&inputs, &statics, &mut fault);
    let cycles = inputs.run.mesh_cycles.unwrap_or_default();
    // those not given yet are not many more
    let steps = f64::from(inputs.run.steps_per_mesh_cycle.unwrap_or(50));
    for (key, cycles) in [
        ("mesh_cycles", cycles),
        ("transient_mesh_cycles", inputs.run.transient_mesh_cycles.unwrap_or_default()),
        ("steady_limit_mesh_cycles", inputs.run.steady_limit_mesh_cycles),
    ] {
        let all = steps * f64::from(cycles);
        if all > MOST_STEPS {
            fault(&format!("run.{key}"), format!("makes {all:e} steps; at most {MOST_STEPS:e}"));
        }
    }
    if let Some(impulse) = &inputs.impulse
        && (impulse.mesh_cycles.is_empty() || impulse.mesh_cycles.iter().any(|cycle| !(cycle.abs() <= 1e5)))
    {
        fault("impulse.mesh_cycles", "must hold at least one mesh cycle, each from -100000 to 100000".into());
    }
    let from = inputs.run.mesh_cycle_from;
    if let Some(film) = inputs.output.film {
        let to = from + f64::from(cycles);
        for (key, value) in [("mesh_cycle_from", film.mesh_cycle_from), ("mesh_cycle_to", film.mesh_cycle_to)] {
            if !(from..=to).contains(&value) {
                fault(&format!("output.film.{key}"), format!("must lie within the record, mesh cycle {from} to {to}"));
            }
        }
        if !(film.mesh_cycle_to > film.mesh_cycle_from) {
            fault("output.film.mesh_cycle_to", format!("must be above mesh_cycle_from = {}", film.mesh_cycle_from));
        }
    }
    let options = options(&inputs, pinion_rotation);
    if let Err(error) = options.validate() {
        fault("pair", error.to_string());
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let origin = inputs.run.mesh_cycle_origin.unwrap_or_default();
    let mut case = DynamicsCase {
        torque: inputs.pair.torque_n_m.unwrap_or_default(),
        initial: match inputs.run.start {
            Start::Equilibrium => InitialState::Equilibrium,
            Start::Unloaded => InitialState::Unloaded,
        },
        steps: inputs.run.steps_per_mesh_cycle.map(|steps| steps as usize),
        from: from - origin,
        origin,
        cycles: cycles as usize,
        inputs,
        statics: Box::new(statics),
        severities,
        options,
        speeds,
        notes: Notes::default(),
    };
    case.notes = notes(&case, document);
    Ok(case)
}

/// How the pinion's rotation is held.
fn input_support(inputs: &Dynamics, fault: &mut impl FnMut(&str, String)) -> Support {
    let pair = &inputs.pair;
    let shaft = [
        ("pair.shaft_stiffness_n_m_per_rad", pair.shaft_stiffness_n_m_per_rad),
        ("pair.shaft_damping_n_m_s_per_rad", pair.shaft_damping_n_m_s_per_rad),
    ];
    if pair.input != Input::Shaft {
        for (key, _) in shaft.iter().filter(|(_, value)| value.is_some()) {
            fault(key, "must be left out unless pair.input is \"shaft\"".into());
        }
    }
    match (pair.input, pair.shaft_stiffness_n_m_per_rad) {
        (Input::Prescribed, _) => Support::Fixed,
        (Input::Free, _) => Support::Free,
        (Input::Shaft, Some(stiffness)) => {
            Support::Elastic { stiffness, damping: pair.shaft_damping_n_m_s_per_rad.unwrap_or_default() }
        }
        (Input::Shaft, None) => {
            fault(shaft[0].0, "this key is required with input \"shaft\"".into());
            Support::Free
        }
    }
}

/// Refuses dampers of coordinates that do not move.
fn dampers_have_springs(name: &str, rotor: &Rotor, fault: &mut impl FnMut(&str, String)) {
    let b = &rotor.bearing;
    for (key, damping, stiffness) in [
        ("x_damping_n_s_per_m", b.x_damping_n_s_per_m, b.x_stiffness_n_per_m),
        ("y_damping_n_s_per_m", b.y_damping_n_s_per_m, b.y_stiffness_n_per_m),
        ("z_damping_n_s_per_m", b.z_damping_n_s_per_m, b.z_stiffness_n_per_m),
        ("tilt_x_damping_n_m_s_per_rad", b.tilt_x_damping_n_m_s_per_rad, b.tilt_x_stiffness_n_m_per_rad),
        ("tilt_y_damping_n_m_s_per_rad", b.tilt_y_damping_n_m_s_per_rad, b.tilt_y_stiffness_n_m_per_rad),
    ] {
        if damping > 0.0 && stiffness.is_none() {
            let message = "damps nothing: without a stiffness this coordinate is fixed; stiffness 0 makes it free";
            fault(&format!("{name}.bearing.{key}"), message.into());
        }
    }
}

/// The severities asked for, with their numbers.
fn chosen(inputs: &Dynamics, statics: &SpurPairCase, fault: &mut impl FnMut(&str, String)) -> Vec<(usize, Severity)> {
    let count = statics.severities.len();
    let all: Vec<u32> = (1..=count as u32).collect();
    let wanted = inputs.pair.severities.as_ref().unwrap_or(&all);
    let mut found = Vec::new();
    for &number in wanted {
        let severity = (number as usize).checked_sub(1).and_then(|k| statics.severities.get(k));
        match severity {
            Some(_) if found.iter().any(|(n, _)| *n == number as usize) => {
                fault("pair.severities", format!("names {number} twice"));
            }
            Some(severity) => found.push((number as usize, severity.clone())),
            None if count == 0 => fault("pair.severities", "the spur-pair case has no damage".into()),
            None => fault("pair.severities", format!("the spur-pair case has severities 1 to {count}, not {number}")),
        }
    }
    found
}

/// What was left out and follows from the spur-pair case.
fn fill_defaults(inputs: &mut Dynamics, statics: &SpurPairCase, severities: &[(usize, Severity)]) {
    let density = statics.inputs.material.density_kg_per_m3;
    let gears = [statics.pair.pinion(), statics.pair.wheel()];
    for (rotor, gear) in [&mut inputs.pinion, &mut inputs.gear].into_iter().zip(gears) {
        let solid = gear.inertia(density);
        let mass = *rotor.mass_kg.get_or_insert(solid.mass);
        let inertia = *rotor.inertia_kg_m2.get_or_insert(solid.polar);
        rotor.transverse_inertia_kg_m2.get_or_insert(0.5 * inertia + mass * gear.facewidth().powi(2) / 12.0);
    }
    inputs.pair.torque_n_m.get_or_insert(statics.inputs.load.torque_n_m);
    inputs.pair.severities.get_or_insert_with(|| severities.iter().map(|(number, _)| *number as u32).collect());
    inputs.run.mesh_cycle_origin.get_or_insert(statics.inputs.analysis.mesh_cycle_origin);
    let damaged = |member: usize| severities.iter().any(|(_, severity)| !severity.damage[member].is_empty());
    let member = usize::from(damaged(1) && !damaged(0));
    inputs.run.mesh_cycles.get_or_insert(gears[member].teeth());
}

/// Mean speeds of the pinion (rad/s).
fn speeds(inputs: &Dynamics, statics: &SpurPairCase, fault: &mut impl FnMut(&str, String)) -> Vec<f64> {
    let run = &inputs.run;
    let turn = 2.0 * std::f64::consts::PI;
    let (key, values, unit) = match (&run.speed_rpm, &run.mesh_frequency_hz) {
        (Some(values), None) => ("run.speed_rpm", values, turn / 60.0),
        (None, Some(values)) => ("run.mesh_frequency_hz", values, turn / f64::from(statics.pair.pinion().teeth())),
        (None, None) if inputs.impulse.is_some() => return Vec::new(),
        (None, None) => {
            fault("run.speed_rpm", "this key is required, or mesh_frequency_hz, or a section [impulse]".into());
            return Vec::new();
        }
        (Some(_), Some(_)) => {
            fault("run.mesh_frequency_hz", "give either speed_rpm or mesh_frequency_hz, not both".into());
            return Vec::new();
        }
    };
    let list = match values {
        Values::One(value) => vec![*value],
        Values::Each(list) => list.clone(),
    };
    if list.is_empty() || list.len() > MOST_SPEEDS {
        fault(key, format!("must hold 1 to {MOST_SPEEDS} speeds"));
    }
    if let Some(bad) = list.iter().find(|value| !(1e-3..=1e7).contains(*value)) {
        fault(key, format!("must be 0.001 to 1e7; {bad} is not"));
    }
    list.iter().map(|value| value * unit).collect()
}

fn options(inputs: &Dynamics, pinion_rotation: Support) -> DynamicsOptions {
    let numerics = &inputs.numerics;
    DynamicsOptions {
        rotors: [rotor(&inputs.pinion, pinion_rotation), rotor(&inputs.gear, Support::Free)],
        damping: Damping {
            mass_proportional: inputs.damping.mass_proportional_per_s,
            stiffness_proportional: inputs.damping.stiffness_proportional_s,
            modal_ratio: inputs.damping.modal_ratio,
        },
        integrator: match numerics.integrator {
            schema::Integrator::Newmark => Integrator::AverageAcceleration,
            schema::Integrator::GeneralizedAlpha => {
                Integrator::GeneralizedAlpha { spectral_radius: numerics.spectral_radius }
            }
        },
        solver: match numerics.solver {
            Solver::Newton => StepSolver::Newton,
            Solver::Lemke => StepSolver::Lemke,
        },
        operator_memory: numerics.memory_mb as usize * 1_000_000,
    }
}

fn rotor(written: &Rotor, rotation: Support) -> RotorOptions {
    let b = &written.bearing;
    let held = |stiffness: Option<f64>, damping: f64| match stiffness {
        None => Support::Fixed,
        Some(stiffness) => Support::Elastic { stiffness, damping },
    };
    let supports = [
        held(b.x_stiffness_n_per_m, b.x_damping_n_s_per_m),
        held(b.y_stiffness_n_per_m, b.y_damping_n_s_per_m),
        held(b.z_stiffness_n_per_m, b.z_damping_n_s_per_m),
        held(b.tilt_x_stiffness_n_m_per_rad, b.tilt_x_damping_n_m_s_per_rad),
        held(b.tilt_y_stiffness_n_m_per_rad, b.tilt_y_damping_n_m_s_per_rad),
        rotation,
    ];
    RotorOptions {
        inertia: RotorInertia {
            mass: written.mass_kg.unwrap_or_default(),
            polar: written.inertia_kg_m2.unwrap_or_default(),
            transverse: written.transverse_inertia_kg_m2.unwrap_or_default(),
        },
        supports,
        modes: written.elastic_modes as usize,
    }
}
