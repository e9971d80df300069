//! Command line of gearwright.

use std::process::ExitCode;

use clap::Parser as _;
use gearwright::cli::exit::Exit;
use gearwright::cli::{Cli, execute, output};

fn main() -> ExitCode {
    let ended = execute(&Cli::parse()).and_then(|done| output::print(&done.text).map(|()| done.exit));
    match ended {
        Ok(exit) => exit.into(),
        Err(error) => {
            output::note(&format!("error: {}", output::reasons(&error)));
            Exit::of(&error).into()
        }
    }
}
