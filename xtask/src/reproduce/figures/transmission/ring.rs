//! Figures 5.5 to 5.10 and Table 5.2: a root crack on a tooth of the ring.

use anyhow::{Context as _, ensure};
use gearwright_plot::Band;
use hums::indicator::basic::{kurtosis, peak};

use super::*;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Table};
use crate::reproduce::vibration::{Average, Vibration};

/// Part of a carrier turn before and after the damaged tooth engages that is shown closely.
const AROUND: (f64, f64) = (0.02, 0.08);
/// Part of its peak above which a difference signal is not at rest.
const AT_REST: f64 = 0.05;
/// Crack whose transient gives the place of the tooth, as the clearest.
const CLEAREST: f64 = 80.0;
/// Most pairs of sidebands removed.
const MOST_PAIRS: usize = 5;

fn beside(vibration: &Vibration) -> anyhow::Result<usize> {
    vibration.sensor(RING_TOOTH)
}

/// Exact difference signals of the planet-pass average beside the tooth, by state.
fn exact(vibration: &Vibration) -> anyhow::Result<Vec<Vec<f64>>> {
    let (sensor, healthy) = (beside(vibration)?, vibration.healthy()?);
    let one = |state: &State| vibration.clock.exact(&state.shown[sensor], &healthy.shown[sensor], Average::PlanetPass);
    vibration.damaged().iter().map(one).collect()
}

/// Where a transient begins and ends (carrier turns): first and last crossing of a part of its peak.
fn transient(vibration: &Vibration, signal: &[f64]) -> anyhow::Result<(f64, f64)> {
    let level = AT_REST * peak(signal)?;
    let loud = |x: &f64| x.abs() > level;
    let first = signal.iter().position(loud).context("a difference signal at rest")?;
    let last = signal.iter().rposition(loud).unwrap_or(first);
    Ok((vibration.clock.turn_of(first), vibration.clock.turn_of(last)))
}

/// The engagement of the damaged tooth in the first planet pass.
fn engagement(vibration: &Vibration) -> anyhow::Result<(f64, f64)> {
    let signals = exact(vibration)?;
    let clearest = vibration.damaged().iter().position(|s| s.percent == CLEAREST).context("no crack of 80 %")?;
    transient(vibration, &signals[clearest])
}

/// Healthy and one damaged signal near the engagement.
fn close_ups(
    drawn: &mut Drawn,
    vibration: &Vibration,
    signals: &[(&State, &'static str, Vec<f64>)],
    first_letter: u8,
    what: &str,
) -> anyhow::Result<()> {
    const LETTERS: [&str; 6] = ["a", "b", "c", "d", "e", "f"];
    let begin = engagement(vibration)?.0;
    let shown = (begin - AROUND.0, begin + AROUND.1);
    let Some(((_, healthy_colour, healthy), damaged)) = signals.split_first() else { return Ok(()) };
    for (k, (state, colour, samples)) in damaged.iter().enumerate() {
        let lines = vec![
            solid("healthy", healthy_colour, over_turns(&vibration.clock, healthy, shown)),
            solid(&state.key(), colour, over_turns(&vibration.clock, samples, shown)),
        ];
        let about = format!("{what} as the damaged tooth engages, crack of {}.", state.key());
        drawn.panels.push(time_panel(LETTERS[usize::from(first_letter) + k], &about, lines));
    }
    Ok(())
}

/// The engagement as a shaded stretch of a chart.
fn boxed(mut panel: Panel, vibration: &Vibration) -> anyhow::Result<Panel> {
    let (from, to) = engagement(vibration)?;
    if let Picture::Chart(chart) = &mut panel.picture {
        chart.bands.push(Band { from, to, colour: MAGENTA });
    }
    Ok(panel)
}

/// Figure 5.5.
pub fn accelerations(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let sensor = beside(&vibration)?;
    let signals: Vec<_> = coloured(&vibration.states, &RING_COLOURS)
        .into_iter()
        .map(|(s, colour)| (s, colour, s.shown[sensor].clone()))
        .collect();
    let mut drawn = Drawn::default();
    // the largest damage lies lowest, so that all show
    let all =
        signals.iter().rev().map(|(s, colour, x)| solid(&s.key(), colour, vibration.clock.over_turns(x))).collect();
    drawn
        .panels
        .push(boxed(time_panel("a", "Three turns of the carrier, sensor beside the damaged tooth.", all), &vibration)?);
    close_ups(&mut drawn, &vibration, &signals, 1, "Accelerations")?;
    drawn.panels.push(model::cracked_tooth(context, RING, "e", "Root cracks of the ring tooth.", RING_COLOURS)?);
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 5.6.
pub fn exact_differences(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let signals = exact(&vibration)?;
    let states: Vec<_> = coloured(&vibration.states, &RING_COLOURS).into_iter().skip(1).zip(&signals).collect();
    let mut drawn = Drawn::default();
    let lines =
        states.iter().rev().map(|((s, colour), x)| solid(&s.key(), colour, vibration.clock.over_turns(x))).collect();
    drawn.panels.push(time_panel("a", "Exact difference signals of the planet-pass average.", lines));
    let mut spectra = Vec::new();
    for ((state, colour), signal) in states.iter().rev() {
        spectra.push(solid(&state.key(), colour, vibration.clock.spectrum(signal, HIGHEST)?));
    }
    drawn.panels.push(spectrum_panel("b", "Their spectra.", spectra));
    let (begin, end) = engagement(&vibration)?;
    drawn.value("crack, transients begin (carrier cycle)", begin);
    drawn.value("crack, transients end (carrier cycle)", end);
    for (k, name) in ["34.56", "154.56", "274.56"].iter().enumerate() {
        drawn.value(format!("damaged tooth at {name}"), 360.0 * begin + 120.0 * k as f64);
    }
    let peaks: Vec<f64> = signals.iter().map(|x| peak(x)).collect::<Result<_, _>>()?;
    let listed: Vec<String> = peaks.iter().map(|p| format!("{p:.3}")).collect();
    drawn.claim("amplitudes rise with the crack", peaks.is_sorted(), format!("peaks {} g", listed.join(", ")));
    drawn.note(format!("A transient begins and ends where it passes {:.0} % of its peak.", 100.0 * AT_REST));
    drawn.note(MODEL);
    Ok(drawn)
}

/// Approximate difference signals of the planet-pass average beside the tooth, by state.
fn approximate<'a>(vibration: &'a Vibration, pairs: usize) -> anyhow::Result<Vec<(&'a State, &'static str, Vec<f64>)>> {
    let sensor = beside(vibration)?;
    let one = |(state, colour): (&'a State, &'static str)| {
        let signal = vibration.clock.approximate(&state.shown[sensor], Average::PlanetPass, pairs)?;
        Ok((state, colour, signal))
    };
    coloured(&vibration.states, &RING_COLOURS).into_iter().map(one).collect()
}

fn approximate_panel(vibration: &Vibration, letter: &'static str, about: &str, pairs: usize) -> anyhow::Result<Panel> {
    let signals = approximate(vibration, pairs)?;
    let lines =
        signals.iter().rev().map(|(s, colour, x)| solid(&s.key(), colour, vibration.clock.over_turns(x))).collect();
    boxed(time_panel(letter, about, lines), vibration)
}

/// Figure 5.7.
pub fn approximate_differences(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let mut drawn = Drawn::default();
    let about = "Planet-pass average without mesh harmonics and their first sidebands.";
    drawn.panels.push(approximate_panel(&vibration, "a", about, 1)?);
    close_ups(&mut drawn, &vibration, &approximate(&vibration, 1)?, 1, "Approximate difference signals")?;
    drawn.note(MODEL);
    Ok(drawn)
}

/// Table 5.2.
pub fn fm4_table(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let exact = exact(&vibration)?;
    let mut drawn = Drawn::default();
    let mut rows = Vec::new();
    for (k, (state, _, signal)) in approximate(&vibration, 1)?.iter().enumerate() {
        let key = state.key();
        let value = kurtosis(signal)?;
        drawn.value(format!("{key}, approximate"), value);
        let mut row = vec![key.clone(), format!("{value:.2}"), String::new()];
        if k > 0 {
            let value = kurtosis(&exact[k - 1])?;
            drawn.value(format!("{key}, exact"), value);
            row[2] = format!("{value:.2}");
        }
        rows.push(row);
    }
    let least =
        exact.iter().map(|x| kurtosis(x)).collect::<Result<Vec<_>, _>>()?.into_iter().fold(f64::INFINITY, f64::min);
    drawn.claim("exact differences tell every crack", least > FM4_THRESHOLD, format!("least FM4 {least:.1}"));
    drawn.tables.push(Table { head: ["crack", "FM4, approximate", "FM4, exact"].map(String::from).to_vec(), rows });
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 5.8.
pub fn more_sidebands(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let mut drawn = Drawn::default();
    for (letter, pairs) in [("a", 3), ("b", 5)] {
        let about = format!("Approximate difference signals without {pairs} pairs of sidebands.");
        drawn.panels.push(approximate_panel(&vibration, letter, &about, pairs)?);
    }
    const PATTERNS: [Pattern; 4] = [Pattern::Squares, Pattern::Circles, Pattern::Crosses, Pattern::Dashed];
    let mut lines = Vec::new();
    let mut rising = Vec::new();
    for (index, ((state, colour), pattern)) in
        coloured(&vibration.states, &RING_COLOURS).into_iter().zip(PATTERNS).enumerate()
    {
        let mut values = Vec::new();
        for pairs in 0..=MOST_PAIRS {
            values.push((pairs as f64, kurtosis(&approximate(&vibration, pairs)?[index].2)?));
        }
        if index > 0 {
            rising.push((state.key(), values[1].1, values[4].1));
        }
        lines.push(solid(&state.key(), colour, values.clone()));
        if pattern != Pattern::Dashed {
            lines.push(line("", colour, pattern, values));
        }
    }
    let holds = rising.iter().all(|(_, one, four)| four > one);
    let found: Vec<String> = rising.iter().map(|(key, one, four)| format!("{key}: {one:.2} to {four:.2}")).collect();
    drawn.claim("FM4 rises with sidebands removed", holds, found.join("; "));
    let panel = Panel::chart("c", "FM4 over the pairs of sidebands removed.", ("Pairs of sidebands", "FM4"), lines);
    drawn.panels.push(panel.mark(threshold(FM4_THRESHOLD, "")));
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 5.9.
pub fn around_the_housing(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let mut drawn = Drawn::default();
    let mut overall = f64::INFINITY;
    for (letter, state) in ["a", "b", "c"].iter().zip(vibration.damaged()) {
        let key = state.key();
        let exact: Vec<(f64, f64)> = state.around.iter().map(|s| (s.angle, s.exact[1])).collect();
        let approximate = state.around.iter().map(|s| (s.angle, s.approximate)).collect();
        let least =
            exact.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).context("no sensors around the housing")?;
        overall = overall.min(least.1);
        drawn.value(format!("{key}, least FM4"), least.1);
        drawn.value(format!("{key}, angle of the least FM4"), least.0.rem_euclid(360.0));
        let rings = vec![
            Ring { name: "exact".into(), colour: RED, points: exact },
            Ring { name: "approximate".into(), colour: BLUE, points: approximate },
        ];
        drawn.panels.push(polar(letter, &format!("ln FM4 about the housing, crack of {key}."), rings, FM4_THRESHOLD));
    }
    drawn.claim("every sensor tells every crack", overall > FM4_THRESHOLD, format!("least FM4 {overall:.2}"));
    drawn.note("One sensor a ring tooth but over the two supports of the housing, whose places are not printed.");
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 5.10.
pub fn elsewhere(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(PLACES)?;
    let colours = [BLUE, RED, GREEN];
    let mut drawn = Drawn::default();
    for (letter, percent) in [("a", 20.0), ("b", 50.0)] {
        let states = vibration.damaged().iter().filter(|s| s.percent == percent);
        let rings: Vec<Ring> = states
            .zip(colours)
            .map(|(state, colour)| {
                let points = state.around.iter().map(|s| (s.angle, s.exact[1])).collect();
                Ring { name: state.label.clone(), colour, points }
            })
            .collect();
        ensure!(rings.len() == colours.len(), "the case has not three cracks of {percent} %");
        let values = || rings.iter().flat_map(|r| &r.points).map(|p| p.1);
        let least = values().fold(f64::INFINITY, f64::min);
        drawn.value(format!("{percent:.0} %, least FM4"), least);
        drawn.claim(
            format!("{percent:.0} % told at every place"),
            least > FM4_THRESHOLD,
            format!("least FM4 {least:.2}"),
        );
        let about = format!("ln FM4 of the exact difference signal about the housing, crack of {percent:.0} %.");
        drawn.panels.push(polar(letter, &about, rings, FM4_THRESHOLD));
    }
    drawn.note(MODEL);
    Ok(drawn)
}
