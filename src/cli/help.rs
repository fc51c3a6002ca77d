//! The help and the complaints of the command line in the language of the user.
//!
//! The texts of the derived command are English; for another language each is replaced by its entry in the locale
//! tables: `help.<verb>.about`, `help.<verb>.after`, `help.<verb>.arg.<id>`, `help.<verb>.value.<id>.<word>`, with
//! `sagnac` for the program itself and `help.common` for what every verb has. The English entries repeat the texts of the
//! command; the tests hold the two together.

use crate::i18n::{Lang, Localize, Note, lookup};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, ArgAction, Command, Error};
use std::ffi::OsString;
use std::process::ExitCode;

/// The language that the arguments ask for, or else the locale. It is needed before the arguments are parsed, for the
/// help and for the complaints about them.
pub fn language(arguments: &[OsString]) -> Lang {
    let mut asked = None;
    let mut rest = arguments.iter().filter_map(|a| a.to_str());
    while let Some(argument) = rest.next() {
        match argument.strip_prefix("--lang") {
            _ if argument == "--" => break,
            Some("") => asked = rest.next().and_then(Lang::from_code).or(asked),
            Some(value) => asked = value.strip_prefix('=').and_then(Lang::from_code).or(asked),
            None => {}
        }
    }
    asked.unwrap_or_else(|| Lang::of_locale(|name| std::env::var(name).ok()))
}

/// The command with its texts in a language.
pub fn command(command: Command, lang: Lang) -> Command {
    if lang == Lang::En { command } else { translated(command, "sagnac", lang) }
}

/// The text of a key; `None` where the tables lack it, so that the English text stays.
fn words(lang: Lang, key: &str) -> Option<&'static str> {
    lookup(lang, key)
}

fn translated(command: Command, path: &str, lang: Lang) -> Command {
    let of = |key: &str| words(lang, &format!("help.{path}.{key}"));
    let common = |key: &str| words(lang, &format!("help.common.{key}")).unwrap_or_default();
    let mut command = command
        .help_template(format!(
            "{{before-help}}{{about-with-newline}}\n{}: {{usage}}\n\n{{all-args}}{{after-help}}",
            common("usage")
        ))
        .subcommand_help_heading(common("commands"))
        .disable_help_flag(true)
        .disable_help_subcommand(true);
    if let Some(about) = of("about") {
        command = command.about(about);
    }
    if let Some(after) = of("after") {
        command = command.after_help(after.trim_start());
    }
    let ids: Vec<String> = command.get_arguments().map(|a| a.get_id().to_string()).collect();
    for id in &ids {
        // `--lang` is global and stands in one place of the tables.
        let text = if id == "lang" { words(lang, "help.common.lang") } else { of(&format!("arg.{id}")) };
        command = command.mut_arg(id, |arg| argument(arg, text, path, lang, &common));
    }
    // What the library would add by itself is English.
    command = command.arg(flag("help", 'h', ArgAction::Help, &common));
    if path == "sagnac" {
        command = command.disable_version_flag(true).arg(flag("version", 'V', ArgAction::Version, &common));
    }
    let usage = usage(&command, path, &common);
    command = command.override_usage(usage);
    let names: Vec<String> = command.get_subcommands().map(|c| c.get_name().to_owned()).collect();
    for name in names {
        command = command.mut_subcommand(&name, |below| translated(below, &below_path(path, &name), lang));
    }
    command
}

/// Path of the entries of a verb: its name, behind that of the verb that it is below.
fn below_path(path: &str, name: &str) -> String {
    if path == "sagnac" { name.to_owned() } else { format!("{path}_{name}") }
}

fn flag(name: &'static str, short: char, action: ArgAction, common: &dyn Fn(&str) -> &'static str) -> Arg {
    let arg = Arg::new(name).short(short).long(name).action(action);
    arg.help(common(name)).help_heading(common("options"))
}

/// The line that shows how the command is written.
fn usage(command: &Command, path: &str, common: &dyn Fn(&str) -> &'static str) -> String {
    let mut out =
        if path == "sagnac" { path.to_owned() } else { format!("sagnac {}", path.replace('_', " ")) };
    out.push_str(&format!(" [{}]", common("usage_options")));
    for arg in command.get_positionals() {
        out.push_str(&format!(" {arg}"));
    }
    if command.has_subcommands() {
        out.push_str(&format!(" <{}>", common("usage_command")));
    }
    out
}

fn argument(
    arg: Arg,
    text: Option<&'static str>,
    path: &str,
    lang: Lang,
    common: &dyn Fn(&str) -> &'static str,
) -> Arg {
    let positional = arg.is_positional();
    let id = arg.get_id().to_string();
    // The only heading of its own is that of the options for reading.
    let own = arg.get_help_heading().is_some();
    let heading = if positional {
        "arguments"
    } else if own {
        "how_read"
    } else {
        "options"
    };
    let mut arg = arg.help_heading(common(heading));
    let Some(text) = text else { return arg };
    let mut help = text.to_owned();
    if arg.get_action().takes_values() {
        let shown =
            arg.get_value_names().and_then(|names| names.first()).map_or(id.clone(), ToString::to_string);
        if let Some(name) = words(lang, &format!("help.value_name.{}", shown.to_lowercase())) {
            arg = arg.value_name(name);
        }
        let values: Vec<String> = arg
            .get_possible_values()
            .iter()
            .map(|v| match words(lang, &format!("help.{path}.value.{id}.{}", v.get_name())) {
                Some(meaning) if meaning != v.get_name() => format!("{} ({meaning})", v.get_name()),
                _ => v.get_name().to_owned(),
            })
            .collect();
        if !values.is_empty() {
            help.push_str(&format!(" [{}: {}]", common("values"), values.join(", ")));
        }
        let default: Vec<String> =
            arg.get_default_values().iter().map(|v| v.to_string_lossy().into_owned()).collect();
        if !default.is_empty() {
            help.push_str(&format!(" [{}: {}]", common("default"), default.join(", ")));
        }
        arg = arg.hide_possible_values(true).hide_default_value(true);
    }
    arg.help(help)
}

/// Says why the arguments cannot be used, or shows the help that was asked for.
pub fn refuse(error: &Error, lang: Lang) -> ExitCode {
    let asked_for = !error.use_stderr();
    if asked_for || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        super::stdout::check(error.print());
    } else if lang == Lang::En {
        // What was typed stands in it, so that it goes the way of all text from outside.
        super::place::eprint_diagnostic(&error.to_string());
    } else {
        super::place::eprint_diagnostic(&complaint(error, lang));
    }
    ExitCode::from(super::place::settled(
        if asked_for { super::exit::PASS } else { super::exit::ERROR },
        lang,
    ))
}

/// The complaint in a language, for the kinds that the tables know; in the words of the library for others.
fn complaint(error: &Error, lang: Lang) -> String {
    let part = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(texts)) => texts.join(", "),
        _ => String::new(),
    };
    let key = match error.kind() {
        ErrorKind::UnknownArgument => "help.error.unknown_argument",
        ErrorKind::InvalidSubcommand => "help.error.unknown_verb",
        ErrorKind::MissingRequiredArgument => "help.error.missing",
        ErrorKind::MissingSubcommand => "help.error.no_verb",
        ErrorKind::InvalidValue if part(ContextKind::InvalidValue).is_empty() => "help.error.no_value",
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => "help.error.invalid_value",
        ErrorKind::ArgumentConflict => "help.error.twice",
        ErrorKind::TooManyValues | ErrorKind::WrongNumberOfValues | ErrorKind::TooFewValues => {
            "help.error.number_of_values"
        }
        ErrorKind::InvalidUtf8 => "help.error.not_utf8",
        _ => return error.to_string(),
    };
    let subcommand = part(ContextKind::InvalidSubcommand);
    let given = part(ContextKind::InvalidArg);
    let note = Note::new(key)
        .with("argument", if given.is_empty() { subcommand } else { given })
        .with("value", part(ContextKind::InvalidValue));
    let mut out = super::place::error(&note, lang);
    let near = [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand, ContextKind::SuggestedValue];
    if let Some(near) = near.into_iter().map(part).find(|text| !text.is_empty()) {
        let hint = Note::new("keyed.help.did_you_mean").with("name", near);
        out.push_str(&format!("  {}: {}\n", Note::new("diagnostic.help").say(lang), hint.say(lang)));
    }
    let valid = part(ContextKind::ValidValue);
    if !valid.is_empty() {
        out.push_str(&format!("  {}\n", Note::new("help.error.values").with("values", valid).say(lang)));
    }
    out.push_str(&format!("\n{}\n", Note::new("help.error.more").say(lang)));
    out
}

#[cfg(test)]
#[path = "help_tests.rs"]
mod tests;
