//! Stress at the roots of loaded teeth: largest tension on the loaded side and largest compression on the other.
//!
//! The stress along the fillet's tangent ([`crate::surface`]) is read at points of fillet and root land from mid-space to the involute, and at
//! places along the face; between three neighbouring points of the profile the largest value is that of a parabola. The stress is that of the
//! model's own fillet, under its own load distribution and rim: nothing is taken from a beam formula.

use std::collections::{HashMap, HashSet};

use gear_geom::FlankSide;
use rayon::prelude::*;

use super::model::PairModel;
use super::reading::SectorReading;
use super::result::PositionResult;
use crate::body::{GearBody, ToothSector};
use crate::element::lagrange::lobatto_points;
use crate::error::FecmError;
use crate::face::FaceModel;
use crate::functional::Functional;
use crate::mesh::SectorMesh;
use crate::surface::SurfacePoint;

/// An extreme of the tangential stress in a root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RootPeak {
    /// Stress along the profile's tangent (Pa), tension positive.
    pub stress: f64,
    /// Angle between the profile's tangent there and the tooth's centre line (rad); 30 degrees is the section of ISO 6336-3.
    pub tangent_angle: f64,
    /// Face position (m, 0 at mid-face). Where the scene is symmetric, the one at `z >= 0`.
    pub face: f64,
}

/// Root stress of one tooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RootStress {
    /// Pinion (0) or wheel (1).
    pub member: usize,
    /// Tooth pair.
    pub pair: i32,
    /// Largest stress on the side of the loaded flank.
    pub tension: RootPeak,
    /// Smallest stress on the other side.
    pub compression: RootPeak,
}

/// Reads root stresses of a pair's positions.
pub struct RootStressReader<'a> {
    model: &'a PairModel,
    members: [MemberReading; 2],
}

struct MemberReading {
    healthy: RootReading,
    damaged: HashMap<i32, RootReading>,
}

/// Points of one kind of sector.
struct RootReading {
    reading: SectorReading,
    /// Loaded side, other side.
    sides: [Vec<RootPoint>; 2],
    faces: Vec<f64>,
}

struct RootPoint {
    tangent_angle: f64,
    /// Arc length from the involute (m).
    along: f64,
    /// Whether the crack's mouth lies between this point and the one before.
    parted: bool,
}

impl PairModel {
    /// Prepares both gears for reading root stresses: a solve for every point of the fillets.
    #[must_use]
    pub fn root_stress_reader(&self) -> RootStressReader<'_> {
        let member = |index: usize| {
            let body = &self.bodies[index];
            let cracked: Vec<i32> = body.damaged_teeth().collect();
            let reading = |sector: &ToothSector, openings| RootReading::new(self, body, sector, openings);
            let healthy = reading(body.healthy_sector(), None);
            let of_tooth = |tooth: i32| {
                let openings = self.crack_on(index, tooth).map(|crack| &crack.openings[..]);
                (tooth, reading(body.sector(tooth), openings))
            };
            MemberReading { healthy, damaged: cracked.into_iter().map(of_tooth).collect() }
        };
        let (pinion, wheel) = rayon::join(|| member(0), || member(1));
        RootStressReader { model: self, members: [pinion, wheel] }
    }
}

impl RootStressReader<'_> {
    /// Root stresses of all loaded teeth at a position whose pressures were kept.
    ///
    /// # Errors
    /// Those of finding the loaded places in the mesh.
    pub fn read(&self, position: &PositionResult) -> Result<Vec<RootStress>, FecmError> {
        let mut all = Vec::new();
        for member in 0..2 {
            let loads = self.model.tooth_loads(position, member)?;
            for patch in &position.patches {
                let tooth = self.model.tooth_of(patch.pair, member);
                let own = &self.members[member];
                let root = own.damaged.get(&tooth).unwrap_or(&own.healthy);
                let body = &self.model.bodies[member];
                let values = root.reading.values(body, tooth, &loads, self.model.reach(member));
                let (tension, compression) = root.peaks(&values);
                all.push(RootStress { member, pair: patch.pair, tension, compression });
            }
        }
        Ok(all)
    }

    /// Root stresses of many positions, in parallel.
    ///
    /// # Errors
    /// The first error in the order of positions.
    pub fn read_all(&self, positions: &[PositionResult]) -> Result<Vec<Vec<RootStress>>, FecmError> {
        let all: Vec<Result<_, FecmError>> = positions.par_iter().map(|position| self.read(position)).collect();
        all.into_iter().collect()
    }
}

impl RootReading {
    fn new(model: &PairModel, body: &GearBody, sector: &ToothSector, openings: Option<&[Vec<Functional>]>) -> Self {
        let loaded = body.side;
        let sides = [loaded, loaded.other()].map(|side| root_points(&sector.shape, side));
        let faces = face_positions(model, body);
        let functionals = body.families.iter().map(|family| {
            let points = sides.iter().flatten();
            let along = |(point, _, _): &(SurfacePoint, f64, bool)| {
                let stress = point.stress(&family.basis);
                faces.iter().map(|&z| stress.at(&family.basis, z)).collect::<Vec<_>>()
            };
            points.flat_map(along).collect()
        });
        let functionals: Vec<Vec<_>> = functionals.collect();
        let reading = SectorReading::new(body, sector, &functionals, openings);
        let place = |(point, along, parted): &(SurfacePoint, f64, bool)| RootPoint {
            tangent_angle: point.tangent.x.abs().min(1.0).acos(),
            along: *along,
            parted: *parted,
        };
        Self { reading, sides: sides.map(|side| side.iter().map(place).collect()), faces }
    }

    fn peaks(&self, values: &[f64]) -> (RootPeak, RootPeak) {
        let split = self.sides[0].len() * self.faces.len();
        let tension = self.peak(&self.sides[0], &values[..split], 1.0);
        (tension, self.peak(&self.sides[1], &values[split..], -1.0))
    }

    /// Largest of `sign` times the stress.
    fn peak(&self, points: &[RootPoint], values: &[f64], sign: f64) -> RootPeak {
        let columns = self.faces.len();
        let at = |k: usize, column: usize| sign * values[k * columns + column];
        let places = (0..points.len()).flat_map(|k| (0..columns).map(move |column| (k, column)));
        let best = places.max_by(|a, b| at(a.0, a.1).total_cmp(&at(b.0, b.1)));
        let Some((k, column)) = best else {
            return RootPeak { stress: 0.0, tangent_angle: 0.0, face: 0.0 };
        };
        let (mut stress, mut angle) = (at(k, column), points[k].tangent_angle);
        let inside = k > 0 && k + 1 < points.len() && !points[k].parted && !points[k + 1].parted;
        if inside {
            let x = [k - 1, k, k + 1].map(|i| points[i].along);
            let y = [k - 1, k, k + 1].map(|i| at(i, column));
            if let Some((top, value)) = summit(x, y) {
                stress = value;
                let (from, to) = if top < x[1] { (k - 1, k) } else { (k, k + 1) };
                let part = (top - points[from].along) / (points[to].along - points[from].along);
                angle = points[from].tangent_angle + part * (points[to].tangent_angle - points[from].tangent_angle);
            }
        }
        RootPeak { stress: sign * stress, tangent_angle: angle, face: self.faces[column] }
    }
}

/// Place and height of the top of the parabola through three points, the middle one highest.
fn summit(x: [f64; 3], y: [f64; 3]) -> Option<(f64, f64)> {
    let (first, second) = ((y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1]));
    let bend = (second - first) / (x[2] - x[0]);
    if !(bend < 0.0) {
        return None;
    }
    let top = 0.5 * (x[0] + x[1]) - 0.5 * first / bend;
    let value = y[0] + first * (top - x[0]) + bend * (top - x[0]) * (top - x[1]);
    (top > x[0] && top < x[2]).then_some((top, value))
}

/// Places along the face: as many as the face model can tell apart; where the scene is symmetric, half of them.
pub(super) fn face_positions(model: &PairModel, body: &GearBody) -> Vec<f64> {
    let FaceModel::Solid { order } = model.options.face else { return vec![0.0] };
    let half = 0.5 * body.families[0].basis.width();
    // an even order has a point at mid-face, known to rounding
    let points =
        lobatto_points(2 * order.div_ceil(2)).into_iter().map(|x| if x.abs() < 1e-12 { 0.0 } else { half * x });
    points.filter(|&z| !model.face.mirrored || z >= 0.0).collect()
}

/// Points of a root from the involute to mid-space, with their distance from the involute; parted by the mouth of a crack.
fn root_points(sector: &SectorMesh, side: FlankSide) -> Vec<(SurfacePoint, f64, bool)> {
    let mut points: Vec<(SurfacePoint, f64, bool)> = Vec::new();
    let mut along = 0.0;
    for chain in root_chains(sector, side) {
        let mut parted = !points.is_empty();
        for edge in chain {
            for point in SurfacePoint::of_edge(&sector.mesh, &edge) {
                along += points.last().map_or(0.0, |(last, _, _)| (point.place - last.place).norm());
                points.push((point, along, parted));
                parted = false;
            }
        }
    }
    points
}

/// Element edges of a root in the direction from the involute to mid-space: one chain, or two where a crack parts it.
fn root_chains(sector: &SectorMesh, side: FlankSide) -> Vec<Vec<Vec<u32>>> {
    let mesh = &sector.mesh;
    let cut = match side {
        FlankSide::Lower => &sector.lower_cut,
        FlankSide::Upper => &sector.upper_cut,
    };
    let set = |nodes: &[u32]| nodes.iter().copied().collect::<HashSet<u32>>();
    let mut others = vec![set(&sector.lower_cut), set(&sector.upper_cut), set(&sector.rim.concat())];
    others.extend(sector.flanks.iter().map(|flank| set(&flank.edges.concat())));
    others.extend(sector.crack.iter().flat_map(|crack| crack.nodes.iter().map(|face| set(face))));
    let edges: Vec<Vec<u32>> = mesh
        .boundary_edges()
        .into_iter()
        .map(|(_, edge)| edge)
        .filter(|edge| !others.iter().any(|other| edge.iter().all(|node| other.contains(node))))
        .collect();
    let walk = |mut node: u32| {
        let mut chain: Vec<Vec<u32>> = Vec::new();
        let mut used = vec![false; edges.len()];
        while let Some(k) =
            (0..edges.len()).find(|&k| !used[k] && (edges[k][0] == node || edges[k][mesh.order] == node))
        {
            used[k] = true;
            let mut edge = edges[k].clone();
            if edge[0] != node {
                edge.reverse();
            }
            node = edge[mesh.order];
            chain.push(edge);
        }
        (chain, node)
    };
    let flank = sector.flank(side);
    let (start, middle) = (flank.edges.first(), cut.last().copied());
    let (Some(start), Some(middle)) = (start.map(|edge| edge[0]), middle) else { return Vec::new() };
    let (upper, end) = walk(start);
    if end == middle {
        return vec![upper];
    }
    let (mut lower, _) = walk(middle);
    lower.reverse();
    lower.iter_mut().for_each(|edge| edge.reverse());
    vec![upper, lower]
}
