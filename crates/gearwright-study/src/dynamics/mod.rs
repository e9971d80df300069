//! Dynamics of a gear pair: every state at every speed, difference signals of damaged states, impulse tests.

mod checkpoint;
pub mod film;
mod resolution;
mod simulate;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, bail};
use fecm::dynamics::{ImpulseSpec, PairDynamics};
use fecm::statics::PairModel;
use gearwright_case::DynamicsCase;
use gearwright_case::lumped_pair::resolve::HEALTHY;
use gearwright_results::dynamics::{Blow, Difference, Dynamics, Response, Speed, moving_coordinates, summary::Times};
use hums::moments::Moments;
use lpm::Spectrum;

use super::{AsObserver, RunObserver};
use checkpoint::Checkpoint;
use simulate::{Plan, Progress, SavedState, simulate, start};

/// A state of the pair.
struct State {
    name: String,
    /// Number among the damaged states, from 1; `None` for the healthy one.
    number: Option<usize>,
    model: PairModel,
}

/// A case, computed.
pub struct Computed {
    /// What came out.
    pub results: Dynamics,
    /// What films are run again from, by speed and state.
    films: Vec<Vec<FilmStart>>,
    states: Vec<State>,
    checkpoint: Checkpoint,
}

/// Where the film of a response begins.
struct FilmStart {
    plan: Plan,
    state: Option<SavedState>,
}

/// Computes a dynamics case whose results will stand at `target`; a checkpoint is kept beside it.
///
/// # Errors
/// Model errors, what the file system says of the checkpoint, cancellation.
pub fn compute(case: &DynamicsCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Computed> {
    let mut times = Times::default();
    let clock = Instant::now();
    observer.stage("condensing both gears");
    let states = states(case)?;
    times.condensation = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let mut checkpoint = Checkpoint::open(case, target, case.speeds.len() * states.len());
    let name = checkpoint.file().display();
    if checkpoint.is_taken_up() {
        observer.stage(&format!("taking up {name}"));
    } else if let Some(reason) = checkpoint.ignored() {
        observer.stage(&format!("not taking up {name}: {reason}"));
    }
    let (vibration, resolutions) = resolution::resolutions(case, &states[0].model)?.unzip();
    let steps = vibration.zip(resolutions.as_ref()).map(|(vibration, all)| resolution::told(&vibration, all));
    let (mut speeds, mut films) = (Vec::new(), Vec::new());
    for (row, (&speed, resolution)) in case.speeds.iter().zip(resolutions.into_iter().flatten()).enumerate() {
        let (mut responses, mut starts): (Vec<Response>, Vec<FilmStart>) = (Vec::new(), Vec::new());
        let mut healthy_end: Option<SavedState> = None;
        for (column, state) in states.iter().enumerate() {
            let index = row * states.len() + column;
            observer.stage(&stage(case, speed, &state.name));
            let dynamics = PairDynamics::new(&state.model, &case.options)?;
            let modes = [0, 1].map(|body| dynamics.mode_frequencies(body));
            let healthy = responses.first();
            let plan =
                Plan::new(case, speed, resolution.steps, dynamics.period(), healthy.and_then(|healthy| healthy.shrink));
            let mut progress = checkpoint.run(index);
            let mut save = |progress: &Progress| checkpoint.save(index, progress);
            if !progress.complete {
                // modes of a model of half the face are others than those of the whole
                let like = healthy.filter(|healthy| healthy.modes == modes);
                let start = start(case, &plan, like.and(healthy_end.as_ref()));
                simulate(&dynamics, case, &plan, start, &mut progress, &AsObserver(observer), &mut save)
                    .with_context(|| format!("the run of the {} pair", state.name))?;
            }
            if observer.is_cancelled() {
                bail!(
                    "stopped; `gearwright run` of the same case and results folder goes on from {}",
                    checkpoint.file().display()
                );
            }
            if column == 0 {
                healthy_end.clone_from(&progress.state);
            }
            starts.push(FilmStart { plan, state: progress.film_start.clone() });
            responses.push(response(case, &plan, progress, (&state.name, state.number), modes, healthy)?);
        }
        let teeth = f64::from(case.statics.pair.pinion().teeth());
        let mesh_frequency = speed * teeth / (2.0 * std::f64::consts::PI);
        speeds.push(Speed { speed, mesh_frequency, resolution, responses });
        films.push(starts);
    }
    times.response = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let blows = impulse_tests(case, &states, observer)?;
    times.impulse = clock.elapsed().as_secs_f64();
    if observer.is_cancelled() {
        bail!("stopped; `gearwright run` of the same case and results folder goes on where it was");
    }
    let results = Dynamics { vibration, steps, speeds, blows, times };
    Ok(Computed { results, films, states, checkpoint })
}

impl Computed {
    /// Removes the checkpoint: the results are there.
    pub fn finish(self) {
        self.checkpoint.remove();
    }
}

/// A response from a complete run.
///
/// # Errors
/// Records too short for a spectrum.
fn response(
    case: &DynamicsCase,
    plan: &Plan,
    progress: Progress,
    (state, number): (&str, Option<usize>),
    modes: [Vec<f64>; 2],
    healthy: Option<&Response>,
) -> anyhow::Result<Response> {
    let teeth = f64::from(case.statics.pair.pinion().teeth());
    let steps = plan.cycle as f64;
    let time_step = 2.0 * std::f64::consts::PI / (teeth * plan.speed * steps);
    let before = progress.before_record.unwrap_or_default();
    let left = progress.transient_left(plan);
    let mut samples = progress.samples;
    // a record after some periods is told as the first one: its teeth stand where those of the first did
    let periods_before = match plan.transient {
        Some(_) => 0,
        None => (before / plan.cycle as i64) as i32,
    };
    for (pair, _) in samples.iter_mut().flat_map(|sample| &mut sample.pairs) {
        *pair -= periods_before;
    }
    let signal: Vec<f64> = samples.iter().map(|sample| sample.transmission_error).collect();
    let duration = time_step * samples.len() as f64;
    let spectrum = Spectrum::of(&signal, duration)?;
    let difference = healthy.map(|healthy| difference(&signal, healthy, duration)).transpose()?;
    let tolerance = case.inputs.run.steady_tolerance;
    let period = plan.period / plan.cycle;
    Ok(Response {
        state: state.into(),
        number,
        time_step,
        mesh_cycle: (0..samples.len()).map(|k| case.inputs.run.mesh_cycle_from + k as f64 / steps).collect(),
        samples,
        coordinates: moving_coordinates(case),
        modes,
        spectrum,
        difference,
        period,
        transient: before as f64 / steps,
        transient_left: left,
        shrink: progress.shrink.map(|shrink| shrink.min(1.0).powf(1.0 / period as f64)),
        steady: plan.transient.is_none().then(|| left.is_some_and(|left| left < tolerance)),
        work: progress.work,
    })
}

fn difference(signal: &[f64], healthy: &Response, duration: f64) -> anyhow::Result<Difference> {
    let reference: Vec<f64> = healthy.samples.iter().map(|sample| sample.transmission_error).collect();
    let signal = hums::difference::exact_difference(signal, &reference)?;
    let moments = Moments::of(&signal)?;
    Ok(Difference {
        spectrum: Spectrum::of(&signal, duration)?,
        rms: moments.rms(),
        fm4: moments.standardized(4).ok(),
        m8a: moments.standardized(8).ok(),
        signal,
    })
}

/// The steps of a mesh cycle a run of the case takes, and why; nothing for a case without speeds.
///
/// # Errors
/// Those of the model of the healthy pair.
pub fn steps_told(case: &DynamicsCase) -> anyhow::Result<String> {
    if case.speeds.is_empty() {
        return Ok(String::new());
    }
    let found = resolution::resolutions(case, &healthy(case)?)?;
    Ok(found.map_or_else(String::new, |(v, all)| format!("steps a mesh cycle: {}\n", resolution::told(&v, &all))))
}

fn stage(case: &DynamicsCase, speed: f64, state: &str) -> String {
    match case.speeds.len() {
        1 => state.to_owned(),
        _ => format!("{:.1} rpm, {state}", speed * 30.0 / std::f64::consts::PI),
    }
}

/// The pair without damage.
///
/// # Errors
/// Those of the model.
pub fn healthy(case: &DynamicsCase) -> anyhow::Result<PairModel> {
    PairModel::new(&case.statics.pair, &case.statics.options).context("the gears cannot be modelled")
}

/// The healthy pair, then each severity.
fn states(case: &DynamicsCase) -> anyhow::Result<Vec<State>> {
    let healthy = healthy(case)?;
    let mut states = vec![State { name: HEALTHY.into(), number: None, model: healthy }];
    for (number, (_, severity)) in case.severities.iter().enumerate() {
        // derived from the state before: what they have in common is computed once
        let before = &states[states.len() - 1].model;
        let model =
            before.with_damage(&severity.damage).with_context(|| format!("{} cannot be modelled", severity.label))?;
        states.push(State { name: severity.label.clone(), number: Some(number + 1), model });
    }
    Ok(states)
}

fn impulse_tests(case: &DynamicsCase, states: &[State], observer: &dyn RunObserver) -> anyhow::Result<Vec<Blow>> {
    let Some(impulse) = &case.inputs.impulse else { return Ok(Vec::new()) };
    let mut blows = Vec::new();
    for state in states {
        observer.stage(&format!("impulse tests, {}", state.name));
        let dynamics = PairDynamics::new(&state.model, &case.options)?;
        for &mesh_cycle in &impulse.mesh_cycles {
            let spec = ImpulseSpec {
                mesh_cycle: mesh_cycle - case.origin,
                torque: case.torque,
                pulse: impulse.pulse_fraction,
                periods: impulse.natural_periods as usize,
            };
            let reading = dynamics
                .impulse_test(&spec, &AsObserver(observer))
                .with_context(|| format!("the impulse test of the {} pair at mesh cycle {mesh_cycle}", state.name))?;
            blows.push(Blow { state: state.name.clone(), mesh_cycle, reading });
        }
    }
    Ok(blows)
}
