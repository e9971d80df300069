//! The case file as written: keys, units, ranges, defaults. Doc comments are the documentation, as for every kind.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::stage_schema::{Bevel, Housing};
use crate::spur_pair::schema::{
    BrokenCorner, Crack, Gear, Material, Mesh, Model, Numerics as Contact, Pit, Values, Wear,
};

/// Vibration of a whole planetary transmission: ring fixed, sun or a bevel pinion before it driving, load on the carrier.
///
/// The main axis is z. Gears, carrier and shafts are rigid bodies on bearings; teeth are those of the finite-element contact model; the housing is
/// elastic and carries the sensors. Angles count counter-clockwise seen from positive z, where sun and carrier turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Transmission {
    /// What the file describes.
    pub kind: Kind,
    /// A line for headings of plots and reports.
    #[serde(default)]
    pub title: String,
    /// What sun, planets and ring share.
    pub mesh: Mesh,
    /// Planets and where they are at the start.
    pub train: Train,
    /// The sun gear.
    pub sun: Gear,
    /// The planet gear; all planets are alike.
    pub planet: Gear,
    /// The ring gear, fixed: its `bore_diameter_mm` is the outside diameter of its rim.
    pub ring: Gear,
    /// A spiral bevel stage that drives the sun: its gear turns with the sun. Default: none, the sun's rotation is prescribed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bevel: Option<Bevel>,
    /// Mass and moments of inertia; what is left out is computed from the gears as solid discs. The summary says what was used.
    #[serde(default)]
    pub bodies: Bodies,
    /// Bearings, one section each. Every body needs at least one.
    pub bearing: Vec<Bearing>,
    /// Elastic housing; the ring's teeth sit in it. Default: rigid, and no sensors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub housing: Option<Housing>,
    /// Sensors of acceleration on the housing whose signals are written in full, one section each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensor: Vec<Sensor>,
    /// A row of sensors around the housing, for polar maps of indicators.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub around: Option<Around>,
    /// Damaged teeth, one section each. Lists of values make a sweep: the transmission is run healthy and then at every severity, all lists
    /// advancing together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub damage: Vec<Damage>,
    /// Speed, load, steps and record.
    pub run: Run,
    /// How teeth are modelled.
    #[serde(default)]
    pub analysis: Analysis,
    /// Material of the gears.
    #[serde(default)]
    pub material: Material,
    /// Discretisation and solver of the tooth contact.
    #[serde(default)]
    pub contact: Contact,
    /// Integration in time.
    #[serde(default)]
    pub numerics: Numerics,
    /// What is made of the acceleration signals.
    #[serde(default)]
    pub signals: Signals,
    /// What is written.
    #[serde(default)]
    pub output: Output,
}

/// Kinds of case files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Kind {
    /// Vibration of a planetary transmission.
    #[serde(rename = "transmission")]
    Transmission,
}

/// Planets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Train {
    /// Number of planets, equally spaced unless `planet_angles_deg` says otherwise.
    #[schemars(range(min = 1, max = 12))]
    pub planets: u32,
    /// Angle of the first planet at the start (degrees).
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub first_planet_deg: f64,
    /// Angle of the centre line of tooth 0 of the ring (degrees). Planets and sun find their places between the teeth.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub ring_tooth_deg: f64,
    /// Angle near which tooth 0 of the sun is at the start (degrees); the nearest place that fits is taken.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub sun_tooth_deg: f64,
    /// Angles of all planets at the start (degrees), instead of `first_planet_deg` and equal spacing. Those between planets must be
    /// whole multiples of 360 degrees over the teeth of sun and ring together, else the gears cannot be assembled.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planet_angles_deg: Vec<f64>,
    /// Position errors of the planets' pins, outward from the main axis (um), one for each planet. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin_radial_um: Vec<f64>,
    /// Position errors of the planets' pins along the circumference, counter-clockwise (um), one for each planet. A pin that stands ahead carries less.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin_tangential_um: Vec<f64>,
}

/// Mass and inertia of all rigid bodies.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Bodies {
    /// The sun with its shaft and the bevel gear, where there is one. Default: the sun gear as a solid disc, alone.
    pub sun: Body,
    /// One planet. Default: the planet gear as a solid disc.
    pub planet: Body,
    /// The carrier with its pins. Default: a disc as thick as the planets are wide that reaches half a planet's bore beyond their centres.
    pub carrier: Body,
    /// The bevel pinion with its shaft. Required with a bevel stage.
    pub bevel_pinion: Body,
    /// The bevel gear with its shaft. Required where a spline joins it to the sun, else it is part of the sun.
    pub bevel_gear: Body,
}

/// Mass and inertia of a rigid body about its centre of mass.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Body {
    /// Mass (kg).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e9))]
    pub mass_kg: Option<f64>,
    /// Moment of inertia about the body's axis (kg m^2).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-18, max = 1e12))]
    pub inertia_kg_m2: Option<f64>,
    /// Moment of inertia about a diameter (kg m^2).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-18, max = 1e12))]
    pub transverse_inertia_kg_m2: Option<f64>,
    /// Place of the centre of mass along the body's axis (mm): above the gears' mid-face; of a bevel pinion, from the apex outward.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub centre_mm: Option<f64>,
}

/// A bearing: springs and dampers between a body and the housing, or, for a planet, the pin on the carrier. 1e12 N/m is as good as rigid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bearing {
    /// Body that it carries: "sun", "planet" (each on its pin), "carrier", "bevel-pinion" or, where a spline joins it to the sun, "bevel-gear".
    pub on: Supported,
    /// Port of the housing that holds it. Default: the ground, or the pin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port: Option<String>,
    /// Place along the body's axis (mm): above the gears' mid-face; on a bevel pinion, from the apex outward.
    #[serde(default)]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub place_mm: f64,
    /// Stiffness across the axis (N/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub radial_stiffness_n_per_m: f64,
    /// Stiffness along the axis (N/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub axial_stiffness_n_per_m: f64,
    /// Stiffness against tilt of the axis (N m/rad).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub tilt_stiffness_n_m_per_rad: f64,
    /// Damping: force of velocity as this time (s) times the stiffness. Rolling bearings have about 2.5e-6 to 2.5e-5 s (Kraemer,
    /// Dynamics of Rotors and Foundations, 1993).
    #[serde(default = "bearing_damping")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub damping_s: f64,
}

pub(super) fn bearing_damping() -> f64 {
    1e-5
}

/// Bodies on bearings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Supported {
    /// The sun with its shaft.
    Sun,
    /// Every planet.
    Planet,
    /// The carrier.
    Carrier,
    /// The bevel pinion with its shaft.
    BevelPinion,
    /// The bevel gear with its shaft.
    BevelGear,
}

/// A sensor on the housing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// Name, for columns and legends.
    pub name: String,
    /// Angle around the housing (degrees). It senses the radial direction, outward.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub angle_deg: f64,
    /// Height above the gears' mid-face (mm).
    #[serde(default)]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub height_mm: f64,
}

/// A row of sensors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Around {
    /// Angle of the first sensor (degrees).
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub first_deg: f64,
    /// Sensors evenly around, before some are left out. Default: one for each tooth of the ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 2, max = 2000))]
    pub count: Option<u32>,
    /// Stretches without sensors, near supports for instance: angles from, to, from, to, .. (degrees).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub leave_out_deg: Vec<f64>,
    /// Height above the gears' mid-face (mm).
    #[serde(default)]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub height_mm: f64,
}

/// One damage of one tooth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Damage {
    /// Which gear: "sun", "planet" or "ring".
    pub on: Member,
    /// Which planet, counted from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 12))]
    pub planet: Option<u32>,
    /// Tooth number, counted counter-clockwise from tooth 0: `train.ring_tooth_deg` and `train.sun_tooth_deg` say where that is; of a planet it points
    /// most nearly away from the main axis at the start. Give this or `angle_deg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1999))]
    pub tooth: Option<u32>,
    /// Angle at the start (degrees): the tooth of sun or ring nearest to it is damaged. A number, or a list for a sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<Values>,
    /// A root crack, through the whole face or of a length that varies along it. On a planet, "drive" is the flank that the sun loads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crack: Option<Crack>,
    /// A pit on the working flank (3d only).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pit: Option<Pit>,
    /// Material worn off the working flank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wear: Option<Wear>,
    /// A tip corner broken off at one end of the face (3d only).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub broken_corner: Option<BrokenCorner>,
}

/// Gears of the train.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Member {
    /// The sun.
    Sun,
    /// A planet.
    Planet,
    /// The ring.
    Ring,
}

/// What is run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Speed of the input (rpm), prescribed: of the bevel pinion, or without one of the sun.
    #[schemars(range(min = 0.001, max = 1e6))]
    pub speed_rpm: f64,
    /// Torque of the load on the carrier (N m).
    #[schemars(range(min = 1e-3, max = 1e9))]
    pub torque_n_m: f64,
    /// Turns of the carrier recorded. A tooth of the sun meets the same tooth of the ring again after a few of them: `gearwright check` says how
    /// many.
    #[serde(default = "turns")]
    #[schemars(range(min = 1, max = 1000))]
    pub carrier_turns: u32,
    /// Planet passes run before the record, from static equilibrium, until the transient is gone; the summary says what is left of it.
    #[serde(default = "passes")]
    #[schemars(range(min = 0, max = 10000))]
    pub settling_planet_passes: u32,
}

fn turns() -> u32 {
    3
}

/// Two: the remaining transient is measured against a run that is one pass shorter.
fn passes() -> u32 {
    2
}

/// How teeth are modelled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Analysis {
    /// "plane-stress" (thin gears, nothing varying along the face; a table in seconds), "plane-strain" or "3d".
    pub model: Model,
    /// Relative error of the force of a mesh that its table is allowed where tooth pairs join, against the contact model.
    #[schemars(range(min = 1e-6, max = 0.1))]
    pub table_tolerance: f64,
    /// Load up to which tables are made, in mean loads of the mesh; beyond, they go on straight.
    #[schemars(range(min = 1.1, max = 100.0))]
    pub table_load_factor: f64,
    /// Positions of a mesh cycle at which tables are computed; between them force is interpolated. Independent of the time step.
    #[schemars(range(min = 8, max = 10000))]
    pub table_positions: u32,
}

impl Default for Analysis {
    fn default() -> Self {
        Self { model: Model::PlaneStress, table_tolerance: 5e-4, table_load_factor: 4.0, table_positions: 128 }
    }
}

/// Integration in time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Numerics {
    /// Time steps from one sample of the signals to the next. Default: from `signals.band_hz`, such that coupled modes up to the band are moved by less than
    /// 0.02 % in frequency; the summary gives the number and the error that is left.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000))]
    pub steps_per_sample: Option<u32>,
    /// Damping of the teeth in contact: force of approach velocity as this time (s) times the mesh stiffness.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub mesh_damping_s: f64,
}

impl Default for Numerics {
    fn default() -> Self {
        Self { steps_per_sample: None, mesh_damping_s: 2e-6 }
    }
}

/// What is made of the signals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Signals {
    /// Band of all records (Hz): accelerations, forces and loads pass a low-pass of linear phase that is flat to this frequency, and are sampled at 2.56 times it or a
    /// little more, a whole number of samples in a mesh cycle. Files and indicators hold nothing above it but the transition of the filter.
    #[schemars(range(min = 1.0, max = 1e6))]
    pub band_hz: f64,
    /// Most sideband pairs that the approximate difference signals lose: one signal for each number from 0 to this.
    #[schemars(range(min = 0, max = 100))]
    pub sideband_pairs: u32,
}

impl Default for Signals {
    fn default() -> Self {
        Self { band_hz: 10e3, sideband_pairs: 5 }
    }
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Plots as SVG and PNG.
    pub plots: bool,
    /// Signals of the sensors around the housing in full, too, not only their indicators.
    pub around_signals: bool,
    /// Keep mesh tables and the reduced housing beside the results, in `.gearwright-cache`, and take them from there when nothing they depend on
    /// has changed. The folder may be deleted at any time.
    pub cache: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self { plots: true, around_signals: false, cache: true }
    }
}
