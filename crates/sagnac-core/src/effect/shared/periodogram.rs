//! Gain of log-likelihood of a sinusoid of each frequency.

use crate::effect::{Drivers, SearchContext};
use sagnac_fft::real_forward;

/// Gains of log-likelihood, nats, of sinusoids at equidistant frequencies from 0.
pub(in crate::effect) struct LineGains {
    /// One a frequency.
    pub gains: Vec<f64>,
    /// Step of the frequencies, Hz: a half or less of the resolution of the record.
    pub step_hz: f64,
}

impl LineGains {
    /// From the score, padded to at least twice its length that transforms fast. Empty where it cannot be transformed.
    pub fn of(drivers: &Drivers, context: &SearchContext<'_>) -> LineGains {
        let n = context.score.len();
        let padded = (2 * n).next_power_of_two();
        let mut input = context.score.to_vec();
        input.resize(padded, 0.0);
        let plan = real_forward(padded);
        let mut spectrum = plan.make_output_vec();
        if n < 2 || plan.process(&mut input, &mut spectrum).is_err() {
            return LineGains { gains: vec![], step_hz: 1.0 };
        }
        // Mode k lies at k/(2n·dt). Weighted by the inverse covariance a sinusoid of amplitude 1 has n/2 over the power there.
        let power = |j: usize| {
            let mode = (2.0 * n as f64 * j as f64 / padded as f64).round() as usize;
            context.powers.get(mode.clamp(1, n - 1)).copied().unwrap_or(0.0)
        };
        let gains = spectrum.iter().enumerate().map(|(j, w)| w.norm_sqr() * power(j) / n as f64).collect();
        LineGains { gains, step_hz: 1.0 / (padded as f64 * drivers.dt_s) }
    }
}
