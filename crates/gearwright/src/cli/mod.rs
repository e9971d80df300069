//! Commands.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Parser, Subcommand};

use crate::run;
use gearwright_case::kind::{self, CaseKind};
use gearwright_case::{self as case, Case, Notes, reference, template};

use exit::{Exit, Stopped, refused};

pub mod exit;
mod hums;
pub mod output;
mod progress;
mod verify;

/// Threads a run may start.
const MAX_THREADS: usize = 1024;

/// Spur gear contact and dynamics from a TOML case file.
#[derive(Debug, Parser)]
#[command(name = "gearwright", version, about, max_term_width = 100, after_help = exit::HELP)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a case and write tables, plots, ParaView files and a summary.
    Run {
        /// Case file.
        case: PathBuf,
        /// Results folder; default: out/<name of the case file>.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Threads, 1 to 1024; default: one per core. Results do not depend on it.
        #[arg(long, value_parser = threads)]
        threads: Option<usize>,
    },
    /// Compare a results folder with its manifest: changed and missing files.
    Verify {
        /// Results folder.
        folder: PathBuf,
    },
    /// Condition indicators of recorded vibration: averages, indicators, verdicts, trends.
    Hums(Box<hums::Flags>),
    /// Validate a case without running it.
    Check {
        /// Case file.
        case: PathBuf,
    },
    /// Write a commented case file to start from.
    Init {
        /// Kind of case: spur-pair, lumped-pair, dynamics, transmission, recording.
        kind: String,
        /// File to write; default: <kind>.toml.
        file: Option<PathBuf>,
    },
    /// Say what a key of the case file means; without a key, list all.
    Explain {
        /// Key with or without its sections, e.g. tip_relief_um or pinion.hub.condition.
        key: Option<String>,
    },
    /// Print the JSON schema of a kind of case file, for editors.
    Schema {
        /// Kind of case: see `gearwright init --help`.
        kind: String,
    },
}

/// What a command ends with.
#[derive(Debug)]
pub struct Done {
    /// Text for standard output.
    pub text: String,
    /// How the program ends.
    pub exit: Exit,
}

/// A number of threads on the command line.
fn threads(text: &str) -> Result<usize, String> {
    let allowed = || format!("must be a whole number from 1 to {MAX_THREADS}");
    text.parse().ok().filter(|count| (1..=MAX_THREADS).contains(count)).ok_or_else(allowed)
}

/// Runs the command line.
///
/// # Errors
/// The message for the user; [`Exit::of`] gives its exit code.
pub fn execute(cli: &Cli) -> anyhow::Result<Done> {
    let text = match &cli.command {
        Command::Run { case, out, threads } => {
            return run_case(&case::load(case)?, case, out.as_deref(), *threads);
        }
        Command::Hums(flags) => {
            let (loaded, file) = flags.load()?;
            return run_case(&loaded, &file, flags.out.as_deref(), flags.threads);
        }
        Command::Verify { folder } => return verify::verify(folder),
        Command::Check { case: file } => {
            let case = case::load(file)?;
            Ok(format!("{}{}{}: valid{}\n", about(&case)?, case.notes(), file.display(), with_warnings(case.notes())))
        }
        Command::Init { kind, file } => init(kind, file.as_deref()),
        Command::Explain { key } => explain(key.as_deref()),
        Command::Schema { kind } => Ok(format!("{}\n", serde_json::to_string_pretty(&(known_kind(kind)?.schema)())?)),
    };
    Ok(Done { text: text?, exit: Exit::Usable })
}

/// Runs a case; `file` names its results.
fn run_case(loaded: &Case, file: &Path, out: Option<&Path>, threads: Option<usize>) -> anyhow::Result<Done> {
    let target = match out {
        Some(folder) => folder.to_path_buf(),
        None => Path::new("out").join(file.file_stem().unwrap_or_default()),
    };
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(count) = threads {
        pool = pool.num_threads(count);
    }
    let pool = pool.build().context("threads cannot be started")?;
    let Notes { warnings, assumptions } = loaded.notes().clone();
    let warnings = Notes { warnings, ..Notes::default() }.to_string();
    if !warnings.is_empty() {
        output::note(warnings.trim_end());
    }
    let observer = progress::Terminal::new();
    let finished = pool.install(|| run::run(loaded, &target, &observer));
    observer.finish();
    // whatever a stopped run reports, it was stopped
    let finished = finished.map_err(|error| match observer.is_stopped() {
        true => Stopped(output::reasons(&error)).into(),
        false => error,
    })?;
    let run::Unusable { count, total, what } = finished.unusable;
    if count > 0 {
        output::note(&format!(
            "warning: {count} of {total} {what} have no usable answer; the status columns of the tables say why"
        ));
    }
    let exit = if count > 0 { Exit::Unusable } else { Exit::Usable };
    let assumed = Notes { assumptions, ..Notes::default() };
    Ok(Done { text: format!("{}{assumed}  results in {}\n", finished.screen, finished.folder.display()), exit })
}

fn with_warnings(notes: &Notes) -> String {
    match notes.warnings.len() {
        0 => String::new(),
        1 => ", with 1 warning".to_owned(),
        count => format!(", with {count} warnings"),
    }
}

fn init(kind: &str, file: Option<&Path>) -> anyhow::Result<String> {
    let kind = known_kind(kind)?;
    let default = PathBuf::from(format!("{}.toml", kind.name));
    let file = file.unwrap_or(&default);
    if file.exists() {
        return Err(refused(format!("{} exists; choose another name", file.display())));
    }
    std::fs::write(file, template::commented(kind)).with_context(|| format!("{} cannot be written", file.display()))?;
    Ok(format!("wrote {}; run it with: gearwright run {}\n", file.display(), file.display()))
}

/// What a valid case comes to, one line each.
fn about(case: &Case) -> anyhow::Result<String> {
    Ok(match case {
        Case::SpurPair(case) => {
            format!("{} positions, contact ratio {:.3}\n", case.mesh_cycles.len(), case.pair.contact_ratio())
        }
        Case::Recording(case) => {
            let mesh = case.rule.mesh_orders.first().copied().unwrap_or_default();
            let there = if case.signal.exists() { "" } else { " (not there yet)" };
            format!("{}{there}: {mesh} mesh cycles in a period of {} turns\n", case.signal.display(), case.period_turns)
        }
        Case::Dynamics(case) => {
            let speeds: Vec<String> =
                case.speeds.iter().map(|w| format!("{:.1}", w * 30.0 / std::f64::consts::PI)).collect();
            let states = 1 + case.severities.len();
            // the stiffness of the mesh takes the healthy gears
            let steps = gearwright_study::dynamics::steps_told(case)?;
            format!("{} rpm, {} mesh cycles recorded, {states} states\n{steps}", speeds.join(", "), case.cycles)
        }
        Case::Transmission(case) => {
            let (speeds, train) = (&case.speeds, &case.train);
            format!(
                "{} planets, carrier {:.1} rpm, planetary mesh frequency {:.1} Hz, planet pass {:.3} Hz\n\
                 same teeth of sun and ring meet again after {} carrier turns, all teeth after {}\n\
                 {} sensors, {} states\n",
                train.planets(),
                speeds.carrier * 30.0 / std::f64::consts::PI,
                speeds.mesh_frequency,
                speeds.planet_pass_frequency,
                train.sun_ring_period(),
                train.hunting_period(),
                case.sensors.len(),
                1 + case.severities.len()
            )
        }
        Case::LumpedPair(case) => {
            let (mass, force) = (case.pair.effective_mass(), case.pair.mean_force());
            format!("moving mass {mass:.4} kg, mean mesh force {force:.1} N, {} damaged states\n", case.damaged.len())
        }
    })
}

fn known_kind(name: &str) -> anyhow::Result<&'static CaseKind> {
    kind::find(name).ok_or_else(|| refused(format!("there is no kind of case \"{name}\"; known: {}", kind::names())))
}

fn explain(key: Option<&str>) -> anyhow::Result<String> {
    // a key that several kinds share is told once
    let mut all: Vec<reference::KeyReference> = Vec::new();
    for entry in kind::KINDS.iter().flat_map(reference::keys) {
        if !all.contains(&entry) {
            all.push(entry);
        }
    }
    let Some(key) = key else {
        return Ok(all.iter().filter(|k| !k.is_section).map(|k| format!("{}\n", k.key)).collect());
    };
    let found: Vec<_> = all.iter().filter(|k| k.key == key || k.key.ends_with(&format!(".{key}"))).collect();
    if found.is_empty() {
        let likeness =
            |k: &reference::KeyReference| strsim::jaro_winkler(key, k.key.rsplit('.').next().unwrap_or_default());
        let near = all.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        let near = near.map_or("", |k| &k.key);
        return Err(refused(format!("there is no key \"{key}\"; the nearest is \"{near}\"")));
    }
    let mut text = String::new();
    for entry in found {
        let state = match (&entry.default, entry.required) {
            (Some(default), _) => format!("default {default}"),
            (None, true) => "required".to_owned(),
            (None, false) => "optional".to_owned(),
        };
        text.push_str(&format!("{}\n  {}\n  allowed: {}; {state}\n", entry.key, entry.text, entry.allowed));
    }
    Ok(text)
}
