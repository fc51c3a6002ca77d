//! A law that several recordings may share: an effect of which everything but its coefficients is chosen.

use crate::claim::Stated;
use crate::effect::{
    COLUMN_TEXT, Column, Domain, Drivers, Effect, MeanModel, Model, Param, Sizing, Value, Values, list,
    number,
};

/// Sizes at which an effect is tried whose course is not proportional to its size, over the one to begin from.
const TRIED_SIZES: [f64; 6] = [0.03, 0.1, 0.3, 1.0, 3.0, 10.0];

/// An effect with its parameters. Some of them are coefficients, which are fitted.
#[derive(Clone)]
pub(super) struct Law {
    pub effect: &'static dyn Effect,
    pub model: &'static dyn MeanModel,
    /// Parameters; those that are coefficients are replaced by what is fitted.
    pub values: Values,
    pub coefficients: Coefficients,
    /// Numbers that its search looks for, coefficients among them.
    pub numbers: usize,
    /// Independent places that its search looks at.
    pub trials: f64,
}

/// Coefficients that the course is proportional to.
#[derive(Clone)]
pub(super) enum Coefficients {
    /// One number.
    Number(Sizing),
    /// A list of so many.
    List(&'static str, usize),
    /// Nothing: the course is that of the parameters.
    None,
}

/// The course of a law over one recording, deg/h, one value a sample.
pub(super) enum Courses {
    /// One for a coefficient of 1 of each.
    Columns(Vec<Vec<f64>>),
    /// That of the parameters.
    Fixed(Vec<f64>),
}

impl Law {
    /// The kind and the column that it follows: laws that are equal in both are one cause.
    pub fn cause(&self) -> (&'static str, Option<String>) {
        (self.effect.kind(), self.column().map(|c| c.name().to_owned()))
    }

    /// The column that it follows, for an effect that any column can drive.
    pub fn column(&self) -> Option<Column> {
        match self.values.get(COLUMN_TEXT) {
            Some(Value::Text(name)) => Some(Column::of_name(name)),
            _ => None,
        }
    }

    /// The course over a recording; `None` where the recording lacks what it needs.
    pub fn courses(&self, drivers: &Drivers) -> Option<Courses> {
        if !has_needs(self.effect, self.model, drivers) {
            return None;
        }
        match &self.coefficients {
            Coefficients::Number(sizing) => {
                let column = self.model.sized_course(sizing, &self.values, sizing.begin, drivers)?;
                Some(Courses::Columns(vec![column.into_iter().map(|x| x / sizing.begin).collect()]))
            }
            Coefficients::List(name, count) => {
                let one = |i: usize| {
                    let unit = (0..*count).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
                    let mut values = self.values.clone();
                    values.insert((*name).to_owned(), Value::List(unit));
                    self.model.course(&values, drivers)
                };
                Some(Courses::Columns((0..*count).map(one).collect::<Option<_>>()?))
            }
            Coefficients::None => self.model.course(&self.values, drivers).map(Courses::Fixed),
        }
    }

    /// Numbers that are neither coefficients nor whole, each with its parameter: they are searched.
    pub fn searched(&self) -> Vec<(&'static Param, f64)> {
        let fitted = match &self.coefficients {
            Coefficients::Number(sizing) => Some(sizing.parameter.name),
            _ => None,
        };
        let params = self.effect.params().iter().filter(|p| Some(p.name) != fitted && !p.whole);
        let at = |p: &'static Param| number(&self.values, p.name).filter(|v| *v != 0.0).map(|v| (p, v));
        let lists = self.effect.list_params().iter().any(|p| !list(&self.values, p.name).is_empty());
        // A listed parameter has its scale in the list.
        if lists { vec![] } else { params.filter_map(at).collect() }
    }

    /// The same with other values of the numbers that are searched, in the order of [`Law::searched`].
    pub fn at(&self, numbers: &[f64]) -> Law {
        let mut law = self.clone();
        for ((param, _), value) in self.searched().into_iter().zip(numbers) {
            law.values.insert(param.name.to_owned(), Value::Number(*value));
        }
        law
    }

    /// The effect with its coefficients, as a claim states it. `drivers` are those of a recording that has its column.
    pub fn stated(&self, coefficients: &[f64], drivers: &Drivers) -> Stated {
        let values = match (&self.coefficients, coefficients) {
            (Coefficients::Number(sizing), [size, ..]) => {
                self.model.claimed_size(sizing, &self.values, *size, drivers)
            }
            (Coefficients::List(name, _), all) => {
                let mut values = self.values.clone();
                values.insert((*name).to_owned(), Value::List(all.to_vec()));
                values
            }
            _ => self.values.clone(),
        };
        Stated { effect: self.effect, values }
    }
}

/// True where a recording has the columns that an effect needs.
fn has_needs(effect: &dyn Effect, model: &dyn MeanModel, drivers: &Drivers) -> bool {
    effect.needs().iter().all(|c| drivers.column(*c).is_some()) && model.applies(drivers)
}

/// Forward model of an effect of which every recording of the unit shows the same parameters; `None` for one of a moment of one
/// recording.
pub(super) fn of_the_unit(effect: &dyn Effect) -> Option<&'static dyn MeanModel> {
    let Model::Mean(model) = effect.model() else { return None };
    let of_a_moment = matches!(effect.domain(), Domain::Time | Domain::Frequency)
        || effect.params().iter().any(|p| p.instant);
    (!of_a_moment).then_some(model)
}

/// The laws that a recording suggests: every place of every effect of the unit.
pub(super) fn of_catalogue(
    effects: impl Iterator<Item = &'static dyn Effect>,
    drivers: &Drivers,
) -> Vec<Law> {
    let mut out = vec![];
    for effect in effects {
        let Some(model) = of_the_unit(effect) else { continue };
        if !has_needs(effect, model, drivers) {
            continue;
        }
        for sizing in model.sizings(drivers) {
            for place in sizing.places.clone() {
                out.extend(of_sizing(effect, model, &sizing, &place, drivers));
            }
        }
    }
    out
}

fn of_sizing(
    effect: &'static dyn Effect,
    model: &'static dyn MeanModel,
    sizing: &Sizing,
    place: &Values,
    drivers: &Drivers,
) -> Vec<Law> {
    let (numbers, trials) = (sizing.parameters, sizing.trials);
    if is_proportional(model, sizing, place, drivers) {
        let coefficients = Coefficients::Number(sizing.clone());
        return vec![Law { effect, model, values: place.clone(), coefficients, numbers, trials }];
    }
    let at = |factor: f64| Law {
        effect,
        model,
        values: sizing.values(place, factor * sizing.begin),
        coefficients: Coefficients::None,
        numbers,
        trials,
    };
    TRIED_SIZES.into_iter().map(at).collect()
}

fn is_proportional(model: &dyn MeanModel, sizing: &Sizing, place: &Values, drivers: &Drivers) -> bool {
    let course = |factor: f64| model.sized_course(sizing, place, factor * sizing.begin, drivers);
    let (Some(once), Some(twice)) = (course(1.0), course(2.0)) else { return false };
    let size = once.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    once.iter().zip(&twice).all(|(a, b)| (2.0 * a - b).abs() <= 1e-6 * size)
}

/// The law that another recording was found to follow, from what its explanation states.
pub(super) fn of_stated(stated: &Stated) -> Option<Law> {
    let model = of_the_unit(stated.effect)?;
    let coefficients = match model.linear_list() {
        Some(name) if !list(&stated.values, name).is_empty() => {
            Coefficients::List(name, list(&stated.values, name).len())
        }
        _ => Coefficients::None,
    };
    let numbers = stated.values.values().map(|v| if matches!(v, Value::Number(_)) { 1 } else { 0 }).sum();
    let numbers = match coefficients {
        Coefficients::List(_, count) => count,
        _ => numbers,
    };
    Some(Law {
        effect: stated.effect,
        model,
        values: stated.values.clone(),
        coefficients,
        numbers,
        trials: 1.0,
    })
}
