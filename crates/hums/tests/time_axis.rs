//! Time columns: steps, missing rows, changes of rate.

mod common;
use common::close;
use hums::HumsError;
use hums::time_axis::{TimeAxis, step_of};

const RATE: f64 = 5120.0;

fn times(rows: usize, at: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..rows).map(at).collect()
}

#[test]
fn analytic_step_of_rounded_and_holed_times() {
    close(step_of(&times(10_000, |i| 1e6 + i as f64 / RATE)).unwrap(), 1.0 / RATE, 1e-9);
    // Four decimals: steps of 1e-4 and 2e-4 for 1.953e-4.
    let rounded = times(60_000, |i| (i as f64 / RATE * 1e4).round() / 1e4);
    close(step_of(&rounded).unwrap(), 1.0 / RATE, 1e-5);
    let holed = times(5000, |i| (if i < 900 { i } else { i + 3333 }) as f64 / RATE);
    close(step_of(&holed).unwrap(), 1.0 / RATE, 1e-9);
    assert_eq!(step_of(&[0.0, 0.25, 0.5]).unwrap(), 0.25);
    for bad in [vec![0.0], vec![0.0, 0.0], vec![0.0, 1.0, 0.5, 3.0], vec![f64::NAN; 5], vec![2.0, 1.0]] {
        assert!(step_of(&bad).is_err(), "{bad:?}");
    }
}

/// Rows are missing far behind the head: they are put in, whatever the blocks.
#[test]
fn missing_rows_become_nan_rows() {
    let t = times(100_000, |i| (if i < 70_000 { i } else { i + 3333 }) as f64 / RATE);
    let x = times(100_000, |i| i as f64);
    for block in [1, 4096, 65_536, 100_000] {
        let mut axis = TimeAxis::new(1.0 / RATE).unwrap();
        let mut whole: Vec<Vec<f64>> = vec![Vec::new(), Vec::new()];
        for (t, x) in t.chunks(block).zip(x.chunks(block)) {
            let from = whole[0].len();
            whole[0].extend_from_slice(t);
            whole[1].extend_from_slice(x);
            axis.complete(&mut whole, 0, from).unwrap();
        }
        assert_eq!(whole[1].len(), 103_333, "{block}");
        assert!(whole[1][70_000..73_333].iter().all(|x| x.is_nan()));
        assert_eq!((whole[1][69_999], whole[1][73_333]), (69_999.0, 70_000.0));
        let gaps = axis.gaps();
        assert_eq!((gaps.count, gaps.missing, gaps.first), (1, 3333, Some(70_000)));
    }
}

#[test]
fn changes_of_rate_and_steps_back_are_errors() {
    let follow = |t: &[f64]| TimeAxis::new(1.0 / RATE).unwrap().push(t, |_, _| {});
    // From row 70,000 on the step is doubled: every second row is missing.
    let doubled = times(80_000, |i| (i + i.saturating_sub(70_000)) as f64 / RATE);
    let mut axis = TimeAxis::new(1.0 / RATE).unwrap();
    axis.push(&doubled, |_, _| {}).unwrap();
    assert_eq!((axis.gaps().count, axis.gaps().missing), (9999, 9999));
    // Slower by a fifth: no row is missing, but the rate is another.
    let slower = times(80_000, |i| (i as f64 + 0.2 * i.saturating_sub(70_000) as f64) / RATE);
    assert!(matches!(follow(&slower), Err(HumsError::Parameter { parameter: "mean time step", .. })));
    let back = times(80_000, |i| if i == 70_000 { 1.0 } else { i as f64 / RATE });
    assert!(matches!(follow(&back), Err(HumsError::Parameter { parameter: "time step", .. })));
    let repeated = times(300, |i| i.min(200) as f64 / RATE);
    assert!(follow(&repeated).is_err());
    let lacking = times(300, |i| if i % 7 == 0 { f64::NAN } else { i as f64 / RATE });
    follow(&lacking).unwrap();
    assert!(follow(&[0.0, 1e9]).is_err(), "more rows missing than may be put in");
    assert!(TimeAxis::new(0.0).is_err() && TimeAxis::new(f64::NAN).is_err());
}
