//! Reduction of a finite-element structure to few uncoupled coordinates that are exact in rest.
//!
//! The lowest modes `Phi` of the held structure are completed by residual attachment vectors: static responses `X = K^-1 F` to unit loads at all
//! ports and harmonics of the seat, less what the modes take part in, `R = X - Phi Omega^-2 Phi^T F` (MacNeal 1971; Rubin 1975;
//! Dickens, Nakagawa and Wittbrodt 1997). `R` is orthogonal to the modes in both `K` and `M`. Its own stiffness `R^T K R = R^T F` is
//! the residual compliance; directions with less than `NEGLIGIBLE` of the compliance of a load are rounding and left out. Made orthonormal in
//! `K` and diagonalised in `M` they are further coordinates, of high frequency: all inertia that loads can feel at rest or slowly, none
//! of the eigenforms. With modes left out above a frequency limit, motion is exact in statics and good to about half that limit.

use faer::Mat;
use fecm::linalg::{product, symmetric_eigen, symmetrise};
use fecm::modes::krylov::{Pencil, lowest};

use super::assembly::Structure;
use super::error::HousingError;

/// Part of a load's own compliance below which a residual direction is left out. Rounding of the subtraction is some 1e-15.
const NEGLIGIBLE: f64 = 1e-12;
/// Width of the Krylov blocks.
const BLOCK: usize = 12;

/// Uncoupled coordinates of unit modal mass.
#[derive(Debug, Clone)]
pub struct Reduced {
    /// Circular frequencies (rad/s), ascending.
    pub frequencies: Vec<f64>,
    /// Displacements of the free nodes per unit of each coordinate.
    pub shapes: Mat<f64>,
    /// How many of the coordinates are eigenmodes.
    pub modes: usize,
    /// Circular frequency of the highest mode found, whether kept or not (rad/s): the spectrum is complete up to it.
    pub complete_to: f64,
}

/// Keeps the lowest `most` modes up to the circular frequency `limit`, and the static response to each column of `loads`.
///
/// # Errors
/// [`HousingError::Algebra`] where an eigenproblem does not converge.
pub fn reduce(structure: &Structure, loads: &Mat<f64>, most: usize, limit: f64) -> Result<Reduced, HousingError> {
    let found = lowest(structure, most, BLOCK, "housing")?;
    let complete_to = found.values.last().map_or(0.0, |value| value.sqrt());
    let modes = found.values.iter().filter(|value| value.sqrt() <= limit).count();
    let phi = found.vectors.subcols(0, modes).to_owned();
    let residual = residual_vectors(structure, loads, &phi, &found.values[..modes])?;
    let mut coordinates: Vec<(f64, Option<usize>)> =
        found.values[..modes].iter().enumerate().map(|(k, value)| (value.sqrt(), Some(k))).collect();
    coordinates.extend(residual.frequencies.iter().map(|&frequency| (frequency, None)));
    // residual coordinates come in ascending order, and as a rule after the modes
    let mut next = 0;
    let mut sources: Vec<(f64, usize)> = Vec::with_capacity(coordinates.len());
    for (frequency, mode) in coordinates {
        sources.push((
            frequency,
            mode.unwrap_or_else(|| {
                next += 1;
                modes + next - 1
            }),
        ));
    }
    sources.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let column = |row, k: usize| {
        let source = sources[k].1;
        if source < modes { phi[(row, source)] } else { residual.shapes[(row, source - modes)] }
    };
    Ok(Reduced {
        frequencies: sources.iter().map(|source| source.0).collect(),
        shapes: Mat::from_fn(phi.nrows(), sources.len(), column),
        modes,
        complete_to,
    })
}

struct Residual {
    frequencies: Vec<f64>,
    shapes: Mat<f64>,
}

fn residual_vectors(
    structure: &Structure,
    loads: &Mat<f64>,
    phi: &Mat<f64>,
    values: &[f64],
) -> Result<Residual, HousingError> {
    let statics = structure.solve(loads.clone());
    let whole = product(loads.transpose(), statics.as_ref());
    let parts = product(phi.transpose(), loads.as_ref());
    let weighted = Mat::from_fn(parts.nrows(), parts.ncols(), |k, j| parts[(k, j)] / values[k]);
    let residual = statics - product(phi.as_ref(), weighted.as_ref());
    let scales: Vec<f64> =
        (0..loads.ncols()).map(|k| whole[(k, k)]).map(|c| if c > 0.0 { 1.0 / c.sqrt() } else { 0.0 }).collect();
    let compliance = product(residual.transpose(), loads.as_ref());
    let mut compliance = Mat::from_fn(loads.ncols(), loads.ncols(), |i, j| compliance[(i, j)] * scales[i] * scales[j]);
    symmetrise(&mut compliance);
    let (sizes, mix) = symmetric_eigen(&compliance, "residual compliance")?;
    let kept: Vec<usize> = (0..sizes.len()).filter(|&k| sizes[k] > NEGLIGIBLE).collect();
    // orthonormal in the stiffness
    let mix = Mat::from_fn(loads.ncols(), kept.len(), |i, k| scales[i] * mix[(i, kept[k])] / sizes[kept[k]].sqrt());
    let fields = product(residual.as_ref(), mix.as_ref());
    let mut inertia = product(fields.transpose(), structure.mass(&fields).as_ref());
    symmetrise(&mut inertia);
    let (masses, turn) = symmetric_eigen(&inertia, "residual inertia")?;
    // of unit modal mass, lowest frequency (largest mass) first; `omega^2` is one over the mass at unit stiffness
    let order: Vec<usize> = (0..masses.len()).rev().filter(|&k| masses[k] > 0.0).collect();
    let turn = Mat::from_fn(masses.len(), order.len(), |i, k| turn[(i, order[k])] / masses[order[k]].sqrt());
    Ok(Residual {
        frequencies: order.iter().map(|&k| 1.0 / masses[k].sqrt()).collect(),
        shapes: product(fields.as_ref(), turn.as_ref()),
    })
}
