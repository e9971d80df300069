//! Figures of lumped-parameter dynamics.

use lpm::{Measure, Stability};

use super::{COLOURS, Chart, Line, Pattern};
use gearwright_results::lumped::{
    BranchResult, DamageResult, DamageSpeeds, ImpulseResult, State, SweepResult, TimeResponse,
};

const CYCLE: &str = "Mesh cycle";
/// Spectra are drawn up to this multiple of the mesh frequency.
const ORDERS: f64 = 6.0;
/// A difference is shown where it exceeds this part of its largest value.
const SEEN: f64 = 0.02;
/// Points per mesh cycle of the excitation's figures.
const CURVE_POINTS: usize = 200;
const PATTERNS: [Pattern; 4] = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];

fn line(name: &str, index: usize, pattern: Pattern, points: Vec<(f64, f64)>) -> Line {
    Line { name: name.into(), points, pattern, colour: COLOURS[index % COLOURS.len()] }
}

fn pattern(index: usize) -> Pattern {
    PATTERNS[index % PATTERNS.len()]
}

fn chart(title: &str, x_label: &str, y_label: &str, lines: Vec<Line>) -> Chart {
    Chart {
        title: title.into(),
        x_label: x_label.into(),
        y_label: y_label.into(),
        lines,
        from_zero: false,
        logarithmic: false,
    }
}

/// A curve of every state: one mesh cycle of the healthy one, or the cycles around the damage where there is some.
fn excitation(title: &str, states: &[State], label: &str, value: impl Fn(&State, f64) -> f64) -> Chart {
    let changed = states.iter().filter_map(|s| s.damaged_cycles);
    let (from, to) = changed
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        .map_or((0, 1), |(from, to)| (from.saturating_sub(1), to + 1));
    let lines = states.iter().enumerate().map(|(index, state)| {
        let points = (from * CURVE_POINTS..to * CURVE_POINTS).map(|i| {
            let t = i as f64 / CURVE_POINTS as f64;
            (t, value(state, t))
        });
        line(&state.name, index, pattern(index), points.collect())
    });
    chart(title, CYCLE, label, lines.collect())
}

/// Mesh stiffness of every state.
#[must_use]
pub fn stiffness(title: &str, states: &[State]) -> Chart {
    excitation(title, states, "Mesh stiffness, local slope (N/µm)", |s, t| {
        s.model.excitation().mesh_stiffness().value(t) * 1e-6
    })
}

/// Static transmission error of every state.
#[must_use]
pub fn static_error(title: &str, states: &[State]) -> Chart {
    excitation(title, states, "Static transmission error (µm)", |s, t| {
        s.model.excitation().transmission_error().value(t) * 1e6
    })
}

fn over_cycles(title: &str, all: &[TimeResponse], label: &str, value: impl Fn(&TimeResponse, usize) -> f64) -> Chart {
    let lines = all.iter().enumerate().map(|(index, one)| {
        let points = one.response.mesh_cycle.iter().enumerate().map(|(i, t)| (*t, value(one, i)));
        line(&one.state, index, pattern(index), points.collect())
    });
    let title = match all.first() {
        Some(first) => format!("{title}, {} Hz", rounded(first.response.mesh_frequency)),
        None => title.to_owned(),
    };
    chart(&title, CYCLE, label, lines.collect())
}

fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// Dynamic transmission error over time.
#[must_use]
pub fn transmission_error(title: &str, all: &[TimeResponse]) -> Chart {
    over_cycles(title, all, "Dynamic transmission error (µm)", |r, i| r.response.transmission_error[i] * 1e6)
}

/// Mesh force over time.
#[must_use]
pub fn mesh_force(title: &str, all: &[TimeResponse]) -> Chart {
    over_cycles(title, all, "Mesh force (kN)", |r, i| r.response.mesh_force[i] * 1e-3)
}

/// Forces on both bearings over time.
#[must_use]
pub fn bearing_forces(title: &str, all: &[TimeResponse]) -> Chart {
    let label = "Bearing force (kN)";
    let mut result = over_cycles(title, all, label, |r, i| r.response.gear_bearing_force[i] * 1e-3);
    let mut pinion = over_cycles(title, all, label, |r, i| r.response.pinion_bearing_force[i] * 1e-3);
    result.lines.iter_mut().for_each(|l| l.name = format!("gear, {}", l.name));
    pinion.lines.iter_mut().for_each(|l| l.name = format!("pinion, {}", l.name));
    result.lines.append(&mut pinion.lines);
    result
}

/// Force on three successive tooth pairs: those about the largest force of all, in every state the same.
#[must_use]
pub fn tooth_forces(title: &str, all: &[TimeResponse]) -> Chart {
    let loads = all.iter().flat_map(|one| &one.tooth_forces);
    let middle = loads.max_by(|a, b| a.2.total_cmp(&b.2)).map_or(0, |most| most.1);
    let mut lines = Vec::new();
    for (index, one) in all.iter().enumerate() {
        for (offset, pair) in (middle - 1..=middle + 1).enumerate() {
            let own = one.tooth_forces.iter().filter(|f| f.1 == pair);
            let points: Vec<(f64, f64)> = own.map(|f| (one.response.mesh_cycle[f.0], f.2 * 1e-3)).collect();
            if !points.is_empty() {
                lines.push(line(&format!("{}, pair {pair}", one.state), index, pattern(offset), points));
            }
        }
    }
    chart(title, CYCLE, "Force on the tooth pair (kN)", lines)
}

fn spectral_line(spectrum: &lpm::Spectrum, mesh_frequency: f64) -> Vec<(f64, f64)> {
    spectrum
        .frequency
        .iter()
        .zip(&spectrum.amplitude)
        .skip(1)
        .take_while(|(f, _)| **f <= ORDERS * mesh_frequency)
        .map(|(f, a)| (*f, a * 1e6))
        .collect()
}

/// Amplitude spectrum of the dynamic transmission error.
#[must_use]
pub fn spectrum(title: &str, all: &[TimeResponse]) -> Chart {
    let lines = all.iter().enumerate().map(|(index, one)| {
        line(&one.state, index, pattern(index), spectral_line(&one.spectrum, one.response.mesh_frequency))
    });
    Chart { from_zero: true, ..chart(title, "Frequency (Hz)", "Amplitude of the DTE (µm)", lines.collect()) }
}

/// A measure over speed: sweeps, branches with their unstable parts, turning points as crosses.
#[must_use]
pub fn over_speed(
    title: &str,
    sweeps: &[SweepResult],
    branches: &[BranchResult],
    label: &str,
    measure: impl Fn(&Measure) -> f64,
) -> Chart {
    let mut names: Vec<&str> = Vec::new();
    let mut index_of = |name| {
        names.iter().position(|n| *n == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        })
    };
    let swept = sweeps.iter().map(|s| &s.state).collect::<std::collections::BTreeSet<_>>().len();
    let mut lines = Vec::new();
    for sweep in sweeps {
        let points = sweep.points.iter().map(|p| (p.mesh_frequency, measure(&p.measure) * 1e6)).collect();
        let (direction, pattern) = if sweep.up { ("up", Pattern::Solid) } else { ("down", Pattern::Dashed) };
        lines.push(line(&format!("{}, {direction}", sweep.state), index_of(&sweep.state), pattern, points));
    }
    for result in branches {
        // colours that the sweeps do not have
        let index = index_of(&result.state) + swept;
        let mut named = [false, false];
        // stretches of one kind, each reaching to the first point of the next
        let curve = result.branch.curve();
        let mut start = 0;
        while start + 1 < curve.len() {
            let stable = curve[start + 1].stability == Stability::Stable;
            let mut end = start + 1;
            while end + 1 < curve.len() && (curve[end + 1].stability == Stability::Stable) == stable {
                end += 1;
            }
            let points = curve[start..=end].iter().map(|p| (p.mesh_frequency, measure(&p.measure) * 1e6)).collect();
            let (kind, pattern) = if stable { ("stable", Pattern::DashDotted) } else { ("unstable", Pattern::Dotted) };
            let fresh = !std::mem::replace(&mut named[usize::from(stable)], true);
            let name = if fresh { format!("{}, {kind} branch", result.state) } else { String::new() };
            lines.push(line(&name, index, pattern, points));
            start = end;
        }
        let height = curve.iter().map(|p| measure(&p.measure) * 1e6).fold(0.0, f64::max);
        let width = curve.iter().map(|p| p.mesh_frequency).fold(0.0, f64::max);
        for (k, turn) in result.branch.turning_points.iter().enumerate() {
            let (x, y) = (turn.point.mesh_frequency, measure(&turn.point.measure) * 1e6);
            let (dx, dy) = (0.008 * width, 0.015 * height);
            let name = if k == 0 { "turning points" } else { "" };
            lines.push(line(name, index + 1, Pattern::Solid, vec![(x - dx, y - dy), (x + dx, y + dy)]));
            lines.push(line("", index + 1, Pattern::Solid, vec![(x - dx, y + dy), (x + dx, y - dy)]));
        }
    }
    Chart { from_zero: true, ..chart(title, "Mesh frequency (Hz)", label, lines) }
}

/// Decay after a blow.
#[must_use]
pub fn impulse(title: &str, all: &[ImpulseResult]) -> Chart {
    let lines = all.iter().enumerate().filter_map(|(index, one)| {
        let r = &one.test.as_ref()?.response;
        let points = r.mesh_cycle.iter().zip(&r.transmission_error);
        let points = points.map(|(t, x)| (t / r.mesh_frequency * 1e3, x * 1e6)).collect();
        Some(line(&format!("{}, cycle {:.2}", one.state, one.mesh_cycle), index, pattern(index), points))
    });
    chart(title, "Time (ms)", "Dynamic transmission error (µm)", lines.collect())
}

/// Damaged minus healthy over the mesh cycles in which it is seen, with the static difference.
#[must_use]
pub fn damage_response(title: &str, all: &[DamageResult]) -> Chart {
    let seen = all.iter().flat_map(|one| {
        let (cycles, values) = (&one.response.damaged.response.mesh_cycle, &one.response.difference);
        let largest = values.iter().fold(0.0_f64, |most, v| v.abs().max(most));
        cycles.iter().zip(values).filter(move |(_, v)| v.abs() > SEEN * largest).map(|(t, _)| *t)
    });
    let (from, to) = seen.fold((f64::INFINITY, 0.0_f64), |(from, to), t| (from.min(t), to.max(t)));
    let mut lines = Vec::new();
    for (index, one) in all.iter().enumerate() {
        let cycles = &one.response.damaged.response.mesh_cycle;
        let points = |values: &[f64]| {
            let all = cycles.iter().zip(values).filter(|(t, _)| (from - 1.0..=to + 1.0).contains(*t));
            all.map(|(t, x)| (*t, x * 1e6)).collect()
        };
        let name = format!("{}, {} Hz", one.state, rounded(one.mesh_frequency));
        lines.push(line(&name, index, pattern(index), points(&one.response.difference)));
        if !all[..index].iter().any(|a| a.state == one.state) {
            let name = format!("{}, static", one.state);
            lines.push(line(&name, index + 4, Pattern::Dotted, points(&one.response.static_difference)));
        }
    }
    chart(title, CYCLE, "Damage-induced response (µm)", lines)
}

/// Spectrum of the damage-induced response.
#[must_use]
pub fn damage_spectrum(title: &str, all: &[DamageResult]) -> Chart {
    let lines = all.iter().enumerate().map(|(index, one)| {
        let name = format!("{}, {} Hz", one.state, rounded(one.mesh_frequency));
        line(&name, index, pattern(index), spectral_line(&one.response.spectrum, one.mesh_frequency))
    });
    Chart { from_zero: true, ..chart(title, "Frequency (Hz)", "Amplitude of the difference (µm)", lines.collect()) }
}

/// Largest line of the damage-induced spectrum over speed, with its value at vanishing speed.
#[must_use]
pub fn damage_speeds(title: &str, all: &[DamageSpeeds]) -> Chart {
    let mut lines = Vec::new();
    for (index, one) in all.iter().enumerate() {
        let points: Vec<(f64, f64)> = one.rows.iter().map(|r| (r[0], r[2] * 1e6)).collect();
        let ends = [one.rows.first(), one.rows.last()].into_iter().flatten();
        let threshold = ends.map(|r| (r[0], one.static_amplitude * 1e6)).collect();
        lines.push(line(&one.state, index, Pattern::Solid, points));
        lines.push(line(&format!("{}, static", one.state), index, Pattern::Dashed, threshold));
    }
    Chart { from_zero: true, ..chart(title, "Mesh frequency (Hz)", "Largest amplitude of the difference (µm)", lines) }
}
