//! Limits and verdicts.
//!
//! A verdict is ok, alarm, or not judged with the reason. Nothing is ok for want of a limit, of a value or of a usable signal.

use std::collections::BTreeMap;

use hums::threshold::{Limit, Rate, held_out, prediction_limit, quantile_limit, sigma_limit};

use super::{Channel, Measured, Row};
use gearwright_case::recording::resolve::{GaussianLimit, HealthyLimit};

/// The limit of an indicator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Values outside it are a reason to look.
    pub limit: Limit,
    /// Share of the healthy set outside the limits that the rest of the set gives.
    pub false_alarms: Option<Rate>,
}

/// Whether a value is a reason to look.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// Within its limits.
    Ok,
    /// Outside.
    Alarm,
    /// Not judged, and why.
    NotJudged(String),
}

impl Verdict {
    /// Short name, as used in result columns.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Alarm => "alarm",
            Self::NotJudged(_) => "not judged",
        }
    }

    /// Why it is not judged; empty otherwise.
    #[must_use]
    pub fn reason(&self) -> &str {
        if let Self::NotJudged(reason) = self { reason } else { "" }
    }
}

/// Verdict on a channel, from those on its indicators.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelVerdict {
    /// The verdict.
    pub verdict: Verdict,
    /// Indicators judged.
    pub judged: usize,
    /// Indicators outside their limits.
    pub alarms: usize,
}

/// The largest deviation of a recording's indicators, 1 at the limits.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct HealthIndex {
    /// Its value; above 1 is an alarm.
    pub value: f64,
    /// Channel of the indicator that deviates most.
    pub channel: String,
    /// That indicator.
    pub indicator: &'static str,
    /// Signal it is computed from.
    pub signal: &'static str,
}

/// Channel, indicator, signal.
type Key = (String, &'static str, &'static str);

/// Limits of indicators.
#[derive(Debug, Clone)]
pub struct Limits {
    source: Source,
    /// Indicators that are judged together, all channels.
    tests: usize,
    /// Probability of any alarm on a healthy recording, where the limits are made for one.
    pub false_alarm_rate: Option<f64>,
    /// Share of healthy recordings that raise any alarm at the limits of the others.
    pub held_out: Option<Rate>,
}

#[derive(Debug, Clone)]
enum Source {
    /// Standard errors above the value for Gaussian noise.
    Gaussian(f64),
    /// From a healthy set.
    Healthy(BTreeMap<Key, Bound>),
}

/// Indicators of which values for Gaussian noise are limits, in each channel: FM4, M6A, M8A, NA4.
const GAUSSIAN: usize = 4;

impl Limits {
    /// Limits from values for Gaussian noise, for a recording with so many channels.
    #[must_use]
    pub fn gaussian(rule: GaussianLimit, channels: usize) -> Self {
        let tests = GAUSSIAN * channels.max(1);
        let (sigmas, false_alarm_rate) = match rule {
            GaussianLimit::Sigmas(sigmas) => (sigmas, None),
            GaussianLimit::FalseAlarms(rate) => {
                (hums::threshold::normal_quantile(1.0 - rate / tests as f64), Some(rate))
            }
        };
        Self { source: Source::Gaussian(sigmas), tests, false_alarm_rate, held_out: None }
    }

    /// Limits from healthy recordings: of every indicator that at least two of them have, but the mean, which is the sensor's. Channels
    /// that are not to be judged have no part in them.
    #[must_use]
    pub fn of_healthy(healthy: &[&Measured], rule: HealthyLimit) -> Self {
        // One place for each recording, so that all indicators leave out the same one.
        let mut values: BTreeMap<Key, Vec<Option<f64>>> = BTreeMap::new();
        for (place, recording) in healthy.iter().enumerate() {
            for channel in recording.channels.iter().filter(|channel| channel.blocked.is_none()) {
                for row in channel.rows.iter().filter(|row| row.indicator != "mean") {
                    if let Ok(value) = row.value {
                        let key = (channel.name.clone(), row.indicator, row.signal);
                        values.entry(key).or_insert_with(|| vec![None; healthy.len()])[place] = Some(value);
                    }
                }
            }
        }
        values.retain(|_, set| set.iter().flatten().count() >= 2);
        let tests = values.len().max(1);
        let limit = |set: &[f64]| match rule {
            HealthyLimit::FalseAlarms(rate) => prediction_limit(set, rate / tests as f64),
            HealthyLimit::MeanPlusSigmas(k) => sigma_limit(set, k),
            HealthyLimit::Quantile(share) => quantile_limit(set, share),
        };
        let present = |set: &[Option<f64>]| set.iter().flatten().copied().collect::<Vec<f64>>();
        let bounds = values.iter().filter_map(|(key, set)| {
            let set = present(set);
            Some((key.clone(), Bound { limit: limit(&set).ok()?, false_alarms: held_out(&set, limit).ok() }))
        });
        let bounds = bounds.collect();
        let alarms = |place: usize| {
            values.values().any(|set| {
                let Some(value) = set[place] else { return false };
                let others: Vec<f64> =
                    set.iter().enumerate().filter(|(k, _)| *k != place).filter_map(|(_, value)| *value).collect();
                limit(&others).is_ok_and(|limit| limit.excludes(value))
            })
        };
        let held_out = (healthy.len() >= 3)
            .then(|| Rate::of((0..healthy.len()).filter(|place| alarms(*place)).count(), healthy.len()).ok())
            .flatten();
        let false_alarm_rate = if let HealthyLimit::FalseAlarms(rate) = rule { Some(rate) } else { None };
        Self { source: Source::Healthy(bounds), tests, false_alarm_rate, held_out }
    }

    /// Indicators that are judged together.
    #[must_use]
    pub fn tests(&self) -> usize {
        self.tests
    }

    /// Limit of an indicator.
    #[must_use]
    pub fn of(&self, channel: &str, row: &Row) -> Option<Bound> {
        match &self.source {
            Source::Gaussian(sigmas) => {
                let nominal = row.nominal?;
                // The scatter of these moments is one of factors: see the module of thresholds.
                let limit = Limit::up_to_factor(nominal, (sigmas * row.standard_error? / nominal).exp());
                Some(Bound { limit, false_alarms: None })
            }
            Source::Healthy(bounds) => bounds.get(&(channel.to_owned(), row.indicator, row.signal)).copied(),
        }
    }

    /// Why an indicator has no limit.
    #[must_use]
    pub fn why_none(&self, channel: &str, row: &Row) -> String {
        let healthy = match &self.source {
            Source::Healthy(bounds) => bounds,
            Source::Gaussian(_) => {
                return match (row.indicator, row.nominal) {
                    ("mean", _) => "the mean is a matter of the sensor, not of the gear",
                    (_, None) => "no nominal value: needs a healthy set",
                    ("energy_operator", _) => "the nominal value is that of white noise only: needs a healthy set",
                    (_, Some(_)) => "regular vibration is not Gaussian: needs a healthy set",
                }
                .to_owned();
            }
        };
        if row.indicator == "mean" {
            return "the mean is a matter of the sensor, not of the gear".to_owned();
        }
        let mut known: Vec<&str> = healthy.keys().map(|key| key.0.as_str()).collect();
        known.dedup();
        if known.contains(&channel) {
            return "fewer than two healthy recordings have a value".to_owned();
        }
        let names = known.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        let names = if names.is_empty() { "none that can be used".to_owned() } else { names };
        format!("the healthy set has no usable channel \"{channel}\"; it has {names}")
    }

    /// Verdict on an indicator.
    #[must_use]
    pub fn verdict(&self, channel: &Channel, row: &Row) -> Verdict {
        if let Some(reason) = &channel.blocked {
            return Verdict::NotJudged(reason.clone());
        }
        match (&row.value, self.of(&channel.name, row)) {
            (Err(reason), _) => Verdict::NotJudged(reason.clone()),
            (Ok(_), None) => Verdict::NotJudged(self.why_none(&channel.name, row)),
            (Ok(value), Some(bound)) => {
                if bound.limit.excludes(*value) {
                    Verdict::Alarm
                } else {
                    Verdict::Ok
                }
            }
        }
    }

    /// Verdict on a channel: alarm where an indicator alarms; not judged without any that can be judged, or without an average.
    #[must_use]
    pub fn on_channel(&self, channel: &Channel) -> ChannelVerdict {
        let verdicts: Vec<Verdict> = channel.rows.iter().map(|row| self.verdict(channel, row)).collect();
        let count = |verdict: &Verdict| verdicts.iter().filter(|v| *v == verdict).count();
        let alarms = count(&Verdict::Alarm);
        let judged = alarms + count(&Verdict::Ok);
        let verdict = match (&channel.blocked, &channel.average) {
            (Some(reason), _) => Verdict::NotJudged(reason.clone()),
            _ if alarms > 0 => Verdict::Alarm,
            (None, Err(reason)) => Verdict::NotJudged(format!("no synchronous average: {reason}")),
            (None, Ok(_)) if judged == 0 => {
                let named = channel.rows.iter().find(|row| row.indicator != "mean");
                Verdict::NotJudged(named.map_or_else(String::new, |row| self.verdict(channel, row).reason().to_owned()))
            }
            _ => Verdict::Ok,
        };
        ChannelVerdict { verdict, judged, alarms }
    }

    /// Health index of a recording; `None` where nothing is judged.
    #[must_use]
    pub fn health_index(&self, recording: &Measured) -> Option<HealthIndex> {
        let channels = recording.channels.iter().filter(|channel| channel.blocked.is_none());
        let rows = channels.flat_map(|channel| channel.rows.iter().map(move |row| (channel, row)));
        let deviations = rows.filter_map(|(channel, row)| {
            let value = *row.value.as_ref().ok()?;
            Some((self.of(&channel.name, row)?.limit.deviation(value), channel, row))
        });
        // The first of equal ones.
        let most = deviations.reduce(|most, next| if next.0 > most.0 { next } else { most });
        most.map(|(value, channel, row)| HealthIndex {
            value,
            channel: channel.name.clone(),
            indicator: row.indicator,
            signal: row.signal,
        })
    }
}
