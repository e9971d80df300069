//! Vibration of a planetary transmission: mesh tables, housing, every state from equilibrium over its transient to the record, signals judged,
//! everything written.

pub mod cache;
pub mod findings;
pub mod housing;
pub mod laws;
pub mod model;
pub mod signals;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use anyhow::{Context, anyhow, bail};
use fecm::statics::Observer;
use gear_geom::TrainTooth;
use planetary::elastic::ElasticBody;
use planetary::engine::{Load, NaturalMode, RunRequest, Start, Transmission, TransmissionRun, Turning};
use rayon::prelude::*;

use crate::output::folder::ResultsFolder;
use crate::output::{transmission_summary as summary, transmission_tables as tables};
use crate::plot::transmission as figures;
use gearwright_case::TransmissionCase;
use gearwright_case::lumped_pair::resolve::HEALTHY;

use super::{Finished, RunObserver};
use cache::Cache;
use findings::{Findings, Sensor, State};
use laws::laws;
use model::Laws;
use signals::{Judge, periods};

/// Natural frequencies told (Hz), at most.
const HIGHEST_MODE: f64 = 12e3;

/// A case, computed.
#[derive(Debug)]
pub struct Computed {
    /// Laws of the meshes of the healthy state, then of every severity.
    pub laws: Vec<Laws>,
    /// What the runs show.
    pub findings: Findings,
    /// What it took.
    pub times: summary::Times,
}

/// Runs a transmission case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then; tables made so far stay in the cache.
pub fn run(case: &TransmissionCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let Computed { laws, findings, mut times } =
        compute(case, &Cache::beside(target, case.inputs.output.cache), observer)?;
    observer.stage("writing results");
    let clock = Instant::now();
    write(case, &folder, &findings)?;
    if case.inputs.output.plots {
        let file = |name: &str| folder.file(name);
        for (name, figure) in figures::all(&case.inputs.title, &findings) {
            figure.save(&file, &name).map_err(|e| anyhow!("plot {name}: {e}"))?;
        }
    }
    times.output = clock.elapsed().as_secs_f64();
    let whole = summary::summary(case, &laws[0], &findings, times);
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    stopped(observer)?;
    let screen = summary::screen(case, &findings, &times);
    Ok(Finished { folder: folder.publish()?, screen, unusable: 0 })
}

/// Computes all states of a case and judges their signals.
///
/// # Errors
/// Model errors; cancellation. Tables made so far stay in the cache.
pub fn compute(case: &TransmissionCase, cache: &Cache, observer: &dyn RunObserver) -> anyhow::Result<Computed> {
    let mut times = summary::Times::default();
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
    times.vibration = clock.elapsed().as_secs_f64();
    stopped(observer)?;

    observer.stage("signals and indicators");
    let clock = Instant::now();
    let findings = findings(case, runs, modes, parts, housing.as_ref())?;
    times.signals = clock.elapsed().as_secs_f64();
    Ok(Computed { laws, findings, times })
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
    let total = states.len() * (request.settle_steps + request.record_steps);
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

/// The record begins with the first planet at its angle of the start, so the transient is run before.
fn request(case: &TransmissionCase) -> RunRequest {
    let run = &case.inputs.run;
    let steps = run.steps_per_mesh_cycle as usize;
    let turn = case.inputs.ring.teeth as usize * steps;
    let settle_steps = run.settling_planet_passes as usize * turn / case.train.planets();
    RunRequest {
        turning: Turning::Steady { carrier_speed: case.speeds.carrier, steps_per_cycle: steps },
        output_torque: run.torque_n_m,
        // the first step recorded is the one after
        travelled: -((settle_steps + 1) as f64) / steps as f64,
        start: Start::Equilibrium,
        settle_steps,
        record_steps: run.carrier_turns as usize * turn,
        record_motion: false,
        integrator: case.integrator,
    }
}

fn findings(
    case: &TransmissionCase,
    runs: Vec<(String, TransmissionRun)>,
    modes: Vec<NaturalMode>,
    parts: Vec<String>,
    housing: Option<&ElasticBody>,
) -> anyhow::Result<Findings> {
    let (ring, steps) = (case.inputs.ring.teeth, case.inputs.run.steps_per_mesh_cycle as usize);
    let periods = periods(ring, case.train.planets(), case.equally_spaced, steps);
    let judge = Judge::new(&periods, case.inputs.signals.sideband_pairs as usize)?;
    let turn = ring as usize * steps;
    // with everything on the sun's shaft alike the ring sees a planet pass repeat, otherwise all must return
    let on_ring = |tooth: &TrainTooth| matches!(tooth, TrainTooth::Ring(_));
    let alike = case.bevel.is_none() && case.severities.iter().flat_map(|s| &s.damage).all(|(t, _)| on_ring(t));
    let repeats = match periods.first() {
        Some(period) if alike => period.samples,
        _ => turn * case.train.sun_ring_period() as usize,
    };
    let states = findings::states(runs, &judge, repeats).context("the signals cannot be judged")?;
    let sensors = case.sensors.iter().enumerate().map(|(index, place)| Sensor {
        name: place.name.clone(),
        angle_deg: place.angle.to_degrees().rem_euclid(360.0),
        named: index < case.named_sensors,
    });
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
    })
}

fn write(case: &TransmissionCase, folder: &ResultsFolder, findings: &Findings) -> anyhow::Result<()> {
    let sensors: Vec<(usize, &Sensor)> = findings.shown(case.inputs.output.around_signals).collect();
    for state in &findings.states {
        write_state(folder, findings, state, &sensors)?;
    }
    tables::load_sharing(&folder.file("load_sharing.csv"), findings)?;
    tables::bearings(&folder.file("bearings.csv"), findings)?;
    tables::natural_frequencies(&folder.file("natural_frequencies.csv"), findings)?;
    if !findings.housing.is_empty() {
        tables::housing_frequencies(&folder.file("housing_frequencies.csv"), findings)?;
    }
    if !findings.sensors.is_empty() {
        tables::indicators(&folder.file("indicators.csv"), findings)?;
    }
    Ok(())
}

fn write_state(
    folder: &ResultsFolder,
    findings: &Findings,
    state: &State,
    sensors: &[(usize, &Sensor)],
) -> anyhow::Result<()> {
    let suffix = state.suffix();
    let file = |name: &str| folder.file(&format!("{name}{suffix}.csv"));
    let (time_step, mesh_frequency) = (state.run.time_step, findings.mesh_frequency);
    tables::meshes(&file("meshes"), findings, state)?;
    if sensors.is_empty() {
        return Ok(());
    }
    tables::acceleration(&file("acceleration"), findings, state, sensors)?;
    let signals: Vec<(String, &[f64])> =
        sensors.iter().map(|(k, sensor)| (sensor.name.clone(), state.signals[*k].as_slice())).collect();
    tables::spectra(&file("spectrum"), time_step, mesh_frequency, &signals)?;
    let exact = |k: usize| state.judged[k].exact.as_deref();
    let differences: Vec<(String, &[f64])> =
        sensors.iter().filter_map(|(k, sensor)| Some((sensor.name.clone(), exact(*k)?))).collect();
    if !differences.is_empty() {
        tables::difference(&file("difference"), findings, state, sensors)?;
        tables::spectra(&file("difference_spectrum"), time_step, mesh_frequency, &differences)?;
    }
    for (period, kind) in findings.periods.iter().enumerate() {
        let name = kind.averaging.name();
        tables::average(&file(&format!("average_{name}")), findings, state, period, sensors)?;
        let averaged = |k: usize| state.judged[k].averages[period].exact.as_deref();
        let differences: Vec<(String, &[f64])> =
            sensors.iter().filter_map(|(k, sensor)| Some((sensor.name.clone(), averaged(*k)?))).collect();
        if !differences.is_empty() {
            let name = format!("difference_spectrum_{name}");
            tables::spectra(&file(&name), time_step, mesh_frequency, &differences)?;
        }
    }
    Ok(())
}
