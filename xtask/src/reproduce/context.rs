//! What a figure can ask for: cases at the chosen level, static analyses, lumped-parameter runs.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use anyhow::{Context as _, bail};
use gear_geom::MeshSite;
use gearwright_case::{self as case, Case, SpurPairCase, TransmissionCase};
use gearwright_results::lumped::Lumped;
use gearwright_study::lumped_pair;

use super::dynamics::Dynamics;
use super::statics::{self, Statics};
use super::store::{Store, hash};
use super::vibration::Vibration;
use super::{Level, root};

/// Keys of spur-pair cases that the quick level sets, with the values.
pub const QUICK: [(&str, &str, f64); 3] =
    [("numerics", "face_cells", 24.0), ("numerics", "face_order", 4.0), ("numerics", "cells_per_half_width", 5.0)];
/// Torques of a force-deflection map at the quick level.
pub const QUICK_TORQUES: f64 = 12.0;

/// What a figure can ask for.
pub struct Context<'a> {
    store: &'a Store,
    level: Level,
    lumped: RefCell<BTreeMap<String, Rc<Lumped>>>,
    vibrations: RefCell<BTreeMap<String, Rc<Vibration>>>,
}

impl<'a> Context<'a> {
    /// Nothing computed yet.
    pub fn new(store: &'a Store, level: Level) -> Self {
        Self { store, level, lumped: RefCell::default(), vibrations: RefCell::default() }
    }

    /// The text of a case file as it is run at this level.
    pub fn text(&self, file: &str) -> anyhow::Result<String> {
        let path = root().join("configs").join(file);
        let text = std::fs::read_to_string(&path).with_context(|| format!("configs/{file} cannot be read"))?;
        let mut document: toml::Table = text.parse().with_context(|| format!("configs/{file}"))?;
        if self.level == Level::Full || document.get("kind").and_then(|k| k.as_str()) != Some("spur-pair") {
            return Ok(text);
        }
        let as_number = |value: f64| toml::Value::Integer(value as i64);
        for (section, key, value) in QUICK {
            let table = document.entry(section).or_insert_with(|| toml::Table::new().into());
            if let Some(table) = table.as_table_mut() {
                // cells per half width is a decimal key
                let value = if key == "cells_per_half_width" { toml::Value::Float(value) } else { as_number(value) };
                table.insert(key.into(), value);
            }
        }
        if let Some(torques) = document.get_mut("load").and_then(|l| l.get_mut("map_torques")) {
            *torques = as_number(QUICK_TORQUES);
        }
        Ok(document.to_string())
    }

    /// What a figure's result depends on: its case files and those they name.
    pub fn key(&self, files: &[&str]) -> anyhow::Result<String> {
        let mut key = self.level.name().to_owned();
        for file in files {
            let text = self.text(file)?;
            for line in text.lines().filter(|line| line.trim_start().starts_with("spur_pair")) {
                if let Some(other) = line.split('"').nth(1) {
                    key.push_str(&std::fs::read_to_string(root().join("configs").join(other))?);
                }
            }
            key.push_str(&text);
        }
        Ok(key)
    }

    fn case(&self, file: &str) -> anyhow::Result<Case> {
        Ok(case::from_text(&self.text(file)?, &root().join("configs").join(file))?)
    }

    /// A spur-pair case.
    pub fn spur_pair(&self, file: &str) -> anyhow::Result<SpurPairCase> {
        match self.case(file)? {
            Case::SpurPair(case) => Ok(*case),
            other => bail!("configs/{file} is a {}, not a spur-pair", other.kind()),
        }
    }

    /// Static analysis of a spur-pair case and all its severities. Cases that differ in their damage only share the healthy pair.
    pub fn statics(&self, file: &str) -> anyhow::Result<Statics> {
        let case = self.spur_pair(file)?;
        let mut inputs = case.inputs.clone();
        inputs.title.clear();
        inputs.damage.clear();
        let inputs = serde_json::to_string(&inputs)?;
        let name = format!("healthy-{:016x}", hash(inputs.as_bytes()));
        let healthy = self.store.study(&name, &inputs, || statics::healthy(&case))?;
        let name = format!("damaged-{}", file.trim_end_matches(".toml"));
        let damaged = self.store.study(&name, &self.key(&[file])?, || statics::damaged(&case))?;
        Ok(Statics { healthy, damaged })
    }

    /// Dynamics of the finite-element/contact model of a spur-pair case, with the severities picked.
    pub fn dynamics(&self, file: &str, mesh_frequency: f64, picked: &[usize]) -> anyhow::Result<Dynamics> {
        let name = format!("{}-{mesh_frequency}hz", file.trim_end_matches(".toml"));
        let key = format!("{} {picked:?}", self.key(&[file])?);
        self.store.study(&name, &key, || Dynamics::compute(&self.spur_pair(file)?, mesh_frequency, picked))
    }

    /// A transmission case.
    pub fn transmission(&self, file: &str) -> anyhow::Result<TransmissionCase> {
        match self.case(file)? {
            Case::Transmission(case) => Ok(*case),
            other => bail!("configs/{file} is a {}, not a transmission", other.kind()),
        }
    }

    /// Vibration of a transmission case in all its states. Cases share tables of meshes and the reduced housing.
    pub fn vibration(&self, file: &str) -> anyhow::Result<Rc<Vibration>> {
        if let Some(run) = self.vibrations.borrow().get(file) {
            return Ok(Rc::clone(run));
        }
        let name = format!("vibration-{}", file.trim_end_matches(".toml"));
        let compute = || Vibration::compute(&self.transmission(file)?, &self.store.tables());
        let run = Rc::new(self.store.study(&name, &self.key(&[file])?, compute)?);
        self.vibrations.borrow_mut().insert(file.into(), Rc::clone(&run));
        Ok(run)
    }

    /// Carrier turns at which the damaged tooth of a sun meets planets, during the record.
    pub fn sun_engagements(&self, file: &str) -> anyhow::Result<Vec<f64>> {
        let case = self.transmission(file)?;
        let damage = case.severities.first().and_then(|s| s.damage.first()).context("the case has no damage")?;
        let turns = f64::from(case.inputs.run.carrier_turns);
        let met = case.train.engagements(damage.0, 0.0..turns)?;
        Ok(met.iter().filter(|met| met.site == MeshSite::SunPlanet).map(|met| met.carrier_turns).collect())
    }

    /// A lumped-parameter case with all its analyses; run once for all figures that ask for it.
    pub fn lumped(&self, file: &str) -> anyhow::Result<Rc<Lumped>> {
        if let Some(run) = self.lumped.borrow().get(file) {
            return Ok(Rc::clone(run));
        }
        let Case::LumpedPair(case) = self.case(file)? else { bail!("configs/{file} is not a lumped-pair") };
        let run = Rc::new(lumped_pair::compute(&case, &())?);
        self.lumped.borrow_mut().insert(file.into(), Rc::clone(&run));
        Ok(run)
    }
}
