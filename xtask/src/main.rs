//! Development and study commands of the workspace: `cargo xtask help`.

use clap::{Parser, Subcommand};

mod calculix;
mod calculix_housing;
mod ci;
mod compare;
mod damage_classifier;
mod docs;
mod reproduce;
mod scene_costs;
mod stability;
mod train;
mod work_precision;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Development and study commands")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Format, lints, docs, tests and the README's main command; what CI runs.
    Ci {
        /// The slow tests as well.
        #[arg(long)]
        full: bool,
    },
    /// Builds the documentation into target/site and checks links, formulas, citations, commands, case files and code in it.
    Docs {
        /// Take committed pages that are not current for faults instead of writing them.
        #[arg(long)]
        check: bool,
        /// Leave out the crates' API, which takes longest.
        #[arg(long)]
        no_api: bool,
        /// Run the case files that pages name and compare the numbers on the pages with their results.
        #[arg(long)]
        numbers: bool,
    },
    /// Static transmission error against CalculiX (program `ccx`, Debian package calculix-ccx); writes docs/reports/calculix.md.
    PeerCalculix,
    /// Natural frequencies of the default housing against CalculiX; writes docs/reports/calculix-housing.md.
    PeerHousing,
    /// Every number of the result files of all case files before and after a change, to the bit.
    CompareResults(compare::Options),
    /// Confusion table of the damage classifier (dissertation, section 3.3); writes docs/reports/damage-classifier.md.
    DamageClassifier,
    /// Figures and tables of the dissertation, computed again from the case files, beside the printed numbers, on one page.
    ReproduceThesisFigures(reproduce::Options),
    /// What each kind of scene leaves out and what that saves; writes docs/reports/scene-costs.md.
    SceneCosts,
    /// Stiff and extreme cases of all crates; writes docs/reports/stability.md and fails if one of them does.
    Stability,
    /// Error against run time; writes docs/reports/work-precision-STUDY.md and plots.
    WorkPrecision {
        /// What to study; default: everything.
        #[arg(value_enum)]
        study: Option<work_precision::Study>,
    },
}

fn main() -> anyhow::Result<()> {
    match Arguments::parse().command {
        Command::Ci { full } => ci::run(full),
        Command::Docs { check, no_api, numbers } => docs::run(check, !no_api, numbers),
        Command::PeerCalculix => calculix::run(),
        Command::PeerHousing => calculix_housing::run(),
        Command::CompareResults(options) => compare::run(&options),
        Command::DamageClassifier => damage_classifier::run(),
        Command::ReproduceThesisFigures(options) => reproduce::run(&options),
        Command::SceneCosts => scene_costs::run(),
        Command::Stability => stability::run(),
        Command::WorkPrecision { study } => work_precision::run(study),
    }
}
