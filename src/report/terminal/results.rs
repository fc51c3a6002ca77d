//! Results of any kind as text.

use super::{Terminal, explanation, run};
use crate::i18n::Lang;
use crate::report::explain::ExplainView;
use crate::report::view::{PhasePart, View};
use crate::report::{Record, Results, RunResults, page};

/// Results as text for a terminal.
pub fn results(results: &Results, lang: Lang, terminal: Terminal) -> String {
    if let Results::Run(of) = results {
        return run(&view(of, lang), lang, terminal);
    }
    match results.record().record() {
        Record::Explanation(of) => {
            let view = ExplainView::new(&of.explanation, &[], &of.context, lang);
            explanation(&view, lang, terminal)
        }
        // The units of a lot were told before, a line each.
        Record::Lot(_) => format!("\n{}", page::terminal(&results.record().on_terminal(lang), terminal)),
        _ => page::terminal(&results.record().on_terminal(lang), terminal),
    }
}

/// The view of a run, with its phases where it has some.
fn view(results: &RunResults, lang: Lang) -> View {
    let record = &results.outcome.record;
    let phases = record.phases.iter().zip(&results.phases);
    let parts: Vec<PhasePart<'_>> = phases
        .map(|(phase, outcome)| PhasePart {
            phase,
            record: outcome.as_ref().map(|o| &o.record),
            figures: &[],
        })
        .collect();
    View::of_phases(record, &parts, lang)
}
