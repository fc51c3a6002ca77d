//! Estimators written down from their definitions in extended precision: slow, and independent of the program.

use super::arithmetic::{X, sum};

/// Phase of a stretch: running sum of the rate, 0 first.
pub fn phase(samples: &[f64]) -> Vec<X> {
    let mut x = vec![X::zero()];
    for y in samples {
        let next = x.last().expect("never empty") + &X::from(*y);
        x.push(next);
    }
    x
}

fn second(x: &[X], i: usize, m: usize) -> X {
    &x[i + 2 * m] - &(&X::from(2.0) * &x[i + m]) + &x[i]
}

/// σ² from a sum of squares over terms and the usual divisor.
fn deviation(squares: X, terms: usize, divisor: f64, m: usize, power: i32) -> Option<f64> {
    let scale = X::from(divisor) * X::from((m as f64).powi(power)) * X::from(terms);
    (terms > 0).then(|| (squares / scale).sqrt().to_f64())
}

/// Overlapping Allan deviation (SP 1065 equation 11), pooled over stretches.
pub fn overlapping_allan(stretches: &[Vec<X>], m: usize) -> Option<f64> {
    let (mut squares, mut terms) = (X::zero(), 0);
    for x in stretches {
        for i in 0..x.len().saturating_sub(2 * m) {
            squares = squares + second(x, i, m).square();
            terms += 1;
        }
    }
    deviation(squares, terms, 2.0, m, 2)
}

/// Modified Allan deviation (SP 1065 equation 14).
pub fn modified_allan(stretches: &[Vec<X>], m: usize) -> Option<f64> {
    let (mut squares, mut terms) = (X::zero(), 0);
    for x in stretches {
        let count = (x.len() + 1).saturating_sub(3 * m);
        let mut running = vec![X::zero()];
        for i in 0..x.len().saturating_sub(2 * m) {
            let next = running.last().expect("never empty") + &second(x, i, m);
            running.push(next);
        }
        for j in 0..count {
            squares = squares + (&running[j + m] - &running[j]).square();
            terms += 1;
        }
    }
    deviation(squares, terms, 2.0, m, 4)
}

/// Overlapping Hadamard deviation (SP 1065 equation 19).
pub fn overlapping_hadamard(stretches: &[Vec<X>], m: usize) -> Option<f64> {
    let (mut squares, mut terms) = (X::zero(), 0);
    let three = X::from(3.0);
    for x in stretches {
        for i in 0..x.len().saturating_sub(3 * m) {
            let d = &x[i + 3 * m] - &(&three * &x[i + 2 * m]) + &(&three * &x[i + m]) - &x[i];
            squares = squares + d.square();
            terms += 1;
        }
    }
    deviation(squares, terms, 6.0, m, 2)
}

/// Total deviation (SP 1065 equation 25) of one stretch: the phase continued by reflection at both ends.
pub fn total(x: &[X], m: usize) -> Option<f64> {
    let n = x.len() as i64;
    let at = |i: i64| -> X {
        let two = X::from(2.0);
        if i < 0 {
            &(&two * &x[0]) - &x[(-i) as usize]
        } else if i >= n {
            &(&two * &x[(n - 1) as usize]) - &x[(2 * n - 2 - i) as usize]
        } else {
            x[i as usize].clone()
        }
    };
    let step = m as i64;
    let squares = sum((1..n - 1).map(|i| (at(i - step) - X::from(2.0) * at(i) + at(i + step)).square()));
    deviation(squares, x.len().saturating_sub(2), 2.0, m, 2)
}

/// Mean.
pub fn mean(samples: &[f64]) -> X {
    sum(samples.iter().map(|y| X::from(*y))) / X::from(samples.len())
}

/// Standard deviation with n - 1.
pub fn standard_deviation(values: &[X]) -> f64 {
    let centre = sum(values.iter().cloned()) / X::from(values.len());
    let squares = sum(values.iter().map(|v| (v - &centre).square()));
    (squares / X::from(values.len() - 1)).sqrt().to_f64()
}

/// Averaged periodogram at some bins: Hann window, three quarters overlap, mean of each segment removed, two-sided, times the
/// sample interval.
pub fn welch(stretches: &[&[f64]], length: usize, bins: &[usize]) -> Vec<f64> {
    let turn = |k: usize| X::from(2.0) * X::pi() * X::from(k) / X::from(length);
    let cosines: Vec<X> = (0..length).map(|k| turn(k).cos()).collect();
    let sines: Vec<X> = (0..length).map(|k| turn(k).sin()).collect();
    let half = X::from(0.5);
    let window: Vec<X> = cosines.iter().map(|c| &half - &(&half * c)).collect();
    let power = sum(window.iter().map(X::square));
    let mut sums = vec![X::zero(); bins.len()];
    let mut segments = 0;
    for y in stretches {
        let mut from = 0;
        while from + length <= y.len() {
            let part = &y[from..from + length];
            let centre = mean(part);
            let windowed: Vec<X> =
                part.iter().zip(&window).map(|(y, w)| (X::from(*y) - &centre) * w).collect();
            for (total, k) in sums.iter_mut().zip(bins) {
                let (mut re, mut im) = (X::zero(), X::zero());
                for (i, v) in windowed.iter().enumerate() {
                    re = re + v * &cosines[k * i % length];
                    im = im + v * &sines[k * i % length];
                }
                *total = &*total + &(re.square() + im.square());
            }
            segments += 1;
            from += length / 4;
        }
    }
    let scale = power * X::from(segments.max(1));
    sums.into_iter().map(|s| (s / &scale).to_f64()).collect()
}

/// Standard deviation, skewness and excess kurtosis about the means of blocks; each mean takes a degree of freedom
/// from the variance.
pub fn moments(blocks: &[&[f64]]) -> (f64, f64, f64) {
    let [mut two, mut three, mut four] = [X::zero(), X::zero(), X::zero()];
    let mut count = 0;
    for block in blocks {
        let centre = mean(block);
        for y in *block {
            let d = X::from(*y) - &centre;
            let square = d.square();
            three = three + &square * &d;
            four = four + square.square();
            two = two + square;
        }
        count += block.len();
    }
    let n = X::from(count);
    let variance = two / X::from(count - blocks.len());
    if !variance.is_positive() {
        return (0.0, 0.0, 0.0);
    }
    let sigma = variance.sqrt();
    let skewness = three / &n / (&variance * &sigma);
    let kurtosis = four / &n / variance.square() - X::from(3.0);
    (sigma.to_f64(), skewness.to_f64(), kurtosis.to_f64())
}

/// Autocorrelation, biased estimate, of a series that may have holes: the pairs present scaled to the whole.
pub fn autocorrelation(series: &[f64], lag: usize) -> f64 {
    let present: Vec<f64> = series.iter().copied().filter(|v| v.is_finite()).collect();
    let centre = mean(&present);
    let d: Vec<Option<X>> = series.iter().map(|v| v.is_finite().then(|| X::from(*v) - &centre)).collect();
    let variance = sum(d.iter().flatten().map(X::square)) / X::from(present.len());
    let pairs: Vec<X> =
        d.iter().zip(d.iter().skip(lag)).filter_map(|(a, b)| Some(a.as_ref()? * b.as_ref()?)).collect();
    let (count, whole) = (X::from(pairs.len()), X::from(series.len() - lag) / X::from(series.len()));
    (sum(pairs) / count * whole / variance).to_f64()
}

/// A coefficient of the orthonormal DCT-II of a series less its mean, squared.
pub fn squared_mode(series: &[X], k: usize) -> X {
    let n = series.len();
    let centre = sum(series.iter().cloned()) / X::from(n);
    let step = X::pi() * X::from(k) / X::from(2 * n);
    let c = sum(series.iter().enumerate().map(|(j, y)| (y - &centre) * (&step * &X::from(2 * j + 1)).cos()));
    X::from(2.0) / X::from(n) * c.square()
}
