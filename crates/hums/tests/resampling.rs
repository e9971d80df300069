//! Interpolation: agreement with scipy, orders of convergence, decay of band-limited errors.

mod common;
use common::max_difference;
use hums::HumsError;
use hums::resample::{Interpolation, resample, samples_per_period, to_angle};
use hums::tachometer::Shaft;
use std::f64::consts::{PI, TAU};

#[test]
fn peer_scipy_cubic_spline() {
    let field = |name: &str| -> Vec<f64> {
        include_str!("data/scipy_reference.txt")
            .lines()
            .find_map(|line| line.strip_prefix(name)?.strip_prefix(": "))
            .unwrap()
            .split(' ')
            .map(|v| v.parse().unwrap())
            .collect()
    };
    let values = resample(&field("signal"), &field("spline_positions"), Interpolation::CubicSpline).unwrap();
    assert!(max_difference(&values, &field("spline_values")) < 1e-12);
}

#[test]
fn analytic_cubics_are_reproduced() {
    // The not-a-knot spline through a cubic is the cubic, ends included; short records too.
    let cubic = |x: f64| 2.0 - 0.3 * x + 0.07 * x * x - 0.004 * x * x * x;
    for n in [4, 5, 40, 100] {
        let y: Vec<f64> = (0..n).map(|i| cubic(i as f64)).collect();
        let at: Vec<f64> = (0..7 * (n - 1)).map(|i| i as f64 / 7.0).collect();
        let expected: Vec<f64> = at.iter().map(|x| cubic(*x)).collect();
        let scale = y.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
        let found = resample(&y, &at, Interpolation::CubicSpline).unwrap();
        assert!(max_difference(&found, &expected) < 1e-12 * scale, "{n}");
    }
    let parabola = resample(&[0.0, 1.0, 4.0], &[0.5, 1.5], Interpolation::CubicSpline).unwrap();
    assert!(max_difference(&parabola, &[0.25, 2.25]) < 1e-15);
    let line = resample(&[1.0, 3.0], &[0.25], Interpolation::CubicSpline).unwrap();
    assert!(max_difference(&line, &[1.5]) < 1e-15);
    assert_eq!(resample(&[7.0], &[0.0], Interpolation::Linear).unwrap(), [7.0]);
}

/// Largest interior error for a tone of `w` rad per sample.
fn tone_error(w: f64, method: Interpolation) -> f64 {
    let n = 1200;
    let x: Vec<f64> = (0..n).map(|i| (w * i as f64 + 0.3).sin()).collect();
    let at: Vec<f64> = (0..600).map(|i| 300.0 + i as f64 * 0.997).collect();
    let expected: Vec<f64> = at.iter().map(|p| (w * p + 0.3).sin()).collect();
    max_difference(&resample(&x, &at, method).unwrap(), &expected)
}

fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x.ln() / n, b + y.ln() / n));
    let (num, den) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| {
        let d = x.ln() - mx;
        (a + d * (y.ln() - my), b + d * d)
    });
    num / den
}

#[test]
fn order_of_linear_and_spline() {
    let ladder = [PI / 8.0, PI / 16.0, PI / 32.0, PI / 64.0];
    for (method, order) in [(Interpolation::Linear, 2.0), (Interpolation::CubicSpline, 4.0)] {
        let points: Vec<_> = ladder.iter().map(|&w| (w, tone_error(w, method))).collect();
        let found = slope(&points);
        assert!((found - order).abs() < 0.05, "{method:?}: order {found}");
    }
}

#[test]
fn order_band_limited_decays_exponentially() {
    // beta chosen so that the transition ends at half Nyquist: a = 8 + 4.57 L (pi/2) dB, up to the
    // largest beta; the error must follow 10^(-a/20) (within a factor of 4 for the sum of ripples).
    for half_width in [4, 8, 12] {
        let a = 8.0 + 4.57 * half_width as f64 * PI / 2.0;
        let beta = (0.1102 * (a - 8.7)).min(16.0);
        let method = Interpolation::BandLimited { half_width, beta };
        let bound = 4.0 * 10_f64.powf(-(beta / 0.1102 + 8.7) / 20.0);
        for w in [0.05, 0.3, 0.7, PI / 2.0] {
            let error = tone_error(w, method);
            assert!(error < bound, "L {half_width}, w {w}: {error:e} > {bound:e}");
        }
    }
    // The default: ripple 1e-6 up to 0.84 Nyquist.
    assert!(tone_error(0.84 * PI, Interpolation::default()) < 4e-6);
}

#[test]
fn invariant_samples_are_reproduced_at_samples() {
    let x = common::gaussian(200, 3);
    let at: Vec<f64> = (60..140).map(f64::from).collect();
    for method in [Interpolation::Linear, Interpolation::CubicSpline, Interpolation::default()] {
        let y = resample(&x, &at, method).unwrap();
        assert!(max_difference(&y, &x[60..140]) < 1e-13, "{method:?}");
    }
}

#[test]
fn analytic_coarser_grid_does_not_alias() {
    // Every third sample: a tone at 0.8 Nyquist would fold onto 0.4 Nyquist of the new grid.
    let x: Vec<f64> = (0..3000).map(|i| (0.8 * PI * i as f64).sin()).collect();
    let at: Vec<f64> = (0..600).map(|i| 500.0 + 3.0 * f64::from(i)).collect();
    let filtered = resample(&x, &at, Interpolation::default()).unwrap();
    assert!(filtered.iter().all(|v| v.abs() < 4e-6));
    let aliased = resample(&x, &at, Interpolation::CubicSpline).unwrap();
    assert!(aliased.iter().any(|v| v.abs() > 0.5));
}

#[test]
fn analytic_chirp_becomes_a_tone_in_angle() {
    // Speed doubles over the record: phase = 20 t + 10 t^2 turns over 1 s... order 12 vibration.
    let (rate, order) = (20_000.0, 12.0);
    let phase = |t: f64| 20.0 * t + 10.0 * t * t;
    let x: Vec<f64> = (0..20_000).map(|i| (TAU * order * phase(f64::from(i) / rate)).sin()).collect();
    // Exact times of turns: t = -1 + sqrt(1 + turn / 10).
    let pulses: Vec<f64> = (0..=30).map(|k| (1.0 + f64::from(k) / 10.0).sqrt() - 1.0).collect();
    let shaft = Shaft::from_pulses(&pulses, 1.0).unwrap();
    let angle = to_angle(&x, rate, &shaft, 1024, Interpolation::default()).unwrap();
    assert_eq!(angle.per_turn, 1024);
    let expected: Vec<f64> =
        (0..angle.samples.len()).map(|k| (TAU * order * (angle.first_turn + k as f64 / 1024.0)).sin()).collect();
    // The spline through 31 exact pulses places angles to 1e-6 turns at its worst end interval.
    assert!(angle.samples.len() > 28 * 1024);
    assert!(max_difference(&angle.samples, &expected) < 5e-3);
    let inner = 10 * 1024..20 * 1024;
    assert!(max_difference(&angle.samples[inner.clone()], &expected[inner]) < 1e-4);
    assert_eq!(samples_per_period(rate, &shaft, 1.0).unwrap(), 1024);
}

#[test]
fn extreme_positions_and_parameters() {
    let x = [0.0, 1.0, 2.0];
    assert!(matches!(resample(&x, &[2.5], Interpolation::Linear), Err(HumsError::Parameter { .. })));
    assert!(resample(&x, &[f64::NAN], Interpolation::Linear).is_err());
    assert!(resample(&[], &[], Interpolation::Linear).is_err());
    assert!(resample(&[f64::NAN, 1.0], &[0.5], Interpolation::Linear).is_err());
    for method in [
        Interpolation::BandLimited { half_width: 1, beta: 8.0 },
        Interpolation::BandLimited { half_width: 8, beta: 17.0 },
        Interpolation::BandLimited { half_width: 8, beta: f64::NAN },
    ] {
        assert!(resample(&x, &[1.0], method).is_err());
    }
    let late = Shaft::from_pulses(&[50.0, 51.0], 1.0).unwrap();
    assert!(matches!(to_angle(&x, 1.0, &late, 64, Interpolation::Linear), Err(HumsError::Undefined { .. })));
}

/// Tones that a coarser grid carries keep their amplitude: the anti-aliasing filter has gain 1.
#[test]
fn analytic_coarser_grid_keeps_the_pass_band() {
    for step in [1.5, 3.0, 7.3] {
        for part in [0.0, 0.2, 0.6] {
            // At a share of the Nyquist frequency of the new grid.
            let omega = part * PI / step;
            let x: Vec<f64> = (0..4000).map(|i| (omega * f64::from(i)).cos()).collect();
            let at: Vec<f64> = (0..300).map(|k| 600.0 + step * f64::from(k)).collect();
            let found = resample(&x, &at, Interpolation::default()).unwrap();
            let expected: Vec<f64> = at.iter().map(|p| (omega * p).cos()).collect();
            assert!(max_difference(&found, &expected) < 1e-5, "{step} {part}");
        }
    }
}
