//! The results folder: written beside its place and moved there when complete, so that no half-written folder is ever seen.
//!
//! A folder that exists is replaced only if gearwright wrote it (it then holds the marker file).

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Marks a folder as written by gearwright.
const MARKER: &str = ".gearwright-results";

/// Why results cannot be put where they were asked for.
#[derive(Debug, Error)]
pub enum FolderError {
    /// Something else is there.
    #[error("{path} exists and was not written by gearwright; choose another folder with --out, or remove it")]
    Foreign {
        /// The place.
        path: PathBuf,
    },
    /// The file system said no.
    #[error("results cannot be written to {path}: {source}")]
    Io {
        /// The place.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// A results folder under construction.
#[derive(Debug)]
pub struct ResultsFolder {
    target: PathBuf,
    work: tempfile::TempDir,
    // Goes after the folder in it has gone.
    _parent: NewParent,
}

/// A folder made for the results to stand in: removed again if nothing came of them.
#[derive(Debug)]
struct NewParent(Option<PathBuf>);

impl Drop for NewParent {
    fn drop(&mut self) {
        if let Some(parent) = &self.0 {
            // Refused as long as anything is in it.
            let _ = std::fs::remove_dir(parent);
        }
    }
}

impl ResultsFolder {
    /// Starts a folder that will stand at `target`.
    ///
    /// # Errors
    /// [`FolderError`] when `target` holds something else or cannot be written.
    pub fn create(target: &Path) -> Result<Self, FolderError> {
        let io = |source| FolderError::Io { path: target.to_path_buf(), source };
        if target.exists() && !target.join(MARKER).is_file() {
            return Err(FolderError::Foreign { path: target.to_path_buf() });
        }
        let parent = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let _parent = NewParent((!parent.exists()).then(|| parent.to_path_buf()));
        std::fs::create_dir_all(parent).map_err(io)?;
        let work = tempfile::Builder::new().prefix(".gearwright-").tempdir_in(parent).map_err(io)?;
        std::fs::write(work.path().join(MARKER), "").map_err(io)?;
        Ok(Self { target: target.to_path_buf(), work, _parent })
    }

    /// Where a file of the folder is written.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.work.path().join(name)
    }

    /// Moves the complete folder to its place.
    ///
    /// # Errors
    /// [`FolderError::Io`].
    pub fn publish(self) -> Result<PathBuf, FolderError> {
        let io = |source| FolderError::Io { path: self.target.clone(), source };
        if self.target.exists() {
            std::fs::remove_dir_all(&self.target).map_err(io)?;
        }
        let work = self.work.keep();
        std::fs::rename(&work, &self.target).map_err(io)?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            std::fs::set_permissions(&self.target, std::fs::Permissions::from_mode(0o755)).map_err(io)?;
        }
        Ok(self.target)
    }
}
