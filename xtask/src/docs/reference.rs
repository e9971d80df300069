//! Reference of the case files, `docs/reference/KIND.md`, from the schemas: the text of `gearwright explain`, as pages.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use gearwright_case::kind::{CaseKind, KINDS};
use gearwright_case::reference::{KeyReference, keys};

/// Folder of the pages, from the root of the repository.
const FOLDER: &str = "docs/reference";

/// Every page with its text.
pub fn pages() -> Vec<(PathBuf, String)> {
    KINDS.iter().map(|kind| (Path::new(FOLDER).join(format!("{}.md", kind.name)), page(kind))).collect()
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
