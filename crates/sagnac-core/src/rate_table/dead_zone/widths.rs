//! Half widths by their likelihood: value, curve and bound.

use super::points::{Left, Points};
use super::rounded;
use super::shape::{Kind, Shape};
use crate::estimate::normal_quantile;

/// Half widths tried, up to a part of half the range of the rates.
const WIDTH_COUNT: usize = 160;

/// Normal score up to which a stretch that is all as likely spreads: at a risk of a tenth or less a bound is its end.
const STRETCH_SCORE: f64 = 1.2816;
/// Normal score of the ends of such a stretch.
const STRETCH_END_SCORE: f64 = 1.6449;

/// Halvings by which an end of a stretch is found.
const END_HALVINGS: usize = 24;

/// Forms that are tried: the kinds without noise inside the loop, and zones with noise.
pub const FORM_COUNT: usize = Kind::NOISE_FREE.len() + 1;

/// Number of the form with noise inside the loop.
pub const WITH_NOISE: usize = FORM_COUNT - 1;

/// Number of the gap among the forms.
const GAP_FORM: usize = 1;

/// The half widths tried, and what they leave.
pub struct Widths {
    widths: Vec<f64>,
    /// Zones without noise inside the loop, by kind.
    clean: [Vec<Left>; Kind::NOISE_FREE.len()],
    /// Zones with noise, and −2 ln of their mean likelihood over all noises for every width.
    pub with_noise: Vec<Left>,
    over_noise: Vec<f64>,
    /// Half widths of gaps, from and to, that the test does not tell from the likeliest.
    stretch: (f64, f64),
}

/// So many half widths from none up to a part of half the range of the rates, the closer the smaller they are.
pub fn tried(largest: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| 0.7 * largest * (i as f64 / (count - 1) as f64).powi(2))
}

impl Widths {
    /// Tries all half widths.
    pub fn new(points: &Points) -> Option<Widths> {
        let (_, largest) = points.range();
        let widths: Vec<f64> = tried(largest, WIDTH_COUNT).collect();
        let clean = Kind::NOISE_FREE.map(|kind| {
            let left = |w: &f64| match kind {
                Kind::Gap => points.gap(*w),
                _ => points.at_any_centre(Shape::clean(kind, *w)),
            };
            widths.iter().map(left).collect::<Vec<Left>>()
        });
        let (over_noise, with_noise) = rounded::over_noise(points, &widths);
        let stretch = stretch(points, &widths, &clean[GAP_FORM])?;
        Some(Widths { widths, clean, with_noise, over_noise, stretch })
    }

    /// The half widths, ascending.
    pub fn tried(&self) -> &[f64] {
        &self.widths
    }

    /// −2 ln of the likelihood of a form at each half width. A gap of any half width in its stretch is as likely: it is
    /// taken at its best centre, and every other form at all centres where it may lie.
    fn cost(&self, form: usize, i: usize) -> f64 {
        match form {
            WITH_NOISE => self.over_noise[i],
            GAP_FORM => self.clean[GAP_FORM][i].least,
            _ => self.clean[form][i].over_centres,
        }
    }

    /// The likeliest half width of a form without noise.
    pub fn best(&self, form: usize) -> Option<&Left> {
        self.clean.get(form)?.iter().min_by(|a, b| a.least.total_cmp(&b.least))
    }

    /// −2 ln L of the best zone of a form.
    pub fn least(&self, form: usize) -> f64 {
        let all = if form == WITH_NOISE { &self.with_noise } else { &self.clean[form] };
        all.iter().map(|l| l.least).fold(f64::INFINITY, f64::min)
    }

    /// The same of all forms without noise inside the loop.
    pub fn least_clean(&self) -> f64 {
        (0..WITH_NOISE).map(|f| self.least(f)).fold(f64::INFINITY, f64::min)
    }

    /// The same of the mean likelihood over all centres.
    pub fn least_clean_over_centres(&self) -> f64 {
        self.clean.iter().flatten().map(|v| v.over_centres).fold(f64::INFINITY, f64::min)
    }

    /// Upper bound of 95 %: for the form that allows the wider zone.
    pub fn bound(&self) -> f64 {
        (0..FORM_COUNT).map(|form| self.bound_of(form)).fold(0.0, f64::max)
    }

    /// The same of the input at which half comes through.
    pub fn bound_of_threshold(&self) -> f64 {
        let times = |form: usize| Kind::NOISE_FREE.get(form).map_or(2.0, |k| k.threshold_over_width());
        (0..FORM_COUNT).map(|form| times(form) * self.bound_of(form)).fold(0.0, f64::max)
    }

    /// The largest half width tried, deg/h, where it fits as well: the zone may be wider.
    pub fn open(&self, form: usize) -> Option<f64> {
        let z = normal_quantile(0.95);
        let lowest = (0..WIDTH_COUNT).map(|i| self.cost(form, i)).fold(f64::INFINITY, f64::min);
        let last = WIDTH_COUNT - 1;
        (self.cost(form, last) <= lowest + z * z).then(|| self.widths[last])
    }

    /// True when that is a gap, which may lie between two rates.
    pub fn bounded_by_a_gap(&self) -> bool {
        self.bound_of(GAP_FORM) >= self.bound()
    }

    fn bound_of(&self, form: usize) -> f64 {
        if form == GAP_FORM {
            return self.stretch.1;
        }
        let z = normal_quantile(0.95);
        let costs = |i: usize| self.cost(form, i);
        let lowest = (0..WIDTH_COUNT).map(costs).fold(f64::INFINITY, f64::min);
        let last = (0..WIDTH_COUNT).rev().find(|i| costs(*i) <= lowest + z * z).unwrap_or(0);
        self.widths[(last + 1).min(WIDTH_COUNT - 1)]
    }

    /// (normal score, half width) of a form, ascending.
    pub fn curve(&self, form: usize) -> Vec<(f64, f64)> {
        let cost = |i: usize| self.cost(form, i);
        let best = (0..WIDTH_COUNT).min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(0);
        let lowest = cost(best);
        let (low, high) = self.stretch;
        let mut inside = (form == GAP_FORM).then(|| {
            // A hair apart, for no stretch of a curve is level.
            let hair = 1e-6 * (high - low).max(1e-6 * high);
            let (spread, end) = (STRETCH_SCORE, STRETCH_END_SCORE);
            [(-end, low), (-spread, low + hair), (spread, high - hair), (end, high)]
        });
        let mut curve: Vec<(f64, f64)> = Vec::new();
        for (i, w) in self.widths.iter().enumerate() {
            if form == GAP_FORM && *w >= low {
                curve.extend(inside.take().into_iter().flatten());
                if *w <= high {
                    continue;
                }
            }
            let below = if form == GAP_FORM { *w < low } else { i < best };
            // Beyond a second dip all up to it belongs to the interval.
            let beyond = if below {
                (0..=i).map(cost).fold(f64::INFINITY, f64::min)
            } else {
                (i..WIDTH_COUNT).map(cost).fold(f64::INFINITY, f64::min)
            };
            let away = (beyond - lowest).max(0.0).sqrt();
            let z = if below { -away } else { away };
            match curve.last_mut() {
                Some((last, width)) if z <= *last + 1e-9 => {
                    if !below && z > *last - 1e-9 {
                        *width = *w;
                    }
                }
                _ => curve.push((z, *w)),
            }
        }
        curve.extend(inside.take().into_iter().flatten());
        curve
    }
}

/// The half widths of gaps from the least to the largest that costs no more than the likeliest but for what a bound of
/// 95 % allows. Between the last silent rate and the first that answers the edge moves nothing.
fn stretch(points: &Points, widths: &[f64], gaps: &[Left]) -> Option<(f64, f64)> {
    let z = normal_quantile(0.95);
    let most = gaps.iter().map(|g| g.least).fold(f64::INFINITY, f64::min) + z * z;
    let first = gaps.iter().position(|g| g.least <= most)?;
    let last = gaps.iter().rposition(|g| g.least <= most)?;
    // The end between a half width that is allowed and one that is not.
    let end = |mut inside: f64, mut outside: f64| {
        for _ in 0..END_HALVINGS {
            let middle = 0.5 * (inside + outside);
            if points.gap(middle).least <= most { inside = middle } else { outside = middle }
        }
        outside
    };
    let low = if first == 0 { 0.0 } else { end(widths[first], widths[first - 1]) };
    let high = if last + 1 == widths.len() { widths[last] } else { end(widths[last], widths[last + 1]) };
    Some((low, high))
}
