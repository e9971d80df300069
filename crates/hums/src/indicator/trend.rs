//! Indicators with a memory: NA4, NA4*, NB4.
//!
//! Problem. FM4 falls back to 3 when damage spreads, since numerator and denominator then grow
//! together. NA4 divides the fourth moment of the present residual signal by the square of the
//! variance *averaged over the records so far* (Zakrajsek, Townsend and Decker 1993, NASA TM-105950):
//! `NA4 = 1/N sum_i (r_iM - m_M)^4 / (1/M sum_(j=1..M) var_j)^2`.
//! With one record (M = 1) it is the kurtosis of the residual (D B.2).
//!
//! | variant | memory |
//! |---|---|
//! | NA4 | all records so far ([`Memory::Running`]) |
//! | NA4, reset | starts again when load or speed changes: [`QuasiKurtosis::reset`] (cf. Dempsey and Zakrajsek 2001) |
//! | NA4* | mean of the healthy variances, locked once a variance passes their mean + z sigma ([`Memory::Locked`]; Decker, Handschuh and Zakrajsek 1994, An enhancement to the NA4 gear vibration diagnostic parameter) |
//! | NB4 | any of these, fed with the envelope of the mesh band (Zakrajsek, Handschuh and Decker 1994, Application of fault detection techniques to spiral bevel gear fatigue data): [`crate::envelope::demodulate`] |
//!
//! Verified by `tests/indicators.rs`.

use crate::error::{HumsError, Result, finite_or_out_of_range};
use crate::moments::Moments;

/// Which records make the reference variance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Memory {
    /// All records up to and including the present one.
    #[default]
    Running,
    /// Records until one's variance exceeds mean + `z` standard deviations of the variances before
    /// it; that record and all later ones leave the reference alone. The test needs at least
    /// `learn` records (>= 2), which are all taken as healthy.
    Locked {
        /// Limit in standard deviations of the healthy variances, >= 0.
        z: f64,
        /// Records taken as healthy.
        learn: usize,
    },
}

/// Running quasi-normalised kurtosis (NA4 on residual signals, NB4 on envelopes).
#[derive(Debug, Clone, Default)]
pub struct QuasiKurtosis {
    memory: Memory,
    count: u64,
    mean_variance: f64,
    /// Sum of squared deviations of the variances from their mean (Welford).
    spread: f64,
    locked: bool,
}

impl QuasiKurtosis {
    /// A tracker without history.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for a negative or non-finite `z` or `learn` below 2.
    pub fn new(memory: Memory) -> Result<Self> {
        if let Memory::Locked { z, learn } = memory {
            if !(z.is_finite() && z >= 0.0) {
                return Err(HumsError::Parameter { parameter: "z", value: z, allowed: "finite and >= 0" });
            }
            if learn < 2 {
                return Err(HumsError::Parameter {
                    parameter: "learn",
                    value: learn as f64,
                    allowed: "at least 2 records",
                });
            }
        }
        Ok(Self { memory, ..Self::default() })
    }

    /// Forgets all records: for a change of load or speed.
    pub fn reset(&mut self) {
        *self = Self { memory: self.memory, ..Self::default() };
    }

    /// Records in the reference variance.
    #[must_use]
    pub fn records(&self) -> u64 {
        self.count
    }

    /// The reference no longer changes (only [`Memory::Locked`]).
    #[must_use]
    pub fn is_locked(&self) -> bool {
        self.locked
    }

    /// Takes the next record (in time order) and returns its value, dimensionless.
    ///
    /// # Errors
    /// Empty or non-finite record; [`HumsError::Undefined`] when all variances so far are zero.
    pub fn update(&mut self, signal: &[f64]) -> Result<f64> {
        self.update_moments(&Moments::of(signal)?)
    }

    /// As [`Self::update`], from moments.
    ///
    /// # Errors
    /// As [`Self::update`].
    pub fn update_moments(&mut self, moments: &Moments) -> Result<f64> {
        let constant = moments.is_constant();
        let variance = if constant { 0.0 } else { moments.variance()? };
        if !self.locked && !self.exceeds(variance) {
            self.count += 1;
            let step = variance - self.mean_variance;
            self.mean_variance += step / self.count as f64;
            self.spread += step * (variance - self.mean_variance);
        }
        if self.mean_variance <= 0.0 {
            return Err(HumsError::Undefined {
                what: "quasi-normalised kurtosis",
                reason: "every record so far has zero variance",
            });
        }
        if constant {
            return Ok(0.0);
        }
        let ratio = variance / self.mean_variance;
        finite_or_out_of_range("quasi-normalised kurtosis", moments.standardized(4)? * ratio * ratio)
    }

    fn exceeds(&mut self, variance: f64) -> bool {
        if let Memory::Locked { z, learn } = self.memory
            && self.count >= learn as u64
        {
            let sigma = (self.spread / (self.count - 1) as f64).sqrt();
            self.locked = variance > self.mean_variance + z * sigma;
        }
        self.locked
    }
}
