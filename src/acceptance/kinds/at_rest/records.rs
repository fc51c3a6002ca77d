//! What the record holds of the noise of a gyro at rest: lines, the model of the noise, the deviations.

use super::noise_remarks;
use crate::measurand::GyroEvidence;
use crate::record::{LineRecord, NoiseModelRecord};

/// The spectral lines of a channel.
pub fn lines(gyro: &GyroEvidence) -> Vec<LineRecord> {
    gyro.lines
        .iter()
        .map(|l| LineRecord {
            channel: gyro.channel.clone(),
            frequency_hz: l.frequency_hz,
            resolution_hz: l.resolution_hz,
            amplitude_deg_h: l.amplitude_deg_h,
            excess: l.excess,
            false_alarm_probability: l.false_alarm_probability,
        })
        .collect()
}

/// The identified noise of a channel.
pub fn noise_model(gyro: &GyroEvidence) -> NoiseModelRecord {
    let id = &gyro.identification;
    let model = &id.supported;
    NoiseModelRecord {
        channel: gyro.channel.clone(),
        method: id.method.to_owned(),
        terms: id.claimed.clone(),
        angle_random_walk: model.n,
        bias_instability: model.b,
        rate_random_walk: model.k,
        rate_ramp: model.r,
        quantization: model.q,
        misfit: id.misfit.per_dof,
        misfit_probability: id.misfit.probability,
        misfit_band_hz: id.misfit.worst_band_hz.filter(|_| id.misfit.worst_probability < 0.01),
        markov: id.described.model.markov.iter().map(|d| [d.rms_deg_h, d.decay_time_s]).collect(),
        quasi_periodic: id
            .described
            .model
            .quasi_periodic
            .iter()
            .map(|d| [d.rms_deg_h, d.frequency_hz, d.decay_time_s])
            .collect(),
        cutoff_hz: id.cutoff.as_ref().and_then(|c| c.value),
        remarks: noise_remarks::remarks(gyro).into_iter().map(Into::into).collect(),
    }
}
