//! Times the parts of a rate digest on simulated white noise: `cargo run --release --example digest_speed [samples]`.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::block_series::BlockSeriesAccumulator;
use sagnac::noise::digest::{DigestPlan, RateAccumulator};
use sagnac::noise::envelope::EnvelopeAccumulator;
use sagnac::noise::family::Estimator;
use sagnac::noise::histogram::HistogramAccumulator;
use sagnac::noise::lines::find_lines;
use sagnac::noise::tau_grid::TauGrid;
use sagnac::noise::welch::WelchAccumulator;
use sagnac::noise::windows::WindowMeans;
use std::time::Instant;

const BLOCK: usize = 65_536;

fn timed(name: &str, work: impl FnOnce()) {
    let start = Instant::now();
    work();
    println!("{name:<44} {:7.3} s", start.elapsed().as_secs_f64());
}

fn allan(samples: &[f64], grid: TauGrid, exact: bool, estimators: Vec<Estimator>) {
    let mut acc = AllanAccumulator::new(AllanPlan { tau0_s: 0.001, grid, exact, estimators });
    let mut at = 0;
    for block in samples.chunks(BLOCK) {
        acc.push(block, at, at > 0);
        at += block.len() as u64;
    }
    std::hint::black_box(acc.finish());
}

fn main() {
    let count = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(36_000_000usize);
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
    let y: Vec<f64> = (0..count)
        .map(|_| {
            let v: f64 = StandardNormal.sample(&mut rng);
            v + 7.5
        })
        .collect();
    println!("{count} samples, {} threads", rayon::current_num_threads());
    let family = vec![Estimator::Allan, Estimator::Modified, Estimator::Hadamard];
    timed("Allan, octaves, bounded memory", || allan(&y, TauGrid::Octave, false, vec![Estimator::Allan]));
    timed("Allan, decades, bounded memory", || allan(&y, TauGrid::Decade, false, vec![Estimator::Allan]));
    timed("Allan, octaves, exact", || allan(&y, TauGrid::Octave, true, vec![Estimator::Allan]));
    timed("Allan, modified, Hadamard, octaves, bounded", || {
        allan(&y, TauGrid::Octave, false, family.clone())
    });
    timed("whole family, octaves, exact", || allan(&y, TauGrid::Octave, true, Estimator::ALL.to_vec()));
    timed("Welch", || {
        let mut acc = WelchAccumulator::new();
        y.chunks(BLOCK).enumerate().for_each(|(k, b)| acc.push(b, k > 0));
        let spectrum = acc.finish().spectrum;
        timed("  line search", || drop(std::hint::black_box(find_lines(&spectrum, 0.001, 0.01))));
    });
    timed("histogram", || {
        let mut acc = HistogramAccumulator::new();
        y.chunks(BLOCK).enumerate().for_each(|(k, b)| acc.push(b, k > 0));
        std::hint::black_box(acc.finish());
    });
    timed("block means, window means, envelope", || {
        let mut blocks = BlockSeriesAccumulator::default();
        let mut windows = [WindowMeans::new(100.0, 0.001), WindowMeans::new(10.0, 0.001)];
        let mut envelope = EnvelopeAccumulator::new();
        for (k, b) in y.chunks(BLOCK).enumerate() {
            blocks.push(b, (k * BLOCK) as u64);
            windows.iter_mut().for_each(|w| w.push(b, k > 0));
            envelope.push(b, (k * BLOCK) as u64);
        }
        std::hint::black_box((blocks.finish(), windows.map(WindowMeans::finish), envelope.finish()));
    });
    timed("the whole digest", || {
        let mut acc = RateAccumulator::new(DigestPlan::new(0.001));
        y.chunks(BLOCK).enumerate().for_each(|(k, b)| acc.push(b, (k * BLOCK) as u64, k > 0));
        std::hint::black_box(acc.finish());
    });
}
