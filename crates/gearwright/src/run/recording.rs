//! Condition indicators of a recording, or of a folder of recordings.

use std::path::Path;
use std::time::Instant;

use anyhow::anyhow;
use gearwright_case::RecordingCase;
use gearwright_plot::recording as figures;
use gearwright_results::recording::{detection_tables, summary, tables};
use gearwright_store::ResultsFolder;
use gearwright_study::RunObserver;
use gearwright_study::recording::{RecordingError, compute};

use super::{Finished, Unusable};

/// Runs a recording case into `target`.
///
/// # Errors
/// Input that gives no indicators ([`RecordingError`]), and anything the file system says. Nothing is left at `target` then.
pub fn run(case: &RecordingCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let started = Instant::now();
    let folder = ResultsFolder::create(target)?;
    let outcome = compute(case, observer)?;
    observer.stage("writing results");
    let file = |name: &str| folder.file(name);
    let shown = outcome.shown().ok_or_else(|| anyhow!("no recording could be used"))?;
    tables::indicators(&file("indicators.csv"), shown, &outcome.limits)?;
    tables::quality(&file("quality.csv"), &outcome.entries)?;
    tables::difference_signals(&file("difference_signals.csv"), shown)?;
    if case.inputs.output.averages {
        tables::averages(&file("averages.csv"), shown, case.period_turns)?;
        tables::order_spectrum(&file("order_spectrum.csv"), shown, &case.rule, case.period_turns)?;
    }
    if outcome.is_trend {
        tables::trend(&file("trend.csv"), &outcome.entries, &outcome.limits)?;
        tables::alarms(&file("alarms.csv"), &outcome.alarms)?;
        tables::health_index(&file("health_index.csv"), &outcome.entries, &outcome.limits)?;
    }
    if let Some(detection) = &outcome.detection {
        detection_tables::rates(&file("detection.csv"), &detection.detected)?;
        detection_tables::roc(&file("roc.csv"), &detection.detected)?;
        if case.detection.as_ref().is_some_and(|plan| plan.severities.is_some()) {
            detection_tables::severities(&file("detection_over_severity.csv"), &detection.detected)?;
            detection_tables::pod(&file("pod.csv"), &detection.detected)?;
        }
    }
    if case.inputs.output.plots {
        for (name, chart) in figures::all(case, &outcome) {
            chart.save(&file, &name).map_err(|e| anyhow!("plot {name}: {e}"))?;
        }
    }
    let seconds = started.elapsed().as_secs_f64();
    let whole = summary::summary(case, &outcome, seconds);
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    if observer.is_cancelled() {
        return Err(RecordingError::Cancelled.into());
    }
    let screen = summary::screen(case, &outcome);
    let unusable = Unusable {
        count: outcome.entries.iter().filter(|entry| entry.measured.is_err()).count(),
        total: outcome.entries.len(),
        what: "recordings",
    };
    Ok(Finished { folder: folder.publish()?, screen, unusable })
}
