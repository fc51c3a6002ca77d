//! σ(τ) of the units of a lot.

use super::units::TestedUnit;
use crate::lot::population::LEAST_VALUES;
use crate::lot::tolerance::{Promise, normal_factor};
use crate::numeric::order::quantile;
use crate::record::{SheetCurve, SheetPoint, SheetUnitCurve};
use rayon::prelude::*;

/// The estimator whose curves are taken.
const CURVE_ESTIMATOR: &str = "oadev";
/// Two averaging times that differ by less than this share are the same.
const MAX_TIME_DIFFERENCE: f64 = 0.01;

/// The curves of every channel that at least two units have.
pub(super) fn curves(units: &[TestedUnit], promise: Promise) -> Vec<SheetCurve> {
    let mut channels: Vec<&str> = vec![];
    for d in units.iter().flat_map(|u| &u.result.deviations) {
        if !channels.contains(&d.channel.as_str()) {
            channels.push(&d.channel);
        }
    }
    channels.into_iter().filter_map(|channel| curve(channel, units, promise)).collect()
}

fn curve(channel: &str, units: &[TestedUnit], promise: Promise) -> Option<SheetCurve> {
    let curves: Vec<SheetUnitCurve> = units
        .iter()
        .map(|u| SheetUnitCurve {
            serial: u.serial.clone(),
            points: u
                .result
                .deviations
                .iter()
                .filter(|d| d.channel == channel && d.estimator == CURVE_ESTIMATOR)
                .filter(|d| d.deviation_deg_h > 0.0 && d.deviation_deg_h.is_finite())
                .map(|d| [d.tau_s, d.deviation_deg_h])
                .collect(),
        })
        .filter(|c| !c.points.is_empty())
        .collect();
    let mut times: Vec<f64> = curves.iter().flat_map(|c| c.points.iter().map(|[tau, _]| *tau)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup_by(|b, a| *b - *a <= MAX_TIME_DIFFERENCE * *a);
    let points: Vec<Option<SheetPoint>> =
        times.into_par_iter().map(|tau| point(tau, &curves, promise)).collect();
    let points: Vec<SheetPoint> = points.into_iter().flatten().collect();
    (curves.len() > 1 && !points.is_empty()).then(|| SheetCurve {
        channel: channel.to_owned(),
        points,
        units: curves,
    })
}

/// The units at one averaging time; `None` where fewer than two have it.
fn point(tau_s: f64, curves: &[SheetUnitCurve], promise: Promise) -> Option<SheetPoint> {
    let at = |c: &SheetUnitCurve| {
        c.points
            .iter()
            .find(|[tau, _]| (tau - tau_s).abs() <= MAX_TIME_DIFFERENCE * tau_s)
            .map(|[_, deviation]| *deviation)
    };
    let mut all: Vec<f64> = curves.iter().filter_map(at).collect();
    all.sort_by(f64::total_cmp);
    let median = quantile(&all, 0.5)?;
    let (low, high) = (quantile(&all, 0.16)?, quantile(&all, 0.84)?);
    let bound = bound(&all, promise);
    (all.len() > 1).then_some(SheetPoint { tau_s, units: all.len(), median, low, high, bound })
}

/// The bound for measured values, of a normal sample of their logarithms; `None` of few units.
fn bound(values: &[f64], promise: Promise) -> Option<f64> {
    let logs: Vec<f64> = values.iter().filter(|v| **v > 0.0).map(|v| v.ln()).collect();
    let n = logs.len() as f64;
    let factor = (logs.len() >= LEAST_VALUES).then(|| normal_factor(n, n - 1.0, promise)).flatten()?;
    let mean = logs.iter().sum::<f64>() / n;
    let variance = logs.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    Some((mean + factor * variance.sqrt()).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_at_a_time_is_the_tolerance_bound_of_the_logarithms() {
        let promise = Promise { proportion: 0.95, confidence: 0.95 };
        // Ten logarithms of mean 0 and deviation 1; the factor of ten units is 2.91096.
        let raw: Vec<f64> = (0..10).map(|i| f64::from(i) - 4.5).collect();
        let scale = (raw.iter().map(|v| v * v).sum::<f64>() / 9.0).sqrt();
        let values: Vec<f64> = raw.iter().map(|v| (v / scale).exp()).collect();
        let found = bound(&values, promise).map(f64::ln);
        assert!(found.is_some_and(|b| (b - 2.910_96).abs() < 1e-4), "{found:?}");
        assert_eq!(bound(&values[..4], promise), None);
    }
}
