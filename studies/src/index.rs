//! The summary of misses in `docs/validation/README.md`, collected from all pages beside it.

use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

const BEGIN: &str = "<!-- misses: begin; written by `cargo xtask validate --index` -->";
const END: &str = "<!-- misses: end -->";

/// File names and texts of the pages of a folder, by name; without `README.md`.
///
/// # Errors
/// If the folder or a page cannot be read.
pub fn read_pages(folder: &Path) -> io::Result<Vec<(String, String)>> {
    let mut pages = vec![];
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") && name != "README.md" {
            pages.push((name, fs::read_to_string(entry.path())?));
        }
    }
    pages.sort();
    Ok(pages)
}

/// The summary with what misses in `pages` between its marks; absent where it has no such marks.
pub fn with_misses(summary: &str, pages: &[(String, String)]) -> Option<String> {
    let (before, rest) = summary.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    let mut table = String::from("| page | claim | asked | measured |\n|---|---|---|---|\n");
    for (file, page) in pages {
        let title = page.lines().find_map(|l| l.strip_prefix("# ")).unwrap_or(file);
        for [claim, asked, measured] in rows_that_miss(page) {
            let _ = writeln!(table, "| [{title}]({file}) | {claim} | {asked} | {measured} |");
        }
    }
    Some(format!("{before}{BEGIN}\n\n{table}\n{END}{after}"))
}

/// Writes the misses of all pages of a folder into its `README.md`.
///
/// # Errors
/// If a page cannot be read or written, or the summary lacks its marks.
pub fn update(folder: &Path) -> io::Result<()> {
    let path = folder.join("README.md");
    let summary = with_misses(&fs::read_to_string(&path)?, &read_pages(folder)?)
        .ok_or_else(|| io::Error::other(format!("{} lacks {BEGIN} or {END}", path.display())))?;
    fs::write(path, summary)
}

/// Claim, asked and measured of the rows below `## Misses` whose verdict is a miss; of all where there is no verdict.
fn rows_that_miss(page: &str) -> Vec<[&str; 3]> {
    let Some((_, rest)) = page.split_once("\n## Misses\n") else { return vec![] };
    let section = rest.split("\n## ").next().unwrap_or(rest);
    let mut rows = section.lines().filter(|l| l.starts_with('|')).map(cells);
    let Some(header) = rows.next() else { return vec![] };
    let column = |name| header.iter().position(|cell| *cell == name);
    let (Some(claim), Some(asked), Some(measured)) = (column("claim"), column("asked"), column("measured"))
    else {
        return vec![];
    };
    let verdict = column("verdict");
    let misses = |row: &Vec<&str>| verdict.is_none_or(|v| row.get(v).is_some_and(|t| t.contains("**miss")));
    // The first row is the rule below the header.
    rows.skip(1)
        .filter(misses)
        .filter_map(|row| Some([*row.get(claim)?, *row.get(asked)?, *row.get(measured)?]))
        .collect()
}

fn cells(line: &str) -> Vec<&str> {
    line.trim().trim_matches('|').split('|').map(str::trim).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_misses_is_collected_and_nothing_else_changes() {
        let page = "# Title\n\n## Misses\n\n| claim | asked | measured | verdict |\n|---|---|---|---|\n\
                    | a | 1 | 2 | **misses** |\n| b | 1 | 1 | unresolved |\n\n## What holds\n\n| claim | x |\n|---|---|\n| c | d |\n";
        let no_verdict =
            "# Other\n\n## Misses\n\n| claim | asked | measured |\n|---|---|--:|\n| d | 3 | 4 |\n";
        let pages = [("p.md".into(), page.into()), ("q.md".into(), no_verdict.into())];
        let summary = format!("before\n{BEGIN}\nold\n{END}\nafter\n");
        let expected = format!(
            "before\n{BEGIN}\n\n| page | claim | asked | measured |\n|---|---|---|---|\n\
             | [Title](p.md) | a | 1 | 2 |\n| [Other](q.md) | d | 3 | 4 |\n\n{END}\nafter\n"
        );
        assert_eq!(with_misses(&summary, &pages), Some(expected));
        assert_eq!(with_misses("no marks", &pages), None);
    }
}
