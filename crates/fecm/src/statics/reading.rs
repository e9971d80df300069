//! Functionals of a sector's displacement as functions of the loads on the teeth.
//!
//! With [`crate::condense`]'s symbols, a functional `r` of the displacement of a sector `a` is
//!
//! `r . u = (K_II^-1 r_I) . f_a + (X^T r_I - r_C) . sum_b G_ab X_b^T f_b`,
//!
//! so that one solve per functional serves all positions and torques. Loads `f` act on the flank, so only its rows of `K_II^-1 r_I` and `X` are kept; and
//! between the faces of a crack ([`super::crack_contact`]), for which `W^T K_II^-1 r_I` and `X^T W` are.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use faer::{ColRef, Mat};
use nalgebra::{Rotation2, Vector2};

use super::crack_contact::CrackOnTooth;
use super::model::PairModel;
use super::result::PositionResult;
use crate::body::{GearBody, ToothSector};
use crate::error::FecmError;
use crate::face::FaceBasis;
use crate::functional::Functional;
use crate::linalg::product;

/// Loads on the teeth of one gear, by tooth in `0..teeth`.
pub(super) type ToothLoads = BTreeMap<i32, ToothLoad>;

/// Loads on one tooth.
pub(super) struct ToothLoad {
    /// On the flank unknowns, by family.
    pub flank: Vec<Mat<f64>>,
    /// On the cells between the faces of its crack (N); empty where they do not touch.
    pub faces: Vec<f64>,
    /// `X^T f` of both, by family.
    pub cuts: Vec<Mat<f64>>,
}

impl ToothLoad {
    fn none(sector: &ToothSector) -> Self {
        let zeros = |rows: usize| Mat::zeros(rows, 1);
        Self {
            flank: sector.families.iter().map(|family| zeros(family.flank_size())).collect(),
            faces: Vec::new(),
            cuts: Vec::new(),
        }
    }
}

impl PairModel {
    /// Loads that the kept pressures of a position, and those between crack faces, put on the teeth of the pinion (0) or wheel (1).
    pub(super) fn tooth_loads(&self, position: &PositionResult, member: usize) -> Result<ToothLoads, FecmError> {
        let body = &self.bodies[member];
        let places = if self.face.mirrored { 2.0 } else { 1.0 };
        let mut teeth = ToothLoads::new();
        for patch in &position.patches {
            let tooth = self.tooth_of(patch.pair, member);
            let sector = body.sector(tooth);
            let loads = &mut teeth.entry(tooth).or_insert_with(|| ToothLoad::none(sector)).flank;
            let area = patch.cell[0] * patch.cell[1] * places;
            let rolls = if member == 0 { &patch.pinion_roll } else { &patch.wheel_roll };
            for (roll, pressures) in rolls.iter().zip(&patch.pressure) {
                if pressures.iter().all(|&p| p == 0.0) {
                    continue;
                }
                let station = sector.station(*roll);
                for (family, load) in body.families.iter().zip(&mut *loads) {
                    let mut modal = vec![0.0; family.basis.plane_degrees().len()];
                    for (z, pressure) in patch.face.iter().zip(pressures) {
                        for (sum, value) in modal.iter_mut().zip(family.basis.plane_values(*z)) {
                            *sum += value * pressure * area;
                        }
                    }
                    ToothSector::add_load(&station, &modal, load);
                }
            }
        }
        for contact in position.crack_faces.iter().filter(|contact| contact.member == member) {
            let load = teeth.entry(contact.tooth).or_insert_with(|| ToothLoad::none(body.sector(contact.tooth)));
            load.faces = contact.force.concat();
        }
        for (&tooth, load) in &mut teeth {
            let crack = self.crack_on(member, tooth);
            let on_cuts = |(index, flank): (usize, &Mat<f64>)| {
                let mut cuts = product(body.sector(tooth).families[index].at_flank.transpose(), flank.as_ref());
                if let Some(crack) = crack.filter(|_| !load.faces.is_empty()) {
                    cuts += product(crack.on_cuts[index].as_ref(), ColRef::from_slice(&load.faces).as_mat());
                }
                cuts
            };
            load.cuts = load.flank.iter().enumerate().map(on_cuts).collect();
        }
        Ok(teeth)
    }

    /// The crack of a tooth in `0..teeth`, as far as its faces can carry contact.
    pub(super) fn crack_on(&self, member: usize, tooth: i32) -> Option<&CrackOnTooth> {
        let cracks = self.options.contact.crack_face_contact.then(|| &self.crack_faces().cracks)?;
        cracks.iter().find(|crack| crack.member == member && crack.tooth == tooth)
    }

    /// Number in `0..teeth` of the tooth of a gear that belongs to a tooth pair.
    pub(super) fn tooth_of(&self, pair: i32, member: usize) -> i32 {
        let teeth = i64::from(self.bodies[member].teeth());
        (i64::from(pair) * i64::from(self.pairing.tooth_steps()[member])).rem_euclid(teeth) as i32
    }

    /// Tooth numbers farther apart than this do not share load.
    pub(super) fn reach(&self, member: usize) -> i32 {
        (self.pairing.most_pairs() as i32).min((self.bodies[member].teeth() - 1) / 2)
    }
}

/// Matrices by family, tooth read and tooth loaded.
type Between = BTreeMap<(usize, i32, i32), Arc<Mat<f64>>>;

/// Functionals of one sector, carried through its factorisation.
pub(super) struct SectorReading {
    pub families: Vec<FamilyReading>,
    count: usize,
    /// `(X^T r_I - r_C)^T G_ab`, made when first asked for.
    between: Mutex<Between>,
}

pub(super) struct FamilyReading {
    /// Rows of `K_II^-1 r_I` at the flank, a column a functional.
    pub at_flank: Mat<f64>,
    /// `W^T K_II^-1 r_I` of the cells between the faces of the sector's crack.
    pub at_faces: Mat<f64>,
    /// `X^T r_I - r_C`.
    pub cuts: Mat<f64>,
}

impl SectorReading {
    /// Prepares the functionals `[family][functional]` of a sector of a body, with the openings `[family][cell]` of its crack.
    pub fn new(
        body: &GearBody,
        sector: &ToothSector,
        functionals: &[Vec<Functional>],
        openings: Option<&[Vec<Functional>]>,
    ) -> Self {
        let families = body.families.iter().zip(functionals).enumerate();
        let families = families.map(|(index, (family, list))| {
            let openings = openings.map_or(&[][..], |openings| &openings[index]);
            FamilyReading::new(body, sector, (index, &family.basis), list, openings)
        });
        Self { families: families.collect(), count: functionals.first().map_or(0, Vec::len), between: Mutex::default() }
    }

    /// Values on tooth `tooth` under the loads of its gear.
    pub fn values(&self, body: &GearBody, tooth: i32, loads: &ToothLoads, reach: i32) -> Vec<f64> {
        let mut sums = vec![0.0; self.count];
        for (index, (reading, family)) in self.families.iter().zip(&body.families).enumerate() {
            let mut add = |part: Mat<f64>| sums.iter_mut().enumerate().for_each(|(k, sum)| *sum += part[(k, 0)]);
            if let Some(own) = loads.get(&tooth) {
                add(product(reading.at_flank.transpose(), own.flank[index].as_ref()));
                if !own.faces.is_empty() {
                    add(product(reading.at_faces.transpose(), ColRef::from_slice(&own.faces).as_mat()));
                }
            }
            for (&other, load) in loads {
                if family.ring.offset(tooth, other).abs() > reach {
                    continue;
                }
                let between = self.between(index, tooth, other, || {
                    product(reading.cuts.transpose(), family.ring.pair(tooth, other).as_ref())
                });
                add(product(between.as_ref().as_ref(), load.cuts[index].as_ref()));
            }
        }
        sums
    }

    fn between(&self, family: usize, tooth: i32, loaded: i32, make: impl FnOnce() -> Mat<f64>) -> Arc<Mat<f64>> {
        let lock = || self.between.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (family, tooth, loaded);
        if let Some(known) = lock().get(&key) {
            return Arc::clone(known);
        }
        // made outside the lock: two threads may both do it, with the same outcome
        let made = make();
        Arc::clone(lock().entry(key).or_insert_with(|| Arc::new(made)))
    }
}

impl FamilyReading {
    fn new(
        body: &GearBody,
        sector: &ToothSector,
        (index, basis): (usize, &FaceBasis),
        list: &[Functional],
        openings: &[Functional],
    ) -> Self {
        let condensed = &sector.families[index].condensed;
        let half = 0.5 * body.sector_angle();
        let pairs = basis.plane_degrees().len();
        let mut interior = Mat::zeros(condensed.interior_size(), list.len());
        let mut on_cuts = Mat::<f64>::zeros(condensed.stiffness().nrows(), list.len());
        for (k, functional) in list.iter().enumerate() {
            for &(node, dof, weight) in functional.terms() {
                for (row, part) in condensed.interior_terms(node, dof) {
                    interior[(row, k)] += part * weight;
                }
                let Some(row) = condensed.retained_row(node, dof) else { continue };
                if dof >= 2 * pairs {
                    on_cuts[(row, k)] += weight;
                    continue;
                }
                // retained components are radial and tangential
                let turn = Rotation2::new(if sector.shape.lower_cut.contains(&node) { -half } else { half });
                let axis = if dof % 2 == 0 { Vector2::x() } else { Vector2::y() };
                let local = turn.inverse() * (axis * weight);
                let first = row - dof % 2;
                on_cuts[(first, k)] += local.x;
                on_cuts[(first + 1, k)] += local.y;
            }
        }
        let mut cuts = product(condensed.retained_solution().transpose(), interior.as_ref());
        cuts -= on_cuts;
        condensed.solve_interior(&mut interior);
        let mut at_faces = Mat::zeros(openings.len(), list.len());
        for (i, opening) in openings.iter().enumerate() {
            for &(node, dof, weight) in opening.terms() {
                let Some(row) = condensed.interior_row(node, dof) else { continue };
                (0..list.len()).for_each(|k| at_faces[(i, k)] += weight * interior[(row, k)]);
            }
        }
        Self { at_flank: sector.families[index].at_flank_of(interior.as_ref()), at_faces, cuts }
    }
}
