//! The determinism gate: every output of every kind of case, byte for byte the same with 1, 2 and 7 threads, and after an interruption.
//!
//! Wall times are the only numbers that may differ; they are taken out of `summary.json`, and with it out of the manifest.

#[macro_use]
mod common;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{Scratch, gearwright, text};
use fecm::statics::Observer;
use gearwright::run::RunObserver;
use gearwright_store::Digest;
use serde_json::Value;

/// Cracked in two severities, a force-deflection map, and grids for ParaView; 3-D, few cells.
const SPUR: &str = spur_pair!(
    "title = \"gate\"\n",
    r#"
[analysis]
positions_per_cycle = 5
model = "plane-strain"

[[damage]]
on = "pinion"
tooth = 0
crack.length_percent = [30.0, 60.0]
"#
);

const LUMPED: &str = r#"kind = "lumped-pair"
[pair]
input = "prescribed"
gear_torque_n_m = 424.0
mesh_damping_n_s_per_m = 3660.0
[pair.pinion]
teeth = 27
base_radius_mm = 35.20
mass_kg = 0.7294
inertia_kg_m2 = 0.0008
support_stiffness_n_per_m = 1e9
[pair.gear]
base_radius_mm = 45.63
mass_kg = 0.8537
inertia_kg_m2 = 0.0050
support_stiffness_n_per_m = 1e9
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
mesh_frequency_hz = 700.0
[analysis.sweep]
from_hz = 600.0
to_hz = 800.0
step_hz = 50.0
"#;

const DYNAMICS: &str = r#"kind = "dynamics"
[pair]
spur_pair = "spur.toml"
severities = [1]
input = "prescribed"
[gear]
elastic_modes = 3
[damping]
mass_proportional_per_s = 3000.0
modal_ratio = 0.02
[run]
speed_rpm = 3000.0
steps_per_mesh_cycle = 20
mesh_cycles = 3
[checkpoint]
every_steps = 13
[output]
film.mesh_cycle_from = 0.5
film.mesh_cycle_to = 0.7
"#;

const TRANSMISSION: &str = r#"kind = "transmission"
[mesh]
module_mm = 2.8677419354838712
pressure_angle_deg = 24.6
centre_distance_mm = 88.9
[train]
planets = 3
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
radial_stiffness_n_per_m = 3e8
axial_stiffness_n_per_m = 2e8
tilt_stiffness_n_m_per_rad = 1e6
[[bearing]]
on = "carrier"
radial_stiffness_n_per_m = 4e8
axial_stiffness_n_per_m = 4e8
tilt_stiffness_n_m_per_rad = 1e6
[[damage]]
on = "ring"
angle_deg = 90.0
crack.length_percent = 60.0
[run]
speed_rpm = 1621.7
torque_n_m = 6106.0
carrier_turns = 1
[analysis]
table_positions = 16
[numerics]
steps_per_sample = 1
[signals]
band_hz = 2150.0
[contact]
element_order = 2
mesh_density = 0.6
cells_per_half_width = 4.0
"#;

const RECORDING: &str = r#"kind = "recording"
[signal]
file = "runs"
rate_hz = 2000.0
[tachometer]
channel = "tacho"
[gear]
teeth = 19
[thresholds]
healthy_first = 3
"#;

/// Two channels of harmonics, a knock and scatter from a linear congruential generator, one pulse a turn.
fn recording(seed: u32) -> String {
    let mut state = seed;
    let mut text = String::from("case,tail,tacho\n");
    for sample in 0..4000 {
        let turn = f64::from(sample) / 2000.0 * 10.0;
        let mesh = (std::f64::consts::TAU * 19.0 * turn).sin();
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = f64::from(state >> 8) / f64::from(1 << 24) - 0.5;
        let knock = f64::from(seed) * (-40.0 * turn.fract()).exp();
        let pulse = u8::from(turn.fract() < 0.1);
        text.push_str(&format!("{:.6},{:.6},{pulse}\n", mesh + noise + knock, 0.3 * mesh - noise));
    }
    text
}

/// Keys out of a summary: wall times, and what else does not describe results.
fn without(value: &mut Value, keys: &[&str]) {
    match value {
        Value::Object(map) => {
            map.retain(|key, _| !keys.contains(&key.as_str()));
            map.values_mut().for_each(|value| without(value, keys));
        }
        Value::Array(items) => items.iter_mut().for_each(|value| without(value, keys)),
        _ => {}
    }
}

/// Wall times, and the number of threads.
const TIMES: [&str; 2] = ["time_s", "threads"];
/// Wall times, and counters of a solver that starts anew after an interruption: without a contact to start from it takes more pivots to the same
/// solution.
const WORK: [&str; 3] = ["time_s", "pivots", "factorisations"];

/// Hashes of all files of a results folder, `left_out` of its summary taken out.
fn hashes(folder: &Path, left_out: &[&str]) -> BTreeMap<String, Digest> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            all.extend(hashes(&path, left_out).into_iter().map(|(inner, digest)| (format!("{name}/{inner}"), digest)));
        } else if name == "summary.json" {
            let mut summary: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
            without(&mut summary, left_out);
            all.insert(name, Digest::of_value(&summary).unwrap());
        } else if name != "manifest.sha256" {
            all.insert(name, Digest::of(&std::fs::read(&path).unwrap()));
        }
    }
    all
}

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    for (name, content) in [
        ("spur.toml", SPUR),
        ("lumped.toml", LUMPED),
        ("dynamics.toml", DYNAMICS),
        ("transmission.toml", TRANSMISSION),
        ("recording.toml", RECORDING),
    ] {
        scratch.write(name, content);
    }
    (1..=5).for_each(|day| drop(scratch.write(&format!("runs/day{day}.csv"), &recording(day))));
    scratch
}

fn assert_same(kind: &str, about: &str, expected: &BTreeMap<String, Digest>, found: &BTreeMap<String, Digest>) {
    let names = |all: &BTreeMap<String, Digest>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(expected), names(found), "{kind}, {about}");
    let different: Vec<_> = expected.iter().filter(|(name, digest)| found[*name] != **digest).map(|(n, _)| n).collect();
    assert!(different.is_empty(), "{kind}, {about}: {different:?} differ");
}

#[test]
fn every_output_of_every_kind_is_the_same_at_any_number_of_threads() {
    let scratch = scratch();
    let mut files = 0;
    for kind in ["spur", "lumped", "dynamics", "transmission", "recording"] {
        let mut expected = None;
        for threads in ["1", "2", "7"] {
            let target = format!("{kind}-{threads}");
            // each computes its own mesh tables
            let _ = std::fs::remove_dir_all(scratch.path().join(".gearwright-cache"));
            let arguments = ["run", &format!("{kind}.toml"), "--out", &target, "--threads", threads];
            let output = gearwright(scratch.path(), &arguments);
            assert!(output.status.success(), "{kind}: {}", text(&output.stderr));
            let found = hashes(&scratch.path().join(&target), &TIMES);
            files += found.len();
            assert!(found.len() > 4, "{kind}: {found:?}");
            assert_same(kind, &format!("{threads} threads"), expected.get_or_insert_with(|| found.clone()), &found);
        }
    }
    println!("reliability: {files} result files compared over 1, 2 and 7 threads, 0 different");
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

#[test]
fn every_output_is_the_same_after_interruptions() {
    let scratch = scratch();
    for kind in ["dynamics", "lumped", "spur"] {
        let case = gearwright_case::load(&scratch.path().join(format!("{kind}.toml"))).unwrap();
        let (whole, pieces) = (scratch.path().join("whole"), scratch.path().join("pieces"));
        gearwright::run::run(&case, &whole, &()).unwrap();
        for steps in [1, 17, 50] {
            assert!(gearwright::run::run(&case, &pieces, &StopAfter(AtomicUsize::new(steps))).is_err() || steps > 1);
        }
        gearwright::run::run(&case, &pieces, &()).unwrap();
        // identifiers in SVG files are numbered through the process, and both runs are in this one
        let of = |folder: &Path| {
            let mut all = hashes(folder, &WORK);
            all.retain(|name, _| !name.ends_with(".svg"));
            all
        };
        assert_same(kind, "interrupted", &of(&whole), &of(&pieces));
    }
}
