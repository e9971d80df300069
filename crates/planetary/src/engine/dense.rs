//! Small dense matrices: elimination without pivoting, for matrices whose symmetric part is positive definite and large against the rest, and with.

/// A matrix, column by column.
#[derive(Debug, Clone, Default)]
pub(super) struct Matrix {
    pub rows: usize,
    pub columns: usize,
    pub values: Vec<f64>,
}

impl Matrix {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    pub fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.rows..(j + 1) * self.rows]
    }

    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.rows..(j + 1) * self.rows]
    }

    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.values[j * self.rows + i]
    }

    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.values[j * self.rows + i]
    }

    /// `y += factor * self * x`.
    pub fn add_times(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for (j, x) in x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            axpy(y, factor * x, self.column(j));
        }
    }

    /// The product with another.
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::zeros(self.rows, other.columns);
        for j in 0..other.columns {
            self.add_times(1.0, other.column(j), product.column_mut(j));
        }
        product
    }

    /// `P L U` of a square matrix, rows exchanged. None where a pivot is less than `threshold` of the largest entry that its column had, or no number.
    pub fn factor(mut self, threshold: f64) -> Option<Factors> {
        let n = self.rows;
        let largest = |column: &[f64]| column.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let sizes: Vec<f64> = (0..n).map(|k| largest(self.column(k))).collect();
        let mut exchanges = Vec::with_capacity(n);
        for k in 0..n {
            let below = &self.column(k)[k..];
            let place =
                below.iter().enumerate().fold(0, |best, (i, x)| if x.abs() > below[best].abs() { i } else { best });
            let pivot = below[place];
            if !(pivot.abs() > threshold * sizes[k] && pivot.is_finite()) {
                return None;
            }
            exchanges.push(k + place);
            if place > 0 {
                self.values.chunks_exact_mut(n).for_each(|column| column.swap(k, k + place));
            }
            let (left, right) = self.values.split_at_mut((k + 1) * n);
            let below = &mut left[k * n + k + 1..];
            below.iter_mut().for_each(|x| *x /= pivot);
            for column in right.chunks_exact_mut(n) {
                let factor = column[k];
                if factor != 0.0 {
                    axpy(&mut column[k + 1..], -factor, below);
                }
            }
        }
        Some(Factors { matrix: self, exchanges })
    }
}

/// Factors of a square matrix.
#[derive(Debug, Clone, Default)]
pub(super) struct Factors {
    matrix: Matrix,
    exchanges: Vec<usize>,
}

impl Factors {
    /// Solves in place.
    pub fn solve(&self, x: &mut [f64]) {
        let n = self.matrix.rows;
        for (k, &place) in self.exchanges.iter().enumerate() {
            x.swap(k, place);
        }
        for k in 0..n {
            let value = x[k];
            if value != 0.0 {
                axpy(&mut x[k + 1..n], -value, &self.matrix.column(k)[k + 1..]);
            }
        }
        for k in (0..n).rev() {
            x[k] /= self.matrix.at(k, k);
            let value = x[k];
            axpy(&mut x[..k], -value, &self.matrix.column(k)[..k]);
        }
    }

    /// The inverse.
    pub fn inverse(&self) -> Matrix {
        let n = self.matrix.rows;
        let mut inverse = Matrix::zeros(n, n);
        for k in 0..n {
            *inverse.at_mut(k, k) = 1.0;
            self.solve(inverse.column_mut(k));
        }
        inverse
    }
}

/// `y += factor * x`.
pub(super) fn axpy(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// A square matrix, column by column.
#[derive(Debug, Clone, Default)]
pub(super) struct Square {
    pub size: usize,
    pub values: Vec<f64>,
}

impl Square {
    pub fn zeros(size: usize) -> Self {
        Self { size, values: vec![0.0; size * size] }
    }

    pub fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.size..(j + 1) * self.size]
    }

    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.size..(j + 1) * self.size]
    }

    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.values[j * self.size + i]
    }

    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.values[j * self.size + i]
    }

    /// `L U` in place, `L` of unit diagonal. False where a pivot is less than `threshold` of the diagonal entry it came from (not a number
    /// included).
    pub fn factor(&mut self, threshold: f64) -> bool {
        let n = self.size;
        let diagonal: Vec<f64> = (0..n).map(|k| self.at(k, k)).collect();
        for k in 0..n {
            let (left, right) = self.values.split_at_mut((k + 1) * n);
            let pivot_column = &mut left[k * n..];
            let pivot = pivot_column[k];
            if !(pivot > threshold * diagonal[k] && pivot.is_finite()) {
                return false;
            }
            let below = &mut pivot_column[k + 1..];
            below.iter_mut().for_each(|x| *x /= pivot);
            for column in right.chunks_exact_mut(n) {
                let factor = column[k];
                if factor != 0.0 {
                    axpy(&mut column[k + 1..], -factor, below);
                }
            }
        }
        true
    }

    /// Solves with the factors, in place.
    pub fn solve(&self, x: &mut [f64]) {
        let n = self.size;
        for k in 0..n {
            let value = x[k];
            if value != 0.0 {
                axpy(&mut x[k + 1..n], -value, &self.column(k)[k + 1..]);
            }
        }
        for k in (0..n).rev() {
            x[k] /= self.at(k, k);
            let value = x[k];
            axpy(&mut x[..k], -value, &self.column(k)[..k]);
        }
    }
}

/// Sum of products in eight lanes: always in the same order.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (chunks_a, chunks_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f64 = chunks_a.remainder().iter().zip(chunks_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in chunks_a.zip(chunks_b) {
        for lane in 0..8 {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (b + f)) + ((c + g) + (d + h)) + tail
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invariant_factors_solve_what_they_came_from() {
        let n = 11;
        let mut matrix = Square::zeros(n);
        for i in 0..n {
            for j in 0..n {
                *matrix.at_mut(i, j) = 1.0 / (1.0 + i as f64 + j as f64) + 0.01 * (i as f64 - j as f64);
            }
            *matrix.at_mut(i, i) += 0.5;
        }
        let exact: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let mut x: Vec<f64> = (0..n).map(|i| (0..n).map(|j| matrix.at(i, j) * exact[j]).sum()).collect();
        let mut factors = matrix.clone();
        assert!(factors.factor(1e-13));
        let mut other = x.clone();
        factors.solve(&mut x);
        // the same equations, the last row first, which needs exchanges
        let mut turned = Matrix { rows: n, columns: n, values: matrix.values.clone() };
        turned.values.chunks_exact_mut(n).for_each(|column| column.rotate_right(1));
        other.rotate_right(1);
        turned.factor(1e-13).unwrap().solve(&mut other);
        for ((x, other), exact) in x.iter().zip(&other).zip(&exact) {
            assert!((x - exact).abs() < 1e-12 && (other - exact).abs() < 1e-12, "{x} {other} {exact}");
        }
        for k in 0..n {
            let copy = matrix.column(0).to_vec();
            matrix.column_mut(3).copy_from_slice(&copy);
            *matrix.at_mut(3, k) = matrix.at(0, k);
        }
        *matrix.at_mut(3, 3) = matrix.at(0, 0);
        assert!(!matrix.factor(1e-13), "two equal rows and columns");
    }
}
