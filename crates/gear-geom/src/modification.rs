//! Micro-geometry: material removed from a flank, along its normal, as a function of roll distance and face position.
//!
//! Terms follow ISO 21771 and ISO 53: relief starts at a roll distance and grows to its amount at the end of the involute (tip or
//! form point); crown and end relief are measured at the ends of the face. Contributions add.

/// How a relief grows from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReliefShape {
    /// In proportion to the distance from the start.
    #[default]
    Linear,
    /// With the square of it: no corner at the start.
    Parabolic,
}

impl ReliefShape {
    fn at(self, fraction: f64) -> f64 {
        match self {
            Self::Linear => fraction,
            Self::Parabolic => fraction * fraction,
        }
    }
}

/// Tip or root relief.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileRelief {
    /// Material removed at `end_roll` (m).
    pub amount: f64,
    /// Roll distance at which relief begins (m).
    pub start_roll: f64,
    /// Roll distance at which it has its amount (m): beyond the start for the tip of an external gear, before it for its root.
    pub end_roll: f64,
    /// Growth between the two.
    pub shape: ReliefShape,
}

impl ProfileRelief {
    fn at(&self, roll: f64) -> f64 {
        let fraction = (roll - self.start_roll) / (self.end_roll - self.start_roll);
        if fraction > 0.0 { self.amount * self.shape.at(fraction) } else { 0.0 }
    }
}

/// Relief of both ends of the face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndRelief {
    /// Material removed at the ends of the face (m).
    pub amount: f64,
    /// Length of the relieved part at each end (m).
    pub length: f64,
    /// Growth toward the end.
    pub shape: ReliefShape,
}

/// Measured deviation on a grid, material removed positive; bilinear between points, constant beyond them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeasuredDeviation {
    /// Roll distances (m), ascending.
    pub roll: Vec<f64>,
    /// Face positions (m, 0 at mid-face), ascending.
    pub face: Vec<f64>,
    /// Material removed (m): `removed[i][j]` at `roll[i]`, `face[j]`.
    pub removed: Vec<Vec<f64>>,
}

impl MeasuredDeviation {
    /// Whether the grid is complete, ascending and finite.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let ascending =
            |v: &[f64]| !v.is_empty() && v.windows(2).all(|w| w[0] < w[1]) && v.iter().all(|x| x.is_finite());
        let full = |row: &Vec<f64>| row.len() == self.face.len() && row.iter().all(|x| x.is_finite());
        ascending(&self.roll)
            && ascending(&self.face)
            && self.removed.len() == self.roll.len()
            && self.removed.iter().all(full)
    }

    /// Whether `z` and `-z` always agree.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        let count = self.face.len();
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-15 + 1e-12 * a.abs();
        let row_is = |row: &Vec<f64>| (0..count).all(|j| close(row[j], row[count - 1 - j]));
        count == 1
            || (0..count).all(|j| close(self.face[j], -self.face[count - 1 - j])) && self.removed.iter().all(row_is)
    }

    /// Material removed (m) at a roll distance and face position: bilinear, beyond the table that of its edge.
    #[must_use]
    pub fn at(&self, roll: f64, z: f64) -> f64 {
        let (i, u) = locate(&self.roll, roll);
        let (j, v) = locate(&self.face, z);
        let value = |i: usize, j: usize| self.removed[i.min(self.roll.len() - 1)][j.min(self.face.len() - 1)];
        (1.0 - u) * ((1.0 - v) * value(i, j) + v * value(i, j + 1))
            + u * ((1.0 - v) * value(i + 1, j) + v * value(i + 1, j + 1))
    }
}

/// Interval and fraction of a value in an ascending list.
fn locate(points: &[f64], value: f64) -> (usize, f64) {
    let after = points.partition_point(|&p| p <= value);
    if after == 0 {
        return (0, 0.0);
    }
    if after == points.len() {
        return (points.len() - 1, 0.0);
    }
    (after - 1, (value - points[after - 1]) / (points[after] - points[after - 1]))
}

/// All modifications of a gear's flanks; the default is the plain involute.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FlankModification {
    /// Tip relief.
    pub tip_relief: Option<ProfileRelief>,
    /// Root relief.
    pub root_relief: Option<ProfileRelief>,
    /// Symmetric parabolic lead crown: material removed at both ends of the face (m).
    pub lead_crown: f64,
    /// End relief.
    pub end_relief: Option<EndRelief>,
    /// Lead slope (helix deviation): removed at the end `z = +b/2` more than at `z = -b/2` (m); zero at mid-face.
    pub lead_slope: f64,
    /// Measured deviation.
    pub measured: Option<MeasuredDeviation>,
}

impl FlankModification {
    /// Material removed along the normal (m) at a roll distance and face position, for a face of `width` (m). Only lead slope and measured
    /// deviations can be negative (material added).
    #[must_use]
    pub fn deviation(&self, roll: f64, z: f64, width: f64) -> f64 {
        let from_middle = 2.0 * z / width;
        let mut removed = self.lead_crown * from_middle * from_middle + 0.5 * self.lead_slope * from_middle;
        for relief in [&self.tip_relief, &self.root_relief].into_iter().flatten() {
            removed += relief.at(roll);
        }
        if let Some(relief) = &self.end_relief {
            let into = (z.abs() - (0.5 * width - relief.length)) / relief.length;
            if into > 0.0 {
                removed += relief.amount * relief.shape.at(into);
            }
        }
        if let Some(table) = &self.measured {
            removed += table.at(roll, z);
        }
        removed
    }

    /// Whether `z` and `-z` always agree.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.lead_slope == 0.0 && self.measured.as_ref().is_none_or(MeasuredDeviation::is_symmetric)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_relief_and_crown_at_their_ends() {
        let width = 0.03;
        let modification = FlankModification {
            tip_relief: Some(ProfileRelief {
                amount: 14e-6,
                start_roll: 0.018,
                end_roll: 0.022,
                shape: ReliefShape::Linear,
            }),
            root_relief: Some(ProfileRelief {
                amount: 6e-6,
                start_roll: 0.012,
                end_roll: 0.010,
                shape: ReliefShape::Parabolic,
            }),
            lead_crown: 28e-6,
            end_relief: Some(EndRelief { amount: 5e-6, length: 0.003, shape: ReliefShape::Linear }),
            lead_slope: 4e-6,
            measured: None,
        };
        let at = |s, z| modification.deviation(s, z, width);
        assert_eq!(at(0.015, 0.0), 0.0);
        assert!((at(0.022, 0.0) - 14e-6).abs() < 1e-18);
        assert!((at(0.020, 0.0) - 7e-6).abs() < 1e-18);
        assert!((at(0.010, 0.0) - 6e-6).abs() < 1e-18);
        assert!((at(0.011, 0.0) - 1.5e-6).abs() < 1e-18);
        assert!((at(0.015, 0.015) - (28e-6 + 5e-6 + 2e-6)).abs() < 1e-17);
        assert!((at(0.015, -0.015) - (28e-6 + 5e-6 - 2e-6)).abs() < 1e-17);
        assert!(!modification.is_symmetric());
    }

    #[test]
    fn analytic_measured_table_is_bilinear() {
        let table = MeasuredDeviation {
            roll: vec![0.0, 1.0],
            face: vec![-1.0, 1.0],
            removed: vec![vec![0.0, 2.0], vec![4.0, 6.0]],
        };
        assert!(table.is_valid());
        assert_eq!(table.at(0.5, 0.0), 3.0);
        assert_eq!(table.at(5.0, 5.0), 6.0);
        assert_eq!(table.at(-5.0, -5.0), 0.0);
    }
}
