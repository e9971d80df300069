//! A mesh as a table: force curves at equal steps of the mesh cycle, and windows of other curves where a damaged tooth is in mesh.
//!
//! Position `i` is mesh cycle `origin + i / n`. Curves are exact there; between positions force and stiffness at an approach are cubics in the mesh cycle through the four positions about it,
//! so a table is smooth for any step of time. Healthy teeth are all alike: `n` curves serve all cycles. A damaged tooth comes back after as many pairs as its gear has teeth.

use serde::{Deserialize, Serialize};

use super::curve::ForceCurve;
use super::error::MeshError;
use super::law::{MeshLaw, MeshResponse};

/// Curves around a damaged tooth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DamageWindow {
    /// A pair that has the damaged tooth.
    pub pair: i64,
    /// Pairs from one meeting to the next: teeth of the damaged gear.
    pub period: u32,
    /// First position, counted from that at which `pair` would be pair 0.
    pub first: i64,
    /// Curves from there on; pair numbers in them are counted from `pair`.
    pub curves: Vec<ForceCurve>,
}

/// What a table is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeshTableData {
    /// Mesh cycle of position 0.
    pub origin: f64,
    /// Curves of sound teeth, as many as steps a cycle.
    pub sound: Vec<ForceCurve>,
    /// Damaged teeth.
    pub windows: Vec<DamageWindow>,
}

/// A mesh as a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MeshTableData", into = "MeshTableData")]
pub struct MeshTable {
    data: MeshTableData,
}

impl TryFrom<MeshTableData> for MeshTable {
    type Error = MeshError;

    fn try_from(data: MeshTableData) -> Result<Self, MeshError> {
        Self::new(data)
    }
}

impl From<MeshTable> for MeshTableData {
    fn from(table: MeshTable) -> Self {
        table.data
    }
}

/// Part of a step within which a mesh cycle counts as at a position: what rounding of angles leaves.
const AT_POSITION: f64 = 1e-6;
/// Pairs and positions beyond this are no use: a mesh cycle's place in its cycle is then lost to rounding.
const MOST_POSITIONS: u64 = 1_000_000_000_000;

impl MeshTable {
    /// Checks a table.
    ///
    /// # Errors
    /// [`MeshError::Option`] without curves or for an origin or window that is none, [`MeshError::Overlap`] for damaged teeth in mesh at the same time.
    pub fn new(data: MeshTableData) -> Result<Self, MeshError> {
        let steps = data.sound.len() as i64;
        if steps == 0 {
            return Err(MeshError::Option { name: "positions a cycle", value: 0.0, allowed: "1 or more" });
        }
        if !(data.origin.abs() < 1e6) {
            return Err(MeshError::Option { name: "origin", value: data.origin, allowed: "-1e6 to 1e6 mesh cycles" });
        }
        for (index, window) in data.windows.iter().enumerate() {
            if let Some(&value) = [window.pair, window.first].iter().find(|value| value.unsigned_abs() > MOST_POSITIONS)
            {
                let allowed = "-1e12 to 1e12";
                return Err(MeshError::Option {
                    name: "pair or position of a damaged tooth",
                    value: value as f64,
                    allowed,
                });
            }
            if window.period == 0 {
                return Err(MeshError::Option { name: "period of a damaged tooth", value: 0.0, allowed: "1 or more" });
            }
            let own = std::iter::once(window).filter(|window| window.curves.len() as i64 > window.positions(steps));
            let others = data.windows[..index].iter().filter(|other| other.overlaps(window, steps));
            if let Some(other) = own.chain(others).next() {
                return Err(MeshError::Overlap {
                    first: other.pair,
                    first_period: other.period,
                    second: window.pair,
                    second_period: window.period,
                });
            }
        }
        Ok(Self { data })
    }

    /// What it is made of.
    #[must_use]
    pub fn data(&self) -> &MeshTableData {
        &self.data
    }

    /// Positions a cycle.
    #[must_use]
    pub fn positions_per_cycle(&self) -> usize {
        self.data.sound.len()
    }

    /// Curve at a position, and what to add to its pair numbers.
    #[must_use]
    pub fn curve(&self, position: i64) -> (&ForceCurve, i64) {
        let steps = self.data.sound.len() as i64;
        for window in &self.data.windows {
            let since = position.saturating_sub(window.first + window.pair * steps);
            let (meeting, index) =
                (since.div_euclid(window.positions(steps)), since.rem_euclid(window.positions(steps)));
            if let Some(curve) = window.curves.get(index as usize) {
                return (curve, window.pair + meeting * i64::from(window.period));
            }
        }
        (&self.data.sound[position.rem_euclid(steps) as usize], position.div_euclid(steps))
    }

    /// Forces of the tooth pairs (N), by number, at a mesh cycle and an approach (m).
    #[must_use]
    pub fn pair_forces(&self, mesh_cycle: f64, approach: f64) -> Vec<(i64, f64)> {
        let mut forces = std::collections::BTreeMap::new();
        for (position, weight) in self.beside(mesh_cycle) {
            let (curve, shift) = self.curve(position);
            for (pair, force) in curve.pair_forces(approach) {
                *forces.entry(i64::from(pair) + shift).or_insert(0.0) += weight * force;
            }
        }
        forces.into_iter().filter(|(_, force)| *force > 0.0).collect()
    }

    /// The four positions about a mesh cycle, with their weights: cubic convolution (R. G. Keys, *IEEE Trans. ASSP* 29, 1981, 1153-1160). Weights of the two positions on either side
    /// do not add up to less than 0; where only the outermost touches, force is 0.
    pub(super) fn beside(&self, mesh_cycle: f64) -> [(i64, f64); 4] {
        let most = MOST_POSITIONS as f64;
        let place = ((mesh_cycle - self.data.origin) * self.data.sound.len() as f64).clamp(-most, most);
        let nearest = place.round();
        let (below, t) =
            if (place - nearest).abs() < AT_POSITION { (nearest, 0.0) } else { (place.floor(), place - place.floor()) };
        let weights = [
            0.5 * t * (t * (2.0 - t) - 1.0),
            1.0 + 0.5 * t * t * (3.0 * t - 5.0),
            0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
            0.5 * t * t * (t - 1.0),
        ];
        std::array::from_fn(|k| (below as i64 + k as i64 - 1, weights[k]))
    }
}

impl MeshLaw for MeshTable {
    fn response(&self, mesh_cycle: f64, approach: f64) -> MeshResponse {
        let mut sum = MeshResponse::default();
        for (position, weight) in self.beside(mesh_cycle).into_iter().filter(|(_, weight)| *weight != 0.0) {
            let own = self.curve(position).0.response(approach);
            sum.force += weight * own.force;
            sum.stiffness += weight * own.stiffness;
        }
        if sum.force > 0.0 {
            MeshResponse { stiffness: sum.stiffness.max(0.0), ..sum }
        } else {
            MeshResponse::default()
        }
    }
}

impl DamageWindow {
    /// Positions from one meeting to the next.
    fn positions(&self, steps: i64) -> i64 {
        i64::from(self.period) * steps
    }

    /// Whether it is ever in the way of another: meetings of two teeth differ by all multiples of the greatest common divisor of their periods.
    fn overlaps(&self, other: &Self, steps: i64) -> bool {
        let begin = |window: &Self| window.first + window.pair * steps;
        let common = gcd(self.positions(steps), other.positions(steps));
        let after = (begin(other) - begin(self)).rem_euclid(common);
        after < self.curves.len() as i64 || common - after < other.curves.len() as i64
    }
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::super::curve::{ForceCurveData, ForceKnot};
    use super::*;

    /// A straight curve of a stiffness (N/um).
    fn line(stiffness: f64) -> ForceCurve {
        let knot =
            ForceKnot { approach: 1e-6, force: stiffness, stiffness: 1e6 * stiffness, pairs: vec![(0, stiffness)] };
        ForceCurve::new(ForceCurveData { touch: 0.0, knots: vec![knot] }).unwrap()
    }

    fn window(pair: i64, period: u32, first: i64, count: usize) -> DamageWindow {
        DamageWindow { pair, period, first, curves: (0..count).map(|i| line(900.0 + i as f64)).collect() }
    }

    fn table(windows: Vec<DamageWindow>) -> Result<MeshTable, MeshError> {
        let sound = (0..4).map(|i| line(100.0 * f64::from(i + 1))).collect();
        MeshTable::new(MeshTableData { origin: 0.1, sound, windows })
    }

    /// Sound curves come back every cycle, those of a damaged tooth every turn of its gear; between positions cubics.
    #[test]
    fn invariant_table_repeats() {
        let table = table(vec![window(5, 7, -2, 3)]).unwrap();
        let force = |cycle: f64| table.response(cycle, 1e-6).force;
        for turn in [-14.0, 0.0, 21.0] {
            for (cycle, expected) in
                [(0.1, 100.0), (3.35, 200.0), (0.85, 400.0), (4.6, 900.0), (4.85, 901.0), (5.1, 902.0), (5.35, 200.0)]
            {
                assert!((force(cycle + turn) - expected).abs() < 1e-9, "{cycle} {turn}: {}", force(cycle + turn));
            }
            let middle = (9.0 * (200.0 + 900.0) - 100.0 - 901.0) / 16.0;
            assert!((force(4.475 + turn) - middle).abs() < 1e-6, "{}", force(4.475 + turn));
            assert!((force(0.1 + 1e-9 + turn) - 100.0).abs() < 1e-12);
            assert_eq!(table.pair_forces(4.85 + turn, 1e-6)[0].0, 5 + turn as i64);
            assert_eq!(table.pair_forces(3.35 + turn, 1e-6)[0].0, 3 + turn as i64);
        }
    }

    #[test]
    fn extreme_tables_are_refused() {
        // the same gear: apart or not; gears of 6 and 9 teeth meet every third pair
        assert!(table(vec![window(0, 7, 0, 8), window(3, 7, 0, 8)]).is_ok());
        assert!(matches!(table(vec![window(0, 7, 0, 8), window(6, 7, 0, 8)]), Err(MeshError::Overlap { .. })));
        assert!(table(vec![window(0, 6, 0, 4), window(1, 9, 0, 4)]).is_ok());
        assert!(matches!(table(vec![window(0, 6, 0, 4), window(3, 9, 0, 4)]), Err(MeshError::Overlap { .. })));
        assert!(matches!(table(vec![window(0, 7, 0, 4), window(2, 9, 0, 4)]), Err(MeshError::Overlap { .. })));
        assert!(matches!(table(vec![window(0, 1, 0, 5)]), Err(MeshError::Overlap { .. })));
        assert!(matches!(table(vec![window(i64::MIN, 7, 0, 5)]), Err(MeshError::Option { .. })));
        let sound = table(vec![window(5, 7, -2, 3)]).unwrap();
        for (cycle, approach) in [(f64::MAX, 1e-6), (f64::NAN, 1e-6), (-f64::INFINITY, 1e-6), (0.3, f64::NAN)] {
            let answer = sound.response(cycle, approach);
            assert!(answer.force.is_finite() && answer.stiffness.is_finite(), "{cycle} {approach}: {answer:?}");
        }
        let empty = MeshTableData { origin: 0.0, sound: vec![], windows: vec![] };
        assert!(matches!(MeshTable::new(empty), Err(MeshError::Option { .. })));
    }
}
