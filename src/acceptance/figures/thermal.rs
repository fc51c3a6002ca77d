//! Figures of tests over temperature and of the warm-up.

use super::draw;
use crate::config::procedure::Procedure;
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::figure::{Figure, Layer, Panel, Style};
use crate::i18n::{Arg, Note, note};
use crate::measurand::GyroEvidence;
use crate::temperature::SegmentKind;
use crate::temperature::course::{legendre, legendre_slopes, rate_per_minute};
use crate::temperature::findings::{Analysis, Schedule};
use crate::temperature::read::deviation;
use crate::temperature::warm_up::WarmUpFindings;
use nalgebra::DVector;

/// Points of a curve over temperature.
const CURVE_POINTS: usize = 101;
/// Points of a series at most.
const MAX_POINTS: usize = 1500;
/// Every figure that a channel has.
pub fn figures(
    gyro: &GyroEvidence,
    schedule: Option<&Schedule>,
    procedure: &Procedure,
    wanted: &dyn Fn(&str) -> bool,
) -> Vec<Figure> {
    let mut out = vec![];
    let make = |stem: &str, title: &'static str, panels: Vec<Panel>, remarks: Vec<Note>| {
        draw::figure(stem, title, &gyro.channel, gyro.several, panels, remarks)
    };
    let analysis = gyro.over_temperature.as_ref().and_then(|o| o.analysis.as_ref());
    if let Some(a) = analysis.filter(|_| wanted("over_temperature")) {
        let (panels, remarks) = over_temperature(a);
        out.push(make("over_temperature", "figure.title.over_temperature", panels, remarks));
    }
    if let Some(s) = schedule.filter(|_| wanted("temperature_schedule") && gyro.over_temperature.is_some()) {
        out.push(make(
            "temperature_schedule",
            "figure.title.temperature_schedule",
            course(s, procedure),
            vec![],
        ));
    }
    if let Some(a) = analysis.filter(|_| wanted("temperature_residual")) {
        let remark = note!("figure_thermal.averaged", average_s = Arg::figures(a.average_s, 4));
        out.push(make(
            "temperature_residual",
            "figure.title.temperature_residual",
            vec![residual(a, schedule)],
            vec![remark],
        ));
    }
    if let Some(a) = analysis.filter(|_| wanted("temperature_sensitivity")) {
        out.push(make(
            "temperature_sensitivity",
            "figure.title.temperature_sensitivity",
            vec![sensitivity(a)],
            vec![],
        ));
    }
    if let Some(w) = gyro.warm_up.as_ref().filter(|_| wanted("warm_up")) {
        out.push(make("warm_up", "figure.title.warm_up", vec![warm_up(w)], vec![]));
    }
    out
}

fn averaged_down(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let each = points.len().div_ceil(MAX_POINTS).max(1);
    let mean = |c: &[(f64, f64)]| {
        let n = c.len() as f64;
        (c.iter().map(|p| p.0).sum::<f64>() / n, c.iter().map(|p| p.1).sum::<f64>() / n)
    };
    points.chunks(each).map(mean).collect()
}

/// Bias over temperature: what was measured while heating and while cooling, the static curve with its band.
fn over_temperature(a: &Analysis) -> (Vec<Panel>, Vec<Note>) {
    let each = (((a.average_s / a.course.block_s).round() as usize).max(1)).min(a.course.len() / 8).max(1);
    let merged = a.course.merged(each.max(a.course.len() / MAX_POINTS).max(1));
    let rates = rate_per_minute(&merged.temperature_deg_c, merged.block_s, 1);
    let least = 0.5 * a.slowest_deg_c_min;
    let branch = |suits: &dyn Fn(f64) -> bool| -> Vec<(f64, f64)> {
        (0..merged.len())
            .filter(|i| suits(rates[*i]))
            .map(|i| (merged.temperature_deg_c[i], merged.rate_deg_h[i]))
            .collect()
    };
    let p = &a.posterior;
    let curve: Vec<(f64, f64, f64)> = (0..CURVE_POINTS)
        .map(|i| {
            let x = 2.0 * i as f64 / (CURVE_POINTS - 1) as f64 - 1.0;
            let t = p.span.temperature(x);
            let basis = legendre(x, p.terms.order);
            (t, a.bias_at(t), SCORE_TWO_SIDED_95 * deviation(&p.draws, &padded(&basis, p.terms.count())))
        })
        .collect();
    let points =
        |points: Vec<(f64, f64)>, style, legend: &str| draw::points(decimated(points), style, legend);
    let layers = vec![
        points(branch(&|r| r.abs() < least), Style::Muted, "figure_thermal.legend.still"),
        points(branch(&|r| r >= least), Style::Heating, "figure_thermal.legend.heating"),
        points(branch(&|r| r <= -least), Style::Cooling, "figure_thermal.legend.cooling"),
        draw::band(
            curve.iter().map(|(t, b, u)| (*t, b - u, b + u)).collect(),
            Style::Model,
            "figure.legend.band95",
        ),
        draw::line(
            curve.iter().map(|(t, b, _)| (*t, *b)).collect(),
            Style::Model,
            "figure_thermal.legend.static",
        ),
    ];
    let panel =
        draw::panel(draw::linear("axis.temperature", "degC"), draw::linear("axis.rate", "deg/h"), layers);
    let remark = note!("figure_thermal.averaged", average_s = Arg::figures(merged.block_s, 4));
    (vec![panel], vec![remark, noise_of_fit(p.best.fitted.noise, a.course.len() as f64 * a.course.block_s)])
}

/// The noise of the fit. Flicker and random walk that move the record by less than a hundredth of what its white noise
/// does are only where the search came to rest, and have no value.
fn noise_of_fit([n, b, k]: [f64; 3], length_s: f64) -> Note {
    let hours = length_s / 3600.0;
    let least = 0.01 * n / hours.sqrt();
    let seen = |value: f64, moves: f64, key: &'static str, none: &'static str| {
        if moves > least { Note::new(key).with("value", Arg::figures(value, 3)) } else { none.into() }
    };
    note!(
        "figure_thermal.noise",
        n = Arg::figures(n, 3),
        b = seen(b, b, "figure_thermal.flicker", "figure_thermal.no_flicker"),
        k = seen(k, k * hours.sqrt(), "figure_thermal.walk", "figure_thermal.no_walk")
    )
}

fn decimated(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let each = points.len().div_ceil(400).max(1);
    points.into_iter().step_by(each).collect()
}

fn padded(basis: &[f64], count: usize) -> DVector<f64> {
    DVector::from_fn(count, |i, _| basis.get(i).copied().unwrap_or(0.0))
}

/// Temperature and its rate with the segments shaded.
fn course(s: &Schedule, procedure: &Procedure) -> Vec<Panel> {
    let shades = || -> Vec<Layer> {
        s.segments
            .iter()
            .filter_map(|segment| {
                let (style, legend) = match segment.kind {
                    SegmentKind::Heating => (Style::Heating, "figure_thermal.legend.heating"),
                    SegmentKind::Cooling => (Style::Cooling, "figure_thermal.legend.cooling"),
                    SegmentKind::Soak | SegmentKind::Dwell => return None,
                };
                Some(draw::span(segment.from_s, segment.to_s, style, legend))
            })
            .collect()
    };
    let limit = |at: f64| draw::horizontal(at, Style::Limit, "figure.legend.limit");
    let mut above = shades();
    above.push(draw::line(averaged_down(s.temperature.clone()), Style::Model, "figure.legend.temperature"));
    if let Some(command) = &s.command {
        above.push(draw::line(
            averaged_down(command.clone()),
            Style::Reference,
            "figure_thermal.legend.command",
        ));
    }
    let mut below = shades();
    let step_s = s.temperature.get(1).zip(s.temperature.first()).map_or(1.0, |(b, a)| b.0 - a.0);
    let values: Vec<f64> = s.temperature.iter().map(|t| t.1).collect();
    let reach = ((300.0 / step_s).round() as usize).clamp(1, (values.len() / 100).max(1));
    let rates: Vec<(f64, f64)> = rate_per_minute(&values, step_s, reach)
        .into_iter()
        .zip(&s.temperature)
        .map(|(r, (t, _))| (*t, 60.0 * r))
        .collect();
    below.push(draw::line(averaged_down(rates), Style::Model, "figure_thermal.legend.rate"));
    if let Some(test) = &procedure.temperature_test {
        above.extend([limit(test.low_deg_c), limit(test.high_deg_c)]);
        let (slow, fast) = (test.slowest_deg_c_h, test.fastest_deg_c_h);
        below.extend([limit(fast), limit(slow), limit(-slow), limit(-fast)]);
    }
    vec![
        draw::panel(draw::linear("axis.time", "s"), draw::linear("axis.temperature", "degC"), above),
        draw::panel(draw::linear("axis.time", "s"), draw::linear("axis_thermal.rate", "degC/h"), below),
    ]
}

fn residual(a: &Analysis, schedule: Option<&Schedule>) -> Panel {
    let mut layers: Vec<Layer> = schedule
        .into_iter()
        .flat_map(|s| &s.segments)
        .filter(|s| s.kind.is_ramp())
        .map(|s| {
            let (style, legend) = match s.kind {
                SegmentKind::Heating => (Style::Heating, "figure_thermal.legend.heating"),
                _ => (Style::Cooling, "figure_thermal.legend.cooling"),
            };
            draw::span(s.from_s, s.to_s, style, legend)
        })
        .collect();
    layers.push(draw::line(
        averaged_down(a.residual.iter().map(|(t, _, r)| (*t, *r)).collect()),
        Style::Muted,
        "figure_thermal.legend.residual",
    ));
    let slow = a.slow_noise();
    let time = |i: usize| a.course.first_s + (i as f64 + 0.5) * a.course.block_s;
    layers.push(draw::line(
        averaged_down(slow.iter().enumerate().map(|(i, v)| (time(i), *v)).collect()),
        Style::Model,
        "figure_thermal.legend.slow",
    ));
    draw::panel(draw::linear("axis.time", "s"), draw::linear("axis.rate", "deg/h"), layers)
}

fn sensitivity(a: &Analysis) -> Panel {
    let p = &a.posterior;
    let scale = 2.0 / (p.span.high - p.span.low);
    let curve: Vec<(f64, f64, f64)> = (0..CURVE_POINTS)
        .map(|i| {
            let x = 2.0 * i as f64 / (CURVE_POINTS - 1) as f64 - 1.0;
            let t = p.span.temperature(x);
            let basis: Vec<f64> = legendre_slopes(x, p.terms.order).iter().map(|b| b * scale).collect();
            (t, a.slope_at(t), SCORE_TWO_SIDED_95 * deviation(&p.draws, &padded(&basis, p.terms.count())))
        })
        .collect();
    draw::panel(
        draw::linear("axis.temperature", "degC"),
        draw::linear("axis_thermal.sensitivity", "deg/h/degC"),
        vec![
            draw::band(
                curve.iter().map(|(t, b, u)| (*t, b - u, b + u)).collect(),
                Style::Model,
                "figure.legend.band95",
            ),
            draw::line(
                curve.iter().map(|(t, b, _)| (*t, *b)).collect(),
                Style::Model,
                "figure_thermal.legend.slope",
            ),
        ],
    )
}

fn warm_up(w: &WarmUpFindings) -> Panel {
    let horizontal = |at: f64| draw::horizontal(at, Style::Limit, "figure_thermal.legend.band");
    let modelled = w.blocks.iter().zip(&w.modelled).map(|((t, _), m)| (*t, *m)).collect();
    let mut layers = vec![
        draw::line(averaged_down(w.blocks.clone()), Style::Data, "figure.legend.rate"),
        draw::line(averaged_down(modelled), Style::Model, "figure_thermal.legend.transient"),
        horizontal(w.final_deg_h - w.test.band_deg_h),
        horizontal(w.final_deg_h + w.test.band_deg_h),
    ];
    if let Some(i) =
        w.time.spread.interval(w.time.value, 0.95).filter(|i| i.high > 0.0 && !w.too_short && !w.drifts_on())
    {
        layers.insert(0, draw::span(i.low, i.high, Style::Reference, "figure_thermal.legend.warm_up"));
    }
    draw::panel(draw::linear("axis.time", "s"), draw::linear("axis.rate", "deg/h"), layers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::Lang;
    use crate::i18n::Localize;

    #[test]
    fn noise_that_was_not_seen_has_no_value() {
        let none = noise_of_fit([0.002, 1.4e-8, 1.6e-8], 75_600.0).say(Lang::En);
        assert!(none.ends_with("N 0.00200 °/√h, no flicker resolved, no random walk resolved."), "{none}");
        let both = noise_of_fit([0.002, 0.003, 0.004], 75_600.0).say(Lang::En);
        assert!(both.ends_with("N 0.00200 °/√h, B 0.00300 °/h, K 0.00400 °/h/√h."), "{both}");
    }
}
