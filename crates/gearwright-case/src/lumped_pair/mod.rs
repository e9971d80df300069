//! Kind `lumped-pair`: dynamics of a gear pair with lumped parameters and contact loss.

pub mod curves;
mod notes;
pub mod resolve;
pub mod schema;
pub mod table;

use super::kind::CaseKind;
use super::{Case, as_written};

pub use resolve::LumpedPairCase;

/// The kind, its schema and its example.
pub const KIND: CaseKind = CaseKind {
    name: "lumped-pair",
    about: "dynamics of a gear pair with lumped parameters and contact loss",
    schema: || schemars::schema_for!(schema::LumpedPair).to_value(),
    resolve: |text, document, folder| {
        let written = as_written(text)?;
        resolve::resolve(written, document, folder).map(|case| Case::LumpedPair(Box::new(case)))
    },
    example: EXAMPLE,
};

/// Values of the example: Table 3.2 of the dissertation with the two stiffnesses that its natural frequencies imply; the damaged
/// state is illustrative.
const EXAMPLE: &[(&str, &str)] = &[
    ("kind", "\"lumped-pair\""),
    ("title", "\"Nonunity pair, 27/35 teeth, 424 N m\""),
    ("pair.input", "\"prescribed\""),
    ("pair.gear_torque_n_m", "424.0"),
    ("pair.mesh_damping_n_s_per_m", "3660.0"),
    ("pair.damping_when_apart", "true"),
    ("pair.pinion.teeth", "27"),
    ("pair.pinion.base_radius_mm", "35.20"),
    ("pair.pinion.mass_kg", "0.7294"),
    ("pair.pinion.inertia_kg_m2", "0.0008"),
    ("pair.pinion.support_stiffness_n_per_m", "1e12"),
    ("pair.pinion.support_damping_n_s_per_m", "800.0"),
    ("pair.gear.teeth", "35"),
    ("pair.gear.base_radius_mm", "45.63"),
    ("pair.gear.mass_kg", "0.8537"),
    ("pair.gear.inertia_kg_m2", "0.0050"),
    ("pair.gear.support_stiffness_n_per_m", "1e12"),
    ("pair.gear.support_damping_n_s_per_m", "800.0"),
    ("excitation.wave.single_stiffness_n_per_um", "533.0"),
    ("excitation.wave.double_stiffness_n_per_um", "806.0"),
    ("excitation.wave.contact_ratio", "1.64"),
    ("excitation.wave.double_from_mesh_cycle", "0.18"),
    ("state.name", "\"stiffness down by a tenth\""),
    ("state.mesh_cycle", "14"),
    ("state.stiffness_factor", "0.9"),
    ("analysis.time.mesh_frequency_hz", "900.0"),
    ("analysis.sweep.from_hz", "200.0"),
    ("analysis.sweep.to_hz", "4000.0"),
    ("analysis.sweep.step_hz", "50.0"),
    ("analysis.continuation.from_hz", "200.0"),
    ("analysis.continuation.to_hz", "4000.0"),
    ("analysis.impulse.impulse_n_s", "0.001"),
    ("analysis.impulse.mesh_cycles", "[0.0, 0.5]"),
    ("analysis.damage.mesh_frequencies_hz", "[900.0, 1800.0]"),
];
