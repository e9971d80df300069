use fecm::body::{BodyOptions, BoreCondition, GearBody};
use fecm::{FaceModel, GearModes, Material, MeshDensity, ModesOptions};
use gear_geom::{FlankSide, Gear, GearSpec, ToothThickness};
use std::time::Instant;

fn gear(teeth: u32) -> Gear {
    let module = 6e-3;
    let radius = 0.5 * module * f64::from(teeth);
    Gear::new(&GearSpec {
        teeth,
        thickness: ToothThickness::AtReference(0.5 * std::f64::consts::PI * module - 0.05e-3),
        tip_radius: radius + module,
        root_radius: radius - 1.25 * module,
        rim_radius: 0.4 * radius,
        ..GearSpec::default()
    })
    .unwrap()
}
fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    for teeth in [27, 12, 100] {
        let t = Instant::now();
        let body = GearBody::new(
            &gear(teeth),
            FlankSide::Upper,
            &Material::STEEL,
            &BodyOptions {
                mesh: MeshDensity::default(),
                face: FaceModel::Solid { order: 6 },
                width: 25e-3,
                bore: BoreCondition::RigidHub,
                matching_depth: 0.9e-3,
                reach: 3,
                antisymmetric: false,
                cracks: vec![],
            },
            "g",
        )
        .unwrap();
        println!("teeth {teeth} body {:?} {:?}", t.elapsed(), body.sizes());
        for count in [20, 100] {
            let mut reference: Vec<f64> = vec![];
            for k in [1e-9, 1e-1, 1e-2, 1e-3, 1e-4] {
                let t = Instant::now();
                let modes = GearModes::new(&body, &ModesOptions { count, tolerance: k }).unwrap();
                let time = t.elapsed();
                let f: Vec<f64> = modes.modes.iter().map(|m| m.angular_frequency).collect();
                if reference.is_empty() {
                    reference = f.clone();
                }
                let e = f.iter().zip(&reference).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
                println!(
                    "count {count} tol {k:e} time {time:?} n {} lowest {:.1} Hz highest {:.1} Hz error {e:.2e}",
                    f.len(),
                    f[0] / 6.2832,
                    f[f.len() - 1] / 6.2832
                );
            }
        }
    }
}
