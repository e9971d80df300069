//! The contact problem at one position: a linear complementarity problem with one rigid approach.
//!
//! Given cells with compliance `C` (symmetric positive definite), gaps `g`, lever arms `a >= 0` and a load `T`, find forces and an approach
//! `phi` of either sign with
//!
//! `gap = g + C f - a phi >= 0`, `f >= 0`, `f . gap = 0`, `a . f = T`
//!
//! Cells with an arm are closed by the approach. Cells without one lie within a body, such as the faces of a crack: neither does the approach
//! close them nor do their forces balance the load, so they start apart or touching (`g >= 0`) and only `C` couples them to the others.
//!
//! These are the Karush-Kuhn-Tucker conditions of `min 1/2 f C f + g f` over `a . f = T`, `f >= 0`; the solution is unique (dissertation section 3.2.1;
//! Cottle, Pang and Stone, *The Linear Complementarity Problem*, 1992, section 1.4).
//!
//! Two solvers sit behind [`ContactSolver`]: [`ActiveSetSolver`] (block principal pivoting on Cholesky factors, warm-started) for speed, and
//! [`LemkeSolver`] (complementary pivoting, the method of Vijayakar's modified Simplex algorithm) as reference and fallback. They agree to
//! rounding; [`solve_held`] is the same for bodies held by inertia, a step of dynamics. `tests/lcp_solvers.rs` holds them against each other and against enumeration.

mod active_set;
mod error;
mod held;
mod lemke;
mod pivoting;
mod problem;

pub use active_set::ActiveSetSolver;
pub use error::LcpError;
pub use held::{FactorMemory, HeldBlock, HeldProblem, HeldSolution, solve_held, solve_held_by_lemke};
pub use lemke::{LemkeSolver, solve_lcp};
pub use problem::{ContactProblem, ContactSolution, SolveStats, SolveStatus};

/// A solver of the contact problem.
pub trait ContactSolver {
    /// Solves; `warm` marks the cells expected to carry load.
    ///
    /// # Errors
    /// [`LcpError`] for malformed problems; not converging is a status.
    fn solve(&self, problem: &ContactProblem<'_>, warm: Option<&[bool]>) -> Result<ContactSolution, LcpError>;
}

/// Which solver to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SolverKind {
    /// Block principal pivoting.
    #[default]
    ActiveSet,
    /// Complementary pivoting.
    Lemke,
}

/// Solves with the solver of a kind.
///
/// # Errors
/// As [`ContactSolver::solve`].
pub fn solve_contact(
    kind: SolverKind,
    problem: &ContactProblem<'_>,
    warm: Option<&[bool]>,
) -> Result<ContactSolution, LcpError> {
    match kind {
        SolverKind::ActiveSet => ActiveSetSolver::default().solve(problem, warm),
        SolverKind::Lemke => LemkeSolver::default().solve(problem, warm),
    }
}
