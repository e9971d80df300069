//! Mesh tables and reduced housings on disc, beside the results, found again by what they depend on.
//!
//! A file is named by a fingerprint of everything that went into it, the program itself included; it appears complete or not at all. One that
//! cannot be read is as none. The folder may be deleted at any time.

use std::fmt::Debug;
use std::io::{BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Name of the folder.
pub const FOLDER: &str = ".gearwright-cache";

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

    /// What was kept under a name and a key, or what `make` makes, which is kept.
    ///
    /// # Errors
    /// What `make` says. A cache that cannot be written is not used.
    pub fn get<T: Serialize + DeserializeOwned, E>(
        &self,
        name: &str,
        key: &dyn Debug,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let Some(folder) = &self.folder else { return make() };
        let file = folder.join(format!("{name}-{:016x}.json", fingerprint(key)));
        let kept = std::fs::File::open(&file).ok().and_then(|f| serde_json::from_reader(BufReader::new(f)).ok());
        if let Some(kept) = kept {
            return Ok(kept);
        }
        let made = make()?;
        // nothing is lost where it cannot be kept
        let _ = keep(folder, &file, &made);
        Ok(made)
    }
}

fn keep(folder: &Path, file: &Path, content: &impl Serialize) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut writer = BufWriter::new(tempfile::NamedTempFile::new_in(folder)?);
    serde_json::to_writer(&mut writer, content)?;
    writer.flush()?;
    writer.into_inner().map_err(|error| error.into_error())?.persist(file)?;
    Ok(())
}

/// FNV-1a of all that a result depends on: what is computed, and the program that computes it.
fn fingerprint(key: &dyn Debug) -> u64 {
    fnv(program(), format!("{key:?}").as_bytes())
}

/// Fingerprint of the running program; of its version where it cannot be read.
fn program() -> u64 {
    static PROGRAM: OnceLock<u64> = OnceLock::new();
    *PROGRAM.get_or_init(|| {
        let own = std::env::current_exe().and_then(std::fs::read);
        fnv(FNV_BASIS, own.as_deref().unwrap_or(env!("CARGO_PKG_VERSION").as_bytes()))
    })
}

const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

fn fnv(basis: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(basis, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
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
        // a broken file is as none
        for entry in std::fs::read_dir(scratch.path().join(FOLDER)).unwrap() {
            std::fs::write(entry.unwrap().path(), "[0.1").unwrap();
        }
        assert!(cache.get::<Vec<f64>, ()>("table", &("a", 1.0), || Err(())).is_err());
        let off = Cache::beside(&scratch.path().join("elsewhere/results"), false);
        assert!(off.get::<Vec<f64>, ()>("table", &1, || Ok(vec![])).is_ok());
        assert!(!scratch.path().join("elsewhere").exists());
    }
}
