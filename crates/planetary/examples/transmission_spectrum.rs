//! From tooth numbers to the spectrum of a sensor on the housing: meshes by contact mechanics (plane stress), the default housing on a coarse mesh, a turn
//! of the carrier at 219 kW.
//!
//! `cargo run --release -p planetary --example transmission_spectrum [element size of the housing, mm]`

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Instant;

use fecm::{FaceModel, PairModel, PairModelOptions};
use gear_geom::{FilletSpec, Gear, GearKind, GearSpec, MeshSite, PlanetaryTrain, PlanetaryTrainSpec, ToothThickness};
use hums::spectrum::{Spectrum, Window};
use planetary::elastic::ElasticBody;
use planetary::engine::{
    Anchor, Band, Bearing, BodyId, Mesh, Planet, PlanetaryStage, RigidBody, RunRequest, STAGES, Start, Transmission,
    TransmissionSpec, Turning,
};
use planetary::housing::{Casing, ReductionOptions};
use planetary::mesh::{MeshTable, TableOptions};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Load on the carrier (N m) and its speed (rad/s).
const TORQUE: f64 = 6106.0;
const CARRIER_SPEED: f64 = 347.5 * TAU / 60.0;
const STEPS: usize = 50;
const GRAVITY: f64 = 9.80665;

fn main() -> Result<()> {
    let size = std::env::args().nth(1).map_or(Ok(30.0), |text| text.parse::<f64>())?;
    let started = Instant::now();
    let passed = |what: &str| println!("{:7.2} s  {what}", started.elapsed().as_secs_f64());

    let mut casing = Casing::default();
    casing.density.element_size = 1e-3 * size;
    let housing = casing.housing()?.reduce(&ReductionOptions::default())?;
    passed(&format!("housing: {} unknowns, {} coordinates", housing.stats.unknowns, housing.body.frequencies.len()));

    let train = train()?;
    let spec = transmission(&train, housing.body)?;
    passed("mesh tables");

    let ring_teeth = spec.stage.ring_teeth as usize;
    let planets = spec.stage.planets.len();
    let request = RunRequest {
        turning: Turning::Steady { carrier_speed: CARRIER_SPEED, steps_per_cycle: STEPS },
        output_torque: TORQUE,
        travelled: 0.0,
        start: Start::Equilibrium,
        settle_steps: STEPS * ring_teeth / planets,
        samples: STEPS * ring_teeth,
        band: Some(Band { frequency: 10e3, steps_per_sample: 1 }),
        record_motion: false,
        stages: STAGES,
    };
    let run = Transmission::new(&spec)?.run(&request, &())?;
    passed(&format!("{} steps, {} Newton iterations", run.stats.steps, run.stats.newton_iterations));

    let sensor = run.sensors.first().ok_or("the housing has no sensor")?;
    let spectrum = Spectrum::of(&sensor.acceleration, Window::Rectangular)?;
    let frequencies = spectrum.frequencies(1.0 / run.sample_time);
    let amplitudes = spectrum.amplitudes();
    let mut lines: Vec<usize> = (1..amplitudes.len()).collect();
    lines.sort_by(|&a, &b| amplitudes[b].total_cmp(&amplitudes[a]));
    println!("\nsensor `{}`: largest lines\n      Hz      orders of the carrier, of the mesh    g", sensor.name);
    for &line in &lines[..12] {
        let order = line as f64 / ring_teeth as f64;
        println!("{:9.2} {line:10} {order:16.3} {:16.4}", frequencies[line], amplitudes[line] / GRAVITY);
    }
    Ok(())
}

/// The dissertation's train (Tables 5.1 and 7.1). Fillets, and the ring's tooth thickness and root, are not printed, and chosen.
fn train() -> Result<PlanetaryTrain> {
    let centre_distance = 88.9e-3;
    let module = 2.0 * centre_distance / 62.0;
    let gear = |kind, teeth, thickness: f64, [tip, root, rim]: [f64; 3], facewidth: f64, fillet| {
        Gear::new(&GearSpec::standard(teeth, module).with(|spec| {
            spec.kind = kind;
            spec.pressure_angle = 24.6_f64.to_radians();
            spec.thickness = ToothThickness::AtReference(1e-3 * thickness);
            spec.tip_radius = 0.5e-3 * tip;
            spec.root_radius = 0.5e-3 * root;
            spec.rim_radius = 0.5e-3 * rim;
            spec.facewidth = 1e-3 * facewidth;
            spec.fillet = fillet;
            spec.tip_round = 0.02 * module;
        }))
    };
    let rack = |tip_radius: f64| FilletSpec::Rack { tip_radius };
    Ok(PlanetaryTrain::new(&PlanetaryTrainSpec {
        sun: gear(GearKind::External, 27, 4.52, [84.05, 70.76, 62.23], 34.93, rack(0.86e-3))?,
        planet: gear(GearKind::External, 35, 4.18, [104.98, 91.54, 77.9], 31.75, rack(0.55e-3))?,
        ring: gear(
            GearKind::Internal,
            99,
            6.92,
            [271.75, 284.2, 296.55],
            25.4,
            FilletSpec::Circular { radius: 0.5e-3 },
        )?,
        centre_distance,
        planet_angles: (0..3).map(|n| f64::from(n) * TAU / 3.0).collect(),
        ring_tooth_angle: 35.6_f64.to_radians(),
        sun_tooth_angle: 0.0,
    })?)
}

/// Gears on bearings in the ports of the default housing. Masses and bearings are those of a transmission of this size.
fn transmission(train: &PlanetaryTrain, housing: ElasticBody) -> Result<TransmissionSpec> {
    let gears = train.spec();
    let [z_s, z_p, z_r] = [&gears.sun, &gears.planet, &gears.ring].map(|gear| f64::from(gear.teeth()));
    let sun_torque = TORQUE * z_s / (z_s + z_r);
    let force = sun_torque / gears.sun.base_radius() / train.planets() as f64;
    // all sun meshes are in phase, and all ring meshes: one table each
    let table = |site| -> Result<Arc<MeshTable>> {
        let options = PairModelOptions { face: FaceModel::PlaneStress, ..PairModelOptions::default() };
        let model = PairModel::new(train.pair(site), &options)?;
        Ok(Arc::new(MeshTable::from_contact(&model, &TableOptions::up_to(3.0 * force), &())?))
    };
    let [sun_table, ring_table] = [table(MeshSite::SunPlanet)?, table(MeshSite::PlanetRing)?];
    let mesh = |site, planet| -> Result<Mesh> {
        let law = if site == MeshSite::SunPlanet { sun_table.clone() } else { ring_table.clone() };
        let cycle_offset = train.mesh_offset(site, planet)?;
        Ok(Mesh { law, cycle_offset, damping: 1200.0, damping_force: 0.01 * force, coast: None })
    };
    let planet = |(index, &angle): (usize, &f64)| -> Result<Planet> {
        Ok(Planet {
            angle,
            mass: 0.85,
            polar: 1.6e-3,
            transverse: 0.9e-3,
            spin_ratio: 1.0 - z_r / z_p,
            bearing_stiffness: [4e8, 4e8, 1e8, 1e5, 1e5],
            bearing_damping: [4e3, 4e3, 1e3, 1.0, 1.0],
            sun_mesh: mesh(MeshSite::SunPlanet, index)?,
            ring_mesh: mesh(MeshSite::PlanetRing, index)?,
        })
    };
    let stage = PlanetaryStage {
        ring_teeth: gears.ring.teeth(),
        centre_distance: gears.centre_distance,
        height: 0.0,
        sun_base_radius: gears.sun.base_radius(),
        planet_base_radius: gears.planet.base_radius(),
        ring_base_radius: gears.ring.base_radius(),
        sun_pressure_angle: train.pair(MeshSite::SunPlanet).working_pressure_angle(),
        ring_pressure_angle: train.pair(MeshSite::PlanetRing).working_pressure_angle(),
        planets: gears.planet_angles.iter().enumerate().map(planet).collect::<Result<_>>()?,
    };
    let body = |mass, polar, spin_ratio| RigidBody {
        position: [0.0; 3],
        axis: [0.0, 0.0, 1.0],
        mass,
        polar,
        transverse: 0.6 * polar,
        spin_ratio,
    };
    let bearing = |body, port: &str| -> Result<Bearing> {
        let place = housing.ports.iter().find(|own| own.name == port).ok_or_else(|| format!("no port `{port}`"))?;
        let stiffness = [3e8, 3e8, 1e8, 1e4, 1e4, 0.0];
        Ok(Bearing {
            name: port.into(),
            body,
            anchor: Anchor::Port(port.into()),
            position: place.position,
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            stiffness,
            damping: stiffness.map(|k| 1e-5 * k),
        })
    };
    let bearings = vec![
        bearing(BodyId::Sun, "shaft_upper")?,
        bearing(BodyId::Sun, "shaft_lower")?,
        bearing(BodyId::Carrier, "mast_lower")?,
        bearing(BodyId::Carrier, "mast_upper")?,
    ];
    Ok(TransmissionSpec {
        stage,
        sun: body(4.0, 6e-3, 1.0 + z_r / z_s),
        carrier: body(8.0, 0.06, 1.0),
        bevel: None,
        bearings,
        housing: Some(housing),
        drive: Some(BodyId::Sun),
    })
}
