//! Chapters 5 and 6, Appendices A and B: housing vibration of the rotorcraft transmission and what a HUMS sees of it.

pub mod healthy;
pub mod indicators;
pub mod model;
pub mod ring;
pub mod sun;

use gearwright_plot::{Line, Mark, Pattern, PolarChart};

use crate::reproduce::drawn::{Panel, Picture, colour::*, line};
use crate::reproduce::vibration::{Clock, State};

/// Case files.
pub const RING: &str = "transmission-ring-crack.toml";
/// Sun.
pub const SUN: &str = "transmission-sun-crack.toml";
/// The damaged ring tooth at three places.
pub const PLACES: &str = "transmission-ring-crack-places.toml";
/// Sensor near the input port, where the experiments had theirs.
pub const INPUT_PORT: &str = "input port";
/// Sensor beside the ring tooth that is damaged.
pub const RING_TOOTH: &str = "damaged tooth";
/// What FM4 and M8A are for Gaussian noise: the thresholds.
pub const FM4_THRESHOLD: f64 = 3.0;
/// As above.
pub const M8A_THRESHOLD: f64 = 105.0;

/// Axis titles.
const TURNS: &str = "Carrier cycle";
const ACCELERATION: &str = "Acceleration (g)";
const AMPLITUDE: (&str, &str) = ("Frequency (Hz)", "Amplitude (g)");
/// Spectra are shown up to here (Hz).
const HIGHEST: f64 = 10_000.0;

/// What every figure of the transmission says of its model.
const MODEL: &str = "Housing, bearing stiffnesses and damping are not printed: the case file says what was chosen and from where, so amplitudes are \
                     those of another housing than the dissertation's. Angles of sensors are counted from a planet at the start; the input port's is one of the three at \
                     which a planet passes at the printed 0.092 of a carrier cycle, so its sensor is near the damaged ring tooth's.";

/// Colours of the healthy state and of cracks of 20, 50 and 80 % of the ring.
const RING_COLOURS: [&str; 4] = [BLACK, BLUE, RED, GREEN];
/// The same for the sun.
const SUN_COLOURS: [&str; 4] = [BLUE, RED, GREEN, PURPLE];

fn over_turns(clock: &Clock, samples: &[f64], (from, to): (f64, f64)) -> Vec<(f64, f64)> {
    clock.over_turns(samples).into_iter().filter(|p| (from..=to).contains(&p.0)).collect()
}

/// A chart of accelerations over carrier turns.
fn time_panel(letter: &'static str, about: &str, lines: Vec<Line>) -> Panel {
    Panel::chart(letter, about, (TURNS, ACCELERATION), lines)
}

/// A chart of amplitudes over frequency.
fn spectrum_panel(letter: &'static str, about: &str, lines: Vec<Line>) -> Panel {
    Panel::chart(letter, about, AMPLITUDE, lines).zero_based()
}

/// A solid line.
fn solid(name: &str, colour: &'static str, points: Vec<(f64, f64)>) -> Line {
    line(name, colour, Pattern::Solid, points)
}

/// A dashed threshold.
fn threshold(at: f64, label: &str) -> Mark {
    Mark { at, upright: false, label: label.into(), colour: MAGENTA, dotted: false }
}

/// Something over severities, healthy at 0.
fn over_severity(name: &str, colour: &'static str, pattern: Pattern, values: &[(f64, f64)]) -> Line {
    line(name, colour, pattern, values.to_vec())
}

/// The largest line of a spectrum: frequency and amplitude.
fn largest(spectrum: &[(f64, f64)]) -> (f64, f64) {
    spectrum.iter().copied().fold((0.0, 0.0), |best, line| if line.1 > best.1 { line } else { best })
}

/// A value over sensor angles (degrees), to be drawn about the housing.
struct Ring {
    name: String,
    colour: &'static str,
    points: Vec<(f64, f64)>,
}

/// Closed lines about the housing, of the natural logarithm of a value over sensor angles, with the threshold as a circle.
fn polar(letter: &'static str, about: &str, rings: Vec<Ring>, threshold: f64) -> Panel {
    let radii = || rings.iter().flat_map(|ring| &ring.points).map(|point| point.1.ln());
    let rim = radii().fold(threshold.ln(), f64::max).ceil();
    let centre = radii().fold(0.0, f64::min).floor();
    let mut lines: Vec<Line> = rings
        .iter()
        .flat_map(|Ring { name, colour, points }| {
            arcs(points).into_iter().enumerate().map(|(k, arc)| (if k == 0 { name.as_str() } else { "" }, *colour, arc))
        })
        .map(|(name, colour, arc)| {
            solid(name, colour, arc.into_iter().map(|(angle, value)| (angle, value.ln())).collect())
        })
        .collect();
    let circle = (0..=360).map(|degree| (f64::from(degree), threshold.ln())).collect();
    lines.push(line("threshold", MAGENTA, Pattern::Dashed, circle));
    let picture = Picture::Polar(PolarChart { title: String::new(), lines, radii: (centre, rim) });
    Panel { letter, about: about.into(), picture }
}

/// Points about a circle cut where no sensors are for more than three teeth (the housing's supports).
fn arcs(points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    const GAP: f64 = 12.0;
    let mut sorted: Vec<(f64, f64)> = points.iter().map(|p| (p.0.rem_euclid(360.0), p.1)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut arcs: Vec<Vec<(f64, f64)>> = Vec::new();
    for point in sorted {
        match arcs.last_mut() {
            Some(arc) if arc.last().is_some_and(|last| point.0 - last.0 < GAP) => arc.push(point),
            _ => arcs.push(vec![point]),
        }
    }
    // the first and the last meet across 0 degrees
    if let [first, .., last] = &mut arcs[..]
        && let (Some(a), Some(b)) = (first.first().copied(), last.last())
        && a.0 + 360.0 - b.0 < GAP
    {
        last.extend(first.iter().map(|p| (p.0 + 360.0, p.1)));
        arcs.remove(0);
    } else if let [only] = &mut arcs[..]
        && let Some(first) = only.first().copied()
    {
        only.push((first.0 + 360.0, first.1));
    }
    arcs
}

/// States with the colours of a chapter.
fn coloured<'a>(states: &'a [State], colours: &[&'static str; 4]) -> Vec<(&'a State, &'static str)> {
    states.iter().zip(*colours).collect()
}
