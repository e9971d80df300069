//! Forces of the meshes at the stages of one step.
//!
//! With all bilateral connections eliminated the approaches at the stages answer to the forces of the stages as `x = x_0 - W F`, and a mesh to the approach over the step as the projection of
//! `max(0, f(m, x) + c(f) x')` on the stages (`stages`). Newton's method on `r(x) = x - x_0 + W F(x)` with the slopes of the laws at the points (semismooth, as in
//! `contact`); a step that leaves a larger residual is halved.

use super::contact::{ContactReport, ROUNDING, TOLERANCE};
use super::dense::{Matrix, axpy};
use super::stages::Stages;
use super::system::Flank;

/// A flank over a step.
pub(super) struct StageTouch<'a> {
    pub flank: &'a Flank,
    /// Mesh cycles at the points of the step.
    pub cycles: Vec<f64>,
    /// Approach at the start.
    pub start: f64,
}

/// What is asked.
pub(super) struct StageProblem<'a> {
    pub stages: &'a Stages,
    /// Length of the step (s).
    pub step: f64,
    pub touches: &'a [StageTouch<'a>],
    /// `W`, a mesh after the other.
    pub compliance: &'a Matrix,
    /// `x_0`.
    pub free: &'a [f64],
    /// Size of the displacements that make up the approaches (m).
    pub scale: f64,
}

const MOST_NEWTON: usize = 30;
const MOST_HALVINGS: usize = 6;
/// Smallest pivot of `1 + W K` against its column.
const PIVOT: f64 = 1e-14;

#[derive(Clone)]
struct Evaluation {
    forces: Vec<f64>,
    /// `s x s` by rows for each mesh.
    slopes: Vec<f64>,
    residual: Vec<f64>,
    worst: f64,
}

impl StageTouch<'_> {
    /// Forces of the stages and their derivatives by the approaches of the stages.
    fn forces(&self, stages: &Stages, step: f64, x: &[f64], forces: &mut [f64], slopes: &mut [f64]) {
        let (s, n) = (stages.count, stages.points.len());
        forces.fill(0.0);
        slopes.fill(0.0);
        for (q, &cycle) in self.cycles.iter().enumerate() {
            let at = |table: &[f64]| {
                let row = &table[q * (s + 1)..(q + 1) * (s + 1)];
                row[0] * self.start + row[1..].iter().zip(x).map(|(a, x)| a * x).sum::<f64>()
            };
            let press = self.flank.press(cycle, at(&stages.value), at(&stages.rate) / step);
            if press.force == 0.0 {
                continue;
            }
            let (value, rate) = (&stages.value[q * (s + 1) + 1..], &stages.rate[q * (s + 1) + 1..]);
            for i in 0..s {
                let weight = stages.projection[i * n + q];
                forces[i] += weight * press.force;
                for j in 0..s {
                    slopes[i * s + j] += weight * (press.by_approach * value[j] + press.by_speed / step * rate[j]);
                }
            }
        }
    }
}

impl StageProblem<'_> {
    fn evaluate(&self, x: &[f64], out: &mut Evaluation) {
        let s = self.stages.count;
        for (a, touch) in self.touches.iter().enumerate() {
            let (forces, slopes) = (&mut out.forces[a * s..(a + 1) * s], &mut out.slopes[a * s * s..(a + 1) * s * s]);
            touch.forces(self.stages, self.step, &x[a * s..(a + 1) * s], forces, slopes);
        }
        for ((residual, x), free) in out.residual.iter_mut().zip(x).zip(self.free) {
            *residual = x - free;
        }
        self.compliance.add_times(1.0, &out.forces, &mut out.residual);
        out.worst = out.residual.iter().fold(0.0, |most, r| if r.is_nan() { f64::INFINITY } else { most.max(r.abs()) });
    }

    fn size(&self, x: &[f64]) -> f64 {
        x.iter().fold(self.scale, |most, x| most.max(x.abs()))
    }

    /// Newton's step.
    fn direction(&self, now: &Evaluation) -> Option<Vec<f64>> {
        let (s, n) = (self.stages.count, self.free.len());
        let mut matrix = Matrix::zeros(n, n);
        for a in 0..self.touches.len() {
            for j in 0..s {
                let column = matrix.column_mut(a * s + j);
                for i in 0..s {
                    let slope = now.slopes[(a * s + i) * s + j];
                    if slope != 0.0 {
                        axpy(column, slope, self.compliance.column(a * s + i));
                    }
                }
                column[a * s + j] += 1.0;
            }
        }
        let mut direction = now.residual.clone();
        matrix.factor(PIVOT)?.solve(&mut direction);
        Some(direction)
    }
}

/// Forces and approaches at the stages; `forces` are where it begins.
pub(super) fn solve_stages(problem: &StageProblem<'_>, forces: &mut [f64]) -> (Vec<f64>, ContactReport) {
    let (s, n) = (problem.stages.count, problem.free.len());
    let empty = Evaluation { forces: vec![0.0; n], slopes: vec![0.0; n * s], residual: vec![0.0; n], worst: 0.0 };
    let (mut now, mut trial) = (empty.clone(), empty);
    let mut x = problem.free.to_vec();
    problem.compliance.add_times(-1.0, forces, &mut x);
    problem.evaluate(&x, &mut now);
    let mut report = ContactReport::default();
    while report.iterations < MOST_NEWTON && now.worst > TOLERANCE * problem.size(&x) {
        let Some(direction) = problem.direction(&now) else { break };
        report.iterations += 1;
        let mut length = 1.0;
        let mut next = x.clone();
        for _ in 0..=MOST_HALVINGS {
            next.copy_from_slice(&x);
            axpy(&mut next, -length, &direction);
            problem.evaluate(&next, &mut trial);
            if trial.worst < now.worst {
                break;
            }
            length *= 0.5;
        }
        if !(trial.worst < now.worst) {
            break;
        }
        report.searched |= length < 1.0;
        std::mem::swap(&mut x, &mut next);
        std::mem::swap(&mut now, &mut trial);
    }
    forces.copy_from_slice(&now.forces);
    report.residual = now.worst;
    report.is_solved = now.worst <= ROUNDING * problem.size(&x);
    (x, report)
}
