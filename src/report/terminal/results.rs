//! Results of any kind as text.

use super::Terminal;
use super::run::run;
use crate::estimate::Verdict;
use crate::i18n::Lang;
use crate::report::translator::Translator;
use crate::report::view::{Part, Phase};
use crate::report::{Record, Results, RunResults, page};

/// Results as text for a terminal.
pub fn results(results: &Results, lang: Lang, terminal: Terminal) -> String {
    if let Results::Run(of) = results {
        return run_with_phases(of, lang, terminal);
    }
    match results.record().record() {
        // The units of a lot were told before, a line each.
        Record::Lot(_) => format!("\n{}", page::terminal(&results.record().on_terminal(lang), terminal)),
        _ => page::terminal(&results.record().on_terminal(lang), terminal),
    }
}

/// The verdict of a test in a word, on a line of its own behind what was printed of it; empty where nothing was decided.
pub fn verdict(results: &Results, lang: Lang, terminal: Terminal) -> String {
    let Results::Run(of) = results else { return String::new() };
    let (verdict, words) = (of.outcome.record.verdict, Translator { lang });
    if verdict == Verdict::None {
        return String::new();
    }
    let word = terminal.verdict(&words.verdict(verdict).to_uppercase(), verdict.id());
    format!("{}: {word}\n", words.t("report.verdict"))
}

/// A run with its phases where it has some.
fn run_with_phases(results: &RunResults, lang: Lang, terminal: Terminal) -> String {
    let record = &results.outcome.record;
    let words = Translator { lang };
    let phases = record.phases.iter().zip(&results.phases).zip(1..).map(|((phase, outcome), number)| {
        let part = outcome.as_ref().map(|o| Part::of_phase(phase, &o.record, &[], words));
        Phase { phase, number, part }
    });
    run(&Part::new(record, &[], words), &phases.collect::<Vec<_>>(), terminal)
}
