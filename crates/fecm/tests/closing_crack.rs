//! Crack faces that close: they carry what presses on them, pull nothing, and stay out of the way of a crack that opens.

mod common;

use common::TORQUE;
use common::bodies::{Body, cracked_plate};
use faer::Mat;
use fecm::crack_faces::CrackFaceCells;
use fecm::face::{FaceBasis, Parity};
use fecm::functional::Functional;
use fecm::lcp::{ActiveSetSolver, ContactProblem, ContactSolver, LcpError, LemkeSolver, solve_lcp};
use fecm::statics::{PairModel, PairModelOptions, PositionResult, StaticsRequest};
use fecm::{FaceModel, Material};
use gear_geom::{Damage, FlankSide, RootCrack, ToothDamage};
use nalgebra::{Point2, Vector2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STRESS: f64 = 1e8;
const WIDTH: f64 = 20e-3;

/// A plate with a crack across half of it under tractions on its ends: what the faces do.
struct PressedPlate {
    cells: CrackFaceCells,
    forces: Vec<f64>,
    openings: Vec<f64>,
    /// Openings if the faces did not touch.
    free: Vec<f64>,
    /// How much the corners beyond the crack's mouth come apart without and with contact (m).
    lengthening: [f64; 2],
}

fn press(model: FaceModel, traction: impl Fn(f64) -> f64) -> PressedPlate {
    let basis = FaceBasis::new(model, Parity::Symmetric, 10e-3, &Material::STEEL).unwrap();
    let body: Body = cracked_plate(3, WIDTH, [WIDTH; 2], 0.5 * WIDTH, 0.0);
    let up = |p: Point2<f64>| Vector2::new(0.0, traction(p.x));
    let down = |p: Point2<f64>| Vector2::new(0.0, -traction(p.x));
    let solution = body.solve(&basis, None, &[(1, &up), (0, &down)]);
    let cells = CrackFaceCells::new(&body.mesh, [&body.crack[1], &body.crack[0]], &[&basis]);
    assert!(cells.is_some_and(|cells| cells.row(0).1.y < 0.0), "the first face says which way the normal points");
    let cells = CrackFaceCells::new(&body.mesh, [&body.crack[0], &body.crack[1]], &[&basis]).unwrap();
    let openings = cells.openings(&basis);
    let free: Vec<f64> = openings.iter().map(|w| solution.value(w)).collect();
    let responses: Vec<Mat<f64>> = openings.iter().map(|w| solution.response(w)).collect();
    let compliance = Mat::from_fn(free.len(), free.len(), |i, j| solution.read(&responses[j], &openings[i]));
    // in units of order one
    let (force, length) = (cells.area(0) * STRESS, free.iter().fold(0.0_f64, |m, o| m.max(o.abs())));
    let scaled = Mat::from_fn(free.len(), free.len(), |i, j| compliance[(i, j)] * force / length);
    let constant: Vec<f64> = free.iter().map(|o| o / length).collect();
    let (z, _) = solve_lcp(scaled.as_ref(), &constant).unwrap();
    let forces: Vec<f64> = z.iter().map(|z| z * force).collect();
    let sum = |i: usize| -> f64 { (0..free.len()).map(|j| compliance[(i, j)] * forces[j]).sum() };
    let apart = Functional::new(vec![(body.edges[1][0][0], 1, 1.0), (body.edges[0][0][0], 1, -1.0)]);
    let alone = solution.value(&apart);
    let pushed: f64 = responses.iter().zip(&forces).map(|(moved, force)| solution.read(moved, &apart) * force).sum();
    let openings = (0..free.len()).map(|i| free[i] + sum(i)).collect();
    PressedPlate { cells, forces, openings, free, lengthening: [alone, alone + pushed] }
}

/// A plate under uniform pressure across its crack is a plate without one: every cell carries the pressure on its area, no face parts, and the plate
/// shortens by Hooke's law. The springs that keep the plate from drifting disturb by 1e-9 of its stiffness, twice that of a unit load.
#[test]
fn analytic_closed_crack_under_pressure_is_none() {
    let Material { young_modulus, poisson_ratio, .. } = Material::STEEL;
    for (model, modulus) in [
        (FaceModel::PlaneStress, young_modulus),
        (FaceModel::PlaneStrain, young_modulus / (1.0 - poisson_ratio * poisson_ratio)),
        (FaceModel::Solid { order: 4 }, young_modulus),
    ] {
        let pulled = press(model, |_| STRESS);
        assert!(pulled.forces.iter().all(|&force| force == 0.0) && pulled.openings == pulled.free, "nothing touches");
        let plate = press(model, |_| -STRESS);
        let largest = plate.free.iter().fold(0.0_f64, |m, o| m.max(o.abs()));
        for (cell, (force, opening)) in plate.forces.iter().zip(&plate.openings).enumerate() {
            assert!(plate.free[cell] < 0.0 && opening.abs() < 1e-9 * largest, "{model:?} cell {cell}: {opening} m");
            let pressure = force / plate.cells.area(cell);
            assert!((pressure / STRESS - 1.0).abs() < 1e-5, "{model:?} cell {cell}: {pressure} Pa");
        }
        let exact = -STRESS * 2.0 * WIDTH / modulus;
        let [free, closed] = plate.lengthening;
        assert!((closed / exact - 1.0).abs() < 1e-6, "{model:?}: {closed} against {exact}");
        assert!(free / exact > 1.5, "{model:?}: {free} without contact");
    }
}

/// Under bending and pressure together the mouth parts while the rest closes, and the conditions of contact hold.
#[test]
fn invariant_partly_closed_crack_neither_pulls_nor_overlaps() {
    let plate = press(FaceModel::PlaneStrain, |x| STRESS * (0.25 - 1.25 * x / WIDTH));
    let largest = plate.free.iter().fold(0.0_f64, |m, o| m.max(o.abs()));
    for (force, opening) in plate.forces.iter().zip(&plate.openings) {
        assert!(*force >= 0.0 && *opening > -1e-9 * largest && (*force == 0.0 || opening.abs() < 1e-9 * largest));
    }
    let closed = plate.forces.iter().filter(|&&force| force > 0.0).count();
    assert!(plate.forces[0] == 0.0 && closed > 3 && closed + 3 < plate.forces.len(), "{:?}", plate.forces);
}

/// Cells without arm in random problems: both solvers agree, no condition is broken; and what has no meaning is refused.
#[test]
fn invariant_cells_without_arm() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for index in 0..200 {
        let size = 2 + index % 24;
        let factor = Mat::from_fn(size, 2 * size, |_, _| rng.random_range(-1.0..1.0));
        let mut compliance = &factor * factor.transpose() * faer::Scale(1e-9 / size as f64);
        (0..size).for_each(|i| compliance[(i, i)] += 1e-10);
        let arm: Vec<f64> =
            (0..size).map(|i| if i == 0 || index % 3 > 0 && i % 2 == 0 { 0.045 } else { 0.0 }).collect();
        let gap: Vec<f64> = arm
            .iter()
            .map(
                |&a| if a > 0.0 { rng.random_range(-1e-5..1e-5) } else { f64::max(0.0, rng.random_range(-1e-5..1e-5)) },
            )
            .collect();
        let problem = ContactProblem { compliance: compliance.as_ref(), gap: &gap, arm: &arm, load: 300.0 };
        let warm: Vec<bool> = arm.iter().map(|&a| a == 0.0).collect();
        let fast = ActiveSetSolver::default().solve(&problem, Some(&warm)).unwrap();
        let reference = LemkeSolver::default().solve(&problem, None).unwrap();
        assert!(fast.is_converged() && reference.is_converged());
        assert!(fast.stats.kkt_violation < 1e-9 && fast.stats.load_residual < 1e-12, "{index}: {:?}", fast.stats);
        let largest = fast.forces.iter().fold(0.0_f64, |m, f| m.max(*f));
        for (x, y) in fast.forces.iter().zip(&reference.forces) {
            assert!((x - y).abs() < 1e-9 * largest, "{index}: {x} against {y}");
        }
    }
    let compliance = Mat::<f64>::identity(2, 2);
    let refused = |gap: [f64; 2], arm: [f64; 2]| {
        let problem = ContactProblem { compliance: compliance.as_ref(), gap: &gap, arm: &arm, load: 1.0 };
        ActiveSetSolver::default().solve(&problem, None)
    };
    assert!(matches!(refused([0.0, -1.0], [1.0, 0.0]), Err(LcpError::Value { cell: 1, .. })));
    assert!(matches!(refused([0.0, 1.0], [1.0, -1.0]), Err(LcpError::Value { what: "arm", .. })));
    assert!(!refused([0.0, 0.0], [0.0, 0.0]).unwrap().is_converged(), "nothing to carry the load");
}

/// The first five, and the last three, start from each other.
const CYCLES: [f64; 8] = [-0.7, -0.4, 0.0, 0.15, 0.45, 0.7, 1.2, -1.2];

fn options(face: FaceModel, contact: bool) -> PairModelOptions {
    let mut options = PairModelOptions { face, ..PairModelOptions::default() };
    options.contact.face_cells = 16;
    options.contact.crack_face_contact = contact;
    options
}

fn request() -> StaticsRequest {
    let mesh_cycles = CYCLES.to_vec();
    StaticsRequest::new(mesh_cycles, [TORQUE]).with_stiffness_difference().keeping_pressure()
}

fn solve(model: &PairModel) -> Vec<PositionResult> {
    model.solve(&request(), &()).unwrap().results.remove(0)
}

/// The pair with a 50 % crack on tooth 0 of the pinion, at the fillet of the working flank (`Upper`) or of the other.
fn cracked(face: FaceModel, contact: bool, side: FlankSide) -> PairModel {
    let mut options = options(face, contact);
    options.damage[0] = vec![ToothDamage { tooth: 0, damage: Damage::Crack(RootCrack::along_chord(side, 0.5)) }];
    PairModel::new(&common::pair(25, 31), &options).unwrap()
}

fn ste(position: &PositionResult) -> f64 {
    position.static_transmission_error
}

/// Neither tension nor overlap, forces only where faces touch: relative to what the faces do.
fn assert_contact_conditions(position: &PositionResult) {
    for contact in &position.crack_faces {
        let cells = || contact.force.iter().flatten().zip(contact.opening.iter().flatten());
        let scale = 1e-3 * ste(position);
        for (force, opening) in cells() {
            assert!(*force >= 0.0 && *opening > -1e-9 * scale && (*force == 0.0 || opening.abs() < 1e-9 * scale));
        }
        assert!(contact.total_force() > 0.0 && contact.closed_fraction() > 0.0);
    }
}

/// A crack at the fillet of the idle flank: with its faces in contact the tooth is a little softer than a sound one, for they slide, and much
/// stiffer than with faces that pass through each other. Pressed up to the tip, it has no opening intensity.
#[test]
fn invariant_crack_on_the_coast_side_closes() {
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let sound = solve(&PairModel::new(&common::pair(25, 31), &options(face, true)).unwrap());
        let overlapping = cracked(face, false, FlankSide::Lower);
        let touching = cracked(face, true, FlankSide::Lower);
        let (free, closed) = (solve(&overlapping), solve(&touching));
        let (free_tips, tips) = (overlapping.crack_tip_reader(), touching.crack_tip_reader());
        for ((sound, free), closed) in sound.iter().zip(&free).zip(&closed) {
            let at = closed.mesh_cycle;
            assert_contact_conditions(closed);
            let share = closed.pairs.iter().find(|pair| pair.pair == 0).map_or(0.0, |pair| pair.share);
            if share < 0.3 {
                continue;
            }
            let (without, with) = (ste(free) / ste(sound) - 1.0, ste(closed) / ste(sound) - 1.0);
            assert!(
                without > 0.03 && with > 0.0 && with < 0.4 * without,
                "{face:?} {at}: {without} free, {with} closed"
            );
            let slopes = [sound, closed, free].map(|position| position.local_stiffness().unwrap());
            assert!(slopes[0] > slopes[1] && slopes[1] > slopes[2], "{face:?} {at}: {slopes:?}");
            let largest =
                |tips: Vec<fecm::statics::CrackTip>| tips.iter().fold(0.0_f64, |m, tip| m.max(tip.k_one.abs()));
            let [open, shut] = [largest(free_tips.read(free).unwrap()), largest(tips.read(closed).unwrap())];
            assert!(shut < 0.05 * open, "{face:?} {at}: K_I {open} free, {shut} closed");
        }
    }
}

/// Faces that part: as without contact, to the bit.
#[test]
fn invariant_crack_that_opens_is_as_without_contact() {
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let [free, touching] = [false, true].map(|contact| solve(&cracked(face, contact, FlankSide::Upper)));
        assert_eq!(free[..5], touching[..5]);
        // loads on neighbours close the crack by some nanometres
        for (free, touching) in free.iter().zip(&touching) {
            assert_contact_conditions(touching);
            assert!((ste(free) / ste(touching) - 1.0).abs() < 1e-5, "{}", free.mesh_cycle);
        }
    }
}

/// Openings as the contact problem sees them are those of the whole gear's displacement, recovered from the loads.
#[test]
fn invariant_recovered_displacement_has_the_openings() {
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let [overlap, rest] = [false, true].map(|contact| {
            let model = cracked(face, contact, FlankSide::Lower);
            let results = solve(&model);
            let position = results.iter().find(|r| r.mesh_cycle == 0.0).unwrap();
            let body = &model.bodies()[0];
            let field = model.deformation(position, 0).unwrap();
            let shape = &body.sector(0).shape;
            let crack = shape.crack.as_ref().unwrap();
            let bases: Vec<&FaceBasis> = body.families.iter().map(|family| &family.basis).collect();
            let cells = CrackFaceCells::new(&shape.mesh, [&crack.nodes[0], &crack.nodes[1]], &bases).unwrap();
            let openings = (0..cells.along.len()).flat_map(|row| {
                let (nodes, normal) = cells.row(row);
                let at = |node: u32, z: f64| field.at(body, 0, node as usize, z).xy();
                let faces = cells.face.clone().into_iter();
                faces.map(move |z| normal.dot(&(at(nodes[0], z) - at(nodes[1], z)))).collect::<Vec<_>>()
            });
            openings.fold(0.0_f64, |m, opening| m.max(-opening))
        });
        assert!(overlap > 5e-6 && rest < 1e-9 * overlap, "{face:?}: {overlap} m without contact, {rest} m with it");
    }
}

#[test]
fn invariant_threads_do_not_change_a_bit() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&cracked(FaceModel::Solid { order: 4 }, true, FlankSide::Lower)))
    };
    assert_eq!(on(1), on(3));
}
