//! Half a tooth as one smooth curve.
//!
//! The upper half of one pitch, from the mid-space line at the root circle to the tooth's centre line at the tip: root land (arc),
//! fillet, flank (involute), tip round (arc), tip land (arc). Each joins the next without a gap in slope, unless the tooth is
//! undercut. A root land or a tip round may have no length.

use nalgebra::{Point2, Vector2};

use crate::gear::{FlankSide, Gear};
use crate::involute::involute_at_roll;

/// Pieces of the outline in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutlineSegment {
    /// Arc of the root circle.
    RootLand,
    /// Fillet.
    Fillet,
    /// Involute; `u` is linear in roll distance.
    Flank,
    /// Arc between flank and tip circle.
    TipRound,
    /// Arc of the tip circle.
    TipLand,
}

impl OutlineSegment {
    /// All pieces in order.
    pub const ALL: [Self; 5] = [Self::RootLand, Self::Fillet, Self::Flank, Self::TipRound, Self::TipLand];
}

/// The upper half of a tooth; see the module header.
#[derive(Debug, Clone)]
pub struct HalfToothOutline {
    gear: Gear,
    /// Roll distances at the ends of the involute.
    rolls: [f64; 2],
    /// Polar angles of the root land, from mid-space to the fillet.
    root_angles: [f64; 2],
    round_centre: Point2<f64>,
    /// Directions of the tip round's ends from its centre.
    round_angles: [f64; 2],
    /// Polar angle at which the tip land begins.
    land_angle: f64,
}

impl HalfToothOutline {
    pub(crate) fn new(gear: &Gear) -> Self {
        let sigma = gear.kind().sigma();
        let rolls = [gear.form_radius(), gear.tip_form_radius()].map(|radius| gear.roll_distance(radius));
        let start = gear.fillet().point(0.0);
        let root_angles = [std::f64::consts::PI / f64::from(gear.teeth()), start.y.atan2(start.x)];
        let (end, normal) =
            (gear.flank_point(FlankSide::Upper, rolls[1]), gear.flank_normal(FlankSide::Upper, rolls[1]));
        let round_centre = end - normal * gear.tip_round();
        let land_angle = if gear.tip_round() > 0.0 {
            round_centre.y.atan2(round_centre.x)
        } else {
            gear.base_half_angle() - sigma * involute_at_roll(gear.base_radius(), rolls[1])
        };
        let outward = if sigma > 0.0 { land_angle } else { land_angle + std::f64::consts::PI };
        let round_angles = [normal.y.atan2(normal.x), outward];
        Self { gear: gear.clone(), rolls, root_angles, round_centre, round_angles, land_angle }
    }

    /// Point of a piece at `u` in [0, 1], from root to tip.
    #[must_use]
    pub fn point(&self, segment: OutlineSegment, u: f64) -> Point2<f64> {
        let mix = |ends: [f64; 2]| ends[0] + u * (ends[1] - ends[0]);
        let polar = |radius: f64, angle: f64| Point2::new(radius * angle.cos(), radius * angle.sin());
        match segment {
            OutlineSegment::RootLand => polar(self.gear.root_radius(), mix(self.root_angles)),
            OutlineSegment::Fillet => self.gear.fillet().point(u),
            OutlineSegment::Flank => self.gear.flank_point(FlankSide::Upper, mix(self.rolls)),
            OutlineSegment::TipRound => self.round_centre + polar(self.gear.tip_round(), mix(self.round_angles)).coords,
            OutlineSegment::TipLand => polar(self.gear.tip_radius(), self.land_angle * (1.0 - u)),
        }
    }

    /// Unit tangent toward the tip (on the tip land: toward the centre line).
    #[must_use]
    pub fn tangent(&self, segment: OutlineSegment, u: f64) -> Vector2<f64> {
        let circle = |angle: f64| Vector2::new(angle.sin(), -angle.cos());
        match segment {
            OutlineSegment::RootLand => circle(self.root_angles[0] + u * (self.root_angles[1] - self.root_angles[0])),
            OutlineSegment::Fillet => self.gear.fillet().tangent(u),
            OutlineSegment::Flank => {
                let roll = self.rolls[0] + u * (self.rolls[1] - self.rolls[0]);
                let normal = self.gear.flank_normal(FlankSide::Upper, roll);
                // toward the tip: radially outward for external teeth, inward for a ring's
                let along = Vector2::new(normal.y, -normal.x);
                if self.gear.kind().sigma() > 0.0 { along } else { -along }
            }
            OutlineSegment::TipRound => {
                let angle = self.round_angles[0] + u * (self.round_angles[1] - self.round_angles[0]);
                let turn = if self.round_angles[1] > self.round_angles[0] { -1.0 } else { 1.0 };
                circle(angle) * turn
            }
            OutlineSegment::TipLand => circle(self.land_angle * (1.0 - u)),
        }
    }

    /// Arc length of a piece (m), by chords of a fine polygon (relative error below 1e-6).
    #[must_use]
    pub fn length(&self, segment: OutlineSegment) -> f64 {
        const PARTS: u32 = 512;
        let at = |k: u32| self.point(segment, f64::from(k) / f64::from(PARTS));
        (0..PARTS).map(|k| (at(k + 1) - at(k)).norm()).sum()
    }
}
