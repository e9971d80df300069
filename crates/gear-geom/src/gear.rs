//! One gear: its specification, the checks, and the sizes that follow.

use nalgebra::{Point2, Vector2};

use crate::error::{GeometryError, GeometryErrors};
use crate::fillet::{Fillet, FilletSpec};
use crate::involute::{inverse_involute, involute, involute_at_roll, radius_at_roll, roll_distance};
use crate::modification::FlankModification;
use crate::outline::HalfToothOutline;

/// External gear, or internal (ring).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GearKind {
    /// Teeth point away from the axis.
    #[default]
    External,
    /// Teeth point toward the axis.
    Internal,
}

impl GearKind {
    /// `+1` external, `-1` internal: the sign of involute terms.
    #[must_use]
    pub fn sigma(self) -> f64 {
        match self {
            Self::External => 1.0,
            Self::Internal => -1.0,
        }
    }
}

/// The two flanks of a tooth in the gear's own frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlankSide {
    /// At `theta < 0`.
    Lower,
    /// At `theta > 0`.
    Upper,
}

impl FlankSide {
    /// `-1` lower, `+1` upper.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Lower => -1.0,
            Self::Upper => 1.0,
        }
    }

    /// The flank on the other side of the tooth.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Lower => Self::Upper,
            Self::Upper => Self::Lower,
        }
    }
}

/// Tooth thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ToothThickness {
    /// Profile-shift coefficient `x`: `s = m (pi / 2 + 2 x tan(alpha))` for external gears; for a ring the same is its tooth space.
    ProfileShift(f64),
    /// Circular thickness at the reference circle (m).
    AtReference(f64),
}

/// Specification of a gear, SI units.
///
/// Begin with [`GearSpec::standard`], which scales every size with the module, then set what differs. Teeth and module are fixed from there
/// on, so that no size of another module can be left behind:
///
/// ```
/// use gear_geom::{Gear, GearSpec, ToothThickness};
///
/// let mut spec = GearSpec::standard(27, 5e-3);
/// spec.facewidth = 30e-3;
/// spec.thickness = ToothThickness::ProfileShift(0.1);
/// let gear = Gear::new(&spec)?;
/// assert!((gear.tip_radius() - (67.5e-3 + 5e-3)).abs() < 1e-12);
/// # Ok::<(), gear_geom::GeometryErrors>(())
/// ```
///
/// ```compile_fail
/// // a gear of module 5 mm with the fillet of module 6 mm cannot be written
/// let spec = gear_geom::GearSpec { module: 5e-3, ..gear_geom::GearSpec::standard(25, 6e-3) };
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GearSpec {
    pub(crate) teeth: u32,
    pub(crate) module: f64,
    /// External or internal.
    pub kind: GearKind,
    /// Transverse pressure angle at the reference circle (rad), 10 to 35 degrees.
    pub pressure_angle: f64,
    /// Tooth thickness.
    pub thickness: ToothThickness,
    /// Radius of the tip circle (m).
    pub tip_radius: f64,
    /// Radius of the root circle (m).
    pub root_radius: f64,
    /// Radius of the bore (external) or of the outside (ring) (m).
    pub rim_radius: f64,
    /// Facewidth (m).
    pub facewidth: f64,
    /// Fillet.
    pub fillet: FilletSpec,
    /// Radius of the round between flank and tip circle (m), 0 or more.
    pub tip_round: f64,
    /// Modifications of all flanks.
    pub modification: FlankModification,
    /// Pitch error of each tooth: material removed from its flank (m). Empty for none; teeth beyond its end repeat it.
    pub pitch_errors: Vec<f64>,
}

impl GearSpec {
    /// External gear of `teeth` teeth (6 to 2000) and `module` (m, reference diameter per tooth) with the basic rack of ISO 53 profile A:
    /// 20 degrees, addendum 1, dedendum 1.25 and tool tip radius 0.38 modules, no profile shift.
    ///
    /// ISO 53 says nothing of the rest: facewidth 10 modules, bore 0.4 of the reference circle, tip round 0.02 modules, no modifications.
    #[must_use]
    pub fn standard(teeth: u32, module: f64) -> Self {
        let reference = 0.5 * module * f64::from(teeth);
        Self {
            teeth,
            module,
            kind: GearKind::External,
            pressure_angle: 20_f64.to_radians(),
            thickness: ToothThickness::ProfileShift(0.0),
            tip_radius: reference + module,
            root_radius: reference - 1.25 * module,
            rim_radius: 0.4 * reference,
            facewidth: 10.0 * module,
            fillet: FilletSpec::Rack { tip_radius: 0.38 * module },
            tip_round: 0.02 * module,
            modification: FlankModification::default(),
            pitch_errors: Vec::new(),
        }
    }

    /// Ring (internal gear) of the same rack: tooth space of the external gear, tips 1 module inside and root 1.25 modules outside the
    /// reference circle, circular fillet of 0.2 modules, rim 3 modules thick.
    #[must_use]
    pub fn standard_ring(teeth: u32, module: f64) -> Self {
        let reference = 0.5 * module * f64::from(teeth);
        Self {
            kind: GearKind::Internal,
            tip_radius: reference - module,
            root_radius: reference + 1.25 * module,
            rim_radius: reference + 4.25 * module,
            fillet: FilletSpec::Circular { radius: 0.2 * module },
            ..Self::standard(teeth, module)
        }
    }

    /// The same with changes: `GearSpec::standard(27, 5e-3).with(|gear| gear.facewidth = 30e-3)`.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Number of teeth.
    #[must_use]
    pub fn teeth(&self) -> u32 {
        self.teeth
    }

    /// Module (m): reference diameter per tooth.
    #[must_use]
    pub fn module(&self) -> f64 {
        self.module
    }

    /// Reference radius (m).
    #[must_use]
    pub fn reference_radius(&self) -> f64 {
        0.5 * self.module * f64::from(self.teeth)
    }

    /// Circular pitch at the reference circle (m).
    #[must_use]
    pub fn pitch(&self) -> f64 {
        std::f64::consts::PI * self.module
    }

    /// Circular tooth thickness at the reference circle (m).
    #[must_use]
    pub fn reference_thickness(&self) -> f64 {
        match self.thickness {
            ToothThickness::ProfileShift(x) => {
                0.5 * self.pitch() + self.kind.sigma() * 2.0 * x * self.module * self.pressure_angle.tan()
            }
            ToothThickness::AtReference(thickness) => thickness,
        }
    }

    fn faults(&self) -> Vec<GeometryError> {
        let mut faults = Vec::new();
        let mut range = |parameter: &'static str, value: f64, low: f64, high: f64, unit: &str| {
            if !(value >= low && value <= high) {
                let allowed = format!("{low} to {high} {unit}");
                faults.push(GeometryError::OutOfRange { parameter, value, allowed });
            }
        };
        range("teeth", f64::from(self.teeth), 6.0, 2000.0, "teeth");
        range("module", self.module, 1e-5, 1.0, "m");
        range(
            "pressure_angle",
            self.pressure_angle,
            10_f64.to_radians(),
            35_f64.to_radians(),
            "rad (10 to 35 degrees)",
        );
        range("facewidth", self.facewidth, 1e-5, 10.0, "m");
        range("tip_round", self.tip_round, 0.0, 0.5 * self.module, "m (at most half a module)");
        for (parameter, value) in
            [("tip_radius", self.tip_radius), ("root_radius", self.root_radius), ("rim_radius", self.rim_radius)]
        {
            range(parameter, value, 1e-6, 100.0, "m");
        }
        let pitch = self.pitch();
        let thickness = self.reference_thickness();
        range("thickness", thickness, 0.05 * pitch, 0.95 * pitch, "m at the reference circle (5 to 95 % of the pitch)");
        let modification = &self.modification;
        for relief in [&modification.tip_relief, &modification.root_relief].into_iter().flatten() {
            let length = (relief.end_roll - relief.start_roll).abs();
            range(
                "relief start",
                length,
                1e-9 * self.module,
                f64::INFINITY,
                "m of roll distance to the end of the involute",
            );
            range("relief amount", relief.amount, 0.0, self.module, "m");
        }
        if let Some(relief) = &modification.end_relief {
            range("end relief length", relief.length, 1e-9, 0.5 * self.facewidth, "m (at most half the face)");
            range("end relief amount", relief.amount, 0.0, self.module, "m");
        }
        range("lead_crown", modification.lead_crown, -self.module, self.module, "m");
        range("lead_slope", modification.lead_slope, -self.module, self.module, "m");
        for &error in &self.pitch_errors {
            range("pitch_errors", error, -self.module, self.module, "m");
        }
        if modification.measured.as_ref().is_some_and(|table| !table.is_valid()) {
            faults.push(GeometryError::OutOfRange {
                parameter: "measured deviation",
                value: f64::NAN,
                allowed: "a full grid with ascending roll distances and face positions and finite values".into(),
            });
        }
        let (tip, root, rim) =
            (("tip_radius", self.tip_radius), ("root_radius", self.root_radius), ("rim_radius", self.rim_radius));
        let order = match self.kind {
            GearKind::External => [(rim, root), (root, tip)],
            GearKind::Internal => [(tip, root), (root, rim)],
        };
        for ((smaller, smaller_value), (larger, larger_value)) in order {
            if smaller_value.is_finite() && larger_value.is_finite() && smaller_value >= larger_value {
                faults.push(GeometryError::Order { smaller, smaller_value, larger, larger_value });
            }
        }
        faults
    }
}

/// A gear whose geometry is sound.
#[derive(Debug, Clone, PartialEq)]
pub struct Gear {
    spec: GearSpec,
    base_radius: f64,
    base_half_angle: f64,
    fillet: Fillet,
    form_radius: f64,
    tip_form_radius: f64,
}

impl Gear {
    /// Checks a specification and derives what follows from it.
    ///
    /// # Errors
    /// All faults of the specification that can be told together.
    pub fn new(spec: &GearSpec) -> Result<Self, GeometryErrors> {
        let faults = spec.faults();
        if !faults.is_empty() {
            return Err(GeometryErrors(faults));
        }
        let sigma = spec.kind.sigma();
        let base = spec.reference_radius() * spec.pressure_angle.cos();
        let half_angle =
            0.5 * spec.reference_thickness() / spec.reference_radius() + sigma * involute(spec.pressure_angle);
        if spec.kind == GearKind::Internal && spec.tip_radius <= base {
            return Err(GeometryError::Order {
                smaller: "base radius",
                smaller_value: base,
                larger: "tip_radius",
                larger_value: spec.tip_radius,
            }
            .into());
        }
        let fillet = Fillet::new(spec, base, half_angle)?;
        // the round's centre lies on the involute its radius inside the flank
        let centre_radius = spec.tip_radius - sigma * spec.tip_round;
        let centre_roll = roll_distance(base, centre_radius);
        let tip_form_radius = radius_at_roll(base, centre_roll + sigma * spec.tip_round);
        let land = half_angle - spec.tip_round / base - sigma * involute_at_roll(base, centre_roll);
        if !(land > 0.0) {
            let pointed =
                if spec.kind == GearKind::External { pointed_radius(base, half_angle) } else { spec.tip_radius };
            return Err(GeometryError::PointedTeeth {
                pointed_radius: pointed,
                tip_radius: spec.tip_radius,
                tip_round: spec.tip_round,
            }
            .into());
        }
        let form_radius = fillet.point(1.0).coords.norm();
        let involute_left = sigma * (roll_distance(base, tip_form_radius) - roll_distance(base, form_radius));
        if !(involute_left > 0.02 * spec.module) {
            return Err(GeometryError::NoInvolute { form_radius, tip_form_radius }.into());
        }
        Ok(Self {
            spec: spec.clone(),
            base_radius: base,
            base_half_angle: half_angle,
            fillet,
            form_radius,
            tip_form_radius,
        })
    }

    /// The specification.
    #[must_use]
    pub fn spec(&self) -> &GearSpec {
        &self.spec
    }

    /// External or internal.
    #[must_use]
    pub fn kind(&self) -> GearKind {
        self.spec.kind
    }

    /// Number of teeth.
    #[must_use]
    pub fn teeth(&self) -> u32 {
        self.spec.teeth
    }

    /// Module (m).
    #[must_use]
    pub fn module(&self) -> f64 {
        self.spec.module
    }

    /// Facewidth (m).
    #[must_use]
    pub fn facewidth(&self) -> f64 {
        self.spec.facewidth
    }

    /// Base radius (m).
    #[must_use]
    pub fn base_radius(&self) -> f64 {
        self.base_radius
    }

    /// Half tooth angle at the base circle, `psi_b` (rad): the flank is `theta = psi_b - sigma inv(alpha)`.
    #[must_use]
    pub fn base_half_angle(&self) -> f64 {
        self.base_half_angle
    }

    /// Base pitch (m).
    #[must_use]
    pub fn base_pitch(&self) -> f64 {
        2.0 * std::f64::consts::PI * self.base_radius / f64::from(self.spec.teeth)
    }

    /// Radius of the tip circle (m).
    #[must_use]
    pub fn tip_radius(&self) -> f64 {
        self.spec.tip_radius
    }

    /// Radius of the root circle (m).
    #[must_use]
    pub fn root_radius(&self) -> f64 {
        self.spec.root_radius
    }

    /// Radius of the bore, or of the outside of a ring (m).
    #[must_use]
    pub fn rim_radius(&self) -> f64 {
        self.spec.rim_radius
    }

    /// Radius of the tip round (m).
    #[must_use]
    pub fn tip_round(&self) -> f64 {
        self.spec.tip_round
    }

    /// Radius where the involute meets the fillet (m).
    #[must_use]
    pub fn form_radius(&self) -> f64 {
        self.form_radius
    }

    /// Radius where the involute meets the tip round (m).
    #[must_use]
    pub fn tip_form_radius(&self) -> f64 {
        self.tip_form_radius
    }

    /// Whether the fillet cuts into the involute.
    #[must_use]
    pub fn is_undercut(&self) -> bool {
        self.fillet.undercut
    }

    /// The fillet.
    #[must_use]
    pub fn fillet(&self) -> &Fillet {
        &self.fillet
    }

    /// Roll distance (m) at a radius (m).
    #[must_use]
    pub fn roll_distance(&self, radius: f64) -> f64 {
        roll_distance(self.base_radius, radius)
    }

    /// Circular tooth thickness (m) at a radius (m) on the involute.
    #[must_use]
    pub fn thickness_at(&self, radius: f64) -> f64 {
        let inv = involute_at_roll(self.base_radius, self.roll_distance(radius));
        2.0 * radius * (self.base_half_angle - self.spec.kind.sigma() * inv)
    }

    /// Point of a flank of tooth 0 at a roll distance (m).
    #[must_use]
    pub fn flank_point(&self, side: FlankSide, roll: f64) -> Point2<f64> {
        let radius = radius_at_roll(self.base_radius, roll);
        let theta = self.base_half_angle - self.spec.kind.sigma() * involute_at_roll(self.base_radius, roll);
        Point2::new(radius * theta.cos(), side.sign() * radius * theta.sin())
    }

    /// Outward unit normal of a flank of tooth 0 at a roll distance (m).
    #[must_use]
    pub fn flank_normal(&self, side: FlankSide, roll: f64) -> Vector2<f64> {
        let sigma = self.spec.kind.sigma();
        let alpha = (roll / self.base_radius).atan();
        let theta = self.base_half_angle - sigma * (roll / self.base_radius - alpha);
        let (sine, cosine) = (theta - sigma * alpha).sin_cos();
        Vector2::new(-sine, side.sign() * cosine)
    }

    /// Half a tooth from mid-space to the middle of its tip.
    #[must_use]
    pub fn half_tooth_outline(&self) -> HalfToothOutline {
        HalfToothOutline::new(self)
    }

    /// Whether the flanks differ from plain involutes in their place.
    #[must_use]
    pub fn is_modified(&self) -> bool {
        !self.spec.pitch_errors.is_empty() || self.spec.modification != FlankModification::default()
    }

    /// Pitch error of a tooth, any number modulo the number of teeth (m): material removed from its whole flank.
    #[must_use]
    pub fn pitch_error(&self, tooth: i64) -> f64 {
        let errors = &self.spec.pitch_errors;
        let tooth = tooth.rem_euclid(i64::from(self.spec.teeth)) as usize;
        tooth.checked_rem(errors.len()).map_or(0.0, |index| errors[index])
    }

    /// Material removed (m) from the flank of a tooth at a roll distance and face position, pitch error included.
    #[must_use]
    pub fn material_removed(&self, tooth: i64, roll: f64, z: f64) -> f64 {
        self.pitch_error(tooth) + self.spec.modification.deviation(roll, z, self.spec.facewidth)
    }
}

/// Radius at which the two flanks of an external tooth meet.
fn pointed_radius(base: f64, half_angle: f64) -> f64 {
    base / inverse_involute(half_angle).cos()
}
