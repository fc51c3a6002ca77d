//! A constant delay between the gyro and the columns beside it.

use crate::effect::mean::first;
use crate::effect::shared::delay::{claimed_mean_varies, follow, regressors, shifted};
use crate::effect::shared::search::{best_of, peaks};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Values, number,
};
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::range::Bounds;
use sagnac_fft::{real_forward, real_inverse};

pub struct TimeOffset;

static PARAMS: [Param; 1] = [Param::reported("lag_s", "s", -1e4, 1e4).signed()];

describe! {
    TimeOffset, "time_offset", Mean in Lag, needs [],
    confusers [ClockDrift, SfError, BandwidthFilter, ThermalLag]
}

/// Σ a(i) b(i − L) for every L from 0 up and from −1 down, by Fourier transforms.
fn correlation(a: &[f64], b: &[f64]) -> Vec<f64> {
    let size = (2 * a.len().max(b.len())).next_power_of_two();
    let (forward, back) = (real_forward(size), real_inverse(size));
    let transform = |x: &[f64]| {
        let mut input = x.to_vec();
        input.resize(size, 0.0);
        let mut output = forward.make_output_vec();
        forward.process(&mut input, &mut output).ok().map(|()| output)
    };
    let (Some(mut x), Some(y)) = (transform(a), transform(b)) else { return vec![0.0; size] };
    x.iter_mut().zip(&y).for_each(|(x, y)| *x = *x * y.conj() / size as f64);
    if let Some(first) = x.first_mut() {
        first.im = 0.0;
    }
    if let Some(last) = x.last_mut() {
        last.im = 0.0;
    }
    let mut out = back.make_output_vec();
    match back.process(&mut x, &mut out) {
        Ok(()) => out,
        Err(_) => vec![0.0; size],
    }
}

/// Whole lags, in samples, that gain most.
fn whole_lags(mean: &[f64], context: &SearchContext<'_>, most: usize) -> Vec<f64> {
    let n = mean.len();
    let average = mean.iter().sum::<f64>() / n as f64;
    let mean: Vec<f64> = mean.iter().map(|m| m - average).collect();
    let mut weighted = crate::numeric::cosine::dct2(&mean);
    weighted.iter_mut().zip(context.powers).for_each(|(m, p)| *m /= p);
    if let Some(first) = weighted.first_mut() {
        *first = 0.0;
    }
    let weighted = inverse_dct2(&weighted);
    let with_score = correlation(context.score, &mean);
    let with_mean = correlation(&weighted, &mean);
    let size = with_score.len();
    // Sums of the products without a delay over the samples that a lag loses.
    let sums = |a: &[f64]| {
        let mut sum = vec![0.0; n + 1];
        for i in 0..n {
            sum[i + 1] = sum[i] + a[i] * mean[i];
        }
        sum
    };
    let (score_sums, mean_sums) = (sums(context.score), sums(&weighted));
    let gain = |lag: isize| {
        let lost = lag.unsigned_abs();
        let at = if lag >= 0 { lost } else { size - lost };
        let kept = |s: &[f64]| if lag >= 0 { s[n] - s[lost] } else { s[n - lost] };
        let linear = with_score[at] - kept(&score_sums);
        let square = 2.0 * (kept(&mean_sums) - with_mean[at]);
        linear - 0.5 * square.max(0.0)
    };
    let most = most.min(n / 2) as isize;
    let lags: Vec<isize> = (-most..=most).filter(|l| *l != 0).collect();
    let gains: Vec<f64> = lags.iter().map(|l| gain(*l).max(0.0)).collect();
    peaks(&gains, 3, 2).into_iter().map(|i| lags[i] as f64).collect()
}

impl MeanModel for TimeOffset {
    fn applies(&self, drivers: &Drivers) -> bool {
        claimed_mean_varies(drivers)
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let n = drivers.samples;
        if !claimed_mean_varies(drivers) || !context.is_of(n) {
            return Starts::none();
        }
        let Bounds { low, high } = self.bounds(drivers)[0];
        let mean = drivers.claimed_mean();
        let residual = inverse_dct2(context.modes);
        let dt = drivers.dt_s;
        let mut lags = whole_lags(&mean, context, (high / dt) as usize);
        lags.push(0.0);
        let fine: Vec<f64> = lags.iter().map(|l| follow(&residual, &mean, n, *l, |_| 1.0, 0.05)).collect();
        lags.extend(fine);
        let inside = lags.into_iter().filter(|l| l.is_finite() && *l != 0.0);
        let points = inside.map(|l| vec![(l * dt).clamp(low, high)]);
        Starts { points: best_of(self, points, 3, drivers, context), trials: (2.0 * high / dt).max(1.0) }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let most = (20.0 * drivers.dt_s).max(60.0).min(0.25 * drivers.length_s());
        vec![Bounds::new(-most, most)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let Some(lag) = nonlinear_parameters.first() else { return Regressors::default() };
        let samples = lag / drivers.dt_s;
        regressors(&drivers.claimed_mean(), |_| samples)
    }

    fn parameters(
        &self,
        nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<f64> {
        vec![first(nonlinear_parameters)]
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let Bounds { high, .. } = self.bounds(drivers)[0];
        let (dt, places) = (drivers.dt_s, vec![Values::new()]);
        let beside = self.regressors(&[dt], drivers).nuisance.len();
        vec![Sizing::searched(&PARAMS[0], places, 1 + beside, 2.0 * high / dt).from(0.1 * dt)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let samples = number(values, PARAMS[0].name)? / drivers.dt_s;
        Some(shifted(&drivers.claimed_mean(), |_| samples).0)
    }

    fn nuisance_columns(&self, values: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
        number(values, PARAMS[0].name).map_or_else(Vec::new, |lag| self.regressors(&[lag], drivers).nuisance)
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let half = 0.5 * drivers.dt_s;
        let at = |lag: &f64| Place { domain: Domain::Lag, from: lag - half, to: lag + half };
        nonlinear_parameters.first().map(at).into_iter().collect()
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        vec![0.05 * drivers.dt_s]
    }

    fn score_step(&self, drivers: &Drivers) -> Option<f64> {
        Some(0.05 * drivers.dt_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_by_transforms_are_the_sums() {
        let a: Vec<f64> = (0..37).map(|i| f64::from(i * 7 % 11) - 4.0).collect();
        let b: Vec<f64> = (0..37).map(|i| f64::from(i * 5 % 13) - 6.0).collect();
        let all = correlation(&a, &b);
        for lag in -36i32..=36 {
            let of = |i: i32| b.get(usize::try_from(i - lag).ok()?);
            let sum: f64 = (0..37).filter_map(|i| Some(a[i as usize] * of(i)?)).sum();
            let at = if lag >= 0 { lag as usize } else { all.len() - lag.unsigned_abs() as usize };
            assert!((all[at] - sum).abs() < 1e-9, "{lag}: {} {sum}", all[at]);
        }
    }

    #[test]
    fn the_whole_lag_of_a_delayed_mean_is_the_first() {
        let wave = |i: i32| 50.0 * (0.11 * f64::from(i)).sin() + 20.0 * (0.37 * f64::from(i)).cos();
        let mean: Vec<f64> = (0..500).map(wave).collect();
        let residual: Vec<f64> = (0..500).map(|i| wave(i - 6) - wave(i)).collect();
        let modes = crate::numeric::cosine::dct2(&residual);
        let powers = vec![1.0; 500];
        let context = SearchContext { score: &residual, modes: &modes, powers: &powers };
        assert_eq!(whole_lags(&mean, &context, 20)[0], 6.0);
    }
}
