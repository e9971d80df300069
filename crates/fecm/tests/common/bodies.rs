//! Plane bodies with closed solutions: blocks, loads on edges, soft springs against drift.
#![allow(dead_code)]

use faer::Mat;
use fecm::Material;
use fecm::condense::{CondensedBody, Substructure};
use fecm::element::lagrange::{LagrangeBasis, gauss_rule};
use fecm::face::FaceBasis;
use fecm::functional::Functional;
use fecm::mesh::PlaneMesh;
use fecm::mesh::blocks::{BlockMesher, Edge, geometric_breaks};
use nalgebra::{Point2, Vector2};

/// Traction (Pa) by place.
pub type Traction<'a> = &'a dyn Fn(Point2<f64>) -> Vector2<f64>;

/// A mesh, edges that carry load or springs, and the faces of its crack.
pub struct Body {
    pub mesh: PlaneMesh,
    /// Element edges by name: what a constructor says.
    pub edges: Vec<Vec<Vec<u32>>>,
    pub crack: [Vec<u32>; 2],
}

/// Displacement of a loaded body.
pub struct Solution {
    condensed: CondensedBody,
    moved: Mat<f64>,
    /// Strain energy (J).
    pub energy: f64,
}

impl Body {
    /// Solves under tractions (Pa) at places of edges, each uniform along the face; edges held, or all boundary on springs so soft that
    /// they only keep balanced loads from drifting.
    pub fn solve(&self, basis: &FaceBasis, held: Option<usize>, tractions: &[(usize, Traction<'_>)]) -> Solution {
        let fixed: Vec<u32> = held.map_or_else(Vec::new, |k| self.edges[k].concat());
        let size = self.mesh.nodes.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let all: Vec<Vec<u32>> = self.edges.concat();
        let springs = held.is_none().then_some((1e-9 * Material::STEEL.young_modulus / size, all.as_slice()));
        let body = Substructure { mesh: &self.mesh, retained: vec![], fixed, springs, rich: &[] };
        let condensed = CondensedBody::new(&body, basis).unwrap();
        let line = LagrangeBasis::new(self.mesh.order);
        let (mut shapes, mut slopes) = (vec![0.0; self.mesh.order + 1], vec![0.0; self.mesh.order + 1]);
        let mut loads = Mat::<f64>::zeros(condensed.interior_size(), 1);
        for (edge, traction) in tractions {
            for piece in &self.edges[*edge] {
                for (x, weight) in gauss_rule(self.mesh.order + 2) {
                    line.values_into(x, &mut shapes);
                    line.derivatives_into(x, &mut slopes);
                    let sum = |w: &[f64]| -> Vector2<f64> {
                        piece.iter().zip(w).map(|(&n, w)| self.mesh.nodes[n as usize].coords * *w).sum()
                    };
                    let force = traction(Point2::from(sum(&shapes))) * (weight * sum(&slopes).norm() * basis.width());
                    for (&node, shape) in piece.iter().zip(&shapes) {
                        for c in 0..2 {
                            if let Some(row) = condensed.interior_row(node, c) {
                                loads[(row, 0)] += force[c] * shape;
                            }
                        }
                    }
                }
            }
        }
        let mut moved = loads.clone();
        condensed.solve_interior(&mut moved);
        let energy = 0.5 * (0..loads.nrows()).map(|i| loads[(i, 0)] * moved[(i, 0)]).sum::<f64>();
        Solution { condensed, moved, energy }
    }
}

impl Solution {
    pub fn value(&self, functional: &Functional) -> f64 {
        functional.value(|node, dof| self.condensed.interior_row(node, dof).map_or(0.0, |row| self.moved[(row, 0)]))
    }
}

impl Solution {
    /// Displacement by a functional taken as a load: `K^-1 w`, to be read with [`Self::read`].
    pub fn response(&self, load: &Functional) -> Mat<f64> {
        let mut moved = Mat::<f64>::zeros(self.moved.nrows(), 1);
        for &(node, dof, weight) in load.terms() {
            if let Some(row) = self.condensed.interior_row(node, dof) {
                moved[(row, 0)] += weight;
            }
        }
        self.condensed.solve_interior(&mut moved);
        moved
    }

    /// Value of a functional on a displacement.
    pub fn read(&self, moved: &Mat<f64>, functional: &Functional) -> f64 {
        functional.value(|node, dof| self.condensed.interior_row(node, dof).map_or(0.0, |row| moved[(row, 0)]))
    }
}

fn pieces(order: usize, edge: &Edge) -> Vec<Vec<u32>> {
    edge.nodes().windows(order + 1).step_by(order).map(<[u32]>::to_vec).collect()
}

/// Annulus; edges: bore, outside.
pub fn annulus(order: usize, radial: usize, around: usize, radii: [f64; 2], ratio: f64) -> Body {
    let mut mesher = BlockMesher::new(order);
    let at = |r: f64, angle: f64| Point2::new(r * angle.cos(), r * angle.sin());
    let quarter = std::f64::consts::FRAC_PI_2;
    let even: Vec<f64> = (0..=around).map(|k| k as f64 / around as f64).collect();
    let out = geometric_breaks(radial, ratio);
    let corners: Vec<_> = (0..4).map(|k| radii.map(|r| mesher.vertex(at(r, quarter * f64::from(k))))).collect();
    let spokes: Vec<Edge> = (0..4)
        .map(|k| {
            let angle = quarter * f64::from(k);
            mesher.edge(corners[k as usize][0], corners[k as usize][1], &out, |t| {
                at(radii[0] + t * (radii[1] - radii[0]), angle)
            })
        })
        .collect();
    let mut edges = vec![Vec::new(), Vec::new()];
    for k in 0..4 {
        let next = (k + 1) % 4;
        let arcs = [0, 1]
            .map(|i| mesher.edge(corners[k][i], corners[next][i], &even, |t| at(radii[i], quarter * (k as f64 + t))));
        // counter-clockwise: outward along the first spoke, around the outside, back in
        mesher.block(&spokes[k], &spokes[next], &arcs[0], &arcs[1]);
        edges[0].extend(pieces(order, &arcs[0]));
        edges[1].extend(pieces(order, &arcs[1]));
    }
    Body { mesh: mesher.finish(), edges, crack: [vec![], vec![]] }
}

/// Plate `[0, width] x [-low, high]` with a crack of length `crack` along `y = 0` from `x = 0`, bent like `y = bend x^2`; edges: bottom, top, right below, right
/// above.
pub fn cracked_plate(order: usize, width: f64, heights: [f64; 2], crack: f64, bend: f64) -> Body {
    let mut mesher = BlockMesher::new(order);
    let tip = crack / width;
    let graded = |count| geometric_breaks(count, 2.0);
    let to_tip: Vec<f64> = graded(6).iter().rev().map(|b| tip * (1.0 - b)).collect();
    let from_tip: Vec<f64> = graded(6).iter().map(|b| tip + (1.0 - tip) * b).collect();
    let across = [to_tip.clone(), from_tip[1..].to_vec()].concat();
    let up = geometric_breaks(9, 1.8);
    let curve = |x: f64| Point2::new(x * width, bend * (x * width).powi(2));
    let far = |x: f64, sign: f64| Point2::new(x * width, if sign > 0.0 { heights[1] } else { -heights[0] });
    let [mouth_above, mouth_below, end, right] = [0.0, 0.0, tip, 1.0].map(|x| mesher.vertex(curve(x)));
    let above = mesher.edge(mouth_above, end, &to_tip, curve);
    let below = mesher.edge(mouth_below, end, &to_tip, curve);
    let ligament = mesher.edge(end, right, &from_tip, curve);
    let mut edges = Vec::new();
    let mut sides = Vec::new();
    for (edge, mouth, sign) in [(&below, mouth_below, -1.0), (&above, mouth_above, 1.0)] {
        let [left_far, right_far] = [0.0, 1.0].map(|x| mesher.vertex(far(x, sign)));
        let away = mesher.edge(left_far, right_far, &across, |t| far(t, sign));
        let mix = |x: f64, t: f64| curve(x) + (far(x, sign) - curve(x)) * t;
        let left = mesher.edge(mouth, left_far, &up, |t| mix(0.0, t));
        let side = mesher.edge(right, right_far, &up, |t| mix(1.0, t));
        let near = edge.joined(&ligament);
        if sign > 0.0 {
            mesher.block(&near, &away, &left, &side);
        } else {
            mesher.block(&away, &near, &left.reversed(), &side.reversed());
        }
        edges.push(pieces(order, &away));
        sides.push(pieces(order, &side));
    }
    edges.extend(sides);
    Body { mesh: mesher.finish(), edges, crack: [above.nodes().to_vec(), below.nodes().to_vec()] }
}

/// Beam `[0, length] x [-height/2, height/2]`; edges: left, right, top (from right to left).
pub fn beam(order: usize, counts: [usize; 2], length: f64, height: f64) -> Body {
    let mut mesher = BlockMesher::new(order);
    let even = |n: usize| (0..=n).map(|k| k as f64 / n as f64).collect::<Vec<_>>();
    let at = |x: f64, y: f64| Point2::new(x * length, (y - 0.5) * height);
    let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| mesher.vertex(at(x, y)));
    let bottom = mesher.edge(a, b, &even(counts[0]), |t| at(t, 0.0));
    let top = mesher.edge(c, d, &even(counts[0]), |t| at(t, 1.0));
    let left = mesher.edge(a, c, &even(counts[1]), |t| at(0.0, t));
    let right = mesher.edge(b, d, &even(counts[1]), |t| at(1.0, t));
    mesher.block(&bottom, &top, &left, &right);
    let edges = vec![pieces(order, &left), pieces(order, &right), pieces(order, &top.reversed())];
    Body { mesh: mesher.finish(), edges, crack: [vec![], vec![]] }
}
