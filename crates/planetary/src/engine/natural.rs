//! Natural modes about a position of rest.
//!
//! `K x = w^2 M x` with the tangent stiffness `K = K_housing + sum k J^T J` of springs and flanks, gyroscopic moments and damping left out. Coordinates are
//! made those of unit mass first (`M = L L^T`, closed form for bodies of revolution); infinitely stiff rows take motions out: the rest of an orthogonal
//! basis that begins with them spans what can move.

use faer::Mat;
use fecm::linalg::symmetric_eigen;
use nalgebra::DMatrix;

use super::contact::Touch;
use super::placed::Placed;
use super::request::NaturalMode;
use super::rows::RIGID;
use super::transmission::{Load, Transmission};
use crate::error::PlanetaryError;

/// Eigenvalues down to this part of the largest, below zero, are rounding.
const ROUNDING: f64 = 1e-9;
/// An infinitely stiff row of which less than this is new holds what others hold already.
const DEPENDENT: f64 = 1e-9;

impl Transmission {
    /// Natural modes about the equilibrium at a load, ascending.
    ///
    /// # Errors
    /// As [`Self::equilibrium`]; eigenvalues that do not converge.
    pub fn natural_modes(&self, load: &Load) -> Result<Vec<NaturalMode>, PlanetaryError> {
        let rest = self.equilibrium(load)?;
        let (system, place) = (&self.system, self.place(load.travelled));
        let (rigid, size, springs) = (system.rigid(), system.size(), system.springs.len());
        let placed = Placed::new(system, place);
        let mut stiffness = DMatrix::<f64>::zeros(size, size);
        for (k, w) in system.frequencies.iter().enumerate() {
            stiffness[(rigid + k, rigid + k)] = w * w;
        }
        let mut held = Vec::new();
        for index in 0..system.rows.len() {
            let row = placed.row(system, index);
            let k = if index < springs {
                system.springs[index].stiffness
            } else {
                let flank = &system.flanks[index - springs];
                let cycle = flank.cycle_offset + flank.cycle_rate * place.travelled;
                let approach = row.iter().zip(&rest.position).map(|(a, b)| a * b).sum();
                Touch { flank, cycle, rate: 0.0, history: 0.0 }.force(approach).1
            };
            if k == 0.0 {
                continue;
            }
            let row = self.unit_mass(&row);
            if k.is_finite() {
                add_square(&mut stiffness, k, &row);
            } else {
                held.push(row);
            }
        }
        let free = free_motions(size, &held);
        let reduced = free.transpose() * &stiffness * &free;
        let n = reduced.nrows();
        let matrix = Mat::from_fn(n, n, |i, j| 0.5 * (reduced[(i, j)] + reduced[(j, i)]));
        let (values, vectors) = symmetric_eigen(&matrix, "tangent stiffness of the transmission")?;
        let largest = values.last().copied().unwrap_or(0.0);
        let mut modes = Vec::with_capacity(n);
        for (index, &value) in values.iter().enumerate() {
            let value = if value.abs() < ROUNDING * largest { 0.0 } else { value.max(0.0) };
            let unit: Vec<f64> = (0..size).map(|i| (0..n).map(|j| free[(i, j)] * vectors[(j, index)]).sum()).collect();
            let mut energy: Vec<f64> = unit[..rigid].chunks_exact(RIGID).map(square).collect();
            energy.push(square(&unit[rigid..]));
            modes.push(NaturalMode {
                frequency: value.sqrt() / (2.0 * std::f64::consts::PI),
                shape: self.unit_mass(&unit),
                energy,
            });
        }
        Ok(modes)
    }

    /// `M^(-1/2) x`.
    pub(super) fn unit_mass(&self, x: &[f64]) -> Vec<f64> {
        let rigid = self.system.rigid();
        let mut out = Vec::with_capacity(x.len());
        for (body, x) in self.system.inertia.iter().zip(x[..rigid].chunks_exact(RIGID)) {
            out.extend(x[..3].iter().map(|x| x / body.mass.sqrt()));
            let along: f64 = x[3..].iter().zip(body.axis).map(|(x, a)| x * a).sum();
            let (about, across) = (1.0 / body.polar.sqrt(), 1.0 / body.transverse.sqrt());
            out.extend(x[3..].iter().zip(body.axis).map(|(x, a)| across * x + (about - across) * along * a));
        }
        out.extend_from_slice(&x[rigid..]);
        out
    }
}

pub(super) fn square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

/// `matrix += k row^T row`.
fn add_square(matrix: &mut DMatrix<f64>, k: f64, row: &[f64]) {
    for (j, &b) in row.iter().enumerate().filter(|(_, b)| **b != 0.0) {
        for (value, a) in matrix.column_mut(j).iter_mut().zip(row) {
            *value += k * a * b;
        }
    }
}

/// Orthonormal columns that span what is at right angles to all rows.
fn free_motions(size: usize, held: &[Vec<f64>]) -> DMatrix<f64> {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(size);
    let units = (0..size).map(|k| (0..size).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>());
    let mut count = 0;
    // rows first, then the coordinates of what is left: each made orthogonal twice to what is there
    for (index, mut vector) in held.iter().cloned().chain(units).enumerate() {
        let before = square(&vector).sqrt();
        for _ in 0..2 {
            for other in &basis {
                let product: f64 = vector.iter().zip(other).map(|(a, b)| a * b).sum();
                vector.iter_mut().zip(other).for_each(|(a, b)| *a -= product * b);
            }
        }
        let after = square(&vector).sqrt();
        if after > DEPENDENT * before && basis.len() < size {
            basis.push(vector.iter().map(|x| x / after).collect());
            count += usize::from(index < held.len());
        }
    }
    let free = &basis[count..];
    DMatrix::from_fn(size, free.len(), |i, j| free[j][i])
}
