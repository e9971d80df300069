//! Lumped-parameter dynamics: curves found or read, every analysis asked for.

mod analyses;
mod states;
mod supports;

use std::time::Instant;

use gearwright_case::LumpedPairCase;
use gearwright_results::lumped::{Lumped, summary::Times};

use super::RunObserver;

/// Computes a lumped-pair case.
///
/// # Errors
/// Model errors; cancellation.
pub fn compute(case: &LumpedPairCase, observer: &dyn RunObserver) -> anyhow::Result<Lumped> {
    let clock = Instant::now();
    let (states, treatment) = states::build(case, observer)?;
    let mut times = Times { curves: clock.elapsed().as_secs_f64(), ..Times::default() };
    let findings = analyses::run(case, &states, observer, &mut times)?;
    Ok(Lumped { states, treatment, findings, times })
}
