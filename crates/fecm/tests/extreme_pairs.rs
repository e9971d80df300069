//! Extreme geometry and load: every case ends in a converged answer with small residuals, or in a typed error that says why.

use fecm::FaceModel;
use fecm::statics::{PairModel, PairModelOptions, PositionStatus, StaticsRequest};
use gear_geom::{FilletSpec, Gear, GearKind, GearPair, GearSpec, ToothThickness};

#[derive(Debug, Clone, Copy)]
struct Case {
    teeth: [u32; 2],
    module: f64,
    facewidth: f64,
    /// Bore over reference radius.
    bore: f64,
    /// Addendum in modules.
    addendum: f64,
    pressure_angle_deg: f64,
    /// Added to the sum of reference radii, in modules.
    apart: f64,
    /// In units of the nominal torque.
    torque: f64,
    face: FaceModel,
}

const USUAL: Case = Case {
    teeth: [25, 31],
    module: 6e-3,
    facewidth: 16e-3,
    bore: 0.4,
    addendum: 1.0,
    pressure_angle_deg: 20.0,
    apart: 0.0,
    torque: 1.0,
    face: FaceModel::Solid { order: 4 },
};

impl Case {
    fn gear(&self, teeth: u32) -> Result<Gear, gear_geom::GeometryErrors> {
        let radius = 0.5 * self.module * f64::from(teeth);
        Gear::new(&GearSpec {
            teeth,
            module: self.module,
            pressure_angle: self.pressure_angle_deg.to_radians(),
            thickness: ToothThickness::AtReference((0.5 * std::f64::consts::PI - 0.01) * self.module),
            tip_radius: radius + self.addendum * self.module,
            root_radius: radius - (self.addendum + 0.25) * self.module,
            rim_radius: self.bore * radius,
            facewidth: self.facewidth,
            fillet: FilletSpec::Rack { tip_radius: 0.2 * self.module },
            tip_round: 0.02 * self.module,
            ..GearSpec::default()
        })
    }

    /// Torque that loads the teeth with 100 N per mm of face and mm of module, times the case's factor.
    fn wheel_torque(&self, pair: &GearPair) -> f64 {
        self.torque * 1e5 * self.facewidth * self.module * 1e3 * pair.wheel().base_radius()
    }

    /// Solves five positions and holds every number against what must be.
    fn check(&self) {
        let centre = 0.5 * self.module * f64::from(self.teeth[0] + self.teeth[1]) + self.apart * self.module;
        let pair = GearPair::new(self.gear(self.teeth[0]).unwrap(), self.gear(self.teeth[1]).unwrap(), centre).unwrap();
        solve_and_check(&pair, self.face, self.wheel_torque(&pair), &format!("{self:?}"));
    }
}

fn solve_and_check(pair: &GearPair, face: FaceModel, torque: f64, name: &str) {
    let mut options = PairModelOptions { face, ..PairModelOptions::default() };
    options.contact.face_cells = 12;
    let model = PairModel::new(pair, &options).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mesh_cycles = vec![0.0, 0.2, 0.4, 0.6, 0.8];
    let request =
        StaticsRequest { mesh_cycles, torques: vec![torque], stiffness_difference: false, keep_pressure: true };
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
        Case { facewidth, ..USUAL }.check();
    }
}

#[test]
fn extreme_module() {
    for module in [0.2e-3, 1e-3, 30e-3] {
        Case { module, facewidth: 3.0 * module, ..USUAL }.check();
    }
}

#[test]
fn extreme_tooth_numbers_and_ratios() {
    for teeth in [[12, 12], [12, 240], [20, 400], [400, 20], [200, 400], [13, 90]] {
        // fewer than 17 teeth are undercut unless the pressure angle is larger
        Case { teeth, pressure_angle_deg: 25.0, ..USUAL }.check();
    }
}

#[test]
fn extreme_torque() {
    for torque in [0.0, 1e-6, 1e-3, 10.0] {
        Case { torque, ..USUAL }.check();
        Case { torque, face: FaceModel::PlaneStrain, ..USUAL }.check();
    }
    // teeth would have to deflect by more than their own size
    for torque in [1e3, 1e6] {
        let case = Case { torque, ..USUAL };
        let pair = GearPair::new(case.gear(25).unwrap(), case.gear(31).unwrap(), 168e-3).unwrap();
        let model =
            PairModel::new(&pair, &PairModelOptions { face: FaceModel::PlaneStrain, ..PairModelOptions::default() })
                .unwrap();
        let request = StaticsRequest {
            mesh_cycles: vec![0.0, 0.5],
            torques: vec![case.wheel_torque(&pair)],
            stiffness_difference: true,
            keep_pressure: true,
        };
        for at in &model.solve(&request, &()).unwrap().results[0] {
            assert_eq!(at.status, PositionStatus::Overloaded);
            assert!(at.static_transmission_error.is_finite() && at.peak_pressure().is_finite());
        }
    }
}

#[test]
fn extreme_thin_rims() {
    for bore in [0.80, 0.86, 0.88] {
        Case { bore, ..USUAL }.check();
        Case { bore, teeth: [40, 60], ..USUAL }.check();
    }
}

#[test]
fn extreme_contact_ratios() {
    // 1.05: far apart; 2.9: long teeth on many of them
    for (case, ratio) in [
        (Case { apart: 0.62, addendum: 1.0, ..USUAL }, 1.05),
        (Case { addendum: 1.25, teeth: [60, 80], ..USUAL }, 2.2),
        (Case { addendum: 1.45, teeth: [90, 140], pressure_angle_deg: 17.0, ..USUAL }, 2.9),
    ] {
        let centre = 0.5 * case.module * f64::from(case.teeth[0] + case.teeth[1]) + case.apart * case.module;
        let pair = GearPair::new(case.gear(case.teeth[0]).unwrap(), case.gear(case.teeth[1]).unwrap(), centre).unwrap();
        assert!((pair.contact_ratio() - ratio).abs() < 0.1, "contact ratio {} wanted {ratio}", pair.contact_ratio());
        case.check();
    }
}

#[test]
fn extreme_internal_gears() {
    let module = 3e-3;
    for (pinion_teeth, ring_teeth) in [(21, 63), (27, 99), (30, 60), (20, 200)] {
        let radius = |teeth: u32| 0.5 * module * f64::from(teeth);
        let spec = |teeth: u32| GearSpec {
            teeth,
            module,
            thickness: ToothThickness::AtReference((0.5 * std::f64::consts::PI - 0.01) * module),
            facewidth: 20e-3,
            tip_round: 0.02 * module,
            ..GearSpec::default()
        };
        let pinion = Gear::new(&GearSpec {
            tip_radius: radius(pinion_teeth) + module,
            root_radius: radius(pinion_teeth) - 1.25 * module,
            rim_radius: 0.4 * radius(pinion_teeth),
            fillet: FilletSpec::Rack { tip_radius: 0.2 * module },
            ..spec(pinion_teeth)
        })
        .unwrap();
        let ring = Gear::new(&GearSpec {
            kind: GearKind::Internal,
            tip_radius: radius(ring_teeth) - 0.75 * module,
            root_radius: radius(ring_teeth) + 1.25 * module,
            rim_radius: radius(ring_teeth) + 5.0 * module,
            fillet: FilletSpec::Circular { radius: 0.2 * module },
            ..spec(ring_teeth)
        })
        .unwrap();
        let pair = GearPair::new(pinion, ring, radius(ring_teeth) - radius(pinion_teeth)).unwrap();
        for face in [FaceModel::PlaneStress, FaceModel::Solid { order: 4 }] {
            solve_and_check(
                &pair,
                face,
                2e4 * 20e-3 * 3.0 * radius(ring_teeth),
                &format!("{pinion_teeth}/{ring_teeth} internal {face:?}"),
            );
        }
    }
}
