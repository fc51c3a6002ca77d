//! Small files written by hand, and what is in them by hand.

use crate::english::english;
use crate::{Column, Encoding, ReadOptions, Source, StampOptions, StampWriting, TextOptions, open_with};
use sagnac_core::recording::{ColumnRef, Role};
use std::io::Write;
use std::ops::ControlFlow;
use tempfile::NamedTempFile;

const NO: f64 = f64::NAN;

fn file(bytes: &[u8]) -> NamedTempFile {
    let mut f = NamedTempFile::new().unwrap();
    f.write_all(bytes).unwrap();
    f.flush().unwrap();
    f
}

/// The source of a content and all its numbers, by column.
fn read(bytes: &[u8], text: TextOptions) -> Result<(Source, Vec<Vec<f64>>, u64), String> {
    let f = file(bytes);
    let options = ReadOptions { text, ..ReadOptions::default() };
    let source = open_with(f.path(), &options).map_err(|e| english(&e.note()))?;
    let all: Vec<usize> = (0..source.columns().len()).collect();
    let mut columns = vec![Vec::new(); all.len()];
    let mut unparsable = 0;
    for &i in &all {
        // One column alone and all together give the same.
        let mut single = Vec::new();
        let facts = source.read(&[i], &mut |block| {
            single.extend_from_slice(&block.columns[0]);
            unparsable += block.unparsable[0];
            ControlFlow::Continue(())
        });
        if facts.is_ok() {
            columns[i] = single;
        }
    }
    let numbers: Vec<usize> = all.into_iter().filter(|&i| !columns[i].is_empty()).collect();
    let mut together = vec![Vec::new(); numbers.len()];
    source
        .read(&numbers, &mut |block| {
            for (whole, part) in together.iter_mut().zip(&block.columns) {
                whole.extend_from_slice(part);
            }
            ControlFlow::Continue(())
        })
        .map_err(|e| english(&e.note()))?;
    for (whole, &i) in together.iter().zip(&numbers) {
        assert!(whole.iter().zip(&columns[i]).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan()));
    }
    Ok((source, columns, unparsable))
}

fn described(columns: &[Column]) -> String {
    let one = |c: &Column| match &c.unit {
        Some(unit) => format!("{} {{{unit}}}", c.name),
        None => c.name.clone(),
    };
    columns.iter().map(one).collect::<Vec<_>>().join(" | ")
}

#[path = "cases_table.rs"]
mod table;

use table::{CASES, MARCH};

#[test]
fn files_written_by_hand_give_what_stands_in_them() {
    assert!(CASES.len() >= 60, "{}", CASES.len());
    for (content, columns, rows) in CASES {
        let (source, read, _) =
            read(content.as_bytes(), TextOptions::default()).unwrap_or_else(|e| panic!("{content:?}: {e}"));
        assert_eq!(described(source.columns()), *columns, "{content:?}");
        for (c, values) in read.iter().enumerate() {
            // A column of words cannot be read; it is expected to have no number.
            for (r, row) in rows.iter().enumerate() {
                let found = values.get(r).copied().unwrap_or(NO);
                let same = found == row[c] || (found.is_nan() && row[c].is_nan());
                assert!(same, "{content:?}: row {r} column {c}: {found} instead of {}", row[c]);
            }
        }
    }
}

/// A text in Windows-1251, where it has every character.
fn windows_1251(text: &str) -> Option<Vec<u8>> {
    let byte = |c: char| match c {
        '\0'..='\x7f' => u8::try_from(c).ok(),
        'А'..='я' => u8::try_from(u32::from(c) - u32::from('А') + 0xc0).ok(),
        'Ё' => Some(0xa8),
        'ё' => Some(0xb8),
        '№' => Some(0xb9),
        '\u{a0}' | '§' | '©' | '«' | '¬' | '®' | '°' | '±' | 'µ' | '¶' | '·' | '»' => {
            u8::try_from(c).ok()
        }
        _ => None,
    };
    text.chars().map(byte).collect()
}

#[test]
fn every_case_reads_the_same_in_every_encoding() {
    for (content, columns, _) in CASES {
        let (_, plain, _) = read(content.as_bytes(), TextOptions::default()).unwrap();
        let le: Vec<u8> = content.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let be: Vec<u8> = content.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let marked = |mark: &[u8], bytes: &[u8]| [mark, bytes].concat();
        let cyrillic = windows_1251(content);
        let mut contents = vec![
            marked(b"\xef\xbb\xbf", content.as_bytes()),
            marked(b"\xff\xfe", &le),
            marked(b"\xfe\xff", &be),
            content.replace('\n', "\r\n").into_bytes(),
        ];
        contents.extend(cyrillic);
        if content.is_ascii() {
            contents.extend([le, be]);
        }
        for (i, bytes) in contents.iter().enumerate() {
            let (source, other, _) =
                read(bytes, TextOptions::default()).unwrap_or_else(|e| panic!("{i} {content:?}: {e}"));
            assert_eq!(described(source.columns()), *columns, "{i} {content:?}");
            let bits = |all: &[Vec<f64>]| -> Vec<Vec<u64>> {
                all.iter().map(|c| c.iter().map(|v| v.to_bits()).collect()).collect()
            };
            assert_eq!(bits(&plain), bits(&other), "{i} {content:?}");
        }
    }
}

#[test]
fn dates_tell_their_epoch_and_clocks_their_period() {
    let column = |content: &str, i: usize| {
        let (source, ..) = read(content.as_bytes(), TextOptions::default()).unwrap();
        (source.columns()[i].epoch_s, source.columns()[i].rollover_s, source.time_column())
    };
    assert_eq!(
        column("time,r\n2026-03-01T10:00:00Z,1\n2026-03-01T10:00:01Z,2\n", 0),
        (Some(MARCH), None, Some(0))
    );
    assert_eq!(
        column("r,time\n1,01.03.2026 10:00:00\n2,01.03.2026 10:00:01\n", 1),
        (Some(MARCH), None, Some(1))
    );
    assert_eq!(column("time,r\n10:00:00,1\n10:00:01,2\n", 0), (None, Some(86_400.0), Some(0)));
    let two = "date,time,r\n2026-03-01,10:00:00,1\n2026-03-01,10:00:01,2\n";
    assert_eq!(column(two, 3), (Some(MARCH), None, Some(3)));
    // Week 2408 of GPS time began on 2026-03-01: 315964800 + 2408 * 604800 = MARCH.
    assert_eq!(column("week,tow,r\n2408,1.5,1\n2408,2.5,2\n", 3), (Some(MARCH), None, Some(3)));
    assert_eq!(column("tow,r\n1.5,1\n2.5,2\n", 0), (None, Some(604_800.0), Some(0)));
    let (source, ..) = read(b"\xb9;r\n1;1,5\n2;2,5\n", TextOptions::default()).unwrap();
    assert_eq!(source.columns()[0].inferred().role, Role::Counter);
}

#[test]
fn metadata_are_kept_as_written() {
    let content = "# Serial: SN-0042\n# rate = 10 Hz\n% a remark\nt,r\n0,1\n1,2\n";
    let (source, ..) = read(content.as_bytes(), TextOptions::default()).unwrap();
    let expected = [("Serial", "SN-0042"), ("rate", "10 Hz"), ("title", "a remark")];
    assert_eq!(source.metadata(), expected.map(|(k, v)| (k.to_owned(), v.to_owned())));
    assert_eq!(source.stated_serials(), ["SN-0042"]);
    let (source, ..) = read("Зав. №;0042\nt;r\n0;1,5\n1;2,5\n".as_bytes(), TextOptions::default()).unwrap();
    assert_eq!(source.stated_serials(), ["0042"]);
    let many: String = (0..100).map(|i| format!("# key{i}: {}\n", "v".repeat(1000))).collect();
    let (source, ..) = read(format!("{many}t,r\n0,1\n1,2\n").as_bytes(), TextOptions::default()).unwrap();
    assert_eq!((source.metadata().len(), source.metadata()[0].1.len()), (64, 200));
}

#[test]
fn what_cannot_be_read_surely_is_refused_with_its_place() {
    for (content, fragments) in [
        ("rate\n0,5\n1,5\n", &[":2:", "the comma appears to be both", "`0,5`"][..]),
        ("t,r\n0,1,5\n1,2,5\n", &[":2:", "the comma appears to be both", "`0,1,5`"]),
        ("t,r\n0,1,5.5\n1,2,5.5\n", &[":2:", "names 2 columns, but this row has 3 fields"]),
        ("0,05\n1,25\n", &[":1:", "the comma appears to be both"]),
        ("t;r\n0;1 234,5\n1;2 345,5\n", &[":2:", "thousands separators", "`1 234,5`"]),
        ("t;r\n0;1\u{a0}234,5\n1;2\u{a0}345,5\n", &[":2:", "thousands separators"]),
        ("t;r\n0;1'234.5\n1;2'345.5\n", &[":2:", "thousands separators"]),
        ("t;r\n0;1.234,5\n1;2.345,5\n", &[":2:", "thousands separators"]),
        ("t;r\n0;999\n1;1,234\n", &[":3:", "thousands separators", "`1,234`"]),
        ("\"t\",\"r\"\n\"0\",\"1,234\"\n\"1\",\"2,345\"\n", &[":2:", "thousands separators"]),
        ("t,r,u\n0,1.5\n1,2.5\n", &[":2:", "names 3 columns, but this row has 2 fields"]),
    ] {
        let Err(message) = read(content.as_bytes(), TextOptions::default()) else {
            panic!("{content:?} is read")
        };
        for fragment in fragments {
            assert!(message.contains(fragment), "{content:?}: no `{fragment}` in {message}");
        }
    }
}

fn stated(change: impl FnOnce(&mut TextOptions)) -> TextOptions {
    let mut options = TextOptions::default();
    change(&mut options);
    options
}

#[test]
fn what_a_user_states_is_followed_or_contradicted() {
    let followed: [(&str, TextOptions, &str, f64); 9] = [
        ("t;r\n0;999\n1;1,234\n", stated(|o| o.decimal = Some(b',')), "t | r", 1.234),
        ("1,5\n2,5\n", stated(|o| o.decimal = Some(b',')), "column_1", 2.5),
        ("rate\n0,5\n1,5\n", stated(|o| o.delimiter = Some(b',')), "column_1 | column_2", 5.0),
        ("a b\nx,y\nt,r\n0,1\n1,2\n", stated(|o| o.header_line = Some(3)), "t | r", 2.0),
        ("1,2\n3,4\n5,6\n", stated(|o| o.header_line = Some(1)), "1 | 2", 6.0),
        ("7,8\n3,4\n5,6\n", stated(|o| o.header_line = Some(0)), "column_1 | column_2", 6.0),
        ("t,r\n0,1\n9,9\n5,6\n", stated(|o| o.first_line = Some(3)), "t | r", 6.0),
        ("t,r\nREM 1,1\n5,6\n7,8\n", stated(|o| o.comment = Some("REM".into())), "t | r", 8.0),
        ("t,r\n0,1.5\n1,2.5\n", stated(|o| o.encoding = Some(Encoding::Windows1251)), "t | r", 2.5),
    ];
    for (content, options, columns, last) in followed {
        let (source, read, _) =
            read(content.as_bytes(), options).unwrap_or_else(|e| panic!("{content:?}: {e}"));
        assert_eq!(described(source.columns()), columns, "{content:?}");
        assert_eq!(read.last().and_then(|c| c.last()), Some(&last), "{content:?}");
    }
    let stamps = |column: &str, writing| StampOptions {
        column: ColumnRef::Name(column.into()),
        writing: Some(writing),
        date_column: None,
        week_column: None,
    };
    for (bytes, options, fragment) in [
        (&b"t;r\n0;1,5\n1;2,5\n"[..], stated(|o| o.delimiter = Some(b'|')), "the lines are delimited by `;`"),
        (b"t;r\n0;1,5\n1;2,5\n", stated(|o| o.decimal = Some(b'.')), "the numbers have `,`"),
        (b"t,r\n0,1.5\n1,2.5\n", stated(|o| o.encoding = Some(Encoding::Utf16Le)), "it looks like UTF-8"),
        (
            b"\xff\xfet\0\n\x001\0\n\0",
            stated(|o| o.encoding = Some(Encoding::Utf8)),
            "it looks like UTF-16LE",
        ),
        (b"t,r\n0,1.5\n1,2.5\n", stated(|o| o.header_line = Some(40)), "there is no such line"),
        (
            b"t,r\n0,1.5\n1,2.5\n",
            stated(|o| o.stamps = vec![stamps("t", StampWriting::Clock)]),
            "matches the given timestamp format",
        ),
    ] {
        let Err(message) = read(bytes, options) else { panic!("{bytes:?} is read") };
        assert!(message.contains(fragment), "no `{fragment}` in {message}");
    }
}

#[test]
fn stated_stamps_settle_what_the_file_leaves_open() {
    let of = |column: &str, writing, date: Option<&str>| StampOptions {
        column: ColumnRef::Name(column.into()),
        writing: Some(writing),
        date_column: date.map(|d| ColumnRef::Name(d.into())),
        week_column: None,
    };
    let american = b"time,r\n03/01/2026 00:00:01,1\n03/01/2026 00:00:02,2\n";
    let open = read(american, TextOptions::default()).unwrap();
    assert_eq!(open.0.columns()[0].epoch_s, None);
    let options = stated(|o| o.stamps = vec![of("time", StampWriting::MonthFirst, None)]);
    let (source, columns, _) = read(american, options).unwrap();
    assert_eq!((source.columns()[0].epoch_s, columns[0].as_slice()), (Some(MARCH), &[1.0, 2.0][..]));
    let apart = b"d,x,c,r\n01/03/2026,0,00:00:01,1\n01/03/2026,0,00:00:02,2\n";
    let options = stated(|o| o.stamps = vec![of("c", StampWriting::DayFirst, Some("d"))]);
    let (source, columns, _) = read(apart, options).unwrap();
    assert_eq!(source.columns()[4].name, "d+c");
    assert_eq!((source.columns()[4].epoch_s, columns[4].as_slice()), (Some(MARCH), &[1.0, 2.0][..]));
}

#[test]
fn damaged_characters_are_located() {
    // A lone byte in a number of a UTF-8 file, and half a pair in UTF-16.
    let (_, columns, bad) = read(b"t,r \xc2\xb0\n0,1\n1,2\xff3\n2,4\n3,5\n", TextOptions::default()).unwrap();
    assert!(columns[1][1].is_nan() && columns[1][2] == 4.0 && bad == 1);
    let mut units: Vec<u16> = "t,r\n0,1\n1,25\n2,4\n3,5\n".encode_utf16().collect();
    let at = units.iter().position(|u| *u == u16::from(b'5')).unwrap();
    units[at] = 0xd800;
    let bytes: Vec<u8> = [0xff, 0xfe].into_iter().chain(units.iter().flat_map(|u| u.to_le_bytes())).collect();
    let (_, columns, bad) = read(&bytes, TextOptions::default()).unwrap();
    assert!(columns[1][1].is_nan() && columns[1][2] == 4.0 && bad == 1, "{columns:?}");
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(40))]
    #[test]
    fn the_same_numbers_come_back_from_every_dialect(
        rows in proptest::collection::vec((-1e6f64..1e6, -1e-3f64..1e-3, -100i32..100), 2..40)
    ) {
        let name = |i: usize| ["Скорость, град/ч", "u", "k"][i];
        for (separator, comma) in [(",", false), (";", false), (";", true), ("\t", true), ("|", true), (" ", false), ("   ", true)] {
            let header = if separator.starts_with(' ') { "a b k".to_owned() } else {
                let quoted = |n: &str| if n.contains(separator) { format!("\"{n}\"") } else { n.to_owned() };
                (0..3).map(|i| quoted(name(i))).collect::<Vec<_>>().join(separator)
            };
            let mut text = format!("# serial: 7\n{header}\n");
            for (a, b, k) in &rows {
                // A fraction in every row, so that the decimal sign is never open.
                let line = [format!("{a:?}"), format!("{b:?}"), format!("{k}.5")].join("\u{1}");
                let line = if comma { line.replace('.', ",") } else { line };
                text.push_str(&line.replace('\u{1}', separator));
                text.push('\n');
            }
            let cyrillic = windows_1251(&text).unwrap();
            let wide: Vec<u8> =
                [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
            for bytes in [text.clone().into_bytes(), cyrillic, wide] {
                let (_, columns, bad) = read(&bytes, TextOptions::default()).unwrap();
                proptest::prop_assert_eq!(bad, 0, "{}", text);
                for (r, (a, b, k)) in rows.iter().enumerate() {
                    let whole = f64::from(*k).abs() + 0.5;
                    let k = if *k < 0 { -whole } else { whole };
                    for (found, written) in [(columns[0][r], a), (columns[1][r], b), (columns[2][r], &k)] {
                        proptest::prop_assert_eq!(found.to_bits(), written.to_bits(), "{}", text);
                    }
                }
            }
        }
    }

    #[test]
    fn no_content_panics_under_any_option(
        lines in "([0-9a-zЯ,;.|\"\t #:/T+-]{0,24}\n){0,12}",
        header in proptest::option::of(0u64..6), first in proptest::option::of(1u64..6),
        delimiter in proptest::option::of(proptest::sample::select(vec![b',', b';', b' ', b'\t', b'x'])),
        decimal in proptest::option::of(proptest::sample::select(vec![b',', b'.'])),
    ) {
        let options = stated(|o| {
            o.header_line = header;
            o.first_line = first;
            o.delimiter = delimiter;
            o.decimal = decimal;
        });
        let _ = read(lines.as_bytes(), options);
    }
}
