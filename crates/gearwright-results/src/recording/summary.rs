//! What a recording run says in short: `summary.json` and one screen.

use std::fmt::Write as _;

use serde_json::{Map, Value as Json, json};

use gearwright_case::RecordingCase;
use hums::quality::Finding;
use hums::threshold::{Limit, Rate};

use super::{Channel, Measured, Outcome, Verdict};

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
        "difference_signal": convention(case),
        "limits": {
            "indicators_judged_together": outcome.limits.tests(),
            "announced_false_alarm_rate": outcome.limits.false_alarm_rate,
            "held_out_false_alarms": outcome.limits.held_out.map(rate),
        },
        "health_index": outcome.shown().and_then(|measured| outcome.limits.health_index(measured)),
        "healthy_recordings": outcome.healthy,
        "recordings": recordings,
        "shown": outcome.entries.get(outcome.shown).map(|entry| &entry.name),
        "channels": channels,
        "alarms": outcome.alarms,
        "damaged_recordings": outcome.detection.as_ref().map(|detection| detection.damaged),
        "time_s": seconds,
    })
}

fn rate(rate: Rate) -> Json {
    json!({ "hits": rate.hits, "cases": rate.cases, "low": rate.low, "high": rate.high })
}

/// What the difference signal lacks, in words.
#[must_use]
pub fn convention(case: &RecordingCase) -> String {
    let rule = &case.rule;
    let harmonics = match case.inputs.difference.harmonics {
        Some(count) => format!("{count} mesh harmonics"),
        None => "mesh harmonics".to_owned(),
    };
    let pairs = match rule.sideband_pairs {
        1 => "1 sideband pair".to_owned(),
        pairs => format!("{pairs} sideband pairs"),
    };
    let shaft = match rule.shaft_orders {
        0 => String::new(),
        1 => ", shaft order 1".to_owned(),
        orders => format!(", shaft orders 1 to {orders}"),
    };
    format!("without {harmonics}, {pairs} about each{shaft}{}", if rule.remove_mean { ", mean" } else { "" })
}

fn findings(list: &[Finding]) -> Json {
    let one = |f: &Finding| json!({ "flaw": f.flaw.name(), "keeps_from_judging": f.blocks, "detail": f.detail });
    list.iter().map(one).collect()
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
        "quality": findings(&measured.findings),
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
        .map(|(indicator, signal, value, limit)| {
            json!({
                "indicator": indicator,
                "signal": signal,
                "value": value,
                "lower_limit": limit.lower,
                "upper_limit": limit.upper,
            })
        })
        .collect();
    let judged = outcome.limits.on_channel(channel);
    json!({
        "verdict": judged.verdict.name(),
        "not_judged_because": judged.verdict.reason(),
        "indicators_judged": judged.judged,
        "quality": findings(&channel.findings),
        "missing": channel.missing,
        "average": average,
        "indicators": signals,
        "outside_limits": alarms,
    })
}

/// Indicator, signal, value and limits of what is outside them.
fn alarmed<'a>(
    channel: &'a Channel,
    outcome: &'a Outcome,
) -> impl Iterator<Item = (&'static str, &'static str, f64, Limit)> + 'a {
    channel.rows.iter().filter_map(|row| {
        let verdict = outcome.limits.verdict(channel, row);
        let bound = outcome.limits.of(&channel.name, row)?;
        (verdict == Verdict::Alarm).then_some((row.indicator, row.signal, *row.value.as_ref().ok()?, bound.limit))
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
        let judged = outcome.limits.on_channel(channel);
        let _ = match &judged.verdict {
            Verdict::NotJudged(reason) => writeln!(text, "  not judged: {}", cut(reason)),
            verdict => writeln!(text, "  {} ({} of {} judged)", verdict.name(), judged.judged, channel.rows.len()),
        };
    }
    if shown.channels.len() > LINES {
        let _ = writeln!(text, "and {} more channels in indicators.csv", shown.channels.len() - LINES);
    }
    text.push_str(&quality_lines(shown));
    text.push_str(&judged_lines(case, outcome, shown));
    text.push_str(&alarm_lines(outcome, shown));
    text.push_str(&detection_lines(outcome));
    text
}

/// Flaws on the screen.
const FLAWS: usize = 3;
/// Characters of a reason on the screen.
const REASON: usize = 100;

fn cut(reason: &str) -> String {
    let cut: String = reason.chars().take(REASON).collect();
    if cut.len() < reason.len() { format!("{cut} ..") } else { cut }
}

/// Flaws of the recording and its channels, those that keep from judging first.
fn quality_lines(shown: &Measured) -> String {
    let whole = shown.findings.iter().map(|finding| ("recording", finding));
    let channels = shown.channels.iter().flat_map(|c| c.findings.iter().map(move |finding| (&c.name[..], finding)));
    let mut all: Vec<(&str, &Finding)> = whole.chain(channels).collect();
    all.sort_by_key(|(_, finding)| !finding.blocks);
    let mut text = String::new();
    for (name, finding) in all.iter().take(FLAWS) {
        let _ = writeln!(text, "quality    {name}: {}: {}", finding.flaw.name(), cut(&finding.detail));
    }
    if all.len() > FLAWS {
        let _ = writeln!(text, "           and {} more in quality.csv", all.len() - FLAWS);
    }
    text
}

/// Which difference signal, and the health index with its rate of false alarms.
fn judged_lines(case: &RecordingCase, outcome: &Outcome, shown: &Measured) -> String {
    let mut text = format!("difference {}\n", convention(case));
    text.push_str(&conventions_line(shown));
    let Some(index) = outcome.limits.health_index(shown) else { return text };
    let _ = write!(
        text,
        "health     index {} (1 is the limit), by {} {} ({})",
        short(index.value),
        index.channel,
        index.indicator,
        index.signal
    );
    if let Some(rate) = outcome.limits.false_alarm_rate {
        let _ = write!(text, "; false alarms {rate} a recording, {} indicators together", outcome.limits.tests());
    }
    if let Some(rate) = outcome.limits.held_out {
        let _ = write!(text, "; held out {} of {}", rate.hits, rate.cases);
    }
    text.push('\n');
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
        let share = |rate: Option<Rate>| rate.map_or("-".into(), |r| format!("{:.3}", r.value()));
        let (low, high) = detected.roc.area_interval();
        let _ = writeln!(
            text,
            "  {} {} ({}): area {:.3} ({low:.3} to {high:.3}); outside {} of damaged, {} of healthy (held out)",
            detected.channel,
            detected.indicator,
            detected.signal,
            detected.roc.area,
            share(detected.detection),
            share(detected.bound.and_then(|bound| bound.false_alarms))
        );
    }
    text
}

/// Indicators on the screen for their detection.
const BEST: usize = 4;

fn alarm_lines(outcome: &Outcome, shown: &Measured) -> String {
    let lines: Vec<String> = if outcome.is_trend {
        let log = outcome.alarms.iter().map(|alarm| {
            let until = alarm.cleared_at.map_or("still standing".to_owned(), |index| format!("until {index}"));
            format!(
                "{} {} ({}) from {} ({}), {until}: {} outside {}",
                alarm.channel,
                alarm.indicator,
                alarm.signal,
                alarm.raised_at,
                alarm.raised_by,
                short(alarm.extreme),
                range(alarm.lower_limit, alarm.upper_limit)
            )
        });
        log.collect()
    } else {
        let above = shown.channels.iter().flat_map(|channel| {
            alarmed(channel, outcome).map(|(indicator, signal, value, limit)| {
                let range = range(limit.lower, limit.upper);
                format!("{} {indicator} ({signal}): {} outside {range}", channel.name, short(value))
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
        format!("\n{}:\n{text}", if outcome.is_trend { "alarms" } else { "outside limits" })
    }
}

/// FM4 by the usual difference signals, where the choice matters.
fn conventions_line(shown: &Measured) -> String {
    let details = shown.channels.iter().filter(|c| c.blocked.is_none()).filter_map(|c| {
        let detail = c.average.as_ref().ok()?.detail.as_ref()?;
        let fm4 = detail.conventions.iter().filter_map(|one| one.values[0].as_ref().ok().copied());
        let (low, high) = fm4.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        (high > CHOICE_MATTERS * low).then(|| format!("{} {} to {}", c.name, short(low), short(high)))
    });
    let Some(first) = details.into_iter().next() else { return String::new() };
    format!("           fm4 depends on what is removed: {first} (difference_signals.csv)\n")
}

/// Ratio of FM4 by two difference signals that is reported.
const CHOICE_MATTERS: f64 = 2.0;

/// Limits in words.
fn range(lower: Option<f64>, upper: Option<f64>) -> String {
    match (lower, upper) {
        (Some(lower), Some(upper)) => format!("{} to {}", short(lower), short(upper)),
        (Some(lower), None) => format!("{} and more", short(lower)),
        (None, Some(upper)) => format!("up to {}", short(upper)),
        (None, None) => "any".to_owned(),
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
