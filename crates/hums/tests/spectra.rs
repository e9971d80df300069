//! Spectra, envelopes and demodulation of signals with known lines.

mod common;
use common::{close, gaussian, max_difference, sine};
use hums::HumsError;
use hums::envelope::{demodulate, envelope, envelope_spectrum};
use hums::spectrum::{Spectrum, Window, spectrogram, welch};
use std::f64::consts::TAU;

#[test]
fn analytic_lines_are_exact_on_the_grid() {
    for window in [Window::Rectangular, Window::Hann, Window::FlatTop] {
        let x = sine(1000, 37.0, 1.7, 0.3);
        let spectrum = Spectrum::of(&x, window).unwrap();
        close(spectrum.amplitude(37).unwrap(), 1.7, 1e-12);
        assert!(spectrum.amplitude(60).unwrap() < 1e-12);
        assert!(matches!(spectrum.amplitude(501), Err(HumsError::OrderNotResolved { highest: 500, .. })));
    }
}

#[test]
fn analytic_scalloping_loss() {
    // Half-way between bins: sinc(1/2) = 2/pi (3.92 dB); Hann 8/(3 pi) (1.42 dB). The other
    // half of the line leaks O(1/k) of itself: 1e-4 at order 2000.
    let x = sine(16_384, 2000.5, 1.0, 0.0);
    let at = |w| Spectrum::of(&x, w).unwrap().amplitude(2000).unwrap();
    close(at(Window::Rectangular), 2.0 / std::f64::consts::PI, 1e-3);
    close(at(Window::Hann), 8.0 / (3.0 * std::f64::consts::PI), 1e-4);
    close(at(Window::FlatTop), 1.0, 2e-3);
}

#[test]
fn invariant_parseval() {
    for n in [1000, 1001] {
        let x = gaussian(n, 21);
        let amplitudes = Spectrum::of(&x, Window::Rectangular).unwrap().amplitudes();
        let power: f64 = amplitudes
            .iter()
            .enumerate()
            .map(|(k, a)| {
                let whole = k == 0 || 2 * k == n;
                if whole { a * a } else { a * a / 2.0 }
            })
            .sum();
        let mean_square = x.iter().map(|v| v * v).sum::<f64>() / n as f64;
        close(power, mean_square, 1e-12);
    }
}

#[test]
fn analytic_white_noise_density() {
    // Unit variance over 0..fs/2: density 2/fs; 1000 segments leave about 3 % a bin, the mean over
    // 200 bins far less.
    let x = gaussian(400_000, 9);
    let (_, density) = welch(&x, 1000.0, 400, Window::Hann).unwrap();
    let inner = &density[2..199];
    close(inner.iter().sum::<f64>() / inner.len() as f64, 2e-3, 0.01);
    let map = spectrogram(&x, 1000.0, 400, 400, Window::Hann).unwrap();
    assert_eq!(map.times.len(), 1000);
    close(map.times[0], 0.2, 1e-12);
    assert_eq!(map.density.len(), 1000 * map.frequencies.len());
}

#[test]
fn analytic_envelope_of_modulated_tone() {
    let n = 2048;
    let modulation = |i: usize| 1.0 + 0.4 * (TAU * 3.0 * i as f64 / n as f64).cos();
    let x: Vec<f64> = (0..n).map(|i| modulation(i) * (TAU * 50.0 * i as f64 / n as f64).cos()).collect();
    let expected: Vec<f64> = (0..n).map(modulation).collect();
    assert!(max_difference(&envelope(&x).unwrap(), &expected) < 1e-12);
    let spectrum = envelope_spectrum(&x).unwrap();
    close(spectrum.amplitude(3).unwrap(), 0.4, 1e-12);
}

#[test]
fn analytic_demodulation_recovers_amplitude_and_phase() {
    // Phase modulation of index 0.2 at order 2: Bessel sidebands die out as 0.2^k / (2^k k!),
    // below 1e-13 at the eighth, hence the half width of 20 orders.
    let n = 4096;
    let theta = |i: usize| TAU * i as f64 / n as f64;
    let amplitude = |i: usize| 2.0 + 0.5 * (3.0 * theta(i)).sin();
    let phase = |i: usize| 0.7 + 0.2 * (2.0 * theta(i)).sin();
    let x: Vec<f64> =
        (0..n).map(|i| amplitude(i) * (60.0 * theta(i) + phase(i)).cos() + 3.0 * (120.0 * theta(i)).cos()).collect();
    let d = demodulate(&x, 60, 25).unwrap();
    let a: Vec<f64> = (0..n).map(amplitude).collect();
    let p: Vec<f64> = (0..n).map(phase).collect();
    assert!(max_difference(&d.amplitude, &a) < 1e-11);
    assert!(max_difference(&d.phase, &p) < 1e-11);
    // The second harmonic is outside the band.
    let rest: Vec<f64> = x.iter().zip(&d.band).map(|(x, b)| x - b).collect();
    close(Spectrum::of(&rest, Window::Rectangular).unwrap().amplitude(120).unwrap(), 3.0, 1e-12);
}

#[test]
fn extreme_bands_are_checked() {
    let x = sine(128, 20.0, 1.0, 0.0);
    assert!(matches!(demodulate(&x, 20, 20), Err(HumsError::Parameter { .. })));
    assert!(matches!(demodulate(&x, 50, 20), Err(HumsError::OrderNotResolved { .. })));
    assert!(welch(&x, 0.0, 64, Window::Hann).is_err());
    assert!(welch(&x, 1.0, 256, Window::Hann).is_err());
    assert!(welch(&x, 1.0, 1, Window::Hann).is_err());
    assert!(spectrogram(&x, 1.0, 64, 0, Window::Hann).is_err());
}
