//! The means of runs and intervals as records and as a table.

use super::request::Table;
use crate::estimate::{Interval, Spread};
use crate::influence::comparison::{Comparison, IntervalMean};
use crate::influence::repeatability::{Repeatability, RunMean};
use crate::numeric::reml::Combination;
use crate::output::csv_line;
use crate::record::{Evidence, IntervalMeanRecord, RunRecord};

/// The 95 % interval of a mean; its ends are no numbers where the spread has none.
pub(super) fn interval95(c: &Combination) -> Interval {
    let spread = Spread::StudentT { standard_uncertainty: c.standard, dof: c.dof };
    spread.interval(c.value, 0.95).unwrap_or(Interval { low: f64::NAN, high: f64::NAN, coverage: 0.95 })
}

/// Columns that every mean has, of a channel and by its number from 0.
fn record(channel: &str, i: usize, mean: &Combination, temperature_deg_c: f64) -> IntervalMeanRecord {
    let interval = interval95(mean);
    IntervalMeanRecord {
        channel: channel.to_owned(),
        number: i + 1,
        temperature_deg_c: Some(temperature_deg_c).filter(|t| t.is_finite()),
        mean_deg_h: mean.value,
        standard_uncertainty_deg_h: mean.standard,
        degrees_of_freedom: mean.dof,
        low_deg_h: interval.low,
        high_deg_h: interval.high,
        ..IntervalMeanRecord::default()
    }
}

/// The runs of a channel.
pub(super) fn of_runs(found: &Repeatability) -> Vec<IntervalMeanRecord> {
    let one = |(i, r): (usize, &RunMean)| IntervalMeanRecord {
        name: r.name.clone(),
        from_s: r.span_s.0,
        to_s: r.span_s.1,
        row: r.row,
        ..record(&found.channel, i, &r.bias, r.temperature)
    };
    found.runs.iter().enumerate().map(one).collect()
}

/// The intervals of a channel.
pub(super) fn of_intervals(found: &Comparison, evidence: Evidence) -> Vec<IntervalMeanRecord> {
    let one = |(i, r): (usize, &IntervalMean)| IntervalMeanRecord {
        name: r.name.clone(),
        from_s: r.span_s.0,
        to_s: r.span_s.1,
        row: r.row,
        level: Some(r.level),
        evidence: Some(evidence),
        level_unit: Some(found.test.setting.level_unit().to_owned()),
        axis: Some(r.axis.clone()).filter(|a| !a.is_empty()),
        without: Some(r.off),
        ..record(&found.channel, i, &r.mean, r.temperature)
    };
    found.intervals.iter().enumerate().map(one).collect()
}

/// Adds the means to the record; gives the table beside it.
pub(super) fn complete(record: &mut RunRecord, means: Vec<IntervalMeanRecord>) -> Vec<Table> {
    record.interval_means = means;
    vec![("interval_means.csv".to_owned(), csv(&record.interval_means))]
}

/// The same as CSV.
pub(super) fn csv(records: &[IntervalMeanRecord]) -> String {
    let mut out = String::from(
        "channel,number,name,from_s,to_s,row,level,evidence,level_unit,axis,without,temperature_degC,mean_deg_h,\
         standard_uncertainty_deg_h,degrees_of_freedom,low_deg_h,high_deg_h\n",
    );
    for r in records {
        let number = |v: Option<f64>| v.map_or_else(String::new, |v| v.to_string());
        let fields = [
            r.channel.clone(),
            r.number.to_string(),
            r.name.clone(),
            r.from_s.to_string(),
            r.to_s.to_string(),
            r.row.to_string(),
            number(r.level),
            r.evidence.map_or_else(String::new, |e| e.id().to_owned()),
            r.level_unit.clone().unwrap_or_default(),
            r.axis.clone().unwrap_or_default(),
            r.without.map_or_else(String::new, |w| w.to_string()),
            number(r.temperature_deg_c),
            r.mean_deg_h.to_string(),
            r.standard_uncertainty_deg_h.to_string(),
            r.degrees_of_freedom.to_string(),
            r.low_deg_h.to_string(),
            r.high_deg_h.to_string(),
        ];
        out.push_str(&csv_line(&fields));
    }
    out
}
