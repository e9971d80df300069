//! One writer for each target: an advisory lock on a file beside it, given back by the operating system when the process ends in any way.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::file_system::FileSystem;

/// A held lock; its file goes away with it.
#[derive(Debug)]
pub struct Lock {
    disk: Arc<dyn FileSystem>,
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Takes the lock of a file; `None` where another process has it.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn take(disk: &Arc<dyn FileSystem>, path: &Path) -> io::Result<Option<Self>> {
        loop {
            let Some(file) = disk.lock(path, false)? else { return Ok(None) };
            // its last holder may have removed it between opening and locking
            if is_at(&file, path) {
                return Ok(Some(Self { disk: Arc::clone(disk), path: path.to_path_buf(), file }));
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // elsewhere it cannot be seen whether the file opened is the one at the path, so it stays
        if cfg!(unix) {
            let _ = self.disk.remove_file(&self.path);
        }
        let _ = self.file.unlock();
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let same = |a: &std::fs::Metadata, b: &std::fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    matches!((file.metadata(), std::fs::metadata(path)), (Ok(a), Ok(b)) if same(&a, &b))
}

#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}
