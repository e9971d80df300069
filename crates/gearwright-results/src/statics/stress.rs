//! Root stresses, stress-intensity factors and forces between crack faces of a series: columns of its table, a table along crack fronts, extremes.

use std::collections::BTreeSet;

use fecm::FecmError;
use fecm::statics::{CrackTip, PairModel, PositionResult, RootStress};
use serde::Serialize;

/// What is read from the stresses of every position of a series.
#[derive(Default)]
pub struct Stresses {
    /// Root stresses; empty unless asked for.
    pub roots: Vec<Vec<RootStress>>,
    /// Crack tips; empty without cracks.
    pub tips: Vec<Vec<CrackTip>>,
    /// Member, tooth and force (N) of the cracks whose faces press on each other, by position.
    pub faces: Vec<Vec<(usize, i32, f64)>>,
}

/// Largest root stress of a gear.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LargestRoot {
    /// Stress along the profile's tangent (MPa), negative in compression.
    pub stress_mpa: f64,
    /// Mesh cycle.
    pub at: f64,
    /// Tooth pair.
    pub pair: i32,
    /// Angle between the tangent and the tooth's centre line (deg).
    pub tangent_angle_deg: f64,
    /// Face position (mm).
    pub face_mm: f64,
}

/// Names of the gears in columns.
pub(super) const GEARS: [&str; 2] = ["pinion", "gear"];
/// Pa sqrt(m) to MPa sqrt(m).
const MEGA: f64 = 1e-6;

impl Stresses {
    /// Reads a series whose pressures were kept.
    ///
    /// # Errors
    /// Those of the readers.
    pub fn of(model: &PairModel, series: &[PositionResult], roots: bool) -> Result<Self, FecmError> {
        let roots = if roots { model.root_stress_reader().read_all(series)? } else { Vec::new() };
        let tips = model.crack_tip_reader();
        let tips = if tips.is_empty() { Vec::new() } else { tips.read_all(series)? };
        let of = |position: &PositionResult| {
            position.crack_faces.iter().map(|faces| (faces.member, faces.tooth, faces.total_force())).collect()
        };
        Ok(Self { roots, tips, faces: series.iter().map(of).collect() })
    }

    /// Largest tension (0) or compression (1) at the roots of the pinion (0) or gear (1) over the positions; `origin` is added to mesh cycles.
    #[must_use]
    pub fn largest_root(
        &self,
        series: &[PositionResult],
        member: usize,
        side: usize,
        origin: f64,
    ) -> Option<LargestRoot> {
        let usable = series.iter().zip(&self.roots).filter(|(position, _)| position.status.is_usable());
        let all = usable.flat_map(|(position, roots)| roots.iter().map(|root| (position.mesh_cycle + origin, root)));
        let peaks = all.filter(|(_, root)| root.member == member).map(|(at, root)| {
            let peak = if side == 0 { root.tension } else { root.compression };
            LargestRoot {
                stress_mpa: peak.stress * MEGA,
                at,
                pair: root.pair,
                tangent_angle_deg: peak.tangent_angle.to_degrees(),
                face_mm: peak.face * 1e3,
            }
        });
        peaks.max_by(|a, b| a.stress_mpa.abs().total_cmp(&b.stress_mpa.abs()))
    }

    /// Largest `K_I` over positions and along the fronts (MPa sqrt(m)).
    #[must_use]
    pub fn largest_k_one(&self) -> Option<f64> {
        self.tips.iter().flatten().map(|tip| tip.k_one * MEGA).max_by(f64::total_cmp)
    }

    /// Largest magnitude of `K_II` over positions and along the fronts (MPa sqrt(m)).
    #[must_use]
    pub fn largest_k_two(&self) -> Option<f64> {
        self.tips.iter().flatten().map(|tip| tip.k_two.abs() * MEGA).max_by(f64::total_cmp)
    }

    /// Largest force between the faces of a crack (N), `None` if none close.
    #[must_use]
    pub fn largest_face_force(&self) -> Option<f64> {
        self.faces.iter().flatten().map(|(_, _, force)| *force).max_by(f64::total_cmp)
    }

    /// Largest `K_I` along the fronts at a position (MPa sqrt(m)).
    #[must_use]
    pub fn k_one(&self, position: usize) -> Option<f64> {
        self.tips.get(position)?.iter().map(|tip| tip.k_one * MEGA).max_by(f64::total_cmp)
    }

    /// Tension at the root of a gear's tooth at a position (MPa), if it is loaded.
    #[must_use]
    pub fn tension(&self, position: usize, member: usize, pair: i32) -> Option<f64> {
        let root = self.roots.get(position)?.iter().find(|root| root.member == member && root.pair == pair)?;
        Some(root.tension.stress * MEGA)
    }

    /// Teeth with cracks: member and tooth.
    pub(super) fn cracked(&self) -> BTreeSet<(usize, i32)> {
        self.tips.iter().flatten().map(|tip| (tip.member, tip.tooth)).collect()
    }

    /// Teeth with cracks whose faces press on each other somewhere.
    pub(super) fn closing(&self) -> BTreeSet<(usize, i32)> {
        self.faces.iter().flatten().map(|&(member, tooth, _)| (member, tooth)).collect()
    }
}
