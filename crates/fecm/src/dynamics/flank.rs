//! What elastic modes do to the flanks: openings of contact cells by unit modal coordinates.

use faer::Mat;

use crate::error::FecmError;
use crate::linalg::{add_product, column_slice_mut};
use crate::modes::{GearModes, ModesOptions};
use crate::statics::{PairModel, Settled};

/// Modes of both gears.
pub(super) struct PairModes {
    gears: [GearModes; 2],
}

impl PairModes {
    /// The lowest `counts` modes of each gear; both gears at once.
    pub fn new(model: &PairModel, counts: [usize; 2]) -> Result<Self, FecmError> {
        let make = |index: usize| GearModes::new(&model.bodies()[index], &ModesOptions::new(counts[index]));
        let (pinion, wheel) = rayon::join(|| make(0), || make(1));
        Ok(Self { gears: [pinion?, wheel?] })
    }

    /// Modes of the pinion (0) or wheel (1).
    pub fn of(&self, body: usize) -> &GearModes {
        &self.gears[body]
    }

    /// Modal coordinates or forces of both gears with teeth counted from those `pairs` tooth pairs further on: [`GearModes::seen_from`].
    pub fn seen_from(&self, pairs: i32, tooth_steps: [i32; 2], coordinates: &[f64]) -> Vec<f64> {
        let (pinion, wheel) = coordinates.split_at(self.gears[0].modes.len().min(coordinates.len()));
        let of = |index: usize, own: &[f64]| self.gears[index].seen_from(pairs * tooth_steps[index], own);
        [of(0, pinion), of(1, wheel)].concat()
    }

    /// Opening of every cell of a position by unit modal coordinates, cells x modes (pinion's, then wheel's): a flank that moves inward opens.
    pub fn openings(&self, settled: &Settled, model: &PairModel) -> Mat<f64> {
        let grid = &settled.grid;
        let columns = grid.face.centres.len();
        let count = self.gears.iter().map(|gear| gear.modes.len()).sum();
        let mut openings = Mat::zeros(grid.size(), count);
        let mut first_mode = 0;
        for (index, gear) in self.gears.iter().enumerate() {
            let body = &model.bodies()[index];
            let step = model.pairing().tooth_steps()[index];
            for (family, own) in body.families.iter().enumerate() {
                let values: Vec<Vec<f64>> = grid.face.centres.iter().map(|&z| own.basis.plane_values(z)).collect();
                let functions = own.basis.plane_degrees().len();
                let modes = gear.of_family(family);
                let mut first_cell = 0;
                for pair in &grid.pairs {
                    let rolls = pair.rows.iter().map(|row| if index == 0 { row.pinion_roll } else { row.wheel_roll });
                    // modes are those of healthy teeth
                    let stations: Vec<_> = rolls.map(|roll| body.healthy_sector().station(roll)).collect();
                    let inward = gear.at_stations(family, (pair.pair * step, &stations));
                    for (row_of_mode, mode) in modes.clone().enumerate() {
                        let target = column_slice_mut(&mut openings, first_mode + mode);
                        for row in 0..pair.rows.len() {
                            for (column, psi) in values.iter().enumerate() {
                                let at = (0..functions).map(|k| inward[(row_of_mode, row * functions + k)] * psi[k]);
                                target[first_cell + row * columns + column] += at.sum::<f64>();
                            }
                        }
                    }
                    first_cell += pair.rows.len() * columns;
                }
            }
            first_mode += gear.modes.len();
        }
        openings
    }
}

/// `phi diag(weights) phi^T` subtracted from `compliance`.
pub(super) fn take_out(compliance: &mut Mat<f64>, phi: &Mat<f64>, weights: impl Iterator<Item = f64>) {
    let mut scaled = phi.clone();
    for (k, weight) in weights.enumerate() {
        column_slice_mut(&mut scaled, k).iter_mut().for_each(|value| *value *= weight);
    }
    add_product(compliance.as_mut(), -1.0, scaled.as_ref(), phi.transpose());
}

#[cfg(test)]
mod tests {
    use gear_geom::{Gear, GearPair, GearSpec, Member, ToothThickness};
    use nalgebra::Rotation2;

    use super::*;
    use crate::statics::PairModelOptions;
    use crate::{FaceModel, MeshDensity};

    fn gear(teeth: u32) -> Gear {
        let module = 6e-3;
        let thickness = ToothThickness::AtReference(0.5 * std::f64::consts::PI * module - 0.05e-3);
        let spec = GearSpec::standard(teeth, module).with(|spec| {
            spec.thickness = thickness;
            spec.facewidth = 16e-3;
        });
        Gear::new(&spec).unwrap()
    }

    /// The tooth of each gear whose flank is at the contact: of all pairs of teeth the one whose flank points lie together in space.
    fn teeth_in_mesh(model: &PairModel, mesh_cycle: f64, rolls: [f64; 2]) -> [i32; 2] {
        let pair = model.pairing().pair();
        let points = |index: usize| {
            let (gear, member) = (model.pairing().gear(index), [Member::Pinion, Member::Wheel][index]);
            let flank = gear.flank_point(model.pairing().side(index), rolls[index]).coords;
            let sector = model.bodies()[index].sector_angle();
            (0..gear.teeth() as i32).map(move |tooth| {
                let turn = Rotation2::new(pair.tooth_angle(member, 0, mesh_cycle) + sector * f64::from(tooth));
                (tooth, pair.centre(member) + turn * flank)
            })
        };
        let both = points(0).flat_map(|one| points(1).map(move |other| ((one.1 - other.1).norm(), one.0, other.0)));
        let (apart, pinion, wheel) = both.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        assert!(apart < 0.1 * pair.base_pitch(), "{apart}");
        [pinion, wheel]
    }

    /// Openings are displacements of the teeth that geometry finds in mesh. Motion alone cannot show a tooth number that is off by a constant: the
    /// modes of a healthy gear look alike from every tooth, their coordinates only turn into each other.
    #[test]
    fn invariant_openings_are_those_of_the_teeth_in_mesh() {
        let pair = GearPair::new(gear(19), gear(23), 3e-3 * 42.0).unwrap();
        let mut options = PairModelOptions { face: FaceModel::PlaneStress, ..PairModelOptions::default() };
        options.contact.cells_per_half_width = 3.0;
        for member in [&mut options.pinion, &mut options.wheel] {
            member.mesh = MeshDensity { order: 2, density: 0.5 };
        }
        let model = PairModel::new(&pair, &options).unwrap();
        let modes = PairModes::new(&model, [6, 7]).unwrap();
        for mesh_cycle in [0.1, 4.4, -7.3, 30.2] {
            let settled = model.contact_at(mesh_cycle, 100.0).unwrap().unwrap();
            let openings = modes.openings(&settled, &model);
            let mut first_cell = 0;
            for grid in &settled.grid.pairs {
                let row = &grid.rows[grid.rows.len() / 2];
                let rolls = [row.pinion_roll, row.wheel_roll];
                let teeth = teeth_in_mesh(&model, mesh_cycle, rolls);
                let columns = settled.grid.face.centres.len();
                let cell = first_cell + grid.rows.len() / 2 * columns;
                first_cell += grid.rows.len() * columns;
                let mut first_mode = 0;
                for index in 0..2 {
                    let (body, gear) = (&model.bodies()[index], modes.of(index));
                    let station = body.healthy_sector().station(rolls[index]);
                    let inward = gear.at_station(0, teeth[index], body.side, &station);
                    let psi = body.families[0].basis.plane_values(settled.grid.face.centres[0])[0];
                    for mode in 0..gear.modes.len() {
                        let (found, expected) = (openings[(cell, first_mode + mode)], inward[(mode, 0)] * psi);
                        let scale = inward.col_as_slice(0).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                        assert!(
                            (found - expected).abs() < 1e-9 * scale,
                            "mesh cycle {mesh_cycle}, gear {index}, tooth {}, mode {mode}: {found} against {expected}",
                            teeth[index]
                        );
                    }
                    first_mode += gear.modes.len();
                }
            }
        }
    }
}
