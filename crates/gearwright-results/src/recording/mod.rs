//! Condition indicators of recordings.

pub mod detection_tables;
mod judge;
mod measured;
pub mod summary;
pub mod tables;

use std::cmp::Ordering;

use hums::detectability::HitMiss;
use hums::threshold::{Rate, Roc, RocPoint};

pub use judge::{Bound, ChannelVerdict, HealthIndex, Limits, Verdict};
pub use measured::{Averaged, Channel, Convention, Detail, Measured, OF_CONVENTION, Pulses, Row};

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

/// A recording of a trend.
#[derive(Debug)]
pub struct Entry {
    /// Name of the file.
    pub name: String,
    /// What it says, or why nothing.
    pub measured: Result<Measured, String>,
}

/// An alarm: from its first recording until it was over.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Alarm {
    /// Channel.
    pub channel: String,
    /// Indicator.
    pub indicator: &'static str,
    /// Signal it is computed from.
    pub signal: &'static str,
    /// Its limits; none where there is none to that side.
    pub lower_limit: Option<f64>,
    /// See `lower_limit`.
    pub upper_limit: Option<f64>,
    /// Number of the recording (from 1) that raised it, and its name.
    pub raised_at: usize,
    /// Its name.
    pub raised_by: String,
    /// Number of the first recording without alarm; none if it still stands.
    pub cleared_at: Option<usize>,
    /// Value that deviates most meanwhile.
    pub extreme: f64,
    /// Share of all recordings outside the limits.
    pub share_outside: f64,
}

/// Value of an indicator in a recording.
#[must_use]
pub fn value(entry: &Entry, channel: &str, quantity: &Row) -> Option<f64> {
    entry.measured.as_ref().ok()?.value(channel, quantity)
}

/// False alarms allowed where a detection rate without a threshold is given.
pub const FALSE_ALARMS: f64 = 0.05;

/// What one indicator of one channel detects.
#[derive(Debug, Clone)]
pub struct Detected {
    /// Channel.
    pub channel: String,
    /// Indicator.
    pub indicator: &'static str,
    /// Signal it is computed from.
    pub signal: &'static str,
    /// Its limits, with the rate of false alarms.
    pub bound: Option<Bound>,
    /// Share of the damaged set outside the limits.
    pub detection: Option<Rate>,
    /// All thresholds.
    pub roc: Roc,
    /// The threshold that detects most with at most [`FALSE_ALARMS`] of the healthy set above it.
    pub best: RocPoint,
    /// Share outside the limits for each condition and severity, rising.
    pub by_severity: Vec<(Severity, Rate)>,
    /// Probability of detection over severity, for each condition.
    pub pod: Vec<Pod>,
}

/// Probability of detection over severity under one condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Pod {
    /// The condition.
    pub condition: String,
    /// Recordings, and those outside the limits.
    pub recordings: usize,
    /// See `recordings`.
    pub detected: usize,
    /// The fit, or why there is none.
    pub fit: Result<HitMiss, String>,
}

/// What the table of severities says of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Severity {
    /// Under what it was recorded (level of noise, load, ..); empty where the table does not say. Conditions have curves of their own.
    pub condition: String,
    /// Size of the damage, or whatever detection is plotted over.
    pub value: f64,
}

impl Severity {
    /// By condition as a number where both are, as text otherwise; then by value.
    #[must_use]
    pub fn order(&self, other: &Self) -> Ordering {
        let number = |severity: &Self| severity.condition.parse::<f64>().ok();
        let conditions = match (number(self), number(other)) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            (a, b) => b.is_some().cmp(&a.is_some()).then_with(|| self.condition.cmp(&other.condition)),
        };
        conditions.then(self.value.total_cmp(&other.value))
    }
}

/// Detection of damaged recordings.
#[derive(Debug)]
pub struct Detection {
    /// Recordings of the damaged set.
    pub damaged: usize,
    /// What each indicator detects.
    pub detected: Vec<Detected>,
}
