//! Dynamics of a gear pair.

use std::path::Path;
use std::time::Instant;

use anyhow::anyhow;
use gearwright_case::DynamicsCase;
use gearwright_plot::dynamics as figures;
use gearwright_results::dynamics::{Speed, summary, tables};
use gearwright_store::ResultsFolder;
use gearwright_study::RunObserver;
use gearwright_study::dynamics::{compute, film};

use super::{Finished, Unusable, save_tables};

/// Runs a dynamics case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then; a checkpoint stays beside it.
pub fn run(case: &DynamicsCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let computed = compute(case, target, observer)?;
    let results = &computed.results;
    let (speeds, blows) = (&results.speeds, &results.blows);
    observer.stage("writing results");
    let clock = Instant::now();
    save_tables(&folder, tables::tables(results))?;
    for (row, speed) in speeds.iter().enumerate() {
        let prefix = results.folder(row);
        if case.inputs.output.film.is_some() {
            film::write(case, &computed, row, &|name: &str| folder.file(&format!("{prefix}{name}")))?;
        }
        if case.inputs.output.plots {
            draw(case, &folder, &prefix, speed)?;
        }
    }
    if case.inputs.output.plots {
        let file = |name: &str| folder.file(name);
        if speeds.len() > 1 {
            for (name, chart) in figures::over_speed(&case.inputs.title, speeds) {
                chart.save(&file, name).map_err(|e| anyhow!("plot {name}: {e}"))?;
            }
        }
        if !blows.is_empty() {
            let chart = figures::impulse(&case.inputs.title, blows);
            chart.save(&file, "impulse_response").map_err(|e| anyhow!("plot: {e}"))?;
        }
    }
    let times = summary::Times { output: clock.elapsed().as_secs_f64(), ..results.times };
    let whole = summary::summary(case, results.vibration, speeds, blows, times);
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    let screen = summary::screen(case, &whole, results.steps.as_deref());
    let all = || speeds.iter().flat_map(|speed| &speed.responses);
    let unusable = Unusable {
        count: all().map(|response| response.work.not_converged).sum(),
        total: all().map(|response| response.work.steps).sum(),
        what: "steps",
    };
    let folder = folder.publish()?;
    computed.finish();
    Ok(Finished { folder, screen, unusable })
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
