//! Periodic solutions: shooting, waiting, continuation, sweeps.

use lpm::{
    BranchEnd, ContinuationOptions, Curve, Excitation, GearPair, Input, LpmError, Method, Model, Options, OrbitStatus,
    Sampling, ShootingOptions, Stability, State, SteadyOptions, Supports, SweepOptions, frequencies,
};
use std::f64::consts::TAU;

/// Constant stiffness, one harmonic of transmission error: a linear oscillator while contact lasts.
fn linear(mass: f64, k: f64, damping: f64, force: f64, mean: f64, amplitude: f64) -> Result<Model, LpmError> {
    let e = Excitation::new(&Curve::constant(k)?, &Curve::fourier(mean, &[(amplitude, 0.0)])?)?;
    Model::new(&GearPair::oscillator(mass, damping, force), &e, Supports::Rigid)
}

fn pair_model(damped_flight: bool, supports: Supports) -> Result<Model, LpmError> {
    let k = Curve::trapezoidal(534e6, 824e6, 0.2, 0.64, 0.08)?;
    let d = Curve::trapezoidal(18.3e-6, 11.8e-6, 0.2, 0.64, 0.08)?;
    let pair = GearPair { damping_when_apart: damped_flight, ..GearPair::table_3_2(Input::Prescribed) };
    Model::new(&pair, &Excitation::new(&k, &d)?, supports)
}

#[test]
fn analytic_linear_response_amplitude_and_phase() -> Result<(), LpmError> {
    // m x'' + c x' + k x = k delta_0: amplitude A k / |k - m w^2 + i c w|; slow limit is quasi-static.
    let (mass, k, c, a) = (2.4, 600e6, 3000.0, 0.2e-6);
    let m = linear(mass, k, c, 9292.0, 15e-6, a)?;
    for f in [1.0, 50.0, 800.0, 2516.0, 2600.0, 9000.0, 50_000.0] {
        let orbit = m.shoot(f, &m.equilibrium(0.0), &ShootingOptions::default())?;
        assert_eq!(orbit.status, OrbitStatus::Converged, "{f} Hz");
        let w = TAU * f;
        let want = a * k / (k - mass * w * w).hypot(c * w);
        let r = m.simulate(
            f,
            &orbit.state,
            1,
            &Sampling { per_cycle: 400, energy: false },
            &Options::with_tolerance(1e-10),
        )?;
        assert!(r.separations.is_empty());
        let got = r.spectrum()?.amplitude_at(f);
        assert!((got / want - 1.0).abs() < 1e-6, "{f} Hz: {got:e} {want:e}");
        assert!((0.5 * r.peak_to_peak() / want - 1.0).abs() < 1e-6, "{f} Hz");
        assert!((r.mean() - 15e-6).abs() < 1e-6 * want);
        let decay = (-0.5 * c / mass / f).exp();
        assert!((orbit.multipliers[0].modulus() - decay).abs() < 1e-7, "{f} Hz");
    }
    Ok(())
}

#[test]
fn invariant_waiting_and_shooting_find_the_same_orbit() -> Result<(), LpmError> {
    let m = pair_model(false, Supports::Eliminated)?;
    for f in [400.0, 900.0, 1800.0, 2500.0, 3500.0] {
        let waiting = SteadyOptions {
            polish: false,
            tolerance: 1e-9,
            integration: Options::with_tolerance(1e-10),
            ..Default::default()
        };
        let a = m.steady_state(f, &m.equilibrium(0.0), &waiting)?;
        assert_eq!(a.multiple, Some(1));
        let b = m.shoot(f, &a.state, &ShootingOptions::default())?;
        assert!(b.is_attractor());
        assert!((a.state.position[0] - b.state.position[0]).abs() < 1e-6 * 18e-6, "{f} Hz");
        let polished = m.steady_state(f, &m.equilibrium(0.0), &SteadyOptions::default())?;
        assert!((polished.state.position[0] - b.state.position[0]).abs() < 1e-6 * 18e-6, "{f} Hz");
        assert!(polished.periods <= a.periods);
    }
    Ok(())
}

#[test]
fn invariant_sweeps_lie_on_the_branch_of_the_continuation() -> Result<(), LpmError> {
    let m = pair_model(true, Supports::Eliminated)?;
    let up = frequencies(200.0, 4000.0, 77);
    let down: Vec<f64> = up.iter().rev().copied().collect();
    let start = m.steady_state(4050.0, &m.equilibrium(0.0), &SteadyOptions::default())?;
    let o = ContinuationOptions { from: 150.0, to: 4060.0, ..Default::default() };
    let branch = m.continuation(4050.0, &start.state, &o)?;
    assert_eq!(branch.end, BranchEnd::RangeLeft);
    for speeds in [&up, &down] {
        for p in m.sweep(speeds, &SweepOptions { sampling: o.sampling, ..Default::default() })? {
            assert_eq!(p.multiple, Some(1));
            let near = branch
                .at(p.mesh_frequency)
                .iter()
                .filter(|(_, stable)| *stable)
                .map(|(pp, _)| (pp / p.measure.peak_to_peak - 1.0).abs())
                .fold(f64::INFINITY, f64::min);
            // Linear interpolation between branch points; exact agreement is checked by shooting below.
            assert!(near < 0.03, "{} Hz: nearest branch solution off by {near}", p.mesh_frequency);
            let orbit = m.shoot(p.mesh_frequency, &p.state, &ShootingOptions::default())?;
            assert!(orbit.is_attractor());
            assert!((orbit.state.position[0] - p.state.position[0]).abs() < 1e-5 * 18e-6);
        }
    }
    // Between the turning points of the primary resonance there are three solutions, the middle one unstable.
    let middle = branch.at(2000.0);
    assert_eq!(middle.len(), 3, "{middle:?}");
    assert_eq!(middle.iter().filter(|(_, s)| *s).count(), 2);
    for t in &branch.turning_points {
        let nearest = t.point.multipliers.iter().map(|m| (m.re - 1.0).hypot(m.im)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-3, "a multiplier is +1 at a turning point: {:?}", t.point.multipliers);
    }
    Ok(())
}

#[test]
fn invariant_unstable_branch_is_left_in_time() -> Result<(), LpmError> {
    // A saddle found by continuation repeats for one period and is left after many.
    let m = pair_model(true, Supports::Eliminated)?;
    let start = m.steady_state(3000.0, &m.equilibrium(0.0), &SteadyOptions::default())?;
    let o = ContinuationOptions { from: 1500.0, to: 3050.0, ..Default::default() };
    let branch = m.continuation(3000.0, &start.state, &o)?;
    let saddle = branch.points.iter().find(|p| p.stability == Stability::Saddle && p.mesh_frequency > 1900.0);
    let saddle = saddle.ok_or(LpmError::Singular { place: "no saddle on the branch" })?;
    let mut nudged = saddle.state;
    nudged.position[0] += 1e-9;
    let end = m.steady_state(saddle.mesh_frequency, &nudged, &SteadyOptions::default())?;
    assert!((end.state.position[0] - saddle.state.position[0]).abs() > 1e-7);
    Ok(())
}

#[test]
fn invariant_full_and_eliminated_supports_have_the_same_turning_points() -> Result<(), LpmError> {
    let fold = |supports| -> Result<Vec<f64>, LpmError> {
        let m = pair_model(true, supports)?;
        let start = m.steady_state(2500.0, &m.equilibrium(0.0), &SteadyOptions::default())?;
        let o = ContinuationOptions { from: 1500.0, to: 2510.0, max_step: 0.2, ..Default::default() };
        Ok(m.continuation(2500.0, &start.state, &o)?.turning_points.iter().map(|t| t.point.mesh_frequency).collect())
    };
    let (one, three) = (fold(Supports::Eliminated)?, fold(Supports::Integrated)?);
    assert_eq!(one.len(), 2);
    assert_eq!(three.len(), 2);
    for (a, b) in one.iter().zip(&three) {
        assert!((a / b - 1.0).abs() < 1e-3, "{one:?} {three:?}");
    }
    Ok(())
}

#[test]
fn analytic_period_doubling_in_the_principal_tongue_is_found_as_multiple_two() -> Result<(), LpmError> {
    // Stiffness modulated at twice the natural frequency by more than four times the damping ratio; growth ends by contact loss.
    let (mass, k0) = (2.4, 600e6_f64);
    let f = 2.0 * (k0 / mass).sqrt() / TAU;
    let e = Excitation::new(&Curve::fourier(k0, &[(0.3 * k0, 0.0)])?, &Curve::constant(15e-6)?)?;
    let damping = 2.0 * 0.02 * (k0 * mass).sqrt();
    let m = Model::new(&GearPair::oscillator(mass, damping, 9292.0), &e, Supports::Rigid)?;
    let start = State { position: [15.5e-6, 0.0, 0.0], ..State::default() };
    let s = m.steady_state(f, &start, &SteadyOptions::default())?;
    assert_eq!(s.multiple, Some(2), "{s:?}");
    let o = m.shoot(f, &s.state, &ShootingOptions { multiple: 2, ..Default::default() })?;
    assert!(o.is_attractor(), "{o:?}");
    let once = m.shoot(f, &m.equilibrium(0.0), &ShootingOptions::default())?;
    assert_eq!(once.stability(), Stability::Flip);
    Ok(())
}

#[test]
fn peer_dissertation_d7_3_two_solutions_from_about_1700_to_2300_hz() -> Result<(), LpmError> {
    // Table 7.2 as printed, pinion rotation prescribed, damper left in place in flight (D3.4.2: only k_l and delta_0 vanish).
    // Stiffness from the natural frequencies of D4.3, two pairs over 0.64 of the cycle, static transmission error of a
    // linear mesh; and a trapezium with levels of the finite-element curves. Neither is the FE/CM curve, and speeds were
    // stepped by 50 Hz, hence the windows.
    let wave = {
        let pair = GearPair { damping_when_apart: true, ..GearPair::table_3_2(Input::Prescribed) };
        let f0 = pair.mean_force();
        let k = Curve::rectangular(533e6, 806e6, 0.18, 0.64)?;
        let d = Curve::rectangular(f0 / 533e6, f0 / 806e6, 0.18, 0.64)?;
        Model::new(&pair, &Excitation::new(&k, &d)?, Supports::Eliminated)?
    };
    for m in [wave, pair_model(true, Supports::Eliminated)?] {
        let start = m.steady_state(3000.0, &m.equilibrium(0.0), &SteadyOptions::default())?;
        let o = ContinuationOptions { from: 1450.0, to: 3050.0, ..Default::default() };
        let b = m.continuation(3000.0, &start.state, &o)?;
        let [(from, to)] = b.coexistence()[..] else {
            return Err(LpmError::Length {
                what: "ranges with two solutions",
                found: b.coexistence().len(),
                needed: "1",
            });
        };
        assert!((1650.0..1750.0).contains(&from), "{from}");
        assert!((2250.0..2350.0).contains(&to), "{to}");
        // The sweep up jumps at the upper end, the sweep down at the lower one.
        let up = frequencies(1450.0, 3050.0, 33);
        let jump = |points: &[lpm::SweepPoint]| {
            points
                .windows(2)
                .map(|w| {
                    (
                        (w[1].measure.peak_to_peak / w[0].measure.peak_to_peak).ln().abs(),
                        w[0].mesh_frequency,
                        w[1].mesh_frequency,
                    )
                })
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or_default()
        };
        let u = jump(&m.sweep(&up, &SweepOptions::default())?);
        assert!(u.1 <= to && to <= u.2, "{u:?} {to}");
        let down: Vec<f64> = up.iter().rev().copied().collect();
        let d = jump(&m.sweep(&down, &SweepOptions::default())?);
        assert!(d.2 <= from && from <= d.1, "{d:?} {from}");
    }
    Ok(())
}

#[test]
fn invariant_same_bits_on_repetition_and_for_every_thread() -> Result<(), LpmError> {
    let m = pair_model(false, Supports::Integrated)?;
    let run = || m.sweep(&[1000.0, 2000.0, 3000.0], &SweepOptions::default());
    let first = run()?;
    let others: Vec<_> = std::thread::scope(|s| {
        let handles: Vec<_> = (0..3).map(|_| s.spawn(run)).collect();
        handles.into_iter().filter_map(|h| h.join().ok()).collect()
    });
    assert_eq!(others.len(), 3);
    for o in others {
        assert_eq!(o?, first);
    }
    Ok(())
}

#[test]
fn regression_methods_agree_on_the_steady_state() -> Result<(), LpmError> {
    let m = pair_model(false, Supports::Rigid)?;
    let mut found = Vec::new();
    for method in Method::ALL {
        let tolerance = if method == Method::Newmark { 1e-9 } else { 1e-10 };
        let integration = Options { method: Some(method), ..Options::with_tolerance(tolerance) };
        let steady =
            m.steady_state(2500.0, &m.equilibrium(0.0), &SteadyOptions { integration, ..Default::default() })?;
        let r = m.simulate(2500.0, &steady.state, 1, &Sampling::default(), &integration)?;
        found.push(r.peak_to_peak());
    }
    for p in &found {
        assert!((p / found[0] - 1.0).abs() < 1e-6, "{found:?}");
    }
    Ok(())
}
