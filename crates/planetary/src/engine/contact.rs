//! Forces of the meshes of one step.
//!
//! With all bilateral connections eliminated the approaches answer to the mesh forces as `x = x_0 - W (F - F_0)`, and the forces to the approaches as
//! `F_i(x_i)`. `W` is the compliance of bodies with inertia over one step: its symmetric part is positive definite, and no `F_i` falls. So `x + W F(x)`
//! is strongly monotone in the metric of `W^-1`, and there is exactly one solution. Newton's method on `r(x) = x - x_0 + W (F(x) - F_0)`, with the law's
//! slopes (semismooth: L. Qi and J. Sun, *Math. Program.* 58, 1993, 353-367), halves its step while `|r|` grows; where that fails, one mesh after the other
//! takes its own root, found by bisection (nonlinear Gauss-Seidel, convergent for symmetric `W`), before Newton is tried again.
//!
//! Force with damping: `max(0, f + c min(1, f / f_c) x')`, `f` the law's. It is continuous, and does not fall with `x` where `x'` grows with `x`: below `f_c`
//! it is a product of `f` and `max(0, 1 + c x' / f_c)`.

use super::dense::Square;
use super::system::Flank;

/// A flank at one position and step: force and slope over the approach.
pub(super) struct Touch<'a> {
    pub flank: &'a Flank,
    pub cycle: f64,
    /// `x' = rate x - history`, `x` without backlash.
    pub rate: f64,
    pub history: f64,
}

impl Touch<'_> {
    /// Force and its derivative by the approach.
    pub fn force(&self, x: f64) -> (f64, f64) {
        let flank = self.flank;
        let answer = flank.law.response(self.cycle, x - flank.backlash);
        let (f, slope) = (answer.force, answer.stiffness);
        if flank.damping == 0.0 || self.rate == 0.0 || f <= 0.0 {
            return (f, slope);
        }
        let speed = self.rate * x - self.history;
        let (share, share_slope) =
            if f < flank.damping_force { (f / flank.damping_force, slope / flank.damping_force) } else { (1.0, 0.0) };
        let total = f + flank.damping * share * speed;
        if total > 0.0 {
            (total, slope + flank.damping * (share_slope * speed + share * self.rate))
        } else {
            (0.0, 0.0)
        }
    }
}

/// How the solution went.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ContactReport {
    pub iterations: usize,
    pub fallback: bool,
    /// Largest residual (m).
    pub residual: f64,
}

const MOST_NEWTON: usize = 40;
const MOST_HALVINGS: usize = 12;
const MOST_ROUNDS: usize = 20;
const SWEEPS: usize = 10;
const BISECTIONS: usize = 120;
/// Residual wanted, relative to the displacements whose differences the approaches are: their rounding.
const TOLERANCE: f64 = 1e-13;
/// Smallest pivot of `1 + W K` against its diagonal: it cannot be small, this only refuses numbers out of range.
const PIVOT: f64 = 1e-14;

/// What is asked.
pub(super) struct Problem<'a> {
    pub touches: &'a [Touch<'a>],
    /// `W`.
    pub compliance: &'a Square,
    /// `x_0`.
    pub free: &'a [f64],
    /// `F_0`.
    pub before: &'a [f64],
    /// Size of the displacements that make up the approaches (m).
    pub scale: f64,
}

impl Problem<'_> {
    /// Residual, its largest entry, forces and slopes.
    fn evaluate(&self, x: &[f64], out: &mut Evaluation) -> f64 {
        let n = x.len();
        for i in 0..n {
            (out.forces[i], out.slopes[i]) = self.touches[i].force(x[i]);
        }
        let mut worst = 0.0_f64;
        for i in 0..n {
            let sum: f64 = (0..n).map(|j| self.compliance.at(i, j) * (out.forces[j] - self.before[j])).sum();
            out.residual[i] = x[i] - self.free[i] + sum;
            worst = worst.max(out.residual[i].abs());
        }
        worst
    }

    fn is_solved(&self, x: &[f64], worst: f64) -> bool {
        worst <= TOLERANCE * x.iter().fold(self.scale, |most, x| most.max(x.abs()))
    }

    /// The root of one mesh with the forces of the others given.
    fn single(&self, i: usize, x: f64, residual: f64, force: f64) -> f64 {
        let compliance = self.compliance.at(i, i);
        // x_i + W_ii F_i(x_i) = target
        let target = x - residual + compliance * force;
        let (mut high, mut low) = (target, target - compliance * self.touches[i].force(target).0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if middle + compliance * self.touches[i].force(middle).0 < target { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

#[derive(Clone)]
struct Evaluation {
    forces: Vec<f64>,
    slopes: Vec<f64>,
    residual: Vec<f64>,
}

/// Forces.
pub(super) fn solve(problem: &Problem<'_>, forces: &mut [f64]) -> ContactReport {
    let n = problem.free.len();
    let mut now = Evaluation { forces: vec![0.0; n], slopes: vec![0.0; n], residual: vec![0.0; n] };
    let mut trial = now.clone();
    let mut x = problem.free.to_vec();
    let mut worst = problem.evaluate(&x, &mut now);
    let mut report = ContactReport::default();
    let mut begun = f64::INFINITY;
    for _ in 0..MOST_ROUNDS {
        newton(problem, &mut x, &mut now, &mut trial, &mut worst, &mut report);
        if problem.is_solved(&x, worst) {
            break;
        }
        // no better than where the round began: rounding
        if worst > 0.5 * begun {
            break;
        }
        begun = worst;
        report.fallback = true;
        for _ in 0..SWEEPS {
            for i in 0..n {
                x[i] = problem.single(i, x[i], now.residual[i], now.forces[i]);
                worst = problem.evaluate(&x, &mut now);
            }
        }
    }
    forces.copy_from_slice(&now.forces);
    report.residual = worst;
    report
}

/// Newton's method while it helps.
fn newton(
    problem: &Problem<'_>,
    x: &mut Vec<f64>,
    now: &mut Evaluation,
    trial: &mut Evaluation,
    worst: &mut f64,
    report: &mut ContactReport,
) {
    let n = x.len();
    for _ in 0..MOST_NEWTON {
        if problem.is_solved(x, *worst) {
            return;
        }
        let mut matrix = problem.compliance.clone();
        for j in 0..n {
            let slope = now.slopes[j];
            matrix.column_mut(j).iter_mut().for_each(|value| *value *= slope);
            *matrix.at_mut(j, j) += 1.0;
        }
        if !matrix.factor(PIVOT) {
            return;
        }
        let mut direction = now.residual.clone();
        matrix.solve(&mut direction);
        report.iterations += 1;
        let mut length = 1.0;
        let mut better = false;
        for _ in 0..MOST_HALVINGS {
            let next: Vec<f64> = x.iter().zip(&direction).map(|(x, p)| x - length * p).collect();
            let reached = problem.evaluate(&next, trial);
            if reached < *worst {
                *x = next;
                std::mem::swap(now, trial);
                *worst = reached;
                better = true;
                break;
            }
            length *= 0.5;
        }
        if !better {
            return;
        }
    }
}
