//! Linear models with correlated noise whose variance components are not known: y = Xβ + e, cov e = V₀ + Σ θₖ Vₖ with θₖ ≥ 0.
//!
//! The variance components maximise the restricted likelihood (Patterson and Thompson 1971), by average information
//! (Gilmour, Thompson and Cullis 1995); β follows by generalised least squares. A linear combination of β is Student's
//! with the degrees of freedom of Satterthwaite (Giesbrecht and Burns 1985).

use super::cholesky::inverse;
use super::cholesky::log_determinant;
use super::optimize::Damping;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::ControlFlow;

/// Steps of the ascent.
const ASCENT_STEPS: usize = 60;

/// A linear model fitted by restricted maximum likelihood.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Coefficients, one a column of X.
    pub coefficients: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Strengths of the components, one a matrix given.
    pub variance_components: Vec<f64>,
    /// Weight of every value of y in each coefficient.
    pub weights: DMatrix<f64>,
    /// What the model leaves of y.
    pub residuals: DVector<f64>,
    /// Twice the restricted log-likelihood, but for a constant.
    pub twice_log_likelihood: f64,
    /// Derivatives of the covariance by the variance components.
    slopes: Vec<DMatrix<f64>>,
    /// Covariance of those variance components.
    strength_covariance: DMatrix<f64>,
}

/// A linear combination of coefficients with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Combination {
    /// Value.
    pub value: f64,
    /// Standard uncertainty.
    pub standard: f64,
    /// Degrees of freedom of the standard uncertainty.
    pub dof: f64,
}

impl Fit {
    /// A linear combination of the coefficients.
    pub fn combine(&self, weights: &DVector<f64>) -> Combination {
        let variance = weights.dot(&(&self.covariance * weights)).max(0.0);
        let slopes = DVector::from_iterator(
            self.slopes.len(),
            self.slopes.iter().map(|s| weights.dot(&(s * weights))),
        );
        let scatter =
            if slopes.is_empty() { 0.0 } else { slopes.dot(&(&self.strength_covariance * &slopes)) };
        let dof = if scatter > 0.0 { (2.0 * variance * variance / scatter).clamp(1.0, 1e9) } else { 1e9 };
        Combination { value: weights.dot(&self.coefficients), standard: variance.sqrt(), dof }
    }

    /// Standard deviation of a sum of noise, and the degrees of freedom of that, from the variance that each component of
    /// unit strength gives the sum.
    pub fn noise_of(&self, variances: &[f64]) -> (f64, f64) {
        let each = DVector::from_iterator(
            self.variance_components.len(),
            (0..self.variance_components.len()).map(|k| variances.get(k).copied().unwrap_or(0.0)),
        );
        let variance = each.iter().zip(&self.variance_components).map(|(v, s)| v * s).sum::<f64>().max(0.0);
        let scatter = each.dot(&(&self.strength_covariance * &each));
        let dof = if scatter > 0.0 { (2.0 * variance * variance / scatter).clamp(1.0, 1e9) } else { 1e9 };
        (variance.sqrt(), dof)
    }

    /// The fit with columns that were divided by `sizes` before: coefficients of the columns as they were.
    #[must_use]
    pub fn rescaled(mut self, sizes: &[f64]) -> Fit {
        let back =
            DMatrix::from_diagonal(&DVector::from_iterator(sizes.len(), sizes.iter().map(|s| 1.0 / s)));
        self.coefficients = &back * self.coefficients;
        self.covariance = &back * self.covariance * &back;
        self.weights = &back * self.weights;
        self.slopes = self.slopes.iter().map(|s| &back * s * &back).collect();
        self
    }

    /// One coefficient with its uncertainty.
    pub fn coefficient(&self, at: usize) -> Combination {
        let mut weights = DVector::zeros(self.coefficients.len());
        if let Some(w) = weights.get_mut(at) {
            *w = 1.0;
        }
        self.combine(&weights)
    }
}

/// What one set of variance components gives.
struct State {
    twice_log_likelihood: f64,
    factor: Cholesky<f64, Dyn>,
    /// V⁻¹X.
    weighted: DMatrix<f64>,
    covariance: DMatrix<f64>,
    coefficients: DVector<f64>,
    /// Py = V⁻¹(y − Xβ).
    projected: DVector<f64>,
}

/// Fits the model. `fixed` is the covariance that is known, `components` those of unknown strength; all n by n.
///
/// `None` when X has dependent columns, when no degrees of freedom are left, or when no variance components make the covariance
/// positive.
pub fn fit(
    y: &DVector<f64>,
    x: &DMatrix<f64>,
    fixed: &DMatrix<f64>,
    components: &[DMatrix<f64>],
) -> Option<Fit> {
    let (n, p) = (x.nrows(), x.ncols());
    if n <= p || p == 0 || y.len() != n || fixed.nrows() != n {
        return None;
    }
    // Strengths are sought in units in which each component alone would explain the scatter.
    let plain = Cholesky::new(x.transpose() * x)?;
    let hat = |m: &DMatrix<f64>| plain.solve(&(x.transpose() * m));
    let residual = y - x * plain.solve(&(x.transpose() * y));
    let scatter = residual.norm_squared() / (n - p) as f64;
    let units: Vec<f64> = components
        .iter()
        .map(|v| {
            let trace = v.trace() - (hat(v) * x).trace();
            scatter.max(f64::MIN_POSITIVE) / (trace / (n - p) as f64).max(f64::MIN_POSITIVE)
        })
        .collect();
    let known = (fixed.trace() / n as f64).max(0.0);
    let share =
        (1.0 - known / scatter.max(f64::MIN_POSITIVE)).clamp(0.05, 1.0) / components.len().max(1) as f64;
    let mut variance_components: Vec<f64> = units.iter().map(|u| u * share).collect();
    let mut state = evaluate(y, x, fixed, components, &variance_components)?;
    let mut damping = Damping { value: 1e-3, eased_by: 0.2, least: 1e-6, raised_by: 8.0, least_raised: 1e-4 };
    for _ in 0..ASCENT_STEPS {
        if components.is_empty() {
            break;
        }
        let (score, information) = derivatives(&state, components);
        let free: Vec<usize> = (0..components.len())
            .filter(|k| variance_components[*k] > 0.0 || score[*k] > 0.0)
            .filter(|k| information[(*k, *k)] > 0.0)
            .collect();
        if free.is_empty() {
            break;
        }
        let better = damping.search(12, |damping| {
            let stepped = step_within(&score, &information, &free, damping);
            let trial = stepped.map(|step| {
                let mut next = variance_components.clone();
                for (i, k) in free.iter().enumerate() {
                    // A strength is brought down by decades before it is given up.
                    let least = if variance_components[*k] > 1e-6 * units[*k] {
                        0.1 * variance_components[*k]
                    } else {
                        0.0
                    };
                    next[*k] = (variance_components[*k] + step[i]).max(least);
                }
                next
            });
            if let Some(next) = trial
                && let Some(after) = evaluate(y, x, fixed, components, &next)
                && after.twice_log_likelihood >= state.twice_log_likelihood - 1e-9
            {
                return ControlFlow::Break(Some((next, after)));
            }
            ControlFlow::Continue(())
        });
        let Some((next, after)) = better else { break };
        let gain = after.twice_log_likelihood - state.twice_log_likelihood;
        (variance_components, state) = (next, after);
        if gain < 1e-6 {
            break;
        }
    }
    Some(finish(state, x, y, components, variance_components))
}

/// The step of the free strengths under damping.
fn step_within(
    score: &DVector<f64>,
    information: &DMatrix<f64>,
    free: &[usize],
    damping: f64,
) -> Option<DVector<f64>> {
    let m = free.len();
    let matrix = DMatrix::from_fn(m, m, |i, j| {
        let v = information[(free[i], free[j])];
        if i == j { v * (1.0 + damping) } else { v }
    });
    let right = DVector::from_fn(m, |i, _| score[free[i]]);
    Cholesky::new(matrix).map(|c| c.solve(&right))
}

fn evaluate(
    y: &DVector<f64>,
    x: &DMatrix<f64>,
    fixed: &DMatrix<f64>,
    components: &[DMatrix<f64>],
    variance_components: &[f64],
) -> Option<State> {
    let mut v = fixed.clone();
    for (component, strength) in components.iter().zip(variance_components) {
        if *strength > 0.0 {
            v += component * *strength;
        }
    }
    let factor = Cholesky::new(v)?;
    let weighted = factor.solve(x);
    let normal = Cholesky::new(x.transpose() * &weighted)?;
    let coefficients = normal.solve(&(weighted.transpose() * y));
    let projected = factor.solve(&(y - x * &coefficients));
    let twice_log_likelihood = -log_determinant(&factor) - log_determinant(&normal) - y.dot(&projected);
    if !twice_log_likelihood.is_finite() {
        return None;
    }
    Some(State {
        twice_log_likelihood,
        covariance: normal.inverse(),
        factor,
        weighted,
        coefficients,
        projected,
    })
}

/// A covariance of given shape at its best strength.
#[derive(Debug, Clone, Copy)]
pub struct Scaled {
    /// That strength.
    pub scale: f64,
    /// Restricted log-likelihood there, but for a constant.
    pub log_likelihood: f64,
}

/// The strength of all of a covariance of which the shape is known; `None` as with [`fit`].
pub fn scaled(y: &DVector<f64>, x: &DMatrix<f64>, shape: &DMatrix<f64>) -> Option<Scaled> {
    let dof = x.nrows().checked_sub(x.ncols()).filter(|d| *d > 0)? as f64;
    let state = evaluate(y, x, shape, &[], &[])?;
    let square = y.dot(&state.projected);
    let scale = square / dof;
    let log_likelihood = 0.5 * (state.twice_log_likelihood + square - dof * scale.ln());
    log_likelihood.is_finite().then_some(Scaled { scale, log_likelihood })
}

/// P = V⁻¹ − V⁻¹X (X'V⁻¹X)⁻¹ X'V⁻¹.
fn projector(state: &State) -> DMatrix<f64> {
    inverse(&state.factor) - &state.weighted * &state.covariance * state.weighted.transpose()
}

/// Score and average information of the variance components.
fn derivatives(state: &State, components: &[DMatrix<f64>]) -> (DVector<f64>, DMatrix<f64>) {
    let p = projector(state);
    let moved: Vec<DVector<f64>> = components.iter().map(|v| v * &state.projected).collect();
    let back: Vec<DVector<f64>> = moved.iter().map(|m| &p * m).collect();
    let k = components.len();
    let score = DVector::from_fn(k, |i, _| {
        0.5 * (state.projected.dot(&moved[i]) - p.component_mul(&components[i]).sum())
    });
    let information = DMatrix::from_fn(k, k, |i, j| 0.5 * moved[i].dot(&back[j]));
    (score, information)
}

fn finish(
    state: State,
    x: &DMatrix<f64>,
    y: &DVector<f64>,
    components: &[DMatrix<f64>],
    variance_components: Vec<f64>,
) -> Fit {
    let p = projector(&state);
    let products: Vec<DMatrix<f64>> = components.iter().map(|v| &p * v).collect();
    let information = DMatrix::from_fn(components.len(), components.len(), |i, j| {
        0.5 * products[i].component_mul(&products[j].transpose()).sum()
    });
    let slopes = components
        .iter()
        .map(|v| {
            let inner = state.weighted.transpose() * v * &state.weighted;
            &state.covariance * inner * &state.covariance
        })
        .collect();
    let active: Vec<usize> = (0..components.len()).filter(|k| variance_components[*k] > 0.0).collect();
    let residuals = y - x * &state.coefficients;
    Fit {
        covariance: &state.covariance + inflation(&state, components, &products, &information, &active),
        weights: &state.covariance * state.weighted.transpose(),
        coefficients: state.coefficients,
        variance_components,
        residuals,
        twice_log_likelihood: state.twice_log_likelihood,
        slopes,
        // A strength at its end of zero is no better known than one above it.
        strength_covariance: inverse_of(information),
    }
}

/// The inverse of information, as far as there is any.
fn inverse_of(information: DMatrix<f64>) -> DMatrix<f64> {
    if information.is_empty() {
        return information;
    }
    let least = 1e-12 * information.iter().fold(f64::MIN_POSITIVE, |m: f64, v| m.max(v.abs()));
    information.clone().pseudo_inverse(least).unwrap_or(information)
}

/// Part that the covariance of the coefficients lacks because the variance components, and with them the weights, are estimated: weights
/// that scatter about the best ones make coefficients less certain, and the covariance at the variance components found is too small
/// by as much again (Kackar and Harville 1984; Kenward and Roger 1997). Of the variance components that are not at their end of zero,
/// since those that are do not scatter to both sides. `products` are those of the projector with the components.
fn inflation(
    state: &State,
    components: &[DMatrix<f64>],
    products: &[DMatrix<f64>],
    information: &DMatrix<f64>,
    active: &[usize],
) -> DMatrix<f64> {
    let m = active.len();
    let scatter = inverse_of(DMatrix::from_fn(m, m, |i, j| information[(active[i], active[j])]));
    let columns = state.covariance.nrows();
    let mut sum = DMatrix::zeros(columns, columns);
    for (i, k) in active.iter().enumerate() {
        let left = state.weighted.transpose() * &components[*k];
        for (j, l) in active.iter().enumerate() {
            sum += &left * (&products[*l] * &state.weighted) * scatter[(i, j)];
        }
    }
    &state.covariance * sum * &state.covariance * 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_alone_is_ordinary_least_squares() {
        // Longley-like small case by hand: y on a line with residuals ±1.
        let x = DMatrix::from_fn(6, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
        let y = DVector::from_vec(vec![1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
        let f = fit(&y, &x, &DMatrix::zeros(6, 6), &[DMatrix::identity(6, 6)]).unwrap();
        // Slope −6/35·... from the normal equations: Sxy = −3, Sxx = 17.5.
        assert!((f.coefficients[1] + 3.0 / 17.5).abs() < 1e-12);
        let rss = 6.0 - 9.0 / 17.5;
        assert!((f.variance_components[0] - rss / 4.0).abs() < 1e-6);
        let slope = f.coefficient(1);
        assert!((slope.standard - (rss / 4.0 / 17.5).sqrt()).abs() < 1e-6);
        assert!((slope.dof - 4.0).abs() < 1e-6);
        // A mean of four further values: a quarter of the variance, known from the same degrees of freedom.
        let (standard, dof) = f.noise_of(&[0.25]);
        assert!((standard - (rss / 16.0).sqrt()).abs() < 1e-6 && (dof - 4.0).abs() < 1e-6);
    }

    #[test]
    fn a_balanced_random_effect_has_the_variance_components_of_the_analysis_of_variance() {
        // Three groups of two: between and within mean squares give both variance components in closed form.
        let y = DVector::from_vec(vec![1.0, 2.0, 5.0, 7.0, 9.0, 8.0]);
        let x = DMatrix::from_element(6, 1, 1.0);
        let group = DMatrix::from_fn(6, 6, |i, j| if i / 2 == j / 2 { 1.0 } else { 0.0 });
        let f = fit(&y, &x, &DMatrix::zeros(6, 6), &[DMatrix::identity(6, 6), group]).unwrap();
        let within = (0.5 + 2.0 + 0.5) / 3.0;
        let means = [1.5, 6.0, 8.5];
        let mean = 16.0 / 3.0;
        let between = means.iter().map(|m| 2.0 * (m - mean) * (m - mean)).sum::<f64>() / 2.0;
        assert!((f.variance_components[0] - within).abs() < 1e-4, "{:?}", f.variance_components);
        assert!(
            (f.variance_components[1] - (between - within) / 2.0).abs() < 1e-3,
            "{:?}",
            f.variance_components
        );
        let mean_value = f.coefficient(0);
        assert!((mean_value.standard - (between / 6.0).sqrt()).abs() < 1e-3);
        assert!(f.weights.iter().all(|w| (w - 1.0 / 6.0).abs() < 1e-9), "{}", f.weights);
        // Two degrees of freedom: three groups.
        assert!((mean_value.dof - 2.0).abs() < 0.05, "{}", mean_value.dof);
    }

    #[test]
    fn the_scale_of_a_known_shape_is_that_of_a_fit_of_one_component() {
        let x = DMatrix::from_fn(8, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
        let y = DVector::from_fn(8, |i, _| [0.3, -1.1, 0.8, 2.0, -0.4, 0.1, 1.7, -0.9][i]);
        let shape = DMatrix::from_fn(8, 8, |i, j| 0.6f64.powi((i as i32 - j as i32).abs()));
        let fitted = fit(&y, &x, &DMatrix::zeros(8, 8), std::slice::from_ref(&shape)).unwrap();
        let found = scaled(&y, &x, &shape).unwrap();
        assert!((found.scale / fitted.variance_components[0] - 1.0).abs() < 1e-4);
        // The quadratic form at the best scale is the number of degrees of freedom.
        assert!((2.0 * found.log_likelihood - 6.0 - fitted.twice_log_likelihood).abs() < 1e-6);
        assert!(scaled(&y.rows(0, 2).into_owned(), &x.rows(0, 2).into_owned(), &shape).is_none());
    }

    #[test]
    fn columns_of_another_size_give_the_same_fit_once_rescaled() {
        let x = DMatrix::from_fn(6, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
        let y = DVector::from_vec(vec![1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
        let sizes = [2.0, 0.5];
        let divided = DMatrix::from_fn(6, 2, |i, j| x[(i, j)] / sizes[j]);
        let of = |x: &DMatrix<f64>| fit(&y, x, &DMatrix::zeros(6, 6), &[DMatrix::identity(6, 6)]).unwrap();
        let (plain, back) = (of(&x), of(&divided).rescaled(&sizes));
        assert!((&back.coefficients - &plain.coefficients).amax() < 1e-9);
        assert!((&back.covariance - &plain.covariance).amax() < 1e-7);
        assert!((&back.weights - &plain.weights).amax() < 1e-9);
        let (a, b) = (back.coefficient(1), plain.coefficient(1));
        assert!((a.standard - b.standard).abs() < 1e-7 && (a.dof - b.dof).abs() < 1e-5);
        // What the line −3/17.5 (x − 2.5) leaves, and the weights (x − 2.5)/17.5 of its slope.
        for i in 0..6 {
            let from_middle = i as f64 - 2.5;
            assert!((plain.residuals[i] - (y[i] + 3.0 / 17.5 * from_middle)).abs() < 1e-9);
            assert!((plain.weights[(1, i)] - from_middle / 17.5).abs() < 1e-9);
        }
        // A sum of both coefficients: variances 35/12 + 2.5² over 17.5, and 1/17.5, covariance −2.5/17.5.
        let level = plain.variance_components[0];
        let sum = plain.combine(&DVector::from_vec(vec![1.0, 1.0]));
        assert!((sum.value - (plain.coefficients[0] + plain.coefficients[1])).abs() < 1e-12);
        let expected = level * (1.0 / 6.0 + (6.25 + 1.0 - 5.0) / 17.5);
        assert!((sum.standard - expected.sqrt()).abs() < 1e-6, "{}", sum.standard);
    }

    #[test]
    fn what_cannot_be_fitted_gives_none_and_a_known_covariance_is_taken_as_it_is() {
        let x = DMatrix::from_fn(4, 1, |_, _| 1.0);
        let y = DVector::from_vec(vec![3.0, 1.0, 2.0, 6.0]);
        let known = DMatrix::identity(4, 4) * 2.0;
        let plain = fit(&y, &x, &known, &[]).unwrap();
        // The mean with variance 2/4, exactly known; −4 ln 2 − ln(4/2) − Σ(y − 3)²/2.
        let mean = plain.coefficient(0);
        assert!((mean.value - 3.0).abs() < 1e-12 && (mean.standard - 0.5f64.sqrt()).abs() < 1e-12);
        assert_eq!(mean.dof, 1e9);
        assert!((plain.twice_log_likelihood - (-5.0 * 2f64.ln() - 7.0)).abs() < 1e-12);
        assert!(fit(&y, &DMatrix::from_fn(4, 4, |i, j| f64::from(u8::from(i == j))), &known, &[]).is_none());
        assert!(fit(&y, &DMatrix::from_fn(4, 2, |_, _| 1.0), &known, &[]).is_none());
        assert!(fit(&y, &x, &DMatrix::identity(3, 3), &[]).is_none());
        assert!(fit(&y.rows(0, 3).into_owned(), &x, &known, &[]).is_none());
    }
}
