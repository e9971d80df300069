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
    match out.write_all(plain(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output cannot be written")
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error, where there is one.
pub fn note(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", plain(line));
}

/// An error with its causes, each reason once: some errors name their cause in their own message.
#[must_use]
pub fn reasons(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

/// Text without control characters but line breaks and tabs: names in files must not steer a terminal.
fn plain(text: &str) -> String {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.chars().map(|c| if steers(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}
