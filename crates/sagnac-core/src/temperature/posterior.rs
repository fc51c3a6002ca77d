//! The model of a record over temperature, with everything that is not known of it.
//!
//! Coefficients are linear and integrated out; lag, play, B and K are sampled. Intervals are those of the mixture, so
//! that what is not known of the noise and of the shape widens them.

use super::course::{Course, Shape, Span, Terms};
use super::gls::{Fitted, Modes, Solved};
use super::lag::{self, AtLag, Profile};
use super::sampler::{self, Draw, Range};
use nalgebra::{DMatrix, DVector};

/// A fitted model with draws from its posterior distribution.
#[derive(Debug, Clone)]
pub struct Posterior {
    /// Terms.
    pub terms: Terms,
    /// Temperatures of the polynomial.
    pub span: Span,
    /// The fit of maximum likelihood.
    pub best: Best,
    /// States, equally weighted.
    pub draws: Vec<Draw>,
    /// What a part of the states says of every lag.
    pub lags: Vec<Profile>,
    /// Longest lag that was tried, s.
    pub longest_lag_s: f64,
}

/// The best fit.
#[derive(Debug, Clone)]
pub struct Best {
    /// Lag and play.
    pub shape: Shape,
    /// Noise and coefficients.
    pub fitted: Fitted,
}

/// Lags tried as a start, shares of the longest.
const START_LAG_SHARES: [f64; 10] = [0.0, 0.004, 0.012, 0.03, 0.06, 0.1, 0.18, 0.3, 0.5, 0.85];
/// Plays tried as a start, shares of the widest.
const START_PLAY_SHARES: [f64; 4] = [0.07, 0.2, 0.4, 0.8];
/// Range of the play, shares of the span.
const PLAY_RANGE: (f64, f64) = (0.005, 0.15);
/// Play that a body has over any span, degC, and the share of the span that it is not wider than.
const ANY_PLAY: (f64, f64) = (6.0, 0.3);
/// Longest lag that is thought of, s.
const LONGEST_LAG_S: f64 = 7200.0;

/// The longest lag that a record is searched for, s.
pub fn longest_lag_s(course: &Course) -> f64 {
    LONGEST_LAG_S.min(course.len() as f64 * course.block_s / 8.0)
}

/// Widest play, degC, over a span of so many degC.
fn widest_play(width: f64) -> f64 {
    (PLAY_RANGE.1 * width).max(ANY_PLAY.0.min(ANY_PLAY.1 * width))
}

struct Search<'a> {
    course: &'a Course,
    modes: Modes,
    data: Vec<f64>,
    terms: Terms,
    span: Span,
}

impl Search<'_> {
    fn columns(&self, shape: &Shape) -> Vec<Vec<f64>> {
        self.course.columns(&self.terms, shape, &self.span).iter().map(|c| self.modes.of(c)).collect()
    }

    fn solve(&self, shape: &Shape, noise: &[f64; 3]) -> Option<Solved> {
        self.modes.solve(&self.data, &self.columns(shape), noise)
    }
}

fn search<'a>(course: &'a Course, terms: Terms, span: Span) -> Search<'a> {
    let modes = Modes::new(course.len(), course.block_s);
    let data = modes.of(&course.rate_deg_h);
    Search { course, modes, data, terms, span }
}

/// The best fit of a model; `None` when the temperature does not let its terms be told apart at all.
pub fn best(course: &Course, terms: Terms, span: Span) -> Option<(Best, f64)> {
    let s = search(course, terms, span);
    let longest = longest_lag_s(course);
    let width = span.high - span.low;
    let play = |share: f64| share * widest_play(width);
    let start = Shape { lag_s: 0.03 * longest, play_deg_c: play(0.2) };
    let mut noise = s.modes.fit(&s.data, &s.columns(&start), None)?.noise;
    let plays: &[f64] = if terms.hysteresis { &START_PLAY_SHARES } else { &START_PLAY_SHARES[..1] };
    let mut found: Option<(f64, Shape)> = None;
    let mut without_lag = f64::NEG_INFINITY;
    for turn in 0..2 {
        found = None;
        without_lag = f64::NEG_INFINITY;
        for lag in START_LAG_SHARES {
            for p in plays {
                let shape = Shape { lag_s: lag * longest, play_deg_c: play(*p) };
                let Some(l) = s.solve(&shape, &noise).map(|s| s.log_likelihood) else { continue };
                if lag == 0.0 {
                    without_lag = without_lag.max(l);
                }
                if found.as_ref().is_none_or(|f| l > f.0) {
                    found = Some((l, shape));
                }
            }
        }
        let shape = found?.1;
        // Finer about the best.
        for factor in [0.75, 0.87, 1.15, 1.33] {
            let near = Shape { lag_s: (shape.lag_s * factor).min(longest), ..shape };
            if let Some(l) = s.solve(&near, &noise).map(|s| s.log_likelihood)
                && found.as_ref().is_none_or(|f| l > f.0)
            {
                found = Some((l, near));
            }
        }
        let shape = found?.1;
        if turn == 0 {
            noise = s.modes.fit(&s.data, &s.columns(&shape), Some(noise))?.noise;
        }
    }
    let (l, shape) = found?;
    let fitted = s.modes.fit(&s.data, &s.columns(&shape), Some(noise))?;
    Some((Best { shape, fitted }, 2.0 * (l - without_lag)))
}

/// Samples what is not known about a model.
pub fn sample(course: &Course, terms: Terms, span: Span, sweeps: usize) -> Option<Posterior> {
    let (best, _) = best(course, terms, span)?;
    let s = search(course, terms, span);
    let longest = longest_lag_s(course);
    let width = span.high - span.low;
    let mut ranges = vec![Range {
        low: 0.0,
        high: longest,
        log: false,
        step: (0.2 * best.shape.lag_s).max(0.01 * longest),
    }];
    let mut start = vec![best.shape.lag_s];
    if terms.hysteresis {
        let (low, high) = (PLAY_RANGE.0 * width, widest_play(width));
        ranges.push(Range { low, high, log: true, step: 0.5 });
        start.push(best.shape.play_deg_c.clamp(low, high));
    }
    let columns = |shape: &[f64]| s.columns(&Shape::of(shape, best.shape.play_deg_c));
    let model: (sampler::Columns<'_>, _) = (&columns, sampler::Coefficients::Flat);
    let draws = sampler::sample(&s.modes, &s.data, model, &ranges, (&start, &best.fitted), sweeps);
    if draws.is_empty() {
        return None;
    }
    let lags = lags(&s, &draws, longest, &best);
    Some(Posterior { terms, span, best, draws, lags, longest_lag_s: longest })
}

/// What a part of the states says of every lag, noise and play held.
fn lags(s: &Search<'_>, draws: &[Draw], longest: f64, best: &Best) -> Vec<Profile> {
    let play_deg_c = best.shape.play_deg_c;
    let profiled = |solved: &Solved| Some(solved.log_likelihood + 0.5 * solved.log_information()?);
    let grid = lag::grid(draws, longest, |lag_s| {
        profiled(&s.solve(&Shape { lag_s, play_deg_c }, &best.fitted.noise)?)
    });
    // All columns but that of the play are those of the lag alone.
    let apart = Terms { hysteresis: false, ..s.terms };
    let play = Terms { order: 0, rate: false, hysteresis: s.terms.hysteresis };
    let modes = |terms: &Terms, shape: &Shape| -> Vec<Vec<f64>> {
        s.course.columns(terms, shape, &s.span).iter().map(|c| s.modes.of(c)).collect()
    };
    let common: Vec<Vec<Vec<f64>>> =
        grid.iter().map(|lag_s| modes(&apart, &Shape { lag_s: *lag_s, play_deg_c })).collect();
    lag::profiles(draws, (&grid, longest), |at, draw| {
        let lag_s = *grid.get(at)?;
        let shape = Shape { lag_s, ..Shape::of(&draw.shape, play_deg_c) };
        let columns: Vec<Vec<f64>> = common.get(at)?.iter().cloned().chain(modes(&play, &shape)).collect();
        let solved = s.modes.solve(&s.data, &columns, &draw.noise)?;
        let coefficient = |at: Option<usize>| {
            let i = at?;
            Some((solved.coefficients[i], solved.covariance[(i, i)].max(0.0).sqrt()))
        };
        Some(AtLag {
            lag_s,
            log_likelihood: profiled(&solved)?,
            rate: coefficient(s.terms.rate_at()),
            hysteresis: coefficient(s.terms.hysteresis_at()),
        })
    })
}

impl Posterior {
    /// The same with a polynomial of a higher order whose further coefficients are zero.
    fn raised(mut self, order: usize) -> Posterior {
        let (from, more) = (self.terms.order, order.saturating_sub(self.terms.order));
        if more == 0 {
            return self;
        }
        let place = |i: usize| if i < from { i } else { i + more };
        let vector = |v: &DVector<f64>| {
            let mut out = DVector::zeros(v.len() + more);
            v.iter().enumerate().for_each(|(i, x)| out[place(i)] = *x);
            out
        };
        let matrix = |m: &DMatrix<f64>| {
            let mut out = DMatrix::zeros(m.nrows() + more, m.ncols() + more);
            for i in 0..m.nrows() {
                for j in 0..m.ncols() {
                    out[(place(i), place(j))] = m[(i, j)];
                }
            }
            out
        };
        for d in &mut self.draws {
            d.coefficients = vector(&d.coefficients);
            d.covariance = matrix(&d.covariance);
        }
        let solved = &mut self.best.fitted.solved;
        solved.coefficients = vector(&solved.coefficients);
        solved.covariance = matrix(&solved.covariance);
        self.terms.order = order;
        self
    }
}

/// Several orders by their weights: the best fit is that of the order `shown`, the draws are of all.
pub fn average(models: Vec<(Posterior, f64)>, shown: usize) -> Option<Posterior> {
    let highest = models.iter().map(|m| m.0.terms.order).max()?;
    let total: f64 = models.iter().map(|m| m.1).sum();
    let mut whole: Option<Posterior> = None;
    let (mut draws, mut lags) = (vec![], vec![]);
    for (model, weight) in models {
        let is_shown = model.terms.order == shown;
        let model = model.raised(highest);
        let kept = (model.draws.len() as f64 * weight / total).round().max(f64::from(u8::from(is_shown)));
        let step = model.draws.len() as f64 / kept.max(1.0);
        draws.extend((0..kept as usize).filter_map(|i| model.draws.get((i as f64 * step) as usize).cloned()));
        lags.extend(model.lags.iter().map(|c| Profile { weight, ..c.clone() }));
        if is_shown {
            whole = Some(model);
        }
    }
    whole.map(|w| Posterior { draws, lags, ..w })
}
