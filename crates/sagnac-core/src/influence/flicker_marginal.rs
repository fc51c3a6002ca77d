//! The spread between runs where the flicker of the unit is known in part only.
//!
//! Flicker moves runs against one another as switching on does, and minutes of a run show it hardly. Every strength of it
//! gives its own confidence distribution of the spread (see [`super::contrasts`]); what counts is their mean, each weighed
//! by the restricted likelihood of what happens within the runs, which the spread between them does not enter. A strength
//! has a density that is flat below what the record can show and falls above as its inverse.

use super::contrasts::{Contrasts, Means};
use super::cut::Cut;
use super::gls;
use super::range::PossibleMeans;
use crate::estimate::{Spread, normal_probability};
use crate::numeric::optimize::bisect;
use crate::numeric::reml;
use nalgebra::{DMatrix, DVector};

/// Strengths of flicker tried.
const STRENGTH_COUNT: usize = 14;
/// Largest B over what a record can show.
const MAX_STRENGTH_RATIO: f64 = 20.0;
/// Weight, of the largest, below which a strength is left out.
const LEAST_WEIGHT: f64 = 1e-3;

/// One strength of flicker.
struct Possible {
    weight: f64,
    contrasts: Contrasts,
}

/// The means of runs with each strength of flicker that they may have. `runs` has a column a run. `None` where no strength can
/// be fitted.
pub fn means(cut: &Cut, runs: &DMatrix<f64>, fixed: &DMatrix<f64>) -> Option<Vec<PossibleMeans>> {
    let all = [cut.rows.white(), cut.rows.angle(), cut.rows.random_walk()];
    let plain = reml::fit(&cut.y, runs, fixed, &all)?;
    let shown = gls::shown(&plain, &all);
    let others: Vec<DMatrix<f64>> = shown.iter().map(|k| all[*k].clone()).collect();
    let flicker = cut.rows.flicker();
    let noise = all.iter().zip(&plain.variance_components).fold(fixed.clone(), |sum, (v, s)| sum + v * *s);
    let visible = visible(cut, &noise, &flicker).filter(|v| *v > 0.0 && v.is_finite())?;
    let width = MAX_STRENGTH_RATIO.ln_1p() / STRENGTH_COUNT as f64;
    let mut possible: Vec<PossibleMeans> = (0..STRENGTH_COUNT)
        .filter_map(|i| {
            // Equal steps of ln(B + visible) carry equal density.
            let b = visible * ((i as f64 + 0.5) * width).exp_m1();
            let fit = reml::fit(&cut.y, runs, &(fixed + &flicker * (b * b)), &others)?;
            let dof = fit.coefficient(0).dof;
            let weight = 0.5 * fit.twice_log_likelihood;
            Some(PossibleMeans { weight, values: fit.coefficients, noise: fit.covariance, dof })
        })
        .collect();
    let top = possible.iter().map(|p| p.weight).fold(f64::NEG_INFINITY, f64::max);
    possible.retain(|p| p.weight > top + LEAST_WEIGHT.ln());
    possible.iter_mut().for_each(|p| p.weight = (p.weight - top).exp());
    let total: f64 = possible.iter().map(|p| p.weight).sum();
    possible.iter_mut().for_each(|p| p.weight /= total);
    (!possible.is_empty()).then_some(possible)
}

/// The spread between runs about their common mean: value and confidence distribution.
pub fn deviation(possible: &[PossibleMeans]) -> Option<(f64, Spread)> {
    let list: Vec<Possible> = possible
        .iter()
        .filter_map(|p| {
            let means = Means { values: p.values.clone(), noise: p.noise.clone() };
            let columns = DMatrix::from_element(p.values.len(), 1, 1.0);
            Some(Possible { weight: p.weight, contrasts: Contrasts::new(&means, &columns)? })
        })
        .collect();
    (list.len() == possible.len() && !list.is_empty()).then(|| mean(&list))
}

/// The least B that a record shows: its flicker moves the halves of the runs against one another by as much more than the
/// rest of the noise does as the variance of so many differences is uncertain.
fn visible(cut: &Cut, noise: &DMatrix<f64>, flicker: &DMatrix<f64>) -> Option<f64> {
    let runs = cut.of.iter().max()? + 1;
    let (mut by_noise, mut by_flicker) = (0.0, 0.0);
    for run in 0..runs {
        let own: Vec<usize> = (0..cut.of.len()).filter(|i| cut.of[*i] == run).collect();
        let half = own.len() / 2;
        let mut w = DVector::zeros(cut.of.len());
        for (place, i) in own.iter().enumerate() {
            w[*i] = if place < half { -1.0 / half as f64 } else { 1.0 / (own.len() - half) as f64 };
        }
        by_noise += w.dot(&(noise * &w));
        by_flicker += w.dot(&(flicker * &w));
    }
    let noticed = (2.0 / runs as f64).sqrt();
    Some((noticed * by_noise / by_flicker).sqrt())
}

fn mean(list: &[Possible]) -> (f64, Spread) {
    let below = |deviation: f64| list.iter().map(|p| p.weight * p.contrasts.below(deviation)).sum::<f64>();
    let most = list.iter().map(|p| p.contrasts.largest()).fold(0.0, f64::max);
    let at = |share: f64| {
        if below(0.0) >= share {
            return 0.0;
        }
        bisect(0.0, most, 100, |x| below(x) < share).middle()
    };
    let points = (-35..=35).map(|i| f64::from(i) / 10.0).map(|z| (z, at(normal_probability(z)))).collect();
    let variance: f64 = list.iter().map(|p| p.weight * p.contrasts.variance()).sum();
    (variance.sqrt(), Spread::Curve(points))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate_table::noise::Rows;

    /// Six runs of ten minutes, an hour apart, with numbers that look like white noise.
    fn cut(bias: &[f64], spread: f64) -> (Cut, DMatrix<f64>) {
        let (parts, runs) = (10, bias.len());
        let n = parts * runs;
        let rows = Rows {
            mid_s: (0..n).map(|i| (i / parts) as f64 * 3600.0 + (i % parts) as f64 * 60.0).collect(),
            length_s: vec![60.0; n],
            step: (0..n).map(|i| i / parts).collect(),
        };
        let noise = |i: usize| spread * (((i * 7919 + 31) * (i + 13) % 97) as f64 / 48.0 - 1.0);
        let y = DVector::from_fn(n, |i, _| bias[i / parts] + noise(i));
        let of: Vec<usize> = (0..n).map(|i| i / parts).collect();
        let x = DMatrix::from_fn(n, runs, |i, j| f64::from(u8::from(of[i] == j)));
        let (temperature, table_rate) = (vec![f64::NAN; n], vec![f64::NAN; n]);
        (Cut { y, rows, of, temperature, beside: vec![], table_rate }, x)
    }

    #[test]
    fn where_runs_are_quiet_it_is_the_standard_deviation_with_its_chi_square_interval() {
        // domain: six cycles leave 0.62 … 2.45 times the estimate.
        let (cut, x) = cut(&[1.0, 2.0, 4.0, 3.0, 6.0, 5.0], 1e-4);
        let fixed = DMatrix::identity(60, 60) * 1e-14;
        let (value, spread) = deviation(&means(&cut, &x, &fixed).unwrap()).unwrap();
        assert!((value / 3.5f64.sqrt() - 1.0).abs() < 1e-3, "{value}");
        let i = spread.interval(value, 0.95).unwrap();
        assert!((i.low / value - 0.6242).abs() < 3e-3 && (i.high / value - 2.4526).abs() < 8e-3, "{i:?}");
    }

    #[test]
    fn a_spread_that_flicker_might_make_is_not_shown_though_white_noise_would_not_make_it() {
        let (cut, x) = cut(&[0.10, -0.05, 0.04, -0.12, 0.06, -0.03], 0.25);
        let fixed = DMatrix::identity(60, 60) * 1e-12;
        let white = reml::fit(&cut.y, &x, &fixed, &[cut.rows.white()]).unwrap();
        let plain_means = Means { values: white.coefficients, noise: white.covariance };
        let (plain, known) =
            Contrasts::new(&plain_means, &DMatrix::from_element(6, 1, 1.0)).unwrap().deviation();
        assert!(known.bound(plain, 0.025).unwrap() > 0.0, "{plain}");
        let (value, spread) = deviation(&means(&cut, &x, &fixed).unwrap()).unwrap();
        assert_eq!(spread.bound(value, 0.025), Some(0.0));
        assert!(spread.bound(value, 0.975).unwrap() > plain);
    }
}
