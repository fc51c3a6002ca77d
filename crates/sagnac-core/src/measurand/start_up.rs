//! Time to the first sample and to valid data, and what the unit draws from its supply.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, LowerLimit, SCORE_ONE_SIDED_95, Spread};
use crate::message::{Arg, note};
use crate::start_up::{Drawn, InZone, Moment, StartUp};

/// Names of the methods.
const FROM_SUPPLY_EDGE: &str = "supply_edge";
const SUPPLY_POWER: &str = "supply_power";

/// Probability with which a bound holds.
const CLAIM_CONFIDENCE: f64 = 0.95;

/// Time to the first sample.
pub static TIME_TO_FIRST_SAMPLE: Measurand = Measurand::of_start_up(
    "time_to_first_sample",
    "s",
    "time from switching on to the first sample of the output",
    |m, found| vec![in_zone(found, moment(m, found, found.first_sample))],
)
.formulas(
    &["t = t₁ − t₀", "P = mean(U·I)", "u²(P)/P² = u²(U)/U² + u²(I)/I²"],
    "IEEE Std 952-2020, 12.4, 12.5",
);

/// Time to valid data.
pub static TIME_TO_VALID_DATA: Measurand = Measurand::of_start_up(
    "time_to_valid_data",
    "s",
    "time from switching on to data that are valid from then on",
    |m, found| vec![in_zone(found, moment(m, found, found.valid_data))],
)
.also_called(&["time_to_ready", "activation_time"]);

/// Power in steady state.
pub static POWER_STEADY: Measurand =
    Measurand::of_start_up("power_steady", "W", "mean power in steady state", |m, found| {
        vec![in_zone(found, drawn(m, found, found.power_steady))]
    })
    .also_called(&["power", "power_consumption"]);

/// Largest power.
pub static POWER_PEAK: Measurand =
    Measurand::of_start_up("power_peak", "W", "largest power of a sample", |m, found| {
        vec![in_zone(found, sampled(found, drawn(m, found, found.power_peak)))]
    })
    .also_called(&["peak_power"]);

/// Inrush current.
pub static INRUSH_CURRENT: Measurand =
    Measurand::of_start_up("inrush_current", "A", "largest current after switching on", |m, found| {
        vec![in_zone(found, sampled(found, drawn(m, found, found.inrush_current)))]
    });

fn moment(m: &Measurand, found: &StartUp, moment: Moment) -> Estimate {
    let none = || m.not_identifiable(&found.channel, None, FROM_SUPPLY_EDGE);
    match moment {
        Moment::At { time_s, resolution_s } => m
            .measured(&found.channel, time_s, Spread::of_resolution(time_s, resolution_s), FROM_SUPPLY_EDGE)
            .note(note!("start_up.resolution", resolution_s = Arg::figures(resolution_s, 2))),
        Moment::AtLeast(value) => none()
            .at_least((value > 0.0).then_some(LowerLimit { value, coverage: CLAIM_CONFIDENCE }))
            .note(note!("start_up.began_later")),
        Moment::Never => none().note(note!("start_up.never")),
        Moment::NoStart => none().note(note!("start_up.no_start")),
        Moment::Unstated => none().note(note!("start_up.unstated")),
    }
}

fn drawn(m: &Measurand, found: &StartUp, drawn: Option<Drawn>) -> Estimate {
    let none = || m.not_identifiable(&found.channel, None, SUPPLY_POWER);
    match drawn {
        None => none().note(note!("start_up.no_power")),
        Some(Drawn { value, standard, at_least: true }) => {
            let least = value - SCORE_ONE_SIDED_95 * standard;
            none()
                .at_least(Some(LowerLimit { value: least, coverage: CLAIM_CONFIDENCE }))
                .note(note!("start_up.began_later"))
        }
        Some(Drawn { value, standard, .. }) => {
            let spread = Spread::Normal { standard_uncertainty: standard };
            m.measured(&found.channel, value, spread, SUPPLY_POWER)
        }
    }
}

/// A row of a zone says which switchings-on it is of; one without any says only that.
fn in_zone(found: &StartUp, row: Estimate) -> Estimate {
    match found.zone {
        None => row,
        Some(InZone { starts: 0, .. }) => Estimate { notes: vec![note!("start_up.zone_empty")], ..row },
        Some(InZone { starts, temperature_deg_c }) => {
            row.note(note!("start_up.zone", starts, temperature = Arg::figures(temperature_deg_c, 3)))
        }
    }
}

/// A largest value is that of the samples.
fn sampled(found: &StartUp, row: Estimate) -> Estimate {
    row.note(note!("start_up.sampled", interval_s = Arg::figures(found.interval_s, 2)))
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{near, notes, number, shows, withholds};
    use super::*;

    fn found() -> StartUp {
        StartUp {
            channel: "g".into(),
            interval_s: 0.1,
            zone: None,
            first_sample: Moment::At { time_s: 0.5, resolution_s: 0.1 },
            valid_data: Moment::AtLeast(2.0),
            power_steady: Some(Drawn { value: 2.0, standard: 0.01, at_least: false }),
            power_peak: Some(Drawn { value: 10.0, standard: 0.1, at_least: true }),
            inrush_current: None,
        }
    }

    #[test]
    fn a_time_is_known_to_its_resolution() {
        let row = TIME_TO_FIRST_SAMPLE.evaluate_start_up(&found()).remove(0);
        shows(&row, 0.5, FROM_SUPPLY_EDGE);
        // Even over 0.2 s; the curve is told at quarters of a score.
        assert!((row.interval95().unwrap().high - 0.595).abs() < 2e-4);
    }

    #[test]
    fn a_row_of_a_zone_says_how_many_switchings_on_it_is_of() {
        let of = |starts| StartUp {
            zone: Some(InZone { starts, temperature_deg_c: -40.2 }),
            first_sample: if starts > 0 { found().first_sample } else { Moment::NoStart },
            ..found()
        };
        let row = TIME_TO_FIRST_SAMPLE.evaluate_start_up(&of(2)).remove(0);
        assert_eq!(notes(&row), ["start_up.resolution", "start_up.zone"]);
        near(number(&row, "start_up.zone", "starts"), 2.0);
        let row = TIME_TO_FIRST_SAMPLE.evaluate_start_up(&of(0)).remove(0);
        withholds(&row, None, FROM_SUPPLY_EDGE);
        assert_eq!(notes(&row), ["start_up.zone_empty"]);
    }

    #[test]
    fn a_record_that_begins_later_bounds_from_below() {
        let row = TIME_TO_VALID_DATA.evaluate_start_up(&found()).remove(0);
        withholds(&row, None, FROM_SUPPLY_EDGE);
        near(row.lower_limit.unwrap().value, 2.0);
        let row = POWER_PEAK.evaluate_start_up(&found()).remove(0);
        withholds(&row, None, SUPPLY_POWER);
        near(row.lower_limit.unwrap().value, 10.0 - 0.1 * SCORE_ONE_SIDED_95);
        assert_eq!(notes(&row), ["start_up.began_later", "start_up.sampled"]);
    }

    #[test]
    fn a_power_has_the_uncertainty_of_its_instruments() {
        shows(&POWER_STEADY.evaluate_start_up(&found())[0], 2.0, SUPPLY_POWER);
        let row = INRUSH_CURRENT.evaluate_start_up(&found()).remove(0);
        withholds(&row, None, SUPPLY_POWER);
    }
}
