//! Chapter 3, statics: force-deflection behaviour, pits and cracks of the nonunity pair, and what both do to the transmission error.

use gear_geom::Member;
use gearwright_case::SpurPairCase;
use gearwright_plot::{Line, Pattern};

use super::scheme;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Panel, Table, colour::*, line};
use crate::reproduce::statics::{Series, Statics, affected, at, bottom, increase, top};

const CYCLE: &str = "Mesh cycle";
const STE: &str = "Static transmission error (µm)";
const LOCAL: &str = "Mesh stiffness, local slope (N/µm)";
const AVERAGE: &str = "Mesh stiffness, average slope (N/µm)";
/// Colours of up to ten severities.
const MANY: [&str; 10] = [BLUE, RED, CYAN, GREEN, MAGENTA, PURPLE, ORANGE, BROWN, OLIVE, GREY];
/// Looks of cracks of 20, 50 and 80 %.
pub const CRACKS: [(&str, Pattern); 3] =
    [(BLUE, Pattern::Dashed), (RED, Pattern::Dotted), (GREEN, Pattern::DashDotted)];
const ORIGIN: &str = "Mesh cycles are counted so that the damaged teeth touch at the pitch point at 0.75: double contact then begins near 0, as in \
                      the dissertation's figures.";

fn nan(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

/// Figure 3.2.
pub fn force_deflection(context: &Context) -> anyhow::Result<Drawn> {
    let cracked = context.statics("nonunity-modified-cracked.toml")?;
    let pitted = context.statics("nonunity-modified-pitted.toml")?;
    let healthy = &cracked.healthy;
    let (Some(crack), Some(pit)) = (cracked.damaged.first(), pitted.damaged.first()) else {
        anyhow::bail!("a case file has no damage");
    };
    let states = [
        (healthy, "healthy", BLACK, Pattern::Solid),
        (crack, "root crack", BLUE, Pattern::Dashed),
        (pit, "pit", RED, Pattern::DashDotted),
    ];
    let mut drawn = Drawn::default();
    for ((series, name, ..), letter) in states.iter().zip(["a", "b", "c"]) {
        let about = format!("Transmission error over the mesh cycle by load, {name}.");
        drawn
            .panels
            .push(Panel::chart(letter, &about, (CYCLE, "Transmission error (µm)"), by_load(series)).zero_based());
    }
    const AT: f64 = 0.72;
    let curves = states.iter().map(|(series, name, colour, pattern)| {
        let point = |load: &Vec<crate::reproduce::statics::Point>| {
            let curve = |value: fn(&crate::reproduce::statics::Point) -> f64| -> Vec<(f64, f64)> {
                load.iter().map(|p| (p.cycle, value(p))).collect()
            };
            Some((at(&curve(|p| p.error), AT)?, at(&curve(|p| p.force * 1e-3), AT)?))
        };
        line(name, colour, *pattern, series.map.iter().filter_map(point).collect())
    });
    let about = format!("Mesh force over transmission error at {AT} mesh cycle.");
    drawn
        .panels
        .push(Panel::chart("d", &about, ("Transmission error (µm)", "Mesh force (kN)"), curves.collect()).zero_based());
    let compare = |value: fn(&Series) -> Vec<(f64, f64)>| -> Vec<Line> {
        states.iter().map(|(series, name, colour, pattern)| line(name, colour, *pattern, value(series))).collect()
    };
    drawn.panels.push(Panel::chart("e", "Average-slope stiffness.", (CYCLE, AVERAGE), compare(Series::average)));
    drawn.panels.push(Panel::chart("f", "Local-slope stiffness.", (CYCLE, LOCAL), compare(Series::local)));
    let (error, average) = (healthy.error(), healthy.average());
    drawn.value("crack, error at 0.4", nan(increase(&crack.error(), &error, 0.4)));
    drawn.value("crack, error at 0.78", nan(increase(&crack.error(), &error, 0.78)));
    let grown =
        pit.error().iter().filter_map(|p| increase(&pit.error(), &error, p.0).map(|i| (p.0, i))).collect::<Vec<_>>();
    drawn.value("pit, largest increase of error", top(&grown).1);
    drawn.value("pit, cycle of the largest increase", top(&grown).0);
    drawn.value("healthy, average stiffness at unity", nan(at(&average, 1.0)));
    drawn.value("crack, average stiffness at unity", nan(at(&crack.average(), 1.0)));
    drawn.value("healthy, average stiffness at 0.72", nan(at(&average, AT)));
    drawn.value("pit, average stiffness at 0.72", nan(at(&pit.average(), AT)));
    let double: Vec<f64> =
        healthy.points.iter().filter(|p| p.pairs.len() > 1 && p.cycle < 1.0).map(|p| p.cycle).collect();
    let run_end = double.iter().copied().filter(|c| *c < 0.9).fold(f64::NAN, f64::max);
    drawn.value("double contact ends", run_end);
    drawn.value("actual contact ratio", 1.0 + healthy.double_contact());
    drawn.value("theoretical contact ratio", context.spur_pair("nonunity-pair.toml")?.pair.contact_ratio());
    drawn.note(ORIGIN);
    drawn
        .note("The crack runs along the chord below the tooth, the pit's height is an arc length; neither is printed.");
    Ok(drawn)
}

/// Transmission error at up to eight loads.
fn by_load(series: &Series) -> Vec<Line> {
    let count = series.map.len();
    let shown = count.min(8);
    let picked = (0..shown).map(|k| if shown > 1 { k * (count - 1) / (shown - 1) } else { 0 });
    let lines = picked.zip([GREY, BLUE, CYAN, GREEN, OLIVE, ORANGE, RED, BLACK]).map(|(k, colour)| {
        let points = series.map[k].iter().map(|p| (p.cycle, p.error)).collect();
        let load = series.map[k].first().map_or(0.0, |p| p.force);
        line(&format!("{:.2} kN", load * 1e-3), colour, Pattern::Solid, points)
    });
    lines.collect()
}

/// Figure 3.3.
pub fn unity_stiffness(context: &Context) -> anyhow::Result<Drawn> {
    let healthy = context.statics("unity-pits-pitch.toml")?.healthy;
    let mut drawn = Drawn::default();
    let curve = vec![line("computed here", BLACK, Pattern::Solid, healthy.average())];
    drawn.panels.push(Panel::chart("", "Average-slope stiffness of the unity pair, healthy.", (CYCLE, AVERAGE), curve));
    let over_one = healthy.points.iter().filter(|p| p.cycle >= 1.0 && p.cycle < 2.0 - 1e-9);
    let (double, all) = over_one.fold((0.0, 0.0), |(d, n), p| (d + if p.pairs.len() > 1 { 1.0 } else { 0.0 }, n + 1.0));
    drawn.value("double contact", 100.0 * double / all);
    drawn.note("The dashed curve of Huangfu et al. is not in the text.");
    drawn.note(
        "More than 80 % of double contact cannot be at this load: the tips of the next pair are some 50 µm apart a tenth of a cycle from \
         the pitch point, and the deflection is 12 µm. Section 2.2's own entries and exits (0.88 to 1.62) give 74 %.",
    );
    Ok(drawn)
}

/// Figure 3.4.
pub fn irregular_pit(context: &Context) -> anyhow::Result<Drawn> {
    let file = "unity-pit-irregular.toml";
    let (statics, case) = (context.statics(file)?, context.spur_pair(file)?);
    let mut drawn = Drawn::default();
    let pits = case.severities.iter().map(|s| (s, RED, Pattern::Dashed));
    let mut drawing = scheme::flank(&case, Member::Pinion, pits);
    // one severity of five ellipses: its label repeats them
    drawing.strokes.iter_mut().filter(|s| !s.name.is_empty()).for_each(|s| s.name = "five ellipses".into());
    drawn.panels.push(Panel::drawing("a", "Flank with an irregular pit of five ellipses in the recess.", drawing));
    let mut lines = vec![line("healthy", BLACK, Pattern::Solid, statics.healthy.average())];
    lines.extend(statics.damaged.iter().map(|s| line("pit", RED, Pattern::Solid, s.average())));
    drawn.panels.push(Panel::chart("b", "Average-slope stiffness.", (CYCLE, AVERAGE), lines));
    if let Some((from, to)) = statics.damaged.first().and_then(|s| affected(&s.error(), &statics.healthy.error())) {
        drawn.claim("felt in the recess only", from > 0.9 && to < 1.4, format!("{from:.2} to {to:.2}"));
    }
    drawn.note("The pit's outline is printed in a drawing only: the shape here is an illustration, so no number can be compared.");
    Ok(drawn)
}

/// Transmission error and stiffness of all severities, whole and zoomed.
fn severities(drawn: &mut Drawn, statics: &Statics, zoom: (f64, f64), names: &[String]) {
    let lines = |value: fn(&Series) -> Vec<(f64, f64)>| {
        let mut lines = vec![line("healthy", BLACK, Pattern::Solid, value(&statics.healthy))];
        for ((series, name), colour) in statics.damaged.iter().zip(names).zip(MANY) {
            lines.push(line(name, colour, Pattern::Solid, value(series)));
        }
        lines
    };
    let near = |lines: Vec<Line>| -> Vec<Line> {
        let inside = |p: &(f64, f64)| (zoom.0..=zoom.1).contains(&p.0);
        lines.into_iter().map(|l| Line { points: l.points.iter().copied().filter(inside).collect(), ..l }).collect()
    };
    let panels = [
        ("a", "Static transmission error.", STE, lines(Series::error)),
        ("b", "The same, zoomed.", STE, near(lines(Series::error))),
        ("c", "Mesh stiffness.", LOCAL, lines(Series::local)),
        ("d", "The same, zoomed.", LOCAL, near(lines(Series::local))),
    ];
    drawn.panels.extend(panels.map(|(letter, about, label, lines)| Panel::chart(letter, about, (CYCLE, label), lines)));
    drawn.note(ORIGIN);
}

fn region(context: &Context, file: &str, zoom: (f64, f64)) -> anyhow::Result<(Drawn, Statics)> {
    let statics = context.statics(file)?;
    let names: Vec<String> = (1..=statics.damaged.len()).map(|k| format!("{} %", 10 * k)).collect();
    let mut drawn = Drawn::default();
    severities(&mut drawn, &statics, zoom, &names);
    Ok((drawn, statics))
}

/// Figure 3.6.
pub fn single_contact_pits(context: &Context) -> anyhow::Result<Drawn> {
    let (mut drawn, statics) = region(context, "pitted-single-contact.toml", (0.55, 1.1))?;
    if let Some(pit) = statics.damaged.get(6) {
        let grown = top(&pit.error()).1 / top(&statics.healthy.error()).1 - 1.0;
        let sunk = 1.0 - bottom(&pit.local()).1 / bottom(&statics.healthy.local()).1;
        drawn.value("70 %, increase of the largest error", 100.0 * grown);
        drawn.value("70 %, decrease of the least stiffness", 100.0 * sunk);
    }
    let largest = top(&statics.healthy.error()).1;
    saturation(&mut drawn, &statics, 7, |series| Some(100.0 * (top(&series.error()).1 / largest - 1.0)));
    Ok(drawn)
}

/// Whether an effect (%) grows up to a severity (counted from 1) and hardly after.
fn saturation(drawn: &mut Drawn, statics: &Statics, up_to: usize, effect: impl Fn(&Series) -> Option<f64>) {
    let all: Vec<f64> = statics.damaged.iter().filter_map(effect).collect();
    let (Some(&there), Some(&whole)) = (all.get(up_to - 1), all.last()) else { return };
    let grows = all[..up_to].is_sorted_by(|a, b| a < b);
    let found = all.iter().map(|e| format!("{e:.2}")).collect::<Vec<_>>().join(", ");
    drawn.claim("saturates", grows && (whole - there).abs() < 0.15 * there, format!("{found} %"));
}

/// Place of the largest relative increase of the transmission error, and where it begins and ends.
fn where_felt(drawn: &mut Drawn, statics: &Statics) {
    let healthy = statics.healthy.error();
    let Some(worst) = statics.damaged.last() else { return };
    if let Some((from, to)) = affected(&worst.error(), &healthy) {
        drawn.value("felt from", from);
        drawn.value("felt to", to);
    }
    // at the size whose extremum the dissertation takes for the last that grows
    if let Some(pit) = statics.damaged.get(5) {
        let error = pit.error();
        let grown: Vec<(f64, f64)> = error.iter().filter_map(|p| Some((p.0, p.1 - at(&healthy, p.0)?))).collect();
        let extremum = top(&grown).0;
        drawn.value("cycle of the extremum", extremum);
        saturation(drawn, statics, 6, |series| increase(&series.error(), &healthy, extremum));
    }
}

/// Figure 3.7.
pub fn approach_pits(context: &Context) -> anyhow::Result<Drawn> {
    let (mut drawn, statics) = region(context, "pitted-approach.toml", (0.05, 0.65))?;
    where_felt(&mut drawn, &statics);
    Ok(drawn)
}

/// Figure 3.8.
pub fn recess_pits(context: &Context) -> anyhow::Result<Drawn> {
    let (mut drawn, statics) = region(context, "pitted-recess.toml", (1.05, 1.65))?;
    where_felt(&mut drawn, &statics);
    Ok(drawn)
}

fn sized_pits(
    context: &Context,
    file: &str,
    about: &str,
    colours: &[&'static str],
) -> anyhow::Result<(Drawn, Statics)> {
    let (statics, case) = (context.statics(file)?, context.spur_pair(file)?);
    let mut drawn = Drawn::default();
    let pits = case.severities.iter().zip(colours).map(|(s, colour)| (s, *colour, Pattern::Solid));
    drawn.panels.push(Panel::drawing("a", about, scheme::flank(&case, Member::Pinion, pits)));
    for (letter, about, label, value) in [
        ("b", "Static transmission error.", STE, Series::error as fn(&Series) -> Vec<(f64, f64)>),
        ("c", "Mesh stiffness.", LOCAL, Series::local),
    ] {
        let mut lines = vec![line("healthy", BLACK, Pattern::Solid, value(&statics.healthy))];
        let damaged = statics.damaged.iter().zip(colours);
        lines.extend(damaged.map(|(series, colour)| line(&series.label, colour, Pattern::Solid, value(series))));
        drawn.panels.push(Panel::chart(letter, about, (CYCLE, label), lines));
    }
    drawn.note(ORIGIN);
    Ok((drawn, statics))
}

/// Colours of the six pits of Figure 3.9.
pub const PITS: [&str; 6] = [RED, "#d4b106", BLUE, GREEN, ORANGE, PURPLE];

/// Figure 3.9.
pub fn pitch_pits(context: &Context) -> anyhow::Result<Drawn> {
    let about = "Pinion flank with six pits at the pitch line and mid-face.";
    let (mut drawn, statics) = sized_pits(context, "pitted-pitch.toml", about, &PITS)?;
    drawn.value("healthy, largest error", top(&statics.healthy.error()).1);
    if let Some(small) = statics.damaged.first() {
        drawn.value("6.35 mm, largest error", top(&small.error()).1);
    }
    let largest: Vec<(f64, f64)> = statics.damaged.iter().map(|series| top(&series.error())).collect();
    let listed = |values: Vec<f64>| values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(", ");
    let found = format!("{} µm", listed(largest.iter().map(|p| p.1).collect()));
    drawn.claim("largest error rises with size", largest.is_sorted_by(|a, b| a.1 < b.1), found);
    let lpstc = lowest_single_contact(&context.spur_pair("pitted-pitch.toml")?);
    let above = largest.iter().all(|p| (lpstc - 0.02..lpstc + 0.2).contains(&p.0));
    let found = format!("{}; LPSTC at {lpstc:.2}", listed(largest.iter().map(|p| p.0).collect()));
    drawn.claim("largest error just above the LPSTC", above, found);
    Ok(drawn)
}

/// Figure 3.10.
pub fn edge_pits(context: &Context) -> anyhow::Result<Drawn> {
    let about = "Pinion flank with seven pits at the pitch line on one edge; half of each ellipse lies on the tooth.";
    let colours = [RED, "#d4b106", BLUE, GREEN, ORANGE, PURPLE, BROWN];
    let (mut drawn, statics) = sized_pits(context, "pitted-edge.toml", about, &colours)?;
    let lpstc = lowest_single_contact(&context.spur_pair("pitted-edge.toml")?);
    let healthy = statics.healthy.error();
    let (mut near, mut found) = (true, Vec::new());
    for series in &statics.damaged {
        let error = series.error();
        let grown: Vec<(f64, f64)> =
            error.iter().filter_map(|p| Some((p.0, increase(&error, &healthy, p.0)?))).collect();
        let (place, most) = top(&grown);
        let recess = nan(at(&grown, 1.25));
        near &= (place - lpstc).abs() < 0.2 && recess < 0.3 * most;
        found.push(format!("{most:.1} % at {place:.2}, {recess:.1} % at 1.25"));
    }
    drawn.claim("largest difference near the LPSTC, small in the recess", near, found.join("; "));
    Ok(drawn)
}

/// Mesh cycle at which contact is at the pinion's lowest point of single contact.
fn lowest_single_contact(case: &SpurPairCase) -> f64 {
    let landmarks = case.pair.landmarks(Member::Pinion);
    let roll = landmarks.lpstc.map_or(landmarks.sap.roll_distance, |l| l.roll_distance);
    case.inputs.analysis.mesh_cycle_origin + (roll - landmarks.pitch.roll_distance) / case.pair.base_pitch()
}

/// Figure 3.11.
pub fn unity_cracks(context: &Context) -> anyhow::Result<Drawn> {
    let file = "unity-cracked.toml";
    let (statics, case) = (context.statics(file)?, context.spur_pair(file)?);
    let mut drawn = Drawn::default();
    let names = ["crack 20 % (for a-b)", "crack 50 % (for a-b-c)", "crack 80 % (for a-b-c-d)"];
    let colours = [RED, GREEN, PURPLE];
    let mut lines = vec![line("healthy", BLACK, Pattern::Solid, statics.healthy.average())];
    let damaged = statics.damaged.iter().zip(names).zip(colours);
    lines.extend(damaged.map(|((s, name), colour)| line(name, colour, Pattern::Solid, s.average())));
    drawn.panels.push(Panel::chart("a", "Average-slope stiffness at 100 N m.", (CYCLE, AVERAGE), lines));
    let lengths = [0.2, 0.5, 0.8].into_iter().zip(colours).map(|(l, c)| (l, c, Pattern::Solid)).collect::<Vec<_>>();
    let side = case.pair.working_side(Member::Pinion);
    let inset = scheme::cracks(case.pair.pinion(), side, &lengths)?;
    drawn.panels.push(Panel::drawing("b", "The cracks in the mesh of the tooth.", inset));
    let width = |series: &Series, pair: i32| nan(at(&series.of_pair(pair, |p| p.width), 1.2));
    drawn.value("healthy, contact width at 1.2", width(&statics.healthy, 0));
    for (series, name) in statics.damaged.iter().zip(["a-b", "a-b-c", "a-b-c-d"]) {
        drawn.value(format!("crack {name}, contact width at 1.2"), width(series, 0));
    }
    let states = || std::iter::once(&statics.healthy).chain(&statics.damaged);
    let [own, next] = [0, 1].map(|pair| states().map(|series| width(series, pair)).collect::<Vec<f64>>());
    let shifts = own.is_sorted_by(|a, b| a > b) && next.is_sorted_by(|a, b| a < b);
    let listed = |values: &[f64]| values.iter().map(|v| format!("{v:.3}")).collect::<Vec<_>>().join(", ");
    drawn.claim(
        "contact narrows on the cracked tooth",
        shifts,
        format!("{} mm; next {} mm", listed(&own), listed(&next)),
    );
    drawn.note("The curves of Chen et al. are not in the text, nor are the lengths of the cracks: 20, 50 and 80 % are chosen here.");
    Ok(drawn)
}

/// Figure 3.12.
pub fn nonunity_cracks(context: &Context) -> anyhow::Result<Drawn> {
    let pinion = context.statics("cracked-pinion.toml")?;
    let gear = context.statics("cracked-gear.toml")?;
    let mut drawn = Drawn::default();
    let panels = [
        ("a", "Crack on the pinion: static transmission error.", &pinion, STE, true),
        ("b", "Crack on the pinion: mesh stiffness.", &pinion, LOCAL, false),
        ("c", "Crack on the gear: static transmission error.", &gear, STE, true),
        ("d", "Crack on the gear: mesh stiffness.", &gear, LOCAL, false),
    ];
    for (letter, about, statics, label, is_error) in panels {
        let value = if is_error { Series::error } else { Series::local };
        let mut lines = vec![line("healthy", BLACK, Pattern::Solid, value(&statics.healthy))];
        let damaged = statics.damaged.iter().zip(CRACKS);
        lines.extend(damaged.map(|(s, (colour, pattern))| line(&s.label, colour, pattern, value(s))));
        drawn.panels.push(Panel::chart(letter, about, (CYCLE, label), lines));
    }
    let case = context.spur_pair("cracked-pinion.toml")?;
    let insets =
        [(Member::Pinion, "e", "Cracks in the mesh of the pinion's tooth."), (Member::Wheel, "f", "Of the gear's.")];
    for (member, letter, about) in insets {
        let lengths: Vec<_> =
            [0.2, 0.5, 0.8].into_iter().zip(CRACKS).map(|(l, (c, _))| (l, c, Pattern::Solid)).collect();
        let drawing = scheme::cracks(case.pair.gear(member), case.pair.working_side(member), &lengths)?;
        drawn.panels.push(Panel::drawing(letter, about, drawing));
    }
    if let Some(worst) = pinion.damaged.last() {
        if let Some((from, to)) = affected(&worst.error(), &pinion.healthy.error()) {
            drawn.value("crack on the pinion, felt from", from);
            drawn.value("crack on the pinion, felt to", to);
        }
        drawn.value("crack on the pinion, cycle of the largest error", top(&worst.error()).0);
    }
    if let Some(worst) = gear.damaged.last() {
        drawn.value("crack on the gear, cycle of the largest error", top(&worst.error()).0);
    }
    let places = pinion.damaged.iter().map(|series| top(&series.error()).0).collect::<Vec<_>>();
    let found = places.iter().map(|place| format!("{place:.2}")).collect::<Vec<_>>().join(", ");
    drawn.claim("pinion: largest error just below 1", places.iter().all(|p| (0.8..1.0).contains(p)), found);
    let both = pinion
        .damaged
        .iter()
        .zip(&gear.damaged)
        .map(|(p, g)| (top(&p.error()).1, top(&g.error()).1))
        .collect::<Vec<_>>();
    let found = both.iter().map(|(p, g)| format!("{p:.2} and {g:.2} µm")).collect::<Vec<_>>().join("; ");
    drawn.claim("gear: larger error than pinion", both.iter().all(|(p, g)| g > p), found);
    drawn.note(ORIGIN);
    Ok(drawn)
}

/// Figure 3.13.
pub fn severity(context: &Context) -> anyhow::Result<Drawn> {
    let pits = context.statics("pitted-pitch.toml")?;
    let cracks = context.statics("cracked-pinion-growth.toml")?;
    let mut drawn = Drawn::default();
    let largest = |statics: &Statics| -> Vec<(f64, f64)> {
        let all = std::iter::once(&statics.healthy).chain(&statics.damaged);
        all.map(|s| (s.percent, top(&s.error()).1)).collect()
    };
    let spans = |statics: &Statics| -> Vec<(f64, f64)> {
        let healthy = statics.healthy.error();
        let span = |s: &Series| affected(&s.error(), &healthy).map(|(from, to)| (s.percent, to - from));
        statics.damaged.iter().filter_map(span).collect()
    };
    let panels = [
        (
            "a",
            "Largest static transmission error.",
            "Largest transmission error (µm)",
            largest(&pits),
            largest(&cracks),
        ),
        (
            "b",
            "Span of the mesh cycle where the error grew by more than 1 %.",
            "Mesh cycles affected",
            spans(&pits),
            spans(&cracks),
        ),
    ];
    for (letter, about, label, of_pits, of_cracks) in panels {
        let lines = vec![
            line("", BLUE, Pattern::Solid, of_pits.clone()),
            line("pits", BLUE, Pattern::Circles, of_pits),
            line("", RED, Pattern::Solid, of_cracks.clone()),
            line("root cracks", RED, Pattern::Squares, of_cracks),
        ];
        drawn.panels.push(Panel::chart(letter, about, ("Damage (%)", label), lines).zero_based());
    }
    let mut table = Table {
        head: ["damage", "percent", "largest error (µm)", "mesh cycles affected"].map(String::from).to_vec(),
        rows: Vec::new(),
    };
    for statics in [&pits, &cracks] {
        let healthy = statics.healthy.error();
        for series in &statics.damaged {
            let span = affected(&series.error(), &healthy).map_or("-".into(), |(a, b)| format!("{:.2}", b - a));
            let largest = format!("{:.3}", top(&series.error()).1);
            table.rows.push(vec![series.label.clone(), format!("{:.2}", series.percent), largest, span]);
        }
    }
    drawn.tables.push(table);
    if let (Some(middle), Some(large)) = (pits.damaged.get(2), pits.damaged.last()) {
        drawn.value("pit of 16.51 mm, area", middle.percent);
        drawn.value("pit of 16.51 mm, largest error", top(&middle.error()).1);
        drawn.value("largest pit, area", large.percent);
        drawn.value("largest pit, largest error", top(&large.error()).1);
        if let Some((from, to)) = affected(&large.error(), &pits.healthy.error()) {
            drawn.value("largest pit, mesh cycles affected", to - from);
        }
    }
    if let (Some(short), Some(long)) = (cracks.damaged.get(3), cracks.damaged.last()) {
        drawn.value("crack of 24.29 %, largest error", top(&short.error()).1);
        drawn.value("crack of 81 %, largest error", top(&long.error()).1);
        if let Some((from, to)) = affected(&long.error(), &cracks.healthy.error()) {
            drawn.value("crack of 81 %, mesh cycles affected", to - from);
        }
        if let Some((from, to)) = affected(&short.error(), &cracks.healthy.error()) {
            drawn.value("crack of 24.29 %, mesh cycles affected", to - from);
        }
    }
    drawn.note("Pit areas are parts of the pinion's active flank over its own facewidth, arc length by facewidth.");
    Ok(drawn)
}

/// Tables 3.1, 4.1 and 7.1.
pub fn geometry(context: &Context) -> anyhow::Result<Drawn> {
    let case = context.spur_pair("nonunity-pair.toml")?;
    let mut drawn = Drawn::default();
    let row = |name: &str, value: &dyn Fn(Member) -> f64| {
        vec![name.to_owned(), format!("{:.3}", value(Member::Wheel)), format!("{:.3}", value(Member::Pinion))]
    };
    let mm = 1e3;
    let gear = |member: Member| case.pair.gear(member);
    let rows = vec![
        row("teeth", &|m| f64::from(gear(m).teeth())),
        row("module (mm)", &|m| gear(m).module() * mm),
        row("outer diameter (mm)", &|m| 2.0 * gear(m).tip_radius() * mm),
        row("root diameter (mm)", &|m| 2.0 * gear(m).root_radius() * mm),
        row("tooth thickness at the reference circle (mm)", &|m| gear(m).spec().reference_thickness() * mm),
        row("facewidth (mm)", &|m| gear(m).facewidth() * mm),
        row("bore diameter, chosen (mm)", &|m| 2.0 * gear(m).rim_radius() * mm),
        row("centre distance (mm)", &|_| case.pair.centre_distance() * mm),
        row("working pressure angle (deg)", &|_| case.pair.working_pressure_angle().to_degrees()),
        row("follows: base radius (mm)", &|m| gear(m).base_radius() * mm),
        row("follows: working pitch radius (mm)", &|m| case.pair.working_pitch_radius(m) * mm),
        row("follows: contact ratio", &|_| case.pair.contact_ratio()),
        row("follows: base pitch (mm)", &|_| case.pair.base_pitch() * mm),
        row("follows: backlash (mm)", &|_| case.pair.backlash() * mm),
    ];
    drawn.tables.push(Table { head: ["", "gear", "pinion"].map(String::from).to_vec(), rows });
    drawn.note("Input of the computation. The printed module of 2.87 mm is rounded: the centre distance and 62 teeth give 2.867742 mm.");
    Ok(drawn)
}

/// Tables 3.2 and 7.2.
pub fn lumped_parameters(context: &Context) -> anyhow::Result<Drawn> {
    let case = context.spur_pair("nonunity-pair.toml")?;
    let pair = lpm::GearPair::table_3_2(lpm::Input::Prescribed);
    let free = lpm::GearPair::table_3_2(lpm::Input::Free);
    let (pinion, gear) = (case.pair.pinion(), case.pair.wheel());
    let torque = case.inputs.load.torque_n_m;
    let mut drawn = Drawn::default();
    let values = [
        ("base radius, gear", "mm", gear.base_radius() * 1e3),
        ("base radius, pinion", "mm", pinion.base_radius() * 1e3),
        ("torque, pinion", "N m", torque * pinion.base_radius() / gear.base_radius()),
    ];
    let mut rows = Vec::new();
    for (name, unit, value) in values {
        drawn.value(name, value);
        rows.push(vec![name.into(), format!("{value:.3}"), unit.into()]);
    }
    rows.push(vec!["moving mass, input prescribed".into(), format!("{:.4}", pair.effective_mass()), "kg".into()]);
    rows.push(vec!["moving mass, both gears free (3.3d)".into(), format!("{:.4}", free.effective_mass()), "kg".into()]);
    rows.push(vec!["mean mesh force".into(), format!("{:.1}", pair.mean_force()), "N".into()]);
    drawn.tables.push(Table { head: ["quantity", "computed", "unit"].map(String::from).to_vec(), rows });
    drawn.note(
        "Masses, inertias, supports and damping are input. The natural frequencies printed beside the results follow with a prescribed \
         input rotation, not with the moving mass of (3.3d): see docs/lumped-dynamics.md.",
    );
    Ok(drawn)
}
