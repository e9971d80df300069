//! Tables of detection: rates at the threshold, receiver operating characteristic, probability of detection over severity.

use std::path::Path;

use hums::threshold::Rate;

use super::Detected;
use super::tables::{number, optional};

/// Channel, indicator, signal.
fn name(detected: &Detected) -> [String; 3] {
    [detected.channel.clone(), detected.indicator.to_owned(), detected.signal.to_owned()]
}

const NAME: [&str; 3] = ["channel", "indicator", "signal"];

/// A rate and the ends of its 95 % interval.
fn rate(rate: Option<Rate>) -> [String; 3] {
    [rate.map(|r| r.value()), rate.map(|r| r.low), rate.map(|r| r.high)].map(optional)
}

/// `detection.csv`: one row per channel, indicator and signal.
///
/// # Errors
/// I/O errors.
pub fn rates(path: &Path, all: &[Detected]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let columns = [
        "threshold",
        "false_alarm_rate",
        "false_alarm_rate_low",
        "false_alarm_rate_high",
        "detection_rate",
        "detection_rate_low",
        "detection_rate_high",
        "area_under_roc",
        "best_threshold",
        "best_false_alarm_rate",
        "best_detection_rate",
    ];
    table.write_record(NAME.iter().chain(&columns))?;
    for detected in all {
        let mut record = name(detected).to_vec();
        record.push(optional(detected.limit.map(|limit| limit.threshold)));
        record.extend(rate(detected.limit.and_then(|limit| limit.false_alarms)));
        record.extend(rate(detected.detection));
        let best = detected.best;
        // Infinite: no threshold keeps false alarms that low.
        record.push(optional(Some(best.threshold).filter(|t| t.is_finite())));
        record.insert(record.len() - 1, number(detected.roc.area));
        record.extend([best.false_alarm_rate, best.detection_rate].map(number));
        table.write_record(record)?;
    }
    table.flush()?;
    Ok(())
}

/// `roc.csv`: every threshold of every indicator. The first, above all values, is left empty.
///
/// # Errors
/// I/O errors.
pub fn roc(path: &Path, all: &[Detected]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(NAME.iter().chain(&["threshold", "false_alarm_rate", "detection_rate"]))?;
    for detected in all {
        for point in &detected.roc.points {
            let mut record = name(detected).to_vec();
            record.push(optional(Some(point.threshold).filter(|t| t.is_finite())));
            record.extend([point.false_alarm_rate, point.detection_rate].map(number));
            table.write_record(record)?;
        }
    }
    table.flush()?;
    Ok(())
}

/// `detection_over_severity.csv`: share of recordings above the threshold for each condition and severity.
///
/// # Errors
/// I/O errors.
pub fn severities(path: &Path, all: &[Detected]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let columns = [
        "condition",
        "severity",
        "threshold",
        "recordings",
        "above",
        "detection_rate",
        "detection_rate_low",
        "detection_rate_high",
    ];
    table.write_record(NAME.iter().chain(&columns))?;
    for detected in all {
        for (severity, found) in &detected.by_severity {
            let mut record = name(detected).to_vec();
            record.push(severity.condition.clone());
            record.extend([number(severity.value), optional(detected.limit.map(|limit| limit.threshold))]);
            record.extend([found.cases, found.hits].map(|count| count.to_string()));
            record.extend(rate(Some(*found)));
            table.write_record(record)?;
        }
    }
    table.flush()?;
    Ok(())
}
