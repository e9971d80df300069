//! Nodes at and around a crack whose length varies along the face: they have functions along the face of their own.

use std::collections::HashSet;

use gear_geom::CrackFront;
use nalgebra::Point2;

use super::crack_path::polyline_length;
use super::plane::PlaneMesh;
use crate::condense::RichNode;
use crate::face_part::FacePart;

/// Nodes within this share of the facewidth of a crack, but no farther than the crack is long, have more functions along the face.
const ZONE: f64 = 0.25;

/// Quadratic and cubic functions on each layer of the face.
const LAYER_DEGREES: usize = 2;

/// Parts of the face shorter than this share of it are left closed.
const LEAST_PART: f64 = 1e-6;

/// Nodes that open where the crack reaches them, and those around it that need more functions along the face.
///
/// A node halfway along the front is as good open as closed, so it counts as open where the crack reaches half of the way to the next node.
pub(super) fn rich_nodes(
    mesh: &PlaneMesh,
    nodes: &[Vec<u32>; 2],
    front: &CrackFront,
    width: f64,
    keep: &[u32],
) -> Vec<RichNode> {
    if front.is_through() {
        return Vec::new();
    }
    let layer_degrees = LAYER_DEGREES;
    let path: Vec<Point2<f64>> = nodes[0].iter().map(|&node| mesh.nodes[node as usize]).collect();
    let total = polyline_length(&path);
    let zone = (ZONE * width).min(total);
    let (mut near_face, mut far_face) = (Vec::new(), Vec::new());
    let mut along = 0.0;
    for (k, pair) in path.windows(2).enumerate() {
        let step = (pair[1] - pair[0]).norm();
        let parts = front.open_parts(width, (along + 0.5 * step) / total).into_iter();
        let parts = parts.filter(|ends| ends[1] - ends[0] > LEAST_PART * width);
        let open: Vec<FacePart> = parts.map(|ends| FacePart::within(width, ends)).collect();
        let [far, near] = [nodes[0][k], nodes[1][k]];
        near_face.push(RichNode { node: near, follows: near, open: open.clone(), layer_degrees });
        far_face.push(RichNode { node: far, follows: near, open, layer_degrees: 0 });
        along += step;
    }
    let faces: HashSet<u32> = nodes.iter().flat_map(|face| &face[..path.len() - 1]).copied().collect();
    let around = (0..mesh.nodes.len() as u32).filter(|node| {
        let near = || path.iter().any(|point| (point - mesh.nodes[*node as usize]).norm() < zone);
        !faces.contains(node) && !keep.contains(node) && near()
    });
    let around = around.map(|node| RichNode { node, follows: node, open: Vec::new(), layer_degrees });
    near_face.into_iter().chain(far_face).chain(around).collect()
}
