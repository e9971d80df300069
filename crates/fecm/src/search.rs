//! Contact search: which tooth pairs can touch, where, and how far apart their surfaces are.
//!
//! A [`PlacedPair`] is one pair of teeth at one configuration. One of the two flanks is *master*: the one that is met on its
//! involute. Separations are taken along its normals, exactly ([`crate::profile`]), to the other flank's outline including the
//! tip round. So a pair that touches on the line of action, one whose wheel tip meets the pinion's flank early, and one whose
//! pinion tip leaves the wheel's flank late (corner contact) are the same computation.
//!
//! Closing rotation: the wheel is turned by `phi` against its driven direction, toward the pinion's driving flank.

use nalgebra::{Point2, Rotation2, Vector2};

use crate::profile::{FlankProfile, OutlinePoint};

/// Placement of a tooth: rotation of its centre line and mirroring that turns its working flank to `y > 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Gear centre (m).
    pub centre: Point2<f64>,
    /// Angle of the tooth's centre line (rad).
    pub angle: f64,
    /// +1 if the working flank is the upper one, -1 if the lower.
    pub side: f64,
}

impl Placement {
    /// From space to the tooth frame.
    #[must_use]
    pub fn to_tooth(&self, point: Point2<f64>) -> Point2<f64> {
        let local = Rotation2::new(-self.angle) * (point - self.centre);
        Point2::new(local.x, self.side * local.y)
    }

    /// From the tooth frame to space.
    #[must_use]
    pub fn to_space(&self, point: Point2<f64>) -> Point2<f64> {
        self.centre + self.direction_to_space(point.coords)
    }

    /// A direction from the tooth frame to space.
    #[must_use]
    pub fn direction_to_space(&self, direction: Vector2<f64>) -> Vector2<f64> {
        Rotation2::new(self.angle) * Vector2::new(direction.x, self.side * direction.y)
    }
}

/// One flank in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedFlank {
    /// Outline.
    pub profile: FlankProfile,
    /// Where it is.
    pub placement: Placement,
}

/// Which member of the pair a quantity belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Member {
    /// The driving pinion.
    Pinion,
    /// The driven wheel.
    Wheel,
}

/// A pair of flanks that may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedPair {
    /// The pinion's flank.
    pub pinion: PlacedFlank,
    /// The wheel's flank.
    pub wheel: PlacedFlank,
    /// Whose normals separations are measured along.
    pub master: Member,
    /// Where on the master the unmodified flanks come nearest: roll distance (m).
    pub foot_roll: f64,
    /// About where on the slave's outline that is: argument of [`FlankProfile::outline`].
    pub foot_along: f64,
}

/// One profile position of a pair: opposite points of the two flanks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpposedPoints {
    /// Roll distance on the pinion (m).
    pub pinion_roll: f64,
    /// Roll distance on the wheel (m).
    pub wheel_roll: f64,
    /// Separation along the master's normal, without flank modifications (m).
    pub separation: f64,
    /// Lever arm of a unit normal force about the pinion's axis (m).
    pub pinion_arm: f64,
    /// Lever arm about the wheel's axis (m): also the closing speed per unit of closing rotation.
    pub wheel_arm: f64,
    /// Position on the master's flank in space (m).
    pub position: Point2<f64>,
    /// Direction of the force on the wheel.
    pub normal: Vector2<f64>,
}

/// Why a profile position of a pair carries no contact cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoCell {
    /// Below the involute, on the fillet.
    Fillet,
    /// Beyond the tip of one of the teeth.
    BeyondTip,
}

impl PlacedPair {
    /// Pairs two placed flanks. `pinion_roll` is the roll distance at which they touch on the line of action (it may lie beyond either
    /// tip), `wheel_roll` the wheel's.
    #[must_use]
    pub fn new(pinion: PlacedFlank, wheel: PlacedFlank, pinion_roll: f64, wheel_roll: f64) -> Self {
        let past_tip = |flank: &PlacedFlank, roll: f64| flank.profile.along_at(roll.max(0.0));
        let pinion_past = past_tip(&pinion, pinion_roll);
        let foot_along = wheel.profile.along_at(wheel_roll.max(0.0)).min(0.0);
        let mut pair = Self { pinion, wheel, master: Member::Pinion, foot_roll: pinion_roll, foot_along };
        if pinion_past > 0.0 {
            pair.master = Member::Wheel;
            pair.foot_along = 0.0;
            pair.foot_roll = pair.foot_of_tip().unwrap_or(wheel_roll);
        } else if past_tip(&wheel, wheel_roll) > 0.0 || wheel_roll < 0.0 {
            pair.foot_along = 0.0;
            pair.foot_roll = pair.foot_of_tip().unwrap_or(pinion_roll);
        }
        pair
    }

    fn master_and_slave(&self) -> (&PlacedFlank, &PlacedFlank) {
        match self.master {
            Member::Pinion => (&self.pinion, &self.wheel),
            Member::Wheel => (&self.wheel, &self.pinion),
        }
    }

    /// The slave's outline point at `along`, in the master's tooth frame.
    fn slave_point(&self, along: f64) -> OutlinePoint {
        let (master, slave) = self.master_and_slave();
        let local = slave.profile.outline(along);
        let space = slave.placement.to_space(local.position);
        OutlinePoint { position: master.placement.to_tooth(space), normal: local.normal, roll: local.roll }
    }

    /// Foot on the master of the point of the slave's tip round that is nearest to it.
    fn foot_of_tip(&self) -> Option<f64> {
        let (master, slave) = self.master_and_slave();
        let end = slave.profile.outline_end();
        let mut best: Option<(f64, f64)> = None;
        const SAMPLES: u32 = 24;
        for k in 0..=SAMPLES {
            let point = self.slave_point(end * f64::from(k) / f64::from(SAMPLES));
            if let Some((distance, roll)) = master.profile.separation(point.position)
                && best.is_none_or(|(least, _)| distance < least)
            {
                best = Some((distance, roll));
            }
        }
        best.map(|(_, roll)| roll)
    }

    /// Arc length along the master's involute from the foot to a roll distance.
    #[must_use]
    pub fn arc_from_foot(&self, roll: f64) -> f64 {
        let (master, _) = self.master_and_slave();
        (roll * roll - self.foot_roll * self.foot_roll) / (2.0 * master.profile.base_radius)
    }

    /// Opposite points at arc length `offset` (m) from the foot along the master's flank, toward increasing radius.
    ///
    /// # Errors
    /// [`NoCell`] where one of the teeth has no contact surface.
    pub fn opposed(&self, offset: f64) -> Result<OpposedPoints, NoCell> {
        let (master, slave) = self.master_and_slave();
        let squared = self.foot_roll * self.foot_roll + 2.0 * master.profile.base_radius * offset;
        let form = master.profile.form_roll;
        let past_form = master.profile.sigma * (squared - form * form);
        if !(squared > 0.0) || past_form < -1e-9 * form * form {
            return Err(NoCell::Fillet);
        }
        let master_roll = squared.sqrt();
        let drop = master.profile.tip_drop(master_roll).ok_or(NoCell::BeyondTip)?;
        let (along, separation) = self.slave_opposite(offset)?;
        let slave_point = slave.profile.outline(along);
        let slave_form = slave.profile.form_roll;
        if slave.profile.sigma * (slave_point.roll - slave_form) < -1e-9 * slave_form {
            return Err(NoCell::Fillet);
        }
        let own = master.profile.involute(master_roll);
        let position = master.placement.to_space(own.position);
        let outward = master.placement.direction_to_space(own.normal);
        let arm = |centre: Point2<f64>| {
            let lever = position - centre;
            (lever.x * outward.y - lever.y * outward.x).abs()
        };
        let (pinion_roll, wheel_roll, normal) = match self.master {
            Member::Pinion => (master_roll, slave_point.roll, outward),
            Member::Wheel => (slave_point.roll, master_roll, -outward),
        };
        Ok(OpposedPoints {
            pinion_roll,
            wheel_roll,
            separation: separation + drop,
            pinion_arm: arm(self.pinion.placement.centre),
            wheel_arm: arm(self.wheel.placement.centre),
            position,
            normal,
        })
    }

    /// Solves for the slave's outline point whose foot on the master is `offset` from [`Self::foot_roll`]: its argument and its
    /// separation. The outlines run nearly parallel, so the secant method with first slope +-1 takes a few steps.
    fn slave_opposite(&self, offset: f64) -> Result<(f64, f64), NoCell> {
        let (master, slave) = self.master_and_slave();
        let end = slave.profile.outline_end();
        let at = |along: f64| {
            let (distance, roll) = master.profile.separation(self.slave_point(along).position)?;
            Some((self.arc_from_foot(roll) - offset, distance))
        };
        // toward the slave's tip is toward the master's root: inward on an external master, outward on a ring
        let slope = -master.profile.sigma;
        let mut along = (self.foot_along + slope * offset).min(end);
        let (mut miss, mut distance) = at(along).ok_or(NoCell::Fillet)?;
        let mut rate = slope;
        let scale = master.profile.base_radius;
        for _ in 0..40 {
            if miss.abs() < 1e-13 * scale {
                return if along <= end { Ok((along, distance)) } else { Err(NoCell::BeyondTip) };
            }
            let next = (along - miss / rate).min(end);
            if next == along {
                return Err(NoCell::BeyondTip);
            }
            let (next_miss, next_distance) = at(next).ok_or(NoCell::Fillet)?;
            let secant = (next_miss - miss) / (next - along);
            rate = if secant * slope > 0.05 { secant } else { slope };
            (along, miss, distance) = (next, next_miss, next_distance);
        }
        Err(NoCell::BeyondTip)
    }
}
