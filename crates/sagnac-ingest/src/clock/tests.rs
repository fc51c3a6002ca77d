use super::*;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

fn rounded(interval: f64, step: f64, start: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| ((start + i as f64 * interval) / step).round() * step).collect()
}

fn gaps(stamps: &[f64]) -> usize {
    let mut tracker = Tracker::new(Clock::probe(stamps).unwrap());
    (0..stamps.len())
        .filter(|&i| matches!(tracker.step(stamps[i], stamps.get(i + 1).copied()), Step::Gap { .. }))
        .count()
}

#[test]
fn as_many_stamps_as_the_longest_lag_are_enough() {
    for n in 2..40 {
        let stamps: Vec<f64> = (0..n).map(f64::from).collect();
        assert_eq!(Clock::probe(&stamps).unwrap().interval_s, 1.0, "{n}");
    }
}

#[test]
fn rounded_stamps_give_the_interval_and_no_gap() {
    for (interval, step) in [
        (0.001, 1e-3),
        (1.0 / 819.2, 1e-3),
        (0.00142, 1e-3),
        (0.0025, 1e-3),
        (1.0 / 64.0, 1e-3),
        (1.0 / 102.4, 1e-6),
        (10.06, 1.0),
        (0.01, 1e-2),
    ] {
        for start in [0.0, 1.7e9] {
            let t = rounded(interval, step, start, 5000);
            let clock = Clock::probe(&t).unwrap();
            assert!((clock.interval_s / interval - 1.0).abs() < 0.01, "{interval} {step} {start} {clock:?}");
            assert_eq!(gaps(&t), 0, "{interval} {step} {start}");
        }
    }
}

#[test]
fn every_nth_double_step_is_a_loss_unless_the_declared_rate_says_otherwise() {
    // 0, 1, 3, 4, 6 ... are the stamps of a clock that loses every third sample and of one 1.5 times slower.
    for (slow, step) in [(1.5, 1.0), (0.0012, 1e-3), (1.25, 1.0)] {
        let t = rounded(slow, step, 0.0, 6000);
        let lossy = Clock::probe(&t).unwrap();
        assert!((lossy.interval_s / step - 1.0).abs() < 1e-9, "{lossy:?}");
        assert!((lossy.ambiguous_with_s.unwrap() / slow - 1.0).abs() < 1e-3, "{lossy:?}");
        let clock = Clock::probe_with(&t, Some(1.0 / slow)).unwrap();
        assert!(
            (clock.interval_s / slow - 1.0).abs() < 1e-6 && clock.ambiguous_with_s.is_none(),
            "{clock:?}"
        );
        let lossy = Clock::probe_with(&t, Some(1.0 / step)).unwrap();
        assert!((lossy.interval_s / step - 1.0).abs() < 1e-9 && lossy.ambiguous_with_s.is_none());
    }
}

#[test]
fn gaps_of_one_sample_are_found_and_measured() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut t, mut now, mut missing) = (Vec::new(), 0.0f64, 0);
    for _ in 0..20_000 {
        t.push(now.round());
        let lost = rng.random_bool(0.0125);
        missing += u64::from(lost);
        now += if lost { 20.12 } else { 10.06 };
    }
    let mut tracker = Tracker::new(Clock::probe(&t).unwrap());
    let found: u64 = t
        .iter()
        .map(|&s| match tracker.step(s, None) {
            Step::Gap { missing, .. } => missing,
            _ => 0,
        })
        .sum();
    assert_eq!(found, missing);
    assert!((tracker.mean_interval_s() - 10.06).abs() < 1e-3);
}

#[test]
fn a_drifting_clock_makes_no_gap() {
    let t: Vec<f64> = (0..200_000).map(|i| f64::from(i) * 0.01 * (1.0 + 1e-6 * f64::from(i))).collect();
    assert_eq!(gaps(&t), 0);
}

#[test]
fn jitter_is_that_of_the_stamps() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    let t: Vec<f64> = (0..100_000)
        .map(|i| f64::from(i) * 0.015_625 + 33e-6 * (rng.random::<f64>() - 0.5) * 12f64.sqrt())
        .collect();
    let mut tracker = Tracker::new(Clock::probe(&t).unwrap());
    assert_eq!(tracker.step(t[0], None), Step::Next);
    assert!(tracker.take_unbroken(&t[1..]));
    assert!((tracker.jitter_s().unwrap() / 33e-6 - 1.0).abs() < 0.01);
    assert!((tracker.mean_interval_s() / 0.015_625 - 1.0).abs() < 1e-6);
}

#[test]
fn block_and_single_steps_agree() {
    let t = rounded(0.0157, 1e-4, 5.0, 1000);
    let clock = Clock::probe(&t).unwrap();
    let (mut a, mut b) = (Tracker::new(clock), Tracker::new(clock));
    a.step(t[0], None);
    assert!(a.take_unbroken(&t[1..]));
    t.iter().for_each(|&s| assert_eq!(b.step(s, None), Step::Next));
    assert!((a.mean_interval_s() - b.mean_interval_s()).abs() < 1e-15);
    assert!((a.jitter_s().unwrap() - b.jitter_s().unwrap()).abs() < 1e-12);
}

#[test]
fn duplicate_backward_and_stray_stamps_are_told_apart() {
    let clock = Clock::declared(1.0).unwrap();
    let mut tracker = Tracker::new(clock);
    let t = [0.0, 1.0, 1.0, 2.0, 1.5, 3.0, 500.0, 4.0, f64::NAN, 6.0];
    let steps: Vec<Step> = (0..t.len()).map(|i| tracker.step(t[i], t.get(i + 1).copied())).collect();
    assert_eq!(steps[2], Step::Duplicate);
    assert_eq!(steps[4], Step::Backward { back_s: 0.5 });
    assert_eq!(steps[5], Step::Next);
    assert_eq!(steps[6], Step::Stray { ahead_s: 497.0 });
    assert_eq!(steps[7], Step::Next);
    assert_eq!(steps[8], Step::Unusable);
    assert_eq!(steps[9], Step::Gap { missing: 1, step_s: 2.0, clock_set: false });
}

#[test]
fn a_clock_that_was_set_back_starts_afresh() {
    let mut tracker = Tracker::new(Clock::declared(1.0).unwrap());
    (0..5000).for_each(|i| assert_eq!(tracker.step(f64::from(i), None), Step::Next));
    let steps: Vec<Step> = (0..2000).map(|i| tracker.step(f64::from(i), None)).collect();
    assert!(steps[..1000].iter().all(|s| matches!(s, Step::Backward { .. })));
    assert_eq!(steps[1000], Step::SetBack { back_s: 3999.0 });
    assert!(steps[1001..].iter().all(|s| *s == Step::Next));
    assert_eq!(tracker.latest_s(), Some(4999.0 + 2.0 + 999.0));
}

#[test]
fn stamps_that_cannot_serve_are_refused() {
    assert_eq!(Clock::probe(&[1.0]), Err(ClockError::TooFew));
    assert_eq!(Clock::probe(&[f64::NAN; 9]), Err(ClockError::TooFew));
    assert_eq!(Clock::probe(&[3.0, 3.0, 3.0]), Err(ClockError::NotGrowing));
    // Each second row has the stamp of the one before, at random places: copied rows or coarse stamps.
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    let mut copied = Vec::new();
    for i in 0..5000 {
        copied.push(f64::from(i));
        if rng.random_bool(0.3) {
            copied.push(f64::from(i));
        }
    }
    assert!(matches!(Clock::probe(&copied), Err(ClockError::Coarse { .. })));
    let noise: Vec<f64> = (0..1000).map(|i| f64::from(i * i % 101)).collect();
    assert!(matches!(Clock::probe(&noise), Err(ClockError::Falling { .. })));
    assert!(matches!(Clock::declared(-5.0), Err(ClockError::Rate { .. })));
    assert!(matches!(Clock::declared(f64::NAN), Err(ClockError::Rate { .. })));
}

#[test]
fn lost_rows_do_not_stretch_a_clock_of_whole_seconds() {
    // Every stamp is a whole number of intervals; rows are lost without order.
    let lost = |i: u32| i.wrapping_mul(2_654_435_761) >> 16 < 650;
    for interval in [1.0, 10.0] {
        let stamps: Vec<f64> = (0..30_000).filter(|i| !lost(*i)).map(|i| f64::from(i) * interval).collect();
        let clock = Clock::probe(&stamps).unwrap();
        assert_eq!(clock.interval_s, interval);
        assert!(clock.gap_limit_s < 2.0 * interval, "{clock:?}");
    }
    // Stamps of a clock of 1.01 s, rounded to whole seconds, could be those of a clock of 1 s that loses rows.
    let rounded: Vec<f64> = (0..30_000).map(|i| (f64::from(i) * 1.01).round()).collect();
    let clock = Clock::probe(&rounded).unwrap();
    assert!(clock.ambiguous_with_s.is_some_and(|other| (other - 1.01).abs() < 1e-4), "{clock:?}");
}

/// Runs of equal stamps, as (stamp, how many).
fn runs(of: &[(f64, usize)]) -> Vec<f64> {
    of.iter().flat_map(|&(stamp, n)| std::iter::repeat_n(stamp, n)).collect()
}

#[test]
fn bunches_that_do_not_advance_on_the_whole_are_refused() {
    // Six rows at one stamp and six a second later, over and over: 1 stamp in 12 falls, too few to be refused for that.
    // From one pair of bunches to the next the stamps fall by 10 ms, by 1 us, or stay.
    for fall_s in [0.01, 1e-6, 0.0] {
        let pairs: Vec<(f64, usize)> =
            (0..40).flat_map(|i| [0.0, 1.0].map(|level| (level - fall_s * f64::from(i), 6))).collect();
        let stamps = runs(&pairs);
        assert_eq!(Clock::probe(&stamps), Err(ClockError::NotGrowing), "{fall_s}");
        assert_eq!(Clock::probe_with(&stamps, Some(12.0)), Err(ClockError::NotGrowing), "{fall_s}");
    }
    // The same two bunches, advancing by 12 s from pair to pair, are a clock.
    let pairs: Vec<(f64, usize)> =
        (0..40).flat_map(|i| [0.0, 6.0].map(|level| (level + 12.0 * f64::from(i), 6))).collect();
    assert!(Clock::probe(&runs(&pairs)).is_ok_and(|clock| (clock.interval_s - 1.0).abs() < 1e-9));
}

#[test]
fn bunches_of_huge_stamps_that_fall_give_no_clock() {
    // Found by fuzzing: each gave a clock with a negative interval.
    let low = -1.3476555094338099e28;
    let first = [
        (low, 2),
        (3.960403595484939e-11, 1),
        (low, 5),
        (0.0, 8),
        (low, 6),
        (0.0, 4),
        (-3.349720106301617e27, 1),
        (low, 1),
        (-1.34765550942469e28, 1),
        (0.0, 22),
        (-1.3476555094237502e28, 1),
        (-1.3476549265166972e28, 1),
        (low, 4),
        (0.0, 12),
        (-5.76491684961329e24, 1),
        (low, 1),
        (-1.3476549265166972e28, 1),
        (low, 4),
        (0.0, 7),
        (-1.3476550068432251e28, 1),
        (0.0, 1),
        (low, 4),
        (-1.347654911759302e28, 1),
        (0.0, 22),
    ];
    let second = [
        (-5.964482303445587e-37, 1),
        (0.0, 4),
        (-1.3476005151612314e28, 1),
        (0.0, 20),
        (-1.3476552946124327e28, 1),
        (low, 2),
        (-1.3476555070991438e28, 1),
        (0.0, 12),
        (-1.3476555094337971e28, 1),
        (0.0, 19),
        (-1.3476005151612314e28, 1),
        (low, 2),
        (-1.347654911759302e28, 1),
        (0.0, 17),
        (-1.3476555094338114e28, 1),
        (low, 1),
        (-1.3475270610654758e28, 1),
        (low, 3),
        (0.0, 2),
        (low, 2),
        (0.0, 21),
        (-1.347655509430532e28, 1),
        (low, 2),
        (0.0, 8),
        (-1.3476555095346778e28, 1),
        (low, 1),
        (-3.5992803225546133e25, 1),
        (low, 4),
        (0.0, 5),
    ];
    for found in [&first[..], &second[..]] {
        assert_eq!(Clock::probe(&runs(found)), Err(ClockError::NotGrowing));
    }
}

proptest::proptest! {
    #[test]
    fn every_clock_runs_forward(
        levels in proptest::collection::vec(-1e6f64..1e6, 2..6),
        places in proptest::collection::vec(0usize..6, 2..600),
    ) {
        let stamps: Vec<f64> = places.iter().map(|p| levels[p % levels.len()]).collect();
        if let Ok(clock) = Clock::probe(&stamps) {
            proptest::prop_assert!(clock.interval_s > 0.0 && clock.gap_limit_s >= clock.interval_s, "{:?}", clock);
        }
    }
}

#[path = "generator_tests.rs"]
mod generators;
