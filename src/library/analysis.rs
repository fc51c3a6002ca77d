//! The noise of a recording without a procedure.

use super::{Error, Recording, RunResult};
use crate::acceptance::Request;
use crate::acceptance::analysis::Prepared;
use crate::acceptance::column_choice::{ColumnChoice, channels};
use crate::acceptance::execute;
use crate::config::procedure::EffectiveLimits;
use crate::i18n::note;
use crate::moment;
use crate::noise::tau_grid::TauGrid;
use crate::record::UnitUnderTest;
use chrono::{DateTime, Utc};

/// An analysis without a procedure: every quantity of a gyro at rest, no condition, no limit.
///
/// ```no_run
/// # fn main() -> Result<(), sagnac::Error> {
/// let result = sagnac::Analysis::default().run(&sagnac::Recording::open("run.csv")?)?;
/// let n = result.measurand("angle_random_walk");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default)]
pub struct Analysis {
    /// The columns: as their names tell, unless they are named.
    pub columns: ColumnChoice,
    /// Averaging times; `None`: octaves of the sample interval.
    pub taus: Option<TauGrid>,
    /// Sums every term of the deviations at any length.
    pub exact: bool,
    /// Time of the evaluation; `None`: the present.
    pub evaluated_at: Option<DateTime<Utc>>,
}

impl Analysis {
    /// Analyses a recording.
    ///
    /// # Errors
    /// [`Error::is_recording`] when the recording cannot be read, [`Error::is_not_evaluable`] when too little of it is left,
    /// [`Error::is_argument`] when a column cannot be used or the sample rate is not told.
    pub fn run(&self, recording: &Recording) -> Result<RunResult, Error> {
        self.run_watched(recording, &mut |_, _| {})
    }

    /// The same; `progress` gets bytes read and bytes in all.
    ///
    /// # Errors
    /// As [`Analysis::run`].
    pub fn run_watched(
        &self,
        recording: &Recording,
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<RunResult, Error> {
        let warm_up_s = self.columns.warm_up_s;
        if !(warm_up_s >= 0.0 && warm_up_s.is_finite()) {
            return Err(Error::argument(note!("cli.warm_up", given = warm_up_s.to_string())));
        }
        let choice = ColumnChoice {
            sample_rate_hz: self.columns.sample_rate_hz.or(recording.sample_rate_hz()),
            ..self.columns.clone()
        };
        let source = recording.source();
        let chosen = channels(&choice, source.path(), source).map_err(Error::argument)?;
        let prepared = Prepared::new(chosen, &choice, source.path(), source).map_err(Error::argument)?;
        let limits = EffectiveLimits::default();
        let serial = recording.serial_of_manifest().map(str::to_owned);
        let request = Request {
            unit: UnitUnderTest { serial, ..UnitUnderTest::default() },
            taus: self.taus.clone(),
            exact: self.exact,
            bench_checks: None,
            ..prepared.request(source, &limits, self.evaluated_at.unwrap_or_else(moment::now))
        };
        Ok(RunResult::new(execute(&request, progress)?))
    }
}
