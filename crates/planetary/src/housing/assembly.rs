//! Stiffness and mass of a mesh: assembled, factored, applied.
//!
//! With gradients `g_i` of the shape functions and Lame's constants, the stiffness between nodes `i` and `j` is the 3 x 3 block
//! `int lambda g_i g_j^T + mu g_j g_i^T + mu (g_i . g_j) 1 dV`, and the mass `int rho N_i N_j dV` times 1 (Zienkiewicz, Taylor and Zhu,
//! chapter 2). Incompatible modes enter as further functions with gradients `(j_0 / j) J_0^-T dN` (0: middle of the element), which keeps the
//! patch test, and are condensed out of the element.

use faer::Mat;
use fecm::linalg::{BlockCholesky, BlockMatrix, DenseCholesky, add_product};
use fecm::modes::krylov::Pencil;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::error::HousingError;
use super::held;
use super::mesh::{Element, Rules, SolidMesh};

/// Elements computed at a time.
const CHUNK: usize = 128;

/// A spring to the ground at a node: a symmetric 3 x 3 matrix (N/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeSpring {
    /// The node.
    pub node: u32,
    /// Its stiffness.
    pub stiffness: Matrix3<f64>,
}

/// Stiffness, factored, and mass of a held mesh.
pub struct Structure {
    factor: BlockCholesky,
    mass: NodeMatrix,
    /// Place of each node among the free ones; `u32::MAX` where it is fixed.
    numbers: Vec<u32>,
    free: Vec<u32>,
}

/// Symmetric sparse matrix with one number per pair of nodes.
struct NodeMatrix {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

struct ElementMatrices {
    /// 3 x 3 blocks in the order of the nodes.
    stiffness: Mat<f64>,
    mass: Mat<f64>,
}

impl Structure {
    /// Assembles and factors a mesh with springs, and nodes that do not move.
    ///
    /// # Errors
    /// [`HousingError::NotHeld`], [`HousingError::InvertedElement`], faults of the mesh.
    pub fn new(mesh: &SolidMesh, springs: &[NodeSpring], fixed: &[u32]) -> Result<Self, HousingError> {
        mesh.validate()?;
        held::check(mesh, springs, fixed)?;
        let mut used = vec![false; mesh.nodes.len()];
        for &node in mesh.elements.iter().flat_map(|element| &element.nodes) {
            used[node as usize] = true;
        }
        // nodes of no element have neither stiffness nor mass
        for &node in fixed {
            used[node as usize] = false;
        }
        let free: Vec<u32> = (0..mesh.nodes.len() as u32).filter(|&node| used[node as usize]).collect();
        let mut numbers = vec![u32::MAX; mesh.nodes.len()];
        for (number, &node) in free.iter().enumerate() {
            numbers[node as usize] = number as u32;
        }
        let (matrix, mass) = assemble(mesh, springs, &numbers, free.len())?;
        let factor = matrix.cholesky("housing stiffness")?;
        Ok(Self { factor, mass, numbers, free })
    }

    /// Place of a node among the free ones.
    #[must_use]
    pub fn number(&self, node: u32) -> Option<usize> {
        self.numbers.get(node as usize).copied().filter(|&number| number != u32::MAX).map(|number| number as usize)
    }

    /// The nodes that are free, in order.
    #[must_use]
    pub fn free_nodes(&self) -> &[u32] {
        &self.free
    }

    /// Entries of the factor.
    #[must_use]
    pub fn factor_entries(&self) -> usize {
        self.factor.factor_entries()
    }
}

impl Pencil for Structure {
    fn size(&self) -> usize {
        3 * self.free.len()
    }

    fn solve(&self, mut forces: Mat<f64>) -> Mat<f64> {
        self.factor.solve_in_place(forces.as_mut());
        forces
    }

    fn mass(&self, fields: &Mat<f64>) -> Mat<f64> {
        let mut moved = Mat::zeros(fields.nrows(), fields.ncols());
        for column in 0..fields.ncols() {
            let target = fecm::linalg::column_slice_mut(&mut moved, column);
            self.mass.apply(fecm::linalg::column_slice(fields, column), target);
        }
        moved
    }
}

impl NodeMatrix {
    /// `target = (matrix x 1_3) field`, rows in order.
    fn apply(&self, field: &[f64], target: &mut [f64]) {
        for (row, target) in target.chunks_exact_mut(3).enumerate() {
            let mut sum = [0.0; 3];
            for slot in self.starts[row]..self.starts[row + 1] {
                let at = 3 * self.columns[slot] as usize;
                for (sum, value) in sum.iter_mut().zip(&field[at..at + 3]) {
                    *sum += self.values[slot] * value;
                }
            }
            target.copy_from_slice(&sum);
        }
    }
}

fn assemble(
    mesh: &SolidMesh,
    springs: &[NodeSpring],
    numbers: &[u32],
    free: usize,
) -> Result<(BlockMatrix, NodeMatrix), HousingError> {
    let rules = Rules::of_mesh(mesh);
    let graph: Vec<Vec<u32>> =
        mesh.elements.iter().map(|e| e.nodes.iter().map(|&node| numbers[node as usize]).collect()).collect();
    let mut stiffness = BlockMatrix::from_elements(free, 3, graph.iter().map(Vec::as_slice));
    let mut masses = vec![std::collections::BTreeMap::<u32, f64>::new(); free];
    for (chunk, elements) in mesh.elements.chunks(CHUNK).enumerate() {
        let matrices: Vec<ElementMatrices> = elements
            .par_iter()
            .enumerate()
            .map(|(k, element)| element_matrices(mesh, &rules, chunk * CHUNK + k, element))
            .collect::<Result<_, _>>()?;
        for (k, matrices) in matrices.iter().enumerate() {
            let nodes = &graph[chunk * CHUNK + k];
            for (j, &column) in nodes.iter().enumerate().filter(|&(_, &n)| n != u32::MAX) {
                for (i, &row) in nodes.iter().enumerate().filter(|&(_, &n)| n != u32::MAX) {
                    *masses[row as usize].entry(column).or_default() += matrices.mass[(i, j)];
                    if row >= column
                        && let Some(block) = stiffness.block_mut(row, column)
                    {
                        for (e, value) in block.iter_mut().enumerate() {
                            *value += matrices.stiffness[(3 * i + e % 3, 3 * j + e / 3)];
                        }
                    }
                }
            }
        }
    }
    for spring in springs {
        let number = numbers[spring.node as usize];
        if number != u32::MAX
            && let Some(block) = stiffness.block_mut(number, number)
        {
            block.iter_mut().zip(spring.stiffness.iter()).for_each(|(value, s)| *value += s);
        }
    }
    let mut mass = NodeMatrix { starts: vec![0], columns: Vec::new(), values: Vec::new() };
    for row in masses {
        mass.columns.extend(row.keys());
        mass.values.extend(row.values());
        mass.starts.push(mass.columns.len());
    }
    Ok((stiffness, mass))
}

fn element_matrices(
    mesh: &SolidMesh,
    rules: &Rules,
    index: usize,
    element: &Element,
) -> Result<ElementMatrices, HousingError> {
    let material = mesh.materials[element.material].1;
    let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
    let n = element.nodes.len();
    let Some(rule) = rules.get(element.kind) else {
        return Err(HousingError::Dangling { element: index, what: "rule of kind", index: 0 });
    };
    let mut mass = Mat::zeros(n, n);
    for point in &rule.mass {
        let scale = mesh.jacobian(index, element, point)?.determinant() * point.weight * material.density;
        for j in 0..n {
            for i in 0..n {
                mass[(i, j)] += scale * point.values[i] * point.values[j];
            }
        }
    }
    let middle = mesh.jacobian(index, element, &rule.middle)?;
    let extra = element.kind.incompatible_gradients([0.0; 3]).len();
    let mut stiffness = Mat::zeros(3 * (n + extra), 3 * (n + extra));
    for point in &rule.stiffness {
        let jacobian = mesh.jacobian(index, element, point)?;
        let volume = jacobian.determinant();
        let turn = jacobian.try_inverse().unwrap_or_else(Matrix3::zeros).transpose();
        let turn_middle = middle.try_inverse().unwrap_or_else(Matrix3::zeros).transpose();
        let mut gradients: Vec<Vector3<f64>> = point.gradients.iter().map(|g| turn * Vector3::from(*g)).collect();
        let bubbles = element.kind.incompatible_gradients(point.at);
        gradients.extend(bubbles.iter().map(|g| middle.determinant() / volume * turn_middle * Vector3::from(*g)));
        add_stiffness(&mut stiffness, &gradients, lambda, mu, volume * point.weight);
    }
    let stiffness = if extra == 0 { stiffness } else { condensed(&stiffness, 3 * n)? };
    Ok(ElementMatrices { stiffness, mass })
}

fn add_stiffness(stiffness: &mut Mat<f64>, gradients: &[Vector3<f64>], lambda: f64, mu: f64, scale: f64) {
    for (j, g) in gradients.iter().enumerate() {
        for (i, f) in gradients.iter().enumerate() {
            let dot = f.dot(g);
            for c in 0..3 {
                for r in 0..3 {
                    let both = if r == c { dot } else { 0.0 };
                    stiffness[(3 * i + r, 3 * j + c)] += scale * (lambda * f[r] * g[c] + mu * (g[r] * f[c] + both));
                }
            }
        }
    }
}

/// The leading `kept` rows and columns, the others free of force.
fn condensed(matrix: &Mat<f64>, kept: usize) -> Result<Mat<f64>, HousingError> {
    let rest = matrix.nrows() - kept;
    let inner = matrix.as_ref().submatrix(kept, kept, rest, rest).to_owned();
    let coupling = matrix.as_ref().submatrix(kept, 0, rest, kept);
    let mut moved = coupling.to_owned();
    DenseCholesky::new(inner, "incompatible modes")?.solve_in_place(moved.as_mut());
    let mut result = matrix.as_ref().submatrix(0, 0, kept, kept).to_owned();
    add_product(result.as_mut(), -1.0, coupling.transpose(), moved.as_ref());
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::housing::block::block;
    use crate::housing::element::Kind;
    use fecm::Material;

    const MATERIAL: Material = Material { young_modulus: 3.0, poisson_ratio: 0.3, density: 2.0 };

    /// Two cells a side, the middle node moved, edges straight.
    fn distorted(kind: Kind) -> SolidMesh {
        let mut mesh = block(kind, [2, 2, 2], MATERIAL, |x| x);
        let middle = [0.5; 3];
        for node in &mut mesh.nodes {
            if *node == middle {
                *node = [0.57, 0.45, 0.54];
            }
        }
        for element in mesh.elements.clone() {
            let corners = kind.nodes() - if kind.nodes() > 8 || kind == Kind::Tet10 { kind.edges().len() } else { 0 };
            for (k, &[a, b]) in kind.edges().iter().enumerate().take(element.nodes.len() - corners) {
                let place = 0.5 * (mesh.node(element.nodes[a]) + mesh.node(element.nodes[b]));
                mesh.nodes[element.nodes[corners + k] as usize] = place.into();
            }
        }
        mesh
    }

    /// Nodal forces of a displacement field.
    fn forces(mesh: &SolidMesh, field: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<Vector3<f64>> {
        let rules = Rules::of_mesh(mesh);
        let mut forces = vec![Vector3::zeros(); mesh.nodes.len()];
        for (index, element) in mesh.elements.iter().enumerate() {
            let matrices = element_matrices(mesh, &rules, index, element).unwrap();
            for (i, &row) in element.nodes.iter().enumerate() {
                for (j, &column) in element.nodes.iter().enumerate() {
                    let u = field(mesh.node(column));
                    for (r, c) in (0..3).flat_map(|r| (0..3).map(move |c| (r, c))) {
                        forces[row as usize][r] += matrices.stiffness[(3 * i + r, 3 * j + c)] * u[c];
                    }
                }
            }
        }
        forces
    }

    #[test]
    fn analytic_patch_test_of_all_kinds() {
        let slope = Matrix3::new(0.3, -0.2, 0.5, 0.1, 0.4, -0.6, 0.7, 0.2, -0.1);
        let strain: Matrix3<f64> = 0.5 * (slope + slope.transpose());
        let (lambda, mu) = (MATERIAL.lame_lambda(), MATERIAL.shear_modulus());
        let energy = 0.5 * (lambda * strain.trace().powi(2) + 2.0 * mu * strain.norm_squared());
        for kind in Kind::ALL {
            let mesh = distorted(kind);
            let forces = forces(&mesh, |x| slope * x);
            let inside = |x: &[f64; 3]| x.iter().all(|x| *x > 1e-6 && *x < 1.0 - 1e-6);
            let mut work = 0.0;
            for (force, place) in forces.iter().zip(&mesh.nodes) {
                work += 0.5 * force.dot(&(slope * Vector3::from(*place)));
                assert!(!inside(place) || force.norm() < 1e-13, "{kind:?}: {force} at {place:?}");
            }
            assert!((work / energy - 1.0).abs() < 1e-13, "{kind:?}: {work} against {energy}");
        }
    }

    #[test]
    fn invariant_rigid_motion_costs_no_force() {
        for kind in Kind::ALL {
            let mesh = distorted(kind);
            let turn = Vector3::new(0.3, -0.7, 0.2);
            let worst = forces(&mesh, |x| Vector3::new(1.0, 2.0, -0.5) + turn.cross(&x));
            assert!(worst.iter().all(|force| force.norm() < 1e-13), "{kind:?}");
        }
    }

    #[test]
    fn analytic_mass_and_inertia_of_a_cube() {
        for kind in Kind::ALL {
            let inertia = distorted(kind).inertia().unwrap();
            assert!((inertia.mass - 2.0).abs() < 1e-13, "{kind:?}");
            assert!(inertia.centre.iter().all(|x| (x - 0.5).abs() < 1e-13));
            // about a corner: 2/3 m a^2, products -1/4 m a^2
            for i in 0..3 {
                for j in 0..3 {
                    let exact = if i == j { 4.0 / 3.0 } else { -0.5 };
                    assert!((inertia.about_origin[i][j] - exact).abs() < 1e-13, "{kind:?}");
                }
            }
        }
    }

    #[test]
    fn extreme_faults_are_errors() {
        let held = |mesh: &SolidMesh, fixed: &[u32]| Structure::new(mesh, &[], fixed).map(|_| ());
        let mut mesh = distorted(Kind::Hex20R);
        assert!(matches!(held(&mesh, &[]), Err(HousingError::NotHeld { nodes: 81, .. })));
        // two nodes leave the line through them free to turn about
        assert!(matches!(held(&mesh, &[0, 1]), Err(HousingError::NotHeld { .. })));
        let corner: Vec<u32> = (0..mesh.nodes.len() as u32).filter(|&n| mesh.node(n).x == 0.0).collect();
        assert_eq!(held(&mesh, &corner), Ok(()));
        for (lower, upper) in [(0, 4), (1, 5), (2, 6), (3, 7), (8, 12), (9, 13), (10, 14), (11, 15)] {
            mesh.elements[3].nodes.swap(lower, upper);
        }
        assert!(matches!(held(&mesh, &corner), Err(HousingError::InvertedElement { element: 3, .. })));
        mesh.elements[3].nodes[0] = 9999;
        assert!(matches!(held(&mesh, &corner), Err(HousingError::Dangling { what: "node", index: 9999, .. })));
        mesh.elements[3].material = 1;
        assert!(matches!(held(&mesh, &corner), Err(HousingError::Dangling { what: "material", .. })));
    }
}
