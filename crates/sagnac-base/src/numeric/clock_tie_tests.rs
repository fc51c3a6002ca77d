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

/// A bench: the integral of the rate of a gyro at 50 Hz and the angle of the table at 5 Hz by a clock of its own.
struct Bench {
    gyro: (Vec<f64>, Vec<f64>),
    table: (Vec<f64>, Vec<f64>),
}

fn bench(seed: u64, offset_s: f64, rate: f64, encoder_deg: f64, walk_deg: f64) -> Bench {
    let mut of = Generator(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    (0..20).for_each(|_| _ = of.uniform());
    let (mut angle, mut walk) = (0.0, 0.0);
    let mut gyro = (vec![], vec![]);
    let mut truth = vec![];
    for i in 0..20_000 {
        let t = 0.02 * f64::from(i);
        gyro.0.push(t);
        gyro.1.push(1.0005 * angle + walk);
        truth.push(angle);
        angle += 0.02 * table_rate(t + 0.01);
        walk += walk_deg * 0.02f64.sqrt() * of.normal() + 1e-5;
    }
    let mut table = (vec![], vec![]);
    for k in 100..1900 {
        // The stamp of the table at a time of the gyro: t = s + offset + rate (s − 200).
        let s = 0.2 * f64::from(k) - offset_s;
        let t = s + offset_s + rate * (s - 200.0);
        let place = t / 0.02;
        let (i, part) = (place.floor() as usize, place - place.floor());
        table.0.push(s);
        table.1.push(truth[i] * (1.0 - part) + truth[i + 1] * part + encoder_deg * of.normal());
    }
    Bench { gyro, table }
}

fn tied(of: &Bench) -> Result<ClockTie, NoTie> {
    let timed = |(times_s, values): &'_ (Vec<f64>, Vec<f64>)| -> (Vec<f64>, Vec<f64>) {
        (times_s.clone(), values.clone())
    };
    let (gyro, table) = (timed(&of.gyro), timed(&of.table));
    tie(Timed { times_s: &gyro.0, values: &gyro.1 }, Timed { times_s: &table.0, values: &table.1 }, 12.0)
}

/// Offset of the table's clock at the middle of its stamps as they were kept.
fn true_offset_s(found: &ClockTie, offset_s: f64, rate: f64) -> f64 {
    offset_s + rate * (found.reference_s - 200.0)
}

#[test]
fn offset_and_rate_are_found_and_their_intervals_hold_them() {
    let (mut offsets, mut rates, mut all) = (0, 0, 0);
    let runs = std::env::var("TIE_RUNS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    for seed in 1..=runs {
        let mut of = Generator(seed * 7919);
        (0..20).for_each(|_| _ = of.uniform());
        let (offset_s, rate) = (10.0 * of.uniform(), 1e-3 * (of.uniform() - 0.5));
        let noises = [(0.01, 1e-4), (0.002, 0.01), (0.05, 0.002)][(seed % 3) as usize];
        let found = tied(&bench(seed, offset_s, rate, noises.0, noises.1)).unwrap();
        let miss = (found.offset_s - true_offset_s(&found, offset_s, rate)) / found.offset_sd_s;
        let miss_of_rate = (found.rate - rate) / found.rate_sd;
        assert!(miss.abs() < 6.0 && miss_of_rate.abs() < 6.0, "seed {seed}: {miss} {miss_of_rate} {found:?}");
        all += 1;
        offsets += i32::from(miss.abs() < 1.96);
        rates += i32::from(miss_of_rate.abs() < 1.96);
    }
    println!("offset {offsets} of {all}, rate {rates} of {all}");
    let low = f64::from(all) * 0.95 - 3.0 * (f64::from(all) * 0.95 * 0.05).sqrt();
    assert!(f64::from(offsets) >= low && f64::from(rates) >= low, "{offsets} and {rates} of {all}");
}

#[test]
fn a_motion_that_repeats_itself_ties_no_clock() {
    let fast: Vec<f64> = (0..20_000).map(|i| 0.02 * f64::from(i)).collect();
    let wave: Vec<f64> = fast.iter().map(|t| 30.0 * (t * std::f64::consts::TAU / 4.0).sin()).collect();
    let slow: Vec<f64> = (100..1900).map(|k| 0.2 * f64::from(k)).collect();
    let mut of = Generator(99);
    let angle: Vec<f64> =
        slow.iter().map(|s| 30.0 * (s * std::f64::consts::TAU / 4.0).sin() + 0.01 * of.normal()).collect();
    let found = tie(Timed { times_s: &fast, values: &wave }, Timed { times_s: &slow, values: &angle }, 12.0);
    assert_eq!(found, Err(NoTie::Ambiguous));
}

#[test]
fn a_record_at_rest_ties_no_clock() {
    let mut of = Generator(7);
    let fast: Vec<f64> = (0..20_000).map(|i| 0.02 * f64::from(i)).collect();
    let noise: Vec<f64> = fast.iter().map(|_| of.normal()).collect();
    let slow: Vec<f64> = (100..1900).map(|k| 0.2 * f64::from(k)).collect();
    let other: Vec<f64> = slow.iter().map(|_| of.normal()).collect();
    let found = tie(Timed { times_s: &fast, values: &noise }, Timed { times_s: &slow, values: &other }, 12.0);
    assert!(matches!(found, Err(NoTie::Unrelated | NoTie::Ambiguous)), "{found:?}");
}
