//! Thresholds, false-alarm and detection rates, receiver operating characteristic, alarms.
//!
//! Problem. When is an indicator's value a reason to look? Nominal values hold for Gaussian noise
//! (3 for FM4, 15 for M6A, 105 for M8A); real healthy signals are not Gaussian, so limits come from
//! a healthy set, and what they cost in false alarms and buy in detections is counted.
//!
//! | quantity | formula |
//! |---|---|
//! | [`mean_plus_k_sigma`] | `m + k s`, s with `1/(n-1)` |
//! | [`quantile`] | linear between order statistics (type 7 of Hyndman and Fan 1996; numpy's default) |
//! | [`gaussian_standard_error`] | `sqrt(V_p / N)`: delta method, below |
//! | false-alarm rate | share of healthy values above the threshold |
//! | detection rate | share of damaged values above it |
//! | area under the ROC | Mann-Whitney `P(damaged > healthy) + P(equal)/2` (Hanley and McNeil 1982) |
//! | [`Rate`] interval | Wilson 1927, score interval |
//!
//! The standardised moment of order p of N Gaussian samples scatters about its nominal value with
//! variance `V_p / N`, `V_p = m_2p - m_p^2 - p m_p (m_(p+2) - m_p) + p^2 m_p^2 / 2` for even p (`m_p` =
//! (p-1)!! ): 24 for FM4, 6120 for M6A, 1663200 for M8A; 6 for the skewness. It holds for large N; M8A
//! is skewed until N is far above 10^5. A difference signal has fewer independent
//! samples than samples: twice the number of spectral bins that carry noise.
//!
//! Verified by `tests/threshold.rs`.

use crate::error::{HumsError, Result, require_finite, require_len};

/// Upper limit `mean + k s` of a healthy set, unit of the values.
///
/// # Errors
/// [`HumsError::TooShort`] below two values; non-finite values or `k`.
pub fn mean_plus_k_sigma(healthy: &[f64], k: f64) -> Result<f64> {
    require_len("mean + k sigma threshold", healthy, 2)?;
    if !k.is_finite() {
        return Err(HumsError::Parameter { parameter: "k", value: k, allowed: "finite" });
    }
    let moments = crate::moments::Moments::of(healthy)?;
    let n = healthy.len() as f64;
    Ok(moments.mean() + k * moments.standard_deviation() * (n / (n - 1.0)).sqrt())
}

/// Quantile of a set, `share` in 0..=1: 0.99 gives the limit that one healthy value in a hundred
/// passes.
///
/// # Errors
/// Empty or non-finite set; share out of range.
pub fn quantile(values: &[f64], share: f64) -> Result<f64> {
    require_len("quantile", values, 1)?;
    require_finite("quantile", values)?;
    check_share(share)?;
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len() - 1) as f64;
    let low = place.floor() as usize;
    let high = (low + 1).min(sorted.len() - 1);
    let u = place - low as f64;
    Ok(sorted[low] + u * (sorted[high] - sorted[low]))
}

fn check_share(share: f64) -> Result<()> {
    if (0.0..=1.0).contains(&share) {
        Ok(())
    } else {
        Err(HumsError::Parameter { parameter: "share", value: share, allowed: "0 to 1" })
    }
}

/// Nominal value of the standardised moment of even order p for a Gaussian signal, (p - 1)!!.
fn gaussian_moment(p: usize) -> f64 {
    (1..p).step_by(2).map(|k| k as f64).product()
}

/// Standard deviation of the skewness (order 3) or the standardised moment of order 4, 6 or 8 of
/// `samples` independent Gaussian samples.
///
/// # Errors
/// [`HumsError::Parameter`] for another order or no samples.
pub fn gaussian_standard_error(order: usize, samples: usize) -> Result<f64> {
    if samples == 0 {
        return Err(HumsError::TooShort { what: "standard error", needed: 1, found: 0 });
    }
    let variance = match order {
        3 => 6.0,
        4 | 6 | 8 => {
            let (p, m) = (order as f64, gaussian_moment(order));
            gaussian_moment(2 * order) - m * m - p * m * (gaussian_moment(order + 2) - m) + p * p * m * m / 2.0
        }
        _ => {
            return Err(HumsError::Parameter {
                parameter: "moment order",
                value: order as f64,
                allowed: "3, 4, 6 or 8",
            });
        }
    };
    Ok((variance / samples as f64).sqrt())
}

/// A share of cases with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Cases above the threshold.
    pub hits: usize,
    /// All cases, > 0.
    pub cases: usize,
    /// Lower end of the Wilson 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Rate {
    /// Share of values above a threshold, with its interval. A value equal to the threshold is no
    /// alarm.
    ///
    /// # Errors
    /// Empty or non-finite set; NaN threshold.
    pub fn above(values: &[f64], threshold: f64) -> Result<Self> {
        require_len("rate", values, 1)?;
        require_finite("rate", values)?;
        if threshold.is_nan() {
            return Err(HumsError::Parameter { parameter: "threshold", value: threshold, allowed: "a number" });
        }
        let hits = values.iter().filter(|v| **v > threshold).count();
        let (n, p) = (values.len() as f64, hits as f64 / values.len() as f64);
        // 97.5 % quantile of the normal distribution.
        let z: f64 = 1.959_963_984_540_054;
        let shrink = 1.0 + z * z / n;
        let centre = (p + z * z / (2.0 * n)) / shrink;
        let half = z / shrink * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        Ok(Self { hits, cases: values.len(), low: (centre - half).max(0.0), high: (centre + half).min(1.0) })
    }

    /// The share.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.hits as f64 / self.cases as f64
    }
}

/// One point of a receiver operating characteristic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RocPoint {
    /// Alarm above this value; the first point has infinity.
    pub threshold: f64,
    /// Share of healthy cases above.
    pub false_alarm_rate: f64,
    /// Share of damaged cases above.
    pub detection_rate: f64,
}

/// Receiver operating characteristic of an indicator that rises with damage.
#[derive(Debug, Clone, PartialEq)]
pub struct Roc {
    /// From (0, 0) to (1, 1); one point for every distinct value.
    pub points: Vec<RocPoint>,
    /// Area under the curve: 0.5 sees nothing, 1 separates all.
    pub area: f64,
}

impl Roc {
    /// From values of healthy and damaged cases.
    ///
    /// # Errors
    /// An empty or non-finite set.
    pub fn new(healthy: &[f64], damaged: &[f64]) -> Result<Self> {
        for set in [healthy, damaged] {
            require_len("receiver operating characteristic", set, 1)?;
            require_finite("receiver operating characteristic", set)?;
        }
        let descending = |set: &[f64]| {
            let mut sorted = set.to_vec();
            sorted.sort_by(|a, b| b.total_cmp(a));
            sorted
        };
        let (h, d) = (descending(healthy), descending(damaged));
        let (nh, nd) = (h.len() as f64, d.len() as f64);
        let mut points = vec![RocPoint { threshold: f64::INFINITY, false_alarm_rate: 0.0, detection_rate: 0.0 }];
        let (mut i, mut j) = (0, 0);
        // Twice the Mann-Whitney count, in whole numbers: exact.
        let mut doubled: u128 = 0;
        while i < h.len() || j < d.len() {
            let next = match (h.get(i), d.get(j)) {
                (Some(a), Some(b)) => a.max(*b),
                (Some(a), None) => *a,
                (None, Some(b)) => *b,
                (None, None) => break,
            };
            let (i0, j0) = (i, j);
            while h.get(i).is_some_and(|v| *v >= next) {
                i += 1;
            }
            while d.get(j).is_some_and(|v| *v >= next) {
                j += 1;
            }
            // Healthy cases at this value: all damaged ones above win, those equal tie.
            doubled += (i - i0) as u128 * (2 * j0 as u128 + (j - j0) as u128);
            points.push(RocPoint { threshold: next, false_alarm_rate: i as f64 / nh, detection_rate: j as f64 / nd });
        }
        // An alarm is strictly above the threshold, so a point's rates belong to any threshold just
        // below its value.
        for k in 1..points.len() {
            points[k].threshold = points[k].threshold.next_down();
        }
        Ok(Self { area: doubled as f64 / (2.0 * nh * nd), points })
    }

    /// Best detection rate at a false-alarm rate of at most `rate`, with its threshold.
    #[must_use]
    pub fn at_false_alarm_rate(&self, rate: f64) -> RocPoint {
        let allowed = self.points.partition_point(|p| p.false_alarm_rate <= rate);
        self.points[allowed.max(1) - 1]
    }
}

/// Probability of detection for each of several severities (or noise levels, or sensors): the rate
/// above one threshold in every set.
///
/// # Errors
/// As [`Rate::above`].
pub fn detection_curve<S: AsRef<[f64]>>(sets: &[S], threshold: f64) -> Result<Vec<Rate>> {
    sets.iter().map(|set| Rate::above(set.as_ref(), threshold)).collect()
}

/// When a sequence of records raises an alarm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlarmRule {
    /// Values above this count.
    pub threshold: f64,
    /// So many must count ...
    pub hits: usize,
    /// ... among the last so many records that have a value.
    pub window: usize,
}

/// Records (indices) at which an alarm begins and ends (end excluded). `None` values, of records
/// without the indicator, neither raise nor clear one.
///
/// # Errors
/// [`HumsError::Parameter`] unless `1 <= hits <= window`.
pub fn alarms(values: &[Option<f64>], rule: &AlarmRule) -> Result<Vec<std::ops::Range<usize>>> {
    if rule.hits == 0 || rule.hits > rule.window {
        return Err(HumsError::Parameter {
            parameter: "alarm hits",
            value: rule.hits as f64,
            allowed: "at least 1, at most the window",
        });
    }
    let mut recent = std::collections::VecDeque::new();
    let mut found = Vec::new();
    let mut since = None;
    for (i, value) in values.iter().enumerate() {
        let Some(value) = value else { continue };
        recent.push_back(*value > rule.threshold);
        if recent.len() > rule.window {
            recent.pop_front();
        }
        let raised = recent.iter().filter(|hit| **hit).count() >= rule.hits;
        match (raised, since) {
            (true, None) => since = Some(i),
            (false, Some(start)) => {
                found.push(start..i);
                since = None;
            }
            _ => {}
        }
    }
    found.extend(since.map(|start| start..values.len()));
    Ok(found)
}
