//! `sagnac inspect`: what a recording holds.

use super::progress::Progress;
use super::{InspectArgs, exit, place};
use crate::acceptance::inspect::inspect_source;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::open_recording;

pub fn main(args: &InspectArgs, lang: Lang) -> u8 {
    let mut progress = Progress::new();
    let reading = Note::new("cli.reading").say(lang);
    let recording = match open_recording(&args.recording, &args.read.options()) {
        Ok(recording) => recording,
        Err(e) => {
            place::complain(&e.say(lang));
            return exit::ERROR;
        }
    };
    let told = inspect_source(&recording.source, args.sample_rate, lang, &mut |done, total| {
        progress.update(&reading, done, total);
    });
    progress.finish();
    match told {
        Ok(text) => {
            place::print(&text);
            exit::PASS
        }
        Err(e) => {
            place::complain(&place::error(&e.note(), lang));
            exit::ERROR
        }
    }
}
