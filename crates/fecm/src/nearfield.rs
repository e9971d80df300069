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

use faer::Mat;

use crate::face::{FaceBasis, FaceModel};
use crate::halfspace::{rectangle_displacement, strip_displacement};
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
#[derive(Debug, Clone, Copy)]
pub struct NearBody<'a> {
    /// Material.
    pub material: &'a Material,
    /// Face bases of the body's families.
    pub bases: &'a [&'a FaceBasis],
    /// Matching depth (m).
    pub depth: f64,
}

/// Near-field influence of one cell size on one body pair.
#[derive(Debug)]
pub struct NearField {
    /// `[row difference]`: cells x cells, displacement per unit cell force, both bodies, free edges included (m/N).
    surface: Vec<Mat<f64>>,
    /// `[body][family][row difference]`: functions x functions, to be subtracted from the finite-element compliance.
    depth: [Vec<Vec<Mat<f64>>>; 2],
}

/// Mirror loads reach this many matching depths.
const EDGE_REACH: f64 = 8.0;

impl NearField {
    /// Tables for profile cells of width `cell` (m) and up to `rows` rows.
    #[must_use]
    pub fn new(
        model: FaceModel,
        bodies: [NearBody<'_>; 2],
        cell: f64,
        rows: usize,
        face: &FaceCells,
        edge_correction: bool,
    ) -> Self {
        let mut surface = Vec::with_capacity(rows);
        let mut depth = [Vec::new(), Vec::new()];
        for row in 0..rows {
            let x = row as f64 * cell;
            surface.push(match model {
                FaceModel::Solid { .. } => solid_surface(&bodies, x, cell, face, edge_correction),
                _ => plane_surface(model, &bodies, x, cell),
            });
        }
        for (body, tables) in bodies.iter().zip(&mut depth) {
            for basis in body.bases {
                let table = (0..rows).map(|row| {
                    let x = row as f64 * cell;
                    match model {
                        FaceModel::Solid { .. } => solid_depth(body, basis, x, cell),
                        _ => plane_depth(model, body, basis, x, cell),
                    }
                });
                tables.push(table.collect());
            }
        }
        Self { surface, depth }
    }

    /// Surface influence between cells of rows this far apart.
    #[must_use]
    pub fn surface(&self, row_difference: usize) -> &Mat<f64> {
        &self.surface[row_difference]
    }

    /// Depth influence between face functions of rows this far apart, for body 0 or 1.
    #[must_use]
    pub fn depth(&self, body: usize, family: usize, row_difference: usize) -> &Mat<f64> {
        &self.depth[body][family][row_difference]
    }
}

fn plane_surface(model: FaceModel, bodies: &[NearBody<'_>; 2], x: f64, cell: f64) -> Mat<f64> {
    let sum: f64 = bodies
        .iter()
        .map(|body| {
            let width = body.bases.first().map_or(1.0, |basis| basis.width());
            strip_displacement(body.material, model == FaceModel::PlaneStrain, 0.5 * cell, x, 0.0) / width
        })
        .sum();
    Mat::from_fn(1, 1, |_, _| sum)
}

fn plane_depth(model: FaceModel, body: &NearBody<'_>, basis: &FaceBasis, x: f64, cell: f64) -> Mat<f64> {
    let strain = model == FaceModel::PlaneStrain;
    let value = strip_displacement(body.material, strain, 0.5 * cell, x, body.depth) / basis.width();
    Mat::from_fn(1, 1, |_, _| value)
}

fn solid_surface(
    bodies: &[NearBody<'_>; 2],
    x: f64,
    cell: f64,
    face: &FaceCells,
    edge_correction: bool,
) -> Mat<f64> {
    let count = face.centres.len();
    let at = |body: &NearBody<'_>, z: f64, depth: f64| {
        rectangle_displacement(body.material, 0.5 * cell, 0.5 * face.width, x, z, depth)
    };
    // one table over the distances that occur on the uniform grid
    let direct: Vec<f64> = (0..2 * count).map(|k| bodies.iter().map(|b| at(b, k as f64 * face.width, 0.0)).sum()).collect();
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
fn edge_part(
    body: &NearBody<'_>,
    face: &FaceCells,
    i: usize,
    j: usize,
    at: &impl Fn(&NearBody<'_>, f64, f64) -> f64,
) -> f64 {
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
fn solid_depth(body: &NearBody<'_>, basis: &FaceBasis, x: f64, cell: f64) -> Mat<f64> {
    let width = basis.width();
    let count = ((3.0 * width / body.depth).ceil() as usize).clamp(16, 400);
    let dz = width / count as f64;
    let kernel: Vec<f64> = (0..count)
        .map(|k| rectangle_displacement(body.material, 0.5 * cell, 0.5 * dz, x, k as f64 * dz, body.depth))
        .collect();
    let norms = basis.plane_norms();
    let dual = Mat::from_fn(count, norms.len(), |q, k| {
        let z = -0.5 * width + (q as f64 + 0.5) * dz;
        basis.value(basis.plane_degrees()[k], z) * dz / norms[k]
    });
    let spread = Mat::from_fn(count, norms.len(), |q, k| {
        (0..count).map(|r| kernel[q.abs_diff(r)] * dual[(r, k)]).sum::<f64>()
    });
    crate::linalg::product(dual.transpose(), spread.as_ref())
}
