//! Indicators that need nothing but the samples.
//!
//! | indicator | formula | source |
//! |---|---|---|
//! | RMS | `sqrt(1/N sum x_i^2)` | D 4.1, D A.1 |
//! | peak | `max |x_i|` | D A.2 |
//! | peak to peak | `max x_i - min x_i` | D A.2 |
//! | crest factor | `max |x| / RMS`, and two alternates | D A.2 |
//! | kurtosis, FM4 | `N sum (x - m)^4 / [sum (x - m)^2]^2` | D 4.2, D A.3; Stewart 1977 |
//! | M6A, M8A | `N^2 sum (x - m)^6 / [..]^3`, `N^3 sum (x - m)^8 / [..]^4` | D 4.3; Martin 1989 |
//! | skewness | `1/N sum (x - m)^3 / sigma^3` | - |
//! | energy operator | kurtosis of `x_i^2 - x_(i+1) x_(i-1)`; ends cyclic for averages, see [`Ends`] | D A.4; Ma 1995 |
//! | S_alpha | `1/N sum |x - m|^alpha / sigma^alpha` | see [`normalized_moment`] |
//!
//! Conventions: N samples, m their mean, population moments (`1/N`). The index range `i = 2..N`
//! printed under D A.1 is read as `1..N`: dropping the first sample is not a root mean square.
//! Verified by `tests/indicators.rs`.

use crate::error::{HumsError, Result, finite_or_out_of_range};
use crate::moments::{BLOCK, MomentAccumulator, Moments};

/// Root mean square, unit of the signal.
///
/// # Errors
/// Empty signal or non-finite sample.
pub fn rms(signal: &[f64]) -> Result<f64> {
    Ok(Moments::of(signal)?.rms())
}

/// Largest absolute sample, unit of the signal.
///
/// # Errors
/// Empty signal or non-finite sample.
pub fn peak(signal: &[f64]) -> Result<f64> {
    Ok(Moments::of(signal)?.peak())
}

/// Largest minus smallest sample, unit of the signal.
///
/// # Errors
/// Empty signal, non-finite sample, or a range beyond `f64`.
pub fn peak_to_peak(signal: &[f64]) -> Result<f64> {
    peak_to_peak_of(&Moments::of(signal)?)
}

pub(crate) fn peak_to_peak_of(moments: &Moments) -> Result<f64> {
    finite_or_out_of_range("peak to peak", moments.max() - moments.min())
}

/// The three crest factors that D A.2 names. They differ for signals that are not symmetric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrestDefinition {
    /// `max |x| / RMS`: the one the dissertation uses (its "Eq. (2)" is A.2).
    AbsolutePeak,
    /// `(max x - min x) / RMS`.
    PeakToPeak,
    /// `max x / RMS`.
    Maximum,
}

/// Crest factor, dimensionless.
///
/// # Errors
/// [`HumsError::Undefined`] for a signal of zeros; empty signal or non-finite sample.
pub fn crest_factor(signal: &[f64], definition: CrestDefinition) -> Result<f64> {
    crest_factor_of(&Moments::of(signal)?, definition)
}

pub(crate) fn crest_factor_of(moments: &Moments, definition: CrestDefinition) -> Result<f64> {
    let rms = moments.rms();
    if rms <= 0.0 {
        return Err(HumsError::Undefined { what: "crest factor", reason: "the signal is zero everywhere" });
    }
    Ok(match definition {
        CrestDefinition::AbsolutePeak => moments.peak() / rms,
        CrestDefinition::PeakToPeak => moments.max() / rms - moments.min() / rms,
        CrestDefinition::Maximum => moments.max() / rms,
    })
}

/// Skewness, dimensionless; 0 for a symmetric distribution.
///
/// # Errors
/// [`HumsError::Undefined`] for a constant signal; empty signal or non-finite sample.
pub fn skewness(signal: &[f64]) -> Result<f64> {
    Moments::of(signal)?.standardized(3)
}

/// Kurtosis, dimensionless; 3 for Gaussian noise, 1.5 for a sine. That of a difference signal is [`fm4`].
///
/// # Errors
/// [`HumsError::Undefined`] for a constant signal; empty signal or non-finite sample.
pub fn kurtosis(signal: &[f64]) -> Result<f64> {
    Moments::of(signal)?.standardized(4)
}

/// FM4: kurtosis of a difference signal (Stewart 1977; D 4.2), dimensionless; 3 for Gaussian noise, more where a tooth knocks.
///
/// ```
/// let mut difference: Vec<f64> = (0..1024).map(|i| (0.37 * f64::from(i)).sin()).collect();
/// let smooth = hums::fm4(&difference)?;
/// difference[500] += 8.0;
/// assert!(smooth < 1.6 && hums::fm4(&difference)? > 3.0);
/// # Ok::<(), hums::HumsError>(())
/// ```
///
/// # Errors
/// [`HumsError::Undefined`] for a constant signal; empty signal or non-finite sample.
pub fn fm4(difference: &[f64]) -> Result<f64> {
    kurtosis(difference)
}

/// M6A: sixth standardised moment, 15 for Gaussian noise, 2.5 for a sine.
///
/// # Errors
/// [`HumsError::Undefined`] for a constant signal; empty signal or non-finite sample.
pub fn m6a(difference: &[f64]) -> Result<f64> {
    Moments::of(difference)?.standardized(6)
}

/// M8A: eighth standardised moment, 105 for Gaussian noise, 4.375 for a sine.
///
/// # Errors
/// [`HumsError::Undefined`] for a constant signal; empty signal or non-finite sample.
pub fn m8a(difference: &[f64]) -> Result<f64> {
    Moments::of(difference)?.standardized(8)
}

/// What follows the last sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// The first one: the signal is one period of a periodic signal (a synchronous average).
    Cyclic,
    /// Nothing: a record. Its first and last sample have no Teager energy. Joining them, as D A.4 does for
    /// averages, makes an impulse of the step between the ends.
    Open,
}

/// Energy operator: kurtosis of the Teager-Kaiser energy `x_i^2 - x_(i+1) x_(i-1)` (D A.4). 9 for white
/// Gaussian noise (`z = a^2 - b c` has variance 3 and fourth central moment 81, in units of sigma).
///
/// A sampled sine has *constant* Teager energy `A^2 sin^2(omega)`, so the indicator is undefined for it (with
/// cyclic ends: for a whole number of periods).
///
/// # Errors
/// Fewer than three samples, a non-finite sample, or constant Teager energy.
pub fn energy_operator(signal: &[f64], ends: Ends) -> Result<f64> {
    energy_operator_scaled(signal, crate::moments::peak(signal), ends)
}

pub(crate) fn energy_operator_scaled(signal: &[f64], peak: f64, ends: Ends) -> Result<f64> {
    let mut accumulator = TeagerAccumulator::with_peak(peak, ends);
    accumulator.push(signal).and_then(|()| accumulator.finish(peak)).map_err(|error| {
        match signal.iter().position(|x| !x.is_finite()) {
            // A fault found in derived samples is restated in terms of the signal's own.
            Some(index) => HumsError::NotFinite { what: ENERGY_OPERATOR, index, value: signal[index] },
            None => error,
        }
    })
}

const ENERGY_OPERATOR: &str = "energy operator";

/// Streaming kurtosis of the Teager energy; cyclic ends are added last.
#[derive(Debug, Clone)]
pub(crate) struct TeagerAccumulator {
    ends: Ends,
    /// Power of two the samples are multiplied by, which keeps the squares in range and is exact.
    scale: f64,
    first: [f64; 2],
    last: [f64; 2],
    count: usize,
    moments: MomentAccumulator,
}

/// Power of two near 1 / peak.
fn inverse_scale(peak: f64) -> f64 {
    if peak > 0.0 && peak.is_finite() { (-peak.log2().floor()).clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
}

impl TeagerAccumulator {
    /// For samples of the order of `peak` (unit of the signal).
    pub(crate) fn with_peak(peak: f64, ends: Ends) -> Self {
        Self {
            ends,
            scale: inverse_scale(peak),
            first: [0.0; 2],
            last: [0.0; 2],
            count: 0,
            moments: MomentAccumulator::default(),
        }
    }

    fn teager(&self, before: f64, x: f64, after: f64) -> f64 {
        let x = x * self.scale;
        x * x - (after * self.scale) * (before * self.scale)
    }

    /// What was pushed and what comes are no neighbours: a gap lies between them. Only for open ends.
    pub(crate) fn interrupt(&mut self) {
        debug_assert_eq!(self.ends, Ends::Open);
        self.count = 0;
    }

    pub(crate) fn push(&mut self, samples: &[f64]) -> Result<()> {
        // The seam with what came before, then whole windows.
        for (i, &x) in samples.iter().take(2).enumerate() {
            match self.count + i {
                0 => self.first[0] = x,
                1 => self.first[1] = x,
                _ => {
                    let energy = self.teager(self.last[0], self.last[1], x);
                    self.moments.push(&[energy])?;
                }
            }
            self.last = [self.last[1], x];
        }
        let mut buffer = [0.0; BLOCK];
        let mut start = 0;
        while start + 2 < samples.len() {
            let count = BLOCK.min(samples.len() - 2 - start);
            let part = &samples[start..start + count + 2];
            for (out, w) in buffer[..count].iter_mut().zip(part.windows(3)) {
                *out = self.teager(w[0], w[1], w[2]);
            }
            self.moments.push(&buffer[..count])?;
            start += count;
        }
        if let [.., before, last] = *samples {
            self.last = [before, last];
        }
        self.count += samples.len();
        Ok(())
    }

    /// The indicator; `peak` is the largest absolute sample pushed.
    pub(crate) fn finish(mut self, peak: f64) -> Result<f64> {
        if self.moments.count() == 0 {
            return Err(HumsError::TooShort { what: ENERGY_OPERATOR, needed: 3, found: self.count });
        }
        if self.ends == Ends::Cyclic {
            let ends = [
                self.teager(self.last[0], self.last[1], self.first[0]),
                self.teager(self.last[1], self.first[0], self.first[1]),
            ];
            self.moments.push(&ends)?;
        }
        let moments = self.moments.finish()?;
        // Squares carry rounding of order epsilon relative to the squared peak (4 at most once
        // multiplied by its own power of two).
        let unit = self.scale / inverse_scale(peak);
        if moments.standard_deviation() <= 16.0 * f64::EPSILON * unit * unit {
            return Err(HumsError::Undefined { what: ENERGY_OPERATOR, reason: "the Teager energy is constant" });
        }
        moments.standardized(4)
    }
}

/// Normalised absolute central moment of real order, `1/N sum |x - m|^alpha / sigma^alpha`,
/// alpha in (0, 16].
///
/// The dissertation lists S_r and S_alpha among the "other moments of the vibration" without
/// formulas. This is the family those names are read as here: alpha = 2 gives 1, 4 gives FM4,
/// 6 gives M6A, 8 gives M8A. Gaussian noise: `2^(alpha/2) Gamma((alpha+1)/2) / sqrt(pi)`.
///
/// # Errors
/// [`HumsError::Parameter`] for an order out of range; [`HumsError::Undefined`] for a constant
/// signal; empty signal or non-finite sample.
pub fn normalized_moment(signal: &[f64], alpha: f64) -> Result<f64> {
    if !(alpha > 0.0 && alpha <= 16.0) {
        return Err(HumsError::Parameter { parameter: "alpha", value: alpha, allowed: "above 0, at most 16" });
    }
    let moments = Moments::of(signal)?;
    if moments.is_constant() {
        return Err(HumsError::Undefined { what: "S_alpha", reason: "the signal is constant, its variance is zero" });
    }
    let (mean, sigma) = (moments.mean(), moments.standard_deviation());
    // Sums of blocks keep the rounding error of long records small.
    let sum: f64 = signal
        .chunks(BLOCK)
        .map(|block| block.iter().map(|x| ((x - mean).abs() / sigma).powf(alpha)).sum::<f64>())
        .sum();
    finite_or_out_of_range("S_alpha", sum / signal.len() as f64)
}
