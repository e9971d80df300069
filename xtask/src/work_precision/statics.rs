//! Statics: element order and density, contact cells, cells and order along the face, plane and 3-D.
//!
//! Pair: the nonunity pair of `configs/`, unmodified (plane stress and 3-D) and with relief and crown (3-D). Errors are root mean squares
//! over the positions, relative to the mean, against a solution with everything much finer. Time is wall time on all cores for
//! meshing, condensation and all positions; the smaller of two runs.

use std::path::Path;
use std::time::Instant;

use fecm::FaceModel;
use fecm::statics::{PairModel, PairModelOptions, StaticsRequest};
use gear_geom::GearPair;
use gearwright_case as case;

use super::report::{Entry, Report};

const POSITIONS: u32 = 20;

/// A scene: pair, load, defaults and the fine reference.
struct Scene {
    name: &'static str,
    title: &'static str,
    pair: GearPair,
    torque: f64,
    default: PairModelOptions,
    reference: PairModelOptions,
}

/// Transmission error and local stiffness at all positions.
type Curves = [Vec<f64>; 2];

/// Runs the study.
pub fn run() -> anyhow::Result<()> {
    for scene in scenes()? {
        let (reference, time) = solve(&scene, &scene.reference)?;
        println!("{}: reference in {time:.1} s", scene.name);
        let mut entries = Vec::new();
        for (family, setting, options) in choices(&scene) {
            let (first, time) = solve(&scene, &options)?;
            let (_, again) = solve(&scene, &options)?;
            let errors = (0..2).map(|k| root_mean_square(&first[k], &reference[k])).collect::<Vec<_>>();
            println!(
                "{family:>24} {setting:>6}: {:.3} s, {:.4} % {:.4} %",
                time.min(again),
                100.0 * errors[0],
                100.0 * errors[1]
            );
            let is_default = options == scene.default;
            entries.push(Entry { family, setting, is_default, time: time.min(again), errors });
        }
        Report {
            name: scene.name,
            title: format!("Statics: error against run time, {}", scene.title),
            text: format!(
                "Written by `cargo xtask work-precision statics`. One parameter varied at a time, the others at their defaults; {POSITIONS} positions of a mesh\n\
                 cycle; root-mean-square error relative to the mean, against element order {}, density {}, {} cells per half width, {} face cells, face\n\
                 model {:?} ({time:.1} s).",
                scene.reference.pinion.mesh.order,
                scene.reference.pinion.mesh.density,
                scene.reference.contact.cells_per_half_width,
                scene.reference.contact.face_cells,
                scene.reference.face,
            ),
            quantities: vec!["transmission error", "local-slope stiffness"],
            entries,
        }
        .write()?;
    }
    Ok(())
}

fn scenes() -> anyhow::Result<Vec<Scene>> {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs");
    let mut scenes = Vec::new();
    for (file, name, title) in [
        ("nonunity-pair-plane.toml", "statics-plane", "nonunity pair, plane stress"),
        ("nonunity-pair.toml", "statics-solid", "nonunity pair, 3-D"),
        ("nonunity-pair-modified.toml", "statics-modified", "nonunity pair with relief and crown, 3-D"),
    ] {
        let case = case::load_spur_pair(&configs.join(file))?;
        let mut reference = case.options.clone();
        let solid = matches!(case.options.face, FaceModel::Solid { .. });
        for member in [&mut reference.pinion, &mut reference.wheel] {
            (member.mesh.order, member.mesh.density) = if solid { (5, 1.6) } else { (6, 3.0) };
        }
        reference.contact.cells_per_half_width = if solid { 12.0 } else { 40.0 };
        if solid {
            reference.contact.face_cells = 96;
            reference.face = FaceModel::Solid { order: 12 };
        }
        scenes.push(Scene {
            name,
            title,
            pair: case.pair,
            torque: case.inputs.load.torque_n_m,
            default: case.options,
            reference,
        });
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
    for order in [1, 2, 3, 4, 5] {
        add("element order", order.to_string(), &|o| mesh(o, order, 1.0));
    }
    for (order, densities) in [(1, [1.0, 2.0, 4.0]), (2, [0.7, 1.4, 2.0]), (3, [0.6, 1.0, 1.5])] {
        for density in densities {
            add(&format!("density, order {order}"), density.to_string(), &|o| mesh(o, order, density));
        }
    }
    for cells in [2.0, 3.0, 4.0, 6.0, 8.0, 12.0] {
        add("cells per half width", cells.to_string(), &|o| o.contact.cells_per_half_width = cells);
    }
    for order in [4, 6, 8, 10, 12, 14] {
        add("profile order", order.to_string(), &|o| o.contact.profile_order = order);
    }
    if matches!(scene.default.face, FaceModel::Solid { .. }) {
        for cells in [6, 12, 24, 48] {
            add("face cells", cells.to_string(), &|o| o.contact.face_cells = cells);
        }
        for order in [2, 4, 6, 8, 10] {
            add("face order", order.to_string(), &|o| o.face = FaceModel::Solid { order });
        }
    }
    all
}

fn solve(scene: &Scene, options: &PairModelOptions) -> anyhow::Result<(Curves, f64)> {
    let started = Instant::now();
    let model = PairModel::new(&scene.pair, options)?;
    let mesh_cycles: Vec<f64> = (0..POSITIONS).map(|k| f64::from(k) / f64::from(POSITIONS)).collect();
    let request = StaticsRequest::new(mesh_cycles, [scene.torque]).with_stiffness_difference();
    let results = model.solve(&request, &())?.results.remove(0);
    let time = started.elapsed().as_secs_f64();
    let error = results.iter().map(|r| r.static_transmission_error).collect();
    let stiffness = results.iter().map(|r| r.local_stiffness().unwrap_or_default()).collect();
    Ok(([error, stiffness], time))
}

/// Root mean square of the difference over the mean of the reference.
fn root_mean_square(values: &[f64], reference: &[f64]) -> f64 {
    let count = reference.len() as f64;
    let squares: f64 = values.iter().zip(reference).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / count).sqrt() / (reference.iter().sum::<f64>() / count)
}
