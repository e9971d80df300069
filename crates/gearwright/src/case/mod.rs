//! Case files: from TOML text to gears, options and requests in SI units.
//!
//! `text -> document (with lines) -> checked against the schema -> SpurPair (as written) -> SpurPairCase (resolved, SI)`; every stage
//! tells all its faults at once.

pub mod check;
pub mod document;
pub mod fault;
pub mod reference;
pub mod resolve;
pub mod schema;
pub mod template;

use std::path::Path;

pub use fault::{CaseFaults, Fault};
pub use resolve::SpurPairCase;

/// Reads, checks and resolves a case file.
///
/// # Errors
/// All faults of the file.
pub fn load(file: &Path) -> Result<SpurPairCase, CaseFaults> {
    let text = std::fs::read_to_string(file).map_err(|error| {
        let message = match error.kind() {
            std::io::ErrorKind::NotFound => {
                "there is no such file; `gearwright init spur-pair FILE` writes one to start from".to_owned()
            }
            _ => format!("cannot be read: {error}"),
        };
        CaseFaults::new(file, vec![Fault { line: None, key: String::new(), value: None, message }])
    })?;
    from_text(&text, file)
}

/// Checks and resolves the text of a case file; `file` names it in faults, and tables it refers to are looked for beside it.
///
/// # Errors
/// All faults of the text.
pub fn from_text(text: &str, file: &Path) -> Result<SpurPairCase, CaseFaults> {
    let document = document::parse(text).map_err(|fault| CaseFaults::new(file, vec![fault]))?;
    let faults = check::faults(&document);
    if !faults.is_empty() {
        return Err(CaseFaults::new(file, faults));
    }
    let written: schema::SpurPair = toml::from_str(text).map_err(|error| {
        let line = error.span().map(|span| text[..span.start].matches('\n').count() + 1);
        let fault = Fault { line, key: String::new(), value: None, message: error.message().to_owned() };
        CaseFaults::new(file, vec![fault])
    })?;
    let folder = file.parent().unwrap_or(Path::new(""));
    resolve::resolve(written, &document, folder).map_err(|faults| CaseFaults::new(file, faults))
}
