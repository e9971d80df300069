//! What was computed, kept by content: a result counts as long as the sources, the level and the case files it came from are the same.
//!
//! Studies (static analyses) depend on the computing crates; figures on those and on this command as well. Everything lies in the results
//! folder and is safe to delete.

use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow};
use gearwright_study::transmission::cache::Cache;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::drawn::{Drawn, Saved};
use super::{Level, root};

/// Sources that a study depends on.
const COMPUTING: [&str; 12] = [
    "crates/gear-geom/src",
    "crates/fecm/src",
    "crates/lpm/src",
    "crates/hums/src",
    "crates/planetary/src",
    "crates/gearwright-case/src",
    "crates/gearwright-results/src",
    "crates/gearwright-study/src",
    "xtask/src/reproduce/statics.rs",
    "xtask/src/reproduce/dynamics.rs",
    "xtask/src/reproduce/vibration.rs",
    "Cargo.lock",
];
/// Sources that a figure depends on besides.
const DRAWING: [&str; 3] =
    ["crates/gearwright-plot/src", "xtask/src/reproduce/figures", "xtask/src/reproduce/drawn.rs"];

/// The results folder and what is up to date in it.
pub struct Store {
    folder: PathBuf,
    computing: u64,
    drawing: u64,
    level: Level,
    fresh: bool,
}

#[derive(Serialize, Deserialize)]
struct Kept<T> {
    key: String,
    value: T,
}

impl Store {
    /// Opens or makes the folder.
    pub fn open(folder: &Path, level: Level, fresh: bool) -> anyhow::Result<Self> {
        for part in ["figures", "cache"] {
            let made = folder.join(part);
            fs::create_dir_all(&made).with_context(|| format!("{} cannot be made", made.display()))?;
        }
        let computing = hash_of(&COMPUTING)?;
        let drawing = hash_of(&DRAWING)?;
        Ok(Self { folder: folder.to_path_buf(), computing, drawing, level, fresh })
    }

    /// A study: read if up to date, else computed and kept.
    pub fn study<T: Serialize + DeserializeOwned>(
        &self,
        name: &str,
        inputs: &str,
        compute: impl FnOnce() -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let file = self.folder.join("cache").join(format!("{name}.{}.json", self.level.name()));
        let key = format!("{:016x} {:016x}", self.computing, hash(inputs.as_bytes()));
        if let Some(kept) = read(&file, &key) {
            return Ok(kept);
        }
        let value = compute()?;
        keep(&file, &Kept { key, value: &value })?;
        Ok(value)
    }

    /// Where tables of meshes and reduced housings are kept.
    pub fn tables(&self) -> Cache {
        Cache::within(&self.folder.join("cache").join("transmission"))
    }

    fn figure_file(&self, id: &str) -> PathBuf {
        self.folder.join("cache").join(format!("figure-{id}.{}.json", self.level.name()))
    }

    fn figure_key(&self, inputs: &str) -> String {
        format!("{:016x} {:016x} {:016x}", self.computing, self.drawing, hash(inputs.as_bytes()))
    }

    /// A figure that is up to date.
    pub fn figure(&self, id: &str, inputs: &str) -> Option<Saved> {
        if self.fresh {
            return None;
        }
        let saved: Saved = read(&self.figure_file(id), &self.figure_key(inputs))?;
        let exists = |name: &String| self.folder.join("figures").join(format!("{name}.svg")).is_file();
        saved.panels.iter().all(|(name, _)| exists(name)).then_some(saved)
    }

    /// Writes a figure's pictures and data, and keeps the rest.
    pub fn keep_figure(&self, id: &str, inputs: &str, drawn: Drawn) -> anyhow::Result<Saved> {
        let mut panels = Vec::new();
        let place = |file: &str| self.folder.join("figures").join(file);
        for panel in drawn.panels {
            let letter = if panel.letter.is_empty() { String::new() } else { format!("-{}", panel.letter) };
            // the levels side by side
            let name = format!("{id}{letter}.{}", self.level.name());
            panel.picture.save(&place, &name).map_err(|message| anyhow!("panel {name}: {message}"))?;
            if let Some(data) = panel.picture.rows() {
                fs::write(place(&format!("{name}.csv")), data.csv())?;
            }
            let about =
                if panel.letter.is_empty() { panel.about } else { format!("({}) {}", panel.letter, panel.about) };
            panels.push((name, about));
        }
        for (index, table) in drawn.tables.iter().enumerate() {
            let file = format!("{id}-table-{}.{}.csv", index + 1, self.level.name());
            fs::write(place(&file), table.csv())?;
        }
        let Drawn { tables, values, claims, notes, seconds, .. } = drawn;
        let saved = Saved { panels, tables, values, claims, notes, seconds };
        keep(&self.figure_file(id), &Kept { key: self.figure_key(inputs), value: &saved })?;
        Ok(saved)
    }
}

impl super::drawn::Table {
    fn csv(&self) -> String {
        let quoted = |cell: &String| {
            if cell.contains([',', '"', '\n']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
        };
        let row = |cells: &Vec<String>| cells.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n";
        std::iter::once(&self.head).chain(&self.rows).map(row).collect()
    }
}

fn read<T: DeserializeOwned>(file: &Path, key: &str) -> Option<T> {
    let text = fs::read_to_string(file).ok()?;
    let kept: Kept<T> = serde_json::from_str(&text).ok()?;
    (kept.key == key).then_some(kept.value)
}

/// Writes beside the place and moves there, so that a run that is stopped leaves no half file.
fn keep(file: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    let beside = file.with_extension("part");
    fs::write(&beside, serde_json::to_string(value)?)
        .with_context(|| format!("{} cannot be written", beside.display()))?;
    fs::rename(&beside, file).with_context(|| format!("{} cannot be written", file.display()))
}

/// Hash of bytes.
pub fn hash(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

/// Hash of files and folders of the repository: names and contents, in order of their names.
fn hash_of(places: &[&str]) -> anyhow::Result<u64> {
    let mut hasher = DefaultHasher::new();
    for place in places {
        add(&mut hasher, &root().join(place)).with_context(|| format!("{place} cannot be read"))?;
    }
    Ok(hasher.finish())
}

fn add(hasher: &mut DefaultHasher, place: &Path) -> std::io::Result<()> {
    if place.is_dir() {
        let mut inside: Vec<PathBuf> = fs::read_dir(place)?.map(|e| e.map(|e| e.path())).collect::<Result<_, _>>()?;
        inside.sort();
        return inside.iter().try_for_each(|path| add(hasher, path));
    }
    if let Some(name) = place.file_name() {
        hasher.write(name.as_encoded_bytes());
    }
    hasher.write(&fs::read(place)?);
    Ok(())
}
