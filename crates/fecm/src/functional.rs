//! Linear functionals of the displacement of an extruded body.
//!
//! A strain at a point, or an integral of strains over a region, is `sum w_k u_k` over the body's unknowns. What is read from many solutions
//! of one body is better kept in this form: it is then carried through the body's factorisation once, like a load.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector2};

use crate::face::FaceBasis;

/// `sum w u` over the unknowns of nodes, in Cartesian components.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Functional {
    /// By node and degree of freedom.
    weights: BTreeMap<(u32, usize), f64>,
}

/// Shape functions at a point of an element, and their derivatives with respect to `x` and `y` (1/m).
#[derive(Debug, Clone, Copy)]
pub struct PointShapes<'a> {
    /// Nodes.
    pub nodes: &'a [u32],
    /// Values.
    pub values: &'a [f64],
    /// Derivatives.
    pub gradients: &'a [Vector2<f64>],
}

impl Functional {
    /// Adds `sum_cj weights_cj du_c/dx_j + axial_cj d^2 u_c / dx_j dz` at a point of the plane and face position `z` (m).
    pub fn add_gradient(
        &mut self,
        basis: &FaceBasis,
        z: f64,
        point: PointShapes<'_>,
        weights: &Matrix3<f64>,
        axial: &Matrix3<f64>,
    ) {
        for (d, dof) in basis.dofs().iter().enumerate() {
            let c = dof.component;
            let [value, slope, curvature] = basis.derivatives(dof.degree, z);
            for ((&node, shape), gradient) in point.nodes.iter().zip(point.values).zip(point.gradients) {
                let along = |w: &Matrix3<f64>, f: f64, df: f64| {
                    (w[(c, 0)] * gradient.x + w[(c, 1)] * gradient.y) * f + w[(c, 2)] * shape * df
                };
                *self.weights.entry((node, d)).or_default() +=
                    along(weights, value, slope) + along(axial, slope, curvature);
            }
        }
    }

    /// Adds `weight` times one unknown.
    pub fn add(&mut self, node: u32, dof: usize, weight: f64) {
        *self.weights.entry((node, dof)).or_default() += weight;
    }

    /// Nodes, degrees of freedom and weights, ascending.
    pub fn terms(&self) -> impl Iterator<Item = (u32, usize, f64)> + '_ {
        self.weights.iter().map(|(&(node, dof), &weight)| (node, dof, weight))
    }

    /// Value on a field given by its unknowns.
    pub fn value(&self, mut unknown: impl FnMut(u32, usize) -> f64) -> f64 {
        self.terms().map(|(node, dof, weight)| weight * unknown(node, dof)).sum()
    }
}
