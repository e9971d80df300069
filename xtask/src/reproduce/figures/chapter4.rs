//! Chapter 4: the phenomenon-based model, its fit to difference signals, and its condition indicators.

use anyhow::Context as _;
use gearwright_plot::{Line, Mark, Pattern};
use hums::indicator::basic::{kurtosis, m8a, rms};
use hums::phenomenon::fit::{Fit, FitOptions, fit};
use hums::phenomenon::{ClosedForm, DampedSine, simplified_indicators};

use super::chapter3::CRACKS;
use super::scheme;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Panel, Table, colour::*, line};
use crate::reproduce::dynamics::{Dynamics, Motion, PITCH, STEPS, over_cycles};
use crate::reproduce::statics::{at, top};
use gear_geom::Member;

/// Mesh frequency of the chapter (Hz).
const MESH: f64 = 1800.0;
/// Mesh cycles of one turn of the pinion.
const TURN: usize = 27;
/// The printed model of the 20 % crack (um, s, Hz): input of Figures 4.9 and 4.10, which are closed expressions of it.
const PRINTED: DampedSine =
    DampedSine { amplitude: 2.798, delay: 0.000_475_303, natural_frequency: 2733.33, damping: 0.03992 };
/// Crack (%) whose signal gives the pair's natural frequency and damping ratio: large enough to be clear, small enough to stay in contact.
const LINEAR: f64 = 20.0;
const GROWTH: &str = "cracked-pinion-plane-growth.toml";
/// Mesh cycle at which the damaged tooth engages (printed): where the record of a difference signal begins.
const ENGAGED: f64 = 14.02;
const MODEL: &str = "Finite-element/contact model with rigid hubs and the inertias of Table 3.2, pinion at constant speed, damping ratio 0.048 with one \
                     pair in contact (printed as a result of impulse tests, input here).";
const CRACKED: &str = "Cracks in a plane-stress model, along the chord below the tooth.";
const PITTED: &str = "Pits in a three-dimensional model, which is some 8 % stiffer than the printed curves.";

/// A difference signal of one turn from the engagement of the damaged tooth on, and its sampling rate (Hz).
struct Signal {
    percent: f64,
    samples: Vec<f64>,
    rate: f64,
}

impl Signal {
    fn new(dynamics: &Dynamics, motion: &Motion) -> Self {
        let mut samples = motion.difference(&dynamics.healthy);
        samples.rotate_left((ENGAGED * STEPS as f64).round() as usize - 1);
        Self { percent: motion.percent, samples, rate: dynamics.rate() }
    }

    fn over_cycles(&self, values: &[f64]) -> Vec<(f64, f64)> {
        values.iter().enumerate().map(|(k, y)| (k as f64 / self.rate * MESH, *y)).collect()
    }

    /// Amplitude and delay for a known natural frequency (Hz) and damping ratio.
    fn fitted(&self, (frequency, damping): (f64, f64)) -> anyhow::Result<Fit> {
        Ok(fit(&self.samples, self.rate, &FitOptions::amplitude_and_delay(frequency, damping))?)
    }
}

/// Natural frequency (Hz) and damping ratio of the computed pair: all four parameters fitted to the signal of one crack.
fn mode(signals: &[Signal]) -> anyhow::Result<(f64, f64)> {
    const TYPICAL: (f64, f64) = (2700.0, 0.04);
    let clear = signals.iter().find(|s| (s.percent - LINEAR).abs() < 1e-9).context("no crack to find the mode from")?;
    let start = FitOptions::amplitude_and_delay(TYPICAL.0, TYPICAL.1);
    let found =
        fit(&clear.samples, clear.rate, &FitOptions { free_frequency: true, free_damping: true, ..start })?.model;
    Ok((found.natural_frequency, found.damping))
}

fn mode_note((frequency, damping): (f64, f64)) -> String {
    format!(
        "Natural frequency {frequency:.1} Hz and damping ratio {damping:.5} of the damped sine are the computed pair's own, from a fit of all four parameters to \
         the {LINEAR} % crack; the dissertation's pair has {} Hz and {}.",
        PRINTED.natural_frequency, PRINTED.damping
    )
}

fn growth(context: &Context) -> anyhow::Result<Dynamics> {
    context.dynamics(GROWTH, MESH, &[0, 1, 2, 3, 4, 5, 6, 7, 8])
}

/// Cracks of 20, 50 and 80 % at 4000 rpm.
fn cracks(context: &Context) -> anyhow::Result<Dynamics> {
    context.dynamics("cracked-pinion-plane.toml", MESH, &[0, 1, 2])
}

/// Pits of 6.35, 12.7 and 20.32 mm at 4000 rpm.
fn pits(context: &Context) -> anyhow::Result<Dynamics> {
    context.dynamics("pitted-pitch.toml", MESH, &[0, 1, 3])
}

fn signals(context: &Context) -> anyhow::Result<Vec<Signal>> {
    let dynamics = growth(context)?;
    Ok(dynamics.damaged.iter().map(|motion| Signal::new(&dynamics, motion)).collect())
}

const DTE: &str = "Dynamic transmission error (µm)";
const AMPLITUDE: (&str, &str) = ("Frequency (Hz)", "Amplitude (µm)");
/// Spectra are shown up to here (Hz).
const HIGHEST: f64 = 6000.0;

/// Figure 4.2.
pub fn healthy(context: &Context) -> anyhow::Result<Drawn> {
    let dynamics = cracks(context)?;
    let mut drawn = Drawn::default();
    let points = dynamics.healthy.over_cycles().into_iter().take_while(|p| p.0 <= 3.0).collect();
    let labels = ("Mesh cycle", DTE);
    drawn.panels.push(Panel::chart(
        "a",
        "Three mesh cycles at 4000 rpm.",
        labels,
        vec![line("", BLACK, Pattern::Solid, points)],
    ));
    let spectrum = dynamics.spectrum(&dynamics.healthy.error, HIGHEST)?;
    let lines = vec![line("", BLACK, Pattern::Solid, spectrum)];
    drawn.panels.push(Panel::chart("b", "Spectrum.", AMPLITUDE, lines).zero_based());
    drawn.note(MODEL);
    drawn.note(CRACKED);
    Ok(drawn)
}

/// Response, spectrum and zoom of a healthy pair and three severities.
fn responses(dynamics: &Dynamics) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let all = || {
        let damaged = dynamics.damaged.iter().zip(CRACKS).map(|(m, (colour, pattern))| (m, colour, pattern));
        std::iter::once((&dynamics.healthy, BLACK, Pattern::Solid)).chain(damaged)
    };
    let time = |from: f64, to: f64| -> Vec<Line> {
        let inside = |p: &(f64, f64)| (from..=to).contains(&p.0);
        let points = |m: &Motion| m.over_cycles().into_iter().filter(inside).collect();
        all().map(|(m, colour, pattern)| line(&m.label, colour, pattern, points(m))).collect()
    };
    let mut spectra = Vec::new();
    for (m, colour, pattern) in all() {
        spectra.push(line(&m.label, colour, pattern, dynamics.spectrum(&m.error, HIGHEST)?));
    }
    let near = spectra.iter().map(|l| {
        let points = l.points.iter().copied().filter(|p| (2000.0..=3500.0).contains(&p.0)).collect();
        Line { points, ..l.clone() }
    });
    let near = Panel::chart("d", "The spectrum from 2000 to 3500 Hz.", AMPLITUDE, near.collect()).zero_based();
    drawn.panels.push(Panel::chart("a", "One rotation of the pinion.", ("Mesh cycle", DTE), time(0.0, 27.0)));
    drawn.panels.push(Panel::chart("b", "Spectrum.", AMPLITUDE, spectra).zero_based());
    drawn.panels.push(Panel::chart("c", "After the damaged tooth engages.", ("Mesh cycle", DTE), time(13.0, 20.0)));
    drawn.panels.push(near);
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 4.3.
pub fn cracked(context: &Context) -> anyhow::Result<Drawn> {
    let dynamics = cracks(context)?;
    let mut drawn = responses(&dynamics)?;
    let own = |m: &Motion| -> anyhow::Result<f64> {
        Ok(at(&dynamics.spectrum(&m.error, HIGHEST)?, MESH).unwrap_or(f64::NAN))
    };
    let healthy = own(&dynamics.healthy)?;
    drawn.value("healthy, line at the mesh frequency", healthy);
    if let [_, half, most] = &dynamics.damaged[..] {
        for (name, motion) in [("50 %", half), ("80 %", most)] {
            let value = own(motion)?;
            drawn.value(format!("{name}, line at the mesh frequency"), value);
            drawn.value(format!("{name}, increase of that line"), 100.0 * (value / healthy - 1.0));
        }
        let lines = dynamics.spectrum(&half.error, HIGHEST)?.into_iter().filter(|l| (2000.0..=3500.0).contains(&l.0));
        drawn.value("largest line beside the mesh harmonics", top(&lines.collect::<Vec<_>>()).0);
        for (k, flight) in most.lost.iter().filter(|l| l[0] > 14.0).enumerate() {
            drawn.value(format!("80 %, contact lost {}", k + 1), flight[0]);
            drawn.value(format!("80 %, contact found {}", k + 1), flight[1]);
        }
    }
    // the figures count from 14 what the statics count from 0
    let statics = context.statics("cracked-pinion-plane.toml")?.healthy;
    let entry = statics.of_pair(0, |p| p.force).first().map_or(f64::NAN, |p| p.0);
    drawn.value("damaged tooth engages", entry + PITCH - 0.75);
    let case = context.spur_pair("cracked-pinion-plane.toml")?;
    let lengths: Vec<_> = [0.2, 0.5, 0.8].into_iter().zip(CRACKS).map(|(l, (c, _))| (l, c, Pattern::Solid)).collect();
    let side = case.pair.working_side(Member::Pinion);
    let mesh = scheme::cracks(case.pair.pinion(), side, &lengths)?;
    drawn.panels.push(Panel::drawing("e", "The cracks in the mesh of the tooth.", mesh));
    drawn.note(CRACKED);
    Ok(drawn)
}

/// Figure 4.4.
pub fn pitted(context: &Context) -> anyhow::Result<Drawn> {
    let dynamics = pits(context)?;
    let mut drawn = responses(&dynamics)?;
    for (motion, name) in dynamics.damaged.iter().zip(["6.35", "12.7", "20.32"]) {
        drawn.value(format!("pit of {name} mm, area"), motion.percent);
    }
    let case = context.spur_pair("pitted-pitch.toml")?;
    let shown = [0, 1, 3].into_iter().filter_map(|k| case.severities.get(k));
    let pits = shown.zip(CRACKS).map(|(s, (colour, pattern))| (s, colour, pattern));
    drawn.panels.push(Panel::drawing("e", "The pits on the pinion flank.", scheme::flank(&case, Member::Pinion, pits)));
    drawn.note(PITTED);
    Ok(drawn)
}

/// Figure 4.5.
pub fn differences(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    for (dynamics, what, [time, frequency]) in
        [(cracks(context)?, "Cracks", ["a", "b"]), (pits(context)?, "Pits", ["c", "d"])]
    {
        let (mut signals, mut spectra) = (Vec::new(), Vec::new());
        for (motion, (colour, pattern)) in dynamics.damaged.iter().zip(CRACKS) {
            let samples = motion.difference(&dynamics.healthy);
            signals.push(line(&motion.label, colour, pattern, over_cycles(&samples)));
            spectra.push(line(&motion.label, colour, pattern, dynamics.spectrum(&samples, HIGHEST)?));
        }
        // where the difference is a free oscillation: the middle severity
        if let (Some(signal), Some(spectrum)) = (signals.get(1), spectra.get(1)) {
            let highest = top(&signal.points).0;
            if what == "Cracks" {
                drawn.value("crack, cycle of the maximum", highest);
                drawn.value("crack, frequency of the largest line", top(&spectrum.points).0);
                let after: Vec<(f64, f64)> =
                    signal.points.iter().copied().filter(|p| p.0 > highest + 0.35 && p.0 < highest + 1.0).collect();
                let period = top(&after).0 - highest;
                drawn.value("crack, period of the oscillation", period);
                drawn.value("crack, frequency of the oscillation", MESH / period);
            } else {
                drawn.value("pit, cycle of the maximum", highest);
            }
        }
        let labels = ("Mesh cycle", "Damaged minus healthy (µm)");
        drawn.panels.push(Panel::chart(time, &format!("{what}: difference signal."), labels, signals));
        drawn.panels.push(Panel::chart(frequency, &format!("{what}: its spectrum."), AMPLITUDE, spectra).zero_based());
    }
    [MODEL, CRACKED, PITTED].into_iter().for_each(|note| drawn.note(note));
    Ok(drawn)
}

/// Table 4.2.
pub fn indicator_table(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let mut rows = Vec::new();
    let names = [["crack 20 %", "crack 50 %", "crack 80 %"], ["pit 3.32 %", "pit 13.28 %", "pit 30.28 %"]];
    for (dynamics, names) in [cracks(context)?, pits(context)?].into_iter().zip(names) {
        let mut moments = Vec::new();
        for (motion, name) in dynamics.damaged.iter().zip(names) {
            let values = measured(&motion.difference(&dynamics.healthy))?;
            moments.push(values[1]);
            let mut row = vec![name.to_owned()];
            for (value, indicator) in values.into_iter().zip(["RMS", "FM4", "M8A"]) {
                drawn.value(format!("{name}, {indicator}"), value);
                row.push(format!("{value:.3}"));
            }
            rows.push(row);
        }
        if let [first, .., last] = moments[..] {
            let key = if names[0].starts_with("crack") {
                "crack, FM4 from 20 to 80 %"
            } else {
                "pit, FM4 from 3.32 to 30.28 %"
            };
            drawn.value(key, 100.0 * (last / first - 1.0));
        }
    }
    drawn.tables.push(Table { head: ["damage", "RMS (µm)", "FM4", "M8A"].map(String::from).to_vec(), rows });
    [MODEL, CRACKED, PITTED].into_iter().for_each(|note| drawn.note(note));
    Ok(drawn)
}

/// Figure 4.6.
pub fn fitted_signals(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let letters = [["a", "b"], ["c", "d"], ["e", "f"]];
    let dynamics = growth(context)?;
    let signals: Vec<Signal> = dynamics.damaged.iter().map(|m| Signal::new(&dynamics, m)).collect();
    let mode = mode(&signals)?;
    for (percent, [time, frequency]) in [20.0, 50.0, 80.0].into_iter().zip(letters) {
        let Some(signal) = signals.iter().find(|s| (s.percent - percent).abs() < 1e-9) else { continue };
        let model = signal.fitted(mode)?;
        let values = model.model.samples(signal.samples.len(), signal.rate)?;
        let pair = |exact: Vec<(f64, f64)>, fitted: Vec<(f64, f64)>| -> Vec<Line> {
            vec![
                line("difference signal", BLACK, Pattern::Solid, exact),
                line("damped sine", RED, Pattern::Dashed, fitted),
            ]
        };
        let lines = pair(signal.over_cycles(&signal.samples), signal.over_cycles(&values));
        let lines =
            lines.into_iter().map(|l| Line { points: l.points.into_iter().filter(|p| p.0 <= 12.0).collect(), ..l });
        let labels = ("Mesh cycles after engagement", "Difference signal (µm)");
        drawn.panels.push(Panel::chart(time, &format!("Crack of {percent} %."), labels, lines.collect()));
        let lines = pair(dynamics.spectrum(&signal.samples, HIGHEST)?, dynamics.spectrum(&values, HIGHEST)?);
        let labels = ("Frequency (Hz)", "Amplitude (µm)");
        drawn.panels.push(Panel::chart(frequency, &format!("Its spectrum, {percent} %."), labels, lines).zero_based());
        drawn.value(format!("{percent} %, amplitude"), model.model.amplitude);
        drawn.value(format!("{percent} %, delay"), model.model.delay);
        let peak = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        drawn.value(
            format!("{percent} %, peak of the model over the signal's"),
            100.0 * (peak(&values) / peak(&signal.samples) - 1.0),
        );
    }
    drawn.note(MODEL);
    drawn.note(CRACKED);
    drawn.note(mode_note(mode));
    Ok(drawn)
}

/// Figure 4.7.
pub fn amplitude_and_delay(context: &Context) -> anyhow::Result<Drawn> {
    let (mut amplitude, mut delay) = (Vec::new(), Vec::new());
    let signals = signals(context)?;
    let mode = mode(&signals)?;
    for signal in signals {
        let model = signal.fitted(mode)?.model;
        amplitude.push((signal.percent, model.amplitude));
        delay.push((signal.percent, model.delay * 1e3));
    }
    let mut drawn = Drawn::default();
    let panels = [("a", "Amplitude.", "Amplitude A (µm)", amplitude), ("b", "Delay.", "Delay (ms)", delay)];
    for (letter, about, label, points) in panels {
        let lines = vec![line("", BLUE, Pattern::Solid, points.clone()), line("", BLUE, Pattern::Circles, points)];
        drawn.panels.push(Panel::chart(letter, about, ("Crack length (%)", label), lines).zero_based());
    }
    drawn.note(MODEL);
    drawn.note(CRACKED);
    drawn.note(mode_note(mode));
    Ok(drawn)
}

/// Damped natural frequency (Hz).
fn damped(sine: &DampedSine) -> f64 {
    sine.natural_frequency * (1.0 - sine.damping * sine.damping).sqrt()
}

fn measured(samples: &[f64]) -> anyhow::Result<[f64; 3]> {
    Ok([rms(samples)?, kurtosis(samples)?, m8a(samples)?])
}

fn listed(form: &ClosedForm) -> [f64; 3] {
    [form.rms, form.fm4, form.m8a]
}

const INDICATORS: [(&str, &str); 3] = [("a", "RMS (µm)"), ("b", "FM4"), ("c", "M8A")];

/// Figure 4.8.
pub fn indicators(context: &Context) -> anyhow::Result<Drawn> {
    let mut rows: Vec<(f64, [[f64; 3]; 3])> = Vec::new();
    let signals = signals(context)?;
    let mode = mode(&signals)?;
    for signal in signals {
        let model = signal.fitted(mode)?.model;
        let samples = model.samples(signal.samples.len(), signal.rate)?;
        let duration = TURN as f64 / MESH;
        let closed =
            simplified_indicators(model.extremum(1), model.log_decrement(), model.half_cycles(duration) as f64)?;
        rows.push((signal.percent, [measured(&signal.samples)?, measured(&samples)?, listed(&closed)]));
    }
    let mut drawn = Drawn::default();
    let looks = [
        ("difference signal", BLUE, Pattern::Solid, Pattern::Circles),
        ("damped sine", RED, Pattern::Dashed, Pattern::Squares),
        ("closed form (4.14)", GREEN, Pattern::DashDotted, Pattern::Crosses),
    ];
    for (k, (letter, label)) in INDICATORS.into_iter().enumerate() {
        let mut lines = Vec::new();
        for (j, (name, colour, pattern, marker)) in looks.into_iter().enumerate() {
            let points: Vec<(f64, f64)> = rows.iter().map(|(percent, all)| (*percent, all[j][k])).collect();
            lines.push(line("", colour, pattern, points.clone()));
            lines.push(line(name, colour, marker, points));
        }
        drawn.panels.push(Panel::chart(letter, label, ("Crack length (%)", label), lines).zero_based());
    }
    for percent in [20.0, 80.0] {
        if let Some((_, [exact, model, _])) = rows.iter().find(|r| (r.0 - percent).abs() < 1e-9) {
            for (k, name) in ["RMS", "FM4", "M8A"].into_iter().enumerate() {
                let apart = 100.0 * (model[k] / exact[k] - 1.0).abs();
                drawn.value(format!("{percent} %, {name} of model and signal apart"), apart);
            }
        }
    }
    drawn.note(MODEL);
    drawn.note(CRACKED);
    drawn.note(mode_note(mode));
    Ok(drawn)
}

/// Density of sampled values over equal bins.
fn histogram(samples: &[f64], bins: usize) -> Vec<(f64, f64)> {
    let (low, high) = samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(*y), h.max(*y)));
    let width = (high - low) / bins as f64;
    let mut counts = vec![0.0; bins];
    for y in samples {
        counts[(((y - low) / width) as usize).min(bins - 1)] += 1.0;
    }
    let scale = 1.0 / (samples.len() as f64 * width);
    counts.iter().enumerate().map(|(k, c)| (low + (k as f64 + 0.5) * width, c * scale)).collect()
}

/// Figure 4.9.
pub fn densities(_: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    // the damaged tooth engages at 0
    let sine = DampedSine { delay: 0.0, ..PRINTED };
    let half = 0.5 / damped(&sine);
    let parts = [(3_usize, ["a", "b"]), (4, ["c", "d"]), (82, ["e", "f"])];
    for (count, [time, density]) in parts {
        let duration = if count == 82 { TURN as f64 / MESH } else { count as f64 * half };
        let samples = 400_000;
        let rate = samples as f64 / duration;
        let values = sine.samples(samples, rate)?;
        let points = values.iter().enumerate().step_by(200).map(|(k, y)| (k as f64 / rate * MESH, *y)).collect();
        let about = format!("Damped sine, {count} half cycles.");
        let labels = ("Mesh cycles", "Signal (µm)");
        drawn.panels.push(Panel::chart(time, &about, labels, vec![line("", BLACK, Pattern::Solid, points)]));
        let form = sine.density(count)?;
        let bins = histogram(&values, 400);
        let inside = |y: f64| form.density(y);
        let exact = bins.iter().map(|(y, _)| (*y, inside(*y))).filter(|p| p.1.is_finite()).collect();
        let lines = vec![
            line("counted", BLACK, Pattern::Solid, bins.clone()),
            line("closed form (4.11), (4.12)", RED, Pattern::Dashed, exact),
        ];
        let labels = ("Signal (µm)", "Probability density (1/µm)");
        let mut panel = Panel::chart(density, &format!("Its probability density, {count} half cycles."), labels, lines)
            .zero_based();
        // the peaks at the extrema are singular: cut for the eye
        if let crate::reproduce::drawn::Picture::Chart(chart) = &mut panel.picture {
            let high = if count == 82 { 4.0 } else { 1.2 };
            for l in &mut chart.chart.lines {
                l.points.iter_mut().for_each(|p| p.1 = p.1.min(high));
            }
        }
        drawn.panels.push(panel);
    }
    let period = 2.0 * half * MESH;
    let first = (sine.time_of_maximum()) * MESH;
    for (k, name) in ["A1", "A2", "A3"].into_iter().enumerate() {
        drawn.value(name, sine.extremum(k + 1));
        drawn.value(format!("time of {name}"), first + 0.5 * period * k as f64);
    }
    drawn.value("density below zero", 2.0 / (3.0 * std::f64::consts::PI * sine.extremum(2).abs()));
    drawn.value("half cycles", sine.half_cycles(TURN as f64 / MESH) as f64);
    drawn.note("Input: the printed amplitude, natural frequency and damping ratio of the 20 % crack. Peaks of the densities are cut off.");
    drawn.note(
        "The dissertation shows one and two cycles as two to four half sines; three, four and 82 are shown here.",
    );
    Ok(drawn)
}

/// RMS, FM4 and M8A over a property.
type Swept = Vec<(f64, [f64; 3])>;

/// Figure 4.10.
pub fn sensitivity(_: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let turn = TURN as f64 / MESH;
    let steps = |from: f64, to: f64| (0..=60).map(move |k| from + (to - from) * f64::from(k) / 60.0);
    let by = |sine: DampedSine, n: f64| -> anyhow::Result<[f64; 3]> {
        Ok(listed(&simplified_indicators(sine.extremum(1), sine.log_decrement(), n)?))
    };
    let cycles = |sine: &DampedSine| 2.0 * turn * damped(sine);
    let own = cycles(&PRINTED);
    let mut sweeps: Vec<(&str, f64, Swept)> = Vec::new();
    let mut rows = Vec::new();
    for damping in steps(0.01, 0.2) {
        let sine = DampedSine { damping, ..PRINTED };
        rows.push((damping, by(sine, cycles(&sine))?));
    }
    sweeps.push(("Damping ratio", PRINTED.damping, rows));
    let mut rows = Vec::new();
    for natural_frequency in steps(1000.0, 5000.0) {
        let sine = DampedSine { natural_frequency, ..PRINTED };
        rows.push((natural_frequency, by(sine, cycles(&sine))?));
    }
    sweeps.push(("Natural frequency (Hz)", PRINTED.natural_frequency, rows));
    let mut rows = Vec::new();
    for n in steps(20.0, 160.0) {
        rows.push((n, by(PRINTED, n)?));
    }
    sweeps.push(("Half-sine cycles n", own, rows));
    let letters = [["a1", "a2", "a3"], ["b1", "b2", "b3"], ["c1", "c2", "c3"]];
    for ((label, here, rows), letters) in sweeps.into_iter().zip(letters) {
        for (k, (letter, (_, name))) in letters.into_iter().zip(INDICATORS).enumerate() {
            let points = rows.iter().map(|(x, all)| (*x, all[k])).collect();
            let mark = Mark { at: here, upright: true, label: String::new(), colour: RED, dotted: false };
            let lines = vec![line("", BLACK, Pattern::Solid, points)];
            let about = format!("{name} over {}.", label.to_lowercase());
            drawn.panels.push(Panel::chart(letter, &about, (label, name), lines).zero_based().mark(mark));
        }
    }
    // three routes to the indicators of the printed model
    let rate = 50.0 * MESH;
    let samples = PRINTED.samples(50 * TURN + 1, rate)?;
    let time = measured(&samples)?;
    let closed = listed(&DampedSine { delay: 0.0, ..PRINTED }.density(PRINTED.half_cycles(turn))?.indicators()?);
    let simple = by(PRINTED, PRINTED.half_cycles(turn) as f64)?;
    let mut table =
        Table { head: ["indicator", "samples", "(4.13)", "(4.14)"].map(String::from).to_vec(), rows: Vec::new() };
    for (k, name) in ["RMS", "FM4", "M8A"].into_iter().enumerate() {
        drawn.value(format!("{name}, (4.13) and samples apart"), 100.0 * (closed[k] / time[k] - 1.0).abs());
        table.rows.push(vec![
            name.into(),
            format!("{:.5}", time[k]),
            format!("{:.5}", closed[k]),
            format!("{:.5}", simple[k]),
        ]);
    }
    drawn.value("RMS of the model", time[0]);
    drawn.tables.push(table);
    drawn.note("Red: the pair of the dissertation. Input: the printed parameters of the 20 % crack's model.");
    Ok(drawn)
}
