//! A whole gear as quadratic triangles: constrained Delaunay refinement of its outline, graded toward the contact.

use std::collections::HashMap;

use anyhow::{Context, ensure};
use gear_geom::{Gear, GearPair, HalfToothOutline, Member, OutlineSegment};
use nalgebra::{Point2, Rotation2};
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, RefinementParameters, Triangulation};

/// Six-node triangles: corners counter-clockwise, then the middles of edges 1-2, 2-3, 3-1.
pub struct TriangleMesh {
    /// Nodes in space (m).
    pub nodes: Vec<Point2<f64>>,
    /// Elements.
    pub elements: Vec<[usize; 6]>,
    /// Element and edge (1 to 3) of the working flanks that may touch.
    pub contact_faces: Vec<(usize, usize)>,
    /// Nodes on the bore.
    pub bore: Vec<usize>,
}

impl TriangleMesh {
    /// Drops nodes without elements (those of triangles outside the gear).
    fn drop_unused_nodes(&mut self) {
        let mut used = vec![false; self.nodes.len()];
        for &node in self.elements.iter().flatten() {
            used[node] = true;
        }
        let mut number = vec![0; self.nodes.len()];
        let mut kept = Vec::new();
        for (old, point) in self.nodes.iter().enumerate().filter(|(old, _)| used[*old]) {
            number[old] = kept.len();
            kept.push(*point);
        }
        self.nodes = kept;
        for node in self.elements.iter_mut().flatten().chain(&mut self.bore) {
            *node = number[*node];
        }
    }
}

/// A crack in a tooth: its path from the mouth on the fillet to the tip, in the frame of tooth 0.
pub struct CrackPath {
    /// Tooth number.
    pub tooth: i32,
    /// Whether it starts on the upper half of the tooth.
    pub upper: bool,
    /// Points.
    pub points: Vec<Point2<f64>>,
}

/// Where a boundary edge lies.
#[derive(Clone, Copy)]
enum Place {
    /// A piece of a tooth's outline: tooth, upper half, segment, parameters of the two ends.
    Tooth {
        tooth: i32,
        upper: bool,
        segment: OutlineSegment,
        ends: [f64; 2],
    },
    Bore {
        angles: [f64; 2],
    },
}

/// Largest elements: on the outline of the teeth and on the bore, in modules.
const COARSEST: f64 = 0.3;
/// Largest elements on fillets, in modules; on tip rounds it is their radius.
const FILLET: f64 = 0.08;
/// Edges that bulge by more than this fraction of their length stay straight: their elements would fold.
const MOST_BULGE: f64 = 0.06;
/// Growth of boundary elements with the distance from the contact.
const GROWTH: f64 = 0.2;

struct Outline<'a> {
    gear: &'a Gear,
    half: HalfToothOutline,
    pitch: f64,
}

/// A polyline with points about as far apart as wanted where they are, ends kept.
fn resampled(points: &[Point2<f64>], size: &impl Fn(Point2<f64>) -> f64) -> Vec<Point2<f64>> {
    let mut measure = vec![0.0];
    for pair in points.windows(2) {
        let last = measure[measure.len() - 1];
        measure.push(last + (pair[1] - pair[0]).norm() / size(nalgebra::center(&pair[0], &pair[1])));
    }
    let total = measure[points.len() - 1];
    let count = total.ceil().max(2.0) as usize;
    (0..=count)
        .map(|k| {
            let wanted = total * k as f64 / count as f64;
            let next = measure.partition_point(|&m| m < wanted).clamp(1, points.len() - 1);
            let share = (wanted - measure[next - 1]) / (measure[next] - measure[next - 1]);
            points[next - 1] + (points[next] - points[next - 1]) * share.clamp(0.0, 1.0)
        })
        .collect()
}

/// Whether a point lies inside a closed polygon.
fn is_inside(corners: &[Point2<f64>], point: Point2<f64>) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossings = edges.filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossings.count() % 2 == 1
}

/// Side of the nearest segment of a polyline on which a point lies.
fn is_left_of(line: &[Point2<f64>], point: Point2<f64>) -> bool {
    let nearest = line.windows(2).map(|pair| {
        let (along, to) = (pair[1] - pair[0], point - pair[0]);
        let t = (along.dot(&to) / along.norm_squared()).clamp(0.0, 1.0);
        ((to - along * t).norm(), along.x * to.y - along.y * to.x)
    });
    nearest.min_by(|a, b| a.0.total_cmp(&b.0)).is_some_and(|(_, cross)| cross > 0.0)
}

impl Outline<'_> {
    /// Parameter of the fillet nearest to a point of either half, in the frame of tooth 0.
    fn fillet_parameter(&self, point: Point2<f64>) -> f64 {
        let point = Point2::new(point.x, point.y.abs());
        let distance = |u: f64| (self.half.point(OutlineSegment::Fillet, u) - point).norm();
        let mut best =
            (0..=400).map(|k| f64::from(k) / 400.0).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0.5);
        let mut reach = 1.0 / 400.0;
        for _ in 0..40 {
            reach *= 0.5;
            for u in [best - reach, best + reach] {
                if distance(u) < distance(best) {
                    best = u;
                }
            }
        }
        best
    }

    fn point(&self, place: Place, t: f64) -> Point2<f64> {
        let mix = |ends: [f64; 2]| ends[0] + t * (ends[1] - ends[0]);
        match place {
            Place::Tooth { tooth, upper, segment, ends } => {
                let own = self.half.point(segment, mix(ends));
                let own = if upper { own } else { Point2::new(own.x, -own.y) };
                Rotation2::new(self.pitch * f64::from(tooth)) * own
            }
            Place::Bore { angles } => {
                let angle = mix(angles);
                Point2::new(angle.cos(), angle.sin()) * self.gear.rim_radius()
            }
        }
    }

    /// Splits a boundary piece so that edges have about the size wanted where they are.
    fn split(&self, whole: Place, size: &impl Fn(Point2<f64>) -> f64) -> Vec<Place> {
        const FINE: usize = 2000;
        let points: Vec<Point2<f64>> = (0..=FINE).map(|k| self.point(whole, k as f64 / FINE as f64)).collect();
        // measure in wanted edges
        let mut measure = vec![0.0];
        for pair in points.windows(2) {
            let last = measure[measure.len() - 1];
            measure.push(last + (pair[1] - pair[0]).norm() / size(pair[0]));
        }
        let total = measure[FINE];
        if total < 1e-9 {
            return Vec::new();
        }
        let count = total.ceil() as usize;
        let at = |wanted: f64| {
            let k = measure.partition_point(|&m| m < wanted).clamp(1, FINE);
            let share = (wanted - measure[k - 1]) / (measure[k] - measure[k - 1]).max(1e-300);
            ((k - 1) as f64 + share) / FINE as f64
        };
        let cuts: Vec<f64> = (0..=count)
            .map(|k| {
                if k == 0 {
                    0.0
                } else if k == count {
                    1.0
                } else {
                    at(total * k as f64 / count as f64)
                }
            })
            .collect();
        cuts.windows(2)
            .map(|cut| {
                let inner =
                    |ends: [f64; 2]| [ends[0] + cut[0] * (ends[1] - ends[0]), ends[0] + cut[1] * (ends[1] - ends[0])];
                match whole {
                    Place::Tooth { tooth, upper, segment, ends } => {
                        Place::Tooth { tooth, upper, segment, ends: inner(ends) }
                    }
                    Place::Bore { angles } => Place::Bore { angles: inner(angles) },
                }
            })
            .collect()
    }
}

/// Meshes one gear of a pair as it stands at a mesh cycle, contact elements of about `finest` (m), all others scaled by `bulk`.
pub fn whole_gear(
    pair: &GearPair,
    member: Member,
    pairs: &[i32],
    mesh_cycle: f64,
    (finest, bulk): (f64, f64),
    crack: Option<&CrackPath>,
) -> anyhow::Result<TriangleMesh> {
    let gear = pair.gear(member);
    let outline =
        Outline { gear, half: gear.half_tooth_outline(), pitch: std::f64::consts::TAU / f64::from(gear.teeth()) };
    let upper_works = pair.working_side(member).sign() > 0.0;
    let step = pair.tooth_step(member);
    let tip = gear.roll_distance(gear.tip_form_radius());
    let form = gear.roll_distance(gear.form_radius());
    let turned = |tooth: i32, point: Point2<f64>| Rotation2::new(outline.pitch * f64::from(tooth)) * point;
    let mut focuses: Vec<Point2<f64>> = pairs
        .iter()
        .map(|&k| {
            let roll = pair.contact_roll(member, k, mesh_cycle).clamp(form, tip);
            Rotation2::new(outline.pitch * f64::from(k * step)) * gear.flank_point(pair.working_side(member), roll)
        })
        .collect();
    if let Some(crack) = crack {
        focuses.extend(crack.points.last().map(|tip| turned(crack.tooth, *tip)));
    }
    // teeth from -z/2 on, so that the numbers of pairs are tooth numbers
    let teeth = gear.teeth() as i32;
    let first = -teeth / 2;
    let size = |point: Point2<f64>| {
        let distance = focuses.iter().map(|c| (c - point).norm()).fold(f64::INFINITY, f64::min);
        // uniform over three sizes around the contact, growing beyond
        (finest + bulk * GROWTH * (distance - 6.0 * finest).max(0.0)).min(bulk * COARSEST * gear.module())
    };
    let mut boundary: Vec<Place> = Vec::new();
    for tooth in first..first + teeth {
        for upper in [false, true] {
            let segments: Vec<OutlineSegment> =
                if upper { OutlineSegment::ALL.iter().rev().copied().collect() } else { OutlineSegment::ALL.to_vec() };
            for segment in segments {
                let ends = if upper { [1.0, 0.0] } else { [0.0, 1.0] };
                let most = match segment {
                    OutlineSegment::Fillet => bulk * FILLET * gear.module(),
                    OutlineSegment::TipRound => gear.tip_round(),
                    _ => f64::INFINITY,
                };
                // the mouth of a crack is a point of the outline
                let mouth = crack.filter(|crack| {
                    let own = crack.tooth.rem_euclid(teeth) == tooth.rem_euclid(teeth);
                    own && crack.upper == upper && segment == OutlineSegment::Fillet
                });
                let pieces = match mouth.map(|crack| outline.fillet_parameter(crack.points[0])) {
                    Some(u) => vec![[ends[0], u], [u, ends[1]]],
                    None => vec![ends],
                };
                for ends in pieces {
                    let piece = Place::Tooth { tooth, upper, segment, ends };
                    boundary.extend(outline.split(piece, &|p| size(p).min(most)));
                }
            }
        }
    }
    let bore_start = boundary.len();
    boundary.extend(outline.split(Place::Bore { angles: [0.0, std::f64::consts::TAU] }, &size));
    let slit = crack.map(|crack| resampled(&crack.points, &|p| size(turned(crack.tooth, p))));
    let slit: Vec<Point2<f64>> =
        slit.into_iter().flatten().map(|p| turned(crack.map_or(0, |crack| crack.tooth), p)).collect();
    triangulate(&outline, &boundary, bore_start, &slit, |place| match place {
        Place::Tooth { tooth, upper, segment, .. } => {
            upper == upper_works
                && matches!(segment, OutlineSegment::Flank | OutlineSegment::TipRound)
                && pairs.iter().any(|&k| (k * step - tooth).rem_euclid(teeth) == 0)
        }
        Place::Bore { .. } => false,
    })
    .map(|mut mesh| {
        let turn = Rotation2::new(pair.tooth_angle(member, 0, mesh_cycle));
        let centre = pair.centre(member);
        for node in &mut mesh.nodes {
            *node = centre + turn * node.coords;
        }
        mesh
    })
}

fn triangulate(
    outline: &Outline<'_>,
    boundary: &[Place],
    bore_start: usize,
    slit: &[Point2<f64>],
    touches: impl Fn(Place) -> bool,
) -> anyhow::Result<TriangleMesh> {
    let mut triangulation = ConstrainedDelaunayTriangulation::<spade::Point2<f64>>::new();
    let starts: Vec<Point2<f64>> = boundary.iter().map(|&place| outline.point(place, 0.0)).collect();
    let handles = starts
        .iter()
        .map(|p| triangulation.insert(spade::Point2::new(p.x, p.y)))
        .collect::<Result<Vec<_>, _>>()
        .context("outline point")?;
    // loops: outline, bore
    let next = |k: usize| match k + 1 {
        n if n == bore_start => 0,
        n if n == boundary.len() => bore_start,
        n => n,
    };
    let mut place_of = HashMap::new();
    for k in 0..boundary.len() {
        ensure!(triangulation.can_add_constraint(handles[k], handles[next(k)]), "the outline crosses itself");
        triangulation.add_constraint(handles[k], handles[next(k)]);
        place_of.insert((handles[k].index(), handles[next(k)].index()), boundary[k]);
    }
    // the first point of a slit is a point of the outline
    let mut slit_handles = Vec::new();
    for (k, point) in slit.iter().enumerate() {
        let on_outline =
            || (0..bore_start).min_by(|&a, &b| (starts[a] - point).norm().total_cmp(&(starts[b] - point).norm()));
        slit_handles.push(match on_outline().filter(|_| k == 0) {
            Some(nearest) => handles[nearest],
            None => triangulation.insert(spade::Point2::new(point.x, point.y)).context("crack point")?,
        });
    }
    for pair in slit_handles.windows(2) {
        ensure!(triangulation.can_add_constraint(pair[0], pair[1]), "the crack crosses the outline");
        triangulation.add_constraint(pair[0], pair[1]);
    }
    let parameters = RefinementParameters::<f64>::new()
        // a slit ends inside: what is outside is then told by the outline alone, below
        .exclude_outer_faces(slit.is_empty())
        .keep_constraint_edges()
        .with_angle_limit(AngleLimit::from_deg(26.0))
        .with_max_additional_vertices(400_000);
    let outcome = triangulation.refine(parameters);
    let excluded: std::collections::HashSet<_> = outcome.excluded_faces.into_iter().collect();
    let mut mesh = TriangleMesh {
        nodes: triangulation.vertices().map(|v| Point2::new(v.position().x, v.position().y)).collect(),
        elements: Vec::new(),
        contact_faces: Vec::new(),
        bore: Vec::new(),
    };
    // every point of the slit but its tip is doubled for the triangles on its left
    let mut doubles: HashMap<usize, usize> = HashMap::new();
    for handle in slit_handles.iter().rev().skip(1) {
        doubles.insert(handle.index(), mesh.nodes.len());
        mesh.nodes.push(mesh.nodes[handle.index()]);
    }
    let mut middles: HashMap<(usize, usize), usize> = HashMap::new();
    let (rim, bore_radius) = (&starts[..bore_start], outline.gear.rim_radius());
    for face in triangulation.inner_faces().filter(|face| !excluded.contains(&face.fix())) {
        let corners = face.vertices().map(|v| v.fix().index());
        let centroid =
            Point2::from(corners.iter().map(|&c| mesh.nodes[c].coords).sum::<nalgebra::Vector2<f64>>() / 3.0);
        if !slit.is_empty() && (centroid.coords.norm() < bore_radius || !is_inside(rim, centroid)) {
            continue;
        }
        let double = |corner: usize| {
            let doubled = doubles.get(&corner).filter(|_| is_left_of(slit, centroid));
            doubled.copied().unwrap_or(corner)
        };
        let own = corners.map(double);
        let mut element = [own[0], own[1], own[2], 0, 0, 0];
        for edge in 0..3 {
            let place_at = |a: usize, b: usize| place_of.get(&(a, b)).or_else(|| place_of.get(&(b, a))).copied();
            let place = place_at(corners[edge], corners[(edge + 1) % 3]);
            let (a, b) = (own[edge], own[(edge + 1) % 3]);
            let middle = *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let straight = nalgebra::center(&mesh.nodes[a], &mesh.nodes[b]);
                let most = MOST_BULGE * (mesh.nodes[b] - mesh.nodes[a]).norm();
                let curved = place.map(|place| outline.point(place, 0.5)).filter(|p| (p - straight).norm() < most);
                mesh.nodes.push(curved.unwrap_or(straight));
                mesh.nodes.len() - 1
            });
            element[3 + edge] = middle;
            match place {
                Some(Place::Bore { .. }) => mesh.bore.extend([a, b, middle]),
                Some(place) if touches(place) => mesh.contact_faces.push((mesh.elements.len(), edge + 1)),
                _ => {}
            }
        }
        mesh.elements.push(element);
    }
    mesh.bore.sort_unstable();
    mesh.bore.dedup();
    mesh.drop_unused_nodes();
    let (elements, faces, bore) = (mesh.elements.len(), mesh.contact_faces.len(), mesh.bore.len());
    ensure!(
        faces > 0 && bore > 0,
        "the mesh of {elements} elements has {faces} contact faces and {bore} nodes on the bore"
    );
    Ok(mesh)
}
