//! The table of a procedure that asks for the start-up.

use super::temperature::REACHABLE_DEG_C;
use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::i18n::note;
use crate::measurand::Test;
use crate::recording::Role;
use crate::start_up::{StartUpTest, Valid, Zone};

/// A test of the start-up: the recording begins before the supply (role `supply`) is switched on. This table makes its measurands
/// available: `time_to_first_sample`, `time_to_valid_data`, `power_steady`, `power_peak` and `inrush_current`. A recording that
/// begins after switching on gives bounds only.
#[derive(Table)]
#[table("start_up_test")]
pub(crate) struct StartUpKeys {
    /// Supply voltage from which on the unit is on.
    #[key(quantity = "V", above = 0, example = "3 V")]
    on_voltage_v: f64,
    /// Time from switching on to steady power.
    #[key(quantity = "s", min = 0, default = "60 s", example = "60 s")]
    steady_after_s: f64,
    /// Time from switching on in which the inrush current is sought.
    #[key(quantity = "s", above = 0, default = "1 s", example = "100 ms")]
    inrush_within_s: f64,
    /// Bits of the channel with the role `status` that are all 1 where data are valid.
    #[key(min = 1, max = 9007199254740991, example = 1.0)]
    valid_mask: Option<f64>,
    /// Half the width of the band about its final level within which the output is valid; instead of `valid_mask`.
    #[key(quantity = "deg/h", above = 0, example = "0.5 deg/h")]
    valid_band_deg_h: Option<f64>,
    /// Length of the means that are held against the band.
    #[key(quantity = "s", above = 0, default = "1 s", example = "1 s")]
    average_s: f64,
    /// Standard uncertainty (k = 1) of the voltage.
    #[key(quantity = "1", min = 0, max = 1, default = "0.1 %", example = "0.1 %")]
    voltage_uncertainty: f64,
    /// Standard uncertainty (k = 1) of the current.
    #[key(quantity = "1", min = 0, max = 1, default = "0.5 %", example = "0.5 %")]
    current_uncertainty: f64,
    /// Zones of temperature, for a recording in which the supply is switched on at several: each switching-on belongs to the zone that
    /// the mean temperature while on lies in. Rows are named `rate@-40`.
    #[key(name = "zone")]
    zones: Vec<ZoneKeys>,
}

/// A zone of temperature.
#[derive(Table)]
#[table("start_up_test.zone")]
pub(crate) struct ZoneKeys {
    /// Its middle.
    #[key(quantity = "degC", range = REACHABLE_DEG_C, example = "-40 degC")]
    at_deg_c: f64,
    /// Distance from the middle to either end.
    #[key(difference = "degC", above = 0, default = "5 degC", example = "3 degC")]
    within_deg_c: f64,
}

impl From<StartUpKeys> for StartUpTest {
    fn from(keys: StartUpKeys) -> StartUpTest {
        let valid = match (keys.valid_mask, keys.valid_band_deg_h) {
            (Some(mask), _) => Valid::Status { mask: mask as u64 },
            (None, Some(half_width_deg_h)) => Valid::Band { half_width_deg_h, average_s: keys.average_s },
            (None, None) => Valid::Unstated,
        };
        StartUpTest {
            on_voltage_v: keys.on_voltage_v,
            steady_after_s: keys.steady_after_s,
            inrush_within_s: keys.inrush_within_s,
            valid,
            voltage_uncertainty: keys.voltage_uncertainty,
            current_uncertainty: keys.current_uncertainty,
            zones: keys
                .zones
                .into_iter()
                .map(|z| Zone { at_deg_c: z.at_deg_c, half_width_deg_c: z.within_deg_c })
                .collect(),
        }
    }
}

/// What a test of the start-up and its measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let has = |role: Role| procedure.channels.iter().any(|c| c.channel.role == role);
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        let at = section.span_of("id");
        match (&procedure.start_up_test, measurand.test()) {
            (None, Test::StartUp) => {
                let table = "start_up_test";
                reader.error(&at, note!("check_temperature.needs_table", id = measurand.id, table), None);
            }
            (Some(test), Test::StartUp) => {
                let power = matches!(measurand.id, "power_steady" | "power_peak" | "inrush_current");
                if power && !has(Role::Current) {
                    reader.error(&at, note!("start_up.needs_current", id = measurand.id), None);
                }
                if measurand.id == "time_to_valid_data" && test.valid == Valid::Unstated {
                    reader.error(&at, "start_up.needs_valid", None);
                }
            }
            (Some(_), _) => {
                reader.error(&at, note!("influence_check.static", id = measurand.id), None);
            }
            _ => {}
        }
    }
    let Some(section) = root.table("start_up_test") else { return };
    if !has(Role::Supply) {
        reader.error(&section.span.clone(), "start_up.needs_supply", None);
    }
    let zones = procedure.start_up_test.as_ref().map_or(&[][..], |test| &test.zones);
    if let (Some(first), false) = (section.tables("zone").first(), has(Role::Temperature)) {
        reader.error(&first.span.clone(), "start_up.needs_temperature", None);
    }
    for (at, (own, zone)) in section.tables("zone").iter().zip(zones).enumerate() {
        let overlaps = |other: &Zone| {
            (other.at_deg_c - zone.at_deg_c).abs() < other.half_width_deg_c + zone.half_width_deg_c
        };
        if zones.iter().take(at).any(overlaps) {
            reader.error(&own.span_of("at"), "start_up.zones_overlap", None);
        }
    }
    if section.entry("valid_mask").is_some() {
        if section.entry("valid_band").is_some() {
            reader.error(&section.span_of("valid_band"), "start_up.two_signs", None);
        }
        if !has(Role::Status) {
            reader.error(&section.span_of("valid_mask"), "start_up.needs_status", None);
        }
    }
}
