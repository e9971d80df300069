//! What a transmission run says in short: `summary.json` and one screen.

use std::f64::consts::PI;
use std::fmt::Write as _;

use gear_geom::MeshSite;
use hums::spectrum::{Spectrum, Window};
use planetary::engine::{Deviation, STAGES};
use serde::Serialize;
use serde_json::{Value as Json, json};

use super::tables::{share, statistics};
use super::{Averaging, Findings, State};
use gearwright_case::TransmissionCase;

/// Wall times (s).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Times {
    /// Contact models and mesh tables.
    pub contact: f64,
    /// Housing.
    pub housing: f64,
    /// Natural frequencies.
    pub modes: f64,
    /// Runs in time.
    pub vibration: f64,
    /// Averages, difference signals, indicators.
    pub signals: f64,
    /// Tables and figures.
    pub output: f64,
}

/// `summary.json`.
#[must_use]
pub fn summary(case: &TransmissionCase, findings: &Findings, times: Times) -> Json {
    let (train, speeds) = (&case.train, &case.speeds);
    let rpm = |speed: f64| speed * 30.0 / PI;
    let meshes: Vec<Json> = MeshSite::ALL
        .iter()
        .zip(findings.mean_stiffness)
        .map(|(&site, stiffness)| {
            let pair = train.pair(site);
            json!({
                "pair": match site { MeshSite::SunPlanet => "sun-planet", MeshSite::PlanetRing => "planet-ring" },
                "contact_ratio": pair.contact_ratio(),
                "working_pressure_angle_deg": pair.working_pressure_angle().to_degrees(),
                "normal_backlash_um": pair.normal_backlash() * 1e6,
                "mean_force_n": findings.mean_force,
                "mean_stiffness_n_per_um": stiffness.map(|k| k * 1e-6),
                "in_phase": train.is_in_phase(site),
                "mesh_cycle_at_start": (0..train.planets()).filter_map(|p| train.mesh_offset(site, p).ok()).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({
        "program": "gearwright",
        "version": env!("CARGO_PKG_VERSION"),
        "inputs": case.inputs,
        "warnings": case.notes.warnings,
        "assumptions": case.notes.assumptions,
        "train": {
            "sun_rpm": rpm(speeds.sun),
            "carrier_rpm": rpm(speeds.carrier),
            "planet_rpm": rpm(speeds.planet),
            "mesh_frequency_hz": speeds.mesh_frequency,
            "planet_pass_frequency_hz": speeds.planet_pass_frequency,
            "sun_ring_period_carrier_turns": train.sun_ring_period(),
            "hunting_period_carrier_turns": train.hunting_period(),
            "sun_tooth_0_deg": train.sun_tooth_angle().to_degrees(),
        },
        "meshes": meshes,
        "natural_frequencies_hz": findings.modes.iter().map(|mode| mode.frequency).collect::<Vec<_>>(),
        "housing_frequencies_hz": findings.housing.iter().map(|(f, _)| *f).collect::<Vec<_>>(),
        "resolution": resolution(case, findings),
        "states": findings.states.iter().map(|state| state_summary(findings, state)).collect::<Vec<_>>(),
        "time_s": times,
    })
}

/// Band, steps, and what they leave.
fn resolution(case: &TransmissionCase, findings: &Findings) -> Json {
    let sampling = &case.sampling;
    let left = |deviation: Option<Deviation>| {
        deviation.map(|left| json!({ "acceleration": left.acceleration, "mesh_force": left.mesh_force }))
    };
    json!({
        "band_hz": sampling.band,
        "samples_per_mesh_cycle": sampling.samples_per_cycle,
        "sample_rate_hz": sampling.samples_per_cycle as f64 * case.speeds.mesh_frequency,
        "steps_per_mesh_cycle": sampling.steps_per_cycle(),
        "stages_per_step": STAGES,
        "table_positions": case.inputs.analysis.table_positions,
        "left_by_steps": left(findings.resolution.steps),
        "left_by_transient": left(findings.resolution.transient),
        "source": "root mean square of the change over that of the variation, in the band, healthy state: steps half as long over a stretch from equilibrium; a transient one \
                   planet pass shorter",
    })
}

fn state_summary(findings: &Findings, state: &State) -> Json {
    let sensors: Vec<Json> = findings
        .shown(false)
        .map(|(k, sensor)| {
            let judged = &state.judged[k];
            let (frequency, amplitude) = largest_line(&state.signals[k], state.run.sample_time).unwrap_or_default();
            let of = |averaging: Averaging, signal: &str, name: &str| judged.value(averaging, signal, name);
            json!({
                "sensor": sensor.name,
                "angle_deg": sensor.angle_deg,
                "rms_g": of(Averaging::None, "raw", "rms"),
                "peak_g": of(Averaging::None, "raw", "peak"),
                "largest_line_hz": frequency,
                "largest_line_g": amplitude,
                "fm4": findings.periods.iter().map(|period| json!({
                    "average": period.averaging.name(),
                    "approximate_1": of(period.averaging, "difference_1", "fm4"),
                    "exact": of(period.averaging, "exact_difference", "fm4"),
                })).collect::<Vec<_>>(),
            })
        })
        .collect();
    let meshes: Vec<Json> = state
        .run
        .meshes
        .iter()
        .map(|mesh| {
            let [mean, deviation, least, greatest] = statistics(&mesh.force);
            json!({
                "mesh": mesh.name,
                "share": share(state, &mesh.name),
                "mean_n": mean,
                "standard_deviation_n": deviation,
                "least_n": least,
                "greatest_n": greatest,
                "contact_losses": mesh.losses,
            })
        })
        .collect();
    let stats = &state.run.stats;
    json!({
        "state": state.name,
        "samples": state.run.len(),
        "sample_time_s": state.run.sample_time,
        "change_from_period_to_period": state.change.or(findings.resolution.transient.and_then(|left| left.acceleration)),
        "sensors": sensors,
        "meshes": meshes,
        "work": {
            "steps": stats.steps,
            "newton_iterations": stats.newton_iterations,
            "fallbacks": stats.fallbacks,
            "worst_residual_m": stats.worst_residual,
            "time_s": stats.time.as_secs_f64(),
        },
    })
}

/// Frequency (Hz) and amplitude of the largest line of a signal.
#[must_use]
pub fn largest_line(signal: &[f64], time_step: f64) -> Option<(f64, f64)> {
    let spectrum = Spectrum::of(signal, Window::Rectangular).ok()?;
    let lines = spectrum.frequencies(1.0 / time_step).into_iter().zip(spectrum.amplitudes()).skip(1);
    lines.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// States and natural frequencies on the screen, at most.
const LINES: usize = 6;

/// The one-screen summary.
#[must_use]
pub fn screen(case: &TransmissionCase, findings: &Findings, times: &Times) -> String {
    let mut text = String::new();
    // Writing to a text cannot fail.
    if !case.inputs.title.is_empty() {
        let _ = writeln!(text, "{}", case.inputs.title);
    }
    let speeds = &case.speeds;
    let rpm = |speed: f64| speed * 30.0 / PI;
    let _ = writeln!(
        text,
        "speeds     sun {:.1} rpm, carrier {:.1} rpm; planetary mesh {:.1} Hz, planet pass {:.3} Hz",
        rpm(speeds.sun),
        rpm(speeds.carrier),
        speeds.mesh_frequency,
        speeds.planet_pass_frequency
    );
    let frequencies: Vec<String> = findings
        .modes
        .iter()
        .map(|mode| mode.frequency)
        .filter(|f| *f > 1.0)
        .take(2 * LINES)
        .map(|f| format!("{f:.0}"))
        .collect();
    let _ = writeln!(text, "natural    {} .. Hz (natural_frequencies.csv)", frequencies.join(", "));
    if let Some(state) = findings.states.first() {
        let _ = writeln!(
            text,
            "record     {} carrier turns, {} samples of {:.2} us, band {:.0} Hz, {} steps a mesh cycle",
            case.inputs.run.carrier_turns,
            state.run.len(),
            state.run.sample_time * 1e6,
            case.sampling.band,
            case.sampling.steps_per_cycle()
        );
        let left = |deviation: Option<Deviation>| match deviation.map(|left| (left.acceleration, left.mesh_force)) {
            Some((acceleration, force)) => {
                let percent = |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.2} %", 100.0 * value));
                format!("{} of acceleration, {} of mesh force", percent(acceleration), percent(force))
            }
            None => "not measured".into(),
        };
        let resolution = &findings.resolution;
        let _ = writeln!(
            text,
            "left       by steps {}; by transient {}",
            left(resolution.steps),
            left(resolution.transient)
        );
    }
    let _ = writeln!(text, "\n{:<24} {:>10} {:>22} {:>10}", "state", "mesh kN", "least to greatest kN", "share");
    for state in findings.states.iter().take(LINES) {
        // the worst of all meshes
        let worst = state.run.meshes.iter().max_by(|a, b| statistics(&a.force)[3].total_cmp(&statistics(&b.force)[3]));
        let Some(mesh) = worst else { continue };
        let [mean, _, least, greatest] = statistics(&mesh.force);
        let own = share(state, &mesh.name).map_or("-".to_owned(), |share| format!("{share:.4}"));
        let range = format!("{:.3} to {:.3}", least * 1e-3, greatest * 1e-3);
        let _ = writeln!(text, "{:<24} {:>10.3} {range:>22} {own:>10}  {}", short(&state.name), mean * 1e-3, mesh.name);
    }
    let shown: Vec<_> = findings.shown(false).take(2).collect();
    for (k, sensor) in shown {
        let averaging = findings.shortest();
        let _ = writeln!(
            text,
            "\n{:<24} {:>10} {:>10} {:>14} {:>14}",
            short(&sensor.name),
            "rms g",
            "peak g",
            "FM4 approx. 1",
            "FM4 exact"
        );
        for state in findings.states.iter().take(LINES) {
            let of = |averaging, signal: &str, name: &str| {
                let value = state.judged[k].value(averaging, signal, name);
                value.map_or("-".to_owned(), |value| format!("{value:.3}"))
            };
            let _ = writeln!(
                text,
                "{:<24} {:>10} {:>10} {:>14} {:>14}",
                short(&state.name),
                of(Averaging::None, "raw", "rms"),
                of(Averaging::None, "raw", "peak"),
                of(averaging, "difference_1", "fm4"),
                of(averaging, "exact_difference", "fm4")
            );
        }
    }
    let Times { contact, housing, vibration, .. } = times;
    let _ = writeln!(text, "\nseconds    contact {contact:.1}, housing {housing:.1}, vibration {vibration:.1}");
    text
}

/// A name that leaves room beside it.
fn short(name: &str) -> String {
    if name.chars().count() <= 23 {
        name.to_owned()
    } else {
        format!("{}...", name.chars().take(20).collect::<String>())
    }
}
