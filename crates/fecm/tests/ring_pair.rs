//! The planet and the ring of the dissertation's planetary stage (Table 5.1): an internal gear in contact, sound and damaged.

use std::sync::OnceLock;

use fecm::{ContactOptions, FaceModel, PairModel, PairModelOptions, PositionResult, PositionStatus, StaticsRequest};
use gear_geom::{
    Damage, Gear, GearPair, Member, MeshSite, Pit, PlanetaryTrain, ProfileMeasure, RootCrack, ToothDamage,
};

#[path = "../../gear-geom/tests/common/train.rs"]
mod train;

/// Normal force at 219 kW (N): a third of the sun's torque on its base radius.
const FORCE: f64 = 12.39e3;

fn ring_pair() -> GearPair {
    PlanetaryTrain::new(&train::dissertation_spec()).unwrap().pair(MeshSite::PlanetRing).clone()
}

fn plane_model() -> &'static PairModel {
    static MODEL: OnceLock<PairModel> = OnceLock::new();
    MODEL.get_or_init(|| {
        let options = PairModelOptions { face: FaceModel::PlaneStress, ..PairModelOptions::default() };
        PairModel::new(&ring_pair(), &options).unwrap()
    })
}

fn solve(model: &PairModel, mesh_cycles: Vec<f64>, force: f64) -> Vec<PositionResult> {
    let torque = force * model.pairing().base_radius(1);
    let request = StaticsRequest::new(mesh_cycles, [torque]);
    let results = model.solve(&request, &()).unwrap().results.remove(0);
    for result in &results {
        assert_eq!(result.status, PositionStatus::Converged, "{}", result.mesh_cycle);
        let solver = result.stats.solver;
        assert!(result.stats.torque_residual < 1e-9 && solver.kkt_violation < 1e-9 && solver.complementarity < 1e-9);
    }
    results
}

/// Forces balance the torque, pairs in contact follow the rotation, and under a load that hardly bends the teeth each pair carries for as many cycles as the
/// contact ratio of the geometry says.
#[test]
fn invariant_equilibrium_and_contact_ratio() {
    let model = plane_model();
    let steps = 200;
    let cycles: Vec<f64> = (0..steps).map(|i| f64::from(i) / f64::from(steps)).collect();
    let light = solve(model, cycles.clone(), 1e-3 * FORCE);
    let carried: usize = light.iter().map(|result| result.loaded_pairs().count()).sum();
    let ratio = carried as f64 / f64::from(steps);
    let expected = ring_pair().contact_ratio();
    assert!((ratio - expected).abs() < 0.03, "{ratio} {expected}");
    let full = solve(model, cycles, FORCE);
    let carried: usize = full.iter().map(|result| result.loaded_pairs().count()).sum();
    assert!(carried as f64 / f64::from(steps) > ratio + 0.1);
    for (result, next) in
        full.iter().zip(solve(model, (0..steps).map(|i| 1.0 + f64::from(i) / f64::from(steps)).collect(), FORCE))
    {
        assert!((result.static_transmission_error / next.static_transmission_error - 1.0).abs() < 1e-9);
        let shifted = result.loaded_pairs().map(|pair| pair.pair + 1);
        assert!(shifted.eq(next.loaded_pairs().map(|pair| pair.pair)));
    }
}

/// With gears of one width, plane strain and plane stress bracket the solid.
#[test]
fn invariant_plane_brackets_solid() {
    let mut spec = train::dissertation_spec();
    let narrow = |gear: &Gear| {
        Gear::new(&gear.spec().clone().with(|spec| {
            spec.facewidth = 25.4e-3;
        }))
        .unwrap()
    };
    (spec.sun, spec.planet) = (narrow(&spec.sun), narrow(&spec.planet));
    let pair = PlanetaryTrain::new(&spec).unwrap().pair(MeshSite::PlanetRing).clone();
    let deflection = |face: FaceModel| {
        let contact = ContactOptions { cells_per_half_width: 6.0, face_cells: 24, ..ContactOptions::default() };
        let options = PairModelOptions { face, contact, ..PairModelOptions::default() };
        let results = solve(&PairModel::new(&pair, &options).unwrap(), vec![0.0, 0.5], FORCE);
        results.iter().map(|result| result.static_transmission_error).sum::<f64>()
    };
    let [strain, solid, stress] =
        [FaceModel::PlaneStrain, FaceModel::Solid { order: 6 }, FaceModel::PlaneStress].map(deflection);
    println!("plane strain {strain:.4e}, solid {solid:.4e}, plane stress {stress:.4e} m");
    assert!(strain < solid && solid < stress, "{strain} {solid} {stress}");
}

/// Cracks at the root of a ring tooth soften it, the more the longer; at the fillet that bending closes they do so less. A pit takes load from its tooth.
#[test]
fn invariant_damaged_ring_tooth() {
    let model = plane_model();
    let pair = ring_pair();
    let loaded = pair.working_side(Member::Wheel);
    // where pair 0 carries all or most of the load
    let cycle = -0.35;
    let with = |damage: Damage| {
        let damaged = model.with_damage(&[vec![], vec![ToothDamage { tooth: 0, damage }]]).unwrap();
        solve(&damaged, vec![cycle], FORCE).remove(0)
    };
    let sound = solve(model, vec![cycle], FORCE).remove(0);
    let mut before = sound.static_transmission_error;
    for part in [0.2, 0.5, 0.8] {
        let pulled = with(Damage::Crack(RootCrack::along_chord(loaded, part)));
        let pushed = with(Damage::Crack(RootCrack::along_chord(loaded.other(), part)));
        let change = |result: &PositionResult| result.static_transmission_error / sound.static_transmission_error - 1.0;
        println!("{part}: pulled {:.4}, pushed {:.4}", change(&pulled), change(&pushed));
        assert!(pulled.static_transmission_error > before && change(&pushed) < 0.5 * change(&pulled));
        before = pulled.static_transmission_error;
    }
    let roll = pair.contact_roll(Member::Wheel, 0, cycle);
    let pit = Pit::ellipse(0.0, roll, 1.0, 0.25 * pair.base_pitch(), ProfileMeasure::RollDistance);
    let force =
        |result: &PositionResult| result.pairs.iter().find(|pair| pair.pair == 0).map_or(0.0, |pair| pair.force);
    let pitted = with(Damage::Pit(pit));
    println!("pit: force {:.0} of {:.0} N", force(&pitted), force(&sound));
    assert!(force(&pitted) < 0.9 * force(&sound) && pitted.static_transmission_error > sound.static_transmission_error);
}
