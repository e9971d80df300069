//! What a dynamic analysis needs besides the static model.

use super::integrator::Integrator;
use super::system::{Damping, HUB_COORDINATES, ROTATION, Support};
use crate::error::FecmError;

/// Mass and moments of inertia of everything that moves with a hub.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorInertia {
    /// kg.
    pub mass: f64,
    /// About the gear's axis (kg m^2).
    pub polar: f64,
    /// About a diameter at mid-face (kg m^2).
    pub transverse: f64,
}

/// One gear as a moving body.
#[derive(Debug, Clone, PartialEq)]
pub struct RotorOptions {
    /// Inertia.
    pub inertia: RotorInertia,
    /// How each hub coordinate is held, in the order of [`HUB_COORDINATES`].
    pub supports: [Support; 6],
    /// Elastic modes of the gear kept in motion, lowest first: 0 for a rigid body. The rest of the gear follows as it would at rest. The inertia must
    /// then hold that of the gear itself, and the bore be held by a hub.
    pub modes: usize,
}

/// Which contact solver a step uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StepSolver {
    /// Semismooth Newton on the active set, warm-started; complementary pivoting where it does not end.
    #[default]
    Newton,
    /// Complementary pivoting on the whole problem: slow, for checks.
    Lemke,
}

/// Options of a dynamic analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicsOptions {
    /// Pinion and wheel. A pinion whose rotation is [`Support::Fixed`] turns at constant speed.
    pub rotors: [RotorOptions; 2],
    /// Damping.
    pub damping: Damping,
    /// Time integration.
    pub integrator: Integrator,
    /// Solver of each step.
    pub solver: StepSolver,
    /// Memory for contact operators kept (bytes).
    pub operator_memory: usize,
}

/// How the gears turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// The pinion turns at this mean speed (rad/s), with this many steps a mesh cycle.
    Running {
        /// rad/s, positive.
        speed: f64,
        /// 4 to 100,000.
        steps_per_cycle: usize,
    },
    /// The gears stand at the mesh cycle of the start, in steps of this length.
    Standing {
        /// s, positive.
        time_step: f64,
    },
}

/// How a run begins.
#[derive(Debug, Clone, PartialEq)]
pub enum InitialState {
    /// Static equilibrium at the first position.
    Equilibrium,
    /// At first touch without load, moving at nominal speed: the torque comes as a step.
    Unloaded,
    /// As given: for resuming, or to start from anywhere.
    Given(DynamicsState),
}

/// Everything a run needs to go on from a step.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicsState {
    /// Steps since the start.
    pub step: i64,
    /// Rigid coordinates (m, rad), then modal coordinates (m kg^1/2).
    pub position: Vec<f64>,
    /// Their velocities.
    pub velocity: Vec<f64>,
    /// Their accelerations.
    pub acceleration: Vec<f64>,
    /// Generalised contact forces.
    pub contact: Vec<f64>,
}

/// A half-sine pulse of torque on the wheel, in the direction of the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorquePulse {
    /// Start (s since step 0).
    pub start: f64,
    /// Duration (s).
    pub duration: f64,
    /// Peak (N m).
    pub peak: f64,
}

/// What to compute.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicsRequest {
    /// Mesh cycle at step 0.
    pub mesh_cycle: f64,
    /// How the gears turn.
    pub motion: Motion,
    /// Load on the wheel (N m), positive.
    pub torque: f64,
    /// Added to the load.
    pub pulse: Option<TorquePulse>,
    /// How the run begins.
    pub initial: InitialState,
    /// Steps, counted from step 0, whose pressures are kept.
    pub snapshots: Vec<i64>,
}

impl TorquePulse {
    pub(super) fn at(&self, time: f64) -> f64 {
        let phase = (time - self.start) / self.duration;
        if (0.0..1.0).contains(&phase) { self.peak * (std::f64::consts::PI * phase).sin() } else { 0.0 }
    }
}

impl RotorOptions {
    /// A gear of this inertia on ideal bearings, its rotation held as given.
    #[must_use]
    pub fn on_ideal_bearings(inertia: RotorInertia, rotation: Support) -> Self {
        let mut supports = [Support::Fixed; 6];
        supports[ROTATION] = rotation;
        Self { inertia, supports, modes: 0 }
    }

    /// Mass of each hub coordinate (kg, kg m^2).
    #[must_use]
    pub fn masses(&self) -> [f64; 6] {
        let RotorInertia { mass, polar, transverse } = self.inertia;
        [mass, mass, mass, transverse, transverse, polar]
    }
}

impl DynamicsOptions {
    /// Average acceleration, semismooth Newton, 1 GiB of contact operators.
    #[must_use]
    pub fn new(rotors: [RotorOptions; 2], damping: Damping) -> Self {
        Self {
            rotors,
            damping,
            integrator: Integrator::AverageAcceleration,
            solver: StepSolver::Newton,
            operator_memory: 1 << 30,
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`FecmError::Option`] for the first option out of range.
    pub fn validate(&self) -> Result<(), FecmError> {
        self.integrator.validate()?;
        let not_negative = |name, value: f64, allowed| {
            if value >= 0.0 && value.is_finite() { Ok(()) } else { Err(FecmError::Option { name, value, allowed }) }
        };
        for rotor in &self.rotors {
            let RotorInertia { mass, polar, transverse } = rotor.inertia;
            for (name, value) in [("mass", mass), ("polar inertia", polar), ("transverse inertia", transverse)] {
                if !(value > 0.0 && value.is_finite()) {
                    return Err(FecmError::Option { name, value, allowed: "positive" });
                }
            }
            for (support, name) in rotor.supports.iter().zip(HUB_COORDINATES) {
                if let Support::Elastic { stiffness, damping } = *support {
                    not_negative(name, stiffness, "a stiffness of 0 or more")?;
                    not_negative(name, damping, "a damping of 0 or more")?;
                }
            }
        }
        let Damping { mass_proportional, stiffness_proportional, modal_ratio } = self.damping;
        not_negative("mass-proportional damping", mass_proportional, "0 or more, in 1/s")?;
        not_negative("stiffness-proportional damping", stiffness_proportional, "0 or more, in s")?;
        not_negative("modal damping ratio", modal_ratio, "0 or more")
    }
}

impl DynamicsRequest {
    /// Gears that turn, the pinion at `speed` (rad/s), under `torque` (N m) on the wheel, from equilibrium at mesh cycle 0.
    #[must_use]
    pub fn running(speed: f64, steps_per_cycle: usize, torque: f64) -> Self {
        Self {
            mesh_cycle: 0.0,
            motion: Motion::Running { speed, steps_per_cycle },
            torque,
            pulse: None,
            initial: InitialState::Equilibrium,
            snapshots: Vec::new(),
        }
    }

    /// Length of a step (s) for gears with this angle from tooth to tooth of the pinion.
    #[must_use]
    pub fn time_step(&self, pinion_pitch: f64) -> f64 {
        match self.motion {
            Motion::Running { speed, steps_per_cycle } => pinion_pitch / speed / steps_per_cycle as f64,
            Motion::Standing { time_step } => time_step,
        }
    }

    pub(super) fn validate(&self) -> Result<(), FecmError> {
        let positive = |name, value: f64, allowed| {
            if value > 0.0 && value.is_finite() { Ok(()) } else { Err(FecmError::Option { name, value, allowed }) }
        };
        positive("torque", self.torque, "positive, in N m")?;
        if !(self.mesh_cycle.abs() < 1e6) {
            return Err(FecmError::Option { name: "mesh cycle", value: self.mesh_cycle, allowed: "-1e6 to 1e6" });
        }
        match self.motion {
            Motion::Running { speed, steps_per_cycle } => {
                positive("speed", speed, "positive, in rad/s")?;
                if !(4..=100_000).contains(&steps_per_cycle) {
                    let value = steps_per_cycle as f64;
                    return Err(FecmError::Option { name: "steps per mesh cycle", value, allowed: "4 to 100000" });
                }
            }
            Motion::Standing { time_step } => positive("time step", time_step, "positive, in s")?,
        }
        if let Some(pulse) = &self.pulse {
            positive("pulse duration", pulse.duration, "positive, in s")?;
            if !(pulse.peak.is_finite() && pulse.start.is_finite()) {
                return Err(FecmError::Option { name: "pulse", value: pulse.peak, allowed: "finite" });
            }
        }
        Ok(())
    }
}
