//! Kind `spur-pair`: contact statics of a gear pair over the mesh cycle.

pub mod damage;
pub mod notes;
pub mod resolve;
pub mod schema;

use super::kind::CaseKind;
use super::{Case, as_written};

pub use resolve::SpurPairCase;

/// The kind, its schema and its example.
pub const KIND: CaseKind = CaseKind {
    name: "spur-pair",
    about: "a spur gear pair: contact statics over the mesh cycle",
    schema: || schemars::schema_for!(schema::SpurPair).to_value(),
    resolve: |text, document, folder| {
        let written = as_written(text)?;
        resolve::resolve(written, document, folder).map(|case| Case::SpurPair(Box::new(case)))
    },
    example: EXAMPLE,
};

/// Values of the example: the unity-ratio pair of the dissertation (sections 2.2 and 3.2.3), bore and fillet chosen here.
const EXAMPLE: &[(&str, &str)] = &[
    ("kind", "\"spur-pair\""),
    ("title", "\"Unity-ratio pair, 25 teeth, module 6 mm\""),
    ("mesh.module_mm", "6.0"),
    ("mesh.pressure_angle_deg", "20.0"),
    ("mesh.centre_distance_mm", "150.1"),
    ("pinion.teeth", "25"),
    ("pinion.profile_shift", "0.0"),
    ("pinion.tip_diameter_mm", "162.0"),
    ("pinion.root_diameter_mm", "135.0"),
    ("pinion.bore_diameter_mm", "60.0"),
    ("pinion.facewidth_mm", "16.0"),
    ("gear.teeth", "25"),
    ("gear.profile_shift", "0.0"),
    ("gear.tip_diameter_mm", "162.0"),
    ("gear.root_diameter_mm", "135.0"),
    ("gear.bore_diameter_mm", "60.0"),
    ("gear.facewidth_mm", "16.0"),
    ("load.torque_n_m", "200.0"),
];
