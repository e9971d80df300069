//! Appendices A and B: condition indicators of the housing's accelerations over crack lengths.

use anyhow::Context as _;
use hums::indicator::basic::{CrestDefinition, Ends, crest_factor, energy_operator, kurtosis, m8a, rms};
use hums::moments::Moments;

use super::*;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Table};
use crate::reproduce::vibration::{Average, Vibration};

type Indicator = fn(&[f64]) -> anyhow::Result<f64>;

const LENGTH: &str = "Crack length (%); 0: healthy";
const MARKERS: [Pattern; 3] = [Pattern::Squares, Pattern::Circles, Pattern::Crosses];
const COLOURS: [&str; 3] = [BLACK, BLUE, RED];
const AVERAGED: [Average; 2] = [Average::PlanetPass, Average::CarrierTurn];

fn rms_of(x: &[f64]) -> anyhow::Result<f64> {
    Ok(rms(x)?)
}

fn crest_of(x: &[f64]) -> anyhow::Result<f64> {
    Ok(crest_factor(x, CrestDefinition::AbsolutePeak)?)
}

fn kurtosis_of(x: &[f64]) -> anyhow::Result<f64> {
    Ok(kurtosis(x)?)
}

fn energy_of(x: &[f64]) -> anyhow::Result<f64> {
    Ok(energy_operator(x, Ends::Cyclic)?)
}

fn m8a_of(x: &[f64]) -> anyhow::Result<f64> {
    Ok(m8a(x)?)
}

/// What an indicator is taken from.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    Acceleration,
    Approximate,
    Residual,
    Exact,
}

/// An indicator over crack lengths, for one way of averaging.
struct Row {
    average: Average,
    /// Crack length (%) and value.
    values: Vec<(f64, f64)>,
}

impl Row {
    /// Change against the healthy state (%).
    fn change(&self) -> Vec<(f64, f64)> {
        let healthy = self.values.first().map_or(f64::NAN, |v| v.1);
        self.values.iter().map(|(length, value)| (*length, 100.0 * (value / healthy - 1.0))).collect()
    }

    /// Change at a crack length (%).
    fn change_at(&self, length: f64) -> Option<f64> {
        self.change().into_iter().find(|v| v.0 == length).map(|v| v.1)
    }
}

fn rows(
    vibration: &Vibration,
    sensor: &str,
    source: Source,
    averages: &[Average],
    indicator: Indicator,
) -> anyhow::Result<Vec<Row>> {
    let sensor = vibration.sensor(sensor)?;
    let (clock, healthy) = (&vibration.clock, &vibration.healthy()?.shown[sensor]);
    let row = |&average: &Average| {
        let states = if source == Source::Exact { vibration.damaged() } else { &vibration.states };
        let value = |state: &State| {
            let record = &state.shown[sensor];
            let signal = match source {
                Source::Acceleration => clock.averaged(record, average),
                Source::Approximate => clock.approximate(record, average, 1),
                Source::Residual => clock.residual(record, average),
                Source::Exact => clock.exact(record, healthy, average),
            }?;
            Ok((state.percent, indicator(&signal)?))
        };
        Ok(Row { average, values: states.iter().map(value).collect::<anyhow::Result<_>>()? })
    };
    averages.iter().map(row).collect()
}

fn lines(rows: &[Row], values: impl Fn(&Row) -> Vec<(f64, f64)>) -> Vec<Line> {
    let mut lines = Vec::new();
    for row in rows {
        let index = Average::ALL.iter().position(|a| *a == row.average).unwrap_or(0);
        lines.push(solid(row.average.name(), COLOURS[index], values(row)));
        lines.push(over_severity("", COLOURS[index], MARKERS[index], &values(row)));
    }
    lines
}

fn value_panel(letter: &'static str, name: &str, rows: &[Row]) -> Panel {
    Panel::chart(letter, &format!("{name} over crack length."), (LENGTH, name), lines(rows, |row| row.values.clone()))
}

/// The value and its change.
fn pair_of_panels(drawn: &mut Drawn, name: &str, rows: &[Row]) {
    drawn.panels.push(value_panel("a", name, rows));
    let label = format!("Change of {name} (%)");
    drawn.panels.push(Panel::chart(
        "b",
        "Change against the healthy state.",
        (LENGTH, &label),
        lines(rows, Row::change),
    ));
    drawn.note(MODEL);
}

fn changes(rows: &[Row], length: f64) -> Vec<f64> {
    rows.iter().filter_map(|row| row.change_at(length)).collect()
}

fn largest_size(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest, value| value.abs().max(largest))
}

fn ring(context: &Context, source: Source, averages: &[Average], indicator: Indicator) -> anyhow::Result<Vec<Row>> {
    rows(context.vibration(RING)?.as_ref(), RING_TOOTH, source, averages, indicator)
}

/// Figure A.1.
pub fn rms_of_ring(context: &Context) -> anyhow::Result<Drawn> {
    let found = ring(context, Source::Acceleration, &Average::ALL, rms_of)?;
    let mut drawn = Drawn::default();
    let healthy: Vec<f64> = found.iter().filter_map(|row| row.values.first()).map(|v| v.1).collect();
    if let [unaltered, pass, _] = healthy[..] {
        drawn.value("bevel stage, increase of RMS", unaltered - pass);
    }
    let small = largest_size([20.0, 50.0].into_iter().flat_map(|length| changes(&found, length)));
    drawn.claim("small cracks change it little", small < 1.0, format!("at most {small:.2} % up to 50 %"));
    pair_of_panels(&mut drawn, "RMS (g)", &found);
    Ok(drawn)
}

/// Figure A.2.
pub fn crest_of_ring(context: &Context) -> anyhow::Result<Drawn> {
    let found = ring(context, Source::Acceleration, &Average::ALL, crest_of)?;
    let mut drawn = Drawn::default();
    let large = changes(&found, 80.0);
    drawn.value("80 %, increase of the crest factor, average", large.get(1).copied().unwrap_or(f64::NAN));
    let small = largest_size([20.0, 50.0].into_iter().flat_map(|length| changes(&found, length)));
    drawn.claim("small cracks change it little", small < 5.0, format!("at most {small:.2} % up to 50 %"));
    pair_of_panels(&mut drawn, "Crest factor", &found);
    Ok(drawn)
}

/// Figure A.3.
pub fn kurtosis_of_ring(context: &Context) -> anyhow::Result<Drawn> {
    let found = ring(context, Source::Acceleration, &Average::ALL, kurtosis_of)?;
    let mut drawn = Drawn::default();
    let large = changes(&found, 80.0);
    drawn.value("80 %, increase of kurtosis, unaltered", large.first().copied().unwrap_or(f64::NAN));
    drawn.value("80 %, increase of kurtosis, average", large.get(1).copied().unwrap_or(f64::NAN));
    pair_of_panels(&mut drawn, "Kurtosis", &found);
    Ok(drawn)
}

/// Figure A.4.
pub fn energy_of_ring(context: &Context) -> anyhow::Result<Drawn> {
    let found = ring(context, Source::Acceleration, &Average::ALL, energy_of)?;
    let kurtosis = ring(context, Source::Acceleration, &Average::ALL, kurtosis_of)?;
    let mut drawn = Drawn::default();
    let (own, other) = (changes(&found, 80.0), changes(&kurtosis, 80.0));
    let listed = format!("energy operator {:.1} %, kurtosis {:.1} % at 80 %, planet-pass average", own[1], other[1]);
    drawn.claim("changes more than kurtosis", own[1] > other[1], listed);
    pair_of_panels(&mut drawn, "Energy operator", &found);
    Ok(drawn)
}

/// Figure A.5.
pub fn averages_of_ring(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let sensor = vibration.sensor(RING_TOOTH)?;
    let record = &vibration.healthy()?.shown[sensor];
    let clock = vibration.clock;
    let turns = record.len() / clock.per_turn();
    let mut drawn = Drawn::default();
    for (letter, about, period, most) in [
        ("a", "Over the number of planet passes averaged.", clock.per_pass(), 27),
        ("b", "Over the number of carrier turns averaged.", clock.per_turn(), 9),
    ] {
        // the record repeats, as in the dissertation
        let periodic: Vec<f64> = record.iter().copied().cycle().take(period * most).collect();
        let (mut level, mut shape, mut rows) = (Vec::new(), Vec::new(), Vec::new());
        for blocks in 1..=most {
            let average = hums::tsa::average_periods(&periodic, period, Some(blocks))?.samples;
            let (rms, kurtosis) = (rms(&average)?, kurtosis(&average)?);
            level.push((blocks as f64, rms));
            shape.push((blocks as f64, kurtosis));
            rows.push(vec![blocks.to_string(), format!("{rms:.5}"), format!("{kurtosis:.5}")]);
        }
        let whole = turns * clock.per_turn() / period;
        if let (Some(once), Some(twice)) = (level.get(whole - 1), level.get(2 * whole - 1)) {
            let apart = (twice.1 / once.1 - 1.0).abs();
            let found = format!("RMS at {whole} and {} periods apart by {apart:.1e}", 2 * whole);
            drawn.claim(format!("repeats after {turns} turns ({letter})"), apart < 1e-9, found);
        }
        let normal = |values: Vec<(f64, f64)>| -> Vec<(f64, f64)> {
            let last = values.get(whole - 1).map_or(1.0, |v| v.1);
            values.into_iter().map(|(n, v)| (n, v / last)).collect()
        };
        let lines = vec![solid("RMS", BLACK, normal(level)), solid("kurtosis", RED, normal(shape))];
        let label = format!("Value over that of {whole} periods");
        drawn.panels.push(Panel::chart(letter, about, ("Periods averaged", &label), lines));
        drawn.tables.push(Table { head: ["periods", "RMS (g)", "kurtosis"].map(String::from).to_vec(), rows });
    }
    drawn.note("As in the dissertation, the record of three turns is repeated for longer averages.");
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure A.6.
pub fn difference_rms_of_ring(context: &Context) -> anyhow::Result<Drawn> {
    let found = ring(context, Source::Approximate, &[Average::PlanetPass], rms_of)?;
    let mut drawn = Drawn::default();
    let large = found.first().and_then(|row| row.change_at(80.0)).context("no crack of 80 %")?;
    drawn.value("80 %, increase of the RMS of the difference signal", large);
    let plain = ring(context, Source::Acceleration, &[Average::PlanetPass], rms_of)?;
    let plain = plain.first().and_then(|row| row.change_at(80.0)).context("no crack of 80 %")?;
    drawn.claim("more than of the acceleration", large > plain, format!("{large:.2} % against {plain:.2} % at 80 %"));
    pair_of_panels(&mut drawn, "RMS difference (g)", &found);
    Ok(drawn)
}

/// Figure A.7.
pub fn m8a_of_ring(context: &Context) -> anyhow::Result<Drawn> {
    let found = ring(context, Source::Approximate, &[Average::PlanetPass], m8a_of)?;
    let mut drawn = Drawn::default();
    let values = found.first().map(|row| row.values.clone()).unwrap_or_default();
    let told: Vec<bool> = values.iter().map(|v| v.1 > M8A_THRESHOLD).collect();
    let listed: Vec<String> = values.iter().map(|v| format!("{:.0} %: {:.1}", v.0, v.1)).collect();
    drawn.claim("80 % is told, 50 % and less is not", told == [false, false, false, true], listed.join("; "));
    pair_of_panels(&mut drawn, "M8A", &found);
    if let Some(panel) = drawn.panels.first_mut()
        && let Picture::Chart(chart) = &mut panel.picture
    {
        chart.marks.push(threshold(M8A_THRESHOLD, ""));
    }
    Ok(drawn)
}

fn sun(context: &Context, source: Source, averages: &[Average], indicator: Indicator) -> anyhow::Result<Vec<Row>> {
    rows(context.vibration(SUN)?.as_ref(), INPUT_PORT, source, averages, indicator)
}

/// Figure B.1.
pub fn accelerations_of_sun(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let all: [(&'static str, &str, Indicator); 4] = [
        ("a", "RMS (g)", rms_of),
        ("b", "Crest factor", crest_of),
        ("c", "Kurtosis", kurtosis_of),
        ("d", "Energy operator", energy_of),
    ];
    let mut small: f64 = 0.0;
    for (letter, name, indicator) in all {
        let found = sun(context, Source::Acceleration, &Average::ALL, indicator)?;
        small = largest_size([20.0, 50.0].into_iter().flat_map(|length| changes(&found, length)).chain([small]));
        drawn.panels.push(value_panel(letter, name, &found));
    }
    drawn.claim("small cracks change them little", small < 10.0, format!("at most {small:.2} % up to 50 %"));
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure B.2.
pub fn differences_of_sun(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    drawn.panels.push(value_panel("a", "RMS difference (g)", &sun(context, Source::Approximate, &AVERAGED, rms_of)?));
    drawn.panels.push(value_panel("b", "Energy ratio", &energy_ratios(context)?));
    drawn.panels.push(value_panel("c", "M8A", &sun(context, Source::Approximate, &AVERAGED, m8a_of)?));
    drawn.panels.push(value_panel("d", "NA4", &sun(context, Source::Residual, &AVERAGED, kurtosis_of)?));
    drawn.note("NA4 of one record is the kurtosis of the residual signal.");
    drawn.note(MODEL);
    Ok(drawn)
}

/// Standard deviation of the difference signal over that of what is removed.
fn energy_ratios(context: &Context) -> anyhow::Result<Vec<Row>> {
    let vibration = context.vibration(SUN)?;
    let (sensor, clock) = (vibration.sensor(INPUT_PORT)?, &vibration.clock);
    let ratio = |state: &State, average: Average| -> anyhow::Result<f64> {
        let record = &state.shown[sensor];
        let (whole, difference) = (clock.averaged(record, average)?, clock.approximate(record, average, 1)?);
        let regular: Vec<f64> = whole.iter().zip(&difference).map(|(x, d)| x - d).collect();
        Ok(hums::indicator::gear::energy_ratio(&Moments::of(&difference)?, &Moments::of(&regular)?)?)
    };
    let mut rows = Vec::new();
    for average in AVERAGED {
        let mut values = Vec::new();
        for state in &vibration.states {
            values.push((state.percent, ratio(state, average)?));
        }
        rows.push(Row { average, values });
    }
    Ok(rows)
}

/// Figure B.3.
pub fn exact_of_sun(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    drawn.panels.push(value_panel("a", "RMS difference (g)", &sun(context, Source::Exact, &Average::ALL, rms_of)?));
    let found = sun(context, Source::Exact, &Average::ALL, m8a_of)?;
    let telling = found.iter().filter(|row| row.average != Average::PlanetPass);
    let least = telling.flat_map(|row| &row.values).map(|v| v.1).fold(f64::INFINITY, f64::min);
    drawn.claim(
        "unaltered and carrier averages tell every crack",
        least > M8A_THRESHOLD,
        format!("least M8A {least:.0}"),
    );
    drawn.panels.push(value_panel("b", "M8A", &found).mark(threshold(M8A_THRESHOLD, "")));
    drawn.note(MODEL);
    Ok(drawn)
}
