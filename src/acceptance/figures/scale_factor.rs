//! Residuals of the scale factor over rate, and the steps over time.

use super::draw;
use crate::estimate::{Limit, normal_quantile};
use crate::figure::{Figure, Style};
use crate::rate_table::TableRun;
use crate::rate_table::scale_factor::ScaleFactor;

/// Draws the residuals in ppm of full scale: levels with their intervals, and single steps by the way they were reached.
pub fn residuals(run: &TableRun, channel: &ScaleFactor, limit: Option<&Limit>, several: bool) -> Figure {
    let ppm = 1e6 / (channel.factor * channel.full_scale).abs();
    let unit = channel.rate_unit();
    let k = normal_quantile(0.975);
    let levels = channel.response.levels.iter().zip(&channel.levels);
    let band =
        levels.clone().map(|(rate, (r, u))| (unit.of(*rate), (r - k * u) * ppm, (r + k * u) * ppm)).collect();
    let points: Vec<(f64, f64)> = levels.map(|(rate, (r, _))| (unit.of(*rate), r * ppm)).collect();
    let reached = |from_below: bool| -> Vec<(f64, f64)> {
        channel
            .steps
            .iter()
            .filter_map(|r| {
                let step = run.steps.list.get(r.step)?;
                ((step.approach >= 0) == from_below).then_some((unit.of(step.rate), r.residual * ppm))
            })
            .collect()
    };
    let mut layers = vec![
        draw::band(band, Style::Data, "figure.legend.band95"),
        draw::line(points, Style::Model, "figure_table.mean_of_rate"),
        draw::points(reached(true), Style::Data, "figure_table.from_below"),
        draw::points(reached(false), Style::SecondData, "figure_table.from_above"),
    ];
    if let Some(most) = limit.and_then(|l| l.max) {
        for at in [-most, most] {
            let legend = if at > 0.0 { "figure.legend.limit" } else { "" };
            layers.push(draw::horizontal(at, Style::Limit, legend));
        }
    }
    draw::figure(
        "scale_factor_residual",
        "figure.title.scale_factor_residual",
        &channel.channel,
        several,
        vec![draw::panel(
            draw::linear("figure_table.axis_rate", unit.text()),
            draw::linear("figure_table.axis_residual", "ppm"),
            layers,
        )],
        vec![],
    )
}

/// Draws rate and residual of the steps over time.
pub fn over_time(run: &TableRun, channel: &ScaleFactor, several: bool) -> Figure {
    let ppm = 1e6 / (channel.factor * channel.full_scale).abs();
    let unit = channel.rate_unit();
    let mut rate = Vec::new();
    let mut residual = Vec::new();
    for r in &channel.steps {
        let Some(step) = run.steps.list.get(r.step) else { continue };
        rate.extend([(step.from_s / 60.0, unit.of(step.rate)), (step.to_s / 60.0, unit.of(step.rate))]);
        rate.push((step.to_s / 60.0, f64::NAN));
        residual.push((0.5 * (step.from_s + step.to_s) / 60.0, r.residual * ppm));
    }
    let mut panels = vec![
        draw::panel(
            draw::linear("axis.time", "min"),
            draw::linear("figure_table.axis_rate", unit.text()),
            vec![draw::line(rate, Style::Data, "figure_table.table")],
        ),
        draw::panel(
            draw::linear("axis.time", "min"),
            draw::linear("figure_table.axis_residual", "ppm"),
            vec![draw::points(residual, Style::Data, "figure_table.residual")],
        ),
    ];
    if run.blocks.has_temperature {
        let points =
            run.steps.list.iter().map(|s| (0.5 * (s.from_s + s.to_s) / 60.0, s.temperature)).collect();
        panels.push(draw::panel(
            draw::linear("axis.time", "min"),
            draw::linear("axis.temperature", "degC"),
            vec![draw::line(points, Style::Data, "figure.legend.temperature")],
        ));
    }
    draw::figure("table_steps", "figure.title.table_steps", &channel.channel, several, panels, vec![])
}
