//! Both stages in an elastic housing.

mod support;

use std::f64::consts::TAU;

use planetary::engine::{Anchor, BodyId, Load, RunRequest, STAGES, Start, Transmission, Turning};
use support::{equal, train, whole};

const TORQUE: f64 = 6106.0;
const SPEED: f64 = 347.5 * TAU / 60.0;

#[test]
fn analytic_torques_and_forces_through_both_stages() {
    let spec = whole(&equal(3, 0.3), 20);
    let load = Load { travelled: 0.4, output_torque: TORQUE, carrier_speed: 0.0 };
    let rest = Transmission::new(&spec).unwrap().equilibrium(&load).unwrap();
    let bevel = spec.bevel.as_ref().unwrap();
    let (gear, pinion) = (bevel.gear.unwrap(), bevel.pinion);
    // moment of the line of action about the axis of a body
    let lever = |position: [f64; 3], axis: [f64; 3]| {
        let arm: [f64; 3] = std::array::from_fn(|k| bevel.point[k] - position[k]);
        let n = bevel.normal;
        let moment = [arm[1] * n[2] - arm[2] * n[1], arm[2] * n[0] - arm[0] * n[2], arm[0] * n[1] - arm[1] * n[0]];
        moment.iter().zip(axis).map(|(a, b)| a * b).sum::<f64>()
    };
    let sun_torque = TORQUE * 27.0 / 126.0;
    let normal_force = sun_torque / lever(gear.position, gear.axis);
    let [.., bevel_force] = rest.mesh_forces[..] else { panic!("no meshes") };
    assert!((bevel_force / normal_force - 1.0).abs() < 1e-4, "{bevel_force} {normal_force}");
    let input = normal_force * lever(pinion.position, pinion.axis);
    let held = rest.input_torque.unwrap();
    assert!((held / input - 1.0).abs() < 1e-4, "{held} {input}");
    // along z the bevel mesh alone pushes the gear; its shaft and the spline carry that
    let axial: f64 = -rest.bearing_loads[3][2] + rest.bearing_loads[4][2] + rest.bearing_loads[5][2];
    assert!((axial / (normal_force * bevel.normal[2]) - 1.0).abs() < 1e-4, "{axial}");
}

#[test]
fn invariant_order_of_ports_and_bearings_is_of_no_account() {
    let mut spec = whole(&equal(3, 0.3), 12);
    let load = Load { travelled: 0.4, output_torque: TORQUE, carrier_speed: SPEED };
    let one = Transmission::new(&spec).unwrap().equilibrium(&load).unwrap();
    spec.bearings.reverse();
    spec.housing.as_mut().unwrap().ports.reverse();
    let other = Transmission::new(&spec).unwrap().equilibrium(&load).unwrap();
    for (a, b) in one.position.iter().zip(&other.position) {
        // motions are of 1e-4
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn invariant_planet_pass_repeats_where_planets_are_equal() {
    // no bevel stage: the gear's mesh does not repeat with the planets
    let mut spec = whole(&equal(3, 0.3), 30);
    spec.bevel = None;
    spec.bearings.retain(|bearing| bearing.body == BodyId::Carrier);
    spec.bearings.push(train(&[0.0], 0.0).bearings[0].clone());
    spec.bearings[1].anchor = Anchor::Port("bottom".into());
    spec.drive = Some(BodyId::Sun);
    // 200 Hz lose seven powers of e a pass
    spec.housing.as_mut().unwrap().damping_ratios.fill(0.1);
    for bearing in &mut spec.bearings {
        bearing.damping = bearing.stiffness.map(|k| 5e-5 * k);
    }
    for planet in &mut spec.stage.planets {
        planet.bearing_damping = planet.bearing_stiffness.map(|k| 5e-5 * k);
        (planet.sun_mesh.damping, planet.ring_mesh.damping) = (2e4, 2e4);
    }
    let pass = 33 * 12;
    let request = RunRequest {
        turning: Turning::Steady { carrier_speed: SPEED, steps_per_cycle: 12 },
        output_torque: TORQUE,
        travelled: 0.0,
        start: Start::Equilibrium,
        settle_steps: 3 * pass,
        samples: 3 * pass,
        band: None,
        record_motion: false,
        stages: STAGES,
    };
    let run = Transmission::new(&spec).unwrap().run(&request, &()).unwrap();
    let change = run.periodic_change(pass).unwrap();
    assert!(change < 1e-6, "{change}");
    assert!(run.periodic_change(pass / 3).unwrap() > 1e-2, "a third of a pass is no period");
    assert!(run.periodic_change(2 * pass).is_none());
    let rms = |series: &[f64]| (series.iter().map(|x| x * x).sum::<f64>() / series.len() as f64).sqrt();
    assert!(run.sensors.iter().all(|sensor| rms(&sensor.acceleration) > 0.0));
}
