//! `sagnac guide`: the documents that the program carries, and the search over them.

use super::{exit, place};
use crate::i18n::{Lang, Localize, note};
use crate::manual::{self, PAGES, Section};
use clap::Args;
use std::fmt::Write as _;

/// Sections that are shown.
const MAX_SHOWN: usize = 8;
/// Lines of a section that are shown.
const MAX_LINES: usize = 6;

#[derive(Debug, Args)]
pub struct GuideArgs {
    /// Name of a page, which is printed; or words to search for [default: list the pages]
    #[arg(value_name = "PAGE|WORD")]
    words: Vec<String>,
}

pub fn main(args: &GuideArgs, lang: Lang) -> Result<u8, String> {
    if args.words.is_empty() {
        place::print(&list(lang));
        return Ok(exit::PASS);
    }
    if let [name] = args.words.as_slice()
        && let Some(page) = manual::page(name)
    {
        place::print(page.text);
        return Ok(exit::PASS);
    }
    let found = manual::search(&args.words);
    if found.is_empty() {
        return Err(place::error(&note!("guide.nothing", words = args.words.join(" ")), lang));
    }
    place::print(&shown(&found, lang));
    Ok(exit::PASS)
}

/// The pages with their titles.
fn list(lang: Lang) -> String {
    let width = PAGES.iter().map(|p| p.name().len()).max().unwrap_or(0);
    let mut out = String::new();
    for page in PAGES {
        let _ = writeln!(out, "  {:<width$}  {}", page.name(), page.title());
    }
    let _ = writeln!(out, "\n{}", note!("guide.how").say(lang));
    out
}

/// The beginnings of the first sections.
fn shown(found: &[Section], lang: Lang) -> String {
    let mut out = String::new();
    for section in found.iter().take(MAX_SHOWN) {
        let _ = writeln!(out, "{}: {}", section.page.name(), section.heading);
        let lines = section.text.lines().skip(1).filter(|line| !line.trim().is_empty());
        for line in lines.take(MAX_LINES) {
            let _ = writeln!(out, "  {line}");
        }
        out.push('\n');
    }
    let further = found.len().saturating_sub(MAX_SHOWN);
    if further > 0 {
        let _ = writeln!(out, "{}", note!("guide.further", n = further).say(lang));
    }
    let _ = writeln!(out, "{}", note!("guide.page").say(lang));
    out
}
