//! Lumped dynamics: every integration method at every tolerance, smooth and with contact loss, supports soft to stiff.

use std::fmt::Write as _;

use anyhow::anyhow;
use gearwright_plot::{COLOURS, Chart, Line, Pattern};
use lpm::{Supports, WorkPrecision, work_precision};

use super::report::reports;

const NAME: &str = "work-precision-lumped";
/// Tolerances of the study.
const TOLERANCES: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10];
/// Each run is repeated for this long, the shortest time counts (s).
const REPEAT: f64 = 0.003;
/// Tolerance that is the default of case files.
const DEFAULT: f64 = 1e-8;
const PATTERNS: [Pattern; 4] = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];

/// Runs the study.
pub fn run() -> anyhow::Result<()> {
    let rows = work_precision(&TOLERANCES, REPEAT)?;
    let mut problems: Vec<&str> = Vec::new();
    for row in &rows {
        if !problems.contains(&row.problem.as_str()) {
            problems.push(&row.problem);
        }
    }
    let mut text = String::from(
        "# Lumped dynamics: error against run time\n\n\
         Written by `cargo xtask work-precision dynamics-lumped`. Eight mesh cycles of the dissertation's pair at 1800 Hz; error is the largest difference\n\
         of the transmission error over its peak-to-peak value, against a reference at a tolerance of 1e-13. Time is the shortest of repeated runs on\n\
         one core. `eliminated` supports hold the error of the one-coordinate model too: it is what remains at tight tolerances.\n",
    );
    for (index, problem) in problems.iter().enumerate() {
        let own: Vec<&WorkPrecision> = rows.iter().filter(|r| r.problem == *problem).collect();
        let plot = format!("{NAME}-{}", index + 1);
        chart(problem, &own).save(&reports, &plot).map_err(|e| anyhow!("plot {plot}: {e}"))?;
        write!(
            text,
            "\n## {problem}\n\n![error over run time]({plot}.svg)\n\n| method | tolerance | error | time (us) | steps | events |\n\
             |---|---|---|---|---|---|\n"
        )?;
        for row in &own {
            let mark = if row.tolerance == DEFAULT { " (default)" } else { "" };
            writeln!(
                text,
                "| {} | {:.0e}{mark} | {:.1e} | {:.1} | {} | {} |",
                name(row),
                row.tolerance,
                row.error,
                row.seconds * 1e6,
                row.steps,
                row.events
            )?;
        }
        println!("{problem}: {} runs", own.len());
    }
    std::fs::write(reports(&format!("{NAME}.md")), text)?;
    println!("written: docs/reports/{NAME}.md");
    Ok(())
}

fn name(row: &WorkPrecision) -> String {
    let supports = if row.supports == Supports::Eliminated { ", supports eliminated" } else { "" };
    format!("{}{supports}", row.method.name())
}

fn chart(problem: &str, rows: &[&WorkPrecision]) -> Chart {
    let mut methods: Vec<String> = Vec::new();
    for row in rows {
        if !methods.contains(&name(row)) {
            methods.push(name(row));
        }
    }
    let lines = methods.iter().enumerate().map(|(index, method)| Line {
        name: method.clone(),
        // errors at rounding would stretch the axis
        points: rows.iter().filter(|r| name(r) == *method).map(|r| (r.seconds * 1e6, r.error.max(1e-13))).collect(),
        pattern: PATTERNS[index % PATTERNS.len()],
        colour: COLOURS[index % COLOURS.len()],
    });
    Chart {
        title: problem.to_owned(),
        x_label: "Run time (µs)".into(),
        y_label: "Largest error over peak to peak".into(),
        lines: lines.collect(),
        from_zero: false,
        logarithmic: true,
    }
}
