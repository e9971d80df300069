//! `gearwright hums` as a user meets it, on recordings made here: what it finds, what it says of bad input, what it leaves behind.

mod common;

use common::{Scratch, gearwright, text};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::Command;

use hums::difference::RemovalRule;
use hums::indicator::GearAnalyzer;
use hums::resample::samples_per_period;
use hums::tachometer::{PulseOptions, Shaft};
use hums::tsa::{TsaOptions, average, comb_gain};

const RATE: f64 = 5120.0;
const SPEED: f64 = 10.0;
const TEETH: f64 = 27.0;

fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = gearwright(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Numbers from -0.5 to 0.5, their sums nearly Gaussian.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let uniform = (0..12).map(|_| {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        });
        uniform.sum::<f64>() - 6.0
    }
}

/// Amplitudes of what a recording holds besides its mesh.
#[derive(Clone, Copy, Default)]
struct Holds {
    /// Ringing as one tooth passes.
    knock: f64,
    /// Tone of 40 cycles a turn.
    tone: f64,
    /// Tone of 33.37 cycles a turn: another shaft's.
    foreign: f64,
    /// RMS of noise.
    noise: f64,
}

/// Vibration and tachometer (a trapezoid a turn, its flank on the sampling grid's times).
fn recording(samples: usize, holds: Holds, seed: u64) -> [Vec<f64>; 2] {
    let mut noise = Noise(seed);
    let sample = |i: usize| {
        let turn = i as f64 / RATE * SPEED;
        let since = (turn - 0.4).rem_euclid(1.0) / SPEED;
        holds.knock * (-200.0 * since).exp() * (TAU * 700.0 * since).sin()
            + (TEETH * TAU * turn).sin()
            + 0.3 * (2.0 * TEETH * TAU * turn).sin()
            + holds.tone * (40.0 * TAU * turn).cos()
            + holds.foreign * (33.37 * TAU * turn).cos()
            + holds.noise * noise.next()
    };
    let vibration: Vec<f64> = (0..samples).map(sample).collect();
    // Rises within 8 samples about each turn.
    let pulse = |i: usize| {
        let turn = (i as f64 / RATE * SPEED + 0.5).rem_euclid(1.0) - 0.5;
        let place = turn / SPEED * RATE;
        if place < 20.0 { (place / 8.0 + 0.5).clamp(0.0, 1.0) } else { 0.0 }
    };
    [vibration, (0..samples).map(pulse).collect()]
}

fn csv_text(header: &str, columns: &[&[f64]]) -> String {
    let mut text = format!("{header}\n");
    for i in 0..columns[0].len() {
        let row: Vec<String> = columns.iter().map(|column| column[i].to_string()).collect();
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}

impl Scratch {
    fn record(&self, name: &str, samples: usize, holds: Holds, seed: u64) -> [Vec<f64>; 2] {
        let [x, tacho] = recording(samples, holds, seed);
        self.write(name, &csv_text("case,tacho", &[&x, &tacho]));
        [x, tacho]
    }
}

/// Rows of a table by column name.
fn table(path: &Path) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(path).unwrap().deserialize().map(|row| row.unwrap()).collect()
}

fn row<'a>(rows: &'a [BTreeMap<String, String>], indicator: &str, signal: &str) -> &'a BTreeMap<String, String> {
    rows.iter().find(|row| row["indicator"] == indicator && row["signal"] == signal).unwrap()
}

/// Amplitude of a column of averages.csv at an order.
fn amplitude(rows: &[BTreeMap<String, String>], column: &str, order: f64) -> f64 {
    let values: Vec<f64> = rows.iter().map(|row| row[column].parse().unwrap()).collect();
    let n = values.len() as f64;
    let part = |wave: fn(f64) -> f64| {
        values.iter().enumerate().map(|(k, x)| x * wave(TAU * order * k as f64 / n)).sum::<f64>() * 2.0 / n
    };
    part(f64::cos).hypot(part(f64::sin))
}

#[test]
fn analytic_average_keeps_the_fault_tone_and_removes_the_foreign_one() {
    let scratch = Scratch::new();
    let holds = Holds { tone: 0.2, foreign: 0.5, ..Holds::default() };
    // 60 turns and a bit: the first begins with the first pulse, which the record cuts in half.
    scratch.record("rec.csv", 31_000, holds, 1);
    let arguments = ["hums", "--signal", "rec.csv", "--rate-hz", "5120", "--teeth", "27", "--tach", "tacho"];
    let screen = succeed(scratch.path(), &arguments);
    assert!(screen.contains("results in out/rec") && screen.lines().count() < 25, "{screen}");
    let out = scratch.path().join("out/rec");
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    let periods = summary["channels"]["case"]["average"]["periods"].as_u64().unwrap() as usize;
    assert_eq!(periods, 59);
    let rows = table(&out.join("averages.csv"));
    // The foreign tone's leakage into order 40, and no more: the comb filter's gain at order 33.37.
    let left = 0.5 * comb_gain(33.37, periods);
    assert!(left < 0.02);
    for column in ["case tsa", "case residual", "case difference"] {
        let found = amplitude(&rows, column, 40.0);
        assert!((found - 0.2).abs() < left, "{column}: {found}");
    }
    assert!((amplitude(&rows, "case tsa", 27.0) - 1.0).abs() < left);
    assert!(amplitude(&rows, "case residual", 27.0) < 1e-9, "mesh harmonics leave the residual");
    for name in ["signal", "order_spectrum", "difference"] {
        let svg = std::fs::read_to_string(out.join(format!("{name}.svg"))).unwrap();
        assert!(svg.contains("<svg") && !svg.contains("NaN"), "{name}.svg");
        assert_eq!(&std::fs::read(out.join(format!("{name}.png"))).unwrap()[1..4], b"PNG", "{name}.png");
    }
}

#[test]
fn analytic_table_is_the_librarys() {
    let scratch = Scratch::new();
    let holds = Holds { knock: 0.5, noise: 0.1, ..Holds::default() };
    let [x, tacho] = scratch.record("rec.csv", 20_480, holds, 2);
    succeed(
        scratch.path(),
        &["hums", "--signal", "rec.csv", "--channel", "1", "--rate-hz", "5120", "--teeth", "27", "--tach", "2"],
    );
    let (shaft, _) = Shaft::from_channel(&tacho, RATE, 1.0, &PulseOptions::default()).unwrap();
    let samples = samples_per_period(RATE, &shaft, 1.0).unwrap();
    let average = average(&x, RATE, &shaft, &TsaOptions::per_turn(samples)).unwrap();
    let analyzer = GearAnalyzer::new(samples, &RemovalRule::shaft_and_mesh(27)).unwrap();
    let rows = table(&scratch.path().join("out/rec/indicators.csv"));
    let analysis = analyzer.analyze(&average.samples).unwrap();
    assert!(analysis.table.len() > 20);
    for entry in &analysis.table {
        let row = row(&rows, entry.indicator.name(), entry.signal.name());
        match &entry.value {
            // Twelve decimals are written.
            Ok(value) => {
                let written: f64 = row["value"].parse().unwrap();
                assert!(
                    (written - value).abs() <= 1e-12 * value.abs(),
                    "{}: {written} {value}",
                    entry.indicator.name()
                );
            }
            Err(reason) => assert_eq!(row["reason"], reason.to_string()),
        }
    }
    let rms = hums::indicator::basic::rms(&x).unwrap();
    assert!((row(&rows, "rms", "raw")["value"].parse::<f64>().unwrap() / rms - 1.0).abs() < 1e-11);
    assert_eq!(row(&rows, "fm4", "difference")["verdict"], "alarm", "a knock is not Gaussian");
}

#[test]
fn healthy_noise_raises_no_alarm_and_a_case_file_says_what_flags_say() {
    let scratch = Scratch::new();
    scratch.record("rec.csv", 20_480, Holds { noise: 0.2, ..Holds::default() }, 3);
    let flags = ["hums", "--signal", "rec.csv", "--rate-hz", "5120", "--teeth", "27", "--tach", "tacho", "--no-plots"];
    let screen = succeed(scratch.path(), &[&flags[..], &["--out", "a", "--threads", "1"]].concat());
    assert!(!screen.contains("outside limits") && screen.contains("  ok (4 of "), "{screen}");
    let case = "kind = \"recording\"\noutput.plots = false\ngear.teeth = 27\n\n[signal]\nfile = \"rec.csv\"\n\
                rate_hz = 5120.0\n\n[tachometer]\nchannel = \"tacho\"\n";
    scratch.write("case.toml", case);
    succeed(scratch.path(), &["hums", "case.toml", "--out", "b"]);
    succeed(scratch.path(), &["run", "case.toml", "--out", "c", "--threads", "2"]);
    for name in ["indicators.csv", "averages.csv"] {
        let read = |folder: &str| std::fs::read(scratch.path().join(folder).join(name)).unwrap();
        assert!(read("a") == read("b") && read("b") == read("c"), "{name}");
    }
    let rows = table(&scratch.path().join("a/indicators.csv"));
    let fm4 = row(&rows, "fm4", "difference");
    assert_eq!((fm4["verdict"].as_str(), fm4["gaussian_value"].parse::<f64>().unwrap()), ("ok", 3.0));
    assert!(!scratch.path().join("a/signal.svg").exists());
}

#[test]
fn wav_states_its_rate_and_a_file_or_a_speed_stands_for_the_tachometer() {
    let scratch = Scratch::new();
    let [x, tacho] = recording(20_480, Holds { knock: 0.5, noise: 0.05, ..Holds::default() }, 4);
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 5120,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut wav = hound::WavWriter::create(scratch.path().join("rec.wav"), spec).unwrap();
    for (x, t) in x.iter().zip(&tacho) {
        wav.write_sample(*x as f32).unwrap();
        wav.write_sample(*t as f32).unwrap();
    }
    wav.finalize().unwrap();
    let times: String = (0..41).map(|k| format!("{}\n", f64::from(k) / SPEED)).collect();
    scratch.write("pulses.txt", &times);
    let mut found = Vec::new();
    let ways: [&[&str]; 4] = [
        &["--tach", "channel 2"],
        &["--tach", "pulses.txt"],
        &["--speed-hz", "10"],
        // A shaft of 30 Hz whose 27 teeth drive the 81 of ours.
        &["--speed-hz", "30", "--gear-ratio", "27/81"],
    ];
    for (index, way) in ways.iter().enumerate() {
        let out = index.to_string();
        let base =
            ["hums", "--signal", "rec.wav", "--channel", "channel 1", "--teeth", "27", "--no-plots", "--out", &out];
        succeed(scratch.path(), &[&base[..], way].concat());
        let rows = table(&scratch.path().join(&out).join("indicators.csv"));
        found.push(row(&rows, "fm4", "difference")["value"].parse::<f64>().unwrap());
    }
    assert!(found[0] > 6.0, "{found:?}");
    for value in &found {
        // The ways differ by whether the first turn counts.
        assert!((value / found[0] - 1.0).abs() < 0.05, "{found:?}");
    }
    // Exact pulse times are a constant speed.
    assert!((found[1] / found[2] - 1.0).abs() < 1e-6, "{found:?}");
}

#[test]
fn planet_passes_and_several_turns() {
    let scratch = Scratch::new();
    scratch.record("rec.csv", 40_960, Holds { noise: 0.1, ..Holds::default() }, 5);
    let base = ["hums", "--signal", "rec.csv", "--rate-hz", "5120", "--tach", "tacho", "--no-plots", "--teeth", "27"];
    let periods = |more: &[&str]| {
        succeed(scratch.path(), &[&base[..], more].concat());
        let summary = std::fs::read_to_string(scratch.path().join("out/rec/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        (summary["mesh_order"].as_u64().unwrap(), summary["channels"]["case"]["average"]["periods"].as_u64().unwrap())
    };
    assert_eq!(periods(&[]), (27, 78));
    assert_eq!(periods(&["--per-turn", "3"]), (9, 3 * 78));
    assert_eq!(periods(&["--turns", "3"]), (81, 26));
    let output = gearwright(scratch.path(), &[&base[..], &["--per-turn", "2"]].concat());
    let message = text(&output.stderr);
    assert!(!output.status.success() && message.contains("13.5 mesh cycles"), "{message}");
}

#[test]
fn trend_raises_alarms_after_the_healthy_ones_and_tells_what_it_cannot_use() {
    let scratch = Scratch::new();
    for k in 0..12_u32 {
        let knock = f64::from(k.saturating_sub(7)) * 0.15;
        let holds = Holds { knock, noise: 0.1, ..Holds::default() };
        scratch.record(&format!("runs/day{k:02}.csv"), 12_000, holds, 10 + u64::from(k));
    }
    scratch.write("runs/day05b.csv", "case,tacho\n1.0,0\n2.0,1\n");
    scratch.write("runs/notes.pdf", "not a recording");
    let flags = ["hums", "--signal", "runs", "--rate-hz", "5120", "--teeth", "27", "--tach", "tacho"];
    let arguments = [&flags[..], &["--healthy-first", "6", "--sigmas", "3"]].concat();
    let output = gearwright(scratch.path(), &arguments);
    let (screen, warning) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.code() == Some(3) && warning.contains("1 of 13 recordings"), "{warning}");
    assert!(screen.contains("13 recordings, 1 of them unusable") && screen.contains("alarms:"), "{screen}");
    assert!(screen.lines().count() < 25, "{screen}");
    let out = scratch.path().join("out/runs");
    let trend = table(&out.join("trend.csv"));
    let fm4: Vec<_> = trend.iter().filter(|r| r["indicator"] == "fm4").collect();
    assert_eq!(fm4.len(), 12);
    assert!(fm4[..6].iter().all(|r| r["verdict"] == "ok"), "3 sigma of 6 is above all of them");
    assert!(fm4[10..].iter().all(|r| r["verdict"] == "alarm"));
    let unusable: Vec<_> = trend.iter().filter(|r| r["file"] == "day05b.csv").collect();
    assert!(unusable.len() == 1 && unusable[0]["reason"].contains("tachometer"), "{unusable:?}");
    let alarms = table(&out.join("alarms.csv"));
    let alarm = row(&alarms, "fm4", "difference");
    assert!(alarm["raised_by"].as_str() > "day07.csv" && alarm["cleared_at"].is_empty(), "{alarm:?}");
    // A memory of healthy variances lets NA4 rise with the damage, where one record's kurtosis levels off.
    let na4 = |name: &str| {
        let rows: Vec<_> = trend.iter().filter(|r| r["indicator"] == name).collect();
        rows.last().unwrap()["value"].parse::<f64>().unwrap()
    };
    assert!(na4("na4_running") > na4("na4"));
    assert!(out.join("trend_fm4_difference.svg").exists() && out.join("averages.csv").exists());

    // Limits of a folder, with their rate of false alarms.
    let healthy = scratch.path().join("healthy");
    std::fs::create_dir(&healthy).unwrap();
    for k in 0..6 {
        let name = format!("day{k:02}.csv");
        std::fs::copy(scratch.path().join("runs").join(&name), healthy.join(&name)).unwrap();
    }
    let judge = [
        "hums",
        "--signal",
        "runs/day11.csv",
        "--rate-hz",
        "5120",
        "--teeth",
        "27",
        "--tach",
        "tacho",
        "--healthy",
        "healthy",
        "--quantile",
        "0.5",
        "--no-plots",
    ];
    succeed(scratch.path(), &judge);
    let rows = table(&scratch.path().join("out/day11/indicators.csv"));
    let fm4 = row(&rows, "fm4", "difference");
    let held_out: f64 = fm4["false_alarm_rate"].parse().unwrap();
    assert!(held_out >= 0.5, "the middle half of five others leaves out half of the sixth at least: {held_out}");
    assert_eq!(fm4["verdict"], "alarm");
}

/// Detection and polar maps: rates, areas and severities against the numbers they are made of.
#[test]
fn detection_counts_what_is_above_the_threshold() {
    let scratch = Scratch::new();
    let quiet = Holds { noise: 0.1, ..Holds::default() };
    let mut severities = String::from("recording,severity\n");
    for k in 0..6_u64 {
        scratch.record(&format!("healthy/{k}.csv"), 12_000, quiet, 100 + k);
        // Three without damage, three with a good deal of it.
        let knock = if k < 3 { 0.0 } else { 0.5 };
        scratch.record(&format!("damaged/{k}.csv"), 12_000, Holds { knock, ..quiet }, 200 + k);
        severities.push_str(&format!("{k},{}\n", 100.0 * knock));
    }
    scratch.write("severities.csv", &severities);
    let base =
        ["hums", "--signal", "damaged", "--rate-hz", "5120", "--teeth", "27", "--tach", "tacho", "--angles-deg", "30"];
    let sets = ["--healthy", "healthy", "--damaged", "damaged", "--severities", "severities.csv"];
    let screen = succeed(scratch.path(), &[&base[..], &sets, &["--sigmas", "6"]].concat());
    assert!(screen.contains("6 damaged against 6 healthy"), "{screen}");
    let out = scratch.path().join("out/damaged");
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    let rates = table(&out.join("detection.csv"));
    let fm4 = row(&rates, "fm4", "difference");
    // Six standard deviations: no false alarm of six, no detection of the undamaged, detection of the damaged.
    assert_eq!((number(fm4, "false_alarm_rate"), number(fm4, "detection_rate")), (0.0, 0.5), "{fm4:?}");
    assert!(number(fm4, "detection_rate_low") < 0.2 && number(fm4, "detection_rate_high") > 0.8);
    // The damaged half separates fully, the rest as it falls: between 1/2 and 1.
    assert!((0.5..=1.0).contains(&number(fm4, "area_under_roc")) && number(fm4, "best_detection_rate") >= 0.5);
    let values = |folder: &str| -> Vec<f64> {
        let case = format!("{folder}-alone");
        let flags = ["hums", "--signal", folder, "--rate-hz", "5120", "--teeth", "27", "--tach", "tacho", "--no-plots"];
        succeed(scratch.path(), &[&flags[..], &["--out", &case]].concat());
        let rows = table(&scratch.path().join(case).join("trend.csv"));
        rows.iter().filter(|r| r["indicator"] == "fm4").map(|r| r["value"].parse().unwrap()).collect()
    };
    let (healthy, damaged) = (values("healthy"), values("damaged"));
    let wins = damaged.iter().flat_map(|d| healthy.iter().map(move |h| f64::from(u8::from(d > h)))).sum::<f64>();
    assert!((number(fm4, "area_under_roc") - wins / 36.0).abs() < 1e-12);
    let roc: Vec<_> = table(&out.join("roc.csv")).into_iter().filter(|r| r["indicator"] == "fm4").collect();
    assert_eq!(roc.len(), 13, "a point for each value, and the corner");
    let over = table(&out.join("detection_over_severity.csv"));
    let over: Vec<_> = over.iter().filter(|r| r["indicator"] == "fm4").collect();
    let found: Vec<_> =
        over.iter().map(|r| (number(r, "severity"), &r["recordings"][..], number(r, "detection_rate"))).collect();
    assert_eq!(found, [(0.0, "3", 0.0), (50.0, "3", 1.0)]);
    for name in ["roc.svg", "detection_over_severity.png", "trend_fm4_difference.svg"] {
        assert!(out.join(name).exists(), "{name}");
    }

    // Two conditions: a curve each.
    let noisy: String =
        (0..6).map(|k| format!("{k},{},{}\n", if k < 3 { 0 } else { 50 }, if k % 3 == 0 { 2 } else { 10 })).collect();
    scratch.write("conditions.csv", &format!("recording,severity,condition\n{noisy}"));
    let flags = ["--healthy", "healthy", "--damaged", "damaged", "--severities", "conditions.csv", "--sigmas", "6"];
    succeed(scratch.path(), &[&base[..], &flags, &["--out", "conditions"]].concat());
    let out = scratch.path().join("conditions");
    let over = table(&out.join("detection_over_severity.csv"));
    let found: Vec<_> = over
        .iter()
        .filter(|r| r["indicator"] == "fm4")
        .map(|r| (&r["condition"][..], number(r, "severity"), &r["recordings"][..], number(r, "detection_rate")))
        .collect();
    assert_eq!(found, [("2", 0.0, "1", 0.0), ("2", 50.0, "1", 1.0), ("10", 0.0, "2", 0.0), ("10", 50.0, "2", 1.0)]);
    assert!(out.join("detection_over_severity_condition_2.svg").exists());

    // Bad input, one message each.
    scratch.write("twice.csv", "recording,severity\n1.csv,2\n1.csv,3\n");
    scratch.write("words.csv", "recording,severity\n1.csv,much\n");
    scratch.write("columns.csv", "file,size\n1.csv,2\n");
    let cases: [(&[&str], &[&str]); 8] = [
        (&["--damaged", "damaged"], &["--healthy", "healthy set"]),
        (&["--severities", "severities.csv"], &["--severities", "damaged"]),
        (&["--healthy", "healthy", "--damaged", "nowhere"], &["nowhere", "--damaged"]),
        (&["--healthy-first", "4", "--damaged-last", "3"], &["4 healthy", "3 damaged", "6"]),
        (
            &["--healthy", "healthy", "--damaged", "damaged", "--severities", "twice.csv"],
            &["twice.csv", "line 3", "twice"],
        ),
        (
            &["--healthy", "healthy", "--damaged", "damaged", "--severities", "words.csv"],
            &["words.csv", "line 2", "`much`"],
        ),
        (
            &["--healthy", "healthy", "--damaged", "damaged", "--severities", "columns.csv"],
            &["line 1", "\"recording\""],
        ),
        (&["--angles-deg", "0,90"], &["angles_deg", "2 numbers for 1 channels", "\"case\""]),
    ];
    for (flags, wanted) in cases {
        let base = if flags[0] == "--angles-deg" { &base[..9] } else { &base[..] };
        let output = gearwright(scratch.path(), &[base, flags].concat());
        let message = text(&output.stderr);
        assert!(!output.status.success(), "{flags:?} was accepted");
        for word in wanted {
            assert!(message.contains(word), "{flags:?}: \"{word}\" is missing in: {message}");
        }
    }
}

/// NA4 with a memory: begun anew, and locked.
#[test]
fn memories_begin_anew_and_lock() {
    let scratch = Scratch::new();
    for k in 0..9_u64 {
        // From the sixth on, three times the noise: variances nine times as large.
        let noise = if k < 5 { 0.1 } else { 0.3 };
        scratch.record(&format!("runs/{k}.csv"), 12_000, Holds { noise, ..Holds::default() }, 300 + k);
    }
    let case = |memory: &str| {
        format!(
            "kind = \"recording\"\n[signal]\nfile = \"runs\"\nrate_hz = 5120\n[tachometer]\nchannel = \"tacho\"\n\
             [gear]\nteeth = 27\n[memory]\n{memory}\n[output]\nplots = false\n"
        )
    };
    scratch.write("case.toml", &case("learn = 5\nlock_sigmas = 8\nreset_before = \"5.csv\""));
    succeed(scratch.path(), &["hums", "case.toml"]);
    let rows = table(&scratch.path().join("out/case/trend.csv"));
    let of = |name: &str| -> Vec<f64> {
        rows.iter().filter(|r| r["indicator"] == name).map(|r| r["value"].parse().unwrap()).collect()
    };
    let (single, running, reset, locked) = (of("na4"), of("na4_running"), of("na4_reset"), of("na4_locked"));
    assert_eq!(running[..5], reset[..5]);
    assert_eq!(reset[5], single[5], "the first of a new memory stands alone");
    assert!(running[5] > 5.0 * single[5], "variance 9 over a mean of (5 + 9) / 6");
    assert_eq!(locked[..6], reset[..6], "a reset goes for the locked one, too");
    scratch.write("bad.toml", &case("reset_before = \"55.csv\""));
    let message = text(&gearwright(scratch.path(), &["hums", "bad.toml"]).stderr);
    assert!(message.contains("\"55.csv\"") && message.contains("memory.reset_before"), "{message}");
    scratch.write("case.toml", &case("learn = 5\nlock_sigmas = 8"));
    succeed(scratch.path(), &["hums", "case.toml"]);
    let rows = table(&scratch.path().join("out/case/trend.csv"));
    let locked: Vec<f64> =
        rows.iter().filter(|r| r["indicator"] == "na4_locked").map(|r| r["value"].parse().unwrap()).collect();
    // Healthy variances stay the reference: 3 x 81, less where noise is not all of the residual.
    assert!(locked[5..].iter().all(|v| *v > 100.0), "{locked:?}");
    assert!(rows.iter().all(|r| r["indicator"] != "na4_reset"));
}

#[test]
fn gaps_cost_periods_not_the_recording() {
    let scratch = Scratch::new();
    let [mut x, tacho] = recording(20_480, Holds { noise: 0.1, ..Holds::default() }, 6);
    for gap in [5000..5003, 10_000..10_900] {
        x[gap].fill(f64::NAN);
    }
    scratch.write("rec.csv", &csv_text("case,tacho", &[&x, &tacho]));
    let screen =
        succeed(scratch.path(), &["hums", "--signal", "rec.csv", "--rate-hz", "5120", "--teeth", "27", "--tach", "2"]);
    assert!(screen.contains("903 samples missing"), "{screen}");
    let rows = table(&scratch.path().join("out/rec/indicators.csv"));
    // Raw indicators are those of the samples that are there.
    let finite: Vec<f64> = x.iter().copied().filter(|v| v.is_finite()).collect();
    let rms: f64 = row(&rows, "rms", "raw")["value"].parse().unwrap();
    assert!((rms / hums::indicator::basic::rms(&finite).unwrap() - 1.0).abs() < 1e-11);
    assert!(!row(&rows, "rms", "tsa")["value"].is_empty());
    let svg = std::fs::read_to_string(scratch.path().join("out/rec/signal.svg")).unwrap();
    assert!(!svg.contains("NaN"));
}

/// Recording, flags in groups, and what the message must name.
type Case<'a> = (&'a str, &'a [&'a [&'a str]], &'a [&'a str]);

#[test]
fn bad_input_is_one_message_with_a_remedy() {
    let scratch = Scratch::new();
    let [x, tacho] = scratch.record("rec.csv", 10_000, Holds::default(), 7);
    scratch.write("short.csv", &csv_text("case,tacho", &[&x[..300], &tacho[..300]]));
    scratch.write("flat.csv", &csv_text("case,tacho", &[&x, &vec![0.0; x.len()]]));
    scratch.write("nan.csv", &csv_text("case,tacho", &[&vec![f64::NAN; x.len()], &tacho]));
    scratch.write("broken.csv", "case,tacho\n1,0\n2,0\nbad,0\n");
    scratch.write("rec.xyz", "1,2");
    std::fs::create_dir(scratch.path().join("empty")).unwrap();
    let before = scratch.names();
    let gear = ["--teeth", "27"];
    let rate = ["--rate-hz", "5120"];
    let cases: [Case<'_>; 18] = [
        ("nowhere.csv", &[&gear, &rate, &["--tach", "2"]], &["nowhere.csv", "no such file", "--signal"]),
        ("rec.csv", &[&gear, &["--tach", "2"]], &["sampling rate", "--rate-hz", "signal.rate_hz"]),
        ("rec.csv", &[&gear, &rate, &["--tach", "taco"]], &["\"taco\"", "\"case\"", "\"tacho\""]),
        ("rec.csv", &[&gear, &rate, &["--tach", "2", "--channel", "3"]], &["\"3\"", "\"case\""]),
        ("rec.csv", &[&gear, &rate], &["--tach", "--speed-hz"]),
        ("rec.csv", &[&rate, &["--tach", "2"]], &["--teeth", "required"]),
        ("rec.csv", &[&["--teeth", "0", "--rate-hz", "0", "--tach", "2"]], &["--teeth = 0", "--rate-hz = 0"]),
        ("rec.csv", &[&gear, &rate, &["--tach", "times.csv"]], &["times.csv", "--tach"]),
        ("rec.csv", &[&gear, &rate, &["--tach", "2", "--speed-hz", "3"]], &["--speed-hz", "--tach"]),
        ("rec.csv", &[&gear, &rate, &["--speed-hz", "100"]], &["2700.0 mesh cycles", "5120"]),
        ("rec.csv", &[&gear, &rate, &["--tach", "2", "--gear-ratio", "a"]], &["--gear-ratio", "27/81"]),
        ("rec.csv", &[&gear, &rate, &["--tach", "2", "--healthy-first", "3"]], &["folder", "--healthy-first"]),
        ("rec.csv", &[&gear, &rate, &["--tach", "2", "--healthy", "empty"]], &["empty", "no recordings", ".wav"]),
        ("short.csv", &[&gear, &rate, &["--speed-hz", "10"]], &["short.csv", "0.0586 s", "0.1000 s", "record longer"]),
        ("flat.csv", &[&gear, &rate, &["--tach", "tacho"]], &["flat.csv", "\"tacho\"", "no pulses"]),
        ("nan.csv", &[&gear, &rate, &["--tach", "tacho"]], &["nan.csv", "gap"]),
        ("broken.csv", &[&gear, &rate, &["--speed-hz", "10"]], &["broken.csv", "line 4", "bad"]),
        ("rec.xyz", &[&gear, &rate, &["--speed-hz", "10"]], &["rec.xyz", "csv", "wav"]),
    ];
    for (file, flags, wanted) in cases {
        let arguments = [&["hums", "--signal", file][..], &flags.concat()].concat();
        let output = gearwright(scratch.path(), &arguments);
        let message = text(&output.stderr);
        assert!(!output.status.success(), "{arguments:?} was accepted");
        for word in wanted {
            assert!(message.contains(word), "{arguments:?}: \"{word}\" is missing in: {message}");
        }
        assert!(!message.contains("panicked"), "{message}");
        assert_eq!(scratch.names(), before, "{arguments:?} left something behind");
    }
    // All faults of a case file at once, with their lines.
    let case =
        "kind = \"recording\"\n[signal]\nfile = \"rec.csv\"\nrate = 3\n[gear]\nteeth = 0\n[tachometer]\nspeed = 1\n";
    scratch.write("case.toml", case);
    let message = text(&gearwright(scratch.path(), &["hums", "case.toml"]).stderr);
    for word in ["case.toml:4", "signal.rate", "rate_hz", "case.toml:6", "gear.teeth", "case.toml:8", "speed_hz"] {
        assert!(message.contains(word), "{word} is missing in: {message}");
    }
    // A case of another kind.
    scratch.write("pair.toml", "kind = \"spur-pair\"\n");
    assert!(!gearwright(scratch.path(), &["hums", "pair.toml"]).status.success());
}

/// An interrupt while a long recording is read leaves nothing behind.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing() {
    let scratch = Scratch::new();
    // 40 million samples of silence with pulses: far longer than the test waits.
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 50_000,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut wav = hound::WavWriter::create(scratch.path().join("long.wav"), spec).unwrap();
    for i in 0..40_000_000_u32 {
        wav.write_sample((i % 5000) as i16).unwrap();
    }
    wav.finalize().unwrap();
    let mut run = Command::new(env!("CARGO_BIN_EXE_gearwright"))
        .args(["hums", "--signal", "long.wav", "--teeth", "27", "--speed-hz", "10"])
        .current_dir(scratch.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The first line tells that reading has begun.
    let mut told = String::new();
    let mut errors = BufReader::new(run.stderr.take().unwrap());
    errors.read_line(&mut told).unwrap();
    assert!(told.contains("reading"), "{told}");
    std::thread::sleep(std::time::Duration::from_millis(200));
    assert!(run.try_wait().unwrap().is_none(), "the run is too short for this test");
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    errors.read_to_string(&mut told).unwrap();
    assert!(!run.wait().unwrap().success() && told.contains("stopped"), "{told}");
    assert_eq!(scratch.names(), ["long.wav"]);
}

/// Every command of the how-to, in its order, on recordings of the names it uses.
#[test]
fn the_how_to_works() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/own-recording.md");
    let page = std::fs::read_to_string(page).unwrap();
    let scratch = Scratch::new();
    let holds = Holds { noise: 0.1, ..Holds::default() };
    let [x, tacho] = scratch.record("rec.csv", 20_480, holds, 1);
    for k in 0..6 {
        scratch.record(&format!("recordings/{k}.csv"), 10_240, holds, k);
        scratch.record(&format!("healthy/{k}.csv"), 10_240, holds, 10 + k);
    }
    scratch.write("pulses.txt", &(0..40).map(|k| format!("{}\n", f64::from(k) / SPEED)).collect::<String>());
    let spec =
        hound::WavSpec { channels: 2, sample_rate: 5120, bits_per_sample: 24, sample_format: hound::SampleFormat::Int };
    let mut wav = hound::WavWriter::create(scratch.path().join("rec.wav"), spec).unwrap();
    for sample in x.iter().zip(&tacho).flat_map(|(x, t)| [x / 4.0, *t / 2.0]) {
        wav.write_sample((sample * 8e6) as i32).unwrap();
    }
    wav.finalize().unwrap();
    let sensors: Vec<Vec<f64>> = (0..4).map(|k| recording(20_480, holds, 50 + k)[0].clone()).collect();
    let columns: Vec<&[f64]> = sensors.iter().map(Vec::as_slice).chain([&tacho[..]]).collect();
    scratch.write("sensors.csv", &csv_text("a,b,c,d,tacho", &columns));
    let mut severities = String::from("recording,severity\n");
    for k in 0..6_u32 {
        let holds = Holds { knock: 0.1 * f64::from(k / 2), ..holds };
        scratch.record(&format!("damaged/{k}.csv"), 10_240, holds, 30 + u64::from(k));
        severities.push_str(&format!("{k}.csv,{}\n", 10 * (k / 2)));
    }
    scratch.write("severities.csv", &severities);
    let mut count = 0;
    for command in page.lines().filter_map(|line| line.strip_prefix("gearwright ")) {
        succeed(scratch.path(), &command.split_whitespace().collect::<Vec<_>>());
        count += 1;
    }
    assert!(count >= 12, "{count} commands");
    for name in [
        "rec/indicators.csv",
        "recordings/trend.csv",
        "recordings/alarms.csv",
        "recordings/trend_fm4_difference.svg",
        "sensors/polar_fm4_difference.svg",
        "damaged/roc.svg",
        "damaged/detection_over_severity.svg",
        "detection/detection.csv",
    ] {
        assert!(scratch.path().join("out").join(name).exists(), "{name}");
    }
}

#[test]
fn a_time_column_gives_the_rate_and_is_not_judged() {
    let scratch = Scratch::new();
    let [x, tacho] = recording(10_240, Holds { noise: 0.1, ..Holds::default() }, 8);
    let time: Vec<f64> = (0..x.len()).map(|i| i as f64 / RATE).collect();
    scratch.write("rec.csv", &csv_text("Time (s),x,x,tacho", &[&time, &x, &x, &tacho]));
    let arguments = ["hums", "--signal", "rec.csv", "--teeth", "27", "--tach", "tacho", "--no-plots"];
    let screen = succeed(scratch.path(), &arguments);
    assert!(screen.contains("at 5120 Hz"), "{screen}");
    let rows = table(&scratch.path().join("out/rec/indicators.csv"));
    let channels: std::collections::BTreeSet<&str> = rows.iter().map(|r| r["channel"].as_str()).collect();
    assert_eq!(channels.into_iter().collect::<Vec<_>>(), ["x", "x (3)"], "equal names are told apart");
}

/// Flags of a recording with a tachometer and nothing else.
const PLAIN: [&str; 7] = ["hums", "--teeth", "27", "--tach", "tacho", "--no-plots", "--signal"];

/// Channel verdicts of a run: verdict and why it is not judged.
fn verdicts(folder: &Path) -> BTreeMap<String, (String, String)> {
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap();
    let of = |channel: &serde_json::Value, key: &str| channel[key].as_str().unwrap().to_owned();
    let channels = summary["channels"].as_object().unwrap().iter();
    channels.map(|(name, c)| (name.clone(), (of(c, "verdict"), of(c, "not_judged_because")))).collect()
}

/// Nothing is "ok" that was not judged: dead, empty and clipped channels say so on the screen, in the tables and in the summary.
#[test]
fn a_channel_that_cannot_be_judged_is_not_ok() {
    let scratch = Scratch::new();
    let [x, tacho] = recording(20_480, Holds { noise: 0.2, ..Holds::default() }, 61);
    let dead = vec![0.0; x.len()];
    let empty = vec![f64::NAN; x.len()];
    let clipped: Vec<f64> = x.iter().map(|v| v.clamp(-0.9, 0.9)).collect();
    let mut loose = x.clone();
    loose[3000..5000].fill(0.01);
    scratch.write(
        "rec.csv",
        &csv_text("good,dead,empty,clipped,loose,tacho", &[&x, &dead, &empty, &clipped, &loose, &tacho]),
    );
    let screen = succeed(scratch.path(), &[&PLAIN[..], &["rec.csv", "--rate-hz", "5120"]].concat());
    let out = scratch.path().join("out/rec");
    let found = verdicts(&out);
    assert_eq!(found["good"], ("ok".to_owned(), String::new()));
    for (name, flaw) in [("dead", "dead"), ("empty", "no-data"), ("clipped", "clipped"), ("loose", "dropout")] {
        let (verdict, why) = &found[name];
        assert!(verdict == "not judged" && why.starts_with(flaw), "{name}: {verdict}, {why}");
        let line = screen.lines().find(|line| line.starts_with(name)).unwrap();
        assert!(line.contains("not judged") && line.contains(flaw), "{line}");
    }
    let rows = table(&out.join("indicators.csv"));
    for row in rows.iter().filter(|row| row["channel"] == "clipped") {
        assert_eq!(row["verdict"], "not judged", "{row:?}");
        assert!(row["not_judged_because"].starts_with("clipped"), "{row:?}");
    }
    let quality = table(&out.join("quality.csv"));
    let flaws: Vec<(&str, &str)> = quality.iter().map(|r| (&r["channel"][..], &r["flaw"][..])).collect();
    assert_eq!(flaws, [("dead", "dead"), ("empty", "no-data"), ("clipped", "clipped"), ("loose", "dropout")]);
    // The user may accept a flaw.
    succeed(scratch.path(), &[&PLAIN[..], &["rec.csv", "--rate-hz", "5120", "--accept", "clipped,dropout"]].concat());
    let found = verdicts(&out);
    assert!(found["clipped"].0 != "not judged" && found["loose"].0 != "not judged" && found["dead"].0 == "not judged");
    let output =
        gearwright(scratch.path(), &[&PLAIN[..], &["rec.csv", "--rate-hz", "5120", "--accept", "clip"]].concat());
    let message = text(&output.stderr);
    assert!(!output.status.success() && message.contains("--accept") && message.contains("clipped"), "{message}");
}

/// A healthy set whose channels carry other names has no limits for these: nine times the RMS is not "ok".
#[test]
fn limits_of_other_channels_judge_nothing() {
    let scratch = Scratch::new();
    for k in 0..4_u64 {
        let [x, tacho] = recording(12_000, Holds { noise: 0.1, ..Holds::default() }, 70 + k);
        scratch.write(&format!("healthy/{k}.csv"), &csv_text("case x,tacho", &[&x, &tacho]));
    }
    let [x, tacho] = recording(12_000, Holds { noise: 0.1, ..Holds::default() }, 80);
    let loud: Vec<f64> = x.iter().map(|v| 9.0 * v).collect();
    scratch.write("loud.csv", &csv_text("case x,tacho", &[&loud, &tacho]));
    scratch.write("other.csv", &csv_text("case y,tacho", &[&loud, &tacho]));
    let flags = ["--rate-hz", "5120", "--healthy", "healthy"];
    let screen = succeed(scratch.path(), &[&PLAIN[..], &["other.csv"], &flags].concat());
    let (verdict, why) = &verdicts(&scratch.path().join("out/other"))["case y"];
    assert!(verdict == "not judged" && why.contains("\"case x\"") && why.contains("\"case y\""), "{verdict} {why}");
    assert!(screen.contains("not judged: the healthy set has no usable channel"), "{screen}");
    succeed(scratch.path(), &[&PLAIN[..], &["loud.csv"], &flags].concat());
    assert_eq!(verdicts(&scratch.path().join("out/loud"))["case x"].0, "alarm");
    let rows = table(&scratch.path().join("out/loud/indicators.csv"));
    assert_eq!(row(&rows, "rms", "raw")["verdict"], "alarm");
    // Limits have two sides: a ninth of the RMS is no better.
    let quiet: Vec<f64> = x.iter().map(|v| v / 9.0).collect();
    scratch.write("quiet.csv", &csv_text("case x,tacho", &[&quiet, &tacho]));
    succeed(scratch.path(), &[&PLAIN[..], &["quiet.csv"], &flags].concat());
    let rows = table(&scratch.path().join("out/quiet/indicators.csv"));
    assert_eq!(row(&rows, "rms", "raw")["verdict"], "alarm");
}

/// The whole time column counts: rows missing behind its head leave the average what it is, and are reported.
#[test]
fn rows_missing_from_a_time_column_are_gaps() {
    let scratch = Scratch::new();
    let [x, tacho] = recording(90_000, Holds { noise: 0.05, ..Holds::default() }, 91);
    let time: Vec<f64> = (0..x.len()).map(|i| i as f64 / RATE).collect();
    let without = |columns: [&[f64]; 3]| -> String {
        let kept: Vec<Vec<f64>> = columns.iter().map(|c| [&c[..70_000], &c[73_333..]].concat()).collect();
        csv_text("t,x,tacho", &[&kept[0], &kept[1], &kept[2]])
    };
    scratch.write("whole.csv", &csv_text("t,x,tacho", &[&time, &x, &tacho]));
    scratch.write("holed.csv", &without([&time, &x, &tacho]));
    succeed(scratch.path(), &[&PLAIN[..], &["whole.csv"]].concat());
    let screen = succeed(scratch.path(), &[&PLAIN[..], &["holed.csv"]].concat());
    assert!(screen.contains("3333 rows are missing"), "{screen}");
    let amplitudes = ["whole", "holed"]
        .map(|name| amplitude(&table(&scratch.path().join(format!("out/{name}/averages.csv"))), "x tsa", 27.0));
    assert!((amplitudes[1] / amplitudes[0] - 1.0).abs() < 1e-3, "{amplitudes:?}");
    let quality = table(&scratch.path().join("out/holed/quality.csv"));
    assert!(quality.iter().any(|r| r["flaw"] == "time-column" && r["channel"].is_empty()), "{quality:?}");

    // From the middle on only every second row: half of the samples are missing, nothing is judged.
    let every_second: Vec<usize> = (0..45_000).chain((45_000..90_000).step_by(2)).collect();
    let pick = |column: &[f64]| every_second.iter().map(|i| column[*i]).collect::<Vec<f64>>();
    scratch.write("doubled.csv", &csv_text("t,x,tacho", &[&pick(&time), &pick(&x), &pick(&tacho)]));
    succeed(scratch.path(), &[&PLAIN[..], &["doubled.csv"]].concat());
    assert_eq!(verdicts(&scratch.path().join("out/doubled"))["x"].0, "not judged");
    // A step back is an error with the column's name.
    let back: Vec<f64> = time.iter().enumerate().map(|(i, t)| if i == 80_000 { t - 1.0 } else { *t }).collect();
    scratch.write("back.csv", &csv_text("t,x,tacho", &[&back, &x, &tacho]));
    let output = gearwright(scratch.path(), &[&PLAIN[..], &["back.csv"]].concat());
    let message = text(&output.stderr);
    assert!(!output.status.success() && message.contains("\"t\"") && message.contains("go back"), "{message}");
}

/// A rate that contradicts the file keeps everything from being judged.
#[test]
fn a_rate_that_contradicts_the_file_is_a_conflict() {
    let scratch = Scratch::new();
    let [x, tacho] = recording(20_480, Holds { noise: 0.2, ..Holds::default() }, 95);
    let time: Vec<f64> = (0..x.len()).map(|i| i as f64 / RATE).collect();
    scratch.write("rec.csv", &csv_text("t,x,tacho", &[&time, &x, &tacho]));
    let screen = succeed(scratch.path(), &[&PLAIN[..], &["rec.csv", "--rate-hz", "10240"]].concat());
    assert!(screen.contains("rate-conflict") && screen.contains("5120"), "{screen}");
    assert_eq!(verdicts(&scratch.path().join("out/rec"))["x"].0, "not judged");
    succeed(scratch.path(), &[&PLAIN[..], &["rec.csv", "--rate-hz", "5121"]].concat());
    assert_eq!(verdicts(&scratch.path().join("out/rec"))["x"].0, "ok", "two parts in ten thousand are no conflict");
}

/// Three seconds of standstill are no thirty turns.
#[test]
fn a_standstill_is_left_out_and_reported() {
    let scratch = Scratch::new();
    let [x, tacho] = recording(61_440, Holds { noise: 0.05, ..Holds::default() }, 97);
    let rest = 15_360;
    let mut noise = Noise(5);
    let still: Vec<f64> = (0..rest).map(|_| 5.0 + noise.next()).collect();
    // The shaft stops half way between two pulses.
    let at = 51_200 + 256;
    let stopped = [&x[..at], &still, &x[at..]].concat();
    let pulses = [&tacho[..at], &vec![0.0; rest][..], &tacho[at..]].concat();
    scratch.write("rec.csv", &csv_text("x,tacho", &[&stopped, &pulses]));
    let screen =
        succeed(scratch.path(), &[&PLAIN[..], &["rec.csv", "--rate-hz", "5120", "--accept", "saturated"]].concat());
    assert!(screen.contains("standstill: no pulses for 3.1"), "{screen}");
    let out = scratch.path().join("out/rec");
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    // 120 turns, less one at each end and those that touch the rest.
    let periods = summary["channels"]["x"]["average"]["periods"].as_u64().unwrap();
    assert!((114..=118).contains(&periods), "{periods}");
    let tsa: f64 = row(&table(&out.join("indicators.csv")), "rms", "tsa")["value"].parse().unwrap();
    assert!((tsa - (0.5 * 1.09_f64).sqrt()).abs() < 0.02, "{tsa}");
    assert!(row(&table(&out.join("indicators.csv")), "mean", "tsa")["value"].parse::<f64>().unwrap().abs() < 0.1);
}

/// Arrays of another length are named, not passed over.
#[test]
fn arrays_of_another_length_are_reported() {
    let scratch = Scratch::new();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../hums/tests/data");
    let header: Vec<u8> = std::fs::read(data.join("compressed.mat")).unwrap()[..128].to_vec();
    let array = |name: &str, numbers: &[f64]| -> Vec<u8> {
        let mut name_bytes = name.as_bytes().to_vec();
        name_bytes.resize(name.len().next_multiple_of(8), 0);
        let mut body: Vec<u8> = Vec::new();
        let tag = |body: &mut Vec<u8>, kind: u32, bytes: usize| {
            body.extend(kind.to_le_bytes());
            body.extend((bytes as u32).to_le_bytes());
        };
        tag(&mut body, 6, 8);
        body.extend(6_u32.to_le_bytes());
        body.extend(0_u32.to_le_bytes());
        tag(&mut body, 5, 8);
        body.extend((numbers.len() as u32).to_le_bytes());
        body.extend(1_u32.to_le_bytes());
        tag(&mut body, 1, name.len());
        body.extend(name_bytes);
        tag(&mut body, 9, 8 * numbers.len());
        body.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        let mut element = Vec::new();
        tag(&mut element, 14, body.len());
        element.extend(body);
        element
    };
    let [x, tacho] = recording(20_480, Holds { noise: 0.2, ..Holds::default() }, 99);
    let file = [header, array("tacho", &tacho), array("x", &x), array("torque", &x[..5000])].concat();
    std::fs::write(scratch.path().join("rec.mat"), file).unwrap();
    let screen = succeed(scratch.path(), &[&PLAIN[..], &["rec.mat", "--rate-hz", "5120"]].concat());
    assert!(screen.contains("left-out: array \"torque\" of 5000 by 1"), "{screen}");
}

/// Wide files take memory for the data they have; more channels than memory allows are refused with a remedy.
#[cfg(target_os = "linux")]
#[test]
fn memory_follows_the_data() {
    let scratch = Scratch::new();
    let columns = 20_000;
    let row = vec!["1.5"; columns].join(",");
    let other = vec!["-2.5"; columns].join(",");
    let text_of: String = (0..200).map(|k| format!("{}\n", if k % 2 == 0 { &row } else { &other })).collect();
    scratch.write("wide.csv", &text_of);
    // 1 GiB of address space: the 8 GB of a kernel table a channel do not fit.
    let limited = |arguments: &[&str]| {
        let command = "ulimit -v 1048576; exec \"$0\" \"$@\"";
        Command::new("sh")
            .args(["-c", command, env!("CARGO_BIN_EXE_gearwright")])
            .args(arguments)
            .current_dir(scratch.path())
            .output()
            .unwrap()
    };
    let flags =
        ["hums", "--signal", "wide.csv", "--teeth", "3", "--sideband-pairs", "0", "--no-plots", "--threads", "1"];
    let output = limited(&[&flags[..], &["--rate-hz", "100", "--speed-hz", "10"]].concat());
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    let output = limited(&[&flags[..], &["--rate-hz", "1000000", "--speed-hz", "1"]].concat());
    let message = text(&output.stderr);
    assert!(
        !output.status.success() && message.contains("20000 channels take") && message.contains("--channel"),
        "{message}"
    );
}

/// Devices and pipes are no recordings.
#[cfg(unix)]
#[test]
fn devices_are_refused_at_once() {
    let scratch = Scratch::new();
    for target in ["/dev/zero", "/dev/stdin"] {
        let link = scratch.path().join("rec.csv");
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(target, &link).unwrap();
        let mut run = Command::new(env!("CARGO_BIN_EXE_gearwright"))
            .args(PLAIN)
            .args(["rec.csv", "--rate-hz", "5120"])
            .current_dir(scratch.path())
            .stdin(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let mut message = String::new();
        run.stderr.take().unwrap().read_to_string(&mut message).unwrap();
        assert!(
            !run.wait().unwrap().success() && message.contains("neither a file nor a folder"),
            "{target}: {message}"
        );
    }
}
