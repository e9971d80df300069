//! The analyses of a case, in order, each over all states; states and speeds run in parallel, with the same bits as one by one.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use anyhow::{Context, anyhow, bail};
use lpm::{
    ContinuationOptions, Method, Model, Options, Response, Sampling, Spectrum, SteadyOptions, Stop, SweepOptions,
};
use rayon::prelude::*;

use crate::RunObserver;
use gearwright_case::LumpedPairCase;
use gearwright_case::lumped_pair::schema::{self, Direction, Start};
use gearwright_results::lumped::summary::Times;
use gearwright_results::lumped::{
    BranchResult, DamageResult, DamageSpeeds, Findings, ImpulseResult, State, SweepResult, TimeResponse,
};

/// Longest step of an approach to a speed (Hz).
const APPROACH_STEP: f64 = 50.0;
/// Mesh cycles recorded where teeth are not given.
const CYCLES: usize = 20;

/// Runs all analyses of a case.
///
/// # Errors
/// Model errors; cancellation.
pub fn run(
    case: &LumpedPairCase,
    states: &[State],
    observer: &dyn RunObserver,
    times: &mut Times,
) -> anyhow::Result<Findings> {
    let asked = || observer.is_cancelled();
    let run = Run { case, states, observer, integration: Options { stop: Stop::when(&asked), ..integration(case) } };
    let mut findings = Findings::default();
    let analysis = &case.inputs.analysis;
    if analysis.time.is_some() {
        findings.time = timed(observer, "response over time", &mut times.time, || run.time())?;
    }
    if let Some(sweep) = &analysis.sweep {
        findings.sweeps = timed(observer, "sweeps", &mut times.sweep, || run.sweeps(sweep))?;
    }
    if let Some(branch) = &analysis.continuation {
        findings.branches = timed(observer, "continuation", &mut times.continuation, || run.branches(branch))?;
    }
    if let Some(impulse) = &analysis.impulse {
        findings.impulses = timed(observer, "impulse tests", &mut times.impulse, || run.impulses(impulse))?;
    }
    if let Some(damage) = &analysis.damage {
        (findings.damage, findings.damage_speeds) =
            timed(observer, "damage-induced response", &mut times.damage, || {
                Ok((run.damage(&damage.mesh_frequencies_hz)?, run.damage_speeds(damage)?))
            })?;
    }
    Ok(findings)
}

/// Runs a stage and notes its wall time (s).
fn timed<R>(
    observer: &dyn RunObserver,
    stage: &str,
    slot: &mut f64,
    work: impl FnOnce() -> anyhow::Result<R>,
) -> anyhow::Result<R> {
    observer.stage(stage);
    let clock = Instant::now();
    let result = work();
    *slot = clock.elapsed().as_secs_f64();
    result
}

/// Evenly spaced values from `from` to `to` or just below it.
#[must_use]
pub fn grid(from: f64, to: f64, step: f64) -> Vec<f64> {
    let count = ((to - from) / step + 1e-9).floor().max(0.0) as usize;
    (0..=count).map(|i| from + i as f64 * step).collect()
}

fn integration(case: &LumpedPairCase) -> Options<'static> {
    let analysis = &case.inputs.analysis;
    let method = match analysis.method {
        schema::Method::Automatic => None,
        schema::Method::Exponential => Some(Method::Magnus),
        schema::Method::DormandPrince => Some(Method::DormandPrince),
        schema::Method::Implicit => Some(Method::Esdirk),
        schema::Method::Newmark => Some(Method::Newmark),
    };
    Options { method, ..Options::with_tolerance(analysis.tolerance) }
}

struct Run<'a> {
    case: &'a LumpedPairCase,
    states: &'a [State],
    observer: &'a dyn RunObserver,
    integration: Options<'a>,
}

impl Run<'_> {
    fn steady(&self) -> SteadyOptions<'_> {
        let tolerance = (10.0 * self.case.inputs.analysis.tolerance).clamp(1e-12, 0.1);
        SteadyOptions { integration: self.integration, tolerance, ..SteadyOptions::default() }
    }

    fn sampling(&self) -> Sampling {
        Sampling { per_cycle: self.case.inputs.analysis.samples_per_cycle as usize, energy: false }
    }

    /// Runs jobs in parallel, results in order.
    fn each<J: Sync, R: Send>(
        &self,
        jobs: &[J],
        work: impl Fn(&J) -> anyhow::Result<R> + Sync,
    ) -> anyhow::Result<Vec<R>> {
        let done = AtomicUsize::new(0);
        let results: Vec<anyhow::Result<R>> = jobs
            .par_iter()
            .map(|job| {
                if self.observer.is_cancelled() {
                    bail!("stopped; nothing was written");
                }
                let result = work(job)?;
                self.observer.advanced(done.fetch_add(1, Ordering::Relaxed) + 1, jobs.len());
                Ok(result)
            })
            .collect();
        results.into_iter().collect()
    }

    fn time(&self) -> anyhow::Result<Vec<TimeResponse>> {
        let request = self.case.inputs.analysis.time.ok_or_else(|| anyhow!("no time response is asked for"))?;
        let frequency = self.case.time_frequency().ok_or_else(|| anyhow!("the time response has no speed"))?;
        let cycles = request.mesh_cycles.map_or_else(|| self.case.rotation.unwrap_or(CYCLES), |c| c as usize);
        self.each(self.states, |state| {
            let model = &state.model;
            let start = match request.approach_from_hz {
                Some(from) => approach(model, from, frequency, &self.steady())?,
                None => model.equilibrium(0.0),
            };
            let (multiple, response) = match request.start {
                Start::Steady => {
                    let found = model.steady_response(frequency, &start, cycles, &self.sampling(), &self.steady());
                    let found = found.with_context(|| format!("state \"{}\" at {frequency} Hz", state.name))?;
                    (found.steady.multiple, found.response)
                }
                Start::Rest => (None, model.simulate(frequency, &start, cycles, &self.sampling(), &self.integration)?),
            };
            let spectrum = response.spectrum()?;
            let tooth_forces = tooth_forces(state, &response);
            Ok(TimeResponse { state: state.name.clone(), multiple, response, spectrum, tooth_forces })
        })
    }

    fn sweeps(&self, request: &schema::Sweep) -> anyhow::Result<Vec<SweepResult>> {
        let up = grid(request.from_hz, request.to_hz, request.step_hz);
        let down: Vec<f64> = up.iter().rev().copied().collect();
        let directions: &[bool] = match request.direction {
            Direction::Both => &[true, false],
            Direction::Up => &[true],
            Direction::Down => &[false],
        };
        let jobs: Vec<(&State, bool)> =
            self.states.iter().flat_map(|s| directions.iter().map(move |up| (s, *up))).collect();
        let options = SweepOptions { steady: self.steady(), sampling: self.sampling(), ..SweepOptions::default() };
        self.each(&jobs, |&(state, rising)| {
            let points = state.model.sweep(if rising { &up } else { &down }, &options);
            let points = points.with_context(|| format!("sweep of state \"{}\"", state.name))?;
            Ok(SweepResult { state: state.name.clone(), up: rising, points })
        })
    }

    fn branches(&self, request: &schema::Continuation) -> anyhow::Result<Vec<BranchResult>> {
        let states = if request.damaged { self.states } else { &self.states[..1] };
        let tolerance = self.case.inputs.analysis.tolerance;
        let finer = Options::with_tolerance((0.1 * tolerance).max(1e-13)).step;
        let fine = Options { step: finer, ..self.integration };
        let options = ContinuationOptions {
            from: request.from_hz,
            to: request.to_hz,
            max_step: request.largest_step,
            integration: fine,
            tolerance: tolerance.clamp(1e-12, 1e-3),
            ..ContinuationOptions::default()
        };
        self.each(states, |state| {
            let branch = || {
                let rest = state.model.equilibrium(0.0);
                let start = state.model.steady_state(request.to_hz, &rest, &self.steady())?;
                state.model.continuation(request.to_hz, &start.state, &options)
            };
            let branch = branch().with_context(|| format!("continuation of state \"{}\"", state.name))?;
            Ok(BranchResult { state: state.name.clone(), branch })
        })
    }

    fn impulses(&self, request: &schema::Impulse) -> anyhow::Result<Vec<ImpulseResult>> {
        let jobs: Vec<(&State, f64)> =
            self.states.iter().flat_map(|s| request.mesh_cycles.iter().map(move |t| (s, *t))).collect();
        self.each(&jobs, |&(state, mesh_cycle)| {
            let periods = request.periods as usize;
            let test = state.model.impulse_test(mesh_cycle, request.impulse_n_s, periods, &self.integration)?;
            Ok(ImpulseResult { state: state.name.clone(), mesh_cycle, test })
        })
    }

    fn damage_response(&self, state: &State, frequency: f64) -> anyhow::Result<DamageResult> {
        let healthy = &self.states[0].model;
        let rest = healthy.equilibrium(0.0);
        let response = healthy
            .damage_response(&state.model, frequency, &rest, &self.sampling(), &self.steady())
            .with_context(|| format!("state \"{}\" at {frequency} Hz", state.name))?;
        let duration = response.healthy.response.duration();
        let lines = Spectrum::of(&response.static_difference, duration)?;
        let static_amplitude = lines.peak(0.0, f64::INFINITY).map_or(0.0, |p| p.1);
        Ok(DamageResult { state: state.name.clone(), mesh_frequency: frequency, response, static_amplitude })
    }

    fn damage(&self, frequencies: &[f64]) -> anyhow::Result<Vec<DamageResult>> {
        let jobs: Vec<(&State, f64)> =
            self.states[1..].iter().flat_map(|s| frequencies.iter().map(move |f| (s, *f))).collect();
        self.each(&jobs, |&(state, frequency)| self.damage_response(state, frequency))
    }

    fn damage_speeds(&self, request: &schema::Damage) -> anyhow::Result<Vec<DamageSpeeds>> {
        let (Some(from), Some(to), Some(step)) = (request.from_hz, request.to_hz, request.step_hz) else {
            return Ok(Vec::new());
        };
        let speeds = grid(from, to, step);
        let mut all = Vec::new();
        for state in &self.states[1..] {
            let found = self.each(&speeds, |&frequency| {
                let result = self.damage_response(state, frequency)?;
                let (at, amplitude) = result.response.spectrum.peak(0.0, f64::INFINITY).unwrap_or_default();
                Ok((result.static_amplitude, [frequency, at, amplitude, result.response.peak_to_peak()]))
            })?;
            let static_amplitude = found.first().map_or(0.0, |f| f.0);
            let rows = found.into_iter().map(|f| f.1).collect();
            all.push(DamageSpeeds { state: state.name.clone(), static_amplitude, rows });
        }
        Ok(all)
    }
}

/// State at phase 0 at `to` (Hz), reached from `from` in small steps.
fn approach(model: &Model, from: f64, to: f64, options: &SteadyOptions) -> anyhow::Result<lpm::State> {
    let steps = ((to - from).abs() / APPROACH_STEP).ceil().max(1.0) as usize;
    let speeds = lpm::frequencies(from, to, steps + 1);
    let points = model.sweep(&speeds, &SweepOptions { steady: *options, ..SweepOptions::default() })?;
    points.last().map(|p| p.state).ok_or_else(|| anyhow!("no speeds to approach by"))
}

fn tooth_forces(state: &State, response: &Response) -> Vec<(usize, i32, f64)> {
    let Some(sharing) = &state.curves.sharing else { return Vec::new() };
    let mut all = Vec::new();
    for (sample, (&mesh_cycle, &force)) in response.mesh_cycle.iter().zip(&response.mesh_force).enumerate() {
        all.extend(sharing.at(mesh_cycle).into_iter().map(|(pair, share)| (sample, pair, share * force)));
    }
    all
}
