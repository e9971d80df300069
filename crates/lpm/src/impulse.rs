//! Numerical impulse tests: natural frequency and damping ratio from the decay after a blow.
//!
//! As in dissertation D4.3: the gears stand still at a mesh phase under their nominal load, a short impulse along the line of
//! action sets them swinging, and the decaying transient is read. Frequency and decay come from successive maxima of the
//! displacement from equilibrium (logarithmic decrement), which is exact for one linear coordinate; with integrated
//! supports it reads the mesh mode once the support motion is small. The mesh average follows D4.3:
//! `f = (ICR - 1) f_2 + (2 - ICR) f_1`.
//!
//! Tests: `analytic_*` below, against `sqrt(k/m)` and `c / (2 sqrt(k m))`.

use crate::error::{LpmError, check};
use crate::integrate::Options;
use crate::model::Model;
use crate::response::{Response, Sampling};
use std::f64::consts::TAU;

/// Samples per undamped period; the cubic through two samples then finds a maximum to 1e-8 of its height.
const SAMPLES: usize = 200;

/// What an impulse test reads.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct ImpulseTest {
    /// Undamped natural frequency (Hz), from the damped one and the damping ratio.
    pub natural_frequency: f64,
    /// Frequency of the decaying oscillation (Hz).
    pub damped_frequency: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Maxima that were used.
    pub maxima: usize,
    /// The transient; its "mesh cycle" is one undamped natural period of the model.
    pub response: Response,
}

impl Model {
    /// Strikes the pair at mesh phase `tau` with `impulse` (N s, positive presses the teeth together) and reads `periods` natural periods.
    ///
    /// `None` where fewer than two maxima stand out (critical damping). Where the teeth separate, which
    /// `response.separations` tells, the reading depends on the amplitude.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for numbers outside their ranges; errors of the integration, as [`Model::simulate`].
    pub fn impulse_test(
        &self,
        tau: f64,
        impulse: f64,
        periods: usize,
        options: &Options,
    ) -> Result<Option<ImpulseTest>, LpmError> {
        check(impulse != 0.0, "impulse", impulse, "N s", "not zero")?;
        check((2..=100_000).contains(&periods), "natural periods", periods as f64, "-", "between 2 and 100000")?;
        let still = self.with_excitation(&self.excitation().frozen(tau)?)?;
        let frequency = still.natural_frequencies(0.0).first().copied().unwrap_or(1.0);
        let rest = still.equilibrium(0.0);
        let mut start = rest;
        start.velocity[0] += impulse / self.pair().effective_mass();
        let sampling = Sampling { per_cycle: SAMPLES, energy: false };
        let response = still.simulate(frequency, &start, periods, &sampling, options)?;
        let peaks = maxima(&response, rest.position[0]);
        let (Some(first), Some(last)) = (peaks.first(), peaks.last()) else {
            return Ok(None);
        };
        if peaks.len() < 2 {
            return Ok(None);
        }
        let n = (peaks.len() - 1) as f64;
        let damped_frequency = n / (last.0 - first.0);
        let decrement = (first.1 / last.1).ln() / n;
        let damping_ratio = decrement / TAU.hypot(decrement);
        let natural_frequency = damped_frequency / (1.0 - damping_ratio * damping_ratio).sqrt();
        Ok(Some(ImpulseTest { natural_frequency, damped_frequency, damping_ratio, maxima: peaks.len(), response }))
    }
}

/// Times (s) and heights (m) of the maxima above `level`, down to a ten-thousandth of the first.
fn maxima(r: &Response, level: f64) -> Vec<(f64, f64)> {
    let (x, v) = (&r.transmission_error, &r.velocity);
    let dt = 1.0 / (r.per_cycle() * r.mesh_frequency);
    let mut found: Vec<(f64, f64)> = Vec::new();
    for i in 0..x.len().saturating_sub(1) {
        let (d0, d1) = (v[i] * dt, v[i + 1] * dt);
        if !(d0 > 0.0 && d1 <= 0.0) {
            continue;
        }
        let rise = x[i + 1] - x[i];
        let (c2, c3) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
        let disc = (c2 * c2 - 3.0 * c3 * d0).max(0.0).sqrt();
        let u = if c2 < 0.0 { d0 / (disc - c2) } else { -(c2 + disc) / (3.0 * c3) };
        let height = x[i] + u * (d0 + u * (c2 + u * c3)) - level;
        let keep = height > 1e-4 * found.first().map_or(0.0, |p| p.1) && height > 0.0;
        if u.is_finite() && keep {
            found.push(((i as f64 + u) * dt, height));
        } else if !found.is_empty() {
            break;
        }
    }
    found
}

/// Mesh average of a quantity `one` at one pair and `two` at two pairs in contact, by contact ratio between 1 and 2 (D4.3).
///
/// # Errors
/// [`LpmError::OutOfRange`] for a contact ratio outside 1 to 2, or numbers that are not finite.
pub fn mesh_average(one: f64, two: f64, contact_ratio: f64) -> Result<f64, LpmError> {
    check((1.0..=2.0).contains(&contact_ratio), "contact ratio", contact_ratio, "-", "between 1 and 2")?;
    Ok((contact_ratio - 1.0) * two + (2.0 - contact_ratio) * one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Curve;
    use crate::excitation::Excitation;
    use crate::model::{GearPair, Input, Supports};

    #[test]
    fn analytic_frequency_and_damping_of_the_linear_pair() -> Result<(), LpmError> {
        let k = Curve::rectangular(533e6, 806e6, 0.2, 0.64)?;
        let e = Excitation::new(&k, &Curve::constant(15e-6)?)?;
        for ratio in [0.0, 0.01, 0.048, 0.2, 0.6] {
            let mut pair = GearPair::table_3_2(Input::Prescribed);
            pair.mesh_damping = pair.damping_for_ratio(ratio, 533e6);
            let m = Model::new(&pair, &e, Supports::Rigid)?;
            let t = m.impulse_test(0.05, 1e-3, 20, &Options::default())?;
            let t = t.ok_or(LpmError::Singular { place: "test" })?;
            let f = (533e6 / pair.effective_mass()).sqrt() / TAU;
            assert!((t.natural_frequency / f - 1.0).abs() < 1e-5, "{ratio}: {} {f}", t.natural_frequency);
            assert!((t.damping_ratio - ratio).abs() < 1e-5, "{ratio}: {}", t.damping_ratio);
        }
        Ok(())
    }

    #[test]
    fn extreme_critical_damping_has_no_maxima_to_read() -> Result<(), LpmError> {
        let e = Excitation::new(&Curve::constant(533e6)?, &Curve::constant(15e-6)?)?;
        let mut pair = GearPair::table_3_2(Input::Prescribed);
        pair.mesh_damping = pair.damping_for_ratio(1.0, 533e6);
        let m = Model::new(&pair, &e, Supports::Rigid)?;
        assert_eq!(m.impulse_test(0.0, 1e-3, 10, &Options::default())?, None);
        assert!(m.impulse_test(0.0, 0.0, 10, &Options::default()).is_err());
        Ok(())
    }

    #[test]
    fn peer_dissertation_d4_3_mesh_average() -> Result<(), LpmError> {
        // 2370.73 and 2916.63 Hz, contact ratio 1.64: printed 2720.11 Hz; damping 0.048, 0.039: 0.042.
        assert!((mesh_average(2370.73, 2916.63, 1.64)? - 2720.11).abs() < 0.01);
        assert!((mesh_average(0.048, 0.039, 1.64)? - 0.042).abs() < 5e-4);
        assert!(mesh_average(1.0, 2.0, 2.5).is_err());
        Ok(())
    }
}
