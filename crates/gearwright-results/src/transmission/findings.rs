//! What the runs of all states show.

use planetary::engine::{Deviation, NaturalMode, TransmissionRun};

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
    /// Mean force of one mesh of the planetary stage (N).
    pub mean_force: f64,
    /// Mean stiffness of the healthy meshes of sun and planets, and of planets and ring, at that force (N/m).
    pub mean_stiffness: [Option<f64>; 2],
    /// What steps and transient leave in the records.
    pub resolution: Resolution,
    /// Wall times.
    pub times: super::summary::Times,
}

/// What steps and transient leave in the records of the healthy state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Resolution {
    /// The steps.
    pub steps: Option<Deviation>,
    /// The transient; none where no planet pass is run before the record.
    pub transient: Option<Deviation>,
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

/// Over what a signal is averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Averaging {
    /// Not at all.
    None,
    /// Over planet passes.
    PlanetPass,
    /// Over carrier turns.
    Carrier,
}

impl Averaging {
    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::PlanetPass => "planet_pass",
            Self::Carrier => "carrier",
        }
    }
}

/// A period to average over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Period {
    /// Which.
    pub averaging: Averaging,
    /// Samples in it.
    pub samples: usize,
    /// Planetary mesh cycles in it.
    pub mesh_order: usize,
    /// Planet passes in it.
    pub spacing: usize,
}

/// One indicator.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Averaging of its signal.
    pub averaging: Averaging,
    /// Signal it is computed from; a difference signal is followed by its number of sideband pairs.
    pub signal: String,
    /// Short name.
    pub indicator: &'static str,
    /// Value, or why there is none.
    pub value: Result<f64, String>,
    /// Value for Gaussian noise.
    pub nominal: Option<f64>,
}

/// An average and what is made of it.
#[derive(Debug, Clone)]
pub struct Averaged {
    /// The period.
    pub period: Period,
    /// Periods averaged.
    pub blocks: usize,
    /// The average.
    pub average: Vec<f64>,
    /// Average without mesh harmonics and so many sideband pairs as its number in the list.
    pub approximate: Vec<Vec<f64>>,
    /// Average less that of the healthy state.
    pub exact: Option<Vec<f64>>,
}

/// What a sensor says in one state.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Indicators.
    pub rows: Vec<Row>,
    /// Signal less that of the healthy state.
    pub exact: Option<Vec<f64>>,
    /// Averages, in the order of the periods.
    pub averages: Vec<Averaged>,
}

impl Judged {
    /// Value of an indicator.
    #[must_use]
    pub fn value(&self, averaging: Averaging, signal: &str, indicator: &str) -> Option<f64> {
        let wanted = |row: &&Row| row.averaging == averaging && row.signal == signal && row.indicator == indicator;
        self.rows.iter().find(wanted)?.value.as_ref().ok().copied()
    }
}
