//! The power of tests that know more of a dead zone than the program does: no test has more.

use crate::bench::small_rates::SmallRates;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::estimate::normal_probability;

/// The rates of a test about the middle, each with the weight of its mean: the inverse of its standard uncertainty.
fn weighed(bench: &SmallRates) -> Vec<(f64, f64)> {
    let length = bench.dwell_s - 2.0;
    let step = (bench.n.powi(2) * 3600.0 / length + 2.0 * (bench.reading_arcsec / length).powi(2)).sqrt();
    // There and back: the outermost rate has one step.
    let visits = |i: i32| if i == bench.each_side { 1.0f64 } else { 2.0 };
    let all = -bench.each_side..=bench.each_side;
    all.map(|i| (f64::from(i) * bench.spacing, visits(i).sqrt() / step)).collect()
}

/// Power at one false claim in a hundred of the likelihood ratio of the true zone to the line, told everything but the
/// offset and what is not known of the slope: no test has more.
pub fn power_told(bench: &SmallRates, known: Option<f64>) -> f64 {
    let (x, weights): (Vec<f64>, Vec<f64>) = weighed(bench).into_iter().unzip();
    let n = x.len();
    let row = |i: usize, v: f64| if i < n { v * weights[i] } else { 0.0 };
    let certain = known.map_or(0.0, |u| 1.0 / u);
    let line = DMatrix::from_fn(n + 1, 2, |i, j| match (i == n, j) {
        (true, 1) => certain,
        (true, _) => 0.0,
        (_, 1) => row(i, x[i]),
        _ => row(i, 1.0),
    });
    let zone = |v: f64| v.signum() * (v.abs() - bench.half_width).max(0.0);
    let y = DVector::from_fn(n + 1, |i, _| if i == n { certain } else { row(i, zone(x[i])) });
    let fit = (line.transpose() * &line).cholesky().expect("a design").solve(&(line.transpose() * &y));
    normal_probability((y - line * fit).norm() - 2.326)
}

/// The same of the mean likelihood ratio over all centres in the inner half of the rates, slope free: a test that is told
/// kind and width and not where the zone lies has no more on the average of these centres. That average, and its power
/// where the zone lies in the middle of the rates, which is what a free slope hides best.
pub fn power_told_but_the_centre(bench: &SmallRates) -> [f64; 2] {
    let (x, weights): (Vec<f64>, Vec<f64>) = weighed(bench).into_iter().unzip();
    let largest = x.last().copied().expect("rates");
    let response = |centre: f64| {
        let zone = |v: f64| v.signum() * (v.abs() - bench.half_width).max(0.0);
        DVector::from_iterator(x.len(), x.iter().zip(&weights).map(|(x, w)| w * zone(x - centre)))
    };
    let one = DVector::from_column_slice(&weights);
    let basis = |column: DVector<f64>| DMatrix::from_columns(&[one.clone(), column]).qr().q();
    let straight = DVector::from_iterator(x.len(), x.iter().zip(&weights).map(|(x, w)| w * x));
    let of_line = basis(straight.clone());
    let centres: Vec<f64> = (-80..=80).map(|i| 0.5 * largest * f64::from(i) / 80.0).collect();
    let of_zones: Vec<DMatrix<f64>> = centres.iter().map(|c| basis(response(*c))).collect();
    let mean_ratio = |r: &DVector<f64>| {
        let explained = |q: &DMatrix<f64>| q.tr_mul(r).norm_squared();
        let line = explained(&of_line);
        let ratios = of_zones.iter().map(|q| (0.5 * (explained(q) - line)).exp());
        ratios.sum::<f64>()
    };
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut drawn = |of: &DVector<f64>| {
        let noise = DVector::from_fn(x.len(), |_, _| StandardNormal.sample(&mut rng));
        mean_ratio(&(of + noise))
    };
    let mut without: Vec<f64> = (0..20_000).map(|_| drawn(&straight)).collect();
    without.sort_by(f64::total_cmp);
    let claimed_from = without[without.len() * 99 / 100];
    let shifted: Vec<DVector<f64>> = centres.iter().map(|c| response(*c)).collect();
    let mut shown = |of: &dyn Fn(usize) -> usize| {
        (0..20_000).filter(|i| drawn(&shifted[of(*i)]) > claimed_from).count() as f64 / 20_000.0
    };
    [shown(&|i| i % centres.len()), shown(&|_| centres.len() / 2)]
}
