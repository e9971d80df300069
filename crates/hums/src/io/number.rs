//! Decimal text to `f64`, correctly rounded.
//!
//! A number with mantissa `m <= 2^53` and decimal exponent `|e| <= 22` is `m * 10^e` or `m / 10^-e` of
//! two exact doubles, hence correctly rounded by one operation (Clinger 1990, PLDI). All others go to
//! the standard library's parser.

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Parses the number at the start of `text`: value and length. `None` when there is none.
/// `decimal` is the decimal mark. Infinity and NaN are not numbers here.
#[inline]
pub(super) fn parse(text: &[u8], decimal: u8) -> Option<(f64, usize)> {
    let mut at = 0;
    let negative = match text.first() {
        Some(b'-') => {
            at = 1;
            true
        }
        Some(b'+') => {
            at = 1;
            false
        }
        _ => false,
    };
    let mut mantissa: u64 = 0;
    let mut exact = true;
    let start = at;
    while let Some(digit) = text.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        exact &= mantissa < 900_719_925_474_099;
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    let mut digits = at - start;
    let mut exponent: i64 = 0;
    if text.get(at) == Some(&decimal) {
        at += 1;
        let fraction = at;
        while let Some(digit) = text.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            exact &= mantissa < 900_719_925_474_099;
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            at += 1;
        }
        exponent = -((at - fraction) as i64);
        digits += at - fraction;
    }
    if digits == 0 {
        return None;
    }
    if let Some(b'e' | b'E') = text.get(at) {
        let mut end = at + 1;
        let falling = text.get(end) == Some(&b'-');
        if let Some(b'-' | b'+') = text.get(end) {
            end += 1;
        }
        let first = end;
        let mut power: i64 = 0;
        while let Some(digit) = text.get(end).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            power = (power * 10 + i64::from(digit)).min(100_000);
            end += 1;
        }
        if end > first {
            exponent += if falling { -power } else { power };
            at = end;
        }
    }
    if exact && (-22..=22).contains(&exponent) {
        let m = mantissa as f64;
        let value = if exponent < 0 { m / POWERS[(-exponent) as usize] } else { m * POWERS[exponent as usize] };
        return Some((if negative { -value } else { value }, at));
    }
    let slow: String = text[..at].iter().map(|b| if *b == decimal { '.' } else { *b as char }).collect();
    let value: f64 = slow.parse().ok()?;
    value.is_finite().then_some((value, at))
}
