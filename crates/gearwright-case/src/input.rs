//! Files that a case names, and case files themselves: regular files of limited size, nothing else. Devices and pipes are refused before they are
//! opened: they may never end, or never begin.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

/// Largest case file (bytes).
pub const MAX_CASE: u64 = 4 << 20;
/// Largest table (bytes).
pub const MAX_TABLE: u64 = 64 << 20;
/// Largest mesh (bytes).
pub const MAX_MESH: u64 = 1 << 30;

/// Content of a regular file of at most `most` bytes.
///
/// # Errors
/// Those of the file system; [`io::ErrorKind::InvalidInput`] for anything but a regular file, [`io::ErrorKind::FileTooLarge`] for a larger one.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let found = std::fs::metadata(path)?;
    if !found.is_file() {
        let what = if found.is_dir() { "it is a folder" } else { "it is a device, pipe or socket" };
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("{what}, not a regular file")));
    }
    let large = |size: u64| {
        let reason = format!("it has {size} bytes, at most {most} are read");
        io::Error::new(io::ErrorKind::FileTooLarge, reason)
    };
    if found.len() > most {
        return Err(large(found.len()));
    }
    let mut content = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut content)?;
    // it may have grown
    if content.len() as u64 > most { Err(large(content.len() as u64)) } else { Ok(content) }
}

/// As [`read`], as text.
///
/// # Errors
/// As [`read`]; [`io::ErrorKind::InvalidData`] for bytes that are not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let text = String::from_utf8(read(path, most)?);
    text.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"))
}
