//! Response to rates near zero: dead zone, threshold, resolution.
//!
//! Two static models are held against the straight line: *subtractive*, D = sgn(x)·max(|x| − δ, 0), and *gap*,
//! D = x·[|x| > δ], each about a centre that is fitted too, for the zone lies where the unit believes to be at rest. The
//! half width δ has the interval of its likelihood over the means of the rates with their covariance, slope and offset at
//! their best, kind averaged over and centre too, over the places where a unit is at rest and any other (`place`). The
//! noise is that about the zone that suits best (`about`), of all strengths that the test allows.
//!
//! Outside a zone the output follows the rate by the scale factor. What a test of scale factor said of it may be used: a
//! line that may have any slope takes up most of a small zone. A zone is claimed when a line with the noise of this test
//! would make zones as likely on the average in less than one test of a hundred, of four hundred where the slope is known;
//! draws tell (`chance`).
//!
//! Noise inside the loop carries the input in and out of the zone and rounds it off (*rounded*): the subtractive response
//! is averaged over normal noise σ. Where that fits better than any zone without noise, δ and σ are estimated together;
//! otherwise σ is bounded, and the interval of δ is averaged over it too.

mod about;
mod chance;
mod place;
mod points;
mod rounded;
mod shape;
mod widths;

use super::Setup;
use super::design::Design;
use super::model::Response;
use super::steps::Steps;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::text::{Arg, Note};
use nalgebra::{DMatrix, DVector};
use points::{Left, Points};
use rounded::Rounded;
use shape::{Kind, Shape};
use widths::Widths;

/// Ids that this evaluation gives.
pub const IDS: &[&str] = &["dead_zone", NOISE, "threshold", "resolution"];

/// Id of the noise inside the loop.
const NOISE: &str = "dead_zone_noise";

const METHOD: &str = "profile_likelihood";

/// Half widths tried, up to a part of half the range of the rates.
const WIDTHS: usize = 160;

/// What the small rates show.
#[derive(Debug, Clone)]
pub struct DeadZone {
    /// Channel.
    pub channel: String,
    /// Half width, deg/h, where a zone is shown.
    pub half_width: Option<f64>,
    /// Centre of the zone on the scale of the table rate, deg/h.
    pub centre: f64,
    /// Output per input outside.
    pub slope: f64,
    /// Output at the centre, deg/h.
    pub offset: f64,
    /// The zone that is drawn.
    shape: Shape,
    /// (normal score, half width), ascending.
    curve: Vec<(f64, f64)>,
    /// Upper bound of 95 %, deg/h.
    bound: f64,
    /// Zone with noise inside the loop, where that is shown.
    rounded: Option<Rounded>,
    /// (normal score, input at which half comes through), ascending; of all kinds where none is shown to be it.
    threshold: Vec<(f64, f64)>,
    /// Upper bound of 95 % of the noise inside the loop where it is not shown, deg/h.
    noise_bound: Option<f64>,
    /// Smallest rate beside the middle of the test, and the widest distance of neighbours where a zone was looked for, deg/h,
    /// where what fits between rates makes the bound.
    between: Option<(f64, f64)>,
    /// Smallest change of rate that the output followed by half, deg/h.
    resolution: Option<f64>,
    /// Relative standard uncertainty of the scale factor outside, where it was used.
    scale_factor_known: Option<f64>,
    /// Points: rate, output, standard uncertainty, deg/h.
    pub points: Vec<(f64, f64, f64)>,
}

/// Evaluates the response of the gyro of this number to the steps it was fitted to; `None` with fewer than five rates.
pub fn evaluate(
    steps: &Steps,
    gyro: usize,
    response: &Response,
    channel: &str,
    setup: &Setup,
) -> Option<DeadZone> {
    let x = &response.levels;
    let n = x.len();
    if n < 5 {
        return None;
    }
    let made = |means: &DVector<f64>, mut covariance: DMatrix<f64>| {
        let floor = 1e-9 * (covariance.trace() / n as f64).max(f64::MIN_POSITIVE);
        for i in 0..n {
            covariance[(i, i)] += floor;
        }
        let y = DVector::from_iterator(n, means.iter().zip(x).map(|(m, x)| m + response.slope * x));
        let shown = (0..n).map(|i| (x[i], y[i], covariance[(i, i)].sqrt())).collect();
        Some((Points::new(x.clone(), y, covariance, setup.scale_factor_uncertainty)?, shown))
    };
    let design = Design::new(steps, gyro, setup, &response.extras)?;
    let about = about::means(&design, |means, covariance| Some(made(means, covariance)?.0))?;
    let (points, of_points): (Points, Vec<_>) = made(&about.means, about.covariance.clone())?;
    let (line, _, _) = points.cost(|x| x);
    let widths = Widths::new(&points)?;
    let gain = line - widths.least_clean();
    let known = setup.scale_factor_uncertainty;
    let shown = chance::shows_a_zone(&about, known, |m, v| Some(made(m, v)?.0), gain, widths.tried())?;
    let closer = if shown { rounded::closer(&points, &widths.with_noise) } else { None };
    let with_noise = closer.as_ref().filter(|r| r.shown(widths.least_clean()));
    let (value, curve, Left { mut shape, centre, slope, offset, .. }) = match with_noise {
        Some(r) => (middle_of(&r.half_width), r.half_width.clone(), r.best),
        None => {
            let (value, curve) = widths.curve();
            (value, curve, widths.chosen())
        }
    };
    shape.half_width = if shown { value } else { 0.0 };
    // A subtractive zone lets half through at twice its width, a gap everything at its edge.
    let times = if shape.kind == Kind::Gap { 1.0 } else { 2.0 };
    let threshold = match (with_noise, &closer) {
        (Some(r), _) => r.threshold.clone(),
        (None, Some(r)) => {
            let clean: Vec<(f64, f64)> = curve.iter().map(|(z, w)| (*z, times * w)).collect();
            rounded::mixture(&clean, &r.threshold, widths.share_with_noise())
        }
        (None, None) => curve.iter().map(|(z, w)| (*z, times * w)).collect(),
    };
    Some(DeadZone {
        channel: channel.to_owned(),
        half_width: shown.then_some(value),
        centre,
        slope,
        offset,
        shape,
        curve,
        bound: widths.bound(),
        between: widths.bounded_by_a_gap().then(|| points.spacing()),
        noise_bound: closer.as_ref().map(|r| r.bound(widths.least_clean_over_centres())),
        rounded: with_noise.cloned(),
        threshold,
        resolution: resolution(response, slope),
        scale_factor_known: setup.scale_factor_uncertainty,
        points: of_points,
    })
}

/// The median of a curve.
fn middle_of(curve: &[(f64, f64)]) -> f64 {
    Spread::Curve(curve.to_vec()).bound(0.0, 0.5).unwrap_or(0.0)
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
        let found = match id {
            "dead_zone" => match self.half_width {
                Some(value) => self.of_zone(id, unit, value, &self.curve),
                None => self.bounded(id, unit, self.bound),
            },
            // What is not shown lets half through at twice the half width at the latest.
            "threshold" if self.half_width.is_none() => self.bounded(id, unit, 2.0 * self.bound),
            "threshold" if middle_of(&self.threshold) <= 0.0 => {
                let value = Spread::Curve(self.threshold.clone()).bound(0.0, 0.95).unwrap_or(0.0);
                self.at_most(id, unit, Some(value)).note(Note::new("dead_zone_noise.half_of_any"))
            }
            "threshold" => self.of_zone(id, unit, middle_of(&self.threshold), &self.threshold),
            NOISE => self.noise(unit),
            "resolution" => {
                let limit = self.resolution.map(|value| UpperLimit { value, coverage: 0.95 });
                return Some(
                    Estimate::not_identifiable(id, &self.channel, limit, unit, "smallest_step_shown")
                        .note(Note::new("dead_zone.resolution")),
                );
            }
            _ => return None,
        };
        Some(match self.scale_factor_known {
            Some(u) => {
                found.note(Note::new("dead_zone_known.scale_factor").with("ppm", Arg::figures(1e6 * u, 3)))
            }
            None => found,
        })
    }

    /// What a zone that is not shown is at most, and what would show less.
    fn bounded(&self, id: &'static str, unit: &'static str, value: f64) -> Estimate {
        let found = self.at_most(id, unit, Some(value));
        match self.between {
            Some((smallest, apart)) => found.note(
                Note::new("dead_zone_noise.between_rates")
                    .with("smallest", Arg::figures(smallest, 2))
                    .with("apart", Arg::figures(apart, 2)),
            ),
            None => found,
        }
    }

    fn at_most(&self, id: &'static str, unit: &'static str, value: Option<f64>) -> Estimate {
        let limit = value.map(|value| UpperLimit { value, coverage: 0.95 });
        Estimate::not_identifiable(id, &self.channel, limit, unit, METHOD)
    }

    /// What a zone that is shown has.
    fn of_zone(&self, id: &'static str, unit: &'static str, value: f64, curve: &[(f64, f64)]) -> Estimate {
        let key = match self.shape.kind {
            Kind::Subtractive => "dead_zone.subtractive",
            Kind::Gap => "dead_zone.gap",
            Kind::Rounded => "dead_zone_noise.rounded",
        };
        Estimate::measured(id, &self.channel, value, unit, Spread::Curve(curve.to_vec()), METHOD)
            .note(Note::new(key).with("centre", Arg::figures(self.centre, 3)))
    }

    /// The noise inside the loop.
    fn noise(&self, unit: &'static str) -> Estimate {
        match &self.rounded {
            Some(r) => {
                let spread = Spread::Curve(r.noise.clone());
                Estimate::measured(NOISE, &self.channel, middle_of(&r.noise), unit, spread, METHOD)
                    .note(Note::new("dead_zone_noise.shown"))
            }
            None if self.half_width.is_some() => {
                self.at_most(NOISE, unit, self.noise_bound).note(Note::new("dead_zone_noise.not_shown"))
            }
            None => self.at_most(NOISE, unit, None).note(Note::new("dead_zone_noise.no_zone")),
        }
    }

    /// The fitted response at a rate, deg/h.
    pub fn at(&self, rate: f64) -> f64 {
        self.offset + self.slope * self.shape.of(rate - self.centre)
    }
}
