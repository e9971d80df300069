//! Recordings block by block: which files, which channels, which sampling rate.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hums::io::{BlockReader, EXTENSIONS, block_samples, is_recording, open_counted};
use hums::quality::{Finding, Flaw};
use hums::time_axis::{TimeAxis, TimeGaps, step_of};

use super::error::RecordingError;
use crate::RunObserver;
use gearwright_case::recording::RecordingCase;
use gearwright_case::recording::resolve::TachometerSource;

/// The recordings of a file or folder, in the order of their names.
///
/// # Errors
/// Nothing there, or nothing readable in the folder.
pub fn recordings(path: &Path, key: &'static str) -> Result<Vec<PathBuf>, RecordingError> {
    if path.is_file() {
        return Ok(vec![path.to_path_buf()]);
    }
    if path.exists() && !path.is_dir() {
        return Err(RecordingError::Kind { path: path.into(), message: "it is neither a file nor a folder" });
    }
    let Ok(entries) = std::fs::read_dir(path) else {
        return Err(RecordingError::Missing { path: path.into(), key });
    };
    let mut found: Vec<PathBuf> =
        entries.filter_map(|e| e.ok().map(|e| e.path())).filter(|p| p.is_file() && is_recording(p)).collect();
    found.sort_by_cached_key(|file| natural(&file.file_name().unwrap_or_default().to_string_lossy()));
    if found.is_empty() {
        return Err(RecordingError::NoRecordings { path: path.into(), known: EXTENSIONS.join(", .") });
    }
    Ok(found)
}

/// Sort key of a name in which numbers count as numbers: "run 9" goes before "run 10". The name itself settles ties.
fn natural(name: &str) -> (Vec<(u64, String)>, String) {
    let mut parts: Vec<(u64, String)> = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let text = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (before, after) = rest.split_at(text);
        let digits = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
        if !before.is_empty() {
            parts.push((u64::MAX, before.to_lowercase()));
        }
        if digits > 0 {
            parts.push((after[..digits].parse().unwrap_or(u64::MAX - 1), String::new()));
        }
        rest = &after[digits..];
    }
    (parts, name.to_owned())
}

/// Names of channels, each once: a name that came before gets its column's number.
fn told_apart(names: &[String]) -> Vec<String> {
    let repeated = |column: usize| names[..column].contains(&names[column]);
    names
        .iter()
        .enumerate()
        .map(|(column, name)| if repeated(column) { format!("{name} ({})", column + 1) } else { name.clone() })
        .collect()
}

/// Follows the bytes read, of all recordings together.
pub struct Progress<'a> {
    observer: &'a dyn RunObserver,
    bytes: Arc<AtomicU64>,
    total: u64,
}

impl<'a> Progress<'a> {
    /// Over recordings that are read `passes` times each.
    pub fn new(observer: &'a dyn RunObserver, files: &[PathBuf], passes: u64) -> Self {
        let size: u64 = files.iter().filter_map(|f| f.metadata().ok()).map(|m| m.len()).sum();
        Self { observer, bytes: Arc::default(), total: passes * size }
    }

    fn block(&self) -> Result<(), RecordingError> {
        let kilo = |bytes: u64| (bytes >> 10) as usize;
        self.observer.advanced(kilo(self.bytes.load(Ordering::Relaxed).min(self.total)), kilo(self.total));
        if self.observer.is_cancelled() { Err(RecordingError::Cancelled) } else { Ok(()) }
    }
}

/// Hands the columns of a recording to `take`, block by block, rows that are missing from its time column put in as NaN; returns the
/// number of samples and what is missing.
///
/// # Errors
/// The reader's, the time column's, `take`'s, or that the run was stopped.
pub fn each_block(
    file: &Path,
    case: &RecordingCase,
    layout: &Layout,
    progress: &Progress<'_>,
    mut take: impl FnMut(&[Vec<f64>]) -> Result<(), RecordingError>,
) -> Result<(usize, TimeGaps), RecordingError> {
    let failed = |source| RecordingError::Read { path: file.into(), source };
    let mut reader = open_counted(file, &case.text, &progress.bytes).map_err(failed)?;
    let channels = reader.channels().len();
    let mut columns = vec![Vec::new(); channels];
    let timed =
        |source, time: &TimeColumn| RecordingError::Time { path: file.into(), channel: time.name.clone(), source };
    let mut axis = match &layout.time {
        Some(time) => Some((TimeAxis::new(time.step).map_err(|e| timed(e, time))?, time)),
        None => None,
    };
    let mut samples = 0;
    loop {
        let mut count = reader.read_block(block_samples(channels), &mut columns).map_err(failed)?;
        if count == 0 {
            return Ok((samples, axis.map(|(axis, _)| axis.gaps()).unwrap_or_default()));
        }
        if let Some((axis, time)) = &mut axis {
            count += axis.complete(&mut columns, time.column, 0).map_err(|e| timed(e, time))?;
        }
        samples += count;
        take(&columns)?;
        columns.iter_mut().for_each(Vec::clear);
        progress.block()?;
    }
}

/// A time column.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeColumn {
    /// Where.
    pub column: usize,
    /// Its name.
    pub name: String,
    /// Its step, in its own unit.
    pub step: f64,
}

/// Which channels of a recording are what.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Sampling rate (Hz).
    pub rate: f64,
    /// Channels to judge: column and name.
    pub judged: Vec<(usize, String)>,
    /// Column of the tachometer.
    pub tachometer: Option<usize>,
    /// The time column.
    pub time: Option<TimeColumn>,
    /// What is odd about the recording as a whole.
    pub findings: Vec<Finding>,
}

/// Memory for the channels judged at most (bytes).
const MAX_MEMORY: u64 = 4 << 30;

/// Memory that `channels` channels with `period` samples in a period take at most (bytes): two periods and their sums, a block of statistics, their share
/// of a block.
fn memory(channels: usize, period: f64) -> u64 {
    let each = 8.0 * (6.0 * period + 2.0 * hums::moments::BLOCK as f64) + 16_384.0;
    (channels as f64 * each) as u64
}

/// Refuses more channels than [`MAX_MEMORY`] holds.
///
/// # Errors
/// [`RecordingError::Memory`].
pub fn check_memory(file: &Path, channels: usize, period: f64) -> Result<(), RecordingError> {
    let bytes = memory(channels, period);
    if bytes <= MAX_MEMORY {
        return Ok(());
    }
    Err(RecordingError::Memory { path: file.into(), channels, needed: bytes >> 20, allowed: MAX_MEMORY >> 20 })
}

/// Looks at the head of a recording.
///
/// # Errors
/// Unreadable, unknown channels, no sampling rate.
pub fn layout(file: &Path, case: &RecordingCase) -> Result<Layout, RecordingError> {
    let failed = |source| RecordingError::Read { path: file.into(), source };
    let mut reader = open_counted(file, &case.text, &Arc::default()).map_err(failed)?;
    let names = told_apart(reader.channels());
    let find = |wanted: &str| {
        channel(&names, wanted).ok_or_else(|| RecordingError::Channel {
            path: file.into(),
            wanted: wanted.into(),
            known: listed(&names),
        })
    };
    let tachometer = match &case.tachometer {
        TachometerSource::Channel(name, _) => Some(find(name)?),
        _ => None,
    };
    let time = match &case.inputs.signal.time_channel {
        Some(name) => Some(find(name)?),
        None => names.iter().position(|name| time_unit(name).is_some()),
    };
    let columns: Vec<usize> = if case.channels.is_empty() {
        (0..names.len()).filter(|c| Some(*c) != tachometer && Some(*c) != time).collect()
    } else {
        let mut columns = Vec::new();
        for name in &case.channels {
            let column = find(name)?;
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
        columns
    };
    if columns.is_empty() {
        return Err(RecordingError::NoChannels { path: file.into(), known: listed(&names) });
    }
    let note = |detail: &String| Finding { flaw: Flaw::LeftOut, blocks: false, detail: detail.clone() };
    let mut findings: Vec<Finding> = reader.notes().iter().map(note).collect();
    let of_file = reader.rate();
    let given = case.inputs.signal.rate_hz;
    let (mut axis, mut of_time) = (None, None);
    if let Some(column) = time {
        match head_step(reader.as_mut(), column).map_err(failed)? {
            Ok(step) => {
                of_time = Some(1.0 / (step * time_unit(&names[column]).unwrap_or(1.0)));
                axis = Some(TimeColumn { column, name: names[column].clone(), step });
            }
            // Another rate makes up for it.
            Err(fault) if given.or(of_file).is_some() => {
                let detail = format!("\"{}\" is of no use: {fault}", names[column]);
                findings.push(Finding { flaw: Flaw::TimeColumn, blocks: false, detail });
            }
            Err(source) => {
                return Err(RecordingError::Time { path: file.into(), channel: names[column].clone(), source });
            }
        }
    }
    let sources = [("signal.rate_hz", given), ("the file", of_file), ("the time column", of_time)];
    let mut known = sources.iter().filter_map(|(name, rate)| Some((name, (*rate)?)));
    let Some((first, rate)) = known.next() else { return Err(RecordingError::Rate { path: file.into() }) };
    for (name, other) in known {
        if (other / rate - 1.0).abs() > RATE_TOLERANCE {
            let detail = format!("{first} says {rate} Hz, {name} {other} Hz");
            findings.push(Finding { flaw: Flaw::RateConflict, blocks: true, detail });
        }
    }
    let judged = columns.into_iter().map(|c| (c, names[c].clone())).collect();
    Ok(Layout { rate, judged, tachometer, time: axis, findings })
}

/// Relative difference of two sampling rates that is a conflict.
const RATE_TOLERANCE: f64 = 1e-3;
/// Rows at the head of a recording that give the step of its time column.
const HEAD: usize = 1 << 16;

/// Step of a time column from the head of a recording.
fn head_step(reader: &mut dyn BlockReader, column: usize) -> Result<hums::Result<f64>, hums::io::ReadError> {
    let channels = reader.channels().len();
    let mut block = vec![Vec::new(); channels];
    let mut times = Vec::new();
    while times.len() < HEAD && reader.read_block(block_samples(channels), &mut block)? > 0 {
        times.extend_from_slice(&block[column]);
        block.iter_mut().for_each(Vec::clear);
    }
    Ok(step_of(&times))
}

/// Column of a channel given by name (any case if that is not ambiguous) or by number from 1.
fn channel(names: &[String], wanted: &str) -> Option<usize> {
    let same = |name: &String| name.trim().eq_ignore_ascii_case(wanted);
    let by_name = names.iter().position(|name| name.trim() == wanted).or_else(|| {
        let mut alike = names.iter().enumerate().filter(|(_, name)| same(name)).map(|(column, _)| column);
        alike.next().filter(|_| alike.next().is_none())
    });
    by_name.or_else(|| wanted.parse::<usize>().ok()?.checked_sub(1).filter(|column| *column < names.len()))
}

fn listed(names: &[String]) -> String {
    const MOST: usize = 24;
    let mut text = names.iter().take(MOST).map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    if names.len() > MOST {
        text.push_str(&format!(" and {} more", names.len() - MOST));
    }
    text
}

/// Unit (s) of a channel whose name is that of a time: "time", "t", "Time (s)", "time_ms", "t [us]".
fn time_unit(name: &str) -> Option<f64> {
    let lower = name.to_ascii_lowercase();
    let mut words = lower.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
    if !matches!(words.next(), Some("time" | "t")) {
        return None;
    }
    match words.next() {
        None | Some("s" | "sec" | "seconds") => Some(1.0),
        Some("ms") => Some(1e-3),
        Some("us") => Some(1e-6),
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["run 10.csv", "run 9.csv", "Run 9b.csv", "7.csv", "run.csv", "run 010.csv"];
        names.sort_by_cached_key(|name| natural(name));
        assert_eq!(names, ["7.csv", "run 9.csv", "Run 9b.csv", "run 010.csv", "run 10.csv", "run.csv"]);
    }

    #[test]
    fn equal_names_are_told_apart() {
        let names = ["x", "y", "x", "x"].map(String::from);
        assert_eq!(told_apart(&names), ["x", "y", "x (3)", "x (4)"]);
    }

    #[test]
    fn channels_by_name_case_and_number() {
        let names: Vec<String> = ["Time (s)", "x", "X", "Tacho", "2"].map(String::from).to_vec();
        assert_eq!(channel(&names, "x"), Some(1));
        assert_eq!(channel(&names, "tacho"), Some(3));
        assert_eq!(channel(&names, "2"), Some(4), "a name goes before a number");
        assert_eq!(channel(&names, "3"), Some(2));
        assert_eq!(channel(&names, "0"), None);
        assert_eq!(channel(&names, "6"), None);
        for (name, expected) in [
            ("Time (s)", Some(1.0)),
            ("t", Some(1.0)),
            ("time_ms", Some(1e-3)),
            ("t [us]", Some(1e-6)),
            ("time of day", None),
            ("x", None),
        ] {
            assert_eq!(time_unit(name), expected, "{name}");
        }
    }
}
