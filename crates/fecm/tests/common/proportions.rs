//! Gear pairs of any proportions, usual ones to start from: what extreme cases vary.
// every binary uses a part of it
#![allow(dead_code)]

use gear_geom::{FilletSpec, Gear, GearKind, GearPair, GearSpec, GeometryErrors, ToothThickness};

/// Two gears and what loads them.
#[derive(Debug, Clone, Copy)]
pub struct Proportions {
    pub teeth: [u32; 2],
    /// Module (m).
    pub module: f64,
    /// Facewidth (m).
    pub facewidth: f64,
    /// Bore over reference radius.
    pub bore: f64,
    /// Addendum (modules).
    pub addendum: f64,
    /// Pressure angle (deg).
    pub pressure_angle: f64,
    /// Added to the sum of the reference radii (modules).
    pub apart: f64,
}

/// 25 and 31 teeth of module 6 mm.
pub const USUAL: Proportions = Proportions {
    teeth: [25, 31],
    module: 6e-3,
    facewidth: 16e-3,
    bore: 0.4,
    addendum: 1.0,
    pressure_angle: 20.0,
    apart: 0.0,
};

impl Proportions {
    fn reference_radius(&self, teeth: u32) -> f64 {
        0.5 * self.module * f64::from(teeth)
    }

    fn spec(&self, teeth: u32) -> GearSpec {
        let radius = self.reference_radius(teeth);
        GearSpec::standard(teeth, self.module).with(|spec| {
            spec.pressure_angle = self.pressure_angle.to_radians();
            spec.thickness = ToothThickness::AtReference((0.5 * std::f64::consts::PI - 0.01) * self.module);
            spec.tip_radius = radius + self.addendum * self.module;
            spec.root_radius = radius - (self.addendum + 0.25) * self.module;
            spec.rim_radius = self.bore * radius;
            spec.facewidth = self.facewidth;
            spec.fillet = FilletSpec::Rack { tip_radius: 0.2 * self.module };
            spec.tip_round = 0.02 * self.module;
        })
    }

    /// Both external.
    pub fn pair(&self) -> Result<GearPair, GeometryErrors> {
        let [pinion, wheel] = self.teeth;
        let centre = self.reference_radius(pinion) + self.reference_radius(wheel) + self.apart * self.module;
        GearPair::new(Gear::new(&self.spec(pinion))?, Gear::new(&self.spec(wheel))?, centre)
    }

    /// The second one a ring of stub teeth.
    pub fn internal_pair(&self) -> Result<GearPair, GeometryErrors> {
        let [pinion, ring] = self.teeth;
        let radius = self.reference_radius(ring);
        let spec = self.spec(ring).with(|spec| {
            spec.kind = GearKind::Internal;
            spec.tip_radius = radius - 0.75 * self.module;
            spec.root_radius = radius + 1.25 * self.module;
            spec.rim_radius = radius + 5.0 * self.module;
            spec.fillet = FilletSpec::Circular { radius: 0.2 * self.module };
        });
        let centre = radius - self.reference_radius(pinion);
        GearPair::new(Gear::new(&self.spec(pinion))?, Gear::new(&spec)?, centre)
    }

    /// Torque on the wheel (N m) that loads the teeth with 100 N per mm of face and mm of module.
    pub fn nominal_torque(&self, pair: &GearPair) -> f64 {
        1e5 * self.facewidth * self.module * 1e3 * pair.wheel().base_radius()
    }
}
