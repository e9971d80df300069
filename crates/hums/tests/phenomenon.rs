//! Phenomenon-based model: closed forms against quadrature and samples, the dissertation's numbers,
//! recovery of parameters.

mod common;
use common::{close, gaussian, max_difference};
use hums::HumsError;
use hums::indicator::basic::{kurtosis, m6a, m8a, rms};
use hums::modal_fit::{Method, fit_modes};
use hums::phenomenon::fit::{FitOptions, FitStatus, fit};
use hums::phenomenon::modes::{ModalResponse, Mode};
use hums::phenomenon::{AmplitudeDensity, ClosedForm, DampedSine, simplified_indicators};
use std::f64::consts::PI;

/// 20 % crack, D 4.5.1; micrometres.
const CRACK_20: DampedSine =
    DampedSine { amplitude: 2.798, delay: 0.475_303e-3, natural_frequency: 2733.33, damping: 0.039_92 };
/// One pinion turn: 27 mesh cycles at 1800 Hz (D 4.2).
const TURN: f64 = 27.0 / 1800.0;

fn off(found: f64, expected: f64) -> f64 {
    100.0 * (found / expected - 1.0).abs()
}

#[test]
fn peer_dissertation_4_5_numbers() {
    // Extrema of Figure 4.9(b), printed to three digits.
    for (i, printed) in [(1, 2.63), (2, -2.32), (3, 2.05)] {
        assert!((CRACK_20.extremum(i) - printed).abs() <= 0.005, "{i}");
    }
    // Times of the extrema in mesh cycles without delay: 0.161, 0.490, 0.820.
    let free = DampedSine { delay: 0.0, ..CRACK_20 };
    let half = 0.5 / free.damped_frequency();
    for (k, printed) in [(0, 0.161), (1, 0.490), (2, 0.820)] {
        let cycles = (free.time_of_maximum() + f64::from(k) * half) * 1800.0;
        assert!((cycles - printed).abs() <= 0.0006, "{cycles}");
    }
    // RMS 0.435736 um from 50 steps a mesh cycle, both ends counted. The inputs are printed to
    // A +- 1.8e-4 and zeta +- 1.25e-4 (half of it in the RMS): 2.4e-4 together.
    let y = CRACK_20.samples(27 * 50 + 1, 50.0 * 1800.0).unwrap();
    close(rms(&y).unwrap(), 0.435_736, 2.4e-4);
    // Deviation of the closed forms from the sampled ones: 0.03, 0.04, 0.14 %.
    assert_eq!(CRACK_20.half_cycles(TURN), 82);
    let form = CRACK_20.density(82).unwrap().indicators().unwrap();
    assert_eq!(format!("{:.2}", off(form.rms, rms(&y).unwrap())), "0.03");
    assert_eq!(format!("{:.2}", off(form.fm4, kurtosis(&y).unwrap())), "0.04");
    assert_eq!(format!("{:.2}", off(form.m8a, m8a(&y).unwrap())), "0.14");
}

#[test]
fn analytic_exact_integrals_match_fine_samples() {
    // The rectangle rule over a record with a kink in the slope converges as 1/N^2.
    let y = CRACK_20.samples(270_000, 270_000.0 / TURN).unwrap();
    let form = CRACK_20.exact_indicators(TURN).unwrap();
    close(form.rms, rms(&y).unwrap(), 1e-8);
    close(form.fm4, kurtosis(&y).unwrap(), 1e-8);
    close(form.m6a, m6a(&y).unwrap(), 1e-8);
    close(form.m8a, m8a(&y).unwrap(), 1e-8);
    close(form.mean, y.iter().sum::<f64>() / 270_000.0, 1e-6);
    // int e^(-2at) sin^2 wt dt = (1 - zeta^2) / (4 a) for a response that has died away.
    let a = CRACK_20.damping * CRACK_20.natural_frequency * 2.0 * PI;
    let square = CRACK_20.amplitude.powi(2) * (1.0 - CRACK_20.damping.powi(2)) / (4.0 * a * TURN);
    close(form.rms, square.sqrt(), 1e-8);
}

/// The density's moments by quadrature: `y = A_i sin u` takes the singularity out of each term, and u
/// in 0..pi/2 gets 400 midpoints.
fn quadrature(first: f64, delta: f64, n: usize) -> ClosedForm {
    let mut raw = [0.0; 9];
    for i in 0..n {
        let a = first * (-1.0_f64).powi(i as i32) * (-delta * i as f64 / 2.0).exp();
        for k in 0..400 {
            let u = (f64::from(k) + 0.5) * PI / 800.0;
            for (p, m) in raw.iter_mut().enumerate() {
                *m += (a * u.sin()).powi(p as i32) / (400 * n) as f64;
            }
        }
    }
    ClosedForm::from_raw_moments(&raw).unwrap()
}

#[test]
fn analytic_closed_forms_match_quadrature_of_the_density() {
    // Midpoint rule with 400 points for sin^p on a quarter: (pi/2/400)^2 p / 24 = 5e-6 at p = 8.
    for n in [1, 2, 3, 10, 81, 82] {
        let delta = 0.251;
        let form = AmplitudeDensity::new(2.63, delta, n).unwrap().indicators().unwrap();
        let numeric = quadrature(2.63, delta, n);
        close(form.rms, numeric.rms, 1e-5);
        close(form.mean, numeric.mean, 1e-5);
        close(form.fm4, numeric.fm4, 1e-4);
        close(form.m8a, numeric.m8a, 1e-4);
    }
}

/// D 4.13d and 4.13e term by term, with the coefficient of `mu^6` as an argument.
fn printed(first: f64, delta: f64, n: usize, c: f64) -> (f64, f64) {
    let nf = n as f64;
    let even = |p: f64| (0..n).map(|i| (-p * delta * i as f64).exp()).sum::<f64>();
    let odd = |p: f64| (0..n).map(|i| (-1.0_f64).powi(i as i32) * (-p * delta * i as f64 / 2.0).exp()).sum::<f64>();
    let a = first;
    let mu = 2.0 * a / (nf * PI) * odd(1.0);
    let variance = a * a / (2.0 * nf) * even(1.0) - mu * mu;
    let fm4 = 3.0 * a.powi(4) / (8.0 * nf) * even(2.0) + 3.0 * mu * mu * a * a / nf * even(1.0)
        - 3.0 * mu.powi(4)
        - 16.0 * mu * a.powi(3) / (3.0 * nf * PI) * odd(3.0);
    let m8a = 35.0 * a.powi(8) / (128.0 * nf) * even(4.0)
        + 35.0 * mu.powi(2) * a.powi(6) / (4.0 * nf) * even(3.0)
        + 105.0 * mu.powi(4) * a.powi(4) / (4.0 * nf) * even(2.0)
        + c * mu.powi(6) * a * a / nf * even(1.0)
        - 7.0 * mu.powi(8)
        - 224.0 * mu.powi(5) * a.powi(3) / (3.0 * nf * PI) * odd(3.0)
        - 896.0 * mu.powi(3) * a.powi(5) / (15.0 * nf * PI) * odd(5.0)
        - 256.0 * mu * a.powi(7) / (35.0 * nf * PI) * odd(7.0);
    (fm4 / variance.powi(2), m8a / variance.powi(4))
}

#[test]
fn peer_dissertation_4_13_coefficients() {
    for n in [1, 2, 7, 82] {
        let form = AmplitudeDensity::new(2.63, 0.251, n).unwrap().indicators().unwrap();
        let (fm4, m8a) = printed(2.63, 0.251, n, 14.0);
        close(fm4, form.fm4, 1e-9);
        close(m8a, form.m8a, 1e-9);
    }
    // The printed 17 instead of C(8,6)/2 = 14: wrong for few half cycles, invisible for 82.
    let (_, wrong) = printed(2.63, 0.251, 1, 17.0);
    let right = AmplitudeDensity::new(2.63, 0.251, 1).unwrap().indicators().unwrap().m8a;
    assert!(wrong / right > 2.0, "{wrong} {right}");
    let (_, wrong) = printed(2.63, 0.251, 82, 17.0);
    let (_, right) = printed(2.63, 0.251, 82, 14.0);
    assert!((wrong / right - 1.0).abs() < 1e-12);
}

#[test]
fn invariant_density_is_a_density() {
    for n in [1, 2, 5, 82] {
        let f = AmplitudeDensity::new(2.63, 0.251, n).unwrap();
        let total = f.probability_between_zero_and(9.0) + f.probability_between_zero_and(-9.0);
        close(total, 1.0, 1e-13);
        assert_eq!(f.density(2.64), 0.0);
        // The density is the derivative of the probability: central differences half way (in the
        // logarithm) between extrema of one sign, where the third derivative leaves about 1e-6.
        for m in [0, 1, 3] {
            let up = 2.63 * (-0.251 * (f64::from(m) + 0.5)).exp();
            let down = -2.63 * (-0.251 * f64::from(m + 1)).exp();
            for y in [up, down] {
                let h = 1e-4 * y;
                let (low, high) = (y - h, y + h);
                let share = f.probability_between_zero_and(high) - f.probability_between_zero_and(low);
                assert!((share / (2.0 * h.abs()) - f.density(y)).abs() <= 1e-5 * f.density(y));
            }
        }
    }
    // D 4.6.1.2: near zero from below 2 / (3 pi A_2) = 0.092 for three half cycles.
    let three = AmplitudeDensity::new(2.63, CRACK_20.log_decrement(), 3).unwrap();
    assert!((three.density(-1e-9) - 0.092).abs() < 1e-3);
    assert!((three.density(-1e-9) - 2.0 / (3.0 * PI * 2.32)).abs() < 1e-4);
}

#[test]
fn peer_density_against_histogram() {
    // D 4.6.1.2: share of time in amplitude bands, from a million samples of the truncated signal.
    let free = DampedSine { delay: 0.0, ..CRACK_20 };
    let n = 82;
    let duration = n as f64 / 2.0 / free.damped_frequency();
    let y = free.samples(1_000_000, 1e6 / duration).unwrap();
    let f = free.density(n).unwrap();
    for (low, high) in [(0.05, 0.2), (0.2, 0.6), (0.6, 1.2), (-0.3, -0.05), (-1.5, -0.5)] {
        let share = y.iter().filter(|v| (low..high).contains(*v)).count() as f64 / 1e6;
        let predicted = (f.probability_between_zero_and(high) - f.probability_between_zero_and(low)).abs();
        // The approximation (constant amplitude within a half cycle) is good to about zeta.
        close(predicted, share, 0.04);
    }
}

#[test]
fn analytic_simplified_forms_are_the_limit() {
    // Mean dropped, series summed to infinity: with mean 0 and n large the full forms agree.
    let delta = 0.251;
    let n = 4000;
    let full = AmplitudeDensity::new(-1.5, delta, n).unwrap().indicators().unwrap();
    let simple = simplified_indicators(-1.5, delta, n as f64).unwrap();
    close(simple.rms, full.rms, 1e-12);
    close(simple.fm4, full.fm4, 2e-4);
    close(simple.m6a, full.m6a, 3e-4);
    close(simple.m8a, full.m8a, 4e-4);
    let double = simplified_indicators(3.0, delta, n as f64).unwrap();
    assert_eq!(double.fm4, simple.fm4);
    close(double.rms, 2.0 * simple.rms, 1e-14);
}

#[test]
fn peer_dissertation_figure_4_10_sensitivities() {
    // D 4.6.3: over each range of Figure 4.10 the RMS falls, FM4 and M8A rise.
    let of = |model: DampedSine, n: f64| simplified_indicators(model.extremum(1), model.log_decrement(), n).unwrap();
    let in_turn = |model: DampedSine| of(model, 2.0 * model.damped_frequency() * TURN);
    let steps = |from: f64, to: f64| (0..=20).map(move |k| from + (to - from) * f64::from(k) / 20.0);
    let damping: Vec<_> = steps(0.01, 0.2).map(|damping| in_turn(DampedSine { damping, ..CRACK_20 })).collect();
    let frequency: Vec<_> =
        steps(1000.0, 5000.0).map(|natural_frequency| in_turn(DampedSine { natural_frequency, ..CRACK_20 })).collect();
    let cycles: Vec<_> = steps(20.0, 160.0).map(|n| of(CRACK_20, n)).collect();
    for (name, study) in [("damping", &damping), ("frequency", &frequency), ("half cycles", &cycles)] {
        for pair in study.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            assert!(b.rms < a.rms && b.fm4 > a.fm4 && b.m8a > a.m8a, "{name}: {a:?} {b:?}");
        }
    }
    // The simplified forms say how: RMS as n^(-1/2), FM4 as n, M8A as n^3.
    let (first, last) = (&cycles[0], &cycles[20]);
    close(first.rms / last.rms, 8.0_f64.sqrt(), 1e-12);
    close(last.fm4 / first.fm4, 8.0, 1e-12);
    close(last.m8a / first.m8a, 512.0, 1e-12);
}

#[test]
fn analytic_fit_recovers_parameters() {
    let rate = 500.0 * 1800.0;
    let y = CRACK_20.samples(13_500, rate).unwrap();
    let fixed = fit(&y, rate, &FitOptions::amplitude_and_delay(2733.33, 0.039_92)).unwrap();
    assert_eq!(fixed.status, FitStatus::Converged);
    close(fixed.model.amplitude, 2.798, 1e-9);
    close(fixed.model.delay, 0.475_303e-3, 1e-9);
    assert!(fixed.residual_rms < 1e-9 && fixed.explained > 1.0 - 1e-12);
    let free = FitOptions { free_frequency: true, free_damping: true, ..FitOptions::amplitude_and_delay(2650.0, 0.06) };
    let found = fit(&y, rate, &free).unwrap();
    assert_eq!(found.status, FitStatus::Converged);
    close(found.model.natural_frequency, 2733.33, 1e-9);
    close(found.model.damping, 0.039_92, 1e-8);
    close(found.model.amplitude, 2.798, 1e-8);
}

#[test]
fn analytic_fit_in_noise_is_at_the_cramer_rao_bound() {
    // Known frequency and damping; A and t_d are nearly orthogonal, so var A = sigma^2 / <g,g>.
    let rate = 50.0 * 1800.0;
    let clean = CRACK_20.samples(1350, rate).unwrap();
    let energy: f64 = clean.iter().map(|v| v * v).sum::<f64>() / CRACK_20.amplitude.powi(2);
    let sigma = 0.1;
    let bound = sigma / energy.sqrt();
    let options = FitOptions::amplitude_and_delay(2733.33, 0.039_92);
    let errors: Vec<f64> = (0..200)
        .map(|seed| {
            let noise = gaussian(1350, 1000 + seed);
            let y: Vec<f64> = clean.iter().zip(noise).map(|(a, b)| a + sigma * b).collect();
            fit(&y, rate, &options).unwrap().model.amplitude - CRACK_20.amplitude
        })
        .collect();
    // 200 runs: 5 % a standard deviation of the estimate of the spread.
    close(rms(&errors).unwrap(), bound, 0.2);
}

#[test]
fn extreme_fit_inputs() {
    let options = FitOptions::amplitude_and_delay(100.0, 0.05);
    assert!(matches!(fit(&[0.0; 100], 1000.0, &options), Err(HumsError::Undefined { .. })));
    assert!(matches!(fit(&[1.0; 3], 1000.0, &options), Err(HumsError::TooShort { .. })));
    assert!(fit(&[f64::NAN; 100], 1000.0, &options).is_err());
    assert!(fit(&[1.0; 100], 150.0, &options).is_err());
    assert!(fit(&[1.0; 100], 1000.0, &FitOptions { damping: 1.0, ..options }).is_err());
    // A constant is not a ringing, but the least-squares answer exists and is finite.
    let constant = fit(&[1.0; 100], 1000.0, &options).unwrap();
    assert!(constant.model.amplitude.is_finite() && constant.explained < 0.9);
    assert!(AmplitudeDensity::new(0.0, 0.2, 5).is_err());
    assert!(AmplitudeDensity::new(1.0, 0.2, 0).is_err());
    assert!(CRACK_20.exact_indicators(1e-4).is_err());
}

fn three_modes() -> ModalResponse {
    let mode = |amplitude, phase, natural_frequency, damping| Mode { amplitude, phase, natural_frequency, damping };
    ModalResponse::new(vec![mode(1.0, 0.4, 700.0, 0.03), mode(0.6, -1.2, 1240.0, 0.02), mode(0.25, 2.9, 1300.0, 0.015)])
        .unwrap()
}

#[test]
fn analytic_indicators_of_three_modes() {
    let response = three_modes();
    let (n, duration, delay) = (400_000, 0.05, 0.01);
    // Midpoint samples; the response jumps at the delay, which lies on a cell edge.
    let y: Vec<f64> = (0..n).map(|i| response.value((f64::from(i) + 0.5) * duration / f64::from(n) - delay)).collect();
    let form = response.indicators(delay, duration).unwrap();
    close(form.rms, rms(&y).unwrap(), 1e-7);
    close(form.fm4, kurtosis(&y).unwrap(), 1e-7);
    close(form.m8a, m8a(&y).unwrap(), 1e-7);
    // One mode is the phenomenon-based model.
    let single = CRACK_20.modes().unwrap();
    for t in [0.0, 1e-4, 3e-3] {
        assert!((single.value(t) - CRACK_20.value(t + CRACK_20.delay)).abs() < 1e-12);
    }
}

#[test]
fn analytic_modal_fit_without_noise_is_exact() {
    let (rate, wanted) = (10_000.0, three_modes());
    let y: Vec<f64> = (0..240).map(|i| wanted.value(f64::from(i) / rate)).collect();
    for (method, tolerance) in [(Method::MatrixPencil, 1e-9), (Method::Prony, 1e-6)] {
        let found = fit_modes(&y, rate, 3, method).unwrap();
        assert_eq!((found.modes.len(), found.discarded), (3, 0));
        assert!(found.residual_rms < 1e-9);
        for (f, w) in found.modes.iter().zip(wanted.modes()) {
            close(f.natural_frequency, w.natural_frequency, tolerance);
            close(f.damping, w.damping, tolerance);
            close(f.amplitude, w.amplitude, tolerance);
            close(f.phase, w.phase, tolerance);
        }
    }
    // Six singular values stand out of rounding.
    let found = fit_modes(&y, rate, 5, Method::MatrixPencil).unwrap();
    assert!(found.singular_values[5] > 1e-4 && found.singular_values[6] < 1e-12);
}

#[test]
fn peer_matrix_pencil_beats_prony_in_noise() {
    let (rate, wanted) = (10_000.0, three_modes());
    let clean: Vec<f64> = (0..240).map(|i| wanted.value(f64::from(i) / rate)).collect();
    let mut errors = [0.0, 0.0];
    for seed in 0..10 {
        let noise = gaussian(240, seed);
        let y: Vec<f64> = clean.iter().zip(noise).map(|(a, b)| a + 0.01 * b).collect();
        for (error, method) in errors.iter_mut().zip([Method::MatrixPencil, Method::Prony]) {
            *error += fit_modes(&y, rate, 3, method).map_or(1.0, |f| (f.modes[0].damping / 0.03 - 1.0).abs() / 10.0);
        }
    }
    assert!(errors[0] < 0.01, "{errors:?}");
    assert!(errors[1] > 5.0 * errors[0], "{errors:?}");
}

#[test]
fn extreme_modal_fit_inputs() {
    assert!(matches!(fit_modes(&[0.0; 50], 1.0, 2, Method::Prony), Err(HumsError::Undefined { .. })));
    assert!(fit_modes(&[1.0; 50], 1.0, 0, Method::Prony).is_err());
    assert!(fit_modes(&[1.0; 10], 1.0, 2, Method::MatrixPencil).is_err());
    assert!(fit_modes(&vec![1.0; 5000], 1.0, 2, Method::MatrixPencil).is_err());
    // A constant does not ring; it is refused or fitted by something finite, never NaN.
    for method in [Method::Prony, Method::MatrixPencil] {
        if let Ok(found) = fit_modes(&[1.0; 50], 1.0, 2, method) {
            assert!(found.modes.iter().all(|m| m.amplitude.is_finite() && m.damping > 0.0));
        }
    }
    let y: Vec<f64> = three_modes().modes().iter().map(|m| m.value(0.0)).collect();
    assert!(max_difference(&y, &[0.4_f64.cos(), 0.6 * 1.2_f64.cos(), 0.25 * 2.9_f64.cos()]) < 1e-15);
}

/// The printed coefficient 17 of D 4.13e for the derivation's 14, on one half cycle: a half sine, whose moments are known.
#[test]
fn analytic_misprint_of_the_eighth_moment() {
    let density = AmplitudeDensity::new(1.0, 0.25, 1).unwrap();
    let found = density.indicators().unwrap();
    // E[(sin - 2/pi)^8] / var^4, by Simpson's rule over half a turn.
    let n = 2000;
    let mean = 2.0 / std::f64::consts::PI;
    let moment = |p: i32| -> f64 {
        (0..=n)
            .map(|k| {
                let weight = if k == 0 || k == n {
                    1.0
                } else if k % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                let theta = std::f64::consts::PI * f64::from(k) / f64::from(n);
                weight * (theta.sin() - mean).powi(p)
            })
            .sum::<f64>()
            / (3.0 * f64::from(n))
    };
    let variance = moment(2);
    assert!((found.m8a / (moment(8) / variance.powi(4)) - 1.0).abs() < 1e-9);
    assert!((found.m8a - 15.77).abs() < 0.005, "{}", found.m8a);
    // 17 - 14 times mu^6 A_1^2 / n more.
    let printed = found.m8a + 3.0 * mean.powi(6) / variance.powi(4);
    assert!((printed - 2497.3).abs() < 0.05, "{printed}");
}
