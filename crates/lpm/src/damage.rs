//! Steady responses over whole rotations, and what damage adds to them.
//!
//! Damage enters through the curves: `k_l` and `delta_0` over one rotation of the damaged gear (as many mesh cycles as
//! it has teeth), equal to the healthy curves except where the damaged tooth is in mesh. The damage-induced response is the
//! exact difference of the two steady responses at the same mesh phase (dissertation D7.4),
//!
//! `x_d(tau) - x_h(tau)`,
//!
//! with nothing estimated or filtered. Beside it stands the static difference, `delta_0` of the damaged pair minus that of
//! the healthy one (with the give of eliminated supports), which the dynamic one approaches at vanishing speed.
//!
//! | quantity | field | unit |
//! |---|---|---|
//! | `x_h`, `x_d` | `healthy`, `damaged` | m |
//! | `x_d - x_h` | `difference` | m |
//! | its amplitudes, in lines of one per rotation | `spectrum` | m, Hz |
//!
//! Tests: `tests/damage.rs`.

use crate::error::{LpmError, check};
use crate::model::{Model, State};
use crate::periodic::{Steady, SteadyOptions};
use crate::response::{Response, Sampling};
use crate::spectrum::{Spectrum, damage_induced};
use gear_numerics::number::lcm;

/// A steady response over whole mesh cycles from phase 0.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct SteadyResponse {
    /// How the steady state was reached; `steady.multiple` is `None` where motion is not periodic.
    pub steady: Steady,
    /// The response.
    pub response: Response,
}

/// Healthy and damaged steady responses and their difference.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct DamageResponse {
    /// Without damage, over the mesh cycles of the damaged response.
    pub healthy: SteadyResponse,
    /// With damage.
    pub damaged: SteadyResponse,
    /// Damaged minus healthy transmission error (m) at the samples of both.
    pub difference: Vec<f64>,
    /// The same at vanishing speed (m).
    pub static_difference: Vec<f64>,
    /// Amplitudes of `difference`.
    pub spectrum: Spectrum,
}

impl DamageResponse {
    /// Peak-to-peak damage-induced response (m).
    pub fn peak_to_peak(&self) -> f64 {
        range(&self.difference)
    }

    /// Peak-to-peak static difference (m).
    pub fn static_peak_to_peak(&self) -> f64 {
        range(&self.static_difference)
    }
}

fn range(x: &[f64]) -> f64 {
    let (lo, hi) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    if lo <= hi { hi - lo } else { 0.0 }
}

impl Model {
    /// Waits for the steady state from `start` and samples `cycles` mesh cycles of it.
    ///
    /// # Errors
    /// As [`Model::simulate`]; options outside their ranges.
    pub fn steady_response(
        &self,
        mesh_frequency: f64,
        start: &State,
        cycles: usize,
        sampling: &Sampling,
        options: &SteadyOptions,
    ) -> Result<SteadyResponse, LpmError> {
        let steady = self.steady_state(mesh_frequency, start, options)?;
        let response = self.simulate(mesh_frequency, &steady.state, cycles, sampling, &options.integration)?;
        Ok(SteadyResponse { steady, response })
    }

    /// Damage-induced response: steady state of `self` (healthy) from `start`, steady state of `damaged` from there, and the difference
    /// over one period of the damaged motion.
    ///
    /// The damaged curves must have a period that the healthy period divides. Starting the damaged pair on the healthy orbit
    /// keeps both on the same branch where several exist.
    ///
    /// # Errors
    /// [`LpmError::Period`] where the periods do not fit; as [`Model::steady_response`].
    pub fn damage_response(
        &self,
        damaged: &Model,
        mesh_frequency: f64,
        start: &State,
        sampling: &Sampling,
        options: &SteadyOptions,
    ) -> Result<DamageResponse, LpmError> {
        let (h, d) = (self.excitation().period(), damaged.excitation().period());
        if !d.is_multiple_of(h) {
            return Err(LpmError::Period {
                first: h,
                second: d,
                reason: "the healthy period must divide that of the damaged curves",
            });
        }
        let first = self.steady_state(mesh_frequency, start, options)?;
        let second = damaged.steady_state(mesh_frequency, &first.state, options)?;
        // Subharmonic motion of either needs more than one period of the damaged curves.
        let cycles = lcm(d * second.multiple.unwrap_or(1), h * first.multiple.unwrap_or(1));
        check(cycles <= 10_000_000, "mesh cycles", cycles as f64, "-", "at most 1e7")?;
        let run = |m: &Model, steady: Steady| -> Result<SteadyResponse, LpmError> {
            let response = m.simulate(mesh_frequency, &steady.state, cycles, sampling, &options.integration)?;
            Ok(SteadyResponse { steady, response })
        };
        let (healthy, damaged_response) = (run(self, first)?, run(damaged, second)?);
        let difference =
            damage_induced(&damaged_response.response.transmission_error, &healthy.response.transmission_error)?;
        let static_difference = healthy
            .response
            .mesh_cycle
            .iter()
            .map(|&t| damaged.equilibrium(t).position[0] - self.equilibrium(t).position[0])
            .collect();
        let spectrum = Spectrum::of(&difference, cycles as f64 / mesh_frequency)?;
        Ok(DamageResponse { healthy, damaged: damaged_response, difference, static_difference, spectrum })
    }
}
