//! What is read from the motion of nodes: the rigid frame of a set, harmonics of a ring, a sensor. A load on what is read is the transpose.

use faer::Mat;
use fecm::linalg::{DenseCholesky, symmetric_eigen};
use nalgebra::Vector3;

use super::assembly::Structure;
use super::error::HousingError;
use super::mesh::SolidMesh;
use super::surface::{Surface, SurfacePoint};

/// Linear functions of the displacements of nodes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// For each function its nodes and the weights of their displacements.
    pub rows: Vec<Vec<(u32, Vector3<f64>)>>,
}

/// Smallest eigenvalue of the normal matrix of a fit, scaled to a unit diagonal: below it a set does not determine what is fitted.
const SMALLEST: f64 = 1e-8;

impl Reading {
    /// Values for each column of fields on the free nodes.
    #[must_use]
    pub fn of(&self, structure: &Structure, fields: &Mat<f64>) -> Mat<f64> {
        let mut values = Mat::zeros(self.rows.len(), fields.ncols());
        for column in 0..fields.ncols() {
            let field = fecm::linalg::column_slice(fields, column);
            for (k, row) in self.rows.iter().enumerate() {
                values[(k, column)] = row
                    .iter()
                    .filter_map(|(node, weight)| {
                        let at = 3 * structure.number(*node)?;
                        Some(weight.dot(&Vector3::new(field[at], field[at + 1], field[at + 2])))
                    })
                    .sum();
            }
        }
        values
    }

    /// Forces of unit loads on what is read, a column each.
    #[must_use]
    pub fn loads(&self, structure: &Structure) -> Mat<f64> {
        let mut forces = Mat::zeros(3 * structure.free_nodes().len(), self.rows.len());
        for (k, row) in self.rows.iter().enumerate() {
            for (node, weight) in row {
                if let Some(number) = structure.number(*node) {
                    for d in 0..3 {
                        forces[(3 * number + d, k)] += weight[d];
                    }
                }
            }
        }
        forces
    }

    /// Motion of a rigid frame at a place that fits a node set best: least squares with the nodes' shares in the surface (the weighted
    /// average of an RBE3 element). Rows: displacement `x, y, z` (m), small rotation about `x, y, z` (rad).
    ///
    /// # Errors
    /// [`HousingError::WeakSet`] of a set on a line, [`HousingError::NoSet`].
    pub fn frame(mesh: &SolidMesh, surface: &Surface, name: &str, place: [f64; 3]) -> Result<Self, HousingError> {
        let set = mesh.set(name)?;
        let shares = surface.shares(mesh, set);
        let design = |node: u32| {
            let arm = mesh.node(node) - Vector3::from(place);
            // displacement of the node by the six motions of the frame, a column of three each
            let turn = |axis: Vector3<f64>| axis.cross(&arm);
            vec![Vector3::x(), Vector3::y(), Vector3::z(), turn(Vector3::x()), turn(Vector3::y()), turn(Vector3::z())]
        };
        fit(set, &shares, 6, design).ok_or_else(|| HousingError::WeakSet {
            set: name.to_owned(),
            nodes: set.len(),
            what: "the motion of a rigid frame".to_owned(),
        })
    }

    /// Harmonics of the angle about `z` up to the given one of a node set on a circle: radial, tangential, axial displacement, each by
    /// `1, cos t, sin t, ..., cos N t, sin N t`.
    ///
    /// Least squares with shares of the surface. Displacements that vary along `z` as those of a tilted ring do are fitted with them and left out,
    /// so that every rigid motion is read exactly whatever the nodes' heights.
    ///
    /// # Errors
    /// [`HousingError::WeakSet`] where the nodes are too few for the harmonics, [`HousingError::NoSet`].
    pub fn harmonics(
        mesh: &SolidMesh,
        surface: &Surface,
        name: &str,
        harmonics: usize,
    ) -> Result<(Self, Circle), HousingError> {
        let set = mesh.set(name)?;
        let shares = surface.shares(mesh, set);
        let mean = |of: &dyn Fn(Vector3<f64>) -> f64| -> f64 {
            set.iter().zip(&shares).map(|(&node, share)| share * of(mesh.node(node))).sum()
        };
        let circle = Circle { radius: mean(&|x| x.xy().norm()), z: mean(&|x| x.z) };
        let spread: f64 = mean(&|x| (x.z - circle.z).powi(2)).sqrt();
        let count = 2 * harmonics + 1;
        // heights tell tilting terms from others only where there are several
        let tilting = if spread > 1e-6 * circle.radius { 3 } else { 0 };
        let design = |node: u32| {
            let x = mesh.node(node);
            let angle = x.y.atan2(x.x);
            let height = (x.z - circle.z) / circle.radius;
            let harmonic = |k: usize| {
                let order = k.div_ceil(2) as f64;
                if k % 2 == 1 || k == 0 { (order * angle).cos() } else { (order * angle).sin() }
            };
            let directions = [
                Vector3::new(angle.cos(), angle.sin(), 0.0),
                Vector3::new(-angle.sin(), angle.cos(), 0.0),
                Vector3::z(),
            ];
            let wanted = directions.iter().flat_map(|d| (0..count).map(move |k| harmonic(k) * d));
            let left_out = directions.iter().flat_map(|d| (0..tilting).map(move |k| height * harmonic(k) * d));
            wanted.chain(left_out).collect()
        };
        let weak = || HousingError::WeakSet {
            set: name.to_owned(),
            nodes: set.len(),
            what: format!("{harmonics} harmonics of a ring"),
        };
        let mut reading = fit(set, &shares, 3 * (count + tilting), design).ok_or_else(weak)?;
        reading.rows.truncate(3 * count);
        Ok((reading, circle))
    }

    /// Displacement of a point of the surface along a direction.
    #[must_use]
    pub fn sensor(point: &SurfacePoint, direction: Vector3<f64>) -> Self {
        Self { rows: vec![point.nodes.iter().map(|&(node, weight)| (node, weight * direction)).collect()] }
    }
}

/// The circle of a ring seat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Mean radius (m).
    pub radius: f64,
    /// Mean height (m).
    pub z: f64,
}

/// Weighted least squares of `count` motions, given the displacements of a node by each; `None` where the set does not determine them.
fn fit(set: &[u32], shares: &[f64], count: usize, design: impl Fn(u32) -> Vec<Vector3<f64>>) -> Option<Reading> {
    let columns: Vec<Vec<Vector3<f64>>> = set.iter().map(|&node| design(node)).collect();
    let mut normal = Mat::<f64>::zeros(count, count);
    for (column, share) in columns.iter().zip(shares) {
        for j in 0..count {
            for i in 0..count {
                normal[(i, j)] += share * column[i].dot(&column[j]);
            }
        }
    }
    let scales: Vec<f64> = (0..count).map(|k| normal[(k, k)].sqrt()).collect();
    if !scales.iter().all(|&scale| scale > 0.0) {
        return None;
    }
    let scaled = Mat::from_fn(count, count, |i, j| normal[(i, j)] / (scales[i] * scales[j]));
    let (values, _) = symmetric_eigen(&scaled, "least-squares").ok()?;
    if !(values.first().copied()? > SMALLEST) {
        return None;
    }
    let inverse = DenseCholesky::new(scaled, "least-squares").ok()?.inverse();
    let row = |k: usize| {
        let weight = |(column, share): (&Vec<Vector3<f64>>, &f64)| -> Vector3<f64> {
            (0..count).map(|j| inverse[(k, j)] / (scales[k] * scales[j]) * *share * column[j]).sum()
        };
        set.iter().copied().zip(columns.iter().zip(shares).map(weight)).collect()
    };
    Some(Reading { rows: (0..count).map(row).collect() })
}
