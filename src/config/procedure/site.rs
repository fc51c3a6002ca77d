//! Where the unit stands, how its axes point, and what the Earth turns along them.

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

/// Where the unit stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Site {
    /// Latitude, deg, positive north.
    pub latitude_deg: f64,
    /// Its standard uncertainty, deg.
    pub latitude_uncertainty_deg: f64,
    /// Direction of the input axis of every channel without an entry of its own.
    pub orientation: Orientation,
    /// Directions of single channels.
    pub axes: Vec<(String, Orientation)>,
}

impl Site {
    /// Direction of the input axis of a channel.
    pub fn orientation_of(&self, channel: &str) -> Orientation {
        self.axes.iter().find(|(id, _)| id == channel).map_or(self.orientation, |(_, o)| *o)
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
