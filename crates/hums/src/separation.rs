//! Vibration separation: averages of single planets and of the sun from a sensor on the ring.
//!
//! Problem. A sensor fixed to the ring hears a planet best as it passes. Meshes of all planets run at
//! one frequency, so a plain synchronous average cannot tell planets, or planet from sun.
//!
//! Method (McFadden 1991, J. Vib. Acoust. 113:222; McFadden 1994, Mech. Syst. Signal Process. 8:345).
//! While a planet passes the sensor, a window of a few mesh cycles is cut out. The mesh count m =
//! `c z_r` (c carrier turns, z_r ring teeth) says which tooth meshes then: planet tooth `m mod z_p`,
//! sun tooth `m - psi z_s mod z_s` for a planet at carrier angle `psi` (turns). Each window is added at
//! its teeth; dividing by the sum of windows gives an average over the planet's (or sun's) own
//! turn. After `z_p / gcd(z_r, z_p)` passes the teeth at the sensor repeat. Several sensors at ring angles
//! `theta` (Samuel and Pines 2001, AHS Forum 57) fill the turn faster: a planet passes sensor theta
//! at `c = theta - psi`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | z_r, z_p, z_s | `ring_teeth`, `planet_teeth`, `sun_teeth` | - |
//! | psi | `planet_angles` (in the carrier, in the sense of its rotation) | turns |
//! | theta | `sensor_angles` | turns |
//! | S | `samples_per_mesh` | - |
//! | W | `window_teeth` | mesh cycles |
//!
//! Records are in carrier angle, `z_r S` samples a carrier turn: [`crate::resample::to_angle`]. The
//! window's centre is placed on the nearest sample; teeth are counted from tooth 0 in mesh at carrier
//! angle 0 (which tooth that is, no sensor can know). What a window hears of *other* planets is not
//! removed, only averaged down.
//! Verified by `tests/separation.rs`.

use crate::error::{HumsError, Result, require_positive};
use gear_numerics::number::gcd;
use std::f64::consts::PI;

/// Weight of the samples about a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PassWindow {
    /// One weight over W mesh cycles.
    Rectangular,
    /// `cos^2`, zero at +- W/2 mesh cycles (McFadden's Hann window).
    #[default]
    Hann,
    /// Flat over half of W, cosine flanks (Tukey).
    Tukey,
}

impl PassWindow {
    /// Weight at `x` in -1..=1 (window's edges).
    fn weight(self, x: f64) -> f64 {
        let x = x.abs();
        match self {
            Self::Rectangular => 1.0,
            Self::Hann => (PI * x / 2.0).cos().powi(2),
            Self::Tukey if x <= 0.5 => 1.0,
            Self::Tukey => (PI * (x - 0.5)).cos().powi(2),
        }
    }
}

/// A planetary stage with a fixed ring, its sensors, and the windows.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanetaryStage {
    /// z_r.
    pub ring_teeth: usize,
    /// z_p.
    pub planet_teeth: usize,
    /// z_s.
    pub sun_teeth: usize,
    /// psi of every planet, turns.
    pub planet_angles: Vec<f64>,
    /// theta of every sensor, turns.
    pub sensor_angles: Vec<f64>,
    /// Samples a mesh cycle, >= 2.
    pub samples_per_mesh: usize,
    /// Width of the window, mesh cycles, >= 1.
    pub window_teeth: f64,
    /// Shape of the window.
    pub window: PassWindow,
}

/// A separated average.
#[derive(Debug, Clone, PartialEq)]
pub struct Separated {
    /// One turn of the planet or sun, S samples a tooth, unit of the signal.
    pub samples: Vec<f64>,
    /// Passes used.
    pub passes: usize,
    /// Passes left out because of gaps.
    pub skipped: usize,
    /// Smallest and largest sum of window weights over the turn: how evenly it is covered.
    pub coverage: (f64, f64),
}

/// Teeth at most.
const MAX_TEETH: usize = 10_000;
/// Samples a mesh cycle at most.
const MAX_PER_MESH: usize = 8192;
/// Weight below which a sample of the turn counts as not covered.
const LEAST_COVERAGE: f64 = 1e-6;

impl PlanetaryStage {
    /// Equally spaced planets, one sensor at angle 0, Hann windows of five teeth.
    #[must_use]
    pub fn new(ring_teeth: usize, planet_teeth: usize, sun_teeth: usize, planets: usize) -> Self {
        Self {
            ring_teeth,
            planet_teeth,
            sun_teeth,
            planet_angles: (0..planets).map(|k| k as f64 / planets as f64).collect(),
            sensor_angles: vec![0.0],
            samples_per_mesh: 64,
            window_teeth: 5.0,
            window: PassWindow::Hann,
        }
    }

    /// Samples a carrier turn of the records.
    #[must_use]
    pub fn samples_per_turn(&self) -> usize {
        self.ring_teeth.saturating_mul(self.samples_per_mesh)
    }

    /// Carrier turns after which the same planet tooth passes the same sensor: `z_p / gcd(z_r, z_p)`.
    #[must_use]
    pub fn planet_reset_turns(&self) -> usize {
        self.planet_teeth / gcd(self.ring_teeth, self.planet_teeth).max(1)
    }

    /// Carrier turns after which the same sun tooth meets the same planet at the same sensor.
    #[must_use]
    pub fn sun_reset_turns(&self) -> usize {
        self.sun_teeth / gcd(self.ring_teeth, self.sun_teeth).max(1)
    }

    fn validate(&self) -> Result<()> {
        for (parameter, value) in
            [("ring teeth", self.ring_teeth), ("planet teeth", self.planet_teeth), ("sun teeth", self.sun_teeth)]
        {
            require_positive(parameter, value as f64)?;
            if value > MAX_TEETH {
                return Err(HumsError::Parameter { parameter, value: value as f64, allowed: "at most 10000" });
            }
        }
        if !(2..=MAX_PER_MESH).contains(&self.samples_per_mesh) {
            return Err(HumsError::Parameter {
                parameter: "samples per mesh cycle",
                value: self.samples_per_mesh as f64,
                allowed: "2 to 8192",
            });
        }
        if !(self.window_teeth >= 1.0 && self.window_teeth <= self.ring_teeth as f64) {
            return Err(HumsError::Parameter {
                parameter: "window width in teeth",
                value: self.window_teeth,
                allowed: "at least 1, at most the ring's teeth",
            });
        }
        let angles = self.planet_angles.iter().chain(&self.sensor_angles);
        match angles.into_iter().find(|a| !(a.abs() <= 1e6)) {
            Some(&value) => Err(HumsError::Parameter {
                parameter: "planet or sensor angle",
                value,
                allowed: "at most 1e6 turns in size",
            }),
            None => Ok(()),
        }
    }

    /// Average of one planet (index into `planet_angles`) from one record a sensor, all beginning at
    /// carrier angle `first_turn` (turns).
    ///
    /// # Errors
    /// Parameters out of range; [`HumsError::LengthMismatch`] unless there is one record a sensor;
    /// [`HumsError::Undefined`] when some of the planet's turn is covered by no window: more carrier
    /// turns, wider windows or more sensors are needed.
    pub fn planet(&self, records: &[&[f64]], first_turn: f64, planet: usize) -> Result<Separated> {
        let Some(&psi) = self.planet_angles.get(planet) else {
            return Err(HumsError::Parameter {
                parameter: "planet",
                value: planet as f64,
                allowed: "an index into the planet angles",
            });
        };
        self.validate()?;
        let mut sums = Sums::new(self.planet_teeth * self.samples_per_mesh);
        self.collect(records, first_turn, psi, 0.0, &mut sums)?;
        sums.finish()
    }

    /// Average of the sun, from windows at the passes of all planets.
    ///
    /// # Errors
    /// As [`Self::planet`].
    pub fn sun(&self, records: &[&[f64]], first_turn: f64) -> Result<Separated> {
        self.validate()?;
        let mut sums = Sums::new(self.sun_teeth * self.samples_per_mesh);
        for &psi in &self.planet_angles {
            self.collect(records, first_turn, psi, psi * self.sun_teeth as f64, &mut sums)?;
        }
        sums.finish()
    }

    /// Adds the windows of one planet's passes; `offset` is taken from the mesh count.
    fn collect(&self, records: &[&[f64]], first_turn: f64, psi: f64, offset: f64, sums: &mut Sums) -> Result<()> {
        if records.len() != self.sensor_angles.len() {
            return Err(HumsError::LengthMismatch {
                what: "records and sensors",
                left: records.len(),
                right: self.sensor_angles.len(),
            });
        }
        if !(first_turn.abs() < 1e6) {
            return Err(HumsError::Parameter {
                parameter: "first turn",
                value: first_turn,
                allowed: "below 1e6 in size",
            });
        }
        let per_turn = self.samples_per_turn() as f64;
        let half = self.window_teeth / 2.0 * self.samples_per_mesh as f64;
        let reach = half.floor() as usize;
        let turn = sums.weights.len() as f64;
        for (record, theta) in records.iter().zip(&self.sensor_angles) {
            // First pass whose window begins inside the record.
            let mut pass = (first_turn + reach as f64 / per_turn - (theta - psi) - 1e-9).ceil();
            loop {
                // Centre in samples of the record, and the tooth coordinate there, in samples.
                let centre = ((pass + theta - psi - first_turn) * per_turn).round() as usize;
                let Some(part) = record.get(centre.saturating_sub(reach)..=centre + reach) else {
                    break;
                };
                pass += 1.0;
                if centre < reach {
                    continue;
                }
                if !part.iter().all(|x| x.is_finite()) {
                    sums.skipped += 1;
                    continue;
                }
                sums.passes += 1;
                let count = first_turn * per_turn + (centre - reach) as f64 - offset * self.samples_per_mesh as f64;
                let mut place = count.round().rem_euclid(turn) as usize;
                for (k, x) in part.iter().enumerate() {
                    if place >= sums.weights.len() {
                        place = 0;
                    }
                    let w = self.window.weight((k as f64 - reach as f64) / half);
                    sums.values[place] += w * x;
                    sums.weights[place] += w;
                    place += 1;
                }
            }
        }
        Ok(())
    }
}

struct Sums {
    values: Vec<f64>,
    weights: Vec<f64>,
    passes: usize,
    skipped: usize,
}

impl Sums {
    fn new(samples: usize) -> Self {
        Self { values: vec![0.0; samples], weights: vec![0.0; samples], passes: 0, skipped: 0 }
    }

    fn finish(self) -> Result<Separated> {
        let least = self.weights.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.weights.iter().copied().fold(0.0, f64::max);
        if !(least > LEAST_COVERAGE) {
            return Err(HumsError::Undefined {
                what: "separated average",
                reason: "part of the gear's turn is covered by no window; use more carrier turns, \
                         wider windows or more sensors",
            });
        }
        let samples = self.values.iter().zip(&self.weights).map(|(v, w)| v / w);
        Ok(Separated {
            samples: samples.collect(),
            passes: self.passes,
            skipped: self.skipped,
            coverage: (least, most),
        })
    }
}
