//! `sagnac inspect`: what a recording holds.

use super::progress::Progress;
use super::{InspectArgs, exit, place};
use crate::ingest::{ReadOptions, open_recording};
use crate::run::inspect::inspect_source;

pub fn main(args: &InspectArgs) -> u8 {
    let mut progress = Progress::new();
    let recording = match open_recording(&args.recording, &ReadOptions::default()) {
        Ok(recording) => recording,
        Err(e) => {
            place::complain(&format!("{e}\n"));
            return exit::ERROR;
        }
    };
    let told = inspect_source(&recording.source, args.sample_rate, &mut |done, total| {
        progress.update("reading", done, total);
    });
    progress.finish();
    match told {
        Ok(text) => {
            place::print(&text);
            exit::PASS
        }
        Err(e) => {
            place::complain(&format!("error: {e}\n"));
            exit::ERROR
        }
    }
}
