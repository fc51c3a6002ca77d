//! Identification of noise: mixes of known truth against Cramér-Rao bounds, against a fit that knows the true structure, and
//! against the usual methods on the same records.

pub mod allan;
pub mod alternatives;
pub mod claims;
pub mod flicker_or_markov;
pub mod generator;
pub mod gmwm;
pub mod mixes;
pub mod oracle;
pub mod record;
mod rivals;
mod rows;
pub mod run;
pub mod sample_rates;
pub mod tally;
pub mod whittle;

use crate::study::{Case, Study};
use run::Source;

/// Every mix at two lengths.
pub static STUDY: Study = Study {
    id: "identification",
    title: "Identification of noise",
    method: "Twenty mixes of noise, 10 and 100 h at 1 Hz, in turn from the simulator of the program and from a generator that shares \
             nothing with it. A term counts as identifiable where its Cramér-Rao bound is at most 20 %; only of such is something \
             asked. Errors are over the bound, widths over those of a fit that knows the true structure. A record tells a slow \
             term where others that could stand for it raise the deviance by more than 2.71. Usual methods: a fit of the \
             logarithms of the Allan deviation, its slopes, its minimum over 0.664, non-negative least squares of the Allan \
             variance, and wavelet moments that know the structure.",
    records: 200,
    cases,
};

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for hours in [10u64, 100] {
        for (i, mix) in (0u64..).zip(mixes::mixes()) {
            cases.push(Case::new(format!("{}, {hours} h", mix.name), move |records, seed| {
                let seed = (seed * 1000 + i) * 1000 + hours;
                rows::rows(&run::study(&mix, hours as f64, records as usize, seed, Source::Both))
            }));
        }
    }
    cases
}
