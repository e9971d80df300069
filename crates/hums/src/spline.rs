//! Cubic splines with not-a-knot ends, as node slopes (de Boor 1978, A Practical Guide to Splines,
//! chapter IV).
//!
//! A spline is stored as values and slopes at its nodes and evaluated as Hermite cubics. Interior
//! slopes `s_i` of nodes with spacings `h_i` and secants `q_i` solve
//! `h_i s_(i-1) + 2 (h_(i-1) + h_i) s_i + h_(i-1) s_(i+1) = 3 (h_i q_(i-1) + h_(i-1) q_i)`;
//! the not-a-knot condition makes the third derivative continuous at the second and last but one
//! node. Three nodes give the parabola, two the line, one a constant.
//! Verified by `tests/resampling.rs` (scipy's `CubicSpline`, order four).

/// Slopes at equidistant nodes of spacing 1, written to `slopes` (cleared first).
pub(crate) fn uniform_slopes(y: &[f64], slopes: &mut Vec<f64>) {
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

/// Slopes at strictly increasing nodes `x`.
pub(crate) fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
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
pub(crate) fn hermite(u: f64, h: f64, y: [f64; 2], s: [f64; 2]) -> f64 {
    let rise = y[1] - y[0];
    let (a, b) = (s[0] * h, s[1] * h);
    y[0] + u * (a + u * (3.0 * rise - 2.0 * a - b + u * (a + b - 2.0 * rise)))
}

/// Derivative of [`hermite`] with respect to the abscissa.
#[inline]
pub(crate) fn hermite_slope(u: f64, h: f64, y: [f64; 2], s: [f64; 2]) -> f64 {
    let rise = y[1] - y[0];
    let (a, b) = (s[0] * h, s[1] * h);
    (a + u * (2.0 * (3.0 * rise - 2.0 * a - b) + u * 3.0 * (a + b - 2.0 * rise))) / h
}
