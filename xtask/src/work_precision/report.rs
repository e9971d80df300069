//! Table and plot of a study.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::anyhow;
use gearwright_plot::{COLOURS, Chart, Line, Pattern};

/// One choice of numerics.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Which parameter is varied.
    pub family: String,
    /// Its value.
    pub setting: String,
    /// Whether this is the default.
    pub is_default: bool,
    /// Wall time (s).
    pub time: f64,
    /// Errors, relative, in the order of the report's quantities.
    pub errors: Vec<f64>,
}

/// A study's results.
#[derive(Debug, Clone)]
pub struct Report {
    /// Name of the files.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// What was done, in a paragraph.
    pub text: String,
    /// Quantities whose error is given.
    pub quantities: Vec<&'static str>,
    /// All choices.
    pub entries: Vec<Entry>,
}

/// Place of a file among the reports.
pub fn reports(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/reports").join(file)
}

impl Report {
    /// Writes `docs/reports/work-precision-<name>.md` and a plot per quantity.
    pub fn write(&self) -> anyhow::Result<()> {
        let mut text = format!("# {}\n\n{}\n\n| varied | value | time (s) |", self.title, self.text);
        for quantity in &self.quantities {
            write!(text, " error of {quantity} |")?;
        }
        text.push_str("\n|---|---|---|");
        text.push_str(&"---|".repeat(self.quantities.len()));
        text.push('\n');
        for entry in &self.entries {
            let mark = if entry.is_default { " (default)" } else { "" };
            let decimals = if entry.time < 0.1 { 5 } else { 3 };
            write!(text, "| {} | {}{mark} | {:.decimals$} |", entry.family, entry.setting, entry.time)?;
            for error in &entry.errors {
                // errors of the order of rounding would all read 0
                let percent = 100.0 * error;
                match percent < 5e-5 && percent > 0.0 {
                    true => write!(text, " {percent:.1e} % |")?,
                    false => write!(text, " {percent:.4} % |")?,
                }
            }
            text.push('\n');
        }
        for (index, quantity) in self.quantities.iter().enumerate() {
            let name = format!("work-precision-{}-{}", self.name, index + 1);
            self.chart(index, quantity).save(&reports, &name).map_err(|e| anyhow!("plot {name}: {e}"))?;
            write!(text, "\n![error of {quantity} over run time]({name}.svg)\n")?;
        }
        let file = format!("work-precision-{}.md", self.name);
        std::fs::write(reports(&file), text)?;
        println!("written: docs/reports/{file}");
        Ok(())
    }

    fn chart(&self, index: usize, quantity: &str) -> Chart {
        let mut families: Vec<&String> = Vec::new();
        for entry in &self.entries {
            if !families.contains(&&entry.family) {
                families.push(&entry.family);
            }
        }
        let patterns = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];
        let point = |entry: &Entry| (entry.time, (100.0 * entry.errors[index]).max(1e-8));
        let mut lines: Vec<Line> = families
            .iter()
            .enumerate()
            .map(|(k, family)| {
                let mut points: Vec<(f64, f64)> =
                    self.entries.iter().filter(|e| e.family == **family).map(point).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Line {
                    name: (*family).clone(),
                    points,
                    pattern: patterns[(k / COLOURS.len()) % 4],
                    colour: COLOURS[k % COLOURS.len()],
                }
            })
            .collect();
        // a cross over the default
        if let Some(default) = self.entries.iter().find(|e| e.is_default) {
            let (x, y) = point(default);
            for (k, points) in
                [vec![(x / 1.25, y / 1.6), (x * 1.25, y * 1.6)], vec![(x / 1.25, y * 1.6), (x * 1.25, y / 1.6)]]
                    .into_iter()
                    .enumerate()
            {
                let name = if k == 0 { "default".to_owned() } else { String::new() };
                lines.push(Line { name, points, pattern: Pattern::Solid, colour: "#ff0000" });
            }
        }
        Chart {
            title: self.title.clone(),
            x_label: "Run time (s)".into(),
            y_label: format!("Error of {quantity} (%)"),
            lines,
            from_zero: false,
            logarithmic: true,
        }
    }
}
