//! Tests of the residual against the recorded columns: any smooth function of one, its rate of change, or a product of
//! two; and the size of the residual over each.

use super::departure::{Departure, White};
use crate::effect::{Column, Domain, Place};
use crate::estimate::{ln_chi_square_tail, ln_normal_two_sided};
use crate::mismatch::several::ln_least_of;
use crate::mismatch::spectral_data::{SpectralData, smoothed};
use crate::numeric::cosine::dct2;
use crate::numeric::order::SortByNumber;
use crate::numeric::range::{Bounds, ends};
use crate::numeric::special::{f_normal, legendre};
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;

/// Order of the polynomials of a column.
const POLYNOMIAL_ORDER: usize = 6;
/// Groups by value of a column for the size of the residual.
const VALUE_GROUPS: usize = 8;

fn domain(column: Column) -> Domain {
    match column {
        Column::Temperature => Domain::Temperature,
        Column::TableRate => Domain::InputRate,
        Column::TableAngle => Domain::Angle,
        Column::OuterRate => Domain::OuterRate,
        Column::Supply => Domain::Supply,
        Column::Other(_) => Domain::Driver,
    }
}

/// Every test against columns.
pub fn all(spectral: &SpectralData, white: &White) -> Vec<Departure> {
    let mut named: Vec<(Domain, Cow<'_, [f64]>)> = vec![];
    for column in spectral.drivers.columns() {
        let Some(values) = spectral.drivers.column(column) else { continue };
        let values =
            if column == Column::Temperature { smoothed(values).into() } else { Cow::Borrowed(values) };
        if column == Column::Temperature {
            let per_minute = 60.0 / spectral.drivers.dt_s;
            let rate: Vec<f64> = derivative(&values).iter().map(|d| d * per_minute).collect();
            named.push((Domain::TemperatureRate, rate.into()));
        }
        named.push((domain(column), values));
    }
    let mut out: Vec<Departure> = vec![];
    for (place, values) in &named {
        let found = [function_of(white, "column_mean", *place, values), size_over(white, *place, values)];
        out.extend(found.into_iter().flatten().map(|d| when(d, spectral, values)));
    }
    for i in 0..named.len() {
        for j in 0..i {
            let mut product = centred(&named[i].1);
            product.iter_mut().zip(centred(&named[j].1)).for_each(|(x, y)| *x *= y);
            if let Some(ln_p) = gain_of(white, std::iter::once(product)) {
                let Bounds { low: from, high: to } = ends(&named[j].1);
                let place = Place { domain: named[j].0, from, to };
                out.push(Departure { test: "product", place, beside: None, ln_p, shape: None });
            }
        }
    }
    out
}

fn derivative(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    (0..n)
        .map(|i| {
            let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
            (values[b] - values[a]) / (b - a).max(1) as f64
        })
        .collect()
}

fn centred(values: &[f64]) -> Vec<f64> {
    let Bounds { low, high } = ends(values);
    let (middle, half) = (0.5 * (low + high), (0.5 * (high - low)).max(1e-300));
    values.iter().map(|v| (v - middle) / half).collect()
}

/// ln of the p-value of the power of the whitened residual in the span of some columns.
fn gain_of(white: &White, columns: impl Iterator<Item = Vec<f64>>) -> Option<f64> {
    let whitened = |column: Vec<f64>| {
        let mut modes = dct2(&column);
        modes.iter_mut().zip(&white.roots).for_each(|(z, r)| *z /= r);
        modes
    };
    let modes: Vec<Vec<f64>> = columns.map(whitened).collect();
    let p = modes.len();
    let mut matrix = DMatrix::zeros(p, p);
    let mut right = DVector::zeros(p);
    for i in 0..p {
        for j in 0..=i {
            let v: f64 = modes[i].iter().zip(&modes[j]).skip(1).map(|(a, b)| a * b).sum();
            matrix[(i, j)] = v;
            matrix[(j, i)] = v;
        }
        right[i] = modes[i].iter().zip(&white.modes).skip(1).map(|(a, u)| a * u).sum();
    }
    let scale: Vec<f64> = (0..p).map(|i| matrix[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| !s.is_finite() || *s <= 0.0) {
        return None;
    }
    for i in 0..p {
        for j in 0..p {
            matrix[(i, j)] /= scale[i] * scale[j];
        }
        right[i] /= scale[i];
        matrix[(i, i)] += 1e-9;
    }
    let solution = matrix.cholesky()?.solve(&right);
    Some(ln_chi_square_tail(right.dot(&solution), p as f64))
}

/// The times between which a column has the values of a departure.
fn when(departure: Departure, spectral: &SpectralData, values: &[f64]) -> Departure {
    let Place { domain, from, to } = departure.place;
    // Sizes of the rate stand for both signs of it.
    let inside = |v: &f64| {
        let held = from..=to;
        held.contains(v) || (domain == Domain::InputRate && held.contains(&v.abs()))
    };
    let ends = values.iter().position(inside).zip(values.iter().rposition(inside));
    let beside = ends.map(|(a, b)| Place {
        domain: Domain::Time,
        from: spectral.drivers.time_s(a),
        to: spectral.drivers.time_s(b),
    });
    Departure { beside, ..departure }
}

/// Test of a residual that follows a smooth function of a column, with the values of the column at which it does so most.
fn function_of(white: &White, test: &'static str, domain: Domain, values: &[f64]) -> Option<Departure> {
    let Bounds { low, high } = ends(values);
    if high - low <= 1e-9 * low.abs().max(high.abs()) {
        return None;
    }
    let ln_p = if domain == Domain::Angle {
        let turn = |k: usize, f: fn(f64) -> f64| {
            values.iter().map(|a| f(k as f64 * a.to_radians())).collect::<Vec<f64>>()
        };
        gain_of(
            white,
            (1..=POLYNOMIAL_ORDER).map(|i| turn(i.div_ceil(2), if i % 2 == 1 { f64::cos } else { f64::sin })),
        )
    } else {
        let x = centred(values);
        gain_of(white, (1..=POLYNOMIAL_ORDER).map(|k| x.iter().map(|v| legendre(k, *v)).collect()))
    }?;
    let Bounds { low: from, high: to } = extreme(white, values, low, high);
    Some(Departure { test, place: Place { domain, from, to }, beside: None, ln_p, shape: None })
}

/// The tenth of the range of a column in which the weighted residual is farthest from zero.
fn extreme(white: &White, values: &[f64], low: f64, high: f64) -> Bounds {
    const VALUE_PARTS: usize = 10;
    let mut sums = [(0.0, 0.0); VALUE_PARTS];
    for (e, v) in white.series.iter().zip(values) {
        let i = (((v - low) / (high - low) * VALUE_PARTS as f64) as usize).min(VALUE_PARTS - 1);
        sums[i].0 += e;
        sums[i].1 += 1.0;
    }
    let z = |i: usize| if sums[i].1 > 0.0 { (sums[i].0 / f64::sqrt(sums[i].1)).abs() } else { 0.0 };
    let best = (0..VALUE_PARTS).max_by(|a, b| z(*a).total_cmp(&z(*b))).unwrap_or(0);
    let step = (high - low) / VALUE_PARTS as f64;
    Bounds::new(low + best as f64 * step, low + (best + 1) as f64 * step)
}

/// Test of a size of the whitened residual that depends on a column.
fn size_over(white: &White, domain: Domain, values: &[f64]) -> Option<Departure> {
    let n = values.len();
    if n < 64 * VALUE_GROUPS || domain == Domain::Angle {
        return None;
    }
    let Bounds { low, high } = ends(values);
    if high - low <= 1e-9 * low.abs().max(high.abs()) {
        return None;
    }
    let by = |i: usize| if domain == Domain::InputRate { values[i].abs() } else { values[i] };
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_ascending_by(|a| by(*a));
    let whole: f64 = white.series.iter().map(|e| e * e).sum();
    let mut best = (0.0, 0.0, 0.0);
    let mut trials = 0.0f64;
    for group in order.chunks(n / VALUE_GROUPS) {
        if group.len() < 32 {
            continue;
        }
        let inside: f64 = group.iter().map(|i| white.series[*i].powi(2)).sum();
        let (length, rest) = (group.len() as f64, (n - group.len()) as f64);
        let z = f_normal((inside / length) / ((whole - inside) / rest), length, rest);
        let p = ln_normal_two_sided(z);
        trials += 1.0;
        if p < best.0 {
            let (a, b) = (by(group[0]), by(group[group.len() - 1]));
            best = (p, a.min(b), a.max(b));
        }
    }
    let place = Place { domain, from: best.1, to: best.2 };
    Some(Departure { test: "size", place, beside: None, ln_p: ln_least_of(best.0, trials), shape: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_of_a_column_where_the_residual_is_largest_is_found() {
        let values: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0).collect();
        let series: Vec<f64> = values
            .iter()
            .enumerate()
            .map(|(i, v)| if (7.0..8.0).contains(v) { 1.0 } else { [-0.5, 0.5][i % 2] })
            .collect();
        let white = White { modes: vec![], series, roots: vec![] };
        let Bounds { low: from, high: to } = extreme(&white, &values, 0.0, 10.0);
        assert!((from - 7.0).abs() < 1e-9 && (to - 8.0).abs() < 1e-9, "{from} {to}");
        assert_eq!(centred(&[0.0, 5.0, 10.0]), [-1.0, 0.0, 1.0]);
        assert_eq!(derivative(&[0.0, 1.0, 4.0]), [1.0, 2.0, 3.0]);
    }
}
