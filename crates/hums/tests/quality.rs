//! The quality of recorded channels: every flaw is found, clean records have none.

mod common;
use common::{gaussian, sine};
use hums::quality::{ChannelMonitor, ChannelQuality, Flaw};

fn flaws(x: &[f64]) -> Vec<(Flaw, bool)> {
    ChannelQuality::of(x).findings().iter().map(|f| (f.flaw, f.blocks)).collect()
}

#[test]
fn clean_records_have_no_flaw() {
    let noise = gaussian(50_000, 1);
    assert!(ChannelQuality::of(&noise).is_clean(), "{:?}", flaws(&noise));
    for cycles in [7.3, 50.0, 4000.0] {
        let x = sine(20_000, cycles, 1.0, 0.2);
        assert!(flaws(&x).iter().all(|(flaw, blocks)| !blocks && *flaw == Flaw::Drift), "{cycles}: {:?}", flaws(&x));
    }
    // A slow sine in 16 bits stays at its peak for many samples without being clipped; so does a small one.
    for amplitude in [30_000.0, 900.0, 40.0] {
        let x: Vec<f64> = sine(50_000, 40.0, amplitude, 0.1).iter().map(|v| v.round()).collect();
        assert!(ChannelQuality::of(&x).is_clean(), "{amplitude}: {:?}", ChannelQuality::of(&x).findings());
    }
    let counts: Vec<f64> = noise.iter().map(|g| (5.0 * g).round()).collect();
    assert!(ChannelQuality::of(&counts).is_clean());
}

#[test]
fn each_flaw_is_named() {
    assert_eq!(flaws(&[0.0; 5000]), [(Flaw::Dead, true)]);
    assert_eq!(flaws(&[f64::NAN; 5000]), [(Flaw::NoData, true)]);
    let flicker: Vec<f64> = gaussian(5000, 2).iter().map(|g| if *g > 0.0 { 3.0 } else { 2.0 }).collect();
    assert!(flaws(&flicker).contains(&(Flaw::Dead, true)), "one bit of noise");
    let noise = gaussian(40_000, 3);

    let clipped: Vec<f64> = sine(40_000, 200.0, 1.0, 0.0).iter().map(|v| v.clamp(-0.8, 0.8)).collect();
    assert_eq!(flaws(&clipped), [(Flaw::Clipped, true)]);
    let mut rarely = noise.clone();
    rarely[1000..1003].fill(9.0);
    assert_eq!(flaws(&rarely), [(Flaw::Clipped, false)], "three of 40,000 samples are reported, no more");

    let mut loose = noise.clone();
    loose[7000..7400].fill(0.0);
    assert_eq!(flaws(&loose), [(Flaw::Dropout, true)]);
    let quality = ChannelQuality::of(&loose);
    assert_eq!((quality.dropouts.first, quality.dropouts.longest), (Some(7000), 400));

    let mut holes = noise.clone();
    holes[100] = f64::NAN;
    holes[5000..5010].fill(f64::INFINITY);
    assert_eq!(flaws(&holes), [(Flaw::Gap, false)]);
    holes[10_000..20_000].fill(f64::NAN);
    assert_eq!(flaws(&holes), [(Flaw::Gap, true)]);

    let ramp = |slope: f64| -> Vec<f64> { noise.iter().enumerate().map(|(i, g)| g + slope * i as f64).collect() };
    assert_eq!(flaws(&ramp(5.0 / 40_000.0)), [(Flaw::Drift, false)]);
    assert_eq!(flaws(&ramp(100.0 / 40_000.0)), [(Flaw::Drift, true)]);

    // An overload that decays within a tenth of the record.
    let overload: Vec<f64> = noise
        .iter()
        .enumerate()
        .map(|(i, g)| if i < 9000 { *g } else { g + 50.0 * (-(i as f64 - 9000.0) / 1500.0).exp() })
        .collect();
    assert!(flaws(&overload).contains(&(Flaw::Saturated, true)), "{:?}", flaws(&overload));
}

/// Pieces of any size give the same outcome as the whole.
#[test]
fn invariant_quality_does_not_depend_on_pieces() {
    let mut x: Vec<f64> = gaussian(30_000, 5).iter().map(|g| (20.0 * g).round().clamp(-40.0, 45.0)).collect();
    x[777..790].fill(f64::NAN);
    x[9000..9100].fill(3.0);
    let whole = ChannelQuality::of(&x);
    assert!(whole.clipped.count > 0 && whole.dropouts.count == 1 && whole.gaps.samples == 13);
    for piece in [1, 7, 1000] {
        let mut monitor = ChannelMonitor::default();
        x.chunks(piece).for_each(|part| monitor.push(part));
        assert_eq!(monitor.finish(), whole, "{piece}");
    }
}
