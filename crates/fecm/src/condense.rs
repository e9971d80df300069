//! Assembly of an extruded body and its static condensation onto retained nodes.
//!
//! With interior unknowns `I` and retained unknowns `C`,
//!
//! `u_I = K_II^-1 f_I - X u_C`, `X = K_II^-1 K_IC`, `S = K_CC - K_CI X`, `S u_C = f_C - X^T f_I`.
//!
//! `K_II` is factored once (sparse Cholesky). For a tooth sector the retained nodes are those of its two radial cuts, in radial,
//! tangential and axial components, so that neighbours share them unturned; identical sectors share everything here.
//! Checked by patch tests, convergence orders, a thick ring and a cantilever (`tests/analytic_elements.rs`), and against the
//! uncondensed full ring (`tests/invariant_cyclic.rs`).

use std::collections::HashMap;

use faer::{Mat, MatRef};

use crate::assembly::{PairStiffness, rotate_block};
use crate::element::ReferenceQuad;
use crate::element::lagrange::gauss_rule;
use crate::error::FecmError;
use crate::face::FaceBasis;
use crate::linalg::{BlockCholesky, BlockMatrix, product_of_sparse_rows, symmetrise};
use crate::mesh::PlaneMesh;

/// A body to condense: its mesh and what is held and retained.
#[derive(Debug, Clone)]
pub struct Substructure<'a> {
    /// Plane mesh.
    pub mesh: &'a PlaneMesh,
    /// Retained nodes, in the order of their unknowns, and the angle of their local axes (rad; 0 for Cartesian components).
    pub retained: Vec<(u32, f64)>,
    /// Nodes without displacement. A node both held and retained is held.
    pub fixed: Vec<u32>,
    /// Element edges on springs of a stiffness per area (N/m^3), equal in all directions.
    pub springs: Option<(f64, &'a [Vec<u32>])>,
}

/// Where a node stands in the partition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Interior(u32),
    Retained(u32),
    Fixed,
}

/// A body, condensed onto its retained nodes.
pub struct CondensedBody {
    block: usize,
    roles: Vec<Role>,
    factor: BlockCholesky,
    /// `X`, interior rows.
    retained_solution: Mat<f64>,
    /// `S`.
    stiffness: Mat<f64>,
}

impl CondensedBody {
    /// Assembles and condenses a body.
    ///
    /// # Errors
    /// Factorisation errors ([`FecmError::NotPositiveDefinite`], [`FecmError::OutOfMemory`]).
    pub fn new(body: &Substructure<'_>, basis: &FaceBasis) -> Result<Self, FecmError> {
        let (roles, interior_count, retained_count) = partition(body);
        let block = basis.block();
        let interior_elements: Vec<Vec<u32>> = body
            .mesh
            .elements()
            .map(|element| {
                let number = |&node: &u32| match roles[node as usize] {
                    Role::Interior(n) => n,
                    _ => u32::MAX,
                };
                element.iter().map(number).collect()
            })
            .collect();
        let graph = interior_elements.iter().map(Vec::as_slice);
        let mut assembly = Assembly {
            roles: &roles,
            angles: body.retained.iter().copied().collect(),
            block,
            interior: BlockMatrix::from_elements(interior_count, block, graph),
            coupling: Mat::zeros(interior_count * block, retained_count * block),
            retained: Mat::zeros(retained_count * block, retained_count * block),
        };
        assembly.add_elements(body.mesh, basis);
        if let Some((stiffness, edges)) = body.springs {
            assembly.add_springs(body.mesh, basis, stiffness, edges);
        }
        let Assembly { interior, coupling, retained, .. } = assembly;
        let factor = interior.cholesky("body stiffness")?;
        let mut retained_solution = coupling.clone();
        factor.solve_in_place(retained_solution.as_mut());
        let mut stiffness = retained;
        stiffness -= product_of_sparse_rows(&coupling, &retained_solution);
        symmetrise(&mut stiffness);
        Ok(Self { block, roles, factor, retained_solution, stiffness })
    }

    /// Condensed stiffness `S` on the retained nodes.
    #[must_use]
    pub fn stiffness(&self) -> &Mat<f64> {
        &self.stiffness
    }

    /// `X = K_II^-1 K_IC`.
    #[must_use]
    pub fn retained_solution(&self) -> MatRef<'_, f64> {
        self.retained_solution.as_ref()
    }

    /// Number of interior unknowns.
    #[must_use]
    pub fn interior_size(&self) -> usize {
        self.factor.size()
    }

    /// Stored entries of the sparse factor.
    #[must_use]
    pub fn factor_entries(&self) -> usize {
        self.factor.factor_entries()
    }

    /// Row of an interior unknown, or `None` for a node retained or held.
    #[must_use]
    pub fn interior_row(&self, node: u32, dof: usize) -> Option<usize> {
        match self.roles[node as usize] {
            Role::Interior(n) => Some(n as usize * self.block + dof),
            _ => None,
        }
    }

    /// Row of a retained unknown, or `None`.
    #[must_use]
    pub fn retained_row(&self, node: u32, dof: usize) -> Option<usize> {
        match self.roles[node as usize] {
            Role::Retained(n) => Some(n as usize * self.block + dof),
            _ => None,
        }
    }

    /// Solves `K_II u = f` in place (retained nodes held).
    pub fn solve_interior(&self, rhs: &mut Mat<f64>) {
        self.factor.solve_in_place(rhs.as_mut());
    }
}

/// Roles of all nodes, and the number of interior and retained ones.
fn partition(body: &Substructure<'_>) -> (Vec<Role>, usize, usize) {
    let mut roles = vec![Role::Interior(u32::MAX); body.mesh.nodes.len()];
    let mut count = 0;
    for &(node, _) in &body.retained {
        if !body.fixed.contains(&node) {
            roles[node as usize] = Role::Retained(count);
            count += 1;
        }
    }
    for &node in &body.fixed {
        roles[node as usize] = Role::Fixed;
    }
    let mut interiors = 0;
    for role in &mut roles {
        if let Role::Interior(number) = role {
            *number = interiors;
            interiors += 1;
        }
    }
    (roles, interiors as usize, count as usize)
}

struct Assembly<'a> {
    roles: &'a [Role],
    angles: HashMap<u32, f64>,
    block: usize,
    interior: BlockMatrix,
    coupling: Mat<f64>,
    retained: Mat<f64>,
}

impl Assembly<'_> {
    fn add_elements(&mut self, mesh: &PlaneMesh, basis: &FaceBasis) {
        let quad = ReferenceQuad::new(mesh.order);
        let stiffness = PairStiffness::new(basis);
        let mut values = vec![0.0; self.block * self.block];
        for (index, element) in mesh.elements().enumerate() {
            let integrals = quad.integrals(&mesh.element_points(index));
            for (i, &row) in element.iter().enumerate() {
                for (j, &column) in element.iter().enumerate() {
                    if !self.wanted(row, column) {
                        continue;
                    }
                    stiffness.fill(&integrals[i * element.len() + j], &mut values);
                    rotate_block(&mut values, basis, self.angle(row), self.angle(column));
                    self.add(row, column, &values);
                }
            }
        }
    }

    fn angle(&self, node: u32) -> Option<f64> {
        self.angles.get(&node).copied().filter(|&angle| angle != 0.0)
    }

    /// Only the lower triangle of `K_II`, `K_IC` and all of `K_CC` are stored.
    fn wanted(&self, row: u32, column: u32) -> bool {
        match (self.roles[row as usize], self.roles[column as usize]) {
            (Role::Interior(i), Role::Interior(j)) => i >= j,
            (Role::Interior(_) | Role::Retained(_), Role::Retained(_)) => true,
            _ => false,
        }
    }

    fn add(&mut self, row: u32, column: u32, values: &[f64]) {
        let n = self.block;
        match (self.roles[row as usize], self.roles[column as usize]) {
            (Role::Interior(i), Role::Interior(j)) => {
                if let Some(block) = self.interior.block_mut(i, j) {
                    for (sum, value) in block.iter_mut().zip(values) {
                        *sum += value;
                    }
                }
            }
            (Role::Interior(i), Role::Retained(j)) => add_block(&mut self.coupling, i, j, n, values),
            (Role::Retained(i), Role::Retained(j)) => add_block(&mut self.retained, i, j, n, values),
            _ => {}
        }
    }

    /// `stiffness * int u . v dA` over element edges times the face.
    fn add_springs(&mut self, mesh: &PlaneMesh, basis: &FaceBasis, stiffness: f64, edges: &[Vec<u32>]) {
        let quad = ReferenceQuad::new(mesh.order);
        let line = quad.basis();
        let n = mesh.order + 1;
        let (mut shapes, mut slopes) = (vec![0.0; n], vec![0.0; n]);
        let mut values = vec![0.0; self.block * self.block];
        for edge in edges {
            let mut mass = vec![0.0; n * n];
            for (x, weight) in gauss_rule(n + 1) {
                line.values_into(x, &mut shapes);
                line.derivatives_into(x, &mut slopes);
                let tangent = edge.iter().zip(&slopes).fold(nalgebra::Vector2::zeros(), |sum, (&node, slope)| {
                    sum + mesh.nodes[node as usize].coords * *slope
                });
                let length = weight * tangent.norm();
                for i in 0..n {
                    for j in 0..n {
                        mass[i * n + j] += length * shapes[i] * shapes[j];
                    }
                }
            }
            for (i, &row) in edge.iter().enumerate() {
                for (j, &column) in edge.iter().enumerate() {
                    if !self.wanted(row, column) {
                        continue;
                    }
                    // Cartesian springs, turned like the stiffness
                    values.fill(0.0);
                    for (a, dof) in basis.dofs().iter().enumerate() {
                        for (b, other) in basis.dofs().iter().enumerate() {
                            if dof.component == other.component {
                                values[b * self.block + a] =
                                    stiffness * mass[i * n + j] * basis.integrals(dof.degree, other.degree).value_value;
                            }
                        }
                    }
                    rotate_block(&mut values, basis, self.angle(row), self.angle(column));
                    self.add(row, column, &values);
                }
            }
        }
    }
}

fn add_block(matrix: &mut Mat<f64>, row: u32, column: u32, n: usize, values: &[f64]) {
    let (row, column) = (row as usize * n, column as usize * n);
    for c in 0..n {
        for r in 0..n {
            matrix[(row + r, column + c)] += values[c * n + r];
        }
    }
}
