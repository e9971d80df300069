//! Speed sweeps: steady states at a list of speeds, each started from the state of the one before.
//!
//! As in dissertation D7.3: stepping the speed up follows one branch of the resonance curve to its end and jumps,
//! stepping it down follows the other. Where motion is not periodic the point says so and is measured over a fixed number of periods.
//!
//! Tests: `tests/periodic.rs` (both directions against continuation).

use crate::error::LpmError;
use crate::model::{Model, State};
use crate::periodic::SteadyOptions;
use crate::response::{Response, Sampling};

/// Options of [`Model::sweep`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepOptions<'a> {
    /// Wait for the steady state at each speed.
    pub steady: SteadyOptions<'a>,
    /// Sampling of the steady response.
    pub sampling: Sampling,
    /// Periods of the excitation over which motion that is not periodic is measured.
    pub aperiodic_periods: usize,
}

impl Default for SweepOptions<'_> {
    /// Default waits and sampling; 50 periods where motion is not periodic.
    fn default() -> Self {
        Self { steady: SteadyOptions::default(), sampling: Sampling::default(), aperiodic_periods: 50 }
    }
}

/// What is kept of a steady response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Peak-to-peak transmission error (m).
    pub peak_to_peak: f64,
    /// Root mean square about the mean (m).
    pub rms: f64,
    /// Mean (m).
    pub mean: f64,
    /// Largest transmission error (m).
    pub maximum: f64,
    /// Least transmission error (m).
    pub minimum: f64,
    /// Largest mesh force over mean mesh force (0 without load).
    pub dynamic_factor: f64,
    /// Fraction of the time without drive contact.
    pub separated_fraction: f64,
}

impl Response {
    /// The numbers of a resonance curve.
    pub fn measure(&self) -> Measure {
        let (maximum, minimum) = (self.maximum().value, self.minimum().value);
        Measure {
            peak_to_peak: maximum - minimum,
            rms: self.rms(),
            mean: self.mean(),
            maximum,
            minimum,
            dynamic_factor: self.dynamic_factor(),
            separated_fraction: self.separated_fraction(),
        }
    }
}

/// One speed of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepPoint {
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// State at phase 0.
    pub state: State,
    /// Periods of the excitation in one period of the motion; `None`: not periodic.
    pub multiple: Option<usize>,
    /// Periods integrated until steady.
    pub periods: usize,
    /// The steady response.
    pub measure: Measure,
}

impl Model {
    /// Steady states at `mesh_frequencies` (Hz) in the order given, the first from static equilibrium, each further one from the last.
    ///
    /// ```
    /// use lpm::{Curve, Excitation, GearPair, Input, Model, Supports, SweepOptions, frequencies};
    ///
    /// let pair = GearPair::table_3_2(Input::Prescribed);
    /// // two pairs of teeth in contact over 0.64 of the cycle; error of the mesh under the mean force
    /// let stiffness = Curve::rectangular(533e6, 806e6, 0.18, 0.64)?;
    /// let force = pair.mean_force();
    /// let error = Curve::rectangular(force / 533e6, force / 806e6, 0.18, 0.64)?;
    /// let model = Model::new(&pair, &Excitation::new(&stiffness, &error)?, Supports::Eliminated)?;
    /// let curve = model.sweep(&frequencies(500.0, 1000.0, 6), &SweepOptions::default())?;
    /// assert!(curve.iter().all(|point| point.measure.dynamic_factor > 1.0));
    /// # Ok::<(), lpm::LpmError>(())
    /// ```
    ///
    /// # Errors
    /// [`LpmError::Length`] for an empty list; as [`Model::steady_state`].
    pub fn sweep(&self, mesh_frequencies: &[f64], options: &SweepOptions) -> Result<Vec<SweepPoint>, LpmError> {
        self.sweep_from(&self.equilibrium(0.0), mesh_frequencies, options)
    }

    /// As [`Model::sweep`], the first from `start` (state at phase 0).
    ///
    /// # Errors
    /// As [`Model::sweep`].
    pub fn sweep_from(
        &self,
        start: &State,
        mesh_frequencies: &[f64],
        options: &SweepOptions,
    ) -> Result<Vec<SweepPoint>, LpmError> {
        if mesh_frequencies.is_empty() {
            return Err(LpmError::Length { what: "mesh frequencies of a sweep", found: 0, needed: "at least 1" });
        }
        let mut state = *start;
        mesh_frequencies
            .iter()
            .map(|&f| {
                let steady = self.steady_state(f, &state, &options.steady)?;
                let periods = steady.multiple.unwrap_or(options.aperiodic_periods.max(1));
                let cycles = periods * self.excitation().period();
                let response =
                    self.simulate(f, &steady.state, cycles, &options.sampling, &options.steady.integration)?;
                state = response.end;
                Ok(SweepPoint {
                    mesh_frequency: f,
                    state: steady.state,
                    multiple: steady.multiple,
                    periods: steady.periods,
                    measure: response.measure(),
                })
            })
            .collect()
    }
}

/// `count` equally spaced mesh frequencies from `from` to `to` (Hz), both included.
pub fn frequencies(from: f64, to: f64, count: usize) -> Vec<f64> {
    match count {
        0 => Vec::new(),
        1 => vec![from],
        _ => (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect(),
    }
}
