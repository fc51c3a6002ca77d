//! `sagnac inspect`: what a recording holds.

use super::progress::Progress;
use super::{InspectArgs, exit, place};
use crate::run::RunError;
use crate::text::{Lang, Note};

pub fn main(args: &InspectArgs, lang: Lang) -> u8 {
    let mut progress = Progress::new();
    let reading = Note::new("cli.reading").say(lang);
    let source = crate::ingest::open_with(&args.recording, &args.read.options());
    let told = source.map_err(RunError::from).and_then(|source| {
        crate::run::inspect::inspect_source(&source, args.sample_rate, lang, &mut |done, total| {
            progress.update(&reading, done, total);
        })
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
