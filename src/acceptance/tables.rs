//! Tables of a run as far as they follow from its record, so that what was written can be checked without the recording.

use super::interval_means;
use crate::noise::family::Estimator;
use crate::output::csv_line;
use crate::record::{DeviationRecord, RunRecord, TableStepRecord};
use std::collections::BTreeMap;

/// Whether a table is the one of its record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follows {
    /// The record gives all of it, and it is the same.
    Wholly,
    /// The record gives a part of it, and that part is the same.
    Partly,
    /// It is another one.
    Not,
    /// The record gives nothing of it.
    Unknown,
}

/// Whether the table of a name is the one of a record.
pub fn follows(name: &str, text: &str, record: &RunRecord) -> Follows {
    let whole = |made: String| if made == text { Follows::Wholly } else { Follows::Not };
    match name {
        "table_steps.csv" => whole(table_steps(&record.table_steps)),
        "interval_means.csv" => whole(interval_means::csv(&record.interval_means)),
        _ => match name.strip_prefix("sigma_tau").and_then(|rest| rest.strip_suffix(".csv")) {
            Some(channel) => {
                let channel = channel.strip_prefix('_');
                let own = |d: &&DeviationRecord| channel.is_none_or(|c| d.channel == c);
                points(text, record.deviations.iter().filter(own))
            }
            None => Follows::Unknown,
        },
    }
}

/// The steps of a test on a rate table as CSV.
pub(super) fn table_steps(records: &[TableStepRecord]) -> String {
    let mut out = String::from(
        "channel,from_s,to_s,row,rate_deg_h,turns,temperature_degC,approach,cycle,output_deg_h,residual_deg_h,\
         standard_uncertainty_deg_h,residual_ppm\n",
    );
    for r in records {
        let temperature = r.temperature_deg_c.map_or_else(String::new, |t| t.to_string());
        out.push_str(&csv_line([
            r.channel.clone(),
            r.from_s.to_string(),
            r.to_s.to_string(),
            r.row.to_string(),
            r.rate_deg_h.to_string(),
            r.turns.to_string(),
            temperature,
            r.approach.to_string(),
            r.cycle.to_string(),
            r.output_deg_h.to_string(),
            r.residual_deg_h.to_string(),
            r.standard_uncertainty_deg_h.to_string(),
            r.residual_ppm.to_string(),
        ]));
    }
    out
}

/// Whether a table of the Allan family has the points that a record states.
fn points<'a>(text: &str, stated: impl Iterator<Item = &'a DeviationRecord>) -> Follows {
    let mut rows: BTreeMap<(String, u64), [Option<f64>; 3]> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields.get(i).and_then(|f| f.parse::<f64>().ok());
        let (Some(estimator), Some(tau_s)) = (fields.first(), number(1)) else { return Follows::Not };
        rows.insert(((*estimator).to_owned(), tau_s.to_bits()), [number(5), number(6), number(7)]);
    }
    let mut follows = Follows::Unknown;
    for point in stated {
        let Some(row) = rows.get(&(point.estimator.clone(), point.tau_s.to_bits())) else {
            return Follows::Not;
        };
        // The record has the total deviation without its bias, the table as it was summed; the interval is the same.
        let corrected = point.estimator == Estimator::Total.id();
        let [deviation, low, high] = *row;
        let same = deviation == Some(point.deviation_deg_h) || corrected;
        if !same || (low, high) != (point.low_deg_h, point.high_deg_h) {
            return Follows::Not;
        }
        follows = Follows::Partly;
    }
    follows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_the_points_of_its_record_to_the_bit() {
        let point = |deviation_deg_h| DeviationRecord {
            channel: "rate".into(),
            estimator: "oadev".into(),
            tau_s: 20.0,
            deviation_deg_h,
            low_deg_h: Some(0.25),
            high_deg_h: None,
            edf: 3.0,
        };
        let table = "estimator,tau_s,m,n,stride,deviation_deg_h,low_deg_h,high_deg_h,edf,noise_type\n\
            oadev,10,1,35999,1,6.4e-2,,,23999.5556,angle_random_walk\noadev,20,2,9,1,3e-1,2.5e-1,,3,none\n";
        let follows = |stated: &[DeviationRecord]| points(table, stated.iter());
        assert_eq!(follows(&[point(0.3)]), Follows::Partly);
        assert_eq!(follows(&[point(0.3f64.next_up())]), Follows::Not, "another bit");
        assert_eq!(follows(&[point(0.31)]), Follows::Not);
        assert_eq!(follows(&[DeviationRecord { tau_s: 40.0, ..point(0.3) }]), Follows::Not);
        assert_eq!(follows(&[]), Follows::Unknown);
    }
}
