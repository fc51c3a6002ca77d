use super::*;
use clap::CommandFactory;

fn has_cyrillic(text: &str) -> bool {
    text.chars().any(|c| matches!(c, 'а'..='я' | 'А'..='Я' | 'ё'))
}

/// Every command with the path of its entries in the tables.
fn walk(command: &Command, path: &str, out: &mut Vec<(String, Command)>) {
    out.push((path.to_owned(), command.clone()));
    for below in command.get_subcommands() {
        walk(below, &below_path(path, below.get_name()), out);
    }
}

fn all(lang: Lang) -> Vec<(String, Command)> {
    let mut out = vec![];
    walk(&command(super::super::Cli::command(), lang), "sagnac", &mut out);
    out
}

#[test]
fn the_english_entries_are_the_texts_of_the_command() {
    let mut seen = 0;
    for (path, command) in all(Lang::En) {
        let entry = |key: &str| lookup(Lang::En, &format!("help.{path}.{key}")).map(str::trim);
        let shown = |text: Option<&clap::builder::StyledStr>| text.map(|t| t.to_string().trim().to_owned());
        assert_eq!(entry("about"), shown(command.get_about()).as_deref(), "{path}");
        assert_eq!(entry("after"), shown(command.get_after_help()).as_deref(), "{path}");
        for arg in command.get_arguments() {
            let id = arg.get_id().as_str();
            let entry =
                if id == "lang" { lookup(Lang::En, "help.common.lang") } else { entry(&format!("arg.{id}")) };
            assert_eq!(entry, shown(arg.get_help()).as_deref(), "{path} {id}");
            seen += 1;
            for value in arg.get_possible_values() {
                let key = format!("help.{path}.value.{id}.{}", value.get_name());
                let said = value.get_help().map(ToString::to_string);
                assert_eq!(lookup(Lang::En, &key).map(str::to_owned), said, "{key}");
            }
        }
    }
    assert!(seen > 20, "only {seen} arguments were seen");
}

#[test]
fn every_entry_of_the_tables_belongs_to_the_command() {
    let commands = all(Lang::En);
    for key in crate::i18n::table(Lang::En).keys().filter_map(|k| k.strip_prefix("help.")) {
        let Some((path, rest)) = key.split_once('.') else { panic!("{key}") };
        if matches!(path, "common" | "error" | "value_name") {
            continue;
        }
        let command = commands.iter().find(|c| c.0 == path).map(|c| &c.1);
        let command = command.unwrap_or_else(|| panic!("no command `{path}`"));
        let id = rest.split('.').nth(1);
        let known = matches!(rest, "about" | "after")
            || command.get_arguments().any(|a| Some(a.get_id().as_str()) == id);
        assert!(known, "nothing uses help.{key}");
    }
}

#[test]
fn no_visible_text_lacks_its_russian() {
    for (path, mut command) in all(Lang::Ru) {
        assert!(command.get_about().is_some_and(|a| has_cyrillic(&a.to_string())), "{path}");
        for arg in command.get_arguments() {
            let id = arg.get_id();
            assert!(arg.get_help().is_some_and(|h| has_cyrillic(&h.to_string())), "{path} {id}");
            if let Some(names) = arg.get_value_names().filter(|_| arg.get_action().takes_values()) {
                assert!(names.iter().all(|n| has_cyrillic(n)), "{path} {id}: {names:?}");
            }
        }
        let shown = command.render_help().to_string();
        for english in
            ["Usage", "Options", "Arguments", "Commands", "Print ", "default", "possible", "Example"]
        {
            assert!(!shown.contains(english), "{path}: {english}\n{shown}");
        }
    }
}

#[test]
fn complaints_are_said_in_russian() {
    for arguments in [
        &["sagnac", "rum"][..],
        &["sagnac", "run"],
        &["sagnac", "check", "--limts", "x"],
        &["sagnac", "schema", "x"],
        &["sagnac", "inspect", "x", "--sample-rate", "fast"],
        &["sagnac", "inspect", "--sample-rate"],
        &["sagnac", "run", "a", "b", "--serial", "1", "--serial", "2"],
        &["sagnac", "selftest", "more"],
        &["sagnac", "run", "--lang", "de"],
    ] {
        let parsed = command(super::super::Cli::command(), Lang::Ru).try_get_matches_from(arguments);
        let said = complaint(&parsed.unwrap_err(), Lang::Ru);
        assert!(said.starts_with("ошибка: ") && has_cyrillic(&said[16..]), "{arguments:?}: {said}");
        assert!(!said.contains("error") && !said.contains("Usage") && !said.contains('{'), "{said}");
    }
}

#[test]
fn the_language_is_found_before_the_arguments_are_parsed() {
    let of = |list: &[&str]| language(&list.iter().map(OsString::from).collect::<Vec<_>>());
    assert_eq!(of(&["sagnac", "run", "--lang", "ru"]), Lang::Ru);
    assert_eq!(of(&["sagnac", "--lang=ru", "--lang=en"]), Lang::En);
    assert_eq!(of(&["sagnac", "--lang=ru", "check", "--", "--lang=en"]), Lang::Ru);
}
