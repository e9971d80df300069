//! Motion in time against statics, closed forms, invariants, and itself at other steps.

mod common;

use common::{TORQUE, gear, pair};
use fecm::dynamics::{
    Damping, DynamicsOptions, DynamicsRequest, DynamicsRun, DynamicsState, ImpulseSpec, InitialState, Integrator,
    Motion, PairDynamics, RotorInertia, RotorOptions, SteadySpec, StepSolver, Support,
};
use fecm::statics::{PairModel, PairModelOptions, StaticsRequest};
use fecm::{FaceModel, FecmError};
use gear_geom::{Damage, GearPair, Member, Pit, ProfileMeasure, ToothDamage};

const UNDAMPED: Damping = Damping { mass_proportional: 0.0, stiffness_proportional: 0.0, modal_ratio: 0.0 };
const DAMPED: Damping = Damping { mass_proportional: 1500.0, ..UNDAMPED };
const RPM: f64 = std::f64::consts::PI / 30.0;

fn plane(cells_per_half_width: f64) -> PairModelOptions {
    let mut options = PairModelOptions { face: FaceModel::PlaneStress, ..PairModelOptions::default() };
    options.contact.cells_per_half_width = cells_per_half_width;
    options
}

fn model() -> PairModel {
    PairModel::new(&pair(25, 31), &plane(4.0)).unwrap()
}

fn rotor(rotation: Support) -> RotorOptions {
    RotorOptions::on_ideal_bearings(RotorInertia { mass: 2.0, polar: 0.006, transverse: 0.004 }, rotation)
}

fn options(damping: Damping) -> DynamicsOptions {
    DynamicsOptions::new([rotor(Support::Fixed), rotor(Support::Free)], damping)
}

fn running(rpm: f64, steps_per_cycle: usize) -> DynamicsRequest {
    DynamicsRequest::running(rpm * RPM, steps_per_cycle, TORQUE)
}

fn run(model: &PairModel, options: &DynamicsOptions, request: &DynamicsRequest, steps: usize) -> DynamicsRun {
    let run = PairDynamics::new(model, options).unwrap().run(request, steps, &()).unwrap();
    assert_eq!(run.stats.not_converged, 0);
    assert!(run.stats.worst_kkt < 1e-10 && run.stats.worst_complementarity < 1e-10, "{:?}", run.stats);
    run
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(s, n), x| (s + x * x, n + 1.0));
    (sum / count).sqrt()
}

#[test]
fn invariant_slow_motion_is_the_static_answer() {
    let model = model();
    let steps = 40;
    let request = StaticsRequest::one_cycle(steps, TORQUE);
    let still = model.solve(&request, &()).unwrap().results.remove(0);
    for integrator in [Integrator::AverageAcceleration, Integrator::GeneralizedAlpha { spectral_radius: 0.5 }] {
        let options = DynamicsOptions { integrator, ..options(DAMPED) };
        let slow = run(&model, &options, &running(0.01, steps as usize), 2 * steps as usize);
        // step 1 ends at the second position
        for (record, position) in slow.records.iter().zip(still.iter().cycle().skip(1)) {
            let static_error = position.static_transmission_error;
            let miss = (record.transmission_error - static_error).abs();
            assert!(miss < 1e-6 * static_error, "{integrator:?} at {}: {miss:.2e}", record.mesh_cycle);
            let force: f64 = position.pairs.iter().map(|pair| pair.force).sum();
            assert!((record.mesh_force / force - 1.0).abs() < 1e-5, "{} {force}", record.mesh_force);
        }
    }
}

/// The pair standing still, displaced by little: teeth stay in contact, the contact's stiffness hardly changes.
fn free_vibration(
    model: &PairModel,
    options: &DynamicsOptions,
    steps_per_period: f64,
    periods: f64,
    kick: f64,
) -> (DynamicsRun, f64) {
    let frequency = frequency_of(model, options);
    let mut request = running(1000.0, 50);
    request.motion = Motion::Standing { time_step: 1.0 / frequency / steps_per_period };
    let dynamics = PairDynamics::new(model, options).unwrap();
    let rest = dynamics.start(&request).unwrap().state().clone();
    let mut moved = rest;
    moved.velocity[0] = kick;
    request.initial = InitialState::Given(moved);
    let run = dynamics.run(&request, (steps_per_period * periods).round() as usize, &()).unwrap();
    (run, frequency)
}

fn frequency_of(model: &PairModel, options: &DynamicsOptions) -> f64 {
    let request = StaticsRequest::new([0.0], [TORQUE]);
    let stiffness = model.solve(&request, &()).unwrap().results[0][0].stiffness_local_slope.unwrap();
    let radius = model.pairing().base_radius(1);
    (stiffness * radius * radius / options.rotors[1].inertia.polar).sqrt() / (2.0 * std::f64::consts::PI)
}

#[test]
fn order_two_of_the_period() {
    // (omega h)^2 / 12 longer than it should be
    let model = model();
    let options = options(UNDAMPED);
    let crossings = |steps: f64| {
        let (run, frequency) = free_vibration(&model, &options, steps, 10.5, 1e-9);
        let values = run.transmission_errors();
        let mean =
            0.5 * (values.iter().fold(f64::MAX, |m, x| m.min(*x)) + values.iter().fold(f64::MIN, |m, x| m.max(*x)));
        let times: Vec<f64> = (values.windows(2).enumerate())
            .filter(|(_, w)| w[0] < mean && w[1] >= mean)
            .map(|(k, w)| (k as f64 + (mean - w[0]) / (w[1] - w[0])) * run.time_step)
            .collect();
        (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64 * frequency
    };
    for steps in [20.0, 40.0, 80.0] {
        let phase = 2.0 * std::f64::consts::PI / steps;
        let exact = 0.5 * phase / (0.5 * phase).atan();
        assert!((crossings(steps) / exact - 1.0).abs() < 3e-3 * phase * phase + 1e-5, "{steps}: {}", crossings(steps));
    }
}

/// Second order as long as teeth touch. Where they part and meet again, the step in which that happens is not resolved: something between first and
/// second order is left.
#[test]
fn order_in_time_with_and_without_loss_of_contact() {
    let model = model();
    let dynamics = PairDynamics::new(&model, &options(DAMPED)).unwrap();
    let cycles = 3;
    let finest = 800;
    for (kick, parts, orders) in [(0.1, false, 1.7..2.4), (3.0, true, 0.9..2.3)] {
        let mut state = dynamics.start(&running(2000.0, 50)).unwrap().state().clone();
        state.velocity[0] = kick;
        let motion = |steps: usize| {
            let request = DynamicsRequest { initial: InitialState::Given(state.clone()), ..running(2000.0, steps) };
            dynamics.run(&request, cycles * steps, &()).unwrap()
        };
        let reference = motion(finest);
        assert_eq!(reference.records.iter().any(|r| r.mesh_force == 0.0), parts);
        let fine = reference.transmission_errors();
        let mean = fine.iter().sum::<f64>() / fine.len() as f64;
        let swing = rms(fine.iter().map(|x| x - mean));
        let errors: Vec<f64> = [25, 50, 100, 200]
            .iter()
            .map(|&steps| {
                let every = finest / steps;
                let coarse = motion(steps).transmission_errors();
                rms(coarse.iter().zip(fine.iter().skip(every - 1).step_by(every)).map(|(a, b)| a - b)) / swing
            })
            .collect();
        let order = (errors[0] / errors[3]).log2() / 3.0;
        assert!(errors[3] < 0.03 && orders.contains(&order), "loss {parts}: order {order} of {errors:?}");
    }
}

#[test]
fn invariant_energy_of_bodies_and_work_balance_to_rounding() {
    let model = model();
    for rpm in [500.0, 3000.0, 6000.0] {
        let run = run(&model, &options(UNDAMPED), &running(rpm, 50), 50 * 20);
        let relative = run.energy.worst_residual / run.energy.scale;
        assert!(relative < 1e-9, "{rpm} rpm: {relative:.2e}");
        assert_eq!(run.energy.dissipated, 0.0);
    }
}

#[test]
fn invariant_whole_energy_does_not_drift_without_damping() {
    let model = model();
    let options = options(UNDAMPED);
    // 1000 natural periods: within contact, and hard enough that teeth part and meet again in every one
    for (kick, parts) in [(1e-2, false), (6.0, true)] {
        let frequency = frequency_of(&model, &options);
        let mut request = running(1000.0, 50);
        request.motion = Motion::Standing { time_step: 1.0 / frequency / 100.0 };
        let dynamics = PairDynamics::new(&model, &options).unwrap();
        let mut state = dynamics.start(&request).unwrap().state().clone();
        state.velocity[0] = kick;
        request.initial = InitialState::Given(state);
        let mut runner = dynamics.start(&request).unwrap();
        let torque_energy = |e: f64, te: f64| e - TORQUE / model.pairing().base_radius(1) * te;
        let start = torque_energy(runner.stored_energy().unwrap(), runner.transmission_error());
        let swing = 0.5 * options.rotors[1].inertia.polar * kick * kick;
        let mut worst = 0.0_f64;
        let mut lost = false;
        for _ in 0..20 {
            let run = runner.advance(5000, &()).unwrap();
            lost |= run.records.iter().any(|r| r.mesh_force == 0.0);
            let now = torque_energy(runner.stored_energy().unwrap(), runner.transmission_error());
            worst = worst.max(((now - start) / swing).abs());
        }
        assert_eq!(lost, parts);
        assert!(worst < if parts { 2e-2 } else { 2e-3 }, "kick {kick}: {worst:.2e}");
    }
}

#[test]
fn both_step_solvers_agree() {
    let model = model();
    let newton = run(&model, &options(DAMPED), &running(5000.0, 50), 200);
    let lemke =
        run(&model, &DynamicsOptions { solver: StepSolver::Lemke, ..options(DAMPED) }, &running(5000.0, 50), 200);
    for (a, b) in newton.records.iter().zip(&lemke.records) {
        assert!((a.transmission_error - b.transmission_error).abs() < 1e-9 * 1e-5, "step {}", a.step);
        assert!((a.mesh_force - b.mesh_force).abs() < 1e-7 * TORQUE / 0.08);
    }
}

#[test]
fn steady_motion_forgets_how_it_began() {
    let model = model();
    let options = options(DAMPED);
    let dynamics = PairDynamics::new(&model, &options).unwrap();
    let spec = SteadySpec { period: 50, tolerance: 1e-10, most_periods: 400 };
    let settle = |initial: InitialState| {
        let request = DynamicsRequest { initial, ..running(3000.0, 50) };
        let (run, change) = dynamics.start(&request).unwrap().settle(&spec, &()).unwrap();
        assert!(change < spec.tolerance);
        run.transmission_errors()
    };
    let reference = settle(InitialState::Equilibrium);
    let wrong = DynamicsState {
        step: 0,
        position: vec![-2e-4],
        velocity: vec![0.3],
        acceleration: vec![-50.0],
        contact: vec![10.0],
    };
    for initial in [InitialState::Unloaded, InitialState::Given(wrong)] {
        let other = settle(initial);
        let miss = rms(reference.iter().zip(&other).map(|(a, b)| a - b));
        assert!(miss < 1e-8 * rms(reference.iter().copied()), "{miss:.2e}");
    }
}

#[test]
fn pieces_of_a_run_are_the_run() {
    let model = model();
    let options = options(DAMPED);
    let dynamics = PairDynamics::new(&model, &options).unwrap();
    let whole = dynamics.run(&running(3000.0, 50), 230, &()).unwrap();
    let mut first = dynamics.start(&running(3000.0, 50)).unwrap();
    let mut records = first.advance(97, &()).unwrap().records;
    // resumed from the state alone, by another runner
    let request = DynamicsRequest { initial: InitialState::Given(first.state().clone()), ..running(3000.0, 50) };
    records.extend(dynamics.run(&request, 133, &()).unwrap().records);
    assert_eq!(records, whole.records);
}

#[test]
fn invariant_threads_give_the_same_bits() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&model(), &options(DAMPED), &running(4000.0, 37), 200).records)
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn coast_flanks_carry_a_load_that_reverses() {
    // started far open, the wheel flies across the backlash and is thrown back by the coast flanks
    let model = model();
    let options = options(UNDAMPED);
    let mut request = running(100.0, 2000);
    request.torque = 1.0;
    let dynamics = PairDynamics::new(&model, &options).unwrap();
    let mut state = dynamics.start(&request).unwrap().state().clone();
    state.velocity[0] = -2.0 * model.pairing().pair().closing_direction();
    request.initial = InitialState::Given(state);
    let run = dynamics.run(&request, 1200, &()).unwrap();
    let least = run.transmission_errors().into_iter().fold(f64::INFINITY, f64::min);
    let backlash = model.pairing().pair().normal_backlash();
    let hit = run.records.iter().map(|r| r.back_force).fold(0.0, f64::max);
    assert!(hit > 100.0, "no blow on the coast flanks: {hit} N, farthest {least:.3e} of {backlash:.3e} m");
    assert!(least < -0.95 * backlash && least > -1.6 * backlash, "{least:.3e} of {backlash:.3e}");
    let first_hit = run.records.iter().find(|r| r.back_force > 0.0).unwrap();
    assert!(
        (first_hit.transmission_error / -backlash - 1.0).abs() < 0.05,
        "met at {:.3e}",
        first_hit.transmission_error
    );
    assert!(run.records.iter().all(|r| r.mesh_force == 0.0 || r.back_force == 0.0), "one side at a time");
    // it comes back
    assert!(run.records.last().unwrap().transmission_error > least + 0.5 * backlash);
}

#[test]
fn a_blow_without_damping_lasts_as_the_oscillator_says() {
    // one linear oscillator of the tangent stiffness: half a period of contact, crest at v / omega
    let model = model();
    let options = options(UNDAMPED);
    let (run, frequency) = free_vibration(&model, &options, 200.0, 1.0, 1e-6);
    let radius = model.pairing().base_radius(1);
    let rest = run.records.last().unwrap().transmission_error;
    let crest = run.transmission_errors().into_iter().fold(f64::MIN, f64::max) - rest;
    let exact = radius * 1e-6 / (2.0 * std::f64::consts::PI * frequency);
    assert!((crest / exact - 1.0).abs() < 2e-3, "{crest:.4e} {exact:.4e}");
}

#[test]
fn impulse_test_reads_the_oscillator() {
    let model = model();
    let alpha = 2.0 * 0.04 * 2.0 * std::f64::consts::PI * frequency_of(&model, &options(UNDAMPED));
    let options = options(Damping { mass_proportional: alpha, ..UNDAMPED });
    let dynamics = PairDynamics::new(&model, &options).unwrap();
    let spec = ImpulseSpec { mesh_cycle: 0.0, torque: TORQUE, pulse: 0.05, periods: 40 };
    let reading = dynamics.impulse_test(&spec, &()).unwrap().unwrap();
    let frequency = frequency_of(&model, &options);
    assert!((reading.natural_frequency / frequency - 1.0).abs() < 5e-3, "{} {frequency}", reading.natural_frequency);
    assert!((reading.damping_log_decrement / 0.04 - 1.0).abs() < 0.03, "{}", reading.damping_log_decrement);
    assert!((reading.damping_half_power / 0.04 - 1.0).abs() < 0.05, "{}", reading.damping_half_power);
    assert!((reading.peak_frequency / frequency - 1.0).abs() < 0.01);
}

#[test]
fn stiff_bearings_are_ideal_bearings() {
    let model = model();
    let on = |stiffness: f64| {
        let mut options = options(DAMPED);
        for rotor in &mut options.rotors {
            for axis in 0..2 {
                rotor.supports[axis] = Support::Elastic { stiffness, damping: 800.0 };
            }
        }
        run(&model, &options, &running(4000.0, 50), 500)
    };
    let ideal = run(&model, &options(DAMPED), &running(4000.0, 50), 500).transmission_errors();
    let scale = rms(ideal.iter().copied());
    let miss = |run: &DynamicsRun| rms(run.transmission_errors().iter().zip(&ideal).map(|(a, b)| a - b)) / scale;
    let [soft, stiff, rigid] = [1e9, 1e12, 1e15].map(on);
    assert!(miss(&stiff) < 2e-3 && miss(&rigid) < 2e-6, "{} {}", miss(&stiff), miss(&rigid));
    assert!(miss(&soft) > 10.0 * miss(&stiff), "bearings of 1e9 N/m are felt");
    // the bearings carry the mesh force, on the mean of a mesh cycle: average acceleration lets a bearing ring that is too stiff for the step
    let last = &stiff.records[stiff.records.len() - 50..];
    let force = last.iter().map(|r| r.mesh_force).sum::<f64>() / 50.0;
    for body in 0..2 {
        let mean = |axis: usize| {
            let row = stiff.coordinates.iter().position(|&c| c == (body, axis)).unwrap();
            last.iter().map(|r| r.support_forces[row]).sum::<f64>() / 50.0
        };
        let carried = mean(0).hypot(mean(1));
        assert!((carried / force - 1.0).abs() < 1e-3, "{carried} {force}");
    }
}

/// A bearing of 1e12 N/m swings far faster than a step: average acceleration turns its force over from step to step, generalised alpha damps that. What
/// the gears do stays. A bearing that stiff should carry the mesh force of the step as it is.
#[test]
fn generalised_alpha_quiets_stiff_bearings() {
    let model = model();
    let on = |integrator: Integrator| {
        let mut options = DynamicsOptions { integrator, ..options(DAMPED) };
        for axis in 0..2 {
            options.rotors[1].supports[axis] = Support::Elastic { stiffness: 1e12, damping: 0.0 };
        }
        let request = DynamicsRequest { initial: InitialState::Unloaded, ..running(4000.0, 50) };
        let run = run(&model, &options, &request, 1000);
        let [x, y] = [0, 1].map(|axis| run.coordinates.iter().position(|&c| c == (1, axis)).unwrap());
        let last = &run.records[run.records.len() - 50..];
        let carried: Vec<f64> = last.iter().map(|r| r.support_forces[x].hypot(r.support_forces[y])).collect();
        let mean = last.iter().map(|r| r.mesh_force).sum::<f64>() / 50.0;
        let rings = rms(carried.iter().zip(last).map(|(force, r)| force - r.mesh_force)) / mean;
        let bias = [x, y].map(|row| last.iter().map(|r| r.support_forces[row]).sum::<f64>() / 50.0);
        (rings, bias[0].hypot(bias[1]) / mean - 1.0, last.iter().map(|r| r.transmission_error).collect::<Vec<f64>>())
    };
    let (rings, bias, error) = on(Integrator::AverageAcceleration);
    let (quiet, other_bias, other_error) = on(Integrator::GeneralizedAlpha { spectral_radius: 0.8 });
    let centre = error.iter().sum::<f64>() / 50.0;
    let moved = rms(error.iter().zip(&other_error).map(|(a, b)| a - b)) / rms(error.iter().map(|x| x - centre));
    assert!(rings > 0.03 && quiet < 0.3 * rings, "{rings} {quiet}");
    assert!(bias.abs() < 0.01 && other_bias.abs() < 1e-3 && moved < 0.02, "{bias} {other_bias} {moved}");
}

#[test]
fn pitted_tooth_disturbs_once_a_rotation_only() {
    let mut options3 = PairModelOptions { face: FaceModel::Solid { order: 2 }, ..PairModelOptions::default() };
    options3.contact.cells_per_half_width = 3.0;
    options3.contact.face_cells = 8;
    let pair = pair(25, 31);
    let pitch = pair.landmarks(Member::Pinion).pitch.roll_distance;
    let pit = Pit::ellipse(0.0, pitch, 12e-3, 5e-3, ProfileMeasure::RollDistance);
    let damage = ToothDamage { tooth: 25 - 12, damage: Damage::Pit(pit) };
    let healthy = PairModel::new(&pair, &options3).unwrap();
    let pitted = healthy.with_damage(&[vec![damage], Vec::new()]).unwrap();
    let dynamics = PairDynamics::new(&pitted, &options(DAMPED)).unwrap();
    assert_eq!(dynamics.period(), 25);
    let damaged = dynamics.run(&running(3000.0, 20), 20 * 75, &()).unwrap();
    let sound = run(&healthy, &options(DAMPED), &running(3000.0, 20), 20 * 75);
    let difference: Vec<f64> =
        damaged.records.iter().zip(&sound.records).map(|(a, b)| a.transmission_error - b.transmission_error).collect();
    // pair 12 has pinion tooth -12 = 13; nothing before it comes into mesh, and the same again a rotation later
    let before = difference[..20 * 10].iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    let largest = difference.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    assert!(before < 1e-12 && largest > 1e-7, "{before:.2e} {largest:.2e}");
    // by the second rotation the start has died away
    for k in 20 * 36..20 * 50 {
        let again = (difference[k] - difference[k + 20 * 25]).abs();
        assert!(again < 1e-5 * largest, "step {k}: {again:.2e} of {largest:.2e}");
    }
}

#[test]
fn extreme_speeds_and_steps() {
    let model = model();
    for (rpm, steps_per_cycle) in [(1.0, 10), (60_000.0, 10), (1.0, 1000), (60_000.0, 1000), (3000.0, 4)] {
        let run = run(&model, &options(DAMPED), &running(rpm, steps_per_cycle), 3 * steps_per_cycle);
        assert!(run.records.iter().all(|r| r.transmission_error.is_finite() && r.mesh_force.is_finite()));
    }
}

#[test]
fn bad_requests_are_explained() {
    let model = model();
    let error = |options: &DynamicsOptions, request: &DynamicsRequest| -> FecmError {
        match PairDynamics::new(&model, options) {
            Err(error) => error,
            Ok(dynamics) => dynamics.run(request, 10, &()).unwrap_err(),
        }
    };
    let fine = options(DAMPED);
    let says = |error: FecmError, what: &str| assert!(error.to_string().contains(what), "{error}");
    says(error(&fine, &running(0.0, 50)), "speed");
    says(error(&fine, &running(1000.0, 1)), "steps per mesh cycle");
    says(error(&fine, &DynamicsRequest { torque: -1.0, ..running(1000.0, 50) }), "torque");
    says(error(&fine, &DynamicsRequest { torque: 1e9, ..running(1000.0, 50) }), "no static equilibrium");
    let state = DynamicsState { step: 0, position: vec![], velocity: vec![], acceleration: vec![], contact: vec![] };
    let request = DynamicsRequest { initial: InitialState::Given(state), ..running(1000.0, 50) };
    says(error(&fine, &request), "state given");
    let massless = DynamicsOptions {
        rotors: [
            rotor(Support::Fixed),
            RotorOptions { inertia: RotorInertia { mass: 1.0, polar: 0.0, transverse: 1.0 }, ..rotor(Support::Free) },
        ],
        ..fine.clone()
    };
    says(error(&massless, &running(1000.0, 50)), "polar inertia");
    let radius = DynamicsOptions { integrator: Integrator::GeneralizedAlpha { spectral_radius: 2.0 }, ..fine };
    says(error(&radius, &running(1000.0, 50)), "spectral radius");
}

#[test]
fn zero_backlash_touches_on_both_sides() {
    let exact = |teeth| {
        let module = 6e-3;
        let spec = gear(teeth).spec().clone().with(|spec| {
            spec.thickness = gear_geom::ToothThickness::AtReference(0.5 * std::f64::consts::PI * module);
        });
        gear_geom::Gear::new(&spec).unwrap()
    };
    let pair = GearPair::new(exact(25), exact(31), 168e-3).unwrap();
    let model = PairModel::new(&pair, &plane(4.0)).unwrap();
    // under load the coast flanks are open by the deflection; thrown back, they meet where the drive flanks let go
    let options = options(UNDAMPED);
    let dynamics = PairDynamics::new(&model, &options).unwrap();
    let mut request = running(1000.0, 500);
    let mut state = dynamics.start(&request).unwrap().state().clone();
    state.velocity[0] = -4.0 * model.pairing().pair().closing_direction();
    request.initial = InitialState::Given(state);
    let run = dynamics.run(&request, 200, &()).unwrap();
    let first = run.records.iter().find(|r| r.back_force > 0.0).unwrap();
    assert!(first.transmission_error.abs() < 5e-6, "{:.3e}", first.transmission_error);
    assert!(run.records.iter().all(|r| r.mesh_force > 0.0 || r.back_force > 0.0 || r.transmission_error.abs() < 5e-6));
}
