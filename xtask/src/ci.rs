//! What CI runs.

use std::process::Command;

use anyhow::{Context, ensure};

use crate::docs;

/// Runs all checks; with `full` the slow tests too.
pub fn run(full: bool) -> anyhow::Result<()> {
    let test: &[&str] = &["test", "--release", "--workspace"];
    cargo(&["fmt", "--all", "--check"], &[])?;
    cargo(&["clippy", "--release", "--workspace", "--all-targets", "--", "-D", "warnings"], &[])?;
    docs::run(true, true, full)?;
    cargo(test, &[])?;
    if full {
        cargo(&[test, &["--", "--ignored"]].concat(), &[])?;
    }
    cargo(&["run", "--release", "--", "run", "configs/nonunity-pair.toml"], &[])
}

/// Runs cargo and waits; its output goes to the terminal.
pub fn cargo(arguments: &[&str], environment: &[(&str, &str)]) -> anyhow::Result<()> {
    println!("cargo {}", arguments.join(" "));
    let status =
        Command::new(env!("CARGO")).args(arguments).envs(environment.iter().copied()).status().context("cargo")?;
    ensure!(status.success(), "cargo {} failed", arguments.join(" "));
    Ok(())
}
