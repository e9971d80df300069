//! The dissertation's figures and tables, computed again from the case files, beside the numbers printed there.
//!
//! A figure is one [`Figure`] of the [`registry`] and one function from [`Context`] to [`drawn::Drawn`]: pictures, tables, and values under the keys
//! of `docs/dissertation/printed.toml`. Everything else is common: what is up to date is not computed again ([`store`]), what fails is
//! shown with its error, the page and the report are made from what is there ([`page`], [`report`]), and printed numbers are judged by
//! the tolerance of their kind ([`printed`]).

mod context;
mod drawn;
mod dynamics;
mod figures;
mod page;
mod printed;
mod registry;
mod report;
mod scan;
mod statics;
mod store;
mod vibration;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, bail};

use context::Context;
use drawn::{Done, Outcome};
use printed::Printed;
use registry::{FIGURES, Figure};
use store::Store;

/// How fine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Level {
    /// Coarser along the face and in the contact, fewer loads.
    Quick,
    /// The case files as they stand.
    Full,
}

impl Level {
    /// Name on the page.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Full => "full",
        }
    }
}

/// What to do.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Only these: numbers of figures, "T" before those of tables, as in 3.9,T2.1.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    /// How fine.
    #[arg(long, value_enum, default_value = "full")]
    level: Level,
    /// Folder of the results.
    #[arg(long, default_value = "reproduction")]
    out: PathBuf,
    /// Compute again what is up to date.
    #[arg(long)]
    fresh: bool,
    /// Write docs/reports/dissertation.md, too.
    #[arg(long, conflicts_with = "only")]
    report: bool,
    /// List the figures and tables.
    #[arg(long)]
    list: bool,
    /// Check the data file of printed numbers against the text of the dissertation: nothing is computed.
    #[arg(long, value_name = "TEXT")]
    check_printed: Option<PathBuf>,
}

/// The repository.
pub fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own).to_path_buf()
}

/// Runs the command.
///
/// # Errors
/// Unknown figures, faults of the data file, and what the file system says. Figures that fail are told on the page.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let printed = Printed::load(&root().join("docs/dissertation/printed.toml"))?;
    if let Some(text) = &options.check_printed {
        return scan::check(&printed, text);
    }
    if options.list {
        for figure in FIGURES {
            println!("{:6} {}", figure.id, figure.title);
        }
        return Ok(());
    }
    printed.check_against(FIGURES)?;
    let wanted: Vec<&Figure> =
        FIGURES.iter().filter(|f| options.only.is_empty() || is_named(f, &options.only)).collect();
    if let Some(unknown) = options.only.iter().find(|id| !FIGURES.iter().any(|f| f.id.eq_ignore_ascii_case(id))) {
        bail!("there is no figure or table {unknown}; --list lists them");
    }
    let store = Store::open(&options.out, options.level, options.fresh)?;
    let context = Context::new(&store, options.level);
    let clock = Instant::now();
    let mut all = Vec::new();
    for figure in FIGURES {
        let chosen = wanted.iter().any(|f| f.id == figure.id);
        all.push(Done { figure, outcome: outcome(figure, chosen, &store, &context)? });
    }
    let seconds = clock.elapsed().as_secs_f64();
    let page = page::write(&options.out, &all, &printed, options.level)?;
    if options.report {
        report::write(&all, &printed, options.level)?;
        println!("written: docs/reports/dissertation.md");
    }
    let count = |pick: fn(&Outcome) -> bool| all.iter().filter(|d| pick(&d.outcome)).count();
    println!(
        "{} drawn, {} failed, {} not asked for; {seconds:.0} s",
        count(|o| matches!(o, Outcome::Drawn(_))),
        count(|o| matches!(o, Outcome::Failed(_))),
        count(|o| matches!(o, Outcome::NotAsked))
    );
    println!("written: {}", page.display());
    Ok(())
}

fn is_named(figure: &Figure, only: &[String]) -> bool {
    only.iter().any(|id| figure.id.eq_ignore_ascii_case(id))
}

/// A figure's outcome: kept, computed or failed. Errors are those of the results folder alone.
fn outcome(figure: &'static Figure, chosen: bool, store: &Store, context: &Context) -> anyhow::Result<Outcome> {
    let key = match context.key(figure.cases) {
        Ok(key) => key,
        Err(error) => return Ok(Outcome::Failed(format!("{error:#}"))),
    };
    if let Some(kept) = store.figure(figure.id, &key) {
        return Ok(Outcome::Drawn(kept));
    }
    if !chosen {
        return Ok(Outcome::NotAsked);
    }
    print!("{:6} {} ... ", figure.id, figure.title);
    std::io::Write::flush(&mut std::io::stdout())?;
    let clock = Instant::now();
    let made = catch_unwind(AssertUnwindSafe(|| (figure.compute)(context)))
        .unwrap_or_else(|_| bail!("the computation panicked; its message stands above"));
    match made {
        Ok(mut drawn) => {
            drawn.seconds = clock.elapsed().as_secs_f64();
            let saved = store.keep_figure(figure.id, &key, drawn).with_context(|| format!("figure {}", figure.id))?;
            println!("{:.1} s", saved.seconds);
            Ok(Outcome::Drawn(saved))
        }
        Err(error) => {
            println!("failed: {error:#}");
            Ok(Outcome::Failed(format!("{error:#}")))
        }
    }
}
