//! The residual over time, before and after.

use super::join::{MAX_TIME_POINTS, over_time};
use super::{axis, line, shaded};
use crate::effect::{Domain, Place};
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::message::note;

/// Curves over time.
#[derive(Debug, Clone, Copy)]
pub struct TimeSeries<'a> {
    /// `time_s`, s.
    pub time_s: &'a [f64],
    /// Recording less the mean of the claim, deg/h.
    pub before: &'a [f64],
    /// The same less the contribution, deg/h. `None` where nothing was added.
    pub after: Option<&'a [f64]>,
    /// Fitted contribution, deg/h.
    pub contribution: Option<&'a [f64]>,
    /// Interval in which the mismatch was located.
    pub places: &'a [Place],
}

/// Draws the residual with the contribution, and under it what is left.
pub fn time_course(course: &TimeSeries<'_>) -> Figure {
    let (before, group) = over_time(course.time_s, course.before);
    let ends = course.time_s.first().copied().zip(course.time_s.last().copied());
    let span = |domains: &'static [Domain]| {
        shaded(course.places, domains, ends, Scale::Linear).collect::<Vec<Layer>>()
    };
    let mut upper = span(&[Domain::Time, Domain::Timestamps]);
    upper.push(line(before, Style::Data, "figure.explain.before"));
    if let Some(contribution) = course.contribution {
        let fitted = over_time(course.time_s, contribution).0;
        upper.push(line(fitted, Style::Model, "figure.explain.contribution"));
    }
    let mut panels = vec![panel(upper)];
    if let Some(after) = course.after {
        let mut lower = span(&[Domain::Time, Domain::Timestamps]);
        lower.push(line(over_time(course.time_s, after).0, Style::SecondData, "figure.explain.after"));
        panels.push(panel(lower));
    }
    let mut remarks = vec![];
    if group > 1
        && let [first, .., last] = course.time_s
    {
        let step = (last - first) / (course.time_s.len() - 1) as f64;
        remarks.push(note!("figure.explain.averaged", seconds = step * group as f64));
    }
    Figure {
        id: "residual_over_time".into(),
        title: "figure.explain.title_time".into(),
        channel: String::new(),
        panels,
        remarks,
    }
}

fn panel(layers: Vec<Layer>) -> Panel {
    Panel {
        x: axis("axis.time", "s", Scale::Linear),
        y: axis("figure.explain.residual", "deg/h", Scale::Linear),
        layers,
    }
}

/// Draws the level of the whitened residual over time, before and after, with the band in which that of a correct claim
/// stays in 95 of 100 intervals. `level_*` hold (middle of the interval s, mean square); `values` is how many
/// independent values each averages.
pub fn local_level(
    before: &[(f64, f64)],
    after: Option<&[(f64, f64)]>,
    values: f64,
    places: &[Place],
) -> Figure {
    let ends = before.first().zip(before.last()).map(|(a, b)| (a.0, b.0));
    let mut layers: Vec<Layer> = shaded(places, &[Domain::Time], ends, Scale::Linear).collect();
    if let Some((from, to)) = ends
        && values >= 1.0
    {
        let at = |p: f64| crate::estimate::chi_square_quantile(p, values) / values;
        let (low, high) = (at(0.025), at(0.975));
        layers.push(Layer::Band {
            points: vec![(from, low, high), (to, low, high)],
            style: Style::Muted,
            legend: "figure.explain.band".into(),
        });
    }
    layers.push(Layer::Horizontal { at: 1.0, style: Style::Model, legend: String::new() });
    let thin = |points: &[(f64, f64)]| {
        let step = points.len().div_ceil(MAX_TIME_POINTS).max(1);
        points.iter().step_by(step).copied().collect::<Vec<_>>()
    };
    layers.push(line(thin(before), Style::Data, "figure.explain.before"));
    if let Some(after) = after {
        layers.push(line(thin(after), Style::SecondData, "figure.explain.after"));
    }
    Figure {
        id: "level_over_time".into(),
        title: "figure.explain.title_level".into(),
        channel: String::new(),
        panels: vec![Panel {
            x: axis("axis.time", "s", Scale::Linear),
            y: axis("figure.explain.level", "", Scale::Log),
            layers,
        }],
        remarks: vec!["figure.explain.whitened".into()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(layer: &Layer) -> &[(f64, f64)] {
        match layer {
            Layer::Line { points, .. } => points,
            _ => &[],
        }
    }

    #[test]
    fn the_residual_and_the_contribution_stand_above_what_is_left() {
        let time: Vec<f64> = (0..5000).map(|i| f64::from(i) * 0.1).collect();
        let step: Vec<f64> = time.iter().map(|t| if *t < 250.0 { 0.0 } else { 2.0 }).collect();
        let before: Vec<f64> = step.iter().map(|s| s + 1.0).collect();
        let after = vec![1.0; 5000];
        let place = Place { domain: Domain::Time, from: 245.0, to: 255.0 };
        let figure = time_course(&TimeSeries {
            time_s: &time,
            before: &before,
            after: Some(&after),
            contribution: Some(&step),
            places: &[place],
        });
        assert_eq!(figure.panels.len(), 2);
        let upper = &figure.panels[0].layers;
        assert!(matches!(upper[0], Layer::Span { from, to, .. } if from == 245.0 && to == 255.0));
        // 5000 samples become means of six, 0.6 s.
        assert_eq!(drawn(&upper[1]).len(), 834);
        let crate::message::Arg::Number(seconds) = figure.remarks[0].args["seconds"] else { panic!() };
        assert!((seconds - 0.6).abs() < 1e-9, "{seconds}");
        let (first, last) = (drawn(&upper[2])[0].1, drawn(&upper[2])[833].1);
        assert_eq!((first, last), (0.0, 2.0));
        assert!(drawn(&figure.panels[1].layers[1]).iter().all(|p| (p.1 - 1.0).abs() < 1e-12));
    }

    #[test]
    fn a_place_is_shaded_only_where_it_narrows() {
        let points: Vec<(f64, f64)> = (0..=10).map(|i| (f64::from(i), 1.0)).collect();
        let spans = |from: f64, to: f64| {
            let place = Place { domain: Domain::Time, from, to };
            let layers = &local_level(&points, None, 10.0, &[place]).panels[0].layers;
            layers.iter().filter(|l| matches!(l, Layer::Span { .. })).count()
        };
        assert_eq!([spans(2.0, 5.0), spans(0.0, 7.9), spans(-5.0, 20.0), spans(0.5, 9.5)], [1, 1, 0, 0]);
    }

    #[test]
    fn the_band_of_the_level_is_that_of_chi_square() {
        let points = [(0.0, 1.0), (10.0, 1.1)];
        let figure = local_level(&points, None, 10.0, &[]);
        // χ² of 10 degrees of freedom: 3.247 and 20.483 at 2.5 and 97.5 %.
        let Layer::Band { points, .. } = &figure.panels[0].layers[0] else { panic!("no band") };
        assert!((points[0].1 - 0.3247).abs() < 1e-4 && (points[0].2 - 2.0483).abs() < 1e-4);
    }
}
