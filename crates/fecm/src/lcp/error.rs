//! Malformed contact problems.

use thiserror::Error;

/// What is wrong with a contact problem.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LcpError {
    /// Sizes do not agree.
    #[error("sizes differ: compliance {rows} x {columns}, {gaps} gaps, {arms} arms")]
    Size {
        /// Rows of the compliance.
        rows: usize,
        /// Columns of the compliance.
        columns: usize,
        /// Number of gaps.
        gaps: usize,
        /// Number of arms.
        arms: usize,
    },
    /// A number that cannot be used.
    #[error("{what} of cell {cell} is {value}: {allowed}")]
    Value {
        /// Which quantity.
        what: &'static str,
        /// Cell.
        cell: usize,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A load that is negative or not finite.
    #[error("load {value} N m is not allowed: 0 or more")]
    Load {
        /// Load (N m).
        value: f64,
    },
    /// A compliance that is not positive definite on the cells in contact.
    #[error("the compliance of {cells} cells in contact is not positive definite")]
    NotPositiveDefinite {
        /// Number of cells.
        cells: usize,
    },
}
