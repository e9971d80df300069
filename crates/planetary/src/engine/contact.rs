//! Forces of the meshes of one step.
//!
//! With all bilateral connections eliminated the approaches answer to the mesh forces as `x = x_0 - W (F - F_0)`, and the forces to the approaches as
//! `F_i(x_i)`. `W` is the compliance of bodies with inertia over one step: its symmetric part is positive definite, and no `F_i` falls. So `x + W F(x)`
//! is strongly monotone in the metric of `W^-1`, and there is exactly one solution: with symmetric `W` (gyroscopic moments make it a little less) the lowest place
//! of a convex energy. Newton's method on `r(x) = x - x_0 + W (F(x) - F_0)`, with the law's slopes (semismooth: L. Qi and J. Sun, *Math. Program.* 58, 1993,
//! 353-367), goes back along its step to the lowest energy where the step ends beyond it and no nearer, as far as halving the interval tells; so
//! to converge from any start. Where it gains nothing for all that, one mesh after the other takes its own root, found by bisection (nonlinear Gauss-Seidel), before
//! Newton is tried again. With `x = x_0 - W (l - F_0)` the gradient of the energy is `F(x) - l`, and `W^-1` is not needed.
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
        let press = self.flank.press(self.cycle, x, self.rate * x - self.history);
        (press.force, press.by_approach + self.rate * press.by_speed)
    }
}

/// Force of flanks and its derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Press {
    pub force: f64,
    pub by_approach: f64,
    pub by_speed: f64,
}

impl Flank {
    /// Force at an approach without backlash and a speed of approach.
    pub fn press(&self, cycle: f64, x: f64, speed: f64) -> Press {
        let answer = self.law.response(cycle, x - self.backlash);
        let (f, slope) = (answer.force, answer.stiffness);
        if self.damping == 0.0 || f <= 0.0 {
            return Press { force: f, by_approach: slope, by_speed: 0.0 };
        }
        let (share, share_slope) =
            if f < self.damping_force { (f / self.damping_force, slope / self.damping_force) } else { (1.0, 0.0) };
        let force = f + self.damping * share * speed;
        if force > 0.0 {
            Press { force, by_approach: slope + self.damping * share_slope * speed, by_speed: self.damping * share }
        } else {
            Press::default()
        }
    }
}

/// How the solution went.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ContactReport {
    pub iterations: usize,
    /// Whether a step had to be shortened.
    pub searched: bool,
    /// Largest residual (m).
    pub residual: f64,
    /// Whether it is that of rounding.
    pub is_solved: bool,
}

const MOST_NEWTON: usize = 60;
const MOST_HALVINGS: usize = 40;
const MOST_ROUNDS: usize = 20;
const SWEEPS: usize = 10;
const BISECTIONS: usize = 120;
/// Residual wanted, relative to the displacements whose differences the approaches are: their rounding.
pub(super) const TOLERANCE: f64 = 1e-13;
/// A full step is taken where it leaves no more than this part of the residual.
const NEARER: f64 = 0.5;
/// Residual, relative to the same, below which one that no longer falls is rounding.
pub(super) const ROUNDING: f64 = 1e-9;
/// Residual, relative to the terms it is a sum of, that is their rounding.
const CANCELLATION: f64 = 1e-14;
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
        out.terms = 0.0;
        for i in 0..n {
            let (mut sum, mut terms) = (0.0, self.free[i].abs());
            for j in 0..n {
                let term = self.compliance.at(i, j) * (out.forces[j] - self.before[j]);
                sum += term;
                terms += term.abs();
            }
            out.residual[i] = x[i] - self.free[i] + sum;
            worst = worst.max(out.residual[i].abs());
            out.terms = out.terms.max(terms);
        }
        worst
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

    /// Size of the displacements (m).
    fn size(&self, x: &[f64]) -> f64 {
        x.iter().fold(self.scale, |most, x| most.max(x.abs()))
    }

    /// Whether a residual is rounding.
    fn is_rounding(&self, x: &[f64], now: &Evaluation, worst: f64) -> bool {
        worst <= (ROUNDING * self.size(x)).max(CANCELLATION * now.terms)
    }
}

#[derive(Clone)]
struct Evaluation {
    forces: Vec<f64>,
    slopes: Vec<f64>,
    residual: Vec<f64>,
    /// Size of what the residual is a sum of (m).
    terms: f64,
}

/// Forces.
pub(super) fn solve(problem: &Problem<'_>, forces: &mut [f64]) -> ContactReport {
    let n = problem.free.len();
    let mut now = Evaluation { forces: vec![0.0; n], slopes: vec![0.0; n], residual: vec![0.0; n], terms: 0.0 };
    let mut x = problem.free.to_vec();
    let mut worst = problem.evaluate(&x, &mut now);
    let mut report = ContactReport::default();
    // `l`
    let mut held = problem.before.to_vec();
    for _ in 0..MOST_ROUNDS {
        newton(problem, &mut x, &mut held, &mut now, &mut worst, &mut report);
        report.is_solved = problem.is_rounding(&x, &now, worst);
        if report.is_solved {
            break;
        }
        report.searched = true;
        for _ in 0..SWEEPS {
            for i in 0..n {
                x[i] = problem.single(i, x[i], now.residual[i], now.forces[i]);
                worst = problem.evaluate(&x, &mut now);
            }
        }
        let mut back = now.residual.clone();
        let mut compliance = problem.compliance.clone();
        if !compliance.factor(PIVOT) {
            break;
        }
        compliance.solve(&mut back);
        held = now.forces.iter().zip(&back).map(|(force, back)| force - back).collect();
    }
    forces.copy_from_slice(&now.forces);
    report.residual = worst;
    report
}

/// Newton's method until it is solved, or gains nothing.
fn newton(
    problem: &Problem<'_>,
    x: &mut Vec<f64>,
    held: &mut [f64],
    now: &mut Evaluation,
    worst: &mut f64,
    report: &mut ContactReport,
) {
    let n = x.len();
    let mut trial = now.clone();
    for _ in 0..MOST_NEWTON {
        if *worst <= TOLERANCE * problem.size(x) {
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
        let change: Vec<f64> = (0..n).map(|i| now.forces[i] - held[i] - now.slopes[i] * direction[i]).collect();
        let at = |length: f64, trial: &mut Evaluation| {
            let next: Vec<f64> = x.iter().zip(&direction).map(|(x, p)| x - length * p).collect();
            let reached = problem.evaluate(&next, trial);
            let slope: f64 = (0..n).map(|i| direction[i] * (held[i] + length * change[i] - trial.forces[i])).sum();
            (next, reached, slope)
        };
        let mut length = 1.0;
        let mut found = at(length, &mut trial);
        if found.2 > 0.0 && !(found.1 <= NEARER * *worst) {
            report.searched = true;
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..MOST_HALVINGS {
                length = 0.5 * (low + high);
                found = at(length, &mut trial);
                *(if found.2 > 0.0 { &mut high } else { &mut low }) = length;
            }
        }
        let (next, reached, _) = found;
        if !(reached < *worst) && problem.is_rounding(x, now, *worst) {
            return;
        }
        held.iter_mut().zip(&change).for_each(|(held, change)| *held += length * change);
        *x = next;
        std::mem::swap(now, &mut trial);
        *worst = reached;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::mesh::LinearMesh;

    /// Flanks that hold each other stiffly in most directions and softly in two, far from where they will be: compliances from 1e-10 to 1 m/N, as
    /// of a train in which whatever turns is free. Half of the flanks face each other across a backlash.
    #[test]
    fn extreme_compliances_are_solved_from_any_start() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        const COUNT: usize = 10;
        for _ in 0..300 {
            let mut number = |size: f64| size * random.random_range(-1.0..1.0_f64);
            let flanks: Vec<Flank> = (0..COUNT)
                .map(|_| Flank {
                    law: Arc::new(LinearMesh::constant(5e8).unwrap()),
                    cycle_offset: 0.0,
                    cycle_rate: 1.0,
                    damping: 0.0,
                    damping_force: 1.0,
                    backlash: number(1e-4),
                })
                .collect();
            let touches: Vec<Touch<'_>> =
                flanks.iter().map(|flank| Touch { flank, cycle: 0.0, rate: 0.0, history: 0.0 }).collect();
            let soft: Vec<[f64; 3]> = (0..COUNT / 2).map(|_| [number(1.0), number(0.1), number(1e-3)]).collect();
            let mut compliance = Square::zeros(COUNT);
            for i in 0..COUNT {
                for j in 0..COUNT {
                    let side = if (i < COUNT / 2) == (j < COUNT / 2) { 1.0 } else { -1.0 };
                    let product: f64 = soft[i % 5].iter().zip(&soft[j % 5]).map(|(a, b)| a * b).sum();
                    *compliance.at_mut(i, j) = side * product + if i == j { 1e-10 } else { 0.0 };
                }
            }
            let free: Vec<f64> = (0..COUNT).map(|_| number(1.0)).collect();
            let before: Vec<f64> = (0..COUNT).map(|_| number(1e4).max(0.0)).collect();
            let problem =
                Problem { touches: &touches, compliance: &compliance, free: &free, before: &before, scale: 0.0 };
            let mut forces = vec![0.0; COUNT];
            let report = solve(&problem, &mut forces);
            assert!(report.is_solved, "{report:?}");
            assert!(report.iterations < 100, "{report:?}");
        }
    }
}
