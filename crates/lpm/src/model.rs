//! The gear pair: three coordinates, or one when the supports are rigid or eliminated.
//!
//! Two rigid discs on elastic supports along the line of action, joined by a mesh that carries compression only
//! (dissertation D3.4.2 and Eq. (3.3), repeated as Eq. (7.1)):
//!
//! ```text
//! m_e x''   =  f_0 - F                                  x = r_p theta_p + r_g theta_g
//! m_p y_p'' + c_p y_p' + k_p y_p = -F                   delta = x + y_p - y_g
//! m_g y_g'' + c_g y_g' + k_g y_g = +F
//! F = f_0 + k_l(tau) (delta - delta_0(tau)) + c_m delta'   in contact, else 0
//! m_e = J_p J_g / (r_p^2 J_g + r_g^2 J_p),  f_0 = (r_p J_g T_p + r_g J_p T_g) / (r_p^2 J_g + r_g^2 J_p)
//! ```
//!
//! Substituting `F` gives Eq. (3.3a-c) term by term: there `f_0` cancels from the third equation and stands on
//! the right of the first two. `k_l` is the *local* slope of the force-deflection curve at the nominal load, so
//! the mesh carries `f_0` where `delta = delta_0`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `r_p`, `r_g` | `base_radius` | m |
//! | `m_p`, `m_g` | `mass` | kg |
//! | `J_p`, `J_g` | `inertia` | kg m^2 |
//! | `T_p`, `T_g` | `torque`, positive where it presses the drive flanks together | N m |
//! | `k_p`, `k_g`; `c_p`, `c_g` | `support_stiffness`, `support_damping` | N/m, N s/m |
//! | `c_m` | `mesh_damping` | N s/m |
//! | `tau = f_m t` | mesh phase, `f_m` the mesh frequency | cycles, Hz |
//!
//! **Input rotation.** With [`Input::Prescribed`] the pinion turns uniformly whatever the mesh does (its bore is
//! constrained, as in the finite-element model of the dissertation). That is the limit `J_p -> inf` of Eq. (3.3d):
//! `m_e = J_g / r_g^2`, `f_0 = T_g / r_g`. Table 3.2 then gives 2.40 kg and the natural frequencies the dissertation
//! reports (2371, 2917 Hz); free rotation gives 0.51 kg and twice these. Both are offered.
//!
//! **Separation.** The printed rule is "separate when `delta <= 0`, then `k_l -> 0`, `delta_0 -> 0`". With a local slope
//! the elastic force vanishes at `delta_0 - f_0 / k_l`, which is not zero unless the force-deflection curve is
//! straight, so the printed rule makes the force jump. [`Separation::ForceVanishes`] (default) separates where the
//! elastic force is zero; [`Separation::DeflectionVanishes`] is the printed rule. In flight the discs move under
//! `f_0` alone. Mesh damping acts in contact only, unless `damping_when_apart` (the letter of the printed rule).
//!
//! Tests: `tests/closed_form.rs`, `tests/supports.rs`; unit tests below.

use crate::error::{LpmError, check};
use crate::excitation::Excitation;
use crate::system::System;

/// One gear and its support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gear {
    /// Base radius (m), positive.
    pub base_radius: f64,
    /// Mass (kg), positive; used where the support is integrated.
    pub mass: f64,
    /// Moment of inertia about the axis (kg m^2), positive.
    pub inertia: f64,
    /// Torque (N m), positive where it loads the drive flanks; zero is allowed.
    pub torque: f64,
    /// Stiffness of the support along the line of action (N/m), positive.
    pub support_stiffness: f64,
    /// Damping of the support along the line of action (N s/m), not negative.
    pub support_damping: f64,
}

/// What the pinion's rotation does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// The pinion turns freely under its torque.
    Free,
    /// The pinion turns uniformly; only the gear swings.
    Prescribed,
}

/// How the translations of the gears on their supports are treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Supports {
    /// Both translations are coordinates: three coordinates in all.
    Integrated,
    /// The supports deflect quasi-statically, in series with the mesh: one coordinate. Error of the order of the
    /// squared ratio of mesh to support frequency.
    Eliminated,
    /// No translation: one coordinate.
    Rigid,
}

/// Where contact ends and begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separation {
    /// Where the elastic mesh force vanishes, `delta = delta_0 - f_0 / k_l`.
    ForceVanishes,
    /// Where the mesh deflection vanishes, `delta = 0`.
    DeflectionVanishes,
}

/// A gear pair without its excitation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GearPair {
    /// Driving gear.
    pub pinion: Gear,
    /// Driven gear.
    pub gear: Gear,
    /// Mesh damping (N s/m), not negative.
    pub mesh_damping: f64,
    /// Pinion rotation.
    pub input: Input,
    /// Rule for loss and gain of contact.
    pub separation: Separation,
    /// Keep mesh damping while the teeth are apart.
    pub damping_when_apart: bool,
    /// Clearance along the line of action behind which the coast flanks touch (m), positive; `None`: no coast side.
    /// The coast mesh has the stiffness and damping of the drive mesh.
    pub backlash: Option<f64>,
}

impl GearPair {
    /// The nonunity pair of Table 3.2 (Table 7.2) of the dissertation, as printed. Contact ends where the elastic force vanishes,
    /// and no damper acts in flight. The dissertation's equations keep the damper in flight (only `k_l` and `delta_0` vanish there): set
    /// `damping_when_apart` to follow them; the lower end of the range with two solutions, 1700 Hz, depends on it.
    pub fn table_3_2(input: Input) -> Self {
        let support = |base_radius, mass, inertia, torque| Gear {
            base_radius,
            mass,
            inertia,
            torque,
            support_stiffness: 1e12,
            support_damping: 800.0,
        };
        Self {
            pinion: support(35.20e-3, 0.7294, 0.0008, 327.0),
            gear: support(45.63e-3, 0.8537, 0.0050, 424.0),
            mesh_damping: 3660.0,
            input,
            separation: Separation::ForceVanishes,
            damping_when_apart: false,
            backlash: None,
        }
    }

    /// A one-mass oscillator: mass (kg), mesh damping (N s/m) and mean force (N); for studies without a gear behind them.
    pub fn oscillator(mass: f64, mesh_damping: f64, force: f64) -> Self {
        let gear = Gear {
            base_radius: 1.0,
            mass,
            inertia: mass,
            torque: force,
            support_stiffness: f64::MAX,
            support_damping: 0.0,
        };
        Self { pinion: gear, gear, mesh_damping, ..Self::table_3_2(Input::Prescribed) }
    }

    /// Moving mass `m_e` of the mesh coordinate (kg), Eq. (3.3d).
    pub fn effective_mass(&self) -> f64 {
        let (rp, rg, jp, jg) = self.radii_and_inertias();
        match self.input {
            Input::Prescribed => jg / (rg * rg),
            Input::Free => jp * jg / (rp * rp * jg + rg * rg * jp),
        }
    }

    /// Mean mesh force `f_0` (N), Eq. (3.3d).
    pub fn mean_force(&self) -> f64 {
        let (rp, rg, jp, jg) = self.radii_and_inertias();
        match self.input {
            Input::Prescribed => self.gear.torque / rg,
            Input::Free => (rp * jg * self.pinion.torque + rg * jp * self.gear.torque) / (rp * rp * jg + rg * rg * jp),
        }
    }

    /// Mesh damping that gives `ratio` of critical damping at mesh stiffness `stiffness` (N/m): `2 ratio sqrt(k m_e)` (N s/m).
    pub fn damping_for_ratio(&self, ratio: f64, stiffness: f64) -> f64 {
        2.0 * ratio * (stiffness * self.effective_mass()).sqrt()
    }

    fn radii_and_inertias(&self) -> (f64, f64, f64, f64) {
        (self.pinion.base_radius, self.gear.base_radius, self.pinion.inertia, self.gear.inertia)
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for the first number outside its range.
    pub fn validate(&self) -> Result<(), LpmError> {
        for g in [&self.pinion, &self.gear] {
            check(g.base_radius > 0.0, "base radius", g.base_radius, "m", "positive")?;
            check(g.mass > 0.0, "mass", g.mass, "kg", "positive")?;
            check(g.inertia > 0.0, "moment of inertia", g.inertia, "kg m^2", "positive")?;
            check(g.torque >= 0.0, "torque", g.torque, "N m", "zero or positive (loading the drive flanks)")?;
            check(g.support_stiffness > 0.0, "support stiffness", g.support_stiffness, "N/m", "positive")?;
            check(g.support_damping >= 0.0, "support damping", g.support_damping, "N s/m", "zero or positive")?;
        }
        check(self.mesh_damping >= 0.0, "mesh damping", self.mesh_damping, "N s/m", "zero or positive")?;
        if let Some(b) = self.backlash {
            check(b > 0.0, "backlash", b, "m", "positive")?;
        }
        check(self.effective_mass() > 0.0, "effective mass", self.effective_mass(), "kg", "positive")?;
        Ok(())
    }
}

/// Displacements and velocities: index 0 is `x` (m, m/s), 1 and 2 are `y_p` and `y_g`, zero where not coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// `x`, `y_p`, `y_g` (m).
    pub position: [f64; 3],
    /// Their rates (m/s).
    pub velocity: [f64; 3],
}

/// A gear pair with its excitation, ready to run.
#[derive(Debug, Clone)]
pub struct Model {
    pair: GearPair,
    supports: Supports,
    pub(crate) kind: Kind,
}

#[derive(Debug, Clone)]
pub(crate) enum Kind {
    One(System<1>),
    Three(System<3>),
}

/// Runs an expression with `$s` bound to the system of either size.
macro_rules! with_system {
    ($model:expr, $s:ident => $body:expr) => {
        match &$model.kind {
            $crate::model::Kind::One($s) => $body,
            $crate::model::Kind::Three($s) => $body,
        }
    };
}
pub(crate) use with_system;

impl Model {
    /// Joins pair and excitation. Fails on numbers out of range and where backlash is smaller than the drive-side deflection.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`]; [`LpmError::Jammed`] where backlash is smaller than the deflection of the drive side.
    pub fn new(pair: &GearPair, excitation: &Excitation, supports: Supports) -> Result<Self, LpmError> {
        pair.validate()?;
        let kind = match supports {
            Supports::Integrated => Kind::Three(System::three(pair, excitation)),
            Supports::Eliminated => {
                let compliance = 1.0 / pair.pinion.support_stiffness + 1.0 / pair.gear.support_stiffness;
                Kind::One(System::one(pair, excitation, compliance))
            }
            Supports::Rigid => Kind::One(System::one(pair, excitation, 0.0)),
        };
        let model = Self { pair: *pair, supports, kind };
        with_system!(model, s => s.check_backlash())?;
        Ok(model)
    }

    /// The gear pair.
    pub fn pair(&self) -> &GearPair {
        &self.pair
    }

    /// How supports are treated.
    pub fn supports(&self) -> Supports {
        self.supports
    }

    /// The excitation.
    pub fn excitation(&self) -> &Excitation {
        with_system!(self, s => s.excitation())
    }

    /// Number of coordinates, 1 or 3.
    pub fn coordinates(&self) -> usize {
        match self.kind {
            Kind::One(_) => 1,
            Kind::Three(_) => 3,
        }
    }

    /// Natural frequencies at mesh phase `tau` with the teeth in contact and no damping (Hz), ascending.
    pub fn natural_frequencies(&self, tau: f64) -> Vec<f64> {
        with_system!(self, s => s.natural_frequencies(tau))
    }

    /// Damping ratio of the mesh mode at phase `tau`, `c_m / (2 sqrt(k m_e))` with supports in series.
    pub fn damping_ratio(&self, tau: f64) -> f64 {
        with_system!(self, s => s.damping_ratio(tau))
    }

    /// Static equilibrium at phase `tau` (zero velocity): the response at vanishing speed.
    pub fn equilibrium(&self, tau: f64) -> State {
        with_system!(self, s => s.export(&s.equilibrium(tau)))
    }

    /// The same model with another excitation (a damaged pair beside its healthy twin).
    ///
    /// # Errors
    /// [`LpmError::Jammed`] where backlash is smaller than the deflection of the drive side.
    pub fn with_excitation(&self, excitation: &Excitation) -> Result<Self, LpmError> {
        Self::new(&self.pair, excitation, self.supports)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Curve;

    #[test]
    fn analytic_effective_mass_and_force_of_table_3_2() {
        let free = GearPair::table_3_2(Input::Free);
        let held = GearPair::table_3_2(Input::Prescribed);
        // Eq. (3.3d) worked by hand from the printed values.
        assert!((free.effective_mass() - 0.50885).abs() < 1e-5, "{}", free.effective_mass());
        assert!((held.effective_mass() - 2.40140).abs() < 1e-4, "{}", held.effective_mass());
        assert!((held.mean_force() - 9292.1).abs() < 0.1);
        assert!((free.mean_force() - 9290.2).abs() < 0.5);
    }

    #[test]
    fn analytic_natural_frequencies_with_stiff_and_soft_supports() -> Result<(), LpmError> {
        let e = Excitation::new(&Curve::constant(533e6)?, &Curve::constant(18e-6)?)?;
        let mut pair = GearPair::table_3_2(Input::Prescribed);
        let one = Model::new(&pair, &e, Supports::Rigid)?;
        let f = (533e6_f64 / pair.effective_mass()).sqrt() / std::f64::consts::TAU;
        assert!((one.natural_frequencies(0.3)[0] / f - 1.0).abs() < 1e-12);
        assert!((f - 2371.0).abs() < 1.0, "the dissertation's 2370.73 Hz, by its stiffness: {f}");
        let three = Model::new(&pair, &e, Supports::Integrated)?;
        let all = three.natural_frequencies(0.0);
        assert!((all[0] / f - 1.0).abs() < 2e-3 && all[0] < f, "series compliance lowers it: {all:?}");
        assert!((all[2] / ((1e12 / 0.7294_f64).sqrt() / std::f64::consts::TAU) - 1.0).abs() < 1e-3);
        // Supports without stiffness: two free masses and one mesh mode of the reduced mass.
        pair.pinion.support_stiffness = 1e-3;
        pair.gear.support_stiffness = 1e-3;
        let soft = Model::new(&pair, &e, Supports::Integrated)?.natural_frequencies(0.0);
        let inverse = 1.0 / pair.effective_mass() + 1.0 / 0.7294 + 1.0 / 0.8537;
        assert!((soft[2] / ((533e6 * inverse).sqrt() / std::f64::consts::TAU) - 1.0).abs() < 1e-9);
        Ok(())
    }

    #[test]
    fn extreme_bad_pairs_are_refused() {
        let good = GearPair::table_3_2(Input::Free);
        let mut cases = vec![good; 6];
        cases[0].pinion.inertia = 0.0;
        cases[1].gear.base_radius = f64::NAN;
        cases[2].mesh_damping = -1.0;
        cases[3].gear.torque = -1.0;
        cases[4].backlash = Some(0.0);
        cases[5].pinion.support_stiffness = f64::INFINITY;
        assert!(good.validate().is_ok());
        for (i, c) in cases.iter().enumerate() {
            assert!(c.validate().is_err(), "case {i}");
        }
    }
}
