//! Damaged teeth: element order and density, contact cells, cells and order along the face; cracked and pitted, 3-D and plane.
//!
//! The nonunity pair of `configs/`. Errors are those of what damage is judged by: the increase of the transmission error over the healthy pair,
//! root mean square over the positions and relative to its largest value, and the stress-intensity factor of a crack. Time is that of one more
//! severity: meshing and condensing what is damaged, and all positions, from a healthy model that exists.

use std::path::Path;
use std::time::Instant;

use fecm::FaceModel;
use fecm::statics::{PairModel, PairModelOptions, StaticsRequest};
use gear_geom::{Damage, GearPair, Pit, ProfileMeasure, RootCrack, ToothDamage};
use gearwright_case as case;

use super::report::{Entry, Report};

const POSITIONS: u32 = 24;

struct Scene {
    name: &'static str,
    title: &'static str,
    pair: GearPair,
    torque: f64,
    damage: Kind,
    default: PairModelOptions,
    reference: PairModelOptions,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Crack,
    Pit,
}

/// Increase of the transmission error (m), largest stress-intensity factor by position (Pa sqrt(m)).
type Curves = [Vec<f64>; 2];

/// Runs the study.
pub fn run() -> anyhow::Result<()> {
    for scene in scenes()? {
        let (reference, time) = solve(&scene, &scene.reference)?;
        println!("{}: reference in {time:.1} s", scene.name);
        let quantities = match scene.damage {
            Kind::Crack => vec!["increase of the transmission error", "stress-intensity factor"],
            Kind::Pit => vec!["increase of the transmission error"],
        };
        let mut entries = Vec::new();
        for (family, setting, options) in choices(&scene) {
            let (curves, time) = solve(&scene, &options)?;
            let errors: Vec<f64> = (0..quantities.len()).map(|k| relative_error(&curves[k], &reference[k])).collect();
            println!("{family:>24} {setting:>6}: {time:.3} s, {errors:.5?}");
            entries.push(Entry { family, setting, is_default: options == scene.default, time, errors });
        }
        let (mesh, contact) = (scene.reference.pinion.mesh, scene.reference.contact);
        Report {
            name: scene.name,
            title: format!("Damaged teeth: error against run time, {}", scene.title),
            text: format!(
                "Written by `cargo xtask work-precision damage`. One parameter varied at a time, the others at their defaults; {POSITIONS} positions over two mesh\n\
                 cycles. Errors are root mean squares over the largest value, against element order {}, density {}, {} cells per half width, {} face\n\
                 cells, face model {:?}. Time is that of one more severity once the healthy pair is condensed.",
                mesh.order, mesh.density, contact.cells_per_half_width, contact.face_cells, scene.reference.face,
            ),
            quantities,
            entries,
        }
        .write()?;
    }
    Ok(())
}

fn scenes() -> anyhow::Result<Vec<Scene>> {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs");
    let mut scenes = Vec::new();
    for (file, name, title, damage) in [
        ("nonunity-pair-plane.toml", "damage-crack-plane", "50 % crack, plane stress", Kind::Crack),
        ("nonunity-pair.toml", "damage-crack-solid", "50 % crack, 3-D", Kind::Crack),
        ("nonunity-pair.toml", "damage-pit-solid", "pit of 16.51 x 3.35 mm at the pitch point, 3-D", Kind::Pit),
    ] {
        let case = case::load_spur_pair(&configs.join(file))?;
        let mut reference = case.options.clone();
        let solid = matches!(case.options.face, FaceModel::Solid { .. });
        for member in [&mut reference.pinion, &mut reference.wheel] {
            (member.mesh.order, member.mesh.density) = if solid { (4, 1.6) } else { (6, 3.0) };
        }
        reference.contact.cells_per_half_width = if solid { 12.0 } else { 30.0 };
        if solid {
            reference.contact.face_cells = 96;
            reference.face = FaceModel::Solid { order: 10 };
        }
        let torque = case.inputs.load.torque_n_m;
        scenes.push(Scene { name, title, pair: case.pair, torque, damage, default: case.options, reference });
    }
    Ok(scenes)
}

/// Parameter, value and the options that have it.
fn choices(scene: &Scene) -> Vec<(String, String, PairModelOptions)> {
    let mut all = Vec::new();
    let mut add = |family: &str, setting: String, change: &dyn Fn(&mut PairModelOptions)| {
        let mut options = scene.default.clone();
        change(&mut options);
        all.push((family.to_owned(), setting, options));
    };
    let mesh = |options: &mut PairModelOptions, order: usize, density: f64| {
        for member in [&mut options.pinion, &mut options.wheel] {
            (member.mesh.order, member.mesh.density) = (order, density);
        }
    };
    for order in [1, 2, 3, 4] {
        add("element order", order.to_string(), &|o| mesh(o, order, 1.0));
    }
    for (order, densities) in [(2, [0.7, 1.4, 2.0]), (3, [0.6, 1.0, 1.5])] {
        for density in densities {
            add(&format!("density, order {order}"), density.to_string(), &|o| mesh(o, order, density));
        }
    }
    for cells in [3.0, 4.0, 6.0, 8.0, 12.0] {
        add("cells per half width", cells.to_string(), &|o| o.contact.cells_per_half_width = cells);
    }
    if matches!(scene.default.face, FaceModel::Solid { .. }) {
        for cells in [6, 12, 24, 48] {
            add("face cells", cells.to_string(), &|o| o.contact.face_cells = cells);
        }
        for order in [2, 4, 6, 8] {
            add("face order", order.to_string(), &|o| o.face = FaceModel::Solid { order });
        }
    }
    all
}

fn solve(scene: &Scene, options: &PairModelOptions) -> anyhow::Result<(Curves, f64)> {
    let healthy = PairModel::new(&scene.pair, options)?;
    let damage = match scene.damage {
        Kind::Crack => Damage::Crack(RootCrack::along_chord(healthy.bodies()[0].side, 0.5)),
        Kind::Pit => {
            let measure = ProfileMeasure::ArcLength { base_radius: scene.pair.pinion().base_radius() };
            Damage::Pit(Pit::ellipse(0.0, scene.pair.pitch_roll(), 16.51e-3, 3.35e-3, measure))
        }
    };
    let request = StaticsRequest::new(
        (0..POSITIONS).map(|k| 2.0 * f64::from(k) / f64::from(POSITIONS) - 1.0).collect::<Vec<_>>(),
        [scene.torque],
    )
    .keeping_pressure();
    let before = healthy.solve(&request, &())?.results.remove(0);
    let started = Instant::now();
    let damaged = healthy.with_damage(&[vec![ToothDamage { tooth: 0, damage }], vec![]])?;
    let after = damaged.solve(&request, &())?.results.remove(0);
    let time = started.elapsed().as_secs_f64();
    let increase =
        after.iter().zip(&before).map(|(d, h)| d.static_transmission_error - h.static_transmission_error).collect();
    let tips = damaged.crack_tip_reader().read_all(&after)?;
    let largest = tips.iter().map(|tips| tips.iter().map(|tip| tip.k_one).fold(0.0, f64::max)).collect();
    Ok(([increase, largest], time))
}

/// Root mean square of the difference over the largest value of the reference.
fn relative_error(values: &[f64], reference: &[f64]) -> f64 {
    let squares: f64 = values.iter().zip(reference).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / reference.len() as f64).sqrt() / reference.iter().copied().fold(0.0, f64::max)
}
