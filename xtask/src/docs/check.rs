//! Whether what the pages tell a reader to type exists: commands, case files, keys, paths, runnable Rust.

use std::collections::BTreeSet;
use std::path::Path;

use clap::Parser;
use gearwright::cli::Cli;
use gearwright_case::{self as case, kind, template};

use super::Fault;
use super::page::{Block, Page};

/// File whose documentation tests are the Rust blocks of pages.
const DOCTESTS: &str = "tests/src/lib.rs";

/// Faults of a page; `root` is the root of the repository.
pub fn faults(page: &Page, root: &Path) -> Vec<Fault> {
    let mut found: Vec<(usize, String)> = Vec::new();
    for block in &page.blocks {
        match block.language.as_str() {
            "sh" | "console" => commands(block, root, &mut found),
            "toml" => found.extend(toml_fault(&block.text, root).map(|message| (block.line, message))),
            "rust" => {
                let name = format!("{:?}", format!("../../{}", page.source.display()));
                if !std::fs::read_to_string(root.join(DOCTESTS)).is_ok_and(|text| text.contains(&name)) {
                    found.push((block.line, format!("Rust that is not run: include the page in {DOCTESTS}")));
                }
            }
            "text" | "" => {}
            other => found.push((block.line, format!("block in \"{other}\": known are sh, toml, rust, text"))),
        }
    }
    for (line, code) in &page.codes {
        let is_command = ["cargo ", "gearwright "].iter().any(|start| code.starts_with(start));
        if is_command {
            found.extend(command_fault(code, root).map(|message| (*line, message)));
        }
        let is_history = page.source == Path::new("CHANGELOG.md");
        for missing in code.split_whitespace().flat_map(|word| missing_paths(word, root)).filter(|_| !is_history) {
            found.push((*line, format!("there is no {missing}")));
        }
    }
    found.into_iter().map(|(line, message)| Fault { file: page.source.clone(), line, message }).collect()
}

fn commands(block: &Block, root: &Path, found: &mut Vec<(usize, String)>) {
    for (offset, line) in block.text.lines().enumerate() {
        let line = line.trim().trim_start_matches("$ ");
        let command = line.split(" #").next().unwrap_or(line).trim();
        if command.is_empty() || command.starts_with('#') {
            continue;
        }
        found.extend(command_fault(command, root).map(|message| (block.line + offset, message)));
        for missing in command.split_whitespace().flat_map(|word| missing_paths(word, root)) {
            found.push((block.line + offset, format!("there is no {missing}")));
        }
    }
}

/// What is wrong with a command line.
fn command_fault(command: &str, root: &Path) -> Option<String> {
    let words: Vec<&str> = command.split_whitespace().take_while(|word| *word != ">").collect();
    let parsed = |words: &[&str], result: Result<(), clap::Error>| match result {
        // a command named without what it works on
        Err(error) if error.kind() == clap::error::ErrorKind::MissingRequiredArgument && words.len() == 2 => None,
        Err(error) if error.use_stderr() && words.len() > 1 => {
            Some(format!("`{command}`: {}", error.to_string().lines().next().unwrap_or_default()))
        }
        _ => None,
    };
    match words.as_slice() {
        ["gearwright", ..] => parsed(&words, Cli::try_parse_from(&words).map(drop)),
        ["cargo", "run", "--release", "--", rest @ ..] => {
            let words = [&["gearwright"], rest].concat();
            parsed(&words, Cli::try_parse_from(&words).map(drop))
        }
        ["cargo", "xtask", rest @ ..] => {
            let words = [&["xtask"], rest].concat();
            parsed(&words, crate::Arguments::try_parse_from(&words).map(drop))
        }
        ["cargo", "run", "--release", "-p", package, "--example", example, ..] => {
            let file = format!("crates/{package}/examples/{example}.rs");
            (!root.join(&file).exists()).then(|| format!("`{command}`: there is no {file}"))
        }
        ["cargo", "test" | "doc" | "build" | "bench" | "install" | "fmt" | "clippy", ..] => None,
        ["git", "clone", ..] | ["cd", _] => None,
        _ => Some(format!("`{command}`: not a command this check knows")),
    }
}

/// Paths of the repository in a word that are not there; `{a,b}` stands for both.
fn missing_paths(word: &str, root: &Path) -> Vec<String> {
    let word = word.trim_matches(|c: char| matches!(c, ',' | ';' | ':' | '"' | '(' | ')'));
    if word.contains("..") || word.contains(|c: char| c == '*' || c.is_ascii_uppercase() && !word.ends_with(".md")) {
        return Vec::new();
    }
    let crates = std::fs::read_dir(root.join("crates")).into_iter().flatten().flatten();
    let crates: BTreeSet<String> = crates.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    let Some((first, _)) = word.split_once('/') else { return Vec::new() };
    let prefix = match first {
        "configs" | "crates" | "docs" | "xtask" | "tests" => "",
        name if crates.contains(name) && word.contains("/src/") => "crates/",
        _ => return Vec::new(),
    };
    alternatives(word)
        .into_iter()
        .map(|path| format!("{prefix}{path}"))
        .filter(|path| !root.join(path).exists())
        .collect()
}

/// A path with its braces written out.
fn alternatives(path: &str) -> Vec<String> {
    let Some((before, rest)) = path.split_once('{') else { return vec![path.to_owned()] };
    let Some((inside, after)) = rest.split_once('}') else { return vec![path.to_owned()] };
    inside.split(',').map(|part| format!("{before}{part}{after}")).collect()
}

/// What is wrong with a case file, or with a piece of one put into the example of some kind; files that it names are those beside the case files.
fn toml_fault(text: &str, root: &Path) -> Option<String> {
    let piece: toml::Table = match text.parse() {
        Ok(table) => table,
        Err(error) => return Some(error.to_string()),
    };
    let file = &root.join("configs/case.toml");
    if piece.contains_key("kind") {
        return case::from_text(text, file).err().map(|faults| faults.to_string());
    }
    let mut least: Option<(usize, String)> = None;
    for kind in kind::KINDS {
        let mut whole: toml::Table = template::commented(kind).parse().unwrap_or_default();
        merge(&mut whole, &piece);
        match case::from_text(&whole.to_string(), file) {
            Ok(_) => return None,
            Err(faults) => {
                let message = faults.to_string();
                if least.as_ref().is_none_or(|(length, _)| message.len() < *length) {
                    least = Some((message.len(), format!("as part of a {} case: {message}", kind.name)));
                }
            }
        }
    }
    least.map(|(_, message)| message)
}

fn merge(whole: &mut toml::Table, piece: &toml::Table) {
    for (key, value) in piece {
        match (whole.get_mut(key), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(piece)) => merge(inner, piece),
            _ => {
                whole.insert(key.clone(), value.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root() -> &'static Path {
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
    }

    fn messages(text: &str) -> Vec<String> {
        faults(&Page::new(Path::new("docs/x.md"), text.into()), root()).into_iter().map(|f| f.message).collect()
    }

    #[test]
    fn what_exists_passes() {
        let text = "`gearwright explain pinion.teeth` and `fecm/src/{lib,statics/mod}.rs`\n\n```sh\ncargo xtask ci --full  # all\n\
                    cargo run --release -- run configs/nonunity-pair.toml --threads 2\n```\n\n\
                    ```toml\n[mesh]\nmodule_mm = 3.0\ncentre_distance_mm = 75.05\n```\n";
        let left: Vec<_> = messages(text).into_iter().filter(|m| !m.contains("case")).collect();
        assert!(left.is_empty(), "{left:?}");
        assert_eq!(toml_fault("[analysis]\npositions_per_cycle = 20\n", root()), None);
    }

    #[test]
    fn what_does_not_exist_is_told() {
        for (text, part) in [
            ("`gearwright fly`", "fly"),
            ("`cargo xtask ci --fast`", "--fast"),
            ("`configs/no-such.toml`", "configs/no-such.toml"),
            ("`fecm/src/{lib,nothing}.rs`", "crates/fecm/src/nothing.rs"),
            ("```sh\nrm x\n```", "rm x"),
            ("```toml\n[analysis]\npositions_per_cylce = 3\n```", "positions_per_cylce"),
            ("```rust\nlet x = 1;\n```", "not run"),
            ("```sh\ncargo run --release -p fecm --example nothing\n```", "nothing.rs"),
        ] {
            let told = messages(text);
            assert!(told.len() == 1 && told[0].contains(part), "{text}: {told:?}");
        }
    }
}
