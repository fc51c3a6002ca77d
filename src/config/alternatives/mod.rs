//! `alternatives.toml`: what would explain a recording as well as the chosen effects do, each with its parameters.

mod tables;

pub use sagnac_core::mismatch::Alternative;

use crate::config::diagnostics::Problems;
use crate::config::model::write_effect;
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::config::text_file;
use std::fmt::Write as _;
pub(crate) use tables::ALTERNATIVES_FILE;
use tables::{AlternativeKeys, AlternativesTables};

/// Reads alternatives from the bytes of a file; `name` stands in diagnostics.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Vec<Alternative>, Problems> {
    let (found, problems) = checked(&text_file::source(name, bytes)?, &ALTERNATIVES_FILE, build);
    found.ok_or(problems)
}

fn build(root: &Section, reader: &mut Reader<'_>) -> Vec<Alternative> {
    let mut one = |keys: AlternativeKeys| Alternative {
        cause: keys.cause,
        chosen: keys.chosen,
        effects: keys.effects.into_iter().filter_map(|effect| effect.stated(reader)).collect(),
    };
    AlternativesTables::read(root).alternatives.into_iter().map(&mut one).collect()
}

/// The text of alternatives.
pub fn write(alternatives: &[Alternative]) -> String {
    let mut out = format!("format = \"{}\"\n", AlternativesTables::FORMAT);
    for one in alternatives {
        let _ = write!(out, "\n[[alternative]]\ncause = {}\nchosen = {}\n", one.cause, one.chosen);
        one.effects.iter().for_each(|stated| write_effect(stated, "alternative.effect", &mut out));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim::Stated;
    use crate::effect::{Value, find};
    use crate::i18n::Lang;

    #[test]
    fn alternatives_read_back_with_their_parameters() {
        let stated = |kind: &str, name: &str, value: f64| Stated {
            effect: find(kind).unwrap(),
            values: [(name.to_owned(), Value::Number(value))].into(),
        };
        let ramp = stated("rate_ramp", "slope_deg_h_per_h", 1.0 / 3.0);
        let line = stated("line", "frequency_hz", 0.4);
        let given = [
            Alternative { cause: 2, chosen: true, effects: vec![ramp, line.clone()] },
            Alternative { cause: 2, chosen: false, effects: vec![line] },
        ];
        let read = parse("alternatives.toml", write(&given).as_bytes()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(write(&read), write(&given));
        assert_eq!((read.len(), read[0].cause, read[0].chosen, read[1].chosen), (2, 2, true, false));
        assert_eq!(read[0].effects[0].values["slope_deg_h_per_h"], Value::Number(1.0 / 3.0));
        assert!(parse("a.toml", write(&[]).as_bytes()).is_ok_and(|a| a.is_empty()));
    }

    #[test]
    fn an_unknown_effect_is_diagnosed_at_its_place() {
        let text = "format = \"alternatives/1\"\n[[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"bias_stepp\"\n";
        let said = parse("a.toml", text.as_bytes()).err().map(|p| p.say(Lang::En)).unwrap_or_default();
        assert!(said.contains("a.toml:5:9") && said.contains("bias_step"), "{said}");
    }
}
