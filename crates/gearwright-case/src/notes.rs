//! Notes on a valid case: keys without effect, values outside the range of the model, assumptions.
//!
//! Notes are no faults: the case runs. `gearwright check` and `gearwright run` print them, and `summary.json` holds them as `warnings` and `assumptions`.

use std::fmt;

use serde::Serialize;

use super::document::Node;
use super::fault::Fault;

/// Notes on a case.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Notes {
    /// Keys without effect, and values outside the range of the model.
    pub warnings: Vec<Warning>,
    /// What the model assumes, one sentence each.
    pub assumptions: Vec<String>,
}

/// A warning.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Warning {
    /// What kind of warning.
    pub kind: WarningKind,
    /// Key, value and message.
    #[serde(flatten)]
    pub place: Fault,
}

/// Kinds of warnings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WarningKind {
    /// The key has no effect in this case.
    NoEffect,
    /// The model is used outside the range in which it describes a gear well.
    Range,
}

impl Notes {
    /// Warns that the model is used outside its range.
    pub fn warn(&mut self, document: &Node, key: &str, message: impl Into<String>) {
        self.warnings.push(Warning { kind: WarningKind::Range, place: document.fault(key, message) });
    }

    /// Warns of the keys of a section that are given in the file and have no effect.
    pub fn without_effect(&mut self, document: &Node, section: &str, keys: &[&str], because: &str) {
        for key in keys {
            let key = if section.is_empty() { (*key).to_owned() } else { format!("{section}.{key}") };
            if document.find(&key).is_some() {
                let place = document.fault(&key, format!("has no effect: {because}"));
                self.warnings.push(Warning { kind: WarningKind::NoEffect, place });
            }
        }
    }

    /// Adds an assumption.
    pub fn assume(&mut self, sentence: impl Into<String>) {
        self.assumptions.push(sentence.into());
    }

    /// Adds the notes of the case file that a key refers to. Its keys without effect there may have one here.
    pub fn include(&mut self, key: &str, notes: &Self) {
        for warning in notes.warnings.iter().filter(|warning| warning.kind != WarningKind::NoEffect) {
            let place = Fault { line: None, key: format!("{key}: {}", warning.place.key), ..warning.place.clone() };
            self.warnings.push(Warning { place, ..warning.clone() });
        }
        for sentence in &notes.assumptions {
            if !self.assumptions.contains(sentence) {
                self.assume(sentence);
            }
        }
    }
}

impl fmt::Display for Notes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Warning { place, .. } in &self.warnings {
            writeln!(f, "warning: {}{place}", place.line.map_or(String::new(), |line| format!("line {line}: ")))?;
        }
        for assumption in &self.assumptions {
            writeln!(f, "assumption: {assumption}")?;
        }
        Ok(())
    }
}
