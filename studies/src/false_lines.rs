//! Lines found in noise that has none. A short version is a unit test of `sagnac_core::noise::lines`.

use crate::study::{Asked, Case, Row, Study};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use sagnac::noise::lines::{FALSE_ALARM_RATE, find_lines};
use sagnac::noise::welch::WelchAccumulator;

/// Records with one or more false lines.
pub static STUDY: Study = Study {
    id: "false-lines",
    title: "Lines found in noise without lines",
    method: "White noise, alone or with flicker or a random walk that rules the lower part of the spectrum, through the averaged \
             periodogram and the search for lines at its stated rate of false alarms.",
    records: 2000,
    cases,
};

#[derive(Clone, Copy)]
enum Slow {
    Nothing,
    Flicker,
    Walk,
}

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for (name, slow) in [("white", Slow::Nothing), ("flicker", Slow::Flicker), ("random walk", Slow::Walk)] {
        for (samples, segment) in [(1 << 12, 256), (1 << 14, 1024), (1 << 14, 64), (1 << 17, 512)] {
            let name = format!("{name}, {samples} samples, segments of {segment}");
            cases.push(Case::new(name, move |records, seed| {
                let first = 1000 + 1_000_000 * (seed - 1);
                let found = |seed: &u64| has_lines(&noise(samples, slow, *seed), segment);
                let alarms = (first..first + records).into_par_iter().filter(found).count() as u64;
                let claim = "one or more false lines";
                vec![Row::share("search for lines", claim, Asked::AtMost(FALSE_ALARM_RATE), alarms, records)]
            }));
        }
    }
    cases
}

fn has_lines(samples: &[f64], segment: usize) -> bool {
    let mut welch = WelchAccumulator::with_segment(segment);
    welch.push(samples, false);
    !find_lines(&welch.finish().spectrum, 0.01, FALSE_ALARM_RATE).lines.is_empty()
}

/// White noise of σ = 1 with slow noise. Flicker is a sum of first-order processes, one an octave.
fn noise(samples: usize, slow: Slow, seed: u64) -> Vec<f64> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut states = [0.0f64; 16];
    let mut walk = 0.0;
    let mut sample = || {
        let level = match slow {
            Slow::Nothing => 0.0,
            Slow::Flicker => {
                for (k, state) in states.iter_mut().enumerate() {
                    let kept = (-(0.5f64.powi(k as i32))).exp();
                    *state = kept * *state + (1.0 - kept * kept).sqrt() * draw();
                }
                states.iter().sum::<f64>()
            }
            Slow::Walk => {
                walk += 0.05 * draw();
                walk
            }
        };
        level + draw()
    };
    (0..samples).map(|_| sample()).collect()
}
