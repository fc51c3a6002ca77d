//! A law that no kind describes: a sum of few terms, each a form of one recorded column or the product of two.
//!
//! Forms are the value, its square, the rate of change and the value behind a delay. The terms are chosen by what they gain
//! under the noise at hand. A law that columns shifted in time reach as well is chance.

use super::chance::{is_chance, moved, orthonormal};
use super::first_order::{decay, delayed};
use super::polynomial::Scale;
use super::pursuit::{Pursuit, choices, matching_pursuit, remove, unit};
use super::reach::varies;
use super::response::rate_per_hour;
use super::thermal;
use crate::effect::{Column, Drivers, SearchContext};
use crate::numeric::cosine::dct2;
use crate::numeric::parallel;

/// Time constants of the delays, s.
const DELAYS_S: [f64; 3] = [150.0, 940.0, 5900.0];
/// Terms that a law has at most.
pub(in crate::effect) const MAX_TERMS: usize = 3;
/// Least gain of a term beyond the logarithm of the number of terms, nats.
const TERM_PRICE: f64 = 3.0;
/// Gain of shifted columns beyond the logarithm of the number of terms, nats, up to which it is that of plain noise.
const MAX_NOISE_GAIN: f64 = 8.0;

/// A form of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::effect) enum Form {
    /// The scaled value.
    Value,
    /// Its square.
    Square,
    /// Its rate of change, per hour.
    Rate,
    /// The scaled value behind a first-order delay.
    Delay { time_constant_s: f64 },
}

impl Form {
    fn all() -> impl Iterator<Item = Form> {
        let delays = DELAYS_S.into_iter().map(|time_constant_s| Form::Delay { time_constant_s });
        [Form::Value, Form::Square, Form::Rate].into_iter().chain(delays)
    }

    /// True where a record resolves it: a delay is longer than a sample and shorter than half the record.
    fn resolved(self, drivers: &Drivers) -> bool {
        match self {
            Form::Delay { time_constant_s } => {
                (drivers.dt_s..=0.5 * drivers.length_s()).contains(&time_constant_s)
            }
            _ => true,
        }
    }

    fn course(self, scaled: &[f64], drivers: &Drivers) -> Vec<f64> {
        match self {
            Form::Value => scaled.to_vec(),
            Form::Square => scaled.iter().map(|x| x * x).collect(),
            Form::Rate => rate_per_hour(scaled, drivers.dt_s),
            Form::Delay { time_constant_s } => delayed(scaled, time_constant_s, drivers.dt_s),
        }
    }
}

/// A form of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::effect) struct Factor {
    pub column: Column,
    pub form: Form,
}

impl Factor {
    /// As a claim states it: the form, the time constant of a delay, the column.
    fn stated(self) -> String {
        let name = self.column.name();
        match self.form {
            Form::Value => format!("value {name}"),
            Form::Square => format!("square {name}"),
            Form::Rate => format!("rate {name}"),
            Form::Delay { time_constant_s } => format!("delay {time_constant_s} {name}"),
        }
    }

    fn of_stated(stated: &str) -> Option<Factor> {
        let (form, rest) = stated.split_once(' ')?;
        let (form, name) = match form {
            "value" => (Form::Value, rest),
            "square" => (Form::Square, rest),
            "rate" => (Form::Rate, rest),
            "delay" => {
                let (time, name) = rest.split_once(' ')?;
                let time_constant_s = time.parse().ok().filter(|t: &f64| t.is_finite() && *t > 0.0)?;
                (Form::Delay { time_constant_s }, name)
            }
            _ => return None,
        };
        Some(Factor { column: Column::of_name(name), form })
    }
}

/// A term: one factor or the product of two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::effect) struct Term {
    pub first: Factor,
    pub second: Option<Factor>,
}

/// Between the factors of a term, and between terms, in a claim.
const FACTOR_SEPARATOR: &str = " * ";
const TERM_SEPARATOR: &str = " + ";

impl Term {
    pub fn factors(self) -> impl Iterator<Item = Factor> {
        [Some(self.first), self.second].into_iter().flatten()
    }

    /// True where it is made of a column, alone or with another.
    fn has(self, column: Column) -> bool {
        self.factors().any(|f| f.column == column)
    }

    /// Its course for a coefficient of 1.
    pub fn course(self, columns: &Columns<'_>, drivers: &Drivers) -> Option<Vec<f64>> {
        let mut out: Option<Vec<f64>> = None;
        for factor in self.factors() {
            let course = factor.form.course(&columns.scaled(factor.column)?, drivers);
            out = Some(match out {
                Some(so_far) => so_far.iter().zip(course).map(|(a, b)| a * b).collect(),
                None => course,
            });
        }
        out
    }

    /// Courses of its unknown states at the beginning of the record: that of each delay, times the other factor.
    pub fn initial(self, columns: &Columns<'_>, drivers: &Drivers) -> Vec<Vec<f64>> {
        let one = |factor: Factor, other: Option<Factor>| {
            let Form::Delay { time_constant_s } = factor.form else { return None };
            let state = decay(time_constant_s, drivers);
            let Some(other) = other else { return Some(state) };
            let other = other.form.course(&columns.scaled(other.column)?, drivers);
            Some(state.iter().zip(other).map(|(s, o)| s * o).collect())
        };
        let second = self.second.and_then(|second| one(second, Some(self.first)));
        one(self.first, self.second).into_iter().chain(second).collect()
    }
}

/// Terms as a claim states them.
pub(in crate::effect) fn stated(terms: &[Term]) -> String {
    let one = |t: &Term| t.factors().map(Factor::stated).collect::<Vec<_>>().join(FACTOR_SEPARATOR);
    terms.iter().map(one).collect::<Vec<_>>().join(TERM_SEPARATOR)
}

/// Terms that a claim states; `None` where they are none.
pub(in crate::effect) fn of_stated(text: &str) -> Option<Vec<Term>> {
    let one = |t: &str| {
        let mut factors = t.split(FACTOR_SEPARATOR).map(Factor::of_stated);
        let first = factors.next()??;
        let second = match factors.next() {
            Some(factor) => Some(factor?),
            None => None,
        };
        factors.next().is_none().then_some(Term { first, second })
    };
    text.split(TERM_SEPARATOR).map(one).collect()
}

/// A column with the range that is taken as −1 to 1.
pub(in crate::effect) struct Scaled<'a> {
    pub column: Column,
    pub values: std::borrow::Cow<'a, [f64]>,
    pub scale: Scale,
}

/// The columns that a law may be made of.
pub(in crate::effect) struct Columns<'a>(Vec<Scaled<'a>>);

impl<'a> Columns<'a> {
    /// Temperature, supply and every column without a role, where they vary.
    pub fn of(drivers: &'a Drivers) -> Columns<'a> {
        let known = [
            (Column::Temperature, thermal::smooth(drivers)),
            (Column::Supply, drivers.column(Column::Supply)),
        ];
        let others = drivers.others.iter().map(|o| (o.column, Some(o.smooth.as_slice())));
        let there = known.into_iter().chain(others).filter(|(_, values)| varies(*values));
        let scaled = |(column, values): (Column, Option<&'a [f64]>)| {
            let values = values?;
            Some(Scaled { column, scale: Scale::of(values), values: values.into() })
        };
        Columns(there.filter_map(scaled).collect())
    }

    /// The same with the ranges that a claim states, in the order of its factors.
    pub fn stated(
        drivers: &'a Drivers,
        terms: &[Term],
        centers: &[f64],
        halves: &[f64],
    ) -> Option<Columns<'a>> {
        let mut out = Columns::of(drivers);
        let factors: Vec<Factor> = terms.iter().flat_map(|t| t.factors()).collect();
        if factors.len() != centers.len() || factors.len() != halves.len() {
            return None;
        }
        for (factor, (center, half)) in factors.iter().zip(centers.iter().zip(halves)) {
            let column = out.0.iter_mut().find(|c| c.column == factor.column)?;
            column.scale = Scale { center: *center, half: *half };
            if half.is_nan() || *half <= 0.0 {
                return None;
            }
        }
        Some(out)
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The range of a column.
    pub fn scale(&self, column: Column) -> Option<Scale> {
        self.0.iter().find(|c| c.column == column).map(|c| c.scale)
    }

    /// The values of a column, in its unit.
    pub fn values(&self, column: Column) -> Option<&[f64]> {
        self.0.iter().find(|c| c.column == column).map(|c| &*c.values)
    }

    fn scaled(&self, column: Column) -> Option<Vec<f64>> {
        let column = self.0.iter().find(|c| c.column == column)?;
        Some(column.values.iter().map(|v| column.scale.scaled(*v)).collect())
    }

    /// One of them, or all, moved in time by the same shift.
    fn shifted(&self, slide: usize, only: Option<Column>) -> Columns<'_> {
        let moved = self.0.iter().map(|c| Scaled {
            column: c.column,
            values: match only.is_none_or(|only| only == c.column) {
                true => moved(&c.values, slide).into(),
                false => std::borrow::Cow::Borrowed(&*c.values),
            },
            scale: c.scale,
        });
        Columns(moved.collect())
    }

    /// Every term: each form of a column, and the product of any two forms but squares of different columns, or of value and rate of one.
    pub fn terms(&self, drivers: &Drivers) -> Vec<Term> {
        let forms = || Form::all().filter(|f| f.resolved(drivers));
        let factors = |column: Column| forms().map(move |form| Factor { column, form });
        let single = |first: Factor| Term { first, second: None };
        let mut out: Vec<Term> = self.0.iter().flat_map(|c| factors(c.column)).map(single).collect();
        for (i, a) in self.0.iter().enumerate() {
            let own = |form| Factor { column: a.column, form };
            out.push(Term { first: own(Form::Value), second: Some(own(Form::Rate)) });
            for b in &self.0[..i] {
                let linear = |f: &Factor| f.form != Form::Square;
                for first in factors(a.column).filter(linear) {
                    let products = factors(b.column).filter(linear);
                    out.extend(products.map(|second| Term { first, second: Some(second) }));
                }
            }
        }
        out
    }
}

/// A law that was found.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::effect) struct LawFound {
    /// Positions of its terms in [`Columns::terms`].
    pub terms: Vec<usize>,
    /// Choices of as many terms.
    pub trials: f64,
}

/// Terms in whitened modes.
fn whitened_terms(columns: &Columns<'_>, terms: &[Term], drivers: &Drivers, roots: &[f64]) -> Vec<Vec<f64>> {
    let one = |term: &Term| {
        let Some(course) = term.course(columns, drivers) else { return vec![] };
        let mut modes = whitened(&dct2(&course), roots);
        for initial in term.initial(columns, drivers) {
            remove(&mut modes, &unit(whitened(&dct2(&initial), roots)));
        }
        modes
    };
    parallel::map_items(terms, one)
}

fn whitened(modes: &[f64], roots: &[f64]) -> Vec<f64> {
    modes.iter().zip(roots).skip(1).map(|(x, r)| if r.is_finite() { x / r } else { 0.0 }).collect()
}

/// Data for the search of a law.
struct Search<'a> {
    columns: Columns<'a>,
    terms: Vec<Term>,
    /// The terms in whitened modes.
    modes: Vec<Vec<f64>>,
    residual: Vec<f64>,
    drivers: &'a Drivers,
    roots: Vec<f64>,
    /// Logarithm of the number of terms.
    many: f64,
}

impl Search<'_> {
    fn matching_pursuit(
        &self,
        modes: &[Vec<f64>],
        allowed: impl Fn(usize) -> bool,
        residual: &[f64],
    ) -> Pursuit {
        matching_pursuit(modes, allowed, residual, MAX_TERMS, self.many + TERM_PRICE)
    }

    /// Residual that some terms leave.
    fn left(&self, found: &Pursuit) -> Vec<f64> {
        let own = found.terms.iter().filter_map(|i| self.modes.get(*i).cloned()).collect();
        let mut left = self.residual.clone();
        orthonormal(own).iter().for_each(|d| remove(&mut left, d));
        left
    }

    /// The columns of a law, each once.
    fn columns_of(&self, found: &Pursuit) -> Vec<Column> {
        let mut out: Vec<Column> =
            found.terms.iter().flat_map(|i| self.terms[*i].factors()).map(|f| f.column).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    /// True where the columns of a law, moved in time, gain on what it leaves no small part of what it gains.
    fn is_chance(&self, found: &Pursuit) -> bool {
        let left = self.left(found);
        let of_slide = |slide: usize| {
            let modes =
                whitened_terms(&self.columns.shifted(slide, None), &self.terms, self.drivers, &self.roots);
            self.matching_pursuit(&modes, |_| true, &left).gain
        };
        is_chance(found.gain, self.many + MAX_NOISE_GAIN, of_slide)
    }

    /// The column of a law of several that, moved in time by itself, gains on what the law leaves no small part of what it adds to
    /// the others: it stands in the law by chance. `allowed` are the terms that the law was chosen from.
    fn column_by_chance(&self, found: &Pursuit, allowed: impl Fn(usize) -> bool) -> Option<Column> {
        let columns = self.columns_of(found);
        if columns.len() < 2 {
            return None;
        }
        let left = self.left(found);
        columns.into_iter().find(|column| {
            let with = |i: usize| self.terms[i].has(*column);
            let others = self.matching_pursuit(&self.modes, |i| allowed(i) && !with(i), &self.residual);
            let terms: Vec<Term> =
                (0..self.terms.len()).filter(|i| allowed(*i) && with(*i)).map(|i| self.terms[i]).collect();
            let of_slide = |slide: usize| {
                let columns = self.columns.shifted(slide, Some(*column));
                let modes = whitened_terms(&columns, &terms, self.drivers, &self.roots);
                self.matching_pursuit(&modes, |_| true, &left).gain
            };
            is_chance(found.gain - others.gain, self.many + MAX_NOISE_GAIN, of_slide)
        })
    }
}

/// The law that the residual follows; `None` where it follows none, or columns shifted in time do about as well. A column that
/// does about as well shifted by itself is no part of it.
pub(in crate::effect) fn search(drivers: &Drivers, context: &SearchContext<'_>) -> Option<LawFound> {
    let columns = Columns::of(drivers);
    let terms = columns.terms(drivers);
    let roots: Vec<f64> = context.powers.iter().map(|p| p.sqrt()).collect();
    let modes = whitened_terms(&columns, &terms, drivers, &roots);
    let many = (terms.len().max(1) as f64).ln();
    let residual = whitened(context.modes, &roots);
    let search = Search { columns, terms, modes, residual, drivers, roots, many };
    let mut barred: Vec<Column> = vec![];
    let found = loop {
        let allowed = |i: usize| !barred.iter().any(|c| search.terms[i].has(*c));
        let found = search.matching_pursuit(&search.modes, allowed, &search.residual);
        // Of one column each there are kinds.
        if !found.terms.iter().any(|i| search.terms[*i].second.is_some()) {
            return None;
        }
        // A whole that is chance is not examined column by column.
        if barred.is_empty() && search.is_chance(&found) {
            return None;
        }
        match search.column_by_chance(&found, allowed) {
            Some(column) => barred.push(column),
            None => break found,
        }
    };
    if !barred.is_empty() && search.is_chance(&found) {
        return None;
    }
    let trials = choices(search.terms.len(), found.terms.len());
    Some(LawFound { terms: found.terms, trials })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::OtherDriver;

    /// A day at a minute: temperature, and a pressure that changes unlike it.
    fn drivers() -> Drivers {
        let n = 1440;
        let of = |f: &dyn Fn(f64) -> f64| (0..n).map(|i| f(f64::from(i))).collect::<Vec<f64>>();
        let pressure = of(&|t| 1000.0 + 5.0 * (t / 130.0).sin() + 3.0 * (t / 57.0).cos());
        Drivers {
            dt_s: 60.0,
            samples: n as usize,
            averaged: 1,
            temperature: Some(of(&|t| 20.0 + 6.0 * (t / 210.0).cos() + 2.0 * (t / 33.0).sin())),
            others: vec![OtherDriver {
                column: Column::of_name("pressure_hPa"),
                smooth: pressure.clone(),
                values: pressure,
            }],
            ..Drivers::default()
        }
    }

    /// A course in noise of a deviation of 1.
    fn noisy(added: &[f64]) -> Vec<f64> {
        let mut state = 11u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        added.iter().map(|a| a + (0..12).map(|_| uniform()).sum::<f64>()).collect()
    }

    fn found(added: &[f64], drivers: &Drivers) -> Option<Vec<Term>> {
        let residual = noisy(added);
        let modes = dct2(&residual);
        let mut powers = vec![1.0; residual.len()];
        powers[0] = f64::INFINITY;
        let context = SearchContext { score: &residual, modes: &modes, powers: &powers };
        let found = search(drivers, &context)?;
        let terms = Columns::of(drivers).terms(drivers);
        Some(found.terms.iter().map(|i| terms[*i]).collect())
    }

    #[test]
    fn the_change_of_one_column_times_another_is_found_and_noise_follows_nothing() {
        let drivers = drivers();
        let (t, p) = (drivers.temperature.clone().unwrap(), drivers.others[0].values.clone());
        let product: Vec<f64> =
            (0..1440).map(|i| 60.0 * (p[i] - p[i.max(1) - 1]) * (t[i] - 20.0) / 8.0).collect();
        let terms = found(&product, &drivers).unwrap();
        let wanted = [Form::Value, Form::Rate];
        assert!(terms[0].second.is_some_and(|s| wanted.contains(&s.form)), "{terms:?}");
        assert!(terms[0].factors().any(|f| f.form == Form::Rate && f.column.name() == "pressure_hPa"));
        assert!(found(&vec![0.0; 1440], &drivers).is_none());
        // What follows one column alone has a kind of its own.
        let single: Vec<f64> = t.iter().map(|t| t - 20.0).collect();
        assert!(found(&single, &drivers).is_none());
    }

    #[test]
    fn a_column_that_only_fills_what_is_unexplained_is_no_part_of_a_law() {
        let mut drivers = drivers();
        let (t, p) = (drivers.temperature.clone().unwrap(), drivers.others[0].values.clone());
        let decoy = moved(&p, 3);
        let column = Column::of_name("decoy");
        drivers.others.push(OtherDriver { column, smooth: decoy.clone(), values: decoy });
        // A law of temperature and pressure, and beside it a course that nothing recorded explains.
        let added: Vec<f64> = (0..1440)
            .map(|i| {
                let law = 60.0 * (p[i] - p[i.max(1) - 1]) * (t[i] - 20.0) / 4.0;
                let x = i as f64;
                law + 0.5 * (x / 97.0).sin() + 0.5 * (x / 61.0 + 1.0).cos()
            })
            .collect();
        let columns = Columns::of(&drivers);
        let terms = columns.terms(&drivers);
        let modes = whitened_terms(&columns, &terms, &drivers, &[1.0; 1440]);
        let residual = whitened(&dct2(&noisy(&added)), &[1.0; 1440]);
        let plain =
            matching_pursuit(&modes, |_| true, &residual, MAX_TERMS, (terms.len() as f64).ln() + TERM_PRICE);
        assert!(plain.terms.iter().any(|i| terms[*i].has(column)), "{:?}", plain.terms);
        let law = found(&added, &drivers).unwrap();
        assert!(law.iter().all(|t| !t.has(column)), "{law:?}");
        assert!(law.iter().any(|t| t.second.is_some()));
    }

    #[test]
    fn terms_are_read_as_they_are_stated() {
        let drivers = drivers();
        let terms = Columns::of(&drivers).terms(&drivers);
        // Two columns: six forms each, their products of five by five, value times rate of each.
        assert_eq!(terms.len(), 12 + 25 + 2);
        for term in &terms {
            assert_eq!(of_stated(&stated(&[*term, terms[0]])), Some(vec![*term, terms[0]]));
        }
        let refused = ["", "value", "delay x t", "delay 0 t", "cube t", "value a * value b * value c"];
        for text in refused {
            assert_eq!(of_stated(text), None, "{text}");
        }
    }
}
