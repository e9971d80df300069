//! Notes and refusals: nothing that is accepted is ignored, physics out of range is reported, errors speak the case file's language.

use std::path::Path;

use gearwright_case::notes::WarningKind;
use gearwright_case::{Notes, from_text};

fn pair(torque: f64, bore: f64, rest: &str) -> String {
    let gear = |bore: f64| {
        format!(
            "teeth = 25\nprofile_shift = 0.0\ntip_diameter_mm = 81.0\nroot_diameter_mm = 67.5\nbore_diameter_mm = {bore}\nfacewidth_mm = 20.0\n"
        )
    };
    format!(
        "kind = \"spur-pair\"\n[mesh]\nmodule_mm = 3.0\npressure_angle_deg = 20.0\ncentre_distance_mm = 75.05\n\
         [pinion]\n{}[gear]\n{}[load]\ntorque_n_m = {torque}\n{rest}",
        gear(bore),
        gear(30.0)
    )
}

fn notes(text: &str) -> Notes {
    from_text(text, Path::new("case.toml")).unwrap_or_else(|faults| panic!("{faults}")).notes().clone()
}

fn faults(text: &str) -> String {
    from_text(text, Path::new("case.toml")).unwrap_err().to_string()
}

fn ranges(notes: &Notes) -> Vec<&str> {
    let all = notes.warnings.iter().filter(|warning| warning.kind == WarningKind::Range);
    all.map(|warning| warning.place.key.as_str()).collect()
}

/// 100 N m are usual for module 3 mm; 30,000 N m break the teeth: pressure, bending of both roots, deflection.
#[test]
fn overload_is_reported_with_its_limits() {
    assert_eq!(ranges(&notes(&pair(100.0, 30.0, ""))), Vec::<&str>::new());
    let over = notes(&pair(30_000.0, 30.0, ""));
    assert_eq!(ranges(&over), ["load.torque_n_m"; 4]);
    let text = over.to_string();
    for part in ["contact pressure", "root of the pinion", "root of the gear", "deflection of the teeth", "ISO 6336"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// ISO 6336-3: `s_R / h_t = (67.5 - 62) / 2 / 6.75 = 0.41`, `Y_B = 1.6 ln(2.242 / 0.407) = 2.73`; 1.2 and more is thick.
#[test]
fn thin_rims_are_reported_with_their_factor() {
    let thin = notes(&pair(100.0, 62.0, ""));
    assert_eq!(ranges(&thin), ["pinion.bore_diameter_mm"]);
    let message = &thin.warnings[0].place.message;
    assert!(message.contains("0.41 tooth heights") && message.contains("Y_B = 2.73"), "{message}");
    assert!(message.contains("bonded to a rigid body"), "{message}");
    assert!(ranges(&notes(&pair(100.0, 51.0, ""))).is_empty());
    let free = notes(&pair(100.0, 62.0, "").replacen(
        "bore_diameter_mm = 62",
        "hub.condition = \"tractions\"\nbore_diameter_mm = 62",
        1,
    ));
    assert!(free.warnings[0].place.message.contains("free at the bore"));
}

#[test]
fn keys_without_effect_are_named() {
    let text = pair(
        100.0,
        30.0,
        "map_from_n_m = 10.0\n[analysis]\nmodel = \"plane-stress\"\n[numerics]\nface_cells = 10\n[[damage]]\non = \"gear\"\ntooth = 12\ncrack.length_percent = 30.0\n",
    );
    let named: Vec<(Option<usize>, String)> =
        notes(&text).warnings.into_iter().map(|warning| (warning.place.line, warning.place.key)).collect();
    let expected = [(Some(26), "numerics.face_cells"), (Some(22), "load.map_from_n_m"), (Some(27), "damage[1]")];
    assert_eq!(named.len(), expected.len(), "{named:?}");
    for (line, key) in expected {
        assert!(named.iter().any(|own| own.0 == line && own.1 == key), "{key}: {named:?}");
    }
    // the healthy pair says what it assumes, and nothing else
    let plain = notes(&pair(100.0, 30.0, ""));
    assert!(plain.warnings.is_empty(), "{plain}");
    assert!(plain.assumptions.iter().any(|a| a.contains("three dimensions")), "{plain}");
    assert!(plain.assumptions.iter().any(|a| a.contains("pinion, gear: bonded at the bore")), "{plain}");
}

#[test]
fn what_a_model_cannot_have_is_refused_with_the_reason() {
    let plane = "[analysis]\nmodel = \"plane-stress\"\n";
    for key in ["lead_slope_um", "lead_crown_um", "end_relief_um"] {
        let own = format!("{plane}[pinion.modification]\n{key} = 5.0\nend_relief_length_mm = 3.0\n");
        let message = faults(&pair(100.0, 30.0, &own));
        assert!(message.contains(key) && message.contains("lead modifications need 3-D teeth"), "{message}");
        let zero = own.replace("= 5.0", "= 0.0");
        assert!(from_text(&pair(100.0, 30.0, &zero), Path::new("case.toml")).is_ok());
    }
    let long = format!("[gear.modification]\npitch_errors_um = {:?}\n", vec![1.0; 26]);
    assert!(faults(&pair(100.0, 30.0, &long)).contains("26 values; this gear has 25 teeth"));
    let empty = "[[damage]]\non = \"gear\"\ncrack.length_percent = []\n";
    assert!(faults(&pair(100.0, 30.0, empty)).contains("is an empty list"));
    let helical = pair(100.0, 30.0, "").replace("module_mm = 3.0", "module_mm = 3.0\nhelix_angle_deg = 12.0");
    assert!(faults(&helical).contains("helical gears are not supported"));
}

#[test]
fn geometry_errors_are_in_millimetres_and_by_key() {
    let message = faults(&pair(100.0, 68.0, ""));
    assert!(message.contains("bore_diameter_mm = 68 must be smaller than root_diameter_mm = 67.5"), "{message}");
    let message = faults(&pair(100.0, 30.0, "").replace("75.05", "70.0"));
    assert!(message.contains("centre distance 70 mm is too small") && message.contains("70.477 mm"), "{message}");
    for text in [pair(100.0, 68.0, ""), pair(100.0, 30.0, "").replace("75.05", "74.0")] {
        let message = faults(&text);
        assert!(!message.contains(" m ") && !message.contains("_radius"), "{message}");
    }
}
