//! References: `docs/references.bib` as a page, and citations `[Key]` or `[Key; Key]` in pages as links to it.

use std::fmt::Write;

use anyhow::{Context, ensure};

use super::page::escaped;

/// One entry of the bibliography.
struct Entry {
    key: String,
    fields: Vec<(String, String)>,
}

/// All entries, in their order.
pub struct Bibliography(Vec<Entry>);

impl Bibliography {
    /// Reads BibTeX whose values stand in braces.
    pub fn parse(text: &str) -> anyhow::Result<Self> {
        let mut entries: Vec<Entry> = Vec::new();
        for item in text.split("\n@").map(|item| item.trim_start_matches('@')).filter(|item| !item.trim().is_empty()) {
            let (_, body) = item.split_once('{').with_context(|| format!("no entry: {item}"))?;
            let (key, mut rest) = body.split_once(',').with_context(|| format!("no key: {item}"))?;
            let key = key.trim().to_owned();
            let mut fields = Vec::new();
            while let Some((name, after)) = rest.split_once('=') {
                let open = after.find('{').with_context(|| format!("{key}: {name} has no braces"))?;
                let mut depth = 0;
                let close = after[open..].char_indices().find_map(|(at, c)| {
                    depth += i32::from(c == '{') - i32::from(c == '}');
                    (depth == 0).then_some(open + at)
                });
                let close = close.with_context(|| format!("{key}: {name} is not closed"))?;
                fields.push((
                    name.trim().trim_start_matches([',', ' ', '\n']).to_owned(),
                    plain(&after[open + 1..close]),
                ));
                rest = &after[close + 1..];
            }
            ensure!(!fields.is_empty() && entries.iter().all(|e| e.key != key), "{key}: empty or twice");
            entries.push(Entry { key, fields });
        }
        Ok(Self(entries))
    }

    /// The page of references, as HTML.
    pub fn html(&self) -> String {
        let mut out = String::from("<h1>References</h1>\n<dl>\n");
        for entry in &self.0 {
            let fields: Vec<String> = entry
                .fields
                .iter()
                .map(|(name, value)| match name.as_str() {
                    "title" => format!("<em>{}</em>", escaped(value)),
                    "volume" => format!("vol. {}", escaped(value)),
                    "pages" => format!("pp. {}", escaped(value)),
                    "edition" => format!("edition {}", escaped(value)),
                    "doi" => format!("<a href=\"https://doi.org/{0}\">doi:{0}</a>", escaped(value)),
                    _ => escaped(value),
                })
                .collect();
            let _ = writeln!(out, "<dt id=\"{0}\">{0}</dt><dd>{1}</dd>", entry.key, fields.join(", "));
        }
        out + "</dl>\n"
    }

    /// HTML of a text in which citations are links to `page`; none if it cites nothing, an error for keys that are not there.
    pub fn cited(&self, text: &str, page: &str) -> Result<Option<String>, String> {
        let (mut out, mut rest, mut any) = (String::new(), text, false);
        while let Some((before, after)) = rest.split_once('[') {
            out.push_str(&escaped(before));
            out.push('[');
            rest = after;
            let Some((inside, behind)) = after.split_once(']') else { continue };
            if !inside.split("; ").all(is_key) {
                continue;
            }
            if let Some(unknown) = inside.split("; ").find(|key| self.0.iter().all(|e| e.key != *key)) {
                return Err(format!("[{unknown}] is not in docs/references.bib"));
            }
            let links: Vec<String> =
                inside.split("; ").map(|key| format!("<a href=\"{page}#{key}\">{key}</a>")).collect();
            out.push_str(&links.join("; "));
            out.push(']');
            (rest, any) = (behind, true);
        }
        out.push_str(&escaped(rest));
        Ok(any.then_some(out))
    }
}

/// Whether a text looks like `Name1990` or `Name1990a`.
fn is_key(text: &str) -> bool {
    let name = text.trim_end_matches(|c: char| c.is_ascii_lowercase());
    let year = name.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    text.starts_with(|c: char| c.is_ascii_uppercase()) && year.len() == 4 && year.bytes().all(|b| b.is_ascii_digit())
}

/// BibTeX text without its commands for accents.
fn plain(tex: &str) -> String {
    let mut text = tex.split_whitespace().collect::<Vec<_>>().join(" ");
    for (code, letter) in
        [("\\'u", "ú"), ("\\'e", "é"), ("\\'a", "á"), ("\\\"o", "ö"), ("\\\"u", "ü"), ("\\\"a", "ä"), ("\\'c", "ć")]
    {
        text = text.replace(code, letter);
    }
    text.replace("--", "–").replace(['{', '}'], "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn citations_become_links_and_unknown_keys_errors() {
        let bib = Bibliography::parse(
            "@book{Love1929, title = {A {B} c}, year = {1929} }\n@misc{Judice1994a,\n note = {J{\\'u}dice}}\n",
        )
        .unwrap();
        assert!(bib.html().contains("Júdice") && bib.html().contains("<em>A B c</em>"), "{}", bib.html());
        let text = bib.cited("a < b [Love1929; Judice1994a], [x] [1]", "r.html").unwrap().unwrap();
        let links = "[<a href=\"r.html#Love1929\">Love1929</a>; <a href=\"r.html#Judice1994a\">Judice1994a</a>]";
        assert_eq!(text, format!("a &lt; b {links}, [x] [1]"));
        assert!(bib.cited("[Hertz1881]", "r.html").unwrap_err().contains("Hertz1881"));
        assert_eq!(bib.cited("no [brackets", "r.html"), Ok(None));
    }
}
