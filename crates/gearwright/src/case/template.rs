//! Commented case files for `gearwright init`, made from the schema's documentation and an example that runs.

use super::reference::{KeyReference, keys};

/// Kinds of case files that can be written.
pub const KINDS: [&str; 1] = ["spur-pair"];

/// Values of the example: the unity-ratio pair of the dissertation (sections 2.2 and 3.2.3), bore and fillet chosen here.
const EXAMPLE: &[(&str, &str)] = &[
    ("kind", "\"spur-pair\""),
    ("title", "\"Unity-ratio pair, 25 teeth, module 6 mm\""),
    ("mesh.module_mm", "6.0"),
    ("mesh.pressure_angle_deg", "20.0"),
    ("mesh.centre_distance_mm", "150.1"),
    ("pinion.teeth", "25"),
    ("pinion.profile_shift", "0.0"),
    ("pinion.tip_diameter_mm", "162.0"),
    ("pinion.root_diameter_mm", "135.0"),
    ("pinion.bore_diameter_mm", "60.0"),
    ("pinion.facewidth_mm", "16.0"),
    ("gear.teeth", "25"),
    ("gear.profile_shift", "0.0"),
    ("gear.tip_diameter_mm", "162.0"),
    ("gear.root_diameter_mm", "135.0"),
    ("gear.bore_diameter_mm", "60.0"),
    ("gear.facewidth_mm", "16.0"),
    ("load.torque_n_m", "200.0"),
];

/// A commented case file.
#[must_use]
pub fn spur_pair() -> String {
    let mut text = String::from(
        "# A gearwright case file. `gearwright check FILE` validates it, `gearwright run FILE` runs it,\n\
         # `gearwright explain KEY` explains a key. Keys carry their units; lines after \"#\" show optional keys.\n\n",
    );
    for key in keys() {
        text.push_str(&lines(&key));
    }
    text
}

fn lines(key: &KeyReference) -> String {
    let name = key.key.rsplit('.').next().unwrap_or(&key.key);
    if key.is_section {
        return format!("\n{}[{}]\n", wrapped(&key.text), key.key);
    }
    let example = EXAMPLE.iter().find(|(k, _)| *k == key.key).map(|(_, v)| *v);
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
