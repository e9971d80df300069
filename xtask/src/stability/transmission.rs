//! Planetary transmissions: stiffness, load, speed, planets, damage, damping, steps, housings.

use std::f64::consts::TAU;
use std::sync::Arc;

use fecm::FaceModel;
use gear_geom::{Damage, Member, MeshSite, PlanetaryTrain, RootCrack};
use planetary::engine::{Anchor, Band, Load, RunRequest, Start, Transmission, TransmissionSpec, Turning};
use planetary::housing::{Casing, ReductionOptions};
use planetary::mesh::{DamagedTooth, MeshLaw, MeshTable, TableOptions};

use super::{Answer, Table};
use crate::train::{self, POSITIONS, STEPS_PER_SAMPLE, Scene, TORQUE};

type Outcome = anyhow::Result<Answer>;

/// All cases.
pub fn cases() -> Table {
    let mut table = Table::new(
        "planetary: whole transmissions",
        "The dissertation's train (27/35/99 teeth, three planets) with bevel stage in a coarse elastic housing (elements of 40 mm, modes to 5 kHz), 6060 rpm, 6106 N m, plane stress, \
         25 steps a mesh cycle, two planet passes, unless named. Rest: torques of sun and ring in static equilibrium against the load. Contact: approach of a mesh not accounted for, over the \
         largest approach or motion of a body, worst step. Motion: mean torques of sun and ring over the last planet pass against the load; empty without load or where they have no reason to be even in so short a time.",
        &[("rest", 1e-9), ("contact", 1e-9), ("motion", 0.02)],
    );
    let scene = match scene() {
        Ok(scene) => scene,
        Err(error) => {
            table.answered("the transmission", || Err(error));
            return table;
        }
    };
    stiffness(&mut table, &scene);
    operation(&mut table, &scene);
    planets(&mut table, &scene);
    damage(&mut table, &scene);
    numerics(&mut table, &scene);
    housings(&mut table, &scene);
    refusals(&mut table, &scene);
    table
}

fn coarse() -> Casing {
    let mut casing = train::casing(40e-3);
    casing.seat_harmonics = 8;
    casing
}

fn few_modes() -> ReductionOptions {
    ReductionOptions { modes: 60, highest_frequency: 5e3, ..ReductionOptions::default() }
}

fn scene() -> anyhow::Result<Scene> {
    let gears = train::train(train::equal(3))?;
    let housing = train::reduced(&coarse(), &few_modes())?.body;
    Ok(Scene {
        laws: train::tables(&gears, FaceModel::PlaneStress, POSITIONS)?,
        bevel: Some(train::bevel_law()?),
        places: train::places(&housing),
        housing: Some(housing),
        train: gears,
    })
}

fn usual() -> RunRequest {
    train::request(STEPS_PER_SAMPLE, 1)
}

/// Rest and motion of a transmission, the latter's mean torques where they should be even.
fn run(spec: &TransmissionSpec, request: &RunRequest, is_even: bool) -> Outcome {
    let transmission = Transmission::new(spec)?;
    let carrier_speed = match request.turning {
        Turning::Steady { carrier_speed, .. } => carrier_speed,
        Turning::Standing { .. } => 0.0,
    };
    let load = request.output_torque;
    let rest = transmission.equilibrium(&Load { travelled: request.travelled, output_torque: load, carrier_speed })?;
    let planets = spec.stage.planets.len();
    let arms = |index: usize| match index {
        index if index < planets => spec.stage.sun_base_radius,
        index if index < 2 * planets => spec.stage.ring_base_radius,
        _ => 0.0,
    };
    let torque = |forces: &mut dyn Iterator<Item = f64>| forces.enumerate().map(|(k, f)| arms(k) * f).sum::<f64>();
    let at_rest = torque(&mut rest.mesh_forces.iter().zip(&rest.coast_forces).map(|(drive, coast)| drive - coast));
    let motion = transmission.run(request, &())?;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let in_motion = torque(&mut motion.meshes.iter().map(|mesh| mean(&mesh.force) - mean(&mesh.coast_force)));
    let approaches = motion.meshes.iter().flat_map(|mesh| &mesh.approach);
    let rigid = motion.state.position.iter().take(6 * transmission.bodies().len());
    let most = approaches.chain(rigid).fold(0.0_f64, |most, x| most.max(x.abs()));
    let apart: usize = motion.meshes.iter().map(|mesh| mesh.steps_apart).sum();
    let touched = motion.meshes.iter().flat_map(|mesh| &mesh.coast_force).filter(|force| **force > 0.0).count();
    let highest = motion.meshes.iter().flat_map(|mesh| &mesh.force).fold(0.0_f64, |most, f| most.max(*f));
    let stats = motion.stats;
    let mut said = format!(
        "highest force {highest:.3e} N; {:.1} iterations a step",
        stats.newton_iterations as f64 / stats.steps as f64
    );
    for (count, what) in
        [(apart, "steps apart"), (touched, "with coast flanks"), (stats.fallbacks, "steps of one stage")]
    {
        if count > 0 {
            said += &format!(", {count} {what}");
        }
    }
    let relative = |torque: f64| (load > 0.0).then(|| torque / load - 1.0);
    let residual = if most > 0.0 { stats.worst_residual / most } else { stats.worst_residual };
    let residuals = vec![relative(at_rest), Some(residual), relative(in_motion).filter(|_| is_even)];
    let accelerations = motion.sensors.iter().flat_map(|sensor| sensor.acceleration.iter().copied());
    let state = motion.state.position.iter().chain(&motion.state.velocity).copied();
    Ok(Answer::new(said, residuals).with_finite("acceleration", accelerations).with_finite("motion", state))
}

/// The usual motion of a transmission that is changed somehow.
fn changed(scene: &Scene, change: impl FnOnce(&mut TransmissionSpec)) -> Outcome {
    let mut spec = scene.spec()?;
    change(&mut spec);
    run(&spec, &usual(), true)
}

/// All bearings of one stiffness (N/m), tilts in proportion.
fn on_bearings(spec: &mut TransmissionSpec, stiffness: f64) {
    const SQUARE_ARM: f64 = 1e-2;
    let springs = |k: usize| stiffness * if k < 3 { 1.0 } else { SQUARE_ARM };
    for planet in &mut spec.stage.planets {
        planet.bearing_stiffness = std::array::from_fn(springs);
    }
    for bearing in &mut spec.bearings {
        bearing.stiffness = std::array::from_fn(|k| if k < 5 { springs(k) } else { 0.0 });
    }
}

fn stiffness(table: &mut Table, scene: &Scene) {
    for stiffness in [1e3, 1e5, 1e7, 1e9, 1e12, 1e15] {
        table.answered(format!("all bearings of {stiffness:.0e} N/m"), || {
            let mut spec = scene.spec()?;
            on_bearings(&mut spec, stiffness);
            // bodies on the softest swing by metres
            run(&spec, &usual(), stiffness > 1e4)
        });
    }
    table.answered("rigid bearings, one for each body", || {
        changed(scene, |spec| {
            on_bearings(spec, f64::INFINITY);
            let mut held = Vec::new();
            spec.bearings.retain(|bearing| {
                let is_first = !held.contains(&bearing.body);
                held.push(bearing.body);
                is_first
            });
        })
    });
    table.answered("rigid bearings in a rigid housing", || {
        let rigid = Scene { housing: None, ..scene.clone() };
        changed(&rigid, |spec| {
            on_bearings(spec, f64::INFINITY);
            spec.bearings
                .retain(|bearing| ["shaft_upper", "mast_upper", "pinion_outer"].contains(&bearing.name.as_str()));
        })
    });
    table.refused("rigid bearings in a rigid housing, two for each body", || {
        let rigid = Scene { housing: None, ..scene.clone() };
        changed(&rigid, |spec| on_bearings(spec, f64::INFINITY))
    });
    table.answered("sun without a bearing of its own, driven: held by its planets", || {
        let alone = Scene { bevel: None, ..scene.clone() };
        changed(&alone, |spec| spec.bearings.retain(|bearing| !bearing.name.starts_with("shaft")))
    });
    table.answered("dampers of 1e9 N s/m in all bearings", || {
        changed(scene, |spec| {
            spec.bearings.iter_mut().for_each(|bearing| bearing.damping = [1e9, 1e9, 1e9, 1e7, 1e7, 0.0]);
        })
    });
    let times = |part: f64| {
        changed(scene, |spec| {
            let pinion = spec.bevel.iter_mut().map(|bevel| &mut bevel.pinion);
            for body in [&mut spec.sun, &mut spec.carrier].into_iter().chain(pinion) {
                (body.mass, body.polar, body.transverse) =
                    (part * body.mass, part * body.polar, part * body.transverse);
            }
            for body in &mut spec.stage.planets {
                (body.mass, body.polar, body.transverse) =
                    (part * body.mass, part * body.polar, part * body.transverse);
            }
        })
    };
    for part in [1e-6, 1e-3] {
        table.answered(format!("masses and moments of inertia of all bodies times {part:.0e}"), || times(part));
    }
    table.answered("masses and moments of inertia of all bodies times 1e3", || {
        // they have not come to even motion in two passes
        times(1e3).map(|answer| Answer { residuals: answer.residuals.into_iter().take(2).collect(), ..answer })
    });
    table.refused("masses and moments of inertia of all bodies times 1e6: rest is not found", || times(1e6));
}

fn operation(table: &mut Table, scene: &Scene) {
    for part in [0.0, 1e-6, 10.0, 100.0] {
        table.answered(format!("torque times {part}"), || {
            run(&scene.spec()?, &RunRequest { output_torque: part * TORQUE, ..usual() }, part >= 1.0)
        });
    }
    for rpm in [1.0, 600.0, 20_000.0, 60_000.0] {
        table.answered(format!("{rpm} rpm"), || {
            let part = rpm / 6060.0;
            let turning = Turning::Steady { carrier_speed: train::carrier_speed() * part, steps_per_cycle: 90 };
            let band = Some(Band { frequency: train::BAND * part, steps_per_sample: STEPS_PER_SAMPLE });
            run(&scene.spec()?, &RunRequest { turning, band, ..usual() }, rpm < 1e4)
        });
    }
    table.answered("standing, steps of 20 us", || {
        run(
            &scene.spec()?,
            &RunRequest { turning: Turning::Standing { time_step: 2e-5 }, band: None, samples: 3000, ..usual() },
            true,
        )
    });
    table.answered("after a million mesh cycles", || {
        run(&scene.spec()?, &RunRequest { travelled: 1e6, ..usual() }, true)
    });
    table.answered("from a wrong state: bodies thrown at 0.1 m/s", || {
        let spec = scene.spec()?;
        let request = usual();
        let mut state = Transmission::new(&spec)?.start(&request)?.state().clone();
        state.velocity.iter_mut().take(6 * spec.body_ids().len()).for_each(|velocity| *velocity += 0.1);
        run(&spec, &RunRequest { start: Start::Given(Box::new(state)), ..request }, false)
    });
    table.answered("load taken away at once: drive flanks part, coast flanks meet", || {
        let spec = scene.spec()?;
        let state = Transmission::new(&spec)?.start(&usual())?.state().clone();
        run(&spec, &RunRequest { start: Start::Given(Box::new(state)), output_torque: 0.0, ..usual() }, false)
    });
}

fn of_gears(scene: &Scene, angles: Vec<f64>) -> anyhow::Result<Scene> {
    Ok(Scene { train: train::train(angles)?, ..scene.clone() })
}

fn planets(table: &mut Table, scene: &Scene) {
    let step = TAU / 126.0;
    let places = |steps: &[u32]| steps.iter().map(|&k| f64::from(k) * step).collect::<Vec<f64>>();
    for (angles, name) in [
        (vec![0.3], "one planet"),
        (train::equal(2), "two planets"),
        (places(&[0, 31, 63, 94]), "four planets, unequal distances"),
        (places(&[0, 26, 60]), "three planets, unequal distances"),
        (places(&[0, 26, 52]), "three planets on one side"),
    ] {
        table.answered(name, || changed(&of_gears(scene, angles)?, |_| {}));
    }
    for count in [5, 6, 7] {
        // the nearest places at which they can be assembled
        let angles = (0..count).map(|n| (f64::from(n) * 126.0 / f64::from(count)).round() * step).collect();
        table.refused(format!("{count} planets: no room"), || changed(&of_gears(scene, angles)?, |_| {}));
    }
    table.refused("planets that no tooth space fits", || changed(&of_gears(scene, vec![0.0, 2.0, 4.0])?, |_| {}));
    table.refused("no planet", || changed(&of_gears(scene, vec![])?, |_| {}));
    table.answered("a planet that has lost its bearing on the pin", || {
        changed(scene, |spec| spec.stage.planets[0].bearing_stiffness = [0.0; 5])
            .map(|answer| Answer { residuals: answer.residuals.into_iter().take(2).collect(), ..answer })
    });
}

fn cracked(train: &PlanetaryTrain, site: MeshSite, teeth: &[(Member, i64, f64)]) -> anyhow::Result<Arc<dyn MeshLaw>> {
    let model = train::model(train, site, FaceModel::PlaneStress)?;
    let options = TableOptions { octaves: 4, ..train::table_options(train, POSITIONS) };
    let sound = MeshTable::from_contact(&model, &options, &())?;
    let teeth: Vec<DamagedTooth> = teeth
        .iter()
        .map(|&(member, pair, part)| {
            let crack = RootCrack::along_chord(train.pair(site).working_side(member), part);
            DamagedTooth { member, pair, damage: vec![Damage::Crack(crack)] }
        })
        .collect();
    Ok(Arc::new(sound.with_damage(&model, &teeth, &options, &())?))
}

fn damage(table: &mut Table, scene: &Scene) {
    for (site, member, name) in
        [(MeshSite::PlanetRing, Member::Wheel, "ring"), (MeshSite::SunPlanet, Member::Pinion, "sun")]
    {
        let with = |teeth: &[(Member, i64, f64)]| -> Outcome {
            let mut own = scene.clone();
            own.laws[usize::from(site == MeshSite::PlanetRing)] = cracked(&own.train, site, teeth)?;
            changed(&own, |_| {})
        };
        table.answered(format!("{name} tooth cracked by 0.1 %"), || with(&[(member, 10, 1e-3)]));
        table.answered(format!("{name} tooth cracked by 95 %"), || with(&[(member, 10, 0.95)]));
        table.answered(format!("two {name} teeth cracked by 80 %, six apart"), || {
            with(&[(member, 10, 0.8), (member, 16, 0.8)])
        });
        table.refused(format!("neighbouring {name} teeth cracked: in mesh together"), || {
            with(&[(member, 10, 0.8), (member, 11, 0.8)])
        });
    }
    table.refused("a sun and a planet tooth cracked: together some time", || {
        let teeth = [(Member::Pinion, 10, 0.8), (Member::Wheel, 15, 0.8)];
        cracked(&scene.train, MeshSite::SunPlanet, &teeth)?;
        Ok(Answer::new("a table", vec![]))
    });
}

fn undamped(spec: &mut TransmissionSpec) {
    for planet in &mut spec.stage.planets {
        (planet.sun_mesh.damping, planet.ring_mesh.damping) = (0.0, 0.0);
        planet.bearing_damping = [0.0; 5];
    }
    spec.bearings.iter_mut().for_each(|bearing| bearing.damping = [0.0; 6]);
    spec.bevel.iter_mut().for_each(|bevel| bevel.mesh.damping = 0.0);
    spec.housing.iter_mut().for_each(|housing| housing.damping_ratios.fill(0.0));
}

fn numerics(table: &mut Table, scene: &Scene) {
    for steps in [4, 10, 30, 100, 1000] {
        table.answered(format!("{steps} steps a mesh cycle"), || {
            let turning = Turning::Steady { carrier_speed: train::carrier_speed(), steps_per_cycle: steps };
            run(&scene.spec()?, &RunRequest { turning, band: None, samples: 33 * steps, ..train::request(1, 0) }, false)
        });
    }
    for stages in [1, 2, 4] {
        table.answered(format!("{stages} of the 4 stages a step may have"), || {
            run(&scene.spec()?, &RunRequest { stages, ..usual() }, true)
        });
    }
    table.answered("no damping at all, 10 planet passes", || {
        let mut spec = scene.spec()?;
        undamped(&mut spec);
        run(&spec, &train::request(STEPS_PER_SAMPLE, 9), true)
    });
    table.answered("damping of meshes times 1e4", || {
        changed(scene, |spec| {
            for planet in &mut spec.stage.planets {
                planet.sun_mesh.damping *= 1e4;
                planet.ring_mesh.damping *= 1e4;
            }
        })
    });
    for positions in [1, 4] {
        table.answered(format!("tables of {positions} positions"), || {
            let laws = train::tables(&scene.train, FaceModel::PlaneStress, positions)?;
            changed(&Scene { laws, ..scene.clone() }, |_| {})
        });
    }
}

fn housings(table: &mut Table, scene: &Scene) {
    table.answered("no housing", || changed(&Scene { housing: None, ..scene.clone() }, |_| {}));
    table.answered("no bevel stage", || changed(&Scene { bevel: None, ..scene.clone() }, |_| {}));
    for part in [1e-2, 1e3] {
        table.answered(format!("Young's modulus of the housing times {part:.0e}"), || {
            let mut casing = coarse();
            casing.material.young_modulus *= part;
            casing.ring.iter_mut().for_each(|ring| ring.material.young_modulus *= part);
            let housing = Some(train::reduced(&casing, &few_modes())?.body);
            changed(&Scene { housing, ..scene.clone() }, |_| {})
        });
    }
    // the carrier then turns nearly as fast as waves run around the ring, and the loads it carries along feed them
    table.refused("Young's modulus of the housing times 1e-3", || {
        let mut casing = coarse();
        casing.material.young_modulus *= 1e-3;
        casing.ring.iter_mut().for_each(|ring| ring.material.young_modulus *= 1e-3);
        let housing = Some(train::reduced(&casing, &few_modes())?.body);
        changed(&Scene { housing, ..scene.clone() }, |_| {})
    });
    table.answered("static responses of the housing only", || {
        let options = ReductionOptions { highest_frequency: 0.0, ..few_modes() };
        let housing = Some(train::reduced(&coarse(), &options)?.body);
        changed(&Scene { housing, ..scene.clone() }, |_| {})
    });
    table.answered("no ring seat: the ring stands still", || {
        changed(scene, |spec| spec.housing.iter_mut().for_each(|housing| housing.ring_seat = None))
    });
    table.refused("a housing that nothing holds", || {
        let mut housing = coarse().housing()?;
        housing.mounts.clear();
        housing.reduce(&few_modes())?;
        Ok(Answer::new("reduced", vec![]))
    });
    table.refused("a housing with elements of 0 mm", || {
        train::reduced(&train::casing(0.0), &few_modes())?;
        Ok(Answer::new("reduced", vec![]))
    });
}

fn refusals(table: &mut Table, scene: &Scene) {
    let mut asked = |name: &str, request: RunRequest| {
        table.refused(name, || run(&scene.spec()?, &request, false));
    };
    let turning = |carrier_speed: f64, steps_per_cycle: usize| Turning::Steady { carrier_speed, steps_per_cycle };
    let speed = train::carrier_speed();
    asked("3 steps a mesh cycle", RunRequest { turning: turning(speed, 3), band: None, ..usual() });
    asked("speed 0", RunRequest { turning: turning(0.0, 90), ..usual() });
    asked("speed NaN", RunRequest { turning: turning(f64::NAN, 90), ..usual() });
    asked("torque NaN", RunRequest { output_torque: f64::NAN, ..usual() });
    asked("torque that drives", RunRequest { output_torque: -TORQUE, ..usual() });
    asked("5 stages", RunRequest { stages: 5, ..usual() });
    let band = |frequency| Some(Band { frequency, steps_per_sample: 1 });
    asked("a band above half the sample rate", RunRequest { band: band(1e6), ..usual() });
    table.refused("free input: nothing holds the load", || changed(scene, |spec| spec.drive = None));
    table.refused("carrier of no mass", || changed(scene, |spec| spec.carrier.mass = 0.0));
    table.refused("negative stiffness", || changed(scene, |spec| spec.bearings[0].stiffness[1] = -1.0));
    table.refused("a bearing at a port that is not there", || {
        changed(scene, |spec| spec.bearings[0].anchor = Anchor::Port("nowhere".into()))
    });
    table.refused("a housing whose tables do not fit", || {
        changed(scene, |spec| spec.housing.iter_mut().for_each(|housing| housing.damping_ratios.truncate(1)))
    });
    table.refused("tables up to loads that no tooth bears", || {
        let model = train::model(&scene.train, MeshSite::SunPlanet, FaceModel::PlaneStress)?;
        MeshTable::from_contact(&model, &TableOptions { octaves: 1, ..TableOptions::up_to(1e11) }, &())?;
        Ok(Answer::new("a table", vec![]))
    });
}
