//! One kind of tooth sector: healthy, or with a crack of its own.
//!
//! A sector is meshed and condensed onto its two cuts. Loads on its flank are normal and vary as the polynomials of [`ProfileBasis`] along the profile and
//! of the face's basis across it. Unit loads give, with the cuts held, the displacements of the flank in the same functions (`base`), and
//! the shapes that carry cut displacements to the flank (`at_flank`).

use faer::{Mat, MatRef};
use gear_geom::{FlankSide, Gear, RootCrack};
use nalgebra::{Point2, Vector2};

use super::BodyOptions;
use crate::condense::CondensedBody;
use crate::element::lagrange::{LagrangeBasis, gauss_rule};
use crate::error::FecmError;
use crate::face::FaceBasis;
use crate::linalg::symmetrise;
use crate::mesh::SectorMesh;
use crate::profile_basis::ProfileBasis;

/// A profile position on a flank.
#[derive(Debug, Clone)]
pub struct Station {
    /// The profile's functions there (1/sqrt(m)): how a unit normal load is spread, and how the normal displacement is read.
    pub(crate) values: Vec<f64>,
}

/// One symmetry family of a sector.
pub struct SectorFamily {
    /// The condensed sector.
    pub condensed: CondensedBody,
    /// Interior rows and weights of every flank unknown: of profile function `m` and function `k` along the face at `m * functions + k`. Inward
    /// displacements are positive.
    flank: Vec<Vec<(usize, f64)>>,
    /// Flank displacements by unit flank loads with the cuts held.
    pub(super) base: Mat<f64>,
    /// Rows of `X` at the flank unknowns: displacement by unit cut displacement.
    pub(crate) at_flank: Mat<f64>,
}

/// A tooth sector made ready for contact on one flank.
pub struct ToothSector {
    /// Mesh.
    pub shape: SectorMesh,
    /// Symmetry families, in the order of the body's.
    pub families: Vec<SectorFamily>,
    side: FlankSide,
    line: LagrangeBasis,
    profile: ProfileBasis,
    /// By profile function: nodes and weights of the inward normal displacement in it.
    flank: Vec<Vec<(u32, Vector2<f64>)>>,
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
            side,
            line: LagrangeBasis::new(options.mesh.order),
            profile: ProfileBasis::new(gear, options.profile_order),
            flank: Vec::new(),
        };
        sector.flank = sector.flank_weights();
        for basis in bases {
            let family = sector.condense(basis, springs)?;
            sector.families.push(family);
        }
        Ok(sector)
    }

    fn condense(&self, basis: &FaceBasis, springs: Option<f64>) -> Result<SectorFamily, FecmError> {
        let condensed = CondensedBody::new(&self.shape.substructure(springs), basis)?;
        let mut flank = Vec::new();
        for weights in &self.flank {
            for k in 0..basis.plane_degrees().len() {
                let mut terms = Vec::new();
                for &(node, weight) in weights {
                    for (dof, weight) in [(2 * k, weight.x), (2 * k + 1, weight.y)] {
                        let of_node = condensed.interior_terms(node, dof).into_iter();
                        terms.extend(of_node.map(|(row, part)| (row, part * weight)));
                    }
                }
                flank.push(terms);
            }
        }
        let mut loads = Mat::zeros(condensed.interior_size(), flank.len());
        for (column, terms) in flank.iter().enumerate() {
            for &(row, weight) in terms {
                loads[(row, column)] += weight;
            }
        }
        condensed.solve_interior(&mut loads);
        let mut base = read(&flank, loads.as_ref());
        symmetrise(&mut base);
        let at_flank = read(&flank, condensed.retained_solution());
        Ok(SectorFamily { condensed, flank, base, at_flank })
    }

    /// The flank's functions along the profile.
    #[must_use]
    pub fn profile(&self) -> &ProfileBasis {
        &self.profile
    }

    /// Weights of the inward normal displacement in each profile function, `int phi_m N (-n) da` over the element edges.
    fn flank_weights(&self) -> Vec<Vec<(u32, Vector2<f64>)>> {
        let flank = self.shape.flank(self.side);
        let mut all = vec![Vec::new(); self.profile.count()];
        let mut shapes = vec![0.0; self.line.points().len()];
        let rule = gauss_rule(self.line.points().len() + self.profile.count());
        for (index, (edge, ends)) in flank.edges.iter().zip(flank.arc_breaks.windows(2)).enumerate() {
            let half = 0.5 * (ends[1] - ends[0]);
            let mut sums = vec![vec![Vector2::zeros(); edge.len()]; all.len()];
            for &(xi, weight) in &rule {
                let (_, normal) = self.on_edge(index, xi);
                self.line.values_into(xi, &mut shapes);
                let values = self.profile.values(ends[0] + half * (1.0 + xi));
                for (sums, value) in sums.iter_mut().zip(values) {
                    for (sum, shape) in sums.iter_mut().zip(&shapes) {
                        *sum -= normal * (weight * half.abs() * value * shape);
                    }
                }
            }
            for (all, sums) in all.iter_mut().zip(sums) {
                all.extend(edge.iter().copied().zip(sums));
            }
        }
        all
    }

    /// Force and moment about the axis of unit loads in each profile function, in the tooth's frame.
    pub(super) fn resultants(&self) -> Vec<(Vector2<f64>, f64)> {
        let of = |weights: &Vec<(u32, Vector2<f64>)>| {
            weights.iter().fold((Vector2::zeros(), 0.0), |(force, moment), &(node, weight)| {
                let at = self.shape.mesh.nodes[node as usize];
                (force + weight, moment + at.x * weight.y - at.y * weight.x)
            })
        };
        self.flank.iter().map(of).collect()
    }

    /// Position and outward normal at the local coordinate of a flank edge.
    fn on_edge(&self, index: usize, xi: f64) -> (Point2<f64>, Vector2<f64>) {
        let n = self.line.points().len();
        let (mut shapes, mut slopes) = (vec![0.0; n], vec![0.0; n]);
        self.line.values_into(xi, &mut shapes);
        self.line.derivatives_into(xi, &mut slopes);
        let mut position = Vector2::zeros();
        let mut tangent = Vector2::zeros();
        for ((&node, shape), slope) in self.shape.flank(self.side).edges[index].iter().zip(&shapes).zip(&slopes) {
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
        (Point2::from(position), normal)
    }

    /// Station at a roll distance (m), clipped to the meshed involute.
    #[must_use]
    pub fn station(&self, roll_distance: f64) -> Station {
        Station { values: self.profile.values(self.profile.arc(roll_distance)) }
    }

    /// Inward normal unit load of a station as forces on nodes, in the tooth's frame; a node may occur twice.
    #[must_use]
    pub fn nodal_load(&self, station: &Station) -> Vec<(u32, Vector2<f64>)> {
        let of = |(weights, value): (&Vec<(u32, Vector2<f64>)>, &f64)| {
            weights.iter().map(|&(node, weight)| (node, weight * *value)).collect::<Vec<_>>()
        };
        self.flank.iter().zip(&station.values).flat_map(of).collect()
    }

    /// Displacement of the flank in its functions, `m * functions + k`, of node fields with `block` unknowns a node.
    pub(crate) fn flank_of_fields(&self, fields: MatRef<'_, f64>, block: usize, functions: usize) -> Mat<f64> {
        Mat::from_fn(self.flank.len() * functions, fields.ncols(), |row, column| {
            let (m, k) = (row / functions, row % functions);
            let of_node = |&(node, weight): &(u32, Vector2<f64>)| {
                let at = node as usize * block + 2 * k;
                weight.x * fields[(at, column)] + weight.y * fields[(at + 1, column)]
            };
            self.flank[m].iter().map(of_node).sum()
        })
    }

    /// Position and outward normal of the meshed flank at a roll distance (m), in the tooth's frame.
    #[must_use]
    pub fn flank_point(&self, roll_distance: f64) -> (Point2<f64>, Vector2<f64>) {
        let arc = self.profile.arc(roll_distance);
        let breaks = &self.shape.flank(self.side).arc_breaks;
        let last = breaks.len() - 1;
        let forward = breaks[last] > breaks[0];
        let after = breaks.partition_point(|&b| if forward { b <= arc } else { b >= arc });
        let index = after.clamp(1, last) - 1;
        self.on_edge(index, 2.0 * (arc - breaks[index]) / (breaks[index + 1] - breaks[index]) - 1.0)
    }

    /// Adds the inward normal load of a station, given in the functions along the face of a family (N), to the loads on its flank unknowns.
    pub fn add_load(station: &Station, modal: &[f64], flank: &mut Mat<f64>) {
        for (m, value) in station.values.iter().enumerate() {
            for (k, force) in modal.iter().enumerate() {
                flank[(m * modal.len() + k, 0)] += value * force;
            }
        }
    }
}

impl SectorFamily {
    /// Number of flank unknowns: functions along the profile times those along the face.
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

/// Weighted sums of rows of a matrix.
fn read(rows: &[Vec<(usize, f64)>], matrix: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(rows.len(), matrix.ncols(), |i, j| {
        rows[i].iter().map(|&(row, weight)| weight * matrix[(row, j)]).sum()
    })
}
