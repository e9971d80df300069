//! Values of a result file by their place.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, anyhow};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value as Json;

/// Values of a file: lists of cells by column, key or array.
#[derive(Debug, Default, PartialEq)]
pub struct Content {
    values: BTreeMap<String, Vec<String>>,
}

/// What differs at one place.
#[derive(Debug, PartialEq)]
pub struct Difference {
    place: String,
    what: String,
}

impl Difference {
    /// A place that one side lacks.
    pub fn only(place: &str, side: &str) -> Self {
        Self { place: place.into(), what: format!("only {side}") }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.what)
    }
}

/// Whether a TOML file is a case; others are parts of cases.
pub fn is_case(file: &Path) -> anyhow::Result<bool> {
    let text = fs::read_to_string(file)?;
    let table: toml::Table = toml::from_str(&text).with_context(|| format!("{}", file.display()))?;
    Ok(table.contains_key("kind"))
}

impl Content {
    /// Whether a file is compared.
    pub fn is_kept(path: &Path) -> bool {
        path.extension().is_some_and(|e| ["csv", "json", "vtu", "pvd"].iter().any(|kept| e == *kept))
    }

    /// Reads a file; `ignored` are keys of JSON objects to leave out.
    pub fn read(path: &Path, ignored: &[&str]) -> anyhow::Result<Self> {
        let text = fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))?;
        let content = match path.extension().and_then(|e| e.to_str()) {
            Some("csv") => Self::of_csv(&text),
            Some("json") => Self::of_json(&text, ignored),
            Some("vtu") => Self::of_vtu(&text),
            _ => Ok(Self::of_lines(&text)),
        };
        content.with_context(|| format!("{}", path.display()))
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.values.values().map(Vec::len).sum()
    }

    fn of_csv(text: &str) -> anyhow::Result<Self> {
        let mut table = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
        let header: Vec<String> = table.headers()?.iter().map(str::to_owned).collect();
        let mut values: BTreeMap<String, Vec<String>> = header.iter().map(|name| (name.clone(), Vec::new())).collect();
        for row in table.records() {
            for (name, cell) in header.iter().zip(&row?) {
                values.entry(name.clone()).or_default().push(cell.to_owned());
            }
        }
        Ok(Self { values })
    }

    fn of_json(text: &str, ignored: &[&str]) -> anyhow::Result<Self> {
        let mut values = BTreeMap::new();
        flatten(&serde_json::from_str(text)?, String::new(), ignored, &mut values);
        Ok(Self { values })
    }

    fn of_vtu(text: &str) -> anyhow::Result<Self> {
        let mut values = BTreeMap::new();
        for array in text.split("<DataArray ").skip(1) {
            let attribute = |name: &str| {
                let rest = array.split_once(&format!("{name}=\""))?.1;
                rest.split_once('"').map(|found| found.0)
            };
            let (name, kind) = attribute("Name").zip(attribute("type")).ok_or_else(|| anyhow!("array without name"))?;
            let data = array.split_once('>').and_then(|(_, rest)| rest.split_once("</")).map_or("", |(data, _)| data);
            let bytes = STANDARD.decode(data.trim())?;
            let bytes = bytes.get(8..).unwrap_or_default();
            let cells = match kind {
                "Float64" => bytes.chunks_exact(8).map(|b| f64::from_le_bytes(eight(b)).to_string()).collect(),
                "Int64" => bytes.chunks_exact(8).map(|b| i64::from_le_bytes(eight(b)).to_string()).collect(),
                _ => bytes.iter().map(u8::to_string).collect(),
            };
            values.insert(name.to_owned(), cells);
        }
        Ok(Self { values })
    }

    fn of_lines(text: &str) -> Self {
        Self { values: BTreeMap::from([("lines".into(), text.lines().map(str::to_owned).collect())]) }
    }

    /// What differs after a change.
    pub fn differences(&self, after: &Self) -> Vec<Difference> {
        let mut found = Vec::new();
        for (place, old) in &self.values {
            match after.values.get(place) {
                None => found.push(Difference::only(place, "before")),
                Some(new) => found.extend(difference(place, old, new)),
            }
        }
        let fresh = after.values.keys().filter(|place| !self.values.contains_key(*place));
        found.extend(fresh.map(|place| Difference::only(place, "after")));
        found
    }
}

fn eight(bytes: &[u8]) -> [u8; 8] {
    std::array::from_fn(|k| bytes[k])
}

fn flatten(value: &Json, at: String, ignored: &[&str], all: &mut BTreeMap<String, Vec<String>>) {
    match value {
        Json::Object(object) => {
            for (key, value) in object.iter().filter(|(key, _)| !ignored.contains(&key.as_str())) {
                flatten(value, if at.is_empty() { key.clone() } else { format!("{at}.{key}") }, ignored, all);
            }
        }
        Json::Array(items) if items.iter().any(|item| item.is_object() || item.is_array()) => {
            for (k, item) in items.iter().enumerate() {
                flatten(item, format!("{at}[{k}]"), ignored, all);
            }
        }
        Json::Array(items) => {
            all.insert(at, items.iter().map(Json::to_string).collect());
        }
        plain => {
            all.insert(at, vec![plain.to_string()]);
        }
    }
}

/// Whether two cells are the same: as numbers to the bit, else as text.
fn same(old: &str, new: &str) -> bool {
    let bits = |text: &str| text.parse::<f64>().ok().map(f64::to_bits);
    old == new || bits(old).zip(bits(new)).is_some_and(|(a, b)| a == b)
}

fn difference(place: &str, old: &[String], new: &[String]) -> Option<Difference> {
    let changed: Vec<usize> = (0..old.len().min(new.len())).filter(|&k| !same(&old[k], &new[k])).collect();
    let mut parts = Vec::new();
    if old.len() != new.len() {
        parts.push(format!("{} values before, {} after", old.len(), new.len()));
    }
    if let Some(&first) = changed.first() {
        let relative = changed.iter().filter_map(|&k| {
            let (a, b): (f64, f64) = (old[k].parse().ok()?, new[k].parse().ok()?);
            Some((b - a).abs() / a.abs().max(b.abs()))
        });
        let largest = relative.fold(0.0, f64::max);
        parts.push(format!(
            "{} of {} values differ, by {largest:.2e} at most relatively; value {}: {} before, {} after",
            changed.len(),
            old.len(),
            first + 1,
            old[first],
            new[first]
        ));
    }
    (!parts.is_empty()).then(|| Difference { place: place.into(), what: parts.join("; ") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_bit_a_lost_column_and_a_missing_row_are_found() {
        let old = Content::of_csv("a,b\n1.0,x\n2.0,y\n").unwrap();
        let found = |text: &str| old.differences(&Content::of_csv(text).unwrap());
        assert!(found("a,b\n1.0,x\n2.0,y\n").is_empty());
        // the same number written in another way
        assert!(found("a,b\n1,x\n2.0e0,y\n").is_empty());
        assert!(found("a,b\n1.0000000000000002,x\n2.0,y\n")[0].to_string().starts_with("a: 1 of 2 values differ"));
        assert_eq!(found("a\n1.0\n2.0\n"), [Difference::only("b", "before")]);
        assert_eq!(found("a,b,c\n1.0,x,0\n2.0,y,0\n"), [Difference::only("c", "after")]);
        assert_eq!(found("a,b\n1.0,x\n").len(), 2);
    }

    #[test]
    fn versions_and_wall_times_do_not_count() {
        let of = |text: &str| Content::of_json(text, &["version", "time_s"]).unwrap();
        let old = of(r#"{"version": "1", "time_s": {"a": 1.0}, "work": {"time_s": 2.0, "steps": 3}, "x": [1.0, 2.0]}"#);
        let new = of(r#"{"version": "2", "time_s": {"a": 9.0}, "work": {"time_s": 9.0, "steps": 3}, "x": [1.0, 2.5]}"#);
        let found = old.differences(&new);
        assert!(found.len() == 1 && found[0].place == "x", "{found:?}");
        assert_eq!(old.len(), 3);
    }
}
