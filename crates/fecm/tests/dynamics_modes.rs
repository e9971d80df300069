//! Elastic modes in motion: more of them change less, and none of them changes the static answer.

mod common;

use common::{TORQUE, pair};
use fecm::dynamics::{
    Damping, DynamicsOptions, DynamicsRequest, DynamicsRun, ImpulseSpec, PairDynamics, RotorInertia, RotorOptions,
    SteadySpec, Support,
};
use fecm::statics::{PairModel, PairModelOptions};
use fecm::{FaceModel, FecmError, MeshDensity};

const UNDAMPED: Damping = Damping { mass_proportional: 0.0, stiffness_proportional: 0.0, modal_ratio: 0.0 };
const DAMPED: Damping = Damping { mass_proportional: 3000.0, stiffness_proportional: 0.0, modal_ratio: 0.01 };
const RPM: f64 = std::f64::consts::PI / 30.0;
const LADDER: [usize; 4] = [0, 5, 20, 100];

fn model() -> PairModel {
    let mut options = PairModelOptions { face: FaceModel::PlaneStress, ..PairModelOptions::default() };
    options.contact.cells_per_half_width = 4.0;
    for member in [&mut options.pinion, &mut options.wheel] {
        member.mesh = MeshDensity { order: 2, density: 0.7 };
    }
    PairModel::new(&pair(25, 31), &options).unwrap()
}

/// Gears that carry a fifth more than their own inertia, times `share`.
fn options(model: &PairModel, modes: usize, damping: Damping, share: f64) -> DynamicsOptions {
    let rotor = |body: usize, rotation: Support| {
        let own = model.bodies()[body].inertia();
        let [mass, polar, transverse] = [own.mass, own.polar, own.transverse].map(|value| 1.2 * share * value);
        let inertia = RotorInertia { mass, polar, transverse };
        RotorOptions { modes, ..RotorOptions::on_ideal_bearings(inertia, rotation) }
    };
    DynamicsOptions::new([rotor(0, Support::Fixed), rotor(1, Support::Free)], damping)
}

fn running(rpm: f64, steps_per_cycle: usize) -> DynamicsRequest {
    DynamicsRequest::running(rpm * RPM, steps_per_cycle, TORQUE)
}

fn run(model: &PairModel, options: &DynamicsOptions, request: &DynamicsRequest, steps: usize) -> DynamicsRun {
    let run = PairDynamics::new(model, options).unwrap().run(request, steps, &()).unwrap();
    assert_eq!(run.stats.not_converged, 0);
    run
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(s, n), x| (s + x * x, n + 1.0));
    (sum / count).sqrt()
}

/// RMS difference of two runs over the RMS variation of the second.
fn difference(one: &DynamicsRun, other: &DynamicsRun) -> f64 {
    let (one, other) = (one.transmission_errors(), other.transmission_errors());
    let mean = other.iter().sum::<f64>() / other.len() as f64;
    rms(one.iter().zip(&other).map(|(a, b)| a - b)) / rms(other.iter().map(|x| x - mean))
}

/// One mesh cycle of steady motion: it repeats from mesh cycle to mesh cycle, although every cycle has other teeth.
fn steady(model: &PairModel, modes: usize, rpm: f64, steps: usize) -> DynamicsRun {
    let spec = SteadySpec { period: steps, tolerance: 1e-6, most_periods: 400 };
    let dynamics = PairDynamics::new(model, &options(model, modes, DAMPED, 1.0)).unwrap();
    let (run, change) = dynamics.start(&running(rpm, steps)).unwrap().settle(&spec, &()).unwrap();
    assert!(change < spec.tolerance, "{modes} modes, {rpm} rpm: {change:.1e}");
    run
}

/// Gears with hardly more than their own inertia: a rigid hub that holds all of it swings 2.4 % too slowly, which five modes mend.
#[test]
fn order_ladder_of_modes_in_steady_motion() {
    let model = model();
    let frequencies = LADDER.map(|modes| {
        let dynamics = PairDynamics::new(&model, &options(&model, modes, DAMPED, 1.0)).unwrap();
        let spec = ImpulseSpec { mesh_cycle: 0.0, torque: TORQUE, pulse: 0.05, periods: 20 };
        dynamics.impulse_test(&spec, &()).unwrap().unwrap().natural_frequency
    });
    let shift = frequencies.map(|frequency| frequency / frequencies[3] - 1.0);
    assert!(shift[0] < -0.01 && shift[0] > -0.05, "{frequencies:?}");
    assert!(shift[1].abs() < 2e-3 && shift[2].abs() < shift[1].abs(), "{frequencies:?}");
    // resonances lie at 3650 rpm over whole numbers; next to one a shift of frequency counts several times
    for (rpm, most) in [(2600.0, [0.2, 0.01, 0.005]), (4000.0, [0.4, 0.01, 0.005])] {
        let runs = LADDER.map(|modes| steady(&model, modes, rpm, 100));
        let errors: Vec<f64> = runs[..3].iter().map(|one| difference(one, &runs[3])).collect();
        assert!(errors[0] > errors[1] && errors[1] > errors[2], "{rpm} rpm: {errors:?}");
        assert!(errors.iter().zip(most).all(|(error, most)| *error < most), "{rpm} rpm: {errors:?}");
    }
}

/// The rigid level is held to the static answer in `tests/dynamics.rs`.
#[test]
fn invariant_slow_motion_is_the_same_at_every_level() {
    let model = model();
    let [rigid, others @ ..] =
        LADDER.map(|modes| run(&model, &options(&model, modes, DAMPED, 1.0), &running(0.01, 20), 60));
    for (modes, other) in LADDER[1..].iter().zip(&others) {
        for (record, rigid) in other.records.iter().zip(&rigid.records) {
            let miss = (record.transmission_error / rigid.transmission_error - 1.0).abs();
            assert!(miss < 1e-6, "{modes} modes at {}: {miss:.2e}", record.mesh_cycle);
        }
    }
}

#[test]
fn invariant_work_and_energy_balance_to_rounding_with_modes() {
    let model = model();
    for modes in LADDER {
        let run = run(&model, &options(&model, modes, UNDAMPED, 1.0), &running(5000.0, 100), 1000);
        let relative = run.energy.worst_residual / run.energy.scale;
        assert!(relative < 1e-9, "{modes} modes: {relative:.2e}");
    }
}

#[test]
fn invariant_threads_give_the_same_bits_with_modes() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let model = model();
            run(&model, &options(&model, 20, DAMPED, 1.0), &running(5000.0, 37), 100).records
        })
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_hub_lighter_than_its_modes_is_refused() {
    let model = model();
    let error = PairDynamics::new(&model, &options(&model, 100, DAMPED, 0.05)).err().unwrap();
    let given = 0.05 * 1.2 * model.bodies()[1].inertia().polar;
    let FecmError::LightHub { body, given: found, carried, .. } = error else { panic!("{error}") };
    assert!(body == "wheel" && (found / given - 1.0).abs() < 1e-12 && carried > given, "{error}");
    assert!(error.to_string().contains("or keep no elastic modes"), "{error}");
}

/// Modes move the surface with what a few of them resolve: what is left for the residual must keep its sign, for steps short and long.
#[test]
fn extreme_many_modes_and_small_steps() {
    let model = model();
    for modes in [200, 1600] {
        for steps in [50, 20_000] {
            run(&model, &options(&model, modes, DAMPED, 1.0), &running(2000.0, steps), 5);
        }
    }
}
