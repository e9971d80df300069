//! Results folders: written beside their place and published by exchange.
//!
//! For a target `NAME` these stand beside it while a run is under way: `.NAME.gearwright-lock` (one run at a time), `.NAME.gearwright-new` (the
//! folder under construction) and, during the exchange, `.NAME.gearwright-old`. Publishing takes these steps:
//!
//! | step | | killed after it, the next start |
//! |---|---|---|
//! | 1 | manifest written, all files and folders synced | drops the new folder, as no old results are missing |
//! | 2 | target renamed to `old` | finishes: step 3 (or renames `old` back, if `new` is not whole) |
//! | 3 | `new` renamed to target | finishes: steps 4 and 5 |
//! | 4 | files of the user, and results that were edited, moved from `old` to the target | goes on with the rest |
//! | 5 | `old` removed, its manifest last | goes on with the rest |
//!
//! Whatever fails, the target keeps the old results, or has the new ones; new results that cannot be moved there stay in `NAME.unpublished`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::{StoreError, refused};
use crate::file_system::{Disk, FileSystem, Kind, Tree, remove_tree};
use crate::lock::Lock;
use crate::manifest::{self, Manifest, Verification, name_below};

/// What stands at a target.
enum Standing {
    Nothing,
    /// An empty folder, or results.
    Ours,
}

/// A target and what stands beside it.
#[derive(Debug, Clone)]
struct Places {
    disk: Arc<dyn FileSystem>,
    target: PathBuf,
    parent: PathBuf,
    new: PathBuf,
    old: PathBuf,
    lock: PathBuf,
}

impl Places {
    fn of(disk: Arc<dyn FileSystem>, target: &Path) -> Self {
        // where a link leads is where the results stand
        let target = match disk.kind(target) {
            Ok(Some(Kind::Other)) => std::fs::canonicalize(target).unwrap_or_else(|_| target.to_path_buf()),
            _ => target.to_path_buf(),
        };
        let parent = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf();
        let beside = |what: &str| {
            let mut name = std::ffi::OsString::from(".");
            name.push(target.file_name().unwrap_or_default());
            name.push(".gearwright-");
            name.push(what);
            parent.join(name)
        };
        let (new, old, lock) = (beside("new"), beside("old"), beside("lock"));
        Self { disk, target, parent, new, old, lock }
    }

    fn kind(&self, path: &Path) -> Result<Option<Kind>, StoreError> {
        self.disk.kind(path).map_err(refused(path, "read"))
    }

    fn rename(&self, from: &Path, to: &Path) -> Result<(), StoreError> {
        self.disk.rename(from, to).map_err(refused(from, "moved"))
    }

    fn sync_parent(&self) -> Result<(), StoreError> {
        self.disk.sync(&self.parent, Kind::Folder).map_err(refused(&self.parent, "synced"))
    }

    /// What stands at the target; an error if it is neither results nor empty.
    fn standing(&self) -> Result<Standing, StoreError> {
        match self.kind(&self.target)? {
            None => Ok(Standing::Nothing),
            Some(Kind::Folder) if Manifest::read(&*self.disk, &self.target)?.is_some() => Ok(Standing::Ours),
            Some(Kind::Folder) if self.disk.list(&self.target).map_err(refused(&self.target, "listed"))?.is_empty() => {
                Ok(Standing::Ours)
            }
            Some(_) => Err(StoreError::Foreign { path: self.target.clone() }),
        }
    }

    /// Finishes or undoes an exchange that was interrupted; the folder under construction stays if it was not exchanged.
    fn settle(&self) -> Result<(), StoreError> {
        if self.kind(&self.old)?.is_none() {
            return Ok(());
        }
        if self.kind(&self.target)?.is_none() {
            let whole = matches!(Manifest::read(&*self.disk, &self.new), Ok(Some(_)));
            let undone = if whole { self.rename(&self.new, &self.target).is_err() } else { true };
            if undone {
                self.rename(&self.old, &self.target)?;
            }
            self.sync_parent()?;
            if undone {
                return Ok(());
            }
        }
        if Manifest::read(&*self.disk, &self.target)?.is_none() {
            return Err(StoreError::Taken { path: self.target.clone(), old: self.old.clone() });
        }
        self.carry_over()
    }

    /// Moves what are not results from the old folder to the target, and removes the old folder.
    fn carry_over(&self) -> Result<(), StoreError> {
        let disk = &*self.disk;
        // a manifest that went with everything it names leaves only files of the user
        let manifest = match Manifest::read(disk, &self.old) {
            Err(StoreError::Damaged { .. }) | Ok(None) => Manifest::default(),
            Err(error) => return Err(error),
            Ok(Some(manifest)) => manifest,
        };
        let tree = Tree::of(disk, &self.old).map_err(refused(&self.old, "listed"))?;
        for (file, kind) in &tree.files {
            let name = name_below(&self.old, file);
            let is_manifest = name.as_deref() == Some(manifest::NAME);
            let is_result = match &name {
                Some(name) if *kind == Kind::File => manifest.holds(disk, name, file)?,
                _ => false,
            };
            if is_result {
                disk.remove_file(file).map_err(refused(file, "removed"))?;
            } else if !is_manifest {
                self.carry(file)?;
            }
        }
        for folder in &tree.folders {
            if *folder == self.old {
                let own = folder.join(manifest::NAME);
                if self.kind(&own)?.is_some() {
                    disk.remove_file(&own).map_err(refused(&own, "removed"))?;
                }
            }
            disk.remove_folder(folder).map_err(refused(folder, "removed"))?;
        }
        self.sync_parent()
    }

    /// Moves a file from the old folder to its place in the target, under another name if that is taken.
    fn carry(&self, file: &Path) -> Result<(), StoreError> {
        let below = file.strip_prefix(&self.old).unwrap_or(file);
        let mut folder = self.target.clone();
        let mut changed = vec![folder.clone()];
        for part in below.parent().into_iter().flat_map(Path::components) {
            folder.push(part);
            match self.kind(&folder)? {
                Some(Kind::Folder) => {}
                None => self.disk.create_folder(&folder).map_err(refused(&folder, "made"))?,
                // a result has taken the folder's name
                Some(_) => {
                    folder = free_name(&folder, |path| Ok(self.kind(path)?.is_none_or(|kind| kind == Kind::Folder)))?;
                    if self.kind(&folder)?.is_none() {
                        self.disk.create_folder(&folder).map_err(refused(&folder, "made"))?;
                    }
                }
            }
            changed.push(folder.clone());
        }
        let place = folder.join(below.file_name().unwrap_or_default());
        let free = |path: &Path| Ok(self.kind(path)?.is_none());
        let place = if free(&place)? { place } else { free_name(&place, free)? };
        self.rename(file, &place)?;
        for folder in changed {
            self.disk.sync(&folder, Kind::Folder).map_err(refused(&folder, "synced"))?;
        }
        Ok(())
    }

    /// Removes what a killed run left of a folder under construction.
    fn sweep(&self) -> Result<(), StoreError> {
        remove_tree(&*self.disk, &self.new).map_err(refused(&self.new, "removed"))
    }
}

/// The path with `.kept`, `.kept-2`, ... behind it that is free.
fn free_name(path: &Path, is_free: impl Fn(&Path) -> Result<bool, StoreError>) -> Result<PathBuf, StoreError> {
    let mut number = 1;
    loop {
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(if number == 1 { ".kept".to_owned() } else { format!(".kept-{number}") });
        let next = path.with_file_name(name);
        if is_free(&next)? {
            return Ok(next);
        }
        number += 1;
    }
}

/// Folders made for the results to stand in: removed again, inner before outer, if nothing came of them.
#[derive(Debug)]
struct NewParents {
    disk: Arc<dyn FileSystem>,
    made: Vec<PathBuf>,
}

impl NewParents {
    fn make(disk: &Arc<dyn FileSystem>, folder: &Path) -> Result<Self, StoreError> {
        let mut own = Self { disk: Arc::clone(disk), made: Vec::new() };
        let mut missing = Vec::new();
        let mut at = Some(folder);
        while let Some(folder) = at.filter(|path| !path.as_os_str().is_empty()) {
            if disk.kind(folder).map_err(refused(folder, "read"))?.is_some() {
                break;
            }
            missing.push(folder.to_path_buf());
            at = folder.parent();
        }
        for folder in missing.into_iter().rev() {
            disk.create_folder(&folder).map_err(refused(&folder, "made"))?;
            own.made.push(folder);
        }
        Ok(own)
    }
}

impl Drop for NewParents {
    fn drop(&mut self) {
        for folder in self.made.iter().rev() {
            // refused as long as anything is in it
            let _ = self.disk.remove_folder(folder);
        }
    }
}

/// A results folder under construction.
#[derive(Debug)]
pub struct ResultsFolder {
    places: Places,
    // given back in this order: the lock file lies in the parent
    _lock: Lock,
    _parents: NewParents,
}

impl ResultsFolder {
    /// Starts a folder that will stand at `target`, after finishing or undoing what an interrupted run left there.
    ///
    /// # Errors
    /// [`StoreError`] when `target` holds something else, another run writes to it, or the file system refuses.
    pub fn create(target: &Path) -> Result<Self, StoreError> {
        Self::create_on(Arc::new(Disk), target)
    }

    /// As [`ResultsFolder::create`], on another file system.
    ///
    /// # Errors
    /// As there.
    pub fn create_on(disk: Arc<dyn FileSystem>, target: &Path) -> Result<Self, StoreError> {
        let places = Places::of(disk, target);
        let parents = NewParents::make(&places.disk, &places.parent)?;
        let lock = Lock::take(&places.disk, &places.lock).map_err(refused(&places.lock, "locked"))?;
        let lock = lock.ok_or_else(|| StoreError::Busy { path: places.target.clone() })?;
        places.settle()?;
        places.sweep()?;
        places.standing()?;
        places.disk.create_folder(&places.new).map_err(refused(&places.new, "made"))?;
        Ok(Self { places, _lock: lock, _parents: parents })
    }

    /// Where a file of the folder is written.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.places.new.join(name)
    }

    /// Moves the complete folder to its place; returns the place.
    ///
    /// # Errors
    /// [`StoreError`]; the old results then stand where they were, and the new ones where the error says.
    pub fn publish(self) -> Result<PathBuf, StoreError> {
        let places = &self.places;
        let disk = &*places.disk;
        let complete = || -> Result<(), StoreError> {
            let manifest = Manifest::of(disk, &places.new)?;
            let file = places.new.join(manifest::NAME);
            let tree = Tree::of(disk, &places.new).map_err(refused(&places.new, "listed"))?;
            for (file, kind) in &tree.files {
                disk.sync(file, *kind).map_err(refused(file, "synced"))?;
            }
            disk.write(&file, manifest.to_text().as_bytes()).map_err(refused(&file, "written"))?;
            for folder in &tree.folders {
                disk.sync(folder, Kind::Folder).map_err(refused(folder, "synced"))?;
            }
            Ok(())
        };
        complete()?;
        let Err(source) = self.exchange() else { return Ok(places.target.clone()) };
        // one step was refused: finish, or put the old results back
        let settled = places.settle();
        match places.kind(&places.new) {
            Ok(None) if settled.is_ok() => Ok(places.target.clone()),
            Ok(None) => Err(source),
            _ => {
                let mut name = places.target.file_name().unwrap_or_default().to_owned();
                name.push(".unpublished");
                let place = places.target.with_file_name(name);
                let free = |path: &Path| Ok(places.kind(path)?.is_none());
                let place = if free(&place)? { place } else { free_name(&place, free)? };
                places.rename(&places.new, &place)?;
                places.sync_parent()?;
                Err(StoreError::Unpublished { path: places.target.clone(), kept: place, source: Box::new(source) })
            }
        }
    }

    fn exchange(&self) -> Result<(), StoreError> {
        let places = &self.places;
        if matches!(places.standing()?, Standing::Ours) {
            places.rename(&places.target, &places.old)?;
            places.rename(&places.new, &places.target)?;
            places.sync_parent()?;
            return places.carry_over();
        }
        places.rename(&places.new, &places.target)?;
        places.sync_parent()
    }
}

impl Drop for ResultsFolder {
    fn drop(&mut self) {
        // not published
        let _ = self.places.sweep();
    }
}

/// Compares a results folder with its manifest, after finishing or undoing an interrupted exchange.
///
/// # Errors
/// Folders without a manifest or with a damaged one, and those of the file system.
pub fn verify(folder: &Path) -> Result<Verification, StoreError> {
    verify_on(Arc::new(Disk), folder)
}

/// As [`verify`], on another file system.
///
/// # Errors
/// As there.
pub fn verify_on(disk: Arc<dyn FileSystem>, folder: &Path) -> Result<Verification, StoreError> {
    let places = Places::of(disk, folder);
    // only where something is to be settled: checking needs no right to write
    if places.kind(&places.old)?.is_some() {
        let lock = Lock::take(&places.disk, &places.lock).map_err(refused(&places.lock, "locked"))?;
        let _lock = lock.ok_or_else(|| StoreError::Busy { path: places.target.clone() })?;
        places.settle()?;
    }
    let manifest = Manifest::read(&*places.disk, &places.target)?;
    let manifest = manifest.ok_or_else(|| StoreError::NoManifest { path: places.target.clone() })?;
    manifest.compare(&*places.disk, &places.target)
}
