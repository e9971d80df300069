//! Residual, difference and regular signals of a synchronous average.
//!
//! Problem. The regular mesh vibration hides the trace of a local fault, so its known orders are
//! removed: mesh harmonics (the *residual* signal), and some sidebands about each of them (the
//! *difference* signal). What is removed to make the difference is the *regular* signal.
//!
//! Method. Discrete Fourier transform of one period (or several whole ones), the chosen bins set to
//! zero, and back (Stewart 1977; D 5.4.2). All bins are exact orders.
//!
//! Conventions in use, as [`RemovalRule`] constructors:
//!
//! | rule | residual removes | difference removes as well |
//! |---|---|---|
//! | [`RemovalRule::sidebands`] (D 5.4.2, D 6.4.1) | mesh harmonics | k sideband pairs, k = 0 to 5 |
//! | [`RemovalRule::shaft_and_mesh`] | mesh harmonics, shaft orders 1 and 2, mean | first sideband pair |
//!
//! The second is the convention of most publications: regular meshing components are the shaft frequency and its harmonics, the mesh frequency
//! and its harmonics, and the first-order sidebands of these (Zakrajsek, Townsend and Decker 1993, NASA TM-105950; Lebold, McClintic, Campbell, Byington
//! and Maynard 2000, Proc. 54th MFPT; Vecer, Kreidl and Smid 2005, Acta Polytechnica 45(6):35). They do not say how many shaft harmonics; all of them
//! would be every bin of an average over one turn. Two, of unbalance and misalignment, are taken here.
//!
//! Setting bins to zero spreads the removed part of a local event over the whole period: the
//! "new steady-state vibrations" of D 5.4.2. The exact difference signal,
//! [`exact_difference`] (D 4.4, D 5.4.1), has no such trace but needs a healthy twin, so it exists
//! in simulation, or as difference from a recorded baseline.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | z (mesh cycles per record) | `mesh_orders` | cycles per record |
//! | k | `sideband_pairs` | - |
//! | spacing | `sideband_spacing` | cycles per record |
//!
//! Verified by `tests/difference.rs`: removal is a projection (idempotent, orthogonal, additive),
//! and equals a brute-force Fourier sum.

use crate::error::{HumsError, Result, require_finite, require_len};
use crate::spectrum::{Spectrum, require_in_range};
use gear_numerics::fft::{Complex, ComplexToReal, RealToComplex, real_forward, real_inverse};
use std::sync::Arc;

/// Which orders count as regular. Orders are cycles per record (per averaging period).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemovalRule {
    /// Mesh cycles per record of every mesh on the shaft; tooth number for one shaft revolution.
    pub mesh_orders: Vec<usize>,
    /// Highest mesh harmonic removed; `usize::MAX` for all up to the Nyquist order.
    pub harmonics: usize,
    /// Sideband pairs about every harmonic that the difference signal loses, k in `d^(k)`.
    pub sideband_pairs: usize,
    /// Distance between sidebands, cycles per record: 1 for sidebands at shaft order in a record of
    /// one revolution; the number of planets for planet-pass sidebands in a record of one carrier turn.
    pub sideband_spacing: usize,
    /// Shaft orders, 1 to this number times `sideband_spacing`, removed from residual and difference.
    pub shaft_orders: usize,
    /// Remove order 0 (the mean).
    pub remove_mean: bool,
}

impl RemovalRule {
    /// The dissertation's approximate difference signal `d^(k)`: all mesh harmonics and `k`
    /// sideband pairs one order apart; mean and shaft orders stay.
    #[must_use]
    pub fn sidebands(mesh_order: usize, k: usize) -> Self {
        Self {
            mesh_orders: vec![mesh_order],
            harmonics: usize::MAX,
            sideband_pairs: k,
            sideband_spacing: 1,
            shaft_orders: 0,
            remove_mean: false,
        }
    }

    /// The convention of most publications (see the module): mesh harmonics, shaft orders 1 and 2 and the mean
    /// leave the residual, first sidebands leave the difference.
    #[must_use]
    pub fn shaft_and_mesh(mesh_order: usize) -> Self {
        Self { shaft_orders: 2, remove_mean: true, ..Self::sidebands(mesh_order, 1) }
    }

    /// Orders the residual signal loses, sorted, each once, for a record of `samples` samples.
    #[must_use]
    pub fn residual_orders(&self, samples: usize) -> Vec<usize> {
        self.orders(samples, 0)
    }

    /// Orders the difference signal loses, sorted, each once.
    #[must_use]
    pub fn difference_orders(&self, samples: usize) -> Vec<usize> {
        self.orders(samples, self.sideband_pairs)
    }

    fn orders(&self, samples: usize, pairs: usize) -> Vec<usize> {
        let highest = samples / 2;
        let shaft = self.sideband_spacing.max(1);
        let mut removed: Vec<usize> = (1..=self.shaft_orders.min(highest / shaft)).map(|k| k * shaft).collect();
        if self.remove_mean {
            removed.push(0);
        }
        let reach = pairs.saturating_mul(self.sideband_spacing);
        for &mesh in &self.mesh_orders {
            // A harmonic above Nyquist can still have lower sidebands below it.
            for h in 1..=self.harmonics {
                let Some(centre) = mesh.checked_mul(h).filter(|c| *c <= highest + reach) else {
                    break;
                };
                if mesh == 0 {
                    break;
                }
                removed.push(centre);
                for j in 1..=pairs {
                    let offset = j * self.sideband_spacing;
                    removed.push(centre + offset);
                    removed.extend(centre.checked_sub(offset).filter(|order| *order > 0));
                }
            }
        }
        removed.retain(|order| *order <= highest);
        removed.sort_unstable();
        removed.dedup();
        removed
    }

    fn validate(&self, samples: usize) -> Result<()> {
        if self.mesh_orders.is_empty() || self.mesh_orders.contains(&0) {
            return Err(HumsError::Parameter {
                parameter: "mesh orders",
                value: 0.0,
                allowed: "at least one, each at least 1 cycle per record",
            });
        }
        if self.sideband_pairs > 0 && self.sideband_spacing == 0 {
            return Err(HumsError::Parameter {
                parameter: "sideband spacing",
                value: 0.0,
                allowed: "at least 1 cycle per record",
            });
        }
        match self.mesh_orders.iter().find(|z| **z > samples / 2) {
            Some(&order) => Err(HumsError::OrderNotResolved { order, highest: samples / 2, samples }),
            None => Ok(()),
        }
    }
}

/// Mesh order of a record from a ratio that may come out of floating-point arithmetic (for example
/// ring teeth per planet pass, 99 / 3).
///
/// # Errors
/// [`HumsError::Parameter`] unless the value is within 1e-6 of a whole number from 1 upward: a mesh
/// that does not repeat in the record has no exact bin, and a period that holds whole mesh cycles
/// (the carrier's, for instance) must be averaged instead.
pub fn whole_mesh_order(mesh_cycles_per_record: f64) -> Result<usize> {
    let rounded = mesh_cycles_per_record.round();
    if (mesh_cycles_per_record - rounded).abs() <= 1e-6 && (1.0..1e9).contains(&rounded) {
        Ok(rounded as usize)
    } else {
        Err(HumsError::Parameter {
            parameter: "mesh cycles per averaging period",
            value: mesh_cycles_per_record,
            allowed: "a whole number, at least 1; average over a period holding whole mesh cycles",
        })
    }
}

/// The signals that gear indicators start from; all of the average's length and unit.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalSet {
    /// Average without mesh harmonics (and shaft orders, mean: see the rule).
    pub residual: Vec<f64>,
    /// Residual without sidebands.
    pub difference: Vec<f64>,
    /// Average minus difference.
    pub regular: Vec<f64>,
    /// Spectrum of the average (rectangular window): amplitude at order k is bin k.
    pub spectrum: Spectrum,
}

impl SignalSet {
    pub(crate) fn empty() -> Self {
        Self { residual: Vec::new(), difference: Vec::new(), regular: Vec::new(), spectrum: Spectrum::empty() }
    }
}

/// Buffers of [`Splitter::split`] that survive it.
#[derive(Debug, Clone, Default)]
pub(crate) struct SplitBuffers {
    kept: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

/// Splits averages of one length by one rule; transforms are planned once.
#[derive(Clone)]
pub struct Splitter {
    rule: RemovalRule,
    residual_orders: Vec<usize>,
    difference_orders: Vec<usize>,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl std::fmt::Debug for Splitter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Splitter").field("rule", &self.rule).field("samples", &self.forward.len()).finish()
    }
}

impl Splitter {
    /// Prepares for averages of `samples` samples.
    ///
    /// # Errors
    /// Mesh orders that are zero, missing, or above the Nyquist order `samples / 2`.
    pub fn new(samples: usize, rule: &RemovalRule) -> Result<Self> {
        rule.validate(samples)?;
        Ok(Self {
            residual_orders: rule.residual_orders(samples),
            difference_orders: rule.difference_orders(samples),
            rule: rule.clone(),
            forward: real_forward(samples),
            inverse: real_inverse(samples),
        })
    }

    /// The rule in force.
    #[must_use]
    pub fn rule(&self) -> &RemovalRule {
        &self.rule
    }

    /// Splits an average.
    ///
    /// # Errors
    /// [`HumsError::LengthMismatch`] for another length than planned; non-finite samples.
    pub fn split(&self, average: &[f64]) -> Result<SignalSet> {
        let mut signals = SignalSet::empty();
        self.split_into(average, &mut SplitBuffers::default(), &mut signals)?;
        Ok(signals)
    }

    /// As [`Self::split`], into signals that may hold an earlier result, whose memory is used again.
    pub(crate) fn split_into(&self, average: &[f64], buffers: &mut SplitBuffers, out: &mut SignalSet) -> Result<()> {
        let n = self.forward.len();
        if average.len() != n {
            return Err(HumsError::LengthMismatch {
                what: "average and plan of the splitter",
                left: average.len(),
                right: n,
            });
        }
        require_finite("difference signal", average)?;
        let SplitBuffers { kept, scratch } = buffers;
        scratch.resize(self.forward.get_scratch_len().max(self.inverse.get_scratch_len()), Complex::new(0.0, 0.0));
        // The transform destroys its input, whose place the residual then takes.
        out.residual.clear();
        out.residual.extend_from_slice(average);
        let bins = out.spectrum.room(n);
        let outcome = self.forward.process_with_scratch(&mut out.residual, bins, scratch);
        debug_assert!(outcome.is_ok());
        require_in_range("spectrum of the average", bins)?;
        kept.clear();
        kept.extend_from_slice(bins);
        self.without(&self.residual_orders, kept, scratch, &mut out.residual);
        if self.rule.sideband_pairs == 0 {
            out.difference.clone_from(&out.residual);
        } else {
            kept.copy_from_slice(bins);
            out.difference.resize(n, 0.0);
            self.without(&self.difference_orders, kept, scratch, &mut out.difference);
        }
        out.regular.clear();
        out.regular.extend(average.iter().zip(&out.difference).map(|(x, d)| x - d));
        Ok(())
    }

    /// Signal of the bins without some orders, written over `out`; `kept` is used up.
    fn without(&self, orders: &[usize], kept: &mut [Complex<f64>], scratch: &mut [Complex<f64>], out: &mut [f64]) {
        let n = out.len();
        for &order in orders {
            kept[order] = Complex::new(0.0, 0.0);
        }
        // The transform of a real signal has real bins at DC and Nyquist; the inverse insists.
        kept[0].im = 0.0;
        if n % 2 == 0 {
            kept[n / 2].im = 0.0;
        }
        let outcome = self.inverse.process_with_scratch(kept, out, scratch);
        debug_assert!(outcome.is_ok());
        let scale = 1.0 / n as f64;
        out.iter_mut().for_each(|x| *x *= scale);
    }
}

/// Splits one average; see [`Splitter`] for many.
///
/// # Errors
/// As [`Splitter::new`] and [`Splitter::split`].
pub fn split(average: &[f64], rule: &RemovalRule) -> Result<SignalSet> {
    require_len("difference signal", average, 2)?;
    Splitter::new(average.len(), rule)?.split(average)
}

/// Exact difference signal `d = x_damaged - x_healthy` (D 4.4, D 5.4.1), unit of the signals.
///
/// # Errors
/// [`HumsError::LengthMismatch`]; non-finite samples; empty signals.
pub fn exact_difference(damaged: &[f64], healthy: &[f64]) -> Result<Vec<f64>> {
    const WHAT: &str = "exact difference signal";
    if damaged.len() != healthy.len() {
        return Err(HumsError::LengthMismatch { what: WHAT, left: damaged.len(), right: healthy.len() });
    }
    require_len(WHAT, damaged, 1)?;
    require_finite(WHAT, damaged)?;
    require_finite(WHAT, healthy)?;
    Ok(damaged.iter().zip(healthy).map(|(d, h)| d - h).collect())
}
