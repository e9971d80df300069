//! Pairs: published sizes, conjugacy, faults.

use gear_geom::{
    FilletSpec, FlankSide, Gear, GearKind, GearPair, GearSpec, GeometryError, GeometryErrors, Member, ToothThickness,
};
use nalgebra::Rotation2;
use proptest::prelude::*;

fn nonunity(teeth: u32, thickness: f64, tip: f64, root: f64, corner: f64) -> GearSpec {
    GearSpec::standard(teeth, 2.0 * 88.9e-3 / 62.0).with(|spec| {
        spec.pressure_angle = 24.6_f64.to_radians();
        spec.thickness = ToothThickness::AtReference(thickness * 1e-3);
        spec.tip_radius = 0.5e-3 * tip;
        spec.root_radius = 0.5e-3 * root;
        spec.rim_radius = 25.4e-3;
        spec.facewidth = 31.75e-3;
        spec.fillet = FilletSpec::Rack { tip_radius: corner * 1e-3 };
        spec.tip_round = 0.05e-3;
    })
}

fn nonunity_pair() -> GearPair {
    let pinion = Gear::new(&nonunity(27, 4.52, 84.05, 70.76, 0.86)).unwrap();
    let wheel = Gear::new(&nonunity(35, 4.18, 104.98, 91.54, 0.55)).unwrap();
    GearPair::new(pinion, wheel, 88.9e-3).unwrap()
}

fn ring_pair() -> GearPair {
    let pinion = Gear::new(&GearSpec::standard(35, 3e-3).with(|spec| {
        spec.tip_radius = 55.5e-3;
        spec.root_radius = 48.75e-3;
        spec.fillet = FilletSpec::Rack { tip_radius: 0.8e-3 };
        spec.tip_round = 0.06e-3;
        spec.facewidth = 16e-3;
    }))
    .unwrap();
    let ring = Gear::new(&GearSpec::standard(99, 3e-3).with(|spec| {
        spec.kind = GearKind::Internal;
        spec.thickness = ToothThickness::AtReference(4.6e-3);
        spec.tip_radius = 146.2e-3;
        spec.root_radius = 152.25e-3;
        spec.rim_radius = 165e-3;
        spec.fillet = FilletSpec::Shaper { teeth: 25, addendum: 1.25, tip_radius: 0.6e-3 };
        spec.tip_round = 0.06e-3;
        spec.facewidth = 16e-3;
    }))
    .unwrap();
    GearPair::new(pinion, ring, 96e-3).unwrap()
}

/// Dissertation Table 3.1 and section 3.2.4.2: base radii, contact ratio, base pitch, lengths between landmarks.
#[test]
fn peer_dissertation_table_3_1() {
    let pair = nonunity_pair();
    let close =
        |value: f64, printed: f64, digit: f64| assert!((value - printed).abs() < digit, "{value} against {printed}");
    close(pair.pinion().base_radius() * 1e3, 35.20, 0.005);
    close(pair.wheel().base_radius() * 1e3, 45.63, 0.005);
    close(pair.working_pressure_angle().to_degrees(), 24.6, 1e-9);
    close(pair.contact_ratio(), 1.452, 0.0005);
    close(pair.base_pitch() * 1e3, 8.192, 0.0005);
    close(pair.backlash() * 1e3, 0.309, 0.0005);
    let landmarks = pair.landmarks(Member::Pinion);
    // the tip diameters are printed to 0.01 mm, which moves the ends of contact by up to 0.005 mm each
    let roll = |l: Option<gear_geom::Landmark>| l.unwrap().roll_distance * 1e3;
    close(roll(landmarks.hpstc) - roll(landmarks.lpstc), 4.488, 0.01);
    close(roll(landmarks.lpstc) - landmarks.sap.roll_distance * 1e3, 3.702, 0.01);
    close(landmarks.eap.roll_distance * 1e3 - roll(landmarks.hpstc), 3.702, 0.01);
}

/// Dissertation section 2.2: the unity pair's theoretical contact ratio of 1.61, on its 150 mm centre distance without backlash.
#[test]
fn peer_dissertation_unity_contact_ratio() {
    let gear = Gear::new(&GearSpec::standard(25, 6e-3)).unwrap();
    let pair = GearPair::new(gear.clone(), gear, 150e-3).unwrap();
    assert!((pair.contact_ratio() - 1.61).abs() < 0.006, "{}", pair.contact_ratio());
    assert!(pair.findings().contains(&gear_geom::Finding::ZeroBacklash));
}

/// At every mesh cycle the driving flanks touch on the line of action with opposite normals.
#[test]
fn invariant_flanks_are_conjugate() {
    for pair in [nonunity_pair(), ring_pair()] {
        for pair_number in -1..=1 {
            for k in -6..=6 {
                let cycle = f64::from(pair_number) + 0.1 * f64::from(k);
                let touch = |member: Member| {
                    let (gear, side) = (pair.gear(member), pair.working_side(member));
                    let roll = pair.contact_roll(member, pair_number, cycle);
                    let turn = Rotation2::new(pair.tooth_angle(member, pair_number, cycle));
                    (
                        pair.centre(member) + turn * gear.flank_point(side, roll).coords,
                        turn * gear.flank_normal(side, roll),
                    )
                };
                let ((p, n), (q, m)) = (touch(Member::Pinion), touch(Member::Wheel));
                assert!((p - q).norm() < 1e-14 * 1e3, "points differ by {}", (p - q).norm());
                assert!((n + m).norm() < 1e-12);
                let alpha = pair.working_pressure_angle();
                assert!((n.x - alpha.sin()).abs() < 1e-12 && (n.y - alpha.cos()).abs() < 1e-12);
            }
        }
    }
}

/// One mesh cycle turns both gears by one pitch; teeth number as documented.
#[test]
fn invariant_tooth_numbers_follow_the_rotation() {
    for pair in [nonunity_pair(), ring_pair()] {
        for member in [Member::Pinion, Member::Wheel] {
            let pitch = 2.0 * std::f64::consts::PI / f64::from(pair.gear(member).teeth());
            let step = pair.tooth_angle(member, 1, 0.3) - pair.tooth_angle(member, 0, 0.3);
            assert!((step - f64::from(pair.tooth_step(member)) * pitch).abs() < 1e-12);
            let turned = pair.tooth_angle(member, 0, 1.3) - pair.tooth_angle(member, 0, 0.3);
            assert!((turned + f64::from(pair.tooth_step(member)) * pitch).abs() < 1e-12);
        }
    }
}

#[test]
fn invariant_outline_has_no_gap_in_place_or_slope() {
    use gear_geom::OutlineSegment;
    let circular = GearSpec::standard(40, 6e-3).with(|spec| {
        spec.fillet = FilletSpec::Circular { radius: 1.9e-3 };
        spec.tip_radius = 126e-3;
        spec.root_radius = 112.8e-3;
        spec.facewidth = 16e-3;
    });
    let ring = ring_pair().wheel().clone();
    let ring_circular = Gear::new(&ring.spec().clone().with(|spec| {
        spec.fillet = FilletSpec::Circular { radius: 0.5e-3 };
    }))
    .unwrap();
    let pair = nonunity_pair();
    for gear in [pair.pinion().clone(), pair.wheel().clone(), Gear::new(&circular).unwrap(), ring, ring_circular] {
        let outline = gear.half_tooth_outline();
        for pieces in OutlineSegment::ALL.windows(2) {
            let gap = (outline.point(pieces[0], 1.0) - outline.point(pieces[1], 0.0)).norm();
            let turn = outline.tangent(pieces[0], 1.0).dot(&outline.tangent(pieces[1], 0.0));
            assert!(gap < 1e-12, "{pieces:?}: gap {gap}");
            assert!(turn > 1.0 - 1e-8, "{pieces:?}: cosine of the kink {turn}");
        }
        let tip = outline.point(OutlineSegment::TipLand, 1.0);
        assert!((tip.x - gear.tip_radius()).abs() < 1e-12 && tip.y.abs() < 1e-12);
        // the tangent is the direction of the curve
        for piece in OutlineSegment::ALL {
            if outline.length(piece) < 1e-9 {
                continue;
            }
            let chord = (outline.point(piece, 0.5005) - outline.point(piece, 0.4995)).normalize();
            assert!(chord.dot(&outline.tangent(piece, 0.5)) > 1.0 - 1e-6, "{piece:?}");
        }
    }
}

#[test]
fn analytic_thickness_at_the_reference_circle() {
    let gear = Gear::new(&nonunity(27, 4.52, 84.05, 70.76, 0.86)).unwrap();
    assert!((gear.thickness_at(gear.spec().reference_radius()) - 4.52e-3).abs() < 1e-15);
    let ring = ring_pair();
    let ring = ring.wheel();
    assert!((ring.thickness_at(ring.spec().reference_radius()) - 4.6e-3).abs() < 1e-15);
}

fn only(errors: &GeometryErrors) -> &GeometryError {
    assert_eq!(errors.0.len(), 1, "{errors}");
    &errors.0[0]
}

#[test]
fn extreme_each_fault_is_found_and_explained() {
    let base = GearSpec::standard(25, 6e-3);
    let gear = |spec: GearSpec| Gear::new(&spec);
    let error = gear(base.clone().with(|spec| {
        spec.tip_radius = 66e-3;
    }))
    .unwrap_err();
    assert!(matches!(only(&error), GeometryError::Order { larger: "tip_radius", .. }), "{error}");
    let error = gear(base.clone().with(|spec| {
        spec.tip_radius = 95e-3;
    }))
    .unwrap_err();
    assert!(matches!(only(&error), GeometryError::PointedTeeth { .. }), "{error}");
    let error = gear(base.clone().with(|spec| {
        spec.fillet = FilletSpec::Rack { tip_radius: 5e-3 };
    }))
    .unwrap_err();
    assert!(matches!(only(&error), GeometryError::FilletDoesNotFit { .. }), "{error}");
    let error = gear(GearSpec::standard(25, f64::NAN).with(|spec| {
        spec.facewidth = -1.0;
    }))
    .unwrap_err();
    assert!(error.0.len() >= 2, "several faults are told at once: {error}");
    let error = gear(base.clone().with(|spec| {
        spec.kind = GearKind::Internal;
    }))
    .unwrap_err();
    assert!(error.0.iter().any(|e| matches!(e, GeometryError::Order { .. })), "{error}");

    let good = gear(base.clone()).unwrap();
    let pair = |a: Gear, b: Gear, distance: f64| GearPair::new(a, b, distance).unwrap_err();
    let other = gear(GearSpec::standard(25, 5e-3).with(|spec| {
        spec.tip_radius = 67.5e-3;
        spec.root_radius = 56.25e-3;
        spec.fillet = FilletSpec::Rack { tip_radius: 1.9e-3 };
    }))
    .unwrap();
    assert!(matches!(only(&pair(good.clone(), other, 140e-3)), GeometryError::BasePitch { .. }));
    assert!(matches!(only(&pair(good.clone(), good.clone(), 130e-3)), GeometryError::CentreDistance { .. }));
    let jam = pair(good.clone(), good.clone(), 148e-3);
    assert!(jam.0.iter().any(|e| matches!(e, GeometryError::NegativeBacklash { .. })), "{jam}");
    let apart = pair(good.clone(), good.clone(), 158e-3);
    assert!(apart.0.iter().any(|e| matches!(e, GeometryError::ContactRatio { .. })), "{apart}");
    let few = gear(GearSpec::standard(12, 6e-3).with(|spec| {
        spec.tip_radius = 42e-3;
        spec.root_radius = 28.5e-3;
        spec.rim_radius = 10e-3;
    }))
    .unwrap();
    assert!(few.is_undercut());
    let rack_like = gear(GearSpec::standard(120, 6e-3).with(|spec| {
        spec.tip_radius = 366e-3;
        spec.root_radius = 352.5e-3;
    }))
    .unwrap();
    let interference = pair(few, rack_like, 396e-3);
    assert!(
        interference.0.iter().any(|e| matches!(e, GeometryError::Interference { member: "pinion", .. })),
        "{interference}"
    );
    let fouling = GearPair::new(
        gear(GearSpec::standard(90, 6e-3).with(|spec| {
            spec.tip_radius = 276e-3;
            spec.root_radius = 262.5e-3;
        }))
        .unwrap(),
        gear(GearSpec::standard(96, 6e-3).with(|spec| {
            spec.kind = GearKind::Internal;
            spec.tip_radius = 282.6e-3;
            spec.root_radius = 296e-3;
            spec.rim_radius = 330e-3;
            spec.thickness = ToothThickness::AtReference(9.2e-3);
            spec.fillet = FilletSpec::Circular { radius: 1.2e-3 };
        }))
        .unwrap(),
        18e-3,
    )
    .unwrap_err();
    assert!(fouling.0.iter().any(|e| matches!(e, GeometryError::TipFouling { .. })), "{fouling}");
}

proptest! {
    /// Whatever the numbers: a gear or typed errors, never a panic, and finite outlines.
    #[test]
    fn extreme_random_specifications(
        teeth in 6_u32..420, module in 0.2e-3..30e-3_f64, angle in 12.0..32.0_f64, shift in -0.8..0.8_f64,
        addendum in 0.4..1.4_f64, dedendum in 0.8..1.6_f64, corner in 0.02..0.5_f64, rim in 0.2..5.0_f64, internal in any::<bool>(),
        round in 0.0..0.1_f64,
    ) {
        let kind = if internal { GearKind::Internal } else { GearKind::External };
        let sigma = kind.sigma();
        let reference = 0.5 * module * f64::from(teeth);
        let root = reference - sigma * (dedendum - shift) * module;
        let spec = GearSpec::standard(teeth, module).with(|spec| { spec.kind = kind; spec.pressure_angle = angle.to_radians(); spec.thickness = ToothThickness::ProfileShift(shift); spec.tip_radius = reference + sigma * (addendum + shift) * module; spec.root_radius = root; spec.rim_radius = (root - sigma * rim * module).max(0.05 * root); spec.fillet = if internal { FilletSpec::Circular { radius: corner * module } } else { FilletSpec::Rack { tip_radius: corner * module } }; spec.tip_round = round * module; spec.facewidth = 10.0 * module; });
        match Gear::new(&spec) {
            Err(errors) => prop_assert!(!errors.0.is_empty() && !errors.to_string().contains("NaN")),
            Ok(gear) => {
                let outline = gear.half_tooth_outline();
                for piece in gear_geom::OutlineSegment::ALL {
                    for k in 0..=10 {
                        let p = outline.point(piece, f64::from(k) / 10.0);
                        prop_assert!(p.x.is_finite() && p.y.is_finite());
                        prop_assert!(p.y > -1e-12 && p.y.atan2(p.x) < std::f64::consts::PI / f64::from(teeth) + 1e-9);
                    }
                }
                let _ = GearPair::new(gear.clone(), gear, 2.0 * reference * 1.001);
            }
        }
    }
}

#[test]
fn invariant_sides_are_mirror_images() {
    let pair = nonunity_pair();
    let (a, b) =
        (pair.pinion().flank_point(FlankSide::Upper, 0.018), pair.pinion().flank_point(FlankSide::Lower, 0.018));
    assert_eq!((a.x, a.y), (b.x, -b.y));
}

/// Coast flanks: the pair seen in a mirror, its wheel turned through the backlash, has teeth where a pair at the coast flanks' mesh cycle has them.
#[test]
fn invariant_coast_cycle() {
    for pair in [nonunity_pair(), ring_pair()] {
        for mesh_cycle in [0.0, 0.3, -1.7] {
            let mirrored = pair.coast_cycle(mesh_cycle);
            let opening = pair.closing_direction() * pair.backlash() / pair.working_pitch_radius(Member::Wheel);
            for (member, turned) in [(Member::Pinion, 0.0), (Member::Wheel, -opening)] {
                let driving = pair.tooth_angle(member, 0, mesh_cycle) + turned;
                let coasting = pair.tooth_angle(member, 0, mirrored);
                let teeth = (coasting + driving) / std::f64::consts::TAU * f64::from(pair.gear(member).teeth());
                assert!((teeth - teeth.round()).abs() < 1e-9, "{member:?} {mesh_cycle}: {teeth}");
            }
        }
    }
}
