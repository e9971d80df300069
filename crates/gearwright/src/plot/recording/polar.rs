//! Polar maps: an indicator over the angles of the sensors about the housing, as in D5.9 and D6.8 (there the natural logarithm of FM4).

use crate::case::RecordingCase;
use crate::plot::{COLOURS, Line, Pattern, PolarChart};
use crate::run::recording::Outcome;
use crate::run::recording::measure::{Measured, Row};

use super::heading;

/// Indicators that get a map, and whether it shows their logarithm.
const MAPS: [(&str, &str, bool); 5] = [
    ("rms", "raw", false),
    ("rms", "difference", false),
    ("fm4", "difference", true),
    ("m6a", "difference", true),
    ("m8a", "difference", true),
];

/// Maps of the recording shown; in a trend, of the first usable one as well.
pub fn maps(case: &RecordingCase, outcome: &Outcome) -> Vec<(String, PolarChart)> {
    if case.inputs.signal.angles_deg.len() < 2 {
        return Vec::new();
    }
    let drawn = MAPS.iter().filter_map(|(indicator, signal, logarithm)| {
        Some((format!("polar_{indicator}_{signal}"), map(case, outcome, indicator, signal, *logarithm)?))
    });
    drawn.collect()
}

fn map(
    case: &RecordingCase,
    outcome: &Outcome,
    indicator: &'static str,
    signal: &'static str,
    logarithm: bool,
) -> Option<PolarChart> {
    let quantity = Row { indicator, signal, value: Ok(0.0), nominal: None, standard_error: None };
    let scaled = |value: f64| if logarithm { (value > 0.0).then(|| value.ln()) } else { Some(value) };
    let shown = outcome.shown()?;
    let closed = |value: &dyn Fn(&str) -> Option<f64>| -> Vec<(f64, f64)> {
        let places = shown.channels.iter().zip(&case.inputs.signal.angles_deg);
        let mut points: Vec<(f64, f64)> = places
            .filter_map(|(channel, angle)| Some((angle.rem_euclid(360.0), scaled(value(&channel.name)?)?)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.extend(points.first().copied().map(|(angle, radius)| (angle + 360.0, radius)));
        points
    };
    let line = |name: String, points, colour| Line { name, points, pattern: Pattern::Solid, colour };
    let of = |measured: &Measured, colour| {
        line(measured.name.clone(), closed(&|channel| measured.value(channel, &quantity)), colour)
    };
    let mut lines = Vec::new();
    let first = outcome.entries.iter().find_map(|entry| entry.measured.as_ref().ok());
    if outcome.is_trend
        && let Some(first) = first.filter(|first| first.name != shown.name)
    {
        lines.push(of(first, COLOURS[1]));
    }
    lines.push(of(shown, COLOURS[2]));
    let limit = |channel: &str| {
        let rows = &shown.channels.iter().find(|c| c.name == channel)?.rows;
        let row = rows.iter().find(|row| row.indicator == indicator && row.signal == signal)?;
        Some(outcome.limits.of(channel, row)?.threshold)
    };
    lines.push(line("threshold".into(), rounded(closed(&limit)), COLOURS[4]));
    lines.retain(|line| line.points.len() > 2);
    let radii = || lines.iter().flat_map(|line| &line.points).map(|point| point.1);
    let (low, high) = (radii().fold(f64::INFINITY, f64::min), radii().fold(f64::NEG_INFINITY, f64::max));
    if lines.is_empty() {
        return None;
    }
    // Logarithms may be negative: the centre lies below them all.
    let centre = if low < 0.0 { low.floor() } else { 0.0 };
    let rim = round_up(high - centre) + centre;
    // Rings have labels of few decimals.
    let exponent = if (0.1..1e4).contains(&rim.abs()) { 0 } else { 3 * (rim.abs().log10() / 3.0).floor() as i32 };
    let scale = 10_f64.powi(-exponent);
    lines.iter_mut().flat_map(|line| &mut line.points).for_each(|point| point.1 *= scale);
    let name = if logarithm { format!("ln {indicator}") } else { indicator.to_owned() };
    let unit = match (case.inputs.signal.unit.as_str(), exponent) {
        ("", 0) => String::new(),
        _ if logarithm => String::new(),
        ("", power) => format!(" (1e{power})"),
        (unit, 0) => format!(" ({unit})"),
        (unit, power) => format!(" (1e{power} {unit})"),
    };
    Some(PolarChart {
        title: heading(case, &format!("{name} of the {signal} signal{unit} about the housing")),
        lines,
        radii: (centre * scale, rim * scale),
    })
}

/// Points between two of a line at most a degree apart, so that a limit common to all sensors is a circle.
fn rounded(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for pair in points.windows(2) {
        let steps = (pair[1].0 - pair[0].0).ceil().max(1.0);
        for k in 0..steps as usize {
            let u = k as f64 / steps;
            found.push((pair[0].0 + u * (pair[1].0 - pair[0].0), pair[0].1 + u * (pair[1].1 - pair[0].1)));
        }
    }
    found.extend(points.last());
    found
}

/// The next number with short labels on four rings up to it.
fn round_up(value: f64) -> f64 {
    if !(value > 0.0) {
        return 1.0;
    }
    let power = 10_f64.powi(value.log10().floor() as i32);
    [1.0, 1.2, 1.6, 2.0, 4.0, 6.0, 8.0].iter().map(|f| f * power).find(|rim| *rim >= value).unwrap_or(10.0 * power)
}
