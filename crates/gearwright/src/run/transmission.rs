//! Vibration of a planetary transmission.

use std::path::Path;
use std::time::Instant;

use anyhow::{anyhow, bail};
use gearwright_case::TransmissionCase;
use gearwright_plot::transmission as figures;
use gearwright_results::transmission::{Findings, Sensor, State, summary, tables};
use gearwright_store::ResultsFolder;
use gearwright_study::RunObserver;
use gearwright_study::transmission::{cache::Cache, compute};

use super::{Finished, Unusable};

/// Runs a transmission case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then; tables made so far stay in the cache.
pub fn run(case: &TransmissionCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let findings = compute(case, &Cache::beside(target, case.inputs.output.cache), observer)?;
    observer.stage("writing results");
    let clock = Instant::now();
    write(case, &folder, &findings)?;
    if case.inputs.output.plots {
        let file = |name: &str| folder.file(name);
        for (name, figure) in figures::all(&case.inputs.title, &findings) {
            figure.save(&file, &name).map_err(|e| anyhow!("plot {name}: {e}"))?;
        }
    }
    let times = summary::Times { output: clock.elapsed().as_secs_f64(), ..findings.times };
    let whole = summary::summary(case, &findings, times);
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    if observer.is_cancelled() {
        bail!("stopped; tables made so far are kept for the next run");
    }
    let screen = summary::screen(case, &findings, &times);
    Ok(Finished { folder: folder.publish()?, screen, unusable: Unusable::default() })
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
    let (time_step, mesh_frequency) = (state.run.sample_time, findings.mesh_frequency);
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
