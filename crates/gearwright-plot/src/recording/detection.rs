//! Receiver operating characteristics, and probability of detection over severity with 95 % intervals.

use crate::{COLOURS, Line, MarkedChart, Pattern};
use gearwright_case::RecordingCase;
use gearwright_results::recording::{Detected, Outcome};

use super::{CHANNELS, chart, heading};

/// Figures for each channel.
pub fn charts(case: &RecordingCase, outcome: &Outcome) -> Vec<(String, MarkedChart)> {
    let Some(detection) = &outcome.detection else { return Vec::new() };
    let mut channels: Vec<&str> = Vec::new();
    for detected in &detection.detected {
        if !channels.contains(&detected.channel.as_str()) {
            channels.push(&detected.channel);
        }
    }
    let mut charts = Vec::new();
    for (index, channel) in channels.iter().take(CHANNELS).enumerate() {
        let name = |what: &str| if channels.len() > 1 { format!("{what}_{}", index + 1) } else { what.to_owned() };
        // Those that separate best; of equal ones, the first of the tables.
        let mut shown: Vec<&Detected> = detection.detected.iter().filter(|d| d.channel == *channel).collect();
        shown.sort_by(|a, b| b.roc.area.total_cmp(&a.roc.area));
        shown.truncate(BEST);
        charts.push((name("roc"), roc(case, channel, &shown)));
        for (number, condition) in conditions(&shown).into_iter().enumerate() {
            let what = match (condition, number) {
                ("", _) => "detection_over_severity".to_owned(),
                (_, number) => format!("detection_over_severity_condition_{}", number + 1),
            };
            charts.push((name(&what), over_severity(case, channel, condition, &shown)));
        }
    }
    charts
}

/// Indicators in a figure: the best by area under the receiver operating characteristic.
const BEST: usize = 8;

/// Conditions with more than one severity, in their order.
fn conditions<'a>(shown: &[&'a Detected]) -> Vec<&'a str> {
    let all = shown.iter().flat_map(|detected| &detected.by_severity).map(|(severity, _)| &severity.condition[..]);
    let mut found: Vec<&str> = Vec::new();
    for condition in all {
        let severities = |d: &&Detected| d.by_severity.iter().filter(|(s, _)| s.condition == condition).count();
        if !found.contains(&condition) && shown.iter().any(|detected| severities(detected) > 1) {
            found.push(condition);
        }
    }
    found
}

fn named(detected: &Detected, extra: &str) -> String {
    format!("{}, {}{extra}", detected.indicator.replace('_', " "), detected.signal)
}

fn line(name: String, index: usize, points: Vec<(f64, f64)>) -> Line {
    // Curves that run together stay apart by their patterns.
    let patterns = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];
    Line { name, points, pattern: patterns[index % patterns.len()], colour: COLOURS[index % COLOURS.len()] }
}

fn roc(case: &RecordingCase, channel: &str, shown: &[&Detected]) -> MarkedChart {
    let mut lines: Vec<Line> = shown
        .iter()
        .enumerate()
        .map(|(index, detected)| {
            let points = detected.roc.points.iter().map(|p| (p.false_alarm_rate, p.detection_rate)).collect();
            line(named(detected, &format!(": {:.3}", detected.roc.area)), index, points)
        })
        .collect();
    let chance = vec![(0.0, 0.0), (1.0, 1.0)];
    lines.push(Line { name: "chance: 0.500".into(), points: chance, pattern: Pattern::Dotted, colour: "#9a9a9a" });
    let title = heading(case, &format!("receiver operating characteristic of {channel}, area under it"));
    let chart = chart(title, "False-alarm rate", "Detection rate".into(), lines);
    MarkedChart { chart, marks: Vec::new(), bands: Vec::new(), x_range: Some((0.0, 1.0)), y_up_to: Some(1.0) }
}

fn over_severity(case: &RecordingCase, channel: &str, condition: &str, shown: &[&Detected]) -> MarkedChart {
    let under = |detected: &Detected| -> Vec<(f64, f64)> {
        let here = detected.by_severity.iter().filter(|(severity, _)| severity.condition == condition);
        here.map(|(severity, rate)| (severity.value, rate.value())).collect()
    };
    let drawn: Vec<&&Detected> = shown.iter().filter(|detected| !under(detected).is_empty()).collect();
    let mut lines: Vec<Line> =
        drawn.iter().enumerate().map(|(index, detected)| line(named(detected, ""), index, under(detected))).collect();
    // Intervals of the best one: those of all would hide each other.
    if let Some(best) = drawn.first() {
        for (severity, rate) in best.by_severity.iter().filter(|(severity, _)| severity.condition == condition) {
            let points = vec![(severity.value, rate.low), (severity.value, rate.high)];
            lines.push(Line { name: String::new(), points, pattern: Pattern::Solid, colour: COLOURS[0] });
        }
    }
    let at = if condition.is_empty() { String::new() } else { format!(", condition {condition}") };
    let title = heading(case, &format!("probability of detection of {channel}{at}"));
    let mut chart = chart(title, "Severity", "Share outside the limits".into(), lines);
    chart.from_zero = true;
    MarkedChart { chart, marks: Vec::new(), bands: Vec::new(), x_range: None, y_up_to: Some(1.0) }
}
