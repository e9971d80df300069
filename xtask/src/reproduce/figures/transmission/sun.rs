//! Figures 6.4 to 6.8: a root crack on a tooth of the sun.

use anyhow::Context as _;
use hums::indicator::basic::{kurtosis, peak};

use super::*;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::Drawn;
use crate::reproduce::vibration::{Average, Vibration};

/// Which engagement is shown closely, and carrier turns before and after it.
const SHOWN: (usize, f64, f64) = (2, 0.01, 0.06);
const AVERAGES: [Average; 2] = [Average::PlanetPass, Average::CarrierTurn];

fn sensor(vibration: &Vibration) -> anyhow::Result<usize> {
    vibration.sensor(INPUT_PORT)
}

/// Exact difference signals near the input port.
fn exact(vibration: &Vibration, over: Average) -> anyhow::Result<Vec<Vec<f64>>> {
    let (sensor, healthy) = (sensor(vibration)?, vibration.healthy()?);
    let one = |state: &State| vibration.clock.exact(&state.shown[sensor], &healthy.shown[sensor], over);
    vibration.damaged().iter().map(one).collect()
}

fn difference_panel(vibration: &Vibration, letter: &'static str, about: &str, signals: &[Vec<f64>]) -> Panel {
    let states = coloured(&vibration.states, &SUN_COLOURS).into_iter().skip(1).zip(signals);
    let lines: Vec<Line> =
        states.map(|((s, colour), x)| solid(&s.key(), colour, vibration.clock.over_turns(x))).collect();
    time_panel(letter, about, lines.into_iter().rev().collect())
}

/// Figure 6.4.
pub fn accelerations(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(SUN)?;
    let sensor = sensor(&vibration)?;
    let engagements = context.sun_engagements(SUN)?;
    let (first, second) = (engagements.first().context("none")?, engagements.get(1).context("only one")?);
    let mut drawn = Drawn::default();
    drawn.value("first engagement (carrier cycle)", *first);
    drawn.value("second engagement (carrier cycle)", *second);
    let in_a_turn = engagements.iter().filter(|turn| **turn - first < 1.0 - 1e-9).count();
    drawn.value("engagements of the damaged tooth in a carrier cycle", in_a_turn as f64);
    let lines = |range: (f64, f64)| -> Vec<Line> {
        let states = coloured(&vibration.states, &SUN_COLOURS).into_iter().rev();
        states
            .map(|(s, colour)| solid(&s.key(), colour, over_turns(&vibration.clock, &s.shown[sensor], range)))
            .collect()
    };
    drawn.panels.push(time_panel("a", "Three turns of the carrier.", lines((0.0, 3.0))));
    let at = engagements.get(SHOWN.0).context("too few engagements")?;
    drawn.panels.push(time_panel("b", "One engagement of the damaged tooth.", lines((at - SHOWN.1, at + SHOWN.2))));
    drawn.panels.push(model::cracked_tooth(context, SUN, "c", "Root cracks of the sun tooth.", SUN_COLOURS)?);
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 6.5.
pub fn approximate_differences(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(SUN)?;
    let sensor = sensor(&vibration)?;
    let mut drawn = Drawn::default();
    for (letter, over) in ["a", "b"].iter().zip(AVERAGES) {
        let mut lines = Vec::new();
        for (state, colour) in coloured(&vibration.states, &SUN_COLOURS).into_iter().rev() {
            let signal = vibration.clock.approximate(&state.shown[sensor], over, 1)?;
            lines.push(solid(&state.key(), colour, vibration.clock.over_turns(&signal)));
        }
        drawn.panels.push(time_panel(
            letter,
            &format!("Approximate difference signals of the {}.", over.name()),
            lines,
        ));
    }
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 6.6.
pub fn exact_differences(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(SUN)?;
    let mut drawn = Drawn::default();
    let panels = [("a", Average::PlanetPass), ("b", Average::CarrierTurn), ("c", Average::Unaltered)];
    let mut peaks = Vec::new();
    for (letter, over) in panels {
        let signals = exact(&vibration, over)?;
        let about = format!("Exact difference signals, {}.", over.name());
        drawn.panels.push(difference_panel(&vibration, letter, &about, &signals));
        let all = || signals.iter().flatten().copied();
        if over != Average::PlanetPass {
            drawn.value(format!("{}, least", over.name()), all().fold(f64::INFINITY, f64::min));
            drawn.value(format!("{}, largest", over.name()), all().fold(f64::NEG_INFINITY, f64::max));
            let largest = signals.iter().map(|x| peak(x)).collect::<Result<Vec<_>, _>>()?;
            peaks.push(largest.into_iter().fold(0.0, f64::max));
        }
    }
    if let [carrier, unaltered] = peaks[..] {
        let found = format!("peak {unaltered:.2} g unaltered, {carrier:.2} g averaged");
        drawn.claim("averaging over the carrier turn loses damage", carrier < unaltered, found);
    }
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 6.7.
pub fn fm4(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(SUN)?;
    let sensor = sensor(&vibration)?;
    let mut drawn = Drawn::default();
    let styles = [(MAGENTA, Pattern::Circles), (ORANGE, Pattern::Squares)];
    let mut lines = Vec::new();
    for (over, (colour, marker)) in AVERAGES.into_iter().zip(styles) {
        let mut values = Vec::new();
        for state in &vibration.states {
            values.push((state.percent, kurtosis(&vibration.clock.approximate(&state.shown[sensor], over, 1)?)?));
        }
        lines.push(solid(over.name(), colour, values.clone()));
        lines.push(over_severity("", colour, marker, &values));
    }
    let labels = ("Crack length (%)", "FM4");
    let panel = Panel::chart("a", "Approximate difference signals; 0: healthy.", labels, lines);
    drawn.panels.push(panel.mark(threshold(FM4_THRESHOLD, "")));
    let styles = [(BLUE, Pattern::Circles), (GREEN, Pattern::Squares), (RED, Pattern::Crosses)];
    let mut lines = Vec::new();
    let mut least = f64::INFINITY;
    for (over, (colour, marker)) in Average::ALL.into_iter().zip(styles) {
        let mut values = Vec::new();
        for (state, signal) in vibration.damaged().iter().zip(exact(&vibration, over)?) {
            values.push((state.percent, kurtosis(&signal)?));
        }
        if over != Average::PlanetPass {
            least = values.iter().map(|v| v.1).fold(least, f64::min);
        }
        lines.push(solid(over.name(), colour, values.clone()));
        lines.push(over_severity("", colour, marker, &values));
    }
    drawn.value("exact, least FM4 over the threshold", 100.0 * (least / FM4_THRESHOLD - 1.0));
    let panel = Panel::chart("b", "Exact difference signals.", labels, lines);
    drawn.panels.push(panel.mark(threshold(FM4_THRESHOLD, "")));
    drawn.claim(
        "unaltered and carrier averages tell every crack",
        least > FM4_THRESHOLD,
        format!("least FM4 {least:.2}"),
    );
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 6.8.
pub fn around_the_housing(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(SUN)?;
    let mut drawn = Drawn::default();
    let mut least = f64::INFINITY;
    for (letter, about, average) in [("a", "unaltered", 0), ("b", "carrier average", 2)] {
        let states = coloured(&vibration.states, &SUN_COLOURS).into_iter().skip(1);
        let rings: Vec<_> = states
            .map(|(state, colour)| {
                let points: Vec<(f64, f64)> = state.around.iter().map(|s| (s.angle, s.exact[average])).collect();
                Ring { name: state.key(), colour, points }
            })
            .collect();
        least = rings.iter().flat_map(|r| &r.points).map(|p| p.1).fold(least, f64::min);
        drawn.panels.push(polar(
            letter,
            &format!("ln FM4 of the exact difference signal about the housing, {about}."),
            rings,
            FM4_THRESHOLD,
        ));
    }
    drawn.value("exact, least FM4 around the housing over the threshold", 100.0 * (least / FM4_THRESHOLD - 1.0));
    drawn.claim("every sensor tells every crack", least > FM4_THRESHOLD, format!("least FM4 {least:.2}"));
    drawn.note("The logarithm is drawn, as in Figure 5.9.");
    drawn.note(MODEL);
    Ok(drawn)
}
