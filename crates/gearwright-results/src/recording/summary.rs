//! What a recording run says in short: `summary.json` and one screen.

use std::fmt::Write as _;

use serde_json::{Map, Value as Json, json};

use super::{Channel, Measured, Outcome, Verdict};
use gearwright_case::RecordingCase;

/// `summary.json`: inputs with all defaults, recordings, indicators of the last one, alarms.
#[must_use]
pub fn summary(case: &RecordingCase, outcome: &Outcome, seconds: f64) -> Json {
    let recordings: Vec<Json> = outcome
        .entries
        .iter()
        .map(|entry| match &entry.measured {
            Ok(measured) => recording(measured),
            Err(reason) => json!({ "file": entry.name, "unusable": reason }),
        })
        .collect();
    let channels: Map<String, Json> = outcome
        .shown()
        .map(|measured| measured.channels.iter().map(|c| (c.name.clone(), channel(c, outcome))).collect())
        .unwrap_or_default();
    json!({
        "program": "gearwright",
        "version": env!("CARGO_PKG_VERSION"),
        "inputs": case.inputs,
        "warnings": case.notes.warnings,
        "assumptions": case.notes.assumptions,
        "period_turns": case.period_turns,
        "mesh_order": case.rule.mesh_orders.first(),
        "healthy_recordings": outcome.healthy,
        "recordings": recordings,
        "shown": outcome.entries.get(outcome.shown).map(|entry| &entry.name),
        "channels": channels,
        "alarms": outcome.alarms,
        "damaged_recordings": outcome.detection.as_ref().map(|detection| detection.damaged),
        "time_s": seconds,
    })
}

fn recording(measured: &Measured) -> Json {
    json!({
        "file": measured.name,
        "samples": measured.samples,
        "rate_hz": measured.rate,
        "duration_s": measured.samples as f64 / measured.rate,
        "slowest_hz": measured.speed.0,
        "fastest_hz": measured.speed.1,
        "pulses": measured.pulses,
    })
}

fn channel(channel: &Channel, outcome: &Outcome) -> Json {
    let mut signals: Map<String, Json> = Map::new();
    for row in &channel.rows {
        let signal = signals.entry(row.signal).or_insert_with(|| json!({}));
        signal[row.indicator] = match &row.value {
            Ok(value) => json!(value),
            Err(_) => Json::Null,
        };
    }
    let average = match &channel.average {
        Ok(average) => json!({
            "periods": average.periods,
            "skipped": average.skipped,
            "removed_rms": average.removed_rms,
            "noise_floor": average.noise_floor,
        }),
        Err(reason) => json!({ "none": reason }),
    };
    let alarms: Vec<Json> = alarmed(channel, outcome)
        .map(|(indicator, signal, value, threshold)| {
            json!({ "indicator": indicator, "signal": signal, "value": value, "threshold": threshold })
        })
        .collect();
    json!({ "missing": channel.missing, "average": average, "indicators": signals, "above_threshold": alarms })
}

/// Indicator, signal, value and threshold of what is above it.
fn alarmed<'a>(
    channel: &'a Channel,
    outcome: &'a Outcome,
) -> impl Iterator<Item = (&'static str, &'static str, f64, f64)> + 'a {
    channel.rows.iter().filter_map(|row| {
        let verdict = outcome.limits.verdict(&channel.name, row)?;
        let limit = outcome.limits.of(&channel.name, row)?;
        (verdict == Verdict::Alarm).then_some((row.indicator, row.signal, *row.value.as_ref().ok()?, limit.threshold))
    })
}

/// Columns of the screen: heading, indicator, signal.
const COLUMNS: [(&str, &str, &str); 8] = [
    ("rms raw", "rms", "raw"),
    ("rms tsa", "rms", "tsa"),
    ("fm0", "fm0", "tsa"),
    ("rms diff", "rms", "difference"),
    ("fm4", "fm4", "difference"),
    ("m6a", "m6a", "difference"),
    ("m8a", "m8a", "difference"),
    ("na4", "na4", "residual"),
];
/// Lines of channels, and of alarms, on the screen.
const LINES: usize = 7;

/// The one-screen summary.
#[must_use]
pub fn screen(case: &RecordingCase, outcome: &Outcome) -> String {
    let mut text = String::new();
    let Some(shown) = outcome.shown() else { return text };
    // Writing to a text cannot fail.
    if !case.inputs.title.is_empty() {
        let _ = writeln!(text, "{}", case.inputs.title);
    }
    if outcome.is_trend {
        let unusable = outcome.entries.iter().filter(|entry| entry.measured.is_err()).count();
        let _ = write!(text, "trend      {} recordings", outcome.entries.len());
        let _ =
            writeln!(text, "{}", if unusable > 0 { format!(", {unusable} of them unusable") } else { String::new() });
    }
    let _ = writeln!(
        text,
        "{} {}: {} samples at {} Hz, {:.3} s",
        if outcome.is_trend { "last      " } else { "recording " },
        shown.name,
        shown.samples,
        plain(shown.rate),
        shown.samples as f64 / shown.rate
    );
    let _ = write!(text, "shaft      {}", speed(shown.speed));
    let _ = match shown.pulses {
        Some(p) => writeln!(text, "; {} pulses, {} missing, {} extra", p.found, p.missing, p.extra),
        None => writeln!(text),
    };
    if let Some(average) = shown.channels.iter().find_map(|c| c.average.as_ref().ok()) {
        let _ = writeln!(
            text,
            "average    {} periods of {}, {} left out for gaps; {} mesh cycles a period",
            average.periods,
            turns(case),
            average.skipped,
            case.rule.mesh_orders.first().copied().unwrap_or_default()
        );
    }
    let width = shown.channels.iter().take(LINES).map(|c| c.name.chars().count()).max().unwrap_or(0).clamp(10, 24);
    let _ = write!(text, "\n{:<width$}", "channel");
    for (heading, ..) in COLUMNS {
        let _ = write!(text, " {heading:>10}");
    }
    let _ = writeln!(text, "  verdict");
    for channel in shown.channels.iter().take(LINES) {
        let name: String = channel.name.chars().take(width).collect();
        let _ = write!(text, "{name:<width$}");
        for (_, indicator, signal) in COLUMNS {
            let row = channel.rows.iter().find(|row| row.indicator == indicator && row.signal == signal);
            let value = row.and_then(|row| row.value.as_ref().ok());
            let _ = write!(text, " {:>10}", value.map_or("-".into(), |v| short(*v)));
        }
        let count = alarmed(channel, outcome).count();
        let gaps = if channel.missing > 0 { format!(", {} samples missing", channel.missing) } else { String::new() };
        let _ = writeln!(text, "  {}{gaps}", if count > 0 { format!("{count} above") } else { "ok".into() });
    }
    if shown.channels.len() > LINES {
        let _ = writeln!(text, "and {} more channels in indicators.csv", shown.channels.len() - LINES);
    }
    text.push_str(&alarm_lines(outcome, shown));
    text.push_str(&detection_lines(outcome));
    text
}

/// The indicators that tell damaged from healthy best.
fn detection_lines(outcome: &Outcome) -> String {
    let Some(detection) = &outcome.detection else { return String::new() };
    let mut best: Vec<_> = detection.detected.iter().collect();
    best.sort_by(|a, b| b.roc.area.total_cmp(&a.roc.area));
    let mut text = format!(
        "\n{} damaged against {} healthy recordings, best by area under the ROC (detection.csv):\n",
        detection.damaged, outcome.healthy
    );
    for detected in best.iter().take(BEST) {
        let share = |rate: Option<hums::threshold::Rate>| rate.map_or("-".into(), |r| format!("{:.3}", r.value()));
        let _ = writeln!(
            text,
            "  {} {} ({}): area {:.3}; above the threshold {} of damaged, {} of healthy",
            detected.channel,
            detected.indicator,
            detected.signal,
            detected.roc.area,
            share(detected.detection),
            share(detected.limit.and_then(|limit| limit.false_alarms))
        );
    }
    text
}

/// Indicators told on the screen for their detection.
const BEST: usize = 4;

fn alarm_lines(outcome: &Outcome, shown: &Measured) -> String {
    let lines: Vec<String> = if outcome.is_trend {
        let log = outcome.alarms.iter().map(|alarm| {
            let until = alarm.cleared_at.map_or("still standing".to_owned(), |index| format!("until {index}"));
            format!(
                "{} {} ({}) from {} ({}), {until}: largest {} over {}",
                alarm.channel,
                alarm.indicator,
                alarm.signal,
                alarm.raised_at,
                alarm.raised_by,
                short(alarm.largest),
                short(alarm.threshold)
            )
        });
        log.collect()
    } else {
        let above = shown.channels.iter().flat_map(|channel| {
            alarmed(channel, outcome).map(|(indicator, signal, value, threshold)| {
                format!("{} {indicator} ({signal}): {} over {}", channel.name, short(value), short(threshold))
            })
        });
        above.collect()
    };
    let mut text: String = lines.iter().take(LINES).map(|line| format!("  {line}\n")).collect();
    if lines.len() > LINES {
        let table = if outcome.is_trend { "alarms.csv" } else { "indicators.csv" };
        text.push_str(&format!("  and {} more in {table}\n", lines.len() - LINES));
    }
    if text.is_empty() {
        text
    } else {
        format!("\n{}:\n{text}", if outcome.is_trend { "alarms" } else { "above threshold" })
    }
}

/// Slowest and fastest speed, or the one speed.
fn speed((slowest, fastest): (f64, f64)) -> String {
    if fastest - slowest <= 1e-6 * fastest {
        format!("{} Hz", plain(fastest))
    } else {
        format!("{slowest:.4} to {fastest:.4} Hz between pulses")
    }
}

/// Length of the averaging period in words.
fn turns(case: &RecordingCase) -> String {
    match (case.inputs.average.turns, case.inputs.average.per_turn) {
        (1, 1) => "1 turn".into(),
        (turns, 1) => format!("{turns} turns"),
        (turns, parts) => format!("{turns}/{parts} turn"),
    }
}

/// Seven significant digits, no zeros behind them.
fn plain(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// Four significant digits.
fn short(value: f64) -> String {
    let size = value.abs();
    if size > 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{value:.3e}");
    }
    let decimals = if size >= 1.0 { 3 - (size.log10().floor() as usize).min(3) } else { 5 };
    format!("{value:.decimals$}")
}
