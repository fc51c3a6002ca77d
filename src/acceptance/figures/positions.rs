//! Output in every position against the Earth rate expected there, and what the line leaves.

use super::draw;
use crate::estimate::normal_quantile;
use crate::figure::{Figure, Style};
use crate::i18n::note;
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
        draw::line(of(&true_slope), Style::Reference, "figure_positions.earth"),
        draw::line(of(&fitted), Style::Model, "figure_positions.line"),
        draw::points(means().map(|p| (p.earth, p.output)).collect(), Style::Data, "figure_positions.output"),
    ];
    // Positions at one place in the figure share a word.
    for (i, p) in found.means.iter().enumerate() {
        if found.means[..i].iter().all(|other| (other.earth - p.earth).abs() > room) {
            let names: Vec<&str> =
                means().filter(|o| (o.earth - p.earth).abs() <= room).map(|o| o.name.as_str()).collect();
            let text = note!("figure_positions.name", name = names.join(", "));
            layers.push(draw::label((p.earth, p.output), text));
        }
    }
    let left = || means().map(|p| (p.earth, p.output - fitted(p.earth), k * p.standard));
    let rest = vec![
        draw::horizontal(0.0, Style::Model, ""),
        draw::strokes(left().map(|(x, r, u)| (x, r - u, r + u)), Style::Data, "figure.legend.band95"),
        draw::points(left().map(|(x, r, _)| (x, r)).collect(), Style::Data, "figure_table.residual"),
    ];
    let x = || draw::linear("figure_positions.axis_earth", "deg/h");
    draw::figure(
        "positions",
        "figure.title.positions",
        &found.channel,
        several,
        vec![
            draw::panel(x(), draw::linear("figure_table.axis_output", "deg/h"), layers),
            draw::panel(x(), draw::linear("figure_table.axis_residual", "deg/h"), rest),
        ],
        vec![],
    )
}
