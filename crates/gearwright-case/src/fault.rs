//! Faults of a case file: where, what was found, what is allowed.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// One fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// Line of the case file, from 1; `None` when nothing in the file stands for it.
    pub line: Option<usize>,
    /// Key with its sections, e.g. `pinion.tip_diameter_mm`.
    pub key: String,
    /// Value as written.
    pub value: Option<String>,
    /// What is wrong and what is allowed.
    pub message: String,
}

/// All faults of a file, in the order of its lines; never empty.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseFaults {
    /// The file.
    pub file: PathBuf,
    /// Its faults.
    pub faults: Vec<Fault>,
}

impl CaseFaults {
    /// Faults sorted by line.
    #[must_use]
    pub fn new(file: &Path, mut faults: Vec<Fault>) -> Self {
        faults.sort_by_key(|fault| fault.line.unwrap_or(usize::MAX));
        Self { file: file.to_path_buf(), faults }
    }
}

/// Characters of a file or key, of a value and of a message that are shown.
const SHOWN: [usize; 3] = [200, 120, 4000];
/// Faults that are shown.
const FAULTS: usize = 100;

/// Text for a message: control characters escaped, lines kept, what is too long cut off with its length.
fn shown(text: &str, most: usize) -> String {
    let mut clean = String::new();
    for c in text.chars().take(most) {
        match c {
            '\n' => clean.push(c),
            c if c.is_control() => clean.extend(c.escape_default()),
            c => clean.push(c),
        }
    }
    let all = text.chars().count();
    if all > most {
        clean.push_str(&format!(".. ({} more characters)", all - most));
    }
    clean
}

impl fmt::Display for CaseFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = shown(&self.file.to_string_lossy(), SHOWN[0]);
        for (index, fault) in self.faults.iter().take(FAULTS).enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            match fault.line {
                Some(line) => write!(f, "{file}:{line}: ")?,
                None => write!(f, "{file}: ")?,
            }
            write!(f, "{fault}")?;
        }
        if self.faults.len() > FAULTS {
            write!(f, "\n{file}: {} more faults", self.faults.len() - FAULTS)?;
        }
        Ok(())
    }
}

/// Key, value and message; the line is the caller's.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.key.is_empty() {
            write!(f, "{}", shown(&self.key, SHOWN[0]))?;
            if let Some(value) = &self.value {
                write!(f, " = {}", shown(value, SHOWN[1]))?;
            }
            write!(f, ": ")?;
        }
        write!(f, "{}", shown(&self.message, SHOWN[2]))
    }
}

impl std::error::Error for CaseFaults {}
