//! Recordings block by block: which files, which channels, which sampling rate.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hums::io::{EXTENSIONS, is_recording, open_counted, rate_of_times};

use super::error::RecordingError;
use crate::RunObserver;
use gearwright_case::recording::RecordingCase;
use gearwright_case::recording::resolve::TachometerSource;

/// Samples of a block: memory does not grow with the recording.
const BLOCK: usize = 1 << 16;

/// The recordings of a file or folder, in the order of their names.
///
/// # Errors
/// Nothing there, or nothing readable in the folder.
pub fn recordings(path: &Path, key: &'static str) -> Result<Vec<PathBuf>, RecordingError> {
    if path.is_file() {
        return Ok(vec![path.to_path_buf()]);
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

/// Hands the columns of a recording to `take`, block by block; returns the number of samples.
///
/// # Errors
/// The reader's, `take`'s, or that the run was stopped.
pub fn each_block(
    file: &Path,
    case: &RecordingCase,
    progress: &Progress<'_>,
    mut take: impl FnMut(&[Vec<f64>]) -> Result<(), RecordingError>,
) -> Result<usize, RecordingError> {
    let failed = |source| RecordingError::Read { path: file.into(), source };
    let mut reader = open_counted(file, &case.text, &progress.bytes).map_err(failed)?;
    let mut columns = vec![Vec::new(); reader.channels().len()];
    let mut samples = 0;
    loop {
        match reader.read_block(BLOCK, &mut columns).map_err(failed)? {
            0 => return Ok(samples),
            count => samples += count,
        }
        take(&columns)?;
        columns.iter_mut().for_each(Vec::clear);
        progress.block()?;
    }
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
        None => names.iter().position(|name| is_time(name)),
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
    let rate = match (case.inputs.signal.rate_hz.or(reader.rate()), time) {
        (Some(rate), _) => rate,
        (None, Some(column)) => {
            let mut head = vec![Vec::new(); names.len()];
            reader.read_block(BLOCK, &mut head).map_err(failed)?;
            rate_of_times(&head[column]).map_err(|source| RecordingError::Time {
                path: file.into(),
                channel: names[column].clone(),
                source,
            })?
        }
        (None, None) => return Err(RecordingError::Rate { path: file.into() }),
    };
    Ok(Layout { rate, judged: columns.into_iter().map(|c| (c, names[c].clone())).collect(), tachometer })
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

/// "time", "t", "Time (s)", "time_s", "t [s]".
fn is_time(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    let word = lower.split(|c: char| !c.is_ascii_alphanumeric()).find(|part| !part.is_empty());
    let rest = lower.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty()).nth(1);
    matches!(word, Some("time" | "t")) && matches!(rest, None | Some("s" | "sec" | "seconds"))
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
        for (name, expected) in
            [("Time (s)", true), ("t", true), ("time_s", true), ("time of day", false), ("x", false)]
        {
            assert_eq!(is_time(name), expected, "{name}");
        }
    }
}
