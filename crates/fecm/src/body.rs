//! A gear as the contact problem sees it: compliance from normal loads on the flanks to displacements at matching depth.
//!
//! One sector is meshed and condensed ([`crate::condense`]) and the ring of identical sectors is closed ([`crate::ring`]). Unit
//! loads at the flank nodes of tooth 0 then give two kinds of dense matrix, per symmetry family along the face:
//!
//! * *own*: displacement of the nodes around the matching depth below the same flank,
//!   `K_II^-1 + X G X^T` with `G` the closed ring's compliance on the two cuts of the sector;
//! * *cross*: displacement of the flank of the `d`-th next tooth, `X G_d X^T` - rim and hub coupling.
//!
//! A [`Station`] is a profile position; its load is spread over the flank nodes of its element edge, and its displacement is read
//! at depth `h` below it inside the element that holds the point. Loads and displacements along the inward normal are
//! positive. Stations and functions along the face stay separate (`station * functions + function`), so that a contact
//! grid of any resolution is two small products.

use std::collections::HashMap;

use faer::Mat;
use gear_geom::{FlankSide, Gear};
use nalgebra::{Point2, Rotation2, Vector2};

use crate::condense::CondensedBody;
use crate::element::ReferenceQuad;
use crate::error::FecmError;
use crate::face::{FaceBasis, FaceModel, Parity};
use crate::linalg::{add_product, add_scaled, column_slice, column_slice_mut, product, symmetrise};
use crate::material::Material;
use crate::mesh::{MeshDensity, SectorMesh};
use crate::ring::{Arc, cyclic_cut_compliance};

/// What holds the gear at its bore (external) or outside (ring).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum BoreCondition {
    /// Bonded to a rigid hub, which turns as one.
    #[default]
    RigidHub,
    /// Bonded to a rigid hub through springs of this stiffness per area (N/m^3).
    ElasticHub {
        /// Stiffness per area (N/m^3), positive.
        stiffness: f64,
    },
    /// No hub: the reaction is spread over the bore as uniform tractions, and the bore's mean displacement and mean
    /// rotation take the place of the hub's.
    Tractions,
}

/// How a gear body is modelled.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyOptions {
    /// Mesh of the sector.
    pub mesh: MeshDensity,
    /// Behaviour along the face.
    pub face: FaceModel,
    /// Width of the body along the face (m).
    pub width: f64,
    /// Bore condition.
    pub bore: BoreCondition,
    /// Depth below the flank at which the finite-element displacement is taken (m).
    pub matching_depth: f64,
    /// Number of neighbouring teeth on either side whose coupling is kept.
    pub reach: usize,
    /// Whether loads that are not symmetric about mid-face can occur.
    pub antisymmetric: bool,
}

/// A profile position on a flank.
#[derive(Debug, Clone)]
pub struct Station {
    /// Flank node columns and their weights for a unit normal load: `(node slot, x weight, y weight)`.
    load: Vec<(usize, Vector2<f64>)>,
    /// Depth node rows and their weights for the normal displacement.
    depth: Vec<(usize, Vector2<f64>)>,
}

/// One symmetry family of a gear.
pub struct Family {
    /// Functions along the face.
    pub basis: FaceBasis,
    /// The condensed sector.
    pub sector: CondensedBody,
    own: Mat<f64>,
    cross: Vec<Mat<f64>>,
}

/// Sizes of a body's model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BodySizes {
    /// Nodes of the plane sector mesh.
    pub plane_nodes: usize,
    /// Elements of the plane sector mesh.
    pub plane_elements: usize,
    /// Interior unknowns of a sector, all families.
    pub sector_unknowns: usize,
    /// Unknowns on one cut, all families.
    pub cut_unknowns: usize,
    /// Entries of the sparse factors.
    pub factor_entries: usize,
}

/// A gear, condensed for contact on one flank of its teeth.
pub struct GearBody {
    /// Mesh of one sector.
    pub sector: SectorMesh,
    /// Material.
    pub material: Material,
    /// Flank that carries the load.
    pub side: FlankSide,
    /// Symmetry families: symmetric, and antisymmetric if asked for.
    pub families: Vec<Family>,
    name: &'static str,
    quad: ReferenceQuad,
    depth: f64,
    base_radius: f64,
    flank_slots: HashMap<u32, usize>,
    /// Node of each flank slot.
    flank_nodes: Vec<u32>,
    depth_slots: HashMap<u32, usize>,
    depth_elements: Vec<u32>,
}

impl GearBody {
    /// Meshes and condenses a gear loaded on the flank `side`; `name` appears in errors.
    ///
    /// # Errors
    /// Options out of range, a tooth form that cannot be meshed, failed factorisations.
    pub fn new(
        gear: &Gear,
        side: FlankSide,
        material: &Material,
        options: &BodyOptions,
        name: &'static str,
    ) -> Result<Self, FecmError> {
        material.validate()?;
        let sector = SectorMesh::new(gear, &options.mesh, name)?;
        let mut body = Self {
            quad: ReferenceQuad::new(options.mesh.order),
            material: *material,
            side,
            families: Vec::new(),
            name,
            depth: options.matching_depth,
            base_radius: gear.base_radius(),
            flank_slots: HashMap::new(),
            flank_nodes: Vec::new(),
            depth_slots: HashMap::new(),
            depth_elements: Vec::new(),
            sector,
        };
        body.number_flank();
        body.find_depth_elements()?;
        for parity in [Parity::Symmetric, Parity::Antisymmetric] {
            if parity == Parity::Antisymmetric && !options.antisymmetric {
                continue;
            }
            if let Some(basis) = FaceBasis::new(options.face, parity, options.width, material) {
                let family = body.condense(gear, basis, options)?;
                body.families.push(family);
            }
        }
        Ok(body)
    }

    /// Sizes of the model.
    #[must_use]
    pub fn sizes(&self) -> BodySizes {
        BodySizes {
            plane_nodes: self.sector.mesh.nodes.len(),
            plane_elements: self.sector.mesh.element_count(),
            sector_unknowns: self.families.iter().map(|f| f.sector.interior_size()).sum(),
            cut_unknowns: self.families.iter().map(|f| f.sector.stiffness().nrows() / 2).sum(),
            factor_entries: self.families.iter().map(|f| f.sector.factor_entries()).sum(),
        }
    }

    /// Matching depth (m).
    #[must_use]
    pub fn matching_depth(&self) -> f64 {
        self.depth
    }

    fn number_flank(&mut self) {
        for edge in &self.sector.flank(self.side).edges {
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
        let flank = self.sector.flank(self.side);
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
            let point = self.sector.mesh.nodes[node as usize].coords;
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
        let breaks = self.sector.flank(self.side).arc_breaks.clone();
        let mut found = Vec::new();
        for pair in breaks.windows(2) {
            for k in 0..=8 {
                let arc = pair[0] + (pair[1] - pair[0]) * f64::from(k) / 8.0;
                let (_, _, position, normal) = self.locate_on_flank(arc);
                let target = position - normal * self.depth;
                let (element, _) = self.locate_in(&self.sector.tooth_elements, target)?;
                if !found.contains(&element) {
                    found.push(element);
                }
            }
        }
        found.sort_unstable();
        for &element in &found {
            for &node in self.sector.mesh.element(element as usize) {
                let next = self.depth_slots.len();
                self.depth_slots.entry(node).or_insert(next);
            }
        }
        self.depth_elements = found;
        Ok(())
    }

    /// Element of a list that holds a point, and the local coordinates there.
    fn locate_in(&self, elements: &[u32], target: Point2<f64>) -> Result<(u32, (f64, f64)), FecmError> {
        let mut best: Option<(f64, u32, (f64, f64))> = None;
        for &element in elements {
            let points = self.sector.mesh.element_points(element as usize);
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
        let edge = &self.sector.flank(self.side).edges[index];
        let load = edge.iter().zip(&shapes).map(|(node, shape)| (self.flank_slots[node], normal * *shape)).collect();
        let (element, (xi, eta)) = self.locate_in(&self.depth_elements, position - normal * self.depth)?;
        let (shapes, _) = self.quad.shapes(xi, eta);
        let nodes = self.sector.mesh.element(element as usize);
        let depth = nodes.iter().zip(&shapes).map(|(node, shape)| (self.depth_slots[node], normal * *shape)).collect();
        Ok(Station { load, depth })
    }

    /// Position and outward normal of the meshed flank at a roll distance (m), in the tooth's frame.
    #[must_use]
    pub fn flank_point(&self, roll_distance: f64) -> (Point2<f64>, Vector2<f64>) {
        let (_, _, position, normal) = self.locate_on_flank(roll_distance * roll_distance / (2.0 * self.base_radius));
        (position, normal)
    }

    /// Adds the inward normal load of a station, given in the functions along the face of a family (N), to the interior loads of its sector.
    pub fn add_load(&self, family: usize, station: &Station, modal: &[f64], loads: &mut Mat<f64>) {
        let family = &self.families[family];
        for &(slot, weight) in &station.load {
            let node = self.flank_nodes[slot];
            for (k, force) in modal.iter().enumerate() {
                for (c, share) in [weight.x, weight.y].into_iter().enumerate() {
                    if let Some(row) = family.sector.interior_row(node, 2 * k + c) {
                        loads[(row, 0)] -= share * force;
                    }
                }
            }
        }
    }

    fn condense(&self, gear: &Gear, basis: FaceBasis, options: &BodyOptions) -> Result<Family, FecmError> {
        let soft = 1e-5 * self.material.young_modulus / gear.rim_radius();
        let springs = match options.bore {
            BoreCondition::RigidHub => None,
            BoreCondition::ElasticHub { stiffness } => {
                if !(stiffness > 0.0 && stiffness.is_finite()) {
                    let allowed = "a positive stiffness per area in N/m^3";
                    return Err(FecmError::Option { name: "hub stiffness", value: stiffness, allowed });
                }
                Some(stiffness)
            }
            BoreCondition::Tractions => Some(soft),
        };
        let condensed = CondensedBody::new(&self.sector.substructure(springs), &basis)?;
        let teeth = gear.teeth() as usize;
        let reach = options.reach.min((teeth - 1) / 2);
        let arc = Arc::of_sector(condensed.stiffness());
        let cuts = cyclic_cut_compliance(&arc, teeth, reach + 1)?;

        let functions = 2 * basis.plane_degrees().len();
        let flank_rows = self.rows(&self.flank_slots, &condensed, functions);
        let depth_rows = self.rows(&self.depth_slots, &condensed, functions);
        let mut loads = Mat::zeros(condensed.interior_size(), flank_rows.len());
        for (column, &row) in flank_rows.iter().enumerate() {
            loads[(row, column)] = 1.0;
        }
        condensed.solve_interior(&mut loads);
        let solution = condensed.retained_solution();
        let mut own = Mat::from_fn(depth_rows.len(), flank_rows.len(), |i, j| loads[(depth_rows[i], j)]);
        let at_flank = Mat::from_fn(flank_rows.len(), solution.ncols(), |i, j| solution[(flank_rows[i], j)]);
        let at_depth = Mat::from_fn(depth_rows.len(), solution.ncols(), |i, j| solution[(depth_rows[i], j)]);
        let pair = tooth_cut_compliance(&cuts, 0);
        let spread = product(at_depth.as_ref(), pair.as_ref());
        add_product(own.as_mut(), 1.0, spread.as_ref(), at_flank.transpose());
        let mut cross = Vec::new();
        for offset in 1..=reach {
            let pair = tooth_cut_compliance(&cuts, offset);
            let spread = product(at_flank.as_ref(), pair.as_ref());
            cross.push(product(spread.as_ref(), at_flank.transpose()));
        }
        let mut family = Family { basis, sector: condensed, own, cross };
        if options.bore == BoreCondition::Tractions {
            self.remove_hub_motion(gear, soft, &mut family);
        }
        Ok(family)
    }

    /// Interior rows of the in-plane unknowns of numbered nodes, in slot order.
    fn rows(&self, slots: &HashMap<u32, usize>, sector: &CondensedBody, functions: usize) -> Vec<usize> {
        let mut nodes: Vec<(usize, u32)> = slots.iter().map(|(&node, &slot)| (slot, node)).collect();
        nodes.sort_unstable();
        let rows = nodes.iter().flat_map(|&(_, node)| (0..functions).filter_map(move |d| sector.interior_row(node, d)));
        rows.collect()
    }

    /// Takes the rigid motion of a bore on soft springs out of the compliance. The spring forces balance the load exactly, so the
    /// bore's mean motion is the load's resultant over the springs' total stiffness; what remains is the body under uniform
    /// reaction tractions with the bore's mean displacement and rotation zero.
    fn remove_hub_motion(&self, gear: &Gear, stiffness: f64, family: &mut Family) {
        let (radius, width) = (gear.rim_radius(), family.basis.width());
        let area = 2.0 * std::f64::consts::PI * radius * width;
        let pitch = self.sector.sector_angle;
        let flank = self.slot_points(&self.flank_slots);
        let depth = self.slot_points(&self.depth_slots);
        let degrees = family.basis.plane_degrees().to_vec();
        let count = 2 * degrees.len();
        for (offset, matrix) in std::iter::once(&mut family.own).chain(&mut family.cross).enumerate() {
            let observed = if offset == 0 { &depth } else { &flank };
            let turn = Rotation2::new(-pitch * offset as f64);
            for (k, &degree) in degrees.iter().enumerate() {
                // functions 1 and 2 z / b carry rigid motion: translation and rotation, or tilt
                let (translation, rotation) = match degree {
                    0 => (1.0 / (stiffness * area), 1.0 / (stiffness * area * radius * radius)),
                    1 => {
                        let tilt = stiffness * area * (width * width / 12.0 + 0.5 * radius * radius);
                        (0.25 * width * width / tilt, 0.0)
                    }
                    _ => continue,
                };
                for (i, at) in observed.iter().enumerate() {
                    for (j, from) in flank.iter().enumerate() {
                        for c in 0..2 {
                            let force = if c == 0 { Vector2::x() } else { Vector2::y() };
                            let moment = from.x * force.y - from.y * force.x;
                            let spin = Vector2::new(-at.y, at.x) * (moment * rotation);
                            let motion = turn * force * translation + spin;
                            matrix[(i * count + 2 * k, j * count + 2 * k + c)] -= motion.x;
                            matrix[(i * count + 2 * k + 1, j * count + 2 * k + c)] -= motion.y;
                        }
                    }
                }
            }
        }
    }

    fn slot_points(&self, slots: &HashMap<u32, usize>) -> Vec<Point2<f64>> {
        let mut points = vec![Point2::origin(); slots.len()];
        for (&node, &slot) in slots {
            points[slot] = self.sector.mesh.nodes[node as usize];
        }
        points
    }

    /// Normal displacement at depth below each station by unit normal loads at each station of the same flank, in the
    /// functions along the face of family `family`; symmetric (m/N).
    #[must_use]
    pub fn own_compliance(&self, family: usize, stations: &[Station]) -> Mat<f64> {
        let family = &self.families[family];
        let functions = family.basis.plane_degrees().len();
        let mut result = contract(&family.own, functions, stations, stations, |s| &s.depth);
        symmetrise(&mut result);
        result
    }

    /// Normal displacement of the flank at `observed` stations of tooth `t + offset` by unit normal loads at the `loaded` stations of
    /// tooth `t` (m/N). Zero beyond the reach.
    #[must_use]
    pub fn cross_compliance(&self, family: usize, offset: i32, observed: &[Station], loaded: &[Station]) -> Mat<f64> {
        let family = &self.families[family];
        let functions = family.basis.plane_degrees().len();
        match family.cross.get((offset.unsigned_abs() as usize).wrapping_sub(1)) {
            None => Mat::zeros(observed.len() * functions, loaded.len() * functions),
            Some(matrix) if offset > 0 => contract(matrix, functions, observed, loaded, |s| &s.load),
            Some(matrix) => contract(matrix, functions, loaded, observed, |s| &s.load).transpose().to_owned(),
        }
    }
}

/// Compliance between the two cuts of tooth `t + offset` (rows) and of tooth `t` (columns).
fn tooth_cut_compliance(cuts: &[Mat<f64>], offset: usize) -> Mat<f64> {
    let n = cuts[0].nrows();
    let mut pair = Mat::zeros(2 * n, 2 * n);
    let mut put = |i: usize, j: usize, distance: isize| {
        let mut block = pair.as_mut().submatrix_mut(i * n, j * n, n, n);
        let source = &cuts[distance.unsigned_abs()];
        if distance >= 0 {
            block.copy_from(source);
        } else {
            block.copy_from(source.transpose());
        }
    };
    let d = offset as isize;
    put(0, 0, d);
    put(0, 1, d - 1);
    put(1, 0, d + 1);
    put(1, 1, d);
    pair
}

/// `observed^T matrix loaded` with the stations' weights, functions along the face kept apart.
fn contract(
    matrix: &Mat<f64>,
    functions: usize,
    observed: &[Station],
    loaded: &[Station],
    rows: impl Fn(&Station) -> &Vec<(usize, Vector2<f64>)>,
) -> Mat<f64> {
    let mut result = Mat::zeros(observed.len() * functions, loaded.len() * functions);
    let mut spread = vec![0.0; matrix.nrows()];
    for (j, station) in loaded.iter().enumerate() {
        for k in 0..functions {
            // displacements of all observed nodes by this load
            spread.fill(0.0);
            for &(slot, weight) in &station.load {
                let at = 2 * (slot * functions + k);
                let columns = [(at, weight.x), (at + 1, weight.y)];
                for (column, share) in columns {
                    add_scaled(&mut spread, share, column_slice(matrix, column));
                }
            }
            let target = column_slice_mut(&mut result, j * functions + k);
            for (station, target) in observed.iter().zip(target.chunks_exact_mut(functions)) {
                for &(slot, weight) in rows(station) {
                    let at = 2 * slot * functions;
                    let motions = spread[at..at + 2 * functions].chunks_exact(2);
                    for (value, motion) in target.iter_mut().zip(motions) {
                        *value += weight.x * motion[0] + weight.y * motion[1];
                    }
                }
            }
        }
    }
    result
}
