//! `sagnac run --follow`: a recording is looked at while it is being written; the report comes at its end.
//!
//! A look evaluates a copy of what there is, up to the last complete line. The numbers of the report are those of a plain run, which is
//! what follows: nothing of a look enters them.

use super::length::Length;
use super::printer::Printer;
use super::progress::Progress;
use super::run_args::RunArgs;
use super::single_test::SingleTest;
use super::{ending, place};
use crate::estimate::Verdict;
use crate::i18n::{Arg, Lang, Localize, Note, io_reason, note};
use crate::record::{InterimRow, InterimState, MeasurandRecord, RunRecord};
use crate::watch::folder::Stamp;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Pause between two looks for a request to end.
const REQUEST_POLL: Duration = Duration::from_millis(50);

/// Size of the blocks that a recording is copied in, bytes.
const COPY_BLOCK: usize = 1 << 20;

/// Looks at the recording of a test until it is complete, the test is decided, or a request to end comes.
///
/// # Errors
/// The diagnostic, in words.
pub fn until_complete(args: &RunArgs, test: &SingleTest<'_>, lang: Lang) -> Result<(), String> {
    let [file] = args.recording.as_slice() else {
        return Err(place::error(&note!("follow.one_file"), lang));
    };
    ending::defer();
    let follow = Follow { args, test, file, lang, printer: Printer::new(&args.output, lang) };
    follow.printer.next_step(Some(&note!("follow.begins", file = file.display().to_string())));
    follow.until_complete()
}

struct Follow<'a> {
    args: &'a RunArgs,
    test: &'a SingleTest<'a>,
    file: &'a Path,
    lang: Lang,
    printer: Printer,
}

impl Follow<'_> {
    fn until_complete(&self) -> Result<(), String> {
        let seconds = |length: Length| Duration::try_from_secs_f64(length.seconds).unwrap_or(Duration::MAX);
        let (poll, still) = (seconds(self.args.follow.poll), seconds(self.args.follow.still));
        let (mut last, mut changed, mut decided) = (None, Instant::now(), false);
        loop {
            let stamp =
                Stamp::of_all(&[self.file.to_owned()]).map_err(|note| place::error(&note, self.lang))?;
            if last == Some(stamp) {
                // A decided test ends with the first quiet moment: a recording that changes while it is read is refused.
                if decided || changed.elapsed() >= still {
                    break;
                }
            } else {
                (last, changed) = (Some(stamp), Instant::now());
                if !decided {
                    decided = self.look(stamp.bytes)?;
                }
            }
            let looked = Instant::now();
            while !ending::is_asked() && looked.elapsed() < poll {
                std::thread::sleep(REQUEST_POLL.min(poll));
            }
            if ending::is_asked() {
                break;
            }
        }
        let key = match (decided, ending::is_asked()) {
            (true, _) => "follow.decided",
            (_, true) => "follow.asked",
            _ => "follow.complete",
        };
        self.printer.next_step(Some(&key.into()));
        Ok(())
    }

    /// Evaluates what there is and prints the state of each row; true where the test is decided by its plan.
    fn look(&self, bytes: u64) -> Result<bool, String> {
        let unreadable = |e: std::io::Error| {
            let (path, reason) = (self.file.display().to_string(), io_reason(&e));
            place::error(&note!("watch.unreadable", path, reason), self.lang)
        };
        let folder = tempfile::tempdir().map_err(unreadable)?;
        let copy = folder.path().join(self.file.file_name().unwrap_or_default());
        copy_whole_lines(self.file, &copy, bytes).map_err(unreadable)?;
        let copy: [PathBuf; 1] = [copy];
        let opened = self.test.open(&copy);
        let serial = self.args.serial.as_deref();
        let mut progress = Progress::silent(self.lang);
        let evaluated = self.test.evaluate(&copy, &opened, serial, &mut progress);
        if let Some(reason) = evaluated.refused {
            self.print(&[note!("follow.not_yet", reason)]);
            return Ok(false);
        }
        let record = &evaluated.results.outcome.record;
        self.print(&rows(record));
        Ok(record.interim.as_ref().is_some_and(|i| i.state != InterimState::Open))
    }

    fn print(&self, notes: &[Note]) {
        let lines: String = notes.iter().map(|note| format!("{}\n", note.say(self.lang))).collect();
        self.printer.line(|_| lines);
    }
}

/// Copies the beginning of a recording; of text, up to the last complete line.
fn copy_whole_lines(from: &Path, to: &Path, bytes: u64) -> std::io::Result<()> {
    let mut source = File::open(from)?.take(bytes);
    let mut copy = File::create_new(to)?;
    let (mut block, mut copied, mut lines_end, mut is_text) = (vec![0; COPY_BLOCK], 0_u64, None, true);
    loop {
        let read = source.read(&mut block)?;
        let part = block.get(..read).unwrap_or_default();
        if part.is_empty() {
            break;
        }
        copy.write_all(part)?;
        is_text &= !part.contains(&0);
        if let Some(at) = part.iter().rposition(|byte| *byte == b'\n') {
            lines_end = Some(copied + at as u64 + 1);
        }
        copied += read as u64;
    }
    match lines_end.filter(|_| is_text) {
        Some(end) => copy.set_len(end),
        None => Ok(()),
    }
}

/// How far the recording has come, and the state of every row with a limit. Without a plan of looks nothing is decided before the end.
fn rows(record: &RunRecord) -> Vec<Note> {
    let recorded_s = record.recording.iter().map(|f| f.duration_s).sum::<f64>();
    let mut notes = vec![note!("follow.so_far", recorded_h = recorded_s / 3600.0)];
    let limited = record.measurands.iter().filter(|m| m.limit.is_some());
    notes.extend(limited.map(|m| {
        let plan = record.interim.as_ref();
        let row = plan.and_then(|i| i.rows.iter().find(|r| r.id == m.id && r.channel == m.channel));
        note!(
            "follow.row",
            quantity = Arg::key("measurand", &m.id),
            channel = m.channel.clone(),
            value = value(m),
            state = state(m, row)
        )
    }));
    notes
}

fn value(row: &MeasurandRecord) -> Note {
    match (row.value, row.upper_limit) {
        (Some(value), _) => note!("follow.value", value, unit = row.unit.clone()),
        (None, Some(bound)) => note!("follow.bound", value = bound.value, unit = row.unit.clone()),
        (None, None) => "follow.no_value".into(),
    }
}

fn state(row: &MeasurandRecord, of_plan: Option<&InterimRow>) -> Note {
    let Some(planned) = of_plan else { return "follow.open_to_the_end".into() };
    match (planned.state, planned.decidable_s) {
        (InterimState::Decided, _) if row.verdict != Verdict::None => {
            note!("follow.row_decided", verdict = Arg::key("verdict", row.verdict.id()))
        }
        (InterimState::Open, Some(next_s)) => note!("follow.row_open", next = Arg::span(next_s)),
        (state, _) => note!("follow.row_state", state = Arg::key("interim.state", state.id())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_of_text_ends_with_a_whole_line_and_one_of_bytes_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let (from, to) = (folder.path().join("a"), folder.path().join("b"));
        for (written, copied) in
            [(&b"t,r\n1,2\n3,"[..], &b"t,r\n1,2\n"[..]), (b"\0\n12", b"\0\n12"), (b"t,r", b"t,r"), (b"", b"")]
        {
            std::fs::write(&from, written).unwrap();
            copy_whole_lines(&from, &to, written.len() as u64).unwrap();
            assert_eq!(std::fs::read(&to).unwrap(), copied);
            std::fs::remove_file(&to).unwrap();
        }
        std::fs::write(&from, "a\nb\nc\n").unwrap();
        copy_whole_lines(&from, &to, 3).unwrap();
        assert_eq!(std::fs::read(&to).unwrap(), b"a\n");
    }
}
