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
    let keys = keys(kind);
    for (index, key) in keys.iter().enumerate() {
        text.push_str(&lines(key, is_used(key, &keys, kind.example), kind.example));
        // the section that ends here, if it may be repeated
        let inside =
            |list: &KeyReference, key: &str| key.strip_prefix(&list.key).is_some_and(|rest| rest.starts_with('.'));
        let next = keys.get(index + 1).map_or("", |next| &next.key);
        let ended = keys.iter().filter(|list| list.is_list && inside(list, &key.key) && !inside(list, next));
        ended.for_each(|list| text.push_str(&repeated(&list.key, kind.example)));
    }
    text
}

/// Further sections of a list: the example's keys `name[2].key`, `name[3].key`, ...
fn repeated(list: &str, example: &[(&str, &str)]) -> String {
    let mut text = String::new();
    for number in 2.. {
        let section = format!("{list}[{number}].");
        let mut own = example.iter().filter_map(|(key, value)| Some((key.strip_prefix(&section)?, value))).peekable();
        if own.peek().is_none() {
            break;
        }
        text.push_str(&format!("\n[[{list}]]\n"));
        own.for_each(|(key, value)| text.push_str(&format!("{key} = {value}\n")));
    }
    text
}

/// Whether a section stands in the example: it, or what must stand in a section that does. One that does not would demand its required keys.
fn is_used(key: &KeyReference, all: &[KeyReference], example: &[(&str, &str)]) -> bool {
    let inside = format!("{}.", key.key);
    let outer = key.key.rsplit_once('.').and_then(|(outer, _)| all.iter().find(|section| section.key == outer));
    let stands = || outer.is_none_or(|outer| is_used(outer, all, example));
    example.iter().any(|(k, _)| k.starts_with(&inside)) || ((key.required || key.given_by_default) && stands())
}

fn lines(key: &KeyReference, used: bool, example: &[(&str, &str)]) -> String {
    let name = key.key.rsplit('.').next().unwrap_or(&key.key);
    if key.is_section {
        let header = if key.is_list { format!("[[{}]]", key.key) } else { format!("[{}]", key.key) };
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
