//! Streaming readers for recordings (feature `io`): CSV/TSV, WAV, NPY, MAT v5, Parquet.
//!
//! Problem. Recordings come in many dressings and are larger than memory. Every reader here hands out
//! blocks of samples, one column a channel, and holds one block:
//!
//! | format | streamed | notes |
//! |---|---|---|
//! | text ([`text`]) | yes | delimiter, decimal comma, header, units, comments found by themselves |
//! | WAV ([`wav`]) | yes | 8 to 32 bits whole, 32 and 64 bits float; whole numbers scaled to -1..1 |
//! | NPY ([`npy`]) | yes | 1-D or 2-D; the longer axis is time |
//! | MAT v5 ([`mat`]) | yes, compressed or not | vectors and matrices of numbers |
//! | Parquet ([`parquet`]) | by pages | columns of whole numbers, floats, truth values, times |
//!
//! Missing values come out as NaN, for [`crate::quality`] to find; anything else that is not
//! a number is an error naming line and column.
//! Verified by `tests/io.rs` (round trips and damaged files).

pub mod mat;
pub mod npy;
mod number;
pub mod parquet;
mod stretch;
pub mod text;
pub mod wav;

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Extensions of the formats read.
pub const EXTENSIONS: [&str; 11] = ["csv", "tsv", "txt", "dat", "asc", "wav", "wave", "npy", "mat", "parquet", "pq"];

/// Why a recording could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system refused.
    #[error("failed to read {path}")]
    File {
        /// Which file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// A pipe, a device, a folder: only regular files are read.
    #[error("{path} is no regular file")]
    NotRegular {
        /// Which.
        path: PathBuf,
    },
    /// Reading broke off.
    #[error("failed to read the recording")]
    Io(#[from] std::io::Error),
    /// The file is not what its name says, or is damaged.
    #[error("not a readable {format} recording: {reason}")]
    Format {
        /// Format expected.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A cell of a text file is not a number.
    #[error("line {line}, column {column}: `{text}` is not a number")]
    Cell {
        /// Line, from 1.
        line: u64,
        /// Column, from 1.
        column: usize,
        /// What is there (at most 40 characters).
        text: String,
    },
    /// A line of a text file has another number of columns than the first.
    #[error("line {line} has {found} columns, the recording has {expected}")]
    Row {
        /// Line, from 1.
        line: u64,
        /// Columns found.
        found: usize,
        /// Columns of the first data line.
        expected: usize,
    },
    /// The caller's columns do not match the recording's channels.
    #[error("{given} columns given for {channels} channels")]
    Columns {
        /// Columns given.
        given: usize,
        /// Channels of the recording.
        channels: usize,
    },
    /// The extension of the file is not known.
    #[error("cannot tell the format of {path} from its name; known: csv, tsv, txt, dat, asc, wav, npy, mat, parquet")]
    UnknownExtension {
        /// Which file.
        path: PathBuf,
    },
}

/// Numbers of a block, all channels together: 32 MiB.
pub const BLOCK_VALUES: usize = 1 << 22;

/// Samples a channel of a block, so that memory is bounded whatever the number of channels.
#[must_use]
pub fn block_samples(channels: usize) -> usize {
    (BLOCK_VALUES / channels.max(1)).clamp(64, 1 << 16)
}

/// Hands out a recording block by block.
pub trait BlockReader {
    /// Names of the channels, in order.
    fn channels(&self) -> &[String];

    /// Sampling rate stated by the file, Hz.
    fn rate(&self) -> Option<f64>;

    /// What the file holds besides, and is not read (arrays of another length, ..).
    fn notes(&self) -> &[String] {
        &[]
    }

    /// Appends at most `samples` samples to each column (one column a channel) and returns their
    /// number; 0 at the end.
    ///
    /// # Errors
    /// [`ReadError`]; what was appended before it stays and is good.
    fn read_block(&mut self, samples: usize, columns: &mut [Vec<f64>]) -> std::result::Result<usize, ReadError>;
}

/// A whole recording in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Names of the channels.
    pub names: Vec<String>,
    /// Sampling rate stated by the file, Hz.
    pub rate: Option<f64>,
    /// Samples of each channel, all of one length.
    pub channels: Vec<Vec<f64>>,
}

/// Whether a file has one of the [`EXTENSIONS`].
#[must_use]
pub fn is_recording(path: &Path) -> bool {
    EXTENSIONS.contains(&extension(path).as_str())
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Opens a recording by its extension.
///
/// # Errors
/// [`ReadError`].
pub fn open(path: &Path, options: &text::TextOptions) -> std::result::Result<Box<dyn BlockReader>, ReadError> {
    open_counted(path, options, &Arc::default())
}

/// As [`open`], and adds the bytes taken from the file to `bytes`, for progress.
///
/// # Errors
/// [`ReadError`].
pub fn open_counted(
    path: &Path,
    options: &text::TextOptions,
    bytes: &Arc<AtomicU64>,
) -> std::result::Result<Box<dyn BlockReader>, ReadError> {
    if !is_recording(path) {
        return Err(ReadError::UnknownExtension { path: path.into() });
    }
    let inner = open_regular(path)?;
    let extension = extension(path);
    if matches!(extension.as_str(), "parquet" | "pq") {
        return Ok(Box::new(parquet::ParquetRecording::new(inner, bytes)?));
    }
    let file = Counted { inner, bytes: Arc::clone(bytes) };
    Ok(match extension.as_str() {
        "wav" | "wave" => Box::new(wav::WavRecording::new(BufReader::with_capacity(BUFFER, file))?),
        "npy" => npy::open(file)?,
        "mat" => mat::open(file)?,
        _ => Box::new(text::TextReader::new(file, options)?),
    })
}

/// Opens a file, but no pipe and no device: those may never end, and cannot be read twice.
///
/// # Errors
/// [`ReadError::NotRegular`], [`ReadError::File`].
fn open_regular(path: &Path) -> std::result::Result<File, ReadError> {
    let failed = |source| ReadError::File { path: path.into(), source };
    // Asked before it is opened: opening a pipe waits for its other end.
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err(ReadError::NotRegular { path: path.into() });
    }
    File::open(path).map_err(failed)
}

/// Bytes taken from a file at a time.
const BUFFER: usize = 1 << 17;

/// A file that counts what is read from it.
struct Counted {
    inner: File,
    bytes: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.bytes.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

impl Seek for Counted {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.inner.seek(to)
    }
}

/// Whether a name in a file's own metadata means the sampling rate (any case).
fn is_rate_name(name: &str) -> bool {
    const NAMES: [&str; 7] =
        ["fs", "rate", "rate_hz", "sample_rate", "samplerate", "sampling_rate", "sampling_rate_hz"];
    NAMES.contains(&name.to_ascii_lowercase().as_str())
}

/// Reads everything that is left.
///
/// # Errors
/// [`ReadError`].
pub fn read_all(reader: &mut dyn BlockReader) -> std::result::Result<Recording, ReadError> {
    let mut channels = vec![Vec::new(); reader.channels().len()];
    let samples = block_samples(channels.len());
    while reader.read_block(samples, &mut channels)? > 0 {}
    Ok(Recording { names: reader.channels().to_vec(), rate: reader.rate(), channels })
}

fn check_columns(channels: usize, columns: &[Vec<f64>]) -> std::result::Result<(), ReadError> {
    if channels == columns.len() { Ok(()) } else { Err(ReadError::Columns { given: columns.len(), channels }) }
}

fn numbered(count: usize) -> Vec<String> {
    (1..=count).map(|i| format!("channel {i}")).collect()
}
