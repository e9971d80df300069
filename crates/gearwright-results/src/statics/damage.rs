//! What damage does to the mesh, severity by severity: `damage.csv`.

use std::path::Path;

use fecm::statics::PositionResult;
use serde::Serialize;

use super::stress::Stresses;

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

/// Writes the table.
///
/// # Errors
/// I/O errors.
pub fn table(path: &Path, effects: &[Effect]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    for effect in effects {
        table.serialize(effect)?;
    }
    table.flush()?;
    Ok(())
}
