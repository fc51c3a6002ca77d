use super::*;
use clap::CommandFactory;
use std::collections::BTreeSet;

fn has_cyrillic(text: &str) -> bool {
    text.chars().any(|c| matches!(c, 'а'..='я' | 'А'..='Я' | 'ё'))
}

/// Every command of a language with how it is called.
fn all(lang: Lang) -> Vec<(String, Command)> {
    fn walk(command: &Command, called: &str, out: &mut Vec<(String, Command)>) {
        out.push((called.to_owned(), command.clone()));
        for below in command.get_subcommands() {
            walk(below, &format!("{called} {}", below.get_name()), out);
        }
    }
    let mut out = vec![];
    walk(&command(super::super::Cli::command(), lang), "sagnac", &mut out);
    out
}

/// Every English text that needs a translation: those of the derived command, and those that this module adds.
fn english_texts() -> BTreeSet<String> {
    let added = ["Usage", "OPTIONS", "COMMAND", "Commands", "Arguments", "Options", "Print help"];
    let added = added.into_iter().chain(["Print version", "possible values", "default"]);
    let mut texts: BTreeSet<String> =
        added.chain(VERB_HEADINGS.iter().map(|(_, heading)| *heading)).map(str::to_owned).collect();
    for (_, command) in all(Lang::En) {
        texts.extend(command.get_about().map(ToString::to_string));
        let after = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        texts.extend(after.lines().map(|line| line.trim_start().to_owned()));
        for arg in command.get_arguments() {
            texts.extend(arg.get_help().map(ToString::to_string));
            texts.extend(arg.get_help_heading().map(str::to_owned));
            if arg.get_action().takes_values() {
                texts.extend(arg.get_value_names().unwrap_or_default().iter().map(ToString::to_string));
            }
            let values = arg.get_possible_values();
            texts.extend(values.iter().filter_map(|value| value.get_help().map(ToString::to_string)));
        }
    }
    texts
}

/// True for a line that stays as it is: an empty one, a command, the name of a file.
fn is_the_same_everywhere(text: &str) -> bool {
    text.is_empty() || text.starts_with("sagnac ") || (text.ends_with(".json") && !text.contains(' '))
}

#[test]
fn every_text_of_the_command_has_a_translation_and_none_is_left_over() {
    let texts = english_texts();
    assert!(texts.len() > 200, "only {} texts were found", texts.len());
    for lang in Lang::ALL.iter().filter(|lang| **lang != Lang::En) {
        let keys = crate::i18n::table(*lang).keys().filter_map(|key| key.strip_prefix("help_text."));
        let keys: BTreeSet<String> = keys.map(str::to_owned).collect();
        let missing: Vec<&String> =
            texts.difference(&keys).filter(|text| !is_the_same_everywhere(text)).collect();
        assert!(missing.is_empty(), "{lang:?} has no translation of {missing:#?}");
        let left_over: Vec<&String> = keys.difference(&texts).collect();
        assert!(left_over.is_empty(), "{lang:?} translates what the command does not say: {left_over:#?}");
    }
    assert!(!crate::i18n::table(Lang::En).keys().any(|key| key.starts_with("help_text.")));
}

#[test]
fn every_heading_stands_above_its_verb() {
    let text = all(Lang::Ru)[0].1.clone().render_help().to_string();
    for (verb, heading) in VERB_HEADINGS {
        let above = format!("{}:\n  {verb} ", translation(heading, Lang::Ru));
        assert!(text.contains(&above), "`{above}` is not in {text}");
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
