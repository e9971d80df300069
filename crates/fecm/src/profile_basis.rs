//! How loads and displacements vary along the profile of a flank.
//!
//! Legendre polynomials of the involute's arc length `a = s^2 / (2 r_b)` (m, `s` the roll distance) from the fillet to the tip, orthonormal:
//! `int phi_m phi_n da = 1` for `m = n`, else 0. A unit force at `a_j` is represented by `sum_m phi_m(a_j) phi_m(a)`, the polynomial that has the same
//! work as the force on every polynomial of the basis. See [`crate::nearfield`] for why this suffices.

use gear_geom::Gear;

use crate::element::lagrange::legendre;

/// Polynomials of arc length along a flank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileBasis {
    /// Arc lengths of the two ends (m), ascending.
    ends: [f64; 2],
    order: usize,
    base_radius: f64,
}

impl ProfileBasis {
    /// Polynomials up to a degree on the involute of a gear's teeth.
    #[must_use]
    pub fn new(gear: &Gear, order: usize) -> Self {
        let base_radius = gear.base_radius();
        let arc = |radius: f64| (radius * radius - base_radius * base_radius).max(0.0) / (2.0 * base_radius);
        let (one, other) = (arc(gear.form_radius()), arc(gear.tip_form_radius()));
        Self { ends: [one.min(other), one.max(other)], order, base_radius }
    }

    /// Number of functions.
    #[must_use]
    pub fn count(&self) -> usize {
        self.order + 1
    }

    /// Length of the involute (m).
    #[must_use]
    pub fn length(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }

    /// Arc length at the lower end (m).
    #[must_use]
    pub fn start(&self) -> f64 {
        self.ends[0]
    }

    /// Arc length at a roll distance (m), clipped to the involute.
    #[must_use]
    pub fn arc(&self, roll: f64) -> f64 {
        (roll * roll / (2.0 * self.base_radius)).clamp(self.ends[0], self.ends[1])
    }

    /// All functions at an arc length (1/sqrt(m)).
    #[must_use]
    pub fn values(&self, arc: f64) -> Vec<f64> {
        let x = (2.0 * (arc - self.ends[0]) / self.length() - 1.0).clamp(-1.0, 1.0);
        (0..=self.order).map(|m| ((2 * m + 1) as f64 / self.length()).sqrt() * legendre(m, x).0).collect()
    }
}
