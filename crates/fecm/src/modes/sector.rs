//! One healthy sector, reduced to its cuts and a few fields with the cuts held, in two mirror halves.
//!
//! As Craig and Bampton (1968): with the cuts' displacements `u_C` and fields `V` that vanish on the cuts, `u_I = -X u_C + V q`; the reduced
//! stiffness is `diag(S, V^T K V)`, `S` the condensed stiffness the statics use. The fields are not the sector's modes, of which many
//! would be needed, but the answers to the inertia of the gear's own modes as far as they are known, `K_II^-1 (M u)_I`: one step of
//! inverse iteration inside the sector, for all nodal diameters together. Each [`HalfSector::enrich`] takes the error of a frequency down by the
//! fourth power of its ratio to those beyond reach.
//!
//! A healthy sector is its own mirror image about the tooth's centre line. A field is the sum of a part equal to its image (*even*)
//! and of one opposite to it (*odd*), and stiffness and mass couple neither with the other. In radial, tangential, axial components
//! `F = diag(1, -1, 1)` is the mirror on a cut, and the upper cut `sigma` alone describes a half: the lower one is `F sigma` or
//! `-F sigma`. So all matrices here are of one cut, real, and half of what they would be.

use faer::Mat;
use nalgebra::Point2;

use super::krylov::{append, lengths, orthonormal_mix};
use crate::condense::CondensedBody;
use crate::error::FecmError;
use crate::face::FaceBasis;
use crate::linalg::{product, symmetrise};
use crate::mass::{BodyMass, RigidMotion};
use crate::mesh::SectorMesh;

/// Behaviour under the mirror about the tooth's centre line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mirror {
    Even,
    Odd,
}

impl Mirror {
    fn sign(self) -> f64 {
        match self {
            Self::Even => 1.0,
            Self::Odd => -1.0,
        }
    }
}

/// Where the unknowns of a sector stand in one family: node fields, interior, cuts.
#[derive(Clone, Copy)]
pub(super) struct SectorLayout<'a> {
    pub(super) shape: &'a SectorMesh,
    pub(super) basis: &'a FaceBasis,
    pub(super) condensed: &'a CondensedBody,
}

impl SectorLayout<'_> {
    fn rows(&self) -> usize {
        self.shape.mesh.nodes.len() * self.basis.block()
    }

    /// Component along the face or in the plane of each unknown of the upper cut: 0 radial, 1 tangential, 2 axial.
    pub(super) fn cut_components(&self) -> Vec<usize> {
        let held = |node: &&u32| self.condensed.retained_row(**node, 0).is_some();
        let nodes = self.shape.upper_cut.iter().filter(held).count();
        let components: Vec<usize> = self.basis.dofs().iter().map(|dof| dof.component).collect();
        components.repeat(nodes)
    }

    /// Interior unknowns as node fields, the rest zero.
    fn expand(&self, interior: &Mat<f64>) -> Mat<f64> {
        let mut fields = Mat::zeros(self.rows(), interior.ncols());
        self.for_interior(|row, inner| {
            for k in 0..interior.ncols() {
                fields[(row, k)] = interior[(inner, k)];
            }
        });
        fields
    }

    /// Interior unknowns of node fields.
    fn gather(&self, fields: &Mat<f64>) -> Mat<f64> {
        let mut interior = Mat::zeros(self.condensed.interior_size(), fields.ncols());
        self.for_interior(|row, inner| {
            for k in 0..fields.ncols() {
                interior[(inner, k)] = fields[(row, k)];
            }
        });
        interior
    }

    fn for_interior(&self, mut visit: impl FnMut(usize, usize)) {
        let block = self.basis.block();
        for node in 0..self.shape.mesh.nodes.len() {
            if let Some(inner) = self.condensed.interior_row(node as u32, 0) {
                (0..block).for_each(|dof| visit(node * block + dof, inner + dof));
            }
        }
    }

    /// Node fields of cut displacements in local axes, without forces inside.
    pub(super) fn fields_of_cuts(&self, cuts: &Mat<f64>) -> Mat<f64> {
        let mut interior = product(self.condensed.retained_solution(), cuts.as_ref());
        interior *= faer::Scale(-1.0);
        let mut fields = self.expand(&interior);
        self.place_cuts(cuts, &mut fields);
        fields
    }

    /// Node fields of unit displacements of the upper cut, the lower one its image.
    fn fields_of_upper(&self, mirror: Mirror) -> Mat<f64> {
        let cuts = self.cuts_of_upper(mirror);
        let n = cuts.ncols();
        let by_cuts = self.condensed.retained_solution();
        let mut interior = Mat::zeros(by_cuts.nrows(), n);
        for k in 0..n {
            let image = cuts[(k, k)];
            let (lower, upper) = (by_cuts.col(k), by_cuts.col(n + k));
            for (value, (lower, upper)) in interior.col_as_slice_mut(k).iter_mut().zip(lower.iter().zip(upper.iter())) {
                *value = -image * lower - upper;
            }
        }
        let mut fields = self.expand(&interior);
        self.place_cuts(&cuts, &mut fields);
        fields
    }

    /// Both cuts (lower, upper; the order of the condensed stiffness) by the upper one.
    pub(super) fn cuts_of_upper(&self, mirror: Mirror) -> Mat<f64> {
        let components = self.cut_components();
        let n = components.len();
        Mat::from_fn(2 * n, n, |i, j| match i.checked_sub(n) {
            Some(upper) => f64::from(u8::from(upper == j)),
            None if i != j => 0.0,
            None if components[j] == 1 => -mirror.sign(),
            None => mirror.sign(),
        })
    }

    /// Writes cut displacements, given in local axes, into node fields.
    fn place_cuts(&self, cuts: &Mat<f64>, fields: &mut Mat<f64>) {
        let block = self.basis.block();
        let pairs = self.basis.plane_degrees().len();
        let half = 0.5 * self.shape.sector_angle;
        for (nodes, angle) in [(&self.shape.lower_cut, -half), (&self.shape.upper_cut, half)] {
            let (sine, cosine) = angle.sin_cos();
            for &node in nodes {
                let Some(first) = self.condensed.retained_row(node, 0) else { continue };
                let at = node as usize * block;
                for k in 0..cuts.ncols() {
                    for pair in 0..pairs {
                        let (radial, tangential) = (cuts[(first + 2 * pair, k)], cuts[(first + 2 * pair + 1, k)]);
                        fields[(at + 2 * pair, k)] = cosine * radial - sine * tangential;
                        fields[(at + 2 * pair + 1, k)] = sine * radial + cosine * tangential;
                    }
                    for dof in 2 * pairs..block {
                        fields[(at + dof, k)] = cuts[(first + dof, k)];
                    }
                }
            }
        }
    }
}

/// A sector in one family, with its mass and its mirror.
pub(super) struct SectorSpace<'a> {
    pub(super) layout: SectorLayout<'a>,
    pub(super) mass: BodyMass,
    /// Mirror image of each node.
    images: Vec<usize>,
}

impl<'a> SectorSpace<'a> {
    pub(super) fn new(layout: SectorLayout<'a>, density: f64) -> Result<Self, FecmError> {
        let mesh = &layout.shape.mesh;
        Ok(Self { layout, mass: BodyMass::new(mesh, layout.basis, density), images: mirror_images(&mesh.nodes)? })
    }

    /// Keeps one mirror half of node fields.
    fn keep(&self, mirror: Mirror, fields: &mut Mat<f64>) {
        let block = self.layout.basis.block();
        let flips: Vec<f64> =
            self.layout.basis.dofs().iter().map(|dof| if dof.component == 1 { -1.0 } else { 1.0 }).collect();
        for column in 0..fields.ncols() {
            let values = fields.col_as_slice_mut(column);
            for (node, &image) in self.images.iter().enumerate().filter(|&(node, &image)| image >= node) {
                for (dof, flip) in flips.iter().enumerate() {
                    let (a, b) = (node * block + dof, image * block + dof);
                    let sign = mirror.sign() * flip;
                    let mean = 0.5 * (values[a] + sign * values[b]);
                    values[a] = mean;
                    values[b] = sign * mean;
                }
            }
        }
    }
}

/// A mirror half of the sector, reduced to its upper cut and a few fields with the cuts held.
pub(super) struct HalfSector {
    pub(super) mirror: Mirror,
    /// Stiffness of the upper cut.
    pub(super) cut_stiffness: Mat<f64>,
    /// Mass of the upper cut.
    pub(super) cut_mass: Mat<f64>,
    /// `M` times the fields of unit displacements of the upper cut.
    cut_momenta: Mat<f64>,
    /// Fields with the cuts held, of unit mass and orthogonal in it.
    pub(super) held: Mat<f64>,
    /// `M` and `K` times these fields; of the latter the interior forces.
    momenta: Mat<f64>,
    forces: Mat<f64>,
    /// Stiffness of the held fields.
    pub(super) held_stiffness: Mat<f64>,
    /// Mass between upper cut (rows) and held fields.
    pub(super) coupling: Mat<f64>,
}

impl HalfSector {
    /// Reduces one half to its cut alone.
    pub(super) fn new(space: &SectorSpace<'_>, mirror: Mirror) -> Self {
        let layout = &space.layout;
        let cuts = layout.cuts_of_upper(mirror);
        let constraints = layout.fields_of_upper(mirror);
        let cut_momenta = space.mass.apply(&constraints);
        let mut cut_mass = product(constraints.transpose(), cut_momenta.as_ref());
        symmetrise(&mut cut_mass);
        let spread = product(layout.condensed.stiffness().as_ref(), cuts.as_ref());
        let mut cut_stiffness = product(cuts.transpose(), spread.as_ref());
        symmetrise(&mut cut_stiffness);
        let (rows, cut) = (layout.rows(), cut_mass.nrows());
        let none = || Mat::zeros(rows, 0);
        Self {
            mirror,
            cut_stiffness,
            cut_mass,
            cut_momenta,
            held: none(),
            momenta: none(),
            forces: none(),
            held_stiffness: Mat::zeros(0, 0),
            coupling: Mat::zeros(cut, 0),
        }
    }

    /// Adds what the inertia of given motions (cut, then held fields; one a column) does inside the sector: `K_II^-1 (M u)_I`, as far as the
    /// held fields do not have it. Returns how many fields were new.
    pub(super) fn enrich(&mut self, space: &SectorSpace<'_>, motions: &Mat<f64>) -> Result<usize, FecmError> {
        if motions.ncols() == 0 {
            return Ok(0);
        }
        let layout = &space.layout;
        let cut = self.cut_mass.nrows();
        let mut inertia = product(self.cut_momenta.as_ref(), motions.as_ref().subrows(0, cut));
        inertia += product(self.momenta.as_ref(), motions.as_ref().subrows(cut, self.held.ncols()));
        space.keep(self.mirror, &mut inertia);
        let mut interior = layout.gather(&inertia);
        let mut forces = layout.expand(&interior);
        layout.condensed.solve_interior(&mut interior);
        let mut fields = layout.expand(&interior);
        space.keep(self.mirror, &mut fields);
        let mut before = lengths(&fields, &space.mass.apply(&fields));
        for _ in 0..3 {
            let part = product(self.momenta.transpose(), fields.as_ref());
            fields -= product(self.held.as_ref(), part.as_ref());
            forces -= product(self.forces.as_ref(), part.as_ref());
            let mix = orthonormal_mix(&fields, &space.mass.apply(&fields), &before)?;
            fields = product(fields.as_ref(), mix.as_ref());
            forces = product(forces.as_ref(), mix.as_ref());
            before = vec![1.0; fields.ncols()];
        }
        let momenta = space.mass.apply(&fields);
        append(&mut self.coupling, &product(self.cut_momenta.transpose(), fields.as_ref()));
        append(&mut self.held, &fields);
        append(&mut self.momenta, &momenta);
        append(&mut self.forces, &forces);
        self.held_stiffness = product(self.held.transpose(), self.forces.as_ref());
        symmetrise(&mut self.held_stiffness);
        Ok(fields.ncols())
    }

    /// `M r` on cut and held fields for each rigid motion of the family.
    pub(super) fn rigid(&self, space: &SectorSpace<'_>) -> [Vec<f64>; 6] {
        RigidMotion::ALL.map(|motion| {
            let mut field = motion.field(&space.layout.shape.mesh.nodes, space.layout.basis);
            space.keep(self.mirror, &mut field);
            let on_cut = product(self.cut_momenta.transpose(), field.as_ref());
            let on_held = product(self.momenta.transpose(), field.as_ref());
            [on_cut.col_as_slice(0), on_held.col_as_slice(0)].concat()
        })
    }

    /// Unknowns: upper cut and held fields.
    pub(super) fn size(&self) -> usize {
        self.cut_stiffness.nrows() + self.held.ncols()
    }
}

/// Node at the mirror image `(x, -y)` of each node.
fn mirror_images(nodes: &[Point2<f64>]) -> Result<Vec<usize>, FecmError> {
    let extent = nodes.iter().fold(0.0_f64, |most, p| most.max(p.coords.norm()));
    let tolerance = 1e-9 * extent;
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by(|&a, &b| nodes[a].x.total_cmp(&nodes[b].x));
    let image = |p: &Point2<f64>| {
        let first = order.partition_point(|&k| nodes[k].x < p.x - tolerance);
        let near = order[first..].iter().take_while(|&&k| nodes[k].x <= p.x + tolerance);
        near.copied().find(|&k| (nodes[k].y + p.y).abs() <= tolerance)
    };
    nodes.iter().map(|p| image(p).ok_or(FecmError::NotMirrored { x: p.x, y: p.y })).collect()
}
