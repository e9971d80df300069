//! The case file as written: keys, units, ranges, defaults. Doc comments are the documentation, as for every kind.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Dynamics of a gear pair with lumped parameters: two discs, a mesh known by two curves, contact loss.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LumpedPair {
    /// What the file describes.
    pub kind: Kind,
    /// A line for headings of plots and reports.
    #[serde(default)]
    pub title: String,
    /// The two gears, their supports and the mesh between them.
    pub pair: Pair,
    /// Mesh stiffness and static transmission error of the healthy pair. Give one of `spur_pair`, `table`, `wave` and `fourier`.
    pub excitation: Excitation,
    /// Damaged states, beside the healthy one: the rotation in which one tooth is damaged. Give one of `spur_pair`, `table`
    /// and `stiffness_factor` for the mesh cycles that the damage changes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub state: Vec<State>,
    /// What is computed. Every section given is run.
    #[serde(default)]
    pub analysis: Analysis,
    /// What is written.
    #[serde(default)]
    pub output: Output,
}

/// Kinds of case files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Kind {
    /// A lumped-parameter gear pair.
    #[serde(rename = "lumped-pair")]
    LumpedPair,
}

/// The gear pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// "prescribed": the pinion turns uniformly, only the gear swings (pinion bore held, as in the finite-element model).
    /// "free": both swing under their torques. The natural frequency differs by a factor of two or so: see docs/lumped-dynamics.md.
    pub input: Input,
    /// Torque on the gear (N m). Default: that of the spur-pair case in `excitation.spur_pair`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub gear_torque_n_m: Option<f64>,
    /// Torque on the pinion (N m), positive where it loads the same flanks. Default: balances the gear's. Used with free input.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub pinion_torque_n_m: Option<f64>,
    /// Damping of the mesh (N s/m). Give this or `mesh_damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub mesh_damping_n_s_per_m: Option<f64>,
    /// Damping of the mesh as a fraction of critical damping at the mean mesh stiffness of the healthy pair.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub mesh_damping_ratio: Option<f64>,
    /// Where teeth separate: "force-vanishes" (the elastic mesh force is zero) or "deflection-vanishes" (the mesh deflection is zero;
    /// with a local-slope stiffness the force then jumps).
    #[serde(default)]
    pub separation: Separation,
    /// Keep the mesh damper while the teeth are apart.
    #[serde(default)]
    pub damping_when_apart: bool,
    /// Clearance along the line of action behind which the coast flanks touch (um). Default: no coast side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub backlash_um: Option<f64>,
    /// Treatment of the supports: "integrated" (three coordinates), "eliminated" (quasi-static, in series with the mesh; one
    /// coordinate; refused where the estimated error of the response is above 1 %), "rigid". Default: with support stiffnesses
    /// "eliminated" where that error allows it, otherwise "integrated"; without any, "rigid".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supports: Option<Supports>,
    /// The driving gear.
    #[serde(default)]
    pub pinion: Disc,
    /// The driven gear.
    #[serde(default)]
    pub gear: Disc,
}

/// What the pinion's rotation does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Input {
    /// Turns uniformly.
    Prescribed,
    /// Swings.
    Free,
}

/// Separation rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Separation {
    /// Zero elastic force.
    #[default]
    ForceVanishes,
    /// Zero deflection.
    DeflectionVanishes,
}

/// Treatment of supports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Supports {
    /// Three coordinates.
    Integrated,
    /// In series with the mesh.
    Eliminated,
    /// None.
    Rigid,
}

/// One gear as a disc on a support. What is left out is computed from the geometry of `excitation.spur_pair`, where that is given:
/// a solid disc with the gear's outline, bore, facewidth and density.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Number of teeth: mesh cycles in a rotation. Needed for damaged states and for speeds in rpm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 2000))]
    pub teeth: Option<u32>,
    /// Base radius (mm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-4, max = 100000.0))]
    pub base_radius_mm: Option<f64>,
    /// Mass (kg). Needed with elastic supports.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e9))]
    pub mass_kg: Option<f64>,
    /// Moment of inertia about the axis (kg m^2).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-18, max = 1e12))]
    pub inertia_kg_m2: Option<f64>,
    /// Stiffness of the support along the line of action (N/m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1.0, max = 1e18))]
    pub support_stiffness_n_per_m: Option<f64>,
    /// Damping of the support along the line of action (N s/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub support_damping_n_s_per_m: f64,
}

/// Mesh stiffness and static transmission error over the mesh cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Excitation {
    /// Spur-pair case file, beside this file: its static analysis is run, without its damage, and its curves are used. It must cover whole
    /// mesh cycles; where all teeth are alike one of them is used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spur_pair: Option<String>,
    /// Between the points of a spur-pair run or a table: "linear" (keeps the sharp changes of contact as they are) or "spline" (smooth
    /// curves; overshoots at sharp changes).
    #[serde(default)]
    pub interpolation: Interpolation,
    /// The gear that carries the damage: its teeth are the mesh cycles of a rotation.
    #[serde(default)]
    pub damaged_gear: Member,
    /// Curves from a CSV table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Rectangular or trapezoidal wave: one and two pairs in contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wave: Option<Wave>,
    /// Fourier series over the mesh cycle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fourier: Option<Fourier>,
}

/// Interpolation of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Straight lines.
    #[default]
    Linear,
    /// Periodic cubic spline.
    Spline,
}

/// One of the gears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Member {
    /// The driving gear.
    #[default]
    Pinion,
    /// The driven gear.
    Gear,
}

/// A CSV table with a header row, such as the `series.csv` of a spur-pair run. It covers whole mesh cycles, evenly or not; columns
/// `pair_<number>_share`, where present, give the forces on single tooth pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// File, beside the case file.
    pub file: String,
    /// Column of the mesh cycle.
    #[serde(default = "mesh_cycle_column")]
    pub mesh_cycle_column: String,
    /// Column of the local-slope mesh stiffness (N/um).
    #[serde(default = "stiffness_column")]
    pub stiffness_column: String,
    /// Column of the static transmission error (um).
    #[serde(default = "ste_column")]
    pub ste_column: String,
}

fn mesh_cycle_column() -> String {
    "mesh_cycle".into()
}

fn stiffness_column() -> String {
    "mesh_stiffness_local_n_per_um".into()
}

fn ste_column() -> String {
    "ste_um".into()
}

/// A wave between one and two pairs in contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// Mesh stiffness with one pair in contact (N/um).
    #[schemars(range(min = 1e-6, max = 1e9))]
    pub single_stiffness_n_per_um: f64,
    /// Mesh stiffness with two pairs in contact (N/um).
    #[schemars(range(min = 1e-6, max = 1e9))]
    pub double_stiffness_n_per_um: f64,
    /// Contact ratio under load: two pairs are in contact over its part above 1.
    #[schemars(range(min = 1.001, max = 1.999))]
    pub contact_ratio: f64,
    /// Mesh cycle at which the second pair comes into contact.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 0.999999))]
    pub double_from_mesh_cycle: f64,
    /// Length of straight ramps in place of the jumps (mesh cycles). 0 for jumps.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 0.5))]
    pub ramp_mesh_cycles: f64,
    /// Static transmission error with one pair in contact (um). Default: mean mesh force over stiffness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e6, max = 1e6))]
    pub single_ste_um: Option<f64>,
    /// Static transmission error with two pairs in contact (um). Default: mean mesh force over stiffness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e6, max = 1e6))]
    pub double_ste_um: Option<f64>,
}

/// Fourier series `mean + sum_j cosine_j cos(2 pi j t) + sine_j sin(2 pi j t)` over the mesh cycle `t`. For damaged states it is
/// tabulated at 64 points per wave of its highest harmonic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fourier {
    /// Mean mesh stiffness (N/um).
    #[schemars(range(min = 1e-6, max = 1e9))]
    pub stiffness_mean_n_per_um: f64,
    /// Cosine coefficients of the mesh stiffness, from the first harmonic on (N/um).
    #[serde(default)]
    pub stiffness_cosines_n_per_um: Vec<f64>,
    /// Sine coefficients of the mesh stiffness (N/um).
    #[serde(default)]
    pub stiffness_sines_n_per_um: Vec<f64>,
    /// Mean static transmission error (um).
    #[schemars(range(min = -1e6, max = 1e6))]
    pub ste_mean_um: f64,
    /// Cosine coefficients of the static transmission error (um).
    #[serde(default)]
    pub ste_cosines_um: Vec<f64>,
    /// Sine coefficients of the static transmission error (um).
    #[serde(default)]
    pub ste_sines_um: Vec<f64>,
}

/// A damaged state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Name in tables and plots. Where the spur-pair case holds several severities, each is a state of its own, named as there.
    pub name: String,
    /// First mesh cycle of the rotation that the damage changes. Default: the first mesh cycle of the table or of the spur-pair
    /// case, within the rotation. Required with `stiffness_factor`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 100000))]
    pub mesh_cycle: Option<u32>,
    /// Mesh cycles that `stiffness_factor` changes.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 1000))]
    pub mesh_cycles: u32,
    /// A stand-in for damage: mesh stiffness times this factor, static transmission error divided by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 1000.0))]
    pub stiffness_factor: Option<f64>,
    /// Spur-pair case file with the damage, over the whole mesh cycles that it changes. Mesh cycles must be counted from the same
    /// origin as in `excitation.spur_pair`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spur_pair: Option<String>,
    /// Curves with the damage from a CSV table, over the whole mesh cycles that it changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
}

fn one() -> u32 {
    1
}

/// What is computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Analysis {
    /// Error per step of the integration, relative to the static deflection.
    #[schemars(range(min = 1e-12, max = 0.01))]
    pub tolerance: f64,
    /// Integration: "automatic" (exponential for one coordinate, implicit Runge-Kutta for three), "exponential", "dormand-prince",
    /// "implicit" or "newmark".
    pub method: Method,
    /// Samples of a response per mesh cycle.
    #[schemars(range(min = 16, max = 10000))]
    pub samples_per_cycle: u32,
    /// Response over time at one speed, with spectrum, contact loss, tooth and bearing forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<Time>,
    /// Steady states over speed, stepped up and down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Sweep>,
    /// Periodic solutions over speed, stable and unstable, through turning points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuation: Option<Continuation>,
    /// Blow at standstill: natural frequency and damping ratio.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse: Option<Impulse>,
    /// Damage-induced response: damaged minus healthy, and its spectrum. Needs damaged states.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
}

impl Default for Analysis {
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            method: Method::Automatic,
            samples_per_cycle: 100,
            time: None,
            sweep: None,
            continuation: None,
            impulse: None,
            damage: None,
        }
    }
}

/// Integration methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// By the number of coordinates.
    #[default]
    Automatic,
    /// Exponential integrator of order 6 (one coordinate).
    Exponential,
    /// Explicit Runge-Kutta of order 5.
    DormandPrince,
    /// Diagonally implicit Runge-Kutta of order 4.
    Implicit,
    /// Newmark, average acceleration.
    Newmark,
}

/// Response over time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Mesh frequency (Hz). Give this or `pinion_speed_rpm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub mesh_frequency_hz: Option<f64>,
    /// Speed of the pinion (rpm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub pinion_speed_rpm: Option<f64>,
    /// Mesh cycles recorded. Default: one rotation of the damaged gear, or 20 where teeth are not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100000))]
    pub mesh_cycles: Option<u32>,
    /// "steady" (recorded once the motion repeats) or "rest" (recorded from static equilibrium on, transient included).
    #[serde(default)]
    pub start: Start,
    /// Approach the speed from this mesh frequency in steps of at most 50 Hz, each from the motion of the one before: where two motions
    /// are possible, from below and from above give one each (Hz). Default: from rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub approach_from_hz: Option<f64>,
}

/// Where recording starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Steady state.
    #[default]
    Steady,
    /// Static equilibrium.
    Rest,
}

/// Speed sweep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Lowest mesh frequency (Hz).
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub from_hz: f64,
    /// Highest mesh frequency (Hz).
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub to_hz: f64,
    /// Step (Hz).
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub step_hz: f64,
    /// "both", "up" or "down".
    #[serde(default)]
    pub direction: Direction,
}

/// Sweep directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Up and down.
    #[default]
    Both,
    /// Up.
    Up,
    /// Down.
    Down,
}

/// Continuation of periodic solutions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Continuation {
    /// Lowest mesh frequency (Hz).
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub from_hz: f64,
    /// Highest mesh frequency, where the branch starts from the steady state reached from rest (Hz).
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub to_hz: f64,
    /// Largest step along the branch, in units of the natural frequency and the static deflection.
    #[serde(default = "branch_step")]
    #[schemars(range(min = 0.0001, max = 1.0))]
    pub largest_step: f64,
    /// Also the damaged states, whose period is a whole rotation; else the healthy one alone.
    #[serde(default)]
    pub damaged: bool,
}

fn branch_step() -> f64 {
    lpm::ContinuationOptions::default().max_step
}

/// Impulse test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Impulse {
    /// Impulse along the line of action, pressing the teeth together (N s).
    #[schemars(range(min = 1e-12, max = 1e6))]
    pub impulse_n_s: f64,
    /// Mesh cycles at which the gears stand still.
    pub mesh_cycles: Vec<f64>,
    /// Natural periods recorded.
    #[serde(default = "periods")]
    #[schemars(range(min = 2, max = 10000))]
    pub periods: u32,
}

fn periods() -> u32 {
    20
}

/// Damage-induced response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Damage {
    /// Mesh frequencies whose difference and spectrum are written (Hz).
    pub mesh_frequencies_hz: Vec<f64>,
    /// Largest amplitude over speed: lowest mesh frequency (Hz).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub from_hz: Option<f64>,
    /// Highest mesh frequency (Hz).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub to_hz: Option<f64>,
    /// Step (Hz).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub step_hz: Option<f64>,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Plots as SVG and PNG.
    pub plots: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self { plots: true }
    }
}
