//! Block principal pivoting, the loop that the contact solvers share.
//!
//! Each step solves as if exactly the cells of the active set touched, then exchanges every cell that is wrong: those that would pull leave,
//! those that would interpenetrate enter. This is the semismooth Newton method on `min(force, gap) = 0` (Hintermüller, Ito and Kunisch,
//! *SIAM J. Optim.* 13, 2003, 865-888). Exchanging all at once takes a few steps, whatever the number of cells; when the number of wrong cells
//! stops falling, cells are exchanged one at a time from the largest index (Murty's rule) until it does (Portugal, Judice and Vicente,
//! *Math. Comp.* 63, 1994, 625-643).

use super::error::LcpError;

/// A complementarity problem over cells, solved set by set.
pub(super) trait CellProblem {
    /// What is known once a set of cells is taken to touch.
    type OnActive;

    /// Number of cells.
    fn size(&self) -> usize;

    /// Solution if exactly `cells` (ascending) touch.
    fn on_active(&mut self, cells: &[usize]) -> Result<Self::OnActive, LcpError>;

    /// Cells on the wrong side, ascending.
    fn wrong_cells(&self, cells: &[usize], active: &[bool], on: &Self::OnActive) -> Vec<usize>;

    /// A set to go on from in place of one that has no solution; `None` for one that has.
    fn revived(&self, active: &[bool]) -> Option<Vec<bool>>;
}

/// Outcome of [`block_pivoting`].
pub(super) struct Pivoted<S> {
    /// Cells in contact, ascending; with their solution when converged.
    pub found: Option<(Vec<usize>, S)>,
    /// Cells exchanged.
    pub pivots: usize,
    /// Sets tried.
    pub steps: usize,
}

/// Full exchanges allowed without progress.
const PATIENCE: usize = 3;

/// Pivots from the set `active` until no cell is wrong or `step_limit` sets were tried.
pub(super) fn block_pivoting<P: CellProblem>(
    problem: &mut P,
    mut active: Vec<bool>,
    step_limit: usize,
) -> Result<Pivoted<P::OnActive>, LcpError> {
    let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
    let mut pivots = 0;
    for steps in 1..=step_limit {
        let cells: Vec<usize> = (0..problem.size()).filter(|&i| active[i]).collect();
        let on = problem.on_active(&cells)?;
        let wrong = problem.wrong_cells(&cells, &active, &on);
        if wrong.is_empty() {
            return Ok(Pivoted { found: Some((cells, on)), pivots, steps });
        }
        let exchange = if wrong.len() < fewest {
            (fewest, patience) = (wrong.len(), PATIENCE);
            &wrong[..]
        } else if patience > 0 {
            patience -= 1;
            &wrong[..]
        } else {
            &wrong[wrong.len() - 1..]
        };
        for &cell in exchange {
            active[cell] = !active[cell];
        }
        pivots += exchange.len();
        if let Some(set) = problem.revived(&active) {
            active = set;
        }
    }
    Ok(Pivoted { found: None, pivots, steps: step_limit })
}
