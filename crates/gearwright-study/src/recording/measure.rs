//! One recording: indicators of the raw channels, synchronous averages, indicators of those. Memory is bounded by a block of samples and an
//! averaging period of each channel.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use hums::HumsError;
use hums::difference::{RemovalRule, Splitter};
use hums::indicator::{Entry, GearAnalysis, GearAnalyzer, Indicator, SignalKind, StreamingIndicators};
use hums::moments::Moments;
use hums::quality::{ChannelMonitor, Finding, Flaw};
use hums::resample::samples_per_period;
use hums::tachometer::Shaft;
use hums::threshold::gaussian_standard_error;
use hums::tsa::{Average, Averager, TsaOptions};
use rayon::prelude::*;

use super::error::RecordingError;
use super::source::{Layout, Progress, check_memory, each_block, layout};
use super::turning::turning;
use gearwright_case::recording::RecordingCase;
use gearwright_results::recording::{Averaged, Channel, Convention, Detail, Measured, Row};

/// Samples of the first period kept for the plot at most.
const SHOWN: usize = 1 << 18;

/// Sideband pairs and shaft orders that are compared.
const CONVENTIONS: [(usize, usize); 6] = [(0, 0), (1, 0), (2, 0), (0, 2), (1, 2), (2, 2)];

/// Shape indicators of one average by the usual difference signals, and by the case's own.
fn conventions(average: &[f64], rule: &RemovalRule) -> Vec<Convention> {
    let own = (rule.sideband_pairs, rule.shaft_orders);
    let mut all = CONVENTIONS.to_vec();
    if !all.contains(&own) {
        all.push(own);
    }
    let indicators = |(sideband_pairs, shaft_orders): (usize, usize)| {
        let rule = RemovalRule { sideband_pairs, shaft_orders, ..rule.clone() };
        let set = Splitter::new(average.len(), &rule).and_then(|splitter| splitter.split(average));
        let moments = set.and_then(|set| Moments::of(&set.difference));
        let orders = [4, 6, 8].map(|p| {
            moments.as_ref().map_err(ToString::to_string).and_then(|m| m.standardized(p).map_err(|e| e.to_string()))
        });
        Convention { sideband_pairs, shaft_orders, chosen: own == (sideband_pairs, shaft_orders), values: orders }
    };
    all.into_iter().map(indicators).collect()
}

/// Measures a recording; `keep` its signals.
///
/// # Errors
/// Anything that leaves no channel with an average.
pub fn measure(
    file: &Path,
    case: &RecordingCase,
    progress: &Progress<'_>,
    keep: bool,
) -> Result<Measured, RecordingError> {
    let layout = layout(file, case)?;
    let (angles, channels) = (case.inputs.signal.angles_deg.len(), layout.judged.len());
    if angles > 0 && angles != channels {
        let known = layout.judged.iter().map(|(_, name)| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        return Err(RecordingError::Angles { path: file.into(), angles, channels, known });
    }
    let turning = turning(file, case, &layout, progress)?;
    let shaft = Arc::new(turning.shaft);
    let plan = Plan::new(file, case, &layout, &shaft)?;
    check_memory(file, channels, plan.samples_per_period as f64)?;
    let mut tracks: Vec<Track> = layout.judged.iter().map(|_| Track::new(&plan)).collect();
    let (samples, time_gaps) = each_block(file, case, &layout, progress, |columns| {
        tracks.par_iter_mut().zip(&layout.judged).for_each(|(track, (column, _))| track.push(&columns[*column], &plan));
        Ok(())
    })?;
    let mut findings = layout.findings;
    findings.extend(turning.findings);
    if let Some(first) = time_gaps.first {
        let share = time_gaps.missing as f64 / samples.max(1) as f64;
        let detail = format!(
            "{} rows are missing from the time column in {} places, the longest {} rows, first after row {first}: gaps of all channels",
            time_gaps.missing, time_gaps.count, time_gaps.longest
        );
        let blocks = share > hums::quality::MAX_MISSING_SHARE;
        findings.push(Finding { flaw: Flaw::TimeColumn, blocks, detail });
    }
    let finished: Vec<(Channel, Option<HumsError>)> = tracks
        .into_par_iter()
        .zip(&layout.judged)
        .map(|(track, (_, name))| track.finish(name, case, &plan, &findings, keep))
        .collect();
    let no_period = |source| RecordingError::NoPeriod {
        path: file.into(),
        duration: samples as f64 / layout.rate,
        period: case.period_turns / shaft.speed_range().0,
        source,
    };
    if finished.iter().all(|(channel, _)| channel.average.is_err())
        && let Some(fault) = finished.iter().find_map(|(_, fault)| fault.clone())
    {
        return Err(no_period(fault));
    }
    Ok(Measured {
        name: file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        rate: layout.rate,
        samples,
        speed: shaft.speed_range(),
        pulses: turning.pulses,
        findings,
        channels: finished.into_iter().map(|(channel, _)| channel).collect(),
    })
}

/// What the channels of a recording have in common.
struct Plan {
    averager: Averager,
    analyzer: GearAnalyzer,
    samples_per_period: usize,
    shaft: Arc<Shaft>,
    rate: f64,
    /// Turn at which the first period begins, and its samples.
    first_turn: f64,
    first_samples: Range<usize>,
    /// Independent samples in a difference signal: twice its spectral lines that carry noise.
    independent: usize,
}

impl Plan {
    fn new(file: &Path, case: &RecordingCase, layout: &Layout, shaft: &Arc<Shaft>) -> Result<Self, RecordingError> {
        let failed = |key| move |source| RecordingError::Parameter { path: file.into(), key, source };
        let (rate, period) = (layout.rate, case.period_turns);
        let (slowest, fastest) = shaft.speed_range();
        let mesh_order = case.rule.mesh_orders.first().copied().unwrap_or(1);
        let mesh = mesh_order as f64 / period * fastest;
        if 2.0 * mesh >= rate {
            return Err(RecordingError::MeshTooFast { path: file.into(), mesh, rate });
        }
        let samples_per_period = match case.inputs.average.samples {
            Some(samples) => samples as usize,
            None => samples_per_period(rate, shaft, period).map_err(failed("average.turns"))?,
        };
        let options = TsaOptions {
            samples_per_period,
            period_turns: period,
            max_blocks: case.inputs.average.max_periods.map(|count| count as usize),
            interpolation: case.interpolation,
        };
        let averager = Averager::new(rate, Arc::clone(shaft), options).map_err(failed("average.turns"))?;
        let analyzer = GearAnalyzer::new(samples_per_period, &case.rule).map_err(failed("average.samples"))?;
        // Orders above the Nyquist frequency of the recording carry nothing.
        let orders = (rate * period / slowest / 2.0).min(samples_per_period as f64 / 2.0) as usize;
        let removed = case.rule.difference_orders(samples_per_period);
        let carrying = orders.saturating_sub(removed.iter().filter(|order| **order <= orders).count());
        let start = shaft.turn_at(0.0).unwrap_or(shaft.turn_range().0);
        let first_turn = (start / period - 1e-9).ceil() * period;
        let at = |turn: f64| shaft.time_at(turn).map_or(0, |t| (t * rate).ceil().max(0.0) as usize);
        let first = at(first_turn);
        Ok(Self {
            averager,
            analyzer,
            samples_per_period,
            shaft: Arc::clone(shaft),
            rate,
            first_turn,
            first_samples: first..at(first_turn + period).min(first.saturating_add(SHOWN)),
            independent: 2 * carrying,
        })
    }
}

/// A channel on its way.
struct Track {
    quality: ChannelMonitor,
    raw: Option<StreamingIndicators>,
    raw_fault: Option<HumsError>,
    averager: Averager,
    first_period: Vec<f64>,
    samples: usize,
}

impl Track {
    fn new(plan: &Plan) -> Self {
        Self {
            quality: ChannelMonitor::default(),
            raw: None,
            raw_fault: None,
            averager: plan.averager.clone(),
            first_period: Vec::new(),
            samples: 0,
        }
    }

    fn push(&mut self, samples: &[f64], plan: &Plan) {
        self.quality.push(samples);
        if self.raw_fault.is_none() {
            // The first block tells the order of magnitude.
            let peak = || samples.iter().filter(|x| x.is_finite()).fold(0.0_f64, |m, x| m.max(x.abs()));
            let raw = self.raw.get_or_insert_with(|| StreamingIndicators::new(peak()));
            self.raw_fault = raw.push(samples).err();
        }
        let (from, to) = (self.samples, self.samples + samples.len());
        let wanted = plan.first_samples.start.max(from)..plan.first_samples.end.min(to);
        if wanted.start < wanted.end {
            self.first_period.extend_from_slice(&samples[wanted.start - from..wanted.end - from]);
        }
        self.samples = to;
        self.averager.push(samples);
    }

    fn finish(
        self,
        name: &str,
        case: &RecordingCase,
        plan: &Plan,
        of_recording: &[Finding],
        keep: bool,
    ) -> (Channel, Option<HumsError>) {
        let quality = self.quality.finish();
        let findings = quality.findings();
        let counts = |finding: &&Finding| finding.blocks && !case.accepted.contains(&finding.flaw);
        let blocked = of_recording.iter().chain(&findings).find(counts);
        let blocked = blocked.map(|finding| format!("{}: {}", finding.flaw.name(), finding.detail));
        let empty = HumsError::TooShort { what: "indicators", needed: 1, found: 0 };
        let raw = match (self.raw, self.raw_fault) {
            (_, Some(fault)) => Err(fault),
            (Some(raw), None) => raw.finish(),
            (None, None) => Err(empty),
        };
        let mut rows: Vec<Row> = match raw {
            Ok(entries) => entries.iter().map(|entry| row(entry, plan)).collect(),
            Err(fault) => RAW.iter().map(|indicator| row(&without(*indicator, &fault), plan)).collect(),
        };
        let analysed = self.averager.finish().and_then(|average| {
            let analysis = plan.analyzer.analyze(&average.samples)?;
            Ok((average, analysis))
        });
        let fault = analysed.as_ref().err().cloned();
        let average = analysed.map_err(|fault| fault.to_string()).map(|(average, analysis)| {
            rows.extend(analysis.table.iter().map(|entry| row(entry, plan)));
            let shown = if keep { self.first_period } else { Vec::new() };
            averaged(average, analysis, case, plan, keep.then_some(shown))
        });
        (Channel { name: name.into(), missing: quality.gaps.samples, findings, blocked, rows, average }, fault)
    }
}

/// Indicators of a raw channel, for one that has none.
const RAW: [Indicator; 10] = [
    Indicator::Mean,
    Indicator::Rms,
    Indicator::Peak,
    Indicator::PeakToPeak,
    Indicator::CrestFactor,
    Indicator::CrestFactorPeakToPeak,
    Indicator::CrestFactorMaximum,
    Indicator::Skewness,
    Indicator::Kurtosis,
    Indicator::EnergyOperator,
];

fn without(indicator: Indicator, fault: &HumsError) -> Entry {
    Entry { indicator, signal: SignalKind::Raw, value: Err(fault.clone()) }
}

/// Gaussian limits make sense where regular vibration is removed: a healthy mesh is not Gaussian noise.
fn row(entry: &Entry, plan: &Plan) -> Row {
    let order = match (entry.indicator, entry.signal) {
        (Indicator::Fm4, SignalKind::Difference) | (Indicator::Na4, SignalKind::Residual) => Some(4),
        (Indicator::M6a, SignalKind::Difference) => Some(6),
        (Indicator::M8a, SignalKind::Difference) => Some(8),
        _ => None,
    };
    Row {
        indicator: entry.indicator.name(),
        signal: entry.signal.name(),
        value: entry.value.clone().map_err(|reason| reason.to_string()),
        nominal: entry.indicator.gaussian_value(),
        standard_error: order.and_then(|order| gaussian_standard_error(order, plan.independent).ok()),
    }
}

fn averaged(
    average: Average,
    analysis: GearAnalysis,
    case: &RecordingCase,
    plan: &Plan,
    first_period: Option<Vec<f64>>,
) -> Averaged {
    let envelope = analysis.mesh_envelope.as_ref().and_then(|envelope| Moments::of(envelope).ok());
    // A residual that vanishes to rounding has no NA4, hence none with a memory.
    let residual = analysis.value(Indicator::Na4, SignalKind::Residual).ok();
    let residual = residual.and_then(|_| Moments::of(&analysis.signals.residual).ok());
    let (periods, skipped) = (average.blocks, average.skipped);
    let (removed_rms, noise_floor) = (average.removed_rms(), average.noise_floor());
    let detail = first_period.map(|samples| {
        let first = plan.first_samples.start;
        let turn = |index: usize| plan.shaft.turn_at(index as f64 / plan.rate);
        let place = |k: usize| turn(first + k).map(|turn| (turn - plan.first_turn).clamp(0.0, case.period_turns));
        let amplitudes = analysis.signals.spectrum.amplitudes();
        let conventions = conventions(&average.samples, &case.rule);
        Detail {
            first_period: samples.iter().enumerate().filter_map(|(k, x)| Some((place(k)?, *x))).collect(),
            signals: [average.samples, analysis.signals.residual, analysis.signals.difference],
            amplitudes,
            conventions,
        }
    });
    Averaged { periods, skipped, removed_rms, noise_floor, memory: [residual, envelope], detail }
}
