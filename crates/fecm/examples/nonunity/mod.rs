//! The dissertation's nonunity pair.

use gear_geom::{FilletSpec, Gear, GearPair, GearSpec, GeometryErrors, ToothThickness};

/// Table 3.1; bores and fillets are not printed: `configs/nonunity-pair.toml` says where they come from.
pub fn pair() -> Result<GearPair, GeometryErrors> {
    let gear = |teeth, thickness: f64, tip: f64, root: f64, bore: f64, face: f64, corner: f64| {
        Gear::new(&GearSpec {
            teeth,
            module: 2.0 * 88.9e-3 / 62.0,
            pressure_angle: 24.6_f64.to_radians(),
            thickness: ToothThickness::AtReference(thickness * 1e-3),
            tip_radius: 0.5e-3 * tip,
            root_radius: 0.5e-3 * root,
            rim_radius: 1e-3 * bore,
            facewidth: 1e-3 * face,
            fillet: FilletSpec::Rack { tip_radius: 1e-3 * corner },
            tip_round: 0.05e-3,
            ..GearSpec::default()
        })
    };
    let pinion = gear(27, 4.52, 84.05, 70.76, 25.4, 34.925, 0.86)?;
    let wheel = gear(35, 4.18, 104.98, 91.54, 37.7, 31.75, 0.55)?;
    GearPair::new(pinion, wheel, 88.9e-3)
}
