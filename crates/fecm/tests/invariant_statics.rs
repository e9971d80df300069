//! What must hold for any pair: equilibrium, the same answer however teeth are numbered, whichever gear is called the pinion, however the
//! face is turned, whatever the degree in which finite elements and half-space are joined, and however many threads work.

mod common;

use common::{TORQUE, gear, pair};
use fecm::body::BoreCondition;
use fecm::element::lagrange::{LagrangeBasis, gauss_rule};
use fecm::statics::{PairModel, PairModelOptions, PositionResult, StaticsRequest};
use fecm::{FaceModel, SolverKind};
use gear_geom::{Damage, Gear, GearPair, Member, RootCrack, ToothDamage};
use nalgebra::{Rotation2, Vector2};

fn coarse(face: FaceModel) -> PairModelOptions {
    let mut options = PairModelOptions { face, ..PairModelOptions::default() };
    options.contact.face_cells = 12;
    options
}

fn solve(pair: &GearPair, options: &PairModelOptions, mesh_cycles: Vec<f64>, torque: f64) -> Vec<PositionResult> {
    let model = PairModel::new(pair, options).unwrap();
    let request = StaticsRequest::new(mesh_cycles, [torque]).keeping_pressure();
    model.solve(&request, &()).unwrap().results.remove(0)
}

fn close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance * a.abs().max(b.abs()), "{what}: {a} against {b}");
}

/// Reaction of the elastic hub on a gear: force (x, y) and moment about the axis, by integrating spring tractions over the bore.
fn hub_reaction(model: &PairModel, position: &PositionResult, member: usize, stiffness: f64, width: f64) -> [f64; 3] {
    let body = &model.bodies()[member];
    let field = model.deformation(position, member).unwrap();
    let order = body.sector(0).shape.mesh.order;
    let line = LagrangeBasis::new(order);
    let (mut shapes, mut slopes) = (vec![0.0; order + 1], vec![0.0; order + 1]);
    let teeth = (std::f64::consts::TAU / body.sector_angle()).round() as usize;
    let mut total = [0.0; 3];
    for sector in 0..teeth {
        let turn = Rotation2::new(body.sector_angle() * sector as f64);
        for edge in &body.sector(0).shape.rim {
            for (xi, weight) in gauss_rule(order + 2) {
                line.values_into(xi, &mut shapes);
                line.derivatives_into(xi, &mut slopes);
                let points = edge.iter().map(|&n| turn * body.sector(0).shape.mesh.nodes[n as usize].coords);
                let (mut place, mut tangent) = (Vector2::zeros(), Vector2::zeros());
                for ((point, shape), slope) in points.zip(&shapes).zip(&slopes) {
                    place += point * *shape;
                    tangent += point * *slope;
                }
                for (eta, face_weight) in gauss_rule(8) {
                    let z = 0.5 * width * eta;
                    let moved = edge.iter().zip(&shapes).fold(Vector2::zeros(), |sum, (&n, shape)| {
                        sum + field.at(body, sector, n as usize, z).xy() * *shape
                    });
                    let force = -stiffness * moved * weight * tangent.norm() * face_weight * 0.5 * width;
                    total[0] += force.x;
                    total[1] += force.y;
                    total[2] += place.x * force.y - place.y * force.x;
                }
            }
        }
    }
    total
}

/// Contact pressures as the finite elements received them: force and moment on a gear, its own frame.
fn contact_load(model: &PairModel, position: &PositionResult, member: usize, mirrored: bool) -> [f64; 3] {
    let body = &model.bodies()[member];
    let step = model.pairing().tooth_steps()[member];
    let mut total = [0.0; 3];
    for patch in &position.patches {
        let turn = Rotation2::new(body.sector_angle() * f64::from(patch.pair * step));
        let rolls = if member == 0 { &patch.pinion_roll } else { &patch.wheel_roll };
        let area = patch.cell[0] * patch.cell[1] * if mirrored { 2.0 } else { 1.0 };
        for (roll, pressures) in rolls.iter().zip(&patch.pressure) {
            let sector = body.sector(0);
            for (node, weight) in sector.nodal_load(&sector.station(*roll)) {
                let place = turn * sector.shape.mesh.nodes[node as usize].coords;
                let force = turn * weight * (pressures.iter().sum::<f64>() * area);
                total[0] += force.x;
                total[1] += force.y;
                total[2] += place.x * force.y - place.y * force.x;
            }
        }
    }
    total
}

#[test]
fn invariant_hub_reactions_balance_contact_forces_and_torque() {
    let stiffness = 2e13;
    for face in [FaceModel::PlaneStrain, FaceModel::Solid { order: 4 }] {
        let pair = pair(25, 31);
        let mut options = coarse(face);
        options.pinion.bore = BoreCondition::ElasticHub { stiffness };
        options.wheel.bore = BoreCondition::ElasticHub { stiffness };
        let model = PairModel::new(&pair, &options).unwrap();
        let mirrored = model.stats().symmetric && matches!(face, FaceModel::Solid { .. });
        let request = StaticsRequest::new([0.0, 0.45, 0.9], [TORQUE]).keeping_pressure();
        for at in &model.solve(&request, &()).unwrap().results[0] {
            assert!(at.stats.torque_residual < 1e-9, "{face:?} {}: {}", at.mesh_cycle, at.stats.torque_residual);
            assert!(at.stats.solver.kkt_violation < 1e-9 && at.stats.solver.complementarity < 1e-9);
            for member in 0..2 {
                let reaction = hub_reaction(&model, at, member, stiffness, 16e-3);
                let load = contact_load(&model, at, member, mirrored);
                let force = load[0].hypot(load[1]);
                for (k, scale) in [force, force, TORQUE].into_iter().enumerate() {
                    let out_of_balance = (reaction[k] + load[k]).abs() / scale;
                    assert!(
                        out_of_balance < 1e-9,
                        "{face:?} {} gear {member} component {k}: {out_of_balance}",
                        at.mesh_cycle
                    );
                }
            }
            // exact flanks against meshed ones: the polynomial edges deviate by their interpolation error
            let moment = contact_load(&model, at, 1, mirrored)[2].abs();
            close(moment, TORQUE, 1e-4, "contact moment about the wheel's axis");
        }
    }
}

#[test]
fn invariant_teeth_may_be_numbered_from_anywhere() {
    let pair = pair(17, 25);
    let cycles = vec![0.1, 0.35, 0.6, 0.85];
    let first = solve(&pair, &coarse(FaceModel::Solid { order: 4 }), cycles.clone(), TORQUE);
    for shift in [1, -3, 17, 400] {
        let later = cycles.iter().map(|c| c + f64::from(shift)).collect();
        for (a, b) in first.iter().zip(&solve(&pair, &coarse(FaceModel::Solid { order: 4 }), later, TORQUE)) {
            // mesh cycles of some hundreds cost three digits of the angle
            close(a.static_transmission_error, b.static_transmission_error, 1e-9, "transmission error");
            assert_eq!(a.pairs.len(), b.pairs.len());
            for (a, b) in a.pairs.iter().zip(&b.pairs) {
                assert_eq!(a.pair + shift, b.pair);
                assert!((a.force - b.force).abs() < 1e-7 * first[0].mesh_force);
            }
        }
    }
}

/// Calling the other gear the driver reflects the pair about its line of centres and reverses the motion.
#[test]
fn invariant_either_gear_may_drive() {
    let (forward, backward) = (pair(19, 31), pair(31, 19));
    let radius = |pair: &GearPair| pair.wheel().base_radius();
    let force = TORQUE / radius(&forward);
    // on the line of action: at tip edges the lever arms are no longer the base radii, so that equal torque on one gear is not equal on the other
    let cycles = [0.05, 0.3, 0.5];
    for face in [FaceModel::PlaneStress, FaceModel::Solid { order: 4 }] {
        let options = coarse(face);
        let driven = solve(&forward, &options, cycles.to_vec(), force * radius(&forward));
        let driving = solve(&backward, &options, cycles.iter().map(|c| -c).collect(), force * radius(&backward));
        for (a, b) in driven.iter().zip(&driving) {
            close(a.static_transmission_error, b.static_transmission_error, 2e-4, "transmission error");
            close(a.stiffness_average_slope.unwrap(), b.stiffness_average_slope.unwrap(), 2e-4, "stiffness");
        }
    }
}

#[test]
fn invariant_mirrored_lead_slope_mirrors_the_pressure() {
    let with_slope = |slope: f64| {
        let mut spec = gear(25).spec().clone();
        spec.modification.lead_slope = slope;
        let pair = GearPair::new(Gear::new(&spec).unwrap(), gear(31), 168e-3).unwrap();
        solve(&pair, &coarse(FaceModel::Solid { order: 5 }), vec![0.0, 0.5], TORQUE)
    };
    for (a, b) in with_slope(8e-6).iter().zip(&with_slope(-8e-6)) {
        close(a.static_transmission_error, b.static_transmission_error, 1e-9, "transmission error");
        let peak = a.peak_pressure();
        for (a, b) in a.patches.iter().zip(&b.patches) {
            for (a, b) in a.pressure.iter().zip(&b.pressure) {
                for (a, b) in a.iter().zip(b.iter().rev()) {
                    assert!((a - b).abs() < 1e-7 * peak, "{a} {b}");
                }
            }
        }
    }
}

/// The symmetric half-face model is the whole-face model with symmetric input.
#[test]
fn invariant_half_face_equals_whole_face() {
    let with_slope = |slope: f64| {
        let mut spec = gear(25).spec().clone();
        spec.modification.lead_crown = 6e-6;
        spec.modification.lead_slope = slope;
        let pair = GearPair::new(Gear::new(&spec).unwrap(), gear(31), 168e-3).unwrap();
        solve(&pair, &coarse(FaceModel::Solid { order: 4 }), vec![0.0, 0.5], TORQUE)
    };
    // a slope of 1e-15 m calls for the whole face and changes nothing
    for (half, whole) in with_slope(0.0).iter().zip(&with_slope(1e-15)) {
        close(half.static_transmission_error, whole.static_transmission_error, 1e-8, "transmission error");
        close(half.peak_pressure(), whole.peak_pressure(), 1e-6, "peak pressure");
    }
}

/// The finite elements add to the half-space what it lacks, and that is smooth: the degree of the polynomials in which it is exchanged does not matter, at
/// default density, with one pair and with two in contact on the involute, healthy and cracked.
#[test]
fn invariant_profile_order() {
    let pair = pair(25, 31);
    let crack = RootCrack::along_chord(pair.working_side(Member::Pinion), 0.4);
    let cracked = [vec![ToothDamage { tooth: 0, damage: Damage::Crack(crack) }], vec![]];
    for damage in [[vec![], vec![]], cracked] {
        for face in [FaceModel::PlaneStress, FaceModel::PlaneStrain, FaceModel::Solid { order: 6 }] {
            let with_order = |order: usize| {
                let mut options = PairModelOptions { damage: damage.clone(), ..coarse(face) };
                options.contact.profile_order = order;
                let positions = solve(&pair, &options, vec![0.0, 0.1, 0.4, 0.6], TORQUE);
                positions.iter().map(|at| at.static_transmission_error).collect::<Vec<_>>()
            };
            let usual = with_order(8);
            for order in [6, 7, 10] {
                for (other, usual) in with_order(order).iter().zip(&usual) {
                    close(*other, *usual, 1e-3, &format!("{face:?} order {order}"));
                }
            }
        }
    }
}

/// At the default density the finite elements leave little: against twice the elements of order 5.
#[test]
fn invariant_refined_finite_elements() {
    for face in [FaceModel::PlaneStress, FaceModel::PlaneStrain] {
        let [usual, fine] = [(3, 1.0), (5, 2.0)].map(|(order, density)| {
            let mut options = coarse(face);
            for member in [&mut options.pinion, &mut options.wheel] {
                (member.mesh.order, member.mesh.density) = (order, density);
            }
            solve(&pair(25, 31), &options, vec![0.0, 0.1, 0.4, 0.6], TORQUE)
        });
        for (usual, fine) in usual.iter().zip(&fine) {
            close(usual.static_transmission_error, fine.static_transmission_error, 1e-3, "transmission error");
        }
    }
}

#[test]
fn invariant_threads_do_not_change_a_bit() {
    let pair = pair(25, 31);
    let request = StaticsRequest::new((0..20).map(|k| f64::from(k) / 20.0).collect::<Vec<_>>(), [20.0, TORQUE])
        .with_stiffness_difference()
        .keeping_pressure();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let model = PairModel::new(&pair, &coarse(FaceModel::Solid { order: 4 })).unwrap();
            model.solve(&request, &()).unwrap().results
        })
    };
    let one = on(1);
    // PartialEq on f64 is equality of values: no rounding is forgiven
    assert_eq!(one, on(2));
    assert_eq!(one, on(7));
}

/// Both solvers on the real contact problem of a pair.
#[test]
fn invariant_solvers_agree_on_gear_contact() {
    let mut options = coarse(FaceModel::Solid { order: 4 });
    options.contact.face_cells = 6;
    let fast = solve(&pair(25, 31), &options, vec![0.0, 0.42], TORQUE);
    options.contact.solver = SolverKind::Lemke;
    for (a, b) in fast.iter().zip(&solve(&pair(25, 31), &options, vec![0.0, 0.42], TORQUE)) {
        close(a.static_transmission_error, b.static_transmission_error, 1e-10, "transmission error");
        close(a.peak_pressure(), b.peak_pressure(), 1e-9, "peak pressure");
    }
}

/// The exact tangent is the limit of differences: both must agree where no cell enters or leaves within 1 % of the torque.
#[test]
fn invariant_tangent_equals_differences_and_work() {
    let model = PairModel::new(&pair(25, 31), &coarse(FaceModel::PlaneStrain)).unwrap();
    let torques: Vec<f64> = (0..=40).map(|k| TORQUE * (0.9 + 0.005 * f64::from(k))).collect();
    let request = StaticsRequest::new([0.0], torques.clone()).with_stiffness_difference();
    let results = model.solve(&request, &()).unwrap().results;
    let radius = model.pairing().base_radius(1);
    // integral of compliance over the force gives the change of transmission error
    let compliance: Vec<f64> = results.iter().map(|r| 1.0 / r[0].stiffness_local_slope.unwrap()).collect();
    let step = (torques[1] - torques[0]) / radius;
    let integral: f64 = compliance.windows(2).map(|w| 0.5 * (w[0] + w[1]) * step).sum();
    let change = results[40][0].static_transmission_error - results[0][0].static_transmission_error;
    close(integral, change, 2e-3, "integral of the tangent compliance");
    for result in &results {
        let (exact, difference) =
            (result[0].stiffness_local_slope.unwrap(), result[0].stiffness_local_slope_difference.unwrap());
        close(exact, difference, 0.01, "local slope");
    }
}

#[test]
fn invariant_no_torque_is_first_touch() {
    // unloaded: first touch and nothing else
    let positions = solve(&pair(25, 31), &coarse(FaceModel::PlaneStrain), vec![0.0, 0.5], 0.0);
    for at in positions {
        assert!((at.static_transmission_error - at.no_load_transmission_error).abs() < 1e-15);
        assert!(at.loaded_pairs().next().is_none() && at.stiffness_local_slope.is_none());
    }
}
