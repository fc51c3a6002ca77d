//! The tables of a procedure that ask for a test over temperature, and for the warm-up time.

use crate::config::spec::{Range, Word};
use crate::config::table::{Table, words};
use crate::temperature::{SegmentKind, StartAsked, StatedSegment, TemperatureTest, WarmUpTest};

/// Temperatures that a unit can have, degC.
pub(super) const REACHABLE_DEG_C: Range = Range::between(-273.15, 1000.0);

/// Kinds of stated segments.
pub const SEGMENT_KINDS: &[Word] = &[
    ("soak", "constant temperature before the first ramp"),
    ("heating", "rising temperature"),
    ("cooling", "falling temperature"),
    ("dwell", "constant temperature after a ramp"),
];

words!(SegmentKind, SEGMENT_KINDS, |word: &str| SegmentKind::ALL.into_iter().find(|kind| kind.id() == word));

/// A temperature test: ramps and dwells, checked from the recording. This table makes the temperature measurands
/// available.
#[derive(Table)]
#[table("temperature_test")]
pub(crate) struct TemperatureKeys {
    /// Channel with the role `temperature` used as the reference for the bias: the sensor nearest to the coil.
    #[key(id, example = "temp")]
    channel: String,
    /// Channel with the role `temperature` that has the chamber set point; segments are then found from it.
    /// Default: `channel`.
    #[key(id, example = "chamber")]
    command: Option<String>,
    /// Lowest temperature to be reached.
    #[key(quantity = "degC", range = REACHABLE_DEG_C, example = "-40 degC")]
    low_deg_c: f64,
    /// Highest temperature to be reached.
    #[key(quantity = "degC", range = REACHABLE_DEG_C, example = "60 degC")]
    high_deg_c: f64,
    /// Maximum shortfall from an end point.
    #[key(difference = "degC", above = 0, default = "2 degC", example = "2 degC")]
    end_tolerance_deg_c: f64,
    /// Maximum overshoot of an end point. If omitted, not judged.
    #[key(difference = "degC", above = 0, example = "3 degC")]
    overshoot_deg_c: Option<f64>,
    /// Nominal ramp rate. Default: any from `slowest` to `fastest`.
    #[key(difference = "degC/h", above = 0, example = "20 degC/h")]
    ramp_rate_deg_c_h: Option<f64>,
    /// Maximum relative difference from the nominal rate.
    #[key(quantity = "1", above = 0, max = 0.5, default = "10 %", example = "10 %")]
    ramp_rate_tolerance: f64,
    /// Slowest ramp allowed.
    #[key(difference = "degC/h", above = 0, default = "4 degC/h", example = "4 degC/h")]
    slowest_deg_c_h: f64,
    /// Fastest ramp allowed.
    #[key(difference = "degC/h", above = 0, default = "60 degC/h", example = "60 degC/h")]
    fastest_deg_c_h: f64,
    /// Minimum length of a dwell between ramps. If omitted, not judged.
    #[key(quantity = "s", above = 0, example = "1 h")]
    dwell_s: Option<f64>,
    /// Maximum temperature drift in the second half of a dwell.
    #[key(difference = "degC/h", above = 0, default = "1 degC/h", example = "1 degC/h")]
    dwell_drift_deg_c_h: f64,
    /// Minimum number of ramps in each direction.
    #[key(min = 0, max = 100, default = 1, example = 3)]
    ramps_each_way: usize,
    /// Standard uncertainty (k = 1) of the sensor, calibration and drift included.
    #[key(difference = "degC", min = 0, example = "0.1 degC")]
    sensor_uncertainty_deg_c: f64,
    /// Multiple of the sensor's uncertainty by which requirements are narrowed.
    #[key(min = 0, max = 4, default = 2.0, example = 2.0)]
    coverage_factor: f64,
    /// Zones of temperature, evenly from `low` to `high`, in which the noise is determined.
    #[key(min = 0, max = 21, default = 5, example = 5)]
    zones: usize,
    /// Averaging time of the residual.
    #[key(quantity = "s", above = 0, default = "100 s", example = "100 s")]
    residual_average_s: f64,
    /// Highest order of the polynomial in temperature; the order is chosen by holding out whole ramps.
    #[key(min = 1, max = 6, default = 6, example = 4)]
    highest_order: usize,
    /// Segments of the schedule; detected from the recording if omitted.
    #[key(name = "segment")]
    segments: Vec<SegmentKeys>,
}

/// A segment of the schedule, in the order of time.
#[derive(Table)]
#[table("temperature_test.segment")]
pub(crate) struct SegmentKeys {
    /// What it is.
    #[key(required, example = "heating")]
    kind: Option<SegmentKind>,
    /// Start, from the beginning of the recording.
    #[key(quantity = "s", min = 0, example = "2 h")]
    from_s: f64,
    /// End, from the beginning of the recording.
    #[key(quantity = "s", above = 0, example = "7 h")]
    to_s: f64,
}

impl From<TemperatureKeys> for TemperatureTest {
    fn from(keys: TemperatureKeys) -> TemperatureTest {
        let (low, high) = (keys.low_deg_c, keys.high_deg_c);
        let zone = |i: usize| match keys.zones {
            1 => 0.5 * (low + high),
            n => low + (high - low) * i as f64 / (n - 1) as f64,
        };
        let segment = |s: SegmentKeys| Some(StatedSegment { kind: s.kind?, from_s: s.from_s, to_s: s.to_s });
        TemperatureTest {
            channel: keys.channel,
            command: keys.command,
            low_deg_c: low,
            high_deg_c: high,
            end_tolerance_deg_c: keys.end_tolerance_deg_c,
            overshoot_deg_c: keys.overshoot_deg_c,
            ramp_rate_deg_c_h: keys.ramp_rate_deg_c_h,
            ramp_rate_tolerance: keys.ramp_rate_tolerance,
            slowest_deg_c_h: keys.slowest_deg_c_h,
            fastest_deg_c_h: keys.fastest_deg_c_h,
            dwell_s: keys.dwell_s,
            dwell_drift_deg_c_h: keys.dwell_drift_deg_c_h,
            ramps_each_way: keys.ramps_each_way,
            sensor_uncertainty_deg_c: keys.sensor_uncertainty_deg_c,
            coverage_factor: keys.coverage_factor,
            zones_deg_c: (0..keys.zones).map(zone).collect(),
            residual_average_s: keys.residual_average_s,
            highest_order: keys.highest_order,
            segments: keys.segments.into_iter().filter_map(segment).collect(),
        }
    }
}

/// Sources of the time of turn-on.
pub const TURN_ON_SOURCES: &[Word] = &[
    ("declared", "the procedure: at the first row; reports say that it is declared, not seen"),
    ("stamp", "the stamps: at `power_on`"),
    ("supply", "a supply that comes on in the recording"),
    ("temperature", "a thermometer that stands at `cold` first and rises"),
];

/// A warm-up test, from turn-on. The recording must show the turn-on, or the procedure must declare it: a recording
/// with its start missing shows a shorter warm-up. Otherwise no warm-up time can pass.
#[derive(Table)]
#[table("warm_up_test")]
pub(crate) struct WarmUpKeys {
    /// Maximum deviation of the bias from its final value once the unit is warm.
    #[key(quantity = "deg/h", above = 0, example = "0.01 deg/h")]
    band_deg_h: f64,
    /// Share of the recording, at its end, whose mean is the final value.
    #[key(quantity = "1", above = 0, max = 0.5, default = "25 %", example = "25 %")]
    final_share: f64,
    /// What shows the turn-on time. If omitted, it is unknown and no warm-up time can pass.
    #[key(choice = TURN_ON_SOURCES, example = "declared")]
    start: Option<&'static str>,
    /// With `start = "supply"` the channel of the supply, with `"temperature"` that of the thermometer on the unit.
    #[key(id, example = "supply")]
    start_channel: Option<String>,
    /// With `start = "stamp"`: the timestamp of turn-on.
    #[key(quantity = "s", min = 0, default = "0 s", example = "0 s")]
    power_on_s: f64,
    /// With `start = "temperature"`: temperature of the cold unit, that of the chamber.
    #[key(quantity = "degC", range = REACHABLE_DEG_C, example = "23 degC")]
    cold_deg_c: Option<f64>,
    /// Maximum difference of the first temperature from `cold`; the unit must warm up by three times as much.
    #[key(difference = "degC", above = 0, default = "0.5 degC", example = "0.5 degC")]
    cold_tolerance_deg_c: f64,
}

impl From<WarmUpKeys> for WarmUpTest {
    fn from(keys: WarmUpKeys) -> WarmUpTest {
        let (band_deg_h, final_share) = (keys.band_deg_h, keys.final_share);
        WarmUpTest { band_deg_h, final_share, start: keys.start().unwrap_or(StartAsked::Nothing) }
    }
}

impl WarmUpKeys {
    fn start(self) -> Option<StartAsked> {
        Some(match self.start? {
            "declared" => StartAsked::Declared,
            "stamp" => StartAsked::Stamp { power_on_s: self.power_on_s },
            "supply" => StartAsked::Supply { channel: self.start_channel? },
            _ => StartAsked::Temperature {
                channel: self.start_channel?,
                cold_deg_c: self.cold_deg_c?,
                tolerance_deg_c: self.cold_tolerance_deg_c,
            },
        })
    }
}
