//! Spiral bevel pairs: the dissertation's numbers, textbook forces, and what must hold for any.

use std::f64::consts::{PI, TAU};

use gear_geom::{BevelPair, BevelPlacement, BevelSpec, Hand};
use nalgebra::{Point3, Unit, Vector3};

/// The input stage of section 5.2. Its module is not printed: thicknesses of 6.24 and 3.36 mm and a usual backlash of 0.15 mm make a pitch of 9.75 mm, at
/// the section (not printed either) where they are measured; it is taken to be mid-face.
fn dissertation_spec() -> BevelSpec {
    BevelSpec {
        teeth: [19, 71],
        shaft_angle: 95_f64.to_radians(),
        module: 9.75e-3 / PI,
        facewidth: 30.48e-3,
        spiral_angle: 30_f64.to_radians(),
        pinion_hand: Hand::Left,
        pressure_angle: 20_f64.to_radians(),
        thickness: [6.24e-3, 3.36e-3],
    }
}

fn placement(gear_turns_positive: bool) -> BevelPlacement {
    BevelPlacement {
        apex: Point3::new(0.01, -0.02, 0.3),
        gear_axis: Unit::new_normalize(Vector3::new(0.1, 0.2, -1.0)),
        toward_pinion: Vector3::new(-0.3, 1.0, 0.4),
        gear_turns_positive,
    }
}

/// Section 5.2: pitch angles, speeds, mesh frequency. Printed values fit each other: teeth, shaft angle and pitch angles to the last digit.
#[test]
fn peer_dissertation_section_5_2() {
    let pair = BevelPair::new(&dissertation_spec()).unwrap();
    let [first, second] = pair.pitch_angles().map(f64::to_degrees);
    assert!((first - 15.27).abs() < 0.005 && (second - 79.73).abs() < 0.005, "{first} {second}");
    assert!((pair.gear_speed(6060.0) - 1621.7).abs() < 0.05);
    assert!((pair.mesh_frequency(6060.0 * TAU / 60.0) - 1919.0).abs() < 0.5);
    // at most 30 % of the outer cone distance, as is usual
    let outer = pair.mean_cone_distance() + 0.5 * 30.48e-3;
    assert!(30.48e-3 / outer < 0.3);
    let [pinion, gear] = pair.virtual_teeth();
    assert!((pinion - 19.695).abs() < 1e-3 && (gear - 398.2).abs() < 0.5, "{pinion} {gear}");
    assert!((1.7..1.9).contains(&pair.overlap_ratio()), "{}", pair.overlap_ratio());
    let virtual_pair = pair.virtual_pair().unwrap();
    assert!((1.2..1.6).contains(&virtual_pair.contact_ratio()), "{}", virtual_pair.contact_ratio());
    assert!((virtual_pair.normal_backlash() / pair.transverse_backlash() - 1.0).abs() < 1e-6);
}

/// Axial and radial forces of textbooks (Shigley, *Mechanical Engineering Design*, Eq. (13-39) for straight teeth; with a spiral, Stadtfeld 2014): on the driving
/// pinion, positive away from the apex, `W_t / cos b (tan a_n sin d +- sin b cos d)`, `+` for a left hand that turns clockwise seen from its back;
/// radial, toward the axis, `W_t / cos b (tan a_n cos d -+ sin b sin d)`. On the gear the same with its pitch angle and the other sign.
#[test]
fn peer_textbook_forces() {
    for hand in [Hand::Left, Hand::Right] {
        for positive in [true, false] {
            let pair = BevelPair::new(&BevelSpec { pinion_hand: hand, ..dissertation_spec() }).unwrap();
            let action = pair.line_of_action(&placement(positive)).unwrap();
            let (a_n, b) = (20_f64.to_radians(), 30_f64.to_radians());
            // the gear counter-clockwise about the axis away from the apex is the pinion clockwise about its own, and clockwise seen from its back
            let clockwise = if positive { 1.0 } else { -1.0 };
            let sign = -hand.sign() * clockwise;
            let tangential = a_n.cos() * b.cos();
            for (axis, force, d, sign) in [
                (action.pinion_axis, -action.normal.into_inner(), pair.pitch_angles()[0], sign),
                (action.gear_axis, action.normal.into_inner(), pair.pitch_angles()[1], -sign),
            ] {
                let axial = tangential / b.cos() * (a_n.tan() * d.sin() + sign * b.sin() * d.cos());
                let radial = tangential / b.cos() * (a_n.tan() * d.cos() - sign * b.sin() * d.sin());
                assert!((force.dot(&axis) - axial).abs() < 1e-12, "axial {hand:?} {positive}");
                let from_apex = action.point - placement(positive).apex;
                let outward = (from_apex - axis.into_inner() * from_apex.dot(&axis)).normalize();
                assert!((-force.dot(&outward) - radial).abs() < 1e-12, "radial {hand:?} {positive}");
                assert!((force.dot(&axis.cross(&outward)).abs() - tangential).abs() < 1e-12);
            }
        }
    }
}

/// Torques have the ratio of the teeth, drive the gear in its sense and resist the pinion in its own; rigid rotation in the ratio of the teeth does not
/// open or close the flanks; arms are mean radii times `cos a_n cos b`.
#[test]
fn invariant_ratio() {
    for positive in [true, false] {
        let pair = BevelPair::new(&dissertation_spec()).unwrap();
        let action = pair.line_of_action(&placement(positive)).unwrap();
        let sense = if positive { 1.0 } else { -1.0 };
        let [pinion, gear] = action.arms;
        assert!((gear / pinion - 71.0 / 19.0).abs() < 1e-12, "{pinion} {gear}");
        let arm = pair.mean_radii()[1] * 20_f64.to_radians().cos() * 30_f64.to_radians().cos();
        assert!((gear - sense * arm).abs() < 1e-15);
        let from_apex = action.point - placement(positive).apex;
        let velocity = |axis: Unit<Vector3<f64>>, speed: f64| (axis.into_inner() * speed).cross(&from_apex);
        let of_gear = velocity(action.gear_axis, sense * 19.0);
        let of_pinion = velocity(action.pinion_axis, -sense * 71.0);
        assert!((of_gear - of_pinion).norm() < 1e-12);
        assert!(action.normal.dot(&of_gear) > 0.0);
        let angle = action.pinion_axis.dot(&action.gear_axis).acos();
        assert!((angle - 95_f64.to_radians()).abs() < 1e-12);
        // base spiral angle: the normal is inclined by it against the transverse section
        let transverse = pair.mean_radii()[1] * pair.transverse_pressure_angle().cos();
        assert!((arm / transverse - pair.base_spiral_angle().cos()).abs() < 1e-12);
    }
}

#[test]
fn extreme_pairs_are_refused() {
    let refused = |change: &dyn Fn(&mut BevelSpec)| {
        let mut spec = dissertation_spec();
        change(&mut spec);
        BevelPair::new(&spec).unwrap_err()
    };
    assert_eq!(refused(&|spec| spec.thickness[0] = 7e-3).0.len(), 1);
    assert_eq!(refused(&|spec| spec.facewidth = f64::NAN).0.len(), 1);
    assert!(!refused(&|spec| spec.shaft_angle = 170_f64.to_radians()).0.is_empty());
    assert!(refused(&|spec| spec.spiral_angle = -0.2).to_string().contains("spiral_angle"));
    let pair = BevelPair::new(&dissertation_spec()).unwrap();
    let along = BevelPlacement { toward_pinion: Vector3::new(0.1, 0.2, -1.0), ..placement(true) };
    assert!(pair.line_of_action(&along).is_err());
}
