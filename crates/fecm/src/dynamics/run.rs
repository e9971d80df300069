//! Steps in time.

use std::sync::Arc;
use std::time::Instant;

use super::flank::PairModes;
use super::integrator::Weights;
use super::operator::{Flanks, Operator};
use super::options::{DynamicsOptions, DynamicsRequest, DynamicsState, InitialState, Motion, StepSolver};
use super::result::{DynamicsRun, EnergyBalance, RunStats, Snapshot, StepRecord};
use super::schedule::{LEVELS, Place, Schedule, ScheduleSpec, mirrored};
use super::system::{BodyTerms, Generalised, ROTATION, StepMatrix, System};
use crate::error::FecmError;
use crate::lcp::{FactorMemory, HeldBlock, HeldProblem, HeldSolution, solve_held, solve_held_by_lemke};
use crate::statics::{Observer, PairModel};

/// A gear pair made ready to run: options checked, bodies assembled.
pub struct PairDynamics<'a> {
    pub(super) model: &'a PairModel,
    /// What coast flanks see; the model itself where nothing is damaged.
    healthy: Option<PairModel>,
    options: DynamicsOptions,
    modes: PairModes,
    pub(super) system: System,
}

/// Steps whose operators are made ahead, in parallel.
const AHEAD: i64 = 50;
/// Width of the grids for the energy in the contact: six times the static load.
const ENERGY_LEVEL: u32 = 2;
/// Deflection at which a run is given up, in base pitches.
const MOST_DEFLECTION: f64 = 0.25;

impl<'a> PairDynamics<'a> {
    /// Prepares a pair.
    ///
    /// # Errors
    /// Options out of range; hubs lighter than the elastic bodies on them.
    pub fn new(model: &'a PairModel, options: &DynamicsOptions) -> Result<Self, FecmError> {
        options.validate()?;
        let modes = PairModes::new(model, options.rotors.each_ref().map(|rotor| rotor.modes))?;
        let bodies = [0, 1].map(|index: usize| {
            let (rotor, own) = (&options.rotors[index], &modes.of(index).modes);
            BodyTerms {
                mass: rotor.masses(),
                supports: rotor.supports,
                frequencies: own.iter().map(|mode| mode.angular_frequency).collect(),
                participation: own.iter().map(|mode| mode.rigid_coupling).collect(),
            }
        });
        let system = System::new(&bodies, options.damping)?;
        let damaged = model.options().damage.iter().any(|damage| !damage.is_empty());
        let healthy = if damaged { Some(model.with_damage(&[Vec::new(), Vec::new()])?) } else { None };
        Ok(Self { model, healthy, options: options.clone(), modes, system })
    }

    /// Runs `steps` steps from the start.
    ///
    /// # Errors
    /// Requests out of range, positions without static equilibrium, gears that leave each other.
    pub fn run(
        &self,
        request: &DynamicsRequest,
        steps: usize,
        observer: &dyn Observer,
    ) -> Result<DynamicsRun, FecmError> {
        self.start(request)?.advance(steps, observer)
    }

    /// Makes ready to run, piece by piece.
    ///
    /// # Errors
    /// Requests out of range, no static equilibrium at the start.
    pub fn start(&self, request: &DynamicsRequest) -> Result<Runner<'_>, FecmError> {
        request.validate()?;
        let pitch = 2.0 * std::f64::consts::PI / f64::from(self.model.bodies()[0].teeth());
        let weights = self.options.integrator.weights(request.time_step(pitch));
        let matrix = Arc::new(self.system.step_matrix(&weights));
        let schedule = Schedule::new(ScheduleSpec {
            model: self.model,
            healthy: self.healthy.as_ref().unwrap_or(self.model),
            torque: request.torque,
            start: request.mesh_cycle,
            steps: match request.motion {
                Motion::Running { steps_per_cycle, .. } => steps_per_cycle,
                Motion::Standing { .. } => 1,
            },
            system: &self.system,
            step: Arc::clone(&matrix),
            modes: &self.modes,
            most_bytes: self.options.operator_memory,
        });
        let pair = self.model.pairing();
        let mut stepper = Stepper {
            system: &self.system,
            modes: &self.modes,
            weights,
            matrix,
            schedule,
            solver: self.options.solver,
            request: request.clone(),
            standing: matches!(request.motion, Motion::Standing { .. }),
            radii: [0, 1].map(|index| pair.base_radius(index)),
            rotation_rows: [0, 1].map(|body| self.system.row(body, ROTATION)),
            closing: pair.pair().closing_direction(),
            most: MOST_DEFLECTION * pair.pair().base_pitch(),
            stats: RunStats::default(),
        };
        let state = stepper.initial()?;
        Ok(Runner { stepper, state, energy: EnergyBalance::default(), prepared: None })
    }

    /// Natural frequencies of the elastic modes kept of the pinion (0) or wheel (1), hub held (Hz).
    #[must_use]
    pub fn mode_frequencies(&self, body: usize) -> Vec<f64> {
        self.modes.of(body).modes.iter().map(|mode| mode.angular_frequency / (2.0 * std::f64::consts::PI)).collect()
    }

    /// Mesh cycles after which the teeth in mesh repeat, for pairs that differ from others: 1 for a healthy pair.
    #[must_use]
    pub fn period(&self) -> i64 {
        super::schedule::period(self.model)
    }
}

/// A run under way.
pub struct Runner<'a> {
    stepper: Stepper<'a>,
    state: DynamicsState,
    energy: EnergyBalance,
    /// Step up to which operators were made ahead.
    prepared: Option<i64>,
}

impl Runner<'_> {
    /// Takes up energies and counters of an earlier run that [`InitialState::Given`] goes on from: the totals are then those of one run in one
    /// piece, to the bit.
    pub fn take_up(&mut self, energy: EnergyBalance, stats: RunStats) {
        self.energy = energy;
        self.stepper.stats = stats;
    }

    /// Where the run stands: what [`InitialState::Given`] takes to go on from here.
    #[must_use]
    pub fn state(&self) -> &DynamicsState {
        &self.state
    }

    /// Transmission error where the run stands (m).
    #[must_use]
    pub fn transmission_error(&self) -> f64 {
        self.stepper.transmission_error(&self.state.position)
    }

    /// Kinetic and elastic energy of bodies, supports, modes and contact where the run stands (J).
    ///
    /// # Errors
    /// Positions without static equilibrium.
    pub fn stored_energy(&mut self) -> Result<f64, FecmError> {
        self.stepper.whole_energy(&self.state)
    }

    /// The next steps; energies and counters go on from the start of the run. Fewer steps where cancelled.
    ///
    /// # Errors
    /// Positions without static equilibrium, gears that leave each other.
    pub fn advance(&mut self, steps: usize, observer: &dyn Observer) -> Result<DynamicsRun, FecmError> {
        let started = Instant::now();
        let mut records = Vec::with_capacity(steps);
        let mut snapshots = Vec::new();
        for done in 0..steps {
            if observer.is_cancelled() {
                break;
            }
            let next = self.state.step + 1;
            if self.prepared.is_none_or(|prepared| next >= prepared) {
                let end = next + AHEAD.min((steps - done) as i64);
                self.stepper.schedule.prepare(if self.stepper.standing { 0..1 } else { next..end })?;
                self.prepared = Some(end);
            }
            let keep = self.stepper.request.snapshots.contains(&next);
            let (next, record, snapshot) = self.stepper.advance(&self.state, keep)?;
            self.stepper.account(&mut self.energy, &self.state, &next);
            records.push(record);
            snapshots.extend(snapshot);
            self.state = next;
            observer.advanced(done + 1, steps);
        }
        self.stepper.stats.steps += records.len();
        self.stepper.stats.time += started.elapsed();
        Ok(DynamicsRun {
            time_step: self.stepper.weights.step,
            records,
            coordinates: self.stepper.system.coordinates.clone(),
            snapshots,
            state: self.state.clone(),
            energy: self.energy,
            stats: self.stepper.stats,
        })
    }

    /// Goes on period by period until the transmission error repeats: the root mean square of its change from period to period falls below
    /// `tolerance` times that of its own variation. Returns the last period, and the change reached.
    ///
    /// # Errors
    /// As [`Self::advance`]; a period of no steps.
    pub fn settle(&mut self, spec: &SteadySpec, observer: &dyn Observer) -> Result<(DynamicsRun, f64), FecmError> {
        if spec.period == 0 || spec.most_periods < 2 {
            let allowed = "a period of at least one step, and two periods";
            return Err(FecmError::Option { name: "steps of a period", value: spec.period as f64, allowed });
        }
        let mut last = self.advance(spec.period, observer)?;
        let mut change = f64::INFINITY;
        for done in 1..spec.most_periods {
            let next = self.advance(spec.period, observer)?;
            let (before, now) = (last.transmission_errors(), next.transmission_errors());
            last = next;
            if now.len() < spec.period {
                break;
            }
            let mean = now.iter().sum::<f64>() / now.len() as f64;
            let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
            let difference = square(&mut before.iter().zip(&now).map(|(a, b)| b - a));
            let variation = square(&mut now.iter().map(|x| x - mean)).max(1e-30);
            change = (difference / variation).sqrt();
            observer.advanced(done, spec.most_periods);
            if change < spec.tolerance {
                break;
            }
        }
        Ok((last, change))
    }
}

/// When a run counts as steady.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadySpec {
    /// Steps after which it should repeat.
    pub period: usize,
    /// Relative change from period to period.
    pub tolerance: f64,
    /// Periods to give up after.
    pub most_periods: usize,
}

/// What one step uses.
struct Stepper<'a> {
    system: &'a System,
    modes: &'a PairModes,
    weights: Weights,
    matrix: Arc<StepMatrix>,
    schedule: Schedule<'a>,
    solver: StepSolver,
    request: DynamicsRequest,
    standing: bool,
    radii: [f64; 2],
    rotation_rows: [Option<usize>; 2],
    closing: f64,
    most: f64,
    stats: RunStats,
}

/// Contact of one step.
struct Contact {
    rigid: Vec<f64>,
    drive: Vec<f64>,
    back: f64,
    /// Generalised contact forces.
    generalised: Vec<f64>,
    place: Place,
}

impl Stepper<'_> {
    /// Torques on the rotations at a time: the load closes the mesh, and a pinion that is free to turn is driven against its mean.
    fn external(&self, time: f64) -> Generalised {
        let mut force = vec![0.0; self.system.size()];
        let pulse = self.request.pulse.map_or(0.0, |pulse| pulse.at(time));
        if let Some(row) = self.rotation_rows[1] {
            force[row] = self.closing * (self.request.torque + pulse);
        }
        if let Some(row) = self.rotation_rows[0] {
            force[row] = self.request.torque * self.radii[0] / self.radii[1];
        }
        force
    }

    /// Closing rotation of the wheel (rad).
    fn closing_rotation(&self, q: &[f64]) -> f64 {
        self.rotation_rows[1].map_or(0.0, |row| self.closing * q[row])
    }

    fn transmission_error(&self, q: &[f64]) -> f64 {
        let lead = self.rotation_rows[0].map_or(0.0, |row| q[row]);
        self.radii[1] * self.closing_rotation(q) + self.radii[0] * lead
    }

    fn operator_step(&self, step: i64) -> i64 {
        if self.standing { 0 } else { step }
    }

    fn initial(&mut self) -> Result<DynamicsState, FecmError> {
        let size = self.system.size();
        let (rotation, forces) = match &self.request.initial {
            InitialState::Given(state) => {
                let lengths = [&state.position, &state.velocity, &state.acceleration, &state.contact];
                return match lengths.iter().find(|v| v.len() != size || v.iter().any(|x| !x.is_finite())) {
                    None => Ok(state.clone()),
                    Some(bad) => {
                        let allowed = "as many finite numbers as the pair has coordinates and modes";
                        Err(FecmError::Option { name: "state given to start from", value: bad.len() as f64, allowed })
                    }
                };
            }
            initial => {
                let place = self.schedule.place(0, 0, false);
                let operator = self.schedule.operator(&place)?;
                match initial {
                    InitialState::Unloaded => (operator.no_load, vec![0.0; size]),
                    _ => {
                        let (rotation, own) = (operator.rotation, operator.generalised(&operator.static_forces));
                        (rotation, self.on_bodies(own, &place))
                    }
                }
            }
        };
        let rigid = self.system.rigid_count();
        let mut position = vec![0.0; size];
        for (k, w) in self.system.frequencies().iter().enumerate() {
            position[rigid + k] = forces[rigid + k] / (w * w);
        }
        // bearings give way under the contact force; the wheel follows so that the mesh stays as loaded as it was
        let mut work = 0.0;
        for i in 0..rigid {
            let stiffness = self.system.support_stiffness(i);
            if stiffness > 0.0 && !self.rotation_rows.contains(&Some(i)) {
                position[i] = forces[i] / stiffness;
                work += forces[i] * position[i];
            }
        }
        if let Some(row) = self.rotation_rows[1] {
            position[row] = self.closing * rotation;
            if forces[row] != 0.0 {
                position[row] -= work / forces[row];
            }
        }
        let velocity = vec![0.0; size];
        let mut push = self.external(0.0);
        let spring = self.system.times_stiffness(&position);
        for ((push, contact), spring) in push.iter_mut().zip(&forces).zip(&spring) {
            *push += contact - spring;
        }
        let acceleration = self.system.acceleration(&push)?;
        Ok(DynamicsState { step: 0, position, velocity, acceleration, contact: forces })
    }

    /// One step.
    fn advance(
        &mut self,
        from: &DynamicsState,
        keep: bool,
    ) -> Result<(DynamicsState, StepRecord, Option<Snapshot>), FecmError> {
        let step = from.step + 1;
        let step_length = self.weights.step;
        let time = |step: i64| step as f64 * step_length;
        let start = self.weights.start();
        let mut force = self.external(time(step));
        let before = self.external(time(from.step));
        for (i, force) in force.iter_mut().enumerate() {
            *force += start * (before[i] + from.contact[i]);
        }
        let right = self.system.history(&self.weights, &from.position, &from.velocity, &from.acceleration, &force);
        let contact = self.contact(step, &right)?;
        let rigid = self.system.rigid_count();
        let mut position = contact.rigid.clone();
        for (k, a) in self.matrix.modal.iter().enumerate() {
            let coupled: f64 = (0..rigid).map(|i| self.matrix.coupling[(i, k)] * contact.rigid[i]).sum();
            position.push((right[rigid + k] - coupled + contact.generalised[rigid + k]) / a);
        }
        let (mut velocity, mut acceleration) = (Vec::with_capacity(position.len()), Vec::with_capacity(position.len()));
        for (i, &q) in position.iter().enumerate() {
            let (v, a) = self.weights.end([from.position[i], q], from.velocity[i], from.acceleration[i]);
            velocity.push(v);
            acceleration.push(a);
        }
        let mesh_cycle = self.schedule.mesh_cycle(self.operator_step(step));
        let transmission_error = self.transmission_error(&position);
        if !(transmission_error.abs() < self.most) {
            return Err(FecmError::Separated { mesh_cycle, time: time(step), transmission_error, allowed: self.most });
        }
        let operator = self.schedule.operator(&contact.place)?;
        let record = StepRecord {
            step,
            time: time(step),
            mesh_cycle,
            transmission_error,
            mesh_force: contact.drive.iter().sum(),
            back_force: contact.back,
            pairs: operator.pair_forces(&contact.drive, contact.place.shift).filter(|(_, f)| *f > 0.0).collect(),
            support_forces: self.system.support_forces(&position, &velocity),
            coordinates: contact.rigid,
        };
        let snapshot =
            keep.then(|| Snapshot { step, mesh_cycle, patches: operator.patches(&contact.drive, contact.place.shift) });
        let state = DynamicsState { step, position, velocity, acceleration, contact: contact.generalised };
        Ok((state, record, snapshot))
    }

    /// Solves the contact at the end of a step, on grids as wide as it needs.
    fn contact(&mut self, step: i64, right: &[f64]) -> Result<Contact, FecmError> {
        let rigid = self.system.rigid_count();
        let free: Vec<f64> = self.matrix.modal.iter().zip(&right[rigid..]).map(|(a, b)| b / a).collect();
        let load: Vec<f64> = (0..rigid)
            .map(|i| right[i] - free.iter().enumerate().map(|(k, m)| self.matrix.coupling[(i, k)] * m).sum::<f64>())
            .collect();
        let at = self.operator_step(step);
        let mut watch_back = false;
        let mut level = 0;
        loop {
            let place = self.schedule.place(at, level, false);
            let back_place = self.schedule.place(at, 0, true);
            let modal = self.at_operator(&free, &place);
            // operators are taken out of the schedule one at a time: their memories travel with them
            let mut blocks = vec![self.schedule.take(&place)?];
            if watch_back {
                blocks.push(self.schedule.take(&back_place)?);
            }
            let solved = solve_blocks(self.solver, &mut blocks, &modal, &self.matrix, &load);
            let outcome = solved.map(|solution| {
                let drive = &solution.forces[0];
                let closing = self.closing_rotation(&solution.coordinates);
                let wide = blocks[0].is_crowded(drive) || closing > blocks[0].most;
                let mut generalised = self.on_bodies(blocks[0].generalised(drive), &place);
                let mut back = 0.0;
                if let (Some(operator), Some(forces)) = (blocks.get(1), solution.forces.get(1)) {
                    back = forces.iter().sum();
                    for (sum, force) in generalised.iter_mut().zip(operator.generalised(forces)) {
                        *sum += force;
                    }
                }
                (solution, wide, generalised, back)
            });
            let mut blocks = blocks.into_iter();
            for place in [&place, &back_place] {
                if let Some(operator) = blocks.next() {
                    self.schedule.put_back(place, operator);
                }
            }
            let (mut solution, wide, generalised, back) = outcome?;
            if wide && level + 1 < LEVELS {
                level += 1;
                continue;
            }
            if !watch_back && self.may_touch_back(at, &solution.coordinates) {
                watch_back = true;
                continue;
            }
            let stats = &mut self.stats;
            stats.solver = stats.solver.followed_by(&solution.stats);
            stats.worst_complementarity = stats.worst_complementarity.max(solution.stats.complementarity);
            stats.worst_kkt = stats.worst_kkt.max(solution.stats.kkt_violation);
            stats.widened += usize::from(level > 0);
            stats.watched_back += usize::from(watch_back);
            stats.not_converged += usize::from(!solution.converged);
            let drive = std::mem::take(&mut solution.forces[0]);
            return Ok(Contact { rigid: solution.coordinates, drive, back, generalised, place });
        }
    }

    /// Whether the coast flanks are near enough to touch.
    fn may_touch_back(&self, step: i64, q: &[f64]) -> bool {
        let (_, flanks) = mirrored(self.schedule.pairing(), self.schedule.mesh_cycle(step));
        let Flanks::Coast { offset } = flanks else { return false };
        let lead = self.rotation_rows[0].map_or(0.0, |row| q[row]) * self.radii[0] / self.radii[1];
        let translations = self.system.coordinates.iter().zip(q).filter(|((_, axis), _)| *axis < 2);
        let moved: f64 = translations.map(|(_, q)| q.abs()).sum::<f64>() / self.radii[1];
        offset - self.closing_rotation(q) - lead + moved > -0.02 * offset.abs()
    }

    /// Kinetic and elastic energy of bodies and modes (J).
    fn body_energy(&self, state: &DynamicsState) -> f64 {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        0.5 * dot(&state.velocity, &self.system.times_mass(&state.velocity))
            + 0.5 * dot(&state.position, &self.system.times_stiffness(&state.position))
    }

    /// The same with the energy in the contact: cell forces are those that the positions imply.
    fn whole_energy(&mut self, state: &DynamicsState) -> Result<f64, FecmError> {
        let (rigid, bodies) = (self.system.rigid_count(), self.body_energy(state));
        let place = self.schedule.place(self.operator_step(state.step), ENERGY_LEVEL, false);
        let (q, eta) = state.position.split_at(rigid);
        let eta = self.at_operator(eta, &place);
        let operator = self.schedule.operator(&place)?;
        Ok(bodies + operator.energy_at(q, &eta, &self.matrix.modal, self.system)?)
    }

    /// Modal coordinates as an operator made at other teeth sees them.
    fn at_operator(&self, modal: &[f64], place: &Place) -> Vec<f64> {
        self.modes.seen_from(place.shift, self.schedule.pairing().tooth_steps(), modal)
    }

    /// Generalised forces from an operator on the bodies: modal ones turned back to the teeth that carry them.
    fn on_bodies(&self, generalised: Vec<f64>, place: &Place) -> Vec<f64> {
        let (rigid, modal) = generalised.split_at(self.system.rigid_count());
        [rigid, &self.modes.seen_from(-place.shift, self.schedule.pairing().tooth_steps(), modal)].concat()
    }

    /// Adds a step to the energies. With average acceleration the balance closes to rounding.
    fn account(&self, energy: &mut EnergyBalance, from: &DynamicsState, to: &DynamicsState) {
        let time = |step: i64| step as f64 * self.weights.step;
        let moved: Vec<f64> = to.position.iter().zip(&from.position).map(|(b, a)| b - a).collect();
        let work = |a: &[f64], b: &[f64]| -> f64 { (0..moved.len()).map(|i| 0.5 * moved[i] * (a[i] + b[i])).sum() };
        energy.external += work(&self.external(time(from.step)), &self.external(time(to.step)));
        energy.contact += work(&from.contact, &to.contact);
        energy.dissipated += work(&self.system.times_damping(&from.velocity), &self.system.times_damping(&to.velocity));
        let (before, after) = (self.body_energy(from), self.body_energy(to));
        energy.stored += after - before;
        let residual = energy.stored - (energy.external + energy.contact - energy.dissipated);
        energy.worst_residual = energy.worst_residual.max(residual.abs());
        energy.scale = energy.scale.max(after).max(energy.external.abs());
    }
}

/// Solves one step's problem over its meshes. Modes move the drive flanks' gaps by what they have of their own history.
fn solve_blocks(
    solver: StepSolver,
    blocks: &mut [Operator],
    modal: &[f64],
    matrix: &StepMatrix,
    load: &[f64],
) -> Result<HeldSolution, FecmError> {
    let gaps: Vec<Vec<f64>> = blocks
        .iter()
        .map(|operator| {
            let mut gap = operator.gap.clone();
            for (k, m) in modal.iter().enumerate() {
                for (gap, phi) in gap.iter_mut().zip(operator.modes.col_as_slice(k)) {
                    *gap += phi * m;
                }
            }
            gap
        })
        .collect();
    let mut memories: Vec<FactorMemory> = blocks.iter_mut().map(|block| std::mem::take(&mut block.memory)).collect();
    let problem = HeldProblem {
        blocks: blocks
            .iter()
            .zip(&gaps)
            .map(|(operator, gap)| HeldBlock {
                compliance: operator.compliance.as_ref(),
                motion: operator.step_motion.as_ref(),
                gap,
            })
            .collect(),
        stiffness: matrix.rigid.as_ref(),
        load,
    };
    let solution = match solver {
        StepSolver::Newton => solve_held(&problem, &mut memories),
        StepSolver::Lemke => solve_held_by_lemke(&problem, &mut memories),
    };
    for (block, memory) in blocks.iter_mut().zip(memories) {
        block.memory = memory;
    }
    Ok(solution?)
}
