//! Tachometer: exact pulses, faults, speed that varies.

mod common;
use common::{close, uniform};
use hums::HumsError;
use hums::tachometer::{Edge, PulseFinder, PulseOptions, Shaft, pulse_times, repair};

/// Trapezoidal pulses with flanks of two samples about each time.
fn channel(times: &[f64], rate: f64, samples: usize) -> Vec<f64> {
    let ramp = |t: f64| (0.5 + t * rate / 2.0).clamp(0.0, 1.0);
    (0..samples)
        .map(|i| {
            let t = i as f64 / rate;
            let height: f64 = times.iter().map(|p| ramp(t - p) - ramp(t - p - 20.0 / rate)).sum();
            5.0 * height - 0.3
        })
        .collect()
}

fn pulses(count: usize, phase_to_time: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..count).map(|k| phase_to_time(k as f64)).collect()
}

/// Speed from 10 Hz down to 5 Hz over 40 turns: turn = 10 t - a t^2, with the end speed half.
fn slowing(turn: f64) -> f64 {
    // d turn/dt = 10 - 2 a t = 5 at the end, 40 = 7.5 t_end, so a = 2.5 / t_end = 0.46875.
    let a = 0.468_75;
    (10.0 - (100.0 - 4.0 * a * turn).sqrt()) / (2.0 * a)
}

#[test]
fn analytic_pulse_times_between_samples() {
    let exact = pulses(40, |k| 0.01234 + 0.05 * k);
    let x = channel(&exact, 2000.0, 4200);
    let found = pulse_times(&x, 2000.0, &PulseOptions::default()).unwrap();
    assert_eq!(found.len(), 40);
    for (f, e) in found.iter().zip(&exact) {
        assert!((f - e).abs() < 1e-12, "{f} {e}");
    }
    let falling = PulseOptions { edge: Edge::Falling, ..PulseOptions::default() };
    let down = pulse_times(&x, 2000.0, &falling).unwrap();
    assert!((down[3] - exact[3] - 0.01).abs() < 1e-12);
}

/// A channel in pieces of any size gives the same bits as in one.
#[test]
fn invariant_pulses_do_not_depend_on_pieces() {
    let mut x = channel(&pulses(40, |k| 0.02 + 0.05 * k), 2000.0, 4200);
    for (v, u) in x.iter_mut().zip(uniform(4200, 4)) {
        *v += 0.8 * (u - 0.5);
    }
    x[777] = f64::NAN;
    let options = PulseOptions { level: Some(2.2), hysteresis: Some(1.0), edge: Edge::Rising };
    let whole = pulse_times(&x, 2000.0, &options).unwrap();
    assert_eq!(whole.len(), 40);
    for piece in [1, 7, 1000, 4200] {
        let mut finder = PulseFinder::new(2000.0, 2.2, 1.0, Edge::Rising).unwrap();
        let mut times = Vec::new();
        x.chunks(piece).for_each(|part| finder.push(part, &mut times));
        assert_eq!(times, whole, "{piece}");
    }
    assert!(PulseFinder::new(2000.0, f64::NAN, 1.0, Edge::Rising).is_err());
    assert!(PulseFinder::new(2000.0, 1.0, 0.0, Edge::Rising).is_err());
}

#[test]
fn extreme_noise_and_gaps_in_the_channel() {
    let exact = pulses(40, |k| 0.02 + 0.05 * k);
    let mut x = channel(&exact, 2000.0, 4200);
    for (v, u) in x.iter_mut().zip(uniform(4200, 4)) {
        *v += 0.8 * (u - 0.5);
    }
    x[777] = f64::NAN;
    let found = pulse_times(&x, 2000.0, &PulseOptions::default()).unwrap();
    assert_eq!(found.len(), 40);
    for bad in [vec![1.0; 50], vec![f64::NAN; 50]] {
        assert!(matches!(pulse_times(&bad, 1.0, &PulseOptions::default()), Err(HumsError::Tachometer { .. })));
    }
    let high = PulseOptions { level: Some(100.0), ..PulseOptions::default() };
    assert!(pulse_times(&x, 2000.0, &high).is_err());
}

#[test]
fn extreme_missing_and_double_pulses_at_varying_speed() {
    let exact = pulses(41, slowing);
    let mut faulty = exact.clone();
    for missing in [33, 32, 20, 7] {
        faulty.remove(missing);
    }
    faulty.push(exact[12] + 0.004); // a bounce
    faulty.push(0.5 * (exact[25] + exact[26])); // a glint half way
    faulty.push(exact[3] - 0.01); // early
    faulty.sort_by(f64::total_cmp);
    let kept = repair(&faulty).unwrap();
    assert_eq!((kept.missing, kept.extra), (4, 3));
    for (t, k) in kept.times.iter().zip(&kept.numbers) {
        assert_eq!(*t, exact[*k as usize]);
    }
    let shaft = Shaft::from_repaired(&kept, 1.0).unwrap();
    assert_eq!(shaft.turn_range(), (0.0, 40.0));
    for turn in [6.9, 7.3, 20.5, 32.5, 33.1] {
        let t = shaft.time_at(turn).unwrap();
        assert!((t - slowing(turn)).abs() < 2e-5, "{turn}: {}", t - slowing(turn));
    }
    let (low, high) = shaft.speed_range();
    assert!(low > 4.9 && low < 5.2 && high > 9.8 && high < 10.1);
}

#[test]
fn invariant_clean_pulses_stay_and_a_false_first_goes() {
    let exact = pulses(30, slowing);
    let kept = repair(&exact).unwrap();
    assert_eq!(kept.times, exact);
    assert_eq!((kept.missing, kept.extra), (0, 0));
    let mut early = vec![-0.03];
    early.extend(&exact);
    assert_eq!(repair(&early).unwrap().times, exact);
}

#[test]
fn extreme_hopeless_pulses_are_refused() {
    let chaos: Vec<f64> = uniform(60, 8)
        .iter()
        .scan(0.0, |t, u| {
            *t += 0.01 + u * u * u;
            Some(*t)
        })
        .collect();
    assert!(matches!(repair(&chaos), Err(HumsError::Tachometer { .. })));
    for bad in [vec![], vec![1.0], vec![1.0, 1.0], vec![2.0, 1.0], vec![0.0, f64::NAN]] {
        assert!(matches!(repair(&bad), Err(HumsError::Tachometer { .. })));
        assert!(Shaft::from_pulses(&bad, 1.0).is_err());
    }
    assert!(Shaft::from_pulses(&[0.0, 1.0], 0.0).is_err());
}

#[test]
fn order_of_angle_between_pulses() {
    // One to eight pulses a turn of the slowing shaft: time errors fall with the fourth power.
    let errors: Vec<f64> = [1, 2, 4, 8]
        .iter()
        .map(|&per_turn| {
            let p = f64::from(per_turn);
            let times = pulses(40 * per_turn as usize + 1, |k| slowing(k / p));
            let shaft = Shaft::from_pulses(&times, p).unwrap();
            (80..320)
                .map(|i| f64::from(i) / 8.0 - 0.043)
                .filter(|turn| (10.0..30.0).contains(turn))
                .map(|turn| (shaft.time_at(turn).unwrap() - slowing(turn)).abs())
                .fold(0.0, f64::max)
        })
        .collect();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.6..4.6).contains(&order), "{errors:?}");
    }
}

#[test]
fn invariant_time_and_turn_are_inverse() {
    let shaft = Shaft::from_pulses(&pulses(41, slowing), 1.0).unwrap();
    for i in 0..200 {
        let turn = 0.2 * f64::from(i);
        let back = shaft.turn_at(shaft.time_at(turn).unwrap()).unwrap();
        assert!((back - turn).abs() < 1e-12, "{turn}");
    }
    close(shaft.speed_at(20.0).unwrap(), (100.0 - 4.0 * 0.468_75 * 20.0_f64).sqrt(), 1e-4);
    let planet = shaft.geared(2.5).unwrap();
    close(planet.time_at(50.0).unwrap(), shaft.time_at(20.0).unwrap(), 1e-15);
    close(planet.speed_at(50.0).unwrap(), 2.5 * shaft.speed_at(20.0).unwrap(), 1e-12);
    assert_eq!(shaft.time_at(-0.1), None);
    assert_eq!(shaft.time_at(f64::NAN), None);
    assert_eq!(shaft.turn_at(1e9), None);
}

#[test]
fn invariant_time_increases_through_a_speed_jump() {
    // An abrupt jump makes an unlimited spline overshoot; the limited one may not.
    let mut times = pulses(10, |k| k);
    times.extend((1..30).map(|k| 9.0 + 0.01 * f64::from(k)));
    let shaft = Shaft::from_pulses(&times, 1.0).unwrap();
    let mut last = -1.0;
    for i in 0..=3800 {
        let t = shaft.time_at(f64::from(i) / 100.0).unwrap();
        assert!(t >= last);
        last = t;
    }
}

/// Three seconds without pulses are a hole, not thirty turns; a few missing pulses are bridged.
#[test]
fn a_standstill_is_a_hole() {
    let mut times = pulses(200, |k| 0.1 * k);
    for t in &mut times[100..] {
        *t += 3.0;
    }
    times.remove(50);
    let kept = repair(&times).unwrap();
    assert_eq!((kept.missing, kept.extra, kept.holes.len()), (1, 0, 1));
    let shaft = Shaft::from_repaired(&kept, 1.0).unwrap();
    let [from, to] = shaft.holes().next().unwrap();
    close(from.1, 9.9, 1e-12);
    close(to.1, 13.0, 1e-12);
    let (slowest, fastest) = shaft.speed_range();
    assert!(slowest > 9.9 && fastest < 10.1);
    let stretch = kept.longest_stretch();
    assert_eq!((stretch.times.len(), stretch.numbers[0], stretch.holes.len()), (100, 0, 0));
    // Pulses that come at a tenth of the speed after the hole are not missing ones.
    let mut slower = pulses(50, |k| 0.1 * k);
    slower.extend(pulses(50, |k| 6.0 + k));
    let kept = repair(&slower).unwrap();
    assert_eq!((kept.missing, kept.holes.len()), (0, 1));
    for holes in [vec![5, 5], vec![99], vec![98, 99]] {
        let bad = hums::tachometer::RepairedPulses { holes, ..kept.clone() };
        assert!(Shaft::from_repaired(&bad, 1.0).is_err());
    }
}
