//! What damage does to the mesh, severity by severity.

use fecm::statics::PositionResult;
use serde::Serialize;

use super::stress::Stresses;
use crate::table::{
    FilledTable, MEGAPASCAL, MICROMETRE, MILLIMETRE, NEWTON, PERCENT, PLAIN, STRESS_INTENSITY, Table, column,
};

/// Effect of one severity against the healthy pair at the same positions.
#[derive(Debug, Clone, Serialize)]
pub struct Effect {
    /// Severity.
    pub label: String,
    /// Largest transmission error (um).
    pub ste_max_um: f64,
    /// Mesh cycle of it.
    pub ste_max_at: f64,
    /// Largest increase of the transmission error over the healthy pair (%).
    pub ste_increase_max_percent: f64,
    /// Mesh cycle of it.
    pub ste_increase_max_at: f64,
    /// Mesh cycles over which the transmission error exceeds the healthy one by more than 1 % (dissertation section 3.3).
    pub affected_mesh_cycles: f64,
    /// Largest decrease of the local-slope stiffness (%).
    pub stiffness_decrease_max_percent: f64,
    /// Mesh cycle of it.
    pub stiffness_decrease_max_at: f64,
    /// Length of its longest crack along the path (mm).
    pub crack_length_mm: Option<f64>,
    /// Largest stress-intensity factor `K_I` of its cracks (MPa sqrt(m)).
    pub k_one_max_mpa_sqrt_m: Option<f64>,
    /// Largest magnitude of `K_II` (MPa sqrt(m)).
    pub k_two_max_mpa_sqrt_m: Option<f64>,
    /// Largest force between the faces of a crack that closes (N).
    pub crack_face_force_max_n: Option<f64>,
    /// Largest tension at the roots of the pinion's teeth (MPa), if asked for.
    pub pinion_root_tension_max_mpa: Option<f64>,
    /// Largest tension at the roots of the gear's teeth (MPa), if asked for.
    pub gear_root_tension_max_mpa: Option<f64>,
}

/// The 1 % rule of the dissertation.
const AFFECTED: f64 = 0.01;

/// Effect of a damaged series whose longest crack is `crack_length` (m); `origin` is added to mesh cycles. Positions without a usable answer do not count.
#[must_use]
pub fn effect(
    label: &str,
    healthy: &[PositionResult],
    damaged: &[PositionResult],
    (crack_length, stresses): (Option<f64>, &Stresses),
    origin: f64,
) -> Effect {
    let pairs = || healthy.iter().zip(damaged).filter(|(h, d)| h.status.is_usable() && d.status.is_usable());
    let largest = |value: &dyn Fn(&PositionResult, &PositionResult) -> Option<f64>| {
        let all = pairs().filter_map(|(h, d)| value(h, d).map(|v| (v, d.mesh_cycle + origin)));
        all.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0.0))
    };
    let increase = |h: &PositionResult, d: &PositionResult| {
        (h.static_transmission_error > 0.0).then(|| d.static_transmission_error / h.static_transmission_error - 1.0)
    };
    let decrease = |h: &PositionResult, d: &PositionResult| Some(1.0 - d.local_stiffness()? / h.local_stiffness()?);
    let ste = largest(&|_, d| Some(d.static_transmission_error * 1e6));
    let (ste_increase, stiffness_decrease) = (largest(&increase), largest(&decrease));
    let step = match healthy {
        [first, second, ..] => second.mesh_cycle - first.mesh_cycle,
        _ => 0.0,
    };
    let root_tension = |member| stresses.largest_root(damaged, member, 0, origin).map(|root| root.stress_mpa);
    let affected = pairs().filter(|(h, d)| increase(h, d).is_some_and(|i| i > AFFECTED)).count();
    Effect {
        label: label.into(),
        ste_max_um: ste.0,
        ste_max_at: ste.1,
        ste_increase_max_percent: 100.0 * ste_increase.0,
        ste_increase_max_at: ste_increase.1,
        affected_mesh_cycles: affected as f64 * step,
        stiffness_decrease_max_percent: 100.0 * stiffness_decrease.0,
        stiffness_decrease_max_at: stiffness_decrease.1,
        crack_length_mm: crack_length.map(|length| length * 1e3),
        k_one_max_mpa_sqrt_m: stresses.largest_k_one(),
        k_two_max_mpa_sqrt_m: stresses.largest_k_two(),
        crack_face_force_max_n: stresses.largest_face_force(),
        pinion_root_tension_max_mpa: root_tension(0),
        gear_root_tension_max_mpa: root_tension(1),
    }
}

/// `damage`: one row per severity.
pub(super) fn table(effects: &[Effect]) -> FilledTable<'_> {
    type Row<'a> = &'a Effect;
    let columns = vec![
        column("label", PLAIN, "Severity.", |e: &Row<'_>| e.label.as_str()),
        column("ste_max", MICROMETRE.given(), "Largest transmission error.", |e: &Row<'_>| e.ste_max_um),
        column("ste_max_at", PLAIN, "Mesh cycle of it.", |e: &Row<'_>| e.ste_max_at),
        column("ste_increase_max", PERCENT.given(), "Largest increase over the healthy pair.", |e: &Row<'_>| {
            e.ste_increase_max_percent
        }),
        column("ste_increase_max_at", PLAIN, "Mesh cycle of it.", |e: &Row<'_>| e.ste_increase_max_at),
        column("affected_mesh_cycles", PLAIN, "Mesh cycles with more than 1 % increase.", |e: &Row<'_>| {
            e.affected_mesh_cycles
        }),
        column(
            "stiffness_decrease_max",
            PERCENT.given(),
            "Largest decrease of the local-slope stiffness.",
            |e: &Row<'_>| e.stiffness_decrease_max_percent,
        ),
        column("stiffness_decrease_max_at", PLAIN, "Mesh cycle of it.", |e: &Row<'_>| e.stiffness_decrease_max_at),
        column("crack_length", MILLIMETRE.given(), "Length of its longest crack along the path.", |e: &Row<'_>| {
            e.crack_length_mm
        }),
        column("k_one_max", STRESS_INTENSITY.given(), "Largest K_I of its cracks.", |e: &Row<'_>| {
            e.k_one_max_mpa_sqrt_m
        }),
        column("k_two_max", STRESS_INTENSITY.given(), "Largest magnitude of K_II.", |e: &Row<'_>| {
            e.k_two_max_mpa_sqrt_m
        }),
        column(
            "crack_face_force_max",
            NEWTON.given(),
            "Largest force between the faces of a crack that closes.",
            |e: &Row<'_>| e.crack_face_force_max_n,
        ),
        column(
            "pinion_root_tension_max",
            MEGAPASCAL.given(),
            "Largest tension at the roots of the pinion's teeth.",
            |e: &Row<'_>| e.pinion_root_tension_max_mpa,
        ),
        column(
            "gear_root_tension_max",
            MEGAPASCAL.given(),
            "Largest tension at the roots of the gear's teeth.",
            |e: &Row<'_>| e.gear_root_tension_max_mpa,
        ),
    ];
    Table::new("damage", "Effect of every severity of damage against the healthy pair.", columns)
        .decimals(None)
        .with(effects.iter())
}
