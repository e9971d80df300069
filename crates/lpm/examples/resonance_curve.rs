//! Resonance curve of the dissertation's pair: sweeps up and down, and continuation through the turning points.
//!
//! `cargo run --release -p lpm --example resonance_curve [free] [damped-flight] [printed-rule]` prints CSV: method, mesh frequency (Hz), peak to peak (um),
//! RMS (um), fraction of the time without contact, stability.

use lpm::{
    ContinuationOptions, Curve, Excitation, GearPair, Input, LpmError, Model, Separation,
    Stability, Supports, SweepOptions, frequencies,
};
use std::time::Instant;

fn main() -> Result<(), LpmError> {
    let has = |word: &str| std::env::args().any(|a| a == word);
    let free = has("free");
    let input = if free { Input::Free } else { Input::Prescribed };
    // Stiffness and static transmission error alternate between one and two pairs in contact.
    let k = Curve::trapezoidal(534e6, 824e6, 0.2, 0.64, 0.08)?;
    let d = Curve::trapezoidal(18.3e-6, 11.8e-6, 0.2, 0.64, 0.08)?;
    let excitation = Excitation::new(&k, &d)?;
    let mut pair = GearPair {
        damping_when_apart: has("damped-flight"),
        ..GearPair::table_3_2(input)
    };
    if has("printed-rule") {
        pair.separation = Separation::DeflectionVanishes;
    }
    let model = Model::new(&pair, &excitation, Supports::Eliminated)?;
    eprintln!(
        "natural frequency: {:?} to {:?} Hz",
        model.natural_frequencies(0.0),
        model.natural_frequencies(0.5)
    );

    println!("method,mesh_frequency_hz,peak_to_peak_um,rms_um,separated,stable");
    let up = frequencies(
        200.0,
        if free { 9000.0 } else { 4000.0 },
        if free { 177 } else { 77 },
    );
    let down: Vec<f64> = up.iter().rev().copied().collect();
    for (name, speeds) in [("up", &up), ("down", &down)] {
        let clock = Instant::now();
        let points = model.sweep(speeds, &SweepOptions::default())?;
        eprintln!(
            "sweep {name}: {} speeds in {:.1} ms",
            points.len(),
            clock.elapsed().as_secs_f64() * 1e3
        );
        for p in points {
            let m = p.measure;
            let stable = p
                .multiple
                .map_or("aperiodic".to_owned(), |n| format!("period {n}"));
            row(
                name,
                p.mesh_frequency,
                m.peak_to_peak,
                m.rms,
                m.separated_fraction,
                &stable,
            );
        }
    }
    let clock = Instant::now();
    let top = up[up.len() - 1];
    let start = model.steady_state(top, &model.equilibrium(0.0), &Default::default())?;
    let branch = model.continuation(
        top,
        &start.state,
        &ContinuationOptions {
            to: top,
            ..Default::default()
        },
    )?;
    eprintln!(
        "continuation: {} points, {} turning points, {:?}, {} Newton iterations in {:.1} ms",
        branch.points.len(),
        branch.turning_points.len(),
        branch.end,
        branch.iterations,
        clock.elapsed().as_secs_f64() * 1e3
    );
    for p in &branch.points {
        let m = p.measure;
        let kind = if p.stability == Stability::Stable {
            "stable".into()
        } else {
            format!("{:?}", p.stability)
        };
        row(
            "branch",
            p.mesh_frequency,
            m.peak_to_peak,
            m.rms,
            m.separated_fraction,
            &kind,
        );
    }
    for t in &branch.turning_points {
        let p = &t.point;
        eprintln!(
            "turning point ({}): {:.2} Hz, peak to peak {:.2} um, largest multiplier {:.6}",
            if t.is_maximum { "largest" } else { "least" },
            p.mesh_frequency,
            p.measure.peak_to_peak * 1e6,
            p.multipliers[0].re
        );
    }
    Ok(())
}

fn row(name: &str, f: f64, peak_to_peak: f64, rms: f64, separated: f64, stable: &str) {
    println!(
        "{name},{f:.3},{:.5},{:.5},{separated:.4},{stable}",
        peak_to_peak * 1e6,
        rms * 1e6
    );
}
