//! A structured block of elements of any kind, mapped to where it is wanted: plates, beams, rings; the start of a mesh of one's own, and of tests.

use std::collections::BTreeMap;

use fecm::Material;

use super::element::Kind;
use super::mesh::{Element, SolidMesh};

/// Corners of the cube in the order of a hexahedron.
const CUBE: [[usize; 3]; 8] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
/// Six tetrahedra around the diagonal from corner 0 to corner 6 (Kuhn's).
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
/// Two wedges, upright.
const WEDGES: [[usize; 6]; 2] = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]];

/// Elements of one kind on a grid of `cells` (each split where the kind asks for it). The grid is the unit cube; `map` brings every node to its
/// place (m). Nodes that land on each other, within a billionth of the block's size, are one: a block can close to a ring.
#[must_use]
pub fn block(kind: Kind, cells: [usize; 3], material: Material, map: impl Fn([f64; 3]) -> [f64; 3]) -> SolidMesh {
    let mut mesh = SolidMesh { materials: vec![("block".to_owned(), material)], ..SolidMesh::default() };
    let corners_of: Vec<Vec<usize>> = match kind {
        Kind::Tet4 | Kind::Tet10 => TETRAHEDRA.iter().map(|t| t.to_vec()).collect(),
        Kind::Wedge6 | Kind::Wedge15 => WEDGES.iter().map(|w| w.to_vec()).collect(),
        Kind::Hex8 | Kind::Hex20 | Kind::Hex20R => vec![(0..8).collect()],
    };
    let corners: Vec<[f64; 3]> = (0..8).map(|k| map(std::array::from_fn(|d| CUBE[k][d] as f64))).collect();
    let middle = map([0.5; 3]);
    let size = corners.iter().chain([&middle]).flatten().fold(f64::MIN_POSITIVE, |size, x| size.max(x.abs()));
    let mut numbers: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let edges = kind.edges();
    let local = if kind.nodes() > corners_of[0].len() { edges } else { &[] };
    for cell in (0..cells[2]).flat_map(|k| (0..cells[1]).flat_map(move |j| (0..cells[0]).map(move |i| [i, j, k]))) {
        for corners in &corners_of {
            // twice the place on the grid, so that the middle of an edge is whole
            let at =
                |corner: usize| -> [usize; 3] { std::array::from_fn(|d| 2 * (cell[d] + CUBE[corners[corner]][d])) };
            let ends = (0..corners.len())
                .map(at)
                .chain(local.iter().map(|&[a, b]| std::array::from_fn(|d| (at(a)[d] + at(b)[d]) / 2)));
            let nodes = ends.map(|grid: [usize; 3]| {
                let place = map(std::array::from_fn(|d| grid[d] as f64 / (2 * cells[d]) as f64));
                let key = place.map(|x| (x / (1e-9 * size)).round() as i64);
                // a place next to the border between two roundings is looked for in both
                let near = neighbours(key).find_map(|key| numbers.get(&key).copied());
                near.unwrap_or_else(|| {
                    mesh.nodes.push(place);
                    let number = mesh.nodes.len() as u32 - 1;
                    numbers.insert(key, number);
                    number
                })
            });
            let nodes = nodes.collect();
            mesh.elements.push(Element { kind, material: 0, nodes });
        }
    }
    mesh
}

/// A key and those that differ by one.
fn neighbours(key: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let steps = [0, -1, 1];
    steps.into_iter().flat_map(move |i| {
        steps.into_iter().flat_map(move |j| steps.map(move |k| [key[0] + i, key[1] + j, key[2] + k]))
    })
}

impl SolidMesh {
    /// Names the nodes that a predicate holds for.
    pub fn name_set(&mut self, name: &str, belongs: impl Fn([f64; 3]) -> bool) {
        let nodes = self.nodes.iter().enumerate().filter(|(_, place)| belongs(**place)).map(|(node, _)| node as u32);
        self.node_sets.insert(name.to_owned(), nodes.collect());
    }
}
