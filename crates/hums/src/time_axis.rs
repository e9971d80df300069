//! A time column: its sampling step, and rows that are missing from it.
//!
//! Problem. Text recordings carry the time of every row. The step is found from the head of the file, but a logger may
//! stop for a while, or change its rate, anywhere. [`TimeAxis`] follows the whole column: rows that are missing are
//! put in as NaN in every channel, so that sample index and time agree from the first to the last row; a column that
//! goes back, repeats itself or changes its rate is an error with its row.
//!
//! The step of the head is the median of mean steps over [`WINDOW`] rows, then rows over duration. A row counts as the next one
//! if its time is within half a step of it, so that times written with few digits pass; the mean step
//! of every [`WINDOW`] rows must be within [`TOLERANCE`] of the head's.
//! Verified by `tests/time_axis.rs`.

use crate::error::{HumsError, Result, require_len, require_positive};

/// Rows over which the step is compared.
pub const WINDOW: usize = 256;
/// Largest relative deviation of the mean step of a window.
pub const TOLERANCE: f64 = 0.01;
/// Rows that may be put in for missing ones, altogether: half a gigabyte a channel.
pub const MAX_MISSING: u64 = 1 << 26;

/// What was found in a time column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TimeGaps {
    /// Places where rows are missing.
    pub count: usize,
    /// Rows missing in all of them.
    pub missing: u64,
    /// Rows missing in the longest.
    pub longest: u64,
    /// Row after the first gap, from 0.
    pub first: Option<u64>,
}

/// Follows a time column.
#[derive(Debug, Clone)]
pub struct TimeAxis {
    step: f64,
    /// Time of the last row that has one, and rows since (1 for the next).
    last: Option<f64>,
    since: u64,
    row: u64,
    /// Time at the begin of the window, and steps in it so far.
    window: Option<(f64, u64)>,
    gaps: TimeGaps,
}

/// Sampling step (unit of the times) of a column whose begin this is.
///
/// # Errors
/// Fewer than two finite times; [`HumsError::Parameter`] for times that do not increase, or jump by something that is not a
/// whole number of steps within half a step.
pub fn step_of(times: &[f64]) -> Result<f64> {
    const WHAT: &str = "time column";
    require_len(WHAT, times, 2)?;
    let finite: Vec<f64> = times.iter().copied().filter(|t| t.is_finite()).collect();
    require_len(WHAT, &finite, 2)?;
    let width = WINDOW.min(finite.len() - 1);
    let mut means: Vec<f64> = finite.windows(width + 1).map(|w| (w[width] - w[0]) / width as f64).collect();
    means.sort_by(f64::total_cmp);
    let median = means[means.len() / 2];
    require_positive("mean time step", median)?;
    let mut axis = TimeAxis::new(median)?;
    axis.push(times, |_, _| {})?;
    let rows = (times.len() as u64 - 1 + axis.gaps.missing) as f64;
    match (times[0].is_finite(), times[times.len() - 1].is_finite()) {
        (true, true) => Ok((times[times.len() - 1] - times[0]) / rows),
        _ => Ok(median),
    }
}

impl TimeAxis {
    /// For a column with a known step (unit of the times).
    ///
    /// # Errors
    /// [`HumsError::Parameter`] unless it is finite and positive.
    pub fn new(step: f64) -> Result<Self> {
        require_positive("time step", step)?;
        Ok(Self { step, last: None, since: 1, row: 0, window: None, gaps: TimeGaps::default() })
    }

    /// What was found so far.
    #[must_use]
    pub fn gaps(&self) -> TimeGaps {
        self.gaps
    }

    /// Follows the next rows; `missing(row, count)` is called where `count` rows are missing before one (index into `times`). A row without
    /// a finite time is taken as the next.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for a step back, a repeated time, another rate, or more than [`MAX_MISSING`] rows missing.
    pub fn push(&mut self, times: &[f64], mut missing: impl FnMut(usize, usize)) -> Result<()> {
        for (k, &t) in times.iter().enumerate() {
            let Some(last) = self.last.filter(|_| t.is_finite()) else {
                if t.is_finite() {
                    (self.last, self.since, self.window) = (Some(t), 0, Some((t, 0)));
                }
                self.since += 1;
                self.row += 1;
                continue;
            };
            let steps = ((t - last) / self.step).round();
            if !(steps >= self.since as f64) {
                return Err(HumsError::Parameter {
                    parameter: "time step",
                    value: (t - last) / self.since as f64,
                    allowed: "above half the usual step: times must not repeat or go back",
                });
            }
            let gap = steps - self.since as f64;
            if gap > 0.0 {
                if !(self.gaps.missing as f64 + gap <= MAX_MISSING as f64) {
                    return Err(HumsError::Parameter {
                        parameter: "rows missing from the time column",
                        value: self.gaps.missing as f64 + gap,
                        allowed: "at most 2^26 altogether",
                    });
                }
                let rows = gap as u64;
                self.gaps.count += 1;
                self.gaps.missing += rows;
                self.gaps.longest = self.gaps.longest.max(rows);
                self.gaps.first = self.gaps.first.or(Some(self.row));
                missing(k, rows as usize);
                self.window = Some((t, 0));
            } else if let Some((begin, count)) = &mut self.window {
                *count += steps as u64;
                if *count >= WINDOW as u64 {
                    let mean = (t - *begin) / *count as f64;
                    if (mean / self.step - 1.0).abs() > TOLERANCE {
                        return Err(HumsError::Parameter {
                            parameter: "mean time step",
                            value: mean,
                            allowed: "within 1 % of that at the begin: the sampling rate must not change",
                        });
                    }
                    self.window = Some((t, 0));
                }
            }
            (self.last, self.since) = (Some(t), 1);
            self.row += 1;
        }
        Ok(())
    }

    /// Puts NaN rows for missing ones into the rows of a block from `from` on (columns of one length; `time` is the time column), and
    /// returns how many.
    ///
    /// # Errors
    /// As [`Self::push`].
    pub fn complete(&mut self, columns: &mut [Vec<f64>], time: usize, from: usize) -> Result<usize> {
        let mut gaps = Vec::new();
        self.push(&columns[time][from..], |row, count| gaps.push((from + row, count)))?;
        for column in columns.iter_mut() {
            for &(row, count) in gaps.iter().rev() {
                column.splice(row..row, std::iter::repeat_n(f64::NAN, count));
            }
        }
        Ok(gaps.iter().map(|gap| gap.1).sum())
    }
}
