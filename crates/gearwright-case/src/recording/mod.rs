//! Kind `recording`: condition indicators of recorded vibration, of one recording or of a folder of them.

mod notes;
pub mod resolve;
pub mod schema;

use super::kind::CaseKind;
use super::{Case, as_written};

pub use resolve::RecordingCase;

/// The kind, its schema and its example.
pub const KIND: CaseKind = CaseKind {
    name: "recording",
    about: "recorded vibration: synchronous averages, condition indicators, verdicts, trends",
    schema: || schemars::schema_for!(schema::Recording).to_value(),
    resolve: |text, document, folder| {
        let written = as_written(text)?;
        resolve::resolve(written, document, folder).map(|case| Case::Recording(Box::new(case)))
    },
    example: EXAMPLE,
};

/// Values of the example: a 27-tooth gear with one tachometer pulse a turn in the same file. The recording is the user's own, so that it is
/// looked for when the case runs, not when it is checked.
const EXAMPLE: &[(&str, &str)] = &[
    ("kind", "\"recording\""),
    ("title", "\"27-tooth gear\""),
    ("signal.file", "\"recording.csv\""),
    ("signal.rate_hz", "5120.0"),
    ("tachometer.channel", "\"tacho\""),
    ("gear.teeth", "27"),
];
