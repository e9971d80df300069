//! The case file as written: keys, units, ranges, defaults.
//!
//! The doc comment of a field is the only documentation of its key: the JSON schema, `gearwright explain`, the comments of
//! `gearwright init` and the reference page all derive from it. Ranges stand in the `schemars` attributes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A spur gear pair: contact statics over the mesh cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpurPair {
    /// What the file describes.
    pub kind: Kind,
    /// A line for headings of plots and reports.
    #[serde(default)]
    pub title: String,
    /// What both gears share.
    pub mesh: Mesh,
    /// The driving gear; its hub is held while the other closes on it.
    pub pinion: Gear,
    /// The driven gear; it carries the torque.
    pub gear: Gear,
    /// Load.
    pub load: Load,
    /// What is computed.
    #[serde(default)]
    pub analysis: Analysis,
    /// Damaged teeth, one section each: a root crack or a pit. Lists of values make a sweep: the pair is computed healthy and then for every
    /// severity, all lists advancing together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub damage: Vec<Damage>,
    /// Material of both gears.
    #[serde(default)]
    pub material: Material,
    /// Discretisation and solver. The defaults are at the knee of error against run time (`cargo xtask work-precision statics`).
    #[serde(default)]
    pub numerics: Numerics,
    /// What is written.
    #[serde(default)]
    pub output: Output,
}

/// Kinds of case files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Kind {
    /// A spur gear pair.
    #[serde(rename = "spur-pair")]
    SpurPair,
}

/// What both gears share.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    /// Module: reference diameter per tooth (mm).
    #[schemars(range(min = 0.01, max = 1000.0))]
    pub module_mm: f64,
    /// Transverse pressure angle at the reference circle (degrees).
    #[schemars(range(min = 10.0, max = 35.0))]
    pub pressure_angle_deg: f64,
    /// Operating centre distance (mm).
    #[schemars(range(min = 0.001, max = 100000.0))]
    pub centre_distance_mm: f64,
}

/// One gear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// Whether teeth point outward ("external") or inward ("internal", a ring). Default: outward, those of a `ring` inward.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<Form>,
    /// Number of teeth.
    #[schemars(range(min = 6, max = 2000))]
    pub teeth: u32,
    /// Circular tooth thickness at the reference circle (mm). Give this or `profile_shift`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0001, max = 3000.0))]
    pub tooth_thickness_mm: Option<f64>,
    /// Profile-shift coefficient `x`: thickness `module (pi/2 + 2 x tan(pressure angle))`; of a ring it is the tooth space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -2.0, max = 2.0))]
    pub profile_shift: Option<f64>,
    /// Tip diameter (mm).
    #[schemars(range(min = 0.001, max = 200000.0))]
    pub tip_diameter_mm: f64,
    /// Root diameter (mm).
    #[schemars(range(min = 0.001, max = 200000.0))]
    pub root_diameter_mm: f64,
    /// Diameter of the bore; for a ring its outside diameter (mm).
    #[schemars(range(min = 0.001, max = 200000.0))]
    pub bore_diameter_mm: f64,
    /// Facewidth (mm). Both gears are centred at mid-face.
    #[schemars(range(min = 0.01, max = 10000.0))]
    pub facewidth_mm: f64,
    /// Radius of the round between flank and tip circle (mm). A sharp edge has no normal, so corner contact needs one; default 0.02 modules.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 500.0))]
    pub tip_round_mm: Option<f64>,
    /// Root fillet.
    #[serde(default)]
    pub fillet: Fillet,
    /// What holds the gear at its bore.
    #[serde(default)]
    pub hub: Hub,
    /// Flank modifications of all teeth; default: plain involutes.
    #[serde(default)]
    pub modification: Modification,
}

/// External or internal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// Teeth point outward.
    #[default]
    External,
    /// Teeth point inward.
    Internal,
}

/// Root fillet.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fillet {
    /// How it is made: "rack" (trochoid; external gears), "shaper" (trochoid; rings), "circular" (arc). Default: rack or shaper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<FilletShape>,
    /// Radius of the tool's tip corner, or of the arc (mm); default 0.38 modules (ISO 53 profile A), 0.2 for a shaper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0001, max = 1000.0))]
    pub radius_mm: Option<f64>,
    /// Teeth of the shaper cutter; default a quarter of the ring's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 6, max = 1000))]
    pub cutter_teeth: Option<u32>,
    /// Addendum of the shaper cutter over its reference circle (modules); default 1.25.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.1, max = 3.0))]
    pub cutter_addendum_modules: Option<f64>,
}

/// Fillet shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FilletShape {
    /// Trochoid of a rack.
    Rack,
    /// Trochoid of a shaper cutter.
    Shaper,
    /// Arc.
    Circular,
}

/// What holds the bore.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hub {
    /// "rigid" (bonded to a rigid hub), "elastic" (the same through springs), "tractions" (no hub; the torque is spread over the bore).
    #[serde(default)]
    pub condition: HubCondition,
    /// Spring stiffness per area of an elastic hub (N/mm^3).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e12))]
    pub stiffness_n_per_mm3: Option<f64>,
}

/// Bore conditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HubCondition {
    /// Bonded to a rigid hub.
    #[default]
    Rigid,
    /// On springs.
    Elastic,
    /// Uniform tractions.
    Tractions,
}

/// Flank modifications: material removed along the normal.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Modification {
    /// Tip relief at the tip circle (um).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10000.0))]
    pub tip_relief_um: f64,
    /// Roll angle at which tip relief begins (degrees). Required with `tip_relief_um`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 180.0))]
    pub tip_relief_start_deg: Option<f64>,
    /// Growth of tip relief: "linear" or "parabolic".
    #[serde(default)]
    pub tip_relief_shape: ReliefShape,
    /// Root relief at the start of the involute (um).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10000.0))]
    pub root_relief_um: f64,
    /// Roll angle at which root relief begins (degrees). Required with `root_relief_um`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 180.0))]
    pub root_relief_start_deg: Option<f64>,
    /// Growth of root relief: "linear" or "parabolic".
    #[serde(default)]
    pub root_relief_shape: ReliefShape,
    /// Symmetric parabolic lead crown, at the ends of the face (um).
    #[serde(default)]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub lead_crown_um: f64,
    /// End relief at the ends of the face (um).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10000.0))]
    pub end_relief_um: f64,
    /// Length of the relieved part at each end of the face (mm). Required with `end_relief_um`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0001, max = 10000.0))]
    pub end_relief_length_mm: Option<f64>,
    /// Growth of end relief: "linear" or "parabolic".
    #[serde(default)]
    pub end_relief_shape: ReliefShape,
    /// Lead slope: removed at one end of the face more than at the other (um).
    #[serde(default)]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub lead_slope_um: f64,
    /// Pitch error of each tooth, from tooth 0 on: material removed from its flank (um). A shorter list repeats.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pitch_errors_um: Vec<f64>,
    /// CSV table of measured deviation, beside the case file: the first row holds face positions (mm, 0 at mid-face) from its second column on,
    /// each further row a roll angle (degrees) and the material removed (um).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation_table: Option<String>,
}

/// Growth of a relief.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReliefShape {
    /// In proportion to the distance.
    #[default]
    Linear,
    /// With its square.
    Parabolic,
}

/// Load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Torque on the gear (N m).
    #[schemars(range(min = 0.0, max = 1e12))]
    pub torque_n_m: f64,
    /// Also a force-deflection map: this many torques, evenly spaced up to `torque_n_m`. 0 for none.
    #[serde(default)]
    #[schemars(range(min = 0, max = 10000))]
    pub map_torques: u32,
    /// Smallest torque of the map (N m); default 0.1 % of `torque_n_m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12))]
    pub map_from_n_m: Option<f64>,
}

/// What is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Analysis {
    /// "3d", "plane-stress" (thin gears, nothing varying along the face) or "plane-strain" (wide gears).
    pub model: Model,
    /// First mesh cycle. One mesh cycle is one base pitch of rotation; tooth pair 0 touches at the pitch point at `mesh_cycle_origin`.
    #[schemars(range(min = -100000.0, max = 100000.0))]
    pub mesh_cycle_from: f64,
    /// Last mesh cycle (included when it is not a whole number of cycles after the first).
    #[schemars(range(min = -100000.0, max = 100000.0))]
    pub mesh_cycle_to: f64,
    /// Positions per mesh cycle.
    #[schemars(range(min = 1, max = 100000))]
    pub positions_per_cycle: u32,
    /// Mesh cycle at which tooth pair 0 touches at the pitch point.
    #[schemars(range(min = -100000.0, max = 100000.0))]
    pub mesh_cycle_origin: f64,
    /// Also the local stiffness from torques above and below (`slope_step_percent`), beside the exact tangent, which is a stair as cells join the
    /// contact one by one.
    pub stiffness_by_differences: bool,
}

impl Default for Analysis {
    fn default() -> Self {
        Self {
            model: Model::Solid,
            mesh_cycle_from: 0.0,
            mesh_cycle_to: 1.0,
            positions_per_cycle: 50,
            mesh_cycle_origin: 0.0,
            stiffness_by_differences: true,
        }
    }
}

/// Model along the face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Three-dimensional.
    #[default]
    #[serde(rename = "3d")]
    Solid,
    /// Plane stress.
    PlaneStress,
    /// Plane strain.
    PlaneStrain,
}

/// One damage of one tooth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Damage {
    /// Which gear: "pinion" or "gear".
    pub on: Member,
    /// Tooth number; tooth 0 of either gear belongs to tooth pair 0, pinion teeth count backward and gear teeth forward from pair to pair.
    #[serde(default)]
    #[schemars(range(min = 0, max = 1999))]
    pub tooth: u32,
    /// A root crack, through the whole face or of a length that varies along it.
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

/// Wear of one tooth: the same depth all over its flank, or a table. Wear of all teeth alike is a `modification.deviation_table`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wear {
    /// Depth all over the flank (um); a number, or a list for a sweep. Give this or `table`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth_um: Option<Values>,
    /// CSV file of depths (um), none negative, in the format of `modification.deviation_table`: face positions (mm) in the first row, roll
    /// angles (degrees) in the first column. A single face position holds all along the face (and for plane models).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<String>,
    /// Factor on the depths of the table; a number, or a list for a sweep. Default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Values>,
}

/// A broken tip corner: what a plane cuts off that meets the tip `length_mm` from the end of the face and both flanks, at the end, `height_mm`
/// below the tip. Nothing touches there any more; the tooth keeps the stiffness of what is missing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BrokenCorner {
    /// End of the face: "positive" or "negative" face positions.
    #[serde(default)]
    pub face_end: FaceEnd,
    /// Missing length of the tip along the face (mm); a number, or a list for a sweep.
    pub length_mm: Values,
    /// Missing height of the profile at the end of the face, arc length from the tip (mm); a number, or a list for a sweep.
    pub height_mm: Values,
}

/// An end of the face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaceEnd {
    /// At positive face positions.
    #[default]
    Positive,
    /// At negative face positions.
    Negative,
}

/// Gears of the pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Member {
    /// The driving gear.
    Pinion,
    /// The driven gear.
    Gear,
}

/// A root crack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Crack {
    /// Length in percent of the chord from fillet to fillet below the tooth, 0 to 97, or of the path, if points give one; a number, or a list for a
    /// sweep. Give this or `length_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_percent: Option<Values>,
    /// Length (mm); a number, or a list for a sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_mm: Option<Values>,
    /// Flank at whose fillet it starts: "drive" carries the load, and the crack opens; under "coast" the crack closes and its faces press on each
    /// other.
    #[serde(default)]
    pub side: CrackSide,
    /// Angle between the fillet's tangent at the start and the tooth's centre line (degrees; ISO 6336's critical section has 30); default:
    /// the middle of the fillet's turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 90.0))]
    pub start_tangent_deg: Option<f64>,
    /// Radius at which it starts on the fillet, instead of a tangent (mm); a place at roll distance s lies at the root of s^2 and the base radius
    /// squared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub start_radius_mm: Option<f64>,
    /// Angle between the crack and the tooth's centre line, toward the axis (degrees; 90 is straight across); default: along the chord.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 120.0))]
    pub direction_deg: Option<f64>,
    /// A path of its own instead of a direction: points, from the start across the tooth (mm), joined by a smooth curve together with
    /// `path_inward_mm`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub path_across_mm: Vec<f64>,
    /// The same points, from the start toward the gear's axis (mm; for internal teeth away from it).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub path_inward_mm: Vec<f64>,
    /// How the length varies along the face: percent of the length above at the places of `front_face_mm`, straight lines between them; two values
    /// without places are those at the negative and at the positive end of the face. `[0.0, 100.0]` is a crack from the positive end to nothing at the other.
    /// Needs `analysis.model = "3d"`; default: the same all along.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub front_percent: Vec<f64>,
    /// Face positions of `front_percent` (mm, 0 at mid-face), ascending; level beyond the first and the last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub front_face_mm: Vec<f64>,
}

/// Side of a tooth at which a crack starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CrackSide {
    /// The loaded flank.
    #[default]
    Drive,
    /// The other flank.
    Coast,
}

/// A pit: an ellipse or a polygon. Positions along the profile are roll distances, measured along the line of action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pit {
    /// Landmark at which an ellipse is centred: "sap", "lpstc", "pitch", "hpstc", "eap" (of its own gear). Give this or `roll_distance_mm`;
    /// default pitch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<LandmarkName>,
    /// Roll distance of the centre (mm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 10000.0))]
    pub roll_distance_mm: Option<f64>,
    /// Face position of the centre (mm, 0 at mid-face).
    #[serde(default)]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub face_mm: f64,
    /// Full width along the face (mm); a number, or a list for a sweep. Required for an ellipse.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_mm: Option<Values>,
    /// Full height along the profile (mm); a number, or a list for a sweep. Required for an ellipse.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_mm: Option<Values>,
    /// What `height_mm` is measured along: "flank" (arc length on the tooth) or "line-of-action" (roll distance).
    #[serde(default)]
    pub height_along: HeightAlong,
    /// Face positions of the corners of a polygon (mm), instead of an ellipse.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub corners_face_mm: Vec<f64>,
    /// Roll distances of the corners of a polygon (mm).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub corners_roll_distance_mm: Vec<f64>,
    /// Depth (um); default: no contact inside, whatever the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 100000.0))]
    pub depth_um: Option<f64>,
}

/// What the height of a pit is measured along.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HeightAlong {
    /// Arc length on the flank.
    #[default]
    Flank,
    /// Roll distance.
    LineOfAction,
}

/// Landmarks of a flank.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LandmarkName {
    /// Start of active profile.
    Sap,
    /// Lowest point of single-tooth contact.
    Lpstc,
    /// Pitch point.
    Pitch,
    /// Highest point of single-tooth contact.
    Hpstc,
    /// End of active profile.
    Eap,
}

/// A number, or a list of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Values {
    /// The same at every severity.
    One(f64),
    /// One for each severity.
    Each(Vec<f64>),
}

impl JsonSchema for Values {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Values".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": ["number", "array"], "items": { "type": "number" } })
    }
}

/// Material of both gears.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Material {
    /// Young's modulus (GPa).
    #[schemars(range(min = 1e-6, max = 10000.0))]
    pub young_modulus_gpa: f64,
    /// Poisson's ratio.
    #[schemars(range(min = -0.9, max = 0.49))]
    pub poisson_ratio: f64,
    /// Density (kg/m^3); statics do not use it.
    #[schemars(range(min = 1e-3, max = 100000.0))]
    pub density_kg_per_m3: f64,
}

impl Default for Material {
    fn default() -> Self {
        Self { young_modulus_gpa: 200.0, poisson_ratio: 0.3, density_kg_per_m3: 7800.0 }
    }
}

/// Discretisation and solver.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Numerics {
    /// Polynomial order of the finite elements in the plane.
    #[schemars(range(min = 1, max = 8))]
    pub element_order: u32,
    /// Scale of the number of elements along every edge.
    #[schemars(range(min = 0.2, max = 10.0))]
    pub mesh_density: f64,
    /// Highest polynomial order along the face (3d).
    #[schemars(range(min = 1, max = 40))]
    pub face_order: u32,
    /// Contact cells along the face (3d).
    #[schemars(range(min = 1, max = 400))]
    pub face_cells: u32,
    /// Contact cells per Hertz half width along the profile.
    #[schemars(range(min = 1.0, max = 100.0))]
    pub cells_per_half_width: f64,
    /// Highest polynomial order along the profile in which the finite elements complete the half-space.
    #[schemars(range(min = 2, max = 24))]
    pub profile_order: u32,
    /// Correct the half-space at the free ends of the face by mirror loads (3d).
    pub edge_correction: bool,
    /// Change of torque either way for the local stiffness by differences (percent). Small steps see the stair of single cells, 10 the slope.
    #[schemars(range(min = 0.01, max = 30.0))]
    pub slope_step_percent: f64,
    /// Faces of a crack that close press on each other; otherwise they pass through each other freely.
    pub crack_face_contact: bool,
    /// Contact solver: "active-set" (fast) or "lemke" (reference).
    pub solver: Solver,
}

impl Default for Numerics {
    fn default() -> Self {
        let defaults = fecm::PairModelOptions::default();
        let fecm::FaceModel::Solid { order } = defaults.face else { return Self::plane_defaults() };
        Self { face_order: order as u32, ..Self::plane_defaults() }
    }
}

impl Numerics {
    fn plane_defaults() -> Self {
        let defaults = fecm::PairModelOptions::default();
        Self {
            element_order: defaults.pinion.mesh.order as u32,
            mesh_density: defaults.pinion.mesh.density,
            face_order: 1,
            face_cells: defaults.contact.face_cells as u32,
            cells_per_half_width: defaults.contact.cells_per_half_width,
            profile_order: defaults.contact.profile_order as u32,
            edge_correction: defaults.contact.edge_correction,
            slope_step_percent: 100.0 * defaults.contact.slope_step,
            crack_face_contact: defaults.contact.crack_face_contact,
            solver: Solver::ActiveSet,
        }
    }
}

/// Contact solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// Block principal pivoting.
    #[default]
    ActiveSet,
    /// Complementary pivoting.
    Lemke,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Plots as SVG and PNG.
    pub plots: bool,
    /// Meshes, deformed shape and pressure as VTU files.
    pub vtu: bool,
    /// Mesh cycle of the deformed shape and the pressure map; default: the largest transmission error.
    #[schemars(range(min = -100000.0, max = 100000.0))]
    pub snapshot_mesh_cycle: Option<f64>,
    /// Stress at the roots of the loaded teeth at every position: columns of the series, a plot, a line of the summary.
    pub root_stress: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self { plots: true, vtu: true, snapshot_mesh_cycle: None, root_stress: false }
    }
}
