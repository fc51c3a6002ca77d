//! Made clocks with known interval and known losses: what is found must be what was made. Fixed seeds.

use super::*;

/// What a generator does to a uniform clock.
#[derive(Debug, Clone, Copy)]
struct Made {
    interval: f64,
    start: f64,
    /// Share of samples lost at random.
    lost: f64,
    /// Every so many samples a burst of 5 to 60 is lost; 0: none.
    burst_every: u64,
    /// Peak of the uniform jitter, in intervals.
    jitter: f64,
    /// Step the stamps are rounded to; 0: none.
    round: f64,
    /// Step the stamps are cut to; 0: none.
    floor: f64,
    /// Rows that arrive together; 0: none.
    packet: u64,
    /// Change of the rate over the record, relative.
    drift: f64,
    /// Random-walk frequency noise: standard deviation of the step of the interval a sample, relative.
    wander: f64,
}

const EVEN: Made = Made {
    interval: 0.01,
    start: 0.0,
    lost: 0.0,
    burst_every: 0,
    jitter: 0.0,
    round: 0.0,
    floor: 0.0,
    packet: 0,
    drift: 0.0,
    wander: 0.0,
};

const ROWS: u64 = 40_000;

/// The stamps and the number of samples lost between the first and the last.
fn made(m: &Made, seed: u64) -> (Vec<f64>, u64) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let (mut t, mut now, mut interval) = (Vec::new(), 0.0, m.interval);
    let (mut missing, mut pending, mut burst, mut until_burst) = (0, 0, 0, m.burst_every);
    for i in 0..ROWS {
        let this = now;
        interval += m.interval * (m.wander * 3f64.sqrt() * (2.0 * rng.random::<f64>() - 1.0));
        now += interval * (1.0 + m.drift * i as f64 / ROWS as f64);
        if m.burst_every > 0 {
            until_burst -= 1;
            if until_burst == 0 {
                burst = rng.random_range(5..60);
                until_burst = m.burst_every;
            }
        }
        let lost = i > 0 && (burst > 0 || rng.random_bool(m.lost));
        burst = u64::saturating_sub(burst, 1);
        if lost {
            pending += 1;
            continue;
        }
        missing += pending;
        pending = 0;
        let mut stamp = m.start + this + m.interval * m.jitter * (2.0 * rng.random::<f64>() - 1.0);
        if m.packet > 0 {
            // Rows are stamped when their packet arrives, 20 µs apart.
            let place = i % m.packet;
            stamp = m.start + ((i / m.packet + 1) * m.packet) as f64 * m.interval + place as f64 * 20e-6;
        }
        if m.round > 0.0 {
            stamp = (stamp / m.round).round() * m.round;
        }
        if m.floor > 0.0 {
            stamp = (stamp / m.floor + 1e-9).floor() * m.floor;
        }
        t.push(stamp);
    }
    (t, missing)
}

/// Follows stamps as the stream does; interval, missing samples.
fn followed(t: &[f64]) -> (f64, u64, Clock) {
    let clock = Clock::probe(&t[..t.len().min(65_536)]).unwrap();
    let mut tracker = Tracker::new(clock);
    let mut missing = 0;
    let mut losses = Vec::new();
    if let Cadence::Buffered { .. } = clock.cadence {
        let mut batches = Batches::new(clock.interval_s);
        t.iter().for_each(|stamp| batches.push(*stamp));
        losses = batches.clock().unwrap().losses;
    }
    for (i, &stamp) in t.iter().enumerate() {
        losses.iter().filter(|l| l.row == i as u64).for_each(|l| tracker.note_loss(l.samples));
        match tracker.step(stamp, t.get(i + 1).copied()) {
            Step::Gap { missing: n, .. } => missing += n,
            Step::Next => {}
            other => panic!("row {i}: {other:?}"),
        }
    }
    (tracker.mean_interval_s(), missing, clock)
}

fn check(name: &str, m: Made, within: f64) -> String {
    let mut wrong = String::new();
    for seed in 0..4 {
        for start in [0.0, 1.7e9] {
            let m = Made { start, ..m };
            // Stamps from 1970 have a resolution of 0.24 µs in f64.
            if start > 0.0 && m.interval < 1e-3 {
                continue;
            }
            let (t, missing) = made(&m, seed);
            let (interval, found, clock) = followed(&t);
            let off = interval / m.interval - 1.0;
            if off.abs() > within || found != missing {
                wrong.push_str(&format!(
                    "{name} seed {seed} start {start}: off {off:e}, missing {found} of {missing}, {clock:?}\n"
                ));
            }
        }
    }
    wrong
}

#[test]
fn lost_samples_are_counted_and_the_interval_is_right() {
    let mut wrong = String::new();
    for interval in [0.001, 0.01, 1.0 / 102.4, 1.0, 10.06] {
        for lost in [0.0, 0.01, 0.1, 0.3, 0.5, 0.6] {
            let m = Made { interval, lost, ..EVEN };
            wrong += &check(&format!("lost {lost} of {interval}"), m, 1e-9);
            let m = Made { jitter: 0.02, ..m };
            wrong += &check(&format!("lost {lost} of {interval}, jitter 2 %"), m, 1e-6);
        }
        let m = Made { interval, burst_every: 2000, ..EVEN };
        wrong += &check(&format!("bursts of {interval}"), m, 1e-9);
        let m = Made { jitter: 0.1, ..m };
        wrong += &check(&format!("bursts of {interval}, jitter 10 %"), m, 1e-6);
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn jitter_up_to_thirty_per_cent_makes_no_gap_and_hides_none() {
    let mut wrong = String::new();
    for jitter in [0.1, 0.2, 0.3] {
        for lost in [0.0, 0.05, 0.3] {
            // Four standard errors of a slope through 40 000 stamps with that jitter.
            let within = 4.0 * jitter / 3f64.sqrt() * 12f64.sqrt() / (ROWS as f64).powf(1.5);
            let m = Made { jitter, lost, ..EVEN };
            wrong += &check(&format!("jitter {jitter}, lost {lost}"), m, within.max(1e-9));
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn rounded_stamps_with_losses_keep_their_count() {
    let mut wrong = String::new();
    for (interval, round) in
        [(0.0157, 1e-3), (0.0233, 1e-2), (0.0025, 1e-3), (1.0 / 409.6, 1e-3), (10.06, 1.0), (0.01, 1e-3)]
    {
        for lost in [0.0, 0.01, 0.2, 0.5] {
            let m = Made { interval, round, lost, ..EVEN };
            // A slope through rounded stamps is off by 1.5 roundings over the record at most.
            let within = 1.5 * round / (interval * ROWS as f64);
            wrong += &check(&format!("{interval} rounded to {round}, lost {lost}"), m, within);
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn shared_stamps_and_packets_give_the_mean_rate() {
    let mut wrong = String::new();
    for (interval, floor) in
        [(0.01, 1.0), (1.0 / 102.4, 1.0), (0.001, 0.01), (1.0 / 3.7, 1.0), (0.0004, 0.001)]
    {
        let m = Made { interval, floor, ..EVEN };
        let within = 1.5 * floor.min(interval) / (interval * ROWS as f64);
        wrong += &check(&format!("{interval} in stamps of {floor}"), m, within);
    }
    for packet in [4, 8, 32] {
        let m = Made { interval: 0.005, packet, ..EVEN };
        wrong += &check(&format!("packets of {packet}"), m, 1e-6);
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn lost_rows_are_counted_in_bunches_as_well_as_the_stamps_allow() {
    let (t, _) = made(&Made { floor: 1.0, ..EVEN }, 1);
    // 2345 rows are lost in the middle.
    let cut: Vec<f64> = t[..20_030].iter().chain(&t[22_375..]).copied().collect();
    let (interval, found, _) = followed(&cut);
    assert!((interval / 0.01 - 1.0).abs() < 1e-5, "{interval}");
    assert!(found.abs_diff(2345) <= 1, "{found}");
}

#[test]
fn a_clock_that_drifts_or_wanders_makes_no_gap() {
    let mut wrong = String::new();
    for (drift, wander) in [(1e-4, 0.0), (0.01, 0.0), (0.0, 1e-6), (0.0, 1e-5)] {
        for lost in [0.0, 0.3] {
            let m = Made { drift, wander, lost, jitter: 0.05, ..EVEN };
            wrong += &check(&format!("drift {drift}, wander {wander}, lost {lost}"), m, 0.05);
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn the_stated_uncertainty_covers_the_error() {
    let mut outside = 0;
    for seed in 0..40 {
        let (t, _) = made(&Made { jitter: 0.05, ..EVEN }, 100 + seed);
        let mut tracker = Tracker::new(Clock::probe(&t).unwrap());
        t.iter().for_each(|s| assert_eq!(tracker.step(*s, None), Step::Next));
        let m = tracker.measured().unwrap();
        outside += u32::from((m.interval_s - 0.01).abs() > 2.0 * m.uncertainty_s);
        assert!(
            m.uncertainty_s < 1e-9 && m.drift.is_none_or(|d| d.abs() < 5.0 * m.drift_uncertainty.unwrap())
        );
    }
    // Two standard deviations leave 2 of 40 outside; more than 6 has a probability below 1 %.
    assert!(outside <= 6, "{outside} of 40");
}
