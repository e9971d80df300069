//! Resonance curves: families of periodic solutions over the mesh frequency, through turning points.
//!
//! Pseudo-arclength continuation (Keller 1977; Nayfeh & Balachandran, *Applied Nonlinear Dynamics*, 1995, section
//! 6.1). Unknown `u = (z, f)`: state at phase 0 and mesh frequency, in natural units. With unit tangent `t` at the last point,
//!
//! ```text
//! predictor  u = u_0 + ds t
//! corrector  P(z, f) - z = 0,   t . (u - u_0) = ds       (Newton, bordered matrix)
//! ```
//!
//! `dP/dz` is carried by the integrator; `dP/df` is a difference quotient. The step `ds` follows the number of Newton
//! iterations; it is cut where the curve bends by more than about 25 degrees or the corrector strays, so the curve does not change branches.
//!
//! Turning points (`df/ds = 0`) are located on the curve by regula falsi on the frequency component of the tangent.
//! Points where a multiplier crosses the unit circle elsewhere are reported as intervals between neighbours.
//!
//! Tests: `tests/periodic.rs`.

use crate::branch::{Branch, BranchEnd, BranchPoint, ContinuationOptions, TurningPoint};
use crate::error::LpmError;
use crate::floquet::{multipliers, stability};
use crate::integrate::{Method, Runner};
use crate::linear;
use crate::model::{Model, State, with_system};
use crate::periodic::{ShootingOptions, distance, follow, newton_matrix, period_map, repeatability, resolved};
use crate::system::{System, Vector};

/// Least cosine between tangents of neighbouring points.
const MAX_BEND: f64 = 0.9;
/// Relative step of the difference quotient in frequency.
const FREQUENCY_STEP: f64 = 1e-6;
/// Newton iterations of one corrector.
const CORRECTIONS: usize = 8;

impl Model {
    /// Follows the periodic solution found near `guess` (state at phase 0) at `mesh_frequency` (Hz) over the frequency range.
    ///
    /// Fails where no periodic solution is found at the start.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for an option outside its range, or where no periodic solution is found near `guess`; [`LpmError::Singular`] where
    /// the branch has no tangent at its start; errors of the integration, as [`Model::simulate`].
    pub fn continuation(
        &self,
        mesh_frequency: f64,
        guess: &State,
        options: &ContinuationOptions,
    ) -> Result<Branch, LpmError> {
        options.validate()?;
        let shooting = ShootingOptions {
            integration: options.integration,
            tolerance: options.tolerance,
            ..ShootingOptions::default()
        };
        let orbit = self.shoot(mesh_frequency, guess, &shooting)?;
        let limit = options.tolerance.max(30.0 * repeatability(&options.integration));
        if orbit.residual > limit {
            return Err(LpmError::OutOfRange {
                quantity: "residual of the first periodic solution",
                value: orbit.residual,
                unit: "-",
                allowed: "below the tolerance or 1000 integration tolerances: start elsewhere or from a steady state",
            });
        }
        with_system!(self, s => trace(self, s, mesh_frequency, s.import(&orbit.state)?, options))
    }
}

/// State and frequency.
#[derive(Clone, Copy)]
struct Unknown<const N: usize> {
    z: Vector<N>,
    f: f64,
}

/// A converged point with its Jacobian `[dP/dz - 1, dP/df]` in natural units.
#[derive(Clone)]
struct Solved<const N: usize> {
    u: Unknown<N>,
    jacobian: Vec<Vec<f64>>,
    columns: Vec<Vector<N>>,
    iterations: usize,
    residual: f64,
}

/// End of the period map, Jacobian rows, columns of the derivative.
type Linearised<const N: usize> = (Vector<N>, Vec<Vec<f64>>, Vec<Vector<N>>);

struct Tracer<'a, const N: usize> {
    s: &'a System<N>,
    o: &'a ContinuationOptions<'a>,
    f_unit: f64,
    method: Method,
    /// Unknown components of the state: those the method resolves.
    by: Vec<usize>,
}

impl<const N: usize> Tracer<'_, N> {
    fn add(&self, u: &Unknown<N>, direction: &[f64], ds: f64) -> Unknown<N> {
        let mut r = *u;
        for (&i, d) in self.by.iter().zip(direction) {
            r.z.set(i, u.z.get(i) + ds * d * self.s.unit(i));
        }
        r.f += ds * self.frequency_of(direction) * self.f_unit;
        r
    }

    fn difference(&self, a: &Unknown<N>, b: &Unknown<N>) -> Vec<f64> {
        let mut d: Vec<f64> = self.by.iter().map(|&i| (a.z.get(i) - b.z.get(i)) / self.s.unit(i)).collect();
        d.push((a.f - b.f) / self.f_unit);
        d
    }

    /// Frequency component of a direction.
    fn frequency_of(&self, direction: &[f64]) -> f64 {
        direction[self.by.len()]
    }

    /// Residual and Jacobian rows at `u`.
    fn linearise(&self, u: &Unknown<N>) -> Result<Linearised<N>, LpmError> {
        let run = Runner::new(self.s, &self.o.integration, u.f)?;
        let (end, columns) = period_map(&run, u.z, 1, &self.by)?;
        let df = FREQUENCY_STEP * u.f;
        let other = Runner::new(self.s, &self.o.integration, u.f + df)?;
        let (moved, _) = period_map(&other, u.z, 1, &[])?;
        let mut rows = newton_matrix(self.s, &self.by, &columns);
        for (row, &i) in rows.iter_mut().zip(&self.by) {
            row.push((moved.get(i) - end.get(i)) / df * self.f_unit / self.s.unit(i));
        }
        Ok((end, rows, columns))
    }

    /// Corrector in the plane `tangent . (u - base) = ds`.
    fn correct(&self, base: &Unknown<N>, tangent: &[f64], ds: f64) -> Option<Solved<N>> {
        let mut u = self.add(base, tangent, ds);
        let predicted = u;
        let mut best: Option<Solved<N>> = None;
        for iterations in 0..=CORRECTIONS {
            if u.f.is_nan() || u.f <= 0.0 {
                return None;
            }
            let (end, jacobian, columns) = self.linearise(&u).ok()?;
            let residual = distance(self.s, self.method, &end, &u.z);
            if best.as_ref().is_none_or(|b| residual < b.residual) {
                best = Some(Solved {
                    u: Unknown { z: follow(&self.by, &u.z, &end), f: u.f },
                    jacobian: jacobian.clone(),
                    columns,
                    iterations,
                    residual,
                });
            }
            if residual < self.o.tolerance {
                break;
            }
            let mut rows = jacobian;
            rows.push(tangent.to_vec());
            let mut rhs: Vec<f64> = self.by.iter().map(|&i| (u.z.get(i) - end.get(i)) / self.s.unit(i)).collect();
            let along: f64 = self.difference(&u, base).iter().zip(tangent).map(|(a, b)| a * b).sum();
            rhs.push(ds - along);
            let step = linear::solve(rows, rhs, "continuation").ok()?;
            u = self.add(&u, &step, 1.0);
            let strayed = self.difference(&u, &predicted).iter().map(|d| d * d).sum::<f64>().sqrt();
            if strayed > ds.abs() {
                return None;
            }
        }
        let limit = self.o.tolerance.max(30.0 * repeatability(&self.o.integration));
        best.filter(|b| b.residual < limit)
    }

    /// Unit tangent at a solved point, on the side of `previous`.
    fn tangent(&self, p: &Solved<N>, previous: &[f64]) -> Option<Vec<f64>> {
        let mut rows = p.jacobian.clone();
        rows.push(previous.to_vec());
        let mut rhs = vec![0.0; self.by.len()];
        rhs.push(1.0);
        let t = linear::solve(rows, rhs, "tangent").ok()?;
        let size = t.iter().map(|v| v * v).sum::<f64>().sqrt();
        Some(t.into_iter().map(|v| v / size).collect())
    }

    fn report(&self, model: &Model, p: &Solved<N>) -> Result<BranchPoint, LpmError> {
        let state = self.s.export(&p.u.z);
        let cycles = self.s.excitation().period();
        let response = model.simulate(p.u.f, &state, cycles, &self.o.sampling, &self.o.integration)?;
        let multipliers = multipliers(self.s, &self.by, &p.columns)?;
        Ok(BranchPoint {
            mesh_frequency: p.u.f,
            state,
            stability: stability(&multipliers),
            residual: p.residual,
            multipliers,
            measure: response.measure(),
        })
    }

    /// Point between `base` and `far`, `ds` further, where the tangent has no frequency component; `end` is that of `far`.
    ///
    /// Where noise of the integration keeps the corrector from the point itself, the nearest point found counts.
    fn turning(&self, base: &Unknown<N>, tangent: &[f64], ds: f64, far: &Solved<N>, end: f64) -> Solved<N> {
        let ((mut a, mut fa), (mut b, mut fb)) = ((0.0, self.frequency_of(tangent)), (ds, end));
        let mut best = (end.abs(), far.clone());
        let mut side = 0i8;
        for i in 0..40 {
            let x = if i % 8 == 7 { 0.5 * (a + b) } else { (a * fb - b * fa) / (fb - fa) };
            let found = self.correct(base, tangent, x);
            let Some((p, t)) = found.and_then(|p| self.tangent(&p, tangent).map(|t| (p, t))) else {
                break;
            };
            let fx = self.frequency_of(&t);
            if fx.abs() < best.0 {
                best = (fx.abs(), p);
            }
            if fx.abs() < 1e-6 || b - a < 1e-9 * ds {
                break;
            }
            if (fx > 0.0) == (fa > 0.0) {
                (a, fa) = (x, fx);
                if side == 1 {
                    fb *= 0.5;
                }
                side = 1;
            } else {
                (b, fb) = (x, fx);
                if side == -1 {
                    fa *= 0.5;
                }
                side = -1;
            }
        }
        best.1
    }
}

fn trace<const N: usize>(
    model: &Model,
    s: &System<N>,
    frequency: f64,
    z: Vector<N>,
    o: &ContinuationOptions,
) -> Result<Branch, LpmError> {
    let method = o.integration.method_for::<N>()?;
    let t = Tracer { s, o, f_unit: s.omega / std::f64::consts::TAU, method, by: resolved(s, method) };
    let u = Unknown { z, f: frequency };
    let (end, jacobian, columns) = t.linearise(&u)?;
    let mut here = Solved { u, jacobian, columns, iterations: 0, residual: distance(s, method, &end, &z) };
    let mut start = vec![0.0; t.by.len()];
    start.push(if o.upwards { 1.0 } else { -1.0 });
    let mut tangent = t.tangent(&here, &start).ok_or(LpmError::Singular { place: "first tangent of a branch" })?;
    let mut out = Branch {
        points: vec![t.report(model, &here)?],
        turning_points: Vec::new(),
        end: BranchEnd::PointLimit,
        iterations: 0,
    };
    let mut ds = 0.2 * o.max_step;
    while out.points.len() < o.max_points {
        let step = t.correct(&here.u, &tangent, ds).and_then(|p| {
            let next = t.tangent(&p, &tangent)?;
            let bend: f64 = next.iter().zip(&tangent).map(|(a, b)| a * b).sum();
            (bend > MAX_BEND).then_some((p, next))
        });
        let Some((point, next)) = step else {
            if o.integration.stop.is_requested() {
                return Err(LpmError::Stopped { phase: 0.0 });
            }
            ds *= 0.5;
            if ds < 1e-8 {
                out.end = BranchEnd::NoConvergence;
                break;
            }
            continue;
        };
        out.iterations += point.iterations;
        if t.frequency_of(&next) * t.frequency_of(&tangent) < 0.0 {
            let fold = t.turning(&here.u, &tangent, ds, &point, t.frequency_of(&next));
            let point = t.report(model, &fold)?;
            let after = out.points.len() - 1;
            out.turning_points.push(TurningPoint { point, after, is_maximum: t.frequency_of(&tangent) > 0.0 });
        }
        let outside = point.u.f < o.from || point.u.f > o.to;
        ds = match point.iterations {
            0..=2 => (1.5 * ds).min(o.max_step),
            3..=4 => ds,
            _ => 0.7 * ds,
        };
        (here, tangent) = (point, next);
        out.points.push(t.report(model, &here)?);
        if outside {
            out.end = BranchEnd::RangeLeft;
            break;
        }
    }
    Ok(out)
}
