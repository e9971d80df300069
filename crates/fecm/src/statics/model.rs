//! A gear pair made ready for contact: bodies condensed, pairs placed, near fields tabulated.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use gear_geom::GearPair;

use super::options::PairModelOptions;
use crate::body::{BodyOptions, BodySizes, GearBody};
use crate::error::FecmError;
use crate::face::FaceModel;
use crate::nearfield::{FaceCells, NearBody, NearField, NearFieldSpec};
use crate::pairing::Pairing;

/// A gear pair, condensed: statics at any position and torque cost a contact solution each.
pub struct PairModel {
    pub(super) pairing: Pairing,
    pub(super) bodies: [GearBody; 2],
    pub(super) options: PairModelOptions,
    pub(super) face: FaceCells,
    /// By the bits of the cell size.
    near_fields: Mutex<BTreeMap<u64, Arc<NearField>>>,
    condensation_time: Duration,
}

/// Sizes and cost of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelStats {
    /// Pinion.
    pub pinion: BodySizes,
    /// Wheel.
    pub wheel: BodySizes,
    /// Whether the scene is symmetric about mid-face, so that half of it is solved.
    pub symmetric: bool,
    /// Cells along the face.
    pub face_cells: usize,
    /// Time to mesh and condense both bodies.
    pub condensation_time: Duration,
}

impl PairModel {
    /// Meshes and condenses both gears (in parallel).
    ///
    /// # Errors
    /// Options out of range, tooth forms that cannot be meshed, failed factorisations.
    pub fn new(pair: &GearPair, options: &PairModelOptions) -> Result<Self, FecmError> {
        options.validate()?;
        let started = Instant::now();
        let pairing = Pairing::new(pair);
        let symmetric = pairing.is_symmetric_about_midface();
        let solid = matches!(options.face, FaceModel::Solid { .. });
        let common = pairing.common_facewidth();
        let members = [&options.pinion, &options.wheel];
        let names = ["pinion", "wheel"];
        let condense = |index: usize| {
            let gear = pairing.gear(index);
            let body = BodyOptions {
                mesh: members[index].mesh,
                face: options.face,
                // a plane model is uniform along the face that carries load
                width: if solid { gear.facewidth() } else { common },
                bore: members[index].bore,
                matching_depth: options.contact.matching_depth * gear.module(),
                reach: pairing.most_pairs(),
                antisymmetric: solid && !symmetric,
            };
            GearBody::new(gear, pairing.side(index), &members[index].material, &body, names[index])
        };
        let (pinion, wheel) = rayon::join(|| condense(0), || condense(1));
        let bodies = [pinion?, wheel?];
        let face = if solid {
            let count = options.contact.face_cells;
            FaceCells::new(common, if symmetric { count.div_ceil(2) } else { count }, symmetric)
        } else {
            FaceCells::new(common, 1, false)
        };
        let near_fields = Mutex::default();
        Ok(Self { pairing, bodies, options: *options, face, near_fields, condensation_time: started.elapsed() })
    }

    /// Sizes and cost.
    #[must_use]
    pub fn stats(&self) -> ModelStats {
        ModelStats {
            pinion: self.bodies[0].sizes(),
            wheel: self.bodies[1].sizes(),
            symmetric: self.face.mirrored,
            face_cells: self.face.centres.len() * if self.face.mirrored { 2 } else { 1 },
            condensation_time: self.condensation_time,
        }
    }

    /// Bodies: pinion, wheel.
    #[must_use]
    pub fn bodies(&self) -> &[GearBody; 2] {
        &self.bodies
    }

    /// Tooth pairs in space.
    #[must_use]
    pub fn pairing(&self) -> &Pairing {
        &self.pairing
    }

    /// Options.
    #[must_use]
    pub fn options(&self) -> &PairModelOptions {
        &self.options
    }

    /// Near field of a cell size; made once.
    pub(super) fn near_field(&self, cell: f64) -> Arc<NearField> {
        // a poisoned lock only means that another thread panicked between two complete states
        let mut fields = self.near_fields.lock().unwrap_or_else(PoisonError::into_inner);
        let field = fields.entry(cell.to_bits()).or_insert_with(|| {
            let near = |body: &GearBody| NearBody {
                material: body.material,
                bases: body.families.iter().map(|family| family.basis.clone()).collect(),
                depth: body.matching_depth(),
            };
            Arc::new(NearField::new(NearFieldSpec {
                model: self.options.face,
                bodies: [near(&self.bodies[0]), near(&self.bodies[1])],
                cell,
                face: self.face.clone(),
                edge_correction: self.options.contact.edge_correction,
            }))
        });
        Arc::clone(field)
    }

    /// Largest cell that still resolves a flank (m).
    pub(super) fn widest_cell(&self) -> f64 {
        self.pairing.shortest_flank() / (4.0 * self.options.contact.cells_per_half_width)
    }

    /// Cell size along the profile for a torque (m): a fraction of the Hertz half width of all the load on one pair at the pitch point,
    /// rounded to a ladder of quarter octaves so that torques share near fields, and no wider than the flank allows.
    pub(super) fn cell_size(&self, torque: f64) -> f64 {
        let line_load = torque / self.pairing.base_radius(1) / self.face_span();
        let half_width = self.pairing.hertz_half_width(self.compliance_modulus(), line_load);
        let cells = self.options.contact.cells_per_half_width;
        let widest = self.widest_cell();
        let cell = (half_width / cells).min(widest).max(1e-9 * widest);
        on_ladder(cell)
    }

    /// Width of the face that carries load (m).
    pub(super) fn face_span(&self) -> f64 {
        self.pairing.common_facewidth()
    }

    /// `1 / E* = (1 - nu_1^2) / E_1 + (1 - nu_2^2) / E_2`, without the `nu` for plane stress (1/Pa).
    pub(super) fn compliance_modulus(&self) -> f64 {
        let plane_stress = self.options.face == FaceModel::PlaneStress;
        let one = |body: &GearBody| {
            let nu = if plane_stress { 0.0 } else { body.material.poisson_ratio };
            (1.0 - nu * nu) / body.material.young_modulus
        };
        self.bodies.iter().map(one).sum()
    }

    /// First guess of the mesh deflection (m): the plane-strain tooth-pair stiffness of about 0.07 E per unit face of ISO 6336-1.
    pub(super) fn deflection_guess(&self, torque: f64) -> f64 {
        torque / self.pairing.base_radius(1) / self.face_span() * self.compliance_modulus() / (2.0 * 0.07)
    }
}

/// The nearest size on a ladder of quarter octaves.
pub(super) fn on_ladder(cell: f64) -> f64 {
    2.0_f64.powf((4.0 * cell.log2()).round() / 4.0)
}
