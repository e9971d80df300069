//! Which recordings are judged, healthy, damaged: files, and what is measured on them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::detection;
use super::error::RecordingError;
use super::source::recordings;
use gearwright_case::RecordingCase;
use gearwright_case::recording::resolve::{DamagedSet, HealthySet, LimitSource};
use gearwright_results::recording::{Detection, Entry, Limits, Measured, Severity};

/// Files of a run.
#[derive(Debug, Clone)]
pub struct Files {
    /// Recordings to judge, in order.
    pub judged: Vec<PathBuf>,
    /// Whether they are a trend.
    pub is_trend: bool,
    /// A healthy set of its own.
    pub healthy: Vec<PathBuf>,
    /// A damaged set of its own.
    pub damaged: Vec<PathBuf>,
    /// Severities of the damaged set, by name.
    pub severities: Option<BTreeMap<String, Severity>>,
}

impl Files {
    /// Looks the files of a case up.
    ///
    /// # Errors
    /// Missing files, and sets that do not suit a single recording or each other.
    pub fn of(case: &RecordingCase) -> Result<Self, RecordingError> {
        let path = || case.signal.clone();
        let is_trend = case.signal.is_dir();
        let judged = recordings(&case.signal, "signal.file (--signal)")?;
        let is_there =
            |name: &String| judged.iter().any(|f| f.file_name().is_some_and(|n| n.to_string_lossy() == **name));
        if let Some(name) = case.memory.reset_before.iter().find(|name| !is_there(name)) {
            return Err(RecordingError::ResetBefore { path: path(), name: name.clone() });
        }
        let of_trend = |message| if is_trend { Ok(()) } else { Err(RecordingError::Kind { path: path(), message }) };
        let (mut healthy, mut first) = (Vec::new(), 0);
        match &case.limits {
            LimitSource::Gaussian(_) => {}
            LimitSource::Healthy(HealthySet::Folder(folder), _) => {
                healthy = recordings(folder, "thresholds.healthy (--healthy)")?
            }
            LimitSource::Healthy(HealthySet::First(count), _) => {
                of_trend("thresholds.healthy_first (--healthy-first) needs a folder of recordings")?;
                first = *count;
            }
        }
        let (mut damaged, mut severities) = (Vec::new(), None);
        if let Some(plan) = &case.detection {
            match &plan.damaged {
                DamagedSet::Folder(folder) => damaged = recordings(folder, "detection.damaged (--damaged)")?,
                DamagedSet::Last(last) => {
                    of_trend("detection.damaged_last (--damaged-last) needs a folder of recordings")?;
                    let (healthy, damaged, count) = (first, *last, judged.len());
                    if healthy + damaged > count {
                        return Err(RecordingError::Overlap { path: path(), healthy, damaged, count });
                    }
                }
            }
            severities = plan.severities.as_ref().map(|table| detection::severities(table)).transpose()?;
        }
        Ok(Self { judged, is_trend, healthy, damaged, severities })
    }
}

/// What is measured of a set.
#[must_use]
pub fn measured(set: &[Entry]) -> Vec<&Measured> {
    set.iter().filter_map(|entry| entry.measured.as_ref().ok()).collect()
}

/// Thresholds of a case, and the healthy recordings behind them; `healthy` is a set of its own, `entries` the recordings judged.
///
/// # Errors
/// A healthy set of fewer than two usable recordings.
pub fn limits<'a>(
    case: &RecordingCase,
    healthy: &'a [Entry],
    entries: &'a [Entry],
) -> Result<(Limits, Vec<&'a Measured>), RecordingError> {
    let (set, rule) = match &case.limits {
        LimitSource::Healthy(set, rule) => (set, rule),
        LimitSource::Gaussian(rule) => {
            let channels = measured(entries).iter().map(|m| m.channels.len()).max().unwrap_or(1);
            return Ok((Limits::gaussian(*rule, channels), Vec::new()));
        }
    };
    let (set, path) = match set {
        HealthySet::Folder(path) => (healthy, path),
        HealthySet::First(count) => (&entries[..(*count).min(entries.len())], &case.signal),
    };
    let set = measured(set);
    if set.len() < 2 {
        return Err(RecordingError::Healthy { path: path.clone(), found: set.len() });
    }
    Ok((Limits::of_healthy(&set, *rule), set))
}

/// Detection, where a case asks for it; `damaged` is a set of its own, `entries` the recordings judged.
///
/// # Errors
/// A damaged set without usable recordings.
pub fn detection(
    case: &RecordingCase,
    damaged: &[Entry],
    entries: &[Entry],
    healthy: &[&Measured],
    limits: &Limits,
    severities: Option<&BTreeMap<String, Severity>>,
) -> Result<Option<Detection>, RecordingError> {
    let Some(plan) = &case.detection else { return Ok(None) };
    let (set, path) = match &plan.damaged {
        DamagedSet::Folder(path) => (damaged, path),
        DamagedSet::Last(count) => (&entries[entries.len().saturating_sub(*count)..], &case.signal),
    };
    let of_damaged = measured(set);
    if of_damaged.is_empty() {
        let first = set.first().and_then(|entry| entry.measured.as_ref().err()).cloned().unwrap_or_default();
        return Err(RecordingError::Damaged { path: path.clone(), first });
    }
    let detected = detection::detect(healthy, &of_damaged, limits, severities);
    Ok(Some(Detection { damaged: of_damaged.len(), detected }))
}
