//! Cubic splines (de Boor 1978, A Practical Guide to Splines, chapter IV) and Hermite cubics.
//!
//! Not-a-knot splines are stored as values and slopes at their nodes and evaluated as Hermite cubics. Interior
//! slopes `s_i` of nodes with spacings `h_i` and secants `q_i` solve
//! `h_i s_(i-1) + 2 (h_(i-1) + h_i) s_i + h_(i-1) s_(i+1) = 3 (h_i q_(i-1) + h_(i-1) q_i)`;
//! the not-a-knot condition makes the third derivative continuous at the second and last but one
//! node. Three nodes give the parabola, two the line, one a constant.
//! Periodic splines are given by their second derivatives at the nodes.
//! Verified by tests of `hums` (`resampling.rs`: scipy's `CubicSpline`, order four) and `lpm` (curves: order four) and below.

/// Slopes at equidistant nodes of spacing 1, written to `slopes` (cleared first).
pub fn uniform_slopes(y: &[f64], slopes: &mut Vec<f64>) {
    slopes.clear();
    let n = y.len();
    match n {
        0 => return,
        1 => return slopes.push(0.0),
        2 => return slopes.extend([y[1] - y[0]; 2]),
        3 => return slopes.extend(parabola([0.0, 1.0, 2.0], [y[0], y[1], y[2]])),
        _ => {}
    }
    // Forward sweep: slopes[i] holds the reduced right side, c the reduced upper diagonal, which
    // converges to 2 - sqrt 3 within 30 rows, so that only those are kept.
    const KEPT: usize = 32;
    let mut upper = [0.0; KEPT];
    upper[0] = 2.0;
    for i in 1..KEPT {
        upper[i] = 1.0 / (4.0 - upper[i - 1]);
    }
    let limit = upper[KEPT - 1];
    let c = |i: usize| if i < KEPT { upper[i] } else { limit };
    slopes.resize(n, 0.0);
    let mut last = (5.0 * (y[1] - y[0]) + (y[2] - y[1])) / 2.0;
    slopes[0] = last;
    for i in 1..n - 1 {
        last = (3.0 * (y[i + 1] - y[i - 1]) - last) * c(i);
        slopes[i] = last;
    }
    let end = (5.0 * (y[n - 1] - y[n - 2]) + (y[n - 2] - y[n - 3])) / 2.0;
    last = (end - 2.0 * last) / (1.0 - 2.0 * c(n - 2));
    slopes[n - 1] = last;
    for i in (0..n - 1).rev() {
        last = slopes[i] - c(i) * last;
        slopes[i] = last;
    }
}

/// Slopes at strictly increasing nodes `x` (unit of `y` per unit of `x`).
#[must_use]
pub fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len().min(y.len());
    let h = |i: usize| x[i + 1] - x[i];
    let q = |i: usize| (y[i + 1] - y[i]) / h(i);
    match n {
        0 => return Vec::new(),
        1 => return vec![0.0],
        2 => return vec![q(0); 2],
        3 => return parabola([x[0], x[1], x[2]], [y[0], y[1], y[2]]).to_vec(),
        _ => {}
    }
    let end = |near: f64, far: f64, q_near: f64, q_far: f64| {
        ((near + 2.0 * (near + far)) * far * q_near + near * near * q_far) / (near + far)
    };
    let mut upper = vec![0.0; n];
    let mut s = vec![0.0; n];
    upper[0] = (h(0) + h(1)) / h(1);
    s[0] = end(h(0), h(1), q(0), q(1)) / h(1);
    for i in 1..n - 1 {
        let pivot = 2.0 * (h(i - 1) + h(i)) - h(i) * upper[i - 1];
        upper[i] = h(i - 1) / pivot;
        s[i] = (3.0 * (h(i) * q(i - 1) + h(i - 1) * q(i)) - h(i) * s[i - 1]) / pivot;
    }
    let lower = h(n - 2) + h(n - 3);
    let right = end(h(n - 2), h(n - 3), q(n - 2), q(n - 3));
    s[n - 1] = (right - lower * s[n - 2]) / (h(n - 3) - lower * upper[n - 2]);
    for i in (0..n - 1).rev() {
        s[i] -= upper[i] * s[i + 1];
    }
    s
}

fn parabola(x: [f64; 3], y: [f64; 3]) -> [f64; 3] {
    let q = [(y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])];
    let curvature = (q[1] - q[0]) / (x[2] - x[0]);
    let at = |t: f64| q[0] + curvature * (2.0 * t - x[0] - x[1]);
    [at(x[0]), at(x[1]), at(x[2])]
}

/// Hermite cubic on an interval of length `h`; `u` in 0..=1.
#[inline]
#[must_use]
pub fn hermite(u: f64, h: f64, y: [f64; 2], s: [f64; 2]) -> f64 {
    let rise = y[1] - y[0];
    let (a, b) = (s[0] * h, s[1] * h);
    y[0] + u * (a + u * (3.0 * rise - 2.0 * a - b + u * (a + b - 2.0 * rise)))
}

/// Derivative of [`hermite`] with respect to the abscissa.
#[inline]
#[must_use]
pub fn hermite_slope(u: f64, h: f64, y: [f64; 2], s: [f64; 2]) -> f64 {
    let rise = y[1] - y[0];
    let (a, b) = (s[0] * h, s[1] * h);
    (a + u * (2.0 * (3.0 * rise - 2.0 * a - b) + u * 3.0 * (a + b - 2.0 * rise))) / h
}

/// Second derivatives at the nodes of the periodic cubic spline of intervals `width` and secants `slope` on them (the last interval leads back
/// to the first node). Cyclic tridiagonal system, solved by Sherman and Morrison's formula; not finite where the system is singular.
#[must_use]
pub fn periodic_second_derivatives(width: &[f64], slope: &[f64]) -> Vec<f64> {
    let n = width.len().min(slope.len());
    // with one or two nodes neighbours coincide; symmetry leaves a constant and a pair of equal and opposite bends
    match n {
        0 => return Vec::new(),
        1 => return vec![0.0],
        2 => {
            let bend = 6.0 * (slope[0] - slope[1]) / (width[0] + width[1]);
            return vec![bend, -bend];
        }
        _ => {}
    }
    let previous = |i: usize| (i + n - 1) % n;
    let rhs: Vec<f64> = (0..n).map(|i| 6.0 * (slope[i] - slope[previous(i)])).collect();
    let mut diagonal: Vec<f64> = (0..n).map(|i| 2.0 * (width[previous(i)] + width[i])).collect();
    let corner = width[n - 1];
    let g = -diagonal[0];
    diagonal[0] -= g;
    diagonal[n - 1] -= corner * corner / g;
    let solve = |mut r: Vec<f64>| {
        let mut d = diagonal.clone();
        for i in 1..n {
            let f = width[i - 1] / d[i - 1];
            d[i] -= f * width[i - 1];
            r[i] -= f * r[i - 1];
        }
        r[n - 1] /= d[n - 1];
        for i in (0..n - 1).rev() {
            r[i] = (r[i] - width[i] * r[i + 1]) / d[i];
        }
        r
    };
    let y = solve(rhs);
    let mut u = vec![0.0; n];
    (u[0], u[n - 1]) = (g, corner);
    let z = solve(u);
    let factor = (y[0] + corner / g * y[n - 1]) / (1.0 + z[0] + corner / g * z[n - 1]);
    y.iter().zip(&z).map(|(y, z)| y - factor * z).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A cubic is its own not-a-knot spline, on any nodes.
    #[test]
    fn analytic_cubics_are_reproduced() {
        let (f, slope) = (|x: f64| 1.0 + x * (2.0 - x * (0.5 + 0.25 * x)), |x: f64| 2.0 - x * (1.0 + 0.75 * x));
        for nodes in [vec![0.0, 1.0, 2.0, 3.0, 4.0], vec![-1.0, -0.4, 0.3, 1.1, 1.5, 3.0]] {
            let values: Vec<f64> = nodes.iter().map(|x| f(*x)).collect();
            let found = slopes(&nodes, &values);
            for (found, x) in found.iter().zip(&nodes) {
                assert_relative_eq!(*found, slope(*x), max_relative = 1e-12, epsilon = 1e-12);
            }
            for (x, (y, s)) in nodes.windows(2).zip(values.windows(2).zip(found.windows(2))) {
                let (u, h) = (0.3, x[1] - x[0]);
                assert_relative_eq!(hermite(u, h, [y[0], y[1]], [s[0], s[1]]), f(x[0] + u * h), epsilon = 1e-12);
                let at = hermite_slope(u, h, [y[0], y[1]], [s[0], s[1]]);
                assert_relative_eq!(at, slope(x[0] + u * h), epsilon = 1e-12);
            }
        }
    }

    /// The equations of the periodic spline hold at every node, for two nodes and more.
    #[test]
    fn invariant_periodic_slopes_are_continuous() {
        for n in [2_usize, 3, 4, 9] {
            let width: Vec<f64> = (0..n).map(|i| 1.0 + 0.3 * (i as f64).sin()).collect();
            let values: Vec<f64> = (0..n).map(|i| (1.7 * i as f64).cos()).collect();
            let slope: Vec<f64> = (0..n).map(|i| (values[(i + 1) % n] - values[i]) / width[i]).collect();
            let m = periodic_second_derivatives(&width, &slope);
            for i in 0..n {
                let (before, next) = ((i + n - 1) % n, (i + 1) % n);
                let leaving = slope[i] - width[i] * (2.0 * m[i] + m[next]) / 6.0;
                let arriving = slope[before] + width[before] * (m[before] + 2.0 * m[i]) / 6.0;
                assert_relative_eq!(leaving, arriving, epsilon = 1e-13);
            }
        }
    }
}
