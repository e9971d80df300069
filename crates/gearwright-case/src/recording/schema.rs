//! The case file as written: keys, units, ranges, defaults.
//!
//! The doc comment of a field is the only documentation of its key: the JSON schema, `gearwright explain`, the comments of
//! `gearwright init` and the reference page all derive from it. Ranges stand in the `schemars` attributes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Recorded vibration: synchronous averages, condition indicators, verdicts, trends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// What the file describes.
    pub kind: Kind,
    /// A line for headings of plots and reports.
    #[serde(default)]
    pub title: String,
    /// What was recorded.
    pub signal: Signal,
    /// How the shaft turned: give one of `channel`, `file` and `speed_hz`.
    pub tachometer: Tachometer,
    /// The gear whose condition is asked for.
    pub gear: Gear,
    /// Synchronous average.
    #[serde(default)]
    pub average: Average,
    /// Which orders count as regular: mesh harmonics leave the residual signal, sidebands the difference signal as well.
    #[serde(default)]
    pub difference: Difference,
    /// Which flaws of a recording do not keep it from being judged.
    #[serde(default)]
    pub quality: Quality,
    /// When a value is a reason to look.
    #[serde(default)]
    pub thresholds: Thresholds,
    /// Indicators with a memory in a trend: NA4 and NB4 over the variances of earlier recordings.
    #[serde(default)]
    pub memory: Memory,
    /// How well indicators tell damaged from healthy recordings. Needs a healthy set, and `damaged` or `damaged_last`.
    #[serde(default)]
    pub detection: Detection,
    /// What is written.
    #[serde(default)]
    pub output: Output,
}

/// Kinds of case files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Kind {
    /// Recorded vibration.
    #[serde(rename = "recording")]
    Recording,
}

/// What was recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// Recording, beside the case file: csv, tsv, txt, dat, asc, wav, npy, mat or parquet.
    /// A folder of recordings, taken in the order of their names, gives a trend.
    pub file: String,
    /// Channels to judge, by name or by number from 1, separated by commas, e.g. "3" or "gearbox x, gearbox y"; default: all that are
    /// neither tachometer nor time. A name with a comma in it has to be given by its number.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub channels: String,
    /// Where the sensors sit about the housing (degrees), a number for each channel judged, in their order: gives polar maps of indicators.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub angles_deg: Vec<f64>,
    /// Sampling rate (Hz); default: what the file states, or the step of its time column. One that contradicts them by more than 0.1 % is a
    /// "rate-conflict": nothing is judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e12))]
    pub rate_hz: Option<f64>,
    /// Channel that holds the time, by name or number; default: a channel named "time" or "t". Its unit is s unless its name ends in "ms" or "us". Rows
    /// missing from it are gaps of all channels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_channel: Option<String>,
    /// Unit of the channels, for headings and columns, e.g. "g".
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Delimiter of a text file: "comma", "semicolon", "tab" or "blank"; default: found out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delimiter: Option<Delimiter>,
    /// Whether numbers of a text file have a decimal comma; default: found out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decimal_comma: Option<bool>,
    /// Lines of a text file before its numbers; default: found out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 100000))]
    pub header_lines: Option<u32>,
}

/// Delimiters of text files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Delimiter {
    /// A comma.
    Comma,
    /// A semicolon.
    Semicolon,
    /// A tab.
    Tab,
    /// Any run of blanks and tabs.
    Blank,
}

/// How the shaft turned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tachometer {
    /// Channel of the recording that holds tachometer pulses, by name or number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// File whose first column holds the times of the pulses (s, 0 at the first sample). With a folder of recordings: a folder with a file
    /// of the same name (up to the extension) for each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Constant speed of the tachometer's shaft (Hz).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub speed_hz: Option<f64>,
    /// Pulses for each turn of the tachometer's shaft.
    #[serde(default = "one")]
    #[schemars(range(min = 0.001, max = 1000000.0))]
    pub pulses_per_turn: f64,
    /// Turns of the shaft of interest for each `gear_ratio_divisor` turns of the tachometer's shaft. Tooth numbers keep it exact: the
    /// tachometer's gear here, that of the shaft of interest below.
    #[serde(default = "one")]
    #[schemars(range(min = 1e-6, max = 1000000.0))]
    pub gear_ratio: f64,
    /// See `gear_ratio`.
    #[serde(default = "one")]
    #[schemars(range(min = 1e-6, max = 1000000.0))]
    pub gear_ratio_divisor: f64,
    /// Level of the channel that counts as a pulse; default: midway between its extremes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<f64>,
    /// Width of the band about the level that a pulse must cross; default: a quarter of the channel's range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub hysteresis: Option<f64>,
    /// Flank of a pulse that carries the time: "rising" or "falling".
    #[serde(default)]
    pub edge: Edge,
}

fn one() -> f64 {
    1.0
}

impl Default for Tachometer {
    fn default() -> Self {
        Self {
            channel: None,
            file: None,
            speed_hz: None,
            pulses_per_turn: 1.0,
            gear_ratio: 1.0,
            gear_ratio_divisor: 1.0,
            level: None,
            hysteresis: None,
            edge: Edge::Rising,
        }
    }
}

/// Flanks of a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Edge {
    /// Upward crossings.
    #[default]
    Rising,
    /// Downward crossings.
    Falling,
}

/// The gear.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// Number of teeth of the gear on the shaft of interest: mesh cycles for each of its turns.
    /// Of a planetary stage whose carrier is the shaft of interest: teeth of the ring.
    #[schemars(range(min = 1, max = 100000))]
    pub teeth: u32,
}

/// Synchronous average.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Average {
    /// Turns of the shaft of interest in one averaging period, before `per_turn` divides it.
    #[schemars(range(min = 1, max = 10000))]
    pub turns: u32,
    /// The period is `turns` / `per_turn` turns: the number of planets averages over a planet pass of the carrier.
    #[schemars(range(min = 1, max = 10000))]
    pub per_turn: u32,
    /// Periods to average at most; default: all.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000000000))]
    pub max_periods: Option<u32>,
    /// Samples of the average; default: the power of two that keeps every sample of the recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 4, max = 67108864))]
    pub samples: Option<u32>,
    /// Values between samples: "band-limited" (exact up to 0.84 of the Nyquist frequency), "cubic-spline" or "linear".
    pub interpolation: Interpolation,
}

impl Default for Average {
    fn default() -> Self {
        Self { turns: 1, per_turn: 1, max_periods: None, samples: None, interpolation: Interpolation::BandLimited }
    }
}

/// Interpolations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Windowed sinc.
    #[default]
    BandLimited,
    /// Cubic spline.
    CubicSpline,
    /// Straight lines.
    Linear,
}

/// Regular orders. The defaults are the convention of most publications: mesh harmonics with their first sidebands, the
/// shaft's orders 1 and 2, and the mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Difference {
    /// Sideband pairs about every mesh harmonic that the difference signal loses.
    #[schemars(range(min = 0, max = 1000))]
    pub sideband_pairs: u32,
    /// Distance of sidebands (cycles per turn of the shaft of interest); default: `average.per_turn`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10000))]
    pub sideband_spacing: Option<u32>,
    /// Mesh harmonics that count as regular; default: all.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100000))]
    pub harmonics: Option<u32>,
    /// Shaft orders, 1 to this number (multiples of `sideband_spacing`), that count as regular.
    #[schemars(range(min = 0, max = 100000))]
    pub shaft_orders: u32,
    /// Whether the mean is regular, too.
    pub remove_mean: bool,
}

impl Default for Difference {
    fn default() -> Self {
        Self { sideband_pairs: 1, sideband_spacing: None, harmonics: None, shaft_orders: 2, remove_mean: true }
    }
}

/// Which flaws of a recording do not keep it from being judged.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Quality {
    /// Flaws, separated by commas, that are reported but do not keep channels from being judged: "clipped", "saturated", "dropout", "drift", "gap",
    /// "dead", "rate-conflict", "standstill", "time-column". Without, a channel with one of them in a harmful measure is "not judged".
    #[serde(skip_serializing_if = "String::is_empty")]
    pub accept: String,
}

/// When a value is a reason to look.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Thresholds {
    /// "prediction": limits that a further healthy recording passes with at most the probability `false_alarm_rate`, all channels and indicators
    /// together; "mean-plus-sigmas": mean and `sigmas` standard deviations of a healthy set to either side; "quantile": the middle share
    /// `quantile` of a healthy set; "gaussian": values for Gaussian noise, on residual and difference signals only. Default: with a healthy set
    /// "prediction" (or the method whose key is given), without "gaussian".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
    /// Probability that a healthy recording raises any alarm, for the methods "prediction" and "gaussian"; default 0.01.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 0.5))]
    pub false_alarm_rate: Option<f64>,
    /// Folder of recordings of the healthy state, made like the signal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub healthy: Option<String>,
    /// Number of recordings, from the first of the folder on, that are the healthy set.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 2, max = 1000000))]
    pub healthy_first: Option<u32>,
    /// Standard deviations from the mean of a healthy set, or standard errors from the value for Gaussian noise: a limit for each indicator on its
    /// own, without regard to their number. Default for the method "mean-plus-sigmas": 3.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 100.0))]
    pub sigmas: Option<f64>,
    /// Share of healthy values between the limits of the method "quantile"; default 0.99.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub quantile: Option<f64>,
    /// In a trend, an alarm needs this number of values outside their limits ...
    #[schemars(range(min = 1, max = 1000000))]
    pub alarm_hits: u32,
    /// ... among this number of the last recordings that have a value.
    #[schemars(range(min = 1, max = 1000000))]
    pub alarm_window: u32,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self {
            method: None,
            false_alarm_rate: None,
            healthy: None,
            healthy_first: None,
            sigmas: None,
            quantile: None,
            alarm_hits: 1,
            alarm_window: 1,
        }
    }
}

/// Where thresholds come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Values for Gaussian noise.
    Gaussian,
    /// Prediction interval of a healthy set.
    Prediction,
    /// Mean and standard deviation of a healthy set.
    MeanPlusSigmas,
    /// Quantile of a healthy set.
    Quantile,
}

/// Indicators with a memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Memory {
    /// For NA4* and NB4* (`na4_locked`): recordings at the beginning that are taken as healthy; default: as many as are healthy by
    /// `thresholds`, else 8.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 2, max = 1000000))]
    pub learn: Option<u32>,
    /// For NA4* and NB4*: the reference is locked once a variance is so many standard deviations above the mean of those before.
    #[schemars(range(min = 0.0, max = 100.0))]
    pub lock_sigmas: f64,
    /// Recordings, by the names of their files and separated by commas, before which the memory begins anew: after a change of load or
    /// an overhaul. Gives `na4_reset`, and `na4_locked` learns anew.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub reset_before: String,
    /// The memory begins anew, too, when the mean speed is more than this off that of its first recording (%).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 1000.0))]
    pub reset_speed_percent: Option<f64>,
}

impl Default for Memory {
    fn default() -> Self {
        Self { learn: None, lock_sigmas: 3.0, reset_before: String::new(), reset_speed_percent: None }
    }
}

/// How well indicators tell damaged from healthy recordings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Detection {
    /// Folder of recordings of the damaged state, made like the signal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damaged: Option<String>,
    /// Of a folder of recordings as signal, so many of the last are the damaged set.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000000))]
    pub damaged_last: Option<u32>,
    /// Text file with the columns "recording" (name of its file), "severity" (a number: size of damage, level of noise, ..) and, if wanted,
    /// "condition" (level of noise, load, ..): gives the probability of detection over severity, for each condition and channel. Recordings of
    /// the damaged set that are not in it are left out there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub severities: Option<String>,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Plots as SVG and PNG.
    pub plots: bool,
    /// Synchronous average, residual and difference signal of every channel as a table.
    pub averages: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self { plots: true, averages: true }
    }
}
