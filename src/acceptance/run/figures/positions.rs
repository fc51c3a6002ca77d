//! Output in every position against the Earth rate expected there, and what the line leaves.

use super::{axis, line, strokes};
use crate::estimate::normal_quantile;
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::i18n::Note;
use crate::rate_table::known::Positions;

/// Draws the positions of a channel.
pub fn figure(found: &Positions, several: bool) -> Figure {
    let k = normal_quantile(0.975);
    let means = || found.means.iter();
    let low = means().fold(f64::INFINITY, |m, p| m.min(p.earth));
    let high = means().fold(f64::NEG_INFINITY, |m, p| m.max(p.earth));
    let room = 0.1 * (high - low);
    let ends = [low - room, high + room];
    let fitted = |earth: f64| found.bias.value + found.factor.value * earth;
    let true_slope = |earth: f64| found.bias.value + earth;
    let of = |f: &dyn Fn(f64) -> f64| ends.map(|x| (x, f(x))).to_vec();
    let mut layers = vec![
        line(of(&true_slope), Style::Reference, "figure_positions.earth"),
        line(of(&fitted), Style::Model, "figure_positions.line"),
        Layer::Points {
            points: means().map(|p| (p.earth, p.output)).collect(),
            style: Style::Data,
            legend: "figure_positions.output".into(),
        },
    ];
    // Positions at one place in the figure share a word.
    for (i, p) in found.means.iter().enumerate() {
        if found.means[..i].iter().all(|other| (other.earth - p.earth).abs() > room) {
            let names: Vec<&str> =
                means().filter(|o| (o.earth - p.earth).abs() <= room).map(|o| o.name.as_str()).collect();
            let text = Note::new("figure_positions.name").with("name", names.join(", "));
            layers.push(Layer::Label { at: (p.earth, p.output), text });
        }
    }
    let left = || means().map(|p| (p.earth, p.output - fitted(p.earth), k * p.standard));
    let rest = vec![
        Layer::Horizontal { at: 0.0, style: Style::Model, legend: String::new() },
        strokes(left().map(|(x, r, u)| (x, r - u, r + u)), Style::Data, "figure.legend.band95"),
        Layer::Points {
            points: left().map(|(x, r, _)| (x, r)).collect(),
            style: Style::Data,
            legend: "figure_table.residual".into(),
        },
    ];
    let x = || axis("figure_positions.axis_earth", "deg/h", Scale::Linear);
    Figure {
        id: if several { format!("positions_{}", found.channel) } else { "positions".to_owned() },
        title: "figure.title.positions".into(),
        channel: if several { found.channel.clone() } else { String::new() },
        panels: vec![
            Panel { x: x(), y: axis("figure_table.axis_output", "deg/h", Scale::Linear), layers },
            Panel { x: x(), y: axis("figure_table.axis_residual", "deg/h", Scale::Linear), layers: rest },
        ],
        remarks: vec![],
    }
}
