//! Gears of module 6 mm and pairs of them.
// every test binary uses a part of it
#![allow(dead_code)]

use gear_geom::{Gear, GearPair, GearSpec, ToothThickness};

/// Torque on the wheel (N m).
pub const TORQUE: f64 = 200.0;

/// A gear of module 6 mm with standard proportions and a little backlash.
pub fn gear(teeth: u32) -> Gear {
    let module = 6e-3;
    let radius = 0.5 * module * f64::from(teeth);
    Gear::new(&GearSpec::standard(teeth, 6e-3).with(|spec| {
        spec.thickness = ToothThickness::AtReference(0.5 * std::f64::consts::PI * module - 0.05e-3);
        spec.tip_radius = radius + module;
        spec.root_radius = radius - 1.25 * module;
        spec.rim_radius = 0.4 * radius;
        spec.facewidth = 16e-3;
    }))
    .unwrap()
}

/// Two of them at their standard centre distance.
pub fn pair(first: u32, second: u32) -> GearPair {
    let centre_distance = 0.5 * 6e-3 * f64::from(first + second);
    GearPair::new(gear(first), gear(second), centre_distance).unwrap()
}
