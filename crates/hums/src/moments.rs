//! Mean and central moments up to order eight in one streaming pass.
//!
//! Problem. FM4, M6A and M8A are ratios of central moments of order 4, 6 and 8 to powers of the
//! variance. Power sums about zero cancel catastrophically when a record has an offset, and a
//! second pass over a file of gigabytes costs as much as reading it.
//!
//! Method. The record is cut into blocks of [`BLOCK`] samples. In a block (resident in the first
//! cache level) the mean is found first, then the power sums
//! `P_p = sum (x_i - c)^p`, `p = 1..8`, about that mean `c`. Two sets of sums about `c_a` and `c_b`
//! are joined by shifting both to the common mean `m` with the binomial identity
//! `sum (x_i - m)^p = sum_k C(p, k) (c - m)^(p-k) P_k`, `P_0 = n`
//! (for orders up to four: Chan, Golub and LeVeque 1983; any order: Pebay 2008, Sandia report
//! SAND2008-6212). Block boundaries depend on the sample count only, so the result does not depend
//! on how a record is handed over.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | n | `count` | - |
//! | m | `mean` | unit of the signal |
//! | P_p | `sums[p]` | unit^p |
//!
//! Very large or small signals (peak outside 2^-60 to 2^60) are scaled by a power of two, which is
//! exact, so that the eighth power neither overflows nor vanishes.
//! Verified by `tests/indicators.rs` (exact values, `scipy.stats`) and `tests/extremes.rs`.

use crate::error::{HumsError, Result, finite_or_out_of_range};

/// Samples per block.
pub const BLOCK: usize = 2048;
const LANES: usize = 4;
const ORDERS: usize = 9;

const BINOMIAL: [[f64; ORDERS]; ORDERS] = [
    [1., 0., 0., 0., 0., 0., 0., 0., 0.],
    [1., 1., 0., 0., 0., 0., 0., 0., 0.],
    [1., 2., 1., 0., 0., 0., 0., 0., 0.],
    [1., 3., 3., 1., 0., 0., 0., 0., 0.],
    [1., 4., 6., 4., 1., 0., 0., 0., 0.],
    [1., 5., 10., 10., 5., 1., 0., 0., 0.],
    [1., 6., 15., 20., 15., 6., 1., 0., 0.],
    [1., 7., 21., 35., 35., 21., 7., 1., 0.],
    [1., 8., 28., 56., 70., 56., 28., 8., 1.],
];

/// Count, mean, extremes and central moments of a signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    count: u64,
    /// Power of two the samples were multiplied by.
    scale: f64,
    /// Mean of the scaled samples.
    mean: f64,
    /// `sums[p]` = sum of (scaled sample - mean)^p; `sums[0]` = count, `sums[1]` ~ 0.
    sums: [f64; ORDERS],
    /// Extremes of the unscaled samples.
    min: f64,
    max: f64,
}

impl Moments {
    /// Moments of a whole signal.
    ///
    /// # Errors
    /// [`HumsError::TooShort`] for an empty signal, [`HumsError::NotFinite`] for NaN or infinity.
    pub fn of(signal: &[f64]) -> Result<Self> {
        let mut accumulator = MomentAccumulator::with_peak(peak(signal));
        accumulator.push(signal)?;
        accumulator.finish()
    }

    /// Number of samples.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Arithmetic mean, unit of the signal.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean / self.scale
    }

    /// Smallest sample.
    #[must_use]
    pub fn min(&self) -> f64 {
        self.min
    }

    /// Largest sample.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.max
    }

    /// Largest absolute sample.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.max.max(-self.min)
    }

    /// Population variance, unit^2 (`1/N`, as in D A.3; not `1/(N-1)`).
    ///
    /// # Errors
    /// [`HumsError::OutOfRange`] when it leaves the range of `f64`.
    pub fn variance(&self) -> Result<f64> {
        finite_or_out_of_range("variance", self.central(2) / self.scale / self.scale)
    }

    /// Population standard deviation, unit of the signal.
    #[must_use]
    pub fn standard_deviation(&self) -> f64 {
        self.central(2).sqrt() / self.scale
    }

    /// Root mean square `sqrt(1/N sum x_i^2)` (D 4.1, D A.1), unit of the signal.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.mean * self.mean + self.central(2)).sqrt() / self.scale
    }

    /// Standardised central moment `1/N sum (x - m)^p / sigma^p` of order `p` in 2..=8. Order 3 is
    /// the skewness, 4 the kurtosis (FM4 on a difference signal, D 4.2), 6 is M6A, 8 is M8A (D 4.3).
    ///
    /// # Errors
    /// [`HumsError::Undefined`] for a signal that is constant to rounding,
    /// [`HumsError::Parameter`] for another order.
    pub fn standardized(&self, order: usize) -> Result<f64> {
        if !(2..ORDERS).contains(&order) {
            return Err(HumsError::Parameter { parameter: "moment order", value: order as f64, allowed: "2 to 8" });
        }
        if self.is_constant() {
            return Err(HumsError::Undefined {
                what: "standardised moment",
                reason: "the signal is constant, its variance is zero",
            });
        }
        let sigma_2 = self.central(2);
        let power = sigma_2.powi((order / 2) as i32) * if order % 2 == 1 { sigma_2.sqrt() } else { 1.0 };
        finite_or_out_of_range("standardised moment", self.central(order) / power)
    }

    /// No deviation from the mean beyond rounding of the samples: standard deviation at most four
    /// units in the last place of the peak.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.min >= self.max || self.central(2).sqrt() <= 4.0 * f64::EPSILON * self.peak() * self.scale
    }

    fn central(&self, order: usize) -> f64 {
        self.sums[order] / self.count as f64
    }

    fn empty(scale: f64) -> Self {
        Self { count: 0, scale, mean: 0.0, sums: [0.0; ORDERS], min: f64::INFINITY, max: f64::NEG_INFINITY }
    }

    /// Joins the sums of a block (already scaled) into `self`.
    fn join(&mut self, block: &BlockSums) {
        let (n_a, n_b) = (self.count as f64, block.sums[0]);
        // Mean of the block, corrected by the residual first-order sum about `centre`.
        let mean_b = block.centre + block.sums[1] / n_b;
        let mean = if self.count == 0 { mean_b } else { self.mean + (mean_b - self.mean) * (n_b / (n_a + n_b)) };
        let b = shifted(&block.sums, block.centre - mean);
        if self.count == 0 {
            self.sums = b;
        } else {
            self.sums = shifted(&self.sums, self.mean - mean);
            for (total, part) in self.sums.iter_mut().zip(b) {
                *total += part;
            }
        }
        self.mean = mean;
        self.count += n_b as u64;
        self.min = self.min.min(block.min);
        self.max = self.max.max(block.max);
    }
}

/// Largest absolute value, NaN ignored, 0 for an empty slice.
pub(crate) fn peak(signal: &[f64]) -> f64 {
    let mut lanes = [0.0_f64; LANES];
    let mut chunks = signal.chunks_exact(LANES);
    for chunk in &mut chunks {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            let a = x.abs();
            *lane = if a > *lane { a } else { *lane };
        }
    }
    let rest = chunks.remainder().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    lanes.iter().fold(rest, |m, x| m.max(*x))
}

fn shifted(sums: &[f64; ORDERS], shift: f64) -> [f64; ORDERS] {
    let mut power = [1.0; ORDERS];
    for p in 1..ORDERS {
        power[p] = power[p - 1] * shift;
    }
    std::array::from_fn(|p| (0..=p).map(|k| BINOMIAL[p][k] * power[p - k] * sums[k]).sum())
}

struct BlockSums {
    centre: f64,
    sums: [f64; ORDERS],
    min: f64,
    max: f64,
}

fn lane_sum(lanes: [f64; LANES]) -> f64 {
    (lanes[0] + lanes[2]) + (lanes[1] + lanes[3])
}

/// Power sums of at most [`BLOCK`] finite samples about their mean. `Err(())` when the sum is not
/// finite, which after scaling means that a sample is not.
fn block_sums(block: &[f64], scale: f64) -> std::result::Result<BlockSums, ()> {
    let mut sum = [0.0; LANES];
    let mut low = [f64::INFINITY; LANES];
    let mut high = [f64::NEG_INFINITY; LANES];
    let mut chunks = block.chunks_exact(LANES);
    for chunk in &mut chunks {
        for j in 0..LANES {
            let x = chunk[j];
            sum[j] += x * scale;
            low[j] = if x < low[j] { x } else { low[j] };
            high[j] = if x > high[j] { x } else { high[j] };
        }
    }
    for (j, &x) in chunks.remainder().iter().enumerate() {
        sum[j] += x * scale;
        low[j] = low[j].min(x);
        high[j] = high[j].max(x);
    }
    let total = lane_sum(sum);
    if !total.is_finite() {
        return Err(());
    }
    let n = block.len() as f64;
    let centre = total / n;

    let mut odd = [[0.0; LANES]; 4];
    let mut even = [[0.0; LANES]; 4];
    let mut add = |j: usize, x: f64| {
        let d = x * scale - centre;
        let d2 = d * d;
        let d3 = d2 * d;
        let d4 = d2 * d2;
        odd[0][j] += d;
        even[0][j] += d2;
        odd[1][j] += d3;
        even[1][j] += d4;
        odd[2][j] += d4 * d;
        even[2][j] += d4 * d2;
        odd[3][j] += d4 * d3;
        even[3][j] += d4 * d4;
    };
    let mut chunks = block.chunks_exact(LANES);
    for chunk in &mut chunks {
        for j in 0..LANES {
            add(j, chunk[j]);
        }
    }
    for (j, &x) in chunks.remainder().iter().enumerate() {
        add(j, x);
    }
    let mut sums = [n; ORDERS];
    for k in 0..4 {
        sums[2 * k + 1] = lane_sum(odd[k]);
        sums[2 * k + 2] = lane_sum(even[k]);
    }
    Ok(BlockSums {
        centre,
        sums,
        min: low.iter().copied().fold(f64::INFINITY, f64::min),
        max: high.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    })
}

/// Streaming moments: push slices of any size, then finish. The same samples give the same bits
/// however they are cut into slices.
#[derive(Debug, Clone)]
pub struct MomentAccumulator {
    total: Moments,
    pending: Vec<f64>,
}

impl Default for MomentAccumulator {
    fn default() -> Self {
        Self::with_peak(1.0)
    }
}

impl MomentAccumulator {
    /// For samples whose absolute values are of the order of `peak` (unit of the signal) at most;
    /// only its binary order of magnitude matters, and only outside 2^-60 to 2^60.
    #[must_use]
    pub fn with_peak(peak: f64) -> Self {
        let exponent = if peak.is_finite() && peak > 0.0 { peak.log2().floor() } else { 0.0 };
        let scale = if exponent.abs() > 60.0 { (-exponent).clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
        Self { total: Moments::empty(scale), pending: Vec::new() }
    }

    /// Adds samples.
    ///
    /// # Errors
    /// [`HumsError::NotFinite`] with the index counted from the first sample ever pushed. The
    /// accumulator is not usable afterwards.
    pub fn push(&mut self, mut samples: &[f64]) -> Result<()> {
        if !self.pending.is_empty() {
            let take = samples.len().min(BLOCK - self.pending.len());
            self.pending.extend_from_slice(&samples[..take]);
            samples = &samples[take..];
            if self.pending.len() < BLOCK {
                return Ok(());
            }
            let block = std::mem::take(&mut self.pending);
            self.absorb(&block)?;
            self.pending = block;
            self.pending.clear();
        }
        let whole = samples.len() - samples.len() % BLOCK;
        for block in samples[..whole].chunks_exact(BLOCK) {
            self.absorb(block)?;
        }
        self.pending.extend_from_slice(&samples[whole..]);
        Ok(())
    }

    /// Samples pushed so far.
    #[must_use]
    pub fn count(&self) -> usize {
        self.total.count as usize + self.pending.len()
    }

    /// Moments of everything pushed.
    ///
    /// # Errors
    /// [`HumsError::TooShort`] when nothing was pushed; [`HumsError::NotFinite`] as in `push`.
    pub fn finish(mut self) -> Result<Moments> {
        if !self.pending.is_empty() {
            let block = std::mem::take(&mut self.pending);
            self.absorb(&block)?;
        }
        if self.total.count == 0 {
            return Err(HumsError::TooShort { what: "moments", needed: 1, found: 0 });
        }
        if self.total.sums.iter().all(|s| s.is_finite()) {
            Ok(self.total)
        } else {
            Err(HumsError::OutOfRange { what: "moments" })
        }
    }

    fn absorb(&mut self, block: &[f64]) -> Result<()> {
        match block_sums(block, self.total.scale) {
            Ok(sums) => {
                self.total.join(&sums);
                Ok(())
            }
            Err(()) => match block.iter().position(|x| !x.is_finite()) {
                Some(k) => {
                    Err(HumsError::NotFinite { what: "moments", index: self.total.count as usize + k, value: block[k] })
                }
                None => Err(HumsError::OutOfRange { what: "moments" }),
            },
        }
    }
}
