//! One kind of tooth sector: healthy, or with a crack of its own.
//!
//! A sector is meshed and condensed onto its two cuts. Unit loads at its flank nodes give, with the cuts held, the displacements at its depth nodes
//! (`base`), and the shapes that carry cut displacements to depth and flank (`at_depth`, `at_flank`).

use std::collections::HashMap;

use faer::{Mat, MatRef};
use gear_geom::{FlankSide, Gear, RootCrack};
use nalgebra::{Point2, Vector2};

use super::BodyOptions;
use crate::condense::CondensedBody;
use crate::element::ReferenceQuad;
use crate::error::FecmError;
use crate::face::FaceBasis;
use crate::mesh::SectorMesh;

/// A profile position on a flank.
#[derive(Debug, Clone)]
pub struct Station {
    /// Flank node columns and their weights for a unit normal load: `(node slot, x weight, y weight)`.
    pub(crate) load: Vec<(usize, Vector2<f64>)>,
    /// Depth node rows and their weights for the normal displacement.
    pub(super) depth: Vec<(usize, Vector2<f64>)>,
}

/// One symmetry family of a sector.
pub struct SectorFamily {
    /// The condensed sector.
    pub condensed: CondensedBody,
    /// Interior rows and weights of every flank unknown: of slot `s` and function `d` at `s * functions + d`.
    flank: Vec<Vec<(usize, f64)>>,
    /// Depth displacements by unit flank loads with the cuts held.
    pub(super) base: Mat<f64>,
    /// Rows of `X` at the flank nodes: displacement by unit cut displacement.
    pub(crate) at_flank: Mat<f64>,
    /// Rows of `X` at the depth nodes.
    pub(super) at_depth: Mat<f64>,
}

/// Samples of each flank edge in the search for the elements at matching depth.
const SAMPLES: u32 = 40;

/// A tooth sector made ready for contact on one flank.
pub struct ToothSector {
    /// Mesh.
    pub shape: SectorMesh,
    /// Symmetry families, in the order of the body's.
    pub families: Vec<SectorFamily>,
    name: &'static str,
    side: FlankSide,
    quad: ReferenceQuad,
    depth: f64,
    base_radius: f64,
    flank_slots: HashMap<u32, usize>,
    /// Node of each flank slot.
    flank_nodes: Vec<u32>,
    depth_slots: HashMap<u32, usize>,
    depth_elements: Vec<u32>,
}

impl ToothSector {
    /// Meshes a sector and condenses it in every family of the face.
    pub(super) fn new(
        gear: &Gear,
        side: FlankSide,
        crack: Option<&RootCrack>,
        bases: &[FaceBasis],
        options: &BodyOptions,
        springs: Option<f64>,
        name: &'static str,
    ) -> Result<Self, FecmError> {
        let mut sector = Self {
            shape: SectorMesh::with_crack(gear, &options.mesh, crack, name)?,
            families: Vec::new(),
            name,
            side,
            quad: ReferenceQuad::new(options.mesh.order),
            depth: options.matching_depth,
            base_radius: gear.base_radius(),
            flank_slots: HashMap::new(),
            flank_nodes: Vec::new(),
            depth_slots: HashMap::new(),
            depth_elements: Vec::new(),
        };
        sector.number_flank();
        sector.find_depth_elements()?;
        for basis in bases {
            let family = sector.condense(basis, springs)?;
            sector.families.push(family);
        }
        Ok(sector)
    }

    fn condense(&self, basis: &FaceBasis, springs: Option<f64>) -> Result<SectorFamily, FecmError> {
        let condensed = CondensedBody::new(&self.shape.substructure(springs), basis)?;
        let functions = 2 * basis.plane_degrees().len();
        let flank = rows(&condensed, &self.flank_nodes, functions);
        let depth = rows(&condensed, &self.depth_nodes(), functions);
        let mut loads = Mat::zeros(condensed.interior_size(), flank.len());
        for (column, terms) in flank.iter().enumerate() {
            for &(row, weight) in terms {
                loads[(row, column)] = weight;
            }
        }
        condensed.solve_interior(&mut loads);
        let solution = condensed.retained_solution();
        let base = read(&depth, loads.as_ref());
        let at_flank = read(&flank, solution);
        let at_depth = read(&depth, solution);
        Ok(SectorFamily { condensed, flank, base, at_flank, at_depth })
    }

    /// Nodes of the loaded flank, in slot order.
    pub(crate) fn flank_nodes(&self) -> &[u32] {
        &self.flank_nodes
    }

    /// Positions of the flank nodes, in slot order.
    pub(super) fn flank_points(&self) -> Vec<Point2<f64>> {
        self.flank_nodes.iter().map(|&node| self.shape.mesh.nodes[node as usize]).collect()
    }

    /// Positions of the depth nodes, in slot order.
    pub(super) fn depth_points(&self) -> Vec<Point2<f64>> {
        self.depth_nodes().iter().map(|&node| self.shape.mesh.nodes[node as usize]).collect()
    }

    fn depth_nodes(&self) -> Vec<u32> {
        let mut nodes = vec![0; self.depth_slots.len()];
        for (&node, &slot) in &self.depth_slots {
            nodes[slot] = node;
        }
        nodes
    }

    fn number_flank(&mut self) {
        for edge in &self.shape.flank(self.side).edges {
            for &node in edge {
                let next = self.flank_slots.len();
                if *self.flank_slots.entry(node).or_insert(next) == next {
                    self.flank_nodes.push(node);
                }
            }
        }
    }

    /// Element edge, local coordinate, position and outward normal of the flank at an involute arc length.
    fn locate_on_flank(&self, arc: f64) -> (usize, f64, Point2<f64>, Vector2<f64>) {
        let flank = self.shape.flank(self.side);
        let breaks = &flank.arc_breaks;
        let last = breaks.len() - 1;
        let forward = breaks[last] > breaks[0];
        let (low, high) = if forward { (breaks[0], breaks[last]) } else { (breaks[last], breaks[0]) };
        let arc = arc.clamp(low, high);
        let after = if forward { breaks.partition_point(|&b| b <= arc) } else { breaks.partition_point(|&b| b >= arc) };
        let index = after.clamp(1, last) - 1;
        let xi = 2.0 * (arc - breaks[index]) / (breaks[index + 1] - breaks[index]) - 1.0;
        let n = self.quad.order() + 1;
        let (mut shapes, mut slopes) = (vec![0.0; n], vec![0.0; n]);
        self.quad.basis().values_into(xi, &mut shapes);
        self.quad.basis().derivatives_into(xi, &mut slopes);
        let mut position = Vector2::zeros();
        let mut tangent = Vector2::zeros();
        for ((&node, shape), slope) in flank.edges[index].iter().zip(&shapes).zip(&slopes) {
            let point = self.shape.mesh.nodes[node as usize].coords;
            position += point * *shape;
            tangent += point * *slope;
        }
        // outward: away from the tooth's centre line
        let mut normal = Vector2::new(tangent.y, -tangent.x).normalize();
        let outward_y = if self.side == FlankSide::Upper { 1.0 } else { -1.0 };
        if normal.y * outward_y < 0.0 {
            normal = -normal;
        }
        (index, xi, Point2::from(position), normal)
    }

    /// Elements that hold points at matching depth, found by sampling the flank.
    fn find_depth_elements(&mut self) -> Result<(), FecmError> {
        let breaks = self.shape.flank(self.side).arc_breaks.clone();
        let mut found = Vec::new();
        for pair in breaks.windows(2) {
            // close enough that an element only clipped between two samples can be left to its neighbour
            for k in 0..=SAMPLES {
                let arc = pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(SAMPLES);
                let (_, _, position, normal) = self.locate_on_flank(arc);
                let target = position - normal * self.depth;
                // mostly the element of the sample before
                let last: &[u32] = found.last().map_or(&[], std::slice::from_ref);
                if self.holds(last, target) {
                    continue;
                }
                let (element, _) = self.locate_in(&self.shape.tooth_elements, target)?;
                if !found.contains(&element) {
                    found.push(element);
                }
            }
        }
        found.sort_unstable();
        for &element in &found {
            for &node in self.shape.mesh.element(element as usize) {
                let next = self.depth_slots.len();
                self.depth_slots.entry(node).or_insert(next);
            }
        }
        self.depth_elements = found;
        Ok(())
    }

    /// Whether one of the elements holds a point without extrapolation.
    fn holds(&self, elements: &[u32], target: Point2<f64>) -> bool {
        elements.iter().any(|&element| {
            let points = self.shape.mesh.element_points(element as usize);
            self.quad.inverse_map(&points, target).is_some_and(|(xi, eta)| xi.abs().max(eta.abs()) <= 1.0)
        })
    }

    /// Element of a list that holds a point, and the local coordinates there.
    fn locate_in(&self, elements: &[u32], target: Point2<f64>) -> Result<(u32, (f64, f64)), FecmError> {
        let mut best: Option<(f64, u32, (f64, f64))> = None;
        for &element in elements {
            let points = self.shape.mesh.element_points(element as usize);
            let size = (points[points.len() - 1] - points[0]).norm();
            let near = points.iter().any(|p| (p - target).norm() < 1.5 * size);
            if !near {
                continue;
            }
            if let Some((xi, eta)) = self.quad.inverse_map(&points, target) {
                let excess = xi.abs().max(eta.abs());
                if best.is_none_or(|(least, _, _)| excess < least) {
                    best = Some((excess, element, (xi, eta)));
                }
                if excess <= 1.0 {
                    break;
                }
            }
        }
        match best {
            Some((excess, element, local)) if excess < 1.05 => Ok((element, local)),
            _ => Err(FecmError::PointOutsideMesh { body: self.name, x: target.x, y: target.y, depth: self.depth }),
        }
    }

    /// Station at a roll distance (m), clipped to the meshed involute.
    ///
    /// # Errors
    /// [`FecmError::PointOutsideMesh`] when the matching depth leaves the tooth.
    pub fn station(&self, roll_distance: f64) -> Result<Station, FecmError> {
        let arc = roll_distance * roll_distance / (2.0 * self.base_radius);
        let (index, xi, position, normal) = self.locate_on_flank(arc);
        let mut shapes = vec![0.0; self.quad.order() + 1];
        self.quad.basis().values_into(xi, &mut shapes);
        let edge = &self.shape.flank(self.side).edges[index];
        let load = edge.iter().zip(&shapes).map(|(node, shape)| (self.flank_slots[node], normal * *shape)).collect();
        let (element, (xi, eta)) = self.locate_in(&self.depth_elements, position - normal * self.depth)?;
        let (shapes, _) = self.quad.shapes(xi, eta);
        let nodes = self.shape.mesh.element(element as usize);
        let depth = nodes.iter().zip(&shapes).map(|(node, shape)| (self.depth_slots[node], normal * *shape)).collect();
        Ok(Station { load, depth })
    }

    /// Position and outward normal of the meshed flank at a roll distance (m), in the tooth's frame.
    #[must_use]
    pub fn flank_point(&self, roll_distance: f64) -> (Point2<f64>, Vector2<f64>) {
        let (_, _, position, normal) = self.locate_on_flank(roll_distance * roll_distance / (2.0 * self.base_radius));
        (position, normal)
    }

    /// Adds the inward normal load of a station, given in the functions along the face of a family (N), to the loads on its flank unknowns.
    pub fn add_load(station: &Station, modal: &[f64], flank: &mut Mat<f64>) {
        for &(slot, weight) in &station.load {
            for (k, force) in modal.iter().enumerate() {
                let row = 2 * (slot * modal.len() + k);
                flank[(row, 0)] -= weight.x * force;
                flank[(row + 1, 0)] -= weight.y * force;
            }
        }
    }
}

impl SectorFamily {
    /// Number of flank unknowns: in-plane ones of the loaded flank's nodes.
    #[must_use]
    pub fn flank_size(&self) -> usize {
        self.flank.len()
    }

    /// Rows of a matrix over interior unknowns that are flank unknowns.
    pub(crate) fn at_flank_of(&self, interior: MatRef<'_, f64>) -> Mat<f64> {
        read(&self.flank, interior)
    }

    /// Loads on flank unknowns as loads on all interior unknowns.
    #[must_use]
    pub fn interior_load(&self, flank: &Mat<f64>) -> Mat<f64> {
        let mut interior = Mat::zeros(self.condensed.interior_size(), flank.ncols());
        for j in 0..flank.ncols() {
            for (i, terms) in self.flank.iter().enumerate() {
                for &(row, weight) in terms {
                    interior[(row, j)] += weight * flank[(i, j)];
                }
            }
        }
        interior
    }
}

/// Interior rows and weights of the in-plane unknowns of nodes, those of one node after those of the one before.
fn rows(condensed: &CondensedBody, nodes: &[u32], functions: usize) -> Vec<Vec<(usize, f64)>> {
    let of_node = |&node: &u32| (0..functions).map(move |d| condensed.interior_terms(node, d));
    nodes.iter().flat_map(of_node).filter(|terms| !terms.is_empty()).collect()
}

/// Weighted sums of rows of a matrix.
fn read(rows: &[Vec<(usize, f64)>], matrix: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(rows.len(), matrix.ncols(), |i, j| {
        rows[i].iter().map(|&(row, weight)| weight * matrix[(row, j)]).sum()
    })
}
