//! What can be wrong with the input of this crate, and where a run can end.
//!
//! Input faults are errors. Searches that do not converge (steady state, shooting, continuation) are
//! not: they return what they have with a status.

use thiserror::Error;

/// Every error of the crate.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LpmError {
    /// A number is not finite or not in its admissible range.
    #[error("{quantity} = {value} {unit}: must be {allowed}")]
    OutOfRange {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// Its unit ("-" when it has none).
        unit: &'static str,
        /// The admissible range in words.
        allowed: &'static str,
    },
    /// The points of a table do not describe a periodic curve.
    #[error("table point {index}: phase {phase} cycles: {reason}")]
    Table {
        /// Index of the point.
        index: usize,
        /// Its phase (mesh cycles).
        phase: f64,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A table, a list of speeds or a list of pieces is too short, or two lists differ in length.
    #[error("{what}: {found} given, {needed} needed")]
    Length {
        /// Which list.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries needed, in words.
        needed: &'static str,
    },
    /// The mesh stiffness is not positive everywhere.
    #[error("mesh stiffness falls to {value} N/m near mesh cycle {phase}: must be positive everywhere")]
    StiffnessNotPositive {
        /// Least stiffness found (N/m).
        value: f64,
        /// Where (mesh cycles).
        phase: f64,
    },
    /// Drive and coast flanks overlap: the clearance is used up by the transmission error.
    #[error("backlash {backlash} m is used up: the drive flanks touch at {drive} m near mesh cycle {phase}")]
    Jammed {
        /// Clearance along the line of action (m).
        backlash: f64,
        /// Deflection at which the drive flanks touch (m).
        drive: f64,
        /// Where (mesh cycles).
        phase: f64,
    },
    /// Two curves, or a curve and a run, have periods that do not fit.
    #[error("periods of {first} and {second} mesh cycles: {reason}")]
    Period {
        /// First period (mesh cycles).
        first: usize,
        /// Second period (mesh cycles).
        second: usize,
        /// Why they do not fit.
        reason: &'static str,
    },
    /// A method cannot do what was asked of it.
    #[error("{method}: {reason}")]
    Unsuited {
        /// The method.
        method: &'static str,
        /// Why not, and what does.
        reason: &'static str,
    },
    /// The adaptive step fell below what the clock resolves.
    #[error(
        "step of {step} mesh cycles at mesh cycle {phase} is below resolution: tolerance {tolerance} cannot be held"
    )]
    StepUnderflow {
        /// Mesh cycle reached.
        phase: f64,
        /// Step (mesh cycles).
        step: f64,
        /// Relative tolerance asked for.
        tolerance: f64,
    },
    /// The response grew beyond every bound (a parametric instability without contact loss, an explicit method
    /// with too long a step, or free flight without a load that ends it).
    #[error("response grew beyond {limit} m at mesh cycle {phase}")]
    Unbounded {
        /// Mesh cycle reached.
        phase: f64,
        /// Bound that was passed (m).
        limit: f64,
    },
    /// The integration would need more steps than it may take: a mesh cycle is too long against the period of the mesh mode.
    #[error(
        "{cycles} mesh cycles at {frequency} Hz need at least {needed:.1e} steps, an eighth of the mesh mode's period each; \
         at most {limit:.0e} are allowed: raise the mesh frequency, or use the static answer at such speeds"
    )]
    TooManySteps {
        /// Mesh cycles asked for.
        cycles: f64,
        /// Mesh frequency (Hz).
        frequency: f64,
        /// Steps needed at least.
        needed: f64,
        /// Steps allowed.
        limit: u64,
    },
    /// The integration took all steps it may take.
    #[error("the integration took its {limit:.0e} steps without an end, at mesh cycle {phase:.6}")]
    StepLimit {
        /// Mesh cycle reached.
        phase: f64,
        /// Steps allowed.
        limit: u64,
    },
    /// Stopped on request.
    #[error("stopped at mesh cycle {phase:.6}")]
    Stopped {
        /// Mesh cycle reached.
        phase: f64,
    },
    /// More contact events in one mesh cycle than a solution can have.
    #[error("more than {limit} contact events in one period, at mesh cycle {phase}")]
    TooManyEvents {
        /// Mesh cycle reached.
        phase: f64,
        /// The limit.
        limit: usize,
    },
    /// A linear system that must be regular was singular.
    #[error("singular system in {place}")]
    Singular {
        /// Where.
        place: &'static str,
    },
}

/// `Ok(value)` when it is finite and `ok` holds.
pub(crate) fn check(
    ok: bool,
    quantity: &'static str,
    value: f64,
    unit: &'static str,
    allowed: &'static str,
) -> Result<f64, LpmError> {
    if ok && value.is_finite() { Ok(value) } else { Err(LpmError::OutOfRange { quantity, value, unit, allowed }) }
}
