//! Force laws of all meshes in all states, from contact mechanics. Sound teeth are all alike, so a table of each pair of gears serves all planets, and curves
//! around a damaged tooth all planets that meet it. Positions of tables are their own, not those of time steps.

use std::sync::{Arc, OnceLock};

use anyhow::{Context, bail};
use fecm::statics::PairModel;
use gear_geom::{Damage, Member, MeshSite, TrainTooth};
use planetary::mesh::{
    BevelSlices, DamageWindow, DamagedTooth, MeshLaw, MeshTable, MeshTableData, SlicedMesh, TableOptions, virtual_table,
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
        Ok(Self { case, site, cache, observer, options, model, sound: Arc::new(sound) })
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
                if windows.is_empty() {
                    return Ok(self.sound.clone() as Arc<dyn MeshLaw>);
                }
                let data = MeshTableData { windows, ..self.sound.data().clone() };
                let table =
                    MeshTable::new(data).with_context(|| format!("{}, planet {}", severity.label, planet + 1))?;
                Ok(Arc::new(table) as Arc<dyn MeshLaw>)
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
