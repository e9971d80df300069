//! Stress-intensity factors at the tip of a crack between two faces of a mesh, by the interaction integral.
//!
//! Near the tip the displacement is `K_I u^I + K_II u^II` with Williams' fields `u^a` of unit intensity. With `,1` along the crack and
//!
//! `P_j = sigma_ij u^a_i,1 + sigma^a_ij u_i,1 - sigma^a_mn u_m,n delta_1j`,
//!
//! the flux of `-P` into the tip is `2 K_a / E'` (J. F. Yau, S. S. Wang and H. T. Corten, *J. Appl. Mech.* 47, 1980, 335-341). A smooth weight `q`, 1 at
//! the tip and 0 beyond a radius, makes it an integral over the plane (B. Moran and C. F. Shih, *Eng. Fract. Mech.* 27, 1987, 615-642):
//!
//! `2 K_a / E' = int P_j q,j + q P_j,j dA - int_faces P_j n_j q ds`.
//!
//! The terms with `q` vanish for a straight crack in a plane. At face position `z` of a solid, `P_j,j = -sigma_i3,3 u^a_i,1 + lambda u_3,3 tr(e^a),1`
//! with the plane-strain fields; along a curved crack the faces are not free of the fields' tractions. `E' = E / (1 - nu^2)`, in
//! plane stress `E`.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `x_1` | from the tip onward along the crack's tangent | m |
//! | `x_2` | a quarter turn counter-clockwise from it | m |
//! | `K_I` | opening, positive when the faces part | Pa sqrt(m) |
//! | `K_II` | sliding, positive when the face at `x_2 > 0` moves along `x_1` against the other | Pa sqrt(m) |
//!
//! Faces that press on each other add `-int t_i u^a_i,1 q ds` ([`CrackTipZone::of_face_force`]), without which a closed crack would seem to have a `K_I`.
//!
//! Everything is linear in the displacement, so factors are [`PlaneFunctional`]s. Verified on edge-cracked plates in tension and shear
//! (`tests/stress.rs`).

use std::collections::HashSet;
use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix2, Matrix3, Point2, Vector2};

use crate::element::ReferenceQuad;
use crate::element::lagrange::gauss_rule;
use crate::face::FaceBasis;
use crate::functional::{PlaneFunctional, PointShapes};
use crate::mesh::PlaneMesh;

/// The neighbourhood of a crack tip in a mesh, out to where the weight ends.
#[derive(Debug, Clone)]
pub struct CrackTipZone {
    tip: Point2<f64>,
    /// Columns: along the crack and across.
    axes: Matrix2<f64>,
    radius: f64,
    /// Side of the crack on which each face's material lies: +1 at `x_2 > 0`.
    sides: [f64; 2],
    plane: Vec<Sample>,
    faces: Vec<Sample>,
}

/// A quadrature point.
#[derive(Debug, Clone)]
struct Sample {
    nodes: Vec<u32>,
    values: Vec<f64>,
    gradients: Vec<Vector2<f64>>,
    /// Polar coordinates about the tip; the angle is that of the crack's own side.
    polar: [f64; 2],
    /// Area, or length of face (m^2, m).
    weight: f64,
    /// Outward normal, on faces.
    normal: Vector2<f64>,
}

/// Part of the way from the tip to the nearest boundary that the weight reaches.
pub const ZONE: f64 = 0.8;

impl CrackTipZone {
    /// Zone around the tip of a crack with these faces, each from the mouth to the common tip, that reaches `reach` (0 to 1) of the way to
    /// the nearest other boundary of the mesh. `None` if the faces are no crack of this mesh.
    #[must_use]
    pub fn new(mesh: &PlaneMesh, faces: [&[u32]; 2], reach: f64) -> Option<Self> {
        let p = mesh.order;
        let place = |node: u32| mesh.nodes[node as usize];
        let tip_node = *faces[0].last()?;
        if faces[1].last() != Some(&tip_node) || faces[0].len() <= p {
            return None;
        }
        let tip = place(tip_node);
        let quad = ReferenceQuad::new(p);
        let mut slopes = vec![0.0; p + 1];
        quad.basis().derivatives_into(1.0, &mut slopes);
        let last = &faces[0][faces[0].len() - p - 1..];
        let onward: Vector2<f64> = last.iter().zip(&slopes).map(|(&node, slope)| place(node).coords * *slope).sum();
        let onward = onward.try_normalize(0.0)?;
        let axes = Matrix2::from_columns(&[onward, Vector2::new(-onward.y, onward.x)]);
        let sides = faces.map(|face| face.iter().copied().filter(|&node| node != tip_node).collect::<HashSet<u32>>());
        let on_face = |edge: &[u32], side: usize| edge.iter().all(|n| *n == tip_node || sides[side].contains(n));
        let boundary = mesh.boundary_edges();
        let others = boundary.iter().filter(|(_, edge)| !on_face(edge, 0) && !on_face(edge, 1));
        let nearest = others.flat_map(|(_, edge)| edge).map(|&n| (place(n) - tip).norm()).fold(f64::INFINITY, f64::min);
        let radius = reach * nearest;
        if !(radius > 0.0 && radius.is_finite()) {
            return None;
        }
        let mut zone = Self { tip, axes, radius, sides: [1.0, -1.0], plane: Vec::new(), faces: Vec::new() };
        let points = quadrature(p);
        for element in 0..mesh.element_count() {
            let nodes = mesh.element(element);
            let extent = nodes.iter().map(|&n| (place(n) - tip).norm()).fold(f64::INFINITY, f64::min);
            let size = (place(nodes[nodes.len() - 1]) - place(nodes[0])).norm();
            if extent > radius + size {
                continue;
            }
            // elements along a face know their side of it
            let side = (0..2).find(|&k| nodes.iter().any(|n| sides[k].contains(n)));
            let turn = side.map(|_| zone.side_of(mesh, element));
            let corner = mesh.corners(element).iter().position(|&n| n == tip_node);
            if let (Some(side), Some(turn), Some(_)) = (side, turn, corner) {
                zone.sides[side] = turn;
            }
            let rule = corner.map_or_else(|| points.clone(), |corner| tip_quadrature(p, corner));
            for (local, weight) in rule {
                zone.add_plane(mesh, &quad, element, local, weight, turn);
            }
            for edge in mesh.element_edges(element).iter().filter(|e| on_face(e, 0) || on_face(e, 1)) {
                zone.add_face(mesh, &quad, element, edge, turn);
            }
        }
        Some(zone)
    }

    /// Reach of the weight (m).
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// `K_I` and `K_II` along the face as functionals of the displacement in one symmetry family.
    #[must_use]
    pub fn intensities(&self, basis: &FaceBasis) -> [PlaneFunctional; 2] {
        [Mode::Opening, Mode::Sliding].map(|mode| {
            let mut factor = PlaneFunctional::default();
            let fields = UnitField::new(basis, mode);
            for sample in &self.plane {
                let (weights, axial) = self.area_terms(&fields, sample);
                factor.add(sample.shapes(), &weights, &axial);
            }
            for sample in &self.faces {
                factor.add(sample.shapes(), &self.face_terms(&fields, sample), &Matrix3::zeros());
            }
            factor
        })
    }

    /// What a force per width (N/m) on the material at a place of a face (the first or the second) adds to `K_I` and `K_II` beside what the
    /// displacement says: the faces' part of the integral, `-E' / 2 F . u^a,1 q`. Without it only faces free of load are read rightly.
    #[must_use]
    pub fn of_face_force(&self, basis: &FaceBasis, face: usize, place: Point2<f64>, force: Vector2<f64>) -> [f64; 2] {
        let polar = self.polar(place, Some(self.sides[face]));
        if !(polar[0] > 0.0 && polar[0] < self.radius) {
            return [0.0; 2];
        }
        let (q, _) = self.cover(polar);
        [Mode::Opening, Mode::Sliding].map(|mode| {
            let field = UnitField::new(basis, mode);
            let along = self.axes * field.at(polar).gradient.column(0);
            -field.scale * q * along.dot(&force)
        })
    }

    /// +1 if the element lies at `x_2 > 0` of the crack, which may be curved, -1 otherwise.
    fn side_of(&self, mesh: &PlaneMesh, element: usize) -> f64 {
        let points = mesh.element_points(element);
        let centre = points.iter().fold(Vector2::zeros(), |sum, p| sum + p.coords) / points.len() as f64;
        (self.axes.transpose() * (centre - self.tip.coords)).y.signum()
    }

    /// Polar coordinates about the tip; `side` tells the faces apart.
    fn polar(&self, place: Point2<f64>, side: Option<f64>) -> [f64; 2] {
        let local = self.axes.transpose() * (place - self.tip);
        let angle = local.y.atan2(local.x);
        let angle = match side {
            Some(side) if angle * side < -FRAC_PI_2 => angle + 2.0 * PI * side,
            _ => angle,
        };
        [local.norm(), angle]
    }

    fn sample(
        &self,
        mesh: &PlaneMesh,
        quad: &ReferenceQuad,
        element: usize,
        local: [f64; 2],
        side: Option<f64>,
    ) -> (Sample, Matrix2<f64>) {
        let nodes = mesh.element(element).to_vec();
        let points = mesh.element_points(element);
        let (values, slopes) = quad.shapes(local[0], local[1]);
        let mut jacobian = Matrix2::zeros();
        let mut place = Vector2::zeros();
        for ((point, value), slope) in points.iter().zip(&values).zip(&slopes) {
            jacobian += point.coords * slope.transpose();
            place += point.coords * *value;
        }
        let inverse = jacobian.try_inverse().unwrap_or_else(Matrix2::zeros).transpose();
        let gradients = slopes.iter().map(|slope| inverse * slope).collect();
        let polar = self.polar(Point2::from(place), side);
        (Sample { nodes, values, gradients, polar, weight: 0.0, normal: Vector2::zeros() }, jacobian)
    }

    fn add_plane(
        &mut self,
        mesh: &PlaneMesh,
        quad: &ReferenceQuad,
        element: usize,
        local: [f64; 2],
        weight: f64,
        side: Option<f64>,
    ) {
        let (sample, jacobian) = self.sample(mesh, quad, element, local, side);
        if sample.polar[0] < self.radius {
            self.plane.push(Sample { weight: weight * jacobian.determinant(), ..sample });
        }
    }

    fn add_face(&mut self, mesh: &PlaneMesh, quad: &ReferenceQuad, element: usize, edge: &[u32], side: Option<f64>) {
        let edges = mesh.element_edges(element);
        let Some(which) = edges.iter().position(|e| e == edge) else { return };
        // squared from the tip, where the integrand is singular; from either end where there is none
        for (x, weight) in gauss_rule(2 * mesh.order + 6) {
            let along = if mesh.nodes[edge[0] as usize] == self.tip {
                0.5 * (1.0 + x).powi(2) - 1.0
            } else {
                1.0 - 0.5 * (1.0 - x).powi(2)
            };
            let stretch = if mesh.nodes[edge[0] as usize] == self.tip { 1.0 + x } else { 1.0 - x };
            let (local, direction) = match which {
                0 => ([along, -1.0], Vector2::new(1.0, 0.0)),
                1 => ([1.0, along], Vector2::new(0.0, 1.0)),
                2 => ([-along, 1.0], Vector2::new(-1.0, 0.0)),
                _ => ([-1.0, -along], Vector2::new(0.0, -1.0)),
            };
            let (sample, jacobian) = self.sample(mesh, quad, element, local, side);
            if sample.polar[0] < self.radius {
                let tangent = jacobian * direction;
                let normal = Vector2::new(tangent.y, -tangent.x).normalize();
                self.faces.push(Sample { weight: weight * stretch * tangent.norm(), normal, ..sample });
            }
        }
    }

    /// `q` and its gradient in local axes.
    fn cover(&self, [r, angle]: [f64; 2]) -> (f64, Vector2<f64>) {
        let ratio = r / self.radius;
        let rest = (1.0 - ratio * ratio).max(0.0);
        let slope = -6.0 * ratio * rest * rest / self.radius;
        (rest.powi(3), Vector2::new(angle.cos(), angle.sin()) * slope)
    }

    /// Weights of the displacement gradient and of its derivative along the face.
    fn area_terms(&self, field: &UnitField, sample: &Sample) -> (Matrix3<f64>, Matrix3<f64>) {
        let (q, dq) = self.cover(sample.polar);
        let aux = field.at(sample.polar);
        let along = aux.gradient.column(0).into_owned();
        let flux = along * dq.transpose();
        let (lambda, mu) = (field.lambda, field.shear);
        let mut weights = (flux + flux.transpose()) * mu;
        weights += Matrix2::identity() * (lambda * flux.trace()) - aux.stress * dq.x;
        let pulled = aux.stress * dq;
        weights[(0, 0)] += pulled.x;
        weights[(1, 0)] += pulled.y;
        let mut all = self.to_global(&weights);
        all[(2, 2)] = lambda * (flux.trace() + q * aux.dilatation_slope);
        let pull = self.axes * along * (-q * mu);
        let mut axial = Matrix3::zeros();
        for c in 0..2 {
            axial[(c, 2)] = pull[c];
            axial[(2, c)] = pull[c];
        }
        let scale = sample.weight * field.scale;
        (all * scale, axial * scale)
    }

    /// Weights of the displacement gradient on a face of the crack.
    fn face_terms(&self, field: &UnitField, sample: &Sample) -> Matrix3<f64> {
        let (q, _) = self.cover(sample.polar);
        let aux = field.at(sample.polar);
        let normal = self.axes.transpose() * sample.normal;
        let traction = aux.stress * normal;
        let mut weights = aux.stress * normal.x;
        weights[(0, 0)] -= traction.x;
        weights[(1, 0)] -= traction.y;
        self.to_global(&weights) * (q * sample.weight * field.scale)
    }

    fn to_global(&self, local: &Matrix2<f64>) -> Matrix3<f64> {
        let turned = self.axes * local * self.axes.transpose();
        let mut all = Matrix3::zeros();
        all.fixed_view_mut::<2, 2>(0, 0).copy_from(&turned);
        all
    }
}

impl Sample {
    fn shapes(&self) -> PointShapes<'_> {
        PointShapes { nodes: &self.nodes, values: &self.values, gradients: &self.gradients }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Opening,
    Sliding,
}

/// Williams' field of unit intensity.
struct UnitField {
    mode: Mode,
    lambda: f64,
    shear: f64,
    kappa: f64,
    /// `E' / 2`.
    scale: f64,
}

/// A unit field at a point, in local axes.
struct UnitValues {
    /// `du_i / dx_j` (1/sqrt(m) per Pa sqrt(m)).
    gradient: Matrix2<f64>,
    stress: Matrix2<f64>,
    /// `d/dx_1` of the trace of the strain.
    dilatation_slope: f64,
}

impl UnitField {
    fn new(basis: &FaceBasis, mode: Mode) -> Self {
        let (lambda, shear) = (basis.lambda(), basis.shear());
        // 3 - 4 nu, with the reduced constant of plane stress (3 - nu) / (1 + nu)
        let kappa = (lambda + 3.0 * shear) / (lambda + shear);
        Self { mode, lambda, shear, kappa, scale: 4.0 * shear / (1.0 + kappa) }
    }

    fn at(&self, [r, angle]: [f64; 2]) -> UnitValues {
        let (sine, cosine) = angle.sin_cos();
        let (s, c) = (0.5 * angle).sin_cos();
        let kappa = self.kappa;
        // u = sqrt(r) f(angle) / (2 mu sqrt(2 pi)), and df
        let (f, df) = match self.mode {
            Mode::Opening => (
                Vector2::new(c, s) * (kappa - cosine),
                Vector2::new(-s, c) * (0.5 * (kappa - cosine)) + Vector2::new(c, s) * sine,
            ),
            Mode::Sliding => (
                Vector2::new(s * (kappa + 2.0 + cosine), -c * (kappa - 2.0 + cosine)),
                Vector2::new(0.5 * c * (kappa + 2.0 + cosine) - s * sine, 0.5 * s * (kappa - 2.0 + cosine) + c * sine),
            ),
        };
        let unit = 1.0 / (2.0 * PI * r).sqrt();
        let size = unit / (2.0 * self.shear);
        let gradient =
            Matrix2::from_columns(&[(f * (0.5 * cosine) - df * sine) * size, (f * (0.5 * sine) + df * cosine) * size]);
        let stress =
            (gradient + gradient.transpose()) * self.shear + Matrix2::identity() * (self.lambda * gradient.trace());
        let turn = match self.mode {
            Mode::Opening => -(1.5 * angle).cos(),
            Mode::Sliding => (1.5 * angle).sin(),
        };
        let dilatation_slope = 0.5 * turn * unit / (r * (self.lambda + self.shear));
        UnitValues { gradient, stress, dilatation_slope }
    }
}

/// Points and weights of an element away from the tip.
fn quadrature(order: usize) -> Vec<([f64; 2], f64)> {
    let rule = gauss_rule(2 * order + 6);
    rule.iter().flat_map(|&(y, v)| rule.iter().map(move |&(x, w)| ([x, y], v * w))).collect()
}

/// Points and weights of an element with the tip in a corner: two triangles with their apex there, squared in the distance from it, so that
/// `r^(-3/2)` is integrated as a smooth function (M. G. Duffy, *SIAM J. Numer. Anal.* 19, 1982, 1260-1262).
fn tip_quadrature(order: usize, corner: usize) -> Vec<([f64; 2], f64)> {
    let rule = gauss_rule(2 * order + 6);
    let apex = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][corner];
    let mut points = Vec::new();
    for (first, second) in [(0, 1), (1, 0)] {
        for &(x, w) in &rule {
            let t = 0.5 * (1.0 + x);
            for &(y, v) in &rule {
                let across = 0.5 * (1.0 + y);
                // twice the unit square: distances from the apex in local coordinates
                let far = 2.0 * t * t;
                let mut local = apex;
                local[first] -= apex[first] * far;
                local[second] -= apex[second] * far * across;
                points.push((local, 0.25 * w * v * (4.0 * t) * (2.0 * t * t)));
            }
        }
    }
    points
}
