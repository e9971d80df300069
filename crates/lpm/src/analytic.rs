//! Closed forms of piecewise linear oscillators, shared by tests, examples and figures.
//!
//! - damped oscillator under a constant force, every damping ratio;
//! - flight and bounce of a mass on a one-sided spring (period against amplitude);
//! - Floquet multipliers of a stiffness that alternates between two values (Meissner 1918; Magnus & Winkler, *Hill's
//!   Equation*, 1966, section 8);
//! - boundaries of the principal parametric instability of a damped Mathieu oscillator to first order
//!   (Nayfeh & Mook, *Nonlinear Oscillations*, 1979, section 5.3).
//!
//! All in SI. Tests: below, and wherever the crate is compared with them.

/// A mass on a spring and damper under a constant force: `m x'' + c x' + k x = f`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// Mass (kg), positive.
    pub mass: f64,
    /// Damping (N s/m).
    pub damping: f64,
    /// Stiffness (N/m), zero or positive.
    pub stiffness: f64,
    /// Force (N).
    pub force: f64,
}

impl Oscillator {
    /// Displacement and velocity after time `t` (s) from `x` (m), `v` (m/s).
    pub fn after(&self, t: f64, x: f64, v: f64) -> (f64, f64) {
        let (g, k, a) = (0.5 * self.damping / self.mass, self.stiffness / self.mass, self.force / self.mass);
        if self.stiffness == 0.0 {
            if g == 0.0 {
                return (x + t * (v + 0.5 * a * t), v + a * t);
            }
            // Terminal velocity a / (2 g).
            let (end, decay) = (0.5 * a / g, (-2.0 * g * t).exp());
            return (x + end * t + (v - end) * (1.0 - decay) / (2.0 * g), end + (v - end) * decay);
        }
        let u = x - a / k;
        let disc = g * g - k;
        let decay = (-g * t).exp();
        let (c, s) = if disc < 0.0 {
            let w = (-disc).sqrt();
            ((w * t).cos(), (w * t).sin() / w)
        } else if disc == 0.0 {
            (1.0, t)
        } else {
            let w = disc.sqrt();
            ((w * t).cosh(), (w * t).sinh() / w)
        };
        (a / k + decay * (u * (c + g * s) + v * s), decay * (v * (c - g * s) - k * u * s))
    }

    /// Undamped natural frequency (Hz).
    pub fn natural_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt() / std::f64::consts::TAU
    }
}

/// Period (s) of the undamped bounce of a mass on a one-sided spring under a force that presses it on.
///
/// `amplitude` (m) is the largest excursion from the static deflection `force / stiffness`; where it is below the
/// static deflection, contact is kept and the period is that of the linear oscillator.
pub fn bounce_period(mass: f64, stiffness: f64, force: f64, amplitude: f64) -> f64 {
    let (w, d) = ((stiffness / mass).sqrt(), force / stiffness);
    if amplitude <= d {
        return std::f64::consts::TAU / w;
    }
    let contact = 2.0 * (-d / amplitude).acos() / w;
    let flight = 2.0 * (amplitude * amplitude - d * d).sqrt() / (w * d);
    contact + flight
}

/// Floquet multipliers of `m x'' + c x' + k(t) x = 0` where `k` is `k1` for `t1` seconds and `k2` for `t2`, as
/// ((re, im), (re, im)), larger modulus first.
pub fn two_stage_multipliers(mass: f64, damping: f64, (k1, t1): (f64, f64), (k2, t2): (f64, f64)) -> [(f64, f64); 2] {
    let stage = |k, t| {
        let o = Oscillator { mass, damping, stiffness: k, force: 0.0 };
        let ((a, c), (b, d)) = (o.after(t, 1.0, 0.0), o.after(t, 0.0, 1.0));
        [a, b, c, d]
    };
    let ([a, b, c, d], [e, f, g, h]) = (stage(k2, t2), stage(k1, t1));
    let half_trace = 0.5 * (a * e + b * g + c * f + d * h);
    let determinant = (-damping * (t1 + t2) / mass).exp();
    let disc = half_trace * half_trace - determinant;
    if disc < 0.0 {
        let im = (-disc).sqrt();
        [(half_trace, im), (half_trace, -im)]
    } else {
        let large = half_trace + disc.sqrt().copysign(half_trace);
        [(large, 0.0), (determinant / large, 0.0)]
    }
}

/// Excitation frequencies (Hz) between which the equilibrium of `x'' + 2 zeta w x' + w^2 (1 + eps cos 2 pi f t) x = 0` is unstable, to
/// first order in `eps`: `f = 2 f_n (1 -+ sqrt((eps/4)^2 - zeta^2))`; `None` where damping forbids it (`eps <= 4 zeta`).
pub fn principal_instability(natural_frequency: f64, eps: f64, zeta: f64) -> Option<(f64, f64)> {
    let half = (eps / 4.0).powi(2) - zeta * zeta;
    (half > 0.0).then(|| {
        let h = half.sqrt();
        (2.0 * natural_frequency * (1.0 - h), 2.0 * natural_frequency * (1.0 + h))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invariant_closed_forms_satisfy_the_equation_of_motion() {
        for (damping, stiffness) in [(0.0, 3.0), (0.4, 3.0), (2.0, 1.0), (5.0, 1.0), (0.0, 0.0), (0.7, 0.0)] {
            let o = Oscillator { mass: 1.0, damping, stiffness, force: 0.6 };
            for i in 0..20 {
                let (t, h) = (0.2 * f64::from(i), 1e-4);
                let ((xm, _), (x, v), (xp, _)) =
                    (o.after(t - h, 0.3, -0.2), o.after(t, 0.3, -0.2), o.after(t + h, 0.3, -0.2));
                let residual = (xp - 2.0 * x + xm) / (h * h) + damping * v + stiffness * x - 0.6;
                assert!(residual.abs() < 1e-6, "damping {damping}, stiffness {stiffness}, t {t}: {residual}");
                assert!(((xp - xm) / (2.0 * h) - v).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn analytic_multipliers_reduce_to_constant_stiffness() {
        let [(re, im), _] = two_stage_multipliers(2.0, 0.3, (5.0, 0.4), (5.0, 0.6));
        let (g, w) = (0.075f64, (2.5f64 - 0.075 * 0.075).sqrt());
        assert!((re - (-g).exp() * w.cos()).abs() < 1e-14);
        assert!((im - (-g).exp() * w.sin()).abs() < 1e-14);
    }
}
