//! Problem, solution and how good the solution is.

use faer::{Mat, MatRef};

use super::error::LcpError;
use crate::linalg::{DenseCholesky, lower_triangle};

/// A contact problem; see [`crate::lcp`].
#[derive(Debug, Clone, Copy)]
pub struct ContactProblem<'a> {
    /// `C`: displacement of cell `i` by force on cell `j` (m/N), symmetric positive definite.
    pub compliance: MatRef<'a, f64>,
    /// `g`: gaps without deformation (m).
    pub gap: &'a [f64],
    /// `a`: lever arms, also closing per unit of approach (m), not negative; cells without one have a gap that is not negative.
    pub arm: &'a [f64],
    /// `T` (N m), not negative.
    pub load: f64,
}

/// Outcome of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolveStatus {
    /// Solved.
    Converged,
    /// Stopped at the limit of iterations; residuals tell how far it got.
    IterationLimit,
    /// Load, but no cells to carry it.
    NoContact,
}

/// Work and residuals.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SolveStats {
    /// Solves counted together.
    pub solves: usize,
    /// Cells that entered or left the contact.
    pub pivots: usize,
    /// Cholesky factorisations.
    pub factorisations: usize,
    /// Largest violation of `f >= 0`, `gap >= 0`, relative to the largest force and to the largest deflection.
    pub kkt_violation: f64,
    /// `|f . gap|` over `sum f` times the largest deflection.
    pub complementarity: f64,
    /// `|a . f - T| / T`.
    pub load_residual: f64,
}

impl SolveStats {
    /// Counters added, residuals those of the later solve.
    #[must_use]
    pub fn followed_by(&self, later: &Self) -> Self {
        Self {
            solves: self.solves + later.solves,
            pivots: self.pivots + later.pivots,
            factorisations: self.factorisations + later.factorisations,
            ..*later
        }
    }
}

/// Solution of a contact problem.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct ContactSolution {
    /// Cell forces (N).
    pub forces: Vec<f64>,
    /// Approach `phi` (rad).
    pub approach: f64,
    /// Outcome.
    pub status: SolveStatus,
    /// `dT / dphi = a_A C_AA^-1 a_A` on the cells in contact (N m/rad).
    pub tangent: Option<f64>,
    /// Work and residuals.
    pub stats: SolveStats,
}

impl ContactSolution {
    /// Whether it is a solution.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.status == SolveStatus::Converged
    }
}

impl ContactProblem<'_> {
    /// Number of cells.
    #[must_use]
    pub fn size(&self) -> usize {
        self.gap.len()
    }

    pub(super) fn check(&self) -> Result<(), LcpError> {
        let n = self.gap.len();
        let (rows, columns) = (self.compliance.nrows(), self.compliance.ncols());
        if rows != n || columns != n || self.arm.len() != n {
            return Err(LcpError::Size { rows, columns, gaps: n, arms: self.arm.len() });
        }
        if !(self.load >= 0.0 && self.load.is_finite()) {
            return Err(LcpError::Load { value: self.load });
        }
        for cell in 0..n {
            let diagonal = self.compliance[(cell, cell)];
            let value = |what, value: f64, allowed| Err(LcpError::Value { what, cell, value, allowed });
            if !self.gap[cell].is_finite() {
                return value("gap", self.gap[cell], "finite (m)");
            }
            if !(self.arm[cell] >= 0.0 && self.arm[cell].is_finite()) {
                return value("arm", self.arm[cell], "0 or more (m)");
            }
            if self.arm[cell] == 0.0 && self.gap[cell] < 0.0 {
                return value("gap without an arm", self.gap[cell], "0 or more (m)");
            }
            if !(diagonal > 0.0 && diagonal.is_finite()) {
                return value("own compliance", diagonal, "positive (m/N)");
            }
        }
        Ok(())
    }

    /// Cells that the approach closes.
    pub(super) fn closing_cells(&self) -> impl Iterator<Item = usize> {
        (0..self.size()).filter(|&cell| self.arm[cell] > 0.0)
    }

    /// Whether a set of cells can balance a load.
    pub(super) fn can_balance(&self, active: &[bool]) -> bool {
        active.iter().zip(self.arm).any(|(active, arm)| *active && *arm > 0.0)
    }

    /// Approach at first touch without load (rad), and its cell.
    pub(super) fn first_touch(&self) -> Option<(f64, usize)> {
        let touch = |cell: usize| (self.gap[cell] / self.arm[cell], cell);
        self.closing_cells().map(touch).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Outcomes that need no solving: no cells, or no load.
    pub(super) fn trivial(&self) -> Option<ContactSolution> {
        let forces = vec![0.0; self.size()];
        let stats = SolveStats { solves: 1, ..SolveStats::default() };
        match self.first_touch() {
            None => {
                let status = if self.load > 0.0 { SolveStatus::NoContact } else { SolveStatus::Converged };
                Some(ContactSolution { forces, approach: 0.0, status, tangent: None, stats })
            }
            Some((approach, _)) if self.load == 0.0 => {
                Some(ContactSolution { forces, approach, status: SolveStatus::Converged, tangent: None, stats })
            }
            Some(_) => None,
        }
    }

    /// Forces and approach if exactly the given cells are in contact. Gaps count from first touch, so that small loads on widely
    /// separated cells lose no digits.
    pub(super) fn on_active(&self, cells: &[usize]) -> Result<OnActive, LcpError> {
        let count = cells.len();
        let touch = self.touch();
        let matrix = lower_triangle(self.compliance, cells);
        let factor =
            DenseCholesky::new(matrix, "contact").map_err(|_| LcpError::NotPositiveDefinite { cells: count })?;
        let mut solved =
            Mat::from_fn(count, 2, |i, j| if j == 0 { self.open(cells[i], touch) } else { self.arm[cells[i]] });
        factor.solve_in_place(solved.as_mut());
        let (mut from_gap, mut tangent) = (0.0, 0.0);
        for (i, &cell) in cells.iter().enumerate() {
            from_gap += self.arm[cell] * solved[(i, 0)];
            tangent += self.arm[cell] * solved[(i, 1)];
        }
        let closing = (self.load + from_gap) / tangent;
        let forces = (0..count).map(|i| closing * solved[(i, 1)] - solved[(i, 0)]).collect();
        Ok(OnActive { forces, closing, tangent })
    }

    /// Gaps of all cells by forces on some of them.
    pub(super) fn gaps(&self, cells: &[usize], on: &OnActive) -> Vec<f64> {
        let touch = self.touch();
        let mut gaps: Vec<f64> = (0..self.size()).map(|i| self.open(i, touch) - self.arm[i] * on.closing).collect();
        for (&cell, &force) in cells.iter().zip(&on.forces) {
            let column = self.compliance.col(cell);
            for (gap, influence) in gaps.iter_mut().zip(column.iter()) {
                *gap += influence * force;
            }
        }
        gaps
    }

    /// Assembles the solution on a set of cells, with its residuals.
    pub(super) fn finish(
        &self,
        cells: &[usize],
        on: &OnActive,
        status: SolveStatus,
        pivots: usize,
        factorisations: usize,
    ) -> ContactSolution {
        let gaps = self.gaps(cells, on);
        let mut forces = vec![0.0; self.size()];
        let (mut worst, mut complementarity, mut moment, mut total) = (0.0_f64, 0.0_f64, 0.0, 0.0);
        let largest = on.forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let deflection = self.deflection(on.closing);
        for (&cell, &force) in cells.iter().zip(&on.forces) {
            worst = worst.max(-force / largest);
            forces[cell] = force.max(0.0);
            moment += self.arm[cell] * forces[cell];
            total += forces[cell];
        }
        for (gap, force) in gaps.iter().zip(&forces) {
            worst = worst.max(-gap / deflection);
            complementarity += (gap * force).abs();
        }
        let stats = SolveStats {
            solves: 1,
            pivots,
            factorisations,
            kkt_violation: worst.max(0.0),
            complementarity: complementarity / (total * deflection).max(f64::MIN_POSITIVE),
            load_residual: (moment / self.load - 1.0).abs(),
        };
        ContactSolution { forces, approach: self.touch() + on.closing, status, tangent: Some(on.tangent), stats }
    }

    /// Approach at first touch, 0 without cells.
    pub(super) fn touch(&self) -> f64 {
        self.first_touch().map_or(0.0, |(touch, _)| touch)
    }

    /// Gap of a cell at first touch (m).
    pub(super) fn open(&self, cell: usize, touch: f64) -> f64 {
        self.gap[cell] - self.arm[cell] * touch
    }

    /// Scale of displacements (m) for an approach `closing` since first touch.
    pub(super) fn deflection(&self, closing: f64) -> f64 {
        let arm = self.arm.iter().fold(0.0_f64, |m, a| m.max(*a));
        (arm * closing).abs().max(f64::MIN_POSITIVE)
    }
}

/// Solution on a given set of cells.
#[derive(Debug, Clone)]
pub(super) struct OnActive {
    pub forces: Vec<f64>,
    /// Approach since first touch.
    pub closing: f64,
    pub tangent: f64,
}
