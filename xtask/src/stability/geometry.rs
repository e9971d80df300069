//! Gears and pairs: extreme ones are made, impossible ones are explained.

use gear_geom::{GearPair, Member};
use nalgebra::Rotation2;

use super::pairs::{Proportions, USUAL};
use super::{Answer, Table};

/// All cases.
pub fn cases() -> Table {
    let mut table = Table::new(
        "gear-geom",
        "Residual: distance of the flanks' points that should touch, over the module, and of their normals from opposite, largest over three tooth \
         pairs and the mesh cycle.",
        &[("conjugacy", 1e-9)],
    );
    let apart = [(0.62, "contact ratio 1.05")];
    let external = [
        ("12 and 12 teeth, 25 deg", Proportions { teeth: [12, 12], pressure_angle: 25.0, ..USUAL }),
        ("12 and 240 teeth, 25 deg", Proportions { teeth: [12, 240], pressure_angle: 25.0, ..USUAL }),
        ("400 and 400 teeth", Proportions { teeth: [400, 400], ..USUAL }),
        ("module 0.2 mm", Proportions { module: 0.2e-3, facewidth: 0.6e-3, ..USUAL }),
        ("module 30 mm", Proportions { module: 30e-3, facewidth: 90e-3, ..USUAL }),
        ("facewidth 500 mm", Proportions { facewidth: 0.5, ..USUAL }),
        ("bore of 0.88 reference radii", Proportions { bore: 0.88, ..USUAL }),
        (
            "contact ratio 2.9: addendum 1.45 modules on 90 and 140 teeth, 17 deg",
            Proportions { teeth: [90, 140], addendum: 1.45, pressure_angle: 17.0, ..USUAL },
        ),
        (apart[0].1, Proportions { apart: apart[0].0, ..USUAL }),
    ];
    for (name, proportions) in external {
        table.answered(name, || Ok(conjugate(&proportions.pair()?)));
    }
    for teeth in [[20, 200], [30, 60]] {
        let proportions = Proportions { teeth, module: 3e-3, ..USUAL };
        table.answered(format!("ring, {} and {} teeth", teeth[0], teeth[1]), || {
            Ok(conjugate(&proportions.internal_pair()?))
        });
    }
    let impossible = [
        ("no teeth", Proportions { teeth: [0, 31], ..USUAL }),
        ("module 0", Proportions { module: 0.0, ..USUAL }),
        ("module NaN", Proportions { module: f64::NAN, ..USUAL }),
        ("facewidth infinite", Proportions { facewidth: f64::INFINITY, ..USUAL }),
        ("bore beyond the root", Proportions { bore: 1.2, ..USUAL }),
        ("pressure angle 90 deg", Proportions { pressure_angle: 90.0, ..USUAL }),
        ("pointed teeth: addendum 3 modules", Proportions { addendum: 3.0, ..USUAL }),
        ("contact ratio below 1: 1 module apart", Proportions { apart: 1.0, ..USUAL }),
        ("too far apart to touch: 3 modules", Proportions { apart: 3.0, ..USUAL }),
        ("teeth that overlap: 0.5 modules too near", Proportions { apart: -0.5, ..USUAL }),
    ];
    for (name, proportions) in impossible {
        table.refused(name, || Ok(conjugate(&proportions.pair()?)));
    }
    table
}

fn conjugate(pair: &GearPair) -> Answer {
    let module = pair.pinion().module();
    let mut worst = 0.0_f64;
    for number in -1..=1 {
        for step in -6..=6 {
            let cycle = f64::from(number) + 0.1 * f64::from(step);
            let [(p, n), (q, m)] = [Member::Pinion, Member::Wheel].map(|member| {
                let (gear, side) = (pair.gear(member), pair.working_side(member));
                let roll = pair.contact_roll(member, number, cycle);
                let turn = Rotation2::new(pair.tooth_angle(member, number, cycle));
                let at = pair.centre(member) + turn * gear.flank_point(side, roll).coords;
                (at, turn * gear.flank_normal(side, roll))
            });
            worst = worst.max((p - q).norm() / module).max((n + m).norm());
        }
    }
    Answer::new(format!("contact ratio {:.3}", pair.contact_ratio()), vec![Some(worst)])
        .with_finite("contact ratio", [pair.contact_ratio()].into_iter())
}
