//! Contact of bodies held by inertia and springs: both solvers against each other, and the two limits of the coordinates' stiffness.

use faer::Mat;
use fecm::lcp::{
    ContactProblem, FactorMemory, HeldBlock, HeldProblem, HeldSolution, SolverKind, solve_contact, solve_held,
    solve_held_by_lemke,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

struct Block {
    compliance: Mat<f64>,
    motion: Mat<f64>,
    gap: Vec<f64>,
}

struct Case {
    blocks: Vec<Block>,
    stiffness: Mat<f64>,
    load: Vec<f64>,
}

impl Case {
    fn problem(&self) -> HeldProblem<'_> {
        let blocks = (self.blocks.iter())
            .map(|b| HeldBlock { compliance: b.compliance.as_ref(), motion: b.motion.as_ref(), gap: &b.gap })
            .collect();
        HeldProblem { blocks, stiffness: self.stiffness.as_ref(), load: &self.load }
    }

    fn memory(&self) -> Vec<FactorMemory> {
        self.blocks.iter().map(|_| FactorMemory::default()).collect()
    }
}

fn definite(rng: &mut ChaCha8Rng, size: usize, scale: f64) -> Mat<f64> {
    let factor = Mat::from_fn(size, 2 * size, |_, _| rng.random_range(-1.0..1.0));
    let product = &factor * factor.transpose();
    Mat::from_fn(size, size, |i, j| scale * (product[(i, j)] / size as f64 + if i == j { 0.1 } else { 0.0 }))
}

fn random_case(rng: &mut ChaCha8Rng, index: usize) -> Case {
    let coordinates = 1 + index % 4;
    let blocks = (0..1 + index % 3)
        .map(|_| {
            let size = rng.random_range(1..12);
            Block {
                compliance: definite(rng, size, 1e-9),
                motion: Mat::from_fn(size, coordinates, |_, _| rng.random_range(-1.0..1.0)),
                gap: (0..size).map(|_| 1e-5 * rng.random_range(-1.0..1.0)).collect(),
            }
        })
        .collect();
    let scale = 10_f64.powf(rng.random_range(6.0..12.0));
    let load = (0..coordinates).map(|_| 1e4 * rng.random_range(-1.0..1.0)).collect();
    Case { blocks, stiffness: definite(rng, coordinates, scale), load }
}

fn assert_solved(solution: &HeldSolution, what: &str) {
    assert!(solution.converged, "{what}");
    let stats = &solution.stats;
    assert!(stats.kkt_violation < 1e-11, "{what}: KKT {}", stats.kkt_violation);
    assert!(stats.complementarity < 1e-10, "{what}: complementarity {}", stats.complementarity);
    assert!(stats.load_residual < 1e-10, "{what}: coordinates' equation {}", stats.load_residual);
}

#[test]
fn both_solvers_agree_on_random_problems() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut touching = 0;
    for index in 0..2000 {
        let case = random_case(&mut rng, index);
        let fast = solve_held(&case.problem(), &mut case.memory()).unwrap();
        let slow = solve_held_by_lemke(&case.problem(), &mut case.memory()).unwrap();
        assert_solved(&fast, &format!("active set, case {index}"));
        assert_solved(&slow, &format!("Lemke, case {index}"));
        let forces = |s: &HeldSolution| s.forces.concat();
        let largest = forces(&fast).iter().fold(1e-6_f64, |m, f| m.max(*f));
        for (a, b) in forces(&fast).iter().zip(&forces(&slow)) {
            assert!((a - b).abs() < 1e-9 * largest, "case {index}: {a} against {b}");
        }
        touching += usize::from(largest > 1.0);
    }
    assert!(touching > 1000, "only {touching} problems have contact");
}

#[test]
fn memory_of_another_step_changes_nothing() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for index in 0..200 {
        let mut case = random_case(&mut rng, index);
        let mut memory = case.memory();
        let _ = solve_held(&case.problem(), &mut memory).unwrap();
        for load in &mut case.load {
            *load *= -0.7;
        }
        let warm = solve_held(&case.problem(), &mut memory).unwrap();
        let cold = solve_held(&case.problem(), &mut case.memory()).unwrap();
        for (a, b) in warm.coordinates.iter().zip(&cold.coordinates) {
            assert!((a - b).abs() <= 1e-12 * b.abs().max(1e-9), "case {index}");
        }
    }
}

/// A coordinate without stiffness under a load is the static problem; a very stiff one does not move.
#[test]
fn soft_and_stiff_coordinates_are_the_static_problem_and_a_fixed_one() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for index in 0..50 {
        let size = 6;
        let arm: Vec<f64> = (0..size).map(|_| 0.045 * rng.random_range(0.98..1.02)).collect();
        let motion = Mat::from_fn(size, 1, |i, _| -arm[i]);
        let gap: Vec<f64> = (0..size).map(|_| 1e-5 * rng.random_range(0.0..1.0)).collect();
        let block = Block { compliance: definite(&mut rng, size, 1e-9), motion, gap: gap.clone() };
        let torque = 200.0;
        let mut case = Case { blocks: vec![block], stiffness: Mat::from_fn(1, 1, |_, _| 1e-3), load: vec![torque] };
        let free = solve_held(&case.problem(), &mut case.memory()).unwrap();
        let problem =
            ContactProblem { compliance: case.blocks[0].compliance.as_ref(), gap: &gap, arm: &arm, load: torque };
        let still = solve_contact(SolverKind::Lemke, &problem, None).unwrap();
        assert!((free.coordinates[0] / still.approach - 1.0).abs() < 1e-8, "case {index}");
        case.stiffness = Mat::from_fn(1, 1, |_, _| 1e18);
        let held = solve_held(&case.problem(), &mut case.memory()).unwrap();
        assert!(held.coordinates[0].abs() < 1e-15);
        assert!(held.forces[0].iter().all(|f| *f == 0.0), "gaps are open, nothing moves");
    }
}

#[test]
fn no_cells_and_no_contact_are_answers() {
    let stiffness = Mat::from_fn(1, 1, |_, _| 4.0);
    let empty = HeldProblem { blocks: Vec::new(), stiffness: stiffness.as_ref(), load: &[6.0] };
    assert_eq!(solve_held(&empty, &mut []).unwrap().coordinates, vec![1.5]);
    let far =
        Block { compliance: Mat::from_fn(1, 1, |_, _| 1e-9), motion: Mat::from_fn(1, 1, |_, _| -1.0), gap: vec![10.0] };
    let case = Case { blocks: vec![far], stiffness, load: vec![6.0] };
    let solution = solve_held(&case.problem(), &mut case.memory()).unwrap();
    assert!(solution.converged && solution.forces[0][0] == 0.0 && solution.coordinates[0] == 1.5);
}

#[test]
fn malformed_problems_are_refused() {
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let mut case = random_case(&mut rng, 0);
    assert!(solve_held(&case.problem(), &mut []).is_err(), "one memory a block");
    case.load[0] = f64::NAN;
    assert!(solve_held(&case.problem(), &mut case.memory()).unwrap_err().to_string().contains("NaN"));
    let mut case = random_case(&mut rng, 0);
    case.blocks[0].gap[0] = f64::INFINITY;
    assert!(solve_held(&case.problem(), &mut case.memory()).is_err());
    let mut case = random_case(&mut rng, 0);
    case.stiffness = Mat::from_fn(1, 1, |_, _| -1e30);
    assert!(solve_held(&case.problem(), &mut case.memory()).is_err(), "not positive definite");
}
