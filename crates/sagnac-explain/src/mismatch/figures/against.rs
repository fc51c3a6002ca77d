//! The residual against a column, before and after.

use super::join::by_abscissa;
use super::{axis, line, shaded};
use crate::effect::{Domain, Place};
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::figure::{Figure, Layer, Panel, Scale, Style};

/// Points of each curve.
const CURVE_POINTS: usize = 60;
/// Curves against a column.
#[derive(Debug, Clone, Copy)]
pub struct Against<'a> {
    /// The view: temperature, its rate, input rate, outer rate, angle or supply.
    pub domain: Domain,
    /// The column, in the unit of the domain.
    pub column: &'a [f64],
    /// Recording less the mean of the claim, deg/h.
    pub before: &'a [f64],
    /// The same less the contribution, deg/h. `None` where nothing was added.
    pub after: Option<&'a [f64]>,
    /// Fitted contribution, deg/h.
    pub contribution: Option<&'a [f64]>,
    /// Interval in which the mismatch was located.
    pub places: &'a [Place],
}

/// Label of the abscissa and its unit.
fn labels(domain: Domain) -> Option<(&'static str, &'static str)> {
    Some(match domain {
        Domain::Temperature => ("axis.temperature", "degC"),
        Domain::TemperatureRate => ("figure.explain.temperature_rate", "degC/min"),
        Domain::InputRate => ("figure.explain.input_rate", "deg/s"),
        Domain::OuterRate => ("figure.explain.outer_rate", "deg/s"),
        Domain::Angle => ("figure.explain.angle", "deg"),
        Domain::Supply => ("axis.supply", "V"),
        _ => return None,
    })
}

/// Draws means of the residual over groups of the column with the 95 % band of their scatter. `None` for a domain that is
/// no column.
pub fn against(a: &Against<'_>) -> Option<Figure> {
    let (label, unit) = labels(a.domain)?;
    let curve = |series: &[f64], style: Style, legend: &str, banded: bool| {
        let means = by_abscissa(a.column, series, CURVE_POINTS);
        let band = means
            .iter()
            .map(|m| (m.x, m.y - SCORE_TWO_SIDED_95 * m.spread, m.y + SCORE_TWO_SIDED_95 * m.spread));
        let points: Vec<(f64, f64)> = means.iter().map(|m| (m.x, m.y)).collect();
        let mut layers = vec![];
        if banded {
            layers.push(Layer::Band { points: band.collect(), style, legend: String::new() });
            layers.push(Layer::Points { points: points.clone(), style, legend: legend.into() });
        }
        layers.push(line(points, style, legend));
        layers
    };
    let finite = a.column.iter().copied().filter(|v| v.is_finite());
    let ends = finite.fold(None, |ends: Option<(f64, f64)>, v| {
        Some(ends.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    });
    let mut layers: Vec<Layer> = shaded(a.places, &[a.domain], ends, Scale::Linear).collect();
    layers.extend(curve(a.before, Style::Data, "figure.explain.before", true));
    if let Some(after) = a.after {
        layers.extend(curve(after, Style::SecondData, "figure.explain.after", true));
    }
    if let Some(contribution) = a.contribution {
        layers.extend(curve(contribution, Style::Model, "figure.explain.contribution", false));
    }
    Some(Figure {
        id: format!("residual_against_{}", a.domain.id()),
        title: "figure.explain.title_against".into(),
        channel: String::new(),
        panels: vec![Panel {
            x: axis(label, unit, Scale::Linear),
            y: axis("figure.explain.residual", "deg/h", Scale::Linear),
            layers,
        }],
        remarks: vec!["figure.explain.means".into()],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_against_temperature_stays_one() {
        let temperature: Vec<f64> = (0..6000).map(|i| 20.0 + 10.0 * (f64::from(i) * 0.01).sin()).collect();
        let before: Vec<f64> = temperature.iter().map(|t| 0.5 * (t - 20.0)).collect();
        let after = vec![0.0; 6000];
        let drawn = |domain| {
            against(&Against {
                domain,
                column: &temperature,
                before: &before,
                after: Some(&after),
                contribution: None,
                places: &[],
            })
        };
        assert!(drawn(Domain::Frequency).is_none());
        let figure = drawn(Domain::Temperature).unwrap();
        let lines: Vec<&Vec<(f64, f64)>> = figure.panels[0]
            .layers
            .iter()
            .filter_map(|l| if let Layer::Line { points, .. } = l { Some(points) } else { None })
            .collect();
        assert_eq!((lines.len(), lines[0].len()), (2, CURVE_POINTS));
        assert!(lines[0].iter().all(|(t, r)| (r - 0.5 * (t - 20.0)).abs() < 1e-9));
        assert!(lines[1].iter().all(|p| p.1 == 0.0));
    }
}
