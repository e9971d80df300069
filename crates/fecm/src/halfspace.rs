//! Displacement of an elastic half-space and half-plane under a uniform patch of normal load.
//!
//! * Solid: the point load's `u_z = (1 + nu) / (2 pi E) [z^2 / R^3 + 2 (1 - nu) / R]` (Boussinesq; K. L. Johnson, *Contact Mechanics*, 1985,
//!   Eq. (3.18)) integrated over a rectangle. Both integrals are closed: `int int dA / R` is A. E. H. Love's (*Phil. Trans. R. Soc. A*
//!   228, 1929, 377-420; Johnson Eq. (3.25) at the surface), `int int z^2 / R^3 dA = z atan(x y / (z R))` at the corners.
//! * Plane: Flamant's `u_z = -2 / (pi E') ln r + (1 + nu') / (pi E') z^2 / r^2` (Johnson section 2.2; constants that cancel in
//!   differences are dropped, lengths in metres), with `E' = E`, `nu' = nu` for plane stress and `E / (1 - nu^2)`, `nu / (1 - nu)` for
//!   plane strain, integrated over a strip. Only differences between two places are meaningful.
//!
//! Closed forms are differences of large numbers far from narrow patches, so beyond eight half widths across the patch the narrow direction is
//! integrated by Gauss-Legendre quadrature instead (five points: relative error below 1e-12).
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
    let factor = (1.0 + nu) / (2.0 * PI * material.young_modulus);
    if x.hypot(z) > FAR * a {
        let line = |x: f64| {
            let rho_squared = x * x + z * z;
            let end = |y: f64| {
                let depth = z * z * y / (rho_squared * (rho_squared + y * y).sqrt());
                2.0 * (1.0 - nu) * (y / rho_squared.sqrt()).asinh() + depth
            };
            (end(y + b) - end(y - b)) / (2.0 * b)
        };
        return factor * mean_over(x, a, line);
    }
    let corner = |x: f64, y: f64| {
        // odd in both coordinates
        let sign = x.signum() * y.signum();
        let (x, y) = (x.abs(), y.abs());
        sign * (depth_integral(x, y, z) + 2.0 * (1.0 - nu) * potential_integral(x, y, z))
    };
    let sum = corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b);
    factor * sum / (4.0 * a * b)
}

/// Distance, in half widths of the patch, beyond which quadrature replaces the closed form.
const FAR: f64 = 8.0;

/// Mean of a function over `[x - a, x + a]` by five Gauss-Legendre points.
fn mean_over(x: f64, a: f64, f: impl Fn(f64) -> f64) -> f64 {
    const POINTS: [(f64, f64); 3] = [
        (0.0, 0.284_444_444_444_444_4),
        (0.538_469_310_105_683_1, 0.239_314_335_249_683_23),
        (0.906_179_845_938_664, 0.118_463_442_528_094_54),
    ];
    POINTS.iter().fold(0.0, |sum, &(at, weight)| match at {
        0.0 => sum + weight * f(x),
        _ => sum + weight * (f(x - a * at) + f(x + a * at)),
    })
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
    if x.hypot(z) > FAR * a {
        let point = |x: f64| {
            let squared = x * x + z * z;
            (-squared.ln() + (1.0 + nu) * z * z / squared) / (PI * e)
        };
        return mean_over(x, a, point);
    }
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
