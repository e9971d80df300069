//! Tests of curves.

use super::*;
use crate::error::LpmError;

#[test]
fn invariant_a_jump_met_up_to_rounding_counts_as_reached() -> Result<(), LpmError> {
    // 0.82 cycles after every start, by three routes of rounding.
    let wave = Curve::rectangular(1.0, 2.0, 0.18, 0.64)?;
    let rotation = wave.with_cycles_replaced(27, 14, &wave.scaled(10.0, 0.0)?)?;
    for i in 0..27 {
        for t in [f64::from(i) + 0.82, f64::from(100 * i + 82) / 100.0] {
            assert_eq!(wave.value(t), 1.0, "{t}");
            assert_eq!(rotation.value(t), if i == 14 { 10.0 } else { 1.0 }, "{t}");
            assert_eq!(wave.value(t - 1e-9), 2.0, "{t}");
        }
    }
    Ok(())
}

#[test]
fn order_spline_is_fourth_order_and_linear_second() -> Result<(), LpmError> {
    let f = |t: f64| (TAU * t).sin() + 0.3 * (2.0 * TAU * t).cos();
    let error = |n: usize, kind| -> Result<f64, LpmError> {
        let values: Vec<f64> = (0..n).map(|i| f(i as f64 / n as f64)).collect();
        let c = Curve::samples(1, &values, kind)?;
        Ok((0..997).map(|i| i as f64 / 997.0).map(|t| (c.value(t) - f(t)).abs()).fold(0.0, f64::max))
    };
    for (kind, order) in [(Interpolation::Linear, 2.0), (Interpolation::Spline, 4.0)] {
        let e: Vec<f64> = [20, 40, 80, 160].iter().map(|&n| error(n, kind)).collect::<Result<_, _>>()?;
        let slope = (e[0] / e[3]).log2() / 3.0;
        assert!((slope - order).abs() < 0.15, "{kind:?}: order {slope}, errors {e:?}");
    }
    Ok(())
}

#[test]
fn analytic_rectangular_and_shifted_jumps() -> Result<(), LpmError> {
    let c = Curve::rectangular(1.0, 2.0, 0.7, 0.5)?;
    for (t, v) in [(0.0, 2.0), (0.19, 2.0), (0.2, 1.0), (0.69, 1.0), (0.7, 2.0), (-0.1, 2.0), (5.5, 1.0)] {
        assert_eq!(c.value(t), v, "at {t}");
    }
    assert!((c.mean() - 1.5).abs() < 1e-15);
    let s = c.shifted(0.4)?;
    for i in 0..50 {
        let t = i as f64 * 0.02 + 0.003;
        assert_eq!(s.value(t), c.value(t - 0.4), "at {t}");
    }
    Ok(())
}

#[test]
fn invariant_replaced_cycles_follow_both_curves() -> Result<(), LpmError> {
    let h = Curve::trapezoidal(5.0, 8.0, 0.3, 0.4, 0.1)?;
    let d = h.repeated(2)?.scaled(0.5, 0.0)?;
    let w = h.with_cycles_replaced(7, 3, &d)?;
    assert_eq!(w.period(), 7);
    for i in 0..700 {
        let t = i as f64 * 0.01 + 0.001;
        let want = if (3.0..5.0).contains(&t) { 0.5 * h.value(t) } else { h.value(t) };
        assert!((w.value(t) - want).abs() < 1e-12, "at {t}");
    }
    Ok(())
}

#[test]
fn invariant_fourier_slope_shift_and_range() -> Result<(), LpmError> {
    let c = Curve::fourier(2.0, &[(0.5, -0.2), (0.0, 0.1)])?;
    let s = c.shifted(0.13)?;
    for i in 0..40 {
        let t = i as f64 / 40.0;
        let (v, d) = c.value_and_slope(t);
        let num = (c.value(t + 1e-6) - c.value(t - 1e-6)) / 2e-6;
        assert!((d - num).abs() < 1e-8, "slope {d} {num}");
        assert!((s.value(t + 0.13) - v).abs() < 1e-14);
        assert!(c.range().min <= v + 1e-3 && v <= c.range().max + 1e-3);
    }
    Ok(())
}

#[test]
fn extreme_bad_tables_are_refused() {
    assert!(Curve::table(1, &[0.0, 0.5], &[1.0], Interpolation::Linear).is_err());
    assert!(Curve::table(1, &[0.5, 0.2], &[1.0, 2.0], Interpolation::Linear).is_err());
    assert!(Curve::table(1, &[0.0, 1.0], &[1.0, 2.0], Interpolation::Linear).is_err());
    assert!(Curve::table(1, &[0.0, f64::NAN], &[1.0, 2.0], Interpolation::Linear).is_err());
    assert!(Curve::table(1, &[0.0, 0.5], &[1.0, f64::INFINITY], Interpolation::Linear).is_err());
    assert!(Curve::samples(1, &[], Interpolation::Spline).is_err());
    assert!(Curve::table(0, &[0.0, 0.5], &[1.0, 2.0], Interpolation::Linear).is_err());
    assert!(Curve::constant(f64::NAN).is_err());
}
