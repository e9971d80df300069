//! Solution of the small dense systems of shooting and continuation.

use crate::error::LpmError;

/// Solves `a x = b` by elimination with row pivoting; `a` in rows. At most seven unknowns here.
pub(crate) fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>, place: &'static str) -> Result<Vec<f64>, LpmError> {
    let n = b.len();
    let size = a.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    for col in 0..n {
        let pivot = (col..n).max_by(|&i, &j| a[i][col].abs().total_cmp(&a[j][col].abs())).unwrap_or(col);
        let p = a[pivot][col].abs();
        if !p.is_finite() || p <= 1e-14 * size {
            return Err(LpmError::Singular { place });
        }
        a.swap(col, pivot);
        b.swap(col, pivot);
        for row in col + 1..n {
            let f = a[row][col] / a[col][col];
            if f != 0.0 {
                let (top, bottom) = a.split_at_mut(row);
                for (x, y) in bottom[0][col..].iter_mut().zip(&top[col][col..]) {
                    *x -= f * y;
                }
                b[row] -= f * b[col];
            }
        }
    }
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|j| a[row][j] * b[j]).sum();
        b[row] = (b[row] - known) / a[row][row];
    }
    if b.iter().all(|v| v.is_finite()) { Ok(b) } else { Err(LpmError::Singular { place }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_small_systems() -> Result<(), LpmError> {
        let x =
            solve(vec![vec![0.0, 2.0, 1.0], vec![1.0, -1.0, 0.0], vec![3.0, 0.0, 4.0]], vec![7.0, -1.0, 15.0], "t")?;
        for (a, b) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((a - b).abs() < 1e-14);
        }
        assert!(solve(vec![vec![1.0, 2.0], vec![2.0, 4.0]], vec![1.0, 2.0], "t").is_err());
        assert!(solve(vec![vec![f64::NAN]], vec![1.0], "t").is_err());
        Ok(())
    }
}
