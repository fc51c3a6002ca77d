//! What the scale factor changes by over temperature, from rates that are repeated at several soaks.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use super::scale_factor_shape::of_largest;
use crate::estimate::{Component, Estimate, InputQuantity, normal_probability, student_quantile};
use crate::message::{Arg, Note, note};
use crate::numeric::reml::Combination;
use crate::rate_table::combine::spread;
use crate::rate_table::largest::{Largest, largest};
use crate::rate_table::scale_over_temperature::ScaleOverTemperature;

/// Largest difference of the scale factors of two temperatures.
pub static SF_OVER_TEMPERATURE_PEAK_TO_PEAK: Measurand = Measurand::of_steps(
    "sf_over_temperature_peak_to_peak",
    "ppm",
    "largest difference of the scale factors of two soak temperatures",
    Stimulus::Soaks,
    |m, e| of_soaks(m, e, |found| peak_to_peak(m, e, found)),
)
.also_called(&[
    "scale_factor_over_temperature",
    "sf_over_temperature",
    "scale_factor_over_temperature_peak_to_peak",
])
.formulas(
    &["y = Σ μ_l + b_s + k_s·K·Ω + e", "Δ_pp = max_{i,j} |k(T_i) − k(T_j)|"],
    "IEEE Std 952-2020, 12.9; GUM (JCGM 100)",
);

/// Largest difference of the scale factor between heating and cooling at one temperature.
pub static SF_TEMPERATURE_HYSTERESIS: Measurand = Measurand::of_steps(
    "sf_temperature_hysteresis",
    "ppm",
    "largest difference of the scale factor between heating and cooling at one soak temperature",
    Stimulus::Soaks,
    |m, e| of_soaks(m, e, |found| hysteresis(m, e, found)),
)
.also_called(&["sf_hysteresis_over_temperature", "scale_factor_temperature_hysteresis"]);

const METHOD: &str = "table_soaks";

/// The row of what the soaks show, or why they do not show it.
fn of_soaks(
    m: &Measurand,
    e: &TableEvidence<'_>,
    row: impl Fn(&ScaleOverTemperature) -> Estimate,
) -> Vec<Estimate> {
    let Some(soaks) = &e.over_temperature else { return vec![] };
    vec![shown(m, e, soaks, row)]
}

fn shown(
    m: &Measurand,
    e: &TableEvidence<'_>,
    soaks: &Result<ScaleOverTemperature, Note>,
    row: impl Fn(&ScaleOverTemperature) -> Estimate,
) -> Estimate {
    match soaks {
        Ok(found) => {
            let row = row(found);
            if found.scatter.is_some() { row.note(note!("soaks.gone_through_once")) } else { row }
        }
        Err(why) => m.not_identifiable(&e.channel, None, METHOD).note(why.clone()),
    }
}

fn degrees(value: f64) -> Arg {
    Arg::decimals(value, 1)
}

fn peak_to_peak(m: &Measurand, e: &TableEvidence<'_>, found: &ScaleOverTemperature) -> Estimate {
    let count = found.points.len();
    let pairs: Vec<(usize, usize)> = (0..count).flat_map(|i| (0..i).map(move |j| (j, i))).collect();
    let contrasts = pairs.iter().map(|(low, high)| found.difference(*high, *low)).collect();
    let (row, at) = largest_of(m, e, found, contrasts);
    let Some((low, high)) = at.and_then(|at| pairs.get(at)) else { return row };
    let [from, to] = [*low, *high].map(|p| degrees(found.temperature_of(p)));
    row.note(note!("soaks.between", n = count, from, to))
}

fn hysteresis(m: &Measurand, e: &TableEvidence<'_>, found: &ScaleOverTemperature) -> Estimate {
    let points = (0..found.points.len()).filter_map(|p| Some((p, found.both_ways(p)?)));
    let (points, contrasts): (Vec<usize>, Vec<Vec<f64>>) = points.unzip();
    if points.is_empty() {
        return m.not_identifiable(&e.channel, None, METHOD).note(note!("soaks.one_way"));
    }
    let count = points.len();
    let (row, at) = largest_of(m, e, found, contrasts);
    let Some(point) = at.and_then(|at| points.get(at)) else { return row };
    row.note(note!("soaks.both_ways", n = count, at = degrees(found.temperature_of(*point))))
}

/// The largest magnitude of these sums over soaks, and its position.
fn largest_of(
    m: &Measurand,
    e: &TableEvidence<'_>,
    found: &ScaleOverTemperature,
    contrasts: Vec<Vec<f64>>,
) -> (Estimate, Option<usize>) {
    let sums: Vec<_> = contrasts.iter().map(|w| found.contrast(w)).collect();
    let values: Vec<f64> = sums.iter().map(|s| s.value).collect();
    match largest(&values, &found.covariance(&contrasts), &|i| sums[i].dof) {
        Some(mut largest) => {
            lower_for_rivals(&mut largest, &sums);
            (of_largest(m, &e.channel, &largest, 1.0, METHOD), Some(largest.at))
        }
        None => (m.not_identifiable(&e.channel, None, METHOD).note(note!("soaks.undetermined")), None),
    }
}

/// Standard deviations within which a magnitude may be the largest in truth.
const RIVAL_SIGMAS: f64 = 3.0;

/// Lowers lower ends where several magnitudes may be the largest: that which came out largest is then too large by chance, and each of
/// them alone is claimed at a share of the risk (Bonferroni).
fn lower_for_rivals(largest: &mut Largest, sums: &[Combination]) {
    let Some(top) = sums.get(largest.at) else { return };
    let off = |s: &Combination| (top.value.abs() - s.value.abs()) / top.standard.hypot(s.standard);
    let rivals = sums.iter().filter(|s| off(s) <= RIVAL_SIGMAS).count().max(1) as f64;
    for (score, value) in largest.curve.iter_mut().filter(|(score, _)| *score < 0.0) {
        let quantile = student_quantile(1.0 - normal_probability(*score) / rivals, top.dof);
        *value = value.min((top.value.abs() - quantile * top.standard).max(0.0));
    }
}

/// Slope of the line of least squares through the temperatures, each with the same weight.
pub(super) fn slope(
    m: &Measurand,
    e: &TableEvidence<'_>,
    soaks: &Result<ScaleOverTemperature, Note>,
) -> Estimate {
    shown(m, e, soaks, |found| {
        let weights = found.slope_weights();
        let slope = found.contrast(&weights);
        let temperatures = found.temperatures();
        let range = temperatures.last().zip(temperatures.first()).map_or(0.0, |(high, low)| high - low);
        // Calibration at both ends of the range, and the scatter of the readings.
        let calibration = std::f64::consts::SQRT_2 / range * e.setup.temperature_uncertainty_deg_c;
        let relative = calibration.hypot(found.temperature_scatter(&weights));
        let reading = [Component::of(
            InputQuantity::Thermometer,
            relative * range / std::f64::consts::SQRT_2,
            "degC",
            std::f64::consts::SQRT_2 / range * slope.value,
        )];
        m.measured(&e.channel, slope.value, spread(&slope, 1.0, &reading), METHOD)
            .components(&reading)
            .note(note!("on_table.temperature_range", range = Arg::figures(range, 3)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(value: f64) -> Combination {
        Combination { value, standard: 1.0, dof: 1e9 }
    }

    /// The lower end at 2.275 % of the largest of these, each with a standard deviation of one.
    fn lower(values: &[f64]) -> f64 {
        let sums: Vec<Combination> = values.iter().map(|v| sum(*v)).collect();
        let curve = vec![(-2.0, 9.5), (0.0, 10.0), (2.0, 12.0)];
        let mut found = Largest { at: 0, value: 10.0, curve, by_chance: 0.0 };
        lower_for_rivals(&mut found, &sums);
        assert_eq!(found.curve[1..], [(0.0, 10.0), (2.0, 12.0)]);
        found.curve[0].1
    }

    #[test]
    fn rivals_share_the_risk_of_a_lower_end() {
        assert!((lower(&[10.0, 2.0]) - 8.0).abs() < 1e-3);
        // Normal quantiles of half and of a quarter of 2.275 %.
        assert!((lower(&[10.0, -9.5]) - 7.722).abs() < 2e-3, "{}", lower(&[10.0, -9.5]));
        assert!((lower(&[10.0, 9.0, 8.0, -9.5]) - 7.470).abs() < 2e-3, "{}", lower(&[10.0, 9.0, 8.0, -9.5]));
    }
}
