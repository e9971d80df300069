//! One step of each integration method inside a contact phase.
//!
//! | method | order | error estimate | stiff supports | source |
//! |---|---|---|---|---|
//! | Magnus | 6 | order-4 Magnus term | one coordinate only | Blanes, Casas, Oteo & Ros, Phys. Rep. 470 (2009), Eqs. (250)-(256) |
//! | Dormand-Prince | 5 | embedded order 4 | explicit: resolves them | Dormand & Prince, J. Comput. Appl. Math. 6 (1980) |
//! | ESDIRK | 4 | embedded order 3 | L-stable | Kennedy & Carpenter, Appl. Numer. Math. 44 (2003), ARK4(3)6L[2]SA, implicit part |
//! | Newmark | 2 | Zienkiewicz & Xie (1991) | A-stable, no damping | Newmark (1959), average acceleration |
//!
//! The equations are linear inside a phase, so a method is a linear map of the state that depends on the
//! coefficients at its stage times only; [`Step::prepare`] collects those once and [`Step::apply`] carries the
//! state, and with the homogeneous coefficients any number of tangent vectors.
//!
//! The Magnus method writes `z' = A(t) z + b(t)` with `z = (x, v)` as a matrix of two rows and three columns,
//! `[A b]`, for which the exponential is known in closed form: it is exact where coefficients are constant (rectangular wave, free flight).
//!
//! Tests: order of each in `tests/convergence.rs`; order conditions of the tables below.

use crate::excitation::Segment;
use crate::integrate::Method;
use crate::system::{Coefs, ContactPhase, System, Vector};

const DP_C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const DP_A: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Order 5 minus order 4 weights.
const DP_E: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

const SD_G: f64 = 0.25;
const SD_C: [f64; 6] = [0.0, 0.5, 83.0 / 250.0, 31.0 / 50.0, 17.0 / 20.0, 1.0];
const SD_A: [[f64; 5]; 6] = [
    [0.0; 5],
    [0.25, 0.0, 0.0, 0.0, 0.0],
    [8611.0 / 62500.0, -1743.0 / 31250.0, 0.0, 0.0, 0.0],
    [5012029.0 / 34652500.0, -654441.0 / 2922500.0, 174375.0 / 388108.0, 0.0, 0.0],
    [15267082809.0 / 155376265600.0, -71443401.0 / 120774400.0, 730878875.0 / 902184768.0, 2285395.0 / 8070912.0, 0.0],
    [82889.0 / 524892.0, 0.0, 15625.0 / 83664.0, 69875.0 / 102672.0, -2260.0 / 8211.0],
];
const SD_BHAT: [f64; 6] = [
    4586570599.0 / 29645900160.0,
    0.0,
    178811875.0 / 945068544.0,
    814220225.0 / 1159782912.0,
    -3700637.0 / 11593932.0,
    61727.0 / 225920.0,
];

/// Gauss-Legendre nodes of order 6 on [0, 1].
const GAUSS3: [f64; 3] = [0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7];

/// A prepared step: stage coefficients of one method over one interval.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    method: Method,
    /// Step (s).
    h: f64,
    co: [Coefs; 7],
    /// Magnus: new state and error estimate as affine maps of the state.
    maps: [Affine; 2],
}

impl Step {
    /// Reads the coefficients for the step from `tau` over `dtau` mesh cycles at `mesh_frequency` (Hz).
    #[inline]
    pub fn prepare<const N: usize>(
        system: &System<N>,
        method: Method,
        phase: ContactPhase,
        segment: &Segment,
        tau: f64,
        dtau: f64,
        mesh_frequency: f64,
    ) -> Self {
        let mut co = [Coefs::default(); 7];
        let nodes: &[f64] = match method {
            Method::Magnus => &GAUSS3,
            Method::DormandPrince => &DP_C,
            Method::Esdirk => &SD_C,
            Method::Newmark => &[0.0, 1.0],
        };
        for (c, &node) in co.iter_mut().zip(nodes) {
            *c = system.coefs(phase, segment, tau + node * dtau);
        }
        let h = dtau / mesh_frequency;
        let maps = match method {
            Method::Magnus => magnus(h, system.mass[0], &co),
            _ => [[[0.0; 3]; 2]; 2],
        };
        Self { method, h, co, maps }
    }

    /// Length of the step (s).
    pub fn span(&self) -> f64 {
        self.h
    }

    /// The same step for differences of solutions.
    pub fn homogeneous(&self) -> Self {
        Self { co: self.co.map(Coefs::homogeneous), maps: self.maps.map(|m| m.map(|[a, b, _]| [a, b, 0.0])), ..*self }
    }

    /// New state and an estimate of the local error.
    #[inline]
    pub fn apply<const N: usize>(&self, s: &System<N>, z: &Vector<N>) -> (Vector<N>, Vector<N>) {
        match self.method {
            Method::Magnus => {
                let mut r = (*z, Vector::ZERO);
                (r.0.q[0], r.0.v[0]) = image(&self.maps[0], z.q[0], z.v[0]);
                (r.1.q[0], r.1.v[0]) = image(&self.maps[1], z.q[0], z.v[0]);
                r
            }
            Method::DormandPrince => self.dormand_prince(s, z),
            Method::Esdirk => self.esdirk(s, z),
            Method::Newmark => self.newmark(s, z),
        }
    }

    fn dormand_prince<const N: usize>(&self, s: &System<N>, z: &Vector<N>) -> (Vector<N>, Vector<N>) {
        let h = self.h;
        let (mut kq, mut kv) = ([[0.0; N]; 7], [[0.0; N]; 7]);
        let mut y = *z;
        for i in 0..7 {
            if i > 0 {
                y = *z;
                for j in 0..i {
                    let a = h * DP_A[i][j];
                    for n in 0..N {
                        y.q[n] += a * kq[j][n];
                        y.v[n] += a * kv[j][n];
                    }
                }
            }
            kq[i] = y.v;
            kv[i] = s.acceleration(&self.co[i], &y);
        }
        let mut e = Vector::ZERO;
        for j in 0..7 {
            for n in 0..N {
                e.q[n] += h * DP_E[j] * kq[j][n];
                e.v[n] += h * DP_E[j] * kv[j][n];
            }
        }
        (y, e)
    }

    fn esdirk<const N: usize>(&self, s: &System<N>, z: &Vector<N>) -> (Vector<N>, Vector<N>) {
        let (h, g) = (self.h, self.h * SD_G);
        let (mut kq, mut kv) = ([[0.0; N]; 6], [[0.0; N]; 6]);
        kq[0] = z.v;
        kv[0] = s.acceleration(&self.co[0], z);
        let mut y = *z;
        for i in 1..6 {
            y = *z;
            for j in 0..i {
                let a = h * SD_A[i][j];
                for n in 0..N {
                    y.q[n] += a * kq[j][n];
                    y.v[n] += a * kv[j][n];
                }
            }
            for n in 0..N {
                y.q[n] += g * y.v[n];
            }
            let a = s.implicit_acceleration(&self.co[i], &y, g);
            for n in 0..N {
                y.q[n] += g * g * a[n];
                y.v[n] += g * a[n];
            }
            (kq[i], kv[i]) = (y.v, a);
        }
        let mut e = Vector::ZERO;
        for j in 0..6 {
            let b = if j < 5 { SD_A[5][j] } else { SD_G };
            for n in 0..N {
                e.q[n] += h * (b - SD_BHAT[j]) * kq[j][n];
                e.v[n] += h * (b - SD_BHAT[j]) * kv[j][n];
            }
        }
        (y, e)
    }

    fn newmark<const N: usize>(&self, s: &System<N>, z: &Vector<N>) -> (Vector<N>, Vector<N>) {
        let g = 0.5 * self.h;
        let a0 = s.acceleration(&self.co[0], z);
        let mut y = *z;
        for n in 0..N {
            y.q[n] += self.h * z.v[n] + g * g * a0[n];
            y.v[n] += g * a0[n];
        }
        let a1 = s.implicit_acceleration(&self.co[1], &y, g);
        let mut e = Vector::ZERO;
        for n in 0..N {
            y.q[n] += g * g * a1[n];
            y.v[n] += g * a1[n];
            e.q[n] = self.h * self.h * (a1[n] - a0[n]) / 12.0;
        }
        (y, e)
    }
}

/// The step of length `h` (s) as an affine map, and that of its error estimate.
fn magnus(h: f64, m: f64, co: &[Coefs; 7]) -> [Affine; 2] {
    let row = |c: &Coefs| [-c.k / m, -c.c / m, (c.load - c.p) / m];
    let (r1, r2, r3) = (row(&co[0]), row(&co[1]), row(&co[2]));
    let a1: Affine = [[0.0, h, 0.0], r2.map(|v| h * v)];
    if r1 == r2 && r2 == r3 {
        return [exponential(&a1), [[0.0; 3]; 2]];
    }
    let s5 = 15f64.sqrt() / 3.0 * h;
    let mut a2: Affine = [[0.0; 3]; 2];
    let mut a3: Affine = [[0.0; 3]; 2];
    for i in 0..3 {
        a2[1][i] = s5 * (r3[i] - r1[i]);
        a3[1][i] = 10.0 / 3.0 * h * (r3[i] - 2.0 * r2[i] + r1[i]);
    }
    let c1 = bracket(&a1, &a2);
    let c2 = combine(&[(-1.0 / 60.0, &bracket(&a1, &combine(&[(2.0, &a3), (1.0, &c1)])))]);
    let left = combine(&[(-20.0, &a1), (-1.0, &a3), (1.0, &c1)]);
    let c3 = bracket(&left, &combine(&[(1.0, &a2), (1.0, &c2)]));
    let omega = combine(&[(1.0, &a1), (1.0 / 12.0, &a3), (1.0 / 240.0, &c3)]);
    // Order 4 on the same nodes: a1 + a3/12 - [a1, a2]/12.
    let error = combine(&[(1.0 / 240.0, &c3), (1.0 / 12.0, &c1)]);
    [exponential(&omega), error]
}

/// `A z + b` for `map = [A b]`.
#[inline]
fn image(map: &Affine, x: f64, v: f64) -> (f64, f64) {
    let [[a, b, f], [c, d, g]] = *map;
    (a * x + b * v + f, c * x + d * v + g)
}

/// `[A b]`: the generator of `z' = A z + b` in two dimensions.
type Affine = [[f64; 3]; 2];

fn combine(terms: &[(f64, &Affine)]) -> Affine {
    let mut r = [[0.0; 3]; 2];
    for (f, t) in terms {
        for i in 0..2 {
            for j in 0..3 {
                r[i][j] += f * t[i][j];
            }
        }
    }
    r
}

fn product(a: &Affine, b: &Affine) -> Affine {
    let mut r = [[0.0; 3]; 2];
    for i in 0..2 {
        for j in 0..3 {
            r[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j];
        }
    }
    r
}

fn bracket(a: &Affine, b: &Affine) -> Affine {
    combine(&[(1.0, &product(a, b)), (-1.0, &product(b, a))])
}

/// `[exp(B), phi_1(B) b]` for `omega = [B b]`.
fn exponential(omega: &Affine) -> Affine {
    let [[a, b, f], [c, d, g]] = *omega;
    let det = a * d - b * c;
    let half = 0.5 * (a + d);
    let dev = 0.5 * (a - d);
    let disc = dev * dev + b * c; // square of the half difference of the eigenvalues
    // exp(half) times cosh(r) and sinh(r)/r with r^2 = disc, which may be negative.
    let grow = half.exp();
    let (co, si) = if disc.abs() < 1e-4 {
        (
            grow * (1.0 + disc / 2.0 * (1.0 + disc / 12.0 * (1.0 + disc / 30.0 * (1.0 + disc / 56.0)))),
            grow * (1.0 + disc / 6.0 * (1.0 + disc / 20.0 * (1.0 + disc / 42.0 * (1.0 + disc / 72.0)))),
        )
    } else if disc < 0.0 {
        let r = (-disc).sqrt();
        let (s, c) = r.sin_cos();
        (grow * c, grow * s / r)
    } else {
        // By the two eigenvalues, the smaller one as determinant over larger: under heavy damping cosh and sinh overflow, and half + r
        // loses its digits.
        let r = disc.sqrt();
        let large = if half < 0.0 { half - r } else { half + r };
        let (large_exp, small_exp) = (large.exp(), (det / large).exp());
        let sign = half.signum();
        (0.5 * (large_exp + small_exp), 0.5 * sign * (large_exp - small_exp) / r)
    };
    let (e11, e12, e21, e22) = (co + si * dev, si * b, si * c, co - si * dev);
    let (mut x1, mut v1) = (0.0, 0.0);
    if f == 0.0 && g == 0.0 {
        return [[e11, e12, x1], [e21, e22, v1]];
    }
    // Size of the exponent in units in which displacement and velocity are alike.
    let size = disc.abs().sqrt() + half.abs();
    if size > 0.05 && det.abs() > 1e-6 * size * size {
        // phi_1 b = B^-1 (exp(B) - 1) b
        let (p, q) = ((e11 - 1.0) * f + e12 * g, e21 * f + (e22 - 1.0) * g);
        x1 += (d * p - b * q) / det;
        v1 += (a * q - c * p) / det;
    } else {
        // Taylor series of phi_1, sum B^n b / (n+1)!, scaled so that it converges quickly.
        let halvings = if size > 0.5 { (size / 0.5).log2().ceil() as i32 } else { 0 };
        let t = 0.5f64.powi(halvings);
        let (mut p, mut q) = (f * t, g * t);
        let (mut sp, mut sq) = (p, q);
        for n in 2..=16 {
            let w = t / f64::from(n);
            (p, q) = (w * (a * p + b * q), w * (c * p + d * q));
            sp += p;
            sq += q;
        }
        // phi_1 over twice the interval: s(2t) = exp(B t) s(t) + s(t).
        let mut scale = t;
        for _ in 0..halvings {
            let e = exponential(&[[a * scale, b * scale, 0.0], [c * scale, d * scale, 0.0]]);
            let (ex, ev) = image(&e, sp, sq);
            (sp, sq) = (sp + ex, sq + ev);
            scale *= 2.0;
        }
        x1 += sp;
        v1 += sq;
    }
    [[e11, e12, x1], [e21, e22, v1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_tables_satisfy_their_order_conditions() {
        let full = |i: usize, j: usize| match (i, j) {
            (i, j) if j < i => SD_A[i][j],
            (i, j) if i == j && i > 0 => SD_G,
            _ => 0.0,
        };
        let b: Vec<f64> = (0..6).map(|j| full(5, j)).collect();
        let row = |f: &dyn Fn(usize) -> f64, i: usize| (0..6).map(|j| full(i, j) * f(j)).sum::<f64>();
        let dot = |w: &[f64], f: &dyn Fn(usize) -> f64| (0..6).map(|j| w[j] * f(j)).sum::<f64>();
        let c = |j: usize| SD_C[j];
        for (i, &ci) in SD_C.iter().enumerate() {
            assert!((row(&|_| 1.0, i) - ci).abs() < 1e-14, "row {i}");
            if i > 0 {
                assert!((row(&c, i) - 0.5 * ci * ci).abs() < 1e-14, "stage order 2, row {i}");
            }
        }
        let near = |a: f64, b: f64, what: &str| assert!((a - b).abs() < 1e-13, "{what}: {a} {b}");
        for w in [&b[..], &SD_BHAT[..]] {
            near(dot(w, &|_| 1.0), 1.0, "order 1");
            near(dot(w, &c), 0.5, "order 2");
            near(dot(w, &|j| c(j).powi(2)), 1.0 / 3.0, "order 3");
        }
        near(dot(&b, &|j| c(j).powi(3)), 0.25, "order 4");
        near(dot(&b, &|i| c(i) * row(&c, i)), 0.125, "order 4");
        near(dot(&b, &|i| row(&|j| c(j) * c(j), i)), 1.0 / 12.0, "order 4");
        near(dot(&b, &|i| row(&|j| row(&c, j), i)), 1.0 / 24.0, "order 4");
        for k in 0..5u32 {
            let s: f64 = (0..6).map(|j| DP_A[6][j] * DP_C[j].powi(k as i32)).sum();
            near(s, 1.0 / f64::from(k + 1), "Dormand-Prince quadrature");
        }
        for i in 1..7 {
            near((0..i).map(|j| DP_A[i][j]).sum(), DP_C[i], "Dormand-Prince row");
        }
        near(DP_E.iter().sum(), 0.0, "Dormand-Prince error weights");
    }

    /// Under a damper of any strength the slow motion decays as `exp(-k t / c)`, and a step of any length is one evaluation.
    #[test]
    fn extreme_heavily_damped_exponential() {
        for damping in [1e2, 1e4, 1e6, 1e9, 1e12] {
            // m = 1, k = 1, over a time of c / k
            let h: f64 = damping;
            let map = exponential(&[[0.0, h, 0.0], [-h, -damping * h, h]]);
            let slow = -2.0 / (damping + (damping * damping - 4.0).sqrt()) * h;
            let (x, v) = image(&map, 1.0, 0.0);
            // from 1 towards the static displacement 1: nothing changes
            assert!((x - 1.0).abs() < 1e-9 && v.abs() < 1e-9, "{damping}: {x} {v}");
            let (x, _) = image(&exponential(&[[0.0, h, 0.0], [-h, -damping * h, 0.0]]), 1.0, 0.0);
            assert!((x / slow.exp() - 1.0).abs() < 1e-3, "{damping}: {x} against {}", slow.exp());
        }
    }

    #[test]
    fn analytic_exponential_against_its_taylor_series() {
        let cases: [Affine; 9] = [
            [[0.0, 1e-3, 0.0], [-2e-3, -12.0, 3e-4]],
            [[0.0, 0.3, 0.0], [-0.7, -0.1, 0.2]],
            [[0.0, 1.0, 0.0], [0.0, 0.0, 2.0]],
            [[0.0, 1e-7, 0.0], [-50.0, -1e-4, 3e-5]],
            [[0.0, 2.0, 0.1], [-3.0, -0.5, 1.0]],
            [[0.0, 1.0, 0.0], [0.0, -3.0, 1.0]],
            [[0.01, 0.5, 0.02], [0.4, -0.02, 0.3]],
            [[0.0, 1.0, 0.0], [-1.0, -2.0, 0.5]],
            [[0.0, 1e-3, 0.0], [-1e-3, -2e-3, 5e-4]],
        ];
        for (n, o) in cases.iter().enumerate() {
            let (x0, v0) = (0.7, -0.3);
            // Homogeneous extension (x, v, 1), Taylor series of the 3 by 3 exponential.
            let (mut t, mut sum, mut largest) = ([x0, v0, 1.0], [x0, v0], 1.0_f64);
            for k in 1..60 {
                let w = 1.0 / f64::from(k);
                t = [
                    w * (o[0][0] * t[0] + o[0][1] * t[1] + o[0][2] * t[2]),
                    w * (o[1][0] * t[0] + o[1][1] * t[1] + o[1][2] * t[2]),
                    0.0,
                ];
                sum = [sum[0] + t[0], sum[1] + t[1]];
                largest = largest.max(t[0].abs()).max(t[1].abs());
            }
            let (x, v) = image(&exponential(o), x0, v0);
            // the terms of the alternating series cancel: their rounding stays
            let tol = 1e-13 * (1.0 + sum[0].abs().max(sum[1].abs())) + 4.0 * f64::EPSILON * largest;
            assert!((x - sum[0]).abs() < tol && (v - sum[1]).abs() < tol, "case {n}: {x} {v} against {sum:?}");
        }
    }
}
