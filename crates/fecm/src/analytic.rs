//! Closed forms of contact, shared by tests, documentation and figures.
//!
//! `E*` is the contact modulus, `1 / E* = (1 - nu_1^2) / E_1 + (1 - nu_2^2) / E_2` (plane stress: without `nu`).

use std::f64::consts::PI;

/// Hertz line contact (K. L. Johnson, *Contact Mechanics*, 1985, section 4.2(c)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineContact {
    /// Half width `b = sqrt(4 P R / (pi E*))` (m).
    pub half_width: f64,
    /// Peak pressure `p_0 = 2 P / (pi b)` (Pa).
    pub peak_pressure: f64,
}

/// Line contact of cylinders of relative radius `radius` (m) under `line_load` (N/m), contact modulus `modulus` (Pa).
#[must_use]
pub fn hertz_line(line_load: f64, radius: f64, modulus: f64) -> LineContact {
    let half_width = (4.0 * line_load * radius / (PI * modulus)).sqrt();
    LineContact { half_width, peak_pressure: 2.0 * line_load / (PI * half_width) }
}

/// Displacement of the centre of a line contact of half width `b` relative to the point at depth `h` below it, half-plane in plane strain:
/// `P (1 - nu^2) / (pi E) [2 ln(2 h / b) - nu / (1 - nu)]` for `h >> b` (Johnson Eq. (5.56)).
#[must_use]
pub fn line_contact_compression(line_load: f64, young: f64, poisson: f64, half_width: f64, depth: f64) -> f64 {
    line_load * (1.0 - poisson * poisson) / (PI * young)
        * (2.0 * (2.0 * depth / half_width).ln() - poisson / (1.0 - poisson))
}

/// Hertz point contact of spheres (Johnson section 4.2(a)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointContact {
    /// Contact radius `a = (3 P R / (4 E*))^(1/3)` (m).
    pub radius: f64,
    /// Peak pressure `3 P / (2 pi a^2)` (Pa).
    pub peak_pressure: f64,
    /// Approach of distant points `a^2 / R` (m).
    pub approach: f64,
}

/// Point contact of relative radius `radius` (m) under `load` (N), contact modulus `modulus` (Pa).
#[must_use]
pub fn hertz_point(load: f64, radius: f64, modulus: f64) -> PointContact {
    let a = (0.75 * load * radius / modulus).cbrt();
    PointContact { radius: a, peak_pressure: 1.5 * load / (PI * a * a), approach: a * a / radius }
}

/// Pressure (Pa) under a rigid flat punch of half width `a` (m) at `x`, plane: `P / (pi sqrt(a^2 - x^2))` (Johnson Eq. (2.64)).
#[must_use]
pub fn flat_punch_pressure(line_load: f64, a: f64, x: f64) -> f64 {
    line_load / (PI * (a * a - x * x).sqrt())
}

/// Indentation (m) of a half-space by a rigid circular flat punch of radius `a` (m): `P / (2 a E*)` (Johnson Eq. (3.36)).
#[must_use]
pub fn circular_punch_indentation(load: f64, a: f64, modulus: f64) -> f64 {
    load / (2.0 * a * modulus)
}
