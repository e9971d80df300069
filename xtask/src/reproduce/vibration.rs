//! Vibration of a transmission's housing, as the figures need it: series of the sensors that are shown, FM4 of all others.

use anyhow::{Context as _, ensure};
use gear_geom::{CrackLength, Damage};
use gearwright_case::TransmissionCase;
use gearwright_case::transmission::damage::Severity;
use gearwright_study::transmission::{self as study, cache::Cache};
use hums::difference::{RemovalRule, exact_difference, split};
use hums::indicator::basic::kurtosis;
use hums::spectrum::{Spectrum, Window};
use hums::tsa::average_periods;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What an acceleration is averaged over before anything is computed from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Average {
    /// Nothing.
    Unaltered,
    /// The planet-pass period.
    PlanetPass,
    /// A turn of the carrier.
    CarrierTurn,
}

impl Average {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Unaltered, Self::PlanetPass, Self::CarrierTurn];

    /// Name in keys and legends.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unaltered => "unaltered",
            Self::PlanetPass => "planet-pass average",
            Self::CarrierTurn => "carrier average",
        }
    }
}

/// Where time stands in a record: whole steps, counted in mesh cycles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Samples of a mesh cycle of the planetary stage.
    pub per_mesh: usize,
    /// Mesh cycles of a carrier turn: teeth of the ring.
    pub ring_teeth: usize,
    /// Planets, at equal angles.
    pub planets: usize,
    /// Mesh frequency of the planetary stage (Hz).
    pub mesh_hz: f64,
    /// Mesh frequency of the bevel stage (Hz).
    pub bevel_hz: f64,
}

impl Clock {
    /// Samples of a carrier turn.
    pub fn per_turn(&self) -> usize {
        self.per_mesh * self.ring_teeth
    }

    /// Samples of a planet pass.
    pub fn per_pass(&self) -> usize {
        self.per_turn() / self.planets
    }

    /// Sampling rate (Hz).
    pub fn rate(&self) -> f64 {
        self.mesh_hz * self.per_mesh as f64
    }

    /// Frequency of planet passes (Hz).
    pub fn pass_hz(&self) -> f64 {
        self.mesh_hz * self.planets as f64 / self.ring_teeth as f64
    }

    /// Samples over carrier turns.
    pub fn over_turns(&self, samples: &[f64]) -> Vec<(f64, f64)> {
        samples.iter().enumerate().map(|(k, a)| (self.turn_of(k), *a)).collect()
    }

    /// Carrier turns at a sample.
    pub fn turn_of(&self, sample: usize) -> f64 {
        (sample + 1) as f64 / self.per_turn() as f64
    }

    /// Amplitudes over frequency (Hz), without the mean, up to a limit.
    pub fn spectrum(&self, samples: &[f64], up_to: f64) -> anyhow::Result<Vec<(f64, f64)>> {
        let spectrum = Spectrum::of(samples, Window::Rectangular)?;
        let lines = spectrum.frequencies(self.rate()).into_iter().zip(spectrum.amplitudes()).skip(1);
        Ok(lines.take_while(|line| line.0 <= up_to).collect())
    }

    /// A record or what is left of it by averaging.
    pub fn averaged(&self, record: &[f64], over: Average) -> anyhow::Result<Vec<f64>> {
        let period = match over {
            Average::Unaltered => return Ok(record.to_vec()),
            Average::PlanetPass => self.per_pass(),
            Average::CarrierTurn => self.per_turn(),
        };
        Ok(average_periods(record, period, None)?.samples)
    }

    /// Orders that the approximate difference signal loses: mesh harmonics and pairs of sidebands at the planet-pass frequency.
    pub fn removal(&self, over: Average, pairs: usize) -> anyhow::Result<RemovalRule> {
        let rule = match over {
            Average::Unaltered => anyhow::bail!("approximate difference signals are of averages"),
            Average::PlanetPass => RemovalRule::sidebands(self.ring_teeth / self.planets, pairs),
            Average::CarrierTurn => {
                RemovalRule { sideband_spacing: self.planets, ..RemovalRule::sidebands(self.ring_teeth, pairs) }
            }
        };
        Ok(rule)
    }

    /// The approximate difference signal of a record.
    pub fn approximate(&self, record: &[f64], over: Average, pairs: usize) -> anyhow::Result<Vec<f64>> {
        Ok(split(&self.averaged(record, over)?, &self.removal(over, pairs)?)?.difference)
    }

    /// The residual of a record: without mesh harmonics, with sidebands.
    pub fn residual(&self, record: &[f64], over: Average) -> anyhow::Result<Vec<f64>> {
        Ok(split(&self.averaged(record, over)?, &self.removal(over, 1)?)?.residual)
    }

    /// The exact difference signal of two records.
    pub fn exact(&self, damaged: &[f64], healthy: &[f64], over: Average) -> anyhow::Result<Vec<f64>> {
        Ok(exact_difference(&self.averaged(damaged, over)?, &self.averaged(healthy, over)?)?)
    }
}

/// FM4 of a sensor in a damaged state, by the signal it is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fm4 {
    /// Angle of the sensor (degrees).
    pub angle: f64,
    /// Exact difference, by [`Average::ALL`].
    pub exact: [f64; 3],
    /// Approximate difference of the planet-pass average, one pair of sidebands.
    pub approximate: f64,
}

/// One state of the transmission.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State {
    /// What distinguishes it.
    pub label: String,
    /// Crack length (%), 0 without damage.
    pub percent: f64,
    /// Acceleration (g) of the sensors shown.
    pub shown: Vec<Vec<f64>>,
    /// FM4 about the housing; empty without damage.
    pub around: Vec<Fm4>,
}

/// A transmission case, run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Vibration {
    /// Time.
    pub clock: Clock,
    /// Sensors shown: name and angle (degrees).
    pub sensors: Vec<(String, f64)>,
    /// States, the healthy one first.
    pub states: Vec<State>,
}

impl Vibration {
    /// Runs a case in all its states.
    pub fn compute(case: &TransmissionCase, cache: &Cache) -> anyhow::Result<Self> {
        let found = study::compute(case, cache, &())?;
        let clock = Clock {
            per_mesh: case.sampling.samples_per_cycle,
            ring_teeth: case.inputs.ring.teeth as usize,
            planets: case.train.planets(),
            mesh_hz: found.mesh_frequency,
            bevel_hz: case.bevel_mesh_frequency().unwrap_or(0.0),
        };
        let shown: Vec<usize> = found.shown(false).map(|(index, _)| index).collect();
        let around: Vec<usize> = (0..found.sensors.len()).filter(|index| !shown.contains(index)).collect();
        let healthy = found.states.first().context("no state was run")?;
        let lengths = std::iter::once(0.0).chain(case.severities.iter().map(crack_percent));
        let mut states = Vec::new();
        for (state, percent) in found.states.iter().zip(lengths) {
            let one = |index: &usize| {
                let angle = found.sensors[*index].angle_deg;
                Self::fm4(&clock, angle, &healthy.signals[*index], &state.signals[*index])
            };
            let damaged = state.number.is_some();
            let around = if damaged { around.par_iter().map(one).collect::<anyhow::Result<_>>()? } else { Vec::new() };
            let shown = shown.iter().map(|index| state.signals[*index].clone()).collect();
            states.push(State { label: state.name.clone(), percent, shown, around });
        }
        let sensors = found.shown(false).map(|(_, sensor)| (sensor.name.clone(), sensor.angle_deg)).collect();
        Self { clock, sensors, states }.checked()
    }

    /// FM4 of one sensor from the accelerations of a healthy and a damaged transmission.
    pub fn fm4(clock: &Clock, angle: f64, healthy: &[f64], damaged: &[f64]) -> anyhow::Result<Fm4> {
        let mut exact = [0.0; 3];
        for (value, over) in exact.iter_mut().zip(Average::ALL) {
            *value = kurtosis(&clock.exact(damaged, healthy, over)?)?;
        }
        let approximate = kurtosis(&clock.approximate(damaged, Average::PlanetPass, 1)?)?;
        Ok(Fm4 { angle, exact, approximate })
    }

    /// The healthy state.
    pub fn healthy(&self) -> anyhow::Result<&State> {
        self.states.first().filter(|s| s.percent == 0.0).context("the case has no healthy state")
    }

    /// The damaged states, each with the dissertation's name for it.
    pub fn damaged(&self) -> &[State] {
        self.states.get(1..).unwrap_or_default()
    }

    /// Index of a sensor that is shown.
    pub fn sensor(&self, name: &str) -> anyhow::Result<usize> {
        let found = self.sensors.iter().position(|s| s.0 == name);
        found.with_context(|| format!("the case has no sensor {name:?}"))
    }

    /// Checks that records hold whole carrier turns.
    pub fn checked(self) -> anyhow::Result<Self> {
        let turn = self.clock.per_turn();
        for record in self.states.iter().flat_map(|s| &s.shown) {
            ensure!(
                !record.is_empty() && record.len() % turn == 0,
                "a record of {} samples is no whole number of carrier turns",
                record.len()
            );
        }
        Ok(self)
    }
}

/// Length of the crack of a severity (%), NaN where there is none.
fn crack_percent(severity: &Severity) -> f64 {
    let cracks = severity.damage.iter().filter_map(|(_, damage)| match damage {
        Damage::Crack(crack) => match crack.length {
            CrackLength::Chord(fraction) | CrackLength::Path(fraction) => Some(100.0 * fraction),
            CrackLength::Length(_) => None,
        },
        _ => None,
    });
    cracks.fold(f64::NAN, f64::max)
}

impl State {
    /// `healthy`, or the crack's length.
    pub fn key(&self) -> String {
        if self.percent == 0.0 { "healthy".into() } else { format!("{:.0} %", self.percent) }
    }
}
