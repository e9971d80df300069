//! What a recording says: indicators of its channels, their averages.

use hums::indicator::Indicator;
use hums::moments::Moments;
use hums::quality::Finding;

/// What a recording says.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Name of the file.
    pub name: String,
    /// Sampling rate (Hz).
    pub rate: f64,
    /// Samples of each channel.
    pub samples: usize,
    /// Slowest and fastest speed of the shaft of interest (Hz).
    pub speed: (f64, f64),
    /// Tachometer pulses.
    pub pulses: Option<Pulses>,
    /// What is odd about the recording as a whole.
    pub findings: Vec<Finding>,
    /// Channels judged.
    pub channels: Vec<Channel>,
}

impl Measured {
    /// Value of an indicator of a channel.
    #[must_use]
    pub fn value(&self, channel: &str, quantity: &Row) -> Option<f64> {
        let channel = self.channels.iter().find(|c| c.name == channel)?;
        let row = channel.rows.iter().find(|r| r.indicator == quantity.indicator && r.signal == quantity.signal)?;
        row.value.as_ref().ok().copied()
    }
}

/// What a channel says.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Its name.
    pub name: String,
    /// Samples missing in it (NaN).
    pub missing: usize,
    /// What is odd about it.
    pub findings: Vec<Finding>,
    /// Why it must not be judged.
    pub blocked: Option<String>,
    /// Indicators.
    pub rows: Vec<Row>,
    /// Its synchronous average, or why there is none.
    pub average: Result<Averaged, String>,
}

/// One indicator.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Short name.
    pub indicator: &'static str,
    /// Signal it is computed from.
    pub signal: &'static str,
    /// Value, or why there is none.
    pub value: Result<f64, String>,
    /// Value for Gaussian noise.
    pub nominal: Option<f64>,
    /// Standard error of that value, where a Gaussian limit makes sense.
    pub standard_error: Option<f64>,
}

/// What a synchronous average says.
#[derive(Debug, Clone)]
pub struct Averaged {
    /// Periods averaged.
    pub periods: usize,
    /// Periods left out because of gaps.
    pub skipped: usize,
    /// RMS of what averaging removed.
    pub removed_rms: f64,
    /// RMS of the noise left.
    pub noise_floor: f64,
    /// Moments of the residual signal and of the mesh envelope, for indicators with a memory.
    pub memory: [Option<Moments>; 2],
    /// Signals; dropped in trends.
    pub detail: Option<Detail>,
}

/// Signals of one channel.
#[derive(Debug, Clone)]
pub struct Detail {
    /// First period as recorded: turns of the shaft from its start, and samples.
    pub first_period: Vec<(f64, f64)>,
    /// Synchronous average with its residual and difference signals.
    pub signals: [Vec<f64>; 3],
    /// Amplitudes of the average at orders 0, 1, .. (cycles per period).
    pub amplitudes: Vec<f64>,
    /// What other difference signals of the same average say.
    pub conventions: Vec<Convention>,
}

/// FM4, M6A and M8A of a difference signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Convention {
    /// Sideband pairs removed.
    pub sideband_pairs: usize,
    /// Shaft orders removed.
    pub shaft_orders: usize,
    /// Whether these are the case's.
    pub chosen: bool,
    /// The indicators, or why there are none.
    pub values: [Result<f64, String>; 3],
}

/// Indicators of a [`Convention`].
pub const OF_CONVENTION: [Indicator; 3] = [Indicator::Fm4, Indicator::M6a, Indicator::M8a];

/// Pulses of a tachometer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Pulses {
    /// Pulses found.
    pub found: usize,
    /// Pulses missing among them, and bridged.
    pub missing: u64,
    /// Pulses left out as extra.
    pub extra: u64,
}
