//! NumPy, MATLAB and raw recordings: the right values from files that other tools wrote, and a diagnostic or the right
//! values from damaged ones.

mod support;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::ingest::{FieldFault, IngestError, IngestErrorKind, ReadOptions, Source, open_with};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use support::{sagnac, shipped};
use tempfile::tempdir;

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(shipped(&format!("tests/fixtures/binary/{name}")))
}

const ALL: &[&str] = &[
    "structured.npy",
    "big_endian.npy",
    "version3.npy",
    "rows.npy",
    "fortran.npy",
    "flat.npy",
    "vector.npy",
    "dates.npy",
    "types.npy",
    "objects.npy",
    "stored.npz",
    "packed.npz",
    "v4.mat",
    "v5.mat",
    "v7.mat",
    "struct.mat",
    "matrix.mat",
    "nothing.mat",
];

fn time_s(i: usize) -> f64 {
    // The decimal that was written, not the product.
    format!("{:.3}", i as f64 * 0.005).parse().unwrap()
}

fn rate(i: usize) -> f64 {
    format!("{:.2}", (((i * 7919) % 1000) as f64 - 500.0) / 100.0).parse().unwrap()
}

fn temperature(i: usize) -> f64 {
    20.0 + (i % 7) as f64 / 8.0
}

fn columns(of: &[fn(usize) -> f64]) -> Vec<Vec<f64>> {
    of.iter().map(|f| (0..250).map(f).collect()).collect()
}

struct Read {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    faults: Vec<FieldFault>,
    source: Source,
}

/// Every column of numbers of a file, read in one go.
fn read(path: &Path, options: &ReadOptions) -> Result<Read, IngestError> {
    let source = open_with(path, options)?;
    let wanted: Vec<usize> = (0..source.columns().len()).filter(|i| source.columns()[*i].numeric).collect();
    let names = wanted.iter().map(|i| source.columns()[*i].name.clone()).collect();
    let mut columns = vec![Vec::new(); wanted.len()];
    let mut faults = Vec::new();
    let facts = source.read(&wanted, &mut |block| {
        assert_eq!(block.first_row as usize, columns[0].len() + 1);
        for (all, part) in columns.iter_mut().zip(&block.columns) {
            all.extend_from_slice(part);
        }
        faults.extend_from_slice(&block.faults);
        ControlFlow::Continue(())
    })?;
    assert_eq!(facts.unwrap().rows as usize, columns[0].len());
    // A single column comes out as it does among the others.
    for (slot, w) in wanted.iter().enumerate().take(3) {
        let mut one = Vec::new();
        source.read(&[*w], &mut |block| {
            one.extend_from_slice(&block.columns[0]);
            ControlFlow::Continue(())
        })?;
        let bits = |c: &[f64]| c.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&one), bits(&columns[slot]));
    }
    Ok(Read { names, columns, faults, source })
}

fn sound(name: &str) -> Read {
    read(&fixture(name), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn notes(source: &Source) -> String {
    source.notes().iter().map(|n| n.say(sagnac::text::Lang::En) + "\n").collect()
}

#[test]
fn arrays_of_every_shape_and_order_give_their_values() {
    let named = ["time_s", "rate_deg_h", "temp_degC"];
    for name in ["structured.npy", "big_endian.npy", "stored.npz", "v4.mat", "v5.mat", "v7.mat"] {
        let read = sound(name);
        assert_eq!(
            (read.names, read.columns),
            (named.map(str::to_owned).to_vec(), columns(&[time_s, rate, temperature])),
            "{name}"
        );
        assert!(read.faults.is_empty());
    }
    for name in ["rows.npy", "fortran.npy"] {
        let read = sound(name);
        assert_eq!((read.columns, notes(&read.source)), (columns(&[time_s, rate]), String::new()), "{name}");
    }
    let flat = sound("flat.npy");
    assert_eq!(flat.columns, columns(&[time_s, rate]));
    assert!(notes(&flat.source).contains("2 × 250 values: taken for 2 columns of 250 rows"));
    assert_eq!(sound("vector.npy").columns, columns(&[rate]));
    let cyrillic = sound("version3.npy");
    assert_eq!(
        (cyrillic.names, cyrillic.columns),
        (vec!["время".into(), "скорость".into()], columns(&[time_s, rate]))
    );
    let types = sound("types.npy");
    assert_eq!(types.names.len(), 12);
    for (name, column) in types.names.iter().zip(&types.columns) {
        let value = |i: u32| if name == "b" { f64::from(i % 2) } else { f64::from(3 * i) };
        assert_eq!(*column, (0..20).map(value).collect::<Vec<_>>(), "{name}");
    }
}

#[test]
fn dates_become_seconds_with_their_epoch() {
    let read = sound("dates.npy");
    let stamp = &read.source.columns()[0];
    // 2026-03-01T10:00:00Z is 20513 days and ten hours after 1970.
    assert_eq!((stamp.unit.as_deref(), stamp.epoch_s), (Some("s"), Some(20513.0 * 86400.0 + 36000.0)));
    for i in (0..250).filter(|i| *i != 7) {
        assert_eq!(read.columns[0][i], (250_000 + 5000 * i) as f64 / 1e6, "row {i}");
    }
    assert!(read.columns[0][7].is_nan() && read.columns[1][9].is_nan());
    assert_eq!(read.columns[2][249], 0.249);
    let faults: Vec<_> = read.faults.iter().map(|f| (f.slot, f.row, f.text.as_str())).collect();
    assert_eq!(faults, [(0, 8, "NaT"), (1, 10, "NaN")]);
}

#[test]
fn containers_say_what_they_hold_and_what_is_left_out() {
    let read = sound("packed.npz");
    assert_eq!(read.names, ["time_s", "rate_deg_h", "temp_degC", "xy[0]", "xy[1]"]);
    assert_eq!(read.columns[3..], columns(&[time_s, rate]));
    assert_eq!(read.source.stated_sample_rate_hz(), Some(200.0));
    assert!(
        read.source.metadata().contains(&("serial".into(), "SN-7".into())),
        "{:?}",
        read.source.metadata()
    );
    let said = notes(&read.source);
    assert!(said.contains("`short` is left out: it has 5 rows, the recording 250"), "{said}");
    assert!(said.contains("`obj.npy` is left out: the array holds Python objects"), "{said}");

    let read = sound("v7.mat");
    assert_eq!(read.source.stated_sample_rate_hz(), Some(200.0));
    assert!(read.source.metadata().contains(&("serial".into(), "SN-7".into())));
    let said = notes(&read.source);
    for left in [
        "`z` is left out: its numbers are complex",
        "`sp` is left out: it is a sparse",
        "`c` is left out: it is a cell",
        "`short` is left out: it has 5",
    ] {
        assert!(said.contains(left), "{said}");
    }
    let read = sound("struct.mat");
    assert_eq!(read.names, ["data.time_s", "data.rate_deg_h", "data.temp_degC"]);
    assert_eq!(read.columns, columns(&[time_s, rate, temperature]));
    assert_eq!(read.source.stated_sample_rate_hz(), Some(200.0));
    assert!(notes(&read.source).contains("`data.deep` is left out: it is a structure within a structure"));
    let read = sound("matrix.mat");
    assert_eq!(read.names, ["m(:,1)", "m(:,2)", "flags", "n"]);
    assert_eq!(read.columns, columns(&[time_s, rate, |i| f64::from(u8::from(i % 2 == 0)), |i| i as f64]));

    let part = |part: &str| ReadOptions { part: Some(part.into()), ..ReadOptions::default() };
    assert_eq!(read_names("packed.npz", &part("xy")), ["xy[0]", "xy[1]"]);
    assert_eq!(read_names("packed.npz", &part("short")), ["short"]);
    assert_eq!(read_names("matrix.mat", &part("m")), ["m(:,1)", "m(:,2)"]);
    let error = read_error(&fixture("v7.mat"), &part("rote"));
    assert_eq!(error.kind(), IngestErrorKind::Column);
    assert!(
        error.to_string().contains("there is no array `rote`; the file has: time_s, rate_deg_h"),
        "{error}"
    );
}

fn read_names(name: &str, options: &ReadOptions) -> Vec<String> {
    read(&fixture(name), options).unwrap_or_else(|e| panic!("{e}")).names
}

fn read_error(path: &Path, options: &ReadOptions) -> IngestError {
    read(path, options).err().expect("an error")
}

#[test]
fn what_holds_no_numbers_is_refused_with_advice() {
    let plain = ReadOptions::default();
    let error = read_error(&fixture("objects.npy"), &plain).to_string();
    assert!(error.contains("Python objects; objects are never unpacked"), "{error}");
    let error = read_error(&fixture("nothing.mat"), &plain).to_string();
    assert!(error.contains("`z` is left out: its numbers are complex; save plain arrays"), "{error}");
    let format = |id: &str| ReadOptions { format: Some(id.into()), ..ReadOptions::default() };
    let error = read_error(&fixture("v7.mat"), &format("nyp")).to_string();
    assert!(error.contains("there is no format `nyp`; did you mean `npy`?"), "{error}");
    let error = read_error(&fixture("v7.mat"), &format("excel")).to_string();
    assert!(error.contains("formats: raw, parquet, npy, npz, mat"), "{error}");
    let error = read_error(&fixture("v7.mat"), &format("npy")).to_string();
    assert!(error.contains("this is no NumPy array; leave the format out"), "{error}");
    let error = read_error(&fixture("v7.mat"), &format("raw"));
    assert_eq!(error.kind(), IngestErrorKind::Layout);
    assert!(error.to_string().contains("need a layout; describe the records in a TOML file"), "{error}");
    let dir = tempdir().unwrap();
    let path = dir.path().join("x.bin");
    std::fs::write(&path, [7u8, 0, 3, 0, 1, 0]).unwrap();
    let error = read_error(&path, &plain).to_string();
    assert!(error.contains("raw binary records need a layout (--layout layout.toml)"), "{error}");
}

/// A MAT file of version 5 with big-endian numbers, written by hand: vectors of doubles.
fn big_endian_mat(vectors: &[(&str, Vec<f64>)]) -> Vec<u8> {
    let mut out = vec![b' '; 116];
    out.extend_from_slice(&[0; 8]);
    out.extend_from_slice(&[1, 0, b'M', b'I']);
    let words = |list: &[u32]| list.iter().flat_map(|w| w.to_be_bytes()).collect::<Vec<u8>>();
    for (name, values) in vectors {
        let mut body = words(&[6, 8, 6, 0, 5, 8, values.len() as u32, 1, 1, name.len() as u32]);
        body.extend_from_slice(name.as_bytes());
        body.resize(body.len().next_multiple_of(8), 0);
        body.extend_from_slice(&words(&[9, 8 * values.len() as u32]));
        body.extend(values.iter().flat_map(|v| v.to_be_bytes()));
        out.extend_from_slice(&words(&[14, body.len() as u32]));
        out.extend_from_slice(&body);
    }
    out
}

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
    ReadOptions { layout: Some(path), ..ReadOptions::default() }
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
    let seen = sagnac::run::inspect::inspect_source(&sound.source, None, &mut |_, _| {}).unwrap();
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
        ("EB 90", "EB 91", "the layout does not fit: of the first 250 records 0 are sound"),
        ("\"crc32\"", "\"crc16-ccitt\"", "0 are sound"),
        ("header_bytes = 16", "header_bytes = 9000", "less than the header and one record"),
        ("\"i16\"", "\"int16\"", "layout.toml:27:9: `int16` is not a value of `type`"),
    ] {
        let options = with_layout(dir.path(), &IMU.replace(change, to));
        let error = read_error(&path, &options).to_string();
        assert!(error.contains(says), "{error}");
    }
    let options = ReadOptions { layout: Some(dir.path().join("none.toml")), ..ReadOptions::default() };
    assert!(read_error(&path, &options).to_string().contains("the layout cannot be read"));
}

#[test]
fn one_record_gives_the_same_curve_from_every_format() {
    let dir = tempdir().unwrap();
    let mut text = String::from("time_s,rate_deg_h,temp_degC\n");
    for i in 0..250 {
        text.push_str(&format!("{:.3},{:.2},{:.3}\n", time_s(i), rate(i), temperature(i)));
    }
    std::fs::write(dir.path().join("r.csv"), text).unwrap();
    let vector = |f: fn(usize) -> f64| (0..250).map(f).collect::<Vec<f64>>();
    let all = [("time_s", vector(time_s)), ("rate_deg_h", vector(rate)), ("temp_degC", vector(temperature))];
    std::fs::write(dir.path().join("big.mat"), big_endian_mat(&all)).unwrap();
    let mut files: Vec<PathBuf> =
        ["structured.npy", "stored.npz", "packed.npz", "v4.mat", "v5.mat", "v7.mat"]
            .iter()
            .map(|name| fixture(name))
            .collect();
    files.push(dir.path().join("big.mat"));
    let curve = |path: &Path| {
        let out = dir.path().join("out").join(path.file_name().unwrap());
        let said = sagnac(dir.path(), &["analyze", path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert_eq!(said.code, 0, "{said:?}");
        std::fs::read_to_string(out.join("sigma_tau.csv")).unwrap()
    };
    let expected = curve(&dir.path().join("r.csv"));
    assert!(expected.lines().count() > 5, "{expected}");
    for file in files {
        assert_eq!(curve(&file), expected, "{}", file.display());
    }
}

#[test]
fn files_cut_anywhere_are_refused_or_right() {
    let dir = tempdir().unwrap();
    let options = ReadOptions::default();
    for name in ALL {
        let whole = std::fs::read(fixture(name)).unwrap();
        let right = read(&fixture(name), &options).ok();
        let path = dir.path().join(name);
        // Every byte of the head and of the tail, and some between.
        let places = (0..whole.len()).filter(|n| *n < 300 || *n + 200 > whole.len() || n % 37 == 0);
        for n in places {
            std::fs::write(&path, &whole[..n]).unwrap();
            match read(&path, &options) {
                Err(error) => assert!(error.to_string().contains(name), "{name} cut at {n}: {error}"),
                Ok(cut) => {
                    let right = right.as_ref().unwrap();
                    for (name_of, column) in cut.names.iter().zip(&cut.columns) {
                        let slot = right.names.iter().position(|r| r == name_of);
                        // Whole variables may be missing behind the cut, and the rest must be right.
                        assert_eq!(Some(column), slot.map(|s| &right.columns[s]), "{name} cut at {n}");
                    }
                }
            }
        }
    }
}

#[test]
fn files_with_changed_bytes_are_refused_or_read_without_harm() {
    let dir = tempdir().unwrap();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let mut checked = 0;
    for name in ALL {
        let whole = std::fs::read(fixture(name)).unwrap();
        let right = read(&fixture(name), &ReadOptions::default()).ok();
        let path = dir.path().join(name);
        for k in 0..400 {
            let mut broken = whole.clone();
            // Headers stand at the start, directories at the end: half of the changes go there.
            let at = match k % 4 {
                0 => random.random_range(0..whole.len().min(300)),
                1 => whole.len() - 1 - random.random_range(0..whole.len().min(300)),
                _ => random.random_range(0..whole.len()),
            };
            broken[at] =
                if k % 3 == 0 { random.random() } else { broken[at] ^ (1 << random.random_range(0..8)) };
            std::fs::write(&path, &broken).unwrap();
            match read(&path, &ReadOptions::default()) {
                Err(error) => assert!(error.to_string().contains(name), "{name} byte {at}: {error}"),
                // The checksums of archives leave no way for a wrong value.
                Ok(read) if name.ends_with(".npz") => {
                    let right = right.as_ref().unwrap();
                    for (name_of, column) in read.names.iter().zip(&read.columns) {
                        if let Some(slot) = right.names.iter().position(|r| r == name_of) {
                            checked += 1;
                            assert_eq!(column, &right.columns[slot], "{name} byte {at}: {name_of}");
                        }
                    }
                }
                Ok(read) => assert!(read.columns[0].len() <= 8 * whole.len(), "{name} byte {at}"),
            }
        }
    }
    assert!(checked > 100, "{checked}");
}
