//! Numbers printed in the dissertation: one file, entered once, each with its place; and how a computed one compares.

use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use serde::Deserialize;

use super::drawn::{Done, Found, Outcome};
use super::registry::Figure;

/// The data file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// Kinds of numbers.
    pub kind: Vec<Kind>,
    /// Results, to be compared.
    pub result: Vec<Number>,
    /// Results said in words.
    #[serde(default)]
    pub claim: Vec<Claim>,
    /// What is not a result, or not comparable by any computation here.
    pub other: Vec<Other>,
}

/// How near a number of a kind is expected.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kind {
    /// Name.
    pub name: String,
    /// Part of the printed value.
    pub relative: f64,
    /// In the number's unit.
    #[serde(default)]
    pub absolute: f64,
    /// Why so much.
    pub why: String,
}

/// A printed result.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// Figure or table whose function gives the computed one.
    pub figure: String,
    /// Key among that function's values.
    pub key: String,
    /// Value with the digits printed.
    #[serde(rename = "value")]
    pub printed: String,
    /// The same as a number.
    #[serde(skip)]
    pub value: f64,
    /// Unit; empty for none.
    #[serde(default)]
    pub unit: String,
    /// Kind, for the tolerance.
    pub kind: String,
    /// Page element and what is said of it.
    pub place: String,
    /// Sections that print it.
    pub sections: Vec<String>,
    /// Why it cannot be compared although there may be a computed one.
    #[serde(default)]
    pub not_comparable: Option<String>,
    /// Why the computed one differs, as far as is known.
    #[serde(default)]
    pub note: Option<String>,
}

/// A result said in words.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Figure or table whose function looks whether it holds.
    pub figure: String,
    /// Key among what that function finds.
    pub key: String,
    /// What is said, in our words.
    pub says: String,
    /// Section.
    pub place: String,
}

/// Printed numbers that are no results of a computation here.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Other {
    /// What they are.
    pub reason: String,
    /// Sections that print them, with all below; `""` for all.
    pub sections: Vec<String>,
    /// Numbers with units.
    pub numbers: Vec<String>,
}

/// What comparing gives.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Within the tolerance of its kind.
    Pass,
    /// Beyond it.
    Differs,
    /// Nothing to compare, and why.
    NotComparable(String),
}

/// A printed number beside the computed one.
pub struct Compared<'a> {
    /// The printed one.
    pub number: &'a Number,
    /// The computed one, if any.
    pub computed: Option<f64>,
    /// The verdict.
    pub verdict: Verdict,
}

impl Number {
    /// Half a unit of the last printed digit.
    fn rounding(&self) -> f64 {
        let decimals = self.printed.split_once('.').map_or(0, |(_, d)| d.len());
        0.5 * 0.1_f64.powi(decimals as i32)
    }
}

impl Compared<'_> {
    /// The difference as text: in points for percentages, in cycles for places in the mesh cycle, else relative.
    pub fn difference(&self) -> String {
        let Some(value) = self.computed else { return String::new() };
        let Number { value: printed, unit, kind, .. } = self.number;
        let apart = value - printed;
        match (unit.as_str(), kind.as_str()) {
            ("%", _) => format!("{apart:+.2} points"),
            (_, "cycle") => format!("{apart:+.3}"),
            _ => format!("{:+.1} %", 100.0 * apart / printed.abs()),
        }
    }

    /// The computed value as text.
    pub fn shown(&self) -> String {
        self.computed.map_or(String::new(), significant)
    }
}

/// Five digits, more for large numbers.
pub fn significant(value: f64) -> String {
    let digits = if value == 0.0 { 2 } else { (4 - value.abs().log10().floor() as i32).clamp(0, 8) };
    format!("{value:.*}", digits as usize)
}

impl Printed {
    /// Reads the file.
    pub fn load(file: &Path) -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
        let mut printed: Self = toml::from_str(&text).with_context(|| format!("{}", file.display()))?;
        for number in &mut printed.result {
            let Number { figure, key, .. } = &number;
            let value = number.printed.parse();
            number.value = value.with_context(|| format!("printed number {key} of figure {figure} is no number"))?;
            if !printed.kind.iter().any(|k| k.name == number.kind) {
                bail!(
                    "printed number {} of figure {} is of an unknown kind {}",
                    number.key,
                    number.figure,
                    number.kind
                );
            }
        }
        Ok(printed)
    }

    /// Every number's figure exists, and no two share a key.
    pub fn check_against(&self, figures: &[Figure]) -> anyhow::Result<()> {
        for (index, number) in self.result.iter().enumerate() {
            let Number { figure, key, .. } = number;
            ensure!(
                figures.iter().any(|f| f.id == *figure),
                "printed number {key} belongs to figure {figure}, which there is not"
            );
            let twin = self.result[..index].iter().any(|n| n.figure == *figure && n.key == *key);
            ensure!(!twin, "printed number {key} of figure {figure} is there twice");
        }
        for Claim { figure, key, .. } in &self.claim {
            ensure!(
                figures.iter().any(|f| f.id == *figure),
                "claim {key} belongs to figure {figure}, which there is not"
            );
        }
        Ok(())
    }

    /// The numbers of a figure, compared.
    pub fn compare<'a>(&'a self, done: &Done) -> Vec<Compared<'a>> {
        let own = self.result.iter().filter(|n| n.figure == done.figure.id);
        own.map(|number| self.compare_one(number, &done.outcome)).collect()
    }

    /// What is said of a figure in words, with what was found, if anything.
    pub fn claims<'a>(&'a self, done: &'a Done) -> Vec<(&'a Claim, Option<&'a Found>)> {
        let found = |claim: &Claim| match &done.outcome {
            Outcome::Drawn(saved) => saved.claims.get(&claim.key),
            _ => None,
        };
        self.claim.iter().filter(|c| c.figure == done.figure.id).map(|c| (c, found(c))).collect()
    }

    fn compare_one<'a>(&self, number: &'a Number, outcome: &Outcome) -> Compared<'a> {
        let none = |reason: String| Compared { number, computed: None, verdict: Verdict::NotComparable(reason) };
        let saved = match outcome {
            Outcome::Drawn(saved) => saved,
            Outcome::Failed(error) => return none(format!("the figure failed: {error}")),
            Outcome::NotAsked => return none("not computed: others were asked for with --only".into()),
        };
        let computed = saved.values.get(&number.key).copied().filter(|v| v.is_finite());
        let verdict = match (&number.not_comparable, computed) {
            (Some(reason), _) => Verdict::NotComparable(reason.clone()),
            (None, None) => Verdict::NotComparable("the computation gives no such value".into()),
            (None, Some(value)) => {
                let kind = self.kind.iter().find(|k| k.name == number.kind);
                let allowed = kind.map_or(0.0, |k| k.relative * number.value.abs() + k.absolute) + number.rounding();
                if (value - number.value).abs() <= allowed { Verdict::Pass } else { Verdict::Differs }
            }
        };
        Compared { number, computed, verdict }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::super::drawn::Saved;
    use super::super::registry::FIGURES;
    use super::super::root;
    use super::*;

    #[test]
    fn the_data_file_fits_the_figures() {
        let printed = Printed::load(&root().join("docs/dissertation/printed.toml")).expect("it can be read");
        printed.check_against(FIGURES).expect("it fits");
    }

    #[test]
    fn verdicts_follow_tolerance_and_rounding() {
        let text = "other = []\n[[kind]]\nname = \"k\"\nrelative = 0.01\nwhy = \"\"\n[[result]]\nfigure = \"2.2\"\nkey = \"a\"\nvalue = \"2.0\"\n\
                    kind = \"k\"\nplace = \"\"\nsections = []\n";
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("printed.toml");
        std::fs::write(&file, text).expect("it can be written");
        let printed = Printed::load(&file).expect("it can be read");
        let verdict = |value: Option<f64>| {
            let values: BTreeMap<String, f64> = value.map(|v| ("a".to_owned(), v)).into_iter().collect();
            let claims = BTreeMap::new();
            let saved = Saved { panels: vec![], tables: vec![], values, claims, notes: vec![], seconds: 0.0 };
            let figure = FIGURES.iter().find(|f| f.id == "2.2").expect("there is one");
            printed.compare(&Done { figure, outcome: Outcome::Drawn(saved) }).remove(0).verdict
        };
        // 0.02 by the kind and 0.05 by the last digit
        assert_eq!(verdict(Some(2.069)), Verdict::Pass);
        assert_eq!(verdict(Some(2.071)), Verdict::Differs);
        assert!(matches!(verdict(Some(f64::NAN)), Verdict::NotComparable(_)));
        assert!(matches!(verdict(None), Verdict::NotComparable(_)));
    }
}
