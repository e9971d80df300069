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
fn verify_finds_changed_and_missing_results_and_leaves_other_files_alone() {
    let scratch = Scratch::new();
    scratch.write("small.toml", SMALL);
    let verify = || {
        let output = gearwright(scratch.path(), &["verify", "out/small"]);
        (output.status.code(), text(&output.stdout) + &text(&output.stderr))
    };
    assert_eq!(verify().0, Some(2), "no such folder");
    assert!(gearwright(scratch.path(), &["run", "small.toml"]).status.success());
    let (code, said) = verify();
    assert!(code == Some(0) && said.contains("0 changed, 0 missing, 0 not from gearwright"), "{said}");
    let series = scratch.path().join("out/small/series.csv");
    let table = std::fs::read_to_string(&series).unwrap();
    std::fs::write(&series, table.replacen('1', "2", 1)).unwrap();
    std::fs::remove_file(scratch.path().join("out/small/gear.vtu")).unwrap();
    scratch.write("out/small/my-notes.txt", "mine");
    let (code, said) = verify();
    assert_eq!(code, Some(3));
    for word in ["changed: series.csv", "missing: gear.vtu", "1 not from gearwright"] {
        assert!(said.contains(word), "{said}");
    }
    // a new run keeps the notes and the edited table
    assert!(gearwright(scratch.path(), &["run", "small.toml"]).status.success());
    assert!(scratch.path().join("out/small/my-notes.txt").exists());
    assert_eq!(std::fs::read_to_string(&series).unwrap(), table);
    assert!(scratch.path().join("out/small/series.csv.kept").exists());
    assert_eq!(scratch.names(), ["out", "small.toml"]);
}

/// Runs the program with an exit code.
fn code(scratch: &Scratch, arguments: &[&str]) -> (Option<i32>, String) {
    let output = gearwright(scratch.path(), arguments);
    (output.status.code(), text(&output.stderr))
}

#[test]
fn exit_codes_are_a_contract() {
    let scratch = Scratch::new();
    scratch.write("small.toml", SMALL);
    // 0 usable
    assert_eq!(code(&scratch, &["run", "small.toml"]).0, Some(0));
    assert_eq!(code(&scratch, &["check", "small.toml"]).0, Some(0));
    // 1 error: the results cannot be written below a file
    scratch.write("file", "x");
    assert_eq!(code(&scratch, &["run", "small.toml", "--out", "file/results"]).0, Some(1));
    // 2 refused: command line, case, target
    scratch.write("wrong.toml", &SMALL.replace("teeth = 25", "teeth = 2"));
    scratch.write("photos/a.jpg", "x");
    for refused in [
        &["run"][..],
        &["run", "absent.toml"],
        &["run", "wrong.toml"],
        &["check", "wrong.toml"],
        &["run", "small.toml", "--threads", "0"],
        &["run", "small.toml", "--threads", "1000000"],
        &["run", "small.toml", "--out", "photos"],
        &["init", "nonsense"],
        &["explain", "nonsense"],
        &["schema", "nonsense"],
        &["hums"],
        &["hums", "--signal", "absent.wav", "--teeth", "20", "--speed-hz", "10"],
        &["verify", "photos"],
    ] {
        let (code, said) = code(&scratch, refused);
        assert!(code == Some(2) && said.contains("error:"), "{refused:?}: {code:?} {said}");
    }
    // 3 unusable: a load that needs wider contact grids than the teeth are long
    scratch.write("overloaded.toml", &SMALL.replace("torque_n_m = 200.0", "torque_n_m = 2e6"));
    let (overloaded, said) = code(&scratch, &["run", "overloaded.toml"]);
    assert!(
        overloaded == Some(3) && said.contains("10 of 10 positions have no usable answer"),
        "{overloaded:?} {said}"
    );
    assert!(scratch.path().join("out/overloaded/series.csv").exists());
    // the help holds the contract
    let help = text(&gearwright(scratch.path(), &["--help"]).stdout);
    for line in ["0    done", "1    error", "2    refused", "3    results written", "130  stopped"] {
        assert!(help.contains(line), "{line}: {help}");
    }
}

#[cfg(unix)]
#[test]
fn a_signal_stops_a_run_with_130_and_leaves_nothing_behind() {
    let scratch = Scratch::new();
    scratch.write("long.toml", &SMALL.replace("positions_per_cycle = 10", "positions_per_cycle = 2000"));
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_gearwright"))
        .args(["run", "long.toml"])
        .current_dir(scratch.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let work = scratch.path().join("out/.long.gearwright-new");
    while !work.exists() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    // the handler is set before the folder is made
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    let said = text(&output.stderr);
    assert!(output.status.code() == Some(130) && said.contains("stopped"), "{:?} {said}", output.status);
    assert_eq!(scratch.names(), ["long.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_may_be_closed_or_full() {
    use std::process::{Command, Stdio};
    let scratch = Scratch::new();
    scratch.write("small.toml", SMALL);
    let program = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gearwright"));
        command.current_dir(scratch.path()).stderr(Stdio::piped());
        command
    };
    // a reader that has gone
    for arguments in [&["schema", "transmission"][..], &["explain"], &["check", "small.toml"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = program().args(arguments).stdout(writer).output().unwrap();
        assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""), "{arguments:?}");
    }
    // a full disk
    for arguments in [&["check", "small.toml"][..], &["schema", "transmission"], &["run", "small.toml"]] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = program().args(arguments).stdout(full).output().unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("error: standard output cannot be written") && !said.contains("panicked"), "{said}");
    }
    // standard error gone as well: the exit code stays
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = program().args(["run", "absent.toml"]).stderr(writer).status().unwrap();
    assert_eq!(status.code(), Some(2));
}

#[cfg(unix)]
#[test]
fn devices_pipes_and_files_without_end_are_refused_at_once() {
    let scratch = Scratch::new();
    assert!(std::process::Command::new("mkfifo").arg(scratch.path().join("pipe")).status().unwrap().success());
    let large = std::fs::File::create(scratch.path().join("large")).unwrap();
    // sparse: it takes no room
    large.set_len(10 << 30).unwrap();
    let lumped = |file: &str| {
        format!("kind = \"lumped-pair\"\n[pair]\ninput = \"prescribed\"\n[excitation]\ntable.file = \"{file}\"\n")
    };
    let dynamics = |file: &str| {
        format!("kind = \"dynamics\"\n[pair]\ninput = \"prescribed\"\nspur_pair = \"{file}\"\n[run]\nspeed_rpm = 1.0\n")
    };
    let deviation = |file: &str| {
        let key = format!("facewidth_mm = 16.0\nmodification.deviation_table = \"{file}\"\n\n[gear]");
        SMALL.replacen("facewidth_mm = 16.0\n\n[gear]", &key, 1)
    };
    for (file, reason) in [("/dev/zero", "device"), ("pipe", "pipe"), ("large", "bytes"), (".", "folder")] {
        for content in [lumped(file), dynamics(file), deviation(file)] {
            scratch.write("case.toml", &content);
            let (code, said) = code(&scratch, &["check", "case.toml"]);
            assert!(code == Some(2) && said.contains(reason), "{file}: {code:?} {said}");
        }
        let (code, said) = code(&scratch, &["check", file]);
        assert!(code == Some(2) && said.contains(reason), "{file}: {code:?} {said}");
    }
}

#[test]
fn messages_are_short_and_do_not_steer_the_terminal() {
    let scratch = Scratch::new();
    let said = |content: &str| {
        scratch.write("case.toml", content);
        let (code, said) = code(&scratch, &["check", "case.toml"]);
        assert_eq!(code, Some(2), "{said}");
        assert!(!said.contains('\u{1b}') && said.len() < 20_000, "{} bytes", said.len());
        said
    };
    let long = "x".repeat(1 << 20);
    assert!(said(&SMALL.replace("25", &format!("\"{long}\""))).contains("more characters"));
    assert!(said(&SMALL.replace("\"small\"", "\"\\u001b[2Jgone\"")).contains("control characters"));
    let keys: String = (0..100_000).map(|k| format!("key_{k} = 1\n")).collect();
    assert!(said(&format!("{SMALL}{keys}")).contains("more faults"));
    said(&SMALL.replace("[mesh]", &format!("[{long}]")));
    // each reason once
    scratch.write("file", "x");
    let (_, said) = code(&scratch, &["run", "absent.toml", "--out", "file/results"]);
    assert_eq!(said.matches("no such file").count(), 1, "{said}");
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
