//! Broken and odd Parquet recordings.

use crate::support::{both, result, sagnac, shipped};
use tempfile::tempdir;

fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(shipped(&format!("tests/bad-input/recording/{name}.parquet"))).unwrap()
}

fn refused(bytes: &[u8], name: &str, fragments: &[&str]) {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join(name), bytes).unwrap();
    let (analysed, run) = both(dir.path(), name);
    for said in [analysed, run] {
        assert_eq!(said.code, 2, "{name}: {said:?}");
        for fragment in [&[name], fragments].concat() {
            assert!(said.err.contains(fragment), "{name}: no `{fragment}` in\n{}", said.err);
        }
    }
}

#[test]
fn a_sound_file_is_read_under_any_name() {
    let dir = tempdir().unwrap();
    for name in ["r.parquet", "r.csv"] {
        std::fs::write(dir.path().join(name), fixture("sound")).unwrap();
        let (analysed, run) = both(dir.path(), name);
        assert_eq!((analysed.code, run.code), (0, 3), "{analysed:?} {run:?}");
        assert_eq!(result(&dir.path().join("a"))["recording"][0]["samples"], 1000);
    }
}

#[test]
fn nulls_and_nan_are_located() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("n.parquet"), fixture("nulls")).unwrap();
    let (analysed, run) = both(dir.path(), "n.parquet");
    assert_eq!((analysed.code, run.code), (0, 3), "{analysed:?} {run:?}");
    let result = result(&dir.path().join("a"));
    let faults = result["integrity"]["faults"].as_array().unwrap();
    let found: Vec<_> =
        faults.iter().map(|f| (f["kind"].as_str().unwrap(), f["row"].as_u64().unwrap())).collect();
    assert_eq!(found, [("non_finite", 500), ("non_finite", 600)]);
}

#[test]
fn what_lacks_a_rate_or_rows_is_refused() {
    refused(&fixture("no-rate"), "no-rate.parquet", &["column"]);
    refused(&fixture("words"), "words.parquet", &["rate_deg_h"]);
    refused(&fixture("no-rows"), "no-rows.parquet", &["no rows"]);
}

#[test]
fn a_damaged_file_is_refused_wherever_it_is_damaged() {
    let sound = fixture("sound");
    refused(&sound[..sound.len() / 2], "half.parquet", &[]);
    refused(&sound[..8], "head.parquet", &[]);
    refused(&sound[..sound.len() - 1], "last-byte.parquet", &[]);
    // A byte that is turned over is caught or changes nothing that breaks the program; pages without checksum may
    // carry it into a value.
    let dir = tempdir().unwrap();
    for k in 0..20 {
        let mut broken = sound.clone();
        let at = 4 + k * (sound.len() - 8) / 20;
        broken[at] ^= 0xff;
        std::fs::write(dir.path().join("b.parquet"), &broken).unwrap();
        let said = sagnac(dir.path(), &["analyze", "b.parquet", "--out", "b"]);
        assert!([0, 2].contains(&said.code), "byte {at}: {said:?}");
        assert!(said.code == 0 || said.err.contains("b.parquet"), "byte {at}: {said:?}");
    }
}

#[test]
fn a_page_whose_bytes_do_not_give_its_checksum_is_refused() {
    let whole = std::fs::read(shipped("tests/fixtures/containers/checksums.parquet")).unwrap();
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("whole.parquet"), &whole).unwrap();
    assert_eq!(sagnac(dir.path(), &["analyze", "whole.parquet", "--out", "a"]).code, 0);
    // The numbers lie in the first 6400 bytes: 400 of each column, behind a short header.
    for at in [500, 3100, 3900, 6000] {
        let mut changed = whole.clone();
        changed[at] ^= 0x01;
        std::fs::write(dir.path().join("changed.parquet"), &changed).unwrap();
        let said = sagnac(dir.path(), &["analyze", "changed.parquet", "--out", "b"]);
        assert!(said.code == 2 && said.err.contains("CRC"), "byte {at}: {said:?}");
    }
}
