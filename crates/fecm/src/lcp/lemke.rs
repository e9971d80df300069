//! Lemke's complementary pivoting.
//!
//! The contact problem, with the approach counted from first touch so that it is not negative, is a linear complementarity problem of
//! size `n + 1`,
//!
//! `w = M z + q`, `w, z >= 0`, `w . z = 0`, `M = [C, -a; a, 0]`, `q = [g; -T]`,
//!
//! and `M` is positive semidefinite, for which Lemke's method ends with a solution (Cottle, Pang and Stone, 1992, theorem 4.4.12). Ties are
//! broken lexicographically, which excludes cycling. Lengths, forces and the approach are scaled to order one, and the final
//! forces are computed anew from the final set of cells, so that rounding of the tableau does not remain.

use faer::{Mat, MatRef};

use super::ContactSolver;
use super::error::LcpError;
use super::problem::{ContactProblem, ContactSolution, SolveStatus};

/// Reference solver; see the module header.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LemkeSolver {
    /// Pivots allowed per unknown.
    pub pivots_per_unknown: usize,
}

impl Default for LemkeSolver {
    fn default() -> Self {
        Self { pivots_per_unknown: 50 }
    }
}

impl ContactSolver for LemkeSolver {
    fn solve(&self, problem: &ContactProblem<'_>, _warm: Option<&[bool]>) -> Result<ContactSolution, LcpError> {
        problem.check()?;
        if let Some(solution) = problem.trivial() {
            return Ok(solution);
        }
        let n = problem.size();
        let touch = problem.touch();
        let closing = problem.closing_cells().count();
        let mean = |values: &dyn Fn(usize) -> f64| problem.closing_cells().map(values).sum::<f64>() / closing as f64;
        let arm = mean(&|i| problem.arm[i]);
        let compliance = mean(&|i| problem.compliance[(i, i)]);
        let deflection = problem.load / arm * compliance;
        let matrix = Mat::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => problem.compliance[(i, j)] / compliance,
            (true, false) => -problem.arm[i] / arm,
            (false, true) => problem.arm[j] / arm,
            (false, false) => 0.0,
        });
        let constant: Vec<f64> = (0..n).map(|i| (problem.open(i, touch) / deflection).max(0.0)).chain([-1.0]).collect();
        let outcome = lemke(matrix.as_ref(), &constant, self.pivots_per_unknown * (n + 1));
        let status = if outcome.solved { SolveStatus::Converged } else { SolveStatus::IterationLimit };
        let mut cells: Vec<usize> = (0..n).filter(|&i| outcome.z[i] > 0.0).collect();
        if !cells.iter().any(|&cell| problem.arm[cell] > 0.0) {
            cells.extend(problem.first_touch().map(|(_, cell)| cell));
            cells.sort_unstable();
        }
        let mut on = problem.on_active(&cells)?;
        let mut factorisations = 1;
        // degenerate cells that the recomputed solution would pull carry no force
        loop {
            let largest = on.forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            let kept: Vec<usize> =
                cells.iter().zip(&on.forces).filter(|(_, f)| **f >= -1e-12 * largest).map(|(c, _)| *c).collect();
            if kept.len() == cells.len() || !kept.iter().any(|&cell| problem.arm[cell] > 0.0) {
                break;
            }
            cells = kept;
            on = problem.on_active(&cells)?;
            factorisations += 1;
        }
        Ok(problem.finish(&cells, &on, status, outcome.pivots, factorisations))
    }
}

/// Result of [`lemke`].
struct Outcome {
    z: Vec<f64>,
    pivots: usize,
    solved: bool,
}

/// Solves `w = M z + q`, `w, z >= 0`, `w . z = 0` for positive semidefinite `M`; `None` when it has no solution or the limit of pivots is
/// reached. Returns `z` and the number of pivots.
#[must_use]
pub fn solve_lcp(matrix: MatRef<'_, f64>, constant: &[f64]) -> Option<(Vec<f64>, usize)> {
    let outcome = lemke(matrix, constant, 50 * (constant.len() + 1));
    outcome.solved.then_some((outcome.z, outcome.pivots))
}

/// Columns of the tableau: `w` (0..n), `z` (n..2n), the artificial variable (2n), the right-hand side (2n + 1).
fn lemke(matrix: MatRef<'_, f64>, constant: &[f64], limit: usize) -> Outcome {
    let n = constant.len();
    let width = 2 * n + 2;
    let artificial = 2 * n;
    if constant.iter().all(|&q| q >= 0.0) {
        return Outcome { z: vec![0.0; n], pivots: 0, solved: true };
    }
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row = vec![0.0; width];
            row[i] = 1.0;
            for j in 0..n {
                row[n + j] = -matrix[(i, j)];
            }
            row[artificial] = -1.0;
            row[width - 1] = constant[i];
            row
        })
        .collect();
    let mut basis: Vec<usize> = (0..n).collect();
    // the artificial variable enters in the row that needs it most, by lexicographic order
    let mut leaving_row = (0..n)
        .reduce(|best, i| if lexicographically_less(&rows[i], 1.0, &rows[best], 1.0, n) { i } else { best })
        .unwrap_or(0);
    let mut entering = artificial;
    for pivots in 1..=limit {
        pivot(&mut rows, leaving_row, entering);
        let leaving = std::mem::replace(&mut basis[leaving_row], entering);
        if leaving == artificial {
            let mut z = vec![0.0; n];
            for (row, &variable) in rows.iter().zip(&basis) {
                if (n..2 * n).contains(&variable) {
                    z[variable - n] = row[width - 1].max(0.0);
                }
            }
            return Outcome { z, pivots, solved: true };
        }
        entering = if leaving < n { leaving + n } else { leaving - n };
        // lexicographic ratio test
        let mut best: Option<usize> = None;
        for i in 0..n {
            let step = rows[i][entering];
            if step > 1e-11 {
                let better =
                    best.is_none_or(|b| lexicographically_less(&rows[i], step, &rows[b], rows[b][entering], n));
                if better {
                    best = Some(i);
                }
            }
        }
        match best {
            Some(row) => leaving_row = row,
            None => break,
        }
    }
    Outcome { z: vec![0.0; n], pivots: limit, solved: false }
}

/// Whether `(right-hand side, basis inverse)` of row `a` over `scale_a` comes before that of row `b` over `scale_b`.
fn lexicographically_less(a: &[f64], scale_a: f64, b: &[f64], scale_b: f64, n: usize) -> bool {
    let last = a.len() - 1;
    for column in std::iter::once(last).chain(0..n) {
        let (x, y) = (a[column] / scale_a, b[column] / scale_b);
        if (x - y).abs() > 1e-13 * x.abs().max(y.abs()) {
            return x < y;
        }
    }
    false
}

fn pivot(rows: &mut [Vec<f64>], row: usize, column: usize) {
    let inverse = 1.0 / rows[row][column];
    for value in &mut rows[row] {
        *value *= inverse;
    }
    let pivot_row = rows[row].clone();
    for (i, other) in rows.iter_mut().enumerate() {
        let factor = other[column];
        if i != row && factor != 0.0 {
            for (value, p) in other.iter_mut().zip(&pivot_row) {
                *value -= factor * p;
            }
            other[column] = 0.0;
        }
    }
}
