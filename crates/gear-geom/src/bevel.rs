//! A pair of spiral bevel gears: cones, ratio, virtual spur gears, and the line along which the teeth press.
//!
//! All sizes are those at the middle of the face. Axes point from the apex of the pitch cones to the backs of the gears, `a_1` of the pinion and `a_2` of the
//! gear, the shaft angle `Sigma` between them.
//!
//! | quantity | formula | source |
//! |---|---|---|
//! | pitch angles | `tan d_1 = sin(Sigma) / (z_2 / z_1 + cos(Sigma))`, `d_2 = Sigma - d_1` | ISO 23509:2016 |
//! | virtual spur gears | `z_v = z / cos d`, transverse section, `tan a_t = tan a_n / cos b` | Tredgold; ISO 10300-1:2014, Annex A |
//! | whole depth, addenda | `h = 2 m cos b` working, `c = 0.21 + 0.29 z_1 cos d_2 / (z_2 cos d_1)` of it the gear's addendum, `h / 8` clearance | ANSI/AGMA 2005-D03 |
//! | normal of the teeth | below | Shigley, *Mechanical Engineering Design*, chapter on bevel gears; Stadtfeld 2014 |
//!
//! At the mean point `P` on the common generatrix `g`, with `t = a_2 x e` (`e` from the gear's axis toward the pinion), `k` normal to both pitch cones, out of the
//! gear, `s = +-1` the sense of the gear about `a_2` and `h = +-1` the hand of its spiral (right: the outer half of a tooth is turned clockwise, seen from the apex):
//!
//! `n = s cos(a_n) (cos(b) t - h sin(b) g) - sin(a_n) k` is the direction of the driving pinion's force on the gear.
//!
//! Pitch cones roll on each other, so both gears' points at `P` have one velocity and the torques of a force along `n` have the ratio of the teeth.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Unit, Vector3};

use crate::error::{GeometryError, GeometryErrors};
use crate::fillet::FilletSpec;
use crate::gear::{Gear, GearSpec, ToothThickness};
use crate::pair::{GearPair, Member};

/// Hand of a spiral.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hand {
    /// The outer half of a tooth is turned counter-clockwise, seen from the apex.
    Left,
    /// Clockwise.
    Right,
}

impl Hand {
    /// `+1` right, `-1` left.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }

    /// Hand of the mate.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// Specification of a spiral bevel pair; the pinion drives.
#[derive(Debug, Clone, PartialEq)]
pub struct BevelSpec {
    /// Teeth of pinion and gear, 6 to 500.
    pub teeth: [u32; 2],
    /// Angle between the axes (rad), 10 to 170 degrees.
    pub shaft_angle: f64,
    /// Transverse module at mid-face (m).
    pub module: f64,
    /// Facewidth along the generatrix (m).
    pub facewidth: f64,
    /// Spiral angle at mid-face (rad), 0 to 50 degrees.
    pub spiral_angle: f64,
    /// Hand of the pinion's spiral.
    pub pinion_hand: Hand,
    /// Normal pressure angle (rad), 14 to 30 degrees.
    pub pressure_angle: f64,
    /// Transverse circular tooth thickness at mid-face of pinion and gear (m).
    pub thickness: [f64; 2],
}

/// Where a pair stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BevelPlacement {
    /// Apex of the pitch cones (m).
    pub apex: Point3<f64>,
    /// From the apex to the back of the gear.
    pub gear_axis: Unit<Vector3<f64>>,
    /// On which side of the gear's axis the pinion is; what is along the axis does not count.
    pub toward_pinion: Vector3<f64>,
    /// Whether the gear turns counter-clockwise about its axis (by the right hand).
    pub gear_turns_positive: bool,
}

/// Where and along what the teeth press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOfAction {
    /// Mean point of the teeth (m).
    pub point: Point3<f64>,
    /// Direction of the pinion's force on the gear.
    pub normal: Unit<Vector3<f64>>,
    /// From the apex to the back of the pinion.
    pub pinion_axis: Unit<Vector3<f64>>,
    /// From the apex to the back of the gear.
    pub gear_axis: Unit<Vector3<f64>>,
    /// Torque about the pinion's and the gear's axis of a unit force on each (m): negative against the pinion's sense, positive about the gear's if that turns so.
    pub arms: [f64; 2],
}

/// A spiral bevel pair whose geometry is sound.
#[derive(Debug, Clone, PartialEq)]
pub struct BevelPair {
    spec: BevelSpec,
    pitch_angles: [f64; 2],
}

impl BevelPair {
    /// Checks a specification.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] for all sizes out of range, thicknesses that leave no backlash among them.
    pub fn new(spec: &BevelSpec) -> Result<Self, GeometryErrors> {
        let degrees = |low: f64, high: f64| (low.to_radians(), high.to_radians(), "rad");
        let [z_1, z_2] = spec.teeth.map(f64::from);
        let ratio = z_2 / z_1;
        let first = spec.shaft_angle.sin().atan2(ratio + spec.shaft_angle.cos());
        let pitch_angles = [first, spec.shaft_angle - first];
        let cone = 0.5 * spec.module * z_1 / first.sin();
        let pitch = PI * spec.module;
        let ranges = [
            ("teeth", z_1, (6.0, 500.0, "teeth of the pinion")),
            ("teeth", z_2, (6.0, 500.0, "teeth of the gear")),
            ("shaft_angle", spec.shaft_angle, degrees(10.0, 170.0)),
            ("module", spec.module, (1e-4, 0.1, "m")),
            ("spiral_angle", spec.spiral_angle, degrees(0.0, 50.0)),
            ("pressure_angle", spec.pressure_angle, degrees(14.0, 30.0)),
            ("facewidth", spec.facewidth, (1e-4, cone, "m (at most the mean cone distance)")),
            ("thickness", spec.thickness[0], (0.1 * pitch, 0.9 * pitch, "m (10 to 90 % of the pitch)")),
            ("thickness", spec.thickness[1], (0.1 * pitch, 0.9 * pitch, "m (10 to 90 % of the pitch)")),
            ("thickness", spec.thickness[0] + spec.thickness[1], (0.0, pitch, "m in sum (the pitch)")),
            // a gear that is no more than a crown gear
            ("shaft_angle", pitch_angles[1], (0.0, 89.9_f64.to_radians(), "rad of pitch angle on the gear")),
        ];
        let faults: Vec<GeometryError> = ranges
            .into_iter()
            .filter(|(_, value, (low, high, _))| !(low..=high).contains(&value))
            .map(|(parameter, value, (low, high, unit))| {
                let allowed = format!("{low:.6} to {high:.6} {unit}");
                GeometryError::OutOfRange { parameter, value, allowed }
            })
            .collect();
        if faults.is_empty() { Ok(Self { spec: spec.clone(), pitch_angles }) } else { Err(GeometryErrors(faults)) }
    }

    /// The specification.
    #[must_use]
    pub fn spec(&self) -> &BevelSpec {
        &self.spec
    }

    /// Pitch angles of pinion and gear (rad).
    #[must_use]
    pub fn pitch_angles(&self) -> [f64; 2] {
        self.pitch_angles
    }

    /// Pitch radii at mid-face of pinion and gear (m).
    #[must_use]
    pub fn mean_radii(&self) -> [f64; 2] {
        self.spec.teeth.map(|teeth| 0.5 * self.spec.module * f64::from(teeth))
    }

    /// Distance of mid-face from the apex (m).
    #[must_use]
    pub fn mean_cone_distance(&self) -> f64 {
        self.mean_radii()[0] / self.pitch_angles[0].sin()
    }

    /// Teeth of the virtual spur gears.
    #[must_use]
    pub fn virtual_teeth(&self) -> [f64; 2] {
        [0, 1].map(|i| f64::from(self.spec.teeth[i]) / self.pitch_angles[i].cos())
    }

    /// Pressure angle in the transverse section at mid-face (rad).
    #[must_use]
    pub fn transverse_pressure_angle(&self) -> f64 {
        (self.spec.pressure_angle.tan() / self.spec.spiral_angle.cos()).atan()
    }

    /// Spiral angle on the base cone, `sin b_b = sin b cos a_n` (rad).
    #[must_use]
    pub fn base_spiral_angle(&self) -> f64 {
        (self.spec.spiral_angle.sin() * self.spec.pressure_angle.cos()).asin()
    }

    /// Mesh cycles by which a section at a distance `y` outward of mid-face (m) is ahead, for a spiral angle that is the same all along the face:
    /// `tan(b) ln(1 + y / R_m) R_m / (pi m)`. Without regard to which end meets first.
    #[must_use]
    pub fn phase_along_face(&self, y: f64) -> f64 {
        let cone = self.mean_cone_distance();
        self.spec.spiral_angle.tan() * cone * (y / cone).ln_1p() / (PI * self.spec.module)
    }

    /// Overlap ratio: mesh cycles between the ends of the face.
    #[must_use]
    pub fn overlap_ratio(&self) -> f64 {
        let half = 0.5 * self.spec.facewidth;
        self.phase_along_face(half) - self.phase_along_face(-half)
    }

    /// Speed of the gear for one of the pinion, in the same unit.
    #[must_use]
    pub fn gear_speed(&self, pinion_speed: f64) -> f64 {
        pinion_speed * f64::from(self.spec.teeth[0]) / f64::from(self.spec.teeth[1])
    }

    /// Mesh frequency (Hz) at a speed of the pinion (rad/s).
    #[must_use]
    pub fn mesh_frequency(&self, pinion_speed: f64) -> f64 {
        pinion_speed.abs() / TAU * f64::from(self.spec.teeth[0])
    }

    /// Backlash along the line of action in the transverse section at mid-face (m).
    #[must_use]
    pub fn transverse_backlash(&self) -> f64 {
        let [t_1, t_2] = self.spec.thickness;
        (PI * self.spec.module - t_1 - t_2) * self.transverse_pressure_angle().cos()
    }

    /// The virtual spur gears in mesh: teeth rounded to whole numbers (base pitch, pressure angle and thicknesses are exact, radii of curvature within
    /// `1 / 2 z_v`), addenda as in the module's header, rims of three modules below the roots.
    ///
    /// # Errors
    /// Tooth forms that cannot be, gears that cannot mesh.
    pub fn virtual_pair(&self) -> Result<GearPair, GeometryErrors> {
        let &BevelSpec { module, spiral_angle, facewidth, thickness, .. } = &self.spec;
        let [d_1, d_2] = self.pitch_angles;
        let [z_1, z_2] = self.spec.teeth.map(f64::from);
        let depth = 2.0 * module * spiral_angle.cos();
        let of_gear = (0.21 + 0.29 * z_1 * d_2.cos() / (z_2 * d_1.cos())) * depth;
        let addenda = [depth - of_gear, of_gear];
        let gears = [0, 1].map(|i| {
            let teeth = self.virtual_teeth()[i].round();
            let reference = 0.5 * module * teeth;
            let root_radius = reference + addenda[i] - 1.125 * depth;
            Gear::new(&GearSpec::standard(teeth as u32, module).with(|spec| {
                spec.pressure_angle = self.transverse_pressure_angle();
                spec.thickness = ToothThickness::AtReference(thickness[i]);
                spec.tip_radius = reference + addenda[i];
                spec.root_radius = root_radius;
                spec.rim_radius = root_radius - 3.0 * module;
                spec.facewidth = facewidth;
                spec.fillet = FilletSpec::Rack { tip_radius: 0.125 * depth };
                spec.tip_round = 0.03 * module;
            }))
        });
        let [pinion, gear] = gears;
        let (pinion, gear) = (pinion?, gear?);
        let distance = 0.5 * module * f64::from(pinion.teeth() + gear.teeth());
        GearPair::new(pinion, gear, distance)
    }

    /// Where the teeth press, and along what.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] for a pinion in the direction of the gear's axis, and for numbers that are none.
    pub fn line_of_action(&self, placement: &BevelPlacement) -> Result<LineOfAction, GeometryErrors> {
        let a_2 = placement.gear_axis.into_inner();
        let across = placement.toward_pinion - a_2 * placement.toward_pinion.dot(&a_2);
        let reach = across.norm();
        let is_finite = placement.apex.coords.iter().chain(a_2.iter()).all(|value| value.is_finite());
        if !(is_finite && reach > 1e-9 * placement.toward_pinion.norm() && reach.is_finite()) {
            let allowed = "finite numbers, a direction to the pinion that is not the gear's axis".into();
            return Err(GeometryError::OutOfRange { parameter: "toward_pinion", value: reach, allowed }.into());
        }
        let e = across / reach;
        let turned = |angle: f64| a_2 * angle.cos() + e * angle.sin();
        let (a_1, g) = (turned(self.spec.shaft_angle), turned(self.pitch_angles[1]));
        let (t, k) = (a_2.cross(&e), turned(self.pitch_angles[1] + 0.5 * PI));
        let s = if placement.gear_turns_positive { 1.0 } else { -1.0 };
        let h = self.spec.pinion_hand.other().sign();
        let (a_n, b) = (self.spec.pressure_angle, self.spec.spiral_angle);
        let normal = (t * b.cos() - g * (h * b.sin())) * (s * a_n.cos()) - k * a_n.sin();
        let from_apex = g * self.mean_cone_distance();
        let arm = |axis: &Vector3<f64>, force: Vector3<f64>| axis.dot(&from_apex.cross(&force));
        Ok(LineOfAction {
            point: placement.apex + from_apex,
            normal: Unit::new_normalize(normal),
            pinion_axis: Unit::new_normalize(a_1),
            gear_axis: placement.gear_axis,
            arms: [arm(&a_1, -normal), arm(&a_2, normal)],
        })
    }

    /// Teeth of a gear.
    #[must_use]
    pub fn teeth(&self, member: Member) -> u32 {
        match member {
            Member::Pinion => self.spec.teeth[0],
            Member::Wheel => self.spec.teeth[1],
        }
    }
}
