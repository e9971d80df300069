//! Inertia of an extruded body: consistent mass, rigid motions, and the inertia of a whole gear.
//!
//! Displacements are those of [`crate::assembly`]: plane shape functions times orthogonal functions along the face. The consistent
//! mass `int rho u . v dV` therefore couples only equal components of equal degree, and is one plane matrix times numbers,
//!
//! `M_(i a c)(j b d) = rho int N_i N_j dA int psi_a psi_b dz delta_ab delta_cd`.
//!
//! A *node field* holds all nodes of a plane mesh, held and retained ones included, `block` Cartesian unknowns a node
//! (row `node * block + dof`, in the order of [`FaceBasis::dofs`]); one field a column. The isoparametric map holds the coordinates
//! themselves, so rigid motions are exact node fields and the inertia of the meshed body follows from them without another quadrature.
//! Checked against a disc with a hole, and rigid motions against the inertia, in `tests/modes.rs`.

use faer::Mat;
use nalgebra::Point2;

use crate::element::ReferenceQuad;
use crate::face::{FaceBasis, Parity};
use crate::mesh::{PlaneMesh, SectorMesh};

/// Consistent plane mass of a mesh, compressed by rows (m^2).
#[derive(Debug, Clone)]
pub struct PlaneMass {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl PlaneMass {
    /// Assembles `int N_i N_j dA`.
    #[must_use]
    pub fn new(mesh: &PlaneMesh) -> Self {
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); mesh.nodes.len()];
        for element in mesh.elements() {
            for &node in element {
                neighbours[node as usize].extend_from_slice(element);
            }
        }
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for row in &mut neighbours {
            row.sort_unstable();
            row.dedup();
            columns.extend_from_slice(row);
            starts.push(columns.len());
        }
        let mut mass = Self { starts, values: vec![0.0; columns.len()], columns };
        let quad = ReferenceQuad::new(mesh.order);
        for (index, element) in mesh.elements().enumerate() {
            let integrals = quad.integrals(&mesh.element_points(index));
            for (i, &row) in element.iter().enumerate() {
                for (j, &column) in element.iter().enumerate() {
                    mass.add(row, column, integrals[i * element.len() + j].value_value);
                }
            }
        }
        mass
    }

    fn add(&mut self, row: u32, column: u32, value: f64) {
        let range = self.starts[row as usize]..self.starts[row as usize + 1];
        if let Ok(at) = self.columns[range.clone()].binary_search(&column) {
            self.values[range.start + at] += value;
        }
    }

    /// Columns and values of a row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[row]..self.starts[row + 1];
        self.columns[range.clone()].iter().zip(&self.values[range]).map(|(&column, &value)| (column as usize, value))
    }

    /// `int f g dA` of two functions given at the nodes.
    #[must_use]
    pub fn integral(&self, f: &[f64], g: &[f64]) -> f64 {
        let inner = |row| self.row(row).map(|(column, value)| value * g[column]).sum::<f64>();
        f.iter().enumerate().map(|(row, f)| f * inner(row)).sum()
    }
}

/// Consistent mass of an extruded body in one symmetry family.
#[derive(Debug, Clone)]
pub struct BodyMass {
    plane: PlaneMass,
    /// `rho int psi^2 dz` of each unknown of a node (kg/m^2).
    weights: Vec<f64>,
}

impl BodyMass {
    /// Mass of a mesh, extruded with the functions of `basis`, of density `density` (kg/m^3).
    #[must_use]
    pub fn new(mesh: &PlaneMesh, basis: &FaceBasis, density: f64) -> Self {
        let norm = |degree| density * basis.integrals(degree, degree).value_value;
        Self { plane: PlaneMass::new(mesh), weights: basis.dofs().iter().map(|dof| norm(dof.degree)).collect() }
    }

    /// `M u` of node fields.
    #[must_use]
    pub fn apply(&self, fields: &Mat<f64>) -> Mat<f64> {
        let block = self.weights.len();
        let mut result = Mat::zeros(fields.nrows(), fields.ncols());
        for column in 0..fields.ncols() {
            let source = fields.col_as_slice(column);
            for (row, sums) in result.col_as_slice_mut(column).chunks_exact_mut(block).enumerate() {
                for (other, mass) in self.plane.row(row) {
                    for (sum, value) in sums.iter_mut().zip(&source[other * block..(other + 1) * block]) {
                        *sum += mass * value;
                    }
                }
                for (sum, weight) in sums.iter_mut().zip(&self.weights) {
                    *sum *= weight;
                }
            }
        }
        result
    }
}

/// The six rigid motions of a hub about the gear's axis and mid-face: translations along and rotations about x, y, z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RigidMotion {
    /// Translation along x.
    X,
    /// Translation along y.
    Y,
    /// Translation along z, the gear's axis.
    Z,
    /// Rotation about x.
    AboutX,
    /// Rotation about y.
    AboutY,
    /// Rotation about z.
    AboutZ,
}

impl RigidMotion {
    /// All six, in the order of generalised coordinates.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::AboutX, Self::AboutY, Self::AboutZ];

    /// Symmetry family about mid-face that holds the motion.
    #[must_use]
    pub fn parity(self) -> Parity {
        match self {
            Self::X | Self::Y | Self::AboutZ => Parity::Symmetric,
            Self::Z | Self::AboutX | Self::AboutY => Parity::Antisymmetric,
        }
    }

    /// Node field of the unit motion, zero where the basis does not hold it.
    #[must_use]
    pub fn field(self, nodes: &[Point2<f64>], basis: &FaceBasis) -> Mat<f64> {
        // z = (b / 2) P_1(2 z / b)
        let half = 0.5 * basis.width();
        let block = basis.block();
        let mut field = Mat::zeros(nodes.len() * block, 1);
        for (node, point) in nodes.iter().enumerate() {
            for (dof, function) in basis.dofs().iter().enumerate() {
                field[(node * block + dof, 0)] = match (self, function.component, function.degree) {
                    (Self::X, 0, 0) | (Self::Y, 1, 0) | (Self::Z, 2, 0) => 1.0,
                    (Self::AboutX, 1, 1) => -half,
                    (Self::AboutX, 2, 0) => point.y,
                    (Self::AboutY, 0, 1) => half,
                    (Self::AboutY, 2, 0) => -point.x,
                    (Self::AboutZ, 0, 0) => -point.y,
                    (Self::AboutZ, 1, 0) => point.x,
                    _ => 0.0,
                };
            }
        }
        field
    }
}

/// Inertia of a whole gear, from its mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyInertia {
    /// Mass (kg).
    pub mass: f64,
    /// Moment of inertia about the gear's axis (kg m^2).
    pub polar: f64,
    /// Moment of inertia about any diameter at mid-face (kg m^2).
    pub transverse: f64,
}

impl BodyInertia {
    /// Inertia of `teeth` copies of a sector of width `width` (m) and density `density` (kg/m^3).
    #[must_use]
    pub fn of_gear(sector: &SectorMesh, teeth: u32, width: f64, density: f64) -> Self {
        let plane = PlaneMass::new(&sector.mesh);
        let at = |f: fn(&Point2<f64>) -> f64| sector.mesh.nodes.iter().map(f).collect::<Vec<_>>();
        let (ones, x, y) = (vec![1.0; sector.mesh.nodes.len()], at(|p| p.x), at(|p| p.y));
        let mass = f64::from(teeth) * density * width * plane.integral(&ones, &ones);
        let polar = f64::from(teeth) * density * width * (plane.integral(&x, &x) + plane.integral(&y, &y));
        Self { mass, polar, transverse: 0.5 * polar + mass * width * width / 12.0 }
    }

    /// Diagonal of the rigid mass matrix in the order of [`RigidMotion::ALL`].
    #[must_use]
    pub fn diagonal(&self) -> [f64; 6] {
        [self.mass, self.mass, self.mass, self.transverse, self.transverse, self.polar]
    }
}
