//! Time integration over contact phases: land on every jump of the excitation, locate every loss and gain of
//! contact, keep the local error within tolerance in between.
//!
//! The independent variable is the mesh phase `tau` (mesh cycles). A *segment* is a stretch without jump or kink of
//! the excitation; within a segment and a contact phase the equations are linear with smooth coefficients
//! ([`crate::system`]), which every method of [`steppers`] integrates at its full order.
//!
//! Tolerance is relative to the static scale of the pair: displacements to `max(f_0/k, |delta_0|)`, velocities to that
//! times the mesh frequency in rad/s. Translations on supports whose own frequency is more than ten times the mesh
//! frequency take no part in the error control of the implicit methods: there the L-stable method follows the quasi-static
//! support deflection and damps the ringing of the support, and the step is set by the mesh.
//!
//! An error estimate sees the excitation at the nodes of the step only. Steps are therefore no longer than an eighth of the
//! mesh mode's period, a piece of a spline, or a quarter of the shortest wave of a Fourier series.
//!
//! Tests: `tests/closed_form.rs`, `tests/convergence.rs`, `tests/extreme.rs`.

pub(crate) mod events;
pub(crate) mod steppers;
mod stop;

use crate::error::{LpmError, check};
use crate::excitation::Segment;
use crate::system::{ContactPhase, System, Vector};
use steppers::Step;
pub use stop::Stop;

/// Integration method, see the table in the module `steppers` for orders and sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Exponential integrator of order 6 for one coordinate: exact where coefficients are constant. The default there.
    Magnus,
    /// Explicit Runge-Kutta 5(4).
    DormandPrince,
    /// L-stable diagonally implicit Runge-Kutta 4(3): the choice for integrated supports.
    Esdirk,
    /// Average acceleration, order 2, as finite-element programs use it.
    Newmark,
}

impl Method {
    /// Every method, for studies.
    pub const ALL: [Self; 4] = [Self::Magnus, Self::DormandPrince, Self::Esdirk, Self::Newmark];

    /// Short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Magnus => "magnus6",
            Self::DormandPrince => "dormand-prince5",
            Self::Esdirk => "esdirk4",
            Self::Newmark => "newmark2",
        }
    }

    /// Must follow every motion, that of stiff supports too.
    pub(crate) fn resolves_all(self) -> bool {
        self == Self::DormandPrince
    }

    /// Order of the local error estimate: the estimate shrinks with this power of the step.
    fn estimate_power(self) -> f64 {
        match self {
            Self::Magnus | Self::DormandPrince => 5.0,
            Self::Esdirk => 4.0,
            Self::Newmark => 3.0,
        }
    }
}

/// How the step is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepControl {
    /// Local error per step below this fraction of the static scale, 1e-14 to 0.1.
    Adaptive {
        /// Relative tolerance.
        tolerance: f64,
    },
    /// At least this many equal steps per mesh cycle in each segment.
    Fixed {
        /// Steps per mesh cycle, 1 to 1e8.
        per_cycle: f64,
    },
}

/// Integration options.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options<'a> {
    /// `None`: [`Method::Magnus`] for one coordinate, [`Method::Esdirk`] for three.
    pub method: Option<Method>,
    /// Step choice.
    pub step: StepControl,
    /// Contact events allowed in one mesh cycle (or one natural period, where longer) before the run is given up.
    pub max_events_per_cycle: usize,
    /// Steps, rejected ones included, that one integration may take, at least 1. An integration that must take more by its own limit on the
    /// step is refused before its first step.
    pub max_steps: u64,
    /// Asked every [`STOP_STEPS`] steps.
    pub stop: Stop<'a>,
}

/// Steps between two questions whether to stop.
pub const STOP_STEPS: u64 = 256;

impl Default for Options<'_> {
    /// Adaptive steps at a tolerance of 1e-8, at most 1e7 of them (some seconds).
    fn default() -> Self {
        Self {
            method: None,
            step: StepControl::Adaptive { tolerance: 1e-8 },
            max_events_per_cycle: 1000,
            max_steps: 10_000_000,
            stop: Stop::default(),
        }
    }
}

impl Options<'_> {
    /// Default options at another tolerance.
    pub fn with_tolerance(tolerance: f64) -> Self {
        Self { step: StepControl::Adaptive { tolerance }, ..Self::default() }
    }

    /// Checks ranges.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for the first number outside its range.
    pub fn validate(&self) -> Result<(), LpmError> {
        match self.step {
            StepControl::Adaptive { tolerance: t } => {
                check((1e-14..=0.1).contains(&t), "tolerance", t, "-", "between 1e-14 and 0.1")?
            }
            StepControl::Fixed { per_cycle: n } => {
                check((1.0..=1e8).contains(&n), "steps per mesh cycle", n, "-", "between 1 and 1e8")?
            }
        };
        check(self.max_events_per_cycle >= 1, "events per cycle", self.max_events_per_cycle as f64, "-", "at least 1")?;
        check(self.max_steps >= 1, "steps", self.max_steps as f64, "-", "at least 1")?;
        Ok(())
    }

    pub(crate) fn method_for<const N: usize>(&self) -> Result<Method, LpmError> {
        match (self.method, N) {
            (None, 1) => Ok(Method::Magnus),
            (None, _) => Ok(Method::Esdirk),
            (Some(Method::Magnus), n) if n > 1 => Err(LpmError::Unsuited {
                method: "magnus6",
                reason: "needs one coordinate; use esdirk4 for integrated supports, or eliminate them",
            }),
            (Some(m), _) => Ok(m),
        }
    }
}

/// What a run cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stats {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Contact events.
    pub events: u64,
    /// Trial steps spent on locating events.
    pub event_trials: u64,
}

/// A change of contact at an instant between two phases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Mesh cycle, counted from the start of the run's first period.
    pub mesh_cycle: f64,
    /// Phase before.
    pub from: ContactPhase,
    /// Phase after.
    pub to: ContactPhase,
}

/// One accepted step, for observers.
pub(crate) struct Record<'a, const N: usize> {
    /// Mesh cycles completed before the current period of the excitation.
    pub base: f64,
    /// Start within the period.
    pub tau: f64,
    pub dtau: f64,
    pub segment: &'a Segment,
    pub phase: ContactPhase,
    /// Phase that holds from the end of this step, if another.
    pub next: Option<ContactPhase>,
    pub before: Vector<N>,
    pub after: Vector<N>,
}

/// A state on the move.
#[derive(Debug, Clone)]
pub(crate) struct Cursor<const N: usize> {
    /// Whole mesh cycles before the current period.
    pub base: f64,
    /// Phase in `[0, period)`.
    pub tau: f64,
    pub z: Vector<N>,
    /// Tangent vectors carried along.
    pub tangents: Vec<Vector<N>>,
    /// Suggested step (mesh cycles), 0 when none.
    pub h: f64,
    pub phase: Option<ContactPhase>,
    pub stats: Stats,
}

impl<const N: usize> Cursor<N> {
    pub fn new(tau: f64, z: Vector<N>) -> Self {
        Self { base: 0.0, tau, z, tangents: Vec::new(), h: 0.0, phase: None, stats: Stats::default() }
    }

    /// With a unit tangent vector for each component in `by`: together they become the derivative of the flow by these.
    pub fn with_tangents(tau: f64, z: Vector<N>, by: &[usize]) -> Self {
        let mut c = Self::new(tau, z);
        c.tangents = by
            .iter()
            .map(|&i| {
                let mut t = Vector::ZERO;
                t.set(i, 1.0);
                t
            })
            .collect();
        c
    }
}

/// Fixed data of a run.
pub(crate) struct Runner<'a, const N: usize> {
    pub system: &'a System<N>,
    pub method: Method,
    pub options: Options<'a>,
    /// Mesh frequency (Hz).
    pub frequency: f64,
    /// Hold the tangent vectors to the tolerance too (the state alone may be at rest).
    pub control_tangents: bool,
}

impl<'a, const N: usize> Runner<'a, N> {
    pub fn new(system: &'a System<N>, options: &Options<'a>, frequency: f64) -> Result<Self, LpmError> {
        options.validate()?;
        check((1e-6..=1e9).contains(&frequency), "mesh frequency", frequency, "Hz", "between 1e-6 and 1e9")?;
        Ok(Self { system, method: options.method_for::<N>()?, options: *options, frequency, control_tangents: false })
    }

    /// Advances `cursor` by `cycles` mesh cycles and shows every accepted step to `observe`.
    pub fn advance(
        &self,
        cursor: &mut Cursor<N>,
        cycles: f64,
        mut observe: impl FnMut(&Record<N>),
    ) -> Result<(), LpmError> {
        let excitation = self.system.excitation();
        let period = excitation.period() as f64;
        let needed = cycles / self.longest_step();
        if needed > self.options.max_steps as f64 {
            let (limit, frequency) = (self.options.max_steps, self.frequency);
            return Err(LpmError::TooManySteps { cycles, frequency, needed, limit });
        }
        let mut left = cycles;
        let mut index = excitation.segment_at(cursor.tau);
        let resolution = 1e-12;
        while left > resolution {
            let segment = excitation.segments()[index];
            // A stop that misses the end of the segment by rounding is the end of the segment.
            let whole = left >= segment.end - cursor.tau - resolution;
            let end = if whole { segment.end } else { cursor.tau + left };
            left -= end - cursor.tau;
            if end > cursor.tau {
                self.cross_segment(cursor, &segment, end, &mut observe)?;
            }
            if whole {
                index += 1;
                // The boundary may have jumped with the excitation.
                cursor.phase = None;
                if index == excitation.segments().len() {
                    index = 0;
                    cursor.base += period;
                    cursor.tau = 0.0;
                }
            }
        }
        Ok(())
    }

    fn cross_segment(
        &self,
        cursor: &mut Cursor<N>,
        segment: &Segment,
        end: f64,
        observe: &mut impl FnMut(&Record<N>),
    ) -> Result<(), LpmError> {
        let (s, f) = (self.system, self.frequency);
        let cap = self.longest_step();
        let event_span = 1f64.max(8.0 * cap);
        let cap = cap.min(segment.max_step);
        let mut stuck = 0usize;
        let mut window = (cursor.base + cursor.tau, 0usize);
        while cursor.tau < end {
            let tau = cursor.tau;
            self.go_on(cursor)?;
            let phase = match cursor.phase {
                Some(p) => p,
                None => s.phase(segment, tau, f, &cursor.z),
            };
            cursor.phase = Some(phase);
            let mut h = self.first_guess(cursor.h, cap, end - tau, segment.end - segment.start);
            let (step, after) = loop {
                let last = h >= end - tau;
                let dtau = if last { end - tau } else { h };
                let step = Step::prepare(s, self.method, phase, segment, tau, dtau, f);
                let (after, error) = step.apply(s, &cursor.z);
                let StepControl::Adaptive { tolerance } = self.options.step else {
                    break (step, after);
                };
                let size =
                    s.norm(&error, self.method.resolves_all()).max(self.tangent_error(cursor, &step)) / tolerance;
                if size <= 1.0 && after.is_finite() {
                    let grow = if size > 0.0 { 0.9 * size.powf(-1.0 / self.method.estimate_power()) } else { 5.0 };
                    // A step cut short by the end of the segment must not shorten the next.
                    cursor.h = (dtau * grow.clamp(0.2, 5.0)).max(if last { cursor.h.min(h) } else { 0.0 }).min(cap);
                    break (step, after);
                }
                cursor.stats.rejected += 1;
                self.go_on(cursor)?;
                let shrink = if size.is_finite() { 0.9 * size.powf(-1.0 / self.method.estimate_power()) } else { 0.1 };
                h = dtau * shrink.clamp(0.1, 0.9);
                if h < 1e-13 * (1.0 + segment.end) {
                    return Err(LpmError::StepUnderflow { phase: cursor.base + tau, step: h, tolerance });
                }
            };
            let dtau = step.span() * f;
            let reached_end = dtau >= (end - tau) * (1.0 - 1e-14);
            let mut record = Record {
                base: cursor.base,
                tau,
                dtau: if reached_end { end - tau } else { dtau },
                segment,
                phase,
                next: None,
                before: cursor.z,
                after,
            };
            let mut taken = step;
            let cut = if stuck > 2 { None } else { events::find(self, &record, &mut cursor.stats.event_trials) };
            let mut new_tau = if reached_end { end } else { tau + dtau };
            if let Some(cut) = cut {
                record.dtau *= cut.theta;
                taken = Step::prepare(s, self.method, phase, segment, tau, record.dtau, f);
                record.after = taken.apply(s, &cursor.z).0;
                record.next = cut.next;
                new_tau = tau + record.dtau;
            } else if stuck > 2 {
                // Contact neither begins nor ends here (grazing to rounding): leave the boundary, then look again.
                stuck = 0;
                record.next = Some(s.phase(segment, new_tau.min(end), f, &record.after)).filter(|p| *p != phase);
            }
            if !record.after.is_finite() || record.after.q.iter().any(|q| q.abs() > s.bound()) {
                return Err(LpmError::Unbounded { phase: cursor.base + tau, limit: s.bound() });
            }
            self.carry_tangents(cursor, &record, &taken);
            cursor.stats.steps += 1;
            if let Some(next) = record.next {
                cursor.stats.events += 1;
                stuck = if record.dtau < 1e-12 { stuck + 1 } else { 0 };
                cursor.phase = Some(next);
                window.1 += 1;
                let here = cursor.base + new_tau;
                if here - window.0 > event_span {
                    window = (here, 0);
                } else if window.1 > self.options.max_events_per_cycle {
                    return Err(LpmError::TooManyEvents { phase: here, limit: self.options.max_events_per_cycle });
                }
            }
            cursor.z = record.after;
            cursor.tau = new_tau;
            observe(&record);
        }
        Ok(())
    }

    /// Longest step (mesh cycles): an eighth of the mesh mode's period.
    fn longest_step(&self) -> f64 {
        self.system.omega.recip() * std::f64::consts::TAU / 8.0 * self.frequency
    }

    /// Ends an integration that has taken all its steps, or is asked to stop.
    fn go_on(&self, cursor: &Cursor<N>) -> Result<(), LpmError> {
        let taken = cursor.stats.steps + cursor.stats.rejected;
        if taken >= self.options.max_steps {
            return Err(LpmError::StepLimit { phase: cursor.base + cursor.tau, limit: self.options.max_steps });
        }
        if taken % STOP_STEPS == 0 && self.options.stop.is_requested() {
            return Err(LpmError::Stopped { phase: cursor.base + cursor.tau });
        }
        Ok(())
    }

    /// Largest error of a tangent vector, in natural units.
    fn tangent_error(&self, cursor: &Cursor<N>, step: &Step) -> f64 {
        if !self.control_tangents {
            return 0.0;
        }
        let linear = step.homogeneous();
        let size = |(j, t): (usize, &Vector<N>)| {
            let e = linear.apply(self.system, t).1;
            self.system.norm(&e, self.method.resolves_all()) * self.system.unit(j)
        };
        cursor.tangents.iter().enumerate().map(size).fold(0.0, f64::max)
    }

    /// Length of the next trial step (mesh cycles).
    fn first_guess(&self, suggested: f64, cap: f64, remaining: f64, segment: f64) -> f64 {
        let h = match self.options.step {
            StepControl::Fixed { per_cycle } => {
                let full = segment / (segment * per_cycle).ceil().max(1.0);
                return remaining / (remaining / full * (1.0 - 1e-9)).ceil().max(1.0);
            }
            StepControl::Adaptive { .. } if suggested > 0.0 => suggested.min(cap),
            StepControl::Adaptive { .. } => 0.25 * cap,
        };
        if h >= remaining {
            remaining
        } else if 2.0 * h > remaining {
            0.5 * remaining
        } else {
            h
        }
    }

    /// Derivative of the flow across the step, and across the event at its end (saltation matrix).
    fn carry_tangents(&self, cursor: &mut Cursor<N>, record: &Record<N>, taken: &Step) {
        if cursor.tangents.is_empty() {
            return;
        }
        let s = self.system;
        let linear = taken.homogeneous();
        let jump = record.next.and_then(|next| events::saltation(self, record, next));
        for t in &mut cursor.tangents {
            *t = linear.apply(s, t).0;
            if let Some((column, row_scale)) = &jump {
                let normal = s.along_mesh(&t.q) * row_scale;
                for i in 0..N {
                    t.v[i] += column[i] * normal;
                }
            }
        }
    }
}
