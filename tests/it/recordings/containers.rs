//! Recordings in containers: HDF5, TDMS, MCAP, ROS bags. The files were written by other tools; what they hold is known
//! in closed form (tests/fixtures/containers/README.md).

use crate::support::{sagnac, shipped};
use sagnac::i18n::{Lang, Localize};
use sagnac::ingest::{IngestError, IngestErrorKind, ReadOptions, Source, open_with};
use sagnac::recording::column_inference::infer;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tempfile::tempdir;

const ROWS: usize = 84;
/// 2026-01-02T03:04:05Z.
const START_S: f64 = 1_767_323_045.0;

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(shipped(&format!("tests/fixtures/containers/{name}")))
}

fn options(part: Option<&str>) -> ReadOptions {
    ReadOptions { part: part.map(str::to_owned), ..ReadOptions::default() }
}

fn open(name: &str, part: Option<&str>) -> Result<Source, IngestError> {
    open_with(&fixture(name), &options(part))
}

/// Every column of numbers, by name.
fn columns(source: &Source) -> Result<Vec<(String, Vec<f64>)>, IngestError> {
    let wanted: Vec<usize> = (0..source.columns().len()).filter(|&i| source.columns()[i].numeric).collect();
    let mut out: Vec<(String, Vec<f64>)> =
        wanted.iter().map(|&i| (source.columns()[i].name.clone(), Vec::new())).collect();
    source.read(&wanted, &mut |block| {
        for (values, (_, all)) in block.columns.iter().zip(&mut out) {
            all.extend(values);
        }
        ControlFlow::Continue(())
    })?;
    Ok(out)
}

fn column(name: &str, part: Option<&str>, column: &str) -> Vec<f64> {
    let source = open(name, part).unwrap();
    columns(&source).unwrap().into_iter().find(|(n, _)| n == column).unwrap().1
}

fn rate(k: usize) -> f64 {
    ((7919 * k) % 101) as f64 / 8.0
}

fn rows(value: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..ROWS).map(value).collect()
}

fn notes(source: &Source) -> String {
    source.notes().iter().map(|n| n.say(Lang::En)).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_format_gives_the_numbers_that_were_written() {
    for name in ["v0.h5", "v3.h5", "compound.h5", "wave.tdms", "scaled.tdms", "matlab73.mat"] {
        let rate_name = if name == "matlab73.mat" { "gyro_1" } else { "rate" };
        assert_eq!(column(name, None, rate_name), rows(rate), "{name}");
        assert_eq!(column(name, None, "time"), rows(|k| k as f64 / 64.0), "{name}");
    }
    assert_eq!(column("matlab73.mat", None, "gyro_3"), rows(|k| 2.0 * rate(k)));
    assert_eq!(column("chunked.h5", None, "rate"), rows(rate));
    assert_eq!(column("chunked.h5", None, "time_ns"), rows(|k| k as f64 / 64.0));
    assert_eq!(column("chunked.h5", None, "temp"), rows(|k| 25.0 + k as f64 / 8.0));
    assert_eq!(column("wave.tdms", None, "temp"), rows(|k| 25.0 + k as f64 / 8.0));
    for name in ["zstd.mcap", "lz4.mcap", "lz4.bag"] {
        let source = open(name, None).unwrap();
        let gyros = source.columns().iter().filter(|c| infer(&c.name, c.unit.as_deref()).role.is_gyro());
        assert_eq!(gyros.count(), 3, "{name}: the three angular velocities and nothing else");
        assert_eq!(column(name, None, "angular_velocity.x"), rows(rate), "{name}");
        assert_eq!(column(name, None, "angular_velocity.z"), rows(|k| 2.0 * rate(k)), "{name}");
        assert_eq!(column(name, None, "orientation.w"), rows(|_| 1.0), "{name}");
        assert_eq!(column(name, None, "linear_acceleration.z"), rows(|_| 9.81), "{name}");
        assert_eq!(column(name, None, "header.stamp"), rows(|k| k as f64 / 64.0), "{name}");
        let logged = column(name, None, "log_time");
        let off = logged.iter().zip(0..).map(|(t, k)| (t - f64::from(k) / 64.0 - 1e-3).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12, "{name}: {logged:?}");
    }
}

#[test]
fn what_the_file_says_of_itself_is_kept() {
    for (name, column, unit, epoch_s, rate_hz) in [
        ("v0.h5", "rate", "deg/h", None, Some(64.0)),
        ("v3.h5", "time", "s", None, Some(64.0)),
        ("chunked.h5", "time_ns", "s", Some(START_S), None),
        ("matlab73.mat", "time", "", None, Some(64.0)),
        ("wave.tdms", "time", "s", Some(START_S), Some(64.0)),
        ("wave.tdms", "temp", "degC", None, Some(64.0)),
        ("scaled.tdms", "time", "s", Some(START_S), None),
        ("zstd.mcap", "header.stamp", "s", Some(START_S), None),
        ("lz4.bag", "log_time", "s", Some(START_S), None),
        ("lz4.mcap", "angular_velocity.x", "rad/s", None, None),
    ] {
        let source = open(name, None).unwrap();
        let found = source.columns().iter().find(|c| c.name == column).unwrap();
        assert_eq!(found.unit.as_deref().unwrap_or(""), unit, "{name} {column}");
        assert_eq!(found.epoch_s, epoch_s, "{name} {column}");
        assert_eq!(source.stated_sample_rate_hz(), rate_hz, "{name}");
    }
    for name in ["v0.h5", "v3.h5", "wave.tdms"] {
        let source = open(name, None).unwrap();
        assert!(
            source.metadata().contains(&("serial".into(), "SN-7".into())),
            "{name}: {:?}",
            source.metadata()
        );
    }
    assert!(notes(&open("wave.tdms", None).unwrap()).contains("2026-01-02T03:04:05"));
}

#[test]
fn a_scale_that_is_not_known_leaves_the_channel_out() {
    let source = open("scaled.tdms", None).unwrap();
    let pt100 = source.columns().iter().find(|c| c.name == "pt100").unwrap();
    assert!(!pt100.numeric);
    let said = notes(&source);
    for fragment in ["`pt100`", "`RTD`", "`short` (7)"] {
        assert!(said.contains(fragment), "{fragment}: {said}");
    }
}

#[test]
fn the_same_record_gives_the_same_deviations_in_every_format() {
    let dir = tempdir().unwrap();
    let deviations = |name: &str, column: &str, unit: &str| {
        let path = fixture(name);
        let args = ["analyze", path.to_str().unwrap(), "--rate", column, "--unit", unit, "--out", name];
        let said = sagnac(dir.path(), &args);
        assert_eq!(said.code, 0, "{name}: {said:?}");
        std::fs::read(dir.path().join(name).join("sigma_tau.csv")).unwrap()
    };
    let expected = deviations("recording.csv", "rate", "deg/h");
    assert!(expected.len() > 200);
    for name in ["v0.h5", "v3.h5", "chunked.h5", "compound.h5", "wave.tdms", "scaled.tdms"] {
        assert_eq!(deviations(name, "rate", "deg/h"), expected, "{name}");
    }
    assert_eq!(deviations("matlab73.mat", "gyro_1", "deg/h"), expected);
    let expected = deviations("messages.csv", "angular_velocity.x", "rad/s");
    for name in ["zstd.mcap", "lz4.mcap", "lz4.bag"] {
        assert_eq!(deviations(name, "angular_velocity.x", "rad/s"), expected, "{name}");
    }
}

fn refused(name: &str, part: Option<&str>, fragments: &[&str]) {
    let Err(error) = open(name, part).map(|_| ()) else { panic!("{name} was read") };
    let said = error.say(Lang::En);
    for fragment in [&[name], fragments].concat() {
        assert!(said.contains(fragment), "{name}: no `{fragment}` in {said}");
    }
    let russian = error.say(Lang::Ru);
    assert!(russian.chars().any(|c| ('а'..='я').contains(&c)), "{russian}");
}

#[test]
fn several_parts_are_listed_and_one_can_be_named() {
    refused("two.h5", None, &["`/left` (rate, short, time: 40 rows)", "`/right`", "say which"]);
    refused("two.h5", Some("middle"), &["`middle`", "`/left`"]);
    assert_eq!(column("two.h5", Some("left"), "rate"), (0..40).map(rate).collect::<Vec<_>>());
    assert_eq!(column("two.h5", Some("/right/short"), "short"), (0..7).map(rate).collect::<Vec<_>>());
    refused("two.mcap", None, &["`/imu/a` (sensor_msgs/msg/Imu, 20)", "`/imu/b`", "which topic"]);
    refused("two.mcap", Some("/imu/c"), &["`/imu/c`", "`/imu/a`"]);
    refused("two.mcap", Some("/log"), &["std_msgs/msg/String", "`/imu/b`"]);
    assert_eq!(
        column("two.mcap", Some("/imu/b"), "angular_velocity.x"),
        (0..20).map(rate).collect::<Vec<_>>()
    );
    assert_eq!(column("zstd.mcap", Some("/temp"), "data"), [25.0, 30.0, 35.0]);
    refused("bz2.bag", None, &["`bz2`", "rosbag decompress"]);
}

fn refused_bytes(bytes: &[u8], fragments: &[&str]) {
    let dir = tempdir().unwrap();
    let path = dir.path().join("recording.bin");
    std::fs::write(&path, bytes).unwrap();
    let Err(error) = open_with(&path, &options(None)).and_then(|s| columns(&s).map(|_| ())) else {
        panic!("the file was read, expected {fragments:?}")
    };
    let said = error.say(Lang::En);
    for fragment in fragments {
        assert!(said.contains(fragment), "no `{fragment}` in {said}");
    }
}

#[test]
fn what_is_not_read_is_refused_with_advice() {
    refused_bytes(b"SQLite format 3\0and more", &["SQLite", "ros2 bag convert"]);
    let mut daqmx = std::fs::read(fixture("wave.tdms")).unwrap();
    // The bit of raw DAQmx values in the first lead-in.
    daqmx[4] |= 1 << 7;
    refused_bytes(&daqmx, &["DAQmx", "byte 0"]);
    let mut checksum = std::fs::read(fixture("zstd.mcap")).unwrap();
    // The checksum of the first chunk: after magic, header record, code, length, two times and the size.
    let header = u64::from_le_bytes(checksum[9..17].try_into().unwrap()) as usize;
    let at = 8 + 9 + header + 9 + 24;
    assert_eq!(checksum[8 + 9 + header], 6, "the record is a chunk");
    checksum[at] ^= 1;
    refused_bytes(&checksum, &["checksum"]);
}

#[test]
fn a_file_that_breaks_off_is_read_as_far_as_it_goes() {
    let dir = tempdir().unwrap();
    for (name, cut, at_least) in [("wave.tdms", 300, 80), ("lz4.mcap", 2500, 25), ("lz4.bag", 2500, 25)] {
        let whole = std::fs::read(fixture(name)).unwrap();
        let path = dir.path().join(name);
        std::fs::write(&path, &whole[..whole.len() - cut]).unwrap();
        let source = open_with(&path, &options(None));
        let source = source.unwrap_or_else(|e| panic!("{e}"));
        let column = if name == "wave.tdms" { "rate" } else { "angular_velocity.x" };
        let found = columns(&source).unwrap().into_iter().find(|(n, _)| n == column).unwrap().1;
        assert!(found.len() >= at_least && found.len() < ROWS, "{name}: {}", found.len());
        assert_eq!(found, (0..found.len()).map(rate).collect::<Vec<_>>(), "{name}");
        assert!(notes(&source).contains("as far as it goes"), "{name}: {}", notes(&source));
    }
}

/// An MCAP file without chunks: temperatures of 1, 2, 3 ... degC, of which message 2 is cut.
fn mcap_with_a_short_message() -> Vec<u8> {
    let text = |t: &str| [&(t.len() as u32).to_le_bytes()[..], t.as_bytes()].concat();
    let record = |code: u8, body: Vec<u8>| [&[code][..], &(body.len() as u64).to_le_bytes(), &body].concat();
    let mut file = b"\x89MCAP0\r\n".to_vec();
    file.extend(record(1, [text("ros2"), text("by hand")].concat()));
    let schema = [&1u16.to_le_bytes()[..], &text("sensor_msgs/msg/Temperature"), &text("ros2msg"), &text("")];
    file.extend(record(3, schema.concat()));
    let channel =
        [&1u16.to_le_bytes()[..], &1u16.to_le_bytes(), &text("/t"), &text("cdr"), &0u32.to_le_bytes()];
    file.extend(record(4, channel.concat()));
    for k in 1..=3u32 {
        // Stamp 10 s + k, an empty frame (one zero), three bytes of padding, temperature, variance.
        let mut data = vec![0, 1, 0, 0];
        [10 + k, 0, 1].iter().for_each(|w| data.extend(w.to_le_bytes()));
        data.extend([0, 0, 0, 0]);
        data.extend(f64::from(k).to_le_bytes());
        data.extend(0f64.to_le_bytes());
        data.truncate(if k == 2 { 21 } else { data.len() });
        let log = u64::from(20 + k) * 1_000_000_000;
        let head = [&1u16.to_le_bytes()[..], &k.to_le_bytes(), &log.to_le_bytes(), &log.to_le_bytes()];
        file.extend(record(5, [head.concat(), data].concat()));
    }
    file.extend(record(15, vec![0; 4]));
    file
}

#[test]
fn a_message_that_ends_early_is_a_located_fault() {
    let dir = tempdir().unwrap();
    let path = dir.path().join("t.mcap");
    std::fs::write(&path, mcap_with_a_short_message()).unwrap();
    let source = open_with(&path, &options(Some("/t"))).unwrap();
    let names: Vec<&str> = source.columns().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["header.stamp", "log_time", "temperature", "variance"]);
    let mut seen = Vec::new();
    source
        .read(&[0, 1, 2], &mut |block| {
            assert_eq!(block.columns[1], [0.0, 1.0, 2.0]);
            assert_eq!((block.columns[2][0], block.columns[2][2]), (1.0, 3.0));
            assert!(block.columns[2][1].is_nan());
            assert_eq!((&block.unparsable[..], &block.non_finite[..]), (&[1, 0, 1][..], &[0, 0, 0][..]));
            seen.extend(block.faults.iter().map(|f| (f.slot, f.row, f.text.clone())));
            ControlFlow::Continue(())
        })
        .unwrap();
    let text = "message of 21 bytes".to_owned();
    assert_eq!(seen, [(0, 2, text.clone()), (2, 2, text)]);
}

/// A TDMS file in big-endian order with interleaved values, written by hand: rate -k as i16 and b k/4 as f64. The second
/// segment says nothing of its channels, the third was left open after one row and a piece.
fn interleaved_tdms() -> Vec<u8> {
    const VALUES: u32 = 1 << 3 | 1 << 5 | 1 << 6;
    let text = |t: &str| [&(t.len() as u32).to_be_bytes()[..], t.as_bytes()].concat();
    let channel = |path: &str, kind: u32| {
        let numbers = [20u32, kind, 1].map(u32::to_be_bytes).concat();
        [text(path), numbers, 3u64.to_be_bytes().to_vec(), 0u32.to_be_bytes().to_vec()].concat()
    };
    let metadata = [2u32.to_be_bytes().to_vec(), channel("/'g'/'rate'", 2), channel("/'g'/'b'", 10)].concat();
    let row = |k: i16| [&(-k).to_be_bytes()[..], &(f64::from(k) / 4.0).to_be_bytes()].concat();
    let segment = |toc: u32, metadata: &[u8], values: &[u8], open: bool| {
        let length = if open { u64::MAX } else { (metadata.len() + values.len()) as u64 };
        let mut out = b"TDSm".to_vec();
        out.extend(toc.to_le_bytes());
        out.extend(4713u32.to_be_bytes());
        out.extend(length.to_be_bytes());
        out.extend((metadata.len() as u64).to_be_bytes());
        out.extend(metadata);
        out.extend(values);
        out
    };
    let rows = |range: std::ops::Range<i16>| range.flat_map(row).collect::<Vec<u8>>();
    let mut broken = rows(9..11);
    broken.truncate(15);
    [
        segment(VALUES | 1 << 1 | 1 << 2, &metadata, &rows(0..6), false),
        segment(VALUES, &[], &rows(6..9), false),
        segment(VALUES, &[], &broken, true),
    ]
    .concat()
}

#[test]
fn interleaved_and_big_endian_values_are_read() {
    let dir = tempdir().unwrap();
    let path = dir.path().join("interleaved.tdms");
    std::fs::write(&path, interleaved_tdms()).unwrap();
    let source = open_with(&path, &options(None)).unwrap();
    let found = columns(&source).unwrap();
    assert_eq!(found[0], ("rate".to_owned(), (0..10).map(|k| -f64::from(k)).collect()));
    assert_eq!(found[1], ("b".to_owned(), (0..10).map(|k| f64::from(k) / 4.0).collect()));
    assert!(notes(&source).contains("as far as it goes"), "{}", notes(&source));
}

/// Numbers that depend on the seed alone.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

/// Reads whatever stands at a path: numbers or a diagnostic, and no thread that broke.
fn survives(path: &Path, what: &str) {
    let outcome = open_with(path, &options(None)).and_then(|s| columns(&s).map(|_| ()));
    if let Err(e) = outcome {
        let said = e.say(Lang::En);
        assert!(said.contains("damaged"), "{what}: the file is not named in {said}");
        assert_ne!(e.message().id, "ingest.thread_stopped", "{what}: {said}");
        assert_ne!(e.kind(), IngestErrorKind::Changed, "{what}: {said}");
    }
}

#[test]
fn a_damaged_file_gives_numbers_or_a_diagnostic() {
    // More rounds on demand: SAGNAC_DAMAGE_ROUNDS=100000.
    let rounds = std::env::var("SAGNAC_DAMAGE_ROUNDS").ok().and_then(|r| r.parse().ok()).unwrap_or(120);
    let seed = std::env::var("SAGNAC_DAMAGE_SEED").ok().and_then(|r| r.parse().ok()).unwrap_or(7);
    let dir = tempdir().unwrap();
    let path = dir.path().join("damaged");
    let mut random = Random(seed);
    let names = [
        "v0.h5",
        "v3.h5",
        "chunked.h5",
        "compound.h5",
        "matlab73.mat",
        "wave.tdms",
        "scaled.tdms",
        "zstd.mcap",
        "lz4.mcap",
        "lz4.bag",
    ];
    for name in names {
        let whole = std::fs::read(fixture(name)).unwrap();
        assert!(whole.len() < 10 << 10, "{name}");
        for round in 0..rounds {
            let mut bytes = whole.clone();
            if round % 3 == 0 {
                bytes.truncate(1 + random.below(whole.len() - 1));
            }
            for _ in 0..random.below(4).max(usize::from(round % 3 != 0)) {
                // Most of what holds a file together stands at its start.
                let reach = if random.below(2) == 0 { bytes.len().min(1200) } else { bytes.len() };
                let at = random.below(reach);
                bytes[at] = match random.below(4) {
                    0 => 0,
                    1 => 0xff,
                    2 => bytes[at] ^ 1 << random.below(8),
                    _ => random.below(256) as u8,
                };
            }
            std::fs::write(&path, &bytes).unwrap();
            survives(&path, &format!("{name}, round {round}, seed {seed}"));
        }
    }
}
