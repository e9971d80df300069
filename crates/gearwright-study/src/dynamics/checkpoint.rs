//! What a run needs to go on after an interruption, in a file beside the results folder.
//!
//! The file appears complete or not at all, holds the version of the program and a fingerprint of the resolved case, and is taken up only where
//! both are those of the case at hand. Numbers are written so that they read back to the same bits.

use std::io::{BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::simulate::Progress;
use gearwright_case::DynamicsCase;

/// The file of a results folder.
#[derive(Debug)]
pub struct Checkpoint {
    file: PathBuf,
    content: Content,
}

#[derive(Debug, Serialize, Deserialize)]
struct Content {
    version: String,
    fingerprint: u64,
    /// In the order of speeds, then states.
    runs: Vec<Progress>,
}

impl Checkpoint {
    /// Takes up the checkpoint of a case beside its results folder, or starts one with `count` runs.
    #[must_use]
    pub fn open(case: &DynamicsCase, target: &Path, count: usize) -> Self {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(".checkpoint.json");
        let file = target.with_file_name(name);
        let fresh = Content {
            version: env!("CARGO_PKG_VERSION").into(),
            fingerprint: fingerprint(case),
            runs: vec![Progress::default(); count],
        };
        let fits = |found: &Content| {
            found.version == fresh.version && found.fingerprint == fresh.fingerprint && found.runs.len() == count
        };
        // one that cannot be read, or is of another case, is as none
        let found = std::fs::File::open(&file).ok();
        let found: Option<Content> = found.and_then(|f| serde_json::from_reader(BufReader::new(f)).ok());
        let content = found.filter(fits).unwrap_or(fresh);
        Self { file, content }
    }

    /// Whether anything was run before.
    #[must_use]
    pub fn is_taken_up(&self) -> bool {
        self.content.runs.iter().any(|run| run.state.is_some())
    }

    /// A run as far as it is saved.
    #[must_use]
    pub fn run(&self, index: usize) -> Progress {
        self.content.runs.get(index).cloned().unwrap_or_default()
    }

    /// Saves a run.
    ///
    /// # Errors
    /// What the file system says.
    pub fn save(&mut self, index: usize, progress: &Progress) -> anyhow::Result<()> {
        if let Some(run) = self.content.runs.get_mut(index) {
            run.clone_from(progress);
        }
        self.write().with_context(|| format!("the checkpoint {} cannot be written", self.file.display()))
    }

    fn write(&self) -> anyhow::Result<()> {
        let folder = self.file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let temporary = tempfile::NamedTempFile::new_in(folder)?;
        let mut writer = BufWriter::new(temporary);
        serde_json::to_writer(&mut writer, &self.content)?;
        writer.flush()?;
        let temporary = writer.into_inner().map_err(|error| error.into_error())?;
        temporary.as_file().sync_all()?;
        temporary.persist(&self.file)?;
        Ok(())
    }

    /// Removes the file: the results are there.
    pub fn remove(self) {
        // nothing is lost where it stays: it is of a case that is complete
        let _ = std::fs::remove_file(&self.file);
    }

    /// The file.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }
}

/// FNV-1a of everything a result depends on.
fn fingerprint(case: &DynamicsCase) -> u64 {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for byte in format!("{case:?}").bytes() {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
    hash
}
