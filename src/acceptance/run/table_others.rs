//! What a table test gives beside the line: a sine, a dead zone, the direction of the input axis.

use super::Request;
use crate::config::procedure::model::MeasurandSpec;
use crate::config::procedure::scale_factor_unit::scale_factor_unit;
use crate::estimate::{Estimate, Spread};
use crate::i18n::{Arg, Note};
use crate::noise::static_bias::EARTH_RATE_DEG_H;
use crate::rate_table::alignment::{self, Alignment};
use crate::rate_table::dead_zone::{self, DeadZone};
use crate::rate_table::scale_factor::ScaleFactor;
use crate::rate_table::sine::{self, Sine};
use crate::rate_table::{Setup, TableRun, combine};

/// Ids that a sine gives in place of the line.
pub(super) const SINE_IDS: &[&str] = &[
    "scale_factor",
    "scale_factor_error",
    "scale_factor_residual",
    "scale_factor_temperature_sensitivity",
    "sine_response",
];

/// Radians a second in one degree an hour.
const RAD_S: f64 = std::f64::consts::PI / 180.0 / 3600.0;

/// What one channel gives beside the line.
pub(super) struct Others {
    channel: String,
    as_recorded: (&'static str, f64),
    full_scale: f64,
    sine: Option<Sine>,
    pub zone: Option<DeadZone>,
    alignment: Option<Alignment>,
}

impl Others {
    pub(super) fn evaluate(
        request: &Request<'_>,
        run: &TableRun,
        setup: &Setup,
        gyro: usize,
        line: Option<&ScaleFactor>,
        wanted: &dyn Fn(&str) -> bool,
    ) -> Others {
        let channel = run.blocks.gyros[gyro].clone();
        let any = |ids: &[&str]| ids.iter().any(|id| wanted(id));
        let vertical = request
            .procedure
            .site
            .as_ref()
            .map_or(0.0, |s| EARTH_RATE_DEG_H * s.latitude_deg.to_radians().sin());
        let highest = run.steps.list.iter().fold(0.0, |m: f64, s| m.max(s.rate.abs()));
        Others {
            as_recorded: scale_factor_unit(request.procedure, &channel),
            full_scale: setup.full_scale_deg_h.unwrap_or(highest),
            sine: setup.sine.then(|| sine::fit(&run.steps, gyro)).flatten(),
            zone: any(dead_zone::IDS)
                .then(|| {
                    line.and_then(|l| dead_zone::evaluate(&run.steps, gyro, &l.response, &channel, setup))
                })
                .flatten(),
            alignment: any(alignment::IDS).then(|| {
                alignment::evaluate(&run.steps, &channel, gyro, vertical, setup.alignment_uncertainty_rad)
            }),
            channel,
        }
    }

    /// The estimates of a measurand.
    pub(super) fn estimate(&self, spec: &MeasurandSpec, setup: &Setup) -> Vec<Estimate> {
        if spec.channel.as_ref().is_some_and(|c| *c != self.channel) {
            return vec![];
        }
        let (id, unit) = (spec.id.id, spec.id.unit);
        let zone = self.zone.as_ref().and_then(|z| z.estimate(id, unit));
        let tilt = self.alignment.as_ref().and_then(|a| a.estimate(id, unit, setup));
        zone.into_iter().chain(tilt).chain(self.of_sine(id, unit, setup)).collect()
    }

    fn of_sine(&self, id: &'static str, unit: &'static str, setup: &Setup) -> Option<Estimate> {
        if !setup.sine || !SINE_IDS.contains(&id) {
            return None;
        }
        let method = "sine_response";
        let Some(s) = &self.sine else {
            return Some(
                Estimate::not_identifiable(id, &self.channel, None, unit, method)
                    .note(Note::new("on_table.no_sine")),
            );
        };
        let slope = s.fit.coefficient(sine::SLOPE);
        let relative = setup.rate_uncertainty;
        let measured = |value: f64, unit: &'static str, spread: Spread| {
            Estimate::measured(id, &self.channel, value, unit, spread, method)
        };
        Some(match id {
            "scale_factor" => {
                let factor = self.as_recorded.1;
                let spread =
                    combine::spread(&slope, factor.abs(), &[relative * (slope.value * factor).abs()]);
                measured(slope.value * factor, self.as_recorded.0, spread).note(Note::new("on_table.at_zero"))
            }
            "scale_factor_error" => {
                measured((slope.value - 1.0) * 1e6, unit, combine::spread(&slope, 1e6, &[1e6 * relative]))
                    .note(Note::new("on_table.at_zero"))
            }
            "scale_factor_residual" => {
                measured(1e6 * s.rms / self.full_scale, unit, Spread::ChiSquare { dof: s.dof }).note(
                    Note::new("on_table.sine_left")
                        .with("rms", Arg::figures(s.rms * RAD_S * 1e3, 3))
                        .with("line", Arg::figures(s.rms_of_line * RAD_S * 1e3, 3)),
                )
            }
            "scale_factor_temperature_sensitivity" => {
                if s.temperature_range <= 0.0 {
                    return Some(
                        Estimate::not_identifiable(id, &self.channel, None, unit, method)
                            .note(Note::new("on_table.no_temperature_range")),
                    );
                }
                let gain = s.fit.coefficient(sine::GAIN_OVER_TEMPERATURE);
                let value = gain.value / slope.value;
                let reading = std::f64::consts::SQRT_2 * setup.temperature_uncertainty_deg_c
                    / s.temperature_range
                    * value.abs();
                measured(value, unit, combine::spread(&gain, 1.0 / slope.value.abs(), &[reading])).note(
                    Note::new("on_table.temperature_range")
                        .with("range", Arg::figures(s.temperature_range, 3)),
                )
            }
            _ => {
                let per = 1.0 / RAD_S;
                let spread = Spread::Normal { standard_uncertainty: s.kappa_standard * per };
                measured(s.kappa * per, unit, spread)
            }
        })
    }
}
