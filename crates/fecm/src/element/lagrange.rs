//! One-dimensional Lagrange basis on Gauss-Lobatto-Legendre points, and Gauss quadrature.
//!
//! Gauss-Lobatto points keep the interpolation of curved boundaries and the conditioning sound at any order
//! (Karniadakis and Sherwin, *Spectral/hp Element Methods for CFD*, 2005, section 2.3 and appendix B).

/// Legendre polynomial `P_n(x)` and its derivative.
#[must_use]
pub fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut p0, mut p1) = (1.0, x);
    let (mut d0, mut d1) = (0.0, 1.0);
    if n == 0 {
        return (p0, d0);
    }
    for k in 1..n {
        let k_f = k as f64;
        let p2 = ((2.0 * k_f + 1.0) * x * p1 - k_f * p0) / (k_f + 1.0);
        let d2 = d0 + (2.0 * k_f + 1.0) * p1;
        (p0, p1, d0, d1) = (p1, p2, d1, d2);
    }
    (p1, d1)
}

/// Points and weights of the `n`-point Gauss rule on [-1, 1], exact to degree `2 n - 1`.
#[must_use]
pub fn gauss_rule(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            for _ in 0..50 {
                let (p, d) = legendre(n, x);
                let step = p / d;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            let (_, d) = legendre(n, x);
            (x, 2.0 / ((1.0 - x * x) * d * d))
        })
        .collect()
}

/// The `order + 1` Gauss-Lobatto-Legendre points of [-1, 1], ascending.
#[must_use]
pub fn lobatto_points(order: usize) -> Vec<f64> {
    let n = order as f64;
    (0..=order)
        .map(|i| {
            if i == 0 {
                return -1.0;
            }
            if i == order {
                return 1.0;
            }
            // interior points are the zeros of P_n'; Newton with P_n'' from Legendre's equation
            let mut x = -(std::f64::consts::PI * i as f64 / n).cos();
            for _ in 0..50 {
                let (p, d) = legendre(order, x);
                let second = (2.0 * x * d - n * (n + 1.0) * p) / (1.0 - x * x);
                let step = d / second;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            x
        })
        .collect()
}

/// Lagrange polynomials on given points.
#[derive(Debug, Clone)]
pub struct LagrangeBasis {
    points: Vec<f64>,
    /// `1 / prod_{j != i} (x_i - x_j)`.
    weights: Vec<f64>,
}

impl LagrangeBasis {
    /// Basis of polynomial order `order` on Gauss-Lobatto points.
    #[must_use]
    pub fn new(order: usize) -> Self {
        let points = lobatto_points(order);
        let weights = (0..points.len())
            .map(|i| {
                let others = (0..points.len()).filter(|&j| j != i);
                1.0 / others.map(|j| points[i] - points[j]).product::<f64>()
            })
            .collect();
        Self { points, weights }
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[f64] {
        &self.points
    }

    /// Values of all basis polynomials at `x`, into `values`.
    pub fn values_into(&self, x: f64, values: &mut [f64]) {
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.weights[i];
            for (j, &point) in self.points.iter().enumerate() {
                if j != i {
                    *value *= x - point;
                }
            }
        }
    }

    /// Derivatives of all basis polynomials at `x`, into `slopes`.
    pub fn derivatives_into(&self, x: f64, slopes: &mut [f64]) {
        let n = self.points.len();
        for (i, slope) in slopes.iter_mut().enumerate() {
            *slope = 0.0;
            for k in (0..n).filter(|&k| k != i) {
                let rest = (0..n).filter(|&j| j != i && j != k);
                *slope += rest.map(|j| x - self.points[j]).product::<f64>();
            }
            *slope *= self.weights[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_gauss_rule_integrates_polynomials_exactly() {
        for n in 1..12 {
            for degree in 0..2 * n {
                let sum: f64 = gauss_rule(n).iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-13, "n = {n}, degree {degree}: {sum} against {exact}");
            }
        }
    }

    #[test]
    fn analytic_lobatto_points_of_low_order() {
        assert_eq!(lobatto_points(1), vec![-1.0, 1.0]);
        assert!((lobatto_points(3)[1] + 0.2_f64.sqrt()).abs() < 1e-15);
        assert!((lobatto_points(4)[1] + (3.0_f64 / 7.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn invariant_basis_reproduces_polynomials_and_slopes() {
        for order in 1..=8 {
            let basis = LagrangeBasis::new(order);
            let (mut values, mut slopes) = (vec![0.0; order + 1], vec![0.0; order + 1]);
            for x in [-0.9, -0.3, 0.123, 0.77, 1.0] {
                basis.values_into(x, &mut values);
                basis.derivatives_into(x, &mut slopes);
                for power in 0..=order as i32 {
                    let at = |c: &[f64]| -> f64 { basis.points().iter().zip(c).map(|(p, c)| c * p.powi(power)).sum() };
                    let slope = if power == 0 { 0.0 } else { f64::from(power) * x.powi(power - 1) };
                    assert!((at(&values) - x.powi(power)).abs() < 1e-12);
                    assert!((at(&slopes) - slope).abs() < 1e-10);
                }
            }
        }
    }
}
