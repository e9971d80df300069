//! Printed results of the dissertation against computed ones.

mod classifier;
mod damage;

use std::fmt::Write as _;
use std::path::Path;

/// Chapters that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Chapter {
    /// Statics of cracked and pitted teeth: sections 2.3, 2.4, 3.2 and 3.3.
    Damage,
    /// Damage type and severity from the transmission error: section 3.3 made a classifier, and its confusion table.
    Classifier,
}

/// One number in print and computed.
struct Comparison {
    /// Section, table or figure.
    place: &'static str,
    /// Quantity with its unit.
    quantity: String,
    printed: f64,
    computed: f64,
}

/// Something said in words.
struct Claim {
    place: &'static str,
    text: String,
    found: String,
    holds: bool,
}

/// What a chapter says and what was found.
#[derive(Default)]
pub struct Findings {
    numbers: Vec<Comparison>,
    claims: Vec<Claim>,
}

impl Findings {
    fn number(&mut self, place: &'static str, quantity: String, printed: f64, computed: f64) {
        println!("{place}: {quantity}: printed {printed}, computed {computed:.3}");
        self.numbers.push(Comparison { place, quantity, printed, computed });
    }

    fn claim(&mut self, place: &'static str, text: String, found: String, holds: bool) {
        println!("{place}: {text}: {found} ({})", if holds { "holds" } else { "does not hold" });
        self.claims.push(Claim { place, text, found, holds });
    }

    fn tables(&self) -> Result<String, std::fmt::Error> {
        let mut text = String::from("| place | quantity | printed | computed | difference |\n|---|---|---|---|---|\n");
        for Comparison { place, quantity, printed, computed } in &self.numbers {
            let difference =
                if *printed == 0.0 { "-".to_owned() } else { format!("{:+.1} %", 100.0 * (computed / printed - 1.0)) };
            writeln!(text, "| {place} | {quantity} | {printed} | {computed:.3} | {difference} |")?;
        }
        text.push_str("\n| place | said in words | found | holds |\n|---|---|---|---|\n");
        for Claim { place, text: said, found, holds } in &self.claims {
            writeln!(text, "| {place} | {said} | {found} | {} |", if *holds { "yes" } else { "no" })?;
        }
        Ok(text)
    }
}

/// Compares a chapter and writes its report.
pub fn run(chapter: Chapter) -> anyhow::Result<()> {
    let (file, text) = match chapter {
        Chapter::Damage => {
            let tables = damage::compare()?.tables()?;
            let text = format!("# Damaged teeth against the dissertation\n\n{}\n\n{tables}", damage::TEXT);
            ("dissertation-damage.md", text)
        }
        Chapter::Classifier => ("damage-classifier.md", classifier::report()?),
    };
    std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reports").join(file), text)?;
    println!("written: docs/reports/{file}");
    Ok(())
}
