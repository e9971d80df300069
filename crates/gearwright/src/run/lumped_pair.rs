//! Lumped-parameter dynamics of a pair.

use std::path::Path;
use std::time::Instant;

use anyhow::anyhow;
use gearwright_case::LumpedPairCase;
use gearwright_plot::{Chart, lumped as figures};
use gearwright_results::lumped::{Findings, State, summary, tables};
use gearwright_store::ResultsFolder;
use gearwright_study::RunObserver;
use gearwright_study::lumped_pair::compute;

use super::{Finished, Unusable, save_tables};

/// Runs a lumped-pair case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then.
pub fn run(case: &LumpedPairCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let results = compute(case, observer)?;
    observer.stage("writing results");
    let clock = Instant::now();
    save_tables(&folder, tables::tables(&results))?;
    if case.inputs.output.plots {
        draw(case, &folder, &results.states, &results.findings)?;
    }
    let times = summary::Times { output: clock.elapsed().as_secs_f64(), ..results.times };
    let whole = summary::summary(case, (&results.states, &results.treatment), &results.findings, times)?;
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    let screen = summary::screen(case, &whole);
    Ok(Finished { folder: folder.publish()?, screen, unusable: Unusable::default() })
}

fn draw(case: &LumpedPairCase, folder: &ResultsFolder, states: &[State], findings: &Findings) -> anyhow::Result<()> {
    let file = |name: &str| folder.file(name);
    let title = case.inputs.title.as_str();
    let save = |chart: Chart, name: &str| chart.save(&file, name).map_err(|e| anyhow!("plot {name}: {e}"));
    save(figures::stiffness(title, states), "mesh_stiffness")?;
    save(figures::static_error(title, states), "static_transmission_error")?;
    if !findings.time.is_empty() {
        save(figures::transmission_error(title, &findings.time), "dynamic_transmission_error")?;
        save(figures::spectrum(title, &findings.time), "spectrum")?;
        save(figures::mesh_force(title, &findings.time), "mesh_force")?;
        save(figures::bearing_forces(title, &findings.time), "bearing_forces")?;
        if findings.time.iter().any(|t| !t.tooth_forces.is_empty()) {
            save(figures::tooth_forces(title, &findings.time), "tooth_forces")?;
        }
    }
    if !findings.sweeps.is_empty() || !findings.branches.is_empty() {
        let (sweeps, branches) = (&findings.sweeps, &findings.branches);
        save(
            figures::over_speed(title, sweeps, branches, "Peak-to-peak DTE (µm)", |m| m.peak_to_peak),
            "peak_to_peak",
        )?;
        save(figures::over_speed(title, sweeps, branches, "RMS of the DTE (µm)", |m| m.rms), "rms")?;
    }
    if !findings.impulses.is_empty() {
        save(figures::impulse(title, &findings.impulses), "impulse_response")?;
    }
    if !findings.damage.is_empty() {
        save(figures::damage_response(title, &findings.damage), "damage_response")?;
        save(figures::damage_spectrum(title, &findings.damage), "damage_spectrum")?;
    }
    if !findings.damage_speeds.is_empty() {
        save(figures::damage_speeds(title, &findings.damage_speeds), "damage_over_speed")?;
    }
    Ok(())
}
