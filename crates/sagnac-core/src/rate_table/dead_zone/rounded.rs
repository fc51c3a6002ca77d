//! A dead zone that noise inside the loop rounds off: half width and noise together.
//!
//! The likelihood is taken over a grid of half widths and of noise over half width, each the same number of times larger
//! than the one before: a noise of an eighth of the half width rounds nothing that a test shows, and beyond eight times it
//! the response is a line for most tests. Around the peak the grid is made finer twice.

use super::points::{Left, Points};
use super::shape::{Kind, Shape};
use crate::estimate::normal_quantile;
use crate::numeric::order::{SortByNumber, SortNumbers};

/// Noise over half width, largest; its inverse is the least.
const MOST_NOISE: f64 = 8.0;

/// Ratios tried between them.
const RATIO_COUNT: usize = 13;

/// Half widths of a finer grid.
const FINE_WIDTHS: usize = 40;
/// Noises of a finer grid.
const FINE_NOISES: usize = 24;

/// Costs above the least up to which a grid is made finer.
const MAX_COST_EXCESS: f64 = 20.0;

/// Gain of −2 ln L over a zone without noise from which the noise is said to be shown: by chance in one test of a hundred.
pub const SHOWN_FROM: f64 = 5.41;

/// What the rates show of a zone with noise inside the loop.
#[derive(Debug, Clone)]
pub struct Rounded {
    /// The likeliest.
    pub best: Left,
    /// (normal score, value) of half width, noise and threshold, ascending.
    pub half_width: Vec<(f64, f64)>,
    /// The same of the noise.
    pub noise: Vec<(f64, f64)>,
    /// The same of the input at which half comes through.
    pub threshold: Vec<(f64, f64)>,
    /// (noise, −2 ln of the likelihood of the best half width with it), ascending.
    over_noise: Vec<(f64, f64)>,
}

/// −2 ln of the mean likelihood over all noises, for each of the half widths; infinite at none.
pub fn over_noise(points: &Points, widths: &[f64]) -> (Vec<f64>, Vec<Left>) {
    let cells: Vec<Vec<Left>> = widths
        .iter()
        .map(|w| {
            let ratio = |j: usize| MOST_NOISE.powf(2.0 * j as f64 / (RATIO_COUNT - 1) as f64 - 1.0);
            let some = if *w > 0.0 { RATIO_COUNT } else { 0 };
            (0..some).map(|j| points.at_any_centre(rounded(*w, ratio(j) * w))).collect()
        })
        .collect();
    (cells.iter().map(|c| mean_of(c)).collect(), cells.into_iter().flatten().collect())
}

fn rounded(half_width: f64, noise: f64) -> Shape {
    Shape { kind: Kind::Rounded, half_width, noise }
}

/// −2 ln of the mean likelihood.
fn mean_of(cells: &[Left]) -> f64 {
    let least = least_of(cells);
    let mean = cells.iter().map(|c| (0.5 * (least - c.over_centres)).exp()).sum::<f64>() / cells.len() as f64;
    if least.is_finite() { least - 2.0 * mean.ln() } else { f64::INFINITY }
}

fn least_of(cells: &[Left]) -> f64 {
    cells.iter().map(|c| c.over_centres).fold(f64::INFINITY, f64::min)
}

/// The range of a number over the cells near the likeliest, and the step by which it is to be left on either side.
fn around(cells: &[Left], of: impl Fn(&Shape) -> f64) -> (f64, f64) {
    let least = least_of(cells);
    let near = cells.iter().filter(|c| c.over_centres <= least + MAX_COST_EXCESS).map(|c| of(&c.shape));
    near.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Looks closer at the peak of what was found on the coarse grid.
pub fn closer(points: &Points, coarse: &[Left]) -> Option<Rounded> {
    let mut cells = coarse.to_vec();
    for round in 0..2 {
        let (w0, w1) = around(&cells, |s| s.half_width);
        let (n0, n1) = around(&cells, |s| s.noise);
        if !(w0 > 0.0 && n0 > 0.0 && w1.is_finite() && n1.is_finite()) {
            return None;
        }
        // By as much as a step of the grid before on either side.
        let (w_step, n_step) = if round == 0 {
            (coarse_step(coarse, w1), MOST_NOISE.powf(2.0 / (RATIO_COUNT - 1) as f64))
        } else {
            (step_of(&cells, |s| s.half_width), step_of(&cells, |s| s.noise.ln()).exp())
        };
        let (w0, w1) = ((w0 - w_step).max(0.02 * w0), w1 + w_step);
        let (n0, n1) = ((n0 / n_step).ln(), (n1 * n_step).ln());
        let at = |k: usize, n: usize, from: f64, to: f64| from + (to - from) * k as f64 / (n - 1) as f64;
        cells = (0..FINE_WIDTHS)
            .flat_map(|i| {
                (0..FINE_NOISES).map(move |j| (at(i, FINE_WIDTHS, w0, w1), at(j, FINE_NOISES, n0, n1).exp()))
            })
            .filter(|(w, n)| n / w <= MOST_NOISE && w / n <= MOST_NOISE)
            .map(|(w, n)| points.at_any_centre(rounded(w, n)))
            .collect();
    }
    let least = least_of(&cells);
    let best = *cells.iter().min_by(|a, b| a.over_centres.total_cmp(&b.over_centres))?;
    let weighted = |of: &dyn Fn(&Shape) -> f64| -> Vec<(f64, f64)> {
        curve(cells.iter().map(|c| (of(&c.shape), (0.5 * (least - c.over_centres)).exp())).collect())
    };
    let mut over_noise: Vec<(f64, f64)> = cells.iter().map(|c| (c.shape.noise, c.over_centres)).collect();
    over_noise.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    over_noise.dedup_by(|next, kept| (next.0 / kept.0 - 1.0).abs() < 1e-9);
    Some(Rounded {
        best,
        half_width: weighted(&|s| s.half_width),
        noise: weighted(&|s| s.noise),
        threshold: weighted(&|s| s.threshold()),
        over_noise,
    })
}

/// Distance of the half width from the next one on the coarse grid.
fn coarse_step(coarse: &[Left], from: f64) -> f64 {
    let above = coarse.iter().map(|c| c.shape.half_width).filter(|w| *w > from);
    let next = above.fold(f64::INFINITY, f64::min);
    if next.is_finite() { next - from } else { 0.05 * from }
}

/// Step of an even grid.
fn step_of(cells: &[Left], of: impl Fn(&Shape) -> f64) -> f64 {
    let mut values: Vec<f64> = cells.iter().map(|c| of(&c.shape)).collect();
    values.sort_ascending();
    let steps = values.windows(2).map(|p| p[1] - p[0]);
    steps.fold(0.0, f64::max)
}

/// (normal score, value) of values with their weights.
fn curve(mut values: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    values.sort_ascending_by(|a| a.0);
    let total: f64 = values.iter().map(|v| v.1).sum();
    let mut below = 0.0;
    let mut found: Vec<(f64, f64)> = vec![];
    let mut i = 0;
    while i < values.len() {
        let alike = values[i..].iter().take_while(|v| v.0 - values[i].0 <= 1e-9 * v.0.abs()).count();
        let weight: f64 = values[i..i + alike].iter().map(|v| v.1).sum();
        let p = (below + 0.5 * weight) / total;
        below += weight;
        if (1e-5..=1.0 - 1e-5).contains(&p) {
            found.push((normal_quantile(p), values[i].0));
        }
        i += alike;
    }
    found
}

impl Rounded {
    /// Whether the noise explains what a zone without leaves.
    pub fn shown(&self, least_without: f64) -> bool {
        least_without - self.best.least >= SHOWN_FROM
    }

    /// A larger noise would have been shown; `least_without` is −2 ln of the likelihood without it.
    pub fn bound(&self, least_without: f64) -> f64 {
        let least = self.over_noise.iter().map(|p| p.1).fold(least_without, f64::min);
        let within = self.over_noise.iter().filter(|p| p.1 <= least + SHOWN_FROM);
        let least_tried = self.over_noise.first().map_or(0.0, |p| p.0);
        within.map(|p| p.0).fold(least_tried, f64::max)
    }
}
