//! Floquet multipliers: eigenvalues of the derivative of the period map.
//!
//! A periodic solution is stable when every multiplier lies inside the unit circle. A real multiplier that leaves through
//! +1 marks a turning point (saddle-node), through -1 a period doubling; a complex pair that leaves marks a
//! Neimark-Sacker (secondary Hopf) bifurcation.
//!
//! For one coordinate the eigenvalues of the 2 by 2 matrix are in closed form; for three, the Schur form of a
//! balanced 6 by 6 matrix.
//!
//! Tests: `tests/floquet.rs` (two-stage stiffness in closed form, Mathieu tongues, saltation against differences).

use crate::error::LpmError;
use crate::excitation::Excitation;
use crate::integrate::{Cursor, Options, Runner};
use crate::model::{GearPair, Model, Supports, with_system};
use crate::periodic::resolved;
use crate::system::{System, Vector};
use nalgebra::DMatrix;

/// One Floquet multiplier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multiplier {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Multiplier {
    /// Modulus.
    pub fn modulus(&self) -> f64 {
        self.re.hypot(self.im)
    }
}

/// How a periodic solution is unstable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// Every multiplier inside the unit circle.
    Stable,
    /// A real multiplier above +1.
    Saddle,
    /// A real multiplier below -1.
    Flip,
    /// A complex pair outside.
    Torus,
}

/// Classifies by the multiplier of largest modulus.
pub fn stability(multipliers: &[Multiplier]) -> Stability {
    match multipliers.iter().max_by(|a, b| a.modulus().total_cmp(&b.modulus())) {
        Some(m) if m.modulus() > 1.0 => match (m.im == 0.0, m.re > 0.0) {
            (true, true) => Stability::Saddle,
            (true, false) => Stability::Flip,
            _ => Stability::Torus,
        },
        _ => Stability::Stable,
    }
}

impl Model {
    /// Multipliers of the pair *in permanent contact* (no contact loss, so the load does not matter) at
    /// `mesh_frequency` (Hz) over one period of the excitation: the parametric stability of small vibrations.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for a frequency or option outside its range; [`LpmError::Singular`] where the period map has no eigenvalues;
    /// errors of the integration, as [`Model::simulate`].
    pub fn parametric_multipliers(&self, mesh_frequency: f64, options: &Options) -> Result<Vec<Multiplier>, LpmError> {
        // Same stiffness, no load, no transmission error, nothing to leave: the zero solution stays in contact.
        let mut pair: GearPair = *self.pair();
        (pair.pinion.torque, pair.gear.torque, pair.backlash) = (0.0, 0.0, None);
        let flat = crate::curve::Curve::constant(0.0)?;
        let excitation = Excitation::new(self.excitation().mesh_stiffness(), &flat)?;
        let model = Model::new(&pair, &excitation, self.supports())?;
        debug_assert!(model.supports() != Supports::Integrated || model.coordinates() == 3);
        with_system!(model, s => {
            let run = Runner { control_tangents: true, ..Runner::new(s, options, mesh_frequency)? };
            let by = resolved(s, run.method);
            let mut cursor = Cursor::with_tangents(0.0, Vector::ZERO, &by);
            run.advance(&mut cursor, excitation.period() as f64, |_| {})?;
            multipliers(s, &by, &cursor.tangents)
        })
    }
}

/// Eigenvalues of the derivative by the components `by` whose columns are `columns`, largest modulus first.
pub(crate) fn multipliers<const N: usize>(
    s: &System<N>,
    by: &[usize],
    columns: &[Vector<N>],
) -> Result<Vec<Multiplier>, LpmError> {
    let n = by.len();
    // In natural units displacement and velocity entries are alike in size.
    let entry = |i: usize, j: usize| columns[j].get(by[i]) * s.unit(by[j]) / s.unit(by[i]);
    let mut found = if n == 2 {
        let (a, b, c, d) = (entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1));
        let (half, det) = (0.5 * (a + d), a * d - b * c);
        let disc = 0.25 * (a - d) * (a - d) + b * c;
        if disc < 0.0 {
            let im = (-disc).sqrt();
            vec![Multiplier { re: half, im }, Multiplier { re: half, im: -im }]
        } else {
            let large = half + disc.sqrt().copysign(half);
            let small = if large == 0.0 { 0.0 } else { det / large };
            vec![Multiplier { re: large, im: 0.0 }, Multiplier { re: small, im: 0.0 }]
        }
    } else {
        let m = DMatrix::from_fn(n, n, entry);
        if !m.iter().all(|v| v.is_finite()) {
            return Err(LpmError::Singular { place: "period map" });
        }
        let schur = nalgebra::Schur::try_new(m, f64::EPSILON, 10_000)
            .ok_or(LpmError::Singular { place: "eigenvalues of the period map" })?;
        schur.complex_eigenvalues().iter().map(|c| Multiplier { re: c.re, im: c.im }).collect()
    };
    found.sort_by(|a, b| b.modulus().total_cmp(&a.modulus()));
    if found.iter().all(|m| m.modulus().is_finite()) {
        Ok(found)
    } else {
        Err(LpmError::Singular { place: "period map" })
    }
}
