//! Displacement of an elastic half-space and half-plane under a uniform patch of normal load.
//!
//! * Solid: the point load's `u_z = (1 + nu) / (2 pi E) [z^2 / R^3 + 2 (1 - nu) / R]` (Boussinesq; K. L. Johnson, *Contact Mechanics*, 1985,
//!   Eq. (3.18)) integrated over a rectangle. Both integrals are closed: `int int dA / R` is A. E. H. Love's (*Phil. Trans. R. Soc. A*
//!   228, 1929, 377-420; Johnson Eq. (3.25) at the surface), `int int z^2 / R^3 dA = z atan(x y / (z R))` at the corners.
//! * Plane: Flamant's `u_z = -2 / (pi E') ln r + (1 + nu') / (pi E') z^2 / r^2` (Johnson section 2.2; constants that cancel in
//!   differences are dropped, lengths in metres), with `E' = E`, `nu' = nu` for plane stress and `E / (1 - nu^2)`, `nu / (1 - nu)` for
//!   plane strain, integrated over a strip. Only differences between two places are meaningful.
//!
//! Displacements are per unit total force, positive into the body. Checked in `tests/halfspace.rs` against quadrature, the point load
//! and published values.

use std::f64::consts::PI;

use crate::material::Material;

/// Normal displacement (m/N) at `(x, y)` and depth `z >= 0` (m) by a unit force spread over the rectangle `|x| <= a`, `|y| <= b` of the
/// surface of a half-space.
#[must_use]
pub fn rectangle_displacement(material: &Material, a: f64, b: f64, x: f64, y: f64, z: f64) -> f64 {
    let nu = material.poisson_ratio;
    let corner = |x: f64, y: f64| {
        // odd in both coordinates
        let sign = x.signum() * y.signum();
        let (x, y) = (x.abs(), y.abs());
        sign * (depth_integral(x, y, z) + 2.0 * (1.0 - nu) * potential_integral(x, y, z))
    };
    let sum = corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b);
    (1.0 + nu) / (2.0 * PI * material.young_modulus) * sum / (4.0 * a * b)
}

/// `int_0^x int_0^y dA / R` for `x, y, z >= 0`.
fn potential_integral(x: f64, y: f64, z: f64) -> f64 {
    let r = (x * x + y * y + z * z).sqrt();
    let mut value = 0.0;
    if x > 0.0 {
        value += x * ((y + r) / x.hypot(z)).ln();
    }
    if y > 0.0 {
        value += y * ((x + r) / y.hypot(z)).ln();
    }
    if z > 0.0 {
        value -= z * (x * y / (z * r)).atan();
    }
    value
}

/// `int_0^x int_0^y z^2 / R^3 dA` for `x, y, z >= 0`.
fn depth_integral(x: f64, y: f64, z: f64) -> f64 {
    if z > 0.0 { z * (x * y / (z * (x * x + y * y + z * z).sqrt())).atan() } else { 0.0 }
}

/// Normal displacement at `x` and depth `z >= 0` (m) by a unit force per length (N/m) spread over the strip `|x| <= a` of the edge of a
/// half-plane, up to a constant common to all places (m per N/m).
#[must_use]
pub fn strip_displacement(material: &Material, plane_strain: bool, a: f64, x: f64, z: f64) -> f64 {
    let (e, nu) = (material.young_modulus, material.poisson_ratio);
    let (e, nu) = if plane_strain { (e / (1.0 - nu * nu), nu / (1.0 - nu)) } else { (e, nu) };
    let end = |t: f64| {
        let squared = t * t + z * z;
        if squared == 0.0 {
            return 0.0;
        }
        let angle_part = if z > 0.0 { z * (t / z).atan() } else { 0.0 };
        let logarithm = 0.5 * t * squared.ln() - t + angle_part;
        (-2.0 * logarithm + (1.0 + nu) * angle_part) / (PI * e)
    };
    (end(x + a) - end(x - a)) / (2.0 * a)
}
