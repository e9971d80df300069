//! Mesh stiffness, static transmission error and load sharing over whole mesh cycles: from points, waves and series; with damaged
//! cycles put into a rotation.
//!
//! Points carry the mesh cycle they were found at; a healthy curve is laid on `[0, cycles)` by whole periods, a damaged one
//! starts at its first whole cycle and is put where it belongs in the rotation. Tooth pair `k` moves along with the cycles.
//!
//! Tests: unit tests below; `tests/lumped_pair.rs`.

use std::collections::BTreeMap;

use fecm::statics::PositionResult;
use lpm::{Curve, Interpolation, LpmError};

use super::schema::{Fourier, Wave};

const UM: f64 = 1e-6;
const N_PER_UM: f64 = 1e6;
/// Points per wave of the highest harmonic where a series is tabulated.
const POINTS_PER_WAVE: usize = 64;

/// Values at mesh cycles, ascending, SI.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// Mesh cycles.
    pub mesh_cycle: Vec<f64>,
    /// Local-slope mesh stiffness (N/m).
    pub stiffness: Vec<f64>,
    /// Static transmission error (m).
    pub error: Vec<f64>,
    /// Share of the mesh force of each tooth pair; empty where not known.
    pub shares: BTreeMap<i32, Vec<f64>>,
}

/// Curves of one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// First whole mesh cycle of the points they come from.
    pub first: i64,
    /// Local-slope mesh stiffness (N/m).
    pub stiffness: Curve,
    /// Static transmission error (m).
    pub error: Curve,
    /// Load sharing, where known.
    pub sharing: Option<Sharing>,
}

/// Shares of the mesh force over a period of whole mesh cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct Sharing {
    cycles: usize,
    /// Phase in `[0, cycles)` and the share of each pair there.
    points: Vec<(f64, BTreeMap<i32, f64>)>,
}

impl Points {
    /// From a static analysis; `origin` is added to its mesh cycles.
    ///
    /// # Errors
    /// Says how many positions have no answer.
    pub fn from_statics(results: &[PositionResult], origin: f64) -> Result<Self, String> {
        let mut points = Self::default();
        let mut unusable = 0;
        for result in results {
            match result.local_stiffness().filter(|_| result.status.is_usable()) {
                Some(stiffness) => {
                    points.mesh_cycle.push(result.mesh_cycle + origin);
                    points.stiffness.push(stiffness);
                    points.error.push(result.static_transmission_error);
                }
                None => unusable += 1,
            }
        }
        if unusable > 0 {
            return Err(format!("{unusable} of {} positions have no usable answer", results.len()));
        }
        let pairs: std::collections::BTreeSet<i32> =
            results.iter().flat_map(|r| r.pairs.iter().map(|p| p.pair)).collect();
        for pair in pairs {
            let of = |r: &PositionResult| r.pairs.iter().find(|p| p.pair == pair).map_or(0.0, |p| p.share);
            points.shares.insert(pair, results.iter().map(of).collect());
        }
        Ok(points)
    }

    /// Drops what lies beyond the first mesh cycle.
    pub fn keep_one_cycle(&mut self) {
        let Some(first) = self.mesh_cycle.first().copied() else { return };
        let count = self.mesh_cycle.partition_point(|x| *x < first + 1.0 - 1e-6);
        for column in [&mut self.mesh_cycle, &mut self.stiffness, &mut self.error] {
            column.truncate(count);
        }
        self.shares.values_mut().for_each(|shares| shares.truncate(count));
    }

    /// Whole mesh cycles covered; the last point may repeat the first.
    fn cycles(&self) -> Result<usize, String> {
        let x = &self.mesh_cycle;
        let (Some(first), Some(last)) = (x.first(), x.last()) else { return Err("holds no points".into()) };
        let widest = x.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        if !x.windows(2).all(|w| w[1] - w[0] > 1e-9) {
            return Err("its mesh cycles must ascend".into());
        }
        let length = last - first;
        let cycles = (length - 1e-6).ceil();
        if x.len() < 4 || cycles < 1.0 || cycles - length > 3.0 * widest {
            return Err(format!("it must cover whole mesh cycles with at least 4 points; it covers {length:.4}"));
        }
        Ok(cycles as usize)
    }

    /// As curves with a period of the whole cycles covered, phase 0 at a whole mesh cycle.
    ///
    /// # Errors
    /// Says why the points are no periodic curve.
    pub fn curves(&self, interpolation: Interpolation) -> Result<Curves, String> {
        let cycles = self.cycles()?;
        let period = cycles as f64;
        let first = (self.mesh_cycle[0] + 1e-6).floor();
        let wrap = |x: f64| {
            let phase = (x - first).rem_euclid(period);
            if period - phase < 1e-6 { 0.0 } else { phase }
        };
        let mut rows: Vec<(f64, usize)> = (0..self.mesh_cycle.len()).map(|i| (wrap(self.mesh_cycle[i]), i)).collect();
        let repeats = self.mesh_cycle[rows.len() - 1] - self.mesh_cycle[0] > period - 1e-6;
        if repeats {
            rows.pop();
        }
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let phases: Vec<f64> = rows.iter().map(|r| r.0).collect();
        let curve = |values: &[f64]| {
            let values: Vec<f64> = rows.iter().map(|r| values[r.1]).collect();
            Curve::table(cycles, &phases, &values, interpolation).map_err(|e| e.to_string())
        };
        let sharing = (!self.shares.is_empty()).then(|| Sharing {
            cycles,
            points: rows
                .iter()
                .map(|&(phase, row)| {
                    let moved = (self.mesh_cycle[row] - phase).round() as i32;
                    let shares = self.shares.iter().map(|(pair, shares)| (pair - moved, shares[row]));
                    (phase, shares.filter(|s| s.1 > 0.0).collect())
                })
                .collect(),
        });
        Ok(Curves { first: first as i64, stiffness: curve(&self.stiffness)?, error: curve(&self.error)?, sharing })
    }
}

impl Curves {
    /// From a wave; `mean_force` (N) gives the transmission error where it is left out.
    ///
    /// # Errors
    /// Those of the curves.
    pub fn wave(wave: &Wave, mean_force: f64) -> Result<Self, LpmError> {
        let between = |one: f64, two: f64| {
            let (rise, duty) = (wave.double_from_mesh_cycle, wave.contact_ratio - 1.0);
            if wave.ramp_mesh_cycles > 0.0 {
                Curve::trapezoidal(one, two, rise, duty, wave.ramp_mesh_cycles)
            } else {
                Curve::rectangular(one, two, rise, duty)
            }
        };
        let stiffness = [wave.single_stiffness_n_per_um, wave.double_stiffness_n_per_um].map(|k| k * N_PER_UM);
        let error = |given: Option<f64>, k: f64| given.map_or(mean_force / k, |e| e * UM);
        Ok(Self {
            first: 0,
            stiffness: between(stiffness[0], stiffness[1])?,
            error: between(error(wave.single_ste_um, stiffness[0]), error(wave.double_ste_um, stiffness[1]))?,
            sharing: None,
        })
    }

    /// From Fourier series.
    ///
    /// # Errors
    /// Those of the curves.
    pub fn fourier(series: &Fourier) -> Result<Self, LpmError> {
        let curve = |mean: f64, cosines: &[f64], sines: &[f64], unit: f64| {
            let at = |list: &[f64], j: usize| list.get(j).copied().unwrap_or(0.0) * unit;
            let count = cosines.len().max(sines.len());
            let harmonics: Vec<(f64, f64)> = (0..count).map(|j| (at(cosines, j), at(sines, j))).collect();
            Curve::fourier(mean * unit, &harmonics)
        };
        let s = series;
        Ok(Self {
            first: 0,
            stiffness: curve(
                s.stiffness_mean_n_per_um,
                &s.stiffness_cosines_n_per_um,
                &s.stiffness_sines_n_per_um,
                N_PER_UM,
            )?,
            error: curve(s.ste_mean_um, &s.ste_cosines_um, &s.ste_sines_um, UM)?,
            sharing: None,
        })
    }

    /// The same as tables, which cycles can be cut out of; `harmonics` is the highest of the series.
    ///
    /// # Errors
    /// Those of the curves.
    pub fn tabulated(&self, harmonics: usize) -> Result<Self, LpmError> {
        let count = POINTS_PER_WAVE * harmonics.max(1);
        let table = |curve: &Curve| {
            let values: Vec<f64> = (0..count).map(|i| curve.value(i as f64 / count as f64)).collect();
            Curve::samples(1, &values, Interpolation::Spline)
        };
        Ok(Self { stiffness: table(&self.stiffness)?, error: table(&self.error)?, ..self.clone() })
    }

    /// A stand-in for damage: stiffness times `factor`, transmission error over it, for `cycles` mesh cycles.
    ///
    /// # Errors
    /// Those of the curves.
    pub fn weakened(&self, factor: f64, cycles: usize) -> Result<Self, LpmError> {
        let times = cycles.div_ceil(self.stiffness.period());
        let repeated = |curve: &Curve, factor: f64| curve.scaled(factor, 0.0)?.repeated(times);
        Ok(Self {
            stiffness: repeated(&self.stiffness, factor)?,
            error: repeated(&self.error, 1.0 / factor)?,
            sharing: self.sharing.as_ref().map(|s| s.repeated(times)),
            first: self.first,
        })
    }

    /// A rotation of `cycles` mesh cycles that follows `self` except where `damaged` begins at cycle `first`.
    ///
    /// # Errors
    /// Where periods do not fit.
    pub fn with_damage(&self, cycles: usize, first: usize, damaged: &Self) -> Result<Self, LpmError> {
        Ok(Self {
            first: 0,
            stiffness: self.stiffness.with_cycles_replaced(cycles, first, &damaged.stiffness)?,
            error: self.error.with_cycles_replaced(cycles, first, &damaged.error)?,
            sharing: match (&self.sharing, &damaged.sharing) {
                (Some(healthy), Some(damaged)) => Some(healthy.with_damage(cycles, first, damaged)),
                _ => None,
            },
        })
    }
}

fn moved(point: &(f64, BTreeMap<i32, f64>), by: usize) -> (f64, BTreeMap<i32, f64>) {
    (point.0 + by as f64, point.1.iter().map(|(pair, share)| (pair + by as i32, *share)).collect())
}

impl Sharing {
    fn repeated(&self, times: usize) -> Self {
        let points = (0..times).flat_map(|r| self.points.iter().map(move |p| moved(p, r * self.cycles))).collect();
        Self { cycles: self.cycles * times, points }
    }

    fn with_damage(&self, cycles: usize, first: usize, damaged: &Self) -> Self {
        let mut points = self.repeated(cycles / self.cycles).points;
        points.retain(|p| p.0 < first as f64 || p.0 >= (first + damaged.cycles) as f64);
        points.extend(damaged.points.iter().map(|p| moved(p, first)));
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { cycles, points }
    }

    /// Loaded pairs and their shares at a mesh cycle (not negative), linear between points.
    #[must_use]
    pub fn at(&self, mesh_cycle: f64) -> Vec<(i32, f64)> {
        let period = self.cycles as f64;
        let turns = (mesh_cycle / period).floor();
        let phase = mesh_cycle - turns * period;
        let after = self.points.partition_point(|p| p.0 <= phase);
        let around = |index: usize, offset: i32| {
            let point = &self.points[index];
            let by = offset * self.cycles as i32;
            (point.0 + f64::from(by), &point.1, by)
        };
        let last = self.points.len() - 1;
        let left = if after == 0 { around(last, -1) } else { around(after - 1, 0) };
        let right = if after > last { around(0, 1) } else { around(after, 0) };
        let weight = ((phase - left.0) / (right.0 - left.0)).clamp(0.0, 1.0);
        let mut shares: BTreeMap<i32, f64> = BTreeMap::new();
        for ((_, point, by), weight) in [(left, 1.0 - weight), (right, weight)] {
            for (pair, share) in point {
                *shares.entry(pair + by + turns as i32 * self.cycles as i32).or_default() += weight * share;
            }
        }
        shares.into_iter().filter(|s| s.1 > 0.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pairs over the first half of the cycle, one over the second, with pair 0 leaving in the middle.
    fn points(from: f64, cycles: usize) -> Points {
        let n = 20 * cycles;
        let x: Vec<f64> = (0..n).map(|i| from + i as f64 / 20.0).collect();
        let double = |x: &f64| x.rem_euclid(1.0) < 0.49;
        let mut shares: BTreeMap<i32, Vec<f64>> = BTreeMap::new();
        for pair in from as i32..=(from as i32 + cycles as i32) {
            let share = |x: &f64| match (*x + 1e-9).floor() as i32 - pair {
                0 if double(x) => 0.5,
                -1 => {
                    if double(x) {
                        0.5
                    } else {
                        1.0
                    }
                }
                _ => 0.0,
            };
            shares.insert(pair, x.iter().map(share).collect());
        }
        let stiffness = x.iter().map(|x| if double(x) { 800e6 } else { 500e6 }).collect();
        Points { error: x.iter().map(|_| 1e-5).collect(), mesh_cycle: x, stiffness, shares }
    }

    #[test]
    fn analytic_points_of_any_cycle_lie_on_the_same_phases() -> Result<(), String> {
        let here = points(0.0, 1).curves(Interpolation::Linear)?;
        let there = points(14.0, 2).curves(Interpolation::Linear)?;
        assert_eq!((there.first, there.stiffness.period()), (14, 2));
        for i in 0..200 {
            let t = f64::from(i) / 100.0;
            assert!((here.stiffness.value(t) / there.stiffness.value(t) - 1.0).abs() < 1e-12);
        }
        Ok(())
    }

    #[test]
    fn invariant_shares_sum_to_one_in_every_cycle_and_move_with_it() -> Result<(), String> {
        let healthy = points(0.0, 1).curves(Interpolation::Linear)?;
        let damaged = points(3.0, 2).curves(Interpolation::Linear)?;
        let whole = healthy.with_damage(5, 3, &damaged).map_err(|e| e.to_string())?;
        let (one, rotation) = (healthy.sharing.ok_or("none")?, whole.sharing.ok_or("none")?);
        for i in 0..1200 {
            let t = f64::from(i) / 100.0 + 1e-4;
            let shares = rotation.at(t);
            assert!((shares.iter().map(|s| s.1).sum::<f64>() - 1.0).abs() < 1e-12, "{t}: {shares:?}");
            let (a, b) = (one.at(t), &shares);
            assert_eq!(a.len(), b.len(), "{t}: {a:?} {b:?}");
            assert!(a.iter().zip(b).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-9), "{t}: {a:?} {b:?}");
        }
        Ok(())
    }

    #[test]
    fn extreme_points_that_are_no_whole_cycles_are_refused() {
        let mut half = points(0.0, 1);
        for column in [&mut half.mesh_cycle, &mut half.stiffness, &mut half.error] {
            column.truncate(10);
        }
        half.shares.clear();
        assert!(half.curves(Interpolation::Linear).unwrap_err().contains("whole mesh cycles"));
        assert!(Points::default().curves(Interpolation::Linear).is_err());
    }
}
