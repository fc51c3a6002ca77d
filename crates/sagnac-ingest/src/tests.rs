use super::*;
use crate::english::english;
use sagnac_core::recording::ColumnRef;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use tempfile::{NamedTempFile, TempDir};

fn file(bytes: &[u8]) -> NamedTempFile {
    let mut f = NamedTempFile::new().unwrap();
    f.write_all(bytes).unwrap();
    f.flush().unwrap();
    f
}

/// Columns, faults and facts of a whole file.
type Whole = (Vec<Vec<f64>>, Vec<FieldFault>, FileFacts);

fn read(path: &Path, wanted: &[usize]) -> Result<Whole, IngestError> {
    let source = open(path)?;
    let mut columns = vec![Vec::new(); wanted.len()];
    let mut faults = Vec::new();
    let facts = source.read(wanted, &mut |block| {
        assert_eq!(block.first_row as usize, columns[0].len() + 1);
        for (all, part) in columns.iter_mut().zip(&block.columns) {
            all.extend_from_slice(part);
        }
        faults.extend_from_slice(&block.faults);
        ControlFlow::Continue(())
    })?;
    Ok((columns, faults, facts.unwrap()))
}

fn text(content: &str, wanted: &[usize]) -> Whole {
    read(file(content.as_bytes()).path(), wanted).unwrap()
}

/// The error of opening a content or reading its first column.
fn refused(content: &[u8]) -> IngestError {
    read(file(content).path(), &[0]).unwrap_err()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    e.write_all(bytes).unwrap();
    e.finish().unwrap()
}

/// A table that spans several chunks, with lines of different length and a bad field here and there.
fn long_table() -> (String, usize) {
    let mut s = String::from("time_s,rate,word,temp\n");
    let rows = 120_000;
    for i in 0..rows {
        let rate = if i % 40_000 == 17 { "oops".to_owned() } else { format!("{}", f64::from(i).sin() * 1e3) };
        s.push_str(&format!("{}.{:03},{rate},w{i},{}\n", i / 1000, i % 1000, i % 7));
    }
    (s, rows as usize)
}

#[test]
fn every_dialect_gives_the_same_numbers() {
    let expected = vec![vec![0.0, 1.0, 2.0], vec![1.5, -2.5, 1000.0]];
    for content in [
        "t,r\n0,1.5\n1,-2.5\n2,1e3\n",
        "\u{feff}t,r\r\n0,1.5\r\n1,-2.5\r\n2,1e3\r\n",
        "# a comment\n# another\n\nt,r\n0,1.5\n1,-2.5\n2,1e3",
        "t;r\n0;1.5\n1;-2.5\n2;1e3\n",
        "t;r\n0;1,5\n1;-2,5\n2;1e3\n",
        "t\tr\n0\t1.5\n1\t-2.5\n2\t1e3\n",
        "\"t\",\"r\"\n\"0\",\"1.5\"\n 1 , -2.5 \n+2,+1000\n",
        "0,1.5\n1,-2.5\n2,1e3\n",
        "t,r,\n0,1.5,\n1,-2.5,\n2,1e3,\n",
    ] {
        let (columns, faults, facts) = text(content, &[0, 1]);
        assert_eq!(columns, expected, "{content:?}");
        assert_eq!((faults.len(), facts.rows), (0, 3), "{content:?}");
    }
}

#[test]
fn names_are_found_and_wrong_ones_get_a_hint() {
    let f = file(b"time_s,rate,rate\n0,1,2\n");
    let source = open(f.path()).unwrap();
    let name = |n: &str| source.resolve(&ColumnRef::Name(n.to_owned()));
    assert_eq!(name("time_s").unwrap(), 0);
    assert!(english(&name("tme_s").unwrap_err().note()).contains("did you mean `time_s`"));
    assert!(english(&name("voltage").unwrap_err().note()).contains("the file has: time_s, rate, rate"));
    let twice = name("rate").unwrap_err();
    assert_eq!(twice.kind(), IngestErrorKind::Column);
    assert!(english(&twice.note()).contains("is used by 2 columns (2, 3)"), "{twice}");
    assert_eq!(source.resolve(&ColumnRef::Position(3)).unwrap(), 2);
    for p in [0, 4] {
        assert!(
            english(&source.resolve(&ColumnRef::Position(p)).unwrap_err().note()).contains("columns 1 to 3")
        );
    }
    let bare = file(b"0,1\n1,2\n");
    let names: Vec<String> = open(bare.path()).unwrap().columns().iter().map(|c| c.name.clone()).collect();
    assert_eq!(names, ["column_1", "column_2"]);
}

#[test]
fn unreadable_files_are_refused_with_their_reason() {
    use IngestErrorKind::*;
    let dir = TempDir::new().unwrap();
    assert!(english(&open(dir.path()).err().unwrap().note()).contains("is a folder"));
    assert_eq!(open(&dir.path().join("none.csv")).err().unwrap().kind(), Io);
    let long_line = vec![b'1'; 3 << 20];
    for (content, kind, says) in [
        (&b""[..], Empty, "the file is empty"),
        (b"t,r\n", Empty, "a header but no rows"),
        (b"# only\n# comments\n", Empty, "only comments"),
        (b"PK\x03\x04abc", UnknownFormat, "a zip archive"),
        #[cfg(feature = "hdf5")]
        (b"\x89HDF\r\n\x1a\n", Damaged, "the HDF5 file cannot be decoded"),
        (b"\xff\xfet\0,\0r\0", Empty, "a header but no rows"),
        (b"abc\0def\0\x01", UnknownFormat, "neither text nor a supported binary format"),
        #[cfg(feature = "parquet")]
        (b"PAR1 but no more", Damaged, "cannot be decoded"),
        (b"rate\n0,5\n1,5\n", UnknownFormat, "the comma appears to be both delimiter and decimal mark"),
        (&gzip(b""), Empty, "the compressed file is empty"),
        (&long_line, UnknownFormat, "does not end"),
        (b"\x1f\x8b\x08\x00garbage that is no gzip", Damaged, "damaged"),
        (b"\x28\xb5\x2f\xfdgarbage", Damaged, "damaged"),
    ] {
        let e = refused(content);
        assert_eq!(e.kind(), kind, "{e}");
        assert!(english(&e.note()).contains(says), "{e}");
    }
}

#[test]
fn a_cut_packed_file_is_refused() {
    let (content, _) = long_table();
    let packed = gzip(content.as_bytes());
    for keep in [packed.len() - 4, packed.len() / 2, 40] {
        let e = refused(&packed[..keep]);
        assert_eq!(e.kind(), IngestErrorKind::Damaged, "{e}");
    }
    let zst = zstd::stream::encode_all(content.as_bytes(), 1).unwrap();
    assert_eq!(refused(&zst[..zst.len() / 2]).kind(), IngestErrorKind::Damaged);
}

#[test]
fn a_bomb_is_refused() {
    let mut line = String::from("t,r\n");
    line.push_str(&"1,2\n".repeat(10 << 20));
    let packed = zstd::stream::encode_all(line.as_bytes(), 1).unwrap();
    assert!(packed.len() < 100_000);
    let e = refused(&packed);
    assert_eq!(e.kind(), IngestErrorKind::Bomb, "{e}");
}

#[test]
fn packing_and_chunks_change_nothing() {
    let (content, rows) = long_table();
    let plain = file(content.as_bytes());
    let (columns, faults, facts) = read(plain.path(), &[3, 0, 1]).unwrap();
    assert_eq!((facts.rows, facts.bytes), (rows as u64, content.len() as u64));
    for (i, line) in content.lines().skip(1).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(columns[0][i], cells[3].parse::<f64>().unwrap());
        assert_eq!(columns[1][i], cells[0].parse::<f64>().unwrap());
        match cells[1].parse::<f64>() {
            Ok(v) => assert_eq!(columns[2][i], v),
            Err(_) => assert!(columns[2][i].is_nan()),
        }
    }
    let places: Vec<(u64, u64, u64, usize)> =
        faults.iter().map(|f| (f.row, f.line, f.character, f.slot)).collect();
    assert_eq!(places, [(18, 19, 7, 2), (40_018, 40_019, 8, 2), (80_018, 80_019, 8, 2)]);
    let zst = zstd::stream::encode_all(content.as_bytes(), 1).unwrap();
    for packed in [gzip(content.as_bytes()), zst] {
        let f = file(&packed);
        let (other, other_faults, other_facts) = read(f.path(), &[3, 0, 1]).unwrap();
        assert_eq!(faults, other_faults);
        for (a, b) in columns.iter().zip(&other) {
            assert!(a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        assert_eq!(other_facts.bytes, packed.len() as u64);
        assert_ne!(other_facts.sha256, facts.sha256);
    }
}

#[test]
fn the_hash_is_that_of_the_file() {
    let (.., facts) = text("t,r\n0,1\n", &[0]);
    // sha256sum of these bytes.
    assert_eq!(facts.sha256, "d6b959a27d19998f8229e8e1b86161d9fa4a000529d508e035a5287c3e3ef022");
}

#[test]
fn bad_fields_are_counted_and_a_column_of_words_is_refused() {
    let mut content = String::from("t,r,section\n");
    for i in 0..200 {
        let bad = ["abc", "#N/A", "", "nan", "inf"].get(i % 20).copied();
        content.push_str(&format!("{i},{},word\n", bad.map_or(i.to_string(), str::to_owned)));
    }
    let (columns, faults, _) = text(&content, &[0, 1]);
    assert_eq!(columns[1].iter().filter(|v| v.is_nan()).count(), 50);
    let unparsable = faults.iter().filter(|f| f.kind == FieldFaultKind::Unparsable).count();
    assert_eq!((unparsable, faults.len()), (20, 50));
    let f = file(content.as_bytes());
    let e = read(f.path(), &[0, 2]).unwrap_err();
    assert_eq!((e.kind(), e.line(), e.column()), (IngestErrorKind::NotNumeric, Some(2), Some(7)));
    assert!(english(&e.note()).contains("`section`") && e.text() == Some("word"), "{e}");
    // Half of the rows cut short.
    let mut ragged = String::from("t,r\n");
    (0..5000).for_each(|i| ragged.push_str(if i % 3 == 0 { "1,2\n" } else { "1\n" }));
    assert_eq!(refused(ragged.as_bytes()).line(), Some(3));
}

#[test]
fn a_column_may_be_wanted_twice() {
    let (columns, faults, _) = text("t,r\n0,1\n1,x\n2,3\n", &[1, 0, 1]);
    assert_eq!(columns[1], [0.0, 1.0, 2.0]);
    assert!(columns[0][1].is_nan() && columns[2][1].is_nan() && columns[2][2] == 3.0);
    assert_eq!(faults.iter().map(|f| f.slot).collect::<Vec<_>>(), [0, 2]);
}

#[test]
fn reading_can_be_stopped() {
    let (content, _) = long_table();
    let f = file(content.as_bytes());
    let source = open(f.path()).unwrap();
    let mut blocks = 0;
    let facts = source.read(&[0], &mut |_| {
        blocks += 1;
        ControlFlow::Break(())
    });
    assert_eq!((facts.unwrap(), blocks), (None, 1));
}

#[test]
fn a_file_that_changes_is_refused() {
    let (content, _) = long_table();
    for growing in [true, false] {
        let mut f = file(content.as_bytes());
        let source = open(f.path()).unwrap();
        if growing {
            f.write_all(b"120.000,1,w,2\n").unwrap();
        } else {
            f.as_file().set_len(content.len() as u64 / 2).unwrap();
        }
        let e = source.read(&[0], &mut |_| ControlFlow::Continue(())).unwrap_err();
        assert_eq!(e.kind(), IngestErrorKind::Changed, "{e}");
    }
    let sizes = |open, read, now| byte_stream::unchanged(Path::new("x"), open, read, now).is_ok();
    assert!(sizes(5, 5, 5) && !sizes(5, 6, 6) && !sizes(5, 5, 6) && !sizes(5, 4, 5));
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(300))]
    #[test]
    fn no_content_makes_it_panic(bytes: Vec<u8>, lines in "([0-9a,;.\"\t \n#-]{0,20}\n){0,20}") {
        for content in [bytes.as_slice(), lines.as_bytes()] {
            let f = file(content);
            if let Ok(source) = open(f.path()) {
                let all: Vec<usize> = (0..source.columns().len()).collect();
                let _ = source.read(&all, &mut |block| {
                    assert!(block.columns.iter().all(|c| c.len() == block.rows()));
                    ControlFlow::Continue(())
                });
            }
        }
    }
}
