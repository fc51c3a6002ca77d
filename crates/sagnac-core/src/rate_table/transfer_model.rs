//! Models of the response of a gyro over frequency, and their fits: a delay with a pole, two poles or a moving average.

use super::cross_spectrum::Bin;
use nalgebra::{DMatrix, DVector};
use sagnac_fft::Complex;
use std::f64::consts::TAU;

/// Variance of neighbouring bins under a Hann window taken as if each stood alone, relative: they share two thirds of their
/// amplitude with the next and a sixth with the one after.
pub(crate) const SHARED_BY_BINS: f64 = 1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0);

/// Steps of a fit.
const MAX_STEPS: usize = 60;

/// Steps for the derivative of a response, relative for what is a logarithm and in units of the shortest period for a delay.
const DERIVATIVE_STEP: f64 = 1e-5;

/// Largest share of the response that the best model may leave beyond the noise: with more no row rests on it. Less is in the intervals.
pub(crate) const LARGEST_RELATIVE_MISFIT: f64 = 0.03;

/// Largest step for the derivative of what follows from a model, relative.
const DERIVATIVE_OF_RESULT_STEP: f64 = 1e-3;

/// How a response falls with frequency, beside its gain and its delay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Not at all.
    Flat,
    /// One pole.
    First,
    /// Two poles.
    Second,
    /// Mean over a time.
    Average,
}

impl Order {
    /// Every order, the plainest first.
    pub const ALL: [Order; 4] = [Order::Flat, Order::First, Order::Average, Order::Second];

    /// Its id.
    pub fn id(self) -> &'static str {
        match self {
            Order::Flat => "flat",
            Order::First => "first",
            Order::Second => "second",
            Order::Average => "average",
        }
    }

    /// Parameters beside gain and delay.
    fn parameters(self) -> usize {
        match self {
            Order::Flat => 0,
            Order::First | Order::Average => 1,
            Order::Second => 2,
        }
    }
}

/// A model with its parameters: gain, delay in s, then natural logarithms of corner frequency in Hz and damping, or of the averaging time
/// in s.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// How it falls.
    pub order: Order,
    /// Its parameters.
    pub parameters: Vec<f64>,
}

impl Model {
    fn parameter(&self, at: usize) -> f64 {
        self.parameters.get(at).copied().unwrap_or(0.0)
    }

    /// Gain at frequency zero.
    pub fn gain(&self) -> f64 {
        self.parameter(0)
    }

    /// Response at a frequency over the gain.
    pub fn shape(&self, frequency_hz: f64) -> Complex<f64> {
        let f = frequency_hz;
        let delayed = Complex::from_polar(1.0, -TAU * f * self.parameter(1));
        let (corner, further) = (self.parameter(2).exp(), self.parameter(3).exp());
        let one = Complex::new(1.0, 0.0);
        delayed
            * match self.order {
                Order::Flat => one,
                Order::First => one / Complex::new(1.0, f / corner),
                Order::Second => {
                    let x = f / corner;
                    one / Complex::new(1.0 - x * x, 2.0 * further * x)
                }
                Order::Average => {
                    let half = 0.5 * TAU * f * corner;
                    let share = if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
                    Complex::from_polar(1.0, -half) * share
                }
            }
    }

    /// Delay of slow motion, s.
    pub fn latency_s(&self) -> f64 {
        let (corner, further) = (self.parameter(2).exp(), self.parameter(3).exp());
        self.parameter(1)
            + match self.order {
                Order::Flat => 0.0,
                Order::First => 1.0 / (TAU * corner),
                Order::Second => 2.0 * further / (TAU * corner),
                Order::Average => 0.5 * corner,
            }
    }

    /// The lowest frequency where a function of the shape falls to zero from above, Hz; `None` below `highest_hz`.
    pub fn falls(&self, highest_hz: f64, of: impl Fn(&Model, f64) -> f64) -> Option<f64> {
        let grid = |i: usize| highest_hz * 10f64.powf(-6.0 * (1.0 - i as f64 / 3000.0));
        let end = (1..=3000).find(|i| of(self, grid(*i)) <= 0.0)?;
        let found = crate::numeric::optimize::bisect(grid(end - 1), grid(end), 60, |f| of(self, f) > 0.0);
        Some(found.middle())
    }

    /// Phase at a frequency, rad, without turns left out.
    pub fn phase(&self, frequency_hz: f64) -> f64 {
        let f = frequency_hz;
        let delayed = -TAU * f * self.parameter(1);
        let (corner, further) = (self.parameter(2).exp(), self.parameter(3).exp());
        delayed
            + match self.order {
                Order::Flat => 0.0,
                Order::First => -(f / corner).atan(),
                Order::Second => {
                    let x = f / corner;
                    -(2.0 * further * x).atan2(1.0 - x * x)
                }
                Order::Average => -0.5 * TAU * f * corner,
            }
    }
}

impl Model {
    /// The response that is read in a bin where the unit is this model.
    pub fn read(&self, bin: &Bin) -> Complex<f64> {
        bin.window.read(bin.frequency_hz, |f| self.shape(f) * self.gain())
    }
}

/// A fitted model.
#[derive(Debug, Clone)]
pub struct FittedModel {
    /// The model.
    pub model: Model,
    /// Covariance of its parameters, for what scatter the bins have about it.
    pub covariance: DMatrix<f64>,
    /// Sum of squares of the residuals over their variances, over the degrees of freedom.
    pub misfit: f64,
    /// Root mean square of what it leaves beyond the noise, as a share of the response.
    pub relative_misfit: f64,
    /// Schwarz criterion, with the scatter about the best model as noise: smaller is better.
    pub criterion: f64,
    squares: f64,
}

/// Largest standard deviation of the logarithm of a parameter that a record determines.
const LARGEST_LOG_DEVIATION: f64 = 1.0;

impl FittedModel {
    /// True where the record tells corner, damping or averaging time to within a factor: otherwise the model is a plainer one.
    pub fn is_determined(&self) -> bool {
        (2..self.model.parameters.len())
            .all(|i| self.covariance.get((i, i)).is_some_and(|v| v.sqrt() <= LARGEST_LOG_DEVIATION))
    }

    /// Standard uncertainty of a function of the model, from its derivatives.
    pub fn standard(&self, of: impl Fn(&Model) -> Option<f64>) -> Option<f64> {
        let here = of(&self.model)?;
        let gradient = (0..self.model.parameters.len())
            .map(|i| {
                let size = self.model.parameters.get(i)?.abs().max(1e-3);
                let step = (0.1 * self.covariance.get((i, i))?.max(0.0).sqrt())
                    .min(DERIVATIVE_OF_RESULT_STEP * size);
                let mut moved = self.model.clone();
                *moved.parameters.get_mut(i)? += step;
                if step > 0.0 { Some((of(&moved)? - here) / step) } else { Some(0.0) }
            })
            .collect::<Option<Vec<f64>>>()?;
        let gradient = DVector::from_vec(gradient);
        let variance = (gradient.transpose() * &self.covariance * &gradient).get((0, 0)).copied()?;
        (variance >= 0.0).then(|| variance.sqrt())
    }
}

/// Fits every order to the bins; the best first. Empty where there are too few bins.
pub fn fit(bins: &[Bin]) -> Vec<FittedModel> {
    let mut found: Vec<FittedModel> =
        Order::ALL.into_iter().filter_map(|order| of_order(order, bins)).collect();
    // Where no model leaves noise alone, what the best one leaves is the scale by which models differ.
    let scatter = found.iter().map(|f| f.misfit).fold(f64::INFINITY, f64::min).max(1.0);
    let independent = (2.0 * bins.len() as f64 / SHARED_BY_BINS).max(2.0);
    for f in &mut found {
        let count = f.model.parameters.len() as f64;
        f.criterion = f.squares / (SHARED_BY_BINS * scatter) + count * independent.ln();
    }
    found.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    found
}

fn of_order(order: Order, bins: &[Bin]) -> Option<FittedModel> {
    let highest = bins.iter().map(|b| b.frequency_hz).fold(0.0, f64::max);
    let gain = bins.first()?.response;
    let gain = gain.norm().copysign(gain.re);
    if 2 * bins.len() <= order.parameters() + 2 || highest <= 0.0 {
        return None;
    }
    let starts: Vec<Vec<f64>> = match order {
        Order::Flat => vec![vec![]],
        Order::First => [0.1, 0.4, 1.5, 6.0].iter().map(|r| vec![(r * highest).ln()]).collect(),
        Order::Average => [0.1, 0.4, 1.5, 6.0].iter().map(|r| vec![-(r * highest).ln()]).collect(),
        Order::Second => [0.1, 0.3, 0.8, 2.0, 5.0]
            .iter()
            .flat_map(|r| [0.2f64, 0.7, 1.5].map(|z| vec![(r * highest).ln(), z.ln()]))
            .collect(),
    };
    let tried = starts.into_iter().filter_map(|rest| {
        let parameters = [vec![gain, 0.0], rest].concat();
        descend(Model { order, parameters }, bins, highest)
    });
    let (model, squares) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let jacobian = jacobian(&model, bins, highest)?;
    let information = jacobian.transpose() * &jacobian;
    let covariance = information.try_inverse()?;
    let count = model.parameters.len() as f64;
    let dof = (2.0 * bins.len() as f64 - count).max(1.0);
    let misfit = squares / dof;
    let relative_misfit = beyond_noise(&model, bins);
    Some(FittedModel {
        model,
        // Bins share noise: what they say counts for less, and scatter beyond it widens everything.
        covariance: covariance * (SHARED_BY_BINS * misfit.max(1.0)),
        misfit,
        relative_misfit,
        criterion: 0.0,
        squares,
    })
}

/// Root mean square of what a model leaves beyond the noise, as a share of the response. Bins whose own noise hides what counts as a misfit
/// count less; a bin may fall below its noise as well as above it.
fn beyond_noise(model: &Model, bins: &[Bin]) -> f64 {
    let (mut left, mut weights) = (0.0, 0.0);
    for b in bins {
        let power = model.read(b).norm_sqr();
        let noise = 2.0 * b.variance / power;
        let weight = 1.0 / (1.0 + noise / LARGEST_RELATIVE_MISFIT.powi(2));
        left += weight * ((b.response - model.read(b)).norm_sqr() / power - noise);
        weights += weight;
    }
    (left / weights).max(0.0).sqrt()
}

/// Residuals over their standard deviations, real and imaginary parts.
fn residuals(model: &Model, bins: &[Bin]) -> DVector<f64> {
    let mut out = Vec::with_capacity(2 * bins.len());
    for b in bins {
        let left = b.response - model.read(b);
        let deviation = b.variance.sqrt();
        out.extend([left.re / deviation, left.im / deviation]);
    }
    DVector::from_vec(out)
}

fn jacobian(model: &Model, bins: &[Bin], highest_hz: f64) -> Option<DMatrix<f64>> {
    let here = residuals(model, bins);
    let columns: Vec<DVector<f64>> = (0..model.parameters.len())
        .map(|i| {
            let step = match i {
                0 => DERIVATIVE_STEP * model.gain().abs(),
                1 => DERIVATIVE_STEP / highest_hz,
                _ => DERIVATIVE_STEP,
            };
            let mut moved = model.clone();
            if let Some(p) = moved.parameters.get_mut(i) {
                *p += step;
            }
            (&here - residuals(&moved, bins)) / step
        })
        .collect();
    let jacobian = DMatrix::from_columns(&columns);
    jacobian.iter().all(|v| v.is_finite()).then_some(jacobian)
}

/// Levenberg and Marquardt from a start; the sum of squares with the model.
fn descend(mut model: Model, bins: &[Bin], highest_hz: f64) -> Option<(Model, f64)> {
    let mut squares = residuals(&model, bins).norm_squared();
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        let jacobian = jacobian(&model, bins, highest_hz)?;
        let information = jacobian.transpose() * &jacobian;
        let gradient = jacobian.transpose() * residuals(&model, bins);
        let mut damped = information.clone();
        for i in 0..damped.nrows() {
            if let Some(d) = damped.get_mut((i, i)) {
                *d *= 1.0 + damping;
            }
        }
        let step = damped.lu().solve(&gradient)?;
        let mut next = model.clone();
        next.parameters.iter_mut().zip(step.iter()).for_each(|(p, s)| *p += s);
        let lower = residuals(&next, bins).norm_squared();
        if lower < squares {
            let gained = squares - lower;
            (model, squares) = (next, lower);
            damping = (damping * 0.3).max(1e-9);
            if gained < 1e-9 * squares.max(1e-9) {
                break;
            }
        } else if damping > 1e9 {
            break;
        } else {
            damping *= 5.0;
        }
    }
    squares.is_finite().then_some((model, squares))
}

#[cfg(test)]
mod tests {
    use super::super::cross_spectrum::WindowTerms;
    use super::*;

    /// Bins of a model from 0.5 Hz to `highest_hz` with deviations of `sd` that alternate.
    fn bins(model: &Model, highest_hz: f64, sd: f64) -> Vec<Bin> {
        let one = |i: u32| {
            let frequency_hz = highest_hz * f64::from(i) / 100.0;
            let sign = |k: u32| if (i * 7 + k).is_multiple_of(3) { sd } else { -0.5 * sd };
            let response = model.shape(frequency_hz) * model.gain() + Complex::new(sign(0), sign(1));
            Bin { frequency_hz, response, variance: sd * sd, window: WindowTerms::default(), coherence: 0.99 }
        };
        (1..=100).map(one).collect()
    }

    #[test]
    fn the_order_is_that_of_the_unit() {
        for (order, rest) in [
            (Order::First, vec![30f64.ln()]),
            (Order::Second, vec![30f64.ln(), 0.5f64.ln()]),
            (Order::Average, vec![0.02f64.ln()]),
        ] {
            let truth = Model { order, parameters: [vec![-0.98, 0.003], rest].concat() };
            let found = fit(&bins(&truth, 60.0, 1e-3));
            let best = found.first().unwrap();
            assert_eq!(best.model.order, order);
            for (a, b) in best.model.parameters.iter().zip(&truth.parameters) {
                assert!((a - b).abs() < 2e-3, "{order:?}: {:?}", best.model.parameters);
            }
        }
    }

    #[test]
    fn low_frequencies_leave_the_order_open_and_know_the_latency() {
        // Up to a hundredth of the corner a pole is a delay.
        let truth = Model { order: Order::First, parameters: vec![1.0, 0.0, 2000f64.ln()] };
        let found = fit(&bins(&truth, 20.0, 1e-3));
        assert_eq!(found.first().unwrap().model.order, Order::Flat);
        let latency = found.first().unwrap().model.latency_s();
        assert!((latency - 1.0 / (TAU * 2000.0)).abs() < 1e-5, "{latency}");
    }

    #[test]
    fn an_uncertainty_is_that_of_the_parameters() {
        let truth = Model { order: Order::First, parameters: vec![1.0, 0.0, 30f64.ln()] };
        let best = fit(&bins(&truth, 60.0, 1e-3)).remove(0);
        let corner = best.standard(|m| Some(m.parameters[2].exp())).unwrap();
        let by_hand = 30.0 * best.covariance[(2, 2)].sqrt();
        assert!((corner / by_hand - 1.0).abs() < 0.02, "{corner} {by_hand}");
    }
}
