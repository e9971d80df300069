//! Vibration of a planetary transmission: mesh tables, housing, every state from equilibrium over its transient to the record, signals judged.

pub mod cache;
mod housing;
mod laws;
mod model;
mod resolution;
mod signals;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use anyhow::{Context, bail};
use fecm::statics::Observer;
use gear_geom::TrainTooth;
use gearwright_case::TransmissionCase;
use gearwright_case::lumped_pair::resolve::HEALTHY;
use gearwright_results::transmission::summary::Times;
use gearwright_results::transmission::{Findings, Resolution, Sensor};
use planetary::elastic::ElasticBody;
use planetary::engine::{Band, Load, NaturalMode, RunRequest, STAGES, Start, Transmission, TransmissionRun, Turning};
use planetary::stage::mean_stiffness;
use rayon::prelude::*;

use super::{AsObserver, RunObserver};
use cache::Cache;
use laws::laws;
use model::Laws;
use signals::{Judge, periods};

/// Natural frequencies told (Hz), at most.
const HIGHEST_MODE: f64 = 12e3;

/// Computes all states of a case and judges their signals.
///
/// # Errors
/// Model errors; cancellation. Tables made so far stay in the cache.
pub fn compute(case: &TransmissionCase, cache: &Cache, observer: &dyn RunObserver) -> anyhow::Result<Findings> {
    let mut times = Times::default();
    let clock = Instant::now();
    let laws = laws(case, cache, observer)?;
    times.contact = clock.elapsed().as_secs_f64();
    stopped(observer)?;
    let clock = Instant::now();
    let housing = case.housing.as_ref().map(|plan| housing::reduced(plan, cache, observer)).transpose()?;
    times.housing = clock.elapsed().as_secs_f64();
    stopped(observer)?;

    let names = std::iter::once(HEALTHY.to_owned()).chain(case.severities.iter().map(|s| s.label.clone()));
    let states = names.zip(&laws).map(|(name, laws)| {
        let spec = model::spec(case, laws, housing.clone())?;
        let ready =
            Transmission::new(&spec).with_context(|| format!("the transmission cannot be put together ({name})"))?;
        Ok((name, ready))
    });
    let states: Vec<(String, Transmission)> = states.collect::<anyhow::Result<_>>()?;

    observer.stage("natural frequencies");
    let clock = Instant::now();
    let (modes, parts) = modes(case, &states[0].1)?;
    times.modes = clock.elapsed().as_secs_f64();

    observer.stage("vibration of all states (steps)");
    let clock = Instant::now();
    let runs = runs(case, &states, observer)?;
    observer.stage("what steps and transient leave");
    let resolution = resolution::measure(case, &states[0].1, &request(case), &runs[0].1, &AsObserver(observer))?;
    times.vibration = clock.elapsed().as_secs_f64();
    stopped(observer)?;

    observer.stage("signals and indicators");
    let clock = Instant::now();
    let mut findings = findings(case, &laws[0], runs, modes, parts, housing.as_ref(), resolution)?;
    times.signals = clock.elapsed().as_secs_f64();
    findings.times = times;
    Ok(findings)
}

fn stopped(observer: &dyn RunObserver) -> anyhow::Result<()> {
    if observer.is_cancelled() {
        bail!("stopped; tables made so far are kept for the next run");
    }
    Ok(())
}

/// Modes of the healthy transmission where the record begins, and the names of its parts.
fn modes(case: &TransmissionCase, healthy: &Transmission) -> anyhow::Result<(Vec<NaturalMode>, Vec<String>)> {
    let load = Load { travelled: 0.0, output_torque: case.inputs.run.torque_n_m, carrier_speed: case.speeds.carrier };
    let mut modes = healthy.natural_modes(&load).context("natural frequencies")?;
    modes.retain(|mode| mode.frequency <= HIGHEST_MODE);
    let bodies = healthy.bodies().iter().map(ToString::to_string);
    Ok((modes, bodies.chain(["housing".to_owned()]).collect()))
}

/// Progress of runs side by side.
struct Together<'a> {
    observer: &'a dyn RunObserver,
    done: AtomicUsize,
    total: usize,
}

impl Observer for Together<'_> {
    fn advanced(&self, _: usize, _: usize) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        // a terminal need not hear of every step
        if done % 64 == 0 {
            self.observer.advanced(done, self.total);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.observer.is_cancelled()
    }
}

/// All states over transient and record, side by side.
fn runs(
    case: &TransmissionCase,
    states: &[(String, Transmission)],
    observer: &dyn RunObserver,
) -> anyhow::Result<Vec<(String, TransmissionRun)>> {
    let request = request(case);
    let total = states.len() * (request.settle_steps + request.samples * case.sampling.steps_per_sample);
    let together = Together { observer, done: AtomicUsize::new(0), total };
    let runs: Vec<anyhow::Result<_>> = states
        .par_iter()
        .map(|(name, state)| {
            let run = state.run(&request, &together).with_context(|| format!("the run of the state \"{name}\""))?;
            Ok((name.clone(), run))
        })
        .collect();
    runs.into_iter().collect()
}

/// The record begins with the first planet at its angle of the start, so the transient is run before: some planet passes, at least what the filter of the band reaches back.
fn request(case: &TransmissionCase) -> RunRequest {
    let (run, sampling) = (&case.inputs.run, &case.sampling);
    let steps = sampling.steps_per_cycle();
    let band = Band { frequency: sampling.band, steps_per_sample: sampling.steps_per_sample };
    let lead = band.lead_steps(1.0 / (case.speeds.mesh_frequency * steps as f64));
    let turn = case.inputs.ring.teeth as usize * steps;
    let settle_steps = (run.settling_planet_passes as usize * turn / case.train.planets()).max(lead);
    RunRequest {
        turning: Turning::Steady { carrier_speed: case.speeds.carrier, steps_per_cycle: steps },
        output_torque: run.torque_n_m,
        travelled: -(settle_steps as f64) / steps as f64,
        start: Start::Equilibrium,
        settle_steps,
        samples: run.carrier_turns as usize * case.inputs.ring.teeth as usize * sampling.samples_per_cycle,
        band: Some(band),
        record_motion: false,
        stages: STAGES,
    }
}

fn findings(
    case: &TransmissionCase,
    healthy: &Laws,
    runs: Vec<(String, TransmissionRun)>,
    modes: Vec<NaturalMode>,
    parts: Vec<String>,
    housing: Option<&ElasticBody>,
    resolution: Resolution,
) -> anyhow::Result<Findings> {
    let (ring, samples) = (case.inputs.ring.teeth, case.sampling.samples_per_cycle);
    let periods = periods(ring, case.train.planets(), case.equally_spaced, samples);
    let judge = Judge::new(&periods, case.inputs.signals.sideband_pairs as usize)?;
    let turn = ring as usize * samples;
    // with everything on the sun's shaft alike the ring sees a planet pass repeat, otherwise all must return
    let on_ring = |tooth: &TrainTooth| matches!(tooth, TrainTooth::Ring(_));
    let [sun_errors, planet_errors, _] = &case.tooth_errors;
    let alike = case.bevel.is_none()
        && sun_errors.is_empty()
        && case.pin_errors.is_empty()
        && case.severities.iter().flat_map(|s| &s.damage).all(|(t, _)| on_ring(t));
    let repeats = match periods.first() {
        _ if !planet_errors.is_empty() => turn.saturating_mul(case.train.hunting_period() as usize),
        Some(period) if alike => period.samples,
        _ => turn * case.train.sun_ring_period() as usize,
    };
    let states = signals::states(runs, &judge, repeats).context("the signals cannot be judged")?;
    let sensors = case.sensors.iter().enumerate().map(|(index, place)| Sensor {
        name: place.name.clone(),
        angle_deg: place.angle.to_degrees().rem_euclid(360.0),
        named: index < case.named_sensors,
    });
    let force = case.mean_force();
    let coordinates = housing.iter().flat_map(|body| body.frequencies.iter().zip(&body.damping_ratios));
    Ok(Findings {
        sensors: sensors.collect(),
        periods,
        samples_per_turn: turn,
        mesh_frequency: case.speeds.mesh_frequency,
        states,
        modes,
        parts,
        housing: coordinates.map(|(omega, zeta)| (omega / std::f64::consts::TAU, *zeta)).collect(),
        mean_force: force,
        mean_stiffness: [&healthy.stage.sun, &healthy.stage.ring]
            .map(|laws| laws.first().map(|law| mean_stiffness(law.as_ref(), force))),
        resolution,
        times: Times::default(),
    })
}
