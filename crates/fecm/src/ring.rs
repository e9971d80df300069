//! Closing a ring of condensed sectors.
//!
//! An [`Arc`] is any run of consecutive sectors condensed onto its two end cuts. Two arcs join by eliminating the cut between
//! them, so an arc of `n` identical sectors costs `log2(n)` joins of dense blocks. A ring is a cyclic list of arcs; its
//! compliance on the cuts between them is one dense inverse. Damaged sectors are arcs like any other.

use faer::{Mat, MatRef};

use crate::error::FecmError;
use crate::linalg::{DenseCholesky, add_product, symmetrise};

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
