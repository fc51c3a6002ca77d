//! Turns of a unit at rest by known angles: what every channel makes of a turn about the axis of every channel.
//!
//! A turn by the angle θ in the time h leaves ∫y dt = K θ + b h + noise; the bias b is that of the rests. The noise of their
//! difference is that of a turn against the rests, with flicker and random walk as the rests show them.

use super::blocks::Blocks;
use super::known::{Stretch, cut, noise_components, solve};
use super::noise::Rows;
use super::setup::{Input, ReferenceInput};
use crate::numeric::reml::{Combination, Fit};
use crate::units::EARTH_RATE_DEG_H;
use nalgebra::{DMatrix, DVector};

/// Turns by known angles.
#[derive(Debug, Clone)]
pub struct Turns {
    /// One a channel and axis.
    pub table: Vec<Turned>,
}

/// What a channel made of the turns about an axis.
#[derive(Debug, Clone)]
pub struct Turned {
    /// Channel of the output.
    pub output: String,
    /// Channel whose axis was turned about.
    pub axis: String,
    /// Output per input, with the noise.
    pub factor: Combination,
    /// Standard uncertainty from that of the angles.
    pub by_angle: f64,
    /// Most that the Earth's rotation across the axis adds to either side.
    pub by_earth: f64,
}

/// What the rests tell of a channel.
struct Rest {
    rows: Rows,
    fit: Fit,
    /// Which kinds of noise the strengths of the fit are of.
    kinds: Vec<usize>,
}

impl Rest {
    fn of(blocks: &Blocks, rests: &[&Stretch], channel: usize) -> Option<Rest> {
        let cut = cut(blocks, rests, channel)?;
        let n = cut.rows.len();
        let (fit, kinds) = solve(&cut, &DMatrix::from_element(n, 1, 1.0), &DMatrix::zeros(n, n))?;
        Some(Rest { rows: cut.rows, fit, kinds })
    }

    /// The bias, deg/h.
    fn bias(&self) -> f64 {
        self.fit.coefficients[0]
    }

    /// Standard deviation and degrees of freedom of Σ wᵢ(ȳᵢ − b) over turns: each its middle and length, s, and weight.
    fn noise_of(&self, turns: &[(f64, f64, f64)]) -> (f64, f64) {
        let mut rows = self.rows.clone();
        let of_bias: f64 = turns.iter().map(|t| t.2).sum();
        let mut weights: Vec<f64> = self.fit.weights.iter().map(|w| -w * of_bias).collect();
        for (i, (mid_s, length_s, weight)) in turns.iter().enumerate() {
            rows.mid_s.push(*mid_s);
            rows.length_s.push(*length_s);
            rows.step.push(usize::MAX - i);
            weights.push(*weight);
        }
        let (weights, all) = (DVector::from_vec(weights), noise_components(&rows));
        let variances: Vec<f64> = self.kinds.iter().map(|k| weights.dot(&(&all[*k] * &weights))).collect();
        self.fit.noise_of(&variances)
    }
}

/// Evaluates turns by known angles; `None` without one.
pub fn turns(blocks: &Blocks, known: &[ReferenceInput], stretches: &[Stretch]) -> Option<Turns> {
    let rests: Vec<&Stretch> =
        stretches.iter().filter(|s| matches!(known[s.known].input, Input::Rest)).collect();
    let mut table = Vec::new();
    for (channel, output) in blocks.gyros.iter().enumerate() {
        let rest = Rest::of(blocks, &rests, channel);
        for axis in &blocks.gyros {
            let own: Vec<(&Stretch, (f64, f64))> = stretches
                .iter()
                .filter(|s| known[s.known].channel.as_ref() == Some(axis))
                .filter_map(|s| match known[s.known].input {
                    Input::Turn { angle } => Some((s, angle)),
                    _ => None,
                })
                .collect();
            if own.is_empty() {
                continue;
            }
            let bias = rest.as_ref().map_or(0.0, Rest::bias);
            let square: f64 = own.iter().map(|(_, a)| a.0 * a.0).sum();
            let (mut sum, mut length, mut weighed) = (0.0, 0.0, vec![]);
            for (s, angle) in &own {
                let (turned, hours, middle_s) = integral(blocks, s, channel);
                sum += angle.0 * (turned - bias * hours);
                length += angle.0 * hours;
                weighed.push((middle_s, 3600.0 * hours, angle.0 * hours / square));
            }
            let factor = sum / square;
            let by_angle: f64 = own.iter().map(|(_, a)| (factor * a.0 * a.1 / square).powi(2)).sum();
            let (noise, dof) = rest.as_ref().map_or((0.0, 1e9), |r| r.noise_of(&weighed));
            // What the Earth's rotation adds across the axis stands in the bias at rest and turns with the unit; along the
            // axis it stays. Attitude and latitude are not asked for: any direction is as likely, and with it any component
            // up to the whole.
            let across = if output == axis { 0.0 } else { EARTH_RATE_DEG_H };
            table.push(Turned {
                output: output.clone(),
                axis: axis.clone(),
                factor: Combination { value: factor, standard: noise, dof },
                by_angle: by_angle.sqrt(),
                by_earth: (across * length / square).abs(),
            });
        }
    }
    (!table.is_empty()).then_some(Turns { table })
}

/// Angle that the output makes of a stretch, deg, its length, h, and its middle, s. Samples that cannot be used count as the
/// mean.
fn integral(blocks: &Blocks, s: &Stretch, channel: usize) -> (f64, f64, f64) {
    let list = &blocks.list[s.blocks.0..s.blocks.1];
    let (mut angle, mut used, mut all, mut middle) = (0.0, 0.0, 0.0, 0.0);
    for b in list {
        let samples = f64::from(b.samples);
        let hours = samples * blocks.interval_s / 3600.0;
        all += hours;
        middle += hours * (b.first_index as f64 + 0.5 * samples) * blocks.interval_s;
        if let Some(g) = b.gyro.get(channel).filter(|g| g.is_finite()) {
            angle += g * hours;
            used += hours;
        }
    }
    let middle_s = middle / all.max(f64::MIN_POSITIVE);
    if used > 0.0 { (angle * all / used, all, middle_s) } else { (0.0, all, middle_s) }
}
