//! The identification of noise on mixes of known truth, in short. The studies are `cargo xtask validate identification
//! sample-rates flicker-or-markov`; only the timing is an ignored test here.

mod instruments;
mod parts;

use rayon::prelude::*;
use sagnac::noise::composite::{Composite, Damped};
use sagnac::noise::digest::{DigestPlan, RateAccumulator};
use sagnac::noise::model::NoiseModel;
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac_studies::identification::generator::Generator;
use sagnac_studies::identification::mixes::{Mix, TAU0_S, mixes};
use sagnac_studies::identification::record::identify;
use sagnac_studies::identification::run::{Source, simulated, study};
use sagnac_studies::identification::sample_rates::at_three_rates;
use sagnac_studies::identification::whittle::Layout;
use sagnac_studies::identification::{allan, gmwm};

/// Power over its expectation, by bands, of records of a mix from one source.
fn departures(
    mix: &Mix,
    samples: usize,
    records: u64,
    source: &dyn Fn(u64) -> Vec<f64>,
) -> Vec<(usize, f64)> {
    let layout = Layout::new(samples, &mix.truth);
    let mut sums: Vec<(f64, f64)> = vec![];
    for seed in 0..records {
        let bands = layout.whitened(&layout.data(&source(seed)), &mix.truth, 30.0);
        sums.resize(bands.len(), (0.0, 0.0));
        for (sum, (ratio, dof)) in sums.iter_mut().zip(bands) {
            *sum = (sum.0 + ratio * dof, sum.1 + dof);
        }
    }
    // Normal scores: a mean of χ² of so many degrees of freedom.
    sums.into_iter().map(|(sum, dof)| (sum / dof - 1.0) / (2.0 / dof).sqrt()).enumerate().collect()
}

#[test]
fn both_sources_of_records_have_the_spectrum_of_the_mix() {
    let samples = 12_000;
    for mix in mixes() {
        let generator = Generator::new(&mix, samples, TAU0_S);
        let own = departures(&mix, samples, 24, &|seed| simulated(&mix, samples, 4_000 + seed));
        let other = departures(&mix, samples, 24, &|seed| generator.record(4_000 + seed, 0.37));
        for (source, scores) in [("simulator", own), ("generator", other)] {
            let worst = scores.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).expect("bands");
            assert!(
                worst.1.abs() < 4.5,
                "{} {source}: band {} of {} by {:.1} σ",
                mix.name,
                worst.0,
                scores.len(),
                worst.1
            );
            let square = scores.iter().map(|s| s.1 * s.1).sum::<f64>() / scores.len() as f64;
            let slack = 4.5 * (2.0 / scores.len() as f64).sqrt();
            assert!((square - 1.0).abs() < slack, "{} {source}: {square} ± {slack}", mix.name);
        }
    }
}

#[test]
fn angle_random_walk_does_not_depend_on_the_sample_rate() {
    let model = NoiseModel { n: 0.002, b: 0.006, k: 0.02, ..Default::default() }.into();
    let mut scores = vec![];
    for seed in 0..3 {
        let found = at_three_rates(&model, 0.5, 600 + seed);
        let n = |i: usize| found[i].1.angle_random_walk.value.expect("N is always seen");
        // Bound of N from 1800, 18 000 and 180 000 samples of white noise. The fast records hold the slow ones, so that
        // differences have the difference of the variances.
        let bound = |i: usize| 1.0 / (2.0 * 1800.0 * found[i].0).sqrt();
        for (slow, fast) in [(0, 2), (1, 2), (0, 1)] {
            let sigma = (bound(slow).powi(2) - bound(fast).powi(2)).sqrt();
            scores.push((n(slow) / n(fast) - 1.0) / sigma);
        }
        assert!((n(2) / 0.002 - 1.0).abs() < 5.0 * bound(2), "{}", n(2));
    }
    assert!(scores.iter().all(|s| s.abs() < 4.5), "{scores:?}");
}

/// User and system time of the process so far, s; `None` where the system does not tell.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    // The unit of this file is fixed at 1/100 s on every common Linux.
    Some(ticks / 100.0)
}

/// `cargo test --test it identification_study speed -- --ignored --nocapture --test-threads 1`
#[test]
#[ignore = "timing"]
fn speed_of_36_million_samples() {
    let (samples, tau0_s) = (36_000_000usize, 0.001);
    for mix in mixes().iter().filter(|m| m.name == "N+B+K" || m.name == "N+short Markov+quasi-periodic") {
        let mut simulator = Simulator::of(&mix.truth, &Setup::for_record(5, tau0_s, samples as u64));
        let mut accumulator = RateAccumulator::new(DigestPlan::new(tau0_s));
        let mut block = vec![0.0; 1 << 16];
        let mut done = 0;
        while done < samples {
            let size = block.len().min(samples - done);
            simulator.fill(&mut block[..size]);
            accumulator.push(&block[..size], done as u64, done > 0);
            done += size;
        }
        let record = accumulator.finish();
        let (start, before) = (std::time::Instant::now(), cpu_seconds());
        let found = identify(&record);
        let wall = start.elapsed().as_secs_f64();
        let cpu = cpu_seconds().zip(before).map_or(wall, |(now, then)| now - then);
        let n = found.identification.angle_random_walk.value.unwrap_or(f64::NAN);
        println!("{}: {cpu:.2} s of CPU, {wall:.2} s of wall clock, N {n:.6}", mix.name);
        assert!(cpu <= 2.0, "{cpu} s");
        assert!((n / mix.truth.terms.n - 1.0).abs() < 0.01, "{n}");
    }
}

#[test]
fn the_oracle_reaches_the_bound_and_the_mix_is_found() {
    let mix = mixes().into_iter().find(|m| m.name == "N+Q").expect("a mix");
    let tally = study(&mix, 10.0, 40, 77, Source::Both);
    for (i, q) in tally.quantities.iter().enumerate() {
        let oracle = tally.oracle_rms(i) / tally.bounds[i];
        // The ratio of a root mean square of 40 to its expectation: 1 ± 0.11.
        assert!((0.6..1.4).contains(&oracle), "{}: {oracle}", q.label);
        assert!(tally.oracle_coverage(i) >= 0.82, "{}", tally.oracle_coverage(i));
        let ours = tally.error(i, 0);
        assert!(ours.found >= 0.9, "{} found in {}", q.label, ours.found);
        assert!(ours.of_found / tally.bounds[i] < 1.6, "{}: {}", q.label, ours.of_found / tally.bounds[i]);
        assert!(tally.coverage(i).0 >= 0.82, "{}", tally.coverage(i).0);
        assert!((0.9..1.3).contains(&tally.width_ratio(i)), "{}", tally.width_ratio(i));
        // The usual fit of the logarithms is several times worse on the same records.
        assert!(tally.error(i, 2).of_all > 2.0 * ours.of_all, "{}", q.label);
    }
    assert!(tally.false_share() <= 0.15, "{}", tally.false_share());
}

#[test]
fn wavelet_moments_recover_the_published_simulation_of_their_authors() {
    // Bosch MEMS gyro of the authors' 2016 note: correlation time 530.8 s, 12 h; here at 1 Hz, in the same proportions.
    let mix = Mix {
        name: "GMWM",
        truth: Composite {
            markov: vec![Damped { rms_deg_h: 0.05, frequency_hz: 0.0, decay_time_s: 530.8 }],
            ..NoiseModel { n: 0.002, ..Default::default() }.into()
        },
    };
    let generator = Generator::new(&mix, 43_200, TAU0_S);
    let fits: Vec<Vec<f64>> = (0..24)
        .into_par_iter()
        .map(|seed| {
            let points = allan::octaves(&generator.record(seed, 0.0), TAU0_S, 0.5);
            gmwm::fit(&points, &mix.truth, &mix.parameters()).into_iter().map(|v| v.unwrap_or(0.0)).collect()
        })
        .collect();
    for (i, q) in mix.quantities().iter().enumerate() {
        let mean = fits.iter().map(|f| f[i] / q.truth).sum::<f64>() / 24.0;
        assert!((mean - 1.0).abs() < 0.25, "{}: {mean}", q.label);
    }
}
