//! Probability of detection: closed forms, coverage, and data that say nothing.

mod common;
use common::{close, uniform};
use hums::HumsError;
use hums::detectability::HitMiss;

/// Two severities: the fit goes through the two shares, its variances are those of two logits.
#[test]
fn analytic_two_severities() {
    let severities: Vec<f64> = (0..40).map(|k| if k < 20 { 1.0 } else { 3.0 }).collect();
    let detected: Vec<bool> = (0..40).map(|k| if k < 20 { k < 4 } else { k < 38 }).collect();
    let fit = HitMiss::fit(&severities, &detected).unwrap();
    close(fit.probability(1.0), 0.2, 1e-10);
    close(fit.probability(3.0), 0.9, 1e-10);
    close(fit.size_detected(0.9), 3.0, 1e-9);
    let logit = |p: f64| (p / (1.0 - p)).ln();
    let half = 1.644_853_626_951_472_7 / (20.0 * 0.9 * 0.1_f64).sqrt();
    let (low, high) = fit.bounds(3.0);
    close(low, 1.0 / (1.0 + (-(logit(0.9) - half)).exp()), 1e-9);
    close(high, 1.0 / (1.0 + (-(logit(0.9) + half)).exp()), 1e-9);
    let a = fit.size_detected_with_confidence(0.9).unwrap();
    assert!(a > 3.0);
    close(fit.bounds(a).0, 0.9, 1e-9);
}

/// a_90/95 lies above the true a_90 in about 95 % of all experiments.
#[test]
fn analytic_confidence_of_a90() {
    let truth = |a: f64| 1.0 / (1.0 + (-(a - 2.0) * 3.0).exp());
    let a90 = 2.0 + 9.0_f64.ln() / 3.0;
    let (mut above, mut trials) = (0, 0);
    for seed in 0..400 {
        let draws = uniform(120, 9000 + seed);
        let severities: Vec<f64> = (0..120).map(|k| 0.5 + 3.0 * f64::from(k) / 119.0).collect();
        let detected: Vec<bool> = severities.iter().zip(&draws).map(|(a, u)| *u < truth(*a)).collect();
        let Ok(fit) = HitMiss::fit(&severities, &detected) else { continue };
        trials += 1;
        above += usize::from(fit.size_detected_with_confidence(0.9).is_some_and(|a| a > a90));
    }
    let share = f64::from(above as u32) / f64::from(trials);
    // Four standard deviations of 400 trials are 0.044; Wald's bound is a little short for 120 data.
    assert!(trials > 390 && (0.90..0.99).contains(&share), "{share} of {trials}");
}

#[test]
fn extreme_data_say_why_there_is_no_curve() {
    let a = [1.0, 2.0, 3.0, 4.0];
    let undefined = |hits: [bool; 4]| matches!(HitMiss::fit(&a, &hits), Err(HumsError::Undefined { .. }));
    assert!(undefined([false; 4]) && undefined([true; 4]));
    assert!(undefined([false, false, true, true]), "separated");
    assert!(undefined([true, true, false, false]) && undefined([true, false, true, false]), "falling");
    assert!(HitMiss::fit(&[1.0; 4], &[true, false, true, false]).is_err());
    assert!(HitMiss::fit(&[1.0, 2.0], &[true, false]).is_err());
    assert!(HitMiss::fit(&a, &[true; 3]).is_err());
    assert!(HitMiss::fit(&[1.0, f64::NAN, 2.0, 3.0], &[true, false, true, false]).is_err());
    // Large offsets are as good as small ones.
    let hits = [false, true, false, true];
    let near = HitMiss::fit(&a, &hits).unwrap();
    let far = HitMiss::fit(&a.map(|x| 1e6 + 1e-3 * x), &hits).unwrap();
    close((far.size_detected(0.5) - 1e6) * 1e3, near.size_detected(0.5), 1e-5);
}
