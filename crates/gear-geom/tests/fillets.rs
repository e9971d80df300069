//! Generated fillets against the tools that cut them: over a fine sweep of tool positions, the tool's rounded corner must touch
//! every point of the fillet and never reach past it.

use gear_geom::involute::{inverse_involute, involute};
use gear_geom::{FilletSpec, Gear, GearKind, GearSpec, ToothThickness};
use nalgebra::{Point2, Rotation2};

/// Least value of `f` on [low, high]: grid, then golden section around the best.
fn least(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    const GRID: i32 = 4000;
    let step = (high - low) / f64::from(GRID);
    let best = (0..=GRID).map(|k| low + step * f64::from(k)).min_by(|a, b| f(*a).total_cmp(&f(*b))).unwrap();
    let (mut a, mut b) = (best - step, best + step);
    let ratio = 0.5 * (5_f64.sqrt() - 1.0);
    for _ in 0..80 {
        let (c, d) = (b - ratio * (b - a), a + ratio * (b - a));
        if f(c) < f(d) { b = d } else { a = c }
    }
    f(0.5 * (a + b))
}

#[test]
fn analytic_rack_trochoid_is_the_envelope_of_the_rack_corner() {
    for (teeth, corner, root) in [(27_u32, 0.8e-3, 36.9e-3), (60, 1.1e-3, 86.2e-3), (12, 0.9e-3, 14.25e-3)] {
        let module = 3e-3;
        let spec = GearSpec::standard(teeth, module).with(|spec| {
            spec.tip_radius = 0.5 * module * f64::from(teeth) + module;
            spec.root_radius = root;
            spec.rim_radius = 0.5 * root;
            spec.fillet = FilletSpec::Rack { tip_radius: corner };
            spec.tip_round = 0.0;
            spec.facewidth = 16e-3;
        });
        let gear = Gear::new(&spec).unwrap();
        let (r, alpha) = (spec.reference_radius(), spec.pressure_angle);
        let depth = r - root - corner;
        let half_space = 0.5 * (spec.pitch() - spec.reference_thickness());
        let offset = half_space - depth * alpha.tan() - corner / alpha.cos();
        let pitch = std::f64::consts::PI / f64::from(teeth);
        for k in 0..=20 {
            let point = gear.fillet().point(f64::from(k) / 20.0);
            // the rack rolls by `roll`: its tooth's centre line at r * roll, the gear's space at the angle `roll`
            let gap = |roll: f64| {
                let fixed = Rotation2::new(roll - pitch) * point;
                let centre = Point2::new(r - depth, r * roll - offset);
                (fixed - centre).norm() - corner
            };
            let touch = least(gap, -0.6, 0.6);
            assert!(touch.abs() < 1e-12, "{teeth} teeth, u = {}: {touch}", f64::from(k) / 20.0);
        }
    }
}

#[test]
fn analytic_shaper_trochoid_is_the_envelope_of_the_cutter_corner() {
    let (cutter_teeth, addendum, corner) = (25_u32, 1.25, 0.6e-3);
    let spec = GearSpec::standard(99, 3e-3).with(|spec| {
        spec.kind = GearKind::Internal;
        spec.thickness = ToothThickness::AtReference(4.6e-3);
        spec.tip_radius = 146.2e-3;
        spec.root_radius = 152.25e-3;
        spec.rim_radius = 165e-3;
        spec.fillet = FilletSpec::Shaper { teeth: cutter_teeth, addendum, tip_radius: corner };
        spec.tip_round = 0.0;
        spec.facewidth = 16e-3;
    });
    let ring = Gear::new(&spec).unwrap();
    // independently: the cutter whose tooth fills the ring's space where both roll
    let ratio = f64::from(cutter_teeth) / 99.0;
    let (base, cutter_base) = (ring.base_radius(), ring.base_radius() * ratio);
    let tip = 0.5 * 3e-3 * f64::from(cutter_teeth) + addendum * 3e-3;
    let distance = spec.root_radius - tip;
    let working = ((base - cutter_base) / distance).acos();
    let radius = base / working.cos();
    let space = 2.0 * std::f64::consts::PI * radius / 99.0 - ring.thickness_at(radius);
    let cutter_half_at_base = 0.5 * space / (radius * ratio) + involute(working);
    let centre_radius = tip - corner;
    let centre_angle = cutter_half_at_base - corner / cutter_base - involute((cutter_base / centre_radius).acos());
    assert!((inverse_involute(involute(working)) - working).abs() < 1e-12);
    let pitch = std::f64::consts::PI / 99.0;
    for k in 0..=20 {
        let point = ring.fillet().point(f64::from(k) / 20.0);
        // cutter turned by `turn` about the origin, the ring by `turn * ratio` about (-distance, 0), space over tooth
        let gap = |turn: f64| {
            let seen = Rotation2::new(turn * ratio - pitch) * point;
            let fixed = Point2::new(seen.x - distance, seen.y);
            let angle = turn - centre_angle;
            let centre = Point2::new(centre_radius * angle.cos(), centre_radius * angle.sin());
            // the ring's material is outside the cutter
            (fixed - centre).norm() - corner
        };
        let touch = least(gap, -0.8, 0.8);
        assert!(touch.abs() < 1e-12, "u = {}: {touch}", f64::from(k) / 20.0);
    }
}
