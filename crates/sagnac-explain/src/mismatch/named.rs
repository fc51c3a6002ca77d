//! Effects that were named: by the fit in cosine modes, or by their detectors in single samples.

use super::estimates::Estimated;
use super::finding::{ParameterValue, ShapeRecord};
use super::improvement::Improvement;
use super::posterior::Probable;
use super::several::least_of;
use crate::effect::{Detection, Effect, Place, Value};

/// Effects that are counted as looked for in single samples.
pub const SAMPLE_EFFECTS: f64 = 40.0;

/// An effect that was named, however it was found.
pub struct NamedEffect {
    /// The effect that gives it its name.
    pub effect: &'static dyn Effect,
    /// The effect that a claim states it as: another one for a response that is named by its leading law.
    pub stated_as: &'static dyn Effect,
    /// Parameters.
    pub estimated: Estimated,
    /// Kinds that would have served as well.
    pub equivalents: Vec<&'static str>,
    /// Probability of each name; empty for an effect that its detector found.
    pub names: Vec<Probable>,
    /// Intervals in which it shows, principal one first.
    pub places: Vec<Place>,
    /// BIC without it less BIC with it.
    pub delta_bic: f64,
    /// Probability without it, everything counted.
    pub p_value: f64,
    /// Its improvement, where the fit in cosine modes determines it.
    pub improvement: Option<Improvement>,
    /// Gain of log-likelihood that the fit in cosine modes does not hold.
    pub local_gain: f64,
    /// Shape of a course that was found and is of no kind.
    pub shape: Option<ShapeRecord>,
}

impl NamedEffect {
    /// An effect as its detector found it.
    pub fn detected(effect: &'static dyn Effect, found: &Detection, delta_bic: f64) -> NamedEffect {
        let value = |r: &crate::effect::Reported| {
            let value = ParameterValue { value: r.value, unit: r.unit.to_owned(), ci95: r.ci95 };
            (r.name.to_owned(), value)
        };
        let text = |(name, value): (&String, &Value)| match value {
            Value::Text(text) => Some((name.clone(), text.clone())),
            _ => None,
        };
        NamedEffect {
            effect,
            stated_as: effect,
            estimated: Estimated {
                reported: found.reported.iter().map(value).collect(),
                formula: None,
                texts: found.stated.iter().filter_map(text).collect(),
                stated: found.stated.clone(),
            },
            equivalents: vec![],
            names: vec![],
            places: found.places.clone(),
            delta_bic,
            p_value: found.p_value,
            improvement: None,
            local_gain: found.gain,
            shape: None,
        }
    }

    /// Its reported instant, for an effect that has one.
    pub fn instant(&self) -> Option<&ParameterValue> {
        let param = self.effect.params().iter().find(|p| p.instant)?;
        self.estimated.reported.get(param.name)
    }
}

/// ΔBIC of a gain that is significant, all effects on samples counted; `None` for any other. BIC orders and does not decide.
pub fn significant_delta_bic(
    gain: f64,
    parameters: usize,
    p_value: f64,
    rows: usize,
    alpha: f64,
) -> Option<f64> {
    let delta_bic = 2.0 * gain - parameters as f64 * (rows as f64).ln();
    (least_of(p_value, SAMPLE_EFFECTS) < alpha).then_some(delta_bic)
}

/// Effects found in single samples.
#[derive(Default)]
pub struct SampleFindings {
    /// The effects with their names.
    pub named: Vec<NamedEffect>,
    /// Deviation of the noise of each sample over that of the record.
    pub level: Option<Vec<f64>>,
    /// Course that was subtracted from the residual, deg/h.
    pub taken: Option<Vec<f64>>,
    /// Gain of the fits without it, which counts it as known.
    pub gained_in_fit: f64,
}

impl SampleFindings {
    /// Takes a course out of what is left to explain.
    pub fn take(&mut self, course: Vec<f64>) {
        match &mut self.taken {
            Some(sum) => sum.iter_mut().zip(course).for_each(|(s, c)| *s += c),
            None => self.taken = Some(course),
        }
    }

    /// Gain that the fits in cosine modes do not hold.
    pub fn local_gain(&self) -> f64 {
        self.named.iter().map(|n| n.local_gain).sum::<f64>() - self.gained_in_fit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_chance_counts_whatever_its_parameters_cost() {
        // 2 · 20 − 2 ln 1000 = 26.18.
        let delta_bic = significant_delta_bic(20.0, 2, 1e-5, 1000, 0.01).unwrap();
        assert!((delta_bic - 26.184_489_442).abs() < 1e-6, "{delta_bic}");
        // 40 effects were looked for: 2.5e-4 is the 0.01 that was asked for.
        let counts = |gain: f64, p: f64| significant_delta_bic(gain, 2, p, 1000, 0.01).is_some();
        assert!(counts(20.0, 2.4e-4) && !counts(20.0, 2.6e-4));
        // Many parameters, each of which the p-value has counted.
        assert!(counts(5.0, 1e-9));
    }

    #[test]
    fn what_was_taken_out_adds_up() {
        let mut found = SampleFindings::default();
        found.take(vec![1.0, 2.0]);
        found.take(vec![0.5, -2.0]);
        assert_eq!(found.taken, Some(vec![1.5, 0.0]));
        assert_eq!(found.local_gain(), 0.0);
    }
}
