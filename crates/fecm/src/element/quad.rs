//! Quadrilateral Lagrange element of any order, and its plane integrals.
//!
//! Nodes are the tensor product of Gauss-Lobatto points, node `i + (p + 1) j` at `(xi_i, eta_j)`; the geometry is
//! isoparametric. Displacements are products of the element's shape functions in the plane with functions along the
//! face ([`crate::face`]), so an element contributes nine plane integrals per pair of nodes
//!
//! `A_kl = int N_i,k N_j,l dA`, `B_k = int N_i,k N_j dA`, `C_k = int N_i N_j,k dA`, `M = int N_i N_j dA`,
//!
//! from which the stiffness of an extruded solid and of a plane one follow ([`crate::assembly`]).
//! Verified by the patch tests and convergence orders of `tests/analytic_elements.rs`.

use nalgebra::{Matrix2, Point2, Vector2};

use super::lagrange::{LagrangeBasis, gauss_rule};

/// Reference quadrilateral of one order: basis and tabulated quadrature.
#[derive(Debug, Clone)]
pub struct ReferenceQuad {
    order: usize,
    basis: LagrangeBasis,
    /// Per quadrature point: weight, shape values, shape derivatives.
    points: Vec<TabulatedPoint>,
}

#[derive(Debug, Clone)]
struct TabulatedPoint {
    weight: f64,
    shapes: Vec<f64>,
    slopes: Vec<Vector2<f64>>,
}

/// Plane integrals of one pair of nodes; see the module header.
#[derive(Debug, Clone, Copy, Default)]
pub struct PairIntegrals {
    /// `A_kl`, dimensionless.
    pub gradient_gradient: [[f64; 2]; 2],
    /// `B_k` (m).
    pub gradient_value: [f64; 2],
    /// `C_k` (m).
    pub value_gradient: [f64; 2],
    /// `M` (m^2).
    pub value_value: f64,
}

impl ReferenceQuad {
    /// Element of polynomial order `order >= 1`, integrated with `order + 2` Gauss points a direction.
    #[must_use]
    pub fn new(order: usize) -> Self {
        let basis = LagrangeBasis::new(order);
        let mut quad = Self { order, basis, points: Vec::new() };
        let rule = gauss_rule(order + 2);
        for &(eta, w_eta) in &rule {
            for &(xi, w_xi) in &rule {
                let (shapes, slopes) = quad.shapes(xi, eta);
                quad.points.push(TabulatedPoint { weight: w_xi * w_eta, shapes, slopes });
            }
        }
        quad
    }

    /// Polynomial order.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// The one-dimensional basis.
    #[must_use]
    pub fn basis(&self) -> &LagrangeBasis {
        &self.basis
    }

    /// Nodes per element.
    #[must_use]
    pub fn node_count(&self) -> usize {
        (self.order + 1) * (self.order + 1)
    }

    /// Shape functions and their derivatives with respect to `(xi, eta)`.
    #[must_use]
    pub fn shapes(&self, xi: f64, eta: f64) -> (Vec<f64>, Vec<Vector2<f64>>) {
        let n = self.order + 1;
        let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
        let (mut da, mut db) = (vec![0.0; n], vec![0.0; n]);
        self.basis.values_into(xi, &mut a);
        self.basis.values_into(eta, &mut b);
        self.basis.derivatives_into(xi, &mut da);
        self.basis.derivatives_into(eta, &mut db);
        let mut shapes = Vec::with_capacity(n * n);
        let mut slopes = Vec::with_capacity(n * n);
        for j in 0..n {
            for i in 0..n {
                shapes.push(a[i] * b[j]);
                slopes.push(Vector2::new(da[i] * b[j], a[i] * db[j]));
            }
        }
        (shapes, slopes)
    }

    /// Position of `(xi, eta)` in an element with the given nodes.
    #[must_use]
    pub fn map(&self, nodes: &[Point2<f64>], xi: f64, eta: f64) -> Point2<f64> {
        let (shapes, _) = self.shapes(xi, eta);
        Point2::from(shapes.iter().zip(nodes).fold(Vector2::zeros(), |sum, (n, p)| sum + p.coords * *n))
    }

    /// Smallest Jacobian determinant over the quadrature points and corners, and where it is.
    #[must_use]
    pub fn smallest_jacobian(&self, nodes: &[Point2<f64>]) -> (f64, Point2<f64>) {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(xi, eta)| {
            let (shapes, slopes) = self.shapes(xi, eta);
            TabulatedPoint { weight: 0.0, shapes, slopes }
        });
        let mut worst = (f64::INFINITY, Point2::origin());
        for point in self.points.iter().chain(&corners) {
            let determinant = jacobian(nodes, &point.slopes).determinant();
            if determinant < worst.0 || determinant.is_nan() {
                let place = point.shapes.iter().zip(nodes).fold(Vector2::zeros(), |s, (n, p)| s + p.coords * *n);
                worst = (determinant, Point2::from(place));
            }
        }
        worst
    }

    /// Plane integrals of all node pairs: entry `i * node_count + j`.
    #[must_use]
    pub fn integrals(&self, nodes: &[Point2<f64>]) -> Vec<PairIntegrals> {
        let n = self.node_count();
        let mut all = vec![PairIntegrals::default(); n * n];
        let mut gradients = vec![Vector2::zeros(); n];
        for point in &self.points {
            let jacobian = jacobian(nodes, &point.slopes);
            let determinant = jacobian.determinant();
            let inverse_transpose =
                Matrix2::new(jacobian.m22, -jacobian.m21, -jacobian.m12, jacobian.m11) / determinant;
            for (gradient, slope) in gradients.iter_mut().zip(&point.slopes) {
                *gradient = inverse_transpose * slope;
            }
            let weight = point.weight * determinant;
            for i in 0..n {
                let (g_i, n_i) = (gradients[i] * weight, point.shapes[i] * weight);
                for j in 0..n {
                    let (g_j, n_j) = (gradients[j], point.shapes[j]);
                    let pair = &mut all[i * n + j];
                    pair.gradient_gradient[0][0] += g_i.x * g_j.x;
                    pair.gradient_gradient[0][1] += g_i.x * g_j.y;
                    pair.gradient_gradient[1][0] += g_i.y * g_j.x;
                    pair.gradient_gradient[1][1] += g_i.y * g_j.y;
                    pair.gradient_value[0] += g_i.x * n_j;
                    pair.gradient_value[1] += g_i.y * n_j;
                    pair.value_gradient[0] += n_i * g_j.x;
                    pair.value_gradient[1] += n_i * g_j.y;
                    pair.value_value += n_i * n_j;
                }
            }
        }
        all
    }
}

/// `J = d(x, y) / d(xi, eta)`: row = coordinate, column = local direction.
fn jacobian(nodes: &[Point2<f64>], slopes: &[Vector2<f64>]) -> Matrix2<f64> {
    nodes.iter().zip(slopes).fold(Matrix2::zeros(), |sum, (node, slope)| sum + node.coords * slope.transpose())
}
