//! Lengths of time on the command line: a number with its unit, read alike by every option.

use crate::config::quantity;
use crate::i18n::{Lang, Localize, Note, note};
use std::fmt;

/// A length of time, or a moment from the start of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length {
    /// Seconds.
    pub seconds: f64,
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}s", self.seconds)
    }
}

/// The reason why a text is no length of time that an option takes.
#[derive(Debug)]
pub struct LengthError {
    why: Note,
    /// True where the text says no length at all, so that an example helps.
    example_helps: bool,
}

impl LengthError {
    /// The reason in a language, without the option and the text.
    pub fn say(&self, lang: Lang) -> String {
        let why = self.why.say(lang);
        if !self.example_helps {
            return why;
        }
        let help = note!("cli.length.help").say(lang);
        format!("{why}\n  {}: {help}", note!("diagnostic.help").say(lang))
    }
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.say(Lang::En))
    }
}

impl std::error::Error for LengthError {}

/// Reads a length above zero, such as that of a test.
///
/// # Errors
/// A number without a unit, a unit of something else, zero or less.
pub fn above_zero(text: &str) -> Result<Length, LengthError> {
    let length = with_unit(text)?;
    if length.seconds > 0.0 { Ok(length) } else { Err(out_of_range("cli.length.not_above_zero")) }
}

/// Reads a length that may be zero, such as a moment from the start of a recording.
///
/// # Errors
/// As [`above_zero`], but for zero.
pub fn from_zero(text: &str) -> Result<Length, LengthError> {
    not_negative(with_unit(text)?)
}

/// Reads a length that may be zero; a number without a unit is in seconds.
///
/// # Errors
/// As [`from_zero`], but for the unit.
pub fn from_zero_or_seconds(text: &str) -> Result<Length, LengthError> {
    match quantity::split(text) {
        Ok((seconds, "")) => not_negative(Length { seconds }),
        _ => from_zero(text),
    }
}

fn with_unit(text: &str) -> Result<Length, LengthError> {
    match quantity::parse(text, "s", true, false) {
        Ok(seconds) => Ok(Length { seconds }),
        Err(error) => Err(LengthError { why: error.message, example_helps: true }),
    }
}

fn not_negative(length: Length) -> Result<Length, LengthError> {
    if length.seconds >= 0.0 { Ok(length) } else { Err(out_of_range("cli.length.negative")) }
}

fn out_of_range(key: &'static str) -> LengthError {
    LengthError { why: key.into(), example_helps: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Reading = fn(&str) -> Result<Length, LengthError>;

    #[test]
    fn one_length_is_read_alike_by_every_option() {
        for read in [above_zero as Reading, from_zero, from_zero_or_seconds] {
            for text in ["30min", "30 min", "0.5h", "1800 s"] {
                assert_eq!(read(text).map(|l| l.seconds).ok(), Some(1800.0), "{text}");
            }
            for wrong in ["", "h", "3 deg", "NaN", "-5 s", "1e999 s", "0,5 h"] {
                assert!(read(wrong).is_err(), "{wrong}");
            }
        }
    }

    #[test]
    fn a_number_without_a_unit_is_seconds_only_where_it_always_was() {
        assert_eq!(from_zero_or_seconds("90").map(|l| l.seconds).ok(), Some(90.0));
        assert!(from_zero_or_seconds("-5").is_err());
        assert!(above_zero("90").is_err() && from_zero("90").is_err());
        assert_eq!(from_zero("0s").map(|l| l.seconds).ok(), Some(0.0));
        assert!(above_zero("0s").is_err());
    }
}
