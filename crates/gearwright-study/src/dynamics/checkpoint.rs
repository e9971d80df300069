//! What a run needs to go on after an interruption, in a file beside the results folder.
//!
//! The file is an entry of [`gearwright_store`]: it appears complete or not at all, with a checksum, the hash of the program and of the case, and is
//! taken up only where all three fit. Numbers are written so that they read back to the same bits.

use std::path::{Path, PathBuf};

use gearwright_store::file_system::Disk;
use gearwright_store::{Digest, Found, Ignored, read_entry, remove_entry, write_entry};

use super::simulate::Progress;
use gearwright_case::DynamicsCase;

/// The file of a results folder.
#[derive(Debug)]
pub struct Checkpoint {
    file: PathBuf,
    key: Digest,
    /// In the order of speeds, then states.
    runs: Vec<Progress>,
    ignored: Option<Ignored>,
}

impl Checkpoint {
    /// Takes up the checkpoint of a case beside its results folder, or starts one with `count` runs.
    #[must_use]
    pub fn open(case: &DynamicsCase, target: &Path, count: usize) -> Self {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(".checkpoint");
        let file = target.with_file_name(name);
        let key = Digest::of(format!("{case:?}").as_bytes());
        let fresh = || vec![Progress::default(); count];
        let (runs, ignored) = match read_entry::<Vec<Progress>>(&Disk, &file, key) {
            Found::Value(runs) if runs.len() == count => (runs, None),
            Found::Value(_) => (fresh(), Some(Ignored::OtherKey)),
            Found::Absent => (fresh(), None),
            Found::Ignored(reason) => (fresh(), Some(reason)),
        };
        Self { file, key, runs, ignored }
    }

    /// Whether anything was run before.
    #[must_use]
    pub fn is_taken_up(&self) -> bool {
        self.runs.iter().any(|run| run.state.is_some())
    }

    /// Why a checkpoint that is there is not taken up.
    #[must_use]
    pub fn ignored(&self) -> Option<Ignored> {
        self.ignored
    }

    /// A run as far as it is saved.
    #[must_use]
    pub fn run(&self, index: usize) -> Progress {
        self.runs.get(index).cloned().unwrap_or_default()
    }

    /// Saves a run.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn save(&mut self, index: usize, progress: &Progress) -> anyhow::Result<()> {
        if let Some(run) = self.runs.get_mut(index) {
            run.clone_from(progress);
        }
        Ok(write_entry(&Disk, &self.file, self.key, &self.runs)?)
    }

    /// Removes the file: the results are there.
    pub fn remove(self) {
        // nothing is lost where it stays: it is of a case that is complete
        let _ = remove_entry(&Disk, &self.file);
    }

    /// The file.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }
}
