//! Lumped-parameter dynamics: the rest of chapter 3, and chapter 7.

use gearwright_plot::{Line, Mark, Pattern};
use gearwright_results::lumped::{DamageResult, Lumped, SweepResult, TimeResponse};

use super::chapter3::CRACKS;
use super::scheme;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Panel, colour::*, line};
use crate::reproduce::statics::{bottom, top};

const CYCLE: &str = "Mesh cycle";
const DTE: &str = "Dynamic transmission error (µm)";
const CURVES: &str = "Stiffness and static error are those of a plane-stress model of the pair; input rotation prescribed, mesh damper kept in flight.";
/// Spectra are shown up to here (Hz).
const HIGHEST: f64 = 8000.0;

fn of<'a>(run: &'a Lumped, name: &str) -> anyhow::Result<&'a TimeResponse> {
    run.findings.time.iter().find(|t| t.state == name).ok_or_else(|| anyhow::anyhow!("there is no state {name}"))
}

fn over_time(response: &TimeResponse, from: f64, to: f64) -> Vec<(f64, f64)> {
    let r = &response.response;
    let points = r.mesh_cycle.iter().zip(&r.transmission_error).map(|(t, x)| (*t, x * 1e6));
    points.filter(|p| (from..=to).contains(&p.0)).collect()
}

/// Amplitudes (um) over frequency (Hz), without the mean.
fn amplitudes(spectrum: &lpm::Spectrum) -> Vec<(f64, f64)> {
    let lines = spectrum.frequency.iter().zip(&spectrum.amplitude).skip(1).map(|(f, a)| (*f, a * 1e6));
    lines.take_while(|l| l.0 <= HIGHEST).collect()
}

/// Figure 3.15.
pub fn at_900(context: &Context) -> anyhow::Result<Drawn> {
    let (cracks, pits) = (context.lumped("lumped-900hz.toml")?, context.lumped("lumped-900hz-pits.toml")?);
    let mut drawn = Drawn::default();
    let panels = [
        ("a", "All teeth healthy.", of(&cracks, "healthy")?, (0.0, 3.0)),
        ("b", "A pit of 12.7 x 2.76 mm on a pinion tooth.", of(&pits, "pit 12.7 x 2.76 mm")?, (13.0, 20.0)),
        ("c", "A root crack of 20 % on a pinion tooth.", of(&cracks, "crack 20 %")?, (13.0, 20.0)),
    ];
    let cracked = context.dynamics("cracked-pinion-plane.toml", 900.0, &[0])?;
    let pitted = context.dynamics("pitted-pitch.toml", 900.0, &[1])?;
    let full = [Some(&cracked.healthy), pitted.damaged.first(), cracked.damaged.first()];
    for ((letter, about, response, (from, to)), full) in panels.into_iter().zip(full) {
        let mut lines = vec![line("lumped parameters", BLACK, Pattern::Solid, over_time(response, from, to))];
        if let Some(motion) = full {
            let points = motion.over_cycles().into_iter().filter(|p| (from..=to).contains(&p.0)).step_by(2).collect();
            lines.push(line("finite elements", BLUE, Pattern::Circles, points));
        }
        drawn.panels.push(Panel::chart(letter, about, (CYCLE, DTE), lines));
    }
    drawn.note(
        "(a) and (c) from the plane-stress curves, (b) from the three-dimensional ones, which are some 8 % stiffer.",
    );
    Ok(drawn)
}

fn damaged(
    drawn: &mut Drawn,
    run: &Lumped,
    names: &[(&str, &'static str, Pattern)],
    zoom: (f64, f64),
) -> anyhow::Result<()> {
    let lines = |from: f64, to: f64| -> anyhow::Result<Vec<Line>> {
        let mut lines = vec![line("healthy", BLACK, Pattern::Solid, over_time(of(run, "healthy")?, from, to))];
        for (name, colour, pattern) in names {
            lines.push(line(name, colour, *pattern, over_time(of(run, name)?, from, to)));
        }
        Ok(lines)
    };
    let zero = Mark { at: 0.0, upright: false, label: String::new(), colour: PURPLE, dotted: true };
    let whole = Panel::chart("a", "One rotation of the pinion.", (CYCLE, DTE), lines(0.0, 27.0)?);
    drawn.panels.push(whole.between(0.0, 27.0).mark(zero.clone()));
    let zoomed = Panel::chart("b", "After the damaged tooth engages.", (CYCLE, DTE), lines(zoom.0, zoom.1)?);
    drawn.panels.push(zoomed.between(zoom.0, zoom.1).mark(zero));
    if let Some((name, ..)) = names.last() {
        let response = of(run, name)?;
        let points = over_time(response, 13.9, 27.0);
        let ((high, most), (low, least)) = (top(&points), bottom(&points));
        drawn.value("largest, maximum", most);
        drawn.value("largest, cycle of the maximum", high);
        drawn.value("largest, minimum", least);
        drawn.value("largest, cycle of the minimum", low);
        // the first flight after the damaged tooth engages
        if let Some(flight) = response.response.separations.iter().find(|s| s.start > 14.0) {
            drawn.value("largest, contact lost", flight.start);
            drawn.value("largest, contact found", flight.end);
        }
    }
    Ok(())
}

/// Figure 3.16.
pub fn pits_at_900(context: &Context) -> anyhow::Result<Drawn> {
    let run = context.lumped("lumped-900hz-pits.toml")?;
    let mut drawn = Drawn::default();
    let names = [
        ("pit 12.7 x 2.76 mm", BLUE, Pattern::Dashed),
        ("pit 20.32 x 3.94 mm", RED, Pattern::Dotted),
        ("pit 25.4 x 4.63 mm", GREEN, Pattern::DashDotted),
    ];
    damaged(&mut drawn, &run, &names, (13.5, 20.0))?;
    drawn.note("Curves of the three-dimensional model; the damaged tooth engages at 14 mesh cycles.");
    Ok(drawn)
}

fn crack_names() -> [(&'static str, &'static str, Pattern); 3] {
    let [a, b, c] = CRACKS;
    [("crack 20 %", a.0, a.1), ("crack 50 %", b.0, b.1), ("crack 80 %", c.0, c.1)]
}

/// Figure 3.17.
pub fn cracks_at_900(context: &Context) -> anyhow::Result<Drawn> {
    let run = context.lumped("lumped-900hz.toml")?;
    let mut drawn = Drawn::default();
    damaged(&mut drawn, &run, &crack_names(), (13.5, 20.0))?;
    drawn.note(CURVES);
    Ok(drawn)
}

/// Figure 7.2.
pub fn healthy_at_1800(context: &Context) -> anyhow::Result<Drawn> {
    let run = context.lumped("lumped-resonance.toml")?;
    let healthy = of(&run, "healthy")?;
    let mut drawn = Drawn::default();
    let lines = vec![line("", BLACK, Pattern::Solid, over_time(healthy, 0.0, 3.0))];
    drawn.panels.push(Panel::chart("a", "Three mesh cycles at 1800 Hz.", (CYCLE, DTE), lines).between(0.0, 3.0));
    let lines = vec![line("", BLACK, Pattern::Solid, amplitudes(&healthy.spectrum))];
    drawn.panels.push(Panel::chart("b", "Spectrum.", ("Frequency (Hz)", "Amplitude (µm)"), lines).zero_based());
    drawn.note(CURVES);
    Ok(drawn)
}

/// Looks of chapter 7: healthy, 20 and 50 %.
const CHAPTER7: [(&str, &str); 3] = [("healthy", BLACK), ("crack 20 %", BLUE), ("crack 50 %", RED)];

fn compared(run: &Lumped, value: impl Fn(&TimeResponse) -> Vec<(f64, f64)>) -> anyhow::Result<Vec<Line>> {
    // the healthy line on top of the others
    let lines =
        CHAPTER7.iter().rev().map(|(name, colour)| Ok(line(name, colour, Pattern::Solid, value(of(run, name)?))));
    lines.collect()
}

/// Figure 7.3.
pub fn cracks_at_1800(context: &Context) -> anyhow::Result<Drawn> {
    let run = context.lumped("lumped-resonance.toml")?;
    let mut drawn = Drawn::default();
    let lines = compared(&run, |r| over_time(r, 0.0, 27.0))?;
    drawn
        .panels
        .push(Panel::chart("a", "One rotation of the pinion at 1800 Hz.", (CYCLE, DTE), lines).between(0.0, 27.0));
    let lines = compared(&run, |r| amplitudes(&r.spectrum))?;
    drawn.panels.push(Panel::chart("b", "Spectrum.", ("Frequency (Hz)", "Amplitude (µm)"), lines).zero_based());
    let case = context.spur_pair("cracked-pinion-plane.toml")?;
    let side = case.pair.working_side(gear_geom::Member::Pinion);
    let lengths = [(0.2, BLUE, Pattern::Solid), (0.5, RED, Pattern::Solid)];
    let drawing = scheme::cracks(case.pair.pinion(), side, &lengths)?;
    drawn.panels.push(Panel::drawing("c", "The cracks in the mesh of the tooth.", drawing));
    drawn.note(CURVES);
    Ok(drawn)
}

fn swept(sweep: &SweepResult) -> Vec<(f64, f64)> {
    sweep.points.iter().map(|p| (p.mesh_frequency, p.measure.peak_to_peak * 1e6)).collect()
}

/// Frequencies of a sweep about its largest rise from one point to the next: where it jumps.
fn jump(sweep: &SweepResult) -> f64 {
    let points = swept(sweep);
    let rises = points.windows(2).map(|w| (0.5 * (w[0].0 + w[1].0), (w[1].1 - w[0].1).abs()));
    top(&rises.collect::<Vec<_>>()).0
}

/// Figure 7.4.
pub fn resonance(context: &Context) -> anyhow::Result<Drawn> {
    let run = context.lumped("lumped-resonance.toml")?;
    let mut drawn = Drawn::default();
    let curves = |names: &[(&str, &'static str)]| {
        let mut lines = Vec::new();
        for (name, colour) in names {
            for sweep in run.findings.sweeps.iter().filter(|s| s.state == *name) {
                let (direction, pattern) = if sweep.up { ("up", Pattern::Solid) } else { ("down", Pattern::Dashed) };
                lines.push(line(&format!("{name}, {direction}"), colour, pattern, swept(sweep)));
            }
        }
        lines
    };
    let labels = ("Mesh frequency (Hz)", "Peak-to-peak DTE (µm)");
    drawn
        .panels
        .push(Panel::chart("a", "Healthy pair, speed up and down.", labels, curves(&CHAPTER7[..1])).zero_based());
    drawn.panels.push(Panel::chart("b", "With root cracks on a pinion tooth.", labels, curves(&CHAPTER7)).zero_based());
    let healthy: Vec<&SweepResult> = run.findings.sweeps.iter().filter(|s| s.state == "healthy").collect();
    for sweep in healthy {
        drawn.value(if sweep.up { "jump up" } else { "jump down" }, jump(sweep));
    }
    drawn.note(CURVES);
    Ok(drawn)
}

/// Distance from the mesh harmonics (Hz) of the largest line that is none of them.
fn sideband(response: &TimeResponse) -> f64 {
    let mesh = response.response.mesh_frequency;
    let apart = |f: f64| (f - (f / mesh).round() * mesh).abs();
    let others = amplitudes(&response.spectrum).into_iter().filter(|l| l.0 > 0.5 * mesh && apart(l.0) > 1e-3 * mesh);
    apart(top(&others.collect::<Vec<_>>()).0)
}

/// Figure 7.5.
pub fn two_branches(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    for (side, file, letters) in
        [("Lower", "lumped-1750hz-lower.toml", ["a", "b"]), ("Upper", "lumped-1850hz-upper.toml", ["c", "d"])]
    {
        let run = context.lumped(file)?;
        let healthy = of(&run, "healthy")?;
        let speed = healthy.response.mesh_frequency;
        let lines = compared(&run, |r| over_time(r, 13.0, 23.0))?;
        let about = format!("{side} branch at {speed} Hz.");
        drawn.panels.push(Panel::chart(letters[0], &about, (CYCLE, DTE), lines).between(13.0, 23.0));
        let lines = compared(&run, |r| amplitudes(&r.spectrum))?;
        let about = format!("Its spectrum, {} branch.", side.to_lowercase());
        drawn.panels.push(Panel::chart(letters[1], &about, ("Frequency (Hz)", "Amplitude (µm)"), lines).zero_based());
        let apart = healthy.response.separated_fraction();
        let largest = healthy.response.maximum().value * 1e6;
        let apart = 100.0 * apart;
        drawn.note(format!(
            "{side} branch, healthy: largest error {largest:.1} µm, contact lost {apart:.0} % of the time."
        ));
        if side == "Upper" {
            drawn.value("sidebands, distance from the mesh harmonics", sideband(of(&run, "crack 50 %")?));
        }
    }
    drawn.note("The dissertation shows both at 1750 Hz; with the curves here the upper branch ends a little above that: 1850 Hz instead.");
    drawn.note(CURVES);
    Ok(drawn)
}

/// The damage-induced response of a state at a speed.
fn difference<'a>(run: &'a Lumped, state: &str, frequency: f64) -> anyhow::Result<&'a DamageResult> {
    let mut all = run.findings.damage.iter();
    let found = all.find(|d| d.state == state && (d.mesh_frequency - frequency).abs() < 1e-6);
    found.ok_or_else(|| anyhow::anyhow!("there is no damage-induced response of {state} at {frequency} Hz"))
}

/// A difference signal over the mesh cycle (um).
fn difference_points(result: &DamageResult) -> Vec<(f64, f64)> {
    let cycles = &result.response.damaged.response.mesh_cycle;
    cycles.iter().zip(&result.response.difference).map(|(t, x)| (*t, x * 1e6)).collect()
}

/// Figure 7.6.
pub fn damage_response(context: &Context) -> anyhow::Result<Drawn> {
    let run = context.lumped("lumped-900hz.toml")?;
    let result = difference(&run, "crack 20 %", 1800.0)?;
    let mut drawn = Drawn::default();
    let lines = vec![line("", BLACK, Pattern::Solid, difference_points(result))];
    let labels = (CYCLE, "Damage-induced response (µm)");
    drawn
        .panels
        .push(Panel::chart("a", "Damaged minus healthy, crack of 20 %, 1800 Hz.", labels, lines).between(0.0, 27.0));
    let spectrum = amplitudes(&result.response.spectrum);
    drawn.value("frequency of the largest line", top(&spectrum).0);
    let lines = vec![line("", BLACK, Pattern::Solid, spectrum)];
    drawn.panels.push(Panel::chart("b", "Spectrum.", ("Frequency (Hz)", "Amplitude (µm)"), lines).zero_based());
    drawn.note(CURVES);
    Ok(drawn)
}

/// Figure 7.7.
pub fn damage_speeds(context: &Context) -> anyhow::Result<Drawn> {
    let run = context.lumped("lumped-900hz.toml")?;
    let mut drawn = Drawn::default();
    for (letter, state) in [("a", "crack 20 %"), ("b", "crack 50 %")] {
        let found = run.findings.damage_speeds.iter().find(|d| d.state == state);
        let Some(speeds) = found else { anyhow::bail!("there is no speed range of {state}") };
        // a line with more than a quarter of the peak to peak never dies out: the damaged pair has gone over to another motion
        let (kept, gone): (Vec<&[f64; 4]>, Vec<&[f64; 4]>) = speeds.rows.iter().partition(|r| r[2] <= 0.25 * r[3]);
        if !gone.is_empty() {
            let list = gone.iter().map(|r| format!("{:.0}", r[0])).collect::<Vec<_>>().join(", ");
            drawn.note(format!(
                "{state}: left out at {list} Hz, where the damage carries the pair to its other motion for good."
            ));
        }
        let points: Vec<(f64, f64)> = kept.iter().map(|r| (r[0], r[2] * 1e6)).collect();
        let quiet = speeds.static_amplitude * 1e6;
        let ends = points.first().into_iter().chain(points.last()).map(|p| (p.0, quiet)).collect();
        let about = format!("Largest line of the damage-induced spectrum over speed, {state}.");
        let lines = vec![line("response", BLACK, Pattern::Solid, points), line("static", BLUE, Pattern::Dashed, ends)];
        let labels = ("Mesh frequency (Hz)", "Largest amplitude (µm)");
        drawn.panels.push(Panel::chart(letter, &about, labels, lines).zero_based());
        drawn.value(format!("{state}, static amplitude"), quiet);
    }
    drawn.note(CURVES);
    Ok(drawn)
}
