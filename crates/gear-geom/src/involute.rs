//! The involute of a circle.
//!
//! With pressure angle `cos(alpha) = r_b / r` at radius `r`: `inv(alpha) = tan(alpha) - alpha`, roll angle `tan(alpha)`, roll distance
//! `s = r_b tan(alpha) = sqrt(r^2 - r_b^2)`, arc length from the base circle `s^2 / (2 r_b)` (Litvin and Fuentes, *Gear Geometry and
//! Applied Theory*, 2004, section 10.2).

/// `inv(alpha) = tan(alpha) - alpha` (rad).
#[must_use]
pub fn involute(alpha: f64) -> f64 {
    alpha.tan() - alpha
}

/// Roll distance (m) at a radius (m); 0 inside the base circle.
#[must_use]
pub fn roll_distance(base_radius: f64, radius: f64) -> f64 {
    (radius * radius - base_radius * base_radius).max(0.0).sqrt()
}

/// Radius (m) at a roll distance (m).
#[must_use]
pub fn radius_at_roll(base_radius: f64, roll: f64) -> f64 {
    base_radius.hypot(roll)
}

/// `inv(alpha)` at a roll distance.
#[must_use]
pub fn involute_at_roll(base_radius: f64, roll: f64) -> f64 {
    let ratio = roll / base_radius;
    ratio - ratio.atan()
}

/// Involute arc length from the base circle (m) at a roll distance (m).
#[must_use]
pub fn arc_length(base_radius: f64, roll: f64) -> f64 {
    roll * roll / (2.0 * base_radius)
}

/// Angle whose involute is `value`, by Newton's method from a cubic start; 0 for values that are not positive.
#[must_use]
pub fn inverse_involute(value: f64) -> f64 {
    if !(value > 0.0) {
        return 0.0;
    }
    let mut alpha = (3.0 * value).cbrt().min(1.5);
    for _ in 0..60 {
        let tangent = alpha.tan();
        let step = (tangent - alpha - value) / (tangent * tangent);
        alpha = (alpha - step).clamp(1e-12, std::f64::consts::FRAC_PI_2 - 1e-12);
        if step.abs() < 1e-15 {
            break;
        }
    }
    alpha
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_involute_of_twenty_degrees() {
        // standard table value, e.g. Litvin and Fuentes, table of involute functions
        assert!((involute(20_f64.to_radians()) - 0.014_904_383_9).abs() < 1e-10);
    }

    #[test]
    fn invariant_inverse_involute() {
        for k in 1..150 {
            let alpha = f64::from(k) * 0.01;
            assert!((inverse_involute(involute(alpha)) - alpha).abs() < 1e-11, "alpha = {alpha}");
        }
    }

    #[test]
    fn invariant_arc_length_is_the_integral_of_roll_angle() {
        let (base, end) = (0.04, 0.015);
        let n = 20_000;
        let sum: f64 = (0..n).map(|k| (f64::from(k) + 0.5) / f64::from(n) * end / base * (end / f64::from(n))).sum();
        assert!((sum - arc_length(base, end)).abs() < 1e-12);
    }
}
