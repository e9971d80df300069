//! Geometry of involute spur gears: flanks, fillets, micro-geometry, landmarks and mesh kinematics.
//!
//! | module | holds |
//! |---|---|
//! | [`involute`] | the involute function and its inverse; roll distance, radius, arc length |
//! | [`fillet`] | fillets: rack trochoid, shaper trochoid, circular arc |
//! | [`outline`] | half a tooth from mid-space to the middle of its tip, exact and without gaps in slope |
//! | [`modification`] | relief, crown, end relief, slope, measured deviation |
//! | [`gear`] | one gear: specification, checks, derived sizes; [`Gear::inertia`] |
//! | [`pair`] | two gears in mesh: working angle, contact ratio, backlash, interference, landmarks, kinematics |
//! | [`bevel`] | spiral bevel gears: cones, virtual spur gears, line of action |
//! | [`planetary_train`] | sun, planets and ring: assembly, speeds, mesh phases, which tooth meets which when |
//!
//! Conventions. SI units and radians. In a gear's own frame the axis is `z`, mid-face is `z = 0`, and tooth 0 is centred on `+x`; tooth
//! `k` follows at `2 pi k / N` counter-clockwise. The profile coordinate is the *roll distance* `s = sqrt(r^2 - r_b^2)` (m), measured
//! along the line of action from the base tangent point.
//!
//! ```
//! use gear_geom::{Gear, GearPair, GearSpec, ToothThickness};
//!
//! // 27 teeth with a profile shift of 0.05 and 35 teeth, module 3 mm, at 0.2 mm more than their standard centre distance
//! let pinion = GearSpec::standard(27, 3e-3).with(|gear| gear.thickness = ToothThickness::ProfileShift(0.05));
//! let pair = GearPair::new(Gear::new(&pinion)?, Gear::new(&GearSpec::standard(35, 3e-3))?, 93.2e-3)?;
//! assert!((pair.contact_ratio() - 1.59).abs() < 0.02, "{}", pair.contact_ratio());
//! # Ok::<(), gear_geom::GeometryErrors>(())
//! ```
//!
//! A spur pair by the standard, its contact ratio:
//!
//! ```
//! use gear_geom::{Gear, GearPair, GearSpec};
//!
//! let gear = Gear::new(&GearSpec::standard(25, 6e-3))?;
//! let pair = GearPair::new(gear.clone(), gear, 150e-3)?;
//! assert!((pair.contact_ratio() - 1.61).abs() < 0.006);
//! # Ok::<(), gear_geom::GeometryErrors>(())
//! ```

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, clippy::print_stderr)
)]

pub mod bevel;
pub mod damage;
pub mod error;
pub mod fillet;
pub mod gear;
mod inertia;
pub mod involute;
pub mod modification;
pub mod outline;
pub mod pair;
pub mod planetary_train;

pub use bevel::{BevelPair, BevelPlacement, BevelSpec, Hand, LineOfAction};
pub use damage::{
    BrokenCorner, CrackFront, CrackLength, CrackPath, CrackStart, Damage, Pit, PitShape, ProfileMeasure, RootCrack,
    ToothDamage,
};
pub use error::{GeometryError, GeometryErrors, TrainError};
pub use fillet::{Fillet, FilletSpec};
pub use gear::{FlankSide, Gear, GearKind, GearSpec, ToothThickness};
pub use inertia::GearInertia;
pub use modification::{EndRelief, FlankModification, MeasuredDeviation, ProfileRelief, ReliefShape};
pub use outline::{HalfToothOutline, OutlineSegment};
pub use pair::{Finding, GearPair, Landmark, Landmarks, Member};
pub use planetary_train::{
    CentralMember, Engagement, MeshSite, PlanetaryTrain, PlanetaryTrainSpec, TrainSpeeds, TrainTooth,
};
