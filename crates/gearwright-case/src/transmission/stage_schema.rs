//! The bevel stage and the housing, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Spiral bevel stage. Sizes are those at the middle of the face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bevel {
    /// Teeth of the pinion, which drives.
    #[schemars(range(min = 6, max = 500))]
    pub pinion_teeth: u32,
    /// Teeth of the gear on the sun's shaft.
    #[schemars(range(min = 6, max = 500))]
    pub gear_teeth: u32,
    /// Angle between the axes, from the backs of both gears (degrees).
    #[schemars(range(min = 10.0, max = 170.0))]
    pub shaft_angle_deg: f64,
    /// Transverse module at mid-face (mm).
    #[schemars(range(min = 0.1, max = 100.0))]
    pub module_mm: f64,
    /// Facewidth along the cone (mm).
    #[schemars(range(min = 0.1, max = 10000.0))]
    pub facewidth_mm: f64,
    /// Spiral angle at mid-face (degrees).
    #[schemars(range(min = 0.0, max = 50.0))]
    pub spiral_angle_deg: f64,
    /// Hand of the pinion's spiral: "left" or "right".
    #[serde(default)]
    pub pinion_hand: Hand,
    /// Normal pressure angle (degrees).
    #[serde(default = "pressure_angle")]
    #[schemars(range(min = 14.0, max = 30.0))]
    pub pressure_angle_deg: f64,
    /// Transverse circular tooth thickness of the pinion (mm).
    #[schemars(range(min = 0.01, max = 1000.0))]
    pub pinion_thickness_mm: f64,
    /// Transverse circular tooth thickness of the gear (mm).
    #[schemars(range(min = 0.01, max = 1000.0))]
    pub gear_thickness_mm: f64,
    /// Crowning: by how much both ends of the face stand back (um).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10000.0))]
    pub crown_um: f64,
    /// Slices along the face.
    #[serde(default = "slices")]
    #[schemars(range(min = 1, max = 1000))]
    pub slices: u32,
    /// Angle of the pinion's axis around the housing (degrees).
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub pinion_at_deg: f64,
    /// Height above the gears' mid-face of the apex, where the axes meet (mm).
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub apex_mm: f64,
    /// Whether the back of the gear faces "down" (teeth upward) or "up".
    #[serde(default)]
    pub gear_back: Facing,
    /// A spline that joins the gear to the sun. Default: they are one body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spline: Option<Spline>,
}

fn pressure_angle() -> f64 {
    20.0
}

fn slices() -> u32 {
    21
}

/// Hand of a spiral.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Hand {
    /// Left.
    #[default]
    Left,
    /// Right.
    Right,
}

/// Where the back of a gear faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Facing {
    /// Against the main axis.
    #[default]
    Down,
    /// Along it.
    Up,
}

/// A spline between the bevel gear's shaft and the sun.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spline {
    /// Height above the gears' mid-face (mm).
    #[serde(default)]
    #[schemars(range(min = -10000.0, max = 10000.0))]
    pub place_mm: f64,
    /// Stiffness against twist (N m/rad).
    #[schemars(range(min = 1e-3, max = 1e18))]
    pub torsional_stiffness_n_m_per_rad: f64,
    /// Stiffness across the axis (N/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub radial_stiffness_n_per_m: f64,
    /// Stiffness along the axis (N/m).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub axial_stiffness_n_per_m: f64,
    /// Stiffness against tilt (N m/rad).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e18))]
    pub tilt_stiffness_n_m_per_rad: f64,
    /// Damping: force of velocity as this time (s) times the stiffness.
    #[serde(default = "super::schema::bearing_damping")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub damping_s: f64,
}

/// Elastic housing: without further keys one of the size of a light helicopter's main transmission. A casing of your own is a wall of revolution,
/// given by points of its middle, with a ring, mounts, swellings and an input port; or give a finite-element `mesh`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Housing {
    /// Finite-element mesh of your own, beside the case file: Abaqus or CalculiX input. Mounts, ports and the ring's seat are its node sets; their names
    /// are in lower case here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    /// Units of the mesh file: "si" (m, Pa, kg/m^3) or "millimetre" (mm, MPa, t/mm^3).
    pub mesh_units: MeshUnits,
    /// Node set of a mesh of your own on which the ring's teeth sit: on a circle about the main axis.
    pub ring_seat: String,
    /// Highest harmonic of the angle with which the ring's seat deforms.
    #[schemars(range(min = 1, max = 200))]
    pub seat_harmonics: u32,
    /// Radii of the points of the wall's middle, from the lower hub outward, up, and inward to the upper hub (mm).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wall_radius_mm: Vec<f64>,
    /// Heights of the same points above the gears' mid-face (mm).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wall_height_mm: Vec<f64>,
    /// Thickness of the wall there (mm).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wall_thickness_mm: Vec<f64>,
    /// Segment of the wall, from point so many (counted from 1) to the next, that holds the ring over its full height.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000))]
    pub ring_segment: Option<u32>,
    /// Inner diameter of the ring without its teeth (mm). Default: its root diameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 200000.0))]
    pub ring_inner_diameter_mm: Option<f64>,
    /// Mounts that hold it to the ground. Given ones replace those of the default housing; so with the lists below.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mount: Vec<Mount>,
    /// Bearings in hubs: ports for `bearing.port`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub port: Vec<Port>,
    /// Ribs, bosses and pads on the outside.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub swelling: Vec<Swelling>,
    /// Input port: a boss around an opening, with ports for the pinion's bearings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<Input>,
    /// Young's modulus of the casing (GPa); default aluminium, 71. A mesh of your own has its own materials.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 10000.0))]
    pub young_modulus_gpa: Option<f64>,
    /// Poisson's ratio of the casing; default 0.33.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -0.9, max = 0.49))]
    pub poisson_ratio: Option<f64>,
    /// Density of the casing (kg/m^3); default 2770.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 100000.0))]
    pub density_kg_per_m3: Option<f64>,
    /// Longest element of the casing (mm).
    #[schemars(range(min = 0.1, max = 10000.0))]
    pub element_size_mm: f64,
    /// Damping ratio of every mode.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub damping_ratio: f64,
    /// Modes above this frequency (Hz) are kept as static response only.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub highest_frequency_hz: f64,
    /// Modes kept at most.
    #[schemars(range(min = 1, max = 5000))]
    pub modes: u32,
}

impl Default for Housing {
    fn default() -> Self {
        let options = planetary::housing::ReductionOptions::default();
        Self {
            mesh: None,
            mesh_units: MeshUnits::Si,
            ring_seat: planetary::housing::casing::RING_SEAT.into(),
            seat_harmonics: 20,
            wall_radius_mm: Vec::new(),
            wall_height_mm: Vec::new(),
            wall_thickness_mm: Vec::new(),
            ring_segment: None,
            ring_inner_diameter_mm: None,
            mount: Vec::new(),
            port: Vec::new(),
            swelling: Vec::new(),
            input: None,
            young_modulus_gpa: None,
            poisson_ratio: None,
            density_kg_per_m3: None,
            element_size_mm: 20.0,
            damping_ratio: 0.02,
            highest_frequency_hz: options.highest_frequency,
            modes: options.modes as u32,
        }
    }
}

/// Units of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MeshUnits {
    /// m, N, Pa, kg.
    #[default]
    Si,
    /// mm, N, MPa, t.
    Millimetre,
}

/// A mount: a patch of the outside on springs to the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mount {
    /// Name; of a mesh of your own, its node set.
    pub name: String,
    /// Angle of its middle (degrees); not with a mesh of your own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub angle_deg: Option<f64>,
    /// Angle that it takes (degrees); not with a mesh of your own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 360.0))]
    pub width_deg: Option<f64>,
    /// First segment of the wall that it covers, counted from 1; not with a mesh of your own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000))]
    pub first_segment: Option<u32>,
    /// Last segment; default: the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000))]
    pub last_segment: Option<u32>,
    /// Stiffness of the whole mount along the radius (N/m).
    #[schemars(range(min = 0.0, max = 1e18))]
    pub radial_stiffness_n_per_m: f64,
    /// Along the circumference (N/m).
    #[schemars(range(min = 0.0, max = 1e18))]
    pub tangential_stiffness_n_per_m: f64,
    /// Along the main axis (N/m).
    #[schemars(range(min = 0.0, max = 1e18))]
    pub axial_stiffness_n_per_m: f64,
}

/// A place where a bearing sits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Port {
    /// Name; of a mesh of your own, its node set.
    pub name: String,
    /// Segment of the wall that carries it on its inside, counted from 1; not with a mesh of your own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000))]
    pub segment: Option<u32>,
}

/// Extra thickness outside: `thickness cos^2` in angle and along the wall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Swelling {
    /// Angle of its middle (degrees).
    #[schemars(range(min = -360.0, max = 360.0))]
    pub angle_deg: f64,
    /// Angle over which it is more than half as thick (degrees).
    #[schemars(range(min = 0.001, max = 360.0))]
    pub width_deg: f64,
    /// Length along the wall's middle from its first point to the swelling's middle (mm).
    #[schemars(range(min = 0.0, max = 100000.0))]
    pub along_mm: f64,
    /// Length over which it is more than half as thick (mm).
    #[schemars(range(min = 0.001, max = 100000.0))]
    pub length_mm: f64,
    /// Greatest extra thickness (mm).
    #[schemars(range(min = 0.0, max = 10000.0))]
    pub thickness_mm: f64,
}

/// The input port.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Segment of the wall that it takes over its full height, counted from 1.
    #[schemars(range(min = 1, max = 1000))]
    pub segment: u32,
    /// Angle of its middle (degrees).
    #[schemars(range(min = -360.0, max = 360.0))]
    pub angle_deg: f64,
    /// Angle it takes, walls included (degrees).
    #[schemars(range(min = 0.001, max = 180.0))]
    pub width_deg: f64,
    /// Thickness of the boss's walls (mm).
    #[schemars(range(min = 0.001, max = 10000.0))]
    pub thickness_mm: f64,
    /// Rise of the pinion's axis, outward, over the level (degrees).
    #[serde(default)]
    #[schemars(range(min = -60.0, max = 60.0))]
    pub elevation_deg: f64,
    /// Ports for the pinion's bearings, from the inside out.
    pub port: Vec<InputBearing>,
}

/// A bearing of the pinion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputBearing {
    /// Name of the port.
    pub name: String,
    /// Where it begins: distance along the pinion's axis from the main axis (mm).
    #[schemars(range(min = 0.001, max = 100000.0))]
    pub from_mm: f64,
    /// Where it ends (mm).
    #[schemars(range(min = 0.001, max = 100000.0))]
    pub to_mm: f64,
}
