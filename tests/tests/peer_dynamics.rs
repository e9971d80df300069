//! Two independent ways to the same motion: FE/CM steps with rigid hubs, and the lumped-parameter model fed with that model's own stiffness and
//! transmission error; and the impulse tests printed in the dissertation.
//!
//! The lumped model is linear about the static answer of every position, FE/CM is not: contact spreads with load. Dissertation section 3.4.3 finds
//! them close at a mesh frequency of 900 Hz, and so must we.

use std::f64::consts::TAU;
use std::path::Path;

use fecm::dynamics::{
    Damping, DynamicsOptions, DynamicsRequest, ImpulseSpec, PairDynamics, RotorInertia, RotorOptions, SteadySpec,
    Support,
};
use fecm::statics::{PairModel, StaticsRequest};
use gearwright_case as case;
use lpm::{Curve, Excitation, GearPair, Input, Interpolation, Model, Sampling, SteadyOptions, Supports};

const TORQUE: f64 = 424.0;
/// `2 zeta omega` of the impulse tests of section 4.3: 3434 N s/m on 2.401 kg.
const ALPHA: f64 = 2.0 * 0.048 * TAU * 2370.73;

fn model() -> PairModel {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/nonunity-pair-plane.toml");
    let case = case::load_spur_pair(&file).unwrap();
    PairModel::new(&case.pair, &case.options).unwrap()
}

/// Inertias of Table 3.2 on ideal bearings, the pinion turning at constant speed.
fn options() -> DynamicsOptions {
    let rotor = |mass, polar, rotation| {
        RotorOptions::on_ideal_bearings(RotorInertia { mass, polar, transverse: 0.5 * polar }, rotation)
    };
    DynamicsOptions::new(
        [rotor(0.7294, 0.0008, Support::Fixed), rotor(0.8537, 0.0050, Support::Free)],
        Damping { mass_proportional: ALPHA, stiffness_proportional: 0.0, modal_ratio: 0.0 },
    )
}

#[test]
fn peer_lumped_model_fed_with_the_same_stiffness() {
    const STEPS: usize = 200;
    let model = model();
    let positions = StaticsRequest::new((0..STEPS).map(|k| k as f64 / STEPS as f64).collect::<Vec<_>>(), [TORQUE]);
    let still = model.solve(&positions, &()).unwrap().results.remove(0);
    let stiffness: Vec<f64> = still.iter().map(|r| r.stiffness_local_slope.unwrap()).collect();
    let error: Vec<f64> = still.iter().map(|r| r.static_transmission_error).collect();
    let curve = |values: &[f64]| Curve::samples(1, values, Interpolation::Linear).unwrap();
    let mut pair = GearPair::table_3_2(Input::Prescribed);
    pair.damping_when_apart = true;
    // the FE/CM model's base radius, and its damping of all motion
    pair.gear.base_radius = model.pairing().base_radius(1);
    pair.gear.torque = TORQUE;
    pair.mesh_damping = ALPHA * pair.effective_mass();
    let lumped =
        Model::new(&pair, &Excitation::new(&curve(&stiffness), &curve(&error)).unwrap(), Supports::Rigid).unwrap();
    let dynamics = PairDynamics::new(&model, &options()).unwrap();
    for (mesh_frequency, allowed) in [(300.0, 0.02), (900.0, 0.03), (3500.0, 0.03)] {
        let request = DynamicsRequest::running(TAU * mesh_frequency / 27.0, STEPS, TORQUE);
        let spec = SteadySpec { period: STEPS, tolerance: 1e-8, most_periods: 200 };
        let (run, change) = dynamics.start(&request).unwrap().settle(&spec, &()).unwrap();
        assert!(change < spec.tolerance, "{mesh_frequency} Hz: {change:.1e}");
        let sampling = Sampling { per_cycle: STEPS, energy: false };
        let response = lumped
            .steady_response(mesh_frequency, &lumped.equilibrium(0.0), 1, &sampling, &SteadyOptions::default())
            .unwrap()
            .response;
        // records end their steps: record k is at sample k + 1
        let pairs: Vec<(f64, f64)> =
            (0..STEPS - 1).map(|k| (run.records[k].transmission_error, response.transmission_error[k + 1])).collect();
        let mean = pairs.iter().map(|p| p.1).sum::<f64>() / pairs.len() as f64;
        let rms = |values: &dyn Fn(&(f64, f64)) -> f64| {
            (pairs.iter().map(|p| values(p).powi(2)).sum::<f64>() / pairs.len() as f64).sqrt()
        };
        let miss = rms(&|p| p.0 - p.1) / rms(&|p| p.1 - mean);
        println!("{mesh_frequency} Hz: {miss:.4} of the variation, {:.4} of the mean", rms(&|p| p.0 - p.1) / mean);
        assert!(rms(&|p| p.0 - p.1) / mean < allowed, "{mesh_frequency} Hz: {miss:.4}");
    }
}

/// D4.3: 2370.73 Hz and 0.048 with one pair, 2916.63 Hz and 0.039 with two, 2720.11 Hz over the cycle.
#[test]
fn peer_dissertation_impulse_tests() {
    let model = model();
    let dynamics = PairDynamics::new(&model, &options()).unwrap();
    let read = |mesh_cycle: f64| {
        let spec = ImpulseSpec { mesh_cycle, torque: TORQUE, pulse: 0.05, periods: 60 };
        dynamics.impulse_test(&spec, &()).unwrap().unwrap()
    };
    let (one, two) = (read(0.0), read(0.6));
    for reading in [&one, &two] {
        println!(
            "{:.2}: {:.2} Hz, zeta {:.4} / {:.4}, peak {:.2} Hz, {} maxima",
            reading.mesh_cycle,
            reading.natural_frequency,
            reading.damping_log_decrement,
            reading.damping_half_power,
            reading.peak_frequency,
            reading.maxima
        );
    }
    let within = |value: f64, printed: f64, tolerance: f64| {
        assert!((value / printed - 1.0).abs() < tolerance, "computed {value}, printed {printed}");
    };
    within(one.natural_frequency, 2370.73, 0.015);
    within(two.natural_frequency, 2916.63, 0.015);
    // the damping of one pair is given, that of two is computed
    within(two.damping_log_decrement, 0.039, 0.03);
    within(two.damping_half_power, 0.039, 0.06);
    let overall = 0.64 * two.natural_frequency + 0.36 * one.natural_frequency;
    within(overall, 2720.11, 0.015);
}
