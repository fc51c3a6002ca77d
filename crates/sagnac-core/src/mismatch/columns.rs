//! What became of each recorded column: it drives something that was found, it is silent, or it cannot be used and why.

use super::finding::{ColumnRecord, ColumnStatus, UnusableColumn};
use super::named::Named;
use super::problem::Problem;
use super::tried::Tried;
use crate::effect::Column;
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
    let recorded_as = |column: Column| {
        let read = read_from.iter().find(|r| r.name == column.name());
        read.map(|r| r.column.clone()).filter(|name| name != column.name())
    };
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
