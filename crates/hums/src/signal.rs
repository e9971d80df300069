//! Gaps, trends and times of a record.
//!
//! Problem. Recorded vibration has holes (NaN, infinite values) and offsets. Most functions refuse
//! non-finite samples; this module fills short gaps and removes trends. What else may be wrong with
//! a record is found by [`crate::quality`].
//!
//! Units: whatever the signal has; indices count samples from 0.
//! Verified by `tests/extremes.rs`.

use crate::error::{HumsError, Result, require_finite, require_len, require_positive};
use std::ops::Range;

fn runs(signal: &[f64], hit: impl Fn(f64) -> bool, shortest: usize) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = None;
    for (i, &x) in signal.iter().enumerate() {
        match (hit(x), start) {
            (true, None) => start = Some(i),
            (false, Some(first)) => {
                if i - first >= shortest {
                    found.push(first..i);
                }
                start = None;
            }
            _ => {}
        }
    }
    if let Some(first) = start
        && signal.len() - first >= shortest
    {
        found.push(first..signal.len());
    }
    found
}

/// Replaces non-finite samples by straight lines between their finite neighbours (the end values
/// where a gap touches an end). Returns the number of samples filled.
///
/// # Errors
/// [`HumsError::Parameter`] when a gap is longer than `longest` samples: a long gap is a hole in
/// the evidence, not something to invent; [`HumsError::Undefined`] when no sample is finite. The
/// signal is unchanged then.
pub fn fill_gaps(signal: &mut [f64], longest: usize) -> Result<usize> {
    let gaps = runs(signal, |x| !x.is_finite(), 1);
    if gaps.iter().map(Range::len).sum::<usize>() == signal.len() {
        return Err(HumsError::Undefined { what: "gap filling", reason: "the record has no finite sample" });
    }
    if let Some(gap) = gaps.iter().find(|gap| gap.len() > longest) {
        return Err(HumsError::Parameter {
            parameter: "gap length",
            value: gap.len() as f64,
            allowed: "at most the longest gap the caller permits",
        });
    }
    let mut filled = 0;
    for gap in gaps {
        let left = gap.start.checked_sub(1).map(|i| signal[i]);
        let right = signal.get(gap.end).copied();
        let (a, b) = match (left, right) {
            (Some(a), Some(b)) => (a, b),
            (Some(a), None) => (a, a),
            (None, Some(b)) => (b, b),
            (None, None) => continue,
        };
        let steps = (gap.len() + 1) as f64;
        for (k, i) in gap.enumerate() {
            let s = (k + 1) as f64 / steps;
            signal[i] = (1.0 - s) * a + s * b;
            filled += 1;
        }
    }
    Ok(filled)
}

/// The longest run of finite samples, for records whose gaps are too long to fill.
#[must_use]
pub fn longest_finite_run(signal: &[f64]) -> Range<usize> {
    runs(signal, f64::is_finite, 1)
        .into_iter()
        .max_by(|a, b| a.len().cmp(&b.len()).then(b.start.cmp(&a.start)))
        .unwrap_or(0..0)
}

/// Subtracts the least-squares straight line (`linear = true`) or the mean.
///
/// # Errors
/// Non-finite samples, or an empty signal.
pub fn detrend(signal: &mut [f64], linear: bool) -> Result<()> {
    require_len("detrending", signal, 1)?;
    require_finite("detrending", signal)?;
    let n = signal.len() as f64;
    let mean = signal.iter().sum::<f64>() / n;
    let centre = (n - 1.0) / 2.0;
    let slope = if linear && signal.len() > 1 {
        let cross: f64 = signal.iter().enumerate().map(|(i, x)| (i as f64 - centre) * (x - mean)).sum();
        cross / (n * (n * n - 1.0) / 12.0)
    } else {
        0.0
    };
    for (i, x) in signal.iter_mut().enumerate() {
        *x -= mean + slope * (i as f64 - centre);
    }
    Ok(())
}

/// Times `i / rate` (s) of the samples of a uniformly sampled record, `rate` in samples per second.
///
/// # Errors
/// [`HumsError::Parameter`] unless the rate is finite and positive.
pub fn uniform_times(samples: usize, rate: f64) -> Result<Vec<f64>> {
    require_positive("sampling rate", rate)?;
    Ok((0..samples).map(|i| i as f64 / rate).collect())
}
