//! Tables of recordings: indicators, averages, trend, alarms. Values are in the unit of the recording.

use std::path::Path;

use hums::difference::RemovalRule;
use hums::quality::Finding;

use super::{Alarm, Channel, Entry, Limits, Measured, OF_CONVENTION, Row};

pub(super) fn number(value: f64) -> String {
    format!("{value:.12e}")
}

pub(super) fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), number)
}

/// Value, reason, Gaussian value, limits, verdict and why there is none.
fn judged(channel: &Channel, row: &Row, limits: &Limits) -> [String; 7] {
    let limit = limits.of(&channel.name, row).map(|bound| bound.limit);
    let (value, reason) = match &row.value {
        Ok(value) => (number(*value), String::new()),
        Err(reason) => (String::new(), reason.clone()),
    };
    let verdict = limits.verdict(channel, row);
    [
        value,
        reason,
        optional(row.nominal),
        optional(limit.and_then(|limit| limit.lower)),
        optional(limit.and_then(|limit| limit.upper)),
        verdict.name().to_owned(),
        verdict.reason().to_owned(),
    ]
}

const JUDGED: [&str; 7] =
    ["value", "reason", "gaussian_value", "lower_limit", "upper_limit", "verdict", "not_judged_because"];

/// `indicators.csv`: one row per channel, indicator and signal.
///
/// # Errors
/// I/O errors.
pub fn indicators(path: &Path, recording: &Measured, limits: &Limits) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let rates = ["false_alarm_rate", "false_alarm_rate_low", "false_alarm_rate_high"];
    table.write_record(["channel", "indicator", "signal"].iter().chain(&JUDGED).chain(&rates))?;
    for (channel, row) in rows(recording) {
        let rate = limits.of(&channel.name, row).and_then(|bound| bound.false_alarms);
        let mut record = vec![channel.name.clone(), row.indicator.to_owned(), row.signal.to_owned()];
        record.extend(judged(channel, row, limits));
        record.extend([rate.map(|r| r.value()), rate.map(|r| r.low), rate.map(|r| r.high)].map(optional));
        table.write_record(record)?;
    }
    table.flush()?;
    Ok(())
}

/// `quality.csv`: one row per recording, channel and flaw; an empty channel is the recording as a whole.
///
/// # Errors
/// I/O errors.
pub fn quality(path: &Path, entries: &[Entry]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(["recording", "file", "channel", "flaw", "keeps_from_judging", "detail"])?;
    for (index, entry) in entries.iter().enumerate() {
        let begin = [(index + 1).to_string(), entry.name.clone()];
        let mut write = |channel: &str, finding: &Finding| {
            let flaw = [channel, finding.flaw.name(), if finding.blocks { "yes" } else { "no" }, &finding.detail];
            table.write_record(begin.iter().map(String::as_str).chain(flaw))
        };
        let Ok(measured) = &entry.measured else { continue };
        for finding in &measured.findings {
            write("", finding)?;
        }
        for channel in &measured.channels {
            for finding in &channel.findings {
                write(&channel.name, finding)?;
            }
        }
    }
    table.flush()?;
    Ok(())
}

/// `health_index.csv`: the largest deviation of each recording's indicators, 1 at the limits.
///
/// # Errors
/// I/O errors.
pub fn health_index(path: &Path, entries: &[Entry], limits: &Limits) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(["recording", "file", "health_index", "verdict", "channel", "indicator", "signal"])?;
    for (index, entry) in entries.iter().enumerate() {
        let found = entry.measured.as_ref().ok().and_then(|measured| limits.health_index(measured));
        let begin = [(index + 1).to_string(), entry.name.clone()];
        let rest = match found {
            Some(found) => [
                number(found.value),
                if found.value > 1.0 { "alarm" } else { "ok" }.to_owned(),
                found.channel,
                found.indicator.to_owned(),
                found.signal.to_owned(),
            ],
            None => ["", "not judged", "", "", ""].map(String::from),
        };
        table.write_record(begin.iter().chain(&rest))?;
    }
    table.flush()?;
    Ok(())
}

fn rows(recording: &Measured) -> impl Iterator<Item = (&Channel, &Row)> {
    recording.channels.iter().flat_map(|channel| channel.rows.iter().map(move |row| (channel, row)))
}

/// `averages.csv`: synchronous average, residual and difference signal of every channel over one period (turns of the shaft).
///
/// # Errors
/// I/O errors.
pub fn averages(path: &Path, recording: &Measured, period_turns: f64) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let kept = || {
        let details = recording.channels.iter().map(|c| (c, c.average.as_ref().ok().and_then(|a| a.detail.as_ref())));
        details.filter_map(|(channel, detail)| Some((&channel.name, &detail?.signals)))
    };
    let mut header = vec!["turn".to_owned()];
    header.extend(kept().flat_map(|(name, _)| ["tsa", "residual", "difference"].map(|kind| format!("{name} {kind}"))));
    table.write_record(&header)?;
    let columns: Vec<&[f64]> = kept().flat_map(|(_, signals)| signals.iter().map(Vec::as_slice)).collect();
    let samples = columns.first().map_or(0, |column| column.len());
    for k in 0..samples {
        let turn = k as f64 / samples as f64 * period_turns;
        table.write_record(std::iter::once(turn).chain(columns.iter().map(|column| column[k])).map(number))?;
    }
    table.flush()?;
    Ok(())
}

/// Name of an order (cycles per period) of an average: mesh harmonic, sideband, shaft order; empty for any other.
#[must_use]
pub fn line_name(rule: &RemovalRule, order: usize) -> String {
    let mesh = rule.mesh_orders.first().copied().unwrap_or(1).max(1);
    let spacing = rule.sideband_spacing.max(1);
    let harmonic = ((order + mesh / 2) / mesh).max(1);
    let centre = harmonic * mesh;
    let (away, side) = if order < centre { (centre - order, "-") } else { (order - centre, "+") };
    let pairs = rule.sideband_pairs.max(1) * spacing;
    match (away, order) {
        (0, _) => format!("mesh {harmonic}"),
        (away, _) if away <= pairs && away % spacing == 0 => format!("mesh {harmonic} {side} {}", away / spacing),
        (_, order) if order > 0 && order <= rule.shaft_orders.max(2) * spacing && order % spacing == 0 => {
            format!("shaft {}", order / spacing)
        }
        _ => String::new(),
    }
}

/// `order_spectrum.csv`: amplitude of every order of every channel's average, and the name of the line.
///
/// # Errors
/// I/O errors.
pub fn order_spectrum(path: &Path, recording: &Measured, rule: &RemovalRule, period: f64) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(["channel", "order", "amplitude", "line"])?;
    for channel in &recording.channels {
        let Some(detail) = channel.average.as_ref().ok().and_then(|a| a.detail.as_ref()) else { continue };
        for (k, amplitude) in detail.amplitudes.iter().enumerate() {
            let (order, name) = (number(k as f64 / period), line_name(rule, k));
            table.write_record([&channel.name, &order, &number(*amplitude), &name])?;
        }
    }
    table.flush()?;
    Ok(())
}

/// `difference_signals.csv`: what the usual difference signals of the same average say.
///
/// # Errors
/// I/O errors.
pub fn difference_signals(path: &Path, recording: &Measured) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let names = OF_CONVENTION.map(|indicator| indicator.name());
    table.write_record(["channel", "sideband_pairs", "shaft_orders", "chosen"].iter().chain(&names))?;
    for channel in &recording.channels {
        let Some(detail) = channel.average.as_ref().ok().and_then(|a| a.detail.as_ref()) else { continue };
        for convention in &detail.conventions {
            let chosen = if convention.chosen { "yes" } else { "no" };
            let counts = [convention.sideband_pairs, convention.shaft_orders].map(|count| count.to_string());
            let mut record = vec![channel.name.clone()];
            record.extend(counts);
            record.push(chosen.to_owned());
            record.extend(convention.values.iter().map(|value| optional(value.as_ref().ok().copied())));
            table.write_record(record)?;
        }
    }
    table.flush()?;
    Ok(())
}

/// `trend.csv`: one row per recording, channel, indicator and signal; a recording that cannot be used has one row with the reason.
///
/// # Errors
/// I/O errors.
pub fn trend(path: &Path, entries: &[Entry], limits: &Limits) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(["recording", "file", "channel", "indicator", "signal"].iter().chain(&JUDGED))?;
    for (index, entry) in entries.iter().enumerate() {
        let begin = [(index + 1).to_string(), entry.name.clone()];
        match &entry.measured {
            Ok(measured) => {
                for (channel, row) in rows(measured) {
                    let mut record = begin.to_vec();
                    record.extend([channel.name.clone(), row.indicator.to_owned(), row.signal.to_owned()]);
                    record.extend(judged(channel, row, limits));
                    table.write_record(record)?;
                }
            }
            Err(reason) => {
                let mut record = begin.to_vec();
                record.extend(["", "", "", "", reason, "", "", "", "not judged", reason].map(String::from));
                table.write_record(record)?;
            }
        }
    }
    table.flush()?;
    Ok(())
}

/// `alarms.csv`: the alarm log.
///
/// # Errors
/// I/O errors.
pub fn alarms(path: &Path, alarms: &[Alarm]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record([
        "channel",
        "indicator",
        "signal",
        "lower_limit",
        "upper_limit",
        "raised_at",
        "raised_by",
        "cleared_at",
        "extreme",
        "share_outside",
    ])?;
    for alarm in alarms {
        table.write_record([
            alarm.channel.clone(),
            alarm.indicator.to_owned(),
            alarm.signal.to_owned(),
            optional(alarm.lower_limit),
            optional(alarm.upper_limit),
            alarm.raised_at.to_string(),
            alarm.raised_by.clone(),
            alarm.cleared_at.map_or(String::new(), |index| index.to_string()),
            number(alarm.extreme),
            number(alarm.share_outside),
        ])?;
    }
    table.flush()?;
    Ok(())
}
