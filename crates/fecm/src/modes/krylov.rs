//! Lowest eigenpairs of `K u = omega^2 M u` by block Krylov spaces of `K^-1 M`.
//!
//! Each step multiplies the newest block by `K^-1 M`, makes it orthonormal in the inner product of `M` against all blocks before it
//! (twice: full reorthogonalisation), and adds it to the basis; the Ritz pairs of `K^-1 M` on the basis are the estimates. The residual
//! of a Ritz pair is known from the last block without forming it, and the error of an eigenvalue is of its square (Golub and Van Loan,
//! *Matrix Computations*, 4th ed., section 10.3; Grimes, Lewis and Simon 1994). Blocks find eigenvalues of multiplicity up to the block
//! width. When many of all eigenpairs are wanted the start is the whole space: the same steps are then a dense solution.

use faer::Mat;

use crate::error::FecmError;
use crate::linalg::{product, symmetric_eigen, symmetrise};

/// A symmetric positive definite pair of matrices, known by what they do.
pub trait Pencil {
    /// Number of unknowns.
    fn size(&self) -> usize;
    /// `K^-1 f`.
    fn solve(&self, forces: Mat<f64>) -> Mat<f64>;
    /// `M u`.
    fn mass(&self, fields: &Mat<f64>) -> Mat<f64>;
}

/// Eigenpairs, ascending.
pub struct Eigenpairs {
    /// `omega^2` (rad^2/s^2).
    pub values: Vec<f64>,
    /// Eigenvectors of unit modal mass, one a column.
    pub vectors: Mat<f64>,
}

/// Width of a block where nothing asks for more: eigenvalues of this multiplicity are found.
pub const BLOCK: usize = 5;
/// Residual of an accepted Ritz pair, relative to its Ritz value: the eigenvalue is then good to the square of it over the gap.
const RESIDUAL: f64 = 1e-8;
/// Part of its length that a field must keep after what is known of it is taken away, to count as new. Eigenvalues feel what is
/// left out by its square; what little is left of longer differences is rounding.
const NEW: f64 = 1e-6;

/// The lowest `count` eigenpairs, or all if there are fewer, by blocks of the given width (at least 1): wide blocks make few, cheap solutions of
/// many right-hand sides, narrow ones a smaller basis.
///
/// # Errors
/// [`FecmError::EigenNotConverged`] naming `what`.
pub fn lowest(pencil: &impl Pencil, count: usize, block: usize, what: &'static str) -> Result<Eigenpairs, FecmError> {
    let size = pencil.size();
    if count == 0 || size == 0 {
        return Ok(Eigenpairs { values: Vec::new(), vectors: Mat::zeros(size, 0) });
    }
    let block = block.max(1);
    if 4 * (count + block) < size {
        let found = expand(pencil, scattered(size, block), count, what)?;
        if found.values.len() >= count {
            return Ok(found);
        }
    }
    expand(pencil, Mat::identity(size, size), count, what)
}

/// Grows a Krylov space from a start until `count` pairs are found or the space is closed.
fn expand(pencil: &impl Pencil, start: Mat<f64>, count: usize, what: &'static str) -> Result<Eigenpairs, FecmError> {
    let start_width = start.ncols();
    let lengths = lengths(&start, &pencil.mass(&start));
    let mut basis = Mat::zeros(pencil.size(), 0);
    let mut momenta = Mat::zeros(pencil.size(), 0);
    // room for what is likely needed, so that growing does not copy
    let likely = (2 * count + 4 * start_width).min(pencil.size());
    basis.reserve(pencil.size(), likely);
    momenta.reserve(pencil.size(), likely);
    let mut block = orthonormal(pencil, start, &lengths)?;
    let mut projected = Mat::<f64>::zeros(0, 0);
    let wanted_total = (count + 2 * start_width).min(pencil.size());
    // the small eigenproblem is solved again when the basis has grown by an eighth
    let mut due = wanted_total;
    loop {
        let first = basis.ncols();
        let moved = pencil.mass(&block);
        append(&mut basis, &block);
        append(&mut momenta, &moved);
        let total = basis.ncols();
        let mut next = pencil.solve(moved);
        let before = self::lengths(&next, &pencil.mass(&next));
        let mut coefficients = Mat::zeros(total, total - first);
        for _ in 0..2 {
            let part = product(momenta.transpose(), next.as_ref());
            next -= product(basis.as_ref(), part.as_ref());
            coefficients += part;
        }
        let rest = next.clone();
        let mut follower = orthonormal(pencil, next, &before)?;
        // once more against the basis: normalising enlarges what is left of it
        let part = product(momenta.transpose(), follower.as_ref());
        follower -= product(basis.as_ref(), part.as_ref());
        let unit = vec![1.0; follower.ncols()];
        let follower = orthonormal(pencil, follower, &unit)?;
        projected.resize_with(total, total, |i, j| if j >= first { coefficients[(i, j - first)] } else { 0.0 });
        for j in first..total {
            for i in 0..first {
                projected[(j, i)] = projected[(i, j)];
            }
        }
        let closed = follower.ncols() == 0;
        if closed || total >= due {
            due = total + (2 * start_width).max(total / 8);
            let mut small = projected.clone();
            symmetrise(&mut small);
            // ascending Ritz values of K^-1 M: the last ones are the lowest frequencies
            let (values, vectors) = symmetric_eigen(&small, what)?;
            let wanted = count.min(total);
            let residual = product(pencil.mass(&follower).transpose(), rest.as_ref());
            let tail = vectors.as_ref().submatrix(first, total - wanted, total - first, wanted);
            let residual = product(residual.as_ref(), tail);
            let settled = (0..wanted).all(|k| residual.col(k).norm_l2() <= RESIDUAL * values[total - wanted + k].abs());
            if closed || settled {
                let chosen = Mat::from_fn(total, wanted, |i, k| vectors[(i, total - 1 - k)]);
                return Ok(Eigenpairs {
                    values: (0..wanted).map(|k| 1.0 / values[total - 1 - k]).collect(),
                    vectors: product(basis.as_ref(), chosen.as_ref()),
                });
            }
        }
        block = follower;
    }
}

/// Orthonormal columns that span those of `fields`, but for what is short against the lengths `before`.
fn orthonormal(pencil: &impl Pencil, fields: Mat<f64>, before: &[f64]) -> Result<Mat<f64>, FecmError> {
    let mix = orthonormal_mix(&fields, &pencil.mass(&fields), before)?;
    let fields = product(fields.as_ref(), mix.as_ref());
    let mix = orthonormal_mix(&fields, &pencil.mass(&fields), &vec![1.0; fields.ncols()])?;
    Ok(product(fields.as_ref(), mix.as_ref()))
}

/// What columns must be multiplied by to be orthonormal, given `M` times them; directions short against the lengths `before` are left out.
/// Twice makes it exact to rounding.
pub(super) fn orthonormal_mix(fields: &Mat<f64>, moved: &Mat<f64>, before: &[f64]) -> Result<Mat<f64>, FecmError> {
    let n = fields.ncols();
    let scales: Vec<f64> = before.iter().map(|&length| if length > 0.0 { 1.0 / length } else { 0.0 }).collect();
    let gram = product(fields.transpose(), moved.as_ref());
    let mut gram = Mat::from_fn(n, n, |i, j| gram[(i, j)] * scales[i] * scales[j]);
    symmetrise(&mut gram);
    let (values, vectors) = symmetric_eigen(&gram, "Gram")?;
    let new: Vec<usize> = (0..n).filter(|&k| values[k] > NEW * NEW).collect();
    Ok(Mat::from_fn(n, new.len(), |i, k| vectors[(i, new[k])] * scales[i] / values[new[k]].sqrt()))
}

/// Lengths of columns, given `M` times them.
pub(super) fn lengths(fields: &Mat<f64>, moved: &Mat<f64>) -> Vec<f64> {
    let square =
        |k: usize| -> f64 { fields.col_as_slice(k).iter().zip(moved.col_as_slice(k)).map(|(a, b)| a * b).sum() };
    (0..fields.ncols()).map(|k| square(k).max(0.0).sqrt()).collect()
}

/// Adds columns.
pub fn append(all: &mut Mat<f64>, columns: &Mat<f64>) {
    let (rows, first) = (all.nrows(), all.ncols());
    all.resize_with(rows, first + columns.ncols(), |i, j| columns[(i, j - first)]);
}

/// Columns of scattered numbers in (-1, 1), the same at every call (the 64-bit mixer of Steele, Lea and Flood 2014).
fn scattered(rows: usize, columns: usize) -> Mat<f64> {
    let mut state = 0_u64;
    let mut number = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
    };
    Mat::from_fn(rows, columns, |_, _| number())
}
