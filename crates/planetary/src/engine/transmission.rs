//! A transmission made ready: rest, natural modes, motion.

use super::request::{Equilibrium, RunRequest, TransmissionRun, TransmissionState};
use super::rows::RIGID;
use super::run::Runner;
use super::spec::{BodyId, TransmissionSpec};
use super::step::{History, Operator, Place, Stepped, step};
use super::system::System;
use crate::error::PlanetaryError;
use fecm::statics::Observer;

/// A transmission made ready to rest and to run.
#[derive(Debug, Clone)]
pub struct Transmission {
    pub(super) system: System,
    axes: Vec<[f64; 3]>,
    drive: Option<BodyId>,
}

/// Where a transmission stands and what loads it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Mesh cycles travelled.
    pub travelled: f64,
    /// Torque against the carrier (N m).
    pub output_torque: f64,
    /// Speed of the carrier (rad/s), for the centrifugal force of the planets.
    pub carrier_speed: f64,
}

/// Weights of the mass in the search for rest (1/s^2): first, factor, last. The last is that of a very low natural frequency (1.6 Hz), the first lets the
/// meshes close.
const PROXIMAL: [f64; 3] = [1e8, 0.01, 1e2];
/// Proximal steps to give up after.
const MOST_PROXIMAL: usize = 300;
/// Motion of the last step, relative to the motion from the start, in the metric of the masses.
const REST: f64 = 1e-11;

impl Transmission {
    /// Checks and assembles.
    ///
    /// # Errors
    /// The first number or name that is not allowed.
    pub fn new(spec: &TransmissionSpec) -> Result<Self, PlanetaryError> {
        spec.validate()?;
        let axes = spec.body_ids().iter().map(|&id| spec.body(id).map_or([0.0, 0.0, 1.0], |body| body.axis)).collect();
        Ok(Self { system: System::new(spec)?, axes, drive: spec.drive })
    }

    /// Names of the meshes: `sun-planet 1`, ..., `ring-planet 1`, ..., `bevel`.
    #[must_use]
    pub fn mesh_names(&self) -> Vec<&str> {
        self.system.meshes.iter().map(|mesh| mesh.name.as_str()).collect()
    }

    /// Number of coordinates: six of each body, and those of the housing.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.system.size()
    }

    /// Bodies in the order of their coordinates.
    #[must_use]
    pub fn bodies(&self) -> &[BodyId] {
        &self.system.ids
    }

    pub(super) fn place(&self, travelled: f64) -> Place {
        Place { angle: 2.0 * std::f64::consts::PI * (travelled / self.system.ring_teeth), travelled }
    }

    /// Loads on the rigid coordinates: torque, centrifugal force.
    pub(super) fn external(&self, place: Place, torque: f64, carrier_speed: f64) -> Vec<f64> {
        let mut force = vec![0.0; self.system.rigid()];
        force[RIGID * self.system.carrier + 5] = -torque;
        for (index, body) in self.system.inertia.iter().enumerate() {
            if let Some((radius, angle)) = body.carried {
                let (sin, cos) = (angle + place.angle).sin_cos();
                let size = body.mass * radius * carrier_speed * carrier_speed;
                force[RIGID * index] += size * cos;
                force[RIGID * index + 1] += size * sin;
            }
        }
        force
    }

    /// Static equilibrium.
    ///
    /// # Errors
    /// Loads that nothing holds; infinitely stiff connections that share a motion.
    pub fn equilibrium(&self, load: &Load) -> Result<Equilibrium, PlanetaryError> {
        let values = [load.travelled, load.output_torque, load.carrier_speed];
        let bad = values.iter().find(|value| !value.is_finite());
        PlanetaryError::check(bad.is_none(), || "load".into(), *bad.unwrap_or(&0.0), "finite numbers")?;
        let (system, place) = (&self.system, self.place(load.travelled));
        let external = self.external(place, load.output_torque, load.carrier_speed);
        let still = vec![0.0; system.size()];
        let (mut position, mut forces) = (still.clone(), vec![0.0; system.rows.len()]);
        let [mut rho, factor, least] = PROXIMAL;
        let mut change = f64::INFINITY;
        for iteration in 1..=MOST_PROXIMAL {
            let mut right = self.masses_times(&position);
            right.iter_mut().for_each(|value| *value *= rho);
            right.iter_mut().zip(&external).for_each(|(value, force)| *value += force);
            let history = History { load: &right, velocity: &still, expected: &still, speed: 0.0, forces: &forces };
            let next = step(system, &Operator::resting(system, rho), place, &history)?;
            let moved: Vec<f64> = next.position.iter().zip(&position).map(|(a, b)| a - b).collect();
            let (moved, size) = (self.energy_norm(&moved), self.energy_norm(&next.position));
            change = if size > 0.0 { moved / size } else { 0.0 };
            if !change.is_finite() {
                break;
            }
            if rho <= least && change <= REST {
                return Ok(self.at_rest(next, &external, iteration));
            }
            (position, forces) = (next.position, next.forces);
            rho = (rho * factor).max(least);
        }
        Err(PlanetaryError::NoEquilibrium { cycle: load.travelled, iterations: MOST_PROXIMAL, motion: change })
    }

    fn at_rest(&self, found: Stepped, external: &[f64], iterations: usize) -> Equilibrium {
        let system = &self.system;
        let springs = system.springs.len();
        let flank = |index: usize| found.forces[springs + index];
        let mut force = found.generalised;
        force.iter_mut().zip(external).for_each(|(force, external)| *force += external);
        let zeros = vec![0.0; system.size()];
        Equilibrium {
            mesh_forces: system.meshes.iter().map(|mesh| flank(mesh.drive)).collect(),
            coast_forces: system.meshes.iter().map(|mesh| mesh.coast.map_or(0.0, flank)).collect(),
            approaches: system.meshes.iter().map(|mesh| found.approaches[mesh.drive]).collect(),
            bearing_loads: system
                .bearings
                .iter()
                .map(|bearing| bearing.rows.map(|row| row.map_or(0.0, |row| found.forces[row])))
                .collect(),
            input_torque: system.drive.map(|row| -found.forces[row]),
            state: TransmissionState {
                step: 0,
                position: found.position.clone(),
                velocity: zeros.clone(),
                acceleration: zeros,
                connection: found.forces,
                force,
            },
            position: found.position,
            iterations,
        }
    }

    pub(super) fn masses_times(&self, x: &[f64]) -> Vec<f64> {
        let rigid = self.system.rigid();
        let mut out = Vec::with_capacity(x.len());
        for (body, x) in self.system.inertia.iter().zip(x[..rigid].chunks_exact(RIGID)) {
            out.extend(body.times([x[0], x[1], x[2], x[3], x[4], x[5]]));
        }
        out.extend_from_slice(&x[rigid..]);
        out
    }

    fn energy_norm(&self, x: &[f64]) -> f64 {
        self.masses_times(x).iter().zip(x).map(|(a, b)| a * b).sum::<f64>().sqrt()
    }

    /// Makes ready to run, piece by piece.
    ///
    /// # Errors
    /// Requests out of range, no equilibrium to start from.
    pub fn start(&self, request: &RunRequest) -> Result<Runner<'_>, PlanetaryError> {
        Runner::new(self, request)
    }

    /// Settles and records.
    ///
    /// # Errors
    /// As [`Self::start`] and [`Runner::record`].
    pub fn run(&self, request: &RunRequest, observer: &dyn Observer) -> Result<TransmissionRun, PlanetaryError> {
        let mut runner = self.start(request)?;
        runner.settle(request.settle_steps, observer)?;
        runner.record(request.record_steps, observer)
    }

    /// The driven body and its axis.
    #[must_use]
    pub fn drive(&self) -> Option<(BodyId, [f64; 3])> {
        let id = self.drive?;
        let index = self.system.ids.iter().position(|other| *other == id)?;
        Some((id, self.axes[index]))
    }
}
