//! What the output leaves about the mean of each step, over the angle of the table: a polar plot.

use super::draw;
use crate::estimate::normal_quantile;
use crate::figure::{Figure, Style};
use crate::i18n::{Arg, note};
use crate::rate_table::TableRun;
use crate::rate_table::blocks::TURN_ARCSEC;
use crate::rate_table::scale_factor::ScaleFactor;
use std::f64::consts::TAU;

/// Sectors of a turn.
const SECTORS_PER_TURN: usize = 36;

/// Radius of the zero in units of the largest residual.
const ZERO_RADIUS: f64 = 2.0;

/// Mean and the square of its standard uncertainty of every sector: samples, sum, sum of squares, blocks.
#[derive(Default, Clone, Copy)]
struct Sector {
    weight: f64,
    sum: f64,
    squares: f64,
    blocks: f64,
}

/// The means over the angle with their standard uncertainties, deg/h; `None` where too few whole turns tell them.
fn sectors(run: &TableRun, channel: &ScaleFactor) -> Option<Vec<(f64, f64)>> {
    let gyro = run.blocks.gyros.iter().position(|g| *g == channel.channel)?;
    let mut all = vec![Sector::default(); SECTORS_PER_TURN];
    let dt = run.blocks.interval_s;
    for step in run.steps.list.iter().filter(|s| s.turns.abs() >= 1.0) {
        let inside = run.blocks.list.iter().filter(|b| {
            b.first_row >= step.first_row && b.first_row < step.end_row && b.gyro[gyro].is_finite()
        });
        let mean = *step.gyro.get(gyro)?;
        for b in inside {
            let turned = step.rate * f64::from(b.samples) * dt;
            // A block that passes several sectors tells none of them.
            if turned.abs() > 2.0 * TURN_ARCSEC / SECTORS_PER_TURN as f64 || !b.angle_first.is_finite() {
                continue;
            }
            let turn = ((b.angle_first + 0.5 * turned) / TURN_ARCSEC).rem_euclid(1.0);
            let at = ((turn * SECTORS_PER_TURN as f64) as usize).min(SECTORS_PER_TURN - 1);
            let (w, r) = (f64::from(b.samples), b.gyro[gyro] - mean);
            let s = &mut all[at];
            s.weight += w;
            s.sum += w * r;
            s.squares += w * r * r;
            s.blocks += 1.0;
        }
    }
    let whole = all.iter().all(|s| s.blocks >= 3.0);
    whole.then(|| {
        all.iter()
            .map(|s| {
                let mean = s.sum / s.weight;
                (mean, ((s.squares / s.weight - mean * mean).max(0.0) / (s.blocks - 1.0)).sqrt())
            })
            .collect()
    })
}

/// Draws the residual of a channel over the angle of the table.
pub fn figure(run: &TableRun, channel: &ScaleFactor, several: bool) -> Option<Figure> {
    let means = sectors(run, channel)?;
    let k = normal_quantile(0.975);
    let largest = means.iter().fold(0.0, |m: f64, (r, u)| m.max(r.abs() + k * u)).max(f64::MIN_POSITIVE);
    let zero = ZERO_RADIUS * largest;
    let angle = |i: f64| TAU * (i + 0.5) / SECTORS_PER_TURN as f64;
    let place = |theta: f64, value: f64| ((zero + value) * theta.cos(), (zero + value) * theta.sin());
    let ring = |value: f64| (0..=180).map(|i| place(TAU * f64::from(i) / 180.0, value)).collect();
    let mut spokes = Vec::new();
    for i in 0..12 {
        let theta = TAU * f64::from(i) / 12.0;
        spokes.extend([place(theta, -largest), place(theta, largest), (f64::NAN, f64::NAN)]);
    }
    let mut bars = Vec::new();
    for (i, (r, u)) in means.iter().enumerate() {
        let theta = angle(i as f64);
        bars.extend([place(theta, r - k * u), place(theta, r + k * u), (f64::NAN, f64::NAN)]);
    }
    let mut curve: Vec<(f64, f64)> =
        means.iter().enumerate().map(|(i, (r, _))| place(angle(i as f64), *r)).collect();
    curve.extend(curve.first().copied());
    let mut layers = vec![
        draw::line(spokes, Style::Muted, ""),
        draw::line(ring(largest), Style::Muted, ""),
        draw::line(ring(-largest), Style::Muted, ""),
        draw::line(ring(0.0), Style::Reference, "figure_polar.zero"),
        draw::line(bars, Style::SecondData, "figure.legend.band95"),
        draw::line(curve, Style::Data, "figure_table.residual"),
    ];
    for i in 0..4 {
        let degrees = 90.0 * f64::from(i);
        let text = note!("figure_polar.angle", angle = Arg::decimals(degrees, 0));
        layers.push(draw::label(place(degrees.to_radians(), 1.15 * largest), text));
    }
    Some(draw::figure(
        "table_polar",
        "figure.title.table_polar",
        &channel.channel,
        several,
        vec![draw::panel(draw::polar("figure_polar.axis", ""), draw::polar("figure_polar.axis", ""), layers)],
        vec![note!("figure_polar.rings", value = Arg::figures(largest, 2))],
    ))
}
