//! A parametric housing: a wall of revolution closed by covers, around a ring gear, with what breaks the symmetry.
//!
//! The wall is a polyline of its middle in the meridian plane, with thicknesses; it runs from the lower hub outward, up, and inward to the upper hub, so
//! that the outside is on its right. Surfaces are joined by mitres. On it sit: the steel ring, bonded inside one segment; swellings, raised
//! on the outside by `thickness * cos^2` in angle and in length along the wall (ribs, bosses, pads); mounts, tied over a window of the outside;
//! bearings in the hubs; and the input port, a box-like boss around an opening of one segment, extruded along the pinion's axis.
//!
//! All of it is one lattice of hexahedra: around, along the wall, and through it (ring inside, boss outside). Lines of the lattice follow
//! the edges of windows, so that sets of nodes are the same area at any mesh density.

mod default;
mod lattice;

use fecm::Material;

use super::error::HousingError;
use super::model::{Housing, SensorPlace};
use lattice::Lattice;

/// Name of the node set, and seat, of the ring's teeth.
pub const RING_SEAT: &str = "ring_seat";

/// A point of the wall's middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallPoint {
    /// Distance from the axis (m).
    pub r: f64,
    /// Height (m).
    pub z: f64,
    /// Thickness (m).
    pub thickness: f64,
}

/// The ring, without teeth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingPart {
    /// Segment of the wall (between wall points `segment` and `segment + 1`) that holds it over its full height.
    pub segment: usize,
    /// Radius of its inside (m): that of the teeth's roots.
    pub inner_radius: f64,
    /// Its material.
    pub material: Material,
}

/// A rib, boss or pad: extra thickness on the outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swelling {
    /// Angle of its middle (rad).
    pub angle: f64,
    /// Angle over which it is more than half as thick (rad).
    pub width: f64,
    /// Length along the wall's middle from its first point to the swelling's middle (m).
    pub along: f64,
    /// Length over which it is more than half as thick (m).
    pub length: f64,
    /// Greatest extra thickness (m).
    pub thickness: f64,
}

/// A mount.
#[derive(Debug, Clone, PartialEq)]
pub struct MountPart {
    /// Name of its node set.
    pub name: String,
    /// Angle of its middle (rad).
    pub angle: f64,
    /// Angle it takes (rad).
    pub width: f64,
    /// First and last segment of the wall that it covers.
    pub segments: [usize; 2],
    /// Radial, tangential and axial stiffness (N/m).
    pub stiffness: [f64; 3],
}

/// A bearing in a hub.
#[derive(Debug, Clone, PartialEq)]
pub struct BearingPart {
    /// Name of its port.
    pub name: String,
    /// Segment of the wall that carries it on the side of the axis.
    pub segment: usize,
}

/// A bearing in the boss of the input port.
#[derive(Debug, Clone, PartialEq)]
pub struct BossBearing {
    /// Name of its port.
    pub name: String,
    /// Where it begins and ends: distance along the pinion's axis from the main axis (m).
    pub span: [f64; 2],
}

/// The input port.
#[derive(Debug, Clone, PartialEq)]
pub struct InputPart {
    /// Segment of the wall that it takes over its full height.
    pub segment: usize,
    /// Angle of its middle (rad).
    pub angle: f64,
    /// Angle it takes, walls included (rad).
    pub width: f64,
    /// Thickness of the boss's walls (m).
    pub thickness: f64,
    /// Rise of the pinion's axis, outward, over the level (rad).
    pub elevation: f64,
    /// Bearings, from the inside out, not overlapping; the boss ends with the last one.
    pub bearings: Vec<BossBearing>,
}

/// Size of elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CasingDensity {
    /// Longest element along the wall and around (m).
    pub element_size: f64,
    /// Elements through the wall.
    pub through_wall: usize,
    /// Elements through the ring.
    pub through_ring: usize,
}

/// A parametric housing. The default is of the size of a light helicopter's main transmission; see [`Casing::default`].
#[derive(Debug, Clone, PartialEq)]
pub struct Casing {
    /// Material of wall and boss.
    pub material: Material,
    /// The wall.
    pub wall: Vec<WallPoint>,
    /// The ring.
    pub ring: Option<RingPart>,
    /// Highest harmonic of the ring's seat.
    pub seat_harmonics: usize,
    /// Ribs, bosses and pads.
    pub swellings: Vec<Swelling>,
    /// Mounts.
    pub mounts: Vec<MountPart>,
    /// Bearings in hubs.
    pub bearings: Vec<BearingPart>,
    /// Input port.
    pub input: Option<InputPart>,
    /// Sensors.
    pub sensors: Vec<SensorPlace>,
    /// Size of elements.
    pub density: CasingDensity,
}

impl Casing {
    /// Meshes the housing.
    ///
    /// # Errors
    /// [`HousingError::Value`] naming what is out of range, [`HousingError::InvertedElement`] where parts do not fit each other.
    pub fn housing(&self) -> Result<Housing, HousingError> {
        self.validate()?;
        Lattice::new(self).housing()
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`HousingError::Value`].
    pub fn validate(&self) -> Result<(), HousingError> {
        let fault = |name, value, allowed| Err(HousingError::Value { name, value, allowed });
        let positive: Vec<(&'static str, f64)> = std::iter::empty()
            .chain(self.wall.iter().flat_map(|p| [("wall radius", p.r), ("wall thickness", p.thickness)]))
            .chain(self.ring.iter().map(|p| ("ring inner radius", p.inner_radius)))
            .chain(self.swellings.iter().flat_map(|p| [("swelling width", p.width), ("swelling length", p.length)]))
            .chain(self.mounts.iter().map(|p| ("mount width", p.width)))
            .chain(self.input.iter().flat_map(|p| [("input width", p.width), ("boss thickness", p.thickness)]))
            .chain([("element size", self.density.element_size)])
            .collect();
        if let Some(&(name, value)) = positive.iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            return fault(name, value, "a positive number");
        }
        let finite = self.wall.iter().map(|p| p.z).chain(self.mounts.iter().map(|p| p.angle));
        if let Some(value) = finite.chain(self.input.iter().map(|p| p.angle)).find(|x| !x.is_finite()) {
            return fault("height or angle", value, "a number");
        }
        if self.wall.len() < 2 {
            return fault("wall points", self.wall.len() as f64, "at least 2");
        }
        if self.density.through_wall == 0 || self.density.through_ring == 0 {
            return fault("elements through wall or ring", 0.0, "at least 1");
        }
        let lengths = self.segment_lengths();
        if let Some(&value) = lengths.iter().find(|length| !(**length > 0.0)) {
            return fault("length of a wall segment", value, "more than 0");
        }
        let total: f64 = lengths.iter().sum();
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let finest = total / self.density.element_size;
        if finest > 1e4 {
            return fault("element size", self.density.element_size, "at least a ten-thousandth of the wall's length");
        }
        let segments = std::iter::empty()
            .chain(self.ring.iter().map(|p| p.segment))
            .chain(self.mounts.iter().flat_map(|p| p.segments))
            .chain(self.bearings.iter().map(|p| p.segment))
            .chain(self.input.iter().map(|p| p.segment));
        if let Some(segment) = segments.into_iter().find(|&segment| segment >= lengths.len()) {
            return fault("wall segment", segment as f64, "less than the number of wall points less one");
        }
        if let Some(input) = &self.input {
            let half_angle = input.thickness / self.wall[input.segment].r.max(self.wall[input.segment + 1].r);
            if !(2.0 * input.thickness < lengths[input.segment] && 2.0 * half_angle < input.width) {
                return fault("boss thickness", input.thickness, "less than half the input port's height and width");
            }
            if !(input.width < std::f64::consts::PI) {
                return fault("input width", input.width, "less than half a turn");
            }
            let ends: Vec<f64> = input.bearings.iter().flat_map(|b| b.span).collect();
            if !(ends.first().is_some_and(|first| *first > 0.0) && ends.windows(2).all(|w| w[0] <= w[1]))
                || input.bearings.iter().any(|b| !(b.span[0] < b.span[1]))
            {
                let value = ends.first().copied().unwrap_or(f64::NAN);
                return fault(
                    "bearing span of the input port",
                    value,
                    "at least one bearing, spans ascending, from the inside out",
                );
            }
        }
        debug_assert!(longest <= total);
        Ok(())
    }

    fn segment_lengths(&self) -> Vec<f64> {
        self.wall.windows(2).map(|w| (w[1].r - w[0].r).hypot(w[1].z - w[0].z)).collect()
    }
}
