//! What a procedure demands to be known of a unit.

use crate::config::spec::Word;
use crate::config::table::words;
use crate::i18n::{Arg, Note, note};
use crate::record::UnitUnderTest;

/// Something that must be known of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitFact {
    /// Its model, or the family in its place.
    Model,
    /// Its lot.
    Lot,
    /// The date on which it was built.
    BuildDate,
}

words!(UnitFact, UnitFact::FACT_WORDS, UnitFact::of);

impl UnitFact {
    /// The words of procedures.
    pub(crate) const FACT_WORDS: &[Word] = &[
        ("model", "The model, or the family in its place"),
        ("lot", "The lot or batch"),
        ("build_date", "The date on which the unit was built"),
    ];

    /// The fact of a word; `None` for another.
    pub(crate) fn of(word: &str) -> Option<UnitFact> {
        match word {
            "model" => Some(UnitFact::Model),
            "lot" => Some(UnitFact::Lot),
            "build_date" => Some(UnitFact::BuildDate),
            _ => None,
        }
    }

    /// Key of its name in the locale tables.
    fn name(self) -> &'static str {
        match self {
            UnitFact::Model => "report.model",
            UnitFact::Lot => "report.lot",
            UnitFact::BuildDate => "report.build_date",
        }
    }

    fn is_known(self, unit: &UnitUnderTest) -> bool {
        let stated = |text: &Option<String>| text.as_ref().is_some_and(|t| !t.trim().is_empty());
        match self {
            UnitFact::Model => stated(&unit.model) || unit.family.is_some(),
            UnitFact::Lot => stated(&unit.lot),
            UnitFact::BuildDate => stated(&unit.build_date),
        }
    }
}

/// What a test lacks to know about its unit: the serial number where it must be there, and other facts.
pub fn unknown(unit: &UnitUnderTest, serial_required: bool, required: &[UnitFact]) -> Vec<Note> {
    let no_serial = unit.serial.as_deref().is_none_or(|s| s.trim().is_empty());
    let mut notes: Vec<Note> = vec![];
    if serial_required && no_serial {
        notes.push("error.serial_missing".into());
    }
    let names: Vec<Arg> =
        required.iter().filter(|f| !f.is_known(unit)).map(|f| Arg::Key(f.name().to_owned())).collect();
    if !names.is_empty() {
        notes.push(note!("error.unit_data_missing", names = Arg::Several(names, ", ".into())));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_a_fact() {
        for (word, _) in UnitFact::FACT_WORDS {
            assert!(UnitFact::of(word).is_some(), "{word}");
        }
    }

    #[test]
    fn what_is_required_and_unknown_is_named() {
        let required = [UnitFact::Model, UnitFact::Lot, UnitFact::BuildDate];
        let mut unit = UnitUnderTest { serial: Some("1".into()), ..UnitUnderTest::default() };
        assert!(unknown(&unit, true, &[]).is_empty());
        unit.lot = Some("L7".into());
        let notes = unknown(&unit, true, &required);
        assert_eq!(notes.len(), 1);
        let Some(Arg::Several(names, _)) = notes[0].args.get("names") else { panic!("{notes:?}") };
        assert_eq!(names.len(), 2, "{names:?}");
        assert_eq!(unknown(&UnitUnderTest::default(), true, &[])[0].id, "error.serial_missing");
    }
}
