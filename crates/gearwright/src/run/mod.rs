//! Running a case: compute, write everything, publish the folder.

mod dynamics;
mod lumped_pair;
mod recording;
mod spur_pair;
mod transmission;

use std::path::{Path, PathBuf};

use gearwright_case::Case;
use gearwright_results::table::FilledTable;
use gearwright_store::ResultsFolder;
pub use gearwright_study::RunObserver;

/// A finished run.
#[derive(Debug)]
pub struct Finished {
    /// The results folder.
    pub folder: PathBuf,
    /// The one-screen summary.
    pub screen: String,
    /// Answers that cannot be used.
    pub unusable: Unusable,
}

/// How many answers of a run cannot be used; its tables mark them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Unusable {
    /// Answers that cannot be used.
    pub count: usize,
    /// All answers.
    pub total: usize,
    /// What is counted: positions, steps, recordings.
    pub what: &'static str,
}

/// Runs a case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then.
pub fn run(case: &Case, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    match case {
        Case::SpurPair(case) => spur_pair::run(case, target, observer),
        Case::LumpedPair(case) => lumped_pair::run(case, target, observer),
        Case::Dynamics(case) => dynamics::run(case, target, observer),
        Case::Transmission(case) => transmission::run(case, target, observer),
        Case::Recording(case) => recording::run(case, target, observer),
    }
}

/// Writes tables into a results folder.
fn save_tables(folder: &ResultsFolder, tables: Vec<FilledTable<'_>>) -> anyhow::Result<()> {
    let place = folder.file("");
    for table in tables {
        table.save(&place)?;
    }
    Ok(())
}
