//! Faults of a geometry.

use thiserror::Error;

use crate::planetary_train::CentralMember;

/// One thing that cannot be.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A size is not a usable number.
    #[error("{parameter} = {value} is not allowed: {allowed}")]
    OutOfRange {
        /// Which size (field name).
        parameter: &'static str,
        /// Its value (SI).
        value: f64,
        /// What is allowed.
        allowed: String,
    },
    /// Radii in the wrong order.
    #[error("{smaller} ({smaller_value:.6} m) must be smaller than {larger} ({larger_value:.6} m)")]
    Order {
        /// Field that must be smaller.
        smaller: &'static str,
        /// Its value (m).
        smaller_value: f64,
        /// Field that must be larger.
        larger: &'static str,
        /// Its value (m).
        larger_value: f64,
    },
    /// The tooth comes to a point below its tip circle.
    #[error(
        "the teeth are pointed: flanks meet at radius {pointed_radius:.6} m, inside the tip radius {tip_radius:.6} m (tip round {tip_round:.6} m); \
         use a tip radius nearer the reference circle, a smaller tip round or a smaller profile shift"
    )]
    PointedTeeth {
        /// Radius at which the flanks meet (m).
        pointed_radius: f64,
        /// Tip radius (m).
        tip_radius: f64,
        /// Tip round (m).
        tip_round: f64,
    },
    /// A fillet that does not fit between the teeth.
    #[error("a fillet (tool tip) radius of {radius:.6} m does not fit the tooth space: {allowed}")]
    FilletDoesNotFit {
        /// Asked radius (m).
        radius: f64,
        /// What is allowed.
        allowed: String,
    },
    /// The fillet reaches to the tip: no involute is left.
    #[error(
        "no involute is left on the flank: the fillet ends at radius {form_radius:.6} m, the tip form circle is {tip_form_radius:.6} m"
    )]
    NoInvolute {
        /// Form radius (m).
        form_radius: f64,
        /// Tip form radius (m).
        tip_form_radius: f64,
    },
    /// Two gears that cannot mesh.
    #[error(
        "base pitches differ: {pinion:.9} m on the pinion, {wheel:.9} m on the wheel; module and pressure angle must agree"
    )]
    BasePitch {
        /// Pinion (m).
        pinion: f64,
        /// Wheel (m).
        wheel: f64,
    },
    /// Centre distance at which base circles cross.
    #[error("centre distance {centre_distance:.6} m is too small: the base circles need more than {least:.6} m")]
    CentreDistance {
        /// Asked (m).
        centre_distance: f64,
        /// Least (m).
        least: f64,
    },
    /// Negative backlash.
    #[error(
        "the teeth jam: circumferential backlash at the working pitch circle is {backlash:.3e} m; thin the teeth by that much in sum, \
         or increase the centre distance"
    )]
    NegativeBacklash {
        /// Backlash (m), negative.
        backlash: f64,
    },
    /// A tip that runs into the mating root circle.
    #[error("the {member} tip reaches the mating root circle: clearance {clearance:.3e} m")]
    TipClearance {
        /// Whose tip.
        member: &'static str,
        /// Clearance (m), negative.
        clearance: f64,
    },
    /// Contact ratio below one.
    #[error(
        "contact ratio {contact_ratio:.4} is below 1: no pair of teeth is in contact for part of the mesh cycle; use larger tip circles"
    )]
    ContactRatio {
        /// Contact ratio.
        contact_ratio: f64,
    },
    /// Contact that would have to happen where a flank has no involute.
    #[error(
        "the {member} would be met below its involute: contact starts at roll distance {start:.6} m, the involute at {form:.6} m \
         (fillet contact, interference); use a smaller mating tip circle or a smaller fillet"
    )]
    Interference {
        /// Whose fillet.
        member: &'static str,
        /// Roll distance of the first contact (m), from the base tangent point; negative below it.
        start: f64,
        /// Roll distance where the involute begins (m).
        form: f64,
    },
    /// Tips of an internal pair that foul each other away from the line of action.
    #[error(
        "pinion and ring tips foul each other outside the mesh by {overlap:.3e} m; use a larger difference of tooth numbers or shorter teeth"
    )]
    TipFouling {
        /// Overlap (m).
        overlap: f64,
    },
}

impl GeometryError {
    /// Field of the specification the fault is about, where it is one.
    #[must_use]
    pub fn parameter(&self) -> &'static str {
        match self {
            Self::OutOfRange { parameter, .. } => parameter,
            Self::Order { smaller, .. } => smaller,
            Self::PointedTeeth { .. } | Self::NoInvolute { .. } => "tip_radius",
            Self::FilletDoesNotFit { .. } => "fillet",
            Self::BasePitch { .. } => "module",
            Self::CentreDistance { .. } | Self::NegativeBacklash { .. } | Self::TipClearance { .. } => {
                "centre_distance"
            }
            Self::ContactRatio { .. } | Self::Interference { .. } | Self::TipFouling { .. } => "tip_radius",
        }
    }
}

/// All faults found at once; never empty.
#[derive(Debug, Clone, PartialEq)]
pub struct GeometryErrors(pub Vec<GeometryError>);

impl std::fmt::Display for GeometryErrors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (index, error) in self.0.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{error}")?;
        }
        Ok(())
    }
}

impl std::error::Error for GeometryErrors {}

impl From<GeometryError> for GeometryErrors {
    fn from(error: GeometryError) -> Self {
        Self(vec![error])
    }
}

/// What keeps gears from being a planetary train.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TrainError {
    /// No planet.
    #[error("a planetary train needs at least one planet")]
    NoPlanet,
    /// A number that is none.
    #[error("{quantity} = {value} is not allowed: a finite number is")]
    NotFinite {
        /// Which.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// An internal gear where an external one belongs, or the reverse.
    #[error("the {gear} must be an {needed} gear")]
    Kind {
        /// Which gear.
        gear: &'static str,
        /// `external` or `internal`.
        needed: &'static str,
    },
    /// A pair that cannot mesh.
    #[error("{pair}: {source}")]
    Pair {
        /// Which pair.
        pair: &'static str,
        /// Why.
        source: GeometryErrors,
    },
    /// A planet whose teeth do not fit both sun and ring.
    #[error(
        "planet {planet} at {angle:.6} rad does not fit between the teeth of sun ({sun_teeth}) and ring ({ring_teeth}): from planet 0 it must \
         stand at a multiple of {step:.6} rad; the nearest angle is {nearest:.6} rad"
    )]
    Assembly {
        /// Planet.
        planet: usize,
        /// Its angle (rad).
        angle: f64,
        /// Teeth of the sun.
        sun_teeth: u32,
        /// Teeth of the ring.
        ring_teeth: u32,
        /// `2 pi / (Z_s + Z_r)` (rad).
        step: f64,
        /// Nearest angle that fits (rad).
        nearest: f64,
    },
    /// Planets that run into each other.
    #[error("planets {first} and {second} collide: their tip circles overlap by {overlap:.6} m")]
    Collision {
        /// One planet.
        first: usize,
        /// The other.
        second: usize,
        /// Overlap (m).
        overlap: f64,
    },
    /// The same part named twice, so that the train's speeds are not determined.
    #[error("the speed of the {0:?} is given twice: speeds of two different parts determine a train")]
    SpeedsUndetermined(CentralMember),
    /// More engagements than a list can hold.
    #[error("about {count:.3e} engagements are asked for: at most {most:.0e}; take fewer turns of the carrier")]
    TooManyEngagements {
        /// About how many.
        count: f64,
        /// How many are allowed.
        most: f64,
    },
    /// No such planet or tooth.
    #[error("there is no {what} {number}: there are {count}")]
    NoSuch {
        /// `planet` or `tooth`.
        what: &'static str,
        /// Asked for.
        number: usize,
        /// How many there are.
        count: usize,
    },
}
