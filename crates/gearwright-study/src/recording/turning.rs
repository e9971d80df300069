//! How the shaft of interest turned: from pulses in a channel, pulse times in a file, or a constant speed.

use std::path::{Path, PathBuf};

use hums::io::{is_recording, open, read_all};
use hums::quality::{Finding, Flaw};
use hums::tachometer::{PulseFinder, PulseOptions, RepairedPulses, Shaft, repair};

use super::error::RecordingError;
use super::source::{Layout, Progress, each_block};
use gearwright_case::recording::RecordingCase;
use gearwright_case::recording::resolve::TachometerSource;
use gearwright_results::recording::Pulses;

/// Longest recording for which a constant-speed shaft is laid out (samples).
const LONGEST: usize = 1 << 40;

/// The shaft of interest.
#[derive(Debug, Clone)]
pub struct Turning {
    /// Angle over time.
    pub shaft: Shaft,
    /// Pulses behind it.
    pub pulses: Option<Pulses>,
    /// Standstills.
    pub findings: Vec<Finding>,
}

/// Times that a recording is read.
#[must_use]
pub fn passes(case: &RecordingCase) -> u64 {
    match &case.tachometer {
        TachometerSource::Channel(_, PulseOptions { level: Some(_), hysteresis: Some(_), .. }) => 2,
        TachometerSource::Channel(..) => 3,
        _ => 1,
    }
}

/// Finds out how the shaft of interest turned during a recording.
///
/// # Errors
/// No pulses, too few, or more faulty ones than can be repaired.
pub fn turning(
    file: &Path,
    case: &RecordingCase,
    layout: &Layout,
    progress: &Progress<'_>,
) -> Result<Turning, RecordingError> {
    let tachometer = &case.inputs.tachometer;
    let ratio = tachometer.gear_ratio / tachometer.gear_ratio_divisor;
    let (what, times) = match &case.tachometer {
        TachometerSource::Speed(speed) => {
            let shaft = Shaft::constant(*speed, LONGEST, layout.rate).and_then(|shaft| shaft.geared(ratio));
            let failed = |source| RecordingError::Parameter { path: file.into(), key: "tachometer.speed_hz", source };
            return Ok(Turning { shaft: shaft.map_err(failed)?, pulses: None, findings: Vec::new() });
        }
        TachometerSource::Channel(name, options) => {
            (format!("channel \"{name}\""), channel_pulses(file, case, layout, options, progress))
        }
        TachometerSource::File(times) => {
            let times = if times.is_dir() { beside(times, file)? } else { times.clone() };
            (times.display().to_string(), file_pulses(&times, case))
        }
    };
    let failed = |source| RecordingError::Tachometer { path: file.into(), what: what.clone(), source };
    let times = times?.map_err(failed)?;
    let mut repaired: RepairedPulses = repair(&times).map_err(failed)?;
    let pulses = Pulses { found: times.len(), missing: repaired.missing, extra: repaired.extra };
    let findings = standstill(&repaired).into_iter().collect();
    // A pulse for every whole period keeps the phase across a hole; otherwise it is lost there.
    let periods = ratio / tachometer.pulses_per_turn / case.period_turns;
    if !repaired.holes.is_empty() && (periods - periods.round()).abs() > 1e-9 * periods {
        repaired = repaired.longest_stretch();
    }
    let shaft = Shaft::from_repaired(&repaired, tachometer.pulses_per_turn).map_err(failed)?;
    let shaft = shaft.geared(ratio).map_err(failed)?;
    Ok(Turning { shaft, pulses: Some(pulses), findings })
}

fn standstill(pulses: &RepairedPulses) -> Option<Finding> {
    let first = *pulses.holes.first()?;
    let length = |&hole: &usize| pulses.times[hole + 1] - pulses.times[hole];
    let total: f64 = pulses.holes.iter().map(length).sum();
    let detail = format!(
        "no pulses for {total:.3} s in {} places, first {:.3} s from {:.3} s on (standstill, or pulses lost); left out",
        pulses.holes.len(),
        length(&first),
        pulses.times[first]
    );
    Some(Finding { flaw: Flaw::Standstill, blocks: false, detail })
}

/// Pulse times, or why the channel has none.
type Times = Result<hums::Result<Vec<f64>>, RecordingError>;

fn channel_pulses(
    file: &Path,
    case: &RecordingCase,
    layout: &Layout,
    options: &PulseOptions,
    progress: &Progress<'_>,
) -> Times {
    let column = layout.tachometer.unwrap_or_default();
    let (level, band) = match (options.level, options.hysteresis) {
        (Some(level), Some(band)) => (level, band),
        _ => {
            let mut range = (f64::INFINITY, f64::NEG_INFINITY);
            each_block(file, case, layout, progress, |columns| {
                for x in columns[column].iter().filter(|x| x.is_finite()) {
                    range = (range.0.min(*x), range.1.max(*x));
                }
                Ok(())
            })?;
            if !(range.0 < range.1) {
                let reason = "the channel is constant or empty: there are no pulses in it";
                return Ok(Err(hums::HumsError::Tachometer { reason, index: 0 }));
            }
            let (middle, quarter) = (range.0 / 2.0 + range.1 / 2.0, (range.1 / 2.0 - range.0 / 2.0) / 2.0);
            (options.level.unwrap_or(middle), options.hysteresis.unwrap_or(quarter))
        }
    };
    let mut finder = match PulseFinder::new(layout.rate, level, band, options.edge) {
        Ok(finder) => finder,
        Err(error) => return Ok(Err(error)),
    };
    let mut times = Vec::new();
    each_block(file, case, layout, progress, |columns| {
        finder.push(&columns[column], &mut times);
        Ok(())
    })?;
    Ok(Ok(times))
}

fn file_pulses(times: &Path, case: &RecordingCase) -> Times {
    if !times.is_file() {
        return Err(RecordingError::Missing { path: times.into(), key: "tachometer.file (--tach)" });
    }
    let failed = |source| RecordingError::Read { path: times.into(), source };
    let mut reader = open(times, &case.text).map_err(failed)?;
    let mut recording = read_all(reader.as_mut()).map_err(failed)?;
    Ok(Ok(if recording.channels.is_empty() { Vec::new() } else { recording.channels.swap_remove(0) }))
}

/// The file of a folder that has a recording's name up to the extension.
fn beside(folder: &Path, file: &Path) -> Result<PathBuf, RecordingError> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(|e| e.ok().map(|e| e.path()));
    let mut alike: Vec<PathBuf> = entries.filter(|p| is_recording(p) && p.file_stem() == file.file_stem()).collect();
    alike.sort();
    alike.into_iter().next().ok_or_else(|| RecordingError::Missing {
        path: folder.join(file.file_name().unwrap_or_default()),
        key: "tachometer.file (--tach): pulse times of this recording are missing",
    })
}
