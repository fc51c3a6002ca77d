use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

fn gauss(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..n).map(|_| Distribution::<f64>::sample(&StandardNormal, &mut rng)).collect()
}

fn rounded(values: &[f64], step: f64) -> Vec<f64> {
    values.iter().map(|v| (v / step).round() * step).collect()
}

fn found(values: &[f64]) -> (u64, Vec<Repeat>) {
    let mut repeats = RepetitionCheck::new(1.0);
    let mut at = 0;
    // Uneven pieces, so that no result hangs on where a block ends.
    for length in [1, 700, 1024, 3].iter().cycle() {
        if at >= values.len() {
            break;
        }
        let end = (at + length).min(values.len());
        repeats.take(&values[at..end], Place { row: at as u64 + 1, time_s: at as f64 });
        at = end;
    }
    repeats.finish()
}

/// The samples with some of them put in again at a place.
fn doubled(values: &[f64], from: usize, length: usize, at: usize) -> Vec<f64> {
    let mut out = values[..at].to_vec();
    out.extend_from_slice(&values[from..from + length]);
    out.extend_from_slice(&values[at..]);
    out
}

#[test]
fn a_block_put_in_again_is_found_where_it_stands() {
    let clean = rounded(&gauss(40_000, 1), 1e-4);
    for (from, length, at) in
        [(500, 50, 550), (9_000, 2_000, 11_000), (100, 50, 39_000), (20_000, 60, 20_060)]
    {
        let (count, list) = found(&doubled(&clean, from, length, at));
        assert_eq!(list.len(), 1, "{from} {length} {at}: {list:?}");
        assert_eq!((count, list[0].length), (length as u64, length as u64));
        assert_eq!((list[0].place.row, list[0].first_row), (at as u64 + 1, from as u64 + 1));
        assert_eq!(list[0].place.time_s, at as f64);
    }
    let (count, list) = found(&doubled(&clean, 0, 40_000, 40_000));
    assert_eq!((count, list.len(), list[0].place.row, list[0].first_row), (40_000, 1, 40_001, 1));
}

#[test]
fn long_records_keep_fewer_anchors_and_find_long_blocks_still() {
    let clean = gauss(3_000_000, 2);
    let (count, list) = found(&doubled(&clean, 100_000, 5_000, 2_500_000));
    assert_eq!(list.len(), 1);
    assert!(count <= 5_000 && count > 4_000, "{count}");
    let ahead = list[0].place.row - 2_500_001;
    assert!(ahead < 500 && list[0].first_row - 100_001 == ahead, "{list:?}");
}

#[test]
fn coarse_values_ask_for_longer_blocks_and_show_them() {
    for (step, length) in [(0.2, 100), (0.5, 200), (1.0, 400), (2.0, 1000)] {
        let clean = rounded(&gauss(60_000, 3), step);
        assert_eq!(found(&clean), (0, vec![]), "step {step}");
        let (count, list) = found(&doubled(&clean, 5_000, length, 40_000));
        assert!(list.len() == 1 && count as usize >= length * 9 / 10, "step {step}: {count} {list:?}");
        assert!(count as usize <= length + 60, "step {step}: {count}");
    }
}

#[test]
fn a_wave_without_noise_repeats_and_no_sample_counts_twice() {
    let wave: Vec<f64> = (0..50_000).map(|i| (f64::from(i % 250) * 0.025_132_741_2).sin()).collect();
    assert_eq!(found(&wave).0, 49_750);
}

#[test]
fn regular_and_stuck_outputs_are_no_repeats() {
    // Increments of a counter that turns steadily: 0, 0, 1, 0, 1, ... without noise.
    let steady = |rate: f64| -> Vec<f64> {
        (0..50_000).map(|i| (f64::from(i + 1) * rate).floor() - (f64::from(i) * rate).floor()).collect()
    };
    for rate in [0.37, 0.05, 2.720_281_828, 0.5] {
        assert_eq!(found(&steady(rate)), (0, vec![]), "{rate}");
    }
    assert_eq!(found(&[1.25; 50_000]).0, 0);
    let mut stuck = rounded(&gauss(20_000, 4), 1e-3);
    stuck[3_000..3_100].fill(0.5);
    stuck[9_000..9_400].fill(0.5);
    assert_eq!(found(&stuck), (0, vec![]));
    let held: Vec<f64> = gauss(4_000, 5).iter().flat_map(|v| [*v; 10]).collect();
    assert_eq!(found(&held), (0, vec![]));
}

/// Clean records of many kinds: white, coarse from a hundredth to five standard deviations, walking, smoothed, counts of
/// a slow turn with and without noise.
fn clean(kind: usize, seed: u64, n: usize) -> Vec<f64> {
    let noise = gauss(n, seed);
    let mut drift = 0.0;
    match kind {
        0 => noise,
        1 => rounded(&noise, 0.01),
        2 => rounded(&noise, 0.3),
        3 => rounded(&noise, 1.0),
        4 => rounded(&noise, 3.0),
        5 => rounded(&noise, 5.0),
        6 => {
            let walk: Vec<f64> = noise
                .iter()
                .map(|v| {
                    drift += 0.05 * v;
                    drift
                })
                .collect();
            rounded(&walk, 0.2)
        }
        7 => rounded(&noise.windows(20).map(|w| w.iter().sum::<f64>() / 20.0).collect::<Vec<_>>(), 0.05),
        8 => {
            let mut before = 0.0;
            noise
                .iter()
                .map(|v| {
                    drift += 0.37 + 0.1 * v;
                    let step = drift.floor() - before;
                    before = drift.floor();
                    step
                })
                .collect()
        }
        _ => {
            (0..n).map(|i| (i as f64 * 0.6180339).floor() - ((i as f64 - 1.0) * 0.6180339).floor()).collect()
        }
    }
}

#[test]
fn clean_records_of_many_kinds_show_no_repeat() {
    for kind in 0..10 {
        for seed in 0..5 {
            assert_eq!(found(&clean(kind, 100 + seed, 20_000)), (0, vec![]), "kind {kind}, seed {seed}");
        }
    }
}

#[test]
#[ignore = "takes a minute; the short form is `clean_records_of_many_kinds_show_no_repeat`"]
fn false_repeats_stay_at_the_stated_rate() {
    let mut false_alarms = [0; 10];
    for seed in 0..250 {
        for (kind, count) in false_alarms.iter_mut().enumerate() {
            *count += u32::from(found(&clean(kind, 5000 + seed, 20_000)).0 > 0);
        }
    }
    println!("of 250 records of each kind: {false_alarms:?}");
    assert_eq!(false_alarms, [0; 10]);
}
