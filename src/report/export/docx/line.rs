//! Values as lines of text with its looks.

use super::super::xml::{Xml, empty, node, printable};
use crate::i18n::visible;
use crate::report::page::{Joined, State, Value};
use quick_xml::events::BytesText;
use std::io;

/// A line: pieces of text, each of one look.
pub(super) type Line = Vec<Piece>;

/// A piece of text of one look.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Piece {
    /// Text.
    text: String,
    /// Look.
    look: Look,
}

/// How a piece of text looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Look {
    /// Bold.
    is_bold: bool,
    /// Smaller than its line.
    is_small: bool,
    /// As files have it.
    is_code: bool,
    /// Where it stands against the line.
    position: Option<&'static str>,
    /// Colour, six hexadecimal digits.
    colour: Option<&'static str>,
}

const ABOVE: Option<&str> = Some("superscript");
const BELOW: Option<&str> = Some("subscript");

/// Size of small text, half points.
const SMALL: &str = "15";

impl Piece {
    fn new(text: &str, look: Look) -> Piece {
        Piece { text: visible(text).into_owned(), look }
    }
}

/// A text in which nothing is markup.
pub(super) fn plain(text: &str) -> Line {
    vec![Piece::new(text, Look::default())]
}

/// A text that stands out.
pub(super) fn bold(text: &str) -> Line {
    vec![Piece::new(text, Look { is_bold: true, ..Look::default() })]
}

/// A sentence, in which names between backticks are code.
pub(super) fn sentence(text: &str) -> Line {
    let parts: Vec<&str> = text.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return plain(text);
    }
    let piece =
        |(at, part): (usize, &&str)| Piece::new(part, Look { is_code: at % 2 == 1, ..Look::default() });
    parts.iter().enumerate().filter(|(_, part)| !part.is_empty()).map(piece).collect()
}

/// A formula, in which letters and digits behind an underscore stand below the line.
pub(super) fn formula(text: &str) -> Line {
    let mut parts = text.split('_');
    let mut out = plain(parts.next().unwrap_or_default());
    for part in parts {
        let end = part.find(|c: char| !c.is_alphabetic() && !c.is_ascii_digit()).unwrap_or(part.len());
        let (below, rest) = part.split_at(end);
        out.push(Piece::new(below, Look { position: BELOW, ..Look::default() }));
        out.extend(plain(rest));
    }
    out
}

/// A verdict or a state, in its colour.
pub(super) fn state(state: &State) -> Line {
    let colour = match state.id.as_str() {
        "pass" | "ok" | "consistent" => Some("1A7F37"),
        "fail" | "error" | "invalid" | "mismatch" => Some("B42318"),
        "indeterminate" | "remark" | "unknown" => Some("8A5A00"),
        _ => None,
    };
    vec![Piece::new(&state.word, Look { is_bold: true, colour, ..Look::default() })]
}

/// A value as lines; a quantity with its unit where the unit has no place of its own.
pub(super) fn lines(value: &Value, with_unit: bool) -> Vec<Line> {
    match value {
        Value::Empty => vec![],
        Value::Text(text) => vec![plain(text)],
        Value::Sentence(text) => vec![sentence(text)],
        Value::Code(text) | Value::Digest(text) => vec![code(text)],
        Value::Formula(text) => vec![formula(text)],
        Value::Named { text, id } => vec![[plain(text), plain(" ("), code(id), plain(")")].concat()],
        Value::Link { text, .. } => vec![plain(text)],
        Value::State(of) => vec![state(of)],
        Value::Quantity(of) => vec![plain(&if with_unit { of.whole() } else { of.printed.clone() })],
        Value::Wide(of) => lines(of, with_unit),
        Value::Detailed(of) => {
            let mut out = lines(&of.value, with_unit);
            if of.is_strong {
                out.iter_mut().flatten().for_each(|piece| piece.look.is_bold = true);
            }
            for detail in &of.details {
                let below = lines(&detail.value, true);
                match detail.joined {
                    Joined::Unit => {
                        behind(&mut out, plain(", "));
                        below.into_iter().for_each(|line| behind(&mut out, line));
                    }
                    Joined::Interval | Joined::Remark | Joined::Further => out.extend(small(below)),
                }
            }
            out
        }
        Value::Noted { value, notes, .. } => {
            let mut out = lines(value, with_unit);
            let numbers = notes.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
            behind(&mut out, vec![Piece::new(&numbers, Look { position: ABOVE, ..Look::default() })]);
            out
        }
        Value::Several { values, between } => {
            let mut out = vec![];
            for (at, value) in values.iter().enumerate() {
                if at > 0 {
                    behind(&mut out, plain(between));
                }
                lines(value, with_unit).into_iter().for_each(|line| behind(&mut out, line));
            }
            out
        }
        Value::List { items, ordered } => {
            let item = |(text, number): (&String, usize)| {
                let before = if *ordered { plain(&format!("{number}. ")) } else { vec![] };
                [before, sentence(text)].concat()
            };
            items.iter().zip(1..).map(item).collect()
        }
    }
}

/// A name as files have it.
fn code(text: &str) -> Line {
    vec![Piece::new(text, Look { is_code: true, ..Look::default() })]
}

/// Adds pieces to the last line.
fn behind(out: &mut Vec<Line>, more: Line) {
    match out.last_mut() {
        Some(last) => last.extend(more),
        None => out.push(more),
    }
}

fn small(mut lines: Vec<Line>) -> Vec<Line> {
    lines.iter_mut().flatten().for_each(|piece| piece.look.is_small = true);
    lines
}

/// Letters of a piece.
pub(super) fn length(piece: &Piece) -> usize {
    piece.text.chars().count()
}

/// A paragraph of a style with a line.
pub(super) fn paragraph(xml: &mut Xml, style: &str, line: &Line) -> io::Result<()> {
    node(xml, "w:p", &[], |xml| {
        node(xml, "w:pPr", &[], |xml| empty(xml, "w:pStyle", &[("w:val", style)]))?;
        line.iter().try_for_each(|piece| run(xml, piece))
    })
}

fn run(xml: &mut Xml, piece: &Piece) -> io::Result<()> {
    let look = piece.look;
    node(xml, "w:r", &[], |xml| {
        if look != Look::default() {
            node(xml, "w:rPr", &[], |xml| {
                if look.is_code {
                    empty(xml, "w:rStyle", &[("w:val", "Code")])?;
                }
                if look.is_bold {
                    empty(xml, "w:b", &[])?;
                }
                if let Some(colour) = look.colour {
                    empty(xml, "w:color", &[("w:val", colour)])?;
                }
                if look.is_small {
                    empty(xml, "w:sz", &[("w:val", SMALL)])?;
                }
                look.position.map_or(Ok(()), |at| empty(xml, "w:vertAlign", &[("w:val", at)]))
            })?;
        }
        text(xml, &piece.text)
    })
}

/// A text, with the spaces at its ends.
pub(super) fn text(xml: &mut Xml, text: &str) -> io::Result<()> {
    let element = xml.create_element("w:t").with_attribute(("xml:space", "preserve"));
    element.write_text_content(BytesText::new(&printable(text))).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::Quantity;

    fn texts(value: &Value) -> Vec<String> {
        let whole = |line: &Line| line.iter().map(|p| p.text.as_str()).collect::<String>();
        lines(value, true).iter().map(whole).collect()
    }

    #[test]
    fn details_stand_below_their_value_and_units_behind_it() {
        let quantity = Quantity { number: Some(1.5), printed: "1.5".into(), unit: "°/h".into() };
        let value = Value::from(quantity).strong().detail(Joined::Interval, "1.4 … 1.6");
        assert_eq!(texts(&value), ["1.5\u{202f}°/h", "1.4 … 1.6"]);
        assert!(lines(&value, true)[0][0].look.is_bold && lines(&value, true)[1][0].look.is_small);
        assert_eq!(texts(&lines_of_unit()), ["Bias, °/h12"]);
    }

    fn lines_of_unit() -> Value {
        Value::from("Bias").detail(Joined::Unit, "°/h").noted("", vec![12])
    }

    #[test]
    fn backticks_are_code_and_underscores_stand_below() {
        let said = sentence("see `result.json` and `");
        assert_eq!(said, plain("see `result.json` and `"));
        assert!(sentence("see `a` now")[1].look.is_code);
        let formula = formula("σ_rrw·τ");
        assert_eq!((formula[1].text.as_str(), formula[1].look.position), ("rrw", BELOW));
    }
}
