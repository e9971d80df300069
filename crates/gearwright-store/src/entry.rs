//! One value in one file: caches and checkpoints.
//!
//! The first line holds the hash of the program, of the key and of the content; the rest is the content as JSON. A value is returned only if
//! all three agree, so a damaged file, or one of another case or another program, is never taken up.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::digest::{Digest, program};
use crate::error::{StoreError, refused};
use crate::file_system::{FileSystem, Kind};

const FORMAT: &str = "gearwright entry 1";

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Found<T> {
    /// A value.
    Value(T),
    /// There is no file.
    Absent,
    /// A file that is not taken up, and why.
    Ignored(Ignored),
}

/// Why a file is not taken up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ignored {
    /// Its content does not fit its checksum, or it cannot be read.
    Damaged,
    /// Another key: another case.
    OtherKey,
    /// Another program wrote it, or the hash of this one is unknown.
    OtherProgram,
}

impl std::fmt::Display for Ignored {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Damaged => "it is damaged",
            Self::OtherKey => "it belongs to another case",
            Self::OtherProgram => "another build of the program wrote it",
        })
    }
}

fn header(program: Digest, key: Digest, content: Digest) -> String {
    format!("{FORMAT} program {program} key {key} content {content}\n")
}

/// Reads a value.
#[must_use]
pub fn read_entry<T: DeserializeOwned>(disk: &dyn FileSystem, file: &Path, key: Digest) -> Found<T> {
    match disk.kind(file) {
        Ok(None) => return Found::Absent,
        Ok(Some(Kind::File)) => {}
        _ => return Found::Ignored(Ignored::Damaged),
    }
    let Ok(bytes) = disk.read(file) else { return Found::Ignored(Ignored::Damaged) };
    let found = || -> Option<(Digest, Digest, &[u8])> {
        let end = bytes.iter().position(|byte| *byte == b'\n')?;
        let (line, content) = (std::str::from_utf8(&bytes[..end]).ok()?, &bytes[end + 1..]);
        let words: Vec<&str> = line.strip_prefix(FORMAT)?.split_whitespace().collect();
        let ["program", program, "key", key, "content", own] = words[..] else { return None };
        (own.parse() == Ok(Digest::of(content))).then_some((program.parse().ok()?, key.parse().ok()?, content))
    };
    let Some((of_program, of_key, content)) = found() else { return Found::Ignored(Ignored::Damaged) };
    if of_key != key {
        return Found::Ignored(Ignored::OtherKey);
    }
    if Some(of_program) != program() {
        return Found::Ignored(Ignored::OtherProgram);
    }
    serde_json::from_slice(content).map_or(Found::Ignored(Ignored::Damaged), Found::Value)
}

/// Writes a value; the file holds the old value or the new one at any time. Two writers of one file must exclude each other. Nothing is written
/// by a program that does not know its own hash.
///
/// # Errors
/// Values that JSON cannot hold, and those of the file system.
pub fn write_entry(disk: &dyn FileSystem, file: &Path, key: Digest, value: &impl Serialize) -> Result<(), StoreError> {
    let Some(program) = program() else { return Ok(()) };
    let content = serde_json::to_vec(value).map_err(|error| refused(file, "written")(error.into()))?;
    let mut bytes = header(program, key, Digest::of(&content)).into_bytes();
    bytes.extend(content);
    let temporary = temporary(file);
    disk.write(&temporary, &bytes).map_err(refused(&temporary, "written"))?;
    disk.rename(&temporary, file).map_err(refused(file, "written"))?;
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    disk.sync(folder, Kind::Folder).map_err(refused(folder, "synced"))
}

/// Removes a value, with what a killed writer left of it.
///
/// # Errors
/// Those of the file system.
pub fn remove_entry(disk: &dyn FileSystem, file: &Path) -> Result<(), StoreError> {
    for file in [temporary(file).as_path(), file] {
        if disk.kind(file).map_err(refused(file, "read"))?.is_some() {
            disk.remove_file(file).map_err(refused(file, "removed"))?;
        }
    }
    Ok(())
}

/// Where a value is written before it takes its place.
fn temporary(file: &Path) -> std::path::PathBuf {
    let mut name = file.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    file.with_file_name(name)
}
