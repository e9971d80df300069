//! Closing a ring of condensed sectors.
//!
//! An [`Arc`] is any run of consecutive sectors condensed onto its two end cuts. Two arcs join by eliminating the cut between
//! them, so an arc of `n` identical sectors costs `log2(n)` joins of dense blocks. A ring is a cyclic list of arcs; its
//! compliance on the cuts between them is one dense inverse. Damaged sectors are arcs like any other.

use faer::{Mat, MatRef};

use crate::error::FecmError;
use crate::linalg::{DenseCholesky, add_product, product, symmetrise};

/// A run of sectors condensed onto its lower and upper cut: `2 n x 2 n` stiffness.
#[derive(Debug, Clone)]
pub struct Arc {
    stiffness: Mat<f64>,
}

impl Arc {
    /// An arc of one condensed sector.
    #[must_use]
    pub fn of_sector(cut_stiffness: &Mat<f64>) -> Self {
        Self { stiffness: cut_stiffness.clone() }
    }

    fn cut_size(&self) -> usize {
        self.stiffness.nrows() / 2
    }

    /// Block of the stiffness: 0 = lower cut, 1 = upper cut.
    fn part(&self, row: usize, column: usize) -> MatRef<'_, f64> {
        let n = self.cut_size();
        self.stiffness.as_ref().submatrix(row * n, column * n, n, n)
    }

    /// This arc followed (in the direction of increasing angle) by `next`.
    ///
    /// # Errors
    /// [`FecmError::NotPositiveDefinite`] if the cut between them is not held.
    pub fn join(&self, next: &Self) -> Result<Self, FecmError> {
        let n = self.cut_size();
        let between = self.part(1, 1) + next.part(0, 0);
        let factor = DenseCholesky::new(between, "joined cut")?;
        // columns: own lower cut, next's upper cut
        let mut coupling = Mat::zeros(n, 2 * n);
        coupling.as_mut().submatrix_mut(0, 0, n, n).copy_from(self.part(1, 0));
        coupling.as_mut().submatrix_mut(0, n, n, n).copy_from(next.part(0, 1));
        let mut solution = coupling.clone();
        factor.solve_in_place(solution.as_mut());
        let mut stiffness = Mat::zeros(2 * n, 2 * n);
        stiffness.as_mut().submatrix_mut(0, 0, n, n).copy_from(self.part(0, 0));
        stiffness.as_mut().submatrix_mut(n, n, n, n).copy_from(next.part(1, 1));
        add_product(stiffness.as_mut(), -1.0, coupling.transpose(), solution.as_ref());
        symmetrise(&mut stiffness);
        Ok(Self { stiffness })
    }

    /// `count >= 1` copies of this arc in a row, by repeated doubling.
    ///
    /// # Errors
    /// As [`Self::join`].
    pub fn repeat(&self, count: usize) -> Result<Self, FecmError> {
        let mut result: Option<Self> = None;
        let mut power = self.clone();
        let mut left = count.max(1);
        loop {
            if left % 2 == 1 {
                result = Some(match result {
                    Some(arc) => arc.join(&power)?,
                    None => power.clone(),
                });
            }
            left /= 2;
            match (left, result) {
                (0, Some(arc)) => return Ok(arc),
                (_, unfinished) => result = unfinished,
            }
            power = power.join(&power)?;
        }
    }
}

/// Compliance on the cuts of the closed ring `arcs[0], arcs[1], ...`: cut `k` is the lower cut of `arcs[k]`.
///
/// # Errors
/// [`FecmError::NotPositiveDefinite`] if the ring is not held.
pub fn ring_compliance(arcs: &[Arc]) -> Result<Mat<f64>, FecmError> {
    let count = arcs.len();
    let n = arcs.first().map_or(0, Arc::cut_size);
    let mut stiffness = Mat::<f64>::zeros(count * n, count * n);
    for (k, arc) in arcs.iter().enumerate() {
        let ends = [k, (k + 1) % count];
        for (i, &row) in ends.iter().enumerate() {
            for (j, &column) in ends.iter().enumerate() {
                let mut block = stiffness.as_mut().submatrix_mut(row * n, column * n, n, n);
                block += arc.part(i, j);
            }
        }
    }
    Ok(DenseCholesky::new(stiffness, "closed ring")?.inverse())
}

/// Cut compliance of a ring of `teeth` identical sectors: entry `d` is the displacement of cut `d` by loads on cut 0
/// (`d = 0..=reach`); the reverse is its transpose.
///
/// # Errors
/// As [`ring_compliance`].
pub fn cyclic_cut_compliance(sector: &Arc, teeth: usize, reach: usize) -> Result<Vec<Mat<f64>>, FecmError> {
    let n = sector.cut_size();
    let mut all = vec![ring_compliance(&[sector.repeat(teeth)?])?];
    let reach = reach.min(teeth - 1);
    // arcs of 1..=reach sectors, and of the rest of the ring
    let mut near = vec![sector.clone()];
    for d in 1..reach {
        let longer = near[d - 1].join(sector)?;
        near.push(longer);
    }
    let mut rest = Vec::new();
    for d in (1..=reach).rev() {
        let arc = match rest.last() {
            None => sector.repeat(teeth - d)?,
            Some(shorter) => sector.join(shorter)?,
        };
        rest.push(arc);
    }
    for d in 1..=reach {
        let inverse = ring_compliance(&[near[d - 1].clone(), rest[reach - d].clone()])?;
        all.push(inverse.as_ref().submatrix(n, 0, n, n).to_owned());
    }
    Ok(all)
}

/// Displacements of all cuts of a ring of sectors with cut stiffness `sectors[k]` under loads on the cuts, cut `k` below sector `k`: block
/// elimination around the ring (the last cut is kept to the end, so the system stays banded).
///
/// # Errors
/// [`FecmError::NotPositiveDefinite`] if the ring is not held.
pub fn solve_ring(sectors: &[&Mat<f64>], loads: &[Mat<f64>]) -> Result<Vec<Mat<f64>>, FecmError> {
    let count = sectors.len();
    let n = sectors.first().map_or(0, |s| s.nrows() / 2);
    let part = |k: usize, row: usize, column: usize| sectors[k].as_ref().submatrix(row * n, column * n, n, n);
    let last = count - 1;
    // forward: cut k in terms of cuts k + 1 and `last`: u_k = -next_k u_{k+1} - end_k u_last + free_k
    let (mut next, mut end, mut free) = (Vec::new(), Vec::new(), Vec::new());
    // what eliminated cuts leave on the present one, on the last, and between the last (row) and the present one
    let mut own = Mat::<f64>::zeros(n, n);
    let mut to_last = part(last, 0, 1).to_owned();
    let mut at_last = part(last, 0, 0) + part(last - 1, 1, 1);
    let mut load = loads[0].clone();
    let mut load_last = loads[last].clone();
    own += part(0, 0, 0) + part(last, 1, 1);
    for k in 0..last {
        let factor = DenseCholesky::new(own.clone(), "ring cut")?;
        // the step before the last couples to it twice: as the next cut and as the one kept
        let is_before_last = k + 1 == last;
        let mut along = if is_before_last { Mat::zeros(n, n) } else { part(k, 0, 1).to_owned() };
        let mut across = to_last.transpose().to_owned();
        if is_before_last {
            across += part(k, 0, 1);
            to_last += part(k, 1, 0);
        }
        let coupling = along.clone();
        factor.solve_in_place(along.as_mut());
        factor.solve_in_place(across.as_mut());
        let mut moved = load.clone();
        factor.solve_in_place(moved.as_mut());
        add_product(at_last.as_mut(), -1.0, to_last.as_ref(), across.as_ref());
        add_product(load_last.as_mut(), -1.0, to_last.as_ref(), moved.as_ref());
        if !is_before_last {
            own = part(k, 1, 1) + part(k + 1, 0, 0);
            add_product(own.as_mut(), -1.0, coupling.transpose(), along.as_ref());
            let after = -product(to_last.as_ref(), along.as_ref());
            load = loads[k + 1].clone();
            add_product(load.as_mut(), -1.0, coupling.transpose(), moved.as_ref());
            to_last = after;
        }
        next.push(along);
        end.push(across);
        free.push(moved);
    }
    let mut cuts = vec![Mat::<f64>::zeros(n, 1); count];
    DenseCholesky::new(at_last, "ring")?.solve_in_place(load_last.as_mut());
    cuts[last] = load_last;
    for k in (0..last).rev() {
        let mut cut = free[k].clone();
        add_product(cut.as_mut(), -1.0, end[k].as_ref(), cuts[last].as_ref());
        if k + 1 < last {
            add_product(cut.as_mut(), -1.0, next[k].as_ref(), cuts[k + 1].as_ref());
        }
        cuts[k] = cut;
    }
    Ok(cuts)
}
