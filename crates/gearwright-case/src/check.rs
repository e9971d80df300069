//! A case file against the JSON schema: unknown and missing keys, types, choices, ranges - all at once, each with its line.

use serde_json::Value as Json;

use super::document::{Node, Value};
use super::fault::Fault;
use super::kind::{self, CaseKind};
use super::reference::resolve;

/// The kind of a document.
///
/// # Errors
/// The fault of a missing or unknown kind.
pub fn kind(document: &Node) -> Result<&'static CaseKind, Fault> {
    let names = kind::names();
    let written = match document.find("kind").map(|node| &node.value) {
        None => {
            let first = format!("this key is required, one of {names}: it says what the file describes");
            return Err(document.fault("kind", first));
        }
        Some(Value::Plain(Json::String(name))) => name,
        Some(_) => return Err(document.fault("kind", format!("must be one of {names}"))),
    };
    kind::find(written).ok_or_else(|| {
        let near = nearest(written, kind::KINDS.iter().map(|kind| kind.name));
        let hint = near.map_or(String::new(), |n| format!("; did you mean \"{n}\"?"));
        document.fault("kind", format!("must be one of {names}{hint}"))
    })
}

/// All faults of a document against the schema of its kind.
#[must_use]
pub fn faults(document: &Node, kind: &CaseKind) -> Vec<Fault> {
    let schema = (kind.schema)();
    let mut faults = Vec::new();
    check(document, document, &schema, &schema, "", &mut faults);
    faults
}

fn join(section: &str, key: &str) -> String {
    if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") }
}

fn check(root: &Node, node: &Node, schema: &Json, whole: &Json, at: &str, faults: &mut Vec<Fault>) {
    let schema = resolve(schema, whole);
    match &node.value {
        Value::Table(table) => {
            let Some(properties) = schema.get("properties").and_then(Json::as_object) else {
                let wanted = if is_list_of_sections(&schema, whole) {
                    format!("write [[{at}]], it may be repeated")
                } else {
                    expected(&schema)
                };
                faults.push(root.fault(at, format!("a section is not expected here: {wanted}")));
                return;
            };
            for (key, child) in table {
                match properties.get(key) {
                    Some(child_schema) => check(root, child, child_schema, whole, &join(at, key), faults),
                    None => faults.push(root.fault(&join(at, key), unknown(key, properties.keys()))),
                }
            }
            for key in schema.get("required").and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str) {
                if !table.contains_key(key) {
                    let about = properties.get(key).map(|s| resolve(s, whole));
                    let hint =
                        about.as_ref().and_then(|s| s.get("description")).and_then(Json::as_str).unwrap_or_default();
                    let what = hint.lines().next().unwrap_or_default();
                    faults.push(root.fault(&join(at, key), format!("this key is required: {what}")));
                }
            }
        }
        Value::List(items) => match schema.get("items").filter(|_| is_list_of_sections(&schema, whole)) {
            Some(item) => {
                for (index, node) in items.iter().enumerate() {
                    check(root, node, item, whole, &format!("{at}[{}]", index + 1), faults);
                }
            }
            None => {
                faults.push(root.fault(at, format!("repeated sections are not expected here: {}", expected(&schema))))
            }
        },
        Value::Plain(value)
            if value.as_array().is_some_and(|v| !v.is_empty()) && is_list_of_sections(&schema, whole) =>
        {
            faults.push(root.fault(at, format!("must be repeated sections, each headed [[{at}]]")));
        }
        Value::Plain(value) => check_plain(root, value, &schema, at, faults),
    }
}

/// Whether a schema describes repeated sections.
#[must_use]
pub fn is_list_of_sections(schema: &Json, whole: &Json) -> bool {
    schema.get("items").is_some_and(|item| resolve(item, whole).get("properties").is_some())
}

fn check_plain(root: &Node, value: &Json, schema: &Json, at: &str, faults: &mut Vec<Fault>) {
    if let Some(choices) = choices(schema) {
        let fits = value.as_str().is_some_and(|v| choices.iter().any(|c| c == v));
        if !fits {
            let near = value.as_str().and_then(|v| nearest(v, choices.iter().map(String::as_str)));
            let hint = near.map_or(String::new(), |n| format!("; did you mean \"{n}\"?"));
            let list = choices.iter().map(|c| format!("\"{c}\"")).collect::<Vec<_>>().join(", ");
            faults.push(root.fault(at, format!("must be one of {list}{hint}")));
        }
        return;
    }
    let types = types(schema);
    let fits = types.iter().any(|t| match t.as_str() {
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "array" => value.as_array().is_some_and(|items| items.iter().all(Json::is_number)),
        _ => false,
    });
    if !fits {
        faults.push(root.fault(at, format!("must be {}", expected(schema))));
        return;
    }
    if value.as_str().is_some_and(|text| text.contains(char::is_control)) {
        faults.push(root.fault(at, "must not hold control characters, line breaks included".to_owned()));
    }
    if let Some(number) = value.as_f64() {
        let low = schema.get("minimum").and_then(Json::as_f64);
        let high = schema.get("maximum").and_then(Json::as_f64);
        if low.is_some_and(|low| number < low) || high.is_some_and(|high| number > high) {
            faults.push(root.fault(at, format!("must be {}", expected(schema))));
        }
    }
}

/// Names of the types a schema allows, "null" left out.
fn types(schema: &Json) -> Vec<String> {
    let names = match schema.get("type") {
        Some(Json::String(name)) => vec![name.clone()],
        Some(Json::Array(names)) => names.iter().filter_map(Json::as_str).map(str::to_owned).collect(),
        _ => Vec::new(),
    };
    names.into_iter().filter(|name| name != "null").collect()
}

/// The strings an enumeration allows.
#[must_use]
pub fn choices(schema: &Json) -> Option<Vec<String>> {
    if let Some(list) = schema.get("enum").and_then(Json::as_array) {
        return Some(list.iter().filter_map(Json::as_str).map(str::to_owned).collect());
    }
    if let Some(one) = schema.get("const").and_then(Json::as_str) {
        return Some(vec![one.to_owned()]);
    }
    let variants = schema.get("oneOf")?.as_array()?;
    let all: Vec<String> = variants.iter().filter_map(choices).flatten().collect();
    (!all.is_empty()).then_some(all)
}

/// What a schema allows, in words.
#[must_use]
pub fn expected(schema: &Json) -> String {
    if let Some(choices) = choices(schema) {
        return format!("one of {}", choices.iter().map(|c| format!("\"{c}\"")).collect::<Vec<_>>().join(", "));
    }
    let name = match types(schema).first().map(String::as_str) {
        Some("number") => "a number",
        Some("integer") => "a whole number",
        Some("string") => "a text in quotes",
        Some("boolean") => "true or false",
        Some("array") => "a list of numbers",
        _ => "a section",
    };
    let bound = |key: &str| schema.get(key).and_then(Json::as_f64);
    match (bound("minimum"), bound("maximum")) {
        (Some(low), Some(high)) => format!("{name} from {low} to {high}"),
        (Some(low), None) => format!("{name}, at least {low}"),
        _ => name.to_owned(),
    }
}

/// Features that a key may ask for and that are not there: part of its name, and why.
const UNSUPPORTED: [(&str, &str); 3] = [
    ("helix", "helical gears are not supported: the teeth of spur and planetary gears are straight"),
    ("beta", "helical gears are not supported: the teeth of spur and planetary gears are straight"),
    ("friction", "friction between flanks is not modelled"),
];

fn unknown<'a>(key: &str, known: impl Iterator<Item = &'a String> + Clone) -> String {
    if let Some((_, why)) = UNSUPPORTED.iter().find(|(name, _)| key.split('_').any(|part| part == *name)) {
        return format!("unknown key; {why}");
    }
    const UNITS: [&str; 24] = [
        "_mm",
        "_um",
        "_m",
        "_in",
        "_inch",
        "_deg",
        "_rad",
        "_n_m",
        "_nm",
        "_lb_in",
        "_gpa",
        "_mpa",
        "_pa",
        "_s",
        "_ms",
        "_hz",
        "_rpm",
        "_kg",
        "_g",
        "_kg_m2",
        "_n_per_m",
        "_n_per_um",
        "_n_s_per_m",
        "_n_s",
    ];
    let stem = |k: &'a str| UNITS.iter().filter_map(|unit| k.strip_suffix(unit)).min_by_key(|stem| stem.len());
    // the same quantity in another unit, or without one
    let quantity = UNITS.iter().filter_map(|unit| key.strip_suffix(unit)).min_by_key(|stem| stem.len()).unwrap_or(key);
    let other_unit = known.clone().find(|k| stem(k) == Some(quantity));
    if let Some(other) = other_unit {
        return format!("unknown key; the key is \"{other}\" (its name carries the unit)");
    }
    match nearest(key, known.clone().map(String::as_str)) {
        Some(near) => format!("unknown key; did you mean \"{near}\"?"),
        None => format!("unknown key; known here: {}", known.cloned().collect::<Vec<_>>().join(", ")),
    }
}

fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|k| (strsim::jaro_winkler(word, k), k))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(likeness, _)| *likeness > 0.78)
        .map(|(_, k)| k)
}
