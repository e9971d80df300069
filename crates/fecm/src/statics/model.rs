//! A gear pair made ready for contact: bodies condensed, pairs placed, near fields tabulated.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use gear_geom::{Damage, GearPair, RootCrack, ToothDamage};

use super::crack_contact::CrackFaces;
use super::options::PairModelOptions;
use crate::body::{BodyOptions, BodySizes, GearBody};
use crate::error::FecmError;
use crate::face::FaceModel;
use crate::nearfield::{FaceCells, NearBody, NearField, NearFieldSpec};
use crate::pairing::Pairing;

/// A gear pair, condensed: statics at any position and torque cost a contact solution each.
pub struct PairModel {
    pub(super) pairing: Pairing,
    pub(super) bodies: [Arc<GearBody>; 2],
    pub(super) options: PairModelOptions,
    pub(super) face: FaceCells,
    /// By the bits of the cell size.
    near_fields: Arc<Mutex<BTreeMap<u64, Arc<NearField>>>>,
    crack_faces: OnceLock<CrackFaces>,
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
        let pairing = Pairing::new(pair).with_damage(&options.damage);
        let symmetric = pairing.is_symmetric_about_midface() && options.damage_is_symmetric();
        let solid = matches!(options.face, FaceModel::Solid { .. });
        let common = pairing.common_facewidth();
        let condense = |index: usize| {
            let body = body_options(&pairing, options, symmetric, index);
            let material = &options.member(index).material;
            GearBody::new(pairing.gear(index), pairing.side(index), material, &body, NAMES[index]).map(Arc::new)
        };
        let (pinion, wheel) = rayon::join(|| condense(0), || condense(1));
        let bodies = [pinion?, wheel?];
        let face = if solid {
            let count = options.contact.face_cells;
            FaceCells::new(common, if symmetric { count.div_ceil(2) } else { count }, symmetric)
        } else {
            FaceCells::new(common, 1, false)
        };
        let near_fields = Arc::default();
        Ok(Self {
            pairing,
            bodies,
            options: options.clone(),
            face,
            near_fields,
            crack_faces: OnceLock::new(),
            condensation_time: started.elapsed(),
        })
    }

    /// The same pair with other damage. What damage does not touch is shared: a healthy gear as a whole, of a cracked one all but the cracked
    /// sectors. Damage that breaks the symmetry about mid-face of this model or of a gear needs [`Self::new`] and gets it.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_damage(&self, damage: &[Vec<ToothDamage>; 2]) -> Result<Self, FecmError> {
        let options = PairModelOptions { damage: damage.clone(), ..self.options.clone() };
        options.validate()?;
        let varies = |damage: &[Vec<ToothDamage>; 2]| {
            damage.each_ref().map(|own| cracks_of(own).iter().any(|(_, crack)| crack.varies_along_face()))
        };
        let breaks_symmetry = self.stats().symmetric && !options.damage_is_symmetric();
        if breaks_symmetry || varies(damage) != varies(&self.options.damage) {
            return Self::new(self.pairing.pair(), &options);
        }
        let started = Instant::now();
        let pairing = Pairing::new(self.pairing.pair()).with_damage(damage);
        let derive = |index: usize| {
            let cracks = cracks_of(&damage[index]);
            if cracks == cracks_of(&self.options.damage[index]) {
                return Ok(Arc::clone(&self.bodies[index]));
            }
            let body = body_options(&pairing, &options, self.stats().symmetric, index);
            self.bodies[index].with_cracks(pairing.gear(index), &body, NAMES[index]).map(Arc::new)
        };
        let (pinion, wheel) = rayon::join(|| derive(0), || derive(1));
        Ok(Self {
            bodies: [pinion?, wheel?],
            pairing,
            options,
            face: self.face.clone(),
            near_fields: Arc::clone(&self.near_fields),
            crack_faces: OnceLock::new(),
            condensation_time: started.elapsed(),
        })
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
    pub fn bodies(&self) -> &[Arc<GearBody>; 2] {
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

    /// Faces of all cracks; made once.
    pub(super) fn crack_faces(&self) -> &CrackFaces {
        self.crack_faces.get_or_init(|| CrackFaces::new(&self.bodies))
    }

    /// Near field of a cell size; made once.
    pub(super) fn near_field(&self, cell: f64) -> Arc<NearField> {
        // a poisoned lock only means that another thread panicked between two complete states
        let mut fields = self.near_fields.lock().unwrap_or_else(PoisonError::into_inner);
        let field = fields.entry(cell.to_bits()).or_insert_with(|| {
            let near = |body: &GearBody| NearBody {
                material: body.material,
                width: body.families.first().map_or(0.0, |family| family.basis.width()),
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
        let one = |body: &Arc<GearBody>| {
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

/// Names of the gears in errors.
const NAMES: [&str; 2] = ["pinion", "wheel"];

fn body_options(pairing: &Pairing, options: &PairModelOptions, symmetric: bool, index: usize) -> BodyOptions {
    let solid = matches!(options.face, FaceModel::Solid { .. });
    let (gear, member) = (pairing.gear(index), options.member(index));
    BodyOptions {
        mesh: member.mesh,
        face: options.face,
        // a plane model is uniform along the face that carries load
        width: if solid { gear.facewidth() } else { pairing.common_facewidth() },
        bore: member.bore,
        profile_order: options.contact.profile_order,
        edge_correction: options.contact.edge_correction,
        reach: pairing.most_pairs(),
        antisymmetric: solid && !symmetric,
        cracks: cracks_of(&options.damage[index]),
    }
}

/// The cracks of any length among a gear's damage.
pub(super) fn cracks_of(damage: &[ToothDamage]) -> Vec<(i64, RootCrack)> {
    let cracks = damage.iter().filter_map(|damage| match &damage.damage {
        Damage::Crack(crack) if !crack.is_empty() => Some((damage.tooth, crack.clone())),
        _ => None,
    });
    cracks.collect()
}
