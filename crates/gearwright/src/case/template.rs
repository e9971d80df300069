//! Commented case files for `gearwright init`, made from the schema's documentation and an example that runs.

use super::kind::CaseKind;
use super::reference::{KeyReference, keys};

/// A commented case file of a kind.
#[must_use]
pub fn commented(kind: &CaseKind) -> String {
    let mut text = String::from(
        "# A gearwright case file. `gearwright check FILE` validates it, `gearwright run FILE` runs it,\n\
         # `gearwright explain KEY` explains a key. Keys carry their units; lines after \"#\" show optional keys.\n\n",
    );
    for key in keys(kind) {
        text.push_str(&lines(&key, kind.example));
    }
    text
}

fn lines(key: &KeyReference, example: &[(&str, &str)]) -> String {
    let name = key.key.rsplit('.').next().unwrap_or(&key.key);
    if key.is_section {
        let header = if key.is_list { format!("[[{}]]", key.key) } else { format!("[{}]", key.key) };
        // an optional section that the example leaves out would demand its required keys
        let inside = format!("{}.", key.key);
        let used = key.required || key.given_by_default || example.iter().any(|(k, _)| k.starts_with(&inside));
        return format!("\n{}{}{header}\n", wrapped(&key.text), if used { "" } else { "# " });
    }
    let example = example.iter().find(|(k, _)| *k == key.key).map(|(_, v)| *v);
    let mut comment = key.text.clone();
    if example.is_none() {
        comment.push_str(&format!(" Allowed: {}.", key.allowed));
    }
    let comment = wrapped(&comment);
    match (example, &key.default) {
        (Some(value), _) => format!("{comment}{name} = {value}\n"),
        (None, Some(default)) => format!("{comment}# {name} = {default}\n"),
        (None, None) => format!("{comment}# {name} =\n"),
    }
}

/// Comment lines of at most 96 characters.
fn wrapped(text: &str) -> String {
    let mut result = String::new();
    let mut line = String::from("#");
    for word in text.split_whitespace() {
        if line.len() + word.len() > 95 {
            result.push_str(&line);
            result.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line.push_str(word);
    }
    if line.len() > 1 {
        result.push_str(&line);
        result.push('\n');
    }
    result
}
