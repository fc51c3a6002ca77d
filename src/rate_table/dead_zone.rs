//! Response to rates near zero: dead zone, threshold, resolution.
//!
//! Two static models are held against the straight line: *subtractive*, D = sgn(x)·max(|x| − δ, 0), and *gap*,
//! D = x·[|x| > δ], each about a centre that is fitted too, for the zone lies where the unit believes to be at rest. The
//! half width δ has the interval of its likelihood over the means of the rates with their covariance, slope and offset at
//! their best, centre and kind averaged over.
//!
//! Outside a zone the output follows the rate by the scale factor. What a test of scale factor said of it may be used: a
//! line that may have any slope takes up most of a small zone. A zone is claimed when a line with the noise of this test
//! would gain as much from a zone in less than one test of a hundred; draws tell.

use super::Setup;
use super::model::Response;
use crate::estimate::{Estimate, Spread, UpperLimit, normal_quantile};
use crate::text::{Arg, Note};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Ids that this evaluation gives.
pub const IDS: &[&str] = &["dead_zone", "threshold", "resolution"];

const METHOD: &str = "profile_likelihood";

/// Half widths tried, up to a part of half the range of the rates.
const WIDTHS: usize = 160;

/// Centres tried.
const CENTRES: usize = 41;

/// Probability of such a gain by chance above which a zone is not claimed.
const CLAIMED_BELOW: f64 = 0.01;

/// Gains of −2 ln L below and above which no draws are needed.
const SURE: (f64, f64) = (6.0, 40.0);

/// Tests without a zone that are drawn to tell it.
const DRAWS: usize = 1000;

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

/// What one half width leaves.
#[derive(Debug, Clone, Copy)]
struct Width {
    kind: Kind,
    /// −2 ln L at the best centre.
    least: f64,
    /// That centre, and slope and offset there.
    centre: f64,
    slope: f64,
    offset: f64,
    /// −2 ln of the mean likelihood over all centres: at its best centre a zone of any width follows the noise.
    over_centres: f64,
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
    /// Relative standard uncertainty of the scale factor outside, where it was used.
    scale_factor_known: Option<f64>,
    /// Points: rate, output, standard uncertainty, deg/h.
    pub points: Vec<(f64, f64, f64)>,
}

struct Points {
    x: Vec<f64>,
    /// Output about its mean slope times rate.
    y: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    /// Relative standard uncertainty of the scale factor about the nominal one, where it is known.
    slope_known: Option<f64>,
}

impl Points {
    /// Offset and response, each over its standard uncertainty and free of correlation; what is known of the slope is one
    /// more row.
    fn design(&self, d: impl Fn(f64) -> f64) -> Option<DMatrix<f64>> {
        let n = self.x.len();
        let a = DMatrix::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { d(self.x[i]) });
        let w = self.factor.l_dirty().solve_lower_triangular(&a)?;
        let known = self.slope_known.map_or(0.0, |u| 1.0 / u);
        Some(w.insert_row(n, 0.0)).map(|mut w| {
            w[(n, 1)] = known;
            w
        })
    }

    fn data(&self) -> Option<DVector<f64>> {
        let w = self.factor.l_dirty().solve_lower_triangular(&self.y)?;
        Some(w.push(self.slope_known.map_or(0.0, |u| 1.0 / u)))
    }

    /// −2 ln L, slope and offset of a response given up to slope and offset.
    fn cost(&self, d: impl Fn(f64) -> f64) -> (f64, f64, f64) {
        let (Some(wa), Some(wy)) = (self.design(d), self.data()) else {
            return (f64::INFINITY, 0.0, 0.0);
        };
        let Some(normal) = Cholesky::new(wa.transpose() * &wa) else {
            return (f64::INFINITY, 0.0, 0.0);
        };
        let b = normal.solve(&(wa.transpose() * &wy));
        ((wy - wa * &b).norm_squared(), b[1], b[0])
    }
}

impl Points {
    /// Whether a line would gain as much from some zone by chance in too few tests to be believed.
    fn shows_a_zone(&self, gain: f64, (widths, middle, largest): (&[f64], f64, f64)) -> Option<bool> {
        if gain < SURE.0 || gain > SURE.1 {
            return Some(gain > SURE.1);
        }
        let line = self.design(|x| x)?;
        let data = self.data()?;
        let rows = data.len();
        let normal = Cholesky::new(line.transpose() * &line)?;
        let fitted = &line * normal.solve(&(line.transpose() * &data));
        let basis = |a: DMatrix<f64>| -> Option<[DVector<f64>; 2]> {
            let first = a.column(0).clone_owned().try_normalize(0.0)?;
            let rest = a.column(1) - &first * first.dot(&a.column(1));
            Some([first, rest.try_normalize(1e-12)?])
        };
        let of_line = basis(line)?;
        // Centres as close as the search takes them, every fourth width.
        let fine = 4 * (CENTRES - 1);
        let centre = |i: usize| middle + 0.5 * largest * (2.0 * i as f64 / fine as f64 - 1.0);
        let of_zones: Vec<_> = [Kind::Subtractive, Kind::Gap]
            .into_iter()
            .flat_map(|k| widths.iter().skip(1).step_by(4).map(move |w| (k, *w)))
            .flat_map(|(k, w)| (0..=fine).map(move |i| (k, w, centre(i))))
            .filter_map(|(k, w, c)| basis(self.design(|x| k.of(x - c, w))?))
            .collect();
        let explained =
            |b: &[DVector<f64>; 2], r: &DVector<f64>| b.iter().map(|q| q.dot(r).powi(2)).sum::<f64>();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x7a6f_6e65);
        let free = rows - usize::from(self.slope_known.is_none());
        let most = (CLAIMED_BELOW * DRAWS as f64) as usize;
        let mut as_large = 0;
        for _ in 0..DRAWS {
            let mut r = fitted.clone();
            for v in r.iter_mut().take(free) {
                let z: f64 = StandardNormal.sample(&mut rng);
                *v += z;
            }
            let enough = gain + explained(&of_line, &r);
            as_large += usize::from(of_zones.iter().any(|b| explained(b, &r) >= enough));
            if as_large >= most {
                return Some(false);
            }
        }
        Some(true)
    }
}

/// Evaluates the response of a channel; `None` with fewer than five rates.
pub fn evaluate(response: &Response, channel: &str, setup: &Setup) -> Option<DeadZone> {
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
    let points = Points {
        factor: Cholesky::new(covariance)?,
        x: x.clone(),
        y: y.clone(),
        slope_known: setup.scale_factor_uncertainty,
    };
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
    let profile = |kind: Kind| -> Vec<Width> {
        widths
            .iter()
            .map(|w| {
                let at = |c: f64| {
                    let (cost, slope, offset) = points.cost(|x| kind.of(x - c, *w));
                    (cost, c, slope, offset)
                };
                let mut tried: Vec<(f64, f64, f64, f64)> = centres.iter().map(|c| at(*c)).collect();
                let least = |t: &[(f64, f64, f64, f64)]| {
                    t.iter()
                        .copied()
                        .fold((f64::INFINITY, 0.0, 0.0, 0.0), |m, v| if v.0 < m.0 { v } else { m })
                };
                let mut step = 0.5 * largest / (CENTRES - 1) as f64;
                for _ in 0..6 {
                    let middle = least(&tried).1;
                    tried.extend([middle - step, middle + step].map(at));
                    step *= 0.5;
                }
                let best = least(&tried);
                tried.sort_by(|a, b| a.1.total_cmp(&b.1));
                let weight = |v: &(f64, f64, f64, f64)| (-0.5 * (v.0 - best.0)).exp();
                let area: f64 =
                    tried.windows(2).map(|p| 0.5 * (weight(&p[0]) + weight(&p[1])) * (p[1].1 - p[0].1)).sum();
                let over_centres = best.0 - 2.0 * (area / largest).max(f64::MIN_POSITIVE).ln();
                Width { kind, least: best.0, centre: best.1, slope: best.2, offset: best.3, over_centres }
            })
            .collect()
    };
    let both = [Kind::Subtractive, Kind::Gap].map(profile);
    let least = |p: &[Width]| p.iter().map(|v| v.over_centres).fold(f64::INFINITY, f64::min);
    let gain = line - both.iter().flatten().map(|v| v.least).fold(f64::INFINITY, f64::min);
    // Which kind it is, is not known either.
    let costs: Vec<f64> = (0..WIDTHS)
        .map(|i| {
            let [a, b] = [both[0][i].over_centres, both[1][i].over_centres];
            a.min(b) - 2.0 * (0.5 + 0.5 * (-0.5 * (a - b).abs()).exp()).ln()
        })
        .collect();
    let cost = |i: usize| costs[i];
    let best = (0..WIDTHS).min_by(|a, b| cost(*a).total_cmp(&cost(*b)))?;
    let chosen =
        if both[0][best].over_centres <= both[1][best].over_centres { both[0][best] } else { both[1][best] };
    let lowest = cost(best);
    let shown = points.shows_a_zone(gain, (&widths, middle, largest))?;
    // A bound holds for the kind that allows the wider zone.
    let bound_of = |profile: &[Width]| {
        let lowest = least(profile);
        let z = normal_quantile(0.95);
        let last = (0..WIDTHS).rev().find(|i| profile[*i].over_centres <= lowest + z * z).unwrap_or(0);
        widths[(last + 1).min(WIDTHS - 1)]
    };
    let bound = bound_of(&both[0]).max(bound_of(&both[1]));
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
    let Width { kind, centre, slope, offset, .. } = chosen;
    Some(DeadZone {
        channel: channel.to_owned(),
        kind,
        half_width: shown.then_some(value),
        centre,
        slope,
        offset,
        curve,
        bound,
        resolution: resolution(response, slope),
        scale_factor_known: setup.scale_factor_uncertainty,
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
        let known = |e: Estimate| match self.scale_factor_known {
            Some(u) => {
                e.note(Note::new("dead_zone_known.scale_factor").with("ppm", Arg::figures(1e6 * u, 3)))
            }
            None => e,
        };
        Some(known(match self.half_width {
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
        }))
    }

    /// The fitted response at a rate, deg/h.
    pub fn at(&self, rate: f64) -> f64 {
        let delta = self.half_width.unwrap_or(0.0);
        self.offset + self.slope * self.kind.of(rate - self.centre, delta)
    }
}
