//! Block principal pivoting ([`super::pivoting`]) with Cholesky factors.
//!
//! If the limit of steps is reached, Lemke's method finishes, so the outcome does not rest on a heuristic.
//!
//! A step factors the active block anew: at the sizes of a contact grid (up to some 1500 cells) most exchanges touch a large
//! part of the set, for which a fresh blocked factorisation is faster than updates.

use super::ContactSolver;
use super::error::LcpError;
use super::lemke::LemkeSolver;
use super::pivoting::{CellProblem, block_pivoting};
use super::problem::{ContactProblem, ContactSolution, OnActive, SolveStatus};

/// Fast solver; see the module header.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveSetSolver {
    /// Steps before Lemke's method takes over.
    pub step_limit: usize,
    /// A cell is wrong when its force or gap is negative by more than this fraction of the largest.
    pub tolerance: f64,
}

impl Default for ActiveSetSolver {
    fn default() -> Self {
        Self { step_limit: 200, tolerance: 1e-12 }
    }
}

impl ContactSolver for ActiveSetSolver {
    fn solve(&self, problem: &ContactProblem<'_>, warm: Option<&[bool]>) -> Result<ContactSolution, LcpError> {
        problem.check()?;
        if let Some(solution) = problem.trivial() {
            return Ok(solution);
        }
        let active = match warm {
            Some(warm) if warm.len() == problem.size() && problem.can_balance(warm) => warm.to_vec(),
            _ => first_set(problem),
        };
        let mut cells = Loaded { problem, tolerance: self.tolerance };
        let outcome = block_pivoting(&mut cells, active, self.step_limit)?;
        let (pivots, steps) = (outcome.pivots, outcome.steps);
        if let Some((cells, on)) = outcome.found {
            return Ok(problem.finish(&cells, &on, SolveStatus::Converged, pivots, steps));
        }
        let mut solution = LemkeSolver::default().solve(problem, None)?;
        solution.stats.pivots += pivots;
        solution.stats.factorisations += steps;
        Ok(solution)
    }
}

/// The cells of a contact problem under load.
struct Loaded<'a> {
    problem: &'a ContactProblem<'a>,
    tolerance: f64,
}

impl CellProblem for Loaded<'_> {
    type OnActive = OnActive;

    fn size(&self) -> usize {
        self.problem.size()
    }

    fn on_active(&mut self, cells: &[usize]) -> Result<OnActive, LcpError> {
        self.problem.on_active(cells)
    }

    fn wrong_cells(&self, cells: &[usize], active: &[bool], on: &OnActive) -> Vec<usize> {
        let problem = self.problem;
        let largest = on.forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let deflection = problem.deflection(on.closing);
        let gaps = problem.gaps(cells, on);
        let pulls = cells.iter().zip(&on.forces).filter(|(_, f)| **f < -self.tolerance * largest).map(|(c, _)| *c);
        let overlaps = (0..problem.size()).filter(|&i| !active[i] && gaps[i] < -self.tolerance * deflection);
        let mut wrong: Vec<usize> = pulls.chain(overlaps).collect();
        wrong.sort_unstable();
        wrong
    }

    fn revived(&self, active: &[bool]) -> Option<Vec<bool>> {
        (!self.problem.can_balance(active)).then(|| first_set(self.problem))
    }
}

/// Cells that would overlap if each deformed alone under its share of the load.
fn first_set(problem: &ContactProblem<'_>) -> Vec<bool> {
    let Some((touch, cell)) = problem.first_touch() else {
        return Vec::new();
    };
    let force = problem.load / problem.arm[cell];
    let mut order: Vec<usize> = problem.closing_cells().collect();
    order.sort_by(|&i, &j| (problem.gap[i] / problem.arm[i]).total_cmp(&(problem.gap[j] / problem.arm[j])));
    // a first guess of the deflection: the load spread evenly over the half of the cells nearest to touching
    let share = order[..order.len().div_ceil(2)].to_vec();
    let even = force / share.len() as f64;
    let mean: f64 = share.iter().map(|&j| problem.compliance[(cell, j)] * even).sum();
    let limit = touch + mean.max(0.0) / problem.arm[cell];
    (0..problem.size()).map(|i| problem.arm[i] > 0.0 && problem.gap[i] / problem.arm[i] <= limit).collect()
}
