//! Transmission: steps in time, mesh tables, housing.
//!
//! The dissertation's transmission of [`crate::train`], from rest in equilibrium through a planet pass of transient to a recorded one, unless the parameter is
//! one of these. One parameter is varied at a time, the others at their defaults; errors are against its own finest value.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Instant;

use anyhow::ensure;
use fecm::FaceModel;
use fecm::statics::PairModelOptions;
use gear_geom::MeshSite;
use planetary::elastic::ElasticBody;
use planetary::engine::{RunRequest, STAGES, Transmission, TransmissionRun};
use planetary::housing::{Casing, ReducedHousing, ReductionOptions};
use planetary::mesh::{MeshLaw, MeshTable, TableOptions};

use super::report::{Entry, Report};
use crate::train::{self, POSITIONS, STEPS_PER_SAMPLE, Scene};

/// Positions of the finest tables, which the study of steps uses too.
const FINEST_POSITIONS: usize = 512;
/// Steps per sample, and stages, of the reference in time.
const FINE: (usize, usize) = (8, 4);
/// Planet passes after which bevel mesh and planets are where they were.
const PASSES: usize = 9;
const ACCELERATION: &str = "acceleration";
const FORCE: &str = "mesh forces";
const TRANSIENT: &str = "a planet pass of transient and one recorded";

/// Records of a planet pass.
struct Curves {
    /// Rows of sensors, then of meshes.
    accelerations: Vec<Vec<f64>>,
    forces: Vec<Vec<f64>>,
}

/// Runs the study.
pub fn run() -> anyhow::Result<()> {
    let started = Instant::now();
    let gears = train::train(train::equal(3))?;
    let housing = train::reduced(&train::casing(train::element_size()), &ReductionOptions::default())?;
    let mut scene = Scene {
        laws: train::tables(&gears, FaceModel::PlaneStress, POSITIONS)?,
        bevel: Some(train::bevel_law()?),
        places: train::places(&housing.body),
        housing: Some(housing.body),
        train: gears,
    };
    println!("scene in {:.1} s", started.elapsed().as_secs_f64());
    housings(&scene)?;
    scene.laws = meshes(&scene)?;
    time(&scene)
}

/// Steps, stages, transient.
fn time(scene: &Scene) -> anyhow::Result<()> {
    let mut entries = Vec::new();
    let of = |(steps, stages): (usize, usize)| RunRequest { stages, ..train::request(steps, 1) };
    let (reference, seconds) = solve(scene, &of(FINE))?;
    println!("{} steps a sample, {} stages: {seconds:.1} s", FINE.0, FINE.1);
    for stages in 1..=4 {
        for steps in [1, 2, 4, 8].into_iter().filter(|steps| (*steps, stages) != FINE) {
            let (own, seconds) = solve(scene, &of((steps, stages)))?;
            let is_default = (steps, stages) == (STEPS_PER_SAMPLE, STAGES);
            let family = format!("steps per sample, {stages} {}", if stages == 1 { "stage" } else { "stages" });
            entries.push(entry(&family, steps, is_default, seconds, own.errors(&reference)));
        }
    }
    for passes in 0..=3 {
        let (own, seconds) = solve(scene, &train::request(STEPS_PER_SAMPLE, passes))?;
        let (settled, _) = solve(scene, &train::request(STEPS_PER_SAMPLE, passes + PASSES))?;
        let name = "planet passes before the record";
        entries.push(entry(name, passes, passes == 1, seconds, own.errors(&settled)));
    }
    write(
        "transmission-time",
        "steps in time",
        &format!(
            "Time is that of the run: equilibrium, {TRANSIENT}; tables of {FINEST_POSITIONS} positions a mesh cycle are made before. Steps and stages against {} steps a sample of {} stages; planet passes before the record against the same places of the transmission {PASSES} passes later.",
            FINE.0, FINE.1,
        ),
        vec![ACCELERATION, FORCE],
        entries,
    )
}

/// Tables: positions, tolerance, model of the face. Gives the finest laws.
fn meshes(scene: &Scene) -> anyhow::Result<[Arc<dyn MeshLaw>; 2]> {
    let gears = &scene.train;
    let model = |site, face: FaceModel| train::model(gears, site, face);
    let plane =
        [model(MeshSite::SunPlanet, FaceModel::PlaneStress)?, model(MeshSite::PlanetRing, FaceModel::PlaneStress)?];
    let mut entries = Vec::new();
    let make = |positions: usize, tolerance: f64| -> anyhow::Result<([Arc<dyn MeshLaw>; 2], f64)> {
        let clock = Instant::now();
        let mut laws = scene.laws.clone();
        for k in 0..plane.len() {
            let options = TableOptions { tolerance, ..train::table_options(gears, positions) };
            laws[k] = Arc::new(MeshTable::from_contact(&plane[k], &options, &())?);
        }
        Ok((laws, clock.elapsed().as_secs_f64()))
    };
    let with = |laws: &[Arc<dyn MeshLaw>; 2]| -> anyhow::Result<Curves> {
        let own = Scene { laws: laws.clone(), ..scene.clone() };
        Ok(solve(&own, &train::request(STEPS_PER_SAMPLE, 1))?.0)
    };
    let tolerance = train::table_options(gears, POSITIONS).tolerance;
    let (finest, seconds) = make(FINEST_POSITIONS, tolerance)?;
    println!("{FINEST_POSITIONS} positions in {seconds:.1} s");
    let fine = with(&finest)?;
    for positions in [16, 32, 64, POSITIONS, 256] {
        let (laws, seconds) = make(positions, tolerance)?;
        let errors = with(&laws)?.errors(&fine);
        entries.push(entry("positions a mesh cycle", positions, positions == POSITIONS, seconds, errors));
    }
    let fine = with(&make(POSITIONS, 1e-6)?.0)?;
    for allowed in [1e-1, 1e-2, tolerance, 1e-4] {
        let (laws, seconds) = make(POSITIONS, allowed)?;
        let errors = with(&laws)?.errors(&fine);
        entries.push(entry("tolerance", format!("{allowed:.0e}"), allowed == tolerance, seconds, errors));
    }
    let solid = PairModelOptions::default().face;
    let face = |face| -> anyhow::Result<(Curves, f64)> {
        let clock = Instant::now();
        let laws = train::tables(gears, face, POSITIONS)?;
        let seconds = clock.elapsed().as_secs_f64();
        Ok((with(&laws)?, seconds))
    };
    let (fine, seconds) = face(solid)?;
    println!("3-D tables in {seconds:.1} s");
    for (model, name) in [(FaceModel::PlaneStress, "plane stress"), (FaceModel::PlaneStrain, "plane strain")] {
        let (own, seconds) = face(model)?;
        entries.push(entry("model of the teeth", name, model == FaceModel::PlaneStress, seconds, own.errors(&fine)));
    }
    write(
        "transmission-meshes",
        "mesh tables",
        &format!(
            "Time is that of both tables of the planetary stage, which the program makes once and keeps. Positions against {FINEST_POSITIONS}; tolerance where tooth pairs join against 1e-6; plane models against 3-D, made in {seconds:.0} s."
        ),
        vec![ACCELERATION, FORCE],
        entries,
    )?;
    Ok(finest)
}

/// Modes, static responses, mesh of the housing.
fn housings(scene: &Scene) -> anyhow::Result<()> {
    let mut entries = Vec::new();
    let default = ReductionOptions::default();
    let options = |modes, highest_frequency| ReductionOptions { modes, highest_frequency, ..default };
    let usual = train::casing(train::element_size());
    let make = |casing: &Casing, options: &ReductionOptions| -> anyhow::Result<(ReducedHousing, f64)> {
        let clock = Instant::now();
        let reduced = train::reduced(casing, options)?;
        Ok((reduced, clock.elapsed().as_secs_f64()))
    };
    let with = |body: ElasticBody| -> anyhow::Result<(Curves, f64)> {
        let own = Scene { housing: Some(body), ..scene.clone() };
        solve(&own, &train::request(STEPS_PER_SAMPLE, 1))
    };
    let (most, _) = make(&usual, &options(MODES, 20e3))?;
    let (fine, _) = with(most.body.clone())?;
    println!("{} modes to 20 kHz of {:.0} Hz found", most.stats.modes, most.stats.complete_to);
    ensure!(most.stats.complete_to >= 20e3, "{MODES} modes end at {:.0} Hz", most.stats.complete_to);
    for hertz in [2e3, 5e3, 10e3, default.highest_frequency, 15e3] {
        // one more, so that all below are there
        let modes = most.body.frequencies.iter().filter(|frequency| **frequency <= TAU * hertz).count() + 1;
        let (reduced, seconds) = make(&usual, &options(modes, hertz))?;
        let says = format!("{:.0} kHz, {} modes", 1e-3 * hertz, reduced.stats.modes);
        let modes = reduced.stats.modes;
        let alone = modes_alone(&reduced.body, modes);
        let (own, run) = with(reduced.body)?;
        let is_default = hertz == default.highest_frequency;
        let errors = own.errors(&fine);
        entries.push(entry("highest frequency", says.clone(), is_default, seconds + run, errors));
        let (own, run) = with(alone)?;
        entries.push(entry("without static responses", says, false, seconds + run, own.errors(&fine)));
    }
    write(
        "transmission-housing",
        "modes of the housing",
        &format!(
            "Time is that of meshing, factoring and reducing the housing, and of the run: {TRANSIENT}. Against modes up to 20 kHz ({}). Damping ratio 0.02 of all modes, of static responses too.",
            most.stats.modes
        ),
        vec![ACCELERATION, FORCE],
        entries,
    )?;
    let mut entries = Vec::new();
    let mut casing = usual.clone();
    casing.density.element_size = 0.5 * train::element_size();
    let (finest, seconds) = make(&casing, &default)?;
    println!("{} unknowns in {seconds:.1} s", finest.stats.unknowns);
    let frequencies = finest.body.frequencies.clone();
    let (fine, _) = with(finest.body)?;
    for factor in [2.0, 1.5, 1.0, 0.75] {
        casing.density.element_size = factor * train::element_size();
        let (reduced, seconds) = make(&casing, &default)?;
        let says = format!("{:.0} mm, {} unknowns", 1e3 * casing.density.element_size, reduced.stats.unknowns);
        let frequency = natural_error(&reduced.body.frequencies, &frequencies);
        let (own, run) = with(reduced.body)?;
        let mut errors = own.errors(&fine);
        errors.insert(0, frequency);
        entries.push(entry("element size", says, factor == 1.0, seconds + run, errors));
    }
    write(
        "transmission-housing-mesh",
        "mesh of the housing",
        &format!(
            "Time is that of meshing, factoring and reducing the housing, and of the run: {TRANSIENT}. Elements around and along the wall against {:.0} mm ({} unknowns, {seconds:.0} s); one \
             quadratic element through the wall. Natural frequencies: root mean square of the relative error of the lowest {NATURAL}.",
            500.0 * train::element_size(),
            finest.stats.unknowns,
        ),
        vec!["natural frequencies", ACCELERATION, FORCE],
        entries,
    )
}

/// Modes looked for up to 20 kHz.
const MODES: usize = 600;
/// How many natural frequencies of a housing are compared.
const NATURAL: usize = 40;

fn natural_error(own: &[f64], fine: &[f64]) -> f64 {
    let squares: f64 = own.iter().zip(fine).take(NATURAL).map(|(own, fine)| (own / fine - 1.0).powi(2)).sum();
    (squares / NATURAL as f64).sqrt()
}

/// The body without its static responses, which come after all modes.
fn modes_alone(body: &ElasticBody, modes: usize) -> ElasticBody {
    let mut own = body.clone();
    own.frequencies.truncate(modes);
    own.damping_ratios.truncate(modes);
    for port in &mut own.ports {
        port.shapes = port.shapes.subcols(0, modes).to_owned();
    }
    if let Some(seat) = &mut own.ring_seat {
        seat.shapes = seat.shapes.subcols(0, modes).to_owned();
    }
    own.sensors.iter_mut().for_each(|sensor| sensor.shape.truncate(modes));
    own
}

fn solve(scene: &Scene, request: &RunRequest) -> anyhow::Result<(Curves, f64)> {
    let clock = Instant::now();
    let run = Transmission::new(&scene.spec()?)?.run(request, &())?;
    Ok((Curves::new(run), clock.elapsed().as_secs_f64()))
}

impl Curves {
    fn new(run: TransmissionRun) -> Self {
        Self {
            accelerations: run.sensors.into_iter().map(|sensor| sensor.acceleration).collect(),
            forces: run.meshes.into_iter().map(|mesh| mesh.force).collect(),
        }
    }

    /// Of accelerations and of forces.
    fn errors(&self, fine: &Self) -> Vec<f64> {
        let in_time = |own: &[Vec<f64>], fine: &[Vec<f64>]| {
            let (mut squares, mut variance) = (0.0, 0.0);
            for (own, fine) in own.iter().zip(fine) {
                squares += own.iter().zip(fine).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
                let mean = fine.iter().sum::<f64>() / fine.len() as f64;
                variance += fine.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            }
            (squares / variance).sqrt()
        };
        vec![in_time(&self.accelerations, &fine.accelerations), in_time(&self.forces, &fine.forces)]
    }
}

fn entry(family: &str, setting: impl ToString, is_default: bool, time: f64, errors: Vec<f64>) -> Entry {
    let setting = setting.to_string();
    println!("{family:>32} {setting:>28}: {time:.2} s, {errors:.5?}");
    Entry { family: family.to_owned(), setting, is_default, time, errors }
}

fn write(
    name: &'static str,
    of: &str,
    text: &str,
    quantities: Vec<&'static str>,
    entries: Vec<Entry>,
) -> anyhow::Result<()> {
    Report {
        name,
        title: format!("Transmission: error against run time, {of}"),
        text: format!(
            "Written by `cargo xtask work-precision transmission`. Planetary stage with bevel stage and elastic housing (dissertation, chapter 5; what is not printed there is chosen), \
             6060 rpm, 6106 N m, records of {:.0} kHz, {STEPS_PER_SAMPLE} steps a sample, plane stress unless named. One parameter varied at a time. {text} Errors are root mean squares of the \
             difference over a planet pass, both sensors or all meshes together, relative to the root mean square of the finest curves about their means.",
            1e-3 * train::BAND,
        ),
        quantities,
        entries,
    }
    .write()
}
