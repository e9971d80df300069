//! Cost of one step more or less: integrators, steady state, sweep, continuation.
//!
//! `cargo bench -p lpm`; the work-precision study (`lpm::work_precision`) sets cost against error.
#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use lpm::{
    ContinuationOptions, Curve, Excitation, GearPair, Input, LpmError, Method, Model, Options, Sampling, State,
    SteadyOptions, Supports, SweepOptions, frequencies,
};
use std::hint::black_box;
use std::time::Duration;

fn model(supports: Supports) -> Result<Model, LpmError> {
    let k = Curve::fourier(680e6, &[(-120e6, 30e6), (20e6, 15e6)])?;
    let d = Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6), (-0.4e-6, 0.0)])?;
    let pair = GearPair { damping_when_apart: true, ..GearPair::table_3_2(Input::Prescribed) };
    Model::new(&pair, &Excitation::new(&k, &d)?, supports)
}

fn run(c: &mut Criterion) -> Result<(), LpmError> {
    let (one, three) = (model(Supports::Eliminated)?, model(Supports::Integrated)?);
    let mut group = c.benchmark_group("eight_cycles_with_contact_loss_at_1e-6");
    let start = State { position: [60e-6, 0.0, 0.0], ..State::default() };
    for (name, m, methods) in
        [("one", &one, &Method::ALL[..]), ("three", &three, &[Method::Esdirk, Method::DormandPrince][..])]
    {
        for &method in methods {
            let o = Options { method: Some(method), ..Options::with_tolerance(1e-6) };
            group.bench_function(format!("{name}/{}", method.name()), |b| {
                b.iter(|| m.simulate(1800.0, black_box(&start), 8, &Sampling::default(), &o))
            });
        }
    }
    group.finish();
    c.bench_function("steady_state_1800_hz", |b| {
        b.iter(|| one.steady_state(1800.0, black_box(&start), &SteadyOptions::default()))
    });
    let speeds = frequencies(200.0, 4000.0, 77);
    c.bench_function("sweep_77_speeds", |b| b.iter(|| one.sweep(black_box(&speeds), &SweepOptions::default())));
    let top = one.steady_state(4000.0, &one.equilibrium(0.0), &SteadyOptions::default())?;
    c.bench_function("continuation_200_to_4000_hz", |b| {
        b.iter(|| one.continuation(4000.0, black_box(&top.state), &ContinuationOptions::default()))
    });
    Ok(())
}

fn benches(c: &mut Criterion) {
    if let Err(e) = run(c) {
        eprintln!("{e}");
    }
}

criterion_group! {
    name = all;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
    targets = benches
}
criterion_main!(all);
