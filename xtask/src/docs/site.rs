//! Pages joined to a site: contents, links between pages, files they show.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, bail};

use super::Fault;
use super::bibliography::Bibliography;
use super::page::{Page, escaped};

/// Table of contents: parts with links, as lists in Markdown.
const SUMMARY: &str = "docs/SUMMARY.md";
/// Citations go here.
const BIBLIOGRAPHY: &str = "docs/references.bib";
const STYLE: &str = include_str!("style.css");

/// One line of the contents.
enum Entry {
    /// Heading of a part.
    Part(String),
    /// Title and index of a page.
    Page(String, usize),
}

/// All pages and how they are listed.
pub struct Site {
    root: PathBuf,
    pages: Vec<Page>,
    contents: Vec<Entry>,
    bibliography: Bibliography,
}

impl Site {
    /// Reads the contents and all pages it lists.
    pub fn read(root: &Path) -> anyhow::Result<Self> {
        let read = |file: &Path| {
            std::fs::read_to_string(root.join(file)).with_context(|| format!("{} cannot be read", file.display()))
        };
        let (mut pages, mut contents) = (Vec::new(), Vec::new());
        for line in read(Path::new(SUMMARY))?.lines() {
            if let Some(part) = line.strip_prefix("## ") {
                contents.push(Entry::Part(part.to_owned()));
            } else if let Some((title, target)) = line.trim().strip_prefix("- [").and_then(|l| l.split_once("](")) {
                let source = joined(Path::new("docs"), target.trim_end_matches(')'));
                contents.push(Entry::Page(title.to_owned(), pages.len()));
                pages.push(Page::new(&source, read(&source)?));
            }
        }
        let listed: BTreeSet<&Path> = pages.iter().map(|page| page.source.as_path()).collect();
        let mut unlisted = markdown_files(root, Path::new("docs"))?;
        unlisted.retain(|file| !listed.contains(file.as_path()) && file != Path::new(SUMMARY));
        if !unlisted.is_empty() {
            bail!("pages that {SUMMARY} does not list: {unlisted:?}");
        }
        let bibliography = Bibliography::parse(&read(Path::new(BIBLIOGRAPHY))?).context(BIBLIOGRAPHY)?;
        Ok(Self { root: root.to_path_buf(), pages, contents, bibliography })
    }

    /// Pages in the order of the contents.
    pub fn pages(&self) -> &[Page] {
        &self.pages
    }

    /// Writes the site into a folder of its own, which is emptied first.
    pub fn write(&self, folder: &Path, faults: &mut Vec<Fault>) -> anyhow::Result<()> {
        if folder.exists() {
            std::fs::remove_dir_all(folder)?;
        }
        let mut files: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
        for (index, page) in self.pages.iter().enumerate() {
            let here = html_path(&page.source);
            let mut relink = |link: &str| self.target(page, link, &mut files);
            let cite = |text: &str| self.bibliography.cited(text, &relative(&here, Path::new("references.html")));
            let mut body = page.html(&mut relink, &cite, faults);
            let listed: Vec<usize> =
                self.contents.iter().filter_map(|e| if let Entry::Page(_, k) = e { Some(*k) } else { None }).collect();
            let neighbour = |k: usize, arrow: &str| {
                let page = &self.pages[k];
                format!(
                    "<a href=\"{}\">{arrow} {}</a>",
                    relative(&here, &html_path(&page.source)),
                    escaped(&page.title)
                )
            };
            let before = index.checked_sub(1).map_or(String::new(), |k| neighbour(k, "←"));
            let after = if index + 1 < listed.len() { neighbour(index + 1, "→") } else { String::new() };
            let _ = write!(body, "<nav class=\"turn\"><span>{before}</span><span>{after}</span></nav>");
            write_file(&folder.join(&here), &self.frame(&here, &page.title, &body))?;
        }
        let here = Path::new("references.html");
        write_file(&folder.join(here), &self.frame(here, "References", &self.bibliography.html()))?;
        write_file(&folder.join("style.css"), STYLE)?;
        for (source, target) in files {
            let target = folder.join(target);
            std::fs::create_dir_all(target.parent().unwrap_or(folder))?;
            std::fs::copy(self.root.join(&source), &target).with_context(|| format!("{}", source.display()))?;
        }
        Ok(())
    }

    /// Where a link of a page leads in the site; files it needs are put on the list.
    fn target(&self, page: &Page, link: &str, files: &mut BTreeMap<PathBuf, PathBuf>) -> Result<String, String> {
        if link.starts_with("https://") || link.starts_with("http://") || link.starts_with("mailto:") {
            return Ok(link.to_owned());
        }
        let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor)));
        let source = if path.is_empty() {
            page.source.clone()
        } else {
            joined(page.source.parent().unwrap_or(Path::new("")), path)
        };
        let here = html_path(&page.source);
        let suffix = anchor.map_or(String::new(), |anchor| format!("#{anchor}"));
        if let Some(other) = self.pages.iter().find(|other| other.source == source) {
            if let Some(anchor) = anchor.filter(|anchor| !other.anchors.contains(*anchor)) {
                return Err(format!("link {link}: {} has no heading #{anchor}", source.display()));
            }
            let path = if path.is_empty() { String::new() } else { relative(&here, &html_path(&source)) };
            return Ok(format!("{path}{suffix}"));
        }
        let whole = self.root.join(&source);
        if source == Path::new(BIBLIOGRAPHY) {
            return Ok(relative(&here, Path::new("references.html")));
        }
        if let Some(name) =
            source.strip_prefix("crates").ok().filter(|name| whole.is_dir() && name.components().count() == 1)
        {
            let name = name.to_string_lossy().replace('-', "_");
            return Ok(relative(&here, &Path::new("api").join(name).join("index.html")));
        }
        if !whole.is_file() {
            return Err(format!("link {link}: there is no file {}", source.display()));
        }
        let target = source.strip_prefix("docs").unwrap_or(&source).to_path_buf();
        files.insert(source, target.clone());
        Ok(relative(&here, &target))
    }

    /// A whole HTML page.
    fn frame(&self, here: &Path, title: &str, body: &str) -> String {
        let mut contents = String::new();
        for entry in &self.contents {
            match entry {
                Entry::Part(name) => {
                    let _ = writeln!(contents, "<h2>{}</h2>", escaped(name));
                }
                Entry::Page(name, index) => {
                    let there = html_path(&self.pages[*index].source);
                    let mark = if there == here { " aria-current=\"page\"" } else { "" };
                    let _ = writeln!(contents, "<a href=\"{}\"{mark}>{}</a>", relative(here, &there), escaped(name));
                }
            }
        }
        let _ = writeln!(
            contents,
            "<h2>Also</h2>\n<a href=\"{}\">References</a>",
            relative(here, Path::new("references.html"))
        );
        let _ = writeln!(contents, "<a href=\"{}\">Crates</a>", relative(here, Path::new("api/gearwright/index.html")));
        let name = if title == "gearwright" { title.to_owned() } else { format!("{title} · gearwright") };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
             <title>{}</title>\n<link rel=\"stylesheet\" href=\"{}\">\n</head>\n<body>\n<nav class=\"contents\">\n{contents}</nav>\n\
             <main>\n{body}\n</main>\n</body>\n</html>\n",
            escaped(&name),
            relative(here, Path::new("style.css"))
        )
    }
}

/// A page's place in the site.
fn html_path(source: &Path) -> PathBuf {
    match source.to_str() {
        Some("README.md") => "index.html".into(),
        _ => source.strip_prefix("docs").unwrap_or(source).with_extension("html"),
    }
}

/// A path from a folder, its `..` resolved.
fn joined(folder: &Path, path: &str) -> PathBuf {
    let mut out = PathBuf::new();
    for part in folder.join(path).components() {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            Component::CurDir => {}
            other => out.push(other),
        }
    }
    out
}

/// The link from one file of the site to another.
fn relative(from: &Path, to: &Path) -> String {
    let up = from.components().count().saturating_sub(1);
    format!("{}{}", "../".repeat(up), to.display()).replace('\\', "/")
}

fn markdown_files(root: &Path, folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(root.join(folder))? {
        let entry = entry?;
        let path = folder.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            files.extend(markdown_files(root, &path)?);
        } else if path.extension().is_some_and(|e| e == "md") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn write_file(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::create_dir_all(path.parent().unwrap_or(path))?;
    std::fs::write(path, text).with_context(|| format!("{} cannot be written", path.display()))
}

/// Copies a folder with all it holds.
pub fn copy_folder(from: &Path, to: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from).with_context(|| format!("{} cannot be read", from.display()))? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            std::fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_page_to_page() {
        assert_eq!(joined(Path::new("docs/reports"), "../../README.md"), Path::new("README.md"));
        assert_eq!(html_path(Path::new("docs/reports/a.md")), Path::new("reports/a.html"));
        assert_eq!(html_path(Path::new("README.md")), Path::new("index.html"));
        assert_eq!(relative(Path::new("reports/a.html"), Path::new("b.html")), "../b.html");
    }
}
