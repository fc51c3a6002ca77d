//! NumPy, MATLAB and raw recordings: the right values from files that other tools wrote, and a diagnostic or the right
//! values from damaged ones.

use crate::recordings::binary_files::*;
use crate::support::sagnac;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::i18n::{Lang, Localize};
use sagnac::ingest::{IngestErrorKind, ReadOptions};
use std::path::{Path, PathBuf};
use tempfile::tempdir;

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

fn sound(name: &str) -> Read {
    read(&fixture(name), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
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
    assert!(notes(&flat.source).contains("2 × 250 values: read as 2 columns of 250 rows"));
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
    assert!(said.contains("`short` is skipped: it has 5 rows, the recording 250"), "{said}");
    assert!(said.contains("`obj.npy` is skipped: the array holds Python objects"), "{said}");

    let read = sound("v7.mat");
    assert_eq!(read.source.stated_sample_rate_hz(), Some(200.0));
    assert!(read.source.metadata().contains(&("serial".into(), "SN-7".into())));
    let said = notes(&read.source);
    for left in [
        "`z` is skipped: its numbers are complex",
        "`sp` is skipped: it is a sparse",
        "`c` is skipped: it is a cell",
        "`short` is skipped: it has 5",
    ] {
        assert!(said.contains(left), "{said}");
    }
    let read = sound("struct.mat");
    assert_eq!(read.names, ["data.time_s", "data.rate_deg_h", "data.temp_degC"]);
    assert_eq!(read.columns, columns(&[time_s, rate, temperature]));
    assert_eq!(read.source.stated_sample_rate_hz(), Some(200.0));
    assert!(notes(&read.source).contains("`data.deep` is skipped: it is a structure within a structure"));
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
        error.say(Lang::En).contains("there is no array `rote`; the file has: time_s, rate_deg_h"),
        "{error}"
    );
}

fn read_names(name: &str, options: &ReadOptions) -> Vec<String> {
    read(&fixture(name), options).unwrap_or_else(|e| panic!("{e}")).names
}

#[test]
fn what_holds_no_numbers_is_refused_with_advice() {
    let plain = ReadOptions::default();
    let error = read_error(&fixture("objects.npy"), &plain).say(Lang::En);
    assert!(error.contains("Python objects; objects are never loaded"), "{error}");
    let error = read_error(&fixture("nothing.mat"), &plain).say(Lang::En);
    assert!(error.contains("`z` is skipped: its numbers are complex; save plain arrays"), "{error}");
    let format = |id: &str| ReadOptions { format: Some(id.into()), ..ReadOptions::default() };
    let error = read_error(&fixture("v7.mat"), &format("nyp")).say(Lang::En);
    assert!(error.contains("unknown format `nyp`; did you mean `npy`?"), "{error}");
    let error = read_error(&fixture("v7.mat"), &format("excel")).say(Lang::En);
    assert!(error.contains("formats: raw, parquet, npy, npz, hdf5, mat"), "{error}");
    let error = read_error(&fixture("v7.mat"), &format("npy")).say(Lang::En);
    assert!(error.contains("npy"), "{error}");
    let error = read_error(&fixture("v7.mat"), &format("raw"));
    assert_eq!(error.kind(), IngestErrorKind::Layout);
    assert!(error.say(Lang::En).contains("need a layout; describe the records in a TOML file"), "{error}");
    let dir = tempdir().unwrap();
    let path = dir.path().join("x.bin");
    std::fs::write(&path, [7u8, 0, 3, 0, 1, 0]).unwrap();
    let error = read_error(&path, &plain).say(Lang::En);
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
                Err(error) => assert!(error.say(Lang::En).contains(name), "{name} cut at {n}: {error}"),
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
                Err(error) => assert!(error.say(Lang::En).contains(name), "{name} byte {at}: {error}"),
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
