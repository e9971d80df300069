//! Elastic supports: implicit integration, explicit integration that resolves everything, and elimination agree.

use lpm::{
    Curve, Excitation, GearPair, Input, LpmError, Method, Model, Options, Response, Sampling, SteadyOptions, Supports,
    elimination_error,
};

fn excitation() -> Result<Excitation, LpmError> {
    let k = Curve::fourier(680e6, &[(-120e6, 30e6), (20e6, 15e6)])?;
    let d = Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6), (-0.4e-6, 0.0)])?;
    Excitation::new(&k, &d)
}

fn run(
    stiffness: f64,
    mesh_damping: f64,
    supports: Supports,
    method: Method,
    tolerance: f64,
) -> Result<Response, LpmError> {
    let mut pair = GearPair { mesh_damping, ..GearPair::table_3_2(Input::Prescribed) };
    (pair.pinion.support_stiffness, pair.gear.support_stiffness) = (stiffness, stiffness);
    let model = Model::new(&pair, &excitation()?, supports)?;
    let o = Options { method: Some(method), ..Options::with_tolerance(tolerance) };
    model.simulate(1800.0, &model.equilibrium(0.0), 8, &Sampling { per_cycle: 50, energy: false }, &o)
}

fn largest_difference(a: &Response, b: &Response) -> f64 {
    let scale = b.peak_to_peak();
    a.transmission_error.iter().zip(&b.transmission_error).map(|(x, y)| (x - y).abs() / scale).fold(0.0, f64::max)
}

#[test]
fn invariant_implicit_agrees_with_resolved_explicit_at_every_stiffness() -> Result<(), LpmError> {
    for (stiffness, limit) in [(1e8, 1e-6), (1e10, 1e-6), (1e12, 1e-5)] {
        let resolved = run(stiffness, 3434.0, Supports::Integrated, Method::DormandPrince, 1e-9)?;
        let implicit = run(stiffness, 3434.0, Supports::Integrated, Method::Esdirk, 1e-9)?;
        let d = largest_difference(&implicit, &resolved);
        assert!(d < limit, "{stiffness:e} N/m: {d:e}");
    }
    Ok(())
}

#[test]
fn order_elimination_error_falls_with_support_stiffness() -> Result<(), LpmError> {
    // Neglected with a mesh damper: its lag behind the give of the support, first order in k/k_s. Without: support
    // inertia, second order.
    for (damping, order, ladder) in
        [(3434.0, 1.0, [1e10, 1e11, 1e12, 1e13, 1e14]), (0.0, 2.0, [1e10, 3e10, 1e11, 3e11, 1e12])]
    {
        let mut errors = Vec::new();
        for stiffness in ladder {
            let full = run(stiffness, damping, Supports::Integrated, Method::Esdirk, 1e-11)?;
            let one = run(stiffness, damping, Supports::Eliminated, Method::Magnus, 1e-11)?;
            errors.push(largest_difference(&one, &full));
            // Bearing forces of massless supports are the mesh force.
            for (b, f) in one.gear_bearing_force.iter().zip(&one.mesh_force) {
                assert!((b - f).abs() < 1e-9 * full.mean_force);
            }
        }
        println!("mesh damping {damping}: eliminated against integrated, fraction of peak to peak: {errors:?}");
        let decades = (ladder[3] / ladder[0]).log10();
        let slope = (errors[0] / errors[3]).log10() / decades;
        assert!((slope - order).abs() < 0.3, "damping {damping}: order {slope}: {errors:?}");
        assert!(damping == 0.0 || errors[2] < 1e-4, "at 1e12 N/m: {errors:?}");
    }
    Ok(())
}

/// The estimate against both models' steady responses: realistic bearings (1e9 N/m) to rigid ones, below and near the resonance. At 1e9 N/m
/// elimination was up to 22 % wrong without a word.
#[test]
fn invariant_elimination_error_is_estimated() -> Result<(), LpmError> {
    let excitation = excitation()?;
    let (mut refused, mut taken) = (0, 0);
    for stiffness in [3e8, 1e9, 3e9, 1e10, 1e11, 1e12] {
        for frequency in [150.0, 400.0, 700.0, 900.0, 1300.0] {
            let mut pair = GearPair { mesh_damping: 3434.0, ..GearPair::table_3_2(Input::Prescribed) };
            (pair.pinion.support_stiffness, pair.gear.support_stiffness) = (stiffness, stiffness);
            let steady = |supports| {
                let model = Model::new(&pair, &excitation, supports)?;
                let options = SteadyOptions { integration: Options::with_tolerance(1e-9), ..Default::default() };
                let sampling = Sampling { per_cycle: 200, energy: false };
                let found = model.steady_response(frequency, &model.equilibrium(0.0), 1, &sampling, &options)?;
                Ok(found.response)
            };
            let (one, three): (Response, Response) = (steady(Supports::Eliminated)?, steady(Supports::Integrated)?);
            if one.separated_fraction() > 0.0 || three.separated_fraction() > 0.0 {
                continue;
            }
            let mean = three.mean() - one.mean();
            let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
            let pairs = || one.transmission_error.iter().zip(&three.transmission_error);
            let error = squares(&mut pairs().map(|(a, b)| b - a - mean));
            let whole = squares(&mut three.transmission_error.iter().map(|x| x - three.mean()));
            let measured = (error / whole).sqrt();
            let estimated = elimination_error(&pair, &excitation, frequency)?;
            println!("{stiffness:e} N/m, {frequency} Hz: measured {measured:.2e}, estimated {estimated:.2e}");
            // what a limit of 1 % lets pass is right to 2 %, what it refuses is wrong by more than 0.5 %
            assert!(estimated > 0.01 || measured < 0.02, "{stiffness:e} N/m, {frequency} Hz: {measured} {estimated}");
            assert!(estimated < 0.01 || measured > 0.005, "{stiffness:e} N/m, {frequency} Hz: {measured} {estimated}");
            (refused, taken) = (refused + usize::from(estimated > 0.01), taken + usize::from(estimated <= 0.01));
        }
    }
    assert!(refused >= 6 && taken >= 6, "{refused} {taken}");
    Ok(())
}

#[test]
fn regression_stiff_supports_do_not_set_the_step() -> Result<(), LpmError> {
    let soft = run(1e10, 3434.0, Supports::Integrated, Method::Esdirk, 1e-6)?.stats.steps;
    let stiff = run(1e12, 3434.0, Supports::Integrated, Method::Esdirk, 1e-6)?.stats.steps;
    let stiffest = run(1e14, 3434.0, Supports::Integrated, Method::Esdirk, 1e-6)?.stats.steps;
    println!("steps for 8 cycles: 1e10 {soft}, 1e12 {stiff}, 1e14 {stiffest}");
    // 8 cycles last 4.4 ms, 840 periods of the 190 kHz mode: resolving it takes more than ten thousand steps.
    assert!(stiff < 2000 && stiffest < 2000, "{soft} {stiff} {stiffest}");
    Ok(())
}
