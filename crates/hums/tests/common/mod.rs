//! Shared by the integration tests: seeded noise and comparison.
#![allow(dead_code)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Standard normal noise by Box and Muller, the same bits on every run.
pub fn gaussian(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = move || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..n)
        .map(|_| {
            let (u, v) = (1.0 - uniform(), uniform());
            (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
        })
        .collect()
}

pub fn uniform(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..n).map(|_| (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64).collect()
}

pub fn sine(n: usize, cycles: f64, amplitude: f64, phase: f64) -> Vec<f64> {
    (0..n).map(|i| amplitude * (TAU * cycles * i as f64 / n as f64 + phase).sin()).collect()
}

pub fn max_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[track_caller]
pub fn close(found: f64, expected: f64, relative: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= relative * expected.abs(),
        "{found} is not {expected}: relative error {:.3e} > {relative:.1e}",
        error / expected.abs()
    );
}
