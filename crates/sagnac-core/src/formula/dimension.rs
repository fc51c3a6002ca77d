//! The unit of each part of a formula, known without data.

use super::expression::{Expression, FormulaError, Function, Node, Sign};
use crate::message::{Note, note};
use crate::units::Unit;

fn error<T>(expression: &Expression, message: Note) -> Result<T, FormulaError> {
    Err(FormulaError { span: expression.span.clone(), message })
}

/// Both units measure the same, or the second part is pointed at.
fn same(first: &Unit, second: &Unit, at: &Expression) -> Result<(), FormulaError> {
    match second.factor_to(first) {
        Ok(_) => Ok(()),
        Err(e) => error(at, e.note()),
    }
}

pub(super) fn unit(expression: &Expression, units: &[Unit]) -> Result<Unit, FormulaError> {
    let too_large = || note!("formula.no_unit");
    match &expression.node {
        Node::Number { unit, .. } => Ok(unit.clone()),
        Node::Quantity(place) => Ok(units.get(*place).cloned().unwrap_or_else(Unit::pure)),
        Node::Negative(inner) => unit(inner, units),
        Node::Binary { sign, left, right } => {
            let (a, b) = (unit(left, units)?, unit(right, units)?);
            let made = match sign {
                Sign::Plus | Sign::Minus => {
                    same(&a, &b, right)?;
                    Some(a)
                }
                Sign::Times => a.times(&b),
                Sign::Over => a.over(&b),
            };
            made.map_or_else(|| error(expression, too_large()), Ok)
        }
        Node::Power { base, exponent } => {
            let made = unit(base, units)?.to_power(*exponent);
            made.map_or_else(|| error(expression, too_large()), Ok)
        }
        Node::Call { function, arguments } => {
            let mut all = arguments.iter().map(|a| Ok::<_, FormulaError>((a, unit(a, units)?)));
            let Some(first) = all.next() else { return error(expression, too_large()) };
            let (_, first) = first?;
            for other in all {
                let (at, other) = other?;
                same(&first, &other, at)?;
            }
            match function {
                Function::Sqrt => first.to_power(0.5).map_or_else(|| error(expression, too_large()), Ok),
                Function::Abs | Function::Min | Function::Max | Function::Rss | Function::Mean => Ok(first),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::formula::Formula;
    use crate::units::Unit;

    /// Unit of a formula of `n` in deg/√h, `b` in deg/h and `m` in deg/h/mT.
    fn of(text: &str) -> Result<Unit, crate::formula::FormulaError> {
        let formula = Formula::parse(text).unwrap();
        let units: Vec<Unit> = formula
            .references
            .iter()
            .map(|(r, _)| match r.id.as_str() {
                "n" => "deg/sqrt(h)",
                "b" => "deg/h",
                _ => "deg/h/mT",
            })
            .map(|u| Unit::parse(u).unwrap())
            .collect();
        formula.unit(&units)
    }

    #[test]
    fn units_follow_from_the_parts() {
        for (text, unit) in [
            ("max(n, n@x)", "deg/sqrt(h)"),
            ("sqrt(b^2 + (m * 0.05 mT)^2)", "deg/s"),
            ("b / n^2", "1/deg"),
            ("n / sqrt(1 h)", "rad/s"),
            ("b / 0.1 [deg/h]", "1"),
            ("rss(b, m * 1 [mT])", "deg/h"),
        ] {
            // `1/deg` has no text of its own: deg/deg^2.
            let unit = Unit::parse(&unit.replace("1/deg", "deg/deg^2")).unwrap();
            assert!(of(text).unwrap().same_dimension(&unit), "{text}");
        }
    }

    #[test]
    fn parts_that_do_not_fit_are_pointed_at() {
        for (text, span) in [
            ("b + n", 4..5),
            ("max(b, b, n)", 10..11),
            ("b + 3", 4..5),
            ("sqrt(n)", 0..7),
            ("b + sqrt(b * n)", 4..15),
        ] {
            assert_eq!(of(text).unwrap_err().span, span, "{text}");
        }
    }
}
