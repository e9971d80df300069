//! The documentation as one site, and whether it is right.
//!
//! Pages are the Markdown files that `docs/SUMMARY.md` lists; the site stands in `target/site`, needs neither network nor scripts (formulas are MathML)
//! and holds the crates' API beside the pages. Checked on the way: every link and anchor, every citation, every formula, and what [`check`]
//! says about commands, case files and code. The case-file reference is written from the schemas.

mod bibliography;
mod check;
mod numbers;
mod page;
mod reference;
mod site;

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

/// Something a page says that is not so.
pub struct Fault {
    /// Page, from the root of the repository.
    pub file: PathBuf,
    /// Line.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.message)
    }
}

/// Builds and checks the site. With `check`, committed pages that are not current are faults instead of being written; with `api`, the
/// crates' documentation is built and put beside the pages; with `numbers`, case files are run and numbers on pages compared with their results.
pub fn run(check: bool, api: bool, numbers: bool) -> anyhow::Result<()> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let mut faults = Vec::new();
    for (file, text) in reference::pages() {
        let path = root.join(&file);
        if std::fs::read_to_string(&path).is_ok_and(|old| old == text) {
            continue;
        }
        if check {
            faults.push(Fault { file, line: 1, message: "not current: `cargo xtask docs` writes it".into() });
        } else {
            std::fs::create_dir_all(path.parent().unwrap_or(root))?;
            std::fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))?;
            println!("wrote {}", file.display());
        }
    }
    let site = site::Site::read(root)?;
    for page in site.pages() {
        faults.extend(check::faults(page, root));
    }
    if numbers {
        let mut runs = numbers::Runs::new(root);
        for page in site.pages() {
            faults.extend(runs.faults(page));
        }
    }
    let target = target_folder(root);
    let folder = target.join("site");
    site.write(&folder, &mut faults)?;
    if api {
        crate::ci::cargo(&["doc", "--no-deps", "--workspace", "--release"], &[("RUSTDOCFLAGS", "-D warnings")])?;
        site::copy_folder(&target.join("doc"), &folder.join("api"))?;
    }
    for fault in &faults {
        eprintln!("{fault}");
    }
    if !faults.is_empty() {
        bail!("{} faults in the documentation", faults.len());
    }
    println!("{} pages without faults: {}", site.pages().len(), folder.join("index.html").display());
    Ok(())
}

/// Where cargo builds.
fn target_folder(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}
