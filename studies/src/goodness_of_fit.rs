//! Goodness of fit on simulated records: how often correct models are rejected.

use crate::study::{Asked, Case, Row, Study};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::block_series::BlockSeriesAccumulator;
use sagnac::noise::composite::{Composite, Damped, Described, Sampling};
use sagnac::noise::data::{BlockSeries, DeviationPoint, WelchSpectrum};
use sagnac::noise::family::Estimator;
use sagnac::noise::model::NoiseModel;
use sagnac::noise::residual::{GoodnessOfFit, View};
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::spectral_record::SpectralRecord;
use sagnac::noise::tau_grid::TauGrid;
use sagnac::noise::welch::WelchAccumulator;

/// Rejections of correct models, by view.
pub static STUDY: Study = Study {
    id: "goodness-of-fit",
    title: "Goodness of fit of correct models",
    method: "Records of 16 384 or 65 536 samples of models that the identification may claim, and two judged with their true \
             parameters. Each view of the residual gives a p-value.",
    records: 2000,
    cases,
};

/// What one pass leaves of a record at 1 Hz.
pub struct Record {
    /// Means over blocks of samples.
    pub blocks: BlockSeries,
    welch: WelchSpectrum,
    octaves: Vec<DeviationPoint>,
}

impl Record {
    /// With at most `most` block means.
    pub fn of(samples: &[f64], most: usize) -> Record {
        let mut blocks = BlockSeriesAccumulator::with_max_blocks(most);
        blocks.push(samples, 0);
        let mut welch = WelchAccumulator::with_segment(1024);
        welch.push(samples, false);
        let mut allan = AllanAccumulator::new(AllanPlan {
            tau0_s: 1.0,
            grid: TauGrid::Octave,
            exact: false,
            estimators: vec![Estimator::Allan],
        });
        allan.push(samples, 0, false);
        Record {
            blocks: blocks.finish(),
            welch: welch.finish().spectrum,
            octaves: allan.finish().curve(Estimator::Allan).unwrap().points.clone(),
        }
    }

    fn spectral(&self) -> SpectralRecord<'_> {
        SpectralRecord {
            blocks: &self.blocks,
            welch: Some(&self.welch),
            tau0_s: 1.0,
            lines: &[],
            sampling: Sampling::Averaging,
        }
    }

    /// Judges what identification made of the record, or a description that is given.
    pub fn judge(&self, given: Option<&Described>) -> GoodnessOfFit {
        let record = self.spectral();
        let found =
            given.map_or_else(|| record.identify("rate").ranged.identification.described, Clone::clone);
        GoodnessOfFit::of(&record, &found, &self.octaves)
    }
}

/// A record of a model. Quantisation is white noise of the angle here: the simulator rounds, which is no white noise
/// unless the steps are small.
pub fn simulated(model: &Composite, seed: u64, samples: usize) -> Vec<f64> {
    let q = model.terms.q;
    let mut rest = model.clone();
    rest.terms.q = 0.0;
    let mut record = Simulator::of(&rest, &Setup::for_record(seed, 1.0, samples as u64)).take(samples);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(!seed);
    let mut angle = || q * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let mut last = angle();
    for y in &mut record {
        let next = angle();
        // Arcseconds a second are degrees an hour.
        *y += next - last;
        last = next;
    }
    record
}

/// The p-value of one view of the fit, where it was judged.
pub fn p_value(fit: &GoodnessOfFit, view: View) -> Option<f64> {
    fit.views.iter().find(|j| j.view == view).map(|j| j.p_value)
}

struct Mix {
    name: &'static str,
    model: Composite,
    /// Judged with the true parameters and not with fitted ones.
    told: bool,
    samples: usize,
    most_blocks: usize,
}

fn mixes() -> Vec<Mix> {
    let terms = |n, b, k, r, q| Composite::from(NoiseModel { n, b, k, r, q });
    let fitted = |name, model| Mix { name, model, told: false, samples: 16_384, most_blocks: 1 << 18 };
    let markov = Composite {
        markov: vec![Damped { rms_deg_h: 0.1, frequency_hz: 0.0, decay_time_s: 20.0 }],
        ..terms(0.002, 0.0, 0.0, 0.0, 0.0)
    };
    let periodic = Composite {
        quasi_periodic: vec![Damped { rms_deg_h: 0.06, frequency_hz: 0.02, decay_time_s: 300.0 }],
        ..terms(0.002, 0.003, 0.0, 0.0, 0.0)
    };
    vec![
        fitted("N", terms(0.002, 0.0, 0.0, 0.0, 0.0)),
        fitted("N B", terms(0.002, 0.02, 0.0, 0.0, 0.0)),
        fitted("N K", terms(0.002, 0.0, 0.02, 0.0, 0.0)),
        fitted("N B K", terms(0.002, 0.02, 0.02, 0.0, 0.0)),
        fitted("N Q", terms(0.002, 0.0, 0.0, 0.0, 0.1)),
        fitted("N R", terms(0.002, 0.0, 0.0, 0.01, 0.0)),
        Mix {
            most_blocks: 4096,
            samples: 65_536,
            ..fitted("N B, blocks of 16", terms(0.002, 0.02, 0.0, 0.0, 0.0))
        },
        Mix {
            most_blocks: 4096,
            samples: 65_536,
            ..fitted("N K Q, blocks of 16", terms(0.002, 0.0, 0.02, 0.0, 0.1))
        },
        Mix { told: true, ..fitted("N Markov, given", markov) },
        Mix { told: true, ..fitted("N B quasi-periodic, given", periodic) },
    ]
}

/// Number of views of a fit.
pub const VIEWS: usize = View::ALL.len();

impl Mix {
    /// Number of records of this correct model that each view rejects at each level.
    fn false_alarms<const LEVELS: usize>(
        &self,
        records: u64,
        seed: u64,
        levels: [f64; LEVELS],
    ) -> [[u32; VIEWS]; LEVELS] {
        let given = Described { model: self.model.clone(), ..Default::default() };
        (0..records)
            .into_par_iter()
            .map(|i| {
                let samples = simulated(&self.model, seed + i, self.samples);
                let fit = Record::of(&samples, self.most_blocks).judge(self.told.then_some(&given));
                let found = View::ALL.map(|v| p_value(&fit, v).expect("long enough"));
                levels.map(|level| found.map(|p| u32::from(p < level)))
            })
            .reduce(
                || [[0; VIEWS]; LEVELS],
                |a, b| std::array::from_fn(|l| std::array::from_fn(|v| a[l][v] + b[l][v])),
            )
    }
}

/// Share of records of correct models that each view rejects at a level, by mix.
pub fn false_alarms<const LEVELS: usize>(
    records: u64,
    seed: u64,
    levels: [f64; LEVELS],
) -> Vec<(&'static str, [[f64; VIEWS]; LEVELS])> {
    (0u64..)
        .zip(mixes())
        .map(|(place, mix)| {
            let counts = mix.false_alarms(records, seed + place * 10_000_000, levels);
            (mix.name, counts.map(|level| level.map(|c| f64::from(c) / records as f64)))
        })
        .collect()
}

fn cases() -> Vec<Case> {
    mixes()
        .into_iter()
        .enumerate()
        .map(|(place, mix)| {
            Case::new(mix.name, move |records, seed| {
                let shares = mix.false_alarms(records, seed + 10_000_000 * place as u64, LEVELS);
                rows(shares, records)
            })
        })
        .collect()
}

const LEVELS: [f64; 2] = [0.01, 0.05];

fn rows(counts: [[u32; VIEWS]; 2], records: u64) -> Vec<Row> {
    let mut rows = vec![];
    for (level, counts) in LEVELS.into_iter().zip(counts) {
        for (view, count) in View::ALL.iter().zip(counts) {
            // What a fitted walk took of the largest jump makes that p-value an upper bound.
            let asked = match view {
                View::Jump => Asked::AtMost(1.5 * level),
                _ => Asked::Between(0.5 * level, 1.5 * level),
            };
            let claim = format!("a true model is rejected at {level}");
            rows.push(Row::share(format!("{view:?}"), claim, asked, u64::from(count), records));
        }
    }
    rows
}
