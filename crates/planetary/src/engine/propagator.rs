//! Exact motion of a body over a step under a force that is a polynomial in the step.
//!
//! A coordinate of the housing, `q'' + 2 zeta w q' + w^2 q = f`, is advanced by the exponential of the system augmented with the derivatives of the force and the repeated
//! integrals of the rate (C. F. Van Loan, *IEEE Trans. Autom. Control* 23, 1978, 395-404): no mode is moved in frequency or damped, whatever its frequency. A rigid
//! body moves on polynomials, exactly where it does not spin; gyroscopic moments enter by collocation, of order `2 s`.
//!
//! To connections a coordinate shows the projection of its rate on the polynomials of degree `s - 1` (its first `s` moments over the step are exact), and as position the
//! integral of that from its start, which ends where the coordinate ends. So the work of the forces is exact, a body takes and gives the energy that it has, and connections that are springs make a
//! method that is stable for any stiffness and any step, and conserves energy: `lambda . u` summed over the stages is the work done on the body.
//!
//! | symbol | is |
//! |---|---|
//! | `q, v` | position and rate at the start of the step |
//! | `f_j` | force at stage `j` |
//! | `u_i` | projected rate at stage `i` |
//! | `q_i = q + h sum_j A_ij u_j` | position at stage `i`, `A` the integrals of the stages |

use nalgebra::{DMatrix, Matrix3};

use super::rows::RIGID;
use super::stages::{Stages, shifted_legendre};
use super::system::Inertia;

/// A coordinate of the housing over a step, as rows of factors of `q, v, f_0 .. f_(s-1)`: positions at the stages, then the rate at the end.
#[derive(Debug, Clone)]
pub(super) struct ModeStep {
    pub rows: Vec<f64>,
}

impl ModeStep {
    /// Of a circular frequency (rad/s) and damping ratio over a step (s).
    #[allow(non_snake_case)]
    pub fn new(stages: &Stages, h: f64, w: f64, zeta: f64) -> Self {
        let s = stages.count;
        // the size of q in which it is like v
        let size = w.max(1.0 / h);
        // size q, v, h f and its derivatives, repeated integrals of v
        let n = 2 + 2 * s;
        let mut A = DMatrix::<f64>::zeros(n, n);
        A[(0, 1)] = h * size;
        (A[(1, 0)], A[(1, 1)], A[(1, 2)]) = (-h * w * w / size, -2.0 * zeta * w * h, 1.0);
        for m in 1..s {
            A[(1 + m, 2 + m)] = 1.0;
        }
        A[(2 + s, 1)] = 1.0;
        for m in 1..s {
            A[(2 + s + m, 1 + s + m)] = 1.0;
        }
        let E = A.exp();
        // start of the chain from q, v, f_j
        let mut start = DMatrix::<f64>::zeros(n, 2 + s);
        (start[(0, 0)], start[(1, 1)]) = (size, 1.0);
        for j in 0..s {
            let mut factorial = 1.0;
            for (m, coefficient) in monomials(&stages.nodes, j).into_iter().enumerate() {
                factorial *= (m as f64).max(1.0);
                start[(2 + m, 2 + j)] = h * factorial * coefficient;
            }
        }
        let end = E * start;
        let columns = 2 + s;
        // projected rates at the stages
        let mut rates = DMatrix::<f64>::zeros(s, columns);
        for k in 0..s {
            for column in 0..columns {
                let moment: f64 = (0..=k).map(|m| legendre_from_end(k, m) * end[(2 + s + m, column)]).sum();
                for i in 0..s {
                    rates[(i, column)] += (2 * k + 1) as f64 * shifted_legendre(k, stages.nodes[i]) * moment;
                }
            }
        }
        let mut rows = Vec::with_capacity((s + 1) * columns);
        for i in 0..s {
            for column in 0..columns {
                let moved: f64 = (0..s).map(|j| stages.integral[i * s + j] * rates[(j, column)]).sum();
                rows.push(h * moved + if column == 0 { 1.0 } else { 0.0 });
            }
        }
        rows.extend((0..columns).map(|column| end[(1, column)]));
        Self { rows }
    }
}

/// Coefficients of a Lagrange polynomial, of rising powers.
fn monomials(nodes: &[f64], j: usize) -> Vec<f64> {
    let mut found = vec![1.0];
    for (k, node) in nodes.iter().enumerate() {
        if k == j {
            continue;
        }
        let scale = 1.0 / (nodes[j] - node);
        let mut next = vec![0.0; found.len() + 1];
        for (m, value) in found.iter().enumerate() {
            next[m] -= scale * node * value;
            next[m + 1] += scale * value;
        }
        found = next;
    }
    found
}

/// Factor of `(1 - theta)^m / m!` in the Legendre polynomial of a degree on 0 to 1.
fn legendre_from_end(degree: usize, m: usize) -> f64 {
    // P_k(1 - 2 y) = sum_m (-1)^m C(k, m) C(k + m, m) y^m
    let choose = |n: usize, k: usize| (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
    let factorial: f64 = (1..=m).map(|i| i as f64).product();
    let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
    sign * choose(degree, m) * choose(degree + m, m) * factorial
}

/// A rigid body over a step.
#[derive(Debug, Clone)]
pub(super) struct BodyStep {
    /// Translation: positions at the stages from forces, `s x s` by rows (m/N).
    translation: Vec<f64>,
    /// `h b_j / m`.
    impulse: Vec<f64>,
    /// `h theta_i`.
    drift: Vec<f64>,
    /// Rotations at the stages from rates at the start, `3 s x 3`.
    rotation_drift: DMatrix<f64>,
    /// Rotations at the stages from moments, `3 s x 3 s` (rad/(N m)).
    rotation: DMatrix<f64>,
    /// Rates of rotation at the end, from those at the start and from moments.
    spin: (DMatrix<f64>, DMatrix<f64>),
}

impl BodyStep {
    /// Of a body over a step (s), the carrier at a speed (rad/s).
    #[allow(non_snake_case)]
    pub fn new(stages: &Stages, h: f64, body: &Inertia, speed: f64) -> Self {
        let s = stages.count;
        let A = |i: usize, j: usize| h * stages.integral[i * s + j];
        // weights of the rule: the integral to the end, from that of every polynomial
        let weights: Vec<f64> = fecm::element::lagrange::gauss_rule(s).into_iter().map(|(_, w)| 0.5 * h * w).collect();
        let translation =
            (0..s * s).map(|k| (0..s).map(|l| A(k / s, l) * A(l, k % s)).sum::<f64>() / body.mass).collect();
        let tensor = Matrix3::from_fn(|i, j| body.tensor[i][j]);
        // moments of inertia are positive
        let inverse = tensor.try_inverse().unwrap_or_default();
        let gyroscopic = inverse * Matrix3::from_fn(|i, j| speed * body.gyroscopic[i][j]);
        let block = |f: &dyn Fn(usize, usize) -> Matrix3<f64>| {
            let mut whole = DMatrix::<f64>::zeros(3 * s, 3 * s);
            for i in 0..s {
                for j in 0..s {
                    whole.fixed_view_mut::<3, 3>(3 * i, 3 * j).copy_from(&f(i, j));
                }
            }
            whole
        };
        let unit = |i: usize, j: usize| if i == j { Matrix3::identity() } else { Matrix3::zeros() };
        // u = v + A (I^-1 f - N u): one plus a skew matrix in the metric of the inertia is never singular
        let left = block(&|i, j| unit(i, j) + gyroscopic * A(i, j));
        let left = left.try_inverse().unwrap_or_else(|| DMatrix::identity(3 * s, 3 * s));
        let mut ones = DMatrix::<f64>::zeros(3 * s, 3);
        (0..3 * s).for_each(|k| ones[(k, k % 3)] = 1.0);
        let from_rate = &left * ones;
        let from_moment = &left * block(&|i, j| inverse * A(i, j));
        let integrate = block(&|i, j| Matrix3::identity() * A(i, j));
        let mut sum = DMatrix::<f64>::zeros(3, 3 * s);
        for j in 0..s {
            sum.fixed_view_mut::<3, 3>(0, 3 * j).copy_from(&(Matrix3::identity() * weights[j]));
        }
        let mut spread = DMatrix::<f64>::zeros(3 * s, 3 * s);
        let mut turned = DMatrix::<f64>::zeros(3 * s, 3 * s);
        for j in 0..s {
            spread.fixed_view_mut::<3, 3>(3 * j, 3 * j).copy_from(&inverse);
            turned.fixed_view_mut::<3, 3>(3 * j, 3 * j).copy_from(&gyroscopic);
        }
        Self {
            translation,
            impulse: weights.iter().map(|w| w / body.mass).collect(),
            drift: stages.nodes.iter().map(|node| h * node).collect(),
            spin: (DMatrix::identity(3, 3) - &sum * &turned * &from_rate, &sum * (spread - turned * &from_moment)),
            rotation_drift: &integrate * from_rate,
            rotation: integrate * from_moment,
        }
    }

    /// Position of one coordinate at a stage from the force on another at a stage.
    pub fn compliance(&self, (i, a): (usize, usize), (j, b): (usize, usize)) -> f64 {
        let s = self.drift.len();
        match (a < 3, b < 3) {
            (true, true) if a == b => self.translation[i * s + j],
            (false, false) => self.rotation[(3 * i + a - 3, 3 * j + b - 3)],
            _ => 0.0,
        }
    }

    /// Positions at the stages and rates at the end; `forces` of the stages, one after the other.
    pub fn advance(&self, q: &[f64], v: &[f64], forces: &[[f64; RIGID]], at: &mut [[f64; RIGID]]) -> [f64; RIGID] {
        let s = self.drift.len();
        let mut end = [0.0; RIGID];
        for a in 0..3 {
            end[a] = v[a];
            for j in 0..s {
                end[a] += self.impulse[j] * forces[j][a];
            }
            for i in 0..s {
                let pushed: f64 = (0..s).map(|j| self.translation[i * s + j] * forces[j][a]).sum();
                at[i][a] = q[a] + self.drift[i] * v[a] + pushed;
            }
            let (from_rate, from_moment) = &self.spin;
            let turned = |matrix: &DMatrix<f64>, drift: &DMatrix<f64>, row: usize| {
                let mut sum = 0.0;
                for b in 0..3 {
                    sum += drift[(row, b)] * v[3 + b];
                    for j in 0..s {
                        sum += matrix[(row, 3 * j + b)] * forces[j][3 + b];
                    }
                }
                sum
            };
            end[3 + a] = turned(from_moment, from_rate, a);
            for i in 0..s {
                at[i][3 + a] = q[3 + a] + turned(&self.rotation, &self.rotation_drift, 3 * i + a);
            }
        }
        end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Position and rate of a damped oscillator from rest under a force `t^n`, n up to 3, by its closed form.
    fn exact(w: f64, zeta: f64, q: f64, v: f64, polynomial: &[f64], t: f64) -> (f64, f64) {
        // particular solution: w^2 p + 2 zeta w p' + p'' = f, from the highest power down
        let n = polynomial.len();
        let mut p = vec![0.0; n + 2];
        for k in (0..n).rev() {
            let (k1, k2) = ((k + 1) as f64, ((k + 1) * (k + 2)) as f64);
            p[k] = (polynomial[k] - 2.0 * zeta * w * k1 * p[k + 1] - k2 * p[k + 2]) / (w * w);
        }
        let at = |x: f64| (0..n).rev().fold(0.0, |sum, k| sum * x + p[k]);
        let rate = |x: f64| (1..n).rev().fold(0.0, |sum, k| sum * x + k as f64 * p[k]);
        let (a, b) = (q - at(0.0), v - rate(0.0));
        let wd = w * (1.0 - zeta * zeta).sqrt();
        let (sin, cos) = (wd * t).sin_cos();
        let decay = (-zeta * w * t).exp();
        let c = (b + zeta * w * a) / wd;
        let free = decay * (a * cos + c * sin);
        let free_rate = decay * (-zeta * w * (a * cos + c * sin) + wd * (-a * sin + c * cos));
        (free + at(t), free_rate + rate(t))
    }

    #[test]
    fn analytic_oscillators_of_any_frequency() {
        let h: f64 = 3.5e-5;
        for count in 1..=4 {
            let stages = Stages::new(count);
            for angle in [0.05, 0.7, 3.0, 40.0, 900.0] {
                for zeta in [0.0, 0.02, 0.6] {
                    let w = angle / h;
                    let own = ModeStep::new(&stages, h, w, zeta);
                    let polynomial: Vec<f64> = (0..count).map(|k| (1.0 - 0.7 * k as f64) / h.powi(k as i32)).collect();
                    let force = |x: f64| (0..count).rev().fold(0.0, |sum, k| sum * x * h + polynomial[k]);
                    let (q, v) = (0.4 * h * h, -0.3 * h);
                    let inputs: Vec<f64> = [q, v].into_iter().chain(stages.nodes.iter().map(|x| force(*x))).collect();
                    let columns = 2 + count;
                    let row = |i: usize| -> f64 {
                        own.rows[i * columns..(i + 1) * columns].iter().zip(&inputs).map(|(a, b)| a * b).sum()
                    };
                    let (end, rate) = exact(w, zeta, q, v, &polynomial, h);
                    let scale = h + v.abs() + w * q.abs();
                    // rounding of the reference: its particular solution divides by the frequency once per power of the force
                    let tolerance = 1e-11 + 64.0 * f64::EPSILON * angle.powi(-(count as i32));
                    assert!(
                        (row(count) - rate).abs() < tolerance * scale,
                        "{count} {angle} {zeta}: {} {rate}",
                        row(count)
                    );
                    // the polynomial of the position ends where the coordinate does
                    let positions = std::iter::once(q).chain((0..count).map(row));
                    let found: f64 = positions.zip(&stages.motion_end).map(|(a, b)| a * b).sum();
                    assert!((found - end).abs() < tolerance * scale * h, "{count} {angle} {zeta}: {found} {end}");
                }
            }
        }
    }

    /// `sum_i b_i f_i u_i` is the energy taken: a body gives and takes what it has, for any force of the stages.
    #[test]
    fn invariant_work_is_energy() {
        let h: f64 = 2e-5;
        for count in 1..=4 {
            let stages = Stages::new(count);
            let weights: Vec<f64> =
                fecm::element::lagrange::gauss_rule(count).iter().map(|(_, w)| 0.5 * h * w).collect();
            for angle in [0.01, 1.0, 8.0, 300.0] {
                let w = angle / h;
                let own = ModeStep::new(&stages, h, w, 0.0);
                let (q, v) = (0.3 / w, 0.8);
                let forces: Vec<f64> = (0..count).map(|j| (1.3 * j as f64 - 0.9) / h).collect();
                let inputs: Vec<f64> = [q, v].into_iter().chain(forces.iter().copied()).collect();
                let columns = 2 + count;
                let row = |i: usize| -> f64 {
                    own.rows[i * columns..(i + 1) * columns].iter().zip(&inputs).map(|(a, b)| a * b).sum()
                };
                let held: Vec<f64> = std::iter::once(q).chain((0..count).map(row)).collect();
                let rate = |i: usize| -> f64 {
                    let slopes = &stages.slope[i * (count + 1)..(i + 1) * (count + 1)];
                    slopes.iter().zip(&held).map(|(a, b)| a * b).sum::<f64>() / h
                };
                let work: f64 = (0..count).map(|i| weights[i] * forces[i] * rate(i)).sum();
                let end: f64 = held.iter().zip(&stages.motion_end).map(|(a, b)| a * b).sum();
                let energy = |q: f64, v: f64| 0.5 * (v * v + w * w * q * q);
                let taken = energy(end, row(count)) - energy(q, v);
                assert!((work - taken).abs() < 1e-10, "{count} {angle}: {work} {taken}");
            }
        }
    }
}
