//! Rows for what a procedure asks for and no evaluation produced, so that a missing value never satisfies a limit.

use super::request::Request;
use super::verdict;
use crate::config::procedure::limits::gyro_of;
use crate::config::procedure::model::{MeasurandSpec, Procedure};
use crate::config::procedure::obtainable;
use crate::config::procedure::scale_factor_unit::unit_of_result;
use crate::estimate::Estimate;
use crate::i18n::Note;
use crate::measurand::Measurand;
use crate::record::MeasurandRecord;
use crate::recording::Channel;

/// Adds a row for every requested measurand that no evaluation produced, with the reason, and puts the rows in the order of
/// the procedure. `missing` is the key of the general reason for the kind of test.
pub(super) fn complete(
    request: &Request<'_>,
    channels: &[Channel],
    missing: &'static str,
    mut rows: Vec<MeasurandRecord>,
) -> Vec<MeasurandRecord> {
    let procedure = request.procedure;
    for spec in &procedure.measurands {
        for channel in asked(request, spec, channels) {
            let given = rows.iter().any(|r| r.id == spec.measurand.id && gyro_of(&r.channel) == channel);
            if !given {
                let estimate = without_value(procedure, spec.measurand, channel, missing);
                rows.push(verdict::row(&estimate, request.limits, procedure));
            }
        }
    }
    let place = |row: &MeasurandRecord| {
        let of = |m: &MeasurandSpec| {
            m.measurand.id == row.id && m.channel.as_deref().is_none_or(|c| c == gyro_of(&row.channel))
        };
        procedure.measurands.iter().position(of).unwrap_or(usize::MAX)
    };
    rows.sort_by_key(place);
    rows
}

/// The channels that a measurand is asked for: the one named, or every gyro that was read and those that a limit names.
fn asked<'a>(request: &'a Request<'_>, spec: &'a MeasurandSpec, channels: &'a [Channel]) -> Vec<&'a str> {
    if let Some(own) = &spec.channel {
        return vec![own];
    }
    let mut list: Vec<&str> = channels.iter().filter(|c| c.role.is_gyro()).map(|c| c.id.as_str()).collect();
    let limited = request.limits.set.limits.iter().filter(|l| l.measurand.id == spec.measurand.id);
    for channel in limited.filter_map(|l| l.channel.as_deref()) {
        // A limits file may serve procedures with other channels.
        if request.procedure.channel(channel).is_some() && !list.contains(&channel) {
            list.push(channel);
        }
    }
    list
}

fn without_value(
    procedure: &Procedure,
    measurand: &'static Measurand,
    channel: &str,
    missing: &'static str,
) -> Estimate {
    let unit = unit_of_result(procedure, measurand, channel);
    let general = if measurand.test().is_at_rest() { "unshown.nothing" } else { missing };
    let why = obtainable::why_not(procedure, measurand, channel).unwrap_or_else(|| Note::new(general));
    Estimate::not_identifiable(measurand.id, channel, None, unit, "not_evaluated").note(why)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::procedure::EffectiveLimits;
    use crate::config::procedure::limits::LimitSpec;
    use crate::estimate::{Limit, Rule};

    #[test]
    fn the_limit_of_a_gyro_judges_its_rows_by_zone_and_axis() {
        let mut limits = EffectiveLimits::default();
        for (channel, max) in [(None, 1.0), (Some("rate"), 2.0), (Some("rate@20"), 3.0)] {
            limits.set.limits.push(LimitSpec {
                measurand: &crate::measurand::ANGLE_RANDOM_WALK_AT_TEMPERATURE,
                channel: channel.map(str::to_owned),
                limit: Limit {
                    min: None,
                    max: Some(max),
                    rule: Rule::GuardBand,
                    risk: 0.05,
                    source: String::new(),
                },
                recorded_unit: None,
                span: 0..0,
            });
        }
        let of = |channel: &str| limits.limit("angle_random_walk_at_temperature", channel).unwrap().limit.max;
        assert_eq!(
            [of("rate@-40"), of("rate@20"), of("rate"), of("x@-40")].map(Option::unwrap),
            [2.0, 3.0, 2.0, 1.0]
        );
        assert_eq!([gyro_of("x<-y"), gyro_of("rate@x:0.5"), gyro_of("rate")], ["x", "rate", "rate"]);
    }
}
