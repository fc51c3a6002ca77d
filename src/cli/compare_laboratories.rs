//! Two results of one unit: what their recordings give under both procedures.

use super::evaluate::with_progress;
use super::job::Frame;
use super::place;
use crate::acceptance::Request;
use crate::acceptance::compare::laboratories::{Evaluated, Given, Laboratories, serial_of_both};
use crate::config::procedure::differences::differing_keys;
use crate::config::procedure::{LimitsFile, Loaded, Procedure, effective, load, load_limits};
use crate::i18n::{Arg, Localize, Note, note};
use crate::ingest::{ReadOptions, open_recording};
use crate::output::{LIMITS_FILE, PROCEDURE_FILE, sha256_of_file};
use crate::record::{RunKind, RunRecord, read};
use std::path::{Path, PathBuf};

/// Relative length from which the longer recording is evaluated at the length of the shorter one too.
const LONGER: f64 = 1.05;

/// A result with its folder.
struct Side {
    folder: PathBuf,
    name: String,
    record: RunRecord,
    /// The procedure and limits that it keeps a copy of.
    test: Option<(Loaded<Procedure>, Option<Loaded<LimitsFile>>)>,
    /// The files of its recording, where they are at hand.
    recording: Option<Vec<PathBuf>>,
}

/// The comparison of two results of one unit; `None` where the files are something else.
///
/// # Errors
/// The diagnostics, in words.
pub(super) fn laboratories(
    data: &[PathBuf],
    files: &[Option<PathBuf>],
    frame: &mut Frame<'_>,
) -> Result<Option<Laboratories>, String> {
    let say = |note: Note| place::error(&note, frame.lang);
    let nothing = || if data.is_empty() { Ok(None) } else { Err(say("laboratories.error.data".into())) };
    let [Some(first), Some(second)] = files else { return nothing() };
    let records = [first, second].map(|file| read::open(file).map_err(|e| say(e.note(file))));
    let [first_record, second_record] = records;
    let (first_record, second_record) = (first_record?, second_record?);
    if serial_of_both(&first_record, &second_record).is_none() {
        return nothing();
    }
    if !matches!(data.len(), 0 | 2) {
        return Err(say("laboratories.error.data".into()));
    }
    let sides = [Side::of(first, first_record, data.first()), Side::of(second, second_record, data.get(1))];
    let evaluated = evaluated(&sides, frame);
    let shown: Vec<String> = sides.iter().map(|s| s.folder.display().to_string()).collect();
    let [a, b] = &sides;
    let given = [(a, &shown[0]), (b, &shown[1])].map(|(side, path)| Given {
        name: &side.name,
        path,
        record: &side.record,
        site: side.test.as_ref().and_then(|(procedure, _)| procedure.value.site.clone()),
    });
    Ok(Laboratories::of(given, evaluated))
}

impl Side {
    fn of(file: &Path, record: RunRecord, data: Option<&PathBuf>) -> Side {
        let folder = file.parent().map(Path::to_owned).unwrap_or_default();
        let named = folder.file_name().or_else(|| file.file_stem());
        let name = named.map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let test = load(&folder.join(PROCEDURE_FILE)).ok().map(|mut procedure| {
            // Programs that came with the result of another laboratory are not run.
            procedure.value.programs.clear();
            let limits = folder.join(LIMITS_FILE);
            (procedure, limits.is_file().then(|| load_limits(&limits).ok()).flatten())
        });
        let recording = match data {
            Some(file) => Some(vec![file.clone()]),
            None => at_hand(&record),
        };
        Side { folder, name, record, test, recording }
    }
}

/// The recording of a result, where it is one file that is still what it was.
fn at_hand(record: &RunRecord) -> Option<Vec<PathBuf>> {
    let [file] = record.recording.as_slice() else { return None };
    let path = PathBuf::from(&file.path);
    (sha256_of_file(&path).as_ref() == Some(&file.sha256)).then(|| vec![path])
}

/// Each recording under the procedure of the other result, and the longer one at the length of the shorter.
fn evaluated(sides: &[Side; 2], frame: &mut Frame<'_>) -> Evaluated {
    let [first, second] = sides;
    let mut all = Evaluated::default();
    if let (Some((a, _)), Some((b, _))) = (&first.test, &second.test) {
        all.differing_keys = differing_keys(&a.text(), &b.text());
    }
    let hashes = |side: &Side| side.record.recording.iter().map(|f| f.sha256.clone()).collect::<Vec<_>>();
    if hashes(first) == hashes(second) {
        return all;
    }
    // Without a procedure there is nothing to exchange; of equal procedures, nothing would change.
    let same_test = first.test.is_some() && second.test.is_some() && all.differing_keys.is_empty();
    let mut of = |recording: &Side, test: &Side, rows: Option<(u64, u64)>, n: usize| match again(
        recording, test, rows, n, frame,
    ) {
        Ok(record) => Some(record),
        Err(why) => {
            all.missing.push(why);
            None
        }
    };
    if !same_test {
        all.first_by_second = of(first, second, None, 1);
        all.second_by_first = of(second, first, None, 2);
    }
    let usable = [first, second].map(|s| s.record.window.usable_s);
    let longer = usize::from(usable[1] > usable[0]);
    let (long, short_s) = (&sides[longer], usable[1 - longer]);
    if short_s > 0.0 && usable[longer] > LONGER * short_s {
        let interval_s = long.record.recording.first().map_or(0.0, |f| f.sample_interval_s);
        if interval_s > 0.0 {
            let end = (long.record.window.from_s + short_s) / interval_s;
            all.shortened = of(long, long, Some((1, end.ceil() as u64)), 3).map(|record| (longer, record));
        }
    }
    all
}

/// A recording under a procedure; of all its rows, or of some.
fn again(
    recording: &Side,
    test: &Side,
    rows: Option<(u64, u64)>,
    n: usize,
    frame: &mut Frame<'_>,
) -> Result<RunRecord, Note> {
    let files = recording.recording.as_ref();
    let files = files.ok_or_else(|| note!("laboratories.no_recording", name = recording.name.as_str()))?;
    let (procedure, limits) =
        test.test.as_ref().ok_or_else(|| note!("laboratories.no_procedure", name = test.name.as_str()))?;
    let failed = |why: Arg| {
        let (recording, test) = (recording.name.as_str(), test.name.as_str());
        note!("laboratories.not_evaluated", recording, procedure = test, why)
    };
    let lang = frame.lang;
    let read = ReadOptions { rows, ..procedure.value.recording.read.clone() };
    let opened = open_recording(files, &read).map_err(|e| failed(e.say(lang).into()))?;
    let limits = effective(procedure, limits.as_ref());
    let request = Request {
        kind: RunKind::Run,
        procedure: &procedure.value,
        procedure_record: None,
        limits: &limits,
        source: &opened.source,
        use_stamps: true,
        unit: recording.record.unit_under_test.clone(),
        serial_of_recording: false,
        operator: None,
        station: None,
        now: frame.now,
        taus: None,
        exact: false,
        bench_checks: None,
    };
    let label = note!("progress.of_unit", n, all = 3_usize).say(lang);
    let outcome =
        with_progress(&request, &label, &mut frame.progress).map_err(|e| failed(e.note().into()))?;
    let record = outcome.record;
    let hashes = |r: &RunRecord| r.recording.iter().map(|f| f.sha256.clone()).collect::<Vec<_>>();
    if rows.is_none() && hashes(&record) != hashes(&recording.record) {
        return Err(note!("laboratories.other_recording", name = recording.name.as_str()));
    }
    Ok(record)
}
