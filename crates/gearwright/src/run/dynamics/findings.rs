//! What a run shows: the record with its times, spectra, contact loss, and the difference from the healthy pair.

use fecm::dynamics::{HUB_COORDINATES, ImpulseReading, RotorOptions, Support};
use hums::moments::Moments;
use lpm::Spectrum;

use super::resolution::Resolution;
use super::simulate::{Plan, Progress, Sample, SavedState, Work};
use gearwright_case::DynamicsCase;

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
    /// State of the engine at the end.
    pub end: Option<SavedState>,
    /// State of the engine at the first frame of a film.
    pub film_start: Option<SavedState>,
    /// Lengths of the run.
    pub plan: Plan,
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

impl Speed {
    /// Responses at a speed.
    #[must_use]
    pub fn new(case: &DynamicsCase, speed: f64, resolution: Resolution, responses: Vec<Response>) -> Self {
        let teeth = f64::from(case.statics.pair.pinion().teeth());
        Self { speed, mesh_frequency: speed * teeth / (2.0 * std::f64::consts::PI), resolution, responses }
    }
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
    /// From a complete run.
    ///
    /// # Errors
    /// Records too short for a spectrum.
    pub fn new(
        case: &DynamicsCase,
        plan: &Plan,
        progress: Progress,
        (state, number): (&str, Option<usize>),
        modes: [Vec<f64>; 2],
        healthy: Option<&Self>,
    ) -> anyhow::Result<Self> {
        let teeth = f64::from(case.statics.pair.pinion().teeth());
        let steps = plan.cycle as f64;
        let time_step = 2.0 * std::f64::consts::PI / (teeth * plan.speed * steps);
        let before = progress.before_record.unwrap_or_default();
        let left = progress.transient_left(plan);
        let mut samples = progress.samples;
        // a record after some periods is told as the first one: its teeth stand where those of the first did
        let periods_before = match plan.transient {
            Some(_) => 0,
            None => (before / plan.cycle as i64) as i32,
        };
        for (pair, _) in samples.iter_mut().flat_map(|sample| &mut sample.pairs) {
            *pair -= periods_before;
        }
        let signal: Vec<f64> = samples.iter().map(|sample| sample.transmission_error).collect();
        let duration = time_step * samples.len() as f64;
        let spectrum = Spectrum::of(&signal, duration)?;
        let difference = healthy.map(|healthy| Difference::new(&signal, healthy, duration)).transpose()?;
        let tolerance = case.inputs.run.steady_tolerance;
        let period = plan.period / plan.cycle;
        Ok(Self {
            state: state.into(),
            number,
            time_step,
            mesh_cycle: (0..samples.len()).map(|k| case.inputs.run.mesh_cycle_from + k as f64 / steps).collect(),
            samples,
            coordinates: moving_coordinates(case),
            modes,
            spectrum,
            difference,
            period,
            transient: before as f64 / steps,
            transient_left: left,
            shrink: progress.shrink.map(|shrink| shrink.min(1.0).powf(1.0 / period as f64)),
            steady: plan.transient.is_none().then(|| left.is_some_and(|left| left < tolerance)),
            end: progress.state,
            film_start: progress.film_start,
            plan: *plan,
            work: progress.work,
        })
    }

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

impl Difference {
    fn new(signal: &[f64], healthy: &Response, duration: f64) -> anyhow::Result<Self> {
        let reference: Vec<f64> = healthy.samples.iter().map(|sample| sample.transmission_error).collect();
        let signal = hums::difference::exact_difference(signal, &reference)?;
        let moments = Moments::of(&signal)?;
        Ok(Self {
            spectrum: Spectrum::of(&signal, duration)?,
            rms: moments.rms(),
            fm4: moments.standardized(4).ok(),
            m8a: moments.standardized(8).ok(),
            signal,
        })
    }
}
