//! What every effect has: id, parameters, class, properties.

use super::{
    Column, Detector, Domain, Drivers, Knot, MeanModel, Param, Rounding, Samples, Spectrum, Value, Values,
};

/// Kind, in `explain.json`, of a cause that the format has no kind for.
pub const UNKNOWN: &str = "unknown";

/// One piece of physics that a simulation can leave out.
pub trait Effect: Sync {
    /// Its id in files, on the command line and in the locale tables.
    fn kind(&self) -> &'static str;
    /// Whether format `explain/1` has a kind for it. It is named only where nothing that has one explains nearly as much.
    fn in_format(&self) -> bool {
        true
    }
    /// Its kind in `explain.json`: [`UNKNOWN`] for an effect that the format has no kind for.
    fn reported_kind(&self) -> &'static str {
        if self.in_format() { self.kind() } else { UNKNOWN }
    }
    /// Its parameters, in the order in which reports list them.
    fn params(&self) -> &'static [Param];
    /// Lists that a claim may state beside the numbers; the bounds are those of every value.
    fn list_params(&self) -> &'static [Param] {
        &[]
    }
    /// Recorded columns without which it cannot be found.
    fn needs(&self) -> &'static [Column] {
        &[]
    }
    /// The view in which it is clearest.
    fn domain(&self) -> Domain;
    /// Effects that it is most easily taken for, the nearest first.
    fn confusers(&self) -> &'static [&'static str];
    /// Its class and forward model.
    fn model(&self) -> Model;
    /// How it is found in single samples; `None` for an effect that is fitted to the whole record.
    fn detector(&self) -> Option<Detector> {
        match self.model() {
            Model::Samples(samples) => Some(samples.detector()),
            _ => None,
        }
    }
    /// True for an effect that multiplies the noise of each sample.
    fn sets_level(&self) -> bool {
        matches!(self.detector(), Some(Detector::Level(_)))
    }
    /// For an effect that rounds the output: how the step is stated and found.
    fn rounding(&self) -> Option<&'static dyn Rounding> {
        None
    }
    /// The family of effects of which several at once are one cause without a name; `None` for an effect that stands alone.
    fn family(&self) -> Option<Family> {
        None
    }
    /// The effect that two of this kind are together, where the second takes back what the first brought.
    fn reversed_pair(&self) -> Option<&'static dyn Effect> {
        None
    }
    /// For an effect that oscillates at `frequency_hz`: what a record of few cycles cannot tell it from.
    fn if_few_cycles(&self) -> Option<&'static dyn Effect> {
        None
    }
    /// For an effect that is fitted as a process and stated as the course that the process took.
    fn stated_by_course(&self) -> Option<&'static dyn StatedByCourse> {
        None
    }
    /// The course of stated parameters of an effect that is no [`MeanModel`], deg/h, one value a sample; `None` where they
    /// determine none.
    fn stated_course(&self, _values: &Values, _drivers: &Drivers) -> Option<Vec<f64>> {
        None
    }
}

/// Effects that are alike. Several of one family at once are one cause: lines side by side are a line that is modulated,
/// many lines a periodic course, several changes of the spectrum a spectrum that no effect has, several jumps a staircase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Coherent sinusoids.
    Line,
    /// Changes of the spectrum of the noise.
    Spectrum,
    /// Single jumps.
    Jump,
}

/// An effect that is fitted as a process, and stated as the course that the process took.
pub trait StatedByCourse: Sync {
    /// What a claim states of a course through knots of `time_s` and deg/h.
    fn values(&self, knots: &[Knot]) -> Values;

    /// The fitted parameters of a process of the size and pace of a stated course; `None` for a course of few knots.
    fn process(&self, stated: &Values) -> Option<Vec<f64>>;
}

/// The class of an effect, with its forward model.
#[derive(Clone, Copy)]
pub enum Model {
    /// Adds to the rate what its parameters and the recorded columns determine.
    Mean(&'static dyn MeanModel),
    /// Changes the spectrum of the noise.
    Spectrum(&'static dyn Spectrum),
    /// Acts on single samples: rows, outliers, jumps, the level of the noise.
    Samples(&'static dyn Samples),
}

/// Whether numbers, in the order of an effect's parameters, are within their bounds. NaN, a value that is not known, is.
pub fn plausible(effect: &dyn Effect, parameters: &[f64]) -> bool {
    let within = |(p, v): (&Param, &f64)| v.is_nan() || (p.lower..=p.upper).contains(v);
    effect.params().iter().zip(parameters).all(within)
}

/// Values as a claim may state them: clamped to the bounds of their parameters, NaN left out.
pub fn stateable(effect: &dyn Effect, values: Values) -> Values {
    let param = |name: &str| effect.params().iter().chain(effect.list_params()).find(|p| p.name == name);
    let one = |(name, value): (String, Value)| {
        let Some(p) = param(&name) else { return Some((name, value)) };
        let value = match value {
            Value::Number(v) => Value::Number(Some(v.clamp(p.lower, p.upper)).filter(|v| !v.is_nan())?),
            Value::List(list) if list.iter().any(|v| v.is_nan()) => return None,
            Value::List(list) => Value::List(list.iter().map(|v| v.clamp(p.lower, p.upper)).collect()),
        };
        Some((name, value))
    };
    values.into_iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_claim_cannot_state_is_clamped_or_left_out() {
        let effect = crate::effect::find("bias_step").unwrap();
        let stated = |step: f64, time: f64| {
            let values = [("step_deg_h", step), ("time_s", time)];
            stateable(effect, values.map(|(n, v)| (n.to_owned(), Value::Number(v))).into())
        };
        assert_eq!(stated(3e9, 5.0)["step_deg_h"], Value::Number(1e6));
        assert!(!stated(1.0, f64::NAN).contains_key("time_s"));
        assert!(plausible(effect, &[-1e6, f64::NAN]) && !plausible(effect, &[-1.1e6, 0.0]));
    }

    #[test]
    fn an_effect_that_the_format_has_no_kind_for_is_reported_as_unknown() {
        let of = |kind: &str| crate::effect::find(kind).unwrap().reported_kind();
        assert_eq!((of("line"), of("drifting_line")), ("line", UNKNOWN));
    }
}
