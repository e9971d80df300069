//! The outer surface of a mesh: shares of area of its nodes, and where a ray from the axis leaves it.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::element::Shape;
use super::mesh::SolidMesh;

/// Outer faces with their shape functions.
#[derive(Debug)]
pub struct Surface {
    faces: Vec<Vec<u32>>,
    /// By number of nodes.
    shapes: BTreeMap<usize, Shape>,
}

/// A point of the surface as a combination of nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePoint {
    /// Where (m).
    pub position: [f64; 3],
    /// Nodes and their weights; the weights add up to one.
    pub nodes: Vec<(u32, f64)>,
}

/// How far outside its face, in reference coordinates, a point may lie: rounding only.
const EDGE: f64 = 1e-9;

impl Surface {
    /// Of a mesh.
    #[must_use]
    pub fn new(mesh: &SolidMesh) -> Self {
        let faces = mesh.outer_faces();
        let sizes = faces.iter().map(Vec::len);
        let shapes = sizes.filter_map(|size| Some((size, Shape::of_face(size)?))).collect();
        Self { faces, shapes }
    }

    /// Share of each node of a set in the area of the outer faces all of whose nodes are in the set; equal shares if there are none.
    ///
    /// A face's area goes to its nodes in proportion to `int N_i^2 dA` (Hinton, Rock and Zienkiewicz 1976): positive at corners and
    /// at the middle of edges.
    #[must_use]
    pub fn shares(&self, mesh: &SolidMesh, set: &[u32]) -> Vec<f64> {
        let mut shares = vec![0.0; set.len()];
        for face in &self.faces {
            let local: Option<Vec<usize>> = face.iter().map(|node| set.binary_search(node).ok()).collect();
            let (Some(local), Some(shape)) = (local, self.shapes.get(&face.len())) else { continue };
            let mut area = 0.0;
            let mut squares = vec![0.0; face.len()];
            for (at, weight) in face_rule(face.len()) {
                let (values, frame) = (shape.values(at), tangents(mesh, face, shape, at));
                let part = weight * frame[0].cross(&frame[1]).norm();
                area += part;
                squares.iter_mut().zip(&values).for_each(|(s, n)| *s += part * n * n);
            }
            let total: f64 = squares.iter().sum();
            for (&node, square) in local.iter().zip(&squares) {
                shares[node] += area * square / total;
            }
        }
        let total: f64 = shares.iter().sum();
        if shares.iter().all(|&share| share > 0.0) {
            shares.iter().map(|share| share / total).collect()
        } else {
            // part of the set is inside or on edges only
            vec![1.0 / set.len() as f64; set.len()]
        }
    }

    /// Outermost point where the ray from `(0, 0, height)` at an angle about `z` crosses the surface, level.
    #[must_use]
    pub fn outermost(&self, mesh: &SolidMesh, angle: f64, height: f64) -> Option<SurfacePoint> {
        let direction = Vector3::new(angle.cos(), angle.sin(), 0.0);
        let start = Vector3::new(0.0, 0.0, height);
        let crossings = self.faces.iter().filter_map(|face| {
            let shape = self.shapes.get(&face.len())?;
            crossing(mesh, face, shape, start, direction)
        });
        let farthest = crossings.max_by(|a, b| a.0.total_cmp(&b.0));
        farthest.map(|(_, point)| point)
    }

    /// Node of the surface nearest to a place.
    #[must_use]
    pub fn nearest_node(&self, mesh: &SolidMesh, place: [f64; 3]) -> Option<SurfacePoint> {
        let distance = |node: u32| (mesh.node(node) - Vector3::from(place)).norm();
        let nodes = self.faces.iter().flatten().copied();
        let node = nodes.min_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)))?;
        Some(SurfacePoint { position: mesh.nodes[node as usize], nodes: vec![(node, 1.0)] })
    }
}

/// Where a ray crosses a face, by Newton's method from the middle: distance and point.
fn crossing(
    mesh: &SolidMesh,
    face: &[u32],
    shape: &Shape,
    start: Vector3<f64>,
    direction: Vector3<f64>,
) -> Option<(f64, SurfacePoint)> {
    let triangle = face.len() % 3 == 0;
    let middle: Vector3<f64> = face.iter().map(|&n| mesh.node(n)).sum::<Vector3<f64>>() / face.len() as f64;
    let size = face.iter().map(|&n| (mesh.node(n) - middle).norm()).fold(0.0, f64::max);
    let to_middle = middle - start;
    let along = to_middle.dot(&direction);
    // twice the size: curved faces reach beyond their nodes
    if along < -size || (to_middle - along * direction).norm() > 2.0 * size {
        return None;
    }
    let mut at = if triangle { Vector3::new(1.0 / 3.0, 1.0 / 3.0, 0.0) } else { Vector3::zeros() };
    let mut distance = along;
    for _ in 0..30 {
        let values = shape.values(at.into());
        let point: Vector3<f64> = face.iter().zip(&values).map(|(&node, &n)| n * mesh.node(node)).sum();
        let rest = start + distance * direction - point;
        let [a, b] = tangents(mesh, face, shape, at.into());
        let step = Matrix3::from_columns(&[a, b, -direction]).try_inverse()? * rest;
        at += Vector3::new(step.x, step.y, 0.0);
        distance += step.z;
        if !(at.norm() < 10.0) {
            return None;
        }
        if step.x.abs() + step.y.abs() < 1e-13 {
            break;
        }
    }
    let inside = if triangle {
        at.x >= -EDGE && at.y >= -EDGE && at.x + at.y <= 1.0 + EDGE
    } else {
        at.x.abs() <= 1.0 + EDGE && at.y.abs() <= 1.0 + EDGE
    };
    let position = start + distance * direction;
    let point = || SurfacePoint {
        position: position.into(),
        nodes: face.iter().copied().zip(shape.values(at.into())).collect(),
    };
    (inside && distance > 0.0).then(|| (distance, point()))
}

/// Derivatives of place by the two reference coordinates of a face.
fn tangents(mesh: &SolidMesh, face: &[u32], shape: &Shape, at: [f64; 3]) -> [Vector3<f64>; 2] {
    let gradients = shape.gradients(at);
    [0, 1].map(|d| face.iter().zip(&gradients).map(|(&node, g)| g[d] * mesh.node(node)).sum())
}

fn face_rule(nodes: usize) -> Vec<([f64; 3], f64)> {
    let line = fecm::element::lagrange::gauss_rule(3);
    let unit = |x: f64| 0.5 * (1.0 + x);
    let point = |x: f64, y: f64, weight: f64| {
        if nodes % 3 == 0 {
            // the square collapsed to a triangle
            ([unit(x) * (1.0 - unit(y)), unit(y), 0.0], 0.25 * weight * (1.0 - unit(y)))
        } else {
            ([x, y, 0.0], weight)
        }
    };
    line.iter().flat_map(|&(x, a)| line.iter().map(move |&(y, b)| point(x, y, a * b))).collect()
}
