//! What the likelihood tells of flicker and a long Markov process, both structures being known.

use super::mixes::{Mix, mixes};
use super::oracle::Oracle;
use super::run::simulated;
use super::whittle::Layout;
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::noise::composite::{Composite, Damped, Parameter};
use sagnac::noise::data::NoiseType;
use sagnac::noise::model::NoiseModel;

/// Flicker given up for a Markov process that describes the record better by a margin.
pub static STUDY: Study = Study {
    id: "flicker-or-markov",
    title: "Flicker or a long Markov process",
    method: "10 h of white noise with flicker and of white noise with a Markov process of 600 s, each described by both structures \
             and nothing else. Flicker is given up where the best Markov process has a deviance that is smaller by a margin. The \
             two overlap so far that no margin serves both.",
    records: 400,
    cases: || vec![Case::new("10 h", rows)],
};

/// Deviance of the best Markov process less that of flicker, each beside white noise, and given that there is nothing else.
fn flicker_over_markov(mix: &Mix, samples: usize, records: u64, seed: u64) -> Vec<f64> {
    let layout = Layout::new(samples, &mix.truth);
    let white: Composite = NoiseModel { n: mix.truth.terms.n, ..Default::default() }.into();
    let n = Parameter::Coefficient(NoiseType::AngleRandomWalk);
    let flicker = white.with(Parameter::Coefficient(NoiseType::Flicker), 0.006);
    let markov = |time_s: f64| Composite {
        markov: vec![Damped { rms_deg_h: 0.01, frequency_hz: 0.0, decay_time_s: time_s }],
        ..white.clone()
    };
    (0..records)
        .into_par_iter()
        .map(|run| {
            let data = layout.data(&simulated(mix, samples, seed + run));
            let deviance = |start: &Composite, parameters: &[Parameter]| {
                Oracle { layout: &layout, data: &data, parameters, start }.fit().deviance
            };
            let process = [n, Parameter::MarkovSigma(0), Parameter::MarkovTime(0)];
            let of_markov = [150.0, 600.0, 2400.0].map(|t| deviance(&markov(t), &process));
            of_markov.into_iter().fold(f64::INFINITY, f64::min)
                - deviance(&flicker, &[n, Parameter::Coefficient(NoiseType::Flicker)])
        })
        .collect()
}

fn rows(records: u64, seed: u64) -> Vec<Row> {
    let of = |name: &str| {
        let mix = mixes().into_iter().find(|m| m.name == name).expect("a mix");
        flicker_over_markov(&mix, 36_000, records, seed * 100_000)
    };
    let mut rows = vec![];
    for (name, claim) in [("N+B", "B is kept"), ("N+long Markov", "B is claimed")] {
        let all = of(name);
        for margin in 0..8 {
            let hits = all.iter().filter(|d| **d > -f64::from(margin)).count() as u64;
            let claim = format!("{claim} at a margin of {margin}");
            rows.push(Row::share(name, claim, Asked::Nothing, hits, records));
        }
    }
    rows
}
