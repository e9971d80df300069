//! How well indicators tell damaged from healthy recordings: rates of detection and of false alarms, receiver operating characteristic,
//! probability of detection over severity.

use std::collections::BTreeMap;
use std::path::Path;

use hums::detectability::HitMiss;
use hums::threshold::{Limit, Rate, Roc, detection_curve};

use super::error::RecordingError;
use gearwright_case::input;
use gearwright_results::recording::{Detected, FALSE_ALARMS, Limits, Measured, Pod, Row, Severity};

/// Fits of all conditions of what was counted.
fn pod(by_severity: &[(Severity, Rate)]) -> Vec<Pod> {
    let mut conditions: Vec<&str> = by_severity.iter().map(|(severity, _)| severity.condition.as_str()).collect();
    conditions.dedup();
    let of = |condition: &str| {
        let (mut severities, mut detected) = (Vec::new(), Vec::new());
        for (severity, rate) in by_severity.iter().filter(|(s, _)| s.condition == condition) {
            severities.extend(std::iter::repeat_n(severity.value, rate.cases));
            detected.extend((0..rate.cases).map(|k| k < rate.hits));
        }
        Pod {
            condition: condition.to_owned(),
            recordings: detected.len(),
            detected: detected.iter().filter(|hit| **hit).count(),
            fit: HitMiss::fit(&severities, &detected).map_err(|reason| reason.to_string()),
        }
    };
    conditions.into_iter().map(of).collect()
}

/// Detection by every indicator that both sets have, in the order of the tables.
#[must_use]
pub fn detect(
    healthy: &[&Measured],
    damaged: &[&Measured],
    limits: &Limits,
    severities: Option<&BTreeMap<String, Severity>>,
) -> Vec<Detected> {
    let Some(first) = damaged.first() else { return Vec::new() };
    let rows = first.channels.iter().flat_map(|channel| channel.rows.iter().map(move |row| (&channel.name, row)));
    let found = rows.filter_map(|(channel, row)| {
        let usable = |m: &Measured| m.channels.iter().any(|c| c.name == *channel && c.blocked.is_none());
        let values = |set: &[&Measured]| -> Vec<f64> {
            set.iter().filter(|m| usable(m)).filter_map(|m| m.value(channel, row)).collect()
        };
        let (of_healthy, of_damaged) = (values(healthy), values(damaged));
        let roc = Roc::oriented(&of_healthy, &of_damaged).ok()?;
        let bound = limits.of(channel, row);
        let by_severity = bound
            .zip(severities)
            .map(|(bound, table)| over_severity(damaged, channel, row, &bound.limit, table))
            .unwrap_or_default();
        Some(Detected {
            channel: channel.clone(),
            indicator: row.indicator,
            signal: row.signal,
            bound,
            detection: bound.and_then(|bound| Rate::outside(&of_damaged, &bound.limit).ok()),
            best: roc.at_false_alarm_rate(FALSE_ALARMS),
            roc,
            pod: pod(&by_severity),
            by_severity,
        })
    });
    found.filter(|detected| detected.indicator != "mean").collect()
}

fn over_severity(
    damaged: &[&Measured],
    channel: &str,
    row: &Row,
    limit: &Limit,
    severities: &BTreeMap<String, Severity>,
) -> Vec<(Severity, Rate)> {
    let mut sets: Vec<(&Severity, Vec<f64>)> = Vec::new();
    for measured in damaged {
        let stem = Path::new(&measured.name).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let severity = severities.get(&measured.name).or_else(|| severities.get(&stem));
        let (Some(severity), Some(value)) = (severity, measured.value(channel, row)) else { continue };
        match sets.iter_mut().find(|set| set.0 == severity) {
            Some(set) => set.1.push(value),
            None => sets.push((severity, vec![value])),
        }
    }
    sets.sort_by(|a, b| a.0.order(b.0));
    let values: Vec<&[f64]> = sets.iter().map(|set| &set.1[..]).collect();
    let rates = detection_curve(&values, limit).unwrap_or_default();
    sets.iter().map(|set| set.0.clone()).zip(rates).collect()
}

/// Reads a table of severities by recording.
///
/// # Errors
/// [`RecordingError::Missing`], [`RecordingError::Severities`] with the line at fault.
pub fn severities(path: &Path) -> Result<BTreeMap<String, Severity>, RecordingError> {
    if !path.exists() {
        return Err(RecordingError::Missing { path: path.into(), key: "detection.severities (--severities)" });
    }
    let fault = |line, reason| RecordingError::Severities { path: path.into(), line, reason };
    let read = |e: csv::Error| fault(e.position().map_or(1, csv::Position::line), e.to_string());
    let bytes = input::read(path, input::MAX_TABLE).map_err(|e| fault(1, e.to_string()))?;
    let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(&bytes[..]);
    let header = table.headers().map_err(read)?.clone();
    let named = |name: &str| header.iter().position(|heading| heading.eq_ignore_ascii_case(name));
    let column = |name: &str| named(name).ok_or_else(|| fault(1, format!("there is no column \"{name}\"")));
    let (name, severity) = (column("recording")?, column("severity")?);
    let condition = named("condition");
    let mut found = BTreeMap::new();
    for row in table.records() {
        let row = row.map_err(read)?;
        let line = row.position().map_or(0, csv::Position::line);
        let (name, text) = (row.get(name).unwrap_or_default(), row.get(severity).unwrap_or_default());
        let value: Option<f64> = text.parse().ok().filter(|value: &f64| value.is_finite()).map(|value| value + 0.0);
        let Some(value) = value else { return Err(fault(line, format!("severity `{text}` is not a number"))) };
        let condition = condition.and_then(|column| row.get(column)).unwrap_or_default().to_owned();
        if found.insert(name.to_owned(), Severity { condition, value }).is_some() {
            return Err(fault(line, format!("recording \"{name}\" comes twice")));
        }
    }
    Ok(found)
}
