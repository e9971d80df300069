//! Thresholds and rates: exact small cases, scipy, Gaussian scatter.
// Lists of ranges with one member are meant as such.
#![allow(clippy::single_range_in_vec_init)]

mod common;
use common::{close, gaussian};
use hums::HumsError;
use hums::indicator::basic::{kurtosis, m6a, m8a, skewness};
use hums::threshold::*;

fn field(name: &str) -> Vec<f64> {
    include_str!("data/scipy_reference.txt")
        .lines()
        .find_map(|line| line.strip_prefix(name)?.strip_prefix(": "))
        .unwrap()
        .split(' ')
        .map(|v| v.parse().unwrap())
        .collect()
}

#[test]
fn peer_numpy_quantiles_and_mann_whitney() {
    let x = field("signal");
    for (share, expected) in [0.0, 0.05, 0.5, 0.9, 0.999, 1.0].iter().zip(field("quantiles")) {
        close(quantile(&x, *share).unwrap(), expected, 1e-14);
    }
    let damaged: Vec<f64> = x[200..400].iter().map(|v| v + 0.5).collect();
    let roc = Roc::new(&x[..200], &damaged).unwrap();
    close(roc.area, field("area_under_roc")[0], 1e-14);
}

#[test]
fn analytic_small_roc() {
    let roc = Roc::new(&[1.0, 2.0, 3.0], &[2.0, 4.0]).unwrap();
    // Pairs: 2 beats 1, ties 2, loses to 3; 4 beats all: 4.5 of 6.
    close(roc.area, 0.75, 1e-15);
    let rates: Vec<_> = roc.points.iter().map(|p| (p.false_alarm_rate, p.detection_rate)).collect();
    let third = 1.0 / 3.0;
    assert_eq!(rates, [(0.0, 0.0), (0.0, 0.5), (third, 0.5), (2.0 * third, 1.0), (1.0, 1.0)]);
    // Trapezoids under the points give the same area.
    let area: f64 = rates.windows(2).map(|w| (w[1].0 - w[0].0) * (w[0].1 + w[1].1) / 2.0).sum();
    close(area, roc.area, 1e-15);
    // Every point's rates are what its threshold gives.
    for p in &roc.points {
        let d = Rate::above(&[2.0, 4.0], p.threshold).unwrap();
        let h = Rate::above(&[1.0, 2.0, 3.0], p.threshold).unwrap();
        assert_eq!((h.value(), d.value()), (p.false_alarm_rate, p.detection_rate));
    }
    assert_eq!(roc.at_false_alarm_rate(0.4).detection_rate, 0.5);
    assert_eq!(roc.at_false_alarm_rate(0.7).detection_rate, 1.0);
    let apart = Roc::new(&[1.0; 5], &[2.0; 5]).unwrap();
    assert_eq!(apart.area, 1.0);
    assert_eq!(Roc::new(&[1.0; 5], &[1.0; 5]).unwrap().area, 0.5);
}

#[test]
fn invariant_roc_under_monotone_maps() {
    let (h, d) = (gaussian(300, 1), gaussian(200, 2));
    let map = |v: &[f64]| -> Vec<f64> { v.iter().map(|x| x.exp()).collect() };
    let roc = Roc::new(&h, &d).unwrap();
    assert_eq!(roc.area, Roc::new(&map(&h), &map(&d)).unwrap().area);
    close(Roc::new(&d, &h).unwrap().area, 1.0 - roc.area, 1e-12);
}

#[test]
fn analytic_false_alarms_of_k_sigma() {
    // 1 - Phi(2) = 2.275 %, 1 - Phi(3) = 0.135 %; 20000 values leave 0.11 and 0.026 %.
    let healthy = gaussian(20_000, 31);
    for (k, expected, scatter) in [(2.0, 0.022_75, 0.0035), (3.0, 0.001_35, 0.0008)] {
        let rate = Rate::above(&healthy, sigma_limit(&healthy, k).unwrap().upper.unwrap()).unwrap();
        assert!((rate.value() - expected).abs() < scatter, "{rate:?}");
        assert!(rate.low < rate.value() && rate.value() < rate.high);
    }
    let limit = sigma_limit(&[1.0, 2.0, 3.0], 2.0).unwrap();
    assert!(limit.lower.unwrap().abs() < 1e-14);
    close(limit.centre, 2.0, 1e-14);
    close(limit.upper.unwrap(), 4.0, 1e-14);
    close(limit.deviation(3.0), 0.5, 1e-14);
    close(limit.deviation(-2.0), 2.0, 1e-14);
    // Wilson's interval for 0 of 10: upper end z^2 / (n + z^2).
    let none = Rate::above(&[0.0; 10], 1.0).unwrap();
    assert_eq!(none.low, 0.0);
    close(none.high, 3.841_458_820_694_124 / 13.841_458_820_694_124, 1e-12);
}

#[test]
fn analytic_gaussian_scatter_of_standardised_moments() {
    close(gaussian_standard_error(4, 24).unwrap(), 1.0, 1e-15);
    close(gaussian_standard_error(6, 6120).unwrap(), 1.0, 1e-15);
    close(gaussian_standard_error(8, 1_663_200).unwrap(), 1.0, 1e-15);
    type Moment = fn(&[f64]) -> hums::Result<f64>;
    let cases: [(usize, f64, Moment); 4] = [(3, 0.0, skewness), (4, 3.0, kurtosis), (6, 15.0, m6a), (8, 105.0, m8a)];
    let n = 20_000;
    for (order, nominal, of) in cases {
        let spread: f64 =
            (0..150).map(|seed| (of(&gaussian(n, 500 + seed)).unwrap() - nominal).powi(2)).sum::<f64>() / 150.0;
        // 150 runs: 6 % for a normal scatter; M8A's is skewed.
        close(spread.sqrt(), gaussian_standard_error(order, n).unwrap(), 0.3);
    }
}

#[test]
fn analytic_detection_curve_and_alarms() {
    let sets = [vec![1.0, 1.2, 0.9, 1.1], vec![1.0, 2.0, 3.0, 1.1], vec![3.0, 4.0, 5.0, 6.0]];
    let curve = detection_curve(&sets, &Limit::up_to(1.0, 1.5)).unwrap();
    assert_eq!(curve.iter().map(Rate::value).collect::<Vec<_>>(), [0.0, 0.5, 1.0]);
    let values = [1.0, 5.0, 1.0, 5.0, 5.0, 1.0, 5.0, 1.0, 1.0].map(Some);
    let rule = AlarmRule { limit: Limit::up_to(1.0, 3.0), hits: 2, window: 3 };
    assert_eq!(alarms(&values, &rule).unwrap(), vec![3..7]);
    let mut missing = values.to_vec();
    missing.insert(4, None);
    assert_eq!(alarms(&missing, &rule).unwrap(), vec![3..8]);
    let last = [Some(5.0), Some(5.0)];
    assert_eq!(alarms(&last, &rule).unwrap(), vec![1..2]);
}

#[test]
fn extreme_sets() {
    assert!(matches!(quantile(&[], 0.5), Err(HumsError::TooShort { .. })));
    assert!(quantile(&[1.0], 1.5).is_err());
    assert!(quantile(&[1.0, f64::NAN], 0.5).is_err());
    assert_eq!(quantile(&[7.0], 0.3).unwrap(), 7.0);
    for rule in [|x: &[f64]| sigma_limit(x, 3.0), |x: &[f64]| prediction_limit(x, 0.01)] {
        assert!(rule(&[1.0]).is_err() && rule(&[1.0, f64::NAN]).is_err());
        let equal = rule(&[2.0; 9]).unwrap();
        assert!(
            !equal.excludes(2.0) && equal.excludes(2.1) && equal.deviation(2.0) == 0.0 && equal.deviation(2.1) > 1.0
        );
    }
    assert!(sigma_limit(&[1.0, 2.0], f64::NAN).is_err());
    for rate in [0.0, 1.0, f64::NAN] {
        assert!(prediction_limit(&[1.0, 2.0], rate).is_err());
    }
    assert!(quantile_limit(&[1.0, 2.0], 1.2).is_err());
    assert!(held_out(&[1.0, 2.0], |x| sigma_limit(x, 3.0)).is_err());
    assert!(Rate::of(0, 0).is_err() && Rate::of(3, 2).is_err());
    assert!(Rate::above(&[1.0], f64::NAN).is_err());
    assert!(Roc::new(&[], &[1.0]).is_err());
    assert!(gaussian_standard_error(5, 10).is_err());
    assert!(gaussian_standard_error(4, 0).is_err());
    assert!(alarms(&[], &AlarmRule { limit: Limit::up_to(0.0, 1.0), hits: 0, window: 3 }).is_err());
}

/// A further value leaves its prediction limits as often as announced, also with few healthy ones and for factors.
#[test]
fn analytic_prediction_limits_hold_for_further_values() {
    for (n, rate, lognormal) in [(3, 0.1, false), (6, 0.05, true), (20, 0.02, true)] {
        let trials = 4000;
        let values = gaussian(trials * (n + 1), 700 + n as u64);
        let map = |x: &f64| if lognormal { (0.4 * x).exp() } else { 5.0 * x - 1.0 };
        let hits = values
            .chunks(n + 1)
            .filter(|set| {
                let healthy: Vec<f64> = set[..n].iter().map(map).collect();
                prediction_limit(&healthy, rate).unwrap().excludes(map(&set[n]))
            })
            .count();
        let expected = rate * trials as f64;
        // Four standard deviations of a binomial count.
        assert!((hits as f64 - expected).abs() < 4.0 * (expected * (1.0 - rate)).sqrt(), "{n}: {hits} of {trials}");
    }
    // Leave-one-out estimates the same rate; in the sample it is lower.
    let healthy = gaussian(2000, 32);
    let held = held_out(&healthy[..12], |x| sigma_limit(x, 1.5)).unwrap();
    let limit = sigma_limit(&healthy[..12], 1.5).unwrap();
    assert!(held.hits >= Rate::outside(&healthy[..12], &limit).unwrap().hits && held.cases == 12);
    let by_hand = (0..12)
        .filter(|&k| {
            let others: Vec<f64> = (0..12).filter(|&i| i != k).map(|i| healthy[i]).collect();
            sigma_limit(&others, 1.5).unwrap().excludes(healthy[k])
        })
        .count();
    assert_eq!(held.hits, by_hand);
}

#[test]
fn rocs_turn_towards_the_damage() {
    let (h, d) = (gaussian(200, 41), gaussian(100, 42).iter().map(|x| x - 1.0).collect::<Vec<_>>());
    let roc = Roc::oriented(&h, &d).unwrap();
    assert!(!roc.rises);
    close(roc.area, 1.0 - Roc::new(&h, &d).unwrap().area, 1e-12);
    for p in &roc.points[1..] {
        let below = |set: &[f64]| set.iter().filter(|x| **x < p.threshold).count() as f64 / set.len() as f64;
        assert_eq!((below(&h), below(&d)), (p.false_alarm_rate, p.detection_rate));
    }
    // Phi(1 / sqrt 2) = 0.760 is the area of two unit normals one apart.
    let (low, high) = roc.area_interval();
    assert!(low < 0.760 && 0.760 < high && high - low < 0.13, "{low} {high}");
    let apart = Roc::oriented(&[1.0; 10], &[2.0; 30]).unwrap();
    assert_eq!(apart.area_interval(), (0.7, 1.0));
}

/// White Gaussian noise passes any of the four limits about as often as announced, although the moments are skewed and the limits are
/// an approximation: 1 % announced for each recording.
#[test]
fn analytic_gaussian_limits_of_a_family() {
    let (n, trials, announced) = (1000, 6000, 0.01);
    let z = normal_quantile(1.0 - announced / 4.0);
    close(normal_quantile(0.975), 1.959_963_984_540_054, 1e-8);
    let limits = [(4, 3.0), (6, 15.0), (8, 105.0)].map(|(order, nominal): (usize, f64)| {
        let factor = (z * gaussian_standard_error(order, n).unwrap() / nominal).exp();
        (order, Limit::up_to_factor(nominal, factor))
    });
    let alarms = (0..trials)
        .filter(|seed| {
            let moments = hums::moments::Moments::of(&gaussian(n, 20_000 + seed)).unwrap();
            limits.iter().any(|(order, limit)| limit.excludes(moments.standardized(*order).unwrap()))
        })
        .count();
    let share = alarms as f64 / trials as f64;
    assert!((0.004..0.013).contains(&share), "{share}");
}
