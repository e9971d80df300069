//! Force laws of all meshes in all states, from contact mechanics. Sound teeth are all alike, and meshes in phase share their positions, so a table of
//! each pair of gears serves all planets, and curves around a damaged tooth all planets that meet it.

use std::sync::Arc;

use anyhow::{Context, bail};
use gear_geom::{Damage, Member, MeshSite, TrainTooth};
use planetary::mesh::{
    BevelSlices, DamageWindow, DamagedTooth, MeshLaw, MeshTable, MeshTableData, SlicedMesh, TableOptions, virtual_table,
};

use super::cache::Cache;
use super::model::{Laws, bevel_force};
use crate::{AsObserver, RunObserver};
use gearwright_case::TransmissionCase;
use gearwright_case::transmission::bevel::BevelStage;
use gearwright_case::transmission::damage::Severity;

/// Offsets that differ by less (mesh cycles) share their tables.
const SAME_PHASE: f64 = 1e-9;

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
    let coast = [&sun, &ring].map(|site| site.tables[0].1.clone() as Arc<dyn MeshLaw>);
    let bevel = case.bevel.as_ref().map(|stage| bevel_law(case, stage, cache, observer)).transpose()?;
    let none = Severity { label: String::new(), damage: Vec::new() };
    std::iter::once(&none)
        .chain(&case.severities)
        .map(|severity| {
            let (sun, ring) = (sun.laws(severity)?, ring.laws(severity)?);
            Ok(Laws { sun, ring, coast: coast.clone(), bevel: bevel.clone() })
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
        ..TableOptions::up_to(factor * bevel_force(case, stage))
    };
    let table: MeshTable = cache.get("bevel", &format!("{:?}", (&stage.pair, options)), || {
        observer.stage("contact of the bevel stage");
        virtual_table(&stage.pair, &options, &AsObserver(observer)).context("the bevel stage cannot be solved")
    })?;
    let slices = BevelSlices { count: inputs.slices as usize, crown: inputs.crown_um * 1e-6 };
    Ok(Arc::new(SlicedMesh::bevel(&stage.pair, Arc::new(table), &slices).context("the bevel stage")?))
}

/// Meshes of sun and planets, or of planets and ring.
struct Site<'a> {
    case: &'a TransmissionCase,
    site: MeshSite,
    cache: &'a Cache,
    observer: &'a dyn RunObserver,
    model: std::sync::OnceLock<fecm::statics::PairModel>,
    /// Tables of sound teeth by the mesh cycle of their first position.
    tables: Vec<(f64, Arc<MeshTable>)>,
}

impl<'a> Site<'a> {
    fn new(
        case: &'a TransmissionCase,
        site: MeshSite,
        cache: &'a Cache,
        observer: &'a dyn RunObserver,
    ) -> anyhow::Result<Self> {
        let model = std::sync::OnceLock::new();
        let mut own = Self { case, site, cache, observer, model, tables: Vec::new() };
        for planet in 0..case.train.planets() {
            let origin = own.origin(planet)?;
            if own.table(origin).is_none() {
                let made = own.sound(origin)?;
                own.tables.push((origin, Arc::new(made)));
            }
        }
        Ok(own)
    }

    /// Mesh cycle of the first position of a planet's table: within the first step, so that steps of the transmission meet positions.
    fn origin(&self, planet: usize) -> anyhow::Result<f64> {
        let steps = f64::from(self.case.inputs.run.steps_per_mesh_cycle);
        let offset = self.case.train.mesh_offset(self.site, planet)? * steps;
        let part = offset - offset.floor();
        Ok(if part > 1.0 - SAME_PHASE { 0.0 } else { part / steps })
    }

    /// The table of sound teeth whose positions are those of an origin but for rounding, and its own origin.
    fn table(&self, origin: f64) -> Option<(f64, &Arc<MeshTable>)> {
        let near = |(own, _): &&(f64, Arc<MeshTable>)| (own - origin).abs() < SAME_PHASE;
        self.tables.iter().find(near).map(|(own, table)| (*own, table))
    }

    fn options(&self, origin: f64) -> TableOptions {
        let analysis = &self.case.inputs.analysis;
        TableOptions {
            positions_per_cycle: self.case.inputs.run.steps_per_mesh_cycle as usize,
            origin,
            tolerance: analysis.table_tolerance,
            ..TableOptions::up_to(analysis.table_load_factor * self.case.mean_force())
        }
    }

    /// The contact model of sound gears, made once it is needed.
    fn model(&self) -> anyhow::Result<&fecm::statics::PairModel> {
        if let Some(model) = self.model.get() {
            return Ok(model);
        }
        let options = &self.case.pairs[self.index()];
        let model = fecm::statics::PairModel::new(self.case.train.pair(self.site), options)
            .with_context(|| format!("the {} cannot be modelled", self.name()))?;
        Ok(self.model.get_or_init(|| model))
    }

    fn index(&self) -> usize {
        usize::from(self.site == MeshSite::PlanetRing)
    }

    fn name(&self) -> &'static str {
        ["sun-planet pair", "planet-ring pair"][self.index()]
    }

    fn stopped(&self) -> anyhow::Result<()> {
        if self.observer.is_cancelled() {
            bail!("stopped; nothing was written");
        }
        Ok(())
    }

    /// Table of sound teeth.
    fn sound(&self, origin: f64) -> anyhow::Result<MeshTable> {
        self.stopped()?;
        let options = self.options(origin);
        let key = format!("{:?}", (self.case.train.pair(self.site), &self.case.pairs[self.index()], options));
        self.cache.get("mesh", &key, || {
            self.observer.stage(&format!("contact of the {}", self.name()));
            let made = MeshTable::from_contact(self.model()?, &options, &AsObserver(self.observer));
            made.with_context(|| format!("the contact of the {} cannot be solved", self.name()))
        })
    }

    /// Table with one damaged tooth, in pair 0 of the mesh.
    fn damaged(&self, origin: f64, member: Member, damage: &[Damage], label: &str) -> anyhow::Result<MeshTable> {
        self.stopped()?;
        let options = self.options(origin);
        let tooth = DamagedTooth { member, pair: 0, damage: damage.to_vec() };
        let key = format!("{:?}", (self.case.train.pair(self.site), &self.case.pairs[self.index()], options, &tooth));
        self.cache.get("damage", &key, || {
            self.observer.stage(&format!("contact of the {}, {label}", self.name()));
            let (_, sound) = self.table(origin).context("the table of sound teeth is missing")?;
            let made =
                sound.with_damage(self.model()?, std::slice::from_ref(&tooth), &options, &AsObserver(self.observer));
            made.with_context(|| format!("the contact of the {} with {label} cannot be solved", self.name()))
        })
    }

    /// Laws of all planets.
    fn laws(&self, severity: &Severity) -> anyhow::Result<Vec<Arc<dyn MeshLaw>>> {
        let teeth = teeth(severity);
        (0..self.case.train.planets())
            .map(|planet| {
                let (origin, sound) =
                    self.table(self.origin(planet)?).context("the table of sound teeth is missing")?;
                let mut windows = Vec::new();
                for (tooth, damage) in &teeth {
                    let Some((pair, _)) = self.case.train.pairs_of_tooth(self.site, planet, *tooth)? else { continue };
                    let (member, damage) = self.seen(*tooth, damage);
                    if damage.is_empty() {
                        continue;
                    }
                    let table = self.damaged(origin, member, &damage, &severity.label)?;
                    windows.extend(table.data().windows.iter().cloned().map(|window| DamageWindow { pair, ..window }));
                }
                if windows.is_empty() {
                    return Ok(sound.clone() as Arc<dyn MeshLaw>);
                }
                let data = MeshTableData { windows, ..sound.data().clone() };
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
