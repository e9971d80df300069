//! A parsed case file that knows the line of every key.

use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::Fault;

/// A value with its place.
#[derive(Debug, Clone)]
pub struct Node {
    /// Line, from 1.
    pub line: usize,
    /// Source text of the value.
    pub text: String,
    /// The value.
    pub value: Value,
}

/// A value of a case file.
#[derive(Debug, Clone)]
pub enum Value {
    /// Section.
    Table(BTreeMap<String, Node>),
    /// Repeated section, `[[name]]`.
    List(Vec<Node>),
    /// Anything else.
    Plain(serde_json::Value),
}

/// Parses TOML text.
///
/// # Errors
/// One fault with the line of the syntax error.
pub fn parse(text: &str) -> Result<Node, Fault> {
    let source = Source::new(text);
    let syntax = |message: &str, at: Option<usize>| Fault {
        line: at.map(|offset| source.line(offset)),
        key: String::new(),
        value: None,
        message: format!("not valid TOML: {message}"),
    };
    let table = DeTable::parse(text).map_err(|e| syntax(e.message(), e.span().map(|s| s.start)))?;
    Ok(Node { line: 1, text: String::new(), value: Value::Table(convert_table(&source, table.get_ref())) })
}

/// Text with the places of its line breaks: the line of an offset without counting from the start.
struct Source<'a> {
    text: &'a str,
    breaks: Vec<usize>,
}

impl<'a> Source<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, breaks: text.match_indices('\n').map(|(at, _)| at).collect() }
    }

    /// Line of an offset, from 1.
    fn line(&self, offset: usize) -> usize {
        self.breaks.partition_point(|at| *at < offset) + 1
    }
}

fn convert_table(source: &Source<'_>, table: &DeTable<'_>) -> BTreeMap<String, Node> {
    table
        .iter()
        .map(|(key, value)| {
            let line = source.line(key.span().start);
            (key.get_ref().to_string(), convert(source, line, value))
        })
        .collect()
}

fn convert(source: &Source<'_>, line: usize, value: &Spanned<DeValue<'_>>) -> Node {
    let span = value.span();
    let text = source.text.get(span).unwrap_or_default().trim().to_owned();
    let value = match value.get_ref() {
        DeValue::Table(table) => Value::Table(convert_table(source, table)),
        DeValue::Array(items) if is_list(items) => {
            Value::List(items.iter().map(|item| convert(source, source.line(item.span().start), item)).collect())
        }
        other => Value::Plain(plain(other)),
    };
    Node { line, text, value }
}

/// Whether an array is a repeated section.
fn is_list(items: &[Spanned<DeValue<'_>>]) -> bool {
    !items.is_empty() && items.iter().all(|item| matches!(item.get_ref(), DeValue::Table(_)))
}

fn plain(value: &DeValue<'_>) -> serde_json::Value {
    match value {
        DeValue::String(s) => s.to_string().into(),
        DeValue::Boolean(b) => (*b).into(),
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).map_or(serde_json::Value::Null, Into::into),
        DeValue::Float(x) => {
            let number = x.as_str().replace('_', "").parse::<f64>().ok();
            number.and_then(serde_json::Number::from_f64).map_or(serde_json::Value::Null, serde_json::Value::Number)
        }
        DeValue::Array(items) => items.iter().map(|item| plain(item.get_ref())).collect(),
        DeValue::Table(table) => table.iter().map(|(k, v)| (k.get_ref().to_string(), plain(v.get_ref()))).collect(),
        DeValue::Datetime(d) => d.to_string().into(),
    }
}

impl Node {
    /// The node at a dotted key; `name[2]` is the second of the repeated sections `name`.
    #[must_use]
    pub fn find(&self, key: &str) -> Option<&Self> {
        key.split('.').try_fold(self, |node, part| {
            let (name, item) = match part.strip_suffix(']').and_then(|p| p.split_once('[')) {
                Some((name, number)) => (name, Some(number.parse::<usize>().ok()?.checked_sub(1)?)),
                None => (part, None),
            };
            let Value::Table(table) = &node.value else { return None };
            match (table.get(name)?, item) {
                (found, None) => Some(found),
                (Self { value: Value::List(items), .. }, Some(item)) => items.get(item),
                _ => None,
            }
        })
    }

    /// A fault at a dotted key: its own line if it is written, else that of its innermost section that is.
    #[must_use]
    pub fn fault(&self, key: &str, message: impl Into<String>) -> Fault {
        let written = self.find(key);
        let mut section = key;
        let mut line = written.map(|node| node.line);
        while line.is_none() {
            let Some((outer, _)) = section.rsplit_once('.') else { break };
            section = outer;
            line = self.find(section).map(|node| node.line);
        }
        let value = written.filter(|node| matches!(node.value, Value::Plain(_))).map(|node| node.text.clone());
        Fault { line, key: key.into(), value, message: message.into() }
    }
}
