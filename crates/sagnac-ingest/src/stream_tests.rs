use super::*;
use crate::MemoryColumn;
use crate::english::english;
use sagnac_core::recording::ColumnRef;
use sagnac_core::recording::SampleBlock;
use sagnac_core::units::Unit;

fn channel(id: &str, role: Role, unit: &str, scale: f64) -> Channel {
    Channel {
        id: id.to_owned(),
        column: ColumnRef::Name(id.to_owned()),
        role,
        unit: Unit::parse(unit).unwrap(),
        scale,
    }
}

/// A sample block as a sink gets it: first index, first row, time, continues, values.
type Kept = (u64, u64, f64, bool, Vec<Vec<f64>>);

#[derive(Default)]
struct Keep(Vec<Kept>);

impl Sink for Keep {
    fn push(&mut self, s: &SampleBlock<'_>) {
        self.0.push((s.first_index, s.first_row, s.time_s, s.continues, s.values.to_vec()));
    }
}

impl Keep {
    fn all(&self, channel: usize) -> Vec<f64> {
        self.0.iter().flat_map(|s| s.4[channel].clone()).collect()
    }

    /// Grid position and row of every sample.
    fn places(&self) -> Vec<(u64, u64)> {
        self.0.iter().flat_map(|s| (0..s.4[0].len() as u64).map(|k| (s.0 + k, s.1 + k))).collect()
    }
}

fn run(
    columns: Vec<(&str, Vec<f64>)>,
    channels: &[Channel],
    spec: TimeBaseSpec,
    block_rows: usize,
) -> Result<(Keep, StreamReport), IngestError> {
    let columns = columns.into_iter().map(|(n, c)| MemoryColumn::new(n, c)).collect();
    let source = Source::from_columns("memory", columns, block_rows)?;
    let mut keep = Keep::default();
    let report = stream(&source, channels, spec, &mut [&mut keep], &mut |_, _| {})?;
    Ok((keep, report))
}

#[test]
fn values_arrive_in_inside_units() {
    let t: Vec<f64> = (0..100).map(|i| f64::from(i) * 20.0).collect();
    let channels = [
        channel("t", Role::Time, "ms", 1.0),
        channel("r", Role::Rate, "deg/s", -1.0),
        channel("k", Role::Temperature, "K", 1.0),
        channel("n", Role::AngleIncrement, "arcsec", 0.5),
        channel("a", Role::Auxiliary, "g", 2.0),
    ];
    let columns = vec![
        ("t", t),
        ("r", vec![1.0; 100]),
        ("k", vec![293.15; 100]),
        ("n", vec![3.0; 100]),
        ("a", vec![4.0; 100]),
    ];
    let (keep, report) = run(columns, &channels, TimeBaseSpec::default(), 33).unwrap();
    assert_eq!(report.tau0_nominal_s, 0.02);
    assert!((keep.all(0)[99] - 1.98).abs() < 1e-12);
    assert_eq!(keep.all(1), vec![-3600.0; 100]);
    assert!(keep.all(2).iter().all(|v| (v - 20.0).abs() < 1e-9));
    // 1.5 arcsec in 0.02 s is 75 arcsec/s.
    assert!(keep.all(3).iter().all(|v| (v - 75.0).abs() < 1e-9));
    assert_eq!(keep.all(4), vec![8.0; 100]);
    assert_eq!(keep.0.iter().map(|s| s.3).collect::<Vec<_>>(), [false, true, true, true]);
    assert!((report.duration_s - 2.0).abs() < 1e-9);
    assert_eq!(report.channels[3].unit_inside, "deg/h");
}

#[test]
fn a_unit_that_does_not_fit_is_refused() {
    let columns = || vec![("r", vec![1.0; 10])];
    let spec =
        TimeBaseSpec { declared_sample_rate_hz: Some(10.0), use_stamps: true, ..TimeBaseSpec::default() };
    let e = run(columns(), &[channel("r", Role::Rate, "degC", 1.0)], spec, 5).err().unwrap();
    assert_eq!(e.kind(), IngestErrorKind::Unit);
    let e = run(columns(), &[channel("r", Role::Rate, "deg/h", 0.0)], spec, 5).err().unwrap();
    assert!(english(&e.note()).contains("scale"), "{e}");
    let e =
        run(columns(), &[channel("r", Role::Rate, "deg/h", 1.0)], TimeBaseSpec::default(), 5).err().unwrap();
    assert_eq!(e.kind(), IngestErrorKind::TimeBase);
    assert!(english(&e.note()).contains("declare the sample rate"), "{e}");
}

#[test]
fn faults_of_the_clock_are_the_same_wherever_a_block_ends() {
    let mut t: Vec<f64> = (0..3000).map(|i| f64::from(i) * 0.1).collect();
    t[500] = t[499];
    t[800] = 3.0;
    t[1200] = f64::NAN;
    for v in &mut t[2000..] {
        *v += 0.5;
    }
    let r: Vec<f64> = (0..3000).map(f64::from).collect();
    let channels = [channel("t", Role::Time, "s", 1.0), channel("r", Role::Rate, "deg/h", 1.0)];
    let mut first: Option<(Vec<(u64, u64)>, Integrity)> = None;
    for block_rows in [3000, 1000, 499, 500, 501, 7, 1] {
        let columns = vec![("t", t.clone()), ("r", r.clone())];
        let (keep, report) = run(columns, &channels, TimeBaseSpec::default(), block_rows).unwrap();
        let mut i = report.integrity;
        assert_eq!((i.duplicate_timestamps, i.backward_timestamps, i.non_finite), (1, 1, 1));
        // Each row set aside here stood where a good one should, so it leaves a gap of one sample.
        assert_eq!((i.gaps, i.missing_samples), (4, 8), "{:?}", i.faults);
        assert_eq!(report.rows_used, 2997);
        let rows: Vec<f64> = keep.places().iter().map(|p| p.1 as f64 - 1.0).collect();
        assert_eq!(keep.all(1), rows);
        i.timestamp_jitter_s = None;
        match &first {
            None => first = Some((keep.places(), i)),
            Some((places, integrity)) => {
                assert_eq!(*places, keep.places(), "{block_rows}");
                let kinds = |i: &Integrity| {
                    i.faults.iter().map(|f| (f.kind.clone(), f.row, f.count)).collect::<Vec<_>>()
                };
                assert_eq!(kinds(integrity), kinds(&i), "{block_rows}");
            }
        }
    }
    let places = first.unwrap().0;
    // Every used sample keeps its place on the grid: its time over the interval.
    for (index, row) in places {
        let on_grid = (t[row as usize - 1] / 0.1).round() as u64;
        assert_eq!(index, on_grid, "row {row}");
    }
}

#[test]
fn a_clock_set_back_makes_a_new_stretch_in_time() {
    let mut t: Vec<f64> = (0..10_000).map(|i| 5000.0 + f64::from(i)).collect();
    t.extend((0..10_000).map(|i| 3600.0 + f64::from(i)));
    let n = t.len();
    let channels = [channel("t", Role::Time, "s", 1.0), channel("r", Role::Rate, "deg/h", 1.0)];
    let (keep, report) =
        run(vec![("t", t), ("r", vec![0.5; n])], &channels, TimeBaseSpec::default(), 3000).unwrap();
    let i = &report.integrity;
    assert_eq!((i.gaps, i.missing_samples, i.backward_timestamps), (1, 1, 1001));
    assert_eq!(report.rows_used, 19_000);
    assert!(keep.0.windows(2).all(|w| w[0].2 < w[1].2), "time goes on");
    assert!((report.duration_s - 19_001.0).abs() < 1e-6, "{}", report.duration_s);
    assert!(i.faults.iter().any(|f| f.kind == "backward_timestamp" && f.seen.id == "fault_note.set_back"));
}

#[test]
fn without_stamps_rows_are_the_grid() {
    let spec =
        TimeBaseSpec { declared_sample_rate_hz: Some(100.0), use_stamps: false, ..TimeBaseSpec::default() };
    let channels = [channel("t", Role::Time, "s", 1.0), channel("r", Role::Rate, "deg/h", 1.0)];
    let columns = vec![("t", vec![7.0; 1000]), ("r", (0..1000).map(f64::from).collect())];
    let (keep, report) = run(columns, &channels, spec, 300).unwrap();
    assert_eq!((report.tau0_measured_s, report.duration_s), (0.01, 10.0));
    assert_eq!((report.integrity.gaps, report.integrity.timestamp_jitter_s), (0, None));
    assert_eq!(keep.0[1].2, 3.0);
}

#[test]
fn a_time_column_in_epoch_seconds_tells_the_start_when_its_name_says_so() {
    let t: Vec<f64> = (0..1000).map(|i| 1_700_000_000.0 + f64::from(i) * 0.01).collect();
    for (name, start) in [("unix_time_s", Some("2023-11-14T22:13:20.000Z".to_owned())), ("time_s", None)] {
        let channels = [channel(name, Role::Time, "s", 1.0), channel("r", Role::Rate, "deg/h", 1.0)];
        let columns = vec![(name, t.clone()), ("r", vec![1.0; 1000])];
        let (_, report) = run(columns, &channels, TimeBaseSpec::default(), 100).unwrap();
        assert_eq!(report.start, start);
        assert_eq!(report.integrity.gaps, 0);
        assert!((report.tau0_nominal_s - 0.01).abs() < 1e-7);
    }
}

#[test]
fn a_recording_with_no_usable_stamp_is_refused() {
    let channels = [channel("t", Role::Time, "s", 1.0), channel("r", Role::Rate, "deg/h", 1.0)];
    for t in [vec![f64::NAN; 100], vec![4.0; 100]] {
        let e =
            run(vec![("t", t), ("r", vec![1.0; 100])], &channels, TimeBaseSpec::default(), 10).err().unwrap();
        assert_eq!(e.kind(), IngestErrorKind::TimeBase, "{e}");
    }
}

proptest::proptest! {
    #[test]
    fn every_row_is_used_or_accounted_for(
        steps in proptest::collection::vec((0u8..40, -3i32..9), 2..400), block_rows in 1usize..50
    ) {
        let mut now = 0.0;
        let t: Vec<f64> = steps
            .iter()
            .map(|&(rare, jump)| {
                now += if rare == 0 { f64::from(jump) } else { 1.0 };
                if rare == 1 { f64::NAN } else { now }
            })
            .collect();
        let n = t.len() as u64;
        let channels = [channel("t", Role::Time, "s", 1.0), channel("r", Role::Rate, "deg/h", 1.0)];
        let rows = (1..=n).map(|i| i as f64).collect();
        let Ok((keep, report)) = run(vec![("t", t), ("r", rows)], &channels, TimeBaseSpec::default(), block_rows)
        else {
            return Ok(());
        };
        let i = &report.integrity;
        proptest::prop_assert_eq!(
            report.rows_used + i.duplicate_timestamps + i.backward_timestamps + i.non_finite,
            n
        );
        let mut end: Option<(u64, f64)> = None;
        let mut gaps = 0;
        for (index, row, time, continues, values) in &keep.0 {
            proptest::prop_assert_eq!(values[1][0], *row as f64);
            proptest::prop_assert_eq!(*continues, end.is_some_and(|e| e.0 == *index));
            if let Some((expected, last)) = end {
                proptest::prop_assert!(*index >= expected && *time > last);
                gaps += index - expected;
            }
            proptest::prop_assert!(values[0].windows(2).all(|w| w[1] > w[0]));
            end = Some((index + values[0].len() as u64, values[0][values[0].len() - 1]));
        }
        proptest::prop_assert_eq!(gaps, i.missing_samples);
    }
}
