//! Kinds of case files: the one list that loading, checking, `init`, `explain` and `schema` go by.

use std::path::Path;

use serde_json::Value as Json;

use super::document::Node;
use super::fault::Fault;
use super::{Case, dynamics, lumped_pair, recording, spur_pair, transmission};

/// A kind of case file.
#[derive(Debug, Clone, Copy)]
pub struct CaseKind {
    /// Value of the key `kind`.
    pub name: &'static str,
    /// What it describes.
    pub about: &'static str,
    /// Its JSON schema (draft 2020-12).
    pub schema: fn() -> Json,
    /// From the text, its document and the folder of its file to the resolved case.
    pub resolve: fn(&str, &Node, &Path) -> Result<Case, Vec<Fault>>,
    /// Keys and values (TOML) of a small case that runs, for `gearwright init`.
    pub example: &'static [(&'static str, &'static str)],
}

/// All kinds.
pub const KINDS: &[CaseKind] =
    &[spur_pair::KIND, lumped_pair::KIND, dynamics::KIND, transmission::KIND, recording::KIND];

/// The kind of a name.
#[must_use]
pub fn find(name: &str) -> Option<&'static CaseKind> {
    KINDS.iter().find(|kind| kind.name == name)
}

/// Names of all kinds, in quotes.
#[must_use]
pub fn names() -> String {
    KINDS.iter().map(|kind| format!("\"{}\"", kind.name)).collect::<Vec<_>>().join(", ")
}
