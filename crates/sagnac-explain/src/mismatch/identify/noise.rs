//! The noise of a simulated recording, as a claim states it.

use crate::claim::{Coefficient, Stated};
use crate::effect::{EFFECTS, Model};
use crate::estimate::Estimate;
use crate::noise::composite::{Composite, Damped};
use crate::noise::digest::{DigestPlan, RateAccumulator};
use crate::noise::lines::FALSE_ALARM_RATE;
use crate::noise::spectral_record::identify_digest;
use crate::series::Series;

/// The noise found.
pub struct FittedNoise {
    /// N, deg/√h.
    pub n: Coefficient,
    /// B, deg/h.
    pub b: Coefficient,
    /// K, deg/h/√h.
    pub k: Coefficient,
    /// Q, arcsec.
    pub q: Coefficient,
    /// The noise with every term allowed, found or not: what columns are weighted by, for uncertainties.
    pub composite: Composite,
    /// Processes beyond N, B, K and Q that the catalogue can state.
    pub effects: Vec<Stated>,
}

fn coefficient(estimate: &Estimate) -> Coefficient {
    match estimate.value.filter(|v| *v > 0.0) {
        Some(value) => Coefficient::found(value, estimate.interval95().map(|i| (i.low, i.high))),
        None => {
            let most = estimate.upper_limit.map_or(0.0, |limit| limit.value);
            Coefficient::at_most(most.max(estimate.most_likely.unwrap_or(0.0)))
        }
    }
}

/// Identifies the noise of a residual, row by row.
pub fn identify(series: &Series, residual: &[f64]) -> FittedNoise {
    let tau0_s = series.sample_interval_s;
    let mut digest = RateAccumulator::new(DigestPlan::new(tau0_s));
    let mut from = 0;
    // A stretch without a gap is pushed at once.
    for i in 1..=residual.len() {
        let broken = i == residual.len() || series.index[i] != series.index[i - 1] + 1;
        if broken {
            digest.push(&residual[from..i], series.index[from], from > 0);
            from = i;
        }
    }
    let digest = digest.finish();
    let noise = identify_digest("rate", &digest, tau0_s, FALSE_ALARM_RATE, None);
    let identification = noise.ranged.identification;
    let composite = identification.described.model.clone();
    let processes = composite.markov.iter().chain(&composite.quasi_periodic);
    let effects = processes.filter_map(|p| stated(p, tau0_s)).collect();
    FittedNoise {
        n: coefficient(&identification.angle_random_walk),
        b: coefficient(&identification.bias_instability),
        k: coefficient(&identification.rate_random_walk),
        q: coefficient(&identification.quantization),
        composite: identification.allowed.clone(),
        effects,
    }
}

/// The effect that an identified process is; `None` where the catalogue lacks it.
fn stated(process: &Damped, dt_s: f64) -> Option<Stated> {
    EFFECTS.iter().find_map(|effect| {
        let Model::Spectrum(spectrum) = effect.model() else { return None };
        Some(Stated { effect: *effect, values: spectrum.values_of(process, dt_s)? })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::number;

    #[test]
    fn an_identified_process_is_stated_as_the_effect_that_it_is() {
        let of = |frequency_hz: f64, decay_time_s: f64| {
            stated(&Damped { rms_deg_h: 0.3, frequency_hz, decay_time_s }, 0.1).unwrap()
        };
        // Ten samples divide short from long.
        assert_eq!(of(0.0, 0.99).effect.kind(), "markov_short");
        let long = of(0.0, 1.0);
        assert_eq!(long.effect.kind(), "markov_long");
        assert_eq!(number(&long.values, "correlation_time_s"), Some(1.0));
        assert_eq!(number(&long.values, "sigma_deg_h"), Some(0.3));
        let line = of(2.5, 40.0);
        assert_eq!(line.effect.kind(), "quasi_periodic");
        assert_eq!(number(&line.values, "frequency_hz"), Some(2.5));
        assert_eq!(number(&line.values, "coherence_time_s"), Some(40.0));
    }
}
