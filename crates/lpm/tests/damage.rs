//! Damage-induced response over a rotation of 27 mesh cycles.

use lpm::{Curve, Excitation, GearPair, Input, LpmError, Model, Options, Sampling, State, SteadyOptions, Supports};

const CYCLES: usize = 27;

/// Healthy and damaged pair: constant stiffness, static transmission error raised by `depth` over cycle 14.
fn pair(depth: f64) -> Result<(Model, Model), LpmError> {
    let k = Curve::constant(700e6)?;
    let healthy = Curve::constant(14e-6)?;
    let bump = Curve::steps(1, &[(0.0, 14e-6 + depth)])?;
    let damaged = healthy.with_cycles_replaced(CYCLES, 14, &bump)?;
    let pair = GearPair::table_3_2(Input::Prescribed);
    let of = |d: &Curve| Model::new(&pair, &Excitation::new(&k, d)?, Supports::Rigid);
    Ok((of(&healthy)?, of(&damaged)?))
}

#[test]
fn analytic_linear_damage_response_is_the_step_response() -> Result<(), LpmError> {
    // Contact kept: the difference is the response of the oscillator to a box of height `depth`, one mesh cycle long.
    let depth = 2e-6;
    let (healthy, damaged) = pair(depth)?;
    let f = 900.0;
    let o = SteadyOptions { integration: Options::with_tolerance(1e-11), tolerance: 1e-11, ..Default::default() };
    let r = healthy.damage_response(&damaged, f, &State::default(), &Sampling::default(), &o)?;
    assert_eq!(r.difference.len(), CYCLES * 100);
    let osc = lpm::analytic::Oscillator {
        mass: healthy.pair().effective_mass(),
        damping: 3660.0,
        stiffness: 700e6,
        force: 700e6 * depth,
    };
    for (t, d) in r.healthy.response.mesh_cycle.iter().zip(&r.difference) {
        let step = |from: f64| {
            let dt = (t - from) / f;
            if dt > 0.0 { osc.after(dt, 0.0, 0.0).0 } else { 0.0 }
        };
        // What is left of the rotation before: decay over 13 cycles at 762 / s is 1.6e-5.
        let want = step(14.0) - step(15.0) + step(14.0 - 27.0) - step(15.0 - 27.0);
        assert!((d - want).abs() < 1e-8 * depth, "cycle {t}: {d:e} {want:e}");
    }
    assert!((r.static_peak_to_peak() / depth - 1.0).abs() < 1e-12);
    // One line per rotation.
    assert!((r.spectrum.frequency[1] - f / 27.0).abs() < 1e-9);
    Ok(())
}

#[test]
fn invariant_no_damage_gives_nothing_and_slow_speed_the_static_difference() -> Result<(), LpmError> {
    let (healthy, same) = pair(0.0)?;
    let go = |a: &Model, b: &Model, f: f64| {
        a.damage_response(b, f, &a.equilibrium(0.0), &Sampling::default(), &SteadyOptions::default())
    };
    assert!(go(&healthy, &same, 2400.0)?.peak_to_peak() < 1e-9 * 14e-6);
    // A smooth bump at 2 Hz mesh frequency follows the static curve.
    let k = Curve::constant(700e6)?;
    let d0 = Curve::constant(14e-6)?;
    let phases: Vec<f64> = (0..8).map(|i| f64::from(i) / 8.0).collect();
    let values: Vec<f64> = phases.iter().map(|t| 14e-6 + 3e-6 * (std::f64::consts::PI * t).sin().powi(4)).collect();
    let bump = Curve::table(1, &phases, &values, lpm::Interpolation::Linear)?;
    let pair = GearPair::table_3_2(Input::Prescribed);
    let damaged =
        Model::new(&pair, &Excitation::new(&k, &d0.with_cycles_replaced(CYCLES, 14, &bump)?)?, Supports::Eliminated)?;
    let healthy = Model::new(&pair, &Excitation::new(&k, &d0)?, Supports::Eliminated)?;
    let r = go(&healthy, &damaged, 2.0)?;
    for (d, s) in r.difference.iter().zip(&r.static_difference) {
        assert!((d - s).abs() < 0.01 * 3e-6);
    }
    assert!((r.peak_to_peak() / r.static_peak_to_peak() - 1.0).abs() < 0.01);
    // Periods that do not fit are refused.
    assert!(matches!(go(&damaged, &healthy, 900.0), Err(LpmError::Period { .. })));
    Ok(())
}
