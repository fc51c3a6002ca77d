//! The figures of an explanation: which views are drawn, from a fitted problem. The located view comes first.

use super::candidates::Tried;
use super::departures::White;
use super::estimates;
use super::figures::{Against, Course, Spectra, against, local_level, spectrum, time_course};
use super::finding::{Finding, PlaceRecord};
use super::problem::Problem;
use crate::effect::{Domain, Drivers, Place};
use crate::figure::Figure;
use crate::numeric::cosine::inverse_dct2;

/// Intervals of the level over time.
const INTERVALS: usize = 150;
/// Share of the record from which a place is the whole of it.
const WHOLE: f64 = 0.97;
/// Domains that a place can name.
const DOMAINS: [Domain; 11] = [
    Domain::Time,
    Domain::Frequency,
    Domain::Lag,
    Domain::Temperature,
    Domain::TemperatureRate,
    Domain::InputRate,
    Domain::OuterRate,
    Domain::Angle,
    Domain::Amplitude,
    Domain::Timestamps,
    Domain::Supply,
];
/// Kinds that show in the size of the residual and not in its mean.
const OF_SIZE: [&str; 4] = ["noise_variance_time", "noise_variance_rate", "outlier_bursts", "unknown"];

fn place(record: &PlaceRecord) -> Option<Place> {
    let domain = DOMAINS.into_iter().find(|d| d.id() == record.domain)?;
    Some(Place { domain, from: record.from, to: record.to })
}

/// Draws what there is to see of a claim, `base`, and of the claim with what was found, `best`.
pub fn all(problem: &Problem, base: &Tried, best: &Tried, findings: &[Finding]) -> Vec<Figure> {
    let scene = &problem.scenes.full;
    let drivers = &scene.drivers;
    let located: Vec<Place> = findings.iter().flat_map(|f| f.places.iter().filter_map(place)).collect();
    // The whole record shaded shows no place.
    let whole = |p: &Place| p.domain == Domain::Time && p.to - p.from >= WHOLE * drivers.length_s();
    let places: Vec<Place> = located.iter().copied().filter(|p| !whole(p)).collect();
    let changed = findings.iter().any(|f| f.kind != "unknown");
    // What was filled in for missing rows is not shown.
    let shown = |mut series: Vec<f64>| {
        series.iter_mut().zip(&problem.usable).filter(|(_, u)| !**u).for_each(|(v, _)| *v = f64::NAN);
        series
    };
    let residual = inverse_dct2(&base.fit.mean.residual);
    let contribution = estimates::correction(best, &problem.scenes).map(centred);
    let after = contribution.as_ref().map(|c| shown(residual.iter().zip(c).map(|(r, c)| r - c).collect()));
    let before = shown(residual);
    let time_s: Vec<f64> = (0..drivers.samples).map(|i| drivers.time_s(i)).collect();

    let mut drawn: Vec<(Vec<Domain>, Figure)> = vec![];
    let course = Course {
        time_s: &time_s,
        before: &before,
        after: after.as_deref(),
        contribution: contribution.as_deref(),
        places: &places,
    };
    drawn.push((vec![Domain::Time, Domain::Timestamps], time_course(&course)));
    for domain in DOMAINS.into_iter().filter(|d| places.iter().any(|p| p.domain == *d)) {
        let Some(column) = column(drivers, domain) else { continue };
        let figure = against(&Against {
            domain,
            column: &column,
            before: &before,
            after: after.as_deref(),
            contribution: contribution.as_deref(),
            places: &places,
        });
        drawn.extend(figure.map(|f| (vec![domain], f)));
    }
    if findings.iter().any(|f| OF_SIZE.contains(&f.kind.as_str())) {
        let before = levels(drivers, &White::of(&base.fit).series);
        let after = changed.then(|| levels(drivers, &White::of(&best.fit).series));
        let values = interval(drivers) as f64;
        let figure = local_level(&before, after.as_deref(), values, &places);
        drawn.push((vec![Domain::Amplitude], figure));
    }
    let frequency_hz: Vec<f64> = scene.bins.iter().map(|b| b.frequency_hz).collect();
    let dof: Vec<f64> = scene.bins.iter().map(|b| scene.weight(b)).collect();
    let observed = scene.observed(&base.fit.mean.residual);
    let left = changed.then(|| scene.observed(&best.fit.mean.residual));
    let figure = spectrum(&Spectra {
        frequency_hz: &frequency_hz,
        dof: &dof,
        observed: &observed,
        observed_after: left.as_deref().filter(|_| !best.hypothesis.courses.is_empty()),
        claim: &base.fit.densities,
        augmented: changed.then_some(best.fit.densities.as_slice()),
        places: &places,
    });
    drawn.extend(figure.map(|f| (vec![Domain::Frequency, Domain::Lag], f)));
    if let Some(principal) = located.first() {
        drawn.sort_by_key(|(views, _)| !views.contains(&principal.domain));
    }
    drawn.into_iter().map(|(_, figure)| figure).collect()
}

/// A series about its mean: the bias is free.
fn centred(mut series: Vec<f64>) -> Vec<f64> {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    series.iter_mut().for_each(|v| *v -= mean);
    series
}

/// The column of a view, in the unit of its domain.
fn column(drivers: &Drivers, domain: Domain) -> Option<Vec<f64>> {
    match domain {
        Domain::Temperature => drivers.smooth_temperature.clone(),
        Domain::TemperatureRate => {
            let smooth = drivers.smooth_temperature.as_ref()?;
            let last = smooth.len().checked_sub(1)?;
            let slope = |i: usize| {
                let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
                60.0 * (smooth[b] - smooth[a]) / ((b - a).max(1) as f64 * drivers.dt_s)
            };
            Some((0..smooth.len()).map(slope).collect())
        }
        Domain::InputRate => drivers.table_rate.clone(),
        Domain::OuterRate => drivers.outer_rate.clone(),
        Domain::Angle => drivers.table_angle.clone(),
        Domain::Supply => drivers.supply.clone(),
        _ => None,
    }
}

/// Samples of an interval of the level.
fn interval(drivers: &Drivers) -> usize {
    drivers.samples.div_ceil(INTERVALS).max(1)
}

/// Mean square of a whitened series over intervals.
fn levels(drivers: &Drivers, white: &[f64]) -> Vec<(f64, f64)> {
    let length = interval(drivers);
    let level = |(i, values): (usize, &[f64])| {
        let middle = drivers.time_s(i * length) + 0.5 * (length - 1) as f64 * drivers.dt_s;
        (middle, values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64)
    };
    white.chunks_exact(length).enumerate().map(level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim::parse;
    use crate::mismatch::regular::Regular;
    use crate::noise::model::NoiseModel;
    use crate::noise::simulate::{Setup, Simulator};
    use std::collections::BTreeMap;

    #[test]
    fn the_located_view_comes_first_and_every_place_is_a_domain() {
        let text =
            b"[recording]\nsample_rate_hz = 1\n[noise]\nN_deg_rt_h = 0.01\n[bias]\nvalue_deg_h = 0.0\n";
        let Ok(model) = parse("m.toml", text) else { panic!("a model") };
        let noise = NoiseModel { n: 0.01, ..NoiseModel::default() };
        let rate = Simulator::new(&noise, &Setup::for_record(9, 1.0, 2048)).take(2048);
        let time: Vec<f64> = (0..2048).map(f64::from).collect();
        let temperature = time.iter().map(|t| 20.0 + (t / 300.0).sin()).collect();
        let columns = BTreeMap::from([(crate::effect::Column::Temperature, temperature)]);
        let Ok(regular) = Regular::new(&time, &rate, &columns, 1.0) else { panic!("a grid") };
        let problem = Problem::new(regular, &model.claim);
        let base = problem.baseline();
        let ids = |domain: &str| {
            let place = PlaceRecord { domain: domain.into(), from: 20.0, to: 21.0 };
            let finding = Finding {
                kind: "unknown".into(),
                equivalents: vec![],
                parameters: BTreeMap::new(),
                places: vec![place],
                delta_bic: 10.0,
                p_value: 1e-5,
                heldout_gain: None,
                removed_share: None,
            };
            let figures = all(&problem, &base, &base, &[finding]);
            figures.into_iter().map(|f| f.id).collect::<Vec<_>>()
        };
        assert_eq!(ids("frequency")[0], "residual_spectrum");
        assert_eq!(ids("temperature")[0], "residual_against_temperature");
        assert_eq!(ids("amplitude")[0], "level_over_time");
        assert_eq!(ids("supply"), ["residual_over_time", "level_over_time", "residual_spectrum"]);
        // White noise whitened by its own model: mean squares about 1.
        let levels = levels(&problem.drivers, &White::of(&base.fit).series);
        let mean = levels.iter().map(|l| l.1).sum::<f64>() / levels.len() as f64;
        assert!((mean - 1.0).abs() < 0.15, "{mean}");
    }
}
