//! Multi-block structured meshing: curves with breakpoints, blocks filled by transfinite interpolation.
//!
//! A block is a curved quadrilateral between four edges (Gordon and Hall, 1973). Nodes on a shared edge are created once, so
//! blocks are joined without searching; a crack along an edge is the same edge with its nodes created twice.
//! Interior positions blend the edges' own node positions, with blending parameters from their arc lengths, so that
//! grading on one edge carries across the block.

use nalgebra::Point2;

use super::plane::PlaneMesh;
use crate::element::lagrange::lobatto_points;

/// A mesh vertex (end of edges).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Vertex(u32);

/// An edge with its nodes, ends included.
#[derive(Debug, Clone)]
pub struct Edge {
    nodes: Vec<u32>,
}

impl Edge {
    /// Node numbers from the first to the last vertex.
    #[must_use]
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The edge walked the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { nodes: self.nodes.iter().rev().copied().collect() }
    }

    /// This edge followed by `next`, which starts where this one ends.
    #[must_use]
    pub fn joined(&self, next: &Self) -> Self {
        debug_assert_eq!(self.nodes.last(), next.nodes.first());
        Self { nodes: self.nodes.iter().chain(&next.nodes[1..]).copied().collect() }
    }
}

/// Element numbers of a block, `elements[row][column]`: column along its bottom edge, row away from it.
pub type BlockElements = Vec<Vec<u32>>;

/// Builds a [`PlaneMesh`] from edges and blocks.
#[derive(Debug)]
pub struct BlockMesher {
    mesh: PlaneMesh,
    /// Gauss-Lobatto points mapped to [0, 1].
    local: Vec<f64>,
}

impl BlockMesher {
    /// A mesher for elements of one order.
    #[must_use]
    pub fn new(order: usize) -> Self {
        let local = lobatto_points(order).iter().map(|x| 0.5 * (x + 1.0)).collect();
        Self { mesh: PlaneMesh { order, nodes: Vec::new(), connectivity: Vec::new() }, local }
    }

    fn add_node(&mut self, point: Point2<f64>) -> u32 {
        self.mesh.nodes.push(point);
        (self.mesh.nodes.len() - 1) as u32
    }

    /// Adds a vertex.
    pub fn vertex(&mut self, point: Point2<f64>) -> Vertex {
        Vertex(self.add_node(point))
    }

    /// Adds an edge along `curve`, whose elements end at the parameters `breaks` (first and last at the vertices).
    pub fn edge(&mut self, from: Vertex, to: Vertex, breaks: &[f64], curve: impl Fn(f64) -> Point2<f64>) -> Edge {
        let mut nodes = vec![from.0];
        for (index, pair) in breaks.windows(2).enumerate() {
            for k in 1..self.local.len() {
                if index + 2 == breaks.len() && k + 1 == self.local.len() {
                    nodes.push(to.0);
                } else {
                    let node = self.add_node(curve(pair[0] + self.local[k] * (pair[1] - pair[0])));
                    nodes.push(node);
                }
            }
        }
        Edge { nodes }
    }

    /// Fills the block between `bottom` and `top` (both walked in the direction of columns) and `left` and `right` (both walked
    /// from bottom to top). The walk bottom, right, top reversed, left reversed must be counter-clockwise.
    pub fn block(&mut self, bottom: &Edge, top: &Edge, left: &Edge, right: &Edge) -> BlockElements {
        let (columns, rows) = (bottom.nodes.len(), left.nodes.len());
        debug_assert_eq!(columns, top.nodes.len());
        debug_assert_eq!(rows, right.nodes.len());
        let blend = [bottom, top, left, right].map(|edge| self.arc_fractions(edge));
        let mut grid = vec![vec![0_u32; columns]; rows];
        for row in 0..rows {
            for column in 0..columns {
                grid[row][column] = if row == 0 {
                    bottom.nodes[column]
                } else if row == rows - 1 {
                    top.nodes[column]
                } else if column == 0 {
                    left.nodes[row]
                } else if column == columns - 1 {
                    right.nodes[row]
                } else {
                    let point = self.transfinite([bottom, top, left, right], &blend, row, column);
                    self.add_node(point)
                };
            }
        }
        let p = self.mesh.order;
        let mut elements = Vec::new();
        let mut next = self.mesh.element_count() as u32;
        for row in 0..(rows - 1) / p {
            let mut line = Vec::new();
            for column in 0..(columns - 1) / p {
                for j in 0..=p {
                    for i in 0..=p {
                        self.mesh.connectivity.push(grid[row * p + j][column * p + i]);
                    }
                }
                line.push(next);
                next += 1;
            }
            elements.push(line);
        }
        elements
    }

    fn transfinite(&self, edges: [&Edge; 4], blend: &[Vec<f64>; 4], row: usize, column: usize) -> Point2<f64> {
        let [bottom, top, left, right] = edges;
        let at = |edge: &Edge, k: usize| self.mesh.nodes[edge.nodes[k] as usize].coords;
        let last = bottom.nodes.len() - 1;
        // intersection of the straight lines that join matching parameters of opposite edges
        let (s0, s1) = (blend[0][column], blend[1][column]);
        let (t0, t1) = (blend[2][row], blend[3][row]);
        let u = (s0 + t0 * (s1 - s0)) / (1.0 - (s1 - s0) * (t1 - t0));
        let v = t0 + u * (t1 - t0);
        let edge_part =
            at(bottom, column) * (1.0 - v) + at(top, column) * v + at(left, row) * (1.0 - u) + at(right, row) * u;
        let corner_part = at(bottom, 0) * ((1.0 - u) * (1.0 - v))
            + at(bottom, last) * (u * (1.0 - v))
            + at(top, 0) * ((1.0 - u) * v)
            + at(top, last) * (u * v);
        Point2::from(edge_part - corner_part)
    }

    /// Chord-length fractions of an edge's nodes.
    fn arc_fractions(&self, edge: &Edge) -> Vec<f64> {
        let at = |node: u32| self.mesh.nodes[node as usize];
        let mut sums = vec![0.0];
        for pair in edge.nodes.windows(2) {
            let length = (at(pair[1]) - at(pair[0])).norm();
            sums.push(sums[sums.len() - 1] + length);
        }
        let total = sums[sums.len() - 1];
        sums.iter().map(|sum| sum / total).collect()
    }

    /// The finished mesh.
    #[must_use]
    pub fn finish(self) -> PlaneMesh {
        self.mesh
    }
}

/// `count + 1` breakpoints of [0, 1], each interval `ratio` times the one before.
#[must_use]
pub fn geometric_breaks(count: usize, ratio: f64) -> Vec<f64> {
    let mut breaks = vec![0.0];
    let mut step = 1.0;
    for k in 0..count {
        breaks.push(breaks[k] + step);
        step *= ratio;
    }
    let total = breaks[count];
    breaks.iter().map(|b| b / total).collect()
}
