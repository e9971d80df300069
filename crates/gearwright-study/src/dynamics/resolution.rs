//! Steps of a mesh cycle: those of the case, or as many as the vibration of the pair on its mesh wants at a speed.
//!
//! What counts is steps in a natural period. Far below the natural frequency a mesh cycle holds many of them, and some harmonic of the mesh frequency always
//! meets it; a damaged tooth rings at it. So steps are measured by the error they leave there (see [`MeshVibration::resonance_error`]).

use anyhow::Context;
use fecm::dynamics::{Integrator, MeshVibration, PairDynamics};
use fecm::statics::PairModel;

use gearwright_case::DynamicsCase;
use gearwright_results::dynamics::Resolution;

/// Error that steps chosen leave at resonance, over the motion there.
pub const CHOSEN_ERROR: f64 = 0.025;
/// Error above which steps given are few.
pub const LARGE_ERROR: f64 = 0.1;
/// Steps chosen for a mesh cycle, at least and at most: so far below the natural frequency that more would be wanted, the harmonics that meet it are
/// small (docs/dynamics.md).
pub const CHOSEN_STEPS: [usize; 2] = [50, 400];
/// Steps chosen for a natural period, at least and at most, whatever its damping.
const NATURAL_STEPS: [f64; 2] = [30.0, 120.0];
/// Positions whose mean stiffness counts (mesh cycle).
const POSITIONS: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// The vibration of the healthy pair and the steps at every speed of a case; `None` for a case without speeds.
///
/// # Errors
/// Those of the engine: no position with a static equilibrium, options out of range.
pub fn resolutions(
    case: &DynamicsCase,
    healthy: &PairModel,
) -> anyhow::Result<Option<(MeshVibration, Vec<Resolution>)>> {
    if case.speeds.is_empty() {
        return Ok(None);
    }
    let dynamics = PairDynamics::new(healthy, &case.options)?;
    let vibration =
        dynamics.mesh_vibration(&POSITIONS, case.torque).context("the natural frequency cannot be estimated")?;
    let integrator = case.options.integrator;
    let teeth = f64::from(case.statics.pair.pinion().teeth());
    let at = |&speed: &f64| {
        let cycle = 2.0 * std::f64::consts::PI / (teeth * speed);
        resolution(&vibration, integrator, cycle, case.steps)
    };
    Ok(Some((vibration, case.speeds.iter().map(at).collect())))
}

/// For a mesh cycle of this length (s).
fn resolution(vibration: &MeshVibration, integrator: Integrator, cycle: f64, given: Option<usize>) -> Resolution {
    let period = 1.0 / vibration.frequency;
    let [least, most] = NATURAL_STEPS.map(|steps| period / steps);
    let step = vibration.time_step(integrator, CHOSEN_ERROR).clamp(most, least);
    // whole tens; what is out of range of a count is out of range of those chosen
    let wanted = ((cycle / step / 10.0).ceil() * 10.0) as usize;
    let enough = wanted.clamp(CHOSEN_STEPS[0], CHOSEN_STEPS[1]);
    let steps = given.unwrap_or(enough);
    let step = cycle / steps as f64;
    Resolution {
        steps,
        given: given.is_some(),
        natural_steps: period / step,
        error: vibration.resonance_error(integrator, step),
        enough,
    }
}

/// Whether there are so few steps that the summary says what to write instead.
#[must_use]
pub fn is_coarse(resolution: &Resolution) -> bool {
    resolution.given && resolution.steps < resolution.enough && resolution.error > LARGE_ERROR
}

fn says(resolution: &Resolution, vibration: &MeshVibration) -> String {
    let error = match resolution.error {
        error if error < 1.0 => format!("leave up to {:.1} % at resonance", 100.0 * error),
        error if error.is_finite() => "nothing is right at resonance".to_owned(),
        _ => "without damping, no bound at resonance".to_owned(),
    };
    let mut text = format!(
        "{} {}: {:.0} in the natural period ({:.0} Hz, damping ratio {:.3}), {error}",
        resolution.steps,
        if resolution.given { "given" } else { "chosen" },
        resolution.natural_steps,
        vibration.frequency,
        vibration.damping_ratio
    );
    if is_coarse(resolution) {
        text += &format!("; few: write steps_per_mesh_cycle = {}, or leave it out", resolution.enough);
    } else if !resolution.given && resolution.steps == CHOSEN_STEPS[1] {
        text += &format!("; {} are the most that are chosen", resolution.steps);
    }
    text
}

/// In a line: the steps, those of the speed with the largest error in full.
#[must_use]
pub fn told(vibration: &MeshVibration, all: &[Resolution]) -> String {
    let Some(worst) = all.iter().max_by(|a, b| a.error.total_cmp(&b.error)) else { return String::new() };
    let says = says(worst, vibration);
    let steps = || all.iter().map(|r| r.steps);
    match (steps().min(), steps().max()) {
        (Some(least), Some(most)) if least < most => format!("{least} to {most}; {says}"),
        _ => says,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIBRATION: MeshVibration = MeshVibration { frequency: 2700.0, damping_ratio: 0.04, mesh_stiffness: 7e8 };

    fn at(mesh_frequency: f64, given: Option<usize>) -> Resolution {
        resolution(&VIBRATION, Integrator::AverageAcceleration, 1.0 / mesh_frequency, given)
    }

    #[test]
    fn steps_chosen_leave_the_error_promised() {
        for frequency in [450.0, 900.0, 1350.0, 1800.0] {
            let chosen = at(frequency, None);
            assert!(chosen.error <= CHOSEN_ERROR && !chosen.given && !is_coarse(&chosen), "{chosen:?}");
            // not many more than are wanted
            assert!(chosen.error > 0.8 * CHOSEN_ERROR, "{chosen:?}");
        }
        // above the natural frequency and far below it
        assert_eq!([at(5000.0, None).steps, at(10.0, None).steps], CHOSEN_STEPS);
        assert!(says(&at(10.0, None), &VIBRATION).contains("the most that are chosen"));
    }

    #[test]
    fn steps_given_are_taken_and_few_are_told() {
        let few = at(900.0, Some(50));
        assert!(few.steps == 50 && is_coarse(&few) && few.enough > 150, "{few:?}");
        assert!(says(&few, &VIBRATION).contains(&format!("write steps_per_mesh_cycle = {}", few.enough)));
        assert!(!is_coarse(&at(1800.0, Some(50))));
        let none = MeshVibration { damping_ratio: 0.0, ..VIBRATION };
        let undamped = resolution(&none, Integrator::AverageAcceleration, 1.0 / 1800.0, None);
        assert!(undamped.steps == 180 && undamped.error.is_infinite(), "{undamped:?}");
    }
}
