//! Damage of single teeth: root cracks, surface pits, wear and broken corners.
//!
//! A root crack starts on a fillet and runs into the tooth; the others take away surface, all of it or to some depth ([`Damage::depth_at`]). All are
//! said in the tooth's own terms: fillet tangent and path for cracks, roll distance and face position on the flank for the rest. Heights on a
//! flank are arc lengths along it, or roll distances ([`ProfileMeasure`]): the two differ by the factor `s / r_b`, some 0.3 to 0.6.

use nalgebra::Vector2;

use crate::error::GeometryError;
use crate::gear::{FlankSide, Gear};
use crate::modification::MeasuredDeviation;

/// How long a crack is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrackLength {
    /// Fraction of the way from fillet to fillet along the chord below the tooth, 0 to 0.97.
    Chord(f64),
    /// Fraction of the crack's own path, 0 to 1; for a crack along the chord the same as [`Self::Chord`].
    Path(f64),
    /// Length (m).
    Length(f64),
}

/// Where on the fillet a crack starts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum CrackStart {
    /// In the middle of the fillet's turn.
    #[default]
    MiddleOfFillet,
    /// Where the fillet's tangent makes this angle with the tooth's centre line (rad).
    Tangent(f64),
    /// At this radius (m); one at roll distance `s` is `sqrt(r_b^2 + s^2)`.
    Radius(f64),
}

/// How a crack runs into the tooth.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum CrackPath {
    /// Along the chord to the other fillet.
    #[default]
    Chord,
    /// Straight, at this angle to the tooth's centre line, toward the axis (rad, a quarter turn is straight across).
    Straight(f64),
    /// A smooth curve through points: from the start across the tooth, and toward the axis (m).
    Through(Vec<[f64; 2]>),
}

/// How the length of a crack varies along the face: straight lines between given places, level beyond the first and the last.
///
/// Lengths are shares of the crack's own, which it has where it is longest.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CrackFront {
    /// Face position (m, 0 at mid-face) and share of the length, the largest 1; none for a crack of one length.
    points: Vec<[f64; 2]>,
}

impl CrackFront {
    /// A front from face positions (m, 0 at mid-face, ascending) and lengths there in any one unit; also the longest of these lengths. Without a
    /// length above 0 there is no crack, and the front is that of a through crack.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] for fewer than two places, places that do not ascend, lengths below 0.
    pub fn from_lengths(places: &[(f64, f64)]) -> Result<(Self, f64), GeometryError> {
        let fault = |parameter, value, allowed: &str| {
            Err(GeometryError::OutOfRange { parameter, value, allowed: allowed.to_owned() })
        };
        if places.len() < 2 {
            return fault("number of places of a crack front", places.len() as f64, "two or more");
        }
        if let Some(&(face, _)) = places.iter().find(|place| !place.0.is_finite()) {
            return fault("face position of a crack front", face, "a number of metres");
        }
        if let Some(pair) = places.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
            return fault("face position of a crack front", pair[1].0, "positions that ascend");
        }
        if let Some(&(_, length)) = places.iter().find(|place| !(place.1 >= 0.0 && place.1.is_finite())) {
            return fault("length along a crack front", length, "0 or more");
        }
        let longest = places.iter().map(|place| place.1).fold(0.0, f64::max);
        let varies = places.iter().any(|place| place.1 != longest);
        let points =
            if varies { places.iter().map(|&(face, length)| [face, length / longest]).collect() } else { Vec::new() };
        Ok((Self { points }, longest))
    }

    /// Whether the length is the same all along the face.
    #[must_use]
    pub fn is_through(&self) -> bool {
        self.points.is_empty()
    }

    /// Length at a face position (m), as a share of the longest.
    #[must_use]
    pub fn share_at(&self, face: f64) -> f64 {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return 1.0 };
        if face <= first[0] {
            return first[1];
        }
        if face >= last[0] {
            return last[1];
        }
        let next = self.points.partition_point(|point| point[0] <= face);
        let ([z0, a], [z1, b]) = (self.points[next - 1], self.points[next]);
        a + (b - a) * (face - z0) / (z1 - z0)
    }

    /// Places on a face of a width (m), its ends among them, between which the length changes linearly: face position (m) and share.
    #[must_use]
    pub fn polyline(&self, width: f64) -> Vec<[f64; 2]> {
        let half = 0.5 * width;
        let inner = self.points.iter().filter(|point| point[0].abs() < half).copied();
        std::iter::once([-half, self.share_at(-half)]).chain(inner).chain([[half, self.share_at(half)]]).collect()
    }

    /// The parts of a face of a width (m) along which the crack is longer than a share of its length: ascending, from and to (m).
    #[must_use]
    pub fn open_parts(&self, width: f64, share: f64) -> Vec<[f64; 2]> {
        let mut parts: Vec<[f64; 2]> = Vec::new();
        for pair in self.polyline(width).windows(2) {
            let ([z0, a], [z1, b]) = (pair[0], pair[1]);
            if a.max(b) <= share {
                continue;
            }
            let crossing = || z0 + (z1 - z0) * ((share - a) / (b - a)).clamp(0.0, 1.0);
            let part = [if a > share { z0 } else { crossing() }, if b > share { z1 } else { crossing() }];
            match parts.last_mut() {
                // the crack is open where two lines meet above the share
                Some(last) if last[1] == part[0] && a > share => last[1] = part[1],
                _ => parts.push(part),
            }
        }
        parts
    }
}

/// A root crack.
#[derive(Debug, Clone, PartialEq)]
pub struct RootCrack {
    /// Flank at whose fillet it starts.
    pub side: FlankSide,
    /// Where it starts.
    pub start: CrackStart,
    /// How it runs.
    pub path: CrackPath,
    /// Its length, where it is longest; 0 is no crack.
    pub length: CrackLength,
    /// How its length varies along the face.
    pub front: CrackFront,
}

impl RootCrack {
    /// A crack along the chord of a fraction of its length, the same all along the face.
    #[must_use]
    pub fn along_chord(side: FlankSide, fraction: f64) -> Self {
        let length = CrackLength::Chord(fraction);
        Self { side, start: CrackStart::default(), path: CrackPath::default(), length, front: CrackFront::default() }
    }

    /// Whether there is a crack, and its length varies along the face.
    #[must_use]
    pub fn varies_along_face(&self) -> bool {
        !self.is_empty() && !self.front.is_through()
    }

    /// Whether there is nothing of it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        match self.length {
            CrackLength::Chord(length) | CrackLength::Path(length) | CrackLength::Length(length) => length == 0.0,
        }
    }
}

/// How heights along the profile are measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ProfileMeasure {
    /// Arc length along the flank of a gear of this base radius (m): `s^2 / (2 r_b)`.
    ArcLength {
        /// Base radius (m).
        base_radius: f64,
    },
    /// Roll distance, along the line of action.
    #[default]
    RollDistance,
}

impl ProfileMeasure {
    /// Profile coordinate of a roll distance (m).
    #[must_use]
    pub fn at(self, roll: f64) -> f64 {
        match self {
            Self::ArcLength { base_radius } => roll * roll / (2.0 * base_radius),
            Self::RollDistance => roll,
        }
    }

    /// Roll distance of a profile coordinate (m), 0 below the base circle.
    #[must_use]
    pub fn roll(self, along: f64) -> f64 {
        match self {
            Self::ArcLength { base_radius } => (2.0 * base_radius * along).max(0.0).sqrt(),
            Self::RollDistance => along,
        }
    }
}

/// Outline of a pit on a flank: `x` along the face (m, 0 at mid-face), `y` roll distance (m).
#[derive(Debug, Clone, PartialEq)]
pub enum PitShape {
    /// Ellipse.
    Ellipse {
        /// Centre: face position and roll distance.
        centre: Vector2<f64>,
        /// Full width along the face and full height along the profile (m).
        size: Vector2<f64>,
        /// What the height is measured along.
        measure: ProfileMeasure,
    },
    /// Polygon of three or more corners.
    Polygon(Vec<Vector2<f64>>),
}

impl PitShape {
    /// Whether a place of the flank lies inside.
    #[must_use]
    pub fn contains(&self, face: f64, roll: f64) -> bool {
        match self {
            Self::Ellipse { centre, size, measure } => {
                let along = measure.at(roll) - measure.at(centre.y);
                let (x, y) = (2.0 * (face - centre.x) / size.x, 2.0 * along / size.y);
                x * x + y * y < 1.0
            }
            Self::Polygon(corners) => {
                // a ray toward +x crosses the outline an odd number of times
                let edges = corners.iter().zip(corners.iter().cycle().skip(1));
                let crossings = edges.filter(|(a, b)| {
                    (a.y > roll) != (b.y > roll) && face < a.x + (roll - a.y) / (b.y - a.y) * (b.x - a.x)
                });
                crossings.count() % 2 == 1
            }
        }
    }

    /// Smallest and largest face position and roll distance: `[[low, high]; 2]` (m).
    #[must_use]
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        match self {
            Self::Ellipse { centre, size, measure } => {
                let middle = measure.at(centre.y);
                let roll = [-0.5, 0.5].map(|half| measure.roll(middle + half * size.y));
                [[centre.x - 0.5 * size.x, centre.x + 0.5 * size.x], roll]
            }
            Self::Polygon(corners) => [0, 1].map(|axis| {
                let values = corners.iter().map(|c| c[axis]);
                values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
            }),
        }
    }

    /// Whether the shape is its own image about mid-face.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        match self {
            Self::Ellipse { centre, .. } => centre.x == 0.0,
            Self::Polygon(_) => false,
        }
    }
}

/// A pit: the union of its shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct Pit {
    /// Shapes.
    pub shapes: Vec<PitShape>,
    /// Depth (m): material removed inside. `None`: no contact inside, whatever the load.
    pub depth: Option<f64>,
}

impl Pit {
    /// One ellipse without contact inside: centre at a face position and roll distance, width along the face, height along the profile (m).
    #[must_use]
    pub fn ellipse(face: f64, roll: f64, width: f64, height: f64, measure: ProfileMeasure) -> Self {
        let (centre, size) = (Vector2::new(face, roll), Vector2::new(width, height));
        Self { shapes: vec![PitShape::Ellipse { centre, size, measure }], depth: None }
    }

    /// Whether a place of the flank lies inside.
    #[must_use]
    pub fn contains(&self, face: f64, roll: f64) -> bool {
        self.shapes.iter().any(|shape| shape.contains(face, roll))
    }

    /// Whether it is its own image about mid-face.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.shapes.iter().all(PitShape::is_symmetric)
    }

    /// Whether its place, its sizes and its depth are numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let shape = |shape: &PitShape| match shape {
            PitShape::Ellipse { centre, size, .. } => centre.iter().chain(size.iter()).all(|v| v.is_finite()),
            PitShape::Polygon(corners) => corners.iter().flatten().all(|v| v.is_finite()),
        };
        self.shapes.iter().all(shape) && self.depth.is_none_or(f64::is_finite)
    }

    /// Part of a flank's area that the pit takes, the flank measured in roll distance from `rolls[0]` to `rolls[1]` over a face of `width`
    /// (m); by midpoint sampling, relative error below 1e-3 for pits of a percent or more.
    #[must_use]
    pub fn area_fraction(&self, width: f64, rolls: [f64; 2]) -> f64 {
        const SAMPLES: usize = 600;
        let middle = |k: usize, low: f64, high: f64| low + (high - low) * (k as f64 + 0.5) / SAMPLES as f64;
        let inside = (0..SAMPLES)
            .map(|i| {
                let roll = middle(i, rolls[0], rolls[1]);
                (0..SAMPLES).filter(|&j| self.contains(middle(j, -0.5 * width, 0.5 * width), roll)).count()
            })
            .sum::<usize>();
        inside as f64 / (SAMPLES * SAMPLES) as f64
    }
}

/// A tooth whose tip has broken off at one end of the face, along a plane through three points: on the tip, `length` from the end, and on
/// both flanks at the end, `height` below the tip. On a flank the break is a straight line (in arc length along the profile).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrokenCorner {
    /// End of the face: its position (m), half a facewidth or minus that.
    pub end: f64,
    /// What is missing of the tip along the face (m).
    pub length: f64,
    /// What is missing of the profile at the end of the face, arc length from the tip (m).
    pub height: f64,
    /// Base radius of the gear (m).
    pub base_radius: f64,
    /// Roll distance of the tip (m).
    pub tip_roll: f64,
}

impl BrokenCorner {
    /// A corner broken off a tooth of a gear, at the end `z > 0` of the face or the other.
    #[must_use]
    pub fn new(gear: &Gear, at_positive_end: bool, length: f64, height: f64) -> Self {
        let half = 0.5 * gear.facewidth();
        let end = if at_positive_end { half } else { -half };
        let tip_roll = gear.roll_distance(gear.tip_radius());
        Self { end, length, height, base_radius: gear.base_radius(), tip_roll }
    }

    /// Whether nothing is missing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.length == 0.0 || self.height == 0.0
    }

    /// Whether a place of the flank is missing.
    #[must_use]
    pub fn contains(&self, face: f64, roll: f64) -> bool {
        let measure = ProfileMeasure::ArcLength { base_radius: self.base_radius };
        let below = (measure.at(self.tip_roll) - measure.at(roll)).abs();
        !self.is_empty() && (self.end - face).abs() / self.length + below / self.height < 1.0
    }
}

/// What is wrong with one tooth.
#[derive(Debug, Clone, PartialEq)]
pub enum Damage {
    /// A root crack.
    Crack(RootCrack),
    /// A pit on the working flank.
    Pit(Pit),
    /// Material worn off the working flank, measured from the sound one; nowhere negative.
    Wear(MeasuredDeviation),
    /// A broken tip corner. Nothing touches there any more; the stiffness of what has broken off is left to the tooth.
    BrokenCorner(BrokenCorner),
}

impl Damage {
    /// Material gone from the working flank (m) at a face position and roll distance; infinite where nothing is left to touch.
    #[must_use]
    pub fn depth_at(&self, face: f64, roll: f64) -> f64 {
        match self {
            Self::Crack(_) => 0.0,
            Self::Pit(pit) if pit.contains(face, roll) => pit.depth.unwrap_or(f64::INFINITY),
            Self::BrokenCorner(corner) if corner.contains(face, roll) => f64::INFINITY,
            Self::Pit(_) | Self::BrokenCorner(_) => 0.0,
            Self::Wear(wear) => wear.at(roll, face).max(0.0),
        }
    }

    /// Whether it changes the surface (and not the body).
    #[must_use]
    pub fn is_on_surface(&self) -> bool {
        !matches!(self, Self::Crack(_))
    }

    /// Whether it is its own image about mid-face.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        match self {
            // one that varies is treated as lopsided even where it is not
            Self::Crack(crack) => !crack.varies_along_face(),
            Self::Pit(pit) => pit.is_symmetric(),
            Self::Wear(wear) => wear.is_symmetric(),
            Self::BrokenCorner(corner) => corner.is_empty(),
        }
    }
}

/// A damaged tooth. Tooth 0 is the one that tooth pair 0 brings into contact; numbers count modulo the number of teeth.
#[derive(Debug, Clone, PartialEq)]
pub struct ToothDamage {
    /// Tooth number.
    pub tooth: i64,
    /// Its damage.
    pub damage: Damage,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_open_parts_of_a_crack_front() {
        let parts = |places: &[(f64, f64)], share| CrackFront::from_lengths(places).unwrap().0.open_parts(4.0, share);
        // a corner crack, a hump, a valley, a level beyond the table
        assert_eq!(parts(&[(-2.0, 0.0), (2.0, 3.0)], 0.25), vec![[-1.0, 2.0]]);
        assert_eq!(parts(&[(-2.0, 0.0), (0.0, 5.0), (2.0, 0.0)], 0.5), vec![[-1.0, 1.0]]);
        assert_eq!(parts(&[(-2.0, 4.0), (0.0, 0.0), (2.0, 4.0)], 0.5), vec![[-2.0, -1.0], [1.0, 2.0]]);
        assert_eq!(parts(&[(-1.0, 0.0), (0.0, 2.0)], 0.5), vec![[-0.5, 2.0]]);
        assert_eq!(parts(&[(-2.0, 4.0), (0.0, 2.0), (2.0, 4.0)], 0.5), vec![[-2.0, 0.0], [0.0, 2.0]]);
        assert_eq!(parts(&[(-2.0, 4.0), (0.0, 2.0), (2.0, 4.0)], 0.4), vec![[-2.0, 2.0]]);
        assert!(parts(&[(-2.0, 4.0), (2.0, 3.0)], 1.0).is_empty());
        // the table may be longer than the face
        let (front, longest) = CrackFront::from_lengths(&[(-4.0, 0.0), (4.0, 8.0)]).unwrap();
        assert_eq!((longest, front.share_at(0.0), front.polyline(4.0)), (8.0, 0.5, vec![[-2.0, 0.25], [2.0, 0.75]]));
        // one length, no length, no front
        let (same, length) = CrackFront::from_lengths(&[(-1.0, 3.0), (1.0, 3.0)]).unwrap();
        assert!(same.is_through() && length == 3.0 && same.open_parts(4.0, 0.9) == vec![[-2.0, 2.0]]);
        assert_eq!(CrackFront::from_lengths(&[(-1.0, 0.0), (1.0, 0.0)]).unwrap(), (CrackFront::default(), 0.0));
        for bad in
            [&[(0.0, 1.0)][..], &[(1.0, 1.0), (0.0, 2.0)], &[(0.0, -1.0), (1.0, 1.0)], &[(f64::NAN, 1.0), (1.0, 1.0)]]
        {
            assert!(CrackFront::from_lengths(bad).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn analytic_area_of_an_ellipse_and_a_polygon() {
        let pit = Pit::ellipse(1e-3, 5e-3, 4e-3, 2e-3, ProfileMeasure::RollDistance);
        let exact = std::f64::consts::PI * 2e-3 * 1e-3 / (20e-3 * 10e-3);
        assert!((pit.area_fraction(20e-3, [0.0, 10e-3]) / exact - 1.0).abs() < 2e-3);
        let corners = [(0.0, 1e-3), (4e-3, 1e-3), (4e-3, 3e-3)].map(|(x, y)| Vector2::new(x, y)).to_vec();
        let triangle = Pit { shapes: vec![PitShape::Polygon(corners)], depth: None };
        assert!((triangle.area_fraction(20e-3, [0.0, 10e-3]) / (4e-6 / 200e-6) - 1.0).abs() < 5e-3);
        // the same height as arc length reaches farther in roll distance, and farther down than up
        let arc = Pit::ellipse(0.0, 16e-3, 4e-3, 2e-3, ProfileMeasure::ArcLength { base_radius: 35e-3 });
        let [_, [low, high]] = arc.shapes[0].bounds();
        assert!(16e-3 - low > high - 16e-3 && high - 16e-3 > 2e-3);
        assert!(arc.contains(0.0, low + 1e-6) && !arc.contains(0.0, low - 1e-6) && arc.contains(0.0, high - 1e-6));
        assert!(triangle.contains(3.5e-3, 1.5e-3) && !triangle.contains(0.5e-3, 2.5e-3));
    }
}
