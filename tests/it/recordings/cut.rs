//! Files that were cut: each is refused, or says in `inspect` and in a result that its end is missing.

use crate::support::{result, sagnac};
use sagnac::ingest::{ReadOptions, open_with};
use std::path::{Path, PathBuf};
use tempfile::tempdir;

fn fixtures() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let mut found: Vec<PathBuf> = ["binary", "containers"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|p| !p.extension().is_some_and(|e| e == "md" || e == "py"))
        .collect();
    found.sort();
    found
}

/// Rows that a file gives and whether it says that it is cut off; `None` where it is refused.
fn read(path: &Path, part: Option<&str>) -> Option<(u64, bool)> {
    let options = ReadOptions { part: part.map(str::to_owned), ..ReadOptions::default() };
    let source = open_with(path, &options).ok()?;
    let wanted: Vec<usize> = (0..source.columns().len()).filter(|&i| source.columns()[i].numeric).collect();
    let mut faults = 0;
    let facts = source.read(&wanted, &mut |block| {
        faults += block.faults.len();
        std::ops::ControlFlow::Continue(())
    });
    Some((facts.ok()??.rows, !source.cut_off().is_empty()))
}

#[test]
fn no_file_that_was_cut_passes_for_a_whole_one() {
    let dir = tempdir().unwrap();
    let mut silent = Vec::new();
    let mut read_on = 0;
    for path in fixtures() {
        let Some((rows, cut)) =
            [None, Some("imu"), Some("/imu/data")].into_iter().find_map(|p| read(&path, p))
        else {
            continue;
        };
        assert!(!cut, "{}: a whole file", path.display());
        let bytes = std::fs::read(&path).unwrap();
        let text = path.extension().is_some_and(|e| e == "csv");
        let copy = dir.path().join(path.file_name().unwrap());
        for k in 1..120 {
            let length = bytes.len() * k / 120;
            // Text that ends with a whole row is whole; so is one whose last number may have any form.
            let line = bytes[..length].rsplit(|b| *b == b'\n').next().unwrap_or_default();
            let commas = |l: &[u8]| l.iter().filter(|b| **b == b',').count();
            let fields = commas(bytes.split(|b| *b == b'\n').next().unwrap_or_default());
            let whole = line.is_empty() || length < 4096 || commas(line) == fields;
            if text && whole {
                continue;
            }
            std::fs::write(&copy, &bytes[..length]).unwrap();
            if let Some((left, cut)) = read(&copy, None) {
                read_on += 1;
                // What follows the last value of the recording can be missing without harm to it.
                if !cut && left < rows {
                    silent.push(format!(
                        "{} cut to {length} of {}: {left} rows",
                        path.display(),
                        bytes.len()
                    ));
                }
            }
        }
    }
    assert!(silent.is_empty() && read_on > 20, "{read_on} {silent:#?}");
}

#[test]
fn a_run_on_a_recording_that_was_cut_is_not_valid() {
    let dir = tempdir().unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/containers");
    for name in ["lz4.mcap", "zstd.mcap", "lz4.bag", "bz2.bag", "wave.tdms"] {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        std::fs::write(dir.path().join(name), &bytes[..bytes.len() * 6 / 10]).unwrap();
        let seen = sagnac(dir.path(), &["inspect", name]);
        if seen.code != 0 {
            assert!(format!("{seen:?}").contains("truncated"), "{name}: {seen:?}");
            continue;
        }
        let page = format!("{seen:?}");
        assert!(page.contains("truncated") && !page.contains("no fault"), "{name}: {page}");
        let said = sagnac(dir.path(), &["analyze", name, "--out", name.split('.').next().unwrap()]);
        if said.code != 2 {
            let r = result(&dir.path().join(name.split('.').next().unwrap()));
            assert_eq!(r["integrity"]["cut_off"], 1, "{name}");
            let faults = r["integrity"]["faults"].as_array().unwrap();
            assert!(faults.iter().any(|f| f["kind"] == "cut_off"), "{name}");
            let conditions = r["conditions"].as_array().unwrap();
            let found = conditions.iter().find(|c| c["id"] == "cut_off").unwrap();
            assert_eq!(found["status"], "remark", "{name}");
        }
        std::fs::remove_dir_all(dir.path().join(name.split('.').next().unwrap())).unwrap_or_default();
    }
}
