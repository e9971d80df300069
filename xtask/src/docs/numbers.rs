//! Numbers of pages that come from runs.
//!
//! A page lists them in a comment: a case file, then one line a number, as it is printed on the page and where `summary.json` of the run has it.
//!
//! ```text
//! <!-- numbers of configs/lumped-900hz.toml
//! -5.79 = time_response[state=crack 80 %].smallest_um
//! -->
//! ```
//!
//! The printed number must stand on the page and equal the computed one to its last digit.

use std::collections::HashMap;
use std::path::Path;

use anyhow::Context;
use serde_json::Value;

use super::Fault;
use super::page::Page;

const START: &str = "<!-- numbers of ";

/// Summaries of the case files that pages name, each computed once.
pub struct Runs<'a> {
    root: &'a Path,
    summaries: HashMap<String, Result<Value, String>>,
}

impl<'a> Runs<'a> {
    /// None computed yet; `root` is the root of the repository.
    pub fn new(root: &'a Path) -> Self {
        Self { root, summaries: HashMap::new() }
    }

    /// What is wrong with the numbers of a page.
    pub fn faults(&mut self, page: &Page) -> Vec<Fault> {
        let mut found = Vec::new();
        for list in lists(page.text()) {
            let root = self.root;
            let summary = self
                .summaries
                .entry(list.case.to_owned())
                .or_insert_with(|| summary(root, list.case).map_err(|error| format!("{error:#}")));
            for (line, entry) in &list.entries {
                let message = match summary {
                    Ok(summary) => fault(page.text(), summary, entry),
                    Err(error) => Some(format!("{}: {error}", list.case)),
                };
                found.extend(message.map(|message| Fault { file: page.source.clone(), line: *line, message }));
            }
        }
        found
    }
}

/// A list of numbers of one case.
struct List<'a> {
    case: &'a str,
    /// Line of the page, and what stands there.
    entries: Vec<(usize, &'a str)>,
}

fn lists(text: &str) -> Vec<List<'_>> {
    let mut lists: Vec<List<'_>> = Vec::new();
    let mut inside = false;
    for (index, line) in text.lines().enumerate() {
        if let Some(case) = line.strip_prefix(START) {
            lists.push(List { case: case.trim(), entries: Vec::new() });
            inside = true;
        } else if line.trim() == "-->" {
            inside = false;
        } else if let Some(list) = lists.last_mut().filter(|_| inside) {
            list.entries.push((index + 1, line.trim()));
        }
    }
    lists
}

/// Runs a case and reads its summary.
fn summary(root: &Path, case: &str) -> anyhow::Result<Value> {
    let folder = tempfile::tempdir().context("no temporary folder")?;
    let target = folder.path().join("results");
    let path = root.join(case);
    let arguments = ["run", "--release", "--quiet", "--package", "gearwright", "--", "run"];
    let mut arguments: Vec<_> = arguments.iter().map(std::ffi::OsStr::new).collect();
    arguments.extend([path.as_os_str(), "--out".as_ref(), target.as_os_str()]);
    let status = std::process::Command::new(env!("CARGO")).args(arguments).current_dir(root).status()?;
    anyhow::ensure!(status.success(), "the run ended with {status}");
    let text = std::fs::read_to_string(target.join("summary.json"))?;
    Ok(serde_json::from_str(&text)?)
}

/// What is wrong with one entry, `PRINTED = PLACE`.
fn fault(page: &str, summary: &Value, entry: &str) -> Option<String> {
    let Some((printed, place)) = entry.split_once('=').map(|(a, b)| (a.trim(), b.trim())) else {
        return Some(format!("`{entry}`: a line is `PRINTED = PLACE`"));
    };
    let Ok(expected) = printed.parse::<f64>() else { return Some(format!("`{printed}` is not a number")) };
    let Some(value) = find(summary, place).and_then(Value::as_f64) else {
        return Some(format!("the summary has no number at `{place}`"));
    };
    // twice: in the list, and on the page
    if page.matches(printed).count() < 2 {
        return Some(format!("`{printed}` does not stand on the page"));
    }
    let digits = printed.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let rounded = format!("{value:.digits$}");
    let agrees = rounded.parse::<f64>().is_ok_and(|rounded| rounded.to_bits() == expected.to_bits());
    (!agrees).then(|| format!("`{place}` is printed as {printed} and computed as {rounded}"))
}

/// A place in a summary: names of tables joined by dots; `[number]` or `[key=value]` after a name takes an entry of a list.
fn find<'a>(value: &'a Value, place: &str) -> Option<&'a Value> {
    place.split('.').try_fold(value, |value, step| {
        let mut parts = step.split('[');
        let value = value.get(parts.next()?)?;
        parts.try_fold(value, |value, choice| entry(value, choice.strip_suffix(']')?))
    })
}

/// Entry of a list, by number or by one of its values.
fn entry<'a>(list: &'a Value, choice: &str) -> Option<&'a Value> {
    let Some((key, wanted)) = choice.split_once('=') else { return list.get(choice.parse::<usize>().ok()?) };
    let is_wanted = |own: &Value| match own {
        Value::String(text) => text == wanted,
        other => {
            let printed = other.to_string();
            printed == wanted
        }
    };
    list.as_array()?.iter().find(|entry| entry.get(key).is_some_and(is_wanted))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# Page\n\nThe smallest is -5.79 at 15.2.\n\n<!-- numbers of configs/case.toml\n-5.79 = rows[state=bad].smallest\n\
                        15.2 = rows[1].at\n-->\n\nMore.\n";

    fn summary() -> Value {
        serde_json::json!({
            "rows": [{ "state": "good", "smallest": 1.0 }, { "state": "bad", "smallest": -5.7912, "at": 15.24 }],
            "pairs": [[1.0, 2.0], [3.0, 4.0]],
        })
    }

    #[test]
    fn lists_are_found_with_their_lines() {
        let lists = lists(PAGE);
        assert_eq!(lists.len(), 1);
        assert_eq!(lists[0].case, "configs/case.toml");
        assert_eq!(lists[0].entries, [(6, "-5.79 = rows[state=bad].smallest"), (7, "15.2 = rows[1].at")]);
        assert_eq!(find(&summary(), "pairs[1][0]"), Some(&serde_json::json!(3.0)));
        assert!(lists[0].entries.iter().all(|(_, entry)| fault(PAGE, &summary(), entry).is_none()));
    }

    #[test]
    fn what_differs_is_a_fault() {
        let summary = summary();
        for (entry, part) in [
            ("-5.8 = rows[state=bad].smallest", "does not stand"),
            ("15.2 = rows[state=good].smallest", "computed as 1.0"),
            ("15.2 = rows[7].at", "no number"),
            ("15.2 = rows[0].state", "no number"),
            ("15.2", "PRINTED = PLACE"),
            ("many = rows[1].at", "not a number"),
        ] {
            let message = fault(PAGE, &summary, entry).unwrap_or_default();
            assert!(message.contains(part), "{entry}: {message}");
        }
    }
}
