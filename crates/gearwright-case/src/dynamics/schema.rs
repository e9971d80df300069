//! The case file as written: keys, units, ranges, defaults. Doc comments are the documentation, as for every kind.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spur_pair::schema::Values;

/// Dynamics of a gear pair: the contact of the finite-element model solved at every step of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dynamics {
    /// What the file describes.
    pub kind: Kind,
    /// A line for headings of plots and reports.
    #[serde(default)]
    pub title: String,
    /// The gears: geometry, material, load and damage of a spur-pair case.
    pub pair: Pair,
    /// Inertia and bearing of the driving gear.
    #[serde(default)]
    pub pinion: Rotor,
    /// Inertia and bearing of the driven gear. It turns freely under the torque.
    #[serde(default)]
    pub gear: Rotor,
    /// Damping besides that of bearings. Contact itself loses nothing.
    #[serde(default)]
    pub damping: Damping,
    /// Speed, steps, transient and record.
    #[serde(default)]
    pub run: Run,
    /// Blows at standstill: natural frequency and damping ratio of every state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impulse: Option<Impulse>,
    /// Discretisation of the contact and integration in time.
    #[serde(default)]
    pub numerics: Numerics,
    /// What is written.
    #[serde(default)]
    pub output: Output,
    /// Going on after an interruption. `gearwright run CASE` of the same case and results folder takes up an interrupted run at its last
    /// checkpoint, with the same results to the last bit.
    #[serde(default)]
    pub checkpoint: Checkpoint,
}

/// Kinds of case files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Kind {
    /// Finite-element/contact-mechanics dynamics of a gear pair.
    #[serde(rename = "dynamics")]
    Dynamics,
}

/// The gear pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Spur-pair case file, beside this file: gears, material, model, torque and damage. The pair is run without its damage, and with each
    /// of its severities.
    pub spur_pair: String,
    /// Severities of the spur-pair case to run, counted from 1; an empty list for the healthy pair alone. Default: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub severities: Option<Vec<u32>>,
    /// Torque on the gear (N m). Default: that of the spur-pair case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e12))]
    pub torque_n_m: Option<f64>,
    /// "prescribed": the pinion turns uniformly, only the gear swings. "free": both swing, the pinion under the mean torque that balances
    /// the gear's. "shaft": as free, and a spring ties the pinion to an input that turns uniformly.
    pub input: Input,
    /// Torsional stiffness of the input shaft (N m/rad). Required with input "shaft".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e15))]
    pub shaft_stiffness_n_m_per_rad: Option<f64>,
    /// Torsional damping of the input shaft (N m s/rad). With input "shaft".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub shaft_damping_n_m_s_per_rad: Option<f64>,
}

/// What the pinion's rotation does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Input {
    /// Turns uniformly.
    Prescribed,
    /// Swings.
    Free,
    /// Swings on a shaft.
    Shaft,
}

/// A gear as a moving body. What is left out is computed from its geometry: a solid disc with the gear's outline, bore, facewidth and density,
/// without shafts and webs.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotor {
    /// Mass of all that moves with the gear (kg). Default: the solid disc.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e9))]
    pub mass_kg: Option<f64>,
    /// Moment of inertia about the gear's axis (kg m^2). Default: the solid disc.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-18, max = 1e12))]
    pub inertia_kg_m2: Option<f64>,
    /// Moment of inertia about a diameter at mid-face (kg m^2). Default: half of `inertia_kg_m2` plus `mass_kg` times facewidth squared over 12.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-18, max = 1e12))]
    pub transverse_inertia_kg_m2: Option<f64>,
    /// Elastic modes of the gear kept in motion, lowest first; 0 for a gear that deforms as it would at rest: enough where most of the inertia is not
    /// the gear's own. A gear that carries little else wants 20 (docs/dynamics.md). The inertia must hold that of the gear itself, and the bore be
    /// held by a hub.
    #[serde(default)]
    #[schemars(range(min = 0, max = 2000))]
    pub elastic_modes: u32,
    /// Bearing: springs and dampers between hub and ground. A coordinate without a stiffness does not move; one with stiffness 0 is free.
    #[serde(default)]
    pub bearing: Bearing,
}

/// Springs and dampers of a hub. The x axis points from the pinion's centre to the gear's, z along the axes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bearing {
    /// Stiffness along x (N/m). Left out: fixed; 0: free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub x_stiffness_n_per_m: Option<f64>,
    /// Stiffness along y (N/m). Left out: fixed; 0: free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub y_stiffness_n_per_m: Option<f64>,
    /// Stiffness along z (N/m). Left out: fixed; 0: free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub z_stiffness_n_per_m: Option<f64>,
    /// Stiffness against tilt about x (N m/rad). Left out: fixed; 0: free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub tilt_x_stiffness_n_m_per_rad: Option<f64>,
    /// Stiffness against tilt about y (N m/rad). Left out: fixed; 0: free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub tilt_y_stiffness_n_m_per_rad: Option<f64>,
    /// Damping along x (N s/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub x_damping_n_s_per_m: f64,
    /// Damping along y (N s/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub y_damping_n_s_per_m: f64,
    /// Damping along z (N s/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub z_damping_n_s_per_m: f64,
    /// Damping of tilt about x (N m s/rad).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub tilt_x_damping_n_m_s_per_rad: f64,
    /// Damping of tilt about y (N m s/rad).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub tilt_y_damping_n_m_s_per_rad: f64,
}

/// Rayleigh and modal damping.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Damping {
    /// Force per mass and velocity from the nominal motion (1/s): `2 zeta omega` gives a motion of angular frequency omega the damping ratio zeta.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub mass_proportional_per_s: f64,
    /// Damping per stiffness of bearings and elastic modes (s): `2 zeta / omega` gives the damping ratio zeta.
    #[schemars(range(min = 0.0, max = 1e3))]
    pub stiffness_proportional_s: f64,
    /// Damping ratio of every elastic mode.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub modal_ratio: f64,
}

/// What is run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Run {
    /// Mean speed of the pinion (rpm): a number, or a list of speeds, each run from the start anew. Give this or `mesh_frequency_hz`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_rpm: Option<Values>,
    /// Mesh frequency (Hz): a number, or a list.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_frequency_hz: Option<Values>,
    /// Steps of time in a mesh cycle. What counts is steps in a natural period (docs/dynamics.md). Default: at each speed as many as leave 2.5 % of the
    /// motion where a harmonic of the mesh frequency meets the natural frequency, from 50 to 400; `check` and the summary tell them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 8, max = 10000))]
    pub steps_per_mesh_cycle: Option<u32>,
    /// Mesh cycle at which the record begins.
    #[schemars(range(min = -100000.0, max = 100000.0))]
    pub mesh_cycle_from: f64,
    /// Mesh cycle at which tooth pair 0 touches at the pitch point. A damaged tooth 0 comes about 0.7 mesh cycles before it, so this moves the
    /// damage within the record. Default: that of the spur-pair case.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -100000.0, max = 100000.0))]
    pub mesh_cycle_origin: Option<f64>,
    /// Mesh cycles recorded. Default: one rotation of the damaged gear, of the pinion where none or both are damaged.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100000))]
    pub mesh_cycles: Option<u32>,
    /// How a run starts: "equilibrium" (under load, at rest against the mean motion) or "unloaded" (teeth touch, the load comes at once).
    /// Where the motion is to repeat, damaged pairs start from the steady motion of the healthy one.
    pub start: Start,
    /// Mesh cycles run before the record. Default: until the motion repeats.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1000000))]
    pub transient_mesh_cycles: Option<u32>,
    /// The motion repeats when the root mean square of what is left of the transient, estimated from how changes shrink from period to period, is
    /// this part of that of the transmission error about its mean. A period is a mesh cycle of a healthy pair, a rotation of a damaged gear.
    #[schemars(range(min = 1e-12, max = 0.1))]
    pub steady_tolerance: f64,
    /// Mesh cycles after which it is recorded although it does not repeat; the summary then says so. At least two periods are run.
    #[schemars(range(min = 2, max = 10000000))]
    pub steady_limit_mesh_cycles: u32,
}

impl Default for Run {
    fn default() -> Self {
        Self {
            speed_rpm: None,
            mesh_frequency_hz: None,
            steps_per_mesh_cycle: None,
            mesh_cycle_from: 0.0,
            mesh_cycle_origin: None,
            mesh_cycles: None,
            start: Start::Equilibrium,
            transient_mesh_cycles: None,
            steady_tolerance: 1e-4,
            steady_limit_mesh_cycles: 500,
        }
    }
}

/// How a run starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Static equilibrium.
    #[default]
    Equilibrium,
    /// First touch without load.
    Unloaded,
}

/// Numerical impulse tests: standing gears under their torque get a half-sine pulse of torque an eighth of a natural period long.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Impulse {
    /// Mesh cycles at which the gears stand.
    pub mesh_cycles: Vec<f64>,
    /// Peak of the pulse as a part of the torque: small, so that teeth stay in contact.
    #[serde(default = "pulse")]
    #[schemars(range(min = 1e-6, max = 10.0))]
    pub pulse_fraction: f64,
    /// Natural periods recorded.
    #[serde(default = "periods")]
    #[schemars(range(min = 8, max = 10000))]
    pub natural_periods: u32,
}

fn pulse() -> f64 {
    0.05
}

fn periods() -> u32 {
    40
}

/// Discretisation and integration. The finite-element mesh is that of the spur-pair case.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Numerics {
    /// Contact cells per Hertz half width along the profile: see docs/dynamics.md for why fewer than in statics suffice.
    #[schemars(range(min = 1.0, max = 100.0))]
    pub cells_per_half_width: f64,
    /// Contact cells along the face (3d).
    #[schemars(range(min = 1, max = 400))]
    pub face_cells: u32,
    /// Integration in time: "newmark" (average acceleration: no damping of its own, so forces of bearings too stiff for the step ring) or
    /// "generalized-alpha" (damps what a step cannot follow).
    pub integrator: Integrator,
    /// Spectral radius of generalized-alpha at infinite frequency: 1 damps nothing, 0 all of it in one step.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub spectral_radius: f64,
    /// Contact solver of a step: "newton" (fast) or "lemke" (reference).
    pub solver: Solver,
    /// Memory for contact compliances that are kept (MB).
    #[schemars(range(min = 1, max = 1000000))]
    pub memory_mb: u32,
}

impl Default for Numerics {
    fn default() -> Self {
        Self {
            cells_per_half_width: 4.0,
            face_cells: 24,
            integrator: Integrator::Newmark,
            spectral_radius: 0.8,
            solver: Solver::Newton,
            memory_mb: 2048,
        }
    }
}

/// Integration methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Average acceleration.
    Newmark,
    /// Generalised alpha.
    GeneralizedAlpha,
}

/// Contact solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// Semismooth Newton.
    Newton,
    /// Complementary pivoting.
    Lemke,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Plots as SVG and PNG.
    pub plots: bool,
    /// Contact pressure over a stretch of the record, as a film for ParaView: `film.pvd` and its frames, one film for each state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub film: Option<Film>,
}

impl Default for Output {
    fn default() -> Self {
        Self { plots: true, film: None }
    }
}

/// A film of the contact pressure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// First mesh cycle, within the record.
    pub mesh_cycle_from: f64,
    /// Last mesh cycle, within the record.
    pub mesh_cycle_to: f64,
    /// Steps from frame to frame.
    #[serde(default = "every")]
    #[schemars(range(min = 1, max = 100000))]
    pub every_steps: u32,
}

fn every() -> u32 {
    1
}

/// Checkpoints.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Checkpoint {
    /// Steps from one checkpoint to the next: what an interruption loses at most.
    #[schemars(range(min = 10, max = 10000000))]
    pub every_steps: u32,
}

impl Default for Checkpoint {
    fn default() -> Self {
        Self { every_steps: 1350 }
    }
}
