//! The program as a user meets it: what it writes, what it says of bad input, what it leaves behind.

#[macro_use]
mod common;

use std::path::Path;

use common::{Scratch, gearwright, text};

/// A small case that runs in well under a second.
const SMALL: &str = spur_pair!(
    "title = \"small\"\n",
    r#"
[analysis]
positions_per_cycle = 10
model = "plane-strain"
"#
);

#[test]
fn run_writes_everything_it_promises() {
    let scratch = Scratch::new();
    scratch.write("small.toml", SMALL);
    let output = gearwright(scratch.path(), &["run", "small.toml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let screen = text(&output.stdout);
    assert!(screen.contains("static transmission error") && screen.contains("results in out/small"), "{screen}");
    assert!(screen.lines().count() < 25, "more than one screen");
    let folder = scratch.path().join("out/small");
    for name in ["series.csv", "summary.json", "pinion.vtu", "gear.vtu", "contact_pressure.vtu"] {
        assert!(folder.join(name).metadata().unwrap().len() > 100, "{name}");
    }
    for name in [
        "transmission_error",
        "mesh_stiffness",
        "load_sharing",
        "tooth_forces",
        "flank_pressure",
        "contact_width",
        "peak_pressure",
    ] {
        let svg = std::fs::read_to_string(folder.join(format!("{name}.svg"))).unwrap();
        assert!(svg.contains("<svg") && !svg.contains("NaN"), "{name}.svg");
        let png = std::fs::read(folder.join(format!("{name}.png"))).unwrap();
        assert_eq!(&png[1..4], b"PNG", "{name}.png");
    }
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["results"]["status"]["converged"], 10);
    assert_eq!(summary["inputs"]["numerics"]["cells_per_half_width"], 8.0, "defaults are spelled out");
    let ste = &summary["results"]["ste_um"];
    // the table holds what the summary says
    let mut table = csv::Reader::from_path(folder.join("series.csv")).unwrap();
    let column = table.headers().unwrap().iter().position(|name| name == "ste_um").unwrap();
    let values: Vec<f64> = table.records().map(|r| r.unwrap()[column].parse().unwrap()).collect();
    assert_eq!(values.len(), 10);
    let largest = values.iter().copied().fold(0.0, f64::max);
    assert!((largest / ste["max"].as_f64().unwrap() - 1.0).abs() < 1e-8);
}

#[test]
fn run_again_replaces_results_but_never_a_foreign_folder() {
    let scratch = Scratch::new();
    scratch.write("small.toml", SMALL);
    for _ in 0..2 {
        assert!(gearwright(scratch.path(), &["run", "small.toml", "--out", "mine"]).status.success());
    }
    std::fs::create_dir(scratch.path().join("photos")).unwrap();
    std::fs::write(scratch.path().join("photos/a.jpg"), "x").unwrap();
    let output = gearwright(scratch.path(), &["run", "small.toml", "--out", "photos"]);
    assert!(!output.status.success());
    assert!(text(&output.stderr).contains("photos"), "{}", text(&output.stderr));
    assert!(scratch.path().join("photos/a.jpg").exists());
    assert_eq!(scratch.names(), ["mine", "photos", "small.toml"]);
}

#[test]
fn threads_do_not_change_the_table() {
    let scratch = Scratch::new();
    scratch.write("small.toml", SMALL);
    let table = |threads: &str| {
        assert!(
            gearwright(scratch.path(), &["run", "small.toml", "--threads", threads, "--out", threads]).status.success()
        );
        std::fs::read(scratch.path().join(threads).join("series.csv")).unwrap()
    };
    assert_eq!(table("1"), table("2"));
}

/// Bad input: the file's change, and what the message must name.
#[test]
fn bad_input_is_one_message_with_file_line_key_value_and_remedy() {
    let cases: [(&str, &str, &[&str]); 16] = [
        ("teeth = 25\nprofile_shift", "theeth = 25\nprofile_shift", &["case.toml:10", "pinion.theeth", "teeth"]),
        ("module_mm = 6.0", "modul_mm = 6.0", &["case.toml:5", "mesh.modul_mm", "module_mm"]),
        ("module_mm = 6.0", "module_in = 6.0", &["case.toml:5", "module_in", "module_mm"]),
        ("module_mm = 6.0", "module_mm = \"6 mm\"", &["case.toml:5", "mesh.module_mm", "6 mm", "number"]),
        ("module_mm = 6.0", "module_mm = -6.0", &["case.toml:5", "mesh.module_mm", "-6"]),
        ("torque_n_m = 200.0", "torque_n_m = nan", &["case.toml:26", "load.torque_n_m"]),
        ("torque_n_m = 200.0", "", &["load.torque_n_m", "required"]),
        (
            "model = \"plane-strain\"",
            "model = \"plain-strain\"",
            &["case.toml:30", "analysis.model", "plain-strain", "plane-strain"],
        ),
        ("kind = \"spur-pair\"", "kind = \"spur_pair\"", &["case.toml:1", "kind", "spur_pair", "spur-pair"]),
        ("centre_distance_mm = 150.1", "centre_distance_mm = 140.0", &["case.toml:7", "centre_distance_mm"]),
        ("centre_distance_mm = 150.1", "centre_distance_mm = 162.5", &["case.toml:7", "contact ratio"]),
        ("tip_diameter_mm = 162.0", "tip_diameter_mm = 182.0", &["case.toml:12", "pinion.tip_diameter_mm", "pointed"]),
        ("bore_diameter_mm = 60.0", "bore_diameter_mm = 140.0", &["case.toml:14", "pinion.bore_diameter_mm"]),
        ("[mesh]", "[mesh", &["case.toml:4"]),
        ("positions_per_cycle = 10", "positions_per_cycle = 0", &["case.toml:29", "analysis.positions_per_cycle", "0"]),
        (
            "facewidth_mm = 16.0\n\n[gear]",
            "facewidth_mm = 16.0\nmodification.deviation_table = \"nowhere.csv\"\n\n[gear]",
            &["case.toml:16", "nowhere.csv"],
        ),
    ];
    for (from, to, wanted) in cases {
        let scratch = Scratch::new();
        assert!(SMALL.contains(from), "{from}");
        scratch.write("case.toml", &SMALL.replacen(from, to, 1));
        for command in ["run", "check"] {
            let output = gearwright(scratch.path(), &[command, "case.toml"]);
            let message = text(&output.stderr);
            assert!(!output.status.success(), "{to} was accepted");
            for word in wanted {
                assert!(message.contains(word), "{to:?}: \"{word}\" is missing in: {message}");
            }
            assert!(!message.contains("panicked"), "{message}");
            assert_eq!(scratch.names(), ["case.toml"], "{to} left something behind");
        }
    }
}

#[test]
fn missing_file_says_what_to_do() {
    let scratch = Scratch::new();
    let output = gearwright(scratch.path(), &["run", "absent.toml"]);
    assert!(!output.status.success());
    let message = text(&output.stderr);
    assert!(message.contains("absent.toml") && message.contains("gearwright init"), "{message}");
}

#[test]
fn all_faults_are_told_at_once() {
    let scratch = Scratch::new();
    scratch.write("case.toml", &SMALL.replace("teeth = 25", "teeth = 2").replace("torque_n_m", "torqe_n_m"));
    let message = text(&gearwright(scratch.path(), &["check", "case.toml"]).stderr);
    for word in ["pinion.teeth", "gear.teeth", "load.torqe_n_m", "load.torque_n_m"] {
        assert!(message.contains(word), "{word} is missing in: {message}");
    }
}

#[test]
fn init_writes_cases_that_check_and_explain_themselves() {
    // one folder for all: a case may refer to that of a kind before it
    let scratch = Scratch::new();
    for kind in gearwright_case::kind::KINDS {
        assert!(gearwright(scratch.path(), &["init", kind.name]).status.success());
        let name = format!("{}.toml", kind.name);
        let check = gearwright(scratch.path(), &["check", &name]);
        assert!(check.status.success(), "{}", text(&check.stderr));
        let written = std::fs::read_to_string(scratch.path().join(&name)).unwrap();
        // every key that can be set is there, set or as a comment, with its meaning
        for key in gearwright_case::reference::keys(kind) {
            let last = key.key.rsplit('.').next().unwrap();
            assert!(written.contains(last), "{} is missing in the template", key.key);
            assert!(!key.text.is_empty(), "{} is not documented", key.key);
        }
        let again = gearwright(scratch.path(), &["init", kind.name]);
        assert!(!again.status.success(), "an existing file is not overwritten");
    }
}

#[test]
fn explain_tells_meaning_range_and_default() {
    let scratch = Scratch::new();
    let output = text(&gearwright(scratch.path(), &["explain", "cells_per_half_width"]).stdout);
    for word in ["numerics.cells_per_half_width", "allowed", "default 8"] {
        assert!(output.contains(word), "{word}: {output}");
    }
    let wrong = gearwright(scratch.path(), &["explain", "cells_per_halfwidth"]);
    assert!(!wrong.status.success() && text(&wrong.stderr).contains("cells_per_half_width"));
}

#[test]
fn every_case_of_the_repository_is_valid() {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs");
    let mut count = 0;
    for entry in std::fs::read_dir(&configs).unwrap() {
        let file = entry.unwrap().path();
        // some cases refer to other files beside them
        if file.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let output = gearwright(&configs, &["check", &file.to_string_lossy()]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        count += 1;
    }
    assert!(count >= 4);
}
