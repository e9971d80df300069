//! Phenomenon-based model of a damage-induced response (D 4.5, 4.6): a damped sine after a delay.
//!
//! Problem. When a damaged tooth meshes, the difference signal rings like a one-mass oscillator:
//! `y(t) = A e^(-zeta w_n (t - t_d)) sin[w_d (t - t_d)]`, zero before `t_d` (D 4.4). What do RMS,
//! FM4 and M8A say about A, and why do the last two not depend on it?
//!
//! | symbol | field or function | unit |
//! |---|---|---|
//! | A | `amplitude` | unit of the signal |
//! | t_d | `delay` | s |
//! | w_n / 2 pi | `natural_frequency` | Hz |
//! | zeta | `damping`, 0 < zeta < 1 | - |
//! | w_d = w_n sqrt(1 - zeta^2) | [`DampedSine::damped_frequency`] / 2 pi | Hz |
//! | delta = 2 pi zeta / sqrt(1 - zeta^2) | [`DampedSine::log_decrement`] | - |
//! | A_i, i = 1, 2, .. | [`DampedSine::extremum`] | unit of the signal |
//! | n = round(2 w_d T / 2 pi) | [`DampedSine::half_cycles`] | - |
//!
//! Four routes to the indicators of a record of length T, from exact to simple:
//! [`DampedSine::samples`] with [`crate::indicator`]; [`DampedSine::exact_indicators`] (time
//! integrals in closed form, no approximation); [`AmplitudeDensity::indicators`] (D 4.13 through the
//! density D 4.11, 4.12); [`simplified_indicators`] (D 4.14).
//!
//! For A = 2.798 um, t_d = 0.475303 ms, zeta = 0.03992, 2733.33 Hz and one pinion turn (27 mesh
//! cycles at 1800 Hz, T = 15 ms), measured by `examples/phenomenon.rs`:
//!
//! | route | RMS, um | FM4 | M8A |
//! |---|---|---|---|
//! | 1351 samples, 50 a mesh cycle, both ends | 0.435742 | 15.3198 | 9142.8 |
//! | 1350 samples, 50 a mesh cycle | 0.435904 | 15.3084 | 9122.4 |
//! | exact integrals | 0.435908 | 15.3079 | 9121.8 |
//! | density (4.13), n = 82 | 0.435857 | 15.3130 | 9129.7 |
//! | density (4.13), n = 81 | 0.438539 | 15.1258 | 8798.4 |
//! | simplified (4.14), n = 82 | 0.435857 | 15.3575 | 9246.5 |
//! | printed in D 4.5.2 | 0.435736 | - | - |
//!
//! The printed RMS is that of 1351 samples to 2e-5; the printed A and zeta are rounded to 2e-4 and
//! 1e-4. Density (n = 82) and 1351 samples differ by 0.03, 0.04 and 0.14 %, as D 4.6.1.3 states; much
//! of that is the sample counted twice, for against the exact integrals they differ by 0.01, 0.03 and
//! 0.09 %.
//!
//! The dissertation's print and its derivation disagree in four places; the code follows the derivation. They are
//! listed with their effect in `docs/signals.md`, "Misprints of chapter 4".
//!
//! [`modes`] holds several modes, with exact closed forms; [`fit`] finds A and t_d (and frequency
//! and damping); [`crate::modal_fit`] finds several modes.
//! Verified by `tests/phenomenon.rs`.

pub mod fit;
pub mod modes;

use crate::error::{HumsError, Result, require_positive};
use modes::ModalResponse;
use std::f64::consts::{PI, TAU};

/// The model's four parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampedSine {
    /// A, unit of the signal; may be negative.
    pub amplitude: f64,
    /// t_d, s, finite.
    pub delay: f64,
    /// w_n / 2 pi, Hz, > 0.
    pub natural_frequency: f64,
    /// zeta, between 0 and 1 (both excluded).
    pub damping: f64,
}

/// RMS, FM4, M8A and what goes with them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedForm {
    /// mu, unit of the signal.
    pub mean: f64,
    /// sigma^2, unit^2.
    pub variance: f64,
    /// sqrt of the mean square, unit of the signal.
    pub rms: f64,
    /// Fourth standardised moment.
    pub fm4: f64,
    /// Sixth standardised moment.
    pub m6a: f64,
    /// Eighth standardised moment.
    pub m8a: f64,
}

impl ClosedForm {
    /// From raw moments `E[y^p]`, p = 0..=8: `E[(y - mu)^p] = sum_k C(p,k) (-mu)^(p-k) E[y^k]`.
    ///
    /// # Errors
    /// [`HumsError::Undefined`] without variance; [`HumsError::OutOfRange`].
    pub fn from_raw_moments(raw: &[f64; 9]) -> Result<Self> {
        const WHAT: &str = "closed-form indicator";
        let mean = raw[1];
        let central = |p: usize| -> f64 {
            let mut binomial = 1.0;
            let mut sum = 0.0;
            for k in (0..=p).rev() {
                sum += binomial * (-mean).powi((p - k) as i32) * raw[k];
                binomial = binomial * k as f64 / (p - k + 1) as f64;
            }
            sum
        };
        let variance = central(2);
        if !(variance > 0.0) {
            return Err(HumsError::Undefined { what: WHAT, reason: "the signal has no variance" });
        }
        let form = Self {
            mean,
            variance,
            rms: raw[2].max(0.0).sqrt(),
            fm4: central(4) / variance.powi(2),
            m6a: central(6) / variance.powi(3),
            m8a: central(8) / variance.powi(4),
        };
        if [form.rms, form.fm4, form.m6a, form.m8a].iter().all(|v| v.is_finite()) {
            Ok(form)
        } else {
            Err(HumsError::OutOfRange { what: WHAT })
        }
    }
}

impl DampedSine {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for one out of range.
    pub fn validate(&self) -> Result<()> {
        for (parameter, value) in [("amplitude", self.amplitude), ("delay", self.delay)] {
            if !value.is_finite() {
                return Err(HumsError::Parameter { parameter, value, allowed: "finite" });
            }
        }
        require_positive("natural frequency", self.natural_frequency)?;
        if !(self.damping > 0.0 && self.damping < 1.0) {
            return Err(HumsError::Parameter {
                parameter: "damping ratio",
                value: self.damping,
                allowed: "above 0, below 1",
            });
        }
        Ok(())
    }

    fn root(&self) -> f64 {
        (1.0 - self.damping * self.damping).sqrt()
    }

    /// Damped natural frequency, Hz.
    #[must_use]
    pub fn damped_frequency(&self) -> f64 {
        self.natural_frequency * self.root()
    }

    /// Logarithmic decrement delta over a damped period.
    #[must_use]
    pub fn log_decrement(&self) -> f64 {
        TAU * self.damping / self.root()
    }

    /// `y(t)`, unit of the signal; t in s (0 before the delay, and for NaN or infinite times).
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        let tau = t - self.delay;
        if !(tau > 0.0 && tau < f64::INFINITY) {
            return 0.0;
        }
        let decay = TAU * self.natural_frequency * self.damping;
        self.amplitude * (-decay * tau).exp() * (TAU * self.damped_frequency() * tau).sin()
    }

    /// `count` samples at `rate` (Hz), the first at t = 0.
    ///
    /// # Errors
    /// Parameters or rate out of range.
    pub fn samples(&self, count: usize, rate: f64) -> Result<Vec<f64>> {
        self.validate()?;
        require_positive("sampling rate", rate)?;
        Ok((0..count).map(|i| self.value(i as f64 / rate)).collect())
    }

    /// Time of the first extremum, s: `t_d + atan(w_d / (zeta w_n)) / w_d`.
    #[must_use]
    pub fn time_of_maximum(&self) -> f64 {
        self.delay + (self.root() / self.damping).atan() / (TAU * self.damped_frequency())
    }

    /// Extremum `A_i`, i from 1 (0 is read as 1): `A_1 = y(t_max)`, `A_(i+1) = -A_i e^(-delta/2)`.
    #[must_use]
    pub fn extremum(&self, i: usize) -> f64 {
        let root = self.root();
        let first = self.amplitude * root * (-(self.damping / root) * (root / self.damping).atan()).exp();
        let k = i.max(1) - 1;
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        sign * first * (-self.log_decrement() * k as f64 / 2.0).exp()
    }

    /// Half cycles in a record of `duration` s: `w_d T / pi` rounded to the nearest whole number.
    #[must_use]
    pub fn half_cycles(&self, duration: f64) -> usize {
        // A float beyond the range of usize saturates.
        (2.0 * self.damped_frequency() * duration).round().max(0.0) as usize
    }

    /// As a sum of modes with one member; the delay is not part of it.
    ///
    /// # Errors
    /// Parameters out of range.
    pub fn modes(&self) -> Result<ModalResponse> {
        self.validate()?;
        ModalResponse::new(vec![modes::Mode {
            amplitude: self.amplitude,
            phase: -PI / 2.0,
            natural_frequency: self.natural_frequency,
            damping: self.damping,
        }])
    }

    /// Indicators of the model over a record of `duration` s (from t = 0, the part before the delay
    /// being zero), by exact time integrals of `y^p`: no approximation but rounding.
    ///
    /// # Errors
    /// Parameters out of range; [`HumsError::Parameter`] unless `0 <= delay < duration`;
    /// [`HumsError::Undefined`] for amplitude 0.
    pub fn exact_indicators(&self, duration: f64) -> Result<ClosedForm> {
        self.modes()?.indicators(self.delay, duration)
    }

    /// The approximate amplitude density of a record with `n` half cycles.
    ///
    /// # Errors
    /// Parameters out of range; `n` = 0; amplitude 0.
    pub fn density(&self, n: usize) -> Result<AmplitudeDensity> {
        self.validate()?;
        AmplitudeDensity::new(self.extremum(1), self.log_decrement(), n)
    }
}

/// Approximate amplitude density of n half cycles (D 4.11 for even, D 4.12 for odd n, in one form):
/// `f(y) = sum 2 / (n pi sqrt(A_i^2 - y^2))` over the extrema `A_i`, i = 1..=n, that have the sign of
/// y and pass it. Every half cycle counts as half a cycle of an undamped sine of its own extremum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplitudeDensity {
    first: f64,
    delta: f64,
    n: usize,
}

impl AmplitudeDensity {
    /// First extremum `A_1` (unit of the signal, not 0), logarithmic decrement (> 0), half cycles
    /// (1 to 10^7).
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for one out of range.
    pub fn new(first: f64, delta: f64, n: usize) -> Result<Self> {
        if !(first.is_finite() && first != 0.0) {
            return Err(HumsError::Parameter {
                parameter: "first extremum",
                value: first,
                allowed: "finite and not 0",
            });
        }
        require_positive("logarithmic decrement", delta)?;
        if !(1..=10_000_000).contains(&n) {
            return Err(HumsError::Parameter { parameter: "half cycles", value: n as f64, allowed: "1 to 10^7" });
        }
        Ok(Self { first, delta, n })
    }

    fn extremum(&self, i: usize) -> f64 {
        let sign = if i % 2 == 1 { 1.0 } else { -1.0 };
        sign * self.first * (-self.delta * (i - 1) as f64 / 2.0).exp()
    }

    /// Density at `y`, 1 / unit of the signal. It is 0 outside the extrema, and at an extremum
    /// (where the density is unbounded but integrable) that extremum's term is left out.
    #[must_use]
    pub fn density(&self, y: f64) -> f64 {
        if y.is_nan() {
            return 0.0;
        }
        self.sum(y, |a| 1.0 / ((a - y.abs()) * (a + y.abs())).sqrt())
    }

    /// Probability that the amplitude lies between 0 and `y`, at most that sign's share: the density
    /// integrated, `2 / (n pi) asin(min(|y| / |A_i|, 1))` summed.
    #[must_use]
    pub fn probability_between_zero_and(&self, y: f64) -> f64 {
        if y.is_nan() {
            return 0.0;
        }
        let sign = y.signum();
        (1..=self.n)
            .map(|i| self.extremum(i))
            .filter(|a| a * sign > 0.0)
            .map(|a| 2.0 / (self.n as f64 * PI) * (y / a).min(1.0).asin())
            .sum()
    }

    fn sum(&self, y: f64, term: impl Fn(f64) -> f64) -> f64 {
        let sign = if y < 0.0 { -1.0 } else { 1.0 };
        let mut total = 0.0;
        for i in 1..=self.n {
            let a = self.extremum(i);
            if a.abs() <= y.abs() {
                break;
            }
            if a * sign > 0.0 {
                total += term(a.abs());
            }
        }
        2.0 / (self.n as f64 * PI) * total
    }

    /// Raw moments `E[y^p]`, p = 0..=8: `2 W_p A_1^p / (n pi) sum_i (+-1)^p e^(-p delta (i-1)/2)` with
    /// Wallis' integrals `W_p = int_0^(pi/2) sin^p`; the sums are geometric series in closed form.
    #[must_use]
    pub fn raw_moments(&self) -> [f64; 9] {
        let n = self.n as f64;
        let mut wallis = [PI / 2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for p in 2..9 {
            wallis[p] = wallis[p - 2] * (p - 1) as f64 / p as f64;
        }
        std::array::from_fn(|p| {
            let decay = p as f64 * self.delta / 2.0;
            let sum = if p == 0 {
                n
            } else if p % 2 == 0 {
                // (1 - q^n) / (1 - q) without cancellation.
                (-n * decay).exp_m1() / (-decay).exp_m1()
            } else {
                let last = if self.n % 2 == 0 { 1.0 } else { -1.0 };
                (1.0 - last * (-n * decay).exp()) / (1.0 + (-decay).exp())
            };
            2.0 / (n * PI) * wallis[p] * self.first.powi(p as i32) * sum
        })
    }

    /// Closed forms D 4.13, all terms, with the coefficients of the derivation.
    ///
    /// # Errors
    /// [`HumsError::OutOfRange`] for extrema near the limits of `f64`.
    pub fn indicators(&self) -> Result<ClosedForm> {
        // Standardised moments do not depend on the scale: compute them at A_1 = 1.
        let unit = Self { first: 1.0, ..*self };
        let form = ClosedForm::from_raw_moments(&unit.raw_moments())?;
        crate::error::finite_or_out_of_range("variance", form.variance * self.first * self.first)?;
        Ok(ClosedForm {
            mean: form.mean * self.first,
            variance: form.variance * self.first * self.first,
            rms: form.rms * self.first.abs(),
            ..form
        })
    }
}

/// Simplified closed forms D 4.14: mean dropped, infinite series:
/// `RMS = A_1 / sqrt(2 n (1 - e^-delta))`, `FM4 = 3n/2 (1 - e^-delta)^2 / (1 - e^-2delta)`,
/// `M8A = 35 n^3 / 8 (1 - e^-delta)^4 / (1 - e^-4delta)`; likewise
/// `M6A = 5 n^2 / 2 (1 - e^-delta)^3 / (1 - e^-3delta)`. FM4 and M8A know nothing of the amplitude.
///
/// `n` need not be whole here: `n = Z w_d / (pi f_m)` for Z mesh cycles at f_m Hz.
///
/// # Errors
/// [`HumsError::Parameter`] unless decrement and `n` are positive and `A_1` is finite.
pub fn simplified_indicators(first_extremum: f64, delta: f64, n: f64) -> Result<ClosedForm> {
    require_positive("logarithmic decrement", delta)?;
    require_positive("half cycles", n)?;
    if !first_extremum.is_finite() {
        return Err(HumsError::Parameter { parameter: "first extremum", value: first_extremum, allowed: "finite" });
    }
    let q = |p: f64| -(-p * delta).exp_m1();
    let variance = first_extremum * first_extremum / (2.0 * n * q(1.0));
    Ok(ClosedForm {
        mean: 0.0,
        variance,
        rms: variance.sqrt(),
        fm4: 1.5 * n * q(1.0).powi(2) / q(2.0),
        m6a: 2.5 * n.powi(2) * q(1.0).powi(3) / q(3.0),
        m8a: 35.0 / 8.0 * n.powi(3) * q(1.0).powi(4) / q(4.0),
    })
}
