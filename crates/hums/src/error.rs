//! The one error type of the crate.
//!
//! `Err` always means that no number can be given: the input is malformed, or the quantity is not
//! defined for it (a crest factor of silence). Values that are defined but suspicious are returned,
//! and [`crate::quality`] says what is odd about the record.

/// Why a quantity could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HumsError {
    /// The signal has fewer samples than the quantity needs.
    #[error("{what} needs at least {needed} samples, the signal has {found}")]
    TooShort {
        /// Quantity asked for.
        what: &'static str,
        /// Samples it needs.
        needed: usize,
        /// Samples given.
        found: usize,
    },
    /// A sample is NaN or infinite. Fill or cut gaps first: [`crate::signal::fill_gaps`].
    #[error("sample {index} is not finite ({value}); fill or cut gaps before computing {what}")]
    NotFinite {
        /// Quantity asked for.
        what: &'static str,
        /// Index of the first such sample, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The quantity is a ratio whose denominator vanishes for this signal.
    #[error("{what} is undefined: {reason}")]
    Undefined {
        /// Quantity asked for.
        what: &'static str,
        /// What vanishes or is missing.
        reason: &'static str,
    },
    /// A result would leave the range of `f64`.
    #[error("{what} leaves the range of 64-bit floating point; rescale the signal's unit")]
    OutOfRange {
        /// Quantity asked for.
        what: &'static str,
    },
    /// A parameter is outside its admissible range.
    #[error("{parameter} = {value} is outside its range: {allowed}")]
    Parameter {
        /// Name of the parameter.
        parameter: &'static str,
        /// Value given.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Two slices that must match in length do not.
    #[error("{what}: lengths {left} and {right} must be equal")]
    LengthMismatch {
        /// Where.
        what: &'static str,
        /// First length.
        left: usize,
        /// Second length.
        right: usize,
    },
    /// A gear-mesh order needed by the quantity is not on the record's spectral grid.
    #[error("order {order} is above the highest order {highest} that {samples} samples per period resolve")]
    OrderNotResolved {
        /// Order asked for, cycles per record.
        order: usize,
        /// Highest order on the grid (below the Nyquist order).
        highest: usize,
        /// Samples per period.
        samples: usize,
    },
    /// Pulse times are not strictly increasing, or there are too few of them.
    #[error("tachometer: {reason} (at pulse {index})")]
    Tachometer {
        /// What is wrong.
        reason: &'static str,
        /// Index of the pulse concerned, from 0.
        index: usize,
    },
    /// An iteration ended without meeting its tolerance and has no usable result.
    #[error("{what} did not converge within {iterations} iterations")]
    NoConvergence {
        /// Method.
        what: &'static str,
        /// Iterations spent.
        iterations: usize,
    },
}

/// Result of this crate.
pub type Result<T> = std::result::Result<T, HumsError>;

pub(crate) fn require_len(what: &'static str, signal: &[f64], needed: usize) -> Result<()> {
    if signal.len() < needed {
        return Err(HumsError::TooShort { what, needed, found: signal.len() });
    }
    Ok(())
}

pub(crate) fn require_finite(what: &'static str, signal: &[f64]) -> Result<()> {
    // A sum of x * 0 is 0 unless a sample is NaN or infinite: one vectorised pass, and the search
    // for the culprit runs only when there is one.
    if signal.iter().map(|x| x * 0.0).sum::<f64>() == 0.0 {
        return Ok(());
    }
    match signal.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(HumsError::NotFinite { what, index, value: signal[index] }),
        None => Ok(()),
    }
}

pub(crate) fn finite_or_out_of_range(what: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(HumsError::OutOfRange { what }) }
}

pub(crate) fn require_positive(parameter: &'static str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(HumsError::Parameter { parameter, value, allowed: "finite and > 0" })
    }
}
