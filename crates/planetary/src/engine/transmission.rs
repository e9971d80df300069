//! A transmission made ready: rest, natural modes, motion.

use super::natural::square;
use super::placed::Place;
use super::request::{Equilibrium, RunRequest, TransmissionRun, TransmissionState, Turning};
use super::rest::{Operator, Stepped, step};
use super::rows::RIGID;
use super::run::Runner;
use super::spec::{BodyId, TransmissionSpec};
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

/// Weights of the mass in the search for rest (1/s^2): first, factor, last. The first lets the meshes close, the last is that of a natural frequency of
/// 1.6 Hz.
const PROXIMAL: [f64; 3] = [1e8, 0.01, 1e2];
/// Proximal steps to give up after.
const MOST_PROXIMAL: usize = 300;
/// Forces out of balance, relative to the load, each over the root of its mass: wanted, and accepted where the imbalance no longer falls, which is the
/// rounding of very stiff connections in a soft whole.
const REST: [f64; 2] = [1e-11, 1e-6];
/// Proximal steps without a smaller imbalance, after which it no longer falls.
const STALLED: usize = 8;
/// Last steps, of a weight that leaves less rounding of the forces in the motion.
const POLISH: [f64; 2] = [1e6, 1e6];

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

    /// Length of a step (s).
    #[must_use]
    pub fn time_step(&self, turning: &Turning) -> f64 {
        match *turning {
            Turning::Steady { carrier_speed, steps_per_cycle } => {
                2.0 * std::f64::consts::PI / self.system.ring_teeth / carrier_speed / steps_per_cycle as f64
            }
            Turning::Standing { time_step } => time_step,
        }
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
        let proximal = |rho: f64, position: &[f64], forces: &[f64]| {
            let mut right = self.masses_times(position);
            right.iter_mut().for_each(|value| *value *= rho);
            right.iter_mut().zip(&external).for_each(|(value, force)| *value += force);
            step(system, &Operator::new(system, rho), place, &right, forces)
        };
        let whole = self.unit_mass(&[&external[..], &still[system.rigid()..]].concat());
        let size = square(&whole).sqrt();
        let [mut rho, factor, least] = PROXIMAL;
        let (mut imbalance, mut least_imbalance, mut stalled) = (f64::INFINITY, f64::INFINITY, 0);
        for iteration in 1..=MOST_PROXIMAL {
            let next = proximal(rho, &position, &forces)?;
            // too far at once
            if !next.report.is_solved {
                rho /= factor;
                continue;
            }
            let moved: Vec<f64> = next.position.iter().zip(&position).map(|(a, b)| a - b).collect();
            let moved = self.masses_times(&moved).iter().zip(&moved).map(|(a, b)| a * b).sum::<f64>().sqrt();
            imbalance = rho * moved;
            (position, forces) = (next.position, next.forces);
            if !imbalance.is_finite() {
                break;
            }
            stalled = if imbalance < 0.5 * least_imbalance { 0 } else { stalled + 1 };
            least_imbalance = least_imbalance.min(imbalance);
            let is_rounding = rho <= least && stalled >= STALLED;
            let wanted = if is_rounding { REST[1] } else { REST[0] };
            if imbalance <= wanted * size {
                let [first, last] = POLISH;
                let next = proximal(first, &position, &forces)?;
                return Ok(self.at_rest(proximal(last, &next.position, &next.forces)?, iteration));
            }
            rho = (rho * factor).max(least);
        }
        let relative = imbalance / size.max(f64::MIN_POSITIVE);
        Err(PlanetaryError::NoEquilibrium { cycle: load.travelled, iterations: MOST_PROXIMAL, imbalance: relative })
    }

    fn at_rest(&self, found: Stepped, iterations: usize) -> Equilibrium {
        let system = &self.system;
        let springs = system.springs.len();
        let flank = |index: usize| found.forces[springs + index];
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
                velocity: vec![0.0; system.size()],
                connection: found.forces,
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
        let lead = request.band.map_or(0, |band| band.lead_steps(runner.time_step()));
        runner.settle(request.settle_steps.saturating_sub(lead), observer)?;
        runner.record(request.samples, observer)
    }

    /// The driven body and its axis.
    #[must_use]
    pub fn drive(&self) -> Option<(BodyId, [f64; 3])> {
        let id = self.drive?;
        let index = self.system.ids.iter().position(|other| *other == id)?;
        Some((id, self.axes[index]))
    }
}
