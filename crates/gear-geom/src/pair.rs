//! Two gears in mesh.
//!
//! The pinion (an external gear) turns counter-clockwise about the origin and drives with its upper flanks. The wheel's centre is at
//! `(+a, 0)`, a ring's at `(-a, 0)`; the pitch point is `(r_w1, 0)`. The line of action leaves the pinion's base circle at
//! `T1 = r_b1 (cos a_w, -sin a_w)` along `(sin a_w, cos a_w)`; the pinion's roll distance `s_1` is the distance from `T1`, and
//!
//! `s_2 = a sin(a_w) - s_1` (external), `s_2 = a sin(a_w) + s_1` (internal).
//!
//! *Mesh cycle* `m` counts base pitches of rotation. Tooth pair `k` touches at the pitch point when `m = k`; it is pinion tooth `-k` and wheel
//! tooth `+k` (external) or `-k` (internal), wheel tooth 0 being the mate of pinion tooth 0. The driven flank is the upper one
//! of an external wheel and the lower one of a ring.

use nalgebra::Point2;

use crate::error::{GeometryError, GeometryErrors};
use crate::gear::{FlankSide, Gear, GearKind};
use crate::involute::{arc_length, involute, involute_at_roll, radius_at_roll};

/// One of the two gears.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Member {
    /// The driving gear, external.
    Pinion,
    /// The driven gear, external or a ring.
    Wheel,
}

impl Member {
    /// Name for messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pinion => "pinion",
            Self::Wheel => "wheel",
        }
    }
}

/// A named point of the profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// Radius (m).
    pub radius: f64,
    /// Roll angle (rad).
    pub roll_angle: f64,
    /// Roll distance (m).
    pub roll_distance: f64,
    /// Involute arc length from the base circle (m).
    pub arc_length: f64,
}

/// Landmarks of one gear of a pair, from root to tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmarks {
    /// Start of active profile.
    pub sap: Landmark,
    /// Lowest point of single tooth contact; `None` at contact ratios of 2 and more.
    pub lpstc: Option<Landmark>,
    /// Pitch point.
    pub pitch: Landmark,
    /// Highest point of single tooth contact; `None` at contact ratios of 2 and more.
    pub hpstc: Option<Landmark>,
    /// End of active profile.
    pub eap: Landmark,
}

/// Something a user should know that does not stop the computation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// The root is undercut: part of the involute is cut away.
    Undercut {
        /// Which gear.
        member: Member,
        /// Radius at which the involute now begins (m).
        form_radius: f64,
    },
    /// The mating tip reaches slightly below the involute.
    FilletContact {
        /// Whose fillet.
        member: Member,
        /// Roll distance of the first contact (m).
        start: f64,
        /// Roll distance where the involute begins (m).
        form: f64,
    },
    /// No backlash: the coast flanks touch at no load.
    ZeroBacklash,
    /// A tip land below a fifth of the module.
    ThinTip {
        /// Which gear.
        member: Member,
        /// Thickness at the tip circle (m).
        thickness: f64,
    },
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Undercut { member, form_radius } => {
                write!(
                    f,
                    "the {} is undercut: its involute begins at radius {:.4} mm",
                    member.name(),
                    form_radius * 1e3
                )
            }
            Self::FilletContact { member, start, form } => write!(
                f,
                "the mating tip reaches {:.4} mm (roll distance) below the involute of the {}: contact on the fillet is left out",
                (form - start).abs() * 1e3,
                member.name()
            ),
            Self::ZeroBacklash => write!(f, "there is no backlash: the coast flanks touch when unloaded"),
            Self::ThinTip { member, thickness } => {
                write!(f, "the tip land of the {} is only {:.4} mm thick", member.name(), thickness * 1e3)
            }
        }
    }
}

/// Two gears at a centre distance at which they can run.
#[derive(Debug, Clone, PartialEq)]
pub struct GearPair {
    pinion: Gear,
    wheel: Gear,
    centre_distance: f64,
    working_angle: f64,
    findings: Vec<Finding>,
}

/// Contact on the fillet by more than this fraction of the base pitch is an error, by less a finding.
const TOLERATED_FILLET_CONTACT: f64 = 0.05;

impl GearPair {
    /// Mates two gears.
    ///
    /// # Errors
    /// All faults that can be told together: unequal base pitches, centre distance, jamming, clearance, interference, contact ratio, fouling.
    pub fn new(pinion: Gear, wheel: Gear, centre_distance: f64) -> Result<Self, GeometryErrors> {
        if pinion.kind() == GearKind::Internal {
            return Err(GeometryError::OutOfRange {
                parameter: "pinion kind",
                value: f64::NAN,
                allowed: "the pinion must be external; a ring is given as the wheel".into(),
            }
            .into());
        }
        let mut faults = Vec::new();
        let (p1, p2) = (pinion.base_pitch(), wheel.base_pitch());
        if (p1 - p2).abs() > 1e-6 * p1 {
            faults.push(GeometryError::BasePitch { pinion: p1, wheel: p2 });
        }
        let sigma = wheel.kind().sigma();
        let least = wheel.base_radius() + sigma * pinion.base_radius();
        if !(centre_distance > least) || !(least > 0.0) || !centre_distance.is_finite() {
            faults.push(GeometryError::CentreDistance { centre_distance, least });
        }
        if !faults.is_empty() {
            return Err(GeometryErrors(faults));
        }
        let working_angle = (least / centre_distance).acos();
        let mut pair = Self { pinion, wheel, centre_distance, working_angle, findings: Vec::new() };
        pair.check(&mut faults);
        if faults.is_empty() { Ok(pair) } else { Err(GeometryErrors(faults)) }
    }

    fn check(&mut self, faults: &mut Vec<GeometryError>) {
        let backlash = self.backlash();
        let scale = self.pinion.module();
        if backlash < -1e-6 * scale {
            faults.push(GeometryError::NegativeBacklash { backlash });
        } else if backlash < 1e-6 * scale {
            self.findings.push(Finding::ZeroBacklash);
        }
        for member in [Member::Pinion, Member::Wheel] {
            let clearance = self.tip_clearance(member);
            if clearance < 0.0 {
                faults.push(GeometryError::TipClearance { member: member.name(), clearance });
            }
            self.check_interference(member, faults);
            let gear = self.gear(member);
            let (undercut, form_radius) = (gear.is_undercut(), gear.form_radius());
            let thickness = gear.thickness_at(gear.tip_radius());
            if undercut {
                self.findings.push(Finding::Undercut { member, form_radius });
            }
            if thickness < 0.2 * scale {
                self.findings.push(Finding::ThinTip { member, thickness });
            }
        }
        let contact_ratio = self.contact_ratio();
        if contact_ratio < 1.0 {
            faults.push(GeometryError::ContactRatio { contact_ratio });
        }
        if self.wheel.kind() == GearKind::Internal {
            let overlap = self.tip_fouling();
            if overlap > 0.0 {
                faults.push(GeometryError::TipFouling { overlap });
            }
        }
    }

    /// The start of the active profile against the end of the involute at the root.
    fn check_interference(&mut self, member: Member, faults: &mut Vec<GeometryError>) {
        let gear = self.gear(member);
        let form = gear.roll_distance(gear.form_radius());
        // from where the mating involute ends, its round left out
        let start = match member {
            Member::Pinion => self.partner_roll(Member::Wheel, self.wheel.roll_distance(self.wheel.tip_form_radius())),
            Member::Wheel => {
                self.partner_roll(Member::Pinion, self.pinion.roll_distance(self.pinion.tip_form_radius()))
            }
        };
        let below = gear.kind().sigma() * (form - start);
        if start < 0.0 || below > TOLERATED_FILLET_CONTACT * gear.base_pitch() {
            faults.push(GeometryError::Interference { member: member.name(), start, form });
        } else if below > 0.0 {
            self.findings.push(Finding::FilletContact { member, start, form });
        }
    }

    /// Overlap of the tips of an internal pair where the tip circles cross (m), negative or zero when they pass (Dudley's condition; D. W.
    /// Dudley, *Handbook of Practical Gear Design*, 1994, section on internal gears).
    fn tip_fouling(&self) -> f64 {
        let (n1, n2) = (f64::from(self.pinion.teeth()), f64::from(self.wheel.teeth()));
        let (r1, r2, a) = (self.pinion.tip_radius(), self.wheel.tip_radius(), self.centre_distance);
        let cosine1 = (r2 * r2 - r1 * r1 - a * a) / (2.0 * a * r1);
        let cosine2 = (a * a + r2 * r2 - r1 * r1) / (2.0 * a * r2);
        if cosine1.abs() > 1.0 || cosine2.abs() > 1.0 {
            return 0.0;
        }
        let inv = |gear: &Gear, r: f64| involute_at_roll(gear.base_radius(), gear.roll_distance(r));
        let clear = n1 * (cosine1.acos() + inv(&self.pinion, r1)) - n2 * (cosine2.acos() + inv(&self.wheel, r2))
            + (n2 - n1) * involute(self.working_angle);
        -0.5 * self.pinion.module() * clear
    }

    /// The driving gear.
    #[must_use]
    pub fn pinion(&self) -> &Gear {
        &self.pinion
    }

    /// The driven gear.
    #[must_use]
    pub fn wheel(&self) -> &Gear {
        &self.wheel
    }

    /// One of the gears.
    #[must_use]
    pub fn gear(&self, member: Member) -> &Gear {
        match member {
            Member::Pinion => &self.pinion,
            Member::Wheel => &self.wheel,
        }
    }

    /// Centre distance (m).
    #[must_use]
    pub fn centre_distance(&self) -> f64 {
        self.centre_distance
    }

    /// Working transverse pressure angle (rad).
    #[must_use]
    pub fn working_pressure_angle(&self) -> f64 {
        self.working_angle
    }

    /// Working pitch radius (m).
    #[must_use]
    pub fn working_pitch_radius(&self, member: Member) -> f64 {
        self.gear(member).base_radius() / self.working_angle.cos()
    }

    /// Base pitch (m).
    #[must_use]
    pub fn base_pitch(&self) -> f64 {
        self.pinion.base_pitch()
    }

    /// What a user should know.
    #[must_use]
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// Theoretical contact ratio, from the tip circles.
    #[must_use]
    pub fn contact_ratio(&self) -> f64 {
        let [start, end] = self.active_rolls();
        (end - start) / self.base_pitch()
    }

    /// Circumferential backlash at the working pitch circle (m).
    #[must_use]
    pub fn backlash(&self) -> f64 {
        let radius = self.working_pitch_radius(Member::Pinion);
        let pitch = 2.0 * std::f64::consts::PI * radius / f64::from(self.pinion.teeth());
        let wheel = self.wheel.thickness_at(self.working_pitch_radius(Member::Wheel));
        pitch - self.pinion.thickness_at(radius) - wheel
    }

    /// Backlash along the line of action (m).
    #[must_use]
    pub fn normal_backlash(&self) -> f64 {
        self.backlash() * self.working_angle.cos()
    }

    /// Clearance between a gear's tip circle and the mating root circle (m).
    #[must_use]
    pub fn tip_clearance(&self, member: Member) -> f64 {
        let (a, pinion, wheel) = (self.centre_distance, &self.pinion, &self.wheel);
        match (wheel.kind(), member) {
            (GearKind::External, Member::Pinion) => a - pinion.tip_radius() - wheel.root_radius(),
            (GearKind::External, Member::Wheel) => a - wheel.tip_radius() - pinion.root_radius(),
            (GearKind::Internal, Member::Pinion) => wheel.root_radius() - a - pinion.tip_radius(),
            (GearKind::Internal, Member::Wheel) => wheel.tip_radius() - a - pinion.root_radius(),
        }
    }

    /// Roll distance on the other gear where this one is met at `roll` on the line of action (m); may be negative beyond its base point.
    #[must_use]
    pub fn partner_roll(&self, member: Member, roll: f64) -> f64 {
        let path = self.centre_distance * self.working_angle.sin();
        match (self.wheel.kind(), member) {
            (GearKind::External, _) => path - roll,
            (GearKind::Internal, Member::Pinion) => path + roll,
            (GearKind::Internal, Member::Wheel) => roll - path,
        }
    }

    /// Pinion roll distances between which contact on the line of action is possible (m), from the tip circles.
    #[must_use]
    pub fn active_rolls(&self) -> [f64; 2] {
        let wheel_tip = self.wheel.roll_distance(self.wheel.tip_radius());
        [self.partner_roll(Member::Wheel, wheel_tip), self.pinion.roll_distance(self.pinion.tip_radius())]
    }

    /// Landmarks of one gear.
    #[must_use]
    pub fn landmarks(&self, member: Member) -> Landmarks {
        let base = self.gear(member).base_radius();
        let landmark = |roll: f64| Landmark {
            radius: radius_at_roll(base, roll),
            roll_angle: roll / base,
            roll_distance: roll,
            arc_length: arc_length(base, roll),
        };
        let on_member = |pinion_roll: f64| match member {
            Member::Pinion => landmark(pinion_roll),
            Member::Wheel => landmark(self.partner_roll(Member::Pinion, pinion_roll)),
        };
        let [start, end] = self.active_rolls();
        let single = self.contact_ratio() < 2.0;
        let low = single.then(|| on_member(end - self.base_pitch()));
        let high = single.then(|| on_member(start + self.base_pitch()));
        let pitch = on_member(self.pitch_roll());
        match member {
            Member::Pinion => Landmarks { sap: on_member(start), lpstc: low, pitch, hpstc: high, eap: on_member(end) },
            Member::Wheel => Landmarks { sap: on_member(end), lpstc: high, pitch, hpstc: low, eap: on_member(start) },
        }
    }

    /// Pinion roll distance of the pitch point (m).
    #[must_use]
    pub fn pitch_roll(&self) -> f64 {
        self.pinion.base_radius() * self.working_angle.tan()
    }

    /// Centre of a gear (m).
    #[must_use]
    pub fn centre(&self, member: Member) -> Point2<f64> {
        match member {
            Member::Pinion => Point2::origin(),
            Member::Wheel => Point2::new(self.wheel.kind().sigma() * self.centre_distance, 0.0),
        }
    }

    /// Flank that works.
    #[must_use]
    pub fn working_side(&self, member: Member) -> FlankSide {
        match (member, self.wheel.kind()) {
            (Member::Wheel, GearKind::Internal) => FlankSide::Lower,
            _ => FlankSide::Upper,
        }
    }

    /// Change of a gear's tooth number from one pair to the next.
    #[must_use]
    pub fn tooth_step(&self, member: Member) -> i32 {
        match (member, self.wheel.kind()) {
            (Member::Wheel, GearKind::External) => 1,
            _ => -1,
        }
    }

    /// Direction in which the wheel closes on the driving flank: `+1` counter-clockwise.
    #[must_use]
    pub fn closing_direction(&self) -> f64 {
        self.wheel.kind().sigma()
    }

    /// Roll distance on a gear at which pair `pair` touches on the line of action at `mesh_cycle` (m), whether or not its flanks reach there.
    #[must_use]
    pub fn contact_roll(&self, member: Member, pair: i32, mesh_cycle: f64) -> f64 {
        let pinion = self.pitch_roll() + (mesh_cycle - f64::from(pair)) * self.base_pitch();
        match member {
            Member::Pinion => pinion,
            Member::Wheel => self.partner_roll(Member::Pinion, pinion),
        }
    }

    /// Mesh cycle of the coast flanks at one of the driving flanks, pinion in place, wheel turned through the backlash: that of the mirrored pair, in which the
    /// coast flanks drive. It runs backwards; pairs are numbered anew, and whole cycles do not count.
    #[must_use]
    pub fn coast_cycle(&self, mesh_cycle: f64) -> f64 {
        let radius = self.working_pitch_radius(Member::Pinion);
        let pitch = 2.0 * std::f64::consts::PI * radius / f64::from(self.pinion.teeth());
        self.pinion.thickness_at(radius) / pitch - mesh_cycle
    }

    /// Angle of the centre line of a gear's tooth of pair `pair` (rad, in space), for unloaded unmodified flanks in contact.
    #[must_use]
    pub fn tooth_angle(&self, member: Member, pair: i32, mesh_cycle: f64) -> f64 {
        let gear = self.gear(member);
        let turned = self.contact_roll(member, pair, mesh_cycle) / gear.base_radius();
        let half = gear.base_half_angle();
        match (member, self.wheel.kind()) {
            (Member::Pinion, _) => turned - half - self.working_angle,
            (Member::Wheel, GearKind::External) => std::f64::consts::PI + turned - half - self.working_angle,
            (Member::Wheel, GearKind::Internal) => turned + half - self.working_angle,
        }
    }
}
