//! `sagnac record`: what the devices of a bench say becomes a recording, while a schedule is carried out.

use super::length::{self, Length};
use super::place::{self, OutputPlace};
use super::{ending, exit, next_step};
use crate::config::diagnostics::Problems;
use crate::config::{bench, schedule};
use crate::effect::Column;
use crate::i18n::{Lang, Localize, Note, io_reason, note};
use crate::moment;
use crate::output::{StagedFile, checksums, outside_stores, sha256_of_file};
use crate::schedule::Schedule;
use clap::Args;
use sagnac_bench::device::SafeState;
use sagnac_bench::motion::{TABLE_ANGLE, TABLE_RATE, problems};
use sagnac_bench::session::{End, Order, Summary, record};
use sagnac_bench::setup::Bench;
use sagnac_bench::{Clock, Leg};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Copies of the inputs in the folder of a recording.
const BENCH_COPY: &str = "bench.toml";
const SCHEDULE_COPY: &str = "schedule.toml";
/// Hashes of the files of a recording, written at its end.
const HASHES_FILE: &str = "SHA256SUMS";

#[derive(Debug, Args)]
pub struct RecordArgs {
    /// Devices of the bench, and what they may be asked to move (TOML)
    #[arg(value_name = "BENCH")]
    bench: PathBuf,
    /// Schedule that is carried out, as `sagnac plan` writes it (TOML)
    #[arg(long, value_name = "FILE")]
    schedule: Option<PathBuf>,
    /// Length of a recording without a schedule, with its unit [default: until Ctrl-C]
    #[arg(long, value_name = "LENGTH", value_parser = length::above_zero, conflicts_with = "schedule")]
    duration: Option<Length>,
    /// Serial number of the unit [default: what its driver states]
    #[arg(long, value_name = "SN")]
    serial: Option<String>,
    /// Check bench and schedule, and end before anything is reached
    #[arg(long)]
    check: bool,
    /// Folder for the recording, which must be empty [default: named after the unit and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print only errors and the path of the recording
    #[arg(long, short)]
    quiet: bool,
    /// Emulated bench, host and port: its clock is used in place of that of this computer
    #[arg(long, value_name = "ADDRESS", hide = true)]
    twin: Option<String>,
}

/// Records until the schedule is carried out, the length is over, something goes wrong or a request to end comes; gives the exit code.
///
/// # Errors
/// The diagnostic, in words.
pub fn main(args: &RecordArgs, lang: Lang) -> Result<u8, String> {
    let say = |problems: Problems| problems.say(lang);
    let error = |note: &Note| place::error(note, lang);
    let bench = bench::load(&args.bench).map_err(say)?;
    let schedule = args.schedule.as_deref().map(schedule::load).transpose().map_err(say)?;
    let legs = schedule.as_ref().map_or_else(Vec::new, legs);
    if schedule.is_some() && legs.is_empty() {
        return Err(error(&note!("record.empty_schedule")));
    }
    let refused = problems(&legs, &bench);
    if !refused.is_empty() {
        return Err(refused.iter().map(error).collect());
    }
    let print = |note: &Note| {
        if !args.quiet {
            place::print(&format!("{}\n", note.say(lang)));
        }
    };
    if args.check {
        let length_s: f64 = legs.iter().map(|leg| leg.length.as_secs_f64()).sum();
        print(&note!(
            "record.sound",
            devices = bench.devices.len(),
            length = crate::i18n::Arg::span(length_s)
        ));
        return Ok(exit::PASS);
    }
    ending::defer();
    let folder = folder(args).map_err(|note| error(&note))?;
    let clock = match &args.twin {
        None => Clock::own(),
        Some(address) => {
            Clock::twin(address).map_err(|e| error(&note!("bench_fault.twin", reason = io_reason(&e))))?
        }
    };
    print(&note!("record.into", folder = place::shown(&folder)));
    let order = Order {
        bench: &bench,
        legs,
        duration: args
            .duration
            .map(|length| Duration::try_from_secs_f64(length.seconds).unwrap_or(Duration::MAX)),
        folder: &folder,
        serial: args.serial.as_deref(),
        at: &moment::now().to_rfc3339(),
    };
    let summary = record(&order, clock, &ending::is_asked, &mut |note| print(&note));
    let hashed = hashes(&folder);
    told(&summary, &folder, &bench, lang, args);
    hashed.map_err(|note| error(&note))?;
    Ok(code(&summary, args.schedule.is_some()))
}

/// The exit code of a recording.
fn code(summary: &Summary, has_schedule: bool) -> u8 {
    let is_safe = summary.safe.iter().all(|(_, state)| *state != SafeState::Failed);
    match &summary.end {
        End::Fault(_) if !summary.began => exit::ERROR,
        End::Fault(_) => exit::FAIL,
        _ if !is_safe => exit::FAIL,
        End::Asked if has_schedule => exit::INDETERMINATE,
        _ if !summary.remarks.is_empty() => exit::INDETERMINATE,
        End::Complete | End::Asked => exit::PASS,
    }
}

/// The folder of the recording, with copies of what was given.
fn folder(args: &RecordArgs) -> Result<PathBuf, Note> {
    let place = OutputPlace::new(args.out.as_deref(), "recording", args.serial.as_deref(), moment::now());
    let folder = place.path().to_owned();
    outside_stores(&folder.join(BENCH_COPY)).map_err(|e| e.note())?;
    let refused = |path: &Path, e: &std::io::Error| {
        note!("watch.unreadable", path = path.display().to_string(), reason = io_reason(e))
    };
    fs::create_dir_all(&folder).map_err(|e| refused(&folder, &e))?;
    let mut entries = fs::read_dir(&folder).map_err(|e| refused(&folder, &e))?;
    if entries.next().is_some() {
        return Err(note!("record.not_empty", folder = place::shown(&folder)));
    }
    let copies = [(Some(&args.bench), BENCH_COPY), (args.schedule.as_ref(), SCHEDULE_COPY)];
    for (from, name) in copies {
        let Some(from) = from else { continue };
        fs::copy(from, folder.join(name)).map_err(|e| refused(from, &e))?;
    }
    Ok(folder)
}

/// Writes the hashes of the files of a recording.
fn hashes(folder: &Path) -> Result<(), Note> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.'));
    let known = |name: String| Some((name.clone(), sha256_of_file(&folder.join(&name))?));
    let hashes: BTreeMap<String, String> = names.filter_map(known).collect();
    let staged = StagedFile::begin(&folder.join(HASHES_FILE), &[], false).map_err(|e| e.note())?;
    staged.publish_with(checksums(&hashes).as_bytes()).map_err(|e| e.note()).map(|_| ())
}

/// Says how a recording ended: faults and what is not safe on standard error, whatever is asked to be quiet.
fn told(summary: &Summary, folder: &Path, bench: &Bench, lang: Lang, args: &RecordArgs) {
    let mut lines = String::new();
    match &summary.end {
        End::Complete => lines.push_str(&note!("record.complete").say(lang)),
        End::Asked => lines.push_str(&note!("record.asked").say(lang)),
        End::Fault(fault) => place::eprint_diagnostic(&place::error(&fault.note(), lang)),
    }
    if args.quiet {
        for remark in &summary.remarks {
            place::eprint_diagnostic(&place::warning(&remark.note(), lang));
        }
    }
    for device in bench.devices.iter().filter(|device| device.has_safe_state) {
        let state = summary.safe.iter().find(|(id, _)| *id == device.id).map(|(_, state)| *state);
        let id = device.id.as_str();
        let note = match state {
            Some(SafeState::Confirmed) => note!("record.safe_confirmed", device = id),
            Some(SafeState::Sent) => note!("record.safe_sent", device = id),
            Some(SafeState::Failed) => {
                place::eprint_diagnostic(&place::error(&note!("record.safe_failed", device = id), lang));
                continue;
            }
            // It was never reached, and nothing was asked of it.
            None => continue,
        };
        lines.push_str(&format!("\n{}", note.say(lang)));
    }
    let written = note!(
        "record.written",
        rows = summary.rows,
        parts = summary.parts,
        length = crate::i18n::Arg::span(summary.length_s)
    );
    lines.push_str(&format!("\n{}\n", written.say(lang)));
    if args.quiet {
        place::print(&format!("{}\n", place::shown(&folder.join(RECORDING_FILE))));
        return;
    }
    place::print(lines.trim_start_matches('\n'));
    if summary.parts > 0 {
        let step = next_step::after_record(&folder.join(RECORDING_FILE));
        place::print(&format!("{}\n", step.say(lang)));
    }
}

/// The file by which a recording is read.
const RECORDING_FILE: &str = sagnac_bench::MANIFEST_FILE;

/// The legs of a schedule by the quantities of a bench.
fn legs(schedule: &Schedule) -> Vec<Leg> {
    let of = |leg: &crate::schedule::Leg| {
        let (mut from, mut to) = (BTreeMap::new(), BTreeMap::new());
        let mut put = |quantity: &str, ends: Option<[f64; 2]>| {
            let Some([begin, end]) = ends else { return };
            from.insert(quantity.to_owned(), begin);
            to.insert(quantity.to_owned(), end);
        };
        put(Column::Temperature.name(), leg.temp_degc);
        put(TABLE_RATE, leg.table_rate_deg_s.map(|rate| [rate; 2]));
        put(TABLE_ANGLE, leg.table_angle_deg.map(|angle| [angle; 2]));
        Leg { length: Duration::try_from_secs_f64(leg.to_s - leg.from_s).unwrap_or_default(), from, to }
    };
    schedule.legs().iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::{Start, Step};

    #[test]
    fn legs_have_the_names_of_the_columns_of_a_schedule() {
        let start = Start { temp_degc: Some(20.0), table_angle_deg: Some(90.0), ..Start::default() };
        let steps = vec![
            Step::Ramp { to_degc: 30.0, rate_degc_per_h: 60.0 },
            Step::TableRates { rates_deg_s: vec![5.0], dwell_s: 30.0, count: 1 },
        ];
        let [ramp, rate] = &legs(&Schedule { start, steps })[..] else { panic!() };
        assert_eq!(ramp.length, Duration::from_secs(600));
        let of = |pairs: [(&str, f64); 3]| {
            pairs.map(|(q, v)| (q.to_owned(), v)).into_iter().collect::<BTreeMap<_, _>>()
        };
        assert_eq!(
            ramp.from,
            of([("temp_degC", 20.0), ("table_rate_deg_s", 0.0), ("table_angle_deg", 90.0)])
        );
        assert_eq!(ramp.to["temp_degC"], 30.0);
        assert_eq!((rate.from["table_rate_deg_s"], rate.length), (5.0, Duration::from_secs(30)));
        assert_eq!([Column::TableRate.name(), Column::TableAngle.name()], [TABLE_RATE, TABLE_ANGLE]);
    }
}
