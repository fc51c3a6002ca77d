//! What became of each recorded column: it drives something that was found, it is silent, or it cannot be used and why.

use super::finding::{ColumnRecord, ColumnStatus, Finding, UnusableColumn};
use super::named::Named;
use super::problem::Problem;
use super::tried::Tried;
use crate::effect::{Column, ResponseLaw, find};
use crate::numeric::cosine::dct2;
use crate::series::ReadFrom;

/// Standard deviations from the estimate to a one-sided 95 % limit.
const ONE_SIDED_95: f64 = 1.644_854;

/// Every column with its part in what was found. `best` is what was selected, `read_from` the names in the file.
pub(super) fn records(
    problem: &Problem,
    best: &Tried,
    named: &[Named],
    read_from: &[ReadFrom],
) -> Vec<ColumnRecord> {
    let recorded_as = |column: Column| other_name(column, read_from).map(ToOwned::to_owned);
    let drives = |column: Column| {
        named.iter().any(|n| {
            let named = n.estimated.texts.get("column").or_else(|| n.estimated.texts.get("column2"));
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

/// Whether a thermometer is said to be somewhere else than on the unit: it may say as little of it as any other column.
fn is_elsewhere(column: Column, name: &str) -> bool {
    const PLACES: [&str; 10] =
        ["rack", "room", "ambient", "outside", "outdoor", "hall", "air", "помещ", "комн", "стойк"];
    let name = name.to_lowercase();
    column == Column::Temperature && PLACES.iter().any(|place| name.contains(place))
}

/// Says of a cause that follows the temperature which column of the file that is, where the thermometer is somewhere else than on
/// the unit: to somebody else it is a column as any other.
pub(super) fn as_recorded(findings: &mut [Finding], read_from: &[ReadFrom]) {
    /// Kinds that are an equivalent at most.
    const MOST: usize = 3;
    let elsewhere = |c: &Column| other_name(*c, read_from).filter(|name| is_elsewhere(*c, name));
    for finding in findings {
        for named in [&mut finding.column, &mut finding.column2] {
            let recorded = named.as_ref().and_then(|name| elsewhere(&Column::of_name(name)));
            if let Some(recorded) = recorded.map(str::to_owned) {
                *named = Some(recorded);
            }
        }
        let Some(law) = law_of(&finding.kind) else { continue };
        let needed = find(finding.effect_id()).map_or(&[][..], |e| e.needs());
        let Some(name) = needed.iter().find_map(elsewhere) else { continue };
        finding.column = Some(name.to_owned());
        finding.law = Some(law.id().to_owned());
        finding.equivalents.insert(0, COLUMN_DRIVER.to_owned());
        finding.equivalents.truncate(MOST);
    }
}

/// Kind of what follows a column without a role.
const COLUMN_DRIVER: &str = "column_driver";

/// The law of a kind by which the bias follows a column with a role.
fn law_of(kind: &str) -> Option<ResponseLaw> {
    match kind {
        "temp_linear" => Some(ResponseLaw::Linear),
        "temp_polynomial" => Some(ResponseLaw::Curve),
        "temp_rate" => Some(ResponseLaw::Rate),
        "thermal_lag" => Some(ResponseLaw::Lag),
        "temp_hysteresis" => Some(ResponseLaw::Hysteresis),
        _ => None,
    }
}

/// One-sided 95 % limit of what is proportional to a column, rms over the record, deg/h.
fn linear_limit(column: Column, problem: &Problem, best: &Tried) -> Option<f64> {
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
    let limit = rms * ((both / own).abs() + ONE_SIDED_95 / own.sqrt());
    limit.is_finite().then_some(limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thermometer_elsewhere_is_a_column_as_any_other() {
        let mut finding = Finding {
            kind: "temp_linear".to_owned(),
            effect: None,
            column: None,
            column2: None,
            law: None,
            formula: None,
            shape: None,
            equivalents: ["temp_rate", "temp_polynomial", "unobserved_driver"].map(str::to_owned).to_vec(),
            probabilities: std::collections::BTreeMap::new(),
            parameters: std::collections::BTreeMap::new(),
            places: vec![],
            delta_bic: 100.0,
            p_value: 1e-9,
            heldout_gain: None,
            removed_share: None,
        };
        let after = |finding: &Finding, name: &str| {
            let column = name.to_owned();
            let read = ReadFrom { name: Column::Temperature.name(), column, unit: "degC".to_owned() };
            let mut findings = [finding.clone()];
            as_recorded(&mut findings, &[read]);
            findings[0].clone()
        };
        for its_own in ["temp_degC", "T_housing [degC]", "Температура"] {
            assert_eq!(after(&finding, its_own), finding, "{its_own}");
        }
        let of_rack = after(&finding, "rack_degC");
        assert_eq!((of_rack.column.as_deref(), of_rack.law.as_deref()), (Some("rack_degC"), Some("linear")));
        assert_eq!(of_rack.equivalents, [COLUMN_DRIVER, "temp_rate", "temp_polynomial"]);
        finding.kind = "noise_variance_driver".to_owned();
        finding.column = Some(Column::Temperature.name().to_owned());
        let level = after(&finding, "rack_degC");
        assert_eq!((level.column.as_deref(), level.law), (Some("rack_degC"), None));
        assert_eq!(level.equivalents, finding.equivalents);
    }
}
