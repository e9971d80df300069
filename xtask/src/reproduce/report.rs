//! `docs/reports/dissertation.md`: every printed number with its verdict.

use std::fmt::Write as _;

use super::drawn::Done;
use super::page::{counts, name};
use super::printed::{Compared, Printed, Verdict};
use super::{Level, root};

/// Writes the report.
///
/// # Errors
/// The file system's.
pub fn write(all: &[Done], printed: &Printed, level: Level) -> anyhow::Result<()> {
    let compared: Vec<(&Done, Vec<Compared>)> = all.iter().map(|d| (d, printed.compare(d))).collect();
    let mut counted = [0; 3];
    for (_, own) in &compared {
        counts(own).iter().zip(&mut counted).for_each(|(n, sum)| *sum += n);
    }
    let [pass, differs, none] = counted;
    let mut text = format!(
        "# Printed numbers of the dissertation\n\nWritten by `cargo xtask reproduce-thesis-figures --level {} --report`. {pass} numbers pass, {differs} differ, {none} cannot be \
         compared. Nothing is fitted to the printed numbers; what the dissertation does not print (bores, fillets, crack paths) is chosen in the case files. \
         Heights of pits are taken as arc lengths on the flank but in section 3.2.4.2.1 and 2; see [damaged teeth](../damage.md).\n\n\
         | kind | tolerance | why |\n|---|---|---|\n",
        level.name()
    );
    for kind in &printed.kind {
        let absolute = if kind.absolute > 0.0 { format!(" and {} in the unit", kind.absolute) } else { String::new() };
        writeln!(text, "| {} | {} %{absolute} | {} |", kind.name, 100.0 * kind.relative, kind.why)?;
    }
    text.push_str(
        "\n| where | what | unit | printed | computed | difference | verdict |\n|---|---|---|---|---|---|---|\n",
    );
    let mut silent: Vec<(String, usize, String)> = Vec::new();
    for (done, own) in &compared {
        for one in own {
            let number = one.number;
            let verdict = match &one.verdict {
                Verdict::Pass => "pass",
                Verdict::Differs => match &number.note {
                    Some(note) => &format!("**differs**: {note}"),
                    None => "**differs**",
                },
                // told once for the figure
                Verdict::NotComparable(reason) if one.computed.is_none() => {
                    match silent.iter_mut().find(|s| s.0 == done.figure.id && s.2 == *reason) {
                        Some(known) => known.1 += 1,
                        None => silent.push((done.figure.id.into(), 1, reason.clone())),
                    }
                    continue;
                }
                Verdict::NotComparable(reason) => reason,
            };
            let (place, key, unit) = (&number.place, &number.key, &number.unit);
            let (shown, difference) = (one.shown(), one.difference());
            writeln!(text, "| {place} | {key} | {unit} | {} | {shown} | {difference} | {verdict} |", number.printed)?;
        }
    }
    text.push_str("\n## Said in words\n\n| where | what | found | holds |\n|---|---|---|---|\n");
    for (claim, found) in all.iter().flat_map(|done| printed.claims(done)) {
        let (found, holds) = match found {
            Some(found) => (found.found.as_str(), if found.holds { "yes" } else { "**no**" }),
            None => ("", "not found out"),
        };
        writeln!(text, "| {} | {} | {found} | {holds} |", claim.place, claim.says)?;
    }
    text.push_str("\n## Not compared\n\n| figure | numbers | why |\n|---|---|---|\n");
    for (id, count, reason) in silent {
        writeln!(text, "| {} | {count} | {reason} |", name(&id))?;
    }
    std::fs::write(root().join("docs/reports/dissertation.md"), text)?;
    Ok(())
}
