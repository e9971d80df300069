//! A whole gear as one mesh. The file is part of test binaries and of the crate's own tests: its parent brings the types.

use std::collections::HashMap;

use nalgebra::{Point2, Rotation2};

use super::{PlaneMesh, SectorMesh};

/// All sectors as one mesh: nodes `(sector, node) -> number`, nodes on shared cuts merged.
pub fn full_ring(sector: &SectorMesh, teeth: usize) -> (PlaneMesh, Vec<Vec<u32>>) {
    let lower_of: HashMap<u32, u32> = sector.upper_cut.iter().copied().zip(sector.lower_cut.iter().copied()).collect();
    let mut numbers = vec![vec![u32::MAX; sector.mesh.nodes.len()]; teeth];
    let mut nodes = Vec::new();
    for (tooth, own) in numbers.iter_mut().enumerate() {
        for (node, number) in own.iter_mut().enumerate().filter(|(node, _)| !lower_of.contains_key(&(*node as u32))) {
            *number = nodes.len() as u32;
            let turned = Rotation2::new(sector.sector_angle * tooth as f64) * sector.mesh.nodes[node].coords;
            nodes.push(Point2::from(turned));
        }
    }
    for tooth in 0..teeth {
        for (&upper, &lower) in &lower_of {
            numbers[tooth][upper as usize] = numbers[(tooth + 1) % teeth][lower as usize];
        }
    }
    let connectivity =
        numbers.iter().flat_map(|own| sector.mesh.connectivity.iter().map(|&node| own[node as usize])).collect();
    (PlaneMesh { order: sector.mesh.order, nodes, connectivity }, numbers)
}
