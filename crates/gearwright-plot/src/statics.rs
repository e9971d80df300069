//! Figures of a static analysis.

use std::collections::BTreeSet;

use fecm::statics::{PairState, PositionResult};
use gear_geom::{GearPair, Member};

use gearwright_results::statics::damage::Effect;
use gearwright_results::statics::stress::Stresses;

use super::{COLOURS, Chart, FlankMap, Line, Pattern};

const CYCLE: &str = "Mesh cycle";

fn line(name: &str, index: usize, pattern: Pattern, points: Vec<(f64, f64)>) -> Line {
    Line { name: name.into(), points, pattern, colour: COLOURS[index % COLOURS.len()] }
}

fn over_cycle(
    series: &[PositionResult],
    origin: f64,
    value: impl Fn(&PositionResult) -> Option<f64>,
) -> Vec<(f64, f64)> {
    series.iter().filter_map(|r| value(r).map(|v| (r.mesh_cycle + origin, v))).collect()
}

/// Transmission error, loaded and unloaded.
#[must_use]
pub fn transmission_error(title: &str, series: &[PositionResult], origin: f64) -> Chart {
    let loaded = over_cycle(series, origin, |r| Some(r.static_transmission_error * 1e6));
    let unloaded = over_cycle(series, origin, |r| Some(r.no_load_transmission_error * 1e6));
    let mut lines = vec![line("static", 0, Pattern::Solid, loaded)];
    if unloaded.iter().any(|p| p.1.abs() > 1e-3) {
        lines.push(line("no load", 1, Pattern::Dashed, unloaded));
    }
    Chart {
        title: title.into(),
        x_label: CYCLE.into(),
        y_label: "Transmission error (µm)".into(),
        lines,
        from_zero: false,
        logarithmic: false,
    }
}

/// Mesh stiffness by average and local slope.
#[must_use]
pub fn mesh_stiffness(title: &str, series: &[PositionResult], origin: f64) -> Chart {
    let lines = vec![
        line("local slope", 0, Pattern::Solid, over_cycle(series, origin, |r| r.local_stiffness().map(|k| k * 1e-6))),
        line(
            "average slope",
            1,
            Pattern::Dashed,
            over_cycle(series, origin, |r| r.stiffness_average_slope.map(|k| k * 1e-6)),
        ),
    ];
    Chart {
        title: title.into(),
        x_label: CYCLE.into(),
        y_label: "Mesh stiffness (N/µm)".into(),
        lines,
        from_zero: false,
        logarithmic: false,
    }
}

/// A quantity over the mesh cycle, several series compared.
#[must_use]
pub fn compared(
    title: &str,
    y_label: &str,
    series: &[(&str, &[PositionResult])],
    origin: f64,
    value: impl Fn(&PositionResult) -> Option<f64>,
) -> Chart {
    let patterns = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];
    let lines = series.iter().enumerate().map(|(index, (name, results))| {
        let usable = |r: &PositionResult| value(r).filter(|_| r.status.is_usable());
        line(name, index, patterns[index % 4], over_cycle(results, origin, usable))
    });
    Chart {
        title: title.into(),
        x_label: CYCLE.into(),
        y_label: y_label.into(),
        lines: lines.collect(),
        from_zero: false,
        logarithmic: false,
    }
}

/// A quantity of every tooth pair.
#[must_use]
pub fn per_pair(
    title: &str,
    y_label: &str,
    series: &[PositionResult],
    origin: f64,
    value: impl Fn(&PairState) -> f64,
) -> Chart {
    let pairs: BTreeSet<i32> = series.iter().flat_map(|r| r.loaded_pairs().map(|p| p.pair)).collect();
    let patterns = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];
    let lines = pairs.iter().enumerate().map(|(index, &pair)| {
        let of_pair = |r: &PositionResult| r.pairs.iter().find(|p| p.pair == pair).map_or(0.0, &value);
        let points = over_cycle(series, origin, |r| Some(of_pair(r)));
        // keep one zero at either end of the engagement
        let loaded: Vec<bool> = points.iter().map(|p| p.1 > 0.0).collect();
        let near = |k: usize| loaded[k] || (k > 0 && loaded[k - 1]) || loaded.get(k + 1).is_some_and(|&l| l);
        let points = points.iter().enumerate().filter(|(k, _)| near(*k)).map(|(_, p)| *p).collect();
        line(&format!("pair {pair}"), index, patterns[index % patterns.len()], points)
    });
    Chart {
        title: title.into(),
        x_label: CYCLE.into(),
        y_label: y_label.into(),
        lines: lines.collect(),
        from_zero: true,
        logarithmic: false,
    }
}

/// Largest stress-intensity factor along the crack fronts over the mesh cycle, by severity.
#[must_use]
pub fn crack_opening(title: &str, series: &[(&str, &[PositionResult], &Stresses)], origin: f64) -> Chart {
    let patterns = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];
    let lines = series.iter().enumerate().map(|(index, (name, results, stresses))| {
        let usable = results.iter().enumerate().filter(|(_, r)| r.status.is_usable());
        let points = usable.filter_map(|(k, r)| stresses.k_one(k).map(|value| (r.mesh_cycle + origin, value)));
        line(name, index, patterns[index % 4], points.collect())
    });
    Chart {
        title: title.into(),
        x_label: CYCLE.into(),
        y_label: "Stress-intensity factor K_I (MPa √m)".into(),
        lines: lines.collect(),
        from_zero: true,
        logarithmic: false,
    }
}

/// A number of a severity, if it has it.
type OfEffect = fn(&Effect) -> Option<f64>;

/// Largest stress-intensity factors over the length of the longest crack; `None` unless there is a sweep of lengths.
#[must_use]
pub fn crack_growth(title: &str, effects: &[Effect]) -> Option<Chart> {
    let modes: [(&str, OfEffect); 2] =
        [("K_I", |effect| effect.k_one_max_mpa_sqrt_m), ("|K_II|", |effect| effect.k_two_max_mpa_sqrt_m)];
    let lines = modes.iter().enumerate().map(|(index, (name, value))| {
        let points = by_length(effects, value);
        line(name, index, [Pattern::Solid, Pattern::Dashed][index], points)
    });
    growth(title, "Largest stress-intensity factor (MPa √m)", lines.collect())
}

/// Largest tension at the roots of both gears over the length of the longest crack, from that of the healthy pair (MPa) on; `None` unless there is a sweep of
/// lengths and root stresses were asked for.
#[must_use]
pub fn root_tension_growth(title: &str, healthy: [Option<f64>; 2], effects: &[Effect]) -> Option<Chart> {
    let gears: [(&str, OfEffect); 2] =
        [("pinion", |effect| effect.pinion_root_tension_max_mpa), ("gear", |effect| effect.gear_root_tension_max_mpa)];
    let lines = gears.iter().zip(healthy).enumerate().map(|(index, ((name, value), healthy))| {
        let start = healthy.map(|stress| (0.0, stress)).into_iter();
        let points = start.chain(by_length(effects, value)).collect();
        line(name, index, [Pattern::Solid, Pattern::Dashed][index], points)
    });
    growth(title, "Largest tension at the roots (MPa)", lines.collect())
}

/// A quantity over the length of the longest crack (mm).
fn by_length(effects: &[Effect], value: &OfEffect) -> Vec<(f64, f64)> {
    effects.iter().filter_map(|effect| effect.crack_length_mm.zip(value(effect))).collect()
}

fn growth(title: &str, y_label: &str, lines: Vec<Line>) -> Option<Chart> {
    let is_sweep = |line: &Line| {
        let mut lengths = line.points.iter().map(|point| point.0).filter(|&length| length > 0.0);
        lengths.next().is_some_and(|first| lengths.any(|length| length != first))
    };
    lines.iter().any(is_sweep).then(|| Chart {
        title: title.into(),
        x_label: "Length of the crack (mm)".into(),
        y_label: y_label.into(),
        lines,
        from_zero: true,
        logarithmic: false,
    })
}

/// Tension at the roots of both teeth of the tooth pair that has the most positions.
#[must_use]
pub fn root_tension(title: &str, series: &[PositionResult], stresses: &Stresses, origin: f64) -> Chart {
    let pairs: BTreeSet<i32> = series.iter().flat_map(|r| r.loaded_pairs().map(|p| p.pair)).collect();
    let loaded = |pair: i32| series.iter().filter(|r| r.loaded_pairs().any(|p| p.pair == pair)).count();
    let shown = pairs.into_iter().max_by_key(|&pair| loaded(pair)).unwrap_or(0);
    let lines = ["pinion", "gear"].into_iter().enumerate().map(|(member, name)| {
        let points = series.iter().enumerate();
        let points = points.map(|(k, r)| (r.mesh_cycle + origin, stresses.tension(k, member, shown).unwrap_or(0.0)));
        let pattern = if member == 0 { Pattern::Solid } else { Pattern::Dashed };
        line(name, member, pattern, points.collect())
    });
    Chart {
        title: title.into(),
        x_label: CYCLE.into(),
        y_label: format!("Root stress of tooth pair {shown} (MPa)"),
        lines: lines.collect(),
        from_zero: true,
        logarithmic: false,
    }
}

/// Transmission error over the mesh cycle for a selection of torques.
#[must_use]
pub fn torque_curves(title: &str, map: &[Vec<PositionResult>], origin: f64) -> Chart {
    let lines = selection(map.len(), 6).into_iter().enumerate().filter_map(|(index, k)| {
        let torque = map[k].first()?.torque;
        let points = over_cycle(&map[k], origin, |r| Some(r.static_transmission_error * 1e6));
        Some(line(&format!("{torque:.4} N m"), index, Pattern::Solid, points))
    });
    Chart {
        title: title.into(),
        x_label: CYCLE.into(),
        y_label: "Transmission error (µm)".into(),
        lines: lines.collect(),
        from_zero: true,
        logarithmic: false,
    }
}

/// Mesh force over transmission error at a selection of positions.
#[must_use]
pub fn force_deflection(title: &str, map: &[Vec<PositionResult>], origin: f64) -> Chart {
    let positions = map.first().map_or(0, Vec::len);
    let patterns = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];
    let lines = selection(positions, 5).into_iter().enumerate().map(|(index, k)| {
        let of_torque =
            |r: &Vec<PositionResult>| r.get(k).map(|p| (p.static_transmission_error * 1e6, p.mesh_force * 1e-3));
        let at = map.first().and_then(|r| r.get(k)).map_or(0.0, |p| p.mesh_cycle + origin);
        line(&format!("mesh cycle {at:.2}"), index, patterns[index % 4], map.iter().filter_map(of_torque).collect())
    });
    Chart {
        title: title.into(),
        x_label: "Transmission error (µm)".into(),
        y_label: "Mesh force (kN)".into(),
        lines: lines.collect(),
        from_zero: true,
        logarithmic: false,
    }
}

/// At most `count` indices spread evenly over `0..total`, ends included.
fn selection(total: usize, count: usize) -> Vec<usize> {
    if total <= count {
        return (0..total).collect();
    }
    (0..count).map(|k| k * (total - 1) / (count - 1)).collect()
}

/// Largest pressure that each place of the pinion's flank sees over the positions (MPa), on the tooth pairs that `of_interest` picks, and the rim
/// of damage whose depth at a face position and roll distance (m) is `depth`.
#[must_use]
pub fn flank_pressure(
    title: &str,
    series: &[PositionResult],
    pair: &GearPair,
    mirrored: bool,
    of_interest: impl Fn(i32) -> bool,
    depth: impl Fn(f64, f64) -> f64,
) -> Option<FlankMap> {
    const ROWS: usize = 120;
    let landmarks = pair.landmarks(Member::Pinion);
    let (low, high) = (landmarks.sap.roll_distance, landmarks.eap.roll_distance);
    let margin = 0.03 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let patch = series.iter().flat_map(|r| &r.patches).next()?;
    let half = patch.face.len();
    let columns = if mirrored { 2 * half } else { half };
    let span = patch.cell[1] * columns as f64;
    let mut values = vec![vec![0.0_f64; columns]; ROWS];
    for patch in series.iter().flat_map(|r| &r.patches).filter(|patch| of_interest(patch.pair)) {
        for (roll, pressures) in patch.pinion_roll.iter().zip(&patch.pressure) {
            // the cell's extent in roll distance
            let reach = 0.5 * patch.cell[0] * pair.pinion().base_radius() / roll.max(1e-9);
            let row_of =
                |s: f64| ((s - low) / (high - low) * ROWS as f64).floor().clamp(0.0, ROWS as f64 - 1.0) as usize;
            for row in row_of(roll - reach)..=row_of(roll + reach) {
                for (j, pressure) in pressures.iter().enumerate() {
                    let value = pressure * 1e-6;
                    let mut put = |column: usize| values[row][column] = values[row][column].max(value);
                    if mirrored {
                        put(half + j);
                        put(half - 1 - j);
                    } else {
                        put(j);
                    }
                }
            }
        }
    }
    let named = [
        ("SAP", Some(landmarks.sap)),
        ("LPSTC", landmarks.lpstc),
        ("pitch", Some(landmarks.pitch)),
        ("HPSTC", landmarks.hpstc),
        ("EAP", Some(landmarks.eap)),
    ];
    Some(FlankMap {
        title: title.into(),
        quantity: "MPa".into(),
        face: (-0.5e3 * span, 0.5e3 * span),
        roll: (low * 1e3, high * 1e3),
        values,
        landmarks: named.into_iter().filter_map(|(n, l)| l.map(|l| (n.to_owned(), l.roll_distance * 1e3))).collect(),
        rim: rim([0.5 * span, 0.5 * (high - low)], 0.5 * (low + high), depth),
    })
}

/// Where damage begins, in steps of a fine grid (mm); `half` the extents along face and profile (m).
fn rim(half: [f64; 2], middle_roll: f64, depth: impl Fn(f64, f64) -> f64) -> Vec<(f64, f64)> {
    const STEPS: usize = 240;
    let along = |k: usize, half: f64| half * (2.0 * (k as f64 + 0.5) / STEPS as f64 - 1.0);
    let place = |i: usize, j: usize| (along(j, half[0]), middle_roll + along(i, half[1]));
    let damaged = |i: usize, j: usize| {
        let (face, roll) = place(i, j);
        depth(face, roll) > 0.0
    };
    let inside: Vec<Vec<bool>> = (0..STEPS).map(|i| (0..STEPS).map(|j| damaged(i, j)).collect()).collect();
    let mut points = Vec::new();
    for i in 1..STEPS {
        for j in 1..STEPS {
            if inside[i][j] != inside[i][j - 1] || inside[i][j] != inside[i - 1][j] {
                let (face, roll) = place(i, j);
                points.push((1e3 * face, 1e3 * roll));
            }
        }
    }
    points
}
