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

use crate::error::{LpmError, check};
use crate::floquet::{Multiplier, Stability, multipliers, stability};
use crate::integrate::{Method, Options, Runner};
use crate::linear;
use crate::model::{Model, State, with_system};
use crate::periodic::{
    ShootingOptions, distance, follow, newton_matrix, period_map, repeatability, resolved,
};
use crate::response::Sampling;
use crate::sweep::Measure;
use crate::system::{System, Vector};

/// Least cosine between tangents of neighbouring points.
const MAX_BEND: f64 = 0.9;
/// Relative step of the difference quotient in frequency.
const FREQUENCY_STEP: f64 = 1e-6;
/// Newton iterations of one corrector.
const CORRECTIONS: usize = 8;

/// Options of [`Model::continuation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuationOptions {
    /// Least mesh frequency (Hz).
    pub from: f64,
    /// Largest mesh frequency (Hz).
    pub to: f64,
    /// Begin towards higher frequencies.
    pub upwards: bool,
    /// Largest arclength step (natural units: static scale, and natural frequency for the mesh frequency), 1e-4 to 1.
    pub max_step: f64,
    /// Points at most.
    pub max_points: usize,
    /// Integration.
    pub integration: Options,
    /// Relative residual aimed at. Where noise of the adaptive steps keeps Newton's method above it (unresolved ringing of
    /// stiff supports, forces that jump), the best iterate counts as long as it is within 1000 integration tolerances.
    pub tolerance: f64,
    /// Sampling of the response at each point.
    pub sampling: Sampling,
}

impl Default for ContinuationOptions {
    /// 200 to 4000 Hz downwards, steps up to 0.1, integration at 1e-9, residual 1e-8, 64 samples per cycle.
    fn default() -> Self {
        Self {
            from: 200.0,
            to: 4000.0,
            upwards: false,
            max_step: 0.1,
            max_points: 5000,
            integration: Options::with_tolerance(1e-9),
            tolerance: 1e-8,
            sampling: Sampling {
                per_cycle: 64,
                energy: false,
            },
        }
    }
}

impl ContinuationOptions {
    /// Checks ranges.
    pub fn validate(&self) -> Result<(), LpmError> {
        self.integration.validate()?;
        check(
            self.from > 0.0,
            "least mesh frequency",
            self.from,
            "Hz",
            "positive",
        )?;
        check(
            self.to > self.from,
            "largest mesh frequency",
            self.to,
            "Hz",
            "above the least",
        )?;
        check(
            (1e-4..=1.0).contains(&self.max_step),
            "arclength step",
            self.max_step,
            "-",
            "between 1e-4 and 1",
        )?;
        check(
            self.max_points >= 2,
            "points",
            self.max_points as f64,
            "-",
            "at least 2",
        )?;
        check(
            (1e-12..=1e-3).contains(&self.tolerance),
            "residual",
            self.tolerance,
            "-",
            "between 1e-12 and 1e-3",
        )?;
        Ok(())
    }
}

/// A point of a resonance curve.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchPoint {
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// State at phase 0.
    pub state: State,
    /// Floquet multipliers, largest modulus first.
    pub multipliers: Vec<Multiplier>,
    /// Stability.
    pub stability: Stability,
    /// Relative residual.
    pub residual: f64,
    /// Response over one period.
    pub measure: Measure,
}

/// A point where the curve turns back in frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct TurningPoint {
    /// The point itself; one multiplier is +1 here.
    pub point: BranchPoint,
    /// It lies between points `after` and `after + 1` of the branch.
    pub after: usize,
    /// The curve lies below this frequency nearby (a largest frequency), else above.
    pub is_maximum: bool,
}

/// Where a continuation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchEnd {
    /// The frequency range was left.
    RangeLeft,
    /// `max_points` reached.
    PointLimit,
    /// The corrector failed at the least step.
    NoConvergence,
}

/// A family of periodic solutions.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Branch {
    /// Points in order along the curve.
    pub points: Vec<BranchPoint>,
    /// Turning points in order.
    pub turning_points: Vec<TurningPoint>,
    /// Why it ended.
    pub end: BranchEnd,
    /// Newton iterations spent.
    pub iterations: usize,
}

impl Branch {
    /// Points at which stability changes, other than at turning points: (index of the first point after, kind it changes to).
    pub fn stability_changes(&self) -> Vec<(usize, Stability)> {
        let turning: Vec<usize> = self.turning_points.iter().map(|t| t.after + 1).collect();
        (1..self.points.len())
            .filter(|i| {
                self.points[*i].stability != self.points[i - 1].stability && !turning.contains(i)
            })
            .map(|i| (i, self.points[i].stability))
            .collect()
    }

    /// Frequency ranges (Hz) in which the curve holds more than one stable solution, ascending; neighbouring turning points and ends bound them.
    pub fn coexistence(&self) -> Vec<(f64, f64)> {
        let mut ends: Vec<f64> = self
            .turning_points
            .iter()
            .map(|t| t.point.mesh_frequency)
            .chain(self.points.first().map(|p| p.mesh_frequency))
            .chain(self.points.last().map(|p| p.mesh_frequency))
            .collect();
        ends.extend(
            self.stability_changes()
                .iter()
                .map(|c| self.points[c.0].mesh_frequency),
        );
        ends.sort_by(f64::total_cmp);
        let mut found: Vec<(f64, f64)> = Vec::new();
        for w in ends.windows(2) {
            let stable = self.at(0.5 * (w[0] + w[1])).iter().filter(|p| p.1).count();
            if stable < 2 || w[0] == w[1] {
                continue;
            }
            match found.last_mut() {
                Some(last) if last.1 == w[0] => last.1 = w[1],
                _ => found.push((w[0], w[1])),
            }
        }
        found
    }

    /// Points and turning points in order along the curve.
    pub fn curve(&self) -> Vec<&BranchPoint> {
        let mut turning = self.turning_points.iter().peekable();
        let mut all = Vec::with_capacity(self.points.len() + self.turning_points.len());
        for (i, p) in self.points.iter().enumerate() {
            all.push(p);
            while let Some(t) = turning.next_if(|t| t.after == i) {
                all.push(&t.point);
            }
        }
        all
    }

    /// Solutions at `mesh_frequency` (Hz), interpolated linearly along the curve: (peak to peak in m, stable).
    pub fn at(&self, mesh_frequency: f64) -> Vec<(f64, bool)> {
        let curve = self.curve();
        curve
            .windows(2)
            .filter_map(|w| {
                let (a, b) = (
                    w[0].mesh_frequency - mesh_frequency,
                    w[1].mesh_frequency - mesh_frequency,
                );
                if a * b > 0.0 || a == b || b == 0.0 {
                    return None;
                }
                let t = a / (a - b);
                let p = w[0].measure.peak_to_peak * (1.0 - t) + w[1].measure.peak_to_peak * t;
                // At a turning point the multiplier is +1 and its sign rounding: the other end of the stretch tells.
                let margin = |p: &BranchPoint| {
                    p.multipliers
                        .iter()
                        .fold(0.0, |m: f64, x| m.max(x.modulus()))
                        - 1.0
                };
                let (m0, m1) = (margin(w[0]), margin(w[1]));
                Some((
                    p,
                    if m0.abs() > m1.abs() {
                        m0 < 0.0
                    } else {
                        m1 < 0.0
                    },
                ))
            })
            .collect()
    }
}

impl Model {
    /// Follows the periodic solution found near `guess` (state at phase 0) at `mesh_frequency` (Hz) over the frequency range.
    ///
    /// Fails where no periodic solution is found at the start.
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
        let limit = options
            .tolerance
            .max(30.0 * repeatability(&options.integration));
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
    o: &'a ContinuationOptions,
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
        let mut d: Vec<f64> = self
            .by
            .iter()
            .map(|&i| (a.z.get(i) - b.z.get(i)) / self.s.unit(i))
            .collect();
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
                    u: Unknown {
                        z: follow(&self.by, &u.z, &end),
                        f: u.f,
                    },
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
            let mut rhs: Vec<f64> = self
                .by
                .iter()
                .map(|&i| (u.z.get(i) - end.get(i)) / self.s.unit(i))
                .collect();
            let along: f64 = self
                .difference(&u, base)
                .iter()
                .zip(tangent)
                .map(|(a, b)| a * b)
                .sum();
            rhs.push(ds - along);
            let step = linear::solve(rows, rhs, "continuation").ok()?;
            u = self.add(&u, &step, 1.0);
            let strayed = self
                .difference(&u, &predicted)
                .iter()
                .map(|d| d * d)
                .sum::<f64>()
                .sqrt();
            if strayed > ds.abs() {
                return None;
            }
        }
        let limit = self
            .o
            .tolerance
            .max(30.0 * repeatability(&self.o.integration));
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
        let response =
            model.simulate(p.u.f, &state, cycles, &self.o.sampling, &self.o.integration)?;
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
    fn turning(
        &self,
        base: &Unknown<N>,
        tangent: &[f64],
        ds: f64,
        far: &Solved<N>,
        end: f64,
    ) -> Solved<N> {
        let ((mut a, mut fa), (mut b, mut fb)) = ((0.0, self.frequency_of(tangent)), (ds, end));
        let mut best = (end.abs(), far.clone());
        let mut side = 0i8;
        for i in 0..40 {
            let x = if i % 8 == 7 {
                0.5 * (a + b)
            } else {
                (a * fb - b * fa) / (fb - fa)
            };
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
    let t = Tracer {
        s,
        o,
        f_unit: s.omega / std::f64::consts::TAU,
        method,
        by: resolved(s, method),
    };
    let u = Unknown { z, f: frequency };
    let (end, jacobian, columns) = t.linearise(&u)?;
    let mut here = Solved {
        u,
        jacobian,
        columns,
        iterations: 0,
        residual: distance(s, method, &end, &z),
    };
    let mut start = vec![0.0; t.by.len()];
    start.push(if o.upwards { 1.0 } else { -1.0 });
    let mut tangent = t.tangent(&here, &start).ok_or(LpmError::Singular {
        place: "first tangent of a branch",
    })?;
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
            out.turning_points.push(TurningPoint {
                point,
                after,
                is_maximum: t.frequency_of(&tangent) > 0.0,
            });
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
