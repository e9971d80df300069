//! Influence of uniform patches on a half-space and half-plane: quadrature of the point load, published settlements, and no step
//! where one formula takes over from another.

use std::f64::consts::PI;

use fecm::Material;
use fecm::halfspace::{rectangle_displacement, strip_displacement};

const STEEL: Material = Material::STEEL;

/// Mean over a rectangle of the point load's displacement by midpoint quadrature on `n x n` points.
fn by_quadrature(a: f64, b: f64, at: [f64; 3], n: usize) -> f64 {
    let (e, nu) = (STEEL.young_modulus, STEEL.poisson_ratio);
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let x = at[0] - a * (2.0 * (i as f64 + 0.5) / n as f64 - 1.0);
            let y = at[1] - b * (2.0 * (j as f64 + 0.5) / n as f64 - 1.0);
            let r = (x * x + y * y + at[2] * at[2]).sqrt();
            sum += (1.0 + nu) / (2.0 * PI * e) * (at[2] * at[2] / r.powi(3) + 2.0 * (1.0 - nu) / r);
        }
    }
    sum / (n * n) as f64
}

#[test]
fn analytic_rectangle_equals_quadrature_of_the_point_load() {
    // away from the load by a patch size or more, where the midpoint rule converges fast
    for at in [[3e-3, 0.5e-3, 0.0], [0.0, 0.0, 2e-3], [1e-3, -2e-3, 1e-3], [0.3e-3, 4e-3, 0.0], [9e-3, 0.0, 0.5e-3]] {
        let (a, b) = (0.5e-3, 1e-3);
        let exact = rectangle_displacement(&STEEL, a, b, at[0], at[1], at[2]);
        // Richardson on the second-order midpoint rule
        let (coarse, fine) = (by_quadrature(a, b, at, 100), by_quadrature(a, b, at, 200));
        let quadrature = fine + (fine - coarse) / 3.0;
        assert!((exact / quadrature - 1.0).abs() < 1e-8, "{at:?}: {exact} against {quadrature}");
    }
}

/// `u = q B (1 - nu^2) / E * I` with influence factors `I` at the centre and the corner of a flexible rectangle `L x B`
/// (S. P. Timoshenko and J. N. Goodier, *Theory of Elasticity*, 3rd ed., 1970, art. 139; tabulated to two decimals in
/// J. E. Bowles, *Foundation Analysis and Design*).
#[test]
fn peer_timoshenko_settlement_of_rectangles() {
    let (e, nu) = (STEEL.young_modulus, STEEL.poisson_ratio);
    // the square's centre in closed form: 4 / pi ln(1 + sqrt 2)
    let square = rectangle_displacement(&STEEL, 1e-3, 1e-3, 0.0, 0.0, 0.0) * e * 2e-3 / (1.0 - nu * nu);
    assert!((square / (4.0 / PI * (1.0 + 2.0_f64.sqrt()).ln()) - 1.0).abs() < 1e-12);
    let width = 2e-3;
    for (ratio, centre, corner) in
        [(1.0, 1.12, 0.56), (1.5, 1.36, 0.68), (2.0, 1.53, 0.77), (5.0, 2.10, 1.05), (10.0, 2.54, 1.27)]
    {
        let length = ratio * width;
        // per unit force: q = 1 / (L B)
        let unit = (1.0 - nu * nu) / (e * length);
        let at = |x: f64, y: f64| rectangle_displacement(&STEEL, 0.5 * width, 0.5 * length, x, y, 0.0) / unit;
        assert!((at(0.0, 0.0) - centre).abs() < 5.5e-3, "centre of {ratio}: {}", at(0.0, 0.0));
        assert!((at(0.5 * width, 0.5 * length) - corner).abs() < 5.5e-3, "corner of {ratio}");
    }
}

#[test]
fn invariant_closed_form_and_quadrature_meet_without_a_step() {
    let a = 1e-5;
    for z in [0.0, 1e-5, 5e-5_f64] {
        let edge = f64::max(64.0 * a * a - z * z, 0.0).sqrt();
        let (inside, outside) = (edge * (1.0 - 1e-9), edge * (1.0 + 1e-9));
        for b in [1e-5, 1e-4, 1e-3] {
            for y in [0.0, 3e-4] {
                let near = rectangle_displacement(&STEEL, a, b, inside, y, z);
                let far = rectangle_displacement(&STEEL, a, b, outside, y, z);
                assert!((near / far - 1.0).abs() < 1e-8, "rectangle b {b} y {y} z {z}: {near} {far}");
            }
        }
        for plane_strain in [false, true] {
            let near = strip_displacement(&STEEL, plane_strain, a, inside, z);
            let far = strip_displacement(&STEEL, plane_strain, a, outside, z);
            assert!((near / far - 1.0).abs() < 1e-8, "strip z {z}");
        }
    }
}

/// A strip is a rectangle that goes on: differences between places agree as the rectangle grows (plane strain).
#[test]
fn invariant_long_rectangle_is_a_strip() {
    let (a, length) = (1e-4, 1.0);
    let rectangle = |x: f64, z: f64| rectangle_displacement(&STEEL, a, 0.5 * length, x, 0.0, z) * length;
    let strip = |x: f64, z: f64| strip_displacement(&STEEL, true, a, x, z);
    for (x, z) in [(0.0, 1e-3), (2e-4, 0.0), (5e-4, 5e-4), (3e-3, 0.0)] {
        let solid = rectangle(0.0, 0.0) - rectangle(x, z);
        let plane = strip(0.0, 0.0) - strip(x, z);
        assert!((solid / plane - 1.0).abs() < 1e-4, "at {x} {z}: {solid} against {plane}");
    }
}
