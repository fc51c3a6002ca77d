//! How every measurand behaves where a truth lies at its edge, or where a second effect walks in step with the first.
//!
//! Each family of measurands is a table of cases in `studies/cases/edges/`, and a file with the generator of its recordings,
//! which imports nothing from the analysis. One line in [`FAMILIES`] and a study name both.

pub mod case;
mod declared;
mod frequency;
mod gravity;
mod influence;
mod noise;
mod noise_bands;
mod on_table;
mod overload;
mod rate_table;
mod rest;
mod small_rates;
mod soaks;
mod start_up;
mod table;
pub mod tally;
mod temperature;
mod tilts;
mod vibration;

use crate::study::{Case, Study};
use case::{Family, Simulated};
use sagnac::record::MeasurandRecord;
use sagnac::{Procedure, Recording, UnitUnderTest};
use std::path::Path;
use std::sync::LazyLock;
use table::Bench;

/// Every family.
pub static FAMILIES: LazyLock<[Family; 14]> = LazyLock::new(|| {
    [
        family::<declared::Declared>(include_str!("../../cases/edges/declared.toml")),
        family::<frequency::OverFrequency>(include_str!("../../cases/edges/frequency.toml")),
        family::<gravity::InGravity>(include_str!("../../cases/edges/gravity.toml")),
        family::<influence::Bench>(include_str!("../../cases/edges/influence.toml")),
        family::<rest::Rest>(include_str!("../../cases/edges/noise.toml")),
        family::<rest::Rest>(include_str!("../../cases/edges/noise_bands.toml")),
        family::<overload::Rails>(include_str!("../../cases/edges/overload.toml")),
        family::<rate_table::Bench>(include_str!("../../cases/edges/rate_table.toml")),
        family::<small_rates::Sweep>(include_str!("../../cases/edges/small_rates.toml")),
        family::<crate::bench::soaks::Soaks>(include_str!("../../cases/edges/soaks.toml")),
        family::<start_up::Start>(include_str!("../../cases/edges/start_up.toml")),
        family::<temperature::Bench>(include_str!("../../cases/edges/temperature.toml")),
        family::<tilts::TwoAxes>(include_str!("../../cases/edges/tilts.toml")),
        family::<vibration::ByFrequency>(include_str!("../../cases/edges/vibration.toml")),
    ]
});

fn family<B: Bench>(table: &str) -> Family {
    Family::read::<B>(table).unwrap_or_else(|wrong| panic!("a table of cases: {wrong}"))
}

const METHOD: &str = "Every measurand where its truth is exactly zero, between the points of the schedule, below the noise, beside \
    a large other effect of its family, with a nuisance in step with the stimulus, in the shortest record and with the coarsest \
    schedule. The recordings come from generators that share nothing with the analysis and are tested as a \
    user would. Bounds may hold the truth always; widths are over those of an oracle that knows everything else; units \
    exactly at their limit may pass, and fail, in 5 %.";

const fn study(id: &'static str, title: &'static str, cases: fn() -> Vec<Case>) -> Study {
    Study { id, title, method: METHOD, records: 200, cases }
}

/// Influences that a procedure declares.
pub static DECLARED: Study =
    study("edges-declared", "Declared influences at their edges", || cases("declared"));
/// Response over frequency.
pub static FREQUENCY: Study =
    study("edges-frequency", "Transfer functions at their edges", || cases("frequency"));
/// Sensitivity to acceleration.
pub static GRAVITY: Study = study("edges-gravity", "Acceleration at its edges", || cases("gravity"));
/// Repeatability, and sensitivities to a field, a supply and vibration.
pub static INFLUENCE: Study = study("edges-influence", "Influences at their edges", || cases("influence"));
/// Noise of a unit at rest.
pub static NOISE: Study = study("edges-noise", "Noise at its edges", || cases("noise"));
/// Output noise and its density in bands.
pub static NOISE_BANDS: Study =
    study("edges-noise-bands", "Noise in bands at its edges", || cases("noise_bands"));
/// Rates up to the range of a unit and beyond.
pub static OVERLOAD: Study = study("edges-overload", "Overload at its edges", || cases("overload"));
/// Scale factor and what belongs to it.
pub static RATE_TABLE: Study =
    study("edges-rate-table", "Scale factors at their edges", || cases("rate_table"));
/// Dead zones and thresholds.
pub static SMALL_RATES: Study =
    study("edges-small-rates", "Small rates at their edges", || cases("small_rates"));
/// Scale factor over temperature.
pub static SOAKS: Study =
    study("edges-soaks", "Scale factors over temperature at their edges", || cases("soaks"));
/// Switching on.
pub static START_UP: Study = study("edges-start-up", "Start-up at its edges", || cases("start_up"));
/// Bias over temperature and the warm-up.
pub static TEMPERATURE: Study =
    study("edges-temperature", "Temperature at its edges", || cases("temperature"));
/// Tilts of the input axis.
pub static TILTS: Study = study("edges-tilts", "Tilts at their edges", || cases("tilts"));

/// Vibration by frequency.
pub static VIBRATION: Study =
    study("edges-vibration", "Vibration by frequency at its edges", || cases("vibration"));

fn cases(family: &str) -> Vec<Case> {
    let case = |case: &'static case::Case| {
        Case::new(&case.name, move |records, seed| {
            let records = records.min(case.records as u64) as usize;
            let tallies = tally::run(case, records, 1_000_000 * seed, &by_the_library);
            tallies.iter().flat_map(tally::Tally::rows).collect()
        })
    };
    FAMILIES.iter().filter(|f| f.name == family).flat_map(|f| f.cases.iter().map(case)).collect()
}

/// Tests the files of a folder by the library.
///
/// # Errors
/// Refusals of the library, as text.
pub fn by_the_library(simulated: &Simulated, folder: &Path) -> Result<Vec<MeasurandRecord>, String> {
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
