//! What goes to standard output and standard error. Neither may be there: a closed pipe ends the output and not the program, anything else that
//! cannot be written is an error.

use std::io::{self, Write as _};

use anyhow::Context;

/// Writes to standard output; nothing is left to write where its reader has gone.
///
/// # Errors
/// A full disk and the like.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output cannot be written")
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error, where there is one.
pub fn note(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}
