//! Geometry of involute spur gears: flanks, fillets, micro-geometry, landmarks and mesh kinematics.
//!
//! | module | holds |
//! |---|---|
//! | [`involute`] | the involute function and its inverse; roll distance, radius, arc length |
//! | [`fillet`] | fillets: rack trochoid, shaper trochoid, circular arc |
//! | [`outline`] | half a tooth from mid-space to the middle of its tip, exact and without gaps in slope |
//! | [`modification`] | relief, crown, end relief, slope, measured deviation |
//! | [`gear`] | one gear: specification, checks, derived sizes |
//! | [`pair`] | two gears in mesh: working angle, contact ratio, backlash, interference, landmarks, kinematics |
//! | [`bevel`] | spiral bevel gears: cones, virtual spur gears, line of action |
//! | [`planetary_train`] | sun, planets and ring: assembly, speeds, mesh phases, which tooth meets which when |
//!
//! Conventions. SI units and radians. In a gear's own frame the axis is `z`, mid-face is `z = 0`, and tooth 0 is centred on `+x`; tooth
//! `k` follows at `2 pi k / N` counter-clockwise. The profile coordinate is the *roll distance* `s = sqrt(r^2 - r_b^2)` (m), measured
//! along the line of action from the base tangent point.
//!
//! ```
//! use gear_geom::{FilletSpec, Gear, GearKind, GearPair, GearSpec, ToothThickness};
//! let spec = |teeth: u32| GearSpec {
//!     kind: GearKind::External,
//!     teeth,
//!     module: 6e-3,
//!     pressure_angle: 20_f64.to_radians(),
//!     thickness: ToothThickness::ProfileShift(0.0),
//!     tip_radius: 81e-3,
//!     root_radius: 67.5e-3,
//!     rim_radius: 30e-3,
//!     facewidth: 16e-3,
//!     fillet: FilletSpec::Rack { tip_radius: 0.38 * 6e-3 },
//!     tip_round: 0.1e-3,
//!     ..GearSpec::default()
//! };
//! let pair = GearPair::new(Gear::new(&spec(25))?, Gear::new(&spec(25))?, 150e-3)?;
//! assert!((pair.contact_ratio() - 1.61).abs() < 0.02);
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
pub use modification::{EndRelief, FlankModification, MeasuredDeviation, ProfileRelief, ReliefShape};
pub use outline::{HalfToothOutline, OutlineSegment};
pub use pair::{Finding, GearPair, Landmark, Landmarks, Member};
pub use planetary_train::{
    CentralMember, Engagement, MeshSite, PlanetaryTrain, PlanetaryTrainSpec, TrainSpeeds, TrainTooth,
};
