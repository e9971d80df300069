//! Signals: interpolation to angle, and windows and segments of spectra.
//!
//! Interpolation: a shaft whose speed varies by a tenth, a record of known content (mesh lines at 0.03, 0.26 and 0.6 of the Nyquist
//! frequency, a band-limited knock), averaged; errors against the same content at the exact angles. Spectra: a tone at the worst place
//! between two lines, and the scatter of a density of white noise.

use std::f64::consts::{PI, TAU};
use std::time::Instant;

use hums::difference::RemovalRule;
use hums::indicator::{GearAnalyzer, Indicator, SignalKind};
use hums::resample::Interpolation;
use hums::spectrum::{Spectrum, Window, welch};
use hums::tachometer::Shaft;
use hums::tsa::{TsaOptions, average};

use super::report::{Entry, Report};

/// Sampling rate (Hz), turns a second, teeth.
const RATE: f64 = 20_480.0;
const SPEED: f64 = 10.0;
const TEETH: f64 = 27.0;
/// Samples of the record: 6.4 s.
const SAMPLES: usize = 1 << 17;
/// Samples of the average: all orders up to the Nyquist frequency at the fastest.
const PER_TURN: usize = 4096;
/// Repetitions, of which the fastest counts.
const REPEAT: usize = 5;

/// Runs both studies.
pub fn run() -> anyhow::Result<()> {
    resampling()?;
    spectra()
}

/// Turns at a time: the speed varies by a tenth, in 2 s.
fn turn(t: f64) -> f64 {
    SPEED * t + 0.1 * SPEED / PI * (1.0 - (PI * t).cos())
}

/// Vibration at a turn; the knock is a Gaussian pulse of order 400 that ends far below the Nyquist frequency.
fn content(turn: f64) -> f64 {
    let since = (turn + 0.1).rem_euclid(1.0) - 0.5;
    let knock = 0.2 * (-(since / 0.01).powi(2)).exp() * (400.0 * TAU * since).cos();
    let line = |order: f64, amplitude: f64| amplitude * (order * TAU * turn).cos();
    line(TEETH, 1.0) + line(10.0 * TEETH, 0.3) + line(23.0 * TEETH, 0.1) + knock
}

fn fastest<T>(mut work: impl FnMut() -> hums::Result<T>) -> hums::Result<(T, f64)> {
    let mut best: Option<(T, f64)> = None;
    for _ in 0..REPEAT {
        let begin = Instant::now();
        let value = work()?;
        let time = begin.elapsed().as_secs_f64();
        if best.as_ref().is_none_or(|(_, least)| time < *least) {
            best = Some((value, time));
        }
    }
    best.ok_or(hums::HumsError::TooShort { what: "repetitions", needed: 1, found: 0 })
}

fn rms_of_difference(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    (squares / b.iter().map(|b| b * b).sum::<f64>()).sqrt()
}

fn resampling() -> anyhow::Result<()> {
    let record: Vec<f64> = (0..SAMPLES).map(|i| content(turn(i as f64 / RATE))).collect();
    // An encoder of 720 pulses: its own error is below that of any interpolation here.
    let pulses = 720.0;
    let count = (turn(SAMPLES as f64 / RATE) * pulses) as usize;
    let times: Vec<f64> = (0..count).map(|k| time_of(k as f64 / pulses)).collect();
    let shaft = Shaft::from_pulses(&times, pulses)?;
    let exact: Vec<f64> = (0..PER_TURN).map(|k| content(k as f64 / PER_TURN as f64)).collect();
    let analyzer = GearAnalyzer::new(PER_TURN, &RemovalRule::sidebands(TEETH as usize, 1))?;
    let fm4 = |average: &[f64]| analyzer.analyze(average)?.value(Indicator::Fm4, SignalKind::Difference);
    let highest = |average: &[f64]| Spectrum::of(average, Window::Rectangular)?.amplitude(23 * TEETH as usize);
    let (true_fm4, true_line) = (fm4(&exact)?, highest(&exact)?);
    let band = |half_width, beta| Interpolation::BandLimited { half_width, beta };
    let mut methods = vec![
        ("polynomial".to_owned(), "linear".to_owned(), Interpolation::Linear),
        ("polynomial".to_owned(), "cubic spline".to_owned(), Interpolation::CubicSpline),
    ];
    for (beta, widths) in [
        (5.0, &[3, 4, 6, 8, 12][..]),
        (8.0, &[6, 8, 12, 16, 24]),
        (12.0, &[12, 16, 24, 32, 48]),
        (16.0, &[24, 32, 48, 64]),
    ] {
        methods
            .extend(widths.iter().map(|&l| (format!("band-limited, beta {beta}"), format!("L = {l}"), band(l, beta))));
    }
    let mut entries = Vec::new();
    for (family, setting, interpolation) in methods {
        let options = TsaOptions { interpolation, ..TsaOptions::per_turn(PER_TURN) };
        let (found, time) = fastest(|| average(&record, RATE, &shaft, &options))?;
        let found = &found.samples;
        let errors = vec![
            rms_of_difference(found, &exact),
            (highest(found)? / true_line - 1.0).abs(),
            (fm4(found)? / true_fm4 - 1.0).abs(),
        ];
        println!("{family:>24} {setting:>7}: {:.4} s {errors:?}", time);
        entries.push(Entry { family, setting, is_default: interpolation == Interpolation::default(), time, errors });
    }
    Report {
        name: "hums-resampling",
        title: "Synchronous average: error against run time of interpolation".into(),
        text: format!(
            "Written by `cargo xtask work-precision hums`. {SAMPLES} samples at {RATE} Hz of a shaft at {SPEED} Hz whose speed varies by a tenth, averaged to\n\
             {PER_TURN} samples a turn on one core. Content: mesh lines at 0.03, 0.26 and 0.6 of the Nyquist frequency and a knock; errors against this content\n\
             at the exact angles. The shape beta sets the ripple that is left, the width L how close to the Nyquist frequency it holds. Times are the\n\
             fastest of {REPEAT} runs on a machine that others used as well; 720 encoder pulses a turn give the angle."
        ),
        quantities: vec!["the average (rms)", "the amplitude at 0.6 of the Nyquist frequency", "FM4"],
        entries,
    }
    .write()
}

/// Time of a turn, by Newton's method.
fn time_of(wanted: f64) -> f64 {
    let mut t = wanted / SPEED;
    for _ in 0..50 {
        let step = (turn(t) - wanted) / (SPEED * (1.0 + 0.1 * (PI * t).sin()));
        t -= step;
        if step.abs() < 1e-16 {
            break;
        }
    }
    t
}

/// Nearly Gaussian noise of unit variance.
fn noise(count: usize) -> Vec<f64> {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
}

fn spectra() -> anyhow::Result<()> {
    let white = noise(1 << 20);
    let mut entries = Vec::new();
    for (family, window) in
        [("rectangular", Window::Rectangular), ("Hann", Window::Hann), ("flat top", Window::FlatTop)]
    {
        for power in 6..=16 {
            let segment = 1_usize << power;
            let (density, time) = fastest(|| welch(&white, 1.0, segment, window))?;
            // One-sided, unit variance: 2 at all frequencies but the first and the last few, which the mean and the window touch.
            let inner = &density.1[5..density.1.len() - 5];
            let scatter = (inner.iter().map(|d| (d / 2.0 - 1.0).powi(2)).sum::<f64>() / inner.len() as f64).sqrt();
            let tone: Vec<f64> =
                (0..segment).map(|i| (TAU * (segment as f64 / 8.0 + 0.5) * i as f64 / segment as f64).cos()).collect();
            let amplitudes = Spectrum::of(&tone, window)?.amplitudes();
            let worst = (amplitudes.iter().copied().fold(0.0, f64::max) - 1.0).abs();
            let errors = vec![worst, scatter];
            println!("{family:>12} {segment:>6}: {time:.4} s {errors:?}");
            // The caller chooses the segment.
            entries.push(Entry {
                family: family.into(),
                setting: segment.to_string(),
                is_default: false,
                time,
                errors,
            });
        }
    }
    Report {
        name: "hums-spectra",
        title: "Spectra: error against run time of windows and segments".into(),
        text: "Written by `cargo xtask work-precision hums`. Welch's density of 2^20 samples on one core, segments overlapping by half. The amplitude is that of\n\
               a tone midway between two lines, the worst case; on a line, as mesh orders of a synchronous average are, every window is exact. The density is of\n\
               white noise: its scatter falls with the square root of the number of segments, its resolution with their length."
            .into(),
        quantities: vec!["a tone's amplitude between lines", "a density (scatter)"],
        entries,
    }
    .write()
}
