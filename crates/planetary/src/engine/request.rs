//! What is asked of a transmission, and what it answers.

use std::time::Duration;

use fecm::dynamics::Integrator;

use super::spec::BodyId;

/// How the transmission turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turning {
    /// Evenly, in a whole number of steps per mesh cycle of the planetary stage, so that positions repeat exactly.
    Steady {
        /// Speed of the carrier (rad/s), positive.
        carrier_speed: f64,
        /// 4 to 100,000.
        steps_per_cycle: usize,
    },
    /// It stands where it starts.
    Standing {
        /// s, positive.
        time_step: f64,
    },
}

/// Motion to go on from.
#[derive(Debug, Clone, PartialEq)]
pub struct TransmissionState {
    /// Steps since the start.
    pub step: i64,
    /// Coordinates: `x, y, z, rx, ry, rz` (m, rad) of each body in the order of [`super::TransmissionSpec::body_ids`], in standing axes, then those of the
    /// housing.
    pub position: Vec<f64>,
    /// Their rates.
    pub velocity: Vec<f64>,
    /// And accelerations; a run from accelerations that do not fit the forces loses an order of accuracy.
    pub acceleration: Vec<f64>,
    /// Forces of connections (N, N m): bearings, then meshes.
    pub connection: Vec<f64>,
    /// All forces on the coordinates, those of inertia, elasticity and damping of bodies left out.
    pub force: Vec<f64>,
}

/// How a run begins.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Start {
    /// In static equilibrium.
    #[default]
    Equilibrium,
    /// From here.
    Given(Box<TransmissionState>),
}

/// A run in time.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRequest {
    /// Speed and step.
    pub turning: Turning,
    /// Torque against the carrier (N m), 0 or more.
    pub output_torque: f64,
    /// Mesh cycles travelled at the start (step 0).
    pub travelled: f64,
    /// Start.
    pub start: Start,
    /// Steps before the record begins.
    pub settle_steps: usize,
    /// Steps recorded.
    pub record_steps: usize,
    /// Whether to record the coordinates of bodies.
    pub record_motion: bool,
    /// Time integration.
    pub integrator: Integrator,
}

/// A quantity recorded at every step.
pub type Series = Vec<f64>;

/// Record of a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshRecord {
    /// Name: `sun-planet 1`, `ring-planet 1`, `bevel`.
    pub name: String,
    /// Normal force of the drive flanks (N).
    pub force: Series,
    /// Normal force of the coast flanks (N).
    pub coast_force: Series,
    /// Approach of the drive flanks (m).
    pub approach: Series,
    /// Steps at which nothing touched.
    pub steps_apart: usize,
    /// How often the drive flanks parted.
    pub losses: usize,
}

/// Record of a bearing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BearingRecord {
    /// Name; `planet 1` for that of a planet.
    pub name: String,
    /// Forces (N) and moments (N m) along and about its axes that the body puts on its anchor.
    pub load: [Series; 6],
}

/// Record of a sensor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SensorRecord {
    /// Name.
    pub name: String,
    /// Acceleration (m/s^2).
    pub acceleration: Series,
}

/// Record of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyRecord {
    /// Which.
    pub body: BodyId,
    /// `x, y, z` (m), `rx, ry, rz` (rad) in standing axes.
    pub motion: [Series; 6],
}

/// Work done by a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TransmissionStats {
    /// Steps.
    pub steps: usize,
    /// Newton iterations over meshes.
    pub newton_iterations: usize,
    /// Steps at which Newton's method had to go back along its way.
    pub fallbacks: usize,
    /// Worst residual of a mesh: approach not accounted for (m).
    pub worst_residual: f64,
    /// Wall time.
    pub time: Duration,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct TransmissionRun {
    /// s.
    pub time_step: f64,
    /// Step of the first record.
    pub first_step: i64,
    /// Records of sensors.
    pub sensors: Vec<SensorRecord>,
    /// Of meshes.
    pub meshes: Vec<MeshRecord>,
    /// Of bearings.
    pub bearings: Vec<BearingRecord>,
    /// Of bodies, where asked for.
    pub bodies: Vec<BodyRecord>,
    /// Where the run stands.
    pub state: TransmissionState,
    /// Counters, from the start of the run.
    pub stats: TransmissionStats,
}

impl TransmissionRun {
    /// Steps recorded.
    #[must_use]
    pub fn len(&self) -> usize {
        self.meshes.first().map_or(0, |mesh| mesh.force.len())
    }

    /// Whether nothing is recorded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How far the run is from repeating after `period` steps: root mean square of the change between its last two periods over that of the
    /// variation in the last, over all sensors together, or over mesh forces where there are none. `None` where fewer than two periods are recorded.
    #[must_use]
    pub fn periodic_change(&self, period: usize) -> Option<f64> {
        let series: Vec<&Series> = if self.sensors.is_empty() {
            self.meshes.iter().map(|mesh| &mesh.force).collect()
        } else {
            self.sensors.iter().map(|sensor| &sensor.acceleration).collect()
        };
        if period == 0 || self.len() < 2 * period {
            return None;
        }
        let (mut change, mut variation) = (0.0, 0.0);
        for values in series {
            let (before, last) = values[values.len() - 2 * period..].split_at(period);
            let mean = last.iter().sum::<f64>() / period as f64;
            change += before.iter().zip(last).map(|(a, b)| (b - a) * (b - a)).sum::<f64>();
            variation += last.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        }
        Some((change / variation.max(f64::MIN_POSITIVE)).sqrt())
    }
}

/// Motion at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Coordinates, as in [`TransmissionState::position`].
    pub position: Vec<f64>,
    /// Forces of the drive flanks (N), in the order of [`TransmissionRun::meshes`].
    pub mesh_forces: Vec<f64>,
    /// Of the coast flanks (N).
    pub coast_forces: Vec<f64>,
    /// Approaches of the drive flanks (m).
    pub approaches: Vec<f64>,
    /// Loads of bearings, in the order of [`TransmissionRun::bearings`].
    pub bearing_loads: Vec<[f64; 6]>,
    /// Torque that holds the driven body (N m) about its axis, none where the input is free.
    pub input_torque: Option<f64>,
    /// The same as a state at step 0, at rest.
    pub state: TransmissionState,
    /// Iterations.
    pub iterations: usize,
}

/// A natural mode.
#[derive(Debug, Clone, PartialEq)]
pub struct NaturalMode {
    /// Hz.
    pub frequency: f64,
    /// Coordinates, as in [`TransmissionState::position`], of unit modal mass.
    pub shape: Vec<f64>,
    /// Part of the kinetic energy in each body, in the order of [`super::TransmissionSpec::body_ids`], and last in the housing.
    pub energy: Vec<f64>,
}
