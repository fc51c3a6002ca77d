//! A result as a claim about its unit, which later recordings are held against.

use super::verdict::contradicted;
use crate::claim::{Claim, Coefficient, Stated, Uncertainty};
use crate::effect::{ClaimedMean, Model, SpectrumAct};
use crate::estimate::normal_quantile;
use crate::i18n::{Note, note};
use crate::measurand;
use crate::noise::model::NoiseModel;
use crate::record::{MeasurandRecord, RunRecord};

/// The claim of a result: noise coefficients and mean with their uncertainties, of one channel. Notes tell what it leaves out.
///
/// # Errors
/// A note where the channel is not there or not the only one, or where nothing was measured that makes a claim.
pub fn claim(record: &RunRecord, channel: Option<&str>) -> Result<(Claim, Vec<Note>), Note> {
    let mut channels: Vec<&str> = record.noise_models.iter().map(|m| m.channel.as_str()).collect();
    channels.dedup();
    let channel = match (channel, channels.as_slice()) {
        (Some(asked), known) if known.contains(&asked) => asked,
        (None, [only]) => *only,
        (_, []) => return Err("model_verb.no_noise".into()),
        (_, known) => return Err(note!("model_verb.channels", known = known.join(", "))),
    };
    let row = |id: &str| record.measurands.iter().find(|m| m.id == id && m.channel == channel);
    let [n, b, k, q] = [
        &measurand::ANGLE_RANDOM_WALK,
        &measurand::BIAS_INSTABILITY,
        &measurand::RATE_RANDOM_WALK,
        &measurand::QUANTIZATION,
    ]
    .map(|m| row(m.id).map(known).unwrap_or_default());
    let interval_s = record.recording.first().map(|f| f.sample_interval_s).filter(|dt| *dt > 0.0);
    let (Some(interval_s), true) = (interval_s, n.value > 0.0 || b.value > 0.0 || k.value > 0.0) else {
        return Err("model_verb.no_noise".into());
    };
    // The rate at rest contains the rotation of the Earth; a bias does not.
    let earth = row(measurand::EARTH_RATE_COMPONENT.id).and_then(|m| m.value).unwrap_or(0.0);
    let bias = row(measurand::STATIC_BIAS.id);
    let deviation = bias.and_then(standard_uncertainty).unwrap_or(0.0);
    let mut notes = contradicted(record.measurands.iter().filter(|m| m.channel == channel));
    let model = record.noise_models.iter().find(|m| m.channel == channel);
    let processes = model.map_or(0, |m| m.markov.len() + m.quasi_periodic.len());
    if processes > 0 {
        notes.push(note!("model_verb.processes", n = processes));
    }
    if bias.is_none() {
        notes.push("model_verb.no_bias".into());
    }
    let claim = Claim {
        case: String::new(),
        description: Default::default(),
        sample_rate_hz: 1.0 / interval_s,
        columns: None,
        noise: NoiseModel { n: n.value, b: b.value, k: k.value, r: 0.0, q: q.value },
        quantization_lsb_arcsec: q.value * 12_f64.sqrt(),
        mean: ClaimedMean {
            bias_deg_h: bias.and_then(|m| m.value).unwrap_or(0.0) + earth,
            ..ClaimedMean::default()
        },
        uncertainty: Uncertainty {
            n_rel: n.relative,
            b_rel: b.relative,
            k_rel: k.relative,
            n_at_most_deg_rt_h: n.at_most,
            b_at_most_deg_h: b.at_most,
            k_at_most_deg_h_rt_h: k.at_most,
            // Nothing is known of a bias that was not measured.
            bias_deg_h: if bias.is_some() { deviation } else { UNMEASURED_SIGMA_DEG_H },
            ..Uncertainty::default()
        },
        effects: vec![],
    };
    Ok((claim, notes))
}

/// A claim that was identified, with the effects of an augmented one that belong to the unit, and with the third standardised moment
/// that its noise may have. Noise and mean are those beside the effects, if all of these are kept.
pub fn with_lasting(claim: Claim, augmented: &Claim, skewness: f64) -> Claim {
    let spectrum = |stated: &Stated| match stated.effect.model() {
        Model::Spectrum(s) => Some(s),
        _ => None,
    };
    // Beside a process a filter is one of several shapes that describe a spectrum, and is not known by itself: a claim of a filter
    // that is not there weighs what a later recording shows behind it far too much.
    let beside_process = augmented.effects.iter().filter_map(spectrum).any(|s| s.has_course());
    let filters = |stated: &Stated| spectrum(stated).is_some_and(|s| s.act() == SpectrumAct::Filters);
    let lasts = |stated: &&Stated| stated.effect.is_carried_over() && !(beside_process && filters(stated));
    let effects: Vec<Stated> = augmented.effects.iter().filter(lasts).cloned().collect();
    let uncertainty = Uncertainty { skewness, ..claim.uncertainty };
    let claim = Claim { uncertainty, ..claim };
    if effects.len() < augmented.effects.len() {
        return Claim { effects, ..claim };
    }
    Claim {
        effects,
        noise: augmented.noise,
        quantization_lsb_arcsec: augmented.quantization_lsb_arcsec,
        mean: augmented.mean,
        ..claim
    }
}

/// Standard uncertainty of what was not measured, deg/h.
const UNMEASURED_SIGMA_DEG_H: f64 = 1e6;

fn standard_uncertainty(row: &MeasurandRecord) -> Option<f64> {
    let interval = row.interval?;
    Some((interval.high - interval.low) / (2.0 * normal_quantile(0.5 + 0.5 * interval.coverage)))
}

fn known(row: &MeasurandRecord) -> Coefficient {
    match row.value.filter(|v| *v > 0.0) {
        Some(value) => Coefficient::found(value, row.interval.map(|i| (i.low, i.high))),
        None => {
            let most = row.upper_limit.map_or(0.0, |limit| limit.value);
            Coefficient::at_most(most.max(row.most_likely.unwrap_or(0.0)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::find;

    fn stated(kind: &str) -> Stated {
        Stated { effect: find(kind).unwrap(), values: Default::default() }
    }

    #[test]
    fn effects_of_a_moment_are_left_out_and_those_of_the_unit_kept() {
        let kinds = |claim: &Claim| claim.effects.iter().map(|s| s.effect.kind()).collect::<Vec<_>>();
        let text = b"[recording]\nsample_rate_hz = 1.0\n[noise]\nN_deg_rt_h = 0.1\n";
        let identified = crate::config::model::parse("m.toml", text).unwrap().claim;
        let mut augmented = identified.clone();
        augmented.noise.n = 0.5;
        augmented.effects = vec![stated("bandwidth_filter")];
        let kept = with_lasting(identified.clone(), &augmented, 0.02);
        assert_eq!((kinds(&kept), kept.noise.n), (vec!["bandwidth_filter"], 0.5));
        assert_eq!(kept.uncertainty.skewness, 0.02);
        augmented.effects.push(stated("bias_step"));
        let kept = with_lasting(identified.clone(), &augmented, 0.0);
        assert_eq!((kinds(&kept), kept.noise.n), (vec!["bandwidth_filter"], identified.noise.n));
        // Beside a process no filter is known.
        augmented.effects.push(stated("quasi_periodic"));
        assert_eq!(kinds(&with_lasting(identified, &augmented, 0.0)), ["quasi_periodic"]);
    }
}
