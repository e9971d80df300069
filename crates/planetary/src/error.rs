//! Errors of the crate.

use fecm::FecmError;
use gear_geom::TrainError;
use thiserror::Error;

/// What can be wrong with a transmission, or go wrong in it.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanetaryError {
    /// The gears of the stage do not fit.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// A number is outside its range.
    #[error("{what} = {value} is not allowed: {allowed}")]
    Value {
        /// Which number.
        what: String,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A reference to something the transmission does not have.
    #[error("{what} names `{name}`, which is not there; there: {there}")]
    Missing {
        /// What holds the reference.
        what: String,
        /// The name.
        name: String,
        /// What there is.
        there: String,
    },
    /// Tables of an elastic body do not fit each other.
    #[error("{what} has {found} entries, and needs {needed}")]
    Shape {
        /// Which table.
        what: String,
        /// Its size.
        found: usize,
        /// The size it must have.
        needed: usize,
    },
    /// Infinitely stiff connections hold the same motion more than once.
    #[error(
        "infinitely stiff connections hold the same motion more than once (near mesh cycle {cycle:.3}); give one of them a stiffness"
    )]
    OverConstrained {
        /// Mesh cycles travelled.
        cycle: f64,
    },
    /// Loads that nothing holds.
    #[error(
        "no equilibrium at mesh cycle {cycle:.3}: after {iterations} iterations {imbalance:.3e} of the load is out of balance"
    )]
    NoEquilibrium {
        /// Mesh cycles travelled.
        cycle: f64,
        /// Iterations.
        iterations: usize,
        /// Forces out of balance, relative to the load.
        imbalance: f64,
    },
    /// The motion has left the range of numbers, or teeth are pushed into each other by more than a base pitch.
    #[error("the motion is lost at step {step} (mesh cycle {cycle:.3}): {what}")]
    Lost {
        /// Step.
        step: i64,
        /// Mesh cycles travelled.
        cycle: f64,
        /// What was seen.
        what: &'static str,
    },
    /// Linear algebra or options of the finite-element crate.
    #[error(transparent)]
    Fecm(#[from] FecmError),
}

impl PlanetaryError {
    /// [`Self::Value`], unless `good`.
    pub(crate) fn check(
        good: bool,
        what: impl FnOnce() -> String,
        value: f64,
        allowed: &'static str,
    ) -> Result<(), Self> {
        if good { Ok(()) } else { Err(Self::Value { what: what(), value, allowed }) }
    }
}
