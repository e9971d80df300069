//! Synchronous averaging against the comb filter's formula, and its invariances.

mod common;
use common::{close, gaussian, max_difference};
use hums::HumsError;
use hums::indicator::basic::{kurtosis, rms};
use hums::resample::Interpolation;
use hums::spectrum::{Spectrum, Window};
use hums::tachometer::{PulseOptions, Shaft};
use hums::tsa::{Averager, TsaOptions, average, average_periods, comb_gain};
use std::f64::consts::TAU;

const RATE: f64 = 10_240.0;
const SPEED: f64 = 10.0;

/// 40 turns: order 27 with a sideband, and a tone at an order that need not be whole.
fn record(order: f64, samples: usize) -> Vec<f64> {
    (0..samples)
        .map(|i| {
            let turn = i as f64 * SPEED / RATE;
            (27.0 * TAU * turn).sin() + 0.3 * (28.0 * TAU * turn).cos() + (order * TAU * turn).cos()
        })
        .collect()
}

#[test]
fn analytic_comb_filter_predicts_what_is_left() {
    let n = 41 * 1024;
    for (order, blocks) in [(10.37, 8), (10.37, 32), (3.5, 16), (3.5, 7), (100.01, 20), (6.25, 4)] {
        for interpolation in [Interpolation::default(), Interpolation::CubicSpline] {
            let options = TsaOptions { max_blocks: Some(blocks), interpolation, ..TsaOptions::per_turn(2048) };
            let shaft = Shaft::constant(SPEED, n, RATE).unwrap();
            let left = average(&record(order, n), RATE, &shaft, &options).unwrap();
            assert_eq!(left.blocks, blocks);
            let wanted: Vec<f64> = (0..2048)
                .map(|i| {
                    let a = TAU * f64::from(i) / 2048.0;
                    (27.0 * a).sin() + 0.3 * (28.0 * a).cos()
                })
                .collect();
            // What is left of the tone is a tone of amplitude |H|: its peak over a period of
            // non-whole order reaches |H| to the grid's resolution, 1 - (pi order / 2048)^2 / 2.
            let rest = max_difference(&left.samples, &wanted);
            let gain = comb_gain(order, blocks);
            // Spline error of order 100 at 1024 samples a turn: below 5e-4.
            assert!((rest - gain).abs() < 5e-4 + 0.013 * gain, "order {order}, N {blocks}: {rest} vs {gain}");
        }
    }
}

#[test]
fn analytic_comb_gain() {
    assert_eq!(comb_gain(5.0, 100), 1.0);
    assert!(comb_gain(5.25, 4) < 1e-15);
    close(comb_gain(0.5, 7), 1.0 / 7.0, 1e-14);
    close(comb_gain(1e-9, 3), 1.0, 1e-12);
    close(comb_gain(7.3, 1), 1.0, 1e-14);
}

#[test]
fn analytic_white_noise_falls_by_root_n() {
    let (n, blocks) = (256, 400);
    let x = gaussian(n * blocks, 12);
    let a = average_periods(&x, n, None).unwrap();
    assert_eq!((a.blocks, a.skipped), (400, 0));
    // 256 residual samples: 4.4 % a standard deviation.
    close(rms(&a.samples).unwrap() * a.noise_reduction(), 1.0, 0.15);
    close(a.removed_rms(), 1.0, 0.01);
    close(a.noise_floor(), 0.05, 0.01);
}

#[test]
fn analytic_speed_varying_by_half() {
    // Order 27 with the speed falling from 10 to 5 Hz over 40 turns; ten pulses a turn.
    let a = 0.468_75;
    let turn = |t: f64| 10.0 * t - a * t * t;
    let time = |turn: f64| (10.0 - (100.0 - 4.0 * a * turn).sqrt()) / (2.0 * a);
    let n = (time(39.99) * RATE) as usize;
    let x: Vec<f64> = (0..n).map(|i| (27.0 * TAU * turn(i as f64 / RATE)).sin()).collect();
    let pulses: Vec<f64> = (0..400).map(|k| time(f64::from(k) / 10.0)).collect();
    let shaft = Shaft::from_pulses(&pulses, 10.0).unwrap();
    let tsa = average(&x, RATE, &shaft, &TsaOptions::per_turn(4096)).unwrap();
    assert!(tsa.blocks >= 38);
    let amplitude = Spectrum::of(&tsa.samples, Window::Rectangular).unwrap().amplitude(27).unwrap();
    close(amplitude, 1.0, 1e-5);
    assert!(tsa.removed_rms() < 1e-4, "{}", tsa.removed_rms());
    // Constant speed assumed: the order smears.
    let blind = Shaft::constant(7.5, n, RATE).unwrap();
    let smeared = average(&x, RATE, &blind, &TsaOptions::per_turn(4096)).unwrap();
    assert!(rms(&smeared.samples).unwrap() < 0.3);
}

#[test]
fn extreme_faulty_tachometer_channel_end_to_end() {
    // Five pulses a turn while the speed falls by half; three lost, two doubled, gaps in the channel.
    let a = 0.468_75;
    let turn = |t: f64| 10.0 * t - a * t * t;
    let time = |turn: f64| (10.0 - (100.0 - 4.0 * a * turn).sqrt()) / (2.0 * a);
    let n = (time(39.9) * RATE) as usize;
    let x: Vec<f64> = (0..n).map(|i| (27.0 * TAU * turn(i as f64 / RATE)).sin()).collect();
    // Pulses are parabolas a fifth of the pulse pitch wide in angle, as a slot in a disc makes them.
    let mut centres: Vec<f64> = (0..199).map(|k| f64::from(k) + 0.5).collect();
    for lost in [150, 99, 40] {
        centres.remove(lost);
    }
    centres.extend([60.9, 130.8]);
    let mut channel: Vec<f64> = (0..n)
        .map(|i| {
            let phase = 5.0 * turn(i as f64 / RATE);
            let height = |c: &f64| (1.0 - ((phase - c) / 0.1).powi(2)).max(0.0);
            5.0 * centres.iter().map(height).sum::<f64>()
        })
        .collect();
    channel[5000..5003].fill(f64::NAN);
    let (shaft, pulses) = Shaft::from_channel(&channel, RATE, 5.0, &PulseOptions::default()).unwrap();
    assert_eq!((pulses.missing, pulses.extra), (3, 2));
    let tsa = average(&x, RATE, &shaft, &TsaOptions::per_turn(4096)).unwrap();
    let amplitude = Spectrum::of(&tsa.samples, Window::Rectangular).unwrap().amplitude(27).unwrap();
    // Crossings by linear interpolation on a curved flank: a thousandth of a sample, 1e-4 rad of mesh.
    close(amplitude, 1.0, 1e-3);
    assert!(tsa.removed_rms() < 0.02, "{}", tsa.removed_rms());
}

#[test]
fn invariant_streaming_gives_the_same_bits() {
    let n = 30 * 1024 + 17;
    let x = gaussian(n, 5);
    let pulses: Vec<f64> = (0..30).map(|k| 0.013 + 0.0997 * f64::from(k)).collect();
    for interpolation in [Interpolation::Linear, Interpolation::CubicSpline, Interpolation::default()] {
        let shaft = Shaft::from_pulses(&pulses, 1.0).unwrap();
        let options = TsaOptions { interpolation, ..TsaOptions::per_turn(1024) };
        let whole = average(&x, RATE, &shaft, &options).unwrap();
        for piece in [1000, 4096, 7, n] {
            let mut averager = Averager::new(RATE, shaft.clone(), options.clone()).unwrap();
            x.chunks(piece).for_each(|part| averager.push(part));
            assert_eq!(averager.finish().unwrap(), whole, "{interpolation:?} {piece}");
        }
    }
}

#[test]
fn extreme_gaps_leave_blocks_out() {
    let n = 21 * 1024;
    let shaft = Shaft::constant(SPEED, n, RATE).unwrap();
    let mut x = record(27.0, n);
    let options = TsaOptions { interpolation: Interpolation::Linear, ..TsaOptions::per_turn(1024) };
    let clean = average(&x, RATE, &shaft, &options).unwrap();
    x[5 * 1024 + 100..5 * 1024 + 140].fill(f64::NAN);
    let gap = average(&x, RATE, &shaft, &options).unwrap();
    assert_eq!((gap.blocks, gap.skipped), (clean.blocks - 1, 1));
    assert!(max_difference(&gap.samples, &clean.samples) < 1e-12);
    x.fill(f64::NAN);
    assert!(matches!(average(&x, RATE, &shaft, &options), Err(HumsError::Undefined { .. })));
    assert!(average(&[], RATE, &shaft, &options).is_err());
    assert!(average(&[1.0], RATE, &shaft, &options).is_err());
    assert!(average_periods(&[1.0; 10], 0, None).is_err());
    assert!(average_periods(&[1.0; 10], 11, None).is_err());
    assert!(Averager::new(RATE, shaft, TsaOptions::per_turn(1)).is_err());
}

#[test]
fn peer_dissertation_figure_a5_repetition_every_nine_planet_passes() {
    // D A.5: a record that repeats after three carrier turns (nine planet passes) gives one and the same average for every
    // multiple of nine passes, or of three carrier turns, and others in between; so do its RMS and its kurtosis.
    let (per_pass, passes_per_turn) = (64, 3);
    let pattern = gaussian(9 * per_pass, 77);
    let record: Vec<f64> = (0..10).flat_map(|_| pattern.iter().copied()).collect();
    for (period, repeats) in [(per_pass, 9), (passes_per_turn * per_pass, 3)] {
        let of = |blocks| average_periods(&record, period, Some(blocks)).unwrap().samples;
        let once = of(repeats);
        let (once_rms, once_kurtosis) = (rms(&once).unwrap(), kurtosis(&once).unwrap());
        for multiple in [2, 3, 9] {
            let more = of(multiple * repeats);
            assert!(max_difference(&more, &once) < 1e-14);
            assert!((rms(&more).unwrap() / once_rms - 1.0).abs() < 1e-13);
            assert!((kurtosis(&more).unwrap() / once_kurtosis - 1.0).abs() < 1e-13);
        }
        for blocks in [repeats - 1, repeats + 1, 2 * repeats - 1] {
            assert!(max_difference(&of(blocks), &once) > 1e-2, "{blocks} of {period}");
            assert!((rms(&of(blocks)).unwrap() / once_rms - 1.0).abs() > 1e-4, "{blocks} of {period}");
        }
    }
}

/// Periods that a standstill touches are left out, however long it is.
#[test]
fn standstills_are_not_averaged() {
    let rate = 1000.0;
    // Ten turns a second with an order 3, five seconds of rest with noise of another size, ten turns a second again.
    let moving = |t: f64| (TAU * 3.0 * 10.0 * t).sin();
    let x: Vec<f64> = (0..25_000)
        .map(|i| {
            let t = f64::from(i) / rate;
            if t < 10.05 {
                moving(t)
            } else if t < 14.95 {
                7.0
            } else {
                moving(t - 5.0)
            }
        })
        .collect();
    let mut times: Vec<f64> = (0..100).map(|k| 0.1 * f64::from(k)).collect();
    times.extend((0..100).map(|k| 15.0 + 0.1 * f64::from(k)));
    let shaft = Shaft::from_repaired(&hums::tachometer::repair(&times).unwrap(), 1.0).unwrap();
    let found = average(&x, rate, &shaft, &TsaOptions::per_turn(128)).unwrap();
    let expected: Vec<f64> = (0..128).map(|k| (TAU * 3.0 * f64::from(k) / 128.0).sin()).collect();
    assert!(max_difference(&found.samples, &expected) < 1e-3);
    // Whole turns that reach no farther than the margin of the interpolation to the rest.
    assert!((190..=198).contains(&found.blocks), "{}", found.blocks);
}
