//! Whether a recorded channel can be judged at all: dead, gaps, clipping, saturation, dropouts, drift.
//!
//! Problem. A condition indicator of a dead sensor, of a clipped record or of one with half its samples missing is a
//! number, but it says nothing of the gear. [`ChannelMonitor`] looks at every sample once, in pieces of any
//! size, and [`ChannelQuality::findings`] names what it saw.
//!
//! | flaw | criterion | blocks a verdict |
//! |---|---|---|
//! | [`Flaw::NoData`] | no finite sample | yes |
//! | [`Flaw::Dead`] | all finite samples equal, or at most four levels of the converter | yes |
//! | [`Flaw::Gap`] | NaN or infinite samples | above [`MAX_MISSING_SHARE`] |
//! | [`Flaw::Clipped`] | [`CLIP_RUN`] or more equal samples at the record's own maximum or minimum | above [`MAX_CLIPPED_SHARE`] |
//! | [`Flaw::Dropout`] | [`DROPOUT_RUN`] or more equal samples elsewhere: a loose plug | above [`MAX_DROPOUT_SHARE`] |
//! | [`Flaw::Saturated`] | mean of a stretch more than [`SATURATION`] typical RMS off, in less than a quarter of the stretches: an overloaded charge amplifier recovers | yes |
//! | [`Flaw::Drift`] | means of eighths of the record differ by more than [`DRIFT`] typical RMS | above [`MAX_DRIFT`] |
//!
//! A stretch is a 32nd to a 64th of the record. The typical RMS is the median over the stretches of the RMS about the
//! median of their means; for the drift, about their own. A flat top that rounding explains is no clipping: a smooth peak that stays within one step q
//! of the converter for L samples falls by at most `q ((L + 1) / (L - 1))^2 + q` to the next sample.
//!
//! Units: that of the signal; indices count samples from 0.
//! Verified by `tests/quality.rs`.

/// Equal samples at an extreme that count as clipping, at least.
pub const CLIP_RUN: usize = 3;
/// Equal samples within the range that count as a dropout, at least.
pub const DROPOUT_RUN: usize = 64;
/// Share of clipped samples above which a channel is not judged.
pub const MAX_CLIPPED_SHARE: f64 = 1e-4;
/// Share of missing samples above which a channel is not judged.
pub const MAX_MISSING_SHARE: f64 = 0.1;
/// Share of samples in dropouts above which a channel is not judged.
pub const MAX_DROPOUT_SHARE: f64 = 1e-3;
/// Drift (typical RMS) that is reported.
pub const DRIFT: f64 = 1.0;
/// Drift (typical RMS) above which a channel is not judged.
pub const MAX_DRIFT: f64 = 10.0;
/// Offset of a stretch (typical RMS) that counts as saturation.
pub const SATURATION: f64 = 3.0;

/// Samples of a stretch at first; stretches are joined in pairs once there are [`MAX_STRETCHES`].
const STRETCH: usize = 256;
const MAX_STRETCHES: usize = 64;
/// Stretches that drift and saturation need.
const MIN_STRETCHES: usize = 16;

/// What is wrong with a channel or a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Flaw {
    /// No finite sample.
    NoData,
    /// A constant, or hardly any resolution.
    Dead,
    /// Samples are missing.
    Gap,
    /// Flat tops at the limits of the converter.
    Clipped,
    /// Stretches of equal samples within the range.
    Dropout,
    /// The amplifier was overloaded and recovered.
    Saturated,
    /// The mean wanders.
    Drift,
    /// Two sources of the sampling rate disagree.
    RateConflict,
    /// The shaft stood still, or many pulses in a row are missing.
    Standstill,
    /// The time column is of no use.
    TimeColumn,
    /// The file holds arrays that are not read.
    LeftOut,
}

impl Flaw {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::NoData,
        Self::Dead,
        Self::Gap,
        Self::Clipped,
        Self::Dropout,
        Self::Saturated,
        Self::Drift,
        Self::RateConflict,
        Self::Standstill,
        Self::TimeColumn,
        Self::LeftOut,
    ];

    /// Short name, as used in result columns and case files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NoData => "no-data",
            Self::Dead => "dead",
            Self::Gap => "gap",
            Self::Clipped => "clipped",
            Self::Dropout => "dropout",
            Self::Saturated => "saturated",
            Self::Drift => "drift",
            Self::RateConflict => "rate-conflict",
            Self::Standstill => "standstill",
            Self::TimeColumn => "time-column",
            Self::LeftOut => "left-out",
        }
    }
}

/// A flaw that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Which.
    pub flaw: Flaw,
    /// Whether indicators must not be judged because of it.
    pub blocks: bool,
    /// What was seen, with numbers.
    pub detail: String,
}

/// Runs of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Runs {
    /// Number of runs.
    pub count: usize,
    /// Samples in all of them.
    pub samples: usize,
    /// Samples of the longest.
    pub longest: usize,
    /// First sample of the first.
    pub first: Option<usize>,
}

impl Runs {
    fn add(&mut self, start: usize, length: usize) {
        self.join(Self { count: 1, samples: length, longest: length, first: Some(start) });
    }

    fn join(&mut self, other: Self) {
        self.count += other.count;
        self.samples += other.samples;
        self.longest = self.longest.max(other.longest);
        self.first = match (self.first, other.first) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
    }
}

/// What a channel looks like.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelQuality {
    /// Samples seen.
    pub samples: usize,
    /// Runs of NaN or infinite samples.
    pub gaps: Runs,
    /// Flat tops at the maximum or the minimum.
    pub clipped: Runs,
    /// Runs of equal samples elsewhere.
    pub dropouts: Runs,
    /// Smallest and largest finite sample; `None` when there is none.
    pub range: Option<(f64, f64)>,
    /// Step of the converter, where the differences of neighbours are multiples of one.
    pub step: Option<f64>,
    /// Range of the means of eighths of the record over the typical RMS; `None` for short or constant records.
    pub drift: Option<f64>,
    /// Largest offset of a stretch over the typical RMS, where less than a quarter of the stretches are that far off.
    pub overload: Option<f64>,
}

impl ChannelQuality {
    /// Of a whole signal.
    #[must_use]
    pub fn of(signal: &[f64]) -> Self {
        let mut monitor = ChannelMonitor::default();
        monitor.push(signal);
        monitor.finish()
    }

    /// Every finite sample has the same value.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.range.is_some_and(|(low, high)| low >= high)
    }

    /// No flaw, and not empty.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.samples > 0 && self.findings().is_empty()
    }

    /// The flaws, the gravest first.
    #[must_use]
    pub fn findings(&self) -> Vec<Finding> {
        let mut found = Vec::new();
        let total = self.samples.max(1) as f64;
        let share = |runs: &Runs| runs.samples as f64 / total;
        let percent = |runs: &Runs| 100.0 * share(runs);
        let mut add = |flaw, blocks, detail| found.push(Finding { flaw, blocks, detail });
        let Some((low, high)) = self.range else {
            add(Flaw::NoData, true, format!("none of {} samples is a number", self.samples));
            return found;
        };
        if low >= high {
            add(Flaw::Dead, true, format!("every sample is {low}"));
        } else if let Some(step) = self.step.filter(|step| high - low <= 3.01 * step) {
            add(Flaw::Dead, true, format!("at most four levels, {step} apart: the range of the converter is not used"));
        }
        let first = |runs: &Runs| runs.first.unwrap_or(0) + 1;
        if self.clipped.count > 0 {
            let (runs, at) = (&self.clipped, first(&self.clipped));
            let detail = format!(
                "{} samples ({:.2e} %) in {} flat tops at {low} or {high}, from sample {at} on",
                runs.samples,
                percent(runs),
                runs.count
            );
            add(Flaw::Clipped, share(runs) > MAX_CLIPPED_SHARE, detail);
        }
        if let Some(off) = self.overload {
            add(Flaw::Saturated, true, format!("the mean of a stretch is {off:.1} times the RMS off: an overload"));
        }
        if self.dropouts.count > 0 {
            let (runs, at) = (&self.dropouts, first(&self.dropouts));
            let detail = format!(
                "{} samples in {} stretches of one value, the longest {} samples, from sample {at} on",
                runs.samples, runs.count, runs.longest
            );
            add(Flaw::Dropout, share(runs) > MAX_DROPOUT_SHARE, detail);
        }
        if self.gaps.count > 0 {
            let (runs, at) = (&self.gaps, first(&self.gaps));
            let detail = format!(
                "{} samples missing ({:.2e} %) in {} gaps, the longest {} samples, from sample {at} on",
                runs.samples,
                percent(runs),
                runs.count,
                runs.longest
            );
            add(Flaw::Gap, share(runs) > MAX_MISSING_SHARE, detail);
        }
        if let Some(drift) = self.drift.filter(|drift| *drift > DRIFT) {
            add(Flaw::Drift, drift > MAX_DRIFT, format!("the mean wanders by {drift:.1} times the RMS"));
        }
        found.sort_by_key(|finding| !finding.blocks);
        found
    }
}

/// Flat tops at an extreme so far.
#[derive(Debug, Clone, Default)]
struct Extreme {
    value: Option<f64>,
    clipped: Runs,
    /// Runs long enough for a dropout, should the value not stay the extreme.
    long: Runs,
}

/// A stretch of the record.
#[derive(Debug, Clone, Copy, Default)]
struct Stretch {
    count: usize,
    mean: f64,
    squares: f64,
}

impl Stretch {
    fn joined(self, other: Self) -> Self {
        let count = self.count + other.count;
        if count == 0 {
            return self;
        }
        let (n_a, n_b, n) = (self.count as f64, other.count as f64, count as f64);
        let off = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + off * n_b / n,
            squares: self.squares + other.squares + off * off * n_a * n_b / n,
        }
    }
}

/// The stretch that is being filled: sums about its first sample.
#[derive(Debug, Clone, Copy, Default)]
struct OpenStretch {
    count: usize,
    about: f64,
    sum: f64,
    squares: f64,
    /// Samples, missing ones included.
    samples: usize,
}

impl OpenStretch {
    fn closed(self) -> Stretch {
        let n = self.count.max(1) as f64;
        let off = self.sum / n;
        Stretch { count: self.count, mean: self.about + off, squares: (self.squares - off * self.sum).max(0.0) }
    }
}

/// A run of equal samples.
#[derive(Debug, Clone, Copy)]
struct Run {
    value: f64,
    start: usize,
    length: usize,
    /// Size of the step into it.
    into: f64,
}

/// Differences of neighbours: their greatest common divisor is the step of the converter.
#[derive(Debug, Clone, Copy, Default)]
struct Steps {
    divisor: f64,
    largest: f64,
    seen: usize,
}

impl Steps {
    fn see(&mut self, difference: f64) {
        if self.seen >= STEPS_SEEN {
            return;
        }
        self.seen += 1;
        self.largest = self.largest.max(difference);
        // Euclid's algorithm, to rounding.
        let tolerance = 1e-10 * self.largest;
        let (mut a, mut b) = (self.divisor.max(difference), self.divisor.min(difference));
        while b > tolerance {
            (a, b) = (b, (a - b * (a / b).round()).abs());
        }
        self.divisor = a;
    }

    /// Step of the converter; `None` where the samples are no multiples of one.
    fn converter(&self) -> Option<f64> {
        Some(self.divisor).filter(|step| *step > 1e-8 * self.largest)
    }
}

/// Differences that say whether a channel has steps.
const STEPS_SEEN: usize = 4096;

/// Looks a channel over as it arrives. The outcome does not depend on how it is cut into pieces.
#[derive(Debug, Clone)]
pub struct ChannelMonitor {
    samples: usize,
    gaps: Runs,
    gap: usize,
    run: Option<Run>,
    high: Extreme,
    low: Extreme,
    dropouts: Runs,
    steps: Steps,
    stretches: Vec<Stretch>,
    /// Samples of a whole stretch, missing ones included.
    length: usize,
    open: OpenStretch,
}

impl Default for ChannelMonitor {
    fn default() -> Self {
        Self {
            samples: 0,
            gaps: Runs::default(),
            gap: 0,
            run: None,
            high: Extreme::default(),
            low: Extreme::default(),
            dropouts: Runs::default(),
            steps: Steps::default(),
            stretches: Vec::new(),
            length: STRETCH,
            open: OpenStretch::default(),
        }
    }
}

impl ChannelMonitor {
    /// Takes the next samples.
    pub fn push(&mut self, samples: &[f64]) {
        let mut rest = samples;
        while !rest.is_empty() {
            let (part, after) = rest.split_at(rest.len().min(self.length - self.open.samples));
            rest = after;
            for &x in part {
                if x.is_finite() {
                    self.finite(x);
                } else {
                    self.end_run(0.0);
                    self.gap += 1;
                }
                self.samples += 1;
            }
            self.open.samples += part.len();
            if self.open.samples == self.length {
                self.close_stretch();
            }
        }
    }

    #[inline]
    fn finite(&mut self, x: f64) {
        if self.gap > 0 {
            self.gaps.add(self.samples - self.gap, self.gap);
            self.gap = 0;
        }
        if self.open.count == 0 {
            self.open.about = x;
        }
        let off = x - self.open.about;
        self.open.count += 1;
        self.open.sum += off;
        self.open.squares += off * off;
        let into = match &mut self.run {
            Some(run) if run.value == x => {
                run.length += 1;
                return;
            }
            Some(run) => {
                let edge = (x - run.value).abs();
                self.steps.see(edge);
                self.end_run(edge);
                edge
            }
            None => 0.0,
        };
        self.run = Some(Run { value: x, start: self.samples, length: 1, into });
    }

    /// Ends the present run; `out` is the step out of it.
    #[inline]
    fn end_run(&mut self, out: f64) {
        let Some(Run { value, start, length, into }) = self.run.take() else { return };
        let passes = |extreme: &Extreme, sign: f64| extreme.value.is_none_or(|v| sign * value > sign * v);
        for (high, passed) in [(true, passes(&self.high, 1.0)), (false, passes(&self.low, -1.0))] {
            if passed {
                let extreme = if high { &mut self.high } else { &mut self.low };
                self.dropouts.join(extreme.long);
                *extreme = Extreme { value: Some(value), ..Extreme::default() };
            }
        }
        if length >= CLIP_RUN {
            self.end_long_run(value, start, length, into.max(out));
        }
    }

    fn end_long_run(&mut self, value: f64, start: usize, length: usize, edge: f64) {
        // What rounding can make of a smooth peak.
        let spread = (length + 1) as f64 / (length - 1) as f64;
        let rounding = self.steps.converter().unwrap_or(0.0) * (spread * spread + 1.0);
        let mut inside = true;
        for extreme in [&mut self.high, &mut self.low] {
            if extreme.value == Some(value) {
                inside = false;
                if edge > rounding * (1.0 + 1e-9) {
                    extreme.clipped.add(start, length);
                }
                if length >= DROPOUT_RUN {
                    extreme.long.add(start, length);
                }
            }
        }
        if inside && length >= DROPOUT_RUN {
            self.dropouts.add(start, length);
        }
    }

    fn close_stretch(&mut self) {
        self.stretches.push(std::mem::take(&mut self.open).closed());
        if self.stretches.len() == MAX_STRETCHES {
            self.stretches = self.stretches.chunks(2).map(|pair| pair[0].joined(pair[1])).collect();
            self.length *= 2;
        }
    }

    /// What was seen.
    #[must_use]
    pub fn finish(mut self) -> ChannelQuality {
        if self.gap > 0 {
            self.gaps.add(self.samples - self.gap, self.gap);
        }
        self.end_run(0.0);
        let range = self.low.value.zip(self.high.value);
        let constant = range.is_none_or(|(low, high)| low >= high);
        let (mut clipped, mut dropouts) = (Runs::default(), self.dropouts);
        if !constant {
            clipped.join(self.low.clipped);
            clipped.join(self.high.clipped);
        } else {
            dropouts = Runs::default();
        }
        let (drift, overload) = if constant { (None, None) } else { wandering(&self.stretches) };
        ChannelQuality {
            samples: self.samples,
            gaps: self.gaps,
            clipped,
            dropouts,
            range,
            step: self.steps.converter(),
            drift,
            overload,
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Drift and overload of the stretches of a record.
fn wandering(stretches: &[Stretch]) -> (Option<f64>, Option<f64>) {
    let usable: Vec<&Stretch> = stretches.iter().filter(|s| s.count > 0).collect();
    if usable.len() < MIN_STRETCHES {
        return (None, None);
    }
    let middle = median(usable.iter().map(|s| s.mean).collect());
    let about = |s: &&Stretch| (s.squares / s.count as f64 + (s.mean - middle).powi(2)).sqrt();
    let typical = median(usable.iter().map(about).collect());
    if !(typical > 0.0 && typical.is_finite()) {
        return (None, None);
    }
    let eighths = usable.chunks(usable.len().div_ceil(8)).map(|part| {
        let sum = part.iter().fold(Stretch::default(), |sum, s| sum.joined(**s));
        sum.mean
    });
    let (low, high) =
        eighths.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mean| (low.min(mean), high.max(mean)));
    let within = median(usable.iter().map(|s| (s.squares / s.count as f64).sqrt()).collect());
    let drift = (high - low) / within;
    let off: Vec<f64> =
        usable.iter().map(|s| (s.mean - middle).abs() / typical).filter(|off| *off > SATURATION).collect();
    let overload =
        (!off.is_empty() && 4 * off.len() < usable.len()).then(|| off.iter().copied().fold(0.0_f64, f64::max));
    (drift.is_finite().then_some(drift), overload)
}
