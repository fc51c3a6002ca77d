//! Which language: chosen, or given by the locale of the environment.

/// A language a document can be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Lang {
    /// English.
    #[default]
    En,
    /// Russian.
    Ru,
}

impl Lang {
    /// Every language, the default first.
    pub const ALL: &'static [Lang] = &[Lang::En, Lang::Ru];

    /// The code of the language, as the option `--lang` and HTML have it.
    pub fn code(self) -> &'static str {
        match self {
            Lang::En => "en",
            Lang::Ru => "ru",
        }
    }

    /// Its table as text.
    pub(super) fn source(self) -> &'static str {
        match self {
            Lang::En => include_str!("../../templates/locale/en.toml"),
            Lang::Ru => include_str!("../../templates/locale/ru.toml"),
        }
    }

    /// The language of a code such as `ru`; `None` for any other.
    pub fn from_code(code: &str) -> Option<Lang> {
        Lang::ALL.iter().copied().find(|l| l.code() == code)
    }

    /// The language that the locale of an environment asks for: the first of `LC_ALL`, `LC_MESSAGES` and `LANG` that
    /// is set decides; what is not spoken here is answered in English.
    pub fn of_locale(variable: impl Fn(&str) -> Option<String>) -> Lang {
        let locale = ["LC_ALL", "LC_MESSAGES", "LANG"]
            .iter()
            .find_map(|name| variable(name).filter(|v| !v.is_empty()));
        let locale = locale.unwrap_or_default();
        let code = locale.split(['_', '.', '@', '-']).next().unwrap_or_default();
        Lang::from_code(&code.to_ascii_lowercase()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_variable_that_is_set_decides() {
        let locale = |pairs: &[(&str, &str)]| {
            Lang::of_locale(|name| pairs.iter().find(|p| p.0 == name).map(|p| p.1.to_owned()))
        };
        assert_eq!(locale(&[]), Lang::En);
        assert_eq!(locale(&[("LANG", "ru_RU.UTF-8")]), Lang::Ru);
        assert_eq!(locale(&[("LANG", "ru")]), Lang::Ru);
        assert_eq!(locale(&[("LANG", "run_XX")]), Lang::En);
        assert_eq!(locale(&[("LC_ALL", "C"), ("LANG", "ru_RU.UTF-8")]), Lang::En);
        assert_eq!(locale(&[("LC_ALL", ""), ("LC_MESSAGES", "ru_RU"), ("LANG", "de_DE")]), Lang::Ru);
    }

    #[test]
    fn codes_lead_back() {
        for lang in Lang::ALL {
            assert_eq!(Lang::from_code(lang.code()), Some(*lang));
        }
        assert_eq!(Lang::from_code("de"), None);
    }
}
