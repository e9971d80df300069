//! Mesh of one tooth sector: the tooth, the body below it and half a root land on either side, between two radial cuts; how it is laid out is
//! told in `sector_blocks`.

use gear_geom::{FlankSide, Gear, RootCrack};

use super::plane::PlaneMesh;
use super::sector_blocks::SectorBuilder;
use crate::condense::{RichNode, Substructure};
use crate::element::ReferenceQuad;
use crate::error::FecmError;

/// How finely a sector is meshed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshDensity {
    /// Polynomial order of the elements in the plane, 1 to 8.
    pub order: usize,
    /// Scales the number of elements along every edge; 1 is the default mesh.
    pub density: f64,
}

impl Default for MeshDensity {
    fn default() -> Self {
        Self { order: 3, density: 1.0 }
    }
}

impl MeshDensity {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`FecmError::Option`].
    pub fn validate(&self) -> Result<(), FecmError> {
        if !(1..=8).contains(&self.order) {
            let value = self.order as f64;
            return Err(FecmError::Option { name: "element order", value, allowed: "1 to 8" });
        }
        if !(0.2..=10.0).contains(&self.density) {
            let value = self.density;
            return Err(FecmError::Option { name: "mesh density", value, allowed: "0.2 to 10" });
        }
        Ok(())
    }

    /// Elements where the default mesh has `base`.
    pub(super) fn count(&self, base: f64) -> usize {
        ((base * self.density).round() as usize).max(1)
    }
}

/// Mesh edges along the involute part of one flank, from the fillet to the tip.
#[derive(Debug, Clone)]
pub struct FlankEdge {
    /// Nodes of each element edge, `order + 1` each.
    pub edges: Vec<Vec<u32>>,
    /// Involute arc length from the base circle, `s^2 / (2 r_b)` (m), at the ends of the element edges.
    pub arc_breaks: Vec<f64>,
}

/// Mesh of one sector `-pi/N <= theta <= pi/N`, tooth centred on the x axis.
#[derive(Debug, Clone)]
pub struct SectorMesh {
    /// The plane mesh.
    pub mesh: PlaneMesh,
    /// Angle of the sector (rad).
    pub sector_angle: f64,
    /// Nodes on the cut at `-sector_angle / 2`, from the rim to the root.
    pub lower_cut: Vec<u32>,
    /// Nodes on the cut at `+sector_angle / 2`, matching those of the lower cut.
    pub upper_cut: Vec<u32>,
    /// Nodes of the element edges on the rim (bore, or outside of a ring).
    pub rim: Vec<Vec<u32>>,
    /// Working flanks: lower (`theta < 0`), upper.
    pub flanks: [FlankEdge; 2],
    /// Elements of the tooth block.
    pub tooth_elements: Vec<u32>,
    /// Root crack, if the tooth has one.
    pub crack: Option<CrackFaces>,
}

/// The two faces of a crack in the mesh.
#[derive(Debug, Clone)]
pub struct CrackFaces {
    /// Nodes from the mouth to the tip, on the face toward the tooth and on the face toward the body; both end in the same tip node.
    pub nodes: [Vec<u32>; 2],
    /// Length along the path (m).
    pub length: f64,
    /// Length of the whole chord from fillet to fillet (m).
    pub chord: f64,
    /// Where the length varies along the face: the nodes around the crack, with the functions along the face that they have of their own; those on
    /// the face toward the tooth follow those on the other. Empty for a through crack.
    pub rich: Vec<RichNode>,
}
impl SectorMesh {
    /// Meshes the sector of a gear; `body` names it in errors.
    ///
    /// # Errors
    /// [`FecmError::Option`] for densities out of range, [`FecmError::InvertedElement`] when the blocks do not fit the tooth form.
    pub fn new(gear: &Gear, density: &MeshDensity, body: &'static str) -> Result<Self, FecmError> {
        Self::with_crack(gear, density, None, body)
    }

    /// Meshes a sector whose tooth may have a root crack, along the crack's path.
    ///
    /// # Errors
    /// As [`Self::new`]; [`FecmError::Crack`] for a crack that does not start on the fillet or leaves the tooth.
    pub fn with_crack(
        gear: &Gear,
        density: &MeshDensity,
        crack: Option<&RootCrack>,
        body: &'static str,
    ) -> Result<Self, FecmError> {
        density.validate()?;
        let crack = crack.filter(|crack| !crack.is_empty());
        let sector = SectorBuilder::new(gear, density, crack).build()?;
        sector.mesh.check(&ReferenceQuad::new(density.order), body)?;
        Ok(sector)
    }

    /// The sector as a body to condense onto its cuts (lower, then upper; radial and tangential axes). The rim is on springs of a
    /// stiffness per area (N/m^3), or held where there are none.
    #[must_use]
    pub fn substructure(&self, springs: Option<f64>) -> Substructure<'_> {
        let half = 0.5 * self.sector_angle;
        let lower = self.lower_cut.iter().map(|&node| (node, -half));
        let upper = self.upper_cut.iter().map(|&node| (node, half));
        Substructure {
            mesh: &self.mesh,
            retained: lower.chain(upper).collect(),
            fixed: if springs.is_none() { self.rim.concat() } else { Vec::new() },
            springs: springs.map(|stiffness| (stiffness, self.rim.as_slice())),
            rich: self.crack.as_ref().map_or(&[], |crack| crack.rich.as_slice()),
        }
    }

    /// Edge of one flank.
    #[must_use]
    pub fn flank(&self, side: FlankSide) -> &FlankEdge {
        match side {
            FlankSide::Lower => &self.flanks[0],
            FlankSide::Upper => &self.flanks[1],
        }
    }
}
