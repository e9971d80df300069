//! How displacements vary along the face of an extruded body.
//!
//! A spur gear is an extrusion: a displacement component is `u_c(x, y, z) = sum_a psi_a(z) u_ca(x, y)`, with `u_ca`
//! interpolated by the plane mesh. Three bases share all other code:
//!
//! * plane stress and plane strain: one constant function, two components;
//! * solid: Legendre polynomials `P_a(2 z / b)` up to an order, three components, both end faces free.
//!
//! Mirror symmetry about mid-face splits the solid into two independent families ([`Parity`]): `u_x, u_y` even with
//! `u_z` odd, and the reverse. A scene that is symmetric about mid-face needs the first only, which quarters the
//! memory and divides dense work by eight.
//!
//! The stiffness needs the four integrals over the face (`c = b / 2`; all closed forms of Legendre's):
//! `int P_a P_b dz = 2 c / (2 a + 1)` for `a = b`, `int P_a P_b' dz = 2` for `b > a`, `a + b` odd, and
//! `int P_a' P_b' dz = m (m + 1) / c`, `m = min(a, b)`, for `a + b` even.

use crate::element::lagrange::legendre;
use crate::material::Material;

/// Behaviour of the body across its face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceModel {
    /// No stress across the face: thin bodies.
    PlaneStress,
    /// No strain across the face: wide bodies.
    PlaneStrain,
    /// Three-dimensional, Legendre polynomials along the face up to this order.
    Solid {
        /// Highest polynomial order along the face.
        order: usize,
    },
}

/// Symmetry family of a solid about mid-face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// `u_x`, `u_y` even in `z`, `u_z` odd.
    Symmetric,
    /// `u_x`, `u_y` odd in `z`, `u_z` even.
    Antisymmetric,
    /// Both at once, coupled: for bodies that are not their own image about mid-face.
    Both,
}

/// One displacement function along the face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaceDof {
    /// 0, 1, 2 for x, y, z.
    pub component: usize,
    /// Degree of the Legendre polynomial.
    pub degree: usize,
}

/// Integrals over the face of two functions `a`, `b` (`'` = d/dz).
#[derive(Debug, Clone, Copy, Default)]
pub struct FaceIntegrals {
    /// `int psi_a psi_b dz` (m).
    pub value_value: f64,
    /// `int psi_a psi_b' dz`.
    pub value_slope: f64,
    /// `int psi_a' psi_b dz`.
    pub slope_value: f64,
    /// `int psi_a' psi_b' dz` (1/m).
    pub slope_slope: f64,
}

/// Basis along the face: the degrees of freedom of one plane node.
#[derive(Debug, Clone)]
pub struct FaceBasis {
    width: f64,
    dofs: Vec<FaceDof>,
    plane_degrees: Vec<usize>,
    lambda: f64,
    shear: f64,
}

impl FaceBasis {
    /// Basis for a body of facewidth `width` (m). Plane models have no antisymmetric family (`None`).
    #[must_use]
    pub fn new(model: FaceModel, parity: Parity, width: f64, material: &Material) -> Option<Self> {
        let (lambda, shear) = (material.lame_lambda(), material.shear_modulus());
        let plane_stress_lambda = 2.0 * lambda * shear / (lambda + 2.0 * shear);
        let (lambda, order) = match model {
            FaceModel::PlaneStress => (plane_stress_lambda, None),
            FaceModel::PlaneStrain => (lambda, None),
            FaceModel::Solid { order } => (lambda, Some(order)),
        };
        let (plane_first, axial_first, step) = match parity {
            Parity::Symmetric => (0, 1, 2),
            Parity::Antisymmetric => (1, 0, 2),
            Parity::Both => (0, 0, 1),
        };
        if order.is_none() && parity == Parity::Antisymmetric {
            return None;
        }
        let plane_degrees: Vec<usize> = (plane_first..=order.unwrap_or(0)).step_by(step).collect();
        let plane = plane_degrees.iter().flat_map(|&degree| [0, 1].map(|component| FaceDof { component, degree }));
        let axial = order.map(|order| (axial_first..=order).step_by(step)).into_iter().flatten();
        let dofs = plane.chain(axial.map(|degree| FaceDof { component: 2, degree })).collect();
        Some(Self { width, dofs, plane_degrees, lambda, shear })
    }

    /// Facewidth (m).
    #[must_use]
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Degrees of freedom of a plane node: `(u_x, u_y)` of each plane degree in turn, then `u_z`.
    #[must_use]
    pub fn dofs(&self) -> &[FaceDof] {
        &self.dofs
    }

    /// Number of degrees of freedom of a plane node.
    #[must_use]
    pub fn block(&self) -> usize {
        self.dofs.len()
    }

    /// Degrees along the face of `u_x` and `u_y`.
    #[must_use]
    pub fn plane_degrees(&self) -> &[usize] {
        &self.plane_degrees
    }

    /// First Lame constant that acts in the plane (Pa): reduced for plane stress.
    #[must_use]
    pub fn lambda(&self) -> f64 {
        self.lambda
    }

    /// Shear modulus (Pa).
    #[must_use]
    pub fn shear(&self) -> f64 {
        self.shear
    }

    /// Value of the function of one degree at face position `z` (m, 0 at mid-face).
    #[must_use]
    pub fn value(&self, degree: usize, z: f64) -> f64 {
        legendre(degree, 2.0 * z / self.width).0
    }

    /// Value, slope (1/m) and curvature (1/m^2) of the function of one degree at face position `z` (m).
    #[must_use]
    pub fn derivatives(&self, degree: usize, z: f64) -> [f64; 3] {
        let (x, scale) = (2.0 * z / self.width, 2.0 / self.width);
        let (value, slope) = legendre(degree, x);
        let n = degree as f64;
        let rest = 1.0 - x * x;
        // Legendre's equation; at the ends of the interval its limit
        let curvature = if rest.abs() > 1e-9 {
            (2.0 * x * slope - n * (n + 1.0) * value) / rest
        } else {
            let sign = if x < 0.0 && degree % 2 == 1 { -1.0 } else { 1.0 };
            sign * (n - 1.0) * n * (n + 1.0) * (n + 2.0) / 8.0
        };
        [value, scale * slope, scale * scale * curvature]
    }

    /// Values of the in-plane functions at `z`, in the order of [`Self::plane_degrees`].
    #[must_use]
    pub fn plane_values(&self, z: f64) -> Vec<f64> {
        self.plane_degrees.iter().map(|&degree| self.value(degree, z)).collect()
    }

    /// `int psi_a^2 dz` of the in-plane functions (m).
    #[must_use]
    pub fn plane_norms(&self) -> Vec<f64> {
        self.plane_degrees.iter().map(|&degree| self.integrals(degree, degree).value_value).collect()
    }

    /// Integrals over the face of the functions of degrees `a` and `b`.
    #[must_use]
    pub fn integrals(&self, a: usize, b: usize) -> FaceIntegrals {
        let half = 0.5 * self.width;
        let odd = (a + b) % 2 == 1;
        let lower = a.min(b) as f64;
        FaceIntegrals {
            value_value: if a == b { self.width / (2.0 * a as f64 + 1.0) } else { 0.0 },
            value_slope: if odd && b > a { 2.0 } else { 0.0 },
            slope_value: if odd && a > b { 2.0 } else { 0.0 },
            slope_slope: if odd { 0.0 } else { lower * (lower + 1.0) / half },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::lagrange::gauss_rule;

    #[test]
    fn analytic_face_integrals_equal_quadrature() {
        let width = 0.032;
        let basis = FaceBasis::new(FaceModel::Solid { order: 7 }, Parity::Symmetric, width, &Material::STEEL).unwrap();
        for a in 0..8 {
            for b in 0..8 {
                let (mut vv, mut vs, mut ss) = (0.0, 0.0, 0.0);
                for (x, w) in gauss_rule(12) {
                    let ((p, dp), (q, dq)) = (legendre(a, x), legendre(b, x));
                    let half = 0.5 * width;
                    vv += w * half * p * q;
                    vs += w * p * dq;
                    ss += w * dp * dq / half;
                }
                let closed = basis.integrals(a, b);
                assert!((closed.value_value - vv).abs() < 1e-14);
                assert!((closed.value_slope - vs).abs() < 1e-11);
                assert!((closed.slope_slope - ss).abs() < 1e-9 * ss.abs().max(1.0));
            }
        }
    }
}
