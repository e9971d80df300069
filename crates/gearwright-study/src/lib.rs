//! Cases, computed: from a resolved case to results as data. Nothing is written but what a run keeps to go on or to go faster
//! (checkpoints, mesh tables).
//!
//! | module | computes |
//! |---|---|
//! | [`spur_pair`] | statics of a pair |
//! | [`lumped_pair`] | lumped-parameter dynamics of a pair |
//! | [`dynamics`] | finite-element/contact-mechanics dynamics of a pair |
//! | [`transmission`] | vibration of a planetary transmission |
//! | [`recording`] | condition indicators of recordings |
//! | [`grids`] | meshes, deformed shapes and contact pressure of a model |

pub mod dynamics;
pub mod grids;
pub mod lumped_pair;
pub mod recording;
pub mod spur_pair;
pub mod transmission;

use fecm::statics::Observer;

/// Follows a run.
pub trait RunObserver: Observer {
    /// A stage begins.
    fn stage(&self, _name: &str) {}
}

impl RunObserver for () {}

/// A fault of the input that shows only in the run.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub String);

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
