//! `gearwright hums`: condition indicators of a recording, from a case file or from flags. Flags are written down as a case, which then takes
//! the way of every case: one schema, one set of checks.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use hums::io::is_recording;
use toml::{Table, Value};

use gearwright_case::{self as case, Case, CaseFaults};

use super::exit::refused;

/// Name that faults of flags are reported under.
const COMMAND_LINE: &str = "command line";

/// Flags of `gearwright hums`. All but `--out` and `--threads` stand for keys of a case of the kind "recording".
#[derive(Debug, Args)]
pub struct Flags {
    /// Case file of the kind "recording"; or give --signal, --teeth, and --tach or --speed-hz.
    #[arg(conflicts_with = "signal")]
    case: Option<PathBuf>,
    /// Recording (csv, tsv, txt, dat, asc, wav, npy, mat, parquet), or a folder of recordings for a trend.
    #[arg(long, value_name = "FILE|FOLDER")]
    signal: Option<PathBuf>,
    /// Channel to judge, by name or number from 1; may be repeated. Default: all.
    #[arg(long, value_name = "NAME|NUMBER", requires = "signal")]
    channel: Vec<String>,
    /// Sampling rate (Hz); default: what the file says.
    #[arg(long, requires = "signal")]
    rate_hz: Option<f64>,
    /// Teeth of the gear on the shaft of interest.
    #[arg(long, requires = "signal")]
    teeth: Option<u32>,
    /// Tachometer: a channel of the recording, or a file of pulse times (s).
    #[arg(long, value_name = "CHANNEL|FILE", requires = "signal", conflicts_with = "speed_hz")]
    tach: Option<String>,
    /// Constant speed of the shaft (Hz), instead of a tachometer.
    #[arg(long, requires = "signal")]
    speed_hz: Option<f64>,
    /// Tachometer pulses a turn; default 1.
    #[arg(long, requires = "signal")]
    pulses_per_turn: Option<f64>,
    /// Turns of the shaft of interest for each turn of the tachometer's, e.g. 27/81.
    #[arg(long, value_name = "A/B", requires = "signal")]
    gear_ratio: Option<String>,
    /// Turns in an averaging period; default 1.
    #[arg(long, requires = "signal")]
    turns: Option<u32>,
    /// Periods a turn: the number of planets, for planet passes of a carrier.
    #[arg(long, requires = "signal")]
    per_turn: Option<u32>,
    /// Sideband pairs about each mesh harmonic removed from the difference signal; default 1.
    #[arg(long, visible_alias = "sidebands", requires = "signal")]
    sideband_pairs: Option<u32>,
    /// Shaft orders, from 1 on, removed from residual and difference signal; default 2.
    #[arg(long, requires = "signal")]
    shaft_orders: Option<u32>,
    /// Flaws of a recording that do not keep it from being judged, e.g. clipped,drift.
    #[arg(long, value_name = "FLAW,..", requires = "signal")]
    accept: Option<String>,
    /// Folder of recordings of the healthy state, for thresholds.
    #[arg(long, value_name = "FOLDER", requires = "signal")]
    healthy: Option<String>,
    /// Number of recordings, from the first of the folder on, that are healthy.
    #[arg(long, requires = "signal")]
    healthy_first: Option<u32>,
    /// Folder of recordings of the damaged state: rates of detection, ROC.
    #[arg(long, value_name = "FOLDER", requires = "signal")]
    damaged: Option<String>,
    /// Number of recordings at the end of the folder that are the damaged state.
    #[arg(long, requires = "signal")]
    damaged_last: Option<u32>,
    /// Text file with columns recording, severity and, if wanted, condition (level of noise, ..): probability
    /// of detection over severity.
    #[arg(long, value_name = "FILE", requires = "signal")]
    severities: Option<String>,
    /// Angles of the sensors about the housing (degrees), one for each channel, e.g. 0,90,180: polar maps.
    #[arg(long, value_name = "A,B,..", value_delimiter = ',', allow_negative_numbers = true, requires = "signal")]
    angles_deg: Vec<f64>,
    /// Probability that a healthy recording raises any alarm; default 0.01.
    #[arg(long, requires = "signal")]
    false_alarm_rate: Option<f64>,
    /// Limits this number of standard deviations (or errors) from the mean, each indicator on its own.
    #[arg(long, requires = "signal", conflicts_with = "false_alarm_rate")]
    sigmas: Option<f64>,
    /// Limits that hold this share of the healthy set.
    #[arg(long, requires = "signal", conflicts_with_all = ["sigmas", "false_alarm_rate"])]
    quantile: Option<f64>,
    /// Unit of the channels, for headings.
    #[arg(long, requires = "signal")]
    unit: Option<String>,
    /// A line for headings.
    #[arg(long, requires = "signal")]
    title: Option<String>,
    /// No plots.
    #[arg(long, requires = "signal")]
    no_plots: bool,
    /// Results folder; default: out/<name of the case or recording>.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Threads, 1 to 1024; default: one per core. Results do not depend on it.
    #[arg(long, value_parser = super::threads)]
    pub threads: Option<usize>,
}

impl Flags {
    /// The case, and the file that names its results.
    ///
    /// # Errors
    /// All faults of the case file, or of the flags.
    pub fn load(&self) -> anyhow::Result<(Case, PathBuf)> {
        let Some(signal) = &self.signal else {
            let Some(file) = self.case.clone() else {
                return Err(refused(
                    "give a case file, or --signal FILE with --teeth, and --tach or --speed-hz; see gearwright hums --help",
                ));
            };
            return Ok((Case::Recording(Box::new(case::load_recording(&file)?)), file));
        };
        let text = toml::to_string(&self.written(signal)?).context("the flags cannot be written as a case")?;
        let loaded = case::from_text(&text, Path::new(COMMAND_LINE)).map_err(as_flags)?;
        Ok((loaded, signal.clone()))
    }

    /// The flags as a case file.
    fn written(&self, signal: &Path) -> anyhow::Result<Table> {
        let mut case = Table::new();
        case.insert("kind".into(), "recording".into());
        put(&mut case, "title", self.title.as_deref());
        let Some(file) = signal.to_str() else {
            return Err(refused(format!("{}: the name is not UTF-8; rename the file", signal.display())));
        };
        let mut section = Table::new();
        put(&mut section, "file", Some(file));
        put(&mut section, "channels", (!self.channel.is_empty()).then(|| self.channel.join(",")));
        put(&mut section, "rate_hz", self.rate_hz);
        put(&mut section, "angles_deg", (!self.angles_deg.is_empty()).then(|| self.angles_deg.clone()));
        put(&mut section, "unit", self.unit.as_deref());
        case.insert("signal".into(), section.into());

        let mut section = Table::new();
        if let Some(tach) = &self.tach {
            let is_file = Path::new(tach).exists() || is_recording(Path::new(tach));
            put(&mut section, if is_file { "file" } else { "channel" }, Some(tach.as_str()));
        }
        put(&mut section, "speed_hz", self.speed_hz);
        put(&mut section, "pulses_per_turn", self.pulses_per_turn);
        if let Some(ratio) = &self.gear_ratio {
            let (above, below) = ratio.split_once('/').unwrap_or((ratio, "1"));
            let number = |part: &str| part.trim().parse::<f64>().ok();
            let (Some(above), Some(below)) = (number(above), number(below)) else {
                return Err(refused(format!(
                    "{COMMAND_LINE}: --gear-ratio = {ratio}: must be a number, or two with a slash, e.g. 27/81"
                )));
            };
            put(&mut section, "gear_ratio", Some(above));
            put(&mut section, "gear_ratio_divisor", Some(below));
        }
        case.insert("tachometer".into(), section.into());

        let mut section = Table::new();
        put(&mut section, "teeth", self.teeth.map(i64::from));
        case.insert("gear".into(), section.into());

        let mut section = Table::new();
        put(&mut section, "turns", self.turns.map(i64::from));
        put(&mut section, "per_turn", self.per_turn.map(i64::from));
        case.insert("average".into(), section.into());

        let mut section = Table::new();
        put(&mut section, "sideband_pairs", self.sideband_pairs.map(i64::from));
        put(&mut section, "shaft_orders", self.shaft_orders.map(i64::from));
        case.insert("difference".into(), section.into());

        let mut section = Table::new();
        put(&mut section, "accept", self.accept.as_deref());
        case.insert("quality".into(), section.into());

        let mut section = Table::new();
        put(&mut section, "healthy", self.healthy.as_deref());
        put(&mut section, "healthy_first", self.healthy_first.map(i64::from));
        put(&mut section, "false_alarm_rate", self.false_alarm_rate);
        put(&mut section, "sigmas", self.sigmas);
        put(&mut section, "quantile", self.quantile);
        put(&mut section, "method", self.quantile.map(|_| "quantile"));
        case.insert("thresholds".into(), section.into());

        let mut section = Table::new();
        put(&mut section, "damaged", self.damaged.as_deref());
        put(&mut section, "damaged_last", self.damaged_last.map(i64::from));
        put(&mut section, "severities", self.severities.as_deref());
        case.insert("detection".into(), section.into());

        let mut section = Table::new();
        put(&mut section, "plots", self.no_plots.then_some(false));
        case.insert("output".into(), section.into());
        Ok(case)
    }
}

fn put(section: &mut Table, key: &str, value: Option<impl Into<Value>>) {
    if let Some(value) = value {
        section.insert(key.into(), value.into());
    }
}

/// Keys and the flags that set them.
const FLAGS: [(&str, &str); 27] = [
    ("signal.file", "--signal"),
    ("signal.channels", "--channel"),
    ("signal.rate_hz", "--rate-hz"),
    ("signal.angles_deg", "--angles-deg"),
    ("signal.unit", "--unit"),
    ("title", "--title"),
    ("gear.teeth", "--teeth"),
    ("tachometer", "--tach or --speed-hz"),
    ("tachometer.channel", "--tach"),
    ("tachometer.file", "--tach"),
    ("tachometer.speed_hz", "--speed-hz"),
    ("tachometer.pulses_per_turn", "--pulses-per-turn"),
    ("tachometer.gear_ratio", "--gear-ratio"),
    ("tachometer.gear_ratio_divisor", "--gear-ratio"),
    ("average.turns", "--turns"),
    ("average.per_turn", "--turns, --per-turn"),
    ("difference.sideband_pairs", "--sideband-pairs"),
    ("difference.shaft_orders", "--shaft-orders"),
    ("quality.accept", "--accept"),
    ("thresholds.false_alarm_rate", "--false-alarm-rate"),
    ("thresholds.healthy_first", "--healthy-first"),
    ("thresholds.sigmas", "--sigmas"),
    ("thresholds.quantile", "--quantile"),
    ("thresholds.method", "--healthy, --quantile"),
    ("detection", "--healthy or --healthy-first"),
    ("detection.damaged_last", "--damaged-last"),
    ("detection.severities", "--severities"),
];

/// Faults under the names of the flags, without lines: the user has seen no file.
fn as_flags(mut faults: CaseFaults) -> CaseFaults {
    for fault in &mut faults.faults {
        fault.line = None;
        if let Some((_, flag)) = FLAGS.iter().find(|(key, _)| *key == fault.key) {
            fault.key = (*flag).to_owned();
        }
    }
    faults
}
