//! Kind `dynamics`: dynamics of a gear pair with the contact of the finite-element model solved at every step.

mod notes;
pub mod resolve;
pub mod schema;

use super::kind::CaseKind;
use super::{Case, as_written};

pub use resolve::DynamicsCase;

/// The kind, its schema and its example.
pub const KIND: CaseKind = CaseKind {
    name: "dynamics",
    about: "dynamics of a gear pair, the contact of the finite-element model solved at every step",
    schema: || schemars::schema_for!(schema::Dynamics).to_value(),
    resolve: |text, document, folder| {
        let written = as_written(text)?;
        resolve::resolve(written, document, folder).map(|case| Case::Dynamics(Box::new(case)))
    },
    example: EXAMPLE,
};

/// Values of the example: it refers to the case that `gearwright init spur-pair` writes. Damping is illustrative.
const EXAMPLE: &[(&str, &str)] = &[
    ("kind", "\"dynamics\""),
    ("title", "\"Unity-ratio pair, 25 teeth, 1500 rpm\""),
    ("pair.spur_pair", "\"spur-pair.toml\""),
    ("pair.input", "\"prescribed\""),
    ("damping.mass_proportional_per_s", "1500.0"),
    ("run.speed_rpm", "1500.0"),
];
