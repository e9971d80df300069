//! From a tachometer to shaft angle as a function of time.
//!
//! Problem. Synchronous averaging needs the instant at which a shaft reaches a given angle. What is
//! recorded is a pulse channel, or pulse times, or only a nominal speed; pulses go missing and
//! appear twice; the speed drifts.
//!
//! Method. (1) [`pulse_times`], streamed by [`PulseFinder`]: crossings of a level with hysteresis, placed between samples by
//! linear interpolation. (2) [`repair`]: pulses are matched one after the other to the interval
//! predicted by the median of the last five: the candidate nearest to the prediction wins, others
//! near it are extra; where none is, pulses are missing and the count jumps over them. More than
//! [`MAX_BRIDGED`] missing in a row are a hole: the shaft may have stood still, and nothing is known of its angle. (3)
//! [`Shaft`]: time over turns through the pulses as a cubic spline whose slopes are limited after
//! Hyman (1983, SIAM J. Sci. Stat. Comput. 4:645), so that time always increases with angle while
//! smooth speed changes keep the spline's fourth order.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | t | time from sample 0 | s |
//! | turn | shaft revolutions, 0 at the first pulse | 1 |
//! | speed | d turn / d t | Hz |
//!
//! A speed that changes by a factor near 2 *from one pulse to the next* cannot be told from missing
//! pulses; more pulses per revolution cure that. Verified by `tests/tachometer.rs`.

use crate::error::{HumsError, Result, require_len, require_positive};
use gear_numerics::{roots::bisect, spline};

/// Which flank of a pulse carries the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Edge {
    /// Upward crossings.
    #[default]
    Rising,
    /// Downward crossings.
    Falling,
}

/// How pulses are found in a channel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PulseOptions {
    /// Trigger level, unit of the channel; `None`: midway between the channel's extremes.
    pub level: Option<f64>,
    /// Full width of the hysteresis band about the level, > 0; `None`: a quarter of the range.
    pub hysteresis: Option<f64>,
    /// Flank.
    pub edge: Edge,
}

/// Times of the pulses in a tachometer channel sampled at `rate` (Hz), s. Non-finite samples are
/// passed over.
///
/// # Errors
/// [`HumsError::Tachometer`] when the channel has no pulse; [`HumsError::Parameter`] for a rate or
/// hysteresis that is not positive.
pub fn pulse_times(channel: &[f64], rate: f64, options: &PulseOptions) -> Result<Vec<f64>> {
    require_positive("sampling rate", rate)?;
    require_len("tachometer", channel, 2)?;
    let finite = || channel.iter().copied().filter(|x| x.is_finite());
    let (Some(min), Some(max)) = (finite().reduce(f64::min), finite().reduce(f64::max)) else {
        return Err(tachometer("the channel has no finite sample", 0));
    };
    if min >= max {
        return Err(tachometer("the channel is constant", 0));
    }
    let level = options.level.unwrap_or(min / 2.0 + max / 2.0);
    let band = options.hysteresis.unwrap_or((max / 2.0 - min / 2.0) / 2.0);
    require_positive("hysteresis", band)?;
    let mut finder = PulseFinder::new(rate, level, band, options.edge)?;
    let mut times = Vec::new();
    finder.push(channel, &mut times);
    if times.is_empty() {
        return Err(tachometer("the channel has no pulse at this level", 0));
    }
    Ok(times)
}

/// [`pulse_times`] of a channel that arrives in pieces, its trigger level known. The times have the
/// same bits however the channel is cut.
#[derive(Debug, Clone)]
pub struct PulseFinder {
    rate: f64,
    level: f64,
    /// Half the hysteresis band.
    half: f64,
    /// Pulses rise through the level once multiplied by this.
    sign: f64,
    armed: bool,
    /// Last upward crossing of the level since the trigger was armed.
    crossing: Option<f64>,
    /// Number of the last finite sample and its height over the level.
    previous: Option<(usize, f64)>,
    count: usize,
}

impl PulseFinder {
    /// For a channel sampled at `rate` (Hz); `level` and the full width of the `hysteresis` band in
    /// the channel's unit.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for a rate or hysteresis that is not positive, or a level that is not
    /// finite.
    pub fn new(rate: f64, level: f64, hysteresis: f64, edge: Edge) -> Result<Self> {
        require_positive("sampling rate", rate)?;
        require_positive("hysteresis", hysteresis)?;
        if !level.is_finite() {
            return Err(HumsError::Parameter { parameter: "trigger level", value: level, allowed: "finite" });
        }
        let sign = match edge {
            Edge::Rising => 1.0,
            Edge::Falling => -1.0,
        };
        Ok(Self { rate, level, half: hysteresis / 2.0, sign, armed: false, crossing: None, previous: None, count: 0 })
    }

    /// Takes the next samples and appends the times of their pulses, s. Non-finite samples are passed
    /// over.
    pub fn push(&mut self, samples: &[f64], times: &mut Vec<f64>) {
        let first = self.count;
        self.count += samples.len();
        for (k, x) in samples.iter().enumerate().filter(|(_, x)| x.is_finite()) {
            let (i, y) = (first + k, self.sign * (x - self.level));
            if let Some((j, before)) = self.previous
                && before < 0.0
                && y >= 0.0
            {
                self.crossing = Some((j as f64 + (i - j) as f64 * (before / (before - y))) / self.rate);
            }
            if y <= -self.half {
                self.armed = true;
                self.crossing = None;
            } else if y >= self.half && self.armed {
                times.extend(self.crossing);
                self.armed = false;
            }
            self.previous = Some((i, y));
        }
    }
}

/// Pulse times freed of faults.
#[derive(Debug, Clone, PartialEq)]
pub struct RepairedPulses {
    /// Times of the pulses kept, s.
    pub times: Vec<f64>,
    /// Their running numbers, from 0; they skip the missing ones.
    pub numbers: Vec<u64>,
    /// Pulses that are missing between the first and the last.
    pub missing: u64,
    /// Pulses that were left out as extra.
    pub extra: u64,
    /// Pulses (indices of `times`) after which the angle is not known until the next: a standstill, or many pulses
    /// missing.
    pub holes: Vec<usize>,
}

impl RepairedPulses {
    /// The longest stretch without a hole, its pulses numbered from 0.
    #[must_use]
    pub fn longest_stretch(&self) -> Self {
        let mut begins = vec![0];
        begins.extend(self.holes.iter().map(|i| i + 1));
        let ends = begins.iter().skip(1).copied().chain([self.times.len()]);
        let duration = |range: &std::ops::Range<usize>| self.times[range.end - 1] - self.times[range.start];
        let longest = begins
            .iter()
            .zip(ends)
            .map(|(begin, end)| *begin..end)
            .max_by(|a, b| duration(a).total_cmp(&duration(b)).then(b.start.cmp(&a.start)));
        let range = longest.unwrap_or(0..self.times.len());
        let first = self.numbers[range.start];
        Self {
            times: self.times[range.clone()].to_vec(),
            numbers: self.numbers[range].iter().map(|k| k - first).collect(),
            holes: Vec::new(),
            ..*self
        }
    }
}

/// Share of missing or extra pulses above which [`repair`] gives up.
pub const MAX_FAULTY_SHARE: f64 = 0.25;

/// Missing pulses in a row that are bridged; more are a hole.
pub const MAX_BRIDGED: u64 = 3;

/// Pulses that a hole counts for at most.
const MAX_IN_HOLE: f64 = 1e9;

/// Sorts out missing and extra pulses.
///
/// # Errors
/// [`HumsError::Tachometer`] when times are not finite or not increasing, with fewer than two
/// pulses, or with more than [`MAX_FAULTY_SHARE`] of them faulty.
pub fn repair(times: &[f64]) -> Result<RepairedPulses> {
    check_increasing(times)?;
    let mut recent: Vec<f64> = times.windows(2).take(15).map(|w| w[1] - w[0]).collect();
    let first_guess = median(&mut recent);
    // The first pulse may itself be an extra one: begin with the pulse followed by a good interval.
    let fits = |dt: f64, expected: f64| (dt / expected - 1.0).abs() < 0.25;
    let start = (0..times.len().min(8) - 1).find(|&i| fits(times[i + 1] - times[i], first_guess)).unwrap_or(0);
    let mut kept = RepairedPulses {
        times: vec![times[start]],
        numbers: vec![0],
        missing: 0,
        extra: start as u64,
        holes: Vec::new(),
    };
    let mut intervals = vec![first_guess; 1];
    let mut i = start + 1;
    while i < times.len() {
        let (last, number) = (times_last(&kept), numbers_last(&kept));
        let tail = intervals.len().saturating_sub(5);
        let expected = median(&mut intervals[tail..].to_vec());
        let ratio = |k: usize| (times[k] - last) / expected;
        // Candidates for the next pulse: those within half an interval of it.
        let near = (i..times.len())
            .take_while(|&k| ratio(k) < 1.5)
            .filter(|&k| ratio(k) > 0.5)
            .min_by(|&a, &b| (ratio(a) - 1.0).abs().total_cmp(&(ratio(b) - 1.0).abs()));
        let (chosen, steps) = match near {
            Some(k) => (k, 1),
            None if ratio(i) <= 0.5 => {
                kept.extra += 1;
                i += 1;
                continue;
            }
            None => (i, ratio(i).round().min(MAX_IN_HOLE) as u64),
        };
        kept.extra += (chosen - i) as u64;
        if steps - 1 > MAX_BRIDGED {
            kept.holes.push(kept.times.len() - 1);
            // The speed after it is that of the pulses after it.
            intervals.clear();
            let mut next: Vec<f64> = times[chosen..].windows(2).take(5).map(|w| w[1] - w[0]).collect();
            intervals.push(if next.is_empty() { expected } else { median(&mut next) });
        } else {
            kept.missing += steps - 1;
            intervals.push((times[chosen] - last) / steps as f64);
        }
        kept.times.push(times[chosen]);
        kept.numbers.push(number + steps);
        i = chosen + 1;
    }
    let faults = (kept.missing + kept.extra) as f64;
    if faults > MAX_FAULTY_SHARE * (kept.times.len() as u64 + kept.missing) as f64
        || kept.holes.len() as f64 > MAX_FAULTY_SHARE * kept.times.len() as f64
    {
        return Err(tachometer(
            "more than a quarter of the pulses are missing or extra, or the speed jumps",
            times.len() - 1,
        ));
    }
    Ok(kept)
}

fn times_last(pulses: &RepairedPulses) -> f64 {
    pulses.times.last().copied().unwrap_or(0.0)
}

fn numbers_last(pulses: &RepairedPulses) -> u64 {
    pulses.numbers.last().copied().unwrap_or(0)
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn tachometer(reason: &'static str, index: usize) -> HumsError {
    HumsError::Tachometer { reason, index }
}

fn check_increasing(times: &[f64]) -> Result<()> {
    if times.len() < 2 {
        return Err(tachometer("at least two pulses are needed", times.len()));
    }
    if let Some(i) = times.iter().position(|t| !t.is_finite()) {
        return Err(tachometer("a pulse time is not finite", i));
    }
    match times.windows(2).position(|w| !(w[1] > w[0])) {
        Some(i) => Err(tachometer("pulse times do not increase", i + 1)),
        None => Ok(()),
    }
}

/// Slowest speed, Hz; its inverse is the fastest. Far outside anything that turns, far inside `f64`.
const MIN_SPEED: f64 = 1e-100;

/// Angle of a shaft as a function of time, and back.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaft {
    turns: Vec<f64>,
    times: Vec<f64>,
    /// d time / d turn at the nodes, >= 0, s.
    slopes: Vec<f64>,
    /// Intervals (numbers of their first nodes, rising) in which the angle is not known.
    holes: Vec<usize>,
}

impl Shaft {
    /// Constant speed (Hz = turns per second) over a record of `samples` samples at `rate` (Hz);
    /// turn 0 is sample 0.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for a speed or rate that is not positive; fewer than two samples.
    pub fn constant(speed: f64, samples: usize, rate: f64) -> Result<Self> {
        require_positive("speed", speed)?;
        require_positive("sampling rate", rate)?;
        if samples < 2 {
            return Err(HumsError::TooShort { what: "constant-speed shaft", needed: 2, found: samples });
        }
        let end = (samples - 1) as f64 / rate;
        if !(MIN_SPEED < speed && speed < 1.0 / MIN_SPEED && (end * speed).is_finite()) {
            return Err(tachometer("the speed is outside 1e-100 to 1e100 Hz", 0));
        }
        Ok(Self {
            turns: vec![0.0, end * speed],
            times: vec![0.0, end],
            slopes: vec![1.0 / speed; 2],
            holes: Vec::new(),
        })
    }

    /// From pulse times (s), `per_turn` pulses a revolution, taken as they are; turn 0 is the first.
    ///
    /// # Errors
    /// [`HumsError::Tachometer`] when there are fewer than two, or they do not increase;
    /// [`HumsError::Parameter`] unless `per_turn` is positive.
    pub fn from_pulses(times: &[f64], per_turn: f64) -> Result<Self> {
        check_increasing(times)?;
        require_positive("pulses per turn", per_turn)?;
        let turns = (0..times.len()).map(|i| i as f64 / per_turn).collect();
        Self::through(turns, times.to_vec(), Vec::new())
    }

    /// From repaired pulses, `per_turn` a revolution.
    ///
    /// # Errors
    /// As [`Self::from_pulses`].
    pub fn from_repaired(pulses: &RepairedPulses, per_turn: f64) -> Result<Self> {
        check_increasing(&pulses.times)?;
        require_positive("pulses per turn", per_turn)?;
        if pulses.numbers.len() != pulses.times.len() {
            return Err(HumsError::LengthMismatch {
                what: "pulse times and numbers",
                left: pulses.times.len(),
                right: pulses.numbers.len(),
            });
        }
        if let Some(i) = pulses.numbers.windows(2).position(|w| w[1] <= w[0]) {
            return Err(tachometer("pulse numbers do not increase", i + 1));
        }
        let increasing = pulses.holes.windows(2).all(|w| w[0] < w[1]);
        if !increasing || pulses.holes.last().is_some_and(|last| last + 1 >= pulses.times.len()) {
            return Err(tachometer("holes are not between pulses, or do not increase", pulses.times.len()));
        }
        let turns = pulses.numbers.iter().map(|k| *k as f64 / per_turn);
        Self::through(turns.collect(), pulses.times.clone(), pulses.holes.clone())
    }

    /// Pulse channel to shaft in one call: [`pulse_times`], [`repair`], [`Self::from_repaired`].
    ///
    /// # Errors
    /// As those.
    pub fn from_channel(
        channel: &[f64],
        rate: f64,
        per_turn: f64,
        options: &PulseOptions,
    ) -> Result<(Self, RepairedPulses)> {
        let pulses = repair(&pulse_times(channel, rate, options)?)?;
        Ok((Self::from_repaired(&pulses, per_turn)?, pulses))
    }

    fn through(turns: Vec<f64>, times: Vec<f64>, holes: Vec<usize>) -> Result<Self> {
        let speeds = turns.windows(2).zip(times.windows(2));
        let sound = |(a, t): (&[f64], &[f64])| {
            let speed = (a[1] - a[0]) / (t[1] - t[0]);
            MIN_SPEED < speed && speed < 1.0 / MIN_SPEED
        };
        if let Some(i) = speeds.into_iter().position(|pair| !sound(pair)) {
            return Err(tachometer("the speed is outside 1e-100 to 1e100 Hz", i));
        }
        if holes.len() + 1 == turns.len() {
            return Err(tachometer("the shaft stands still, or nearly all pulses are missing", turns.len()));
        }
        let mut slopes = spline::slopes(&turns, &times);
        let secant = |i: usize| (times[i + 1] - times[i]) / (turns[i + 1] - turns[i]);
        let n = slopes.len();
        for (i, slope) in slopes.iter_mut().enumerate() {
            let left = secant(i.saturating_sub(1));
            let right = secant(i.min(n - 2));
            *slope = slope.max(0.0).min(3.0 * left.min(right));
        }
        Ok(Self { turns, times, slopes, holes })
    }

    /// Turns and times (s) between which the angle is not known: the shaft stood still, or many pulses are missing.
    pub fn holes(&self) -> impl Iterator<Item = [(f64, f64); 2]> {
        let node = |i: usize| (self.turns[i], self.times[i]);
        self.holes.iter().map(move |&i| [node(i), node(i + 1)])
    }

    /// Turn at which a hole ends that turns from `first` to `last` touch.
    pub(crate) fn hole_end(&self, first: f64, last: f64) -> Option<f64> {
        let next = self.holes.partition_point(|&i| self.turns[i + 1] <= first);
        self.holes.get(next).filter(|&&i| self.turns[i] < last).map(|&i| self.turns[i + 1])
    }

    /// Another shaft geared to this one: it makes `ratio` turns for each turn of this one
    /// (tooth numbers: `z_this / z_other`); three planet passes a carrier turn are a ratio of 3.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] unless the ratio is between 1e-9 and 1e9.
    pub fn geared(&self, ratio: f64) -> Result<Self> {
        if !(1e-9..=1e9).contains(&ratio) {
            return Err(HumsError::Parameter { parameter: "gear ratio", value: ratio, allowed: "1e-9 to 1e9" });
        }
        Ok(Self {
            turns: self.turns.iter().map(|x| x * ratio).collect(),
            times: self.times.clone(),
            slopes: self.slopes.iter().map(|x| x / ratio).collect(),
            holes: self.holes.clone(),
        })
    }

    /// First and last turn covered.
    #[must_use]
    pub fn turn_range(&self) -> (f64, f64) {
        (self.turns[0], self.turns[self.turns.len() - 1])
    }

    /// First and last time covered, s.
    #[must_use]
    pub fn time_range(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    fn interval(&self, turn: f64) -> usize {
        let after = self.turns.partition_point(|x| *x <= turn);
        after.clamp(1, self.turns.len() - 1) - 1
    }

    fn local(&self, i: usize, turn: f64) -> (f64, f64, [f64; 2], [f64; 2]) {
        let h = self.turns[i + 1] - self.turns[i];
        let times = [self.times[i], self.times[i + 1]];
        let slopes = [self.slopes[i], self.slopes[i + 1]];
        ((turn - self.turns[i]) / h, h, times, slopes)
    }

    /// Time at which the shaft reaches `turn`, s; `None` outside the pulses (no extrapolation).
    #[must_use]
    pub fn time_at(&self, turn: f64) -> Option<f64> {
        let (first, last) = self.turn_range();
        if !(turn >= first && turn <= last) {
            return None;
        }
        let (u, h, times, slopes) = self.local(self.interval(turn), turn);
        Some(spline::hermite(u, h, times, slopes))
    }

    /// Times of `count` equidistant turns from `first_turn`, `step` apart, appended to `times`, s.
    /// The caller keeps the turns within [`Self::turn_range`]; rounding beyond it is harmless.
    pub(crate) fn times_of(&self, first_turn: f64, step: f64, count: usize, times: &mut Vec<f64>) {
        let mut i = self.interval(first_turn);
        times.extend((0..count).map(|k| {
            let turn = first_turn + k as f64 * step;
            while i + 2 < self.turns.len() && self.turns[i + 1] <= turn {
                i += 1;
            }
            let (u, h, times, slopes) = self.local(i, turn);
            spline::hermite(u, h, times, slopes)
        }));
    }

    /// Turn at time `t` (s); `None` outside the pulses. Bisection on the monotone cubic, to the last
    /// bit of the position within the interval.
    #[must_use]
    pub fn turn_at(&self, t: f64) -> Option<f64> {
        let (first, last) = self.time_range();
        if !(t >= first && t <= last) {
            return None;
        }
        let i = self.times.partition_point(|x| *x <= t);
        let i = i.clamp(1, self.times.len() - 1) - 1;
        let (_, h, times, slopes) = self.local(i, self.turns[i]);
        let (low, _) = bisect([0.0, 1.0], 60, |u| spline::hermite(u, h, times, slopes) <= t);
        Some(self.turns[i] + low * h)
    }

    /// Speed at `turn`, Hz; `None` outside the pulses or where the limited slope is flat.
    #[must_use]
    pub fn speed_at(&self, turn: f64) -> Option<f64> {
        let (first, last) = self.turn_range();
        if !(turn >= first && turn <= last) {
            return None;
        }
        let (u, h, times, slopes) = self.local(self.interval(turn), turn);
        let slowness = spline::hermite_slope(u, h, times, slopes);
        (slowness > 0.0).then(|| 1.0 / slowness)
    }

    /// Slowest and fastest mean speed between pulses, Hz; holes do not count.
    #[must_use]
    pub fn speed_range(&self) -> (f64, f64) {
        let speeds = self.turns.windows(2).zip(self.times.windows(2)).enumerate();
        speeds
            .filter(|(i, _)| self.holes.binary_search(i).is_err())
            .map(|(_, pair)| pair)
            .map(|(a, t)| (a[1] - a[0]) / (t[1] - t[0]))
            .fold((f64::INFINITY, 0.0), |(low, high), v| (f64::min(low, v), f64::max(high, v)))
    }
}
