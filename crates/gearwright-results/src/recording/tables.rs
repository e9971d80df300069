//! Tables of recordings: indicators, averages, trend, alarms. Values are in the unit of the recording.

use std::path::Path;

use super::{Alarm, Channel, Entry, Limits, Measured, Row, Verdict};

pub(super) fn number(value: f64) -> String {
    format!("{value:.12e}")
}

pub(super) fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), number)
}

/// Value, reason, Gaussian value, threshold or why there is none, verdict.
fn judged(channel: &Channel, row: &Row, limits: &Limits) -> [String; 6] {
    let limit = limits.of(&channel.name, row);
    let (value, reason) = match &row.value {
        Ok(value) => (number(*value), String::new()),
        Err(reason) => (String::new(), reason.clone()),
    };
    [
        value,
        reason,
        optional(row.nominal),
        optional(limit.map(|limit| limit.threshold)),
        if limit.is_none() { limits.why_none(row).to_owned() } else { String::new() },
        limits.verdict(&channel.name, row).map_or("", Verdict::name).to_owned(),
    ]
}

const JUDGED: [&str; 6] = ["value", "reason", "gaussian_value", "threshold", "no_threshold", "verdict"];

/// `indicators.csv`: one row per channel, indicator and signal.
///
/// # Errors
/// I/O errors.
pub fn indicators(path: &Path, recording: &Measured, limits: &Limits) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let rates = ["false_alarm_rate", "false_alarm_rate_low", "false_alarm_rate_high"];
    table.write_record(["channel", "indicator", "signal"].iter().chain(&JUDGED).chain(&rates))?;
    for (channel, row) in rows(recording) {
        let rate = limits.of(&channel.name, row).and_then(|limit| limit.false_alarms);
        let mut record = vec![channel.name.clone(), row.indicator.to_owned(), row.signal.to_owned()];
        record.extend(judged(channel, row, limits));
        record.extend([rate.map(|r| r.value()), rate.map(|r| r.low), rate.map(|r| r.high)].map(optional));
        table.write_record(record)?;
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
                record.extend(["", "", "", "", reason, "", "", "", ""].map(String::from));
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
        "threshold",
        "raised_at",
        "raised_by",
        "cleared_at",
        "largest",
        "share_above",
    ])?;
    for alarm in alarms {
        table.write_record([
            alarm.channel.clone(),
            alarm.indicator.to_owned(),
            alarm.signal.to_owned(),
            number(alarm.threshold),
            alarm.raised_at.to_string(),
            alarm.raised_by.clone(),
            alarm.cleared_at.map_or(String::new(), |index| index.to_string()),
            number(alarm.largest),
            number(alarm.share_above),
        ])?;
    }
    table.flush()?;
    Ok(())
}
