//! From symbols to the tree of a formula, by the binding powers of its operators (Pratt 1973).

use super::expression::{Channels, Expression, Formula, FormulaError, Function, Node, Reference, Sign};
use super::lexer::{Placed, Symbol, symbols};
use crate::message::{Note, note};
use std::ops::Range;

/// Deepest nesting of parentheses and functions.
const MAX_DEPTH: usize = 50;

/// Binding powers: a sum, a product, a sign in front, a power.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const NEGATION: u8 = 3;
const POWER: u8 = 4;

/// The function that takes the worst of all axes.
const WORST: &str = "worst";

struct Parser<'a> {
    text: &'a str,
    symbols: &'a [Placed],
    at: usize,
    depth: usize,
    references: Vec<(Reference, Range<usize>)>,
}

pub(super) fn formula(text: &str) -> Result<Formula, FormulaError> {
    let symbols = symbols(text)?;
    let mut parser = Parser { text, symbols: &symbols, at: 0, depth: 0, references: vec![] };
    let root = parser.expression(0)?;
    if let Some((_, span)) = parser.peek() {
        return Err(FormulaError { span: span.clone(), message: note!("formula.operator") });
    }
    Ok(Formula { text: text.trim().to_owned(), references: parser.references, root })
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<&'a Placed> {
        self.symbols.get(self.at)
    }

    fn take(&mut self, mark: char) -> bool {
        let is = matches!(self.peek(), Some((Symbol::Mark(m), _)) if *m == mark);
        self.at += usize::from(is);
        is
    }

    /// The place of the next symbol, or of the end.
    fn here(&self) -> Range<usize> {
        let end = self.text.len();
        self.peek().map_or(end.saturating_sub(1)..end, |(_, span)| span.clone())
    }

    fn wrong<T>(&self, message: Note) -> Result<T, FormulaError> {
        Err(FormulaError { span: self.here(), message })
    }

    fn close(&mut self) -> Result<usize, FormulaError> {
        let end = self.here().end;
        if self.take(')') { Ok(end) } else { self.wrong(note!("formula.parenthesis")) }
    }

    /// An expression whose operators bind more than `least`.
    fn expression(&mut self, least: u8) -> Result<Expression, FormulaError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return self.wrong(note!("formula.nested", most = MAX_DEPTH));
        }
        let mut left = self.operand()?;
        while let Some((Symbol::Mark(mark), _)) = self.peek() {
            let (power, sign) = match mark {
                '+' => (SUM, Some(Sign::Plus)),
                '-' => (SUM, Some(Sign::Minus)),
                '*' => (PRODUCT, Some(Sign::Times)),
                '/' => (PRODUCT, Some(Sign::Over)),
                '^' => (POWER, None),
                _ => break,
            };
            if power <= least {
                break;
            }
            self.at += 1;
            left = match sign {
                Some(sign) => {
                    let right = self.expression(power)?;
                    let span = left.span.start..right.span.end;
                    Expression {
                        node: Node::Binary { sign, left: Box::new(left), right: Box::new(right) },
                        span,
                    }
                }
                None => self.power(left)?,
            };
        }
        self.depth -= 1;
        Ok(left)
    }

    /// The power of a base: its exponent is a number.
    fn power(&mut self, base: Expression) -> Result<Expression, FormulaError> {
        // A power of a power is one of the exponent: `a^2^3` is `a^(2^3)`.
        let exponent = self.expression(POWER - 1)?;
        let span = base.span.start..exponent.span.end;
        match constant(&exponent) {
            Some(exponent) => Ok(Expression { node: Node::Power { base: Box::new(base), exponent }, span }),
            None => Err(FormulaError { span: exponent.span, message: note!("formula.exponent") }),
        }
    }

    fn operand(&mut self) -> Result<Expression, FormulaError> {
        let Some((symbol, span)) = self.peek() else { return self.wrong(note!("formula.end")) };
        self.at += 1;
        match symbol {
            Symbol::Number(value, unit) => {
                let node = Node::Number { value: value * unit.base_factor(), unit: unit.clone() };
                Ok(Expression { node, span: span.clone() })
            }
            Symbol::Mark('-') => {
                let inner = self.expression(NEGATION)?;
                let span = span.start..inner.span.end;
                Ok(Expression { node: Node::Negative(Box::new(inner)), span })
            }
            Symbol::Mark('(') => {
                let inner = self.expression(0)?;
                let end = self.close()?;
                Ok(Expression { node: inner.node, span: span.start..end })
            }
            Symbol::Name(name) => self.named(name, span),
            Symbol::Mark(_) | Symbol::Channel(_) => {
                self.at -= 1;
                self.wrong(note!("formula.operand"))
            }
        }
    }

    /// A quantity or a function.
    fn named(&mut self, name: &str, span: &Range<usize>) -> Result<Expression, FormulaError> {
        if !self.take('(') {
            let (of, end) = match self.peek() {
                Some((Symbol::Channel(channel), place)) => {
                    self.at += 1;
                    (Channels::Named(channel.clone()), place.end)
                }
                _ => (Channels::Own, span.end),
            };
            return Ok(self.quantity(Reference { id: name.to_owned(), of }, span.start..end));
        }
        if name == WORST {
            let Some((Symbol::Name(id), _)) = self.peek() else { return self.wrong(note!("formula.worst")) };
            self.at += 1;
            if !matches!(self.peek(), Some((Symbol::Mark(')'), _))) {
                return self.wrong(note!("formula.worst"));
            }
            let end = self.close()?;
            return Ok(self.quantity(Reference { id: id.clone(), of: Channels::Worst }, span.start..end));
        }
        let Some(function) = Function::of(name) else {
            let known: Vec<&str> = Function::ALL.iter().map(|(n, _)| *n).chain([WORST]).collect();
            let message = note!("formula.function", name, known = known.join(", "));
            return Err(FormulaError { span: span.clone(), message });
        };
        let mut arguments = vec![self.expression(0)?];
        while self.take(',') {
            arguments.push(self.expression(0)?);
        }
        let end = self.close()?;
        if function.takes_one() && arguments.len() > 1 {
            let message = note!("formula.one_argument", name);
            return Err(FormulaError { span: span.start..end, message });
        }
        Ok(Expression { node: Node::Call { function, arguments }, span: span.start..end })
    }

    fn quantity(&mut self, reference: Reference, span: Range<usize>) -> Expression {
        let known = self.references.iter().position(|(r, _)| *r == reference);
        let place = known.unwrap_or_else(|| {
            self.references.push((reference, span.clone()));
            self.references.len() - 1
        });
        Expression { node: Node::Quantity(place), span }
    }
}

/// The value of a part without quantities and units.
fn constant(expression: &Expression) -> Option<f64> {
    match &expression.node {
        Node::Number { value, unit } if unit.is_pure() => Some(*value),
        Node::Negative(inner) => constant(inner).map(|v| -v),
        Node::Binary { sign, left, right } => {
            let (a, b) = (constant(left)?, constant(right)?);
            let value = match sign {
                Sign::Plus => a + b,
                Sign::Minus => a - b,
                Sign::Times => a * b,
                Sign::Over => a / b,
            };
            value.is_finite().then_some(value)
        }
        Node::Power { base, exponent } => constant(base).map(|b| b.powf(*exponent)).filter(|v| v.is_finite()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Input;
    use crate::units::Unit;

    /// The value of a formula of pure numbers.
    fn value(text: &str) -> f64 {
        let formula = Formula::parse(text).unwrap_or_else(|e| panic!("{text}: {e:?}"));
        let inputs: Vec<Vec<Input>> = vec![];
        formula.evaluate(&inputs, &|_, _| None).value.unwrap()
    }

    #[test]
    fn operators_bind_as_in_books() {
        for (text, expected) in [
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("8 - 3 - 2", 3.0),
            ("12 / 3 / 2", 2.0),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("9^(1/2)", 3.0),
            ("2 * -3", -6.0),
            ("1 - -1", 2.0),
            ("sqrt(16) + abs(-3)", 7.0),
            ("max(1, 5, 3) - min(4, 2)", 3.0),
            ("rss(3, 4)", 5.0),
            ("mean(1, 2, 6)", 3.0),
            ("50 %", 0.5),
        ] {
            assert!((value(text) - expected).abs() < 1e-12, "{text}: {}", value(text));
        }
    }

    #[test]
    fn quantities_are_listed_once() {
        let formula = Formula::parse("b + b@x * worst(n) + b").unwrap();
        let names: Vec<(&str, Channels)> =
            formula.references.iter().map(|(r, _)| (r.id.as_str(), r.of.clone())).collect();
        let named = |c: &str| Channels::Named(c.to_owned());
        assert_eq!(names, [("b", Channels::Own), ("b", named("x")), ("n", Channels::Worst)]);
        assert_eq!(formula.references[2].1, 10..18);
        let units = ["deg/h", "deg/h", "1"].map(|u| Unit::parse(u).unwrap());
        assert!(formula.unit(&units).unwrap().same_dimension(&units[0]));
    }

    #[test]
    fn the_wrong_part_is_pointed_at() {
        for (text, span) in [
            ("", 0..0),
            ("1 +", 2..3),
            ("1 2", 2..3),
            ("(1 + 2", 5..6),
            ("1 + * 2", 4..5),
            ("root(2)", 0..4),
            ("sqrt(1, 2)", 0..10),
            ("2^b", 2..3),
            ("worst(1)", 6..7),
            ("worst(b + 1)", 8..9),
            ("@x", 0..2),
            ("b c", 2..3),
        ] {
            assert_eq!(Formula::parse(text).unwrap_err().span, span, "{text}");
        }
        let deep = format!("{}1{}", "(".repeat(400), ")".repeat(400));
        assert_eq!(Formula::parse(&deep).unwrap_err().message.id, "formula.nested");
        let signs = format!("{}1", "-".repeat(900));
        assert!(Formula::parse(&signs).is_err());
    }

    #[test]
    fn any_text_is_read_or_refused_at_a_place_within_it() {
        const PARTS: [&str; 24] = [
            "a",
            "b@x",
            "c@'y@-4'",
            "worst(a)",
            "1",
            "2.5 mT",
            "3 [deg/h]",
            "0",
            "1e300",
            "+",
            "-",
            "*",
            "/",
            "^",
            "(",
            ")",
            ",",
            "sqrt(",
            "max(",
            "min(",
            "rss(",
            "mean(",
            "abs(",
            " ° ",
        ];
        let mut state = 61_u64;
        let mut next = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        let mut read = 0;
        for _ in 0..20_000 {
            let text: String = (0..=next(9)).map(|_| PARTS[next(PARTS.len())]).collect();
            match Formula::parse(&text) {
                Err(e) => {
                    assert!(e.span.start <= e.span.end && e.span.end <= text.len(), "{text}: {e:?}");
                    assert!(text.is_char_boundary(e.span.start), "{text}: {e:?}");
                }
                Ok(formula) => {
                    read += 1;
                    let units = vec![Unit::pure(); formula.references.len()];
                    if let Err(e) = formula.unit(&units) {
                        assert!(e.span.end <= text.len(), "{text}: {e:?}");
                    }
                    let inputs = vec![vec![Input::unknown(true, 1.0)]; formula.references.len()];
                    let outcome = formula.evaluate(&inputs, &|_, _| None);
                    assert!(outcome.value.is_none_or(f64::is_finite), "{text}: {outcome:?}");
                }
            }
        }
        assert!(read > 500, "only {read} texts were formulas");
    }
}
