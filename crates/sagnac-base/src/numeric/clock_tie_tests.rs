use super::*;

/// A generator of normal numbers of its own: xorshift and the polar method.
struct Generator(u64);

impl Generator {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        loop {
            let (u, v) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let s = u * u + v * v;
            if s > 0.0 && s < 1.0 {
                return u * (-2.0 * s.ln() / s).sqrt();
            }
        }
    }
}

/// Rate of a table that turns by steps of several sizes, with ramps between, deg/s.
fn table_rate(t: f64) -> f64 {
    let sizes = [0.0, 10.0, 0.0, -25.0, 5.0, 0.0, 40.0, -3.0];
    let step = t / 20.0;
    let of = |i: f64| sizes[(i.max(0.0) as usize * 5 + (i * i) as usize) % sizes.len()];
    let ramp = ((step - step.floor()) * 10.0).min(1.0);
    of(step.floor() - 1.0) * (1.0 - ramp) + of(step.floor()) * ramp
}

/// Records of both clocks.
struct Bench {
    fast: (Vec<f64>, Vec<f64>),
    slow: (Vec<f64>, Vec<f64>),
}

/// Standard deviations of an encoder, deg, and of the walk of an integrated rate, deg/√s.
const NOISES: [(f64, f64); 3] = [(0.01, 1e-4), (0.002, 0.01), (0.05, 0.002)];

/// What is wrong with the records of a table.
#[derive(Clone, Copy, PartialEq)]
enum Trouble {
    None,
    /// Both have gaps; over that of the gyro the angle is lost. A fiftieth of the rows of the table is missing.
    Gaps,
    /// The table ends long before the gyro.
    Ends,
    /// The table turns a thousandth as fast.
    Weak,
}

/// The integral of the rate of a gyro at 50 Hz for 400 s and the angle of the table at 5 Hz by a clock of its own.
fn table(of: &mut Generator, offset_s: f64, rate: f64, noises: (f64, f64), trouble: Trouble) -> Bench {
    let size = if trouble == Trouble::Weak { 1e-3 } else { 1.0 };
    let (mut angle, mut walk, lost) = (0.0, 0.0, 20.0 * of.normal());
    let (mut fast, mut truth) = ((vec![], vec![]), vec![]);
    for i in 0..20_000 {
        let t = 0.02 * f64::from(i);
        truth.push(angle);
        if trouble != Trouble::Gaps || !(120.0..132.0).contains(&t) {
            fast.0.push(t);
            fast.1
                .push(1.0005 * angle + walk + if trouble == Trouble::Gaps && t > 125.0 { lost } else { 0.0 });
        }
        angle += 0.02 * size * table_rate(t + 0.01);
        walk += noises.1 * 0.02f64.sqrt() * of.normal() + 1e-5;
    }
    let mut slow = (vec![], vec![]);
    for k in 100..if trouble == Trouble::Ends { 1400 } else { 1900 } {
        // The stamp of the table at a time of the gyro: t = s + offset + rate (s − 200).
        let s = 0.2 * f64::from(k) - offset_s;
        let t = s + offset_s + rate * (s - 200.0);
        if trouble == Trouble::Gaps && ((200.0..212.0).contains(&t) || of.uniform() < 0.02) {
            continue;
        }
        let (i, part) = ((t / 0.02).floor() as usize, t / 0.02 - (t / 0.02).floor());
        slow.0.push(s);
        slow.1.push(truth[i] * (1.0 - part) + truth[i + 1] * part + noises.0 * of.normal());
    }
    Bench { fast, slow }
}

/// The thermometer of a gyro, which follows the air of its chamber with a time constant, every second for 4 h, and that of
/// the chamber every 10 s by a clock of its own.
fn chamber(of: &mut Generator, offset_s: f64, rate: f64, lag_s: f64) -> Bench {
    let set = |t: f64| {
        let levels = [20.0, 20.0, 60.0, 60.0, -10.0, -10.0, 20.0, 20.0];
        let (i, part) = ((t / 1800.0).floor() as usize, ((t / 1800.0).fract() * 2.0).min(1.0));
        levels[i.min(6)] + (levels[i.min(6) + 1] - levels[i.min(6)]) * part
    };
    let (mut air, mut body) = (20.0, 20.0);
    let (mut fast, mut airs) = ((vec![], vec![]), vec![]);
    for i in 0..14_400 {
        airs.push(air);
        fast.0.push(f64::from(i));
        fast.1.push(body + 0.005 * of.normal());
        for part in 0..10 {
            air += 0.1 * (set(f64::from(i) + 0.1 * f64::from(part)) - air) / 60.0;
            body += if lag_s > 0.0 { 0.1 * (air - body) / lag_s } else { air - body };
        }
    }
    let mut slow = (vec![], vec![]);
    for k in 100..1340 {
        let s = 10.0 * f64::from(k) - offset_s;
        let t = s + offset_s + rate * (s - 7200.0);
        let (i, part) = (t.floor() as usize, t.fract());
        slow.0.push(s);
        slow.1.push(airs[i] * (1.0 - part) + airs[i + 1] * part + 0.02 * of.normal());
    }
    Bench { fast, slow }
}

fn tied(of: &Bench, range_s: f64, following: Following) -> Result<ClockTie, NoTie> {
    let timed = |(times_s, values): &'_ (Vec<f64>, Vec<f64>)| -> (Vec<f64>, Vec<f64>) {
        (times_s.clone(), values.clone())
    };
    let (fast, slow) = (timed(&of.fast), timed(&of.slow));
    let (fast, slow) =
        (Timed { times_s: &fast.0, values: &fast.1 }, Timed { times_s: &slow.0, values: &slow.1 });
    tie(fast, slow, range_s, following)
}

/// How many of the intervals of offset and rate hold the truth, of the clocks that are tied. The number of runs is that of
/// the test, or of the environment variable TIE_RUNS for the figures of the validation page.
struct Coverage {
    tied: u32,
    offsets: u32,
    rates: u32,
    runs: u64,
}

/// Simulates benches with an offset from 0 to 10 s and a rate within 500 ppm. `reference_s`: middle of the bench.
fn coverage(
    runs: u64,
    reference_s: f64,
    bench: impl Fn(&mut Generator, u64, f64, f64) -> Result<ClockTie, NoTie>,
) -> Coverage {
    let runs = std::env::var("TIE_RUNS").ok().and_then(|n| n.parse().ok()).unwrap_or(runs);
    let mut all = Coverage { tied: 0, offsets: 0, rates: 0, runs };
    for seed in 1..=runs {
        let mut of = Generator((seed * 7919 + 12_345).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        (0..20).for_each(|_| _ = of.uniform());
        let (offset_s, rate) = (10.0 * of.uniform(), 1e-3 * (of.uniform() - 0.5));
        let Ok(found) = bench(&mut of, seed, offset_s, rate) else { continue };
        let truth_s = offset_s + rate * (found.reference_s - reference_s);
        all.tied += 1;
        all.offsets += u32::from((found.offset_s - truth_s).abs() < 1.96 * found.offset_sd_s);
        all.rates += u32::from((found.rate - rate).abs() < 1.96 * found.rate_sd);
    }
    println!("tied {} of {}: offset {}, rate {}", all.tied, all.runs, all.offsets, all.rates);
    all
}

impl Coverage {
    /// Every clock was tied, and no fewer intervals hold than chance leaves at .95.
    #[track_caller]
    fn holds(&self) {
        let n = f64::from(self.tied);
        let low = 0.95 * n - 3.0 * (0.95 * 0.05 * n).sqrt();
        assert_eq!(u64::from(self.tied), self.runs);
        assert!(f64::from(self.offsets) >= low && f64::from(self.rates) >= low, "{}", self.offsets);
    }
}

#[track_caller]
fn table_holds(trouble: Trouble) {
    let noises = |seed: u64| NOISES[(seed % 3) as usize];
    let bench = |of: &mut Generator, seed: u64, offset_s: f64, rate: f64| {
        tied(&table(of, offset_s, rate, noises(seed), trouble), 12.0, Following::AtOnce)
    };
    coverage(12, 200.0, bench).holds();
}

#[test]
fn offset_and_rate_of_the_clock_of_a_table_are_found_and_their_intervals_hold_them() {
    table_holds(Trouble::None);
}

#[test]
fn gaps_of_both_records_are_no_angle_turned() {
    table_holds(Trouble::Gaps);
}

#[test]
fn a_record_that_ends_early_ties_its_clock() {
    table_holds(Trouble::Ends);
}

#[test]
fn a_motion_near_the_noise_ties_no_clock() {
    let bench = |of: &mut Generator, seed: u64, offset_s: f64, rate: f64| {
        tied(&table(of, offset_s, rate, NOISES[(seed % 3) as usize], Trouble::Weak), 12.0, Following::AtOnce)
    };
    assert_eq!(coverage(6, 200.0, bench).tied, 0);
}

#[test]
fn two_thermometers_tie_a_clock_with_the_lag_that_is_not_seen_in_the_uncertainty() {
    for lag_s in [0.0, 5.0] {
        let bench = |of: &mut Generator, _: u64, offset_s: f64, rate: f64| {
            tied(&chamber(of, offset_s, rate, lag_s), 60.0, Following::MayLag)
        };
        let found = coverage(10, 7200.0, bench);
        assert!(100 * found.tied >= 90 * found.runs as u32 && 100 * found.offsets >= 95 * found.tied);
    }
}

#[test]
fn a_thermometer_that_lags_behind_another_one_ties_no_clock() {
    let bench = |of: &mut Generator, _: u64, offset_s: f64, rate: f64| {
        tied(&chamber(of, offset_s, rate, 20.0), 60.0, Following::MayLag)
    };
    assert_eq!(coverage(4, 7200.0, bench).tied, 0);
    let mut of = Generator(2024);
    assert_eq!(tied(&chamber(&mut of, 5.0, 0.0, 20.0), 60.0, Following::MayLag), Err(NoTie::Lags));
}

#[test]
fn a_motion_that_repeats_itself_ties_no_clock() {
    let fast: Vec<f64> = (0..20_000).map(|i| 0.02 * f64::from(i)).collect();
    let wave: Vec<f64> = fast.iter().map(|t| 30.0 * (t * std::f64::consts::TAU / 4.0).sin()).collect();
    let slow: Vec<f64> = (100..1900).map(|k| 0.2 * f64::from(k)).collect();
    let mut of = Generator(99);
    let angle: Vec<f64> =
        slow.iter().map(|s| 30.0 * (s * std::f64::consts::TAU / 4.0).sin() + 0.01 * of.normal()).collect();
    let found = tie(
        Timed { times_s: &fast, values: &wave },
        Timed { times_s: &slow, values: &angle },
        12.0,
        Following::AtOnce,
    );
    assert_eq!(found, Err(NoTie::Ambiguous));
}

#[test]
fn a_record_at_rest_ties_no_clock() {
    let mut of = Generator(7);
    let fast: Vec<f64> = (0..20_000).map(|i| 0.02 * f64::from(i)).collect();
    let noise: Vec<f64> = fast.iter().map(|_| of.normal()).collect();
    let slow: Vec<f64> = (100..1900).map(|k| 0.2 * f64::from(k)).collect();
    let other: Vec<f64> = slow.iter().map(|_| of.normal()).collect();
    let found = tie(
        Timed { times_s: &fast, values: &noise },
        Timed { times_s: &slow, values: &other },
        12.0,
        Following::AtOnce,
    );
    assert!(matches!(found, Err(NoTie::Unrelated | NoTie::Ambiguous)), "{found:?}");
}
