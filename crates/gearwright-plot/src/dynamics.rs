//! Figures of dynamics.

use super::{Band, COLOURS, Chart, Line, MarkedChart, Pattern};
use gearwright_results::dynamics::{BLOW_STEPS, Blow, Response, Sample, Speed};

const CYCLE: &str = "Mesh cycle";
/// Spectra are drawn up to this multiple of the mesh frequency.
const ORDERS: f64 = 6.0;
/// A difference is seen where it exceeds this part of its largest value.
const SEEN: f64 = 0.05;
const PATTERNS: [Pattern; 4] = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];

fn line(name: &str, index: usize, points: Vec<(f64, f64)>) -> Line {
    let (pattern, colour) = (PATTERNS[index % PATTERNS.len()], COLOURS[index % COLOURS.len()]);
    Line { name: name.into(), points, pattern, colour }
}

fn chart(title: &str, labels: [&str; 2], lines: Vec<Line>) -> Chart {
    Chart {
        title: title.into(),
        x_label: labels[0].into(),
        y_label: labels[1].into(),
        lines,
        from_zero: false,
        logarithmic: false,
    }
}

fn heading(title: &str, speed: &Speed) -> String {
    let rpm = speed.speed * 30.0 / std::f64::consts::PI;
    format!("{title}, mesh frequency {:.4} Hz ({rpm:.4} rpm)", rounded(speed.mesh_frequency)).replace(".0000", "")
}

fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn over_cycles(title: &str, speed: &Speed, label: &str, value: impl Fn(&Sample) -> f64) -> MarkedChart {
    let lines = speed.responses.iter().enumerate().map(|(index, response)| {
        let points = response.mesh_cycle.iter().copied().zip(response.samples.iter().map(&value));
        line(&response.state, index, points.collect())
    });
    let chart = chart(&heading(title, speed), [CYCLE, label], lines.collect());
    // contact loss in the colour of its state, from step to step
    let bands = speed.responses.iter().enumerate().flat_map(|(index, response)| {
        let half = 0.5 * step(response);
        let colour = COLOURS[index % COLOURS.len()];
        response.contact_loss().into_iter().map(move |([from, to], _)| Band {
            from: from - half,
            to: to + half,
            colour,
        })
    });
    let bands = bands.collect();
    MarkedChart { chart, marks: Vec::new(), bands, x_range: whole(speed), y_up_to: None }
}

/// Mesh cycles of a step.
fn step(response: &Response) -> f64 {
    match response.mesh_cycle.as_slice() {
        [first, second, ..] => second - first,
        _ => 0.0,
    }
}

/// Mesh cycles of the record.
fn whole(speed: &Speed) -> Option<(f64, f64)> {
    let cycles = &speed.responses.first()?.mesh_cycle;
    Some((*cycles.first()?, *cycles.last()?))
}

/// Mesh cycles in which damage is seen, and one more on either side, within the record.
#[must_use]
pub fn around_damage(speed: &Speed) -> Option<(f64, f64)> {
    let seen = speed.responses.iter().flat_map(|response| {
        let signal = response.difference.iter().flat_map(|difference| &difference.signal);
        let largest = signal.clone().fold(0.0_f64, |most, value| value.abs().max(most));
        let cycles = response.mesh_cycle.iter().zip(signal);
        cycles.filter(move |(_, value)| value.abs() > SEEN * largest).map(|(cycle, _)| *cycle)
    });
    let ends = seen.fold(None, |ends: Option<(f64, f64)>, cycle| match ends {
        None => Some((cycle, cycle)),
        Some((from, to)) => Some((from.min(cycle), to.max(cycle))),
    });
    let ((from, to), (first, last)) = (ends?, whole(speed)?);
    Some(((from - 1.0).max(first), (to + 1.0).min(last)))
}

/// A stretch of a chart over mesh cycles.
#[must_use]
pub fn within(mut chart: MarkedChart, range: (f64, f64)) -> MarkedChart {
    for line in &mut chart.chart.lines {
        line.points.retain(|point| (range.0..=range.1).contains(&point.0));
    }
    chart.bands.retain(|band| band.to >= range.0 && band.from <= range.1);
    chart.x_range = Some(range);
    chart
}

/// Dynamic transmission error of all states over the record.
#[must_use]
pub fn transmission_error(title: &str, speed: &Speed) -> MarkedChart {
    over_cycles(title, speed, "Dynamic transmission error (µm)", |sample| sample.transmission_error * 1e6)
}

/// Force on the drive flanks of all states over the record.
#[must_use]
pub fn mesh_force(title: &str, speed: &Speed) -> MarkedChart {
    over_cycles(title, speed, "Mesh force (kN)", |sample| sample.mesh_force * 1e-3)
}

fn spectral(spectrum: &lpm::Spectrum, mesh_frequency: f64) -> Vec<(f64, f64)> {
    let lines = spectrum.frequency.iter().zip(&spectrum.amplitude).skip(1);
    lines.take_while(|(f, _)| **f <= ORDERS * mesh_frequency).map(|(f, a)| (*f, a * 1e6)).collect()
}

/// Amplitude spectra of the transmission error.
#[must_use]
pub fn spectrum(title: &str, speed: &Speed) -> Chart {
    let each = speed.responses.iter().enumerate();
    let lines = each.map(|(i, r)| line(&r.state, i, spectral(&r.spectrum, speed.mesh_frequency)));
    let labels = ["Frequency (Hz)", "Amplitude of the DTE (µm)"];
    Chart { from_zero: true, ..chart(&heading(title, speed), labels, lines.collect()) }
}

/// Damaged minus healthy over the record.
#[must_use]
pub fn difference(title: &str, speed: &Speed) -> MarkedChart {
    let lines = speed.responses.iter().enumerate().filter_map(|(index, response)| {
        let signal = &response.difference.as_ref()?.signal;
        let points = response.mesh_cycle.iter().zip(signal).map(|(cycle, d)| (*cycle, d * 1e6));
        Some(line(&response.state, index, points.collect()))
    });
    let chart = chart(&heading(title, speed), [CYCLE, "Difference from the healthy pair (µm)"], lines.collect());
    MarkedChart { chart, marks: Vec::new(), bands: Vec::new(), x_range: whole(speed), y_up_to: None }
}

/// Amplitude spectra of the differences.
#[must_use]
pub fn difference_spectrum(title: &str, speed: &Speed) -> Chart {
    let lines = speed.responses.iter().enumerate().filter_map(|(index, response)| {
        let difference = response.difference.as_ref()?;
        Some(line(&response.state, index, spectral(&difference.spectrum, speed.mesh_frequency)))
    });
    let labels = ["Frequency (Hz)", "Amplitude of the difference (µm)"];
    Chart { from_zero: true, ..chart(&heading(title, speed), labels, lines.collect()) }
}

/// Measures over speed, with the names of their files.
#[must_use]
pub fn over_speed(title: &str, speeds: &[Speed]) -> Vec<(&'static str, Chart)> {
    let measure = |label: &str, value: &dyn Fn(&Response) -> f64| {
        let states = speeds.first().map_or(0, |speed| speed.responses.len());
        let lines = (0..states).map(|state| {
            let points = speeds.iter().map(|s| (s.mesh_frequency, value(&s.responses[state]) * 1e6)).collect();
            line(&speeds[0].responses[state].state, state, points)
        });
        Chart { from_zero: true, ..chart(title, ["Mesh frequency (Hz)", label], lines.collect()) }
    };
    vec![
        ("peak_to_peak", measure("Peak-to-peak DTE (µm)", &Response::peak_to_peak)),
        ("rms", measure("RMS of the DTE about its mean (µm)", &Response::rms)),
    ]
}

/// Decay after blows.
#[must_use]
pub fn impulse(title: &str, tests: &[Blow]) -> Chart {
    let lines = tests.iter().enumerate().filter_map(|(index, test)| {
        let reading = test.reading.as_ref()?;
        let records = &reading.run.records;
        let rest = records.last().map_or(0.0, |record| record.transmission_error);
        let told = records.iter().step_by(BLOW_STEPS);
        let points = told.map(|r| (r.time * 1e3, (r.transmission_error - rest) * 1e6));
        Some(line(&format!("{}, cycle {}", test.state, test.mesh_cycle), index, points.collect()))
    });
    chart(title, ["Time (ms)", "Dynamic transmission error from rest (µm)"], lines.collect())
}
