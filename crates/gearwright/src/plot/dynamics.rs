//! Figures of dynamics.

use super::{COLOURS, Chart, Line, Pattern};
use crate::run::dynamics::findings::{Response, Speed};
use crate::run::dynamics::simulate::Sample;

const CYCLE: &str = "Mesh cycle";
/// Spectra are drawn up to this multiple of the mesh frequency.
const ORDERS: f64 = 6.0;
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

fn over_cycles(title: &str, speed: &Speed, label: &str, value: impl Fn(&Sample) -> f64) -> Chart {
    let lines = speed.responses.iter().enumerate().map(|(index, response)| {
        let points = response.mesh_cycle.iter().copied().zip(response.samples.iter().map(&value));
        line(&response.state, index, points.collect())
    });
    chart(&heading(title, speed), [CYCLE, label], lines.collect())
}

/// Dynamic transmission error of all states over the record.
#[must_use]
pub fn transmission_error(title: &str, speed: &Speed) -> Chart {
    over_cycles(title, speed, "Dynamic transmission error (µm)", |sample| sample.transmission_error * 1e6)
}

/// Force on the drive flanks of all states over the record.
#[must_use]
pub fn mesh_force(title: &str, speed: &Speed) -> Chart {
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
pub fn difference(title: &str, speed: &Speed) -> Chart {
    let lines = speed.responses.iter().enumerate().filter_map(|(index, response)| {
        let signal = &response.difference.as_ref()?.signal;
        let points = response.mesh_cycle.iter().zip(signal).map(|(cycle, d)| (*cycle, d * 1e6));
        Some(line(&response.state, index, points.collect()))
    });
    chart(&heading(title, speed), [CYCLE, "Difference from the healthy pair (µm)"], lines.collect())
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
