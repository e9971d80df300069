//! Running a case: compute, write everything, publish the folder.

pub mod dynamics;
pub mod lumped_pair;
pub mod recording;
pub mod spur_pair;
pub mod transmission;

use std::path::{Path, PathBuf};

use fecm::statics::Observer;

use gearwright_case::Case;

/// Follows a run.
pub trait RunObserver: Observer {
    /// A stage begins.
    fn stage(&self, _name: &str) {}
}

impl RunObserver for () {}

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

/// Passes on what the solver reports.
struct AsObserver<'a>(&'a dyn RunObserver);

impl Observer for AsObserver<'_> {
    fn advanced(&self, done: usize, total: usize) {
        self.0.advanced(done, total);
    }

    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}
