//! One self-contained page: the table of printed numbers, then every figure with its description, numbers, data and case files.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::drawn::{Done, Outcome, Saved, Table};
use super::printed::{Compared, Printed, Verdict, significant};
use super::{Level, root};

const STYLE: &str = "
:root { --ink: #1b1b1b; --soft: #666; --line: #d8d8d8; --pass: #176f3a; --differs: #b3400b; --none: #6b6b6b; }
* { box-sizing: border-box }
body { font: 16px/1.5 Georgia, 'Times New Roman', serif; color: var(--ink); max-width: 74rem; margin: 0 auto; padding: 1.5rem; background: #fff }
h1, h2, h3, nav, table, .meta, summary, .chip { font-family: system-ui, 'Helvetica Neue', Arial, sans-serif }
h1 { font-size: 1.7rem; margin: 0 0 .3rem } h2 { font-size: 1.25rem; margin: 3rem 0 .4rem; border-top: 2px solid var(--ink); padding-top: .8rem }
a { color: #0b4f9e } nav { font-size: .85rem; line-height: 1.9; margin: 1rem 0 } nav a { margin-right: .7rem; white-space: nowrap }
table { border-collapse: collapse; font-size: .82rem; width: 100%; margin: .7rem 0 } th { text-align: left; border-bottom: 1.5px solid var(--ink) }
th, td { padding: .22rem .55rem; vertical-align: top } td { border-bottom: 1px solid var(--line) } th.n { text-align: right } td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap }
.numbers td:first-child { width: 27% } .numbers td:nth-child(2) { width: 25% } .numbers td:last-child { width: 19% }
.pass { color: var(--pass) } .differs { color: var(--differs); font-weight: 600 } .none { color: var(--none) }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); gap: 1rem; margin: 1rem 0 }
figure { margin: 0; break-inside: avoid } figure img { width: 100%; height: auto; max-height: 34rem; object-fit: contain; border: 1px solid var(--line) }
figcaption { font-size: .88rem; color: var(--soft) } .meta { font-size: .8rem; color: var(--soft) }
.failed { border-left: 4px solid var(--differs); padding: .4rem .8rem; background: #fff4ee } .missing { border-left: 4px solid var(--line); padding: .4rem .8rem; color: var(--none) }
pre { font-size: .72rem; line-height: 1.35; overflow-x: auto; background: #f6f6f4; padding: .7rem; white-space: pre-wrap } ul { margin: .3rem 0 } li { font-size: .9rem }
.count { display: inline-block; margin-right: 1.2rem; font: 600 1rem system-ui, sans-serif }
@media print { body { max-width: none; padding: 0; font-size: 11pt } nav { display: none } details:not([open]) { display: none } h2 { break-after: avoid } .panels { grid-template-columns: 1fr 1fr } }
";

/// Writes `index.html` into the results folder.
///
/// # Errors
/// The file system's.
pub fn write(folder: &Path, all: &[Done], printed: &Printed, level: Level) -> anyhow::Result<PathBuf> {
    let mut page = String::from("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n");
    page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    writeln!(
        page,
        "<title>Figures of the dissertation, computed again</title>\n<style>{STYLE}</style></head>\n<body>"
    )?;
    head(&mut page, all, printed, level)?;
    for done in all {
        figure(&mut page, folder, done, printed)?;
    }
    others(&mut page, printed)?;
    cases(&mut page, all)?;
    page.push_str("</body></html>\n");
    let file = folder.join("index.html");
    std::fs::write(&file, page).with_context(|| format!("{} cannot be written", file.display()))?;
    Ok(file)
}

/// How many of each verdict: pass, differs, not comparable.
pub fn counts(all: &[Compared]) -> [usize; 3] {
    let of = |pick: fn(&Verdict) -> bool| all.iter().filter(|c| pick(&c.verdict)).count();
    [of(|v| *v == Verdict::Pass), of(|v| *v == Verdict::Differs), of(|v| matches!(v, Verdict::NotComparable(_)))]
}

fn head(page: &mut String, all: &[Done], printed: &Printed, level: Level) -> anyhow::Result<()> {
    let compared: Vec<Compared> = all.iter().flat_map(|d| printed.compare(d)).collect();
    let [pass, differs, none] = counts(&compared);
    let seconds: f64 = all.iter().filter_map(|d| drawn(d).map(|s| s.seconds)).sum();
    write!(
        page,
        "<h1>Figures of the dissertation, computed again</h1>\n<p class=\"meta\">gearwright {}, level {}; {:.0} s of computing</p>\n\
         <p>Every figure and table that holds computed results, from the case files of the repository. Numbers printed in the dissertation stand beside \
         the computed ones; nothing is fitted to them. A number passes if it is as near as the tolerance of its kind, which was set beforehand from \
         what the dissertation leaves open (below the table), and half a unit of its last printed digit.</p>\n\
         <p><span class=\"count pass\">{pass} pass</span><span class=\"count differs\">{differs} differ</span>\
         <span class=\"count none\">{none} not comparable</span></p>\n<nav>",
        env!("CARGO_PKG_VERSION"),
        level.name(),
        seconds
    )?;
    for done in all {
        let style = match done.outcome {
            Outcome::Drawn(_) => "",
            Outcome::Failed(_) => " class=\"differs\"",
            Outcome::NotAsked => " class=\"none\"",
        };
        writeln!(page, "<a{style} href=\"#f{}\">{}</a>", done.figure.id, name(done.figure.id))?;
    }
    page.push_str("</nav>\n<table class=\"numbers\"><thead><tr><th>where</th><th>what</th><th>unit</th><th class=\"n\">printed</th><th class=\"n\">computed</th><th class=\"n\">difference</th><th>verdict</th></tr></thead><tbody>\n");
    for one in &compared {
        row(page, one, true)?;
    }
    page.push_str("</tbody></table>\n<h3>Tolerances</h3>\n<table><thead><tr><th>kind</th><th>tolerance</th><th>why</th></tr></thead><tbody>\n");
    for kind in &printed.kind {
        let absolute = if kind.absolute > 0.0 { format!(" and {} in the unit", kind.absolute) } else { String::new() };
        let percent = 100.0 * kind.relative;
        writeln!(
            page,
            "<tr><td>{}</td><td>{percent} %{absolute}</td><td>{}</td></tr>",
            escaped(&kind.name),
            escaped(&kind.why)
        )?;
    }
    page.push_str("</tbody></table>\n");
    Ok(())
}

fn drawn(done: &Done) -> Option<&Saved> {
    match &done.outcome {
        Outcome::Drawn(saved) => Some(saved),
        _ => None,
    }
}

/// "Figure 2.1", "Table 2.1".
pub fn name(id: &str) -> String {
    id.strip_prefix('T').map_or_else(|| format!("Figure {id}"), |number| format!("Table {number}"))
}

fn row(page: &mut String, one: &Compared, linked: bool) -> anyhow::Result<()> {
    let number = one.number;
    let (class, verdict) = match &one.verdict {
        Verdict::Pass => ("pass", "pass".to_owned()),
        Verdict::Differs => {
            ("differs", number.note.as_ref().map_or("differs".to_owned(), |note| format!("differs: {note}")))
        }
        Verdict::NotComparable(reason) => ("none", format!("not comparable: {reason}")),
    };
    let place = escaped(&number.place);
    let place = if linked { format!("<a href=\"#f{}\">{place}</a>", number.figure) } else { place };
    writeln!(
        page,
        "<tr><td>{place}</td><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
         <td class=\"{class}\">{}</td></tr>",
        escaped(&number.key),
        escaped(&number.unit),
        number.printed,
        one.shown(),
        one.difference(),
        escaped(&verdict)
    )?;
    Ok(())
}

fn figure(page: &mut String, folder: &Path, done: &Done, printed: &Printed) -> anyhow::Result<()> {
    let figure = done.figure;
    writeln!(
        page,
        "<section><h2 id=\"f{}\">{}. {}</h2>\n<p>{}</p>",
        figure.id,
        name(figure.id),
        escaped(figure.title),
        escaped(figure.about)
    )?;
    match &done.outcome {
        Outcome::NotAsked => {
            page.push_str("<p class=\"missing\">Not computed: others were asked for with --only.</p>\n")
        }
        Outcome::Failed(error) => writeln!(page, "<p class=\"failed\">Failed: {}</p>", escaped(error))?,
        Outcome::Drawn(saved) => content(page, folder, saved)?,
    }
    let compared = printed.compare(done);
    if !compared.is_empty() && drawn(done).is_some() {
        page.push_str("<table class=\"numbers\"><thead><tr><th>printed where</th><th>what</th><th>unit</th><th class=\"n\">printed</th><th class=\"n\">computed</th><th class=\"n\">difference</th><th>verdict</th></tr></thead><tbody>\n");
        for one in &compared {
            row(page, one, false)?;
        }
        page.push_str("</tbody></table>\n");
    }
    let claims = printed.claims(done);
    if !claims.is_empty() && drawn(done).is_some() {
        page.push_str("<table><thead><tr><th>said in words where</th><th>what</th><th>found</th><th>holds</th></tr></thead><tbody>\n");
        for (claim, found) in claims {
            let (class, holds, found) = match found {
                Some(found) if found.holds => ("pass", "yes", found.found.as_str()),
                Some(found) => ("differs", "no", found.found.as_str()),
                None => ("none", "not found out", ""),
            };
            let (place, says, found) = (escaped(&claim.place), escaped(&claim.says), escaped(found));
            writeln!(
                page,
                "<tr><td>{place}</td><td>{says}</td><td>{found}</td><td class=\"{class}\">{holds}</td></tr>"
            )?;
        }
        page.push_str("</tbody></table>\n");
    }
    if let Some(saved) = drawn(done) {
        let files: Vec<String> =
            figure.cases.iter().map(|file| format!("<a href=\"#c-{file}\">configs/{file}</a>")).collect();
        let from = if files.is_empty() { "no case file".to_owned() } else { files.join(", ") };
        writeln!(page, "<p class=\"meta\">From {from}; {} s.</p>", significant(saved.seconds))?;
    }
    page.push_str("</section>\n");
    Ok(())
}

fn content(page: &mut String, folder: &Path, saved: &Saved) -> anyhow::Result<()> {
    if !saved.panels.is_empty() {
        page.push_str("<div class=\"panels\">\n");
        for (file, about) in &saved.panels {
            let path = folder.join("figures").join(format!("{file}.svg"));
            let svg = std::fs::read(&path).with_context(|| format!("{} cannot be read", path.display()))?;
            let data = STANDARD.encode(svg);
            let about = escaped(about);
            writeln!(
                page,
                "<figure><img alt=\"{about}\" src=\"data:image/svg+xml;base64,{data}\"><figcaption>{about}</figcaption></figure>"
            )?;
        }
        page.push_str("</div>\n");
    }
    for Table { head, rows } in &saved.tables {
        page.push_str("<table><thead><tr>");
        head.iter().for_each(|cell| *page += &format!("<th>{}</th>", escaped(cell)));
        page.push_str("</tr></thead><tbody>\n");
        for cells in rows {
            page.push_str("<tr>");
            for (k, cell) in cells.iter().enumerate() {
                let class = if k > 0 && cell.parse::<f64>().is_ok() { " class=\"n\"" } else { "" };
                write!(page, "<td{class}>{}</td>", escaped(cell))?;
            }
            page.push_str("</tr>\n");
        }
        page.push_str("</tbody></table>\n");
    }
    if !saved.notes.is_empty() {
        page.push_str("<ul>");
        saved.notes.iter().for_each(|note| *page += &format!("<li>{}</li>", escaped(note)));
        page.push_str("</ul>\n");
    }
    Ok(())
}

/// Printed numbers that are no results.
fn others(page: &mut String, printed: &Printed) -> anyhow::Result<()> {
    page.push_str(
        "<h2>Printed numbers that are not compared</h2>\n<details><summary>Input, repetitions, results of others</summary>\n\
         <table><thead><tr><th>what</th><th>sections</th><th>numbers</th></tr></thead><tbody>\n",
    );
    for other in &printed.other {
        let sections =
            if other.sections.iter().any(String::is_empty) { "all".into() } else { other.sections.join(", ") };
        let (reason, numbers) = (escaped(&other.reason), escaped(&other.numbers.join("; ")));
        writeln!(page, "<tr><td>{reason}</td><td>{sections}</td><td>{numbers}</td></tr>")?;
    }
    page.push_str("</tbody></table></details>\n");
    Ok(())
}

/// The case files, each once.
fn cases(page: &mut String, all: &[Done]) -> anyhow::Result<()> {
    let mut files: Vec<&str> = all.iter().flat_map(|d| d.figure.cases.iter().copied()).collect();
    files.sort_unstable();
    files.dedup();
    page.push_str("<h2>Case files</h2>\n");
    for file in files {
        let text = std::fs::read_to_string(root().join("configs").join(file))
            .unwrap_or_else(|error| format!("cannot be read: {error}"));
        writeln!(
            page,
            "<details id=\"c-{file}\"><summary>configs/{file}</summary><pre>{}</pre></details>",
            escaped(&text)
        )?;
    }
    // a link into a closed case file opens it
    page.push_str(
        "<script>const open=()=>{const e=document.getElementById(decodeURIComponent(location.hash.slice(1)));\
         if(e&&e.tagName==='DETAILS'){e.open=true;e.scrollIntoView()}};addEventListener('hashchange',open);open()</script>\n",
    );
    Ok(())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
