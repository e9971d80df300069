//! Condition indicators: single functions, and tables of all of them.
//!
//! Single functions are in [`basic`] (any signal), [`gear`] (mesh order known) and [`trend`]
//! (several records). This module lists them as data ([`Indicator`]: name, formula, source, input,
//! value for Gaussian noise) and computes tables.
//!
//! A table entry is a value or the reason why there is none; no entry is ever NaN.
//! Verified by `tests/indicators.rs`.

pub mod basic;
pub mod gear;
pub mod trend;

use crate::difference::{RemovalRule, SignalSet, SplitBuffers, Splitter};
use crate::envelope::{AnalyticBuffers, band_analytic_into, moduli_into};
use crate::error::{HumsError, Result, require_finite};
use crate::moments::{MomentAccumulator, Moments};
use basic::{CrestDefinition, Ends, TeagerAccumulator};
use gear_numerics::fft::{Fft, complex_inverse};
use std::sync::Arc;

/// Which signal an indicator was computed from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SignalKind {
    /// As recorded.
    Raw,
    /// Time-synchronous average.
    Average,
    /// Average without mesh harmonics.
    Residual,
    /// Residual without sidebands.
    Difference,
    /// Damaged minus healthy.
    ExactDifference,
    /// Average minus difference.
    Regular,
    /// Amplitude modulation of the band about the mesh fundamental.
    MeshEnvelope,
}

impl SignalKind {
    /// Whether the signal is one period of something periodic; a record as it was taken is not.
    fn ends(self) -> Ends {
        if self == Self::Raw { Ends::Open } else { Ends::Cyclic }
    }

    /// Short name, as used in result columns.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Average => "tsa",
            Self::Residual => "residual",
            Self::Difference => "difference",
            Self::ExactDifference => "exact_difference",
            Self::Regular => "regular",
            Self::MeshEnvelope => "mesh_envelope",
        }
    }
}

macro_rules! indicators {
    ($($(#[$doc:meta])* $variant:ident, $name:literal, $formula:literal, $unit:expr, $gauss:expr;)*) => {
        /// The indicators of this crate.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Indicator { $($(#[$doc])* $variant,)* }

        impl Indicator {
            /// All of them, in the order of the tables.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Short name, as used in result columns.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Formula in plain text; x samples, m mean, s standard deviation, A(k) amplitude at
            /// order k, z mesh order.
            #[must_use]
            pub fn formula(self) -> &'static str {
                match self { $(Self::$variant => $formula,)* }
            }

            /// The value has the signal's unit (otherwise it is dimensionless).
            #[must_use]
            pub fn has_signal_unit(self) -> bool {
                match self { $(Self::$variant => $unit,)* }
            }

            /// Value for white Gaussian noise where it is independent of mean and variance: the
            /// nominal threshold.
            #[must_use]
            pub fn gaussian_value(self) -> Option<f64> {
                match self { $(Self::$variant => $gauss,)* }
            }
        }
    };
}

indicators! {
    /// Arithmetic mean.
    Mean, "mean", "1/N sum x", true, None;
    /// Root mean square; on the difference signal, "RMS difference".
    Rms, "rms", "sqrt(1/N sum x^2)", true, None;
    /// Largest absolute value.
    Peak, "peak", "max |x|", true, None;
    /// Largest minus smallest value.
    PeakToPeak, "peak_to_peak", "max x - min x", true, None;
    /// Crest factor of the absolute peak.
    CrestFactor, "crest_factor", "max |x| / rms", false, None;
    /// Crest factor of the peak to peak.
    CrestFactorPeakToPeak, "crest_factor_peak_to_peak", "(max x - min x) / rms", false, None;
    /// Crest factor of the maximum.
    CrestFactorMaximum, "crest_factor_maximum", "max x / rms", false, None;
    /// Third standardised moment.
    Skewness, "skewness", "1/N sum (x-m)^3 / s^3", false, Some(0.0);
    /// Fourth standardised moment.
    Kurtosis, "kurtosis", "1/N sum (x-m)^4 / s^4", false, Some(3.0);
    /// Kurtosis of the Teager energy.
    EnergyOperator, "energy_operator", "kurtosis of x_i^2 - x_(i+1) x_(i-1)", false, Some(9.0);
    /// Peak to peak over the sum of mesh amplitudes.
    Fm0, "fm0", "(max x - min x) / sum_h A(h z)", false, None;
    /// Kurtosis of the difference signal.
    Fm4, "fm4", "1/N sum (d-m)^4 / s^4", false, Some(3.0);
    /// Sixth standardised moment of the difference signal.
    M6a, "m6a", "1/N sum (d-m)^6 / s^6", false, Some(15.0);
    /// Eighth standardised moment of the difference signal.
    M8a, "m8a", "1/N sum (d-m)^8 / s^8", false, Some(105.0);
    /// Quasi-normalised kurtosis of the residual signal (one record here; see [`trend`]).
    Na4, "na4", "1/N sum (r-m)^4 / (mean over records of s^2)^2", false, Some(3.0);
    /// Quasi-normalised kurtosis of the mesh envelope (one record here; see [`trend`]).
    Nb4, "nb4", "1/N sum (e-m)^4 / (mean over records of s^2)^2", false, None;
    /// Standard deviation of difference over regular signal.
    EnergyRatio, "energy_ratio", "s(d) / s(regular)", false, None;
    /// Mean amplitude of the first sideband pair.
    SidebandIndex, "sideband_index", "[A(z-1) + A(z+1)] / 2", true, None;
    /// First sideband pair over the standard deviation.
    SidebandLevelFactor, "sideband_level_factor", "[A(z-1) + A(z+1)] / s", false, None;
    /// Six sideband pairs over the mesh amplitude.
    SidebandEnergyRatio, "sideband_energy_ratio", "sum_(i=1..6) [A(z-i) + A(z+i)] / A(z)", false, None;
}

/// One line of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What.
    pub indicator: Indicator,
    /// From which signal.
    pub signal: SignalKind,
    /// The value, or why there is none.
    pub value: Result<f64>,
}

/// The indicators that need only samples, of any signal: mean to energy operator, and for
/// difference signals FM4, M6A and M8A in place of the kurtosis.
///
/// # Errors
/// Empty or non-finite signal; a quantity undefined for this signal is an `Err` in its entry.
pub fn signal_indicators(signal: &[f64], kind: SignalKind) -> Result<Vec<Entry>> {
    let moments = Moments::of(signal)?;
    Ok(statistics(signal, &moments, kind))
}

/// [`signal_indicators`] of a raw record that arrives in pieces: memory does not grow with it.
///
/// Samples that are NaN or infinite are left out and counted ([`Self::missing`]): moments and extremes are those of the
/// finite samples, the energy operator takes triples without a gap. The values have the same bits however the record is cut.
#[derive(Debug, Clone)]
pub struct StreamingIndicators {
    moments: MomentAccumulator,
    missing: usize,
    /// The first fault of the energy operator (its squares can leave the range of `f64`) is kept
    /// for its entry.
    energy: Result<TeagerAccumulator>,
}

impl StreamingIndicators {
    /// For samples whose absolute values are of the order of `peak` (unit of the signal); only its
    /// order of magnitude matters, and only outside 1e-18 to 1e18.
    #[must_use]
    pub fn new(peak: f64) -> Self {
        let energy = Ok(TeagerAccumulator::with_peak(peak, Ends::Open));
        Self { moments: MomentAccumulator::with_peak(peak), missing: 0, energy }
    }

    /// Samples left out so far.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// Takes the next samples.
    ///
    /// # Errors
    /// [`HumsError::OutOfRange`] when a sum leaves the range of `f64`; the accumulator is not usable afterwards.
    pub fn push(&mut self, samples: &[f64]) -> Result<()> {
        if require_finite("indicators", samples).is_ok() {
            return self.push_finite(samples);
        }
        for (k, part) in samples.split(|x| !x.is_finite()).enumerate() {
            if k > 0 {
                self.missing += 1;
                if let Ok(energy) = &mut self.energy {
                    energy.interrupt();
                }
            }
            self.push_finite(part)?;
        }
        Ok(())
    }

    fn push_finite(&mut self, samples: &[f64]) -> Result<()> {
        self.moments.push(samples)?;
        if let Ok(energy) = &mut self.energy
            && let Err(fault) = energy.push(samples)
        {
            self.energy = Err(fault);
        }
        Ok(())
    }

    /// The table.
    ///
    /// # Errors
    /// [`HumsError::TooShort`] when nothing finite was pushed.
    pub fn finish(self) -> Result<Vec<Entry>> {
        let moments = self.moments.finish()?;
        let energy = self.energy.and_then(|e| e.finish(moments.peak()));
        // Faults of derived samples are faults of range here: the samples themselves are finite.
        let energy = energy.map_err(|fault| match fault {
            HumsError::NotFinite { .. } => HumsError::OutOfRange { what: "energy operator" },
            other => other,
        });
        Ok(table_of(&moments, energy, SignalKind::Raw))
    }
}

fn statistics(signal: &[f64], moments: &Moments, kind: SignalKind) -> Vec<Entry> {
    let energy = basic::energy_operator_scaled(signal, moments.peak(), kind.ends());
    table_of(moments, energy, kind)
}

fn table_of(moments: &Moments, energy: Result<f64>, kind: SignalKind) -> Vec<Entry> {
    let entry = |indicator, value| Entry { indicator, signal: kind, value };
    let crest = |definition| basic::crest_factor_of(moments, definition);
    let mut table = vec![
        entry(Indicator::Mean, Ok(moments.mean())),
        entry(Indicator::Rms, Ok(moments.rms())),
        entry(Indicator::Peak, Ok(moments.peak())),
        entry(Indicator::PeakToPeak, basic::peak_to_peak_of(moments)),
        entry(Indicator::CrestFactor, crest(CrestDefinition::AbsolutePeak)),
        entry(Indicator::CrestFactorPeakToPeak, crest(CrestDefinition::PeakToPeak)),
        entry(Indicator::CrestFactorMaximum, crest(CrestDefinition::Maximum)),
        entry(Indicator::Skewness, moments.standardized(3)),
    ];
    if matches!(kind, SignalKind::Difference | SignalKind::ExactDifference) {
        table.push(entry(Indicator::Fm4, moments.standardized(4)));
        table.push(entry(Indicator::M6a, moments.standardized(6)));
        table.push(entry(Indicator::M8a, moments.standardized(8)));
    } else {
        table.push(entry(Indicator::Kurtosis, moments.standardized(4)));
    }
    table.push(entry(Indicator::EnergyOperator, energy));
    table
}

/// All indicators of synchronous averages of one length; transforms are planned once.
#[derive(Clone)]
pub struct GearAnalyzer {
    splitter: Splitter,
    inverse: Arc<dyn Fft<f64>>,
}

impl std::fmt::Debug for GearAnalyzer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GearAnalyzer").field("splitter", &self.splitter).finish_non_exhaustive()
    }
}

/// What [`GearAnalyzer::analyze`] finds.
#[derive(Debug, Clone, PartialEq)]
pub struct GearAnalysis {
    /// All entries; gear indicators after the statistics of each signal.
    pub table: Vec<Entry>,
    /// The signals behind them.
    pub signals: SignalSet,
    /// Envelope of the mesh band; `None` when the band does not fit (the reason is in NB4's entry).
    pub mesh_envelope: Option<Vec<f64>>,
}

impl GearAnalysis {
    /// The entry's value.
    ///
    /// # Errors
    /// The reason in the entry, or [`HumsError::Undefined`] when the table has no such entry.
    pub fn value(&self, indicator: Indicator, signal: SignalKind) -> Result<f64> {
        self.table.iter().find(|e| e.indicator == indicator && e.signal == signal).map_or(
            Err(HumsError::Undefined { what: indicator.name(), reason: "it is not computed for this kind of signal" }),
            |e| e.value.clone(),
        )
    }
}

/// Room for an analysis that is used again and again: averages of tens of thousands of samples then cost no
/// new memory.
#[derive(Debug, Clone)]
pub struct GearWorkspace {
    analysis: GearAnalysis,
    split: SplitBuffers,
    analytic: AnalyticBuffers,
    /// The envelope's memory while an analysis has none.
    envelope: Vec<f64>,
}

impl Default for GearWorkspace {
    fn default() -> Self {
        Self {
            analysis: GearAnalysis { table: Vec::new(), signals: SignalSet::empty(), mesh_envelope: None },
            split: SplitBuffers::default(),
            analytic: AnalyticBuffers::default(),
            envelope: Vec::new(),
        }
    }
}

impl GearAnalyzer {
    /// For averages of `samples` samples; the first mesh order of the rule is the gear's own, used
    /// by FM0, the sideband indicators and NB4.
    ///
    /// # Errors
    /// As [`Splitter::new`].
    pub fn new(samples: usize, rule: &RemovalRule) -> Result<Self> {
        Ok(Self { splitter: Splitter::new(samples, rule)?, inverse: complex_inverse(samples) })
    }

    /// All indicators of an average.
    ///
    /// # Errors
    /// As [`Splitter::split`]; a quantity undefined for this signal is an `Err` in its entry.
    pub fn analyze(&self, average: &[f64]) -> Result<GearAnalysis> {
        let mut workspace = GearWorkspace::default();
        self.analyze_with(average, &mut workspace)?;
        Ok(workspace.analysis)
    }

    /// As [`Self::analyze`], bit for bit, in memory that earlier analyses used.
    ///
    /// # Errors
    /// As [`Self::analyze`].
    pub fn analyze_with<'w>(&self, average: &[f64], workspace: &'w mut GearWorkspace) -> Result<&'w GearAnalysis> {
        let GearWorkspace { analysis, split, analytic, envelope: spare } = workspace;
        let GearAnalysis { table, signals, mesh_envelope } = analysis;
        self.splitter.split_into(average, split, signals)?;
        let rule = self.splitter.rule();
        let (mesh, spacing) = (rule.mesh_orders[0], rule.sideband_spacing.max(1));
        let of_average = Moments::of(average)?;
        let of_residual = Moments::of(&signals.residual)?;
        let of_difference = Moments::of(&signals.difference)?;
        let of_regular = Moments::of(&signals.regular)?;
        if let Some(last) = mesh_envelope.take() {
            *spare = last;
        }
        // Band about the mesh fundamental that reaches half way to its neighbours.
        let (bins, samples) = (signals.spectrum.bins(), signals.spectrum.samples());
        let band = band_analytic_into(bins, samples, mesh, mesh / 2, self.inverse.as_ref(), analytic);
        let envelope = band.map(|()| {
            moduli_into(&analytic.z, spare);
            std::mem::take(spare)
        });

        table.clear();
        table.extend(statistics(average, &of_average, SignalKind::Average));
        let mut gear = |indicator, signal, value| {
            table.push(Entry { indicator, signal, value });
        };
        let spectrum = &signals.spectrum;
        let average_kind = SignalKind::Average;
        gear(Indicator::Fm0, average_kind, gear::fm0(&of_average, spectrum, mesh, rule.harmonics));
        gear(Indicator::SidebandIndex, average_kind, gear::sideband_index(spectrum, mesh, spacing));
        gear(
            Indicator::SidebandLevelFactor,
            average_kind,
            gear::sideband_level_factor(&of_average, spectrum, mesh, spacing),
        );
        gear(Indicator::SidebandEnergyRatio, average_kind, gear::sideband_energy_ratio(spectrum, mesh, spacing));
        gear(
            Indicator::Na4,
            SignalKind::Residual,
            unless_rounding(&of_residual, &of_average).and_then(|m| m.standardized(4)),
        );
        gear(
            Indicator::Nb4,
            SignalKind::MeshEnvelope,
            envelope.as_ref().map_err(Clone::clone).and_then(|e| {
                let moments = Moments::of(e)?;
                unless_rounding(&moments, &of_average).and_then(|m| m.standardized(4))
            }),
        );
        gear(Indicator::EnergyRatio, SignalKind::Difference, gear::energy_ratio(&of_difference, &of_regular));
        match unless_rounding(&of_difference, &of_average) {
            Ok(moments) => {
                table.extend(statistics(&signals.difference, moments, SignalKind::Difference));
            }
            Err(reason) => {
                let rest = statistics(&signals.difference, &of_difference, SignalKind::Difference);
                table.extend(rest.into_iter().map(|mut entry| {
                    if !entry.indicator.has_signal_unit() {
                        entry.value = Err(reason.clone());
                    }
                    entry
                }));
            }
        }
        *mesh_envelope = envelope.ok();
        Ok(analysis)
    }
}

/// Ratios of moments of what is left after removing everything are ratios of rounding errors of
/// the transform: they have a value, but no meaning, so they get a reason instead.
fn unless_rounding<'a>(part: &'a Moments, whole: &Moments) -> Result<&'a Moments> {
    if part.standard_deviation() <= 64.0 * f64::EPSILON * whole.peak() {
        Err(HumsError::Undefined {
            what: "standardised moment",
            reason: "the signal vanishes to rounding once the regular orders are removed",
        })
    } else {
        Ok(part)
    }
}
