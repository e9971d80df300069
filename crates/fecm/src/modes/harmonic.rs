//! The eigenproblem of one nodal diameter of a ring of equal sectors.
//!
//! A cyclic mode of nodal diameter `h` moves tooth `t`, in the tooth's own frame, as `Re(exp(i h theta t) (s + i a))`, `theta` the
//! sector angle (Thomas 1979). Its upper cut must meet the lower cut of the next tooth. With `s` even and `a` odd under the mirror about
//! the tooth (always possible: the mirror turns one travelling wave into the other), one real vector `w` on the upper cut holds both,
//!
//! `s = (cos(phi) w_r, -sin(phi) w_t, cos(phi) w_z)`, `a = (sin(phi) w_r, cos(phi) w_t, sin(phi) w_z)`, `phi = h theta / 2`,
//!
//! and the problem is real and symmetric of one cut plus the sector's held fields: the sum of an even and an odd half whose cut rows are
//! scaled by these factors. At `h = 0` and `h = N / 2` even and odd part into two problems.

use faer::Mat;

use super::krylov::{BLOCK, Pencil, lowest};
use super::sector::{HalfSector, Mirror};
use crate::error::FecmError;
use crate::linalg::{DenseCholesky, add_block, product};

/// Nodal diameter, and which mirror halves take part.
#[derive(Debug, Clone)]
pub(super) struct Harmonic {
    pub(super) nodal_diameter: u32,
    /// The only half, at `h = 0` and `h = N / 2`; these modes are single, all others pairs.
    pub(super) only: Option<Mirror>,
    /// Factors of the cut unknowns in the even and the odd half.
    factors: [Vec<f64>; 2],
    /// Cut unknowns that take part.
    rows: Vec<usize>,
}

/// Modes of one harmonic: the vectors of even and odd half (cut, then held fields), one mode a column, unit mass per sector.
pub(super) struct HarmonicModes {
    pub(super) harmonic: Harmonic,
    /// Squared frequencies, ascending (rad^2/s^2).
    pub(super) values: Vec<f64>,
    pub(super) halves: [Mat<f64>; 2],
    /// Whether there are no more.
    pub(super) all: bool,
}

impl Harmonic {
    /// All harmonics of a ring of `teeth` sectors, given the components of the cut unknowns (0, 1, 2: radial, tangential, axial).
    pub(super) fn of_ring(teeth: u32, components: &[usize]) -> Vec<Self> {
        let mut all = Vec::new();
        for h in 0..=teeth / 2 {
            let phi = std::f64::consts::PI * f64::from(h) / f64::from(teeth);
            let (cosine, sine) = match h {
                0 => (1.0, 0.0),
                _ if 2 * h == teeth => (0.0, 1.0),
                _ => (phi.cos(), phi.sin()),
            };
            let factors = |other: f64, tangential: f64| -> Vec<f64> {
                components.iter().map(|&component| if component == 1 { tangential } else { other }).collect()
            };
            let (even, odd) = (factors(cosine, -sine), factors(sine, cosine));
            if h == 0 || 2 * h == teeth {
                for (only, own) in [(Mirror::Even, &even), (Mirror::Odd, &odd)] {
                    let none = vec![0.0; components.len()];
                    let rows = (0..components.len()).filter(|&k| own[k].abs() > 0.5).collect();
                    let factors = if only == Mirror::Even { [own.clone(), none] } else { [none, own.clone()] };
                    all.push(Self { nodal_diameter: h, only: Some(only), factors, rows });
                }
            } else {
                let rows = (0..components.len()).collect();
                all.push(Self { nodal_diameter: h, only: None, factors: [even, odd], rows });
            }
        }
        all
    }

    /// Modes of the gear that one solution stands for.
    pub(super) fn multiplicity(&self) -> usize {
        if self.only.is_some() { 1 } else { 2 }
    }

    /// Whether a half takes part.
    pub(super) fn takes(&self, half: &HalfSector) -> bool {
        self.only.is_none_or(|only| only == half.mirror)
    }

    /// The lowest `count` modes, or all.
    pub(super) fn solve(&self, halves: &[HalfSector; 2], count: usize) -> Result<HarmonicModes, FecmError> {
        let cut = self.rows.len();
        let held: usize = halves.iter().filter(|half| self.takes(half)).map(|half| half.held.ncols()).sum();
        let size = cut + held;
        let (mut stiffness, mut mass) = (Mat::zeros(size, size), Mat::zeros(size, size));
        let mut first = cut;
        for (half, factors) in halves.iter().zip(&self.factors).filter(|(half, _)| self.takes(half)) {
            for (j, &column) in self.rows.iter().enumerate() {
                for (i, &row) in self.rows.iter().enumerate() {
                    let factor = factors[row] * factors[column];
                    stiffness[(i, j)] += factor * half.cut_stiffness[(row, column)];
                    mass[(i, j)] += factor * half.cut_mass[(row, column)];
                }
                for k in 0..half.held.ncols() {
                    let value = factors[column] * half.coupling[(column, k)];
                    mass[(j, first + k)] = value;
                    mass[(first + k, j)] = value;
                }
            }
            for k in 0..half.held.ncols() {
                mass[(first + k, first + k)] = 1.0;
            }
            add_block(&mut stiffness, first, first, 1.0, &half.held_stiffness);
            first += half.held.ncols();
        }
        let pencil = DensePencil { factor: DenseCholesky::new(stiffness, "nodal diameter")?, mass };
        let found = lowest(&pencil, count, BLOCK, "nodal diameter")?;
        let mut first = cut;
        let parts = [0, 1].map(|index| {
            let (half, factors) = (&halves[index], &self.factors[index]);
            let n = half.cut_stiffness.nrows();
            let mut part = Mat::zeros(half.size(), found.values.len());
            if self.takes(half) {
                for mode in 0..found.values.len() {
                    for (i, &row) in self.rows.iter().enumerate() {
                        part[(row, mode)] = factors[row] * found.vectors[(i, mode)];
                    }
                    for k in 0..half.held.ncols() {
                        part[(n + k, mode)] = found.vectors[(first + k, mode)];
                    }
                }
                first += half.held.ncols();
            }
            part
        });
        let mut modes = HarmonicModes {
            harmonic: self.clone(),
            all: found.values.len() == size,
            values: found.values,
            halves: parts,
        };
        modes.fix_signs();
        Ok(modes)
    }
}

impl HarmonicModes {
    /// Leaves the lowest `count`.
    pub(super) fn truncate(&mut self, count: usize) {
        self.values.truncate(count);
        for half in &mut self.halves {
            half.truncate(half.nrows(), count);
        }
    }

    /// Makes the largest component of every mode positive.
    fn fix_signs(&mut self) {
        for mode in 0..self.values.len() {
            let components = self.halves.iter().flat_map(|half| half.col_as_slice(mode));
            let largest = components.fold(0.0_f64, |most, &value| if value.abs() > most.abs() { value } else { most });
            if largest < 0.0 {
                for half in &mut self.halves {
                    half.col_as_slice_mut(mode).iter_mut().for_each(|value| *value = -*value);
                }
            }
        }
    }
}

struct DensePencil {
    factor: DenseCholesky,
    mass: Mat<f64>,
}

impl Pencil for DensePencil {
    fn size(&self) -> usize {
        self.mass.nrows()
    }

    fn solve(&self, mut forces: Mat<f64>) -> Mat<f64> {
        self.factor.solve_in_place(forces.as_mut());
        forces
    }

    fn mass(&self, fields: &Mat<f64>) -> Mat<f64> {
        product(self.mass.as_ref(), fields.as_ref())
    }
}
