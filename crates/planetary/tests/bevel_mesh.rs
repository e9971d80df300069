//! Sliced meshes: closed forms with springs, and the dissertation's bevel stage.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use gear_geom::{BevelPair, BevelSpec, Hand, Member};
use planetary::mesh::{
    BevelSlices, LinearMesh, MeshError, MeshLaw, Periodic, Slice, SlicedMesh, TableOptions, virtual_table,
};

/// The input stage of section 5.2; module from tooth thicknesses and a backlash of 0.15 mm.
fn pair() -> BevelPair {
    BevelPair::new(&BevelSpec {
        teeth: [19, 71],
        shaft_angle: 95_f64.to_radians(),
        module: 9.75e-3 / PI,
        facewidth: 30.48e-3,
        spiral_angle: 30_f64.to_radians(),
        pinion_hand: Hand::Left,
        pressure_angle: 20_f64.to_radians(),
        thickness: [6.24e-3, 3.36e-3],
    })
    .unwrap()
}

/// Slices over a whole cycle average a spring that varies; one over crowned slices is a power of 3/2.
#[test]
fn analytic_springs() {
    let wave = Periodic::Harmonics { mean: 4e8, terms: vec![[1e8, 0.5e8]] };
    let spring: Arc<dyn MeshLaw> = Arc::new(LinearMesh::new(wave, Periodic::Constant(0.0)).unwrap());
    let slices = |count: usize, crown: f64| {
        let slice = |i: usize| {
            let part = (i as f64 + 0.5) / count as f64;
            Slice { phase: part, gap: crown * (2.0 * part - 1.0).powi(2), weight: 1.0 / count as f64 }
        };
        SlicedMesh::new(Arc::clone(&spring), (0..count).map(slice).collect(), 0.5).unwrap()
    };
    let even = slices(16, 0.0);
    for cycle in [0.0, 0.2, 5.7] {
        let answer = even.response(cycle, 3e-6);
        assert!((answer.stiffness * 0.5_f64.cos().powi(2) / 4e8 - 1.0).abs() < 1e-12);
        assert!((answer.force / (answer.stiffness * 3e-6) - 1.0).abs() < 1e-12);
    }
    // contact over |u| < sqrt(x / crown): force 2/3 k x sqrt(x / crown)
    let constant: Arc<dyn MeshLaw> = Arc::new(LinearMesh::constant(4e8).unwrap());
    let crowned = slices(1000, 20e-6);
    let crowned = SlicedMesh::new(constant, crowned.slices().to_vec(), 0.0).unwrap();
    for approach in [2e-6, 5e-6, 15e-6_f64] {
        let expected = 2.0 / 3.0 * 4e8 * approach * (approach / 20e-6).sqrt();
        assert!((crowned.response(0.0, approach).force / expected - 1.0).abs() < 1e-3);
    }
    assert_eq!(crowned.response(0.0, 0.0).force, 0.0);
}

/// The bevel mesh of the dissertation: converges with the slices; overlap makes its stiffness vary less than a slice's; crowning softens it; force is the
/// integral of stiffness.
#[test]
fn invariant_bevel_mesh() {
    let pair = pair();
    // 219 kW on the pinion
    let torque = 219e3 / (6060.0 * TAU / 60.0);
    let virtual_pair = pair.virtual_pair().unwrap();
    let transverse = torque / pair.mean_radii()[0] / pair.transverse_pressure_angle().cos();
    let table = virtual_table(&pair, &TableOptions::up_to(4.0 * transverse), &()).unwrap();
    let table: Arc<dyn MeshLaw> = Arc::new(table);
    let mesh = |count, crown| SlicedMesh::bevel(&pair, Arc::clone(&table), &BevelSlices { count, crown }).unwrap();
    let force = transverse / pair.base_spiral_angle().cos();
    let stiffness = |law: &dyn MeshLaw, force: f64| {
        let approach = |cycle: f64| {
            let (mut low, mut high) = (0.0, 1e-3);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                *(if law.response(cycle, middle).force < force { &mut low } else { &mut high }) = middle;
            }
            low
        };
        let all: Vec<[f64; 2]> = (0..50)
            .map(|i| f64::from(i) / 50.0)
            .map(|cycle| [approach(cycle), law.response(cycle, approach(cycle)).stiffness])
            .collect();
        let mean = all.iter().map(|value| value[1]).sum::<f64>() / 50.0;
        let ends = |i: usize| all.iter().fold([f64::MAX, 0.0_f64], |[a, b], v| [a.min(v[i]), b.max(v[i])]);
        (mean, (ends(1)[1] - ends(1)[0]) / mean, ends(0)[1] - ends(0)[0])
    };
    let (mean, swing, te) = stiffness(&mesh(48, 0.0), force);
    let (of_slice, slice_swing, slice_te) = stiffness(&*table, transverse);
    let (crowned, crowned_swing, crowned_te) = stiffness(&mesh(48, 20e-6), force);
    println!(
        "force {force:.0} N; stiffness {:.1} N/um swing {swing:.3} te {te:.2e}; slice {:.1} {slice_swing:.3} {slice_te:.2e}; crowned {:.1} \
         {crowned_swing:.3} {crowned_te:.2e}; contact ratio {:.3}, overlap {:.3}, pinion {:?}",
        mean * 1e-6,
        of_slice * 1e-6,
        crowned * 1e-6,
        virtual_pair.contact_ratio(),
        pair.overlap_ratio(),
        virtual_pair.gear(Member::Pinion).teeth()
    );
    assert!((mean * pair.base_spiral_angle().cos().powi(2) / of_slice - 1.0).abs() < 0.05);
    assert!(swing < 0.25 * slice_swing && crowned < mean);
    // half the face in contact
    let narrow = stiffness(&mesh(192, 100e-6), force).0;
    assert!(narrow < 0.8 * mean);
    // stiffness joins slice by slice, force does not
    let at = |count| mesh(count, 100e-6).response(0.3, 30e-6).force;
    let [coarse, fine] = [6, 24].map(|count| (at(count) / at(384) - 1.0).abs());
    println!(
        "stiffness with crowning of 100 um {:.1} N/um; force of 6 slices {coarse:.1e}, of 24 {fine:.1e}",
        narrow * 1e-6
    );
    assert!(coarse < 0.05 && fine < 0.005 && fine < coarse, "{coarse} {fine}");
    let law = mesh(12, 20e-6);
    let steps = 4000;
    let dx = 40e-6 / f64::from(steps);
    let work: f64 = (0..steps).map(|i| law.response(0.3, (f64::from(i) + 0.5) * dx).stiffness * dx).sum();
    assert!((work / law.response(0.3, 40e-6).force - 1.0).abs() < 1e-3);
}

#[test]
fn extreme_slices_are_refused() {
    let law: Arc<dyn MeshLaw> = Arc::new(LinearMesh::constant(1e8).unwrap());
    let good = Slice { phase: 0.0, gap: 0.0, weight: 1.0 };
    for (slices, angle) in [
        (vec![], 0.0),
        (vec![Slice { gap: -1e-6, ..good }], 0.0),
        (vec![Slice { phase: f64::NAN, ..good }], 0.0),
        (vec![Slice { weight: 0.0, ..good }], 0.0),
        (vec![good], 1.5),
        (vec![good], f64::NAN),
    ] {
        assert!(matches!(SlicedMesh::new(Arc::clone(&law), slices, angle), Err(MeshError::Option { .. })));
    }
    let none = BevelSlices { count: 0, crown: 0.0 };
    assert!(SlicedMesh::bevel(&pair(), law, &none).is_err());
}
