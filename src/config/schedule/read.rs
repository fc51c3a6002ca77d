//! A schedule from a TOML file, with every problem at its place.

use super::tables::SCHEDULE_FILE;
use super::{Schedule, Start, Step};
use crate::config::diagnostics::Problems;
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::text_file::{self, Wording};
use crate::i18n::Note;
use std::path::Path;

/// What is said of a schedule that cannot be read at all.
const WORDING: Wording = Wording { unreadable: "schedule_file.unreadable", folder: "schedule_file.folder" };

/// Reads a schedule.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<Schedule, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &WORDING)?)
}

/// Reads a schedule from the bytes of a file; `name` stands in diagnostics.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Schedule, Problems> {
    let (schedule, problems) = checked(&text_file::source(name, bytes)?, &SCHEDULE_FILE, build);
    schedule.ok_or(problems)
}

fn build(root: &Section, reader: &mut Reader<'_>) -> Schedule {
    let of = |key: &str| root.table("start").and_then(|s| s.number(key));
    let start = Start {
        temp_degc: of("temp_degC"),
        table_rate_deg_s: of("table_rate_deg_s"),
        table_angle_deg: of("table_angle_deg"),
    };
    let steps = root.tables("step").iter().filter_map(|section| step(section, reader)).collect();
    Schedule { start, steps }
}

fn step(section: &Section, reader: &mut Reader<'_>) -> Option<Step> {
    let does = section.word("do")?;
    let (needed, possible): (&[&str], &[&str]) = match does {
        "hold" => (&["duration_h"], &[]),
        "ramp" => (&["to_degC", "rate_degC_per_h"], &[]),
        "cycle" => (&["low_degC", "high_degC", "rate_degC_per_h"], &["soak_h", "count"]),
        "table_rates" => (&["rates_deg_s", "dwell_s"], &["count"]),
        _ => (&["angles_deg", "dwell_s"], &["count"]),
    };
    let there = |key: &str| section.entry(key).is_some();
    let missing: Vec<&str> = needed.iter().copied().filter(|key| !there(key)).collect();
    if !missing.is_empty() {
        let message = Note::new("schedule_file.missing").with("step", does);
        let help = Note::new("schedule_file.help.missing").with("names", missing.join(", "));
        reader.error(&section.span_of("do"), message, Some(help));
        return None;
    }
    let known = |key: &str| key == "do" || needed.contains(&key) || possible.contains(&key);
    for key in section.entries.keys().filter(|key| !known(key)) {
        let message = Note::new("schedule_file.foreign").with("step", does).with("key", *key);
        let keys = [needed, possible].concat().join(", ");
        let help = Note::new("keyed.help.known").with("keys", keys);
        reader.error(&section.span_of(key), message, Some(help));
    }
    let number = |key: &str| section.number(key).unwrap_or(0.0);
    let list = |key: &str| section.numbers(key).map(<[f64]>::to_vec).unwrap_or_default();
    let count = count(section, reader);
    for key in ["rates_deg_s", "angles_deg"].into_iter().filter(|key| there(key) && list(key).is_empty()) {
        reader.error(&section.span_of(key), Note::new("schedule_file.empty").with("key", key), None);
    }
    Some(match does {
        "hold" => Step::Hold { duration_h: number("duration_h") },
        "ramp" => Step::Ramp { to_degc: number("to_degC"), rate_degc_per_h: number("rate_degC_per_h") },
        "cycle" => Step::Cycle {
            low_degc: number("low_degC"),
            high_degc: number("high_degC"),
            rate_degc_per_h: number("rate_degC_per_h"),
            soak_h: number("soak_h"),
            count,
        },
        "table_rates" => {
            Step::TableRates { rates_deg_s: list("rates_deg_s"), dwell_s: number("dwell_s"), count }
        }
        _ => Step::Headings { angles_deg: list("angles_deg"), dwell_s: number("dwell_s"), count },
    })
}

/// How many times a step is done.
fn count(section: &Section, reader: &mut Reader<'_>) -> u32 {
    let count = section.number("count").unwrap_or(1.0);
    if count.fract() != 0.0 {
        reader.error(&section.span_of("count"), Note::new("reading.whole").with("key", "count"), None);
    }
    count as u32
}
