//! Force laws of all meshes in all states, from contact mechanics. Sound teeth are all alike, so a table of each pair of gears serves all planets, and curves
//! around a damaged tooth all planets that meet it. Positions of tables are their own, not those of time steps.

use std::sync::{Arc, OnceLock};

use anyhow::{Context, bail};
use fecm::statics::PairModel;
use gear_geom::{Damage, Member, MeshSite, TrainTooth};
use planetary::mesh::{
    BevelSlices, DamageWindow, DamagedTooth, MeshLaw, MeshTable, MeshTableData, MeshWithErrors, OffsetMesh, SlicedMesh,
    TableOptions, ToothErrors, ToothPairCurves, pin_offset, virtual_table,
};
use planetary::stage::StageLaws;

use super::cache::Cache;
use super::model::{Laws, bevel_force};
use crate::{AsObserver, RunObserver};
use gearwright_case::TransmissionCase;
use gearwright_case::transmission::bevel::BevelStage;
use gearwright_case::transmission::damage::Severity;

/// Laws of the healthy state, then of every severity.
///
/// # Errors
/// Contact models that fail; damaged teeth that are in mesh at the same time; cancellation.
pub fn laws(case: &TransmissionCase, cache: &Cache, observer: &dyn RunObserver) -> anyhow::Result<Vec<Laws>> {
    let sites = MeshSite::ALL.iter().map(|&site| Site::new(case, site, cache, observer));
    let [sun, ring]: [Site<'_>; 2] = sites
        .collect::<anyhow::Result<Vec<_>>>()?
        .try_into()
        .map_err(|_| anyhow::anyhow!("a train has two kinds of meshes"))?;
    let coast = [&sun, &ring].map(|site| site.sound.clone() as Arc<dyn MeshLaw>);
    let bevel = case.bevel.as_ref().map(|stage| bevel_law(case, stage, cache, observer)).transpose()?;
    let none = Severity { label: String::new(), damage: Vec::new() };
    std::iter::once(&none)
        .chain(&case.severities)
        .map(|severity| {
            let (sun, ring) = (sun.laws(severity)?, ring.laws(severity)?);
            Ok(Laws { stage: StageLaws { sun, ring, sound: coast.clone() }, bevel: bevel.clone() })
        })
        .collect()
}

/// Law of the bevel mesh.
fn bevel_law(
    case: &TransmissionCase,
    stage: &BevelStage,
    cache: &Cache,
    observer: &dyn RunObserver,
) -> anyhow::Result<Arc<dyn MeshLaw>> {
    let inputs = case.inputs.bevel.as_ref().context("a bevel stage without its section")?;
    let factor = case.inputs.analysis.table_load_factor;
    let options = TableOptions {
        tolerance: case.inputs.analysis.table_tolerance,
        positions_per_cycle: case.inputs.analysis.table_positions as usize,
        ..TableOptions::up_to(factor * bevel_force(case, stage))
    };
    let table: MeshTable = cache.get("bevel", &format!("{:?}", (&stage.pair, options)), || {
        observer.stage("contact of the bevel stage");
        virtual_table(&stage.pair, &options, &AsObserver(observer)).context("the bevel stage cannot be solved")
    })?;
    let slices = BevelSlices { count: inputs.slices as usize, crown: inputs.crown_um * 1e-6 };
    Ok(Arc::new(SlicedMesh::bevel(&stage.pair, Arc::new(table), &slices).context("the bevel stage")?))
}

fn name(site: MeshSite) -> &'static str {
    match site {
        MeshSite::SunPlanet => "sun-planet pair",
        MeshSite::PlanetRing => "planet-ring pair",
    }
}

fn stopped(observer: &dyn RunObserver) -> anyhow::Result<()> {
    if observer.is_cancelled() {
        bail!("stopped; nothing was written");
    }
    Ok(())
}

/// The contact model of sound gears, made once it is needed.
fn made<'a>(model: &'a OnceLock<PairModel>, case: &TransmissionCase, site: MeshSite) -> anyhow::Result<&'a PairModel> {
    if let Some(model) = model.get() {
        return Ok(model);
    }
    let options = &case.pairs[usize::from(site == MeshSite::PlanetRing)];
    let found = PairModel::new(case.train.pair(site), options)
        .with_context(|| format!("the {} cannot be modelled", name(site)))?;
    Ok(model.get_or_init(|| found))
}

/// Meshes of sun and planets, or of planets and ring.
struct Site<'a> {
    case: &'a TransmissionCase,
    site: MeshSite,
    cache: &'a Cache,
    observer: &'a dyn RunObserver,
    options: TableOptions,
    model: OnceLock<PairModel>,
    /// Table of sound teeth.
    sound: Arc<MeshTable>,
    /// Curves of single tooth pairs, where teeth have errors.
    pairs: Option<Arc<ToothPairCurves>>,
}

impl<'a> Site<'a> {
    fn new(
        case: &'a TransmissionCase,
        site: MeshSite,
        cache: &'a Cache,
        observer: &'a dyn RunObserver,
    ) -> anyhow::Result<Self> {
        let model = OnceLock::new();
        let (index, name) = (usize::from(site == MeshSite::PlanetRing), name(site));
        let analysis = &case.inputs.analysis;
        let options = TableOptions {
            positions_per_cycle: analysis.table_positions as usize,
            tolerance: analysis.table_tolerance,
            ..TableOptions::up_to(analysis.table_load_factor * case.mean_force())
        };
        stopped(observer)?;
        let pair = case.train.pair(site);
        let key = format!("{:?}", (pair, &case.pairs[index], options));
        let sound = cache.get("mesh", &key, || {
            observer.stage(&format!("contact of the {name}"));
            let made = MeshTable::from_contact(made(&model, case, site)?, &options, &AsObserver(observer));
            made.with_context(|| format!("the contact of the {name} cannot be solved"))
        })?;
        let mut own = Self { case, site, cache, observer, options, model, sound: Arc::new(sound), pairs: None };
        if own.tooth_errors().iter().any(|errors| !errors.is_empty()) {
            own.pairs = Some(Arc::new(own.pair_curves()?));
        }
        Ok(own)
    }

    /// Errors of the teeth of the pinion and of the wheel of this mesh (m).
    fn tooth_errors(&self) -> [&[f64]; 2] {
        let [sun, planet, ring] = &self.case.tooth_errors;
        match self.site {
            MeshSite::SunPlanet => [sun, planet],
            MeshSite::PlanetRing => [planet, ring],
        }
    }

    /// Curves of single tooth pairs at the positions of the table.
    fn pair_curves(&self) -> anyhow::Result<ToothPairCurves> {
        stopped(self.observer)?;
        let (options, name) = (self.options, name(self.site));
        let [pinion, wheel] = self.tooth_errors().map(<[f64]>::to_vec);
        let spread = ToothErrors { pinion, wheel }.spread();
        let pair = &self.case.pairs[usize::from(self.site == MeshSite::PlanetRing)];
        let key = format!("{:?}", (self.case.train.pair(self.site), pair, options, spread));
        self.cache.get("pairs", &key, || {
            self.observer.stage(&format!("contact of single tooth pairs of the {name}"));
            let model = made(&self.model, self.case, self.site)?;
            let found = ToothPairCurves::from_contact(&self.sound, model, &options, spread, &AsObserver(self.observer));
            found.with_context(|| format!("the contact of single tooth pairs of the {name} cannot be solved"))
        })
    }

    /// The law of a planet's mesh with the errors of its teeth and of its pin.
    fn with_errors(&self, table: Arc<MeshTable>, planet: usize) -> anyhow::Result<Arc<dyn MeshLaw>> {
        let law: Arc<dyn MeshLaw> = match &self.pairs {
            None => table,
            Some(curves) => Arc::new(MeshWithErrors::new(table, curves.clone(), self.errors_of(planet)?)?),
        };
        let Some(&error) = self.case.pin_errors.get(planet) else { return Ok(law) };
        let offset = pin_offset(self.site, self.case.train.pair(self.site).working_pressure_angle(), error);
        Ok(Arc::new(OffsetMesh::new(law, offset)?))
    }

    /// Errors of the teeth of a planet's mesh, by pair.
    fn errors_of(&self, planet: usize) -> anyhow::Result<ToothErrors> {
        let of = |errors: &[f64], tooth: fn(usize, u32) -> TrainTooth| -> anyhow::Result<Vec<f64>> {
            let mut by_pair = errors.to_vec();
            for (number, error) in errors.iter().enumerate() {
                let found = self.case.train.pairs_of_tooth(self.site, planet, tooth(planet, number as u32))?;
                let (pair, _) = found.context("a tooth is in no pair of its own mesh")?;
                by_pair[pair as usize] = *error;
            }
            Ok(by_pair)
        };
        let [pinion, wheel] = self.tooth_errors();
        Ok(match self.site {
            MeshSite::SunPlanet => ToothErrors {
                pinion: of(pinion, |_, number| TrainTooth::Sun(number))?,
                wheel: of(wheel, TrainTooth::Planet)?,
            },
            MeshSite::PlanetRing => ToothErrors {
                pinion: of(pinion, TrainTooth::Planet)?,
                wheel: of(wheel, |_, number| TrainTooth::Ring(number))?,
            },
        })
    }

    /// Table with one damaged tooth, in pair 0 of the mesh.
    fn damaged(&self, member: Member, damage: &[Damage], label: &str) -> anyhow::Result<MeshTable> {
        stopped(self.observer)?;
        let (options, name) = (self.options, name(self.site));
        let tooth = DamagedTooth { member, pair: 0, damage: damage.to_vec() };
        let pair = &self.case.pairs[usize::from(self.site == MeshSite::PlanetRing)];
        let key = format!("{:?}", (self.case.train.pair(self.site), pair, options, &tooth));
        self.cache.get("damage", &key, || {
            self.observer.stage(&format!("contact of the {name}, {label}"));
            let (model, teeth) = (made(&self.model, self.case, self.site)?, std::slice::from_ref(&tooth));
            let made = self.sound.with_damage(model, teeth, &options, &AsObserver(self.observer));
            made.with_context(|| format!("the contact of the {name} with {label} cannot be solved"))
        })
    }

    /// Laws of all planets.
    fn laws(&self, severity: &Severity) -> anyhow::Result<Vec<Arc<dyn MeshLaw>>> {
        let teeth = teeth(severity);
        (0..self.case.train.planets())
            .map(|planet| {
                let mut windows = Vec::new();
                for (tooth, damage) in &teeth {
                    let Some((pair, _)) = self.case.train.pairs_of_tooth(self.site, planet, *tooth)? else { continue };
                    let (member, damage) = self.seen(*tooth, damage);
                    if damage.is_empty() {
                        continue;
                    }
                    let table = self.damaged(member, &damage, &severity.label)?;
                    windows.extend(table.data().windows.iter().cloned().map(|window| DamageWindow { pair, ..window }));
                }
                let table = if windows.is_empty() {
                    self.sound.clone()
                } else {
                    let table = MeshTable::new(MeshTableData { windows, ..self.sound.data().clone() });
                    Arc::new(table.with_context(|| format!("{}, planet {}", severity.label, planet + 1))?)
                };
                self.with_errors(table, planet)
            })
            .collect()
    }

    /// Damage of a tooth as this mesh's pair of gears sees it; a flank that does not work here is left out.
    fn seen(&self, tooth: TrainTooth, damage: &[Damage]) -> (Member, Vec<Damage>) {
        let member = match (self.site, tooth) {
            (MeshSite::SunPlanet, TrainTooth::Sun(_)) | (MeshSite::PlanetRing, TrainTooth::Planet(..)) => {
                Member::Pinion
            }
            _ => Member::Wheel,
        };
        if !(self.site == MeshSite::PlanetRing && matches!(tooth, TrainTooth::Planet(..))) {
            return (member, damage.to_vec());
        }
        // described in the pair with the sun, where the other flank works
        let seen = damage.iter().filter_map(|damage| match damage {
            Damage::Crack(crack) => {
                let mut crack = crack.clone();
                crack.side = self.site.side_in_pair(crack.side);
                Some(Damage::Crack(crack))
            }
            Damage::BrokenCorner(_) => Some(damage.clone()),
            _ => None,
        });
        (member, seen.collect())
    }
}

/// Damaged teeth, all damage of a tooth together.
fn teeth(severity: &Severity) -> Vec<(TrainTooth, Vec<Damage>)> {
    let mut teeth: Vec<(TrainTooth, Vec<Damage>)> = Vec::new();
    for (tooth, damage) in &severity.damage {
        match teeth.iter_mut().find(|(own, _)| own == tooth) {
            Some((_, all)) => all.push(damage.clone()),
            None => teeth.push((*tooth, vec![damage.clone()])),
        }
    }
    teeth
}
