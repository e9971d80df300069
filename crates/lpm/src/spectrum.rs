//! One-sided amplitude spectra of signals over whole periods, and the damage-induced response.
//!
//! A steady response sampled over whole periods has no leakage: no window is applied, and the amplitude of
//! `A cos(2 pi f t + phi)` reads `A` at `f` (the mean at 0, and the Nyquist line, are not doubled).
//! The damage-induced response is the sample-by-sample difference of damaged and healthy steady responses
//! (dissertation D7.4: the exact difference signal).
//!
//! Tests: unit tests below.

use crate::error::{LpmError, check};
use gear_numerics::fft;
use std::f64::consts::TAU;

/// Amplitude spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Frequencies (Hz), from 0 in equal steps.
    pub frequency: Vec<f64>,
    /// Amplitudes (unit of the signal).
    pub amplitude: Vec<f64>,
    /// Phases of the cosines (rad), in (-pi, pi].
    pub phase: Vec<f64>,
}

impl Spectrum {
    /// Spectrum of equally spaced samples that cover whole periods; `duration` (s) is that of the whole signal.
    ///
    /// # Errors
    /// [`LpmError::Length`] for fewer than 2 samples; [`LpmError::OutOfRange`] for a duration that is not positive.
    pub fn of(samples: &[f64], duration: f64) -> Result<Self, LpmError> {
        check(duration > 0.0, "duration", duration, "s", "positive")?;
        let n = samples.len();
        if n < 2 {
            return Err(LpmError::Length { what: "samples of a spectrum", found: n, needed: "at least 2" });
        }
        let fft = fft::real_forward(n);
        let (mut input, mut output) = (samples.to_vec(), fft.make_output_vec());
        fft.process(&mut input, &mut output).map_err(|_| LpmError::Singular { place: "Fourier transform" })?;
        let lines = output.len();
        let doubled = |i: usize| {
            if i == 0 || (n.is_multiple_of(2) && i == lines - 1) { 1.0 } else { 2.0 }
        };
        Ok(Self {
            frequency: (0..lines).map(|i| i as f64 / duration).collect(),
            amplitude: output.iter().enumerate().map(|(i, c)| doubled(i) * c.norm() / n as f64).collect(),
            phase: output.iter().map(|c| if c.norm() > 0.0 { c.arg() } else { 0.0 }).collect(),
        })
    }

    /// Amplitude at the line nearest to `frequency` (Hz).
    pub fn amplitude_at(&self, frequency: f64) -> f64 {
        let step = self.frequency.get(1).copied().unwrap_or(1.0);
        let line = (frequency / step).round().clamp(0.0, (self.amplitude.len() - 1) as f64) as usize;
        self.amplitude[line]
    }

    /// Largest amplitude between two frequencies (Hz), zero frequency excluded: (frequency, amplitude).
    pub fn peak(&self, from: f64, to: f64) -> Option<(f64, f64)> {
        self.frequency
            .iter()
            .zip(&self.amplitude)
            .skip(1)
            .filter(|(f, _)| (from..=to).contains(*f))
            .map(|(f, a)| (*f, *a))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Signal of `n` samples that has this spectrum (the inverse of [`Self::of`] when `n` is the same).
    pub fn signal(&self, n: usize) -> Vec<f64> {
        (0..n)
            .map(|j| {
                self.amplitude
                    .iter()
                    .zip(&self.phase)
                    .enumerate()
                    .map(|(i, (a, p))| a * (TAU * ((i * j) % n) as f64 / n as f64 + p).cos())
                    .sum()
            })
            .collect()
    }
}

/// Damaged minus healthy, sample by sample. The healthy signal may cover a shorter period that divides the damaged one; it is repeated.
///
/// # Errors
/// [`LpmError::Length`] where the healthy period does not divide the damaged one.
pub fn damage_induced(damaged: &[f64], healthy: &[f64]) -> Result<Vec<f64>, LpmError> {
    if healthy.is_empty() || !damaged.len().is_multiple_of(healthy.len()) {
        return Err(LpmError::Length {
            what: "healthy samples",
            found: healthy.len(),
            needed: "a divisor of the number of damaged samples",
        });
    }
    Ok(damaged.iter().zip(healthy.iter().cycle()).map(|(d, h)| d - h).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_amplitudes_and_phases_of_known_tones() -> Result<(), LpmError> {
        for n in [96usize, 97] {
            let t = |j: usize| TAU * j as f64 / n as f64;
            let x: Vec<f64> =
                (0..n).map(|j| 1.5 + 2.0 * (3.0 * t(j) + 0.4).cos() - 0.25 * (7.0 * t(j)).sin()).collect();
            let s = Spectrum::of(&x, 0.5)?;
            assert!((s.amplitude_at(0.0) - 1.5).abs() < 1e-13);
            assert!((s.amplitude_at(6.0) - 2.0).abs() < 1e-13);
            assert!((s.amplitude_at(14.0) - 0.25).abs() < 1e-13);
            assert!((s.phase[3] - 0.4).abs() < 1e-12);
            assert_eq!(s.peak(1.0, 1e9).map(|p| p.0), Some(6.0));
            for (a, b) in s.signal(n).iter().zip(&x) {
                assert!((a - b).abs() < 1e-12);
            }
        }
        Ok(())
    }

    #[test]
    fn invariant_difference_repeats_the_healthy_signal() -> Result<(), LpmError> {
        let d = damage_induced(&[1.0, 2.0, 4.0, 2.0], &[1.0, 2.0])?;
        assert_eq!(d, [0.0, 0.0, 3.0, 0.0]);
        assert!(damage_induced(&[1.0, 2.0, 4.0], &[1.0, 2.0]).is_err());
        assert!(damage_induced(&[1.0], &[]).is_err());
        Ok(())
    }
}
