//! The planetary stage of the dissertation. The file is part of test binaries of several crates.

use std::f64::consts::TAU;

use gear_geom::{FilletSpec, Gear, GearKind, GearSpec, PlanetaryTrainSpec, ToothThickness};

/// The planetary stage of Tables 5.1 and 7.1. Not printed: the ring's tooth thickness (here with the planet's backlash against the sun, 0.31 mm) and
/// root circle (clearance of a quarter module), fillets.
pub fn dissertation_spec() -> PlanetaryTrainSpec {
    let module = 2.0 * 88.9e-3 / 62.0;
    let common =
        GearSpec { module, pressure_angle: 24.6_f64.to_radians(), tip_round: 0.02 * module, ..GearSpec::default() };
    let sun = GearSpec {
        teeth: 27,
        thickness: ToothThickness::AtReference(4.52e-3),
        tip_radius: 84.05e-3 / 2.0,
        root_radius: 70.76e-3 / 2.0,
        rim_radius: 62.23e-3 / 2.0,
        facewidth: 34.93e-3,
        fillet: FilletSpec::Rack { tip_radius: 0.86e-3 },
        ..common.clone()
    };
    let planet = GearSpec {
        teeth: 35,
        thickness: ToothThickness::AtReference(4.18e-3),
        tip_radius: 104.98e-3 / 2.0,
        root_radius: 91.54e-3 / 2.0,
        rim_radius: 77.9e-3 / 2.0,
        facewidth: 31.75e-3,
        fillet: FilletSpec::Rack { tip_radius: 0.55e-3 },
        ..common.clone()
    };
    let ring = GearSpec {
        kind: GearKind::Internal,
        teeth: 99,
        thickness: ToothThickness::AtReference(6.92e-3),
        tip_radius: 271.75e-3 / 2.0,
        root_radius: 88.9e-3 + 104.98e-3 / 2.0 + 0.25 * module,
        rim_radius: 296.55e-3 / 2.0,
        facewidth: 25.4e-3,
        fillet: FilletSpec::Circular { radius: 0.5e-3 },
        ..common
    };
    PlanetaryTrainSpec {
        sun: Gear::new(&sun).unwrap(),
        planet: Gear::new(&planet).unwrap(),
        ring: Gear::new(&ring).unwrap(),
        centre_distance: 88.9e-3,
        planet_angles: (0..3).map(|n| f64::from(n) * TAU / 3.0).collect(),
        ring_tooth_angle: 0.0,
        sun_tooth_angle: 0.0,
    }
}
