//! What a procedure asks of a test over temperature, in inside units.

/// A test over temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct TemperatureTest {
    /// Channel of the temperature that the bias is set against.
    pub channel: String,
    /// Channel of the commanded temperature, where there is one: segments are found from it.
    pub command: Option<String>,
    /// Lowest temperature to be reached, degC.
    pub low_deg_c: f64,
    /// Highest temperature to be reached, degC.
    pub high_deg_c: f64,
    /// How far an end may be missed, degC.
    pub end_tolerance_deg_c: f64,
    /// How far an end may be overshot, degC; `None`: not judged.
    pub overshoot_deg_c: Option<f64>,
    /// Nominal rate of the ramps, degC/h; `None`: any rate within the range.
    pub ramp_rate_deg_c_h: Option<f64>,
    /// Tolerance of the nominal rate, as a share.
    pub ramp_rate_tolerance: f64,
    /// Slowest ramp allowed, degC/h.
    pub slowest_deg_c_h: f64,
    /// Fastest ramp allowed, degC/h.
    pub fastest_deg_c_h: f64,
    /// Least length of a dwell, s; `None`: not judged.
    pub dwell_s: Option<f64>,
    /// How steady a dwell must be, degC/h.
    pub dwell_drift_deg_c_h: f64,
    /// Ramps of each direction that the schedule must have.
    pub ramps_each_way: usize,
    /// Standard uncertainty of the sensor, degC.
    pub sensor_uncertainty_deg_c: f64,
    /// Multiple of it by which requirements are narrowed.
    pub coverage_factor: f64,
    /// Middle temperatures of the zones in which the noise is determined, degC.
    pub zones_deg_c: Vec<f64>,
    /// Averaging time of the residual, s.
    pub residual_average_s: f64,
    /// Highest order of the polynomial.
    pub highest_order: usize,
    /// Segments stated in the procedure; empty: found from the record.
    pub segments: Vec<StatedSegment>,
}

/// A segment stated in a procedure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedSegment {
    /// Its kind.
    pub kind: SegmentKind,
    /// Start, s from the beginning of the recording.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
}

/// Kind of a segment of a schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SegmentKind {
    /// Constant temperature before the first ramp.
    Soak,
    /// Rising temperature.
    Heating,
    /// Falling temperature.
    Cooling,
    /// Constant temperature after a ramp.
    Dwell,
}

impl SegmentKind {
    /// Every kind.
    pub const ALL: [SegmentKind; 4] =
        [SegmentKind::Soak, SegmentKind::Heating, SegmentKind::Cooling, SegmentKind::Dwell];

    /// The id used in procedures and results.
    pub fn id(self) -> &'static str {
        match self {
            SegmentKind::Soak => "soak",
            SegmentKind::Heating => "heating",
            SegmentKind::Cooling => "cooling",
            SegmentKind::Dwell => "dwell",
        }
    }

    /// True for heating and cooling.
    pub fn is_ramp(self) -> bool {
        matches!(self, SegmentKind::Heating | SegmentKind::Cooling)
    }
}

/// A search for the time after switching on that a unit needs.
#[derive(Debug, Clone, PartialEq)]
pub struct WarmUpTest {
    /// Band about the final value that the bias must keep, deg/h.
    pub band_deg_h: f64,
    /// Share of the record at its end that gives the final value.
    pub final_share: f64,
    /// Source of the moment of switching on.
    pub start: StartAsked,
}

/// Source of the moment at which a unit was switched on.
#[derive(Debug, Clone, PartialEq)]
pub enum StartAsked {
    /// Nothing.
    Nothing,
    /// The procedure: at the first sample.
    Declared,
    /// The stamps: at one of them, s.
    Stamp {
        /// The stamp of switching on, s.
        power_on_s: f64,
    },
    /// A supply that comes on.
    Supply {
        /// Its channel.
        channel: String,
    },
    /// A thermometer on the unit, which is cold first and warms up.
    Temperature {
        /// Its channel.
        channel: String,
        /// Temperature of the cold unit, degC.
        cold_deg_c: f64,
        /// How far from it the first temperature may be, degC.
        tolerance_deg_c: f64,
    },
}

impl StartAsked {
    /// The channel that is to show when the unit was switched on.
    pub fn channel(&self) -> Option<&str> {
        match self {
            StartAsked::Supply { channel } | StartAsked::Temperature { channel, .. } => Some(channel),
            _ => None,
        }
    }
}
