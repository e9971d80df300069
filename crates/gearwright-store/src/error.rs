//! What can go wrong with kept files.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a folder or file cannot be kept or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StoreError {
    /// Something else stands at the target.
    #[error("{path} exists and was not written by gearwright; choose another folder with --out, or remove it")]
    Foreign {
        /// The target.
        path: PathBuf,
    },
    /// The folder holds no manifest.
    #[error("{path} is not a results folder: it holds no {name}", name = crate::manifest::NAME)]
    NoManifest {
        /// The folder.
        path: PathBuf,
    },
    /// The manifest does not agree with its own checksum.
    #[error(
        "the manifest {path} is damaged ({reason}), so results and other files cannot be told apart; move the folder away or choose another one with --out"
    )]
    Damaged {
        /// The manifest.
        path: PathBuf,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// Another run writes to this target.
    #[error("another run is writing to {path}; wait for it, or choose another folder with --out")]
    Busy {
        /// The target.
        path: PathBuf,
    },
    /// Results of an interrupted run wait for their place, which something else has taken.
    #[error(
        "{path} was put there after a run was interrupted while it exchanged results; the results before that run are in {old}: move one of the two away"
    )]
    Taken {
        /// The target.
        path: PathBuf,
        /// The results before the interrupted run.
        old: PathBuf,
    },
    /// The results are complete but cannot be moved to their place.
    #[error("the results cannot be moved to {path} and stay in {kept}")]
    Unpublished {
        /// The target.
        path: PathBuf,
        /// Where the results are.
        kept: PathBuf,
        /// Why.
        #[source]
        source: Box<StoreError>,
    },
    /// The file system refused.
    #[error("{path} cannot be {action}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried, as a participle.
        action: &'static str,
        /// Why.
        #[source]
        source: io::Error,
    },
}

/// Names file and action of a failure.
pub(crate) fn refused(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> StoreError {
    move |source| StoreError::Io { path: path.to_path_buf(), action, source }
}
