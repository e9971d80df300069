//! Periodic solutions: by waiting for a transient to die out, and directly by shooting.
//!
//! The period map `P` carries the state at phase 0 of the excitation over one period of it (times `multiple` for
//! subharmonic motion). Shooting solves `P(z) - z = 0` by Newton's method with the exact derivative of the flow, which the
//! integrator carries along (linear inside a contact phase, saltation matrix across events); it finds stable and
//! unstable solutions alike. Where an implicit method leaves the ringing of stiff supports unresolved, Newton's method
//! solves for the other coordinates and the supports follow. Waiting follows the physics, finds stable ones only, and tells subharmonic
//! and non-periodic motion apart.
//!
//! Residuals and distances are relative to the static scale of the pair (see [`crate::Options`]).
//!
//! Tests: `tests/periodic.rs`.

use crate::error::{LpmError, check};
use crate::floquet::{Multiplier, Stability, multipliers, stability};
use crate::integrate::{Cursor, Method, Options, Runner, StepControl};
use crate::linear;
use crate::model::{Model, State, with_system};
use crate::system::{System, Vector};

/// Adaptive steps repeat a period to within this many tolerances.
const NOISE: f64 = 30.0;
/// Periods without a halving of the change after which it counts as noise, near the level of the noise.
const STALE_PERIODS: usize = 20;

/// Options of [`Model::shoot`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShootingOptions<'a> {
    /// Integration.
    pub integration: Options<'a>,
    /// Relative residual at which the orbit counts as found (1e-13 to 1e-3).
    pub tolerance: f64,
    /// Newton iterations allowed.
    pub max_iterations: usize,
    /// Periods of the excitation in one period of the motion (1: same period; 2 and more: subharmonic).
    pub multiple: usize,
}

impl Default for ShootingOptions<'_> {
    /// Residual 1e-9 with integration at 1e-10, 30 iterations, the period of the excitation.
    fn default() -> Self {
        Self { integration: Options::with_tolerance(1e-10), tolerance: 1e-9, max_iterations: 30, multiple: 1 }
    }
}

impl ShootingOptions<'_> {
    /// Checks ranges.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for the first number outside its range.
    pub fn validate(&self) -> Result<(), LpmError> {
        self.integration.validate()?;
        let t = self.tolerance;
        check((1e-13..=1e-3).contains(&t), "shooting tolerance", t, "-", "between 1e-13 and 1e-3")?;
        check(self.max_iterations >= 1, "iterations", self.max_iterations as f64, "-", "at least 1")?;
        check((1..=10_000).contains(&self.multiple), "period multiple", self.multiple as f64, "-", "1 to 10000")?;
        Ok(())
    }
}

/// How a search for a periodic solution ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrbitStatus {
    /// Residual below tolerance.
    Converged,
    /// Iterations used up; the best state is returned.
    IterationLimit,
    /// The Newton matrix is singular: solutions are not isolated here (no load, or a bifurcation).
    Singular,
}

/// A periodic solution.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Orbit {
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// State at phase 0 of the excitation.
    pub state: State,
    /// Periods of the excitation in one period of the motion.
    pub multiple: usize,
    /// Floquet multipliers over the period of the motion, largest modulus first, of the coordinates the method resolves.
    pub multipliers: Vec<Multiplier>,
    /// Relative residual.
    pub residual: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Outcome.
    pub status: OrbitStatus,
}

impl Orbit {
    /// Stability by the multipliers.
    pub fn stability(&self) -> Stability {
        stability(&self.multipliers)
    }

    /// Converged and stable.
    pub fn is_attractor(&self) -> bool {
        self.status == OrbitStatus::Converged && self.stability() == Stability::Stable
    }
}

/// Options of [`Model::steady_state`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyOptions<'a> {
    /// Integration.
    pub integration: Options<'a>,
    /// Relative change from period to period at which the motion counts as steady (1e-12 to 0.1). Adaptive integration
    /// repeats itself to some thirty times its own tolerance: where this is less, that counts.
    pub tolerance: f64,
    /// Mesh cycles after which the wait ends (whole periods of the excitation, two at least).
    pub max_cycles: usize,
    /// Subharmonic motion is recognised up to this multiple of the excitation's period.
    pub max_multiple: usize,
    /// Finish by shooting once the change per period is below one percent, provided the orbit found is stable and near.
    pub polish: bool,
}

impl Default for SteadyOptions<'_> {
    /// Change below 1e-7, 20000 mesh cycles, subharmonics to order 8, polished.
    fn default() -> Self {
        Self { integration: Options::default(), tolerance: 1e-7, max_cycles: 20_000, max_multiple: 8, polish: true }
    }
}

impl SteadyOptions<'_> {
    /// Checks ranges.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for the first number outside its range.
    pub fn validate(&self) -> Result<(), LpmError> {
        self.integration.validate()?;
        let t = self.tolerance;
        check((1e-12..=0.1).contains(&t), "steady-state tolerance", t, "-", "between 1e-12 and 0.1")?;
        check(self.max_cycles >= 2, "mesh cycles", self.max_cycles as f64, "-", "at least 2")?;
        check((1..=64).contains(&self.max_multiple), "period multiple", self.max_multiple as f64, "-", "1 to 64")?;
        Ok(())
    }
}

/// What a wait for the steady state found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub struct Steady {
    /// State at phase 0 of the excitation.
    pub state: State,
    /// Periods of the excitation in one period of the motion; `None`: not periodic within the periods allowed.
    pub multiple: Option<usize>,
    /// Periods of the excitation integrated.
    pub periods: usize,
    /// Last relative change over one period of the motion.
    pub residual: f64,
}

impl Model {
    /// Integrates from `start` at phase 0 until the motion repeats.
    ///
    /// # Errors
    /// As [`Model::simulate`]. A motion that does not repeat is not an error: see [`Steady`].
    pub fn steady_state(
        &self,
        mesh_frequency: f64,
        start: &State,
        options: &SteadyOptions,
    ) -> Result<Steady, LpmError> {
        options.validate()?;
        with_system!(self, s => steady(s, mesh_frequency, s.import(start)?, options))
    }

    /// Finds the periodic solution near `guess` (state at phase 0) by shooting.
    ///
    /// # Errors
    /// As [`Model::simulate`]; [`LpmError::Singular`] where the period map has no multipliers. Iterations that do not converge, and singular
    /// Newton matrices, are a status of the [`Orbit`].
    pub fn shoot(&self, mesh_frequency: f64, guess: &State, options: &ShootingOptions) -> Result<Orbit, LpmError> {
        options.validate()?;
        with_system!(self, s => shoot(s, mesh_frequency, s.import(guess)?, options))
    }
}

/// Components of the state that a method resolves. Translations on stiff supports count for the explicit method only: an
/// implicit one lets them follow the mesh force and damps their ringing, so that after a period they depend on the choice
/// of steps more than on where they started.
pub(crate) fn resolved<const N: usize>(s: &System<N>, method: Method) -> Vec<usize> {
    (0..2 * N).filter(|i| method.resolves_all() || !s.is_stiff(i % N)).collect()
}

/// `target` with the components that are not resolved taken from `source`.
pub(crate) fn follow<const N: usize>(resolved: &[usize], target: &Vector<N>, source: &Vector<N>) -> Vector<N> {
    let mut r = *source;
    for &i in resolved {
        r.set(i, target.get(i));
    }
    r
}

/// Largest difference in natural units over the resolved components.
pub(crate) fn distance<const N: usize>(s: &System<N>, method: Method, a: &Vector<N>, b: &Vector<N>) -> f64 {
    let counts = |i: usize| method.resolves_all() || !s.is_stiff(i % N);
    (0..2 * N).filter(|i| counts(*i)).map(|i| (a.get(i) - b.get(i)).abs() / s.unit(i)).fold(0.0, f64::max)
}

/// Relative change to which an integration repeats itself.
pub(crate) fn repeatability(o: &Options) -> f64 {
    match o.step {
        StepControl::Adaptive { tolerance } => NOISE * tolerance,
        StepControl::Fixed { .. } => 0.0,
    }
}

fn steady<const N: usize>(
    s: &System<N>,
    frequency: f64,
    start: Vector<N>,
    o: &SteadyOptions,
) -> Result<Steady, LpmError> {
    let run = Runner::new(s, &o.integration, frequency)?;
    let period = s.excitation().period() as f64;
    let mut cursor = Cursor::new(0.0, start);
    let mut history = vec![start];
    let mut next_polish = 1e-2;
    let noise = repeatability(&o.integration);
    let tolerance = o.tolerance.max(noise);
    // Least change so far, and periods since it was last halved.
    let (mut least, mut stale) = (f64::INFINITY, 0);
    let mut previous = 1.0;
    let done = |state: &Vector<N>, multiple, periods, residual| {
        Ok(Steady { state: s.export(state), multiple, periods, residual })
    };
    let max_periods = o.max_cycles.div_ceil(s.excitation().period()).max(2);
    for n in 1..=max_periods {
        // Every period begins with the same choice of step: what is left to differ is the state.
        cursor.h = 0.0;
        run.advance(&mut cursor, period, |_| {})?;
        history.insert(0, cursor.z);
        history.truncate(2 * o.max_multiple + 1);
        let change = |m: usize| history.get(m).map_or(f64::INFINITY, |z| distance(s, run.method, &cursor.z, z));
        // A multiple must hold twice in a row, and no smaller one may: a slow transient is not a subharmonic.
        let twice = |m: usize| {
            let before =
                history.get(m).zip(history.get(2 * m)).map_or(f64::INFINITY, |(a, b)| distance(s, run.method, a, b));
            change(m).max(before)
        };
        let one = change(1);
        if one < tolerance {
            return done(&cursor.z, Some(1), n, one);
        }
        (least, stale) = if one < 0.5 * least { (one, 0) } else { (least, stale + 1) };
        // Changes that no longer fall and do not add up, near the noise of the integration: this is as steady as it gets.
        let scatter = || (1..history.len()).all(|m| change(m) < 4.0 * one);
        if stale >= STALE_PERIODS && one < 30.0 * noise && one < 1e-3 && scatter() {
            return done(&cursor.z, Some(1), n, one);
        }
        if let Some(m) = (2..=o.max_multiple).find(|&m| twice(m) < tolerance && one > 100.0 * tolerance) {
            return done(&cursor.z, Some(m), n, change(m));
        }
        // Where a period is long and damping ends the transient within it, waiting is the shorter way.
        let ratio = one / previous;
        previous = one;
        if o.polish && one < next_polish && one * ratio * ratio > tolerance {
            next_polish = 0.1 * one;
            let shooting = ShootingOptions {
                integration: o.integration,
                tolerance: tolerance.clamp(1e-13, 1e-3),
                max_iterations: 6,
                multiple: 1,
            };
            // A failure to polish only means that waiting goes on.
            match shoot(s, frequency, cursor.z, &shooting) {
                Ok(orbit) => {
                    let found = s.import(&orbit.state)?;
                    if orbit.is_attractor() && distance(s, run.method, &found, &cursor.z) < 0.1 {
                        return done(&found, Some(1), n, orbit.residual);
                    }
                }
                Err(stopped @ LpmError::Stopped { .. }) => return Err(stopped),
                Err(_) => {}
            }
        }
    }
    let residual = history.get(1).map_or(f64::INFINITY, |z| distance(s, run.method, &cursor.z, z));
    done(&cursor.z, None, max_periods, residual)
}

/// End of the period map, with its derivative by the components `by` as columns.
pub(crate) fn period_map<const N: usize>(
    run: &Runner<N>,
    z: Vector<N>,
    multiple: usize,
    by: &[usize],
) -> Result<(Vector<N>, Vec<Vector<N>>), LpmError> {
    let mut c = Cursor::with_tangents(0.0, z, by);
    run.advance(&mut c, (multiple * run.system.excitation().period()) as f64, |_| {})?;
    Ok((c.z, c.tangents))
}

/// Rows of `dP/dz - 1` over the components `by`, in natural units.
pub(crate) fn newton_matrix<const N: usize>(s: &System<N>, by: &[usize], columns: &[Vector<N>]) -> Vec<Vec<f64>> {
    by.iter()
        .map(|&i| {
            by.iter()
                .zip(columns)
                .map(|(&j, c)| c.get(i) * s.unit(j) / s.unit(i) - if i == j { 1.0 } else { 0.0 })
                .collect()
        })
        .collect()
}

fn shoot<const N: usize>(
    s: &System<N>,
    frequency: f64,
    guess: Vector<N>,
    o: &ShootingOptions,
) -> Result<Orbit, LpmError> {
    let run = Runner::new(s, &o.integration, frequency)?;
    let by = resolved(s, run.method);
    let mut z = guess;
    let (mut end, mut columns) = period_map(&run, z, o.multiple, &by)?;
    let mut residual = distance(s, run.method, &end, &z);
    let mut status = OrbitStatus::IterationLimit;
    let mut iterations = 0;
    while iterations <= o.max_iterations {
        if residual < o.tolerance {
            status = OrbitStatus::Converged;
            break;
        }
        if iterations == o.max_iterations {
            break;
        }
        iterations += 1;
        let rhs = by.iter().map(|&i| (z.get(i) - end.get(i)) / s.unit(i)).collect();
        let Ok(step) = linear::solve(newton_matrix(s, &by, &columns), rhs, "shooting") else {
            status = OrbitStatus::Singular;
            break;
        };
        // Halve the step while the residual does not fall (contact may begin or end on the way).
        let mut fraction = 1.0;
        for attempt in 0..7 {
            let mut trial = z;
            for (&i, d) in by.iter().zip(&step) {
                trial.set(i, z.get(i) + fraction * d * s.unit(i));
            }
            let mapped = period_map(&run, trial, o.multiple, &by);
            if let Err(stopped @ LpmError::Stopped { .. }) = mapped {
                return Err(stopped);
            }
            if let Ok((e, c)) = mapped {
                let r = distance(s, run.method, &e, &trial);
                if r < residual || attempt == 6 {
                    (z, end, columns, residual) = (trial, e, c, r);
                    break;
                }
            }
            fraction *= 0.5;
        }
    }
    Ok(Orbit {
        mesh_frequency: frequency,
        state: s.export(&follow(&by, &z, &end)),
        multiple: o.multiple,
        multipliers: multipliers(s, &by, &columns)?,
        residual,
        iterations,
        status,
    })
}
