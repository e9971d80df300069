//! Stress on free surfaces and at crack tips against closed and published solutions; roots and cracks of teeth.

mod common;

use common::TORQUE;
use common::bodies::{Body, annulus, beam, cracked_plate};
use fecm::face::{FaceBasis, Parity};
use fecm::fracture::CrackTipZone;
use fecm::statics::{MemberOptions, PairModel, PairModelOptions, PositionResult, StaticsRequest};
use fecm::surface::SurfacePoint;
use fecm::{FaceModel, Material, MeshDensity};
use gear_geom::{Damage, FlankSide, GearPair, Member, RootCrack, ToothDamage};
use nalgebra::Vector2;

const STRESS: f64 = 1e8;

fn basis(model: FaceModel) -> FaceBasis {
    FaceBasis::new(model, Parity::Symmetric, 10e-3, &Material::STEEL).unwrap()
}

/// Tangential stress at the Gauss points of edges: place and value.
fn stresses(
    body: &Body,
    edges: &[Vec<u32>],
    basis: &FaceBasis,
    z: f64,
    field: impl Fn(&fecm::functional::Functional) -> f64,
) -> Vec<(nalgebra::Point2<f64>, f64)> {
    let points = edges.iter().flat_map(|edge| SurfacePoint::of_edge(&body.mesh, edge));
    points.map(|point| (point.place, field(&point.stress(basis).at(basis, z)))).collect()
}

/// G. Lame: a ring pulled outward by `p` on its outside has `2 p b^2 / (b^2 - a^2)` around its bore, in every face model and everywhere along a free face.
#[test]
fn analytic_lame_hoop_stress_at_the_bore() {
    let [a, b] = [20e-3, 32e-3];
    let exact = 2.0 * STRESS * b * b / (b * b - a * a);
    for model in [FaceModel::PlaneStress, FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let basis = basis(model);
        let mut errors = Vec::new();
        for count in [1, 2, 4] {
            let body = annulus(3, count, 2 * count, [a, b], 1.0);
            let solution = body.solve(&basis, None, &[(1, &|p| p.coords.normalize() * STRESS)]);
            for z in [0.0, 4e-3] {
                let worst = stresses(&body, &body.edges[0], &basis, z, |f| solution.value(f))
                    .iter()
                    .map(|(_, value)| (value / exact - 1.0).abs())
                    .fold(0.0, f64::max);
                errors.push(worst);
            }
        }
        // third order: two halvings divide by 64
        assert!(errors[5] < 1e-4 && errors[4] < errors[0] / 40.0, "{model:?}: {errors:?}");
    }
}

/// G. Kirsch: a hole in a plate under tension `s` has `s (1 - 2 cos 2 theta)` around it, 3 s at the sides. The outside carries the exact tractions.
#[test]
fn analytic_kirsch_hole() {
    let [a, b] = [5e-3, 25e-3];
    let body = annulus(4, 5, 6, [a, b], 1.7);
    let basis = basis(FaceModel::PlaneStress);
    let traction = |p: nalgebra::Point2<f64>| {
        let (r, angle) = (p.coords.norm(), p.y.atan2(p.x));
        let (q, double) = ((a / r).powi(2), 2.0 * angle);
        let radial = 0.5 * STRESS * ((1.0 - q) + (1.0 - 4.0 * q + 3.0 * q * q) * double.cos());
        let shear = -0.5 * STRESS * (1.0 + 2.0 * q - 3.0 * q * q) * double.sin();
        let outward = p.coords / r;
        outward * radial + Vector2::new(-outward.y, outward.x) * shear
    };
    let solution = body.solve(&basis, None, &[(1, &traction)]);
    let mut largest = 0.0_f64;
    for (place, value) in stresses(&body, &body.edges[0], &basis, 0.0, |f| solution.value(f)) {
        let exact = STRESS * (1.0 - 2.0 * (2.0 * place.y.atan2(place.x)).cos());
        assert!((value - exact).abs() < 2e-3 * 3.0 * STRESS, "{place}: {value} against {exact}");
        largest = largest.max(value);
    }
    assert!((largest / (3.0 * STRESS) - 1.0).abs() < 5e-3, "{largest}");
}

/// A held beam under an end force: `sigma = F x / W` along its top, `x` from the end (exact away from the ends: S. P. Timoshenko and J. N.
/// Goodier, *Theory of Elasticity*, article 21).
#[test]
fn analytic_bent_beam() {
    let (length, height) = (60e-3, 10e-3);
    let body = beam(3, [12, 3], length, height);
    for model in [FaceModel::PlaneStress, FaceModel::PlaneStrain] {
        let basis = basis(model);
        let shear = |p: nalgebra::Point2<f64>| Vector2::new(0.0, -1.5e6 * (1.0 - (2.0 * p.y / height).powi(2)));
        let solution = body.solve(&basis, Some(0), &[(1, &shear)]);
        let force_per_width = 1.5e6 * height * 2.0 / 3.0;
        for (place, value) in stresses(&body, &body.edges[2], &basis, 0.0, |f| solution.value(f)) {
            let exact = force_per_width * (length - place.x) * 6.0 / (height * height);
            if place.x > 1.5 * height {
                assert!((value / exact - 1.0).abs() < 3e-3, "{model:?} at {place}: {value} against {exact}");
            }
        }
    }
}

fn factors(
    body: &Body,
    basis: &FaceBasis,
    reach: f64,
    z: f64,
    value: impl Fn(&fecm::functional::Functional) -> f64,
) -> [f64; 2] {
    let zone = CrackTipZone::new(&body.mesh, [&body.crack[0], &body.crack[1]], reach).unwrap();
    let [one, two] = zone.intensities(basis).map(|factor| factor.at(basis, z));
    [value(&one), value(&two)]
}

/// Plate with an edge crack under tension: `K = sigma sqrt(pi a) F(a / b)` of H. Tada, P. C. Paris and G. R. Irwin, *The Stress Analysis of Cracks
/// Handbook*, section 2.11 (within 0.5 % for any `a / b`). The same from zones of any size; none of it slides.
#[test]
fn peer_tada_edge_crack_by_the_interaction_integral() {
    let width = 20e-3;
    for ratio in [0.2_f64, 0.4, 0.6] {
        let body = cracked_plate(4, width, [1.5 * width; 2], ratio * width, 0.0);
        let angle = 0.5 * std::f64::consts::PI * ratio;
        let shape =
            (angle.tan() / angle).sqrt() * (0.752 + 2.02 * ratio + 0.37 * (1.0 - angle.sin()).powi(3)) / angle.cos();
        let exact = STRESS * (std::f64::consts::PI * ratio * width).sqrt() * shape;
        for model in [FaceModel::PlaneStress, FaceModel::PlaneStrain] {
            let basis = basis(model);
            let solution =
                body.solve(&basis, None, &[(0, &|_| Vector2::new(0.0, -STRESS)), (1, &|_| Vector2::new(0.0, STRESS))]);
            let all: Vec<[f64; 2]> = [0.3, 0.5, 0.8]
                .iter()
                .map(|&reach| factors(&body, &basis, reach, 0.0, |f| solution.value(f)))
                .collect();
            for [one, two] in &all {
                assert!((one / exact - 1.0).abs() < 0.01, "{model:?} a/b = {ratio}: {one} against {exact}");
                assert!(two.abs() < 1e-4 * one, "{two}");
                assert!((one / all[2][0] - 1.0).abs() < 2e-3, "{model:?} a/b = {ratio}: {all:?}");
            }
        }
    }
}

/// Edge crack under end shear, bottom held: `K_I = 34.0`, `K_II = 4.55` for a plate of 7 x 16 with a crack of 3.5 and a unit shear on top (J. F. Yau, S. S. Wang
/// and H. T. Corten, 1980), at Poisson's ratio 0.25 in plane strain.
#[test]
fn peer_yau_edge_crack_in_shear() {
    let material = Material { poisson_ratio: 0.25, ..Material::STEEL };
    let basis = FaceBasis::new(FaceModel::PlaneStrain, Parity::Symmetric, 1.0, &material).unwrap();
    let body = cracked_plate(4, 7.0, [8.0; 2], 3.5, 0.0);
    let solution = body.solve(&basis, Some(0), &[(1, &|_| Vector2::new(1.0, 0.0))]);
    for reach in [0.4, 0.8] {
        let [one, two] = factors(&body, &basis, reach, 0.0, |f| solution.value(f));
        // published to three figures
        assert!((one / 34.0 - 1.0).abs() < 5e-3 && (two.abs() / 4.55 - 1.0).abs() < 5e-3, "{one} {two}");
    }
}

/// Along a curved crack the factors do not depend on the zone, and release the energy that the body loses.
#[test]
fn invariant_curved_crack() {
    let (width, crack, bend) = (20e-3, 8e-3, 30.0);
    let basis = basis(FaceModel::PlaneStrain);
    let solve = |crack: f64| {
        let body = cracked_plate(4, width, [1.5 * width; 2], crack, bend);
        let pull = [-STRESS, STRESS].map(|s| move |_| Vector2::new(0.0, s));
        let solution = body.solve(&basis, None, &[(0, &pull[0]), (1, &pull[1])]);
        (body, solution)
    };
    let (body, solution) = solve(crack);
    let all: Vec<[f64; 2]> =
        [0.2, 0.4, 0.8].iter().map(|&reach| factors(&body, &basis, reach, 0.0, |f| solution.value(f))).collect();
    for [one, two] in &all {
        assert!((one / all[0][0] - 1.0).abs() < 5e-3, "{all:?}");
        assert!((two - all[0][1]).abs() < 5e-3 * one, "{all:?}");
        assert!(two.abs() > 0.05 * one, "a bent crack slides: {all:?}");
    }
    let step = 0.02 * crack;
    let arc = (1.0 + (2.0 * bend * crack).powi(2)).sqrt();
    let released = (solve(crack + step).1.energy - solve(crack - step).1.energy) / (2.0 * step * arc * basis.width());
    let plane = Material::STEEL.young_modulus / (1.0 - Material::STEEL.poisson_ratio.powi(2));
    let from_factors = all[1].iter().map(|k| k * k).sum::<f64>() / plane;
    assert!((from_factors / released - 1.0).abs() < 0.01, "{from_factors} against {released}");
}

fn solve(model: &PairModel, mesh_cycles: &[f64]) -> Vec<PositionResult> {
    let request = StaticsRequest::new(mesh_cycles.to_vec(), [TORQUE]).keeping_pressure();
    model.solve(&request, &()).unwrap().results.remove(0)
}

fn options(face: FaceModel, order: usize, density: f64) -> PairModelOptions {
    let member = MemberOptions { mesh: MeshDensity { order, density }, ..MemberOptions::default() };
    let mut options = PairModelOptions { face, pinion: member, wheel: member, ..PairModelOptions::default() };
    options.contact.face_cells = 12;
    options
}

fn cracked(fraction: f64) -> [Vec<ToothDamage>; 2] {
    let damage = Damage::Crack(RootCrack::along_chord(FlankSide::Upper, fraction));
    [vec![ToothDamage { tooth: 0, damage }], vec![]]
}

/// Root stresses under one and two pairs converge with order and density, and lie where a root breaks.
#[test]
fn order_root_stress() {
    let pair = common::pair(25, 31);
    let stress = |order: usize, density: f64| {
        let model = PairModel::new(&pair, &options(FaceModel::PlaneStress, order, density)).unwrap();
        let results = solve(&model, &[0.0, 0.5]);
        model.root_stress_reader().read_all(&results).unwrap()
    };
    let fine = stress(5, 2.0);
    let mut worst = Vec::new();
    for (order, density) in [(2, 1.0), (3, 1.0), (4, 1.5)] {
        let mut error = 0.0_f64;
        for (coarse, fine) in stress(order, density).iter().flatten().zip(fine.iter().flatten()) {
            assert_eq!((coarse.member, coarse.pair), (fine.member, fine.pair));
            for (a, b) in [(coarse.tension, fine.tension), (coarse.compression, fine.compression)] {
                error = error.max((a.stress / b.stress - 1.0).abs());
            }
        }
        worst.push(error);
    }
    assert!(worst[1] < 0.02 && worst[2] < 5e-3 && worst[2] < worst[0], "{worst:?}");
    for root in &fine[0] {
        let angle = root.tension.tangent_angle.to_degrees();
        assert!(root.tension.stress > 0.0 && root.compression.stress < -root.tension.stress, "{root:?}");
        assert!((20.0..50.0).contains(&angle), "{angle}");
    }
}

/// ISO 6336-3 (2006), method B: notional root stress `F_t Y_F Y_S / (b m)` of the pinion at its outer point of single contact. A beam at the 30 degree
/// tangent with an empirical notch factor: a check of plausibility, not a reference.
#[test]
fn sanity_root_stress_of_iso_6336() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};
    let pair = common::pair(25, 31);
    let (teeth, alpha) = (25.0, 20_f64.to_radians());
    let module = pair.pinion().module();
    let outer = pair.landmarks(Member::Pinion).hpstc.unwrap();
    // rack: dedendum and tip radius in modules
    let (dedendum, round) = (1.25, 0.38);
    let e = 0.25 * PI - dedendum * alpha.tan() - (1.0 - alpha.sin()) * round / alpha.cos();
    let g = round - dedendum;
    let h = 2.0 / teeth * (FRAC_PI_2 - e) - FRAC_PI_3;
    let theta = (0..20).fold(FRAC_PI_6, |theta: f64, _| 2.0 * g / teeth * theta.tan() - h);
    let chord = teeth * (FRAC_PI_3 - theta).sin() + 3_f64.sqrt() * (g / theta.cos() - round);
    let fillet = round + 2.0 * g * g / (theta.cos() * (teeth * theta.cos().powi(2) - 2.0 * g));
    let involute = |a: f64| a.tan() - a;
    let at_load = (pair.pinion().base_radius() / outer.radius).acos();
    let gamma = FRAC_PI_2 / teeth + involute(alpha) - involute(at_load);
    let direction = at_load - gamma;
    let arm = 0.5
        * ((gamma.cos() - gamma.sin() * direction.tan()) * 2.0 * outer.radius / module
            - teeth * (FRAC_PI_3 - theta).cos()
            - g / theta.cos()
            + round);
    let form = 6.0 * arm * direction.cos() / (chord * chord * alpha.cos());
    let slender = chord / arm;
    let notch = (1.2 + 0.13 * slender) * (0.5 * chord / fillet).powf(1.0 / (1.21 + 2.3 / slender));

    let model = PairModel::new(&pair, &options(FaceModel::PlaneStrain, 3, 1.0)).unwrap();
    // just before the next pair takes its share
    let cycle = (outer.roll_distance - pair.pitch_roll()) / pair.base_pitch() - 0.08;
    let position = solve(&model, &[cycle]).remove(0);
    assert_eq!(position.loaded_pairs().count(), 1);
    let root = model.root_stress_reader().read(&position).unwrap()[0];
    let tangential = position.mesh_force * alpha.cos();
    let factor = root.tension.stress * common_facewidth(&pair) * module / tangential;
    let ratio = factor / (form * notch);
    assert!((0.8..1.25).contains(&ratio), "{factor} against {form} x {notch}");
    assert!((root.tension.tangent_angle.to_degrees() - 30.0).abs() < 15.0, "{root:?}");
}

/// 3-D roots lie between plane stress and plane strain at mid-face or near it, and cost a reading, not a solution.
#[test]
fn invariant_root_stress_of_a_solid() {
    let pair = common::pair(25, 31);
    let at = |face: FaceModel| {
        let model = PairModel::new(&pair, &options(face, 3, 1.0)).unwrap();
        let results = solve(&model, &[0.0]);
        model.root_stress_reader().read(&results[0]).unwrap()
    };
    let (thin, wide, solid) =
        (at(FaceModel::PlaneStress), at(FaceModel::PlaneStrain), at(FaceModel::Solid { order: 6 }));
    for ((thin, wide), solid) in thin.iter().zip(&wide).zip(&solid) {
        let [thin, wide, solid] = [thin, wide, solid].map(|root| root.tension.stress);
        assert!((thin / wide - 1.0).abs() < 0.05, "{thin} {wide}");
        // load and stress crowd toward mid-face by up to 1 / (1 - nu^2)
        assert!(solid > 0.97 * thin.min(wide) && solid < 1.15 * thin.max(wide), "{thin} {wide} {solid}");
    }
}

/// A crack relieves the fillet it starts from, and opens under load.
#[test]
fn invariant_cracked_tooth() {
    let pair = common::pair(25, 31);
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let healthy = PairModel::new(&pair, &options(face, 3, 1.0)).unwrap();
        let model = healthy.with_damage(&cracked(0.3)).unwrap();
        let results = solve(&model, &[-0.3, 0.0, 3.0]);
        let roots = |model: &PairModel| {
            let results = solve(model, &[0.0]);
            let roots = model.root_stress_reader().read(&results[0]).unwrap();
            roots.into_iter().find(|r| r.member == 0 && r.pair == 0).unwrap()
        };
        let (before, after) = (roots(&healthy), roots(&model));
        assert!(after.tension.stress < before.tension.stress, "{face:?}");
        assert!(after.compression.stress < before.compression.stress, "{face:?}");
        let reader = model.crack_tip_reader();
        let tips = reader.read_all(&results).unwrap();
        for tips in &tips[..2] {
            assert!(tips.iter().all(|tip| tip.k_one > 1e5 && tip.k_two.abs() < 0.8 * tip.k_one), "{tips:?}");
        }
        assert!(tips[2].iter().all(|tip| tip.k_one.abs() < 0.02 * tips[1][0].k_one), "far from its mesh: {tips:?}");
        assert!(healthy.crack_tip_reader().is_empty());
    }
}

/// `(K_I^2 + K_II^2) / E'` of a tooth against half the load times the growth of the transmission error with the crack.
#[test]
fn invariant_energy_released_by_a_growing_crack() {
    let pair = common::pair(25, 31);
    for (face, plane) in [(FaceModel::PlaneStress, 1.0), (FaceModel::PlaneStrain, 1.0 - 0.3_f64.powi(2))] {
        let healthy = PairModel::new(&pair, &options(face, 4, 1.5)).unwrap();
        for fraction in [0.15, 0.4, 0.7] {
            let at = |fraction: f64| {
                let model = healthy.with_damage(&cracked(fraction)).unwrap();
                let position = solve(&model, &[0.0]).remove(0);
                assert_eq!(position.loaded_pairs().count(), 1);
                let tip = model.crack_tip_reader().read(&position).unwrap()[0];
                let length = model.bodies()[0].sector(0).shape.crack.as_ref().unwrap().length;
                (position, tip, length)
            };
            let (less, same, more) = (at(fraction - 0.03), at(fraction), at(fraction + 0.03));
            let growth = more.0.static_transmission_error - less.0.static_transmission_error;
            let released = 0.5 * same.0.mesh_force * growth / (more.2 - less.2) / common_facewidth(&pair);
            let from_factors = same.1.release_rate(Material::STEEL.young_modulus / plane);
            assert!((from_factors / released - 1.0).abs() < 0.03, "{face:?} {fraction}: {from_factors} {released}");
        }
    }
}

fn common_facewidth(pair: &GearPair) -> f64 {
    pair.pinion().facewidth().min(pair.wheel().facewidth())
}
