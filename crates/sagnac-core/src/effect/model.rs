//! What every effect says of itself, and the classes of effects.

use super::{Column, Domain, Drivers, MeanModel, Param, Samples, Spectrum, Value, Values};

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
    /// The course that stated parameters give where the effect is no [`MeanModel`] for fitting, deg/h; `None` where they
    /// give none.
    fn stated_course(&self, _values: &Values, _drivers: &Drivers) -> Option<Vec<f64>> {
        None
    }
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
