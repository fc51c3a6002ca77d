//! A plan in sentences.

use super::print::{chance, title};
use crate::plan::Plan;
use crate::plan::record::{Contrast, PairPlan, PlanOutcome};
use crate::report::number::limit_digits;
use crate::report::translator::Translator;
use crate::schedule::Step;

/// Digits of temperatures, rates and lengths.
const QUANTITY_DIGITS: usize = 4;

/// What a step asks for.
pub(super) fn step(step: &Step, words: Translator) -> String {
    let number = |value: f64| limit_digits(value, QUANTITY_DIGITS, words.lang);
    let list =
        |values: &[f64]| values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(&words.t("number.list"));
    match step {
        Step::Hold { duration_h } => words.with("plan.step.hold", &[("hours", &number(*duration_h))]),
        Step::Ramp { to_degc, rate_degc_per_h } => {
            words.with("plan.step.ramp", &[("to", &number(*to_degc)), ("rate", &number(*rate_degc_per_h))])
        }
        Step::Cycle { low_degc, high_degc, rate_degc_per_h, soak_h, count } => {
            let (low, high, rate) = (number(*low_degc), number(*high_degc), number(*rate_degc_per_h));
            let (count, soak) = (count.to_string(), number(*soak_h));
            let mut given = vec![("low", &*low), ("high", &*high), ("rate", &*rate), ("count", &*count)];
            if *soak_h > 0.0 {
                given.push(("soak", &*soak));
                return words.with("plan.step.cycle_soak", &given);
            }
            words.with("plan.step.cycle", &given)
        }
        Step::TableRates { rates_deg_s, dwell_s, count } => words.with(
            "plan.step.table_rates",
            &[("rates", &list(rates_deg_s)), ("dwell", &number(*dwell_s)), ("count", &count.to_string())],
        ),
        Step::Headings { angles_deg, dwell_s, count } => words.with(
            "plan.step.headings",
            &[("angles", &list(angles_deg)), ("dwell", &number(*dwell_s)), ("count", &count.to_string())],
        ),
    }
}

/// The outcome.
pub(super) fn summary(plan: &Plan, words: Translator) -> Vec<String> {
    let budget = limit_digits(plan.budget_h, 3, words.lang);
    let asked = crate::report::number::percent(plan.asked, words.lang);
    let mut out = vec![];
    match (plan.outcome, &plan.schedule) {
        (PlanOutcome::Decides, Some(s)) => {
            let (hours, probability) =
                (limit_digits(s.duration_h, 3, words.lang), chance(s.probability, words));
            let given = [("hours", &*hours), ("probability", &*probability)];
            out.push(words.with("plan.says.decides", &given));
        }
        (PlanOutcome::TooShort, Some(s)) => {
            let hours = limit_digits(s.duration_h, 3, words.lang);
            let probability = chance(s.probability, words);
            let given = [
                ("budget", &*budget),
                ("asked", &*asked),
                ("hours", &*hours),
                ("probability", &*probability),
            ];
            out.push(words.with("plan.says.too_short", &given));
            out.push(match plan.needed_h {
                Some(needed) => words.with(
                    "plan.says.needed",
                    &[("hours", &limit_digits(needed, 3, words.lang)), ("asked", &asked)],
                ),
                None => words.with("plan.says.never", &[("asked", &asked)]),
            });
        }
        (PlanOutcome::NothingToDecide, _) => out.push(words.t("plan.says.nothing_to_decide")),
        _ => out.push(words.t("plan.says.undecidable")),
    }
    if !plan.to_record.is_empty() {
        let columns: Vec<String> = plan.to_record.iter().map(|c| format!("`{c}`")).collect();
        let columns = columns.join(&words.t("number.list"));
        out.push(words.with("plan.says.record", &[("columns", &columns)]));
    }
    out
}

/// What decides between two explanations.
pub(super) fn why(pair: &PairPlan, words: Translator) -> String {
    let number = |value: f64| limit_digits(value, 3, words.lang);
    let (truth, against) = (title(&pair.truth, words), title(&pair.against, words));
    let says = |key: &str, given: &[(&str, &str)]| {
        let both = [("truth", &*truth), ("against", &*against)];
        words.with(key, &[&both[..], given].concat())
    };
    match &pair.contrast {
        Contrast::HeatingAndCooling { rate_degc_per_h } => {
            says("plan.why.heating_and_cooling", &[("rate", &number(*rate_degc_per_h))])
        }
        Contrast::RampRates { slowest_degc_per_h, fastest_degc_per_h } => says(
            "plan.why.ramp_rates",
            &[("slow", &number(*slowest_degc_per_h)), ("fast", &number(*fastest_degc_per_h))],
        ),
        Contrast::RampAndSoak { rate_degc_per_h } => {
            says("plan.why.ramp_and_soak", &[("rate", &number(*rate_degc_per_h))])
        }
        Contrast::SignsOfRate { largest_deg_s } => {
            says("plan.why.signs_of_rate", &[("rate", &number(*largest_deg_s))])
        }
        Contrast::SizesOfRate { smallest_deg_s, largest_deg_s } => says(
            "plan.why.sizes_of_rate",
            &[("small", &number(*smallest_deg_s)), ("large", &number(*largest_deg_s))],
        ),
        Contrast::Headings { count } => says("plan.why.headings", &[("count", &count.to_string())]),
        Contrast::Length { hours } => says("plan.why.length", &[("hours", &number(*hours))]),
        Contrast::Nothing => says("plan.why.nothing", &[]),
    }
}
