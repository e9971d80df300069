//! Transmissions in motion.

mod support;

use std::f64::consts::{PI, TAU};

use planetary::PlanetaryError;
use planetary::engine::{
    Anchor, Bearing, BodyId, Load, RunRequest, STAGES, Start, Transmission, TransmissionRun, TransmissionSpec, Turning,
};
use support::{STANDING_AXES, equal, mesh, rigid_ring, train, with_coast};

const TORQUE: f64 = 6106.0;
/// Of the carrier at 6060 rpm of the dissertation's pinion (rad/s).
const SPEED: f64 = 347.5 * TAU / 60.0;

fn steady(steps_per_cycle: usize, samples: usize) -> RunRequest {
    RunRequest {
        turning: Turning::Steady { carrier_speed: SPEED, steps_per_cycle },
        output_torque: TORQUE,
        travelled: 0.0,
        start: Start::Equilibrium,
        settle_steps: 0,
        samples,
        band: None,
        record_motion: true,
        stages: STAGES,
    }
}

fn run(spec: &TransmissionSpec, request: &RunRequest) -> TransmissionRun {
    Transmission::new(spec).unwrap().run(request, &()).unwrap()
}

fn in_housing(angles: &[f64], depth: f64) -> TransmissionSpec {
    let mut spec = train(angles, depth);
    spec.housing = Some(rigid_ring(0.15, [2e9, 20.0], [5e7, 0.3], 0.05));
    spec.bearings[0].anchor = Anchor::Port("axis".into());
    spec
}

/// Enough damping to be steady soon.
fn damp(spec: &mut TransmissionSpec) {
    for bearing in &mut spec.bearings {
        bearing.damping = bearing.stiffness.map(|k| 5e-5 * k);
    }
    for planet in &mut spec.stage.planets {
        planet.bearing_damping = planet.bearing_stiffness.map(|k| 5e-5 * k);
        (planet.sun_mesh.damping, planet.ring_mesh.damping) = (5e4, 5e4);
    }
}

fn undamped(mut spec: TransmissionSpec) -> TransmissionSpec {
    spec.bearings.iter_mut().for_each(|bearing| bearing.damping = [0.0; 6]);
    spec.stage.planets.iter_mut().for_each(|planet| planet.bearing_damping = [0.0; 5]);
    if let Some(housing) = &mut spec.housing {
        housing.damping_ratios.fill(0.0);
    }
    spec
}

/// A planet that only turns, on a torsion spring, against the teeth of a sun that stands: an oscillator of one stiffness in contact, another apart.
fn one_mesh(torsion: f64) -> TransmissionSpec {
    let inf = f64::INFINITY;
    let mut spec = undamped(train(&[0.7], 0.0));
    for bearing in &mut spec.bearings {
        bearing.stiffness = [inf; 6];
    }
    spec.bearings[0].stiffness[5] = 0.0;
    spec.stage.planets[0].bearing_stiffness = [inf; 5];
    spec.stage.planets[0].ring_mesh = mesh(0.0, 0.0, 0.0);
    spec.bearings.push(Bearing {
        name: "torsion".into(),
        body: BodyId::Planet(0),
        anchor: Anchor::Ground,
        position: [0.0; 3],
        axes: STANDING_AXES,
        stiffness: [0.0, 0.0, 0.0, 0.0, 0.0, torsion],
        damping: [0.0; 6],
    });
    spec
}

/// Place of the planet's rotation among the coordinates.
const PLANET_ROTATION: usize = 12 + 5;

#[test]
fn order_of_an_oscillator_that_parts_from_its_mesh() {
    let torsion = 2e5;
    let spec = one_mesh(torsion);
    let transmission = Transmission::new(&spec).unwrap();
    let (inertia, radius) = (spec.stage.planets[0].polar, spec.stage.planet_base_radius);
    let inside = ((5e8 * radius * radius + torsion) / inertia).sqrt();
    let outside = (torsion / inertia).sqrt();
    let (period, rate) = (PI / inside + PI / outside, 0.5);
    let rest = transmission.equilibrium(&Load { travelled: 0.0, output_torque: 0.0, carrier_speed: 0.0 }).unwrap();
    let mut state = rest.state;
    state.velocity[PLANET_ROTATION] = rate;
    // after 5.3 periods: in contact again, 0.3 periods in or past half a wave of it
    let time = 5.3 * period;
    let phase = 0.3 * period;
    let exact = if phase < PI / inside {
        rate / inside * (inside * phase).sin()
    } else {
        -rate / outside * (outside * (phase - PI / inside)).sin()
    };
    let errors: Vec<f64> = [100, 200, 400, 800]
        .map(|steps| {
            let request = RunRequest {
                turning: Turning::Standing { time_step: time / f64::from(steps) },
                output_torque: 0.0,
                start: Start::Given(Box::new(state.clone())),
                ..steady(50, steps as usize)
            };
            let end = transmission.run(&request, &()).unwrap();
            assert!((5..=6).contains(&end.meshes[0].losses));
            (end.state.position[PLANET_ROTATION] - exact).abs() / (rate / outside)
        })
        .to_vec();
    // parting and meeting within a step limit the order; their place in it scatters the errors
    let order = (errors[0] / errors[3]).log2() / 3.0;
    assert!(order > 1.5 && errors.iter().all(|error| *error < 3e-5), "{errors:?}");
}

#[test]
fn order_with_bearings_of_any_stiffness() {
    for (stages, stiffness) in [
        (1, 4e8),
        (1, 1e12),
        (1, f64::INFINITY),
        (2, 4e8),
        (2, 1e12),
        (2, f64::INFINITY),
        (3, 4e8),
        (3, 1e12),
        (3, f64::INFINITY),
        (4, 4e8),
    ] {
        let mut spec = in_housing(&[0.1, 1.9, 4.4], 0.1);
        for planet in &mut spec.stage.planets {
            planet.bearing_stiffness[..2].fill(stiffness);
            planet.sun_mesh.damping = 1000.0;
            planet.ring_mesh.damping = 1000.0;
        }
        let cycles = 2;
        let end = |steps: usize| {
            let request = RunRequest { stages, ..steady(steps, cycles * steps) };
            let run = run(&spec, &request);
            assert!(run.meshes.iter().all(|mesh| mesh.steps_apart == 0));
            run.state.position
        };
        let exact = end(1280);
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let errors: Vec<f64> = [40, 80, 160, 320]
            .into_iter()
            .map(|steps| {
                let difference: Vec<f64> = end(steps).iter().zip(&exact).map(|(a, b)| a - b).collect();
                norm(&difference) / norm(&exact)
            })
            .collect();
        let order = (errors[0] / errors[2]).log2() / 2.0;
        // 1e12 N/m is a frequency that no step resolves and nothing damps: it rings at the size of its start
        let [least, floor] = if stiffness == 1e12 { [0.0, 1e-5] } else { [2.0 * f64::from(stages as u32) - 0.6, 0.0] };
        let is_small = errors[1..].iter().all(|error| *error < floor);
        assert!(order > least || is_small || stages == 4, "{stages} {stiffness:e}: {order} {errors:?}");
        assert!(errors[3] < [1e-4, 1e-5, 1e-5, 1e-11][stages - 1], "{stages} {stiffness:e}: {errors:?}");
    }
}

/// Kinetic energy, energy of springs, meshes and housing, and of the load (J).
fn energy(spec: &TransmissionSpec, run: &TransmissionRun) -> f64 {
    let state = &run.state;
    let ids = spec.body_ids();
    let mut sum = 0.0;
    for (index, id) in ids.iter().enumerate() {
        let body = spec.body(*id).unwrap();
        let masses = [body.mass, body.mass, body.mass, body.transverse, body.transverse, body.polar];
        let rates = &state.velocity[6 * index..6 * index + 6];
        sum += masses.iter().zip(rates).map(|(m, v)| 0.5 * m * v * v).sum::<f64>();
    }
    if let Some(housing) = &spec.housing {
        for (k, w) in housing.frequencies.iter().enumerate() {
            let i = 6 * ids.len() + k;
            sum += 0.5 * (state.velocity[i].powi(2) + (w * state.position[i]).powi(2));
        }
    }
    let at = |body: usize, point: [f64; 3], axis: [f64; 3], rotates: bool| -> f64 {
        let q = &state.position[6 * body..6 * body + 6];
        let centre = spec.body(ids[body]).unwrap().position;
        let r: [f64; 3] = std::array::from_fn(|k| point[k] - centre[k]);
        let turned = [q[4] * r[2] - q[5] * r[1], q[5] * r[0] - q[3] * r[2], q[3] * r[1] - q[4] * r[0]];
        (0..3).map(|k| axis[k] * if rotates { q[3 + k] } else { q[k] + turned[k] }).sum()
    };
    for (index, planet) in spec.stage.planets.iter().enumerate() {
        let angle = planet.angle + TAU * 0.3 / 99.0;
        let (sin, cos) = angle.sin_cos();
        let point = [spec.stage.centre_distance * cos, spec.stage.centre_distance * sin, spec.stage.height];
        let axes = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        for (k, stiffness) in planet.bearing_stiffness.iter().enumerate() {
            // arms from where the carrier's turning has taken the planet
            let own = &state.position[6 * (index + 2)..];
            let of_planet: f64 = (0..3).map(|i| axes[k % 3][i] * own[if k < 3 { i } else { 3 + i }]).sum();
            sum += 0.5 * stiffness * (of_planet - at(1, point, axes[k % 3], k >= 3)).powi(2);
        }
    }
    for bearing in &spec.bearings {
        let body = ids.iter().position(|id| *id == bearing.body).unwrap();
        let port = match (&bearing.anchor, &spec.housing) {
            (Anchor::Port(name), Some(housing)) => housing.ports.iter().find(|port| port.name == *name),
            _ => None,
        };
        for (k, stiffness) in bearing.stiffness.iter().enumerate() {
            let mut moved = at(body, bearing.position, bearing.axes[k % 3], k >= 3);
            if let Some(port) = port {
                assert_eq!(bearing.axes, STANDING_AXES);
                let modal = &state.position[6 * ids.len()..];
                let shape = |row: usize| (0..modal.len()).map(|m| port.shapes[(row, m)] * modal[m]).sum::<f64>();
                let p = bearing.position;
                let turned = [
                    shape(4) * p[2] - shape(5) * p[1],
                    shape(5) * p[0] - shape(3) * p[2],
                    shape(3) * p[1] - shape(4) * p[0],
                ];
                moved -= if k < 3 { shape(k) + turned[k] } else { shape(k) };
            }
            sum += 0.5 * stiffness * moved * moved;
        }
    }
    for mesh in &run.meshes {
        sum += 0.5 * mesh.force.last().unwrap() * mesh.approach.last().unwrap();
    }
    sum + TORQUE * state.position[6 + 5]
}

#[test]
fn invariant_energy_of_an_undamped_transmission_at_rest_position() {
    let spec = undamped(in_housing(&[0.1, 1.9, 4.4], 0.0));
    let transmission = Transmission::new(&spec).unwrap();
    let load = Load { travelled: 0.3, output_torque: TORQUE, carrier_speed: 0.0 };
    let mut state = transmission.equilibrium(&load).unwrap().state;
    for (k, value) in state.velocity.iter_mut().enumerate().skip(6) {
        *value = 1e-3 * (k as f64).sin();
    }
    let request = RunRequest {
        turning: Turning::Standing { time_step: 2e-5 },
        travelled: 0.3,
        start: Start::Given(Box::new(state)),
        ..steady(50, 0)
    };
    let mut runner = transmission.start(&request).unwrap();
    let first = runner.record(1, &()).unwrap();
    let later = runner.record(4000, &()).unwrap();
    assert!(later.meshes.iter().all(|mesh| mesh.steps_apart == 0));
    let kinetic: f64 = 1e-6;
    let (before, after) = (energy(&spec, &first), energy(&spec, &later));
    // against the energy of the motion put in, not that of the preload
    assert!((after - before).abs() < 1e-6 * kinetic.max(1e-6), "{before} {after}");
}

#[test]
fn invariant_constant_meshes_turn_without_exciting() {
    // three unequal planets load a ring on equal springs: in the carrier's axes nothing changes
    let mut spec = in_housing(&[0.1, 1.9, 4.4], 0.0);
    damp(&mut spec);
    let run = run(&spec, &RunRequest { settle_steps: 1500, ..steady(20, 500) });
    let load = Load { travelled: 0.0, output_torque: TORQUE, carrier_speed: SPEED };
    let rest = Transmission::new(&spec).unwrap().equilibrium(&load).unwrap();
    for (mesh, rest) in run.meshes.iter().zip(&rest.mesh_forces) {
        let (low, high) = mesh.force.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
        assert!((high - low) / rest < 1e-6, "{}: {low} {high}", mesh.name);
        // dampers in standing axes see a turning displacement: (damping / stiffness) * speed = 2e-3
        assert!((low / rest - 1.0).abs() < 2e-3, "{}: {low} {rest}", mesh.name);
    }
}

#[test]
fn invariant_sensor_hears_only_multiples_of_planet_pass() {
    // 100 teeth: the meshes of the three planets are a third of a cycle apart, so that they push the ring sideways
    let (steps, teeth) = (12, 100);
    let turn = teeth * steps;
    let mut spec = in_housing(&equal(3, 0.3), 0.15);
    spec.stage.ring_teeth = teeth as u32;
    for planet in &mut spec.stage.planets {
        let phase = teeth as f64 * planet.angle / TAU;
        (planet.sun_mesh, planet.ring_mesh) = (mesh(5e8, 0.15, phase), mesh(6e8, 0.15, phase));
    }
    damp(&mut spec);
    // a housing that is not round, so that a fixed sensor hears the planets pass
    let housing = spec.housing.as_mut().unwrap();
    housing.frequencies[0] *= 0.7;
    let run = run(&spec, &RunRequest { settle_steps: 2 * turn, ..steady(steps, turn) });
    for sensor in &run.sensors {
        let amplitude = |order: usize| {
            let (mut a, mut b) = (0.0, 0.0);
            for (k, x) in sensor.acceleration.iter().enumerate() {
                let (sin, cos) = (TAU * ((order * k) % turn) as f64 / turn as f64).sin_cos();
                (a, b) = (a + x * cos, b + x * sin);
            }
            f64::hypot(a, b) * 2.0 / turn as f64
        };
        let largest = (1..300).map(amplitude).fold(0.0, f64::max);
        let stray = (1..300).filter(|order| order % 3 != 0).map(amplitude).fold(0.0, f64::max);
        assert!(stray < 1e-6 * largest, "{}: {stray} of {largest}", sensor.name);
    }
    let change = run.periodic_change(turn / 3).unwrap();
    assert!(change < 1e-4, "{change}");
}

#[test]
fn invariant_goes_on_to_the_bit_on_any_threads() {
    let mut spec = in_housing(&equal(3, 0.3), 0.15);
    for planet in &mut spec.stage.planets {
        planet.sun_mesh = with_coast(planet.sun_mesh.clone(), 5e-5);
    }
    let transmission = Transmission::new(&spec).unwrap();
    let request = steady(50, 60);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| transmission.run(&request, &()).unwrap())
    };
    let whole = on(1);
    for threads in [2, 7] {
        let other = on(threads);
        assert_eq!((&whole.state, &whole.meshes, &whole.sensors), (&other.state, &other.meshes, &other.sensors));
    }
    let mut runner = transmission.start(&request).unwrap();
    runner.settle(23, &()).unwrap();
    let request = RunRequest { start: Start::Given(Box::new(runner.state().clone())), ..request.clone() };
    let rest = transmission.run(&RunRequest { samples: 37, ..request }, &()).unwrap();
    assert_eq!(rest.state, whole.state);
    assert_eq!(rest.meshes[0].force, whole.meshes[0].force[23..]);
    assert_eq!(rest.first_step, 24);
}

#[test]
fn extreme_speeds_loads_and_stiffnesses() {
    for sun_rpm in [1.0, 1e3, 6e4] {
        for torque in [0.0, 1e-6, 1e6] {
            for stiffness in [1e3, 1e9, 1e15] {
                let mut spec = in_housing(&[0.1, 1.9, 4.4], 0.2);
                for planet in &mut spec.stage.planets {
                    planet.bearing_stiffness = [stiffness; 5];
                    planet.sun_mesh = with_coast(planet.sun_mesh.clone(), 5e-5);
                    planet.ring_mesh = with_coast(planet.ring_mesh.clone(), 5e-5);
                }
                let speed = sun_rpm * TAU / 60.0 * 27.0 / 126.0;
                let turning = Turning::Steady { carrier_speed: speed, steps_per_cycle: 50 };
                let request = RunRequest { turning, output_torque: torque, ..steady(50, 30) };
                let run = run(&spec, &request);
                let size = run.state.position.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                let stats = run.stats;
                // what is left is the rounding of compliance times force, terms larger than the displacements they add up to: millinewtons of 1e7 N
                // and without a load, of flanks that touch by chance: nanonewtons
                assert!(
                    stats.worst_residual <= 1e-10 * size + 1e-17,
                    "{sun_rpm} rpm, {torque} N m, {stiffness:e} N/m: {size} {stats:?}"
                );
                assert!(stats.newton_iterations <= 30 * stats.steps, "{stats:?}");
            }
        }
    }
}

#[test]
fn analytic_whirling_rotor() {
    // I_t z'' - i I_p w z' + k z = 0 for the tilt z = rx + i ry of the sun, which its meshes at mid-height do not feel
    let (stiffness, tilting) = (1e5, 0.2);
    let mut spec = undamped(train(&equal(3, 0.3), 0.0));
    spec.sun.spin_ratio = 200.0;
    spec.bearings[0].position = [0.0; 3];
    spec.bearings[0].stiffness[3..5].fill(stiffness);
    let transmission = Transmission::new(&spec).unwrap();
    let load = Load { travelled: 0.0, output_torque: TORQUE, carrier_speed: SPEED };
    let mut state = transmission.equilibrium(&load).unwrap().state;
    state.velocity[3] = tilting;
    let gyroscopic = spec.sun.polar * spec.sun.spin_ratio * SPEED;
    let root = (gyroscopic.powi(2) + 4.0 * spec.sun.transverse * stiffness).sqrt();
    let [forward, backward] = [1.0, -1.0].map(|sign| (gyroscopic + sign * root) / (2.0 * spec.sun.transverse));
    assert!(forward > 1.5 * -backward, "the spin matters");
    let cycles = 2;
    let time = TAU / SPEED / 99.0 * cycles as f64;
    // tilting (e^(i a t) - e^(i b t)) / (i (a - b))
    let size = tilting / (forward - backward);
    let exact = [
        size * ((forward * time).sin() - (backward * time).sin()),
        -size * ((forward * time).cos() - (backward * time).cos()),
    ];
    let errors = [200, 400].map(|steps| {
        let start = Start::Given(Box::new(state.clone()));
        let end = transmission.run(&RunRequest { start, ..steady(steps, cycles * steps) }, &()).unwrap().state.position;
        f64::hypot(end[3] - exact[0], end[4] - exact[1]) / size
    });
    assert!(errors.iter().all(|error| *error < 1e-7), "{errors:?}");
}

#[test]
fn invariant_a_cancelled_run_keeps_what_it_has() {
    struct Few(std::sync::atomic::AtomicUsize);
    impl fecm::Observer for Few {
        fn advanced(&self, done: usize, _total: usize) {
            self.0.store(done, std::sync::atomic::Ordering::Relaxed);
        }
        fn is_cancelled(&self) -> bool {
            self.0.load(std::sync::atomic::Ordering::Relaxed) >= 7
        }
    }
    let spec = in_housing(&equal(3, 0.3), 0.1);
    let few = Few(std::sync::atomic::AtomicUsize::new(0));
    let part = Transmission::new(&spec).unwrap().run(&steady(50, 20), &few).unwrap();
    assert_eq!((part.len(), part.state.step), (7, 7));
    assert_eq!(part.sensors[0].acceleration[..], run(&spec, &steady(50, 20)).sensors[0].acceleration[..7]);
}

#[test]
fn extreme_load_that_overruns_the_teeth_is_an_error() {
    // 20 MN on springs of 5e8 N/m: 40 mm, five base pitches
    let transmission = Transmission::new(&in_housing(&[0.1, 1.9, 4.4], 0.2)).unwrap();
    let run = transmission.run(&RunRequest { output_torque: 1e7, ..steady(50, 3) }, &());
    assert!(matches!(run, Err(PlanetaryError::Lost { .. })), "{run:?}");
}
