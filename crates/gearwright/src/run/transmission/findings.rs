//! What the runs of all states show.

use hums::HumsError;
use planetary::engine::{NaturalMode, TransmissionRun};
use rayon::prelude::*;

use super::signals::{Averaging, Judge, Judged, Period};

/// Standard gravity (m/s^2), the unit of accelerations in results.
pub const GRAVITY: f64 = 9.806_65;

/// A sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Name.
    pub name: String,
    /// Angle about the main axis (degrees).
    pub angle_deg: f64,
    /// Whether its signals are written in full.
    pub named: bool,
}

/// Everything found.
#[derive(Debug)]
pub struct Findings {
    /// Sensors.
    pub sensors: Vec<Sensor>,
    /// Periods of averages.
    pub periods: Vec<Period>,
    /// Samples in a turn of the carrier.
    pub samples_per_turn: usize,
    /// Planetary mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// The healthy state first.
    pub states: Vec<State>,
    /// Natural modes of the healthy transmission where the record begins.
    pub modes: Vec<NaturalMode>,
    /// Names of the parts in the kinetic energy of modes.
    pub parts: Vec<String>,
    /// Natural frequencies (Hz) and damping ratios of the housing alone.
    pub housing: Vec<(f64, f64)>,
}

/// One state.
#[derive(Debug)]
pub struct State {
    /// Name.
    pub name: String,
    /// Number among the damaged states, from 1; `None` for the healthy one.
    pub number: Option<usize>,
    /// The run.
    pub run: TransmissionRun,
    /// Accelerations (g), a signal for each sensor.
    pub signals: Vec<Vec<f64>>,
    /// What the signals say.
    pub judged: Vec<Judged>,
    /// How far the motion is from repeating, over its variation; `None` where the record is too short.
    pub change: Option<f64>,
}

impl State {
    /// Ending of its files.
    #[must_use]
    pub fn suffix(&self) -> String {
        self.number.map_or(String::new(), |number| format!("_damage_{number}"))
    }
}

/// Judges the signals of all runs; the first is healthy.
///
/// # Errors
/// Signals that are too short or not finite.
pub fn states(runs: Vec<(String, TransmissionRun)>, judge: &Judge, repeats: usize) -> Result<Vec<State>, HumsError> {
    let mut states: Vec<State> = Vec::with_capacity(runs.len());
    for (index, (name, mut run)) in runs.into_iter().enumerate() {
        let change = run.periodic_change(repeats);
        // the record in m/s^2 is not needed any more
        let signals: Vec<Vec<f64>> = run
            .sensors
            .iter_mut()
            .map(|sensor| std::mem::take(&mut sensor.acceleration).into_iter().map(|a| a / GRAVITY).collect())
            .collect();
        let healthy = states.first();
        let judged: Vec<Result<Judged, HumsError>> = signals
            .par_iter()
            .enumerate()
            .map(|(k, signal)| {
                let before = healthy.map(|healthy| (healthy.signals[k].as_slice(), &healthy.judged[k]));
                judge.judge(signal, before)
            })
            .collect();
        let judged = judged.into_iter().collect::<Result<_, _>>()?;
        states.push(State { name, number: index.checked_sub(1).map(|k| k + 1), run, signals, judged, change });
    }
    Ok(states)
}

impl Findings {
    /// Sensors whose signals are written in full; with `all` every one.
    pub fn shown(&self, all: bool) -> impl Iterator<Item = (usize, &Sensor)> {
        self.sensors.iter().enumerate().filter(move |(_, sensor)| all || sensor.named)
    }

    /// Turns of the carrier at a sample, from the start of the record.
    #[must_use]
    pub fn turn(&self, sample: usize) -> f64 {
        sample as f64 / self.samples_per_turn as f64
    }

    /// The shortest period averaged over.
    #[must_use]
    pub fn shortest(&self) -> Averaging {
        self.periods.first().map_or(Averaging::None, |period| period.averaging)
    }
}
