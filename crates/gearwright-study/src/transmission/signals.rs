//! What the signal of a sensor says: synchronous averages over planet pass and carrier turn, exact and approximate difference signals, and all
//! indicators of each.
//!
//! A simulation steps a whole number of times in a planet pass, so averages need no resampling: periods are cut and averaged sample by sample. Mesh
//! orders are those of the ring: its teeth in a carrier turn, in a planet pass so many parts of them as there are planets. Sidebands stand a planet
//! pass apart. Planets that are not equally spaced have no planet pass, and only the carrier's average.

use hums::HumsError;
use hums::difference::{RemovalRule, exact_difference};
use hums::indicator::{Entry, GearAnalyzer, GearWorkspace, SignalKind, signal_indicators};
use hums::tsa::average_periods;

use gearwright_results::transmission::{Averaged, Averaging, GRAVITY, Judged, Period, Row, State};
use planetary::engine::TransmissionRun;
use rayon::prelude::*;

/// Periods of a train whose planets, if `equally_spaced`, follow each other; `steps` a mesh cycle.
#[must_use]
pub fn periods(ring_teeth: u32, planets: usize, equally_spaced: bool, steps: usize) -> Vec<Period> {
    let teeth = ring_teeth as usize;
    let planets = planets.max(1);
    let whole = equally_spaced && teeth % planets == 0;
    let mut found = Vec::new();
    if whole {
        let mesh_order = teeth / planets;
        found.push(Period { averaging: Averaging::PlanetPass, samples: mesh_order * steps, mesh_order, spacing: 1 });
    }
    let spacing = if whole { planets } else { 1 };
    found.push(Period { averaging: Averaging::Carrier, samples: teeth * steps, mesh_order: teeth, spacing });
    found
}

/// Judges signals of one length by the same rules; transforms are planned once.
#[derive(Debug)]
pub struct Judge {
    /// By period, then number of sideband pairs.
    analyzers: Vec<(Period, Vec<GearAnalyzer>)>,
}

impl Judge {
    /// For difference signals of up to `pairs` sideband pairs.
    ///
    /// # Errors
    /// Mesh orders above what the samples of a period resolve.
    pub fn new(periods: &[Period], pairs: usize) -> Result<Self, HumsError> {
        let analyzers = periods.iter().map(|period| {
            let of = |k| {
                let rule =
                    RemovalRule { sideband_spacing: period.spacing, ..RemovalRule::sidebands(period.mesh_order, k) };
                GearAnalyzer::new(period.samples, &rule)
            };
            Ok((*period, (0..=pairs).map(of).collect::<Result<Vec<_>, HumsError>>()?))
        });
        Ok(Self { analyzers: analyzers.collect::<Result<_, HumsError>>()? })
    }

    /// Everything about a signal; `healthy` is that of the healthy state and what was found of it.
    ///
    /// # Errors
    /// A signal shorter than a period, or not finite.
    pub fn judge(&self, signal: &[f64], healthy: Option<(&[f64], &Judged)>) -> Result<Judged, HumsError> {
        let mut rows = Vec::new();
        push(&mut rows, Averaging::None, &signal_indicators(signal, SignalKind::Raw)?, None);
        let exact = healthy.map(|(before, _)| exact_difference(signal, before)).transpose()?;
        if let Some(exact) = &exact {
            push(&mut rows, Averaging::None, &signal_indicators(exact, SignalKind::ExactDifference)?, None);
        }
        let mut averages = Vec::new();
        for (index, (period, analyzers)) in self.analyzers.iter().enumerate() {
            let average = average_periods(signal, period.samples, None)?;
            let mut workspace = GearWorkspace::default();
            let mut approximate = Vec::new();
            for (pairs, analyzer) in analyzers.iter().enumerate() {
                let analysis = analyzer.analyze_with(&average.samples, &mut workspace)?;
                // what does not depend on the sidebands removed is told once
                let own = |entry: &&Entry| pairs == 0 || entry.signal == SignalKind::Difference;
                let entries: Vec<Entry> = analysis.table.iter().filter(own).cloned().collect();
                push(&mut rows, period.averaging, &entries, Some(pairs));
                approximate.push(analysis.signals.difference.clone());
            }
            let before = healthy.and_then(|(_, judged)| judged.averages.get(index));
            let exact = before.map(|before| exact_difference(&average.samples, &before.average)).transpose()?;
            if let Some(exact) = &exact {
                push(&mut rows, period.averaging, &signal_indicators(exact, SignalKind::ExactDifference)?, None);
            }
            let blocks = average.blocks;
            averages.push(Averaged { period: *period, blocks, average: average.samples, approximate, exact });
        }
        Ok(Judged { rows, exact, averages })
    }
}

fn push(rows: &mut Vec<Row>, averaging: Averaging, entries: &[Entry], pairs: Option<usize>) {
    rows.extend(entries.iter().map(|entry| Row {
        averaging,
        signal: match (entry.signal, pairs) {
            (SignalKind::Difference, Some(pairs)) => format!("difference_{pairs}"),
            (kind, _) => kind.name().to_owned(),
        },
        indicator: entry.indicator.name(),
        value: entry.value.clone().map_err(|reason| reason.to_string()),
        nominal: entry.indicator.gaussian_value(),
    }));
}

/// Judges the signals of all runs; the first is healthy.
///
/// # Errors
/// Signals that are too short or not finite.
pub fn states(runs: Vec<(String, TransmissionRun)>, judge: &Judge, repeats: usize) -> Result<Vec<State>, HumsError> {
    let mut states: Vec<State> = Vec::with_capacity(runs.len());
    for (index, (name, mut run)) in runs.into_iter().enumerate() {
        let change = run.periodic_change(repeats);
        // the record in m/s^2 is not needed any more
        let signals: Vec<Vec<f64>> = run
            .sensors
            .iter_mut()
            .map(|sensor| std::mem::take(&mut sensor.acceleration).into_iter().map(|a| a / GRAVITY).collect())
            .collect();
        let healthy = states.first();
        let judged: Vec<Result<Judged, HumsError>> = signals
            .par_iter()
            .enumerate()
            .map(|(k, signal)| {
                let before = healthy.map(|healthy| (healthy.signals[k].as_slice(), &healthy.judged[k]));
                judge.judge(signal, before)
            })
            .collect();
        let judged = judged.into_iter().collect::<Result<_, _>>()?;
        states.push(State { name, number: index.checked_sub(1).map(|k| k + 1), run, signals, judged, change });
    }
    Ok(states)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three carrier turns of a train of 12 ring teeth and three planets, 10 steps a mesh cycle: mesh harmonics with sidebands at the planet pass,
    /// a tone of another shaft, and a knock once a planet pass.
    fn signal(knock: f64, sidebands: f64) -> Vec<f64> {
        let turn = |i: usize| i as f64 / 120.0;
        let tone = |order: f64, t: f64| (std::f64::consts::TAU * order * t).sin();
        let one = |i: usize| {
            let t = turn(i);
            let modulated = tone(12.0, t) + sidebands * (tone(15.0, t) + tone(9.0, t));
            modulated + 0.3 * tone(7.0 / 3.0, t) + if i % 40 == 17 { knock } else { 0.0 }
        };
        (0..360).map(one).collect()
    }

    #[test]
    fn averages_keep_the_planetary_stage_and_differences_the_knock() {
        let periods = periods(12, 3, true, 10);
        assert_eq!(
            periods.iter().map(|p| (p.samples, p.mesh_order, p.spacing)).collect::<Vec<_>>(),
            [(40, 4, 1), (120, 12, 3)]
        );
        let judge = Judge::new(&periods, 2).unwrap();
        let sound = signal(0.0, 0.5);
        let healthy = judge.judge(&sound, None).unwrap();
        let knocked = signal(2.0, 0.5);
        let damaged = judge.judge(&knocked, Some((&sound, &healthy))).unwrap();
        for (averaging, knocks, samples) in
            [(Averaging::PlanetPass, 1.0_f64, 40.0_f64), (Averaging::Carrier, 3.0, 120.0)]
        {
            // mesh and sidebands are all a healthy average holds: 7/3 orders of the carrier average out over three turns
            let rms = |judged: &Judged, k: usize| judged.value(averaging, &format!("difference_{k}"), "rms").unwrap();
            assert!((rms(&healthy, 0) - 0.5).abs() < 1e-9 && rms(&healthy, 1) < 1e-9, "{averaging:?}");
            assert!(rms(&damaged, 1) > 0.1);
            // exactly one sample in 40 differs, by 2
            let exact = damaged.value(averaging, "exact_difference", "rms").unwrap();
            assert!((exact - 2.0 * (knocks / samples).sqrt()).abs() < 1e-9, "{exact}");
        }
        assert_eq!(damaged.averages[0].blocks, 9);
        assert_eq!(damaged.averages[0].approximate.len(), 3);
        let unaltered = damaged.value(Averaging::None, "exact_difference", "peak").unwrap();
        assert!((unaltered - 2.0).abs() < 1e-12);
        assert!(healthy.value(Averaging::Carrier, "exact_difference", "rms").is_none());
    }

    #[test]
    fn planets_that_do_not_follow_each_other_have_no_planet_pass() {
        assert_eq!(periods(99, 4, true, 50).len(), 1);
        assert_eq!(periods(99, 3, false, 50)[0].averaging, Averaging::Carrier);
        assert_eq!(periods(99, 3, true, 50)[0].samples, 1650);
    }
}
