//! A mesh that is a spring: stiffness and error given over the mesh cycle.
//!
//! `F = max(0, k(m) (x - e(m)))`, the mesh of lumped models (dissertation Eqs. (3.4), (7.1)); `k` and `e` repeat every cycle.

use std::f64::consts::TAU;

use super::error::MeshError;
use super::law::{MeshLaw, MeshResponse};

/// A function of the mesh cycle with period 1.
#[derive(Debug, Clone, PartialEq)]
pub enum Periodic {
    /// The same always.
    Constant(f64),
    /// `mean + sum a_j cos(2 pi j m) + b_j sin(2 pi j m)`, `j` from 1.
    Harmonics {
        /// Mean.
        mean: f64,
        /// `[a_j, b_j]`.
        terms: Vec<[f64; 2]>,
    },
    /// Values at equal steps from mesh cycle 0 on, straight lines between.
    Samples(Vec<f64>),
}

impl Periodic {
    /// Value at a mesh cycle.
    #[must_use]
    pub fn at(&self, mesh_cycle: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Harmonics { mean, terms } => {
                let wave = |(j, [a, b]): (usize, &[f64; 2])| {
                    let (sine, cosine) = (TAU * (j + 1) as f64 * mesh_cycle.rem_euclid(1.0)).sin_cos();
                    a * cosine + b * sine
                };
                mean + terms.iter().enumerate().map(wave).sum::<f64>()
            }
            Self::Samples(values) => {
                let place = mesh_cycle.rem_euclid(1.0) * values.len() as f64;
                let (index, part) = (place.floor() as usize, place.fract());
                let value = |i: usize| values.get(i % values.len().max(1)).copied().unwrap_or(0.0);
                value(index) * (1.0 - part) + value(index + 1) * part
            }
        }
    }

    /// A value below which it never falls; for samples and constants the least.
    fn floor(&self) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Harmonics { mean, terms } => mean - terms.iter().map(|[a, b]| a.hypot(*b)).sum::<f64>(),
            Self::Samples(values) => values.iter().copied().fold(f64::INFINITY, f64::min),
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::Constant(value) => value.is_finite(),
            Self::Harmonics { mean, terms } => mean.is_finite() && terms.iter().flatten().all(|term| term.is_finite()),
            Self::Samples(values) => !values.is_empty() && values.iter().all(|value| value.is_finite()),
        }
    }
}

/// A mesh that is a spring.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearMesh {
    stiffness: Periodic,
    error: Periodic,
}

impl LinearMesh {
    /// From stiffness (N/m) and error (m): the approach at which flanks touch.
    ///
    /// # Errors
    /// [`MeshError::Option`] for numbers that are none, and for a stiffness that is not surely 0 or more.
    pub fn new(stiffness: Periodic, error: Periodic) -> Result<Self, MeshError> {
        let least = stiffness.floor();
        if !(stiffness.is_finite() && least >= 0.0) {
            let allowed = "0 or more all over the cycle, finite, in N/m";
            return Err(MeshError::Option { name: "least mesh stiffness", value: least, allowed });
        }
        if !error.is_finite() {
            return Err(MeshError::Option { name: "mesh error", value: f64::NAN, allowed: "finite numbers, in m" });
        }
        Ok(Self { stiffness, error })
    }

    /// A constant stiffness (N/m) without error.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn constant(stiffness: f64) -> Result<Self, MeshError> {
        Self::new(Periodic::Constant(stiffness), Periodic::Constant(0.0))
    }
}

impl MeshLaw for LinearMesh {
    fn response(&self, mesh_cycle: f64, approach: f64) -> MeshResponse {
        let closing = approach - self.error.at(mesh_cycle);
        if !(closing > 0.0) {
            return MeshResponse::default();
        }
        let stiffness = self.stiffness.at(mesh_cycle).max(0.0);
        MeshResponse { force: stiffness * closing, stiffness }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_springs() {
        let mesh = LinearMesh::constant(4e8).unwrap();
        assert_eq!(mesh.response(0.3, 1e-6), MeshResponse { force: 4e8 * 1e-6, stiffness: 4e8 });
        assert_eq!(mesh.response(0.3, -1e-6), MeshResponse::default());
        let stiffness = Periodic::Harmonics { mean: 5e8, terms: vec![[1e8, 0.0], [0.0, 5e7]] };
        let error = Periodic::Samples(vec![0.0, 2e-6]);
        let mesh = LinearMesh::new(stiffness, error).unwrap();
        for cycle in [0.125, 7.125, -2.875] {
            let expected = 5e8 + 1e8 * (TAU / 8.0).cos() + 5e7;
            let answer = mesh.response(cycle, 3e-6);
            assert!((answer.stiffness / expected - 1.0).abs() < 1e-12);
            // a quarter of the way from sample to sample
            assert!((answer.force / (expected * 2.5e-6) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn extreme_springs_are_refused() {
        for stiffness in [Periodic::Constant(-1.0), Periodic::Constant(f64::NAN), Periodic::Samples(vec![])] {
            assert!(LinearMesh::new(stiffness, Periodic::Constant(0.0)).is_err());
        }
        let waves = Periodic::Harmonics { mean: 1.0, terms: vec![[2.0, 0.0]] };
        assert!(LinearMesh::new(waves, Periodic::Constant(0.0)).is_err());
        assert!(LinearMesh::new(Periodic::Constant(1.0), Periodic::Constant(f64::INFINITY)).is_err());
    }
}
