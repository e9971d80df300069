//! `summary.json` and the one-screen summary of dynamics.

use std::fmt::Write as _;

use fecm::dynamics::{ImpulseReading, MeshVibration, ROTATION, Support};
use serde::Serialize;

use super::Work;
use super::{Blow, Difference, Response, Speed, coordinate_names, moving_coordinates};
use gearwright_case::dynamics::schema::Dynamics;
use gearwright_case::spur_pair::schema::SpurPair;
use gearwright_case::{DynamicsCase, Notes};

/// Harmonics of the mesh frequency told.
const HARMONICS: usize = 6;
/// Lines of states on the screen.
const SHOWN: usize = 6;

/// Everything the summary holds.
#[derive(Debug, Serialize)]
pub struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    /// The case with every default spelled out.
    inputs: &'a Dynamics,
    /// Warnings and assumptions.
    #[serde(flatten)]
    notes: &'a Notes,
    /// The spur-pair case it rests on, with every default; contact cells are those of `inputs`.
    spur_pair: &'a SpurPair,
    model: ModelSummary,
    speeds: Vec<SpeedSummary>,
    impulse_tests: Vec<ImpulseSummary>,
    /// Wall time of each stage (s).
    time_s: Times,
}

/// Wall time of stages (s).
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Times {
    /// Condensation of all states.
    pub condensation: f64,
    /// Responses.
    pub response: f64,
    /// Impulse tests.
    pub impulse: f64,
    /// Plots and files.
    pub output: f64,
}

/// The pair as a moving system.
#[derive(Debug, Serialize)]
pub struct ModelSummary {
    /// Mean mesh force (N): torque over base radius of the gear.
    mean_mesh_force_n: f64,
    /// Mass that moves along the line of action where hubs do not give way (kg).
    moving_mass_kg: f64,
    /// Natural frequency of the healthy pair on the mean stiffness of its mesh (Hz); none without speeds.
    natural_frequency_hz: Option<f64>,
    /// Its damping ratio.
    damping_ratio: Option<f64>,
    /// Base radii of pinion and gear (mm).
    base_radius_mm: [f64; 2],
    /// Coordinates of the hubs that move.
    coordinates: Vec<String>,
    /// Natural frequencies of the elastic modes kept of pinion and gear, hub held (Hz), healthy pair.
    elastic_modes_hz: [Vec<f64>; 2],
}

/// A speed.
#[derive(Debug, Serialize)]
pub struct SpeedSummary {
    speed_rpm: f64,
    mesh_frequency_hz: f64,
    time_step_s: f64,
    steps_per_mesh_cycle: usize,
    /// Whether they are chosen by the program.
    steps_chosen: bool,
    steps_per_natural_period: f64,
    /// Error they leave where a harmonic of the mesh frequency meets the natural frequency, over the motion there; none without damping.
    error_at_resonance: Option<f64>,
    states: Vec<StateSummary>,
}

/// A state at a speed.
#[derive(Debug, Serialize)]
pub struct StateSummary {
    state: String,
    mesh_cycles: usize,
    /// Period of the excitation (mesh cycles).
    period_mesh_cycles: usize,
    /// Mesh cycles before the record.
    transient_mesh_cycles: f64,
    /// Whether the motion repeats within the tolerance; none where the transient was given.
    steady: Option<bool>,
    /// Estimate of what is left of the transient, over the variation of the transmission error.
    transient_left: Option<f64>,
    largest_dte_um: f64,
    largest_dte_at_mesh_cycle: f64,
    smallest_dte_um: f64,
    smallest_dte_at_mesh_cycle: f64,
    mean_um: f64,
    /// About the mean.
    rms_um: f64,
    peak_to_peak_um: f64,
    /// Amplitudes at the mesh frequency and its multiples (um).
    harmonics_um: Vec<f64>,
    largest_mesh_force_n: f64,
    largest_mesh_force_at_mesh_cycle: f64,
    /// Largest over mean mesh force.
    dynamic_factor: f64,
    largest_tooth_force_n: f64,
    largest_coast_flank_force_n: f64,
    fraction_without_contact: f64,
    /// From the first to the last step without force on drive flanks.
    contact_loss_mesh_cycles: Vec<[f64; 2]>,
    difference: Option<DifferenceSummary>,
    work: Work,
}

/// An impulse test; no values where nothing oscillates.
#[derive(Debug, Serialize)]
pub struct ImpulseSummary {
    state: String,
    mesh_cycle: f64,
    natural_frequency_hz: Option<f64>,
    damping_ratio_log_decrement: Option<f64>,
    spectrum_peak_hz: Option<f64>,
    damping_ratio_half_power: Option<f64>,
}

/// Exact difference signal.
#[derive(Debug, Serialize)]
pub struct DifferenceSummary {
    rms_um: f64,
    fm4: Option<f64>,
    m8a: Option<f64>,
    largest_um: f64,
    largest_at_mesh_cycle: f64,
    smallest_um: f64,
    smallest_at_mesh_cycle: f64,
    /// Largest line of the spectrum.
    largest_line_um: f64,
    largest_line_hz: f64,
    /// Largest line away from the mesh frequency and its multiples by two lines or more.
    largest_line_between_mesh_orders_um: f64,
    largest_line_between_mesh_orders_hz: f64,
}

/// Collects the summary.
#[must_use]
pub fn summary<'a>(
    case: &'a DynamicsCase,
    vibration: Option<MeshVibration>,
    speeds: &[Speed],
    blows: &[Blow],
    times: Times,
) -> Summary<'a> {
    let pair = &case.statics.pair;
    let radii = [pair.pinion().base_radius(), pair.wheel().base_radius()];
    let force = case.torque / radii[1];
    let inertia = case.options.rotors.each_ref().map(|rotor| rotor.inertia.polar);
    let turning = |index: usize| radii[index].powi(2) / inertia[index];
    let free = case.options.rotors[0].supports[ROTATION] != Support::Fixed;
    let first = speeds.first().and_then(|speed| speed.responses.first());
    Summary {
        program: "gearwright",
        version: env!("CARGO_PKG_VERSION"),
        inputs: &case.inputs,
        notes: &case.notes,
        spur_pair: &case.statics.inputs,
        model: ModelSummary {
            mean_mesh_force_n: force,
            moving_mass_kg: 1.0 / (turning(1) + if free { turning(0) } else { 0.0 }),
            natural_frequency_hz: vibration.map(|v| v.frequency),
            damping_ratio: vibration.map(|v| v.damping_ratio),
            base_radius_mm: radii.map(|r| r * 1e3),
            coordinates: coordinate_names(&moving_coordinates(case)),
            elastic_modes_hz: first.map_or_else(Default::default, |response| response.modes.clone()),
        },
        speeds: speeds.iter().map(|speed| at_speed(speed, force)).collect(),
        impulse_tests: blows.iter().map(impulse).collect(),
        time_s: times,
    }
}

fn impulse(blow: &Blow) -> ImpulseSummary {
    let read = |value: &dyn Fn(&ImpulseReading) -> f64| blow.reading.as_ref().map(value);
    ImpulseSummary {
        state: blow.state.clone(),
        mesh_cycle: blow.mesh_cycle,
        natural_frequency_hz: read(&|r| r.natural_frequency),
        damping_ratio_log_decrement: read(&|r| r.damping_log_decrement),
        spectrum_peak_hz: read(&|r| r.peak_frequency),
        damping_ratio_half_power: read(&|r| r.damping_half_power),
    }
}

fn at_speed(speed: &Speed, mean_force: f64) -> SpeedSummary {
    SpeedSummary {
        speed_rpm: speed.speed * 30.0 / std::f64::consts::PI,
        mesh_frequency_hz: speed.mesh_frequency,
        time_step_s: speed.responses.first().map_or(0.0, |response| response.time_step),
        steps_per_mesh_cycle: speed.resolution.steps,
        steps_chosen: !speed.resolution.given,
        steps_per_natural_period: speed.resolution.natural_steps,
        error_at_resonance: Some(speed.resolution.error).filter(|error| error.is_finite()),
        states: speed.responses.iter().map(|response| of_state(response, speed.mesh_frequency, mean_force)).collect(),
    }
}

fn of_state(response: &Response, mesh_frequency: f64, mean_force: f64) -> StateSummary {
    let (top, top_at) = response.largest(|sample| sample.transmission_error);
    let (bottom, bottom_at) = response.largest(|sample| -sample.transmission_error);
    let (force, force_at) = response.largest(|sample| sample.mesh_force);
    let teeth = response.samples.iter().flat_map(|sample| &sample.pairs);
    let harmonics = (1..=HARMONICS).map(|order| response.spectrum.amplitude_at(order as f64 * mesh_frequency) * 1e6);
    let duration = response.time_step * response.samples.len() as f64;
    StateSummary {
        state: response.state.clone(),
        mesh_cycles: (duration * mesh_frequency).round() as usize,
        period_mesh_cycles: response.period,
        transient_mesh_cycles: response.transient,
        steady: response.steady,
        transient_left: response.transient_left,
        largest_dte_um: top * 1e6,
        largest_dte_at_mesh_cycle: top_at,
        smallest_dte_um: -bottom * 1e6,
        smallest_dte_at_mesh_cycle: bottom_at,
        mean_um: response.mean() * 1e6,
        rms_um: response.rms() * 1e6,
        peak_to_peak_um: response.peak_to_peak() * 1e6,
        harmonics_um: harmonics.collect(),
        largest_mesh_force_n: force,
        largest_mesh_force_at_mesh_cycle: force_at,
        dynamic_factor: force / mean_force,
        largest_tooth_force_n: teeth.fold(0.0, |most, pair| pair.1.max(most)),
        largest_coast_flank_force_n: response.largest(|sample| sample.back_force).0,
        fraction_without_contact: response.without_contact(),
        contact_loss_mesh_cycles: response.contact_loss().into_iter().map(|(stretch, _)| stretch).collect(),
        difference: response.difference.as_ref().map(|d| difference(response, d, mesh_frequency)),
        work: response.work,
    }
}

fn difference(response: &Response, difference: &Difference, mesh_frequency: f64) -> DifferenceSummary {
    let at = |sign: f64| {
        let values = difference.signal.iter().map(|d| sign * d).zip(response.mesh_cycle.iter().copied());
        values.fold((f64::NEG_INFINITY, 0.0), |most, next| if next.0 > most.0 { next } else { most })
    };
    let (top, bottom) = (at(1.0), at(-1.0));
    let spectrum = &difference.spectrum;
    let (line_hz, line) = spectrum.peak(0.0, f64::INFINITY).unwrap_or_default();
    let step = spectrum.frequency.get(1).copied().unwrap_or(1.0);
    let between = |f: f64| (f - (f / mesh_frequency).round() * mesh_frequency).abs() > 1.5 * step;
    let lines = spectrum.frequency.iter().copied().zip(spectrum.amplitude.iter().copied());
    let (off_hz, off) = lines
        .filter(|(f, _)| between(*f))
        .fold((0.0, 0.0), |most: (f64, f64), next| if next.1 > most.1 { next } else { most });
    DifferenceSummary {
        rms_um: difference.rms * 1e6,
        fm4: difference.fm4,
        m8a: difference.m8a,
        largest_um: top.0 * 1e6,
        largest_at_mesh_cycle: top.1,
        smallest_um: -bottom.0 * 1e6,
        smallest_at_mesh_cycle: bottom.1,
        largest_line_um: line * 1e6,
        largest_line_hz: line_hz,
        largest_line_between_mesh_orders_um: off * 1e6,
        largest_line_between_mesh_orders_hz: off_hz,
    }
}

/// The one-screen summary; `steps` tells those of a mesh cycle.
#[must_use]
pub fn screen(case: &DynamicsCase, s: &Summary<'_>, steps: Option<&str>) -> String {
    let mut text = String::new();
    let title = if case.inputs.title.is_empty() { "gear pair dynamics" } else { &case.inputs.title };
    let _ = writeln!(text, "{title}");
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<30} {value}");
    };
    let m = &s.model;
    line(
        "moving mass, mean mesh force",
        format!("{:.4} kg, {:.1} N; {} coordinate(s)", m.moving_mass_kg, m.mean_mesh_force_n, m.coordinates.len()),
    );
    if let Some(steps) = steps {
        line("steps a mesh cycle", steps.to_owned());
    }
    if let [speed] = s.speeds.as_slice() {
        line(
            "speed",
            format!(
                "{:.1} rpm, mesh frequency {:.2} Hz, time step {:.3e} s",
                speed.speed_rpm, speed.mesh_frequency_hz, speed.time_step_s
            ),
        );
        for state in speed.states.iter().take(SHOWN) {
            line(&short(&state.state), of_one(state));
            if let Some(d) = &state.difference {
                line("  difference", of_difference(d));
            }
        }
    } else {
        let lines: usize = s.speeds.iter().map(|speed| speed.states.len()).sum();
        for (speed, state) in s.speeds.iter().flat_map(|v| v.states.iter().map(move |state| (v, state))).take(2 * SHOWN)
        {
            line(&format!("{:.0} Hz, {}", speed.mesh_frequency_hz, short(&state.state)), of_one(state));
        }
        if lines > 2 * SHOWN {
            line("", format!("and {} more in over_speed.csv", lines - 2 * SHOWN));
        }
    }
    for i in s.impulse_tests.iter().take(SHOWN) {
        let read = match (i.natural_frequency_hz, i.damping_ratio_log_decrement, i.damping_ratio_half_power) {
            (Some(f), Some(z), Some(h)) => format!("{f:.1} Hz, damping ratio {z:.4} (half power {h:.4})"),
            _ => "nothing oscillates".into(),
        };
        line(&format!("{}, blow at cycle {:.2}", short(&i.state), i.mesh_cycle), read);
    }
    let all = || s.speeds.iter().flat_map(|speed| &speed.states);
    let unsteady = all().filter(|state| state.steady == Some(false)).count();
    if unsteady > 0 {
        line("not steady", format!("{unsteady} run(s) reached steady_limit_mesh_cycles: see summary.json"));
    }
    let failed: usize = all().map(|state| state.work.not_converged).sum();
    if failed > 0 {
        line("not converged", format!("the contact of {failed} step(s): see summary.json"));
    }
    let steps: usize = all().map(|state| state.work.steps).sum();
    let defect = all().map(|w| w.work.worst_defect_j / w.work.energy_scale_j.max(1e-30)).fold(0.0, f64::max);
    let worst = all().map(|w| w.work.worst_complementarity).fold(0.0, f64::max);
    if steps > 0 {
        line("steps", format!("{steps}; energy balance to {defect:.1e}, complementarity to {worst:.1e}"));
    }
    let t = &s.time_s;
    let stages =
        [("condensation", t.condensation), ("response", t.response), ("impulse tests", t.impulse), ("files", t.output)];
    let spent: Vec<String> =
        stages.iter().filter(|stage| stage.1 > 0.001).map(|(name, seconds)| format!("{seconds:.2} s {name}")).collect();
    line("time", spent.join(", "));
    text
}

fn of_one(state: &StateSummary) -> String {
    let loss = match state.contact_loss_mesh_cycles.len() {
        0 => String::new(),
        count => format!(", contact lost {count} times"),
    };
    format!(
        "DTE {:.2} to {:.2} um, {:.2} um at the mesh frequency, largest force {:.2} of the mean{loss}",
        state.smallest_dte_um,
        state.largest_dte_um,
        state.harmonics_um.first().copied().unwrap_or_default(),
        state.dynamic_factor
    )
}

fn of_difference(d: &DifferenceSummary) -> String {
    let shown = |value: Option<f64>, digits: usize| value.map_or("-".to_owned(), |v| format!("{v:.digits$}"));
    format!(
        "{:.2} um at cycle {:.2}, RMS {:.3} um, FM4 {}, M8A {}; {:.2} um at {:.0} Hz",
        d.largest_um,
        d.largest_at_mesh_cycle,
        d.rms_um,
        shown(d.fm4, 2),
        shown(d.m8a, 0),
        d.largest_line_um,
        d.largest_line_hz
    )
}

/// A name that leaves room beside it.
fn short(name: &str) -> String {
    if name.chars().count() <= 22 {
        name.to_owned()
    } else {
        format!("{}...", name.chars().take(19).collect::<String>())
    }
}
