//! Several modes ringing at once, and their indicators in closed form.
//!
//! Problem. D 4.6 treats one mode and leaves a transmission's several for the future. A sum of
//! damped cosines is a sum of complex exponentials, `y(t) = sum_k c_k e^(s_k t)`, with
//! `s_k = -zeta w_n +- i w_d`, `c_k = a/2 e^(+-i phi)`. Its powers are such sums again, so
//! `int_0^L y^p dt = sum over multisets (p! / prod m_k!) prod c_k^(m_k) (e^(S L) - 1) / S`,
//! `S = sum m_k s_k`, is exact for any number of modes: p-th order has `C(p + 2M - 1, p)` terms for
//! M modes (495 for M = 2, 6435 for M = 4 at p = 8), half of them complex conjugates of the others.
//!
//! Units: amplitude in the signal's unit, frequencies in Hz, phases in rad, times in s.
//! Verified by `tests/phenomenon.rs` against quadrature.

use super::ClosedForm;
use crate::error::{HumsError, Result, require_positive};
use gear_numerics::fft::Complex;
use std::f64::consts::TAU;

/// Modes at most: the number of terms of the eighth moment grows as the eighth power.
pub const MAX_MODES: usize = 8;

/// One damped mode `a e^(-zeta w_n t) cos(w_d t + phi)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// a, unit of the signal.
    pub amplitude: f64,
    /// phi, rad; a sine has -pi/2.
    pub phase: f64,
    /// w_n / 2 pi, Hz, > 0.
    pub natural_frequency: f64,
    /// zeta, at least 0 and below 1.
    pub damping: f64,
}

impl Mode {
    /// Pole `-zeta w_n + i w_d`, rad/s.
    #[must_use]
    pub fn pole(&self) -> Complex<f64> {
        let w = TAU * self.natural_frequency;
        Complex::new(-self.damping * w, w * (1.0 - self.damping * self.damping).sqrt())
    }

    /// Value at time t (s).
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        let s = self.pole();
        self.amplitude * (s.re * t).exp() * (s.im * t + self.phase).cos()
    }
}

/// A sum of damped modes that starts at time 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalResponse {
    modes: Vec<Mode>,
}

impl ModalResponse {
    /// Checks and keeps the modes, at most [`MAX_MODES`].
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for a mode out of range or too many; none at all.
    pub fn new(modes: Vec<Mode>) -> Result<Self> {
        if modes.is_empty() || modes.len() > MAX_MODES {
            return Err(HumsError::Parameter {
                parameter: "number of modes",
                value: modes.len() as f64,
                allowed: "1 to 8",
            });
        }
        for mode in &modes {
            require_positive("natural frequency", mode.natural_frequency)?;
            if !(0.0..1.0).contains(&mode.damping) {
                return Err(HumsError::Parameter {
                    parameter: "damping ratio",
                    value: mode.damping,
                    allowed: "at least 0, below 1",
                });
            }
            if !(mode.amplitude.is_finite() && mode.phase.is_finite()) {
                return Err(HumsError::Parameter {
                    parameter: "amplitude or phase of a mode",
                    value: mode.amplitude + mode.phase,
                    allowed: "finite",
                });
            }
        }
        Ok(Self { modes })
    }

    /// The modes.
    #[must_use]
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Value at time t (s), 0 before time 0 (and for NaN or infinite times).
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        if !(0.0..f64::INFINITY).contains(&t) {
            return 0.0;
        }
        self.modes.iter().map(|mode| mode.value(t)).sum()
    }

    /// `int_0^length y^p dt`, unit^p s, for p = 0..=8.
    fn integrals(&self, length: f64) -> [f64; 9] {
        let mut total = [0.0; 9];
        let half = |mode: &Mode| Complex::from_polar(mode.amplitude / 2.0, mode.phase);
        let terms: Vec<_> =
            self.modes.iter().flat_map(|m| [(half(m), m.pole()), (half(m).conj(), m.pole().conj())]).collect();
        expand(&terms, 0, 0, Complex::new(1.0, 0.0), Complex::new(0.0, 0.0), length, &mut total);
        let mut factorial = 1.0;
        for (p, sum) in total.iter_mut().enumerate() {
            factorial *= p.max(1) as f64;
            *sum *= factorial;
        }
        total
    }

    /// Indicators over a record of `duration` s in which the response begins at `delay` (s).
    ///
    /// # Errors
    /// [`HumsError::Parameter`] unless `0 <= delay < duration`; [`HumsError::Undefined`] when the
    /// response has no variance; [`HumsError::OutOfRange`].
    pub fn indicators(&self, delay: f64, duration: f64) -> Result<ClosedForm> {
        require_positive("duration", duration)?;
        if !(delay >= 0.0 && delay < duration) {
            return Err(HumsError::Parameter {
                parameter: "delay",
                value: delay,
                allowed: "at least 0, below the duration",
            });
        }
        // Standardised moments do not depend on the scale: compute them near 1.
        let scale = self.modes.iter().map(|m| m.amplitude.abs()).fold(0.0, f64::max);
        if !(scale > 0.0) {
            return Err(HumsError::Undefined { what: "closed-form indicator", reason: "all modes have amplitude 0" });
        }
        let mut unit = self.clone();
        unit.modes.iter_mut().for_each(|m| m.amplitude /= scale);
        let mut raw = unit.integrals(duration - delay).map(|x| x / duration);
        raw[0] = 1.0;
        let form = ClosedForm::from_raw_moments(&raw)?;
        let variance = crate::error::finite_or_out_of_range("variance", form.variance * scale * scale)?;
        Ok(ClosedForm { mean: form.mean * scale, variance, rms: form.rms * scale, ..form })
    }
}

/// Adds the terms of all powers that use exponentials `first..` to what is already chosen:
/// `product` = prod c_k^(m_k) / m_k!, `exponent` = sum m_k s_k.
fn expand(
    terms: &[(Complex<f64>, Complex<f64>)],
    first: usize,
    power: usize,
    product: Complex<f64>,
    exponent: Complex<f64>,
    length: f64,
    total: &mut [f64; 9],
) {
    if first == terms.len() {
        // Conjugate multisets add up to a real number, so the real part of each is enough.
        total[power] += (product * exponential_integral(exponent, length)).re;
        return;
    }
    let (c, s) = terms[first];
    let (mut product, mut exponent) = (product, exponent);
    for m in 0..=8 - power {
        if m > 0 {
            product = product * c / m as f64;
            exponent += s;
        }
        expand(terms, first + 1, power + m, product, exponent, length, total);
    }
}

/// `int_0^L e^(S t) dt = (e^(S L) - 1) / S`, by its series for small `S L`.
fn exponential_integral(s: Complex<f64>, length: f64) -> Complex<f64> {
    let z = s * length;
    if z.norm() < 0.5 {
        let one = Complex::new(1.0, 0.0);
        let (mut term, mut sum) = (one, one);
        for k in 2..24 {
            term = term * z / k as f64;
            sum += term;
        }
        return sum * length;
    }
    (z.exp() - 1.0) / s
}
