//! Contact between bodies that are held by inertia and springs: one step of a dynamic analysis.
//!
//! Blocks of cells (one a mesh) share coordinates `q`, the motions of the bodies. Find forces `f` and coordinates with
//!
//! `gap_b = g_b + C_b f_b + R_b q >= 0`, `f_b >= 0`, `f_b . gap_b = 0`, `A q - sum_b R_b^T f_b = b`
//!
//! with `C_b` and `A` symmetric positive definite: the conditions of `min 1/2 f C f + 1/2 q A q - b q + ...`, a linear complementarity problem in
//! `C + R A^-1 R^T` with one solution. On an active set the forces of each block are `f = -C_AA^-1 (g + R q)`, which leaves
//!
//! `(A + sum R_A^T C_AA^-1 R_A) q = b - sum R_A^T C_AA^-1 g_A`
//!
//! for the few coordinates: nothing is ever divided by `A`, so neither a body that turns freely and slowly (`A -> 0`) nor a bearing of
//! 10^12 N/m (`A -> infinity`) costs digits. The factor of an active set is kept from step to step, for steady motion meets the same sets again.

use faer::{Mat, MatRef};

use super::error::LcpError;
use super::lemke::solve_lcp;
use super::pivoting::{CellProblem, block_pivoting};
use super::problem::SolveStats;
use crate::linalg::{DenseCholesky, add_product, column_slice, lower_triangle, product};

/// Cells of one mesh.
#[derive(Debug, Clone, Copy)]
pub struct HeldBlock<'a> {
    /// `C` (m/N), symmetric positive definite.
    pub compliance: MatRef<'a, f64>,
    /// `R`: opening of each cell by unit coordinate, cells x coordinates.
    pub motion: MatRef<'a, f64>,
    /// `g` (m): gaps without forces at `q = 0`.
    pub gap: &'a [f64],
}

/// The problem of one step; see the module header.
#[derive(Debug, Clone)]
pub struct HeldProblem<'a> {
    /// Meshes.
    pub blocks: Vec<HeldBlock<'a>>,
    /// `A`, coordinates x coordinates, symmetric positive definite.
    pub stiffness: MatRef<'a, f64>,
    /// `b`.
    pub load: &'a [f64],
}

/// Solution of a [`HeldProblem`].
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct HeldSolution {
    /// Cell forces of each block (N).
    pub forces: Vec<Vec<f64>>,
    /// Coordinates.
    pub coordinates: Vec<f64>,
    /// Whether the conditions are met.
    pub converged: bool,
    /// Work and residuals; `load_residual` is that of the coordinates' equation, relative to its largest term.
    pub stats: SolveStats,
}

/// The factor of one active set of one block.
struct ActiveFactor {
    cells: Vec<usize>,
    factor: DenseCholesky,
    /// `C_AA^-1 R_A`.
    spread: Mat<f64>,
    /// `R_A^T C_AA^-1 R_A`.
    stiffness: Mat<f64>,
}

/// Factor of the active set a block had last; keep one a block, as long as its compliance and motions are the same.
#[derive(Default)]
pub struct FactorMemory {
    last: Option<ActiveFactor>,
}

impl FactorMemory {
    /// Cells of the set kept.
    #[must_use]
    pub fn cells(&self) -> &[usize] {
        self.last.as_ref().map_or(&[], |last| &last.cells)
    }
}

/// Steps before Lemke's method takes over.
const STEP_LIMIT: usize = 200;
/// A cell is wrong when its force or gap is negative by more than this fraction of the largest.
const TOLERANCE: f64 = 1e-12;

/// Solves from the active sets in `memory` (one a block).
///
/// # Errors
/// [`LcpError`] for sizes that do not agree, values that are not finite, and matrices that are not positive definite.
pub fn solve_held(problem: &HeldProblem<'_>, memory: &mut [FactorMemory]) -> Result<HeldSolution, LcpError> {
    problem.check(memory.len())?;
    let starts = problem.starts();
    let size = problem.size();
    let mut active = vec![false; size];
    for (memory, start) in memory.iter().zip(&starts) {
        for &cell in memory.cells() {
            if let Some(active) = active.get_mut(start + cell) {
                *active = true;
            }
        }
    }
    let mut cells = Held { problem, starts: &starts, memory, factorisations: 0 };
    let outcome = block_pivoting(&mut cells, active, STEP_LIMIT)?;
    let factorisations = cells.factorisations;
    match outcome.found {
        Some((cells, on)) => Ok(problem.finish(&starts, &cells, &on, true, outcome.pivots, factorisations)),
        None => solve_held_by_lemke(problem, memory),
    }
}

/// Solves by complementary pivoting on `C + R A^-1 R^T`, all blocks at once: reference and fallback.
///
/// # Errors
/// As [`solve_held`].
pub fn solve_held_by_lemke(problem: &HeldProblem<'_>, memory: &mut [FactorMemory]) -> Result<HeldSolution, LcpError> {
    problem.check(memory.len())?;
    let (starts, size, coordinates) = (problem.starts(), problem.size(), problem.load.len());
    let whole = Mat::from_fn(coordinates, coordinates, |i, j| problem.stiffness[(i, j)]);
    let factor = DenseCholesky::new(whole, "step").map_err(|_| LcpError::NotPositiveDefinite { cells: 0 })?;
    let mut matrix = Mat::<f64>::zeros(size, size);
    let mut motion = Mat::<f64>::zeros(size, coordinates);
    let mut constant = vec![0.0; size];
    for (block, &start) in problem.blocks.iter().zip(&starts) {
        let n = block.gap.len();
        matrix.as_mut().submatrix_mut(start, start, n, n).copy_from(block.compliance);
        motion.as_mut().submatrix_mut(start, 0, n, coordinates).copy_from(block.motion);
        constant[start..start + n].copy_from_slice(block.gap);
    }
    let mut solved =
        Mat::from_fn(coordinates, size + 1, |i, j| if j < size { motion[(j, i)] } else { problem.load[i] });
    factor.solve_in_place(solved.as_mut());
    add_product(matrix.as_mut(), 1.0, motion.as_ref(), solved.as_ref().subcols(0, size));
    let free = product(motion.as_ref(), solved.as_ref().subcols(size, 1));
    for (value, free) in constant.iter_mut().zip(column_slice(&free, 0)) {
        *value += free;
    }
    // forces in units that make the matrix and the constant of order one
    let compliance = (0..size).map(|i| matrix[(i, i)]).fold(0.0_f64, f64::max).max(f64::MIN_POSITIVE);
    let length = constant.iter().fold(0.0_f64, |m, g| m.max(g.abs())).max(f64::MIN_POSITIVE);
    let scaled = Mat::from_fn(size, size, |i, j| matrix[(i, j)] / compliance);
    let scaled_constant: Vec<f64> = constant.iter().map(|g| g / length).collect();
    let (mut touching, pivots, solved) = match solve_lcp(scaled.as_ref(), &scaled_constant) {
        Some((z, pivots)) => ((0..size).filter(|&i| z[i] > 0.0).collect::<Vec<_>>(), pivots, true),
        None => (Vec::new(), 0, false),
    };
    let mut held = Held { problem, starts: &starts, memory, factorisations: 0 };
    let mut on = held.on_active(&touching)?;
    // degenerate cells that the recomputed solution would pull carry no force
    loop {
        let largest = on.forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let kept: Vec<usize> =
            touching.iter().zip(&on.forces).filter(|(_, f)| **f >= -TOLERANCE * largest).map(|(c, _)| *c).collect();
        if kept.len() == touching.len() {
            break;
        }
        touching = kept;
        on = held.on_active(&touching)?;
    }
    let factorisations = held.factorisations;
    Ok(problem.finish(&starts, &touching, &on, solved, pivots, factorisations))
}

/// Solution on an active set.
struct OnHeld {
    /// Forces of the active cells, blocks in turn.
    forces: Vec<f64>,
    coordinates: Vec<f64>,
}

/// The pivoting's view of a problem.
struct Held<'a> {
    problem: &'a HeldProblem<'a>,
    starts: &'a [usize],
    memory: &'a mut [FactorMemory],
    factorisations: usize,
}

impl CellProblem for Held<'_> {
    type OnActive = OnHeld;

    fn size(&self) -> usize {
        self.problem.size()
    }

    fn on_active(&mut self, cells: &[usize]) -> Result<OnHeld, LcpError> {
        let problem = self.problem;
        let coordinates = problem.load.len();
        let mut left = Mat::from_fn(coordinates, coordinates, |i, j| problem.stiffness[(i, j)]);
        let mut right = Mat::from_fn(coordinates, 1, |i, _| problem.load[i]);
        let mut relaxed = Vec::with_capacity(problem.blocks.len());
        for ((block, memory), &start) in problem.blocks.iter().zip(self.memory.iter_mut()).zip(self.starts) {
            let own: Vec<usize> = (cells.iter().filter(|&&c| c >= start && c < start + block.gap.len()))
                .map(|cell| cell - start)
                .collect();
            let kept = memory.last.take().filter(|last| last.cells == own);
            let factor = match kept {
                Some(factor) => factor,
                None => {
                    self.factorisations += 1;
                    ActiveFactor::new(block, own)?
                }
            };
            left += &factor.stiffness;
            let mut by_gap = Mat::from_fn(factor.cells.len(), 1, |i, _| block.gap[factor.cells[i]]);
            // R_A^T C_AA^-1 g_A, from the spread already known
            add_product(right.as_mut(), -1.0, factor.spread.transpose(), by_gap.as_ref());
            factor.factor.solve_in_place(by_gap.as_mut());
            relaxed.push(by_gap);
            memory.last = Some(factor);
        }
        let factor = DenseCholesky::new(left, "step").map_err(|_| LcpError::NotPositiveDefinite { cells: 0 })?;
        factor.solve_in_place(right.as_mut());
        let mut forces = Vec::with_capacity(cells.len());
        for (memory, by_gap) in self.memory.iter().zip(relaxed) {
            let Some(kept) = &memory.last else { continue };
            let mut own = by_gap;
            add_product(own.as_mut(), 1.0, kept.spread.as_ref(), right.as_ref());
            forces.extend(column_slice(&own, 0).iter().map(|f| -f));
        }
        Ok(OnHeld { forces, coordinates: column_slice(&right, 0).to_vec() })
    }

    fn wrong_cells(&self, cells: &[usize], active: &[bool], on: &OnHeld) -> Vec<usize> {
        let largest = on.forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let (gaps, scale) = self.problem.gaps(self.starts, cells, on);
        let pulls = cells.iter().zip(&on.forces).filter(|(_, f)| **f < -TOLERANCE * largest).map(|(c, _)| *c);
        let overlaps = (0..active.len()).filter(|&i| !active[i] && gaps[i] < -TOLERANCE * scale);
        let mut wrong: Vec<usize> = pulls.chain(overlaps).collect();
        wrong.sort_unstable();
        wrong
    }

    fn revived(&self, _active: &[bool]) -> Option<Vec<bool>> {
        None
    }
}

impl ActiveFactor {
    fn new(block: &HeldBlock<'_>, cells: Vec<usize>) -> Result<Self, LcpError> {
        let count = cells.len();
        let factor = DenseCholesky::new(lower_triangle(block.compliance, &cells), "contact")
            .map_err(|_| LcpError::NotPositiveDefinite { cells: count })?;
        let motion = Mat::from_fn(count, block.motion.ncols(), |i, j| block.motion[(cells[i], j)]);
        let mut spread = motion.clone();
        factor.solve_in_place(spread.as_mut());
        let stiffness = product(motion.transpose(), spread.as_ref());
        Ok(Self { cells, factor, spread, stiffness })
    }
}

impl HeldProblem<'_> {
    /// Number of cells of all blocks.
    #[must_use]
    pub fn size(&self) -> usize {
        self.blocks.iter().map(|block| block.gap.len()).sum()
    }

    fn starts(&self) -> Vec<usize> {
        let mut next = 0;
        let mut starts = Vec::with_capacity(self.blocks.len());
        for block in &self.blocks {
            starts.push(next);
            next += block.gap.len();
        }
        starts
    }

    fn check(&self, memories: usize) -> Result<(), LcpError> {
        let coordinates = self.load.len();
        let square = self.stiffness.nrows() == coordinates && self.stiffness.ncols() == coordinates;
        for block in &self.blocks {
            let (rows, columns, gaps) = (block.compliance.nrows(), block.compliance.ncols(), block.gap.len());
            let motion = block.motion.nrows() == gaps && block.motion.ncols() == coordinates;
            if rows != gaps || columns != gaps || !motion || !square || memories != self.blocks.len() {
                return Err(LcpError::Size { rows, columns, gaps, arms: block.motion.nrows() });
            }
            if let Some(cell) = block.gap.iter().position(|g| !g.is_finite()) {
                return Err(LcpError::Value { what: "gap", cell, value: block.gap[cell], allowed: "finite (m)" });
            }
        }
        match self.load.iter().find(|b| !b.is_finite()) {
            Some(&value) => Err(LcpError::Load { value }),
            None => Ok(()),
        }
    }

    /// Gaps of all cells, and the scale of what they are made of (m).
    fn gaps(&self, starts: &[usize], cells: &[usize], on: &OnHeld) -> (Vec<f64>, f64) {
        let mut gaps = Vec::with_capacity(self.size());
        let mut scale = f64::MIN_POSITIVE;
        for (block, &start) in self.blocks.iter().zip(starts) {
            let mut own = block.gap.to_vec();
            for (k, q) in on.coordinates.iter().enumerate() {
                for (gap, motion) in own.iter_mut().zip(block.motion.col(k).iter()) {
                    *gap += motion * q;
                }
            }
            scale = own.iter().fold(scale, |m, g| m.max(g.abs()));
            for (&cell, &force) in cells.iter().zip(&on.forces) {
                if (start..start + own.len()).contains(&cell) {
                    for (gap, influence) in own.iter_mut().zip(block.compliance.col(cell - start).iter()) {
                        *gap += influence * force;
                    }
                }
            }
            gaps.extend(own);
        }
        (gaps, scale)
    }

    fn finish(
        &self,
        starts: &[usize],
        cells: &[usize],
        on: &OnHeld,
        converged: bool,
        pivots: usize,
        factorisations: usize,
    ) -> HeldSolution {
        let (gaps, scale) = self.gaps(starts, cells, on);
        let largest = on.forces.iter().fold(f64::MIN_POSITIVE, |m, f| m.max(f.abs()));
        let mut all = vec![0.0; self.size()];
        let mut worst = 0.0_f64;
        for (&cell, &force) in cells.iter().zip(&on.forces) {
            worst = worst.max(-force / largest);
            all[cell] = force.max(0.0);
        }
        let (mut complementarity, mut total) = (0.0, f64::MIN_POSITIVE);
        for (gap, force) in gaps.iter().zip(&all) {
            worst = worst.max(-gap / scale);
            complementarity += (gap * force).abs();
            total += force * scale;
        }
        // what is left of A q - R^T f - b
        let (mut residual, mut term) = (0.0_f64, f64::MIN_POSITIVE);
        for (i, load) in self.load.iter().enumerate() {
            let mut left = -load;
            term = term.max(load.abs());
            for (j, q) in on.coordinates.iter().enumerate() {
                left += self.stiffness[(i, j)] * q;
                term = term.max((self.stiffness[(i, j)] * q).abs());
            }
            for (block, &start) in self.blocks.iter().zip(starts) {
                let moments = block.motion.col(i).iter().zip(&all[start..]).map(|(r, f)| r * f);
                left -= moments.sum::<f64>();
            }
            residual = residual.max(left.abs());
        }
        let ends = self.blocks.iter().zip(starts).map(|(block, &start)| all[start..start + block.gap.len()].to_vec());
        let stats = SolveStats {
            solves: 1,
            pivots,
            factorisations,
            kkt_violation: worst.max(0.0),
            complementarity: complementarity / total,
            load_residual: residual / term,
        };
        HeldSolution { forces: ends.collect(), coordinates: on.coordinates.clone(), converged, stats }
    }
}
