//! The runs of a series of switching off and on.

use super::cut::{FileSpan, find_stated, settled, span_s, within};
use super::setup::RepeatabilityTest;
use crate::rate_table::blocks::Blocks;

/// One run as it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Phase or name of its file; empty within one file.
    pub name: String,
    /// Its blocks, without the settling.
    pub blocks: (usize, usize),
}

/// The runs of a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Runs {
    /// Runs in the order of the recording.
    pub list: Vec<Run>,
    /// Runs that were too short.
    pub too_short: usize,
}

/// Finds the runs: those that are stated; else every file, or every stretch of one file between times without output.
pub fn find(blocks: &Blocks, test: &RepeatabilityTest, files: &[FileSpan]) -> Runs {
    let spans: Vec<(String, (usize, usize))> = if !test.runs.is_empty() {
        find_stated(blocks, &test.runs, files).into_iter().map(|s| (s.name, s.blocks)).collect()
    } else if files.len() > 1 {
        files
            .iter()
            .filter_map(|f| Some((f.phase.clone().unwrap_or_else(|| f.name.clone()), of(blocks, f)?)))
            .collect()
    } else {
        between_pauses(blocks, test.off_s).into_iter().map(|s| (String::new(), s)).collect()
    };
    let mut runs = Runs::default();
    for (name, span) in spans {
        match settled(blocks, span, test.settling_s, test.minimum_run_s) {
            Some(blocks) => runs.list.push(Run { name, blocks }),
            None => runs.too_short += 1,
        }
    }
    runs
}

/// The blocks of a file.
fn of(blocks: &Blocks, file: &FileSpan) -> Option<(usize, usize)> {
    let start = blocks.list.iter().position(|b| within(b, file))?;
    let count = blocks.list.iter().skip(start).take_while(|b| within(b, file)).count();
    Some((start, start + count))
}

/// Stretches of output between times without any.
fn between_pauses(blocks: &Blocks, off_s: f64) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    let mut last_end = f64::NEG_INFINITY;
    for (i, block) in blocks.list.iter().enumerate() {
        if !block.gyro.iter().any(|g| g.is_finite()) {
            continue;
        }
        let (from, to) = span_s(blocks, block);
        match found.last_mut() {
            Some(open) if from - last_end < off_s => open.1 = i + 1,
            _ => found.push((i, i + 1)),
        }
        last_end = to;
    }
    found
}
