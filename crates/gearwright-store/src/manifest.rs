//! The manifest of a results folder: SHA-256 of every file in it, and of itself.
//!
//! Lines are those of `sha256sum`, so `sha256sum -c manifest.sha256` checks a folder without this program. Comment lines hold the format, the
//! program, and at the end the hash of all lines before.

use std::collections::BTreeMap;
use std::path::Path;

use crate::digest::{Digest, program};
use crate::error::{StoreError, refused};
use crate::file_system::{FileSystem, Kind, Tree};

/// Name of the file.
pub const NAME: &str = "manifest.sha256";
const FORMAT: &str = "# gearwright results 1";
const END: &str = "# end ";

/// Files of a results folder with their hashes, by path below the folder, `/` between its parts.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Manifest {
    /// Hashes.
    pub files: BTreeMap<String, Digest>,
}

/// A results folder against its manifest; paths are below the folder.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Verification {
    /// Files as they were written.
    pub intact: usize,
    /// Files with another content.
    pub changed: Vec<String>,
    /// Files that are not there.
    pub missing: Vec<String>,
    /// Files that are not results.
    pub other: Vec<String>,
}

impl Verification {
    /// Whether every result is as it was written.
    #[must_use]
    pub fn is_intact(&self) -> bool {
        self.changed.is_empty() && self.missing.is_empty()
    }
}

/// Path of a file below its folder; `None` where it is not text, or has a line break in it: such a file is no result.
pub(crate) fn name_below(folder: &Path, file: &Path) -> Option<String> {
    let parts = file.strip_prefix(folder).ok()?.components().map(|part| part.as_os_str().to_str());
    let name = parts.collect::<Option<Vec<_>>>()?.join("/");
    (!name.contains(['\n', '\r', '\\'])).then_some(name)
}

impl Manifest {
    /// Of all files in a folder.
    pub(crate) fn of(disk: &dyn FileSystem, folder: &Path) -> Result<Self, StoreError> {
        let tree = Tree::of(disk, folder).map_err(refused(folder, "listed"))?;
        let mut files = BTreeMap::new();
        for (file, kind) in tree.files {
            let name = name_below(folder, &file).filter(|name| kind == Kind::File && name != NAME);
            let Some(name) = name else { continue };
            files.insert(name, disk.digest(&file).map_err(refused(&file, "read"))?);
        }
        Ok(Self { files })
    }

    /// As a file.
    #[must_use]
    pub fn to_text(&self) -> String {
        let program = program().map_or_else(|| "unknown".to_owned(), |digest| digest.to_string());
        let mut text = format!("{FORMAT}\n# program gearwright {} sha256 {program}\n", env!("CARGO_PKG_VERSION"));
        for (name, digest) in &self.files {
            text.push_str(&format!("{digest}  {name}\n"));
        }
        let own = Digest::of(text.as_bytes());
        text.push_str(&format!("{END}{own}\n"));
        text
    }

    /// From a file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_text(text: &str) -> Result<Self, &'static str> {
        let body = text.strip_suffix('\n').ok_or("its end is missing")?;
        let start = body.rfind('\n').ok_or("its end is missing")? + 1;
        let own = body[start..].strip_prefix(END).ok_or("its end is missing")?;
        if own.parse() != Ok(Digest::of(&text.as_bytes()[..start])) {
            return Err("its checksum does not fit");
        }
        if !text.starts_with(FORMAT) {
            return Err("its format is unknown");
        }
        let mut files = BTreeMap::new();
        for line in body[..start].lines().filter(|line| !line.starts_with('#')) {
            let (digest, name) = line.split_once("  ").ok_or("a line is no hash with a name")?;
            files.insert(name.to_owned(), digest.parse().map_err(|_| "a line is no hash with a name")?);
        }
        Ok(Self { files })
    }

    /// The manifest of a folder; `None` where it has none.
    ///
    /// # Errors
    /// [`StoreError::Damaged`], or those of the file system.
    pub(crate) fn read(disk: &dyn FileSystem, folder: &Path) -> Result<Option<Self>, StoreError> {
        let file = folder.join(NAME);
        if disk.kind(&file).map_err(refused(&file, "read"))? != Some(Kind::File) {
            return Ok(None);
        }
        let bytes = disk.read(&file).map_err(refused(&file, "read"))?;
        // another program's file of this name
        if !bytes.starts_with(FORMAT.as_bytes()) {
            return Ok(None);
        }
        let damaged = |reason| StoreError::Damaged { path: file.clone(), reason };
        let text = std::str::from_utf8(&bytes).map_err(|_| damaged("it is not text"))?;
        Self::from_text(text).map(Some).map_err(damaged)
    }

    /// Whether a file is one of the results, unchanged.
    pub(crate) fn holds(&self, disk: &dyn FileSystem, name: &str, file: &Path) -> Result<bool, StoreError> {
        let Some(digest) = self.files.get(name) else { return Ok(false) };
        Ok(disk.digest(file).map_err(refused(file, "read"))? == *digest)
    }

    /// Compares a folder.
    pub(crate) fn compare(&self, disk: &dyn FileSystem, folder: &Path) -> Result<Verification, StoreError> {
        let tree = Tree::of(disk, folder).map_err(refused(folder, "listed"))?;
        let mut found = Verification::default();
        let mut missing: BTreeMap<&str, Digest> = self.files.iter().map(|(n, d)| (n.as_str(), *d)).collect();
        for (file, kind) in tree.files {
            let name = name_below(folder, &file);
            let expected = name.as_deref().and_then(|name| missing.remove(name));
            let shown = name.unwrap_or_else(|| file.to_string_lossy().into_owned());
            match expected {
                Some(digest) if kind == Kind::File && disk.digest(&file).map_err(refused(&file, "read"))? == digest => {
                    found.intact += 1;
                }
                Some(_) => found.changed.push(shown),
                None if shown != NAME => found.other.push(shown),
                None => {}
            }
        }
        found.missing = missing.into_keys().map(str::to_owned).collect();
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_and_every_cut_is_seen() {
        let files = [("a.csv", "1"), ("speed_1/b c.csv", "2")];
        let files = files.map(|(name, content)| (name.to_owned(), Digest::of(content.as_bytes())));
        let manifest = Manifest { files: files.into() };
        let text = manifest.to_text();
        assert_eq!(Manifest::from_text(&text), Ok(manifest));
        for at in 0..text.len() {
            assert!(Manifest::from_text(&text[..at]).is_err(), "cut at {at}");
            for bit in 0..7 {
                let mut bytes = text.clone().into_bytes();
                bytes[at] ^= 1 << bit;
                let changed = String::from_utf8(bytes).unwrap();
                // upper and lower case of the last line's hexadecimal digits mean the same
                if !changed.eq_ignore_ascii_case(&text) {
                    assert!(Manifest::from_text(&changed).is_err(), "bit {bit} of byte {at}");
                }
            }
        }
    }
}
