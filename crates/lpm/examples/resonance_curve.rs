//! Resonance curve of the dissertation's pair: sweeps up and down in three states of damage, continuation through the
//! turning points, and what each of them costs.
//!
//! `cargo run --release -p lpm --example resonance_curve [free] [undamped-flight]` prints CSV: state, method, mesh frequency
//! (Hz), peak to peak (um), RMS (um), fraction of the time without contact, stability. Summary on standard error.
//!
//! Table 3.2 as printed, pinion rotation prescribed (or free). Mesh stiffness is the rectangular wave that D4.3's
//! natural frequencies imply, 533 and 806 N/um with two pairs in contact over 0.64 of the cycle; static transmission error is that
//! of a linear mesh, `f_0 / k_l`. No number is fitted to the resonance curve. Damaged states, illustrative: stiffness lower by 10 and by 30 %
//! while the damaged tooth is in mesh, once in a rotation of 27 cycles.

use lpm::{
    Branch, ContinuationOptions, Curve, Excitation, GearPair, Input, Interpolation, LpmError, Model, Options, Sampling,
    Stability, SteadyOptions, Supports, SweepOptions, SweepPoint, frequencies,
};
use std::time::Instant;

const STIFFNESS: (f64, f64) = (533e6, 806e6);
const TEETH: usize = 27;

/// The pair with the stiffness of the damaged tooth lowered by the fraction `loss` in mesh cycle 14 of the rotation.
fn model(pair: &GearPair, loss: f64) -> Result<Model, LpmError> {
    let (one, two) = STIFFNESS;
    let f0 = pair.mean_force();
    let stiffness = |s: f64| Curve::rectangular(s * one, s * two, 0.18, 0.64);
    let error = |s: f64| Curve::rectangular(f0 / (s * one), f0 / (s * two), 0.18, 0.64);
    let (mut k, mut delta_0) = (stiffness(1.0)?, error(1.0)?);
    if loss > 0.0 {
        k = k.with_cycles_replaced(TEETH, 14, &stiffness(1.0 - loss)?)?;
        delta_0 = delta_0.with_cycles_replaced(TEETH, 14, &error(1.0 - loss)?)?;
    }
    Model::new(pair, &Excitation::new(&k, &delta_0)?, Supports::Eliminated)
}

fn main() -> Result<(), LpmError> {
    let has = |word: &str| std::env::args().any(|a| a == word);
    let (input, top, count) = if has("free") { (Input::Free, 9000.0, 177) } else { (Input::Prescribed, 4000.0, 77) };
    let pair = GearPair { damping_when_apart: !has("undamped-flight"), ..GearPair::table_3_2(input) };
    let up = frequencies(200.0, top, count);
    let down: Vec<f64> = up.iter().rev().copied().collect();
    println!("state,method,mesh_frequency_hz,peak_to_peak_um,rms_um,separated,stability");

    let healthy = model(&pair, 0.0)?;
    eprintln!(
        "natural frequency {:.1} Hz at one pair, {:.1} Hz at two; damping ratio {:.4}, {:.4}",
        healthy.natural_frequencies(0.0)[0],
        healthy.natural_frequencies(0.5)[0],
        healthy.damping_ratio(0.0),
        healthy.damping_ratio(0.5)
    );

    let mut total = 0.0;
    for (name, loss) in [("healthy", 0.0), ("small", 0.1), ("large", 0.3)] {
        let m = model(&pair, loss)?;
        for (direction, speeds) in [("up", &up), ("down", &down)] {
            let clock = Instant::now();
            let points = m.sweep(speeds, &SweepOptions::default())?;
            let seconds = clock.elapsed().as_secs_f64();
            total += seconds;
            let jump = largest_jump(&points);
            eprintln!(
                "{name}, sweep {direction}: {} speeds in {:.0} ms; largest jump between {:.0} and {:.0} Hz; {} not periodic",
                points.len(),
                seconds * 1e3,
                jump.0,
                jump.1,
                points.iter().filter(|p| p.multiple.is_none()).count()
            );
            for p in &points {
                let kind = p.multiple.map_or("aperiodic".to_owned(), |n| format!("period {n}"));
                row(name, direction, p.mesh_frequency, &p.measure, &kind);
            }
        }
    }
    eprintln!("sweeps up and down, three states: {total:.2} s");
    let clock = Instant::now();
    for loss in [0.0, 0.1, 0.3] {
        let m = smooth(&pair, loss)?;
        for speeds in [&up, &down] {
            m.sweep(speeds, &SweepOptions::default())?;
        }
    }
    eprintln!("the same with spline tables: {:.2} s", clock.elapsed().as_secs_f64());

    let clock = Instant::now();
    let start = healthy.steady_state(top, &healthy.equilibrium(0.0), &SteadyOptions::default())?;
    let options = ContinuationOptions { to: top, ..Default::default() };
    let branch = healthy.continuation(top, &start.state, &options)?;
    report(&branch, clock.elapsed().as_secs_f64());

    for (name, m) in [("rectangular wave", model(&pair, 0.3)?), ("spline tables", smooth(&pair, 0.3)?)] {
        for f in [900.0, 1800.0] {
            rotation(name, &m, f)?;
        }
    }
    Ok(())
}

/// As `model`, by splines through 40 points a cycle of a wave with ramps: what a finite-element run would give.
fn smooth(pair: &GearPair, loss: f64) -> Result<Model, LpmError> {
    let f0 = pair.mean_force();
    let wave = Curve::trapezoidal(STIFFNESS.0, STIFFNESS.1, 0.18, 0.64, 0.15)?;
    let sampled = |of: &dyn Fn(f64) -> f64| {
        let y: Vec<f64> = (0..40).map(|i| of(wave.value(f64::from(i) / 40.0))).collect();
        Curve::samples(1, &y, Interpolation::Spline)
    };
    let s = 1.0 - loss;
    let (mut k, mut delta_0) = (sampled(&|k| k)?, sampled(&|k| f0 / k)?);
    if loss > 0.0 {
        k = k.with_cycles_replaced(TEETH, 14, &sampled(&|k| s * k)?)?;
        delta_0 = delta_0.with_cycles_replaced(TEETH, 14, &sampled(&|k| f0 / (s * k))?)?;
    }
    Model::new(pair, &Excitation::new(&k, &delta_0)?, Supports::Eliminated)
}

/// Error and cost of one rotation of the damaged pair in steady state, from rest.
fn rotation(name: &str, m: &Model, f: f64) -> Result<(), LpmError> {
    let options = |tolerance: f64, steady: f64| SteadyOptions {
        integration: Options::with_tolerance(tolerance),
        tolerance: steady,
        ..Default::default()
    };
    let run = |o: &SteadyOptions| m.steady_response(f, &m.equilibrium(0.0), TEETH, &Sampling::default(), o);
    let exact = run(&options(1e-13, 1e-12))?.response;
    let (mut best, mut error) = (f64::INFINITY, 0.0);
    for _ in 0..20 {
        let clock = Instant::now();
        let r = run(&options(1e-8, 1e-8))?.response;
        best = best.min(clock.elapsed().as_secs_f64());
        error =
            r.transmission_error.iter().zip(&exact.transmission_error).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                / exact.peak_to_peak();
    }
    eprintln!(
        "one rotation, {name}, {f} Hz, rest to sampled steady state: {:.2} ms, relative error {error:.1e}",
        best * 1e3
    );
    Ok(())
}

/// Speeds between which the peak-to-peak value changes by the largest factor.
fn largest_jump(points: &[SweepPoint]) -> (f64, f64) {
    points
        .windows(2)
        .map(|w| {
            let factor = (w[1].measure.peak_to_peak / w[0].measure.peak_to_peak).ln();
            (factor.abs(), (w[0].mesh_frequency, w[1].mesh_frequency))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or((0.0, 0.0), |j| j.1)
}

fn report(branch: &Branch, seconds: f64) {
    eprintln!(
        "continuation: {} points, {:?}, {} Newton iterations in {:.0} ms",
        branch.points.len(),
        branch.end,
        branch.iterations,
        seconds * 1e3
    );
    for p in &branch.points {
        let kind = match p.stability {
            Stability::Stable => "stable".to_owned(),
            other => format!("{other:?}"),
        };
        row("healthy", "branch", p.mesh_frequency, &p.measure, &kind);
    }
    for t in &branch.turning_points {
        let p = &t.point;
        eprintln!(
            "turning point ({}): {:.2} Hz, peak to peak {:.2} um",
            if t.is_maximum { "largest" } else { "least" },
            p.mesh_frequency,
            p.measure.peak_to_peak * 1e6
        );
    }
    for (from, to) in branch.coexistence() {
        eprintln!("two stable solutions from {from:.1} to {to:.1} Hz");
    }
}

fn row(state: &str, method: &str, f: f64, m: &lpm::Measure, kind: &str) {
    println!(
        "{state},{method},{f:.3},{:.5},{:.5},{:.4},{kind}",
        m.peak_to_peak * 1e6,
        m.rms * 1e6,
        m.separated_fraction
    );
}
