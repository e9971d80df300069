//! Transmission cases as a user meets them: everything promised is written and hangs together, results do not depend on threads or on what was kept,
//! bad input is told.

mod common;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use common::{Scratch, gearwright, text};
use serde_json::Value;

/// The dissertation's planetary stage in a coarse housing, ten samples and ten steps a mesh cycle; a crack on the ring tooth at 90 degrees.
const CASE: &str = r#"kind = "transmission"
title = "small"

[mesh]
module_mm = 2.8677419354838712
pressure_angle_deg = 24.6
centre_distance_mm = 88.9

[train]
planets = 3
ring_tooth_deg = 90.0

[sun]
teeth = 27
tooth_thickness_mm = 4.52
tip_diameter_mm = 84.05
root_diameter_mm = 70.76
bore_diameter_mm = 62.23
facewidth_mm = 34.93
fillet.radius_mm = 0.86

[planet]
teeth = 35
tooth_thickness_mm = 4.18
tip_diameter_mm = 104.98
root_diameter_mm = 91.54
bore_diameter_mm = 77.9
facewidth_mm = 31.75
fillet.radius_mm = 0.55

[ring]
teeth = 99
tooth_thickness_mm = 6.92
tip_diameter_mm = 271.75
root_diameter_mm = 284.2
bore_diameter_mm = 296.55
facewidth_mm = 25.4
fillet.shape = "circular"
fillet.radius_mm = 0.5

[[bearing]]
on = "planet"
radial_stiffness_n_per_m = 3e8
axial_stiffness_n_per_m = 1e8
tilt_stiffness_n_m_per_rad = 1e5

[[bearing]]
on = "sun"
port = "shaft_upper"
place_mm = -122.0
radial_stiffness_n_per_m = 3e8
axial_stiffness_n_per_m = 2e8
tilt_stiffness_n_m_per_rad = 1e6

[[bearing]]
on = "carrier"
port = "mast_lower"
place_mm = 102.0
radial_stiffness_n_per_m = 4e8
axial_stiffness_n_per_m = 4e8
tilt_stiffness_n_m_per_rad = 1e6

[housing]
element_size_mm = 60.0
seat_harmonics = 6
highest_frequency_hz = 2000.0

[[sensor]]
name = "At tooth"
angle_deg = 90.0

[around]
count = 8
leave_out_deg = [170.0, 190.0]

[[damage]]
on = "ring"
angle_deg = 90.0
crack.length_percent = 60.0

[run]
speed_rpm = 1621.7
torque_n_m = 6106.0
carrier_turns = 1

[contact]
element_order = 2
mesh_density = 0.6
cells_per_half_width = 4.0

[analysis]
table_positions = 16

[numerics]
steps_per_sample = 1

[signals]
band_hz = 2150.0
sideband_pairs = 2
"#;

impl Scratch {
    /// Runs a case text into a folder of its name; the folder and its summary.
    fn run_with(&self, name: &str, content: &str, arguments: &[&str]) -> (PathBuf, Value) {
        self.write(&format!("{name}.toml"), content);
        let (file, out) = (format!("{name}.toml"), format!("out/{name}"));
        let output = gearwright(self.path(), &[&["run", &file, "--out", &out], arguments].concat());
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
        let screen = text(&output.stdout);
        assert!(screen.lines().count() < 30, "more than one screen: {screen}");
        let folder = self.path().join(out);
        let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
        (folder, serde_json::from_str(&summary).unwrap())
    }
}

fn column(file: &Path, name: &str) -> Vec<f64> {
    let mut table = csv::Reader::from_path(file).unwrap();
    let index = table.headers().unwrap().iter().position(|header| header == name);
    let index = index.unwrap_or_else(|| panic!("{name} in {}", file.display()));
    let values: Vec<f64> = table.records().map(|record| record.unwrap()[index].parse().unwrap()).collect();
    assert!(values.iter().all(|v| v.is_finite()), "{name}");
    values
}

/// All tables of a folder by name.
fn tables(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files
        .filter(|file| file.extension().is_some_and(|e| e == "csv"))
        .map(|file| (file.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&file).unwrap()))
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn run_writes_everything_it_promises_and_it_hangs_together() {
    let scratch = Scratch::new();
    let (folder, summary) = scratch.run_with("small", CASE, &[]);
    for name in [
        "acceleration",
        "acceleration_damage_1",
        "spectrum",
        "difference_damage_1",
        "difference_spectrum_damage_1",
        "average_planet_pass_damage_1",
        "average_carrier",
        "meshes",
        "load_sharing",
        "bearings",
        "natural_frequencies",
        "housing_frequencies",
        "indicators",
    ] {
        assert!(folder.join(format!("{name}.csv")).metadata().unwrap().len() > 200, "{name}");
    }
    for name in ["acceleration", "exact_difference_planet_pass", "polar_fm4_planet_pass_damage_1", "mesh_forces"] {
        for kind in ["svg", "png"] {
            assert!(folder.join(format!("{name}.{kind}")).metadata().unwrap().len() > 1000, "{name}.{kind}");
        }
    }
    // a turn of the carrier from its start, ten samples a cycle: 2.56 in a period of the band, rounded up
    let turns = column(&folder.join("acceleration.csv"), "carrier_turn");
    assert_eq!((turns.len(), turns[0]), (990, 0.0));
    // mean force from the torque: T_c Z_s / (Z_s + Z_r) / (3 r_bs), the same at sun and ring
    let base = 0.5 * 27.0 * 2.867_741_935e-3 * 24.6_f64.to_radians().cos();
    let expected = 6106.0 * 27.0 / 126.0 / 3.0 / base;
    for mesh in ["sun_planet_1", "ring_planet_1", "sun_planet_3"] {
        let force = mean(&column(&folder.join("meshes.csv"), &format!("{mesh}_force_n")));
        assert!((force / expected - 1.0).abs() < 0.01, "{mesh}: {force} {expected}");
    }
    let shares = column(&folder.join("load_sharing.csv"), "share_of_mean");
    assert!(shares.iter().all(|share| (share - 1.0 / 3.0).abs() < 0.03), "{shares:?}");
    // the damaged signal is the healthy one and the difference
    let of = |name: &str| column(&folder.join(format!("{name}.csv")), "at_tooth_g");
    let (healthy, damaged, difference) = (of("acceleration"), of("acceleration_damage_1"), of("difference_damage_1"));
    for k in 0..healthy.len() {
        assert!((damaged[k] - healthy[k] - difference[k]).abs() < 1e-6 * (1.0 + damaged[k].abs()));
    }
    assert!(difference.iter().any(|d| d.abs() > 0.0));
    // seven places around and one of its own, all judged; the approximate signal loses the mesh
    assert_eq!(summary["states"].as_array().unwrap().len(), 2);
    let indicators = std::fs::read_to_string(folder.join("indicators.csv")).unwrap();
    assert_eq!(indicators.lines().filter(|line| line.contains(",none,raw,rms,")).count(), 2 * 8);
    assert!(indicators.contains("planet_pass,difference_2,fm4"));
    assert!(!indicators.contains("180.00 deg"));
    let fm4 = summary["states"][1]["sensors"][0]["fm4"][0]["exact"].as_f64().unwrap();
    assert!(fm4 > 3.0, "{fm4}");
    // what steps and transient leave is measured
    for what in ["left_by_steps", "left_by_transient"] {
        for of in ["acceleration", "mesh_force"] {
            let left = summary["resolution"][what][of].as_f64().unwrap();
            assert!(left > 0.0 && left < 0.5, "{what} {of}: {left}");
        }
    }
    // nothing above half the sample rate, nothing but the transition of the filter above the band
    let (frequencies, lines) =
        (column(&folder.join("spectrum.csv"), "frequency_hz"), column(&folder.join("spectrum.csv"), "at_tooth_g"));
    assert!((frequencies.last().unwrap() - 5.0 * 573.39).abs() < 10.0);
    let greatest =
        |from: f64| frequencies.iter().zip(&lines).filter(|(f, _)| **f > from).map(|(_, a)| *a).fold(0.0, f64::max);
    assert!(greatest(2800.0) < 1e-2 * greatest(100.0));
    // speeds of the dissertation
    assert!((summary["train"]["mesh_frequency_hz"].as_f64().unwrap() - 573.4).abs() < 0.1);
}

#[test]
fn tables_do_not_depend_on_threads_or_on_what_was_kept() {
    let scratch = Scratch::new();
    let (first, _) = scratch.run_with("one", CASE, &["--threads", "1"]);
    let before = tables(&first);
    assert!(scratch.path().join("out/.gearwright-cache").is_dir());
    let (again, _) = scratch.run_with("two", CASE, &["--threads", "3"]);
    assert!(tables(&again) == before, "kept tables change nothing");
    std::fs::remove_dir_all(scratch.path().join("out/.gearwright-cache")).unwrap();
    let (third, _) =
        scratch.run_with("three", &format!("{CASE}\n[output]\nplots = false\ncache = false\n"), &["--threads", "3"]);
    assert!(tables(&third) == before, "threads change nothing");
    assert!(!scratch.path().join("out/.gearwright-cache").exists());
}

#[test]
fn faults_are_told_together_with_their_lines() {
    let scratch = Scratch::new();
    let told = |name: &str, content: &str| {
        scratch.write(&format!("{name}.toml"), content);
        let output = gearwright(scratch.path(), &["check", &format!("{name}.toml")]);
        assert!(!output.status.success(), "{name}");
        text(&output.stderr)
    };
    let several = CASE
        .replace("port = \"mast_lower\"", "port = \"mast\"")
        .replace("angle_deg = 90.0\ncrack", "tooth = 99\ncrack")
        .replace("leave_out_deg = [170.0, 190.0]", "leave_out_deg = [170.0]");
    let message = told("several", &several);
    for part in
        ["bearing[3].port", "mast_lower", "damage[1].tooth", "teeth 0 to 98", "around.leave_out_deg", "pairs of angles"]
    {
        assert!(message.contains(part), "{part}: {message}");
    }
    let message = told("five", &CASE.replace("planets = 3", "planets = 5"));
    assert!(message.contains("train.planets") && message.contains("does not fit between"), "{message}");
    let floating = CASE.replace("on = \"carrier\"\nport = \"mast_lower\"", "on = \"sun\"\nport = \"mast_lower\"");
    let message = told("floating", &floating);
    assert!(message.contains("carrier: no bearing carries it"), "{message}");
    let message = told(
        "grounded",
        &CASE.replace("[housing]\nelement_size_mm = 60.0\nseat_harmonics = 6\nhighest_frequency_hz = 2000.0\n", ""),
    );
    assert!(message.contains("there is no [housing]") && message.contains("sensors sit on a housing"), "{message}");
}
