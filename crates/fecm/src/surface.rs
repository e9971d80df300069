//! Stress along a free surface of an extruded body, from the displacement of the surface alone.
//!
//! With no traction, the stress along the tangent `t` of the profile follows from strains within the surface:
//!
//! `sigma_tt = 2 mu e_tt + 2 lambda mu / (lambda + 2 mu) (e_tt + e_zz)`
//!
//! (`e_zz = 0` in plane strain; in plane stress `lambda` is the reduced constant and the formula is `E e_tt`). Taken at the Gauss points of the element edges,
//! where derivatives of interpolated displacements are most accurate. Verified on a thick ring, a bent beam and a plate with a hole
//! (`tests/stress.rs`).

use nalgebra::{Matrix3, Point2, Vector2};

use crate::element::lagrange::{LagrangeBasis, gauss_rule};
use crate::face::FaceBasis;
use crate::functional::{PlaneFunctional, PointShapes};
use crate::mesh::PlaneMesh;

/// A point of a surface and the edge that holds it.
#[derive(Debug, Clone)]
pub struct SurfacePoint {
    /// Position in the plane (m).
    pub place: Point2<f64>,
    /// Unit tangent, in the direction of the edge's nodes.
    pub tangent: Vector2<f64>,
    nodes: Vec<u32>,
    values: Vec<f64>,
    /// Shape derivatives along the surface (1/m), times the tangent.
    gradients: Vec<Vector2<f64>>,
}

impl SurfacePoint {
    /// The Gauss points of an element edge, in its direction.
    #[must_use]
    pub fn of_edge(mesh: &PlaneMesh, edge: &[u32]) -> Vec<Self> {
        let line = LagrangeBasis::new(mesh.order);
        let (mut values, mut slopes) = (vec![0.0; edge.len()], vec![0.0; edge.len()]);
        let rule = gauss_rule(mesh.order);
        let point = |x: f64| {
            line.values_into(x, &mut values);
            line.derivatives_into(x, &mut slopes);
            let sum = |weights: &[f64]| -> Vector2<f64> {
                edge.iter().zip(weights).map(|(&node, w)| mesh.nodes[node as usize].coords * *w).sum()
            };
            let along = sum(&slopes);
            let (stretch, tangent) = (along.norm(), along.normalize());
            Self {
                place: Point2::from(sum(&values)),
                tangent,
                nodes: edge.to_vec(),
                values: values.clone(),
                gradients: slopes.iter().map(|slope| tangent * (slope / stretch)).collect(),
            }
        };
        rule.into_iter().map(|(x, _)| x).map(point).collect()
    }

    /// Tangential stress along the face (Pa per m of displacement).
    #[must_use]
    pub fn stress(&self, basis: &FaceBasis) -> PlaneFunctional {
        let (lambda, mu) = (basis.lambda(), basis.shear());
        let shared = 2.0 * lambda * mu / (lambda + 2.0 * mu);
        let in_plane = self.tangent * self.tangent.transpose() * (2.0 * mu + shared);
        let mut weights = Matrix3::zeros();
        weights.fixed_view_mut::<2, 2>(0, 0).copy_from(&in_plane);
        weights[(2, 2)] = shared;
        let mut functional = PlaneFunctional::default();
        let point = PointShapes { nodes: &self.nodes, values: &self.values, gradients: &self.gradients };
        functional.add(point, &weights, &Matrix3::zeros());
        functional
    }
}
