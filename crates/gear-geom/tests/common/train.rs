//! The planetary stage of the dissertation. The file is part of test binaries of several crates.

use std::f64::consts::TAU;

use gear_geom::{FilletSpec, Gear, GearKind, GearSpec, PlanetaryTrainSpec, ToothThickness};

/// The planetary stage of Tables 5.1 and 7.1. Not printed: the ring's tooth thickness (here with the planet's backlash against the sun, 0.31 mm) and
/// root circle (clearance of a quarter module), fillets.
pub fn dissertation_spec() -> PlanetaryTrainSpec {
    let module = 2.0 * 88.9e-3 / 62.0;
    let gear = |teeth: u32| GearSpec::standard(teeth, module).with(|spec| spec.pressure_angle = 24.6_f64.to_radians());
    let sun = gear(27).with(|spec| {
        spec.thickness = ToothThickness::AtReference(4.52e-3);
        spec.tip_radius = 84.05e-3 / 2.0;
        spec.root_radius = 70.76e-3 / 2.0;
        spec.rim_radius = 62.23e-3 / 2.0;
        spec.facewidth = 34.93e-3;
        spec.fillet = FilletSpec::Rack { tip_radius: 0.86e-3 };
    });
    let planet = gear(35).with(|spec| {
        spec.thickness = ToothThickness::AtReference(4.18e-3);
        spec.tip_radius = 104.98e-3 / 2.0;
        spec.root_radius = 91.54e-3 / 2.0;
        spec.rim_radius = 77.9e-3 / 2.0;
        spec.facewidth = 31.75e-3;
        spec.fillet = FilletSpec::Rack { tip_radius: 0.55e-3 };
    });
    let ring = gear(99).with(|spec| {
        spec.kind = GearKind::Internal;
        spec.thickness = ToothThickness::AtReference(6.92e-3);
        spec.tip_radius = 271.75e-3 / 2.0;
        spec.root_radius = 88.9e-3 + 104.98e-3 / 2.0 + 0.25 * module;
        spec.rim_radius = 296.55e-3 / 2.0;
        spec.facewidth = 25.4e-3;
        spec.fillet = FilletSpec::Circular { radius: 0.5e-3 };
    });
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
