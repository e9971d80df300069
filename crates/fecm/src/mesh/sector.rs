//! Mesh of one tooth sector: the tooth, the body below it and half a root land on either side, between two radial cuts.
//!
//! Four blocks meet in a junction `J` on each fillet, where the outline's half turn is shared in three equal angles:
//!
//! ```text
//!            E- --- tip --- E+            tooth block: flank to flank
//!             |    tooth    |
//!   M- --- J- \_____chord__/ J+ --- M+    chord: also where a root crack runs (its nodes doubled up to the tip)
//!    | side |     body      | side |
//!   B- ---- K- ----------- K+ ---- B+     rim: bore, or the outside of a ring
//! ```
//!
//! The same walk serves internal gears: radii run the other way and the two sides change places.

use std::collections::HashSet;
use std::f64::consts::FRAC_PI_3;

use gear_geom::{CrackFront, CrackStart, FlankSide, Gear, GearKind, HalfToothOutline, OutlineSegment, RootCrack};
use nalgebra::{Point2, Rotation2, Vector2};

use super::blocks::{BlockElements, BlockMesher, Edge, Vertex, geometric_breaks};
use super::crack_path::{ChordPath, Junction, mouth_on_fillet, polyline_length};
use super::plane::PlaneMesh;
use crate::condense::{RichNode, Substructure};
use crate::element::ReferenceQuad;
use crate::error::FecmError;
use crate::face_part::FacePart;

/// How finely a sector is meshed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshDensity {
    /// Polynomial order of the elements in the plane, 1 to 8.
    pub order: usize,
    /// Scales the number of elements along every edge; 1 is the default mesh.
    pub density: f64,
}

impl Default for MeshDensity {
    fn default() -> Self {
        Self { order: 3, density: 1.0 }
    }
}

impl MeshDensity {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`FecmError::Option`].
    pub fn validate(&self) -> Result<(), FecmError> {
        if !(1..=8).contains(&self.order) {
            let value = self.order as f64;
            return Err(FecmError::Option { name: "element order", value, allowed: "1 to 8" });
        }
        if !(0.2..=10.0).contains(&self.density) {
            let value = self.density;
            return Err(FecmError::Option { name: "mesh density", value, allowed: "0.2 to 10" });
        }
        Ok(())
    }

    fn count(&self, base: f64) -> usize {
        ((base * self.density).round() as usize).max(1)
    }
}

/// Mesh edges along the involute part of one flank, from the fillet to the tip.
#[derive(Debug, Clone)]
pub struct FlankEdge {
    /// Nodes of each element edge, `order + 1` each.
    pub edges: Vec<Vec<u32>>,
    /// Involute arc length from the base circle, `s^2 / (2 r_b)` (m), at the ends of the element edges.
    pub arc_breaks: Vec<f64>,
}

/// Mesh of one sector `-pi/N <= theta <= pi/N`, tooth centred on the x axis.
#[derive(Debug, Clone)]
pub struct SectorMesh {
    /// The plane mesh.
    pub mesh: PlaneMesh,
    /// Angle of the sector (rad).
    pub sector_angle: f64,
    /// Nodes on the cut at `-sector_angle / 2`, from the rim to the root.
    pub lower_cut: Vec<u32>,
    /// Nodes on the cut at `+sector_angle / 2`, matching those of the lower cut.
    pub upper_cut: Vec<u32>,
    /// Nodes of the element edges on the rim (bore, or outside of a ring).
    pub rim: Vec<Vec<u32>>,
    /// Working flanks: lower (`theta < 0`), upper.
    pub flanks: [FlankEdge; 2],
    /// Elements of the tooth block.
    pub tooth_elements: Vec<u32>,
    /// Root crack, if the tooth has one.
    pub crack: Option<CrackFaces>,
}

/// The two faces of a crack in the mesh.
#[derive(Debug, Clone)]
pub struct CrackFaces {
    /// Nodes from the mouth to the tip, on the face toward the tooth and on the face toward the body; both end in the same tip node.
    pub nodes: [Vec<u32>; 2],
    /// Length along the path (m).
    pub length: f64,
    /// Length of the whole chord from fillet to fillet (m).
    pub chord: f64,
    /// Where the length varies along the face: the nodes around the crack, with the functions along the face that they have of their own; those on
    /// the face toward the tooth follow those on the other. Empty for a through crack.
    pub rich: Vec<RichNode>,
}

/// Nodes within this share of the facewidth of a crack, but no farther than the crack is long, have more functions along the face.
const ZONE: f64 = 0.25;

/// Quadratic and cubic functions on each layer of the face.
const LAYER_DEGREES: usize = 2;

/// Parts of the face shorter than this share of it are left closed.
const LEAST_PART: f64 = 1e-6;

/// Nodes that open where the crack reaches them, and those around it that need more functions along the face.
///
/// A node halfway along the front is as good open as closed, so it counts as open where the crack reaches half of the way to the next node.
fn rich_nodes(mesh: &PlaneMesh, nodes: &[Vec<u32>; 2], front: &CrackFront, width: f64, keep: &[u32]) -> Vec<RichNode> {
    if front.is_through() {
        return Vec::new();
    }
    let layer_degrees = LAYER_DEGREES;
    let path: Vec<Point2<f64>> = nodes[0].iter().map(|&node| mesh.nodes[node as usize]).collect();
    let total = polyline_length(&path);
    let zone = (ZONE * width).min(total);
    let (mut near_face, mut far_face) = (Vec::new(), Vec::new());
    let mut along = 0.0;
    for (k, pair) in path.windows(2).enumerate() {
        let step = (pair[1] - pair[0]).norm();
        let parts = front.open_parts(width, (along + 0.5 * step) / total).into_iter();
        let parts = parts.filter(|ends| ends[1] - ends[0] > LEAST_PART * width);
        let open: Vec<FacePart> = parts.map(|ends| FacePart::within(width, ends)).collect();
        let [far, near] = [nodes[0][k], nodes[1][k]];
        near_face.push(RichNode { node: near, follows: near, open: open.clone(), layer_degrees });
        far_face.push(RichNode { node: far, follows: near, open, layer_degrees: 0 });
        along += step;
    }
    let faces: HashSet<u32> = nodes.iter().flat_map(|face| &face[..path.len() - 1]).copied().collect();
    let around = (0..mesh.nodes.len() as u32).filter(|node| {
        let near = || path.iter().any(|point| (point - mesh.nodes[*node as usize]).norm() < zone);
        !faces.contains(node) && !keep.contains(node) && near()
    });
    let around = around.map(|node| RichNode { node, follows: node, open: Vec::new(), layer_degrees });
    near_face.into_iter().chain(far_face).chain(around).collect()
}

impl SectorMesh {
    /// Meshes the sector of a gear; `body` names it in errors.
    ///
    /// # Errors
    /// [`FecmError::Option`] for densities out of range, [`FecmError::InvertedElement`] when the blocks do not fit the tooth form.
    pub fn new(gear: &Gear, density: &MeshDensity, body: &'static str) -> Result<Self, FecmError> {
        Self::with_crack(gear, density, None, body)
    }

    /// Meshes a sector whose tooth may have a root crack, along the crack's path.
    ///
    /// # Errors
    /// As [`Self::new`]; [`FecmError::Crack`] for a crack that does not start on the fillet or leaves the tooth.
    pub fn with_crack(
        gear: &Gear,
        density: &MeshDensity,
        crack: Option<&RootCrack>,
        body: &'static str,
    ) -> Result<Self, FecmError> {
        density.validate()?;
        let crack = crack.filter(|crack| !crack.is_empty());
        let sector = SectorBuilder::new(gear, density, crack).build()?;
        sector.mesh.check(&ReferenceQuad::new(density.order), body)?;
        Ok(sector)
    }

    /// The sector as a body to condense onto its cuts (lower, then upper; radial and tangential axes). The rim is on springs of a
    /// stiffness per area (N/m^3), or held where there are none.
    #[must_use]
    pub fn substructure(&self, springs: Option<f64>) -> Substructure<'_> {
        let half = 0.5 * self.sector_angle;
        let lower = self.lower_cut.iter().map(|&node| (node, -half));
        let upper = self.upper_cut.iter().map(|&node| (node, half));
        Substructure {
            mesh: &self.mesh,
            retained: lower.chain(upper).collect(),
            fixed: if springs.is_none() { self.rim.concat() } else { Vec::new() },
            springs: springs.map(|stiffness| (stiffness, self.rim.as_slice())),
            rich: self.crack.as_ref().map_or(&[], |crack| crack.rich.as_slice()),
        }
    }

    /// Edge of one flank.
    #[must_use]
    pub fn flank(&self, side: FlankSide) -> &FlankEdge {
        match side {
            FlankSide::Lower => &self.flanks[0],
            FlankSide::Upper => &self.flanks[1],
        }
    }
}

/// Corners and edges of one half of the sector.
struct Half {
    /// From the junction up the flank to the tip.
    flank: Edge,
    /// Its part on the involute.
    involute: Edge,
    /// From the rim to the junction.
    column: Edge,
    /// From the junction to mid-space at the root circle.
    root: Edge,
    /// From the rim to mid-space, along the cut.
    cut: Edge,
    /// Along the rim, from below the junction to the cut.
    rim: Edge,
    junction: Vertex,
    /// Where the flank starts: the junction, or its double at the mouth of a crack.
    mouth: Vertex,
    tip: Vertex,
    rim_vertex: Vertex,
    at: Junction,
    rim_angle: f64,
}

struct SectorBuilder<'a> {
    gear: &'a Gear,
    density: &'a MeshDensity,
    outline: HalfToothOutline,
    half_angle: f64,
    rim_radius: f64,
    /// +1 when the tooth points away from the axis.
    outward: f64,
    involute_breaks: Vec<f64>,
    crack: Option<&'a RootCrack>,
    mesher: BlockMesher,
}

impl<'a> SectorBuilder<'a> {
    fn new(gear: &'a Gear, density: &'a MeshDensity, crack: Option<&'a RootCrack>) -> Self {
        Self {
            crack,
            gear,
            density,
            outline: gear.half_tooth_outline(),
            half_angle: std::f64::consts::PI / f64::from(gear.teeth()),
            rim_radius: gear.rim_radius(),
            outward: if gear.kind() == GearKind::External { 1.0 } else { -1.0 },
            involute_breaks: Vec::new(),
            mesher: BlockMesher::new(density.order),
        }
    }

    fn build(mut self) -> Result<SectorMesh, FecmError> {
        self.involute_breaks = self.equal_arc_breaks(self.density.count(8.0));
        // counter-clockwise: the lower half first when teeth point outward, the upper half first otherwise
        let first = self.half(-self.outward)?;
        let second = self.half(self.outward)?;
        let path = ChordPath::new(self.crack, &first.at, &second.at, self.outward)?;
        let across = self.across_breaks(&path);
        let (above, below, faces) = self.chord(&path, &first, &second, &across);
        let tip = self.tip_edge(&first, &second, &across);
        let rim = self.rim_edge(&first, &second, &across);
        let tooth = self.mesher.block(&first.flank, &second.flank, &above, &tip);
        self.mesher.block(&first.column, &second.column, &rim, &below);
        self.mesher.block(&second.column, &second.cut, &second.rim, &second.root);
        self.mesher.block(&first.cut, &first.column, &first.rim.reversed(), &first.root.reversed());
        let rim_edges = [&first.rim, &rim, &second.rim].map(|edge| self.split(edge)).concat();
        let flanks = [&first, &second]
            .map(|half| FlankEdge { edges: self.split(&half.involute), arc_breaks: self.involute_breaks.clone() });
        let cuts = [&first.cut, &second.cut].map(|cut| cut.nodes().to_vec());
        let mesh = self.mesher.finish();
        let keep = [rim_edges.concat(), cuts.concat()].concat();
        let crack = self.crack.zip(faces).map(|(crack, nodes)| CrackFaces {
            rich: rich_nodes(&mesh, &nodes, &crack.front, self.gear.facewidth(), &keep),
            nodes,
            length: path.crack_length,
            chord: path.chord_length,
        });
        let ([lower_flank, upper_flank], [lower_cut, upper_cut]) =
            if self.outward > 0.0 { (flanks, cuts) } else { (reverse(flanks), reverse(cuts)) };
        Ok(SectorMesh {
            crack,
            sector_angle: 2.0 * self.half_angle,
            lower_cut,
            upper_cut,
            rim: rim_edges,
            flanks: [lower_flank, upper_flank],
            tooth_elements: flatten(tooth),
            mesh,
        })
    }

    /// Involute arc lengths that divide the involute in equal parts, from the fillet to the tip.
    fn equal_arc_breaks(&self, count: usize) -> Vec<f64> {
        let arc = |u: f64| {
            let radius = self.outline.point(OutlineSegment::Flank, u).coords.norm();
            let base = self.gear.base_radius();
            (radius * radius - base * base).max(0.0) / (2.0 * base)
        };
        let (start, end) = (arc(0.0), arc(1.0));
        (0..=count).map(|k| start + (end - start) * k as f64 / count as f64).collect()
    }

    /// Fractions across the tooth: finer at the flanks, and at the tip of a crack.
    fn across_breaks(&self, path: &ChordPath) -> Vec<f64> {
        let Some(tip) = path.crack_tip else {
            let half = geometric_breaks(self.density.count(3.0), 1.5);
            let lower = half.iter().map(|b| 0.5 * b);
            let upper = half.iter().rev().skip(1).map(|b| 1.0 - 0.5 * b);
            return lower.chain(upper).collect();
        };
        // each part is fine at the crack's tip and at its flank, where the load comes in
        let part = |length: f64| {
            let count = |base: f64, slope: f64| self.density.count((base + slope * length).round());
            let from_tip = (0..count(1.0, 3.0)).map(|k| 1.7_f64.powi(k as i32));
            let to_flank = (0..count(1.0, 2.0)).rev().map(|k| 1.5_f64.powi(k as i32));
            let sizes: Vec<f64> = from_tip.chain(to_flank).collect();
            let total: f64 = sizes.iter().sum();
            let mut sum = 0.0;
            let mut breaks = vec![0.0];
            for size in sizes {
                sum += size / total;
                breaks.push(length * sum);
            }
            breaks
        };
        // a front that varies passes everywhere along the crack
        let cracked = |length: f64| {
            if self.crack.is_none_or(|crack| crack.front.is_through()) {
                return part(length);
            }
            let count = self.density.count(2.0 + 8.0 * length);
            even_breaks(count).iter().map(|b| length * b).collect()
        };
        let (first, second) =
            if path.from_first { (cracked(tip), part(1.0 - tip)) } else { (part(tip), cracked(1.0 - tip)) };
        let before = first.into_iter().rev().map(|b| tip - b);
        let after = second.into_iter().skip(1).map(|b| tip + b);
        before.chain(after).collect()
    }

    fn half(&mut self, sign: f64) -> Result<Half, FecmError> {
        let mirror = move |p: Point2<f64>| Point2::new(p.x, sign * p.y);
        let outline = self.outline.clone();
        let (rim_radius, half_angle) = (self.rim_radius, self.half_angle);
        let on_rim = move |angle: f64| Point2::new(rim_radius * angle.cos(), rim_radius * angle.sin());
        let crack = self.crack.filter(|crack| crack.side.sign() == sign);
        let middle_u = OutlinePath::new(&outline, &[(OutlineSegment::Fillet, 0.0, 1.0)]).locate(0.5).1;
        let start = crack.map_or(CrackStart::MiddleOfFillet, |crack| crack.start);
        let junction_u = mouth_on_fillet(&outline, start)?.unwrap_or(middle_u);
        let at_junction = outline.point(OutlineSegment::Fillet, junction_u);
        let up = outline.tangent(OutlineSegment::Fillet, junction_u);
        // the cut and the rim are those of every sector of the gear, wherever a crack starts
        let usual = outline.point(OutlineSegment::Fillet, middle_u);
        let rim_angle = half_angle * (usual.y.atan2(usual.x) / half_angle).clamp(0.4, 0.75);
        let space_point = outline.point(OutlineSegment::RootLand, 0.0);

        let junction = self.mesher.vertex(mirror(at_junction));
        // the mouth of a crack parts tooth and body
        let mouth = if crack.is_some() { self.mesher.vertex(mirror(at_junction)) } else { junction };
        let fillet_end = self.mesher.vertex(mirror(outline.point(OutlineSegment::Flank, 0.0)));
        let tip = self.mesher.vertex(mirror(outline.point(OutlineSegment::Flank, 1.0)));
        let space = self.mesher.vertex(mirror(space_point));
        let rim_vertex = self.mesher.vertex(mirror(on_rim(rim_angle)));
        let rim_cut = self.mesher.vertex(mirror(on_rim(half_angle)));

        let upper_fillet = OutlinePath::new(&outline, &[(OutlineSegment::Fillet, junction_u, 1.0)]);
        let fillet_breaks = even_breaks(self.density.count(3.0));
        let fillet = self.mesher.edge(mouth, fillet_end, &fillet_breaks, |t| mirror(upper_fillet.point(t)));
        let breaks = self.involute_breaks.clone();
        let base = self.gear.base_radius();
        let involute =
            self.mesher.edge(fillet_end, tip, &breaks, |arc| mirror(flank_point_at_arc(&outline, base, &breaks, arc)));

        // from the rim inward to the junction and to mid-space, elements shrinking toward the tooth
        let foot = on_rim(rim_angle);
        let radial_breaks = self.radial_breaks((usual - foot).norm());
        let direction = Rotation2::new(-self.outward * FRAC_PI_3 * 2.0) * up;
        let reach = (0.5 * (at_junction - foot).norm()).min(0.6 * self.gear.module());
        let bend = at_junction + direction * reach;
        let column =
            self.mesher.edge(rim_vertex, junction, &radial_breaks, |t| mirror(bezier(foot, bend, at_junction, t)));
        let cut_foot = on_rim(half_angle);
        let cut = self.mesher.edge(rim_cut, space, &radial_breaks, |t| mirror(cut_foot + (space_point - cut_foot) * t));

        let side_breaks = even_breaks(self.density.count(2.0));
        let root_path = OutlinePath::new(
            &outline,
            &[(OutlineSegment::Fillet, junction_u, 0.0), (OutlineSegment::RootLand, 1.0, 0.0)],
        );
        let root = self.mesher.edge(junction, space, &side_breaks, |t| mirror(root_path.point(t)));
        let rim = self
            .mesher
            .edge(rim_vertex, rim_cut, &side_breaks, |t| mirror(on_rim(rim_angle + t * (half_angle - rim_angle))));
        Ok(Half {
            flank: fillet.joined(&involute),
            mouth,
            involute,
            column,
            root,
            cut,
            rim,
            junction,
            tip,
            rim_vertex,
            at: Junction { point: mirror(at_junction), up: Vector2::new(up.x, sign * up.y), sign },
            rim_angle: sign * rim_angle,
        })
    }

    /// Fractions from the rim to the junction: elements grow away from the tooth.
    fn radial_breaks(&self, length: f64) -> Vec<f64> {
        let (first, ratio) = (0.55 * self.gear.module(), 1.5_f64);
        let count = (1.0 + length * (ratio - 1.0) / first).ln() / ratio.ln();
        let from_tooth =
            geometric_breaks(self.density.count(count.clamp(1.0, 8.0)), ratio.powf(1.0 / self.density.density));
        from_tooth.iter().rev().map(|b| 1.0 - b).collect()
    }

    /// From the first junction to the second, below the tooth: as the tooth block sees it and as the body block does. The two differ in
    /// the nodes along a crack.
    fn chord(
        &mut self,
        path: &ChordPath,
        first: &Half,
        second: &Half,
        across: &[f64],
    ) -> (Edge, Edge, Option<[Vec<u32>; 2]>) {
        let Some(tip) = path.crack_tip else {
            let edge = self.mesher.edge(first.junction, second.junction, across, |t| path.point(t));
            return (edge.clone(), edge, None);
        };
        let split = across.iter().position(|&b| b >= tip).unwrap_or(0);
        let (before, after) = (&across[..=split], &across[split..]);
        let end = self.mesher.vertex(path.point(tip));
        let at = |t| path.point(t);
        let (above, below, faces) = if path.from_first {
            let above = self.mesher.edge(first.mouth, end, before, at);
            let below = self.mesher.edge(first.junction, end, before, at);
            let rest = self.mesher.edge(end, second.junction, after, at);
            let faces = [above.nodes().to_vec(), below.nodes().to_vec()];
            (above.joined(&rest), below.joined(&rest), faces)
        } else {
            let rest = self.mesher.edge(first.junction, end, before, at);
            let above = self.mesher.edge(end, second.mouth, after, at);
            let below = self.mesher.edge(end, second.junction, after, at);
            let faces = [above.reversed().nodes().to_vec(), below.reversed().nodes().to_vec()];
            (rest.joined(&above), rest.joined(&below), faces)
        };
        (above, below, Some(faces))
    }

    /// From the first tip to the second: an arc through the ends of the involutes and the tip circle on the centre line. A tip round is
    /// too small to matter to the body and would flatten the corner of its element.
    fn tip_edge(&mut self, first: &Half, second: &Half, across: &[f64]) -> Edge {
        let corner = self.outline.point(OutlineSegment::Flank, 1.0);
        let crest = self.outline.point(OutlineSegment::TipLand, 1.0).coords.norm();
        let (radius, angle) = (corner.coords.norm(), corner.y.atan2(corner.x));
        let (from, to) = (first.at.sign * angle, second.at.sign * angle);
        self.mesher.edge(first.tip, second.tip, across, |t| {
            let (sine, cosine) = (from + t * (to - from)).sin_cos();
            let radius = radius + (crest - radius) * 4.0 * t * (1.0 - t);
            Point2::new(radius * cosine, radius * sine)
        })
    }

    /// Along the rim below the tooth.
    fn rim_edge(&mut self, first: &Half, second: &Half, across: &[f64]) -> Edge {
        let radius = self.rim_radius;
        let (from, to) = (first.rim_angle, second.rim_angle);
        self.mesher.edge(first.rim_vertex, second.rim_vertex, across, |t| {
            let angle = from + t * (to - from);
            Point2::new(radius * angle.cos(), radius * angle.sin())
        })
    }

    /// Nodes of the element edges along an edge.
    fn split(&self, edge: &Edge) -> Vec<Vec<u32>> {
        let p = self.density.order;
        (0..(edge.nodes().len() - 1) / p).map(|k| edge.nodes()[k * p..=(k + 1) * p].to_vec()).collect()
    }
}

fn reverse<T>([a, b]: [T; 2]) -> [T; 2] {
    [b, a]
}

fn flatten(elements: BlockElements) -> Vec<u32> {
    elements.into_iter().flatten().collect()
}

fn even_breaks(count: usize) -> Vec<f64> {
    (0..=count).map(|k| k as f64 / count as f64).collect()
}

/// Point of the flank at an involute arc length between the first and last break.
fn flank_point_at_arc(outline: &HalfToothOutline, base: f64, breaks: &[f64], arc: f64) -> Point2<f64> {
    let roll = |arc: f64| (2.0 * base * arc.max(0.0)).sqrt();
    let (start, end) = (roll(breaks[0]), roll(breaks[breaks.len() - 1]));
    outline.point(OutlineSegment::Flank, ((roll(arc) - start) / (end - start)).clamp(0.0, 1.0))
}

/// Consecutive pieces of the outline, walked by arc length.
struct OutlinePath<'a> {
    outline: &'a HalfToothOutline,
    /// Fraction of the length, segment, parameter: ascending.
    table: Vec<(f64, OutlineSegment, f64)>,
}

impl<'a> OutlinePath<'a> {
    /// Pieces `(segment, from, to)`; each starts where the one before ends.
    fn new(outline: &'a HalfToothOutline, pieces: &[(OutlineSegment, f64, f64)]) -> Self {
        const SAMPLES: usize = 64;
        let mut table = Vec::new();
        let mut length = 0.0;
        for &(segment, from, to) in pieces {
            let mut last = outline.point(segment, from);
            table.push((length, segment, from));
            for k in 1..=SAMPLES {
                let u = from + (to - from) * k as f64 / SAMPLES as f64;
                let point = outline.point(segment, u);
                length += (point - last).norm();
                table.push((length, segment, u));
                last = point;
            }
        }
        for entry in &mut table {
            entry.0 /= length;
        }
        Self { outline, table }
    }

    fn locate(&self, fraction: f64) -> (OutlineSegment, f64) {
        let next = self.table.partition_point(|entry| entry.0 < fraction).clamp(1, self.table.len() - 1);
        let ((a, _, u), (b, segment, v)) = (self.table[next - 1], self.table[next]);
        let same = self.table[next - 1].1 == segment;
        if !same || b <= a {
            return (segment, v);
        }
        (segment, u + (v - u) * ((fraction - a) / (b - a)).clamp(0.0, 1.0))
    }

    fn point(&self, fraction: f64) -> Point2<f64> {
        let (segment, u) = self.locate(fraction);
        self.outline.point(segment, u)
    }
}

fn bezier(a: Point2<f64>, bend: Point2<f64>, b: Point2<f64>, t: f64) -> Point2<f64> {
    let s = 1.0 - t;
    Point2::from(a.coords * (s * s) + bend.coords * (2.0 * s * t) + b.coords * (t * t))
}
