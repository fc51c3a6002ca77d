//! A law of the recorded columns that no kind describes, found term by term. It has no kind of its own in the format of
//! explanations.

use crate::effect::shared::law::{self, Columns, Factor, Form, MAX_TERMS, Term};
use crate::effect::shared::polynomial::sum;
use crate::effect::shared::pursuit::choices;
use crate::effect::shared::reach::reach;
use crate::effect::shared::response::COEFFICIENTS_LIST;
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, list, text,
};
use crate::numeric::range::Bounds;

pub struct ColumnLaw;

static PARAMS: [Param; 0] = [];

/// Name of the text of the terms.
const TERMS_TEXT: &str = "terms";
/// Names of the lists of the middle and the half width of the range of each factor.
const CENTERS_LIST: &str = "centers";
const HALF_RANGES_LIST: &str = "half_ranges";

describe! {
    ColumnLaw, "column_law", Mean in Driver, needs [],
    confusers [ColumnDriver, TempResponse, ColumnProduct, UnobservedDriver],
    lists [
        Param::inner(CENTERS_LIST, "", -1e12, 1e12),
        Param::inner(HALF_RANGES_LIST, "", 1e-12, 1e12),
        Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)
    ],
    texts [TERMS_TEXT],
    properties [slow, carried_over, outside_format, free_form]
}

/// Terms of nonlinear parameters: positions among the terms of the columns, −1 for none.
fn decode(nonlinear_parameters: &[f64], columns: &Columns<'_>, drivers: &Drivers) -> Vec<Term> {
    let all = columns.terms(drivers);
    let there = nonlinear_parameters.iter().filter(|i| **i >= 0.0);
    there.filter_map(|i| all.get(*i as usize).copied()).collect()
}

/// A number for a formula: three digits, the sign of mathematics.
fn digits(value: f64) -> String {
    let size = value.abs();
    let places = if size > 0.0 { (2.0 - size.log10().floor()).clamp(0.0, 12.0) as usize } else { 0 };
    let plain = if (1e-4..1e6).contains(&size) { format!("{size:.places$}") } else { format!("{size:.2e}") };
    format!("{}{plain}", if value < 0.0 { "−" } else { "" })
}

/// A factor with its zero, in the units of its column.
fn written(factor: Factor, zero: f64) -> String {
    let name = factor.column.name();
    let less = |name: &str| {
        let sign = if zero < 0.0 { '+' } else { '−' };
        format!("({name} {sign} {})", digits(zero.abs()))
    };
    match factor.form {
        Form::Value => less(name),
        Form::Square => format!("{}²", less(name)),
        Form::Rate => format!("d({name})/dt"),
        Form::Delay { time_constant_s } => less(&format!("{name} behind {time_constant_s} s")),
    }
}

/// The zero of a factor where its term and another one have the same other factor: a (u − u₀) f + b f = a (u − u₀ + b/a) f.
struct Merged {
    term: Term,
    coefficient: f64,
    zeros: [f64; 2],
}

/// Terms in the units of their columns, a single term put into the zero of a product that has it as a factor.
fn merged(terms: &[Term], coefficients: &[f64], columns: &Columns<'_>) -> Option<Vec<Merged>> {
    let mut out: Vec<Merged> = vec![];
    for (term, c) in terms.iter().zip(coefficients) {
        let (mut coefficient, mut zeros) = (*c, [0.0; 2]);
        for (factor, zero) in term.factors().zip(&mut zeros) {
            let scale = columns.scale(factor.column)?;
            coefficient /= if factor.form == Form::Square { scale.half.powi(2) } else { scale.half };
            *zero = scale.center;
        }
        out.push(Merged { term: *term, coefficient, zeros });
    }
    let singles: Vec<usize> = (0..out.len()).filter(|i| out[*i].term.second.is_none()).collect();
    let mut gone = vec![];
    for i in singles {
        let (single, c) = (out[i].term.first, out[i].coefficient);
        let product = out.iter_mut().find_map(|m| {
            let second = m.term.second?;
            let of = |moved: Factor| matches!(moved.form, Form::Value | Form::Delay { .. });
            match () {
                () if m.term.first == single && of(second) => Some((m, 1)),
                () if second == single && of(m.term.first) => Some((m, 0)),
                () => None,
            }
        });
        if let Some((product, which)) = product.filter(|(m, _)| m.coefficient != 0.0) {
            product.zeros[which] -= c / product.coefficient;
            gone.push(i);
        }
    }
    let mut at = 0;
    out.retain(|_| {
        at += 1;
        !gone.contains(&(at - 1))
    });
    Some(out)
}

impl MeanModel for ColumnLaw {
    fn applies(&self, drivers: &Drivers) -> bool {
        Columns::of(drivers).len() >= 2
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        if Columns::of(drivers).len() < 2 || !context.is_of(drivers.samples) {
            return Starts::none();
        }
        let Some(found) = law::search(drivers, context) else { return Starts::none() };
        let mut point: Vec<f64> = found.terms.iter().map(|i| *i as f64).collect();
        point.resize(MAX_TERMS, -1.0);
        Starts { points: vec![point], trials: found.trials }
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(-1.0, 1e6); MAX_TERMS]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let columns = Columns::of(drivers);
        let terms = decode(nonlinear_parameters, &columns, drivers);
        Regressors {
            offset: None,
            columns: terms.iter().filter_map(|t| t.course(&columns, drivers)).collect(),
            nuisance: terms.iter().flat_map(|t| t.initial(&columns, drivers)).collect(),
            ..Regressors::default()
        }
    }

    fn parameters(
        &self,
        _nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<f64> {
        vec![]
    }

    fn lists(
        &self,
        nonlinear_parameters: &[f64],
        coefficients: &[f64],
        drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        let columns = Columns::of(drivers);
        let terms = decode(nonlinear_parameters, &columns, drivers);
        let scales = terms.iter().flat_map(|t| t.factors()).filter_map(|f| columns.scale(f.column));
        let (centers, halves) = scales.map(|s| (s.center, s.half)).unzip();
        vec![(CENTERS_LIST, centers), (HALF_RANGES_LIST, halves), (COEFFICIENTS_LIST, coefficients.to_vec())]
    }

    fn texts(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<(&'static str, String)> {
        let terms = decode(nonlinear_parameters, &Columns::of(drivers), drivers);
        if terms.is_empty() { vec![] } else { vec![(TERMS_TEXT, law::stated(&terms))] }
    }

    fn formula(
        &self,
        nonlinear_parameters: &[f64],
        coefficients: &[f64],
        drivers: &Drivers,
    ) -> Option<String> {
        let columns = Columns::of(drivers);
        let terms = decode(nonlinear_parameters, &columns, drivers);
        let merged = merged(&terms, coefficients, &columns)?;
        let mut out = String::new();
        for (i, m) in merged.iter().enumerate() {
            let size = if i == 0 { m.coefficient } else { m.coefficient.abs() };
            if i > 0 {
                out.push_str(if m.coefficient < 0.0 { " − " } else { " + " });
            }
            out.push_str(&digits(size));
            for (factor, zero) in m.term.factors().zip(m.zeros) {
                out.push_str(" · ");
                out.push_str(&written(factor, zero));
            }
        }
        (!out.is_empty()).then_some(out)
    }

    fn odds(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> f64 {
        let all = Columns::of(drivers).terms(drivers).len();
        let chosen = nonlinear_parameters.iter().filter(|i| **i >= 0.0).count();
        -choices(all, chosen).max(1.0).ln()
    }

    fn linear_list(&self) -> Option<&'static str> {
        Some(COEFFICIENTS_LIST)
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let terms = law::of_stated(text(values, TERMS_TEXT)?)?;
        let coefficients = list(values, COEFFICIENTS_LIST);
        if terms.len() != coefficients.len() {
            return None;
        }
        let columns =
            Columns::stated(drivers, &terms, list(values, CENTERS_LIST), list(values, HALF_RANGES_LIST))?;
        let courses: Option<Vec<Vec<f64>>> = terms.iter().map(|t| t.course(&columns, drivers)).collect();
        Some(sum(coefficients, &courses?))
    }

    fn nuisance_columns(&self, values: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
        let Some(terms) = text(values, TERMS_TEXT).and_then(law::of_stated) else { return vec![] };
        let columns =
            Columns::stated(drivers, &terms, list(values, CENTERS_LIST), list(values, HALF_RANGES_LIST));
        columns.map_or_else(Vec::new, |c| terms.iter().flat_map(|t| t.initial(&c, drivers)).collect())
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let columns = Columns::of(drivers);
        let terms = decode(nonlinear_parameters, &columns, drivers);
        let course = sum(coefficients, &self.regressors(nonlinear_parameters, drivers).columns);
        let mut out: Vec<Place> = vec![];
        for factor in terms.iter().flat_map(|t| t.factors()) {
            let domain = factor.column.domain();
            if let Some(values) = columns.values(factor.column)
                && !out.iter().any(|p| p.domain == domain)
            {
                out.extend(reach(domain, values, &course));
            }
        }
        out.sort_by_key(|p| p.domain != Domain::Driver);
        out
    }

    fn whole(&self) -> &'static [usize] {
        &[0, 1, 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Column;
    use crate::effect::OtherDriver;

    #[test]
    fn a_formula_is_in_the_units_of_the_columns() {
        let values = |center: f64, half: f64| (0..9).map(move |i| center + half * (f64::from(i) / 4.0 - 1.0));
        let pressure: Vec<f64> = values(1000.0, 10.0).rev().collect();
        let drivers = Drivers {
            dt_s: 600.0,
            samples: 9,
            averaged: 1,
            temperature: Some(values(20.0, 5.0).collect()),
            others: vec![OtherDriver {
                column: Column::of_name("pressure_hPa"),
                smooth: pressure.clone(),
                values: pressure,
            }],
            ..Drivers::default()
        };
        let columns = Columns::of(&drivers);
        let all = columns.terms(&drivers);
        let at = |wanted: &str| all.iter().position(|t| law::stated(&[*t]) == wanted).unwrap() as f64;
        let product = at("rate pressure_hPa * value temp_degC");
        // 2 a scaled pressure an hour and scaled temperature: 2/(10 · 5).
        let formula = |shape: &[f64], c: &[f64]| ColumnLaw.formula(shape, c, &drivers).unwrap();
        assert_eq!(
            formula(&[product, -1.0, -1.0], &[2.0]),
            "0.0400 · d(pressure_hPa)/dt · (temp_degC − 20.0)"
        );
        // With the rate alone beside it the zero moves: 0.04 (T − 20) + 0.08 = 0.04 (T − 18).
        assert_eq!(
            formula(&[product, at("rate pressure_hPa"), -1.0], &[2.0, 0.8]),
            "0.0400 · d(pressure_hPa)/dt · (temp_degC − 18.0)"
        );
        assert_eq!(
            formula(&[product, at("square pressure_hPa"), -1.0], &[-2.0, -3.0]),
            "−0.0400 · d(pressure_hPa)/dt · (temp_degC − 20.0) − 0.0300 · (pressure_hPa − 1000)²"
        );
    }
}
