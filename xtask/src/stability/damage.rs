//! Damaged pairs at rest: cracks and pits from next to nothing to the whole tooth, together and on neighbours.

use fecm::FaceModel;
use fecm::statics::PairModel;
use gear_geom::{
    BrokenCorner, CrackLength, CrackPath, Damage, FlankSide, GearPair, Member, Pit, ProfileMeasure, RootCrack,
    ToothDamage,
};

use super::pairs::USUAL;
use super::statics::{RESIDUALS, answer, model, solve};
use super::{Answer, Table};

/// A damaged pair's scene.
struct Scene {
    pair: GearPair,
    solid: PairModel,
    plane: PairModel,
}

impl Scene {
    fn new() -> anyhow::Result<Self> {
        let pair = USUAL.pair()?;
        let solid = model(&pair, FaceModel::Solid { order: 4 })?;
        let plane = model(&pair, FaceModel::PlaneStrain)?;
        Ok(Self { pair, solid, plane })
    }

    fn solve(&self, healthy: &PairModel, damage: [Vec<ToothDamage>; 2]) -> anyhow::Result<Answer> {
        let results = solve(&healthy.with_damage(&damage)?, USUAL.nominal_torque(&self.pair))?;
        Ok(answer(&results, true))
    }
}

fn crack(tooth: i64, fraction: f64) -> ToothDamage {
    ToothDamage { tooth, damage: Damage::Crack(RootCrack::along_chord(FlankSide::Upper, fraction)) }
}

fn pit(tooth: i64, face: f64, roll: f64, width: f64, height: f64) -> ToothDamage {
    let pit = Pit::ellipse(face, roll, width, height, ProfileMeasure::RollDistance);
    ToothDamage { tooth, damage: Damage::Pit(pit) }
}

/// All cases.
pub fn cases() -> Table {
    let mut table = Table::new(
        "fecm: damaged pairs at rest",
        "25 and 31 teeth of module 6 mm, facewidth 16 mm, 3-D unless named; damage on tooth 0 of the pinion unless named. Residuals as for healthy pairs.",
        RESIDUALS,
    );
    let scene = match Scene::new() {
        Ok(scene) => scene,
        Err(error) => {
            table.answered("healthy pair", || Err(error));
            return table;
        }
    };
    for percent in [1.0, 5.0, 50.0, 80.0, 95.0] {
        for (name, healthy) in [("3-D", &scene.solid), ("plane strain", &scene.plane)] {
            table.answered(format!("root crack of {percent} %, {name}"), || {
                scene.solve(healthy, [vec![crack(0, 0.01 * percent)], vec![]])
            });
        }
    }
    let (roll, landmarks) = (scene.pair.pitch_roll(), scene.pair.landmarks(Member::Pinion));
    let (tip, end) = (landmarks.eap.roll_distance, 0.5 * USUAL.facewidth);
    let surface = [
        ("pit smaller than a contact cell", vec![pit(0, 0.0, roll, 1e-5, 1e-5)]),
        ("pit of about one contact cell", vec![pit(0, 0.0, roll, 1.4e-3, 6e-5)]),
        ("pit at the tip", vec![pit(0, 0.0, tip, 5e-3, 2e-3)]),
        ("pit cut by the end of the face", vec![pit(0, end, roll, 5e-3, 2e-3)]),
        ("pit beyond the end of the face", vec![pit(0, end + 4e-3, roll, 5e-3, 2e-3)]),
        ("pit right across the face", vec![pit(0, 0.0, roll, 1.0, 1e-3)]),
    ];
    for (name, damage) in surface {
        table.answered(name, || scene.solve(&scene.solid, [damage, vec![]]));
    }
    // where only the bare tooth could carry, the gears turn until the neighbours meet
    table.answered("pit over the whole flank: neighbours carry the load", || {
        scene.solve(&scene.solid, [vec![pit(0, 0.0, roll, 1.0, 1.0)], vec![]])
    });
    table.answered("broken corner, 6 x 3 mm", || {
        let corner = BrokenCorner::new(scene.pair.pinion(), true, 6e-3, 3e-3);
        let damage = ToothDamage { tooth: 0, damage: Damage::BrokenCorner(corner) };
        scene.solve(&scene.solid, [vec![damage], vec![]])
    });
    table.answered("crack of 50 % and pit on one tooth", || {
        scene.solve(&scene.solid, [vec![crack(0, 0.5), pit(0, 0.0, roll, 6e-3, 2e-3)], vec![]])
    });
    table.answered("cracks on three teeth in a row, pits on both gears", || {
        let pinion = vec![crack(0, 0.5), crack(1, 0.3), crack(-1, 0.2), pit(0, 0.0, roll, 6e-3, 2e-3)];
        scene.solve(&scene.solid, [pinion, vec![crack(0, 0.4), pit(1, 2e-3, roll, 6e-3, 2e-3)]])
    });
    let usual = || RootCrack::along_chord(FlankSide::Upper, 0.3);
    let impossible = [
        ("crack of 120 %", RootCrack { length: CrackLength::Chord(1.2), ..usual() }),
        ("crack of half a metre", RootCrack { length: CrackLength::Length(0.5), ..usual() }),
        ("crack of length NaN", RootCrack { length: CrackLength::Length(f64::NAN), ..usual() }),
        ("crack that leaves the tooth", RootCrack { path: CrackPath::Straight(-0.5), ..usual() }),
    ];
    for (name, crack) in impossible {
        table.refused(name, || {
            let damage = ToothDamage { tooth: 0, damage: Damage::Crack(crack) };
            scene.solve(&scene.plane, [vec![damage], vec![]])
        });
    }
    table.refused("two cracks on one tooth, the second named by a turn more", || {
        scene.solve(&scene.plane, [vec![crack(3, 0.1), crack(28, 0.2)], vec![]])
    });
    table.refused("pit of width NaN", || scene.solve(&scene.solid, [vec![pit(0, 0.0, roll, f64::NAN, 1e-3)], vec![]]));
    table
}
