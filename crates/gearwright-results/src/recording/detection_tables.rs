//! Tables of detection: rates at the threshold, receiver operating characteristic, probability of detection over severity.

use std::path::Path;

use hums::detectability::HitMiss;
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
        "lower_limit",
        "upper_limit",
        "false_alarm_rate",
        "false_alarm_rate_low",
        "false_alarm_rate_high",
        "detection_rate",
        "detection_rate_low",
        "detection_rate_high",
        "rises_with_damage",
        "area_under_roc",
        "area_under_roc_low",
        "area_under_roc_high",
        "best_threshold",
        "best_false_alarm_rate",
        "best_detection_rate",
    ];
    table.write_record(NAME.iter().chain(&columns))?;
    for detected in all {
        let mut record = name(detected).to_vec();
        let limit = detected.bound.map(|bound| bound.limit);
        record.extend([limit.and_then(|l| l.lower), limit.and_then(|l| l.upper)].map(optional));
        record.extend(rate(detected.bound.and_then(|bound| bound.false_alarms)));
        record.extend(rate(detected.detection));
        record.push(if detected.roc.rises { "yes" } else { "no" }.to_owned());
        let (low, high) = detected.roc.area_interval();
        record.extend([detected.roc.area, low, high].map(number));
        let best = detected.best;
        // Infinite: no threshold keeps false alarms that low.
        record.push(optional(Some(best.threshold).filter(|t| t.is_finite())));
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

/// `detection_over_severity.csv`: share of recordings outside the limits for each condition and severity.
///
/// # Errors
/// I/O errors.
pub fn severities(path: &Path, all: &[Detected]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let columns = [
        "condition",
        "severity",
        "lower_limit",
        "upper_limit",
        "recordings",
        "outside",
        "detection_rate",
        "detection_rate_low",
        "detection_rate_high",
    ];
    table.write_record(NAME.iter().chain(&columns))?;
    for detected in all {
        for (severity, found) in &detected.by_severity {
            let mut record = name(detected).to_vec();
            record.push(severity.condition.clone());
            let limit = detected.bound.map(|bound| bound.limit);
            record.push(number(severity.value));
            record.extend([limit.and_then(|l| l.lower), limit.and_then(|l| l.upper)].map(optional));
            record.extend([found.cases, found.hits].map(|count| count.to_string()));
            record.extend(rate(Some(*found)));
            table.write_record(record)?;
        }
    }
    table.flush()?;
    Ok(())
}

/// `pod.csv`: logistic probability of detection over severity, for each condition: severities detected with probability 0.5 and 0.9, and a_90/95.
///
/// # Errors
/// I/O errors.
pub fn pod(path: &Path, all: &[Detected]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    let columns = ["condition", "recordings", "detected", "intercept", "slope", "a50", "a90", "a90_95", "reason"];
    table.write_record(NAME.iter().chain(&columns))?;
    for detected in all {
        for pod in &detected.pod {
            let mut record = name(detected).to_vec();
            record.push(pod.condition.clone());
            record.extend([pod.recordings, pod.detected].map(|count| count.to_string()));
            let fit = pod.fit.as_ref();
            let numbers = |fit: &HitMiss| {
                let sizes = [0.5, 0.9].map(|p| Some(fit.size_detected(p)));
                let with_confidence = fit.size_detected_with_confidence(0.9);
                [Some(fit.intercept), Some(fit.slope), sizes[0], sizes[1], with_confidence].map(optional)
            };
            record.extend(fit.map_or_else(|_| Default::default(), numbers));
            let few = || "too few data for 90 % at 95 % confidence at any severity".to_owned();
            record.push(match fit {
                Ok(fit) if fit.size_detected_with_confidence(0.9).is_some() => String::new(),
                Ok(_) => few(),
                Err(reason) => reason.clone(),
            });
            table.write_record(record)?;
        }
    }
    table.flush()?;
    Ok(())
}
