//! The inferred course against what was concealed.

use super::rows::Prepared;
use crate::record::CourseRecord;
use crate::report::ExplanationResults;
use crate::series::Series;

/// Most points of a course in a comparison over lags.
const MOST_POINTS: usize = 4096;

/// Longest lag that is tried, as a share of the recording.
const LONGEST_LAG: f64 = 0.1;

/// The course that the engine inferred, deg/h, a value a row; `None` where it inferred none.
pub(super) fn course(said: &ExplanationResults, shown: &Series) -> Option<Vec<f64>> {
    let (_, text) = said.tables.iter().find(|(name, _)| name == "correction.csv")?;
    let points: Vec<(f64, f64)> = text
        .lines()
        .skip(1)
        .filter_map(|l| l.split_once(','))
        .filter_map(|(t, v)| Some((t.parse().ok()?, v.parse().ok()?)))
        .collect();
    (!points.is_empty()).then(|| shown.time_s.iter().map(|t| at(&points, *t)).collect())
}

/// A value between points, on straight lines; the first or last one outside of them.
fn at(points: &[(f64, f64)], time: f64) -> f64 {
    let after = points.partition_point(|p| p.0 < time);
    match (after.checked_sub(1).and_then(|i| points.get(i)), points.get(after)) {
        (Some(&(t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
        (Some(&(_, v)), None) | (None, Some(&(_, v))) => v,
        (None, None) => 0.0,
    }
}

/// The course against every column that was concealed, and against what was added.
pub(super) fn courses(course: Option<&[f64]>, prepared: &Prepared) -> Vec<CourseRecord> {
    let Some(course) = course else { return vec![] };
    let interval_s = prepared.shown.sample_interval_s;
    let columns = prepared.hidden.iter().map(|(name, values)| (name.clone(), values.as_slice(), None));
    let added = prepared
        .added
        .iter()
        .map(|a| (a.kinds.join(", "), a.course.as_slice(), Some(recovered(course, &a.course))));
    let one = |(name, values, recovered_share): (String, &[f64], Option<f64>)| {
        let (lag_s, correlation_at_lag) = best_lag(course, values, interval_s);
        let correlation = correlation(course, values);
        CourseRecord { name, correlation, lag_s, correlation_at_lag, recovered_share }
    };
    columns.chain(added).map(one).collect()
}

/// Correlation of two series of equal length; 0 where one does not change.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len()) as f64;
    let (mean_a, mean_b) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let (x, y) = (x - mean_a, y - mean_b);
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

/// The lag at which the correlation is largest by size, s, and that correlation. A positive lag: `course` comes later.
fn best_lag(course: &[f64], hidden: &[f64], interval_s: f64) -> (f64, f64) {
    let group = course.len().div_ceil(MOST_POINTS).max(1);
    let means = |values: &[f64]| -> Vec<f64> {
        values.chunks(group).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect()
    };
    let (a, b) = (means(course), means(hidden));
    let longest = (LONGEST_LAG * a.len() as f64) as isize;
    let mut best = (0.0, correlation(&a, &b));
    for lag in -longest..=longest {
        let skip = lag.unsigned_abs();
        let (late, early) = if lag >= 0 { (&a, &b) } else { (&b, &a) };
        let r = correlation(late.get(skip..).unwrap_or_default(), early);
        if r.abs() > best.1.abs() {
            best = (lag as f64 * group as f64 * interval_s, r);
        }
    }
    best
}

/// The share of the mean square of `added` that is in `course`, means apart; below zero where the course is worse than none.
fn recovered(course: &[f64], added: &[f64]) -> f64 {
    let n = added.len() as f64;
    let square = |values: &mut dyn Iterator<Item = f64>| {
        let values: Vec<f64> = values.collect();
        let mean = values.iter().sum::<f64>() / n;
        values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>()
    };
    let whole = square(&mut added.iter().copied());
    let left = square(&mut added.iter().zip(course).map(|(a, c)| a - c));
    if whole > 0.0 { 1.0 - left / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(later: f64) -> Vec<f64> {
        (0..2000).map(|i| ((f64::from(i) - later) * 0.02).sin()).collect()
    }

    #[test]
    fn points_are_joined_by_straight_lines() {
        let points = [(1.0, 10.0), (3.0, 20.0)];
        assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|t| at(&points, t)), [10.0, 10.0, 15.0, 20.0, 20.0]);
    }

    #[test]
    fn a_later_course_has_a_positive_lag() {
        let (lag, r) = best_lag(&wave(30.0), &wave(0.0), 0.5);
        assert!((lag - 15.0).abs() < 0.51 && r > 0.999, "{lag} {r}");
        let (lag, _) = best_lag(&wave(0.0), &wave(30.0), 0.5);
        assert!((lag + 15.0).abs() < 0.51, "{lag}");
        assert_eq!(correlation(&[1.0, 1.0], &[1.0, 2.0]), 0.0);
    }

    #[test]
    fn what_is_recovered_is_a_share_of_the_mean_square() {
        let added = wave(0.0);
        let half: Vec<f64> = added.iter().map(|v| 0.5 * v + 7.0).collect();
        assert!((recovered(&half, &added) - 0.75).abs() < 1e-12);
        assert!((recovered(&added, &added) - 1.0).abs() < 1e-12);
        let against: Vec<f64> = added.iter().map(|v| -v).collect();
        assert!((recovered(&against, &added) + 3.0).abs() < 1e-12);
    }
}
