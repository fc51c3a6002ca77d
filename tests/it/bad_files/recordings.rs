//! Broken and odd recordings: each is refused with its reason and place, or read with its faults located, or read as
//! if nothing were the matter. What is expected was written by hand.
//!
//! The recordings are made here from one sound recording of 1000 samples at 1 Hz. Its sample i stands in row i + 1 and
//! in line i + 2.

use crate::support::synthetic::{HEADER, recording, white, with};
use crate::support::{analysed, both, result};
use serde_json::Value;
use std::io::Write;
use tempfile::tempdir;

const ROWS: u64 = 1000;

/// The recording is refused by both verbs, with the fragments in the message.
fn refused(name: &str, bytes: &[u8], fragments: &[&str]) {
    refused_with(name, bytes, fragments, 1);
}

/// As [`refused`], where the procedure misses several columns: each is an error of its own.
fn refused_with(name: &str, bytes: &[u8], fragments: &[&str], errors_of_run: usize) {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join(name), bytes).unwrap();
    let (analysed, run) = both(dir.path(), name);
    for (said, errors) in [(analysed, 1), (run, errors_of_run)] {
        assert_eq!(said.code, 2, "{name}: {said:?}");
        assert_eq!(said.err.matches("error: ").count(), errors, "{name}: {}", said.err);
        for fragment in [&[name], fragments].concat() {
            assert!(said.err.contains(fragment), "{name}: no `{fragment}` in\n{}", said.err);
        }
    }
}

/// The recording is read; its faults are these and no others: kind, row, count.
fn faulty(name: &str, text: &str, expected: &[(&str, u64, u64)]) -> Value {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join(name), text).unwrap();
    let (analysed, run) = both(dir.path(), name);
    assert_eq!((analysed.code, run.code), (0, 3), "{name}: {analysed:?} {run:?}");
    let analysis = result(&dir.path().join("a"));
    for r in [&analysis, &result(&dir.path().join("r"))] {
        let found: Vec<(&str, u64, u64)> = r["integrity"]["faults"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|f| f["channel"] != "temp" && f["channel"] != "temp_degC")
            .map(|f| (f["kind"].as_str().unwrap(), f["row"].as_u64().unwrap(), f["count"].as_u64().unwrap()))
            .collect();
        assert_eq!(found, expected, "{name}");
    }
    analysis
}

/// The recording with some rows in another form.
fn changed(change: impl Fn(u64, String) -> Option<String>) -> String {
    with(ROWS, |i, row| change(i + 1, row.clone()).unwrap_or(row))
}

/// The recording with the rate of one row in another form.
fn rate(row: u64, text: &str) -> String {
    changed(|r, _| (r == row).then(|| format!("{},{text},20.000", row - 1)))
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    e.write_all(bytes).unwrap();
    e.finish().unwrap()
}

fn zst(bytes: &[u8]) -> Vec<u8> {
    zstd::encode_all(bytes, 3).unwrap()
}

#[test]
fn what_is_no_recording_is_refused_by_its_content() {
    let zip = b"PK\x03\x04\x14\x00\x06\x00\x08\x00\x00\x00!\x00[Content_Types].xml";
    let png = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\x00\x00\x10\x00\x00\x00\x10\x08\x06\x00\x00\x00";
    let binary: Vec<u8> = (0..4096u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    refused("zip.csv", zip, &["a zip archive or a spreadsheet", "export the sheet as CSV"]);
    refused("png.csv", png, &["neither text nor a supported binary format"]);
    refused("binary.csv", &binary, &["neither text nor a supported binary format"]);
    refused("nul.csv", rate(500, "12.5\u{0}").as_bytes(), &["neither text nor a supported binary format"]);
    refused("empty.csv", b"", &["the file is empty"]);
    refused("blank.csv", b"\n\n  \n", &["no rows"]);
    refused("header.csv", format!("{HEADER}\n").as_bytes(), &["no rows"]);
    refused("header-cut.csv", HEADER.as_bytes(), &["no rows"]);
    let dir = tempdir().unwrap();
    std::fs::create_dir(dir.path().join("folder.csv")).unwrap();
    let (analysed, run) = both(dir.path(), "folder.csv");
    for said in [analysed, run] {
        assert_eq!(said.code, 2);
        assert!(said.err.contains("folder.csv: is a folder, not a recording"), "{}", said.err);
    }
}

#[test]
fn a_recording_reads_the_same_in_every_encoding_and_dialect() {
    let text = recording(ROWS);
    let dir = tempdir().unwrap();
    let wide = |marked: &str| -> Vec<u8> { marked.encode_utf16().flat_map(u16::to_le_bytes).collect() };
    let semicolons = text.replace(',', ";").replace('.', ",");
    let n = |bytes: &[u8]| {
        std::fs::write(dir.path().join("r.csv"), bytes).unwrap();
        let said = analysed(dir.path(), "r.csv");
        assert_eq!(said.code, 0, "{said:?}");
        let r = result(&dir.path().join("a"));
        assert_eq!(r["integrity"]["faults"].as_array().unwrap().len(), 0);
        crate::support::measurand(&r, "angle_random_walk")["value"].as_f64().unwrap()
    };
    let expected = n(text.as_bytes());
    for bytes in [
        wide(&format!("\u{feff}{text}")),
        wide(&text),
        semicolons.clone().into_bytes(),
        text.replace(',', "   ").into_bytes(),
        gzip(&wide(&semicolons)),
        format!("# ВОГ\n{text}").into_bytes(),
        [&b"# \xc2\xce\xc3\n"[..], text.as_bytes()].concat(),
    ] {
        assert_eq!(n(&bytes).to_bits(), expected.to_bits());
    }
}

#[test]
fn packed_files_that_end_early_or_unpack_without_end_are_refused() {
    let text = recording(5000).into_bytes();
    let (gz, zs) = (gzip(&text), zst(&text));
    refused("half.csv.gz", &gz[..gz.len() / 2], &["end early", "truncated"]);
    refused("head.csv.gz", &gz[..5], &["head.csv.gz"]);
    refused("half.csv.zst", &zs[..zs.len() / 2], &["end early", "truncated"]);
    let mut flipped = gz.clone();
    flipped[gz.len() / 2] ^= 0x10;
    refused("flipped.csv.gz", &flipped, &["damaged"]);
    refused("nothing.csv.gz", &gzip(b""), &["the compressed file is empty"]);
    let mut bomb = format!("{HEADER}\n").into_bytes();
    bomb.resize(64 << 20, b'0');
    refused("bomb.csv.gz", &gzip(&bomb), &["bomb.csv.gz"]);
    refused("bomb.csv.zst", &zst(&bomb), &["bomb.csv.zst"]);
    let rows = format!("{HEADER}\n{}", "0,0,0\n".repeat(12 << 20));
    refused("rows.csv.gz", &gzip(rows.as_bytes()), &["rows.csv.gz"]);
}

#[test]
fn columns_that_are_missing_doubled_or_words_are_named() {
    let sound = recording(ROWS);
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("c.csv"), sound.replace("rate_deg_h", "rate_deg_s")).unwrap();
    let (analysed, run) = both(dir.path(), "c.csv");
    assert_eq!((analysed.code, run.code), (0, 2), "another unit is another column for a procedure");
    assert!(run.err.contains("there is no column `rate_deg_h`\n"), "{}", run.err);
    assert!(run.err.contains("did you mean `rate_deg_s`? "), "{}", run.err);
    refused("norate.csv", sound.replace("rate_deg_h", "x").as_bytes(), &["column", "x"]);
    let doubled = sound.replace("temp_degC", "rate_deg_h");
    refused_with(
        "doubled.csv",
        doubled.as_bytes(),
        &["the name `rate_deg_h` is used by 2 columns (2, 3)", "position"],
        2,
    );
    let words = changed(|r, _| Some(format!("{},warm,20.0", r - 1)));
    refused("words.csv", words.as_bytes(), &[":2:3:", "`warm`", "rate_deg_h"]);
    let timeless = changed(|r, _| Some(format!("noon,{r},20.0")));
    refused("timeless.csv", timeless.as_bytes(), &[":2:1:", "`noon`", "time_s"]);
    let headless: String = sound.lines().skip(1).map(|l| format!("{l}\n")).collect();
    refused_with("headless.csv", headless.as_bytes(), &["column"], 3);
}

#[test]
fn fields_that_are_no_numbers_are_located() {
    for bad in ["#N/A", "12.5.1", "0x1F", "1_000", "\u{2212}12.5", "--", "12.5 deg/h"] {
        faulty("field.csv", &rate(500, bad), &[("unparsable", 500, 1)]);
    }
    for none in ["", "NaN", "nan", "inf", "-Infinity", "1e309"] {
        faulty("field.csv", &rate(500, none), &[("non_finite", 500, 1)]);
    }
    let run = changed(|r, _| (500..=540).contains(&r).then(|| format!("{},,20.0", r - 1)));
    faulty("empty-fields.csv", &run, &[("non_finite", 500, 41)]);
    let ends = changed(|r, _| (r == 1 || r == ROWS).then(|| format!("{},x,20.0", r - 1)));
    faulty("ends.csv", &ends, &[("unparsable", 1, 1), ("unparsable", ROWS, 1)]);
}

#[test]
fn rows_of_the_wrong_shape_are_faults_of_every_column() {
    // Nobody can tell which field of such a row is which: its stamp and its rate are both unusable, and a sample is
    // missing where it stood.
    let both_columns = [("unparsable", 500, 1), ("unparsable", 500, 1), ("gap", 501, 1)];
    faulty("short.csv", &changed(|r, _| (r == 500).then(|| "499,12.5".to_owned())), &both_columns);
    faulty("long.csv", &changed(|r, row| (r == 500).then(|| format!("{row},1,2"))), &both_columns);
    faulty("decimal-comma.csv", &rate(500, "12,5"), &both_columns);
}

#[test]
fn one_extreme_number_does_not_spoil_the_record() {
    for beyond in ["1e308", "-1e308", "1e61"] {
        let r = faulty("beyond.csv", &rate(500, beyond), &[("non_finite", 500, 1)]);
        assert!(r["integrity"]["faults"][0]["note"].as_str().unwrap().contains(&format!("`{beyond}`")));
        // White noise of 0.1 deg/h at 1 Hz: N = 0.1/60 deg/√h.
        let n = crate::support::measurand(&r, "angle_random_walk")["value"].as_f64().unwrap();
        assert!((n * 600.0 - 1.0).abs() < 0.15, "{beyond}: {n}");
    }
    for extreme in ["5e-324", "99999999999999999999999999", "1e9"] {
        let impossible = ("implausible", 500, 1);
        let both = [impossible, ("outlier", 500, 1)].into_iter();
        let expected: Vec<(&str, u64, u64)> =
            both.filter(|f| *f != impossible || extreme != "5e-324").collect();
        let r = faulty("extreme.csv", &rate(500, extreme), &expected);
        assert_eq!(r["integrity"]["outliers"], 1);
    }
}

#[test]
fn records_of_extreme_numbers_are_refused_or_evaluated_without_overflow() {
    let scaled = |scale: f64| changed(|r, _| Some(format!("{},{:e},20.0", r - 1, scale * white(1, r))));
    for scale in [1e307, 1e300, 1e160] {
        refused("vast.csv", scaled(scale).as_bytes(), &["fewer than two usable numbers"]);
    }
    for scale in [1e50, 1e-160, 1e-310, 5e-324] {
        let dir = tempdir().unwrap();
        std::fs::write(dir.path().join("scaled.csv"), scaled(scale)).unwrap();
        let (analysed, run) = both(dir.path(), "scaled.csv");
        assert_eq!((analysed.code, run.code), (0, 3), "{scale:e}: {analysed:?} {run:?}");
    }
}
