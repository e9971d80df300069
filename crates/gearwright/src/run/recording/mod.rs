//! Condition indicators of a recording, or of a folder of recordings.

pub mod detection;
pub mod error;
pub mod judge;
pub mod measure;
pub mod sets;
mod source;
pub mod trend;
mod turning;

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::anyhow;
use rayon::prelude::*;

use crate::output::folder::ResultsFolder;
use crate::output::{recording as tables, recording_detection as detection_tables, recording_summary as summary};
use crate::plot::recording as figures;
use gearwright_case::RecordingCase;
use gearwright_case::recording::resolve::{HealthySet, LimitSource};

use self::error::RecordingError;
use self::judge::Limits;
use self::measure::{Measured, measure};
use self::sets::{Detection, Files};
use self::source::Progress;
use self::trend::{Alarm, Entry};
use super::{Finished, RunObserver};

/// Everything a run finds.
#[derive(Debug)]
pub struct Outcome {
    /// The recordings; one, or those of a folder.
    pub entries: Vec<Entry>,
    /// Whether they are a trend.
    pub is_trend: bool,
    /// Index of the recording whose signals are kept: the last usable one.
    pub shown: usize,
    /// Thresholds.
    pub limits: Limits,
    /// Alarms of the trend.
    pub alarms: Vec<Alarm>,
    /// Recordings of the healthy set.
    pub healthy: usize,
    /// Detection of damaged recordings.
    pub detection: Option<Detection>,
}

impl Outcome {
    /// The recording whose signals are kept.
    #[must_use]
    pub fn shown(&self) -> Option<&Measured> {
        self.entries.get(self.shown)?.measured.as_ref().ok()
    }
}

/// Runs a recording case into `target`.
///
/// # Errors
/// Input that gives no indicators ([`RecordingError`]), and anything the file system says. Nothing is left at `target` then.
pub fn run(case: &RecordingCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let started = Instant::now();
    let folder = ResultsFolder::create(target)?;
    let outcome = outcome(case, observer)?;
    observer.stage("writing results");
    let file = |name: &str| folder.file(name);
    let shown = outcome.shown().ok_or_else(|| anyhow!("no recording could be used"))?;
    tables::indicators(&file("indicators.csv"), shown, &outcome.limits)?;
    if case.inputs.output.averages {
        tables::averages(&file("averages.csv"), shown, case.period_turns)?;
    }
    if outcome.is_trend {
        tables::trend(&file("trend.csv"), &outcome.entries, &outcome.limits)?;
        tables::alarms(&file("alarms.csv"), &outcome.alarms)?;
    }
    if let Some(detection) = &outcome.detection {
        detection_tables::rates(&file("detection.csv"), &detection.detected)?;
        detection_tables::roc(&file("roc.csv"), &detection.detected)?;
        if case.detection.as_ref().is_some_and(|plan| plan.severities.is_some()) {
            detection_tables::severities(&file("detection_over_severity.csv"), &detection.detected)?;
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
    Ok(Finished { folder: folder.publish()?, screen, unusable: 0 })
}

/// Everything a case says, without writing it.
///
/// # Errors
/// Input that gives no indicators.
pub fn outcome(case: &RecordingCase, observer: &dyn RunObserver) -> Result<Outcome, RecordingError> {
    let files = Files::of(case)?;
    let is_trend = files.is_trend;
    let passes = turning::passes(case);
    let all = |files: &[PathBuf], keep: bool| -> Result<Vec<Entry>, RecordingError> {
        let progress = Progress::new(observer, files, passes);
        let measured: Vec<_> = files.par_iter().map(|file| (file, measure(file, case, &progress, keep))).collect();
        measured
            .into_iter()
            .map(|(file, measured)| match measured {
                Err(RecordingError::Cancelled) => Err(RecordingError::Cancelled),
                other => {
                    let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
                    Ok(Entry { name, measured: other.map_err(|fault| fault.told()) })
                }
            })
            .collect()
    };
    let of_set = |files: &[PathBuf], stage| {
        if files.is_empty() {
            return Ok(Vec::new());
        }
        observer.stage(stage);
        all(files, false)
    };
    let mut healthy = of_set(&files.healthy, "reading the healthy set (KiB)")?;
    let damaged = of_set(&files.damaged, "reading the damaged set (KiB)")?;
    observer.stage(if is_trend { "reading the recordings (KiB)" } else { "reading the recording (KiB)" });
    let mut entries = if is_trend {
        all(&files.judged, false)?
    } else {
        // One recording: its fault is the run's.
        let measured = measure(&files.judged[0], case, &Progress::new(observer, &files.judged, passes), true)?;
        vec![Entry { name: measured.name.clone(), measured: Ok(measured) }]
    };
    let Some(shown) = entries.iter().rposition(|entry| entry.measured.is_ok()) else {
        let first = entries.swap_remove(0).measured.err().unwrap_or_default();
        return Err(RecordingError::Unusable { path: case.signal.clone(), count: files.judged.len(), first });
    };
    if is_trend || !healthy.is_empty() {
        let known = match &case.limits {
            LimitSource::Healthy(HealthySet::First(count), _) => Some(*count),
            LimitSource::Healthy(HealthySet::Folder(_), _) => Some(healthy.len()),
            LimitSource::Gaussian => None,
        };
        let in_order = healthy.iter_mut().chain(&mut entries).filter_map(|entry| entry.measured.as_mut().ok());
        trend::remember(in_order, &case.memory, known).map_err(|source| RecordingError::Parameter {
            path: case.signal.clone(),
            key: "memory",
            source,
        })?;
    }
    let (limits, of_healthy) = sets::limits(case, &healthy, &entries)?;
    let detection = sets::detection(case, &damaged, &entries, &of_healthy, &limits, files.severities.as_ref())?;
    let healthy = of_healthy.len();
    if is_trend {
        observer.stage("signals of the last recording (KiB)");
        keep_signals(&mut entries[shown], &files.judged[shown], case, observer, passes)?;
    }
    let thresholds = &case.inputs.thresholds;
    let (hits, window) = (thresholds.alarm_hits as usize, thresholds.alarm_window as usize);
    let alarms = if is_trend {
        trend::alarm_log(&entries, &limits, hits, window).map_err(|source| RecordingError::Parameter {
            path: case.signal.clone(),
            key: "thresholds.alarm_hits",
            source,
        })?
    } else {
        Vec::new()
    };
    Ok(Outcome { entries, is_trend, shown, limits, alarms, healthy, detection })
}

/// Measures a recording again for its signals; its indicators stay as they are, with their memory.
fn keep_signals(
    entry: &mut Entry,
    file: &Path,
    case: &RecordingCase,
    observer: &dyn RunObserver,
    passes: u64,
) -> Result<(), RecordingError> {
    let progress = Progress::new(observer, &[file.to_path_buf()], passes);
    let full = measure(file, case, &progress, true)?;
    if let Ok(measured) = &mut entry.measured {
        for (channel, with_signals) in measured.channels.iter_mut().zip(full.channels) {
            channel.average = with_signals.average;
        }
    }
    Ok(())
}
