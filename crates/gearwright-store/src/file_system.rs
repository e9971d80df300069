//! Every access of the store to the disk, behind one trait, so that each can be made to fail.

use std::fmt::Debug;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use crate::digest::Digest;

/// What stands at a path; links are not followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A link, device, pipe or socket.
    Other,
}

/// The calls the store makes.
pub trait FileSystem: Debug + Send + Sync {
    /// What stands at a path; `None` where nothing does.
    ///
    /// # Errors
    /// Those of the file system.
    fn kind(&self, path: &Path) -> io::Result<Option<Kind>>;

    /// Paths in a folder, sorted.
    ///
    /// # Errors
    /// Those of the file system.
    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>>;

    /// Content of a file.
    ///
    /// # Errors
    /// Those of the file system.
    fn read(&self, file: &Path) -> io::Result<Vec<u8>>;

    /// Hash of a file.
    ///
    /// # Errors
    /// Those of the file system.
    fn digest(&self, file: &Path) -> io::Result<Digest>;

    /// Writes a file, new or over an old one, and syncs it.
    ///
    /// # Errors
    /// Those of the file system; the file may then hold a part.
    fn write(&self, file: &Path, content: &[u8]) -> io::Result<()>;

    /// Brings a file or folder to the disk.
    ///
    /// # Errors
    /// Those of the file system.
    fn sync(&self, path: &Path, kind: Kind) -> io::Result<()>;

    /// Makes a folder; the one it lies in must exist.
    ///
    /// # Errors
    /// Those of the file system.
    fn create_folder(&self, folder: &Path) -> io::Result<()>;

    /// Moves a file or folder within its file system.
    ///
    /// # Errors
    /// Those of the file system.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;

    /// Removes a file or link.
    ///
    /// # Errors
    /// Those of the file system.
    fn remove_file(&self, file: &Path) -> io::Result<()>;

    /// Removes an empty folder.
    ///
    /// # Errors
    /// Those of the file system.
    fn remove_folder(&self, folder: &Path) -> io::Result<()>;

    /// Opens or makes a lock file and takes its lock; `None` where another process holds it. With `wait`, waits for it instead.
    ///
    /// # Errors
    /// Those of the file system.
    fn lock(&self, file: &Path, wait: bool) -> io::Result<Option<File>>;
}

/// The disk.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl FileSystem for Disk {
    fn kind(&self, path: &Path) -> io::Result<Option<Kind>> {
        match fs::symlink_metadata(path) {
            Ok(data) if data.is_dir() => Ok(Some(Kind::Folder)),
            Ok(data) if data.is_file() => Ok(Some(Kind::File)),
            Ok(_) => Ok(Some(Kind::Other)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        let mut paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
        paths.sort();
        Ok(paths)
    }

    fn read(&self, file: &Path) -> io::Result<Vec<u8>> {
        fs::read(file)
    }

    fn digest(&self, file: &Path) -> io::Result<Digest> {
        Digest::of_reader(File::open(file)?).map(|(_, digest)| digest)
    }

    fn write(&self, file: &Path, content: &[u8]) -> io::Result<()> {
        let mut file = File::create(file)?;
        file.write_all(content)?;
        file.sync_all()
    }

    fn sync(&self, path: &Path, kind: Kind) -> io::Result<()> {
        match kind {
            Kind::File => OpenOptions::new().append(true).open(path)?.sync_all(),
            // other systems have no handle of a folder that could be synced
            Kind::Folder if cfg!(unix) => File::open(path)?.sync_all(),
            _ => Ok(()),
        }
    }

    fn create_folder(&self, folder: &Path) -> io::Result<()> {
        fs::create_dir(folder)
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove_file(&self, file: &Path) -> io::Result<()> {
        fs::remove_file(file)
    }

    fn remove_folder(&self, folder: &Path) -> io::Result<()> {
        fs::remove_dir(folder)
    }

    fn lock(&self, path: &Path, wait: bool) -> io::Result<Option<File>> {
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(path)?;
        let taken = if wait {
            file.lock()
        } else {
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(error)) => Err(error),
                Ok(()) => Ok(()),
            }
        };
        match taken {
            // a file system without locks: as good as it gets there
            Err(error) if error.kind() != io::ErrorKind::Unsupported => Err(error),
            _ => Ok(Some(file)),
        }
    }
}

/// Removes a folder with all in it; no error where it is not there.
pub(crate) fn remove_tree(disk: &dyn FileSystem, folder: &Path) -> io::Result<()> {
    match disk.kind(folder)? {
        None => Ok(()),
        Some(Kind::Folder) => {
            for path in disk.list(folder)? {
                remove_tree(disk, &path)?;
            }
            disk.remove_folder(folder)
        }
        Some(_) => disk.remove_file(folder),
    }
}

/// Everything in a folder that is not a folder, and the folders themselves, inner before outer.
#[derive(Debug, Default)]
pub(crate) struct Tree {
    pub files: Vec<(PathBuf, Kind)>,
    pub folders: Vec<PathBuf>,
}

impl Tree {
    pub fn of(disk: &dyn FileSystem, folder: &Path) -> io::Result<Self> {
        let mut tree = Self::default();
        tree.add(disk, folder)?;
        Ok(tree)
    }

    fn add(&mut self, disk: &dyn FileSystem, folder: &Path) -> io::Result<()> {
        for path in disk.list(folder)? {
            match disk.kind(&path)? {
                Some(Kind::Folder) => self.add(disk, &path)?,
                Some(kind) => self.files.push((path, kind)),
                None => {}
            }
        }
        self.folders.push(folder.to_path_buf());
        Ok(())
    }
}
