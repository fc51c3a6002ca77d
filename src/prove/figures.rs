//! Figures of a proof: the inferred course against what was concealed, then the figures of the explanations.

use super::rows::Prepared;
use crate::figure::{Axis, Figure, Layer, Panel, Scale, Style};
use crate::i18n::note;
use crate::report::ExplanationResults;
use crate::report::proof::{CONCEALED, UNVEILED};
use sagnac_core::mismatch::figures::over_time;

/// All figures of a proof.
pub(super) fn all(
    prepared: &Prepared,
    course: Option<&[f64]>,
    concealed: &ExplanationResults,
    unveiled: Option<&ExplanationResults>,
) -> Vec<Figure> {
    let mut figures: Vec<Figure> = course.and_then(|c| against(prepared, c)).into_iter().collect();
    let both = [(CONCEALED, Some(concealed)), (UNVEILED, unveiled)];
    for (before, results) in both {
        for figure in results.into_iter().flat_map(|r| &r.figures) {
            figures.push(Figure { id: format!("{before}{}", figure.id), ..figure.clone() });
        }
    }
    figures
}

/// The concealed quantity above, the inferred course below; `None` where nothing has a course.
fn against(prepared: &Prepared, course: &[f64]) -> Option<Figure> {
    let time = &prepared.shown.time_s;
    let panel = |label: &'static str, unit: &str, layers| Panel {
        x: axis("axis.time", "s"),
        y: axis(label, unit),
        layers,
    };
    let line = |points, style, legend: &str| Layer::Line { points, style, legend: legend.to_owned() };
    let means = |values: &[f64]| over_time(time, values).0;
    let hidden = prepared.hidden.iter().map(|(name, values)| {
        panel("figure.prove.hidden", name, vec![line(means(values), Style::Data, name)])
    });
    let added = prepared.added.iter().map(|added| {
        panel(
            "figure.prove.added",
            "deg/h",
            vec![line(means(&added.course), Style::Data, "figure.prove.added")],
        )
    });
    let mut panels: Vec<Panel> = hidden.chain(added).collect();
    if panels.is_empty() {
        return None;
    }
    let (points, group) = over_time(time, course);
    let inferred = vec![line(points, Style::Model, "figure.prove.inferred")];
    panels.push(panel("figure.prove.inferred", "deg/h", inferred));
    let averaged = |seconds: f64| note!("figure.explain.averaged", seconds);
    let remarks = (group > 1).then(|| averaged(group as f64 * prepared.shown.sample_interval_s));
    Some(Figure {
        id: "inferred_course".into(),
        title: "figure.prove.title".into(),
        channel: String::new(),
        panels,
        remarks: remarks.into_iter().collect(),
    })
}

fn axis(label: &'static str, unit: &str) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale: Scale::Linear, range: None }
}
