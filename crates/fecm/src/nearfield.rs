//! The local part of contact: half-space displacement at the surface less that at matching depth.
//!
//! Vijayakar's split (S. Vijayakar, *Int. J. Numer. Methods Eng.* 31, 1991, 525-545; dissertation section 3.2.1):
//! `u(surface) = [u_half-space(surface) - u_half-space(depth h)] + u_FE(depth h)`. The finite elements carry only as many functions along the
//! face as their basis has, so the subtracted term is first projected on that basis: what the finite elements do not resolve is left to
//! the half-space at the surface. With growing order the projection becomes the identity and the split the usual one; for any
//! order the sum does not depend on `h` as long as `h` is between the element size and the tooth thickness.
//!
//! A solid near a free end of the face is softer than a half-space. Mirror loads beyond the end (which free the end plane of shear)
//! correct the local difference; they can be switched off.
//!
//! Tables hold values per index difference on a uniform grid and are made once per cell size.

use std::sync::OnceLock;

use faer::Mat;

use crate::face::{FaceBasis, FaceModel};
use crate::halfspace::{rectangle_displacement, strip_displacement};
use crate::linalg::column_slice;
use crate::material::Material;

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
#[derive(Debug, Clone)]
pub struct NearBody {
    /// Material.
    pub material: Material,
    /// Face bases of the body's families.
    pub bases: Vec<FaceBasis>,
    /// Matching depth (m).
    pub depth: f64,
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
    rows: Vec<OnceLock<RowInfluence>>,
}

/// Influence between two rows.
#[derive(Debug)]
struct RowInfluence {
    /// Cells x cells, displacement per unit cell force, both bodies, free edges included (m/N).
    surface: Mat<f64>,
    /// `[body][family]`: functions x functions, to be subtracted from the finite-element compliance.
    depth: [Vec<Mat<f64>>; 2],
}

/// Mirror loads reach this many matching depths.
const EDGE_REACH: f64 = 8.0;

impl NearField {
    /// Largest difference of rows.
    pub const MOST_ROWS: usize = 4096;

    /// Prepares the influence of a cell size.
    #[must_use]
    pub fn new(spec: NearFieldSpec) -> Self {
        Self { spec, rows: std::iter::repeat_with(OnceLock::new).take(Self::MOST_ROWS).collect() }
    }

    fn row(&self, difference: usize) -> &RowInfluence {
        self.rows[difference].get_or_init(|| self.spec.row(difference as f64 * self.spec.cell))
    }

    /// Surface influence between cells of rows this far apart; `row_difference` below [`Self::MOST_ROWS`].
    #[must_use]
    pub fn surface(&self, row_difference: usize) -> &Mat<f64> {
        &self.row(row_difference).surface
    }

    /// Depth influence between face functions of rows this far apart, for body 0 or 1.
    #[must_use]
    pub fn depth(&self, body: usize, family: usize, row_difference: usize) -> &Mat<f64> {
        &self.row(row_difference).depth[body][family]
    }
}

impl NearFieldSpec {
    fn row(&self, x: f64) -> RowInfluence {
        let (model, cell) = (self.model, self.cell);
        let solid = matches!(model, FaceModel::Solid { .. });
        let surface = if solid {
            solid_surface(&self.bodies, x, cell, &self.face, self.edge_correction)
        } else {
            plane_surface(model, &self.bodies, x, cell)
        };
        let depth = [0, 1].map(|index: usize| {
            let body = &self.bodies[index];
            let of_family = |basis: &FaceBasis| {
                if solid { solid_depth(body, basis, x, cell) } else { plane_depth(model, body, basis, x, cell) }
            };
            body.bases.iter().map(of_family).collect()
        });
        RowInfluence { surface, depth }
    }
}

fn plane_surface(model: FaceModel, bodies: &[NearBody; 2], x: f64, cell: f64) -> Mat<f64> {
    let sum: f64 = bodies
        .iter()
        .map(|body| {
            let width = body.bases.first().map_or(1.0, |basis| basis.width());
            strip_displacement(&body.material, model == FaceModel::PlaneStrain, 0.5 * cell, x, 0.0) / width
        })
        .sum();
    Mat::from_fn(1, 1, |_, _| sum)
}

fn plane_depth(model: FaceModel, body: &NearBody, basis: &FaceBasis, x: f64, cell: f64) -> Mat<f64> {
    let strain = model == FaceModel::PlaneStrain;
    let value = strip_displacement(&body.material, strain, 0.5 * cell, x, body.depth) / basis.width();
    Mat::from_fn(1, 1, |_, _| value)
}

fn solid_surface(bodies: &[NearBody; 2], x: f64, cell: f64, face: &FaceCells, edge_correction: bool) -> Mat<f64> {
    let count = face.centres.len();
    let at = |body: &NearBody, z: f64, depth: f64| {
        rectangle_displacement(&body.material, 0.5 * cell, 0.5 * face.width, x, z, depth)
    };
    // one table over the distances that occur on the uniform grid
    let direct: Vec<f64> =
        (0..2 * count).map(|k| bodies.iter().map(|b| at(b, k as f64 * face.width, 0.0)).sum()).collect();
    Mat::from_fn(count, count, |i, j| {
        let mut value = direct[i.abs_diff(j)];
        if face.mirrored {
            value = 0.5 * (value + direct[i + j + 1]);
        }
        if edge_correction {
            for body in bodies {
                value += edge_part(body, face, i, j, &at);
            }
        }
        value
    })
}

/// Local difference of the loads mirrored at the free ends of a body's face.
fn edge_part(body: &NearBody, face: &FaceCells, i: usize, j: usize, at: &impl Fn(&NearBody, f64, f64) -> f64) -> f64 {
    let width = body.bases.first().map_or(0.0, |basis| basis.width());
    let (z, source) = (face.centres[i], face.centres[j]);
    let ends: &[f64] = if face.mirrored { &[0.5] } else { &[0.5, -0.5] };
    // a mirrored cell carries half of its force on either side
    let share = if face.mirrored { 0.5 } else { 1.0 };
    ends.iter()
        .map(|end| {
            let distance = (2.0 * end * width - source - z).abs();
            if distance > EDGE_REACH * body.depth {
                return 0.0;
            }
            share * (at(body, distance, 0.0) - at(body, distance, body.depth))
        })
        .sum()
}

/// `M^-1 [ iint psi(z) g(x, z - z'; h) psi(z') ] M^-1` over the body's face.
fn solid_depth(body: &NearBody, basis: &FaceBasis, x: f64, cell: f64) -> Mat<f64> {
    let width = basis.width();
    let count = ((3.0 * width / body.depth).ceil() as usize).clamp(16, 400);
    let dz = width / count as f64;
    let kernel: Vec<f64> = (0..count)
        .map(|k| rectangle_displacement(&body.material, 0.5 * cell, 0.5 * dz, x, k as f64 * dz, body.depth))
        .collect();
    let norms = basis.plane_norms();
    let dual = Mat::from_fn(count, norms.len(), |q, k| {
        let z = -0.5 * width + (q as f64 + 0.5) * dz;
        basis.value(basis.plane_degrees()[k], z) * dz / norms[k]
    });
    // the kernel as one row of its Toeplitz matrix, mirrored: row q starts at count - 1 - q
    let mirrored: Vec<f64> = kernel.iter().rev().chain(&kernel[1..]).copied().collect();
    let spread = Mat::from_fn(count, norms.len(), |q, k| {
        let row = &mirrored[count - 1 - q..2 * count - 1 - q];
        row.iter().zip(column_slice(&dual, k)).map(|(g, d)| g * d).sum::<f64>()
    });
    crate::linalg::product(dual.transpose(), spread.as_ref())
}
