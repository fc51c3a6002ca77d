//! A schedule from a TOML file, with every problem at its place.

use super::tables::{SCHEDULE_FILE, ScheduleTables, StepKeys};
use super::{Schedule, Start, Step};
use crate::config::diagnostics::Problems;
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::i18n::note;
use std::path::Path;

/// Messages for a schedule that cannot be read at all.
const READ_MESSAGES: Wording =
    Wording { unreadable: "schedule_file.unreadable", folder: "schedule_file.folder" };

/// Reads a schedule.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<Schedule, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &READ_MESSAGES)?)
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
    let ScheduleTables { start, steps } = ScheduleTables::read(root);
    let start = Start {
        temp_degc: start.temp_degc,
        table_rate_deg_s: start.table_rate_deg_s,
        table_angle_deg: start.table_angle_deg,
    };
    Schedule { start, steps: steps.into_iter().filter_map(|keys| step(keys, reader)).collect() }
}

fn step(keys: StepKeys, reader: &mut Reader<'_>) -> Option<Step> {
    let (does, section) = (keys.does?, &keys.section);
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
        let message = note!("schedule_file.missing", step = does);
        let help = note!("schedule_file.help.missing", names = missing.join(", "));
        reader.error(&section.span_of("do"), message, Some(help));
        return None;
    }
    let known = |key: &str| key == "do" || needed.contains(&key) || possible.contains(&key);
    for key in section.entries.keys().filter(|key| !known(key)) {
        let message = note!("schedule_file.foreign", step = does, key = *key);
        let keys = [needed, possible].concat().join(", ");
        let help = note!("keyed.help.known", keys);
        reader.error(&section.span_of(key), message, Some(help));
    }
    let count = count(&keys, reader);
    for (key, list) in [("rates_deg_s", &keys.rates_deg_s), ("angles_deg", &keys.angles_deg)] {
        if there(key) && list.is_empty() {
            reader.error(&section.span_of(key), note!("schedule_file.empty", key), None);
        }
    }
    // Which of the numbers must be there is checked above.
    let [duration_h, to_degc, low_degc, high_degc, rate_degc_per_h, soak_h, dwell_s] = [
        keys.duration_h,
        keys.to_degc,
        keys.low_degc,
        keys.high_degc,
        keys.rate_degc_per_h,
        keys.soak_h,
        keys.dwell_s,
    ]
    .map(Option::unwrap_or_default);
    Some(match does {
        "hold" => Step::Hold { duration_h },
        "ramp" => Step::Ramp { to_degc, rate_degc_per_h },
        "cycle" => Step::Cycle { low_degc, high_degc, rate_degc_per_h, soak_h, count },
        "table_rates" => Step::TableRates { rates_deg_s: keys.rates_deg_s, dwell_s, count },
        _ => Step::Headings { angles_deg: keys.angles_deg, dwell_s, count },
    })
}

/// How many times a step is done.
fn count(keys: &StepKeys, reader: &mut Reader<'_>) -> u32 {
    let count = keys.count.unwrap_or(1.0);
    if count.fract() != 0.0 {
        let message = note!("reading.whole", key = "count");
        reader.error(&keys.section.span_of("count"), message, None);
    }
    count as u32
}
