//! The figures of an explanation: the residual over time, in the spectrum, against the located column, and its level.

use super::departures::White;
use super::figures::{Against, Spectra, TimeSeries, against, local_level, spectrum, time_course};
use super::fitted_hypothesis::FittedHypothesis;
use super::problem::Problem;
use crate::effect::{Column, Domain, Drivers, Place};
use crate::figure::Figure;
use crate::numeric::cosine::inverse_dct2;

/// Intervals of the level over time.
const LEVEL_INTERVALS: usize = 100;

/// Data of the figures.
pub struct FigureData<'a> {
    /// Residual of the claim with everything still in it, on the grid, deg/h.
    pub before: &'a [f64],
    /// Fit of the claim.
    pub base: &'a FittedHypothesis,
    /// Fit of the augmented claim.
    pub best: &'a FittedHypothesis,
    /// Course that was added, deg/h.
    pub correction: Option<&'a [f64]>,
    /// True when anything was added.
    pub added: bool,
    /// Intervals in which the mismatch was located, principal one first.
    pub places: &'a [Place],
}

/// Every figure, that of the located view first.
pub fn all(problem: &Problem, drawn: &FigureData<'_>) -> Vec<Figure> {
    let drivers = &problem.drivers;
    let time: Vec<f64> = (0..drivers.samples).map(|i| drivers.time_s(i)).collect();
    let mean = drawn.before.iter().sum::<f64>() / drawn.before.len().max(1) as f64;
    let before: Vec<f64> = drawn.before.iter().map(|v| v - mean).collect();
    let after: Option<Vec<f64>> = drawn.correction.map(|c| {
        let left: Vec<f64> = before.iter().zip(c).map(|(b, c)| b - c).collect();
        let mean = left.iter().sum::<f64>() / left.len().max(1) as f64;
        left.iter().map(|l| l - mean).collect()
    });
    // A draw over the residual has its mean taken out as the residual has.
    let contribution: Option<Vec<f64>> = drawn.correction.map(|c| {
        let mean = c.iter().sum::<f64>() / c.len().max(1) as f64;
        c.iter().map(|v| v - mean).collect()
    });
    let course = time_course(&TimeSeries {
        time_s: &time,
        before: &before,
        after: after.as_deref(),
        contribution: contribution.as_deref(),
        places: drawn.places,
    });
    let mut found: Vec<(Domain, Figure)> = vec![(Domain::Time, course)];
    found.extend(spectra(problem, drawn).map(|f| (Domain::Frequency, f)));
    for place in drawn.places {
        let Some(column) = column(place.domain, drivers) else { continue };
        let figure = against(&Against {
            domain: place.domain,
            column: &column,
            before: &before,
            after: after.as_deref(),
            contribution: contribution.as_deref(),
            places: drawn.places,
        });
        found.extend(figure.map(|f| (place.domain, f)));
    }
    found.push((Domain::Amplitude, levels(problem, drawn)));
    let principal = drawn.places.first().map(|p| match p.domain {
        Domain::Lag => Domain::Frequency,
        Domain::Timestamps => Domain::Time,
        other => other,
    });
    found.sort_by_key(|(domain, _)| Some(*domain) != principal);
    found.into_iter().map(|(_, f)| f).collect()
}

fn column(domain: Domain, drivers: &Drivers) -> Option<Vec<f64>> {
    let of = |c: Column| drivers.column(c).map(<[f64]>::to_vec);
    match domain {
        Domain::Temperature => of(Column::Temperature),
        Domain::TemperatureRate => {
            let t = drivers.smooth_temperature.as_ref()?;
            let per_minute = 30.0 / drivers.dt_s;
            let n = t.len();
            let at = |i: usize| (t[(i + 1).min(n - 1)] - t[i.saturating_sub(1)]) * per_minute;
            Some((0..n).map(at).collect())
        }
        Domain::InputRate => of(Column::TableRate),
        Domain::OuterRate => of(Column::OuterRate),
        Domain::Angle => of(Column::TableAngle),
        Domain::Supply => of(Column::Supply),
        _ => None,
    }
}

fn spectra(problem: &Problem, drawn: &FigureData<'_>) -> Option<Figure> {
    let spectral = &problem.spectra.full;
    let frequency: Vec<f64> = spectral.bins.iter().map(|b| b.frequency_hz).collect();
    let dof: Vec<f64> = spectral.bins.iter().map(|b| spectral.weight(b)).collect();
    spectrum(&Spectra {
        frequency_hz: &frequency,
        dof: &dof,
        observed: &drawn.base.fit.observed,
        observed_after: drawn.added.then_some(drawn.best.fit.observed.as_slice()),
        claim: &drawn.base.fit.densities,
        augmented: drawn.added.then_some(drawn.best.fit.densities.as_slice()),
        places: drawn.places,
    })
}

fn levels(problem: &Problem, drawn: &FigureData<'_>) -> Figure {
    let of = |tried: &FittedHypothesis| {
        let series = inverse_dct2(&White::of(tried, &problem.spectra).modes);
        let group = (series.len() / LEVEL_INTERVALS).max(1);
        let points: Vec<(f64, f64)> = series
            .chunks_exact(group)
            .enumerate()
            .map(|(g, c)| {
                let middle = problem.drivers.time_s(g * group) + 0.5 * group as f64 * problem.drivers.dt_s;
                (middle, c.iter().map(|e| e * e).sum::<f64>() / c.len() as f64)
            })
            .collect();
        (points, group as f64)
    };
    let (before, values) = of(drawn.base);
    let after = drawn.added.then(|| of(drawn.best).0);
    local_level(&before, after.as_deref(), values, drawn.places)
}
