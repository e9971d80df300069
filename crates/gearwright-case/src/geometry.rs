//! Geometry errors in the units and names of the case file.

use gear_geom::GeometryError;

use super::document::Node;
use super::fault::Fault;

/// A geometry error at the key it comes from.
pub(super) fn geometry_fault(document: &Node, member: Option<&str>, error: &GeometryError) -> Fault {
    let (key, _) = key(error.parameter());
    let member = member.or(match error {
        GeometryError::Interference { member: "pinion", .. } => Some("gear"),
        GeometryError::Interference { .. } => Some("pinion"),
        _ => None,
    });
    let key = match member {
        _ if key.starts_with("mesh.") => key.to_owned(),
        Some(name) => format!("{name}.{key}"),
        None => "mesh.centre_distance_mm".to_owned(),
    };
    document.fault(&key, message(error))
}

/// Key of a field of a gear's specification, and the factor from SI to its unit.
fn key(parameter: &str) -> (&'static str, f64) {
    match parameter {
        "tip_radius" => ("tip_diameter_mm", 2e3),
        "root_radius" => ("root_diameter_mm", 2e3),
        "rim_radius" => ("bore_diameter_mm", 2e3),
        "thickness" => ("tooth_thickness_mm", 1e3),
        "facewidth" => ("facewidth_mm", 1e3),
        "tip_round" => ("tip_round_mm", 1e3),
        "fillet" => ("fillet.radius_mm", 1e3),
        "module" => ("mesh.module_mm", 1e3),
        "pressure_angle" => ("mesh.pressure_angle_deg", 1.0_f64.to_degrees()),
        "centre_distance" => ("mesh.centre_distance_mm", 1e3),
        "teeth" => ("teeth", 1.0),
        "end relief length" => ("modification.end_relief_length_mm", 1e3),
        "end relief amount" => ("modification.end_relief_um", 1e6),
        "lead_crown" => ("modification.lead_crown_um", 1e6),
        "lead_slope" => ("modification.lead_slope_um", 1e6),
        "pitch_errors" => ("modification.pitch_errors_um", 1e6),
        _ => ("modification", 1e3),
    }
}

/// What is wrong, in the case file's units.
fn message(error: &GeometryError) -> String {
    let named = |parameter: &str, value: f64| {
        let (key, factor) = key(parameter);
        let name = if key == "modification" { parameter } else { key };
        format!("{name} = {}", rounded(value * factor))
    };
    match error {
        GeometryError::OutOfRange { parameter, value, allowed } => {
            format!("{} is not allowed: {}", named(parameter, *value), in_millimetres(allowed))
        }
        GeometryError::Order { smaller, smaller_value, larger, larger_value } => {
            format!("{} must be smaller than {}", named(smaller, *smaller_value), named(larger, *larger_value))
        }
        other => in_millimetres(&other.to_string()),
    }
}

/// A number without the digits that conversion leaves.
fn rounded(value: f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6)
}

/// Lengths of a text, written as a number and `m`, in millimetres; of a range `0.1 to 0.2 m` both.
fn in_millimetres(text: &str) -> String {
    let mut words: Vec<String> = text.split(' ').map(str::to_owned).collect();
    let scaled = |word: &str| {
        let (open, number) = word.strip_prefix('(').map_or(("", word), |rest| ("(", rest));
        number.parse::<f64>().ok().map(|metres| format!("{open}{}", rounded(metres * 1e3)))
    };
    for index in 1..words.len() {
        let unit = words[index].trim_end_matches([';', ',', ')', ':', '.']);
        let Some(value) = Some(unit).filter(|unit| *unit == "m").and_then(|_| scaled(&words[index - 1])) else {
            continue;
        };
        words[index] = words[index].replacen('m', "mm", 1);
        words[index - 1] = value;
        if index >= 3
            && words[index - 2] == "to"
            && let Some(low) = scaled(&words[index - 3])
        {
            words[index - 3] = low;
        }
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_in_the_units_of_the_case_file() {
        let order = GeometryError::Order {
            smaller: "root_radius",
            smaller_value: 0.0815,
            larger: "tip_radius",
            larger_value: 0.081,
        };
        assert_eq!(message(&order), "root_diameter_mm = 163 must be smaller than tip_diameter_mm = 162");
        let range = GeometryError::OutOfRange {
            parameter: "tip_round",
            value: 0.004,
            allowed: "0 to 0.003 m (at most half a module)".into(),
        };
        assert_eq!(message(&range), "tip_round_mm = 4 is not allowed: 0 to 3 mm (at most half a module)");
        let distance = GeometryError::CentreDistance { centre_distance: 0.1301, least: 0.140954 };
        assert_eq!(
            message(&distance),
            "centre distance 130.1 mm is too small: the base circles need more than 140.954 mm"
        );
        let jam = GeometryError::NegativeBacklash { backlash: -1.25e-5 };
        assert!(message(&jam).contains("is -0.0125 mm; thin"), "{}", message(&jam));
        let pointed = GeometryError::PointedTeeth { pointed_radius: 0.0821, tip_radius: 0.083, tip_round: 0.00012 };
        assert!(message(&pointed).contains("radius 82.1 mm, inside the tip radius 83 mm (tip round 0.12 mm);"));
    }
}
