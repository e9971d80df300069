//! Lumped-pair cases as a user meets them: everything promised is written and right, bad input is told, sources agree.

#[macro_use]
mod common;

use common::{Scratch, gearwright, text};
use std::collections::BTreeMap;
use std::path::Path;

/// Table 3.2 with the two stiffnesses that its natural frequencies imply, and one state 10 % softer for a cycle.
const CASE: &str = r#"kind = "lumped-pair"
title = "small"

[pair]
input = "prescribed"
gear_torque_n_m = 424.0
mesh_damping_n_s_per_m = 3660.0
damping_when_apart = true

[pair.pinion]
teeth = 27
base_radius_mm = 35.20
mass_kg = 0.7294
inertia_kg_m2 = 0.0008
support_stiffness_n_per_m = 1e12
support_damping_n_s_per_m = 800.0

[pair.gear]
base_radius_mm = 45.63
mass_kg = 0.8537
inertia_kg_m2 = 0.0050
support_stiffness_n_per_m = 1e12
support_damping_n_s_per_m = 800.0

[excitation.wave]
single_stiffness_n_per_um = 533.0
double_stiffness_n_per_um = 806.0
contact_ratio = 1.64
double_from_mesh_cycle = 0.18

[[state]]
name = "softer"
mesh_cycle = 14
stiffness_factor = 0.9

[analysis.time]
mesh_frequency_hz = 1800.0

[analysis.sweep]
from_hz = 1400.0
to_hz = 2800.0
step_hz = 50.0

[analysis.continuation]
from_hz = 1400.0
to_hz = 2800.0

[analysis.impulse]
impulse_n_s = 0.001
mesh_cycles = [0.0, 0.5]

[analysis.damage]
mesh_frequencies_hz = [900.0]
from_hz = 500.0
to_hz = 900.0
step_hz = 100.0
"#;

/// Columns of a table by name.
fn table(file: &Path) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::Reader::from_path(file).unwrap();
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let mut columns: BTreeMap<String, Vec<String>> = names.iter().map(|n| (n.clone(), Vec::new())).collect();
    for record in reader.records() {
        for (name, cell) in names.iter().zip(record.unwrap().iter()) {
            columns.get_mut(name).unwrap().push(cell.to_owned());
        }
    }
    columns
}

fn numbers(table: &BTreeMap<String, Vec<String>>, column: &str) -> Vec<f64> {
    let values: Vec<f64> = table[column].iter().map(|c| c.parse().unwrap()).collect();
    assert!(values.iter().all(|v| v.is_finite()), "{column}");
    values
}

/// Rows of a state.
fn of_state(table: &BTreeMap<String, Vec<String>>, column: &str, state: &str) -> Vec<f64> {
    let all = numbers(table, column);
    all.into_iter().zip(&table["state"]).filter(|(_, s)| *s == state).map(|(v, _)| v).collect()
}

#[test]
fn run_writes_everything_it_promises() {
    let scratch = Scratch::new();
    let (folder, summary) = scratch.run("small", CASE);
    for name in [
        "mesh_stiffness",
        "static_transmission_error",
        "dynamic_transmission_error",
        "spectrum",
        "mesh_force",
        "bearing_forces",
        "peak_to_peak",
        "rms",
        "impulse_response",
        "damage_response",
        "damage_spectrum",
        "damage_over_speed",
    ] {
        let svg = std::fs::read_to_string(folder.join(format!("{name}.svg"))).unwrap();
        assert!(svg.contains("<svg") && !svg.contains("NaN"), "{name}.svg");
        assert_eq!(&std::fs::read(folder.join(format!("{name}.png"))).unwrap()[1..4], b"PNG", "{name}.png");
    }
    // one rotation of 27 cycles, 100 samples each, in both states
    let response = table(&folder.join("response.csv"));
    for state in ["healthy", "softer"] {
        let dte = of_state(&response, "dte_um", state);
        assert_eq!(dte.len(), 2700);
        let force = of_state(&response, "mesh_force_n", state);
        let mean = force.iter().sum::<f64>() / 2700.0;
        // a steady swing has no mean acceleration: the mean mesh force is T / r = 9292 N up to the error of the trapezoidal rule
        assert!((mean / (424.0 / 0.04563) - 1.0).abs() < 1e-3, "{state}: {mean}");
        for column in ["pinion_bearing_force_n", "gear_bearing_force_n"] {
            let bearing = of_state(&response, column, state);
            assert!(bearing.iter().zip(&force).all(|(b, f)| (b.abs() - f.abs()).abs() < 1e-6 * f.abs().max(1.0)));
        }
    }
    // amplitudes and samples carry the same energy (Parseval)
    let spectrum = table(&folder.join("spectrum.csv"));
    let lines = of_state(&spectrum, "amplitude_um", "healthy");
    let dte = of_state(&response, "dte_um", "healthy");
    let mean = dte.iter().sum::<f64>() / 2700.0;
    let energy: f64 = dte.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 2700.0;
    let sum = lines[1..1350].iter().map(|a| 0.5 * a * a).sum::<f64>() + lines[1350].powi(2);
    assert!((energy / sum - 1.0).abs() < 1e-9 && (mean / lines[0] - 1.0).abs() < 1e-9);
    assert!((summary["time_response"][0]["rms_um"].as_f64().unwrap().powi(2) / energy - 1.0).abs() < 1e-9);
    // sweep and branch find the same two motions between the turning points
    let sweep = table(&folder.join("sweep.csv"));
    assert_eq!(sweep["state"].len(), 4 * 29);
    let at = |direction: &str, speed: f64| {
        let frequency = numbers(&sweep, "mesh_frequency_hz");
        let peak = numbers(&sweep, "peak_to_peak_um");
        (0..peak.len())
            .find(|i| sweep["state"][*i] == "healthy" && sweep["direction"][*i] == direction && frequency[*i] == speed)
            .map(|i| peak[i])
            .unwrap()
    };
    assert!(at("down", 2000.0) > 3.0 * at("up", 2000.0));
    let both = summary["continuation"][0]["two_stable_solutions_hz"][0].as_array().unwrap();
    let (from, to) = (both[0].as_f64().unwrap(), both[1].as_f64().unwrap());
    // the library's documented example, on the same pair
    assert!((from - 1705.0).abs() < 1.0 && (to - 2348.0).abs() < 1.0, "{from} {to}");
    let jump = summary["sweeps"][0]["largest_jump_between_hz"].as_array().unwrap();
    assert!(jump[0].as_f64().unwrap() <= to && to <= jump[1].as_f64().unwrap());
    let branch = table(&folder.join("branch.csv"));
    assert_eq!(branch["turning_point"].iter().filter(|t| *t == "true").count(), 2);
    assert!(branch["stability"].iter().any(|s| s == "stable") && branch["stability"].iter().any(|s| s != "stable"));
    // a blow reads sqrt(k / m) at one and at two pairs, supports in series
    let impulse = table(&folder.join("impulse.csv"));
    let mass: f64 = 0.0050 / 0.04563_f64.powi(2);
    for (read, k) in of_state(&impulse, "natural_frequency_hz", "healthy").iter().zip([533e6, 806e6]) {
        let series = 1.0 / (1.0 / k + 2e-12);
        let exact = (series / mass).sqrt() / std::f64::consts::TAU;
        assert!((read / exact - 1.0).abs() < 1e-4, "{read} {exact}");
    }
    // the difference table is what its columns say; before the damage the pair has all but forgotten it
    let damage = table(&folder.join("damage_response.csv"));
    let columns = ["dte_damaged_um", "dte_healthy_um", "difference_um"].map(|c| numbers(&damage, c));
    assert!((0..2700).all(|i| (columns[0][i] - columns[1][i] - columns[2][i]).abs() < 1e-6));
    assert!(columns[2][..1400].iter().all(|d| d.abs() < 0.05) && columns[2][1400..1600].iter().any(|d| d.abs() > 1.0));
    assert_eq!(numbers(&table(&folder.join("damage_over_speed.csv")), "largest_amplitude_um").len(), 5);
    assert_eq!(table(&folder.join("curves.csv"))["state"].len(), 100 + 2700);
    assert!(folder.join("contact_loss.csv").exists() && folder.join("damage_spectrum.csv").exists());
}

#[test]
fn upper_motion_is_reached_from_above_and_loses_contact() {
    let scratch = Scratch::new();
    let tail = CASE.find("[analysis.time]").unwrap();
    let head = CASE[..tail].replace("[[state]]\nname = \"softer\"\nmesh_cycle = 14\nstiffness_factor = 0.9\n", "");
    let at = |name: &str, from: f64| {
        let time = format!("[analysis.time]\nmesh_frequency_hz = 2000.0\napproach_from_hz = {from}\nmesh_cycles = 4\n");
        scratch.run(name, &format!("{head}{time}[output]\nplots = false\n"))
    };
    let (lower, _) = at("lower", 1500.0);
    let (upper, summary) = at("upper", 2600.0);
    assert!(table(&lower.join("contact_loss.csv"))["state"].is_empty());
    let loss = table(&upper.join("contact_loss.csv"));
    let response = table(&upper.join("response.csv"));
    let (from, to) = (numbers(&loss, "from_mesh_cycle"), numbers(&loss, "to_mesh_cycle"));
    assert!(from.len() >= 4);
    // within a loss the mesh carries the damper's force alone, outside it presses
    let (cycle, force) = (numbers(&response, "mesh_cycle"), numbers(&response, "mesh_force_n"));
    let apart = |t: f64| from.iter().zip(&to).any(|(a, b)| t > *a && t < *b);
    let most = |inside: bool| {
        let chosen = cycle.iter().zip(&force).filter(|(t, _)| apart(**t) == inside);
        chosen.map(|(_, f)| f.abs()).fold(0.0, f64::max)
    };
    assert!(most(true) < 0.3 * most(false), "{} {}", most(true), most(false));
    let total: f64 = from.iter().zip(&to).map(|(a, b)| b - a).sum();
    let told = summary["time_response"][0]["fraction_without_contact"].as_f64().unwrap();
    assert!((total / 4.0 - told).abs() < 1e-6);
}

#[test]
fn free_and_prescribed_input_have_the_natural_frequencies_of_their_moving_mass() {
    let scratch = Scratch::new();
    let tail = CASE.find("[[state]]").unwrap();
    let case = |input: &str, supports: &str| {
        let head = CASE[..tail].replace("\"prescribed\"", input);
        let head = head.replace("[pair.pinion]", &format!("supports = \"{supports}\"\n\n[pair.pinion]"));
        format!("{head}[output]\nplots = false\n")
    };
    let (jp, jg, rp, rg) = (0.0008_f64, 0.0050_f64, 0.03520_f64, 0.04563_f64);
    // Eq. (3.3d), and its limit of an endless pinion inertia
    let masses = [("\"free\"", jp * jg / (rp * rp * jg + rg * rg * jp)), ("\"prescribed\"", jg / (rg * rg))];
    for (input, mass) in masses {
        for supports in ["eliminated", "integrated"] {
            let name = format!("{}-{supports}", input.trim_matches('"'));
            let (_, summary) = scratch.run(&name, &case(input, supports));
            let read = &summary["states"][0]["natural_frequency_hz"];
            for (index, k) in [533e6, 806e6].into_iter().enumerate() {
                let exact = (1.0 / (mass * (1.0 / k + 2e-12))).sqrt() / std::f64::consts::TAU;
                // integrated supports: the masses on them move with the mesh by k / k_support, 0.1 %
                let tolerance = if supports == "eliminated" { 1e-9 } else { 1e-3 };
                let found = read[index].as_f64().unwrap();
                assert!((found / exact - 1.0).abs() < tolerance, "{name}: {found} {exact}");
            }
            assert!((summary["model"]["moving_mass_kg"].as_f64().unwrap() / mass - 1.0).abs() < 1e-12);
        }
    }
}

/// A small plane spur pair.
const SPUR: &str = spur_pair!(
    "",
    r#"
[analysis]
positions_per_cycle = 20
model = "plane-strain"
"#
);

/// A state whose teeth have a spacing error, over the two cycles of that tooth's engagement.
fn spur_with_pitch_error() -> String {
    let error = format!("modification.pitch_errors_um = [{}]\n", {
        let mut list = vec!["0.0"; 25];
        list[0] = "4.0";
        list.join(", ")
    });
    SPUR.replacen("facewidth_mm = 16.0\n\n[gear]", &format!("facewidth_mm = 16.0\n{error}\n[gear]"), 1)
        .replace("[analysis]\n", "[analysis]\nmesh_cycle_from = -1.0\nmesh_cycle_to = 1.0\n")
}

const JOINED: &str = r#"kind = "lumped-pair"
[pair]
input = "free"
mesh_damping_ratio = 0.05
EXTRA
[excitation]
spur_pair = "spur.toml"
[[state]]
name = "pitch error"
mesh_cycle = 12
spur_pair = "damaged.toml"
[analysis.time]
pinion_speed_rpm = 1500.0
[output]
plots = true
"#;

#[test]
fn statics_and_dynamics_are_joined_directly_or_by_tables_with_the_same_result() {
    let scratch = Scratch::new();
    scratch.write("spur.toml", SPUR);
    scratch.write("damaged.toml", &spur_with_pitch_error());
    let (direct, summary) = scratch.run("direct", &JOINED.replace("EXTRA", ""));
    // discs from the geometry: a unity pair, so the moving mass is J / (2 r^2)
    let pinion = &summary["inputs"]["pair"]["pinion"];
    let value = |key: &str| pinion[key].as_f64().unwrap();
    let half = 0.5 * value("inertia_kg_m2") / (value("base_radius_mm") * 1e-3).powi(2);
    assert!((summary["model"]["moving_mass_kg"].as_f64().unwrap() / half - 1.0).abs() < 1e-9);
    assert!((value("base_radius_mm") / (75.0 * 20.0_f64.to_radians().cos()) - 1.0).abs() < 1e-9);
    // a steel ring between 60 mm and about 150 mm diameter, 16 mm wide: 1.85 kg
    assert!((value("mass_kg") / 1.85 - 1.0).abs() < 0.05, "{}", value("mass_kg"));
    assert_eq!(summary["inputs"]["pair"]["gear_torque_n_m"], 200.0);
    assert_eq!(summary["time_response"][0]["mesh_frequency_hz"], 625.0);
    assert!(direct.join("tooth_forces.svg").exists());
    // forces of the pairs sum to the mesh force
    let (teeth, response) = (table(&direct.join("tooth_forces.csv")), table(&direct.join("response.csv")));
    let mut sums: BTreeMap<String, f64> = BTreeMap::new();
    for (key, force) in teeth["state"].iter().zip(&teeth["mesh_cycle"]).zip(numbers(&teeth, "force_n")) {
        *sums.entry(format!("{key:?}")).or_default() += force;
    }
    let force = numbers(&response, "mesh_force_n");
    for (key, f) in response["state"].iter().zip(&response["mesh_cycle"]).zip(&force) {
        let sum = sums.get(&format!("{key:?}")).copied().unwrap_or(0.0);
        assert!((sum - f).abs() < 1e-6 * f.abs().max(1.0), "{key:?}: {sum} {f}");
    }
    // the damage changes the curves in its own cycles alone
    let curves = table(&direct.join("curves.csv"));
    let (healthy, damaged) = (of_state(&curves, "ste_um", "healthy"), of_state(&curves, "ste_um", "pitch error"));
    assert_eq!((healthy.len(), damaged.len()), (100, 2500));
    let change: Vec<f64> = damaged.iter().enumerate().map(|(i, d)| (d - healthy[i % 100]).abs()).collect();
    assert!(change[..1200].iter().chain(&change[1400..]).all(|c| *c < 1e-9));
    assert!(change[1200..1400].iter().any(|c| *c > 0.5));

    // the same through the tables of two runs
    for name in ["spur", "damaged"] {
        assert!(gearwright(scratch.path(), &["run", &format!("{name}.toml"), "--out", name]).status.success());
    }
    let given = |key: &str| format!("{key} = {}\n", value(key));
    let disc = ["teeth", "base_radius_mm", "inertia_kg_m2"].map(given).concat();
    let extra = format!("gear_torque_n_m = 200.0\n[pair.pinion]\n{disc}[pair.gear]\n{disc}");
    let tables = JOINED
        .replace("EXTRA", &extra)
        .replace("spur_pair = \"spur.toml\"", "table.file = \"spur/series.csv\"")
        .replace("spur_pair = \"damaged.toml\"", "table.file = \"damaged/series.csv\"");
    let (by_tables, _) = scratch.run("tables", &tables);
    let other = table(&by_tables.join("response.csv"));
    for (a, b) in numbers(&response, "dte_um").iter().zip(numbers(&other, "dte_um")) {
        // tables hold ten digits
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
    assert_eq!(table(&by_tables.join("tooth_forces.csv"))["state"].len(), teeth["state"].len());
}

#[test]
fn a_fourier_series_and_its_table_swing_alike() {
    let scratch = Scratch::new();
    let series = "[excitation.fourier]\nstiffness_mean_n_per_um = 680.0\nstiffness_cosines_n_per_um = [-120.0]\n\
                  stiffness_sines_n_per_um = [30.0, 15.0]\nste_mean_um = 14.5\nste_cosines_um = [3.0]\n";
    let mut rows = "mesh_cycle,mesh_stiffness_local_n_per_um,ste_um\n".to_owned();
    for i in 0..100 {
        let t = f64::from(i) / 100.0;
        let a = std::f64::consts::TAU * t;
        let k = 680.0 - 120.0 * a.cos() + 30.0 * a.sin() + 15.0 * (2.0 * a).sin();
        rows.push_str(&format!("{},{k:.12},{:.12}\n", t + 3.0, 14.5 + 3.0 * a.cos()));
    }
    scratch.write("points.csv", &rows);
    let head = &CASE[..CASE.find("[excitation.wave]").unwrap()];
    let tail = "[analysis.time]\nmesh_frequency_hz = 1800.0\nmesh_cycles = 2\n[output]\nplots = false\n";
    let from_series = scratch.run("series", &format!("{head}{series}{tail}")).0;
    let points = "[excitation]\ninterpolation = \"spline\"\ntable.file = \"points.csv\"\n";
    let from_table = scratch.run("table", &format!("{head}{points}{tail}")).0;
    let dte = |folder: &Path| numbers(&table(&folder.join("response.csv")), "dte_um");
    for (a, b) in dte(&from_series).iter().zip(dte(&from_table)) {
        // a spline through 100 points a cycle: (2 pi / 100)^4 / 384 of the amplitude, and the tolerance of the run
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

#[test]
fn threads_do_not_change_the_tables() {
    let scratch = Scratch::new();
    scratch.write("case.toml", &CASE.replace("[[state]]", "[output]\nplots = false\n\n[[state]]"));
    let tables = |threads: &str| {
        let output = gearwright(scratch.path(), &["run", "case.toml", "--threads", threads, "--out", threads]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        ["sweep.csv", "response.csv", "branch.csv", "damage_over_speed.csv"]
            .map(|name| std::fs::read(scratch.path().join(threads).join(name)).unwrap())
    };
    assert!(tables("1") == tables("2"));
}

/// Bad input: the file's change, and what the message must name.
#[test]
fn bad_input_is_one_message_with_file_line_key_value_and_remedy() {
    let cases: [(&str, &str, &[&str]); 19] = [
        ("input = \"prescribed\"", "input = \"held\"", &["case.toml:5", "pair.input", "held", "prescribed"]),
        ("input = \"prescribed\"\n", "", &["case.toml:4", "pair.input", "required"]),
        ("gear_torque_n_m = 424.0\n", "", &["pair.gear_torque_n_m", "required"]),
        ("gear_torque_n_m", "gear_torque_lb_in", &["case.toml:6", "gear_torque_lb_in", "gear_torque_n_m"]),
        ("inertia_kg_m2 = 0.0050", "inertia_kg_m2 = -1.0", &["case.toml:21", "pair.gear.inertia_kg_m2", "-1"]),
        ("mesh_damping_n_s_per_m = 3660.0\n", "", &["pair.mesh_damping_n_s_per_m", "mesh_damping_ratio"]),
        (
            "mesh_damping_n_s_per_m = 3660.0",
            "mesh_damping_n_s_per_m = 1.0\nmesh_damping_ratio = 0.1",
            &["case.toml:8", "mesh_damping_ratio", "not both"],
        ),
        ("teeth = 27\n", "", &["pair.pinion.teeth", "damaged states"]),
        ("contact_ratio = 1.64", "contact_ratio = 2.5", &["case.toml:28", "excitation.wave.contact_ratio", "2.5"]),
        (
            "[excitation.wave]",
            "[excitation]\ntable.file = \"none.csv\"\n[excitation.wave]",
            &["case.toml:25", "excitation", "one of"],
        ),
        ("[[state]]", "[state]", &["case.toml:31", "state", "[[state]]"]),
        ("name = \"softer\"", "name = \"healthy\"", &["case.toml:32", "state[1].name", "healthy"]),
        (
            "stiffness_factor = 0.9",
            "stifness_factor = 0.9",
            &["case.toml:34", "state[1].stifness_factor", "did you mean"],
        ),
        ("stiffness_factor = 0.9\n", "", &["case.toml:31", "state[1]", "stiffness_factor"]),
        ("mesh_cycle = 14", "mesh_cycle = 27", &["case.toml:33", "state[1].mesh_cycle", "27", "rotation"]),
        (
            "stiffness_factor = 0.9",
            "table.file = \"nowhere.csv\"",
            &["case.toml:34", "state[1].table.file", "nowhere.csv"],
        ),
        ("to_hz = 2800.0\nstep_hz", "to_hz = 28.0\nstep_hz", &["case.toml:41", "analysis.sweep.to_hz", "1400"]),
        ("mesh_frequency_hz = 1800.0", "", &["analysis.time.mesh_frequency_hz", "pinion_speed_rpm"]),
        ("[excitation.wave]", "[excitation]\nspur_pair = \"case.toml\"\n[excitation.wave]", &["spur_pair", "kind"]),
    ];
    for (from, to, wanted) in cases {
        let scratch = Scratch::new();
        assert!(CASE.contains(from), "{from}");
        scratch.write("case.toml", &CASE.replacen(from, to, 1));
        for command in ["run", "check"] {
            let output = gearwright(scratch.path(), &[command, "case.toml"]);
            let message = text(&output.stderr);
            assert!(!output.status.success(), "{to} was accepted");
            for word in wanted {
                assert!(message.contains(word), "{to:?}: \"{word}\" is missing in: {message}");
            }
            assert!(!message.contains("panicked"), "{message}");
            assert_eq!(std::fs::read_dir(scratch.path()).unwrap().count(), 1, "{to} left something behind");
        }
    }
}

#[test]
fn bad_tables_are_told_with_row_and_column() {
    let good = "mesh_cycle,mesh_stiffness_local_n_per_um,ste_um\n0.0,500,15\n0.25,800,12\n0.5,800,12\n0.75,500,15\n";
    let head = &CASE[..CASE.find("[excitation.wave]").unwrap()];
    for (from, to, wanted) in [
        ("0.5,800,12", "0.5,eight,12", &["row 4", "mesh_stiffness_local_n_per_um", "eight"][..]),
        ("ste_um", "error_um", &["no column \"ste_um\"", "error_um"][..]),
        ("0.25,800", "0.85,800", &["ascend"][..]),
        ("0.75,500,15\n", "0.75,-500,15\n", &["positive"][..]),
        ("0.5,800,12\n0.75,500,15\n", "", &["whole mesh cycles"][..]),
    ] {
        let scratch = Scratch::new();
        scratch.write("points.csv", &good.replacen(from, to, 1));
        scratch.write("case.toml", &format!("{head}[excitation.table]\nfile = \"points.csv\"\n"));
        let message = text(&gearwright(scratch.path(), &["check", "case.toml"]).stderr);
        for word in wanted.iter().chain(&["case.toml:26", "excitation.table.file"]) {
            assert!(message.contains(word), "{to:?}: \"{word}\" is missing in: {message}");
        }
    }
}

#[test]
fn init_check_and_run_work() {
    let scratch = Scratch::new();
    assert!(gearwright(scratch.path(), &["init", "lumped-pair"]).status.success());
    assert!(gearwright(scratch.path(), &["check", "lumped-pair.toml"]).status.success());
    let output = gearwright(scratch.path(), &["run", "lumped-pair.toml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(scratch.path().join("out/lumped-pair/sweep.csv").exists());
    let told = text(&gearwright(scratch.path(), &["explain", "state.stiffness_factor"]).stdout);
    assert!(told.contains("stand-in"), "{told}");
}

#[test]
fn severities_of_a_spur_pair_case_are_states() {
    let scratch = Scratch::new();
    let cracked = SPUR.replace("[analysis]\n", "[analysis]\nmesh_cycle_from = -1.0\nmesh_cycle_to = 1.0\n")
        + "[[damage]]\non = \"pinion\"\ntooth = 0\ncrack.length_percent = [20.0, 50.0]\n";
    // the healthy curves come from the same file, whose two cycles are alike
    scratch.write("spur.toml", &cracked);
    scratch.write("damaged.toml", &cracked);
    let (folder, summary) = scratch.run("cracks", &JOINED.replace("EXTRA", ""));
    let states = summary["states"].as_array().unwrap();
    let names: Vec<&str> = states.iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["healthy", "crack 20 %", "crack 50 %"]);
    assert_eq!(states[0]["period_mesh_cycles"], 1);
    let largest: Vec<f64> = states.iter().map(|s| s["ste_um"]["max"].as_f64().unwrap()).collect();
    assert!(largest[0] < largest[1] && largest[1] < largest[2], "{largest:?}");
    let response = table(&folder.join("response.csv"));
    assert_eq!(response["state"].len(), 3 * 2500);

    let shifted = cracked.replace("[analysis]\n", "[analysis]\nmesh_cycle_origin = 0.75\n");
    scratch.write("damaged.toml", &shifted);
    scratch.write("case.toml", &JOINED.replace("EXTRA", ""));
    let message = text(&gearwright(scratch.path(), &["check", "case.toml"]).stderr);
    for word in ["state[1].spur_pair", "mesh_cycle_origin", "0.75"] {
        assert!(message.contains(word), "\"{word}\" is missing in: {message}");
    }
}
