//! Elastic supports: implicit integration, explicit integration that resolves everything, and elimination agree.

use lpm::{
    Curve, Excitation, GearPair, Input, LpmError, Method, Model, Options, Response, Sampling, Supports,
};

fn excitation() -> Result<Excitation, LpmError> {
    let k = Curve::fourier(680e6, &[(-120e6, 30e6), (20e6, 15e6)])?;
    let d = Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6), (-0.4e-6, 0.0)])?;
    Excitation::new(&k, &d)
}

fn run(stiffness: f64, supports: Supports, method: Method, tolerance: f64) -> Result<Response, LpmError> {
    let mut pair = GearPair { mesh_damping: 3434.0, ..GearPair::table_3_2(Input::Prescribed) };
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
        let resolved = run(stiffness, Supports::Integrated, Method::DormandPrince, 1e-9)?;
        let implicit = run(stiffness, Supports::Integrated, Method::Esdirk, 1e-9)?;
        let d = largest_difference(&implicit, &resolved);
        assert!(d < limit, "{stiffness:e} N/m: {d:e}");
    }
    Ok(())
}

#[test]
fn invariant_elimination_agrees_with_integration_for_stiff_supports() -> Result<(), LpmError> {
    let mut last = f64::INFINITY;
    for stiffness in [1e10, 1e11, 1e12, 1e13, 1e14] {
        let full = run(stiffness, Supports::Integrated, Method::Esdirk, 1e-10)?;
        let one = run(stiffness, Supports::Eliminated, Method::Magnus, 1e-10)?;
        let d = largest_difference(&one, &full);
        println!("support {stiffness:e} N/m: eliminated against integrated {d:e} of peak to peak, {} steps", full.stats.steps);
        // Neglected: inertia of the supports, of the order of the stiffness ratio; floor set by the tolerance.
        let ratio = 1e9 / stiffness;
        assert!(d < (2.0 * ratio).max(1e-7), "{stiffness:e} N/m: {d:e}");
        assert!(d < last.max(1e-7), "must not grow with stiffness: {d:e} after {last:e}");
        last = d;
        // Bearing forces: quasi-static part equals the mesh force.
        let scale = full.mean_force;
        for (b, f) in one.gear_bearing_force.iter().zip(&one.mesh_force) {
            assert!((b - f).abs() < 1e-9 * scale);
        }
    }
    Ok(())
}

#[test]
fn regression_stiff_supports_do_not_set_the_step() -> Result<(), LpmError> {
    let soft = run(1e10, Supports::Integrated, Method::Esdirk, 1e-6)?.stats.steps;
    let stiff = run(1e12, Supports::Integrated, Method::Esdirk, 1e-6)?.stats.steps;
    let stiffest = run(1e14, Supports::Integrated, Method::Esdirk, 1e-6)?.stats.steps;
    println!("steps for 8 cycles: 1e10 {soft}, 1e12 {stiff}, 1e14 {stiffest}");
    // 8 cycles last 4.4 ms, 840 periods of the 190 kHz mode: resolving it takes more than ten thousand steps.
    assert!(stiff < 2000 && stiffest < 2000, "{soft} {stiff} {stiffest}");
    Ok(())
}
