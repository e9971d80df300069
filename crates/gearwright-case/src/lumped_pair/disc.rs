//! Mass and moment of inertia of a gear taken as a solid disc: its outline, less the bore, times facewidth and density.
//!
//! Area and polar moment of the outline by Green's theorem on a polygon of one half tooth, mirrored and repeated:
//! `A = 1/2 sum c_i`, `J_0 = 1/12 sum c_i (|p_i|^2 + p_i . p_{i+1} + |p_{i+1}|^2)`, `c_i = p_i x p_{i+1}`. A ring's outline
//! is its inner boundary and its rim the outer one, which the same difference covers up to its sign. Webs, holes and shafts are not in it.
//!
//! Test: `analytic_disc_between_root_and_tip` below.

use gear_geom::{Gear, OutlineSegment};

/// Points per piece of the outline; the polygon's area is then right to 1e-6.
const POINTS: usize = 200;

/// Mass (kg) and moment of inertia about the axis (kg m^2) at a density (kg/m^3).
#[must_use]
pub fn mass_and_inertia(gear: &Gear, density: f64) -> (f64, f64) {
    let outline = gear.half_tooth_outline();
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
    let halves = 2.0 * f64::from(gear.teeth());
    let rim = gear.rim_radius();
    let disc = std::f64::consts::PI * rim * rim;
    let per_area = density * gear.facewidth();
    (per_area * (halves * area.abs() - disc).abs(), per_area * (halves * polar.abs() - 0.5 * disc * rim * rim).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gear_geom::GearSpec;

    /// A gear weighs more than the disc of its root circle, less than that of its tip circle, and about that of the reference
    /// circle (teeth and spaces alike in size).
    #[test]
    fn analytic_disc_between_root_and_tip() {
        let spec = GearSpec::standard(25, 6e-3);
        let gear = Gear::new(&spec).unwrap();
        let disc = |radius: f64, power: i32| {
            let ring = std::f64::consts::PI * (radius.powi(power) - gear.rim_radius().powi(power));
            7800.0 * gear.facewidth() * if power == 2 { ring } else { 0.5 * ring }
        };
        let (mass, inertia) = mass_and_inertia(&gear, 7800.0);
        for (value, power) in [(mass, 2), (inertia, 4)] {
            assert!(value > disc(gear.root_radius(), power) && value < disc(gear.tip_radius(), power));
            let at_reference = disc(spec.reference_radius(), power);
            assert!((value / at_reference - 1.0).abs() < 0.04, "{value} {at_reference}");
        }
    }
}
