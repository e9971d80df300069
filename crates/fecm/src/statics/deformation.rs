//! Displacement of a whole gear at one position, for pictures: the contact forces put back on the sectors they act on, the ring solved for all
//! its cuts, and every sector recovered from its own loads and cuts ([`crate::condense`]).

use faer::Mat;
use nalgebra::{Rotation2, Vector3};

use super::model::PairModel;
use super::result::PositionResult;
use crate::body::GearBody;
use crate::error::FecmError;
use crate::linalg::add_product;
use crate::ring::solve_ring;

/// Displacement field of a gear: hub at rest.
#[derive(Debug, Clone)]
pub struct BodyDeformation {
    /// Coefficients `[sector][family][node * unknowns + unknown]` in each sector's own frame (m).
    coefficients: Vec<Vec<Vec<f64>>>,
    sector_angle: f64,
}

impl PairModel {
    /// Deformation of the pinion (0) or wheel (1) at a position whose pressures were kept.
    ///
    /// # Errors
    /// Factorisation errors, points outside the mesh.
    pub fn deformation(&self, position: &PositionResult, member: usize) -> Result<BodyDeformation, FecmError> {
        let body = &self.bodies[member];
        let teeth = body.teeth();
        let on_teeth = self.tooth_loads(position, member)?;
        let mut coefficients = vec![Vec::new(); teeth as usize];
        for index in 0..body.families.len() {
            let load_on = |tooth: i32| {
                let load = on_teeth.get(&tooth)?;
                let family = &body.sector(tooth).families[index];
                let mut interior = family.interior_load(&load.flank[index]);
                if let Some(crack) = self.crack_on(member, tooth) {
                    crack.add_load(index, &family.condensed, &load.faces, &mut interior);
                }
                Some(SectorLoad { interior, cuts: &load.cuts[index] })
            };
            let loads: Vec<Option<SectorLoad<'_>>> = (0..teeth).map(load_on).collect();
            let fields = recover(body, index, &loads)?;
            for (sector, field) in coefficients.iter_mut().zip(fields) {
                sector.push(field);
            }
        }
        Ok(BodyDeformation { coefficients, sector_angle: body.sector_angle() })
    }
}

impl BodyDeformation {
    /// Displacement of a plane node of a sector at face position `z` (m), in the gear's frame.
    #[must_use]
    pub fn at(&self, body: &GearBody, sector: usize, node: usize, z: f64) -> Vector3<f64> {
        let mut local = Vector3::zeros();
        for (family, field) in body.families.iter().zip(&self.coefficients[sector]) {
            let block = family.basis.block();
            for (d, dof) in family.basis.dofs().iter().enumerate() {
                local[dof.component] += family.basis.value(dof.degree, z) * field[node * block + d];
            }
        }
        let turned = Rotation2::new(self.sector_angle * sector as f64) * local.xy();
        Vector3::new(turned.x, turned.y, local.z)
    }
}

/// Load on a sector, in one family.
struct SectorLoad<'a> {
    /// On its interior unknowns.
    interior: Mat<f64>,
    /// The same carried to its cuts, `X^T f`.
    cuts: &'a Mat<f64>,
}

/// Fields of all sectors from the loads on some.
fn recover(body: &GearBody, index: usize, loads: &[Option<SectorLoad<'_>>]) -> Result<Vec<Vec<f64>>, FecmError> {
    let teeth = loads.len();
    let ends = cut_displacements(body, index, loads)?;
    let basis = &body.families[index].basis;
    let block = basis.block();
    let half = 0.5 * body.sector_angle();
    let field_of = |tooth: usize| {
        let sector = body.sector(tooth as i32);
        let family = &sector.families[index];
        let shape = &sector.shape;
        let mut interior = match &loads[tooth] {
            Some(load) => {
                let mut own = load.interior.clone();
                family.condensed.solve_interior(&mut own);
                own
            }
            None => Mat::zeros(family.condensed.interior_size(), 1),
        };
        add_product(interior.as_mut(), -1.0, family.condensed.retained_solution(), ends[tooth].as_ref());
        let mut field = vec![0.0; shape.mesh.nodes.len() * block];
        for node in 0..shape.mesh.nodes.len() as u32 {
            for d in 0..block {
                for (row, weight) in family.condensed.interior_terms(node, d) {
                    field[node as usize * block + d] += weight * interior[(row, 0)];
                }
            }
        }
        let lower = shape.lower_cut.len();
        for (position, &node) in shape.lower_cut.iter().chain(&shape.upper_cut).enumerate() {
            let turn = Rotation2::new(if position < lower { -half } else { half });
            for d in 0..block {
                let Some(row) = family.condensed.retained_row(node, d) else { continue };
                field[node as usize * block + d] = ends[tooth][(row, 0)];
            }
            for pair in 0..basis.plane_degrees().len() {
                let at = node as usize * block + 2 * pair;
                let turned = turn * nalgebra::Vector2::new(field[at], field[at + 1]);
                (field[at], field[at + 1]) = (turned.x, turned.y);
            }
        }
        field
    };
    Ok((0..teeth).map(field_of).collect())
}

/// Displacements of the two cuts of every sector (lower, then upper). The ring is closed once more, all its sectors in it as they
/// are: a cyclic block-tridiagonal system, condensed to the teeth that are loaded or damaged.
fn cut_displacements(
    body: &GearBody,
    index: usize,
    loads: &[Option<SectorLoad<'_>>],
) -> Result<Vec<Mat<f64>>, FecmError> {
    let teeth = loads.len();
    let stiffness = |tooth: usize| body.sector(tooth as i32).families[index].condensed.stiffness();
    let n = stiffness(0).nrows() / 2;
    // loads on the cuts, cut k below sector k
    let mut cut_loads = vec![Mat::<f64>::zeros(n, 1); teeth];
    for (tooth, load) in loads.iter().enumerate() {
        let Some(load) = load else { continue };
        let reduced = load.cuts;
        for i in 0..n {
            cut_loads[tooth][(i, 0)] -= reduced[(i, 0)];
            cut_loads[(tooth + 1) % teeth][(i, 0)] -= reduced[(n + i, 0)];
        }
    }
    let arcs: Vec<&Mat<f64>> = (0..teeth).map(stiffness).collect();
    let cuts = solve_ring(&arcs, &cut_loads)?;
    Ok((0..teeth)
        .map(|tooth| {
            let mut ends = Mat::<f64>::zeros(2 * n, 1);
            for i in 0..n {
                ends[(i, 0)] = cuts[tooth][(i, 0)];
                ends[(n + i, 0)] = cuts[(tooth + 1) % teeth][(i, 0)];
            }
            ends
        })
        .collect())
}
