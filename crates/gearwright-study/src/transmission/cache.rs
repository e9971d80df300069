//! Mesh tables and reduced housings on disc, beside the results, found again by what they depend on.
//!
//! An entry is named by the hash of its key, and holds its checksum and the hash of the program that wrote it ([`gearwright_store::entry`]). Entries
//! that are damaged or from another build are ignored and computed again. The folder may be deleted at any time.

use std::path::{Path, PathBuf};

use gearwright_store::file_system::{Disk, FileSystem as _};
use gearwright_store::{Digest, Found, read_entry, write_entry};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Name of the folder.
pub const FOLDER: &str = ".gearwright-cache";
/// File whose lock a writer holds.
const LOCK: &str = "lock";

/// A folder of kept results, or none.
#[derive(Debug, Clone)]
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// The cache beside a results folder; none where `kept` is false.
    #[must_use]
    pub fn beside(target: &Path, kept: bool) -> Self {
        let parent = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self { folder: kept.then(|| parent.join(FOLDER)) }
    }

    /// A cache in a folder of its own.
    #[must_use]
    pub fn within(folder: &Path) -> Self {
        Self { folder: Some(folder.to_path_buf()) }
    }

    /// The value kept under a name and a key; if there is none, the one `make` makes, which is kept.
    ///
    /// # Errors
    /// Those of `make`. A cache that cannot be written is not used.
    pub fn get<T: Serialize + DeserializeOwned, E>(
        &self,
        name: &str,
        key: &impl Serialize,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let (Some(folder), Ok(key)) = (&self.folder, Digest::of_value(&(name, key))) else { return make() };
        let file = folder.join(format!("{name}-{key}.entry"));
        if let Found::Value(kept) = read_entry(&Disk, &file, key) {
            return Ok(kept);
        }
        let made = make()?;
        // nothing is lost where it cannot be kept
        let _ = keep(folder, &file, key, &made);
        Ok(made)
    }
}

fn keep(folder: &Path, file: &Path, key: Digest, content: &impl Serialize) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)?;
    let _lock = Disk.lock(&folder.join(LOCK), true)?;
    write_entry(&Disk, file, key, content)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_comes_back_to_the_bit_and_only_for_its_key() {
        let scratch = tempfile::tempdir().unwrap();
        let target = scratch.path().join("results");
        let cache = Cache::beside(&target, true);
        let values = vec![0.1 + 0.2, 1.0 / 3.0, f64::MIN_POSITIVE];
        let made: Result<Vec<f64>, ()> = cache.get("table", &("a", 1.0), || Ok(values.clone()));
        assert_eq!(made.unwrap(), values);
        let again: Result<Vec<f64>, ()> = cache.get("table", &("a", 1.0), || Err(()));
        assert_eq!(again.unwrap(), values);
        assert!(cache.get::<Vec<f64>, ()>("table", &("a", 2.0), || Err(())).is_err());
        assert!(cache.get::<Vec<f64>, ()>("other", &("a", 1.0), || Err(())).is_err());
        // one changed digit: read as valid JSON before there was a checksum
        for entry in std::fs::read_dir(scratch.path().join(FOLDER)).unwrap() {
            let file = entry.unwrap().path();
            let text = std::fs::read_to_string(&file).unwrap();
            std::fs::write(&file, text.replace("0.3333", "0.3433")).unwrap();
        }
        assert!(cache.get::<Vec<f64>, ()>("table", &("a", 1.0), || Err(())).is_err());
        let off = Cache::beside(&scratch.path().join("elsewhere/results"), false);
        assert!(off.get::<Vec<f64>, ()>("table", &1, || Ok(vec![])).is_ok());
        assert!(!scratch.path().join("elsewhere").exists());
    }
}
