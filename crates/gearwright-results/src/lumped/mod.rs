//! Lumped-parameter dynamics of a pair.

pub mod summary;
pub mod tables;

use gearwright_case::lumped_pair::curves::Curves;
use lpm::{Branch, DamageResponse, ImpulseTest, Model, Response, Spectrum, Supports, SweepPoint};

/// A case, computed.
#[derive(Debug)]
pub struct Lumped {
    /// The healthy state first.
    pub states: Vec<State>,
    /// Treatment of the supports.
    pub treatment: Treatment,
    /// What the analyses show.
    pub findings: Findings,
    /// Wall times.
    pub times: summary::Times,
}

/// A state, its curves and model.
#[derive(Debug, Clone)]
pub struct State {
    /// Name.
    pub name: String,
    /// Its curves.
    pub curves: Curves,
    /// Its model.
    pub model: Model,
    /// Mesh cycles that damage changes, from and to; `None` for the healthy state.
    pub damaged_cycles: Option<(usize, usize)>,
}

/// Treatment of the supports of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Treatment {
    /// The treatment.
    pub supports: Supports,
    /// Largest estimated error of eliminating the supports, and the mesh frequency of it (Hz; 0 for free motion); `None` where there are none.
    pub elimination: Option<(f64, f64)>,
}

impl Treatment {
    /// Where an error is, in words.
    #[must_use]
    pub fn place(frequency: f64) -> String {
        if frequency > 0.0 { format!("at {frequency:.4} Hz") } else { "of the natural frequency".to_owned() }
    }
}

/// Everything found.
#[derive(Debug, Default)]
pub struct Findings {
    /// Responses over time, by state.
    pub time: Vec<TimeResponse>,
    /// Sweeps, by state and direction.
    pub sweeps: Vec<SweepResult>,
    /// Branches, by state.
    pub branches: Vec<BranchResult>,
    /// Impulse tests, by state and phase.
    pub impulses: Vec<ImpulseResult>,
    /// Damage-induced responses, by state and speed.
    pub damage: Vec<DamageResult>,
    /// Largest amplitudes over speed, by state.
    pub damage_speeds: Vec<DamageSpeeds>,
}

/// Response over time.
#[derive(Debug)]
pub struct TimeResponse {
    /// State.
    pub state: String,
    /// Whether the motion repeats: periods of the excitation in one period of it; `None` if not, or not waited for.
    pub multiple: Option<usize>,
    /// The response.
    pub response: Response,
    /// Its spectrum.
    pub spectrum: Spectrum,
    /// Forces on single tooth pairs: (sample, pair, N); empty where load sharing is not known.
    pub tooth_forces: Vec<(usize, i32, f64)>,
}

/// Sweep in one direction.
#[derive(Debug)]
pub struct SweepResult {
    /// State.
    pub state: String,
    /// Whether speed rises.
    pub up: bool,
    /// Speeds.
    pub points: Vec<SweepPoint>,
}

/// Branch of periodic solutions.
#[derive(Debug)]
pub struct BranchResult {
    /// State.
    pub state: String,
    /// The branch.
    pub branch: Branch,
}

/// Impulse test.
#[derive(Debug)]
pub struct ImpulseResult {
    /// State.
    pub state: String,
    /// Mesh cycle at which the gears stand.
    pub mesh_cycle: f64,
    /// What is read; `None` where nothing oscillates.
    pub test: Option<ImpulseTest>,
}

/// Damage-induced response at one speed.
#[derive(Debug)]
pub struct DamageResult {
    /// State.
    pub state: String,
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// The response.
    pub response: DamageResponse,
    /// Largest amplitude of the static difference (m).
    pub static_amplitude: f64,
}

/// Largest spectral amplitude of the damage-induced response over speed.
#[derive(Debug)]
pub struct DamageSpeeds {
    /// State.
    pub state: String,
    /// Largest amplitude of the static difference (m).
    pub static_amplitude: f64,
    /// Rows of mesh frequency (Hz), frequency of the largest line (Hz), its amplitude (m), peak to peak (m).
    pub rows: Vec<[f64; 4]>,
}
