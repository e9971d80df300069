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
    pub fn openings(&self, settled: &Settled, model: &PairModel) -> Result<Mat<f64>, FecmError> {
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
                    // modes are those of healthy teeth, whose nodes they number
                    let stations: Result<Vec<_>, _> = rolls.map(|roll| body.healthy_sector().station(roll)).collect();
                    let inward = gear.at_stations(family, (pair.pair * step, &stations?));
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
        Ok(openings)
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
