//! Loads on a flank in polynomials along the profile, from their definition.
// every test binary uses a part of it
#![allow(dead_code)]

use fecm::element::lagrange::{LagrangeBasis, gauss_rule, legendre};
use fecm::mesh::SectorMesh;
use gear_geom::{FlankSide, Gear};
use nalgebra::Vector2;

/// Nodes and forces of a unit inward normal force at an arc length of the flank, projected on the polynomials up to `order`: the density
/// `sum_m phi_m(a_j) phi_m(a)` with orthonormal `phi_m`, integrated with the shape functions along the element edges.
pub fn unit_load(shape: &SectorMesh, gear: &Gear, side: FlankSide, order: usize, arc: f64) -> Vec<(u32, Vector2<f64>)> {
    let flank = shape.flank(side);
    let (start, end) = (flank.arc_breaks[0], flank.arc_breaks[flank.arc_breaks.len() - 1]);
    assert!(end > start && gear.teeth() > 0);
    let length = end - start;
    let place = |arc: f64| 2.0 * (arc - start) / length - 1.0;
    let line = LagrangeBasis::new(shape.mesh.order);
    let (mut n, mut d) = (vec![0.0; shape.mesh.order + 1], vec![0.0; shape.mesh.order + 1]);
    let mut loads = Vec::new();
    for (edge, ends) in flank.edges.iter().zip(flank.arc_breaks.windows(2)) {
        for (xi, weight) in gauss_rule(24) {
            let at = ends[0] + 0.5 * (1.0 + xi) * (ends[1] - ends[0]);
            let density: f64 = (0..=order)
                .map(|m| (2 * m + 1) as f64 / length * legendre(m, place(arc)).0 * legendre(m, place(at)).0)
                .sum();
            line.values_into(xi, &mut n);
            line.derivatives_into(xi, &mut d);
            let points = edge.iter().map(|&node| shape.mesh.nodes[node as usize].coords);
            let tangent: Vector2<f64> = points.zip(&d).map(|(point, slope)| point * *slope).sum();
            let across = if side == FlankSide::Upper { -1.0 } else { 1.0 };
            let normal = Vector2::new(-tangent.y, tangent.x).normalize();
            let inward = normal * (across * normal.y.signum());
            let force = density * 0.5 * (ends[1] - ends[0]) * weight;
            loads.extend(edge.iter().zip(&n).map(|(&node, value)| (node, inward * (force * value))));
        }
    }
    loads
}
