//! Output in every position in the field of gravity, with the model; below, what the model leaves.

use super::draw;
use crate::figure::{Figure, Style};
use crate::rate_table::acceleration::Acceleration;

/// Draws the positions of a channel.
pub fn figure(found: &Acceleration, several: bool) -> Figure {
    let points = |of: &dyn Fn(&(f64, f64)) -> f64| {
        (1..).zip(&found.means).map(|(number, mean)| (f64::from(number), of(mean))).collect::<Vec<_>>()
    };
    let position = || draw::linear("figure_positions.axis_position", "");
    draw::figure(
        "gravity",
        "figure.title.gravity",
        &found.channel,
        several,
        vec![
            draw::panel(
                position(),
                draw::linear("figure_table.axis_output", "deg/h"),
                vec![
                    draw::line(points(&|m| m.1), Style::Model, "figure.legend.model"),
                    draw::points(points(&|m| m.0), Style::Data, "figure_positions.output"),
                ],
            ),
            draw::panel(
                position(),
                draw::linear("figure_table.axis_residual", "deg/h"),
                vec![
                    draw::horizontal(0.0, Style::Model, ""),
                    draw::points(points(&|m| m.0 - m.1), Style::Data, "figure_table.residual"),
                ],
            ),
        ],
        vec![],
    )
}
