//! Stress-intensity factors of cracked teeth over the mesh cycle ([`crate::fracture`]).
//!
//! Cracks of one length along the face only. In three dimensions the factors are those of places along the crack front, with plane strain at the tip; at the ends of the face, where that is not
//! the state of the tip, they lose their meaning within a distance of the order of the zone's radius. A crack whose faces press on each other up to the tip
//! has no `K_I`; what is left of it is the error of the pressure's concentration in nodes.

use rayon::prelude::*;

use super::crack_contact::CrackFaceContact;
use super::model::PairModel;
use super::reading::SectorReading;
use super::result::PositionResult;
use super::root_stress::face_positions;
use crate::body::{Family, GearBody};
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
    zone: CrackTipZone,
    reading: SectorReading,
}

impl PairModel {
    /// Prepares all through cracks of both gears for reading; there may be none.
    #[must_use]
    pub fn crack_tip_reader(&self) -> CrackTipReader<'_> {
        let mut cracks = Vec::new();
        for (member, body) in self.bodies.iter().enumerate() {
            let faces = face_positions(self, body);
            for tooth in body.damaged_teeth() {
                let sector = body.sector(tooth);
                // the zone of a reading is a cylinder along the face: a front that slants has none
                let Some(crack) = sector.shape.crack.as_ref().filter(|crack| crack.rich.is_empty()) else { continue };
                let sides = [crack.nodes[0].as_slice(), crack.nodes[1].as_slice()];
                let Some(zone) = CrackTipZone::new(&sector.shape.mesh, sides, ZONE) else { continue };
                let of_family = |family: &Family| -> Vec<Functional> {
                    let factors = zone.intensities(&family.basis);
                    faces.iter().flat_map(|&z| factors.each_ref().map(|factor| factor.at(&family.basis, z))).collect()
                };
                let functionals: Vec<_> = body.families.iter().map(of_family).collect();
                let reading = SectorReading::new(
                    body,
                    sector,
                    &functionals,
                    self.crack_on(member, tooth).map(|crack| &crack.openings[..]),
                );
                cracks.push(CrackReading { member, tooth, faces: faces.clone(), zone, reading });
            }
        }
        CrackTipReader { model: self, cracks }
    }
}

/// Force per width (N/m) at face position `z` of forces (N) at places of the face: their expansion in the functions along it.
fn line_load(body: &GearBody, places: &[f64], forces: &[f64], z: f64) -> f64 {
    let of_family = |family: &Family| -> f64 {
        let mut modal = vec![0.0; family.basis.plane_degrees().len()];
        for (&place, force) in places.iter().zip(forces) {
            modal.iter_mut().zip(family.basis.plane_values(place)).for_each(|(sum, value)| *sum += value * force);
        }
        let at = family.basis.plane_values(z).into_iter().zip(family.basis.plane_norms());
        at.zip(modal).map(|((value, norm), sum)| value * sum / norm).sum()
    };
    body.families.iter().map(of_family).sum()
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
            let mut values = crack.reading.values(&self.model.bodies[member], tooth, &loads, self.model.reach(member));
            self.add_face_loads(crack, position, &mut values);
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

    /// Adds what faces that press on each other have of the factors.
    fn add_face_loads(&self, crack: &CrackReading, position: &PositionResult, values: &mut [f64]) {
        let is_here = |contact: &&CrackFaceContact| contact.member == crack.member && contact.tooth == crack.tooth;
        let contact = position.crack_faces.iter().find(is_here);
        let faces = self.model.crack_on(crack.member, crack.tooth);
        let (Some(contact), Some(faces)) = (contact, faces) else { return };
        let body = &self.model.bodies[crack.member];
        let mesh = &body.sector(crack.tooth).shape.mesh;
        for (row, forces) in contact.force.iter().enumerate() {
            let (nodes, normal) = faces.cells.row(row);
            let place = mesh.nodes[nodes[0] as usize];
            for (&z, values) in crack.faces.iter().zip(values.chunks_exact_mut(2)) {
                let on_tooth = normal * line_load(body, &contact.face, forces, z);
                for (side, force) in [on_tooth, -on_tooth].into_iter().enumerate() {
                    let part = crack.zone.of_face_force(&body.families[0].basis, side, place, force);
                    values.iter_mut().zip(part).for_each(|(value, part)| *value += part);
                }
            }
        }
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
