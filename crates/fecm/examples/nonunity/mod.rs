//! The dissertation's nonunity pair.

use gear_geom::{FilletSpec, Gear, GearPair, GearSpec, GeometryErrors, ToothThickness};

/// Table 3.1; bores and fillets are not printed: `configs/nonunity-pair.toml` says where they come from.
pub fn pair() -> Result<GearPair, GeometryErrors> {
    let gear = |teeth, thickness: f64, tip: f64, root: f64, bore: f64, face: f64, corner: f64| {
        Gear::new(&GearSpec::standard(teeth, 2.0 * 88.9e-3 / 62.0).with(|spec| {
            spec.pressure_angle = 24.6_f64.to_radians();
            spec.thickness = ToothThickness::AtReference(thickness * 1e-3);
            spec.tip_radius = 0.5e-3 * tip;
            spec.root_radius = 0.5e-3 * root;
            spec.rim_radius = 1e-3 * bore;
            spec.facewidth = 1e-3 * face;
            spec.fillet = FilletSpec::Rack { tip_radius: 1e-3 * corner };
            spec.tip_round = 0.05e-3;
        }))
    };
    let pinion = gear(27, 4.52, 84.05, 70.76, 25.4, 34.925, 0.86)?;
    let wheel = gear(35, 4.18, 104.98, 91.54, 37.7, 31.75, 0.55)?;
    GearPair::new(pinion, wheel, 88.9e-3)
}
