//! Condition indicators of a recording, or of a folder of recordings.

mod detection;
mod error;
mod measure;
mod sets;
mod source;
mod trend;
mod turning;

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use gearwright_case::RecordingCase;
use gearwright_case::recording::resolve::{HealthySet, LimitSource};
use gearwright_results::recording::{Entry, Outcome};

pub use self::error::RecordingError;

use self::measure::measure;
use self::sets::Files;
use self::source::Progress;
use super::RunObserver;

/// Everything a case says, without writing it.
///
/// # Errors
/// Input that gives no indicators.
pub fn compute(case: &RecordingCase, observer: &dyn RunObserver) -> Result<Outcome, RecordingError> {
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
                    Ok(Entry { name, measured: other.map_err(|fault| fault.in_one_line()) })
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
            LimitSource::Gaussian(_) => None,
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
