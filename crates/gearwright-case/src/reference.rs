//! Every key of a kind of case file with its documentation, from the JSON schema.

use serde_json::Value as Json;

use super::check::{expected, is_list_of_sections};
use super::kind::CaseKind;

/// One key of the case file.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyReference {
    /// Key with its sections.
    pub key: String,
    /// Whether it is a section.
    pub is_section: bool,
    /// Whether the section may be repeated, `[[name]]`.
    pub is_list: bool,
    /// Whether it must be given.
    pub required: bool,
    /// What is allowed.
    pub allowed: String,
    /// Whether it is a section that stands with its defaults when left out.
    pub given_by_default: bool,
    /// Default, where there is one to state.
    pub default: Option<String>,
    /// Documentation.
    pub text: String,
}

/// Follows references and unwraps optional values; keeps the description and default written beside a reference.
#[must_use]
pub fn resolve(schema: &Json, whole: &Json) -> Json {
    let mut target = schema.clone();
    let inner = schema
        .get("anyOf")
        .and_then(Json::as_array)
        .and_then(|variants| variants.iter().find(|v| v.get("type").and_then(Json::as_str) != Some("null")))
        .cloned();
    if let Some(inner) = inner {
        target = inner;
    }
    if let Some(name) = target.get("$ref").and_then(Json::as_str).and_then(|r| r.strip_prefix("#/$defs/")) {
        target = whole.get("$defs").and_then(|defs| defs.get(name)).cloned().unwrap_or_default();
    }
    for key in ["description", "default"] {
        if let (Some(value), Some(object)) = (schema.get(key), target.as_object_mut()) {
            object.insert(key.into(), value.clone());
        }
    }
    target
}

/// All keys of a kind in the order of its schema.
#[must_use]
pub fn keys(kind: &CaseKind) -> Vec<KeyReference> {
    let whole = (kind.schema)();
    let mut all = Vec::new();
    collect(&whole, &whole, "", None, &mut all);
    all
}

fn collect(schema: &Json, whole: &Json, at: &str, defaults: Option<&Json>, all: &mut Vec<KeyReference>) {
    let required: Vec<&str> =
        schema.get("required").and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str).collect();
    let Some(properties) = schema.get("properties").and_then(Json::as_object) else { return };
    for (name, property) in properties {
        let mut target = resolve(property, whole);
        let is_list = is_list_of_sections(&target, whole);
        if let Some(mut item) = target.get("items").filter(|_| is_list).map(|item| resolve(item, whole)) {
            if let (Some(about), Some(object)) = (target.get("description"), item.as_object_mut()) {
                object.insert("description".into(), about.clone());
            }
            target = item;
        }
        let key = if at.is_empty() { name.clone() } else { format!("{at}.{name}") };
        let is_section = target.get("properties").is_some();
        let default = defaults.and_then(|d| d.get(name)).or_else(|| target.get("default"));
        let shown = default.filter(|d| !d.is_null() && !d.is_object() && !is_list).map(ToString::to_string);
        all.push(KeyReference {
            key: key.clone(),
            is_section,
            is_list,
            required: required.contains(&name.as_str()),
            allowed: match (is_list, is_section) {
                (true, _) => "repeated sections".into(),
                (false, true) => "a section".into(),
                (false, false) => expected(&target),
            },
            given_by_default: is_section && !is_list && default.is_some_and(Json::is_object),
            default: shown,
            text: target.get("description").and_then(Json::as_str).unwrap_or_default().replace('\n', " "),
        });
        if is_section {
            let inner = default.filter(|d| d.is_object()).cloned();
            collect(&target, whole, &key, inner.as_ref(), all);
        }
    }
}
