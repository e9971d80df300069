//! Elements and assembly against exact elasticity solutions.
//!
//! * patch test: linear displacements are reproduced on a distorted mesh, every order, plane and solid;
//! * convergence order: a harmonic exact solution on a curved mesh, fitted slope over four meshes for orders 1 to 4;
//! * thick ring under internal pressure (Lame; Timoshenko and Goodier, *Theory of Elasticity*, 1970, section 28);
//! * cantilever under end shear with the exact displacement of Timoshenko and Goodier, section 21.

use faer::Mat;
use fecm::condense::{CondensedBody, Substructure};
use fecm::element::ReferenceQuad;
use fecm::element::lagrange::gauss_rule;
use fecm::face::{FaceBasis, FaceModel, Parity};
use fecm::material::Material;
use fecm::mesh::PlaneMesh;
use fecm::mesh::blocks::BlockMesher;
use nalgebra::{Point2, Vector2};

fn steel(model: FaceModel, parity: Parity, width: f64) -> FaceBasis {
    FaceBasis::new(model, parity, width, &Material::STEEL).unwrap()
}

/// A block of `nx` by `ny` elements mapped from the unit square.
fn mapped_block(order: usize, nx: usize, ny: usize, map: impl Fn(f64, f64) -> Point2<f64>) -> Block {
    let breaks = |n: usize| (0..=n).map(|k| k as f64 / n as f64).collect::<Vec<_>>();
    let mut mesher = BlockMesher::new(order);
    let corner = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(u, v)| mesher.vertex(map(u, v)));
    let bottom = mesher.edge(corner[0], corner[1], &breaks(nx), |u| map(u, 0.0));
    let top = mesher.edge(corner[2], corner[3], &breaks(nx), |u| map(u, 1.0));
    let left = mesher.edge(corner[0], corner[2], &breaks(ny), |v| map(0.0, v));
    let right = mesher.edge(corner[1], corner[3], &breaks(ny), |v| map(1.0, v));
    mesher.block(&bottom, &top, &left, &right);
    let sides = [&bottom, &top, &left, &right].map(|edge| edge.nodes().to_vec());
    let mesh = mesher.finish();
    mesh.check(&ReferenceQuad::new(order), "test").unwrap();
    Block { mesh, sides }
}

struct Block {
    mesh: PlaneMesh,
    /// Bottom, top, left, right.
    sides: [Vec<u32>; 4],
}

impl Block {
    fn boundary(&self) -> Vec<u32> {
        let mut nodes = self.sides.concat();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Interior displacements when the boundary has those of `field` (per node, all unknowns of a node): node and unknowns.
    fn solve_with_boundary(&self, basis: &FaceBasis, field: impl Fn(Point2<f64>) -> Vec<f64>) -> Vec<(u32, Vec<f64>)> {
        let boundary = self.boundary();
        let body = Substructure {
            mesh: &self.mesh,
            retained: boundary.iter().map(|&n| (n, 0.0)).collect(),
            fixed: Vec::new(),
            springs: None,
            rich: &[],
        };
        let condensed = CondensedBody::new(&body, basis).unwrap();
        let block = basis.block();
        let prescribed: Vec<f64> = boundary.iter().flat_map(|&n| field(self.mesh.nodes[n as usize])).collect();
        let solution = condensed.retained_solution();
        let at = |node: u32| -> Option<Vec<f64>> {
            (0..block)
                .map(|d| {
                    let row = condensed.interior_row(node, d)?;
                    Some(-prescribed.iter().enumerate().map(|(j, u)| solution[(row, j)] * u).sum::<f64>())
                })
                .collect()
        };
        (0..self.mesh.nodes.len() as u32).filter_map(|n| at(n).map(|u| (n, u))).collect()
    }
}

fn distorted(u: f64, v: f64) -> Point2<f64> {
    Point2::new(u + 0.15 * v + 0.1 * u * v, 0.8 * v + 0.1 * u - 0.12 * u * v)
}

#[test]
fn analytic_patch_linear_displacement_is_exact() {
    for order in 1..=4 {
        for model in [FaceModel::PlaneStress, FaceModel::PlaneStrain] {
            let basis = steel(model, Parity::Symmetric, 0.3);
            let field = |p: Point2<f64>| vec![1e-3 * p.x + 2e-3 * p.y + 0.1, -3e-3 * p.x + 0.5e-3 * p.y];
            let block = mapped_block(order, 3, 3, distorted);
            for (node, u) in block.solve_with_boundary(&basis, field) {
                let exact = field(block.mesh.nodes[node as usize]);
                assert!((u[0] - exact[0]).abs() < 1e-12 && (u[1] - exact[1]).abs() < 1e-12, "order {order} {model:?}");
            }
        }
    }
}

/// Uniaxial stress along x: the solid contracts across the face, which plane stress has built in.
#[test]
fn analytic_patch_solid_uniaxial_stress() {
    let width = 0.3;
    let nu = Material::STEEL.poisson_ratio;
    for parity_order in [1, 4, 5] {
        let basis = steel(FaceModel::Solid { order: parity_order }, Parity::Symmetric, width);
        let field = |p: Point2<f64>| {
            let mut u = vec![0.0; basis.block()];
            u[0] = 1e-3 * p.x;
            u[1] = -nu * 1e-3 * p.y;
            // u_z = -nu e z = -nu e (b / 2) P_1
            let axial = basis.dofs().iter().position(|d| d.component == 2 && d.degree == 1).unwrap();
            u[axial] = -nu * 1e-3 * 0.5 * width;
            u
        };
        let block = mapped_block(2, 3, 3, distorted);
        for (node, u) in block.solve_with_boundary(&basis, field) {
            let exact = field(block.mesh.nodes[node as usize]);
            for (a, b) in u.iter().zip(&exact) {
                assert!((a - b).abs() < 1e-12, "face order {parity_order}: {a} against {b}");
            }
        }
    }
}

/// Plane strain with `u = grad phi`, `phi` harmonic: equilibrium without body force. Error in the interior falls as `h^(p + 1)`.
#[test]
fn order_displacement_on_curved_mesh() {
    let curved = |u: f64, v: f64| {
        let (radius, angle) = (1.0 + u, 0.9 * v + 0.1 * u);
        Point2::new(radius * angle.cos(), radius * angle.sin())
    };
    // phi = exp(x) cos(y)
    let field = |p: Point2<f64>| vec![p.x.exp() * p.y.cos(), -p.x.exp() * p.y.sin()];
    let basis = steel(FaceModel::PlaneStrain, Parity::Symmetric, 1.0);
    for order in 1..=4 {
        let meshes: &[usize] = if order <= 2 { &[4, 6, 8, 12] } else { &[2, 3, 4, 6] };
        let errors: Vec<(f64, f64)> = meshes
            .iter()
            .map(|&n| {
                let block = mapped_block(order, n, n, curved);
                let (mut sum, mut count) = (0.0, 0.0);
                for (node, u) in block.solve_with_boundary(&basis, field) {
                    let exact = field(block.mesh.nodes[node as usize]);
                    sum += (u[0] - exact[0]).powi(2) + (u[1] - exact[1]).powi(2);
                    count += 1.0;
                }
                ((1.0 / n as f64).ln(), (sum / count).sqrt().ln())
            })
            .collect();
        let slope = fitted_slope(&errors);
        assert!(slope > order as f64 + 0.7, "order {order}: fitted slope {slope}");
    }
}

fn fitted_slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (sx, sy): (f64, f64) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x, b + y));
    let (mx, my) = (sx / n, sy / n);
    let top: f64 = points.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    top / points.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

/// Consistent nodal loads of a traction along a side, per unit face (degree-0 functions).
fn edge_loads(block: &Block, side: usize, traction: impl Fn(Point2<f64>) -> Vector2<f64>) -> Vec<(u32, Vector2<f64>)> {
    let order = block.mesh.order;
    let quad = ReferenceQuad::new(order);
    let nodes = &block.sides[side];
    let mut loads = Vec::new();
    let (mut shapes, mut slopes) = (vec![0.0; order + 1], vec![0.0; order + 1]);
    for element in 0..(nodes.len() - 1) / order {
        let edge = &nodes[element * order..=(element + 1) * order];
        for (x, weight) in gauss_rule(order + 3) {
            quad.basis().values_into(x, &mut shapes);
            quad.basis().derivatives_into(x, &mut slopes);
            let at = |c: &[f64]| {
                edge.iter().zip(c).fold(Vector2::zeros(), |s, (&n, c)| s + block.mesh.nodes[n as usize].coords * *c)
            };
            let force = traction(Point2::from(at(&shapes))) * (weight * at(&slopes).norm());
            loads.extend(edge.iter().zip(&shapes).map(|(&n, shape)| (n, force * *shape)));
        }
    }
    loads
}

#[test]
fn analytic_thick_ring_under_pressure() {
    let (inner, outer, pressure, width): (f64, f64, f64, f64) = (0.03, 0.06, 50e6, 0.01);
    let (e, nu) = (Material::STEEL.young_modulus, Material::STEEL.poisson_ratio);
    for (model, e_eff, nu_eff) in [
        (FaceModel::PlaneStress, e, nu),
        (FaceModel::PlaneStrain, e / (1.0 - nu * nu), nu / (1.0 - nu)),
        (FaceModel::Solid { order: 3 }, e, nu),
    ] {
        let angle = std::f64::consts::PI / 6.0;
        // sector of a twelfth: columns tangential so that left and right are the radial cuts
        let block = mapped_block(3, 2, 4, |u, v| {
            let (r, t) = (inner + (outer - inner) * v, angle * (0.5 - u));
            Point2::new(r * t.cos(), r * t.sin())
        });
        let basis = steel(model, Parity::Symmetric, width);
        let retained =
            block.sides[3].iter().map(|&n| (n, -0.5 * angle)).chain(block.sides[2].iter().map(|&n| (n, 0.5 * angle)));
        // weak springs on the outside hold the ring against rigid motion; balanced pressure does not load them tangentially
        let springs: Vec<Vec<u32>> = block.sides[1].windows(4).step_by(3).map(<[u32]>::to_vec).collect();
        let body = Substructure {
            mesh: &block.mesh,
            retained: retained.collect(),
            fixed: Vec::new(),
            springs: Some((1e-9 * e / outer, &springs)),
            rich: &[],
        };
        let condensed = CondensedBody::new(&body, &basis).unwrap();
        let mut load = Mat::zeros(condensed.interior_size(), 1);
        let n = condensed.stiffness().nrows() / 2;
        let mut cut = Mat::<f64>::zeros(n, 1);
        for (node, force) in edge_loads(&block, 0, |p| p.coords.normalize() * pressure * width) {
            let at = block.mesh.nodes[node as usize];
            let radial = force.dot(&at.coords.normalize());
            for (d, component) in [force.x, force.y].into_iter().enumerate() {
                if let Some(row) = condensed.interior_row(node, d) {
                    load[(row, 0)] += component;
                }
            }
            if let Some(row) = condensed.retained_row(node, 0) {
                cut[(row % n, 0)] += radial;
            }
        }
        // every sector carries the same: close the sector on itself
        let load_only = load.clone();
        condensed.solve_interior(&mut load);
        let x = condensed.retained_solution();
        let reduced = x.transpose() * &load_only;
        for i in 0..n {
            cut[(i, 0)] -= reduced[(i, 0)] + reduced[(n + i, 0)];
        }
        let s = condensed.stiffness();
        let closed = Mat::from_fn(n, n, |i, j| s[(i, j)] + s[(n + i, j)] + s[(i, n + j)] + s[(n + i, n + j)]);
        let closed = fecm::linalg::DenseCholesky::new(closed, "ring").unwrap();
        closed.solve_in_place(cut.as_mut());
        for &(radius, node) in &[(inner, block.sides[3][0]), (outer, block.sides[3][block.sides[3].len() - 1])] {
            let row = condensed.retained_row(node, 0).unwrap() % n;
            let (a2, b2) = (inner * inner, outer * outer);
            let exact = pressure * a2 / (e_eff * (b2 - a2)) * ((1.0 - nu_eff) * radius + (1.0 + nu_eff) * b2 / radius);
            let error = cut[(row, 0)] / exact - 1.0;
            assert!(error.abs() < 2e-5, "{model:?} r = {radius}: relative error {error}");
        }
    }
}

/// Timoshenko and Goodier section 21: displacements of a beam under end shear, prescribed on its boundary except that the end is loaded by
/// the parabolic shear. The field is cubic, so order 3 reproduces it to rounding.
#[test]
fn analytic_cantilever_with_parabolic_end_shear() {
    let (length, depth, force, width): (f64, f64, f64, f64) = (0.1, 0.02, 1000.0, 0.01);
    let (e, nu) = (Material::STEEL.young_modulus, Material::STEEL.poisson_ratio);
    let inertia = width * depth.powi(3) / 12.0;
    // origin at mid-depth of the held end, x along the beam, load `force` in +y at x = length
    let exact = |p: Point2<f64>| {
        let (x, y) = (p.x, p.y);
        let u = -force * y / (6.0 * e * inertia)
            * ((6.0 * length - 3.0 * x) * x + (2.0 + nu) * (y * y - 0.25 * depth * depth));
        let v = force / (6.0 * e * inertia)
            * (3.0 * nu * y * y * (length - x)
                + (4.0 + 5.0 * nu) * 0.25 * depth * depth * x
                + (3.0 * length - x) * x * x);
        vec![u, v]
    };
    let block = mapped_block(3, 4, 2, |u, v| Point2::new(length * u, depth * (v - 0.5)));
    let basis = steel(FaceModel::PlaneStress, Parity::Symmetric, width);
    let held = &block.sides[2];
    let body = Substructure {
        mesh: &block.mesh,
        retained: held.iter().map(|&n| (n, 0.0)).collect(),
        fixed: Vec::new(),
        springs: None,
        rich: &[],
    };
    let condensed = CondensedBody::new(&body, &basis).unwrap();
    let mut load = Mat::zeros(condensed.interior_size(), 1);
    for (node, f) in edge_loads(&block, 3, |p| {
        Vector2::new(0.0, force / (2.0 * inertia) * (0.25 * depth * depth - p.y * p.y) * width)
    }) {
        for (d, component) in [f.x, f.y].into_iter().enumerate() {
            load[(condensed.interior_row(node, d).unwrap(), 0)] += component;
        }
    }
    condensed.solve_interior(&mut load);
    let prescribed: Vec<f64> = held.iter().flat_map(|&n| exact(block.mesh.nodes[n as usize])).collect();
    let x = condensed.retained_solution();
    let tip = force * length.powi(3) / (3.0 * e * inertia);
    for node in 0..block.mesh.nodes.len() as u32 {
        for d in 0..2 {
            let Some(row) = condensed.interior_row(node, d) else { continue };
            let held_part: f64 = prescribed.iter().enumerate().map(|(j, u)| x[(row, j)] * u).sum();
            let error = load[(row, 0)] - held_part - exact(block.mesh.nodes[node as usize])[d];
            assert!(error.abs() < 1e-9 * tip, "node {node}: {error} of {tip}");
        }
    }
}
