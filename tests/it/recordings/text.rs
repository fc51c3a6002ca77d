//! Decisions about a text file that its user makes, in a procedure and on the command line.

use crate::support::synthetic::white;
use assert_cmd::Command;
use sagnac::config::procedure::parse_procedure;
use sagnac::i18n::{Lang, Localize};
use sagnac::ingest::{Encoding, StampWriting};
use sagnac::recording::ColumnRef;
use tempfile::tempdir;

const PROCEDURE: &str = r#"format = "procedure/1"

[procedure]
id = "text"
title = "Text"
revision = "A"

[unit_under_test]
serial_required = false

[recording]
encoding = "windows-1251"
delimiter = ";"
decimal = "comma"
header_line = 2
first_line = 4
comment = "!"

[[channel]]
id = "time"
column = "Время"
date_column = "Дата"
stamp = "day_first"
role = "time"
unit = "s"

[[channel]]
id = "rate"
column = "Выход"
role = "rate"
unit = "град/ч"

[[measurand]]
id = "angle_random_walk"
"#;

#[test]
fn a_procedure_fixes_every_decision() {
    let read = parse_procedure("folder/p.toml", PROCEDURE.as_bytes()).unwrap().value.recording.read;
    assert_eq!(read.text.encoding, Some(Encoding::Windows1251));
    assert_eq!((read.text.delimiter, read.text.decimal), (Some(b';'), Some(b',')));
    assert_eq!((read.text.header_line, read.text.first_line), (Some(2), Some(4)));
    assert_eq!(read.text.comment.as_deref(), Some("!"));
    let [stamps] = read.text.stamps.as_slice() else { panic!("{:?}", read.text.stamps) };
    assert_eq!(stamps.writing, Some(StampWriting::DayFirst));
    assert_eq!(stamps.date_column, Some(ColumnRef::Name("Дата".into())));
    let binary =
        PROCEDURE.replace("comment = \"!\"", "part = \"/imu\"\nlayout = \"l.toml\"\nformat = \"csv\"");
    let read = parse_procedure("folder/p.toml", binary.as_bytes()).unwrap().value.recording.read;
    assert_eq!(read.layout.as_ref().map(|l| l.path.as_path()), Some(std::path::Path::new("folder/l.toml")));
    assert_eq!((read.part.as_deref(), read.format.as_deref()), (Some("/imu"), Some("csv")));
}

#[test]
fn wrong_decisions_are_pointed_at() {
    for (from, to, token, message) in [
        ("\"windows-1251\"", "\"cp1251\"", "cp1251", "is not a valid value of `encoding`"),
        ("delimiter = \";\"", "delimiter = \"colon\"", "colon", "is not a valid value of `delimiter`"),
        (
            "delimiter = \";\"",
            "delimiter = \"comma\"",
            "\"comma\"",
            "the comma cannot be both delimiter and decimal mark",
        ),
        ("header_line = 2", "header_line = 2.5", "2.5", "must be a whole number"),
        ("first_line = 4", "first_line = 2", "2", "is not below `header_line` 2"),
        ("comment = \"!\"", "format = \"docx\"", "docx", "is not a file format"),
        ("stamp = \"day_first\"", "week_column = 3", "3", "a date or a GPS week, not both"),
        ("column = \"Выход\"", "column = \"Выход\"\nstamp = \"clock\"", "\"clock\"", "has the role `rate`"),
    ] {
        let text = PROCEDURE.replacen(from, to, 1);
        let problems = parse_procedure("p.toml", text.as_bytes()).unwrap_err();
        let found = problems.list.iter().find(|p| p.message.say(Lang::En).contains(message));
        assert_eq!(found.map(|p| p.token.as_str()), Some(token), "{problems}");
    }
}

#[test]
fn a_run_reads_as_its_procedure_says() {
    let dir = tempdir().unwrap();
    let mut text = String::from("Протокол\nДата;Время;Выход\n!замечание\n");
    for i in 0..1000u64 {
        let stamp = format!("01.03.2026;{:02}:{:02}:{:02},5", i / 3600, i / 60 % 60, i % 60);
        text.push_str(&format!("{stamp};{}\n", format!("{:.5}", 0.1 * white(1, i)).replace('.', ",")));
    }
    let bytes: Vec<u8> = encode(&text);
    std::fs::write(dir.path().join("r.csv"), bytes).unwrap();
    std::fs::write(dir.path().join("p.toml"), PROCEDURE).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .current_dir(dir.path())
        .args(["run", "p.toml", "r.csv", "--out", "out"])
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let r = crate::support::result(&dir.path().join("out"));
    assert_eq!(r["recording"][0]["samples"], 1000);
    assert_eq!(r["recording"][0]["start"], "2026-03-01T00:00:00.500Z");
    assert_eq!(r["recording"][0]["sample_interval_s"], 1.0);
    assert_eq!(r["integrity"]["faults"].as_array().unwrap().len(), 0);
}

/// Windows-1251 of the letters and signs used here.
fn encode(text: &str) -> Vec<u8> {
    let byte = |c: char| match c {
        'А'..='я' => (c as u32 - 'А' as u32 + 0xc0) as u8,
        c => c as u8,
    };
    text.chars().map(byte).collect()
}

#[test]
fn options_of_the_command_line_decide_and_are_contradicted() {
    let dir = tempdir().unwrap();
    let rows: String = (0..2000u64).map(|i| format!("{i};{:.4}\n", white(2, i)).replace('.', ",")).collect();
    std::fs::write(dir.path().join("r.csv"), format!("t_s;rate_deg_h\n{rows}")).unwrap();
    let inspect = |options: &[&str]| {
        let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
            .current_dir(dir.path())
            .args([&["inspect", "r.csv"], options].concat())
            .output()
            .unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (done.status.code(), text(&done.stdout), text(&done.stderr))
    };
    let (code, out, err) =
        inspect(&["--delimiter", "semicolon", "--decimal", "comma", "--encoding", "utf-8"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("delimiter `;`, decimal mark `,`") && out.contains("it was stated"), "{out}");
    for (options, said) in [
        (&["--decimal", "point"][..], "the numbers have `,`"),
        (&["--delimiter", "tab"], "the lines are delimited by `;`"),
        (&["--input-format", "parquet"], "the file does not match it"),
        (&["--input-format", "docx"], "known formats: "),
        (&["--header-line", "0"], ""),
        (&["--encoding", "utf-16le"], "it looks like UTF-8"),
    ] {
        let (code, out, err) = inspect(options);
        if said.is_empty() {
            assert!(code == Some(0) && out.contains("column_1"), "{out}{err}");
        } else {
            assert!(code == Some(2) && err.contains(said) && err.lines().count() == 1, "{options:?}: {err}");
        }
    }
}
