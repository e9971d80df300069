//! Signals as they should not be: every indicator has a finite value or a reason why none.

use hums::difference::RemovalRule;
use hums::envelope::envelope;
use hums::indicator::{Entry, GearAnalyzer, SignalKind, signal_indicators};
use hums::quality::ChannelQuality;
use hums::resample::{Interpolation, to_angle};
use hums::signal::fill_gaps;
use hums::spectrum::{Spectrum, Window};
use hums::tachometer::{Shaft, repair};
use hums::tsa::{TsaOptions, average};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Answer, Table};

const LENGTH: usize = 2048;

/// All cases.
pub fn cases() -> Table {
    let mut table = Table::new(
        "hums",
        "All indicators of the raw signal and, with 27 teeth, of its difference, residual and regular signals; spectrum and envelope. A value that does not \
         exist (the kurtosis of a constant) is an error of its own: how many there are is said.",
        &[],
    );
    let sine = |amplitude: f64, offset: f64| -> Vec<f64> {
        let turn = |k: usize| std::f64::consts::TAU * 27.0 * k as f64 / LENGTH as f64;
        (0..LENGTH).map(|k| offset + amplitude * turn(k).sin()).collect()
    };
    let mut spike = vec![0.0; LENGTH];
    spike[LENGTH / 2] = 1.0;
    let clipped = sine(1.0, 0.0).iter().map(|v| v.clamp(-0.8, 0.8)).collect();
    let counts = noise().iter().map(|g| (20.0 * g).round() + 8_388_407.0).collect();
    let scaled = |scale: f64| noise().iter().map(|v| v * scale).collect::<Vec<f64>>();
    let signals: [(&str, Vec<f64>); 12] = [
        ("all zeros", vec![0.0; LENGTH]),
        ("constant 0.1", vec![0.1; LENGTH]),
        ("constant of the least number", vec![5e-324; LENGTH]),
        ("sine", sine(1.0, 0.0)),
        ("sine of 1e-9 on an offset of 1e6", sine(1e-9, 1e6)),
        ("clipped sine", clipped),
        ("one spike", spike),
        ("24-bit counts near full scale", counts),
        ("noise of 1e-300", scaled(1e-300)),
        ("noise of 1e300", scaled(1e300)),
        ("three samples", vec![1.0, -2.0, 0.5]),
        ("one sample", vec![3.0]),
    ];
    for (name, signal) in signals {
        table.answered(name, || indicators(&signal));
    }
    table.refused("no samples", || indicators(&[]));
    table.refused("constant of the largest number: sums of the transform overflow", || indicators(&[f64::MAX; LENGTH]));
    table.refused("a sample that is not a number", || {
        let mut signal = noise();
        signal[300] = f64::NAN;
        indicators(&signal)
    });
    table.answered("gap of two samples, filled", || {
        let mut signal = noise();
        (signal[300], signal[301]) = (f64::NAN, f64::INFINITY);
        let found = ChannelQuality::of(&signal).gaps.samples;
        let filled = fill_gaps(&mut signal, 2)?;
        Ok(indicators(&signal)?.with(filled == found, "not all filled"))
    });
    table.refused("gap longer than may be filled", || {
        let mut signal = noise();
        signal[300..310].fill(f64::NAN);
        fill_gaps(&mut signal, 2)?;
        indicators(&signal)
    });
    tachometers(&mut table);
    table
}

fn tachometers(table: &mut Table) {
    // pulses of 20 turns within the record, at 100 samples a second
    let steady = |turns: usize| (0..turns).map(|k| 0.5 + k as f64).collect::<Vec<f64>>();
    let mut missing = steady(20);
    missing.remove(7);
    let mut double = steady(20);
    double.insert(8, 7.51);
    // half the speed at the end
    let slowing = (0..15)
        .map(|k| {
            let k = f64::from(k);
            0.5 + k + k * k / 30.0
        })
        .collect::<Vec<f64>>();
    for (name, pulses) in [
        ("tachometer: steady", steady(20)),
        ("tachometer: a pulse missing", missing),
        ("tachometer: a double pulse", double),
        ("tachometer: speed falling by half", slowing),
    ] {
        table.answered(name, || {
            let repaired = repair(&pulses)?;
            averaged(&Shaft::from_repaired(&repaired, 1.0)?)
        });
    }
    table.refused("tachometer: one pulse", || averaged(&Shaft::from_pulses(&[1.0], 1.0)?));
    table.refused("tachometer: pulses that run backward", || averaged(&Shaft::from_pulses(&[3.0, 2.0, 1.0], 1.0)?));
    table.refused("tachometer: a pulse at no time", || averaged(&Shaft::from_pulses(&[0.0, f64::NAN, 2.0], 1.0)?));
}

fn averaged(shaft: &Shaft) -> anyhow::Result<Answer> {
    let signal = noise();
    let mean = average(&signal, 100.0, shaft, &TsaOptions::per_turn(64))?;
    let angle = to_angle(&signal, 100.0, shaft, 64, Interpolation::CubicSpline)?;
    let numbers = mean.samples.iter().chain(&mean.spread).chain(&angle.samples).copied();
    Ok(Answer::new("averaged over turns", vec![]).with_finite("averages", numbers))
}

fn indicators(signal: &[f64]) -> anyhow::Result<Answer> {
    let mut table = signal_indicators(signal, SignalKind::Raw)?;
    // too short for 27 teeth is one of the reasons
    if let Ok(analyzer) = GearAnalyzer::new(signal.len(), &RemovalRule::sidebands(27, 1)) {
        match analyzer.analyze(signal) {
            Ok(analysis) => table.extend(analysis.table.iter().cloned()),
            Err(error) => return Err(error.into()),
        }
    }
    let spectrum = Spectrum::of(signal, Window::Hann)?;
    let envelope = envelope(signal)?;
    let value = |entry: &Entry| entry.value.as_ref().ok().copied();
    let none = table.iter().filter(|entry| entry.value.is_err()).count();
    let said = format!("{} values, {none} reasons why none", table.len() - none);
    let numbers = table.iter().filter_map(value).collect::<Vec<_>>();
    Ok(Answer::new(said, vec![])
        .with_finite("indicators", numbers.into_iter())
        .with_finite("spectrum", spectrum.amplitudes().iter().copied())
        .with_finite("envelope", envelope.iter().copied()))
}

/// Normal noise (Box and Muller), always the same.
fn noise() -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(41);
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let one = |_| {
        let (u, v) = (1.0 - uniform(), uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    };
    (0..LENGTH).map(one).collect()
}
