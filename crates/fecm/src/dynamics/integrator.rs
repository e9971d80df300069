//! Time integration of `M a + C v + K q = F`: Newmark's family and generalised alpha.
//!
//! Generalised alpha (J. Chung and G. M. Hulbert, *J. Appl. Mech.* 60, 1993, 371-375) weighs the equation of motion between the two ends of a
//! step,
//!
//! `M a_(1-alpha_m) + C v_(1-alpha_f) + K q_(1-alpha_f) = (1 - alpha_f) F_1 + alpha_f F_0`,
//!
//! with Newmark's (N. M. Newmark, *J. Eng. Mech. Div.* ASCE 85, 1959, 67-94) `q_1 = q_0 + h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1)`,
//! `v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1)`. Average acceleration is `alpha_m = alpha_f = 0`, `beta = 1/4`, `gamma = 1/2`: second order, no
//! damping of its own, and `1/2 v M v + 1/2 q K q` changes by exactly the work `1/2 (q_1 - q_0) . (F_0 + F_1)`.

use crate::error::FecmError;

/// Which member of the family.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Integrator {
    /// Newmark's average acceleration.
    #[default]
    AverageAcceleration,
    /// Generalised alpha with this spectral radius at infinite frequency, 0 (all damped in one step) to 1 (none).
    GeneralizedAlpha {
        /// Spectral radius at infinite frequency.
        spectral_radius: f64,
    },
}

/// Weights of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Its length `h` (s).
    pub step: f64,
    /// Newmark's `beta`.
    pub beta: f64,
    /// Newmark's `gamma`.
    pub gamma: f64,
    /// `alpha_m`.
    pub alpha_m: f64,
    /// `alpha_f`.
    pub alpha_f: f64,
}

impl Integrator {
    /// Checks the spectral radius.
    ///
    /// # Errors
    /// [`FecmError::Option`] outside 0 to 1.
    pub fn validate(&self) -> Result<(), FecmError> {
        match *self {
            Self::GeneralizedAlpha { spectral_radius: value } if !(0.0..=1.0).contains(&value) => {
                Err(FecmError::Option { name: "spectral radius", value, allowed: "0 to 1" })
            }
            _ => Ok(()),
        }
    }

    /// Weights of a step of this length (s).
    #[must_use]
    pub fn weights(&self, step: f64) -> Weights {
        match *self {
            Self::AverageAcceleration => Weights { step, beta: 0.25, gamma: 0.5, alpha_m: 0.0, alpha_f: 0.0 },
            Self::GeneralizedAlpha { spectral_radius: rho } => {
                let alpha_m = (2.0 * rho - 1.0) / (rho + 1.0);
                let alpha_f = rho / (rho + 1.0);
                let gamma = 0.5 - alpha_m + alpha_f;
                let beta = 0.25 * (1.0 - alpha_m + alpha_f).powi(2);
                Weights { step, beta, gamma, alpha_m, alpha_f }
            }
        }
    }
}

impl Weights {
    /// Weight of the mass in the step matrix (1/s^2); all weights are over `1 - alpha_f`.
    #[must_use]
    pub fn mass(&self) -> f64 {
        (1.0 - self.alpha_m) / (self.beta * self.step * self.step) / (1.0 - self.alpha_f)
    }

    /// Weight of the damping in the step matrix (1/s).
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.gamma / (self.beta * self.step)
    }

    /// What the mass multiplies on the right, from position, velocity and acceleration at the start.
    #[must_use]
    pub fn mass_history(&self, q: f64, v: f64, a: f64) -> f64 {
        let h = self.step;
        let newmark = (q + h * v) / (self.beta * h * h) + (0.5 / self.beta - 1.0) * a;
        ((1.0 - self.alpha_m) * newmark - self.alpha_m * a) / (1.0 - self.alpha_f)
    }

    /// What the damping multiplies on the right.
    #[must_use]
    pub fn damping_history(&self, q: f64, v: f64, a: f64) -> f64 {
        let h = self.step;
        let newmark = self.gamma / (self.beta * h) * q
            + (self.gamma / self.beta - 1.0) * v
            + h * (0.5 * self.gamma / self.beta - 1.0) * a;
        newmark - self.start() * v
    }

    /// `alpha_f / (1 - alpha_f)`: weight of the start against the end.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.alpha_f / (1.0 - self.alpha_f)
    }

    /// Acceleration and velocity at the end from positions at both ends.
    #[must_use]
    pub fn end(&self, q: [f64; 2], v: f64, a: f64) -> (f64, f64) {
        let h = self.step;
        let acceleration = (q[1] - q[0] - h * v) / (self.beta * h * h) - (0.5 / self.beta - 1.0) * a;
        let velocity = v + h * ((1.0 - self.gamma) * a + self.gamma * acceleration);
        (velocity, acceleration)
    }
}
