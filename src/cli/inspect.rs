//! `sagnac inspect`: what a recording holds.

use super::progress::Progress;
use super::{InspectArgs, exit, place};
use crate::run::RunError;

pub fn main(args: &InspectArgs) -> u8 {
    let mut progress = Progress::new();
    let source = crate::ingest::open_with(&args.recording, &args.read.options());
    let told = source.map_err(RunError::from).and_then(|source| {
        crate::run::inspect::inspect_source(&source, args.sample_rate, &mut |done, total| {
            progress.update("reading", done, total);
        })
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
