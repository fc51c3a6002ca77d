use super::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac_core::recording::{ColumnRef, Role};
use sagnac_core::units::Unit;

fn channel(role: Role) -> Channel {
    Channel {
        id: "x".to_owned(),
        column: ColumnRef::Position(1),
        role,
        unit: Unit::parse("1").unwrap(),
        scale: 1.0,
    }
}

fn check(
    values: &[f64],
    role: Role,
) -> (ValueFacts, ValueFaults, Vec<sagnac_core::recording::integrity::Fault>) {
    let mut checks = ValueChecks::new(&[channel(role)], 0.01);
    // Uneven sample blocks, so that no result hangs on where a block ends.
    let mut at = 0;
    for length in [1usize, 7, 1000, 40_000, 3].iter().cycle() {
        if at >= values.len() {
            break;
        }
        let end = (at + length).min(values.len());
        let part = vec![values[at..end].to_vec()];
        checks.push(&SampleBlock {
            first_index: at as u64,
            first_row: at as u64 + 1,
            time_s: at as f64 * 0.01,
            continues: at > 0,
            values: &part,
        });
        at = end;
    }
    let mut log = FaultLog::default();
    let (facts, faults) = checks.finish(&mut log);
    (facts[0], faults, log.into_list())
}

fn gauss(n: usize, sigma: f64, rng: &mut impl Rng) -> Vec<f64> {
    (0..n).map(|_| 7.5 + sigma * Distribution::<f64>::sample(&StandardNormal, rng)).collect()
}

fn on_grid(values: &[f64], step: f64) -> Vec<f64> {
    values.iter().map(|v| (v / step).round() * step).collect()
}

fn rng(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed)
}

#[test]
fn gaussian_records_show_no_fault() {
    let mut rng = rng(1);
    let mut flagged = 0;
    for _ in 0..40 {
        let values = gauss(100_000, 1.0, &mut rng);
        let (_, faults, list) = check(&values, Role::Rate);
        flagged += faults.outliers;
        assert_eq!((faults.saturated, faults.stuck), (0, 0), "{list:?}");
    }
    // 0.02 are expected in a record.
    assert!(flagged <= 4, "{flagged} outliers in 4 million Gaussian samples");
}

#[test]
fn coarse_records_show_no_fault_whatever_the_step() {
    let mut rng = rng(2);
    for step in [0.05, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0] {
        let values = on_grid(&gauss(200_000, 1.0, &mut rng), step);
        let (facts, faults, list) = check(&values, Role::Rate);
        assert_eq!((faults.saturated, faults.stuck), (0, 0), "step {step}: {list:?}");
        if step < 2.0 {
            assert_eq!(faults.outliers, 0, "step {step}: {list:?}");
        }
        if step < 3.0 {
            let found = facts.quantization_step.unwrap();
            assert!((found / step - 1.0).abs() < 1e-6, "step {step}: {found}");
        }
    }
}

#[test]
fn spikes_are_found_counted_and_placed() {
    let mut values = gauss(50_000, 1.0, &mut rng(3));
    for (row, size) in [(1, 12.0), (1024, -9.0), (1025, 9.0), (30_000, 40.0), (50_000, -15.0)] {
        values[row - 1] += size;
    }
    let (_, faults, list) = check(&values, Role::Rate);
    assert_eq!(faults.outliers, 5, "{list:?}");
    let rows: Vec<(u64, u64)> = list.iter().map(|f| (f.row, f.count)).collect();
    assert_eq!(rows, [(1, 1), (1024, 2), (30_000, 1), (50_000, 1)]);
    assert!((list[2].time_s.unwrap() - 299.99).abs() < 1e-9);
}

#[test]
fn steps_and_ramps_are_no_outliers() {
    let mut rng = rng(4);
    for at in [500usize, 1000, 1023, 1024, 1030, 2040] {
        let mut values = gauss(20_000, 1.0, &mut rng);
        values.iter_mut().skip(at).for_each(|v| *v += 50.0);
        let (_, faults, list) = check(&values, Role::Rate);
        assert_eq!(faults.outliers, 0, "step at {at}: {list:?}");
    }
    let ramp: Vec<f64> =
        gauss(50_000, 1.0, &mut rng).iter().enumerate().map(|(i, v)| v + i as f64 * 0.5).collect();
    assert_eq!(check(&ramp, Role::Rate).1.outliers, 0);
}

#[test]
fn clipping_is_found_at_both_rails() {
    let values: Vec<f64> = gauss(100_000, 1.0, &mut rng(5)).iter().map(|v| v.clamp(5.0, 9.5)).collect();
    let expected = values.iter().filter(|v| **v == 5.0 || **v == 9.5).count() as u64;
    let (_, faults, list) = check(&values, Role::Rate);
    assert_eq!(faults.saturated, expected);
    assert_eq!(list.iter().filter(|f| f.kind == "saturated").count(), 2);
    let coarse = on_grid(&values, 0.05);
    let (_, faults, _) = check(&coarse, Role::Rate);
    assert!(faults.saturated >= expected, "{faults:?}");
}

#[test]
fn stuck_stretches_are_found_on_fine_and_coarse_values() {
    for (step, length) in [(0.0, 5), (0.05, 40), (1.0, 60)] {
        let mut values = gauss(100_000, 1.0, &mut rng(6));
        if step > 0.0 {
            values = on_grid(&values, step);
        }
        let held = values[4999];
        values[5000..5000 + length].fill(held);
        values[5000 + length] = held + 1.0;
        let (_, faults, list) = check(&values, Role::Rate);
        assert!(faults.stuck >= length as u64 && faults.stuck <= length as u64 + 4, "{step}: {faults:?}");
        let stuck: Vec<_> = list.iter().filter(|f| f.kind == "stuck").collect();
        assert_eq!(stuck.len(), 1, "{list:?}");
        assert!(stuck[0].row <= 5000 && stuck[0].row >= 4997, "{stuck:?}");
    }
}

#[test]
fn many_stuck_stretches_do_not_hide_each_other() {
    let mut values = gauss(200_000, 1.0, &mut rng(7));
    for k in 0..100 {
        let held = values[2000 * k];
        values[2000 * k..2000 * k + 50].fill(held);
    }
    assert_eq!(check(&values, Role::Rate).1.stuck, 5000);
}

#[test]
fn a_held_output_is_remarked_on_and_not_called_stuck() {
    let values: Vec<f64> = gauss(20_000, 1.0, &mut rng(11)).iter().flat_map(|v| [*v; 10]).collect();
    let (_, faults, list) = check(&values, Role::Rate);
    assert_eq!(faults.stuck, 0);
    assert!(list.len() == 1 && list[0].seen.id == "fault_note.held", "{list:?}");
}

#[test]
fn a_temperature_may_repeat_but_is_remarked_on_when_it_never_changes() {
    let mut values = vec![25.1; 3000];
    values.extend(vec![25.2; 3000]);
    let (_, faults, list) = check(&values, Role::Temperature);
    assert_eq!((faults, list.len()), (ValueFaults::default(), 0));
    let (_, faults, list) = check(&[25.1; 3000], Role::Temperature);
    assert_eq!((faults.stuck, list.len(), list[0].count), (0, 1, 3000));
    let (_, faults, _) = check(&[1.0; 3000], Role::Rate);
    assert_eq!(faults.stuck, 3000);
}

#[test]
fn sums_hold_with_a_large_offset_and_holes() {
    let mut values: Vec<f64> = gauss(100_000, 1.0, &mut rng(8)).iter().map(|v| v + 1e9).collect();
    let exact = values.iter().skip(3).map(|v| v - 1e9).sum::<f64>() / 99_997.0;
    values[..3].fill(f64::NAN);
    let (facts, ..) = check(&values, Role::Rate);
    assert_eq!((facts.count, facts.non_finite), (99_997, 3));
    assert!((facts.mean - 1e9 - exact).abs() < 1e-6, "{} {exact}", facts.mean - 1e9);
    let (facts, ..) = check(&[f64::NAN; 10], Role::Rate);
    assert!(facts.mean.is_nan() && facts.count == 0 && facts.non_finite == 10);
}

#[test]
fn a_quantization_grid_is_found_where_there_is_one_and_only_there() {
    let mut rng = rng(9);
    let fine: Vec<f64> = gauss(50_000, 3.0, &mut rng).iter().map(|v| (v * 1e6).round() / 1e6).collect();
    let step = check(&fine, Role::Rate).0.quantization_step.unwrap();
    assert!((step / 1e-6 - 1.0).abs() < 1e-6, "{step}");
    // 0.05 deg/s in deg/h with an offset, as a real sensor gives it.
    let real: Vec<f64> =
        gauss(50_000, 8.0, &mut rng).iter().map(|v| v.round() * 0.05 * 3600.0 + 11.3).collect();
    let step = check(&real, Role::Rate).0.quantization_step.unwrap();
    assert!((step / 180.0 - 1.0).abs() < 1e-9, "{step}");
    // 30/256, written with four decimals.
    for deviation in [0.02, 0.1, 3.0] {
        let written: Vec<f64> = gauss(20_000, deviation, &mut rng)
            .iter()
            .map(|v| ((v * 256.0 / 30.0).round() * 30.0 / 256.0 * 1e4).round() / 1e4)
            .collect();
        let step = check(&written, Role::Rate).0.quantization_step.unwrap();
        assert!((step / (30.0 / 256.0) - 1.0).abs() < 1e-3, "{deviation}: {step}");
    }
    let smooth = gauss(50_000, 1.0, &mut rng);
    assert_eq!(check(&smooth, Role::Rate).0.quantization_step, None);
    let mut broken = real;
    broken[40_000] += 33.333_333_3;
    let step = check(&broken, Role::Rate).0.quantization_step;
    assert!(step.is_none_or(|s| s < 60.0), "{step:?}");
    assert_eq!(check(&vec![0.1; 100], Role::Rate).0.quantization_step, None);
    // An output that leaves its step late.
    let mut still = vec![2.4; 30_000];
    still[20_000] = 4.8;
    assert_eq!(check(&still, Role::Rate).0.quantization_step, Some(2.4));
    let _ = rng.random::<f64>();
}

/// The stated rate of false outliers, on records of a million samples: 0.02 are allowed in each. Coloured and coarse
/// noise go through the other tests of values as well.
#[test]
#[ignore = "takes a minute; the short form is `gaussian_records_show_no_fault`"]
fn false_alarms_stay_at_the_stated_rate() {
    let mut rng = rng(10);
    let records = 400;
    let (mut white, mut coarse, mut walk, mut other) = (0, 0, 0, 0);
    for _ in 0..records {
        let values = gauss(1_000_000, 1.0, &mut rng);
        let (_, faults, _) = check(&values, Role::Rate);
        white += faults.outliers;
        other += faults.stuck + faults.saturated;
        let (_, faults, _) = check(&on_grid(&values, 0.125), Role::Rate);
        coarse += faults.outliers;
        other += faults.stuck + faults.saturated;
        let mut drift = 0.0;
        let walking: Vec<f64> = values
            .iter()
            .zip(values.iter().rev())
            .map(|(v, w)| {
                drift += 0.02 * (w - 7.5);
                v + drift
            })
            .collect();
        let (_, faults, _) = check(&walking, Role::Rate);
        walk += faults.outliers;
        other += faults.stuck + faults.saturated;
    }
    println!(
        "{records} records: outliers white {white}, coarse {coarse}, random walk {walk}; other faults {other}"
    );
    // Three times the 8 that are expected.
    assert!(white <= 24 && coarse <= 24 && walk <= 24, "{white} {coarse} {walk}");
    assert_eq!(other, 0);
}
