//! Half widths by their likelihood: value, curve and bound.

use super::points::{Left, Points};
use super::shape::{Kind, Shape};
use super::{WIDTHS, rounded};
use crate::estimate::normal_quantile;

/// Normal score of the ends of a stretch that is all as likely: an interval of 95 % holds it.
const EDGE_SCORE: f64 = 1.96;

/// The half widths tried, and what they leave.
pub struct Widths {
    widths: Vec<f64>,
    /// Zones without noise inside the loop, by kind.
    clean: [Vec<Left>; 2],
    /// Zones with noise, and −2 ln of their mean likelihood over all noises for every width.
    pub with_noise: Vec<Left>,
    over_noise: Vec<f64>,
    /// −2 ln of the mean likelihood of the kinds.
    costs: Vec<f64>,
    best: usize,
}

/// So many half widths from none up to a part of half the range of the rates, the closer the smaller they are.
pub fn tried(largest: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| 0.7 * largest * (i as f64 / (count - 1) as f64).powi(2))
}

impl Widths {
    /// Tries all half widths.
    pub fn new(points: &Points) -> Option<Widths> {
        let (_, largest) = points.range();
        let widths: Vec<f64> = tried(largest, WIDTHS).collect();
        let clean = [Kind::Subtractive, Kind::Gap]
            .map(|kind| widths.iter().map(|w| points.at_any_centre(Shape::clean(kind, *w))).collect());
        let (over_noise, with_noise) = rounded::over_noise(points, &widths);
        let mut found = Widths { widths, clean, with_noise, over_noise, costs: vec![], best: 0 };
        // Which kind it is, is not known either.
        found.costs = (0..WIDTHS)
            .map(|i| {
                let kinds = found.of_kinds(i);
                let least = kinds.into_iter().fold(f64::INFINITY, f64::min);
                let mean = kinds.iter().map(|k| (0.5 * (least - k)).exp()).sum::<f64>() / kinds.len() as f64;
                least - 2.0 * mean.ln()
            })
            .collect();
        found.best = (0..WIDTHS).min_by(|a, b| found.costs[*a].total_cmp(&found.costs[*b]))?;
        Some(found)
    }

    fn of_kinds(&self, i: usize) -> [f64; 3] {
        [self.clean[0][i].over_centres, self.clean[1][i].over_centres, self.over_noise[i]]
    }

    /// The half widths, ascending.
    pub fn tried(&self) -> &[f64] {
        &self.widths
    }

    /// Share of the likelihood that zones with noise inside the loop have.
    pub fn share_with_noise(&self) -> f64 {
        let lowest = self.costs[self.best];
        // Tried half widths lie the farther apart the larger they are.
        let of = |costs: &dyn Fn(usize) -> f64| -> f64 {
            (0..WIDTHS).map(|i| i as f64 * (0.5 * (lowest - costs(i))).exp()).sum()
        };
        let [a, b, with] = [0, 1, 2].map(|k| of(&|i| self.of_kinds(i)[k]));
        let all = a + b + with;
        if all > 0.0 { with / all } else { 0.0 }
    }

    /// The better zone without noise at the likeliest half width.
    pub fn chosen(&self) -> Left {
        let [a, b] = [self.clean[0][self.best], self.clean[1][self.best]];
        if a.over_centres <= b.over_centres { a } else { b }
    }

    /// −2 ln L of the best zone without noise inside the loop.
    pub fn least_clean(&self) -> f64 {
        self.clean.iter().flatten().map(|v| v.least).fold(f64::INFINITY, f64::min)
    }

    /// The same of its mean likelihood over all centres.
    pub fn least_clean_over_centres(&self) -> f64 {
        self.clean.iter().flatten().map(|v| v.over_centres).fold(f64::INFINITY, f64::min)
    }

    /// Upper bound of 95 %: for the kind that allows the wider zone.
    pub fn bound(&self) -> f64 {
        (0..3).map(|k| self.bound_of(k)).fold(0.0, f64::max)
    }

    /// True when that is a gap, which may lie between two rates.
    pub fn bounded_by_a_gap(&self) -> bool {
        self.bound_of(1) >= self.bound()
    }

    fn bound_of(&self, kind: usize) -> f64 {
        let z = normal_quantile(0.95);
        let costs = |i: usize| self.of_kinds(i)[kind];
        let lowest = (0..WIDTHS).map(costs).fold(f64::INFINITY, f64::min);
        let last = (0..WIDTHS).rev().find(|i| costs(*i) <= lowest + z * z).unwrap_or(0);
        self.widths[(last + 1).min(WIDTHS - 1)]
    }

    /// The likeliest half width, and (normal score, half width), ascending.
    pub fn curve(&self) -> (f64, Vec<(f64, f64)>) {
        let cost = |i: usize| self.costs[i];
        let (best, widths) = (self.best, &self.widths);
        let lowest = cost(best);
        // Between two rates of the test the edge of a gap moves nothing: all of that stretch is as likely.
        let alike = |i: &usize| cost(*i) <= lowest + 0.2;
        let first = (0..=best).rev().take_while(alike).last().unwrap_or(best);
        let end = (best..WIDTHS).take_while(alike).last().unwrap_or(best);
        let flat = if end > first + 3 { EDGE_SCORE } else { 0.0 };
        let value = if flat > 0.0 { 0.5 * (widths[first] + widths[end]) } else { widths[best] };
        let mut curve: Vec<(f64, f64)> = Vec::new();
        for (i, w) in widths.iter().enumerate() {
            // Beyond a second dip all up to it belongs to the interval.
            let beyond = if i < best {
                (0..=i).map(cost).fold(f64::INFINITY, f64::min)
            } else {
                (i..WIDTHS).map(cost).fold(f64::INFINITY, f64::min)
            };
            let away = (beyond - lowest).max(0.0) + flat * flat;
            let z = if flat > 0.0 && (first..=end).contains(&i) {
                flat * (2.0 * (w - widths[first]) / (widths[end] - widths[first]) - 1.0)
            } else if i < best {
                -away.sqrt()
            } else {
                away.sqrt()
            };
            match curve.last_mut() {
                Some((last, width)) if z <= *last + 1e-9 => {
                    if i > best && z > *last - 1e-9 {
                        *width = *w;
                    }
                }
                _ => curve.push((z, *w)),
            }
        }
        (value, curve)
    }
}
