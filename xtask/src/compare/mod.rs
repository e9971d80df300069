//! Every number of the kept result files before and after a change, to the bit.
//!
//! A side is a folder of results folders, or a program that is run on every case file into such a folder. Compared are tables (CSV), summaries
//! (JSON, without version and wall times) and grids (VTU, PVD); figures are not. Columns are matched by name, JSON values by key, VTU arrays by name.

mod file;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail, ensure};
use clap::Args;

use file::{Content, Difference};

/// What to compare.
#[derive(Debug, Args)]
pub struct Options {
    /// Folder of results folders, or a program `gearwright` to make one with.
    before: PathBuf,
    /// The same after the change.
    after: PathBuf,
    /// Case files that programs run.
    #[arg(long, default_value = "configs")]
    configs: PathBuf,
    /// Case files that the program `before` runs, where they differ.
    #[arg(long)]
    configs_before: Option<PathBuf>,
    /// Only cases whose names contain one of these.
    #[arg(long = "case")]
    cases: Vec<String>,
    /// Folder that programs write to, in `before` and `after`; results that are there already are taken as they are.
    #[arg(long, default_value = "target/compare-results")]
    out: PathBuf,
    /// Keys of summaries that are not compared, at any depth, besides version and wall times.
    #[arg(long)]
    ignore: Vec<String>,
    /// Differences listed per file.
    #[arg(long, default_value_t = 5)]
    most: usize,
}

/// Compares and lists the differences.
///
/// # Errors
/// Any difference; programs that fail; files that cannot be read.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let configs_before = options.configs_before.as_ref().unwrap_or(&options.configs);
    let before = results(&options.before, configs_before, &options.out.join("before"), &options.cases)?;
    let after = results(&options.after, &options.configs, &options.out.join("after"), &options.cases)?;
    let mut ignored: Vec<&str> = vec!["version", "time_s"];
    ignored.extend(options.ignore.iter().map(String::as_str));
    let (mut compared, mut numbers, mut different) = (0_usize, 0_usize, 0_usize);
    for name in files(&before)?.union(&files(&after)?).filter(|name| is_selected(name, &options.cases)) {
        let (old, new) = (before.join(name), after.join(name));
        let differences = match (old.is_file(), new.is_file()) {
            (true, true) => {
                let (old, new) = (Content::read(&old, &ignored)?, Content::read(&new, &ignored)?);
                numbers += old.len();
                old.differences(&new)
            }
            (true, false) => vec![Difference::only("the file", "before")],
            _ => vec![Difference::only("the file", "after")],
        };
        compared += 1;
        if differences.is_empty() {
            continue;
        }
        different += 1;
        println!("{}", name.display());
        for difference in differences.iter().take(options.most) {
            println!("  {difference}");
        }
        if differences.len() > options.most {
            println!("  and {} more", differences.len() - options.most);
        }
    }
    ensure!(compared > 0, "nothing to compare in {} and {}", before.display(), after.display());
    if different > 0 {
        bail!("{different} of {compared} files differ");
    }
    println!("{numbers} values of {compared} files are the same to the bit");
    Ok(())
}

fn is_selected(name: &Path, cases: &[String]) -> bool {
    let case = name.components().next().map(|c| c.as_os_str().to_string_lossy().into_owned()).unwrap_or_default();
    cases.is_empty() || cases.iter().any(|wanted| case.contains(wanted.as_str()))
}

/// The folder of results of a side; a program makes it.
fn results(side: &Path, configs: &Path, out: &Path, cases: &[String]) -> anyhow::Result<PathBuf> {
    if side.is_dir() {
        return Ok(side.to_path_buf());
    }
    ensure!(side.is_file(), "{} is neither a folder nor a program", side.display());
    let program = fs::canonicalize(side)?;
    let entries = fs::read_dir(configs).with_context(|| format!("{} cannot be read", configs.display()))?;
    let mut files: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|file| file.extension().is_some_and(|e| e == "toml"));
    files.sort();
    for file in files {
        let stem = PathBuf::from(file.file_stem().unwrap_or_default());
        let target = out.join(&stem);
        if target.exists() || !is_selected(&stem, cases) || !file::is_case(&file)? {
            continue;
        }
        println!("{} run {}", side.display(), file.display());
        let output = Command::new(&program).arg("run").arg(&file).arg("--out").arg(&target).output()?;
        ensure!(output.status.success(), "{}: {}", file.display(), String::from_utf8_lossy(&output.stderr));
    }
    Ok(out.to_path_buf())
}

/// Kept files below a folder, by their path in it.
fn files(folder: &Path) -> anyhow::Result<BTreeSet<PathBuf>> {
    let mut found = BTreeSet::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(&next).with_context(|| format!("{} cannot be read", next.display()))? {
            let path = entry?.path();
            let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if path.is_dir() && !hidden {
                open.push(path);
            } else if Content::is_kept(&path) {
                found.insert(path.strip_prefix(folder)?.to_path_buf());
            }
        }
    }
    Ok(found)
}
