//! The closed ring of one gear: compliance on the cuts of its teeth, healthy or with damaged sectors among them.
//!
//! A damaged sector changes the ring's stiffness on its own two cuts only, by `dS = S_damaged - S_healthy`. With `P(a, b)` the healthy ring's
//! compliance between the cuts of sectors `a` and `b`, and `D` the damaged sectors,
//!
//! `P'(a, b) = P(a, b) - P(a, D) W P(D, b)`, `W = (1 + dS P(D, D))^-1 dS`
//!
//! (Sherman, Morrison and Woodbury). So damage costs its own sectors and small dense algebra; the healthy ring is untouched.

use std::sync::{Arc, OnceLock};

use faer::Mat;

use crate::error::FecmError;
use crate::linalg::{add_block, product, solve_general};
use crate::ring::{self, cyclic_cut_compliance};

/// Cut compliance of one family.
pub struct RingCompliance {
    teeth: i32,
    /// Entry `d`: displacement of cut `d` by loads on cut 0.
    cuts: Arc<Vec<Mat<f64>>>,
    /// The same for farther cuts, made for the first damage.
    wide: Arc<OnceLock<Arc<Vec<Mat<f64>>>>>,
    /// Damaged teeth in `0..teeth`, ascending, and `W`.
    damage: Option<(Vec<i32>, Mat<f64>)>,
}

impl RingCompliance {
    /// Closes a ring of `teeth` healthy sectors with cut stiffness `sector`; pairs of teeth up to `reach` apart will be asked for.
    ///
    /// # Errors
    /// [`FecmError::NotPositiveDefinite`] if the ring is not held.
    pub fn healthy(sector: &Mat<f64>, teeth: i32, reach: usize) -> Result<Self, FecmError> {
        let cuts = cut_compliance(sector, teeth, reach)?;
        Ok(Self { teeth, cuts: Arc::new(cuts), wide: Arc::default(), damage: None })
    }

    /// The same ring with the sectors of damaged teeth, in `0..teeth`, replaced. Pairs within `reach` of each other will be asked for.
    ///
    /// # Errors
    /// As [`Self::healthy`].
    pub fn with_damage(
        &self,
        sector: &Mat<f64>,
        damaged: &[(i32, &Mat<f64>)],
        reach: usize,
    ) -> Result<Self, FecmError> {
        // damaged teeth are asked for from any tooth in reach, and from each other
        let apart = |a: &(i32, &Mat<f64>), b: &(i32, &Mat<f64>)| self.offset(a.0, b.0).unsigned_abs() as usize;
        let farthest = damaged.iter().flat_map(|a| damaged.iter().map(move |b| apart(a, b))).max().unwrap_or(0);
        let needed = (reach + farthest + 2).min(self.teeth as usize);
        // rings of one damaged tooth share their healthy part
        let cuts = match self.wide.get() {
            Some(wide) if wide.len() >= needed => Arc::clone(wide),
            _ => {
                let wide = Arc::new(cut_compliance(sector, self.teeth, reach + farthest)?);
                let _ = self.wide.set(Arc::clone(&wide));
                wide
            }
        };
        let mut ring = Self { teeth: self.teeth, cuts, wide: Arc::clone(&self.wide), damage: None };
        let n = sector.nrows();
        let numbers: Vec<i32> = damaged.iter().map(|d| d.0).collect();
        let size = n * damaged.len();
        let mut change = Mat::zeros(size, size);
        for (k, (_, stiffness)) in damaged.iter().enumerate() {
            add_block(&mut change, k * n, k * n, 1.0, stiffness);
            add_block(&mut change, k * n, k * n, -1.0, sector);
        }
        if !damaged.is_empty() {
            let between = ring.stacked(&numbers, &numbers);
            let mut system = product(change.as_ref(), between.as_ref());
            for i in 0..size {
                system[(i, i)] += 1.0;
            }
            ring.damage = Some((numbers, solve_general(&system, &change)));
        }
        Ok(ring)
    }

    /// Difference of two tooth numbers around the ring, the shorter way.
    #[must_use]
    pub fn offset(&self, a: i32, b: i32) -> i32 {
        let d = (a - b).rem_euclid(self.teeth);
        if 2 * d > self.teeth { d - self.teeth } else { d }
    }

    /// Compliance between the two cuts of sector `a` (rows) and those of sector `b` (columns).
    #[must_use]
    pub fn pair(&self, a: i32, b: i32) -> Mat<f64> {
        let mut pair = self.healthy_pair(self.offset(a, b));
        if let Some((numbers, weight)) = &self.damage {
            let from = self.stacked(&[a], numbers);
            let to = self.stacked(numbers, &[b]);
            let weighted = product(from.as_ref(), weight.as_ref());
            pair -= product(weighted.as_ref(), to.as_ref());
        }
        pair
    }

    /// Blocks `P(rows, columns)` of the healthy ring.
    fn stacked(&self, rows: &[i32], columns: &[i32]) -> Mat<f64> {
        let n = 2 * self.cuts[0].nrows();
        let mut all = Mat::zeros(n * rows.len(), n * columns.len());
        for (i, &a) in rows.iter().enumerate() {
            for (j, &b) in columns.iter().enumerate() {
                add_block(&mut all, i * n, j * n, 1.0, &self.healthy_pair(self.offset(a, b)));
            }
        }
        all
    }

    fn healthy_pair(&self, offset: i32) -> Mat<f64> {
        if offset >= 0 {
            tooth_cut_compliance(&self.cuts, offset as usize)
        } else {
            tooth_cut_compliance(&self.cuts, offset.unsigned_abs() as usize).transpose().to_owned()
        }
    }
}

/// Entries up to `reach + 1`, as far as the ring goes.
fn cut_compliance(sector: &Mat<f64>, teeth: i32, reach: usize) -> Result<Vec<Mat<f64>>, FecmError> {
    cyclic_cut_compliance(&ring::Arc::of_sector(sector), teeth as usize, (reach + 1).min(teeth as usize - 1))
}

/// Compliance between the two cuts of tooth `t + offset` (rows) and of tooth `t` (columns).
fn tooth_cut_compliance(cuts: &[Mat<f64>], offset: usize) -> Mat<f64> {
    let n = cuts[0].nrows();
    let mut pair = Mat::zeros(2 * n, 2 * n);
    let mut put = |i: usize, j: usize, distance: isize| {
        let mut block = pair.as_mut().submatrix_mut(i * n, j * n, n, n);
        let source = &cuts[distance.unsigned_abs()];
        if distance >= 0 {
            block.copy_from(source);
        } else {
            block.copy_from(source.transpose());
        }
    };
    let d = offset as isize;
    put(0, 0, d);
    put(0, 1, d - 1);
    put(1, 0, d + 1);
    put(1, 1, d);
    pair
}
