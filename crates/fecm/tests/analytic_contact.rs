//! Hertz contact and flat punches: contact grid influence and contact solver together, against closed forms
//! (K. L. Johnson, *Contact Mechanics*, 1985). Two equal bodies of steel; one of them rigid for the punches.

use faer::Mat;
use fecm::analytic::{
    circular_punch_indentation, flat_punch_pressure, hertz_line, hertz_point, line_contact_compression,
};
use fecm::halfspace::{rectangle_displacement, strip_displacement};
use fecm::lcp::{ContactProblem, ContactSolution, SolverKind, solve_contact};
use fecm::{FecmError, Material};

const STEEL: Material = Material::STEEL;

/// Both solvers, which must agree; arms of 1 make approach a translation.
fn solve(compliance: &Mat<f64>, gap: &[f64], load: f64) -> Result<ContactSolution, FecmError> {
    let arm = vec![1.0; gap.len()];
    let problem = ContactProblem { compliance: compliance.as_ref(), gap, arm: &arm, load };
    let fast = solve_contact(SolverKind::ActiveSet, &problem, None)?;
    let slow = solve_contact(SolverKind::Lemke, &problem, None)?;
    let scale = fast.forces.iter().fold(0.0_f64, |m, f| m.max(*f));
    for (a, b) in fast.forces.iter().zip(&slow.forces) {
        assert!((a - b).abs() < 1e-9 * scale, "solvers differ: {a} {b}");
    }
    Ok(fast)
}

/// Full width from the second moment of the forces: exact for an elliptic distribution.
fn half_width(x: &[f64], forces: &[f64], cell: f64) -> f64 {
    let sum: f64 = forces.iter().sum();
    let second: f64 = x.iter().zip(forces).map(|(x, f)| f * (x * x + cell * cell / 12.0)).sum();
    2.0 * (second / sum).sqrt()
}

#[test]
fn analytic_hertz_line_contact() {
    let (load, radius, depth) = (300e3, 10e-3, 2e-3);
    let modulus = STEEL.young_modulus / (1.0 - STEEL.poisson_ratio.powi(2)) / 2.0;
    let exact = hertz_line(load, radius, modulus);
    let cell = exact.half_width / 10.0;
    let x: Vec<f64> = (-16..=16).map(|k| f64::from(k) * cell).collect();
    let influence = |d: f64| {
        2.0 * (strip_displacement(&STEEL, true, 0.5 * cell, d, 0.0)
            - strip_displacement(&STEEL, true, 0.5 * cell, d, depth))
    };
    let compliance = Mat::from_fn(x.len(), x.len(), |i, j| influence(x[i] - x[j]));
    let gap: Vec<f64> = x.iter().map(|x| x * x / (2.0 * radius)).collect();
    let solution = solve(&compliance, &gap, load).unwrap();
    let width = half_width(&x, &solution.forces, cell);
    let peak = solution.forces[16] / cell;
    assert!((width / exact.half_width - 1.0).abs() < 0.01, "half width {width} against {}", exact.half_width);
    assert!((peak / exact.peak_pressure - 1.0).abs() < 0.01, "peak {peak} against {}", exact.peak_pressure);
    // the formula takes the depth as much larger than the contact; here their ratio is some 10
    let approach =
        2.0 * line_contact_compression(load, STEEL.young_modulus, STEEL.poisson_ratio, exact.half_width, depth);
    assert!((solution.approach / approach - 1.0).abs() < 0.005, "approach {} against {approach}", solution.approach);
}

#[test]
fn order_hertz_line_contact_converges_with_the_cell() {
    let (load, radius, depth) = (300e3, 10e-3, 2e-3);
    let modulus = STEEL.young_modulus / (1.0 - STEEL.poisson_ratio.powi(2)) / 2.0;
    let exact = hertz_line(load, radius, modulus);
    // approach, and the mean over the contact of the pressure's deviation from Hertz's ellipse
    let with = |cells: i32| {
        let cell = exact.half_width / f64::from(cells);
        let reach = cells * 3 / 2;
        let x: Vec<f64> = (-reach..=reach).map(|k| f64::from(k) * cell).collect();
        let influence = |d: f64| {
            2.0 * (strip_displacement(&STEEL, true, 0.5 * cell, d, 0.0)
                - strip_displacement(&STEEL, true, 0.5 * cell, d, depth))
        };
        let compliance = Mat::from_fn(x.len(), x.len(), |i, j| influence(x[i] - x[j]));
        let gap: Vec<f64> = x.iter().map(|x| x * x / (2.0 * radius)).collect();
        let solution = solve(&compliance, &gap, load).unwrap();
        let ellipse = |x: f64| exact.peak_pressure * (1.0 - (x / exact.half_width).powi(2)).max(0.0).sqrt();
        let deviation: f64 = x.iter().zip(&solution.forces).map(|(x, f)| (f - ellipse(*x) * cell).abs()).sum();
        (solution.approach, deviation / load)
    };
    let ladder = [4, 8, 16, 32].map(with);
    let finest = with(96).0;
    for (approach, _) in ladder {
        assert!((approach / finest - 1.0).abs() < 2e-4, "approach {approach} against {finest}");
    }
    let logs = ladder.map(|(_, error)| error.log2());
    // least-squares slope over x = 0, 1, 2, 3
    let order = -(3.0 * (logs[3] - logs[0]) + (logs[2] - logs[1])) / 10.0;
    assert!(order > 0.9, "order {order} of {ladder:?}");
}

#[test]
fn analytic_hertz_point_contact() {
    let (load, radius) = (200.0, 10e-3);
    let modulus = STEEL.young_modulus / (1.0 - STEEL.poisson_ratio.powi(2)) / 2.0;
    let exact = hertz_point(load, radius, modulus);
    const REACH: i32 = 14;
    let cell = exact.radius / 10.0;
    let places: Vec<(f64, f64)> = (-REACH..=REACH)
        .flat_map(|i| (-REACH..=REACH).map(move |j| (f64::from(i) * cell, f64::from(j) * cell)))
        .collect();
    let compliance = Mat::from_fn(places.len(), places.len(), |i, j| {
        2.0 * rectangle_displacement(
            &STEEL,
            0.5 * cell,
            0.5 * cell,
            places[i].0 - places[j].0,
            places[i].1 - places[j].1,
            0.0,
        )
    });
    let gap: Vec<f64> = places.iter().map(|(x, y)| (x * x + y * y) / (2.0 * radius)).collect();
    let solution = solve(&compliance, &gap, load).unwrap();
    let sum: f64 = solution.forces.iter().sum();
    let second: f64 = places.iter().zip(&solution.forces).map(|((x, _), f)| f * (x * x + cell * cell / 12.0)).sum();
    // for the hemispherical pressure <x^2> = a^2 / 5
    let width = (5.0 * second / sum).sqrt();
    let peak = solution.forces[places.len() / 2] / (cell * cell);
    assert!((width / exact.radius - 1.0).abs() < 0.01, "radius {width} against {}", exact.radius);
    assert!((peak / exact.peak_pressure - 1.0).abs() < 0.01, "peak {peak} against {}", exact.peak_pressure);
    assert!(
        (solution.approach / exact.approach - 1.0).abs() < 0.005,
        "approach {} against {}",
        solution.approach,
        exact.approach
    );
}

#[test]
fn analytic_flat_punch_in_plane() {
    let (load, a, depth) = (100e3, 1e-3, 20e-3);
    const CELLS: usize = 160;
    let cell = 2.0 * a / CELLS as f64;
    let x: Vec<f64> = (0..CELLS).map(|k| (k as f64 + 0.5) * cell - a).collect();
    let influence = |d: f64| {
        strip_displacement(&STEEL, true, 0.5 * cell, d, 0.0) - strip_displacement(&STEEL, true, 0.5 * cell, d, depth)
    };
    let compliance = Mat::from_fn(CELLS, CELLS, |i, j| influence(x[i] - x[j]));
    let solution = solve(&compliance, &[0.0; CELLS], load).unwrap();
    // inside 80 % of the punch: the pressure at its edge is infinite
    for (x, force) in x.iter().zip(&solution.forces).filter(|(x, _)| x.abs() < 0.8 * a) {
        let exact = flat_punch_pressure(load, a, *x);
        assert!((force / cell / exact - 1.0).abs() < 0.01, "at {x}: {} against {exact}", force / cell);
    }
}

#[test]
fn analytic_circular_punch() {
    let (load, a) = (1000.0, 1e-3);
    const REACH: i32 = 16;
    let cell = a / f64::from(REACH);
    let places: Vec<(f64, f64)> = (-REACH..=REACH)
        .flat_map(|i| (-REACH..=REACH).map(move |j| (f64::from(i) * cell, f64::from(j) * cell)))
        .filter(|(x, y)| x.hypot(*y) <= a)
        .collect();
    let compliance = Mat::from_fn(places.len(), places.len(), |i, j| {
        rectangle_displacement(
            &STEEL,
            0.5 * cell,
            0.5 * cell,
            places[i].0 - places[j].0,
            places[i].1 - places[j].1,
            0.0,
        )
    });
    let solution = solve(&compliance, &vec![0.0; places.len()], load).unwrap();
    // the staircase of square cells has the area of a circle of this radius
    let radius = (places.len() as f64 * cell * cell / std::f64::consts::PI).sqrt();
    let exact = circular_punch_indentation(load, radius, STEEL.young_modulus / (1.0 - STEEL.poisson_ratio.powi(2)));
    assert!((solution.approach / exact - 1.0).abs() < 0.01, "{} against {exact}", solution.approach);
}
