//! Throughput: all indicators of one channel, synchronous averaging, reading of text.
//! `cargo bench -p hums --features io`; the targets are 20 million samples a second on one core for
//! all indicators and 200 MB/s for CSV.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use hums::difference::RemovalRule;
use hums::indicator::{GearAnalyzer, GearWorkspace, SignalKind, signal_indicators};
use hums::resample::Interpolation;
use hums::tachometer::Shaft;
use hums::tsa::{TsaOptions, average};
use std::hint::black_box;
use std::time::Duration;

/// Deterministic rough signal: mesh tone and a linear congruential noise.
fn signal(n: usize) -> Vec<f64> {
    let mut state = 1_u64;
    (0..n)
        .map(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (i as f64 * 0.083).sin() + (state >> 11) as f64 / (1_u64 << 53) as f64
        })
        .collect()
}

fn indicators(c: &mut Criterion) {
    let mut group = c.benchmark_group("indicators");
    group.sample_size(20).measurement_time(Duration::from_secs(2));
    let n = 1 << 20;
    let x = signal(n);
    group.throughput(Throughput::Elements(n as u64));
    group.bench_function("any signal, 1M samples", |b| {
        b.iter(|| signal_indicators(black_box(&x), SignalKind::Raw));
    });
    for samples in [4096, 1 << 16] {
        let average = signal(samples);
        let Ok(analyzer) = GearAnalyzer::new(samples, &RemovalRule::sidebands(27, 1)) else {
            continue;
        };
        group.throughput(Throughput::Elements(samples as u64));
        group.bench_function(format!("all, average of {samples} samples"), |b| {
            b.iter(|| analyzer.analyze(black_box(&average)));
        });
        let mut workspace = GearWorkspace::default();
        group.bench_function(format!("all, average of {samples} samples, in a workspace"), |b| {
            b.iter(|| analyzer.analyze_with(black_box(&average), &mut workspace).is_ok());
        });
    }
    group.finish();
}

fn averaging(c: &mut Criterion) {
    let mut group = c.benchmark_group("synchronous average");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    let n = 1 << 20;
    let x = signal(n);
    group.throughput(Throughput::Elements(n as u64));
    for (name, interpolation) in [
        ("linear", Interpolation::Linear),
        ("cubic spline", Interpolation::CubicSpline),
        ("band-limited", Interpolation::default()),
    ] {
        let options = TsaOptions { interpolation, ..TsaOptions::per_turn(2048) };
        let Ok(shaft) = Shaft::constant(10.0, n, 20_000.0) else {
            continue;
        };
        group.bench_function(name, |b| {
            b.iter(|| average(black_box(&x), 20_000.0, &shaft, &options));
        });
    }
    group.finish();
}

#[cfg(feature = "io")]
fn reading(c: &mut Criterion) {
    use hums::io::text::{TextOptions, TextReader};
    use hums::io::{BlockReader, wav::WavRecording};
    let mut group = c.benchmark_group("reading");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    let x = signal(800_000);
    let short: String = x.chunks(4).map(|r| format!("{:.6},{:.6},{:.6},{:.6}\n", r[0], r[1], r[2], r[3])).collect();
    let long: String = x.chunks(4).map(|r| format!("{},{},{},{}\n", r[0], r[1], r[2], r[3])).collect();
    for (name, text) in [("csv, 7 digits", &short), ("csv, 17 digits", &long)] {
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function(name, |b| {
            b.iter(|| {
                let Ok(mut reader) = TextReader::new(text.as_bytes(), &TextOptions::default()) else {
                    return 0;
                };
                let mut columns = vec![Vec::new(); 4];
                let mut rows = 0;
                while let Ok(count @ 1..) = reader.read_block(1 << 14, &mut columns) {
                    rows += count;
                    columns.iter_mut().for_each(Vec::clear);
                }
                rows
            });
        });
    }
    let mut wav = b"RIFF".to_vec();
    let bytes = 3 * x.len() as u32;
    wav.extend((36 + bytes).to_le_bytes());
    wav.extend(b"WAVEfmt ");
    wav.extend([16, 0, 0, 0, 1, 0, 1, 0]);
    wav.extend(48_000_u32.to_le_bytes());
    wav.extend(144_000_u32.to_le_bytes());
    wav.extend([3, 0, 24, 0]);
    wav.extend(b"data");
    wav.extend(bytes.to_le_bytes());
    for v in &x {
        wav.extend(&((v * 2e6) as i32).to_le_bytes()[..3]);
    }
    group.throughput(Throughput::Bytes(wav.len() as u64));
    group.bench_function("wav, 24 bits", |b| {
        b.iter(|| {
            let Ok(mut reader) = WavRecording::new(wav.as_slice()) else {
                return 0;
            };
            let mut columns = vec![Vec::new()];
            while let Ok(1..) = reader.read_block(1 << 14, &mut columns) {}
            columns[0].len()
        });
    });
    group.finish();
}

#[cfg(not(feature = "io"))]
fn reading(_: &mut Criterion) {}

criterion_group!(benches, indicators, averaging, reading);
criterion_main!(benches);
