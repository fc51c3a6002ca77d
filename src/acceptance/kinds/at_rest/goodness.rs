//! Goodness of fit in words: where the model fails, and by how much.

use crate::i18n::{Arg, Note, note};
use crate::measurand::GyroEvidence;
use crate::noise::residual::{GoodnessOfFit, Judged, TAIL_DEVIATIONS, View};
use crate::record::GoodnessOfFitRecord;

/// The views of a channel.
pub fn records(gyro: &GyroEvidence) -> Vec<GoodnessOfFitRecord> {
    let fit = &gyro.goodness;
    let failures: Vec<View> = fit.failures().iter().map(|j| j.view).collect();
    fit.views
        .iter()
        .map(|judged| {
            let departs = failures.contains(&judged.view);
            GoodnessOfFitRecord {
                channel: gyro.channel.clone(),
                view: judged.view,
                statistic: judged.statistic,
                p_value: judged.p_value,
                departs,
                from: judged.departure.from,
                to: Some(judged.departure.to).filter(|v| v.is_finite()),
                excess: judged.departure.excess,
                message: if departs { departure(judged, fit) } else { note!("goodness.fits") }.into(),
            }
        })
        .collect()
}

/// Excess from which a ratio reads better than percent.
const MIN_RATIO_EXCESS: f64 = 1.0;

/// Where and by how much.
fn departure(judged: &Judged, fit: &GoodnessOfFit) -> Note {
    let place = &judged.departure;
    let figure = |v: f64| Arg::Figures { value: v, digits: 3, zeros: false };
    let percent = Arg::Figures { value: 100.0 * place.excess.abs(), digits: 2, zeros: false };
    let times = Arg::Figures { value: 1.0 + place.excess, digits: 2, zeros: true };
    let more = place.excess >= 0.0;
    match judged.view {
        View::Frequency if place.excess >= MIN_RATIO_EXCESS => {
            note!("goodness_times.frequency", from_hz = figure(place.from), to_hz = figure(place.to), times)
        }
        View::Frequency => {
            Note::new(if more { "goodness.frequency_more" } else { "goodness.frequency_less" })
                .with("from_hz", figure(place.from))
                .with("to_hz", figure(place.to))
                .with("percent", percent)
        }
        View::Lag => {
            let two = Arg::Figures { value: place.excess, digits: 2, zeros: false };
            note!("goodness.lag", lag_s = figure(place.from), correlation = two)
        }
        View::AveragingTime if place.excess >= MIN_RATIO_EXCESS && place.from < place.to => {
            note!("goodness_times.averaging", from_s = figure(place.from), to_s = figure(place.to), times)
        }
        View::AveragingTime => {
            let key = match (place.from < place.to, more) {
                (true, true) => "goodness.averaging_above",
                (true, false) => "goodness.averaging_below",
                (false, true) => "goodness.averaging_above_at",
                (false, false) => "goodness.averaging_below_at",
            };
            let note = Note::new(key).with("from_s", figure(place.from)).with("percent", percent);
            if place.from < place.to { note.with("to_s", figure(place.to)) } else { note }
        }
        View::Jump => note!(
            "goodness.jump",
            time_s = figure(0.5 * (place.from + place.to)),
            size = Arg::Figures { value: place.excess, digits: 3, zeros: true },
            deviations = Arg::Figures { value: judged.statistic.abs(), digits: 2, zeros: true }
        ),
        View::Amplitude => {
            let found = fit.amplitude.as_ref();
            note!(
                "goodness.amplitude",
                n = found.map_or(0, |a| a.beyond),
                sigma = Arg::Stated(TAIL_DEVIATIONS),
                expected = figure(found.map_or(0.0, |a| a.expected_beyond)),
                kurtosis = figure(found.map_or(0.0, |a| a.excess_kurtosis)),
                skewness = figure(found.map_or(0.0, |a| a.skewness))
            )
        }
    }
}
