//! Elastic modes of a gear whose hub is held, with sizes and times.
//!
//! `cargo run --release -p fecm --example gear_modes`

use std::time::Instant;

use fecm::body::{BodyOptions, BoreCondition, GearBody};
use fecm::{FaceModel, GearModes, Material, MeshDensity, ModesOptions};
use gear_geom::{FlankSide, Gear, GearSpec};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let gear = Gear::new(&GearSpec::standard(27, 6e-3).with(|spec| {
        spec.tip_radius = 87e-3;
        spec.root_radius = 73.5e-3;
        spec.facewidth = 16e-3;
    }))?;
    let options = BodyOptions {
        mesh: MeshDensity::default(),
        face: FaceModel::Solid { order: 6 },
        width: 25e-3,
        bore: BoreCondition::RigidHub,
        profile_order: 10,
        edge_correction: true,
        reach: 3,
        antisymmetric: false,
        cracks: Vec::new(),
    };
    let started = Instant::now();
    let body = GearBody::new(&gear, FlankSide::Upper, &Material::STEEL, &options, "gear")?;
    println!("body in {:.2?}: {:?}\n{:?}", started.elapsed(), body.sizes(), body.inertia());
    for (count, tolerance) in [(100, 1e-9), (20, 3e-3), (100, 3e-3)] {
        let started = Instant::now();
        let modes = GearModes::new(&body, &ModesOptions { count, tolerance })?;
        println!("{} modes to {tolerance:e} in {:.2?}", modes.modes.len(), started.elapsed());
    }
    println!("\n  f (Hz)  nodal diameters  twin  with the hub along x, y, about z (sqrt(kg), sqrt(kg) mm)");
    for mode in &GearModes::new(&body, &ModesOptions::new(20))?.modes {
        let [x, y, _, _, _, about_z] = mode.rigid_coupling;
        let hertz = mode.angular_frequency / (2.0 * std::f64::consts::PI);
        let (h, twin) = (mode.nodal_diameter, format!("{:?}", mode.twin));
        println!("{hertz:8.1}  {h:15}  {twin:4}  {x:9.5} {y:9.5} {:9.5}", 1e3 * about_z);
    }
    Ok(())
}
