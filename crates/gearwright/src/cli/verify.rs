//! `gearwright verify`: a results folder against its manifest.

use std::path::Path;

use super::Done;
use super::exit::Exit;

/// Files named for each sort of finding.
const SHOWN: usize = 20;

/// Compares a folder.
///
/// # Errors
/// Folders without a manifest, and those of the file system.
pub fn verify(folder: &Path) -> anyhow::Result<Done> {
    let found = gearwright_store::verify(folder)?;
    let mut text = String::new();
    for (what, names) in [("changed", &found.changed), ("missing", &found.missing)] {
        names.iter().take(SHOWN).for_each(|name| text.push_str(&format!("{what}: {name}\n")));
        if names.len() > SHOWN {
            text.push_str(&format!("{what}: {} more\n", names.len() - SHOWN));
        }
    }
    let (changed, missing, other) = (found.changed.len(), found.missing.len(), found.other.len());
    text.push_str(&format!(
        "{}: {} files intact, {changed} changed, {missing} missing, {other} not from gearwright\n",
        folder.display(),
        found.intact
    ));
    Ok(Done { text, exit: if found.is_intact() { Exit::Usable } else { Exit::Unusable } })
}
