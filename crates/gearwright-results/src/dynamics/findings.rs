//! What a run shows: the record with its times, spectra, contact loss, and the difference from the healthy pair.

use fecm::dynamics::{HUB_COORDINATES, ImpulseReading, MeshVibration, RotorOptions, Support};
use lpm::Spectrum;
use serde::{Deserialize, Serialize};

use gearwright_case::DynamicsCase;

/// A case, computed.
#[derive(Debug)]
pub struct Dynamics {
    /// Vibration of the healthy pair on its mesh; none without speeds.
    pub vibration: Option<MeshVibration>,
    /// Steps of a mesh cycle in words.
    pub steps: Option<String>,
    /// All speeds.
    pub speeds: Vec<Speed>,
    /// Impulse tests.
    pub blows: Vec<Blow>,
    /// Wall times.
    pub times: super::summary::Times,
}

impl Dynamics {
    /// Folder of a speed in the results: none where there is one speed.
    #[must_use]
    pub fn folder(&self, speed: usize) -> String {
        if self.speeds.len() == 1 { String::new() } else { format!("speed_{}/", speed + 1) }
    }
}

/// One step of a record, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Dynamic transmission error (m).
    pub transmission_error: f64,
    /// Force on the drive flanks (N).
    pub mesh_force: f64,
    /// Force on the coast flanks (N).
    pub back_force: f64,
    /// Force of each loaded tooth pair (N).
    pub pairs: Vec<(i32, f64)>,
    /// Coordinates of the hubs (m, rad).
    pub coordinates: Vec<f64>,
    /// Forces of the supports on the ground (N, N m).
    pub support_forces: Vec<f64>,
}

/// What a run took, and how well its equations are kept.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Work {
    /// Steps, transient included.
    pub steps: usize,
    /// Contact problems solved, cells that entered or left the contact, factorisations.
    pub contact_solves: usize,
    /// See above.
    pub pivots: usize,
    /// See above.
    pub factorisations: usize,
    /// Steps that needed wider contact grids than the first.
    pub widened_steps: usize,
    /// Steps at which coast flanks were watched.
    pub steps_with_coast_flanks: usize,
    /// Steps whose contact problem did not converge.
    pub not_converged: usize,
    /// Largest `|force . gap|` of a step, relative.
    pub worst_complementarity: f64,
    /// Largest violation of `force >= 0`, `gap >= 0` of a step, relative.
    pub worst_kkt_violation: f64,
    /// Work of the torques (J).
    pub external_j: f64,
    /// Work of the contact forces (J).
    pub contact_j: f64,
    /// Lost to damping (J).
    pub dissipated_j: f64,
    /// Gained by the bodies (J).
    pub stored_j: f64,
    /// Largest defect of the energy balance (J).
    pub worst_defect_j: f64,
    /// Largest energy seen, against which the defect counts (J).
    pub energy_scale_j: f64,
    /// Wall time (s).
    pub time_s: f64,
}

/// Steps of a mesh cycle at a speed, and what they come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Steps of a mesh cycle.
    pub steps: usize,
    /// Whether the case gives them.
    pub given: bool,
    /// Steps of a natural period.
    pub natural_steps: f64,
    /// Error at resonance over the motion there; infinite without damping.
    pub error: f64,
    /// Steps that would be chosen.
    pub enough: usize,
}

/// All states at one speed.
#[derive(Debug)]
pub struct Speed {
    /// Mean speed of the pinion (rad/s).
    pub speed: f64,
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// Steps of a mesh cycle.
    pub resolution: Resolution,
    /// The healthy pair first.
    pub responses: Vec<Response>,
}

/// One state at one speed.
#[derive(Debug)]
pub struct Response {
    /// State.
    pub state: String,
    /// Number among the damaged states, from 1; `None` for the healthy one.
    pub number: Option<usize>,
    /// Length of a step (s).
    pub time_step: f64,
    /// Mesh cycles of the samples.
    pub mesh_cycle: Vec<f64>,
    /// The record.
    pub samples: Vec<Sample>,
    /// Moving coordinates of the hubs: gear (0 pinion, 1 driven gear) and index in `HUB_COORDINATES`.
    pub coordinates: Vec<(usize, usize)>,
    /// Natural frequencies of the elastic modes kept of pinion and gear, hub held (Hz).
    pub modes: [Vec<f64>; 2],
    /// Spectrum of the transmission error (m).
    pub spectrum: Spectrum,
    /// Damaged minus healthy.
    pub difference: Option<Difference>,
    /// Period of the excitation (mesh cycles).
    pub period: usize,
    /// Mesh cycles run before the record.
    pub transient: f64,
    /// Estimate of what is left of the transient, over the variation of the motion; `None` where it was not looked at.
    pub transient_left: Option<f64>,
    /// How much of a transient a mesh cycle leaves; `None` where it was not seen.
    pub shrink: Option<f64>,
    /// Whether the motion repeats; `None` where it was not looked at.
    pub steady: Option<bool>,
    /// Work done.
    pub work: Work,
}

/// Steps of a decay from one that is told to the next.
pub const BLOW_STEPS: usize = 8;

/// An impulse test.
#[derive(Debug)]
pub struct Blow {
    /// State.
    pub state: String,
    /// Mesh cycle at which the gears stand.
    pub mesh_cycle: f64,
    /// What it reads; `None` where nothing oscillates.
    pub reading: Option<ImpulseReading>,
}

/// Exact difference signal.
#[derive(Debug)]
pub struct Difference {
    /// Damaged minus healthy transmission error at the same steps (m).
    pub signal: Vec<f64>,
    /// Its spectrum (m).
    pub spectrum: Spectrum,
    /// Root mean square (m).
    pub rms: f64,
    /// Kurtosis; `None` where nothing differs.
    pub fm4: Option<f64>,
    /// Eighth standardised moment; `None` where nothing differs.
    pub m8a: Option<f64>,
}

/// Coordinates of the hubs that move: gear (0 pinion, 1 driven gear) and index in `HUB_COORDINATES`.
#[must_use]
pub fn moving_coordinates(case: &DynamicsCase) -> Vec<(usize, usize)> {
    let of = |(gear, rotor): (usize, &RotorOptions)| -> Vec<(usize, usize)> {
        let held = rotor.supports.iter().enumerate();
        held.filter(|(_, support)| **support != Support::Fixed).map(|(axis, _)| (gear, axis)).collect()
    };
    case.options.rotors.iter().enumerate().flat_map(of).collect()
}

/// Names of coordinates, e.g. `gear_rotation`.
#[must_use]
pub fn coordinate_names(coordinates: &[(usize, usize)]) -> Vec<String> {
    let name = |&(gear, axis): &(usize, usize)| {
        let body = if gear == 0 { "pinion" } else { "gear" };
        format!("{body}_{}", HUB_COORDINATES[axis].replace(" about ", "_"))
    };
    coordinates.iter().map(name).collect()
}

impl Response {
    /// What distinguishes its files.
    #[must_use]
    pub fn suffix(&self) -> String {
        self.number.map_or(String::new(), |number| format!("_damage_{number}"))
    }

    /// Mean transmission error (m).
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.samples.iter().map(|sample| sample.transmission_error).sum::<f64>() / self.samples.len() as f64
    }

    /// Root mean square of the transmission error about its mean (m).
    #[must_use]
    pub fn rms(&self) -> f64 {
        let mean = self.mean();
        let squares: f64 = self.samples.iter().map(|sample| (sample.transmission_error - mean).powi(2)).sum();
        (squares / self.samples.len() as f64).sqrt()
    }

    /// Largest minus smallest transmission error (m).
    #[must_use]
    pub fn peak_to_peak(&self) -> f64 {
        self.largest(|sample| sample.transmission_error).0 + self.largest(|sample| -sample.transmission_error).0
    }

    /// Largest value of a quantity and the mesh cycle it is met at.
    #[must_use]
    pub fn largest(&self, value: impl Fn(&Sample) -> f64) -> (f64, f64) {
        let values = self.samples.iter().map(value).zip(self.mesh_cycle.iter().copied());
        values.fold((f64::NEG_INFINITY, 0.0), |most, next| if next.0 > most.0 { next } else { most })
    }

    /// Part of the record without force on drive flanks.
    #[must_use]
    pub fn without_contact(&self) -> f64 {
        let lost = self.samples.iter().filter(|sample| sample.mesh_force <= 0.0).count();
        lost as f64 / self.samples.len() as f64
    }

    /// Stretches of mesh cycle without force on drive flanks, from the first to the last such step, and whether coast flanks touch in it.
    #[must_use]
    pub fn contact_loss(&self) -> Vec<([f64; 2], bool)> {
        let mut stretches: Vec<([f64; 2], bool)> = Vec::new();
        let mut open = false;
        for (sample, &cycle) in self.samples.iter().zip(&self.mesh_cycle) {
            let lost = sample.mesh_force <= 0.0;
            let back = sample.back_force > 0.0;
            match stretches.last_mut() {
                Some(last) if lost && open => *last = ([last.0[0], cycle], last.1 || back),
                _ if lost => stretches.push(([cycle; 2], back)),
                _ => {}
            }
            open = lost;
        }
        stretches
    }
}
