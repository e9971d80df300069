//! Stiff and extreme cases of all crates: each ends in an answer with its residuals, or in a typed error that says why.
//!
//! A case says beforehand which of the two it expects. It fails if it ends in the other, panics, holds a number that is not finite, exceeds a
//! limit of its table, or gives an error that is none of the crates' own. One failure makes the command fail.

mod damage;
mod dynamics;
mod geometry;
mod hums;
mod lumped;
#[path = "../../../crates/fecm/tests/common/proportions.rs"]
mod pairs;
mod statics;
mod transmission;

use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use anyhow::{Context, ensure};

const REPORT: &str = "docs/reports/stability.md";

/// What a case gives.
pub struct Answer {
    /// In a few words.
    said: String,
    /// Residuals in the order of the table's columns; none where it has no meaning.
    residuals: Vec<Option<f64>>,
    /// What is wrong with it besides.
    faults: Vec<String>,
}

/// How a case ended.
enum Outcome {
    Answered(Answer),
    Refused(String),
    Failed(String),
}

struct Row {
    case: String,
    outcome: Outcome,
    seconds: f64,
}

/// Cases of one part.
pub struct Table {
    title: &'static str,
    about: &'static str,
    /// Residuals with what they may be.
    residuals: &'static [(&'static str, f64)],
    rows: Vec<Row>,
}

impl Answer {
    /// An answer.
    fn new(said: impl Into<String>, residuals: Vec<Option<f64>>) -> Self {
        Self { said: said.into(), residuals, faults: Vec::new() }
    }

    /// With numbers that must be finite.
    fn with_finite(mut self, what: &str, mut values: impl Iterator<Item = f64>) -> Self {
        if values.any(|v| !v.is_finite()) {
            self.faults.push(format!("{what} not finite"));
        }
        self
    }

    /// With something that must hold.
    fn with(mut self, holds: bool, otherwise: impl Into<String>) -> Self {
        if !holds {
            self.faults.push(otherwise.into());
        }
        self
    }
}

impl Table {
    fn new(title: &'static str, about: &'static str, residuals: &'static [(&'static str, f64)]) -> Self {
        Self { title, about, residuals, rows: Vec::new() }
    }

    /// A case that must have an answer.
    fn answered(&mut self, case: impl Into<String>, compute: impl FnOnce() -> anyhow::Result<Answer>) {
        self.add(case.into(), compute, |table, outcome| match outcome {
            Outcome::Answered(answer) => match table.faults(&answer) {
                faults if faults.is_empty() => Outcome::Answered(answer),
                faults => Outcome::Failed(format!("{}: {}", answer.said, faults.join("; "))),
            },
            Outcome::Refused(why) => Outcome::Failed(format!("an answer is expected: {why}")),
            failed => failed,
        });
    }

    /// A case that must be refused.
    fn refused(&mut self, case: impl Into<String>, compute: impl FnOnce() -> anyhow::Result<Answer>) {
        self.add(case.into(), compute, |_, outcome| match outcome {
            Outcome::Answered(answer) => Outcome::Failed(format!("an error is expected: {}", answer.said)),
            other => other,
        });
    }

    fn add(
        &mut self,
        case: String,
        compute: impl FnOnce() -> anyhow::Result<Answer>,
        judge: impl FnOnce(&Self, Outcome) -> Outcome,
    ) {
        let clock = Instant::now();
        let outcome = match catch_unwind(AssertUnwindSafe(compute)) {
            Ok(Ok(answer)) => Outcome::Answered(answer),
            Ok(Err(error)) if is_typed(&error) => Outcome::Refused(format!("{error:#}").replace(['\n', '|'], " ")),
            Ok(Err(error)) => Outcome::Failed(format!("an error of no crate: {error:#}")),
            Err(_) => Outcome::Failed("panicked".into()),
        };
        let seconds = clock.elapsed().as_secs_f64();
        let outcome = judge(self, outcome);
        if let Outcome::Failed(why) = &outcome {
            println!("FAILED {}: {case}: {why}", self.title);
        }
        self.rows.push(Row { case, outcome, seconds });
    }

    fn faults(&self, answer: &Answer) -> Vec<String> {
        let beyond = |(&(name, limit), value): (&(&str, f64), &Option<f64>)| {
            let value = (*value)?;
            (!value.is_finite() || value.abs() > limit).then(|| format!("{name} {value:.1e} exceeds {limit:.0e}"))
        };
        let mut faults: Vec<String> = self.residuals.iter().zip(&answer.residuals).filter_map(beyond).collect();
        faults.extend(answer.faults.iter().cloned());
        faults
    }

    fn failures(&self) -> usize {
        self.rows.iter().filter(|row| matches!(row.outcome, Outcome::Failed(_))).count()
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        writeln!(out, "\n## {}\n\n{}\n", self.title, self.about)?;
        let heads: String = self.residuals.iter().map(|(name, limit)| format!(" {name} (≤ {limit:.0e}) |")).collect();
        writeln!(out, "| case | outcome |{heads} time (s) |")?;
        writeln!(out, "|---|---|{}---|", "---|".repeat(self.residuals.len()))?;
        for Row { case, outcome, seconds } in &self.rows {
            let (said, residuals) = match outcome {
                Outcome::Answered(answer) => (answer.said.clone(), answer.residuals.as_slice()),
                Outcome::Refused(why) => (format!("refused: {why}"), &[][..]),
                Outcome::Failed(why) => (format!("**FAILED**: {why}"), &[][..]),
            };
            let cells: String = (0..self.residuals.len())
                .map(|k| residuals.get(k).copied().flatten().map_or(" |".into(), |v| format!(" {v:.1e} |")))
                .collect();
            writeln!(out, "| {case} | {said} |{cells} {seconds:.2} |")?;
        }
        Ok(())
    }
}

/// Whether an error is one of the crates' own.
fn is_typed(error: &anyhow::Error) -> bool {
    error.is::<gear_geom::GeometryErrors>()
        || error.is::<gear_geom::GeometryError>()
        || error.is::<fecm::FecmError>()
        || error.is::<lpm::LpmError>()
        || error.is::<::hums::HumsError>()
        || error.is::<gear_geom::TrainError>()
        || error.is::<planetary::PlanetaryError>()
        || error.is::<planetary::mesh::MeshError>()
        || error.is::<planetary::housing::HousingError>()
}

/// Runs all cases and writes the report.
///
/// # Errors
/// Cases that fail, after the report is written; the file system's.
pub fn run() -> anyhow::Result<()> {
    let clock = Instant::now();
    let parts: [fn() -> Table; 7] = [
        geometry::cases,
        statics::cases,
        damage::cases,
        dynamics::cases,
        lumped::cases,
        hums::cases,
        transmission::cases,
    ];
    let mut text = String::new();
    let (mut cases, mut refused, mut failed) = (0, 0, 0);
    for part in parts {
        let table = part();
        println!("{}: {} cases, {} failed", table.title, table.rows.len(), table.failures());
        cases += table.rows.len();
        refused += table.rows.iter().filter(|row| matches!(row.outcome, Outcome::Refused(_))).count();
        failed += table.failures();
        table.write(&mut text)?;
    }
    let head = format!(
        "# Stiff and extreme cases\n\nWritten by `cargo xtask stability`: {cases} cases in {:.0} s; {} answered, {refused} refused as they should be, {failed} failed.\n\n\
         Each case says beforehand whether it has an answer. An answer is taken if all its numbers are finite and its residuals are below the limits in the heads of \
         the columns; a refusal, if it is an error of the crate's own type, whose text stands in the table. Anything else fails, and the command with it.\n",
        clock.elapsed().as_secs_f64(),
        cases - refused - failed,
    );
    std::fs::write(crate::reproduce::root().join(REPORT), head + &text)
        .with_context(|| format!("{REPORT} cannot be written"))?;
    println!("written: {REPORT}");
    ensure!(failed == 0, "{failed} of {cases} cases failed");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(expect_answer: bool, compute: impl FnOnce() -> anyhow::Result<Answer>) -> usize {
        let mut table = Table::new("t", "", &[("r", 1e-9)]);
        if expect_answer {
            table.answered("c", compute)
        } else {
            table.refused("c", compute)
        }
        table.failures()
    }

    fn geometry_error() -> anyhow::Error {
        gear_geom::Gear::new(&gear_geom::GearSpec::standard(0, 6e-3)).expect_err("no teeth").into()
    }

    #[test]
    fn what_counts_as_failed() {
        assert_eq!(outcome(true, || Ok(Answer::new("", vec![Some(1e-10)]))), 0);
        assert_eq!(outcome(true, || Ok(Answer::new("", vec![None]))), 0);
        assert_eq!(outcome(true, || Ok(Answer::new("", vec![Some(1e-8)]))), 1);
        assert_eq!(outcome(true, || Ok(Answer::new("", vec![Some(f64::NAN)]))), 1);
        assert_eq!(outcome(true, || Ok(Answer::new("", vec![]).with_finite("x", [f64::INFINITY].into_iter()))), 1);
        assert_eq!(outcome(true, || Ok(Answer::new("", vec![]).with(false, "no"))), 1);
        assert_eq!(outcome(true, || Err(geometry_error())), 1);
        assert_eq!(outcome(false, || Err(geometry_error())), 0);
        assert_eq!(outcome(false, || Err(anyhow::anyhow!("untyped"))), 1);
        assert_eq!(outcome(false, || Ok(Answer::new("", vec![]))), 1);
    }
}
