//! Assembly of an extruded body and its static condensation onto retained nodes.
//!
//! With interior unknowns `I` and retained unknowns `C`,
//!
//! `u_I = K_II^-1 f_I - X u_C`, `X = K_II^-1 K_IC`, `S = K_CC - K_CI X`, `S u_C = f_C - X^T f_I`.
//!
//! `K_II` is factored once (sparse Cholesky). For a tooth sector the retained nodes are those of its two radial cuts, in radial,
//! tangential and axial components, so that neighbours share them unturned; identical sectors share everything here.
//! A node may have more than the functions along the face that all nodes have, and may follow another node ([`RichNode`]). On the far side of a
//! crack whose length varies along the face the displacement is
//!
//! `u(z) = u_near(z) + sum_m h_m(z) j_m`,
//!
//! `u_near` that of the node on the near side and `h_m` functions on the part of the face where the crack is open there
//! ([`crate::face_part`]). So the faces part where the crack is and nowhere else, without a penalty or a constraint. Around the crack the field
//! changes along the face faster than the common functions can: nodes there have more, on parts of the face. All these unknowns are interior.
//!
//! Checked by patch tests, convergence orders, a thick ring and a cantilever (`tests/analytic_elements.rs`), and against the
//! uncondensed full ring (`tests/invariant_cyclic.rs`).

use std::collections::HashMap;

use faer::{Mat, MatRef};

use crate::assembly::{PairStiffness, rotate_block};
use crate::element::ReferenceQuad;
use crate::element::lagrange::gauss_rule;
use crate::error::FecmError;
use crate::face::{FaceBasis, FaceDof};
use crate::face_part::{FaceFunctions, FacePart};
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
    /// Nodes with functions of their own along the face, before those that follow them. Neither held, retained, nor on springs.
    pub rich: &'a [RichNode],
}

/// A node with functions of its own along the face.
#[derive(Debug, Clone, PartialEq)]
pub struct RichNode {
    /// This node.
    pub node: u32,
    /// The node that it moves with but for its own functions; itself if none.
    pub follows: u32,
    /// Parts of the face on which it has functions of its own.
    pub open: Vec<FacePart>,
    /// Degrees of the functions of its own on layers of the face ([`FaceFunctions::on_layers`]): 0 to below this.
    pub layer_degrees: usize,
}

/// Where a node stands in the partition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Interior(u32),
    Retained(u32),
    Fixed,
    /// Number in the list of rich nodes.
    Rich(u32),
}

/// Blocks of unknowns that move a rich node, each with the place of its functions among [`Sets`].
type Blocks = Vec<(Role, usize)>;

/// Sets of functions along the face; the first are those that all nodes have.
struct Sets(Vec<FaceFunctions>);

impl Sets {
    /// Place of a set, put there if new.
    fn place(&mut self, set: FaceFunctions) -> usize {
        self.0.iter().position(|known| *known == set).unwrap_or_else(|| {
            self.0.push(set);
            self.0.len() - 1
        })
    }

    /// Coefficients of the functions of a set in those that all nodes have, by least squares: `[degree][number in the set]`.
    fn projection(&self, set: usize, basis: &FaceBasis) -> Vec<Vec<f64>> {
        let most = basis.dofs().iter().map(|dof| dof.degree).max().unwrap_or(0);
        let row = |a: usize| {
            let norm = basis.integrals(a, a).value_value;
            (0..=most).map(|b| self.0[0].integrals(a, &self.0[set], b).value_value / norm).collect()
        };
        (0..=most).map(row).collect()
    }
}

/// A body, condensed onto its retained nodes.
pub struct CondensedBody {
    block: usize,
    roles: Vec<Role>,
    rich: Vec<Blocks>,
    /// Component and degree of each degree of freedom of a node.
    dofs: Vec<FaceDof>,
    /// By set of functions, see [`Sets::projection`].
    projections: Vec<Vec<Vec<f64>>>,
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
        let Partition { roles, rich, sets, interiors, retained } = Partition::new(body, basis);
        let block = basis.block();
        let mut assembly = Assembly {
            roles: &roles,
            rich: &rich,
            sets: &sets,
            angles: body.retained.iter().copied().collect(),
            block,
            interior: BlockMatrix::from_elements(0, block, std::iter::empty()),
            coupling: Mat::zeros(interiors * block, retained * block),
            retained: Mat::zeros(retained * block, retained * block),
        };
        let graph: Vec<Vec<u32>> = body.mesh.elements().map(|element| assembly.interior_numbers(element)).collect();
        assembly.interior = BlockMatrix::from_elements(interiors, block, graph.iter().map(Vec::as_slice));
        assembly.add_elements(body.mesh, basis);
        assembly.settle_redundant();
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
        let projections = (0..sets.0.len()).map(|set| sets.projection(set, basis)).collect();
        let dofs = basis.dofs().to_vec();
        Ok(Self { block, roles, rich, dofs, projections, factor, retained_solution, stiffness })
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

    /// A node's displacement in one function along the face, as interior rows and their weights: one row of weight 1 for an interior node; for a
    /// rich node all that moves it, projected on the functions along the whole face; none for a node retained or held.
    #[must_use]
    pub fn interior_terms(&self, node: u32, dof: usize) -> Vec<(usize, f64)> {
        let Role::Rich(number) = self.roles[node as usize] else {
            return self.interior_row(node, dof).map(|row| (row, 1.0)).into_iter().collect();
        };
        let FaceDof { component, degree } = self.dofs[dof];
        let mut terms = Vec::new();
        for &(role, set) in &self.rich[number as usize] {
            let Role::Interior(number) = role else { continue };
            let first = number as usize * self.block;
            if set == 0 {
                terms.push((first + dof, 1.0));
                continue;
            }
            let weights = &self.projections[set][degree];
            let alike = self.dofs.iter().enumerate().filter(|(_, other)| other.component == component);
            terms.extend(alike.map(|(d, other)| (first + d, weights[other.degree])));
        }
        terms
    }

    /// Row of an interior unknown, or `None` for a node retained, held or rich.
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

/// Roles of all nodes, and how many blocks of unknowns there are.
struct Partition {
    roles: Vec<Role>,
    rich: Vec<Blocks>,
    sets: Sets,
    interiors: usize,
    retained: usize,
}

impl Partition {
    fn new(body: &Substructure<'_>, basis: &FaceBasis) -> Self {
        let mut roles = vec![Role::Interior(u32::MAX); body.mesh.nodes.len()];
        let mut retained = 0;
        for &(node, _) in &body.retained {
            if !body.fixed.contains(&node) {
                roles[node as usize] = Role::Retained(retained);
                retained += 1;
            }
        }
        for &node in &body.fixed {
            roles[node as usize] = Role::Fixed;
        }
        for rich in body.rich.iter().filter(|rich| rich.follows != rich.node) {
            roles[rich.node as usize] = Role::Rich(u32::MAX);
        }
        let mut interiors = 0;
        for role in &mut roles {
            if let Role::Interior(number) = role {
                *number = interiors;
                interiors += 1;
            }
        }
        let order = basis.dofs().iter().map(|dof| dof.degree).max().unwrap_or(0);
        let mut sets = Sets(vec![FaceFunctions::on_part(FacePart::whole(basis.width()), order)]);
        let mut all: Vec<Blocks> = Vec::with_capacity(body.rich.len());
        for (rich, number) in body.rich.iter().zip(0..) {
            let mut blocks = match roles[rich.follows as usize] {
                Role::Rich(followed) => all.get(followed as usize).cloned().unwrap_or_default(),
                role => vec![(role, 0)],
            };
            let open = rich.open.iter().map(|&part| FaceFunctions::on_part(part, order));
            let layers = (0..rich.layer_degrees).map(|m| FaceFunctions::on_layers(basis.width(), order, m));
            for set in open.chain(layers) {
                let place = sets.place(set);
                // a part that is the whole face says nothing new of a node that follows none
                if rich.follows != rich.node || place > 0 {
                    blocks.push((Role::Interior(interiors), place));
                    interiors += 1;
                }
            }
            roles[rich.node as usize] = Role::Rich(number);
            all.push(blocks);
        }
        Self { roles, rich: all, sets, interiors: interiors as usize, retained: retained as usize }
    }
}

/// A block of unknowns that moves a node of an element.
#[derive(Debug, Clone, Copy)]
struct Carrier {
    /// Number of the node in the element.
    local: usize,
    /// Whose unknowns they are.
    role: Role,
    /// Angle of their axes (rad), if turned.
    angle: Option<f64>,
    /// Their functions along the face.
    set: usize,
}

struct Assembly<'a> {
    roles: &'a [Role],
    rich: &'a [Blocks],
    sets: &'a Sets,
    angles: HashMap<u32, f64>,
    block: usize,
    interior: BlockMatrix,
    coupling: Mat<f64>,
    retained: Mat<f64>,
}

impl Assembly<'_> {
    /// The blocks that move an element's nodes.
    fn carriers(&self, element: &[u32]) -> Vec<Carrier> {
        let mut carriers = Vec::with_capacity(element.len());
        for (local, &node) in element.iter().enumerate() {
            match self.roles[node as usize] {
                Role::Rich(number) => carriers.extend(self.rich[number as usize].iter().map(|&(role, set)| Carrier {
                    local,
                    role,
                    angle: None,
                    set,
                })),
                role => carriers.push(Carrier { local, role, angle: self.angle(node), set: 0 }),
            }
        }
        carriers
    }

    /// Interior numbers of an element's blocks, `u32::MAX` for others.
    fn interior_numbers(&self, element: &[u32]) -> Vec<u32> {
        let number = |carrier: &Carrier| if let Role::Interior(number) = carrier.role { number } else { u32::MAX };
        self.carriers(element).iter().map(number).collect()
    }

    /// Functions of a node's own may say in part what others do: a share of their diagonal far below the error of any mesh, and far above rounding, lets
    /// one of the equal representations win.
    fn settle_redundant(&mut self) {
        const SHARE: f64 = 1e-10;
        for &(role, set) in self.rich.iter().flatten() {
            if let (Role::Interior(number), true) = (role, set > 0)
                && let Some(block) = self.interior.block_mut(number, number)
            {
                block.iter_mut().step_by(self.block + 1).for_each(|diagonal| *diagonal *= 1.0 + SHARE);
            }
        }
    }

    fn add_elements(&mut self, mesh: &PlaneMesh, basis: &FaceBasis) {
        let quad = ReferenceQuad::new(mesh.order);
        let mut tables = HashMap::from([((0, 0), PairStiffness::new(basis))]);
        let mut values = vec![0.0; self.block * self.block];
        let sets = &self.sets.0;
        for (index, element) in mesh.elements().enumerate() {
            let integrals = quad.integrals(&mesh.element_points(index));
            let carriers = self.carriers(element);
            for row in &carriers {
                for column in &carriers {
                    if !wanted(row.role, column.role) {
                        continue;
                    }
                    let stiffness = tables.entry((row.set, column.set)).or_insert_with_key(|&(first, second)| {
                        PairStiffness::between(basis, &sets[first], &sets[second])
                    });
                    stiffness.fill(&integrals[row.local * element.len() + column.local], &mut values);
                    rotate_block(&mut values, basis, row.angle, column.angle);
                    self.add(row.role, column.role, &values);
                }
            }
        }
    }

    fn angle(&self, node: u32) -> Option<f64> {
        self.angles.get(&node).copied().filter(|&angle| angle != 0.0)
    }

    fn add(&mut self, row: Role, column: Role, values: &[f64]) {
        let n = self.block;
        match (row, column) {
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
                    let roles = [row, column].map(|node| self.roles[node as usize]);
                    if !wanted(roles[0], roles[1]) {
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
                    self.add(roles[0], roles[1], &values);
                }
            }
        }
    }
}

/// Only the lower triangle of `K_II`, `K_IC` and all of `K_CC` are stored.
fn wanted(row: Role, column: Role) -> bool {
    match (row, column) {
        (Role::Interior(i), Role::Interior(j)) => i >= j,
        (Role::Interior(_) | Role::Retained(_), Role::Retained(_)) => true,
        _ => false,
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
