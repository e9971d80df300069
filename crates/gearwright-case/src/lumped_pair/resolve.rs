//! From keys to discs, curves and requests in SI units; faults told at their keys.

use std::path::Path;

use lpm::{Excitation, GearPair, Interpolation};

use super::curves::Curves;
use super::notes::notes;
use super::schema::{self, Disc, Input, LumpedPair, Member, Separation, Supports, Table};
use super::table;
use crate::SpurPairCase;
use crate::document::Node;
use crate::fault::Fault;
use crate::notes::Notes;

const MM: f64 = 1e-3;
const UM: f64 = 1e-6;
/// Longest list of speeds.
const MOST_SPEEDS: f64 = 100_000.0;

/// A lumped-pair case, ready to run.
#[derive(Debug, Clone)]
pub struct LumpedPairCase {
    /// The case with every default filled in.
    pub inputs: LumpedPair,
    /// The pair; its mesh damping is set by `damping`.
    pub pair: GearPair,
    /// Mesh damping.
    pub damping: Damping,
    /// Treatment of supports; `None`: eliminated where the estimated error allows it, otherwise integrated.
    pub supports: Option<lpm::Supports>,
    /// Mesh cycles in a rotation of the damaged gear, where its teeth are known.
    pub rotation: Option<usize>,
    /// Interpolation of points.
    pub interpolation: Interpolation,
    /// Curves of the healthy pair.
    pub healthy: Source,
    /// Damaged states.
    pub damaged: Vec<DamagedState>,
    /// Warnings and assumptions.
    pub notes: Notes,
}

/// Mesh damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// N s/m.
    Absolute(f64),
    /// Fraction of critical damping at the mean mesh stiffness.
    Ratio(f64),
}

/// Where curves come from.
#[derive(Debug, Clone)]
pub enum Source {
    /// Known now.
    Known(Box<Curves>),
    /// From a static analysis, to be run.
    SpurPair(Box<SpurPairCase>),
    /// Those of the healthy pair with another stiffness.
    Weakened {
        /// Factor of the stiffness.
        factor: f64,
        /// Mesh cycles.
        cycles: usize,
    },
}

/// A damaged state.
#[derive(Debug, Clone)]
pub struct DamagedState {
    /// Name.
    pub name: String,
    /// First mesh cycle of the rotation that it changes; `None`: as its points say.
    pub first: Option<usize>,
    /// Curves over the cycles that it changes.
    pub source: Source,
}

/// Resolves a case; `folder` is where files it refers to are looked for.
///
/// # Errors
/// All faults that can be told together.
pub fn resolve(mut inputs: LumpedPair, document: &Node, folder: &Path) -> Result<LumpedPairCase, Vec<Fault>> {
    let mut faults = Vec::new();
    let statics = inputs.excitation.spur_pair.as_ref().and_then(|name| {
        spur_pair(&folder.join(name)).map_err(|m| faults.push(document.fault("excitation.spur_pair", m))).ok()
    });
    if let Some(statics) = &statics {
        fill_from_geometry(&mut inputs, statics);
    }
    let (pair, damping, supports) = gear_pair(&mut inputs, document, &mut faults);
    let interpolation = match inputs.excitation.interpolation {
        schema::Interpolation::Linear => Interpolation::Linear,
        schema::Interpolation::Spline => Interpolation::Spline,
    };
    let member = match inputs.excitation.damaged_gear {
        Member::Pinion => &inputs.pair.pinion,
        Member::Gear => &inputs.pair.gear,
    };
    let rotation = member.teeth.map(|teeth| teeth as usize);
    let origin = statics.as_ref().map(|s| s.inputs.analysis.mesh_cycle_origin);
    let mut resolver = Resolver { origin, document, folder, interpolation, faults };
    let healthy = resolver.healthy(&inputs, statics, pair.mean_force());
    let damaged = resolver.damaged(&inputs, rotation);
    resolver.analyses(&inputs);
    let faults = resolver.faults;
    match (healthy, faults.is_empty()) {
        (Some(healthy), true) => {
            let made = Notes::default();
            let mut case = LumpedPairCase {
                inputs,
                pair,
                damping,
                supports,
                rotation,
                interpolation,
                healthy,
                damaged,
                notes: made,
            };
            case.notes = notes(&case, document);
            Ok(case)
        }
        _ => Err(faults),
    }
}

/// A spur-pair case file, its faults in one message.
fn spur_pair(file: &Path) -> Result<Box<SpurPairCase>, String> {
    crate::load_spur_pair(file).map(Box::new).map_err(|faults| format!("its file has faults:\n{faults}"))
}

/// Refuses a damaged case whose phases are not those of the healthy one.
fn same_origin(statics: Box<SpurPairCase>, healthy: Option<f64>) -> Result<Box<SpurPairCase>, String> {
    let own = statics.inputs.analysis.mesh_cycle_origin;
    let apart = healthy.map_or(0.0, |healthy| own - healthy);
    if (apart - apart.round()).abs() < 1e-6 {
        Ok(statics)
    } else {
        Err(format!(
            "its mesh_cycle_origin is {own}, that of excitation.spur_pair {}: they must differ by whole mesh cycles",
            own - apart
        ))
    }
}

/// Discs and torque that were left out, from the geometry.
fn fill_from_geometry(inputs: &mut LumpedPair, statics: &SpurPairCase) {
    let density = statics.inputs.material.density_kg_per_m3;
    let gears = [statics.pair.pinion(), statics.pair.wheel()];
    for (disc, gear) in [&mut inputs.pair.pinion, &mut inputs.pair.gear].into_iter().zip(gears) {
        let solid = gear.inertia(density);
        disc.teeth.get_or_insert(gear.teeth());
        disc.base_radius_mm.get_or_insert(gear.base_radius() / MM);
        disc.mass_kg.get_or_insert(solid.mass);
        disc.inertia_kg_m2.get_or_insert(solid.polar);
    }
    inputs.pair.gear_torque_n_m.get_or_insert(statics.inputs.load.torque_n_m);
}

fn gear_pair(
    inputs: &mut LumpedPair,
    document: &Node,
    faults: &mut Vec<Fault>,
) -> (GearPair, Damping, Option<lpm::Supports>) {
    let pair = &mut inputs.pair;
    let known = pair.pinion.support_stiffness_n_per_m.is_some() || pair.gear.support_stiffness_n_per_m.is_some();
    if !known {
        pair.supports.get_or_insert(Supports::Rigid);
    }
    let supports = pair.supports;
    let free = pair.input == Input::Free;
    let mut need = |value: Option<f64>, key: &str, what: &str| {
        value.unwrap_or_else(|| {
            let message = format!("this key is required{what}, or a spur-pair case in excitation.spur_pair");
            faults.push(document.fault(&format!("pair.{key}"), message));
            1.0
        })
    };
    let torque = need(pair.gear_torque_n_m, "gear_torque_n_m", "");
    let radius = need(pair.gear.base_radius_mm, "gear.base_radius_mm", "") * MM;
    need(pair.gear.inertia_kg_m2, "gear.inertia_kg_m2", "");
    if free {
        need(pair.pinion.base_radius_mm, "pinion.base_radius_mm", " with free input");
        need(pair.pinion.inertia_kg_m2, "pinion.inertia_kg_m2", " with free input");
    }
    if supports != Some(Supports::Rigid) {
        // of eliminated supports too: the error of elimination depends on them
        need(pair.pinion.mass_kg, "pinion.mass_kg", " with elastic supports");
        need(pair.gear.mass_kg, "gear.mass_kg", " with elastic supports");
    }
    for (name, disc) in [("pinion", &pair.pinion), ("gear", &pair.gear)] {
        let key = format!("pair.{name}.support_stiffness_n_per_m");
        match (supports, disc.support_stiffness_n_per_m) {
            (Some(Supports::Rigid), Some(_)) => {
                faults.push(document.fault(&key, "must be left out with rigid supports (pair.supports)"));
            }
            (Some(Supports::Rigid), None) | (_, Some(_)) => {}
            (_, None) => faults.push(document.fault(&key, "this key is required unless pair.supports is \"rigid\"")),
        }
    }
    if let Some(pinion) = pair.pinion.base_radius_mm {
        pair.pinion_torque_n_m.get_or_insert(torque * pinion * MM / radius);
    }
    let damping = match (pair.mesh_damping_n_s_per_m, pair.mesh_damping_ratio) {
        (Some(damping), None) => Damping::Absolute(damping),
        (None, Some(ratio)) => Damping::Ratio(ratio),
        (Some(_), Some(_)) => {
            let message = "give either mesh_damping_n_s_per_m or mesh_damping_ratio, not both";
            faults.push(document.fault("pair.mesh_damping_ratio", message));
            Damping::Ratio(0.0)
        }
        (None, None) => {
            let message = "this key is required, or mesh_damping_ratio";
            faults.push(document.fault("pair.mesh_damping_n_s_per_m", message));
            Damping::Ratio(0.0)
        }
    };
    // a value left out here is one that the model does not use: it only has to be positive
    let disc = |disc: &Disc, torque: Option<f64>| lpm::Gear {
        base_radius: disc.base_radius_mm.map_or(1.0, |r| r * MM),
        mass: disc.mass_kg.unwrap_or(1.0),
        inertia: disc.inertia_kg_m2.unwrap_or(1.0),
        torque: torque.unwrap_or(0.0),
        support_stiffness: disc.support_stiffness_n_per_m.unwrap_or(f64::MAX),
        support_damping: disc.support_damping_n_s_per_m,
    };
    let result = GearPair {
        pinion: disc(&pair.pinion, pair.pinion_torque_n_m),
        gear: disc(&pair.gear, Some(torque)),
        mesh_damping: 0.0,
        input: if free { lpm::Input::Free } else { lpm::Input::Prescribed },
        separation: match pair.separation {
            Separation::ForceVanishes => lpm::Separation::ForceVanishes,
            Separation::DeflectionVanishes => lpm::Separation::DeflectionVanishes,
        },
        damping_when_apart: pair.damping_when_apart,
        backlash: pair.backlash_um.map(|b| b * UM),
    };
    let supports = supports.map(|supports| match supports {
        Supports::Integrated => lpm::Supports::Integrated,
        Supports::Eliminated => lpm::Supports::Eliminated,
        Supports::Rigid => lpm::Supports::Rigid,
    });
    (result, damping, supports)
}

struct Resolver<'a> {
    document: &'a Node,
    folder: &'a Path,
    interpolation: Interpolation,
    /// Origin of the mesh cycles of the healthy static analysis.
    origin: Option<f64>,
    faults: Vec<Fault>,
}

impl Resolver<'_> {
    fn fault(&mut self, key: &str, message: impl Into<String>) {
        self.faults.push(self.document.fault(key, message));
    }

    /// Curves that are known without a run: periodic, stiffness positive.
    fn known(&mut self, key: &str, curves: Result<Curves, String>) -> Option<Source> {
        let checked = curves.and_then(|curves| {
            Excitation::new(&curves.stiffness, &curves.error).map_err(|e| e.to_string())?;
            Ok(curves)
        });
        checked.map_err(|message| self.fault(key, message)).ok().map(|curves| Source::Known(Box::new(curves)))
    }

    fn table(&mut self, key: &str, table: &Table) -> Option<Source> {
        let curves = table::read(table, self.folder)
            .and_then(|points| points.curves(self.interpolation).map_err(|m| format!("{}: {m}", table.file)));
        self.known(&format!("{key}.file"), curves)
    }

    fn healthy(&mut self, inputs: &LumpedPair, statics: Option<Box<SpurPairCase>>, force: f64) -> Option<Source> {
        let written = &inputs.excitation;
        let given =
            [written.spur_pair.is_some(), written.table.is_some(), written.wave.is_some(), written.fourier.is_some()];
        if given.iter().filter(|g| **g).count() != 1 {
            let message =
                "give one of spur_pair, table, wave and fourier: it holds mesh stiffness and transmission error";
            self.fault("excitation", message);
            return None;
        }
        let text = |e: lpm::LpmError| e.to_string();
        if let Some(table) = &written.table {
            return self.table("excitation.table", table);
        }
        if let Some(wave) = &written.wave {
            return self.known("excitation.wave", Curves::wave(wave, force).map_err(text));
        }
        if let Some(series) = &written.fourier {
            let harmonics = [
                &series.stiffness_cosines_n_per_um,
                &series.stiffness_sines_n_per_um,
                &series.ste_cosines_um,
                &series.ste_sines_um,
            ];
            let highest = harmonics.iter().map(|h| h.len()).max().unwrap_or(0);
            let tabulate = |c: Curves| if inputs.state.is_empty() { Ok(c) } else { c.tabulated(highest) };
            return self.known("excitation.fourier", Curves::fourier(series).and_then(tabulate).map_err(text));
        }
        statics.map(Source::SpurPair)
    }

    fn damaged(&mut self, inputs: &LumpedPair, rotation: Option<usize>) -> Vec<DamagedState> {
        if !inputs.state.is_empty() && rotation.is_none() {
            let name = if inputs.excitation.damaged_gear == Member::Pinion { "pinion" } else { "gear" };
            self.fault(&format!("pair.{name}.teeth"), "this key is required with damaged states");
        }
        let mut all = Vec::new();
        for (index, state) in inputs.state.iter().enumerate() {
            let at = format!("state[{}]", index + 1);
            let key = |name: &str| format!("{at}.{name}");
            if state.name.is_empty()
                || state.name == HEALTHY
                || inputs.state[..index].iter().any(|s| s.name == state.name)
            {
                let message = format!("must differ from the other states, and from \"{HEALTHY}\"");
                self.fault(&key("name"), message);
            }
            let first = state.mesh_cycle.map(|c| c as usize);
            if let (Some(first), Some(rotation)) = (first, rotation)
                && first + state.mesh_cycles as usize > rotation
            {
                let message = format!("must end within the rotation of {rotation} mesh cycles");
                self.fault(&key("mesh_cycle"), message);
            }
            let healthy = self.origin;
            let source = match (&state.spur_pair, &state.table, state.stiffness_factor) {
                (Some(file), None, None) => spur_pair(&self.folder.join(file))
                    .and_then(|statics| same_origin(statics, healthy))
                    .map_err(|message| self.fault(&key("spur_pair"), message))
                    .ok()
                    .map(Source::SpurPair),
                (None, Some(table), None) => self.table(&key("table"), table),
                (None, None, Some(factor)) => {
                    if first.is_none() {
                        self.fault(&key("mesh_cycle"), "this key is required with stiffness_factor");
                    }
                    Some(Source::Weakened { factor, cycles: state.mesh_cycles as usize })
                }
                _ => {
                    self.fault(&at, "give one of spur_pair, table and stiffness_factor");
                    None
                }
            };
            if let (Some(Source::Known(curves)), Some(rotation)) = (&source, rotation)
                && curves.stiffness.period() > rotation
            {
                let cycles = curves.stiffness.period();
                let message = format!("covers {cycles} mesh cycles, more than the rotation of {rotation}");
                self.fault(&key("table.file"), message);
            }
            all.extend(source.map(|source| DamagedState { name: state.name.clone(), first, source }));
        }
        all
    }

    fn analyses(&mut self, inputs: &LumpedPair) {
        let analysis = &inputs.analysis;
        if let Some(time) = &analysis.time {
            match (time.mesh_frequency_hz, time.pinion_speed_rpm) {
                (Some(_), None) => {}
                (None, Some(_)) if inputs.pair.pinion.teeth.is_none() => {
                    self.fault("pair.pinion.teeth", "this key is required with pinion_speed_rpm");
                }
                (None, Some(_)) => {}
                _ => self.fault("analysis.time.mesh_frequency_hz", "give either this key or pinion_speed_rpm"),
            }
        }
        let mut range = |section: &str, from: f64, to: f64, step: f64| {
            if !(to > from) {
                self.fault(&format!("analysis.{section}.to_hz"), format!("must be above from_hz = {from}"));
            } else if (to - from) / step > MOST_SPEEDS {
                self.fault(&format!("analysis.{section}.step_hz"), format!("makes more than {MOST_SPEEDS} speeds"));
            }
        };
        if let Some(sweep) = &analysis.sweep {
            range("sweep", sweep.from_hz, sweep.to_hz, sweep.step_hz);
        }
        if let Some(branch) = &analysis.continuation {
            range("continuation", branch.from_hz, branch.to_hz, branch.to_hz);
        }
        if let Some(damage) = &analysis.damage {
            match (damage.from_hz, damage.to_hz, damage.step_hz) {
                (None, None, None) => {}
                (Some(from), Some(to), Some(step)) => range("damage", from, to, step),
                _ => self.fault("analysis.damage.from_hz", "give from_hz, to_hz and step_hz together, or none"),
            }
            if inputs.state.is_empty() {
                self.fault("analysis.damage", "needs at least one damaged state: add a section [[state]]");
            }
            if !damage.mesh_frequencies_hz.iter().all(|f| *f > 0.0) {
                self.fault("analysis.damage.mesh_frequencies_hz", "must all be positive");
            }
        }
        let both = [analysis.method == schema::Method::Exponential, inputs.pair.supports == Some(Supports::Integrated)];
        if both == [true, true] {
            self.fault(
                "analysis.method",
                "\"exponential\" is for one coordinate: choose another method or other supports",
            );
        }
    }
}

/// Name of the healthy state.
pub const HEALTHY: &str = "healthy";

impl LumpedPairCase {
    /// Mesh frequency of the time response (Hz), where one is asked for.
    #[must_use]
    pub fn time_frequency(&self) -> Option<f64> {
        let time = self.inputs.analysis.time?;
        let teeth = self.inputs.pair.pinion.teeth.unwrap_or_default();
        time.mesh_frequency_hz.or_else(|| time.pinion_speed_rpm.map(|n| n / 60.0 * f64::from(teeth)))
    }
}
