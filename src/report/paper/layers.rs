//! The layers of a figure by the part that they play, and a legend that is as short as they are few.

use crate::figure::{Figure, Layer, Style};

/// Part that layers play, by which they are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LayerKind {
    /// What was measured.
    Data,
    /// Intervals about another part that is chosen.
    Intervals,
    /// The model as a whole.
    Model,
    /// The terms of the model.
    Terms,
    /// Limits on the curve.
    Limits,
    /// Reference lines and points, such as the Russian value and its limit.
    Reference,
    /// Uncertain data, and data that were left out.
    Muted,
    /// Words at points.
    Labels,
}

/// Every part with its name on the command line.
pub static LAYERS: &[(&str, LayerKind)] = &[
    ("data", LayerKind::Data),
    ("intervals", LayerKind::Intervals),
    ("model", LayerKind::Model),
    ("terms", LayerKind::Terms),
    ("limits", LayerKind::Limits),
    ("reference", LayerKind::Reference),
    ("muted", LayerKind::Muted),
    ("labels", LayerKind::Labels),
];

impl LayerKind {
    /// Parts that a figure of a paper shows unasked: data, model and limits make three entries of a legend.
    pub const OF_A_PAPER: &[LayerKind] =
        &[LayerKind::Data, LayerKind::Intervals, LayerKind::Model, LayerKind::Limits];

    /// The part that a layer plays.
    pub fn of(layer: &Layer) -> LayerKind {
        match (layer, style(layer)) {
            (Layer::Band { .. }, _) => LayerKind::Intervals,
            // A limit at a point is that of a reference value, and stands or goes with it.
            (Layer::Points { .. }, Some(Style::Limit)) => LayerKind::Reference,
            (_, Some(style)) => LayerKind::of_style(style),
            (_, None) => LayerKind::Labels,
        }
    }

    fn of_style(style: Style) -> LayerKind {
        match style {
            Style::Data | Style::SecondData | Style::Unit(_) | Style::Heating | Style::Cooling => {
                LayerKind::Data
            }
            Style::Model => LayerKind::Model,
            Style::Term(_) | Style::UnresolvedTerm(_) => LayerKind::Terms,
            Style::Limit => LayerKind::Limits,
            Style::Reference => LayerKind::Reference,
            Style::Muted => LayerKind::Muted,
        }
    }

    /// The part of this name.
    pub fn named(id: &str) -> Option<LayerKind> {
        LAYERS.iter().find(|(name, _)| *name == id).map(|(_, kind)| *kind)
    }

    /// Its name.
    pub fn id(self) -> &'static str {
        LAYERS.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }
}

/// The style of a layer; words have none.
pub(super) fn style(layer: &Layer) -> Option<Style> {
    match layer {
        Layer::Line { style, .. }
        | Layer::Points { style, .. }
        | Layer::Band { style, .. }
        | Layer::Bars { style, .. }
        | Layer::Horizontal { style, .. }
        | Layer::Span { style, .. } => Some(*style),
        Layer::Label { .. } => None,
    }
}

/// Gives a layer another style and legend.
pub(super) fn restyle(layer: &mut Layer, to: Style, words: &str) {
    match layer {
        Layer::Line { style, legend, .. }
        | Layer::Points { style, legend, .. }
        | Layer::Band { style, legend, .. }
        | Layer::Bars { style, legend, .. }
        | Layer::Horizontal { style, legend, .. }
        | Layer::Span { style, legend, .. } => {
            *style = to;
            words.clone_into(legend);
        }
        Layer::Label { .. } => {}
    }
}

/// Keeps the layers of the chosen parts. Intervals follow the part that they are about, and need no entry beside it.
pub(super) fn keep(figure: &mut Figure, chosen: &[LayerKind]) {
    for panel in &mut figure.panels {
        panel.layers.retain(|layer| {
            chosen.contains(&LayerKind::of(layer))
                && style(layer).is_none_or(|s| {
                    !matches!(layer, Layer::Band { .. }) || chosen.contains(&LayerKind::of_style(s))
                })
        });
        let named: Vec<Style> =
            panel.layers.iter().filter(|l| !matches!(l, Layer::Band { .. })).filter_map(style).collect();
        for layer in &mut panel.layers {
            if let (Layer::Band { .. }, Some(own)) = (&*layer, style(layer))
                && named.contains(&own)
            {
                restyle(layer, own, "");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Panel, Scale};

    fn line(style: Style, legend: &str) -> Layer {
        Layer::Line { points: vec![(1.0, 1.0)], style, legend: legend.to_owned() }
    }

    fn band(style: Style) -> Layer {
        Layer::Band { points: vec![(1.0, 0.9, 1.1)], style, legend: "band".into() }
    }

    fn kept(layers: Vec<Layer>, chosen: &[LayerKind]) -> Vec<Layer> {
        let axis = Axis { label: "a".into(), unit: String::new(), scale: Scale::Linear, range: None };
        let panels = vec![Panel { x: axis.clone(), y: axis, layers }];
        let (id, channel, remarks) = ("f".to_owned(), String::new(), vec![]);
        let mut figure = Figure { id, title: "t".into(), channel, panels, remarks };
        keep(&mut figure, chosen);
        figure.panels.remove(0).layers
    }

    #[test]
    fn a_paper_has_data_model_and_limits_and_their_bands_without_an_entry() {
        let all = vec![
            band(Style::Data),
            band(Style::Muted),
            line(Style::Data, "data"),
            line(Style::Term(0), "term"),
            line(Style::Model, "model"),
            line(Style::Limit, "limit"),
            Layer::Label { at: (1.0, 1.0), text: "word".into() },
        ];
        let kept = kept(all, LayerKind::OF_A_PAPER);
        let legends = |l: &Layer| match l {
            Layer::Line { legend, .. } | Layer::Band { legend, .. } => legend.clone(),
            other => format!("{other:?}"),
        };
        assert_eq!(kept.iter().map(legends).collect::<Vec<_>>(), ["", "data", "model", "limit"]);
    }

    #[test]
    fn a_band_without_its_curve_keeps_its_entry_and_one_without_its_part_goes() {
        let all = vec![band(Style::Data), band(Style::Model)];
        let kept = kept(all, &[LayerKind::Intervals, LayerKind::Data]);
        assert_eq!(kept, [band(Style::Data)]);
    }

    #[test]
    fn every_part_has_a_name_of_its_own() {
        for (name, kind) in LAYERS {
            assert_eq!((LayerKind::named(name), kind.id()), (Some(*kind), *name));
        }
    }
}
