//! Errors of the housing.

use thiserror::Error;

/// What can go wrong between a mesh and an elastic body.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum HousingError {
    /// A number outside its range.
    #[error("{name} = {value} is not allowed: {allowed}")]
    Value {
        /// Which number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A node set that is not in the mesh.
    #[error("there is no node set `{set}` in the mesh; there are: {known}")]
    NoSet {
        /// Name asked for.
        set: String,
        /// Names of all sets.
        known: String,
    },
    /// A node set that does not determine what is read from it.
    #[error("node set `{set}` of {nodes} nodes does not determine {what}")]
    WeakSet {
        /// Its name.
        set: String,
        /// Its size.
        nodes: usize,
        /// What was to be read.
        what: String,
    },
    /// An element turned inside out.
    #[error(
        "element {element} ({kind}) is inside out near ({:.6} m, {:.6} m, {:.6} m): Jacobian {jacobian:.3e} m^3",
        place[0], place[1], place[2]
    )]
    InvertedElement {
        /// Its index, from 0.
        element: usize,
        /// Its kind.
        kind: &'static str,
        /// Where (m).
        place: [f64; 3],
        /// Determinant of the Jacobian (m^3).
        jacobian: f64,
    },
    /// An element with a node that does not exist, or without a material.
    #[error("element {element}: {what} {index} does not exist")]
    Dangling {
        /// Its index, from 0.
        element: usize,
        /// What it points to.
        what: &'static str,
        /// The index.
        index: usize,
    },
    /// No wall where a sensor is wanted.
    #[error("sensor `{sensor}`: no outer wall at angle {angle:.4} rad and height {height:.6} m")]
    NoWall {
        /// Its name.
        sensor: String,
        /// Angle (rad).
        angle: f64,
        /// Height (m).
        height: f64,
    },
    /// A connected part of the housing that nothing keeps from moving as a rigid body.
    #[error(
        "nothing holds the part of {nodes} nodes around ({:.4} m, {:.4} m, {:.4} m): mounts must keep it from moving as a rigid body",
        place[0], place[1], place[2]
    )]
    NotHeld {
        /// Its nodes.
        nodes: usize,
        /// Their middle (m).
        place: [f64; 3],
    },
    /// A line of a mesh file.
    #[error("line {line}: {message}")]
    File {
        /// Line, from 1.
        line: usize,
        /// What is wrong with it, and what is allowed.
        message: String,
    },
    /// A fault of the algebra.
    #[error(transparent)]
    Algebra(#[from] fecm::FecmError),
}
