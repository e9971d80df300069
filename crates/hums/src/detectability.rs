//! Probability of detection over the size of damage, from recordings with and without an alarm.
//!
//! Problem. "90 % detected" says little from ten recordings. What an inspection may claim is the size `a_90/95`: with 95 % confidence, at
//! least 90 % of damages of this size are detected (MIL-HDBK-1823A).
//!
//! Method. Hit-miss data follow `POD(a) = 1 / (1 + exp(-(b_0 + b_1 a)))`, b by maximum likelihood (Newton's method, which is iteratively reweighted least
//! squares). With V the inverse of the information matrix, the lower bound of the linear predictor is
//! `b_0 + b_1 a - z sqrt(V_00 + 2 a V_01 + a^2 V_11)`, z = 1.645 for one side of 95 % (Wald); `a_90/95` is where it reaches ln 9.
//!
//! Where all alarms lie above all others in size, the likelihood has no maximum, and nothing is said about sizes between: an error says so.
//!
//! | symbol | field or function | unit |
//! |---|---|---|
//! | a | severity | the user's |
//! | b_0, b_1 | `intercept`, `slope` | 1, 1 / unit of a |
//! | a_90 | [`HitMiss::size_detected`] (0.9) | unit of a |
//! | a_90/95 | [`HitMiss::size_detected_with_confidence`] (0.9) | unit of a |
//!
//! Verified by `tests/detectability.rs`.

use crate::error::{HumsError, Result, require_finite, require_len};

/// Logistic probability of detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HitMiss {
    /// b_0.
    pub intercept: f64,
    /// b_1 > 0, per unit of severity.
    pub slope: f64,
    /// V_00, V_01, V_11.
    covariance: [f64; 3],
}

/// One-sided 95 % quantile of the normal distribution.
const Z: f64 = 1.644_853_626_951_472_7;
const ITERATIONS: usize = 100;
const WHAT: &str = "probability of detection";

impl HitMiss {
    /// From severities and whether each was detected.
    ///
    /// # Errors
    /// [`HumsError::Undefined`] without detections or without misses, where all detections lie above all misses, and where
    /// detection does not rise with severity; different lengths; non-finite severities.
    pub fn fit(severities: &[f64], detected: &[bool]) -> Result<Self> {
        require_len(WHAT, severities, 3)?;
        require_finite(WHAT, severities)?;
        if severities.len() != detected.len() {
            return Err(HumsError::LengthMismatch { what: WHAT, left: severities.len(), right: detected.len() });
        }
        let undefined = |reason| Err(HumsError::Undefined { what: WHAT, reason });
        let of = |hit: bool| severities.iter().zip(detected).filter(move |(_, d)| **d == hit).map(|(a, _)| *a);
        let (Some(first_hit), Some(last_miss)) = (of(true).reduce(f64::min), of(false).reduce(f64::max)) else {
            return undefined("all or none are detected: add smaller or larger severities");
        };
        if first_hit >= last_miss {
            return undefined(
                "all detections lie above all misses: add severities between them, or more recordings of each",
            );
        }
        // Standardised severities keep the equations well conditioned.
        let n = severities.len() as f64;
        let mean = severities.iter().sum::<f64>() / n;
        let scale = (severities.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / n).sqrt();
        if !(scale > 0.0 && scale.is_finite()) {
            return undefined("there is only one severity");
        }
        let (mut b0, mut b1) = (0.0, 0.0);
        for _ in 0..ITERATIONS {
            let (mut gradient, mut information) = ([0.0; 2], [0.0; 3]);
            for (a, hit) in severities.iter().zip(detected) {
                let x = (a - mean) / scale;
                let p = logistic(b0 + b1 * x);
                let (rest, weight) = (f64::from(u8::from(*hit)) - p, p * (1.0 - p));
                gradient[0] += rest;
                gradient[1] += rest * x;
                information[0] += weight;
                information[1] += weight * x;
                information[2] += weight * x * x;
            }
            let determinant = information[0] * information[2] - information[1] * information[1];
            if !(determinant > 1e-12 * information[0] * information[2]) {
                return undefined("the data do not determine how detection rises with severity");
            }
            let step = [
                (information[2] * gradient[0] - information[1] * gradient[1]) / determinant,
                (information[0] * gradient[1] - information[1] * gradient[0]) / determinant,
            ];
            // A long step leaves the region where the curvature holds.
            let damping = (4.0 / step[0].abs().max(step[1].abs())).min(1.0);
            b0 += damping * step[0];
            b1 += damping * step[1];
            if step[0].abs().max(step[1].abs()) < 1e-12 {
                if b1 <= 0.0 {
                    return undefined("detection does not rise with severity");
                }
                let inverse = [information[2], -information[1], information[0]].map(|v| v / determinant);
                // Back to the severities' own unit: c_0 = b_0 - b_1 mean / scale, c_1 = b_1 / scale.
                let t = mean / scale;
                let covariance = [
                    inverse[0] - 2.0 * t * inverse[1] + t * t * inverse[2],
                    (inverse[1] - t * inverse[2]) / scale,
                    inverse[2] / (scale * scale),
                ];
                return Ok(Self { intercept: b0 - b1 * t, slope: b1 / scale, covariance });
            }
        }
        Err(HumsError::NoConvergence { what: WHAT, iterations: ITERATIONS })
    }

    /// Probability of detection of a severity.
    #[must_use]
    pub fn probability(&self, severity: f64) -> f64 {
        logistic(self.intercept + self.slope * severity)
    }

    fn bound(&self, severity: f64, sign: f64) -> f64 {
        let [v00, v01, v11] = self.covariance;
        let variance = v00 + 2.0 * severity * v01 + severity * severity * v11;
        self.intercept + self.slope * severity + sign * Z * variance.max(0.0).sqrt()
    }

    /// Lower and upper 95 % bound (each one-sided) of the probability of detection of a severity.
    #[must_use]
    pub fn bounds(&self, severity: f64) -> (f64, f64) {
        (logistic(self.bound(severity, -1.0)), logistic(self.bound(severity, 1.0)))
    }

    /// Severity that is detected with a probability in (0, 1): a_90 for 0.9.
    #[must_use]
    pub fn size_detected(&self, probability: f64) -> f64 {
        (logit(probability) - self.intercept) / self.slope
    }

    /// Severity that is detected with at least this probability at 95 % confidence: a_90/95 for 0.9. `None` where the data are too few for any
    /// size.
    #[must_use]
    pub fn size_detected_with_confidence(&self, probability: f64) -> Option<f64> {
        // (c_1^2 - z^2 V_11) a^2 - 2 ((g - c_0) c_1 + z^2 V_01) a + (g - c_0)^2 - z^2 V_00 = 0, the larger root.
        let [v00, v01, v11] = self.covariance;
        let (g, z2) = (logit(probability) - self.intercept, Z * Z);
        let a = self.slope * self.slope - z2 * v11;
        let half_b = g * self.slope + z2 * v01;
        let c = g * g - z2 * v00;
        let root = half_b * half_b - a * c;
        let found = (half_b + root.max(0.0).sqrt()) / a;
        (a > 0.0 && root >= 0.0 && found.is_finite()).then_some(found)
    }
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

fn logit(probability: f64) -> f64 {
    let p = probability.clamp(1e-12, 1.0 - 1e-12);
    (p / (1.0 - p)).ln()
}
