//! Where the unit stands, how its axes point, and what the Earth turns along them.

use crate::config::spec::Range;
use crate::config::table::Table;
use crate::noise::static_bias::{self, Uncertain, earth_rate};

/// Direction of an input axis. Uncertainties are standard uncertainties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// Heading from true north, positive to the east, deg. 0 for a vertical axis, where it has no meaning.
    pub heading_deg: f64,
    /// Its uncertainty, deg.
    pub heading_uncertainty_deg: f64,
    /// Elevation above the horizon, deg.
    pub elevation_deg: f64,
    /// Its uncertainty, deg.
    pub elevation_uncertainty_deg: f64,
}

/// Where the unit stands and where its input axis points: the Earth rate along the axis follows from it.
/// Uncertainties are standard uncertainties (k = 1).
#[derive(Debug, Clone, PartialEq, Table)]
#[table("site")]
pub struct Site {
    /// Latitude, positive north.
    #[key(quantity = "deg", range = RIGHT_ANGLE, example = "55.98 deg")]
    pub latitude_deg: f64,
    /// Its uncertainty.
    #[key(quantity = "deg", range = SMALL_ANGLE, default = "0 deg", example = "1 arcsec")]
    pub latitude_uncertainty_deg: f64,
    /// Heading of the input axis from true north, positive to the east. Needed unless the axis is vertical.
    ///
    /// 0 for a vertical axis, where it has no meaning.
    #[key(quantity = "deg", range = HALF_TURN, optional, example = "90 deg")]
    pub heading_deg: f64,
    /// Its uncertainty.
    #[key(quantity = "deg", min = 0, max = 360, default = "0 deg", example = "1 arcmin")]
    pub heading_uncertainty_deg: f64,
    /// Elevation of the input axis above the horizon; 90 deg is up.
    #[key(quantity = "deg", range = RIGHT_ANGLE, example = "90 deg")]
    pub elevation_deg: f64,
    /// Its uncertainty: the tilt of the axis.
    #[key(quantity = "deg", range = SMALL_ANGLE, default = "0 deg", example = "30 arcsec")]
    pub elevation_uncertainty_deg: f64,
    /// Orientation of single channels that differ from the above.
    #[key(name = "axis")]
    pub axes: Vec<Axis>,
}

/// Orientation of the input axis of one channel.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("site.axis")]
pub struct Axis {
    /// Channel with the role `rate` or `angle_increment`.
    #[key(id, example = "x")]
    pub channel: String,
    /// Heading from true north, positive to the east. Needed unless the axis is vertical.
    ///
    /// 0 for a vertical axis, where it has no meaning.
    #[key(quantity = "deg", range = HALF_TURN, optional, example = "0 deg")]
    pub heading_deg: f64,
    /// Its uncertainty.
    #[key(quantity = "deg", min = 0, max = 360, default = "0 deg", example = "1 arcmin")]
    pub heading_uncertainty_deg: f64,
    /// Elevation above the horizon.
    #[key(quantity = "deg", range = RIGHT_ANGLE, example = "0 deg")]
    pub elevation_deg: f64,
    /// Its uncertainty.
    #[key(quantity = "deg", range = SMALL_ANGLE, default = "0 deg", example = "30 arcsec")]
    pub elevation_uncertainty_deg: f64,
}

/// Ranges of the angles, deg.
const HALF_TURN: Range = Range::between(-360.0, 360.0);
const RIGHT_ANGLE: Range = Range::between(-90.0, 90.0);
const SMALL_ANGLE: Range = Range::between(0.0, 90.0);

impl Site {
    /// Direction of the input axis of a channel.
    pub fn orientation_of(&self, channel: &str) -> Orientation {
        match self.axes.iter().find(|axis| axis.channel == channel) {
            Some(axis) => Orientation {
                heading_deg: axis.heading_deg,
                heading_uncertainty_deg: axis.heading_uncertainty_deg,
                elevation_deg: axis.elevation_deg,
                elevation_uncertainty_deg: axis.elevation_uncertainty_deg,
            },
            None => Orientation {
                heading_deg: self.heading_deg,
                heading_uncertainty_deg: self.heading_uncertainty_deg,
                elevation_deg: self.elevation_deg,
                elevation_uncertainty_deg: self.elevation_uncertainty_deg,
            },
        }
    }

    /// Earth rate along the input axis of a channel, deg/h.
    pub fn earth_rate_along(&self, channel: &str) -> Uncertain {
        let o = self.orientation_of(channel);
        let uncertain = |value, uncertainty| Uncertain { value, uncertainty };
        earth_rate(&static_bias::Orientation {
            latitude_deg: uncertain(self.latitude_deg, self.latitude_uncertainty_deg),
            heading_deg: uncertain(o.heading_deg, o.heading_uncertainty_deg),
            elevation_deg: uncertain(o.elevation_deg, o.elevation_uncertainty_deg),
        })
    }
}
