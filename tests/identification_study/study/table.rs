//! The study as Markdown. A figure that misses its criterion is bold; with a tilde when the number of records is too
//! small to tell.

use super::mixes::Kind;
use super::rivals::TELLING;
use super::run::IDENTIFIABLE;
use super::tally::{Error, METHODS, Tally, median, share};
use sagnac::noise::data::NoiseType;

/// The first of the methods are ours.
const OURS: usize = 2;
/// A method that finds a term in fewer records is not compared by those.
const OFTEN: f64 = 0.5;
/// Errors beyond this are not printed to the digit.
const BEYOND: f64 = 10.0;

/// Marks a value that misses a criterion: `missed` exactly, `clearly` beyond two standard errors.
fn flagged(text: String, missed: bool, clearly: bool) -> String {
    match (missed, clearly) {
        (true, true) => format!("**{text}**"),
        (true, false) => format!("~{text}"),
        _ => text,
    }
}

/// Standard error of a share.
fn error(p: f64, n: usize) -> f64 {
    (p * (1.0 - p) / n.max(1) as f64).sqrt()
}

fn at_least(p: f64, n: usize, wanted: f64, digits: usize) -> String {
    flagged(format!("{p:.digits$}"), p < wanted, p < wanted - 2.0 * error(wanted, n))
}

pub fn head() {
    println!(
        "| mix | h | records | quantity | bound, % | found | record tells (prefers) | rms/bound | oracle rms/bound | holds (interval) | \
         oracle holds | width/oracle | limit holds | interval or limit holds |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
}

/// One line a quantity. Returns the number of figures that clearly miss their criterion.
pub fn print(tally: &Tally) -> usize {
    let mut misses = 0;
    for line in lines(tally) {
        misses += line.matches("**").count() / 2;
        println!("{line}");
    }
    misses
}

fn number(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{value:.digits$}") } else { String::new() }
}

fn lines(tally: &Tally) -> Vec<String> {
    let records = tally.records.len();
    tally
        .quantities
        .iter()
        .enumerate()
        .map(|(i, q)| {
            let bound = tally.bounds[i];
            let identifiable = bound <= IDENTIFIABLE;
            let ours = tally.error(i, 0);
            let ratio = ours.of_found / bound;
            let wanted = if q.kind == Kind::Coefficient(NoiseType::AngleRandomWalk) { 1.1 } else { 1.3 };
            let spread = 1.0 / (2.0 * records as f64).sqrt();
            let (coverage, intervals) = tally.coverage(i);
            let width = tally.width_ratio(i);
            let (limits, limited) = tally.limits(i);
            let plain = |text: String, missed: bool, clearly: bool| {
                let judged = identifiable && !text.is_empty();
                flagged(text, judged && missed, judged && clearly)
            };
            let found = if identifiable {
                at_least(ours.found, records, 0.95, 3)
            } else {
                number(ours.found, 3)
            };
            let rms = plain(
                number(ratio, 2),
                ratio > wanted,
                ratio * (1.0 - 2.0 * spread) > wanted,
            );
            let slack = 2.0 * error(0.95, intervals);
            let covered = plain(
                number(coverage, 3),
                !(0.93..=0.97).contains(&coverage),
                !(0.93 - slack..=0.97 + slack).contains(&coverage),
            );
            let limit = if limited == 0 {
                String::new()
            } else if identifiable {
                format!("{limits:.3} of {limited}")
            } else {
                format!("{} of {limited}", at_least(limits, limited, 0.95, 3))
            };
            let told = tally.told_apart(i, TELLING);
            let told = if told.is_nan() {
                String::new()
            } else {
                format!("{told:.3} ({:.3})", tally.told_apart(i, 0.0))
            };
            let held = number(tally.holds(i), 3);
            format!(
                "| {} | {} | {records} | {} | {} | {found} | {} | {rms} | {} | {covered} | {} | {} | {limit} | {held} |",
                tally.name,
                tally.hours,
                q.label,
                number(100.0 * bound, 2),
                told,
                number(tally.oracle_rms(i) / bound, 2),
                if identifiable { number(tally.oracle_coverage(i), 3) } else { String::new() },
                plain(number(width, 2), width > 1.2, width > 1.22),
            )
        })
        .collect()
}

pub fn false_head() {
    println!(
        "| mix | h | records | any false claim | without exchanges of filter and Markov that the record cannot tell \
         | by term | range restricted or widened | seconds an identification |"
    );
    println!("|---|---|---|---|---|---|---|---|");
}

/// Returns 1 when false claims clearly exceed 7 %.
pub fn print_false(tally: &Tally) -> usize {
    let records = tally.records.len();
    let (any, beyond) = (tally.false_share(), tally.false_share_beyond_swaps());
    let slack = 2.0 * error(0.07, records);
    let terms: Vec<String> = tally.false_by_term().iter().map(|(t, s)| format!("{t} {s:.3}")).collect();
    println!(
        "| {} | {} | {records} | {} | {} | {} | {:.3} | {:.3} |",
        tally.name,
        tally.hours,
        flagged(format!("{any:.3}"), any > 0.07, any > 0.07 + slack),
        flagged(format!("{beyond:.3}"), beyond > 0.07, beyond > 0.07 + slack),
        terms.join(", "),
        share(tally.records.iter().filter(|r| r.restricted).count(), records),
        median(tally.records.iter().map(|r| r.seconds).collect()),
    );
    usize::from(beyond > 0.07 + slack)
}

pub fn methods_head() {
    let head: Vec<String> = METHODS.iter().map(|m| format!(" {m} |")).collect();
    println!("| mix | h | quantity |{} smallest | smallest where found |", head.concat());
    println!("|---|---|---|{}---|---|", "---|".repeat(METHODS.len()));
}

/// Relative rms error in % with −100 % where nothing is found; in brackets the share found and the error of those.
/// Returns the number of terms for which another method is clearly better than ours.
pub fn print_methods(tally: &Tally) -> usize {
    let records = tally.records.len() as f64;
    let mut behind = 0;
    for (i, q) in tally.quantities.iter().enumerate() {
        let errors: Vec<_> = (0..METHODS.len()).map(|m| tally.error(i, m)).collect();
        if errors.iter().all(|e| e.found == 0.0) {
            continue;
        }
        let cells: Vec<String> = errors
            .iter()
            .map(|e| {
                if e.found == 0.0 {
                    " |".to_owned()
                } else if e.of_found > BEYOND {
                    " over 1000 |".to_owned()
                } else if e.found == 1.0 {
                    format!(" {:.2} |", 100.0 * e.of_all)
                } else {
                    format!(" {:.2} ({:.2}: {:.2}) |", 100.0 * e.of_all, e.found, 100.0 * e.of_found)
                }
            })
            .collect();
        // Two root mean squares of so many records differ by chance by this much at most.
        let chance = 2.0 / records.sqrt();
        let identifiable = tally.bounds[i] <= IDENTIFIABLE;
        let smallest = |of: &dyn Fn(&Error) -> f64| {
            let compared = |m: &usize| errors[*m].found >= OFTEN && of(&errors[*m]).is_finite();
            let best = (0..METHODS.len())
                .filter(compared)
                .min_by(|a, b| of(&errors[*a]).total_cmp(&of(&errors[*b])))
                .unwrap_or(0);
            let ours = (0..OURS).map(|m| of(&errors[m])).fold(f64::INFINITY, f64::min);
            // Not found at all: nothing to set beside.
            let ours = if ours.is_finite() { ours } else { 1.0 };
            let clear = best >= OURS && of(&errors[best]) < ours * (1.0 - chance);
            (flagged(METHODS[best].to_owned(), best >= OURS, clear && identifiable), clear)
        };
        let (all, clear) = smallest(&|e| e.of_all);
        let (found, _) = smallest(&|e| e.of_found);
        behind += usize::from(clear && identifiable);
        println!("| {} | {} | {} |{} {all} | {found} |", tally.name, tally.hours, q.label, cells.concat());
    }
    behind
}
