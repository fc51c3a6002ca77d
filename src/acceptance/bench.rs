//! Whether a bench was released for a test by a check that passed, and what a check releases.

use crate::config::procedure::bench::Bench;
use crate::estimate::Verdict;
use crate::i18n::{Arg, Note, note};
use crate::record::{BenchCheckRecord, BenchRecord, ConditionStatus, RecordingFile, RunRecord};
use chrono::{DateTime, Duration, SecondsFormat, Utc};

/// Seconds of an hour.
const HOUR_S: f64 = 3600.0;
/// Significant digits of a time in a sentence.
const TIME_DIGITS: usize = 3;

/// A result that may release a bench, as it was found.
#[derive(Debug, Clone)]
pub struct BenchCheck {
    /// Its folder.
    pub folder: String,
    /// Its address: SHA-256 of the list of its files.
    pub address: String,
    /// Its record.
    pub record: RunRecord,
    /// Why the folder is not what was written, by its hashes, signatures or verdict.
    pub fault: Option<Note>,
}

/// A moment of a test.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moment {
    at: DateTime<Utc>,
    /// True where the recording declares its date, false for the time of the evaluation.
    is_dated: bool,
}

/// Whether a bench was released for a test.
pub struct Release<'c> {
    /// State of the condition.
    pub status: ConditionStatus,
    /// Why.
    pub note: Note,
    /// The check that decided.
    pub check: Option<&'c BenchCheck>,
    /// Time from the end of the check to the beginning of the test, s.
    pub age_s: Option<f64>,
    /// True where the recordings of both declare their dates.
    pub is_dated: bool,
}

/// A test on a bench.
#[derive(Debug, Clone, Copy)]
pub struct OnBench<'a> {
    /// The bench as the procedure states it.
    pub bench: &'a Bench,
    /// Station of the run.
    pub station: Option<&'a str>,
    /// The files of the recording.
    pub files: &'a [RecordingFile],
    /// When the evaluation runs.
    pub now: DateTime<Utc>,
}

/// A date as results state it.
fn parsed(text: &str) -> Option<DateTime<Utc>> {
    DateTime::parse_from_rfc3339(text).ok().map(|at| at.with_timezone(&Utc))
}

fn written(at: DateTime<Utc>) -> String {
    at.to_rfc3339_opts(SecondsFormat::Secs, true)
}

/// When a recording began, where every file declares its date.
fn begin(files: &[RecordingFile]) -> Option<DateTime<Utc>> {
    let starts: Option<Vec<DateTime<Utc>>> = files.iter().map(|f| parsed(f.start.as_deref()?)).collect();
    starts?.into_iter().min()
}

/// When a recording ended, where every file declares its date.
fn end(files: &[RecordingFile]) -> Option<DateTime<Utc>> {
    let one = |f: &RecordingFile| {
        let length = Duration::try_milliseconds((1000.0 * f.duration_s).round() as i64)?;
        parsed(f.start.as_deref()?)?.checked_add_signed(length)
    };
    files.iter().map(one).collect::<Option<Vec<_>>>()?.into_iter().max()
}

/// A moment by the recording, else by the evaluation.
fn moment(of_recording: Option<DateTime<Utc>>, evaluated: Option<DateTime<Utc>>) -> Option<Moment> {
    match of_recording {
        Some(at) => Some(Moment { at, is_dated: true }),
        None => evaluated.map(|at| Moment { at, is_dated: false }),
    }
}

/// Seconds from one moment to another.
fn seconds(from: DateTime<Utc>, to: DateTime<Utc>) -> f64 {
    (to - from).num_milliseconds() as f64 / 1000.0
}

fn hours(time_s: f64) -> Arg {
    Arg::figures(time_s / HOUR_S, TIME_DIGITS)
}

/// A date in a sentence: without the seconds.
fn shown(at: DateTime<Utc>) -> String {
    at.format("%Y-%m-%d %H:%M UTC").to_string()
}

/// The same bench, whatever the case of the letters and the blanks about the name.
fn is_same(one: &str, other: &str) -> bool {
    one.trim().to_lowercase() == other.trim().to_lowercase()
}

impl BenchCheck {
    /// When it ended; `None` where its record states no time.
    fn ended(&self) -> Option<Moment> {
        moment(end(&self.record.recording), parsed(&self.record.session.evaluated_at))
    }

    /// The name of its bench.
    fn bench(&self) -> Option<&str> {
        self.record.bench.as_ref()?.name.as_deref()
    }

    /// For how long it releases its bench, s; `None` for a result that is no check by the procedure of this id.
    fn releases_for_s(&self, procedure: &str) -> Option<f64> {
        self.record.procedure.as_ref().filter(|p| p.id == procedure)?;
        self.record.bench.as_ref()?.releases_for_s
    }

    fn record(&self) -> BenchCheckRecord {
        let ended = self.ended();
        BenchCheckRecord {
            folder: self.folder.clone(),
            address: self.address.clone(),
            procedure_sha256: self.record.procedure.as_ref().map(|p| p.sha256.clone()).unwrap_or_default(),
            verdict: self.record.verdict,
            ended_at: ended.map(|m| written(m.at)),
            is_dated: ended.is_some_and(|m| m.is_dated),
        }
    }
}

impl OnBench<'_> {
    /// The name of the bench.
    fn name(&self) -> Option<&str> {
        self.bench.name(self.station)
    }

    /// Longest time from the end of the check to the beginning of the test, s.
    fn within_s(&self) -> f64 {
        self.bench.released_within_s.unwrap_or_default()
    }

    /// What a test that demands a released bench requires.
    pub fn required(&self) -> Note {
        note!("bench.required", within = Arg::span(self.within_s()), procedure = self.bench.check.as_str())
    }

    /// Whether the bench was released, by the checks that were found; `None` where nobody looked for any. The latest check of the bench before the recording decides: one that failed takes back what
    /// an earlier one released.
    pub fn release<'c>(&self, checks: Option<&'c [BenchCheck]>) -> Release<'c> {
        let Some(name) = self.name() else { return refused("bench.no_name".into()) };
        let procedure = self.bench.check.as_str();
        let about = |key: &'static str| Note::new(key).with("bench", name).with("procedure", procedure);
        let Some(found) = checks else { return refused(about("bench.not_looked")) };
        let (of_procedure, others): (Vec<&BenchCheck>, Vec<&BenchCheck>) =
            found.iter().partition(|c| c.releases_for_s(procedure).is_some());
        let own = of_procedure.iter().copied().filter(|c| c.bench().is_some_and(|b| is_same(b, name)));
        let began = self.began();
        let timed: Vec<(&BenchCheck, Option<Moment>)> = own.map(|c| (c, c.ended())).collect();
        let before = timed.iter().filter(|(_, ended)| ended.is_some_and(|m| m.at <= began.at));
        let latest = before.max_by_key(|(_, ended)| ended.map(|m| m.at));
        if let Some((check, Some(ended))) = latest {
            return self.judged(check, *ended, began, about);
        }
        if let Some((check, ended)) = timed.first() {
            let key = if ended.is_some() { "bench.later" } else { "bench.no_time" };
            return refused(about(key).with("check", check.folder.as_str()));
        }
        let mut benches: Vec<&str> = of_procedure.iter().map(|c| c.bench().unwrap_or("–")).collect();
        benches.sort_unstable();
        benches.dedup();
        match (benches.is_empty(), others.first()) {
            (false, _) => refused(about("bench.of_others").with("others", benches.join(", "))),
            (true, Some(other)) => refused(about("bench.no_check").with("check", other.folder.as_str())),
            (true, None) => refused(about("bench.none")),
        }
    }

    /// When the recording began, or else the evaluation.
    fn began(&self) -> Moment {
        moment(begin(self.files), None).unwrap_or(Moment { at: self.now, is_dated: false })
    }

    /// The check that decides, and whether it releases the bench.
    fn judged<'c>(
        &self,
        check: &'c BenchCheck,
        ended: Moment,
        began: Moment,
        about: impl Fn(&'static str) -> Note,
    ) -> Release<'c> {
        let age_s = seconds(ended.at, began.at);
        let most_s = check.releases_for_s(&self.bench.check).map_or(0.0, |own| own.min(self.within_s()));
        let is_dated = ended.is_dated && began.is_dated;
        let reason = if let Some(fault) = &check.fault {
            Some(about("bench.changed").with("reason", Arg::from(fault.clone())))
        } else if check.record.verdict != Verdict::Pass {
            let verdict = Arg::key("verdict", check.record.verdict.id());
            Some(about("bench.not_passed").with("verdict", verdict))
        } else if age_s > most_s {
            Some(about("bench.expired").with("most", Arg::span(most_s)))
        } else {
            None
        };
        let (status, note) = match reason {
            Some(note) => (ConditionStatus::Invalid, note),
            None if is_dated => (ConditionStatus::Ok, about("bench.released")),
            None => (ConditionStatus::Remark, about("bench.released_undated")),
        };
        let note = note
            .with("check", check.folder.as_str())
            .with("ended", shown(ended.at))
            .with("age", hours(age_s));
        Release { status, note, check: Some(check), age_s: Some(age_s), is_dated }
    }

    /// When the release by a check that is being made ends, and whether the recording declares the date that it counts from.
    fn until(&self, for_s: f64) -> Moment {
        let ended = moment(end(self.files), None).unwrap_or(Moment { at: self.now, is_dated: false });
        let length = Duration::try_milliseconds((1000.0 * for_s).round() as i64).unwrap_or_default();
        Moment { at: ended.at.checked_add_signed(length).unwrap_or(ended.at), ..ended }
    }

    /// What a pass of a check that is being made releases, and whether the bench is named.
    pub fn releases(&self, for_s: f64) -> (ConditionStatus, Note) {
        // Without a name no test finds the check.
        let Some(name) = self.name() else { return (ConditionStatus::Remark, "bench.unnamed_check".into()) };
        let until = self.until(for_s);
        let (status, key) = match until.is_dated {
            true => (ConditionStatus::Ok, "bench.releases"),
            false => (ConditionStatus::Remark, "bench.releases_undated"),
        };
        let note = Note::new(key).with("bench", name).with("length", Arg::span(for_s));
        (status, note.with("until", shown(until.at)))
    }

    /// What the result says of the bench.
    pub fn record(&self, checks: Option<&[BenchCheck]>, verdict: Verdict) -> BenchRecord {
        let releases = verdict == Verdict::Pass && self.name().is_some();
        let passed = self.bench.releases_for_s.filter(|_| releases);
        let demanded = self.bench.released_within_s.map(|_| self.release(checks));
        BenchRecord {
            name: self.name().map(str::to_owned),
            releases_for_s: self.bench.releases_for_s,
            released_until: passed.map(|for_s| written(self.until(for_s).at)),
            released_within_s: self.bench.released_within_s,
            check: demanded.and_then(|release| release.check).map(BenchCheck::record),
        }
    }
}

fn refused<'c>(note: Note) -> Release<'c> {
    Release { status: ConditionStatus::Invalid, note, check: None, age_s: None, is_dated: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};
    use crate::record::{ProcedureRecord, Session};

    fn bench() -> Bench {
        Bench {
            name: Some("TABLE-3".into()),
            releases_for_s: None,
            released_within_s: Some(86_400.0),
            check: "bench-check".into(),
        }
    }

    fn files(start: Option<&str>) -> Vec<RecordingFile> {
        vec![RecordingFile { start: start.map(str::to_owned), duration_s: 900.0, ..RecordingFile::default() }]
    }

    /// A check of a bench that began at a time.
    fn check(name: &str, verdict: Verdict, start: Option<&str>) -> BenchCheck {
        let record = RunRecord {
            procedure: Some(ProcedureRecord { id: "bench-check".into(), ..ProcedureRecord::default() }),
            session: Session { evaluated_at: "2026-11-24T09:00:00Z".into(), ..Session::default() },
            verdict,
            recording: files(start),
            bench: Some(BenchRecord {
                name: Some(name.into()),
                releases_for_s: Some(43_200.0),
                ..BenchRecord::default()
            }),
            ..RunRecord::default()
        };
        BenchCheck { folder: format!("{name}-{start:?}"), address: String::new(), record, fault: None }
    }

    fn judged(found: Vec<BenchCheck>, start: Option<&str>) -> (ConditionStatus, String) {
        let (bench, files) = (bench(), files(start));
        let now = parsed("2026-11-24T18:00:00Z").unwrap();
        let demand = OnBench { bench: &bench, station: None, files: &files, now };
        let release = demand.release(Some(&found));
        (release.status, release.note.say(Lang::En))
    }

    const MORNING: Option<&str> = Some("2026-11-24T06:00:00Z");
    const NOON: Option<&str> = Some("2026-11-24T12:00:00Z");

    #[test]
    fn a_check_that_passed_releases_its_bench_until_its_validity_ends() {
        let released = judged(vec![check("table-3 ", Verdict::Pass, MORNING)], NOON);
        assert_eq!(released.0, ConditionStatus::Ok, "{}", released.1);
        // The check ended at 06:15 and holds for 12 h, less than the day that the test allows.
        let late = judged(vec![check("TABLE-3", Verdict::Pass, MORNING)], Some("2026-11-24T18:16:00Z"));
        assert!(late.0 == ConditionStatus::Invalid && late.1.contains("12"), "{}", late.1);
        let just = judged(vec![check("TABLE-3", Verdict::Pass, MORNING)], Some("2026-11-24T18:15:00Z"));
        assert_eq!(just.0, ConditionStatus::Ok, "{}", just.1);
    }

    #[test]
    fn a_later_check_that_failed_takes_the_release_back() {
        let failed = check("TABLE-3", Verdict::Fail, Some("2026-11-24T08:00:00Z"));
        let judged_both = judged(vec![failed.clone(), check("TABLE-3", Verdict::Pass, MORNING)], NOON);
        assert!(
            judged_both.0 == ConditionStatus::Invalid && judged_both.1.contains("fail"),
            "{}",
            judged_both.1
        );
        let mut again = check("TABLE-3", Verdict::Pass, Some("2026-11-24T09:00:00Z"));
        assert_eq!(judged(vec![failed.clone(), again.clone()], NOON).0, ConditionStatus::Ok);
        again.fault = Some("verify.no_hashes".into());
        assert_eq!(judged(vec![failed, again], NOON).0, ConditionStatus::Invalid);
    }

    #[test]
    fn a_check_of_another_bench_a_later_one_and_none_are_named() {
        let other = judged(vec![check("TABLE-4", Verdict::Pass, MORNING)], NOON);
        assert!(other.0 == ConditionStatus::Invalid && other.1.contains("TABLE-4"), "{}", other.1);
        let later = judged(vec![check("TABLE-3", Verdict::Pass, NOON)], MORNING);
        assert_eq!(later.0, ConditionStatus::Invalid);
        assert_eq!(judged(vec![], NOON).0, ConditionStatus::Invalid);
        let mut wrong = check("TABLE-3", Verdict::Pass, MORNING);
        wrong.record.procedure =
            Some(ProcedureRecord { id: "scale-factor".into(), ..ProcedureRecord::default() });
        assert_eq!(judged(vec![wrong], NOON).0, ConditionStatus::Invalid);
    }

    #[test]
    fn without_dates_the_times_of_evaluation_are_compared_and_that_is_a_remark() {
        let undated = judged(vec![check("TABLE-3", Verdict::Pass, None)], None);
        assert!(undated.0 == ConditionStatus::Remark && undated.1.contains("9"), "{}", undated.1);
        let half = judged(vec![check("TABLE-3", Verdict::Pass, MORNING)], None);
        assert_eq!(half.0, ConditionStatus::Remark, "{}", half.1);
    }

    #[test]
    fn a_check_states_until_when_a_pass_releases() {
        let bench = Bench { releases_for_s: Some(86_400.0), released_within_s: None, ..bench() };
        let files = files(MORNING);
        let now = parsed("2026-11-24T18:00:00Z").unwrap();
        let check = OnBench { bench: &bench, station: None, files: &files, now };
        assert_eq!(check.releases(86_400.0).0, ConditionStatus::Ok);
        let until = |verdict| check.record(None, verdict).released_until;
        assert_eq!(until(Verdict::Pass).as_deref(), Some("2026-11-25T06:15:00Z"));
        assert_eq!(until(Verdict::Fail), None);
        let unnamed = Bench { name: None, ..bench.clone() };
        let check = OnBench { bench: &unnamed, ..check };
        assert_eq!(check.releases(86_400.0).0, ConditionStatus::Remark);
        assert_eq!(check.record(None, Verdict::Pass).released_until, None);
    }
}
