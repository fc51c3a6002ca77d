//! What every effect says of itself, and the classes of effects.

use super::{
    Column, Detector, Domain, Drivers, Knot, MeanModel, Param, Rounding, Samples, Spectrum, Value, Values,
};

/// Kind of a cause that the format of explanations has no name for.
pub const UNKNOWN: &str = "unknown";

/// One piece of physics.
pub trait Effect: Sync {
    /// Its kind in files.
    fn kind(&self) -> &'static str;
    /// Whether format `explain/1` has a kind for it. It is named only where nothing that has one explains nearly as much.
    fn in_format(&self) -> bool {
        true
    }
    /// Its kind in `explain.json`: [`UNKNOWN`] for an effect that the format has no kind for.
    fn reported_kind(&self) -> &'static str {
        if self.in_format() { self.kind() } else { UNKNOWN }
    }
    /// Its parameters.
    fn params(&self) -> &'static [Param];
    /// Lists that its stated form may carry beside the numbers, by name; the bounds are those of every value.
    fn list_params(&self) -> &'static [Param] {
        &[]
    }
    /// Columns without which it cannot be seen.
    fn needs(&self) -> &'static [Column] {
        &[]
    }
    /// The view where it shows first.
    fn domain(&self) -> Domain;
    /// Kinds it is most easily taken for, the nearest first.
    fn confusers(&self) -> &'static [&'static str];
    /// How it acts.
    fn model(&self) -> Model;
    /// How it is found in single samples; `None` for an effect that is fitted to the whole record.
    fn detector(&self) -> Option<Detector> {
        match self.model() {
            Model::Samples(samples) => Some(samples.detector()),
            _ => None,
        }
    }
    /// True for an effect that scales the noise of each sample.
    fn sets_level(&self) -> bool {
        matches!(self.detector(), Some(Detector::Level(_)))
    }
    /// The effect as one that rounds the output, which a claim states as a value of its own.
    fn rounding(&self) -> Option<&'static dyn Rounding> {
        None
    }
    /// Which effects it is alike, of which several together are one cause that has no name.
    fn family(&self) -> Option<Family> {
        None
    }
    /// What two of it are together where the second takes back what the first brought.
    fn reversed_pair(&self) -> Option<&'static dyn Effect> {
        None
    }
    /// What else a record shows where it holds few cycles of an effect that oscillates at `frequency_hz`.
    fn if_few_cycles(&self) -> Option<&'static dyn Effect> {
        None
    }
    /// The effect as one that a claim states by its course and not by its fitted parameters.
    fn stated_by_course(&self) -> Option<&'static dyn StatedByCourse> {
        None
    }
    /// The course that stated parameters give where the effect is no [`MeanModel`] for fitting, deg/h; `None` where they
    /// give none.
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

/// How an effect acts on the output.
#[derive(Clone, Copy)]
pub enum Model {
    /// Adds a course to the rate that its parameters and the columns determine.
    Mean(&'static dyn MeanModel),
    /// Changes the spectrum of the noise.
    Spectrum(&'static dyn Spectrum),
    /// Acts on single samples: rows, outliers, jumps, the level of the noise.
    Samples(&'static dyn Samples),
}

/// Whether numbers in the order of an effect's parameters are within what it allows; one that is not known is.
pub fn plausible(effect: &dyn Effect, parameters: &[f64]) -> bool {
    let within = |(p, v): (&Param, &f64)| v.is_nan() || (p.lower..=p.upper).contains(v);
    effect.params().iter().zip(parameters).all(within)
}

/// Values as a claim may state them: within the bounds of their parameters, those that are no numbers left out.
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
