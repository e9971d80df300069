//! What time steps and transient leave in the records, measured.
//!
//! *Steps*: the healthy transmission over a short stretch from equilibrium, once with the steps of the case and once with steps half as long. *Transient*: its first planet pass again,
//! from an equilibrium one planet pass later; both transients are in the difference, the shorter one dominates. Both are root mean squares of the difference over that of the variation, in the band
//! of the records.

use anyhow::Context;
use fecm::statics::Observer;
use gearwright_case::TransmissionCase;
use gearwright_results::transmission::Resolution;
use planetary::engine::{RunRequest, Transmission, TransmissionRun};

/// Mesh cycles over which steps are compared.
const COMPARED_CYCLES: usize = 12;

/// Measures both; `request` and `recorded` are those of the healthy state.
///
/// # Errors
/// Motion out of the range of numbers.
pub fn measure(
    case: &TransmissionCase,
    healthy: &Transmission,
    request: &RunRequest,
    recorded: &TransmissionRun,
    observer: &dyn Observer,
) -> anyhow::Result<Resolution> {
    let sampling = &case.sampling;
    let pass = case.inputs.ring.teeth as usize * sampling.steps_per_cycle() / case.train.planets();
    let failed = "the run that measures what steps and transient leave";
    let mut found = Resolution::default();
    if case.inputs.run.settling_planet_passes > 0 && request.settle_steps > pass {
        // one planet pass later
        let settle_steps = request.settle_steps - pass;
        let samples = (pass / sampling.steps_per_sample).min(recorded.len());
        let travelled = -(settle_steps as f64) / sampling.steps_per_cycle() as f64;
        let later = RunRequest { travelled, settle_steps, samples, ..request.clone() };
        found.transient = healthy.run(&later, observer).context(failed)?.deviation(recorded, samples);
    }
    let Some(band) = request.band else { return Ok(found) };
    let lead = band.lead_steps(healthy.time_step(&request.turning));
    let samples = COMPARED_CYCLES * sampling.samples_per_cycle;
    let coarse = RunRequest { settle_steps: lead, samples, ..request.clone() };
    let fine = coarse.halved(lead);
    let [coarse, fine] = [coarse, fine].map(|request| healthy.run(&request, observer).context(failed));
    found.steps = coarse?.deviation(&fine?, samples);
    Ok(found)
}
