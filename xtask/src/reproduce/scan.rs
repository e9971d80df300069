//! Whether the data file of printed numbers is complete: every number with a unit or percent sign in the dissertation's text is in it.

use std::path::Path;

use anyhow::{Context as _, bail};

use super::printed::{Number, Printed};

/// Units as they are spelt, and as the data file has them; longer spellings first.
const UNITS: [(&str, &str); 46] = [
    ("N·s/m", "N s/m"),
    ("N · s/m", "N s/m"),
    ("N/μm", "N/um"),
    ("N/ μm", "N/um"),
    ("N/μ m", "N/um"),
    ("N/ μ m", "N/um"),
    ("N/m", "N/m"),
    ("N-m", "N m"),
    ("N·m", "N m"),
    ("N · m", "N m"),
    ("N  m", "N m"),
    ("N m", "N m"),
    ("Nm", "N m"),
    ("kN", "kN"),
    ("kHz", "kHz"),
    ("Hz", "Hz"),
    ("rpm", "rpm"),
    ("kg/m³", "kg/m3"),
    ("kg/m^3", "kg/m3"),
    ("kg/m3", "kg/m3"),
    ("kg · m²", "kg m2"),
    ("kg", "kg"),
    ("GPa", "GPa"),
    ("MPa", "MPa"),
    ("percent", "%"),
    ("%", "%"),
    ("μm", "um"),
    ("μ m", "um"),
    ("micrometers", "um"),
    ("mm", "mm"),
    ("degrees", "deg"),
    ("degree", "deg"),
    ("deg", "deg"),
    ("°", "deg"),
    ("mesh cycles", "cycle"),
    ("mesh cycle", "cycle"),
    ("seconds", "s"),
    ("sec", "s"),
    ("hours", "h"),
    ("hour", "h"),
    ("minutes", "min"),
    ("minute", "min"),
    ("hp", "hp"),
    ("kW", "kW"),
    ("g", "g"),
    ("N", "N"),
];

/// A number somewhere in the text, with its unit or "".
#[derive(Debug, Clone, PartialEq)]
struct Mention {
    section: String,
    line: usize,
    value: f64,
    unit: &'static str,
    context: String,
}

/// Reports what is missing.
///
/// # Errors
/// The file system's, and numbers that the data file does not have.
pub fn check(printed: &Printed, text: &Path) -> anyhow::Result<()> {
    let text = std::fs::read_to_string(text).with_context(|| format!("{} cannot be read", text.display()))?;
    let mentions = mentions(&text);
    let others = others(printed)?;
    let known = |m: &Mention| {
        let same = |value: f64, unit: &str| unit == m.unit && (value - m.value).abs() <= 1e-9 * value.abs().max(1.0);
        let result = printed.result.iter().any(|n| same(n.value, &n.unit) && covers(&n.sections, &m.section));
        result || others.iter().any(|(value, unit, sections)| same(*value, unit) && covers(sections, &m.section))
    };
    let with_unit = || mentions.iter().filter(|m| !m.unit.is_empty());
    let missing: Vec<&Mention> = with_unit().filter(|m| !known(m)).collect();
    for m in &missing {
        println!("{} (line {}): {} {}: ...{}...", m.section, m.line, m.value, m.unit, m.context);
    }
    println!("{} numbers with a unit, {} of them not in the data file", with_unit().count(), missing.len());
    let unused = unused(printed, &mentions);
    for (what, sections) in &unused {
        println!("in the data file, not in the text: {what} in {sections:?}");
    }
    if !missing.is_empty() || !unused.is_empty() {
        bail!("the data file of printed numbers is not complete");
    }
    Ok(())
}

/// Values, units and sections of what is not a result.
fn others(printed: &Printed) -> anyhow::Result<Vec<(f64, String, &[String])>> {
    let mut all = Vec::new();
    for other in &printed.other {
        for number in &other.numbers {
            let (value, unit) = number.split_once(' ').with_context(|| format!("\"{number}\" has no unit"))?;
            let value = value.parse().with_context(|| format!("\"{number}\" does not begin with a number"))?;
            all.push((value, unit.to_owned(), other.sections.as_slice()));
        }
    }
    Ok(all)
}

/// Whether one of the sections is this one or above it.
fn covers(sections: &[String], section: &str) -> bool {
    sections
        .iter()
        .any(|s| s.is_empty() || section == s || section.starts_with(s) && section[s.len()..].starts_with('.'))
}

/// Results that the text does not have where the file says, with their unit or (lists, headings of tables) without.
fn unused<'a>(printed: &'a Printed, mentions: &[Mention]) -> Vec<(String, &'a [String])> {
    let there = |n: &Number, m: &Mention| {
        let unit = m.unit.is_empty() || m.unit == n.unit || n.unit.is_empty();
        unit && (m.value - n.value).abs() <= 1e-9 * n.value.abs().max(1.0) && covers(&n.sections, &m.section)
    };
    let absent = printed.result.iter().filter(|n| !mentions.iter().any(|m| there(n, m)));
    absent.map(|n| (format!("{} {} ({})", n.printed, n.unit, n.key), n.sections.as_slice())).collect()
}

/// Numbers from chapter 2 to the references.
fn mentions(text: &str) -> Vec<Mention> {
    let mut section = String::new();
    let mut all = Vec::new();
    for (index, line) in text.lines().enumerate() {
        section = match heading(line) {
            Some(Heading::Section(name)) => name,
            Some(Heading::Other) => String::new(),
            None => section,
        };
        if !section.is_empty() && !section.starts_with('1') {
            in_line(&plain(line), &section, index + 1, &mut all);
        }
    }
    all
}

enum Heading {
    Section(String),
    Other,
}

fn heading(line: &str) -> Option<Heading> {
    const CHAPTERS: [&str; 8] = ["ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT"];
    let (first, rest) = line.split_once(' ').unwrap_or((line, ""));
    match first {
        // the list of contents has page numbers and tabs
        "CHAPTER" => CHAPTERS.iter().position(|c| *c == rest).map(|k| Heading::Section((k + 1).to_string())),
        "APPENDIX" if rest.len() == 1 => Some(Heading::Section(rest.into())),
        "REFERENCES" => Some(Heading::Other),
        _ => {
            let mut parts = first.split('.');
            let chapter = parts.next().filter(|c| ["2", "3", "4", "5", "6", "7", "8", "A", "B"].contains(c))?;
            let numbers: Vec<&str> = parts.collect();
            let is_number = |p: &&str| !p.is_empty() && p.len() < 3 && p.bytes().all(|b| b.is_ascii_digit());
            let titled = rest.chars().next().is_some_and(char::is_uppercase);
            // a sentence does not begin with a section's number
            let fits = !numbers.is_empty() && numbers.iter().all(is_number) && titled && !line.contains('\t');
            fits.then(|| Heading::Section(format!("{chapter}.{}", numbers.join("."))))
        }
    }
}

/// The line without the marks of the typesetting.
fn plain(line: &str) -> String {
    let mut text = line.replace("\\mu", "μ").replace("\\cdot", "·").replace("µ", "μ");
    for mark in ["\\text", "\\mathrm", "\\,", "\\ ", "$", "{", "}", "\\"] {
        text = text.replace(mark, "");
    }
    while text.contains("  ") {
        text = text.replace("  ", " ");
    }
    text
}

fn in_line(line: &str, section: &str, number: usize, all: &mut Vec<Mention>) {
    let bytes = line.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        if !bytes[at].is_ascii_digit() {
            at += 1;
            continue;
        }
        let start = at;
        at = end_of_number(bytes, at);
        let Some((value, start)) = value(line, start, at) else { continue };
        let rest = &line[at..];
        let after = rest.trim_start_matches([' ', '-', '\u{a0}']);
        // "1.62 mesh cycle" and "mesh cycle 1.62"
        let named = line[..start].trim_end().ends_with("mesh cycle");
        let found = UNITS.iter().find(|(spelt, _)| is_unit(after, spelt)).map(|(_, unit)| *unit);
        let unit = found.unwrap_or(if named { "cycle" } else { "" });
        let context = |from: usize| {
            let low = (0..=from.saturating_sub(60)).rev().find(|k| line.is_char_boundary(*k)).unwrap_or(0);
            let high = (at + 30..line.len()).find(|k| line.is_char_boundary(*k)).unwrap_or(line.len());
            line[low..high].to_owned()
        };
        let mut add = |value: f64, from: usize| {
            all.push(Mention { section: section.into(), line: number, value, unit, context: context(from) });
        };
        add(value, start);
        if unit.is_empty() {
            continue;
        }
        // the numbers before it in a list share its unit
        let mut before = start;
        while let Some((value, from)) = listed_before(line, before) {
            add(value, from);
            before = from;
        }
    }
}

fn end_of_number(bytes: &[u8], mut at: usize) -> usize {
    let digit = |k: usize| bytes.get(k).is_some_and(u8::is_ascii_digit);
    while digit(at) || matches!(bytes.get(at), Some(b'.' | b',')) && digit(at + 1) {
        at += 1;
    }
    at
}

/// A number between two places and where it begins, its sign included; `None` for parts of words and names.
fn value(line: &str, start: usize, end: usize) -> Option<(f64, usize)> {
    let before = &line[..start];
    let (signed, start) = match before.strip_suffix(['-', '−']) {
        // a hyphen after a word or digit is no sign
        Some(left) if left.is_empty() || left.ends_with([' ', '(', '=']) => (true, left.len()),
        Some(_) => return None,
        None => (false, start),
    };
    if line[..start].ends_with(|c: char| c.is_alphanumeric() || c == '.' || c == '_' || c == '^') {
        return None;
    }
    let text = line[start..end].trim_start_matches(['-', '−']).replace(',', "");
    let number: f64 = text.parse().ok()?;
    Some((if signed { -number } else { number }, start))
}

fn is_unit(after: &str, spelt: &str) -> bool {
    let Some(rest) = after.strip_prefix(spelt) else { return false };
    let ends_in_letter = spelt.ends_with(char::is_alphabetic);
    !(ends_in_letter && rest.starts_with(|c: char| c.is_alphanumeric()))
}

/// The number before a place in a list ("20, 50, and 80").
fn listed_before(line: &str, at: usize) -> Option<(f64, usize)> {
    let mut left = line[..at].trim_end();
    let joined = left;
    for word in ["and", "or", "to"] {
        left = left.strip_suffix(word).filter(|l| l.ends_with([' ', ','])).unwrap_or(left).trim_end();
    }
    left = left.strip_suffix(',').unwrap_or(left);
    if left.len() == joined.len() {
        return None;
    }
    let end = left.len();
    let start = left
        .rfind(|c: char| !(c.is_ascii_digit() || c == '.' || c == ','))
        .map_or(0, |k| k + left[k..].chars().next().map_or(1, char::len_utf8));
    // the number of a reference or figure is none of the list
    let word = line[..start].trim_end().rsplit([' ', '(']).next().unwrap_or("");
    if ["Figure", "Figures", "Figs.", "Table", "Eq.", "Ref.", "Refs.", "Section"].contains(&word) {
        return None;
    }
    value(line, start, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "CHAPTER TWO\n2.1 A title\nThe width is $9.3 \\mu\\text{m}$, of 20%, 50, and 80 percent; see Figure 2.5 N.\n\
                        At mesh cycle 1.62 it falls to -25.2 μm.\nREFERENCES\n5 mm\n";

    #[test]
    fn numbers_with_units_are_found_in_their_sections() {
        let found: Vec<(f64, &str, String)> =
            mentions(TEXT).into_iter().filter(|m| !m.unit.is_empty()).map(|m| (m.value, m.unit, m.section)).collect();
        let own = |value: f64, unit: &'static str| (value, unit, "2.1".to_owned());
        let expected =
            [own(9.3, "um"), own(20.0, "%"), own(80.0, "%"), own(50.0, "%"), own(1.62, "cycle"), own(-25.2, "um")];
        for one in &expected {
            assert!(found.contains(one), "{one:?} is not in {found:?}");
        }
        assert!(found.iter().all(|f| f.2 == "2.1"), "{found:?}");
    }

    #[test]
    fn sections_cover_those_below_them_only() {
        let of = |s: &str| vec![s.to_owned()];
        assert!(covers(&of("2.1"), "2.1.3") && covers(&of("2"), "2.1") && covers(&of(""), "A.1"));
        assert!(!covers(&of("2.1"), "2.10") && !covers(&of("2.1.3"), "2.1"));
    }
}
