//! `comparison.csv`: one row a unit, plain numbers, empty where there is none.

use super::published::Checked;
use super::{Comparison, ReadOutRule, Unit};
use crate::measurand;
use crate::output::csv_line;

/// Columns of a comparison of units.
const UNIT_COLUMNS: &str = "unit,channel,path,length_s,n_100s,detrend,sigma100_deg_h,sigma100_low,sigma100_high,\
sigma100_3sigma_deg_h,minimum_deg_h,minimum_low,minimum_high,minimum_tau_s,largest_tau_s,minimum_scaled_deg_h,\
b_deg_h,b_low,b_high,b_upper_limit,floor_deg_h,ratio_minimum,ratio_minimum_low,ratio_minimum_high,\
ratio_minimum_inverse,ratio_b,null_05,null_50,null_95,sigma10_deg_h,n_10s,arw10_deg_rt_h,arw10_low,arw10_high,\
n_deg_rt_h,n_low,n_high,ratio_arw,ratio_arw_low,ratio_arw_high,predicted_deg_h,predicted_low,predicted_high,\
observed_over_predicted,observed_over_predicted_low,observed_over_predicted_high,agreement,largest_part,\
largest_share,crossover_s,identifiable_h\n";

fn number(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map(|v| format!("{v:e}")).unwrap_or_default()
}

/// The table of a comparison.
pub fn of(comparison: &Comparison) -> String {
    match &comparison.published {
        Some(checked) => published(checked),
        None => units(&comparison.units),
    }
}

/// The table of units.
fn units(units: &[Unit]) -> String {
    let mut out = UNIT_COLUMNS.to_owned();
    for unit in units {
        let value = |id: &str| number(unit.value(id));
        let low = |id: &str| number(unit.quantity(id).and_then(|q| Some(q.interval?.low)));
        let high = |id: &str| number(unit.quantity(id).and_then(|q| Some(q.interval?.high)));
        let detail = unit.detail.as_ref();
        let minimum = detail.and_then(|d| d.minimum.as_ref());
        let window = |s: f64| detail.and_then(|d| d.windows.iter().find(|w| w.window_s == s));
        let (w100, w10) = (window(100.0), window(10.0));
        let rule = |r: ReadOutRule| unit.rules.iter().find(|row| row.rule == r);
        let null = |i: usize| number(minimum.and_then(|m| m.null_ratio?.get(i).copied()));
        let count = |n: Option<u64>| n.map(|n| n.to_string()).unwrap_or_default();
        let share = w100.and_then(|w| w.shares.first());
        let b = unit.quantity(measurand::BIAS_INSTABILITY.id);
        let floor = detail.and_then(|d| d.floor.as_ref());
        let row = [
            unit.name.clone(),
            unit.channel.clone(),
            unit.path.clone(),
            number(unit.length_s),
            count(w100.map(|w| w.n)),
            detail.map(|d| d.detrend.clone()).unwrap_or_default(),
            value(measurand::RUSSIAN_DRIFT_100S.id),
            low(measurand::RUSSIAN_DRIFT_100S.id),
            high(measurand::RUSSIAN_DRIFT_100S.id),
            value(measurand::RUSSIAN_DRIFT_100S_3SIGMA.id),
            value(measurand::BIAS_INSTABILITY_MINIMUM.id),
            low(measurand::BIAS_INSTABILITY_MINIMUM.id),
            high(measurand::BIAS_INSTABILITY_MINIMUM.id),
            number(minimum.map(|m| m.tau_s)),
            number(minimum.map(|m| m.largest_tau_s)),
            value(measurand::BIAS_INSTABILITY_MINIMUM_SCALED.id),
            value(measurand::BIAS_INSTABILITY.id),
            low(measurand::BIAS_INSTABILITY.id),
            high(measurand::BIAS_INSTABILITY.id),
            number(b.filter(|b| b.value.is_none()).and_then(|b| Some(b.upper_limit?.value))),
            number(rule(ReadOutRule::FittedFloor).and_then(|r| r.value)),
            number(rule(ReadOutRule::Minimum).and_then(|r| r.ratio)),
            number(rule(ReadOutRule::Minimum).and_then(|r| Some(r.ratio_interval?.low))),
            number(rule(ReadOutRule::Minimum).and_then(|r| Some(r.ratio_interval?.high))),
            number(rule(ReadOutRule::Minimum).and_then(|r| r.inverse)),
            number(rule(ReadOutRule::FittedB).filter(|r| r.value.is_some()).and_then(|r| r.ratio)),
            null(0),
            null(1),
            null(2),
            value(measurand::RUSSIAN_SIGMA_10S.id),
            count(w10.map(|w| w.n)),
            value(measurand::RUSSIAN_ARW_10S.id),
            low(measurand::RUSSIAN_ARW_10S.id),
            high(measurand::RUSSIAN_ARW_10S.id),
            value(measurand::ANGLE_RANDOM_WALK.id),
            low(measurand::ANGLE_RANDOM_WALK.id),
            high(measurand::ANGLE_RANDOM_WALK.id),
            value(measurand::RATIO_RUSSIAN_TO_ALLAN_ARW.id),
            low(measurand::RATIO_RUSSIAN_TO_ALLAN_ARW.id),
            high(measurand::RATIO_RUSSIAN_TO_ALLAN_ARW.id),
            number(w100.and_then(|w| w.predicted)),
            number(w100.and_then(|w| Some(w.predicted_interval?.low))),
            number(w100.and_then(|w| Some(w.predicted_interval?.high))),
            number(w100.and_then(|w| w.ratio)),
            number(w100.and_then(|w| Some(w.ratio_interval?.low))),
            number(w100.and_then(|w| Some(w.ratio_interval?.high))),
            w100.and_then(|w| w.agreement).map_or_else(String::new, |a| a.id().to_owned()),
            share.map(|s| s.part.clone()).unwrap_or_default(),
            number(share.map(|s| s.share)),
            number(floor.map(|f| f.crossover_s)),
            number(floor.and_then(|f| f.identifiable_h)),
        ];
        out.push_str(&csv_line(&row));
    }
    out
}

/// The published tables with what was computed from each row.
fn published(checked: &Checked) -> String {
    let mut out = String::from(
        "device,sigma100_deg_h,bias_instability_deg_h,ratio_printed,ratio_computed,arw_russian_deg_rt_h,\
n_deg_rt_h,arw_ratio_printed,arw_ratio_computed,six_n_deg_h,sigma100_over_six_n,crossover_h,sigma10_over_sigma100,\
n_table1_deg_rt_h,remarks\n",
    );
    for row in &checked.rows {
        let ids: Vec<&str> = row.remarks.iter().map(|r| r.id.as_ref()).collect();
        let fields = [
            row.device.clone(),
            number(Some(row.sigma100)),
            number(Some(row.bias_instability)),
            number(Some(row.ratio_printed)),
            number(Some(row.ratio)),
            number(Some(row.arw_russian)),
            number(Some(row.n)),
            number(Some(row.arw_ratio_printed)),
            number(Some(row.arw_ratio)),
            number(Some(row.six_n)),
            number(Some(row.over_six_n)),
            number(Some(row.crossover_h)),
            number(Some(row.sigma10_over_sigma100)),
            number(row.n_table1),
            ids.join(";"),
        ];
        out.push_str(&csv_line(&fields));
    }
    out
}
