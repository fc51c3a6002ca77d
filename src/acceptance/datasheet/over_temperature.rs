//! Bias over temperature of the units of a lot, from the compensation tables beside their results.

use super::compensation_table::Table;
use super::units::TestedUnit;
use crate::lot::population::LEAST_VALUES;
use crate::lot::tolerance::{Promise, normal_factor};
use crate::numeric::order::quantile;
use crate::record::{SheetTemperatureCurve, SheetTemperaturePoint, SheetUnitCurve};

/// Number of temperatures at which the lot is evaluated.
const TEMPERATURE_POINTS: usize = 25;

/// The curves of every channel that at least two units have over a common range.
pub(super) fn curves(units: &[TestedUnit], promise: Promise) -> Vec<SheetTemperatureCurve> {
    let mut channels: Vec<&str> = vec![];
    for table in units.iter().flat_map(|u| &u.tables) {
        if !channels.contains(&table.channel.as_str()) {
            channels.push(&table.channel);
        }
    }
    let of = |channel: &str| {
        let own = |u: &TestedUnit| {
            u.tables.iter().find(|t| t.channel == channel).map(|t| (u.serial.clone(), t.clone()))
        };
        curve(channel, &units.iter().filter_map(own).collect::<Vec<_>>(), promise)
    };
    channels.into_iter().filter_map(of).collect()
}

/// Each unit less its own mean over the common range: what the bias is at one temperature is another quantity of the sheet.
fn curve(channel: &str, tables: &[(String, Table)], promise: Promise) -> Option<SheetTemperatureCurve> {
    let low = tables.iter().map(|(_, t)| t.ends().0).fold(f64::NEG_INFINITY, f64::max);
    let high = tables.iter().map(|(_, t)| t.ends().1).fold(f64::INFINITY, f64::min);
    if tables.len() < 2 || low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
        return None;
    }
    let grid: Vec<f64> = (0..TEMPERATURE_POINTS)
        .map(|i| low + (high - low) * i as f64 / (TEMPERATURE_POINTS - 1) as f64)
        .collect();
    let of_unit = |(serial, table): &(String, Table)| {
        let values: Vec<f64> = grid.iter().map(|t| table.at(*t)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let points = grid.iter().zip(&values).map(|(t, v)| [*t, v - mean]).collect();
        SheetUnitCurve { serial: serial.clone(), points }
    };
    let units: Vec<SheetUnitCurve> = tables.iter().map(of_unit).collect();
    let points = (0..TEMPERATURE_POINTS).filter_map(|i| point(&units, i, promise)).collect();
    Some(SheetTemperatureCurve { channel: channel.to_owned(), points, units })
}

fn point(units: &[SheetUnitCurve], place: usize, promise: Promise) -> Option<SheetTemperaturePoint> {
    let here: Vec<[f64; 2]> = units.iter().filter_map(|u| u.points.get(place).copied()).collect();
    let temperature_deg_c = here.first()?[0];
    let mut values: Vec<f64> = here.iter().map(|[_, v]| *v).collect();
    values.sort_by(f64::total_cmp);
    Some(SheetTemperaturePoint {
        temperature_deg_c,
        median: quantile(&values, 0.5)?,
        low: quantile(&values, 0.16)?,
        high: quantile(&values, 0.84)?,
        band: band(&values, promise),
    })
}

/// The tolerance band of a normal sample: one bound on each side, each with half of what may lie outside and half of the doubt.
fn band(values: &[f64], promise: Promise) -> Option<[f64; 2]> {
    let n = values.len() as f64;
    let side = Promise {
        proportion: 0.5 * (1.0 + promise.proportion),
        confidence: 0.5 * (1.0 + promise.confidence),
    };
    let factor = (values.len() >= LEAST_VALUES).then(|| normal_factor(n, n - 1.0, side)).flatten()?;
    let mean = values.iter().sum::<f64>() / n;
    let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    Some([mean - factor * deviation, mean + factor * deviation])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(from: f64, to: f64, bias: impl Fn(f64) -> f64) -> Table {
        let at: Vec<f64> = (0..25).map(|i| from + (to - from) * f64::from(i) / 24.0).collect();
        let biases: Vec<f64> = at.iter().map(|t| bias(*t)).collect();
        let text = serde_json::json!({"channel": "rate", "temperature_deg_c": at, "bias_deg_h": biases});
        serde_json::from_value(text).unwrap()
    }

    #[test]
    fn units_are_told_over_their_common_range_and_about_their_own_means() {
        let tables = [
            ("A".to_owned(), table(-10.0, 50.0, |t| 5.0 + 0.1 * t)),
            ("B".to_owned(), table(0.0, 60.0, |t| -7.0 + 0.3 * t)),
        ];
        let curve = curve("rate", &tables, Promise { proportion: 0.95, confidence: 0.95 }).unwrap();
        let ends =
            (curve.points[0].temperature_deg_c, curve.points[TEMPERATURE_POINTS - 1].temperature_deg_c);
        assert_eq!(ends, (0.0, 50.0));
        for (unit, slope) in curve.units.iter().zip([0.1, 0.3]) {
            assert!(unit.points.iter().all(|[t, v]| (v - slope * (t - 25.0)).abs() < 1e-9), "{unit:?}");
        }
        // The median of two is between them; two are too few for a band.
        assert!((curve.points[0].median + 0.2 * 25.0).abs() < 1e-9);
        assert_eq!(curve.points[0].band, None);
        let apart = [("A".to_owned(), table(-10.0, 0.0, |t| t)), ("B".to_owned(), table(1.0, 60.0, |t| t))];
        assert!(super::curve("rate", &apart, Promise { proportion: 0.95, confidence: 0.95 }).is_none());
    }

    #[test]
    fn the_band_holds_ten_normal_units_on_both_sides() {
        let raw: Vec<f64> = (0..10).map(|i| f64::from(i) - 4.5).collect();
        let scale = (raw.iter().map(|v| v * v).sum::<f64>() / 9.0).sqrt();
        let values: Vec<f64> = raw.iter().map(|v| v / scale).collect();
        let [low, high] = band(&values, Promise { proportion: 0.95, confidence: 0.95 }).unwrap();
        // One-sided 97.5/97.5 % of ten units: noncentral t of 9 degrees of freedom.
        assert!((low + high).abs() < 1e-9 && high > 3.379 && high < 4.1, "{high}");
    }
}
