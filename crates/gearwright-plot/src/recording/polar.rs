//! Polar maps: an indicator over the angles of the sensors about the housing, as in D5.9 and D6.8 (there the natural logarithm of FM4).

use crate::{COLOURS, Line, Pattern, PolarChart, polar};
use gearwright_case::RecordingCase;
use gearwright_results::recording::{Measured, Outcome, Row};

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
        polar::closed(places.filter_map(|(channel, angle)| Some((*angle, scaled(value(&channel.name)?)?))))
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
        outcome.limits.of(channel, row)?.limit.upper
    };
    lines.push(line("threshold".into(), polar::rounded(closed(&limit)), COLOURS[4]));
    let quantity = polar::Quantity {
        name: if logarithm { format!("ln {indicator}") } else { indicator.to_owned() },
        of: format!("of the {signal} signal"),
        unit: if logarithm { "" } else { case.inputs.signal.unit.as_str() },
        rescaled: !logarithm,
    };
    polar::about_housing(&case.inputs.title, &quantity, lines)
}
