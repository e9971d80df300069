//! Cracked and pitted teeth.

mod common;

use common::{TORQUE, gear};
use faer::Mat;
use fecm::body::ring::RingCompliance;
use fecm::condense::{CondensedBody, Substructure};
use fecm::element::lagrange::{LagrangeBasis, gauss_rule};
use fecm::face::{FaceBasis, Parity};
use fecm::mesh::blocks::{BlockMesher, Edge, geometric_breaks};
use fecm::mesh::{MeshDensity, SectorMesh};
use fecm::ring::{Arc, ring_compliance};
use fecm::statics::{PairModel, PairModelOptions, PositionResult, PositionStatus, StaticsRequest};
use fecm::{FaceModel, FecmError, Material};
use gear_geom::{
    BrokenCorner, CrackLength, CrackPath, CrackStart, Damage, FlankSide, Gear, GearPair, MeasuredDeviation, Member,
    Pit, ProfileMeasure, RootCrack, ToothDamage,
};
use nalgebra::Point2;

fn pair() -> GearPair {
    common::pair(25, 31)
}

fn options(face: FaceModel) -> PairModelOptions {
    let mut options = PairModelOptions { face, ..PairModelOptions::default() };
    options.contact.face_cells = 16;
    options
}

fn crack(tooth: i64, fraction: f64) -> ToothDamage {
    ToothDamage { tooth, damage: Damage::Crack(RootCrack::along_chord(FlankSide::Upper, fraction)) }
}

/// Heights in roll distance.
fn ellipse(face: f64, roll: f64, width: f64, height: f64) -> Pit {
    Pit::ellipse(face, roll, width, height, ProfileMeasure::RollDistance)
}

fn pit(tooth: i64, pit: Pit) -> ToothDamage {
    ToothDamage { tooth, damage: Damage::Pit(pit) }
}

/// The same depth all over the flank of tooth 0.
fn wear(depth: f64) -> ToothDamage {
    let table = MeasuredDeviation { roll: vec![0.0], face: vec![0.0], removed: vec![vec![depth]] };
    ToothDamage { tooth: 0, damage: Damage::Wear(table) }
}

fn corner(at_positive_end: bool, length: f64, height: f64) -> ToothDamage {
    let corner = BrokenCorner::new(&gear(25), at_positive_end, length, height);
    ToothDamage { tooth: 0, damage: Damage::BrokenCorner(corner) }
}

fn request(mesh_cycles: &[f64]) -> StaticsRequest {
    StaticsRequest::new(mesh_cycles.to_vec(), [TORQUE]).keeping_pressure()
}

fn solve(model: &PairModel, mesh_cycles: &[f64]) -> Vec<PositionResult> {
    model.solve(&request(mesh_cycles), &()).unwrap().results.remove(0)
}

const CYCLES: [f64; 8] = [-1.2, -0.7, -0.4, 0.0, 0.15, 0.45, 0.7, 1.2];

#[test]
fn invariant_damage_of_no_size_is_healthy_to_the_bit() {
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let healthy = PairModel::new(&pair(), &options(face)).unwrap();
        let nothing = [
            vec![
                crack(0, 0.0),
                pit(1, Pit { shapes: vec![], depth: None }),
                corner(true, 0.0, 3e-3),
                corner(true, 3e-3, 0.0),
            ],
            vec![],
        ];
        let undamaged = healthy.with_damage(&nothing).unwrap();
        assert_eq!(solve(&healthy, &CYCLES), solve(&undamaged, &CYCLES));
    }
}

#[test]
fn invariant_wear_all_over_a_flank_is_a_pitch_error() {
    let depth = 6e-6;
    let errors: Vec<f64> = (0..25).map(|tooth| if tooth == 0 { depth } else { 0.0 }).collect();
    let spec = gear(25).spec().clone().with(|spec| {
        spec.pitch_errors = errors;
    });
    let erroneous = GearPair::new(Gear::new(&spec).unwrap(), gear(31), pair().centre_distance()).unwrap();
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let healthy = PairModel::new(&pair(), &options(face)).unwrap();
        let sound = solve(&healthy, &CYCLES);
        let expected = solve(&PairModel::new(&erroneous, &options(face)).unwrap(), &CYCLES);
        let ste = |r: &PositionResult| r.static_transmission_error;
        for (worn, expected) in
            solve(&healthy.with_damage(&[vec![wear(depth)], vec![]]).unwrap(), &CYCLES).iter().zip(&expected)
        {
            // first touch of both is found by search, to 1e-12 m
            assert!((ste(worn) - ste(expected)).abs() < 1e-11, "{}", worn.mesh_cycle);
        }
        assert!(expected.iter().zip(&sound).any(|(worn, sound)| ste(worn) > ste(sound) + 0.3 * depth), "wear is felt");
        for (nothing, sound) in
            solve(&healthy.with_damage(&[vec![wear(0.0)], vec![]]).unwrap(), &CYCLES).iter().zip(&sound)
        {
            assert!((ste(nothing) - ste(sound)).abs() < 1e-11, "{}", nothing.mesh_cycle);
        }
    }
}

#[test]
fn invariant_broken_corner_carries_nothing_and_either_end_is_alike() {
    let healthy = PairModel::new(&pair(), &options(FaceModel::Solid { order: 5 })).unwrap();
    let cycles = [-0.2, 0.2, 0.4, 0.6, 0.8];
    let sound = solve(&healthy, &cycles);
    let [one, other] = [true, false]
        .map(|end| solve(&healthy.with_damage(&[vec![corner(end, 6e-3, 3e-3)], vec![]]).unwrap(), &cycles));
    let missing = BrokenCorner::new(&gear(25), true, 6e-3, 3e-3);
    let mut most = 0.0_f64;
    for ((one, other), sound) in one.iter().zip(&other).zip(&sound) {
        let ratio = one.static_transmission_error / other.static_transmission_error;
        assert!((ratio - 1.0).abs() < 1e-9, "{}: {ratio}", one.mesh_cycle);
        let increase = one.static_transmission_error / sound.static_transmission_error - 1.0;
        // starts differ from those of the sound pair: the rotation settles to 1e-5
        assert!(increase > -2e-5, "{}: {increase}", one.mesh_cycle);
        most = most.max(increase);
        for patch in one.patches.iter().filter(|patch| patch.pair == 0) {
            for (roll, row) in patch.pinion_roll.iter().zip(&patch.pressure) {
                for (z, pressure) in patch.face.iter().zip(row) {
                    assert!(*pressure == 0.0 || !missing.contains(*z, *roll));
                }
            }
        }
    }
    assert!(most > 0.005, "a corner of a third of the face is felt: {most}");
}

/// Positions that flank damage leaves alone are taken over from the sound pair; the others are those of a solution of its own.
#[test]
fn invariant_solved_from_the_sound_pair() {
    let healthy = PairModel::new(&pair(), &options(FaceModel::Solid { order: 4 })).unwrap();
    let cycles: Vec<f64> = (0..24).map(|k| -1.2 + 0.1 * f64::from(k)).collect();
    let request = request(&cycles);
    let sound = healthy.solve(&request, &()).unwrap();
    let roll = pair().pitch_roll();
    let whole_face = pit(0, ellipse(0.0, roll, 9e-3, 2e-3));
    let edge = pit(0, ellipse(8e-3, roll, 9e-3, 2e-3));
    for (damage, must_take_over) in [(whole_face, true), (edge, true), (crack(0, 0.4), false)] {
        let damaged = healthy.with_damage(&[vec![damage.clone()], vec![]]).unwrap();
        let own = damaged.solve(&request, &()).unwrap();
        let helped = damaged.solve_from(&request, (&healthy, &sound), &()).unwrap();
        let mut taken = 0;
        for ((own, helped), sound) in own.results[0].iter().zip(&helped.results[0]).zip(&sound.results[0]) {
            let ratio = helped.static_transmission_error / own.static_transmission_error;
            // other starts: the rotation settles to 1e-5, cells of another size move the rim of a pit: 5.1e-4 at most, for the whole face
            assert!((ratio - 1.0).abs() < 6e-4, "{damage:?} at {}: {ratio}", own.mesh_cycle);
            // pressures of all positions are those of one face
            assert_eq!(helped.patches[0].face, own.patches[0].face);
            if helped.stats.solver.solves == 0 {
                taken += 1;
                assert_eq!(helped.static_transmission_error, sound.static_transmission_error);
                assert_eq!(helped.pairs, sound.pairs);
                let alike = own.patches[0].cell == sound.patches[0].cell;
                assert!(!alike || (ratio - 1.0).abs() < 2e-5, "{damage:?} at {}: {ratio}", own.mesh_cycle);
            } else if must_take_over {
                let carries = sound.loaded_pairs().any(|loaded| loaded.pair == 0);
                assert!(carries, "solved again without need at {}", own.mesh_cycle);
            }
        }
        assert_eq!(taken > 8, must_take_over, "{damage:?}: {taken} taken over");
        let again = damaged.solve_from(&request, (&healthy, &sound), &()).unwrap();
        assert_eq!(helped.results, again.results);
        // other requests are not answered by this one
        let asks_more = StaticsRequest { stiffness_difference: true, ..request.clone() };
        let asked = damaged.solve_from(&asks_more, (&healthy, &sound), &()).unwrap();
        assert!(asked.results[0].iter().all(|at| at.stats.solver.solves > 0));
    }
}

/// A model derived from a healthy one is the model made anew.
#[test]
fn invariant_derived_model_equals_the_one_made_anew() {
    let damage = [vec![crack(0, 0.4), pit(0, ellipse(0.0, 0.026, 6e-3, 3e-3))], vec![crack(30, 0.2)]];
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let healthy = PairModel::new(&pair(), &options(face)).unwrap();
        let derived = healthy.with_damage(&damage).unwrap();
        let anew = PairModel::new(&pair(), &PairModelOptions { damage: damage.clone(), ..options(face) }).unwrap();
        assert_eq!(solve(&derived, &CYCLES), solve(&anew, &CYCLES));
    }
}

/// Low-rank update of the healthy ring against closing a ring that has the damaged sectors in it.
#[test]
fn invariant_damaged_ring_closed_directly() {
    let gear = gear(25);
    let basis = FaceBasis::new(FaceModel::Solid { order: 3 }, Parity::Symmetric, 16e-3, &Material::STEEL).unwrap();
    let density = MeshDensity { order: 2, density: 0.7 };
    let stiffness = |crack: Option<RootCrack>| {
        let sector = SectorMesh::with_crack(&gear, &density, crack.as_ref(), "gear").unwrap();
        CondensedBody::new(&sector.substructure(None), &basis).unwrap().stiffness().clone()
    };
    let healthy = stiffness(None);
    let cracked = stiffness(Some(RootCrack::along_chord(FlankSide::Upper, 0.6)));
    let other = stiffness(Some(RootCrack::along_chord(FlankSide::Lower, 0.3)));
    let ring = RingCompliance::healthy(&healthy, 25, 3).unwrap();
    let ring = ring.with_damage(&healthy, &[(0, &cracked), (2, &other)], 5).unwrap();
    let arcs: Vec<Arc> = (0..25)
        .map(|tooth| {
            Arc::of_sector(if tooth == 0 {
                &cracked
            } else if tooth == 2 {
                &other
            } else {
                &healthy
            })
        })
        .collect();
    let direct = ring_compliance(&arcs).unwrap();
    let n = healthy.nrows() / 2;
    for (a, b) in [(0, 0), (1, 0), (0, 2), (2, 2), (24, 1), (3, 3), (22, 0)] {
        let pair = ring.pair(a, b);
        let cut = |tooth: i32, row: usize| ((tooth as usize + row / n) % 25) * n + row % n;
        let exact = Mat::from_fn(2 * n, 2 * n, |i, j| direct[(cut(a, i), cut(b, j))]);
        let scale = (0..2 * n).map(|i| direct[(cut(a, i), cut(a, i))]).fold(0.0, f64::max);
        for j in 0..2 * n {
            for i in 0..2 * n {
                assert!((pair[(i, j)] - exact[(i, j)]).abs() < 1e-9 * scale, "sectors {a} {b}");
            }
        }
    }
}

#[test]
fn invariant_longer_cracks_are_softer_and_only_where_their_tooth_is_in_mesh() {
    let healthy = PairModel::new(&pair(), &options(FaceModel::Solid { order: 4 })).unwrap();
    let mut last = solve(&healthy, &CYCLES);
    let reference = last.clone();
    for fraction in [0.01, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95] {
        let cracked = solve(&healthy.with_damage(&[vec![crack(0, fraction)], vec![]]).unwrap(), &CYCLES);
        for ((now, before), healthy) in cracked.iter().zip(&last).zip(&reference) {
            assert_eq!(now.status, PositionStatus::Converged, "{fraction} {}", now.mesh_cycle);
            let growth = now.static_transmission_error / before.static_transmission_error - 1.0;
            // mesh changes with the crack: discretisation moves the answer by some 1e-4
            assert!(growth > -3e-4, "{fraction} at {}: {growth}", now.mesh_cycle);
            let change = now.static_transmission_error / healthy.static_transmission_error - 1.0;
            let engaged = now.pairs.iter().any(|p| p.pair == 0 && p.force > 0.0);
            if !engaged {
                assert!(change.abs() < 0.02 * fraction, "{fraction} at {}: {change}", now.mesh_cycle);
            }
        }
        last = cracked;
    }
    let at_pitch = |results: &[PositionResult]| results[3].static_transmission_error;
    assert!(at_pitch(&last) > 2.0 * at_pitch(&reference), "95 % of the chord is gone");
}

/// D3.2.4.2.3: a pit on the pinion's or on the gear's flank opposite it makes the same transmission error.
#[test]
fn invariant_pit_on_either_flank() {
    let pair = pair();
    let model = PairModel::new(&pair, &options(FaceModel::Solid { order: 4 })).unwrap();
    let roll = pair.pitch_roll();
    let opposite = pair.partner_roll(Member::Pinion, roll);
    let on_pinion = model.with_damage(&[vec![pit(0, ellipse(0.0, roll, 9e-3, 3e-3))], vec![]]).unwrap();
    let on_gear = model.with_damage(&[vec![], vec![pit(0, ellipse(0.0, opposite, 9e-3, 3e-3))]]).unwrap();
    for (a, b) in solve(&on_pinion, &[-0.05, 0.0, 0.05, 0.1]).iter().zip(&solve(&on_gear, &[-0.05, 0.0, 0.05, 0.1])) {
        let difference = a.static_transmission_error / b.static_transmission_error - 1.0;
        // the pit's rim falls between other cells
        assert!(difference.abs() < 5e-3, "{}: {difference}", a.mesh_cycle);
    }
    let healthy = solve(&model, &[0.0])[0].static_transmission_error;
    assert!(solve(&on_pinion, &[0.0])[0].static_transmission_error > 1.02 * healthy);
}

#[test]
fn extreme_pits() {
    let pair = pair();
    let model = PairModel::new(&pair, &options(FaceModel::Solid { order: 4 })).unwrap();
    let roll = pair.pitch_roll();
    let landmarks = pair.landmarks(Member::Pinion);
    // the whole flank: the neighbours carry everything while they can reach
    let whole = ellipse(0.0, roll, 1.0, 1.0);
    let results = solve(&model.with_damage(&[vec![pit(0, whole)], vec![]]).unwrap(), &[-0.45, 0.45]);
    for at in &results {
        assert_eq!(at.status, PositionStatus::Converged);
        assert!(at.pairs.iter().all(|p| p.pair != 0 || p.force == 0.0), "{:?}", at.pairs);
        assert!((at.pairs.iter().map(|p| p.share).sum::<f64>() - 1.0).abs() < 1e-12);
    }
    for one in [
        // smaller than a cell, at the tip, at the end of the face, beyond it, of some depth
        ellipse(0.0, roll, 1e-5, 1e-5),
        ellipse(0.0, landmarks.eap.roll_distance, 5e-3, 2e-3),
        ellipse(8e-3, roll, 5e-3, 2e-3),
        ellipse(9e-3, roll, 5e-3, 2e-3),
        Pit { depth: Some(5e-6), ..ellipse(0.0, roll, 5e-3, 2e-3) },
    ] {
        let damaged = model.with_damage(&[vec![pit(0, one.clone())], vec![]]).unwrap();
        for at in solve(&damaged, &[-0.3, 0.0, 0.3, 0.6]) {
            assert_eq!(at.status, PositionStatus::Converged, "{one:?}");
            assert!(at.stats.torque_residual < 1e-9 && at.stats.solver.kkt_violation < 1e-9);
        }
    }
}

/// Crowned flanks with a pit on the crest touch first at the pit's rim: the crown's depth there, no matter where cells lie.
#[test]
fn analytic_first_touch_of_a_crown_with_a_pit() {
    let crown = 30e-6;
    let crowned = |teeth| {
        let mut spec = gear(teeth).spec().clone();
        spec.modification.lead_crown = crown;
        Gear::new(&spec).unwrap()
    };
    let pair = GearPair::new(crowned(25), crowned(31), pair().centre_distance()).unwrap();
    let model = PairModel::new(&pair, &options(FaceModel::Solid { order: 4 })).unwrap();
    let half = 0.5 * pair.pinion().facewidth();
    for width in [3e-3, 5e-3, 7.3e-3] {
        let damaged = model.with_damage(&[vec![pit(0, ellipse(0.0, pair.pitch_roll(), width, 6e-3))], vec![]]).unwrap();
        let light = StaticsRequest { torques: vec![1e-3 * TORQUE], ..request(&[0.0]) };
        let at = &damaged.solve(&light, &()).unwrap().results[0][0];
        // at the pitch point the rim is half the pit's width from mid-face; wheel and pinion are alike there
        let exact = 2.0 * crown * (0.5 * width / half).powi(2);
        let no_load = at.no_load_transmission_error;
        assert!((no_load / exact - 1.0).abs() < 1e-4, "{width}: {no_load:.4e} {exact:.4e}");
        assert!(at.static_transmission_error > no_load, "{width}: load opens the teeth");
    }
}

#[test]
fn extreme_several_damages() {
    let model = PairModel::new(&pair(), &options(FaceModel::Solid { order: 4 })).unwrap();
    let roll = pair().pitch_roll();
    let together = [
        vec![crack(0, 0.5), pit(0, ellipse(0.0, roll, 6e-3, 2e-3)), crack(1, 0.3), crack(-1, 0.2)],
        vec![crack(0, 0.4), pit(1, ellipse(2e-3, roll, 6e-3, 2e-3))],
    ];
    let healthy = solve(&model, &CYCLES);
    for (at, healthy) in solve(&model.with_damage(&together).unwrap(), &CYCLES).iter().zip(&healthy) {
        assert_eq!(at.status, PositionStatus::Converged);
        assert!(at.static_transmission_error > 0.999 * healthy.static_transmission_error);
    }
}

/// A path through points (mm).
fn through(points: &[[f64; 2]]) -> CrackPath {
    CrackPath::Through(points.iter().map(|point| point.map(|value| value * 1e-3)).collect())
}

/// A path through points of a line is that line; through points of an arc, of a length between those of the chords and of the tangents, it gives the same
/// transmission error whether it is told by few points or by many.
#[test]
fn invariant_crack_paths() {
    let model = PairModel::new(&pair(), &options(FaceModel::PlaneStrain)).unwrap();
    let error = |path: CrackPath, length: f64| {
        let length = CrackLength::Length(length);
        let crack = RootCrack { path, length, ..RootCrack::along_chord(FlankSide::Upper, 0.3) };
        let damage = ToothDamage { tooth: 0, damage: Damage::Crack(crack) };
        let damaged = model.with_damage(&[vec![damage], vec![]]).unwrap();
        solve(&damaged, &[0.2])[0].static_transmission_error
    };
    let angle = 70_f64.to_radians();
    let at = |along: f64| [along * angle.sin(), along * angle.cos()];
    let straight = error(CrackPath::Straight(angle), 3e-3);
    let told = error(through(&[at(0.7), at(1.6), at(4.0)]), 3e-3);
    assert!((told / straight - 1.0).abs() < 1e-6, "{told} {straight}");
    let arc = |angle: f64| [4.0 * angle.sin(), 4.0 * (1.0 - angle.cos())];
    let points =
        |count: i32| -> Vec<[f64; 2]> { (1..=count).map(|k| arc(0.8 * f64::from(k) / f64::from(count))).collect() };
    let [few, many] = [4, 16].map(|count| error(through(&points(count)), 3e-3));
    assert!((few / many - 1.0).abs() < 1e-4, "{few} {many}");
    assert!((few / straight - 1.0).abs() > 1e-3, "paths matter: {few} {straight}");
}

#[test]
fn impossible_cracks_are_explained() {
    let model = PairModel::new(&pair(), &options(FaceModel::PlaneStrain)).unwrap();
    let with = |crack: RootCrack| {
        let damage = ToothDamage { tooth: 0, damage: Damage::Crack(crack) };
        model.with_damage(&[vec![damage], vec![]]).map(|_| ())
    };
    let usual = RootCrack::along_chord(FlankSide::Upper, 0.3);
    for crack in [
        RootCrack { length: CrackLength::Chord(1.2), ..usual.clone() },
        RootCrack { length: CrackLength::Length(0.5), ..usual.clone() },
        RootCrack { length: CrackLength::Length(f64::NAN), ..usual.clone() },
        RootCrack { start: CrackStart::Tangent(0.01), ..usual.clone() },
        RootCrack { start: CrackStart::Radius(1.0), ..usual.clone() },
        RootCrack { path: CrackPath::Straight(-0.5), ..usual.clone() },
        RootCrack { path: through(&[[1.0, 0.2], [0.5, 0.4], [2.0, 0.6]]), ..usual.clone() },
        RootCrack { path: through(&[[1.0, 0.2], [1.0, 0.2]]), ..usual.clone() },
        RootCrack { path: through(&[[0.3, 0.1]]), length: CrackLength::Path(20.0), ..usual.clone() },
    ] {
        assert!(matches!(with(crack.clone()), Err(FecmError::Crack { .. })), "{crack:?}");
    }
    for crack in [
        RootCrack { start: CrackStart::Tangent(30_f64.to_radians()), ..usual.clone() },
        RootCrack {
            path: CrackPath::Straight(60_f64.to_radians()),
            length: CrackLength::Length(2e-3),
            ..usual.clone()
        },
        RootCrack { side: FlankSide::Lower, ..usual.clone() },
        RootCrack {
            path: through(&[[1.0, 0.2], [2.0, 0.6], [3.0, 1.4]]),
            length: CrackLength::Length(2.5e-3),
            ..usual.clone()
        },
        RootCrack { path: through(&[[1.0, 0.2], [2.0, 0.6]]), length: CrackLength::Path(0.7), ..usual.clone() },
    ] {
        with(crack).unwrap();
    }
    let two = [vec![crack(3, 0.1), crack(28, 0.2)], vec![]];
    assert!(matches!(model.with_damage(&two), Err(FecmError::Crack { .. })), "tooth 28 is tooth 3");
}

/// Stress-intensity factor of a plate with an edge crack under tension, from the energy it releases: `K^2 = E' G`, `G = dU/da` at constant
/// load. Cracks are doubled nodes between two blocks, as in a tooth. Closed form `K = sigma sqrt(pi a) F(a / b)` of H. Tada, P. C. Paris and
/// G. R. Irwin, *The Stress Analysis of Cracks Handbook*, section 2.11 (within 0.5 % for any `a / b`).
#[test]
fn peer_tada_edge_cracked_plate() {
    let (young, poisson) = (Material::STEEL.young_modulus, Material::STEEL.poisson_ratio);
    let width = 20e-3;
    for ratio in [0.2, 0.4, 0.6] {
        let crack = ratio * width;
        let step = 0.01 * crack;
        let release = (plate_energy(width, crack + step) - plate_energy(width, crack - step)) / (2.0 * step);
        let computed = (release * young / (1.0 - poisson * poisson)).sqrt();
        let angle = 0.5 * std::f64::consts::PI * ratio;
        let shape =
            (angle.tan() / angle).sqrt() * (0.752 + 2.02 * ratio + 0.37 * (1.0 - angle.sin()).powi(3)) / angle.cos();
        let exact = STRESS * (std::f64::consts::PI * crack).sqrt() * shape;
        assert!((computed / exact - 1.0).abs() < 0.01, "a/b = {ratio}: {computed} against {exact}");
    }
}

const STRESS: f64 = 1e8;

/// Strain energy (J per metre of thickness) of a plate `width` wide and three times as high in all, edge crack of length `crack`, plane strain.
fn plate_energy(width: f64, crack: f64) -> f64 {
    let half_height = 1.5 * width;
    let basis = FaceBasis::new(FaceModel::PlaneStrain, Parity::Symmetric, 1.0, &Material::STEEL).unwrap();
    let mut mesher = BlockMesher::new(4);
    let tip = crack / width;
    let graded = |count| geometric_breaks(count, 2.0);
    let to_tip: Vec<f64> = graded(8).iter().rev().map(|b| tip * (1.0 - b)).collect();
    let from_tip: Vec<f64> = graded(8).iter().map(|b| tip + (1.0 - tip) * b).collect();
    let across = [to_tip.clone(), from_tip[1..].to_vec()].concat();
    let up = geometric_breaks(10, 1.8);
    let at = |x: f64, y: f64| Point2::new(x * width, y * half_height);
    let [mouth_above, mouth_below, end, right] = [0.0, 0.0, tip, 1.0].map(|x| mesher.vertex(at(x, 0.0)));
    let above = mesher.edge(mouth_above, end, &to_tip, |t| at(t, 0.0));
    let below = mesher.edge(mouth_below, end, &to_tip, |t| at(t, 0.0));
    let ligament = mesher.edge(end, right, &from_tip, |t| at(t, 0.0));
    let mut loaded = Vec::new();
    let mut sides = Vec::new();
    for (edge, mouth, sign) in [(above, mouth_above, 1.0), (below, mouth_below, -1.0)] {
        let [left_far, right_far] = [0.0, 1.0].map(|x| mesher.vertex(at(x, sign)));
        let far = mesher.edge(left_far, right_far, &across, |t| at(t, sign));
        let left = mesher.edge(mouth, left_far, &up, |t| at(0.0, sign * t));
        let right = mesher.edge(right, right_far, &up, |t| at(1.0, sign * t));
        let near = edge.joined(&ligament);
        if sign > 0.0 {
            mesher.block(&near, &far, &left, &right);
        } else {
            mesher.block(&far, &near, &left.reversed(), &right.reversed());
        }
        loaded.push((far, sign));
        sides.push(right);
    }
    let mesh = mesher.finish();
    let pieces = |edge: &Edge| -> Vec<Vec<u32>> {
        edge.nodes().windows(mesh.order + 1).step_by(mesh.order).map(<[u32]>::to_vec).collect()
    };
    // the loads balance; springs of a billionth of the plate's stiffness only keep it from drifting
    let springs: Vec<Vec<u32>> = sides.iter().flat_map(pieces).collect();
    let soft = 1e-9 * Material::STEEL.young_modulus / width;
    let body =
        Substructure { mesh: &mesh, retained: vec![], fixed: vec![], springs: Some((soft, &springs)), rich: &[] };
    let body = CondensedBody::new(&body, &basis).unwrap();
    let line = LagrangeBasis::new(mesh.order);
    let mut shapes = vec![0.0; mesh.order + 1];
    let mut loads = Mat::zeros(body.interior_size(), 1);
    for (edge, sign) in &loaded {
        for piece in pieces(edge) {
            let length = (mesh.nodes[piece[mesh.order] as usize] - mesh.nodes[piece[0] as usize]).norm();
            for (x, weight) in gauss_rule(mesh.order + 1) {
                line.values_into(x, &mut shapes);
                for (node, shape) in piece.iter().zip(&shapes) {
                    loads[(body.interior_row(*node, 1).unwrap(), 0)] += sign * STRESS * 0.5 * length * weight * shape;
                }
            }
        }
    }
    let mut moved = loads.clone();
    body.solve_interior(&mut moved);
    0.5 * (0..loads.nrows()).map(|i| loads[(i, 0)] * moved[(i, 0)]).sum::<f64>()
}
