//! Every integration ends: by an answer, by a refusal, or when asked to stop.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use lpm::{
    Curve, Excitation, GearPair, Input, LpmError, Method, Model, Options, STOP_STEPS, Sampling, SteadyOptions, Stop,
    Supports, SweepOptions,
};

fn model(mesh_damping: f64, supports: Supports) -> Result<Model, LpmError> {
    let pair = GearPair { mesh_damping, ..GearPair::table_3_2(Input::Prescribed) };
    let k = Curve::fourier(680e6, &[(-120e6, 30e6), (20e6, 15e6)])?;
    let delta = Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6), (-0.4e-6, 0.0)])?;
    Model::new(&pair, &Excitation::new(&k, &delta)?, supports)
}

/// Seconds are generous: tests run on busy machines.
const SOON: Duration = Duration::from_secs(120);

#[test]
fn extreme_slow_and_heavily_damped_pairs_answer_or_are_refused() -> Result<(), LpmError> {
    for (damping, supports) in [
        (0.0, Supports::Rigid),
        (3434.0, Supports::Eliminated),
        (3434.0, Supports::Integrated),
        (1e6, Supports::Rigid),
        (1e9, Supports::Eliminated),
        (1e9, Supports::Integrated),
        (1e12, Supports::Rigid),
    ] {
        let model = model(damping, supports)?;
        for frequency in [1e-6, 0.01, 1.0, 900.0, 1e6] {
            let clock = Instant::now();
            let options = SteadyOptions {
                // far below the default: the suite is run on slow machines too
                integration: Options { max_steps: 200_000, ..Options::with_tolerance(1e-6) },
                ..SteadyOptions::default()
            };
            let sampling = Sampling { per_cycle: 20, energy: false };
            let found = model.steady_response(frequency, &model.equilibrium(0.0), 4, &sampling, &options);
            let told = match &found {
                Ok(found) => {
                    assert!(found.response.transmission_error.iter().all(|x| x.is_finite()));
                    format!("steady {:?}", found.steady.multiple)
                }
                Err(error) => error.to_string(),
            };
            println!("{damping:e} N s/m, {supports:?}, {frequency} Hz: {told}; {:.2} s", clock.elapsed().as_secs_f64());
            assert!(clock.elapsed() < SOON, "{damping:e} N s/m, {supports:?}, {frequency} Hz: {told}");
            let refused = matches!(found, Err(LpmError::TooManySteps { .. } | LpmError::StepLimit { .. }));
            assert!(found.is_ok() || refused, "{damping:e} N s/m, {supports:?}, {frequency} Hz: {told}");
            assert!(frequency > 0.1 || refused, "{frequency} Hz: {told}");
        }
    }
    Ok(())
}

/// The slow creep under a heavy damper, closed form: a step of force `f` decays as `exp(-k t / c)`.
#[test]
fn analytic_heavily_damped_pair_creeps() -> Result<(), LpmError> {
    let (k, c) = (600e6, 1e9);
    let pair = GearPair { mesh_damping: c, ..GearPair::table_3_2(Input::Prescribed) };
    let model = Model::new(&pair, &Excitation::new(&Curve::constant(k)?, &Curve::constant(15e-6)?)?, Supports::Rigid)?;
    let mut start = model.equilibrium(0.0);
    start.position[0] += 1e-6;
    let response =
        model.simulate(900.0, &start, 900, &Sampling { per_cycle: 4, energy: false }, &Options::default())?;
    for (cycle, x) in response.mesh_cycle.iter().zip(&response.transmission_error) {
        let expected = 15e-6 + 1e-6 * (-k / c * cycle / 900.0).exp();
        assert!((x - expected).abs() < 1e-9 * 1e-6 + 1e-13, "cycle {cycle}: {x} against {expected}");
    }
    // an eighth of the mesh mode's period is the only limit on the step
    assert!(response.stats.steps < 40 * 900, "{:?}", response.stats);
    Ok(())
}

#[test]
fn every_analysis_stops_soon_after_it_is_asked() -> Result<(), LpmError> {
    let model = model(3434.0, Supports::Eliminated)?;
    let rest = model.equilibrium(0.0);
    for allowed in [0, 3, 40] {
        let asked = AtomicU64::new(0);
        let stop = || asked.fetch_add(1, Ordering::Relaxed) >= allowed;
        let integration =
            Options { method: Some(Method::Esdirk), stop: Stop::when(&stop), ..Options::with_tolerance(1e-10) };
        let steady = SteadyOptions { integration, ..SteadyOptions::default() };
        let sampling = Sampling::default();
        let mut ends = vec![model.simulate(900.0, &rest, 100_000, &sampling, &integration).map(|_| ())];
        ends.push(model.sweep(&[900.0; 500], &SweepOptions { steady, ..SweepOptions::default() }).map(|_| ()));
        let range = lpm::ContinuationOptions { from: 300.0, to: 3000.0, integration, ..Default::default() };
        ends.push(model.continuation(3000.0, &rest, &range).map(|_| ()));
        for end in ends {
            assert!(matches!(end, Err(LpmError::Stopped { .. })), "{end:?}");
        }
        // once in so many steps, and not again once it was answered, but for each of the analyses
        assert!(asked.load(Ordering::Relaxed) <= allowed + 3, "{STOP_STEPS}");
    }
    Ok(())
}
