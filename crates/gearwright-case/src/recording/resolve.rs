//! From keys to what the signal library takes: defaults filled in, orders of the averaging period worked out, faults told at their keys.
//!
//! Files are looked for when the case runs: a case may be written before its recording is made.

use std::path::{Path, PathBuf};

use hums::difference::{RemovalRule, whole_mesh_order};
use hums::io::text::TextOptions;
use hums::quality::Flaw;
use hums::resample::Interpolation;
use hums::tachometer::{Edge, PulseOptions};

use super::notes::notes;
use super::schema::{self, Delimiter, Method, Recording};
use crate::document::Node;
use crate::fault::Fault;
use crate::notes::Notes;

/// A recording case, ready to run.
#[derive(Debug, Clone)]
pub struct RecordingCase {
    /// The case with every default filled in.
    pub inputs: Recording,
    /// Recording, or folder of recordings.
    pub signal: PathBuf,
    /// How text files are written.
    pub text: TextOptions,
    /// Channels to judge, by name or number; empty for all.
    pub channels: Vec<String>,
    /// How the shaft turned.
    pub tachometer: TachometerSource,
    /// Length of the averaging period (turns of the shaft of interest).
    pub period_turns: f64,
    /// How to interpolate.
    pub interpolation: Interpolation,
    /// Regular orders (cycles per period); the first mesh order is the gear's.
    pub rule: RemovalRule,
    /// Flaws that do not keep channels from being judged.
    pub accepted: Vec<Flaw>,
    /// Where thresholds come from.
    pub limits: LimitSource,
    /// How indicators with a memory keep it.
    pub memory: MemoryPlan,
    /// What detection is measured on.
    pub detection: Option<DetectionPlan>,
    /// Warnings and assumptions.
    pub notes: Notes,
}

/// How indicators with a memory keep it.
#[derive(Debug, Clone, PartialEq)]
pub struct MemoryPlan {
    /// Recordings that NA4* and NB4* learn from.
    pub learn: Option<usize>,
    /// Limit of NA4* and NB4* (standard deviations of healthy variances).
    pub lock_sigmas: f64,
    /// Names of recordings before which it begins anew.
    pub reset_before: Vec<String>,
    /// Relative change of speed at which it begins anew.
    pub reset_speed: Option<f64>,
}

/// What detection is measured on.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectionPlan {
    /// Damaged recordings.
    pub damaged: DamagedSet,
    /// Table of severities.
    pub severities: Option<PathBuf>,
}

/// Which recordings are damaged.
#[derive(Debug, Clone, PartialEq)]
pub enum DamagedSet {
    /// Those of a folder.
    Folder(PathBuf),
    /// So many of the last of the trend.
    Last(usize),
}

/// How the shaft turned.
#[derive(Debug, Clone, PartialEq)]
pub enum TachometerSource {
    /// Pulses in a channel of the recording.
    Channel(String, PulseOptions),
    /// Times of pulses in a file, or in files of a folder.
    File(PathBuf),
    /// Constant speed (Hz).
    Speed(f64),
}

/// Where thresholds come from.
#[derive(Debug, Clone, PartialEq)]
pub enum LimitSource {
    /// Values for Gaussian noise.
    Gaussian(GaussianLimit),
    /// A healthy set.
    Healthy(HealthySet, HealthyLimit),
}

/// Which recordings are healthy.
#[derive(Debug, Clone, PartialEq)]
pub enum HealthySet {
    /// Those of a folder.
    Folder(PathBuf),
    /// So many of the first of the trend.
    First(usize),
}

/// How values for Gaussian noise become limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GaussianLimit {
    /// Probability of any alarm on a healthy recording.
    FalseAlarms(f64),
    /// Standard errors, each indicator on its own.
    Sigmas(f64),
}

/// What a healthy set says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HealthyLimit {
    /// Prediction limits: probability of any alarm on a healthy recording.
    FalseAlarms(f64),
    /// Mean and so many standard deviations.
    MeanPlusSigmas(f64),
    /// Quantile.
    Quantile(f64),
}

/// Resolves a case; `folder` is where files it refers to are looked for.
///
/// # Errors
/// All faults that can be told together.
pub fn resolve(mut inputs: Recording, document: &Node, folder: &Path) -> Result<RecordingCase, Vec<Fault>> {
    let mut faults = Vec::new();
    if inputs.signal.file.trim().is_empty() {
        faults.push(document.fault("signal.file", "name a recording, or a folder of recordings"));
    }
    let spacing = *inputs.difference.sideband_spacing.get_or_insert(inputs.average.per_turn);
    let channels = names(&inputs.signal.channels);
    let tachometer = tachometer(&inputs.tachometer, document, folder, &mut faults);
    let rule = rule(&inputs, spacing, document, &mut faults);
    let limits = limits(&mut inputs.thresholds, document, folder, &mut faults);
    let accepted = accepted(&inputs.quality.accept, document, &mut faults);
    if let Some(angle) = inputs.signal.angles_deg.iter().find(|angle| !(angle.abs() <= 3600.0)) {
        faults.push(document.fault("signal.angles_deg", format!("{angle}: must be within -3600 and 3600")));
    }
    if !channels.is_empty() && !inputs.signal.angles_deg.is_empty() && channels.len() != inputs.signal.angles_deg.len()
    {
        let (angles, channels) = (inputs.signal.angles_deg.len(), channels.len());
        let message = format!("has {angles} numbers for the {channels} channels of signal.channels; give one for each");
        faults.push(document.fault("signal.angles_deg", message));
    }
    let detection = detection(&inputs, document, folder, &mut faults);
    let memory = memory(&inputs.memory);
    let (Some(tachometer), Some(rule), Some(limits), true) = (tachometer, rule, limits, faults.is_empty()) else {
        return Err(faults);
    };
    let text = TextOptions {
        delimiter: inputs.signal.delimiter.map(|delimiter| match delimiter {
            Delimiter::Comma => b',',
            Delimiter::Semicolon => b';',
            Delimiter::Tab => b'\t',
            Delimiter::Blank => b' ',
        }),
        decimal_comma: inputs.signal.decimal_comma,
        header_lines: inputs.signal.header_lines.map(|lines| lines as usize),
    };
    let mut case = RecordingCase {
        signal: folder.join(inputs.signal.file.trim()),
        text,
        channels,
        tachometer,
        period_turns: f64::from(inputs.average.turns) / f64::from(inputs.average.per_turn),
        interpolation: match inputs.average.interpolation {
            schema::Interpolation::BandLimited => Interpolation::default(),
            schema::Interpolation::CubicSpline => Interpolation::CubicSpline,
            schema::Interpolation::Linear => Interpolation::Linear,
        },
        rule,
        accepted,
        limits,
        memory,
        detection,
        inputs,
        notes: Notes::default(),
    };
    case.notes = notes(&case, document);
    Ok(case)
}

/// Defaults of `thresholds.false_alarm_rate`, `sigmas` and `quantile`.
const FALSE_ALARM_RATE: f64 = 0.01;
const SIGMAS: f64 = 3.0;
const QUANTILE: f64 = 0.99;

fn names(list: &str) -> Vec<String> {
    list.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
}

/// Flaws named in `quality.accept`.
fn accepted(list: &str, document: &Node, faults: &mut Vec<Fault>) -> Vec<Flaw> {
    let mut found = Vec::new();
    for name in names(list) {
        match Flaw::ALL.iter().find(|flaw| flaw.name() == name) {
            Some(flaw) => found.push(*flaw),
            None => {
                let known = Flaw::ALL.map(|flaw| flaw.name()).join(", ");
                faults.push(document.fault("quality.accept", format!("there is no flaw \"{name}\"; known: {known}")));
            }
        }
    }
    found
}

fn memory(written: &schema::Memory) -> MemoryPlan {
    MemoryPlan {
        learn: written.learn.map(|count| count as usize),
        lock_sigmas: written.lock_sigmas,
        reset_before: names(&written.reset_before),
        reset_speed: written.reset_speed_percent.map(|percent| percent / 100.0),
    }
}

fn detection(inputs: &Recording, document: &Node, folder: &Path, faults: &mut Vec<Fault>) -> Option<DetectionPlan> {
    let written = &inputs.detection;
    let damaged = match (&written.damaged, written.damaged_last) {
        (Some(_), Some(_)) => {
            faults.push(document.fault("detection.damaged_last", "give either damaged or damaged_last, not both"));
            return None;
        }
        (Some(name), None) => DamagedSet::Folder(folder.join(name)),
        (None, Some(count)) => DamagedSet::Last(count as usize),
        (None, None) => {
            if written.severities.is_some() {
                let message = "needs a damaged set: give detection.damaged or detection.damaged_last";
                faults.push(document.fault("detection.severities", message));
            }
            return None;
        }
    };
    if inputs.thresholds.healthy.is_none() && inputs.thresholds.healthy_first.is_none() {
        let message = "needs a healthy set to compare with: give thresholds.healthy or thresholds.healthy_first";
        faults.push(document.fault("detection", message));
    }
    Some(DetectionPlan { damaged, severities: written.severities.as_ref().map(|name| folder.join(name)) })
}

fn tachometer(
    written: &schema::Tachometer,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<TachometerSource> {
    if written.hysteresis.is_some_and(|width| width <= 0.0) {
        faults.push(document.fault("tachometer.hysteresis", "must be above 0"));
    }
    let source = match (&written.channel, &written.file, written.speed_hz) {
        (Some(channel), None, None) => {
            let edge = match written.edge {
                schema::Edge::Rising => Edge::Rising,
                schema::Edge::Falling => Edge::Falling,
            };
            let options = PulseOptions { level: written.level, hysteresis: written.hysteresis, edge };
            TachometerSource::Channel(channel.trim().to_owned(), options)
        }
        (None, Some(file), None) => TachometerSource::File(folder.join(file)),
        (None, None, Some(speed)) => TachometerSource::Speed(speed),
        (None, None, None) => {
            let message = "give one of channel (pulses in the recording), file (times of pulses) and speed_hz";
            faults.push(document.fault("tachometer", message));
            return None;
        }
        _ => {
            faults.push(document.fault("tachometer", "give only one of channel, file and speed_hz"));
            return None;
        }
    };
    Some(source)
}

/// Orders in cycles per averaging period.
fn rule(inputs: &Recording, spacing: u32, document: &Node, faults: &mut Vec<Fault>) -> Option<RemovalRule> {
    let before = faults.len();
    let (turns, per_turn) = (u64::from(inputs.average.turns), u64::from(inputs.average.per_turn));
    let per_period = |cycles: u32| (u64::from(cycles) * turns) as f64 / per_turn as f64;
    let mesh = whole_mesh_order(per_period(inputs.gear.teeth)).map_err(|_| {
        let message = format!(
            "{} teeth make {} mesh cycles in a period of {turns}/{per_turn} turns, which must be a whole number; raise average.turns",
            inputs.gear.teeth,
            per_period(inputs.gear.teeth)
        );
        faults.push(document.fault("average.per_turn", message));
    });
    let spacing = whole_mesh_order(per_period(spacing)).map_err(|_| {
        let message = format!("must be a whole number of cycles in a period of {turns}/{per_turn} turns");
        faults.push(document.fault("difference.sideband_spacing", message));
    });
    let (Ok(mesh), Ok(spacing)) = (mesh, spacing) else { return None };
    let pairs = inputs.difference.sideband_pairs as usize;
    if 2 * pairs * spacing >= mesh.max(2) {
        let most = mesh.saturating_sub(1) / (2 * spacing);
        let message = format!(
            "must be at most {most}: with {mesh} mesh cycles a period, more sidebands would remove every order"
        );
        faults.push(document.fault("difference.sideband_pairs", message));
    }
    let rule = RemovalRule {
        mesh_orders: vec![mesh],
        harmonics: inputs.difference.harmonics.map_or(usize::MAX, |count| count as usize),
        sideband_pairs: pairs,
        sideband_spacing: spacing,
        shaft_orders: inputs.difference.shaft_orders as usize,
        remove_mean: inputs.difference.remove_mean,
    };
    (faults.len() == before).then_some(rule)
}

fn limits(
    written: &mut schema::Thresholds,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<LimitSource> {
    let before = faults.len();
    if written.alarm_hits > written.alarm_window {
        let message = format!("must be at most alarm_window = {}", written.alarm_window);
        faults.push(document.fault("thresholds.alarm_hits", message));
    }
    let set = match (&written.healthy, written.healthy_first) {
        (Some(_), Some(_)) => {
            faults.push(document.fault("thresholds.healthy_first", "give either healthy or healthy_first, not both"));
            return None;
        }
        (Some(name), None) => Some(HealthySet::Folder(folder.join(name))),
        (None, Some(count)) => Some(HealthySet::First(count as usize)),
        (None, None) => None,
    };
    let natural = match (&set, written.sigmas, written.quantile) {
        (None, ..) => Method::Gaussian,
        (Some(_), Some(_), _) => Method::MeanPlusSigmas,
        (Some(_), None, Some(_)) => Method::Quantile,
        (Some(_), None, None) => Method::Prediction,
    };
    let method = *written.method.get_or_insert(natural);
    let source = match (method, set) {
        (Method::Gaussian, None) => LimitSource::Gaussian(match written.sigmas {
            Some(sigmas) => GaussianLimit::Sigmas(sigmas),
            None => GaussianLimit::FalseAlarms(*written.false_alarm_rate.get_or_insert(FALSE_ALARM_RATE)),
        }),
        (Method::Gaussian, Some(_)) => {
            let message = "the method \"gaussian\" needs no healthy set; choose \"prediction\", \"mean-plus-sigmas\" or \"quantile\"";
            faults.push(document.fault("thresholds.method", message));
            return None;
        }
        (_, None) => {
            let message = "this method needs a healthy set: give thresholds.healthy or thresholds.healthy_first";
            faults.push(document.fault("thresholds.method", message));
            return None;
        }
        (Method::Prediction, Some(set)) => {
            let rate = *written.false_alarm_rate.get_or_insert(FALSE_ALARM_RATE);
            LimitSource::Healthy(set, HealthyLimit::FalseAlarms(rate))
        }
        (Method::MeanPlusSigmas, Some(set)) => {
            LimitSource::Healthy(set, HealthyLimit::MeanPlusSigmas(*written.sigmas.get_or_insert(SIGMAS)))
        }
        (Method::Quantile, Some(set)) => {
            LimitSource::Healthy(set, HealthyLimit::Quantile(*written.quantile.get_or_insert(QUANTILE)))
        }
    };
    (faults.len() == before).then_some(source)
}
