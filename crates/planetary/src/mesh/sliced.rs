//! A mesh of inclined teeth as slices along the face, each with the law of a straight tooth.
//!
//! A slice a distance `y` from mid-face meets `phase(y)` of a cycle ahead, and its flanks stand back by a gap (crowning). With teeth inclined by the base
//! angle `b_b`, an approach `x` along the normal of the teeth is one of `x / cos(b_b)` in the transverse section, and a force `F_t` there is one of
//! `F_t / cos(b_b)` along the normal (the work is the same), so
//!
//! `F(m, x) = sum_i w_i F_t(m + phase_i, x / cos(b_b) - gap_i) / cos(b_b)`, `sum w_i` about 1.
//!
//! Slices are sheets that do not hold each other (the thin-slice model of helical gears; J. D. Smith, *Gear Noise and Vibration*, 2003): the law is that of plane
//! strain, which is what neighbours do to a slice across the face; that they also carry part of its load is left out.
//!
//! **Spiral bevel gears** ([`SlicedMesh::bevel`]): virtual spur gears by Tredgold; slices a distance `y` outward are larger by `l = 1 + y / R_m` in every length. A
//! plane law scales with them, `l F(x / l)` for a unit of face, a rotation closes them by `l x`, and their force has an arm larger by `l`:
//! the weight of a slice is `l^2` of its part of the face. Crowning is a parabola from mid-face to the ends.

use std::sync::Arc;

use fecm::{FaceModel, Observer, PairModel, PairModelOptions};
use gear_geom::BevelPair;
use serde::{Deserialize, Serialize};

use super::contact::TableOptions;
use super::error::MeshError;
use super::law::{MeshLaw, MeshResponse};
use super::table::MeshTable;

/// A slice.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Slice {
    /// Mesh cycles by which it is ahead.
    pub phase: f64,
    /// By how much its flanks stand back, along the line of action in the transverse section (m), 0 or more.
    pub gap: f64,
    /// Its part of the force of a mesh with this law over the whole face.
    pub weight: f64,
}

/// Inclined teeth, by slices.
#[derive(Debug, Clone)]
pub struct SlicedMesh {
    law: Arc<dyn MeshLaw>,
    slices: Vec<Slice>,
    base_angle_cosine: f64,
}

/// Slices of a bevel mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BevelSlices {
    /// How many, 1 to 1000. Where crowning parts the ends of the face, stiffness changes slice by slice; force converges with the square of their number.
    pub count: usize,
    /// Crowning: by how much both ends of the face stand back, both flanks together, along the transverse line of action (m), 0 or more.
    pub crown: f64,
}

impl SlicedMesh {
    /// From the law of straight teeth over the whole face, slices, and the angle of the teeth on the base cylinder or cone (rad).
    ///
    /// # Errors
    /// [`MeshError::Option`] without slices, for numbers out of range.
    pub fn new(law: Arc<dyn MeshLaw>, slices: Vec<Slice>, base_angle: f64) -> Result<Self, MeshError> {
        let most = 75_f64.to_radians();
        let number_of_slices = slices.len() as f64;
        let least_gap = slices.iter().map(|slice| slice.gap).fold(0.0, f64::min);
        let least_weight = slices.iter().map(|slice| slice.weight).fold(f64::INFINITY, f64::min);
        let sum: f64 = slices.iter().map(|slice| slice.phase + slice.gap + slice.weight).sum();
        for (name, value, is_allowed, allowed) in [
            ("slices", number_of_slices, (1.0..=1e3).contains(&number_of_slices), "1 to 1000"),
            ("base angle", base_angle, base_angle.abs() <= most, "-75 to 75 degrees, in rad"),
            ("gap of a slice", least_gap, least_gap == 0.0, "0 or more, in m"),
            ("weight of a slice", least_weight, least_weight > 0.0, "above 0"),
            ("phases, gaps and weights in sum", sum, sum.is_finite(), "finite numbers"),
        ] {
            if !is_allowed {
                return Err(MeshError::Option { name, value, allowed });
            }
        }
        Ok(Self { law, slices, base_angle_cosine: base_angle.cos() })
    }

    /// A spiral bevel mesh with the law of its virtual spur gears over the whole face ([`virtual_table`]).
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn bevel(pair: &BevelPair, law: Arc<dyn MeshLaw>, slices: &BevelSlices) -> Result<Self, MeshError> {
        let &BevelSlices { count, crown } = slices;
        let checks = [("slices", count as f64, 1.0, 1e3, "1 to 1000"), ("crown", crown, 0.0, 1e-2, "0 to 0.01 m")];
        for (name, value, low, high, allowed) in checks {
            if !(low..=high).contains(&value) {
                return Err(MeshError::Option { name, value, allowed });
            }
        }
        let cone = pair.mean_cone_distance();
        let slice = |i: usize| {
            let along = (2.0 * i as f64 + 1.0) / count as f64 - 1.0;
            let y = 0.5 * along * pair.spec().facewidth;
            let scale = 1.0 + y / cone;
            let (phase, gap) = (pair.phase_along_face(y), crown * along * along);
            Slice { phase, gap, weight: scale * scale / count as f64 }
        };
        Self::new(law, (0..count).map(slice).collect(), pair.base_spiral_angle())
    }

    /// The slices.
    #[must_use]
    pub fn slices(&self) -> &[Slice] {
        &self.slices
    }
}

impl MeshLaw for SlicedMesh {
    fn response(&self, mesh_cycle: f64, approach: f64) -> MeshResponse {
        let cosine = self.base_angle_cosine;
        let mut sum = MeshResponse::default();
        for slice in &self.slices {
            let own = self.law.response(mesh_cycle + slice.phase, approach / cosine - slice.gap);
            sum.force += slice.weight * own.force;
            sum.stiffness += slice.weight * own.stiffness;
        }
        MeshResponse { force: sum.force / cosine, stiffness: sum.stiffness / (cosine * cosine) }
    }
}

/// Table of the virtual spur gears of a bevel pair, plane strain, steel. `highest_force` of the options is that of the whole face.
///
/// # Errors
/// Tooth forms that cannot be; as [`MeshTable::from_contact`].
pub fn virtual_table(
    pair: &BevelPair,
    options: &TableOptions,
    observer: &dyn Observer,
) -> Result<MeshTable, MeshError> {
    let gears = pair.virtual_pair()?;
    let face = PairModelOptions { face: FaceModel::PlaneStrain, ..PairModelOptions::default() };
    MeshTable::from_contact(&PairModel::new(&gears, &face)?, options, observer)
}
