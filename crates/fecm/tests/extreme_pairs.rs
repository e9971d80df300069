//! Extreme geometry and load: every case ends in a converged answer with small residuals, or in a typed error that says why.

#[path = "common/proportions.rs"]
mod proportions;

use fecm::FaceModel;
use fecm::statics::{PairModel, PairModelOptions, PositionStatus, StaticsRequest};
use gear_geom::GearPair;
use proportions::{Proportions, USUAL};

const SOLID: FaceModel = FaceModel::Solid { order: 4 };

/// Solves five positions under so many nominal torques and holds every number against what must be.
fn check_under(gears: Proportions, torque: f64, face: FaceModel) {
    let pair = gears.pair().unwrap();
    let name = format!("{gears:?}, {torque} nominal torques, {face:?}");
    solve_and_check(&pair, face, torque * gears.nominal_torque(&pair), &name);
}

fn check(gears: Proportions) {
    check_under(gears, 1.0, SOLID);
}

fn solve_and_check(pair: &GearPair, face: FaceModel, torque: f64, name: &str) {
    let mut options = PairModelOptions { face, ..PairModelOptions::default() };
    options.contact.face_cells = 12;
    let model = PairModel::new(pair, &options).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mesh_cycles = vec![0.0, 0.2, 0.4, 0.6, 0.8];
    let request = StaticsRequest::new(mesh_cycles, [torque]).keeping_pressure();
    for at in &model.solve(&request, &()).unwrap_or_else(|e| panic!("{name}: {e}")).results[0] {
        let place = format!("{name} at {}: {:?}", at.mesh_cycle, at.status);
        let usable = matches!(at.status, PositionStatus::Converged | PositionStatus::FilletContact);
        assert!(usable, "{place} {:?}", at.stats);
        assert!(at.static_transmission_error - at.no_load_transmission_error > -1e-15, "{place}");
        assert!(at.stats.torque_residual < 1e-9 && at.stats.solver.kkt_violation < 1e-9, "{place} {:?}", at.stats);
        if torque > 0.0 {
            let stiffness = at.stiffness_local_slope.unwrap_or_else(|| panic!("{place}: no stiffness"));
            assert!(stiffness > 0.0 && stiffness.is_finite(), "{place}: stiffness {stiffness}");
            assert!(at.loaded_pairs().count() > 0, "{place}");
            assert!(
                at.patches.iter().flat_map(|p| p.pressure.iter().flatten()).all(|p| p.is_finite() && *p >= 0.0),
                "{place}"
            );
        }
    }
}

#[test]
fn extreme_facewidth() {
    for facewidth in [1e-3, 4e-3, 60e-3, 200e-3, 500e-3] {
        check(Proportions { facewidth, ..USUAL });
    }
}

#[test]
fn extreme_module() {
    for module in [0.2e-3, 1e-3, 30e-3] {
        check(Proportions { module, facewidth: 3.0 * module, ..USUAL });
    }
}

#[test]
fn extreme_tooth_numbers_and_ratios() {
    for teeth in [[12, 12], [12, 240], [20, 400], [400, 20], [200, 400], [13, 90]] {
        // fewer than 17 teeth are undercut unless the pressure angle is larger
        check(Proportions { teeth, pressure_angle: 25.0, ..USUAL });
    }
}

#[test]
fn extreme_torque() {
    for torque in [0.0, 1e-6, 1e-3, 10.0] {
        check_under(USUAL, torque, SOLID);
        check_under(USUAL, torque, FaceModel::PlaneStrain);
    }
    // teeth would have to deflect by more than their own size
    for torque in [1e3, 1e6] {
        let pair = USUAL.pair().unwrap();
        let model =
            PairModel::new(&pair, &PairModelOptions { face: FaceModel::PlaneStrain, ..PairModelOptions::default() })
                .unwrap();
        let request = StaticsRequest::new([0.0, 0.5], [torque * USUAL.nominal_torque(&pair)])
            .with_stiffness_difference()
            .keeping_pressure();
        for at in &model.solve(&request, &()).unwrap().results[0] {
            assert_eq!(at.status, PositionStatus::Overloaded);
            assert!(at.static_transmission_error.is_finite() && at.peak_pressure().is_finite());
        }
    }
}

#[test]
fn extreme_thin_rims() {
    for bore in [0.80, 0.86, 0.88] {
        check(Proportions { bore, ..USUAL });
        check(Proportions { bore, teeth: [40, 60], ..USUAL });
    }
}

#[test]
fn extreme_contact_ratios() {
    // 1.05: far apart; 2.9: long teeth on many of them
    for (gears, ratio) in [
        (Proportions { apart: 0.62, addendum: 1.0, ..USUAL }, 1.05),
        (Proportions { addendum: 1.25, teeth: [60, 80], ..USUAL }, 2.2),
        (Proportions { addendum: 1.45, teeth: [90, 140], pressure_angle: 17.0, ..USUAL }, 2.9),
    ] {
        let pair = gears.pair().unwrap();
        assert!((pair.contact_ratio() - ratio).abs() < 0.1, "contact ratio {} wanted {ratio}", pair.contact_ratio());
        check(gears);
    }
}

#[test]
fn extreme_internal_gears() {
    for teeth in [[21, 63], [27, 99], [30, 60], [20, 200]] {
        let gears = Proportions { teeth, module: 3e-3, facewidth: 20e-3, ..USUAL };
        let pair = gears.internal_pair().unwrap();
        for face in [FaceModel::PlaneStress, SOLID] {
            solve_and_check(&pair, face, 0.2 * gears.nominal_torque(&pair), &format!("{teeth:?} internal {face:?}"));
        }
    }
}
