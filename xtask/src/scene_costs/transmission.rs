//! What a transmission can do without.

use std::fs::File;
use std::io::{BufReader, BufWriter, Write as _};
use std::sync::Arc;

use anyhow::Context;
use fecm::FaceModel;
use fecm::statics::PairModelOptions;
use gear_geom::{Damage, Member, MeshSite, PlanetaryTrain, RootCrack};
use planetary::engine::Transmission;
use planetary::housing::{Casing, ReductionOptions};
use planetary::mesh::{DamagedTooth, MeshTable};

use super::{Measured, Saving, measured};
use crate::train::{self, POSITIONS, STEPS_PER_SAMPLE, Scene};

/// Measures all savings: processor time, and the largest force of a mesh of the planetary stage (N).
pub fn savings() -> anyhow::Result<Vec<Saving>> {
    let gears = train::train(train::equal(3))?;
    let casing = train::casing(train::element_size());
    let housing = train::reduced(&casing, &ReductionOptions::default())?.body;
    let tables = made(&gears, FaceModel::PlaneStress)?;
    let scene = Scene {
        laws: tables.clone().map(|table| Arc::new(table) as _),
        bevel: Some(train::bevel_law()?),
        places: train::places(&housing),
        housing: Some(housing.clone()),
        train: gears.clone(),
    };
    let run = "a planet pass of transient and one recorded, 50 steps a mesh cycle";
    let full = measured(|| largest_force(&scene))?;
    let mut savings = vec![
        Saving {
            left_out: "Elastic housing",
            when: "no `[housing]`: bearings and ring stand on the ground, and there are no sensors",
            asked: format!("{run}; with: meshing and reducing the housing included"),
            with: measured(|| {
                let housing = Some(train::reduced(&casing, &ReductionOptions::default())?.body);
                largest_force(&Scene { housing, ..scene.clone() })
            })?,
            without: measured(|| largest_force(&Scene { housing: None, ..scene.clone() }))?,
        },
        Saving {
            left_out: "Bevel stage",
            when: "no `[bevel]`: the sun's rotation is prescribed",
            asked: format!("{run}; with: making the law of the bevel mesh included"),
            with: measured(|| largest_force(&Scene { bevel: Some(train::bevel_law()?), ..scene.clone() }))?,
            without: measured(|| largest_force(&Scene { bevel: None, ..scene.clone() }))?,
        },
        Saving {
            left_out: "Sensors around the housing, all but two",
            when: "no `[around]`",
            asked: format!("{run}; with: all sensors"),
            with: all_sensors(&scene)?,
            without: full,
        },
    ];
    let usual = force_with(&scene, &tables)?;
    savings.push(Saving {
        left_out: "The third dimension of the teeth",
        when: "`model = \"plane-stress\"`, the default, or `\"plane-strain\"`",
        asked: "both tables of the planetary stage, 50 positions a mesh cycle".into(),
        with: {
            let solid = PairModelOptions::default().face;
            let timed = measured(|| made(&gears, solid).map(|_| None))?;
            Measured { error: Some(force_with(&scene, &made(&gears, solid)?)?), ..timed }
        },
        without: Measured { error: Some(usual), ..measured(|| made(&gears, FaceModel::PlaneStress).map(|_| None))? },
    });
    savings.push(cached(&scene, &tables)?);
    savings.push(one_state_more(&scene, &casing, &tables)?);
    Ok(savings)
}

/// Both tables of the stage.
fn made(gears: &PlanetaryTrain, face: FaceModel) -> anyhow::Result<[MeshTable; 2]> {
    let make = |site| -> anyhow::Result<MeshTable> {
        let options = train::table_options(gears, POSITIONS);
        Ok(MeshTable::from_contact(&train::model(gears, site, face)?, &options, &())?)
    };
    Ok([make(MeshSite::SunPlanet)?, make(MeshSite::PlanetRing)?])
}

/// Largest force of a mesh of the stage (N).
fn largest_force(scene: &Scene) -> anyhow::Result<Option<f64>> {
    let run = Transmission::new(&scene.spec()?)?.run(&train::request(STEPS_PER_SAMPLE, 1), &())?;
    let stage = run.meshes.iter().take(2 * scene.train.planets());
    Ok(stage.flat_map(|mesh| mesh.force.iter().copied()).reduce(f64::max))
}

fn force_with(scene: &Scene, tables: &[MeshTable; 2]) -> anyhow::Result<f64> {
    let laws = tables.clone().map(|table| Arc::new(table) as _);
    largest_force(&Scene { laws, ..scene.clone() })?.context("a run without record")
}

fn all_sensors(scene: &Scene) -> anyhow::Result<Measured> {
    let housing = train::reduced(&Casing::default(), &ReductionOptions::default())?.body;
    let own = Scene { housing: Some(housing), ..scene.clone() };
    measured(|| largest_force(&own))
}

/// Tables read instead of made, as the program keeps them.
fn cached(scene: &Scene, tables: &[MeshTable; 2]) -> anyhow::Result<Saving> {
    let file = tempfile::NamedTempFile::new()?;
    let mut writer = BufWriter::new(file.as_file());
    serde_json::to_writer(&mut writer, tables)?;
    writer.flush()?;
    let read =
        || -> anyhow::Result<[MeshTable; 2]> { Ok(serde_json::from_reader(BufReader::new(File::open(file.path())?))?) };
    let [with, without] =
        [measured(|| made(&scene.train, FaceModel::PlaneStress).map(|_| None))?, measured(|| read().map(|_| None))?];
    let (of_made, of_read) = (force_with(scene, tables)?, force_with(scene, &read()?)?);
    Ok(Saving {
        left_out: "Mesh tables that are there",
        when: "`output.cache`, the default: kept on disk, found by all they depend on, safe to delete",
        asked: "both tables of the planetary stage, plane stress; without: read".into(),
        with: Measured { error: Some(of_made), ..with },
        without: Measured { error: Some(of_read), ..without },
    })
}

/// A damaged state shares housing and tables with the healthy one.
fn one_state_more(scene: &Scene, casing: &Casing, sound: &[MeshTable; 2]) -> anyhow::Result<Saving> {
    let gears = &scene.train;
    let site = MeshSite::PlanetRing;
    let options = train::table_options(gears, POSITIONS);
    let crack = RootCrack::along_chord(gears.pair(site).working_side(Member::Wheel), 0.5);
    let tooth = DamagedTooth { member: Member::Wheel, pair: 10, damage: vec![Damage::Crack(crack)] };
    let model = train::model(gears, site, FaceModel::PlaneStress)?;
    let damaged = |sound: &[MeshTable; 2]| -> anyhow::Result<Option<f64>> {
        let ring = sound[1].with_damage(&model, std::slice::from_ref(&tooth), &options, &())?;
        force_with(scene, &[sound[0].clone(), ring]).map(Some)
    };
    Ok(Saving {
        left_out: "What states share",
        when: "by itself: states of damage share housing and tables of sound teeth; curves around the damaged tooth are added",
        asked: "a ring tooth cracked by 50 %, a planet pass of transient and one recorded; with: everything anew"
            .into(),
        with: measured(|| {
            train::reduced(casing, &ReductionOptions::default())?;
            train::bevel_law()?;
            damaged(&made(gears, FaceModel::PlaneStress)?)
        })?,
        without: measured(|| damaged(sound))?,
    })
}
