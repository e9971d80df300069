//! Exit codes: a contract with scripts, printed by `gearwright --help`.

use std::fmt;
use std::process::ExitCode;

use gearwright_case::CaseFaults;
use gearwright_store::StoreError;
use gearwright_study::Refused;
use gearwright_study::recording::RecordingError;

/// The part of `--help` on exit codes.
pub const HELP: &str = "\
Exit codes:
  0    done, all results usable
  1    error: the run failed; nothing was published
  2    refused: a fault of the command line, the case or a file it names
  3    results written, some or all of them not usable (tables and warning name them); `verify`: changed or missing files
  130  stopped by a signal; nothing was published";

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Done, all results usable.
    Usable = 0,
    /// The run failed.
    Error = 1,
    /// A fault of the command line, the case or a file it names.
    Refused = 2,
    /// Results were written, not all of them usable.
    Unusable = 3,
    /// Stopped by a signal.
    Stopped = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

impl Exit {
    /// The exit of an error.
    #[must_use]
    pub fn of(error: &anyhow::Error) -> Self {
        let refused = error.is::<Refused>()
            || error.is::<CaseFaults>()
            || error.is::<RecordingError>()
            || matches!(
                error.downcast_ref::<StoreError>(),
                Some(StoreError::Foreign { .. } | StoreError::NoManifest { .. } | StoreError::Busy { .. })
            );
        match () {
            () if error.is::<Stopped>() => Self::Stopped,
            () if refused => Self::Refused,
            () => Self::Error,
        }
    }
}

/// A run ended by a signal.
#[derive(Debug)]
pub struct Stopped(pub String);

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Stopped {}

/// An error that refuses the command line.
#[must_use]
pub fn refused(message: impl Into<String>) -> anyhow::Error {
    Refused(message.into()).into()
}
