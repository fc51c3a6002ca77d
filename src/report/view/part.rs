//! The record of a run or of one phase, with what the sections of its page share.

use super::rows::{self, Row};
use crate::figure::Figure;
use crate::record::{FigureRecord, MeasurandRecord, PhaseRecord, RunRecord};
use crate::report::page::{Block, Footnotes};
use crate::report::translator::Translator;
use std::ops::RangeInclusive;

/// The record of a run or of one phase, with what the sections of its page share.
pub struct Part<'a> {
    /// The record.
    pub record: &'a RunRecord,
    /// The figures that it names, with their files.
    pub figure_records: &'a [FigureRecord],
    /// The figures whose data are kept.
    pub figures: &'a [Figure],
    /// Rows with a limit.
    pub judged: Vec<Row<'a>>,
    /// Rows without a limit.
    pub further: Vec<Row<'a>>,
    /// Footnotes of the rows, those of rows with a limit first.
    pub footnotes: Vec<String>,
    /// How many footnotes are those of rows with a limit.
    pub limit_footnotes: usize,
    /// True where rows must name their channel.
    pub several_channels: bool,
    /// Beginning of the marks that others refer to: it differs between the phases of one page.
    pub anchor: String,
    /// The language.
    pub words: Translator,
}

/// A phase of a test as its page shows it.
pub struct Phase<'a> {
    /// The phase in the record of the whole.
    pub phase: &'a PhaseRecord,
    /// Number, counted from 1.
    pub number: usize,
    /// What it found; `None` where it was not recorded.
    pub part: Option<Part<'a>>,
}

impl<'a> Part<'a> {
    /// Of a record of a single test.
    pub fn new(record: &'a RunRecord, figures: &'a [Figure], words: Translator) -> Part<'a> {
        let mut footnotes = vec![];
        // Footnotes are numbered in reading order: all rows with limits come first.
        let with_limit = record.measurands.iter().filter(|m| m.limit.is_some());
        let judged = with_limit.map(|m| Row::new(m, words, &mut footnotes)).collect();
        let limit_footnotes = footnotes.len();
        let without = record.measurands.iter().filter(|m| m.limit.is_none());
        let further = without.map(|m| Row::new(m, words, &mut footnotes)).collect();
        Part {
            record,
            figure_records: &record.figures,
            figures,
            judged,
            further,
            footnotes,
            limit_footnotes,
            several_channels: has_several_channels(&record.measurands),
            anchor: String::new(),
            words,
        }
    }

    /// Of a phase, whose figures have the names that the record of the whole gives them.
    pub fn of_phase(
        phase: &'a PhaseRecord,
        record: &'a RunRecord,
        figures: &'a [Figure],
        words: Translator,
    ) -> Part<'a> {
        let anchor = format!("{}-", phase.id);
        Part { figure_records: &phase.figures, anchor, ..Part::new(record, figures, words) }
    }

    /// Whether a row has a reference value.
    pub fn has_references(&self) -> bool {
        self.judged.iter().chain(&self.further).any(|r| r.of.reference.is_some())
    }

    /// True for a phase of a test of several.
    pub fn is_phase(&self) -> bool {
        !self.anchor.is_empty()
    }

    /// The footnotes of a range of numbers; nothing where there are none.
    pub fn notes(&self, numbers: RangeInclusive<usize>) -> Option<Block> {
        let all = (1..).zip(self.footnotes.iter().cloned());
        let notes: Vec<(usize, String)> = all.filter(|(n, _)| numbers.contains(n)).collect();
        let is_empty = notes.is_empty();
        (!is_empty).then(|| Block::Footnotes(Footnotes { anchor: self.anchor.clone(), notes }))
    }

    /// A heading, and the channel that it is of where there are several.
    pub fn of_channel(&self, heading: &str, channel: &str) -> String {
        if self.several_channels && !channel.is_empty() {
            format!("{heading}: {channel}")
        } else {
            heading.to_owned()
        }
    }

    /// Reasons for the verdict, those of rows with their numbers.
    pub fn summary(&self) -> Vec<String> {
        let record = self.record;
        rows::summary(&record.summary, &record.measurands, self.several_channels, self.words)
    }

    /// Errors in words.
    pub fn errors(&self) -> Vec<String> {
        self.record.errors.iter().map(|n| self.words.say(n)).collect()
    }

    /// Which attempt at the test this is and what came of those before, and that the unit is unlike the others of its lot;
    /// empty for a first attempt of a unit that is not.
    pub fn attempt(&self) -> Vec<String> {
        let earlier = self.record.attempt.iter().flat_map(|a| &a.summary);
        let others = self.record.siblings.iter().flat_map(|s| &s.summary);
        earlier.chain(others).map(|m| self.words.say(m)).collect()
    }

    /// Title of the test.
    pub fn title(&self) -> String {
        let procedure = self.record.procedure.as_ref();
        procedure.map_or_else(|| self.words.t("report.title_analysis"), |p| self.words.local(&p.title))
    }
}

impl Phase<'_> {
    /// Title in the language of the page.
    pub fn title(&self, words: Translator) -> String {
        words.local(&self.phase.title)
    }

    /// Mark that links within the page lead to.
    pub fn mark(&self) -> String {
        format!("phase-{}", self.phase.id)
    }

    /// Reasons for the verdict of the phase.
    pub fn summary(&self, words: Translator) -> Vec<String> {
        let phase = self.phase;
        let several = has_several_channels(&phase.measurands);
        rows::summary(&phase.summary, &phase.measurands, several, words)
    }
}

/// True where rows belong to more channels than one, so that each must be named.
fn has_several_channels(rows: &[MeasurandRecord]) -> bool {
    rows.iter().any(|m| rows.first().is_some_and(|first| first.channel != m.channel))
}
