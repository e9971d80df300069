//! What a static analysis needs besides the geometry.

use gear_geom::{Damage, ToothDamage};

use crate::body::BoreCondition;
use crate::error::FecmError;
use crate::face::FaceModel;
use crate::lcp::SolverKind;
use crate::material::Material;
use crate::mesh::MeshDensity;

/// One gear of the pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemberOptions {
    /// Material.
    pub material: Material,
    /// Mesh of the tooth sector.
    pub mesh: MeshDensity,
    /// What holds the bore.
    pub bore: BoreCondition,
}

impl Default for MemberOptions {
    fn default() -> Self {
        Self { material: Material::STEEL, mesh: MeshDensity::default(), bore: BoreCondition::RigidHub }
    }
}

/// Contact grid and its near field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactOptions {
    /// Cells per Hertz half width along the profile, 1 to 100. The half width is that of all the load on one pair.
    pub cells_per_half_width: f64,
    /// Cells along the whole face, 1 to 400. Plane models have one.
    pub face_cells: usize,
    /// Highest degree of the polynomials along the profile in which the finite elements complete the half-space, 2 to 24.
    pub profile_order: usize,
    /// Whether mirror loads correct the near field at the free ends of the face.
    pub edge_correction: bool,
    /// Relative change of torque for the local slope by differences, 1e-4 to 0.3. Cells join a growing contact one by one, so the tangent and
    /// small differences see a stair; a difference that moves the contact's edge by a cell or so sees the slope. For the crowned pair of the
    /// work-precision study, 8 cells a half width: the tangent errs by 0.8 %, 1 % of torque by 0.7 %, 10 % by 0.3 %; what the curvature
    /// of the force-deflection curve costs at 10 % is `0.1^2 / 27`, 0.04 %.
    pub slope_step: f64,
    /// Whether faces of cracks that close press on each other; otherwise they pass through each other freely.
    pub crack_face_contact: bool,
    /// Solver of the contact problem.
    pub solver: SolverKind,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self {
            cells_per_half_width: 8.0,
            face_cells: 48,
            profile_order: 8,
            edge_correction: true,
            slope_step: 0.1,
            crack_face_contact: true,
            solver: SolverKind::default(),
        }
    }
}

/// Options of a [`super::PairModel`].
#[derive(Debug, Clone, PartialEq)]
pub struct PairModelOptions {
    /// Behaviour along the face.
    pub face: FaceModel,
    /// Driving gear.
    pub pinion: MemberOptions,
    /// Driven gear.
    pub wheel: MemberOptions,
    /// Contact.
    pub contact: ContactOptions,
    /// Damaged teeth of the driving and of the driven gear. Tooth 0 belongs to tooth pair 0.
    pub damage: [Vec<ToothDamage>; 2],
}

impl Default for PairModelOptions {
    fn default() -> Self {
        Self {
            face: FaceModel::Solid { order: 6 },
            pinion: MemberOptions::default(),
            wheel: MemberOptions::default(),
            contact: ContactOptions::default(),
            damage: [Vec::new(), Vec::new()],
        }
    }
}

impl PairModelOptions {
    /// Options of the pinion (0) or wheel (1).
    #[must_use]
    pub fn member(&self, index: usize) -> &MemberOptions {
        if index == 0 { &self.pinion } else { &self.wheel }
    }

    /// Whether all damage is its own image about mid-face.
    #[must_use]
    pub fn damage_is_symmetric(&self) -> bool {
        self.damage.iter().flatten().all(|damage| damage.damage.is_symmetric())
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`FecmError::Option`] for the first option out of range.
    pub fn validate(&self) -> Result<(), FecmError> {
        for member in [&self.pinion, &self.wheel] {
            member.material.validate()?;
            member.mesh.validate()?;
        }
        for one in self.damage.iter().flatten() {
            if matches!(&one.damage, Damage::Pit(pit) if !pit.is_finite()) {
                let allowed = "finite place, sizes and depth";
                return Err(FecmError::Option { name: "pit on tooth", value: one.tooth as f64, allowed });
            }
        }
        let contact = &self.contact;
        let order = match self.face {
            FaceModel::Solid { order } => order,
            _ => 1,
        };
        let checks = [
            ("face order", order as f64, 1.0, 40.0, "1 to 40"),
            ("cells per half width", contact.cells_per_half_width, 1.0, 100.0, "1 to 100"),
            ("face cells", contact.face_cells as f64, 1.0, 400.0, "1 to 400"),
            ("slope step", contact.slope_step, 1e-4, 0.3, "1e-4 to 0.3 of the torque"),
            ("profile order", contact.profile_order as f64, 2.0, 24.0, "2 to 24"),
        ];
        for (name, value, low, high, allowed) in checks {
            if !(low..=high).contains(&value) {
                return Err(FecmError::Option { name, value, allowed });
            }
        }
        Ok(())
    }
}
