//! Raw binary records: the right values by a layout, and damaged records lose their own rows and no others.

use crate::recordings::binary_files::{columns, rate, read, read_error, temperature};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::i18n::{Lang, Localize};
use sagnac::ingest::ReadOptions;
use sagnac::ingest::layout::LayoutFile;
use std::path::Path;
use tempfile::tempdir;

/// Records of 32 bytes: sync, counter, stamp in µs, rate, temperature, padding, CRC-32.
fn imu(rows: usize) -> Vec<u8> {
    let mut out = vec![0x77; 16];
    for i in 0..rows {
        let mut record = vec![0xeb, 0x90];
        record.extend_from_slice(&(i as u16).to_le_bytes());
        record.extend_from_slice(&(5000 * i as u32).to_le_bytes());
        record.extend_from_slice(&rate(i).to_le_bytes());
        record.extend_from_slice(&((temperature(i) * 8.0) as i16).to_le_bytes());
        record.resize(28, 0);
        let mut crc = flate2::Crc::new();
        crc.update(&record);
        record.extend_from_slice(&crc.sum().to_le_bytes());
        out.extend_from_slice(&record);
    }
    out
}

const IMU: &str = r#"
format = "layout/1"
header_bytes = 16
record_bytes = 32
sync = "EB 90"

[checksum]
type = "crc32"

[[field]]
name = "counter"
type = "u16"

[[field]]
name = "time_us"
type = "u32"
unit = "us"
rolls_over = "4294.967296 s"

[[field]]
name = "rate_deg_h"
type = "f64"
unit = "deg/h"

[[field]]
name = "temp_degC"
type = "i16"
scale = 0.125
unit = "degC"
"#;

fn with_layout(dir: &Path, layout: &str) -> ReadOptions {
    let path = dir.join("layout.toml");
    std::fs::write(&path, layout).unwrap();
    ReadOptions { layout: Some(LayoutFile::at(path)), ..ReadOptions::default() }
}

#[test]
fn raw_records_are_read_by_their_layout() {
    let dir = tempdir().unwrap();
    let options = with_layout(dir.path(), IMU);
    let path = dir.path().join("imu.bin");
    let bytes = imu(250);
    std::fs::write(&path, &bytes).unwrap();
    let sound = read(&path, &options).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(sound.columns, columns(&[|i| i as f64, |i| 5000.0 * i as f64, rate, temperature]));
    assert_eq!(sound.source.columns()[1].rollover_s, Some(4294.967296));
    let seen = sagnac::acceptance::inspect::inspect_source(
        &sound.source,
        None,
        sagnac::i18n::Lang::En,
        &mut |_, _| {},
    )
    .unwrap();
    assert!(seen.contains("200 Hz") && seen.contains("records of 32 bytes"), "{seen}");

    // Packed, and with a byte turned over, three bytes dropped, and the end cut off.
    let mut damaged = bytes.clone();
    damaged[16 + 32 * 100 + 12] ^= 4;
    damaged.drain(16 + 32 * 200 + 5..16 + 32 * 200 + 8);
    damaged.truncate(damaged.len() - 10);
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, &damaged).unwrap();
    let path = dir.path().join("imu.bin.gz");
    std::fs::write(&path, packed.finish().unwrap()).unwrap();
    let read = read(&path, &options).unwrap_or_else(|e| panic!("{e}"));
    let lost = [100, 200, 249];
    for i in 0..250 {
        let value = read.columns[2][i];
        if lost.contains(&i) { assert!(value.is_nan(), "row {i}") } else { assert_eq!(value, rate(i)) }
    }
    let told: Vec<_> = read.faults.iter().filter(|f| f.slot == 2).map(|f| (f.row, f.text.as_str())).collect();
    assert_eq!(told[0].0, 101);
    assert!(told[0].1.starts_with("crc32 ") && told[0].1.ends_with("@3216"), "{told:?}");
    assert_eq!(told[1..], [(201, "sync @6416 +29 B"), (250, "22/32 B @7981")]);
}

#[test]
fn a_layout_that_does_not_fit_is_refused() {
    let dir = tempdir().unwrap();
    let path = dir.path().join("imu.bin");
    std::fs::write(&path, imu(250)).unwrap();
    for (change, to, says) in [
        ("EB 90", "EB 91", "the layout does not match: 0 of the first 250 records are valid"),
        ("\"crc32\"", "\"crc16-ccitt\"", "0 of the first 250 records are valid"),
        ("header_bytes = 16", "header_bytes = 9000", "less than the header and one record"),
        ("\"i16\"", "\"int16\"", "layout.toml:27:9: `int16` is not a valid value of `type`"),
    ] {
        let options = with_layout(dir.path(), &IMU.replace(change, to));
        let error = read_error(&path, &options).say(Lang::En);
        assert!(error.contains(says), "{error}");
    }
    let options =
        ReadOptions { layout: Some(LayoutFile::at(dir.path().join("none.toml"))), ..ReadOptions::default() };
    assert!(read_error(&path, &options).say(Lang::En).contains("the layout cannot be read"));
}

#[test]
fn no_damage_lets_a_wrong_value_through() {
    let dir = tempdir().unwrap();
    let options = with_layout(dir.path(), IMU);
    let path = dir.path().join("imu.bin");
    let whole = imu(250);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut lost = 0;
    for k in 0..400 {
        let mut bytes = whole.clone();
        let at = random.random_range(16..bytes.len());
        match k % 5 {
            0 | 1 => bytes[at] ^= 1 << random.random_range(0..8),
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..(at + random.random_range(1..100)).min(whole.len()))),
            _ => drop(bytes.splice(at..at, (0..random.random_range(1..100)).map(|b| b as u8))),
        }
        std::fs::write(&path, &bytes).unwrap();
        let Ok(read) = read(&path, &options) else {
            assert!(at < 200, "only a file of a few records may be refused");
            continue;
        };
        let sound: Vec<usize> =
            (0..read.columns[0].len()).filter(|i| read.columns[0][*i].is_finite()).collect();
        for &row in &sound {
            let i = read.columns[0][row] as usize;
            let values: Vec<f64> = read.columns.iter().map(|c| c[row]).collect();
            assert_eq!(values, [i as f64, 5000.0 * i as f64, rate(i), temperature(i)], "change {k} at {at}");
        }
        let faults = read.faults.iter().filter(|f| f.slot == 0).count();
        assert_eq!(faults, read.columns[0].len() - sound.len(), "every row without values is told");
        if k % 5 < 2 {
            assert_eq!(sound.len(), 249, "change {k} at {at}");
        }
        lost += faults;
    }
    assert!(lost > 300, "{lost}");
}
