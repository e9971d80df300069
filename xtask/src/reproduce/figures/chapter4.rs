//! Chapter 4: the phenomenon-based model, its fit to difference signals, and its condition indicators.

use gearwright::plot::{Line, Mark, Pattern};
use hums::indicator::basic::{kurtosis, m8a, rms};
use hums::phenomenon::fit::{Fit, FitOptions, fit};
use hums::phenomenon::{ClosedForm, DampedSine, simplified_indicators};

use super::lumped::{difference, difference_points};
use crate::reproduce::context::{Context, Lumped};
use crate::reproduce::drawn::{Drawn, Panel, Table, colour::*, line};

/// Mesh frequency of the chapter (Hz).
const MESH: f64 = 1800.0;
/// Mesh cycles of one turn of the pinion.
const TURN: usize = 27;
/// Natural frequency (Hz) and damping ratio of the chapter's model (printed: input of the phenomenon-based model).
const MODE: (f64, f64) = (2733.33, 0.03992);
/// Amplitude (um) and delay (s) of the printed model of the 20 % crack, input of Figures 4.9 and 4.10.
const PRINTED: DampedSine =
    DampedSine { amplitude: 2.798, delay: 0.000_475_303, natural_frequency: MODE.0, damping: MODE.1 };
const FILE: &str = "lumped-1800hz-growth.toml";
const STAND_IN: &str = "Difference signals are those of the lumped-parameter model, in place of the dissertation's finite-element dynamics; the \
                        record begins when the damaged tooth engages, at 14 mesh cycles.";

/// A difference signal of one turn from the engagement of the damaged tooth on, and its sampling rate (Hz).
struct Signal {
    percent: f64,
    samples: Vec<f64>,
    rate: f64,
}

impl Signal {
    fn of(run: &Lumped, state: &str, percent: f64) -> anyhow::Result<Self> {
        let result = difference(run, state, MESH)?;
        let mut samples: Vec<f64> = difference_points(result).iter().map(|p| p.1).collect();
        let per_cycle = samples.len() / TURN;
        samples.truncate(per_cycle * TURN);
        samples.rotate_left(14 * per_cycle);
        Ok(Self { percent, samples, rate: per_cycle as f64 * MESH })
    }

    fn over_cycles(&self, values: &[f64]) -> Vec<(f64, f64)> {
        values.iter().enumerate().map(|(k, y)| (k as f64 / self.rate * MESH, *y)).collect()
    }

    fn spectrum(&self, values: &[f64]) -> anyhow::Result<Vec<(f64, f64)>> {
        let lines = lpm::Spectrum::of(values, values.len() as f64 / self.rate)?;
        let lines = lines.frequency.into_iter().zip(lines.amplitude).skip(1);
        Ok(lines.take_while(|l| l.0 <= 6000.0).collect())
    }

    fn fitted(&self) -> anyhow::Result<Fit> {
        Ok(fit(&self.samples, self.rate, &FitOptions::amplitude_and_delay(MODE.0, MODE.1))?)
    }
}

fn signals(context: &Context) -> anyhow::Result<Vec<Signal>> {
    let run = context.lumped(FILE)?;
    let mut all = Vec::new();
    for state in &run.states[1..] {
        let percent = state.name.split_whitespace().nth(1).and_then(|w| w.parse().ok());
        let percent = percent.ok_or_else(|| anyhow::anyhow!("state {} has no crack length in its name", state.name))?;
        all.push(Signal::of(&run, &state.name, percent)?);
    }
    Ok(all)
}

/// Figure 4.6.
pub fn fitted_signals(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let letters = [["a", "b"], ["c", "d"], ["e", "f"]];
    let signals = signals(context)?;
    for (percent, [time, frequency]) in [20.0, 50.0, 80.0].into_iter().zip(letters) {
        let Some(signal) = signals.iter().find(|s| s.percent == percent) else { continue };
        let model = signal.fitted()?;
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
        let lines = pair(signal.spectrum(&signal.samples)?, signal.spectrum(&values)?);
        let labels = ("Frequency (Hz)", "Amplitude (µm)");
        drawn.panels.push(Panel::chart(frequency, &format!("Its spectrum, {percent} %."), labels, lines).from_zero());
        drawn.value(format!("{percent} %, amplitude"), model.model.amplitude);
        drawn.value(format!("{percent} %, delay"), model.model.delay);
        let peak = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        drawn.value(
            format!("{percent} %, peak of the model over the signal's"),
            100.0 * (peak(&values) / peak(&signal.samples) - 1.0),
        );
    }
    drawn.note(STAND_IN);
    Ok(drawn)
}

/// Figure 4.7.
pub fn amplitude_and_delay(context: &Context) -> anyhow::Result<Drawn> {
    let (mut amplitude, mut delay) = (Vec::new(), Vec::new());
    for signal in signals(context)? {
        let model = signal.fitted()?.model;
        amplitude.push((signal.percent, model.amplitude));
        delay.push((signal.percent, model.delay * 1e3));
    }
    let mut drawn = Drawn::default();
    let panels = [("a", "Amplitude.", "Amplitude A (µm)", amplitude), ("b", "Delay.", "Delay (ms)", delay)];
    for (letter, about, label, points) in panels {
        let lines = vec![line("", BLUE, Pattern::Solid, points.clone()), line("", BLUE, Pattern::Circles, points)];
        drawn.panels.push(Panel::chart(letter, about, ("Crack length (%)", label), lines).from_zero());
    }
    drawn.note(STAND_IN);
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
    for signal in signals(context)? {
        let model = signal.fitted()?.model;
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
        drawn.panels.push(Panel::chart(letter, label, ("Crack length (%)", label), lines).from_zero());
    }
    for percent in [20.0, 80.0] {
        if let Some((_, [exact, model, _])) = rows.iter().find(|r| r.0 == percent) {
            for (k, name) in ["RMS", "FM4", "M8A"].into_iter().enumerate() {
                let apart = 100.0 * (model[k] / exact[k] - 1.0).abs();
                drawn.value(format!("{percent} %, {name} of model and signal apart"), apart);
            }
        }
    }
    drawn.note(STAND_IN);
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
        let mut panel =
            Panel::chart(density, &format!("Its probability density, {count} half cycles."), labels, lines).from_zero();
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
    let mut sweeps: Vec<(&str, f64, Vec<(f64, [f64; 3])>)> = Vec::new();
    let mut rows = Vec::new();
    for damping in steps(0.01, 0.2) {
        let sine = DampedSine { damping, ..PRINTED };
        rows.push((damping, by(sine, cycles(&sine))?));
    }
    sweeps.push(("Damping ratio", MODE.1, rows));
    let mut rows = Vec::new();
    for natural_frequency in steps(1000.0, 5000.0) {
        let sine = DampedSine { natural_frequency, ..PRINTED };
        rows.push((natural_frequency, by(sine, cycles(&sine))?));
    }
    sweeps.push(("Natural frequency (Hz)", MODE.0, rows));
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
            drawn.panels.push(Panel::chart(letter, &about, (label, name), lines).from_zero().mark(mark));
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
