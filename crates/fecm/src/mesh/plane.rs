//! A plane mesh of quadrilaterals of one order.

use std::collections::HashMap;

use nalgebra::Point2;

use crate::element::ReferenceQuad;
use crate::error::FecmError;

/// Plane quadrilateral mesh.
#[derive(Debug, Clone)]
pub struct PlaneMesh {
    /// Polynomial order of the elements.
    pub order: usize,
    /// Node positions (m).
    pub nodes: Vec<Point2<f64>>,
    /// Node numbers of all elements, `(order + 1)^2` each, tensor order.
    pub connectivity: Vec<u32>,
}

impl PlaneMesh {
    /// Nodes per element.
    #[must_use]
    pub fn nodes_per_element(&self) -> usize {
        (self.order + 1) * (self.order + 1)
    }

    /// Number of elements.
    #[must_use]
    pub fn element_count(&self) -> usize {
        self.connectivity.len() / self.nodes_per_element()
    }

    /// Node numbers of one element.
    #[must_use]
    pub fn element(&self, index: usize) -> &[u32] {
        let n = self.nodes_per_element();
        &self.connectivity[index * n..(index + 1) * n]
    }

    /// All elements in order.
    pub fn elements(&self) -> impl Iterator<Item = &[u32]> {
        self.connectivity.chunks_exact(self.nodes_per_element())
    }

    /// Node positions of one element.
    #[must_use]
    pub fn element_points(&self, index: usize) -> Vec<Point2<f64>> {
        self.element(index).iter().map(|&node| self.nodes[node as usize]).collect()
    }

    /// Corner nodes of one element, counter-clockwise in local coordinates.
    #[must_use]
    pub fn corners(&self, index: usize) -> [u32; 4] {
        let (element, p) = (self.element(index), self.order);
        [element[0], element[p], element[(p + 1) * (p + 1) - 1], element[(p + 1) * p]]
    }

    /// The four edges of one element, `order + 1` nodes each, counter-clockwise: the outside is on the right.
    #[must_use]
    pub fn element_edges(&self, index: usize) -> [Vec<u32>; 4] {
        let (element, p) = (self.element(index), self.order);
        let at = |i: usize, j: usize| element[i + (p + 1) * j];
        let walk = |place: &dyn Fn(usize) -> (usize, usize)| {
            (0..=p)
                .map(|k| {
                    let (i, j) = place(k);
                    at(i, j)
                })
                .collect()
        };
        [walk(&|k| (k, 0)), walk(&|k| (p, k)), walk(&|k| (p - k, p)), walk(&|k| (0, p - k))]
    }

    /// Edges that belong to one element only, in the order of elements: its number and the edge's nodes, the outside on the right. Both
    /// faces of a crack are among them.
    #[must_use]
    pub fn boundary_edges(&self) -> Vec<(usize, Vec<u32>)> {
        let ends = |edge: &[u32]| (edge[0].min(edge[self.order]), edge[0].max(edge[self.order]));
        let all = || (0..self.element_count()).flat_map(|e| self.element_edges(e).map(|edge| (e, edge)));
        // the faces of a crack whose ends are both shared differ in their middle
        let key = |edge: &[u32]| (ends(edge), edge[1].min(edge[self.order - 1]));
        let mut uses = HashMap::new();
        for (_, edge) in all() {
            *uses.entry(key(&edge)).or_insert(0_u32) += 1;
        }
        all().filter(|(_, edge)| uses[&key(edge)] == 1).collect()
    }

    /// Checks that no element is inside out.
    ///
    /// # Errors
    /// [`FecmError::InvertedElement`] naming `body`, the first such element and its place.
    pub fn check(&self, quad: &ReferenceQuad, body: &'static str) -> Result<(), FecmError> {
        for element in 0..self.element_count() {
            let (jacobian, place) = quad.smallest_jacobian(&self.element_points(element));
            if !(jacobian > 0.0) {
                return Err(FecmError::InvertedElement { body, element, x: place.x, y: place.y, jacobian });
            }
        }
        Ok(())
    }
}
