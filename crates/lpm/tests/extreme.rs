//! Ends of the ranges: damping, speed, load, grazing contact, chattering, backlash without load.

use lpm::{
    ContactPhase, Curve, Excitation, GearPair, Input, LpmError, Method, Model, Options, Response, Sampling, Separation,
    ShootingOptions, State, SteadyOptions, Supports,
};
use std::f64::consts::{PI, TAU};

fn square() -> Result<Excitation, LpmError> {
    Excitation::new(&Curve::rectangular(533e6, 806e6, 0.2, 0.64)?, &Curve::rectangular(11.8e-6, 18.3e-6, 0.84, 0.36)?)
}

fn all_finite(r: &Response) -> bool {
    [
        &r.transmission_error,
        &r.velocity,
        &r.mesh_deflection,
        &r.mesh_force,
        &r.pinion_bearing_force,
        &r.gear_bearing_force,
    ]
    .into_iter()
    .flatten()
    .all(|v| v.is_finite())
        && r.peak_to_peak().is_finite()
        && r.rms().is_finite()
        && r.dynamic_factor().is_finite()
        && (0.0..=1.0 + 1e-12).contains(&r.separated_fraction())
}

#[test]
fn extreme_damping_speed_and_torque_stay_finite() -> Result<(), LpmError> {
    let mut runs = 0;
    for ratio in [0.0, 1e-6, 0.05, 0.7, 1.0] {
        for torque in [0.0, 1e-9, 1.0, 424.0] {
            for input in [Input::Prescribed, Input::Free] {
                for separation in [Separation::ForceVanishes, Separation::DeflectionVanishes] {
                    let mut pair = GearPair::table_3_2(input);
                    pair.mesh_damping = pair.damping_for_ratio(ratio, 806e6);
                    pair.separation = separation;
                    (pair.pinion.torque, pair.gear.torque) = (torque * 35.2 / 45.63, torque);
                    for supports in [Supports::Rigid, Supports::Eliminated, Supports::Integrated] {
                        let m = Model::new(&pair, &square()?, supports)?;
                        for f in [1.0, 30.0, 1000.0, 2400.0, 50_000.0] {
                            // A second of standstill speed holds thousands of free oscillations: the implicit method at
                            // three coordinates gets a share of it by a looser tolerance.
                            let o = Options::with_tolerance(if f < 100.0 { 1e-4 } else { 1e-7 });
                            let r = m.simulate(f, &m.equilibrium(0.0), 1, &Sampling::default(), &o)?;
                            assert!(all_finite(&r), "{ratio} {torque} {input:?} {supports:?} {f} Hz");
                            runs += 1;
                        }
                    }
                }
            }
        }
    }
    assert_eq!(runs, 5 * 4 * 2 * 2 * 3 * 5);
    Ok(())
}

#[test]
fn extreme_slow_speed_follows_the_static_curve_and_fast_speed_its_average() -> Result<(), LpmError> {
    let k = Curve::fourier(680e6, &[(-120e6, 30e6)])?;
    let d = Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6)])?;
    let pair = GearPair::table_3_2(Input::Prescribed);
    let m = Model::new(&pair, &Excitation::new(&k, &d)?, Supports::Rigid)?;
    let slow = m.shoot(1.0, &m.equilibrium(0.0), &ShootingOptions::default())?;
    let r = m.simulate(1.0, &slow.state, 1, &Sampling::default(), &Options::default())?;
    for (t, x) in r.mesh_cycle.iter().zip(&r.transmission_error) {
        // Dynamic part: (c w + m w^2) / k of 3 um, 5e-5 of it at 1 Hz.
        assert!((x - d.value(*t)).abs() < 1e-4 * 3e-6, "cycle {t}");
    }
    let fast = m.shoot(50_000.0, &m.equilibrium(0.0), &ShootingOptions::default())?;
    let r = m.simulate(50_000.0, &fast.state, 1, &Sampling::default(), &Options::default())?;
    // Twenty times above resonance: inertia and damping leave (f_n / f)^2 + 2 zeta f_n / f of 6 um at most.
    let ratio = 2680.0 / 50_000.0_f64;
    assert!(r.peak_to_peak() < 2.0 * (ratio * ratio + 0.1 * ratio) * 6e-6);
    // Mean of k (x - delta_0) over a cycle vanishes: x = <k delta_0> / <k>.
    let n = 1000;
    let mean = (0..n).map(|i| f64::from(i) / f64::from(n)).map(|t| k.value(t) * d.value(t)).sum::<f64>()
        / f64::from(n)
        / k.mean();
    assert!((r.mean() - mean).abs() < 0.01 * 3e-6, "{} {mean}", r.mean());
    Ok(())
}

#[test]
fn extreme_grazing_contact_is_continuous_in_the_amplitude() -> Result<(), LpmError> {
    // One harmonic of error on a linear mesh: contact is lost where the amplitude of the elastic deflection, a * H(f),
    // passes f_0 / k. At that amplitude the trajectory touches the boundary without crossing.
    let (mass, k, c, force) = (2.4, 600e6, 3000.0, 9292.0);
    let f = 2300.0;
    let w = TAU * f;
    // Elastic deflection x - delta_0 = a (k / (k - m w^2 + i c w) - 1) ... as a complex amplitude; its modulus per unit of a:
    // k + i c w is not in the numerator since the damper acts on x' alone.
    let (dr, di) = (k - mass * w * w, c * w);
    let den = dr * dr + di * di;
    let (hr, hi) = (k * dr / den - 1.0, -k * di / den);
    let a_graze = force / k / hr.hypot(hi);
    let run = |scale: f64| -> Result<Response, LpmError> {
        let e = Excitation::new(&Curve::constant(k)?, &Curve::fourier(20e-6, &[(scale * a_graze, 0.0)])?)?;
        let m = Model::new(&GearPair::oscillator(mass, c, force), &e, Supports::Rigid)?;
        let o = ShootingOptions { integration: Options::with_tolerance(1e-12), tolerance: 1e-11, ..Default::default() };
        let orbit = m.shoot(f, &m.equilibrium(0.0), &o)?;
        m.simulate(f, &orbit.state, 20, &Sampling::default(), &Options::with_tolerance(1e-12))
    };
    let exact = |scale: f64| 2.0 * scale * a_graze * k / den.sqrt();
    for eps in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 0.0] {
        let inside = run(1.0 - eps)?;
        assert!(inside.separated_fraction() < 1e-4, "{eps:e}: {}", inside.separated_fraction());
        // Within the integration tolerance of the boundary, rounding decides; see below for the square root.
        let limit = if eps < 1e-9 { 1e-5 } else { 1e-7 };
        let error = inside.peak_to_peak() / exact(1.0 - eps) - 1.0;
        assert!(error.abs() < limit, "below by {eps:e}: {error:e}");
    }
    for eps in [1e-10, 1e-8, 1e-6, 1e-4] {
        let outside = run(1.0 + eps)?;
        // Lost over the tip of a parabola: duration grows with the square root of the excess. Deviation of the
        // response follows with its square root at worst.
        assert!(outside.separated_fraction() < 10.0 * f64::sqrt(eps), "{eps:e}: {}", outside.separated_fraction());
        assert!(
            (outside.peak_to_peak() / exact(1.0 + eps) - 1.0).abs() < 10.0 * f64::sqrt(eps),
            "{eps:e}: {}",
            outside.peak_to_peak() / exact(1.0) - 1.0
        );
    }
    assert!(!run(1.01)?.separations.is_empty());
    Ok(())
}

#[test]
fn extreme_chattering_ends_in_finite_numbers_or_a_named_error() -> Result<(), LpmError> {
    // Printed rule with a negative error: contact pushes off, the load pushes back, ever faster as the damper eats the bounce.
    let e = Excitation::new(&Curve::constant(600e6)?, &Curve::constant(-5e-6)?)?;
    let mut named = 0;
    for damping in [0.0, 3000.0, 60_000.0] {
        for method in Method::ALL {
            let mut pair = GearPair::oscillator(2.4, damping, 9292.0);
            pair.separation = Separation::DeflectionVanishes;
            let m = Model::new(&pair, &e, Supports::Rigid)?;
            let start = State { position: [2e-6, 0.0, 0.0], ..State::default() };
            let o = Options { method: Some(method), ..Options::default() };
            match m.simulate(100.0, &start, 3, &Sampling::default(), &o) {
                Ok(r) => assert!(all_finite(&r)),
                Err(LpmError::TooManyEvents { limit, .. }) => {
                    assert_eq!(limit, o.max_events_per_cycle);
                    named += 1;
                }
                Err(other) => return Err(other),
            }
        }
    }
    assert!(named > 0, "the damped bounce has no end of events");
    // The default rule has a continuous elastic force: the same pair settles to contact.
    let m = Model::new(&GearPair::oscillator(2.4, 3000.0, 9292.0), &e, Supports::Rigid)?;
    let s = m.steady_state(100.0, &State::default(), &SteadyOptions::default())?;
    assert!((s.state.position[0] + 5e-6).abs() < 1e-11);
    Ok(())
}

#[test]
fn analytic_rattle_across_the_backlash_without_load() -> Result<(), LpmError> {
    // Free flight over the clearance b at speed v, half an oscillation on each flank: period 2 (b / v + pi / w).
    let (mass, k, b, v) = (2.4, 600e6_f64, 80e-6, 0.3);
    let period = 2.0 * (b / v + PI / (k / mass).sqrt());
    let e = Excitation::new(&Curve::constant(k)?, &Curve::constant(0.0)?)?;
    let mut pair = GearPair::oscillator(mass, 0.0, 0.0);
    pair.backlash = Some(b);
    let m = Model::new(&pair, &e, Supports::Rigid)?;
    let start = State { position: [-0.5 * b, 0.0, 0.0], velocity: [v, 0.0, 0.0] };
    let r = m.simulate(1.0 / period, &start, 5, &Sampling::default(), &Options::default())?;
    assert!((r.end.position[0] + 0.5 * b).abs() < 1e-9 * b);
    assert!((r.end.velocity[0] / v - 1.0).abs() < 1e-9);
    assert_eq!(r.events.len(), 20);
    let coast: f64 =
        r.separations.iter().filter(|i| i.phase == ContactPhase::Coast).map(|i| (i.end - i.start) * period).sum();
    assert!((coast - 5.0 * PI / (k / mass).sqrt()).abs() < 1e-12);
    assert!(r.mesh_force.iter().any(|f| *f < -1000.0));
    // Flanks that would overlap are refused.
    pair.gear.torque = 9292.0;
    pair.backlash = Some(10e-6);
    assert!(matches!(Model::new(&pair, &e, Supports::Rigid), Err(LpmError::Jammed { .. })));
    Ok(())
}

#[test]
fn extreme_input_is_refused_with_the_number() -> Result<(), LpmError> {
    let e = square()?;
    let good = GearPair::table_3_2(Input::Free);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for i in 0..4 {
            let mut pair = good;
            match i {
                0 => pair.pinion.base_radius = bad,
                1 => pair.gear.inertia = bad,
                2 => pair.gear.mass = bad,
                _ => pair.pinion.support_stiffness = bad,
            }
            assert!(matches!(Model::new(&pair, &e, Supports::Integrated), Err(LpmError::OutOfRange { .. })));
        }
        let m = Model::new(&good, &e, Supports::Rigid)?;
        let r = m.simulate(bad, &m.equilibrium(0.0), 1, &Sampling::default(), &Options::default());
        assert!(matches!(r, Err(LpmError::OutOfRange { .. })));
    }
    let m = Model::new(&good, &e, Supports::Integrated)?;
    let o = Options { method: Some(Method::Magnus), ..Options::default() };
    let r = m.simulate(1000.0, &m.equilibrium(0.0), 1, &Sampling::default(), &o);
    assert!(matches!(r, Err(LpmError::Unsuited { .. })));
    Ok(())
}
