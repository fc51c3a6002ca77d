//! An analysis without a procedure: every static measurand, no condition, no limit.

use super::column_choice::{ColumnChoice, about};
use super::request::Request;
use crate::config::procedure::EffectiveLimits;
use crate::config::procedure::model::{
    ChannelSpec, Conditions, EarthRate, MeasurandSpec, Procedure, UnitSpec,
};
use crate::i18n::Note;
use crate::ingest::Source;
use crate::measurand::{MEASURANDS, Test};
use crate::record::{RunKind, UnitUnderTest};
use crate::recording::{Channel, Role};
use chrono::{DateTime, Utc};
use std::path::Path;

/// An analysis, ready to run.
pub struct Prepared {
    procedure: Procedure,
    use_stamps: bool,
}

impl Prepared {
    /// An analysis of chosen channels. `path` is how sentences name the recording.
    ///
    /// # Errors
    /// A sentence where neither a time column nor anything else tells the sample rate.
    pub fn new(
        channels: Vec<Channel>,
        choice: &ColumnChoice,
        path: &Path,
        source: &Source,
    ) -> Result<Prepared, Note> {
        let use_stamps = channels.iter().any(|c| c.role == Role::Time);
        let declared = choice.sample_rate_hz;
        let sample_rate_hz = if use_stamps { declared } else { source.rate_without_stamps_hz(declared) };
        if !use_stamps && sample_rate_hz.is_none() {
            return Err(about(path, "cli.no_time"));
        }
        Ok(Prepared { procedure: procedure(channels, sample_rate_hz, choice.warm_up_s), use_stamps })
    }

    /// Sample rate that the analysis goes by, Hz; `None` where the stamps tell it.
    pub fn sample_rate_without_stamps_hz(&self) -> Option<f64> {
        self.procedure.sample_rate_hz.filter(|_| !self.use_stamps)
    }

    /// Request of the analysis: averaging times of octaves, a unit without a name.
    pub fn request<'a>(
        &'a self,
        source: &'a Source,
        limits: &'a EffectiveLimits,
        now: DateTime<Utc>,
    ) -> Request<'a> {
        Request {
            kind: RunKind::Analyze,
            procedure: &self.procedure,
            procedure_record: None,
            limits,
            source,
            use_stamps: self.use_stamps,
            unit: UnitUnderTest::default(),
            serial_of_recording: false,
            operator: None,
            station: None,
            now,
            taus: None,
            exact: false,
            bench_checks: None,
        }
    }
}

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
        unit_under_test: UnitSpec { serial_required: false, ..UnitSpec::default() },
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
