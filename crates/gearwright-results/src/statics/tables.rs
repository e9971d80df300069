//! CSV tables; units in the column names, converted here.

use std::collections::BTreeSet;
use std::path::Path;

use fecm::statics::PositionResult;

use super::stress::Stresses;

fn number(value: f64) -> String {
    format!("{value:.9e}")
}

fn optional(value: Option<f64>, scale: f64) -> String {
    value.map_or(String::new(), |v| number(v * scale))
}

/// `series.csv`: one row per position, with what was read from its stresses. `origin` is added to the mesh cycle.
///
/// # Errors
/// I/O errors.
pub fn series(path: &Path, results: &[PositionResult], stresses: &Stresses, origin: f64) -> Result<(), csv::Error> {
    let pairs: BTreeSet<i32> = results.iter().flat_map(|r| r.pairs.iter().map(|p| p.pair)).collect();
    let mut table = csv::Writer::from_path(path)?;
    let mut header: Vec<String> = [
        "mesh_cycle",
        "torque_n_m",
        "ste_um",
        "no_load_te_um",
        "mesh_force_n",
        "mesh_stiffness_average_n_per_um",
        "mesh_stiffness_local_n_per_um",
        "mesh_stiffness_tangent_n_per_um",
        "pairs_in_contact",
        "peak_pressure_mpa",
    ]
    .map(String::from)
    .to_vec();
    for pair in &pairs {
        for quantity in ["force_n", "share", "stiffness_n_per_um", "contact_width_mm", "peak_pressure_mpa"] {
            header.push(format!("pair_{pair}_{quantity}"));
        }
    }
    header.extend(stresses.header(&pairs));
    header.extend(["status", "torque_residual", "kkt_violation", "cells", "pivots"].map(String::from));
    table.write_record(&header)?;
    for (index, result) in results.iter().enumerate() {
        let mut row = vec![
            number(result.mesh_cycle + origin),
            number(result.torque),
            number(result.static_transmission_error * 1e6),
            number(result.no_load_transmission_error * 1e6),
            number(result.mesh_force),
            optional(result.stiffness_average_slope, 1e-6),
            optional(result.local_stiffness(), 1e-6),
            optional(result.stiffness_local_slope, 1e-6),
            result.loaded_pairs().count().to_string(),
            number(result.peak_pressure() * 1e-6),
        ];
        for pair in &pairs {
            match result.pairs.iter().find(|p| p.pair == *pair) {
                Some(p) => row.extend([
                    number(p.force),
                    number(p.share),
                    number(p.stiffness * 1e-6),
                    number(p.contact_width * 1e3),
                    number(p.peak_pressure * 1e-6),
                ]),
                None => row.extend(std::iter::repeat_n(number(0.0), 5)),
            }
        }
        row.extend(stresses.row(index, &pairs).into_iter().map(number));
        row.extend([
            result.status.name().to_owned(),
            number(result.stats.torque_residual),
            number(result.stats.solver.kkt_violation),
            result.stats.cells.to_string(),
            result.stats.solver.pivots.to_string(),
        ]);
        table.write_record(&row)?;
    }
    table.flush()?;
    Ok(())
}

/// `force_deflection.csv`: one row per torque and position.
///
/// # Errors
/// I/O errors.
pub fn force_deflection(path: &Path, results: &[Vec<PositionResult>], origin: f64) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record([
        "torque_n_m",
        "mesh_cycle",
        "mesh_force_n",
        "ste_um",
        "no_load_te_um",
        "mesh_stiffness_average_n_per_um",
        "mesh_stiffness_local_n_per_um",
        "pairs_in_contact",
        "status",
    ])?;
    for result in results.iter().flatten() {
        table.write_record([
            number(result.torque),
            number(result.mesh_cycle + origin),
            number(result.mesh_force),
            number(result.static_transmission_error * 1e6),
            number(result.no_load_transmission_error * 1e6),
            optional(result.stiffness_average_slope, 1e-6),
            optional(result.local_stiffness(), 1e-6),
            result.loaded_pairs().count().to_string(),
            result.status.name().to_owned(),
        ])?;
    }
    table.flush()?;
    Ok(())
}
