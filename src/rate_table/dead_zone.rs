//! Response to rates near zero: dead zone, threshold, resolution.
//!
//! Two static models are held against the straight line: *subtractive*, D = sgn(x)·max(|x| − δ, 0), and *gap*,
//! D = x·[|x| > δ], each about a centre that is fitted too, for the zone lies where the unit believes to be at rest. The
//! half width δ has the interval of its profile likelihood over the means of the rates with their covariance.

use super::model::Response;
use crate::estimate::{Estimate, Spread, UpperLimit, normal_quantile};
use crate::text::{Arg, Note};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Ids that this evaluation gives.
pub const IDS: &[&str] = &["dead_zone", "threshold", "resolution"];

const METHOD: &str = "profile_likelihood";

/// Half widths tried, up to a part of half the range of the rates.
const WIDTHS: usize = 160;

/// Centres tried.
const CENTRES: usize = 41;

/// Fall of −2 ln L by which a zone is claimed: a line is that unlikely in one test of a thousand. Width and centre were
/// sought for two kinds.
const CLAIMED_FROM: f64 = 18.0;

/// Normal score of the ends of a stretch that is all as likely: an interval of 95 % holds it.
const EDGE_SCORE: f64 = 1.96;

/// Kind of a dead zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The output is short by the half width.
    Subtractive,
    /// The output is none inside and whole outside.
    Gap,
}

impl Kind {
    fn of(self, x: f64, delta: f64) -> f64 {
        match self {
            Kind::Subtractive => x.signum() * (x.abs() - delta).max(0.0),
            Kind::Gap => {
                if x.abs() > delta {
                    x
                } else {
                    0.0
                }
            }
        }
    }
}

/// What the small rates show.
#[derive(Debug, Clone)]
pub struct DeadZone {
    /// Channel.
    pub channel: String,
    /// The better kind.
    pub kind: Kind,
    /// Its half width, deg/h, where one is shown.
    pub half_width: Option<f64>,
    /// Centre of the zone on the scale of the table rate, deg/h.
    pub centre: f64,
    /// Output per input outside.
    pub slope: f64,
    /// Output at the centre, deg/h.
    pub offset: f64,
    /// (normal score, half width), ascending.
    curve: Vec<(f64, f64)>,
    /// Upper bound of 95 %, deg/h.
    bound: f64,
    /// Smallest change of rate that the output followed by half, deg/h.
    resolution: Option<f64>,
    /// Points: rate, output, standard uncertainty, deg/h.
    pub points: Vec<(f64, f64, f64)>,
}

struct Points {
    x: Vec<f64>,
    /// Output about its mean slope times rate.
    y: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Points {
    /// −2 ln L, slope and offset of a response given up to slope and offset.
    fn cost(&self, d: impl Fn(f64) -> f64) -> (f64, f64, f64) {
        let n = self.x.len();
        let a = DMatrix::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { d(self.x[i]) });
        let l = self.factor.l_dirty();
        let (Some(wa), Some(wy)) = (l.solve_lower_triangular(&a), l.solve_lower_triangular(&self.y)) else {
            return (f64::INFINITY, 0.0, 0.0);
        };
        let Some(normal) = Cholesky::new(wa.transpose() * &wa) else { return (f64::INFINITY, 0.0, 0.0) };
        let b = normal.solve(&(wa.transpose() * &wy));
        ((wy - wa * &b).norm_squared(), b[1], b[0])
    }
}

/// Evaluates the response of a channel; `None` with fewer than five rates.
pub fn evaluate(response: &Response, channel: &str) -> Option<DeadZone> {
    let x = response.levels.clone();
    let n = x.len();
    if n < 5 {
        return None;
    }
    let mut covariance = response.level_covariance();
    let floor = 1e-9 * (covariance.trace() / n as f64).max(f64::MIN_POSITIVE);
    for i in 0..n {
        covariance[(i, i)] += floor;
    }
    let y =
        DVector::from_iterator(n, response.level_means().iter().zip(&x).map(|(m, x)| m + response.slope * x));
    let sigma: Vec<f64> = (0..n).map(|i| covariance[(i, i)].sqrt()).collect();
    let points = Points { factor: Cholesky::new(covariance)?, x: x.clone(), y: y.clone() };
    let (line, _, _) = points.cost(|x| x);
    let (low, high) = (
        x.iter().copied().fold(f64::INFINITY, f64::min),
        x.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    );
    let (middle, largest) = (0.5 * (low + high), 0.5 * (high - low));
    // The centre is sought where the inner half of the rates lies.
    let centres: Vec<f64> = (0..CENTRES)
        .map(|i| middle + 0.5 * largest * (2.0 * i as f64 / (CENTRES - 1) as f64 - 1.0))
        .collect();
    let widths: Vec<f64> =
        (0..WIDTHS).map(|i| 0.7 * largest * (i as f64 / (WIDTHS - 1) as f64).powi(2)).collect();
    // Profile over centre, slope and offset: (cost, centre, slope, offset) of every width.
    let profile = |kind: Kind| -> Vec<(f64, f64, f64, f64)> {
        widths
            .iter()
            .map(|w| {
                let at = |c: f64| {
                    let (cost, slope, offset) = points.cost(|x| kind.of(x - c, *w));
                    (cost, c, slope, offset)
                };
                let coarse = centres.iter().map(|c| at(*c)).min_by(|a, b| a.0.total_cmp(&b.0));
                let Some(mut best) = coarse else { return (f64::INFINITY, 0.0, 0.0, 0.0) };
                let mut step = 0.5 * largest / (CENTRES - 1) as f64;
                for _ in 0..6 {
                    for c in [best.1 - step, best.1 + step] {
                        let tried = at(c);
                        if tried.0 < best.0 {
                            best = tried;
                        }
                    }
                    step *= 0.5;
                }
                best
            })
            .collect()
    };
    let both = [Kind::Subtractive, Kind::Gap].map(|k| (k, profile(k)));
    let least = |p: &[(f64, f64, f64, f64)]| p.iter().map(|v| v.0).fold(f64::INFINITY, f64::min);
    let (kind, chosen) = if least(&both[0].1) <= least(&both[1].1) { &both[0] } else { &both[1] };
    let best = (0..WIDTHS).min_by(|a, b| chosen[*a].0.total_cmp(&chosen[*b].0))?;
    let lowest = chosen[best].0;
    let shown = line - lowest > CLAIMED_FROM;
    // A bound holds for the kind that allows the wider zone.
    let bound_of = |profile: &[(f64, f64, f64, f64)]| {
        let lowest = least(profile);
        let z = normal_quantile(0.95);
        let last = (0..WIDTHS).rev().find(|i| profile[*i].0 <= lowest + z * z).unwrap_or(0);
        widths[(last + 1).min(WIDTHS - 1)]
    };
    let bound = bound_of(&both[0].1).max(bound_of(&both[1].1));
    // Between two rates of the test the edge of a gap moves nothing: all of that stretch is as likely.
    let alike = |i: &usize| chosen[*i].0 <= lowest + 0.2;
    let first = (0..=best).rev().take_while(alike).last().unwrap_or(best);
    let end = (best..WIDTHS).take_while(alike).last().unwrap_or(best);
    let flat = if end > first + 3 { EDGE_SCORE } else { 0.0 };
    let value = if flat > 0.0 { 0.5 * (widths[first] + widths[end]) } else { widths[best] };
    let mut curve: Vec<(f64, f64)> = Vec::new();
    for (i, w) in widths.iter().enumerate() {
        let away = (chosen[i].0 - lowest).max(0.0) + flat * flat;
        let z = if flat > 0.0 && (first..=end).contains(&i) {
            flat * (2.0 * (w - widths[first]) / (widths[end] - widths[first]) - 1.0)
        } else if i < best {
            -away.sqrt()
        } else {
            away.sqrt()
        };
        if curve.last().is_none_or(|(last, _)| z > *last + 1e-9) {
            curve.push((z, *w));
        }
    }
    let (_, centre, slope, offset) = chosen[best];
    Some(DeadZone {
        channel: channel.to_owned(),
        kind: *kind,
        half_width: shown.then_some(value),
        centre,
        slope,
        offset,
        curve,
        bound,
        resolution: resolution(response, slope),
        points: (0..n).map(|i| (x[i], y[i], sigma[i])).collect(),
    })
}

/// The smallest difference of neighbouring rates that the output followed by half, shown with 95 %.
fn resolution(response: &Response, slope: f64) -> Option<f64> {
    let x = &response.levels;
    let mut least: Option<f64> = None;
    for i in 1..x.len() {
        let change = x[i] - x[i - 1];
        let mut weights = vec![0.0; x.len()];
        (weights[i], weights[i - 1]) = (1.0, -1.0);
        let found = response.of_levels(&weights);
        let followed = found.value + response.slope * change;
        let low = followed / slope - 1.645 * (found.standard / slope).abs();
        if low >= 0.5 * change && least.is_none_or(|l| change < l) {
            least = Some(change);
        }
    }
    least
}

impl DeadZone {
    /// The estimate of one id; `None` for an id that is not given here.
    pub fn estimate(&self, id: &'static str, unit: &'static str) -> Option<Estimate> {
        // A subtractive zone lets half through at twice its width, a gap everything at its edge.
        let times = match (id, self.kind) {
            ("dead_zone", _) => 1.0,
            ("threshold", Kind::Subtractive) => 2.0,
            ("threshold", Kind::Gap) => 1.0,
            ("resolution", _) => {
                let limit = self.resolution.map(|value| UpperLimit { value, coverage: 0.95 });
                return Some(
                    Estimate::not_identifiable(id, &self.channel, limit, unit, "smallest_step_shown")
                        .note(Note::new("dead_zone.resolution")),
                );
            }
            _ => return None,
        };
        let key = match self.kind {
            Kind::Subtractive => "dead_zone.subtractive",
            Kind::Gap => "dead_zone.gap",
        };
        Some(match self.half_width {
            Some(value) => {
                let curve = self.curve.iter().map(|(z, v)| (*z, v * times)).collect();
                Estimate::measured(id, &self.channel, value * times, unit, Spread::Curve(curve), METHOD)
                    .note(Note::new(key).with("centre", Arg::figures(self.centre, 3)))
            }
            None => {
                // Half of the input comes through at twice the half width at the latest.
                let value = if id == "threshold" { 2.0 * self.bound } else { self.bound };
                Estimate::not_identifiable(
                    id,
                    &self.channel,
                    Some(UpperLimit { value, coverage: 0.95 }),
                    unit,
                    METHOD,
                )
            }
        })
    }

    /// The fitted response at a rate, deg/h.
    pub fn at(&self, rate: f64) -> f64 {
        let delta = self.half_width.unwrap_or(0.0);
        self.offset + self.slope * self.kind.of(rate - self.centre, delta)
    }
}
