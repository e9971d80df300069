//! Stiffness of an extruded body from plane integrals and integrals along the face.
//!
//! Linear isotropic elasticity, `a(u, v) = int lambda div u div v + 2 mu e(u) : e(v)`. For basis functions
//! `N_i(x, y) psi_a(z) e_c` and `N_j psi_b e_d` this is
//!
//! `int lambda d_c phi_i d_d phi_j + mu d_d phi_i d_c phi_j + mu delta_cd grad phi_i . grad phi_j`,
//!
//! and every product of derivatives factors into a plane integral ([`PairIntegrals`]) and a face integral
//! ([`FaceIntegrals`]).

use crate::element::PairIntegrals;
use crate::face::{FaceBasis, FaceIntegrals};
use crate::face_part::FaceFunctions;

/// Node-pair blocks of an extruded body: all face integrals tabulated once.
pub struct PairStiffness {
    block: usize,
    lambda: f64,
    shear: f64,
    components: Vec<usize>,
    face: Vec<FaceIntegrals>,
    /// Pairs of degrees of freedom with a nonzero block entry.
    coupled: Vec<(usize, usize)>,
}

impl PairStiffness {
    /// Tables for one face basis.
    #[must_use]
    pub fn new(basis: &FaceBasis) -> Self {
        Self::tabulated(basis, |a, b| basis.integrals(a, b))
    }

    /// Tables for other functions in the place of those of the basis, by degree: those of the first node, those of the second.
    #[must_use]
    pub fn between(basis: &FaceBasis, first: &FaceFunctions, second: &FaceFunctions) -> Self {
        let most = basis.dofs().iter().map(|dof| dof.degree).max().unwrap_or(0);
        let table: Vec<Vec<FaceIntegrals>> =
            (0..=most).map(|a| (0..=most).map(|b| first.integrals(a, second, b)).collect()).collect();
        Self::tabulated(basis, |a, b| table[a][b])
    }

    fn tabulated(basis: &FaceBasis, integrals: impl Fn(usize, usize) -> FaceIntegrals) -> Self {
        let dofs = basis.dofs();
        let block = dofs.len();
        let mut face = Vec::with_capacity(block * block);
        let mut coupled = Vec::new();
        for (i, a) in dofs.iter().enumerate() {
            for (j, b) in dofs.iter().enumerate() {
                let integrals = integrals(a.degree, b.degree);
                let sum = integrals.value_value.abs()
                    + integrals.value_slope.abs()
                    + integrals.slope_value.abs()
                    + integrals.slope_slope.abs();
                if sum > 0.0 {
                    coupled.push((i, j));
                }
                face.push(integrals);
            }
        }
        let components = dofs.iter().map(|dof| dof.component).collect();
        Self { block, lambda: basis.lambda(), shear: basis.shear(), components, face, coupled }
    }

    /// Degrees of freedom per node.
    #[must_use]
    pub fn block(&self) -> usize {
        self.block
    }

    /// The `block x block` stiffness between two nodes, column-major (row = first node), into `out`.
    pub fn fill(&self, plane: &PairIntegrals, out: &mut [f64]) {
        out.fill(0.0);
        let (lambda, mu) = (self.lambda, self.shear);
        let gradients = &plane.gradient_gradient;
        let laplace = gradients[0][0] + gradients[1][1];
        for &(i, j) in &self.coupled {
            let (c, d) = (self.components[i], self.components[j]);
            let face = &self.face[i * self.block + j];
            // product of the derivative of the first function along `k` with that of the second along `l`
            let product = |k: usize, l: usize| match (k < 2, l < 2) {
                (true, true) => gradients[k][l] * face.value_value,
                (true, false) => plane.gradient_value[k] * face.value_slope,
                (false, true) => plane.value_gradient[l] * face.slope_value,
                (false, false) => plane.value_value * face.slope_slope,
            };
            let mut entry = lambda * product(c, d) + mu * product(d, c);
            if c == d {
                entry += mu * (laplace * face.value_value + plane.value_value * face.slope_slope);
            }
            out[j * self.block + i] = entry;
        }
    }
}

/// Rotates the in-plane pairs of a block between nodes from Cartesian to local axes: `R_row^T block R_column`, where an axis
/// turned by `angle` is radial and the next tangential.
pub fn rotate_block(block: &mut [f64], basis: &FaceBasis, row_angle: Option<f64>, column_angle: Option<f64>) {
    let n = basis.block();
    let pairs = basis.plane_degrees().len();
    if let Some(angle) = row_angle {
        let (sine, cosine) = angle.sin_cos();
        for column in 0..n {
            for pair in 0..pairs {
                let at = column * n + 2 * pair;
                let (x, y) = (block[at], block[at + 1]);
                block[at] = cosine * x + sine * y;
                block[at + 1] = cosine * y - sine * x;
            }
        }
    }
    if let Some(angle) = column_angle {
        let (sine, cosine) = angle.sin_cos();
        for row in 0..n {
            for pair in 0..pairs {
                let (at, next) = (2 * pair * n + row, (2 * pair + 1) * n + row);
                let (x, y) = (block[at], block[next]);
                block[at] = cosine * x + sine * y;
                block[next] = cosine * y - sine * x;
            }
        }
    }
}
