//! The contact grid of one position and its compliance.
//!
//! Each tooth pair that can touch gets rows of cells across the expected contact, uniform in arc length along the master flank, times the
//! cells along the face. The compliance of all cells is
//!
//! `C = sum over bodies of Psi R Psi^T + G_half-space`,
//!
//! with `Psi` the functions along the face at the cells, `R` what the finite elements add to the half-space, between stations
//! ([`crate::body`]), and the near field of [`crate::nearfield`]. It is symmetric by construction.

use faer::{Mat, MatRef};

use crate::body::{GearBody, Station};
use crate::linalg::{add_block, add_product, column_slice, column_slice_mut};
use crate::nearfield::{FaceCells, NearField};
use crate::search::{Member, NoCell, OpposedPoints, PlacedPair};

/// Rows of cells on one tooth pair.
#[derive(Debug, Clone)]
pub struct PairGrid {
    /// Tooth-pair number.
    pub pair: i32,
    /// Geometry of the pair.
    pub placed: PlacedPair,
    /// Index of the first row: row `k` lies `k * cell` from the foot.
    pub first_row: i32,
    /// Rows, toward increasing radius on the master.
    pub rows: Vec<OpposedPoints>,
    /// Separation of every cell with flank modifications: `[row][face cell]` (m).
    pub gaps: Vec<Vec<f64>>,
    /// What ended the grid below and above, if not its span.
    pub limits: [Option<NoCell>; 2],
}

/// All cells of one position.
#[derive(Debug, Clone)]
pub struct ContactGrid {
    /// Pairs with cells.
    pub pairs: Vec<PairGrid>,
    /// Size of a cell along the profile (m).
    pub cell: f64,
    /// Cells along the face.
    pub face: FaceCells,
}

impl PairGrid {
    /// Lays rows around `centre` (arc length from the foot, m) to `reach` rows on either side.
    pub fn new(
        pair: i32,
        placed: PlacedPair,
        cell: f64,
        centre: f64,
        reach: i32,
        face: &FaceCells,
        material_removed: &impl Fn(&OpposedPoints, f64) -> f64,
    ) -> Self {
        let middle = (centre / cell).round() as i32;
        let at = |row: i32| placed.opposed(f64::from(row) * cell);
        // walk from the first row that exists: the middle may lie off the end of a tooth
        let start = (0..=reach).flat_map(|k| [middle + k, middle - k]).find(|&row| at(row).is_ok());
        let mut limits = [None, None];
        let mut rows = Vec::new();
        let mut first_row = middle;
        if let Some(start) = start {
            for row in (middle - reach..start).rev() {
                match at(row) {
                    Ok(points) => rows.push(points),
                    Err(reason) => {
                        limits[0] = Some(reason);
                        break;
                    }
                }
            }
            rows.reverse();
            first_row = start - rows.len() as i32;
            for row in start..=middle + reach {
                match at(row) {
                    Ok(points) => rows.push(points),
                    Err(reason) => {
                        limits[1] = Some(reason);
                        break;
                    }
                }
            }
        }
        let gaps = rows
            .iter()
            .map(|row| face.centres.iter().map(|&z| row.separation + material_removed(row, z)).collect())
            .collect();
        Self { pair, placed, first_row, rows, gaps, limits }
    }

    /// Arc length of a row from the foot (m).
    #[must_use]
    pub fn row_offset(&self, row: usize, cell: f64) -> f64 {
        f64::from(self.first_row + row as i32) * cell
    }

    /// Whether the pinion is master.
    #[must_use]
    pub fn pinion_is_master(&self) -> bool {
        self.placed.master == Member::Pinion
    }
}

impl ContactGrid {
    /// Whether the cells are those of another grid, row by row; their gaps may differ.
    #[must_use]
    pub fn has_the_cells_of(&self, other: &Self) -> bool {
        let rows = |pair: &PairGrid| (pair.pair, pair.first_row, pair.rows.len(), pair.pinion_is_master());
        self.cell == other.cell
            && self.face == other.face
            && self.pairs.iter().map(rows).eq(other.pairs.iter().map(rows))
    }

    /// Number of cells.
    #[must_use]
    pub fn size(&self) -> usize {
        self.pairs.iter().map(|pair| pair.rows.len()).sum::<usize>() * self.face.centres.len()
    }

    /// Gaps of all cells (m): pair by pair, row by row, along the face.
    #[must_use]
    pub fn gaps(&self) -> Vec<f64> {
        self.pairs.iter().flat_map(|pair| pair.gaps.iter().flatten().copied()).collect()
    }

    /// Lever arms about the wheel's axis of all cells (m).
    #[must_use]
    pub fn wheel_arms(&self) -> Vec<f64> {
        let count = self.face.centres.len();
        let rows = self.pairs.iter().flat_map(|pair| &pair.rows);
        rows.flat_map(|row| std::iter::repeat_n(row.wheel_arm, count)).collect()
    }

    /// Largest number of rows of a pair.
    #[must_use]
    pub fn most_rows(&self) -> usize {
        self.pairs.iter().map(|pair| pair.rows.len()).max().unwrap_or(0)
    }

    /// Compliance between all cells (m/N), symmetric. `tooth_step` says how a pair's tooth number on each body advances with the pair
    /// number, in the direction of increasing angle of the body's own frame.
    #[must_use]
    pub fn compliance(&self, bodies: [&GearBody; 2], tooth_step: [i32; 2], near: &NearField) -> Mat<f64> {
        let count = self.face.centres.len();
        let mut total = Mat::zeros(self.size(), self.size());
        let starts = self.starts();
        let mut stations = Vec::new();
        // functions along the face of both bodies and all families side by side, at the cells
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); count];
        for (index, body) in bodies.iter().enumerate() {
            stations.push(self.stations(body, index, tooth_step[index]));
            for family in &body.families {
                for (values, &z) in values.iter_mut().zip(&self.face.centres) {
                    values.extend(family.basis.plane_values(z));
                }
            }
        }
        let psi = Mat::from_fn(count, values.first().map_or(0, Vec::len), |j, k| values[j][k]);
        for (i, observed) in self.pairs.iter().enumerate() {
            for (j, loaded) in self.pairs.iter().enumerate().skip(i) {
                let mut modal = Vec::new();
                for (index, body) in bodies.iter().enumerate() {
                    let at = |k: usize, pair: &PairGrid| (pair.pair * tooth_step[index], stations[index][k].as_slice());
                    for (family_index, family) in body.families.iter().enumerate() {
                        let functions = family.basis.plane_degrees().len();
                        modal.push((functions, body.remainder(family_index, at(i, observed), at(j, loaded))));
                    }
                }
                add_expanded(&mut total, [starts[i] * count, starts[j] * count], &modal, psi.as_ref(), i == j);
            }
        }
        self.add_surface(&mut total, &starts, near);
        mirror_upper(&mut total);
        total
    }

    /// First row of each pair in the list of all rows.
    fn starts(&self) -> Vec<usize> {
        self.pairs
            .iter()
            .scan(0, |sum, pair| {
                let start = *sum;
                *sum += pair.rows.len();
                Some(start)
            })
            .collect()
    }

    fn stations(&self, body: &GearBody, index: usize, tooth_step: i32) -> Vec<Vec<Station>> {
        let of_pair = |pair: &PairGrid| {
            let roll = |row: &OpposedPoints| if index == 0 { row.pinion_roll } else { row.wheel_roll };
            let sector = body.sector(pair.pair * tooth_step);
            pair.rows.iter().map(|row| sector.station(roll(row))).collect()
        };
        self.pairs.iter().map(of_pair).collect()
    }

    fn add_surface(&self, total: &mut Mat<f64>, starts: &[usize], near: &NearField) {
        let count = self.face.centres.len();
        for (pair, &start) in self.pairs.iter().zip(starts) {
            for i in 0..pair.rows.len() {
                for j in i..pair.rows.len() {
                    add_block(total, (start + i) * count, (start + j) * count, 1.0, near.surface(j - i));
                }
            }
        }
    }
}

/// Adds the sum of `(I x Psi_m) modal_m (I x Psi_m)^T`, functions along the face turned into cells, at `at`; of a diagonal block only what
/// lies on or above the diagonal, row by row of cells. `psi` has the `Psi_m` side by side; `modal` says how many functions each has.
fn add_expanded(
    total: &mut Mat<f64>,
    at: [usize; 2],
    modal: &[(usize, Mat<f64>)],
    psi: MatRef<'_, f64>,
    is_diagonal: bool,
) {
    let (count, all) = (psi.nrows(), psi.ncols());
    let Some((functions, first)) = modal.first() else { return };
    let (rows, columns) = (first.nrows() / functions, first.ncols() / functions);
    // column `j * all + k`: cells by function `k` of column `j`
    let mut half = Mat::zeros(rows * count, columns * all);
    let mut offset = 0;
    for (functions, modal) in modal {
        let own = psi.submatrix(0, offset, count, *functions);
        for j in 0..columns {
            for i in 0..rows {
                let source = modal.as_ref().submatrix(i * functions, j * functions, *functions, *functions);
                let target = half.as_mut().submatrix_mut(i * count, j * all + offset, count, *functions);
                add_product(target, 1.0, own, source);
            }
        }
        offset += functions;
    }
    for j in 0..columns {
        let height = if is_diagonal { (j + 1) * count } else { rows * count };
        let source = half.as_ref().submatrix(0, j * all, height, all);
        let target = total.as_mut().submatrix_mut(at[0], at[1] + j * count, height, count);
        add_product(target, 1.0, source, psi.transpose());
    }
}

/// Copies the upper triangle to the lower, tile by tile so that both stay in cache.
fn mirror_upper(matrix: &mut Mat<f64>) {
    const TILE: usize = 32;
    let n = matrix.nrows();
    let mut tile = [0.0; TILE * TILE];
    for left in (0..n).step_by(TILE) {
        let width = TILE.min(n - left);
        for top in (0..=left).step_by(TILE) {
            let height = TILE.min(n - top);
            for j in 0..width {
                let column = &column_slice(matrix, left + j)[top..top + height];
                for (i, value) in column.iter().enumerate() {
                    tile[i * TILE + j] = *value;
                }
            }
            for i in 0..height {
                // row `top + i` of the upper triangle is column `top + i` of the lower
                let first = if top == left { i + 1 } else { 0 };
                let target = column_slice_mut(matrix, top + i);
                if first < width {
                    target[left + first..left + width].copy_from_slice(&tile[i * TILE + first..i * TILE + width]);
                }
            }
        }
    }
}
