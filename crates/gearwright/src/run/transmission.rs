//! Vibration of a planetary transmission.

use std::path::Path;
use std::time::Instant;

use anyhow::{anyhow, bail};
use gearwright_case::TransmissionCase;
use gearwright_plot::transmission as figures;
use gearwright_results::transmission::{summary, tables};
use gearwright_store::ResultsFolder;
use gearwright_study::RunObserver;
use gearwright_study::transmission::{cache::Cache, compute};

use super::{Finished, Unusable, save_tables};

/// Runs a transmission case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then; tables made so far stay in the cache.
pub fn run(case: &TransmissionCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let findings = compute(case, &Cache::beside(target, case.inputs.output.cache), observer)?;
    observer.stage("writing results");
    let clock = Instant::now();
    save_tables(&folder, tables::tables(&findings, case.inputs.output.around_signals)?)?;
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
