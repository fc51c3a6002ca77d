//! What the operating system answers, in words of the tables.

pub use sagnac_ingest::io_reason;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};
    use std::io::Error;

    #[cfg(target_os = "linux")]
    #[test]
    fn english_is_what_the_system_says_and_russian_is_russian() {
        for code in [2, 13, 17, 28, 30, 20, 21, 39, 122] {
            let error = Error::from_raw_os_error(code);
            assert_eq!(io_reason(&error).say(Lang::En), error.to_string());
            let russian = io_reason(&error).say(Lang::Ru);
            assert!(!russian.contains("rror") && russian.contains(&code.to_string()), "{russian}");
        }
        let own = Error::other("odd");
        assert_eq!(io_reason(&own).say(Lang::Ru), "odd");
    }
}
