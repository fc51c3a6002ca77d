//! The response to rates near zero of one channel, and one curve for a quantity whose form is not known: it holds what each
//! of the forms that fit holds.

use super::about;
use super::chance;
use super::fits::{FITS_FROM, Fits};
use super::points::{Left, Points};
use super::rounded::{self, Rounded, SHOWN_FROM};
use super::shape::{Kind, Shape};
use super::widths::{FORM_COUNT, WITH_NOISE, Widths};
use crate::estimate::{SCORE_ONE_SIDED_95, Spread};
use crate::numeric::order::SortByNumber;
use crate::rate_table::design::Design;
use crate::rate_table::model::Response;
use crate::rate_table::setup::Setup;
use crate::rate_table::steps::Steps;
use nalgebra::{DMatrix, DVector};

/// Share of a change of rate that the output has to stay below inside a dead zone (IEEE Std 528).
const SILENT_BELOW: f64 = 0.1;

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
    pub(crate) shape: Shape,
    /// (normal score, half width), ascending; of all forms that fit.
    pub(crate) curve: Vec<(f64, f64)>,
    /// Upper bounds of 95 % of half width and threshold, deg/h.
    pub(crate) bound: (f64, f64),
    /// Probability that chance leaves as much of the best form, where none fits.
    pub(crate) unexplained: Option<f64>,
    /// Largest half width tried, deg/h, where the zone may be wider.
    pub(crate) open: Option<f64>,
    /// Forms that fit beside the one that is drawn.
    pub(crate) others: usize,
    /// Zone with noise inside the loop, where that is shown.
    pub(crate) rounded: Option<Rounded>,
    /// Share of the smallest rates that the noise inside the loop lets through, where it is too much for a dead zone, and
    /// what one is at most, where that share may be less.
    pub(crate) follows: Option<(f64, Option<f64>)>,
    /// (normal score, input at which half comes through), ascending; of all forms that fit.
    pub(crate) threshold: Vec<(f64, f64)>,
    /// Upper bound of 95 % of the noise inside the loop where it is not shown, deg/h.
    pub(crate) noise_bound: Option<f64>,
    /// Smallest rate beside the middle of the test, and the widest distance of neighbours where a zone was looked for, deg/h,
    /// where what fits between rates makes the bound.
    pub(crate) between: Option<(f64, f64)>,
    /// Smallest change of rate outside the zone that the output followed by half wherever it was tried, deg/h.
    pub(crate) resolution: Option<f64>,
    /// Relative standard uncertainty of the scale factor outside, where it was used.
    pub(crate) scale_factor_known: Option<f64>,
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
    let (line, line_slope, _) = points.cost(|x| x);
    let widths = Widths::new(&points)?;
    let gain = line - widths.least_clean();
    let known = setup.scale_factor_uncertainty;
    let shown = chance::shows_a_zone(&about, known, |m, v| Some(made(m, v)?.0), gain, widths.tried())?;
    let fits = Fits::new(&design, about.white, known.is_some(), |m, v| Some(made(m, v)?.0))?;
    let closer = if shown { rounded::closer(&points, &widths.with_noise) } else { None };
    let with_noise = closer.as_ref().filter(|r| r.shown(widths.least_clean()));
    let forms = forms(&widths, closer.as_ref(), &fits);
    let explained = forms.iter().map(|f| f.chance).chain([fits.of_line()].into_iter().filter(|_| !shown));
    let unexplained = Some(explained.fold(0.0, f64::max)).filter(|p| *p < FITS_FROM);
    let alike: Vec<&Form> = forms.iter().filter(|f| f.chance >= FITS_FROM || unexplained.is_some()).collect();
    let best = alike.first().map_or(forms.first()?.left, |f| f.left);
    let (curve, threshold) = curves(&widths, &alike, closer.as_ref(), with_noise);
    let Left { mut shape, centre, slope, offset, .. } = with_noise.map_or(best, |r| r.best);
    let open = if with_noise.is_some() { None } else { open(&widths, &alike, shown) };
    let value = Some(median(&curve)).filter(|_| shown && unexplained.is_none() && open.is_none());
    shape.half_width = value.unwrap_or(0.0);
    let follows = with_noise.and_then(follows);
    let rounds = alike.iter().any(|f| f.number == WITH_NOISE);
    let bound = (widths.bound(), widths.bound_of_threshold());
    let zone = match (value, unexplained) {
        (_, Some(_)) => 0.0,
        _ if open.is_some() => f64::INFINITY,
        (None, _) => bound.1,
        (Some(_), _) => Spread::Curve(threshold.clone()).bound(0.0, 0.95).unwrap_or(0.0),
    };
    Some(DeadZone {
        channel: channel.to_owned(),
        half_width: value.filter(|_| follows.is_none()),
        centre,
        slope,
        offset,
        shape,
        curve,
        bound,
        unexplained,
        open,
        others: alike.len().saturating_sub(1),
        between: widths.bounded_by_a_gap().then(|| points.spacing()),
        noise_bound: closer.as_ref().filter(|_| rounds).map(|r| r.bound(widths.least_clean_over_centres())),
        rounded: with_noise.filter(|_| unexplained.is_none()).cloned(),
        follows,
        threshold,
        resolution: resolution(response, line_slope, (centre, zone)),
        scale_factor_known: setup.scale_factor_uncertainty,
        points: of_points,
    })
}

/// The curves of half width and threshold, (normal score, value) ascending: those of a zone with noise inside the loop where
/// that is shown, else covering all forms that fit alike.
fn curves(
    widths: &Widths,
    alike: &[&Form],
    closer: Option<&Rounded>,
    with_noise: Option<&Rounded>,
) -> (Curve, Curve) {
    if let Some(r) = with_noise {
        return (r.half_width.clone(), r.threshold.clone());
    }
    let curves: Vec<Curve> = alike.iter().map(|f| widths.curve(f.number)).collect();
    let thresholds: Vec<Curve> = alike.iter().zip(&curves).map(|(f, c)| f.threshold(c, closer)).collect();
    (covering(&curves), covering(&thresholds))
}

/// Largest half width tried, deg/h, where the zone may be wider. Noise far beyond the half width makes a line of any zone:
/// that form is never told from a slope, and does not count.
fn open(widths: &Widths, alike: &[&Form], shown: bool) -> Option<f64> {
    if shown {
        alike.iter().filter(|f| f.number != WITH_NOISE).find_map(|f| widths.open(f.number))
    } else {
        (0..WITH_NOISE).find_map(|form| widths.open(form))
    }
}

/// Pairs of (normal score, value), ascending.
type Curve = Vec<(f64, f64)>;

/// A form that explains the means nearly as well as the best one.
struct Form {
    number: usize,
    /// Its best zone.
    left: Left,
    /// Probability that chance leaves as much.
    chance: f64,
}

impl Form {
    /// The curve of the threshold from that of the half width.
    fn threshold(&self, curve: &[(f64, f64)], closer: Option<&Rounded>) -> Vec<(f64, f64)> {
        match (Kind::NOISE_FREE.get(self.number), closer) {
            (None, Some(r)) => r.threshold.clone(),
            (kind, _) => {
                let times = kind.map_or(2.0, |k| k.threshold_over_width());
                curve.iter().map(|(z, w)| (*z, times * w)).collect()
            }
        }
    }
}

/// The forms that the means do not tell from the best one, that first.
fn forms(widths: &Widths, closer: Option<&Rounded>, fits: &Fits) -> Vec<Form> {
    let of_noise = || {
        let coarse = widths.with_noise.iter().min_by(|a, b| a.least.total_cmp(&b.least)).copied();
        closer.map(|r| r.best).into_iter().chain(coarse).min_by(|a, b| a.least.total_cmp(&b.least))
    };
    let left = |form: usize| if form == WITH_NOISE { of_noise() } else { widths.best(form).copied() };
    let mut all: Vec<(usize, Left)> = (0..FORM_COUNT).filter_map(|form| Some((form, left(form)?))).collect();
    all.sort_ascending_by(|a| a.1.least);
    let least = all.first().map_or(f64::INFINITY, |f| f.1.least);
    all.retain(|f| f.1.least <= least + SHOWN_FROM);
    all.into_iter()
        .map(|(number, left)| {
            // Where the edge of a gap lies between two rates, neither it nor the centre moves anything.
            let unknowns = if number == WITH_NOISE {
                3.0
            } else if left.shape.kind == Kind::Gap {
                1.0
            } else {
                2.0
            };
            Form { number, left, chance: fits.of_zone(left.shape, left.centre, unknowns) }
        })
        .collect()
}

/// Share of the smallest rates that noise inside the loop lets through, where it is too much for a dead zone; with what one
/// is at most, unless the share is too much for the widest zone and the least noise that the test allows.
fn follows(zone: &Rounded) -> Option<(f64, Option<f64>)> {
    let share = zone.best.shape.at_null();
    let half_width = Spread::Curve(zone.half_width.clone()).bound(0.0, 0.95)?;
    let noise = Spread::Curve(zone.noise.clone()).bound(0.0, 0.05)?;
    let least = Shape { kind: Kind::Rounded, half_width, noise: noise.max(f64::MIN_POSITIVE) }.at_null();
    (share >= SILENT_BELOW).then(|| (share, Some(half_width).filter(|_| least < SILENT_BELOW)))
}

/// The median of a curve.
pub fn median(curve: &[(f64, f64)]) -> f64 {
    Spread::Curve(curve.to_vec()).bound(0.0, 0.5).unwrap_or(0.0)
}

/// The smallest difference of rates that the output followed by half, shown with 95 %, wherever the test has it beyond a
/// distance from a centre: what is followed in one place only is followed by chance, or by the grid of a read-out. The
/// distance of neighbouring rates is added, for the steps of a read-out may lie anywhere between them.
fn resolution(response: &Response, slope: f64, (centre, beyond): (f64, f64)) -> Option<f64> {
    let x = &response.levels;
    let followed = |i: usize, j: usize| {
        let mut weights = vec![0.0; x.len()];
        (weights[j], weights[i]) = (1.0, -1.0);
        let found = response.of_levels(&weights);
        let change = x[j] - x[i];
        let low = (found.value + response.slope * change) / slope
            - SCORE_ONE_SIDED_95 * (found.standard / slope).abs();
        low >= 0.5 * change
    };
    let outside = |i: usize, j: usize| x[i] - centre >= 0.999 * beyond || centre - x[j] >= 0.999 * beyond;
    (1..x.len()).find_map(|apart| {
        let pairs: Vec<(usize, usize)> =
            (0..x.len() - apart).map(|i| (i, i + apart)).filter(|(i, j)| outside(*i, *j)).collect();
        let all = pairs.len() >= 2 && pairs.iter().all(|(i, j)| followed(*i, *j));
        let between = x.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        all.then(|| between + pairs.iter().map(|(i, j)| x[*j] - x[*i]).fold(0.0, f64::max))
    })
}

impl DeadZone {
    /// The fitted response at a rate, deg/h.
    pub fn at(&self, rate: f64) -> f64 {
        self.offset + self.slope * self.shape.of(rate - self.centre)
    }
}

/// Normal score up to which curves are put together.
const MAX_SCORE: f64 = 4.0;
/// Number of scores at which they are.
const SCORE_COUNT: usize = 81;

/// The value at a normal score of (normal score, value), ascending; beyond the ends the ends.
fn at(curve: &[(f64, f64)], z: f64) -> f64 {
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else { return 0.0 };
    if z <= first.0 {
        return first.1;
    }
    if z >= last.0 {
        return last.1;
    }
    let i = curve.partition_point(|p| p.0 <= z);
    let (a, b) = (curve[i - 1], curve[i]);
    a.1 + (b.1 - a.1) * (z - a.0) / (b.0 - a.0).max(f64::MIN_POSITIVE)
}

/// The curve that at every confidence reaches as far as that of any form does, about the value of the first form.
pub fn covering(curves: &[Vec<(f64, f64)>]) -> Vec<(f64, f64)> {
    let Some(first) = curves.first() else { return vec![] };
    if curves.len() == 1 {
        return first.clone();
    }
    let middle = at(first, 0.0);
    (0..SCORE_COUNT)
        .map(|i| MAX_SCORE * (2.0 * i as f64 / (SCORE_COUNT - 1) as f64 - 1.0))
        .map(|z| {
            let values = curves.iter().map(|c| at(c, z));
            // A hair apart, for no stretch of a curve is level.
            let hair = 1e-9 * z * middle;
            if z < 0.0 {
                (z, values.fold(middle, f64::min) + hair)
            } else {
                (z, values.fold(middle, f64::max) + hair)
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_over_forms_reaches_as_far_as_each() {
        let normal = |middle: f64, u: f64| -> Vec<(f64, f64)> {
            (-40..=40).map(|i| (0.1 * f64::from(i), middle + 0.1 * u * f64::from(i))).collect()
        };
        let both = Spread::Curve(covering(&[normal(1.0, 0.1), normal(1.5, 0.2)]));
        let ends = |p: f64| both.bound(0.0, p).unwrap();
        assert!((ends(0.025) - 0.804).abs() < 1e-2 && (ends(0.975) - 1.892).abs() < 1e-2);
        assert!((ends(0.95) - 1.829).abs() < 1e-2);
        assert_eq!(covering(&[normal(1.0, 0.1)]), normal(1.0, 0.1));
    }
}
