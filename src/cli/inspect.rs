//! `sagnac inspect`: what a recording holds.

use super::progress::Progress;
use super::{InspectArgs, exit, place};

pub fn main(args: &InspectArgs) -> u8 {
    let mut progress = Progress::new();
    let told = crate::run::inspect::inspect(&args.recording, args.sample_rate, &mut |done, total| {
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
