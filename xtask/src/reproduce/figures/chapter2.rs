//! Chapter 2: the unity pair, healthy and with pits.

use gear_geom::Member;
use gearwright_plot::Pattern;

use super::scheme;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Panel, Table, colour::*, line};
use crate::reproduce::statics::{Series, Statics, at, increase, top};

const CYCLE: &str = "Mesh cycle";
const STE: &str = "Static transmission error (µm)";
const FORCE: &str = "Tooth contact force (kN)";
const STIFFNESS: &str = "Tooth pair stiffness (N/µm)";
/// Colours of the four pits.
const COLOURS: [&str; 4] = [BLUE, RED, GREEN, ORANGE];
/// Times the healthy peak-to-peak error: below, a curve counts as flat.
const FLAT: f64 = 1.005;
/// Tooth pairs shown: before, of the damaged tooth, after.
const PAIRS: [(i32, &str, Pattern); 3] =
    [(-1, "tooth i - 1", Pattern::Dashed), (0, "tooth i", Pattern::Solid), (1, "tooth i + 1", Pattern::DashDotted)];
const ORIGIN: &str = "Mesh cycles are counted so that the teeth touch at the pitch point at 1.75: the dissertation's origin is not said; tooth i there \
                      enters near 0.88 and leaves near 2.62, with its middle at 1.75.";

/// A place of pits.
struct Place {
    file: &'static str,
    /// Printed areas.
    areas: [&'static str; 4],
    /// Mesh cycles of the table.
    cycles: &'static [&'static str],
}

const PITCH: Place =
    Place { file: "unity-pits-pitch.toml", areas: ["2", "13", "33", "79"], cycles: &["1.4", "1.74", "2.08"] };
const APPROACH: Place =
    Place { file: "unity-pits-approach.toml", areas: ["1", "6", "16", "39"], cycles: &["1.36", "1.62"] };
const RECESS: Place =
    Place { file: "unity-pits-recess.toml", areas: ["1", "6", "16", "39"], cycles: &["1.88", "2.14"] };

/// Figure 2.2.
pub fn healthy_error(context: &Context) -> anyhow::Result<Drawn> {
    let healthy = context.statics(PITCH.file)?.healthy;
    let mut drawn = Drawn::default();
    let curve = line("", BLACK, Pattern::Solid, healthy.error());
    drawn.panels.push(Panel::chart("", "Static transmission error of the healthy pair.", (CYCLE, STE), vec![curve]));
    drawn.value("contact ratio", context.spur_pair(PITCH.file)?.pair.contact_ratio());
    drawn.note(ORIGIN);
    Ok(drawn)
}

/// Figure 2.3.
pub fn healthy_sharing(context: &Context) -> anyhow::Result<Drawn> {
    let healthy = context.statics(PITCH.file)?.healthy;
    let mut drawn = Drawn::default();
    let lines = |value: fn(&crate::reproduce::statics::Pair) -> f64| {
        PAIRS.map(|(pair, name, pattern)| line(name, BLACK, pattern, healthy.of_pair(pair, value))).to_vec()
    };
    let force = lines(|p| p.force * 1e-3);
    let first = |k: usize| force[k].points.first().map_or(f64::NAN, |p| p.0);
    drawn.value("tooth i enters", first(1));
    drawn.value("tooth i + 1 enters", first(2));
    drawn.value("tooth i - 1 leaves", force[0].points.last().map_or(f64::NAN, |p| p.0));
    drawn.panels.push(Panel::chart("a", "Force on three successive tooth pairs.", (CYCLE, FORCE), force));
    let about = "Stiffness of three successive tooth pairs, force over transmission error.";
    drawn.panels.push(Panel::chart("b", about, (CYCLE, STIFFNESS), lines(|p| p.stiffness)));
    drawn.note(ORIGIN);
    Ok(drawn)
}

fn errors(context: &Context, place: &Place, about: &str) -> anyhow::Result<Drawn> {
    let statics = context.statics(place.file)?;
    let case = context.spur_pair(place.file)?;
    let mut drawn = Drawn::default();
    let pits = case.severities.iter().zip(COLOURS);
    let drawing = scheme::flank(&case, Member::Pinion, pits.map(|(s, colour)| (s, colour, Pattern::Solid)));
    drawn.panels.push(Panel::drawing("a", about, drawing));
    let mut lines = vec![line("healthy", BLACK, Pattern::Solid, statics.healthy.error())];
    for ((series, area), colour) in statics.damaged.iter().zip(place.areas).zip(COLOURS) {
        lines.push(line(&format!("pit {area} %"), colour, Pattern::Solid, series.error()));
        drawn.value(format!("area {area}"), series.percent);
    }
    drawn.panels.push(Panel::chart("b", "Static transmission error.", (CYCLE, STE), lines));
    drawn.note(ORIGIN);
    drawn.note(
        "Legends carry the printed areas. Areas here are those of the ellipses over the active flank, arc length by facewidth; the printed \
         ones come from a surface some 1.4 times as large.",
    );
    Ok(drawn)
}

/// Figure 2.5.
pub fn pitch_errors(context: &Context) -> anyhow::Result<Drawn> {
    errors(context, &PITCH, "Pinion flank with four pits at the pitch point.")
}

/// Figure 2.7.
pub fn approach_errors(context: &Context) -> anyhow::Result<Drawn> {
    errors(context, &APPROACH, "Pinion flank with four pits in the approach.")
}

/// Figure 2.9.
pub fn recess_errors(context: &Context) -> anyhow::Result<Drawn> {
    errors(context, &RECESS, "Pinion flank with four pits in the recess.")
}

fn sharing(context: &Context, place: &Place) -> anyhow::Result<(Drawn, Statics)> {
    let statics = context.statics(place.file)?;
    let mut drawn = Drawn::default();
    let lines = |value: fn(&crate::reproduce::statics::Pair) -> f64| {
        let mut lines = Vec::new();
        let named = place.areas.map(|area| format!("pit {area} %"));
        let all = std::iter::once((&statics.healthy, "healthy", BLACK))
            .chain(statics.damaged.iter().zip(&named).zip(COLOURS).map(|((s, n), c)| (s, n.as_str(), c)));
        for (series, name, colour) in all {
            for (pair, _, pattern) in PAIRS {
                // one entry of the key for the three patterns
                let name = if pair == 0 { name } else { "" };
                lines.push(line(name, colour, pattern, series.of_pair(pair, value)));
            }
        }
        lines
    };
    let about = "Tooth contact force; solid the damaged tooth, dashed the one before, dash-dotted the one after.";
    drawn.panels.push(Panel::chart("a", about, (CYCLE, FORCE), lines(|p| p.force * 1e-3)));
    let about = "Tooth pair stiffness, in the same patterns.";
    drawn.panels.push(Panel::chart("b", about, (CYCLE, STIFFNESS), lines(|p| p.stiffness)));
    drawn.note(ORIGIN);
    Ok((drawn, statics))
}

fn own_force(series: &Series) -> Vec<(f64, f64)> {
    series.of_pair(0, |p| p.force * 1e-3)
}

/// Figure 2.6.
pub fn pitch_sharing(context: &Context) -> anyhow::Result<Drawn> {
    let (mut drawn, statics) = sharing(context, &PITCH)?;
    if let Some(worst) = statics.damaged.last() {
        let force = own_force(worst);
        drawn.value("largest force", top(&force).1);
        for cycle in [1.1, 2.4] {
            drawn.value(format!("79 %, force at {cycle}"), at(&force, cycle).unwrap_or(f64::NAN));
        }
    }
    Ok(drawn)
}

/// Figure 2.8.
pub fn approach_sharing(context: &Context) -> anyhow::Result<Drawn> {
    Ok(sharing(context, &APPROACH)?.0)
}

/// Figure 2.10.
pub fn recess_sharing(context: &Context) -> anyhow::Result<Drawn> {
    Ok(sharing(context, &RECESS)?.0)
}

/// Figure 2.11.
pub fn peak_to_peak(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let mut lines = Vec::new();
    let looks = [
        (PITCH.file, "pitch point", BLACK, Pattern::Solid),
        ("unity-pits-approach-growth.toml", "approach", BLUE, Pattern::Dashed),
        ("unity-pits-recess-growth.toml", "recess", RED, Pattern::Dotted),
    ];
    for (file, name, colour, pattern) in looks {
        let statics = context.statics(file)?;
        let all = std::iter::once(&statics.healthy).chain(&statics.damaged);
        let points: Vec<(f64, f64)> = all
            .map(|series| {
                let errors = series.points.iter().map(|p| p.error);
                let (low, high) = errors.fold((f64::INFINITY, 0.0_f64), |(l, h), e| (l.min(e), h.max(e)));
                (series.percent, high - low)
            })
            .collect();
        let Some((&healthy, damaged)) = points.split_first() else { continue };
        let flat = damaged.iter().take_while(|p| p.1 < FLAT * healthy.1).last();
        drawn.value(format!("{name}, flat up to"), flat.map_or(0.0, |p| p.0));
        let rising: Vec<f64> = damaged.iter().map(|p| p.1).skip_while(|value| *value < FLAT * healthy.1).collect();
        let (first, last) = (rising.first().unwrap_or(&healthy.1), rising.last().unwrap_or(&healthy.1));
        let found = format!("{:.2} µm healthy, {first:.2} to {last:.2} µm", healthy.1);
        drawn.claim(format!("{name}, rises"), rising.is_sorted_by(|a, b| a < b), found);
        lines.push(line(name, colour, pattern, points));
    }
    let labels = ("Pit area (% of the active flank)", "Peak-to-peak transmission error (µm)");
    let about = "Peak-to-peak static transmission error over the damaged area.";
    drawn.panels.push(Panel::chart("", about, labels, lines).zero_based());
    drawn.note(
        "The dissertation does not list the sizes between those of Figures 2.5 to 2.10: at the pitch point there are none here, in approach and recess two \
         between every two, interpolated. Flat means within 0.5 % of healthy.",
    );
    Ok(drawn)
}

fn table(context: &Context, place: &Place) -> anyhow::Result<Drawn> {
    let statics = context.statics(place.file)?;
    let healthy = statics.healthy.error();
    let mut drawn = Drawn::default();
    let mut head = vec!["pit".to_owned(), "printed area".to_owned()];
    head.extend(place.cycles.iter().map(|c| format!("increase at {c} (%)")));
    let mut rows = Vec::new();
    for (series, area) in statics.damaged.iter().zip(place.areas) {
        let error = series.error();
        let mut row = vec![series.label.clone(), format!("{area} %")];
        for cycle in place.cycles {
            let value = increase(&error, &healthy, cycle.parse()?).unwrap_or(f64::NAN);
            drawn.value(format!("{area} % at {cycle}"), value);
            row.push(format!("{value:.2}"));
        }
        rows.push(row);
    }
    drawn.tables.push(Table { head, rows });
    drawn.note(ORIGIN);
    Ok(drawn)
}

/// Table 2.1.
pub fn pitch_table(context: &Context) -> anyhow::Result<Drawn> {
    table(context, &PITCH)
}

/// Table 2.2.
pub fn approach_table(context: &Context) -> anyhow::Result<Drawn> {
    table(context, &APPROACH)
}

/// Table 2.3.
pub fn recess_table(context: &Context) -> anyhow::Result<Drawn> {
    table(context, &RECESS)
}
