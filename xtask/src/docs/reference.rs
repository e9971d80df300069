//! Reference of case files, `docs/reference/KIND.md`, from the schemas (the text of `gearwright explain`), and of result tables,
//! `docs/reference/results-KIND.md`, from their columns.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use gearwright_case::kind::{CaseKind, KINDS};
use gearwright_case::reference::{KeyReference, keys};
use gearwright_results::table::TableInfo;

/// Folder of the pages, from the root of the repository.
const FOLDER: &str = "docs/reference";

/// Every page with its text.
pub fn pages() -> Vec<(PathBuf, String)> {
    let file = |name: String| Path::new(FOLDER).join(format!("{name}.md"));
    let keys = KINDS.iter().map(|kind| (file(kind.name.to_owned()), page(kind)));
    let results = gearwright_results::schemas();
    keys.chain(results.iter().map(|(kind, tables)| (file(format!("results-{kind}")), results_page(kind, tables))))
        .collect()
}

fn results_page(kind: &str, tables: &[TableInfo]) -> String {
    let mut out = format!(
        "# Result tables of kind `{kind}`\n\n<!-- written by `cargo xtask docs` from the columns; do not edit -->\n\nEvery table is a CSV file of the results \
         folder; which ones there are depends on the case. The parts of names in angle brackets stand for tooth pairs, teeth, sensors and the like.\n"
    );
    for table in tables {
        let _ = write!(
            out,
            "\n## `{}.csv`\n\n{}\n\n| column | meaning | unit |\n|---|---|---|\n",
            table.name,
            cell(table.text)
        );
        for column in &table.columns {
            let _ = writeln!(out, "| `{}` | {} | {} |", column.name, cell(column.text), column.unit);
        }
    }
    out
}

fn page(kind: &CaseKind) -> String {
    let mut out = format!(
        "# Case files of kind `{0}`\n\n<!-- written by `cargo xtask docs` from the schema; do not edit -->\n\nThe file describes {1}. `gearwright init {0}` writes one to \
         start from, `gearwright explain KEY` says the same as this page.\n",
        kind.name, kind.about
    );
    let all = keys(kind);
    let of = |section: &str| -> Vec<&KeyReference> {
        all.iter().filter(|k| !k.is_section && k.key.rsplit_once('.').map_or("", |(at, _)| at) == section).collect()
    };
    table(&mut out, &of(""));
    for section in all.iter().filter(|k| k.is_section) {
        let (open, close) = if section.is_list { ("[[", "]]") } else { ("[", "]") };
        let state = match (section.required, section.is_list) {
            (true, _) => "Required.",
            (false, true) => "As many as wanted, or none.",
            (false, false) => "Optional.",
        };
        let _ = write!(out, "\n## `{open}{}{close}`\n\n{} {state}\n", section.key, cell(&section.text));
        table(&mut out, &of(&section.key));
    }
    out
}

fn table(out: &mut String, keys: &[&KeyReference]) {
    if keys.is_empty() {
        return;
    }
    out.push_str("\n| key | meaning | allowed | default |\n|---|---|---|---|\n");
    for key in keys {
        let name = key.key.rsplit('.').next().unwrap_or(&key.key);
        let default = match (&key.default, key.required) {
            (Some(default), _) => format!("`{default}`"),
            (None, true) => "required".to_owned(),
            (None, false) => String::new(),
        };
        let _ = writeln!(out, "| `{name}` | {} | {} | {default} |", cell(&key.text), cell(&key.allowed));
    }
}

/// Text that does not break a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ").replace('<', "&lt;")
}
