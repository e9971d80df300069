//! Time-synchronous averaging (TSA).
//!
//! Problem. What repeats with a shaft is buried in noise and in the vibration of other shafts.
//!
//! Method. The record is resampled to equal angles ([`crate::resample`]) and cut into blocks of one
//! averaging period: a turn of a shaft, a planet pass, a carrier turn, or several of them. The mean
//! over N blocks keeps every whole order and multiplies an order f (cycles per period) by the comb
//! filter's gain (McFadden 1987, Mech. Syst. Signal Process. 1:83)
//! `|H(f)| = |sin(pi N f) / (N sin(pi f))|`, [`comb_gain`]: zero at `f = k/N`, 1 at whole f. White
//! noise falls by sqrt N.
//!
//! Blocks begin at whole multiples of the period counted from turn 0 (the first pulse), so averages
//! of several recordings share their phase. A block that touches a gap (a non-finite sample) is left
//! out and counted; one that touches a hole of the tachometer ([`Shaft::holes`]) is left out.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | N | `blocks` | - |
//! | S | `samples_per_period` | - |
//! | - | `period_turns` | turns of the shaft given |
//!
//! [`Averager`] streams: memory is one period and its margins, whatever the record's length.
//! Verified by `tests/tsa.rs`.

use crate::error::{HumsError, Result, require_positive};
use crate::resample::{Interpolation, Resampler};
use crate::tachometer::Shaft;
use std::f64::consts::PI;
use std::sync::Arc;

/// What to average over.
#[derive(Debug, Clone, PartialEq)]
pub struct TsaOptions {
    /// Samples of the average, >= 2; see [`crate::resample::samples_per_period`].
    pub samples_per_period: usize,
    /// Length of the period in turns of the shaft, > 0.
    pub period_turns: f64,
    /// Blocks at most; `None`: all that fit.
    pub max_blocks: Option<usize>,
    /// How to interpolate.
    pub interpolation: Interpolation,
}

impl TsaOptions {
    /// One turn of the shaft, all blocks, band-limited interpolation.
    #[must_use]
    pub fn per_turn(samples_per_period: usize) -> Self {
        Self { samples_per_period, period_turns: 1.0, max_blocks: None, interpolation: Interpolation::default() }
    }
}

/// A synchronous average.
#[derive(Debug, Clone, PartialEq)]
pub struct Average {
    /// One period, unit of the signal.
    pub samples: Vec<f64>,
    /// Blocks averaged, N.
    pub blocks: usize,
    /// Blocks left out because of gaps.
    pub skipped: usize,
    /// Standard deviation between blocks at each sample (`1/(N-1)`), unit of the signal; zeros for N = 1.
    pub spread: Vec<f64>,
}

impl Average {
    /// Factor by which averaging lowers the RMS of white noise: sqrt N.
    #[must_use]
    pub fn noise_reduction(&self) -> f64 {
        (self.blocks as f64).sqrt()
    }

    /// RMS over the period of what the average removed, unit of the signal.
    #[must_use]
    pub fn removed_rms(&self) -> f64 {
        let sum: f64 = self.spread.iter().map(|s| s * s).sum();
        (sum / self.spread.len().max(1) as f64).sqrt()
    }

    /// RMS of the noise that the average still carries: [`Self::removed_rms`] over sqrt N.
    #[must_use]
    pub fn noise_floor(&self) -> f64 {
        self.removed_rms() / self.noise_reduction()
    }
}

/// Gain of the average over `blocks` periods for an order (cycles per period, any real number; 0 for
/// NaN and infinity).
#[must_use]
pub fn comb_gain(order: f64, blocks: usize) -> f64 {
    if !order.is_finite() {
        return 0.0;
    }
    let n = blocks.max(1) as f64;
    // Distance to the nearest whole order: exact, and the gain has period 1.
    let f = order - order.round();
    let below = (PI * f).sin();
    if below.abs() < 1e-12 {
        return 1.0;
    }
    ((PI * n * f).sin() / (n * below)).abs()
}

/// Averages a whole record sampled at `rate` (Hz).
///
/// # Errors
/// As [`Averager::new`] and [`Averager::finish`].
pub fn average(signal: &[f64], rate: f64, shaft: &Shaft, options: &TsaOptions) -> Result<Average> {
    let mut averager = Averager::new(rate, shaft.clone(), options.clone())?;
    averager.complete = true;
    averager.take_blocks(signal, 0);
    averager.sums.finish()
}

/// Averages consecutive whole periods of a signal that is already sampled at equal angles
/// (simulations), `per_period` samples each; a rest at the end is left out.
///
/// # Errors
/// [`HumsError::Undefined`] when there is not one whole period without gaps;
/// [`HumsError::Parameter`] for `per_period` = 0.
pub fn average_periods(signal: &[f64], per_period: usize, max_blocks: Option<usize>) -> Result<Average> {
    require_positive("samples per period", per_period as f64)?;
    let mut sums = Sums::default();
    for block in signal.chunks_exact(per_period).take(max_blocks.unwrap_or(usize::MAX)) {
        sums.add(block);
    }
    sums.finish()
}

/// Running mean and spread of blocks (Welford 1962); without memory until the first one.
#[derive(Debug, Clone, Default)]
struct Sums {
    mean: Vec<f64>,
    squares: Vec<f64>,
    blocks: usize,
    skipped: usize,
}

impl Sums {
    fn add(&mut self, block: &[f64]) {
        if !block.iter().all(|x| x.is_finite()) {
            self.skipped += 1;
            return;
        }
        self.mean.resize(block.len(), 0.0);
        self.squares.resize(block.len(), 0.0);
        self.blocks += 1;
        let weight = 1.0 / self.blocks as f64;
        for ((mean, square), x) in self.mean.iter_mut().zip(&mut self.squares).zip(block) {
            let step = x - *mean;
            *mean += step * weight;
            *square += step * (x - *mean);
        }
    }

    fn finish(self) -> Result<Average> {
        if self.blocks == 0 {
            return Err(HumsError::Undefined {
                what: "synchronous average",
                reason: if self.skipped > 0 {
                    "every period has a gap"
                } else {
                    "no whole period lies inside record and tachometer"
                },
            });
        }
        let divisor = (self.blocks.max(2) - 1) as f64;
        let spread = self.squares.iter().map(|s| (s / divisor).max(0.0).sqrt());
        Ok(Average { spread: spread.collect(), samples: self.mean, blocks: self.blocks, skipped: self.skipped })
    }
}

/// Streaming synchronous average.
#[derive(Debug, Clone)]
pub struct Averager {
    rate: f64,
    shaft: Arc<Shaft>,
    options: TsaOptions,
    resampler: Resampler,
    sums: Sums,
    /// Number of the next block (block b begins at turn b * period).
    next: f64,
    /// Samples not yet used up, and the record index of the first of them.
    buffer: Vec<f64>,
    offset: usize,
    /// No samples are to come.
    complete: bool,
    positions: Vec<f64>,
    block: Vec<f64>,
}

/// Where a block stands with respect to the samples at hand.
enum Place {
    /// Inside: first and one past the last sample needed.
    Ready(usize, usize),
    /// Needs samples before the first of the record, or touches a hole of the tachometer.
    Before,
    /// Needs samples to come.
    Later,
    /// The tachometer ends before the block does, or all blocks wanted are in.
    End,
}

impl Averager {
    /// Prepares for a record sampled at `rate` (Hz), whose sample 0 is at time 0 of the shaft.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for a rate or period that is not positive, fewer than two samples a
    /// period, or interpolation parameters out of range.
    pub fn new(rate: f64, shaft: impl Into<Arc<Shaft>>, options: TsaOptions) -> Result<Self> {
        let shaft = shaft.into();
        require_positive("sampling rate", rate)?;
        require_positive("averaging period", options.period_turns)?;
        if !(2..=crate::resample::MAX_PER_PERIOD).contains(&options.samples_per_period) {
            return Err(HumsError::Parameter {
                parameter: "samples per averaging period",
                value: options.samples_per_period as f64,
                allowed: "2 to 2^26",
            });
        }
        // Also bounds the number of blocks by that of samples.
        let shortest = rate * options.period_turns / shaft.speed_range().1;
        if !(shortest >= 2.0) {
            return Err(HumsError::Parameter {
                parameter: "averaging period in samples of the record",
                value: shortest,
                allowed: "at least 2 at the fastest speed",
            });
        }
        // The first whole period after sample 0; pulses may come before it.
        let (first_turn, last_turn) = shaft.turn_range();
        let start = if shaft.time_range().0 >= 0.0 { first_turn } else { shaft.turn_at(0.0).unwrap_or(last_turn) };
        let next = (start / options.period_turns - 1e-9).ceil();
        // Whole numbers stay exact as blocks are counted on.
        if !(next.abs() < 1e15) {
            return Err(HumsError::Parameter {
                parameter: "averaging period",
                value: options.period_turns,
                allowed: "above 1e-15 of the turns before the record",
            });
        }
        Ok(Self {
            rate,
            shaft,
            resampler: Resampler::new(options.interpolation)?,
            sums: Sums::default(),
            next,
            buffer: Vec::new(),
            offset: 0,
            complete: false,
            positions: Vec::new(),
            block: Vec::new(),
            options,
        })
    }

    /// Takes the next samples of the record. The average has the same bits however a record is cut
    /// into pushes.
    pub fn push(&mut self, samples: &[f64]) {
        let mut buffer = std::mem::take(&mut self.buffer);
        buffer.extend_from_slice(samples);
        let used = self.take_blocks(&buffer, self.offset);
        let drop = used.saturating_sub(self.offset).min(buffer.len());
        buffer.drain(..drop);
        self.offset += drop;
        self.buffer = buffer;
    }

    /// The average of everything pushed.
    ///
    /// # Errors
    /// [`HumsError::Undefined`] when no period without gaps lies inside record and tachometer.
    pub fn finish(mut self) -> Result<Average> {
        self.complete = true;
        let buffer = std::mem::take(&mut self.buffer);
        self.take_blocks(&buffer, self.offset);
        self.sums.finish()
    }

    /// Averages every block inside `samples`, the first of which has record index `offset`. Returns
    /// the record index before which no sample is needed any more.
    fn take_blocks(&mut self, samples: &[f64], offset: usize) -> usize {
        loop {
            match self.place(offset, samples.len()) {
                Place::Ready(from, to) => {
                    let part = &samples[from - offset..to - offset];
                    if part.iter().all(|x| x.is_finite()) {
                        self.positions.iter_mut().for_each(|p| *p -= from as f64);
                        self.block.clear();
                        self.resampler.evaluate(part, &self.positions, &mut self.block);
                        self.sums.add(&self.block);
                    } else {
                        self.sums.skipped += 1;
                    }
                    self.next += 1.0;
                }
                Place::Before => self.next += 1.0,
                Place::Later => {
                    let first = self.positions.first().copied().unwrap_or(0.0);
                    let margin = self.resampler.margin(self.step());
                    return (first.max(0.0) as usize).saturating_sub(margin);
                }
                Place::End => return usize::MAX,
            }
        }
    }

    /// Mean distance of the current block's positions, samples.
    fn step(&self) -> f64 {
        match self.positions[..] {
            [first, .., last] => (last - first) / (self.positions.len() - 1) as f64,
            _ => 1.0,
        }
    }

    /// Computes the next block's positions and compares them with the samples at hand.
    fn place(&mut self, offset: usize, available: usize) -> Place {
        let wanted = self.options.max_blocks.unwrap_or(usize::MAX);
        let period = self.options.period_turns;
        let count = self.options.samples_per_period;
        let first_turn = self.next * period;
        // The last sample of a block is one step before its end.
        let step_turns = period / count as f64;
        let last_turn = first_turn + (count - 1) as f64 * step_turns;
        if self.sums.blocks >= wanted || last_turn > self.shaft.turn_range().1 + 1e-9 * period {
            return Place::End;
        }
        if let Some(end) = self.shaft.hole_end(first_turn, last_turn + step_turns) {
            self.next = (end / period - 1e-9).ceil().max(self.next + 1.0) - 1.0;
            return Place::Before;
        }
        self.positions.clear();
        self.shaft.times_of(first_turn, step_turns, count, &mut self.positions);
        self.positions.iter_mut().for_each(|t| *t *= self.rate);
        let margin = self.resampler.margin(self.step());
        let (first, last) = (self.positions[0], self.positions[count - 1]);
        let must = if self.resampler.needs_margin() { margin as f64 } else { 0.0 };
        // Rounding may put the first position an ulp before sample 0.
        if first - must < -1e-6 {
            return Place::Before;
        }
        let have = offset + available;
        let from = (first.max(0.0) as usize).saturating_sub(margin).max(offset);
        let to = last.max(0.0) as usize + 2 + margin;
        if last + must > have as f64 - 1.0 + 1e-6 || (to > have && !self.complete) {
            return Place::Later;
        }
        let to = to.min(have);
        Place::Ready(from, to)
    }
}
