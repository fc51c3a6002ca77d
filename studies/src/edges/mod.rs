//! How every measurand behaves where a truth lies at its edge, or where a second effect walks in step with the first.
//!
//! Each family of measurands is one file with its cases and a generator of its own, which imports nothing from the analysis,
//! and one line in [`FAMILIES`] with its study.

pub mod case;
pub mod influence;
pub mod noise;
mod on_table;
pub mod rate_table;
pub mod small_rates;
pub mod tally;
pub mod temperature;
pub mod tilts;

use crate::study::{Case, Study};
use case::{Family, Simulated};
use sagnac::record::MeasurandRecord;
use sagnac::{Procedure, Recording, UnitUnderTest};
use std::path::Path;

/// Every family. One more: one file and one line.
pub static FAMILIES: &[&Family] = &[
    &influence::FAMILY,
    &noise::FAMILY,
    &rate_table::FAMILY,
    &small_rates::FAMILY,
    &temperature::FAMILY,
    &tilts::FAMILY,
];

const METHOD: &str = "Every measurand where its truth is exactly zero, between the points of the schedule, below the noise, beside \
    a large other effect of its family, with a nuisance in step with the stimulus, in the shortest record and with the coarsest \
    schedule. The recordings come from generators that share nothing with the analysis and are tested as a \
    user would. Bounds may hold the truth always; widths are over those of an oracle that knows everything else; units \
    exactly at their limit may pass, and fail, in 5 %.";

const fn study(id: &'static str, title: &'static str, cases: fn() -> Vec<Case>) -> Study {
    Study { id, title, method: METHOD, records: 200, cases }
}

/// Repeatability, and sensitivities to a field, a supply and vibration.
pub static INFLUENCE: Study =
    study("edges-influence", "Influences at their edges", || cases(&influence::FAMILY));
/// Noise of a unit at rest.
pub static NOISE: Study = study("edges-noise", "Noise at its edges", || cases(&noise::FAMILY));
/// Scale factor and what belongs to it.
pub static RATE_TABLE: Study =
    study("edges-rate-table", "Scale factors at their edges", || cases(&rate_table::FAMILY));
/// Dead zones and thresholds.
pub static SMALL_RATES: Study =
    study("edges-small-rates", "Small rates at their edges", || cases(&small_rates::FAMILY));
/// Bias over temperature and the warm-up.
pub static TEMPERATURE: Study =
    study("edges-temperature", "Temperature at its edges", || cases(&temperature::FAMILY));
/// Tilts of the input axis.
pub static TILTS: Study = study("edges-tilts", "Tilts at their edges", || cases(&tilts::FAMILY));

fn cases(family: &'static Family) -> Vec<Case> {
    let case = |case: &'static case::Case| {
        Case::new(case.name, move |records, seed| {
            let records = records.min(case.records as u64) as usize;
            let tallies = tally::run(case, records, 1_000_000 * seed, &by_the_library);
            tallies.iter().flat_map(tally::Tally::rows).collect()
        })
    };
    family.cases.iter().map(case).collect()
}

/// Tests the files of a folder by the library.
fn by_the_library(simulated: &Simulated, folder: &Path) -> Result<Vec<MeasurandRecord>, String> {
    let tested = || {
        let mut procedure = Procedure::load(folder.join("p.toml"))?;
        if simulated.is_limited() {
            procedure = procedure.with_limits(folder.join("l.toml"))?;
        }
        let recording = Recording::open(folder.join("r.csv"))?;
        procedure.run(&recording, &UnitUnderTest::with_serial("SN-0001"))
    };
    tested().map(|result| result.record().measurands.clone()).map_err(|e: sagnac::Error| e.to_string())
}
