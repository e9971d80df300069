//! Dynamics of a gear pair: every state at every speed, difference signals of damaged states, films, everything written.

pub mod checkpoint;
pub mod film;
pub mod findings;
pub mod resolution;
pub mod simulate;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow, bail};
use fecm::dynamics::{ImpulseSpec, PairDynamics};
use fecm::statics::PairModel;

use crate::output::folder::ResultsFolder;
use crate::output::{dynamics_summary as summary, dynamics_tables as tables};
use crate::plot::dynamics as figures;
use gearwright_case::DynamicsCase;
use gearwright_case::lumped_pair::resolve::HEALTHY;

use super::{AsObserver, Finished, RunObserver};
use checkpoint::Checkpoint;
use findings::{Blow, Response, Speed};
use simulate::{Plan, simulate, start};

/// A state of the pair.
struct State {
    name: String,
    /// Number among the damaged states, from 1; `None` for the healthy one.
    number: Option<usize>,
    model: PairModel,
}

/// Runs a dynamics case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then; a checkpoint stays beside it.
pub fn run(case: &DynamicsCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let mut times = summary::Times::default();
    let clock = Instant::now();
    observer.stage("condensing both gears");
    let states = states(case)?;
    times.condensation = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let mut checkpoint = Checkpoint::open(case, target, case.speeds.len() * states.len());
    if checkpoint.is_taken_up() {
        observer.stage(&format!("taking up {}", checkpoint.file().display()));
    }
    let (vibration, resolutions) = resolution::resolutions(case, &states[0].model)?.unzip();
    let told = vibration.zip(resolutions.as_ref()).map(|(vibration, all)| resolution::told(&vibration, all));
    let mut speeds = Vec::new();
    for (row, (&speed, resolution)) in case.speeds.iter().zip(resolutions.into_iter().flatten()).enumerate() {
        let mut responses: Vec<Response> = Vec::new();
        for (column, state) in states.iter().enumerate() {
            let index = row * states.len() + column;
            observer.stage(&stage(case, speed, &state.name));
            let dynamics = PairDynamics::new(&state.model, &case.options)?;
            let modes = [0, 1].map(|body| dynamics.mode_frequencies(body));
            let healthy = responses.first();
            let plan =
                Plan::new(case, speed, resolution.steps, dynamics.period(), healthy.and_then(|healthy| healthy.shrink));
            let mut progress = checkpoint.run(index);
            let mut save = |progress: &simulate::Progress| checkpoint.save(index, progress);
            if !progress.complete {
                // modes of a model of half the face are others than those of the whole
                let like = healthy.filter(|healthy| healthy.modes == modes);
                let start = start(case, &plan, like.and_then(|healthy| healthy.end.as_ref()));
                simulate(&dynamics, case, &plan, start, &mut progress, &AsObserver(observer), &mut save)
                    .with_context(|| format!("the run of the {} pair", state.name))?;
            }
            if observer.is_cancelled() {
                bail!(
                    "stopped; `gearwright run` of the same case and results folder goes on from {}",
                    checkpoint.file().display()
                );
            }
            let response = Response::new(case, &plan, progress, (&state.name, state.number), modes, healthy)?;
            responses.push(response);
        }
        speeds.push(Speed::new(case, speed, resolution, responses));
    }
    times.response = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let blows = impulse_tests(case, &states, observer)?;
    times.impulse = clock.elapsed().as_secs_f64();
    if observer.is_cancelled() {
        bail!("stopped; `gearwright run` of the same case and results folder goes on where it was");
    }

    observer.stage("writing results");
    let clock = Instant::now();
    for (row, speed) in speeds.iter().enumerate() {
        // one speed: all in the results folder itself
        let prefix = if speeds.len() == 1 { String::new() } else { format!("speed_{}/", row + 1) };
        std::fs::create_dir_all(folder.file(&prefix))?;
        write_tables(&folder, &prefix, speed)?;
        if case.inputs.output.film.is_some() {
            for (state, response) in states.iter().zip(&speed.responses) {
                film::write(case, &state.model, response, &|name: &str| folder.file(&format!("{prefix}{name}")))?;
            }
        }
        if case.inputs.output.plots {
            draw(case, &folder, &prefix, speed)?;
        }
    }
    if speeds.len() > 1 {
        tables::over_speed(&folder.file("over_speed.csv"), &speeds)?;
        if case.inputs.output.plots {
            let file = |name: &str| folder.file(name);
            for (name, chart) in figures::over_speed(&case.inputs.title, &speeds) {
                chart.save(&file, name).map_err(|e| anyhow!("plot {name}: {e}"))?;
            }
        }
    }
    if !blows.is_empty() {
        tables::impulse(&folder.file("impulse.csv"), &blows)?;
        tables::impulse_response(&folder.file("impulse_response.csv"), &blows)?;
        if case.inputs.output.plots {
            let chart = figures::impulse(&case.inputs.title, &blows);
            chart.save(&|name: &str| folder.file(name), "impulse_response").map_err(|e| anyhow!("plot: {e}"))?;
        }
    }
    times.output = clock.elapsed().as_secs_f64();
    let whole = summary::summary(case, vibration, &speeds, &blows, times);
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    let screen = summary::screen(case, &whole, told.as_deref());
    let folder = folder.publish()?;
    checkpoint.remove();
    Ok(Finished { folder, screen, unusable: 0 })
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

fn write_tables(folder: &ResultsFolder, prefix: &str, speed: &Speed) -> anyhow::Result<()> {
    let file = |name: &str| folder.file(&format!("{prefix}{name}.csv"));
    for response in &speed.responses {
        let suffix = response.suffix();
        tables::response(&file(&format!("response{suffix}")), response)?;
        tables::spectrum(&file(&format!("spectrum{suffix}")), &response.spectrum, speed.mesh_frequency)?;
        if let Some(difference) = &response.difference {
            tables::difference(&file(&format!("difference{suffix}")), response, difference)?;
            let name = format!("difference_spectrum{suffix}");
            tables::spectrum(&file(&name), &difference.spectrum, speed.mesh_frequency)?;
        }
    }
    tables::tooth_forces(&file("tooth_forces"), &speed.responses)?;
    tables::contact_loss(&file("contact_loss"), &speed.responses)?;
    Ok(())
}

fn draw(case: &DynamicsCase, folder: &ResultsFolder, prefix: &str, speed: &Speed) -> anyhow::Result<()> {
    let file = |name: &str| folder.file(&format!("{prefix}{name}"));
    let title = case.inputs.title.as_str();
    let failed = |name: &str| {
        let name = name.to_owned();
        move |error: String| anyhow!("plot {name}: {error}")
    };
    let error = figures::transmission_error(title, speed);
    error.save(&file, "dynamic_transmission_error").map_err(failed("dynamic_transmission_error"))?;
    figures::mesh_force(title, speed).save(&file, "mesh_force").map_err(failed("mesh_force"))?;
    figures::spectrum(title, speed).save(&file, "spectrum").map_err(failed("spectrum"))?;
    if let Some(range) = figures::around_damage(speed) {
        let name = "dynamic_transmission_error_near_damage";
        figures::within(error, range).save(&file, name).map_err(failed(name))?;
        figures::difference(title, speed).save(&file, "difference").map_err(failed("difference"))?;
        let name = "difference_spectrum";
        figures::difference_spectrum(title, speed).save(&file, name).map_err(failed(name))?;
    }
    Ok(())
}
