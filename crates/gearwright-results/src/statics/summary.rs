//! `summary.json` and the one-screen summary: what was asked, what came out, what it cost.

use std::collections::BTreeMap;

use fecm::statics::{ModelStats, PositionResult, PositionStatus, StaticsSeries};
use gear_geom::{GearPair, Landmark, Landmarks, Member};
use serde::Serialize;

use super::damage::Effect;
use super::stress::{LargestRoot, Stresses};
use gearwright_case::spur_pair::schema::SpurPair;
use gearwright_case::{Notes, SpurPairCase};

/// Everything the summary holds.
#[derive(Debug, Serialize)]
pub struct Summary<'a> {
    /// Program and version.
    pub program: &'static str,
    /// Version.
    pub version: &'static str,
    /// The case with every default spelled out.
    pub inputs: &'a SpurPair,
    /// Warnings and assumptions.
    #[serde(flatten)]
    pub notes: &'a Notes,
    /// What follows from the geometry alone.
    pub geometry: Geometry,
    /// What came out.
    pub results: Results,
    /// Effect of each severity of damage.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub damage: &'a [Effect],
    /// Sizes and work.
    pub work: Work,
    /// Wall time of each stage (s).
    pub time_s: Times,
}

/// Geometry of the pair.
#[derive(Debug, Serialize)]
pub struct Geometry {
    working_pressure_angle_deg: f64,
    contact_ratio: f64,
    base_pitch_mm: f64,
    backlash_mm: f64,
    normal_backlash_mm: f64,
    base_radius_mm: [f64; 2],
    working_pitch_radius_mm: [f64; 2],
    form_radius_mm: [f64; 2],
    tip_form_radius_mm: [f64; 2],
    landmarks_pinion: LandmarkTable,
    landmarks_gear: LandmarkTable,
    findings: Vec<String>,
}

/// Landmarks of a gear.
#[derive(Debug, Serialize)]
pub struct LandmarkTable {
    sap: LandmarkRow,
    lpstc: Option<LandmarkRow>,
    pitch: LandmarkRow,
    hpstc: Option<LandmarkRow>,
    eap: LandmarkRow,
}

/// One landmark.
#[derive(Debug, Serialize)]
pub struct LandmarkRow {
    radius_mm: f64,
    roll_angle_deg: f64,
    roll_distance_mm: f64,
    arc_length_mm: f64,
}

/// Extrema over the positions.
#[derive(Debug, Clone, Serialize)]
pub struct Results {
    /// Positions solved.
    pub positions: usize,
    /// Positions by status; extrema are over those with status converged or fillet-contact.
    pub status: BTreeMap<&'static str, usize>,
    /// Mean number of loaded pairs.
    pub contact_ratio_under_load: f64,
    /// Transmission error (um).
    pub ste_um: Range,
    /// Peak-to-peak transmission error (um).
    pub ste_peak_to_peak_um: f64,
    /// No-load transmission error (um).
    pub no_load_te_um: Range,
    /// Average-slope mesh stiffness (N/um).
    pub mesh_stiffness_average_n_per_um: Range,
    /// Local-slope mesh stiffness (N/um).
    pub mesh_stiffness_local_n_per_um: Range,
    /// Largest force on a tooth pair (N).
    pub largest_tooth_force_n: f64,
    /// Largest contact pressure (MPa).
    pub largest_pressure_mpa: f64,
    /// Largest tension at the roots of pinion and gear, if asked for.
    pub largest_root_tension: [Option<LargestRoot>; 2],
    /// Largest compression at the roots of pinion and gear, if asked for.
    pub largest_root_compression: [Option<LargestRoot>; 2],
    /// Largest residual of the torque, relative.
    pub largest_torque_residual: f64,
    /// Largest violation of the contact conditions, relative.
    pub largest_kkt_violation: f64,
}

/// Smallest and largest value, and where.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Range {
    /// Smallest.
    pub min: f64,
    /// Mesh cycle of the smallest.
    pub min_at: f64,
    /// Largest.
    pub max: f64,
    /// Mesh cycle of the largest.
    pub max_at: f64,
}

/// Sizes and counters.
#[derive(Debug, Serialize)]
pub struct Work {
    symmetric_about_midface: bool,
    plane_nodes: [usize; 2],
    plane_elements: [usize; 2],
    sector_unknowns: [usize; 2],
    cut_unknowns: [usize; 2],
    factor_entries: [usize; 2],
    face_cells: usize,
    contact_cells_largest: usize,
    contact_solves: usize,
    pivots: usize,
    factorisations: usize,
    threads: usize,
}

/// Wall time of stages.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Times {
    /// Meshing and condensation.
    pub condensation: f64,
    /// Contact over the mesh cycle.
    pub contact: f64,
    /// Force-deflection map.
    pub map: f64,
    /// Damaged pairs, condensation and contact.
    pub damage: f64,
    /// Root stresses and stress-intensity factors.
    pub stress: f64,
    /// Plots and files.
    pub output: f64,
}

impl Range {
    fn of(values: impl Iterator<Item = (f64, Option<f64>)>, scale: f64) -> Self {
        let start = Self { min: f64::INFINITY, min_at: 0.0, max: f64::NEG_INFINITY, max_at: 0.0 };
        let range = values.filter_map(|(at, v)| v.map(|v| (at, v * scale))).fold(start, |mut range, (at, v)| {
            if v < range.min {
                (range.min, range.min_at) = (v, at);
            }
            if v > range.max {
                (range.max, range.max_at) = (v, at);
            }
            range
        });
        if range.min.is_finite() { range } else { Self { min: 0.0, min_at: 0.0, max: 0.0, max_at: 0.0 } }
    }
}

/// How many positions ended in which status.
pub fn count_status<'a>(positions: impl Iterator<Item = &'a PositionResult>) -> BTreeMap<&'static str, usize> {
    let mut count = BTreeMap::new();
    for position in positions {
        *count.entry(position.status.name()).or_default() += 1;
    }
    count
}

/// Extrema of a series; `origin` is added to mesh cycles.
#[must_use]
pub fn results(all: &[PositionResult], stresses: &Stresses, origin: f64) -> Results {
    let root = |side: usize| [0, 1].map(|member| stresses.largest_root(all, member, side, origin));
    let series: Vec<&PositionResult> = all.iter().filter(|r| r.status.is_usable()).collect();
    let over = |value: &dyn Fn(&PositionResult) -> Option<f64>, scale: f64| {
        Range::of(series.iter().map(|r| (r.mesh_cycle + origin, value(r))), scale)
    };
    let most = |value: &dyn Fn(&PositionResult) -> f64| series.iter().copied().map(value).fold(0.0, f64::max);
    let loaded: usize = series.iter().map(|r| r.loaded_pairs().count()).sum();
    let ste = over(&|r| Some(r.static_transmission_error), 1e6);
    Results {
        positions: all.len(),
        status: count_status(all.iter()),
        contact_ratio_under_load: loaded as f64 / series.len().max(1) as f64,
        ste_um: ste,
        ste_peak_to_peak_um: ste.max - ste.min,
        no_load_te_um: over(&|r| Some(r.no_load_transmission_error), 1e6),
        mesh_stiffness_average_n_per_um: over(&|r| r.stiffness_average_slope, 1e-6),
        mesh_stiffness_local_n_per_um: over(&PositionResult::local_stiffness, 1e-6),
        largest_tooth_force_n: most(&|r| r.pairs.iter().map(|p| p.force).fold(0.0, f64::max)),
        largest_root_tension: root(0),
        largest_root_compression: root(1),
        largest_pressure_mpa: most(&|r| r.peak_pressure() * 1e-6),
        largest_torque_residual: most(&|r| r.stats.torque_residual),
        largest_kkt_violation: most(&|r| r.stats.solver.kkt_violation),
    }
}

fn landmark(l: &Landmark) -> LandmarkRow {
    LandmarkRow {
        radius_mm: l.radius * 1e3,
        roll_angle_deg: l.roll_angle.to_degrees(),
        roll_distance_mm: l.roll_distance * 1e3,
        arc_length_mm: l.arc_length * 1e3,
    }
}

fn landmark_table(l: &Landmarks) -> LandmarkTable {
    LandmarkTable {
        sap: landmark(&l.sap),
        lpstc: l.lpstc.as_ref().map(landmark),
        pitch: landmark(&l.pitch),
        hpstc: l.hpstc.as_ref().map(landmark),
        eap: landmark(&l.eap),
    }
}

/// What follows from the geometry.
#[must_use]
pub fn geometry(pair: &GearPair) -> Geometry {
    let both = |value: &dyn Fn(Member) -> f64| [Member::Pinion, Member::Wheel].map(|m| value(m) * 1e3);
    Geometry {
        working_pressure_angle_deg: pair.working_pressure_angle().to_degrees(),
        contact_ratio: pair.contact_ratio(),
        base_pitch_mm: pair.base_pitch() * 1e3,
        backlash_mm: pair.backlash() * 1e3,
        normal_backlash_mm: pair.normal_backlash() * 1e3,
        base_radius_mm: both(&|m| pair.gear(m).base_radius()),
        working_pitch_radius_mm: both(&|m| pair.working_pitch_radius(m)),
        form_radius_mm: both(&|m| pair.gear(m).form_radius()),
        tip_form_radius_mm: both(&|m| pair.gear(m).tip_form_radius()),
        landmarks_pinion: landmark_table(&pair.landmarks(Member::Pinion)),
        landmarks_gear: landmark_table(&pair.landmarks(Member::Wheel)),
        findings: pair.findings().iter().map(ToString::to_string).collect(),
    }
}

/// Sizes and counters of a run.
#[must_use]
pub fn work(stats: &ModelStats, series: &[&StaticsSeries]) -> Work {
    let bodies = [stats.pinion, stats.wheel];
    let all = || series.iter().flat_map(|s| s.results.iter().flatten());
    Work {
        symmetric_about_midface: stats.symmetric,
        plane_nodes: bodies.map(|b| b.plane_nodes),
        plane_elements: bodies.map(|b| b.plane_elements),
        sector_unknowns: bodies.map(|b| b.sector_unknowns),
        cut_unknowns: bodies.map(|b| b.cut_unknowns),
        factor_entries: bodies.map(|b| b.factor_entries),
        face_cells: stats.face_cells,
        contact_cells_largest: all().map(|r| r.stats.cells).max().unwrap_or(0),
        contact_solves: all().map(|r| r.stats.solver.solves).sum(),
        pivots: all().map(|r| r.stats.solver.pivots).sum(),
        factorisations: all().map(|r| r.stats.solver.factorisations).sum(),
        threads: rayon::current_num_threads(),
    }
}

/// The one-screen summary.
#[must_use]
pub fn screen(case: &SpurPairCase, results: &Results, damage: &[Effect], stats: &ModelStats, times: &Times) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    let pair = &case.pair;
    let title = if case.inputs.title.is_empty() { "spur gear pair" } else { &case.inputs.title };
    let _ = writeln!(text, "{title}");
    let line = |text: &mut String, name: &str, value: String| {
        let _ = writeln!(text, "  {name:<34} {value}");
    };
    line(&mut text, "torque on the gear", format!("{} N m", case.inputs.load.torque_n_m));
    line(
        &mut text,
        "contact ratio",
        format!("{:.3} theoretical, {:.2} under load", pair.contact_ratio(), results.contact_ratio_under_load),
    );
    let ste = &results.ste_um;
    line(
        &mut text,
        "static transmission error",
        format!(
            "{:.3} to {:.3} um (at mesh cycle {:.2}), peak to peak {:.3} um",
            ste.min, ste.max, ste.max_at, results.ste_peak_to_peak_um
        ),
    );
    let no_load = &results.no_load_te_um;
    line(&mut text, "no-load transmission error", format!("{:.3} to {:.3} um", no_load.min, no_load.max));
    let (local, average) = (&results.mesh_stiffness_local_n_per_um, &results.mesh_stiffness_average_n_per_um);
    line(&mut text, "mesh stiffness, local slope", format!("{:.1} to {:.1} N/um", local.min, local.max));
    line(&mut text, "mesh stiffness, average slope", format!("{:.1} to {:.1} N/um", average.min, average.max));
    line(&mut text, "largest tooth force", format!("{:.1} N", results.largest_tooth_force_n));
    line(&mut text, "largest contact pressure", format!("{:.0} MPa", results.largest_pressure_mpa));
    if let [Some(pinion), Some(gear)] = &results.largest_root_tension {
        let one = |root: &LargestRoot| {
            format!("{:.0} MPa at the {:.0} degree tangent", root.stress_mpa, root.tangent_angle_deg)
        };
        line(&mut text, "largest root stress", format!("pinion {}, gear {}", one(pinion), one(gear)));
    }
    line(
        &mut text,
        "residuals: torque, contact",
        format!("{:.1e}, {:.1e}", results.largest_torque_residual, results.largest_kkt_violation),
    );
    for (status, count) in results.status.iter().filter(|(status, _)| **status != PositionStatus::Converged.name()) {
        line(&mut text, "not plainly converged", format!("{count} of {} positions: {status}", results.positions));
    }
    for effect in damage {
        line(
            &mut text,
            &effect.label,
            format!(
                "error up to {:.3} um at {:.2} ({:+.1} % at {:.2}), affected {:.2} mesh cycles",
                effect.ste_max_um,
                effect.ste_max_at,
                effect.ste_increase_max_percent,
                effect.ste_increase_max_at,
                effect.affected_mesh_cycles
            ),
        );
    }
    line(
        &mut text,
        "model",
        format!(
            "{} + {} unknowns a sector{}",
            stats.pinion.sector_unknowns,
            stats.wheel.sector_unknowns,
            if stats.symmetric { ", half of the face by symmetry" } else { "" }
        ),
    );
    line(
        &mut text,
        "time",
        format!(
            "{:.2} s condensation, {:.2} s contact at {} positions{}{}, {:.2} s stresses, {:.2} s files",
            times.condensation,
            times.contact,
            results.positions,
            if times.map > 0.0 { format!(", {:.2} s force-deflection map", times.map) } else { String::new() },
            if times.damage > 0.0 { format!(", {:.2} s damage", times.damage) } else { String::new() },
            times.stress,
            times.output
        ),
    );
    text
}
