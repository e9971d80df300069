//! The two contact solvers against each other, against enumeration, and in degenerate cases.

use faer::Mat;
use fecm::lcp::{
    ActiveSetSolver, ContactProblem, ContactSolution, ContactSolver, LcpError, LemkeSolver, SolveStatus, solve_lcp,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

struct Case {
    compliance: Mat<f64>,
    gap: Vec<f64>,
    arm: Vec<f64>,
    load: f64,
}

impl Case {
    fn problem(&self) -> ContactProblem<'_> {
        ContactProblem { compliance: self.compliance.as_ref(), gap: &self.gap, arm: &self.arm, load: self.load }
    }
}

/// Random problems of contact's scales; every third with ties, every fifth nearly rank deficient.
fn random_case(rng: &mut ChaCha8Rng, size: usize, index: usize) -> Case {
    let columns = if index % 5 == 0 { size.div_ceil(2) } else { 2 * size };
    let factor = Mat::from_fn(size, columns, |_, _| rng.random_range(-1.0..1.0));
    let mut compliance = &factor * factor.transpose();
    let scale = 1e-9 * 10_f64.powf(rng.random_range(-2.0..2.0));
    for i in 0..size {
        for j in 0..size {
            compliance[(i, j)] *= scale / columns as f64;
        }
        compliance[(i, i)] += scale * if index % 5 == 0 { 1e-6 } else { 0.05 };
    }
    let mut gap: Vec<f64> = (0..size).map(|_| 1e-5 * rng.random_range(-1.0..1.0)).collect();
    if index % 3 == 0 {
        let value = gap[0];
        gap.iter_mut().step_by(2).for_each(|g| *g = value);
    }
    if index % 7 == 0 {
        gap.iter_mut().for_each(|g| *g = 0.0);
    }
    let arm = (0..size).map(|_| 0.045 * rng.random_range(0.98..1.02)).collect();
    let load = if index % 11 == 0 { 0.0 } else { 10_f64.powf(rng.random_range(-4.0..4.0)) };
    Case { compliance, gap, arm, load }
}

fn assert_same(a: &ContactSolution, b: &ContactSolution, case: &Case, what: &str) {
    assert_eq!(a.status, SolveStatus::Converged, "{what}");
    assert_eq!(b.status, SolveStatus::Converged, "{what}");
    let touch = case.gap.iter().zip(&case.arm).map(|(g, a)| g / a).fold(f64::INFINITY, f64::min);
    let closing = (a.approach - touch).abs().max(1e-300);
    assert!((a.approach - b.approach).abs() <= 1e-10 * closing, "{what}: approach {} {}", a.approach, b.approach);
    let largest = a.forces.iter().fold(0.0_f64, |m, f| m.max(*f));
    for (i, (x, y)) in a.forces.iter().zip(&b.forces).enumerate() {
        assert!((x - y).abs() <= 1e-10 * largest, "{what}: force {i}: {x} against {y} of {largest}");
    }
}

/// `conditioning` multiplies the bounds: rounding errors of a factorisation grow with the condition number.
fn assert_optimal_within(solution: &ContactSolution, conditioning: f64, what: &str) {
    assert!(
        solution.stats.kkt_violation < 1e-11 * conditioning,
        "{what}: KKT violation {}",
        solution.stats.kkt_violation
    );
    assert!(
        solution.stats.complementarity < 1e-10 * conditioning,
        "{what}: complementarity {}",
        solution.stats.complementarity
    );
    assert!(
        solution.stats.load_residual < 1e-12 * conditioning,
        "{what}: load residual {}",
        solution.stats.load_residual
    );
}

fn assert_optimal(solution: &ContactSolution, what: &str) {
    assert_optimal_within(solution, 1.0, what);
}

#[test]
fn invariant_both_solvers_agree_on_thousands_of_problems() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for index in 1..=4000 {
        let size = rng.random_range(1..=28);
        let case = random_case(&mut rng, size, index);
        let fast = ActiveSetSolver::default().solve(&case.problem(), None).unwrap();
        let reference = LemkeSolver::default().solve(&case.problem(), None).unwrap();
        // nearly rank deficient compliances carry their condition number into the forces: compare those by optimality
        if index % 5 != 0 {
            assert_same(&fast, &reference, &case, &format!("problem {index}, {size} cells"));
        }
        let conditioning = if index % 5 == 0 { 1e4 } else { 10.0 };
        assert_optimal_within(&fast, conditioning, &format!("active set, problem {index}"));
        assert_optimal_within(&reference, conditioning, &format!("Lemke, problem {index}"));
    }
}

#[test]
fn invariant_agrees_with_enumeration() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for index in 1..=200 {
        let size = rng.random_range(1..=7);
        let mut case = random_case(&mut rng, size, 1 + 3 * 5 * 7 * 11 * index);
        case.load = case.load.max(0.1);
        let fast = ActiveSetSolver::default().solve(&case.problem(), None).unwrap();
        // the minimum of 1/2 f C f + g f over the faces of the simplex
        let mut best = f64::INFINITY;
        let mut best_forces = vec![];
        for set in 1_u32..1 << size {
            let cells: Vec<usize> = (0..size).filter(|i| set >> i & 1 == 1).collect();
            let k = cells.len();
            let kkt = Mat::from_fn(k + 1, k + 1, |i, j| match (i < k, j < k) {
                (true, true) => case.compliance[(cells[i], cells[j])] * 1e9,
                (true, false) => -case.arm[cells[i]],
                (false, true) => case.arm[cells[j]],
                (false, false) => 0.0,
            });
            let rhs = Mat::from_fn(k + 1, 1, |i, _| if i < k { -case.gap[cells[i]] * 1e9 } else { case.load });
            let solved = faer::linalg::solvers::Solve::solve(&kkt.full_piv_lu(), &rhs);
            if (0..k).any(|i| solved[(i, 0)] < -1e-9) {
                continue;
            }
            let mut forces = vec![0.0; size];
            (0..k).for_each(|i| forces[cells[i]] = solved[(i, 0)]);
            let value: f64 = (0..size)
                .map(|i| {
                    let u: f64 = (0..size).map(|j| case.compliance[(i, j)] * forces[j]).sum();
                    forces[i] * (0.5 * u + case.gap[i])
                })
                .sum();
            if value < best {
                (best, best_forces) = (value, forces);
            }
        }
        let largest = best_forces.iter().fold(0.0_f64, |m, f| m.max(*f));
        for (x, y) in fast.forces.iter().zip(&best_forces) {
            assert!((x - y).abs() < 1e-7 * largest, "problem {index}: {:?} against {best_forces:?}", fast.forces);
        }
    }
}

#[test]
fn invariant_any_warm_start_gives_the_same_answer() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for index in 1..=300 {
        let size = rng.random_range(2..=40);
        let case = random_case(&mut rng, size, 1 + 5 * index);
        let cold = ActiveSetSolver::default().solve(&case.problem(), None).unwrap();
        let warm: Vec<bool> = (0..size).map(|_| rng.random_bool(0.5)).collect();
        let warm = ActiveSetSolver::default().solve(&case.problem(), Some(&warm)).unwrap();
        assert_same(&cold, &warm, &case, &format!("problem {index}"));
    }
}

#[test]
fn invariant_permutation_and_monotonic_load() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for index in 1..=100 {
        let size = 20;
        let mut case = random_case(&mut rng, size, 1 + 5 * 11 * index);
        case.load = 1.0;
        let first = ActiveSetSolver::default().solve(&case.problem(), None).unwrap();
        let turned = Case {
            compliance: Mat::from_fn(size, size, |i, j| case.compliance[(size - 1 - i, size - 1 - j)]),
            gap: case.gap.iter().rev().copied().collect(),
            arm: case.arm.iter().rev().copied().collect(),
            load: case.load,
        };
        let mut second = ActiveSetSolver::default().solve(&turned.problem(), None).unwrap();
        second.forces.reverse();
        assert_same(&first, &second, &case, "reversed");
        let mut last = f64::NEG_INFINITY;
        for load in [0.0, 1e-6, 1e-3, 0.5, 1.0, 30.0, 1e6] {
            case.load = load;
            let approach = ActiveSetSolver::default().solve(&case.problem(), None).unwrap().approach;
            assert!(approach > last, "load {load}: {approach} after {last}");
            last = approach;
        }
    }
}

#[test]
fn analytic_one_and_two_cells() {
    let one = Case { compliance: Mat::from_fn(1, 1, |_, _| 2e-9), gap: vec![3e-6], arm: vec![0.05], load: 10.0 };
    for solver in [&ActiveSetSolver::default() as &dyn ContactSolver, &LemkeSolver::default()] {
        let solution = solver.solve(&one.problem(), None).unwrap();
        assert!((solution.forces[0] - 200.0).abs() < 1e-10);
        assert!((solution.approach - (3e-6 + 200.0 * 2e-9) / 0.05).abs() < 1e-18);
        assert!((solution.tangent.unwrap() - 0.05 * 0.05 / 2e-9).abs() < 1e-6);
        // the second spring touches after the first has closed 1 um: 500 N on it, then both share
        let two = Case {
            compliance: Mat::from_fn(2, 2, |i, j| if i == j { 2e-9 } else { 0.0 }),
            gap: vec![0.0, 1e-6],
            arm: vec![0.05, 0.05],
            load: 0.05 * 700.0,
        };
        let solution = solver.solve(&two.problem(), None).unwrap();
        assert!((solution.forces[0] - 600.0).abs() < 1e-9 && (solution.forces[1] - 100.0).abs() < 1e-9);
    }
}

#[test]
fn extreme_defined_outcomes() {
    let empty = Case { compliance: Mat::zeros(0, 0), gap: vec![], arm: vec![], load: 1.0 };
    let case = Case {
        compliance: Mat::from_fn(3, 3, |i, j| if i == j { 1e-9 } else { 1e-10 }),
        gap: vec![2e-6, 1e-6, 1e-6],
        arm: vec![0.1; 3],
        load: 0.0,
    };
    for solver in [&ActiveSetSolver::default() as &dyn ContactSolver, &LemkeSolver::default()] {
        assert_eq!(solver.solve(&empty.problem(), None).unwrap().status, SolveStatus::NoContact);
        let unloaded = solver.solve(&case.problem(), None).unwrap();
        assert!(unloaded.is_converged() && unloaded.forces == vec![0.0; 3]);
        assert!((unloaded.approach - 1e-5).abs() < 1e-20);
        // loaded exactly until the first cell is about to touch: it carries nothing
        let grazing = Case { load: 2.0 * 0.1 * (0.9e-6 / (1.1e-9 - 1.0 * 1e-10)) / 1.0, ..clone(&case) };
        let solution = solver.solve(&grazing.problem(), None).unwrap();
        assert!(solution.is_converged());
        assert_optimal(&solution, "grazing");
    }
}

fn clone(case: &Case) -> Case {
    Case { compliance: case.compliance.clone(), gap: case.gap.clone(), arm: case.arm.clone(), load: case.load }
}

#[test]
fn extreme_malformed_problems_are_typed_errors() {
    let good = Case { compliance: Mat::identity(2, 2), gap: vec![0.0; 2], arm: vec![1.0; 2], load: 1.0 };
    let solve = |case: &Case| ActiveSetSolver::default().solve(&case.problem(), None).unwrap_err();
    assert!(matches!(solve(&Case { gap: vec![0.0; 3], ..clone(&good) }), LcpError::Size { gaps: 3, .. }));
    assert!(matches!(
        solve(&Case { gap: vec![0.0, f64::NAN], ..clone(&good) }),
        LcpError::Value { what: "gap", cell: 1, .. }
    ));
    assert!(matches!(
        solve(&Case { arm: vec![1.0, -1.0], ..clone(&good) }),
        LcpError::Value { what: "arm", cell: 1, .. }
    ));
    assert!(matches!(solve(&Case { load: -1.0, ..clone(&good) }), LcpError::Load { .. }));
    let indefinite = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { 2.0 });
    assert!(matches!(
        solve(&Case { compliance: indefinite, ..clone(&good) }),
        LcpError::NotPositiveDefinite { cells: 2 }
    ));
}

#[test]
fn analytic_plain_lcp() {
    // Cottle, Pang and Stone (1992), a 2 x 2 example by hand: M = [2 1; 1 2], q = [-5; -6] gives z = (4/3, 7/3), w = 0
    let matrix = Mat::from_fn(2, 2, |i, j| if i == j { 2.0 } else { 1.0 });
    let (z, _) = solve_lcp(matrix.as_ref(), &[-5.0, -6.0]).unwrap();
    assert!((z[0] - 4.0 / 3.0).abs() < 1e-14 && (z[1] - 7.0 / 3.0).abs() < 1e-14);
    // infeasible: w = -1 whatever z
    assert!(solve_lcp(Mat::<f64>::zeros(1, 1).as_ref(), &[-1.0]).is_none());
}
