//! Signals as they should not be: every entry point gives a finite value or a reason.

mod common;
use common::{close, gaussian, max_difference, sine};
use hums::HumsError;
use hums::difference::{RemovalRule, split};
use hums::envelope::{analytic_signal, demodulate, envelope, envelope_spectrum};
use hums::indicator::basic::Ends;
use hums::indicator::trend::{Memory, QuasiKurtosis};
use hums::indicator::{Entry, GearAnalyzer, Indicator, SignalKind, basic, signal_indicators};
use hums::moments::{MomentAccumulator, Moments};
use hums::quality::ChannelQuality;
use hums::resample::{Interpolation, to_angle};
use hums::signal::{detrend, fill_gaps, longest_finite_run};
use hums::spectrum::{Spectrum, Window, spectrogram};
use hums::tachometer::{PulseOptions, Shaft, repair};
use hums::tsa::{TsaOptions, average};
use proptest::prelude::*;

fn finite_or_reason(table: &[Entry]) {
    for entry in table {
        if let Ok(value) = &entry.value {
            assert!(value.is_finite(), "{entry:?}");
        }
    }
}

fn value(table: &[Entry], indicator: Indicator) -> &hums::Result<f64> {
    &table.iter().find(|e| e.indicator == indicator).unwrap().value
}

#[test]
fn extreme_zeros() {
    let table = signal_indicators(&[0.0; 1000], SignalKind::Raw).unwrap();
    finite_or_reason(&table);
    for zero in [Indicator::Mean, Indicator::Rms, Indicator::Peak, Indicator::PeakToPeak] {
        assert_eq!(value(&table, zero), &Ok(0.0));
    }
    for undefined in [Indicator::CrestFactor, Indicator::Skewness, Indicator::Kurtosis, Indicator::EnergyOperator] {
        assert!(matches!(value(&table, undefined), Err(HumsError::Undefined { .. })));
    }
    let analyzer = GearAnalyzer::new(1000, &RemovalRule::sidebands(27, 1)).unwrap();
    finite_or_reason(&analyzer.analyze(&[0.0; 1000]).unwrap().table);
    assert!(envelope(&[0.0; 10]).unwrap().iter().all(|x| *x == 0.0));
}

#[test]
fn extreme_constant_signals_are_constant_at_any_size() {
    // 0.1 is not a binary number: sums of it round, and must still count as constant.
    for c in [0.1, -1e-300, 1e300, 5e-324, f64::MAX] {
        for n in [1, 2, 3, 7, 1000, 5000] {
            let x = vec![c; n];
            let table = signal_indicators(&x, SignalKind::Raw).unwrap();
            finite_or_reason(&table);
            close(value(&table, Indicator::Rms).clone().unwrap(), c.abs(), 1e-15);
            close(value(&table, Indicator::CrestFactor).clone().unwrap(), 1.0, 1e-15);
            assert!(matches!(value(&table, Indicator::Kurtosis), Err(HumsError::Undefined { .. })));
            let quality = ChannelQuality::of(&x);
            assert!(quality.is_constant() && quality.clipped.count == 0 && quality.dropouts.count == 0);
        }
    }
    // sums of the transform overflow
    let largest = [f64::MAX; 1000];
    assert!(matches!(Spectrum::of(&largest, Window::Hann), Err(HumsError::OutOfRange { .. })));
    let analyzer = GearAnalyzer::new(1000, &RemovalRule::sidebands(27, 1)).unwrap();
    assert!(matches!(analyzer.analyze(&largest), Err(HumsError::OutOfRange { .. })));
    // NA4 of constant residuals has no reference.
    let mut na4 = QuasiKurtosis::new(Memory::Running).unwrap();
    assert!(matches!(na4.update(&[0.1; 50]), Err(HumsError::Undefined { .. })));
}

#[test]
fn extreme_one_and_two_samples() {
    let table = signal_indicators(&[3.0], SignalKind::Raw).unwrap();
    finite_or_reason(&table);
    assert_eq!(value(&table, Indicator::Rms), &Ok(3.0));
    assert!(matches!(value(&table, Indicator::EnergyOperator), Err(HumsError::TooShort { needed: 3, found: 1, .. })));
    close(basic::kurtosis(&[1.0, 2.0]).unwrap(), 1.0, 1e-15);
    for window in [Window::Rectangular, Window::Hann, Window::FlatTop] {
        assert_eq!(Spectrum::of(&[3.0], window).unwrap().amplitudes(), [3.0]);
    }
    assert_eq!(envelope(&[3.0]).unwrap(), [3.0]);
    assert!(split(&[1.0], &RemovalRule::sidebands(1, 0)).is_err());
    assert!(GearAnalyzer::new(2, &RemovalRule::sidebands(1, 1)).is_ok_and(|a| {
        finite_or_reason(&a.analyze(&[1.0, 2.0]).unwrap().table);
        true
    }));
}

#[test]
fn extreme_empty_signals_are_refused() {
    assert!(matches!(basic::rms(&[]), Err(HumsError::TooShort { .. })));
    assert!(signal_indicators(&[], SignalKind::Raw).is_err());
    assert!(Spectrum::of(&[], Window::Hann).is_err());
    assert!(analytic_signal(&[]).is_err() && envelope_spectrum(&[]).is_err());
    assert!(detrend(&mut [], true).is_err());
    assert!(MomentAccumulator::default().finish().is_err());
    let quality = ChannelQuality::of(&[]);
    assert!(!quality.is_clean() && quality.range.is_none() && !quality.is_constant());
    assert_eq!(longest_finite_run(&[]), 0..0);
}

#[test]
fn extreme_gaps_are_named_filled_or_refused() {
    let mut x = sine(1000, 5.0, 1.0, 0.2);
    x[300] = f64::NAN;
    x[301] = f64::INFINITY;
    x[999] = f64::NEG_INFINITY;
    let index = |e: &hums::Result<f64>| match e {
        Err(HumsError::NotFinite { index, .. }) => Some(*index),
        _ => None,
    };
    for found in [
        basic::rms(&x),
        basic::kurtosis(&x),
        basic::energy_operator(&x, Ends::Cyclic),
        basic::normalized_moment(&x, 3.0),
    ] {
        assert_eq!(index(&found), Some(300), "{found:?}");
    }
    assert!(Spectrum::of(&x, Window::Hann).is_err());
    assert!(envelope(&x).is_err() && demodulate(&x, 20, 5).is_err());
    assert!(spectrogram(&x, 1.0, 100, 50, Window::Hann).is_err());
    assert!(GearAnalyzer::new(1000, &RemovalRule::sidebands(27, 1)).unwrap().analyze(&x).is_err());
    let gaps = ChannelQuality::of(&x).gaps;
    assert_eq!((gaps.count, gaps.samples, gaps.longest, gaps.first), (2, 3, 2, Some(300)));
    let before = x.clone();
    assert!(fill_gaps(&mut x, 1).is_err());
    assert!(x.iter().zip(&before).all(|(a, b)| a.to_bits() == b.to_bits()));
    assert_eq!(fill_gaps(&mut x, 2).unwrap(), 3);
    // Straight lines across two samples of a sine of 200 samples a period: h^2 w^2 / 8 = 1.2e-3.
    assert!(max_difference(&x[..999], &sine(1000, 5.0, 1.0, 0.2)[..999]) < 1.3e-3);
    assert!(fill_gaps(&mut [f64::NAN; 4], 10).is_err());
    assert_eq!(longest_finite_run(&before), 302..999);
}

#[test]
fn extreme_clipped_signals() {
    let x: Vec<f64> = sine(10_000, 50.0, 1.0, 0.0).iter().map(|v| v.clamp(-0.8, 0.8)).collect();
    let quality = ChannelQuality::of(&x);
    assert_eq!(quality.clipped.count, 100);
    assert!(!quality.is_clean());
    // RMS of a sine clipped at c = sin a: 1/2 - a/pi ... by parts over a quarter period.
    let a = 0.8_f64.asin();
    let square = (a - a.sin() * a.cos() + 2.0 * 0.64 * (std::f64::consts::FRAC_PI_2 - a)) / std::f64::consts::PI;
    close(basic::rms(&x).unwrap(), square.sqrt(), 1e-4);
    assert_eq!(ChannelQuality::of(&sine(10_000, 50.0, 1.0, 0.1)).clipped.count, 0);
}

#[test]
fn extreme_whole_numbers_of_24_bits() {
    // Raw counts about a large offset: the moments must not lose digits to it.
    let full = 8_388_607.0;
    let counts: Vec<f64> = gaussian(50_000, 40).iter().map(|g| (g * 20.0).round() + full - 200.0).collect();
    let centred: Vec<f64> = counts.iter().map(|c| c - (full - 200.0)).collect();
    for of in [basic::kurtosis, basic::m6a, basic::m8a] {
        close(of(&counts).unwrap(), of(&centred).unwrap(), 1e-9);
    }
    // The mean of counts of 2^23 is rounded to 1e-9 of them, 5e-11 sigma; skewness moves by 3 times that.
    let skewness = basic::skewness(&counts).unwrap() - basic::skewness(&centred).unwrap();
    assert!(skewness.abs() < 1e-9);
    let scaled: Vec<f64> = counts.iter().map(|c| c / 8_388_608.0).collect();
    close(basic::kurtosis(&scaled).unwrap(), basic::kurtosis(&counts).unwrap(), 1e-12);
    assert_eq!(Moments::of(&counts).unwrap().count(), 50_000);
}

#[test]
fn extreme_scales_do_not_overflow() {
    let x = gaussian(4096, 41);
    let kurtosis = basic::m8a(&x).unwrap();
    for scale in [1e-300, 1e-60, 1e60, 1e300] {
        let y: Vec<f64> = x.iter().map(|v| v * scale).collect();
        close(basic::m8a(&y).unwrap(), kurtosis, 1e-9);
        close(
            basic::energy_operator(&y, Ends::Cyclic).unwrap(),
            basic::energy_operator(&x, Ends::Cyclic).unwrap(),
            1e-9,
        );
        finite_or_reason(&signal_indicators(&y, SignalKind::Difference).unwrap());
        let analyzer = GearAnalyzer::new(4096, &RemovalRule::sidebands(27, 2)).unwrap();
        finite_or_reason(&analyzer.analyze(&y).unwrap().table);
    }
}

proptest! {
    #[test]
    fn extreme_any_finite_signal_gives_values_or_reasons(
        x in prop::collection::vec(prop_oneof![
            any::<f64>().prop_filter("finite", |v| v.is_finite()),
            -10.0..10.0_f64,
            Just(0.0),
        ], 3..80)
    ) {
        match signal_indicators(&x, SignalKind::Difference) {
            Ok(table) => finite_or_reason(&table),
            Err(e) => prop_assert!(matches!(e, HumsError::OutOfRange { .. }), "{e}"),
        }
        if let Ok(a) = GearAnalyzer::new(x.len(), &RemovalRule::sidebands(x.len() / 4 + 1, 1))
            && let Ok(analysis) = a.analyze(&x)
        {
            finite_or_reason(&analysis.table);
        }
    }

    #[test]
    fn extreme_any_tachometer_gives_averages_or_reasons(
        steps in prop::collection::vec(prop_oneof![0.0..2.0_f64, 1e-320..1e300_f64, Just(1.0)], 1..40),
        start in prop_oneof![-50.0..50.0_f64, Just(-1e15)],
        per_turn in prop_oneof![0.1..8.0_f64, 1e-320..1e300_f64],
        period in prop_oneof![0.1..3.0_f64, 1e-300..1e300_f64],
        interpolation in prop_oneof![
            Just(Interpolation::Linear), Just(Interpolation::CubicSpline), Just(Interpolation::default())
        ],
    ) {
        let x = gaussian(400, 1);
        let times: Vec<f64> = steps.iter().scan(start, |t, d| { *t += d; Some(*t) }).collect();
        let shafts = [
            Shaft::from_pulses(&times, per_turn),
            repair(&times).and_then(|p| Shaft::from_repaired(&p, per_turn)),
            Shaft::from_channel(&times, 1.0, per_turn, &PulseOptions::default()).map(|s| s.0),
        ];
        for shaft in shafts.into_iter().flatten() {
            let options = TsaOptions {
                period_turns: period,
                interpolation,
                ..TsaOptions::per_turn(32)
            };
            if let Ok(average) = average(&x, 10.0, &shaft, &options) {
                prop_assert!(average.samples.iter().chain(&average.spread).all(|v| v.is_finite()));
            }
            if let Ok(angle) = to_angle(&x, 10.0, &shaft, 32, interpolation) {
                prop_assert!(angle.samples.iter().all(|v| v.is_finite()));
            }
        }
    }
}
