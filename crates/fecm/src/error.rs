//! Errors of the crate.

use thiserror::Error;

/// What can go wrong when a body is meshed, condensed, or brought into contact.
///
/// Input faults and failed factorisations are errors; an iteration that does not converge is a status of the result.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FecmError {
    /// A root crack that cannot be.
    #[error("root crack: {what} = {value:.6} is not possible; allowed: {allowed}")]
    Crack {
        /// Which of its parameters.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: String,
    },
    /// An option is outside its range.
    #[error("{name} = {value} is not allowed: {allowed}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A mapped element is inside out.
    #[error(
        "element {element} of the {body} mesh is inside out near ({x:.6} m, {y:.6} m): Jacobian {jacobian:.3e} m^2; \
         the tooth form or the rim does not fit the mesh blocks"
    )]
    InvertedElement {
        /// Which body.
        body: &'static str,
        /// Element index.
        element: usize,
        /// Place (m).
        x: f64,
        /// Place (m).
        y: f64,
        /// Jacobian determinant (m^2).
        jacobian: f64,
    },
    /// A matrix that must be positive definite is not.
    #[error("the {what} matrix of size {size} is not positive definite")]
    NotPositiveDefinite {
        /// Which matrix.
        what: &'static str,
        /// Its size.
        size: usize,
    },
    /// Memory for a factorisation could not be had.
    #[error("not enough memory to factor the {what} matrix of size {size}")]
    OutOfMemory {
        /// Which matrix.
        what: &'static str,
        /// Its size.
        size: usize,
    },
    /// A position whose static contact problem has no usable solution.
    #[error(
        "no static equilibrium at mesh cycle {mesh_cycle:.4} under {torque} N m: the teeth do not reach each other, or the load is far too large"
    )]
    NoEquilibrium {
        /// Mesh cycle.
        mesh_cycle: f64,
        /// Torque on the wheel (N m).
        torque: f64,
    },
    /// Gears that leave each other.
    #[error(
        "the gears leave each other at mesh cycle {mesh_cycle:.4}, time {time:.6} s: transmission error {transmission_error:.3e} m, \
         allowed is a quarter of the base pitch, {allowed:.3e} m; look at damping, supports, steps per mesh cycle and the state at the start"
    )]
    Separated {
        /// Mesh cycle.
        mesh_cycle: f64,
        /// Time (s).
        time: f64,
        /// Dynamic transmission error (m).
        transmission_error: f64,
        /// Largest allowed (m).
        allowed: f64,
    },
    /// An eigenvalue iteration of a dense matrix did not converge.
    #[error("the eigenvalues of the {what} matrix of size {size} did not converge")]
    EigenNotConverged {
        /// Which matrix.
        what: &'static str,
        /// Its size.
        size: usize,
    },
    /// A healthy sector is not its own mirror image, which its modes rest on.
    #[error("the sector mesh is not symmetric about its tooth: no image of the node at ({x:.6} m, {y:.6} m)")]
    NotMirrored {
        /// Place (m).
        x: f64,
        /// Place (m).
        y: f64,
    },
    /// A malformed contact problem.
    #[error(transparent)]
    Contact(#[from] crate::lcp::LcpError),
    /// An inertia smaller than that of the elastic modes it is to hold.
    #[error(
        "{inertia} of the {body} = {given:.6e} {unit} is less than its elastic modes alone carry, {carried:.6e} {unit}: give the inertia of \
         all that moves with the hub, the gear itself included, or keep no elastic modes"
    )]
    LightHub {
        /// Which gear.
        body: &'static str,
        /// Which inertia.
        inertia: &'static str,
        /// As given.
        given: f64,
        /// What the modes carry.
        carried: f64,
        /// Unit of both.
        unit: &'static str,
    },
}
