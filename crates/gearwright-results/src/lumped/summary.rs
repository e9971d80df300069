//! `summary.json` and the one-screen summary of lumped-parameter dynamics.

use std::fmt::Write as _;

use lpm::{BranchEnd, Input, LpmError, Model, Response, Supports};
use serde::Serialize;

use super::{BranchResult, Findings, State, SweepResult, TimeResponse, Treatment};
use gearwright_case::lumped_pair::schema::LumpedPair;
use gearwright_case::{LumpedPairCase, Notes};

/// Harmonics of the mesh frequency told.
const HARMONICS: usize = 6;
/// A local maximum over speed counts as a peak where it stands out from both sides by this part of itself.
const PROMINENCE: f64 = 0.05;

/// Everything the summary holds.
#[derive(Debug, Serialize)]
pub struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    /// The case with every default spelled out.
    inputs: &'a LumpedPair,
    /// Warnings and assumptions.
    #[serde(flatten)]
    notes: &'a Notes,
    /// The pair without its excitation.
    model: ModelSummary,
    /// By state.
    states: Vec<StateSummary>,
    time_response: Vec<TimeSummary>,
    sweeps: Vec<SweepSummary>,
    continuation: Vec<BranchSummary>,
    impulse_tests: Vec<ImpulseSummary>,
    damage: Vec<DamageSummary>,
    /// Wall time of each stage (s).
    time_s: Times,
}

/// Wall time of stages (s).
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Times {
    /// Curves, static analyses included.
    pub curves: f64,
    /// Response over time.
    pub time: f64,
    /// Sweeps.
    pub sweep: f64,
    /// Continuation.
    pub continuation: f64,
    /// Impulse tests.
    pub impulse: f64,
    /// Damage-induced response.
    pub damage: f64,
    /// Plots and files.
    pub output: f64,
}

/// The pair as a model.
#[derive(Debug, Serialize)]
pub struct ModelSummary {
    moving_mass_kg: f64,
    mean_mesh_force_n: f64,
    mesh_damping_n_s_per_m: f64,
    coordinates: usize,
    /// integrated, eliminated or rigid.
    supports: &'static str,
    /// Largest estimated error of the response with eliminated supports, of its variation; none with rigid ones.
    elimination_error: Option<f64>,
    /// Mesh frequency of that error (Hz); 0 for free motion.
    elimination_error_at_hz: Option<f64>,
}

/// A state.
#[derive(Debug, Serialize)]
pub struct StateSummary {
    name: String,
    period_mesh_cycles: usize,
    mesh_stiffness_n_per_um: Range,
    ste_um: Range,
    /// At the least and the largest mesh stiffness, teeth in contact.
    natural_frequency_hz: [f64; 2],
    /// The same with the other rule for the input, where the pair's values suffice.
    natural_frequency_other_input_hz: Option<[f64; 2]>,
    damping_ratio: [f64; 2],
}

/// Least, mean and largest value.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Range {
    min: f64,
    mean: f64,
    max: f64,
}

/// Response over time.
#[derive(Debug, Serialize)]
pub struct TimeSummary {
    state: String,
    mesh_frequency_hz: f64,
    mesh_cycles: usize,
    /// Periods of the excitation in one period of the motion; none if it does not repeat or was recorded from rest.
    periods_of_the_motion: Option<usize>,
    largest_um: f64,
    largest_at_mesh_cycle: f64,
    smallest_um: f64,
    smallest_at_mesh_cycle: f64,
    peak_to_peak_um: f64,
    rms_um: f64,
    dynamic_factor: f64,
    fraction_without_contact: f64,
    contact_losses: usize,
    /// Amplitudes at the mesh frequency and its multiples (um).
    harmonics_um: Vec<f64>,
    largest_tooth_force_n: Option<f64>,
    largest_bearing_force_n: f64,
}

/// A sweep.
#[derive(Debug, Serialize)]
pub struct SweepSummary {
    state: String,
    direction: &'static str,
    speeds: usize,
    not_periodic: usize,
    /// Largest factor between neighbouring speeds, and the speeds (Hz).
    largest_jump: f64,
    largest_jump_between_hz: [f64; 2],
    /// Local maxima of the peak-to-peak value: mesh frequency (Hz), value (um).
    peaks: Vec<[f64; 2]>,
}

/// A branch.
#[derive(Debug, Serialize)]
pub struct BranchSummary {
    state: String,
    points: usize,
    end: &'static str,
    /// Mesh frequency (Hz) and peak-to-peak value (um).
    turning_points: Vec<[f64; 2]>,
    /// Ranges of mesh frequency with more than one stable solution (Hz).
    two_stable_solutions_hz: Vec<[f64; 2]>,
}

/// An impulse test.
#[derive(Debug, Serialize)]
pub struct ImpulseSummary {
    state: String,
    mesh_cycle: f64,
    natural_frequency_hz: Option<f64>,
    damping_ratio: Option<f64>,
}

/// Damage-induced response.
#[derive(Debug, Serialize)]
pub struct DamageSummary {
    state: String,
    mesh_frequency_hz: f64,
    peak_to_peak_um: f64,
    static_peak_to_peak_um: f64,
    largest_line_hz: f64,
    largest_amplitude_um: f64,
    static_amplitude_um: f64,
}

/// Collects the summary.
///
/// # Errors
/// Those of the model with the other input.
pub fn summary<'a>(
    case: &'a LumpedPairCase,
    (states, treatment): (&[State], &Treatment),
    findings: &Findings,
    times: Times,
) -> Result<Summary<'a>, LpmError> {
    let pair = states.first().map_or(case.pair, |s| *s.model.pair());
    let damage = findings.damage.iter().map(|d| {
        let (at, amplitude) = d.response.spectrum.peak(0.0, f64::INFINITY).unwrap_or_default();
        DamageSummary {
            state: d.state.clone(),
            mesh_frequency_hz: d.mesh_frequency,
            peak_to_peak_um: d.response.peak_to_peak() * 1e6,
            static_peak_to_peak_um: d.response.static_peak_to_peak() * 1e6,
            largest_line_hz: at,
            largest_amplitude_um: amplitude * 1e6,
            static_amplitude_um: d.static_amplitude * 1e6,
        }
    });
    Ok(Summary {
        program: "gearwright",
        version: env!("CARGO_PKG_VERSION"),
        inputs: &case.inputs,
        notes: &case.notes,
        model: ModelSummary {
            moving_mass_kg: pair.effective_mass(),
            mean_mesh_force_n: pair.mean_force(),
            mesh_damping_n_s_per_m: pair.mesh_damping,
            coordinates: states.first().map_or(1, |s| s.model.coordinates()),
            supports: match treatment.supports {
                Supports::Integrated => "integrated",
                Supports::Eliminated => "eliminated",
                Supports::Rigid => "rigid",
            },
            elimination_error: treatment.elimination.map(|worst| worst.0),
            elimination_error_at_hz: treatment.elimination.map(|worst| worst.1),
        },
        states: states.iter().map(|state| state_summary(case, state)).collect::<Result<_, _>>()?,
        time_response: time(findings),
        sweeps: findings.sweeps.iter().map(sweep).collect(),
        continuation: branches(findings),
        impulse_tests: findings
            .impulses
            .iter()
            .map(|i| ImpulseSummary {
                state: i.state.clone(),
                mesh_cycle: i.mesh_cycle,
                natural_frequency_hz: i.test.as_ref().map(|t| t.natural_frequency),
                damping_ratio: i.test.as_ref().map(|t| t.damping_ratio),
            })
            .collect(),
        damage: damage.collect(),
        time_s: times,
    })
}

fn state_summary(case: &LumpedPairCase, state: &State) -> Result<StateSummary, LpmError> {
    let (k, e) = (state.model.excitation().mesh_stiffness(), state.model.excitation().transmission_error());
    let (stiffness, error) = (k.range(), e.range());
    let phases = [stiffness.min_phase, stiffness.max_phase];
    let mesh_mode = |model: &Model| phases.map(|t| model.natural_frequencies(t).first().copied().unwrap_or(0.0));
    let written = &case.inputs.pair.pinion;
    let other = if written.base_radius_mm.is_some() && written.inertia_kg_m2.is_some() {
        let mut pair = *state.model.pair();
        pair.input = if pair.input == Input::Free { Input::Prescribed } else { Input::Free };
        Some(mesh_mode(&Model::new(&pair, state.model.excitation(), state.model.supports())?))
    } else {
        None
    };
    Ok(StateSummary {
        name: state.name.clone(),
        period_mesh_cycles: state.model.excitation().period(),
        mesh_stiffness_n_per_um: Range { min: stiffness.min * 1e-6, mean: k.mean() * 1e-6, max: stiffness.max * 1e-6 },
        ste_um: Range { min: error.min * 1e6, mean: e.mean() * 1e6, max: error.max * 1e6 },
        natural_frequency_hz: mesh_mode(&state.model),
        natural_frequency_other_input_hz: other,
        damping_ratio: phases.map(|t| state.model.damping_ratio(t)),
    })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| v.abs().max(most))
}

fn time(findings: &Findings) -> Vec<TimeSummary> {
    let one = |t: &TimeResponse| {
        let r: &Response = &t.response;
        let (top, bottom) = (r.maximum(), r.minimum());
        TimeSummary {
            state: t.state.clone(),
            mesh_frequency_hz: r.mesh_frequency,
            mesh_cycles: (r.mesh_cycle.len() as f64 / r.per_cycle()).round() as usize,
            periods_of_the_motion: t.multiple,
            largest_um: top.value * 1e6,
            largest_at_mesh_cycle: top.mesh_cycle,
            smallest_um: bottom.value * 1e6,
            smallest_at_mesh_cycle: bottom.mesh_cycle,
            peak_to_peak_um: r.peak_to_peak() * 1e6,
            rms_um: r.rms() * 1e6,
            dynamic_factor: r.dynamic_factor(),
            fraction_without_contact: r.separated_fraction(),
            contact_losses: r.separations.len(),
            harmonics_um: (1..=HARMONICS).map(|j| t.spectrum.amplitude_at(j as f64 * r.mesh_frequency) * 1e6).collect(),
            largest_tooth_force_n: (!t.tooth_forces.is_empty())
                .then(|| t.tooth_forces.iter().fold(0.0, |most: f64, f| most.max(f.2))),
            largest_bearing_force_n: largest(&r.pinion_bearing_force).max(largest(&r.gear_bearing_force)),
        }
    };
    findings.time.iter().map(one).collect()
}

fn sweep(result: &SweepResult) -> SweepSummary {
    let points: Vec<[f64; 2]> =
        result.points.iter().map(|p| [p.mesh_frequency, p.measure.peak_to_peak * 1e6]).collect();
    let factor = |w: &[[f64; 2]]| (w[1][1] / w[0][1]).max(w[0][1] / w[1][1]);
    let jump = points.windows(2).filter(|w| factor(w).is_finite()).max_by(|a, b| factor(a).total_cmp(&factor(b)));
    SweepSummary {
        state: result.state.clone(),
        direction: if result.up { "up" } else { "down" },
        speeds: points.len(),
        not_periodic: result.points.iter().filter(|p| p.multiple.is_none()).count(),
        largest_jump: jump.map_or(1.0, factor),
        largest_jump_between_hz: jump.map_or([0.0; 2], |w| [w[0][0], w[1][0]]),
        peaks: peaks(&points),
    }
}

/// Local maxima that stand out on both sides.
fn peaks(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let falls = |from: f64, side: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut least = from;
        for p in side {
            if p[1] > from {
                break;
            }
            least = least.min(p[1]);
        }
        least < (1.0 - PROMINENCE) * from
    };
    let stands_out = |i: &usize| {
        let height = points[*i][1];
        falls(height, &mut points[..*i].iter().rev()) && falls(height, &mut points[i + 1..].iter())
    };
    let mut found: Vec<[f64; 2]> = (0..points.len()).filter(stands_out).map(|i| points[i]).collect();
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    found
}

fn branches(findings: &Findings) -> Vec<BranchSummary> {
    let one = |b: &BranchResult| BranchSummary {
        state: b.state.clone(),
        points: b.branch.points.len(),
        end: match b.branch.end {
            BranchEnd::RangeLeft => "range left",
            BranchEnd::PointLimit => "limit of points reached",
            BranchEnd::NoConvergence => "no convergence",
        },
        turning_points: b
            .branch
            .turning_points
            .iter()
            .map(|t| [t.point.mesh_frequency, t.point.measure.peak_to_peak * 1e6])
            .collect(),
        two_stable_solutions_hz: b.branch.coexistence().iter().map(|r| [r.0, r.1]).collect(),
    };
    findings.branches.iter().map(one).collect()
}

/// The one-screen summary.
#[must_use]
pub fn screen(case: &LumpedPairCase, s: &Summary<'_>) -> String {
    let mut text = String::new();
    let title = if case.inputs.title.is_empty() { "lumped-parameter gear pair" } else { &case.inputs.title };
    let _ = writeln!(text, "{title}");
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<34} {value}");
    };
    let m = &s.model;
    line(
        "moving mass, mean mesh force",
        format!("{:.4} kg, {:.1} N; {} coordinate(s)", m.moving_mass_kg, m.mean_mesh_force_n, m.coordinates),
    );
    if let (Some(error), Some(at)) = (m.elimination_error, m.elimination_error_at_hz) {
        let error = format!("{}; eliminating them: {:.2} % error {}", m.supports, 100.0 * error, Treatment::place(at));
        line("supports", error);
    }
    if let Some(h) = s.states.first() {
        let (k, e) = (&h.mesh_stiffness_n_per_um, &h.ste_um);
        line("mesh stiffness, local slope", format!("{:.1} to {:.1} N/um, mean {:.1}", k.min, k.max, k.mean));
        line("static transmission error", format!("{:.3} to {:.3} um", e.min, e.max));
        let other = h
            .natural_frequency_other_input_hz
            .map_or(String::new(), |f| format!("; with the other input rule {:.0} to {:.0}", f[0], f[1]));
        let [low, high] = h.natural_frequency_hz;
        line("natural frequency, mesh mode", format!("{low:.0} to {high:.0} Hz{other}"));
        line("damping ratio", format!("{:.4} to {:.4}", h.damping_ratio[1], h.damping_ratio[0]));
    }
    for t in s.time_response.iter().take(4) {
        line(
            &format!("{} at {:.0} Hz", short(&t.state), t.mesh_frequency_hz),
            format!(
                "DTE {:.2} to {:.2} um, {:.2} um at the mesh frequency, {} contact losses",
                t.smallest_um, t.largest_um, t.harmonics_um[0], t.contact_losses
            ),
        );
    }
    for w in s.sweeps.iter().take(4) {
        let top = w.peaks.iter().map(|p| p[1]).fold(0.0, f64::max);
        let [a, b] = w.largest_jump_between_hz;
        line(
            &format!("{}, sweep {}", short(&w.state), w.direction),
            format!("largest peak {top:.1} um, largest jump {:.2}-fold from {a:.0} to {b:.0} Hz", w.largest_jump),
        );
    }
    for b in s.continuation.iter().take(2) {
        let list = |r: &[[f64; 2]]| r.iter().map(|r| format!("{:.0} to {:.0} Hz", r[0], r[1])).collect::<Vec<_>>();
        let ranges = list(&b.two_stable_solutions_hz).join(", ");
        let ranges = if ranges.is_empty() { "none".to_owned() } else { ranges };
        line(
            &format!("{}, branch", short(&b.state)),
            format!("{} points; two stable solutions: {ranges}; end: {}", b.points, b.end),
        );
    }
    for i in s.impulse_tests.iter().take(2) {
        let read = match (i.natural_frequency_hz, i.damping_ratio) {
            (Some(f), Some(z)) => format!("{f:.1} Hz, damping ratio {z:.4}"),
            _ => "nothing oscillates".into(),
        };
        line(&format!("{}, blow at cycle {:.2}", short(&i.state), i.mesh_cycle), read);
    }
    for d in s.damage.iter().take(4) {
        line(
            &format!("{}, difference, {:.0} Hz", short(&d.state), d.mesh_frequency_hz),
            format!(
                "largest line {:.3} um at {:.0} Hz ({:.3} um static)",
                d.largest_amplitude_um, d.largest_line_hz, d.static_amplitude_um
            ),
        );
    }
    let t = &s.time_s;
    let stages = [
        ("curves", t.curves),
        ("time", t.time),
        ("sweeps", t.sweep),
        ("continuation", t.continuation),
        ("impulse", t.impulse),
        ("damage", t.damage),
        ("files", t.output),
    ];
    let spent: Vec<String> =
        stages.iter().filter(|s| s.1 > 0.0).map(|(name, seconds)| format!("{seconds:.3} s {name}")).collect();
    line("time", spent.join(", "));
    text
}

/// A name that leaves room beside it.
fn short(name: &str) -> String {
    if name.chars().count() <= 18 {
        name.to_owned()
    } else {
        format!("{}...", name.chars().take(15).collect::<String>())
    }
}
