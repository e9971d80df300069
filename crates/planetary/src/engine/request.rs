//! What is asked of a transmission, and what it answers.

use std::time::Duration;

use super::band::Band;
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
    /// Forces of connections (N, N m): bearings, then meshes. Where the next step begins to look for those of the meshes.
    pub connection: Vec<f64>,
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
    /// Steps before the record begins; with a band, steps to its first sample, at least [`Band::lead_steps`].
    pub settle_steps: usize,
    /// Samples recorded: steps, or samples of the band.
    pub samples: usize,
    /// Band of the record. Without, the values at the end of every step are recorded as they are, whatever they hold above half the rate of the steps.
    pub band: Option<Band>,
    /// Whether to record the coordinates of bodies.
    pub record_motion: bool,
    /// Stages of a step, 1 to 4: the order of the method is twice as high ([`STAGES`] unless there is a reason).
    pub stages: usize,
}

/// Stages of a step that cost least for a given error of the dissertation's transmission.
pub const STAGES: usize = 3;

/// A quantity recorded sample by sample.
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
    /// Steps taken with one stage, because Newton's method over the stages did not converge.
    pub fallbacks: usize,
    /// Worst residual of a mesh: approach not accounted for (m).
    pub worst_residual: f64,
    /// Wall time.
    pub time: Duration,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct TransmissionRun {
    /// Time between samples (s).
    pub sample_time: f64,
    /// Step of the first sample.
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
    /// Samples recorded.
    #[must_use]
    pub fn len(&self) -> usize {
        self.meshes.first().map_or(0, |mesh| mesh.force.len())
    }

    /// Whether nothing is recorded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How far the run is from repeating after `period` samples: root mean square of the change between its last two periods over that of the
    /// variation in the last, over all sensors together, or over mesh forces where there are none. `None` where fewer than two periods are recorded.
    #[must_use]
    pub fn periodic_change(&self, period: usize) -> Option<f64> {
        if period == 0 || self.len() < 2 * period {
            return None;
        }
        let last = self.len() - 2 * period;
        let halves = |values: &'_ Series| (values[last..last + period].to_vec(), values[last + period..].to_vec());
        let pairs = |all: Vec<&Series>| relative(all.into_iter().map(halves));
        pairs(self.accelerations()).or_else(|| pairs(self.forces()))
    }

    /// How far the first samples of two runs of a transmission are from each other.
    #[must_use]
    pub fn deviation(&self, other: &Self, samples: usize) -> Option<Deviation> {
        if samples == 0 || self.len() < samples || other.len() < samples {
            return None;
        }
        let pairs = |own: Vec<&Series>, other: Vec<&Series>| {
            relative(own.into_iter().zip(other).map(|(a, b)| (a[..samples].to_vec(), b[..samples].to_vec())))
        };
        Some(Deviation {
            acceleration: pairs(self.accelerations(), other.accelerations()),
            mesh_force: pairs(self.forces(), other.forces()),
        })
    }

    fn accelerations(&self) -> Vec<&Series> {
        self.sensors.iter().map(|sensor| &sensor.acceleration).collect()
    }

    fn forces(&self) -> Vec<&Series> {
        self.meshes.iter().map(|mesh| &mesh.force).collect()
    }
}

/// How far two runs are from each other: root mean square of the difference over that of the variation about the mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Of all sensors together; none without sensors.
    pub acceleration: Option<f64>,
    /// Of the forces of all meshes together.
    pub mesh_force: Option<f64>,
}

/// Root mean square of all differences over that of the variation of the second of each pair; none without pairs.
fn relative(pairs: impl Iterator<Item = (Series, Series)>) -> Option<f64> {
    let (mut change, mut variation, mut count) = (0.0, 0.0, 0);
    for (before, last) in pairs {
        let mean = last.iter().sum::<f64>() / last.len().max(1) as f64;
        change += before.iter().zip(&last).map(|(a, b)| (b - a) * (b - a)).sum::<f64>();
        variation += last.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        count += 1;
    }
    (count > 0).then(|| (change / variation.max(f64::MIN_POSITIVE)).sqrt())
}

impl RunRequest {
    /// The same from the same start with steps half as long; `lead` steps of the longer lie before the first sample.
    #[must_use]
    pub fn halved(&self, lead: usize) -> Self {
        let turning = match self.turning {
            Turning::Steady { carrier_speed, steps_per_cycle } => {
                Turning::Steady { carrier_speed, steps_per_cycle: 2 * steps_per_cycle }
            }
            Turning::Standing { time_step } => Turning::Standing { time_step: 0.5 * time_step },
        };
        let band = self.band.map(|band| Band { steps_per_sample: 2 * band.steps_per_sample, ..band });
        Self { turning, band, settle_steps: 2 * lead, ..self.clone() }
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
