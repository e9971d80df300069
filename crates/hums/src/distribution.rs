//! Quantiles of Student's t, by the regularised incomplete beta function.

use std::f64::consts::PI;

/// Logarithm of the gamma function for x > 0 (Lanczos 1964, g = 7, nine terms; relative error 1e-15).
fn ln_gamma(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    if x < 0.5 {
        return (PI / (PI * x).sin()).ln() - ln_gamma(1.0 - x);
    }
    let x = x - 1.0;
    let sum = COEFFICIENTS.iter().enumerate().skip(1).fold(COEFFICIENTS[0], |sum, (k, c)| sum + c / (x + k as f64));
    let t = x + 7.5;
    0.5 * (2.0 * PI).ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// Regularised incomplete beta function I_x(a, b), by its continued fraction (Lentz's method; DLMF 8.17.22).
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp() / a;
    let tiny = 1e-300;
    let guard = |v: f64| if v.abs() < tiny { tiny } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / guard(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for m in 1..10_000 {
        let k = f64::from(m);
        for numerator in [
            k * (b - k) * x / ((a + 2.0 * k - 1.0) * (a + 2.0 * k)),
            -(a + k) * (a + b + k) * x / ((a + 2.0 * k) * (a + 2.0 * k + 1.0)),
        ] {
            d = 1.0 / guard(1.0 + numerator * d);
            c = guard(1.0 + numerator / c);
            fraction *= c * d;
        }
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * fraction
}

/// Upper tail P(T > t) of Student's t for t >= 0.
fn upper_tail(t: f64, degrees: f64) -> f64 {
    0.5 * incomplete_beta(degrees / 2.0, 0.5, degrees / (degrees + t * t))
}

/// Quantile of Student's t with `degrees` (>= 1) degrees of freedom, for a probability in [0.5, 1); the largest double
/// where the quantile is beyond it.
pub(crate) fn student_t_quantile(probability: f64, degrees: f64) -> f64 {
    // The tail keeps its digits as the probability nears 1.
    let tail = 1.0 - probability;
    let (mut low, mut high) = (0.0, 1.0);
    while upper_tail(high, degrees) > tail && high < 1e300 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if upper_tail(middle, degrees) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms for 1 and 2 degrees of freedom, tables for others.
    #[test]
    fn analytic_quantiles_of_t() {
        for p in [0.5, 0.6, 0.9, 0.975, 0.999, 0.999_999] {
            let cauchy = (PI * (p - 0.5)).tan();
            let two = (2.0 * p - 1.0) * (2.0 / (4.0 * p * (1.0 - p))).sqrt();
            assert!((student_t_quantile(p, 1.0) - cauchy).abs() <= 1e-9 * cauchy.max(1e-3), "{p}");
            assert!((student_t_quantile(p, 2.0) - two).abs() <= 1e-9 * two.max(1e-3), "{p}");
        }
        for (p, degrees, expected) in
            [(0.975, 5.0, 2.570_582), (0.995, 10.0, 3.169_273), (0.95, 30.0, 1.697_261), (0.975, 1e6, 1.959_966)]
        {
            assert!((student_t_quantile(p, degrees) - expected).abs() < 1e-5, "{p} {degrees}");
        }
    }
}
