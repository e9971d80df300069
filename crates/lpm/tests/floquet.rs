//! Floquet multipliers against closed forms and characteristic values.

use lpm::analytic::{principal_instability, two_stage_multipliers};
use lpm::{
    Curve, Excitation, GearPair, Input, LpmError, Method, Model, Options, ShootingOptions, Stability, State, Supports,
    stability,
};
use std::f64::consts::{PI, TAU};

fn model(k: &Curve, mass: f64, damping: f64) -> Result<Model, LpmError> {
    let e = Excitation::new(k, &Curve::constant(0.0)?)?;
    Model::new(&GearPair::oscillator(mass, damping, 100.0), &e, Supports::Rigid)
}

#[test]
fn analytic_two_stage_stiffness() -> Result<(), LpmError> {
    for damping in [0.0, 500.0, 3434.0, 40_000.0] {
        for f in [300.0, 1234.5, 2500.0, 5300.0, 20_000.0] {
            let k = Curve::rectangular(534e6, 824e6, 0.2, 0.64)?;
            let want = two_stage_multipliers(2.4, damping, (824e6, 0.64 / f), (534e6, 0.36 / f));
            for (method, tolerance) in [(Method::Magnus, 1e-6), (Method::DormandPrince, 1e-13), (Method::Esdirk, 1e-12)]
            {
                let o = Options { method: Some(method), ..Options::with_tolerance(tolerance) };
                let got = model(&k, 2.4, damping)?.parametric_multipliers(f, &o)?;
                for (g, w) in got.iter().zip(&want) {
                    let error = (g.re - w.0).hypot(g.im.abs() - w.1.abs());
                    // Integrators are followed at their tolerance; the exponential one is exact here.
                    let limit = if method == Method::Magnus { 1e-11 } else { 1e-8 };
                    assert!(error < limit, "{} {damping} {f}: {g:?} {w:?}", method.name());
                }
            }
        }
    }
    Ok(())
}

/// `y'' + (a - 2 q cos 2 t) y = 0` as an oscillator with one mesh cycle of length pi: multiplier trace at unit mass.
fn mathieu_trace(a: f64, q: f64) -> Result<f64, LpmError> {
    let k = Curve::fourier(a, &[(-2.0 * q, 0.0)])?;
    let m = model(&k, 1.0, 0.0)?.parametric_multipliers(1.0 / PI, &Options::with_tolerance(1e-12))?;
    Ok(m[0].re + m[1].re)
}

#[test]
fn peer_abramowitz_stegun_table_20_1_mathieu_characteristic_values() -> Result<(), LpmError> {
    // Characteristic values at q = 1 and 5 (Abramowitz & Stegun 1964, Table 20.1; also McLachlan 1947), where stiffness
    // stays positive: at even order the trace is 2, at odd order -2.
    for (a, q, trace) in [
        (4.371_300_98, 1.0, 2.0),  // a2
        (3.917_024_77, 1.0, 2.0),  // b2
        (9.078_368_85, 1.0, -2.0), // a3
        (9.047_739_26, 1.0, -2.0), // b3
    ] {
        let t = mathieu_trace(a, q)?;
        assert!((t - trace).abs() < 1e-7, "a = {a}, q = {q}: trace {t}");
    }
    // Just outside and inside the second tongue.
    assert!(mathieu_trace(3.90, 1.0)?.abs() < 2.0 && mathieu_trace(4.39, 1.0)?.abs() < 2.0);
    assert!(mathieu_trace(4.1, 1.0)? > 2.0);
    Ok(())
}

#[test]
fn analytic_principal_mathieu_tongue_with_damping() -> Result<(), LpmError> {
    let (k0, mass) = (600e6_f64, 2.4);
    let fn_hz = (k0 / mass).sqrt() / TAU;
    for (eps, zeta) in [(0.02, 0.0), (0.02, 0.003), (0.05, 0.01)] {
        let damping = 2.0 * zeta * (k0 * mass).sqrt();
        let m = model(&Curve::fourier(k0, &[(eps * k0, 0.0)])?, mass, damping)?;
        let at = |f: f64| -> Result<Stability, LpmError> {
            Ok(stability(&m.parametric_multipliers(f, &Options::with_tolerance(1e-11))?))
        };
        let (lo, hi) = principal_instability(fn_hz, eps, zeta).unwrap_or((0.0, 0.0));
        // First-order theory: boundaries are off by the order of eps^2 f_n.
        let slack = eps * eps * fn_hz + 1e-7 * fn_hz;
        assert_eq!(at(lo - slack)?, Stability::Stable);
        assert_eq!(at(hi + slack)?, Stability::Stable);
        assert_eq!(at(lo + slack)?, Stability::Flip, "period doubling inside the principal tongue");
        assert_eq!(at(hi - slack)?, Stability::Flip);
    }
    // Damping above eps / 4 closes the tongue.
    let m = model(&Curve::fourier(k0, &[(0.02 * k0, 0.0)])?, mass, 2.0 * 0.0052 * (k0 * mass).sqrt())?;
    for i in 0..41 {
        let f = 2.0 * fn_hz * (0.98 + 0.001 * f64::from(i));
        assert_eq!(stability(&m.parametric_multipliers(f, &Options::default())?), Stability::Stable);
    }
    Ok(())
}

#[test]
fn invariant_three_coordinates_have_the_determinant_of_liouville() -> Result<(), LpmError> {
    // Product of multipliers = exp(-trace of the damping matrix over the masses, times the period).
    let mut pair = GearPair { mesh_damping: 2000.0, ..GearPair::table_3_2(Input::Free) };
    (pair.pinion.support_stiffness, pair.gear.support_stiffness) = (4e8, 7e8);
    let e = Excitation::new(&Curve::fourier(680e6, &[(-120e6, 30e6)])?, &Curve::constant(0.0)?)?;
    let m = Model::new(&pair, &e, Supports::Integrated)?;
    let f = 2000.0;
    let o = Options { method: Some(Method::DormandPrince), ..Options::with_tolerance(1e-12) };
    let found = m.parametric_multipliers(f, &o)?;
    let log: f64 = found.iter().map(|m| m.modulus().ln()).sum();
    let rate = 2000.0 / pair.effective_mass() + (800.0 + 2000.0) / 0.7294 + (800.0 + 2000.0) / 0.8537;
    assert_eq!(found.len(), 6);
    assert!((log + rate / f).abs() < 1e-8 * rate / f, "{log} {}", -rate / f);
    Ok(())
}

#[test]
fn invariant_period_map_derivative_with_contact_loss_matches_differences() -> Result<(), LpmError> {
    // Saltation at events, with a force jump from the damper: multipliers of an orbit with contact loss against those of
    // a difference quotient of the map.
    let k = Curve::fourier(680e6, &[(-120e6, 30e6), (20e6, 15e6)])?;
    let d = Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6)])?;
    let pair = GearPair { mesh_damping: 2000.0, ..GearPair::table_3_2(Input::Prescribed) };
    let m = Model::new(&pair, &Excitation::new(&k, &d)?, Supports::Rigid)?;
    let f = 2300.0;
    let o = Options::with_tolerance(1e-12);
    let steady = m.steady_state(f, &State { position: [80e-6, 0.0, 0.0], ..State::default() }, &Default::default())?;
    let orbit = m.shoot(f, &steady.state, &ShootingOptions { integration: o, ..Default::default() })?;
    let sampling = Default::default();
    let map = |x: f64, v: f64| -> Result<[f64; 2], LpmError> {
        let s = State { position: [x, 0.0, 0.0], velocity: [v, 0.0, 0.0] };
        let r = m.simulate(f, &s, 1, &sampling, &o)?;
        Ok([r.end.position[0], r.end.velocity[0]])
    };
    let (x, v) = (orbit.state.position[0], orbit.state.velocity[0]);
    assert!(!m.simulate(f, &orbit.state, 1, &sampling, &o)?.separations.is_empty(), "contact must be lost");
    let (hx, hv) = (1e-11, 1e-7);
    let (a, b) = (map(x + hx, v)?, map(x - hx, v)?);
    let (c, e) = (map(x, v + hv)?, map(x, v - hv)?);
    let j = [
        (a[0] - b[0]) / (2.0 * hx),
        (c[0] - e[0]) / (2.0 * hv),
        (a[1] - b[1]) / (2.0 * hx),
        (c[1] - e[1]) / (2.0 * hv),
    ];
    let (trace, det) = (j[0] + j[3], j[0] * j[3] - j[1] * j[2]);
    let sum: f64 = orbit.multipliers.iter().map(|m| m.re).sum();
    let product = orbit.multipliers[0].re * orbit.multipliers[1].re - orbit.multipliers[0].im * orbit.multipliers[1].im;
    assert!((sum - trace).abs() < 1e-4, "trace {sum} {trace}");
    assert!((product - det).abs() < 1e-4, "determinant {product} {det}");
    Ok(())
}
