//! Several recordings in order: indicators with a memory, alarms.

use std::collections::{BTreeMap, BTreeSet};

use hums::indicator::trend::{Memory, QuasiKurtosis};
use hums::threshold::{AlarmRule, Rate, alarms};

use gearwright_case::recording::resolve::MemoryPlan;
use gearwright_results::recording::{Alarm, Entry, Limits, Measured, Row};

/// Kinds of memory with the names of their rows: NA4 of the residual signal, NB4 of the mesh envelope.
const RUNNING: [&str; 2] = ["na4_running", "nb4_running"];
const RESET: [&str; 2] = ["na4_reset", "nb4_reset"];
const LOCKED: [&str; 2] = ["na4_locked", "nb4_locked"];
const SIGNALS: [&str; 2] = ["residual", "mesh_envelope"];

/// Recordings that NA4* learns from when nothing says which are healthy.
const LEARN: usize = 8;

/// Adds NA4 and NB4 with a memory over all recordings, those given first included: running over all of them, begun anew where the case
/// says so, and locked at the first sign of damage. `healthy` recordings come first.
///
/// # Errors
/// A parameter out of range (the case has been checked).
pub fn remember<'a>(
    recordings: impl Iterator<Item = &'a mut Measured>,
    plan: &MemoryPlan,
    healthy: Option<usize>,
) -> hums::Result<()> {
    let learn = plan.learn.or(healthy).unwrap_or(LEARN).max(2);
    let pair = |memory| Ok([QuasiKurtosis::new(memory)?, QuasiKurtosis::new(memory)?]);
    let mut kinds = vec![(RUNNING, Memory::Running, false)];
    if !plan.reset_before.is_empty() || plan.reset_speed.is_some() {
        kinds.push((RESET, Memory::Running, true));
    }
    kinds.push((LOCKED, Memory::Locked { z: plan.lock_sigmas, learn }, true));
    let mut memories: BTreeMap<String, Vec<[QuasiKurtosis; 2]>> = BTreeMap::new();
    let mut first_speed: Option<f64> = None;
    for recording in recordings {
        let speed = (recording.speed.0 + recording.speed.1) / 2.0;
        let changed = |first: f64| plan.reset_speed.is_some_and(|most| (speed - first).abs() > most * first);
        let anew = plan.reset_before.contains(&recording.name) || first_speed.is_some_and(changed);
        if anew || first_speed.is_none() {
            first_speed = Some(speed);
        }
        for channel in &mut recording.channels {
            if !memories.contains_key(&channel.name) {
                let fresh = kinds.iter().map(|kind| pair(kind.1)).collect::<hums::Result<_>>()?;
                memories.insert(channel.name.clone(), fresh);
            }
            let (Ok(average), Some(memories)) = (&channel.average, memories.get_mut(&channel.name)) else { continue };
            for ((names, _, resets), pair) in kinds.iter().zip(memories) {
                for (((memory, moments), indicator), signal) in
                    pair.iter_mut().zip(&average.memory).zip(names).zip(SIGNALS)
                {
                    if anew && *resets {
                        memory.reset();
                    }
                    let value = match moments {
                        Some(moments) => memory.update_moments(moments).map_err(|reason| reason.to_string()),
                        None => Err("this recording has no such signal".to_owned()),
                    };
                    channel.rows.push(Row { indicator, signal, value, nominal: None, standard_error: None });
                }
            }
        }
    }
    Ok(())
}

/// The alarms of a trend, in the order in which they came up.
///
/// # Errors
/// A rule with more hits than its window (the case has been checked).
pub fn alarm_log(trend: &[Entry], limits: &Limits, hits: usize, window: usize) -> hums::Result<Vec<Alarm>> {
    let usable = || trend.iter().filter_map(|entry| entry.measured.as_ref().ok());
    // Every channel and indicator in the order of first appearance.
    let mut quantities: Vec<(&str, &Row)> = Vec::new();
    let mut seen = BTreeSet::new();
    for (channel, row) in usable().flat_map(|m| &m.channels).flat_map(|c| c.rows.iter().map(move |r| (&c.name, r))) {
        if seen.insert((channel, row.indicator, row.signal)) {
            quantities.push((channel, row));
        }
    }
    let mut log = Vec::new();
    for (channel, quantity) in quantities {
        let Some(bound) = limits.of(channel, quantity) else { continue };
        let limit = bound.limit;
        let values: Vec<Option<f64>> = trend.iter().map(|entry| judged_value(entry, channel, quantity)).collect();
        let present: Vec<f64> = values.iter().flatten().copied().collect();
        if present.is_empty() {
            continue;
        }
        let rule = AlarmRule { limit, hits, window };
        for range in alarms(&values, &rule)? {
            let meanwhile = values[range.clone()].iter().flatten().copied();
            let further = |a: f64, b: f64| if limit.deviation(b) > limit.deviation(a) { b } else { a };
            let extreme = meanwhile.reduce(further).unwrap_or(limit.centre);
            log.push(Alarm {
                channel: channel.to_owned(),
                indicator: quantity.indicator,
                signal: quantity.signal,
                lower_limit: limit.lower,
                upper_limit: limit.upper,
                raised_at: range.start + 1,
                raised_by: trend[range.start].name.clone(),
                cleared_at: (range.end < trend.len()).then_some(range.end + 1),
                extreme,
                share_outside: Rate::outside(&present, &limit)?.value(),
            });
        }
    }
    // As they came up; those of one recording in the order of channels and indicators.
    log.sort_by_key(|alarm| alarm.raised_at);
    Ok(log)
}

/// Value of an indicator in a recording whose channel may be judged.
fn judged_value(entry: &Entry, channel: &str, quantity: &Row) -> Option<f64> {
    let measured = entry.measured.as_ref().ok()?;
    let usable = measured.channels.iter().any(|c| c.name == channel && c.blocked.is_none());
    measured.value(channel, quantity).filter(|_| usable)
}
