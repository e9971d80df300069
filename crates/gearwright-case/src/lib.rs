//! Case files: from TOML text to gears, curves, options and requests in SI units.
//!
//! `text -> document (with lines) -> checked against the schema of its kind -> as written -> resolved (SI)`; every stage tells all its
//! faults at once. A kind is a folder with its `schema` (keys, units, ranges, defaults) and `resolve`, listed in [`kind::KINDS`].
//!
//! | module | holds |
//! |---|---|
//! | [`kind`] | the list of kinds |
//! | [`input`] | files that are read: regular ones of limited size |
//! | [`document`], [`check`], [`mod@reference`], [`template`] | lines of keys, checks against the schema, documentation of keys, `init` files |
//! | [`spur_pair`], [`lumped_pair`], [`dynamics`], [`transmission`], [`recording`] | one kind each: `schema` (as written), `resolve` (SI) |
//!
//! ```
//! use gearwright_case::{self as case, Case, kind, template};
//!
//! let kind = kind::find("spur-pair").ok_or("no such kind")?;
//! let text = template::commented(kind);
//! let Case::SpurPair(case) = case::from_text(&text, "example.toml".as_ref())? else { return Err("another kind".into()) };
//! assert_eq!(case.pair.pinion().teeth(), 25);
//!
//! // a fault is reported with its line and what is allowed
//! let faults = case::from_text(&text.replace("teeth = 25", "teeth = 3"), "example.toml".as_ref()).unwrap_err().to_string();
//! assert!(faults.contains("pinion.teeth"), "{faults}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod check;
pub mod document;
pub mod dynamics;
pub mod fault;
mod geometry;
pub mod input;
pub mod kind;
pub mod lumped_pair;
pub mod notes;
mod physics;
pub mod recording;
pub mod reference;
pub mod spur_pair;
pub mod template;
pub mod transmission;

use std::path::Path;

use serde::de::DeserializeOwned;

pub use dynamics::DynamicsCase;
pub use fault::{CaseFaults, Fault};
use kind::CaseKind;
pub use lumped_pair::LumpedPairCase;
pub use notes::Notes;
pub use recording::RecordingCase;
pub use spur_pair::SpurPairCase;
pub use transmission::TransmissionCase;

/// A case file, checked and resolved.
#[derive(Debug, Clone)]
pub enum Case {
    /// Statics of a spur gear pair.
    SpurPair(Box<SpurPairCase>),
    /// Lumped-parameter dynamics of a gear pair.
    LumpedPair(Box<LumpedPairCase>),
    /// Finite-element/contact-mechanics dynamics of a gear pair.
    Dynamics(Box<DynamicsCase>),
    /// Vibration of a planetary transmission.
    Transmission(Box<TransmissionCase>),
    /// Condition indicators of recorded vibration.
    Recording(Box<RecordingCase>),
}

impl Case {
    /// Value of the key `kind`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::SpurPair(_) => spur_pair::KIND.name,
            Self::LumpedPair(_) => lumped_pair::KIND.name,
            Self::Dynamics(_) => dynamics::KIND.name,
            Self::Transmission(_) => transmission::KIND.name,
            Self::Recording(_) => recording::KIND.name,
        }
    }

    /// Warnings and assumptions.
    #[must_use]
    pub fn notes(&self) -> &Notes {
        match self {
            Self::SpurPair(case) => &case.notes,
            Self::LumpedPair(case) => &case.notes,
            Self::Dynamics(case) => &case.notes,
            Self::Transmission(case) => &case.notes,
            Self::Recording(case) => &case.notes,
        }
    }
}

/// Reads, checks and resolves a case file.
///
/// # Errors
/// All faults of the file.
pub fn load(file: &Path) -> Result<Case, CaseFaults> {
    from_text(&read(file)?, file)
}

/// Reads a case file that must be a spur pair.
///
/// # Errors
/// All faults of the file, or its kind.
pub fn load_spur_pair(file: &Path) -> Result<SpurPairCase, CaseFaults> {
    match resolved(&read(file)?, file, Some(&spur_pair::KIND))? {
        Case::SpurPair(case) => Ok(*case),
        other => Err(wrong_kind(file, other.kind(), spur_pair::KIND.name)),
    }
}

/// Reads a case file that must be a recording.
///
/// # Errors
/// All faults of the file, or its kind.
pub fn load_recording(file: &Path) -> Result<RecordingCase, CaseFaults> {
    match resolved(&read(file)?, file, Some(&recording::KIND))? {
        Case::Recording(case) => Ok(*case),
        other => Err(wrong_kind(file, other.kind(), recording::KIND.name)),
    }
}

fn wrong_kind(file: &Path, found: &str, wanted: &str) -> CaseFaults {
    let message = format!("must be \"{wanted}\" here; `gearwright run` takes every kind");
    let value = Some(format!("\"{found}\""));
    CaseFaults::new(file, vec![Fault { line: None, key: "kind".into(), value, message }])
}

fn read(file: &Path) -> Result<String, CaseFaults> {
    input::read_text(file, input::MAX_CASE).map_err(|error| {
        let message = match error.kind() {
            std::io::ErrorKind::NotFound => {
                "there is no such file; `gearwright init spur-pair FILE` writes one to start from".to_owned()
            }
            _ => format!("cannot be read: {error}"),
        };
        CaseFaults::new(file, vec![Fault { line: None, key: String::new(), value: None, message }])
    })
}

/// Checks and resolves the text of a case file; `file` names it in faults, and files it refers to are looked for beside it.
///
/// # Errors
/// All faults of the text.
pub fn from_text(text: &str, file: &Path) -> Result<Case, CaseFaults> {
    resolved(text, file, None)
}

/// As [`from_text`]; a file of another kind than the one wanted is refused before it is resolved, so that files cannot refer to
/// each other in circles.
fn resolved(text: &str, file: &Path, wanted: Option<&CaseKind>) -> Result<Case, CaseFaults> {
    let one = |fault| CaseFaults::new(file, vec![fault]);
    let document = document::parse(text).map_err(one)?;
    let kind = check::kind(&document).map_err(one)?;
    if let Some(wanted) = wanted.filter(|wanted| wanted.name != kind.name) {
        return Err(wrong_kind(file, kind.name, wanted.name));
    }
    let faults = check::faults(&document, kind);
    if !faults.is_empty() {
        return Err(CaseFaults::new(file, faults));
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    (kind.resolve)(text, &document, folder).map_err(|faults| CaseFaults::new(file, faults))
}

/// The file as its kind's schema has it; what the schema check let through but the types do not is told with its line.
fn as_written<T: DeserializeOwned>(text: &str) -> Result<T, Vec<Fault>> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map(|span| text[..span.start].matches('\n').count() + 1);
        vec![Fault { line, key: String::new(), value: None, message: error.message().to_owned() }]
    })
}
