//! Condensed sectors and closed ring against the uncondensed full gear, assembled as one body.

mod common;

use std::collections::HashMap;

use faer::Mat;
use fecm::body::{BodyOptions, BoreCondition, GearBody};
use fecm::condense::{CondensedBody, Substructure};
use fecm::face::{FaceBasis, Parity};
use fecm::mesh::{MeshDensity, PlaneMesh, SectorMesh};
use fecm::{FaceModel, Material};
use gear_geom::{FlankSide, Gear, GearSpec};
use nalgebra::{Point2, Rotation2};

fn gear() -> Gear {
    Gear::new(&GearSpec::standard(17, 6e-3).with(|spec| {
        spec.tip_radius = 57e-3;
        spec.root_radius = 43.5e-3;
        spec.rim_radius = 25e-3;
        spec.facewidth = 16e-3;
    }))
    .unwrap()
}

/// All sectors as one mesh: nodes `(sector, node) -> number`, nodes on shared cuts merged.
fn full_ring(sector: &SectorMesh, teeth: usize) -> (PlaneMesh, impl Fn(usize, u32) -> u32) {
    let per_sector = sector.mesh.nodes.len();
    let lower_of: HashMap<u32, u32> = sector.upper_cut.iter().copied().zip(sector.lower_cut.iter().copied()).collect();
    let mut numbers = vec![vec![u32::MAX; per_sector]; teeth];
    let mut nodes = Vec::new();
    for (tooth, own) in numbers.iter_mut().enumerate() {
        for node in 0..per_sector {
            if !lower_of.contains_key(&(node as u32)) {
                own[node] = nodes.len() as u32;
                let turned = Rotation2::new(sector.sector_angle * tooth as f64) * sector.mesh.nodes[node].coords;
                nodes.push(Point2::from(turned));
            }
        }
    }
    for tooth in 0..teeth {
        for (&upper, &lower) in &lower_of {
            numbers[tooth][upper as usize] = numbers[(tooth + 1) % teeth][lower as usize];
        }
    }
    let connectivity = (0..teeth)
        .flat_map(|t| sector.mesh.connectivity.iter().map(|&n| numbers[t][n as usize]).collect::<Vec<_>>())
        .collect();
    (PlaneMesh { order: sector.mesh.order, nodes, connectivity }, move |tooth, node| numbers[tooth][node as usize])
}

fn options(face: FaceModel, bore: BoreCondition, mesh: MeshDensity) -> BodyOptions {
    BodyOptions {
        mesh,
        face,
        width: 16e-3,
        bore,
        profile_order: 10,
        edge_correction: true,
        reach: 3,
        antisymmetric: false,
        cracks: Vec::new(),
    }
}

#[test]
fn invariant_cyclic_condensation_equals_the_full_gear() {
    let gear = gear();
    let mesh = MeshDensity { order: 2, density: 0.7 };
    for (face, bore, spring) in [
        (FaceModel::PlaneStress, BoreCondition::RigidHub, None),
        (FaceModel::PlaneStrain, BoreCondition::ElasticHub { stiffness: 3e13 }, Some(3e13)),
        (FaceModel::Solid { order: 3 }, BoreCondition::RigidHub, None),
    ] {
        let body =
            GearBody::new(&gear, FlankSide::Upper, &Material::STEEL, &options(face, bore, mesh), "gear").unwrap();
        let teeth = gear.teeth() as usize;
        let (whole, number) = full_ring(&body.sector(0).shape, teeth);
        let basis = FaceBasis::new(face, Parity::Symmetric, 16e-3, &Material::STEEL).unwrap();
        let rim: Vec<Vec<u32>> = (0..teeth)
            .flat_map(|t| {
                body.sector(0)
                    .shape
                    .rim
                    .iter()
                    .map(|edge| edge.iter().map(|&n| number(t, n)).collect())
                    .collect::<Vec<Vec<u32>>>()
            })
            .collect();
        let full = CondensedBody::new(
            &Substructure {
                mesh: &whole,
                retained: Vec::new(),
                fixed: if spring.is_none() { rim.concat() } else { Vec::new() },
                springs: spring.map(|k| (k, rim.as_slice())),
                rich: &[],
            },
            &basis,
        )
        .unwrap();
        let functions = basis.plane_degrees().len();
        let rolls = [0.022, 0.026, 0.030];
        let stations: Vec<_> = rolls.iter().map(|&s| body.sector(0).station(s)).collect();
        // station weights again from their definition
        let weights = |roll: f64| {
            let arc = roll * roll / (2.0 * gear.base_radius());
            common::flank::unit_load(&body.sector(0).shape, &gear, FlankSide::Upper, 10, arc)
        };
        for offset in [1_i32, 2, -1, -3] {
            let cross = body.compliance(0, (offset, &stations), (0, &stations));
            let mut loads = Mat::zeros(full.interior_size(), rolls.len() * functions);
            for (j, &roll) in rolls.iter().enumerate() {
                for (node, weight) in weights(roll) {
                    for k in 0..functions {
                        for c in 0..2 {
                            let row = full.interior_row(number(0, node), 2 * k + c).unwrap();
                            loads[(row, j * functions + k)] += weight[c];
                        }
                    }
                }
            }
            full.solve_interior(&mut loads);
            let tooth = offset.rem_euclid(teeth as i32) as usize;
            let turn = Rotation2::new(body.sector_angle() * tooth as f64);
            let mut largest = 0.0_f64;
            let mut worst = 0.0_f64;
            for (i, &roll) in rolls.iter().enumerate() {
                for k in 0..functions {
                    for j in 0..rolls.len() * functions {
                        let mut value = 0.0;
                        for (node, weight) in weights(roll) {
                            let normal = turn * weight;
                            for c in 0..2 {
                                let row = full.interior_row(number(tooth, node), 2 * k + c).unwrap();
                                value += normal[c] * loads[(row, j)];
                            }
                        }
                        largest = largest.max(value.abs());
                        worst = worst.max((value - cross[(i * functions + k, j)]).abs());
                    }
                }
            }
            assert!(worst < 1e-9 * largest, "{face:?} {bore:?} offset {offset}: {worst} of {largest}");
        }
    }
}

/// Loads and displacements exchange roles: symmetric compliance; and work is positive.
#[test]
fn invariant_compliance_is_reciprocal_and_positive_definite() {
    let gear = gear();
    let body = GearBody::new(
        &gear,
        FlankSide::Upper,
        &Material::STEEL,
        &options(FaceModel::Solid { order: 4 }, BoreCondition::RigidHub, MeshDensity::default()),
        "gear",
    )
    .unwrap();
    let stations: Vec<_> = [0.021, 0.024, 0.027, 0.030].iter().map(|&s| body.sector(0).station(s)).collect();
    let own = body.compliance(0, (0, &stations), (0, &stations));
    let n = own.nrows();
    assert!((0..n).all(|i| (0..n).all(|j| own[(i, j)] == own[(j, i)])));
    assert!(fecm::linalg::DenseCholesky::new(own, "own compliance").is_ok());
    // between teeth: one way and back
    let there = body.compliance(0, (1, &stations), (0, &stations));
    let back = body.compliance(0, (-1, &stations), (0, &stations));
    for i in 0..n {
        for j in 0..n {
            assert!((there[(i, j)] - back[(j, i)]).abs() < 1e-12 * there[(0, 0)].abs());
        }
    }
}

/// Refining the mesh changes the compliance under smooth loads little: what the defaults leave is below 0.3 %.
#[test]
fn order_compliance_converges_with_the_mesh() {
    let gear = gear();
    let at = |order, density| {
        let mesh = MeshDensity { order, density };
        let body = GearBody::new(
            &gear,
            FlankSide::Upper,
            &Material::STEEL,
            &options(FaceModel::PlaneStress, BoreCondition::RigidHub, mesh),
            "gear",
        )
        .unwrap();
        let stations = [body.sector(0).station(0.026)];
        body.compliance(0, (0, &stations), (0, &stations))[(0, 0)]
    };
    let fine = at(5, 2.0);
    let errors: Vec<f64> = (1..=4).map(|order| (at(order, 1.0) / fine - 1.0).abs()).collect();
    assert!(errors[1] < 0.3 * errors[0] && errors[3] < errors[1], "errors by order {errors:?}");
    assert!(errors[2] < 3e-3, "default order 3: {}", errors[2]);
}
