//! Results from elsewhere, and tables for others.

use crate::store::{kept, store, store_says, with_store, write_result, write_results};
use crate::support::quick::Quick;
use crate::support::shared::analyzed_once;
use crate::support::{files, names, result_table, sagnac, sagnac_as_typed, shipped};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use std::fs::{self, File};

#[test]
fn results_of_a_lot_come_in_once_and_go_out_as_they_came() {
    let dir = with_store();
    let samples = shipped("samples/lot");
    let said = store(dir.path(), &["import", "store", &samples]);
    assert!(said.out.contains("Added: 30; there already: 0; refused: 0"), "{said:?}");
    assert!(said.err.contains("stored without files that they list: 30"), "{said:?}");
    let said = store(dir.path(), &["import", "store", &samples]);
    assert!(said.out.contains("Added: 0; there already: 30"), "{said:?}");
    for (_, folder) in kept(&dir.path().join("store")) {
        let serial =
            crate::support::result(&folder)["unit_under_test"]["serial"].as_str().unwrap().to_owned();
        let original = fs::read(format!("{samples}/{serial}/result.json")).unwrap();
        assert!(fs::read(folder.join("result.json")).unwrap() == original, "{serial}");
    }
    // Out of one store and into another: the same addresses.
    store(dir.path(), &["init", "other"]);
    store(dir.path(), &["import", "other", "store/results"]);
    let addresses = |name: &str| -> Vec<String> {
        kept(&dir.path().join(name)).into_iter().map(|(address, _)| address).collect()
    };
    assert_eq!(addresses("other"), addresses("store"));
}

#[test]
fn results_of_a_table_come_in_as_those_of_folders() {
    let dir = with_store();
    result_table(&dir.path().join("t.parquet"));
    let said = store(dir.path(), &["import", "store", "t.parquet"]);
    assert!(said.out.contains("Added: 30; there already: 0; refused: 0"), "{said:?}");
    store(dir.path(), &["init", "other"]);
    store(dir.path(), &["import", "other", &shipped("samples/lot")]);
    let addresses = |name: &str| -> Vec<String> {
        kept(&dir.path().join(name)).into_iter().map(|(address, _)| address).collect()
    };
    assert_eq!(addresses("other"), addresses("store"));
}

#[test]
fn the_table_has_a_row_for_each_measurand() {
    let dir = with_store();
    write_results(&dir.path().join("made"), 2);
    store(dir.path(), &["import", "store", "made"]);
    let said = store(dir.path(), &["export", "store", "--out", "t.parquet"]);
    assert!(said.out.contains("rows: 4"), "{}", said.out);
    let taken = ["store", "export", "store", "--out", "made/u000-1/result.json"];
    let said = sagnac_as_typed(dir.path(), &taken, &[]);
    assert!(said.code == 2, "an existing file is replaced by --force only: {said:?}");
    // The reader for recordings takes its numbers.
    let inspected = sagnac(dir.path(), &["inspect", "t.parquet"]);
    assert!(inspected.out.contains("value") && inspected.out.contains("limit_max"), "{inspected:?}");
    let table = SerializedFileReader::new(File::open(dir.path().join("t.parquet")).unwrap()).unwrap();
    let names: Vec<String> = table
        .metadata()
        .file_metadata()
        .schema_descr()
        .columns()
        .iter()
        .map(|c| c.name().to_owned())
        .collect();
    let at = |name: &str| names.iter().position(|n| n == name).unwrap();
    let rows: Vec<_> = table.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    let text = |row: usize, name: &str| rows[row].get_string(at(name)).unwrap().clone();
    assert_eq!(text(0, "serial"), "SN-000");
    assert_eq!(
        (text(0, "model"), text(0, "lot"), text(0, "station")),
        ("A-1".into(), "L1".into(), "S1".into())
    );
    assert_eq!((text(0, "verdict"), text(1, "verdict")), ("fail".into(), "pass".into()));
    assert_eq!(rows[0].get_double(at("value")).unwrap(), 1.2);
    assert_eq!(rows[0].get_double(at("limit_max")).unwrap(), 1.0);
    assert_eq!((rows[0].get_long(at("attempt")).unwrap(), rows[1].get_long(at("attempt")).unwrap()), (1, 2));
    let address = text(1, "address");
    assert!(kept(&dir.path().join("store")).iter().any(|(a, _)| *a == address));
    assert_eq!(text(1, "measurand"), "static_bias");
}

#[test]
fn copies_of_recordings_leave_the_store_and_are_found_again() {
    let dir = with_store();
    let quick = Quick::new("pass");
    fs::copy(&quick.recording, dir.path().join("unit.csv")).unwrap();
    let run = ["run", &quick.procedure, "unit.csv", "--serial", "SN-1", "--out", "r"];
    let said = sagnac(dir.path(), &[&run[..], &["--store", "store", "--keep-recording"]].concat());
    assert_eq!(said.code, 0, "{said:?}");
    let copies = dir.path().join("store/recordings");
    assert_eq!(names(&copies).len(), 1);
    store(dir.path(), &["verify", "store"]);
    fs::remove_file(dir.path().join("unit.csv")).unwrap();
    let places = || {
        let said = store(dir.path(), &["import", "store", "r", "--recordings", "r"]);
        assert!(said.out.contains("found at new places: 0; in place: 1; missing: 0"), "{said:?}");
    };
    places();
    let before = kept(&dir.path().join("store"));
    let said = store(dir.path(), &["prune", "store", "--to", "archive", "--before", "2020-01-01"]);
    assert!(said.out.contains("Moved copies of recordings: 0"), "{said:?}");
    let said = store(dir.path(), &["prune", "store", "--to", "archive"]);
    assert!(said.out.contains("Moved copies of recordings: 1"), "{said:?}");
    assert!(names(&copies).is_empty());
    let (_, bytes) = files(&dir.path().join("archive")).remove(0);
    assert!(bytes == fs::read(&quick.recording).unwrap());
    assert_eq!(kept(&dir.path().join("store")), before);
    places();
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn what_is_no_test_is_refused_and_the_rest_comes_in() {
    let dir = with_store();
    write_results(&dir.path().join("made"), 1);
    fs::create_dir_all(dir.path().join("made/broken")).unwrap();
    fs::write(dir.path().join("made/broken/result.json"), "{\"format\": \"result/1\"").unwrap();
    analyzed_once("pass").copy_to(&dir.path().join("made/analysis"));
    let said = store_says(dir.path(), &["import", "store", "made"]);
    assert_eq!(said.code, 1, "{said:?}");
    assert!(said.out.contains("Added: 2; there already: 0; refused: 2"), "{said:?}");
    assert!(said.err.contains("broken") && said.err.contains("an analysis is no test"), "{said:?}");
    let said = store_says(dir.path(), &["import", "store", "nothing"]);
    assert_eq!(said.code, 2, "{said:?}");
}

#[test]
fn a_recording_that_moved_is_found_by_its_hash() {
    let dir = with_store();
    let recording = b"time,rate\n0,1\n";
    fs::create_dir_all(dir.path().join("moved/deep")).unwrap();
    fs::write(dir.path().join("moved/deep/renamed.csv"), recording).unwrap();
    fs::write(dir.path().join("moved/other.csv"), b"time,rate\n0,2\n").unwrap();
    let mut result = crate::store::a_result("SN-1", "L", "2026-03-01T10:00:00Z", 0.5);
    let digest = sagnac::ingest::byte_stream::digest(&dir.path().join("moved/deep/renamed.csv")).unwrap();
    result["recording"] =
        serde_json::json!([{"path": "gone.csv", "sha256": digest.sha256, "bytes": recording.len()}]);
    write_result(dir.path(), "made", &result);
    let search = |expected: &str| {
        let said = store(dir.path(), &["import", "store", "made", "--recordings", "moved"]);
        assert!(said.out.contains(expected), "{expected}: {said:?}");
    };
    search("found at new places: 1; in place: 0; missing: 0");
    search("found at new places: 0; in place: 1; missing: 0");
    fs::rename(dir.path().join("moved/deep/renamed.csv"), dir.path().join("moved/again.csv")).unwrap();
    search("found at new places: 1; in place: 0; missing: 0");
    store(dir.path(), &["verify", "store"]);
    fs::remove_file(dir.path().join("moved/again.csv")).unwrap();
    search("found at new places: 0; in place: 0; missing: 1");
}
