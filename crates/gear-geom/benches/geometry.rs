//! Time of a gear from its specification, of points of its flank, and of a pair.
//!
//! `cargo bench -p gear-geom`
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use gear_geom::{FlankSide, Gear, GearPair, GearSpec, Member};

fn geometry(criterion: &mut Criterion) {
    let spec = GearSpec::standard(27, 3e-3);
    let ring = GearSpec::standard_ring(99, 3e-3);
    criterion.bench_function("gear: rack fillet", |b| b.iter(|| Gear::new(black_box(&spec))));
    criterion.bench_function("gear: ring, circular fillet", |b| b.iter(|| Gear::new(black_box(&ring))));
    // 10 teeth are undercut: the crossing of trochoid and involute is searched
    let undercut = GearSpec::standard(10, 3e-3);
    criterion.bench_function("gear: undercut", |b| b.iter(|| Gear::new(black_box(&undercut))));
    let (Ok(pinion), Ok(wheel)) = (Gear::new(&spec), Gear::new(&GearSpec::standard(35, 3e-3))) else { return };
    criterion.bench_function("flank: point and normal", |b| {
        b.iter(|| {
            let roll = black_box(0.014);
            (pinion.flank_point(FlankSide::Upper, roll), pinion.flank_normal(FlankSide::Upper, roll))
        });
    });
    criterion.bench_function("gear: mass and inertia", |b| b.iter(|| black_box(&pinion).inertia(7850.0)));
    criterion.bench_function("pair: checks", |b| {
        b.iter(|| GearPair::new(pinion.clone(), wheel.clone(), black_box(93.2e-3)));
    });
    let Ok(pair) = GearPair::new(pinion.clone(), wheel.clone(), 93.2e-3) else { return };
    criterion.bench_function("pair: landmarks", |b| b.iter(|| black_box(&pair).landmarks(Member::Pinion)));
}

criterion_group!(benches, geometry);
criterion_main!(benches);
