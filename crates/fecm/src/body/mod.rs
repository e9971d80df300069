//! A gear as the contact problem sees it: compliance from normal loads on the flanks to displacements at matching depth.
//!
//! One sector is meshed and condensed ([`crate::condense`]), every damaged tooth one more, and the ring is closed ([`ring`]). Unit loads at the flank
//! nodes of a tooth then give two kinds of dense matrix, per symmetry family along the face:
//!
//! * *own*: displacement of the nodes around the matching depth below the same flank,
//!   `K_II^-1 + X G X^T` with `G` the closed ring's compliance on the two cuts of the sector;
//! * *cross*: displacement of the flank of a neighbour, `X G_d X^T` - rim and hub coupling.
//!
//! A [`Station`] is a profile position; its load is spread over the flank nodes of its element edge, and its displacement is read
//! at depth `h` below it inside the element that holds the point. Loads and displacements along the inward normal are
//! positive. Stations and functions along the face stay separate (`station * functions + function`), so that a contact
//! grid of any resolution is two small products.
//!
//! Near damaged teeth matrices are made when first asked for: a scene pays for the teeth that its contact reaches.

pub mod ring;
pub mod tooth;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

use faer::Mat;
use gear_geom::{FlankSide, Gear, RootCrack};
use nalgebra::{Point2, Rotation2, Vector2};

use crate::error::FecmError;
use crate::face::{FaceBasis, FaceModel, Parity};
use crate::linalg::{add_product, add_scaled, column_slice, column_slice_mut, product, symmetrise};
use crate::mass::BodyInertia;
use crate::material::Material;
use crate::mesh::MeshDensity;
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
    /// Depth below the flank at which the finite-element displacement is taken (m).
    pub matching_depth: f64,
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
    depth: f64,
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
            depth: options.matching_depth,
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
            body.families.push(Family { basis, ring, healthy: matrices });
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
            families.push(Family { basis: family.basis.clone(), ring, healthy: family.healthy.clone() });
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
            depth: self.depth,
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

    /// Matching depth (m).
    #[must_use]
    pub fn matching_depth(&self) -> f64 {
        self.depth
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

    /// Normal displacement by unit normal loads at the `loaded` stations of a tooth (m/N), in the functions along the face of a family. On
    /// the same tooth it is the one at depth below the `observed` stations, symmetric; on another tooth that of its flank. Zero beyond
    /// the reach.
    #[must_use]
    pub fn compliance(&self, family: usize, observed: (i32, &[Station]), loaded: (i32, &[Station])) -> Mat<f64> {
        let functions = self.families[family].basis.plane_degrees().len();
        let offset = self.families[family].ring.offset(observed.0, loaded.0);
        if offset == 0 {
            let matrix = self.matrix_between(family, loaded.0, 0);
            let mut result = contract(&matrix, functions, observed.1, loaded.1, |s| &s.depth);
            symmetrise(&mut result);
            result
        } else if offset.abs() > self.reach {
            Mat::zeros(observed.1.len() * functions, loaded.1.len() * functions)
        } else if offset > 0 {
            contract(&self.matrix_between(family, loaded.0, offset), functions, observed.1, loaded.1, |s| &s.load)
        } else {
            let matrix = self.matrix_between(family, observed.0, -offset);
            contract(&matrix, functions, loaded.1, observed.1, |s| &s.load).transpose().to_owned()
        }
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
        let mut matrix = if offset == 0 {
            let spread = product(own.at_depth.as_ref(), pair.as_ref());
            let mut matrix = own.base.clone();
            add_product(matrix.as_mut(), 1.0, spread.as_ref(), source.at_flank.transpose());
            matrix
        } else {
            let spread = product(own.at_flank.as_ref(), pair.as_ref());
            product(spread.as_ref(), source.at_flank.transpose())
        };
        if let Some(stiffness) = self.hub.soft {
            let places = if offset == 0 { observed.depth_points() } else { observed.flank_points() };
            self.remove_hub_motion(stiffness, basis, &mut matrix, &places, &loaded.flank_points(), offset);
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
        observed: &[Point2<f64>],
        flank: &[Point2<f64>],
        offset: i32,
    ) {
        let (radius, width) = (self.hub.radius, basis.width());
        let area = 2.0 * std::f64::consts::PI * radius * width;
        let degrees = basis.plane_degrees();
        let count = 2 * degrees.len();
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
            for (i, at) in observed.iter().enumerate() {
                for (j, from) in flank.iter().enumerate() {
                    for c in 0..2 {
                        let force = if c == 0 { Vector2::x() } else { Vector2::y() };
                        let moment = from.x * force.y - from.y * force.x;
                        let spin = Vector2::new(-at.y, at.x) * (moment * rotation);
                        let motion = turn * force * translation + spin;
                        matrix[(i * count + 2 * k, j * count + 2 * k + c)] -= motion.x;
                        matrix[(i * count + 2 * k + 1, j * count + 2 * k + c)] -= motion.y;
                    }
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

/// `observed^T matrix loaded` with the stations' weights, functions along the face kept apart. Stations share few nodes: each column of a
/// loaded node is first read by all observed stations, once.
fn contract(
    matrix: &Mat<f64>,
    functions: usize,
    observed: &[Station],
    loaded: &[Station],
    rows: impl Fn(&Station) -> &Vec<(usize, Vector2<f64>)>,
) -> Mat<f64> {
    let height = observed.len() * functions;
    let read = |column: usize| -> Vec<f64> {
        let source = column_slice(matrix, column);
        let mut target = vec![0.0; height];
        for (station, target) in observed.iter().zip(target.chunks_exact_mut(functions)) {
            for &(slot, weight) in rows(station) {
                let at = 2 * slot * functions;
                for (value, motion) in target.iter_mut().zip(source[at..at + 2 * functions].chunks_exact(2)) {
                    *value += weight.x * motion[0] + weight.y * motion[1];
                }
            }
        }
        target
    };
    let slots: BTreeSet<usize> = loaded.iter().flat_map(|station| station.load.iter().map(|(slot, _)| *slot)).collect();
    let by_slot: BTreeMap<usize, Vec<Vec<f64>>> = slots
        .into_iter()
        .map(|slot| (slot, (0..2 * functions).map(|k| read(2 * slot * functions + k)).collect()))
        .collect();
    let mut result = Mat::zeros(height, loaded.len() * functions);
    for (j, station) in loaded.iter().enumerate() {
        for &(slot, weight) in &station.load {
            let columns = by_slot[&slot].chunks_exact(2);
            for (k, pair) in columns.enumerate() {
                let target = column_slice_mut(&mut result, j * functions + k);
                add_scaled(target, weight.x, &pair[0]);
                add_scaled(target, weight.y, &pair[1]);
            }
        }
    }
    result
}
