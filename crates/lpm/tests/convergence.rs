//! Fitted convergence orders of every method, smooth and with contact loss, and energy balance.

use lpm::{
    Curve, Excitation, GearPair, Input, Interpolation, LpmError, Method, Model, Options, Sampling, State, StepControl,
    Supports,
};

/// Smooth excitation near the dissertation's pair.
fn smooth() -> Result<Excitation, LpmError> {
    let k = Curve::fourier(680e6, &[(-120e6, 30e6), (20e6, 15e6)])?;
    let d = Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6), (-0.4e-6, 0.0)])?;
    Excitation::new(&k, &d)
}

/// Linear tables: kinks at every point.
fn kinked() -> Result<Excitation, LpmError> {
    let k: Vec<f64> = (0..8).map(|i| if i < 3 { 534e6 } else { 824e6 - 5e6 * f64::from(i) }).collect();
    let d: Vec<f64> = (0..8).map(|i| if i < 3 { 18.3e-6 } else { 11.8e-6 }).collect();
    Excitation::new(&Curve::samples(1, &k, Interpolation::Linear)?, &Curve::samples(1, &d, Interpolation::Linear)?)
}

fn end(model: &Model, f: f64, x0: f64, method: Method, per_cycle: f64) -> Result<[f64; 2], LpmError> {
    let o = Options { method: Some(method), step: StepControl::Fixed { per_cycle }, ..Options::default() };
    let s = State { position: [x0, 0.0, 0.0], ..State::default() };
    let r = model.simulate(f, &s, 3, &Sampling { per_cycle: 4, energy: false }, &o)?;
    Ok([r.end.position[0], r.end.velocity[0] / 17e3])
}

/// Least-squares slope of log error against log steps over the ladder.
fn fitted(ladder: &[f64], error: &[f64]) -> f64 {
    let (x, y): (Vec<f64>, Vec<f64>) = ladder.iter().zip(error).map(|(n, e)| (n.ln(), e.ln())).unzip();
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let (mut xy, mut xx) = (0.0, 0.0);
    for (a, b) in x.iter().zip(&y) {
        xy += (a - mx) * (b - my);
        xx += (a - mx) * (a - mx);
    }
    -xy / xx
}

fn orders(excitation: &Excitation, x0: f64, must_separate: bool) -> Result<(), LpmError> {
    let f = 1800.0;
    let pair = GearPair { mesh_damping: 3434.0, ..GearPair::table_3_2(Input::Prescribed) };
    let model = Model::new(&pair, excitation, Supports::Rigid)?;
    let reference = end(&model, f, x0, Method::Magnus, 4096.0)?;
    let check = model.simulate(
        f,
        &State { position: [x0, 0.0, 0.0], ..State::default() },
        3,
        &Sampling::default(),
        &Options::default(),
    )?;
    assert_eq!(!check.separations.is_empty(), must_separate);
    for (method, order, ladder) in [
        (Method::Magnus, 6.0, [8.0, 16.0, 32.0, 64.0]),
        (Method::DormandPrince, 5.0, [64.0, 128.0, 256.0, 512.0]),
        (Method::Esdirk, 4.0, [64.0, 128.0, 256.0, 512.0]),
        (Method::Newmark, 2.0, [256.0, 512.0, 1024.0, 2048.0]),
    ] {
        let errors: Vec<f64> = ladder
            .iter()
            .map(|&n| {
                let e = end(&model, f, x0, method, n)?;
                Ok((e[0] - reference[0]).hypot(e[1] - reference[1]))
            })
            .collect::<Result<_, LpmError>>()?;
        let slope = fitted(&ladder, &errors);
        // Pre-asymptotic curvature and moving events allow some slack; a lost order would show as a deficit of one.
        assert!(slope > order - 0.5, "{} has order {slope:.2}: {errors:?}", method.name());
        assert!(errors[3] < 1e-3 * errors[0] || order < 5.0, "{}: {errors:?}", method.name());
    }
    Ok(())
}

#[test]
fn order_smooth_excitation_without_separation() -> Result<(), LpmError> {
    orders(&smooth()?, 15e-6, false)
}

#[test]
fn order_kept_across_contact_loss() -> Result<(), LpmError> {
    orders(&smooth()?, 55e-6, true)
}

#[test]
fn order_kept_across_kinks_of_tables() -> Result<(), LpmError> {
    orders(&kinked()?, 15e-6, false)
}

#[test]
fn invariant_tolerance_controls_the_error() -> Result<(), LpmError> {
    let pair = GearPair { mesh_damping: 3434.0, ..GearPair::table_3_2(Input::Prescribed) };
    let model = Model::new(&pair, &smooth()?, Supports::Rigid)?;
    let reference = end(&model, 900.0, 55e-6, Method::Magnus, 4096.0)?;
    for method in Method::ALL {
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let o = Options { method: Some(method), ..Options::with_tolerance(tolerance) };
            let s = State { position: [55e-6, 0.0, 0.0], ..State::default() };
            let r = model.simulate(900.0, &s, 3, &Sampling::default(), &o)?;
            let error = (r.end.position[0] - reference[0]).abs() / 18e-6;
            // The tolerance holds per step; errors of a damped system can at worst add up.
            let bound = r.stats.steps as f64 * tolerance;
            assert!(error < bound, "{} at {tolerance:e}: {error:e} of {bound:e}", method.name());
        }
    }
    Ok(())
}

#[test]
fn invariant_energy_balance_with_contact_loss() -> Result<(), LpmError> {
    for (supports, method, limit) in [
        (Supports::Rigid, Method::Magnus, 1e-9),
        (Supports::Rigid, Method::DormandPrince, 1e-9),
        (Supports::Integrated, Method::DormandPrince, 1e-9),
        (Supports::Integrated, Method::Esdirk, 1e-8),
    ] {
        let mut pair = GearPair { mesh_damping: 1500.0, ..GearPair::table_3_2(Input::Free) };
        (pair.pinion.support_stiffness, pair.gear.support_stiffness) = (2e8, 3e8);
        let model = Model::new(&pair, &smooth()?, supports)?;
        let o = Options { method: Some(method), ..Options::with_tolerance(1e-11) };
        let s = State { position: [70e-6, 0.0, 0.0], ..State::default() };
        let r = model.simulate(2500.0, &s, 10, &Sampling { per_cycle: 50, energy: true }, &o)?;
        assert!(!r.separations.is_empty());
        let e = r.energy.unwrap_or_default();
        assert!(e.turnover > 0.0 && e.dissipated > 0.0);
        assert!(e.residual.abs() < limit * e.turnover, "{supports:?} {}: {e:?}", method.name());
    }
    Ok(())
}

#[test]
fn invariant_narrow_features_of_a_curve_are_not_stepped_over() -> Result<(), LpmError> {
    // A dip of stiffness over 3 of 40 points; at high speed an eighth of the natural period is half a cycle, and the nodes
    // of such a step can all lie on the plateau.
    let pair = GearPair::table_3_2(Input::Prescribed);
    for at in [3usize, 11, 18, 29] {
        let value = |i: usize| if i.abs_diff(at) <= 1 { 400e6 } else { 800e6 };
        let k: Vec<f64> = (0..40).map(value).collect();
        let e = Excitation::new(&Curve::samples(1, &k, Interpolation::Spline)?, &Curve::constant(14e-6)?)?;
        let model = Model::new(&pair, &e, Supports::Rigid)?;
        for f in [3750.0, 12_000.0] {
            for method in [Method::Magnus, Method::DormandPrince, Method::Esdirk] {
                let start = State { position: [18e-6, 0.0, 0.0], ..State::default() };
                let run = |step| {
                    let o = Options { method: Some(method), step, ..Options::default() };
                    model.simulate(f, &start, 3, &Sampling::default(), &o)
                };
                let fine = run(StepControl::Fixed { per_cycle: 2000.0 })?;
                let r = run(StepControl::Adaptive { tolerance: 1e-8 })?;
                let error = (r.end.position[0] - fine.end.position[0]).abs() / 18e-6;
                let bound = r.stats.steps as f64 * 1e-8;
                assert!(error < bound, "{} at {f} Hz, dip at {at}: {error:e} of {bound:e}", method.name());
            }
        }
    }
    Ok(())
}
