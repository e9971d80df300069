//! Printed results of the dissertation against computed ones.

mod damage;

use std::fmt::Write as _;
use std::path::Path;

/// Chapters that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Chapter {
    /// Statics of cracked and pitted teeth: sections 2.3, 3.2 and 3.3.
    Damage,
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

/// Compares a chapter and writes its report.
pub fn run(chapter: Chapter) -> anyhow::Result<()> {
    let (name, title, text, rows) = match chapter {
        Chapter::Damage => ("damage", "Damaged teeth against the dissertation", damage::TEXT, damage::compare()?),
    };
    let mut report = format!(
        "# {title}\n\n{text}\n\n| place | quantity | printed | computed | difference |\n|---|---|---|---|---|\n"
    );
    for row in &rows {
        let Comparison { place, quantity, printed, computed } = row;
        let difference =
            if *printed == 0.0 { "-".to_owned() } else { format!("{:+.1} %", 100.0 * (computed / printed - 1.0)) };
        writeln!(report, "| {place} | {quantity} | {printed} | {computed:.3} | {difference} |")?;
        println!("{place}: {quantity}: printed {printed}, computed {computed:.3} ({difference})");
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../docs/reports/dissertation-{name}.md"));
    std::fs::write(file, report)?;
    println!("written: docs/reports/dissertation-{name}.md");
    Ok(())
}
