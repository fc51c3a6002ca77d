//! A bench from a TOML file, with every problem at its place.

use super::tables::{BENCH_FILE, BenchTables, DeviceKeys, LanguageWord, LinkWord, MoveKeys};
use crate::config::contained_files::{folder_of, joined};
use crate::config::diagnostics::Problems;
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::i18n::{Note, note};
use sagnac_bench::motion::TABLE_ANGLE;
use sagnac_bench::setup::{Bench, Demand, Device, Language, Link, Text, VALUE_PLACE};
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

/// Messages for a file of a bench that cannot be read at all.
const WORDING: Wording = Wording { unreadable: "bench_file.unreadable", folder: "bench_file.folder" };

/// Reads a file of a bench.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<Bench, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &WORDING)?, folder_of(path))
}

/// Reads a bench from the bytes of a file; `name` stands in diagnostics, files are named relative to `folder`.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8], folder: &Path) -> Result<Bench, Problems> {
    let build = |root: &Section, reader: &mut Reader<'_>| {
        let BenchTables { part_s, devices } = BenchTables::read(root);
        if root.entry("device").is_some() {
            as_a_whole(&devices, root, reader);
        }
        let devices = devices.into_iter().map(|keys| device(keys, folder, reader)).collect();
        Bench { part: seconds(part_s), devices }
    };
    let (bench, problems) = checked(&text_file::source(name, bytes)?, &BENCH_FILE, build);
    bench.ok_or(problems)
}

/// A length of time; zero for one that was refused.
fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

fn wrong(reader: &mut Reader<'_>, section: &Section, key: &str, message: Note) {
    let span = if section.entry(key).is_some() { section.span_of(key) } else { section.span.clone() };
    reader.error(&span, message, None);
}

/// What holds between devices: ids and quantities are there once, and one device is the unit.
fn as_a_whole(devices: &[DeviceKeys], root: &Section, reader: &mut Reader<'_>) {
    let (mut ids, mut quantities) = (BTreeSet::new(), BTreeSet::new());
    for device in devices {
        if !device.id.is_empty() && !ids.insert(device.id.as_str()) {
            wrong(reader, &device.section, "id", note!("bench_file.id_twice", id = device.id.as_str()));
        }
        for keys in &device.moves {
            let Some(quantity) = keys.quantity else { continue };
            if !quantities.insert(quantity) {
                wrong(reader, &keys.section, "quantity", note!("bench_file.quantity_twice", quantity));
            }
        }
    }
    let mut units = devices.iter().filter(|device| device.unit_under_test);
    match (units.next(), units.next()) {
        (Some(_), None) => {}
        (Some(_), Some(second)) => {
            wrong(reader, &second.section, "unit_under_test", note!("bench_file.two_units"));
        }
        (None, _) => reader.error(&root.span_of("device"), note!("bench_file.no_unit"), None),
    }
}

fn device(keys: DeviceKeys, folder: &Path, reader: &mut Reader<'_>) -> Device {
    keys_of_link(&keys, reader);
    keys_of_language(&keys, reader);
    let language = match keys.language {
        LanguageWord::Json => Language::Json,
        LanguageWord::Text => Language::Text(Text {
            columns: keys.columns.clone(),
            device_time: keys.device_time.clone(),
            poll: keys.poll.clone().unwrap_or_default(),
            period: seconds(keys.period_s),
            answer: keys.answer.clone(),
            safe: keys.safe.clone(),
        }),
    };
    let demands: Vec<Demand> = keys.moves.iter().filter_map(|one| demand(one, &keys, reader)).collect();
    let address = keys.address.unwrap_or_default();
    let link = match keys.link {
        LinkWord::Command => Link::Command { words: keys.command, folder: folder.to_owned() },
        LinkWord::Tcp => Link::Tcp(address),
        LinkWord::Udp => Link::Udp(address),
        LinkWord::File => Link::File(joined(folder, &keys.path.unwrap_or_default())),
    };
    Device {
        is_unit: keys.unit_under_test,
        link,
        heartbeat: seconds(keys.heartbeat_s),
        patience: seconds(keys.patience_s),
        clock_step: seconds(keys.clock_step_s),
        has_safe_state: !demands.is_empty() || !keys.safe.is_empty(),
        id: keys.id,
        language,
        demands,
    }
}

/// Each link has its own key, and none of the others.
fn keys_of_link(keys: &DeviceKeys, reader: &mut Reader<'_>) {
    let (word, needed) = match keys.link {
        LinkWord::Command => ("command", "command"),
        LinkWord::Tcp => ("tcp", "address"),
        LinkWord::Udp => ("udp", "address"),
        LinkWord::File => ("file", "path"),
    };
    let section = &keys.section;
    if section.entry(needed).is_none() || needed == "command" && keys.command.is_empty() {
        wrong(reader, section, "link", note!("bench_file.link_needs", link = word, key = needed));
    }
    for key in ["command", "address", "path"].into_iter().filter(|key| *key != needed) {
        if section.entry(key).is_some() {
            wrong(reader, section, key, note!("bench_file.not_of_link", link = word, key));
        }
    }
    for key in ["poll", "answer", "safe", "move"] {
        if keys.link == LinkWord::File && section.entry(key).is_some() {
            wrong(reader, section, key, note!("bench_file.not_of_link", link = word, key));
        }
    }
}

/// A device that speaks text is described here; one that speaks JSON describes itself.
fn keys_of_language(keys: &DeviceKeys, reader: &mut Reader<'_>) {
    let section = &keys.section;
    if keys.language == LanguageWord::Json {
        for key in ["columns", "device_time", "poll", "answer", "safe"] {
            if section.entry(key).is_some() {
                wrong(reader, section, key, note!("bench_file.of_text", key));
            }
        }
        return;
    }
    let is_named = |name: &String| !name.is_empty() && !name.contains([',', '"', '\n', '\r']);
    let names: Vec<&String> = keys.columns.iter().filter(|name| *name != "-").collect();
    let are_single = names.iter().collect::<BTreeSet<_>>().len() == names.len();
    if names.is_empty() || !are_single || !names.iter().all(|name| is_named(name)) {
        wrong(reader, section, "columns", note!("bench_file.columns"));
    }
    if let Some(time) = keys.device_time.as_ref().filter(|time| !keys.columns.contains(time)) {
        wrong(reader, section, "device_time", note!("bench_file.no_column", column = time.as_str()));
    }
    if keys.poll.is_some() && keys.period_s >= keys.heartbeat_s {
        wrong(reader, section, "period", note!("bench_file.heartbeat"));
    }
    if !keys.moves.is_empty() && keys.safe.is_empty() {
        wrong(reader, section, "id", note!("bench_file.no_safe", id = keys.id.as_str()));
    }
}

fn demand(keys: &MoveKeys, device: &DeviceKeys, reader: &mut Reader<'_>) -> Option<Demand> {
    let (quantity, section) = (keys.quantity?, &keys.section);
    let send = keys.send.clone().unwrap_or_default();
    let reads = keys.reads.clone().unwrap_or_else(|| quantity.to_owned());
    let is_text = device.language == LanguageWord::Text;
    if is_text && !send.contains(VALUE_PLACE) {
        wrong(reader, section, "send", note!("bench_file.no_value", place = VALUE_PLACE));
    }
    if !is_text && keys.send.is_some() {
        wrong(reader, section, "send", note!("bench_file.of_text", key = "send"));
    }
    if is_text && (!device.columns.contains(&reads) || device.device_time.as_ref() == Some(&reads)) {
        wrong(reader, section, "reads", note!("bench_file.no_column", column = reads.as_str()));
    }
    if section.entry("highest").is_some() && keys.lowest > keys.highest {
        wrong(reader, section, "highest", note!("bench_file.limits"));
    } else if keys.begin.is_some_and(|value| !(keys.lowest..=keys.highest).contains(&value)) {
        wrong(reader, section, "begin", note!("bench_file.begin"));
    }
    Some(Demand {
        quantity: quantity.to_owned(),
        send,
        reads,
        limits: [keys.lowest, keys.highest],
        tolerance: keys.tolerance,
        within: seconds(keys.within_s),
        fastest_per_h: keys.fastest_per_h,
        begin: keys.begin,
        is_angle: quantity == TABLE_ANGLE,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BENCH: &str = "format = \"bench/1\"\n[[device]]\nid = \"gyro\"\nunit_under_test = true\ncommand = [\"gyro\"]\n\
        [[device]]\nid = \"table\"\nlink = \"tcp\"\naddress = \"h:1\"\nlanguage = \"text\"\n\
        columns = [\"uptime\", \"table_rate_deg_s\"]\nsafe = [\"OFF\"]\n[[device.move]]\n\
        quantity = \"table_rate_deg_s\"\nsend = \"RATE {value}\"\nlowest = -10\nhighest = 10\ntolerance = 0.1\nwithin = \"20 s\"\n";

    fn read(text: &str) -> Result<Bench, Problems> {
        parse("b.toml", text.as_bytes(), Path::new("/bench"))
    }

    #[test]
    fn devices_are_read_with_their_defaults() {
        let bench = read(BENCH).unwrap_or_else(|e| panic!("{e}"));
        let [gyro, table] = bench.devices.as_slice() else { panic!("{bench:?}") };
        assert_eq!(bench.part, Duration::from_secs(60));
        assert!(gyro.is_unit && gyro.language == Language::Json && !gyro.has_safe_state);
        let words = vec!["gyro".to_owned()];
        assert_eq!(gyro.link, Link::Command { words, folder: "/bench".into() });
        assert!(table.has_safe_state && !table.is_unit);
        let [demand] = table.demands.as_slice() else { panic!("{table:?}") };
        assert_eq!((demand.reads.as_str(), demand.limits), ("table_rate_deg_s", [-10.0, 10.0]));
        assert_eq!((demand.within, demand.begin, demand.is_angle), (Duration::from_secs(20), None, false));
    }

    #[test]
    fn a_mistake_is_told_once_at_its_place() {
        for (from, to, line) in [
            ("unit_under_test = true", "unit_under_test = false", 2),
            ("columns", "unit_under_test = true\ncolumns", 11),
            ("\"table\"", "\"gyro\"", 7),
            ("command = [\"gyro\"]", "command = []", 2),
            ("command = [\"gyro\"]", "command = [\"gyro\"]\npath = \"a\"", 6),
            ("command = [\"gyro\"]", "command = [\"gyro\"]\npoll = \"a\"", 6),
            ("address = \"h:1\"\n", "", 8),
            ("\"uptime\", ", "", 0),
            ("\"uptime\", \"table_rate_deg_s\"", "\"a\"", 13),
            ("\"uptime\"", "\"table_rate_deg_s\"", 11),
            ("safe = [\"OFF\"]", "safe = []", 7),
            ("RATE {value}", "RATE", 15),
            ("highest = 10", "highest = -20", 17),
            ("highest = 10", "highest = 10\nbegin = 11", 18),
            ("tolerance = 0.1", "tolerance = 0", 18),
            ("within = \"20 s\"", "within = 20", 19),
            ("columns", "poll = \"?\"\nperiod = \"5 s\"\ncolumns", 12),
            (
                "\"uptime\", \"table_rate_deg_s\"]",
                "\"uptime\", \"table_rate_deg_s\"]\ndevice_time = \"t\"",
                12,
            ),
        ] {
            let text = BENCH.replacen(from, to, 1);
            assert_ne!(text, BENCH);
            let found = read(&text).map_or_else(|p| p.list.iter().map(|p| p.line).collect(), |_| vec![]);
            let expected: Vec<usize> = Some(line).filter(|line| *line > 0).into_iter().collect();
            assert_eq!(found, expected, "{to}: {:?}", read(&text).err().map(|p| p.to_string()));
        }
    }
}
