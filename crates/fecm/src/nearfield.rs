//! The local part of contact: what a half-space adds to finite elements at the surface.
//!
//! Near a concentrated load a tooth deforms as a half-space does; the difference between the two is smooth. So of the compliance between two
//! places of a flank,
//!
//! `G = G_half-space + R`, `R = G - G_half-space`,
//!
//! `G_half-space` is taken in full resolution between the cells of the contact, and only `R` from the finite elements, on polynomials `phi_m` along
//! the profile ([`ProfileBasis`]) and `psi_k` along the face ([`FaceBasis`]):
//!
//! `R = sum phi_m psi_k [ K_FE^-1 - P G_half-space P ]_(mk, nl) phi_n psi_l`,
//!
//! with `P` the projection on these polynomials. Both terms in the bracket are read at the surface under the same smooth loads, which the finite elements
//! resolve. There is no depth at which one field takes over from another (S. Vijayakar, *Int. J. Numer. Methods Eng.* 31, 1991, 525-545, matches
//! at a depth; between surface and depth a half-space then stands for a curved and finite tooth, which makes teeth too stiff by an amount
//! proportional to the depth). The bracket is symmetric, so reciprocity is exact. Its error falls with the degree of the polynomials
//! (`tests/invariant_statics.rs`); the finite-element part converges like an energy.
//!
//! A solid near a free end of the face is softer than a half-space. Mirror loads beyond the ends (which free the end planes of shear)
//! are part of `G_half-space` in both places; they can be switched off.
//!
//! Tables hold values per index difference on a uniform grid and are made once per cell size.

use std::sync::OnceLock;

use faer::Mat;

use crate::element::lagrange::gauss_rule;
use crate::face::{FaceBasis, FaceModel};
use crate::halfspace::{rectangle_displacement, strip_displacement};
use crate::linalg::product;
use crate::material::Material;
use crate::profile_basis::ProfileBasis;

/// Cells across the face that carry the contact.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceCells {
    /// Centres (m), ascending.
    pub centres: Vec<f64>,
    /// Width of each cell (m).
    pub width: f64,
    /// Whether each cell stands for itself and its mirror image about mid-face.
    pub mirrored: bool,
}

impl FaceCells {
    /// `count` equal cells over a face of `width` (m); mirrored cells cover the half at `z > 0`.
    #[must_use]
    pub fn new(width: f64, count: usize, mirrored: bool) -> Self {
        let (span, start) = if mirrored { (0.5 * width, 0.0) } else { (width, -0.5 * width) };
        let cell = span / count as f64;
        let centres = (0..count).map(|j| start + (j as f64 + 0.5) * cell).collect();
        Self { centres, width: cell, mirrored }
    }
}

/// One body of the near field.
#[derive(Debug, Clone, Copy)]
pub struct NearBody {
    /// Material.
    pub material: Material,
    /// Facewidth of the body (m).
    pub width: f64,
}

/// What the influence of one cell size on one body pair rests on.
#[derive(Debug, Clone)]
pub struct NearFieldSpec {
    /// Behaviour along the face.
    pub model: FaceModel,
    /// Pinion and wheel.
    pub bodies: [NearBody; 2],
    /// Cell size along the profile (m).
    pub cell: f64,
    /// Cells along the face.
    pub face: FaceCells,
    /// Whether mirror loads correct the free ends of the face.
    pub edge_correction: bool,
}

/// Near-field influence of one cell size on one body pair, by difference of rows. Rows are computed when first asked for.
#[derive(Debug)]
pub struct NearField {
    spec: NearFieldSpec,
    /// Cells x cells, displacement per unit cell force, both bodies (m/N).
    rows: Vec<OnceLock<Mat<f64>>>,
}

impl NearField {
    /// Largest difference of rows.
    pub const MOST_ROWS: usize = 4096;

    /// Prepares the influence of a cell size.
    #[must_use]
    pub fn new(spec: NearFieldSpec) -> Self {
        Self { spec, rows: std::iter::repeat_with(OnceLock::new).take(Self::MOST_ROWS).collect() }
    }

    /// Surface influence between cells of rows this far apart; `row_difference` below [`Self::MOST_ROWS`].
    #[must_use]
    pub fn surface(&self, row_difference: usize) -> &Mat<f64> {
        self.rows[row_difference].get_or_init(|| {
            let x = row_difference as f64 * self.spec.cell;
            if matches!(self.spec.model, FaceModel::Solid { .. }) { self.spec.solid(x) } else { self.spec.plane(x) }
        })
    }
}

impl NearFieldSpec {
    fn plane(&self, x: f64) -> Mat<f64> {
        let of = |body: &NearBody| {
            strip_displacement(&body.material, self.model == FaceModel::PlaneStrain, 0.5 * self.cell, x, 0.0)
                / body.width
        };
        let sum = self.bodies.iter().map(of).sum();
        Mat::from_fn(1, 1, |_, _| sum)
    }

    fn solid(&self, x: f64) -> Mat<f64> {
        let face = &self.face;
        let count = face.centres.len();
        let first = face.centres.first().copied().unwrap_or(0.0);
        let at = |body: &NearBody, z: f64| {
            rectangle_displacement(&body.material, 0.5 * self.cell, 0.5 * face.width, x, z, 0.0)
        };
        // on the uniform grid all distances follow from the difference and from the sum of two cell numbers
        let mut difference = vec![0.0; count];
        let mut sum = vec![0.0; 2 * count];
        for body in &self.bodies {
            for (k, value) in difference.iter_mut().enumerate() {
                let apart = k as f64 * face.width;
                *value += at(body, apart);
                if self.edge_correction && face.mirrored {
                    *value += at(body, body.width + apart) + at(body, body.width - apart);
                }
            }
            for (k, value) in sum.iter_mut().enumerate() {
                let places = 2.0 * first + k as f64 * face.width;
                if face.mirrored {
                    *value += at(body, places);
                }
                if self.edge_correction {
                    *value += at(body, body.width - places) + at(body, body.width + places);
                }
            }
        }
        // a mirrored cell carries half of its force on either side
        let share = if face.mirrored { 0.5 } else { 1.0 };
        Mat::from_fn(count, count, |i, j| share * (difference[i.abs_diff(j)] + sum[i + j]))
    }
}

/// Cells along the profile in [`projected_half_space`]: of a solid, whose influence costs more, and of a plane model.
const PROFILE_POINTS: [usize; 2] = [192, 320];
/// Cells along the face.
const FACE_POINTS: usize = 48;

/// `P G_half-space P` on one flank: work (m/N) of unit loads in the functions `(m, k)` (row `m * functions + k`, `k` along the face) on the displacements by
/// unit loads in `(n, l)`, in the finite elements' convention for functions along the face.
///
/// The half-space is taken between uniform cells with its exact influence, loads and work by the
/// functions' means over cells: errors fall with the square of the cell.
#[must_use]
pub fn projected_half_space(
    model: FaceModel,
    body: &NearBody,
    profile: &ProfileBasis,
    face: &FaceBasis,
    edge_correction: bool,
) -> Mat<f64> {
    let functions = face.plane_degrees().len();
    let n = PROFILE_POINTS[usize::from(!matches!(model, FaceModel::Solid { .. }))];
    let dx = profile.length() / n as f64;
    let mut at_cells = Mat::zeros(profile.count(), n);
    for i in 0..n {
        for (x, weight) in gauss_rule(4) {
            let values = profile.values(profile.start() + (i as f64 + 0.5 * (1.0 + x)) * dx);
            for (m, value) in values.into_iter().enumerate() {
                at_cells[(m, i)] += 0.5 * weight * value * dx;
            }
        }
    }
    let along_face = FaceProjection::new(model, body, face, edge_correction);
    let mut result = Mat::zeros(profile.count() * functions, profile.count() * functions);
    for d in 0..n {
        let influence = along_face.at(d as f64 * dx, dx);
        // sum over all cells `d` apart, one way and the other
        let (low, high) = (at_cells.as_ref().subcols(0, n - d), at_cells.as_ref().subcols(d, n - d));
        let one_way = product(low, high.transpose());
        for p in 0..profile.count() {
            for q in 0..profile.count() {
                let weight = if d == 0 { one_way[(p, q)] } else { one_way[(p, q)] + one_way[(q, p)] };
                for k in 0..functions {
                    for l in 0..functions {
                        result[(p * functions + k, q * functions + l)] += weight * influence[(k, l)];
                    }
                }
            }
        }
    }
    result
}

/// The half-space's influence on the functions along the face.
struct FaceProjection<'a> {
    model: FaceModel,
    body: &'a NearBody,
    edge_correction: bool,
    /// Functions at the centres of cells, over their norms (points x functions).
    dual: Mat<f64>,
}

impl<'a> FaceProjection<'a> {
    fn new(model: FaceModel, body: &'a NearBody, face: &FaceBasis, edge_correction: bool) -> Self {
        let norms = face.plane_norms();
        let dz = body.width / FACE_POINTS as f64;
        let dual = Mat::from_fn(FACE_POINTS, norms.len(), |q, k| {
            let z = -0.5 * body.width + (q as f64 + 0.5) * dz;
            face.value(face.plane_degrees()[k], z) * dz / norms[k]
        });
        Self { model, body, edge_correction, dual }
    }

    /// Between lines of the profile `x` apart, loads spread over `dx`.
    fn at(&self, x: f64, dx: f64) -> Mat<f64> {
        let material = &self.body.material;
        if !matches!(self.model, FaceModel::Solid { .. }) {
            let value = strip_displacement(material, self.model == FaceModel::PlaneStrain, 0.5 * dx, x, 0.0);
            return Mat::from_fn(1, 1, |_, _| value / self.body.width);
        }
        let count = FACE_POINTS;
        let dz = self.body.width / count as f64;
        let reach = if self.edge_correction { 2 * count } else { count };
        let kernel: Vec<f64> =
            (0..reach).map(|k| rectangle_displacement(material, 0.5 * dx, 0.5 * dz, x, k as f64 * dz, 0.0)).collect();
        let influence = Mat::from_fn(count, count, |i, j| {
            let mut value = kernel[i.abs_diff(j)];
            if self.edge_correction {
                value += kernel[i + j + 1] + kernel[2 * count - 1 - i - j];
            }
            value
        });
        let spread = product(influence.as_ref(), self.dual.as_ref());
        product(self.dual.transpose(), spread.as_ref())
    }
}
