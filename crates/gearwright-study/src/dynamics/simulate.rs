//! One state at one speed: transient until the motion repeats, then the record, in pieces between which the run can stop.
//!
//! A run starts one step before the mesh cycle at which the record begins, or before the given transient. Periods of the excitation follow until the
//! transmission error repeats; the last of them is the record, or its beginning. A damaged pair sets out from the end of the healthy one's record,
//! where its teeth stand as at its own start. [`Progress`] holds all that a run needs to go on.

use std::time::Duration;

use fecm::dynamics::{
    DynamicsRequest, DynamicsRun, DynamicsState, EnergyBalance, InitialState, Motion, PairDynamics, RunStats,
    StepRecord,
};
use fecm::lcp::SolveStats;
use fecm::statics::Observer;
use serde::{Deserialize, Serialize};

use gearwright_case::DynamicsCase;
use gearwright_results::dynamics::{Sample, Work};

/// How far a run has come.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Progress {
    /// Steps before the record, once it has begun.
    pub before_record: Option<i64>,
    /// Where the run stands; `None` before its first step.
    pub state: Option<SavedState>,
    /// Transmission errors of the last whole period (m).
    pub last_period: Vec<f64>,
    /// Steps of the period or record under way.
    pub samples: Vec<Sample>,
    /// Root mean square of the change from the last period but one to the last, over that of the variation.
    pub change: Option<f64>,
    /// How much of the change is left from one period to the next.
    pub shrink: Option<f64>,
    /// State at the first frame of a film.
    pub film_start: Option<SavedState>,
    /// Work done.
    pub work: Work,
    /// Whether the record is complete.
    pub complete: bool,
}

/// A state of the engine, as it is kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SavedState(#[serde(with = "StateFields")] pub DynamicsState);

#[derive(Serialize, Deserialize)]
#[serde(remote = "DynamicsState")]
struct StateFields {
    step: i64,
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    contact: Vec<f64>,
}

/// A change that hardly shrinks is taken to shrink by this factor: slower decay than a hundredth a period is not waited for.
const MOST_SHRINK: f64 = 0.99;

/// Lengths of a run in steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Mean speed of the pinion (rad/s).
    pub speed: f64,
    /// Mesh cycle.
    pub cycle: usize,
    /// Period of the excitation.
    pub period: usize,
    /// Record.
    pub record: usize,
    /// Transient, where given; else until the motion repeats.
    pub transient: Option<usize>,
    /// Largest number of steps until the motion repeats.
    pub most: usize,
    /// How much of a transient is expected to be left after a period, until the run itself shows it.
    pub shrink: Option<f64>,
    /// Steps of the record before the first frame of a film.
    pub film: Option<usize>,
}

impl Plan {
    /// For a state whose teeth repeat after `period` mesh cycles of `cycle` steps; `shrink` is how much of a transient a mesh cycle leaves, where known.
    #[must_use]
    pub fn new(case: &DynamicsCase, speed: f64, cycle: usize, period: i64, shrink: Option<f64>) -> Self {
        let run = &case.inputs.run;
        let steps = |cycles: u32| cycle * cycles as usize;
        let film = case.inputs.output.film.map(|film| {
            let first = (film.mesh_cycle_from - run.mesh_cycle_from) * cycle as f64;
            (first.round() as usize).min(cycle * case.cycles - 1)
        });
        Self {
            speed,
            cycle,
            period: cycle * period.max(1) as usize,
            record: cycle * case.cycles,
            transient: run.transient_mesh_cycles.map(steps),
            most: steps(run.steady_limit_mesh_cycles),
            shrink: shrink.map(|shrink| shrink.powf(period.max(1) as f64)),
            film,
        }
    }

    /// What the engine is asked for.
    #[must_use]
    pub fn request(&self, case: &DynamicsCase, initial: InitialState, snapshots: Vec<i64>) -> DynamicsRequest {
        let lead = (self.transient.unwrap_or(0) + 1) as f64 / self.cycle as f64;
        DynamicsRequest {
            mesh_cycle: case.from - lead,
            motion: Motion::Running { speed: self.speed, steps_per_cycle: self.cycle },
            torque: case.torque,
            pulse: None,
            initial,
            snapshots,
        }
    }

    /// Steps to the next place where a run may stop or turns to something else.
    fn next_piece(&self, progress: &Progress, every: usize) -> usize {
        let done = progress.state.as_ref().map_or(0, |state| state.0.step as usize);
        let kept = progress.samples.len();
        let mut piece = match (progress.before_record, self.transient) {
            (Some(_), _) => self.record - kept,
            (None, Some(transient)) => transient - done,
            (None, None) => self.period - kept,
        };
        piece = piece.min(every - done % every);
        match self.film {
            Some(film) if film > kept => piece.min(film - kept),
            _ => piece,
        }
    }

    /// Steps of the run as far as they can be told.
    fn expected(&self, progress: &Progress) -> usize {
        let done = progress.state.as_ref().map_or(0, |state| state.0.step as usize);
        let kept = progress.samples.len();
        match (progress.before_record, self.transient) {
            (Some(_), _) => done + self.record - kept,
            (None, Some(transient)) => transient + self.record,
            (None, None) => done + self.period - kept + self.record.saturating_sub(self.period),
        }
    }
}

impl Progress {
    /// What is left of the transient after the last period, over the variation of the motion: changes that go on to shrink by the same factor sum to it.
    #[must_use]
    pub fn transient_left(&self, plan: &Plan) -> Option<f64> {
        let shrink = self.shrink.or(plan.shrink).unwrap_or(0.5).min(MOST_SHRINK);
        self.change.map(|change| change * shrink / (1.0 - shrink))
    }

    /// Turns to what comes next where a stretch of the run is complete.
    fn turn(&mut self, plan: &Plan, tolerance: f64) {
        let done = self.state.as_ref().map_or(0, |state| state.0.step as usize);
        if self.before_record.is_none() {
            match plan.transient {
                Some(transient) if done >= transient => {
                    self.before_record = Some(transient as i64);
                    self.samples.clear();
                }
                Some(_) => self.samples.clear(),
                None if self.samples.len() >= plan.period => {
                    let now: Vec<f64> = self.samples.iter().map(|sample| sample.transmission_error).collect();
                    let change = relative_change(&self.last_period, &now);
                    self.shrink = self.change.zip(change).map(|(before, now)| now / before.max(1e-300));
                    self.change = change;
                    let left = self.transient_left(plan);
                    if left.is_some_and(|left| left < tolerance) || done + plan.period > plan.most {
                        self.before_record = Some((done - plan.period) as i64);
                        self.samples.truncate(plan.record);
                    } else {
                        self.last_period = now;
                        self.samples.clear();
                    }
                }
                None => {}
            }
        }
        self.complete = self.before_record.is_some() && self.samples.len() >= plan.record;
        if self.complete {
            self.last_period = Vec::new();
        } else if plan.film == Some(self.samples.len()) {
            self.film_start = self.state.clone();
        }
    }
}

/// Root mean square of the change over that of the variation about the mean; `None` without a period before.
fn relative_change(before: &[f64], now: &[f64]) -> Option<f64> {
    if before.len() != now.len() {
        return None;
    }
    let mean = now.iter().sum::<f64>() / now.len() as f64;
    let change: f64 = before.iter().zip(now).map(|(a, b)| (b - a).powi(2)).sum();
    let variation: f64 = now.iter().map(|x| (x - mean).powi(2)).sum();
    Some((change / variation.max(1e-30)).sqrt())
}

/// Where a run begins that has no step yet.
#[must_use]
pub fn start(case: &DynamicsCase, plan: &Plan, healthy_end: Option<&SavedState>) -> InitialState {
    match healthy_end {
        Some(end) if plan.transient.is_none() => InitialState::Given(DynamicsState { step: 0, ..end.0.clone() }),
        _ => case.initial.clone(),
    }
}

/// Goes on with a run until its record is complete, or it is asked to stop. `save` is called at every checkpoint and at the end.
///
/// # Errors
/// Those of the engine and of saving.
pub fn simulate(
    dynamics: &PairDynamics<'_>,
    case: &DynamicsCase,
    plan: &Plan,
    start: InitialState,
    progress: &mut Progress,
    observer: &dyn Observer,
    save: &mut dyn FnMut(&Progress) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let every = case.inputs.checkpoint.every_steps as usize;
    let tolerance = case.inputs.run.steady_tolerance;
    let initial = progress.state.as_ref().map_or(start, |state| InitialState::Given(state.0.clone()));
    let mut runner = dynamics.start(&plan.request(case, initial, Vec::new()))?;
    let (energy, stats) = account(&progress.work);
    runner.take_up(energy, stats);
    if progress.state.is_none() {
        progress.state = Some(SavedState(runner.state().clone()));
        progress.turn(plan, tolerance);
    }
    while !progress.complete {
        let done = progress.state.as_ref().map_or(0, |state| state.0.step as usize);
        let steps = plan.next_piece(progress, every);
        let shifted = Shifted { inner: observer, done, expected: plan.expected(progress) };
        let run = runner.advance(steps, &shifted)?;
        progress.work = work(&run);
        progress.state = Some(SavedState(run.state));
        let stopped = run.records.len() < steps;
        progress.samples.extend(run.records.into_iter().map(sample));
        progress.turn(plan, tolerance);
        if stopped || progress.complete || (done + steps) % every == 0 {
            save(progress)?;
        }
        if stopped {
            break;
        }
    }
    Ok(())
}

/// Progress of a piece as part of its run.
struct Shifted<'a> {
    inner: &'a dyn Observer,
    done: usize,
    expected: usize,
}

impl Observer for Shifted<'_> {
    fn advanced(&self, done: usize, _: usize) {
        self.inner.advanced(self.done + done, self.expected);
    }

    fn is_cancelled(&self) -> bool {
        self.inner.is_cancelled()
    }
}

fn sample(record: StepRecord) -> Sample {
    Sample {
        transmission_error: record.transmission_error,
        mesh_force: record.mesh_force,
        back_force: record.back_force,
        pairs: record.pairs,
        coordinates: record.coordinates,
        support_forces: record.support_forces,
    }
}

/// Work of a run since its start.
fn work(run: &DynamicsRun) -> Work {
    let (stats, energy) = (&run.stats, &run.energy);
    Work {
        steps: stats.steps,
        contact_solves: stats.solver.solves,
        pivots: stats.solver.pivots,
        factorisations: stats.solver.factorisations,
        widened_steps: stats.widened,
        steps_with_coast_flanks: stats.watched_back,
        not_converged: stats.not_converged,
        worst_complementarity: stats.worst_complementarity,
        worst_kkt_violation: stats.worst_kkt,
        external_j: energy.external,
        contact_j: energy.contact,
        dissipated_j: energy.dissipated,
        stored_j: energy.stored,
        worst_defect_j: energy.worst_residual,
        energy_scale_j: energy.scale,
        time_s: stats.time.as_secs_f64(),
    }
}

/// The engine's energies and counters after some work, to go on from.
fn account(work: &Work) -> (EnergyBalance, RunStats) {
    let energy = EnergyBalance {
        external: work.external_j,
        contact: work.contact_j,
        dissipated: work.dissipated_j,
        stored: work.stored_j,
        worst_residual: work.worst_defect_j,
        scale: work.energy_scale_j,
    };
    let stats = RunStats {
        steps: work.steps,
        solver: SolveStats {
            solves: work.contact_solves,
            pivots: work.pivots,
            factorisations: work.factorisations,
            ..SolveStats::default()
        },
        worst_complementarity: work.worst_complementarity,
        worst_kkt: work.worst_kkt_violation,
        widened: work.widened_steps,
        watched_back: work.steps_with_coast_flanks,
        not_converged: work.not_converged,
        time: Duration::try_from_secs_f64(work.time_s).unwrap_or_default(),
    };
    (energy, stats)
}
