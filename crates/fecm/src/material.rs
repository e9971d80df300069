//! Linear elastic, isotropic material.

use crate::error::FecmError;

/// Isotropic elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus `E` (Pa), positive.
    pub young_modulus: f64,
    /// Poisson's ratio `nu`, in (-1, 0.5).
    pub poisson_ratio: f64,
    /// Density (kg/m^3), positive.
    pub density: f64,
}

impl Material {
    /// Steel of the dissertation's chapter 3 (section 3.2.1): 200 GPa, 0.3, 7800 kg/m^3.
    pub const STEEL: Self = Self { young_modulus: 200e9, poisson_ratio: 0.3, density: 7800.0 };

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`FecmError::Option`] naming the constant out of range.
    pub fn validate(&self) -> Result<(), FecmError> {
        let option = |name, value, allowed| Err(FecmError::Option { name, value, allowed });
        if !(self.young_modulus > 0.0 && self.young_modulus.is_finite()) {
            return option("young_modulus", self.young_modulus, "a positive number of Pa");
        }
        if !(self.poisson_ratio > -1.0 && self.poisson_ratio < 0.5) {
            return option("poisson_ratio", self.poisson_ratio, "between -1 and 0.5, exclusive");
        }
        if !(self.density > 0.0 && self.density.is_finite()) {
            return option("density", self.density, "a positive number of kg/m^3");
        }
        Ok(())
    }

    /// Shear modulus `G = E / (2 (1 + nu))` (Pa).
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// First Lame constant `lambda = E nu / ((1 + nu)(1 - 2 nu))` (Pa).
    #[must_use]
    pub fn lame_lambda(&self) -> f64 {
        let nu = self.poisson_ratio;
        self.young_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }
}
