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
    /// Node, degree of freedom, weight.
    terms: Vec<(u32, usize, f64)>,
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

/// A functional at any face position `z`: `sum_cj a_cj du_c/dx_j + b_cj d^2 u_c / dx_j dz` over points of the plane, before `z` is known.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlaneFunctional {
    /// By node: for each component, the factors of value, slope and curvature of its functions along the face.
    weights: BTreeMap<u32, [[f64; 3]; 3]>,
}

impl PlaneFunctional {
    /// Adds a point of the plane with weights `a` and `b`.
    pub fn add(&mut self, point: PointShapes<'_>, a: &Matrix3<f64>, b: &Matrix3<f64>) {
        for ((&node, shape), gradient) in point.nodes.iter().zip(point.values).zip(point.gradients) {
            for (c, [value, slope, curvature]) in self.weights.entry(node).or_default().iter_mut().enumerate() {
                let in_plane = |w: &Matrix3<f64>| w[(c, 0)] * gradient.x + w[(c, 1)] * gradient.y;
                *value += in_plane(a);
                *slope += a[(c, 2)] * shape + in_plane(b);
                *curvature += b[(c, 2)] * shape;
            }
        }
    }

    /// The functional at face position `z` (m), over the unknowns of one symmetry family.
    #[must_use]
    pub fn at(&self, basis: &FaceBasis, z: f64) -> Functional {
        let along: Vec<_> = basis.dofs().iter().map(|dof| (dof.component, basis.derivatives(dof.degree, z))).collect();
        let of_node = |(&node, weights): (&u32, &[[f64; 3]; 3])| {
            let dot = |(d, (c, along)): (usize, &(usize, [f64; 3]))| {
                (node, d, weights[*c].iter().zip(along).map(|(weight, function)| weight * function).sum())
            };
            along.iter().enumerate().map(dot).collect::<Vec<_>>()
        };
        Functional { terms: self.weights.iter().flat_map(of_node).collect() }
    }
}

impl Functional {
    /// From nodes, degrees of freedom and weights, no unknown twice.
    #[must_use]
    pub fn new(mut terms: Vec<(u32, usize, f64)>) -> Self {
        terms.sort_unstable_by_key(|&(node, dof, _)| (node, dof));
        Self { terms }
    }

    /// Nodes, degrees of freedom and weights, ascending.
    #[must_use]
    pub fn terms(&self) -> &[(u32, usize, f64)] {
        &self.terms
    }

    /// Value on a field given by its unknowns.
    pub fn value(&self, mut unknown: impl FnMut(u32, usize) -> f64) -> f64 {
        self.terms.iter().map(|&(node, dof, weight)| weight * unknown(node, dof)).sum()
    }
}
