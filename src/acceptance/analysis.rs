//! The procedure behind `analyze`: every static measurand, no condition, no limit.

use crate::config::procedure::model::{ChannelSpec, Conditions, EarthRate, MeasurandSpec, Procedure};
use crate::measurand::{MEASURANDS, Test};
use crate::recording::Channel;

/// A procedure that only analyses.
pub fn procedure(channels: Vec<Channel>, sample_rate_hz: Option<f64>, warm_up_s: f64) -> Procedure {
    Procedure {
        id: "analysis".into(),
        title: "Noise analysis".into(),
        sample_rate_hz,
        sample_rate_tolerance: 0.01,
        channels: channels
            .into_iter()
            .map(|channel| ChannelSpec {
                unit_in_file: channel.unit.text().to_owned(),
                channel,
                rail_low: None,
                rail_high: None,
                rollover: None,
                required: true,
                span: 0..0,
                column_span: 0..0,
            })
            .collect(),
        conditions: Conditions { warm_up_s, ..Conditions::default() },
        measurands: MEASURANDS
            .iter()
            .filter(|m| m.test() == Test::Static && !m.from_site)
            .map(|measurand| MeasurandSpec {
                measurand,
                channel: None,
                earth_rate: EarthRate::Keep,
                span: 0..0,
            })
            .collect(),
        ..Procedure::default()
    }
}
