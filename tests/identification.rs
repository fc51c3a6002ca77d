//! Monte Carlo of the identification against simulated truth: coverage, false claims, efficiency.

use sagnac::noise::data::{BlockSeries, WelchSpectrum};
use sagnac::noise::evidence::Evidence;
use sagnac::noise::fit::{Likelihood, Structure};
use sagnac::noise::identify::{Identify, Whittle};
use sagnac::noise::model::{NoiseModel, TERMS};
use sagnac::noise::simulate::{Setup, Simulator};

/// What a set of records of one mix showed. Arrays follow `TERMS`.
#[derive(Default)]
struct Tally {
    records: usize,
    claimed: [usize; 5],
    covered: [usize; 5],
    square_error: [f64; 5],
    limits: [usize; 5],
    limits_hold: [usize; 5],
    false_claims: usize,
    bound: [f64; 5],
    misfit_below_5_percent: usize,
}

fn study(model: &NoiseModel, hours: f64, tau0_s: f64, records: u64, seed: u64) -> Tally {
    let samples = (hours * 3600.0 / tau0_s) as usize;
    let mut tally = Tally { records: records as usize, ..Default::default() };
    let present: Structure = TERMS.map(|t| model.coefficient(t) != 0.0);
    let expected = Evidence::expected(model, samples as u64, tau0_s);
    let covariance = Likelihood::new(&expected).expect("evidence").covariance_bound(model, &present);
    for (i, bound) in tally.bound.iter_mut().enumerate() {
        *bound = covariance[i][i].sqrt() / model.coefficient(TERMS[i]).abs().max(1e-300);
    }
    for run in 0..records {
        let setup =
            Setup { bias_deg_h: 0.37, ..Setup::for_record(seed * 1_000_003 + run, tau0_s, samples as u64) };
        let mean = Simulator::new(model, &setup).take(samples);
        let blocks =
            BlockSeries { block_len: 1, first_index: 0, count: vec![1; samples], mean, rounding: vec![] };
        let found = Whittle::default().identify("rate", &Evidence::new(&blocks, None, tau0_s, &[]));
        let [n, b, k, r, q] = found.estimates();
        let mut wrong = false;
        for (i, estimate) in [n, b, k, q, r].into_iter().enumerate() {
            let truth = model.coefficient(TERMS[i]);
            match estimate.value {
                Some(value) => {
                    tally.claimed[i] += 1;
                    wrong |= !present[i];
                    if present[i] {
                        tally.square_error[i] += (value / truth - 1.0).powi(2);
                        let interval = estimate.interval95().expect("an interval");
                        tally.covered[i] += usize::from(interval.low <= truth && truth <= interval.high);
                    }
                }
                None => {
                    let limit = estimate.upper_limit.expect("an upper limit");
                    tally.limits[i] += 1;
                    tally.limits_hold[i] += usize::from(truth.abs() <= limit.value);
                }
            }
        }
        tally.false_claims += usize::from(wrong);
        tally.misfit_below_5_percent += usize::from(found.misfit.probability < 0.05);
    }
    tally
}

fn share(a: usize, b: usize) -> f64 {
    a as f64 / b.max(1) as f64
}

impl Tally {
    fn print(&self, name: &str, hours: f64) {
        print!(
            "{name:>9} {hours:>4} h  false {:.3} misfit {:.3} |",
            share(self.false_claims, self.records),
            share(self.misfit_below_5_percent, self.records)
        );
        for (i, label) in ["N", "B", "K", "Q", "R"].into_iter().enumerate() {
            if self.bound[i] > 0.0 && self.bound[i] < 1e3 {
                let rms = (self.square_error[i] / self.claimed[i].max(1) as f64).sqrt();
                print!(
                    " {label}: found {:.2} cov {:.3} all {:.3} rms/crb {:.2} (crb {:.3})",
                    share(self.claimed[i], self.records),
                    share(self.covered[i], self.claimed[i]),
                    share(self.covered[i] + self.limits_hold[i], self.records),
                    rms / self.bound[i],
                    self.bound[i]
                );
            }
            if self.limits[i] > 0 {
                print!(
                    " {label}: limit {:.3} of {}",
                    share(self.limits_hold[i], self.limits[i]),
                    self.limits[i]
                );
            }
        }
        println!();
    }
}

fn mixes() -> Vec<(&'static str, NoiseModel)> {
    let m = |n, b, k, r, q| NoiseModel { n, b, k, r, q };
    vec![
        ("N", m(0.0023, 0.0, 0.0, 0.0, 0.0)),
        ("OIUS-200", m(0.0081, 0.006 / 0.664, 0.0, 0.0, 0.0)),
        ("OIUS-501", m(0.0023, 0.0011 / 0.664, 0.0, 0.0, 0.0)),
        ("OIUS-1000", m(0.00055, 0.0006 / 0.664, 0.0, 0.0, 0.0)),
        ("OIUS-2000", m(0.00025, 0.00024 / 0.664, 0.0, 0.0, 0.0)),
        ("N+B", m(0.002, 0.006, 0.0, 0.0, 0.0)),
        ("N+K", m(0.0023, 0.0, 0.006, 0.0, 0.0)),
        ("N+K big", m(0.0023, 0.0, 0.02, 0.0, 0.0)),
        ("N+B+K", m(0.002, 0.004, 0.006, 0.0, 0.0)),
        ("N+R", m(0.0023, 0.0, 0.0, 0.003, 0.0)),
        ("N+Q", m(0.0023, 0.0, 0.0, 0.0, 0.05)),
    ]
}

/// `SEED=1000 RECORDS=400 cargo test --release --test identification long_study -- --ignored --nocapture`
#[test]
#[ignore = "long study: every mix at two lengths"]
fn long_study() {
    let records = std::env::var("RECORDS").ok().and_then(|r| r.parse().ok()).unwrap_or(400);
    let seed: u64 = std::env::var("SEED").ok().and_then(|r| r.parse().ok()).unwrap_or(0);
    let mut worst: f64 = 0.0;
    for (hours, tau0_s) in [(10.0, 1.0), (100.0, 10.0)] {
        for (i, (name, model)) in mixes().into_iter().enumerate() {
            let tally = study(&model, hours, tau0_s, records, seed + i as u64 + 1);
            tally.print(name, hours);
            worst = worst.max(share(tally.false_claims, tally.records));
        }
    }
    assert!(worst <= 0.09, "false claims in {worst} of the records of a mix");
}

#[test]
fn white_noise_alone_shows_nothing_else() {
    let model = NoiseModel { n: 0.0023, ..Default::default() };
    let tally = study(&model, 10.0, 10.0, 60, 77);
    assert_eq!(tally.claimed[0], 60);
    assert!(tally.false_claims <= 5, "{} of 60", tally.false_claims);
    assert!(tally.covered[0] >= 53, "{} of 60", tally.covered[0]);
    assert!(tally.limits_hold.iter().zip(tally.limits).all(|(hold, of)| *hold == of));
}

#[test]
fn flicker_is_found_where_the_record_shows_it_with_honest_intervals() {
    let model = NoiseModel { n: 0.002, b: 0.006, ..Default::default() };
    let tally = study(&model, 100.0, 20.0, 50, 78);
    assert_eq!(tally.claimed[1], 50);
    assert!(tally.covered[0] >= 43 && tally.covered[1] >= 43, "{:?}", tally.covered);
    assert!(tally.false_claims <= 6, "{} of 50", tally.false_claims);
    let rms = (tally.square_error[1] / 50.0).sqrt();
    assert!(rms < 1.35 * tally.bound[1], "rms {rms}, bound {}", tally.bound[1]);
}

#[test]
fn random_walk_is_not_taken_for_flicker() {
    let model = NoiseModel { n: 0.0023, k: 0.006, ..Default::default() };
    let tally = study(&model, 100.0, 20.0, 50, 79);
    assert_eq!(tally.claimed[2], 50);
    assert!(tally.covered[2] >= 43, "{:?}", tally.covered);
    assert!(tally.false_claims <= 6, "{} of 50", tally.false_claims);
}

/// `cargo test --release --test identification -- --ignored --nocapture speed`
#[test]
#[ignore = "timing"]
fn speed() {
    let model = NoiseModel { n: 0.002, b: 0.01, k: 0.005, ..Default::default() };
    let (block_len, count, tau0_s, segment_len) = (128u64, 1usize << 18, 0.001, 16_384usize);
    let tau_s = tau0_s * block_len as f64;
    let start = std::time::Instant::now();
    let mean = Simulator::new(&model, &Setup::for_record(1, tau_s, count as u64)).take(count);
    println!("simulation {:.1} ns a sample", start.elapsed().as_secs_f64() * 1e9 / count as f64);
    let blocks = BlockSeries {
        block_len,
        first_index: 0,
        count: vec![block_len as u32; count],
        mean,
        rounding: vec![],
    };
    let density = (0..=segment_len / 2)
        .map(|k| model.density((k.max(1) as f64) / (segment_len as f64 * tau0_s), tau0_s) / tau0_s)
        .collect();
    let segments = 2 * count as u64 * block_len / segment_len as u64 - 1;
    let effective_averages = 0.947 * segments as f64;
    let welch = WelchSpectrum { segment_len, segments, effective_averages, density };
    let start = std::time::Instant::now();
    let evidence = Evidence::new(&blocks, Some(&welch), tau0_s, &[]);
    let built = start.elapsed();
    let found = Whittle::default().identify("rate", &evidence);
    println!(
        "evidence {built:?}, identification {:?}, {} bands",
        start.elapsed() - built,
        evidence.bands.len()
    );
    assert!(start.elapsed().as_secs_f64() < 2.0);
    assert!((found.model.n / model.n - 1.0).abs() < 0.01);
}
