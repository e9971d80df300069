//! Agreement with scipy to 1e-12 on a random signal.
//!
//! The reference values and the script that wrote them are in `tests/data/`. The tolerance leaves
//! three orders of magnitude above rounding of sums of 600 terms of order one.

mod common;
use common::{close, max_difference};
use hums::indicator::basic;
use hums::spectrum::{Spectrum, Window, welch};
use std::collections::HashMap;

const TOLERANCE: f64 = 1e-12;

fn reference() -> HashMap<&'static str, Vec<f64>> {
    include_str!("data/scipy_reference.txt")
        .lines()
        .map(|line| {
            let (name, values) = line.split_once(": ").expect("name: values");
            let values = values.split(' ').map(|v| v.parse().expect("number"));
            (name, values.collect())
        })
        .collect()
}

#[test]
fn peer_scipy_statistics() {
    let r = reference();
    let x = &r["signal"];
    close(basic::rms(x).unwrap(), r["rms"][0], TOLERANCE);
    close(basic::skewness(x).unwrap(), r["skewness"][0], TOLERANCE);
    close(basic::kurtosis(x).unwrap(), r["kurtosis"][0], TOLERANCE);
    close(basic::m6a(x).unwrap(), r["m6a"][0], TOLERANCE);
    close(basic::m8a(x).unwrap(), r["m8a"][0], TOLERANCE);
    close(basic::normalized_moment(x, 2.5).unwrap(), r["s_2.5"][0], TOLERANCE);
    close(basic::energy_operator(x, basic::Ends::Cyclic).unwrap(), r["energy_operator"][0], TOLERANCE);
    let moments = hums::moments::Moments::of(x).unwrap();
    close(moments.mean(), r["mean"][0], TOLERANCE);
    close(moments.variance().unwrap(), r["variance"][0], TOLERANCE);
}

#[test]
fn peer_scipy_envelope_even_and_odd_length() {
    let r = reference();
    let x = &r["signal"];
    for (signal, expected) in [(&x[..], &r["envelope"]), (&x[..599], &r["odd_envelope"])] {
        let envelope = hums::envelope::envelope(signal).unwrap();
        assert!(max_difference(&envelope, expected) < TOLERANCE);
    }
}

#[test]
fn peer_scipy_spectra() {
    let r = reference();
    let x = &r["signal"];
    let (frequencies, density) = welch(x, 5120.0, 128, Window::Hann).unwrap();
    assert!(max_difference(&frequencies, &r["welch_frequencies"]) < 1e-9);
    assert!(max_difference(&density, &r["welch_density"]) < TOLERANCE);
    let amplitudes = Spectrum::of(x, Window::Rectangular).unwrap().amplitudes();
    assert!(max_difference(&amplitudes, &r["amplitudes"]) < TOLERANCE);
    assert!(max_difference(&Window::FlatTop.samples(64), &r["flattop"]) < TOLERANCE);
}

#[test]
fn peer_scipy_detrend() {
    let r = reference();
    let mut x = r["signal"].clone();
    hums::signal::detrend(&mut x, true).unwrap();
    assert!(max_difference(&x, &r["detrended"]) < TOLERANCE);
}
