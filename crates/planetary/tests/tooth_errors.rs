//! Meshes with errors of single teeth against contact statics of gears that have these errors, over their hunting period.

use std::sync::Arc;

use fecm::{FaceModel, MeshDensity, PairModel, PairModelOptions, StaticsRequest};
use gear_geom::{FilletSpec, Gear, GearPair, GearSpec};
use planetary::mesh::{MeshLaw, MeshTable, MeshWithErrors, OffsetMesh, TableOptions, ToothErrors, ToothPairCurves};

const TEETH: [u32; 2] = [18, 19];
/// N; deflections are about 12 um.
const FORCE: f64 = 3000.0;

fn gear(teeth: u32, errors: &[f64]) -> Gear {
    let radius = 3e-3 * f64::from(teeth);
    let spec = GearSpec::standard(teeth, 6e-3).with(|spec| {
        spec.facewidth = 16e-3;
        spec.rim_radius = radius - 22e-3;
        spec.fillet = FilletSpec::Rack { tip_radius: 2.2e-3 };
        spec.pitch_errors = errors.to_vec();
    });
    Gear::new(&spec).unwrap()
}

fn model(errors: [&[f64]; 2]) -> PairModel {
    let [pinion, wheel] = [0, 1].map(|k| gear(TEETH[k], errors[k]));
    let pair = GearPair::new(pinion, wheel, 111.1e-3).unwrap();
    let mut options = PairModelOptions { face: FaceModel::PlaneStress, ..Default::default() };
    for member in [&mut options.pinion, &mut options.wheel] {
        member.mesh = MeshDensity { order: 3, density: 0.7 };
    }
    PairModel::new(&pair, &options).unwrap()
}

/// Numbers from 0 to `most`, in steps that do not repeat soon.
fn numbers(count: u32, most: f64, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * most
    };
    (0..count).map(|_| next()).collect()
}

/// Errors by pair, from those by tooth.
fn by_pair(model: &PairModel, errors: [&[f64]; 2]) -> ToothErrors {
    let steps = model.pairing().tooth_steps();
    let list = |k: usize| {
        let teeth = errors[k].len() as i64;
        (0..teeth).map(|pair| errors[k][(pair * i64::from(steps[k])).rem_euclid(teeth) as usize]).collect()
    };
    ToothErrors { pinion: list(0), wheel: list(1) }
}

/// Approach of fresh solutions at mesh cycles.
fn approaches(model: &PairModel, mesh_cycles: &[f64], force: f64) -> Vec<f64> {
    let request = StaticsRequest {
        mesh_cycles: mesh_cycles.to_vec(),
        torques: vec![force * model.pairing().base_radius(1)],
        stiffness_difference: false,
        keep_pressure: false,
    };
    let series = model.solve(&request, &()).unwrap();
    series.results[0].iter().map(|result| result.static_transmission_error).collect()
}

#[test]
fn peer_contact_statics_over_the_hunting_period() {
    let perfect = model([&[], &[]]);
    let options = TableOptions { positions_per_cycle: 16, octaves: 6, ..TableOptions::up_to(3.0 * FORCE) };
    let table = Arc::new(MeshTable::from_contact(&perfect, &options, &()).unwrap());
    let hunting = i64::from(TEETH[0] * TEETH[1]);
    for most in [3e-6, 15e-6] {
        let errors = [numbers(TEETH[0], most, 1), numbers(TEETH[1], most, 2)];
        let errors = [errors[0].as_slice(), errors[1].as_slice()];
        let own = by_pair(&perfect, errors);
        let curves = ToothPairCurves::from_contact(&table, &perfect, &options, own.spread(), &()).unwrap();
        let law = MeshWithErrors::new(table.clone(), Arc::new(curves), own).unwrap();
        let with_errors = model(errors);
        // every place of the cycle, spread over the whole period
        let cycles: Vec<f64> = (0..hunting * 16).step_by(13).map(|position| position as f64 / 16.0).collect();
        for force in [FORCE, 0.3 * FORCE] {
            let approaches = approaches(&with_errors, &cycles, force);
            let mut worst = [0.0_f64; 2];
            let mut squares = [0.0; 2];
            let mut slope = 0.0_f64;
            for (&cycle, &approach) in cycles.iter().zip(&approaches) {
                let found = [law.response(cycle, approach).force, table.response(cycle, approach).force];
                for k in 0..2 {
                    let error = found[k] / force - 1.0;
                    worst[k] = worst[k].max(error.abs());
                    squares[k] += error * error / cycles.len() as f64;
                }
                // the slope is the derivative
                let h = 1e-10;
                let [low, high] = [approach - h, approach + h].map(|x| law.response(cycle, x).force);
                let own = law.response(cycle, approach).stiffness;
                slope = slope.max(((high - low) / (2.0 * h) / own - 1.0).abs());
            }
            let rms = squares.map(f64::sqrt);
            println!(
                "{most:.0e} m, {force} N: with errors {:.1e} rms, {:.1e} worst; without {:.1e} rms, {:.1e} worst; slope {slope:.1e}",
                rms[0], worst[0], rms[1], worst[1]
            );
            assert!(rms[0] < 1e-3 && worst[0] < 1e-2, "{rms:?} {worst:?}");
            assert!(rms[1] > 20.0 * rms[0], "the errors matter: {rms:?}");
            assert!(slope < 0.05, "{slope}");
        }
    }
}

/// Without errors the table's bits; the same error on all teeth is an offset; a tooth far out of reach leaves its neighbours alone.
#[test]
fn invariant_equal_errors_are_an_offset() {
    let perfect = model([&[], &[]]);
    let options = TableOptions { positions_per_cycle: 8, octaves: 4, ..TableOptions::up_to(3.0 * FORCE) };
    let table = Arc::new(MeshTable::from_contact(&perfect, &options, &()).unwrap());
    let curves = Arc::new(ToothPairCurves::from_contact(&table, &perfect, &options, 20e-6, &()).unwrap());
    let law = |errors: ToothErrors| MeshWithErrors::new(table.clone(), curves.clone(), errors).unwrap();
    let none = law(ToothErrors { pinion: vec![0.0; 18], wheel: Vec::new() });
    let same = law(ToothErrors { pinion: vec![4e-6; 18], wheel: vec![3e-6; 19] });
    let offset = OffsetMesh::new(table.clone(), 7e-6).unwrap();
    for k in 0..200 {
        let (cycle, approach) = (f64::from(k) * 0.37, 1e-6 * f64::from(k % 40 - 5));
        assert_eq!(none.response(cycle, approach), table.response(cycle, approach));
        let (found, expected) = (same.response(cycle, approach), offset.response(cycle, approach));
        assert!((found.force - expected.force).abs() <= 1e-6 * FORCE, "{cycle} {approach}: {found:?} {expected:?}");
    }
    for (cycle, approach) in [(f64::NAN, 1e-5), (1.0, f64::NAN), (1e300, 1e-5), (0.3, 1e3), (0.3, -1e3)] {
        let answer = same.response(cycle, approach);
        assert!(answer.force >= 0.0 && answer.stiffness >= 0.0, "{cycle} {approach}: {answer:?}");
    }
}
