//! Solid elements as tables: corners, edges, faces, monomials and integration rules. One formula serves all of them.
//!
//! Shape functions are those combinations of the kind's monomials that are one at a node and zero at the others: their coefficients are the
//! inverse of the matrix of monomials at the nodes (Zienkiewicz, Taylor and Zhu, *The Finite Element Method*, 7th ed., section 6.2). Nodes
//! are numbered as in Abaqus and CalculiX: corners, then the middle of the edges.
//!
//! | kind | CalculiX | monomials | stiffness rule | mass rule |
//! |---|---|---|---|---|
//! | [`Kind::Tet4`] | C3D4 | degree 1 | 1 point | 27 |
//! | [`Kind::Tet10`] | C3D10 | degree 2 | 4 | 27 |
//! | [`Kind::Wedge6`] | C3D6 | triangle 1 x line 1 | 3 x 2 | 27 |
//! | [`Kind::Wedge15`] | C3D15 | serendipity | 3 x 3 | 27 |
//! | [`Kind::Hex8`] | C3D8I | trilinear, and three incompatible modes (Taylor, Beresford and Wilson 1976) | 2 x 2 x 2 | 27 |
//! | [`Kind::Hex20`] | C3D20 | serendipity | 3 x 3 x 3 | 27 |
//! | [`Kind::Hex20R`] | C3D20R | serendipity | 2 x 2 x 2: bends without locking in thin walls | 27 |

use faer::Mat;
use fecm::element::lagrange::gauss_rule;
use fecm::linalg::solve_general;

/// A kind of solid element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Tetrahedron of 4 nodes: constant strain, far too stiff in bending.
    Tet4,
    /// Tetrahedron of 10 nodes.
    Tet10,
    /// Wedge of 6 nodes: too stiff in bending.
    Wedge6,
    /// Wedge of 15 nodes.
    Wedge15,
    /// Hexahedron of 8 nodes with incompatible modes.
    Hex8,
    /// Hexahedron of 20 nodes.
    Hex20,
    /// Hexahedron of 20 nodes, stiffness by 8 points.
    Hex20R,
}

/// What kinds share: the solid that a reference element is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Solid {
    Tetrahedron,
    Wedge,
    Box,
}

/// A point of the reference element and its weight.
pub type RulePoint = ([f64; 3], f64);

const TETRAHEDRON_CORNERS: &[[f64; 3]] = &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TETRAHEDRON_EDGES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
const TETRAHEDRON_FACES: &[&[usize]] = &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];
const WEDGE_CORNERS: &[[f64; 3]] =
    &[[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
const WEDGE_EDGES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];
const WEDGE_FACES: &[&[usize]] = &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
const BOX_CORNERS: &[[f64; 3]] = &[
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
const BOX_EDGES: &[[usize; 2]] =
    &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
const BOX_FACES: &[&[usize]] =
    &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 7] =
        [Self::Tet4, Self::Tet10, Self::Wedge6, Self::Wedge15, Self::Hex8, Self::Hex20, Self::Hex20R];

    /// Name in CalculiX.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tet4 => "C3D4",
            Self::Tet10 => "C3D10",
            Self::Wedge6 => "C3D6",
            Self::Wedge15 => "C3D15",
            Self::Hex8 => "C3D8I",
            Self::Hex20 => "C3D20",
            Self::Hex20R => "C3D20R",
        }
    }

    fn solid(self) -> Solid {
        match self {
            Self::Tet4 | Self::Tet10 => Solid::Tetrahedron,
            Self::Wedge6 | Self::Wedge15 => Solid::Wedge,
            Self::Hex8 | Self::Hex20 | Self::Hex20R => Solid::Box,
        }
    }

    fn quadratic(self) -> bool {
        matches!(self, Self::Tet10 | Self::Wedge15 | Self::Hex20 | Self::Hex20R)
    }

    fn corners(self) -> &'static [[f64; 3]] {
        match self.solid() {
            Solid::Tetrahedron => TETRAHEDRON_CORNERS,
            Solid::Wedge => WEDGE_CORNERS,
            Solid::Box => BOX_CORNERS,
        }
    }

    pub(super) fn edges(self) -> &'static [[usize; 2]] {
        match self.solid() {
            Solid::Tetrahedron => TETRAHEDRON_EDGES,
            Solid::Wedge => WEDGE_EDGES,
            Solid::Box => BOX_EDGES,
        }
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(self) -> usize {
        self.corners().len() + if self.quadratic() { self.edges().len() } else { 0 }
    }

    /// Reference coordinates of the nodes.
    #[must_use]
    pub fn reference_nodes(self) -> Vec<[f64; 3]> {
        let corners = self.corners();
        let middle = |&[a, b]: &[usize; 2]| std::array::from_fn(|d| 0.5 * (corners[a][d] + corners[b][d]));
        let edges = if self.quadratic() { self.edges() } else { &[] };
        corners.iter().copied().chain(edges.iter().map(middle)).collect()
    }

    /// Faces as local nodes: corners counter-clockwise seen from outside, then the middle of the edges from each corner to the next.
    #[must_use]
    pub fn faces(self) -> Vec<Vec<usize>> {
        let faces = match self.solid() {
            Solid::Tetrahedron => TETRAHEDRON_FACES,
            Solid::Wedge => WEDGE_FACES,
            Solid::Box => BOX_FACES,
        };
        let middle = |a: usize, b: usize| {
            let edge = self.edges().iter().position(|edge| *edge == [a, b] || *edge == [b, a]);
            edge.map(|edge| self.corners().len() + edge)
        };
        let closed = |face: &&[usize]| {
            let mut nodes = face.to_vec();
            if self.quadratic() {
                nodes.extend((0..face.len()).filter_map(|k| middle(face[k], face[(k + 1) % face.len()])));
            }
            nodes
        };
        faces.iter().map(closed).collect()
    }

    /// Exponents of the monomials.
    fn exponents(self) -> Vec<[i32; 3]> {
        let top = if self.quadratic() { 2 } else { 1 };
        let all = (0..=top).flat_map(|i| (0..=top).flat_map(move |j| (0..=top).map(move |k| [i, j, k])));
        all.filter(|&[i, j, k]| match self.solid() {
            Solid::Tetrahedron => i + j + k <= top,
            Solid::Wedge => i + j + k.max(1) - 1 <= top,
            // at most one exponent above 1
            Solid::Box => [i, j, k].iter().filter(|&&e| e > 1).count() <= 1,
        })
        .collect()
    }

    /// Rule for the stiffness.
    #[must_use]
    pub fn stiffness_rule(self) -> Vec<RulePoint> {
        match self {
            Self::Tet4 => vec![([0.25; 3], 1.0 / 6.0)],
            Self::Tet10 => tetrahedron_of_four(),
            Self::Wedge6 => wedge_of_three(2),
            Self::Wedge15 => wedge_of_three(3),
            Self::Hex8 | Self::Hex20R => box_rule(2),
            Self::Hex20 => box_rule(3),
        }
    }

    /// Rule for mass and volume: exact for straight edges.
    #[must_use]
    pub fn mass_rule(self) -> Vec<RulePoint> {
        match self.solid() {
            Solid::Tetrahedron => collapse(4, 2),
            Solid::Wedge => collapse(4, 1),
            Solid::Box => box_rule(3),
        }
    }

    /// Gradients of the incompatible modes at a reference point.
    #[must_use]
    pub fn incompatible_gradients(self, at: [f64; 3]) -> Vec<[f64; 3]> {
        if self != Self::Hex8 {
            return Vec::new();
        }
        // of 1 - x^2 in each direction
        (0..3).map(|d| std::array::from_fn(|e| if e == d { -2.0 * at[d] } else { 0.0 })).collect()
    }
}

/// Gauss points of a box.
fn box_rule(n: usize) -> Vec<RulePoint> {
    let line = gauss_rule(n);
    let mut points = Vec::with_capacity(n * n * n);
    for &(x, a) in &line {
        for &(y, b) in &line {
            points.extend(line.iter().map(|&(z, c)| ([x, y, z], a * b * c)));
        }
    }
    points
}

/// Gauss points of a box brought to a wedge (`directions` 1) or a tetrahedron (2) by collapsing its sides; exact to degree `2 n - 3`.
fn collapse(n: usize, directions: usize) -> Vec<RulePoint> {
    let unit = |x: f64| 0.5 * (1.0 + x);
    let map = |([a, b, c], weight): RulePoint| {
        let (y, z) = (unit(b), unit(c));
        if directions == 1 {
            // z stays in [-1, 1]
            ([unit(a) * (1.0 - y), y, c], 0.25 * weight * (1.0 - y))
        } else {
            let rest = 1.0 - z;
            ([unit(a) * (1.0 - y) * rest, y * rest, z], 0.125 * weight * (1.0 - y) * rest * rest)
        }
    };
    box_rule(n).into_iter().map(map).collect()
}

/// Four points of a tetrahedron, exact to degree 2.
fn tetrahedron_of_four() -> Vec<RulePoint> {
    let near = (5.0 + 3.0 * 5.0_f64.sqrt()) / 20.0;
    let far = (5.0 - 5.0_f64.sqrt()) / 20.0;
    let point = |corner: usize| std::array::from_fn(|d| if d + 1 == corner { near } else { far });
    (0..4).map(|corner| (point(corner), 1.0 / 24.0)).collect()
}

/// Three points of the triangle, exact to degree 2, times Gauss points of the line.
fn wedge_of_three(n: usize) -> Vec<RulePoint> {
    let triangle = [[1.0 / 6.0, 1.0 / 6.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0]];
    let line = gauss_rule(n);
    line.iter().flat_map(|&(z, c)| triangle.map(|[x, y]| ([x, y, z], c / 6.0))).collect()
}

/// Shape functions of a set of nodes and monomials.
#[derive(Debug, Clone)]
pub struct Shape {
    exponents: Vec<[i32; 3]>,
    /// Monomials by nodes.
    coefficients: Mat<f64>,
}

impl Shape {
    /// Of a solid element.
    #[must_use]
    pub fn of(kind: Kind) -> Self {
        Self::new(kind.exponents(), &kind.reference_nodes())
    }

    /// Of a face of 3, 4, 6 or 8 nodes, in the first two coordinates; `None` of another number.
    #[must_use]
    pub fn of_face(nodes: usize) -> Option<Self> {
        let (kind, corners) = match nodes {
            3 => (Kind::Wedge6, 3),
            6 => (Kind::Wedge15, 3),
            4 => (Kind::Hex8, 4),
            8 => (Kind::Hex20, 4),
            _ => return None,
        };
        // the face at the bottom of the solid: its edges are the first ones of the table
        let all = kind.reference_nodes();
        let middle = kind.corners().len();
        let places: Vec<[f64; 3]> =
            (0..corners).chain((0..nodes - corners).map(|k| middle + k)).map(|k| [all[k][0], all[k][1], 0.0]).collect();
        Some(Self::new(kind.exponents().into_iter().filter(|e| e[2] == 0).collect(), &places))
    }

    fn new(exponents: Vec<[i32; 3]>, nodes: &[[f64; 3]]) -> Self {
        let n = nodes.len();
        let monomials = Mat::from_fn(n, n, |node, m| monomial(exponents[m], nodes[node]));
        Self { coefficients: solve_general(&monomials, &Mat::identity(n, n)), exponents }
    }

    /// Values at a point.
    #[must_use]
    pub fn values(&self, at: [f64; 3]) -> Vec<f64> {
        let monomials: Vec<f64> = self.exponents.iter().map(|&e| monomial(e, at)).collect();
        self.combine(&monomials)
    }

    /// Derivatives by the reference coordinates at a point.
    #[must_use]
    pub fn gradients(&self, at: [f64; 3]) -> Vec<[f64; 3]> {
        let along = |d: usize| {
            let slope = |e: &[i32; 3]| {
                let mut lower = *e;
                lower[d] -= 1;
                if e[d] == 0 { 0.0 } else { f64::from(e[d]) * monomial(lower, at) }
            };
            self.combine(&self.exponents.iter().map(slope).collect::<Vec<_>>())
        };
        let parts = [along(0), along(1), along(2)];
        (0..self.exponents.len()).map(|node| std::array::from_fn(|d| parts[d][node])).collect()
    }

    fn combine(&self, monomials: &[f64]) -> Vec<f64> {
        let column = |node| self.coefficients.col_as_slice(node);
        (0..self.exponents.len()).map(|node| column(node).iter().zip(monomials).map(|(c, m)| c * m).sum()).collect()
    }
}

fn monomial(exponents: [i32; 3], at: [f64; 3]) -> f64 {
    (0..3).map(|d| at[d].powi(exponents[d])).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invariant_shapes_are_one_at_their_node_and_reproduce_linear_fields() {
        for kind in Kind::ALL {
            let (shape, nodes) = (Shape::of(kind), kind.reference_nodes());
            assert_eq!(nodes.len(), kind.nodes());
            for (i, &node) in nodes.iter().enumerate() {
                for (j, value) in shape.values(node).into_iter().enumerate() {
                    assert!((value - f64::from(i == j)).abs() < 1e-12, "{kind:?}");
                }
            }
            for (at, _) in kind.stiffness_rule() {
                for d in 0..3 {
                    let value: f64 = shape.values(at).iter().zip(&nodes).map(|(n, x)| n * x[d]).sum();
                    assert!((value - at[d]).abs() < 1e-13);
                    for e in 0..3 {
                        let slope: f64 = shape.gradients(at).iter().zip(&nodes).map(|(g, x)| g[e] * x[d]).sum();
                        assert!((slope - f64::from(d == e)).abs() < 1e-12);
                    }
                }
            }
        }
    }

    /// Integrals over the unit tetrahedron: `i! j! k! / (i + j + k + 3)!`; over the wedge and the box by products.
    #[test]
    fn analytic_mass_rules_integrate_degree_four() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        let line = |k: i32| if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 };
        for kind in Kind::ALL {
            for [i, j, k] in (0..=4).flat_map(|i| (0..=4).flat_map(move |j| (0..=4).map(move |k| [i, j, k]))) {
                if i + j + k > 4 {
                    continue;
                }
                let sum: f64 = kind.mass_rule().iter().map(|&(at, w)| w * monomial([i, j, k], at)).sum();
                let exact = match kind.solid() {
                    Solid::Tetrahedron => factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3),
                    Solid::Wedge => factorial(i) * factorial(j) / factorial(i + j + 2) * line(k),
                    Solid::Box => line(i) * line(j) * line(k),
                };
                assert!((sum - exact).abs() < 1e-13, "{kind:?} {i}{j}{k}: {sum} against {exact}");
            }
        }
    }

    #[test]
    fn invariant_faces_close_the_solid() {
        // outward area vectors of a closed surface add up to nothing; an edge is shared by two faces
        for kind in Kind::ALL {
            let nodes = kind.reference_nodes();
            let mut sum = [0.0; 3];
            for face in kind.faces() {
                let shape = Shape::of_face(face.len()).expect("a face of 3, 4, 6 or 8 nodes");
                let (at, area) = if face.len() % 3 == 0 { ([1.0 / 3.0, 1.0 / 3.0, 0.0], 0.5) } else { ([0.0; 3], 4.0) };
                let gradients = shape.gradients(at);
                let tangent = |e: usize| -> [f64; 3] {
                    std::array::from_fn(|d| face.iter().zip(&gradients).map(|(&n, g)| g[e] * nodes[n][d]).sum())
                };
                let normal = nalgebra::Vector3::from(tangent(0)).cross(&nalgebra::Vector3::from(tangent(1)));
                let middle: nalgebra::Vector3<f64> =
                    nodes.iter().map(|&n| nalgebra::Vector3::from(n)).sum::<nalgebra::Vector3<f64>>()
                        / nodes.len() as f64;
                assert!(normal.dot(&(nalgebra::Vector3::from(nodes[face[0]]) - middle)) > 0.0, "{kind:?} {face:?}");
                for d in 0..3 {
                    sum[d] += area * normal[d];
                }
            }
            assert!(sum.iter().all(|s| s.abs() < 1e-12), "{kind:?} {sum:?}");
        }
    }
}
