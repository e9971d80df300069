//! Stages of a step: Gauss points, the polynomials through them, and projection on them.
//!
//! Within a step forces of connections are polynomials of degree `s - 1` in `theta = (t - t_n) / h`, given by their values at the `s` Gauss points `theta_i`. Motion is
//! known to connections as the polynomial of degree `s` through its start and those points. Gauss quadrature is exact to degree `2 s - 1`, so the work of these
//! forces on these motions is the same on both sides of a connection, and the method is the Gauss collocation of order `2 s`
//! (E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 1996, IV.5) where bodies are free masses.
//!
//! A force that is no polynomial (a mesh whose teeth join within the step) is projected: its first `s` moments over the step are those of the law, by a finer Gauss rule.

use fecm::element::lagrange::{gauss_rule, legendre};

/// Points of the finer rule per stage.
const FINER: usize = 2;

/// Points, weights and matrices of a step of length 1.
#[derive(Debug, Clone)]
pub(super) struct Stages {
    /// Number of stages, `s`.
    pub count: usize,
    /// Gauss points in a step.
    pub nodes: Vec<f64>,
    /// Integrals of the Lagrange polynomials of the nodes from 0 to each node, `s x s` by rows.
    pub integral: Vec<f64>,
    /// Derivatives at the nodes of the polynomial through start and nodes, `s x (s + 1)` by rows, start first.
    pub slope: Vec<f64>,
    /// Value at the end of the polynomial through start and nodes.
    pub motion_end: Vec<f64>,
    /// Its derivative there.
    pub rate_end: Vec<f64>,
    /// Value at the end of the polynomial through the nodes.
    pub force_end: Vec<f64>,
    /// Points of the finer rule.
    pub points: Vec<f64>,
    /// Values at the points of the polynomial through start and nodes, by rows.
    pub value: Vec<f64>,
    /// Its derivatives.
    pub rate: Vec<f64>,
    /// From values at the points to those at the nodes of the projection, by rows.
    pub projection: Vec<f64>,
}

impl Stages {
    /// Of a number of stages, one or more.
    pub fn new(count: usize) -> Self {
        let rule = |n: usize| -> Vec<(f64, f64)> {
            gauss_rule(n).into_iter().map(|(x, w)| (0.5 * (x + 1.0), 0.5 * w)).collect()
        };
        let own = rule(count);
        let nodes: Vec<f64> = own.iter().map(|(x, _)| *x).collect();
        let with_start: Vec<f64> = std::iter::once(0.0).chain(nodes.iter().copied()).collect();
        let integral = nodes
            .iter()
            .flat_map(|&end| {
                (0..count).map({
                    let (own, nodes) = (&own, &nodes);
                    move |j| own.iter().map(|(x, w)| end * w * lagrange(nodes, j, end * x).0).sum()
                })
            })
            .collect();
        let rows = |places: &[f64], pick: fn((f64, f64)) -> f64| -> Vec<f64> {
            places
                .iter()
                .flat_map(|&x| (0..=count).map(move |j| (j, x)))
                .map(|(j, x)| pick(lagrange(&with_start, j, x)))
                .collect()
        };
        // one stage: the mean force, at the middle
        let fine = rule(if count == 1 { 1 } else { FINER * count });
        let points: Vec<f64> = fine.iter().map(|(x, _)| *x).collect();
        let projection = nodes
            .iter()
            .flat_map(|&x| {
                fine.iter().map(move |&(y, w)| {
                    let term = |k: usize| (2 * k + 1) as f64 * shifted_legendre(k, x) * shifted_legendre(k, y);
                    w * (0..count).map(term).sum::<f64>()
                })
            })
            .collect();
        Self {
            count,
            integral,
            slope: rows(&nodes, |(_, derivative)| derivative),
            motion_end: rows(&[1.0], |(value, _)| value),
            rate_end: rows(&[1.0], |(_, derivative)| derivative),
            force_end: (0..count).map(|j| lagrange(&nodes, j, 1.0).0).collect(),
            value: rows(&points, |(value, _)| value),
            rate: rows(&points, |(_, derivative)| derivative),
            points,
            projection,
            nodes,
        }
    }
}

/// Lagrange polynomial `j` of some places, and its derivative.
pub(super) fn lagrange(places: &[f64], j: usize, x: f64) -> (f64, f64) {
    let (mut value, mut derivative) = (1.0, 0.0);
    for (_, place) in places.iter().enumerate().filter(|(k, _)| *k != j) {
        let scale = 1.0 / (places[j] - place);
        derivative = (derivative * (x - place) + value) * scale;
        value *= (x - place) * scale;
    }
    (value, derivative)
}

/// Legendre polynomial on 0 to 1.
pub(super) fn shifted_legendre(degree: usize, x: f64) -> f64 {
    legendre(degree, 2.0 * x - 1.0).0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials of the degrees that stages hold are integrated, differentiated and projected exactly.
    #[test]
    fn analytic_polynomials() {
        for count in 1..=4 {
            let stages = Stages::new(count);
            let s = count;
            for degree in 0..=s as i32 {
                let p = |x: f64| x.powi(degree);
                let rate = |x: f64| if degree == 0 { 0.0 } else { f64::from(degree) * x.powi(degree - 1) };
                let held: Vec<f64> = std::iter::once(0.0).chain(stages.nodes.iter().copied()).map(p).collect();
                let row = |table: &[f64], i: usize| -> f64 {
                    table[i * (s + 1)..(i + 1) * (s + 1)].iter().zip(&held).map(|(a, b)| a * b).sum()
                };
                for (i, &x) in stages.nodes.iter().enumerate() {
                    assert!((row(&stages.slope, i) - rate(x)).abs() < 1e-12);
                    if degree < s as i32 {
                        let sum: f64 = (0..s).map(|j| stages.integral[i * s + j] * p(stages.nodes[j])).sum();
                        assert!((sum - x.powi(degree + 1) / f64::from(degree + 1)).abs() < 1e-14);
                        let n = stages.points.len();
                        let projected: f64 = (0..n).map(|q| stages.projection[i * n + q] * p(stages.points[q])).sum();
                        assert!((projected - p(x)).abs() < 1e-13);
                    }
                }
                for (q, &x) in stages.points.iter().enumerate() {
                    assert!((row(&stages.value, q) - p(x)).abs() < 1e-13);
                    assert!((row(&stages.rate, q) - rate(x)).abs() < 1e-12);
                }
                assert!((row(&stages.motion_end, 0) - 1.0).abs() < 1e-12);
            }
        }
    }
}
