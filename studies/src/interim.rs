//! How often a growing test that is looked at by a plan accepts or rejects a unit exactly at its limit, what the plan costs in
//! power, and how early it ends.

use crate::bench::chance::Chance;
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::estimate::{
    Dependence, Estimate, Limit, Rule, Spread, Verdict, deciding_scores, judge, normal_probability,
};

/// Looks at a test that grows hour by hour.
pub static STUDY: Study = Study {
    id: "interim",
    title: "Looks at a growing test",
    method: "A test of 100 h grows hour by hour. The mean is that of white samples with known scatter; the deviation is that of 10 \
             white samples an hour; the unrelated estimates are drawn anew at every look. Each look judges the whole of what there \
             is by the limit, at the risk that the plan leaves to it, and the test ends with the first pass or fail. \
             Units lie exactly at the limit, or inside by a number of standard errors of the full test. The generator adds up \
             samples and uses no formula of the plan.",
    records: 20_000,
    cases,
};

/// Risk of the limits.
const RISK: f64 = 0.05;
/// Length of the full test, h.
const FULL_H: usize = 100;
/// Samples an hour of the process whose deviation is judged.
const SAMPLES_AN_HOUR: usize = 10;
/// Limit of every quantity.
const LIMIT: f64 = 1.0;
/// Standard error of the mean of the full test.
const STANDARD_ERROR: f64 = 0.01;

/// A quantity that is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Quantity {
    Mean,
    Deviation,
    Unrelated,
}

/// Looks, h.
#[derive(Debug, Clone)]
struct Plan {
    name: &'static str,
    looks_h: Vec<usize>,
    /// False: each look at the full risk, as without a plan.
    spends: bool,
}

fn plans() -> Vec<Plan> {
    let plan = |name, looks_h: Vec<usize>, spends| Plan { name, looks_h, spends };
    vec![
        plan("looks at 1, 2, 4 … 64, 100 h", vec![1, 2, 4, 8, 16, 32, 64, 100], true),
        plan("looks at 10, 25, 50, 100 h", vec![10, 25, 50, 100], true),
        plan("looks every hour", (1..=FULL_H).collect(), true),
        plan("every hour at the full risk, without a plan", (1..=FULL_H).collect(), false),
        plan("one look at 100 h", vec![100], true),
    ]
}

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for plan in plans() {
        for quantity in [Quantity::Mean, Quantity::Deviation, Quantity::Unrelated] {
            if quantity != Quantity::Mean && !plan.spends {
                continue;
            }
            let of = match quantity {
                Quantity::Mean => "mean",
                Quantity::Deviation => "deviation",
                Quantity::Unrelated => "unrelated estimates",
            };
            let plan = plan.clone();
            let first = 91_000_000 + 1_000_000 * cases.len() as u64;
            cases.push(Case::new(format!("{of}, {}", plan.name), move |records, seed| {
                rows(&plan, quantity, records, first + 100_000_000 * (seed - 1))
            }));
        }
    }
    cases
}

fn rows(plan: &Plan, quantity: Quantity, records: u64, first: u64) -> Vec<Row> {
    let risks = risks(plan, quantity);
    let run = |inside: f64| -> Vec<(Verdict, usize)> {
        (first..first + records)
            .into_par_iter()
            .map(|seed| outcome(plan, quantity, &risks, inside, &mut Chance::new(seed)))
            .collect()
    };
    let count = |of: &[(Verdict, usize)], verdict| of.iter().filter(|(v, _)| *v == verdict).count() as u64;
    let at_limit = run(0.0);
    let asked = if plan.spends { Asked::AtMost(RISK) } else { Asked::Nothing };
    let mut rows = vec![
        Row::share(
            "unit exactly at its limit",
            "passes, of 5 % stated",
            asked,
            count(&at_limit, Verdict::Pass),
            records,
        ),
        Row::share(
            "unit exactly at its limit",
            "fails, of 5 % stated",
            asked,
            count(&at_limit, Verdict::Fail),
            records,
        ),
    ];
    if !plan.spends || plan.looks_h.len() == 1 || quantity == Quantity::Unrelated {
        return rows;
    }
    let fixed = Plan { name: "", looks_h: vec![FULL_H], spends: true };
    for inside in [2.0, 3.0, 4.0, 6.0, 8.0] {
        let looked = run(inside);
        let (passed, of) = (count(&looked, Verdict::Pass), (first..first + records).into_par_iter());
        let by_fixed = of
            .filter(|s| outcome(&fixed, quantity, &[RISK], inside, &mut Chance::new(*s)).0 == Verdict::Pass)
            .count() as f64;
        let name = format!("unit {inside} standard errors inside");
        let ratio = passed as f64 / by_fixed;
        // The plan of every hour pays more for its looks.
        let power = if plan.looks_h.len() < 20 { Asked::AtLeast(0.98) } else { Asked::Nothing };
        rows.push(Row::number(&name, "power over that of the fixed test", power, ratio, records));
        let hours: usize = looked.iter().map(|(_, hours)| hours).sum();
        let mean = hours as f64 / records as f64 / FULL_H as f64;
        let expected = match (inside as u32, plan.looks_h.len(), quantity) {
            (4, 8, Quantity::Mean) => Asked::Between(0.63, 0.67),
            (6, 8, Quantity::Mean) => Asked::Between(0.45, 0.49),
            (8, 8, Quantity::Mean) => Asked::Between(0.34, 0.38),
            _ => Asked::Nothing,
        };
        rows.push(Row::number(&name, "mean duration over the full one", expected, mean, records));
    }
    rows
}

/// Risk of the limit at each look.
fn risks(plan: &Plan, quantity: Quantity) -> Vec<f64> {
    if !plan.spends {
        return vec![RISK; plan.looks_h.len()];
    }
    let shares: Vec<f64> = plan.looks_h.iter().map(|h| *h as f64 / FULL_H as f64).collect();
    let dependence = match quantity {
        Quantity::Unrelated => Dependence::Unknown,
        _ => Dependence::IndependentGains,
    };
    let scores = deciding_scores(RISK, &shares, dependence).unwrap_or_default();
    scores.iter().map(|score| normal_probability(-score)).collect()
}

/// What becomes of one test, and the hour of it.
fn outcome(
    plan: &Plan,
    quantity: Quantity,
    risks: &[f64],
    inside: f64,
    chance: &mut Chance,
) -> (Verdict, usize) {
    // Relative error of the deviation of n samples: 1 / √(2 n).
    let samples = (FULL_H * SAMPLES_AN_HOUR) as f64;
    let error = if quantity == Quantity::Deviation { 1.0 / (2.0 * samples).sqrt() } else { STANDARD_ERROR };
    let truth = LIMIT - inside * error;
    let (mut sum, mut squares, mut hours) = (0.0, 0.0, 0);
    for (look_h, risk) in plan.looks_h.iter().zip(risks) {
        for _ in hours..*look_h {
            match quantity {
                Quantity::Mean => sum += truth + STANDARD_ERROR * (FULL_H as f64).sqrt() * chance.normal(),
                Quantity::Deviation => {
                    squares += (0..SAMPLES_AN_HOUR).map(|_| (truth * chance.normal()).powi(2)).sum::<f64>();
                }
                Quantity::Unrelated => {}
            }
        }
        hours = *look_h;
        let error = STANDARD_ERROR * (FULL_H as f64 / hours as f64).sqrt();
        let normal = Spread::Normal { standard_uncertainty: error };
        let (value, spread) = match quantity {
            Quantity::Mean => (sum / hours as f64, normal),
            Quantity::Unrelated => (truth + error * chance.normal(), normal),
            Quantity::Deviation => {
                let n = (hours * SAMPLES_AN_HOUR) as f64;
                ((squares / n).sqrt(), Spread::ChiSquare { dof: n })
            }
        };
        // A look that can spend nothing decides nothing.
        if *risk <= 0.0 {
            continue;
        }
        let estimate = Estimate::measured("static_bias", "rate", value, "deg/h", spread, "mean");
        let limit =
            Limit { min: None, max: Some(LIMIT), rule: Rule::GuardBand, risk: *risk, source: String::new() };
        let verdict = judge(&estimate, &limit).verdict;
        if verdict != Verdict::Indeterminate {
            return (verdict, hours);
        }
    }
    (Verdict::Indeterminate, FULL_H)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plan_keeps_the_risk_that_hourly_looks_do_not() {
        let plans = plans();
        let passes = |plan: &Plan| {
            let risks = risks(plan, Quantity::Mean);
            let passed = |seed: &u64| {
                outcome(plan, Quantity::Mean, &risks, 0.0, &mut Chance::new(*seed)).0 == Verdict::Pass
            };
            (1..=2000).filter(passed).count() as f64 / 2000.0
        };
        assert!(passes(&plans[1]) < 0.065, "{}", passes(&plans[1]));
        assert!(passes(&plans[3]) > 0.2, "{}", passes(&plans[3]));
    }
}
