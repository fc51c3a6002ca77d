//! Residuals of the scale factor over rate, and the steps over time.

use super::{axis, line};
use crate::estimate::{Limit, normal_quantile};
use crate::figure::{Figure, Layer, Panel, Scale, Style};
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
        Layer::Band { points: band, style: Style::Data, legend: "figure.legend.band95".into() },
        line(points, Style::Model, "figure_table.mean_of_rate"),
        Layer::Points { points: reached(true), style: Style::Data, legend: "figure_table.from_below".into() },
        Layer::Points {
            points: reached(false),
            style: Style::SecondData,
            legend: "figure_table.from_above".into(),
        },
    ];
    if let Some(most) = limit.and_then(|l| l.max) {
        for at in [-most, most] {
            let legend = if at > 0.0 { "figure.legend.limit" } else { "" };
            layers.push(Layer::Horizontal { at, style: Style::Limit, legend: legend.into() });
        }
    }
    figure(
        "scale_factor_residual",
        "figure.title.scale_factor_residual",
        channel,
        several,
        vec![Panel {
            x: axis("figure_table.axis_rate", unit.text(), Scale::Linear),
            y: axis("figure_table.axis_residual", "ppm", Scale::Linear),
            layers,
        }],
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
        Panel {
            x: axis("axis.time", "min", Scale::Linear),
            y: axis("figure_table.axis_rate", unit.text(), Scale::Linear),
            layers: vec![line(rate, Style::Data, "figure_table.table")],
        },
        Panel {
            x: axis("axis.time", "min", Scale::Linear),
            y: axis("figure_table.axis_residual", "ppm", Scale::Linear),
            layers: vec![Layer::Points {
                points: residual,
                style: Style::Data,
                legend: "figure_table.residual".into(),
            }],
        },
    ];
    if run.blocks.has_temperature {
        let points =
            run.steps.list.iter().map(|s| (0.5 * (s.from_s + s.to_s) / 60.0, s.temperature)).collect();
        panels.push(Panel {
            x: axis("axis.time", "min", Scale::Linear),
            y: axis("axis.temperature", "degC", Scale::Linear),
            layers: vec![line(points, Style::Data, "figure.legend.temperature")],
        });
    }
    figure("table_steps", "figure.title.table_steps", channel, several, panels)
}

fn figure(id: &str, title: &'static str, channel: &ScaleFactor, several: bool, panels: Vec<Panel>) -> Figure {
    Figure {
        id: if several { format!("{id}_{}", channel.channel) } else { id.to_owned() },
        title: title.into(),
        channel: if several { channel.channel.clone() } else { String::new() },
        panels,
        remarks: vec![],
    }
}
