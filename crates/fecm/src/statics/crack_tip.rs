//! Stress-intensity factors of cracked teeth over the mesh cycle ([`crate::fracture`]).
//!
//! In three dimensions the factors are those of places along the crack front, with plane strain at the tip; at the ends of the face, where that is not
//! the state of the tip, they lose their meaning within a distance of the order of the zone's radius.

use rayon::prelude::*;

use super::model::PairModel;
use super::reading::SectorReading;
use super::result::PositionResult;
use super::root_stress::face_positions;
use crate::error::FecmError;
use crate::fracture::{CrackTipZone, ZONE};
use crate::functional::Functional;

/// Stress-intensity factors at one place of a crack front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrackTip {
    /// Pinion (0) or wheel (1).
    pub member: usize,
    /// Tooth number in `0..teeth`.
    pub tooth: i32,
    /// Face position (m, 0 at mid-face).
    pub face: f64,
    /// Opening (Pa sqrt(m)), positive when the faces part.
    pub k_one: f64,
    /// Sliding (Pa sqrt(m)), in the frame of [`crate::fracture`].
    pub k_two: f64,
}

impl CrackTip {
    /// Energy release rate `(K_I^2 + K_II^2) / E'` (J/m^2), `E' = plane_modulus` in Pa.
    #[must_use]
    pub fn release_rate(&self, plane_modulus: f64) -> f64 {
        (self.k_one.powi(2) + self.k_two.powi(2)) / plane_modulus
    }
}

/// Reads the crack tips of a pair's positions.
pub struct CrackTipReader<'a> {
    model: &'a PairModel,
    cracks: Vec<CrackReading>,
}

struct CrackReading {
    member: usize,
    tooth: i32,
    faces: Vec<f64>,
    reading: SectorReading,
}

impl PairModel {
    /// Prepares all cracks of both gears for reading; there may be none.
    #[must_use]
    pub fn crack_tip_reader(&self) -> CrackTipReader<'_> {
        let mut cracks = Vec::new();
        for (member, body) in self.bodies.iter().enumerate() {
            let faces = face_positions(self, body);
            for tooth in body.damaged_teeth() {
                let sector = body.sector(tooth);
                let Some(crack) = &sector.shape.crack else { continue };
                let sides = [crack.nodes[0].as_slice(), crack.nodes[1].as_slice()];
                let Some(zone) = CrackTipZone::new(&sector.shape.mesh, sides, ZONE) else { continue };
                let of_family = |family: &crate::body::Family| -> Vec<Functional> {
                    let factors = zone.intensities(&family.basis);
                    faces.iter().flat_map(|&z| factors.each_ref().map(|factor| factor.at(&family.basis, z))).collect()
                };
                let functionals: Vec<_> = body.families.iter().map(of_family).collect();
                let reading = SectorReading::new(body, sector, &functionals);
                cracks.push(CrackReading { member, tooth, faces: faces.clone(), reading });
            }
        }
        CrackTipReader { model: self, cracks }
    }
}

impl CrackTipReader<'_> {
    /// Whether there is nothing to read.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cracks.is_empty()
    }

    /// Factors at all fronts, crack by crack and along the face, at a position whose pressures were kept.
    ///
    /// # Errors
    /// Those of finding the loaded places in the mesh.
    pub fn read(&self, position: &PositionResult) -> Result<Vec<CrackTip>, FecmError> {
        let mut tips = Vec::new();
        for crack in &self.cracks {
            let (member, tooth) = (crack.member, crack.tooth);
            let loads = self.model.tooth_loads(position, member)?;
            let values = crack.reading.values(&self.model.bodies[member], tooth, &loads, self.model.reach(member));
            tips.extend(crack.faces.iter().zip(values.chunks_exact(2)).map(|(&face, factors)| CrackTip {
                member,
                tooth,
                face,
                k_one: factors[0],
                k_two: factors[1],
            }));
        }
        Ok(tips)
    }

    /// Factors of many positions, in parallel.
    ///
    /// # Errors
    /// The first error in the order of positions.
    pub fn read_all(&self, positions: &[PositionResult]) -> Result<Vec<Vec<CrackTip>>, FecmError> {
        let all: Vec<Result<_, FecmError>> = positions.par_iter().map(|position| self.read(position)).collect();
        all.into_iter().collect()
    }
}
