//! Mass and hub-fixed modes of a gear: against the gear assembled as one body, closed forms and static completeness.

use std::collections::HashMap;

use faer::Mat;
use fecm::body::{BodyOptions, BoreCondition, GearBody, Station};
use fecm::condense::{CondensedBody, Substructure};
use fecm::face::{FaceBasis, Parity};
use fecm::linalg::{product, symmetric_eigen};
use fecm::mass::{BodyMass, RigidMotion};
use fecm::mesh::{MeshDensity, PlaneMesh, SectorMesh};
use fecm::modes::Twin;
use fecm::{FaceModel, GearModes, Material, ModesOptions};
use gear_geom::{FlankSide, Gear, GearSpec};
use nalgebra::{Point2, Rotation2};

mod common;

const WIDTH: f64 = 16e-3;
const COARSE: MeshDensity = MeshDensity { order: 2, density: 0.3 };

fn options(face: FaceModel, bore: BoreCondition, mesh: MeshDensity) -> BodyOptions {
    BodyOptions {
        mesh,
        face,
        width: WIDTH,
        bore,
        matching_depth: 0.9e-3,
        reach: 4,
        antisymmetric: matches!(face, FaceModel::Solid { .. }),
        cracks: Vec::new(),
    }
}

fn body(gear: &Gear, face: FaceModel, bore: BoreCondition, mesh: MeshDensity) -> GearBody {
    GearBody::new(gear, FlankSide::Upper, &Material::STEEL, &options(face, bore, mesh), "gear").unwrap()
}

fn all() -> ModesOptions {
    ModesOptions { count: 100_000, tolerance: 1e-12 }
}

/// All sectors as one mesh: nodes `(sector, node) -> number`, nodes on shared cuts merged.
fn full_ring(sector: &SectorMesh, teeth: usize) -> (PlaneMesh, Vec<Vec<u32>>) {
    let lower_of: HashMap<u32, u32> = sector.upper_cut.iter().copied().zip(sector.lower_cut.iter().copied()).collect();
    let mut numbers = vec![vec![u32::MAX; sector.mesh.nodes.len()]; teeth];
    let mut nodes = Vec::new();
    for (tooth, own) in numbers.iter_mut().enumerate() {
        for (node, number) in own.iter_mut().enumerate().filter(|(node, _)| !lower_of.contains_key(&(*node as u32))) {
            *number = nodes.len() as u32;
            let turned = Rotation2::new(sector.sector_angle * tooth as f64) * sector.mesh.nodes[node].coords;
            nodes.push(Point2::from(turned));
        }
    }
    for tooth in 0..teeth {
        for (&upper, &lower) in &lower_of {
            numbers[tooth][upper as usize] = numbers[(tooth + 1) % teeth][lower as usize];
        }
    }
    let connectivity =
        numbers.iter().flat_map(|own| sector.mesh.connectivity.iter().map(|&node| own[node as usize])).collect();
    (PlaneMesh { order: sector.mesh.order, nodes, connectivity }, numbers)
}

/// The whole gear as one body: eigenpairs by dense algebra, and what is needed to compare with it.
struct FullGear {
    numbers: Vec<Vec<u32>>,
    mesh: PlaneMesh,
    basis: FaceBasis,
    condensed: CondensedBody,
    mass: BodyMass,
    frequencies: Vec<f64>,
}

impl FullGear {
    fn new(body: &GearBody, family: usize, spring: Option<f64>) -> Self {
        let shape = &body.sector(0).shape;
        let (mesh, numbers) = full_ring(shape, body.teeth() as usize);
        let basis = body.families[family].basis.clone();
        let rim: Vec<Vec<u32>> = numbers
            .iter()
            .flat_map(|own| shape.rim.iter().map(|edge| edge.iter().map(|&n| own[n as usize]).collect::<Vec<u32>>()))
            .collect();
        let fixed = if spring.is_none() { rim.concat() } else { Vec::new() };
        let springs = spring.map(|k| (k, rim.as_slice()));
        let condensed =
            CondensedBody::new(&Substructure { mesh: &mesh, retained: Vec::new(), fixed, springs }, &basis).unwrap();
        let mass = BodyMass::new(&mesh, &basis, Material::STEEL.density);
        let mut full = Self { numbers, mesh, basis, condensed, mass, frequencies: Vec::new() };
        full.frequencies = full.solve();
        full
    }

    /// Rows of node fields that are free, in the order of the condensed interior.
    fn free_rows(&self) -> Vec<usize> {
        let block = self.basis.block();
        let mut rows = vec![0; self.condensed.interior_size()];
        for node in 0..self.mesh.nodes.len() {
            for dof in 0..block {
                if let Some(row) = self.condensed.interior_row(node as u32, dof) {
                    rows[row] = node * block + dof;
                }
            }
        }
        rows
    }

    /// Node fields of all modes of a family, in the axes of tooth 0.
    fn fields(&self, body: &GearBody, modes: &GearModes, family: usize) -> Mat<f64> {
        let range = modes.of_family(family);
        let block = self.basis.block();
        let mut fields = Mat::zeros(self.mesh.nodes.len() * block, range.len());
        for k in 0..range.len() {
            let mut coordinates = vec![0.0; range.len()];
            coordinates[k] = 1.0;
            for (tooth, numbers) in self.numbers.iter().enumerate() {
                let own = modes.sector_field(family, tooth as i32, &coordinates);
                let (sine, cosine) = (body.sector_angle() * tooth as f64).sin_cos();
                for (node, &number) in numbers.iter().enumerate() {
                    let (from, to) = (&own[node * block..(node + 1) * block], number as usize * block);
                    for (dof, function) in self.basis.dofs().iter().enumerate() {
                        fields[(to + dof, k)] = match function.component {
                            0 => cosine * from[dof] - sine * from[dof + 1],
                            1 => sine * from[dof - 1] + cosine * from[dof],
                            _ => from[dof],
                        };
                    }
                }
            }
        }
        fields
    }

    /// `M^(1/2) K^-1 M^(1/2)`, dense.
    fn solve(&self) -> Vec<f64> {
        let rows = self.free_rows();
        let n = rows.len();
        let mut units = Mat::zeros(self.mesh.nodes.len() * self.basis.block(), n);
        for (k, &row) in rows.iter().enumerate() {
            units[(row, k)] = 1.0;
        }
        let moved = self.mass.apply(&units);
        let mass = Mat::from_fn(n, n, |i, j| moved[(rows[i], j)]);
        let (values, vectors) = symmetric_eigen(&mass, "mass").unwrap();
        let scaled = Mat::from_fn(n, n, |i, j| vectors[(i, j)] * values[j].sqrt());
        let root = product(scaled.as_ref(), vectors.transpose());
        let mut moved = root.clone();
        self.condensed.solve_interior(&mut moved);
        let a = product(root.as_ref(), moved.as_ref());
        let check = |name: &str, a: &Mat<f64>| {
            let mut a = a.clone();
            fecm::linalg::symmetrise(&mut a);
            let (l, v) = symmetric_eigen(&a, "full gear").unwrap();
            let av = product(a.as_ref(), v.as_ref());
            let vv = product(v.transpose(), v.as_ref());
            let mut r = 0.0_f64; let mut o = 0.0_f64; let mut t=0.0;
            for i in 0..n { t += a[(i,i)] - l[i]; for j in 0..n { r = r.max((av[(i,j)] - v[(i,j)]*l[j]).abs()); o = o.max((vv[(i,j)] - f64::from(u8::from(i==j))).abs()); } }
            eprintln!("{name} n {n} residual {:e} orth {:e} trace {:e}", r / l[n-1], o, t/l[n-1]);
        };
        check("mass", &mass);
        check("operator", &a);
        let (values, _) = symmetric_eigen(&a, "full gear").unwrap();
        values.iter().rev().map(|value| 1.0 / value.sqrt()).collect()
    }
}

fn small_gear() -> Gear {
    common::gear(9)
}

#[test]
fn invariant_cyclic_modes_equal_those_of_the_full_gear() {
    let gear = small_gear();
    for (face, bore, spring) in [
        (FaceModel::PlaneStress, BoreCondition::RigidHub, None),
        (FaceModel::PlaneStrain, BoreCondition::ElasticHub { stiffness: 3e13 }, Some(3e13)),
        (FaceModel::Solid { order: 1 }, BoreCondition::RigidHub, None),
    ] {
        let body = body(&gear, face, bore, COARSE);
        let modes = GearModes::new(&body, &all()).unwrap();
        for family in 0..body.families.len() {
            let full = FullGear::new(&body, family, spring);
            let own = &modes.modes[modes.of_family(family)];
            let fields = full.fields(&body, &modes, family);
            let moved = full.mass.apply(&fields);
            let gram = product(fields.transpose(), moved.as_ref());
            let rows = full.free_rows();
            let mut solved = Mat::from_fn(rows.len(), moved.ncols(), |i, k| moved[(rows[i], k)]);
            full.condensed.solve_interior(&mut solved);
            for k in 0..own.len() {
                for j in 0..own.len() {
                    let unit = f64::from(u8::from(j == k));
                    if (gram[(j, k)] - unit).abs() > 1e-9 {eprintln!("{j} {k} gram {} ", gram[(j,k)]);}
                }
                let w = own[k].angular_frequency.powi(2);
                let most = rows.iter().map(|&r| fields[(r,k)].abs()).fold(0.0, f64::max);
                let worst = rows.iter().enumerate().map(|(i, &row)| (w * solved[(i, k)] - fields[(row, k)]).abs()).fold(0.0, f64::max);
                if worst > 1e-8 * most { eprintln!("{k} h {} {} {worst} of {most}", own[k].nodal_diameter, own[k].angular_frequency);}
            }
            assert_eq!(own.len(), full.frequencies.len(), "{face:?}: every mode is found");
            // the high end is the inverse of the smallest values of a dense inverse: rounding grows there
            for (k, (mode, exact)) in own.iter().zip(&full.frequencies).enumerate().take(own.len() / 2) {
                let error = mode.angular_frequency / exact - 1.0;
                if error.abs() > 1e-10 { eprintln!("{k} h {} {:?} {} {error:e}", mode.nodal_diameter, mode.twin, mode.angular_frequency); }
                assert!(error.abs() < 1e-3, "{face:?} family {family} mode {k}: {mode:?} against {exact}");
            }
        }
    }
}
