//! Dynamics: steps a mesh cycle, elastic modes, contact cells, step solver and integrator.
//!
//! The nonunity pair of `configs/dynamics-4000rpm-*.toml` in steady motion: healthy in plane stress; in 3-D healthy and with the pit of 12.7 mm, whose
//! difference signal is judged. One parameter is varied at a time; its errors are against its own finest value, with everything else at the
//! default, so that they are of this parameter alone. Time is wall time with everything: meshing, condensation, transient and record.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, bail, ensure};
use fecm::dynamics::{
    DynamicsOptions, DynamicsRequest, InitialState, Integrator, PairDynamics, SteadySpec, StepSolver,
};
use fecm::statics::{PairModel, PairModelOptions};
use gear_geom::{GearPair, ToothDamage};
use gearwright_case::{self as case, Case};

use super::report::{Entry, Report};

/// What is left of the transient.
const STEADY: f64 = 1e-6;
/// Mesh cycles to give up after.
const MOST_CYCLES: usize = 500;

/// Numerics of a run.
#[derive(Debug, Clone, PartialEq)]
struct Numerics {
    model: PairModelOptions,
    options: DynamicsOptions,
    steps: usize,
}

struct Scene {
    name: &'static str,
    title: &'static str,
    pair: GearPair,
    damage: Option<[Vec<ToothDamage>; 2]>,
    speed: f64,
    torque: f64,
    default: Numerics,
}

/// One parameter: its values, and the finest, against which the others count.
struct Family {
    name: &'static str,
    values: Vec<(String, Numerics)>,
    finest: Numerics,
}

/// Runs the study.
pub fn run() -> anyhow::Result<()> {
    let plane = scene("dynamics-4000rpm-plane.toml", "dynamics-plane", "healthy nonunity pair, plane stress", None)?;
    let solid =
        scene("dynamics-4000rpm-pits.toml", "dynamics-solid", "nonunity pair, pit of 12.7 x 2.76 mm, 3-D", Some(1))?;
    let families = plane_families(&plane.default);
    study(&plane, &families, vec!["transmission error"])?;
    let families = solid_families(&solid.default);
    study(&solid, &families, vec!["transmission error, healthy", "difference signal of the pit"])
}

fn study(scene: &Scene, families: &[Family], quantities: Vec<&'static str>) -> anyhow::Result<()> {
    let mut entries = Vec::new();
    for family in families {
        let (reference, time) = solve(scene, &family.finest)?;
        println!("{}, {}: finest in {time:.1} s", scene.name, family.name);
        for (setting, numerics) in &family.values {
            let (curves, time) = solve(scene, numerics)?;
            let errors: Vec<f64> = curves.iter().zip(&reference).map(|(own, fine)| relative_error(own, fine)).collect();
            println!("{:>24} {setting:>24}: {time:.3} s, {errors:.6?}", family.name);
            let is_default = *numerics == scene.default;
            entries.push(Entry { family: family.name.to_owned(), setting: setting.clone(), is_default, time, errors });
        }
    }
    let finest: Vec<String> =
        families.iter().map(|family| format!("{}: {}", family.name, family.finest_says())).collect();
    Report {
        name: scene.name,
        title: format!("Dynamics: error against run time, {}", scene.title),
        text: format!(
            "Written by `cargo xtask work-precision dynamics`. 4000 rpm (1800 Hz mesh frequency), 424 N m, steady motion. One parameter varied at a time, the others\n\
             at their defaults. Errors are root mean squares of the difference to the finest value of the same parameter ({}), relative to\n\
             the root mean square of the finest curve about its mean. Elastic modes have a damping ratio of 0.01. Time is wall time on all cores with meshing, condensation, transient and record.",
            finest.join("; "),
        ),
        quantities,
        entries,
    }
    .write()
}

fn scene(file: &str, name: &'static str, title: &'static str, severity: Option<usize>) -> anyhow::Result<Scene> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs").join(file);
    let Case::Dynamics(case) = case::load(&path)? else { bail!("{file} is not a dynamics case") };
    let damage = severity.and_then(|index| case.severities.get(index)).map(|(_, severity)| severity.damage.clone());
    ensure!(damage.is_some() == severity.is_some(), "{file} has no severity {severity:?}");
    ensure!(case.speeds.len() == 1, "{file} has {} speeds, not one", case.speeds.len());
    let steps = case.steps.with_context(|| format!("{file} has no steps_per_mesh_cycle"))?;
    let default = Numerics { model: case.statics.options.clone(), options: case.options.clone(), steps };
    Ok(Scene {
        name,
        title,
        pair: case.statics.pair.clone(),
        damage,
        speed: case.speeds[0],
        torque: case.torque,
        default,
    })
}

/// Values of a parameter, the finest last.
fn family<T: Copy>(
    name: &'static str,
    default: &Numerics,
    values: &[T],
    says: impl Fn(T) -> String,
    set: impl Fn(&mut Numerics, T),
) -> Family {
    let with = |value: T| {
        let mut numerics = default.clone();
        set(&mut numerics, value);
        numerics
    };
    let (last, values) = values.split_last().map_or((None, values), |(last, rest)| (Some(*last), rest));
    Family {
        name,
        values: values.iter().map(|&value| (says(value), with(value))).collect(),
        finest: last.map_or_else(|| default.clone(), with),
    }
}

fn steps(default: &Numerics, values: &[usize]) -> Family {
    family("steps a mesh cycle", default, values, |n| n.to_string(), |numerics, n| numerics.steps = n)
}

fn cells(default: &Numerics, values: &[f64]) -> Family {
    let set = |numerics: &mut Numerics, n| numerics.model.contact.cells_per_half_width = n;
    family("cells per half width", default, values, |n| n.to_string(), set)
}

fn integrators(default: &Numerics, finest_steps: usize) -> Family {
    let alpha = |spectral_radius| Integrator::GeneralizedAlpha { spectral_radius };
    let values = [Integrator::AverageAcceleration, alpha(1.0), alpha(0.8), alpha(0.5)].map(|i| (i, default.steps));
    let says = |(integrator, _)| match integrator {
        Integrator::AverageAcceleration => "average acceleration".to_owned(),
        Integrator::GeneralizedAlpha { spectral_radius } => format!("generalised alpha {spectral_radius}"),
    };
    let all = [&values[..], &[(Integrator::AverageAcceleration, finest_steps)]].concat();
    family("integrator", default, &all, says, |numerics, (integrator, steps)| {
        (numerics.options.integrator, numerics.steps) = (integrator, steps);
    })
}

fn plane_families(default: &Numerics) -> Vec<Family> {
    let solvers = [(StepSolver::Newton, "Newton"), (StepSolver::Lemke, "Lemke"), (StepSolver::Newton, "Newton")];
    vec![
        steps(default, &[10, 25, 50, 100, 200, 400, 1600]),
        family(
            "elastic modes",
            default,
            &[0, 5, 20, 100, 400],
            |n| n.to_string(),
            |numerics, n| {
                for rotor in &mut numerics.options.rotors {
                    rotor.modes = n;
                }
                // without damping of their own, high modes hardly die away
                numerics.options.damping.modal_ratio = if n > 0 { 0.01 } else { 0.0 };
            },
        ),
        cells(default, &[2.0, 3.0, 4.0, 6.0, 8.0, 16.0]),
        family(
            "step solver",
            default,
            &solvers,
            |(_, name)| name.to_owned(),
            |numerics, (solver, _)| {
                numerics.options.solver = solver;
            },
        ),
        integrators(default, 1600),
    ]
}

fn solid_families(default: &Numerics) -> Vec<Family> {
    vec![
        steps(default, &[25, 50, 100, 200]),
        cells(default, &[2.0, 3.0, 4.0, 6.0]),
        family(
            "face cells",
            default,
            &[12, 16, 24, 36, 48],
            |n| n.to_string(),
            |numerics, n| numerics.model.contact.face_cells = n,
        ),
    ]
}

impl Family {
    fn finest_says(&self) -> String {
        let Numerics { model, options, steps } = &self.finest;
        match self.name {
            "elastic modes" => options.rotors[0].modes.to_string(),
            "cells per half width" => model.contact.cells_per_half_width.to_string(),
            "face cells" => model.contact.face_cells.to_string(),
            "step solver" => "Newton".to_owned(),
            _ => format!("{steps} steps"),
        }
    }
}

/// Transmission error of the healthy pair over a mesh cycle, difference signal over a rotation; seconds.
fn solve(scene: &Scene, numerics: &Numerics) -> anyhow::Result<(Vec<Vec<f64>>, f64)> {
    let started = Instant::now();
    let healthy = PairModel::new(&scene.pair, &numerics.model)?;
    let dynamics = PairDynamics::new(&healthy, &numerics.options)?;
    let request = DynamicsRequest::running(scene.speed, numerics.steps, scene.torque);
    let spec = SteadySpec { period: numerics.steps, tolerance: STEADY, most_periods: MOST_CYCLES };
    let (run, change) = dynamics.start(&request)?.settle(&spec, &())?;
    ensure!(change < STEADY, "{}: not steady after {MOST_CYCLES} mesh cycles: {change:.1e}", scene.name);
    let cycle = run.transmission_errors();
    let mut curves = vec![cycle.clone()];
    if let Some(damage) = &scene.damage {
        // sets out from the healthy motion; one rotation for its own transient
        let mut state = run.state;
        state.step = 0;
        let damaged = healthy.with_damage(damage)?;
        let dynamics = PairDynamics::new(&damaged, &numerics.options)?;
        let rotation = dynamics.period() as usize * numerics.steps;
        let mut runner = dynamics.start(&DynamicsRequest { initial: InitialState::Given(state), ..request })?;
        runner.advance(rotation, &())?;
        let damaged = runner.advance(rotation, &())?.transmission_errors();
        curves.push(damaged.iter().zip(cycle.iter().cycle()).map(|(d, h)| d - h).collect());
    }
    Ok((curves, started.elapsed().as_secs_f64()))
}

/// Root mean square of the difference at the coarser curve's places, over that of the finer one about its mean.
fn relative_error(coarse: &[f64], fine: &[f64]) -> f64 {
    let every = fine.len() / coarse.len();
    let squares: f64 =
        coarse.iter().zip(fine.iter().skip(every - 1).step_by(every)).map(|(a, b)| (a - b).powi(2)).sum();
    let mean = fine.iter().sum::<f64>() / fine.len() as f64;
    let variance = fine.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / fine.len() as f64;
    (squares / coarse.len() as f64 / variance).sqrt()
}
