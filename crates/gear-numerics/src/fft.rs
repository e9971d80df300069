//! Plans of Fourier transforms of `f64` (`rustfft`, `realfft`).
//!
//! Transforms are not normalised: forward, then inverse, gives `n` times the signal. The algorithms are generic over the number type and
//! long to compile; behind these functions they are compiled once, and other crates hold plans as trait objects.

use std::sync::Arc;

pub use realfft::{ComplexToReal, RealToComplex};
pub use rustfft::{Fft, num_complex::Complex};

use realfft::RealFftPlanner;
use rustfft::FftPlanner;

/// Forward transform of `length` real samples to `length / 2 + 1` bins.
#[must_use]
pub fn real_forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    RealFftPlanner::new().plan_fft_forward(length)
}

/// Inverse transform of `length / 2 + 1` bins to `length` real samples.
#[must_use]
pub fn real_inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    RealFftPlanner::new().plan_fft_inverse(length)
}

/// Inverse transform of `length` complex bins, in place.
#[must_use]
pub fn complex_inverse(length: usize) -> Arc<dyn Fft<f64>> {
    FftPlanner::new().plan_fft_inverse(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// Forward, then inverse, is the signal times its length; for lengths of all kinds of algorithms.
    #[test]
    fn invariant_there_and_back() {
        for length in [1_usize, 2, 3, 8, 17, 30, 97, 1024] {
            let signal: Vec<f64> = (0..length).map(|i| (0.3 * i as f64).sin() + 0.1 * i as f64).collect();
            let (forward, inverse) = (real_forward(length), real_inverse(length));
            let mut bins = forward.make_output_vec();
            forward.process(&mut signal.clone(), &mut bins).unwrap();
            let mut whole: Vec<Complex<f64>> =
                (0..length).map(|k| if k < bins.len() { bins[k] } else { bins[length - k].conj() }).collect();
            complex_inverse(length).process(&mut whole);
            let mut back = inverse.make_output_vec();
            inverse.process(&mut bins, &mut back).unwrap();
            for ((x, back), whole) in signal.iter().zip(&back).zip(&whole) {
                let scale = length as f64;
                assert_abs_diff_eq!(*back, scale * x, epsilon = 1e-12 * scale * scale);
                assert_abs_diff_eq!(whole.re, scale * x, epsilon = 1e-12 * scale * scale);
            }
        }
    }
}
