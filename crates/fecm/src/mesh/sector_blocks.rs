//! Blocks of a tooth sector.
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

use std::f64::consts::FRAC_PI_3;

use gear_geom::{CrackStart, Gear, GearKind, HalfToothOutline, OutlineSegment, RootCrack};
use nalgebra::{Point2, Rotation2, Vector2};

use super::blocks::{BlockElements, BlockMesher, Edge, Vertex, geometric_breaks};
use super::crack_path::{ChordPath, Junction, mouth_on_fillet};
use super::crack_zone::rich_nodes;
use super::outline_path::{OutlinePath, flank_point_at_arc};
use super::sector::{CrackFaces, FlankEdge, MeshDensity, SectorMesh};
use crate::error::FecmError;

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

/// Lays out a sector; see the header.
pub(super) struct SectorBuilder<'a> {
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
    pub fn new(gear: &'a Gear, density: &'a MeshDensity, crack: Option<&'a RootCrack>) -> Self {
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

    pub fn build(mut self) -> Result<SectorMesh, FecmError> {
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
fn bezier(a: Point2<f64>, bend: Point2<f64>, b: Point2<f64>, t: f64) -> Point2<f64> {
    let s = 1.0 - t;
    Point2::from(a.coords * (s * s) + bend.coords * (2.0 * s * t) + b.coords * (t * t))
}
