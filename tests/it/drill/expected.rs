//! What must catch each corruption, written by hand.

/// What a corruption comes to.
#[derive(Debug, Clone, Copy)]
pub enum Expect {
    /// The verdict, that of every row and, within their intervals, the values stay as they are.
    Same,
    /// A condition of this id that is a remark or not met; its sentence holds the fragment.
    Condition(&'static str, &'static str),
    /// The same, and the condition is not met: the verdict is indeterminate.
    Invalid(&'static str, &'static str),
    /// A fault of this kind is listed; its sentence holds the fragment.
    Fault(&'static str, &'static str),
    /// No diagnostic names it, and nothing is accepted: the row of this measurand fails.
    Fails(&'static str),
    /// The recording is refused; the message holds the fragment.
    Refused(&'static str),
    /// Refused by a reader that does not know the form, or read as it is meant.
    RefusedOrSame(&'static str),
}

use Expect::{Condition, Fails, Fault, Invalid, Refused, RefusedOrSame, Same};

/// A corruption, and what it comes to on each sample.
pub type Case = (&'static str, [Expect; 4]);

const fn all(e: Expect) -> [Expect; 4] {
    [e, e, e, e]
}

/// The records of 100 h stay long enough, those of 10.6 h become too short.
const fn short(long: Expect) -> [Expect; 4] {
    let too_short = Invalid("duration", "h usable");
    [long, long, too_short, too_short]
}

/// Every corruption.
pub const CASES: &[Case] = &[
    ("rate_in_deg_s", all(Invalid("earth_rate", "look like deg/s, not deg/h"))),
    ("rate_in_rad_s", all(Invalid("earth_rate", "look like rad/s, not deg/h"))),
    ("rate_in_mrad_s", all(Invalid("earth_rate", "look like mrad/s, not deg/h"))),
    ("rate_in_urad_s", all(Invalid("earth_rate", "look like urad/s, not deg/h"))),
    ("rate_in_deg_min", all(Invalid("earth_rate", "look like deg/min, not deg/h"))),
    ("rate_in_rad_h", all(Invalid("earth_rate", "look like rad/h, not deg/h"))),
    ("rate_in_mdeg_h", all(Invalid("earth_rate", "look like mdeg/h, not deg/h"))),
    ("rate_in_mdeg_s", all(Invalid("earth_rate", "look like mdeg/s, not deg/h"))),
    ("rate_in_arcmin_h", all(Invalid("earth_rate", "look like arcmin/h, not deg/h"))),
    ("rate_in_arcsec_h", all(Invalid("earth_rate", "look like arcsec/h, not deg/h"))),
    // 1 arcsec/s is 1 deg/h.
    ("rate_in_arcsec_s", all(Same)),
    ("rate_converted_from_rad_s_twice", all(Invalid("earth_rate", "from rad/s to deg/h one time too many"))),
    ("sign_flipped", all(Invalid("earth_rate", "the sign is reversed"))),
    ("earth_rate_taken_out", all(Invalid("earth_rate", "already removed"))),
    ("axis_north", all(Invalid("earth_rate", "an axis that points north"))),
    (
        "rate_and_temperature_exchanged",
        all(Invalid("earth_rate", "columns of `rate` and `temp` are exchanged")),
    ),
    ("rate_and_temperature_exchanged_with_header", all(Same)),
    ("time_and_rate_exchanged", all(Refused("this is not a time column"))),
    ("hour_dropped", all(Invalid("longest_gap", "longer than allowed"))),
    ("hour_dropped_stamps_anew", short(Same)),
    ("block_of_50_doubled", all(Invalid("backward_timestamps", "more than allowed"))),
    ("block_of_50_doubled_stamps_anew", all(Invalid("repeated", "50 found"))),
    ("block_of_2000_doubled", all(Invalid("backward_timestamps", "more than allowed"))),
    ("block_of_2000_doubled_stamps_anew", all(Invalid("repeated", "2000 found"))),
    ("file_appended_to_itself_stamps_anew", all(Fault("repeated", "are a bit-for-bit copy of"))),
    ("every_row_twice", all(Fault("stuck", "each value is repeated"))),
    ("clock_ahead_5_h", all(Invalid("longest_gap", "longer than allowed"))),
    ("clock_ahead_60_years", all(Fault("gap", "the clock jumps ahead"))),
    // Two hours are 720 rows at 0.1 Hz: too few to tell a clock that was set back from rows that came late.
    (
        "clock_back_2_h",
        [
            Invalid("backward_timestamps", "720 found"),
            Invalid("backward_timestamps", "720 found"),
            Fault("backward_timestamp", "the clock was set back"),
            Fault("backward_timestamp", "the clock was set back"),
        ],
    ),
    ("clock_in_ms", all(Invalid("noise_level", "look like ms, read as seconds"))),
    ("clock_in_us", all(Refused("no gyro is sampled so"))),
    ("clock_in_thousands_of_s", all(Refused("the recording lasts"))),
    ("clock_4_percent_slow", all(Condition("clock", "the clock is wrong"))),
    ("constant_added_to_stamps", all(Same)),
    ("stamps_rounded_to_100_s", all(Condition("time_base", "share timestamps"))),
    ("stamps_jittered", all(Same)),
    ("clipped", all(Invalid("saturated", "more than allowed"))),
    ("clipped_above", all(Invalid("saturated", "more than allowed"))),
    ("stuck_for_200", all(Invalid("stuck", "more than allowed"))),
    ("stuck_for_all", all(Invalid("stuck", "more than allowed"))),
    ("thermometer_stuck", all(Fault("stuck", "never changes"))),
    ("temperature_in_degF", all(Invalid("units", "the column is in degF"))),
    ("temperature_in_K", all(Invalid("units", "the column is in K"))),
    ("temperature_1_degC_too_high", all(Invalid("temperature", "Channel temp reached 21."))),
    ("decimal_point_lost_in_10_rows", all(Fault("outlier", "robust standard deviations"))),
    ("decimal_point_lost_in_1_percent", all(Invalid("outliers", "more than allowed"))),
    ("decimal_point_lost_in_all", all(Invalid("earth_rate", "5 digits too far to the right, or was lost"))),
    ("decimal_comma_in_some_rows", all(Invalid("unparsable", "more than allowed"))),
    ("thousands_separators", all(Refused("column `time_s` is not numeric"))),
    ("half_a_file", all(Invalid("unparsable", "more than allowed"))),
    ("unfinished_last_line", all(Invalid("unparsable", "more than allowed"))),
    ("no_newline_at_the_end", all(Same)),
    ("second_header", all(Fault("unparsable", "`rate_deg_h`"))),
    ("another_units_file", all(Invalid("unit_named", "states `SN-0002`, but the test is for SN-0001"))),
    ("serial_line_missing", all(Same)),
    ("another_recording_appended", all(Fault("backward_timestamp", "the clock was set back"))),
    (
        "another_recording_appended_stamps_anew",
        [
            Condition("steadiness", "the noise between neighbouring samples"),
            Condition("steadiness", "the noise between neighbouring samples"),
            Condition("steadiness", "the mean steps by"),
            Condition("steadiness", "the mean steps by"),
        ],
    ),
    ("rows_shuffled", all(Refused("this is not a time column"))),
    // The stamp that jumps back in the last sample steps ahead when the rows are reversed.
    (
        "rows_reversed",
        [
            Refused("the timestamps do not increase"),
            Refused("the timestamps do not increase"),
            Refused("the timestamps do not increase"),
            Refused("this is not a time column"),
        ],
    ),
    (
        "every_third_row_lost",
        [
            Invalid("gaps", "more than allowed"),
            Invalid("gaps", "more than allowed"),
            Invalid("gaps", "more than allowed"),
            Condition("clock", "rows are missing at regular intervals"),
        ],
    ),
    ("1_percent_of_rows_lost", all(Invalid("gaps", "more than allowed"))),
    ("5_percent_nan", all(Invalid("non_finite", "more than allowed"))),
    ("20_spikes", all(Fault("outlier", "robust standard deviations"))),
    ("half_a_percent_spikes", all(Invalid("outliers", "more than allowed"))),
    ("fields_swapped_in_1_percent", all(Invalid("outliers", "more than allowed"))),
    ("quantised_to_0.1", all(Condition("output", "the output is quantised in steps of 0.1"))),
    ("averaged_by_10", all(Condition("output", "the output was averaged or filtered"))),
    ("upsampled_by_repetition", all(Fault("stuck", "each value is repeated 4.0 times"))),
    ("upsampled_by_interpolation", all(Fault("interpolated", "the output was interpolated"))),
    ("bias_step", all(Condition("steadiness", "the mean steps by"))),
    ("warm_up_cut_off", short(Same)),
    ("warm_up_cut_off_stamps_anew", short(Same)),
    // In 100 h the fit takes a transient of the first hours for random walk: the unit fails, and the cause is not named.
    (
        "long_warm_up",
        [
            Fails("russian_drift_100s"),
            Fails("russian_drift_100s"),
            Condition("warm_up", "a transient of"),
            Condition("warm_up", "a transient of"),
        ],
    ),
    ("crlf", all(Same)),
    ("bom", all(Same)),
    ("semicolons_and_decimal_commas", all(Same)),
    ("tabs", all(Same)),
    ("utf16", all(RefusedOrSame("UTF-16"))),
    ("gzip", all(Same)),
    ("trailing_garbage", all(Fault("unparsable", "*** end of transfer ***"))),
    ("trailing_nul_bytes", all(Invalid("unparsable", "more than allowed"))),
    ("rate_column_empty", all(Refused("fewer than two usable numbers"))),
    ("temperature_column_empty", all(Invalid("temperature", "has no usable values"))),
    ("empty_column_added", all(Same)),
    ("header_says_deg_s", all(Refused("did you mean `rate_deg_s`?"))),
    ("header_says_deg_s_column_by_position", all(Invalid("units", "Column `rate_deg_s` states deg/s"))),
];
