//! The size of an effect, and the values of its other parameters at which it is asked for.

use super::{Column, Param, Value, Values};

/// Question for the size of an effect on the mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizing {
    /// The parameter that says how large.
    pub parameter: &'static Param,
    /// The recorded column that it follows, for an effect that any column can drive.
    pub column: Option<Column>,
    /// Claimed value of the parameter; a size is the excess of the true value over it.
    pub claimed: f64,
    /// A size to begin from.
    pub begin: f64,
    /// The other parameters, one entry a place. One empty entry for an effect that has no others.
    pub places: Vec<Values>,
    /// Parameters that a fit of the effect counts.
    pub parameters: usize,
    /// Independent positions that its search looks at.
    pub trials: f64,
}

impl Sizing {
    /// Of an effect that is a coefficient times a column.
    pub fn linear(parameter: &'static Param) -> Sizing {
        Sizing {
            parameter,
            column: None,
            claimed: 0.0,
            begin: 1.0,
            places: vec![Values::new()],
            parameters: 1,
            trials: 1.0,
        }
    }

    /// Of an effect that is searched: its places, what its fit counts and how many positions are looked at.
    pub fn searched(
        parameter: &'static Param,
        places: Vec<Values>,
        parameters: usize,
        trials: f64,
    ) -> Sizing {
        Sizing { places, parameters, trials: trials.max(1.0), ..Sizing::linear(parameter) }
    }

    /// The same for a value that the claim states.
    pub fn claimed(self, claimed: f64) -> Sizing {
        Sizing { claimed, ..self }
    }

    /// The same from another size on.
    pub fn from(self, begin: f64) -> Sizing {
        Sizing { begin, ..self }
    }

    /// The parameters at a place with a size.
    pub fn values(&self, place: &Values, size: f64) -> Values {
        let mut values = place.clone();
        values.insert(self.parameter.name.to_owned(), Value::Number(self.claimed + size));
        values
    }
}

/// Question for the size of a process or a filter.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralSizing {
    /// The parameter that says how large.
    pub parameter: &'static Param,
    /// Its position among the fitted ones.
    pub position: usize,
    /// True where the effect is the larger, the smaller the parameter is.
    pub falls: bool,
    /// Fitted parameters, one entry a place; that of the size is one to begin from.
    pub places: Vec<Vec<f64>>,
}

/// Stated numbers by their names.
pub(super) fn numbers<const N: usize>(pairs: [(&str, f64); N]) -> Values {
    pairs.into_iter().map(|(name, value)| (name.to_owned(), Value::Number(value))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::number;

    #[test]
    fn a_size_is_counted_from_what_the_claim_states() {
        let parameter = &crate::effect::find("temp_linear").unwrap().params()[0];
        let sizing = Sizing::linear(parameter).claimed(0.25).from(2.0);
        assert_eq!(number(&sizing.values(&sizing.places[0], 0.5), parameter.name), Some(0.75));
        assert_eq!((sizing.begin, sizing.parameters, sizing.trials), (2.0, 1, 1.0));
        let places = vec![numbers([("time_s", 3.0)])];
        let searched = Sizing::searched(parameter, places, 2, 0.5);
        assert_eq!(number(&searched.values(&searched.places[0], 1.0), "time_s"), Some(3.0));
        assert_eq!((searched.parameters, searched.trials), (2, 1.0));
    }
}
