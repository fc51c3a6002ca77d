//! Runs and intervals as records and as a table.

use crate::estimate::Spread;
use crate::influence::comparison::Comparison;
use crate::influence::repeatability::Repeatability;
use crate::numeric::reml::Combination;
use crate::record::IntervalMeanRecord;

/// The 95 % interval of a mean.
pub(super) fn interval(c: &Combination) -> (f64, f64) {
    let spread = Spread::StudentT { standard_uncertainty: c.standard, dof: c.dof };
    spread.interval(c.value, 0.95).map_or((f64::NAN, f64::NAN), |i| (i.low, i.high))
}

/// The runs of a channel.
pub(super) fn of_runs(found: &Repeatability) -> Vec<IntervalMeanRecord> {
    let one = |(i, r): (usize, &crate::influence::repeatability::RunMean)| IntervalMeanRecord {
        channel: found.channel.clone(),
        number: i + 1,
        name: r.name.clone(),
        from_s: r.span_s.0,
        to_s: r.span_s.1,
        row: r.row,
        level: None,
        level_unit: None,
        axis: None,
        without: None,
        temperature_deg_c: Some(r.temperature).filter(|t| t.is_finite()),
        mean_deg_h: r.bias.value,
        standard_uncertainty_deg_h: r.bias.standard,
        degrees_of_freedom: r.bias.dof,
        low_deg_h: interval(&r.bias).0,
        high_deg_h: interval(&r.bias).1,
    };
    found.runs.iter().enumerate().map(one).collect()
}

/// The intervals of a channel.
pub(super) fn of_intervals(found: &Comparison) -> Vec<IntervalMeanRecord> {
    let one = |(i, r): (usize, &crate::influence::comparison::IntervalMean)| IntervalMeanRecord {
        channel: found.channel.clone(),
        number: i + 1,
        name: r.name.clone(),
        from_s: r.span_s.0,
        to_s: r.span_s.1,
        row: r.row,
        level: Some(r.level),
        level_unit: Some(found.test.influence.unit().to_owned()),
        axis: Some(r.axis.clone()).filter(|a| !a.is_empty()),
        without: Some(r.off),
        temperature_deg_c: Some(r.temperature).filter(|t| t.is_finite()),
        mean_deg_h: r.mean.value,
        standard_uncertainty_deg_h: r.mean.standard,
        degrees_of_freedom: r.mean.dof,
        low_deg_h: interval(&r.mean).0,
        high_deg_h: interval(&r.mean).1,
    };
    found.intervals.iter().enumerate().map(one).collect()
}

/// The same as CSV.
pub(super) fn csv(records: &[IntervalMeanRecord]) -> String {
    let mut out = String::from(
        "channel,number,name,from_s,to_s,row,level,level_unit,axis,without,temperature_degC,mean_deg_h,\
         standard_uncertainty_deg_h,degrees_of_freedom,low_deg_h,high_deg_h\n",
    );
    let quoted = |text: &str| {
        if text.contains([',', '"', '\n', '\r']) {
            format!("\"{}\"", text.replace('"', "\"\""))
        } else {
            text.to_owned()
        }
    };
    for r in records {
        let number = |v: Option<f64>| v.map_or_else(String::new, |v| v.to_string());
        let fields = [
            quoted(&r.channel),
            r.number.to_string(),
            quoted(&r.name),
            r.from_s.to_string(),
            r.to_s.to_string(),
            r.row.to_string(),
            number(r.level),
            r.level_unit.clone().unwrap_or_default(),
            quoted(r.axis.as_deref().unwrap_or_default()),
            r.without.map_or_else(String::new, |w| w.to_string()),
            number(r.temperature_deg_c),
            r.mean_deg_h.to_string(),
            r.standard_uncertainty_deg_h.to_string(),
            r.degrees_of_freedom.to_string(),
            r.low_deg_h.to_string(),
            r.high_deg_h.to_string(),
        ];
        out.push_str(&fields.join(","));
        out.push('\n');
    }
    out
}
