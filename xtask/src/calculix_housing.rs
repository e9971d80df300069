//! Peer: the natural frequencies of the default housing in a conventional finite-element program.
//!
//! CalculiX (`ccx`) gets the very mesh of ours, as its own input format, with the mounts clamped. Mesh, elements and constants are
//! shared; element matrices, assembly and eigenvalue solver are not.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, ensure};
use planetary::housing::inp::{self, Units};
use planetary::housing::{Casing, Damping, Housing, ReductionOptions, Tie};

/// Frequencies compared.
const COUNT: usize = 30;
/// Largest difference that passes.
const AIM: f64 = 0.01;

/// Runs both and writes the report.
pub fn run() -> anyhow::Result<()> {
    let mut housing = Casing::default().housing()?;
    housing.mounts.iter_mut().for_each(|mount| mount.tie = Tie::Fixed);
    let started = Instant::now();
    let options = ReductionOptions { modes: COUNT, highest_frequency: f64::INFINITY, damping: Damping::Ratio(0.0) };
    // modes only: no ports, no seat
    let bare = Housing { mesh: housing.mesh.clone(), mounts: housing.mounts.clone(), ..Housing::default() };
    let reduced = bare.reduce(&options)?;
    let ours_time = started.elapsed();
    let ours: Vec<f64> = reduced.body.frequencies.iter().map(|omega| omega / std::f64::consts::TAU).collect();
    let started = Instant::now();
    let peer = calculix_frequencies(&housing)?;
    let peer_time = started.elapsed();
    ensure!(peer.len() >= COUNT && ours.len() == COUNT, "{} and {} frequencies of {COUNT}", peer.len(), ours.len());
    let mut report = format!(
        "# Natural frequencies of the default housing against CalculiX\n\n\
         Written by `cargo xtask peer-housing`. The same mesh ({} elements, {} unknowns), mounts clamped. Element matrices, assembly and\n\
         eigenvalue solvers are each program's own.\n\n\
         | mode | CalculiX (Hz) | gearwright (Hz) | difference |\n|---|---|---|---|\n",
        housing.mesh.elements.len(),
        reduced.stats.unknowns,
    );
    let mut worst = 0.0_f64;
    for (mode, (ours, peer)) in ours.iter().zip(&peer).enumerate() {
        let difference = ours / peer - 1.0;
        worst = worst.max(difference.abs());
        writeln!(report, "| {} | {peer:.2} | {ours:.2} | {:+.4} % |", mode + 1, 100.0 * difference)?;
    }
    writeln!(
        report,
        "\nLargest difference: {:.4} % (aim: {} %). CalculiX took {:.0} s, gearwright {:.0} s.",
        100.0 * worst,
        100.0 * AIM,
        peer_time.as_secs_f64(),
        ours_time.as_secs_f64(),
    )?;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reports/calculix-housing.md");
    std::fs::write(&file, &report)?;
    println!("largest difference {:.4} %; written: docs/reports/calculix-housing.md", 100.0 * worst);
    ensure!(worst < AIM, "the difference exceeds {} %", 100.0 * AIM);
    Ok(())
}

/// Frequencies (Hz) of a housing whose mounts are clamped.
fn calculix_frequencies(housing: &Housing) -> anyhow::Result<Vec<f64>> {
    let mut text = inp::write(&housing.mesh, &Units::SI);
    text.push_str("*BOUNDARY\n");
    for mount in &housing.mounts {
        writeln!(text, "{}, 1, 3", mount.set)?;
    }
    writeln!(text, "*STEP\n*FREQUENCY\n{COUNT}\n*END STEP")?;
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("housing.inp"), text)?;
    let output = Command::new("ccx")
        .arg("housing")
        .current_dir(folder.path())
        .env("OMP_NUM_THREADS", "1")
        .output()
        .context("ccx cannot be started; on Debian: apt-get install calculix-ccx")?;
    let results = std::fs::read_to_string(folder.path().join("housing.dat")).unwrap_or_default();
    let frequencies = frequencies(&results);
    if frequencies.is_empty() {
        let log = String::from_utf8_lossy(&output.stdout).into_owned();
        let tail: Vec<&str> = log.lines().rev().take(12).collect();
        anyhow::bail!("ccx found no frequencies: {}", tail.into_iter().rev().collect::<Vec<_>>().join("\n"));
    }
    Ok(frequencies)
}

/// Rows of the first table: mode, eigenvalue, circular frequency, frequency, imaginary part.
fn frequencies(results: &str) -> Vec<f64> {
    let row = |line: &str| -> Option<Vec<f64>> {
        let fields: Vec<f64> = line.split_whitespace().map(|field| field.parse().ok()).collect::<Option<_>>()?;
        (fields.len() == 5).then_some(fields)
    };
    let rows = results.lines().skip_while(|line| row(line).is_none()).map_while(row);
    rows.map(|fields| fields[3]).collect()
}
