//! Status of each recorded column: it drives something that was found, it is silent, or it cannot be used and why.

use super::finding::{ColumnRecord, ColumnStatus, Finding, ParameterValue, UnusableColumn};
use super::fitted_hypothesis::FittedHypothesis;
use super::named::NamedEffect;
use super::problem::Problem;
use super::select::MOST_EQUIVALENTS;
use crate::effect::{COLUMN_TEXT, Column, ResponseLaw, any_column_driver, find};
use crate::estimate::SCORE_ONE_SIDED_95;
use crate::numeric::cosine::dct2;
use crate::series::ReadFrom;
use std::collections::BTreeMap;

/// Parameter of every effect that adds to the rate.
const RMS: &str = "rms_deg_h";
/// Coefficient of the law of any column.
const COEFFICIENT: &str = "coefficient";

/// Every column with its part in what was found. `best` is what was selected, `read_from` the names in the file.
pub(super) fn records(
    problem: &Problem,
    best: &FittedHypothesis,
    named: &[NamedEffect],
    read_from: &[ReadFrom],
) -> Vec<ColumnRecord> {
    let recorded_as = |column: Column| other_name(column, read_from).map(ToOwned::to_owned);
    let drives = |column: Column| {
        named.iter().any(|n| {
            let named = n.estimated.texts.get(COLUMN_TEXT).or_else(|| n.estimated.texts.get("column2"));
            named.is_some_and(|name| name == column.name()) || n.effect.needs().contains(&column)
        })
    };
    let used = |column: Column| {
        let is_used = drives(column);
        ColumnRecord {
            name: column.name().to_owned(),
            recorded_as: recorded_as(column),
            status: if is_used { ColumnStatus::Used } else { ColumnStatus::Silent },
            reason: None,
            at_most_deg_h: if is_used { None } else { linear_limit(column, problem, best) },
        }
    };
    let unusable = |(column, reason): &(Column, UnusableColumn)| ColumnRecord {
        name: column.name().to_owned(),
        recorded_as: recorded_as(*column),
        status: ColumnStatus::Unusable,
        reason: Some(*reason),
        at_most_deg_h: None,
    };
    problem.drivers.columns().map(used).chain(problem.unusable.iter().map(unusable)).collect()
}

/// The name of a column in the file, where it is another than its own.
fn other_name(column: Column, read_from: &[ReadFrom]) -> Option<&str> {
    let read = read_from.iter().find(|r| r.name == column.name());
    read.map(|r| r.column.as_str()).filter(|name| *name != column.name())
}

/// Names the column of the file in a cause that follows the temperature, where the thermometer is not on the unit: there it may
/// say as little of the unit as any other column, and the cause is that of any other column. The law stays among the equivalents.
pub(super) fn as_recorded(findings: &mut [Finding], read_from: &[ReadFrom]) {
    let is_elsewhere = |c: &Column| read_from.iter().any(|r| r.name == c.name() && r.elsewhere);
    let elsewhere = |c: &Column| other_name(*c, read_from).filter(|_| is_elsewhere(c));
    for finding in findings {
        for named in [&mut finding.column, &mut finding.column2] {
            let recorded = named.as_ref().and_then(|name| elsewhere(&Column::of_name(name)));
            if let Some(recorded) = recorded.map(str::to_owned) {
                *named = Some(recorded);
            }
        }
        let Some(law) = find(&finding.kind).and_then(|e| e.law()) else { continue };
        let needed = find(finding.effect_id()).map_or(&[][..], |e| e.needs());
        let Some(name) = needed.iter().find_map(elsewhere) else { continue };
        finding.column = Some(name.to_owned());
        finding.law = Some(law.id().to_owned());
        if let Some(driver) = any_column_driver() {
            by_any_column(finding, driver.kind(), law);
        }
    }
}

/// Makes a law of the temperature the law of any column: its kind, its coefficient, and the probability of all such laws together.
fn by_any_column(finding: &mut Finding, driver: &str, law: ResponseLaw) {
    let is_law = |kind: &String| find(kind).and_then(|e| e.law()).is_some();
    let together: f64 = finding
        .probabilities
        .iter()
        .filter(|(kind, _)| is_law(kind))
        .map(|(_, probability)| probability)
        .sum();
    finding.probabilities.retain(|kind, _| !is_law(kind));
    if together > 0.0 {
        *finding.probabilities.entry(driver.to_owned()).or_default() += together;
    }
    let own = std::mem::replace(&mut finding.kind, driver.to_owned());
    finding.equivalents.retain(|kind| *kind != driver && *kind != own);
    finding.equivalents.insert(0, own);
    finding.equivalents.truncate(MOST_EQUIVALENTS);
    // Of a rate of change it is per hour, as of any column.
    let scale = if law == ResponseLaw::Rate { 1.0 / 60.0 } else { 1.0 };
    let (sizes, coefficients): (BTreeMap<_, _>, BTreeMap<_, _>) =
        std::mem::take(&mut finding.parameters).into_iter().partition(|(name, _)| name == RMS);
    finding.parameters = sizes;
    let coefficient = coefficients.into_values().next();
    let coefficient = coefficient.filter(|_| matches!(law, ResponseLaw::Linear | ResponseLaw::Rate));
    finding.parameters.extend(coefficient.map(|ParameterValue { value, ci95, .. }| {
        let unit = String::new();
        (COEFFICIENT.to_owned(), ParameterValue { value: scale * value, unit, ci95: ci95.map(|c| scale * c) })
    }));
}

/// One-sided 95 % limit of what is proportional to a column, rms over the record, deg/h.
fn linear_limit(column: Column, problem: &Problem, best: &FittedHypothesis) -> Option<f64> {
    let values = problem.drivers.column(column)?;
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let rms = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    let (residual, powers) = (best.residual(&problem.spectra), best.powers(&problem.spectra));
    let (mut both, mut own) = (0.0, 0.0);
    for ((z, x), p) in dct2(values).iter().zip(&residual).zip(&powers).skip(1) {
        both += z * x / p;
        own += z * z / p;
    }
    let limit = rms * ((both / own).abs() + SCORE_ONE_SIDED_95 / own.sqrt());
    limit.is_finite().then_some(limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thermometer_that_is_not_on_the_unit_is_a_column_as_any_other() {
        let mut finding = Finding {
            kind: "temp_linear".to_owned(),
            effect: None,
            column: None,
            column2: None,
            law: None,
            formula: None,
            shape: None,
            equivalents: ["temp_rate", "temp_polynomial", "unobserved_driver"].map(str::to_owned).to_vec(),
            probabilities: [("temp_linear", 0.6), ("temp_rate", 0.2), ("excess_rrw", 0.1)]
                .map(|(kind, p)| (kind.to_owned(), p))
                .into(),
            parameters: [("coefficient_deg_h_per_degC", 3.0), ("rms_deg_h", 2.0)]
                .map(|(name, value)| {
                    let unit = "deg/h".to_owned();
                    (name.to_owned(), ParameterValue { value, unit, ci95: [0.5 * value, 2.0 * value] })
                })
                .into(),
            places: vec![],
            delta_bic: 100.0,
            p_value: 1e-9,
            heldout_gain: None,
            removed_share: None,
        };
        let after = |finding: &Finding, name: &str| {
            let column = name.to_owned();
            let elsewhere = name == "rack_degC";
            let read =
                ReadFrom { name: Column::Temperature.name(), column, unit: "degC".to_owned(), elsewhere };
            let mut findings = [finding.clone()];
            as_recorded(&mut findings, &[read]);
            findings[0].clone()
        };
        for its_own in ["temp_degC", "T_housing [degC]", "Температура"] {
            assert_eq!(after(&finding, its_own), finding, "{its_own}");
        }
        let of_rack = after(&finding, "rack_degC");
        assert_eq!((of_rack.column.as_deref(), of_rack.law.as_deref()), (Some("rack_degC"), Some("linear")));
        assert_eq!(of_rack.kind, "column_driver");
        assert_eq!(of_rack.equivalents, ["temp_linear", "temp_rate", "temp_polynomial"]);
        let probabilities = &of_rack.probabilities;
        assert!((probabilities["column_driver"] - 0.8).abs() < 1e-12 && probabilities.len() == 2);
        let parameter = |f: &Finding, name: &str| f.parameters.get(name).map(|p| (p.value, p.ci95));
        assert_eq!(parameter(&of_rack, "coefficient"), Some((3.0, [1.5, 6.0])));
        assert_eq!(parameter(&of_rack, "rms_deg_h"), Some((2.0, [1.0, 4.0])));
        assert_eq!(of_rack.parameters.len(), 2);
        // Per hour in place of per minute; a loop has no coefficient.
        finding.kind = "temp_rate".to_owned();
        assert_eq!(parameter(&after(&finding, "rack_degC"), "coefficient"), Some((0.05, [0.025, 0.1])));
        finding.kind = "temp_hysteresis".to_owned();
        assert_eq!(parameter(&after(&finding, "rack_degC"), "coefficient"), None);
        finding.kind = "noise_variance_driver".to_owned();
        finding.column = Some(Column::Temperature.name().to_owned());
        let level = after(&finding, "rack_degC");
        assert_eq!((level.column.as_deref(), level.law), (Some("rack_degC"), None));
        assert_eq!(level.equivalents, finding.equivalents);
    }
}
