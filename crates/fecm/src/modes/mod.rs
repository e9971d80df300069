//! Elastic modes of a gear whose hub is held: the elastic half of its Craig-Bampton model.
//!
//! A gear in motion is the rigid motion of its hub plus `u = sum_k phi_k q_k` in the frame that turns with it, `phi_k` the mass-normalised
//! modes with the hub held (bore bonded to a rigid hub: held nodes; elastic hub: on its foundation). With `r` the six rigid motions,
//!
//! `M = [[M_rr, M_rq], [M_qr, 1]]`, `K = diag(0, omega_k^2)`, forces `(r^T f, phi^T f)`,
//!
//! `M_rr` of [`BodyInertia`](crate::mass::BodyInertia), `M_qr` the [`Mode::rigid_coupling`]. What the modes left out give at rest is the body's exact static
//! compliance less [`GearModes::compliance`]; with it the static limit is exact at any number of modes (MacNeal 1971; Rubin 1975).
//! A gear with cracks takes the modes of the healthy gear and its own compliance: cracks change stiffness at a tooth's root, which is
//! static, and next to no mass.
//!
//! The gear is a ring of `N` equal sectors, so its modes follow from one sector: `sector` reduces it to its cuts and a few fields,
//! `harmonic` couples the cuts for each nodal diameter `h`, `krylov` finds the lowest eigenpairs. Modes of `0 < h < N / 2` come in
//! pairs, and the rule that fixes them is the mirror about the centre line of tooth 0: [`Twin::Even`] equals its image, [`Twin::Odd`]
//! is opposite to it. Signs make the largest component positive. A pair is never split: one mode more than asked may be returned.
//!
//! Verified in `tests/modes.rs` against the full gear assembled as one body, closed forms, and static completeness.

mod harmonic;
pub mod krylov;
mod ring;
mod sector;

use std::ops::Range;
use std::sync::Arc;

use faer::Mat;
use gear_geom::FlankSide;

use crate::body::{GearBody, Station, ToothSector};
use crate::error::FecmError;
use crate::face::FaceBasis;
use crate::linalg::product;
use harmonic::HarmonicModes;
use ring::FamilyRing;
use sector::SectorLayout;

/// How many modes, and how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModesOptions {
    /// Number of modes of the gear, lowest first; 0 costs nothing.
    pub count: usize,
    /// Largest last correction of a frequency, relative to it, 1e-12 to 0.1. What is left is far smaller.
    pub tolerance: f64,
}

impl ModesOptions {
    /// `count` modes with the default tolerance, 3e-3, which leaves errors of 1e-8 to 1e-5.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { count, tolerance: 3e-3 }
    }
}

/// Which of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Twin {
    /// Equal to its image about the centre line of tooth 0.
    Even,
    /// Opposite to it.
    Odd,
}

/// One mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Symmetry family about mid-face, an index of [`GearBody::families`].
    pub family: usize,
    /// Nodal diameters.
    pub nodal_diameter: u32,
    /// Which of a pair; of single modes, how they behave under the same mirror.
    pub twin: Twin,
    /// Angular frequency (rad/s).
    pub angular_frequency: f64,
    /// `phi^T M r` for [`crate::mass::RigidMotion::ALL`] (sqrt(kg) for translations, sqrt(kg) m for rotations).
    pub rigid_coupling: [f64; 6],
    /// Column of the family's shapes.
    shape: usize,
    /// Of the shape of unit mass per sector.
    scale: f64,
}

impl Mode {
    /// Factors of the even and odd shape on a tooth at `angle` nodal diameters times its place (rad).
    fn factors(&self, angle: f64) -> [f64; 2] {
        let (sine, cosine) = angle.sin_cos();
        let (even, odd) = match self.twin {
            Twin::Even => (cosine, -sine),
            Twin::Odd => (sine, cosine),
        };
        [self.scale * even, self.scale * odd]
    }
}

/// Shapes of one family, even and odd part.
struct FamilyShapes {
    /// Its modes.
    range: Range<usize>,
    basis: FaceBasis,
    /// On the flank: profile function, function along the face by shape.
    flank: [Mat<f64>; 2],
    /// Cuts (lower, upper; local axes) by shape.
    cuts: [Mat<f64>; 2],
    /// Amplitudes of the sector's held fields by shape, and these node fields.
    held: [(Mat<f64>, Mat<f64>); 2],
}

impl FamilyShapes {
    fn layout<'a>(&'a self, sector: &'a ToothSector, family: usize) -> SectorLayout<'a> {
        SectorLayout { shape: &sector.shape, basis: &self.basis, condensed: &sector.families[family].condensed }
    }
}

/// Modes of a gear with its hub held.
pub struct GearModes {
    /// By family, then by frequency.
    pub modes: Vec<Mode>,
    families: Vec<FamilyShapes>,
    teeth: i32,
    side: FlankSide,
    sector: Arc<ToothSector>,
}

impl GearModes {
    /// The lowest modes of a healthy body.
    ///
    /// # Errors
    /// Failed factorisations and eigenvalue iterations; [`FecmError::Option`] for a tolerance out of range and for a bore under tractions, which has
    /// no hub to hold.
    pub fn new(body: &GearBody, options: &ModesOptions) -> Result<Self, FecmError> {
        if body.is_free() {
            let allowed = "RigidHub or ElasticHub: modes with the hub held need a hub";
            return Err(FecmError::Option { name: "bore under tractions", value: 0.0, allowed });
        }
        if !(1e-12..=0.1).contains(&options.tolerance) {
            let (name, value) = ("tolerance of frequencies", options.tolerance);
            return Err(FecmError::Option { name, value, allowed: "1e-12 to 0.1" });
        }
        let sector = Arc::clone(body.healthy_sector());
        let teeth = body.teeth() as u32;
        let mut modes = Self { modes: Vec::new(), families: Vec::new(), teeth: body.teeth(), side: body.side, sector };
        if options.count == 0 {
            return Ok(modes);
        }
        let sector = Arc::clone(&modes.sector);
        let rings = body.families.iter().enumerate().map(|(family, own)| {
            let condensed = &sector.families[family].condensed;
            let layout = SectorLayout { shape: &sector.shape, basis: &own.basis, condensed };
            FamilyRing::new(layout, body.material.density, teeth)
        });
        let mut rings = rings.collect::<Result<Vec<_>, _>>()?;
        let solved = ring::lowest_of_rings(&mut rings, options.count, options.tolerance)?;
        for (family, (ring, solved)) in rings.into_iter().zip(solved).enumerate() {
            modes.add_family(family, ring, &solved);
        }
        Ok(modes)
    }

    /// Adds the modes of one family, each harmonic's list as selected.
    fn add_family(&mut self, family: usize, ring: FamilyRing<'_>, solved: &[HarmonicModes]) {
        let first = self.modes.len();
        let shapes: usize = solved.iter().map(|modes| modes.values.len()).sum();
        let mut halves = [0, 1].map(|half: usize| Mat::<f64>::zeros(ring.halves[half].size(), shapes));
        let rigid = ring.rigid();
        let mut shape = 0;
        for modes in solved {
            for (k, value) in modes.values.iter().enumerate() {
                for (all, own) in halves.iter_mut().zip(&modes.halves) {
                    all.col_as_slice_mut(shape).copy_from_slice(own.col_as_slice(k));
                }
                self.modes.extend(ring.modes_of_shape(&modes.harmonic, &halves, shape, &rigid).map(|mode| Mode {
                    family,
                    angular_frequency: value.sqrt(),
                    ..mode
                }));
                shape += 1;
            }
        }
        self.modes[first..].sort_by(|a, b| {
            let key = |mode: &Mode| (mode.nodal_diameter, mode.shape, mode.twin);
            a.angular_frequency.total_cmp(&b.angular_frequency).then_with(|| key(a).cmp(&key(b)))
        });
        let range = first..self.modes.len();
        self.families.push(ring.shapes(&self.sector, family, range, &halves));
    }

    /// Modes of a symmetry family, as a range of [`Self::modes`].
    #[must_use]
    pub fn of_family(&self, family: usize) -> Range<usize> {
        self.families.get(family).map_or(0..0, |shapes| shapes.range.clone())
    }

    /// Inward normal displacement of the surface by unit modal coordinates (1/sqrt(kg)): one row a mode of the family, one column a function
    /// along the face. `station` is one of the working flank; on the other flank it stands for its mirror image. Its transpose gives
    /// modal forces: `phi^T f` of loads `f` in the same functions.
    #[must_use]
    pub fn at_station(&self, family: usize, tooth: i32, flank: FlankSide, station: &Station) -> Mat<f64> {
        let Some(shapes) = self.families.get(family) else { return Mat::zeros(0, 0) };
        let functions = shapes.basis.plane_degrees().len();
        let at = |part: &Mat<f64>, shape: usize, k: usize| -> f64 {
            let values = part.col_as_slice(shape);
            station.values.iter().enumerate().map(|(m, value)| value * values[m * functions + k]).sum()
        };
        // the mirror turns one flank into the other
        let odd_sign = if flank == self.side { 1.0 } else { -1.0 };
        let modes = &self.modes[shapes.range.clone()];
        let mut result = Mat::zeros(modes.len(), functions);
        for (row, mode) in modes.iter().enumerate() {
            let [even, odd] = mode.factors(self.angle(mode, tooth));
            for k in 0..functions {
                result[(row, k)] =
                    even * at(&shapes.flank[0], mode.shape, k) + odd_sign * odd * at(&shapes.flank[1], mode.shape, k);
            }
        }
        result
    }

    /// What the modes give of the compliance between stations of the working flank (m/N): `sum_k phi_k phi_k^T / omega_k^2`, in the layout of
    /// [`GearBody::compliance`].
    #[must_use]
    pub fn compliance(&self, family: usize, observed: (i32, &[Station]), loaded: (i32, &[Station])) -> Mat<f64> {
        let observed = self.at_stations(family, observed);
        let mut loaded = self.at_stations(family, loaded);
        let range = self.of_family(family);
        for column in 0..loaded.ncols() {
            for (value, mode) in loaded.col_as_slice_mut(column).iter_mut().zip(&self.modes[range.clone()]) {
                *value /= mode.angular_frequency * mode.angular_frequency;
            }
        }
        product(observed.transpose(), loaded.as_ref())
    }

    /// [`Self::at_station`] of several stations of the working flank side by side: `station * functions + function`.
    #[must_use]
    pub fn at_stations(&self, family: usize, (tooth, stations): (i32, &[Station])) -> Mat<f64> {
        let functions = self.families.get(family).map_or(0, |shapes| shapes.basis.plane_degrees().len());
        let mut all = Mat::zeros(self.of_family(family).len(), functions * stations.len());
        for (index, station) in stations.iter().enumerate() {
            let one = self.at_station(family, tooth, self.side, station);
            all.as_mut().subcols_mut(index * functions, functions).copy_from(&one);
        }
        all
    }

    /// Displacement of all nodes of a tooth's sector, in the tooth's frame, by modal coordinates of a family: a node field of
    /// [`crate::mass`] on the healthy sector's mesh.
    #[must_use]
    pub fn sector_field(&self, family: usize, tooth: i32, coordinates: &[f64]) -> Vec<f64> {
        let Some(shapes) = self.families.get(family) else { return Vec::new() };
        let mut amplitudes = [0, 1].map(|half| Mat::<f64>::zeros(shapes.flank[half].ncols(), 1));
        for (mode, coordinate) in self.modes[shapes.range.clone()].iter().zip(coordinates) {
            for (amplitude, factor) in amplitudes.iter_mut().zip(mode.factors(self.angle(mode, tooth))) {
                amplitude[(mode.shape, 0)] += factor * coordinate;
            }
        }
        let layout = shapes.layout(&self.sector, family);
        let mut cuts = Mat::zeros(layout.condensed.stiffness().nrows(), 1);
        for (own, amplitude) in shapes.cuts.iter().zip(&amplitudes) {
            cuts += product(own.as_ref(), amplitude.as_ref());
        }
        let mut fields = layout.fields_of_cuts(&cuts);
        for ((held, modes), amplitude) in shapes.held.iter().zip(&amplitudes) {
            fields += product(modes.as_ref(), product(held.as_ref(), amplitude.as_ref()).as_ref());
        }
        fields.col_as_slice(0).to_vec()
    }

    /// Coordinates of the same motion with teeth counted from another one: tooth `k` under the result moves as tooth `k + tooth` under
    /// `coordinates`. Twins turn into each other like the components of a vector, so of modal forces the same holds, and `-tooth` leads back.
    #[must_use]
    pub fn seen_from(&self, tooth: i32, coordinates: &[f64]) -> Vec<f64> {
        let mut seen = Vec::with_capacity(coordinates.len());
        for (k, (mode, &own)) in self.modes.iter().zip(coordinates).enumerate() {
            let (sine, cosine) = self.angle(mode, tooth).sin_cos();
            // sorted by frequency, diameters and shape, twins stand side by side, the even one first
            let twin = match mode.twin {
                Twin::Even => k + 1,
                Twin::Odd => k.wrapping_sub(1),
            };
            let is_twin = |other: &&Mode| {
                let key = |mode: &Mode| (mode.family, mode.nodal_diameter, mode.shape);
                key(other) == key(mode) && other.twin != mode.twin
            };
            let other = match self.modes.get(twin).filter(is_twin) {
                Some(_) => coordinates.get(twin).copied().unwrap_or(0.0),
                None => 0.0,
            };
            let sign = if mode.twin == Twin::Even { 1.0 } else { -1.0 };
            seen.push(cosine * own + sign * sine * other);
        }
        seen
    }

    fn angle(&self, mode: &Mode, tooth: i32) -> f64 {
        // whole turns out first: rounding must not grow with the tooth number
        let steps = (i64::from(mode.nodal_diameter) * i64::from(tooth)).rem_euclid(i64::from(self.teeth));
        2.0 * std::f64::consts::PI * steps as f64 / f64::from(self.teeth)
    }
}
