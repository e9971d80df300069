//! What CI runs.

use std::process::Command;

use anyhow::{Context, ensure};

/// Runs all checks; with `full` the slow tests too.
pub fn run(full: bool) -> anyhow::Result<()> {
    let test: &[&str] = &["test", "--release", "--workspace"];
    cargo(&["fmt", "--all", "--check"], &[])?;
    cargo(&["clippy", "--release", "--workspace", "--all-targets", "--", "-D", "warnings"], &[])?;
    cargo(&["doc", "--no-deps", "--workspace", "--release"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    cargo(test, &[])?;
    if full {
        cargo(&[test, &["--", "--ignored"]].concat(), &[])?;
    }
    cargo(&["run", "--release", "--", "run", "configs/nonunity-pair.toml"], &[])
}

fn cargo(arguments: &[&str], environment: &[(&str, &str)]) -> anyhow::Result<()> {
    println!("cargo {}", arguments.join(" "));
    let status =
        Command::new(env!("CARGO")).args(arguments).envs(environment.iter().copied()).status().context("cargo")?;
    ensure!(status.success(), "cargo {} failed", arguments.join(" "));
    Ok(())
}
