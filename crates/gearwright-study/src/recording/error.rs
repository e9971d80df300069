//! What can be wrong with a recording, and what to do about it.

use std::path::PathBuf;

use hums::HumsError;
use hums::io::ReadError;
use thiserror::Error;

/// Why a recording gives no indicators. Every message names the file and the remedy.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// A file or folder is not there.
    #[error("{path}: there is no such file or folder; correct {key}")]
    Missing {
        /// Where it was looked for.
        path: PathBuf,
        /// Key and flag that name it.
        key: &'static str,
    },
    /// A folder holds no recordings.
    #[error("{path}: there are no recordings in this folder; read are files named .{known}")]
    NoRecordings {
        /// The folder.
        path: PathBuf,
        /// Extensions that are read.
        known: String,
    },
    /// A folder where a file is needed, or the reverse.
    #[error("{path}: {message}")]
    Kind {
        /// Which.
        path: PathBuf,
        /// What is needed.
        message: &'static str,
    },
    /// The reader refused.
    #[error("{path}: the recording cannot be read")]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        #[source]
        source: ReadError,
    },
    /// A channel that the recording does not have.
    #[error("{path}: there is no channel \"{wanted}\"; its channels are {known} (names or numbers from 1 will do)")]
    Channel {
        /// Which file.
        path: PathBuf,
        /// Channel asked for.
        wanted: String,
        /// Channels of the recording.
        known: String,
    },
    /// More channels than memory is set aside for.
    #[error(
        "{path}: {channels} channels take {needed} MiB, {allowed} MiB are allowed; choose some with signal.channels (--channel)"
    )]
    Memory {
        /// Which file.
        path: PathBuf,
        /// Channels to judge.
        channels: usize,
        /// Memory they take (MiB).
        needed: u64,
        /// Memory allowed (MiB).
        allowed: u64,
    },
    /// Nothing is left to judge.
    #[error("{path}: every channel is tachometer or time; its channels are {known}")]
    NoChannels {
        /// Which file.
        path: PathBuf,
        /// Channels of the recording.
        known: String,
    },
    /// Nothing says how fast the recording was sampled.
    #[error("{path} states no sampling rate: give signal.rate_hz (--rate-hz), or a time column as signal.time_channel")]
    Rate {
        /// Which file.
        path: PathBuf,
    },
    /// The time column is no axis of equal steps.
    #[error(
        "{path}: the time column \"{channel}\" is not uniform; correct the file, or rename the column and give signal.rate_hz (--rate-hz)"
    )]
    Time {
        /// Which file.
        path: PathBuf,
        /// Channel taken as time.
        channel: String,
        /// Why.
        #[source]
        source: HumsError,
    },
    /// The tachometer gives no shaft angle.
    #[error(
        "{path}: the tachometer ({what}) gives no shaft angle; check tachometer.channel or file (--tach), level and edge"
    )]
    Tachometer {
        /// Which file.
        path: PathBuf,
        /// Channel or file.
        what: String,
        /// Why.
        #[source]
        source: HumsError,
    },
    /// The mesh is faster than the sampling resolves.
    #[error(
        "{path}: {mesh:.1} mesh cycles a second are above half the sampling rate of {rate:.6} Hz; check signal.rate_hz, the tachometer and gear.teeth"
    )]
    MeshTooFast {
        /// Which file.
        path: PathBuf,
        /// Mesh frequency (Hz).
        mesh: f64,
        /// Sampling rate (Hz).
        rate: f64,
    },
    /// No averaging period fits.
    #[error(
        "{path}: no synchronous average: the recording lasts {duration:.4} s, one period {period:.4} s; a whole period without gaps (NaN) must lie between the first and the last tachometer pulse: record longer, or lower average.turns"
    )]
    NoPeriod {
        /// Which file.
        path: PathBuf,
        /// Length of the recording (s).
        duration: f64,
        /// Length of the period at the slowest speed (s).
        period: f64,
        /// Why.
        #[source]
        source: HumsError,
    },
    /// The signal library refused a parameter.
    #[error("{path}: {key} does not suit this recording")]
    Parameter {
        /// Which file.
        path: PathBuf,
        /// Key concerned.
        key: &'static str,
        /// Why.
        #[source]
        source: HumsError,
    },
    /// No recording of a folder gives indicators.
    #[error("{path}: none of the {count} recordings can be used; the first: {first}")]
    Unusable {
        /// The folder.
        path: PathBuf,
        /// Recordings in it.
        count: usize,
        /// What is wrong with the first.
        first: String,
    },
    /// The healthy set is too small.
    #[error("{path}: the healthy set has {found} usable recordings, at least 2 are needed")]
    Healthy {
        /// Which folder.
        path: PathBuf,
        /// Recordings that have indicators.
        found: usize,
    },
    /// Angles do not match the channels.
    #[error(
        "{path}: signal.angles_deg has {angles} numbers for {channels} channels ({known}); give one for each channel judged, in this order"
    )]
    Angles {
        /// Which file.
        path: PathBuf,
        /// Angles given.
        angles: usize,
        /// Channels judged.
        channels: usize,
        /// Their names.
        known: String,
    },
    /// No damaged recording gives indicators.
    #[error(
        "{path}: the damaged set has no usable recordings ({first}); correct detection.damaged (--damaged) or damaged_last"
    )]
    Damaged {
        /// Which folder.
        path: PathBuf,
        /// What is wrong with the first, if there is one.
        first: String,
    },
    /// The healthy and the damaged set share recordings.
    #[error(
        "{path}: {healthy} healthy and {damaged} damaged recordings of {count} overlap; lower healthy_first or detection.damaged_last"
    )]
    Overlap {
        /// Which folder.
        path: PathBuf,
        /// Recordings taken as healthy.
        healthy: usize,
        /// Recordings taken as damaged.
        damaged: usize,
        /// Recordings.
        count: usize,
    },
    /// The table of severities is of no use.
    #[error(
        "{path}: line {line}: {reason}; correct detection.severities (--severities): columns recording and severity, and condition if wanted"
    )]
    Severities {
        /// The table.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// What is wrong.
        reason: String,
    },
    /// A recording is named that is not there.
    #[error("{path}: there is no recording \"{name}\"; correct memory.reset_before")]
    ResetBefore {
        /// Folder of recordings.
        path: PathBuf,
        /// Name given.
        name: String,
    },
    /// The user stopped the run.
    #[error("stopped; nothing was written")]
    Cancelled,
}

impl RecordingError {
    /// The message with its causes, in one line.
    #[must_use]
    pub fn in_one_line(&self) -> String {
        let mut text = self.to_string();
        let mut cause = std::error::Error::source(self);
        while let Some(error) = cause {
            text.push_str(&format!(": {error}"));
            cause = error.source();
        }
        text
    }
}
