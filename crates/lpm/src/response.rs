//! A response sampled evenly over whole mesh cycles, and what is read off it.
//!
//! Every sample is a real step of the integration method from the start of the step that holds it, so samples are as
//! accurate as the run. Extremes are those of the cubic through displacement and velocity of neighbouring samples.
//!
//! | quantity | unit | sign |
//! |---|---|---|
//! | transmission error `x` | m | positive in the direction of tooth approach |
//! | mesh force `F` | N | positive where the drive flanks press, negative on the coast side |
//! | bearing force on the support, `k y + c y'` | N | along the line of action; pinion `-F`, gear `+F` for massless supports |
//!
//! Energy: per unit of time the load brings `f_0 x'`, the mesh spring takes `F_el delta'` (which includes the
//! parametric work of `k_l` and `delta_0`), dampers take `c delta'^2`; the balance against the change of kinetic
//! and support energy is a check of the whole integration, by four-point Gauss quadrature on every step.
//!
//! Tests: `tests/closed_form.rs`, `tests/convergence.rs` (energy balance), `tests/extreme.rs`.

use crate::curve::Curve;
use crate::error::{LpmError, check};
use crate::integrate::steppers::Step;
use crate::integrate::{Cursor, Event, Options, Record, Runner, Stats};
use crate::model::{Model, State, with_system};
use crate::spectrum::Spectrum;
use crate::system::{ContactPhase, System, Vector};

/// Gauss-Legendre nodes and weights on [0, 1], four points.
const GAUSS4: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// What to record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Samples per mesh cycle, 4 to 100000.
    pub per_cycle: usize,
    /// Compute the energy balance (four extra steps per step).
    pub energy: bool,
}

impl Default for Sampling {
    /// 100 samples per mesh cycle, no energy balance.
    fn default() -> Self {
        Self { per_cycle: 100, energy: false }
    }
}

/// A stretch of mesh cycles without drive contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Start (mesh cycles).
    pub start: f64,
    /// End (mesh cycles).
    pub end: f64,
    /// [`ContactPhase::Apart`] or [`ContactPhase::Coast`].
    pub phase: ContactPhase,
}

/// Work over a run (J). `residual` is load work minus all the rest, zero for the exact solution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyBalance {
    /// Work of the load `f_0` on `x`.
    pub load: f64,
    /// Work taken by the elastic mesh force.
    pub mesh_spring: f64,
    /// Work taken by mesh and support dampers.
    pub dissipated: f64,
    /// Change of kinetic and support spring energy.
    pub stored: f64,
    /// `load - mesh_spring - dissipated - stored`.
    pub residual: f64,
    /// Sum of the absolute work in and out: the scale to judge the residual by.
    pub turnover: f64,
}

/// A sampled response.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Response {
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// Mesh cycle of each sample; sample `i` at `i / per_cycle`, the end of the run excluded.
    pub mesh_cycle: Vec<f64>,
    /// Dynamic transmission error `x` (m).
    pub transmission_error: Vec<f64>,
    /// Its rate (m/s).
    pub velocity: Vec<f64>,
    /// Mesh deflection `delta` (m).
    pub mesh_deflection: Vec<f64>,
    /// Mesh force (N).
    pub mesh_force: Vec<f64>,
    /// Force on the pinion's support (N).
    pub pinion_bearing_force: Vec<f64>,
    /// Force on the gear's support (N).
    pub gear_bearing_force: Vec<f64>,
    /// Stretches without drive contact, in order.
    pub separations: Vec<Interval>,
    /// Changes of contact within segments of the excitation, in order.
    pub events: Vec<Event>,
    /// Mean mesh force `f_0` (N).
    pub mean_force: f64,
    /// State at the end.
    pub end: State,
    /// Energy balance, where asked for.
    pub energy: Option<EnergyBalance>,
    /// Cost.
    pub stats: Stats,
}

impl Model {
    /// Integrates `cycles` whole mesh cycles at `mesh_frequency` (Hz) from `start` at phase 0 of the excitation.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for numbers outside their ranges; [`LpmError::Unsuited`] for a method that cannot integrate the model;
    /// [`LpmError::StepUnderflow`], [`LpmError::Unbounded`] or [`LpmError::TooManyEvents`] where the integration ends early.
    pub fn simulate(
        &self,
        mesh_frequency: f64,
        start: &State,
        cycles: usize,
        sampling: &Sampling,
        options: &Options,
    ) -> Result<Response, LpmError> {
        with_system!(self, s => simulate(s, mesh_frequency, start, cycles, sampling, options))
    }
}

fn simulate<const N: usize>(
    s: &System<N>,
    mesh_frequency: f64,
    start: &State,
    cycles: usize,
    sampling: &Sampling,
    options: &Options,
) -> Result<Response, LpmError> {
    let n = sampling.per_cycle;
    check((4..=100_000).contains(&n), "samples per mesh cycle", n as f64, "-", "between 4 and 100000")?;
    check((1..=10_000_000).contains(&cycles), "mesh cycles", cycles as f64, "-", "between 1 and 1e7")?;
    let run = Runner::new(s, options, mesh_frequency)?;
    let z0 = s.import(start)?;
    let mut cursor = Cursor::new(0.0, z0);
    let mut rec = Recorder::new(&run, n, n * cycles, sampling.energy);
    run.advance(&mut cursor, cycles as f64, |r| rec.take(r))?;
    let mut out = rec.out;
    out.end = s.export(&cursor.z);
    out.stats = cursor.stats;
    if let Some(e) = &mut out.energy {
        e.stored = stored_energy(s, &cursor.z) - stored_energy(s, &z0);
        e.residual = e.load - e.mesh_spring - e.dissipated - e.stored;
    }
    Ok(out)
}

fn stored_energy<const N: usize>(s: &System<N>, z: &Vector<N>) -> f64 {
    (0..N).map(|i| 0.5 * (s.mass[i] * z.v[i] * z.v[i] + s.stiffness[i] * z.q[i] * z.q[i])).sum()
}

struct Recorder<'a, 'b, const N: usize> {
    run: &'a Runner<'b, N>,
    per_cycle: usize,
    total: usize,
    next: usize,
    out: Response,
}

impl<'a, 'b, const N: usize> Recorder<'a, 'b, N> {
    fn new(run: &'a Runner<'b, N>, per_cycle: usize, total: usize, energy: bool) -> Self {
        let column = || Vec::with_capacity(total);
        let out = Response {
            mesh_frequency: run.frequency,
            mesh_cycle: column(),
            transmission_error: column(),
            velocity: column(),
            mesh_deflection: column(),
            mesh_force: column(),
            pinion_bearing_force: column(),
            gear_bearing_force: column(),
            separations: Vec::new(),
            events: Vec::new(),
            mean_force: run.system.force(),
            end: State::default(),
            energy: energy.then(EnergyBalance::default),
            stats: Stats::default(),
        };
        Self { run, per_cycle, total, next: 0, out }
    }

    fn state(&self, r: &Record<N>, theta: f64) -> Vector<N> {
        if theta <= 0.0 {
            return r.before;
        }
        let (s, m, f) = (self.run.system, self.run.method, self.run.frequency);
        Step::prepare(s, m, r.phase, r.segment, r.tau, theta * r.dtau, f).apply(s, &r.before).0
    }

    fn take(&mut self, r: &Record<N>) {
        let (lo, hi) = (r.base + r.tau, r.base + r.tau + r.dtau);
        while self.next < self.total {
            let at = self.next as f64 / self.per_cycle as f64;
            // Samples on a boundary belong to the later step, so that jumps are seen from the right.
            if at >= hi - 1e-12 {
                break;
            }
            let theta = ((at - lo) / r.dtau).clamp(0.0, 1.0);
            let z = self.state(r, theta);
            self.push(r, at, r.tau + theta * r.dtau, &z);
            self.next += 1;
        }
        if r.phase != ContactPhase::Drive {
            match self.out.separations.last_mut() {
                Some(last) if last.phase == r.phase && lo - last.end < 1e-11 => last.end = hi,
                _ => self.out.separations.push(Interval { start: lo, end: hi, phase: r.phase }),
            }
        }
        if let Some(to) = r.next {
            self.out.events.push(Event { mesh_cycle: hi, from: r.phase, to });
        }
        self.add_energy(r);
    }

    fn push(&mut self, r: &Record<N>, at: f64, tau: f64, z: &Vector<N>) {
        let s = self.run.system;
        let co = s.coefs(r.phase, r.segment, tau);
        let force = s.mesh_force(&co, z);
        let support = |i: usize, reaction: f64| {
            if i < N { s.stiffness[i] * z.q[i] + s.damping[i] * z.v[i] } else { reaction }
        };
        let o = &mut self.out;
        o.mesh_cycle.push(at);
        o.transmission_error.push(z.q[0]);
        o.velocity.push(z.v[0]);
        o.mesh_deflection.push(s.deflection(z, force));
        o.mesh_force.push(force);
        o.pinion_bearing_force.push(support(1, -force));
        o.gear_bearing_force.push(support(2, force));
    }

    fn add_energy(&mut self, r: &Record<N>) {
        let Some(mut e) = self.out.energy else { return };
        let s = self.run.system;
        for (theta, weight) in GAUSS4 {
            let z = self.state(r, theta);
            let co = s.coefs(r.phase, r.segment, r.tau + theta * r.dtau);
            let w = weight * r.dtau / self.run.frequency;
            let rate = s.along_mesh(&z.v);
            let load = w * co.load * z.v[0];
            let spring = w * (co.k * s.along_mesh(&z.q) + co.p) * rate;
            let mut loss = w * co.c * rate * rate;
            for i in 0..N {
                loss += w * s.damping[i] * z.v[i] * z.v[i];
            }
            e.load += load;
            e.mesh_spring += spring;
            e.dissipated += loss;
            e.turnover += load.abs() + spring.abs() + loss;
        }
        self.out.energy = Some(e);
    }
}

/// An extreme of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme {
    /// Value (m).
    pub value: f64,
    /// Mesh cycle at which it occurs.
    pub mesh_cycle: f64,
}

impl Response {
    /// Samples per mesh cycle.
    pub fn per_cycle(&self) -> f64 {
        match self.mesh_cycle.get(1) {
            Some(t) => 1.0 / t,
            None => 1.0,
        }
    }

    /// Duration (s).
    pub fn duration(&self) -> f64 {
        self.mesh_cycle.len() as f64 / self.per_cycle() / self.mesh_frequency
    }

    /// Largest transmission error and where.
    pub fn maximum(&self) -> Extreme {
        self.extreme(1.0)
    }

    /// Least transmission error and where.
    pub fn minimum(&self) -> Extreme {
        self.extreme(-1.0)
    }

    /// Peak-to-peak transmission error (m).
    pub fn peak_to_peak(&self) -> f64 {
        self.maximum().value - self.minimum().value
    }

    /// Mean transmission error (m).
    pub fn mean(&self) -> f64 {
        mean(&self.transmission_error)
    }

    /// Root mean square of the transmission error about its mean (m).
    pub fn rms(&self) -> f64 {
        let m = self.mean();
        let squares: f64 = self.transmission_error.iter().map(|x| (x - m) * (x - m)).sum();
        (squares / self.transmission_error.len() as f64).sqrt()
    }

    /// Largest mesh force over the mean mesh force; 0 without load.
    pub fn dynamic_factor(&self) -> f64 {
        let top = self.mesh_force.iter().copied().fold(0.0, f64::max);
        if self.mean_force > 0.0 { top / self.mean_force } else { 0.0 }
    }

    /// Fraction of the run without drive contact.
    pub fn separated_fraction(&self) -> f64 {
        let apart = self.separations.iter().fold(0.0, |sum, i| sum + (i.end - i.start));
        apart / (self.mesh_cycle.len() as f64 / self.per_cycle())
    }

    /// Force on one tooth pair (N), from the curve of its share of the mesh force (0 to 1 over the mesh phase).
    pub fn pair_force(&self, share: &Curve) -> Vec<f64> {
        self.mesh_cycle.iter().zip(&self.mesh_force).map(|(t, f)| share.value(*t) * f).collect()
    }

    /// Amplitude spectrum of the transmission error.
    ///
    /// # Errors
    /// As [`Spectrum::of`].
    pub fn spectrum(&self) -> Result<Spectrum, LpmError> {
        Spectrum::of(&self.transmission_error, self.duration())
    }

    fn extreme(&self, sign: f64) -> Extreme {
        let (x, v, t) = (&self.transmission_error, &self.velocity, &self.mesh_cycle);
        let spacing = 1.0 / self.per_cycle();
        let mut best = Extreme { value: f64::NEG_INFINITY, mesh_cycle: 0.0 };
        let mut take = |value: f64, mesh_cycle: f64| {
            if value > best.value {
                best = Extreme { value, mesh_cycle };
            }
        };
        for i in 0..x.len() {
            take(sign * x[i], t[i]);
            // After the last sample comes the end of the run.
            let x1 = x.get(i + 1).copied().unwrap_or(self.end.position[0]);
            let v1 = v.get(i + 1).copied().unwrap_or(self.end.velocity[0]);
            let dt = spacing / self.mesh_frequency;
            let (d0, d1) = (sign * v[i] * dt, sign * v1 * dt);
            if d0 > 0.0 && d1 < 0.0 {
                // Maximum of the cubic through both samples with their slopes.
                let rise = sign * (x1 - x[i]);
                let (c2, c3) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
                let disc = (c2 * c2 - 3.0 * c3 * d0).max(0.0).sqrt();
                let u = if c2 < 0.0 { d0 / (disc - c2) } else { -(c2 + disc) / (3.0 * c3) };
                if (0.0..=1.0).contains(&u) {
                    take(sign * x[i] + u * (d0 + u * (c2 + u * c3)), t[i] + u * spacing);
                }
            }
        }
        Extreme { value: sign * best.value, ..best }
    }
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}
