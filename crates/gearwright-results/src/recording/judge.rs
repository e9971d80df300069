//! Thresholds and verdicts.

use std::collections::BTreeMap;

use hums::threshold::{Rate, mean_plus_k_sigma, quantile};

use super::{Measured, Row};
use gearwright_case::recording::resolve::HealthyLimit;

/// An upper limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Values above it are a reason to look.
    pub threshold: f64,
    /// Share of the healthy set above it.
    pub false_alarms: Option<Rate>,
}

/// Says whether a value is a reason to look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// At or below the threshold.
    Ok,
    /// Above it.
    Alarm,
}

impl Verdict {
    /// Short name, as used in result columns.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Alarm => "alarm",
        }
    }
}

/// Channel, indicator, signal.
type Key = (String, &'static str, &'static str);

/// Limits of indicators.
#[derive(Debug, Clone)]
pub enum Limits {
    /// Gaussian value and so many standard errors.
    Gaussian(f64),
    /// From a healthy set.
    Healthy(BTreeMap<Key, Limit>),
}

impl Limits {
    /// Limits from healthy recordings: of every indicator that at least two of them have, but the mean, which tells of the sensor.
    #[must_use]
    pub fn of_healthy<'a>(healthy: impl Iterator<Item = &'a Measured>, rule: HealthyLimit) -> Self {
        let mut values: BTreeMap<Key, Vec<f64>> = BTreeMap::new();
        for channel in healthy.flat_map(|recording| &recording.channels) {
            for row in channel.rows.iter().filter(|row| row.indicator != "mean") {
                if let Ok(value) = row.value {
                    values.entry((channel.name.clone(), row.indicator, row.signal)).or_default().push(value);
                }
            }
        }
        let limit = |set: &[f64]| {
            if set.len() < 2 {
                return None;
            }
            let threshold = match rule {
                HealthyLimit::MeanPlusSigmas(k) => mean_plus_k_sigma(set, k),
                HealthyLimit::Quantile(share) => quantile(set, share),
            };
            let threshold = threshold.ok()?;
            Some(Limit { threshold, false_alarms: Rate::above(set, threshold).ok() })
        };
        Self::Healthy(values.into_iter().filter_map(|(key, set)| Some((key, limit(&set)?))).collect())
    }

    /// Limit of an indicator.
    #[must_use]
    pub fn of(&self, channel: &str, row: &Row) -> Option<Limit> {
        match self {
            Self::Gaussian(sigmas) => {
                let threshold = row.nominal? + sigmas * row.standard_error?;
                Some(Limit { threshold, false_alarms: None })
            }
            Self::Healthy(limits) => limits.get(&(channel.to_owned(), row.indicator, row.signal)).copied(),
        }
    }

    /// Why an indicator has no limit.
    #[must_use]
    pub fn why_none(&self, row: &Row) -> &'static str {
        match (self, row.indicator, row.nominal) {
            (_, "mean", _) => "the mean tells of the sensor, not of the gear",
            (Self::Gaussian(_), _, None) => "no nominal value: needs a healthy set",
            (Self::Gaussian(_), "energy_operator", _) => {
                "the nominal value is that of white noise only: needs a healthy set"
            }
            (Self::Gaussian(_), _, Some(_)) => "regular vibration is not Gaussian: needs a healthy set",
            (Self::Healthy(_), ..) => "fewer than two healthy recordings have a value",
        }
    }

    /// Verdict on an indicator; `None` without value or limit.
    #[must_use]
    pub fn verdict(&self, channel: &str, row: &Row) -> Option<Verdict> {
        let (value, limit) = (row.value.as_ref().ok()?, self.of(channel, row)?);
        Some(if *value > limit.threshold { Verdict::Alarm } else { Verdict::Ok })
    }
}
