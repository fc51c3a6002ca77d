//! What a kind of test adds to the pipeline.

use super::condition::checks::CheckLog;
use super::condition::stability_track::{StabilityFacts, StabilityKey};
use super::condition::status_track::StatusTrack;
use super::condition::{GyroFact, WarmUpFact};
use super::power::Situation;
use super::request::{Request, RunError, Table};
use super::thermometer_pairs::PairFacts;
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::influence::cut::FileSpan;
use crate::ingest::{FileReport, Pauses, StreamReport};
use crate::noise::envelope::Envelope;
use crate::record::{ConditionRecord, RunRecord, Window};
use crate::recording::{Channel, Role, Sink};
use crate::temperature::findings::Schedule;
use std::collections::BTreeMap;

/// A recording that was read once for a request: what every kind of test needs of it.
pub(super) struct Reading<'r> {
    /// The request.
    pub request: &'r Request<'r>,
    /// The channels that were read.
    pub channels: Vec<Channel>,
    /// What the reader found: files, clock, integrity.
    pub report: StreamReport,
    /// Where the recording may pause.
    pub pauses: Pauses,
    /// Stamp of the first row, s.
    pub start_s: f64,
    /// Measured sample interval, s.
    pub tau0_s: f64,
    /// The part that is evaluated.
    pub window: Window,
    /// Statistics of the channels that must stay within a band.
    pub stability: BTreeMap<StabilityKey, StabilityFacts>,
    /// Status words, one for each condition of them.
    pub statuses: Vec<StatusTrack>,
    /// What the thermometers that are compared differ by, pair by pair; `None` where a pair was not read.
    pub thermometer_pairs: Vec<Option<PairFacts>>,
    /// Curves drawn over time, by position of the channel.
    pub envelopes: BTreeMap<usize, Envelope>,
    /// Which checks were made.
    pub checks: CheckLog,
}

impl Reading<'_> {
    /// The procedure that is run.
    pub fn procedure(&self) -> &Procedure {
        self.request.procedure
    }

    /// The gyro channels, each with its position among the channels.
    pub fn gyros(&self) -> impl Iterator<Item = (usize, &Channel)> {
        self.channels.iter().enumerate().filter(|(_, c)| c.role.is_gyro())
    }

    /// True when the time is taken from stamps.
    pub fn has_stamps(&self) -> bool {
        self.request.use_stamps && self.channels.iter().any(|c| c.role == Role::Time)
    }

    /// Step of the output of a channel, where its values lie on a lattice.
    pub fn quantization_step(&self, slot: usize) -> Option<f64> {
        self.report.channels.get(slot).and_then(|c| c.values.quantization_step)
    }

    /// The files of the recording with their phases and rows.
    pub fn file_spans(&self) -> Vec<FileSpan> {
        let of = |f: &FileReport| FileSpan {
            name: f.path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned()),
            phase: f.phase.clone(),
            rows: (f.rows_before + 1, f.rows_before + f.facts.rows),
        };
        self.report.files.iter().map(of).collect()
    }
}

/// Facts that the common conditions are judged by where a test shows a gyro at rest.
#[derive(Default)]
pub(super) struct RestFacts<'e> {
    /// Remainder of a warm-up transient.
    pub warm_up: Vec<WarmUpFact>,
    /// The gyro channels.
    pub gyros: Vec<GyroFact>,
    /// The schedule of a test over temperature.
    pub schedule: Option<&'e Schedule>,
}

impl RestFacts<'_> {
    /// Gyro channels in stretches of a recording. An analysis judges none.
    pub fn of_gyros(reading: &Reading<'_>, gyros: &[GyroFact]) -> RestFacts<'static> {
        let gyros = if reading.request.is_run() { gyros.to_vec() } else { vec![] };
        RestFacts { gyros, ..RestFacts::default() }
    }
}

/// What may keep a recording from being evaluated.
pub(super) type Run<T> = Result<T, RunError>;

/// Gets bytes read and bytes in all.
pub(super) type Progress<'p> = &'p mut dyn FnMut(u64, u64);

/// An option that a test was evaluated with: name and value.
pub(super) type TestOption = (&'static str, String);

/// A kind of test, made of what a procedure states of it. One file a kind and one line in [`super::kinds`].
pub(super) trait TestKind: Sized {
    /// Collects what the test needs while the evaluated part of the recording goes by once.
    type Collector: Sink;
    /// What the collected data show.
    type Evidence: Evidence;
    /// Ids of the checks that the test could make, apart from those of every test.
    const OWN_CHECKS: &'static [&'static str];
    /// Key of the reason for a measurand that has no estimate at all.
    const MISSING_REASON: &'static str;

    /// The test of a procedure; `None` for a procedure of another kind.
    fn of(procedure: &Procedure) -> Option<Self>;

    /// The options that the test is evaluated with.
    fn options(&self, request: &Request<'_>) -> Vec<TestOption>;

    /// Where the recording may pause. Anywhere else a time without samples is a gap.
    fn pauses(&self) -> Pauses {
        Pauses::default()
    }

    /// The collector; `interval_s` is the nominal sample interval.
    ///
    /// # Errors
    /// What the request asks for does not suit the recording.
    fn collector(&self, request: &Request<'_>, channels: &[Channel], interval_s: f64)
    -> Run<Self::Collector>;

    /// The evidence in the collected data. A quantity that one pass cannot give is read in another one here.
    ///
    /// # Errors
    /// [`RunError::Nothing`] when nothing was left to evaluate; those of reading.
    fn evaluate(
        self,
        reading: &Reading<'_>,
        collected: Self::Collector,
        progress: Progress<'_>,
    ) -> Run<Self::Evidence>;
}

/// What a recording shows, before any limit. The pipeline calls the methods in the order in which they stand here.
pub(super) trait Evidence {
    /// Standard deviation of the quietest channel, deg/h: a lattice of the values far finer than this is the number of
    /// decimals in the file. `None` where the test does not show it.
    fn noise_deg_h(&self) -> Option<f64> {
        None
    }

    /// The conditions of this kind of test alone. Which checks were made is noted in `reading.checks`.
    fn conditions(&self, _reading: &Reading<'_>) -> Vec<ConditionRecord> {
        vec![]
    }

    /// Facts that the conditions of every test are judged by besides the recording.
    fn rest_facts(&self, _reading: &Reading<'_>) -> RestFacts<'_> {
        RestFacts::default()
    }

    /// The estimates of a measurand on every channel; channels asked for and limits are applied by the pipeline.
    fn estimates(&self, reading: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate>;

    /// What the predicted variance of a channel's quantities follows from; `None` where nothing predicts it.
    fn situation(&self, _channel: &str) -> Option<Situation> {
        None
    }

    /// The correlation of two estimates from one fit; `None` where they are not of one, or where it is not known.
    fn correlation(&self, _one: &Estimate, _other: &Estimate) -> Option<f64> {
        None
    }

    /// The figures that the report asks for.
    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure>;

    /// Adds to the record what is of this kind of test alone, and returns the tables beside the result.
    fn complete(&self, _reading: &Reading<'_>, _record: &mut RunRecord) -> Vec<Table> {
        vec![]
    }
}
