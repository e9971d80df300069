//! The lattice of a parametric housing. Coordinates count half elements: `i` around, `j` along the wall, `k` through it, 0 on its inside.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};

use super::{Casing, InputPart, RING_SEAT};
use crate::housing::element::Kind;
use crate::housing::error::HousingError;
use crate::housing::mesh::{Element, SolidMesh};
use crate::housing::model::{Housing, Mount, PortPlace, SeatPlace, Tie};

/// Kind of the elements on a level of a wall of so many cells along: reduced integration bends more freely on few elements, but leaves motions
/// without stiffness where a part is one element wide, as the boss's walls are.
fn kind(level: i32, through_wall: i32, along: usize) -> Kind {
    if (0..through_wall).contains(&level) && along > 1 { Kind::Hex20R } else { Kind::Hex20 }
}

/// A place of the lattice.
type Key = [i32; 3];

/// A line across the wall.
#[derive(Debug, Clone, Copy)]
struct Station {
    segment: usize,
    /// Part of the segment.
    fraction: f64,
}

/// What part a cell around and along the wall plays for the input port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Window {
    Outside,
    Frame,
    Opening,
}

pub(super) struct Lattice<'a> {
    casing: &'a Casing,
    /// Angles of the lines around, one turn, without the last.
    angles: Vec<f64>,
    /// First station of each cell along the wall, and its end.
    cells: Vec<[Station; 2]>,
    /// Surfaces of the wall at its points: inside, outside.
    surfaces: Vec<[Vector2<f64>; 2]>,
    /// Length along the wall to its points.
    lengths: Vec<f64>,
    /// Cells through the wall, ring and boss.
    through: [i32; 3],
    /// Distances along the pinion's axis of the boss's levels after the wall.
    levels: Vec<f64>,
}

/// The pinion's axis.
#[derive(Debug, Clone, Copy)]
struct Axis {
    start: Vector3<f64>,
    direction: Vector3<f64>,
}

impl<'a> Lattice<'a> {
    pub(super) fn new(casing: &'a Casing) -> Self {
        let lengths: Vec<f64> = std::iter::once(0.0)
            .chain(casing.segment_lengths().iter().scan(0.0, |sum, length| {
                *sum += length;
                Some(*sum)
            }))
            .collect();
        let levels: Vec<f64> =
            casing.input.iter().flat_map(|input| levels(input, casing.density.element_size)).collect();
        let ring_cells = casing.ring.map_or(0, |_| casing.density.through_ring as i32);
        Self {
            angles: angles(casing),
            cells: cells(casing),
            surfaces: surfaces(casing),
            lengths,
            through: [casing.density.through_wall as i32, ring_cells, levels.len() as i32],
            levels,
            casing,
        }
    }

    pub(super) fn housing(&self) -> Result<Housing, HousingError> {
        let mut mesh =
            SolidMesh { materials: vec![("casing".to_owned(), self.casing.material)], ..SolidMesh::default() };
        if let Some(ring) = self.casing.ring {
            mesh.materials.push(("ring".to_owned(), ring.material));
        }
        let mut numbers: BTreeMap<Key, u32> = BTreeMap::new();
        let [wall, ring, boss] = self.through;
        let corners = Kind::Hex20.reference_nodes();
        for around in 0..self.angles.len() {
            for along in 0..self.cells.len() {
                let window = self.window(around, along);
                for level in -ring..wall + boss {
                    let present = match level {
                        level if level < 0 => {
                            self.casing.ring.is_some_and(|r| r.segment == self.cells[along][0].segment)
                        }
                        level if level < wall => window != Window::Opening,
                        _ => window == Window::Frame,
                    };
                    if !present {
                        continue;
                    }
                    let nodes = corners.iter().map(|at| {
                        // reference coordinates -1, 0, 1 are half elements 0, 1, 2; around, along, outward is right-handed
                        let key = self.key([2 * around as i32, 2 * along as i32, 2 * level], at);
                        *numbers.entry(key).or_insert_with(|| {
                            mesh.nodes.push(self.place(key).into());
                            mesh.nodes.len() as u32 - 1
                        })
                    });
                    let nodes = nodes.collect();
                    mesh.elements.push(Element {
                        kind: kind(level, wall, self.cells.len()),
                        material: usize::from(level < 0),
                        nodes,
                    });
                }
            }
        }
        self.name_sets(&mut mesh, &numbers);
        Ok(self.with_roles(mesh))
    }

    fn key(&self, first: Key, at: &[f64; 3]) -> Key {
        let mut key: Key = std::array::from_fn(|d| first[d] + at[d] as i32 + 1);
        key[0] %= 2 * self.angles.len() as i32;
        key
    }

    fn angle(&self, i: i32) -> f64 {
        let n = self.angles.len();
        let line = |index: usize| self.angles[index % n] + TAU * (index / n) as f64;
        let index = (i / 2) as usize;
        if i % 2 == 0 { line(index) } else { 0.5 * (line(index) + line(index + 1)) }
    }

    fn station(&self, j: i32) -> Station {
        let cell = (j / 2) as usize;
        match self.cells.get(cell) {
            Some(ends) if j % 2 == 0 => ends[0],
            Some(ends) => Station { segment: ends[0].segment, fraction: 0.5 * (ends[0].fraction + ends[1].fraction) },
            None => Station { segment: self.surfaces.len() - 2, fraction: 1.0 },
        }
    }

    /// Place of a lattice point (m).
    fn place(&self, [i, j, k]: Key) -> Vector3<f64> {
        let (angle, station) = (self.angle(i), self.station(j));
        let outside = 2 * self.through[0];
        let [inner, outer] = [0, 1].map(|side| {
            let [a, b] = [self.surfaces[station.segment][side], self.surfaces[station.segment + 1][side]];
            a + station.fraction * (b - a)
        });
        let outer = outer + self.swelling(angle, station) * (outer - inner).normalize();
        let turned = |x: Vector2<f64>| Vector3::new(x.x * angle.cos(), x.x * angle.sin(), x.y);
        if k < 0 {
            let ring = self.casing.ring.map_or(inner.x, |ring| ring.inner_radius);
            let share = f64::from(-k) / f64::from(2 * self.through[1]);
            return turned(Vector2::new(inner.x + share * (ring - inner.x), inner.y));
        }
        let share = f64::from(k.min(outside)) / f64::from(outside);
        let wall = turned(inner + share * (outer - inner));
        match self.axis() {
            Some(axis) if k > outside => {
                let base = (wall - axis.start).dot(&axis.direction);
                let level = |index: usize| if index == 0 { base } else { self.levels[index - 1] };
                let (index, odd) = (((k - outside) / 2) as usize, (k - outside) % 2 == 1);
                let distance = if odd { 0.5 * (level(index) + level(index + 1)) } else { level(index) };
                wall + (distance - base) * axis.direction
            }
            _ => wall,
        }
    }

    fn swelling(&self, angle: f64, station: Station) -> f64 {
        let [start, end] = [self.lengths[station.segment], self.lengths[station.segment + 1]];
        let along = start + station.fraction * (end - start);
        let bump = |x: f64, width: f64| {
            // half of the height at half of the width
            let phase = std::f64::consts::FRAC_PI_2 * x / width;
            if phase.abs() < std::f64::consts::FRAC_PI_2 { phase.cos().powi(2) } else { 0.0 }
        };
        let one = |s: &super::Swelling| {
            s.thickness * bump(turn_between(angle, s.angle), s.width) * bump(along - s.along, s.length)
        };
        self.casing.swellings.iter().map(one).sum()
    }

    /// Axis of the pinion, through the middle of the input port's outside.
    fn axis(&self) -> Option<Axis> {
        let input = self.casing.input.as_ref()?;
        let middle = 0.5 * (self.surfaces[input.segment][1] + self.surfaces[input.segment + 1][1]);
        let (level, rise) = (input.elevation.cos(), input.elevation.sin());
        let direction = Vector3::new(level * input.angle.cos(), level * input.angle.sin(), rise);
        Some(Axis { start: Vector3::new(0.0, 0.0, middle.y - middle.x * rise / level), direction })
    }

    fn middle_angle(&self, around: usize) -> f64 {
        self.angle(2 * around as i32 + 1)
    }

    fn window(&self, around: usize, along: usize) -> Window {
        let Some(input) = &self.casing.input else { return Window::Outside };
        let [start, end] = self.cells[along];
        let offset = turn_between(self.middle_angle(around), input.angle).abs();
        if start.segment != input.segment || offset > 0.5 * input.width {
            return Window::Outside;
        }
        let (edge_angle, edge) = self.frame(input);
        let middle = 0.5 * (start.fraction + end.fraction);
        let inside = offset < 0.5 * input.width - edge_angle && middle > edge && middle < 1.0 - edge;
        if inside { Window::Opening } else { Window::Frame }
    }

    /// Thickness of the boss's walls as an angle and as a part of the segment.
    fn frame(&self, input: &InputPart) -> (f64, f64) {
        frame(self.casing, input)
    }

    /// Cells around and along the wall that touch a lattice line crossing.
    fn cells_at(&self, i: i32, j: i32) -> Vec<(usize, usize)> {
        let n = self.angles.len() as i32;
        let touching = |x: i32| if x % 2 == 0 { vec![x / 2 - 1, x / 2] } else { vec![x / 2] };
        let along = touching(j).into_iter().filter(|&c| c >= 0 && (c as usize) < self.cells.len());
        let around = touching(i).into_iter().map(|c| c.rem_euclid(n) as usize);
        let around: Vec<usize> = around.collect();
        along.flat_map(|along| around.iter().map(move |&around| (around, along as usize))).collect()
    }

    fn name_sets(&self, mesh: &mut SolidMesh, numbers: &BTreeMap<Key, u32>) {
        let outside = 2 * self.through[0];
        let mut name = |set: &str, belongs: &dyn Fn(Key) -> bool| {
            let mut nodes: Vec<u32> = numbers.iter().filter(|(key, _)| belongs(**key)).map(|(_, &node)| node).collect();
            nodes.sort_unstable();
            mesh.node_sets.insert(set.to_owned(), nodes);
        };
        if self.casing.ring.is_some() {
            name(RING_SEAT, &|key| key[2] == -2 * self.through[1]);
        }
        for mount in &self.casing.mounts {
            name(&mount.name, &|[i, j, k]| {
                let covers = |(around, along): (usize, usize)| {
                    let segment = self.cells[along][0].segment;
                    turn_between(self.middle_angle(around), mount.angle).abs() <= 0.5 * mount.width
                        && (mount.segments[0]..=mount.segments[1]).contains(&segment)
                };
                k == outside && self.cells_at(i, j).into_iter().any(covers)
            });
        }
        for bearing in &self.casing.bearings {
            let [inner, outer] =
                [0, 1].map(|side| self.surfaces[bearing.segment][side].x + self.surfaces[bearing.segment + 1][side].x);
            let surface = if inner < outer { 0 } else { outside };
            name(&bearing.name, &|[i, j, k]| {
                k == surface
                    && self.cells_at(i, j).into_iter().any(|(_, along)| self.cells[along][0].segment == bearing.segment)
            });
        }
        if let Some(input) = &self.casing.input {
            for bearing in &input.bearings {
                name(&bearing.name, &|[i, j, k]| {
                    let index = (k - outside) / 2;
                    if k <= outside || index < 1 {
                        return false;
                    }
                    let level = |index: i32| self.levels[(index - 1).clamp(0, self.through[2] - 1) as usize];
                    let distance = 0.5 * (level(index) + level(index + (k - outside) % 2));
                    let slack = 1e-9 * bearing.span[1];
                    let cells = self.cells_at(i, j);
                    let touches = |kind| cells.iter().any(|&(around, along)| self.window(around, along) == kind);
                    distance >= bearing.span[0] - slack
                        && distance <= bearing.span[1] + slack
                        && touches(Window::Opening)
                });
            }
        }
    }

    fn with_roles(&self, mesh: SolidMesh) -> Housing {
        let casing = self.casing;
        let mounts = casing.mounts.iter().map(|m| Mount { set: m.name.clone(), tie: Tie::Springs(m.stiffness) });
        let hubs = casing.bearings.iter().map(|bearing| {
            let [a, b] = [self.surfaces[bearing.segment], self.surfaces[bearing.segment + 1]];
            let height = 0.25 * (a[0].y + a[1].y + b[0].y + b[1].y);
            PortPlace { name: bearing.name.clone(), position: Some([0.0, 0.0, height]) }
        });
        let boss = casing.input.iter().flat_map(|input| &input.bearings).filter_map(|bearing| {
            let axis = self.axis()?;
            let middle = axis.start + 0.5 * (bearing.span[0] + bearing.span[1]) * axis.direction;
            Some(PortPlace { name: bearing.name.clone(), position: Some(middle.into()) })
        });
        Housing {
            mounts: mounts.collect(),
            ports: hubs.chain(boss).collect(),
            seat: casing.ring.map(|_| SeatPlace { set: RING_SEAT.to_owned(), harmonics: casing.seat_harmonics }),
            sensors: casing.sensors.clone(),
            mesh,
        }
    }
}

/// `a - b` in `(-pi, pi]`.
fn turn_between(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    if turn > 0.5 * TAU { turn - TAU } else { turn }
}

fn frame(casing: &Casing, input: &InputPart) -> (f64, f64) {
    let [a, b] = [casing.wall[input.segment], casing.wall[input.segment + 1]];
    (input.thickness / a.r.max(b.r), input.thickness / (b.r - a.r).hypot(b.z - a.z))
}

/// Values from the first to the last, evenly spaced with steps of at most `size`.
fn spaced(first: f64, last: f64, size: f64) -> impl Iterator<Item = f64> {
    let n = ((last - first) / size - 1e-9).ceil().max(1.0) as usize;
    (0..n).map(move |k| first + (last - first) * k as f64 / n as f64)
}

fn angles(casing: &Casing) -> Vec<f64> {
    let windows = casing.mounts.iter().map(|m| (m.angle, 0.5 * m.width)).chain(casing.input.iter().flat_map(|input| {
        let half = 0.5 * input.width;
        [(input.angle, half), (input.angle, half - frame(casing, input).0)]
    }));
    let mut edges: Vec<f64> = windows
        .filter(|(_, half)| *half < 0.5 * TAU * (1.0 - 1e-9))
        .flat_map(|(angle, half)| [angle - half, angle + half])
        .map(|edge| edge.rem_euclid(TAU))
        .collect();
    edges.sort_unstable_by(f64::total_cmp);
    edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    if edges.is_empty() {
        // a turn of three pieces at least, so that no two lines coincide
        edges = vec![0.0, TAU / 3.0, 2.0 * TAU / 3.0];
    }
    let widest = casing.wall.iter().map(|point| point.r).fold(0.0, f64::max);
    let size = casing.density.element_size / widest;
    let first = edges[0];
    let ends = edges.iter().skip(1).copied().chain([first + TAU]);
    edges.iter().zip(ends).flat_map(|(&start, end)| spaced(start, end, size)).collect()
}

fn cells(casing: &Casing) -> Vec<[Station; 2]> {
    let mut cells = Vec::new();
    for (segment, length) in casing.segment_lengths().into_iter().enumerate() {
        let mut edges = vec![0.0, 1.0];
        if let Some(input) = casing.input.as_ref().filter(|input| input.segment == segment) {
            let edge = frame(casing, input).1;
            edges = vec![0.0, edge, 1.0 - edge, 1.0];
        }
        let size = casing.density.element_size / length;
        let mut lines: Vec<f64> = edges.windows(2).flat_map(|w| spaced(w[0], w[1], size)).collect();
        lines.push(1.0);
        cells.extend(lines.windows(2).map(|w| [0, 1].map(|end| Station { segment, fraction: w[end] })));
    }
    cells
}

/// Inside and outside of the wall at its points, on the bisector of the segments that meet there.
fn surfaces(casing: &Casing) -> Vec<[Vector2<f64>; 2]> {
    let point = |index: usize| Vector2::new(casing.wall[index].r, casing.wall[index].z);
    let normal = |segment: usize| {
        let along = (point(segment + 1) - point(segment)).normalize();
        Vector2::new(along.y, -along.x)
    };
    let last = casing.wall.len() - 1;
    (0..=last)
        .map(|index| {
            let [before, after] = [normal(index.saturating_sub(1)), normal(index.min(last - 1))];
            let sum = before + after;
            // as long as keeps the distance from both segments at half the thickness
            let offset = 0.5 * casing.wall[index].thickness * sum * 2.0 / sum.norm_squared();
            [point(index) - offset, point(index) + offset]
        })
        .collect()
}

/// Distances along the pinion's axis of the boss's levels: the ends of the bearings, and between them.
fn levels(input: &InputPart, size: f64) -> Vec<f64> {
    let mut ends: Vec<f64> = input.bearings.iter().flat_map(|bearing| bearing.span).collect();
    ends.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let last = ends.last().copied();
    ends.windows(2).flat_map(|w| spaced(w[0], w[1], size)).chain(last).collect()
}
