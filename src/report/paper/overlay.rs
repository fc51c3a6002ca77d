//! Figures of several records or channels in one.

use super::layers::{LayerKind, restyle};
use crate::figure::{Figure, Layer, Style};
use crate::i18n::{Note, note};

/// Figures that can be told apart on common axes.
pub const MAX_SOURCES: usize = 8;

/// A figure that goes into another, with its entry in the legend.
pub struct Source {
    /// Entry in the legend.
    pub label: String,
    /// The figure.
    pub figure: Figure,
}

/// One figure of several over the same axes: data and intervals of each in a look of its own, limits that they share once.
///
/// # Errors
/// A note where they are too many, or over other axes.
pub fn overlay(sources: Vec<Source>) -> Result<Option<Figure>, Note> {
    if sources.len() > MAX_SOURCES {
        return Err(note!("figure_paper.too_many", given = sources.len(), most = MAX_SOURCES));
    }
    if sources.len() < 2 {
        return Ok(sources.into_iter().next().map(|s| s.figure));
    }
    let mut whole: Option<Figure> = None;
    for (source, number) in sources.into_iter().zip(0u8..) {
        let mut figure = source.figure;
        for layer in figure.panels.iter_mut().flat_map(|p| &mut p.layers) {
            match LayerKind::of(layer) {
                LayerKind::Data => restyle(layer, Style::Unit(number), &source.label),
                LayerKind::Intervals => restyle(layer, Style::Unit(number), ""),
                _ => {}
            }
        }
        let Some(first) = &mut whole else {
            figure.channel = String::new();
            figure.remarks = vec![];
            whole = Some(figure);
            continue;
        };
        let axes = |f: &Figure| f.panels.iter().map(|p| (p.x.clone(), p.y.clone())).collect::<Vec<_>>();
        if axes(first) != axes(&figure) {
            return Err(note!("figure_paper.other_axes", label = source.label));
        }
        for (panel, more) in first.panels.iter_mut().zip(figure.panels) {
            let new: Vec<Layer> = more.layers.into_iter().filter(|l| !panel.layers.contains(l)).collect();
            panel.layers.extend(new);
        }
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Panel, Scale};

    fn source(label: &str, unit: &str) -> Source {
        let axis = Axis { label: "a".into(), unit: unit.to_owned(), scale: Scale::Log, range: None };
        let line = |style, legend: &str| Layer::Line {
            points: vec![(1.0, 1.0), (2.0, 1.0)],
            style,
            legend: legend.to_owned(),
        };
        let layers = vec![line(Style::Data, "data"), line(Style::Limit, "limit")];
        let figure = Figure {
            id: "f".into(),
            title: "t".into(),
            channel: label.to_owned(),
            panels: vec![Panel { x: axis.clone(), y: axis, layers }],
            remarks: vec![],
        };
        Source { label: label.to_owned(), figure }
    }

    #[test]
    fn units_are_told_apart_and_share_their_limit() {
        let whole = overlay(vec![source("one", "deg/h"), source("two", "deg/h")]).unwrap().unwrap();
        let seen: Vec<(Style, &str)> = whole.panels[0]
            .layers
            .iter()
            .filter_map(|l| match l {
                Layer::Line { style, legend, .. } => Some((*style, legend.as_str())),
                _ => None,
            })
            .collect();
        assert_eq!(seen, [(Style::Unit(0), "one"), (Style::Limit, "limit"), (Style::Unit(1), "two")]);
    }

    #[test]
    fn other_axes_and_too_many_units_are_refused() {
        let refused = overlay(vec![source("one", "deg/h"), source("two", "deg")]).unwrap_err();
        assert_eq!(refused.id, "figure_paper.other_axes");
        let many = (0..=MAX_SOURCES).map(|i| source(&i.to_string(), "deg/h")).collect();
        assert_eq!(overlay(many).unwrap_err().id, "figure_paper.too_many");
    }
}
