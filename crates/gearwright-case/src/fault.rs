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

impl fmt::Display for CaseFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = self.file.display();
        for (index, fault) in self.faults.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            match fault.line {
                Some(line) => write!(f, "{file}:{line}: ")?,
                None => write!(f, "{file}: ")?,
            }
            write!(f, "{fault}")?;
        }
        Ok(())
    }
}

/// Key, value and message; the line is the caller's.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.key.is_empty() {
            write!(f, "{}", self.key)?;
            if let Some(value) = &self.value {
                write!(f, " = {value}")?;
            }
            write!(f, ": ")?;
        }
        write!(f, "{}", self.message)
    }
}

impl std::error::Error for CaseFaults {}
