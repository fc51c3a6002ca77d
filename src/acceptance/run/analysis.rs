//! The procedure behind `analyze`: every static measurand, no condition, no limit.

use crate::config::procedure::limits::LimitSet;
use crate::config::procedure::model::{
    Analysis, ChannelSpec, Conditions, EarthRate, MeasurandSpec, Procedure, RecordingSpec, ReportSpec, Taus,
    UnitSpec,
};
use crate::measurand::{MEASURANDS, Test};
use crate::recording::Channel;

/// A procedure that only analyses.
pub fn procedure(channels: Vec<Channel>, sample_rate_hz: Option<f64>, warm_up_s: f64) -> Procedure {
    Procedure {
        id: "analysis".into(),
        title: "Noise analysis".into(),
        revision: String::new(),
        standard: None,
        clause: None,
        author: None,
        unit_under_test: UnitSpec::default(),
        recording: RecordingSpec::default(),
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
            })
            .collect(),
        conditions: Conditions { warm_up_s, ..Conditions::default() },
        exclusions: vec![],
        site: None,
        instruments: vec![],
        explain: None,
        rate_table: None,
        analysis: Analysis { taus: Taus::Octave, exact: false, line_false_alarm: 0.01 },
        temperature_test: None,
        warm_up_test: None,
        repeatability_test: None,
        comparison_test: None,
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
        limits: LimitSet::default(),
        clauses: vec![],
        report: ReportSpec { title: None, figures: None, show_reference: true },
        waivers: vec![],
    }
}
