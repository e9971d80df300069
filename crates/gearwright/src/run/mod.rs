//! Running a case: compute, write everything, publish the folder.

mod dynamics;
mod lumped_pair;
mod recording;
mod spur_pair;
mod transmission;

use std::path::{Path, PathBuf};

use gearwright_case::Case;
pub use gearwright_study::RunObserver;

/// A finished run.
#[derive(Debug)]
pub struct Finished {
    /// The results folder.
    pub folder: PathBuf,
    /// The one-screen summary.
    pub screen: String,
    /// Positions without a usable answer, of the series and the map together.
    pub unusable: usize,
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
