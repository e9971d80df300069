//! Thresholds, false-alarm and detection rates, receiver operating characteristic, alarms.
//!
//! Problem. When is an indicator's value a reason to look? Nominal values hold for Gaussian noise
//! (3 for FM4, 15 for M6A, 105 for M8A); real healthy signals are not Gaussian, so limits come from
//! a healthy set, and what they cost in false alarms and buy in detections is counted.
//!
//! | quantity | formula |
//! |---|---|
//! | [`prediction_limit`] | `m -+ t s sqrt(1 + 1/n)`, t of n - 1 degrees of freedom; of logarithms where all values are positive |
//! | [`sigma_limit`] | `m -+ k s`, s with `1/(n-1)` |
//! | [`quantile_limit`] | quantiles that leave half of the rest out on either side |
//! | [`quantile`] | linear between order statistics (type 7 of Hyndman and Fan 1996; numpy's default) |
//! | [`gaussian_standard_error`] | `sqrt(V_p / N)`: delta method, below |
//! | false-alarm rate | [`held_out`]: share of healthy values outside the limits of the others |
//! | detection rate | share of damaged values outside the limits |
//! | area under the ROC | Mann-Whitney `P(damaged > healthy) + P(equal)/2` (Hanley and McNeil 1982) |
//! | [`Rate`] interval | Wilson 1927, score interval |
//!
//! Limits have two sides: a loose sensor halves the RMS, and a skewness has no preferred sign. Many tests on one recording raise many
//! false alarms: at three standard deviations forty tests alarm on one healthy recording in ten. [`prediction_limit`] takes the false-alarm
//! rate of a single test; divided by the number of tests (Bonferroni), the whole family keeps it, however the tests are correlated.
//! [`Limit::deviation`] puts all indicators on one scale, 1 at the limit; its largest value is a health index of the family.
//!
//! The standardised moment of order p of N Gaussian samples scatters about its nominal value with
//! variance `V_p / N`, `V_p = m_2p - m_p^2 - p m_p (m_(p+2) - m_p) + p^2 m_p^2 / 2` for even p (`m_p` =
//! (p-1)!! ): 24 for FM4, 6120 for M6A, 1663200 for M8A; 6 for the skewness. It holds for large N; M8A
//! is skewed until N is far above 10^5. A difference signal has fewer independent
//! samples than samples: twice the number of spectral bins that carry noise.
//!
//! Verified by `tests/threshold.rs`.

use crate::distribution;
use crate::error::{HumsError, Result, require_finite, require_len};

/// Admissible range of a value, and its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Values below it are a reason to look; `None`: none are.
    pub lower: Option<f64>,
    /// What is expected.
    pub centre: f64,
    /// Values above it are a reason to look; `None`: none are.
    pub upper: Option<f64>,
    /// Distances are those of logarithms.
    logarithmic: bool,
}

impl Limit {
    /// With an upper end only.
    #[must_use]
    pub fn up_to(centre: f64, upper: f64) -> Self {
        Self { lower: None, centre, upper: Some(upper), logarithmic: false }
    }

    /// With an upper end only, `factor` (> 1) times the centre (> 0); distances are those of logarithms.
    #[must_use]
    pub fn up_to_factor(centre: f64, factor: f64) -> Self {
        Self { upper: Some(centre * factor), logarithmic: true, ..Self::up_to(centre, centre) }
    }

    /// Whether a value is outside. One equal to an end is not.
    #[must_use]
    pub fn excludes(&self, value: f64) -> bool {
        self.upper.is_some_and(|upper| value > upper) || self.lower.is_some_and(|lower| value < lower)
    }

    /// Distance of a value from the middle in units of that of the end on its side: 1 at the limits, 0 on a side without limit.
    #[must_use]
    pub fn deviation(&self, value: f64) -> f64 {
        let end = if value > self.centre { self.upper } else { self.lower };
        let Some(end) = end.filter(|_| value != self.centre) else { return 0.0 };
        let scale = |x: f64| if self.logarithmic { x.max(0.0).ln() } else { x };
        let ratio = (scale(value) - scale(self.centre)) / (scale(end) - scale(self.centre));
        // Rounding must not contradict `excludes`.
        let ratio = if ratio.is_finite() { ratio } else { f64::MAX };
        if self.excludes(value) { ratio.max(1.0_f64.next_up()) } else { ratio.clamp(0.0, 1.0) }
    }
}

/// Smallest standard deviation that a healthy set is given, relative to its mean: values of equal recordings differ by rounding.
const ROUNDING: f64 = 1e-9;

/// Range that a further value of the same population leaves with probability `false_alarm_rate` (two sides together), by the prediction
/// interval of a normal population (Hahn and Meeker 1991, Statistical Intervals, section 4.7): exact for n values, wide for few. Where all values are
/// positive their logarithms are taken as normal: levels and ratios scatter by factors.
///
/// # Errors
/// [`HumsError::TooShort`] below two values; non-finite values; [`HumsError::Parameter`] for a rate outside (0, 1).
pub fn prediction_limit(healthy: &[f64], false_alarm_rate: f64) -> Result<Limit> {
    const WHAT: &str = "prediction limit";
    require_len(WHAT, healthy, 2)?;
    require_finite(WHAT, healthy)?;
    if !(false_alarm_rate > 0.0 && false_alarm_rate < 1.0) {
        let allowed = "above 0, below 1";
        return Err(HumsError::Parameter { parameter: "false-alarm rate", value: false_alarm_rate, allowed });
    }
    let logarithmic = healthy.iter().all(|x| *x > 0.0);
    let n = healthy.len() as f64;
    let reach = distribution::student_t_quantile(1.0 - false_alarm_rate / 2.0, n - 1.0) * (1.0 + 1.0 / n).sqrt();
    if logarithmic {
        let logarithms: Vec<f64> = healthy.iter().map(|x| x.ln()).collect();
        let (mean, sigma) = mean_and_sigma(&logarithms)?;
        let half = reach * sigma.max(ROUNDING);
        let end = |x: f64| Some(x.exp()).filter(|x| x.is_finite());
        let lower = end(mean - half).filter(|x| *x > 0.0);
        return Ok(Limit { lower, centre: mean.exp(), upper: end(mean + half), logarithmic });
    }
    let (mean, sigma) = mean_and_sigma(healthy)?;
    let half = reach * sigma.max(ROUNDING * mean.abs());
    Ok(Limit { lower: Some(mean - half), centre: mean, upper: Some(mean + half), logarithmic })
}

/// Mean and standard deviation (`1/(n-1)`).
fn mean_and_sigma(values: &[f64]) -> Result<(f64, f64)> {
    let moments = crate::moments::Moments::of(values)?;
    let n = values.len() as f64;
    Ok((moments.mean(), moments.standard_deviation() * (n / (n - 1.0)).sqrt()))
}

/// Range `mean -+ k s` of a healthy set, unit of the values.
///
/// # Errors
/// [`HumsError::TooShort`] below two values; non-finite values; [`HumsError::Parameter`] unless k is finite and >= 0.
pub fn sigma_limit(healthy: &[f64], k: f64) -> Result<Limit> {
    require_len("mean + k sigma limit", healthy, 2)?;
    if !(k.is_finite() && k >= 0.0) {
        return Err(HumsError::Parameter { parameter: "k", value: k, allowed: "finite and >= 0" });
    }
    let (mean, sigma) = mean_and_sigma(healthy)?;
    Ok(Limit { lower: Some(mean - k * sigma), centre: mean, upper: Some(mean + k * sigma), logarithmic: false })
}

/// Range that holds the middle `share` of a healthy set; its centre is the median.
///
/// # Errors
/// As [`quantile`].
pub fn quantile_limit(healthy: &[f64], share: f64) -> Result<Limit> {
    check_share(share)?;
    let at = |share| quantile(healthy, share);
    let tail = (1.0 - share) / 2.0;
    Ok(Limit { lower: Some(at(tail)?), centre: at(0.5)?, upper: Some(at(1.0 - tail)?), logarithmic: false })
}

/// Quantile of the standard normal distribution for a probability in [0.5, 1).
#[must_use]
pub fn normal_quantile(probability: f64) -> f64 {
    // Student's t of n degrees of freedom is z + (z^3 + z) / (4 n) to O(1/n^2) (Abramowitz and Stegun 26.7.5).
    let degrees = 1e5;
    let t = distribution::student_t_quantile(probability.clamp(0.5, 1.0_f64.next_down()), degrees);
    t - (t * t * t + t) / (4.0 * degrees)
}

/// Share of a healthy set outside the limits that the others give: an estimate of the rate of false alarms on recordings that
/// had no part in the limits.
///
/// # Errors
/// Those of `rule`, and [`HumsError::TooShort`] below three values.
pub fn held_out(healthy: &[f64], rule: impl Fn(&[f64]) -> Result<Limit>) -> Result<Rate> {
    require_len("leave-one-out rate", healthy, 3)?;
    let mut others = healthy[1..].to_vec();
    let mut hits = 0;
    for (k, value) in healthy.iter().enumerate() {
        hits += usize::from(rule(&others)?.excludes(*value));
        if let Some(place) = others.get_mut(k) {
            *place = *value;
        }
    }
    Rate::of(hits, healthy.len())
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
    /// Cases that count.
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
        Self::of(values.iter().filter(|v| **v > threshold).count(), values.len())
    }

    /// Share of values outside limits.
    ///
    /// # Errors
    /// Empty or non-finite set.
    pub fn outside(values: &[f64], limit: &Limit) -> Result<Self> {
        require_finite("rate", values)?;
        Self::of(values.iter().filter(|v| limit.excludes(**v)).count(), values.len())
    }

    /// `hits` of `cases`.
    ///
    /// # Errors
    /// No cases, or more hits than cases.
    pub fn of(hits: usize, cases: usize) -> Result<Self> {
        if cases == 0 || hits > cases {
            return Err(HumsError::Parameter {
                parameter: "hits",
                value: hits as f64,
                allowed: "at most the cases, of which there is at least one",
            });
        }
        let (n, p) = (cases as f64, hits as f64 / cases as f64);
        // 97.5 % quantile of the normal distribution.
        let z: f64 = 1.959_963_984_540_054;
        let shrink = 1.0 + z * z / n;
        let centre = (p + z * z / (2.0 * n)) / shrink;
        let half = z / shrink * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        Ok(Self { hits, cases, low: (centre - half).max(0.0), high: (centre + half).min(1.0) })
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
    /// Alarm above this value (below it for an indicator that falls); the first point has infinity.
    pub threshold: f64,
    /// Share of healthy cases beyond.
    pub false_alarm_rate: f64,
    /// Share of damaged cases beyond.
    pub detection_rate: f64,
}

/// Receiver operating characteristic.
#[derive(Debug, Clone, PartialEq)]
pub struct Roc {
    /// Whether an alarm is a value above the threshold; otherwise, below it.
    pub rises: bool,
    /// Healthy and damaged cases.
    pub cases: (usize, usize),
    /// From (0, 0) to (1, 1); one point for every distinct value.
    pub points: Vec<RocPoint>,
    /// Area under the curve: 0.5 sees nothing, 1 separates all.
    pub area: f64,
}

impl Roc {
    /// Of an indicator that rises or falls with damage, whichever separates the sets better: its area is at least 0.5.
    ///
    /// # Errors
    /// An empty or non-finite set.
    pub fn oriented(healthy: &[f64], damaged: &[f64]) -> Result<Self> {
        let rising = Self::new(healthy, damaged)?;
        if rising.area >= 0.5 {
            return Ok(rising);
        }
        let negated = |set: &[f64]| set.iter().map(|x| -x).collect::<Vec<f64>>();
        let mut falling = Self::new(&negated(healthy), &negated(damaged))?;
        falling.rises = false;
        falling.points.iter_mut().for_each(|p| p.threshold = -p.threshold);
        Ok(falling)
    }

    /// 95 % interval of the area (Hanley and McNeil 1982, Radiology 143:29), within 0 and 1. For an area of 1 it is that of the
    /// smaller set's rule of three.
    #[must_use]
    pub fn area_interval(&self) -> (f64, f64) {
        let (a, h, d) = (self.area, self.cases.0 as f64, self.cases.1 as f64);
        let (q1, q2) = (a / (2.0 - a), 2.0 * a * a / (1.0 + a));
        let variance = (a * (1.0 - a) + (d - 1.0) * (q1 - a * a) + (h - 1.0) * (q2 - a * a)) / (h * d);
        let half = 1.959_963_984_540_054 * variance.max(0.0).sqrt();
        let low = if a < 1.0 { a - half } else { 1.0 - 3.0 / h.min(d) };
        (low.max(0.0), (a + half).min(1.0))
    }

    /// From values of healthy and damaged cases, of an indicator that rises with damage.
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
        Ok(Self { rises: true, cases: (h.len(), d.len()), area: doubled as f64 / (2.0 * nh * nd), points })
    }

    /// Best detection rate at a false-alarm rate of at most `rate`, with its threshold.
    #[must_use]
    pub fn at_false_alarm_rate(&self, rate: f64) -> RocPoint {
        let allowed = self.points.partition_point(|p| p.false_alarm_rate <= rate);
        self.points[allowed.max(1) - 1]
    }
}

/// Probability of detection for each of several severities (or noise levels, or sensors): the share outside one pair of limits in every
/// set.
///
/// # Errors
/// As [`Rate::outside`].
pub fn detection_curve<S: AsRef<[f64]>>(sets: &[S], limit: &Limit) -> Result<Vec<Rate>> {
    sets.iter().map(|set| Rate::outside(set.as_ref(), limit)).collect()
}

/// When a sequence of records raises an alarm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlarmRule {
    /// Values outside count.
    pub limit: Limit,
    /// Number of values that must count ...
    pub hits: usize,
    /// ... among this number of last records that have a value.
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
        recent.push_back(rule.limit.excludes(*value));
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
