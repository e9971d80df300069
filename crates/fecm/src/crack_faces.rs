//! Cells on the faces of a crack, where the faces can press on each other.
//!
//! A crack on the tension side opens under load; one on the compression side, or under reversed torque, closes, and its faces carry load. Both faces have the
//! same nodes along the path, so contact is between pairs of nodes: with the consistent normal `n_i L_i = int N_i n ds` of a node and a place
//! `z_k` along the face, the opening of a cell is the functional
//!
//! `w_ik . u = n_i . (u_tooth - u_body)(x_i, z_k)`
//!
//! and the same `w_ik` times a force is the load of a pair of forces that push the faces apart. Forces `p L_i b_k` are those of a uniform pressure
//! `p`, exactly, with the weights `b_k` of Gauss's rule along the face: a patch of closed faces passes a uniform stress unchanged. There are as many places
//! along the face as functions, so the cells of a crack are independent and their compliance `W^T K^-1 W` is positive definite.
//!
//! | symbol | field | meaning | unit |
//! |---|---|---|---|
//! | `n_i` | - | unit normal, from the body toward the tooth | - |
//! | `L_i` | [`CrackFaceCells::lengths`] | part of the path that belongs to a node | m |
//! | `z_k` | [`CrackFaceCells::face`] | face positions | m |
//! | `b_k` | [`CrackFaceCells::widths`] | part of the face that belongs to a place | m |
//!
//! No friction. The tip belongs to both faces and has no cell. Verified by `tests/closing_crack.rs`: a notched plate under pressure is a sound one.

use nalgebra::Vector2;

use crate::element::lagrange::{LagrangeBasis, gauss_rule};
use crate::face::FaceBasis;
use crate::functional::Functional;
use crate::mesh::PlaneMesh;

/// Cells of one crack: pairs of nodes along the path times places along the face.
#[derive(Debug, Clone, PartialEq)]
pub struct CrackFaceCells {
    /// Distance of each pair of nodes from the mouth along the path (m).
    pub along: Vec<f64>,
    /// Part of the path that belongs to each pair (m).
    pub lengths: Vec<f64>,
    /// Face positions of the cells (m, 0 at mid-face); in a scene symmetric about mid-face, of the half at `z > 0`.
    pub face: Vec<f64>,
    /// Part of the face that belongs to each of them (m), mirror images included.
    pub widths: Vec<f64>,
    pairs: Vec<NodePair>,
}

/// Two nodes at one place.
#[derive(Debug, Clone, PartialEq)]
struct NodePair {
    /// On the face toward the tooth, on the face toward the body.
    nodes: [u32; 2],
    /// From the body toward the tooth.
    normal: Vector2<f64>,
}

impl CrackFaceCells {
    /// Cells between two faces, each from the mouth to the common tip, the first on the side that is "the tooth", in a body whose displacement has
    /// these symmetry families. `None` if the faces are no crack of this mesh.
    #[must_use]
    pub fn new(mesh: &PlaneMesh, faces: [&[u32]; 2], bases: &[&FaceBasis]) -> Option<Self> {
        let p = mesh.order;
        let count = faces[0].len();
        if count != faces[1].len() || count <= p || (count - 1) % p != 0 || faces[0].last() != faces[1].last() {
            return None;
        }
        let toward_tooth = side(mesh, &faces[0][..=p])?;
        let line = LagrangeBasis::new(p);
        let (mut values, mut slopes) = (vec![0.0; p + 1], vec![0.0; p + 1]);
        let mut shares = vec![Vector2::zeros(); count];
        let mut along = vec![0.0; count];
        for first in (0..count - 1).step_by(p) {
            let nodes = &faces[0][first..=first + p];
            let mut tangent_at = |x: f64, values: &mut [f64]| -> Vector2<f64> {
                line.values_into(x, values);
                line.derivatives_into(x, &mut slopes);
                nodes.iter().zip(&slopes).map(|(&node, slope)| mesh.nodes[node as usize].coords * *slope).sum()
            };
            // exact for the normal, which is of one degree less than the shapes
            for (x, weight) in gauss_rule(p + 1) {
                let tangent = tangent_at(x, &mut values);
                let normal = Vector2::new(-tangent.y, tangent.x) * (toward_tooth * weight);
                for (share, value) in shares[first..].iter_mut().zip(&values) {
                    *share += normal * *value;
                }
            }
            let points = line.points();
            for k in 1..=p {
                let (from, to) = (points[k - 1], points[k]);
                let part = |(x, weight): (f64, f64)| {
                    let place = f64::midpoint(from, to) + 0.5 * (to - from) * x;
                    0.5 * (to - from) * weight * tangent_at(place, &mut values).norm()
                };
                along[first + k] = along[first + k - 1] + gauss_rule(p + 1).into_iter().map(part).sum::<f64>();
            }
        }
        let last = count - 1;
        let pair = |k: usize| NodePair { nodes: [faces[0][k], faces[1][k]], normal: shares[k].normalize() };
        let (face, widths) = places(bases).into_iter().unzip();
        along.truncate(last);
        Some(Self {
            along,
            lengths: shares[..last].iter().map(Vector2::norm).collect(),
            face,
            widths,
            pairs: (0..last).map(pair).collect(),
        })
    }

    /// Number of cells.
    #[must_use]
    pub fn size(&self) -> usize {
        self.pairs.len() * self.face.len()
    }

    /// Area of a cell (m^2): forces over it are pressures.
    #[must_use]
    pub fn area(&self, cell: usize) -> f64 {
        self.lengths[cell / self.face.len()] * self.widths[cell % self.face.len()]
    }

    /// Nodes of a row (on the face toward the tooth, on the face toward the body) and its unit normal, from the body toward the tooth.
    #[must_use]
    pub fn row(&self, row: usize) -> ([u32; 2], Vector2<f64>) {
        (self.pairs[row].nodes, self.pairs[row].normal)
    }

    /// Opening of every cell as a functional of the displacement in one symmetry family, which is also the load of a unit pair of forces that
    /// pushes the faces apart: pair of nodes by pair of nodes, along the face.
    #[must_use]
    pub fn openings(&self, basis: &FaceBasis) -> Vec<Functional> {
        let values: Vec<Vec<f64>> = self.face.iter().map(|&z| basis.plane_values(z)).collect();
        let of_pair = |pair: &NodePair| -> Vec<Functional> {
            let at = |values: &Vec<f64>| {
                let unknowns = values.iter().enumerate().flat_map(|(k, value)| [0, 1].map(|c| (2 * k + c, c, value)));
                let terms = unknowns.flat_map(|(dof, c, value)| {
                    let weight = pair.normal[c] * value;
                    [(pair.nodes[0], dof, weight), (pair.nodes[1], dof, -weight)]
                });
                Functional::new(terms.collect())
            };
            values.iter().map(at).collect()
        };
        self.pairs.iter().flat_map(of_pair).collect()
    }
}

/// +1 if the element that holds an edge lies to the left of it, -1 to the right; `None` if no element has this edge.
fn side(mesh: &PlaneMesh, edge: &[u32]) -> Option<f64> {
    let place = |node: u32| mesh.nodes[node as usize].coords;
    let nodes = mesh.elements().find(|nodes| edge.iter().all(|node| nodes.contains(node)))?;
    let centre = nodes.iter().map(|&node| place(node)).sum::<Vector2<f64>>() / nodes.len() as f64;
    let (from, to) = (place(edge[0]), place(edge[edge.len() - 1]));
    let (tangent, inward) = (to - from, centre - (from + to) * 0.5);
    Some((tangent.x * inward.y - tangent.y * inward.x).signum())
}

/// Face positions and widths: as many as functions along the face.
fn places(bases: &[&FaceBasis]) -> Vec<(f64, f64)> {
    let functions: usize = bases.iter().map(|basis| basis.plane_degrees().len()).sum();
    let half = bases.first().map_or(0.0, |basis| 0.5 * basis.width());
    let is_odd = |basis: &&FaceBasis| basis.plane_degrees().iter().any(|degree| degree % 2 == 1);
    if functions < 2 || bases.iter().any(is_odd) {
        return gauss_rule(functions).into_iter().map(|(x, weight)| (half * x, half * weight)).collect();
    }
    let positive = gauss_rule(2 * functions).into_iter().filter(|(x, _)| *x > 0.0);
    positive.map(|(x, weight)| (half * x, 2.0 * half * weight)).collect()
}
