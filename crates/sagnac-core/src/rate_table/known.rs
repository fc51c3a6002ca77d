//! Inputs that are known without a table, and positions against the Earth's rotation.

use super::blocks::{Block, Blocks};
use super::design::slope_of;
use super::model::TAKEN_FROM;
use super::noise::Rows;
use super::setup::{Input, ReferenceInput};
use crate::numeric::reml::{self, Combination, Fit};
use nalgebra::{DMatrix, DVector};

/// Least difference of the Earth rate between positions from which a line is taken, deg/h.
pub const LEAST_SPAN_DEG_H: f64 = 0.1;

/// Parts that all stretches of a channel are cut into.
const TOTAL_PARTS: usize = 200;

/// A stretch as it was found: blocks from the first to before the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Position in the list of known inputs.
    pub known: usize,
    /// Its blocks.
    pub blocks: (usize, usize),
}

/// Finds the stretches in the blocks. `phases` are the phases of a manifest with their first and last row.
pub fn stretches(blocks: &Blocks, known: &[ReferenceInput], phases: &[(String, u64, u64)]) -> Vec<Stretch> {
    let end_row = |b: &Block| b.first_row + u64::from(b.samples);
    known
        .iter()
        .enumerate()
        .flat_map(|(at, k)| {
            let spans: Vec<(u64, u64)> = match &k.phase {
                Some(name) => phases.iter().filter(|(p, _, _)| p == name).map(|(_, a, b)| (*a, *b)).collect(),
                None => vec![(0, u64::MAX)],
            };
            spans.into_iter().filter_map(move |(first, last)| {
                let inside = |b: &Block| {
                    let from = b.first_index as f64 * blocks.interval_s;
                    let to = (b.first_index + u64::from(b.samples)) as f64 * blocks.interval_s;
                    b.first_row >= first
                        && end_row(b) <= last.saturating_add(1)
                        && k.from_s.is_none_or(|f| from >= f - 1e-9)
                        && k.to_s.is_none_or(|t| to <= t + 1e-9)
                };
                let start = blocks.list.iter().position(inside)?;
                let count = blocks.list[start..].iter().take_while(|b| inside(b)).count();
                (count > 0).then_some(Stretch { known: at, blocks: (start, start + count) })
            })
        })
        .collect()
}

/// Rows of a channel over stretches: outputs with the time they were averaged over, and the stretch of each.
pub(super) struct Cut {
    pub(super) y: DVector<f64>,
    pub(super) rows: Rows,
    /// Stretch of each row.
    pub(super) of: Vec<usize>,
}

pub(super) fn cut(blocks: &Blocks, stretches: &[&Stretch], channel: usize) -> Option<Cut> {
    let total: usize = stretches.iter().map(|s| s.blocks.1 - s.blocks.0).sum();
    let (mut y, mut of) = (vec![], vec![]);
    let mut rows = Rows::default();
    for (number, s) in stretches.iter().enumerate() {
        let length = s.blocks.1 - s.blocks.0;
        let parts = (TOTAL_PARTS * length / total.max(1)).clamp(2.min(length), length);
        for k in 0..parts {
            let list = &blocks.list[s.blocks.0 + length * k / parts..s.blocks.0 + length * (k + 1) / parts];
            let usable = list.iter().filter(|b| b.gyro.get(channel).is_some_and(|g| g.is_finite()));
            let (sum, n) = usable.fold((0.0, 0.0), |(s, n), b| {
                let w = f64::from(b.samples);
                (s + w * b.gyro[channel], n + w)
            });
            let (Some(first), Some(last)) = (list.first(), list.last()) else { continue };
            if n == 0.0 {
                continue;
            }
            y.push(sum / n);
            of.push(number);
            let end = last.first_index + u64::from(last.samples);
            rows.mid_s.push(0.5 * (first.first_index + end) as f64 * blocks.interval_s);
            rows.length_s.push(n * blocks.interval_s);
            rows.step.push(number);
        }
    }
    (y.len() > stretches.len()).then(|| Cut { y: DVector::from_vec(y), rows, of })
}

/// Kinds of noise, that of the angle last.
pub(super) fn noise_components(rows: &Rows) -> [DMatrix<f64>; 4] {
    [rows.white(), rows.flicker(), rows.random_walk(), rows.angle()]
}

/// Generalised least squares in the identified noise beside a covariance that is known, with the kinds that its strengths
/// are of. Noise of the angle is only taken where it shows: it averages out where other noise does not, and taken without
/// need makes means too certain.
pub(super) fn solve(cut: &Cut, x: &DMatrix<f64>, known: &DMatrix<f64>) -> Option<(Fit, Vec<usize>)> {
    let n = cut.rows.len();
    let fixed = known + DMatrix::identity(n, n) * (1e-9 * cut.y.variance()).max(f64::MIN_POSITIVE);
    let components = noise_components(&cut.rows);
    let usual = reml::fit(&cut.y, x, &fixed, &components[..3]);
    let all = reml::fit(&cut.y, x, &fixed, &components);
    match (usual, all) {
        (Some(usual), Some(all)) if all.twice_log_likelihood > usual.twice_log_likelihood + TAKEN_FROM => {
            Some((all, vec![0, 1, 2, 3]))
        }
        (Some(usual), _) => Some((usual, vec![0, 1, 2])),
        (None, all) => Some((all?, vec![0, 1, 2, 3])),
    }
}

/// One channel in positions against the Earth's rotation.
#[derive(Debug, Clone)]
pub struct Positions {
    /// Channel.
    pub channel: String,
    /// Output per input, with what the directions and the latitude contribute.
    pub factor: Combination,
    /// Bias, deg/h, likewise.
    pub bias: Combination,
    /// Mean output in every position with its standard uncertainty, and the Earth rate expected there with its own, deg/h.
    pub means: Vec<Mean>,
    /// Channel that shows the Earth's rotation between these positions in place of this one, and its factor.
    pub turned_instead: Option<(String, f64)>,
}

/// One position of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Mean {
    /// Name of the phase, or the number of the position counted from 1.
    pub name: String,
    /// Mean output, deg/h.
    pub output: f64,
    /// Standard uncertainty of it, deg/h.
    pub standard: f64,
    /// Earth rate expected, deg/h.
    pub earth: f64,
    /// Standard uncertainty of it, deg/h.
    pub earth_standard: f64,
}

/// Evaluates the positions of a channel. `earth` gives the Earth rate along an axis with its standard uncertainty.
/// `None` when fewer than two positions differ.
pub fn positions(
    blocks: &Blocks,
    known: &[ReferenceInput],
    stretches: &[Stretch],
    channel: usize,
    earth: &dyn Fn((f64, f64), (f64, f64)) -> (f64, f64),
) -> Option<Positions> {
    let id = blocks.gyros.get(channel)?;
    let own: Vec<&Stretch> = stretches
        .iter()
        .filter(|s| {
            let k = &known[s.known];
            matches!(k.input, Input::Position { .. }) && k.channel.as_ref().is_none_or(|c| c == id)
        })
        .collect();
    let inputs: Vec<(f64, f64)> = own
        .iter()
        .map(|s| match known[s.known].input {
            Input::Position { heading, elevation } => earth(heading, elevation),
            _ => (0.0, 0.0),
        })
        .collect();
    let span = inputs.iter().map(|i| i.0).fold(f64::NEG_INFINITY, f64::max)
        - inputs.iter().map(|i| i.0).fold(f64::INFINITY, f64::min);
    if own.len() < 2 || span.is_nan() || span <= LEAST_SPAN_DEG_H {
        return None;
    }
    let cut = cut(blocks, &own, channel)?;
    let n = cut.rows.len();
    let x = DMatrix::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { inputs[cut.of[i]].0 });
    let along: Vec<f64> = cut.of.iter().map(|k| inputs[*k].0).collect();
    let slope = slope_of(&along, cut.y.as_slice())?;
    // A direction that is wrong shifts all of its position: known beforehand, it is not taken for drift, and the position
    // has the weight that its direction allows.
    let of_directions = DMatrix::from_fn(n, n, |i, j| {
        if cut.of[i] == cut.of[j] { (slope * inputs[cut.of[i]].1).powi(2) } else { 0.0 }
    });
    let (fit, _) = solve(&cut, &x, &of_directions)?;
    let saturated = DMatrix::from_fn(n, own.len(), |i, j| if cut.of[i] == j { 1.0 } else { 0.0 });
    let (each, _) = solve(&cut, &saturated, &DMatrix::zeros(n, n))?;
    let means = own
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let c = each.coefficient(i);
            let k = &known[s.known];
            Mean {
                name: k.phase.clone().unwrap_or_else(|| (s.known + 1).to_string()),
                output: c.value,
                standard: c.standard,
                earth: inputs[i].0,
                earth_standard: inputs[i].1,
            }
        })
        .collect();
    Some(Positions {
        channel: id.clone(),
        factor: fit.coefficient(1),
        bias: fit.coefficient(0),
        means,
        turned_instead: None,
    })
}

impl Positions {
    /// True when the output follows the Earth's rotation as the positions have it, as nearly as the noise tells.
    pub fn follows(&self) -> bool {
        (self.factor.value - 1.0).abs() <= (4.0 * self.factor.standard).max(0.02)
    }

    /// True when it is plain that it follows.
    pub fn plainly_follows(&self) -> bool {
        self.follows() && self.factor.standard < 0.1
    }

    /// Pairs of positions between which the output changed its sign with its bias: turned in software and not in space.
    ///
    /// In space the sum of both outputs is twice the bias, and their difference is the Earth's. Where the outputs are
    /// opposite to one another within their errors and their size is not that of the Earth rate, the bias was turned too.
    pub fn turned_in_software(&self) -> Vec<(&Mean, &Mean)> {
        let mut pairs = Vec::new();
        for (i, a) in self.means.iter().enumerate() {
            for b in &self.means[i + 1..] {
                let opposite = (a.earth + b.earth).abs() < 0.05 * a.earth.abs().max(b.earth.abs());
                let scatter = a.standard.hypot(b.standard).max(1e-9);
                let earth = 0.5 * (a.earth - b.earth);
                let half = 0.5 * (a.output - b.output);
                let off = (half - earth).abs();
                let allowed = 4.0 * (0.5 * scatter).hypot(a.earth_standard.max(b.earth_standard));
                let sum = (a.output + b.output).abs();
                // The bias that the excess would be in software, and how nearly it is missing from the sum.
                if opposite && sum < 3.0 * scatter && sum < 0.2 * off && off > allowed {
                    pairs.push((a, b));
                }
            }
        }
        pairs
    }
}
