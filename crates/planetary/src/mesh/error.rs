//! What can be wrong with a mesh.

use fecm::{FecmError, PositionStatus};
use gear_geom::GeometryErrors;
use thiserror::Error;

/// Faults of mesh laws.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// An option out of range.
    #[error("{name} = {value} is not allowed: {allowed}")]
    Option {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Knots that are no curve.
    #[error(
        "knot {knot} of a force curve (approach {approach:.6e} m, force {force:.6e} N, stiffness {stiffness:.6e} N/m) is not allowed: numbers that \
         ascend in approach and force, above the touch at {touch:.6e} m"
    )]
    Knot {
        /// Which.
        knot: usize,
        /// Its approach (m).
        approach: f64,
        /// Its force (N).
        force: f64,
        /// Its stiffness (N/m).
        stiffness: f64,
        /// Approach of first touch (m).
        touch: f64,
    },
    /// The contact model failed.
    #[error("contact of the mesh: {0}")]
    Contact(#[from] FecmError),
    /// Gears that cannot be.
    #[error("gears of the mesh: {0}")]
    Geometry(#[from] GeometryErrors),
    /// The contact model gives too few usable loads at a position.
    #[error(
        "at mesh cycle {mesh_cycle:.4}, {usable} of {loads} loads up to {highest_force:.1} N have a solution, two are needed; the highest ended as \
         '{}'", .status.name()
    )]
    TooFewLoads {
        /// Mesh cycle.
        mesh_cycle: f64,
        /// Loads with a solution.
        usable: usize,
        /// Loads tried.
        loads: usize,
        /// Highest force tried (N).
        highest_force: f64,
        /// How the highest ended.
        status: PositionStatus,
    },
    /// Two damaged teeth in mesh at the same time.
    #[error(
        "the damaged teeth of pairs {first} (every {first_period} pairs) and {second} (every {second_period} pairs) of a mesh are in mesh at the same time; a \
         mesh table holds damaged teeth that are in mesh one at a time"
    )]
    Overlap {
        /// Pair of one.
        first: i64,
        /// Its period (pairs).
        first_period: u32,
        /// Pair of the other.
        second: i64,
        /// Its period (pairs).
        second_period: u32,
    },
    /// Cancelled by the observer.
    #[error("cancelled")]
    Cancelled,
}
