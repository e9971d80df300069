//! Whether supports may be eliminated: by the estimated error of the response ([`lpm::elimination_error`]) at the speeds of the analyses.

use lpm::{Excitation, GearPair, Supports};

use gearwright_case::LumpedPairCase;
use gearwright_case::lumped_pair::schema::Method;
use gearwright_results::lumped::Treatment;

use super::analyses::grid;
use crate::Refused;

/// Largest estimated error of a response with eliminated supports.
const MAX_ERROR: f64 = 0.01;
/// Speeds of a range at which the error is estimated.
const SPEEDS: usize = 200;

/// Mesh frequencies (Hz) of the analyses; ranges are thinned out.
fn frequencies(case: &LumpedPairCase) -> Vec<f64> {
    let analysis = &case.inputs.analysis;
    let mut all: Vec<f64> = case.time_frequency().filter(|_| analysis.time.is_some()).into_iter().collect();
    let mut range = |from: f64, to: f64| {
        let step = (to - from).max(f64::MIN_POSITIVE) / SPEEDS as f64;
        all.extend(grid(from, to, step).into_iter().take(SPEEDS + 1));
    };
    if let Some(time) = analysis.time.as_ref().and_then(|time| time.approach_from_hz) {
        range(time, time);
    }
    if let Some(sweep) = &analysis.sweep {
        range(sweep.from_hz, sweep.to_hz);
    }
    if let Some(branch) = &analysis.continuation {
        range(branch.from_hz, branch.to_hz);
    }
    if let Some(damage) = &analysis.damage {
        if let (Some(from), Some(to)) = (damage.from_hz, damage.to_hz) {
            range(from, to);
        }
        all.extend(&damage.mesh_frequencies_hz);
    }
    all
}

/// The treatment for a case: as written, or by default eliminated where the estimated error allows it, otherwise integrated.
///
/// # Errors
/// [`Refused`] where elimination is written and too wrong; pairs out of range.
pub fn treatment(case: &LumpedPairCase, pair: &GearPair, excitations: &[Excitation]) -> anyhow::Result<Treatment> {
    if case.supports == Some(Supports::Rigid) {
        return Ok(Treatment { supports: Supports::Rigid, elimination: None });
    }
    let frequencies = frequencies(case);
    let mut worst = (0.0, 0.0);
    for excitation in excitations {
        for &frequency in &frequencies {
            let error = lpm::elimination_error(pair, excitation, frequency)?;
            if error > worst.0 {
                worst = (error, frequency);
            }
        }
        if case.inputs.analysis.impulse.is_some() {
            let error = lpm::elimination_frequency_error(pair, excitation)?;
            if error > worst.0 {
                worst = (error, 0.0);
            }
        }
    }
    let elimination = Some(worst);
    // a method for one coordinate asks for it
    let one = case.inputs.analysis.method == Method::Exponential;
    match case.supports.or(one.then_some(Supports::Eliminated)) {
        Some(Supports::Eliminated) if worst.0 > MAX_ERROR => {
            let (error, place) = (100.0 * worst.0, Treatment::place(worst.1));
            Err(Refused(format!(
                "the supports cannot be eliminated: the estimated error of the response is {error:.1} % {place}; at most {:.0} % is allowed. \
                 Write pair.supports = \"integrated\", or leave it and the \"exponential\" method out",
                100.0 * MAX_ERROR
            ))
            .into())
        }
        Some(supports) => Ok(Treatment { supports, elimination }),
        None if worst.0 > MAX_ERROR => Ok(Treatment { supports: Supports::Integrated, elimination }),
        None => Ok(Treatment { supports: Supports::Eliminated, elimination }),
    }
}
