//! Exact values, invariances and Gaussian limits of the indicators.

mod common;
use common::{close, gaussian, sine};
use hums::HumsError;
use hums::difference::RemovalRule;
use hums::indicator::basic::{self, CrestDefinition};
use hums::indicator::trend::{Memory, QuasiKurtosis};
use hums::indicator::{GearAnalyzer, GearWorkspace, Indicator, SignalKind, signal_indicators};
use hums::moments::{MomentAccumulator, Moments};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Rounding of sums of a few thousand terms.
const EXACT: f64 = 1e-13;

#[test]
fn analytic_sine() {
    // 7 periods in 4096 samples; the sampled extremes are hit: 4096 / 7 is not whole, so use 8.
    let x = sine(4096, 8.0, 2.5, 0.0);
    close(basic::rms(&x).unwrap(), 2.5 / 2.0_f64.sqrt(), EXACT);
    close(basic::peak(&x).unwrap(), 2.5, EXACT);
    close(basic::peak_to_peak(&x).unwrap(), 5.0, EXACT);
    let crest = |d| basic::crest_factor(&x, d).unwrap();
    close(crest(CrestDefinition::AbsolutePeak), 2.0_f64.sqrt(), EXACT);
    close(crest(CrestDefinition::Maximum), 2.0_f64.sqrt(), EXACT);
    close(crest(CrestDefinition::PeakToPeak), 8.0_f64.sqrt(), EXACT);
    // Moments of the arcsine law: 3/8, 5/16, 35/128 over (1/2)^(p/2).
    close(basic::kurtosis(&x).unwrap(), 1.5, EXACT);
    close(basic::m6a(&x).unwrap(), 2.5, EXACT);
    close(basic::m8a(&x).unwrap(), 4.375, EXACT);
    assert!(basic::skewness(&x).unwrap().abs() < EXACT);
    // A sine has constant Teager energy.
    assert!(matches!(basic::energy_operator(&x, basic::Ends::Cyclic), Err(HumsError::Undefined { .. })));
}

#[test]
fn analytic_square_and_offset() {
    let x: Vec<f64> = (0..1000).map(|i| if i % 2 == 0 { 3.0 } else { 1.0 }).collect();
    close(basic::rms(&x).unwrap(), 5.0_f64.sqrt(), EXACT);
    close(basic::kurtosis(&x).unwrap(), 1.0, EXACT);
    close(basic::m8a(&x).unwrap(), 1.0, EXACT);
    let crest = |d| basic::crest_factor(&x, d).unwrap();
    close(crest(CrestDefinition::AbsolutePeak), 3.0 / 5.0_f64.sqrt(), EXACT);
    close(crest(CrestDefinition::PeakToPeak), 2.0 / 5.0_f64.sqrt(), EXACT);
}

#[test]
fn analytic_impulse_train() {
    // One sample in q is one: p = 1/q; central moments of the Bernoulli law.
    let (n, q) = (12_000, 50);
    let x: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i % q == 7))).collect();
    let p = 1.0 / q as f64;
    let central = |k: i32| p * (1.0 - p).powi(k) + (1.0 - p) * (-p).powi(k);
    let sigma = central(2).sqrt();
    close(basic::rms(&x).unwrap(), p.sqrt(), EXACT);
    close(basic::skewness(&x).unwrap(), central(3) / sigma.powi(3), EXACT);
    close(basic::kurtosis(&x).unwrap(), central(4) / sigma.powi(4), EXACT);
    close(basic::m6a(&x).unwrap(), central(6) / sigma.powi(6), EXACT);
    close(basic::m8a(&x).unwrap(), central(8) / sigma.powi(8), EXACT);
    close(basic::crest_factor(&x, CrestDefinition::AbsolutePeak).unwrap(), 1.0 / p.sqrt(), EXACT);
    // Isolated impulses are their own Teager energy.
    close(basic::energy_operator(&x, basic::Ends::Cyclic).unwrap(), central(4) / sigma.powi(4), EXACT);
}

#[test]
fn analytic_gaussian_limits() {
    let n = 4_000_000;
    let x = gaussian(n, 11);
    // Four standard errors of the sample moments. Var of the kurtosis estimate is 24/N; for the
    // sixth and eighth standardised moments, with m_2p = (2p-1)!!, the delta method gives
    // (m_4p - m_2p^2 (1 + 2 p (p... )) evaluated: 15: 3240/N + ..., 105: bounded by m_16/N.
    let bound = |moment_of_double_order: f64| 4.0 * (moment_of_double_order / n as f64).sqrt();
    assert!((basic::kurtosis(&x).unwrap() - 3.0).abs() < 4.0 * (24.0 / n as f64).sqrt());
    assert!((basic::m6a(&x).unwrap() - 15.0).abs() < bound(10_395.0));
    assert!((basic::m8a(&x).unwrap() - 105.0).abs() < bound(2_027_025.0));
    // White Gaussian noise through the Teager operator: 9 (see the function's derivation); the
    // eighth moment of a^2 - bc is below 1e6.
    assert!((basic::energy_operator(&x, basic::Ends::Cyclic).unwrap() - 9.0).abs() < bound(1e6) / 9.0);
    let s_1 = basic::normalized_moment(&x, 1.0).unwrap();
    assert!((s_1 - (2.0 / std::f64::consts::PI).sqrt()).abs() < bound(1.0));
    for (indicator, found) in [
        (Indicator::Kurtosis, basic::kurtosis(&x).unwrap()),
        (Indicator::M6a, basic::m6a(&x).unwrap()),
        (Indicator::M8a, basic::m8a(&x).unwrap()),
        (Indicator::EnergyOperator, basic::energy_operator(&x, basic::Ends::Cyclic).unwrap()),
    ] {
        close(found, indicator.gaussian_value().unwrap(), 0.03);
    }
}

#[test]
fn invariant_to_how_the_record_is_cut() {
    let x = gaussian(10_000, 3);
    let whole = Moments::of(&x).unwrap();
    for size in [1, 7, 2047, 2048, 2049, 9_999] {
        let mut accumulator = MomentAccumulator::default();
        for part in x.chunks(size) {
            accumulator.push(part).unwrap();
        }
        assert_eq!(accumulator.finish().unwrap(), whole, "chunks of {size}");
    }
}

#[test]
fn invariant_offset_does_not_cancel_digits() {
    let x = gaussian(50_000, 4);
    let shifted: Vec<f64> = x.iter().map(|v| v + 1e6).collect();
    // The samples themselves lose 1e6 * 1.1e-16 = 1.2e-10 each, at random.
    close(basic::kurtosis(&shifted).unwrap(), basic::kurtosis(&x).unwrap(), 1e-10);
    close(basic::m8a(&shifted).unwrap(), basic::m8a(&x).unwrap(), 1e-9);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn invariant_scale_sign_and_cyclic_shift(
        seed in 0_u64..1000, scale in 1e-3_f64..1e3, by in 0_usize..900, n in 900_usize..1100,
    ) {
        let x = gaussian(n, seed);
        let mut y: Vec<f64> = x.iter().map(|v| v * scale).collect();
        y.rotate_left(by);
        let a = signal_indicators(&x, SignalKind::Difference).unwrap();
        let b = signal_indicators(&y, SignalKind::Difference).unwrap();
        for (u, v) in a.iter().zip(&b) {
            let factor = if u.indicator.has_signal_unit() { scale } else { 1.0 };
            let (u, v) = (u.value.clone().unwrap() * factor, v.value.clone().unwrap());
            // Mean and skewness are differences of large sums: absolute bound there.
            prop_assert!((u - v).abs() <= 1e-12 * (u.abs() + factor), "{u} {v}");
        }
        let negative: Vec<f64> = x.iter().map(|v| -v).collect();
        prop_assert_eq!(basic::kurtosis(&x).unwrap(), basic::kurtosis(&negative).unwrap());
        prop_assert!((basic::skewness(&x).unwrap() + basic::skewness(&negative).unwrap()).abs() < 1e-14);
    }

    #[test]
    fn invariant_kurtosis_bounds(values in proptest::collection::vec(-1e3_f64..1e3, 3..200)) {
        // 1 + skewness^2 <= kurtosis <= N for any data (Pearson 1916).
        if let Ok(kurtosis) = basic::kurtosis(&values) {
            let skewness = basic::skewness(&values).unwrap();
            prop_assert!(kurtosis >= (1.0 + skewness * skewness) * (1.0 - 1e-9));
            prop_assert!(kurtosis <= values.len() as f64 * (1.0 + 1e-9));
        }
    }
}

/// Mesh tone (amplitude 2 at order 30) with sidebands, second harmonic, and orders 5 and 11.
fn tones(n: usize) -> Vec<f64> {
    let lines = [(30.0, 2.0), (29.0, 0.3), (31.0, 0.5), (28.0, 0.05), (60.0, 0.7), (5.0, 0.25), (11.0, 0.15)];
    (0..n)
        .map(|i| {
            let theta = TAU * i as f64 / n as f64;
            lines.iter().map(|(m, a)| a * (m * theta + m).cos()).sum()
        })
        .collect()
}

#[test]
fn analytic_gear_indicators_of_known_lines() {
    let x = tones(1024);
    let analysis = GearAnalyzer::new(1024, &RemovalRule::sidebands(30, 1)).unwrap().analyze(&x).unwrap();
    let value = |i, s| analysis.value(i, s).unwrap();
    use SignalKind::{Average, Difference};
    let sigma = ((4.0 + 0.09 + 0.25 + 0.0025 + 0.49 + 0.0625 + 0.0225) / 2.0_f64).sqrt();
    close(value(Indicator::Rms, Average), sigma, 1e-12);
    let span = basic::peak_to_peak(&x).unwrap();
    close(value(Indicator::Fm0, Average), span / 2.7, 1e-12);
    close(value(Indicator::SidebandIndex, Average), 0.4, 1e-12);
    close(value(Indicator::SidebandLevelFactor, Average), 0.8 / sigma, 1e-12);
    close(value(Indicator::SidebandEnergyRatio, Average), 0.85 / 2.0, 1e-12);
    // The difference keeps orders 5, 11 and 28.
    let left = ((0.0625 + 0.0225 + 0.0025) / 2.0_f64).sqrt();
    close(value(Indicator::Rms, Difference), left, 1e-12);
    let removed = (sigma * sigma - left * left).sqrt();
    close(value(Indicator::EnergyRatio, Difference), left / removed, 1e-12);
}

#[test]
fn extreme_difference_of_pure_mesh_has_reasons_not_noise() {
    let x = sine(1024, 30.0, 1.0, 0.2);
    let analysis = GearAnalyzer::new(1024, &RemovalRule::sidebands(30, 1)).unwrap().analyze(&x).unwrap();
    for indicator in [Indicator::Fm4, Indicator::M8a, Indicator::Kurtosis] {
        let value = analysis.value(indicator, SignalKind::Difference);
        assert!(matches!(value, Err(HumsError::Undefined { .. })), "{value:?}");
    }
    assert!(matches!(analysis.value(Indicator::Na4, SignalKind::Residual), Err(HumsError::Undefined { .. })));
    assert!(analysis.value(Indicator::Rms, SignalKind::Difference).unwrap() < 1e-14);
}

#[test]
fn analytic_na4_of_growing_records() {
    let base = gaussian(4096, 8);
    let kurtosis = basic::kurtosis(&base).unwrap();
    let scaled = |s: f64| -> Vec<f64> { base.iter().map(|x| x * s).collect() };
    // Variances 1, 1, 4 (in units of the first): the mean is 2, so NA4 = K (4 / 2)^2.
    let mut running = QuasiKurtosis::new(Memory::Running).unwrap();
    close(running.update(&scaled(1.0)).unwrap(), kurtosis, 1e-12);
    close(running.update(&scaled(1.0)).unwrap(), kurtosis, 1e-12);
    close(running.update(&scaled(2.0)).unwrap(), 4.0 * kurtosis, 1e-12);
    running.reset();
    close(running.update(&scaled(2.0)).unwrap(), kurtosis, 1e-12);
    // NA4*: the record of four times the variance is refused, and so are all later ones.
    let mut locked = QuasiKurtosis::new(Memory::Locked { z: 3.0, learn: 3 }).unwrap();
    for s in [1.0, 1.01, 0.99] {
        locked.update(&scaled(s)).unwrap();
    }
    let reference = (1.0 + 1.01_f64.powi(2) + 0.99_f64.powi(2)) / 3.0;
    close(locked.update(&scaled(2.0)).unwrap(), kurtosis * (4.0 / reference).powi(2), 1e-12);
    assert!(locked.is_locked());
    close(locked.update(&scaled(1.0)).unwrap(), kurtosis / reference.powi(2), 1e-12);
    assert_eq!(locked.records(), 3);
}

#[test]
fn invariant_streamed_tables_have_the_same_bits() {
    let x: Vec<f64> = gaussian(30_011, 55).iter().map(|g| 0.3 + 2.0 * g).collect();
    let whole = hums::indicator::signal_indicators(&x, SignalKind::Raw).unwrap();
    for piece in [1, 2, 3, 1000, 4097, 30_011] {
        let mut stream = hums::indicator::StreamingIndicators::new(1.0);
        x.chunks(piece).for_each(|part| stream.push(part).unwrap());
        assert_eq!(stream.finish().unwrap(), whole, "{piece}");
    }
}

/// Missing samples are left out of the moments; triples across a gap are left out of the energy operator.
#[test]
fn missing_samples_are_left_out_and_counted() {
    let x = gaussian(20_000, 56);
    let mut holed = x.clone();
    for k in [0, 5000, 5001, 12_345, 19_999] {
        holed[k] = f64::NAN;
    }
    let finite: Vec<f64> = holed.iter().copied().filter(|v| v.is_finite()).collect();
    let expected = hums::indicator::signal_indicators(&finite, SignalKind::Raw).unwrap();
    let triples: Vec<f64> =
        holed.windows(3).filter(|w| w.iter().all(|v| v.is_finite())).map(|w| w[1] * w[1] - w[0] * w[2]).collect();
    for piece in [1, 2, 7, 5001, 20_000] {
        let mut stream = hums::indicator::StreamingIndicators::new(1.0);
        holed.chunks(piece).for_each(|part| stream.push(part).unwrap());
        assert_eq!(stream.missing(), 5);
        for (found, expected) in stream.finish().unwrap().iter().zip(&expected) {
            if found.indicator == Indicator::EnergyOperator {
                close(found.value.clone().unwrap(), basic::kurtosis(&triples).unwrap(), 1e-12);
            } else {
                assert_eq!(found, expected, "{piece}");
            }
        }
    }
}

/// A record does not close on itself: a step between its ends is no impulse.
#[test]
fn raw_records_have_no_energy_across_their_ends() {
    let x: Vec<f64> = gaussian(5000, 57).iter().enumerate().map(|(i, g)| 0.01 * i as f64 + g).collect();
    let of = |ends| basic::energy_operator(&x, ends).unwrap();
    let inner: Vec<f64> = x.windows(3).map(|w| w[1] * w[1] - w[0] * w[2]).collect();
    close(of(basic::Ends::Open), basic::kurtosis(&inner).unwrap(), 1e-12);
    assert!(of(basic::Ends::Cyclic) > 3.0 * of(basic::Ends::Open), "50 sigma between the ends");
    let table = signal_indicators(&x, SignalKind::Raw).unwrap();
    let raw = table.iter().find(|e| e.indicator == Indicator::EnergyOperator).unwrap();
    assert_eq!(raw.value, Ok(of(basic::Ends::Open)));
}

/// One workspace for averages of several lengths and rules, among them one without mesh envelope (mesh order 1 has no band): every analysis
/// has the bits of one in fresh memory.
#[test]
fn invariant_workspace_leaves_no_trace() {
    let mut workspace = GearWorkspace::default();
    for (samples, mesh, pairs) in [(1024, 27, 1), (512, 8, 0), (512, 1, 0), (1000, 31, 2), (1024, 27, 1)] {
        let rule = RemovalRule::sidebands(mesh, pairs);
        let analyzer = GearAnalyzer::new(samples, &rule).unwrap();
        for seed in 1..3 {
            let x = gaussian(samples, seed);
            let fresh = analyzer.analyze(&x).unwrap();
            assert_eq!(analyzer.analyze_with(&x, &mut workspace).unwrap(), &fresh, "{samples} {mesh}");
        }
        let mut bad = gaussian(samples, 3);
        bad[5] = f64::NAN;
        assert!(analyzer.analyze_with(&bad, &mut workspace).is_err());
    }
}
