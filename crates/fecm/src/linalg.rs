//! Linear algebra of the crate: the only file that names faer's parallelism.
//!
//! Dense operations run on the calling thread (`Par::Seq`): parallelism sits outside, over bodies, positions and panels of right-hand
//! sides, so that results do not depend on the number of threads.
//!
//! * [`BlockCholesky`]: sparse Cholesky factorisation of a symmetric positive definite matrix given as dense
//!   blocks on the edges of a node graph. The fill-reducing order (approximate minimum degree) is found on the
//!   node graph, which is `block` times smaller than the matrix.
//! * Dense helpers: products, Cholesky solves, symmetrisation.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::matmul::matmul;
use faer::perm::PermRef;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, Mat, MatMut, MatRef, Par, Side};

use crate::error::FecmError;

/// `a * b`.
#[must_use]
pub fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut c = Mat::zeros(a.nrows(), b.ncols());
    matmul(c.as_mut(), Accum::Replace, a, b, 1.0, Par::Seq);
    c
}

/// `a^T * b`, skipping the rows that are zero in all of `a`.
#[must_use]
pub fn product_of_sparse_rows(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    let mut filled = vec![false; a.nrows()];
    for j in 0..a.ncols() {
        for (flag, value) in filled.iter_mut().zip(a.col_as_slice(j)) {
            *flag |= *value != 0.0;
        }
    }
    let rows: Vec<usize> = (0..a.nrows()).filter(|&row| filled[row]).collect();
    let gather = |m: &Mat<f64>| Mat::from_fn(rows.len(), m.ncols(), |i, j| m[(rows[i], j)]);
    product(gather(a).transpose(), gather(b).as_ref())
}

/// `c += alpha * a * b`.
pub fn add_product(c: MatMut<'_, f64>, alpha: f64, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    matmul(c, Accum::Add, a, b, alpha, Par::Seq);
}

/// A column as a slice.
#[must_use]
pub fn column_slice(a: &Mat<f64>, column: usize) -> &[f64] {
    a.col_as_slice(column)
}

/// A column as a slice to write.
pub fn column_slice_mut(a: &mut Mat<f64>, column: usize) -> &mut [f64] {
    a.col_as_slice_mut(column)
}

/// Lower triangle of the rows and columns of a symmetric matrix with the given indices; zero above.
#[must_use]
pub fn lower_triangle(a: MatRef<'_, f64>, indices: &[usize]) -> Mat<f64> {
    let mut part = Mat::zeros(indices.len(), indices.len());
    for (j, &column) in indices.iter().enumerate() {
        let source = a.col(column).try_as_col_major();
        for (target, &row) in part.col_as_slice_mut(j).iter_mut().zip(indices).skip(j) {
            *target = match source {
                Some(source) => source.as_slice()[row],
                None => a[(row, column)],
            };
        }
    }
    part
}

/// `y += alpha * x`.
pub fn add_scaled(y: &mut [f64], alpha: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += alpha * x;
    }
}

/// `c[row.., column..] += alpha * block`.
pub fn add_block(c: &mut Mat<f64>, row: usize, column: usize, alpha: f64, block: &Mat<f64>) {
    let height = block.nrows();
    for j in 0..block.ncols() {
        add_scaled(&mut c.col_as_slice_mut(column + j)[row..row + height], alpha, block.col_as_slice(j));
    }
}

/// Replaces a square matrix by its symmetric part.
pub fn symmetrise(a: &mut Mat<f64>) {
    let transposed = a.transpose().to_owned();
    for j in 0..a.ncols() {
        for (value, other) in a.col_as_slice_mut(j).iter_mut().zip(transposed.col_as_slice(j)) {
            *value = 0.5 * (*value + other);
        }
    }
}

/// `a^-1 b` for a square, not symmetric `a`, by elimination with partial pivoting.
#[must_use]
pub fn solve_general(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    use faer::linalg::solvers::Solve as _;
    a.partial_piv_lu().solve(b)
}

/// Eigenvalues, ascending, and orthonormal eigenvectors of a symmetric matrix, from its lower triangle.
///
/// # Errors
/// [`FecmError::EigenNotConverged`] with `what`, also for entries that are not numbers.
pub fn symmetric_eigen(a: &Mat<f64>, what: &'static str) -> Result<(Vec<f64>, Mat<f64>), FecmError> {
    use faer::linalg::evd::{ComputeEigenvectors, SelfAdjointEvdParams, self_adjoint_evd, self_adjoint_evd_scratch};
    let n = a.nrows();
    // QR iteration at any size: divide and conquer (faer 0.24.4, from 128 rows) was seen to leave residuals of 1e-5 of the largest
    // eigenvalue where eigenvalues come in pairs, as those of a cyclic body do
    let params = SelfAdjointEvdParams { recursion_threshold: usize::MAX, ..<_ as faer::Auto<f64>>::auto() }.into();
    let mut memory = MemBuffer::new(self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, params));
    let mut values = Diag::<f64>::zeros(n);
    let mut vectors = Mat::zeros(n, n);
    let stack = MemStack::new(&mut memory);
    self_adjoint_evd(a.as_ref(), values.as_mut(), Some(vectors.as_mut()), Par::Seq, stack, params)
        .map_err(|_| FecmError::EigenNotConverged { what, size: n })?;
    let values: Vec<f64> = values.column_vector().iter().copied().collect();
    if values.iter().all(|value| value.is_finite()) {
        Ok((values, vectors))
    } else {
        Err(FecmError::EigenNotConverged { what, size: n })
    }
}

/// A dense symmetric positive definite matrix, factored.
pub struct DenseCholesky {
    factor: Mat<f64>,
}

impl DenseCholesky {
    /// Factors `a`, reading its lower triangle.
    ///
    /// # Errors
    /// [`FecmError::NotPositiveDefinite`] with `what` when a pivot is not positive.
    pub fn new(mut a: Mat<f64>, what: &'static str) -> Result<Self, FecmError> {
        let n = a.nrows();
        let params = Default::default();
        let mut memory =
            MemBuffer::new(faer::linalg::cholesky::llt::factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, params));
        faer::linalg::cholesky::llt::factor::cholesky_in_place(
            a.as_mut(),
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            params,
        )
        .map_err(|_| FecmError::NotPositiveDefinite { what, size: n })?;
        Ok(Self { factor: a })
    }

    /// Solves in place for every column of `rhs`.
    pub fn solve_in_place(&self, rhs: MatMut<'_, f64>) {
        let n = self.factor.nrows();
        let mut memory =
            MemBuffer::new(faer::linalg::cholesky::llt::solve::solve_in_place_scratch::<f64>(n, rhs.ncols(), Par::Seq));
        faer::linalg::cholesky::llt::solve::solve_in_place(
            self.factor.as_ref(),
            rhs,
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }

    /// The inverse, symmetric to rounding.
    #[must_use]
    pub fn inverse(&self) -> Mat<f64> {
        let n = self.factor.nrows();
        let mut inverse = Mat::identity(n, n);
        self.solve_in_place(inverse.as_mut());
        symmetrise(&mut inverse);
        inverse
    }
}

/// Symmetric sparse matrix of dense `block x block` blocks on the edges of a node graph, lower triangle stored.
pub struct BlockMatrix {
    /// Degrees of freedom per node.
    block: usize,
    /// For each node column, the sorted neighbour rows `>= column`.
    neighbours: Vec<Vec<u32>>,
    /// For each node column, blocks in the order of `neighbours`, each column-major.
    values: Vec<Vec<f64>>,
}

impl BlockMatrix {
    /// An all-zero matrix whose graph joins the nodes of each element; `u32::MAX` marks a node left out.
    #[must_use]
    pub fn from_elements<'a>(node_count: usize, block: usize, elements: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); node_count];
        for element in elements {
            for &column in element.iter().filter(|&&n| n != u32::MAX) {
                let rows = element.iter().filter(|&&n| n != u32::MAX && n >= column);
                neighbours[column as usize].extend(rows);
            }
        }
        let mut values = Vec::with_capacity(node_count);
        for rows in &mut neighbours {
            rows.sort_unstable();
            rows.dedup();
            values.push(vec![0.0; rows.len() * block * block]);
        }
        Self { block, neighbours, values }
    }

    /// The block at node row `row` and node column `column` (`row >= column`), column-major, or `None` off the graph.
    pub fn block_mut(&mut self, row: u32, column: u32) -> Option<&mut [f64]> {
        let position = self.neighbours[column as usize].binary_search(&row).ok()?;
        let size = self.block * self.block;
        self.values[column as usize].get_mut(position * size..(position + 1) * size)
    }

    /// Factors the matrix.
    ///
    /// # Errors
    /// [`FecmError::NotPositiveDefinite`] when it is not, [`FecmError::OutOfMemory`] when the factor does not fit.
    pub fn cholesky(&self, what: &'static str) -> Result<BlockCholesky, FecmError> {
        let (nodes, block) = (self.neighbours.len(), self.block);
        let size = nodes * block;
        let oom = |_| FecmError::OutOfMemory { what, size };
        let order = self.node_order(what)?;
        let (mut forward, mut inverse) = (vec![0_usize; size], vec![0_usize; size]);
        for (new, &old) in order.iter().enumerate() {
            for k in 0..block {
                forward[new * block + k] = old * block + k;
                inverse[old * block + k] = new * block + k;
            }
        }
        let (column_starts, rows, values) = self.expand();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &column_starts, None, &rows);
        let matrix = SparseColMatRef::new(pattern, &values);
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, size)),
            CholeskySymbolicParams::default(),
        )
        .map_err(oom)?;
        let mut factor = vec![0.0; symbolic.len_val()];
        let params = Default::default();
        let mut memory = MemBuffer::try_new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, params))
            .map_err(|_| FecmError::OutOfMemory { what, size })?;
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                params,
            )
            .map_err(|_| FecmError::NotPositiveDefinite { what, size })?;
        Ok(BlockCholesky { symbolic, factor, size })
    }

    /// Fill-reducing order of the nodes: `order[new] = old`.
    fn node_order(&self, what: &'static str) -> Result<Vec<usize>, FecmError> {
        let nodes = self.neighbours.len();
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); nodes];
        for (column, rows) in self.neighbours.iter().enumerate() {
            for &row in rows.iter().filter(|&&r| r as usize != column) {
                columns[column].push(row as usize);
                columns[row as usize].push(column);
            }
        }
        let (mut starts, mut rows) = (vec![0_usize], Vec::new());
        for column in &mut columns {
            column.sort_unstable();
            rows.extend_from_slice(column);
            starts.push(rows.len());
        }
        let pattern = SymbolicSparseColMatRef::new_checked(nodes, nodes, &starts, None, &rows);
        let (mut order, mut inverse) = (vec![0_usize; nodes], vec![0_usize; nodes]);
        let oom = FecmError::OutOfMemory { what, size: nodes };
        let Ok(mut memory) = MemBuffer::try_new(amd::order_scratch::<usize>(nodes, rows.len())) else {
            return Err(oom);
        };
        amd::order(&mut order, &mut inverse, pattern, amd::Control::default(), MemStack::new(&mut memory))
            .map_err(|_| oom)?;
        Ok(order)
    }

    /// Compressed columns of the lower triangle.
    fn expand(&self) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let block = self.block;
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for (column, neighbours) in self.neighbours.iter().enumerate() {
            for c in 0..block {
                for (slot, &row) in neighbours.iter().enumerate() {
                    let first = if row as usize == column { c } else { 0 };
                    let base = slot * block * block + c * block;
                    rows.extend((first..block).map(|r| row as usize * block + r));
                    values.extend_from_slice(&self.values[column][base + first..base + block]);
                }
                starts.push(rows.len());
            }
        }
        (starts, rows, values)
    }
}

/// Sparse Cholesky factor of a [`BlockMatrix`].
pub struct BlockCholesky {
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    size: usize,
}

/// Right-hand sides solved together.
const PANEL: usize = 64;

impl BlockCholesky {
    /// Solves in place for every column of `rhs`: panels of columns in parallel, the same panels on any number of threads.
    pub fn solve_in_place(&self, rhs: MatMut<'_, f64>) {
        if rhs.ncols() <= PANEL {
            return self.solve_panel(rhs);
        }
        let half = rhs.ncols().div_ceil(2 * PANEL) * PANEL;
        let (left, right) = rhs.split_at_col_mut(half);
        rayon::join(|| self.solve_in_place(left), || self.solve_in_place(right));
    }

    fn solve_panel(&self, rhs: MatMut<'_, f64>) {
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(rhs.ncols(), Par::Seq));
        LltRef::<'_, usize, f64>::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            rhs,
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }

    /// Number of unknowns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// Stored entries of the factor.
    #[must_use]
    pub fn factor_entries(&self) -> usize {
        self.factor.len()
    }
}
