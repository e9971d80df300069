//! Transmissions at rest under load.

mod support;

use std::f64::consts::TAU;

use planetary::PlanetaryError;
use planetary::engine::{Anchor, BodyId, Equilibrium, Load, Transmission, TransmissionSpec};
use support::{CENTRE, TEETH, equal, mesh, rigid_ring, train, with_coast};

const TORQUE: f64 = 6106.0;

fn rest(spec: &TransmissionSpec, travelled: f64, torque: f64) -> Equilibrium {
    let load = Load { travelled, output_torque: torque, carrier_speed: 0.0 };
    Transmission::new(spec).unwrap().equilibrium(&load).unwrap()
}

fn close(value: f64, wanted: f64, tolerance: f64) {
    assert!((value - wanted).abs() <= tolerance * wanted.abs().max(1.0), "{value} is not {wanted}");
}

/// Relative rounding of forces through a compliance solve.
const ROUNDING: f64 = 1e-8;

#[test]
fn analytic_torques_and_loads_of_equal_planets() {
    for (count, travelled) in [(1, 0.0), (3, 0.37), (5, 12.9)] {
        let spec = train(&equal(count, 0.4), 0.0);
        let at = rest(&spec, travelled, TORQUE);
        let [sun, _, ring] = TEETH.map(f64::from);
        close(at.input_torque.unwrap(), TORQUE * sun / (sun + ring), ROUNDING);
        // a single planet pushes the carrier over; its share is the same
        let share = TORQUE / (sun + ring) * sun / count as f64 / spec.stage.sun_base_radius;
        for force in &at.mesh_forces {
            close(*force, share, 1e-6);
        }
        // pins carry the sum of both meshes along the tangent
        for bearing in &at.bearing_loads[..count] {
            close(bearing[1].abs(), TORQUE / CENTRE / count as f64, 1e-6);
        }
        // approaches are those of springs
        close(at.approaches[0], at.mesh_forces[0] / 5e8, ROUNDING);
    }
}

#[test]
fn invariant_energy_stored_is_work_done() {
    // linear: the energy in springs is half the work of the torque on the carrier's rotation
    let mut spec = train(&[0.1, 1.9, 4.4], 0.0);
    spec.housing = Some(rigid_ring(0.15, [2e8, 20.0], [5e6, 0.3], 0.01));
    spec.bearings[0].anchor = Anchor::Port("axis".into());
    let at = rest(&spec, 3.3, TORQUE);
    let carrier_turn = at.position[6 + 5];
    let work = -0.5 * TORQUE * carrier_turn;
    let mut stored: f64 = at.mesh_forces.iter().zip(&at.approaches).map(|(f, x)| 0.5 * f * x).sum();
    for (index, load) in at.bearing_loads.iter().enumerate() {
        let stiffness: Vec<f64> = match index {
            0..3 => spec.stage.planets[index].bearing_stiffness.to_vec(),
            _ => spec.bearings[index - 3].stiffness.to_vec(),
        };
        let springs = load.iter().zip(&stiffness).filter(|(_, k)| **k > 0.0);
        stored += springs.map(|(f, k)| 0.5 * f * f / k).sum::<f64>();
    }
    let housing = spec.housing.as_ref().unwrap();
    let modal = at.position.len() - 3;
    stored += (0..3).map(|k| 0.5 * (housing.frequencies[k] * at.position[modal + k]).powi(2)).sum::<f64>();
    close(stored / work, 1.0, ROUNDING);
}

#[test]
fn invariant_reactions_balance_loads() {
    let mut spec = train(&[0.1, 1.9, 4.4], 0.0);
    spec.housing = Some(rigid_ring(0.15, [2e8, 20.0], [5e6, 0.3], 0.01));
    let at = rest(&spec, 3.3, TORQUE);
    // the housing alone holds the ring: its springs carry what the ring meshes and nothing else give it
    let [sun, carrier] = [&at.bearing_loads[3], &at.bearing_loads[4]];
    let housing = spec.housing.as_ref().unwrap();
    let modal = &at.position[at.position.len() - 3..];
    let unit = [1.0 / 20.0_f64.sqrt(), 1.0 / 20.0_f64.sqrt(), 1.0 / 0.3_f64.sqrt()];
    // stiffness times displacement
    let spring = |k: usize| housing.frequencies[k].powi(2) / unit[k] * modal[k];
    for k in 0..2 {
        close(sun[k] + carrier[k] + spring(k), 0.0, 1e-4);
    }
    // torques: ring = carrier - sun
    close(spring(2), -(TORQUE - at.input_torque.unwrap()), ROUNDING);
}

#[test]
fn invariant_infinite_stiffness_is_the_limit() {
    let at = |stiffness: f64| {
        let mut spec = train(&equal(3, 0.0), 0.0);
        for bearing in &mut spec.bearings {
            bearing.stiffness = [stiffness, stiffness, stiffness, stiffness, stiffness, 0.0];
        }
        for planet in &mut spec.stage.planets {
            planet.bearing_stiffness = [stiffness; 5];
        }
        rest(&spec, 0.2, TORQUE)
    };
    let (stiff, limit) = (at(1e15), at(f64::INFINITY));
    for (a, b) in stiff.position.iter().zip(&limit.position) {
        // 34 kN on 1e15 N/m, over a base radius
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    for (a, b) in stiff.mesh_forces.iter().zip(&limit.mesh_forces) {
        close(*a, *b, 1e-6);
    }
}

#[test]
fn invariant_coast_flanks_carry_a_torque_the_other_way() {
    let backlash = 1e-4;
    let mut spec = train(&equal(3, 0.0), 0.0);
    for planet in &mut spec.stage.planets {
        planet.sun_mesh = with_coast(mesh(5e8, 0.0, 0.0), backlash);
        planet.ring_mesh = with_coast(mesh(6e8, 0.0, 0.0), backlash);
    }
    let (ahead, back) = (rest(&spec, 0.0, TORQUE), rest(&spec, 0.0, -TORQUE));
    for (a, b) in ahead.mesh_forces.iter().zip(&back.coast_forces) {
        close(*b, *a, 1e-6);
    }
    assert!(back.mesh_forces.iter().all(|force| *force == 0.0));
    let total: f64 = 2.0 * backlash;
    // driven sun held: play of both meshes turns the carrier
    let play = total / (spec.stage.sun_base_radius + spec.stage.ring_base_radius);
    let turned = back.position[11] + ahead.position[11];
    close(turned / play, 1.0, 1e-6);
}

#[test]
fn extreme_loads_and_trains() {
    for count in 1..=7 {
        let angles: Vec<f64> = (0..count).map(|k| TAU * k as f64 / count as f64 + 0.05 * (k * k) as f64).collect();
        for torque in [0.0, 1e-9, 1e9] {
            let at = rest(&train(&angles, 0.2), 1e6 + 0.3, torque);
            let sum: f64 = at.mesh_forces[..count].iter().sum::<f64>() * 0.0352;
            let wanted = torque * 27.0 / 126.0;
            assert!((sum - wanted).abs() <= 1e-6 * wanted, "{count} planets, {torque} N m: {sum} is not {wanted}");
            assert!(at.position.iter().all(|x| x.is_finite()));
        }
    }
    let at = rest(&train(&equal(3, 0.0), 0.0), 0.0, 0.0);
    assert!(at.position.iter().all(|x| *x == 0.0), "no load, no motion");
}

#[test]
fn invariant_what_cannot_rest_is_an_error() {
    let mut free = train(&equal(3, 0.0), 0.0);
    free.drive = None;
    let load = Load { travelled: 0.0, output_torque: TORQUE, carrier_speed: 0.0 };
    let answer = Transmission::new(&free).unwrap().equilibrium(&load);
    assert!(matches!(answer, Err(PlanetaryError::NoEquilibrium { .. })), "{answer:?}");

    let mut twice = train(&equal(3, 0.0), 0.0);
    twice.bearings[0].stiffness = [f64::INFINITY, 1e8, 1e8, 1e5, 1e5, 0.0];
    let mut copy = twice.bearings[0].clone();
    copy.name = "sun again".into();
    twice.bearings.push(copy);
    let answer = Transmission::new(&twice).unwrap().equilibrium(&load);
    assert!(matches!(answer, Err(PlanetaryError::OverConstrained { .. })), "{answer:?}");

    let mut astray = train(&equal(3, 0.0), 0.0);
    astray.bearings[0].anchor = Anchor::Port("nowhere".into());
    assert!(matches!(Transmission::new(&astray), Err(PlanetaryError::Missing { .. })));
    astray.bearings[0].anchor = Anchor::Body(BodyId::BevelGear);
    assert!(matches!(Transmission::new(&astray), Err(PlanetaryError::Missing { .. })));
    let mut heavy = train(&equal(3, 0.0), 0.0);
    heavy.carrier.mass = f64::NAN;
    let mut aside = train(&equal(3, 0.0), 0.0);
    aside.sun.position[0] = 1e-3;
    assert!(matches!(Transmission::new(&aside), Err(PlanetaryError::Value { .. })));
    // a housing in mm
    let mut large = train(&equal(3, 0.0), 0.0);
    large.housing = Some(rigid_ring(150.0, [2e9, 20.0], [5e7, 0.3], 0.05));
    let answer = Transmission::new(&large).map(|_| ()).unwrap_err().to_string();
    assert!(answer.contains("same unit of length"), "{answer}");
    assert!(matches!(Transmission::new(&heavy), Err(PlanetaryError::Value { .. })));
    assert_eq!(mesh(5e8, 0.0, 0.0).law.response(0.0, -1e-9).force, 0.0);
}
