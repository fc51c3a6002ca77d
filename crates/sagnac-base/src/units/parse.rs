//! The grammar of units: products, powers, roots.

use super::dimension::{BASE_COUNT, Dimension};
use super::error::UnitError;
use super::symbols::{SUGGESTED_SYMBOLS, differ_by_prefix, symbol};

/// Characters between the symbols of a product.
const BLANKS: [char; 3] = [' ', '\t', '\u{a0}'];

pub(super) struct Parser<'a> {
    pub text: &'a str,
    pub rest: &'a str,
    pub depth: u8,
}

impl Parser<'_> {
    pub fn grammar(&self, reason: &'static str) -> UnitError {
        UnitError::Grammar { text: self.text.to_owned(), reason }
    }

    fn skip_space(&mut self) {
        self.rest = self.rest.trim_start_matches(BLANKS);
    }

    /// Takes the sign with the blanks before it; where it is another, the blanks stay.
    fn take(&mut self, c: char) -> bool {
        match self.rest.trim_start_matches(BLANKS).strip_prefix(c) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    pub fn product(&mut self) -> Result<(f64, Dimension), UnitError> {
        self.depth += 1;
        if self.depth > 8 {
            return Err(self.grammar("unit_error.reason.nested"));
        }
        let (mut factor, mut dimension) = self.power()?;
        loop {
            let next = self.rest.trim_start_matches(BLANKS);
            let divide = if self.take('/') {
                true
            } else if ['*', '·', '⋅', '∙', '×', '.'].into_iter().any(|sign| self.take(sign)) {
                false
            } else if next.len() < self.rest.len() && next.starts_with(char::is_alphabetic) {
                // A blank multiplies, as in `rad s^-1`.
                false
            } else {
                break;
            };
            let (f, d) = self.power()?;
            factor = if divide { factor / f } else { factor * f };
            for (a, b) in dimension.iter_mut().zip(d) {
                let sum = i16::from(*a) + if divide { -i16::from(b) } else { i16::from(b) };
                *a = i8::try_from(sum).map_err(|_| self.grammar("unit_error.reason.exponent_large"))?;
            }
        }
        self.depth -= 1;
        Ok((factor, dimension))
    }

    fn power(&mut self) -> Result<(f64, Dimension), UnitError> {
        let (factor, dimension) = self.atom()?;
        let signed = |rest: &str| {
            let digits = rest.strip_prefix('-').unwrap_or(rest);
            digits.starts_with(|c: char| ('1'..='6').contains(&c))
        };
        let halves: i8 = if self.take('^')
            || self.rest.trim_start_matches(BLANKS).strip_prefix("**").is_some_and(|r| {
                self.rest = r;
                true
            }) {
            self.exponent()?
        } else if signed(self.rest) && dimension != [0; BASE_COUNT] {
            // Without a sign of a power: `s-1`, `s2`.
            self.exponent()?
        } else {
            let sign = if self.take('⁻') { -1 } else { 1 };
            match ['¹', '²', '³'].into_iter().zip([2, 4, 6]).find(|(digit, _)| self.take(*digit)) {
                Some((_, halves)) => sign * halves,
                None if sign < 0 => return Err(self.grammar("unit_error.reason.exponent_missing")),
                None => return Ok((factor, dimension)),
            }
        };
        self.raise(factor, dimension, halves)
    }

    fn raise(&self, factor: f64, dimension: Dimension, halves: i8) -> Result<(f64, Dimension), UnitError> {
        let mut out = [0; BASE_COUNT];
        for (o, d) in out.iter_mut().zip(dimension) {
            let twice = i16::from(d) * i16::from(halves);
            if twice % 2 != 0 {
                return Err(self.grammar("unit_error.reason.fourth_root"));
            }
            *o = i8::try_from(twice / 2).map_err(|_| self.grammar("unit_error.reason.exponent_large"))?;
        }
        Ok((factor.powf(f64::from(halves) / 2.0), out))
    }

    fn exponent(&mut self) -> Result<i8, UnitError> {
        let parenthesised = self.take('(');
        let end = self
            .rest
            .find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-' || c == '/'))
            .unwrap_or(self.rest.len());
        // Outside parentheses a slash divides the unit, it does not belong to the exponent.
        let end = if parenthesised { end } else { self.rest[..end].find('/').unwrap_or(end) };
        let (number, rest) = self.rest.split_at(end);
        let value = match number.split_once('/') {
            Some((a, b)) => a.parse::<f64>().ok().zip(b.parse::<f64>().ok()).map(|(a, b)| a / b),
            None => number.parse::<f64>().ok(),
        };
        self.rest = rest;
        if parenthesised && !self.take(')') {
            return Err(self.grammar("unit_error.reason.open"));
        }
        let halves = value.map(|v| v * 2.0).filter(|h| h.fract() == 0.0 && h.abs() <= 12.0);
        halves.map(|h| h as i8).ok_or_else(|| self.grammar("unit_error.reason.exponent"))
    }

    fn atom(&mut self) -> Result<(f64, Dimension), UnitError> {
        self.skip_space();
        if self.take('(') {
            let inner = self.product()?;
            return if self.take(')') { Ok(inner) } else { Err(self.grammar("unit_error.reason.open")) };
        }
        if self.take('√') {
            let (factor, dimension) = self.atom()?;
            return self.raise(factor, dimension, 1);
        }
        let end = self.rest.find(|c: char| "/*·⋅∙×^¹²³⁻() \t\u{a0}√".contains(c)).unwrap_or(self.rest.len());
        let end = self.split(end);
        let (name, rest) = self.rest.split_at(end);
        if name.is_empty() {
            return Err(self.grammar("unit_error.reason.symbol"));
        }
        self.rest = rest;
        if (name == "sqrt" || name == "rt") && self.rest.starts_with('(') {
            let (factor, dimension) = self.atom()?;
            return self.raise(factor, dimension, 1);
        }
        symbol(name).ok_or_else(|| UnitError::Unknown {
            symbol: name.to_owned(),
            suggestion: SUGGESTED_SYMBOLS
                .iter()
                .map(|s| (strsim::damerau_levenshtein(&name.to_lowercase(), &s.to_lowercase()), *s))
                .filter(|(distance, s)| *distance <= 1 + s.len() / 4 && !differ_by_prefix(name, s))
                .min_by_key(|(distance, _)| *distance)
                .map(|(_, s)| s.to_owned()),
        })
    }
    /// The end of the symbol that begins the rest, at most at `end`: before a point that multiplies, or before an exponent.
    fn split(&self, end: usize) -> usize {
        let whole = self.rest.get(..end).unwrap_or_default();
        if symbol(whole).is_some() {
            return end;
        }
        let mut ends = whole
            .char_indices()
            .filter(|(_, c)| *c == '.' || *c == '-' || c.is_ascii_digit())
            .map(|(i, _)| i);
        ends.rfind(|&i| whole.get(..i).is_some_and(|head| symbol(head).is_some())).unwrap_or(end)
    }
}
