//! Effects of the laboratory added to real noise: the noise of a static recording takes the place of simulated noise, and the
//! claim is what the program identifies from another part of the same recording.

use super::bench::Bench;
use super::case::{self, Case};
use super::catalogue::SUBJECTS;
use super::claim::Claim;
use super::dice::Dice;
use super::engine::explain_case;
use super::noise::{Levels, Parts};
use super::score::Score;
use super::truth::Family;
use crate::study::{self, Asked, Row, Study};
use rayon::prelude::*;
use sagnac::mismatch::identify;
use sagnac::series::{Series, SeriesOptions, load_series};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Where the recordings are.
const DATA: &str = "SAGNAC_REAL_DATA";

/// Rows of which the mean is taken: 5 Hz of 100 Hz.
const AVERAGED: usize = 20;

/// The part of which the claim is identified, and the part that gives the noise, s.
const PARTS: [[f64; 2]; 2] = [[0.0, 4500.0], [5000.0, 9500.0]];

/// Gains, nats.
const GAINS: [f64; 3] = [20.0, 60.0, 200.0];

/// Families whose subjects are each of one known kind.
const FAMILIES: [Family; 6] =
    [Family::Temperature, Family::Driver, Family::Unrecorded, Family::Table, Family::Event, Family::Noise];

/// Concealed effects in real noise.
pub static STUDY: Study = Study {
    id: "real-noise",
    title: "Effects added to real noise",
    method: "Real static recordings of a micromechanical unit (SAGNAC_REAL_DATA; 4 recordings of 3 axes, means over 0.2 s, 75 min \
             each) take the place of the noise of the laboratory; the claim is what `sagnac model` identifies from another 75 min of \
             the same recording. Surroundings and effects are those of the laboratory, whose physics shares no formula with the \
             engine, with seeds that are looked at only to report. Each effect is as strong as an oracle told the truth gains 20, 60 \
             or 200 nats under the identified noise. Added are effects only to parts that agree with their claim as they are. The \
             number of records is that of each subject.",
    records: 3,
    cases,
};

fn cases() -> Vec<study::Case> {
    let mut cases = vec![study::Case::new("nothing added", |_, _| nothing_added())];
    for family in FAMILIES {
        for gain in GAINS {
            let name = format!("{}, {gain} nats", family.name());
            cases.push(study::Case::new(name, move |records, seed| run(family, gain, records, seed)));
        }
    }
    cases
}

/// A part of a recording with its claim.
#[derive(Debug, Clone)]
struct Part {
    name: String,
    claim: Claim,
    /// The rate less the claimed bias, deg/h.
    noise: Vec<f64>,
}

/// Every part, with whether it agrees with its claim as it is.
fn parts() -> &'static [(Part, bool)] {
    static READ: OnceLock<Vec<(Part, bool)>> = OnceLock::new();
    READ.get_or_init(|| {
        let Some(data) = std::env::var_os(DATA).map(PathBuf::from) else {
            eprintln!("skipped: {DATA} is not set");
            return vec![];
        };
        let all: Vec<(usize, &str)> = (1..=4).flat_map(|u| ["x", "y", "z"].map(|a| (u, a))).collect();
        let read = |(unit, axis): &(usize, &str)| {
            let part = part(&data, *unit, axis).map_err(|e| eprintln!("unit {unit} {axis}: {e}")).ok()?;
            let agrees = consistent(&part);
            Some((part, agrees))
        };
        all.par_iter().filter_map(read).collect()
    })
}

fn part(data: &Path, unit: usize, axis: &str) -> Result<Part, String> {
    let file = data.join(format!("mems_adis16405_static/unit{unit}.parquet"));
    let options = SeriesOptions { rate: Some(format!("rate_{axis}_deg_s")), ..SeriesOptions::default() };
    let series = load_series(&[file], &options, &mut |_, _| {}).map_err(|e| e.to_string())?;
    let series = averaged(&series);
    let [known, added] = PARTS.map(|[from, to]| series.between(from, to));
    let claim = identify(&known, &mut |_| {}).map_err(|note| note.id.to_string())?;
    let told = claim.uncertainty;
    // A term that is only bounded is stated at half of its bound, and may be anything up to that.
    let level = |value: f64, rel: f64, bound: f64| match value > 0.0 {
        true => (value, rel),
        false => (0.5 * bound, 0.5),
    };
    let (n, n_rel) = level(claim.noise.n, told.n_rel, told.of_zero()[0]);
    let (b, b_rel) = level(claim.noise.b, told.b_rel, told.of_zero()[1]);
    let (k, k_rel) = level(claim.noise.k, told.k_rel, told.of_zero()[2]);
    let mean = claim.mean.bias_deg_h;
    Ok(Part {
        name: format!("recording {unit} {axis}"),
        noise: added.rate_deg_h.iter().map(|r| r - mean).collect(),
        claim: Claim {
            rate_hz: 1.0 / series.sample_interval_s,
            description: "static".to_owned(),
            levels: Levels { n, b, k },
            levels_rel: [n_rel, b_rel, k_rel],
            bias_deg_h: mean,
            bias_sd_deg_h: 1000.0,
            temperature: None,
            scale_ppm: None,
            earth_deg: None,
        },
    })
}

/// Means over [`AVERAGED`] rows; the recordings have no gaps.
fn averaged(series: &Series) -> Series {
    let mean = |values: &[f64]| -> Vec<f64> {
        values.chunks_exact(AVERAGED).map(|c| c.iter().sum::<f64>() / AVERAGED as f64).collect()
    };
    let rate_deg_h = mean(&series.rate_deg_h);
    Series {
        time_s: mean(&series.time_s),
        index: (0..rate_deg_h.len() as u64).collect(),
        rate_deg_h,
        columns: Default::default(),
        sample_interval_s: series.sample_interval_s * AVERAGED as f64,
        ..series.clone()
    }
}

fn bench(part: &Part, dice: Dice) -> Bench {
    let rows = part.noise.len();
    let none = vec![0.0; rows];
    // The level of all of it is multiplied where an effect scales white noise.
    let parts = Parts { white: part.noise.clone(), flicker: none.clone(), walk: none };
    Bench::of_noise(dice, part.claim.clone(), parts)
}

/// True where the engine finds nothing in the part as it is.
fn consistent(part: &Part) -> bool {
    let bench = bench(part, Dice::of(&part.name, 0));
    let case = case::finish(bench, Family::Null, "real-noise", None, vec![], 0);
    judged(&case).is_some_and(|score| !score.detected)
}

fn judged(case: &Case) -> Option<Score> {
    let at =
        std::env::temp_dir().join(format!("sagnac-real-noise-{}", std::process::id())).join(&case.truth.case);
    let said = explain_case(case, &at, false);
    // What is left behind costs nothing but space.
    let _ = std::fs::remove_dir_all(&at);
    said.map(|said| Score::of(&case.truth, &said.answer, &case.time_s, None))
        .map_err(|message| eprintln!("{message}"))
        .ok()
}

fn nothing_added() -> Vec<Row> {
    let agree = parts().iter().filter(|(_, agrees)| *agrees).count() as u64;
    vec![Row::share("any", "consistent as they are", Asked::Nothing, agree, parts().len() as u64)]
}

fn run(family: Family, gain: f64, records: u64, first: u64) -> Vec<Row> {
    let sound: Vec<&Part> = parts().iter().filter(|(_, agrees)| *agrees).map(|(part, _)| part).collect();
    if sound.is_empty() {
        return vec![];
    }
    let subjects = SUBJECTS.iter().filter(|s| s.family == family && !s.days);
    // Odd seeds are looked at only to report.
    let jobs: Vec<_> =
        subjects.flat_map(|s| (0..records).map(move |i| (s, 2 * (1000 * first + i) + 1))).collect();
    let scored = |(place, (subject, seed)): (usize, &(&super::catalogue::Subject, u64))| {
        let part = sound.get((place + *seed as usize) % sound.len())?;
        let dice = Dice::of(&format!("{}/{gain}/real", subject.name), *seed);
        judged(&case::on_bench(subject, bench(part, dice), [gain, gain], None, *seed)?)
    };
    let scores: Vec<Score> = jobs.par_iter().enumerate().filter_map(scored).collect();
    let count = |of: &dyn Fn(&Score) -> bool| scores.iter().filter(|s| of(s)).count() as u64;
    let share = |claim: &str, happened: u64| {
        Row::share(family.name(), claim, Asked::Nothing, happened, scores.len() as u64)
    };
    vec![
        share("detected", count(&|s| s.detected)),
        share("named first", count(&|s| s.named_first)),
        share("named first or as an equivalent of the first", count(&|s| s.named)),
        share("located", count(&|s| s.located)),
        share("an extra name", count(&|s| s.extra > 0)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::claim::Columns;
    use crate::laboratory::oracle::Oracle;

    #[test]
    fn an_effect_in_given_noise_has_the_gain_asked_for() {
        let (rows, n) = (8000, 0.5);
        let mut dice = Dice::new(7);
        let noise = super::super::noise::white(&mut dice, n, rows, 5.0);
        let claim = Claim {
            rate_hz: 5.0,
            description: String::new(),
            levels: Levels { n, b: 0.01, k: 0.01 },
            levels_rel: [0.02, 0.1, 0.1],
            bias_deg_h: 3.0,
            bias_sd_deg_h: 1.0,
            temperature: None,
            scale_ppm: None,
            earth_deg: None,
        };
        let part = Part { name: "white".to_owned(), claim, noise: noise.clone() };
        let plain = bench(&part, Dice::new(1));
        assert!(plain.residual().iter().zip(&noise).all(|(r, v)| (r - v).abs() < 1e-9));
        let white = Oracle::new(&plain.claim, &Columns::new(), &plain.residual()).whitened();
        let mean_square = white.iter().map(|w| w * w).sum::<f64>() / white.len() as f64;
        assert!((mean_square - 1.0).abs() < 0.06, "{mean_square}");
        let step = SUBJECTS.iter().find(|s| s.name == "bias_step").unwrap();
        let case = case::on_bench(step, bench(&part, Dice::new(2)), [60.0, 60.0], None, 1).unwrap();
        let told = case.truth.concealed[0].gain.unwrap();
        assert!((told / 60.0 - 1.0).abs() < 0.05, "{told}");
    }
}
