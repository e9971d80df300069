//! Vibration separation on synthetic planetary records with a known tooth in every place.

mod common;
use common::{gaussian, max_difference};
use hums::HumsError;
use hums::separation::{PassWindow, PlanetaryStage};
use std::f64::consts::TAU;

/// Sensor records: planet k is heard with weight 1 within 4 mesh cycles of the sensor, not at all
/// beyond; while it is heard, `planet(k, coordinate)` + `sun(coordinate)` in samples of their turns.
fn records(
    stage: &PlanetaryStage,
    turns: usize,
    planet: impl Fn(usize, usize) -> f64,
    sun: impl Fn(usize) -> f64,
) -> Vec<Vec<f64>> {
    let per_turn = stage.samples_per_turn();
    let s = stage.samples_per_mesh;
    let (np, ns) = (stage.planet_teeth * s, stage.sun_teeth * s);
    let hear = |k: usize, theta: f64, i: usize| {
        let c = i as f64 / per_turn as f64;
        let off = c - (theta - stage.planet_angles[k]);
        (off - off.round()).abs() * stage.ring_teeth as f64 <= 4.0
    };
    stage
        .sensor_angles
        .iter()
        .map(|&theta| {
            (0..turns * per_turn)
                .map(|i| {
                    (0..stage.planet_angles.len())
                        .filter(|&k| hear(k, theta, i))
                        .map(|k| {
                            let shift = (stage.planet_angles[k] * ns as f64).round() as i64;
                            let at_sun = (i as i64 - shift).rem_euclid(ns as i64) as usize;
                            planet(k, i % np) + sun(at_sun)
                        })
                        .sum()
                })
                .collect()
        })
        .collect()
}

fn stage() -> PlanetaryStage {
    // The dissertation's output stage has 99 ring, 35 planet, 27 sun teeth (D 5.1).
    PlanetaryStage { samples_per_mesh: 16, ..PlanetaryStage::new(99, 35, 27, 3) }
}

/// Different tooth-by-tooth signatures for each planet.
fn signature(k: usize, at: usize) -> f64 {
    let mesh = TAU * at as f64 / 16.0;
    let tooth = at / 16;
    let crack = if tooth == 4 + 9 * k { 1.0 } else { 0.0 };
    (1.0 + 0.1 * k as f64) * mesh.sin() + crack * (3.0 * mesh).sin()
}

#[test]
fn analytic_planets_are_separated_exactly() {
    for window in [PassWindow::Rectangular, PassWindow::Hann, PassWindow::Tukey] {
        let stage = PlanetaryStage { window, ..stage() };
        assert_eq!((stage.planet_reset_turns(), stage.sun_reset_turns()), (35, 3));
        let x = records(&stage, 37, signature, |_| 0.0);
        for k in 0..3 {
            let found = stage.planet(&[&x[0]], 0.0, k).unwrap();
            let expected: Vec<f64> = (0..35 * 16).map(|at| signature(k, at)).collect();
            assert!(found.passes >= 35);
            assert!(max_difference(&found.samples, &expected) < 1e-12, "{window:?} {k}");
        }
    }
}

#[test]
fn analytic_sun_is_separated_exactly() {
    let stage = stage();
    let sun = |at: usize| (TAU * at as f64 / 16.0).cos() + if at / 16 == 20 { 0.7 } else { 0.0 };
    let x = records(&stage, 12, |_, _| 0.0, sun);
    let found = stage.sun(&[&x[0]], 0.0);
    // gcd(99, 27) = 9: the sun teeth at the sensor are 0, 9, 18 for each planet; (99 + 27) / 3 = 42
    // shifts them by 15 and 3 teeth. Five-tooth windows leave holes only where no window reaches.
    match found {
        Ok(found) => {
            let expected: Vec<f64> = (0..27 * 16).map(sun).collect();
            assert!(max_difference(&found.samples, &expected) < 1e-12);
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn analytic_sensors_fill_the_turn_faster() {
    // Nine teeth of hearing a pass: 35 planet teeth need several passes; seven sensors share them.
    let mut stage = PlanetaryStage { window_teeth: 8.0, ..stage() };
    let x = records(&stage, 6, signature, |_| 0.0);
    assert!(matches!(
        PlanetaryStage { window_teeth: 2.0, ..stage.clone() }.planet(&[&x[0]], 0.0, 1),
        Err(HumsError::Undefined { .. })
    ));
    stage.sensor_angles = (0..7).map(|i| f64::from(i) * 11.0 / 99.0).collect();
    let x = records(&stage, 6, signature, |_| 0.0);
    let parts: Vec<&[f64]> = x.iter().map(Vec::as_slice).collect();
    let found = stage.planet(&parts, 0.0, 1).unwrap();
    let expected: Vec<f64> = (0..35 * 16).map(|at| signature(1, at)).collect();
    assert!(max_difference(&found.samples, &expected) < 1e-12);
    assert!(stage.planet(&parts[..2], 0.0, 1).is_err());
}

#[test]
fn invariant_start_of_the_record_and_noise() {
    let stage = stage();
    let mut x = records(&stage, 110, signature, |_| 0.0).remove(0);
    let from = 5 * stage.samples_per_turn() + 777;
    let first_turn = from as f64 / stage.samples_per_turn() as f64;
    let expected: Vec<f64> = (0..35 * 16).map(|at| signature(2, at)).collect();
    let found = stage.planet(&[&x[from..]], first_turn, 2).unwrap();
    assert!(max_difference(&found.samples, &expected) < 1e-12);
    // A gap costs one pass; noise falls by the passes that share a tooth.
    x[from + 40_000..from + 40_100].fill(f64::NAN);
    for (v, g) in x.iter_mut().zip(gaussian(110 * 99 * 16, 3)) {
        *v += 0.1 * g;
    }
    let noisy = stage.planet(&[&x], 0.0, 2).unwrap();
    assert!(noisy.skipped <= 1);
    let errors: Vec<f64> = noisy.samples.iter().zip(&expected).map(|(a, b)| a - b).collect();
    let rms = hums::indicator::basic::rms(&errors).unwrap();
    // Three passes at every tooth, with about 5 overlapping windows of mean square 3/8.
    assert!(rms < 0.1 / 3.0_f64.sqrt(), "{rms}");
}

#[test]
fn extreme_parameters() {
    let good = stage();
    let x = vec![0.0; 4 * good.samples_per_turn()];
    assert!(good.planet(&[&x], 0.0, 3).is_err());
    assert!(good.planet(&[&x], f64::NAN, 0).is_err());
    assert!(good.planet(&[&[]], 0.0, 0).is_err());
    for bad in [
        PlanetaryStage { ring_teeth: 0, ..good.clone() },
        PlanetaryStage { samples_per_mesh: 1, ..good.clone() },
        PlanetaryStage { window_teeth: 0.5, ..good.clone() },
        PlanetaryStage { planet_angles: vec![f64::NAN], ..good.clone() },
    ] {
        assert!(bad.planet(&[&x], 0.0, 0).is_err());
    }
}
