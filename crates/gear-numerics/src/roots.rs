//! Zeros of functions of one variable.

/// Bisection: narrows `[low, high]` by at most `halvings` halvings around the place where `is_low` turns from true to false.
///
/// `is_low` holds at `low` and not at `high`; neither end is evaluated. `low > high` is allowed. Ends early when the two are neighbouring
/// numbers. 60 halvings find a place of the order of the bracket to the last bit.
pub fn bisect([mut low, mut high]: [f64; 2], halvings: usize, mut is_low: impl FnMut(f64) -> bool) -> (f64, f64) {
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        if middle == low || middle == high {
            break;
        }
        if is_low(middle) { low = middle } else { high = middle }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_root_of_two_to_the_last_bit() {
        let (low, high) = bisect([1.0, 2.0], 200, |x| x * x < 2.0);
        assert!(low * low < 2.0 && high * high >= 2.0);
        assert_eq!(low.to_bits() + 1, high.to_bits());
        let (low, high) = bisect([2.0, 1.0], 200, |x| x * x > 2.0);
        assert_eq!(high.to_bits() + 1, low.to_bits());
    }

    #[test]
    fn invariant_each_halving_evaluates_once() {
        let mut calls = 0;
        let (low, high) = bisect([0.0, 1.0], 10, |x| {
            calls += 1;
            x < 0.3
        });
        assert_eq!(calls, 10);
        assert_eq!(high - low, 1.0 / 1024.0);
    }

    #[test]
    fn extreme_not_a_number_ends() {
        let (low, high) = bisect([f64::NAN, 1.0], 60, |x| x < 0.5);
        assert!(low.is_nan() || high.is_nan());
    }
}
