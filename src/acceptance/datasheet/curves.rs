//! σ(τ) of the units of a lot.

use super::units::TestedUnit;
use crate::numeric::order::quantile;
use crate::record::{SheetCurve, SheetPoint, SheetUnitCurve};

/// The estimator whose curves are taken.
const ESTIMATOR: &str = "oadev";
/// Two averaging times that differ by less than this share are the same.
const SAME: f64 = 0.01;

/// The curves of every channel that at least two units have.
pub(super) fn curves(units: &[TestedUnit]) -> Vec<SheetCurve> {
    let mut channels: Vec<&str> = vec![];
    for d in units.iter().flat_map(|u| &u.input.deviations) {
        if !channels.contains(&d.channel.as_str()) {
            channels.push(&d.channel);
        }
    }
    channels.into_iter().filter_map(|channel| curve(channel, units)).collect()
}

fn curve(channel: &str, units: &[TestedUnit]) -> Option<SheetCurve> {
    let curves: Vec<SheetUnitCurve> = units
        .iter()
        .map(|u| SheetUnitCurve {
            serial: u.serial.clone(),
            points: u
                .input
                .deviations
                .iter()
                .filter(|d| d.channel == channel && d.estimator == ESTIMATOR)
                .filter(|d| d.deviation_deg_h > 0.0 && d.deviation_deg_h.is_finite())
                .map(|d| [d.tau_s, d.deviation_deg_h])
                .collect(),
        })
        .filter(|c| !c.points.is_empty())
        .collect();
    let mut times: Vec<f64> = curves.iter().flat_map(|c| c.points.iter().map(|[tau, _]| *tau)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup_by(|b, a| *b - *a <= SAME * *a);
    let points: Vec<SheetPoint> = times.into_iter().filter_map(|tau| point(tau, &curves)).collect();
    (curves.len() > 1 && !points.is_empty()).then(|| SheetCurve {
        channel: channel.to_owned(),
        points,
        units: curves,
    })
}

/// The units at one averaging time; `None` where fewer than two have it.
fn point(tau_s: f64, curves: &[SheetUnitCurve]) -> Option<SheetPoint> {
    let at = |c: &SheetUnitCurve| {
        c.points.iter().find(|[tau, _]| (tau - tau_s).abs() <= SAME * tau_s).map(|[_, deviation]| *deviation)
    };
    let mut all: Vec<f64> = curves.iter().filter_map(at).collect();
    all.sort_by(f64::total_cmp);
    let median = quantile(&all, 0.5)?;
    let (low, high) = (quantile(&all, 0.16)?, quantile(&all, 0.84)?);
    (all.len() > 1).then_some(SheetPoint { tau_s, units: all.len(), median, low, high })
}
