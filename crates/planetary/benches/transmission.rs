//! Cost of a step in time and of a position of rest: three planets, bevel stage, a housing of 250 coordinates.
//!
//! `cargo bench -p planetary`.
#![allow(missing_docs)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use planetary::engine::{Load, RunRequest, STAGES, Start, Transmission, Turning};
use support::{equal, whole};

fn run(c: &mut Criterion) -> Result<(), planetary::PlanetaryError> {
    let transmission = Transmission::new(&whole(&equal(3, 0.3), 250))?;
    let carrier_speed = 36.4;
    let load = Load { travelled: 0.2, output_torque: 6106.0, carrier_speed };
    c.bench_function("rest", |b| b.iter(|| transmission.equilibrium(black_box(&load))));
    let request = RunRequest {
        turning: Turning::Steady { carrier_speed, steps_per_cycle: 50 },
        output_torque: 6106.0,
        travelled: 0.0,
        start: Start::Equilibrium,
        settle_steps: 0,
        samples: 0,
        band: None,
        record_motion: false,
        stages: STAGES,
    };
    let mut runner = transmission.start(&request)?;
    c.bench_function("cycle_of_50_steps", |b| b.iter(|| runner.settle(50, &())));
    Ok(())
}

fn benches(c: &mut Criterion) {
    if let Err(error) = run(c) {
        panic!("{error}");
    }
}

criterion_group! {
    name = group;
    config = Criterion::default().sample_size(20).warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(5));
    targets = benches
}
criterion_main!(group);
