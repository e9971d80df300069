//! Functions that live on a part of the face only.
//!
//! On a part `[p, q]` of the face, `t = (2 z - p - q) / (q - p)`, the functions are `w(t) P_k(t)` with Legendre's polynomials `P_k` and the weight `w` a
//! factor `(1 -+ t) / 2` for every end at which they vanish; elsewhere on the face they are 0. An end that is an end of the face carries no
//! factor: on the whole face they are the functions of [`FaceBasis`](crate::face::FaceBasis). A crack front inside the face is an end at which
//! the jump across the crack vanishes.

use crate::element::lagrange::{gauss_rule, legendre};
use crate::face::FaceIntegrals;

/// A part of the face and what holds at its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacePart {
    /// Ends (m, 0 at mid-face), ascending.
    pub ends: [f64; 2],
    /// Whether the functions vanish there.
    pub vanishes: [bool; 2],
}

impl FacePart {
    /// A face of a width (m) as a whole.
    #[must_use]
    pub fn whole(width: f64) -> Self {
        Self { ends: [-0.5 * width, 0.5 * width], vanishes: [false, false] }
    }

    /// The part between two places of a face of a width (m), with functions that vanish at those inside it.
    #[must_use]
    pub fn within(width: f64, ends: [f64; 2]) -> Self {
        let half = 0.5 * width;
        Self { ends, vanishes: [ends[0] > -half, ends[1] < half] }
    }

    /// Length (m).
    #[must_use]
    pub fn length(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }

    /// Value and slope (1/m) of the function of a degree at a face position (m).
    #[must_use]
    pub fn value(&self, degree: usize, z: f64) -> (f64, f64) {
        if z < self.ends[0] || z > self.ends[1] {
            return (0.0, 0.0);
        }
        let scale = 2.0 / self.length();
        let t = scale * (z - self.ends[0]) - 1.0;
        let (mut value, mut slope) = legendre(degree, t);
        for (vanishes, sign) in self.vanishes.into_iter().zip([1.0, -1.0]) {
            if vanishes {
                let factor = 0.5 * (1.0 + sign * t);
                slope = slope * factor + 0.5 * sign * value;
                value *= factor;
            }
        }
        (value, scale * slope)
    }

    /// Integrals over the face of this part's function of degree `a` and another's of degree `b`, exact.
    #[must_use]
    pub fn integrals(&self, a: usize, other: &Self, b: usize) -> FaceIntegrals {
        let (from, to) = (self.ends[0].max(other.ends[0]), self.ends[1].min(other.ends[1]));
        let mut sum = FaceIntegrals::default();
        if from >= to {
            return sum;
        }
        let half = 0.5 * (to - from);
        // a factor a vanishing end: at most two for either function
        for (x, weight) in gauss_rule((a + b + 4) / 2 + 1) {
            let z = from + half * (1.0 + x);
            let weight = half * weight;
            let ((p, dp), (q, dq)) = (self.value(a, z), other.value(b, z));
            sum.value_value += weight * p * q;
            sum.value_slope += weight * p * dq;
            sum.slope_value += weight * dp * q;
            sum.slope_slope += weight * dp * dq;
        }
        sum
    }
}

/// As many functions along the face as a node has of one component: each of a degree on a part.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceFunctions(Vec<(FacePart, usize)>);

impl FaceFunctions {
    /// The functions of degrees 0 to `order` on one part.
    #[must_use]
    pub fn on_part(part: FacePart, order: usize) -> Self {
        Self((0..=order).map(|degree| (part, degree)).collect())
    }

    /// One function on each of `order + 1` equal layers of a face of a width (m), of one degree and 0 at the layer's ends. Together with the functions on
    /// the whole face they are independent for any number of degrees below `order`: a polynomial of degree at most `order` does not vanish at all
    /// ends of layers.
    #[must_use]
    pub fn on_layers(width: f64, order: usize, degree: usize) -> Self {
        let end = |k: usize| width * (k as f64 / (order + 1) as f64 - 0.5);
        Self((0..=order).map(|k| (FacePart { ends: [end(k), end(k + 1)], vanishes: [true, true] }, degree)).collect())
    }

    /// Integrals over the face of function `a` and another's function `b`, exact.
    #[must_use]
    pub fn integrals(&self, a: usize, other: &Self, b: usize) -> FaceIntegrals {
        let ((first, m), (second, n)) = (&self.0[a], &other.0[b]);
        first.integrals(*m, second, *n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Material;
    use crate::face::{FaceBasis, FaceModel, Parity};

    #[test]
    fn analytic_whole_face_is_the_face_basis() {
        let width = 0.032;
        let basis = FaceBasis::new(FaceModel::Solid { order: 8 }, Parity::Both, width, &Material::STEEL).unwrap();
        let whole = FacePart::whole(width);
        let largest = basis.integrals(8, 8).slope_slope;
        for a in 0..9 {
            for b in 0..9 {
                let (own, closed) = (whole.integrals(a, &whole, b), basis.integrals(a, b));
                assert!((own.value_value - closed.value_value).abs() < 1e-15);
                assert!((own.value_slope - closed.value_slope).abs() < 1e-12);
                assert!((own.slope_value - closed.slope_value).abs() < 1e-12);
                assert!((own.slope_slope - closed.slope_slope).abs() < 1e-13 * largest);
            }
        }
    }

    #[test]
    fn analytic_parts_of_the_face() {
        let width = 4.0;
        let part = FacePart::within(width, [-1.0, 2.0]);
        assert_eq!(part.vanishes, [true, false]);
        assert_eq!((part.value(3, -1.0).0, part.value(3, -1.5), part.value(0, 2.0).0), (0.0, (0.0, 0.0), 1.0));
        // (z + 1) / 3 against 1 and against z / 2
        let whole = FacePart::whole(width);
        let integrals = part.integrals(0, &whole, 1);
        assert!((integrals.value_value - 0.75).abs() < 1e-14, "{integrals:?}");
        assert!((integrals.value_slope - 0.75).abs() < 1e-14 && (integrals.slope_value - 0.25).abs() < 1e-14);
        assert!((integrals.slope_slope - 0.5).abs() < 1e-14);
        let inner = FacePart::within(width, [-1.5, 0.5]);
        assert_eq!(inner.vanishes, [true, true]);
        let other = FacePart::within(width, [0.5, 2.0]);
        assert_eq!(inner.integrals(2, &other, 2).slope_slope, 0.0);
        // slopes against differences
        for degree in 0..5 {
            let (z, step) = (-0.3, 1e-5);
            let slope = (inner.value(degree, z + step).0 - inner.value(degree, z - step).0) / (2.0 * step);
            assert!((inner.value(degree, z).1 - slope).abs() < 1e-8 * slope.abs().max(1.0));
        }
    }
}
