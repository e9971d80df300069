//! A gear as the contact problem sees it: compliance from normal loads on the flanks to displacements of the flanks.
//!
//! One sector is meshed and condensed ([`crate::condense`]), every damaged tooth one more, and the ring is closed ([`ring`]). Unit loads on the flank
//! of a tooth, polynomials along the profile and the face, then give two kinds of small dense matrix, per symmetry family along the face:
//!
//! * *own*: displacement of the same flank in the same functions,
//!   `K_II^-1 + X G X^T` with `G` the closed ring's compliance on the two cuts of the sector;
//! * *cross*: displacement of the flank of a neighbour, `X G_d X^T` - rim and hub coupling.
//!
//! A [`Station`] is a profile position: the profile's functions there. Loads and displacements along the inward normal are
//! positive. Stations and functions along the face stay separate (`station * functions + function`), so that a contact
//! grid of any resolution is two small products. What the near field has in full resolution is taken out of *own*: [`GearBody::remainder`].
//!
//! Near damaged teeth matrices are made when first asked for: a scene pays for the teeth that its contact reaches.

pub mod ring;
pub mod tooth;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use faer::Mat;
use gear_geom::{FlankSide, Gear, RootCrack};
use nalgebra::Rotation2;

use crate::error::FecmError;
use crate::face::{FaceBasis, FaceModel, Parity};
use crate::linalg::{add_product, product, symmetrise};
use crate::mass::BodyInertia;
use crate::material::Material;
use crate::mesh::MeshDensity;
use crate::nearfield::{NearBody, projected_half_space};
use ring::RingCompliance;
pub use tooth::{SectorFamily, Station, ToothSector};

/// What holds the gear at its bore (external) or outside (ring).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum BoreCondition {
    /// Bonded to a rigid hub, which turns as one.
    #[default]
    RigidHub,
    /// Bonded to a rigid hub through springs of this stiffness per area (N/m^3).
    ElasticHub {
        /// Stiffness per area (N/m^3), positive.
        stiffness: f64,
    },
    /// No hub: the reaction is spread over the bore as uniform tractions, and the bore's mean displacement and mean
    /// rotation take the place of the hub's.
    Tractions,
}

/// How a gear body is modelled.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyOptions {
    /// Mesh of the sector.
    pub mesh: MeshDensity,
    /// Behaviour along the face.
    pub face: FaceModel,
    /// Width of the body along the face (m).
    pub width: f64,
    /// Bore condition.
    pub bore: BoreCondition,
    /// Highest degree of the polynomials along the profile in which finite elements and contact exchange loads and displacements.
    pub profile_order: usize,
    /// Whether the near field's half-space has mirror loads at the free ends of the face.
    pub edge_correction: bool,
    /// Number of neighbouring teeth on either side whose coupling is kept.
    pub reach: usize,
    /// Whether loads that are not symmetric about mid-face can occur.
    pub antisymmetric: bool,
    /// Root cracks: tooth number and crack, one a tooth.
    pub cracks: Vec<(i64, RootCrack)>,
}

impl BodyOptions {
    /// Symmetry families that the body needs. A crack that varies along the face couples them.
    fn parities(&self) -> &'static [Parity] {
        if self.cracks.iter().any(|(_, crack)| crack.varies_along_face()) {
            &[Parity::Both]
        } else if self.antisymmetric {
            &[Parity::Symmetric, Parity::Antisymmetric]
        } else {
            &[Parity::Symmetric]
        }
    }
}

/// One symmetry family of a gear.
pub struct Family {
    /// Functions along the face.
    pub basis: FaceBasis,
    /// Compliance on the cuts.
    pub ring: RingCompliance,
    /// What the near field's half-space says of a flank, in the layout of *own*.
    half_space: Arc<Mat<f64>>,
    /// Between two healthy teeth far from damage: own at 0, then the neighbours ahead.
    healthy: Vec<Arc<Mat<f64>>>,
}

/// Sizes of a body's model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BodySizes {
    /// Nodes of the plane sector mesh.
    pub plane_nodes: usize,
    /// Elements of the plane sector mesh.
    pub plane_elements: usize,
    /// Interior unknowns of a sector, all families.
    pub sector_unknowns: usize,
    /// Unknowns on one cut, all families.
    pub cut_unknowns: usize,
    /// Entries of the sparse factors.
    pub factor_entries: usize,
}

/// Matrices near damaged teeth by family, loaded tooth and offset of the observed tooth.
type Cache = Mutex<BTreeMap<(usize, i32, i32), Arc<Mat<f64>>>>;

/// A gear, condensed for contact on one flank of its teeth.
pub struct GearBody {
    /// Material.
    pub material: Material,
    /// Flank that carries the load.
    pub side: FlankSide,
    /// Symmetry families: symmetric, and antisymmetric if asked for; or both in one, where a crack varies along the face.
    pub families: Vec<Family>,
    parities: &'static [Parity],
    healthy: Arc<ToothSector>,
    /// By tooth number in `0..teeth`.
    damaged: BTreeMap<i32, ToothSector>,
    teeth: i32,
    reach: i32,
    hub: Hub,
    near_damage: Cache,
}

/// How the bore is held.
#[derive(Debug, Clone, Copy)]
struct Hub {
    /// Springs per area (N/m^3), if not rigid.
    springs: Option<f64>,
    /// Springs that stand for a bore under tractions (N/m^3), if it is.
    soft: Option<f64>,
    radius: f64,
}

/// Damage is felt this many teeth beyond the reach of contact; beyond, its effect through the rim is left out.
const DAMAGE_MARGIN: i32 = 2;

impl GearBody {
    /// Meshes and condenses a gear loaded on the flank `side`; `name` appears in errors.
    ///
    /// # Errors
    /// Options out of range, a tooth form that cannot be meshed, cracks that cannot be, failed factorisations.
    pub fn new(
        gear: &Gear,
        side: FlankSide,
        material: &Material,
        options: &BodyOptions,
        name: &'static str,
    ) -> Result<Self, FecmError> {
        material.validate()?;
        let teeth = gear.teeth() as i32;
        let (springs, soft) = springs(options.bore, material, gear)?;
        let bases: Vec<FaceBasis> = options
            .parities()
            .iter()
            .filter_map(|&parity| FaceBasis::new(options.face, parity, options.width, material))
            .collect();
        let healthy = ToothSector::new(gear, side, None, &bases, options, springs, name)?;
        let reach = options.reach.min((teeth as usize - 1) / 2) as i32;
        let mut body = Self {
            material: *material,
            side,
            families: Vec::new(),
            parities: options.parities(),
            healthy: Arc::new(healthy),
            damaged: BTreeMap::new(),
            teeth,
            reach,
            hub: Hub { springs, soft, radius: gear.rim_radius() },
            near_damage: Mutex::default(),
        };
        for (index, basis) in bases.into_iter().enumerate() {
            let ring =
                RingCompliance::healthy(body.healthy.families[index].condensed.stiffness(), teeth, reach as usize)?;
            let matrices = (0..=reach)
                .map(|offset| {
                    Arc::new(body.matrix(index, &basis, &ring.pair(offset, 0), &body.healthy, &body.healthy, offset))
                })
                .collect();
            let near = NearBody { material: *material, width: options.width };
            let half_space =
                projected_half_space(options.face, &near, body.healthy.profile(), &basis, options.edge_correction);
            body.families.push(Family { basis, ring, half_space: Arc::new(half_space), healthy: matrices });
        }
        if options.cracks.is_empty() { Ok(body) } else { body.with_cracks(gear, options, name) }
    }

    /// The same gear with the root cracks of `options` (all else in them as it was): only the cracked sectors are meshed and condensed.
    ///
    /// # Errors
    /// [`FecmError::Crack`] for cracks that cannot be or share a tooth; failed factorisations.
    pub fn with_cracks(&self, gear: &Gear, options: &BodyOptions, name: &'static str) -> Result<Self, FecmError> {
        let bases: Vec<FaceBasis> = self.families.iter().map(|family| family.basis.clone()).collect();
        if self.parities != options.parities() {
            return Self::new(gear, self.side, &self.material, options, name);
        }
        let mut damaged = BTreeMap::new();
        for (tooth, crack) in options.cracks.iter().filter(|(_, crack)| !crack.is_empty()) {
            let tooth = tooth.rem_euclid(i64::from(self.teeth)) as i32;
            if crack.varies_along_face() && !matches!(options.face, FaceModel::Solid { .. }) {
                let allowed =
                    "a plane model: only a three-dimensional one has a face along which a crack can vary".into();
                return Err(FecmError::Crack {
                    what: "length along the face on tooth",
                    value: f64::from(tooth),
                    allowed,
                });
            }
            let sector = ToothSector::new(gear, self.side, Some(crack), &bases, options, self.hub.springs, name)?;
            if damaged.insert(tooth, sector).is_some() {
                let allowed = "one crack a tooth".to_owned();
                return Err(FecmError::Crack { what: "second crack on tooth", value: f64::from(tooth), allowed });
            }
        }
        let mut families = Vec::new();
        for (index, family) in self.families.iter().enumerate() {
            let changed: Vec<(i32, &Mat<f64>)> = damaged
                .iter()
                .map(|(&tooth, sector): (_, &ToothSector)| (tooth, sector.families[index].condensed.stiffness()))
                .collect();
            let healthy = self.healthy.families[index].condensed.stiffness();
            let farthest = (2 * self.reach + DAMAGE_MARGIN) as usize;
            let ring = family.ring.with_damage(healthy, &changed, farthest)?;
            families.push(Family {
                basis: family.basis.clone(),
                ring,
                half_space: Arc::clone(&family.half_space),
                healthy: family.healthy.clone(),
            });
        }
        Ok(Self {
            material: self.material,
            side: self.side,
            families,
            parities: self.parities,
            healthy: Arc::clone(&self.healthy),
            damaged,
            teeth: self.teeth,
            reach: self.reach,
            hub: self.hub,
            near_damage: Mutex::default(),
        })
    }

    /// Sizes of the model.
    #[must_use]
    pub fn sizes(&self) -> BodySizes {
        let sectors = || std::iter::once(&*self.healthy).chain(self.damaged.values());
        let families = || sectors().flat_map(|sector| &sector.families);
        BodySizes {
            plane_nodes: self.healthy.shape.mesh.nodes.len(),
            plane_elements: self.healthy.shape.mesh.element_count(),
            sector_unknowns: families().map(|f| f.condensed.interior_size()).sum(),
            cut_unknowns: self.healthy.families.iter().map(|f| f.condensed.stiffness().nrows() / 2).sum(),
            factor_entries: families().map(|f| f.condensed.factor_entries()).sum(),
        }
    }

    /// Teeth on either side of a cracked one whose compliance feels the crack.
    #[must_use]
    pub fn reach_of_damage(&self) -> i32 {
        if self.damaged.is_empty() { 0 } else { self.reach + DAMAGE_MARGIN }
    }

    /// The sector of a healthy tooth, which the gear's modes are made of.
    #[must_use]
    pub fn healthy_sector(&self) -> &Arc<ToothSector> {
        &self.healthy
    }

    /// Whether no hub holds the bore.
    pub(crate) fn is_free(&self) -> bool {
        self.hub.soft.is_some()
    }

    /// Mass and moments of inertia of the healthy gear, from its mesh.
    #[must_use]
    pub fn inertia(&self) -> BodyInertia {
        let width = self.families.first().map_or(0.0, |family| family.basis.width());
        BodyInertia::of_gear(&self.healthy.shape, self.teeth as u32, width, self.material.density)
    }

    /// Number of teeth.
    #[must_use]
    pub fn teeth(&self) -> i32 {
        self.teeth
    }

    /// Angle from tooth to tooth (rad).
    #[must_use]
    pub fn sector_angle(&self) -> f64 {
        self.healthy.shape.sector_angle
    }

    /// The sector of a tooth, any number modulo the number of teeth.
    #[must_use]
    pub fn sector(&self, tooth: i32) -> &ToothSector {
        self.damaged.get(&tooth.rem_euclid(self.teeth)).unwrap_or(&self.healthy)
    }

    /// Numbers in `0..teeth` of the teeth that have a sector of their own, ascending.
    pub fn damaged_teeth(&self) -> impl Iterator<Item = i32> + '_ {
        self.damaged.keys().copied()
    }

    /// Normal displacement by unit normal loads at the `loaded` stations of a tooth (m/N), in the functions along the face of a family: the finite
    /// elements' part, polynomial along the profile. Zero beyond the reach.
    #[must_use]
    pub fn compliance(&self, family: usize, observed: (i32, &[Station]), loaded: (i32, &[Station])) -> Mat<f64> {
        self.between_stations(family, observed, loaded, false)
    }

    /// [`Self::compliance`] less what the near field's half-space has of it: on the same tooth the rest that the half-space lacks.
    #[must_use]
    pub fn remainder(&self, family: usize, observed: (i32, &[Station]), loaded: (i32, &[Station])) -> Mat<f64> {
        self.between_stations(family, observed, loaded, true)
    }

    fn between_stations(
        &self,
        family: usize,
        observed: (i32, &[Station]),
        loaded: (i32, &[Station]),
        without_half_space: bool,
    ) -> Mat<f64> {
        let own = &self.families[family];
        let functions = own.basis.plane_degrees().len();
        let offset = own.ring.offset(observed.0, loaded.0);
        if offset.abs() > self.reach {
            return Mat::zeros(observed.1.len() * functions, loaded.1.len() * functions);
        }
        if offset < 0 {
            let matrix = self.matrix_between(family, observed.0, -offset);
            return at_stations(&matrix, functions, loaded.1, observed.1).transpose().to_owned();
        }
        let matrix = self.matrix_between(family, loaded.0, offset);
        let mut result = if offset == 0 && without_half_space {
            at_stations(&(&*matrix - &*own.half_space), functions, observed.1, loaded.1)
        } else {
            at_stations(&matrix, functions, observed.1, loaded.1)
        };
        if offset == 0 && std::ptr::eq(observed.1, loaded.1) {
            // but for rounding it is already
            symmetrise(&mut result);
        }
        result
    }

    /// The matrix from loads on a tooth to the one `offset >= 0` ahead.
    fn matrix_between(&self, family: usize, loaded: i32, offset: i32) -> Arc<Mat<f64>> {
        let own = &self.families[family];
        let near = |tooth: i32| {
            self.damaged.keys().any(|&damaged| own.ring.offset(tooth, damaged).abs() <= self.reach + DAMAGE_MARGIN)
        };
        if !near(loaded) && !near(loaded + offset) {
            return Arc::clone(&own.healthy[offset as usize]);
        }
        let key = (family, loaded.rem_euclid(self.teeth), offset);
        let lock = || self.near_damage.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get(&key) {
            return Arc::clone(known);
        }
        // made outside the lock: two threads may both do it, with the same outcome
        let pair = own.ring.pair(loaded + offset, loaded);
        let made = self.matrix(family, &own.basis, &pair, self.sector(loaded + offset), self.sector(loaded), offset);
        Arc::clone(lock().entry(key).or_insert_with(|| Arc::new(made)))
    }

    /// `base + X pair X^T` on one tooth, `X pair X^T` between two; without the motion of a soft hub.
    fn matrix(
        &self,
        family: usize,
        basis: &FaceBasis,
        pair: &Mat<f64>,
        observed: &ToothSector,
        loaded: &ToothSector,
        offset: i32,
    ) -> Mat<f64> {
        let (own, source) = (&observed.families[family], &loaded.families[family]);
        let spread = product(own.at_flank.as_ref(), pair.as_ref());
        let mut matrix = if offset == 0 {
            let mut matrix = own.base.clone();
            add_product(matrix.as_mut(), 1.0, spread.as_ref(), source.at_flank.transpose());
            symmetrise(&mut matrix);
            matrix
        } else {
            product(spread.as_ref(), source.at_flank.transpose())
        };
        if let Some(stiffness) = self.hub.soft {
            self.remove_hub_motion(stiffness, basis, &mut matrix, [observed, loaded], offset);
        }
        matrix
    }

    /// Takes the rigid motion of a bore on soft springs out of a compliance. The spring forces balance the load exactly, so the
    /// bore's mean motion is the load's resultant over the springs' total stiffness; what remains is the body under uniform
    /// reaction tractions with the bore's mean displacement and rotation zero.
    fn remove_hub_motion(
        &self,
        stiffness: f64,
        basis: &FaceBasis,
        matrix: &mut Mat<f64>,
        [observed, loaded]: [&ToothSector; 2],
        offset: i32,
    ) {
        let (radius, width) = (self.hub.radius, basis.width());
        let area = 2.0 * std::f64::consts::PI * radius * width;
        let degrees = basis.plane_degrees();
        let turn = Rotation2::new(-self.healthy.shape.sector_angle * f64::from(offset));
        for (k, &degree) in degrees.iter().enumerate() {
            // functions 1 and 2 z / b carry rigid motion: translation and rotation, or tilt
            let (translation, rotation) = match degree {
                0 => (1.0 / (stiffness * area), 1.0 / (stiffness * area * radius * radius)),
                1 => {
                    let tilt = stiffness * area * (width * width / 12.0 + 0.5 * radius * radius);
                    (0.25 * width * width / tilt, 0.0)
                }
                _ => continue,
            };
            for (i, (at_force, at_moment)) in observed.resultants().into_iter().enumerate() {
                for (j, (force, moment)) in loaded.resultants().into_iter().enumerate() {
                    let work = at_force.dot(&(turn * force)) * translation + at_moment * moment * rotation;
                    matrix[(i * degrees.len() + k, j * degrees.len() + k)] -= work;
                }
            }
        }
    }
}

/// Springs per area at the bore, and those of them that only stand for tractions.
fn springs(bore: BoreCondition, material: &Material, gear: &Gear) -> Result<(Option<f64>, Option<f64>), FecmError> {
    match bore {
        BoreCondition::RigidHub => Ok((None, None)),
        BoreCondition::ElasticHub { stiffness } if stiffness > 0.0 && stiffness.is_finite() => {
            Ok((Some(stiffness), None))
        }
        BoreCondition::ElasticHub { stiffness } => {
            let allowed = "a positive stiffness per area in N/m^3";
            Err(FecmError::Option { name: "hub stiffness", value: stiffness, allowed })
        }
        BoreCondition::Tractions => {
            let soft = 1e-5 * material.young_modulus / gear.rim_radius();
            Ok((Some(soft), Some(soft)))
        }
    }
}

/// `(Phi_o x 1) matrix (Phi_l x 1)^T` with the profile's functions `Phi` at stations, functions along the face kept apart.
fn at_stations(matrix: &Mat<f64>, functions: usize, observed: &[Station], loaded: &[Station]) -> Mat<f64> {
    let count = matrix.ncols() / functions;
    let phi = |stations: &[Station]| Mat::from_fn(stations.len(), count, |i, m| stations[i].values[m]);
    let (at_observed, at_loaded) = (phi(observed), phi(loaded));
    let mut result = Mat::zeros(observed.len() * functions, loaded.len() * functions);
    for k in 0..functions {
        for l in 0..functions {
            let part = Mat::from_fn(count, count, |m, n| matrix[(m * functions + k, n * functions + l)]);
            let half = product(at_observed.as_ref(), part.as_ref());
            let whole = product(half.as_ref(), at_loaded.transpose());
            for j in 0..loaded.len() {
                for i in 0..observed.len() {
                    result[(i * functions + k, j * functions + l)] = whole[(i, j)];
                }
            }
        }
    }
    result
}
