//! A file system that fails, or dies, at the n-th call: for tests of programs that keep their files in this store.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::digest::Digest;
use crate::file_system::{Disk, FileSystem, Kind};

/// What happens at the n-th call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The call is refused without effect; later calls work.
    Refuse,
    /// A write leaves half of its content and is refused; other calls are refused. Later calls work.
    Half,
    /// The process is killed before the call: neither it nor any later one has an effect.
    KillBefore,
    /// The process is killed in the middle of the call: half of a write, otherwise the whole call; no later call has an effect.
    KillAfter,
    /// The process really ends there, as by an abort.
    Abort,
}

/// The disk with a fault.
#[derive(Debug)]
pub struct Faulty {
    fault: Fault,
    at: usize,
    calls: AtomicUsize,
}

enum Turn {
    Work,
    Refuse,
    /// Half of a write, the whole of another call, then refused.
    Half,
}

impl Faulty {
    /// With a fault at call `at`, counted from 0.
    #[must_use]
    pub fn new(fault: Fault, at: usize) -> Self {
        Self { fault, at, calls: AtomicUsize::new(0) }
    }

    /// Calls made.
    #[must_use]
    pub fn calls(&self) -> usize {
        self.calls.load(Ordering::Relaxed)
    }

    fn turn(&self) -> Turn {
        let call = self.calls.fetch_add(1, Ordering::Relaxed);
        match self.fault {
            _ if call < self.at => Turn::Work,
            Fault::Abort if call == self.at => std::process::abort(),
            Fault::Refuse | Fault::Half | Fault::Abort if call > self.at => Turn::Work,
            Fault::Half => Turn::Half,
            Fault::KillAfter if call == self.at => Turn::Half,
            _ => Turn::Refuse,
        }
    }

    fn call<T>(&self, work: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
        match (self.turn(), self.fault) {
            (Turn::Work, _) => work(),
            (Turn::Half, Fault::KillAfter) => {
                let _ = work();
                Err(injected())
            }
            _ => Err(injected()),
        }
    }
}

fn injected() -> io::Error {
    io::Error::other("injected failure")
}

impl FileSystem for Faulty {
    fn kind(&self, path: &Path) -> io::Result<Option<Kind>> {
        self.call(|| Disk.kind(path))
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        self.call(|| Disk.list(folder))
    }

    fn read(&self, file: &Path) -> io::Result<Vec<u8>> {
        self.call(|| Disk.read(file))
    }

    fn digest(&self, file: &Path) -> io::Result<Digest> {
        self.call(|| Disk.digest(file))
    }

    fn write(&self, file: &Path, content: &[u8]) -> io::Result<()> {
        match self.turn() {
            Turn::Work => Disk.write(file, content),
            Turn::Half => {
                let _ = Disk.write(file, &content[..content.len() / 2]);
                Err(injected())
            }
            Turn::Refuse => Err(injected()),
        }
    }

    fn sync(&self, path: &Path, kind: Kind) -> io::Result<()> {
        self.call(|| Disk.sync(path, kind))
    }

    fn create_folder(&self, folder: &Path) -> io::Result<()> {
        self.call(|| Disk.create_folder(folder))
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.call(|| Disk.rename(from, to))
    }

    fn remove_file(&self, file: &Path) -> io::Result<()> {
        self.call(|| Disk.remove_file(file))
    }

    fn remove_folder(&self, folder: &Path) -> io::Result<()> {
        self.call(|| Disk.remove_folder(folder))
    }

    fn lock(&self, file: &Path, wait: bool) -> io::Result<Option<File>> {
        self.call(|| Disk.lock(file, wait))
    }
}
