//! Damage type and severity from curves whose features are known exactly.

mod common;
use common::{close, gaussian};
use hums::HumsError;
use hums::damage_type::*;

const STEP: f64 = 0.02;

/// A healthy curve over two mesh cycles: 12 um, 18 um around single contact.
fn healthy() -> Vec<f64> {
    (0..=100).map(|k| if (30..70).contains(&k) { 18.0 } else { 12.0 }).collect()
}

/// Raised by `rise` over `length` mesh cycles around the middle, relative to each value; a trapezium with sides of a tenth.
fn raised(rise: f64, length: f64) -> Vec<f64> {
    let at = |k: usize| ((0.5 * length + 0.05 - (STEP * k as f64 - 1.0).abs()) / 0.1).clamp(0.0, 1.0);
    healthy().iter().enumerate().map(|(k, h)| h * (1.0 + rise * at(k))).collect()
}

fn features(curve: &[f64]) -> CurveFeatures {
    CurveFeatures::of(&healthy(), curve, STEP, AFFECTED).unwrap()
}

/// Cracks are felt for 1.5 mesh cycles at any severity (%), pits for 0.3 to 1.2.
fn crack(severity: f64) -> Vec<f64> {
    raised(2e-4 * severity * severity, 1.5)
}

fn pit(severity: f64) -> Vec<f64> {
    raised(0.03 * severity, 0.3 + 0.02 * severity)
}

fn classifier() -> DamageClassifier {
    let curve = |make: fn(f64) -> Vec<f64>, severities: &[f64]| -> Vec<(f64, CurveFeatures)> {
        severities.iter().map(|&s| (s, features(&make(s)))).collect()
    };
    let cracks = curve(crack, &[10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0]);
    let pits = curve(pit, &[5.0, 15.0, 25.0, 35.0, 45.0]);
    DamageClassifier::new(SeverityFeature::PeakRise, 0.005, &cracks, &pits, &[]).unwrap()
}

#[test]
fn analytic_features() {
    let flat = vec![10.0; 101];
    // a triangle of height 0.11 and half base 0.5: above 1 % over 1.0 (1 - 1 / 11)
    let curve: Vec<f64> =
        (0..=100).map(|k| 10.0 * (1.0 + 0.11 * (1.0 - 2.0 * (STEP * f64::from(k) - 1.0).abs()).max(0.0))).collect();
    let features = CurveFeatures::of(&flat, &curve, STEP, AFFECTED).unwrap();
    close(features.peak_rise, 0.11, 1e-12);
    close(features.largest_rise, 0.11, 1e-12);
    close(features.affected, 10.0 / 11.0, 1e-9);
    // symmetric about the middle, one mesh cycle from the first sample
    close(features.centre, 1.0, 1e-9);
    let same = CurveFeatures::of(&flat, &flat, STEP, AFFECTED).unwrap();
    assert_eq!((same.peak_rise, same.largest_rise, same.affected, same.centre), (0.0, 0.0, 0.0, 0.0));
    // a rise away from the largest value is no rise of it
    let mut early = healthy();
    early[10] = 15.0;
    let early = self::features(&early);
    assert_eq!(early.peak_rise, 0.0);
    close(early.largest_rise, 0.25, 1e-12);
}

#[test]
fn invariant_features_under_units_and_sampling() {
    let scaled = |v: &[f64]| v.iter().map(|x| 1e-6 * x).collect::<Vec<_>>();
    let one = features(&pit(20.0));
    let other = CurveFeatures::of(&scaled(&healthy()), &scaled(&pit(20.0)), STEP, AFFECTED).unwrap();
    close(one.peak_rise, other.peak_rise, 1e-12);
    close(one.affected, other.affected, 1e-12);
}

#[test]
fn invariant_reference_points_and_between() {
    let classifier = classifier();
    for severity in [10.0, 15.0, 25.0, 35.0, 55.0, 80.0] {
        let found = classifier.classify(&features(&crack(severity))).unwrap();
        let damage = found.damage.unwrap();
        assert_eq!(damage.damage, DamageType::Crack, "{severity}: {found:?}");
        // linear between points of a parabola
        close(damage.severity / severity, 1.0, 0.06);
        assert!(found.margin > 0.1 && damage.within_reference);
    }
    for severity in [3.0, 5.0, 10.0, 30.0, 45.0] {
        let found = classifier.classify(&features(&pit(severity))).unwrap();
        let damage = found.damage.unwrap();
        assert_eq!(damage.damage, DamageType::Pit, "{severity}: {found:?}");
        close(damage.severity / severity, 1.0, 1e-6);
    }
    assert_eq!(classifier.classify(&features(&healthy())).unwrap().damage, None);
    let beyond = classifier.classify(&features(&crack(120.0))).unwrap();
    assert!(!beyond.estimates[0].within_reference && beyond.estimates[0].severity == 80.0);
}

/// Felt as long as a crack and rising as far, but about another place: the centre tells, and how near pits may come decides by how much.
#[test]
fn invariant_centre_of_the_rise_tells() {
    let moved = |curve: &[f64], by: usize| -> Vec<f64> {
        let rise = |k: usize| curve[k] / healthy()[k];
        healthy().iter().enumerate().map(|(k, h)| h * if k >= by { rise(k - by) } else { 1.0 }).collect()
    };
    let classifier = classifier();
    let reach = classifier.reach();
    assert!(reach > 0.1 && reach < 0.2, "{reach}");
    let near = (reach / STEP) as usize;
    let kind = |by: usize| {
        let found = classifier.classify(&features(&moved(&crack(40.0), by))).unwrap();
        (found.damage.unwrap().damage, found.margin)
    };
    assert_eq!(kind(near - 1).0, DamageType::Crack);
    assert_eq!(kind(near + 2).0, DamageType::Pit);
    assert!(kind(0).1 > kind(near - 1).1, "the margin falls toward the border");
    // a pit that is known there draws the border nearer
    let points = |make: fn(f64) -> Vec<f64>, severities: &[f64]| -> Vec<(f64, CurveFeatures)> {
        severities.iter().map(|&s| (s, features(&make(s)))).collect()
    };
    let known = features(&moved(&crack(40.0), 5));
    let (cracks, pits) = (points(crack, &[20.0, 40.0, 60.0]), points(pit, &[5.0, 45.0]));
    let bounded = DamageClassifier::new(SeverityFeature::PeakRise, 0.0, &cracks, &pits, &[known]).unwrap();
    close(bounded.reach(), 0.5 * 5.0 * STEP, 0.1);
    assert_eq!(bounded.classify(&known).unwrap().damage.unwrap().damage, DamageType::Pit);
}

/// Noise of half a percent does not change the verdict on damage that rises by ten times as much.
#[test]
fn invariant_small_noise() {
    let classifier = classifier();
    for seed in 0..50 {
        let noise = gaussian(101, seed);
        let noisy = |curve: Vec<f64>| -> Vec<f64> {
            curve.iter().zip(&noise).map(|(value, n)| value * (1.0 + 0.003 * n)).collect()
        };
        let kind = |curve| classifier.classify(&features(&noisy(curve))).unwrap().damage.unwrap().damage;
        assert_eq!(kind(crack(40.0)), DamageType::Crack);
        assert_eq!(kind(pit(10.0)), DamageType::Pit);
    }
}

#[test]
fn extreme_inputs_are_explained() {
    let (h, c) = (healthy(), pit(10.0));
    let of = |h: &[f64], c: &[f64], step, threshold| CurveFeatures::of(h, c, step, threshold);
    assert!(matches!(of(&h[..1], &c[..1], STEP, 0.01), Err(HumsError::TooShort { .. })));
    assert!(matches!(of(&h, &c[1..], STEP, 0.01), Err(HumsError::LengthMismatch { .. })));
    assert!(matches!(of(&h, &c, 0.0, 0.01), Err(HumsError::Parameter { .. })));
    assert!(matches!(of(&h, &c, STEP, f64::NAN), Err(HumsError::Parameter { .. })));
    assert!(matches!(of(&[0.0, 1.0], &[1.0, 1.0], STEP, 0.01), Err(HumsError::Undefined { .. })));
    assert!(matches!(of(&[1.0, f64::NAN], &[1.0, 1.0], STEP, 0.01), Err(HumsError::NotFinite { .. })));
    let new = |points: &[(f64, CurveFeatures)]| {
        DamageClassifier::new(SeverityFeature::PeakRise, 0.0, points, &[(1.0, features(&pit(1.0)))], &[])
    };
    let [small, large] = [features(&crack(10.0)), features(&crack(50.0))];
    assert!(matches!(new(&[]), Err(HumsError::TooShort { .. })));
    assert!(matches!(new(&[(10.0, large), (20.0, small)]), Err(HumsError::Undefined { .. })));
    assert!(matches!(new(&[(10.0, small), (10.0, large)]), Err(HumsError::Parameter { .. })));
    assert!(matches!(new(&[(0.0, small)]), Err(HumsError::Parameter { .. })));
    assert!(new(&[(10.0, small), (20.0, large)]).is_ok());
}
