//! Mass and moments of inertia of a gear taken as a solid disc: its outline, less the bore, times facewidth and density.
//!
//! Area and polar moment of the outline by Green's theorem on a polygon of one half tooth, mirrored and repeated:
//! `A = 1/2 sum c_i`, `J_0 = 1/12 sum c_i (|p_i|^2 + p_i . p_{i+1} + |p_{i+1}|^2)`, `c_i = p_i x p_{i+1}`. A ring's outline
//! is its inner boundary and its rim the outer one; the same difference covers it up to its sign. Webs, holes and shafts are not included.
//!
//! Tests: `analytic_disc_between_root_and_tip` and `analytic_fine_teeth_are_an_annulus` below.

use std::f64::consts::PI;

use crate::gear::Gear;
use crate::outline::OutlineSegment;

/// Points per piece of the outline; the polygon's area is then right to 1e-6.
const POINTS: usize = 200;

/// Mass and moments of inertia of a solid gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GearInertia {
    /// Mass (kg).
    pub mass: f64,
    /// Moment of inertia about the axis (kg m^2).
    pub polar: f64,
    /// Moment of inertia about any diameter at mid-face (kg m^2).
    pub transverse: f64,
}

impl Gear {
    /// Mass (kg) of the solid gear at a density (kg/m^3).
    #[must_use]
    pub fn mass(&self, density: f64) -> f64 {
        self.inertia(density).mass
    }

    /// Mass and moments of inertia of the solid gear at a density (kg/m^3).
    ///
    /// ```
    /// use gear_geom::{Gear, GearSpec};
    ///
    /// let steel = Gear::new(&GearSpec::standard(27, 3e-3))?.inertia(7850.0);
    /// assert!((steel.mass - 1.01).abs() < 0.02, "{} kg", steel.mass);
    /// # Ok::<(), gear_geom::GeometryErrors>(())
    /// ```
    #[must_use]
    pub fn inertia(&self, density: f64) -> GearInertia {
        let outline = self.half_tooth_outline();
        let mut points = Vec::with_capacity(POINTS * OutlineSegment::ALL.len());
        for segment in OutlineSegment::ALL {
            points.extend((0..=POINTS).map(|i| outline.point(segment, i as f64 / POINTS as f64)));
        }
        let (mut area, mut polar) = (0.0, 0.0);
        for pair in points.windows(2) {
            let (p, q) = (pair[0].coords, pair[1].coords);
            let cross = p.x * q.y - p.y * q.x;
            area += 0.5 * cross;
            polar += cross * (p.norm_squared() + p.dot(&q) + q.norm_squared()) / 12.0;
        }
        let halves = 2.0 * f64::from(self.teeth());
        let rim = self.rim_radius();
        let disc = PI * rim * rim;
        let per_area = density * self.facewidth();
        let mass = per_area * (halves * area.abs() - disc).abs();
        let polar = per_area * (halves * polar.abs() - 0.5 * disc * rim * rim).abs();
        GearInertia { mass, polar, transverse: 0.5 * polar + mass * self.facewidth() * self.facewidth() / 12.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::GearSpec;
    use approx::assert_relative_eq;

    /// A gear weighs more than the disc of its root circle, less than that of its tip circle, and about that of the reference
    /// circle (teeth and spaces alike in size).
    #[test]
    fn analytic_disc_between_root_and_tip() {
        let spec = GearSpec::standard(25, 6e-3);
        let gear = Gear::new(&spec).unwrap();
        let disc = |radius: f64, power: i32| {
            let ring = PI * (radius.powi(power) - gear.rim_radius().powi(power));
            7800.0 * gear.facewidth() * if power == 2 { ring } else { 0.5 * ring }
        };
        let inertia = gear.inertia(7800.0);
        for (value, power) in [(inertia.mass, 2), (inertia.polar, 4)] {
            assert!(value > disc(gear.root_radius(), power) && value < disc(gear.tip_radius(), power));
            assert_relative_eq!(value, disc(spec.reference_radius(), power), max_relative = 0.04);
        }
    }

    /// External gear and ring of very fine teeth are the annuli between rim and reference circle: teeth and spaces are of the size of the
    /// module, a thousandth of the radius here.
    #[test]
    fn analytic_fine_teeth_are_an_annulus() {
        for spec in [GearSpec::standard(2000, 0.1e-3), GearSpec::standard_ring(2000, 0.1e-3)] {
            let spec = spec.with(|spec| {
                spec.rim_radius = if spec.kind == crate::GearKind::External { 0.05 } else { 0.2 };
                spec.facewidth = 0.01;
            });
            let gear = Gear::new(&spec).unwrap();
            let (rim, radius) = (gear.rim_radius(), spec.reference_radius());
            let inertia = gear.inertia(1000.0);
            let mass = 1000.0 * 0.01 * PI * (radius * radius - rim * rim).abs();
            assert_relative_eq!(inertia.mass, mass, max_relative = 3e-3);
            assert_relative_eq!(inertia.polar, 0.5 * mass * (radius * radius + rim * rim), max_relative = 3e-3);
            assert_relative_eq!(
                inertia.transverse,
                0.5 * inertia.polar + inertia.mass * 1e-4 / 12.0,
                max_relative = 1e-12
            );
        }
    }
}
