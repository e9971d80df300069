//! Figures of recordings: signal with its average, order spectrum, difference signal, trends; polar maps and detection in the modules.

mod detection;
mod polar;

use gearwright_case::RecordingCase;
use gearwright_results::recording::{Channel, Detail, Entry, Outcome, Row, value};

use super::{COLOURS, Chart, Line, Mark, MarkedChart, Pattern, PolarChart, thinned};

/// Mesh harmonics in the order spectrum.
const HARMONICS: usize = 4;
/// Channels that get their own figures.
const CHANNELS: usize = 16;
/// Lowest amplitude drawn at most (dB below the largest).
const FLOOR: f64 = -120.0;
/// Foot of an order spectrum at least that low (dB below the largest).
const FLAT: f64 = -60.0;
/// Indicators that get a trend figure.
const TRENDS: [(&str, &str); 9] = [
    ("rms", "raw"),
    ("kurtosis", "raw"),
    ("rms", "difference"),
    ("fm4", "difference"),
    ("m6a", "difference"),
    ("m8a", "difference"),
    ("energy_ratio", "difference"),
    ("sideband_level_factor", "tsa"),
    ("na4_running", "residual"),
];

/// A figure of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Figure {
    /// Lines over an axis.
    Chart(MarkedChart),
    /// Lines about the housing.
    Polar(PolarChart),
}

impl Figure {
    /// Writes `name.svg` and `name.png`.
    ///
    /// # Errors
    /// What the file system or the renderer says.
    pub fn save(&self, folder: &dyn Fn(&str) -> std::path::PathBuf, name: &str) -> Result<(), String> {
        match self {
            Self::Chart(chart) => chart.save(folder, name),
            Self::Polar(chart) => chart.save(folder, name),
        }
    }
}

/// All figures of a run with their names.
#[must_use]
pub fn all(case: &RecordingCase, outcome: &Outcome) -> Vec<(String, Figure)> {
    let mut figures: Vec<_> = charts(case, outcome).into_iter().map(|(name, c)| (name, Figure::Chart(c))).collect();
    figures.extend(polar::maps(case, outcome).into_iter().map(|(name, c)| (name, Figure::Polar(c))));
    figures.extend(detection::charts(case, outcome).into_iter().map(|(name, c)| (name, Figure::Chart(c))));
    figures
}

fn charts(case: &RecordingCase, outcome: &Outcome) -> Vec<(String, MarkedChart)> {
    let mut charts = Vec::new();
    let channels = outcome.shown().map(|measured| &measured.channels[..]).unwrap_or_default();
    for (index, channel) in channels.iter().take(CHANNELS).enumerate() {
        let Some(detail) = channel.average.as_ref().ok().and_then(|average| average.detail.as_ref()) else { continue };
        let name = |what: &str| if channels.len() > 1 { format!("{what}_{}", index + 1) } else { what.to_owned() };
        charts.push((name("signal"), signal(case, channel, detail)));
        charts.push((name("order_spectrum"), order_spectrum(case, channel, detail)));
        charts.push((name("difference"), difference(case, channel, detail)));
    }
    if outcome.is_trend {
        let names: Vec<&str> = channels.iter().take(COLOURS.len()).map(|channel| channel.name.as_str()).collect();
        let charted = TRENDS.iter().filter_map(|(indicator, signal)| {
            Some((format!("trend_{indicator}_{signal}"), trend_of(case, outcome, &names, indicator, signal)?))
        });
        charts.extend(charted);
        charts.extend(health_index(case, outcome).map(|chart| ("trend_health_index".to_owned(), chart)));
    }
    charts
}

/// The health index over the recordings, with its limit.
fn health_index(case: &RecordingCase, outcome: &Outcome) -> Option<MarkedChart> {
    let value = |entry: &Entry| Some(outcome.limits.health_index(entry.measured.as_ref().ok()?)?.value);
    let points = outcome.entries.iter().enumerate();
    let points: Vec<_> = points.filter_map(|(k, entry)| Some(((k + 1) as f64, value(entry)?))).collect();
    if points.is_empty() {
        return None;
    }
    let title = heading(case, "health index: largest deviation of all indicators, 1 at the limits");
    let mut chart = chart(title, "Recording", "Health index".into(), vec![line("", 0, points)]);
    chart.from_zero = true;
    let marks = vec![Mark { at: 1.0, upright: false, label: "limit".into(), colour: COLOURS[2], dotted: false }];
    Some(MarkedChart { chart, marks, bands: Vec::new(), x_range: None, y_up_to: Some(1.0) })
}

fn heading(case: &RecordingCase, rest: &str) -> String {
    if case.inputs.title.is_empty() { rest.to_owned() } else { format!("{}: {rest}", case.inputs.title) }
}

fn amplitude(case: &RecordingCase) -> String {
    if case.inputs.signal.unit.is_empty() { "Signal".into() } else { format!("Signal ({})", case.inputs.signal.unit) }
}

fn chart(title: String, x_label: &str, y_label: String, lines: Vec<Line>) -> Chart {
    Chart { title, x_label: x_label.into(), y_label, lines, from_zero: false, logarithmic: false }
}

fn line(name: &str, index: usize, points: Vec<(f64, f64)>) -> Line {
    Line { name: name.into(), points, pattern: Pattern::Solid, colour: COLOURS[index % COLOURS.len()] }
}

fn over_period(case: &RecordingCase, samples: &[f64]) -> Vec<(f64, f64)> {
    let step = case.period_turns / samples.len() as f64;
    let points: Vec<(f64, f64)> = samples.iter().enumerate().map(|(k, x)| (k as f64 * step, *x)).collect();
    thinned(&points)
}

fn signal(case: &RecordingCase, channel: &Channel, detail: &Detail) -> MarkedChart {
    let finite: Vec<(f64, f64)> = detail.first_period.iter().copied().filter(|p| p.1.is_finite()).collect();
    let lines = vec![
        Line { colour: "#9a9a9a", ..line("first period", 0, thinned(&finite)) },
        line("average", 1, over_period(case, &detail.signals[0])),
    ];
    let title = heading(case, &format!("{} and its synchronous average", channel.name));
    let chart = chart(title, "Turns of the shaft", amplitude(case), lines);
    MarkedChart { chart, marks: Vec::new(), bands: Vec::new(), x_range: Some((0.0, case.period_turns)), y_up_to: None }
}

fn difference(case: &RecordingCase, channel: &Channel, detail: &Detail) -> MarkedChart {
    let lines = vec![line("", 0, over_period(case, &detail.signals[2]))];
    let title = heading(case, &format!("difference signal of {}", channel.name));
    let chart = chart(title, "Turns of the shaft", amplitude(case), lines);
    MarkedChart { chart, marks: Vec::new(), bands: Vec::new(), x_range: Some((0.0, case.period_turns)), y_up_to: None }
}

/// Amplitudes in dB of the largest, mesh harmonics and the sidebands that the difference signal loses marked.
fn order_spectrum(case: &RecordingCase, channel: &Channel, detail: &Detail) -> MarkedChart {
    let mesh = case.rule.mesh_orders.first().copied().unwrap_or(1);
    let highest = detail.amplitudes.len().saturating_sub(1).min((HARMONICS * mesh + mesh / 2).max(16));
    let largest = detail.amplitudes.iter().skip(1).copied().fold(f64::MIN_POSITIVE, f64::max);
    let order = |k: usize| k as f64 / case.period_turns;
    // A stick for each order: lines are exact, there is nothing between them.
    let levels: Vec<(usize, f64)> = detail
        .amplitudes
        .iter()
        .enumerate()
        .take(highest + 1)
        .skip(1)
        .map(|(k, a)| (k, (20.0 * (a / largest).log10()).max(FLOOR)))
        .collect();
    let lowest = levels.iter().map(|(_, level)| *level).fold(0.0, f64::min);
    // Room below the lowest line, so that its stick is seen.
    let floor = ((lowest / 10.0).floor() * 10.0 - 10.0).clamp(FLOOR, FLAT);
    let sticks = levels.iter().flat_map(|&(k, level)| [(order(k), floor), (order(k), level), (order(k), floor)]);
    let y_label = match case.inputs.signal.unit.as_str() {
        "" => format!("Amplitude (dB re {largest:.4})"),
        unit => format!("Amplitude (dB re {largest:.4} {unit})"),
    };
    let title = heading(case, &format!("order spectrum of the average of {}", channel.name));
    let chart = chart(title, "Order (cycles per turn)", y_label, vec![line("", 0, sticks.collect())]);
    let mut marks = Vec::new();
    for h in (1..=case.rule.harmonics.min(HARMONICS)).take_while(|h| h * mesh <= highest) {
        let label = if h == 1 { "mesh".to_owned() } else { format!("{h}x") };
        marks.push(Mark { at: order(h * mesh), upright: true, label, colour: COLOURS[2], dotted: false });
        for j in 1..=case.rule.sideband_pairs {
            let offset = j * case.rule.sideband_spacing;
            for side in [(h * mesh).saturating_sub(offset), h * mesh + offset] {
                let (label, colour) = (String::new(), COLOURS[1]);
                marks.push(Mark { at: order(side), upright: true, label, colour, dotted: true });
            }
        }
    }
    MarkedChart { chart, marks, bands: Vec::new(), x_range: Some((0.0, order(highest))), y_up_to: None }
}

/// An indicator over the recordings, a line for each channel, its thresholds dashed.
fn trend_of(
    case: &RecordingCase,
    outcome: &Outcome,
    channels: &[&str],
    indicator: &'static str,
    signal: &'static str,
) -> Option<MarkedChart> {
    let quantity = Row { indicator, signal, value: Ok(0.0), nominal: None, standard_error: None };
    let row = |name: &str| {
        let channel = outcome.shown()?.channels.iter().find(|c| c.name == name)?;
        channel.rows.iter().find(|r| r.indicator == indicator && r.signal == signal)
    };
    let mut lines = Vec::new();
    let mut marks = Vec::new();
    for (index, name) in channels.iter().enumerate() {
        let points = outcome.entries.iter().enumerate();
        let points = points.filter_map(|(k, entry)| Some(((k + 1) as f64, value(entry, name, &quantity)?)));
        lines.push(line(name, index, points.collect()));
        let limit = row(name).and_then(|row| outcome.limits.of(name, row)).map(|bound| bound.limit);
        for at in limit.into_iter().flat_map(|limit| [limit.lower, limit.upper]).flatten() {
            let same = |mark: &Mark| mark.at.total_cmp(&at).is_eq();
            if !marks.iter().any(same) {
                let (label, colour) = (String::new(), COLOURS[index % COLOURS.len()]);
                marks.push(Mark { at, upright: false, label, colour, dotted: false });
            }
        }
    }
    if lines.iter().all(|line| line.points.is_empty()) {
        return None;
    }
    let title = heading(case, &format!("{indicator} of the {signal} signal"));
    let chart = chart(title, "Recording", indicator.replace('_', " "), lines);
    let y_up_to = marks.iter().map(|mark| mark.at).reduce(f64::max);
    Some(MarkedChart { chart, marks, bands: Vec::new(), x_range: None, y_up_to })
}
