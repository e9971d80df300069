//! Whether springs and fixed nodes keep every connected part of a mesh from moving as a rigid body.

use faer::Mat;
use fecm::linalg::symmetric_eigen;
use nalgebra::{Matrix3, Vector3};

use super::assembly::NodeSpring;
use super::error::HousingError;
use super::mesh::SolidMesh;

/// Stiffness against the softest rigid motion over that against the stiffest, below which a part counts as free: what a factorisation in double
/// precision still solves with a few digits.
const SOFTEST: f64 = 1e-11;

/// Checks every connected part.
///
/// # Errors
/// [`HousingError::NotHeld`] with the size and place of the first part that is not.
pub fn check(mesh: &SolidMesh, springs: &[NodeSpring], fixed: &[u32]) -> Result<(), HousingError> {
    let parts = parts(mesh);
    let mut found: Vec<(u32, Vec<u32>)> = Vec::new();
    for (node, &part) in parts.iter().enumerate().filter(|(_, part)| **part != u32::MAX) {
        match found.binary_search_by_key(&part, |(first, _)| *first) {
            Ok(index) => found[index].1.push(node as u32),
            Err(index) => found.insert(index, (part, vec![node as u32])),
        }
    }
    // fixed nodes count as springs as stiff as the stiffest, or of 1 N/m
    let stiffest = springs.iter().map(|s| s.stiffness.norm()).fold(0.0, f64::max);
    let rigid = Matrix3::identity() * if stiffest > 0.0 { stiffest } else { 1.0 };
    for (part, nodes) in found {
        let middle = nodes.iter().map(|&n| mesh.node(n)).sum::<Vector3<f64>>() / nodes.len() as f64;
        let size = nodes.iter().map(|&n| (mesh.node(n) - middle).norm()).fold(0.0, f64::max);
        let mut stiffness = Mat::<f64>::zeros(6, 6);
        let held_here = springs.iter().map(|s| (s.node, s.stiffness)).chain(fixed.iter().map(|&node| (node, rigid)));
        for (node, spring) in held_here.filter(|(node, _)| parts[*node as usize] == part) {
            let arm = (mesh.node(node) - middle) / size;
            let motions = [Vector3::x(), Vector3::y(), Vector3::z()];
            let motions = [motions, motions.map(|axis| axis.cross(&arm))].concat();
            for (i, a) in motions.iter().enumerate() {
                for (j, b) in motions.iter().enumerate() {
                    stiffness[(i, j)] += a.dot(&(spring * b));
                }
            }
        }
        let (values, _) = symmetric_eigen(&stiffness, "rigid motion")?;
        let (softest, stiffest) = (values.first().copied(), values.last().copied());
        if !(softest > stiffest.map(|k| k * SOFTEST) && softest > Some(0.0)) {
            return Err(HousingError::NotHeld { nodes: nodes.len(), place: middle.into() });
        }
    }
    Ok(())
}

/// Lowest node of the connected part that each node belongs to; `u32::MAX` of nodes without element.
fn parts(mesh: &SolidMesh) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
    let root = |parent: &mut Vec<u32>, mut node: u32| {
        while parent[node as usize] != node {
            let above = parent[parent[node as usize] as usize];
            parent[node as usize] = above;
            node = above;
        }
        node
    };
    let mut used = vec![false; mesh.nodes.len()];
    for element in &mesh.elements {
        for pair in element.nodes.windows(2) {
            let (a, b) = (root(&mut parent, pair[0]), root(&mut parent, pair[1]));
            parent[a.max(b) as usize] = a.min(b);
        }
        element.nodes.iter().for_each(|&node| used[node as usize] = true);
    }
    (0..parent.len()).map(|node| if used[node] { root(&mut parent, node as u32) } else { u32::MAX }).collect()
}
