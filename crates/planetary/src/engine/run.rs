//! Motion in time.

use std::time::Instant;

use fecm::statics::Observer;

use super::band::{BandRecorder, BandWeights};
use super::dense::dot;
use super::march::{Begin, Course, Marched, Stepper};
use super::placed::{Place, Placed};
use super::request::{
    BearingRecord, BodyRecord, MeshRecord, RunRequest, SensorRecord, Start, TransmissionRun, TransmissionState,
    TransmissionStats, Turning,
};
use super::transmission::{Load, Transmission};
use crate::error::PlanetaryError;

/// A run under way.
#[derive(Debug)]
pub struct Runner<'a> {
    transmission: &'a Transmission,
    request: RunRequest,
    stepper: Stepper,
    /// Steps of one stage, for those whose meshes are not found otherwise.
    fallback: Option<Box<Stepper>>,
    /// s.
    time_step: f64,
    /// Of the carrier (rad/s).
    speed: f64,
    /// Steps of a mesh cycle; none where the transmission stands.
    steps_per_cycle: Option<i64>,
    state: TransmissionState,
    /// What the last step found.
    last: Marched,
    stats: TransmissionStats,
}

impl<'a> Runner<'a> {
    pub(super) fn new(transmission: &'a Transmission, request: &RunRequest) -> Result<Self, PlanetaryError> {
        let system = &transmission.system;
        let (speed, steps_per_cycle) = match request.turning {
            Turning::Steady { carrier_speed, steps_per_cycle } => (carrier_speed, Some(steps_per_cycle as i64)),
            Turning::Standing { .. } => (0.0, None),
        };
        let time_step = transmission.time_step(&request.turning);
        request.validate(time_step)?;
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
            stepper: Stepper::new(system, request.stages, time_step, speed, request.travelled)?,
            fallback: None,
            time_step,
            speed,
            steps_per_cycle,
            state,
            last: Marched::default(),
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
        self.time_step
    }

    /// Place within a step: the same numbers every turn of the carrier for the angle.
    fn place(&self, step: i64, part: f64) -> Place {
        let teeth = self.transmission.system.ring_teeth;
        let Some(steps) = self.steps_per_cycle else { return self.transmission.place(self.request.travelled) };
        let turn = steps * teeth as i64;
        let fraction = (step.rem_euclid(turn) as f64 + part) / turn as f64 + self.request.travelled / teeth;
        let within = (step.rem_euclid(steps) as f64 + part) / steps as f64;
        let travelled = self.request.travelled + step.div_euclid(steps) as f64 + within;
        Place { angle: 2.0 * std::f64::consts::PI * fraction, travelled }
    }

    fn course(&self, stepper: &Stepper) -> Course {
        let (step, stages) = (self.state.step, stepper.stages());
        let places: Vec<Place> =
            std::iter::once(&0.0).chain(&stages.nodes).map(|part| self.place(step, *part)).collect();
        let points = stages.points.iter().map(|part| self.place(step, *part).travelled);
        let external = places[1..].iter();
        let external = external.map(|place| self.transmission.external(*place, self.request.output_torque, self.speed));
        Course {
            travelled: points.chain([self.place(step + 1, 0.0).travelled]).collect(),
            external: external.collect(),
            places,
        }
    }

    fn advance(&mut self) -> Result<(), PlanetaryError> {
        let system = &self.transmission.system;
        let next = self.state.step + 1;
        let begin = Begin {
            position: &self.state.position,
            velocity: &self.state.velocity,
            connection: &self.state.connection,
        };
        let mut done = self.stepper.advance(system, &self.course(&self.stepper), &begin)?;
        let mut iterations = done.report.iterations;
        let is_fallback = !done.report.is_solved;
        if is_fallback && self.request.stages > 1 {
            let fallback = match self.fallback.take() {
                Some(fallback) => fallback,
                None => Box::new(Stepper::new(system, 1, self.time_step, self.speed, self.request.travelled)?),
            };
            let mean = fallback.advance(system, &self.course(&fallback), &begin)?;
            self.fallback = Some(fallback);
            iterations += mean.report.iterations;
            done = mean.spread(self.request.stages);
        }
        let lost = |what| Err(PlanetaryError::Lost { step: next, cycle: self.place(next, 0.0).travelled, what });
        if !done.report.is_solved {
            return lost("no forces of the meshes were found that fit their approaches");
        }
        if !done.velocity.iter().chain(&done.connection).all(|value| value.is_finite()) {
            return lost("numbers out of range");
        }
        if done.end_approaches.iter().copied().fold(0.0, f64::max) > system.base_pitch {
            return lost("teeth are pushed into each other by more than a base pitch: nothing is small any more");
        }
        self.stats.steps += 1;
        self.stats.newton_iterations += iterations;
        self.stats.fallbacks += usize::from(is_fallback);
        self.stats.worst_residual = self.stats.worst_residual.max(done.report.residual);
        self.state = TransmissionState {
            step: next,
            position: std::mem::take(&mut done.position),
            velocity: std::mem::take(&mut done.velocity),
            connection: done.connection.clone(),
        };
        self.last = done;
        Ok(())
    }

    /// Goes on without a record. Fewer steps where cancelled.
    ///
    /// # Errors
    /// Motion out of the range of numbers.
    pub fn settle(&mut self, steps: usize, observer: &dyn Observer) -> Result<(), PlanetaryError> {
        self.go(steps, observer, |_| {})
    }

    /// Goes on with a record: of every step, or of samples of the band, of which the first is [`super::Band::lead_steps`] from here. Fewer samples where cancelled.
    ///
    /// # Errors
    /// Motion out of the range of numbers.
    pub fn record(&mut self, samples: usize, observer: &dyn Observer) -> Result<TransmissionRun, PlanetaryError> {
        let system = &self.transmission.system;
        let springs = system.springs.len();
        let mut run = self.empty(samples);
        let weights = self.request.band.map(|band| BandWeights::new(&band, self.stepper.stages(), self.time_step));
        let (lead, every, steps) = match &weights {
            Some(weights) => (weights.half, weights.steps_per_sample, BandRecorder::steps_needed(weights, samples)),
            None => (0, 1, samples),
        };
        run.first_step = self.state.step + if weights.is_some() { lead as i64 } else { 1 };
        run.sample_time = every as f64 * self.time_step;
        let mut band = weights.map(|weights| BandRecorder::new(weights, samples));
        let mut touching: Vec<bool> =
            system.meshes.iter().map(|mesh| self.state.connection[springs + mesh.drive] > 0.0).collect();
        let mut done = 0;
        self.go(steps, observer, |runner| {
            done += 1;
            let counts = band.is_none() || (lead < done && done <= steps - lead);
            for ((record, mesh), touching) in run.meshes.iter_mut().zip(&system.meshes).zip(&mut touching) {
                let force = runner.state.connection[springs + mesh.drive];
                let coast_force = mesh.coast.map_or(0.0, |flank| runner.state.connection[springs + flank]);
                if counts {
                    record.losses += usize::from(*touching && force <= 0.0);
                    record.steps_apart += usize::from(force <= 0.0 && coast_force <= 0.0);
                }
                *touching = force > 0.0;
            }
            match &mut band {
                None => {
                    let values = runner.channels(
                        &run,
                        &runner.state.connection,
                        &runner.last.end_approaches,
                        &runner.state.position,
                        (1, 0),
                    );
                    let modal = runner.accelerations();
                    push(&mut run, &values);
                    push_sensors(&mut run, system, &modal);
                }
                Some(band) => {
                    let s = runner.request.stages;
                    let last = &runner.last;
                    let values: Vec<f64> = (0..s)
                        .flat_map(|i| runner.channels(&run, &last.forces, &last.approaches, &last.bodies, (s, i)))
                        .collect();
                    let channels = values.len() / s;
                    if let Some(sample) = band.take(&values, &last.rates) {
                        push(&mut run, &sample[..channels]);
                        push_sensors(&mut run, system, &sample[channels..]);
                    }
                }
            }
        })?;
        (run.state, run.stats) = (self.state.clone(), self.stats);
        Ok(run)
    }

    /// A record without samples.
    fn empty(&self, samples: usize) -> TransmissionRun {
        let system = &self.transmission.system;
        let room = || Vec::with_capacity(samples);
        let sensor = |name: &String| SensorRecord { name: name.clone(), acceleration: room() };
        let mesh = |name: &String| MeshRecord {
            name: name.clone(),
            force: room(),
            coast_force: room(),
            approach: room(),
            ..MeshRecord::default()
        };
        let moved = |&body| BodyRecord { body, motion: Default::default() };
        TransmissionRun {
            sample_time: self.time_step,
            first_step: self.state.step,
            sensors: system.sensors.iter().map(|(name, _)| sensor(name)).collect(),
            meshes: system.meshes.iter().map(|own| mesh(&own.name)).collect(),
            bearings: system
                .bearings
                .iter()
                .map(|bearing| BearingRecord { name: bearing.name.clone(), load: Default::default() })
                .collect(),
            bodies: if self.request.record_motion { system.ids.iter().map(moved).collect() } else { Vec::new() },
            state: self.state.clone(),
            stats: self.stats,
        }
    }

    /// What is recorded of meshes, bearings and bodies, in order; connections and flanks have `of` values each, of which this is number `i`.
    fn channels(
        &self,
        run: &TransmissionRun,
        forces: &[f64],
        approaches: &[f64],
        bodies: &[f64],
        (of, i): (usize, usize),
    ) -> Vec<f64> {
        let system = &self.transmission.system;
        let springs = system.springs.len();
        let force = |row: usize| forces[row * of + i];
        let mut values = Vec::new();
        for mesh in &system.meshes {
            values.push(force(springs + mesh.drive));
            values.push(mesh.coast.map_or(0.0, |flank| force(springs + flank)));
            values.push(approaches[mesh.drive * of + i]);
        }
        for bearing in &system.bearings {
            values.extend(bearing.rows.map(|row| row.map_or(0.0, force)));
        }
        if !run.bodies.is_empty() {
            let rigid = system.rigid();
            values.extend_from_slice(&bodies[i * rigid..(i + 1) * rigid]);
        }
        values
    }

    /// Accelerations of the housing's coordinates at the end of the last step.
    fn accelerations(&self) -> Vec<f64> {
        let (system, state) = (&self.transmission.system, &self.state);
        let (rigid, faces) = (system.rigid(), &system.interfaces);
        let mut reaction = vec![0.0; faces.count];
        Placed::new(system, self.place(state.step, 0.0)).react(
            &state.connection,
            &mut vec![0.0; rigid],
            &mut reaction,
            faces.seat,
        );
        let mut acceleration = vec![0.0; faces.modes];
        for (k, force) in reaction.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            super::dense::axpy(&mut acceleration, *force, faces.row(k));
        }
        for (k, (w, zeta)) in system.frequencies.iter().zip(&system.damping_ratios).enumerate() {
            acceleration[k] -= w * (2.0 * zeta * state.velocity[rigid + k] + w * state.position[rigid + k]);
        }
        acceleration
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

/// A sample of [`Runner::channels`].
fn push(run: &mut TransmissionRun, values: &[f64]) {
    let meshes = run.meshes.iter_mut().flat_map(|mesh| [&mut mesh.force, &mut mesh.coast_force, &mut mesh.approach]);
    let bearings = run.bearings.iter_mut().flat_map(|bearing| &mut bearing.load);
    let bodies = run.bodies.iter_mut().flat_map(|body| &mut body.motion);
    meshes.chain(bearings).chain(bodies).zip(values).for_each(|(series, value)| series.push(*value));
}

fn push_sensors(run: &mut TransmissionRun, system: &super::system::System, modal: &[f64]) {
    for (record, (_, shape)) in run.sensors.iter_mut().zip(&system.sensors) {
        record.acceleration.push(dot(shape, modal));
    }
}
