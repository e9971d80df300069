//! Motion in time.

use std::time::Instant;

use fecm::dynamics::Weights;
use fecm::statics::Observer;

use super::dense::dot;
use super::request::{
    BearingRecord, BodyRecord, MeshRecord, RunRequest, SensorRecord, Start, TransmissionRun, TransmissionState,
    TransmissionStats, Turning,
};
use super::rows::RIGID;
use super::step::{History, Operator, Place, step};
use super::transmission::{Load, Transmission};
use crate::error::PlanetaryError;

/// A run under way.
#[derive(Debug)]
pub struct Runner<'a> {
    transmission: &'a Transmission,
    request: RunRequest,
    weights: Weights,
    operator: Operator,
    /// Of the carrier (rad/s).
    speed: f64,
    /// Steps of a mesh cycle; none where the transmission stands.
    steps_per_cycle: Option<i64>,
    state: TransmissionState,
    /// Approaches at the end of the last step.
    approaches: Vec<f64>,
    stats: TransmissionStats,
}

impl<'a> Runner<'a> {
    pub(super) fn new(transmission: &'a Transmission, request: &RunRequest) -> Result<Self, PlanetaryError> {
        request.validate()?;
        let system = &transmission.system;
        let (speed, steps_per_cycle, time_step) = match request.turning {
            Turning::Steady { carrier_speed, steps_per_cycle } => {
                let pitch = 2.0 * std::f64::consts::PI / system.ring_teeth;
                (carrier_speed, Some(steps_per_cycle as i64), pitch / carrier_speed / steps_per_cycle as f64)
            }
            Turning::Standing { time_step } => (0.0, None, time_step),
        };
        let weights = request.integrator.weights(time_step);
        let state = match &request.start {
            Start::Given(state) => {
                state.check(system.size(), system.rows.len())?;
                state.as_ref().clone()
            }
            Start::Equilibrium => {
                let (travelled, output_torque) = (request.travelled, request.output_torque);
                transmission.equilibrium(&Load { travelled, output_torque, carrier_speed: speed })?.state
            }
        };
        Ok(Self {
            transmission,
            request: request.clone(),
            weights,
            operator: Operator::moving(system, &weights, speed),
            speed,
            steps_per_cycle,
            state,
            approaches: vec![0.0; system.flanks.len()],
            stats: TransmissionStats::default(),
        })
    }

    /// Where the run stands: what [`Start::Given`] takes to go on from here, to the bit.
    #[must_use]
    pub fn state(&self) -> &TransmissionState {
        &self.state
    }

    /// Length of a step (s).
    #[must_use]
    pub fn time_step(&self) -> f64 {
        self.weights.step
    }

    /// Place of a step: the same numbers every turn of the carrier for the angle.
    fn place(&self, step: i64) -> Place {
        let teeth = self.transmission.system.ring_teeth;
        let Some(steps) = self.steps_per_cycle else { return self.transmission.place(self.request.travelled) };
        let turn = steps * teeth as i64;
        let fraction = step.rem_euclid(turn) as f64 / turn as f64 + self.request.travelled / teeth;
        let travelled =
            self.request.travelled + step.div_euclid(steps) as f64 + step.rem_euclid(steps) as f64 / steps as f64;
        Place { angle: 2.0 * std::f64::consts::PI * fraction, travelled }
    }

    fn advance(&mut self) -> Result<(), PlanetaryError> {
        let (system, weights, state) = (&self.transmission.system, &self.weights, &self.state);
        let next = state.step + 1;
        let place = self.place(next);
        let rigid = system.rigid();
        let size = system.size();
        let external = self.transmission.external(place, self.request.output_torque, self.speed);
        let (q, v, a) = (&state.position, &state.velocity, &state.acceleration);
        let start = weights.start();
        let mut load: Vec<f64> = state.force.iter().map(|force| start * force).collect();
        load.iter_mut().zip(&external).for_each(|(load, force)| *load += force);
        let mut lag = vec![0.0; size];
        for (index, body) in system.inertia.iter().enumerate() {
            let first = RIGID * index;
            let mass: [f64; RIGID] =
                std::array::from_fn(|k| weights.mass_history(q[first + k], v[first + k], a[first + k]));
            let rate: [f64; RIGID] =
                std::array::from_fn(|k| weights.damping_history(q[first + k], v[first + k], a[first + k]));
            let (inertia, gyroscopic) = (body.times(mass), body.gyroscopic_times(rate));
            for k in 0..RIGID {
                load[first + k] += inertia[k] + self.speed * gyroscopic[k];
                lag[first + k] = rate[k] + start * v[first + k];
            }
        }
        for (k, (w, zeta)) in system.frequencies.iter().zip(&system.damping_ratios).enumerate() {
            let i = rigid + k;
            let rate = weights.damping_history(q[i], v[i], a[i]);
            load[i] += weights.mass_history(q[i], v[i], a[i]) + 2.0 * zeta * w * rate - start * w * w * q[i];
            lag[i] = rate + start * v[i];
        }
        let h = weights.step;
        let expected: Vec<f64> = (0..size).map(|i| q[i] + h * (v[i] + 0.5 * h * a[i])).collect();
        let history =
            History { load: &load, velocity: &lag, expected: &expected, speed: self.speed, forces: &state.connection };
        let done = step(system, &self.operator, place, &history)?;
        if !done.report.is_solved {
            let what = "no forces of the meshes were found that fit their approaches";
            return Err(PlanetaryError::Lost { step: next, cycle: place.travelled, what });
        }
        let (mut velocity, mut acceleration) = (Vec::with_capacity(size), Vec::with_capacity(size));
        for i in 0..size {
            let (rate, change) = weights.end([q[i], done.position[i]], v[i], a[i]);
            velocity.push(rate);
            acceleration.push(change);
        }
        if !acceleration.iter().chain(&done.forces).all(|value| value.is_finite()) {
            let what = "numbers out of range";
            return Err(PlanetaryError::Lost { step: next, cycle: place.travelled, what });
        }
        let pressed = done.approaches.iter().zip(&system.flanks).map(|(approach, flank)| approach - flank.backlash);
        if pressed.fold(0.0, f64::max) > system.base_pitch {
            let what = "teeth are pushed into each other by more than a base pitch: nothing is small any more";
            return Err(PlanetaryError::Lost { step: next, cycle: place.travelled, what });
        }
        let mut force = done.generalised;
        force.iter_mut().zip(&external).for_each(|(force, external)| *force += external);
        self.stats.steps += 1;
        self.stats.newton_iterations += done.report.iterations;
        self.stats.fallbacks += usize::from(done.report.searched);
        self.stats.worst_residual = self.stats.worst_residual.max(done.report.residual);
        self.approaches = done.approaches;
        self.state = TransmissionState {
            step: next,
            position: done.position,
            velocity,
            acceleration,
            connection: done.forces,
            force,
        };
        Ok(())
    }

    /// Goes on without a record. Fewer steps where cancelled.
    ///
    /// # Errors
    /// Motion out of the range of numbers.
    pub fn settle(&mut self, steps: usize, observer: &dyn Observer) -> Result<(), PlanetaryError> {
        self.go(steps, observer, |_| {})
    }

    /// Goes on with a record. Fewer steps where cancelled.
    ///
    /// # Errors
    /// Motion out of the range of numbers.
    pub fn record(&mut self, steps: usize, observer: &dyn Observer) -> Result<TransmissionRun, PlanetaryError> {
        let system = &self.transmission.system;
        let first_step = self.state.step + 1;
        let room = || Vec::with_capacity(steps);
        let mut sensors: Vec<SensorRecord> =
            system.sensors.iter().map(|(name, _)| SensorRecord { name: name.clone(), acceleration: room() }).collect();
        let mut meshes: Vec<MeshRecord> =
            system.meshes.iter().map(|mesh| MeshRecord { name: mesh.name.clone(), ..MeshRecord::default() }).collect();
        let mut bearings: Vec<BearingRecord> = system
            .bearings
            .iter()
            .map(|bearing| BearingRecord { name: bearing.name.clone(), load: Default::default() })
            .collect();
        let mut bodies: Vec<BodyRecord> = Vec::new();
        if self.request.record_motion {
            bodies.extend(system.ids.iter().map(|&body| BodyRecord { body, motion: Default::default() }));
        }
        let (rigid, springs) = (system.rigid(), system.springs.len());
        let mut touching: Vec<bool> =
            system.meshes.iter().map(|mesh| self.state.connection[springs + mesh.drive] > 0.0).collect();
        self.go(steps, observer, |runner| {
            let state = &runner.state;
            for (record, (_, shape)) in sensors.iter_mut().zip(&system.sensors) {
                record.acceleration.push(dot(shape, &state.acceleration[rigid..]));
            }
            for ((record, mesh), touching) in meshes.iter_mut().zip(&system.meshes).zip(&mut touching) {
                let force = state.connection[springs + mesh.drive];
                let coast_force = mesh.coast.map_or(0.0, |flank| state.connection[springs + flank]);
                record.losses += usize::from(*touching && force <= 0.0);
                *touching = force > 0.0;
                record.steps_apart += usize::from(force <= 0.0 && coast_force <= 0.0);
                record.force.push(force);
                record.coast_force.push(coast_force);
                record.approach.push(runner.approaches[mesh.drive]);
            }
            for (record, bearing) in bearings.iter_mut().zip(&system.bearings) {
                for (load, row) in record.load.iter_mut().zip(bearing.rows) {
                    load.push(row.map_or(0.0, |row| state.connection[row]));
                }
            }
            for (index, record) in bodies.iter_mut().enumerate() {
                for (k, motion) in record.motion.iter_mut().enumerate() {
                    motion.push(state.position[RIGID * index + k]);
                }
            }
        })?;
        let time_step = self.weights.step;
        let (state, stats) = (self.state.clone(), self.stats);
        Ok(TransmissionRun { time_step, first_step, sensors, meshes, bearings, bodies, state, stats })
    }

    fn go(
        &mut self,
        steps: usize,
        observer: &dyn Observer,
        mut after: impl FnMut(&Self),
    ) -> Result<(), PlanetaryError> {
        let started = Instant::now();
        for done in 1..=steps {
            if observer.is_cancelled() {
                break;
            }
            self.advance()?;
            after(self);
            observer.advanced(done, steps);
        }
        self.stats.time += started.elapsed();
        Ok(())
    }
}
