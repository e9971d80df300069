//! Removal of regular orders is an exact projection.

mod common;
use common::{close, gaussian, max_difference};
use hums::HumsError;
use hums::difference::{RemovalRule, exact_difference, split, whole_mesh_order};
use std::f64::consts::TAU;

fn rms(x: &[f64]) -> f64 {
    hums::indicator::basic::rms(x).unwrap()
}

#[test]
fn analytic_matches_fourier_sum() {
    // Orders removed one by one with explicit sums: O(N) each, no transform.
    for n in [240, 241] {
        let x = gaussian(n, 5);
        let rule = RemovalRule::sidebands(27, 2);
        let mut expected = x.clone();
        for order in rule.difference_orders(n) {
            let phase = |i: usize| TAU * ((order * i) % n) as f64 / n as f64;
            let sides = if 2 * order == n { 1.0 } else { 2.0 };
            let part = |f: fn(f64) -> f64| -> f64 {
                x.iter().enumerate().map(|(i, v)| v * f(phase(i))).sum::<f64>() * sides / n as f64
            };
            let (a, b) = (part(f64::cos), part(f64::sin));
            for (i, v) in expected.iter_mut().enumerate() {
                *v -= a * phase(i).cos() + b * phase(i).sin();
            }
        }
        let signals = split(&x, &rule).unwrap();
        assert!(max_difference(&signals.difference, &expected) < 1e-12);
    }
}

#[test]
fn analytic_removed_orders() {
    let rule = RemovalRule::sidebands(10, 2);
    assert_eq!(rule.residual_orders(64), [10, 20, 30]);
    // Order 34 = 2 below the fourth harmonic is above Nyquist (32); 38 and 39 too.
    assert_eq!(rule.difference_orders(64), [8, 9, 10, 11, 12, 18, 19, 20, 21, 22, 28, 29, 30, 31, 32]);
    // A harmonic above Nyquist still has its lower sidebands removed.
    assert_eq!(RemovalRule::sidebands(10, 2).difference_orders(39), [8, 9, 10, 11, 12, 18, 19]);
    let common = RemovalRule::shaft_and_mesh(10);
    assert_eq!(common.residual_orders(64), [0, 1, 2, 10, 20, 30]);
    // Planet-pass sidebands of a carrier average: 99 ring teeth, 3 planets.
    let carrier = RemovalRule { sideband_spacing: 3, ..RemovalRule::sidebands(99, 1) };
    assert_eq!(carrier.difference_orders(300), [96, 99, 102]);
}

#[test]
fn invariant_projection() {
    let x = gaussian(2048, 6);
    for k in 0..=5 {
        let rule = RemovalRule::sidebands(33, k);
        let s = split(&x, &rule).unwrap();
        // Idempotent: nothing is left to remove.
        let again = split(&s.difference, &rule).unwrap();
        assert!(max_difference(&again.difference, &s.difference) < 1e-13);
        // Orthogonal: energies add.
        let energy = rms(&s.difference).powi(2) + rms(&s.regular).powi(2);
        close(energy, rms(&x).powi(2), 1e-12);
        // Additive, by construction of the regular signal.
        let sum: Vec<f64> = s.difference.iter().zip(&s.regular).map(|(d, r)| d + r).collect();
        assert!(max_difference(&sum, &x) < 1e-14);
        // More sidebands removed, less energy left.
        let fewer = split(&x, &RemovalRule::sidebands(33, k.saturating_sub(1))).unwrap();
        assert!(rms(&s.difference) <= rms(&fewer.difference));
    }
}

#[test]
fn analytic_residual_keeps_sidebands() {
    let x: Vec<f64> = (0..512)
        .map(|i| {
            let a = TAU * i as f64 / 512.0;
            (40.0 * a).sin() + 0.2 * (41.0 * a).cos()
        })
        .collect();
    let s = split(&x, &RemovalRule::sidebands(40, 1)).unwrap();
    close(rms(&s.residual), 0.2 / 2.0_f64.sqrt(), 1e-12);
    assert!(rms(&s.difference) < 1e-14);
}

#[test]
fn analytic_exact_difference_and_its_faults() {
    assert_eq!(exact_difference(&[3.0, 5.0], &[1.0, 7.0]).unwrap(), [2.0, -2.0]);
    assert!(matches!(exact_difference(&[1.0], &[1.0, 2.0]), Err(HumsError::LengthMismatch { left: 1, right: 2, .. })));
    assert!(matches!(
        split(&[0.0; 16], &RemovalRule::sidebands(9, 0)),
        Err(HumsError::OrderNotResolved { order: 9, highest: 8, .. })
    ));
    assert_eq!(whole_mesh_order(99.0 / 3.0).unwrap(), 33);
    assert!(whole_mesh_order(98.0 / 3.0).is_err());
    assert!(whole_mesh_order(f64::NAN).is_err());
}
