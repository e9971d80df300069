//! The contacting outline of one tooth flank: involute, then the round at the tip.
//!
//! Everything is said in the *tooth frame*: tooth on the +x axis, the flank in question turned to `y > 0` by mirroring if need be.
//! With `sigma = +1` for an external gear and `-1` for a ring, a point at radius `R`, angle `theta` and pressure angle
//! `cos(alpha) = r_b / R` lies on the involute of base angle `beta = theta + sigma inv(alpha)`, and all involutes of one gear are
//! parallel curves, so its distance from the flank, measured along the flank's normal, is exactly
//!
//! `d = r_b (beta - psi_b)`, foot at roll distance `s = sqrt(R^2 - r_b^2) - sigma d`
//!
//! (Litvin and Fuentes, *Gear Geometry and Applied Theory*, 2004, section 10.3). This is what makes rigid-body separations exact.

use gear_geom::{Gear, GearKind};
use nalgebra::{Point2, Rotation2, Vector2};

/// Outline of a flank in its tooth frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlankProfile {
    /// Base radius (m).
    pub base_radius: f64,
    /// Half tooth angle at the base circle (rad).
    pub base_half_angle: f64,
    /// +1 external, -1 internal.
    pub sigma: f64,
    /// Roll distance where the involute meets the fillet (m).
    pub form_roll: f64,
    /// Roll distance where the involute meets the tip round (m).
    pub tip_roll: f64,
    /// Radius of the tip round (m), 0 for a sharp edge.
    pub tip_round: f64,
}

/// A point of the outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlinePoint {
    /// Position in the tooth frame (m).
    pub position: Point2<f64>,
    /// Outward unit normal.
    pub normal: Vector2<f64>,
    /// Roll distance of the involute point it belongs to; the tip's on the round (m).
    pub roll: f64,
}

impl FlankProfile {
    /// Profile of a gear's teeth.
    #[must_use]
    pub fn new(gear: &Gear) -> Self {
        let base = gear.base_radius();
        let roll = |radius: f64| (radius * radius - base * base).max(0.0).sqrt();
        Self {
            base_radius: base,
            base_half_angle: gear.base_half_angle(),
            sigma: if gear.kind() == GearKind::External { 1.0 } else { -1.0 },
            form_roll: roll(gear.form_radius()),
            tip_roll: roll(gear.tip_form_radius()),
            tip_round: gear.tip_round(),
        }
    }

    /// Point of the (extended) involute at a roll distance.
    #[must_use]
    pub fn involute(&self, roll: f64) -> OutlinePoint {
        let alpha = (roll / self.base_radius).atan();
        let radius = self.base_radius.hypot(roll);
        let theta = self.base_half_angle - self.sigma * (roll / self.base_radius - alpha);
        let (sine, cosine) = theta.sin_cos();
        let (normal_sine, normal_cosine) = (theta - self.sigma * alpha).sin_cos();
        OutlinePoint {
            position: Point2::new(radius * cosine, radius * sine),
            normal: Vector2::new(-normal_sine, normal_cosine),
            roll,
        }
    }

    /// Distance of a point from the extended involute along its normal (positive outside the tooth), and the roll distance of its
    /// foot (both m). `None` inside the base circle.
    #[must_use]
    pub fn separation(&self, point: Point2<f64>) -> Option<(f64, f64)> {
        let radius = point.coords.norm();
        if !(radius >= self.base_radius) {
            return None;
        }
        let roll = (radius * radius - self.base_radius * self.base_radius).sqrt();
        let ratio = roll / self.base_radius;
        let beta = point.y.atan2(point.x) + self.sigma * (ratio - ratio.atan());
        let distance = self.base_radius * (beta - self.base_half_angle);
        // along a common normal the roll distance changes with the distance
        Some((distance, roll - self.sigma * distance))
    }

    /// Signed distance along the outline from the end of the involute: negative on the involute, positive on the tip round.
    #[must_use]
    pub fn outline(&self, along: f64) -> OutlinePoint {
        if along <= 0.0 {
            return self.involute(self.roll_at(along));
        }
        let end = self.involute(self.tip_roll);
        let angle = if self.tip_round > 0.0 { -self.sigma * along / self.tip_round } else { 0.0 };
        let normal = Rotation2::new(angle) * end.normal;
        let centre = end.position - end.normal * self.tip_round;
        OutlinePoint { position: centre + normal * self.tip_round, normal, roll: self.tip_roll }
    }

    /// Largest argument of [`Self::outline`]: where the round ends on the tip circle.
    #[must_use]
    pub fn outline_end(&self) -> f64 {
        let alpha = (self.tip_roll / self.base_radius).atan();
        self.tip_round * (std::f64::consts::FRAC_PI_2 - alpha).max(0.0)
    }

    /// Argument of [`Self::outline`] at a roll distance of the involute.
    #[must_use]
    pub fn along_at(&self, roll: f64) -> f64 {
        self.sigma * (roll * roll - self.tip_roll * self.tip_roll) / (2.0 * self.base_radius)
    }

    fn roll_at(&self, along: f64) -> f64 {
        (self.tip_roll * self.tip_roll + 2.0 * self.base_radius * self.sigma * along).max(0.0).sqrt()
    }

    /// How far the tip round falls below the extended involute at a roll distance beyond its end (m): 0 on the involute, `None`
    /// past nine tenths of the round.
    #[must_use]
    pub fn tip_drop(&self, roll: f64) -> Option<f64> {
        let beyond = self.along_at(roll);
        if beyond <= 0.0 {
            return Some(0.0);
        }
        let rho = self.tip_round;
        (beyond < 0.9 * rho).then(|| rho - (rho * rho - beyond * beyond).sqrt())
    }
}
