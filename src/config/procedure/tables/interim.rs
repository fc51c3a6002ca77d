//! The table of a procedure that may be decided before its full duration.

use crate::config::procedure::interim_plan::InterimPlan;
use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::{Look, Section};
use crate::config::table::Table;
use crate::i18n::{Arg, note};

/// Looks at a growing recording of a unit at rest, fixed before the data are examined. At each of them the test may end, and the
/// risk of every limit over all looks together stays as stated. A recording is evaluated up to the last look that it has
/// reached.
#[derive(Table)]
#[table("interim")]
pub(in crate::config::procedure) struct InterimKeys {
    /// Evaluated time after the warm-up at which the test is looked at: times such as "10 h", or shares of the full duration such
    /// as "10 %" or 0.1. They ascend, and the last one is the full duration.
    #[key(required, example = ["10 h", "25 h", "50 h", "100 h"])]
    pub looks: Vec<Look>,
    /// Full duration that shares are of. Default: `planned_duration` of the conditions.
    #[key(quantity = "s", above = 0, example = "100 h")]
    pub full_duration_s: Option<f64>,
    /// Risk of every limit, over all looks together. Default: the risk that each limit states.
    #[key(above = 0, max = 0.4, example = 0.05)]
    pub risk: Option<f64>,
}

impl InterimKeys {
    /// The plan of a procedure with a planned duration; shares of an unknown duration, which validation refuses, are left out.
    pub(in crate::config::procedure) fn plan(self, planned_s: Option<f64>) -> InterimPlan {
        let full_s = self.full_duration_s.or(planned_s);
        let time = |look: &Look| match look {
            Look::Time(seconds) => Some(*seconds),
            Look::Share(share) => full_s.map(|full| share * full),
        };
        let looks_s = self.looks.iter().filter_map(time).collect();
        InterimPlan { looks_s, risk: self.risk, reached: None }
    }
}

/// Contradictions within the table and with the rest of the procedure.
pub(in crate::config::procedure) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let (Some(section), Some(plan)) = (root.table("interim"), &procedure.interim) else { return };
    let at = section.span_of("looks");
    let looks = Vec::<Look>::default();
    let given = match section.entry("looks") {
        Some(crate::config::section::Entry::Looks(given)) => given,
        _ => &looks,
    };
    let full_s = section.number("full_duration").or(procedure.conditions.planned_duration_s);
    let has_shares = given.iter().any(|look| matches!(look, Look::Share(_)));
    if has_shares && full_s.is_none() {
        reader.error(&at, "interim_check.no_full_duration", Some("interim_check.help.full_duration".into()));
        return;
    }
    let (Some(first), Some(last)) = (plan.looks_s.first(), plan.looks_s.last()) else { return };
    if plan.looks_s.windows(2).any(|pair| matches!(pair, [a, b] if b <= a)) {
        reader.error(&at, "interim_check.order", Some("interim_check.help.order".into()));
    } else if let Some(full_s) = full_s.filter(|full| (last / full - 1.0).abs() > 1e-9) {
        let message = note!("interim_check.last", last = Arg::span(*last), full = Arg::span(full_s));
        reader.error(&at, message, Some("interim_check.help.last".into()));
    }
    if let Some(least_s) = procedure.conditions.minimum_duration_s.filter(|least| first < least) {
        let message = note!("interim_check.too_early", first = Arg::span(*first), least = Arg::span(least_s));
        reader.error(&at, message, Some("interim_check.help.too_early".into()));
    }
    if !procedure.is_at_rest() {
        reader.error(&section.span.clone(), "interim_check.only_at_rest", None);
    }
}
