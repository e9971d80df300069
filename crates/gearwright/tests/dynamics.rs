//! Dynamics cases as a user meets them: everything promised is written and right, runs go on after an interruption, bad input is told.

#[macro_use]
mod common;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{Scratch, gearwright, text};
use fecm::statics::Observer;
use gearwright::run::RunObserver;
use serde_json::Value;

/// A pair in plane strain with two cracks on pinion tooth 0, which is in mesh about mesh cycle 0.
const SPUR: &str = spur_pair!(
    "",
    r#"
[analysis]
model = "plane-strain"

[[damage]]
on = "pinion"
tooth = 0
crack.length_percent = [20.0, 60.0]
"#
);

const CASE: &str = r#"kind = "dynamics"
title = "small"

[pair]
spur_pair = "spur.toml"
input = "prescribed"

[damping]
mass_proportional_per_s = 3000.0

[run]
speed_rpm = 3000.0
steps_per_mesh_cycle = 20
mesh_cycle_origin = 10.0
"#;

const HEALTHY: &str = "spur_pair = \"spur.toml\"\nseverities = []";

fn healthy() -> String {
    CASE.replace("spur_pair = \"spur.toml\"", HEALTHY)
}

impl Scratch {
    /// With the spur-pair case.
    fn with_pair() -> Self {
        let scratch = Self::new();
        scratch.write("spur.toml", SPUR);
        scratch
    }
}

fn column(file: &Path, name: &str) -> Vec<f64> {
    let mut table = csv::Reader::from_path(file).unwrap();
    let index = table.headers().unwrap().iter().position(|header| header == name).unwrap();
    let values: Vec<f64> = table.records().map(|record| record.unwrap()[index].parse().unwrap()).collect();
    assert!(values.iter().all(|v| v.is_finite()), "{name}");
    values
}

/// All tables of a folder, names and bytes.
fn tables(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut all: Vec<_> = files
        .filter(|file| file.extension().is_some_and(|e| e == "csv"))
        .map(|file| (file.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&file).unwrap()))
        .collect();
    all.sort();
    all
}

#[test]
fn run_writes_everything_it_promises_and_it_hangs_together() {
    let scratch = Scratch::with_pair();
    let (folder, summary) = scratch.run("small", CASE);
    let spectra = ["spectrum", "spectrum_damage_1", "difference_spectrum_damage_1", "difference_spectrum_damage_2"];
    for name in ["response", "response_damage_1", "response_damage_2", "tooth_forces"].iter().chain(&spectra) {
        assert!(folder.join(format!("{name}.csv")).metadata().unwrap().len() > 1000, "{name}");
    }
    for name in ["dynamic_transmission_error", "mesh_force", "spectrum", "difference", "difference_spectrum"] {
        for kind in ["svg", "png"] {
            assert!(folder.join(format!("{name}.{kind}")).metadata().unwrap().len() > 1000, "{name}.{kind}");
        }
    }
    // one rotation, from the mesh cycle asked for
    let response = folder.join("response.csv");
    let cycles = column(&response, "mesh_cycle");
    assert_eq!((cycles.len(), cycles[0], cycles[20]), (500, 0.0, 1.0));
    let healthy = column(&response, "dte_um");
    for k in 0..480 {
        assert!((healthy[k + 20] - healthy[k]).abs() < 2e-3, "a healthy pair repeats every mesh cycle");
    }
    // in steady motion the mean force balances the torque: F r_b = T
    let state = &summary["speeds"][0]["states"][0];
    let force = column(&response, "mesh_force_n");
    let mean = force.iter().sum::<f64>() / 500.0;
    let (torque, radius) = (200.0, 0.075 * 20.0_f64.to_radians().cos());
    assert!((mean / (torque / radius) - 1.0).abs() < 5e-3, "{mean}");
    assert_eq!(state["steady"], true);
    assert_eq!(state["contact_loss_mesh_cycles"].as_array().unwrap().len(), 0);
    // the difference is what its name says, nothing before the damaged tooth, and worse for the longer crack
    let mut rms = Vec::new();
    for number in [1, 2] {
        let damaged = column(&folder.join(format!("response_damage_{number}.csv")), "dte_um");
        let difference = column(&folder.join(format!("difference_damage_{number}.csv")), "difference_um");
        for k in 0..500 {
            assert!((damaged[k] - healthy[k] - difference[k]).abs() < 1e-6 * healthy[k].abs().max(1.0));
        }
        let largest = difference.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        let at = difference.iter().position(|d| d.abs() == largest).unwrap();
        assert!((9.0..11.5).contains(&cycles[at]), "{}", cycles[at]);
        assert!(difference[..160].iter().all(|d| d.abs() < 0.05 * largest));
        let written = &summary["speeds"][0]["states"][number]["difference"];
        let own = (difference.iter().map(|d| d * d).sum::<f64>() / 500.0).sqrt();
        assert!((written["rms_um"].as_f64().unwrap() / own - 1.0).abs() < 1e-6);
        assert!(written["fm4"].as_f64().unwrap() > 3.0 && written["m8a"].as_f64().unwrap() > 105.0);
        rms.push(own);
    }
    assert!(rms[1] > 2.0 * rms[0], "{rms:?}");
    // defaults are spelled out: a steel ring between 60 mm and about 150 mm diameter, 16 mm wide, weighs 1.85 kg
    let pinion = &summary["inputs"]["pinion"];
    assert!((pinion["mass_kg"].as_f64().unwrap() / 1.85 - 1.0).abs() < 0.05);
    assert!(pinion["transverse_inertia_kg_m2"].as_f64().unwrap() > 0.0);
    assert_eq!(summary["inputs"]["run"]["mesh_cycles"], 25);
    assert!(
        state["work"]["worst_defect_j"].as_f64().unwrap() < 1e-9 * state["work"]["energy_scale_j"].as_f64().unwrap()
    );
}

#[test]
fn spectrum_and_tooth_forces_agree_with_the_response() {
    let scratch = Scratch::with_pair();
    let (folder, summary) = scratch.run("small", &healthy());
    let response = folder.join("response.csv");
    let dte = column(&response, "dte_um");
    let (mut re, mut im) = (0.0, 0.0);
    for (k, x) in dte.iter().enumerate() {
        let phase = 2.0 * std::f64::consts::PI * k as f64 / 20.0;
        re += x * phase.cos() / 250.0;
        im += x * phase.sin() / 250.0;
    }
    let spectrum = folder.join("spectrum.csv");
    let line = column(&spectrum, "mesh_order").iter().position(|order| (order - 1.0).abs() < 1e-6).unwrap();
    let amplitude = column(&spectrum, "amplitude_um")[line];
    assert!((amplitude / f64::hypot(re, im) - 1.0).abs() < 1e-6, "{amplitude}");
    assert!((column(&spectrum, "frequency_hz")[line] / 1250.0 - 1.0).abs() < 1e-9);
    let harmonic = summary["speeds"][0]["states"][0]["harmonics_um"][0].as_f64().unwrap();
    assert!((harmonic / amplitude - 1.0).abs() < 1e-6);
    let teeth = folder.join("tooth_forces.csv");
    let (at, pair, force) = (column(&teeth, "mesh_cycle"), column(&teeth, "tooth_pair"), column(&teeth, "force_n"));
    let sums = column(&response, "mesh_cycle")
        .into_iter()
        .map(|cycle| at.iter().zip(&force).filter(|(a, _)| **a == cycle).map(|(_, f)| f).sum::<f64>());
    for (sum, whole) in sums.zip(column(&response, "mesh_force_n")) {
        assert!((sum / whole - 1.0).abs() < 1e-6);
    }
    // pair k is in mesh about mesh cycle k, counted from the origin
    assert!(pair.iter().zip(&at).all(|(k, cycle)| (k + 10.0 - cycle).abs() < 1.5));
}

/// Asks a run to stop after so many steps.
struct StopAfter(AtomicUsize);

impl Observer for StopAfter {
    fn advanced(&self, _: usize, _: usize) {
        let _ = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| Some(left.saturating_sub(1)));
    }

    fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) == 0
    }
}

impl RunObserver for StopAfter {}

/// Keeps the names of the stages.
#[derive(Default)]
struct Stages(std::sync::Mutex<Vec<String>>);

impl Observer for Stages {}

impl RunObserver for Stages {
    fn stage(&self, name: &str) {
        self.0.lock().unwrap().push(name.into());
    }
}

impl Stages {
    fn hold(&self, words: &str) -> bool {
        self.0.lock().unwrap().iter().any(|stage| stage.contains(words))
    }
}

#[test]
fn interrupted_runs_go_on_with_the_same_bits() {
    let scratch = Scratch::with_pair();
    let content = format!("{CASE}[output]\nplots = false\n[checkpoint]\nevery_steps = 170\n");
    let (whole, summary) = scratch.run("whole", &content);
    let case = gearwright_case::load(&scratch.path().join("whole.toml")).unwrap();
    let target = scratch.path().join("pieces");
    let checkpoint = scratch.path().join("pieces.checkpoint");
    // in the healthy transient, in the damaged transient, in a record: each goes on where the one before was stopped
    for steps in [33, 700, 900] {
        let stopped = gearwright::run::run(&case, &target, &StopAfter(AtomicUsize::new(steps)));
        let message = stopped.unwrap_err().to_string();
        assert!(message.contains("stopped") && message.contains("pieces.checkpoint"), "{message}");
        assert!(checkpoint.exists() && !target.exists());
    }
    let stages = Stages::default();
    gearwright::run::run(&case, &target, &stages).unwrap();
    assert!(stages.hold("taking up") && !stages.hold("not taking up"));
    assert!(!checkpoint.exists(), "removed with the results there");
    // the summary holds all digits, the account of energies among them; how long it took is the run's own
    let pieces = std::fs::read_to_string(target.join("summary.json")).unwrap();
    let pieces: Value = serde_json::from_str(&pieces).unwrap();
    for index in 0..3 {
        let state = |of: &Value| {
            let mut state = of["speeds"][0]["states"][index].clone();
            // a solver that starts anew has no contact to start from: more pivots for the same solution
            for counter in ["time_s", "pivots", "factorisations"] {
                assert!(state["work"].as_object_mut().unwrap().remove(counter).is_some());
            }
            assert!(state["work"]["external_j"].as_f64().unwrap() != 0.0);
            state
        };
        assert_eq!(state(&summary), state(&pieces));
    }
    let (whole, pieces) = (tables(&whole), tables(&target));
    assert!(whole.len() > 8);
    for (a, b) in whole.iter().zip(&pieces) {
        assert!(a == b, "{} differs after an interruption", a.0);
    }
}

#[test]
fn a_checkpoint_that_does_not_fit_is_not_taken_up() {
    let scratch = Scratch::with_pair();
    let content = format!("{}mesh_cycles = 2\n[output]\nplots = false\n[checkpoint]\nevery_steps = 10\n", healthy());
    scratch.write("case.toml", &content);
    let case = gearwright_case::load(&scratch.path().join("case.toml")).unwrap();
    let target = scratch.path().join("pieces");
    let checkpoint = scratch.path().join("pieces.checkpoint");
    let stop = || {
        assert!(gearwright::run::run(&case, &target, &StopAfter(AtomicUsize::new(25))).is_err());
        std::fs::read_to_string(&checkpoint).unwrap()
    };
    let start = |case: &gearwright_case::Case| {
        let stages = Stages::default();
        gearwright::run::run(case, &target, &stages).unwrap();
        let heard = |words: &str| stages.hold(words);
        [heard("not taking up"), heard("damaged"), heard("another case"), heard("another build")]
    };
    // one digit of the content: read as valid JSON before there was a checksum, and changed the results in silence
    let saved = stop();
    let at = saved.find("transmission_error").unwrap() + "transmission_error\":1".len();
    let digit = saved[at..].find(|c: char| c.is_ascii_digit()).unwrap() + at;
    let other = if &saved[digit..=digit] == "1" { "2" } else { "1" };
    std::fs::write(&checkpoint, format!("{}{other}{}", &saved[..digit], &saved[digit + 1..])).unwrap();
    assert_eq!(start(&case), [true, true, false, false]);
    // another case
    stop();
    scratch.write("case.toml", &content.replace("speed_rpm = 3000.0", "speed_rpm = 2900.0"));
    let changed = gearwright_case::load(&scratch.path().join("case.toml")).unwrap();
    assert_eq!(start(&changed), [true, false, true, false]);
    // another build of the program: this test's is not that of the command
    stop();
    scratch.write("case.toml", &content);
    let output = gearwright(scratch.path(), &["run", "case.toml", "--out", "pieces"]);
    assert!(output.status.success() && text(&output.stderr).contains("another build"), "{}", text(&output.stderr));
}

#[test]
fn films_speeds_bearings_and_blows() {
    let scratch = Scratch::with_pair();
    let film = "[output]\nfilm.mesh_cycle_from = 1.5\nfilm.mesh_cycle_to = 2.0\nfilm.every_steps = 2\n";
    let bearing = "[pinion.bearing]\nx_stiffness_n_per_m = 1e9\ny_stiffness_n_per_m = 1e9\n";
    let (folder, _) = scratch.run("film", &format!("{}mesh_cycles = 3\n{film}{bearing}", healthy()));
    let pvd = std::fs::read_to_string(folder.join("film.pvd")).unwrap();
    assert_eq!(pvd.matches("<DataSet").count(), 6);
    assert!(
        pvd.contains("timestep=\"1.5\" file=\"film/frame_000030.vtu\"")
            && folder.join("film/frame_000030.vtu").exists()
    );
    // under 1e9 N/m in both directions the bearing carries the mesh force
    let response = folder.join("response.csv");
    let sum = |name: &str| column(&response, name).iter().sum::<f64>() / 60.0;
    let (x, y) = (sum("pinion_x_bearing_force_n"), sum("pinion_y_bearing_force_n"));
    assert!((x.hypot(y) / sum("mesh_force_n") - 1.0).abs() < 5e-3, "{x} {y}");

    // so slow that even the harmonics of the mesh are far below the gear's own frequencies, modes in motion change little
    let slow = healthy().replace("speed_rpm = 3000.0", "speed_rpm = 100.0\nmesh_cycles = 1");
    let slow = slow.replace("[damping]\n", "[damping]\nmodal_ratio = 0.05\n");
    let (rigid, _) = scratch.run("rigid", &slow);
    let modes = "[gear]\nelastic_modes = 4\n";
    let (elastic, summary) = scratch.run("elastic", &format!("{slow}{modes}"));
    // modes that come in pairs are kept together
    assert!((4..=5).contains(&summary["model"]["elastic_modes_hz"][1].as_array().unwrap().len()));
    let (rigid, elastic) = [rigid, elastic].map(|folder| column(&folder.join("response.csv"), "dte_um")).into();
    let change = rigid.iter().zip(&elastic).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(change > 1e-9 && change < 0.1, "{change} um");

    let (folder, summary) =
        scratch.run("speeds", &healthy().replace("speed_rpm = 3000.0", "mesh_frequency_hz = [400.0, 800.0]"));
    assert_eq!(column(&folder.join("over_speed.csv"), "mesh_frequency_hz"), [400.0, 800.0]);
    assert!(folder.join("speed_2/response.csv").exists() && folder.join("peak_to_peak.png").exists());
    assert_eq!(summary["speeds"].as_array().unwrap().len(), 2);

    // mass-proportional damping: zeta = alpha / 2 omega
    let blow =
        healthy().replace("speed_rpm = 3000.0\n", "") + "[impulse]\nmesh_cycles = [10.0]\nnatural_periods = 12\n";
    let (folder, _) = scratch.run("blow", &blow);
    let table = folder.join("impulse.csv");
    let natural = column(&table, "natural_frequency_hz")[0];
    let ratio = column(&table, "damping_ratio_log_decrement")[0];
    assert!((ratio * 4.0 * std::f64::consts::PI * natural / 3000.0 - 1.0).abs() < 0.02, "{natural} {ratio}");
    assert!(folder.join("impulse_response.png").exists() && !folder.join("response.csv").exists());
}

#[test]
fn steps_left_out_follow_the_natural_period_at_every_speed() {
    let scratch = Scratch::with_pair();
    let content = healthy().replace("steps_per_mesh_cycle = 20\n", "mesh_cycles = 1\n");
    let content = content.replace("speed_rpm = 3000.0", "mesh_frequency_hz = [500.0, 1000.0, 6000.0]");
    let (folder, summary) = scratch.run("chosen", &content);
    let natural = summary["model"]["natural_frequency_hz"].as_f64().unwrap();
    // mass-proportional damping: zeta = alpha / 2 omega
    let ratio = summary["model"]["damping_ratio"].as_f64().unwrap();
    assert!((ratio * 4.0 * std::f64::consts::PI * natural / 3000.0 - 1.0).abs() < 1e-9);
    let speeds = summary["speeds"].as_array().unwrap();
    for (index, speed) in speeds.iter().enumerate() {
        let steps = speed["steps_per_mesh_cycle"].as_u64().unwrap();
        let mesh = speed["mesh_frequency_hz"].as_f64().unwrap();
        assert!(
            (speed["steps_per_natural_period"].as_f64().unwrap() / (steps as f64 * mesh / natural) - 1.0).abs() < 1e-9
        );
        assert!(steps >= 50 && speed["error_at_resonance"].as_f64().unwrap() <= 0.025 && speed["steps_chosen"] == true);
        let rows = column(&folder.join(format!("speed_{}/response.csv", index + 1)), "dte_um");
        assert_eq!(rows.len(), steps as usize);
    }
    assert!(speeds[0]["steps_per_mesh_cycle"].as_u64() > speeds[1]["steps_per_mesh_cycle"].as_u64());
    assert_eq!(speeds[2]["steps_per_mesh_cycle"], 50);
    assert!(summary["inputs"]["run"].get("steps_per_mesh_cycle").is_none(), "not one number for all speeds");
    let check = |name: &str| text(&gearwright(scratch.path(), &["check", name]).stdout);
    assert!(check("chosen.toml").contains(&format!("50 to {}; ", speeds[0]["steps_per_mesh_cycle"])));

    // few that are given are taken, and it is said what to write
    scratch.write("few.toml", &healthy().replace("speed_rpm = 3000.0", "mesh_frequency_hz = 500.0"));
    let enough = format!("few: write steps_per_mesh_cycle = {},", speeds[0]["steps_per_mesh_cycle"]);
    assert!(check("few.toml").contains("20 given") && check("few.toml").contains(&enough), "{}", check("few.toml"));
}

#[test]
fn bad_input_is_told_with_its_line_and_what_is_allowed() {
    let scratch = Scratch::with_pair();
    for (from, to, says) in [
        ("speed_rpm = 3000.0\n", "", "run.speed_rpm: this key is required"),
        ("speed_rpm = 3000.0", "speed_rpm = -3.0", "run.speed_rpm = -3.0: must be 0.001 to 1e7"),
        ("speed_rpm = 3000.0", "speed_rpm = []", "run.speed_rpm = []: must hold 1 to 1000 speeds"),
        ("speed_rpm = 3000.0", "speed_rpm = 10.0\nmesh_frequency_hz = 10.0", "not both"),
        ("speed_rpm", "speed_hz", "unknown key; the key is \"speed_rpm\""),
        ("\"prescribed\"", "\"held\"", "must be one of \"prescribed\", \"free\", \"shaft\""),
        ("\"prescribed\"", "\"shaft\"", "pair.shaft_stiffness_n_m_per_rad: this key is required"),
        ("\"prescribed\"", "\"free\"\nshaft_stiffness_n_m_per_rad = 1.0", "must be left out"),
        ("spur.toml\"", "spur.toml\"\nseverities = [3]", "the spur-pair case has severities 1 to 2, not 3"),
        ("spur.toml\"", "none.toml\"", "there is no such file"),
        ("spur.toml\"", "case.toml\"", "must be \"spur-pair\" here"),
        ("[damping]", "[gear]\nmass_kg = 0.0\n[damping]", "gear.mass_kg = 0.0: must be"),
        ("[damping]", "[gear.bearing]\nx_damping_n_s_per_m = 1.0\n[damping]", "damps nothing"),
        (
            "origin = 10.0",
            "origin = 10.0\nmesh_cycles = 3\n[output.film]\nmesh_cycle_from = 2.0\nmesh_cycle_to = 4.0",
            "within the record",
        ),
        ("origin = 10.0", "origin = 10.0\n[impulse]\nmesh_cycles = []", "at least one mesh cycle"),
        (
            "[damping]",
            "[numerics]\nintegrator = \"rk4\"\n[damping]",
            "must be one of \"newmark\", \"generalized-alpha\"",
        ),
    ] {
        assert!(CASE.contains(from), "{from}");
        scratch.write("case.toml", &CASE.replacen(from, to, 1));
        let output = gearwright(scratch.path(), &["run", "case.toml"]);
        let error = text(&output.stderr);
        assert!(!output.status.success() && error.contains(says), "{to}: {error}");
        assert!(error.contains("case.toml:") && !error.contains("panicked"), "{to}: {error}");
    }
}

#[test]
fn init_writes_a_case_that_checks() {
    let scratch = Scratch::new();
    for kind in ["spur-pair", "dynamics"] {
        let output = gearwright(scratch.path(), &["init", kind]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let output = gearwright(scratch.path(), &["check", "dynamics.toml"]);
    let told = text(&output.stdout);
    assert!(told.contains("1500.0 rpm, 25 mesh cycles recorded, 1 states"), "{}", text(&output.stderr));
    assert!(told.contains(" chosen: ") && told.contains("in the natural period"), "{told}");
    assert!(text(&gearwright(scratch.path(), &["explain", "steady_tolerance"]).stdout).contains("default 0.0001"));
}
