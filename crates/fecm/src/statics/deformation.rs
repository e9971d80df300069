//! Displacement of a whole gear at one position, for pictures: the contact forces put back on the sectors they act on, the ring solved for all
//! its cuts, and every sector recovered from its own loads and cuts ([`crate::condense`]).

use faer::Mat;
use nalgebra::{Rotation2, Vector3};

use super::model::PairModel;
use super::result::PositionResult;
use crate::body::{Family, GearBody};
use crate::error::FecmError;
use crate::ring::{Arc, cyclic_cut_compliance};

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
        let teeth = self.pairing.gear(member).teeth() as usize;
        let step = self.pairing.tooth_steps()[member];
        let mut coefficients = vec![Vec::new(); teeth];
        for (index, family) in body.families.iter().enumerate() {
            let mut loads = vec![None; teeth];
            for patch in &position.patches {
                let tooth = (i64::from(patch.pair) * i64::from(step)).rem_euclid(teeth as i64) as usize;
                let places = if self.face.mirrored { 2.0 } else { 1.0 };
                let area = patch.cell[0] * patch.cell[1] * places;
                let rolls = if member == 0 { &patch.pinion_roll } else { &patch.wheel_roll };
                let load = loads[tooth].get_or_insert_with(|| Mat::zeros(family.sector.interior_size(), 1));
                for (roll, pressures) in rolls.iter().zip(&patch.pressure) {
                    let station = body.station(*roll)?;
                    let mut modal = vec![0.0; family.basis.plane_degrees().len()];
                    for (z, pressure) in patch.face.iter().zip(pressures) {
                        for (sum, value) in modal.iter_mut().zip(family.basis.plane_values(*z)) {
                            *sum += value * pressure * area;
                        }
                    }
                    body.add_load(index, &station, &modal, load);
                }
            }
            let fields = recover(body, family, teeth, &loads)?;
            for (sector, field) in coefficients.iter_mut().zip(fields) {
                sector.push(field);
            }
        }
        Ok(BodyDeformation { coefficients, sector_angle: body.sector.sector_angle })
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

/// Fields of all sectors from the loads on some.
fn recover(
    body: &GearBody,
    family: &Family,
    teeth: usize,
    loads: &[Option<Mat<f64>>],
) -> Result<Vec<Vec<f64>>, FecmError> {
    let solution = family.sector.retained_solution();
    let n = family.sector.stiffness().nrows() / 2;
    // loads on the cuts, cut k below sector k
    let mut cut_loads = vec![Mat::<f64>::zeros(n, 1); teeth];
    for (tooth, load) in loads.iter().enumerate() {
        let Some(load) = load else { continue };
        let reduced = solution.transpose() * load;
        for i in 0..n {
            cut_loads[tooth][(i, 0)] -= reduced[(i, 0)];
            cut_loads[(tooth + 1) % teeth][(i, 0)] -= reduced[(n + i, 0)];
        }
    }
    let arc = Arc::of_sector(family.sector.stiffness());
    let compliance = cyclic_cut_compliance(&arc, teeth, teeth / 2)?;
    let mut cuts = vec![Mat::<f64>::zeros(n, 1); teeth];
    for (source, load) in cut_loads.iter().enumerate() {
        if (0..n).all(|i| load[(i, 0)] == 0.0) {
            continue;
        }
        for (cut, displacement) in cuts.iter_mut().enumerate() {
            let ahead = (cut + teeth - source) % teeth;
            if ahead < compliance.len() {
                *displacement += &compliance[ahead] * load;
            } else {
                *displacement += compliance[teeth - ahead].transpose() * load;
            }
        }
    }
    let block = family.basis.block();
    let half = 0.5 * body.sector.sector_angle;
    let nodes = body.sector.mesh.nodes.len();
    let lower = body.sector.lower_cut.len();
    (0..teeth)
        .map(|tooth| {
            let mut ends = Mat::<f64>::zeros(2 * n, 1);
            for i in 0..n {
                ends[(i, 0)] = cuts[tooth][(i, 0)];
                ends[(n + i, 0)] = cuts[(tooth + 1) % teeth][(i, 0)];
            }
            let mut interior = match &loads[tooth] {
                Some(load) => {
                    let mut own = load.clone();
                    family.sector.solve_interior(&mut own);
                    own
                }
                None => Mat::zeros(family.sector.interior_size(), 1),
            };
            interior -= solution * &ends;
            let mut field = vec![0.0; nodes * block];
            for node in 0..nodes as u32 {
                for d in 0..block {
                    if let Some(row) = family.sector.interior_row(node, d) {
                        field[node as usize * block + d] = interior[(row, 0)];
                    }
                }
            }
            let retained = body.sector.lower_cut.iter().chain(&body.sector.upper_cut);
            for (position, &node) in retained.enumerate() {
                let turn = Rotation2::new(if position < lower { -half } else { half });
                for d in 0..block {
                    let Some(row) = family.sector.retained_row(node, d) else { continue };
                    field[node as usize * block + d] = ends[(row, 0)];
                }
                for pair in 0..family.basis.plane_degrees().len() {
                    let at = node as usize * block + 2 * pair;
                    let turned = turn * nalgebra::Vector2::new(field[at], field[at + 1]);
                    (field[at], field[at + 1]) = (turned.x, turned.y);
                }
            }
            Ok(field)
        })
        .collect()
}
